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
from math import ceil, exp, inf, isfinite, log, pi, ulp
from operator import attrgetter
from statistics import median
from time import perf_counter
from typing import Any, NamedTuple, Protocol, TypeVar

import numpy as np

from ..arithmetic.interval import decimal_context
from ..arithmetic.rounding import to_double
from ..arrays import solve_arrays
from ..model.quantities import ACCURACIES, REGIMES, STANDARD
from ..model.scene import Scene, SceneError
from ..model.units import STANDARD_GRAVITY
from ..solver.answers import Answers
from ..solver.elements import MAX_ELEMENTS, TOO_LARGE, balanced, extrapolated, march_ratio
from .baseline import paper_in_numpy
from .scenes import Inputs

Values = dict[str, Any]
"""A solution by quantity; None, or NaN, where there is no value."""

VALUES = STANDARD[1:]
MOST_SCENES = 100_000
EXACT_DIGITS = 240
DECIMALS = (17, 50, 200)
MARGIN = 4  # ulp: what certified promises
PRECISE_SCENES = 100  # whose errors count with digits, of which all are about half a unit in the last
REPEATS, RUN_SECONDS = 5, 0.01
FEWEST, MOST_ROWS = 20, 1_000_000
TABLE = 10_000  # scenes at least that are solved at once in arrays: of few, what is rare counts too much
SAMPLE, LONG_SECONDS = 40, 0.1  # of a table: where so many, or a few more, take so long, it has no more
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
    times = ceil(size / len(rows))
    with np.errstate(over="ignore"):
        return {name: np.tile(np.array([row[name] for row in rows], dtype), times)[:size] for name in rows[0]}


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
    counted = [rows if setting.at_once else rows[:PRECISE_SCENES] for setting in SETTINGS]
    off = [
        errors(s.read(some, s.run(s.prepare(some, len(some)))), exact[: len(some)])
        for s, some in zip(SETTINGS, counted, strict=True)
    ]
    sizes = [_size(setting, rows) for setting in SETTINGS]
    given = [setting.prepare(rows, size) for setting, size in zip(SETTINGS, sizes, strict=True)]
    # In turn, so that what slows the machine for a while slows all of them.
    repeats = [[_seconds(s.run, g) for s, g in zip(SETTINGS, given, strict=True)] for _ in range(REPEATS)]
    measured = []
    for setting, size, some, errors_, *taken in zip(SETTINGS, sizes, counted, off, *repeats, strict=True):
        center = _center([seconds / size for seconds in taken])
        wrong = (len(some) - len(errors_)) / len(some)
        measured.append(Measured(family, setting.name, *center, *_summary(errors_), wrong))
    best = front(measured)
    return [one._replace(best=one in best) for one in measured]


def _size(setting: Setting, rows: Sequence[Inputs]) -> int:
    """So many scenes that a run takes long enough to be timed, and not much longer."""
    size, least = (min(SAMPLE, TABLE), TABLE) if setting.at_once else (min(len(rows), FEWEST), 0)
    while size < MOST_ROWS:
        enough = RUN_SECONDS / 2 if size >= least else LONG_SECONDS
        given = setting.prepare(rows, size)
        taken = _seconds(setting.run, given)
        if taken > enough:  # or was it interrupted?
            taken = min(taken, _seconds(setting.run, given))
        if taken > enough:
            return size
        size = min(max(size * min(ceil(RUN_SECONDS / taken), 16), min(2 * size, least)), MOST_ROWS)
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


class Cost(Protocol):
    """What a setting takes, and how far off it is."""

    @property
    def seconds(self) -> float: ...
    @property
    def worst_ulp(self) -> float | None: ...
    @property
    def share_wrong_regime(self) -> float: ...


C = TypeVar("C", bound=Cost)


def front(settings: Sequence[C]) -> list[C]:
    """Those of which no other is both faster and more accurate."""
    return [one for one in settings if not any(_beats(other, one) for other in settings)]


def _beats(one: Cost, other: Cost) -> bool:
    mine, others = (one.seconds, _inaccuracy(one)), (other.seconds, _inaccuracy(other))
    return mine != others and mine[0] <= others[0] and mine[1] <= others[1]


def _inaccuracy(one: Cost) -> tuple[float, float]:
    """Regimes count first: what takes fewer of them wrongly is the more accurate."""
    return one.share_wrong_regime, inf if one.worst_ulp is None else one.worst_ulp


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


COUNTS = (4, *(times * 10**power for power in range(1, 7) for times in (1, 3)), MAX_ELEMENTS)
USUAL_ELEMENTS = 1_000_000


def counts(most: int = USUAL_ELEMENTS) -> list[int]:
    """The numbers of elements that are marched."""
    return [count for count in COUNTS if count <= most]


def marches(scene: Scene, most: int = USUAL_ELEMENTS) -> Iterator[March]:
    """e^{μφ} of a scene by numbers of elements up to the most, plain and extrapolated, last in closed form.

    Raises SceneError where it is no double, Undetermined where no friction can hold the string.
    """
    answers = Answers(scene, EXACT_DIGITS)
    mu = float(answers.settle(attrgetter("reference_mu")))
    ratio = Decimal(answers.settle(attrgetter("reference_ratio")))
    phi = float(answers.settle(lambda machine: machine.phi))
    if to_double(ratio) == inf:  # before a fraction of a hundred million digits is made of it
        raise SceneError("elements", None, TOO_LARGE)
    exact = Fraction(ratio)

    def k(count: int) -> float:
        return march_ratio(mu, phi, count)

    def from_halves(count: int) -> float:
        return extrapolated(k(count), k(count // 2))

    def timed(count: int | None, halved: bool, ratio: Callable[[], float], times: int) -> March:
        taken, reached = [], ratio()  # the first call of all takes longer
        for _ in range(REPEATS):
            start = perf_counter()
            for _ in range(times):
                reached = ratio()
            taken.append((perf_counter() - start) / times)
        return March(count, halved, *_center(taken), abs(float((Fraction(reached) - exact) / exact)))

    for count in counts(most):
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
