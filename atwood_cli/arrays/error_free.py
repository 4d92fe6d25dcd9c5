"""Error-free transformations: sums and products of doubles with their exact rounding errors.

The rounding error of a sum or product of two doubles is itself a double, as long as nothing leaves the normal
doubles. That holds for IEEE 754 arithmetic that rounds to nearest. Python and NumPy's + - * / and sqrt do so
on any platform and with any SIMD path. Arguments are formulas of columns, or numbers.
"""

from __future__ import annotations

from math import frexp, ldexp
from typing import Any

from ..arithmetic.symbolic import Formula, Term

UNIT = 2.0**-53  # u, the largest relative error of a rounding


def two_sum(x: Term, y: Term) -> tuple[Any, Any]:
    """x + y, rounded, and its exact error, whichever of the two is larger (D. E. Knuth)."""
    total = x + y
    added = total - x
    return total, (x - (total - added)) + (y - added)


def fast_two_sum(x: Term, y: Term) -> tuple[Any, Any]:
    """x + y, rounded, and its exact error, where |y| <= |x| in every row (T. J. Dekker)."""
    total = x + y
    return total, (x - total) + y


def two_product(x: Term, y: Term) -> tuple[Any, Any]:
    """x y, rounded, and its exact error, from the products of halves (T. J. Dekker)."""
    product = x * y
    (a, b), (c, d) = split(x), split(y)
    return product, ((a * c - product) + b * c + a * d) + b * d


def split(x: Term) -> tuple[Any, Any]:
    """Two halves of 26 bits that add up to x; the lower one may be negative (T. J. Dekker)."""
    scaled = x * (2.0**27 + 1)
    high = scaled - (scaled - x)
    return high, x - high


def head_of(x: Term) -> Any:
    """Each double cut off after its first 26 bits."""
    if isinstance(x, Formula):
        return x if x.op == "head" else Formula("head", x)
    mantissa, exponent = frexp(x)
    return ldexp(int(ldexp(mantissa, 26)), exponent - 26)
