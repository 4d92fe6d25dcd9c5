"""Runs and their line as a picture."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ..model import physics
from ..output.figure import BLUE, INK, RED, check_file, page, say_above
from .estimate import Data, accelerations, as_data, uncertain_accelerations
from .fitting import Fitted
from .report import conditions, verdict
from .results import QUANTITIES, USUAL, with_u
from .statistics import Column

if TYPE_CHECKING:
    from matplotlib.axes import Axes

NAMED = 40
"""Runs: of more, only those that are odd or left out are named."""
AXES = "tension of the heavier side less that\nof the lighter, $T_h - T_l$  (N)"


def save(fit: Fitted, bare: bool, path: str, force: bool) -> None:
    """Draw runs and their line to a file, whose suffix is its format, below sentences unless it is bare.

    Raises SceneError, OSError.
    """
    check_file(path, force)
    best = fit.whole.best
    c, f = (best.values[x] for x in ("rim_mass", "axle"))
    a, y = points(best.data, best.values)
    u_a = uncertain_accelerations(best)
    u_y, u_rest = (best.data.l + best.data.h) * u_a, (best.data.l + best.data.h + c) * u_a
    with page(path, force) as figure:
        line, rest = figure.subplots(2, 1, sharex=True, height_ratios=[3, 1])
        ends: Any = np.array([min(0.0, min(a - u_a)), max(a + u_a)]) * 1.06
        line.plot([0, ends[1]], [f, f + c * float(ends[1])], color=BLUE, lw=1.5)
        bars: Any = {"fmt": "o", "ms": 5, "capsize": 3, "lw": 1.2, "color": INK}
        line.errorbar(a, y, yerr=u_y, xerr=u_a, **bars)
        of_line: Any = physics.difference_of_a_pulley(np.float64(c), a, np.float64(f))
        residual = y - of_line
        rest.axhline(0, color=BLUE, lw=1.5)
        rest.errorbar(a, residual, yerr=u_rest, **bars)
        for axes, values in ((line, y), (rest, residual)):
            axes.plot(a[fit.odd], values[fit.odd], "o", ms=11, mfc="none", color=RED)
            axes.spines[["top", "right"]].set_visible(False)
        low, high = min(*(y - u_y), f, 0.0), max(*(y + u_y), f, 0.0)
        line.set_xlim(*ends)
        line.set_ylim(low - 0.05 * (high - low) * (low < 0), high + 0.25 * (high - low))
        _name_points(line, fit, a, y)
        line.text(0.03, 0.95, coefficients(fit), transform=line.transAxes, va="top", color=BLUE)
        line.set_ylabel(AXES)
        rest.set_ylabel("residual (N)")
        rest.set_xlabel("acceleration $a$ (m/s²); numbers are those of rows")
        if not bare:
            say_above(figure, conditions(fit), verdict(fit))


def _name_points(line: "Axes", fit: Fitted, a: Column, y: Column) -> None:
    """Write the numbers of rows at the points, and mark runs that are left out, at the edge if beyond it."""
    names = [(fit.used[i], a[i], y[i]) for i in (fit.odd if len(a) > NAMED else range(len(a)))]
    if out := fit.left_out:
        x_out, y_out = points(as_data(fit.runs, out), fit.whole.best.values)
        x_out, y_out = np.clip(x_out, *line.get_xlim()), np.clip(y_out, *line.get_ylim())
        line.plot(x_out, y_out, "o", ms=5, mfc="none", color=INK, clip_on=False)
        names += zip(out, x_out, y_out, strict=True)
    for run, x, height in names:
        words = ",".join(map(str, run.rows)) + ", left out" * run.left_out
        right = x > 0.9 * line.get_xlim()[1]
        side, by = ("right", -7) if right else ("left", 7)
        line.annotate(words, (x, height), (by, -12), textcoords="offset points", size=9, ha=side)


def points(data: Data, values: Mapping[str, float]) -> tuple[Column, Column]:
    """Runs as points (a, T_h - T_l) of a straight line."""
    a = accelerations(data, data.measured, values["delay"])
    y: Any = physics.difference_of_moving_masses(data.l, data.h, a, np.float64(values["gravity"]))
    return a, y


def coefficients(fit: Fitted) -> str:
    """The slope and the intercept of the line, if they are a result, with symbols as in LaTeX."""
    lines, labels = [], ("slope $c$", "intercept $f$")
    for name, label in () if fit.whole.reason else zip(USUAL, labels, strict=True):
        result = fit.whole.results.get(name)
        why = "" if result else ", given" if name in fit.given.values else ", not fitted"
        value = with_u(fit.whole.best.values[name], result and result.uncertainty)
        lines.append(f"{label} = {value} {QUANTITIES[name].unit}{why}")
    return "\n".join(lines)
