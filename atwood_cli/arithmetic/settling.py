"""Correct rounding of exact values and enclosures to digits and text, and why the last digit is right.

Every input is a rational number, taken exactly as typed. A quantity is first computed in exact fractions. If
its formula stays rational, one division, rounded once, gives the result, ties included. Otherwise (it has an
exponential, a logarithm or a root) it is computed in enclosures.

Rounding is monotonic: if both ends of an enclosure round to the same double, or to the same N digits, so does
the true value between them. If they differ, the precision is doubled and the quantity computed again (Ziv's
strategy). This ends, because the width tends to zero, unless the true value is a tie between two results, or
0. Most values not computed in fractions are transcendental and so no ties: e^q and ln q are for rational q
other than 0 and 1, and e^{πq} is (A. O. Gelfond). But sin 30° and cos 60° are rational, and e^{μφ} can
cancel. So a value that agrees with a tie in `CLOSEST` digits is taken for the tie, and a difference that is 0
in so many digits of its terms for 0. Inputs have too few digits (1500) for another value so close.

A comparison, such as μφ against ln(T_h/T_l), is decided once the enclosure of the difference excludes zero.
"""

from __future__ import annotations

from collections.abc import Callable
from decimal import ROUND_HALF_EVEN, Decimal
from fractions import Fraction
from typing import TYPE_CHECKING, TypeVar

from .interval import ZERO, Enclosure, Unsettled, decimal_context, enclosures
from .rational import EXACT, Irrational

if TYPE_CHECKING:
    from .rational import Quantity

A = TypeVar("A")
T = TypeVar("T", bound=float | Decimal)

# Far more than any valid input was found to need (about 6000): a bug must not become a hang.
LARGEST_PRECISION = 50_000
CLOSEST, ENOUGH = 6000, 6050
"""The digits in which a value must agree with a tie to be taken for it; and a precision that shows them."""
SUSPECT = 800
"""If a value is not settled at this precision, the next one is `ENOUGH`, as it may be a tie."""
GUARD_DIGITS = 8
"""Digits beyond the wanted ones in the first computation of a quantity."""
SIGN_DIGITS = 17 + GUARD_DIGITS
"""Digits of the first computation of a sign."""
TO_TIE = decimal_context(CLOSEST - 10, ROUND_HALF_EVEN)
"""Rounds a value that agrees with a tie in `CLOSEST` digits to the tie, as no tie has so many digits."""


def settle(quantity: Quantity, round_: Callable[[Fraction | Decimal], T], digits: int) -> T:
    """The correctly rounded value of a quantity; ``digits`` is about the number of digits wanted."""

    def rounded(value: Enclosure) -> T:
        lo, hi = round_(value.lo), round_(value.hi)
        if lo == hi:
            return lo
        if value.arithmetic.digits < CLOSEST:
            raise Unsettled(ENOUGH if value.arithmetic.digits >= SUSPECT else 0)
        if value.lo <= 0 <= value.hi:
            return round_(ZERO)
        if TO_TIE.divide(TO_TIE.subtract(value.hi, value.lo), value.hi).adjusted() > -CLOSEST:
            raise Unsettled
        return round_(TO_TIE.plus(value.lo))

    try:
        return round_(quantity(EXACT))
    except Irrational:
        return _refine(quantity, rounded, digits + GUARD_DIGITS)


def is_positive(quantity: Quantity) -> bool:
    """Whether a quantity is positive that is known to be irrational, so not zero."""

    def sign(value: Enclosure) -> bool | None:
        return value.lo > 0 if value.lo > 0 or value.hi < 0 else None

    return _refine(quantity, sign, SIGN_DIGITS)


def _refine(quantity: Quantity, answer: Callable[[Enclosure], A | None], digits: int) -> A:
    """Refine the enclosure of a quantity until ``answer`` is not None, and return that."""
    while digits < LARGEST_PRECISION:
        needed = 0
        try:
            if (settled := answer(quantity(enclosures(digits)))) is not None:
                return settled
        except Unsettled as unsettled:
            needed = unsettled.digits
        digits = max(2 * digits, needed)
    raise ArithmeticError(f"not settled within {LARGEST_PRECISION} digits")
