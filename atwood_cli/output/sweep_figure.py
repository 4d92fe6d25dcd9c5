"""The curves of a sweep as a picture."""

from math import isnan, nan
from typing import TYPE_CHECKING

from .figure import BLUE, GREEN, INK, ORANGE, PURPLE, RED, check_file, page, say_above
from .labels import Label, write_labels

if TYPE_CHECKING:
    from .curves import Picture

COLOURS = (BLUE, RED, GREEN, PURPLE, ORANGE, INK)
LINES = ("-", "--", "-.", (0, (5, 1, 1, 1, 1, 1)), (0, (1, 1)), (0, (8, 2)))


def save(picture: "Picture", caption: str, path: str, force: bool) -> None:
    """Draw the curves of a sweep to a file, whose suffix is its format. Raises SceneError, OSError."""
    check_file(path, force)
    with page(path, force) as figure:
        axes = figure.subplots()
        axes.set_xlabel(picture.x)
        axes.set_ylabel(picture.y)
        axes.set_xscale("log" if picture.log else "linear")
        axes.spines[["top", "right"]].set_visible(False)
        axes.margins(y=0.1)
        labels = []
        for curve, colour, style in zip(picture.curves, COLOURS, LINES, strict=False):
            ys, least, most = ([nan if y is None else y for y in line] for line in curve.lines)
            axes.plot(curve.xs, ys, color=colour, ls=style, lw=1.8)
            axes.fill_between(curve.xs, least, most, color=colour, alpha=0.18, lw=0)
            for edge in (least, most):
                axes.plot(curve.xs, edge, color=colour, ls=style, lw=0.8)
            there = [
                (x, y) for x, *both in zip(curve.xs, ys, most, strict=True) for y in both if not isnan(y)
            ]
            if curve.symbols and there:
                labels.append(Label(curve.symbols, *there[-1], colour))
        bottom, _ = axes.get_ylim()
        if min(y for curve in picture.curves for line in curve.lines for y in line if y is not None) >= 0:
            bottom = max(bottom, 0.0)
        for curve, colour in zip(picture.curves, COLOURS, strict=False):
            for x, height, words in curve.marks:
                y = bottom if height is None else height
                axes.plot([x, x], [bottom, y], color=colour, lw=0.8, ls=":")
                axes.plot([x], [y], "o", color=colour, ms=4)
                labels.append(Label(words, x, y, colour))
        axes.set_ylim(bottom=bottom)
        xs = picture.curves[0].xs
        if min(xs) < max(xs):
            axes.set_xlim(min(xs), max(xs))  # where the curve has gaps, too
        say_above(figure, caption)
        write_labels(figure, {axes: labels}, 10)
