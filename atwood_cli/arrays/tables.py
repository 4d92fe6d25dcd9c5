"""Constants and tables for the arithmetics of columns, computed once to 80 digits and split into doubles."""

from collections.abc import Sequence
from fractions import Fraction
from functools import cache
from math import frexp, inf, ldexp

import numpy as np
from numpy.typing import NDArray

from ..arithmetic.interval import enclosures
from ..arithmetic.rational import EXACT, Irrational

Column = NDArray[np.float64]

STEPS, FINER = 16_384, 4  # steps of the coarse table of powers to a factor of 2; fine steps to a coarse one
FINE = STEPS * FINER
TO_A_DEGREE = 4  # steps of the table of sines to a degree
FIRST_DEGREE, LAST_DEGREE = -45, 270

ENOUGH = enclosures(80)
BITS = 240  # of a table's numbers after the binary point


@cache
def pi() -> Fraction:
    """π."""
    return Fraction(ENOUGH.pi.lo)


@cache
def ln2() -> Fraction:
    """ln 2."""
    return Fraction(ENOUGH.log1p(ENOUGH.number(1)).lo)


@cache
def precise_cos_sin(degrees: Fraction) -> tuple[Fraction, Fraction]:
    """Cosine and sine to 70 digits; exact where rational."""
    try:
        return EXACT.cos_sin_of_degrees(degrees)
    except Irrational:
        cos, sin = ENOUGH.cos_sin_of_degrees(degrees % 360)
        return Fraction(cos.lo), Fraction(sin.lo)


@cache
def in_parts(q: Fraction, bits: int, count: int) -> tuple[float, ...]:
    """A number as a sum of ``count`` parts of so many bits, with exact small multiples, and the rest."""
    parts = []
    for _ in range(count):
        mantissa, exponent = frexp(float(q))
        parts.append(ldexp(round(ldexp(mantissa, bits)), exponent - bits))
        q -= Fraction(parts[-1])
    return (*parts, float(q))


@cache
def powers(steps: int, n: int) -> tuple[Column, ...]:
    """2^(i/steps) - 1 for i from 0 to the step of the next coarser table, as the sum of ``n`` columns."""
    exact, count = [0], STEPS if steps == STEPS else FINER
    step = int(Fraction(ENOUGH.expm1(ENOUGH.number(ln2() / steps)).lo) * 2**BITS)
    for _ in range(count - 1):
        exact.append(exact[-1] + step + (exact[-1] * step >> BITS))
    return _columns(exact, n)


@cache
def heads_and_tails() -> tuple[Column, Column]:
    """The coarse table of powers, split into heads of 26 bits and the rest."""
    highs, lows = powers(STEPS, 2)
    heads = (highs.view(np.int64) & HEAD).view(np.float64)
    return heads, highs - heads + lows


HEAD = -1 << 27  # masks the last 27 of the 53 bits of a double


@cache
def whole_powers() -> Column:
    """2^m for m < 52, and then infinity, which makes all that depends on it NaN."""
    return np.array([2.0**m for m in range(52)] + [inf])


@cache
def cosines_and_sines(n: int) -> tuple[tuple[Column, ...], tuple[Column, ...]]:
    """Cosines and sines from `FIRST_DEGREE` to `LAST_DEGREE`, each as the sum of ``n`` columns."""
    degrees = (
        Fraction(i, TO_A_DEGREE) for i in range(FIRST_DEGREE * TO_A_DEGREE, LAST_DEGREE * TO_A_DEGREE + 1)
    )
    pairs = [[int(part * 2**BITS) for part in precise_cos_sin(one)] for one in degrees]
    cosines, sines = zip(*pairs, strict=True)
    return _columns(cosines, n), _columns(sines, n)


def _columns(values: Sequence[int], n: int) -> tuple[Column, ...]:
    """Numbers in units of 2^-BITS, as the sum of ``n`` columns."""
    columns = []
    for _ in range(n):
        parts = [float(value) for value in values]
        values = [value - int(part) for value, part in zip(values, parts, strict=True)]
        columns.append(np.array(parts) * 2.0**-BITS)
    return tuple(columns)
