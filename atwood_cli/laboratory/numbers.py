"""Numbers as they are published: cut where their uncertainty begins, with one power of ten in a row."""

from collections.abc import Mapping
from fractions import Fraction
from math import isfinite
from typing import NamedTuple

from ..arithmetic.rounding import DOUBLE_DIGITS, text, to_digits, to_place, with_one_power
from .quantities import QUANTITIES

MOST_DIGITS = 11
"""Digits that doubles leave right."""
COLUMNS = ("Quantity", "Value", "Unit", "Symbol", "95 % interval")


class Result(NamedTuple):
    """A value, its standard uncertainty, and its interval of 95 %."""

    value: float
    uncertainty: float
    interval: tuple[float, float]


def rows_of(results: Mapping[str, Result], digits: int | None = None) -> list[tuple[str, ...]]:
    """A table of results, with `COLUMNS`, a row a quantity."""
    written = {name: published(*one, digits) for name, one in results.items()}
    return [
        (name, value, QUANTITIES[name].unit, QUANTITIES[name].symbol, ends)
        for name, (value, ends) in written.items()
    ]


def published(
    value: float, uncertainty: float, interval: tuple[float, float] = (0, 0), digits: int | None = None
) -> tuple[str, str]:
    """A value ± its uncertainty, and its interval: (1.49 ± 0.13)e-5 and (1.24 to 1.74)e-5.

    All are cut at the second digit of the uncertainty, or at as many ``digits`` of the value as leave the
    uncertainty one. A value without uncertainty has six digits, and no interval. No number has more digits
    than a double.
    """
    largest = max(map(abs, (value, uncertainty, *interval)))
    place = max(_place(value, uncertainty, digits), _place(largest, largest, DOUBLE_DIGITS))
    numbers = [to_place(place)(Fraction(x)) for x in (value, uncertainty, *interval)]
    if not numbers[1]:
        most = MOST_DIGITS if uncertainty else 6
        return text(to_digits(digits or most)(Fraction(value))), ""
    power = max(number.adjusted() for number in numbers[:2] if number)
    both = with_one_power("{:f} ± {:f}", numbers[:2], power)
    return both, with_one_power("{:f} to {:f}", numbers[2:], power)


def shown(value: float, uncertainty: float | None) -> str:
    """A value ± its uncertainty, if it has one."""
    return published(value, uncertainty or 0)[0]


def cut(value: float, uncertainty: float | None) -> str:
    """A value cut at the second digit of an uncertainty; to six digits if there is none."""
    if not uncertainty:
        return text(to_digits(6)(Fraction(value)))
    return f"{to_place(_place(value, uncertainty))(Fraction(value)):f}"


def _place(value: float, uncertainty: float, digits: int | None = None) -> int:
    """The place of the last digit, as a power of ten."""
    first, of_u = (to_digits(2)(Fraction(x)).adjusted() if x else -(10**3) for x in (value, uncertainty))
    if digits is not None and value:
        return min(first - digits + 1, of_u)
    return max(of_u - 1, first - MOST_DIGITS + 1)


def few(value: float, digits: int = 2) -> str:
    """A value to a few digits, as people write it."""
    return f"{to_digits(digits)(Fraction(value)):f}"


def far(size: float) -> str:
    """How many standard uncertainties something is away."""
    return few(abs(size)) if isfinite(size) else "more than any number of"
