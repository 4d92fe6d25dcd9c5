"""From exact values and enclosures to correctly rounded digits and to text: why the last digit is right.

Every input is a rational number, taken exactly as typed. A quantity is first computed in exact fractions; if
its formula stays rational, one division, rounded once, gives the answer, ties included. Otherwise (an
exponential, logarithm or root was asked for) it is computed in enclosures.

Rounding is monotonic: if both ends of an enclosure round to the same double, or to the same N digits, so
does everything between them, the true value too. If they differ, the precision is doubled and the quantity
computed anew (Ziv's strategy). This ends because the width tends to zero, unless the true value is just the
tie between two results, or 0. Most of what is not computed in fractions is transcendental, as e^q and ln q
are for rational q other than 0 and 1, and e^{πq} (A. O. Gelfond), and so no tie. But sines and cosines of
30° and 60° are rational, so is 4^(1/2), and e^{μφ} can cancel. So where an enclosure closes in on a tie,
`residue` is asked whether the value is that number, and if it is, that number is rounded. Where it has no
answer (a root found by search), what agrees with a tie to `CLOSEST` digits is taken for it, so that all ends.

A comparison, such as μφ against ln(T_h/T_l), is decided once the enclosure of the difference excludes zero.
"""

from __future__ import annotations

from collections.abc import Callable
from decimal import ROUND_CEILING, ROUND_FLOOR, ROUND_HALF_EVEN, Decimal, Inexact
from fractions import Fraction
from math import inf, isfinite, nextafter
from typing import TYPE_CHECKING, Any, TypeVar

from .interval import ZERO, Enclosure, Unsettled, decimal_context, enclosures
from .rational import EXACT, Irrational

if TYPE_CHECKING:
    from .protocol import Quantity

A = TypeVar("A")
T = TypeVar("T", bound=float | Decimal)
Rounding = Callable[[Fraction | Decimal], T]

# Far more than any valid input was found to need (about 6000): a bug must not become a hang.
LARGEST_PRECISION = 50_000
# Closer to a tie than valid inputs can bring a value that is none; where residues cannot tell, it is one.
CLOSEST = 6000
WIDE = 5000  # digits, more than the ratio of any two numbers written beside each other has


def to_double(x: Fraction | Decimal) -> float:
    """The nearest double, half to even; ±inf beyond the range, never -0."""
    try:
        return float(x) + 0.0
    except OverflowError:
        return inf if x > 0 else -inf


def is_infinite(value: float | Decimal) -> bool:
    """Whether a value is too large to be written (math.isinf makes a double of it first)."""
    return value in (inf, -inf)


def to_digits(digits: int, rounding: str = ROUND_HALF_EVEN) -> Rounding[Decimal]:
    """Rounding to that many significant digits, half to even, trailing zeros kept, never -0."""
    context = decimal_context(digits, rounding)

    def round_(x: Fraction | Decimal) -> Decimal:
        if isinstance(x, Fraction):
            value = context.divide(Decimal(x.numerator), Decimal(x.denominator))
        else:
            value = context.plus(x)
        if not value:
            return ZERO
        if not value.is_finite():
            return value
        return context.quantize(value, Decimal((0, (1,), value.adjusted() - digits + 1)))

    return round_


def to_side(digits: int | None, up: bool) -> Rounding[Any]:
    """Rounding up or down, to that many digits or to the next double whose text is not beyond the value."""
    if digits is not None:
        return to_digits(digits, ROUND_CEILING if up else ROUND_FLOOR)

    def round_(x: Fraction | Decimal) -> float:
        value = to_double(x)
        while isfinite(value) and (shown := type(x)(text(value))) != x and (shown < x) == up:
            value = nextafter(value, inf if up else -inf)
        return value

    return round_


def to_place(place: int) -> Rounding[Decimal]:
    """Rounding to a multiple of 10^place, half to even, never -0."""
    context, unit = decimal_context(WIDE, ROUND_HALF_EVEN), Decimal((0, (1,), place))

    def round_(x: Fraction | Decimal) -> Decimal:
        if isinstance(x, Fraction):  # to a whole number of units first, which is exact
            x = context.multiply(Decimal(round(x / Fraction(10) ** place)), unit)
        value = context.quantize(x, unit) if x.is_finite() else x
        return value if value else value.copy_abs()

    return round_


def settle(quantity: Quantity, round_: Rounding[T], digits: int) -> T:
    """The correctly rounded value of a quantity; ``digits`` is about how many are wanted."""
    from_zero = 0

    def rounded(value: Enclosure) -> T | None:
        nonlocal from_zero
        lo, hi = round_(value.lo), round_(value.hi)
        if lo == hi:
            return lo
        from_zero += value.lo <= 0 <= value.hi
        tie = _tie(value, lo, hi, digits) if from_zero != 1 else None
        if tie is None or not (_is(quantity, tie) or _is_narrow(value, CLOSEST)):
            return None
        return round_(tie)

    try:
        return round_(quantity(EXACT))
    except Irrational:
        return _refine(quantity, rounded, digits + 8)


def _tie(value: Enclosure, lo: float | Decimal, hi: float | Decimal, digits: int) -> Fraction | None:
    """The number between two rounded results that an enclosure seems to close in on, if it is one."""
    if value.lo <= 0 <= value.hi:
        return Fraction(0)
    if is_infinite(lo) or is_infinite(hi) or abs(value.hi.adjusted()) > WIDE:
        return None
    return (Fraction(lo) + Fraction(hi)) / 2 if _is_narrow(value, digits) else None


def _is_narrow(value: Enclosure, digits: int) -> bool:
    """Whether the ends of an enclosure beside 0 agree to about so many digits."""
    if value.lo <= 0 <= value.hi:
        return False
    context = decimal_context(digits, ROUND_HALF_EVEN)
    width = context.divide(context.subtract(value.hi, value.lo), value.hi)
    return width.adjusted() <= -digits


def _is(quantity: Quantity, value: Fraction) -> bool:
    from .residue import is_rational

    return is_rational(quantity, value)


def is_positive(quantity: Quantity) -> bool:
    """The sign of a quantity that is known to be irrational, so not zero."""

    def sign(value: Enclosure) -> bool | None:
        return value.lo > 0 if value.lo > 0 or value.hi < 0 else None

    return _refine(quantity, sign, 24)


def _refine(quantity: Quantity, answer: Callable[[Enclosure], A | None], digits: int) -> A:
    """What ``answer`` says of the first enclosure of the quantity that is tight enough for it, not None."""
    while digits < LARGEST_PRECISION:
        needed = 0
        try:
            if (settled := answer(quantity(enclosures(digits)))) is not None:
                return settled
        except Unsettled as unsettled:
            needed = unsettled.digits
        digits = max(2 * digits, needed)
    raise ArithmeticError(f"not settled within {LARGEST_PRECISION} digits")


def as_typed(q: Fraction) -> str:
    """The exact decimal of a rational number, or n/d where it has none."""
    context = decimal_context(WIDE, ROUND_HALF_EVEN)
    value = context.divide(Decimal(q.numerator), Decimal(q.denominator))
    if context.flags[Inexact]:
        return str(q)
    return text(context.normalize(value) if value.adjusted() >= 16 else value)


def with_uncertainty(cut: Callable[[int], Decimal], u: Decimal) -> str:
    """A value and its standard uncertainty u > 0, both cut at the second digit of u: 0.764 ± 0.012.

    ``cut`` rounds the value to a multiple of a power of ten, as `to_place` does.
    """
    place = to_digits(2)(u).adjusted() - 1
    pair = cut(place), to_place(place)(u)
    power = max(x.adjusted() for x in pair if x)
    if -4 <= power < 16:
        return "{:f} ± {:f}".format(*pair)
    context = decimal_context(WIDE, ROUND_HALF_EVEN)
    return "({:f} ± {:f})e{}".format(*(context.scaleb(x, -power) for x in pair), power)


def tidy(value: Decimal) -> Decimal:
    """The same number without trailing zeros, and without an exponent where it is readable without."""
    context = decimal_context(WIDE, ROUND_HALF_EVEN)
    short = context.normalize(value)
    if len(short.as_tuple().digits) <= short.adjusted() < 16:
        return context.quantize(short, Decimal(1))
    return short


def text(value: float | Decimal) -> str:
    """The shortest text that reads back to the same double; all the digits of a decimal."""
    mantissa, _, exponent = str(value).lower().partition("e")
    if isinstance(value, float):
        mantissa = mantissa.removesuffix(".0")
    return f"{mantissa}e{int(exponent)}" if exponent else mantissa
