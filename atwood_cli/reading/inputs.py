"""Read inputs, words and numbers, exactly."""

from __future__ import annotations

import re
from decimal import Decimal
from fractions import Fraction
from math import inf
from numbers import Rational, Real
from typing import Any

from ..numbers.rational import OfFloat
from ..numbers.text import in_quotes, nearest, without_blanks
from ..solver.scene import DEFAULTS, Angle, Given, Input, Parameter, SceneError, Unit, parameter_of
from .units import (
    MAX_DIGITS,
    MAX_MAGNITUDE,
    NOT_A_NUMBER,
    TOO_LONG,
    Malformed,
    NotANumber,
    in_ascii,
    is_uncertain,
    limited,
    read_number,
)


def is_missing(value: object) -> bool:
    """Decide whether a value is not given: None, a masked one of NumPy, NA or NaT of pandas."""
    return value is None or type(value).__name__ in ("MaskedConstant", "NAType", "NaTType")


def read_input(name: str, given: Given | None, signed: bool = False) -> Input:
    """Read one input, whose text may carry a standard uncertainty; ``signed`` allows it to be below 0.

    Raises SceneError.
    """
    if given is None or is_missing(given):
        return Input(Fraction(DEFAULTS[name]) if name in DEFAULTS else None)
    if isinstance(given, str):
        read = _read_text(name, given)
    elif isinstance(given, Angle) and name == "wrap":
        read = Input(_exact_number(name, given.number), unit=Unit(given.unit))
    else:
        read = Input(_exact_number(name, given))
    _check_domain(name, given, read.number, signed)
    return read._replace(given=given)


def read_exactly(name: str, given: Given | None) -> Input:
    """Read one input, which must carry no uncertainty. Raises SceneError."""
    if isinstance(given, str) and is_uncertain(given):
        raise SceneError(name, given, NO_UNCERTAINTY)
    return read_input(name, given)


def read_whole(name: str, given: int | str, least: int, most: int) -> int:
    """Read a whole number within bounds. Raises SceneError."""
    whole = given
    if isinstance(given, str) and given.isascii() and given.isdigit() and len(given) <= len(str(most)):
        whole = int(given)
    if type(whole) is not int or not least <= whole <= most:
        raise SceneError(name, given, f"must be a whole number from {least} to {most}")
    return whole


def read_digits(given: int | str | None) -> int | None:
    """Read how many significant digits are asked for. Raises SceneError."""
    return None if given is None else read_whole("digits", given, 1, MAX_DIGITS)


BY_A_MOTOR = "; the force of a motor is found by atwood solve --find drive"


def _check_domain(name: str, given: Given, value: Fraction | float, signed: bool) -> None:
    """Raise SceneError if an input may not have this value."""
    parameter = parameter_of(name)
    too_small = (value < 0 and not signed) or (value == 0 and not parameter.may_be_zero)
    too_small &= not parameter.signed
    if too_small or (abs(value) == inf and not parameter.may_be_infinite):
        by_motor = BY_A_MOTOR if name == "axle" and value < 0 else ""
        raise SceneError(name, given, parameter.domain + by_motor)


def _read_text(name: str, text: str) -> Input:
    """Read the number in a text. Raises SceneError."""
    parameter = parameter_of(name)
    word = without_blanks(text).lower()
    if parameter.may_be_infinite and word == "inf":
        return Input(inf)
    try:
        return read_number(parameter.names.get(word, text), parameter.dimension, parameter.terms)
    except Malformed as error:
        if re.fullmatch(r"[^,]*\d,\d[^,]*", text) or ("," in text and is_uncertain(text)):
            rule = "has a comma; write a decimal point, and nothing between thousands"
        else:
            rule = _not_a_number(parameter, in_ascii(text)) if isinstance(error, NotANumber) else str(error)
        raise SceneError(name, text, rule) from None


NO_UNCERTAINTY = "has an uncertainty, which only solve and fit take; give the value alone"
IS_NOT_ONE = "is not a number; atwood sweep takes a range as start:stop:count, and a list as 1,2,5"
NUMBER_SIGNS = "±µμ°·²⁻π"
"""The characters beyond ASCII that numbers and their units may have."""


def _not_a_number(parameter: Parameter, word: str) -> str:
    if not word:
        return "is empty; give a value, or leave it out"
    if word.lower() in ("nan", "inf", "+inf", "-inf", "infinity", "∞"):
        return parameter.domain
    if not word.isascii() and re.search("[0-9]", word):
        from unicodedata import name

        odd = min(re.findall("[^ -~]", word), key=NUMBER_SIGNS.__contains__)
        return f"{NOT_A_NUMBER}, without the {in_quotes(odd)} ({name(odd, 'no letter').lower()})"
    if re.match(r"[-+.]?\d.*[:,]|[\d.]+-[\d.]+$", word):
        return IS_NOT_ONE
    names = f", or one of {', '.join(parameter.names)}" if parameter.names else ""
    locked = "; inf is a locked pulley" if parameter.may_be_infinite else ""
    return f"{NOT_A_NUMBER}{names}{locked}{nearest(word, parameter.names)}"


def _exact_number(name: str, given: object) -> Fraction | float:
    is_duration = getattr(getattr(given, "dtype", None), "kind", "") == "m"  # NumPy's pass for integers
    if isinstance(given, bool) or is_duration or not isinstance(given, Real | Decimal):
        many = isinstance(given, list) or bool(getattr(given, "shape", False))
        rule = "must be text or a number (str, int, float, Decimal, Fraction)"
        raise SceneError(name, given, f"{rule}; for many see solve_arrays" if many else rule)
    if isinstance(given, Decimal) and given.is_finite() and given:
        longest = max(given.adjusted(), -int(given.as_tuple().exponent))
        if longest > MAX_MAGNITUDE:  # it must not become a huge integer
            raise SceneError(name, given, TOO_LONG)
    try:
        if isinstance(given, Rational):
            ratio: tuple[Any, Any] = given.numerator, given.denominator
        else:  # NumPy's long doubles are beyond doubles
            ratio = (given if hasattr(given, "as_integer_ratio") else float(given)).as_integer_ratio()
        kind = Fraction if isinstance(given, Rational | Decimal) else OfFloat
        return limited(kind(*map(int, ratio)))  # NumPy's integers have parts that are no ints
    except Malformed as error:
        raise SceneError(name, given, str(error)) from None
    except ValueError:  # not a number
        raise SceneError(name, given, parameter_of(name).domain) from None
    except OverflowError:
        return float(given)
