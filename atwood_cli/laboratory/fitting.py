"""From runs to a result: values, uncertainties and outliers, or why there is none."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from fractions import Fraction
from itertools import combinations, compress
from math import hypot, inf, isfinite, sqrt
from typing import Any, NamedTuple

import numpy as np
from scipy.special import fdtrc, stdtrit

from ..model import physics
from ..model.decisions import Decisions
from ..model.quantities import read_names
from ..model.scene import Input, Scene, SceneError, parameter_of
from ..tables.sources import Unreadable
from .estimate import (
    Data,
    Estimate,
    accelerations,
    as_data,
    estimate,
    expected,
    line_of_forces,
    measurements,
    slopes,
    step_of,
)
from .results import FITTED, QUANTITIES, SYMBOLS, USUAL, Result, rounded, with_u
from .runs import BEYOND, Run, Runs, in_range
from .statistics import (
    NORMAL_DOF,
    CannotSeparate,
    fit_line,
    judge_of_line,
    judge_of_repeats,
    outliers,
    sum_of_squares,
)

OUTLIER_LEVEL = 0.012
"""The probability that a sound set has an outlier among its repeats, and that it has one among its runs."""
SAME = 0.01
"""The spread of m1 + m2, as a share of it, below which it counts as constant."""
LEAST_CHANGE = 2e-4
"""The least change of what is measured, as a share of it, by quantities as large as the masses and forces."""
FASTER, SLOWER, UNUSUAL = 1.02, 1e-4, 100
"""Ratios: accelerations to those without pulley and friction, and cells to the median, that are mistakes."""
TOO_FEW = (
    "{} too few for this fit: give more runs, repeats or uncertainties (as 2.05+/-0.02), or give M or axle{}"
)
GIVE = {"rim_mass": "M (or I and R)", "axle": "axle (0 if it has no friction)"}
"""What to give for a quantity that is neither given nor fitted."""
NEGATIVE = {
    "rim_mass": "the fit gives a negative rim mass, {} kg: check masses, heights and gravity, and whether"
    " something else drives the masses",
    "axle": "the fit gives a negative axle friction, {} N: check masses, and whether something else drives"
    " the masses",
    "gravity": "the fit gives a negative gravity, {} m/s²: check whether m1 and m2, or signs, are exchanged",
}
NOTHING_FITS = "no rim mass and no axle friction of 0 or more fit these runs: check masses, heights and units"


class Conditions(NamedTuple):
    """What is the same in all runs: inputs, with ``drop`` if that is, and the quantities that they give."""

    inputs: Mapping[str, Input]
    scene: Scene
    values: Mapping[str, float]


class Outcome(NamedTuple):
    """A fit of some runs: ``reason`` says why there are no ``results``, if there are none."""

    best: Estimate
    results: Mapping[str, Result]
    reason: str

    @property
    def chi2(self) -> float | None:
        """χ² of the runs by the uncertainties stated, or by the scatter of repeats; None without either."""
        return self.best.line.chi2 if self.best.data.scatter.any() else None

    @property
    def p_value(self) -> float | None:
        """The probability that chance gives a larger χ²; None if nothing is left to test the fit."""
        chi2, dof, data = self.chi2, self.best.dof, self.best.data
        if chi2 is None or not dof:
            return None
        return float(fdtrc(dof, NORMAL_DOF if data.stated else data.repeats[1] or NORMAL_DOF, chi2 / dof))

    @property
    def between_runs(self) -> float | None:
        """The standard deviation between runs beyond that, as a mass (kg); None where nothing shows it."""
        if self.chi2 is None or not self.best.dof:
            return None
        return sqrt(self.best.line.between) / abs(self.best.values["gravity"])

    @property
    def correlation(self) -> tuple[str, str, float] | None:
        """The most correlated pair of fitted quantities."""
        names, covariance = self.best.names, self.best.line.covariance
        u = np.sqrt(covariance.diagonal())
        of = covariance / np.outer(u, u)
        pairs = [(names[i], names[j], float(of[i, j])) for i, j in combinations(range(len(names)), 2)]
        return max(pairs, key=lambda pair: abs(pair[2]), default=None)


class Fitted(NamedTuple):
    """The fit of the runs that can be used, their outliers, and the fit without these.

    ``unusable`` says why other runs cannot be used, by their rows. ``cells`` are repeats far from the others
    of their run, by the index of the run and the place in it, ``rows`` runs far from the line of the others;
    both have the distance in standard deviations. ``without`` is None if nothing is odd, or if too few runs
    are left. ``delay`` is that of a fit with a delay, and the probability that chance lowers χ² as much (an
    F test); None if it was not tried or is not possible.
    """

    runs: Runs
    used: Sequence[Run]
    unusable: Mapping[tuple[int, ...], str]
    given: Conditions
    whole: Outcome
    cells: Mapping[tuple[int, int], float]
    rows: Mapping[int, float]
    without: Outcome | None
    delay: tuple[Result, float] | None

    @property
    def odd(self) -> list[int]:
        """The runs that have anything odd."""
        return sorted({*(i for i, _ in self.cells), *self.rows})

    @property
    def left_out(self) -> list[Run]:
        """The runs that the user leaves out and of which something can be expected, as if they were exact."""
        exact = Fraction(0)
        return [
            run._replace(measured=tuple(one._replace(uncertainty=exact) for one in run.measured))
            for run in self.runs.runs
            if run.left_out and run.mean and run.m1.value != run.m2.value
        ]


# What is given, and what is to be fitted


def conditions_of(inputs: Mapping[str, Input]) -> Conditions:
    """Return what is the same in all runs. Raises SceneError."""
    for x, one in inputs.items():
        if one.given is not None and one.value != inf and not in_range(one):
            raise SceneError(x, one.given, BEYOND)
    masses = {f"m{i}": Input(Fraction(i), Fraction(0), None) for i in (1, 2)}  # any would do
    scene = Scene.of({**inputs, **masses})
    case, values = Decisions(scene), {"gravity": float(scene.g)}
    if scene.axle is not None:
        values["axle"] = float(case.axle_friction or 0)
    if scene.M is not None or scene.I is not None:
        if case.rim_mass is None:
            why = "lets nothing move; give the mass of a pulley that turns"
            raise SceneError("M", inputs["M"].given, why)
        values["rim_mass"] = float(case.rim_mass)
    return Conditions(inputs, scene, values)


def _neighbours(given: Conditions) -> Iterator[list[Conditions]]:
    """Yield the conditions with each uncertain one less and more by its uncertainty. Raises SceneError."""
    for x, one in given.inputs.items():
        u, size = one.uncertainty, getattr(one.value, "number", one.value)
        if u and not parameter_of(x).zero and u >= size:
            raise SceneError(x, one.given, "has an uncertainty that reaches 0")
        ends = [one.value._replace(number=size + by) if x == "axle" else size + by for by in (-u, u) if u]
        if ends:
            yield [conditions_of({**given.inputs, x: Input(end, Fraction(0), one.given)}) for end in ends]


def read_find(words: Sequence[str], given: Conditions) -> list[str]:
    """Return the quantities to fit, by names or symbols; both usual ones unless given. Raises SceneError.

    None may be given, and of the usual ones none may be neither given nor fitted.
    """
    names = list(dict.fromkeys(read_names("find", words, FITTED, "quantity to fit", SYMBOLS)))
    for name in names:
        for known in QUANTITIES[name].given_by:
            if given.inputs[known].given is not None:
                raise SceneError("find", name, f"is known by {known}; leave one of them out")
    if not names:
        return [x for x in USUAL if x not in given.values]
    if left := [x for x in USUAL if x not in names and x not in given.values]:
        what, give, find = (" and ".join(map(of, left)) for of in (_words, GIVE.__getitem__, str))
        raise SceneError("find", ",".join(names), f"leaves {what} open: give {give}, or find {find}, too")
    return names


def _words(name: str) -> str:
    return QUANTITIES[name].words


# From runs to a result


def fitted(runs: Runs, given: Conditions, names: Sequence[str]) -> Fitted:
    """Return the fit of these quantities, and what is odd. Raises Unreadable, SceneError, CannotSeparate."""
    if "delay" in names and runs.kind != "time":
        raise SceneError("find", "delay", "needs times; the table has accelerations")
    reasons = {run.rows: why for run in runs.runs if (why := _unusable(runs, run, given, names))}
    used = [run for run in runs.runs if run.rows not in reasons]
    left_out = "".join(f"; {run.name}: {reasons[run.rows]}" for run in runs.runs if run.rows in reasons)
    if not used:
        raise Unreadable(f"no run can be used{left_out}")
    whole = outcome(runs, used, given, names, left_out)
    cells = _odd_cells(used, whole.best)
    sound = [run.without({k for j, k in cells if j == i}) for i, run in enumerate(used)]
    rows = _odd_rows(as_data(runs, sound), whole.best)
    without = delay = None
    with suppress(CannotSeparate):
        if cells or rows:
            usable = (i not in rows and not _unusable(runs, run, given, names) for i, run in enumerate(sound))
            without = outcome(runs, [*compress(sound, usable)], given, names)
    with suppress(CannotSeparate):
        if runs.kind == "time" and "delay" not in names and not whole.reason and whole.best.dof > 1:
            delay = _delay(whole.best, outcome(runs, used, given, [*names, "delay"]))
    return Fitted(runs, used, reasons, given, whole, cells, rows, without, delay)


def _delay(best: Estimate, late: Outcome) -> tuple[Result, float] | None:
    """Return the delay of a fit that has one, and the probability that chance lowers χ² as much."""
    if late.reason:
        return None
    data, sigma = best.data, late.best.sigma
    on_time, with_delay = (data.measured - expected(data, one.values) for one in (best, late.best))
    J, exact = slopes(data, best.values, best.names), np.zeros_like(sigma)
    chi2 = fit_line(J, on_time, sigma**2, exact + 1, exact).chi2 or 0.0
    lower = max(chi2 - sum_of_squares(with_delay / sigma), 0.0)
    return late.results["delay"], float(fdtrc(1, min(late.best.line.dof, NORMAL_DOF), lower))


def outcome(
    runs: Runs, used: Sequence[Run], given: Conditions, names: Sequence[str], left_out: str = ""
) -> Outcome:
    """Return the fit of these runs, with its uncertainties. Raises CannotSeparate."""
    dof = len(used) - len(names)
    too_few = TOO_FEW.format("1 run is" if len(used) == 1 else f"{len(used)} runs are", left_out)
    if dof < 0 or not used:
        raise CannotSeparate(too_few)
    data = as_data(runs, used)
    if not (dof or data.scatter.any() or data.uncertain):
        raise CannotSeparate(too_few)
    mistake, is_everywhere = _mistake(data, used, runs.kind, given.values["gravity"], "gravity" in names)
    if not _separates(data, given.values, names):
        raise CannotSeparate(mistake or undetermined(used, names))

    def found(there: Conditions) -> dict[str, float]:
        moved = as_data(runs, used, there.inputs.get("drop"))
        return _with_derived(estimate(moved, there.values, names, best.values).values, names, there)

    try:
        best = estimate(data, given.values, names)
        ends = [[*map(found, pair)] for pair in _neighbours(given)]
    except (CannotSeparate, ZeroDivisionError):  # a gravity of 0 holds no axle
        raise CannotSeparate(mistake or NOTHING_FITS) from None
    by_runs = np.sqrt(best.line.scale * best.line.covariance.diagonal())
    spread = _with_derived(dict(zip(names, by_runs.tolist(), strict=True)), names, given)
    times = float(stdtrit(min(best.line.dof, NORMAL_DOF), 0.975))  # Student's t
    results = dict[str, Result]()
    for x, value in _with_derived(best.values, names, given).items():
        steps = (float(np.ptp([value, *(end[x] for end in pair)])) / 2 for pair in ends)
        u = hypot(spread[x], *steps)
        results[x] = Result(value, u, (value - times * u, value + times * u))
    if not all(isfinite(one.value) and isfinite(one.uncertainty) for one in results.values()):
        raise CannotSeparate(mistake or NOTHING_FITS)
    negative = [x for x in names if x in NEGATIVE and results[x].interval[1] < 0]
    if is_everywhere:
        return Outcome(best, {}, mistake)
    if negative:
        x = negative[0]
        return Outcome(best, {}, mistake or NEGATIVE[x].format(with_u(*results[x][:2])))
    return Outcome(best, results, "")


def _with_derived(values: Mapping[str, float], names: Sequence[str], given: Conditions) -> dict[str, float]:
    """Return the fitted values, with what follows from the rim mass by R and by the shape, if given."""
    found = {x: values[x] for x in names}
    if "rim_mass" in found:
        if given.inputs["inertia"].value is not None:
            found["pulley_mass"] = found["rim_mass"] / float(given.inputs["inertia"].value)
        if given.inputs["R"].value is not None:
            R = float(given.inputs["R"].value)
            found["moment_of_inertia"] = physics.moment_of_inertia(found["rim_mass"], R)
    return {x: found[x] for x in QUANTITIES if x in found}


def _odd_cells(used: Sequence[Run], best: Estimate) -> dict[tuple[int, int], float]:
    """Return repeats far from the others of their run, by the index of the run and the place in it."""
    values, u, index = measurements(used)
    # Of two repeats, which are equally far from each other, that far from the line comes first.
    order = np.argsort(-np.abs(values - expected(best.data, best.values)[index]), kind="stable")
    step = step_of([one for run in used for one in run.measured])
    judge = judge_of_repeats(values[order], np.where(u > 0, u, 1)[order], index[order], step)
    judged = int((np.bincount(index)[index] > 1).sum())
    found = outliers(len(values) - len(used), judged, len(values), OUTLIER_LEVEL, judge)
    first = np.searchsorted(index, index)
    return {(int(index[j]), int(j - first[j])): away for i, away in found.items() for j in [order[i]]}


def _odd_rows(data: Data, best: Estimate) -> Mapping[int, float]:
    """Return the runs far from the straight line of forces, which outliers bend least."""
    J, y, known, shape, least = line_of_forces(data, best.values, best.names)
    judge = judge_of_line(J, y, known, shape, least, data.repeats)
    return outliers(best.dof, len(data.l), len(data.l), OUTLIER_LEVEL, judge)


# Why there is no result


def _unusable(runs: Runs, run: Run, given: Conditions, names: Sequence[str]) -> str:
    """Return why nothing can be expected of a run; empty if something can."""
    difference = float(run.m2.value - run.m1.value)
    held = 0.0 if "gravity" in names else given.values.get("axle", 0.0) / given.values["gravity"]
    reasons = {
        "it was left out, as asked": run.left_out,
        "the masses are equal": not difference,
        "nothing moved": not run.mean,
        "the lighter side falls": runs.signed and (run.mean > 0) != (difference > 0),
        "an axle with the friction given holds the masses": abs(difference) <= held,
    }
    return next((why for why, holds in reasons.items() if holds), "")


def _separates(data: Data, given: Mapping[str, float], names: Sequence[str]) -> bool:
    """Decide if runs with these masses and heights determine the quantities, whatever was measured.

    Quantities as large as the masses and forces at hand, in any combination, must change what a plausible
    pulley lets expect by more than ``LEAST_CHANGE``: the singular values of the slopes tell.
    """
    design = data._replace(measured=np.full_like(data.l, inf))
    sizes = {
        "rim_mass": float(np.median(data.l + data.h)),
        "axle": float(np.median(data.h - data.l)) * given["gravity"],
        "gravity": given["gravity"],
    }
    least = float((data.h - data.l).min()) * given["gravity"]
    values = {"rim_mass": 0.1 * sizes["rim_mass"], **given}
    values["axle"] = min(given.get("axle", least), 0.1 * least)  # with which each run moves
    ideal = expected(design, values)
    sizes["delay"] = float(np.median(ideal))
    J: Any = slopes(design, values, names) / ideal[:, None] * [sizes[x] for x in names]
    singular = np.linalg.svd(J, compute_uv=False)
    return not names or bool(singular.min() > LEAST_CHANGE * sqrt(len(ideal)))


def undetermined(used: Sequence[Run], names: Sequence[str]) -> str:
    """Return that the runs do not determine these, and what to vary."""
    verb = "separate" if names[1:] else "determine"
    return f"the runs do not {verb} {' from '.join(map(_words, names))}: {to_vary(used)}"


def to_vary(used: Sequence[Run]) -> str:
    """Return what other runs should vary, so that they determine more."""
    sums, differences = ([float(abs(run.m2.value + sign * run.m1.value)) for run in used] for sign in (1, -1))
    same_sum, same_difference = (max(some) - min(some) < SAME * max(some) for some in (sums, differences))
    if same_sum and same_difference:
        return "vary m2 - m1, and m1 + m2"
    return "vary m1 + m2 as well" if same_sum else "vary m2 - m1 more, and m1 + m2"


def _mistake(data: Data, used: Sequence[Run], kind: str, gravity: float, is_fitted: bool) -> tuple[str, bool]:
    """Return what must be a mistake in the table, if anything, and if most runs are impossible by it."""
    free: Any = physics.acceleration(data.h - data.l, data.h + data.l, np.float64(gravity))
    a, is_time = accelerations(data, data.measured), data.drop is not None
    scatter = data.scatter / data.measured * (2 if is_time else 1)
    too_fast, too_slow = a > free * np.maximum(FASTER, 1 + 3 * scatter), a < SLOWER * free
    impossible = (too_fast | too_slow) & (not is_fitted)
    is_most = bool(impossible.mean() > 0.5)
    if sides := _unusual_sides(used):
        return sides, True
    if unit := _unusual_cell(used, kind):
        return unit, is_most
    if not impossible.any():
        return "", False
    i = int(np.argmax(impossible))
    limit = f"{rounded(float(free[i]), 3)}, what no friction and no pulley would give"
    compared = f"{'more than' if too_fast[i] else 'not a ten-thousandth of'} {limit}"
    said = f"a = {rounded(float(a[i]), 3)} m/s²"
    if is_time:
        time = rounded(float(data.measured[i]), 3)
        check = "check the height of fall, the masses and their units"
        return f"{used[i].name}: t = {time} s is {said}, which is {compared}; {check}", is_most
    return f"{used[i].name}: {said} is {compared}; check its unit, and the masses", is_most


def _unusual_sides(used: Sequence[Run]) -> str:
    """Return that m1 is a hundred times above or below m2; empty if it is not."""
    m1, m2 = np.median([[float(run.m1.value), float(run.m2.value)] for run in used], 0).tolist()
    return f"m1 is about {rounded(m1 / m2)} times m2: check their units" if _is_unusual(m1, m2) else ""


def _unusual_cell(used: Sequence[Run], kind: str) -> str:
    """Return that a cell is a hundred times above or below the median of its column; empty if none is."""
    columns: dict[str, list[float]] = {
        "m1": [float(run.m1.value) for run in used],
        "m2": [float(run.m2.value) for run in used],
        "drop": [float(run.drop.value) if run.drop else 0.0 for run in used],
        kind: [abs(run.mean) for run in used],
    }
    for name, column in columns.items():
        median = float(np.median(column))
        for run, value in zip(used, column, strict=True):
            if _is_unusual(value, median):
                unit, times = parameter_of(name).unit, f"{rounded(value / median)} times"
                compared = f"{times} the median of its column, {rounded(median, 3)} {unit}"
                return f"{run.name}: {name} = {rounded(value, 3)} {unit} is {compared}; check its unit"
    return ""


def _is_unusual(value: float, usual: float) -> bool:
    return bool(value and usual) and not 1 / UNUSUAL < value / usual < UNUSUAL
