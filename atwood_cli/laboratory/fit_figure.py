"""Runs and the line that fits them, as a picture, with residuals below."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..model import physics
from ..output.figure import BLUE, FAINT, INK, RED, page, typeset, write_beside
from .estimate import Data, accelerations, as_data, expected
from .fitting import RARE, Fitted
from .report import conditions, verdict
from .results import QUANTITIES, published, rounded
from .runs import Column

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MOST_NAMED = 40  # runs; of more, only outliers and those left out


class View(NamedTuple):
    """Runs as points of a straight line, of which fitted quantities are the slope and the intercept."""

    x: Column
    y: Column
    slope: float
    intercept: float
    labels: tuple[str, str]
    meaning: Mapping[str, str]


def view(data: Data, a: Column, values: Mapping[str, float], names: Sequence[str]) -> View:
    """Return runs with accelerations in the axes that suit the fitted quantities: T_h - T_l = c a + f."""
    sum_, difference = data.l + data.h, data.h - data.l
    g, c, f = (values[name] for name in ("gravity", "rim_mass", "axle"))
    if "gravity" not in names:
        y: Any = physics.difference_of_moving_masses(data.l, data.h, a, np.float64(g))
        labels = "acceleration a (m/s²)", "difference of tensions Tₕ − Tₗ (N)"
        return View(a, y, c, f, labels, {"rim_mass": "slope c", "axle": "intercept f_axle"})
    if {*names} == {"rim_mass", "gravity"}:
        labels = "(mₕ − mₗ)/a (kg s²/m)", "mₕ + mₗ + f_axle/a (kg)"
        meaning = {"gravity": "slope g", "rim_mass": "intercept −c, with c", "axle": "with f_axle"}
        return View(difference / a, sum_ + f / a, g, -c, labels, meaning)
    added, plus, intercept = (0.0, "", "intercept −f_axle, ") if "axle" in names else (f, " + f_axle", "")
    labels = "difference of masses mₕ − mₗ (kg)", f"(mₕ + mₗ + c) a{plus} (N)"
    meaning = {"gravity": "slope g", "rim_mass": "with c", "axle": f"{intercept}with f_axle"}
    return View(difference, (sum_ + c) * a + added, g, added - f, labels, meaning)


def save(fit: Fitted, bare: bool, path: str, force: bool) -> None:
    """Draw runs and their line to a file, below sentences unless it is bare. Raises OSError."""
    best, data, delay = fit.whole, fit.whole.data, fit.whole.values["delay"]
    a = accelerations(data, data.measured, delay)
    u_a = best.sigma if data.drop is None else 2 * best.sigma * a / (data.measured - delay)
    seen, shifted = (view(data, there, best.values, best.names) for there in (a, a + u_a))
    u_x, u_y = abs(shifted.x - seen.x), abs(shifted.y - seen.y)
    above = [conditions(fit), verdict(fit)]
    if (p := fit.whole.p_value) is not None and p < RARE and not fit.outliers:
        above.append(f"Scatter is larger than the uncertainties, p = {rounded(p)}.")
    bars_are = "widened to the scatter between runs" if fit.whole.between_runs else "not widened"
    if fit.whole.chi2 is None:
        bars_are = "by the scatter of the runs"
    delayed = " The fitted delay is subtracted from the times." if "delay" in best.names else ""
    below = f"Error bars are standard uncertainties, {bars_are}. Points are numbered as rows.{delayed}"
    with page(path, force, above, below, bare, panels=2) as figure:
        line, rest = figure.subplots(2, 1, sharex=True, height_ratios=[2.4, 1])
        end = 1.06 * max(seen.x + u_x)
        line.plot([0, end], [seen.intercept, seen.intercept + seen.slope * end], color=BLUE)
        bars: Any = {"fmt": "o", "ms": 4, "capsize": 2, "lw": 1, "color": INK}
        line.errorbar(seen.x, seen.y, yerr=u_y, xerr=u_x if u_x.any() else None, **bars)
        residual = (data.measured - expected(data, best.values)) / best.sigma
        rest.axhline(0, color=BLUE)
        for level in (-2, 2):
            rest.axhline(level, color=FAINT, lw=0.8, ls="--")
        rest.plot(seen.x, residual, "o", ms=4, color=INK)
        odd = np.isin(np.flatnonzero(fit.used), fit.suspects)
        for axes, heights in ((line, seen.y), (rest, residual)):
            axes.plot(seen.x[odd], heights[odd], "o", ms=9, mfc="none", color=RED)
        line.set_xlim(1.06 * min(0.0, min(seen.x - u_x)), end)
        low, high = min(*(seen.y - u_y), seen.intercept, 0.0), max(*(seen.y + u_y), seen.intercept, 0.0)
        line.set_ylim(low - 0.05 * (high - low) if low < 0 else 0, high + 0.3 * (high - low))
        rest.set_ylim(-max(3, 1.15 * -min(residual)), max(3, 1.15 * max(residual)))
        line.text(0.03, 0.97, coefficients(fit, seen.meaning), transform=line.transAxes, va="top", color=BLUE)
        line.set_ylabel(seen.labels[1])
        rest.set_ylabel("residual/u")
        rest.set_xlabel(seen.labels[0])
        _name_points(line, fit)


def _name_points(line: "Axes", fit: Fitted) -> None:
    """Write the numbers of rows at the points, and mark runs that are left out, at the edge if outside."""
    data, best = as_data(fit.runs, fit.shown), fit.whole
    there = view(data, accelerations(data, data.measured, best.values["delay"]), best.values, best.names)
    x, y = np.clip(there.x, *line.get_xlim()), np.clip(there.y, *line.get_ylim())
    out = ~fit.used[fit.shown]
    if out.any():
        line.plot(x[out], y[out], "o", ms=4, mfc="none", color=INK, clip_on=False)
    labels = []
    for i, run in enumerate(np.flatnonzero(fit.shown).tolist()):
        if out[i] or len(out) <= MOST_NAMED or run in fit.suspects:
            rows = ",".join(map(str, fit.runs.rows[run]))
            labels.append((x[i], y[i], f"{rows}, left out" if out[i] else rows, INK))
    write_beside(line, labels)


def coefficients(fit: Fitted, meaning: Mapping[str, str]) -> str:
    """Return the slope and the intercept of the line."""
    lines = []
    for name, words in meaning.items():
        value, unit = fit.whole.values[name], QUANTITIES[name].unit
        if result := fit.whole.results.get(name):
            lines.append(f"{words} = {published(value, result.uncertainty)[0]} {unit}")
        else:
            why = "given" if name in fit.given.values else "not fitted"
            lines.append(f"{words} = {rounded(value, 6)} {unit}, {why}")
    return typeset("\n".join(lines))
