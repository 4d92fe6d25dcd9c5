"""Constants and a table for the arithmetics of columns, computed once to 80 digits and split into doubles."""

from fractions import Fraction
from functools import cache, lru_cache
from math import frexp, ldexp

import numpy as np

from ..arithmetic.interval import enclosures
from ..arithmetic.rational import EXACT, Irrational
from .pattern import Column

TABLE_STEPS = 16_384
"""The number of equal steps from ln 1 to ln 2 in the table of powers."""
EIGHTY_DIGITS = enclosures(80)
"""The arithmetic of the constants, in decimals of 80 digits."""
BINARY_PLACES = 240
"""The bits of a table's numbers after the binary point."""


@cache
def pi() -> Fraction:
    """Return π."""
    return Fraction(EIGHTY_DIGITS.pi.lo)


@cache
def ln2() -> Fraction:
    """Return ln 2."""
    return Fraction(EIGHTY_DIGITS.log1p(EIGHTY_DIGITS.number(1)).lo)


def precise_cos_sin(degrees: Fraction) -> tuple[Fraction, Fraction]:
    """Return cosine and sine to 70 digits; exact if they are rational."""
    try:
        return EXACT.cos_sin_of_degrees(degrees)
    except Irrational:
        cos, sin = EIGHTY_DIGITS.cos_sin_of_degrees(degrees % 360)
        return Fraction(cos.lo), Fraction(sin.lo)


@lru_cache(10_000)
def cos_sin_in_doubles(degrees: float) -> tuple[float, ...]:
    """Return cosine and sine, each as the sum of two doubles."""
    doubles = []
    for exact in precise_cos_sin(Fraction(degrees)):
        doubles += [float(exact), float(exact - Fraction(float(exact)))]
    return tuple(doubles)


@cache
def in_parts(q: Fraction, bits: int, count: int) -> tuple[float, ...]:
    """Split a number into ``count`` parts of so many bits and a rest; small multiples of parts are exact."""
    parts, rest = [], q
    for _ in range(count):
        mantissa, exponent = frexp(float(rest))
        parts.append(ldexp(round(ldexp(mantissa, bits)), exponent - bits))
        rest -= Fraction(parts[-1])
    return (*parts, float(rest))


@cache
def powers() -> tuple[Column, Column]:
    """Return 2^(i/n) - 1 for each step i of the table's n, as the sum of two columns."""
    exact = [0]
    step = int(Fraction(EIGHTY_DIGITS.expm1(EIGHTY_DIGITS.number(ln2() / TABLE_STEPS)).lo) * 2**BINARY_PLACES)
    for _ in range(TABLE_STEPS - 1):
        exact.append(exact[-1] + step + (exact[-1] * step >> BINARY_PLACES))
    firsts = [float(value) for value in exact]
    rests = [float(value - int(first)) for value, first in zip(exact, firsts, strict=True)]
    return np.array(firsts) * 2.0**-BINARY_PLACES, np.array(rests) * 2.0**-BINARY_PLACES
