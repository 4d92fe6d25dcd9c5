"""What is given: words and numbers in, an exact and valid `Scene` out. Nothing is computed."""

import re
from collections.abc import Callable, Iterable, Mapping
from decimal import Decimal
from fractions import Fraction
from math import inf
from numbers import Rational, Real
from typing import Any, NamedTuple, TypeVar

from ..arithmetic.rounding import as_typed

T = TypeVar("T")
Given = str | int | float | Decimal | Fraction
"""An input. Text, int, Decimal and Fraction mean exactly themselves, a float its binary value."""

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
TIME = {"s": "1", "ms": "1e-3", "min": "60"}
DIMENSIONS = {"mass": MASS, "length": LENGTH, "angle": ANGLE, "time": TIME}

INERTIA_FACTORS = {"disk": "0.5", "hoop": "1"}

STANDARD_GRAVITY = "9.80665"
"""m/s², exact by definition: 3rd General Conference on Weights and Measures, 1901."""

BODIES = {
    "mercury": "3.70",
    "venus": "8.87",
    "earth": STANDARD_GRAVITY,
    "moon": "1.62",
    "mars": "3.73",
    "pluto": "0.62",
}
"""Mean surface gravity of bodies with a surface (m/s²): NASA planetary fact sheets; earth, standard."""

MAX_DIGITS, MAX_EXPONENT = 1000, 500
# No text within those limits is longer as a numerator or denominator.
MAX_MAGNITUDE = MAX_DIGITS + MAX_EXPONENT

NUMBER = re.compile(r"([+-]?)(\d+(?:\.\d+)?|\.\d+)(?:e([+-]?\d+))?(?: *([A-Za-z]+|°))?", re.ASCII)
MISSING_MASS = "is missing; give both masses, m1 and m2"
NOT_A_NUMBER = "is not a number; write it like 2, 0.5 or 1.5e-3"

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


class SceneError(ValueError):
    """An input that is not a valid scene: ``parameter``, its ``value`` as given, the ``rule``."""

    def __init__(self, parameter: str, value: object, rule: str) -> None:
        super().__init__(parameter, value, rule)
        self.parameter, self.value, self.rule = parameter, value, rule

    def __str__(self) -> str:
        return self.describe(self.parameter)

    def describe(self, name: str) -> str:
        """The message, with the parameter called ``name`` (an option, a column)."""
        if self.value is None:
            return f"{name} {self.rule}"
        try:
            shown = repr(self.value)
        except ValueError:  # an int too long for Python to write out
            shown = f"<{type(self.value).__name__}>"
        if len(shown) > 60:
            shown = f"{shown[:40]}...{shown[-10:]}"
        return f"{name} {shown} {self.rule}"


class Parameter(NamedTuple):
    """What an input may be."""

    meaning: str
    unit: str = ""
    zero: bool = False
    inf: bool = False
    dimension: str | None = None
    names: Mapping[str, str] = {}
    signed: bool = False

    @property
    def domain(self) -> str:
        if self.signed:
            return "must be finite"
        bound = "0 or more" if self.zero else "above 0"
        return f"must be {bound}{' (inf locks the pulley)' if self.inf else ', and finite'}"


PARAMETERS = {
    "m1": Parameter("mass on one end of the string", "kg", zero=True, dimension="mass"),
    "m2": Parameter("mass on the other end", "kg", zero=True, dimension="mass"),
    "M": Parameter("mass of the pulley", "kg", zero=True, inf=True, dimension="mass"),
    "mu": Parameter("coefficient of static friction between string and pulley", zero=True),
    "mu_k": Parameter("coefficient of kinetic friction, once the string slips", zero=True),
    "g": Parameter("gravity", "m/s²", names=BODIES),
    "inertia": Parameter("inertia factor β = I/(M R²)", names=INERTIA_FACTORS),
    "I": Parameter("moment of inertia of the pulley", "kg m²"),
    "R": Parameter("radius of the pulley", "m", dimension="length"),
    "wrap": Parameter("angle over which the string touches the pulley", "°", dimension="angle"),
}
MEASURED = {
    "a": Parameter("measured acceleration, positive when m2 descends", "m/s²", signed=True),
    "drop": Parameter("height that the heavier mass falls from rest", "m", dimension="length"),
    "time": Parameter("measured time in which it does", "s", dimension="time"),
}
"""What may be known of the motion, beside the scene or in place of a part of it; see `inverse`."""


def parameter_of(name: str) -> Parameter:
    """What an input may be, of the scene or of the motion."""
    return PARAMETERS.get(name) or MEASURED[name]


def stated(name: str, value: str) -> str:
    """A parameter with its value and unit, for a sentence."""
    unit = parameter_of(name).unit
    return f"{name} = {value}{' ' * (unit not in ('', '°'))}{unit}"


class Radians(Fraction):
    """An angle in radians; a plain Fraction is one in degrees, and no rational is both."""


class Scene(NamedTuple):
    """A valid scene in SI units, exact; None where not given.

    ``M`` is a float only where it is infinite: a locked pulley. ``wrap`` is in degrees or `Radians`.
    """

    m1: Fraction
    m2: Fraction
    M: Fraction | float | None
    mu: Fraction | None
    mu_k: Fraction | None
    g: Fraction
    inertia: Fraction | None
    I: Fraction | None
    R: Fraction | None
    wrap: Fraction

    @classmethod
    def read(cls, given: Mapping[str, Given | None]) -> "Scene":
        """The scene given, by parameter; absent or None is not given. Raises SceneError."""
        values = {name: read_value(name, given.get(name)) for name in PARAMETERS}
        for mass in ("m1", "m2"):
            if values[mass] is None:
                raise SceneError(mass, None, MISSING_MASS)
        if values["inertia"] is None and values["I"] is None:
            values["inertia"] = Fraction(INERTIA_FACTORS["disk"])
        elif values["inertia"] is not None and values["I"] is not None:
            raise SceneError("I", given["I"], "and inertia both describe the pulley; give one of them")
        scene = cls(**values)
        scene._check_together(given)
        return scene

    def _check_together(self, given: Mapping[str, Given | None]) -> None:
        if self.m1 == self.m2 == 0:
            raise SceneError("m1", None, "and m2 are both 0; at least one mass must hang")
        free = "m1" if self.m1 == 0 else "m2"
        if self.mu is not None and 0 in (self.m1, self.m2):
            raise SceneError(free, given[free], "is a free end, which friction cannot hold; leave mu out")
        if self.mu_k is not None and self.mu is None:
            raise SceneError("mu_k", given["mu_k"], "needs mu, the coefficient that decides whether it slips")
        if self.mu_k is not None and self.mu is not None and self.mu_k > self.mu:
            raise SceneError(
                "mu_k",
                given["mu_k"],
                f"must not be above mu; exactly, {as_typed(self.mu_k)} > {as_typed(self.mu)}",
            )
        if self.I is not None and self.R is None:
            raise SceneError("I", given["I"], "needs the radius R as well")
        if self.I is not None and self.M is not None and not 0 < self.M < inf:
            raise SceneError("I", given["I"], f"contradicts M = {given['M']}; leave one of them out")


class Motion(NamedTuple):
    """What was measured of the motion, in SI units, exact; None where not given.

    ``finds`` is the parameter of the scene, "M" or "g", that follows from it and was not given.
    """

    a: Fraction | None = None
    drop: Fraction | None = None
    time: Fraction | None = None
    finds: str | None = None


UNMEASURED = Motion()


def read_uncertain(
    given: Mapping[str, Given | None], read: Callable[[Mapping[str, Given | None]], T]
) -> tuple[T, dict[str, Fraction]]:
    """What ``read`` makes of the inputs without their uncertainties, and these. Raises SceneError."""
    plain, uncertain = dict(given), {}
    for name, words in given.items():
        if isinstance(words, str) and any(mark in words for mark in UNCERTAIN):
            plain[name], uncertain[name] = split_uncertainty(name, words)
    try:
        found = read(plain)
        spreads = {name: _read_text(name, words, parameter_of(name)) for name, words in uncertain.items()}
    except SceneError as error:
        typed = None if error.value is None else given[error.parameter]
        raise SceneError(error.parameter, typed, error.rule) from None
    return found, {name: Fraction(spread) for name, spread in spreads.items() if spread}


def split_uncertainty(name: str, given: str) -> tuple[str, str]:
    """The texts of a value and of its uncertainty: 0.25(12)g is 0.25g and 0.12g. Raises SceneError."""
    if match := re.fullmatch(IN_LAST_DIGITS, given, re.ASCII):
        value, digits, tail = match.groups()
        places = len(value.partition(".")[2])
        point = max(1, len(digits) - places)
        digits = digits.zfill(point + places)
        return value + tail, f"{digits[:point]}{'.' * bool(places)}{digits[point:]}{tail}"
    if match := re.fullmatch(IN_BRACKETS, given, re.ASCII):
        value, spread, tail = match.groups()
        return value + tail, spread + tail
    match = re.fullmatch(WRITTEN_OUT, given, re.ASCII)
    if not match or match[2] not in ("", match[4]):
        raise SceneError(name, given, NOT_UNCERTAIN)
    return match[1] + match[4], match[3] + match[4]


def read_value(name: str, given: Given | None) -> Any:
    """The exact value of one parameter (None, Fraction or inf). Raises SceneError."""
    default = {"g": STANDARD_GRAVITY, "wrap": "180"}
    if given is None:
        return Fraction(default[name]) if name in default else None
    parameter = parameter_of(name)
    value = _read_text(name, given, parameter) if isinstance(given, str) else _read_number(name, given)
    if (
        (value < 0 and not parameter.signed)
        or (value == 0 and not (parameter.zero or parameter.signed))
        or (abs(value) == inf and not parameter.inf)
    ):
        raise SceneError(name, given, parameter.domain)
    return value


def read_plain(name: str, given: str) -> Fraction | float:
    """The value of a number without unit or name, as a table has it. Raises SceneError."""
    return _read_text(name, given, PARAMETERS[name]._replace(dimension=None, names={}))


def read_whole(name: str, given: int | str, least: int, most: int) -> int:
    """A whole number within bounds. Raises SceneError."""
    whole = given
    if isinstance(given, str) and given.isascii() and given.isdigit() and len(given) <= len(str(most)):
        whole = int(given)
    if type(whole) is not int or not least <= whole <= most:
        raise SceneError(name, given, f"must be a whole number from {least} to {most}")
    return whole


def read_digits(given: int | str | None) -> int | None:
    """How many significant digits are asked for. Raises SceneError."""
    return None if given is None else read_whole("digits", given, 1, MAX_DIGITS)


def _read_text(name: str, given: str, parameter: Parameter) -> Fraction | float:
    if parameter.inf and given == "inf":
        return inf
    if given in parameter.names:
        return Fraction(parameter.names[given])
    match = NUMBER.fullmatch(given)
    if not match:
        raise SceneError(name, given, _not_a_number(parameter, given))
    sign, mantissa, exponent, unit = match.groups(default="")
    digits = len(mantissa.replace(".", ""))
    power = exponent.lstrip("+-").lstrip("0") or "0"
    if digits > MAX_DIGITS:
        raise SceneError(name, given, f"has {digits} digits; at most {MAX_DIGITS} are taken")
    if len(power) > 3 or int(power) > MAX_EXPONENT:
        raise SceneError(name, given, f"has an exponent beyond {MAX_EXPONENT} in magnitude")
    value = Fraction(f"{sign}{mantissa}e{'-' * exponent.startswith('-')}{power}")
    if unit:
        value *= _factor(name, given, unit, parameter.dimension)
    return Radians(value) if unit == "rad" else value


def _not_a_number(parameter: Parameter, word: str) -> str:
    if word.lower() in ("nan", "inf", "+inf", "-inf", "infinity"):
        return parameter.domain
    if any(mark in word for mark in UNCERTAIN):
        return "carries an uncertainty, which only solve takes; give the value alone"
    if ":" in word:
        return "is a range, not a number; atwood sweep takes ranges"
    pointed = word.replace(",", ".")
    if pointed != word and NUMBER.fullmatch(pointed):
        return f"is not a number; write it with a decimal point, {pointed}"
    near = nearest(word, parameter.names)
    return f"{NOT_A_NUMBER}{_or_one_of(parameter.names)}{near}"


def _or_one_of(names: Mapping[str, str]) -> str:
    return f", or one of {', '.join(names)}" if names else ""


def nearest(word: str, words: Iterable[str]) -> str:
    """The hint that a near word may have been meant, empty if none is near."""
    from difflib import get_close_matches

    words = list(words)
    near = get_close_matches(word.lower(), words, n=1) or [w for w in words if w.startswith(word.lower())]
    return f"; did you mean {near[0]}?" if near else ""


def _factor(name: str, given: str, unit: str, wanted: str | None) -> Fraction:
    if wanted is None:
        raise SceneError(name, given, f"must be a plain number, without the {unit!r}")
    factors = DIMENSIONS[wanted]
    if unit in factors:
        return Fraction(factors[unit])
    for dimension, others in DIMENSIONS.items():
        if unit in others:
            units = f"{wanted} ({', '.join(factors)})"
            raise SceneError(name, given, f"has a unit of {dimension}; it takes one of {units}")
    raise SceneError(
        name,
        given,
        f"has the unknown unit {unit!r}{nearest(unit, factors) or '; there are ' + ', '.join(factors)}",
    )


def _read_number(name: str, given: object) -> Fraction | float:
    if isinstance(given, bool) or not isinstance(given, Real | Decimal):
        raise SceneError(name, given, "must be text or a number (str, int, float, Decimal, Fraction)")
    if given.is_nan() if isinstance(given, Decimal) else given != given:
        raise SceneError(name, given, parameter_of(name).domain)
    if given in (inf, -inf):
        return float(given)
    # A huge exponent is refused before it becomes a huge integer.
    if not isinstance(given, Decimal) or not given or abs(given.adjusted()) <= MAX_MAGNITUDE:
        if isinstance(given, Rational):  # NumPy's integers among them, whose parts are no ints
            value = Fraction(int(given.numerator), int(given.denominator))
        else:
            value = Fraction(given if isinstance(given, Decimal) else float(given))
        if max(abs(value.numerator), value.denominator) < 10**MAX_MAGNITUDE:
            return value
    raise SceneError(name, given, f"is too long; numerator and denominator may have {MAX_MAGNITUDE} digits")
