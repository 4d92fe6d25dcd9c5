"""What runs require: rim mass and axle friction where the data need them, and what is odd about the runs.

Both are fitted first. What is not significant, by Student's t at 95 %, is left out, one at a time, and said.
Uncertainties are those given, or where none is, the scatter's; what is known and uncertain counts once more
for all runs together. Nothing is left out of the runs silently.
"""

from collections.abc import Collection, Mapping, Sequence
from fractions import Fraction
from math import inf, sqrt
from typing import Any, NamedTuple

import numpy as np

from ..batch.quoted import Unreadable
from ..model import physics
from ..model.case import Case
from ..model.motion import moved
from ..model.scene import UNMEASURED, Input, Scene, SceneError
from .least_squares import Alike, Data, Estimate, estimate, sum_of_squares
from .runs import BEYOND, Run, Runs, in_range
from .student import SURE, chi2_beyond, student_beyond, student_within

FOUND = ("rim_mass", "axle", "gravity")
"""What may be fitted."""
UNITS = {"rim_mass": "kg", "axle": "N", "gravity": "m/s²"}
WORDS = {"rim_mass": "the pulley's inertia", "axle": "axle friction", "gravity": "gravity"}
CLEAR = 3
"""Standard uncertainties beyond which a run is faster than a massless pulley lets it be."""
SAME = 0.01
"""The spread of m1 + m2, as a share of it, below which it is as good as constant."""


TOO_FEW = (
    "{} measurements are too few for what is to be fitted and its scatter: give more, or their uncertainties"
    " (as 2.05+/-0.02), or what is known (--M, --axle), or name one thing to --find"
)


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


class Dropped(NamedTuple):
    """What was not needed, as it was fitted last."""

    name: str
    value: float
    uncertainty: float


class Fit(NamedTuple):
    """What was found, and how well; ``spread_known`` if by uncertainties given, not by the scatter alone.

    ``scale`` is what the uncertainties were multiplied by, and ``times`` the factor to an interval of 95 %.
    ``asked`` says that it was said what to find.
    """

    runs: Runs
    used: Sequence[Run]
    known: Known
    data: Data
    estimate: Estimate
    dropped: Sequence[Dropped]
    spread_known: bool
    scale: float
    dof: int
    asked: bool

    @property
    def times(self) -> float:
        return student_within(SURE, self.dof if self.scatters else inf)

    @property
    def scatters(self) -> bool:
        """Whether the uncertainties are those of the scatter."""
        return not self.spread_known or self.scale != 1

    @property
    def values(self) -> dict[str, float]:
        return {name: self.estimate.values[name] for name in self.estimate.found}

    def uncertainty(self, name: str) -> float:
        """The standard uncertainty of what was found, with that of what is known."""
        i = self.estimate.found.index(name)
        variance = (self.scale * self.estimate.uncertainty(name)) ** 2
        for change in self.known.changes:
            by_known = self.estimate.by_known
            variance += sum(by_known[x][i] * by for x, by in change.items() if x in by_known) ** 2
        return sqrt(variance)

    @property
    def correlation(self) -> tuple[str, str, float] | None:
        """The two of what was found that hang together most."""
        found = self.estimate.found
        pairs = [
            (one, other, self.estimate.correlation(one, other))
            for i, one in enumerate(found)
            for other in found[i + 1 :]
        ]
        return max(pairs, key=lambda pair: abs(pair[2]), default=None)

    @property
    def chi2(self) -> float | None:
        """χ² by the uncertainties given, or by the scatter of repeats; None without either."""
        return self.estimate.chi2 if self.spread_known or self.data.within else None

    @property
    def lines(self) -> list[Line]:
        """Run by run, those that could not be used without what is expected."""
        here = {id(run): i for i, run in enumerate(self.used)}
        lines = []
        for run in self.runs.runs:
            mean = _mean([one.value for one in run.measured])
            i = here.get(id(run))
            if i is None:
                lines.append(Line(run, mean, None, None, None))
                continue
            measured, ideal = float(self.data.measured[i]), float(self.estimate.expected[i])
            sign = -1 if mean < 0 else 1
            u = float(self.estimate.sigma[i]) * self.scale
            residual = (measured - ideal) * sign / u if u else None
            lines.append(Line(run, sign * measured, sign * ideal, u, residual))
        return lines

    def without(self, indices: Collection[int]) -> "Fit | None":
        """The same done without some of the runs used; None where the others do not tell it."""
        left = [run for i, run in enumerate(self.used) if i not in indices]
        try:
            return _required(self.runs, left, self.known, self.estimate.found if self.asked else ())
        except (Alike, TooFew):
            return None

    @property
    def outliers(self) -> dict[int, float]:
        """Runs further from what the others say than one of so many is in 5 % of all cases, and how far."""
        if self.dof < (2 if self.scatters else 1):
            return {}
        away = (self.data.measured - self.estimate.expected) / self.estimate.sigma
        sizes = away / np.sqrt(np.maximum(1 - self.estimate.leverage, 1e-9))
        dof: float = inf
        if self.scatters:  # by the scatter of the others alone
            dof = self.dof - 1
            with np.errstate(divide="ignore", invalid="ignore"):
                sizes = sizes / np.sqrt(np.maximum(self.estimate.chi2 - sizes**2, 0.0) / dof)
        chance = (1 - SURE) / len(self.used)
        return {i: size for i, size in enumerate(sizes.tolist()) if student_beyond(size, dof) < chance}

    @property
    def too_fast(self) -> dict[int, float]:
        """Runs that are clearly faster than a massless pulley without friction allows, and that limit."""
        data, g = self.data, self.estimate.values["gravity"]
        drive = physics.drive_beside_axle(data.l, data.h, np.float64(0))
        limits: Any = physics.acceleration(drive, physics.load(data.l, data.h, np.float64(0)), np.float64(g))
        beyond = data.measured - limits
        if data.kind == "time" and data.drop is not None:
            limits = physics.fall_time(data.drop, limits, np.sqrt)
            beyond = limits - data.measured
        some = np.flatnonzero(beyond > 0).tolist()
        if not some:
            return {}
        others = self.without(some) if self.scatters else self
        clear = CLEAR * self.estimate.sigma * (0.0 if others is None else others.scale)
        return {i: float(limits[i]) for i in some if beyond[i] > clear[i]}

    @property
    def alternative(self) -> "Fit | None":
        """The fit of what was left out in place of what was kept, if it does as well; None if it does not."""
        found = self.estimate.found
        if self.asked or len(found) != 1 or len(self.dropped) != 1:
            return None
        both, other = (
            _fit(self.runs, self.used, self.known, self.data, self.spread_known, names, [])
            for names in ([found[0], self.dropped[0].name], [self.dropped[0].name])
        )
        needed = [both.away(name) > both.times for name in both.estimate.found]
        return other if not any(needed) and other.away(self.dropped[0].name) > other.times else None

    def away(self, name: str) -> float:
        """How many standard uncertainties what was found is from 0."""
        return away(self.values[name], self.uncertainty(name))


def away(value: float, uncertainty: float) -> float:
    """How many standard uncertainties a value is from 0."""
    return abs(value) / uncertainty if uncertainty else inf if value else 0.0


class TooFew(ArithmeticError):
    """The runs are fewer than what is to be fitted."""


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


def fitted(runs: Runs, known: Known, find: Sequence[str]) -> Fit:
    """The fit of what the data require, or of just what is to be found; Unreadable, TooFew, Alike."""
    used = [run for run in runs.runs if not unusable(runs, run, known, find)]
    if not used:
        why = unusable(runs, runs.runs[0], known, find)
        raise Unreadable(f"no run can be used: in {runs.runs[0].name}, {why}")
    return _required(runs, used, known, find)


def _required(runs: Runs, used: Sequence[Run], known: Known, find: Sequence[str]) -> Fit:
    """The fit of those runs: of what is to be found, or of both less what is not significant."""
    if not used:
        raise TooFew
    data, spread_known = as_data(runs, used)
    if find:
        return _fit(runs, used, known, data, spread_known, list(find), [], asked=True)
    found: list[str] = [x for x in FOUND[:2] if x not in known.values]
    dropped: list[Dropped] = []
    while True:
        fit = _fit(runs, used, known, data, spread_known, found, dropped)
        least = min(found, key=fit.away, default=None)
        if least is None or fit.away(least) > fit.times:
            return fit
        dropped = [*dropped, Dropped(least, fit.values[least], fit.uncertainty(least))]
        found = [name for name in found if name != least]


def _fit(
    runs: Runs,
    used: Sequence[Run],
    known: Known,
    data: Data,
    spread_known: bool,
    found: Sequence[str],
    dropped: Sequence[Dropped],
    asked: bool = False,
) -> Fit:
    values = {"axle": 0.0, "rim_mass": 0.0, **known.values}
    dof = int(data.times.sum()) - len(found)
    if dof < 1 and (not spread_known or dof < 0):
        raise TooFew(TOO_FEW.format(int(data.times.sum())))
    try:
        best = estimate(data, {x: value for x, value in values.items() if x not in found}, found)
    except Alike:
        raise Alike(
            f"the runs do not tell {' from '.join(WORDS[x] for x in found)}: {to_vary(used)}"
        ) from None
    good = spread_known and (not dof or chi2_beyond(best.chi2, dof) > 1 - SURE)
    scale = 1.0 if good else sqrt(best.chi2 / dof)
    return Fit(runs, used, known, data, best, dropped, spread_known, scale, dof, asked)


def to_vary(used: Sequence[Run]) -> str:
    """What other runs should vary, so that they tell more."""
    sums, differences = ([float(abs(run.m2.value + sign * run.m1.value)) for run in used] for sign in (1, -1))
    same_sum, same_difference = (max(some) - min(some) < SAME * max(some) for some in (sums, differences))
    if same_sum and same_difference:
        return "vary m2 - m1, and m1 + m2"
    return "vary m1 + m2 as well" if same_sum else "vary m2 - m1 more, and m1 + m2"


def _mean(values: Sequence[Fraction]) -> float:
    return float(sum(values, Fraction(0)) / len(values))


def as_data(runs: Runs, used: Sequence[Run]) -> tuple[Data, bool]:
    """The runs as columns, and whether uncertainties were given. Raises Unreadable."""
    masses = [sorted((run.m1, run.m2), key=lambda mass: Fraction(mass.value)) for run in used]
    inputs = {"l": [light for light, _ in masses], "h": [heavy for _, heavy in masses]}
    if runs.kind == "time":
        inputs["drop"] = [run.drop for run in used if run.drop is not None]
    columns = {name: np.array([float(one.value) for one in some]) for name, some in inputs.items()}
    uncertain = {
        name: np.array([float(one.uncertainty) for one in some])
        for name, some in inputs.items()
        if any(one.uncertainty for one in some) and not (name == "drop" and runs.one_drop)
    }
    means = [_mean([one.value for one in run.measured]) for run in used]
    signs = [-1 if mean < 0 else 1 for mean in means]
    values = [
        np.array([sign * float(one.value) for one in run.measured])
        for run, sign in zip(used, signs, strict=True)
    ]
    times = np.array([float(len(some)) for some in values])
    given = [np.array([float(one.uncertainty) for one in run.measured]) for run in used]
    if any(u.any() for u in given):
        for run, u in zip(used, given, strict=True):
            if not u.all():
                raise Unreadable(
                    f"{run.name} has no uncertainty of its {runs.kind}, as others have; give all"
                )
        measured = np.array([float(np.average(v, weights=u**-2)) for v, u in zip(values, given, strict=True)])
        spread = np.array([sqrt(n / sum_of_squares(1 / u)) for n, u in zip(times, given, strict=True)])
        within = sum(sum_of_squares((v - m) / u) for v, m, u in zip(values, measured, given, strict=True))
        known_spread = True
    else:
        measured = np.abs(means)
        squares = sum(sum_of_squares(v - m) for v, m in zip(values, measured, strict=True))
        repeats = float(times.sum()) - len(used)
        known_spread = bool(uncertain)
        one = sqrt(squares / repeats) if squares else 0.0 if known_spread else 1.0
        spread, within = np.full(len(used), one), repeats if squares else 0.0
    for i, run in enumerate(used):
        if known_spread and not spread[i] and not any(u[i] for u in uncertain.values()):
            raise Unreadable(f"{run.name} has no uncertainty, and others have one; give all of them, or none")
    data = Data(
        runs.kind,
        columns["l"],
        columns["h"],
        columns.get("drop"),
        measured,
        times,
        spread,
        within,
        uncertain,
    )
    return data, known_spread


def unusable(runs: Runs, run: Run, known: Known, find: Sequence[str]) -> str:
    """Why nothing can be expected of a run; empty if something can."""
    if run.m1.value == run.m2.value:
        return "its masses are equal, and rest"
    mean = sum(one.value for one in run.measured)
    if mean == 0:
        return "nothing moved"
    if runs.signed and (mean > 0) != (run.m2.value > run.m1.value):
        return "the lighter side falls"
    drive = abs(float(run.m2.value - run.m1.value)) * known.values["gravity"]
    if "gravity" not in find and drive <= known.values.get("axle", 0):
        return "an axle with the friction given holds its masses"
    return ""
