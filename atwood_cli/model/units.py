"""Numbers as people type them: 1.5e-3, 250g, 1.000(2), (250±1)g. All of it exact; nothing is rounded."""

import re
from collections.abc import Iterable
from fractions import Fraction

MASS = {
    "kg": "1",
    "g": "1e-3",
    "mg": "1e-6",
    "ug": "1e-9",
    "t": "1e3",
    "lb": "0.45359237",
    "lbs": "0.45359237",
    "oz": "0.028349523125",
    "st": "6.35029318",
}
LENGTH = {
    "m": "1",
    "km": "1e3",
    "dm": "1e-1",
    "cm": "1e-2",
    "mm": "1e-3",
    "um": "1e-6",
    "in": "0.0254",
    "ft": "0.3048",
    "yd": "0.9144",
}
ANGLE = {"deg": "1", "°": "1", "turn": "360", "rad": "1"}
"""In degrees, but for radians, which stay what they are."""
TIME = {"s": "1", "ms": "1e-3", "min": "60"}
DIMENSIONS = {"mass": MASS, "length": LENGTH, "angle": ANGLE, "time": TIME}

MAX_DIGITS, MAX_EXPONENT = 1000, 500
# No text within those limits is longer as a numerator or denominator.
MAX_MAGNITUDE = MAX_DIGITS + MAX_EXPONENT

NUMBER = re.compile(r"([+-]?)(\d+(?:\.\d+)?|\.\d+)(?:e([+-]?\d+))?(?: *([A-Za-z]+|°))?", re.ASCII)

# An uncertainty: in units of the last digit, 1.000(2), or written out, 1.000±0.002, (1.000±0.002)g.
_DIGITS, _EXPONENT, _UNIT = r"(?:\d+(?:\.\d+)?|\.\d+)", r"(?:e[+-]?\d+)?", r"(?: *(?:[A-Za-z]+|°))?"
IN_LAST_DIGITS = rf"([+-]?{_DIGITS})\((\d+)\)({_EXPONENT}{_UNIT})"
IN_BRACKETS = rf"\(([+-]?{_DIGITS}) *(?:±|\+/-) *({_DIGITS})\)({_EXPONENT}{_UNIT})"
WRITTEN_OUT = rf"([+-]?{_DIGITS}{_EXPONENT})({_UNIT}) *(?:±|\+/-) *({_DIGITS}{_EXPONENT})({_UNIT})"
UNCERTAIN = ("(", "±", "+/-")
NOT_UNCERTAIN = (
    "is not a number with its uncertainty; write it like 1.000±0.002, 1.000+/-0.002 or 1.000(2),"
    " and a unit after that"
)


class Malformed(ValueError):
    """A text that is no such number; the message is the rule it breaks."""


def is_uncertain(text: str) -> bool:
    """Whether the text is meant to carry an uncertainty."""
    return any(mark in text for mark in UNCERTAIN)


def split_uncertainty(text: str) -> tuple[str, str]:
    """The texts of a value and of its uncertainty: 0.25(12)g is 0.25g and 0.12g. Raises Malformed."""
    if match := re.fullmatch(IN_LAST_DIGITS, text, re.ASCII):
        value, digits, tail = match.groups()
        places = len(value.partition(".")[2])
        point = max(1, len(digits) - places)
        digits = digits.zfill(point + places)
        return value + tail, f"{digits[:point]}{'.' * bool(places)}{digits[point:]}{tail}"
    if match := re.fullmatch(IN_BRACKETS, text, re.ASCII):
        value, uncertainty, tail = match.groups()
        return value + tail, uncertainty + tail
    match = re.fullmatch(WRITTEN_OUT, text, re.ASCII)
    if not match or match[2] not in ("", match[4]):
        raise Malformed(NOT_UNCERTAIN)
    return match[1] + match[4], match[3] + match[4]


def read_number(text: str, dimension: str | None) -> tuple[Fraction, str] | None:
    """A number in SI units, degrees or radians, and the unit typed; None if it is no number at all.

    ``dimension`` is one of `DIMENSIONS`, or None for a number that takes no unit. Raises Malformed.
    """
    match = NUMBER.fullmatch(text)
    if not match:
        return None
    sign, mantissa, exponent, unit = match.groups(default="")
    digits = len(mantissa.replace(".", ""))
    power = exponent.lstrip("+-").lstrip("0") or "0"
    if digits > MAX_DIGITS:
        raise Malformed(f"has {digits} digits; at most {MAX_DIGITS} are taken")
    if len(power) > 3 or int(power) > MAX_EXPONENT:
        raise Malformed(f"has an exponent beyond {MAX_EXPONENT} in magnitude")
    value = Fraction(f"{sign}{mantissa}e{'-' * exponent.startswith('-')}{power}")
    return (value * _factor(unit, dimension) if unit else value), unit


def _factor(unit: str, wanted: str | None) -> Fraction:
    """What a unit is in the SI. Raises Malformed where it is unknown, or of another dimension."""
    if wanted is None:
        raise Malformed(f"must be a plain number, without the {unit!r}")
    factors = DIMENSIONS[wanted]
    if unit in factors:
        return Fraction(factors[unit])
    for dimension, others in DIMENSIONS.items():
        if unit in others:
            units = f"{wanted} ({', '.join(factors)})"
            raise Malformed(f"has a unit of {dimension}; it takes one of {units}")
    hint = nearest(unit, factors) or f"; there are {', '.join(factors)}"
    raise Malformed(f"has the unknown unit {unit!r}{hint}")


def nearest(word: str, words: Iterable[str]) -> str:
    """The hint that a near word may have been meant, empty if none is near."""
    from difflib import get_close_matches

    words = list(words)
    near = get_close_matches(word.lower(), words, n=1) or [w for w in words if w.startswith(word.lower())]
    return f"; did you mean {near[0]}?" if near else ""
