"""When a double is right: within what `certified` promises, or the nearest one."""

from __future__ import annotations

from typing import Any

from ..arithmetic.symbolic import Formula, Term
from ..model.quantities import Accuracy
from .doubles import Number, absolute, at_most, both, either, equal

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
