"""Sums of two doubles with a proven error bound, in columns: to about 2^-100.

A `Bounded` stands for the sum of its parts, of which the second is at most u = 2^-53 of the first. What the
operations lose is counted in u² of the result, or of both terms in a difference:

- a constant, 1: its second part is rounded;
- a sum, 4: it is exact, but for the second parts, which are added in doubles to the rounding error of the
  first parts: 2 u is rounded twice;
- a product of two doubles, 0: it comes with its rounding error (see `two_product`);
- a product of pairs, 8: the product of the first parts, to which both products of a first and a second part
  are added. It loses 2 for forming these, 2 and 3 for adding them, and 1 for the product of the second parts,
  which is left out;
- a quotient, 13: the rounded quotient q of the first parts, and the remainder x - q y over y. The remainder
  is off by 7 u² of x, and it is at most 3 u of x; its division by the first part of y, rounded, loses 6 more;
- a root, 8: it is found in the same way, by a step of Newton's method.

The rest of the proof is that of `doubles`.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import cache, lru_cache
from itertools import accumulate
from math import copysign, frexp, inf, ldexp, log
from operator import add, sub
from typing import Any

import numpy as np

from ..numbers.formula import Formula, Term, formula
from .doubles import (
    EIGHTY_DIGITS,
    UNIT,
    Bounded,
    Column,
    Doubles,
    Parts,
    less,
    maximum,
    minimum,
    precise_cos_sin,
    where,
)

UNIT_SQUARED = UNIT**2
BOUNDED_EXPONENT = 180.0
"""The largest x for which e^x has a bound: e^x and its square are doubles then."""
TABLE_STEPS = 16_384
"""The number of equal steps from ln 1 to ln 2 in the table of powers."""
STEP = tuple(map(float.fromhex, "0x1.62e43p-15 -0x1.05c61p-43 -0x1.950d88p-68 0x1.d9cc01f97b57ap-93".split()))
"""ln 2/16384 in three parts of 24 bits, whose small multiples are exact, and a rest."""
BINARY_PLACES = 240
"""The bits of the table's numbers after the binary point."""


@cache
def powers() -> tuple[Column, Column]:
    """Return 2^(i/n) - 1 for each step i of the table's n, as the sum of two columns."""
    places = 2**BINARY_PLACES
    ln2 = EIGHTY_DIGITS.log1p(EIGHTY_DIGITS.number(1)).lo
    step = int(Fraction(EIGHTY_DIGITS.expm1(EIGHTY_DIGITS.number(Fraction(ln2) / TABLE_STEPS)).lo) * places)
    steps = range(1, TABLE_STEPS)
    exact = [*accumulate(steps, lambda x, _: x + step + (x * step >> BINARY_PLACES), initial=0)]
    firsts = [float(value) for value in exact]
    rests = [float(value - int(first)) for value, first in zip(exact, firsts, strict=True)]
    return np.array(firsts) / places, np.array(rests) / places


@lru_cache(10_000)
def cos_sin_in_doubles(degrees: float) -> tuple[float, ...]:
    """Return cosine and sine, each as the sum of two doubles."""
    cos, sin = precise_cos_sin(Fraction(degrees))
    return *two_doubles(cos), *two_doubles(sin)


def two_doubles(q: Fraction) -> tuple[float, float]:
    """Return the nearest double and that nearest to the rest."""
    first = float(q)
    return first, float(q - Fraction(first))


# Error-free transformations: sums and products of doubles with their rounding errors


def two_sum(x: Term, y: Term) -> tuple[Any, Any]:
    """Return x + y, rounded, and its exact error, whichever of the two is larger (D. E. Knuth)."""
    total = x + y
    added = total - x
    return total, (x - (total - added)) + (y - added)


def fast_two_sum(x: Term, y: Term) -> tuple[Any, Any]:
    """Return x + y, rounded, and its exact error, for |y| <= |x| in every row (T. J. Dekker)."""
    total = x + y
    return total, (x - total) + y


def two_product(x: Term, y: Term) -> tuple[Any, Any]:
    """Return x y, rounded, and its exact error, by products of heads and tails (T. J. Dekker).

    A head is a double rounded to 26 bits. So its tail has 26 bits, too, and a sign. The four products are
    exact, and so are their sums.
    """
    product = x * y
    head_x, head_y = head_of(x), head_of(y)
    tail_x, tail_y = x - head_x, y - head_y
    return product, ((head_x * head_y - product) + tail_x * head_y + head_x * tail_y) + tail_x * tail_y


def head_of(x: Term) -> Any:
    """Return each double rounded to 26 bits; a tie is rounded away from 0."""
    if isinstance(x, Formula):
        return Formula("head", x)
    mantissa, exponent = frexp(x)
    return ldexp(int(ldexp(mantissa, 26) + copysign(0.5, mantissa)), exponent - 26)


class Pairs(Doubles):
    """The arithmetic of numbers that are the sum of two doubles."""

    error_of_constant, error_of_sum, error_of_product = UNIT_SQUARED, 4 * UNIT_SQUARED, 8 * UNIT_SQUARED
    error_of_quotient, error_of_root, error_of_doubles = 13 * UNIT_SQUARED, 8 * UNIT_SQUARED, 0.0
    error_of_series = 256 * UNIT_SQUARED
    sums_take_larger_error = False

    def error(self, x: Bounded) -> Any:
        return x.size * (x.bound + self.error_of_sum)

    # Parts, without bounds

    def sum(self, x: Parts, y: Parts, sign: float, positive: bool) -> Parts:
        (first_x, *rest_x), (first_y, *rest_y) = x, y
        plus = add if sign > 0 else sub
        if positive:
            high, rest = fast_two_sum(maximum(first_x, first_y), minimum(first_x, first_y))
        else:
            high, rest = two_sum(first_x, first_y * sign)
        for part in rest_x:
            rest = rest + part
        for part in rest_y:
            rest = plus(rest, part)
        if not (rest_x or rest_y):
            return high, rest
        return fast_two_sum(high, rest) if positive else two_sum(high, rest)

    def multiply(self, x: Parts, y: Parts) -> Parts:
        product, rest = two_product(x[0], y[0])
        for part in y[1:]:
            rest = rest + x[0] * part
        for part in x[1:]:
            rest = rest + part * y[0]
        return fast_two_sum(product, rest)

    def divide(self, x: Parts, y: Parts) -> Parts:
        """Return the rounded quotient, and the quotient of the remainder that it leaves."""
        quotient = x[0] / y[0]
        remainder = _remainder(x, quotient, y[0])
        for part in y[1:]:
            remainder = remainder - quotient * part
        return fast_two_sum(quotient, remainder / y[0])

    def root_of(self, x: Parts) -> Parts:
        """Return the rounded root, and a step of Newton's from the remainder that its square leaves."""
        root = Formula("sqrt", formula(x[0]))
        return fast_two_sum(root, _remainder(x, root, root) / (2.0 * root))

    def constant(self, q: Fraction) -> Parts:
        first, rest = two_doubles(q)
        return (first, rest) if rest else (first,)

    # Functions

    def expm1(self, x: Bounded) -> Bounded:
        """Return k = e^x - 1 for x >= 0, without a bound beyond x = 180 (`BOUNDED_EXPONENT`).

        x is split into m ln 2, i steps of ln 2/16384 and a rest r < 4.3e-5, which loses 8 u² of x, as a
        product does. The steps are looked up in a table of a = 2^(i/16384) - 1. The rest gives s = e^r - 1 by
        its Taylor series: terms from r⁴ on are computed in doubles and terms from r⁷ on are left out, which
        loses 256 u² of s. Then 1 + k = 2^m (1 + a)(1 + s). The factors are joined as a + s + a s, where
        nothing cancels.
        """
        first, *others = x.parts
        high = minimum(first, BOUNDED_EXPONENT)
        count = Formula("floor", high * (TABLE_STEPS / log(2)))
        number = Formula("int", count)
        s = self._small_expm1(_rest(high, others, count))
        step = Formula("bits", number, TABLE_STEPS - 1)
        a = Bounded(self, [Formula("take", step, column) for column in powers()], self.error_of_constant)
        k = a + s + a * s
        power = Formula("power", Formula(">>", number, TABLE_STEPS.bit_length() - 1))
        k = Bounded(self, [part * power for part in k.parts], k.fixed_error)
        k = k + Bounded(self, fast_two_sum(power, -1.0))
        row_error = (1.0 + high) * (x.bound + self.error_of_product)
        row_error = row_error + s.parts[0] * (1.0 + 1.0 / k.parts[0]) * self.error_of_series
        return Bounded(self, k.parts, k.fixed_error, where(less(first, BOUNDED_EXPONENT), row_error, inf))

    def _small_expm1(self, r: Parts) -> Bounded:
        """Return e^r - 1 = r + r² (1/2 + r (1/6 + ...)) for a small r."""
        x, tail = Bounded(self, r), ((r[0] * (1 / 720) + 1 / 120) * r[0] + 1 / 24) * r[0]
        factor = self.number(Fraction(1, 6)) + Bounded(self, (tail,))
        return Bounded(self, (x + x * x * (factor * x + self.number(Fraction(1, 2)))).parts)

    def log1p(self, x: Bounded) -> Bounded:
        """Return ln(1 + x) for x >= 0, as a double y and a correction.

        The correction is ln(1 + δ) for δ = (1 + x)/e^y - 1, by two terms of its series. As y is below 180 and
        off by a few u of it, δ is below 2^-43.
        """
        y = Bounded(self, (Formula("log1p", formula(x.parts[0])),))
        guess = self.expm1(y)
        off = (x - guess) / (guess + 1)
        return self.taken_as_not_negative(y + off - off * off / 2)

    def cos_sin_of_column(self, degrees: Formula) -> tuple[Bounded, Bounded]:
        """Return the cosine and the sine of angles in degrees; each angle that occurs is computed once."""
        cos, sin = (
            Bounded(self, parts, self.error_of_constant, positive=False)
            for parts in (
                [Formula(op, degrees), Formula(f"rest of {op}", degrees)] for op in ("cos°", "sin°")
            )
        )
        return cos, sin


def _remainder(x: Parts, q: Term, y: Term) -> Any:
    """Return x - q y for a rounded quotient q as a double: q y is so close to x that this is exact."""
    product, error = two_product(q, y)
    remainder = (x[0] - product) - error
    return remainder + x[1] if len(x) == 2 else remainder


def _rest(first: Term, others: Sequence[Term], count: Formula) -> Parts:
    """Return x minus a multiple of ln 2/16384 that is near it (argument reduction)."""
    near, middle, last, rest = STEP
    high, error = two_sum(first - count * near, count * -middle)
    high, next_error = two_sum(high, count * -last)
    low = error + next_error + count * -rest
    for part in others:
        low = low + part
    return two_sum(high, low)


PAIRS = Pairs()
