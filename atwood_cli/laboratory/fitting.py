"""From runs to a result: values, uncertainties, outliers and causes, or why there is none."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from fractions import Fraction
from math import hypot
from typing import Any, NamedTuple

import numpy as np
from scipy.special import fdtrc

from ..numbers.digits import format_number, half_range
from ..numbers.text import counted
from ..reading.names import divided, read_names
from ..solver import physics
from ..solver.decisions import Decisions
from ..solver.scene import MASSES, Input, Scene, SceneError, parameter_of
from .estimate import (
    TINY,
    Data,
    accelerations,
    as_data,
    by_forces,
    estimate,
    expected,
    line_of,
    of_forces,
    of_measured,
    separates,
)
from .results import FITTED, QUANTITIES, RESULTS, SYMBOLS, USUAL, Result, equation, published, rounded
from .runs import (
    OUT_OF_RANGE,
    REACHES_0,
    Column,
    Places,
    Runs,
    Selection,
    behind_an_error,
    in_range,
    in_words,
)
from .statistics import CannotSeparate, Line, distances_from, judge_of_repeats, outliers

OUTLIER_LEVEL = 0.012
"""The probability that a sound set has an outlier among its repeats, and that it has one among its runs."""
FEW_REPEATS = 3
"""With fewer degrees of freedom repeats do not judge each other."""
SELDOM = 0.05
"""The p value below which runs are said to scatter more than their repeats."""
RARE = 0.01
"""The p value below which a cause is reported, and above 1 less which runs scatter less than repeats."""
NEAR_BEST = 4.0
"""Causes are as good as the best if their χ² is not this many times the variance above it."""
EARTH = 9.76, 9.84
"""The least and the most gravity (m/s²) on land."""
PLAUSIBLE = 5.0, 15.0
"""The least and the most gravity (m/s²) that may be a cause: beyond it, something else is wrong."""
WIDE_DELAY = 0.1
"""The half width of a delay's interval (s) from which the runs cannot show it."""
SHARES = 1e-4, 2.0
"""An acceleration outside these shares of that without a pulley and friction must be a mistake."""
GIVE = {"rim_mass": "M (or I and R)", "axle": "axle (0 if it has no friction)"}
"""What to give for a quantity that is neither given nor fitted."""
DERIVED = {"I": "R", "M": "inertia"}
"""What is needed for an input that follows from the rim mass."""
CHECK = "check masses, heights, measurements, their units and signs"
NO_FIT = "no pulley explains these runs, whatever its inertia and its axle's friction"


class Conditions(NamedTuple):
    """The inputs that all runs share, with ``drop`` if they share it."""

    inputs: Mapping[str, Input]
    scene: Scene

    @property
    def values(self) -> dict[str, float]:
        """Return the quantities of a fit that are given, and the height of fall."""
        scene, has_pulley = self.scene, self.scene.M is not None or self.scene.I is not None
        values = {"gravity": scene.g, "drop": scene.motion.drop, "axle": scene.axle}
        values |= {"rim_mass": Decisions(scene).rim_mass} if has_pulley else {}
        return {x: float(value) for x, value in values.items() if value is not None}


class Fitted(NamedTuple):
    """The fit of the runs that are ``used``: ``values`` of all quantities, of which ``names`` are fitted.

    ``line`` is the linear fit of the measurements at these values. Something can be expected of all runs that
    are ``shown``; the others of these are left out. ``outliers`` are runs, with a message on each, and
    ``causes`` messages on what may be wrong in all runs.
    """

    runs: Runs
    used: Selection
    shown: Selection
    given: Conditions
    names: Sequence[str]
    data: Data
    values: Mapping[str, float]
    line: Line
    results: Mapping[str, Result] = {}
    outliers: Sequence[tuple[int, str]] = ()
    causes: Sequence[str] = ()


# What is given, and what is to be fitted


def conditions_of(inputs: Mapping[str, Input]) -> Conditions:
    """Return the conditions that inputs give. Raises SceneError."""
    for x, typed in inputs.items():
        if typed.given is not None and not in_range(typed):
            raise SceneError(x, typed.given, OUT_OF_RANGE)
    masses = {f"m{i}": Input(Fraction(i), Fraction(0), None) for i in (1, 2)}  # any would do
    return Conditions(inputs, Scene.of({**inputs, **masses}))


def _neighbours(runs: Runs, used: Selection, given: Conditions) -> Iterator[list[tuple[Data, Conditions]]]:
    """Yield runs and conditions with each uncertain input of all runs at its two ends. Raises SceneError."""
    data = as_data(runs, used)
    for x, typed in given.inputs.items():
        if u := typed.uncertainty:
            size = given.scene.number_of(x)
            if not parameter_of(x).may_be_zero and u >= size:
                raise SceneError(x, typed.given, REACHES_0)
            scenes = [given.scene.with_number(x, end) for end in (size - u, size + u)]
            yield [(data, given._replace(scene=scene)) for scene in scenes]
    for name, spread in runs.common.items():
        shifted = MASSES if name == "hanger" else (name,)
        for_ends = [{**runs.given, **{x: runs.given[x] + u for x in shifted}} for u in (-spread, spread)]
        yield [(as_data(runs._replace(given=end), used), given) for end in for_ends]


def read_find(words: Sequence[str], given: Conditions) -> list[str]:
    """Return the quantities to fit, by names or symbols; both usual ones unless given. Raises SceneError.

    None may be given, and of the usual ones none may be neither given nor fitted.
    """
    if derived := [x for x in divided(words) if x in DERIVED]:
        raise SceneError(
            "find", derived[0], f"follows from rim_mass: find that, with {DERIVED[derived[0]]} given"
        )
    names = list(dict.fromkeys(read_names("find", words, FITTED, "quantity to fit", SYMBOLS)))
    for name in names:
        for known in QUANTITIES[name].given_by:
            if given.inputs[known].given is not None:
                rule = f"conflicts with {known}, which gives it; leave one of them out"
                raise SceneError("find", name, rule)
    for x, terms in given.scene.terms if "gravity" in names else ():
        if terms.by == "g":
            rule = f"is {terms.words}, and gravity is to be found; give it in kg"
            raise SceneError(x, given.inputs[x].given, rule)
    left = [x for x in USUAL if x not in names and x not in given.values]
    if names and left:
        what, give = (" and ".join(words[x] for x in left) for words in (RESULTS, GIVE))
        rule = f"needs {what}: give {give}, or find {' and '.join(left)}, too"
        raise SceneError("find", ",".join(names), rule)
    return names or left


# From runs to a result


@np.errstate(all="ignore")  # what a step tries may be 0, or beyond doubles
def fitted(runs: Runs, given: Conditions, names: Sequence[str]) -> Fitted:
    """Return the fit of these quantities, with outliers and causes. Raises SceneError, CannotSeparate."""
    if "delay" in names and runs.kind != "time":
        raise SceneError("find", "delay", "needs times; the table has accelerations")
    difference = runs.given["m2"] - runs.given["m1"]
    held = 0.0 if "gravity" in names else given.values.get("axle", 0.0) / given.values["gravity"]
    unusable = {
        "the masses are equal": difference == 0,
        "nothing moved": runs.mean == 0,
        "the lighter side falls": runs.sign * runs.mean < 0,
        "an axle with the friction given holds the masses": abs(difference) <= held,
    }
    shown, remarks = np.ones(len(runs.rows), dtype=bool), [*runs.remarks]
    for reason, holds in unusable.items():
        if (shown & holds).any():
            remarks.append(f"{runs.rows_in_words(*np.flatnonzero(shown & holds))}: not used, as {reason}.")
        shown = shown & ~holds
    runs, used = runs._replace(remarks=remarks), shown & ~runs.left_out
    mistakes: Sequence[tuple[int, str]] = ()
    try:
        if not used.any():
            raise CannotSeparate("no run can be used")
        data = as_data(runs, used)
        what = [QUANTITIES[x].words for x in names]
        needed = len(names) + int(not (data.scatter.any() or data.uncertain))
        if len(data.l) < needed:
            why = f"{counted(len(data.l), 'run')} cannot determine {' and '.join(what)}"
            raise CannotSeparate(f"{why}: give {needed} or more")
        if "gravity" not in names and "delay" not in names:
            mistakes = _mistakes(runs, used, data, given.values["gravity"])
        if not separates(data, given.values, names):
            give, is_one = (f", or give {GIVE[x]}" for x in names if x in GIVE), len(names) == 1
            why = f"determine {what[0]}" if is_one else f"separate {' from '.join(what)}"
            vary = f"vary both m2 - m1 and m1 + m2 more{'' if is_one else ''.join(give)}"
            raise CannotSeparate(f"the runs do not {why}: {vary}")
        fit = _with_results(runs, used, data, given, names)
    except CannotSeparate as error:
        message = mistakes[0][1] if mistakes else "".join(error.args)
        raise CannotSeparate(f"{message}{behind_an_error([*remarks, *runs.doubts])}") from None
    fit = fit._replace(shown=shown, outliers=[*_outliers(fit)] or mistakes)
    freed = [*_freed(fit)]
    causes = _held(fit) or [*filter(None, [_repair(fit, freed) or _unseen_delay(fit, freed)])]
    low, high = fit.results["gravity"].interval if "gravity" in names else EARTH
    if high < EARTH[0] or low > EARTH[1]:
        causes.append(f"gravity is not that of Earth, {EARTH[0]} to {EARTH[1]} m/s²: {CHECK}")
    return fit._replace(causes=causes)


def _with_results(runs: Runs, used: Selection, data: Data, given: Conditions, names: Sequence[str]) -> Fitted:
    """Return the fit of the runs that are used. Raises CannotSeparate."""
    try:
        values, line = estimate(data, given.values, names)
        ends = [
            [_with_derived(estimate(near, by.values, names, values)[0], names, by) for near, by in pair]
            for pair in _neighbours(runs, used, given)
        ]
    except (CannotSeparate, ZeroDivisionError):  # a gravity of 0 holds no axle
        message = CHECK
        with suppress(CannotSeparate):
            values = by_forces(data, given.values, names)
            line = line_of(of_forces, data, values, names)
            message = _suspects(Fitted(runs, used, used, given, names, data, values, line)) or message
        raise CannotSeparate(f"{NO_FIT}: {message}") from None
    spread, results = _with_derived(dict(zip(names, line.u, strict=True)), names, given), dict[str, Result]()
    for x, value in _with_derived(values, names, given).items():
        u = hypot(spread[x], *(half_range([value, *(end[x] for end in pair)]) for pair in ends))
        results[x] = Result(value, u, (value - line.times * u, value + line.times * u))
    fit = Fitted(runs, used, used, given, names, data, values, line, results)
    for x, (value, u, _) in results.items():
        if x in names and _is_negative(x, value, u, line):
            message = _suspects(fit) or _repair(fit, [*_freed(fit)]) or CHECK
            raise CannotSeparate(f"{equation(x, value, u)} is negative: {message}")
    return fit


def _is_negative(name: str, value: float, u: float, line: Line) -> bool:
    """Decide if a value is below 0 by more than chance explains."""
    return name != "delay" and value + max(2.0, line.times) * u < 0


def _with_derived(values: Mapping[str, float], names: Sequence[str], given: Conditions) -> dict[str, float]:
    """Return the fitted values, with what follows from the rim mass by R and by the shape, if given."""
    results, scene = {x: values[x] for x in FITTED if x in names}, given.scene
    if "rim_mass" in results:
        if given.inputs["inertia"].number is not None:
            results["pulley_mass"] = results["rim_mass"] / float(scene.inertia or 0)
        if scene.R is not None:
            results["moment_of_inertia"] = physics.moment_of_inertia(results["rim_mass"], float(scene.R))
    return results


# What may be wrong in all runs


def _freed(fit: Fitted) -> Iterator[Fitted]:
    """Yield the fits of one more quantity, the last of their names, where the runs determine it, too."""
    for name in (x for x in FITTED if x not in fit.names and (x != "delay" or fit.runs.kind == "time")):
        names, known = [*fit.names, name], {x: fit.given.values[x] for x in fit.given.values if x != name}
        if fit.line.dof > 1 and separates(fit.data, fit.given.values, names):
            with suppress(CannotSeparate, ZeroDivisionError):
                values, line = estimate(fit.data, known, names, fit.values)
                yield fit._replace(names=names, values=values, line=line)


def _is_physical(freed: Fitted) -> bool:
    """Decide if what must be above 0 may be, and if a freed gravity is plausible."""
    if freed.names[-1] == "gravity" and not PLAUSIBLE[0] < freed.values["gravity"] < PLAUSIBLE[1]:
        return False
    pairs = zip(freed.names, freed.line.u, strict=True)
    return all(x == "delay" or freed.values[x] + 2 * u > 0 for x, u in pairs)


def _repair(fit: Fitted, freed: Sequence[Fitted]) -> str:
    """Say which freed quantities repair a fit, or "".

    An F test judges what the best takes off χ²; the known variance counts in it unless runs scatter more than
    that with the best, too. Named are all that are as good as the best.
    """
    changes = (abs(one.values[one.names[-1]] - fit.values[one.names[-1]]) / one.line.u[-1] for one in freed)
    causes = [one for one, change in zip(freed, changes, strict=True) if change > 1 and _is_physical(one)]
    if not causes:
        return ""
    causes.sort(key=lambda cause: cause.line.chi2)
    best = causes[0].line
    extra = fit.data.known_dof if (best.p_value or 0) >= SELDOM else 0.0
    scale = max((best.chi2 + extra) / (best.dof + extra), TINY)
    if fdtrc(1, best.dof + extra, max(fit.line.chi2 - best.chi2, 0) / scale) * len(causes) >= RARE:
        return ""
    near = [_cause(one) for one in causes if one.line.chi2 - best.chi2 < NEAR_BEST * scale]
    which = "; they cannot tell which" if len(near) > 1 else ""
    also = ", which may explain outliers, too" if fit.outliers else ""
    return f"the runs fit better if {', or '.join(near)}{which}{also}"


def _unseen_delay(fit: Fitted, freed: Sequence[Fitted]) -> str:
    """Say that sound runs cannot show a delay of all times, or ""."""
    if fit.runs.kind != "time" or "delay" in fit.names or fit.outliers:
        return ""
    late = "the runs cannot show whether all times are too long by a delay"
    if freed and freed[-1].names[-1] == "delay":  # the last that may be freed
        names, value, line = freed[-1].names, freed[-1].values["delay"], freed[-1].line
        if line.times * line.u[-1] <= WIDE_DELAY:
            return ""
        late += f" (`--find {','.join(names)}` gives {published(value, line.u[-1])[0]} s)" * _is_physical(
            freed[-1]
        )
    wider = "More heights of fall, or wider ranges of m2 - m1 and m1 + m2, would show it"
    return f"{late}; the results assume none. {wider}"


def _cause(freed: Fitted) -> str:
    """Say what a freed quantity would be, and how to fit it."""
    name, given = freed.names[-1], freed.given
    value, u = freed.values[name], freed.line.u[-1]
    if name == "delay":
        words = f"all times are {published(abs(value), u)[0]} s too {'long' if value > 0 else 'short'}"
    else:
        what = f"{name} (or the height of fall)" if name == "gravity" and "drop" in given.inputs else name
        unit, instead = QUANTITIES[name].unit, rounded(given.values.get(name, 0.0), 3)
        words = f"{what} is {published(value, u)[0]} {unit}, not {instead}"
    typed = [x for x in QUANTITIES[name].given_by if given.inputs[x].given is not None]
    without = f"without `--{typed[0]}`: " if typed else ""
    return f"{words} ({without}`--find {','.join(freed.names)}`)"


def _held(fit: Fitted) -> list[str]:
    """Say which runs the fitted axle would hold, which no cause in all runs explains."""
    messages, moves = list[str](), expected(fit.data._replace(drop=None), fit.values) > 0
    for run in np.flatnonzero(fit.used)[~moves].tolist():
        given = (
            f"{x} = {rounded(column[run], 3)} {parameter_of(x).unit}" for x, column in fit.runs.given.items()
        )
        where = f"{fit.runs.rows_in_words(run)} ({', '.join(given)})"
        messages.append(f"{where} would not move, as the fitted axle holds it: {CHECK}")
    return messages


# Outliers


def _suspects(fit: Fitted) -> str:
    """Return the outliers if a fit without their runs is one that a pulley explains."""
    suspects, others = [*_outliers(fit)], fit.used.copy()
    others[[run for run, _ in suspects]] = False
    with suppress(CannotSeparate):
        if suspects and others.sum() > len(fit.names):
            values, line = estimate(as_data(fit.runs, others), fit.given.values, fit.names)
            if not any(_is_negative(x, values[x], u, line) for x, u in zip(fit.names, line.u, strict=True)):
                return "; ".join(message for _, message in suspects)
    return ""


def _outliers(fit: Fitted) -> list[tuple[int, str]]:
    """Return outliers among the repeats of each run, and among the runs without these repeats.

    What is wrong with a run or with a row is named once. Few repeats are judged as runs of their own.
    """
    runs, messages = fit.runs, dict[str, tuple[int, str]]()
    places = np.flatnonzero((fit.used & (np.bincount(runs.run) > 1))[runs.run])
    free = len(places) - len({*runs.run[places]})
    kept = np.ones(len(runs.values), dtype=bool)
    if 0 < free < FEW_REPEATS and not fit.data.stated:
        given, u = ({x: column[runs.run] for x, column in some.items()} for some in (runs.given, runs.u))
        single = runs._replace(given=given, u=u, left_out=runs.left_out[runs.run], run=np.arange(len(kept)))
        far = _far_runs(fit._replace(runs=single, used=fit.used[runs.run]), kept)
    else:
        far = _far_repeats(fit, places, free)
        kept[[*far]] = False
        for run, distance in _far_runs(fit, kept).items():
            far |= dict.fromkeys(np.flatnonzero(runs.run == run).tolist(), distance)
    for place, distance in far.items():
        run, cell = int(runs.run[place]), runs.cells[place]
        of_run, row = np.flatnonzero(runs.run == run).tolist(), cell.split(":")[0]
        where: Sequence[int | str] = runs.rows[run]
        if not all(i in far for i in of_run):
            is_whole = all(i in far for i in of_run if runs.cells[i].startswith(f"{row}:"))
            where = [row if is_whole else cell]
        unit = parameter_of(runs.kind).unit
        value = f" = {format_number(float(runs.values[place]))} {unit}" if where == [cell] else ""
        what = f"{in_words(*where)}{value} {'is' if len(where) == 1 else 'are'}"
        left_out = ",".join(map(str, where))
        why = f"{rounded(abs(distance))} standard deviations from what the others give"
        way = f"if it is a mistake, leave it out: `--without {left_out}`"
        messages.setdefault(left_out, (run, f"{what} {why}; {way}"))
    return [*messages.values()]


def _far_repeats(fit: Fitted, places: Places, free: int) -> dict[int, float]:
    """Return the outliers among repeats, at these ``places``, by their distances."""
    # Of two repeats, which are equally far from each other, that far from the line comes first.
    runs = fit.runs
    ideal = expected(fit.data, fit.values)[(np.cumsum(fit.used) - 1)[runs.run[places]]]
    away = (runs.sign[runs.run] * runs.values)[places] - ideal
    places = places[np.argsort(-np.abs(away), kind="stable")]
    u = runs.u_values[places] if fit.data.stated else np.ones(len(places))
    judge = judge_of_repeats(runs.values[places], u, runs.run[places], runs.step)
    return outliers(judge, places, free, OUTLIER_LEVEL)


def _far_runs(fit: Fitted, kept: Selection) -> dict[int, float]:
    """Return the outliers among runs, with the measurements that are ``kept``, by their distances.

    They are judged by the line of forces, which outliers bend least. That is no line in a delay: if one is
    fitted, runs are judged by the least squares of the times of the others.
    """
    usable, data, names = np.flatnonzero(fit.used), as_data(fit.runs, fit.used, kept), fit.names
    values = {**fit.values, "rim_mass": max(fit.values["rim_mass"], 0.0)}
    given = {x: value for x, value in values.items() if x not in names}

    def judge(some: Selection) -> tuple[Column, Any]:
        if "delay" not in names:
            return distances_from(line_of(of_forces, data, values, names), some)
        others = np.isin(np.arange(len(fit.used)), usable[some])
        best, _ = estimate(as_data(fit.runs, others, kept), given, names, values)
        return distances_from(line_of(of_measured, data, best, names), some)

    return outliers(judge, usable, len(usable) - len(names), OUTLIER_LEVEL)


# Why there is no result


def _mistakes(runs: Runs, used: Selection, data: Data, g: float) -> list[tuple[int, str]]:
    """Return the first run that must have a mistake. Raises CannotSeparate if most runs have one.

    Accelerations, which may be small, are compared with those of free masses.
    """
    a: Any = accelerations(data, data.measured)
    free: Any = physics.acceleration(data.h - data.l, data.h + data.l, g)
    is_mistaken = (a / free < SHARES[0]) | (a / free > SHARES[1])
    if not is_mistaken.any():
        return []
    i, what = int(np.argmax(is_mistaken)), "a" if data.drop is None else "a = 2 drop/t²"
    value, times, usual = (rounded(float(x), 3) for x in (a[i], a[i] / free[i], free[i]))
    run = int(np.flatnonzero(used)[i])
    far = f"{value} m/s² is {times} times the acceleration without friction and pulley, {usual} m/s²"
    words = f"{runs.rows_in_words(run)}: {what} = {far}; {CHECK}"
    if is_mistaken.mean() > 0.5:
        raise CannotSeparate(words)
    return [(run, words)]
