"""Words beside the points of a picture, where they cover nothing and cannot be taken for another point's.

A label tries the places around its point, the nearest first, and takes the one of least cost. The cost counts
what the words would cover, what a line from them to their point would cross, and how far away they are.
"""

from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from math import hypot, inf
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from .figure import INK

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.transforms import Bbox


class Label(NamedTuple):
    """Words that belong to a point of a picture."""

    words: str
    x: float
    y: float
    colour: str = INK


DISTANCES, WIDTHS = (6, 15, 27, 42, 60, 80, 110, 150), (1, 2, 3)  # points, and times as far to the side
PLACES = sorted(
    {
        (x * far * wide, y * far)
        for far, wide, x, y in product(DISTANCES, WIDTHS, (-1, 0, 1), (-1, 0, 1))
        if x or y
    },
    key=lambda place: (hypot(*place), -place[0], -place[1]),
)
"""Where words may stand, in points from their point: the nearest first, and then to the right and above."""
FAR = 25  # points: words further away have a thin line to their point
SPARE = 2  # pixels around words
CLEAR = 8  # pixels: a line ends so far before its point, beside the marker
UNREADABLE, CROSSED, AMBIGUOUS = 1000, 40, 20
"""Costs in covered dots: of words over words, of a line across words or a line, of words as near to
another point."""
AWAY = 30  # points of distance that cost as much as a covered dot


def write_labels(figure: "Figure", labels: Mapping["Axes", Sequence[Label]], size: float = 9) -> None:
    """Write labels on axes. To be called last: it lays out the page and goes by where all else then lies."""
    figure.draw_without_rendering()
    for axes, some in labels.items():
        panel = _Panel(axes, some, size)
        for label in [*some, *some]:  # twice, so that the first make way for the last
            panel.place(label)
        panel.write(size)


class _Panel:
    """What lies where in axes, in pixels: words, points, and lines as the dots that they are made of."""

    def __init__(self, axes: "Axes", labels: Sequence[Label], size: float) -> None:
        figure: Any = axes.figure
        self.axes, self.pixels = axes, figure.dpi / 72
        self.texts = [text.get_window_extent() for text in (*axes.texts, axes.title) if text.get_text()]
        self.dots = np.concatenate([np.empty((0, 2)), *_drawn(axes)])
        self.points = [self.point(label) for label in labels]
        self.extents = {label: self.extent(label, size) for label in labels}
        self.placed: dict[Label, tuple[float, float]] = {}

    def point(self, label: Label) -> Any:
        return self.axes.transData.transform((label.x, label.y))

    def place(self, label: Label) -> None:
        """Find the place of least cost for a label, where the others are by now."""
        self.placed.pop(label, None)
        others = [(self.point(other), far, self.box(other, far)) for other, far in self.placed.items()]
        self.words = [*self.texts, *(box for *_, box in others)]
        self.leads = [_line(box, point) for point, far, box in others if hypot(*far) > FAR]
        least, best = inf, PLACES[0]
        for place in PLACES:
            if least <= hypot(*place) / AWAY:
                break  # no place so far away costs less
            if (cost := self.cost(label, place)) < least:
                least, best = cost, place
        self.placed[label] = best

    def write(self, size: float) -> None:
        """Write the labels where they were placed."""
        for label, place in self.placed.items():
            lead = {"arrowstyle": "-", "lw": 0.6, "color": label.colour, "shrinkB": 3}
            self.axes.annotate(
                label.words,
                (label.x, label.y),
                xytext=place,
                textcoords="offset points",
                ha="center" if not place[0] else "left" if place[0] > 0 else "right",
                va="center" if not place[1] else "bottom" if place[1] > 0 else "top",
                color=label.colour,
                size=size,
                arrowprops=lead if hypot(*place) > FAR else None,
                in_layout=False,
            )

    def extent(self, label: Label, size: float) -> Any:
        """The width and height of the words."""
        text = self.axes.text(label.x, label.y, label.words, size=size)
        box = text.get_window_extent()
        text.remove()
        return box.size

    def box(self, label: Label, place: tuple[float, float]) -> "Bbox":
        """The room that words take at a place, with some to spare."""
        from matplotlib.transforms import Bbox

        extent = self.extents[label]
        corner = self.point(label) + np.multiply(place, self.pixels) + (np.sign(place) - 1) * extent / 2
        return Bbox.from_bounds(*corner, *extent).padded(SPARE)

    def cost(self, label: Label, place: tuple[float, float]) -> float:
        """What is wrong with a place for a label."""
        from matplotlib.transforms import Bbox

        point, box, inside = self.point(label), self.box(label, place), self.axes.bbox
        unreadable = sum(map(box.overlaps, self.words))
        unreadable += not (inside.contains(*box.min) and inside.contains(*box.max))
        cost = UNREADABLE * unreadable + _within(self.dots, box).sum() + hypot(*place) / AWAY
        cost += CROSSED * sum(_within(lead, box).any() for lead in self.leads)
        if hypot(*place) > FAR:
            line = _line(box, point)
            cost += CROSSED * sum(_within(line, words).any() for words in self.words)
            cost += CROSSED * sum(_cross(line, lead) for lead in self.leads)
            near = self.dots[_within(self.dots, Bbox([line.min(axis=0), line.max(axis=0)]).padded(SPARE))]
            cost += (np.hypot(*(near[:, None] - line).T) < SPARE).any(axis=0).sum()
        else:
            own, *all_ = (hypot(*(one - one.clip(box.min, box.max))) for one in (point, *self.points))
            cost += AMBIGUOUS * (sum(off <= own + SPARE for off in all_) > 1)
        return float(cost)


def _within(dots: Any, box: "Bbox") -> Any:
    """Which of some dots lie in a box."""
    return ((box.min < dots) & (dots < box.max)).all(axis=1)


def _line(box: "Bbox", point: Any) -> Any:
    """The dots of the line from a box to just before a point."""
    start = point.clip(box.min, box.max)
    return np.linspace(start, point + CLEAR * (start - point) / max(np.hypot(*(start - point)), CLEAR), 40)


def _cross(one: Any, other: Any) -> bool:
    """Whether two straight lines of dots cross."""

    def sides(line: Any, dots: Any) -> Any:
        (x, y), (dx, dy) = (dots - line[0]).T, line[-1] - line[0]
        return np.sign(dx * y - dy * x)

    return bool(sides(one, other[[0, -1]]).prod() < 0 > sides(other, one[[0, -1]]).prod())


def _drawn(axes: "Axes") -> Iterator[Any]:
    """The dots of the lines, error bars and markers that are drawn."""
    for bars in axes.collections:
        for corners in getattr(bars, "get_segments", list)():
            yield _along(bars.get_transform().transform(corners))
    for line in axes.lines:
        corners = line.get_transform().transform(np.column_stack([line.get_xdata(), line.get_ydata()]))
        if line.get_marker() not in NONE:
            figure: Any = axes.figure
            edges = np.array([[1, 0], [-1, 0], [0, 1], [0, -1], [0, 0]])
            edges = edges * line.get_markersize() / 2 * figure.dpi / 72
            yield (corners[np.isfinite(corners).all(axis=1), None] + edges).reshape(-1, 2)
        if line.get_linestyle() not in NONE:
            yield _along(corners)


NONE = ("", " ", "None", None)
"""What matplotlib calls a line or a marker that is not drawn."""


def _along(corners: Any) -> Any:
    """A dot every 3 pixels along a line, but not over its gaps."""
    there = np.isfinite(corners).all(axis=1)
    if there.sum() < 2:
        return corners[there]
    steps = np.where(there[:-1] & there[1:], np.hypot(*np.diff(corners, axis=0).T), 0)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    places = np.arange(0.0, along[-1] + 3, 3)
    return np.column_stack([np.interp(places, along[there], corners[there, i]) for i in (0, 1)])
