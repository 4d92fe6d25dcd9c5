"""Runs and the line that fits them, T_h - T_l = c a + f, as a picture, with residuals below."""

from typing import Any

import numpy as np

from ..output.figure import BLUE, FAINT, INK, RED, saved, typeset
from ..output.forms import Picture
from ..solver import physics
from .estimate import Fitted
from .report import conditions, results_of, verdict
from .results import equation

MOST_NAMED = 40  # runs; of more, only outliers and those left out
MEANING = {"rim_mass": "slope c", "axle": "intercept f", "gravity": "g", "delay": "Δt"}
"""The fitted quantities, as the picture shows them."""


def save(fit: Fitted, picture: Picture) -> None:
    """Draw runs and their line to a file. Raises OSError."""
    runs, columns = results_of(fit).runs, ("m1", "m2", "a", "u_a", "residual")
    m1, m2, a, u, residual = (np.array([run[x] for run in runs], float) for x in columns)
    a, u, residual = abs(a), abs(u), np.sign(a) * residual
    g, c, f = (fit.values[name] for name in ("gravity", "rim_mass", "axle"))
    difference = physics.difference_of_moving_masses(np.minimum(m1, m2), np.maximum(m1, m2), a, np.float64(g))
    used, hollow = fit.used, fit.shown & ~fit.used
    captions = {
        "Error bars are standard uncertainties.": True,
        "They include the scatter between runs.": fit.line.between > 0,
        "Points are numbered as rows.": True,
        "Outliers are ringed.": bool(fit.outliers),
        "Hollow points are left out.": hollow.any(),
        "The fitted delay is subtracted from the times.": "delay" in fit.names,
    }
    below = " ".join(words for words, holds in captions.items() if holds)
    fitted = [x for x in MEANING if x in fit.results]
    results = [equation(x, *fit.results[x][:2]).replace(x, MEANING[x]) for x in fitted]
    with saved(picture, [conditions(fit), verdict(fit)], below, panels=2) as figure:
        line, rest = figure.subplots(2, 1, sharex=True, height_ratios=[2.4, 1])
        for axes in line, rest:
            axes.margins(0, 0.15)
        end = 1.06 * np.nanmax(a[used] + u[used])
        line.plot([0, end], [f, f + c * end], color=BLUE)
        bars: Any = {"fmt": "o", "ms": 4, "capsize": 2, "lw": 1, "color": INK}
        line.errorbar(a[used], difference[used], ((m1 + m2) * u)[used], u[used], **bars)
        rest.axhline(0, color=BLUE)
        for level in (-2, 2):
            rest.axhline(level, color=FAINT, lw=0.8, ls="--")
        rest.plot(a[used], residual[used], "o", ms=4, color=INK)
        odd = [run for run, _ in fit.outliers]
        for axes, heights in ((line, difference), (rest, residual)):
            axes.plot(a[odd], heights[odd], "o", ms=9, mfc="none", color=RED)
        line.text(0.03, 0.97, typeset("\n".join(results)), transform=line.transAxes, va="top", color=BLUE)
        line.set_ylabel("difference of tensions Tₕ − Tₗ (N)")
        rest.set(xlabel="acceleration a (m/s²)", ylabel="residual/u")
        low, high = line.get_ylim()
        line.set(xlim=line.get_xlim(), ylim=(low, high + 0.2 * (high - low)))
        a, difference = np.clip(a, *line.get_xlim()), np.clip(difference, *line.get_ylim())
        bare: Any = {"ms": 4, "mfc": "none", "color": INK, "clip_on": False, "in_layout": False}
        line.plot(a[hollow], difference[hollow], "o", **bare)
        named = np.flatnonzero(fit.shown & (a > 0)).tolist()
        if len(named) > MOST_NAMED:
            named = [run for run in named if run in odd or hollow[run]]
        beside: Any = {"textcoords": "offset points", "ha": "right", "va": "bottom"}
        for i in named:
            line.annotate(runs[i]["rows"].replace(" ", ","), (a[i], difference[i]), (-4, 4), **beside)
