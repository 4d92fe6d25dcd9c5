"""The fit of the pulley's inertia and its axle's friction to runs, and which runs are odd.

Both are always fitted where the runs can separate them: leaving one out falsifies the other. No run is left
out silently.
"""

from collections.abc import Mapping, Sequence
from fractions import Fraction
from itertools import combinations
from math import hypot, inf, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arithmetic.rounding import text
from ..arrays.tables import Column
from ..files import Unreadable
from ..model import physics
from ..model.axle import Axle
from ..model.case import Case
from ..model.motion import moved
from ..model.quantities import read_names
from ..model.scene import UNMEASURED, Input, Scene, SceneError
from .least_squares import Data, Estimate, estimate, expected_of
from .numbers import Result
from .probability import SURE, student_within
from .quantities import FITTED, QUANTITIES, SYMBOLS, USUAL
from .runs import BEYOND, Run, Runs, in_range
from .statistics import Alike, stray_repeats, stray_rows, sum_of_squares

SAME = 0.01
"""The spread of m1 + m2, as a share of it, below which it counts as constant."""
MOST_UNCERTAIN = {"rim_mass": 0.3, "gravity": 0.1}
"""The standard uncertainty, as a share of the load m1 + m2 + c and of g, up to which slopes give it."""
CHANCE = 0.03
"""The share of sound sets of which a repeat is said to be odd, and half of it where a run is."""
TOO_FEW = (
    "{} too few for what is to be fitted and its scatter: give more runs, or repeats, or uncertainties (as"
    " 2.05+/-0.02), or what is known (M, axle), or fit one quantity alone (find)"
)


class TooFew(ArithmeticError):
    """The runs are fewer than the quantities to be fitted."""


class Conditions(NamedTuple):
    """What is the same in all runs: inputs, values, and by how much each uncertain input changes these."""

    inputs: Mapping[str, Input]
    scene: Scene
    values: Mapping[str, float]
    changes: Sequence[Mapping[str, float]]


class Odd(NamedTuple):
    """What is odd about the runs used, by their indices, and the fit without it, where there is one.

    ``repeats`` are single measurements far from their siblings, ``rows`` runs far from what the others say,
    both with the distance in standard uncertainties; ``cannot`` are runs that physics forbids, and why.
    """

    repeats: Mapping[tuple[int, int], float] = {}
    rows: Mapping[int, float] = {}
    cannot: Mapping[int, str] = {}
    without: "Fitted | None" = None

    @property
    def runs(self) -> set[int]:
        """The runs that have anything odd."""
        return {*(i for i, _ in self.repeats), *self.rows, *self.cannot}


class Fitted(NamedTuple):
    """The best values, and how well the runs determine them.

    ``find`` are the quantities that the user asked for, none if the choice is left to the fit; then
    ``assumed`` says why the axle is taken to be free, if it is.
    """

    runs: Runs
    used: Sequence[Run]
    given: Conditions
    find: Sequence[str]
    data: Data
    estimate: Estimate
    assumed: str = ""
    odd: Odd = Odd()

    @property
    def dof(self) -> int:
        """Degrees of freedom: the runs less the fitted quantities."""
        return len(self.used) - len(self.estimate.names)

    @property
    def times(self) -> float:
        """The factor from a standard uncertainty to an interval of 95 %."""
        return student_within(SURE, self.dof or self.data.within)

    @property
    def values(self) -> dict[str, float]:
        """The fitted quantities."""
        return {name: self.estimate.values[name] for name in self.estimate.names}

    @property
    def sigma(self) -> Column:
        """The standard uncertainty of each run's measurement, by all that varies from run to run."""
        scaled: Column = self.estimate.linear.scale * np.sqrt(self.estimate.linear.variance)
        return scaled

    def uncertainty(self, name: str) -> float:
        """The standard uncertainty of a fitted quantity, with that of the conditions."""
        by_given, i = self.estimate.by_given, self.estimate.names.index(name)
        variance = self.estimate.uncertainty(name) ** 2
        for change in self.given.changes:
            variance += sum(by_given[x][i] * by for x, by in change.items() if x in by_given) ** 2
        return sqrt(variance)

    def significant(self, name: str) -> int:
        """The sign of a fitted quantity if its whole interval has it; else 0."""
        value, half = self.values[name], self.times * self.uncertainty(name)
        return (value > half) - (value < -half)

    @property
    def vague(self) -> bool:
        """Whether uncertainties are too large for slopes to give them: then there is no result."""
        least, values = float((self.data.l + self.data.h).min()), self.estimate.values
        sizes = {"rim_mass": least + values["rim_mass"], "gravity": abs(values["gravity"])}
        return any(
            self.estimate.uncertainty(x) > MOST_UNCERTAIN[x] * size
            for x, size in sizes.items()
            if x in self.estimate.names
        )

    @property
    def impossible(self) -> list[str]:
        """The quantities whose whole interval is negative, as no pulley, no axle and no gravity is."""
        return [name for name in self.estimate.names if self.significant(name) < 0]

    @property
    def too_fast(self) -> NDArray[np.bool_]:
        """Which runs are faster than a massless pulley without friction allows, be it by chance."""
        limit, _ = expected_of(self.data, {**self.estimate.values, "rim_mass": 0.0, "axle": 0.0}, [])
        return self.data.measured > limit if self.data.kind == "a" else self.data.measured < limit

    @property
    def void(self) -> bool:
        """Whether there is no result: beside an impossible pulley or gravity the friction means nothing."""
        return self.vague or self.impossible not in ([], ["axle"])

    @property
    def results(self) -> dict[str, Result]:
        """The fitted quantities that are possible.

        The moment of inertia follows if R is given, the pulley's mass if its shape is.
        """

        def result(value: float, u: float) -> Result:
            return Result(value, u, (value - self.times * u, value + self.times * u))

        names = [] if self.void else [x for x in FITTED if x in self.values and x not in self.impossible]
        results = {name: result(self.values[name], self.uncertainty(name)) for name in names}
        if c := results.get("rim_mass"):
            R, beta = self.given.inputs["R"], self.given.inputs["inertia"]
            if R.value is not None:
                r, u = float(R.value), float(R.uncertainty)
                spread = hypot(c.uncertainty * r * r, 2 * c.value * r * u)
                results = {
                    "moment_of_inertia": result(physics.moment_of_inertia(c.value, r), spread)
                } | results
            if beta.value is not None:
                mass, share = c.value / float(beta.value), float(beta.uncertainty / beta.value)
                results["pulley_mass"] = result(mass, hypot(c.uncertainty / float(beta.value), mass * share))
        return results

    @property
    def correlation(self) -> tuple[str, str, float] | None:
        """The most correlated pair of fitted quantities."""
        pairs = [(*pair, self.estimate.correlation(*pair)) for pair in combinations(self.estimate.names, 2)]
        return max(pairs, key=lambda pair: abs(pair[2]), default=None)

    @property
    def chi2(self) -> float | None:
        """χ² of the runs by the uncertainties given, or by the scatter of repeats; None without either."""
        return self.estimate.linear.chi2 if self.data.spread.any() else None

    @property
    def between_runs(self) -> float | None:
        """The standard deviation between runs beyond that, as a mass (kg); None where nothing shows it."""
        between = self.estimate.linear.between
        if between is None or not self.data.spread.any() or not self.dof:
            return None
        return sqrt(between) / abs(self.estimate.values["gravity"])


def conditions_of(inputs: Mapping[str, Input], runs: Runs) -> Conditions:
    """What is the same in all runs. Raises SceneError."""
    for x, one in inputs.items():
        if one.given is not None and one.value != inf and not in_range(one):
            raise SceneError(x, one.given, BEYOND)
    masses = {f"m{i}": Input(Fraction(i), Fraction(0), None) for i in (1, 2)}  # any would do
    scene = Scene.of({**inputs, **masses})
    case = Case(scene)
    values = {"gravity": float(scene.g)}
    if scene.M is not None or scene.I is not None:
        if case.rim_mass is None:
            why = "lets nothing move; give the mass of a pulley that turns"
            raise SceneError("M", inputs["M"].given, why)
        values["rim_mass"] = float(case.rim_mass)
    if scene.axle is not None:
        values["axle"] = float(case.axle_friction or 0)
    changes: list[Mapping[str, float]] = []
    drop = runs.runs[0].drop
    if runs.one_drop and drop is not None and drop.uncertainty:
        changes.append({"drop": float(drop.uncertainty)})
    for x, one in inputs.items():
        if one.uncertainty:
            beside = Case(moved(scene, UNMEASURED, x, 1)[0])
            of = {"gravity": beside.scene.g, "rim_mass": beside.rim_mass, "axle": beside.axle_friction}
            slopes = {name: getattr(value, "slope", None) for name, value in of.items() if name in values}
            changes.append({name: float(slope * one.uncertainty) for name, slope in slopes.items() if slope})
    return Conditions(inputs, scene, values, changes)


def read_find(words: Sequence[str], inputs: Mapping[str, Input]) -> list[str]:
    """The quantities to fit, by names or symbols; none of them may be given. Raises SceneError."""
    names = list(dict.fromkeys(read_names("find", words, FITTED, "quantity to fit", SYMBOLS)))
    for name in names:
        for given in QUANTITIES[name].given_by:
            if inputs[given].given is not None:
                raise SceneError("find", name, f"is known by {given}; leave one of them out")
    return names


def fitted(runs: Runs, given: Conditions, find: Sequence[str]) -> Fitted:
    """The fit of the inertia and the friction, or of just ``find``. Raises Unreadable, TooFew, Alike."""
    used = [run for run in runs.runs if not unusable(runs, run, given, find)]
    if not used:
        why = unusable(runs, runs.runs[0], given, find)
        raise Unreadable(f"no run can be used: in {runs.runs[0].name}, {why}")
    return _best(runs, used, given, find)


def _best(
    runs: Runs, used: Sequence[Run], given: Conditions, find: Sequence[str], judged: bool = True
) -> Fitted:
    """The fit of ``find``, or of both, or of the inertia alone where the runs determine no more.

    If ``judged`` it says what is odd about the runs.
    """
    data = as_data(runs, used)
    both = [x for x in USUAL if x not in given.values]
    choices = [find] if find else [both, both[:1]] if both[1:] else [both]
    assumed = ""
    for names in choices:
        try:
            fit = Fitted(runs, used, given, find, data, _estimate(data, used, given, names), assumed)
            fit = fit._replace(odd=_odd(fit)) if judged else fit
            if not fit.vague or fit.odd.without is not None:
                return fit
            raise Alike(undetermined(used, names))
        except (Alike, TooFew) as why:
            if names == choices[-1]:
                raise
            assumed = str(why)
    raise AssertionError


def _estimate(data: Data, used: Sequence[Run], given: Conditions, names: Sequence[str]) -> Estimate:
    dof = len(used) - len(names)
    if dof < 0 or not (dof or data.spread.any() or data.uncertain):
        raise TooFew(TOO_FEW.format(f"{len(used)} runs are" if used[1:] else "1 run is"))
    values: dict[str, float] = {"axle": 0.0, "rim_mass": 0.0, **given.values}
    try:
        return estimate(data, {x: value for x, value in values.items() if x not in names}, names)
    except Alike:
        raise Alike(undetermined(used, names)) from None


def _odd(fit: Fitted) -> Odd:
    """The repeats that are far from their siblings, then the runs that are far from the others."""
    values, u, index = _measured(fit.used)
    repeated = len(index) > len(fit.used)
    strays = stray_repeats(values, np.where(u > 0, u, 1), index, CHANCE) if repeated else {}
    first = np.searchsorted(index, index)
    repeats = {(int(index[i]), int(i - first[i])): away for i, away in strays.items()}
    for (i, k), away in list(repeats.items()):
        if len(fit.used[i].measured) == 2:  # which of them it is, nobody knows
            repeats[i, 1 - k] = -away
    kept = dict(enumerate(fit.used))
    for i in {i for i, _ in repeats}:
        kept[i] = kept[i].without({k for j, k in repeats if j == i})
    kept = {i: run for i, run in kept.items() if run.measured}
    clean = _without(fit, list(kept.values())) if repeats else fit
    rows: dict[int, float] = {}
    if clean is not None:
        best, numbers = clean.estimate, list(kept)
        rest = clean.data.measured - best.expected
        within = clean.data.within if clean.data.spread.any() else 0
        level = CHANCE / (1 + 2 * repeated)
        strays = stray_rows(best.slopes, rest, best.known, best.shape, within, level)
        rows = {numbers[i]: away for i, away in strays.items()}
    cannot = {i: why for i, run in enumerate(fit.used) if i not in rows and (why := _cannot(fit, run))}
    left = [run for i, run in kept.items() if i not in rows and i not in cannot]
    if rows or cannot:
        clean = _without(fit, left)
    return Odd(repeats, rows, cannot, clean) if repeats or rows or cannot else Odd()


def _without(fit: Fitted, left: Sequence[Run]) -> Fitted | None:
    """The same fit of other runs; None where they do not determine it."""
    try:
        return _best(fit.runs, left, fit.given, fit.find, judged=False) if left else None
    except (Alike, TooFew):
        return None


def _cannot(fit: Fitted, run: Run) -> str:
    """Why the string's friction forbids a run; empty if it does not."""
    scene, values, mu = fit.given.scene, fit.estimate.values, fit.given.scene.mu
    if mu is None or not run.m1.value or not run.m2.value or values["gravity"] <= 0:
        return ""
    c, f = (Fraction(max(values[x], 0.0)) for x in ("rim_mass", "axle"))
    scene = scene._replace(m1=run.m1.value, m2=run.m2.value, M=c, inertia=Fraction(1), I=None)
    if Case(scene._replace(g=Fraction(values["gravity"]), axle=Axle(f))).regime != "slip":
        return ""
    return f"the string would slip, as its mu = {text(float(mu))} is too small for these masses"


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


def _measured(used: Sequence[Run]) -> tuple[Column, Column, NDArray[np.intp]]:
    """All measurements, positive where the heavier side falls, their uncertainties, and the run of each."""
    index = np.repeat(np.arange(len(used)), [len(run.measured) for run in used])
    values, u = _columns([one for run in used for one in run.measured])
    return values * np.where(np.bincount(index, values) < 0, -1.0, 1.0)[index], u, index


def _columns(inputs: Sequence[Input]) -> tuple[Column, Column]:
    """The values of inputs, and their uncertainties."""
    values = np.array([float(one.value) for one in inputs])
    return values, np.array([float(one.uncertainty) for one in inputs])


def as_data(runs: Runs, used: Sequence[Run]) -> Data:
    """The runs as columns. Raises Unreadable where only some measurements have an uncertainty."""
    (m1, u1), (m2, u2) = _columns([run.m1 for run in used]), _columns([run.m2 for run in used])
    uncertain = {"l": np.where(m1 > m2, u2, u1), "h": np.where(m1 > m2, u1, u2)}
    drop = None
    if runs.kind == "time":
        drop, u_drop = _columns([run.drop for run in used if run.drop is not None])
        uncertain |= {} if runs.one_drop else {"drop": u_drop}
    values, u, index = _measured(used)
    times, within = np.bincount(index).astype(float), inf
    if u.any():
        if not u.all():
            name = used[int(index[np.argmin(u > 0)])].name
            raise Unreadable(f"{name} has no uncertainty of its {runs.kind}, as others have; give all")
        total = np.bincount(index, u**-2)
        measured, spread = np.bincount(index, values * u**-2) / total, np.sqrt(times / total)
    else:
        repeated = len(values) > len(used)
        measured = np.array([abs(run.mean) for run in used]) if repeated else values
        squares = sum_of_squares(values - measured[index])
        within = float(len(values) - len(used)) if squares else inf
        spread = np.full(len(used), sqrt(squares / within))
    uncertain = {name: some for name, some in uncertain.items() if some.any()}
    light, heavy = np.minimum(m1, m2), np.maximum(m1, m2)
    return Data(runs.kind, light, heavy, drop, measured, times, spread, within, uncertain)


def unusable(runs: Runs, run: Run, given: Conditions, find: Sequence[str]) -> str:
    """Why nothing can be expected of a run; empty if something can."""
    if run.left_out:
        return "it was left out"
    if run.m1.value == run.m2.value:
        return "its masses are equal, and rest"
    if not run.sign:
        return "nothing moved"
    if runs.signed and (run.sign > 0) != (run.m2.value > run.m1.value):
        return "the lighter side falls"
    if (f := given.values.get("axle")) is None or "gravity" in find:
        return ""
    if abs(float(run.m2.value - run.m1.value)) * given.values["gravity"] <= f:
        return "an axle with the friction given holds its masses"
    return ""
