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
NEAR = 0.01  # of the height, between ends of curves that share a label
PANEL = 3.5  # inches, for each pair of axes more
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
            labels[axes] = _draw(axes, panel)
        if caption:
            say_above(figure, caption)
        write_labels(figure, labels, 10)


def _draw(axes: "Axes", panel: "Panel") -> list[Label]:
    """Draw the curves on one pair of axes; words still to be written."""
    low, high = axis_ends(panel.ys, EMPTY_Y)
    room = MARGIN * (high - low)
    axes.set_ylim(low - room * (low != 0), (high + room * (high != 0)) or 1)
    if low > 0:
        low = max(tick for tick in axes.get_yticks() if tick <= low)
        axes.set_ylim(bottom=low)
    axes.set_ylabel("\n".join(wrapped(with_break(panel.y, low, axes.get_ylim()[1]), TITLE)))
    bottom, _ = axes.get_ylim()
    labels: list[Label] = []
    ends: tuple[list[Label], list[Label]] = [], []  # the last points of curves, and the first
    for curve in panel.curves:
        colour, style = COLOURS[curve.colour], LINES[curve.style]
        ys, least, most = ([nan if y is None else y for y in line] for line in curve.lines)
        axes.plot(curve.xs, ys, color=colour, ls=style, lw=1.8)
        axes.fill_between(curve.xs, least, most, color=colour, alpha=0.18, lw=0)
        for edge in (least, most):
            axes.plot(curve.xs, edge, color=colour, ls=style, lw=0.8)
        there = [(x, y) for x, *both in zip(curve.xs, ys, most, strict=True) for y in both if not isnan(y)]
        if curve.symbols and there:
            for some, at in zip(ends, (there[-1], there[0]), strict=True):
                some.append(Label(curve.symbols, *at, colour))
        for x, height, words in curve.marks:
            y = bottom if height is None else height
            axes.plot([x, x], [bottom, y], color=colour, lw=0.8, ls=":")
            axes.plot([x], [y], "o", color=colour, ms=4)
            if words:
                labels.append(Label(words, x, y, colour))
    near = NEAR * (axes.get_ylim()[1] - bottom)
    return [*labels, *max((_merged(some, near) for some in ends), key=len)]  # where more lie apart


def _merged(labels: Sequence[Label], near: float) -> list[Label]:
    """The labels of the ends of curves, one for all that end as near to each other."""
    groups: list[list[Label]] = []
    for label in sorted(labels, key=attrgetter("x", "y")):
        last = groups[-1][-1] if groups else None
        if last and label.x == last.x and label.y - last.y <= near:
            groups[-1].append(label)
        else:
            groups.append([label])
    return [
        one._replace(
            words="\n".join(label.words for label in (one, *more)), colour=INK if more else one.colour
        )
        for one, *more in groups
    ]
