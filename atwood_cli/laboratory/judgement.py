"""What a fit of runs gives, with its uncertainties, and which runs are odd. No run is left out silently."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from fractions import Fraction
from itertools import combinations
from math import hypot, inf, sqrt
from typing import NamedTuple

import numpy as np
from scipy.special import fdtrc, stdtrit

from ..model import physics
from ..model.case import Case
from ..model.quantities import read_names
from ..model.scene import Input, Scene, SceneError, parameter_of
from ..tables.sources import Unreadable
from .fitting import Estimate, accelerations, as_data, estimate, expected, measurements, slopes, variances
from .published import FITTED, QUANTITIES, SYMBOLS, USUAL, Result, few, shown
from .runs import BEYOND, Run, Runs, in_range
from .statistics import NORMAL, Alike, Column, stray_repeats, stray_rows

SAME = 0.01
"""The spread of m1 + m2, as a share of it, below which it counts as constant."""
MOST_UNCERTAIN = {"rim_mass": 1.0, "gravity": 0.3}
"""The standard uncertainty, as a share of the load m1 + m2 + c and of g, up to which slopes give it."""
CHANCE = 0.015
"""The share of sound sets of which a run is said to be odd; of repeats, and then of runs a third of it."""
FAR = 3.0
"""Standard uncertainties by which most runs are faster than possible."""
TOO_FEW = (
    "{} too few for what is to be fitted and its scatter: give more runs, or repeats, or uncertainties (as"
    " 2.05+/-0.02), or what is known (M, axle), or fit one quantity alone (find)"
)
TOO_FAST = (
    "in {} the acceleration is {} m/s², and with neither pulley nor friction it is {} m/s²: check {}the"
    " masses and their units"
)
NONE_SUCH = {
    "rim_mass": "the runs would need a pulley of {} kg at its rim, and there is none: masses, heights or"
    " gravity are not what they are said to be, or something drives the masses",
    "axle": "the runs would need an axle with a friction of {} N, and there is none: there is more mass on"
    " the heavier side than the table says, or something drives the masses",
    "gravity": "the runs would need a gravity of {} m/s²: m1 and m2, or the sign of a, change places",
}


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
        chi2, dof = self.chi2, self.best.dof
        if chi2 is None or not dof:
            return None
        return float(fdtrc(dof, min(self.best.data.within, NORMAL), chi2 / dof))

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
        of = covariance / np.sqrt(np.outer(covariance.diagonal(), covariance.diagonal()))
        pairs = [(names[i], names[j], float(of[i, j])) for i, j in combinations(range(len(names)), 2)]
        return max(pairs, key=lambda pair: abs(pair[2]), default=None)


class Fitted(NamedTuple):
    """The fit of the runs that can be used, what is odd about them, and the fit without that.

    ``unusable`` says why other runs cannot be used, by their rows. ``repeats`` are runs with a measurement
    far from its siblings, which is given, ``rows`` runs far from what the others say: by their indices, with
    the distance in standard uncertainties. ``without`` is None where nothing is odd, or where too few runs
    are left.
    """

    runs: Runs
    used: Sequence[Run]
    unusable: Mapping[tuple[int, ...], str]
    given: Conditions
    whole: Outcome
    repeats: Mapping[int, tuple[float, float]]
    rows: Mapping[int, float]
    without: Outcome | None

    @property
    def odd(self) -> list[int]:
        """The runs that have anything odd."""
        return sorted({*self.repeats, *self.rows})


def conditions_of(inputs: Mapping[str, Input]) -> Conditions:
    """What is the same in all runs. Raises SceneError."""
    for x, one in inputs.items():
        if one.given is not None and one.value != inf and not in_range(one):
            raise SceneError(x, one.given, BEYOND)
    masses = {f"m{i}": Input(Fraction(i), Fraction(0), None) for i in (1, 2)}  # any would do
    scene = Scene.of({**inputs, **masses})
    case, values = Case(scene), {"gravity": float(scene.g)}
    if scene.axle is not None:
        values["axle"] = float(case.axle_friction or 0)
    if scene.M is not None or scene.I is not None:
        if case.rim_mass is None:
            why = "lets nothing move; give the mass of a pulley that turns"
            raise SceneError("M", inputs["M"].given, why)
        values["rim_mass"] = float(case.rim_mass)
    return Conditions(inputs, scene, values)


def _neighbours(given: Conditions) -> Iterator[list[Conditions]]:
    """The conditions with each uncertain one less and more by its uncertainty. Raises SceneError."""
    for x, one in given.inputs.items():
        u, size = one.uncertainty, getattr(one.value, "number", one.value)
        if u and not parameter_of(x).zero and u >= size:
            raise SceneError(x, one.given, "has an uncertainty that reaches 0")
        ends = [one.value._replace(number=size + by) if x == "axle" else size + by for by in (-u, u) if u]
        if ends:
            yield [conditions_of({**given.inputs, x: Input(end, Fraction(0), one.given)}) for end in ends]


def read_find(words: Sequence[str], inputs: Mapping[str, Input]) -> list[str]:
    """The quantities to fit, by names or symbols; none of them may be given. Raises SceneError."""
    names = list(dict.fromkeys(read_names("find", words, FITTED, "quantity to fit", SYMBOLS)))
    for name in names:
        for given in QUANTITIES[name].given_by:
            if inputs[given].given is not None:
                raise SceneError("find", name, f"is known by {given}; leave one of them out")
    return names


def fitted(runs: Runs, given: Conditions, find: Sequence[str]) -> Fitted:
    """The fit of both usual quantities, or of just ``find``, and what is odd. Raises Unreadable, Alike."""
    reasons = {run.rows: why for run in runs.runs if (why := _unusable(runs, run, given, find))}
    used = [run for run in runs.runs if run.rows not in reasons]
    if not used:
        raise Unreadable(f"no run can be used: in {runs.runs[0].name}, {next(iter(reasons.values()))}")
    names = find or [x for x in USUAL if x not in given.values]
    whole = outcome(runs, used, given, names)
    values, u, index = measurements(used)
    repeats = dict[int, tuple[float, float]]()
    for i, away in stray_repeats(values, np.where(u > 0, u, 1), index, CHANCE).items():
        repeats.setdefault(int(index[i]), (float(values[i]), away))
    left, rows, without = [i for i in range(len(used)) if i not in repeats], dict[int, float](), None
    if left:
        data, best = as_data(runs, [used[i] for i in left]), whole.best
        rest, J = data.measured - expected(data, best.values), slopes(data, best.values, names)
        level = CHANCE / (1 + 2 * (data.times.max() > 1))
        strays = stray_rows(J, rest, *variances(data, best.values), data.within, level)
        rows = {left[i]: away for i, away in strays.items()}
    if repeats or rows:
        with suppress(Alike):
            without = outcome(runs, [used[i] for i in left if i not in rows], given, names)
    return Fitted(runs, used, reasons, given, whole, repeats, rows, without)


def outcome(runs: Runs, used: Sequence[Run], given: Conditions, names: Sequence[str]) -> Outcome:
    """The fit of these runs, with its uncertainties. Raises Alike."""
    data, dof = as_data(runs, used), len(used) - len(names)
    if dof < 0 or not (dof or data.scatter.any() or data.uncertain):
        raise Alike(TOO_FEW.format(f"{len(used)} runs are" if used[1:] else "1 run is"))

    def found(there: Conditions) -> dict[str, float]:
        moved = as_data(runs, used, there.inputs.get("drop"))
        return _with_derived(estimate(moved, there.values, names, best.values).values, names, there)

    try:
        best = estimate(data, given.values, names)
        ends = [[*map(found, pair)] for pair in _neighbours(given)]
    except Alike:
        raise Alike(undetermined(used, names)) from None
    by_runs = np.sqrt(best.line.scale * best.line.covariance.diagonal())
    spread = _with_derived(dict(zip(names, by_runs.tolist(), strict=True)), names, given)
    times = float(stdtrit(min(dof or data.within, NORMAL), 0.975))  # Student's t
    results = dict[str, Result]()
    for x, value in _with_derived(best.values, names, given).items():
        steps = (float(np.ptp([value, *(end[x] for end in pair)])) / 2 for pair in ends)
        u = hypot(spread[x], *steps)
        results[x] = Result(value, u, (value - times * u, value + times * u))
    reason = _why_not(best, results, used)
    return Outcome(best, {} if reason else results, reason)


def _with_derived(values: Mapping[str, float], names: Sequence[str], given: Conditions) -> dict[str, float]:
    """The fitted values, with what follows from the rim mass: by R if that is given, and by the shape."""
    found = {x: values[x] for x in names}
    if "rim_mass" in found:
        if given.inputs["inertia"].value is not None:
            found["pulley_mass"] = found["rim_mass"] / float(given.inputs["inertia"].value)
        if given.inputs["R"].value is not None:
            R = float(given.inputs["R"].value)
            found["moment_of_inertia"] = physics.moment_of_inertia(found["rim_mass"], R)
    return {x: found[x] for x in QUANTITIES if x in found}


def beyond(best: Estimate) -> tuple[Column, Column]:
    """What would be measured with neither pulley nor friction; by how many u each run is faster than that."""
    free = expected(best.data, {**best.values, "rim_mass": 0.0, "axle": 0.0})
    return free, (best.data.measured - free) * (1 if best.data.drop is None else -1) / best.sigma


def _why_not(best: Estimate, results: Mapping[str, Result], used: Sequence[Run]) -> str:
    """Why there is no result; empty if there is one."""
    data, (free, faster) = best.data, beyond(best)
    if "gravity" not in best.names and np.median(faster) > FAR:
        i = int(np.argmax(faster))
        a, most = (few(float(accelerations(data, x)[i]), 3) for x in (data.measured, free))
        return TOO_FAST.format(used[i].name, a, most, "the height of fall, " * (data.drop is not None))
    sizes = {
        "rim_mass": float((data.l + data.h).min()) + best.values["rim_mass"],
        "gravity": best.values["gravity"],
    }
    for x in [x for x in MOST_UNCERTAIN if x in best.names]:
        if results[x].uncertainty > MOST_UNCERTAIN[x] * abs(sizes[x]):
            return undetermined(used, best.names)
    for x in [x for x in best.names if results[x].interval[1] < 0]:
        return NONE_SUCH[x].format(shown(*results[x][:2]))
    return ""


def undetermined(used: Sequence[Run], names: Sequence[str]) -> str:
    """That the runs do not determine these, and what to vary."""
    verb, words = "separate" if names[1:] else "determine", (QUANTITIES[x].words for x in names)
    return f"the runs do not {verb} {' from '.join(words)}: {to_vary(used)}"


def to_vary(used: Sequence[Run]) -> str:
    """What other runs should vary, so that they determine more."""
    sums, differences = ([float(abs(run.m2.value + sign * run.m1.value)) for run in used] for sign in (1, -1))
    same_sum, same_difference = (max(some) - min(some) < SAME * max(some) for some in (sums, differences))
    if same_sum and same_difference:
        return "vary m2 - m1, and m1 + m2"
    return "vary m1 + m2 as well" if same_sum else "vary m2 - m1 more, and m1 + m2"


def _unusable(runs: Runs, run: Run, given: Conditions, find: Sequence[str]) -> str:
    """Why nothing can be expected of a run; empty if something can."""
    mean, difference = run.mean, float(run.m2.value - run.m1.value)
    held = 0.0 if "gravity" in find else given.values.get("axle", 0.0) / given.values["gravity"]
    reasons = {
        "it was left out": run.left_out,
        "the masses are equal, and rest": not difference,
        "nothing moved": not mean,
        "the lighter side falls": runs.signed and (mean > 0) != (difference > 0),
        "an axle with the friction given holds the masses": abs(difference) <= held,
    }
    return next((why for why, holds in reasons.items() if holds), "")
