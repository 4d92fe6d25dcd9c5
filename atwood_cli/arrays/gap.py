"""The least distance of a rational formula from a double that it does not equal.

The formula has only + - * and /, so it is a ratio n/d. Its inputs are doubles, so n and d are multiples of
powers of two: n of 2^i, d of 2^j. Let |d| be at most 2^k, and the double t a multiple of 2^e. Then n - t d is
a multiple of 2^min(i, e + j). It is 0, or n/d differs from t by at least the gap 2^min(i, e + j) / 2^k. So a
bound on |n/d - t| below the gap proves that n/d = t. The fewer bits the inputs have, the wider the gap is.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.rational import Irrational
from ..arithmetic.symbolic import Formula
from .tables import Column


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
