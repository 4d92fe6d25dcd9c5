"""Runs and their line as a picture."""

from typing import TYPE_CHECKING, Any

from .figure import BLUE, GREY, INK, RED, check_file, page
from .labels import Label, write_labels
from .text import wrapped

if TYPE_CHECKING:
    from ..laboratory.fitting import Fitted

TITLE_WIDTH = 130  # characters: more do not fit the page
NAMED = 60  # runs: of more, none is named


def save(fit: "Fitted", head: str | None, path: str, force: bool) -> None:
    """Draw runs and their line to a file, whose suffix is its format, below sentences if there is a head.

    Raises SceneError, OSError.
    """
    import numpy as np

    from ..laboratory.results import left_out, points
    from ..laboratory.sentences import coefficients, verdict

    check_file(path, force)
    at, (out, x_out, y_out) = points(fit), left_out(fit)
    with page(path, force) as figure:
        line, rest = figure.subplots(2, 1, sharex=True, height_ratios=[3, 1])
        end = 1.06 * float(max(*(at.x + at.u_x), *x_out))
        line.plot([0, end], [at.intercept, at.intercept + at.slope * end], color=BLUE, lw=1.5)
        bars: Any = {"fmt": "o", "ms": 5, "capsize": 3, "lw": 1.2, "color": INK}
        line.errorbar(at.x, at.y, yerr=at.u_y, xerr=at.u_x, **bars)
        rest.axhline(0, color=BLUE, lw=1.5)
        rest.errorbar(at.x, at.residual, yerr=at.u_residual, **bars)
        odd = sorted(fit.odd.runs)
        for axes, y in ((line, at.y), (rest, at.residual)):
            axes.plot(at.x[odd], y[odd], "o", ms=11, mfc="none", color=RED)
        line.plot(x_out, y_out, "o", ms=5, mfc="none", color=INK)
        words = "\n".join(coefficients(fit))
        line.text(0.03, 0.95, words, transform=line.transAxes, va="top", color=BLUE)
        line.set_ylabel("tension of the heavier side less that\nof the lighter, $T_h - T_l$  (N)")
        rest.set_ylabel("residual (N)")
        rest.set_xlabel("acceleration $a$ (m/s²)")
        line.set_xlim(1.06 * min(0.0, float(min(at.x - at.u_x))), end)
        ends = np.concatenate([at.y - at.u_y, at.y + at.u_y, y_out, [at.intercept, 0.0]])
        low, high = float(min(ends)), float(max(ends))
        line.set_ylim(low - 0.05 * (high - low) * (low < 0), high + 0.25 * (high - low))
        for axes in (line, rest):
            axes.spines[["top", "right"]].set_visible(False)
        if head is not None:
            figure.suptitle("\n".join([head, *wrapped(verdict(fit), TITLE_WIDTH)]), fontsize=10)
        named = [*zip(fit.used, at.x, at.y, strict=True)] * (len(fit.used) <= NAMED)
        named += zip(out, x_out, y_out, strict=True)
        rows = [(run.name + ", left out" * run.left_out, float(x), float(y)) for run, x, y in named]
        write_labels(figure, {line: [Label(*row, GREY) for row in rows]})
