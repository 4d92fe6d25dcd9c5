"""What contradicts a fit: measurements, columns, runs, or what is wrong in all runs alike."""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from math import inf
from typing import Any

import numpy as np
from scipy.special import fdtrc

from ..numbers.digits import format_number
from ..numbers.text import shortened
from ..solver import physics
from ..solver.scene import parameter_of
from .columns import ONE_LOAD
from .estimate import (
    TINY,
    Conditions,
    Fitted,
    accelerations,
    best_fit,
    data_of,
    estimate,
    expected,
    line_of,
    moves,
    of_forces,
    of_measured,
    separates,
)
from .results import FITTED, QUANTITIES, equation, published, rounded
from .runs import Runs, Selection, in_words
from .statistics import CannotSeparate, Line, distances_from, judge_of_repeats, outliers, spread_of_columns

OUTLIER_LEVEL = 0.012
"""The chance of a false alarm in a sound set: once among repeats, once among runs. It is from simulations."""
FEW_REPEATS = 3
"""With fewer degrees of freedom repeats do not judge each other."""
SELDOM = 0.05
"""The p value below which runs are said to scatter more than their repeats."""
RARE = 0.01
"""The p value below which a cause is reported, and above 1 less which runs scatter less than repeats."""
NEAR_BEST = 4.0
"""Explanations are as good as the best if their χ² is not this many times the variance above it."""
WIDE_SPREAD = 3.0
"""Columns of repeats that differ as a whole do so by this many standard deviations, or more."""
PLAUSIBLE = {"gravity": (5.0, 15.0), "height": (3.0, 25.0), "delay": (-0.2, 0.5)}
"""The least and the most that may be a cause: of gravity (m/s²), of gravity that stands for a height which is
given, and of a delay, in shares of the shortest time."""
WIDE_DELAY = 0.1
"""The half width of a delay's interval (s) from which the runs cannot show it."""
LEAST_SHARE, MOST_SHARE = 1e-4, 2.0
"""An acceleration outside these shares of that without a pulley and friction must be a mistake."""
MOST_KINDS = 50
"""The most columns, or rows of a run, that are compared as a whole."""
CHECK = "check masses, heights, measurements, their units and signs"


def diagnosed(fit: Fitted) -> Fitted:
    """Return a fit with its outliers, and with the causes that may be wrong in all runs.

    Cells are judged by their repeats first; those that are found are left out before the rest. Then rows
    and freed quantities are judged, and rows count if they explain the runs as well as the best quantity.
    """
    cells, rows, clean, line = _far(fit)
    causes, as_good = _repairs(clean, _freed(clean))
    outliers = _named(fit, cells | rows if line.chi2 < as_good else cells)
    return fit._replace(outliers=outliers, cause=_in_words(causes))


def contradiction(fit: Fitted) -> str:
    """Say why no pulley explains a fit: outliers without which one does, runs that are held, causes."""
    cells, rows, *_ = _far(fit)
    with suppress(CannotSeparate):
        if (cells or rows) and _is_sound(_without(fit, cells | rows)):
            return "; ".join(message for _, message in _named(fit, cells | rows))
    if held := np.flatnonzero(fit.used)[~moves(fit.data, fit.values)].tolist():
        return f"{fit.runs.rows_in_words(*held)} would not move, as the fitted axle holds that; {CHECK}"
    causes = _in_words(_repairs(fit, _freed(fit))[0])
    return causes or impossible(fit.runs, fit.used, fit.shared, fit.names)[0] or CHECK


# What may be wrong in all runs


def _freed(fit: Fitted, some: Sequence[str] = FITTED) -> dict[str, Fitted]:
    """Return the fits of one more quantity, the last of their names, where the runs determine it, too."""
    freed = dict[str, Fitted]()
    for name in (x for x in some if x not in fit.names and (x != "delay" or fit.runs.kind == "time")):
        names, known = [*fit.names, name], {x: fit.shared.values[x] for x in fit.shared.values if x != name}
        if fit.line.dof > 1 and separates(fit.data, fit.shared.values, names):
            with suppress(CannotSeparate, ZeroDivisionError):
                values, line = estimate(fit.data, known, names, fit.values)
                freed[name] = fit._replace(names=names, values=values, line=line)
    return freed


def is_negative(name: str, value: float, u: float, times: float = 2.0) -> bool:
    """Decide if what must be above 0 is below it by more than so many ``times`` its uncertainty, or 2."""
    return name != "delay" and value + max(2.0, times) * u < 0


def _is_sound(fit: Fitted) -> bool:
    """Decide if a pulley explains a fit, and more runs than are needed support it."""
    negative = any(is_negative(x, fit.values[x], u) for x, u in zip(fit.names, fit.line.u, strict=True))
    return fit.line.dof > 0 and not negative and bool(moves(fit.data, fit.values).all())


def _is_plausible(freed: Fitted) -> bool:
    """Decide if a freed quantity is of a size that it may have, and explains the runs."""
    name = freed.names[-1]
    unit = float(freed.data.measured.min()) if name == "delay" else 1.0
    of_height = name == "gravity" and "drop" in freed.shared.inputs
    low, high = PLAUSIBLE.get("height" if of_height else name, (-inf, inf))
    return low < freed.values[name] / unit < high and _is_sound(freed)


def _repairs(fit: Fitted, freed: Mapping[str, Fitted]) -> tuple[list[Fitted], float]:
    """Return the freed quantities that repair a fit, the best first, and the χ² of what is as good.

    An F test judges what the best takes off χ², if it leaves two degrees of freedom. With it are all that are
    as good. An inertia that is given without an uncertainty is repaired, too, if the interval of 95 %
    excludes it.
    """
    changes = {x: abs(one.values[x] - fit.values[x]) / one.line.u[-1] for x, one in freed.items()}
    causes = [one for x, one in freed.items() if one.line.dof > 1 and changes[x] > 1 and _is_plausible(one)]
    if not causes:
        return [], inf
    causes.sort(key=lambda cause: cause.line.chi2)
    best = causes[0].line
    # The known variance counts in that of the best, unless runs scatter more.
    extra = best.known_dof if (best.p_value or 0) >= SELDOM else 0.0
    variance, dof = max((best.chi2 + extra) / (best.dof + extra), TINY), best.dof + extra
    as_good = best.chi2 + NEAR_BEST * variance
    if fdtrc(1, dof, max(fit.line.chi2 - best.chi2, 0) / variance) * len(causes) < RARE:
        return [cause for cause in causes if cause.line.chi2 < as_good], as_good
    is_certain = "rim_mass" in fit.shared.values and not any(fit.shared.inputs[x].uncertainty for x in "MIR")
    inertia = [one for one in causes if one.names[-1] == "rim_mass" and changes["rim_mass"] > one.line.times]
    return inertia if is_certain else [], inf


def _in_words(causes: Sequence[Fitted]) -> str:
    which = "; they cannot tell which" if len(causes) > 1 else ""
    return f"the runs fit better if {', or '.join(map(_cause, causes))}{which}" if causes else ""


def _cause(freed: Fitted) -> str:
    """Say what a freed quantity would be, and how to fit it."""
    name, shared = freed.names[-1], freed.shared
    value, u = freed.values[name], freed.line.u[-1]
    if name == "delay":
        words = f"all times are {published(abs(value), u)[0]} s too {'long' if value > 0 else 'short'}"
    else:
        what = f"{name} (or the height of fall)" if name == "gravity" and "drop" in shared.inputs else name
        unit, instead = QUANTITIES[name].unit, rounded(shared.values.get(name, 0.0), 3)
        words = f"{what} is {published(value, u)[0]} {unit}, not {instead}"
    typed = [x for x in QUANTITIES[name].given_by if shared.inputs[x].given is not None]
    without = f"without {shared.option(typed[0])}: " if typed else ""
    return f"{words} ({without}{shared.option('find', ','.join(freed.names))})"


def unseen_delay(fit: Fitted) -> str:
    """Say that runs cannot show a delay of all times, or ""."""
    one, gives = _freed(fit, ["delay"]).get("delay"), ""
    is_shown = one and one.line.times * one.line.u[-1] <= WIDE_DELAY
    if fit.runs.kind != "time" or "delay" in fit.names or is_shown:
        return ""
    if one and _is_plausible(one):
        value, _ = published(one.values["delay"], one.line.u[-1])
        gives = f" ({fit.shared.option('find', ','.join(one.names))} gives {value} s)"
    wider = "More heights of fall, or wider ranges of m2 - m1 and m1 + m2, would show it"
    late = f"the runs cannot show whether all times are too long by a delay{gives}"
    return f"{late}; the results assume none. {wider}"


# Outliers


Distances = dict[int, float]
"""Outliers by their places, or by runs: how many standard deviations each is from what the others give."""


def _far(fit: Fitted) -> tuple[Distances, Distances, Fitted, Line]:
    """Return outliers among repeats, and among runs; the fit without the first, the line without both.

    Few repeats, which do not show their own scatter, are judged as runs.
    """
    runs, run_of, cells, clean = fit.runs, fit.runs.run, Distances(), fit
    with suppress(CannotSeparate):
        if 0 < len(run_of) - len(runs.rows) < FEW_REPEATS:
            given, u = ({x: column[run_of] for x, column in some.items()} for some in (runs.given, runs.u))
            apart = np.arange(len(run_of))
            single = runs._replace(given=given, u=u, left_out=runs.left_out[run_of], run=apart)
            clean, run_of = best_fit(single, fit.used[run_of], fit.shared, fit.names), apart
        elif cells := _far_repeats(fit):
            clean = _without(fit, cells)
    far, line = _far_runs(clean)
    rows = {int(i): distance for run, distance in far.items() for i in np.flatnonzero(run_of == run)}
    return cells, rows, clean, line


def _without(fit: Fitted, far: Distances) -> Fitted:
    """Return the fit without the measurements at these places. Raises CannotSeparate."""
    old, kept = fit.runs, np.delete(np.arange(len(fit.runs.values)), [*far])
    runs = old._replace(values=old.values[kept], u_values=old.u_values[kept], run=old.run[kept])
    used = fit.used & (np.bincount(runs.run, minlength=len(fit.used)) > 0)
    return best_fit(runs._replace(cells=[old.cells[i] for i in kept.tolist()]), used, fit.shared, fit.names)


def _named(fit: Fitted, far: Distances) -> list[tuple[int, str]]:
    """Return outliers as runs with a message on each: on a run once, or on a measurement."""
    runs, messages = fit.runs, dict[str, tuple[int, str]]()
    for place, distance in far.items():
        run = int(runs.run[place])
        is_run = all(i in far for i in np.flatnonzero(runs.run == run).tolist())
        where: Sequence[int | str] = runs.rows[run] if is_run else [runs.cells[place]]
        number = f" = {format_number(float(runs.values[place]))} {parameter_of(runs.kind).unit}"
        verb = " are" if len(where) > 1 else " is" if is_run else f"{number} is"
        left_out = ",".join(map(str, where))
        why = f"{rounded(abs(distance))} standard deviations from what the others give"
        way = f"if it is a mistake, leave it out: {fit.shared.option('without', left_out)}"
        messages.setdefault(left_out, (run, f"{in_words(*where)}{verb} {why}; {way}"))
    return [*messages.values()]


def _far_repeats(fit: Fitted) -> Distances:
    """Return the outliers among repeats."""
    # Of two repeats, which are equally far from each other, that far from the line comes first.
    runs = fit.runs
    places = np.flatnonzero((fit.used & (np.bincount(runs.run) > 1))[runs.run])
    ideal = expected(fit.data, fit.values)[(np.cumsum(fit.used) - 1)[runs.run[places]]]
    away = (runs.sign[runs.run] * runs.values)[places] - ideal
    places = places[np.argsort(-np.abs(away), kind="stable")]
    u = runs.u_values[places] if fit.data.stated else np.ones(len(places))
    judge = judge_of_repeats(runs.values[places], u, runs.run[places], runs.step)
    return outliers(judge, places, len(places) - len({*runs.run[places]}), OUTLIER_LEVEL)


def _far_runs(fit: Fitted) -> tuple[Distances, Line]:
    """Return the outliers among runs, and the line without them.

    They are judged by the line of forces, which outliers bend least. That is no line in a delay: if one is
    fitted, runs are judged by the least squares of the times of the others.
    """
    usable, data, names = np.flatnonzero(fit.used), fit.data, fit.names
    values = {**fit.values, "rim_mass": max(fit.values["rim_mass"], 0.0)}
    known = {x: value for x, value in values.items() if x not in names}

    def line_by(some: Selection) -> Line:
        if "delay" not in names:
            return line_of(of_forces, data, values, names)
        others = data_of(fit.runs, np.isin(np.arange(len(fit.used)), usable[some]))
        best, _ = estimate(others._replace(varying=data.varying), known, names, values)
        return line_of(of_measured, data, best, names)

    free = len(usable) - len(names)
    far = outliers(lambda some: distances_from(line_by(some), some), usable, free, OUTLIER_LEVEL)
    kept = ~np.isin(usable, [*far])
    return far, line_by(kept).part(kept) if far else fit.line


def columns_in_doubt(runs: Runs, used: Selection) -> list[str]:
    """Say which columns of repeats, or rows of runs, differ from others as a whole, as other loads do.

    Logarithms are compared, as another pulley or load changes times, or accelerations, by a share.
    """
    values = runs.sign[runs.run] * runs.values
    places = np.flatnonzero(used[runs.run] & (values > 0))
    cells = [runs.cells[i].split(":") for i in places.tolist()]
    nth = {str(row): str(i) for rows in runs.rows for i, row in enumerate(rows)}
    by_rows = len({word for _, word in cells}) < 2 and sum(len(rows) > 1 for rows in runs.rows) > 1
    kinds = [nth[row] if by_rows else word for row, word in cells]
    names, column = np.unique(kinds, return_inverse=True)
    if not 1 < len(names) <= MOST_KINDS:
        return []
    rounding = float(np.mean((runs.step / values[places]) ** 2)) / 12
    p_value, spread = spread_of_columns(np.log(values[places]), runs.run[places], column, rounding)
    words = f"columns {shortened(', '.join(names))} differ as a whole: are they of one pulley and one load?"
    words = f"{words} If not, {ONE_LOAD}."
    if by_rows:
        words = "the rows of each run differ as a whole, as marks of one fall do: are they of one height?"
    return [words] if p_value < RARE and spread > WIDE_SPREAD else []


# Runs that no pulley has


def impossible(
    runs: Runs, used: Selection, shared: Conditions, names: Sequence[str], most: float = 1.0
) -> tuple[str, float]:
    """Say which accelerations are far below, or above ``most`` times, that of free masses; and how many."""
    if "gravity" in names or "delay" in names:
        return "", 0.0
    data = data_of(runs, used)
    free: Any = physics.acceleration(data.h - data.l, data.h + data.l, shared.values["gravity"])
    a = accelerations(data, data.measured)
    is_impossible = (a / free < LEAST_SHARE) | (a / free > most)
    if not is_impossible.any():
        return "", 0.0
    places, i = np.flatnonzero(used)[is_impossible].tolist(), int(np.argmax(is_impossible))
    others, gives = used & ~np.isin(np.arange(len(used)), places), ""
    with suppress(CannotSeparate):
        if others.any() and _is_sound(rest := best_fit(runs, others, shared, names)):
            results = zip(names, rest.line.u, strict=True)
            gives = f"; the others give {', '.join(equation(x, rest.values[x], u) for x, u in results)}"
    value, times, usual = (rounded(float(x), 3) for x in (a[i], a[i] / free[i], free[i]))
    far = f"{value} m/s² is {times} times the acceleration without friction and pulley, {usual} m/s²"
    too = f"; see {shortened(runs.rows_in_words(*places[1:]))}, too" if len(places) > 1 else ""
    words = f"{runs.rows_in_words(places[0])}: a = {far}{too}{gives}; {CHECK}"
    return words, float(is_impossible.mean())
