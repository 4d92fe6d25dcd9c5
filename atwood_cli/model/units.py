"""Numbers as people type them, exactly: 1.5e-3, 1/3, 250g, 9.81 m/s2, 3pi/2, 1.000(2), (250±1)g."""

import re
from collections.abc import Iterable, Mapping
from decimal import ROUND_FLOOR, Decimal
from fractions import Fraction
from math import inf
from typing import NamedTuple

from ..arithmetic.rounding import as_typed, to_digits

STANDARD_GRAVITY = "9.80665"
"""m/s², exact by definition: 3rd General Conference on Weights and Measures, 1901."""
FOOT, POUND_FORCE = "0.3048", "4.4482216152605"
"""m and N, exact: the pound-force is the weight of a pound, 0.45359237 kg, in standard gravity."""
SLUG = str(Fraction(POUND_FORCE) / Fraction(FOOT))
"""kg: the mass that a pound-force accelerates by 1 ft/s²."""

# fmt: off
MASS = {
    "kg": "1", "g": "1e-3", "mg": "1e-6", "ug": "1e-9", "t": "1e3",
    "lb": "0.45359237", "lbs": "0.45359237", "oz": "0.028349523125", "st": "6.35029318", "slug": SLUG,
}
LENGTH = {
    "m": "1", "km": "1e3", "dm": "1e-1", "cm": "1e-2", "mm": "1e-3", "um": "1e-6",
    "in": "0.0254", "ft": FOOT, "yd": "0.9144",
}
# fmt: on
ANGLE = {"deg": "1", "°": "1", "turn": "360", "rad": "1"}
"""In degrees; radians stay radians."""
TIME = {"s": "1", "ms": "1e-3", "min": "60", "h": "3600"}
FORCE = {"N": "1", "mN": "1e-3", "kN": "1e3", "lbf": POUND_FORCE, "kgf": STANDARD_GRAVITY}
TORQUE = {"Nm": "1", "mNm": "1e-3"}
COMPOUND = {
    "acceleration": ("m/s2", "cm/s2", "ft/s2", "N/kg"),
    "moment of inertia": ("kg m2", "g cm2", "lb ft2"),
}
SIMPLE = {"mass": MASS, "length": LENGTH, "angle": ANGLE, "time": TIME, "force": FORCE, "torque": TORQUE}
DIMENSIONS: Mapping[str, Iterable[str]] = {**SIMPLE, **COMPOUND}
"""The dimensions, and the units of each that a message names. Others are made of those, as km/h2."""
POWERS = {
    **{"mass": [1, 0, 0, 0], "length": [0, 1, 0, 0], "time": [0, 0, 1, 0], "angle": [0, 0, 0, 1]},
    **{"force": [1, 1, -2, 0], "torque": [1, 2, -2, 0]},
    **{"acceleration": [0, 1, -2, 0], "moment of inertia": [1, 2, 0, 0]},
}
"""By dimension, the powers of mass, length, time and angle in it."""
SYMBOLS = {
    symbol: (Fraction(factor), POWERS[dimension])
    for dimension, factors in SIMPLE.items()
    for symbol, factor in factors.items()
}
# fmt: off
WORDS = {
    "kilogram": "kg", "kilogramme": "kg", "kilo": "kg", "gram": "g", "gramme": "g", "milligram": "mg",
    "microgram": "ug", "tonne": "t", "pound": "lb", "lbm": "lb", "ounce": "oz", "stone": "st",
    "metre": "m", "meter": "m", "kilometre": "km", "kilometer": "km", "decimetre": "dm", "decimeter": "dm",
    "centimetre": "cm", "centimeter": "cm", "millimetre": "mm", "millimeter": "mm", "micrometre": "um",
    "micrometer": "um", "micron": "um", "inch": "in", "inche": "in", "foot": "ft", "feet": "ft", "yard": "yd",
    "degree": "deg", "revolution": "turn", "rev": "turn", "radian": "rad", "newton": "N",
    "second": "s", "sec": "s", "millisecond": "ms", "minute": "min", "hour": "h", "hr": "h",
}
# fmt: on
"""Units written out, in small letters and without the s of a plural."""

MAX_DIGITS, MAX_EXPONENT = 1000, 500
"""Of a number as it is typed, and of the number that it is in SI units."""
MAX_UNIT = 60
"""Characters of a unit."""
# No text within those limits is longer as a numerator or denominator.
MAX_MAGNITUDE = MAX_DIGITS + MAX_EXPONENT
_LARGEST = 10**MAX_MAGNITUDE
TOO_LONG = f"is too long; numerator and denominator may have {MAX_MAGNITUDE} digits"

_TERM = r"[A-Za-zµμ]+(?:\^?-?[1-9]|⁻?[¹²³])?"
_UNIT = rf"(?:{_TERM}(?: ?[*·/ ] ?{_TERM})*|°)"
_DIGITS, _POWER, _TAIL = r"(?:\d+(?:\.\d*)?|\.\d+)", r"(?:[eE][+-]?\d+)?", rf"(?: ?{_UNIT})?"
_DECIMAL = rf"[+-]?{_DIGITS}{_POWER}"
_QUOTIENT = rf"{_DECIMAL}(?: ?/ ?{_DECIMAL})?"
NUMBER = re.compile(rf"({_QUOTIENT})(?: ?({_UNIT}))?", re.ASCII)
_MULTIPLE = rf"({_QUOTIENT}|[+-]?) ?\*? ?(?:%s)(?: ?/ ?({_DECIMAL}))?"
MULTIPLES = {
    "angle": (_MULTIPLE % "(?i:pi)|π" + "(?: ?rad)?", "pi", Fraction(180)),
    "acceleration": (_MULTIPLE % "g", "g", Fraction(STANDARD_GRAVITY)),
}
"""By dimension, the constant of which a number may be a multiple, as in 3pi/2, and what that is."""
MEGA = re.compile("M[a-z]|MN.*")
"""Megagrams, megametres and meganewtons are no thousandths in capitals."""
_FACTOR = re.compile(r"([*·/ ]*)([A-Za-z]+|°)\^?(-?[1-9])?")
_PLAIN = str.maketrans("µμ⁻¹²³", "uu-123")

# An uncertainty: in units of the last digit, 1.000(2), or written out, 1.000±0.002, (1.000±0.002)g, 1g±2%.
_SIGN = r" ?(?:±|\+/-) ?"
IN_LAST_DIGITS = rf"([+-]?{_DIGITS})\((\d+)\)({_POWER}{_TAIL})"
IN_BRACKETS = rf"\(([+-]?{_DIGITS}){_SIGN}({_DIGITS})( ?%)?\)({_POWER}{_TAIL})"
WRITTEN_OUT = rf"({_QUOTIENT})({_TAIL}){_SIGN}(?![+-])({_QUOTIENT})({_TAIL}| ?%)"
UNCERTAIN = ("(", "±", "+/-")
PERCENT = "%"
NOT_A_NUMBER = "is not a number; write it like 2, 0.5 or 1.5e-3"
NOT_UNCERTAIN = (
    "is not a number with its uncertainty; write it like 1.000±0.002, 1.000+/-0.002 or 1.000(2),"
    " and a unit after that"
)


class Malformed(ValueError):
    """A text that is no such number; the message is the rule it breaks."""


class NotANumber(Malformed):
    """A text that does not look like a number at all."""


class Number(NamedTuple):
    """A number as it was typed: exact, with its standard uncertainty, in SI units, degrees or radians.

    ``unit`` is the symbol of the unit, or its text if it is made of several, and is empty if there is none.
    The value is a float only where it is infinite.
    """

    value: Fraction | float
    unit: str = ""
    uncertainty: Fraction = Fraction(0)


def shortened(text: str, most: int = 60) -> str:
    """The text as a message shows it: where it is longer than that, only how it begins and ends."""
    return text if len(text) <= most else f"{text[: most - 20]}...{text[-10:]}"


def in_quotes(value: object) -> str:
    """What was typed or read, as a message shows it."""
    return shortened(repr(str(value) if isinstance(value, str) else value))  # not np.str_("hoop")


def counted(count: int, thing: str) -> str:
    """A count with its noun: 1 row, 2 rows."""
    return f"{count} {thing}{'s' * (count != 1)}"


def without_blanks(text: str) -> str:
    """The text without blanks around it, and with plain single ones within: a no-break space is a blank."""
    return " ".join(text.split())


def is_uncertain(text: str) -> bool:
    """Whether the text is meant to carry an uncertainty."""
    return any(mark in text for mark in UNCERTAIN)


def read_number(text: str, dimension: str | None) -> Number:
    """The number that a text is, with its unit and its uncertainty if it has them.

    ``dimension`` is one of `DIMENSIONS`, or two with an "or" between, or None for a number that takes no
    unit. Raises Malformed.
    """
    text = without_blanks(text)
    if not is_uncertain(text):
        return Number(*_read_exactly(text, dimension))
    typed, u = _split_uncertainty(text)
    value, unit = _read_exactly(typed, dimension)
    if u.endswith(PERCENT):
        return Number(value, unit, _read_exactly(u.removesuffix(PERCENT), None)[0] * abs(value) / 100)
    return Number(value, unit, _read_exactly(u, dimension)[0])


def _split_uncertainty(text: str) -> tuple[str, str]:
    """The texts of a value and of its uncertainty: 0.25(12)g is 0.25g and 0.12g, 55g±1% is 55g and 1%.

    Raises Malformed.
    """
    if match := re.fullmatch(IN_LAST_DIGITS, text, re.ASCII):
        value, digits, tail = match.groups()
        places = len(value.partition(".")[2])
        return value + tail, f"{Decimal((0, tuple(map(int, digits)), -places)):f}{tail}"
    if match := re.fullmatch(IN_BRACKETS, text, re.ASCII):
        value, u, percent, tail = match.groups()
        return value + tail, u + (PERCENT if percent else tail)
    match = re.fullmatch(WRITTEN_OUT, text, re.ASCII)
    if match and match[4].endswith(PERCENT):
        return match[1] + match[2], match[3] + PERCENT
    if not match or match[2] not in ("", match[4]):
        raise Malformed(NOT_UNCERTAIN)
    return match[1] + match[4], match[3] + match[4]


def _read_exactly(text: str, dimension: str | None) -> tuple[Fraction, str]:
    """The value of a number without an uncertainty, and its unit. Raises Malformed."""
    pattern, constant, worth = MULTIPLES.get(dimension or "", ("", "", Fraction(0)))
    if pattern and (multiple := re.fullmatch(pattern, text, re.ASCII)):
        times, parts = multiple.groups(default="1")
        one = "1" * (not times.strip("+-"))
        return limited(_quotient(times + one) * worth * _quotient(f"1/{parts}")), constant
    match = NUMBER.fullmatch(text)
    if not match:
        raise NotANumber(NOT_A_NUMBER)
    number, unit = match.groups(default="")
    value = _quotient(number)
    if not unit:
        return value, ""
    if dimension is None:
        raise Malformed(f"must be a plain number, without the {in_quotes(unit)}")
    factor = read_unit(unit, dimension)
    value *= factor
    if "/" in number:
        limited(value)
    else:
        digits = re.sub("[^0-9]", "", as_typed(value, inf).partition("e")[0]).lstrip("0")
        exponent = _power(number) + to_digits(1, ROUND_FLOOR)(factor).adjusted()
        _check_size(len(digits), exponent, ", its unit included")
    return value, symbol_of(unit) or unit


def _quotient(text: str) -> Fraction:
    """The value of a decimal or a quotient of two. Raises Malformed."""
    over, slash, under = text.partition("/")
    if not slash:
        return _decimal(text)
    if not (divisor := _decimal(under.strip())):
        raise Malformed("divides by 0")
    return limited(_decimal(over.strip()) / divisor)


def _decimal(text: str) -> Fraction:
    """The value of a decimal. Raises Malformed."""
    mantissa = re.split("[eE]", text)[0]
    _check_size(len(re.sub("[^0-9]", "", mantissa)), _power(text))
    return Fraction(f"{mantissa}e{_power(text)}")


def _power(decimal: str) -> int:
    """The power of ten that a decimal is written with; of one beyond all bounds, its first digits."""
    exponent = decimal.lower().partition("e")[2]
    return int(f"{'-' * exponent.startswith('-')}{exponent.lstrip('+-0')[:5] or 0}")


def _check_size(digits: int, exponent: int, how: str = "") -> None:
    """Refuse a decimal that would take long. Raises Malformed."""
    if digits > MAX_DIGITS:
        raise Malformed(f"has {digits} digits{how}; at most {MAX_DIGITS} are taken")
    if abs(exponent) > MAX_EXPONENT:
        raise Malformed(f"has an exponent beyond {MAX_EXPONENT} in magnitude{how}")


def limited(value: Fraction) -> Fraction:
    """The same number, refused where it would take long. Raises Malformed."""
    if max(abs(value.numerator), value.denominator) >= _LARGEST:
        raise Malformed(TOO_LONG)
    return value


def read_unit(unit: str, wanted: str) -> Fraction:
    """The factor from a unit to the SI, or to degrees. Raises Malformed if it is of another dimension."""
    if len(unit) > MAX_UNIT:
        raise Malformed(f"has a unit of {len(unit)} characters; at most {MAX_UNIT} are taken")
    if not re.fullmatch(_UNIT, unit):
        raise Malformed(f"has the unknown unit {unit!r}; there are {_names(wanted)}")
    factor, powers = _measure(unit, wanted)
    # Radians are no rational multiple of degrees, so an angle takes a single unit.
    several = wanted == "angle" and not symbol_of(unit)
    if powers in [POWERS[one] for one in wanted.split(" or ")] and not several:
        return factor
    kind = "several parts" if several else _dimension(powers)
    raise Malformed(f"has a unit of {kind}; it takes one of {wanted} ({_names(wanted)})")


def dimension_of(unit: str) -> str:
    """The dimension of a unit that `read_number` took."""
    return _dimension(_measure(unit, "")[1])


def _dimension(powers: list[int]) -> str:
    return next((name for name in DIMENSIONS if POWERS[name] == powers), "another dimension")


def _names(wanted: str) -> str:
    """The units that a sentence names."""
    return ", ".join(unit for one in wanted.split(" or ") for unit in DIMENSIONS[one])


def _measure(unit: str, wanted: str) -> tuple[Fraction, list[int]]:
    """The factor from a unit to the SI, or to degrees, and its powers. Raises Malformed if it is unknown."""
    factor, powers = Fraction(1), [0, 0, 0, 0]
    for operator, word, power in _FACTOR.findall(unit.translate(_PLAIN)):
        symbol = symbol_of(word)
        if symbol is None:
            raise Malformed(f"has the unknown unit {word!r}{_near_units(word, wanted)}")
        times = int(power or 1) * (-1 if "/" in operator else 1)
        one, its_powers = SYMBOLS[symbol]
        factor *= one**times
        powers = [p + times * q for p, q in zip(powers, its_powers, strict=True)]
    return factor, powers


def symbol_of(word: str) -> str | None:
    """The symbol of a unit that may be written out, in the plural or in capitals; None if there is none."""
    if word in SYMBOLS:
        return word
    if MEGA.fullmatch(word):
        return None
    small = word.lower()
    for name in (small, small.removesuffix("s"), small.removesuffix("es")):
        if symbol := WORDS.get(name) or next((one for one in SYMBOLS if one.lower() == name), None):
            return symbol
    return None


def _near_units(word: str, wanted: str) -> str:
    """The hint at a unit of the dimension that begins alike, or else at those there are."""
    accepted = [POWERS[one] for one in wanted.split(" or ")]
    of_it = [name for name, (_, powers) in SYMBOLS.items() if powers in accepted]
    names = [*of_it, *(name for name, symbol in WORDS.items() if symbol in of_it)]
    alike = [name for name in names if name[0].lower() == word[0].lower() and not MEGA.fullmatch(word)]
    return nearest(word, alike) or f"; there are {_names(wanted)}"


def near(word: str, words: Iterable[str]) -> str:
    """The word that was probably meant, empty if none is near."""
    from difflib import get_close_matches

    words = list(words) if word else []
    close = get_close_matches(word.lower(), words, n=1) or [w for w in words if w.startswith(word.lower())]
    return close[0] if close else ""


def nearest(word: str, words: Iterable[str]) -> str:
    """A hint at the word that was probably meant, empty if none is near."""
    meant = near(word, words)
    return f"; did you mean {meant}?" if meant else ""
