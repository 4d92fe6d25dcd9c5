"""Runs and the line T_h - T_l = c a + f that fits them, as a picture, with residuals below."""

from typing import TYPE_CHECKING, Any

import numpy as np

from ..model import physics
from ..output.figure import BLUE, FAINT, INK, RED, check_file, page, typeset, write_beside
from .estimate import Data, accelerations, as_data, expected
from .fitting import Fitted
from .report import conditions, verdict
from .results import QUANTITIES, rounded, with_u
from .statistics import Column

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MOST_NAMED = 40  # runs; of more, only outliers and those left out
MEANING = {"rim_mass": "slope c", "axle": "intercept f_axle", "gravity": "with g", "delay": "with Δt"}
BELOW = "Error bars are standard uncertainties, with the scatter between runs. Numbers are those of rows."


def points(fit: Fitted, data: Data) -> tuple[Column, Column]:
    """Return the accelerations of runs (m/s²), and the differences of their tensions (N)."""
    values = fit.whole.best.values
    a = accelerations(data, data.measured, values["delay"])
    return a, physics.difference_of_moving_masses(data.l, data.h, a, np.float64(values["gravity"]))


def save(fit: Fitted, bare: bool, path: str, force: bool) -> None:
    """Draw runs and their line to a file, whose suffix is its format, below sentences unless it is bare.

    Raises SceneError, OSError.
    """
    check_file(path, force)
    best, data = fit.whole.best, fit.whole.best.data
    c, f, delay = (best.values[name] for name in ("rim_mass", "axle", "delay"))
    x, y = points(fit, data)
    u_x = best.sigma if data.drop is None else 2 * best.sigma * x / (data.measured - delay)
    u_y = u_x * (data.l + data.h)
    with page(path, force, [conditions(fit), verdict(fit)], BELOW, bare, panels=2) as figure:
        line, rest = figure.subplots(2, 1, sharex=True, height_ratios=[2.4, 1])
        end = 1.06 * max(x + u_x)
        line.plot([0, end], [f, f + c * end], color=BLUE)
        line.errorbar(x, y, yerr=u_y, xerr=u_x, fmt="o", ms=4, capsize=2, lw=1, color=INK)
        residual = (data.measured - expected(data, best.values)) / best.sigma
        rest.axhline(0, color=BLUE)
        for level in (-2, 2):
            rest.axhline(level, color=FAINT, lw=0.8, ls="--")
        rest.plot(x, residual, "o", ms=4, color=INK)
        for axes, heights in ((line, y), (rest, residual)):
            axes.plot(x[fit.suspects], heights[fit.suspects], "o", ms=9, mfc="none", color=RED)
        line.set_xlim(1.06 * min(0.0, min(x - u_x)), end)
        low, high = min(*(y - u_y), f, 0.0), max(*(y + u_y), f, 0.0)
        line.set_ylim(low - 0.05 * (high - low) if low < 0 else 0, high + 0.3 * (high - low))
        rest.set_ylim(-max(3, 1.15 * -min(residual)), max(3, 1.15 * max(residual)))
        line.text(0.03, 0.97, coefficients(fit), transform=line.transAxes, va="top", color=BLUE)
        line.set_ylabel("difference of tensions Tₕ − Tₗ (N)")
        rest.set_ylabel("residual/u")
        rest.set_xlabel("acceleration a (m/s²)")
        _name_points(line, fit, x, y)


def _name_points(line: "Axes", fit: Fitted, x: Column, y: Column) -> None:
    """Write the numbers of rows at the points, and mark runs that are left out, at the edge if outside."""
    named = fit.suspects if len(fit.used) > MOST_NAMED else range(len(fit.used))
    labels = [(x[i], y[i], ",".join(map(str, fit.used[i].rows)), INK) for i in named]
    if left_out := fit.left_out:
        there: Any = points(fit, as_data(fit.runs, left_out))
        x, y = np.clip(there[0], *line.get_xlim()), np.clip(there[1], *line.get_ylim())
        line.plot(x, y, "o", ms=4, mfc="none", color=INK, clip_on=False)
        rows = [",".join(map(str, run.rows)) + ", left out" for run in left_out]
        labels += zip(x, y, rows, [INK] * len(rows), strict=True)
    write_beside(line, labels)


def coefficients(fit: Fitted) -> str:
    """Return the slope and the intercept of the line, and what else is fitted, if that is a result."""
    lines = []
    if fit.whole.reason:
        return ""
    for name, words in MEANING.items():
        value, unit = fit.whole.best.values[name], QUANTITIES[name].unit
        if result := fit.whole.results.get(name):
            lines.append(f"{words} = {with_u(value, result.uncertainty)} {unit}")
        elif name in ("rim_mass", "axle"):
            lines.append(f"{words} = {rounded(value, 6)} {unit}, given")
    return typeset("\n".join(lines))
