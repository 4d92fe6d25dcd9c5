"""What accuracy costs on this machine: time a scene beside the error against the exact values.

Scenes come from a seed, so that the errors can be had again; times are this machine's. Errors are in
units in the last place (ulp) of the exact value's double. The error of a scene is the worst of its
quantities', and counts where the regime is right. The exact values are decimals of `EXACT_DIGITS`
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
from timeit import Timer
from typing import Any, NamedTuple

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
PRECISE_SCENES = 100  # that are solved with digits, whose errors are all about half a unit in the last
REPEATS, RUN_SECONDS = 5, 0.01
SAMPLE, TABLE = 40, 10_000  # scenes that are timed in arrays, at least and at most
LONG_SECONDS = 0.25  # where a run takes so long, no more scenes are added to it
PRECISE = decimal_context(EXACT_DIGITS + 20, ROUND_HALF_EVEN)


# Settings


class Setting(NamedTuple):
    """A way to solve scenes: how to prepare so many, the run that is timed, how to read solutions off."""

    name: str
    prepare: Callable[[Sequence[Inputs], int], Any]
    run: Callable[[Any], Any]
    read: Callable[[Sequence[Inputs], Any], list[Values]]
    in_arrays: bool = True


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
        return [Scene.read({"g": float(STANDARD_GRAVITY), **row}) for row in rows[:size]]

    def run(scenes: Sequence[Scene]) -> list[Values]:
        every = (Answers(scene, digits) for scene in scenes)
        return [{name: answers[name] for name in STANDARD} for answers in every]

    return Setting(f"{digits} digits", prepare, run, lambda _, solutions: solutions, False)


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
    sizes = [_timed_rows(setting, rows) for setting in SETTINGS]
    times = timed([partial(s.run, s.prepare(rows, size)) for s, size in zip(SETTINGS, sizes, strict=True)])
    return [
        Measured(family, setting.name, seconds / size, spread, *_inaccuracy(setting, rows, exact))
        for setting, size, (seconds, spread) in zip(SETTINGS, sizes, times, strict=True)
    ]


def _inaccuracy(
    setting: Setting, rows: Sequence[Inputs], exact: Sequence[Values]
) -> tuple[float | None, float | None, float | None, float]:
    """The worst error, the 99th percentile, the share over the margin, and the share of wrong regimes."""
    rows = rows if setting.in_arrays else rows[:PRECISE_SCENES]
    solved = setting.read(rows, setting.run(setting.prepare(rows, len(rows))))
    off = sorted(errors(solved, exact[: len(rows)]))
    wrong = (len(rows) - len(off)) / len(rows)
    if not off:
        return None, None, None, wrong
    return off[-1], off[ceil(0.99 * len(off)) - 1], sum(one > MARGIN for one in off) / len(off), wrong


def _timed_rows(setting: Setting, rows: Sequence[Inputs]) -> int:
    """How many scenes are timed."""
    if not setting.in_arrays:
        return min(len(rows), PRECISE_SCENES)
    size = SAMPLE
    while size < TABLE and _quickest(partial(setting.run, setting.prepare(rows, size))) < LONG_SECONDS:
        size = min(16 * size, TABLE)
    return size


def _quickest(run: Callable[[], object]) -> float:
    """The lesser time (s) of two calls, which no interruption has lengthened."""
    return min(Timer(run, timer=perf_counter).repeat(2, 1))


def timed(runs: Sequence[Callable[[], object]]) -> list[tuple[float, float]]:
    """Of each run, the median time of a call (s), and half the range of the repeats as a share of it.

    They take turns, so that what slows the machine for a while slows all of them.
    """
    timers = [Timer(run, timer=perf_counter) for run in runs]
    calls = [ceil(RUN_SECONDS / max(_quickest(run), 1e-7)) for run in runs]
    repeats = [[one.timeit(n) / n for one, n in zip(timers, calls, strict=True)] for _ in range(REPEATS)]
    return [
        (median(times), (max(times) - min(times)) / 2 / median(times)) for times in zip(*repeats, strict=True)
    ]


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

    def march(count: int | None, halved: bool, ratio: Callable[[], float]) -> March:
        ((seconds, spread),) = timed([ratio])
        return March(count, halved, seconds, spread, abs(float((Fraction(ratio()) - exact) / exact)))

    def from_halves(count: int) -> float:
        return extrapolated(march_ratio(mu, phi, count), march_ratio(mu, phi, count // 2))

    for count in counts(most):
        if balanced(mu, phi, count):
            yield march(count, False, partial(march_ratio, mu, phi, count))
        if balanced(mu, phi, count // 2):
            yield march(count, True, partial(from_halves, count))
    yield march(None, False, lambda: exp(mu * phi))


def with_orders(run: Sequence[March]) -> list[March]:
    """Marches with their order of convergence since the number of elements before, and the best marked."""
    marked = [one._replace(best=True) for one in run if one.elements is None]
    for halved in (False, True):
        ones = [one for one in run if one.elements and one.extrapolated == halved]
        least = min((one.relative_error for one in ones), default=None)
        for before, one in zip([None, *ones], ones, strict=False):
            order = before and _order(before, one)
            marked.append(one._replace(order=order, best=one.relative_error == least))
    return sorted(marked, key=lambda one: (one.elements or inf, one.extrapolated))


def _order(before: March, one: March) -> float | None:
    """The power of N by which the error fell."""
    if not (before.elements and one.elements and before.relative_error and one.relative_error):
        return None
    return log(before.relative_error / one.relative_error) / log(one.elements / before.elements)
