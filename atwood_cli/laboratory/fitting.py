"""From runs to a result: values, uncertainties and outliers, or why there is none."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from fractions import Fraction
from math import hypot, inf
from typing import Any, NamedTuple

import numpy as np
from scipy.special import fdtrc, stdtrit

from ..numbers.digits import format_number
from ..numbers.text import counted
from ..reading.names import read_names
from ..solver import physics
from ..solver.decisions import Decisions
from ..solver.scene import Input, InTerms, Scene, SceneError, parameter_of
from .estimate import (
    TINY,
    Data,
    Estimate,
    accelerations,
    as_data,
    by_forces,
    estimate,
    expected,
    linear,
    of_forces,
    of_measured,
)
from .results import FITTED, QUANTITIES, RESULTS, SYMBOLS, USUAL, Result, equation, published, rounded
from .runs import OUT_OF_RANGE, Runs, Selection, behind_an_error, in_range, in_words
from .statistics import CannotSeparate, judge_of_line, judge_of_repeats, outliers

OUTLIER_LEVEL = 0.012
"""The probability that a sound set has an outlier among its repeats, and that it has one among its runs."""
SELDOM = 0.05
"""The p value below which runs are said to scatter more than their repeats."""
RARE = 0.01
"""The p value below which a delay is reported, and above 1 less which runs scatter less than repeats."""
WIDE_DELAY = 0.1
"""The half width of a delay's interval (s) from which the runs cannot show it."""
LEAST_SINGULAR = 4e-4
"""Below this singular value of its slopes, each of length 1, a design does not separate the quantities."""
MOST_RATIO = 100
"""A value that many times above or below the median of its kind must be a mistake."""
SHARES = 1e-4, 2.0
"""An acceleration outside these shares of that without a pulley and friction must be a mistake, too."""
GIVE = {"rim_mass": "M (or I and R)", "axle": "axle (0 if it has no friction)"}
"""What to give for a quantity that is neither given nor fitted."""
CHECK = "check masses, heights, measurements, their units and signs"
NO_FIT = "no pulley explains these runs, whatever its inertia and its axle's friction"


class Conditions(NamedTuple):
    """The inputs that all runs share, with ``drop`` if they share it, and the quantities that these give."""

    inputs: Mapping[str, Input]
    scene: Scene
    values: Mapping[str, float]


class Fitted(NamedTuple):
    """The fit of the runs that are ``used``, and their outliers: the run of each, and words that name it.

    Something can be expected of all runs that are ``shown``; the others of these are left out. ``delay`` has
    what there is to say of a delay that is not fitted.
    """

    runs: Runs
    used: Selection
    shown: Selection
    given: Conditions
    whole: Estimate
    outliers: Sequence[tuple[int, str]]
    delay: Sequence[str]


# What is given, and what is to be fitted


def conditions_of(inputs: Mapping[str, Input]) -> Conditions:
    """Return the conditions that inputs give. Raises SceneError."""
    for x, one in inputs.items():
        if one.given is not None and not in_range(one):
            raise SceneError(x, one.given, OUT_OF_RANGE)
    masses = {f"m{i}": Input(Fraction(i), Fraction(0), None) for i in (1, 2)}  # any would do
    scene = Scene.of({**inputs, **masses})
    decided, values = Decisions(scene), {"gravity": float(scene.g)}
    if scene.axle is not None:
        values["axle"] = float(decided.axle_friction)
    if scene.M is not None or scene.I is not None:
        values["rim_mass"] = float(decided.rim_mass or 0)
    return Conditions(inputs, scene, values)


def _neighbours(given: Conditions) -> Iterator[list[Conditions]]:
    """Yield the conditions with each uncertain one less and more by its uncertainty. Raises SceneError."""
    for x, one in given.inputs.items():
        u, size = one.uncertainty, getattr(one.value, "number", one.value)
        if u and not parameter_of(x).may_be_zero and u >= size:
            raise SceneError(x, one.given, "has an uncertainty that reaches 0")
        if u:
            is_in_terms = isinstance(one.value, InTerms)
            ends = (one.value._replace(number=end) if is_in_terms else end for end in (size - u, size + u))
            yield [conditions_of({**given.inputs, x: Input(end, Fraction(0), one.given)}) for end in ends]


def read_find(words: Sequence[str], given: Conditions) -> list[str]:
    """Return the quantities to fit, by names or symbols; both usual ones unless given. Raises SceneError.

    None may be given, and of the usual ones none may be neither given nor fitted.
    """
    names = list(dict.fromkeys(read_names("find", words, FITTED, "quantity to fit", SYMBOLS)))
    for name in names:
        for known in QUANTITIES[name].given_by:
            if given.inputs[known].given is not None:
                rule = f"conflicts with {known}, which gives it; leave one of them out"
                raise SceneError("find", name, rule)
    left = [x for x in USUAL if x not in names and x not in given.values]
    if names and left:
        what, give = (" and ".join(words[x] for x in left) for words in (RESULTS, GIVE))
        rule = f"leaves {what} open: give {give}, or find {' and '.join(left)}, too"
        raise SceneError("find", ",".join(names), rule)
    return names or left


# From runs to a result


@np.errstate(all="ignore")  # what a step tries may be 0, or beyond doubles
def fitted(runs: Runs, given: Conditions, names: Sequence[str]) -> Fitted:
    """Return the fit of these quantities, and outliers. Raises SceneError, CannotSeparate."""
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
    try:
        whole = _fit(runs, used, given, names)
    except CannotSeparate as error:
        raise CannotSeparate(f"{error}{behind_an_error(remarks)}") from None
    odd = [*_outliers(runs, used, whole.data, whole.values, names)]
    odd = odd or _mistake(runs, used, whole.data, given.values["gravity"], names)
    return Fitted(runs, used, shown, given, whole, odd, _delay(runs, used, given, whole, bool(odd)))


def _fit(runs: Runs, used: Selection, given: Conditions, names: Sequence[str]) -> Estimate:
    """Return the fit of the runs that are used, with its results. Raises CannotSeparate."""
    if not used.any():
        raise CannotSeparate("no run can be used")
    data, count = as_data(runs, used), int(used.sum())
    what = [QUANTITIES[x].words for x in names]
    needed = len(names) + (not data.scatter.any() and not data.uncertain)
    if count < needed:
        why = f"{counted(count, 'run')} cannot determine {' and '.join(what)}"
        raise CannotSeparate(f"{why}: give {needed} or more")
    mistake = "".join(words for _, words in _mistake(runs, used, data, given.values["gravity"], names))
    if not _separates(data, given.values, names):
        verb, vary = "separate" if names[1:] else "determine", "vary both m2 - m1 and m1 + m2 more"
        raise CannotSeparate(mistake or f"the runs do not {verb} {' from '.join(what)}: {vary}")

    def odd(values: Mapping[str, float]) -> str:
        return "; ".join(words for _, words in _outliers(runs, used, data, values, names)) or CHECK

    def found(there: Conditions) -> dict[str, float]:
        drop = there.inputs.get("drop")
        moved = data._replace(drop=np.full(count, float(drop.value))) if drop else data
        return _with_derived(estimate(moved, there.values, names, best.values).values, names, there)

    try:
        best = estimate(data, given.values, names)
        ends = [[*map(found, pair)] for pair in _neighbours(given)]
    except (CannotSeparate, ZeroDivisionError):  # a gravity of 0 holds no axle
        raise CannotSeparate(mistake or f"{NO_FIT}: {odd(by_forces(data, given.values, names))}") from None
    by_runs = np.sqrt(best.line.scale * best.line.covariance.diagonal())
    spread = _with_derived(dict(zip(names, by_runs.tolist(), strict=True)), names, given)
    times = float(stdtrit(best.line.dof, 0.975))  # Student's t
    results = dict[str, Result]()
    for x, value in _with_derived(best.values, names, given).items():
        u = hypot(spread[x], *(float(np.ptp([value, *(end[x] for end in pair)])) / 2 for pair in ends))
        results[x] = Result(value, u, (value - times * u, value + times * u))
        if x in names and x != "delay" and results[x].interval[1] < 0:
            raise CannotSeparate(mistake or f"{equation(x, value, u)} is negative: {odd(best.values)}")
    return best._replace(results=results)


def _delay(runs: Runs, used: Selection, given: Conditions, whole: Estimate, odd: bool) -> list[str]:
    """Return a sentence if all times seem too long, or if sound runs cannot show that, none being ``odd``.

    An F test judges what a delay takes off χ². The repeats count in it, unless runs scatter more than they do
    with the delay, too.
    """
    if runs.kind != "time" or "delay" in whole.names:
        return []
    names, half, estimated = [*whole.names, "delay"], inf, ""
    if whole.dof > 1:
        with suppress(CannotSeparate):
            late = _fit(runs, used, given, names)
            value, u, (_, high) = late.results["delay"]
            rest, dof, taken_off = late.line.chi2, late.dof, max(whole.line.chi2 - late.line.chi2, 0)
            if late.p_value is not None and late.p_value >= SELDOM:
                rest, dof = rest + late.data.repeats[0], dof + late.data.repeats[1]
            if fdtrc(1, dof, taken_off / max(rest, TINY) * dof) < RARE:
                size, long = published(abs(value), u)[0], "long" if value > 0 else "short"
                also = " and may explain outliers" if odd else ", too"
                return [f"All times seem {size} s too {long}: --find {','.join(names)} fits that{also}."]
            half, estimated = high - value, f" (--find {','.join(names)} gives {published(value, u)[0]} s)"
    if half <= WIDE_DELAY or odd:
        return []
    said = f"It is open whether all times are too long by a delay{estimated}; the results assume none."
    return [f"{said} More heights of fall, or wider ranges of m2 - m1 and m1 + m2, would show it."]


def _with_derived(values: Mapping[str, float], names: Sequence[str], given: Conditions) -> dict[str, float]:
    """Return the fitted values, with what follows from the rim mass by R and by the shape, if given."""
    found = {x: values[x] for x in FITTED if x in names}
    if "rim_mass" in found:
        if given.inputs["inertia"].value is not None:
            found["pulley_mass"] = found["rim_mass"] / float(given.inputs["inertia"].value)
        if given.inputs["R"].value is not None:
            R = float(given.inputs["R"].value)
            found["moment_of_inertia"] = physics.moment_of_inertia(found["rim_mass"], R)
    return found


def _outliers(
    runs: Runs, used: Selection, data: Data, values: Mapping[str, float], names: Sequence[str]
) -> Iterator[tuple[int, str]]:
    """Yield outliers among the repeats of each run, and among the runs without these repeats, in words.

    Runs are judged by the line of forces, which outliers bend least.
    """
    here, counts = np.flatnonzero(used), np.bincount(runs.run)
    places = np.flatnonzero((used & (counts > 1))[runs.run])
    # Of two repeats, which are equally far from each other, that far from the line comes first.
    measured = (runs.sign[runs.run] * runs.values)[places]
    away = measured - expected(data, values)[np.searchsorted(here, runs.run[places])]
    places = places[np.argsort(-np.abs(away), kind="stable")]
    u = runs.u_values[places] if data.stated else np.ones(len(places))
    judge = judge_of_repeats(runs.values[places], u, runs.run[places], runs.step)
    kept = np.ones(len(runs.values), dtype=bool)
    for i, far in outliers(judge, len(places), len(places) - len({*runs.run[places]}), OUTLIER_LEVEL).items():
        kept[places[i]], cell = False, runs.cells[places[i]]
        value = f"{format_number(float(runs.values[places[i]]))} {parameter_of(runs.kind).unit}"
        others = "its repeats, by the scatter of the others"
        yield int(runs.run[places[i]]), _far(f"{in_words(cell)} = {value} is", far, others, cell)
    near = {**values, "rim_mass": max(values["rim_mass"], 0.0), "delay": 0.0}
    judge = judge_of_line(linear(of_forces, as_data(runs, used, kept), near, names))
    for i, far in outliers(judge, len(here), len(here) - len(names), OUTLIER_LEVEL).items():
        rows = runs.rows[here[i]]
        what = f"{runs.rows_in_words(here[i])} {'are' if rows[1:] else 'is'}"
        yield int(here[i]), _far(what, far, "a fit of the other runs", ",".join(map(str, rows)))


def _far(what: str, distance: float, others: str, where: str) -> str:
    """Say how many standard deviations something is from others, and how to leave it out."""
    far = f"{rounded(abs(distance))} standard deviations from {others}"
    return f"{what} {far}; if it is a mistake, leave it out: --without {where}"


# Why there is no result


def _separates(data: Data, given: Mapping[str, float], names: Sequence[str]) -> bool:
    """Decide if runs with these masses and heights determine the quantities, whatever was measured.

    The singular values of the slopes at a plausible pulley tell, each slope scaled to the length 1.
    """
    design = data._replace(measured=np.full_like(data.l, inf))
    least = float((data.h - data.l).min()) * given["gravity"]
    values = {"rim_mass": 0.1 * float(np.median(data.l + data.h)), "delay": 0.0, **given}
    values["axle"] = min(given.get("axle", least), 0.1 * least)  # with which each run moves
    J: Any = linear(of_measured, design, values, names).J / expected(design, values)[:, None]
    singular = np.linalg.svd(J / np.linalg.norm(J, axis=0), compute_uv=False)
    return bool(singular.min(initial=1.0) > LEAST_SINGULAR)


def _mistake(
    runs: Runs, used: Selection, data: Data, g: float, names: Sequence[str]
) -> list[tuple[int, str]]:
    """Return the first run that must have a mistake, in words. Raises CannotSeparate if most runs have one.

    Masses, heights and times are compared with the median of their kind. Accelerations, which may be small,
    are compared with those of free masses, unless gravity or a delay is fitted.
    """
    each = {x: c[used] for x, c in runs.given.items()} | ({} if runs.kind == "a" else {"time": data.measured})
    mass, ratios = np.median([data.l, data.h]), (1 / MOST_RATIO, MOST_RATIO)
    checks: list[tuple[str, str, Any, Any, tuple[float, float]]] = [
        (x, "the median", values, mass if x[0] == "m" else np.median(values), ratios)
        for x, values in each.items()
    ]
    if not {"gravity", "delay"} & {*names}:
        name = "a" if data.drop is None else "a = 2 drop/t²"
        free = physics.acceleration(data.h - data.l, data.h + data.l, g)
        what = "the acceleration without friction and pulley"
        checks.append((name, what, accelerations(data, data.measured), free, SHARES))
    said, is_mistaken = list[tuple[int, str]](), np.zeros(len(data.l), dtype=bool)
    for name, what, values, typical, (least, most) in checks:
        ratio = values / typical
        is_unusual = (values > 0) & ((ratio < least) | (ratio > most))
        is_mistaken |= is_unusual
        if is_unusual.any() and not said:
            i, unit = int(np.argmax(is_unusual)), parameter_of(name.split()[0]).unit
            value, times, there = (rounded(float(x), 3) for x in (values[i], ratio[i], values[i] / ratio[i]))
            far = f"{name} = {value} {unit} is {times} times {what}, {there} {unit}"
            run = int(np.flatnonzero(used)[i])
            said = [(run, f"{runs.rows_in_words(run)}: {far}; {CHECK}")]
    if is_mistaken.mean() > 0.5:
        raise CannotSeparate(said[0][1])
    return said
