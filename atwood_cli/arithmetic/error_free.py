"""Sums and products of doubles with their rounding errors, exactly; of formulas of columns, or numbers.

The error of a sum or product of two doubles is itself a double, as long as nothing leaves the normal
doubles. That holds for IEEE 754 arithmetic, rounding to nearest, which Python and NumPy's + - * / and sqrt
do on any platform and with any SIMD path.
"""

from __future__ import annotations

from math import frexp, ldexp
from typing import Any

from .symbolic import Formula, Part

UNIT = 2.0**-53  # u, the largest relative error of a rounding


def two_sum(x: Part, y: Part) -> tuple[Any, Any]:
    """x + y, rounded, and the error of that, exactly, whichever of the two is larger (D. E. Knuth)."""
    total = x + y
    added = total - x
    return total, (x - (total - added)) + (y - added)


def two_difference(x: Part, y: Part) -> tuple[Any, Any]:
    """x - y, rounded, and the error of that, exactly."""
    total = x - y
    added = total - x
    return total, (x - (total - added)) - (y + added)


def fast_two_sum(x: Part, y: Part) -> tuple[Any, Any]:
    """x + y, rounded, and its error, where no row of y is larger in size than that of x (T. J. Dekker)."""
    total = x + y
    return total, (x - total) + y


def fast_two_difference(x: Part, y: Part) -> tuple[Any, Any]:
    """x - y, rounded, and its error, where no row of y is larger in size than that of x."""
    total = x - y
    return total, (x - total) - y


def two_product(x: Part, y: Part) -> tuple[Any, Any]:
    """x y, rounded, and the error of that, exactly, from the products of halves (T. J. Dekker)."""
    product = x * y
    (a, b), (c, d) = split(x), split(y)
    return product, ((a * c - product) + b * c + a * d) + b * d


def split(x: Part) -> tuple[Any, Any]:
    """Two halves of 26 bits that add up to x; the lower has a sign (T. J. Dekker)."""
    scaled = x * (2.0**27 + 1)
    high = scaled - (scaled - x)
    return high, x - high


def head_of(x: Part) -> Any:
    """The first 26 bits of each double, the others cut off."""
    if isinstance(x, Formula):
        return Formula("head", x)
    mantissa, exponent = frexp(x)
    return ldexp(int(ldexp(mantissa, 26)), exponent - 26)
