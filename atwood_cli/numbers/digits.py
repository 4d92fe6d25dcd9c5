"""Rounding to digits, half to even, and numbers as people read them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from decimal import ROUND_HALF_EVEN, Decimal, Inexact
from fractions import Fraction
from math import inf, isinf
from typing import TypeVar

from .interval import ZERO, decimal_context
from .rational import OfFloat

T = TypeVar("T", bound=float | Decimal)
Number = TypeVar("Number", float, Decimal)
Rounding = Callable[[Fraction | Decimal], T]

DOUBLE_DIGITS, SHOWN_DIGITS = 17, 6
"""Significant digits: of doubles, of tables and sentences."""
MOST_DIGITS = 5000
"""More digits than any two numbers that are shown side by side differ in size."""
ALL_DIGITS = decimal_context(MOST_DIGITS, ROUND_HALF_EVEN)
"""Keeps all digits of numbers that are shown."""


def to_double(x: Fraction | Decimal) -> float:
    """Return the nearest double, half to even; ±inf beyond the range, never -0."""
    try:
        return float(x) + 0.0
    except OverflowError:
        return inf if x > 0 else -inf


def is_infinite(value: float | Decimal) -> bool:
    """Decide whether a value is infinite. (math.isinf would convert a Decimal to a double first.)"""
    return value.is_infinite() if isinstance(value, Decimal) else isinf(value)


def to_digits(digits: int, rounding: str = ROUND_HALF_EVEN) -> Rounding[Decimal]:
    """Return a function that rounds to so many significant digits, with trailing zeros, never -0."""
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


def rounding_apart_from(given: Fraction | None, digits: int) -> Rounding[Decimal]:
    """Return a function that rounds to so many digits, until the result is not that of ``given``.

    If it is the given number, all its digits are kept.
    """

    def round_(x: Fraction | Decimal) -> Decimal:
        shown = to_digits(digits)(x)
        if given is not None and x == given:
            return exact_decimal(given) or shown
        if given is None or not shown.is_finite() or abs(shown.adjusted()) > MOST_DIGITS:
            return shown
        for kept in range(digits, MOST_DIGITS):
            round_alike = to_digits(kept)
            if (near := round_alike(x)) != round_alike(given):
                return near
        return shown

    return round_


def rounding_to_place(place: int) -> Rounding[Decimal]:
    """Return a function that rounds to a multiple of 10^place, half to even, never -0."""
    unit = Decimal((0, (1,), place))

    def round_(x: Fraction | Decimal) -> Decimal:
        if isinstance(x, Fraction):  # round to an integer number of units first, which is exact
            x = ALL_DIGITS.multiply(Decimal(round(x / Fraction(10) ** place)), unit)
        value = ALL_DIGITS.quantize(x, unit) if x.is_finite() else x
        return value if value else value.copy_abs()

    return round_


def exact_decimal(q: Fraction) -> Decimal | None:
    """Return a rational number as a decimal, without the zeros of a huge one; None if it is none."""
    context = decimal_context(MOST_DIGITS, ROUND_HALF_EVEN)
    value = context.divide(Decimal(q.numerator), Decimal(q.denominator))
    if context.flags[Inexact]:
        return None
    return context.normalize(value) if value.adjusted() >= 16 else value


def as_typed(q: Fraction, longest: float = 16) -> str:
    """Return the exact decimal of a rational number; else n/d, rounded if that is too long to read.

    Floats print as Python prints them.
    """
    if isinstance(q, OfFloat):
        return format_number(float(q))
    value = exact_decimal(q)
    if value is None and len(str(q)) > longest:
        value = strip_zeros(to_digits(DOUBLE_DIGITS)(q))
    return str(q) if value is None else format_number(value)


def exact_or_rounded(q: Fraction, round_: Rounding[T]) -> T | Decimal:
    """Return the exact number if it is a decimal, else the rounded one."""
    value = exact_decimal(q)
    return round_(q) if value is None else value


def half_range(numbers: Sequence[Number]) -> Number:
    """Return half the range of a result at an uncertain input and at both its ends (Kragten's step)."""
    return (max(numbers) - min(numbers)) / 2


def rounding_to_uncertainty(u: Fraction | Decimal) -> Rounding[Decimal]:
    """Return a function that rounds at the second digit of a standard uncertainty u > 0."""
    return rounding_to_place(to_digits(2)(u).adjusted() - 1)


def with_uncertainty(value: Decimal, u: Decimal, ends: Sequence[Decimal] = ()) -> tuple[str, str]:
    """Return a value with its uncertainty, 0.764 ± 0.012, and its interval, 0.740 to 0.788, "" without ends.

    They share a power of ten: (1.49 ± 0.13)e-5 and (1.24 to 1.74)e-5.
    """
    power = max(x.adjusted() for x in (value, u) if x)
    both = share_exponent("{:f} ± {:f}", (value, u), power)
    return both, share_exponent("{:f} to {:f}", ends, power) if ends else ""


def share_exponent(form: str, numbers: Sequence[Decimal], power: int) -> str:
    """Return numbers in a form, with a common power of ten behind them if they are hard to read without."""
    if -4 <= power < 16:
        return form.format(*numbers)
    return f"({form.format(*(ALL_DIGITS.scaleb(x, -power) for x in numbers))})e{power}"


def strip_zeros(value: Decimal) -> Decimal:
    """Return a number without trailing zeros, and without an exponent if that would have few zeros."""
    short = ALL_DIGITS.normalize(value)
    is_short_integer = len(short.as_tuple().digits) <= short.adjusted() < 16
    return ALL_DIGITS.quantize(short, Decimal(1)) if is_short_integer else short


def format_number(value: float | Decimal) -> str:
    """Return the shortest text that reads back to the same double; all the digits of a decimal."""
    mantissa, _, exponent = str(value).lower().partition("e")
    if isinstance(value, float):
        mantissa = mantissa.removesuffix(".0")
    return f"{mantissa}e{int(exponent)}" if exponent else mantissa
