"""Correct rounding of exact values and enclosures to digits and text, and why the last digit is right.

Every input is a rational number, taken exactly as typed. A quantity is first computed in exact fractions. If
its formula stays rational, one division, rounded once, gives the result, ties included. Otherwise (it has an
exponential, a logarithm or a root) it is computed in enclosures.

Rounding is monotonic: if both ends of an enclosure round to the same double, or to the same N digits, so does
the true value between them. If they differ, the precision is doubled and the quantity computed again (Ziv's
strategy). This ends, because the width tends to zero, unless the true value is a tie between two results, or
0. Most values not computed in fractions are transcendental and so no ties: e^q and ln q are for rational q
other than 0 and 1, and e^{πq} is (A. O. Gelfond, 1929). But sin 30° and cos 60° are rational, and e^{μφ} can
cancel. So a value that agrees with a tie in `TIE_DIGITS` digits is taken for the tie, and a difference that
is 0 in so many digits of its terms for 0. Inputs have too few digits (1500) for another value so close.

A comparison, such as μφ against ln(T_h/T_l), is decided once the enclosure of the difference excludes zero.
"""

from __future__ import annotations

from collections.abc import Callable
from decimal import ROUND_HALF_EVEN, Decimal
from fractions import Fraction
from typing import TYPE_CHECKING, TypeVar

from .interval import ZERO, Enclosure, NeedsMoreDigits, decimal_context, enclosures
from .rational import EXACT, Irrational

if TYPE_CHECKING:
    from .rational import Quantity

A = TypeVar("A")
T = TypeVar("T", bound=float | Decimal)

# Far more than any valid input was found to need (about 6000): a bug must not become a hang.
LARGEST_PRECISION = 50_000
TIE_DIGITS = 6000
"""A value that agrees with a tie in so many digits is the tie."""
TO_TIE = decimal_context(TIE_DIGITS, ROUND_HALF_EVEN)
"""Rounds both ends of an enclosure that is narrow enough to the tie in it, as no tie has so many digits."""
GUARD_DIGITS = 8
"""Digits beyond the wanted ones in the first computation of a quantity."""
SIGN_DIGITS = 17 + GUARD_DIGITS
"""Digits of the first computation of a sign."""


def settle(quantity: Quantity, round_: Callable[[Fraction | Decimal], T], digits: int) -> T:
    """Return the correctly rounded value of a quantity; ``digits`` is about the number of digits wanted."""

    def rounded(value: Enclosure) -> T | None:
        lo, hi = round_(value.lo), round_(value.hi)
        if lo == hi:
            return lo
        precision = value.arithmetic.digits
        if precision < TIE_DIGITS // 8:
            return None
        if precision < TIE_DIGITS:  # it may be a tie, which more digits than that show
            raise NeedsMoreDigits(TIE_DIGITS + 4 * GUARD_DIGITS)
        if value.lo <= 0 <= value.hi:
            return round_(ZERO)
        near_lo, near_hi = TO_TIE.plus(value.lo), TO_TIE.plus(value.hi)
        return round_(near_lo) if near_lo == near_hi else None

    try:
        return round_(quantity(EXACT))
    except Irrational:
        return _refine(quantity, rounded, digits + GUARD_DIGITS)


def is_positive(quantity: Quantity) -> bool:
    """Decide whether an irrational quantity, which cannot be 0, is positive.

    By the theorem of Gelfond, e^{πq} is transcendental for rational q other than 0, and so is every rational
    function of it that is not constant.
    """

    def sign(value: Enclosure) -> bool | None:
        return value.lo > 0 if value.lo > 0 or value.hi < 0 else None

    return _refine(quantity, sign, SIGN_DIGITS)


def _refine(quantity: Quantity, answer: Callable[[Enclosure], A | None], digits: int) -> A:
    """Refine the enclosure of a quantity until ``answer`` is not None, and return that."""
    while digits < LARGEST_PRECISION:
        needed: tuple[int, ...] = ()
        try:
            if (settled := answer(quantity(enclosures(digits)))) is not None:
                return settled
        except NeedsMoreDigits as unsettled:
            needed = unsettled.args
        digits = max([2 * digits, *needed])
    raise ArithmeticError(f"not settled within {LARGEST_PRECISION} digits")
