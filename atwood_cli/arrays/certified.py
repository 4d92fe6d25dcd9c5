"""When a double is right: within what `certified` promises, or the nearest one, a tie too.

A tie is half-way between two doubles, and no error bound shows that a value is one. But a rational formula
has a least distance from a double that it does not equal. Such a formula has only + - * and /, so it is a
ratio n/d. Its inputs are doubles, so n and d are multiples of powers of two: n of 2^i, d of 2^j. Let |d| be
at most 2^k, and t, a double or half-way between two, a multiple of 2^e. Then n - t d is a multiple of
2^min(i, e + j). It is 0, or n/d differs from t by at least the gap 2^min(i, e + j) / 2^k. So a bound on |n/d
- t| below the gap proves that n/d = t. The fewer bits the inputs have, the wider the gap is.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arithmetic.rational import Irrational
from ..arithmetic.symbolic import Formula, Term
from ..model.quantities import Accuracy
from .doubles import Number, absolute, at_most, both, either, equal
from .pattern import Column

PROMISE = 2e-14
"""The largest relative error of a value that is certified."""
LIMIT = 1.95e-14
"""The largest bound that is certified: bounds leave out products of two, and a pair is rounded to a
double."""
FINE = 2.0**-104
"""Of a value, more than the rounding errors of the ends of its bound."""


def certified(value: Number, accuracy: Accuracy) -> tuple[Term, Formula | None]:
    """A value as a double, and the condition under which a row's double is right; None for none."""
    double: Any = value.parts[0] if value.positive else value.parts[0] + 0.0  # 0.0 makes 0 of -0
    if accuracy == "exact":
        return double, is_nearest(value)
    if value.doubt is None and value.loss <= LIMIT:
        return double, None
    return double, at_most(value.bound, LIMIT)


def is_nearest(value: Number) -> Formula:
    """Whether the first part is the double nearest to the exact value: both ends of the bound round to it."""
    first, second = (*value.parts, 0.0)[:2]
    error = absolute(first) * (value.bound + FINE)
    same = both(equal(first + (second - error), first), equal(first + (second + error), first))
    return either(same, equal(value.bound, 0.0))


def ties(
    first: Column, second: Column, error: Column, plain: Formula, inputs: Mapping[str, Column]
) -> tuple[Column, NDArray[np.bool_]]:
    """The ties nearest to a formula's values, and whether a value is that tie.

    Each value is the sum of two doubles, off by at most ``error``. Raises Irrational.
    """
    half = np.copysign(np.spacing(np.abs(first)) / 2, second)
    return first + half, np.abs(second - half) + error < gap(ratio(plain, inputs), half)


class Bits(NamedTuple):
    """The numbers of a column are multiples of 2^last, and at most 2^most in size."""

    last: Any
    most: Any

    def times(self, other: Bits) -> Bits:
        if self is ONE or other is ONE:
            return other if self is ONE else self
        return Bits(self.last + other.last, self.most + other.most)

    def plus(self, other: Bits) -> Bits:
        return Bits(np.minimum(self.last, other.last), np.maximum(self.most, other.most) + 1)


ONE = Bits(0, 0)
OF_ZERO = 10_000
"""The ``last`` of 0, which is a multiple of every power of two: larger than that of any double."""


def bits(column: Column) -> Bits:
    """The bits of doubles, row by row."""
    mantissas, exponents = np.frexp(column)
    whole = (mantissas * 2.0**53).astype(np.int64)
    _, last = np.frexp((whole & -whole).astype(np.float64))  # one more than the exponent of the last bit
    return Bits(np.where(column == 0, OF_ZERO, exponents - 54 + last), exponents)


Ratio = tuple[Bits, Bits]
"""The bits of a numerator and of a denominator."""


def gap(of: Ratio, t: Column) -> Column:
    """The least that a ratio can differ from ``t`` where it is not t, row by row."""
    n, d = of
    least: Column = np.ldexp(1.0, np.minimum(n.last, bits(t).last + d.last) - d.most)
    return least


def ratio(formula: Formula, inputs: Mapping[str, Column], known: dict[int, Ratio] | None = None) -> Ratio:
    """The bits of a formula's numerator and denominator. Raises Irrational for other operations.

    ``known`` has the formulas that are done, by identity. Terms over the same denominator keep it.
    """
    known = {} if known is None else known
    if id(formula) not in known:
        match formula.op, formula.parts:
            case "symbol", (name,):
                known[id(formula)] = bits(inputs[name]), ONE
            case "number", (number,):
                known[id(formula)] = bits(np.array([float(number)])), ONE
            case "+" | "-" | "*" | "/", parts:
                (a, b), (c, d) = (ratio(part, inputs, known) for part in parts)
                if formula.op == "*":
                    known[id(formula)] = a.times(c), b.times(d)
                elif formula.op == "/":
                    known[id(formula)] = a.times(d), b.times(c)
                elif b is d:
                    known[id(formula)] = a.plus(c), b
                else:
                    known[id(formula)] = a.times(d).plus(c.times(b)), b.times(d)
            case _:
                raise Irrational
    return known[id(formula)]
