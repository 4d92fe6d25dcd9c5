"""Runs and the line that fits them, T_h - T_l = c a + f, as a picture, with residuals below."""

from typing import Any

import numpy as np

from ..output.figure import BLUE, FAINT, INK, RED, saved, typeset, write_beside
from ..output.forms import Picture
from ..solver import physics
from .estimate import Fitted, accelerations, data_of
from .report import conditions, verdict
from .results import equation

MOST_NAMED = 40  # runs; of more, only outliers and those left out
MEANING = {"rim_mass": "slope c", "axle": "intercept f", "gravity": "g", "delay": "Δt"}
"""The fitted quantities, as the picture shows them."""


def save(fit: Fitted, picture: Picture) -> None:
    """Draw runs and their line to a file. Raises OSError."""
    used, data = fit.used[fit.shown], data_of(fit.runs, fit.shown)
    g, c, f, delay = (fit.values[name] for name in ("gravity", "rim_mass", "axle", "delay"))
    a = accelerations(data, np.where(data.measured > delay, data.measured, np.nan), delay)
    difference: Any = physics.difference_of_moving_masses(data.l, data.h, a, np.float64(g))
    x, y = a[used], difference[used]
    u_x = fit.line.sigma if data.drop is None else 2 * fit.line.sigma * x / (fit.data.measured - delay)
    residual = fit.line.y / fit.line.sigma
    captions = {
        "Error bars are standard uncertainties.": True,
        "They include the scatter between runs.": fit.line.between > 0,
        "Points are numbered as rows.": True,
        "Outliers are ringed.": bool(fit.outliers),
        "Hollow points are left out.": not used.all(),
        "The fitted delay is subtracted from the times.": "delay" in fit.names,
    }
    below = " ".join(words for words, holds in captions.items() if holds)
    fitted = [x for x in MEANING if x in fit.results]
    results = [equation(x, *fit.results[x][:2]).replace(x, MEANING[x]) for x in fitted]
    with saved(picture, [conditions(fit), verdict(fit)], below, panels=2) as figure:
        line, rest = figure.subplots(2, 1, sharex=True, height_ratios=[2.4, 1])
        for axes in line, rest:
            axes.margins(0, 0.15)
        end = 1.06 * np.nanmax(x + u_x)
        line.plot([0, end], [f, f + c * end], color=BLUE)
        bars: Any = {"fmt": "o", "ms": 4, "capsize": 2, "lw": 1, "color": INK}
        line.errorbar(x, y, (fit.data.l + fit.data.h) * u_x, u_x, **bars)
        rest.axhline(0, color=BLUE)
        for level in (-2, 2):
            rest.axhline(level, color=FAINT, lw=0.8, ls="--")
        rest.plot(x, residual, "o", ms=4, color=INK)
        odd = np.isin(np.flatnonzero(fit.shown), [run for run, _ in fit.outliers])
        for axes, heights in ((line, y), (rest, residual)):
            axes.plot(x[odd[used]], heights[odd[used]], "o", ms=9, mfc="none", color=RED)
        line.text(0.03, 0.97, typeset("\n".join(results)), transform=line.transAxes, va="top", color=BLUE)
        line.set_ylabel("difference of tensions Tₕ − Tₗ (N)")
        rest.set(xlabel="acceleration a (m/s²)", ylabel="residual/u")
        low, high = line.get_ylim()
        line.set(xlim=line.get_xlim(), ylim=(low, high + 0.2 * (high - low)))
        a, difference = np.clip(a, *line.get_xlim()), np.clip(difference, *line.get_ylim())
        line.plot(
            a[~used], difference[~used], "o", ms=4, mfc="none", color=INK, clip_on=False, in_layout=False
        )
        is_named = ~used | odd | (len(used) <= MOST_NAMED)
        rows = [",".join(map(str, fit.runs.rows[run])) for run in np.flatnonzero(fit.shown).tolist()]
        write_beside(line, [(a[i], difference[i], rows[i], INK) for i in np.flatnonzero(is_named & (a > 0))])
