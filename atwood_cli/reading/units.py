"""Read numbers as people type them, exactly: 1.5e-3, 1½, 12cm/2, 80g+4*5g, 9.81 m/s2, 3pi/2, 1.000(2)."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from decimal import ROUND_FLOOR, Decimal
from fractions import Fraction
from functools import cache
from math import inf

from ..numbers.digits import as_typed, to_digits
from ..numbers.interval import Enclosures
from ..numbers.text import in_quotes, without_blanks
from ..solver.scene import MULTIPLE_OF_G, STANDARD_GRAVITY, WEIGHT, Input, Terms, Unit

FOOT, INCH, POUND = Fraction("0.3048"), Fraction("0.0254"), Fraction("0.45359237")
POUND_FORCE = POUND * Fraction(STANDARD_GRAVITY)

# fmt: off
UNITS: Mapping[str, Mapping[str, Fraction | str]] = {
    "mass": {
        "kg": "1", "g": "1e-3", "mg": "1e-6", "ug": "1e-9", "t": "1e3", "Mg": "1e3",
        "lb": POUND, "lbs": POUND, "oz": POUND / 16, "st": POUND * 14, "slug": POUND_FORCE / FOOT,
    },
    "length": {
        "m": "1", "km": "1e3", "dm": "1e-1", "cm": "1e-2", "mm": "1e-3", "um": "1e-6",
        "in": INCH, "ft": FOOT, "yd": FOOT * 3,
    },
    "angle": {"deg": "1", "°": "1", "turn": "360", "turns": "360", "rad": "1"},
    "time": {"s": "1", "ms": "1e-3", "us": "1e-6", "min": "60", "h": "3600"},
    "force": {
        "N": "1", "mN": "1e-3", "daN": "10", "kN": "1e3",
        "lbf": POUND_FORCE, "kip": POUND_FORCE * 1000, "kgf": STANDARD_GRAVITY,
        "gf": Fraction(STANDARD_GRAVITY) / 1000,
    },
    "energy": {"J": "1", "mJ": "1e-3", "kJ": "1e3", "ft lbf": FOOT * POUND_FORCE},
    "power": {"W": "1", "kW": "1e3"},
    "torque": {
        "N m": "1", "mN m": "1e-3", "N cm": "1e-2", "daN m": "10", "kN m": "1e3", "kgf m": STANDARD_GRAVITY,
        "lbf ft": POUND_FORCE * FOOT, "ft lbf": FOOT * POUND_FORCE, "lbf in": POUND_FORCE * INCH,
    },
    "acceleration": {"m/s2": "1", "m s-2": "1", "cm/s2": "1e-2", "ft/s2": FOOT, "N/kg": "1"},
    "angular acceleration": {"rad/s2": "1", "rad s-2": "1"},
    "speed": {
        "m/s": "1", "cm/s": "1e-2", "mm/s": "1e-3", "km/h": Fraction(5, 18),
        "ft/s": FOOT, "ft/min": FOOT / 60, "mph": FOOT * 5280 / 3600, "knot": Fraction(1852, 3600),
    },
    "angular speed": {"rad/s": "1", "rpm": "pi/30"},
    "moment of inertia": {
        "kg m2": "1", "kg cm2": "1e-4", "g cm2": "1e-7", "lb ft2": POUND * FOOT**2, "lb in2": POUND * INCH**2,
    },
}
# fmt: on
"""The units of each dimension in those of the SI; angles are in degrees, but radians stay radians.

A unit may also have no blank, or a dot, a star, ^2 or ².
"""
AMBIGUOUS = {
    **{"ton": "2000 lb, 2240 lb or 1000 kg", "tonf": "2000 lbf, 2240 lbf or 1000 kgf"},
    **{"cwt": "100 lb, 112 lb or 50 kg", "hp": "745.7 W or 735.5 W"},
}
"""Units that are not taken, and what they may be."""

MAX_DIGITS, MAX_EXPONENT = 1000, 500
"""The limits of a number, as it is typed and in SI units."""
# No text within those limits is longer as a numerator or denominator.
MAX_MAGNITUDE = MAX_DIGITS + MAX_EXPONENT
_LARGEST = 10**MAX_MAGNITUDE
TOO_LONG = f"is too long; numerator and denominator may have {MAX_MAGNITUDE} digits"

_UNIT = r"[A-Za-zа-яН°µμ](?:[A-Za-zа-яН/*·^ 2²⁻µμ-]{0,10}[A-Za-zа-яН2²])?"
_DIGITS, _POWER, _TAIL = r"(?:\d+(?:\.\d*)?|\.\d+)", r"(?:[eE][+-]?\d+)?", rf"(?: ?{_UNIT})?"
_DECIMAL = rf"[+-]?{_DIGITS}{_POWER}"
_QUOTIENT = rf"{_DECIMAL}(?: ?/ ?{_DECIMAL})?"
NUMBER = re.compile(rf"({_QUOTIENT})(?: ?({_UNIT}))?", re.ASCII)
_MULTIPLE = rf"({_QUOTIENT}|[+-]?) ?\*? ?(?:%s)(?: ?/ ?({_DECIMAL}))?"
MULTIPLES = {
    "angle": (_MULTIPLE % "(?i:pi)|π" + "(?: ?rad)?", Fraction(180), "°"),
    "acceleration": (_MULTIPLE % "g", Fraction(STANDARD_GRAVITY), "m/s2"),
}
"""The pattern of multiples of a constant, as 3pi/2, and its value in a unit, by dimension."""
SUM = r"(?<=[^eE ]) ?\+ ?"
"""What stands between numbers that are added."""
PRODUCT = r"(?<=[\w.]) ?\* ?(?=[\d.])"
"""What stands between factors, of which one may have a unit: 4*50g."""
SHARE = rf"({_DECIMAL} ?{_UNIT}) ?/ ?({_DECIMAL})"
"""A number with a unit, divided, as a diameter of 12cm/2."""
STOPWATCH = r"(?:(\d+):(?=[0-5]\d:))?(\d+):([0-5]\d(?:\.\d*)?)"
"""A time in hours, minutes and seconds."""
_ALIKE = str.maketrans("０１２３４５６７８９＋－．／（）％：−⁄×", "0123456789+-./()%:-/*")
"""Characters that mean those of ASCII. Superscripts do not, as 10² is not 102."""
_MIXED = r"(?a)(?<![\d./eE])(?<![eE][+-])(?:(\d+) ?)?([½⅓⅔¼¾⅕-⅞])(?! ?[\d.eE/(])"
"""A vulgar fraction, perhaps behind a whole number."""
_PLAIN = str.maketrans("µμ⁻²", "uu-2", "*·^ ")
_SYMBOLS = {symbol.translate(_PLAIN): symbol for symbols in UNITS.values() for symbol in symbols}
WORDS_FOR_UNITS = {
    "kg": "kilogram kilograms kilos кг",
    "g": "gram grams gramm gramme grammes gramos gramas gr gm gms г",
    "m": "meter meters metre metres м",
    "cm": "centimeters centimetres см",
    "t": "tonne tonnes",
    "s": "sec second seconds sek seg сек с",
    "N": "newton newtons Н",
    **{"mg": "мг", "mm": "мм", "ms": "мс", "min": "мин", "mN": "мН", "m/s2": "м/с2", "cm/s2": "см/с2"},
    **{"in": "inch inches", "ft": "foot feet", "lb": "pound pounds lbm", "rad": "radian radians"},
    **{"lbf ft": "lbft", "ft lbf": "ftlb", "lbf in": "lbin inlb inlbf"},
    **{"mph": "mi/h", "knot": "knots kn kt", "rpm": "rev/min r/min"},
    **{"ton": "ton tons", "tonf": "tonf tonsf", "cwt": "cwt", "hp": "hp"},
}
"""Other words for units."""
_SYMBOLS |= {word: symbol for symbol, words in WORDS_FOR_UNITS.items() for word in words.split()}

# An uncertainty: in units of the last digit, 1.000(2), or written out, 1.000±0.002, (1.000±0.002)g, 1g±2%.
_SIGN = r" ?(?:±|\+/?-) ?"
IN_LAST_DIGITS = rf"([+-]?{_DIGITS})\((\d+)\)({_POWER}{_TAIL})"
IN_BRACKETS = rf"\(([+-]?{_DIGITS}){_SIGN}({_DIGITS})( ?%)?\)({_POWER}{_TAIL})"
WRITTEN_OUT = rf"({_QUOTIENT})({_TAIL}){_SIGN}(?![+-])({_QUOTIENT})({_TAIL}| ?%)"
UNCERTAIN = ("(", "±", "+/-", "+-")
PERCENT = "%"
NOT_A_NUMBER = "is not a number; write it like 2, 1/3 or 1.5e-3"
NOT_UNCERTAIN = (
    "is not a number with its uncertainty; write it like 1.000±0.002, 1.000+-0.002 or 1.000(2),"
    " without a point in the brackets, and a unit after that"
)


class Malformed(ValueError):
    """The text is no number that is allowed here; the message is the rule that it breaks."""


class NotANumber(Malformed):
    """The text does not look like a number."""


def in_ascii(text: str) -> str:
    """Return a number without needless blanks and in the characters of ASCII: −1½ is -3/2."""
    text = without_blanks(text).translate(_ALIKE)
    return text if text.isascii() else re.sub(_MIXED, _as_quotient, text)


def _as_quotient(mixed: re.Match[str]) -> str:
    from unicodedata import normalize

    over, under = map(int, normalize("NFKC", mixed[2]).split("\N{FRACTION SLASH}"))
    return f"{int(mixed[1] or 0) * under + over}/{under}"


def is_uncertain(text: str) -> bool:
    """Decide whether the text is meant to carry an uncertainty."""
    return any(mark in text for mark in UNCERTAIN)


def read_number(text: str, dimension: str | None, others: Sequence[Terms] = ()) -> Input:
    """Read a number, with its unit and its uncertainty if it has them. Raises Malformed.

    ``dimension`` is one of `UNITS`, or None for a number that takes no unit. ``others`` are further terms in
    which it may be.
    """
    typed, u = in_ascii(text), ""
    if is_uncertain(typed):
        typed, u = _split_uncertainty(typed)
    read = _read_exactly(typed, dimension, others)
    if u.endswith(PERCENT):
        return read._replace(uncertainty=_quotient(u.removesuffix(PERCENT)) * abs(read.number) / 100)
    return read._replace(uncertainty=_read_exactly(u, dimension, others).number) if u else read


def _split_uncertainty(text: str) -> tuple[str, str]:
    """Return the texts of a value and of its uncertainty: 0.25(12)g is 0.25g and 0.12g, 55g±1% 55g and 1%.

    Raises Malformed.
    """
    if match := re.fullmatch(IN_LAST_DIGITS, text, re.ASCII):
        value, digits, tail = match.groups()
        places = len(value.partition(".")[2])
        return value + tail, f"{Decimal((0, tuple(map(int, digits)), -places)):f}{tail}"
    if re.search(rf"{_SIGN}0\d", text):
        raise Malformed("has an uncertainty that begins with 0 and no point; write it like 0.1")
    if match := re.fullmatch(IN_BRACKETS, text, re.ASCII):
        value, u, percent, tail = match.groups()
        return value + tail, u + (PERCENT if percent else tail)
    match = re.fullmatch(WRITTEN_OUT, text, re.ASCII)
    if match and match[4].endswith(PERCENT):
        return match[1] + match[2], match[3] + PERCENT
    if not match or match[2] not in ("", match[4]):
        if re.search(r"[^\W\d] ?\(|[*/^] ?\(|\) ?[*/^]", text):  # a function, as sin(20), or an expression
            raise NotANumber(NOT_A_NUMBER)
        raise Malformed(NOT_UNCERTAIN)
    return match[1] + match[4], match[3] + match[4]


def _read_exactly(text: str, dimension: str | None, others: Sequence[Terms]) -> Input:
    """Read a number without an uncertainty. Raises Malformed."""
    pattern, constant, unit_of_constant = MULTIPLES.get(dimension or "", ("", Fraction(0), ""))
    if pattern and (multiple := re.fullmatch(pattern, text, re.ASCII)):
        times, parts = multiple.groups(default="1")
        if not times.strip("+-"):
            times += "1"
        number = _quotient(times) * _quotient(f"1/{parts}")
        if MULTIPLE_OF_G in others:
            return Input(limited(number), unit=Unit(MULTIPLE_OF_G.unit, terms=MULTIPLE_OF_G))
        return Input(limited(number * constant), unit=Unit(unit_of_constant))
    if dimension == "time" and (clock := re.fullmatch(STOPWATCH, text, re.ASCII)):
        hours, minutes, seconds = map(_decimal, clock.groups(default="0"))
        return Input(limited((hours * 60 + minutes) * 60 + seconds), unit=Unit("s"))
    if "+" in text and len(summands := re.split(SUM, text)) > 1:
        terms = [_read_exactly(one, dimension, others) for one in summands]
        own = [
            (x.unit.symbol == "rad", bool(x.unit.symbol or dimension == "angle"), x.unit.terms) for x in terms
        ]
        if len({*own}) > 1:
            raise Malformed("adds numbers of different units; write the same unit at each")
        total = limited(sum((x.number for x in terms), Fraction(0)))
        return terms[0]._replace(number=total, quotient="")
    if "*" in text and len(factors := re.split(PRODUCT, text)) > 1:
        *plain, last = sorted(factors, key=lambda one: not re.fullmatch(_QUOTIENT, one))
        read = _read_exactly(last, dimension, others)._replace(quotient="")
        for one in plain:
            read = read._replace(number=limited(read.number * _read_exactly(one, None, ()).number))
        return read
    if "/" in text and (share := re.fullmatch(SHARE, text, re.ASCII)):
        read = _read_exactly(share[1], dimension, others)
        return read._replace(number=limited(read.number * _quotient(f"1/{share[2]}")))
    match = NUMBER.fullmatch(text)
    if not match:
        raise NotANumber(NOT_A_NUMBER)
    typed, symbol = match.groups(default="")
    value, is_quotient = _quotient(typed), "/" in typed
    quotient = typed if is_quotient else ""
    if not symbol:
        return Input(value, quotient=quotient)
    if dimension is None:
        raise Malformed(f"must be a plain number, without the {in_quotes(symbol)}")
    unit = read_unit(symbol, dimension, others)
    value *= unit.size
    if is_quotient or symbol_of(symbol) == "rpm":
        limited(value)
    else:
        in_si = as_typed(value, inf).partition("e")[0].lstrip("-0.")
        exponent = _power(typed) + to_digits(1, ROUND_FLOOR)(unit.size).adjusted()
        _check_size(in_si, exponent, ", its unit included")
    return Input(value, unit=unit, quotient=quotient)


def _quotient(text: str) -> Fraction:
    """Return the value of a decimal or of a quotient of two. Raises Malformed."""
    over, slash, under = text.partition("/")
    if not slash:
        return _decimal(text)
    if not (divisor := _decimal(under.strip())):
        raise Malformed("divides by 0")
    return limited(_decimal(over.strip()) / divisor)


def _decimal(text: str) -> Fraction:
    """Return the value of a decimal. Raises Malformed."""
    mantissa = text.lower().partition("e")[0]
    _check_size(mantissa, _power(text))
    return Fraction(f"{mantissa}e{_power(text)}")


def _power(decimal: str) -> int:
    """Return the power of ten that a decimal is written with; of a very long one, its first digits."""
    exponent = decimal.lower().partition("e")[2]
    power = int(exponent.lstrip("+-0")[:5] or 0)
    return -power if exponent.startswith("-") else power


def _check_size(mantissa: str, exponent: int, how: str = "") -> None:
    """Raise Malformed if a decimal has too many digits or too large an exponent to be solved quickly."""
    if (digits := sum(map(str.isdigit, mantissa))) > MAX_DIGITS:
        raise Malformed(f"has {digits} digits{how}; at most {MAX_DIGITS} are taken")
    if abs(exponent) > MAX_EXPONENT:
        raise Malformed(f"has an exponent beyond {MAX_EXPONENT} in magnitude{how}")


def limited(value: Fraction) -> Fraction:
    """Return the number. Raises Malformed if it is too long to be solved quickly."""
    if max(abs(value.numerator), value.denominator) >= _LARGEST:
        raise Malformed(TOO_LONG)
    return value


def read_unit(text: str, dimension: str, others: Sequence[Terms] = ()) -> Unit:
    """Return a unit of a dimension, or of the terms of others. Raises Malformed if it is none."""
    terms_by_dimension = {dimension: None, **{terms.dimension: terms for terms in others}}
    units = {symbol: name for name in terms_by_dimension for symbol in UNITS.get(name, {})}
    if MULTIPLE_OF_G in others and text == MULTIPLE_OF_G.unit:
        return Unit(text, terms=MULTIPLE_OF_G)
    if (symbol := symbol_of(text)) in AMBIGUOUS:
        raise Malformed(f"has the unit {in_quotes(text)}, which may be {AMBIGUOUS[symbol]}")
    if symbol not in units:
        raise Malformed(f"has the unit {in_quotes(text)}; it takes {', '.join(units)}")
    name = units[symbol]
    size = UNITS[name][symbol]
    return Unit(symbol, pi() / 30 if size == "pi/30" else Fraction(size), terms_by_dimension[name])


OTHER_TERMS = {"kg": [WEIGHT], "m/s²": [MULTIPLE_OF_G]}
"""The other terms in which a quantity may be said or compared, by its unit; g is the scene's."""


def dimension_of(unit: str) -> str | None:
    """Return the dimension of a unit, None if `UNITS` does not have it: its numbers are then plain."""
    return next((dimension for dimension, units in UNITS.items() if symbol_of(unit) in units), None)


def read_unit_of_result(text: str, unit: str) -> Unit:
    """Return the unit that a quantity, whose own is ``unit``, is to be in. Raises Malformed."""
    if (dimension := dimension_of(unit)) is None:
        raise Malformed("asks for the unit of a plain number; leave it out")
    read = read_unit(text, dimension, OTHER_TERMS.get(unit, ()))
    return read._replace(size=180 / pi()) if read.symbol == "rad" else read


@cache
def pi() -> Fraction:
    """Return π to more digits than any result has."""
    return Fraction(Enclosures(MAX_DIGITS + 100).pi.lo)


def symbol_of(unit: str) -> str:
    """Return the symbol of a unit as the table has it, "" if it is none of them."""
    return _SYMBOLS.get(unit.translate(_PLAIN).rstrip("."), "")
