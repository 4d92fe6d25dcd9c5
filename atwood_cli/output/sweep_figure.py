"""The curves of a sweep as a picture."""

from collections.abc import Sequence
from math import isnan, nan
from operator import attrgetter
from typing import TYPE_CHECKING, Literal

from .curves import EMPTY_X, EMPTY_Y, axis_ends, with_break
from .figure import BLUE, GREEN, INK, ORANGE, PURPLE, RED, check_file, page, say_above
from .labels import Label, write_labels
from .text import wrapped

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .curves import Panel, Picture

COLOURS = (BLUE, RED, GREEN, PURPLE, ORANGE, INK)
LINES = ("-", "--", "-.", (0, (5, 1, 1, 1, 1, 1)), (0, (1, 1)), (0, (8, 2)))

MARGIN = 0.1  # of the height, above and below the curves
POWERS = (-3, 5)  # of ten: beyond, numbers on axes have a power of ten behind them
MOST_MARKS = 6  # more words would lie across each other, and the table has the numbers
BESIDE = 1.02  # of the axes' width: where the names of curves stand
LEAD = {"arrowstyle": "-", "lw": 0.6, "relpos": (0, 0.5), "shrinkA": 0, "shrinkB": 0}
SIZE, LINE = 10, 1.5  # of words, in points, and from one line to the next as a multiple of it
PANEL = 3.5  # inches, for each pair of axes more
AXES_SHARE = 0.75  # of the height, about
DOTS = "At a dot the string begins to slip, or to hold."
TITLE = 40  # characters: more do not fit beside an axis


def save(picture: "Picture", caption: str, path: str, force: bool) -> None:
    """Draw the curves of a sweep to a file, below a caption if there is one. Raises SceneError, OSError."""
    check_file(path, force)
    with page(path, force) as figure:
        if more := len(picture.panels) - 1:
            figure.set_figheight(figure.get_figheight() + more * PANEL)
        panels = figure.subplots(len(picture.panels), 1, sharex=True, squeeze=False)[:, 0]
        low, high = axis_ends(picture.xs, 0 if picture.log else EMPTY_X)
        panels[-1].set_xlabel(picture.x if picture.log else with_break(picture.x, low, high))
        labels = {}
        for axes, panel in zip(panels, picture.panels, strict=True):
            axes.set_xscale("log" if picture.log else "linear")
            if low < high:
                axes.set_xlim(low, high)  # where the curve has gaps, too
            axes.spines[["top", "right"]].set_visible(False)
            axis: Literal["y", "both"] = "y" if picture.log else "both"
            axes.ticklabel_format(axis=axis, scilimits=POWERS, useMathText=True)
            labels[axes] = _draw(axes, panel, AXES_SHARE * figure.get_figheight() / len(panels))
        if caption:
            dots = any(curve.marks for curve in picture.panels[0].curves) and not labels[panels[0]]
            say_above(figure, caption, *[DOTS] * dots)
        write_labels(figure, labels, SIZE)


def _draw(axes: "Axes", panel: "Panel", inches: float) -> list[Label]:
    """Draw the curves on one pair of axes, about so high; words still to be written."""
    low, high = axis_ends(panel.ys, EMPTY_Y)
    room = MARGIN * (high - low)
    axes.set_ylim(low - room * (low != 0), (high + room * (high != 0)) or 1)
    if low > 0:
        low = max(tick for tick in axes.get_yticks() if tick <= low)
        axes.set_ylim(bottom=low)
    axes.set_ylabel("\n".join(wrapped(with_break(panel.y, low, axes.get_ylim()[1]), TITLE)))
    bottom, _ = axes.get_ylim()
    labels: list[Label] = []
    ends: list[Label] = []
    for curve in panel.curves:
        colour, style = COLOURS[curve.colour], LINES[curve.style]
        ys, least, most = ([nan if y is None else y for y in line] for line in curve.lines)
        axes.plot(curve.xs, ys, color=colour, ls=style, lw=1.8)
        axes.fill_between(curve.xs, least, most, color=colour, alpha=0.18, lw=0)
        for edge in (least, most):
            axes.plot(curve.xs, edge, color=colour, ls=style, lw=0.8)
        there = [(x, y) for x, *both in zip(curve.xs, ys, most, strict=True) for y in both if not isnan(y)]
        if curve.symbols and there:
            ends.append(Label(curve.symbols, *max(there), colour))
        for x, height, words in curve.marks:
            y = bottom if height is None else height
            axes.plot([x, x], [bottom, y], color=colour, lw=0.8, ls=":")
            axes.plot([x], [y], "o", color=colour, ms=4)
            if words:
                labels.append(Label(words, x, y, colour))
    _name_ends(axes, ends, inches)
    return labels if len(labels) <= MOST_MARKS else []


def _name_ends(axes: "Axes", ends: Sequence[Label], inches: float) -> None:
    """Name curves beside the axes, at the heights of their ends or as near as the words have room."""
    low, high = axes.get_ylim()
    ends = sorted(ends, key=attrgetter("y"))
    heights = [(end.y - low) / (high - low) for end in ends]
    room = LINE * SIZE / (72 * inches)
    up, down = heights[:1], heights[-1:]
    for one, other in zip(heights[1:], heights[-2::-1], strict=True):
        up.append(max(one, up[-1] + room))
        down.append(min(other, down[-1] - room))
    # Both keep words apart, and so does what lies between; the lowest stays above the numbers of the x axis.
    places = [(one + other) / 2 for one, other in zip(up, reversed(down), strict=True)]
    lift = max(0, room / 2 - min(places, default=0))
    for end, place in zip(ends, places, strict=True):
        axes.annotate(
            end.words,
            (end.x, end.y),
            xytext=(BESIDE, place + lift),
            textcoords="axes fraction",
            va="center",
            color=end.colour,
            size=SIZE,
            arrowprops={**LEAD, "color": end.colour},
        )
