"""Read what is given, words and numbers, into an exact and valid `Scene`."""

from __future__ import annotations

import re
from collections.abc import Mapping
from decimal import Decimal
from fractions import Fraction
from functools import cache
from math import inf
from numbers import Rational, Real
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, NoReturn

from ..arithmetic.rational import OfFloat
from . import physics
from .digits import as_typed, to_double
from .units import (
    MAX_DIGITS,
    MAX_MAGNITUDE,
    NOT_A_NUMBER,
    NUMBER,
    STANDARD_GRAVITY,
    TOO_LONG,
    UNITS,
    Angle,
    Malformed,
    NotANumber,
    TypedNumber,
    in_quotes,
    is_uncertain,
    limited,
    nearest,
    read_number,
    shortened,
    without_blanks,
)


class Axle(NamedTuple):
    """The friction of an axle as it was given: a force at the rim (N) or a torque (N m).

    A torque is not converted when it is read, as R may be uncertain.
    """

    number: Any
    unit: Literal["N", "N m"] = "N"

    def force(self, R: Any) -> Any:
        """Return the friction as a force at the rim (N) of a pulley of radius R (m)."""
        return self.number / R if self.unit == "N m" else self.number


if TYPE_CHECKING:
    from numpy import floating, integer

    OfNumPy = integer[Any] | floating[Any]
else:
    OfNumPy = float

Given = str | int | float | Decimal | Fraction | Angle | Axle | OfNumPy
"""An input. Text, int, Decimal and Fraction mean exactly themselves, a float its binary value."""

INERTIA_FACTORS = {"disk": "1/2", "hoop": "1", "ring": "1", "sphere": "2/5", "shell": "2/3"}

BODIES = {
    "mercury": "3.70",
    "venus": "8.87",
    "earth": STANDARD_GRAVITY,
    "moon": "1.62",
    "mars": "3.73",
    "jupiter": "24.79",
    "saturn": "10.44",
    "uranus": "8.87",
    "neptune": "11.15",
    "pluto": "0.62",
}
"""Gravity (m/s²) by NASA's planetary fact sheets, without the effect of rotation: the mean at the surface, of
giants at the equator where the pressure is 1 bar. Earth has standard gravity."""

MASSES = ("m1", "m2")
DEFAULTS = {"g": STANDARD_GRAVITY, "wrap": "180"}
MISSING_MASS = "is missing; give both masses, m1 and m2"


class SceneError(ValueError):
    """An error of an input: the ``parameter``, its ``value`` as given, and the ``rule`` that it breaks."""

    def __init__(self, parameter: str, value: object, rule: str) -> None:
        super().__init__(parameter, value, rule)
        self.parameter, self.value, self.rule = parameter, value, rule

    def __str__(self) -> str:
        return self.describe(self.parameter)

    def describe(self, name: str) -> str:
        """Return the message, with the parameter called ``name`` (an option, a column)."""
        if self.value is None:
            return f"{name} {self.rule}"
        try:
            shown = in_quotes(self.value)
        except ValueError:  # an int too long for Python to write out
            shown = f"<{type(self.value).__name__}>"
        return f"{name} {shown} {self.rule}"


class Parameter(NamedTuple):
    """An input: its meaning, its unit, and the values that it may have."""

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
        return f"must be {bound} (inf locks the pulley)" if self.inf else f"must be {bound}, and finite"


INPUTS = {
    "m1": Parameter("mass on one end of the string", "kg", zero=True, dimension="mass"),
    "m2": Parameter("mass on the other end", "kg", zero=True, dimension="mass"),
    "M": Parameter("mass of the pulley", "kg", zero=True, inf=True, dimension="mass"),
    "mu": Parameter("coefficient of static friction between string and pulley", zero=True),
    "mu_k": Parameter("coefficient of kinetic friction, once the string slips", zero=True),
    "g": Parameter("gravity", "m/s²", dimension="acceleration", names=BODIES),
    "inertia": Parameter("inertia factor β = I/(M R²)", names=INERTIA_FACTORS),
    "I": Parameter("moment of inertia of the pulley", "kg m²", dimension="moment of inertia"),
    "R": Parameter("radius of the pulley", "m", dimension="length"),
    "wrap": Parameter("angle over which the string touches the pulley", "°", dimension="angle"),
    "axle": Parameter(
        "friction of the axle: a force at the rim", "N", zero=True, dimension="torque or force"
    ),
}
"""The inputs of a scene, which columns of arrays and of tables may have, too."""
MEASURED = {
    "a": Parameter(
        "measured acceleration, positive when m2 descends", "m/s²", dimension="acceleration", signed=True
    ),
    "drop": Parameter("height that the heavier mass falls from rest", "m", dimension="length"),
    "time": Parameter("measured time of that fall", "s", dimension="time"),
}
"""Measurements of the motion, in addition to a scene or instead of one of its inputs; see `motion`."""
# fmt: off
OTHER_NAMES = {
    **{"mass1": "m1", "mass_1": "m1", "mass2": "m2", "mass_2": "m2"},
    **dict.fromkeys("m mp m_p m_pulley pulley pulley_mass mass_pulley mass_of_pulley mass".split(), "M"),
    **dict.fromkeys("mu_s mus mu_static static_friction friction coefficient coeff".split(), "mu"),
    **dict.fromkeys("friction_coefficient coefficient_of_friction friction_coeff".split(), "mu"),
    **{"muk": "mu_k", "mu_kinetic": "mu_k", "kinetic_friction": "mu_k"},
    **{"gravity": "g", "beta": "inertia", "inertia_factor": "inertia", "moment_of_inertia": "I"},
    **{"axle_friction": "axle", "bearing_friction": "axle"},
    **{"r": "R", "radius": "R", "pulley_radius": "R", "wrap_angle": "wrap", "angle": "wrap", "phi": "wrap"},
    **{name.lower(): name for name in (*reversed(INPUTS), *MEASURED) if name != "I"},  # i may count rows
}
# fmt: on
"""The inputs that other names may mean, in small ASCII letters."""


def parameter_of(name: str) -> Parameter:
    """Return an input of the scene or a measurement by its name."""
    return INPUTS.get(name) or MEASURED[name]


def with_unit(value: str, unit: str) -> str:
    """Return a number with its unit: 1 kg, 90°, 0.3."""
    return f"{value}{unit}" if unit in ("", "°") else f"{value} {unit}"


class Input(NamedTuple):
    """An input as it was read: its exact value in SI units, its standard uncertainty, and what was given.

    ``value`` is a Fraction, inf for a locked pulley, an `Angle` for the wrap, or an `Axle`; it is None if
    nothing was given and there is no default. The uncertainty is in the unit of the value.
    """

    value: Any
    uncertainty: Fraction
    given: Given | None


class Scene(NamedTuple):
    """A valid scene in SI units, exact; an input that is not given is None.

    ``M`` is a float only if it is infinite, for a locked pulley.
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
    wrap: Angle
    axle: Axle | None = None

    @classmethod
    def read(cls, given: Mapping[str, Given | None]) -> Scene:
        """Read a scene, by parameter; absent or None is not given. Raises SceneError."""
        return cls.of({name: read_exactly(name, given.get(name)) for name in INPUTS})

    @classmethod
    def of(cls, inputs: Mapping[str, Input]) -> Scene:
        """Make a scene of inputs that were read one by one. Raises SceneError if they contradict another."""
        return cls(**checked(inputs))


def checked(inputs: Mapping[str, Input], unknown: str = "") -> dict[str, Any]:
    """Return the values of inputs that do not contradict each other. Raises SceneError.

    ``unknown`` is a mass that is to be found.
    """

    def refuse(name: str, rule: str) -> NoReturn:
        raise SceneError(name, inputs[name].given, rule)

    values = {name: inputs[name].value for name in INPUTS}
    m1, m2, M, mu, mu_k, _, inertia, I, R, _, axle = values.values()
    for mass in MASSES:
        if values[mass] is None and mass != unknown:
            refuse(mass, MISSING_MASS)
    if I is not None and inertia is not None:
        refuse("I", "and inertia both describe the pulley; give one of them")
    if I is None and inertia is None:
        values["inertia"] = Fraction(INERTIA_FACTORS["disk"])
    if m1 == m2 == 0:
        raise SceneError("m1", None, "and m2 are both 0; at least one mass must hang")
    if mu is not None and 0 in (m1, m2):
        fixed = "is an end of the string that is fixed to the pulley, where mu has no effect; leave mu out"
        refuse("m1" if m1 == 0 else "m2", fixed)
    if mu_k is not None and mu is None:
        refuse("mu_k", "needs mu, the coefficient that decides whether it slips")
    if mu_k is not None and mu_k > mu:
        alike = to_double(mu_k) == to_double(mu)  # then a float's digits are the point
        both = [Fraction(x) if alike else x for x in (mu_k, mu)]
        sizes = " > ".join(shortened(as_typed(x, inf)) for x in both)
        refuse("mu_k", f"must not be above mu: {sizes}")
    if I is not None and R is None:
        refuse("I", "needs the radius R as well")
    if axle is not None and axle.unit == "N m" and R is None:
        refuse("axle", "is a torque, which needs the radius R as well")
    if I is not None and M is not None and not 0 < M < inf:
        refuse("I", f"contradicts M = {shortened(str(inputs['M'].given))}; leave one of them out")
    return values


class Motion(NamedTuple):
    """Measurements of the motion in SI units, exact; one that is not given is None.

    ``finds`` is the input, such as "M" or "g", that was not given and follows from them.
    """

    a: Fraction | None = None
    drop: Fraction | None = None
    time: Fraction | None = None
    finds: str | None = None

    def acceleration(self, sign: int) -> Fraction:
        """Return the measured acceleration (m/s²) of the heavier mass: m2 if its sign is 1, m1 if -1."""
        if self.a is not None:
            return sign * self.a
        assert self.drop is not None
        assert self.time is not None
        return physics.acceleration_of_fall(self.drop, self.time)


UNMEASURED = Motion()


def read_input(name: str, given: Given | None) -> Input:
    """Read one input, whose text may carry a standard uncertainty. Raises SceneError."""
    if given is None:
        return _default(name)
    if isinstance(given, str):
        number = _read_text(name, given, given)
    elif (isinstance(given, Angle) and name == "wrap") or (isinstance(given, Axle) and name == "axle"):
        number = TypedNumber(_exact_number(name, given.number), given.unit)
    else:
        number = TypedNumber(_exact_number(name, given))
    return Input(_checked(name, given, number), number.uncertainty, given)


@cache
def _default(name: str) -> Input:
    """Return an input that is not given."""
    default = DEFAULTS.get(name)
    value = read_value(name, default) if default else None
    return Input(value, Fraction(0), None)


def read_exactly(name: str, given: Given | None) -> Input:
    """Read one input, which must carry no uncertainty. Raises SceneError."""
    if isinstance(given, str) and is_uncertain(given):
        raise SceneError(name, given, NO_UNCERTAINTY)
    return read_input(name, given)


def read_value(name: str, given: Given | None) -> Any:
    """Read the exact value of one input, as `Input` has it. Raises SceneError."""
    return read_exactly(name, given).value


def read_plain(name: str, given: str, text: str) -> Fraction | float:
    """Read the number in a cell of a table, as ``text``, which has no unit or name. Raises SceneError."""
    if is_uncertain(text):
        raise SceneError(name, given, NO_UNCERTAINTY)
    return _read_text(name, given, text, INPUTS[name]._replace(dimension=None, names={})).value


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


def _checked(name: str, given: Given, number: TypedNumber) -> Any:
    """Return a number as the value of an input: an angle or an axle, if it is one. Raises SceneError."""
    parameter, (value, unit, _) = parameter_of(name), number
    too_small = not parameter.signed and (value < 0 or (value == 0 and not parameter.zero))
    if too_small or (abs(value) == inf and not parameter.inf):
        raise SceneError(name, given, parameter.domain)
    if parameter.dimension == "angle":
        return Angle(value, "rad" if unit == "rad" else "°")
    if name == "axle":
        return Axle(value, "N m" if unit in UNITS["torque"] else "N")
    return value


def _read_text(name: str, given: Given, text: str, parameter: Parameter | None = None) -> TypedNumber:
    """Read the number in a text that is all or part of what was given; errors show all. Raises SceneError."""
    parameter = parameter or parameter_of(name)
    word = without_blanks(text).lower()
    if parameter.inf and word == "inf":
        return TypedNumber(inf)
    try:
        return read_number(parameter.names.get(word, text), parameter.dimension)
    except NotANumber:
        rule = _not_a_number(parameter, without_blanks(text))
    except Malformed as error:
        rule = str(error)
    raise SceneError(name, given, rule)


NO_UNCERTAINTY = "has an uncertainty, which only solve and fit take; give the value alone"
THOUSANDS = re.compile(r"[+-]?\d{1,3},\d{3}[^,]*", re.ASCII)
"""A number with one comma before three digits; with more commas it may be a list."""


def _not_a_number(parameter: Parameter, word: str) -> str:
    if not word:
        return "is empty; give a value, or leave it out"
    if word.lower() in ("nan", "inf", "+inf", "-inf", "infinity"):
        return parameter.domain
    meant = [word.replace(",", sign) for sign in ("", ".") if sign or THOUSANDS.fullmatch(word)]
    numbers = [shortened(number) for number in meant if NUMBER.fullmatch(number)]
    if "," in word and numbers:
        return f"is not a number; write {' or '.join(numbers)}, without a comma"
    if re.match(r"[-+.]?\d.*[:,]|[\d.]+-[\d.]+$", word):
        return "is not a number; atwood sweep takes a range as start:stop:count, and a list as 1,2,5"
    names = f", or one of {', '.join(parameter.names)}" if parameter.names else ""
    locked = "; inf is a locked pulley" if parameter.inf else ""
    return f"{NOT_A_NUMBER}{names}{locked}{nearest(word, parameter.names)}"


def _exact_number(name: str, given: object) -> Fraction | float:
    is_duration = getattr(getattr(given, "dtype", None), "kind", "") == "m"  # NumPy's pass for integers
    if isinstance(given, bool) or is_duration or not isinstance(given, Real | Decimal):
        raise SceneError(name, given, "must be text or a number (str, int, float, Decimal, Fraction)")
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
