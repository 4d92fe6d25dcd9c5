"""Pictures in files, for a slide: needs matplotlib (extra ``figure``); the modules beside it draw them.

No pyplot, no display; the same scene gives the same SVG to the byte.
"""

import os
import sys
import warnings
from collections.abc import Iterator, Sequence
from contextlib import chdir, contextmanager
from importlib import import_module
from importlib.util import find_spec
from io import BytesIO
from itertools import product
from operator import itemgetter
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from ..files import check_free, is_stdout, written_beside
from ..model.scene import SceneError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.transforms import Bbox

FORMATS = (".svg", ".png", ".pdf")
BLUE, RED, GREEN, PURPLE, ORANGE, SKY = "#0072b2", "#d55e00", "#009e73", "#b05d91", "#b07800", "#3f8fc0"
"""Told apart without seeing red or green, and on paper: after M. Okabe and K. Ito, Color universal design."""
INK, GREY, FAINT = "#222222", "#777777", "#999999"
MARKED = 60  # points: of more, only the line is drawn
STYLE: Any = {
    "svg.hashsalt": "atwood",  # else the SVG's ids are random
    "font.family": "DejaVu Sans",
    "mathtext.fontset": "dejavusans",
    "font.size": 11,
}


def check_file(path: str, force: bool) -> None:
    """Raises in time: SceneError where the suffix is no format, ImportError, or OSError if it exists."""
    if Path(path).suffix.lower() not in FORMATS:
        raise SceneError("figure", path, f"must end in one of {', '.join(FORMATS)}")
    if is_stdout(path):
        raise SceneError("figure", path, "is where standard output goes; name another")
    _load()
    check_free(Path(path), force)


def _load() -> None:
    """Import matplotlib without any settings but its own: neither the user's nor those of the folder.

    It takes those of the folder it is in first; in its own, these are as it came. Raises ImportError.
    """
    spec = find_spec("matplotlib")
    if "matplotlib" not in sys.modules and spec and spec.origin:
        os.environ.pop("MPLBACKEND", None)
        with warnings.catch_warnings(action="ignore"), chdir(Path(spec.origin).with_name("mpl-data")):
            import_module("matplotlib")
    import_module("matplotlib").set_loglevel("error")


@contextmanager
def page(path: str, force: bool) -> Iterator["Figure"]:
    """A figure to draw on, which is then saved."""
    _load()
    from matplotlib import rc_context, rcParamsDefault
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    kind = Path(path).suffix[1:].lower()
    drawn = BytesIO()  # a full disk is none of matplotlib's business
    with written_beside(Path(path), force) as beside:
        with warnings.catch_warnings(action="ignore"), rc_context({**rcParamsDefault, **STYLE}):
            figure = Figure(figsize=(11, 6), layout="constrained")
            FigureCanvasAgg(figure)  # which knows how wide words are
            yield figure
            figure.savefig(drawn, format=kind, dpi=200, metadata={"Date": None} if kind == "svg" else None)
        beside.write_bytes(drawn.getbuffer())


class Label(NamedTuple):
    """Words that belong to a point of a picture."""

    words: str
    x: float
    y: float
    colour: str = INK


SIDES = (("left", 1), ("right", -1), ("center", 0)), (("bottom", 1), ("top", -1), ("center", 0))
DISTANCES, WIDTHS = (6, 15, 27, 42, 60, 80, 110, 150), (1, 2, 3)  # points, and times as far to the side
AWAY = 30  # points that weigh as much as a covered dot
FAR = 20  # points: from there on a thin line leads to the point
SPARE = 2  # pixels around words


def write_labels(axes: "Axes", labels: Sequence[Label], size: float = 9) -> None:
    """Write words beside their points, where they cover no line, no point and no other words.

    To be called when all else is drawn: it goes by where that stands on the page.
    """
    import numpy as np
    from matplotlib.text import Text

    figure: Any = axes.figure
    figure.draw_without_rendering()  # which decides where the axes lie
    renderer = figure.canvas.get_renderer()
    taken = [Text.get_window_extent(text, renderer) for text in axes.texts]
    if (legend := axes.get_legend()) is not None:
        taken.append(legend.get_window_extent(renderer))
    bars = [(bar, line) for bar in axes.collections for line in getattr(bar, "get_segments", list)()]
    lines = [(line, np.column_stack([line.get_xdata(), line.get_ydata()])) for line in axes.lines]
    drawn = (one.get_transform().transform(points) for one, points in [*lines, *bars])
    dots = np.concatenate([np.empty((0, 2)), *map(_dots, drawn)])

    def place(label: Label, far: float, side: tuple[str, int], height: tuple[str, int], wide: int) -> Any:
        """The words there, the room they take, the line that leads to their point, and what that covers."""
        leads = {"arrowstyle": "-", "lw": 0.6, "color": label.colour, "shrinkB": 3} if far > FAR else None
        note = axes.annotate(
            label.words,
            (label.x, label.y),
            xytext=(side[1] * far * wide, height[1] * far),
            textcoords="offset points",
            ha=side[0],
            va=height[0],
            color=label.colour,
            size=size,
            arrowprops=leads,
            in_layout=False,
        )
        note.update_positions(renderer)
        box = Text.get_window_extent(note, renderer).padded(SPARE)  # without the line to the point
        ends = axes.transData.transform((label.x, label.y)), np.mean([box.min, box.max], axis=0)
        line = np.linspace(*ends, 60 if leads else 0)
        beyond = not (axes.bbox.contains(*box.min) and axes.bbox.contains(*box.max))
        crossed = sum(_inside(line, other).any() for other in taken)
        unreadable = beyond + sum(map(box.overlaps, taken))
        cost = 1000 * unreadable + 20 * crossed + _inside(dots, box).sum() + far * wide / AWAY
        return cost, note, box, line

    for label in labels:
        best = None
        for far, side, height, wide in product(DISTANCES, *SIDES, WIDTHS):
            if side[1] or height[1]:
                here = place(label, far, side, height, wide)
                best, *worse = sorted([best or here, here][best is None :], key=itemgetter(0))
                for other in worse:
                    other[1].remove()
                if best[0] <= far / AWAY:  # as no place farther away is better
                    break
        if best is not None:
            taken.append(best[2])
            dots = np.concatenate([dots, best[3]])


def _inside(dots: Any, box: "Bbox") -> Any:
    """Which of some points of the page lie in a box."""
    return ((box.min < dots) & (dots < box.max)).all(axis=1)


def _dots(corners: Any) -> Any:
    """Where a line runs on the page, a point every few pixels."""
    import numpy as np

    corners = corners[np.isfinite(corners).all(axis=1)]
    if len(corners) < 2:
        return corners
    steps = np.hypot(*np.diff(corners, axis=0).T)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    places = np.arange(0.0, along[-1] + 3, 3)
    return np.column_stack([np.interp(places, along, corners[:, i]) for i in (0, 1)])
