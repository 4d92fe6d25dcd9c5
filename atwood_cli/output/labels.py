"""Words beside the points of a picture, where they cover nothing and cannot be taken for those of another."""

from collections.abc import Iterator, Sequence
from itertools import product
from math import inf
from typing import TYPE_CHECKING, Any, NamedTuple

from .figure import INK

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.transforms import Bbox


class Label(NamedTuple):
    """Words that belong to a point of a picture."""

    words: str
    x: float
    y: float
    colour: str = INK


class Place(NamedTuple):
    """Where words may stand: how far from their point, and to which side of it."""

    far: float
    x: int
    y: int
    wide: int


DISTANCES, WIDTHS = (6, 15, 27, 42, 60, 80, 110, 150), (1, 2, 3)  # points, and times as far to the side
FAR = 20  # points: from there on a thin line leads to the point
SPARE = 2  # pixels around words
CLEAR = 8  # pixels from a point: what is beside its own marker is not crossed
UNREADABLE, CROSSED, AMBIGUOUS = 1000, 40, 20  # covered dots that weigh as much; and points of distance
AWAY = 30
HORIZONTAL, VERTICAL = {1: "left", -1: "right", 0: "center"}, {1: "bottom", -1: "top", 0: "center"}
PLACES = [
    Place(far, x, y, wide)
    for far, x, y, wide in product(DISTANCES, HORIZONTAL, VERTICAL, WIDTHS)
    if (x or y) and (x or wide == 1)
]
"""Around a point, those beside it first."""


def write_labels(axes: "Axes", labels: Sequence[Label], size: float = 9, *, laid_out: bool = False) -> None:
    """Write words beside their points, where they cover no line, no point and no other words.

    To be called when all else is drawn: it goes by where that stands on the page. The page is laid out
    first, which takes a while, unless only other labels were written since it was ``laid_out``.
    """
    if not laid_out:
        figure: Any = axes.figure
        figure.draw_without_rendering()  # which decides where the axes lie
    page = _Page(axes, labels)
    for label in labels:
        extent, best, place = page.extent(label, size), inf, Place(0, 0, 0, 0)
        for other in PLACES:
            if best <= other.far / AWAY:  # as no place so far away is better
                break
            cost = page.cost(label, other, extent, best)
            if cost < best:
                best, place = cost, other
        page.take(label, place, extent)
        _write(axes, label, place, size)


def _write(axes: "Axes", label: Label, place: Place, size: float) -> None:
    leads = {"arrowstyle": "-", "lw": 0.6, "color": label.colour, "shrinkB": 3} if place.far > FAR else None
    axes.annotate(
        label.words,
        (label.x, label.y),
        xytext=(place.x * place.far * place.wide, place.y * place.far),
        textcoords="offset points",
        ha=HORIZONTAL[place.x],
        va=VERTICAL[place.y],
        color=label.colour,
        size=size,
        arrowprops=leads,
        in_layout=False,
    )


class _Page:
    """What stands where on the page, in pixels: words, points, and the dots that all else is made of."""

    def __init__(self, axes: "Axes", labels: Sequence[Label]) -> None:
        import numpy as np
        from matplotlib.text import Text

        self.axes = axes
        figure: Any = axes.figure
        self.renderer, self.pixel = figure.canvas.get_renderer(), figure.dpi / 72
        texts = [text for text in (*axes.texts, axes.title) if text.get_text()]
        self.taken = [Text.get_window_extent(text, self.renderer) for text in texts]
        if (legend := axes.get_legend()) is not None:
            self.taken.append(legend.get_window_extent(self.renderer))
        self.dots = np.concatenate([np.empty((0, 2)), *_drawn(axes)])
        self.points = np.array([self._point(label) for label in labels])

    def extent(self, label: Label, size: float) -> Any:
        """The width and height of its words."""
        text = self.axes.text(label.x, label.y, label.words, size=size)
        box = text.get_window_extent(self.renderer)
        text.remove()
        return box.size

    def cost(self, label: Label, place: Place, extent: Any, least: float) -> float:
        """What is wrong with a place, in covered dots; what is more than the least is not told exactly."""
        box, inside = self._box(label, place, extent), self.axes.bbox
        unreadable = sum(map(box.overlaps, self.taken))
        unreadable += not (inside.contains(*box.min) and inside.contains(*box.max))
        cost = UNREADABLE * unreadable + _inside(self.dots, box).sum() + place.far * place.wide / AWAY
        if cost >= least:
            return float(cost)
        beside = self._crossed if place.far > FAR else self._ambiguous
        return float(cost + beside(box, self._point(label)))

    def take(self, label: Label, place: Place, extent: Any) -> None:
        """Let nothing else stand where these words do, nor on the line to their point."""
        import numpy as np

        box = self._box(label, place, extent)
        self.taken.append(box)
        if place.far > FAR:
            self.dots = np.concatenate([self.dots, _way(box, self._point(label))])

    def _point(self, label: Label) -> Any:
        return self.axes.transData.transform((label.x, label.y))

    def _box(self, label: Label, place: Place, extent: Any) -> "Bbox":
        """The room that words take there: without the line to their point, but with some around them."""
        from matplotlib.transforms import Bbox

        (x, y), (width, height) = self._point(label), extent
        x += place.x * place.far * place.wide * self.pixel + (place.x - 1) * width / 2
        y += place.y * place.far * self.pixel + (place.y - 1) * height / 2
        return Bbox.from_bounds(x, y, width, height).padded(SPARE)

    def _crossed(self, box: "Bbox", point: Any) -> float:
        """What the line from the words to their point crosses."""
        import numpy as np

        way = _way(box, point)
        words = sum(_inside(way, one).any() for one in self.taken)
        lines = (np.hypot(*(self.dots[:, None] - way).T) < SPARE).any(axis=0).sum() if len(self.dots) else 0
        return float(CROSSED * words + lines)

    def _ambiguous(self, box: "Bbox", point: Any) -> float:
        """What it costs to stand as near to the point of other words."""
        import numpy as np

        off = np.hypot(*(self.points - self.points.clip(box.min, box.max)).T)
        own = np.hypot(*(point - point.clip(box.min, box.max)))
        return float(AMBIGUOUS * (np.count_nonzero(off <= own + SPARE) > 1))


def _inside(dots: Any, box: "Bbox") -> Any:
    """Which of some dots lie in a box."""
    return ((box.min < dots) & (dots < box.max)).all(axis=1)


def _way(box: "Bbox", point: Any) -> Any:
    """The dots of the line from a box to just before a point."""
    import numpy as np

    start = point.clip(box.min, box.max)
    return np.linspace(start, point + CLEAR * (start - point) / max(np.hypot(*(start - point)), CLEAR), 40)


def _drawn(axes: "Axes") -> Iterator[Any]:
    """The dots of the lines, bars and markers that are drawn."""
    import numpy as np

    for bars in axes.collections:
        for corners in getattr(bars, "get_segments", list)():
            yield _along(bars.get_transform().transform(corners))
    for line in axes.lines:
        corners = line.get_transform().transform(np.column_stack([line.get_xdata(), line.get_ydata()]))
        if line.get_marker() not in ABSENT:
            radius = line.get_markersize() / 2 * axes.figure.dpi / 72
            edges = np.array([[1, 0], [-1, 0], [0, 1], [0, -1], [0, 0]]) * radius
            yield (corners[np.isfinite(corners).all(axis=1), None] + edges).reshape(-1, 2)
        if line.get_linestyle() not in ABSENT:
            yield _along(corners)


ABSENT = ("", " ", "None", None)


def _along(corners: Any) -> Any:
    """A dot every few pixels along a line, but not over its gaps."""
    import numpy as np

    there = np.isfinite(corners).all(axis=1)
    if there.sum() < 2:
        return corners[there]
    steps = np.where(there[:-1] & there[1:], np.hypot(*np.diff(corners, axis=0).T), 0)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    places = np.arange(0.0, along[-1] + 3, 3)
    return np.column_stack([np.interp(places, along[there], corners[there, i]) for i in (0, 1)])
