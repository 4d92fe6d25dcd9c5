"""When a double is right: its error is within the promise of `certified`, or it is the nearest one."""

from __future__ import annotations

from typing import Any

from ..arithmetic.symbolic import Formula, Term
from ..model.quantities import Accuracy
from .doubles import Number, absolute, at_most, both, either, equal

PROMISE = 2e-14
"""The largest relative error of a value that is certified."""
LIMIT = 1.95e-14
"""The largest bound that is certified. It is below the promise, as bounds leave out products of two, and the
rounding of a pair to a double."""
END_ERROR = 2.0**-104
"""A bound on the relative rounding error of the ends between which a value lies."""


def certified(value: Number, accuracy: Accuracy) -> tuple[Term, Formula | None]:
    """A value as a double, and the condition under which it is right in a row; None if it always is."""
    double: Any = value.parts[0] if value.positive else value.parts[0] + 0.0  # 0.0 makes 0 of -0
    if accuracy == "exact":
        return double, is_nearest(value)
    if value.doubt is None and value.loss <= LIMIT:
        return double, None
    return double, at_most(value.bound, LIMIT)


def is_nearest(value: Number) -> Formula:
    """Whether the first part is the double nearest to the exact value: both ends of the bound round to it."""
    first, second = (*value.parts, 0.0)[:2]
    error = absolute(first) * (value.bound + END_ERROR)
    ends_round_to_it = both(equal(first + (second - error), first), equal(first + (second + error), first))
    return either(ends_round_to_it, equal(value.bound, 0.0))
