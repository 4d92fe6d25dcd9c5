"""Constants and a table for the arithmetics of columns, computed once to 80 digits and split into doubles."""

from fractions import Fraction
from functools import cache, lru_cache
from math import frexp, ldexp

import numpy as np

from ..arithmetic.interval import enclosures
from ..arithmetic.rational import EXACT, Irrational
from .pattern import Column

STEPS = 16_384  # of the table of powers to a factor of 2

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


def precise_cos_sin(degrees: Fraction) -> tuple[Fraction, Fraction]:
    """Cosine and sine to 70 digits; exact where rational."""
    try:
        return EXACT.cos_sin_of_degrees(degrees)
    except Irrational:
        cos, sin = ENOUGH.cos_sin_of_degrees(degrees % 360)
        return Fraction(cos.lo), Fraction(sin.lo)


@lru_cache(10_000)
def cos_sin_in_doubles(degrees: float) -> tuple[float, ...]:
    """Cosine and sine, each as the sum of two doubles."""
    doubles = []
    for exact in precise_cos_sin(Fraction(degrees)):
        doubles += [float(exact), float(exact - Fraction(float(exact)))]
    return tuple(doubles)


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
def powers() -> tuple[Column, Column]:
    """2^(i/STEPS) - 1 for i from 0 to STEPS - 1, as the sum of two columns."""
    exact = [0]
    step = int(Fraction(ENOUGH.expm1(ENOUGH.number(ln2() / STEPS)).lo) * 2**BITS)
    for _ in range(STEPS - 1):
        exact.append(exact[-1] + step + (exact[-1] * step >> BITS))
    firsts = [float(value) for value in exact]
    rests = [float(value - int(first)) for value, first in zip(exact, firsts, strict=True)]
    return np.array(firsts) * 2.0**-BITS, np.array(rests) * 2.0**-BITS
