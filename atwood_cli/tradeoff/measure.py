"""Each way to solve many scenes is timed, and its errors are found, on families that are hard on doubles.

Scenes are drawn from a seed, so that anybody finds the same errors; times are this machine's. Errors are in
units in the last place (ulp) of the exact value's double, the worst of a scene, if its regime is right.
Exact values are those of `solve` to 240 digits.
"""

from collections.abc import Callable, Mapping, Sequence
from decimal import Context, Decimal
from functools import partial
from math import inf, isfinite, ldexp, nan, pi, ulp
from random import Random
from statistics import median
from time import perf_counter
from timeit import Timer
from typing import Any, NamedTuple

import numpy as np

from ..api import solve
from ..arrays import solve_arrays
from ..solver.quantities import ACCURACIES, REGIMES, STANDARD
from ..solver.scene import STANDARD_GRAVITY

Inputs = dict[str, Any]
"""The inputs of a scene by parameter, as doubles."""
NamedColumns = Mapping[str, Any]
"""A column for each input, or for each quantity."""
MOST_SCENES, SEED = 100_000, 1
EXACT_DIGITS = 240
PRECISE = Context(prec=EXACT_DIGITS + 20)
REPEATS = 9
FEWEST_ROWS, MOST_ROWS, RUN_SECONDS = 40, 10_000, 0.1
"""The rows of a table that is timed; between these, as many as are solved in such a time."""


# Every platform draws the same scenes: mantissas and exponents are drawn one by one, so that no library's
# powers or logarithms matter, and masses near the verge are solved exactly first. All scenes have M and mu.


def _between(rng: Random, low: int, high: int) -> float:
    """Return a number from 2^low to 2^high, its exponent uniform."""
    return ldexp(1 + rng.random(), rng.randrange(low, high))


def _ordinary(rng: Random) -> Inputs:
    m1 = _between(rng, -7, 7)
    m2 = m1 * (1 + _between(rng, -7, 7))
    return {"m1": m1, "m2": m2, "M": _between(rng, -7, 10), "mu": _between(rng, -7, 1)}


def _nearly_equal(rng: Random) -> Inputs:
    scene = _ordinary(rng)
    return scene | {"m2": scene["m1"] * (1 + _between(rng, -50, -7)), "mu": _between(rng, -60, -7)}


def _light_pulley(rng: Random) -> Inputs:
    scene = _ordinary(rng) | {"M": _between(rng, -100, -10)}
    return scene | {"mu": _between(rng, -100, -10)} if rng.random() < 0.5 else scene


def _near_critical(rng: Random) -> Inputs:
    """Return a scene beside its critical pulley mass, or beside the least heavier mass that can slip."""
    m1, mu = _between(rng, -7, 7), _between(rng, -7, 0)
    off = 1 + rng.choice((-1, 1)) * _between(rng, -50, -10)
    least: Any = solve(m1=m1, m2=2 * m1, mu=mu).least_heavier_mass
    if rng.random() < 0.3:
        return {"m1": m1, "m2": least * off, "M": _between(rng, 0, 57), "mu": mu}
    m2 = least * (1 + _between(rng, -10, 4))
    critical: Any = solve(m1=m1, m2=m2, mu=mu).critical_pulley_mass
    return {"m1": m1, "m2": m2, "M": critical * off, "mu": mu}


def _whole_range(rng: Random) -> Inputs:
    m1, m2, M = (_between(rng, -1074, 1024) for _ in range(3))
    return {"m1": min(m1, m2), "m2": max(m1, m2), "M": M, "mu": _between(rng, -1074, 10)}


FAMILIES: dict[str, tuple[Callable[[Random], Inputs], str]] = {
    "ordinary": (_ordinary, "masses 0.01 to 100 kg, 1 % to a hundredfold apart; pulleys 0.01 to 1000 kg"),
    "nearly-equal": (_nearly_equal, "masses apart by 1e-15 to 1e-2 of themselves, little friction"),
    "light-pulley": (_light_pulley, "pulleys of 1e-30 to 1e-3 kg"),
    "near-critical": (_near_critical, "M, or m2, within 1e-15 to 1e-3 of where the string slips"),
    "whole-range": (_whole_range, "masses from 5e-324 to 1e308 kg"),
}
"""Kinds of scenes by name: the function that draws a scene, and a description."""


def draw_scenes(family: str, count: int, seed: int = SEED) -> list[Inputs]:
    """Return ``count`` scenes of a family. The same seed draws the same scenes, whatever their number."""
    rng, (draw, _) = Random(f"{family} {seed}"), FAMILIES[family]
    return [draw(rng) for _ in range(count)]


def in_numpy(m1: Any, m2: Any, M: Any, mu: Any) -> NamedColumns:
    """Solve scenes in plain doubles, with the equations as they stand in the paper, for m1 <= m2 and a disk.

    It is the same model, slip included, as one writes it with care in NumPy: both states are computed,
    `where` chooses, and formulas share their sums.
    """
    l, h, c, g = m1, m2, M / 2, float(STANDARD_GRAVITY)
    with np.errstate(all="ignore"):
        k = np.exp(mu * pi)
        lk, grips, slides = l * k, g / (l + h + c), g / (h + l * k)
        t_l, t_h = (2 * h + c) * l * grips, (2 * l + c) * h * grips  # (4)
        mu_verge = np.log(t_h / t_l) / pi  # (27)
        slips = mu < mu_verge
        a = np.where(slips, (h - lk) * slides, (h - l) * grips)
        t_l = np.where(slips, 2 * h * l * slides, t_l)
        t_h = np.where(slips, 2 * h * lk * slides, t_h)  # (26)
        friction = np.where(slips, mu / np.sqrt(1 + mu * mu) * (t_l + t_h), nan)  # (32)
        critical = np.where(h > lk, 4 * h * l * (k - 1) / (h - lk), nan)  # (34)
    regime = np.where(slips, np.int8(REGIMES.index("slip")), np.int8(REGIMES.index("no-slip")))
    return dict(zip(STANDARD, (regime, a, t_l, t_h, mu_verge, friction, critical), strict=True))


def in_digits(digits: int, **given: Any) -> NamedColumns:
    """Run `solve`, a scene at a time."""
    rows = zip(*(column.tolist() for column in given.values()), strict=True)
    solutions = [solve(**dict(zip(given, row, strict=True)), digits=digits) for row in rows]
    columns = {name: [getattr(solution, name) for solution in solutions] for name in STANDARD}
    return columns | {"regime": [REGIMES.index(regime) for regime in columns["regime"]]}


Setting = Callable[..., NamedColumns]
"""A way to solve scenes: a function from columns of inputs to columns of quantities."""
SETTINGS: dict[str, Setting] = {
    "plain doubles": in_numpy,
    **{accuracy: partial(solve_arrays, accuracy=accuracy) for accuracy in ACCURACIES},
    "50 digits": partial(in_digits, 50),
}


def errors(solved: NamedColumns, exact: NamedColumns) -> list[float]:
    """Return the worst error (ulp) of each scene whose regime is right; infinite where a value is lost."""
    rows, right = (zip(*(columns[name] for name in STANDARD), strict=True) for columns in (solved, exact))
    return [
        max((_ulps(*pair) for pair in zip(values, wanted, strict=True) if pair[1] is not None), default=0.0)
        for (regime, *values), (right_regime, *wanted) in zip(rows, right, strict=True)
        if regime == right_regime
    ]


def _ulps(value: Any, exact: Decimal) -> float:
    """Return the error of a value, in units in the last place of the double nearest to the exact value."""
    nearest = float(exact)
    if isinstance(value, float) and not (isfinite(value) and isfinite(nearest)):
        return 0.0 if value == nearest else inf
    unit = Decimal(ulp(nearest)) if isfinite(nearest) else PRECISE.multiply(exact, Decimal(ulp(1.0)))
    return abs(float(PRECISE.divide(PRECISE.subtract(Decimal(value), exact), unit)))


class Measured(NamedTuple):
    """A setting on a family of scenes: the time of a scene, and errors, None if no regime was right."""

    family: str
    setting: str
    seconds: float
    median_ulp: float | None
    worst_ulp: float | None
    share_wrong_regime: float


def measure(family: str, scenes: Sequence[Inputs]) -> list[Measured]:
    """Measure every setting on these scenes, which have the same inputs; ``family`` names them."""
    columns, measured = _columns(scenes, len(scenes)), list[Measured]()
    exact = in_digits(EXACT_DIGITS, **columns)
    for name, run in SETTINGS.items():
        run(**columns)  # compiles what is kept
        start = perf_counter()
        solved = run(**columns)
        rows_in_time = RUN_SECONDS * len(scenes) / max(perf_counter() - start, 1e-9)
        ulps = errors(solved, exact)
        rows = int(min(max(rows_in_time, FEWEST_ROWS), MOST_ROWS))
        # The least time counts: whatever else the machine does makes others longer.
        seconds = min(Timer(partial(run, **_columns(scenes, rows)), timer=perf_counter).repeat(REPEATS, 1))
        typical, worst = median(ulps) if ulps else None, max(ulps, default=None)
        wrong = 1 - len(ulps) / len(scenes)
        measured.append(Measured(family, name, seconds / rows, typical, worst, wrong))
    return measured


def _columns(scenes: Sequence[Inputs], rows: int) -> NamedColumns:
    """Return the scenes as columns of ``rows`` rows, in which they are repeated."""
    return {name: np.resize([scene[name] for scene in scenes], rows) for name in scenes[0]}
