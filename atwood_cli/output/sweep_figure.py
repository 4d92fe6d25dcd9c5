"""The curves of a sweep as a picture."""

from math import isnan, nan
from typing import TYPE_CHECKING

from .curves import EMPTY_X, EMPTY_Y, axis_ends, with_break
from .figure import BLUE, GREEN, INK, ORANGE, PURPLE, RED, check_file, page, say_above
from .labels import Label, write_labels

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .curves import Panel, Picture

COLOURS = (BLUE, RED, GREEN, PURPLE, ORANGE, INK)
LINES = ("-", "--", "-.", (0, (5, 1, 1, 1, 1, 1)), (0, (1, 1)), (0, (8, 2)))

MARGIN = 0.1  # of the height, above and below the curves
PANEL = 3.5  # inches, for each pair of axes more


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
    axes.set_ylabel(with_break(panel.y, low, axes.get_ylim()[1]))
    bottom, _ = axes.get_ylim()
    labels, ends = [], dict[tuple[float, float], dict[str, str]]()
    for curve in panel.curves:
        colour, style = COLOURS[curve.colour], LINES[curve.style]
        ys, least, most = ([nan if y is None else y for y in line] for line in curve.lines)
        axes.plot(curve.xs, ys, color=colour, ls=style, lw=1.8)
        axes.fill_between(curve.xs, least, most, color=colour, alpha=0.18, lw=0)
        for edge in (least, most):
            axes.plot(curve.xs, edge, color=colour, ls=style, lw=0.8)
        there = [(x, y) for x, *both in zip(curve.xs, ys, most, strict=True) for y in both if not isnan(y)]
        if curve.symbols and there:
            ends.setdefault(there[-1], {})[curve.symbols] = colour
        for x, height, words in curve.marks:
            y = bottom if height is None else height
            axes.plot([x, x], [bottom, y], color=colour, lw=0.8, ls=":")
            axes.plot([x], [y], "o", color=colour, ms=4)
            if words:
                labels.append(Label(words, x, y, colour))
    for (x, y), names in ends.items():  # curves that end at one point share a label
        colour, *others = names.values()
        labels.append(Label("; ".join(names), x, y, INK if others else colour))
    return labels
