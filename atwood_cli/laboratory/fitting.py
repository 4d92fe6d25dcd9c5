"""What runs require: the pulley's inertia and the friction of its axle, and which runs are odd.

Both are always fitted where the runs can tell them apart: one that is left out falsifies the other. Nothing
is left out of the runs silently.
"""

from collections.abc import Mapping, Sequence
from fractions import Fraction
from math import inf, sqrt
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
from ..model.scene import UNMEASURED, Input, Scene, SceneError
from ..model.units import nearest
from .least_squares import Data, Estimate, estimate
from .probability import SURE, student_within
from .runs import BEYOND, Run, Runs, in_range
from .statistics import Alike, stray_repeats, stray_rows, sum_of_squares

FOUND = ("rim_mass", "axle", "gravity")
"""What may be fitted."""
SYMBOLS = {"g": "gravity", "c": "rim_mass", "f": "axle"}
GIVEN = {"rim_mass": ("M", "I"), "axle": ("axle",), "gravity": ("g",)}
"""The inputs by which they are known."""
WORDS = {"rim_mass": "the pulley's inertia", "axle": "axle friction", "gravity": "gravity"}
SAME = 0.01
"""The spread of m1 + m2, as a share of it, below which it is as good as constant."""
SMALL = {"rim_mass": 0.3, "gravity": 0.1}
"""The standard uncertainty as a share, of the load m1 + m2 + c and of g, up to which slopes tell it."""
CHANCE = 0.03
"""The share of sound sets of which a repeat is said to be odd, and half of it where a run is."""
TOO_FEW = (
    "{} too few for what is to be fitted and its scatter: give more runs, or repeats, or uncertainties (as"
    " 2.05+/-0.02), or what is known (--M, --axle), or name one thing to --find"
)


class TooFew(ArithmeticError):
    """The runs are fewer than what is to be fitted."""


class Known(NamedTuple):
    """What is known of all runs: values by name, and what each uncertain input changes in them."""

    scene: Scene
    values: Mapping[str, float]
    changes: Sequence[Mapping[str, float]]


class Line(NamedTuple):
    """A run beside what is expected of it; the residual in standard uncertainties, if those are known."""

    run: Run
    measured: float
    expected: float | None
    uncertainty: float | None
    residual: float | None


class Odd(NamedTuple):
    """What is odd about the runs used, by their indices, and the fit without it, if it can be had.

    ``repeats`` are single measurements far from their siblings, ``rows`` runs far from what the others say,
    both with the distance in standard uncertainties; ``cannot`` are runs that physics forbids, and why.
    """

    repeats: Mapping[tuple[int, int], float] = {}
    rows: Mapping[int, float] = {}
    cannot: Mapping[int, str] = {}
    without: "Fit | None" = None

    @property
    def runs(self) -> set[int]:
        """The runs that have anything odd."""
        return {*(i for i, _ in self.repeats), *self.rows, *self.cannot}


class Fit(NamedTuple):
    """What was found, and how well.

    ``asked`` says that it was said what to find, and ``assumed``, if it was not, why the axle is taken to
    be free.
    """

    runs: Runs
    used: Sequence[Run]
    known: Known
    data: Data
    estimate: Estimate
    asked: bool
    assumed: str = ""
    odd: Odd = Odd()

    @property
    def dof(self) -> int:
        """Degrees of freedom: the runs less what is fitted."""
        return len(self.used) - len(self.estimate.found)

    @property
    def times(self) -> float:
        """The factor from a standard uncertainty to an interval of 95 %."""
        return student_within(SURE, self.dof or self.data.within)

    @property
    def values(self) -> dict[str, float]:
        return {name: self.estimate.values[name] for name in self.estimate.found}

    @property
    def sigma(self) -> Column:
        """The standard uncertainty of each run's measurement, by all that varies from run to run."""
        scaled: Column = self.estimate.linear.scale * np.sqrt(self.estimate.linear.variance)
        return scaled

    def uncertainty(self, name: str) -> float:
        """The standard uncertainty of what was found, with that of what is known."""
        by_known, i = self.estimate.by_known, self.estimate.found.index(name)
        variance = self.estimate.uncertainty(name) ** 2
        for change in self.known.changes:
            variance += sum(by_known[x][i] * by for x, by in change.items() if x in by_known) ** 2
        return sqrt(variance)

    def significant(self, name: str) -> int:
        """The sign of what was found if its interval has no other; else 0."""
        value, half = self.values[name], self.times * self.uncertainty(name)
        return (value > half) - (value < -half)

    @property
    def vague(self) -> bool:
        """Whether slopes do not tell the uncertainties, as these are not small: then there is no result."""
        least, values = float((self.data.l + self.data.h).min()), self.estimate.values
        sizes = {"rim_mass": least + values["rim_mass"], "gravity": abs(values["gravity"])}
        found = [x for x in sizes if x in self.estimate.found]
        return any(self.estimate.uncertainty(x) > SMALL[x] * sizes[x] for x in found)

    @property
    def impossible(self) -> list[str]:
        """What is negative beyond its interval, as no pulley, no axle and no gravity is."""
        return [name for name in self.estimate.found if self.significant(name) < 0]

    @property
    def void(self) -> bool:
        """Whether there is no result: friction is none beside a pulley, or a gravity, that cannot be."""
        return self.vague or self.impossible not in ([], ["axle"])

    @property
    def correlation(self) -> tuple[str, str, float] | None:
        """The most correlated pair of what was found."""
        found = self.estimate.found
        pairs = [
            (one, other, self.estimate.correlation(one, other))
            for i, one in enumerate(found)
            for other in found[i + 1 :]
        ]
        return max(pairs, key=lambda pair: abs(pair[2]), default=None)

    @property
    def chi2(self) -> float | None:
        """χ² of the runs by the uncertainties given, or by the scatter of repeats; None without either."""
        return self.estimate.linear.chi2 if self.data.spread.any() else None

    @property
    def between_runs(self) -> float | None:
        """The standard deviation between runs beside that, as a mass (kg); None where nothing tells it."""
        between = self.estimate.linear.between
        if between is None or not self.data.spread.any() or not self.dof:
            return None
        return sqrt(between) / abs(self.estimate.values["gravity"])

    def too_fast(self, i: int) -> bool:
        """Whether a run is faster than a massless pulley without friction allows, be it by chance."""
        data, g, none = self.data, np.float64(self.estimate.values["gravity"]), np.float64(0)
        l, h, a = data.l[i], data.h[i], data.measured[i]
        limit = physics.acceleration(physics.drive(l, h, none), physics.load(l, h, none), g)
        if data.kind == "time" and data.drop is not None:
            a = physics.acceleration_of_fall(data.drop[i], a)
        return bool(a > limit)

    @property
    def lines(self) -> list[Line]:
        """Run by run, those that could not be used without what is expected."""
        columns = (self.data.measured, self.estimate.expected, self.sigma)
        here = {run.rows: one for run, *one in zip(self.used, *(c.tolist() for c in columns), strict=True)}
        lines = []
        for run in self.runs.runs:
            if run.rows not in here:
                lines.append(Line(run, run.mean, None, None, None))
                continue
            measured, ideal, u = here[run.rows]
            sign = -1 if run.sign < 0 else 1
            residual = sign * (measured - ideal) / u if u else None
            lines.append(Line(run, sign * measured, sign * ideal, u, residual))
        return lines


def known_of(inputs: Mapping[str, Input], runs: Runs) -> Known:
    """What options say of all runs; the masses are none of it. Raises SceneError."""
    for x, one in inputs.items():
        if one.given is not None and one.value != inf and not in_range(one):
            raise SceneError(x, one.given, BEYOND)
    masses = {f"m{i}": Input(Fraction(i), Fraction(0), None) for i in (1, 2)}  # no matter which
    scene = Scene.of({**inputs, **masses})
    case = Case(scene)
    values = {"gravity": float(scene.g)}
    if scene.M is not None or scene.I is not None:
        if case.rim_mass is None:
            raise SceneError(
                "M", inputs["M"].given, "lets nothing move; give the mass of a pulley that turns"
            )
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
    return Known(scene, values, changes)


def to_find(words: Sequence[str], inputs: Mapping[str, Input]) -> list[str]:
    """What is to be found, by names or symbols, of which each must be unknown. Raises SceneError."""
    names = list(dict.fromkeys(SYMBOLS.get(word, word) for word in words))
    for name in names:
        if name not in FOUND:
            rule = nearest(str(name), FOUND) or f"; there are {', '.join(FOUND)}"
            raise SceneError("find", name, f"is nothing to fit{rule}")
        for given in GIVEN[name]:
            if inputs[given].given is not None:
                raise SceneError("find", name, f"is known by {given}; leave one of them out")
    return names


def fitted(runs: Runs, known: Known, find: Sequence[str]) -> Fit:
    """The fit of both, or of just what is to be found, and what is odd; Unreadable, TooFew, Alike."""
    used = [run for run in runs.runs if not unusable(runs, run, known, find)]
    if not used:
        why = unusable(runs, runs.runs[0], known, find)
        raise Unreadable(f"no run can be used: in {runs.runs[0].name}, {why}")
    return _required(runs, used, known, find)


def _required(runs: Runs, used: Sequence[Run], known: Known, find: Sequence[str], judged: bool = True) -> Fit:
    """The fit of what is to be found, or of both, or of the inertia alone where the runs tell no more."""
    both = [x for x in FOUND[:2] if x not in known.values]
    choices = [find] if find else [both, both[:1]] if both[1:] else [both]
    assumed = ""
    for found in choices:
        try:
            fit = _fit(runs, used, known, found, bool(find))._replace(assumed=assumed)
            fit = fit._replace(odd=_odd(fit)) if judged else fit
            if not fit.vague or fit.odd.without is not None:
                return fit
            raise Alike(not_told(used, found))
        except (Alike, TooFew) as why:
            if found == choices[-1]:
                raise
            assumed = str(why)
    raise AssertionError


def _fit(runs: Runs, used: Sequence[Run], known: Known, found: Sequence[str], asked: bool) -> Fit:
    data = as_data(runs, used)
    dof = len(used) - len(found)
    if dof < 0 or not (dof or data.spread.any() or data.uncertain):
        count = f"{len(used)} run{'s' * (len(used) != 1)}"
        raise TooFew(TOO_FEW.format(f"{count} {'are' if used[1:] else 'is'}"))
    values: dict[str, float] = {"axle": 0.0, "rim_mass": 0.0, **known.values}
    given = {x: value for x, value in values.items() if x not in found}
    try:
        return Fit(runs, used, known, data, estimate(data, given, found), asked)
    except Alike:
        raise Alike(not_told(used, found)) from None


def _odd(fit: Fit) -> Odd:
    """The repeats that are far from their siblings, then the runs that are far from the others."""
    values, u, index = _measured(fit.used)
    repeated = len(index) > len(fit.used)
    found = stray_repeats(values, np.where(u > 0, u, 1), index, CHANCE) if repeated else {}
    first = np.searchsorted(index, index)
    repeats = {(int(index[i]), int(i - first[i])): away for i, away in found.items()}
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


def _without(fit: Fit, left: Sequence[Run]) -> Fit | None:
    """The same fit of other runs; None where they do not tell it."""
    find = fit.estimate.found if fit.asked else ()
    try:
        return _required(fit.runs, left, fit.known, find, judged=False) if left else None
    except (Alike, TooFew):
        return None


def _cannot(fit: Fit, run: Run) -> str:
    """Why a run cannot have been as it is said, by the string's friction; empty if it can."""
    scene, values, mu = fit.known.scene, fit.estimate.values, fit.known.scene.mu
    if mu is None or not run.m1.value or not run.m2.value or values["gravity"] <= 0:
        return ""
    c, f = (Fraction(max(values[x], 0.0)) for x in ("rim_mass", "axle"))
    scene = scene._replace(m1=run.m1.value, m2=run.m2.value, M=c, inertia=Fraction(1), I=None)
    if Case(scene._replace(g=Fraction(values["gravity"]), axle=Axle(f))).regime != "slip":
        return ""
    return f"the string would slip, as its mu = {text(float(mu))} is too small for these masses"


def not_told(used: Sequence[Run], found: Sequence[str]) -> str:
    """That the runs do not tell these, and what to vary."""
    return f"the runs do not tell {' from '.join(WORDS[x] for x in found)}: {to_vary(used)}"


def to_vary(used: Sequence[Run]) -> str:
    """What other runs should vary, so that they tell more."""
    sums, differences = ([float(abs(run.m2.value + sign * run.m1.value)) for run in used] for sign in (1, -1))
    same_sum, same_difference = (max(some) - min(some) < SAME * max(some) for some in (sums, differences))
    if same_sum and same_difference:
        return "vary m2 - m1, and m1 + m2"
    return "vary m1 + m2 as well" if same_sum else "vary m2 - m1 more, and m1 + m2"


def _measured(used: Sequence[Run]) -> tuple[Column, Column, NDArray[np.intp]]:
    """All measurements, positive where the heavier side falls, their uncertainties, and the run of each."""
    index = np.repeat(np.arange(len(used)), [len(run.measured) for run in used])
    values = np.array([float(one.value) for run in used for one in run.measured])
    u = _floats([one.uncertainty for run in used for one in run.measured])
    return values * np.where(np.bincount(index, values) < 0, -1.0, 1.0)[index], u, index


def _floats(some: Sequence[Fraction]) -> Column:
    return np.array([float(one) if one else 0.0 for one in some])


def as_data(runs: Runs, used: Sequence[Run]) -> Data:
    """The runs as columns. Raises Unreadable where only some measurements have an uncertainty."""
    m1, m2 = (
        np.array([float(one.value) for one in some])
        for some in zip(*((r.m1, r.m2) for r in used), strict=True)
    )
    u1, u2 = (
        _floats([one.uncertainty for one in some]) for some in zip(*((r.m1, r.m2) for r in used), strict=True)
    )
    uncertain = {"l": np.where(m1 > m2, u2, u1), "h": np.where(m1 > m2, u1, u2)}
    drop, drops = None, [run.drop for run in used if run.drop is not None]
    if runs.kind == "time":
        drop = np.array([float(one.value) for one in drops])
        uncertain |= {} if runs.one_drop else {"drop": _floats([one.uncertainty for one in drops])}
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


def unusable(runs: Runs, run: Run, known: Known, find: Sequence[str]) -> str:
    """Why nothing can be expected of a run; empty if something can."""
    if run.left_out:
        return "it was left out"
    if run.m1.value == run.m2.value:
        return "its masses are equal, and rest"
    if not run.sign:
        return "nothing moved"
    if runs.signed and (run.sign > 0) != (run.m2.value > run.m1.value):
        return "the lighter side falls"
    if (f := known.values.get("axle")) is None or "gravity" in find:
        return ""
    if abs(float(run.m2.value - run.m1.value)) * known.values["gravity"] <= f:
        return "an axle with the friction given holds its masses"
    return ""
