"""What accuracy costs on this machine: time a scene beside the error against the exact values.

Scenes come from a seed, so that the errors can be had again; times are this machine's. Errors are in
units in the last place (ulp) of the exact value's double, those of a scene the worst of its
quantities', and counted where the regime is right. The exact values are decimals of `EXACT_DIGITS`
digits; the tests hold what is measured to an independent library.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from decimal import ROUND_HALF_EVEN, Decimal
from fractions import Fraction
from functools import partial
from math import ceil, degrees, exp, inf, isfinite, isinf, log, pi, ulp
from operator import attrgetter
from statistics import median
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.interval import decimal_context
from ..arithmetic.rounding import as_typed, text, to_double
from ..arrays import ACCURACIES, solve_arrays
from ..arrays.plan import COLUMNS
from ..model.machine import Undetermined
from ..model.quantities import REGIMES, STANDARD
from ..model.scene import STANDARD_GRAVITY, Scene, SceneError
from ..solver.answers import Answers
from ..solver.elements import TOO_LARGE, balanced, extrapolated, march
from .baseline import paper_in_numpy
from .scenes import Inputs, draw_scenes

Values = dict[str, Any]
"""A solution by quantity; None, or NaN, where there is no value."""
Watch = Callable[[Iterator[Any], int], Iterator[Any]]

VALUES = STANDARD[1:]
MOST_SCENES = 100_000
EXACT_DIGITS = 240
DECIMALS = (17, 50, 200)
MARGIN = 4  # ulp: what certified promises
REPEATS, RUN_SECONDS = 5, 0.02
FEWEST, MOST_ROWS = 20, 1_000_000
TABLE = 10_000  # scenes at least that are solved at once in arrays: of few, what is rare counts too much
PRECISE = decimal_context(EXACT_DIGITS + 20, ROUND_HALF_EVEN)


# Settings


class Setting(NamedTuple):
    """A way to solve scenes: how to prepare its input, the run that is timed, how to read solutions off."""

    name: str
    prepare: Callable[[Sequence[Inputs], int], Any]
    run: Callable[[Any], Any]
    read: Callable[[Sequence[Inputs], Any], list[Values]]
    at_once: bool = True
    """Whether it solves a table of scenes at once."""


def _columns(rows: Sequence[Inputs], size: int, dtype: Any = np.float64) -> dict[str, Any]:
    """The scenes as columns, over and over until there are as many rows as that."""
    with np.errstate(over="ignore"):
        return {name: np.resize(np.array([row[name] for row in rows], dtype), size) for name in rows[0]}


def _by_scene(columns: Mapping[str, Any], regimes: Sequence[str]) -> list[Values]:
    """The solutions one by one, from a column for each quantity."""
    values = zip(*(np.asarray(columns[name], np.float64).tolist() for name in VALUES), strict=True)
    return [
        {"regime": regime, **dict(zip(VALUES, row, strict=True))}
        for regime, row in zip(regimes, values, strict=True)
    ]


IN_THE_PAPER = ("m1", "m2", "M", "mu", "g", "inertia", "wrap")  # the last two as its obvious extension


def _in_numpy(dtype: Any) -> Setting:
    def prepare(rows: Sequence[Inputs], size: int) -> dict[str, Any]:
        columns = {
            name: column for name, column in _columns(rows, size, dtype).items() if name in IN_THE_PAPER
        }
        given = {"l": columns.pop("m1"), "h": columns.pop("m2"), **columns}
        return given | ({"phi": given.pop("wrap") * dtype(pi / 180)} if "wrap" in given else {})

    def run(given: Mapping[str, Any]) -> dict[str, Any]:
        with np.errstate(all="ignore"):
            return paper_in_numpy(**given)

    def read(rows: Sequence[Inputs], columns: Mapping[str, Any]) -> list[Values]:
        regime = "verge" if "mu" in rows[0] and "M" not in rows[0] else "no-slip"  # as the formulas assume
        return _by_scene(columns, [regime] * len(rows))

    return Setting(f"paper, {dtype.__name__}", prepare, run, read)


def _in_arrays(accuracy: Any) -> Setting:
    def run(columns: Mapping[str, Any]) -> dict[str, Any]:
        return solve_arrays(**columns, accuracy=accuracy)

    def read(_: Sequence[Inputs], columns: Mapping[str, Any]) -> list[Values]:
        return _by_scene(columns, [REGIMES[code] for code in columns["regime"]])

    return Setting(accuracy, _columns, run, read)


def _in_decimals(digits: int) -> Setting:
    def prepare(rows: Sequence[Inputs], size: int) -> list[Scene]:
        scenes = [Scene.read({"g": float(STANDARD_GRAVITY), **row}) for row in rows[:size]]
        return [scenes[i % len(scenes)] for i in range(size)]

    def run(scenes: Sequence[Scene]) -> list[Values]:
        every = (Answers(scene, digits) for scene in scenes)
        return [{name: answers[name] for name in STANDARD} for answers in every]

    return Setting(f"{digits} digits", prepare, run, lambda _, solutions: solutions, at_once=False)


SETTINGS = (
    *map(_in_numpy, (np.float32, np.float64)),
    *map(_in_arrays, ACCURACIES),
    *map(_in_decimals, DECIMALS),
)


# Errors


def errors(solutions: Sequence[Values], exact: Sequence[Values]) -> list[float]:
    """The worst error (ulp) of each scene whose regime is right; infinite where a value is lost."""
    return [
        max((_ulps(values[name], right[name]) for name in VALUES if right[name] is not None), default=0.0)
        for values, right in zip(solutions, exact, strict=True)
        if values["regime"] == right["regime"]
    ]


def _ulps(value: Any, exact: Decimal) -> float:
    """How far a value is off, in units in the last place of the double nearest to the exact one."""
    nearest = float(exact)
    if isinstance(value, float) and not (isfinite(value) and isfinite(nearest)):
        return 0.0 if value == nearest else inf
    unit = Decimal(ulp(nearest)) if isfinite(nearest) else PRECISE.multiply(exact, Decimal(ulp(1.0)))
    return abs(float(PRECISE.divide(PRECISE.subtract(Decimal(value), exact), unit)))


# Measuring


class Measured(NamedTuple):
    """A setting on a family of scenes. Errors are None where no regime was right."""

    family: str
    setting: str
    seconds: float
    """Of one scene: median of the repeats."""
    spread: float
    """Half of the repeats' range, as a share of the median."""
    worst_ulp: float | None
    percentile_99_ulp: float | None
    share_over_4_ulp: float | None
    share_wrong_regime: float
    best: bool = False
    """No other setting is both faster and more accurate."""


def measure(family: str, rows: Sequence[Inputs]) -> list[Measured]:
    """Every setting on these scenes, which have the same parameters; ``family`` names them."""
    reference = _in_decimals(EXACT_DIGITS)
    exact = reference.run(reference.prepare(rows, len(rows)))
    off = [errors(s.read(rows, s.run(s.prepare(rows, len(rows)))), exact) for s in SETTINGS]
    sizes = [_size(setting, rows) for setting in SETTINGS]
    given = [setting.prepare(rows, size) for setting, size in zip(SETTINGS, sizes, strict=True)]
    # In turn, so that what slows the machine for a while slows all of them.
    repeats = [[_seconds(s.run, g) for s, g in zip(SETTINGS, given, strict=True)] for _ in range(REPEATS)]
    measured = []
    for setting, size, errors_, *taken in zip(SETTINGS, sizes, off, *repeats, strict=True):
        center = _center([seconds / size for seconds in taken])
        wrong = (len(rows) - len(errors_)) / len(rows)
        measured.append(Measured(family, setting.name, *center, *_summary(errors_), wrong))
    return [one._replace(best=not any(_beats(other, one) for other in measured)) for one in measured]


def _size(setting: Setting, rows: Sequence[Inputs]) -> int:
    """So many scenes that a run takes long enough to be timed, and not much longer."""
    size = TABLE if setting.at_once else min(len(rows), FEWEST)
    while size < MOST_ROWS:
        given = setting.prepare(rows, size)
        taken = _seconds(setting.run, given)
        if taken > RUN_SECONDS / 2:  # or was it interrupted?
            taken = min(taken, _seconds(setting.run, given))
        if taken > RUN_SECONDS / 2:
            return size
        size = min(size * min(ceil(RUN_SECONDS / taken), 16), MOST_ROWS)
    return size


def _seconds(run: Callable[[Any], object], given: Any) -> float:
    start = perf_counter()
    kept = run(given)
    taken = perf_counter() - start
    del kept
    return taken


def _center(times: Sequence[float]) -> tuple[float, float]:
    """The median of the repeats, and half of their range as a share of it."""
    middle = median(times)
    return middle, (max(times) - min(times)) / 2 / middle


def _summary(off: Sequence[float]) -> tuple[float | None, float | None, float | None]:
    """The worst error, the 99th percentile, and the share over the margin."""
    if not off:
        return None, None, None
    off = sorted(off)
    return off[-1], off[ceil(0.99 * len(off)) - 1], sum(one > MARGIN for one in off) / len(off)


def _off(one: Measured) -> float:
    """The error that counts: a regime taken wrongly is no answer."""
    return inf if one.share_wrong_regime or one.worst_ulp is None else one.worst_ulp


def _beats(one: Measured, other: Measured) -> bool:
    mine, others = (one.seconds, _off(one)), (other.seconds, _off(other))
    return mine != others and mine[0] <= others[0] and mine[1] <= others[1]


# String elements


class March(NamedTuple):
    """e^{μφ} from so many string elements (None: in closed form, in doubles)."""

    elements: int | None
    extrapolated: bool
    seconds: float
    spread: float
    relative_error: float
    order: float | None = None
    """By which power of N the error fell since the number before."""
    best: bool = False
    """The least error: with more elements rounding takes over."""


COUNTS = (4, *(times * 10**power for power in range(1, 6) for times in (1, 3)), 1_000_000)


def marches(scene: Scene) -> Iterator[March]:
    """e^{μφ} of a scene by each number of elements, plain and extrapolated, and last in closed form.

    Raises SceneError where it is no double, Undetermined where no friction can hold the string.
    """
    answers = Answers(scene, EXACT_DIGITS)
    mu = float(answers.settle(attrgetter("reference_mu")))
    ratio = Decimal(answers.settle(attrgetter("capstan_ratio")))
    phi = float(answers.settle(lambda machine: machine.phi))
    if to_double(ratio) == inf:  # before a fraction of a hundred million digits is made of it
        raise SceneError("elements", None, TOO_LARGE)
    exact = Fraction(ratio)

    def k(count: int) -> float:
        return march(mu, phi, count)[0]

    def from_halves(count: int) -> float:
        return extrapolated(k(count), k(count // 2))

    def timed(count: int | None, halved: bool, ratio: Callable[[], float], times: int) -> March:
        taken = []
        for _ in range(REPEATS):
            start = perf_counter()
            for _ in range(times):
                reached = ratio()
            taken.append((perf_counter() - start) / times)
        return March(count, halved, *_center(taken), abs(float((Fraction(reached) - exact) / exact)))

    for count in COUNTS:
        if balanced(mu, phi, count):
            yield timed(count, False, partial(k, count), 1)
        if balanced(mu, phi, count // 2):
            yield timed(count, True, partial(from_halves, count), 1)
    yield timed(None, False, lambda: exp(mu * phi), 1000)


def with_orders(run: Sequence[March]) -> list[March]:
    """Marches with their order of convergence since the number of elements before, and the best marked."""
    marked = []
    for one in run:
        alike = [other for other in run if other.extrapolated == one.extrapolated and other.elements]
        before = max((o for o in alike if (o.elements or 0) < (one.elements or 0)), default=None)
        order = None
        if one.elements and before and before.elements and one.relative_error and before.relative_error:
            order = log(before.relative_error / one.relative_error) / log(one.elements / before.elements)
        least = min((other.relative_error for other in alike), default=None)
        marked.append(one._replace(order=order, best=one.elements is None or one.relative_error == least))
    return marked


# What follows


class Tradeoff(NamedTuple):
    """What was measured: of ``scenes`` of each family from the seed, or of one scene (seed None).

    ``scene`` is the one whose e^{μφ} the elements approach.
    """

    scene: Scene
    scenes: int
    seed: int | None
    measured: list[Measured]
    marches: list[March]
    notes: list[str]

    @property
    def advice(self) -> str:
        return advice(self.measured)


PAPERS_SCENE = {"m1": "1", "m2": "3", "mu": "0.3"}
LEGEND = (
    "* No other setting is both faster and more accurate. Time is for one scene on this machine, of a table"
    f" of at least {TABLE:,} but for digits, ± half the range of its repeats. Errors are in units in the last"
    " place (ulp) of a double, a scene's the worst of its quantities', over the scenes whose regime is right;"
    " Over 4 is the share of them over 4 ulp, Regime the share of scenes whose regime is wrong. paper: the"
    " paper's formulas typed into NumPy."
)
ELEMENTS_LEGEND = (
    "* The least error: with more elements rounding takes over. Order is the power of N by which the error"
    " fell."
)
LEAST_DRAWN, GREATEST_DRAWN = 1e-3, 1e20
EDGES = "Errors below 0.001 ulp and above 1e20 ulp, or without a right regime, lie on the edge."


def drawable(worst_ulp: float | None) -> float:
    """The error as far as a picture shows it."""
    return GREATEST_DRAWN if worst_ulp is None else min(max(worst_ulp, LEAST_DRAWN), GREATEST_DRAWN)


def drawable_marches(marches: Sequence[March]) -> list[list[tuple[float, float]]]:
    """Times and errors of elements, then of extrapolated ones; where there is none, no logarithm of it."""
    return [
        [
            (one.seconds, one.relative_error)
            for one in marches
            if one.extrapolated == way and one.elements and one.relative_error
        ]
        for way in (False, True)
    ]


def tradeoff(families: Sequence[str], scenes: int, seed: int, scene: Scene | None, watch: Watch) -> Tradeoff:
    """Measure every setting on so many scenes of each family, or on the one scene given. Raises SceneError.

    ``watch`` takes the parts of the work, and how many there are, and yields them as they are done.
    """
    sets: Iterator[tuple[str, list[Inputs]]] = ((name, draw_scenes(name, scenes, seed)) for name in families)
    if scene is not None:
        sets, families = iter([("scene", [inputs_of(scene)])]), ["scene"]
    measured = [one for part in watch((measure(*each) for each in sets), len(families)) for one in part]
    marched = scene or Scene.read(PAPERS_SCENE)
    run, notes = [], []
    try:
        run = with_orders(list(watch(marches(marched), 2 * len(COUNTS) + 1)))
    except SceneError as error:
        notes.append(f"String elements {error.rule}.")
    except Undetermined as reason:
        notes.append(f"String elements: {reason}.")
    if scene is not None:
        return Tradeoff(marched, 1, None, measured, run, notes)
    return Tradeoff(marched, scenes, seed, measured, run, notes)


def inputs_of(scene: Scene) -> Inputs:
    """A scene as the doubles that it is measured with, m1 the lighter mass. Raises SceneError."""
    inputs: Inputs = {}
    given = scene._asdict() | {"wrap": scene.wrap.number}
    for name in COLUMNS:
        if (value := given[name]) is not None:
            inputs[name] = double = to_double(value)
            if isinstance(value, Fraction) and (double == inf or (double == 0 and value)):
                raise SceneError(name, as_typed(value), "is beyond the doubles, which are measured here")
    if scene.I is not None:
        raise SceneError("I", None, "is not measured, as arrays have no such column; give --inertia")
    if scene.wrap.unit == "rad":
        inputs["wrap"] = degrees(inputs["wrap"])
    inputs["m1"], inputs["m2"] = sorted((inputs["m1"], inputs["m2"]))
    return inputs


def advice(measured: Sequence[Measured]) -> str:
    """Which setting for which need, from what was measured: times of the first family, errors of all.

    Where another family takes much longer, that is said too.
    """
    by_family: dict[str, dict[str, float]] = {}
    for one in measured:
        by_family.setdefault(one.setting, {})[one.family] = one.seconds
    times = {name: next(iter(seconds.values())) for name, seconds in by_family.items()}
    off = {name: max(_off(one) for one in measured if one.setting == name) for name in times}
    wrong = max(one.share_wrong_regime for one in measured if one.setting == "fast")
    wanted: dict[str, list[str]] = {}
    for need, most in NEEDS.items():
        fit = [name for name in times if off[name] <= most]
        wanted.setdefault(min(fit, key=times.__getitem__), []).append(need)

    def cost(name: str) -> str:
        slowest = max(by_family[name], key=by_family[name].__getitem__)
        longest = by_family[name][slowest]
        more = f", {in_seconds(longest)} if {slowest}" if longest > MUCH * times[name] else ""
        return in_seconds(times[name]) + " a scene" * (name == next(iter(wanted))) + more

    parts = [f"{name} for {' and '.join(needs)} ({cost(name)})" for name, needs in wanted.items()]
    worst = max(one.worst_ulp or 0 for one in measured if one.setting == "fast")
    regimes = f" and took up to {percent(wrong)} of the regimes wrongly" if wrong else ""
    fast = f"; fast ({cost('fast')}) was up to {short(worst)} ulp off{regimes}"
    return f"Take {', '.join(parts)}{'' if 'fast' in wanted else fast}."


MUCH = 5
"""How many times as long a family must take as the first to be named."""
NEEDS = {"results within 4 ulp": MARGIN, "the nearest double": 0.5, "more digits": 1e-9}


def in_seconds(seconds: float) -> str:
    """A time to three digits, in the unit that fits."""
    unit, factor = next((u, f) for u, f in SECONDS.items() if seconds < 1000 * f or u == "s")
    return f"{short(seconds / factor, 3)} {unit}"


SECONDS = {"ns": 1e-9, "µs": 1e-6, "ms": 1e-3, "s": 1.0}


def short(value: float | None, digits: int = 2) -> str:
    """A number to a few digits; a dash where there is none."""
    if value is None or isinf(value):
        return "-" if value is None else "inf"
    return text(Decimal(f"{value:.{digits}g}"))


def scientific(value: float) -> str:
    """A number to two digits, with its power of ten."""
    mantissa, exponent = f"{value:.1e}".split("e")
    return f"{mantissa}e{int(exponent)}"


def percent(share: float | None) -> str:
    """A share in percent, to three digits; a dash where there is none."""
    return "-" if share is None else f"{short(100 * share, 3)} %"
