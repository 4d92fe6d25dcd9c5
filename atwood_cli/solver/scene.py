"""A scene: what is given, exact and valid."""

from collections.abc import Mapping
from decimal import Decimal
from fractions import Fraction
from math import inf
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, NoReturn, SupportsFloat, cast

from ..numbers.digits import as_typed, to_double
from ..numbers.rational import EXACT, N
from ..numbers.text import in_quotes, shortened
from . import physics

if TYPE_CHECKING:
    from ..numbers.rational import Arithmetic

STANDARD_GRAVITY = "9.80665"
"""m/s², exact by definition: 3rd General Conference on Weights and Measures, 1901."""


class Angle(NamedTuple):
    """An angle of wrap, exact: a number of degrees or of radians, as it was given.

    No rational number of degrees is a rational number of radians. In arrays, ``number`` is a column.
    """

    number: Any
    unit: Literal["°", "rad"] = "°"

    def radians(self, ar: "Arithmetic[N]") -> N:
        """Return the angle in radians."""
        if self.unit == "rad":
            return ar.number(self.number)
        return ar.pi * ar.number(self.number / 180)

    def degrees(self, ar: "Arithmetic[N]", share: Any = 1) -> N:
        """Return a share of the angle in degrees; a share of 0 is exactly 0."""
        number = ar.number(share * self.number)
        return number * 180 / ar.pi if self.unit == "rad" and share else number

    def cos_sin(self, ar: "Arithmetic[N]", parts: int = 1) -> tuple[N, N]:
        """Return cosine and sine of one of equal parts of the angle; exact at multiples of 90°."""
        if self.unit == "rad":
            return ar.cos_sin(ar.number(self.number) / parts)
        return ar.cos_sin_of_degrees(self.number / parts)

    @property
    def is_half_turn(self) -> bool:
        return bool(self.unit == "°" and self.number == 180)


class Terms(NamedTuple):
    """Terms in which an input may be given besides its own, and the symbol, dimension and SI unit there.

    The input in its own terms is the number given, or its square, times an input ``by``, or divided by it.
    """

    words: str
    symbol: str
    dimension: str
    unit: str
    by: str
    divided: bool = False
    squared: bool = False

    def own(self, number: Any, by: Any) -> Any:
        """Return the input in its own terms, of a number in these."""
        number = number * number if self.squared else number
        return number / by if self.divided else number * by

    def number(self, own: Any, by: Any) -> Any:
        """Return the number in these terms, of the input in its own."""
        number = own * by if self.divided else own / by
        return EXACT.sqrt(number) if self.squared else number


WEIGHT = Terms("a weight", "W", "force", "N", "g", divided=True)
TORQUE = Terms("a torque", "τ_axle", "torque", "Nm", "R", divided=True)
ANGULAR_ACCELERATION = Terms("an angular acceleration", "α_given", "angular acceleration", "rad/s²", "R")
ANGULAR_SPEED = Terms("an angular speed", "ω_given", "angular speed", "rad/s", "R")
GYRATION = Terms("a radius of gyration", "k_I", "length", "m", "M", squared=True)
NEEDED = {"R": "the radius R", "M": "the pulley's mass M, finite,"}
MULTIPLE_OF_G = Terms("a multiple of g", "n_g", "gravity", "g", "g")


def in_own_terms(numbers: Mapping[str, Any], terms: Mapping[str, Terms]) -> dict[str, Any]:
    """Return numbers, of any type, in their inputs' own terms; ``terms`` has those of the others."""
    values = dict(numbers)
    for x, kind in terms.items():
        values[x] = kind.own(values[x], values[kind.by])
    return values


class Unit(NamedTuple):
    """The unit of a number as it was typed: its symbol, its size in the SI unit or in degrees, its terms.

    The terms are None if they are the input's own.
    """

    symbol: str = ""
    size: Fraction = Fraction(1)
    terms: Terms | None = None

    @property
    def in_words(self) -> str:
        return self.symbol.replace("2", "²")


Units = Mapping[str, Unit]
IN_SI: Units = {}
"""The units of quantities, by their names, that are not those of the SI: of none."""

Given = str | int | float | Decimal | Fraction | Angle | SupportsFloat
"""An input. Text, int, Decimal and Fraction mean exactly themselves, any float its binary value."""

SHAPES = "disk cylinder hoop ring sphere shell"
INERTIA_FACTORS = dict(zip(SHAPES.split(), "1/2 1/2 1 1 2/5 2/3".split(), strict=True))

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
DRIVE = "drive"
FINDABLE = (*MASSES, "M", "g", "mu_k", "axle", DRIVE)
"""The inputs that a measured motion may give, and the drive of a motor or a brake, which is no input."""
FALL = ("drop", "time", "speed")
"""What is measured of a fall from rest; the acceleration follows from two."""
DEFAULTS = {"g": STANDARD_GRAVITY, "wrap": "180"}
MISSING_MASS = "is missing; give both masses, m1 and m2"


class SceneError(ValueError):
    """An error of an input: the ``parameter``, its ``value`` as given (None for an array), and its ``rule``.

    ``fault`` names it among the statuses of arrays, as inputs do that are outside their domain or missing.
    """

    def __init__(self, parameter: str, value: object, rule: str, fault: str = "") -> None:
        super().__init__(parameter, value, rule)
        self.parameter, self.value, self.rule, self.fault = parameter, value, rule, fault or parameter

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
    """An input: its meaning, its symbol, its words on an axis, its unit, and the values that it may have."""

    meaning: str
    symbol: str
    axis: str
    unit: str = ""
    may_be_zero: bool = False
    may_be_infinite: bool = False
    dimension: str | None = None
    names: Mapping[str, str] = {}
    signed: bool = False
    terms: tuple[Terms, ...] = ()

    @property
    def domain(self) -> str:
        if self.signed:
            return "must be finite"
        bound = "0 or more" if self.may_be_zero else "above 0"
        end = " (inf locks the pulley)" if self.may_be_infinite else ", and finite"
        return f"must be {bound}{end}"


# fmt: off
A_MASS: Any = ("mass", "kg", True, False, "mass", {}, False, (WEIGHT,))
INPUTS = {
    "m1": Parameter("mass on one end of the string", "m₁", *A_MASS),
    "m2": Parameter("mass on the other end", "m₂", *A_MASS),
    "M": Parameter(
        "mass of the pulley", "M", "pulley mass", "kg",
        may_be_zero=True, may_be_infinite=True, dimension="mass", terms=(WEIGHT,),
    ),
    "mu": Parameter(
        "coefficient of static friction between string and pulley", "μ", "friction coefficient",
        may_be_zero=True,
    ),
    "mu_k": Parameter(
        "coefficient of kinetic friction, once the string slips", "μₖ", "kinetic friction coefficient",
        may_be_zero=True,
    ),
    "g": Parameter("gravity", "g", "gravity", "m/s²", dimension="acceleration", names=BODIES),
    "inertia": Parameter("inertia factor β = I/(M R²)", "β", "inertia factor", names=INERTIA_FACTORS),
    "I": Parameter(
        "moment of inertia of the pulley", "I", "moment of inertia", "kg m²", dimension="moment of inertia",
        terms=(GYRATION,),
    ),
    "R": Parameter("radius of the pulley", "R", "radius", "m", dimension="length"),
    "wrap": Parameter(
        "angle over which the string touches the pulley", "φ", "angle of wrap", "°", dimension="angle"
    ),
    "axle": Parameter(
        "friction of the axle: a force at the rim", "f_axle", "axle friction", "N",
        may_be_zero=True, dimension="force", terms=(TORQUE,),
    ),
}
"""The inputs of a scene, which columns of arrays and of tables may have, too."""
MEASURED = {
    "a": Parameter(
        "measured acceleration, positive when m2 descends", "a", "acceleration", "m/s²",
        dimension="acceleration", signed=True, terms=(MULTIPLE_OF_G, ANGULAR_ACCELERATION),
    ),
    "drop": Parameter(
        "height that the heavier mass falls from rest", "s", "height of fall", "m", dimension="length"
    ),
    "time": Parameter("measured time of that fall", "t", "time of fall", "s", dimension="time"),
    "speed": Parameter(
        "speed at the end of that fall", "v", "final speed", "m/s",
        dimension="speed", terms=(ANGULAR_SPEED,),
    ),
}
"""Measurements of the motion, in addition to a scene or instead of one of its inputs; see `inverse`."""
# fmt: on
COLUMNS = INPUTS | {name: MEASURED[name] for name in FALL}
"""The inputs of many scenes: those of a scene, and one of a fall from rest."""


def parameter_of(name: str) -> Parameter:
    """Return an input of the scene or a measurement by its name."""
    return INPUTS.get(name) or MEASURED[name]


def with_unit(value: str, unit: str) -> str:
    """Return a number with its unit: 1 kg, 90°, 0.3."""
    return f"{value}{unit}" if unit in ("", "°") else f"{value} {unit}"


class Input(NamedTuple):
    """A number with its unit, as it was given: exact, with its standard uncertainty, and what was typed.

    ``number`` is in the SI unit of its terms, in degrees or in radians, and so is the uncertainty. It is a
    Fraction, inf for a locked pulley, or None if nothing was given and there is no default. The page writes
    it in the ``unit`` that was typed, and as the ``quotient``, if it was one.
    """

    number: Any = None
    uncertainty: Fraction = Fraction(0)
    given: Given | None = None
    unit: Unit = Unit()
    quotient: str = ""


NOT_GIVEN = Input()


class Motion(NamedTuple):
    """Measurements of the motion in SI units, exact; one that is not given is None.

    ``finds`` is the input, such as "M" or "g", that was not given and follows from them, or the drive.
    ``direction`` is 1 if m2 descends and -1 if m1 does, where the masses do not tell: one of them is found
    from a fall (m2 rises if height or speed is below 0), or the axle's friction or a drive is.
    """

    a: Fraction | None = None
    drop: Fraction | None = None
    time: Fraction | None = None
    speed: Fraction | None = None
    finds: str | None = None
    direction: int = 0

    @property
    def fall(self) -> tuple[str, ...]:
        """What was measured of a fall, by name."""
        return tuple(name for name in FALL if getattr(self, name) is not None)

    @property
    def way(self) -> int:
        """1 if a drive moves m2 downwards, -1 if upwards, 0 if unknown; from rest unless a = 0."""
        moves = self.acceleration(1) or self.speed or self.drop or 0
        return (moves > 0) - (moves < 0)

    def acceleration(self, sign: int) -> Fraction:
        """Return the measured acceleration (m/s²) of the heavier mass: m2 if its sign is 1, m1 if -1."""
        if self.a is not None:
            return sign * self.a
        drop, time, speed = (cast(Fraction, getattr(self, name)) for name in FALL)
        if drop is None:
            a = physics.time_or_acceleration(speed, time)
        elif time is None:
            a = physics.height_or_acceleration(speed, drop)
        else:
            a = physics.acceleration_of_fall(drop, time)
        return sign * self.direction * a if self.finds in (*MASSES, DRIVE) else a


class Scene(NamedTuple):
    """A valid scene in SI units, exact; an input that is not given is None.

    ``M`` is a float only if it is infinite, for a locked pulley. ``motion`` has what was measured of it, and
    ``terms`` are those of inputs and measurements that were given in other terms than their own.
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
    axle: Fraction | None = None
    motion: Motion = Motion()
    terms: tuple[tuple[str, Terms], ...] = ()

    @classmethod
    def of(cls, inputs: Mapping[str, Input], finds: str | None = None, may_lack: bool = False) -> "Scene":
        """Make a scene of inputs and measurements that were read one by one; a motion may find a mass.

        It ``may_lack`` masses beside mu, as some limits hold without them.

        Raises SceneError if they contradict another.
        """

        def refuse(name: str, rule: str, fault: str = "") -> NoReturn:
            raise SceneError(name, inputs[name].given, rule, fault)

        numbers = {name: read.number for name, read in inputs.items()}
        terms = {name: read.unit.terms for name, read in inputs.items() if read.unit.terms}
        for name, kind in terms.items():
            if numbers[kind.by] in (None, inf):  # g has a default
                refuse(name, f"is {kind.words}, which needs {NEEDED[kind.by]} as well")
        values = in_own_terms(numbers, terms)
        values["wrap"] = Angle(values["wrap"], "rad" if inputs["wrap"].unit.symbol == "rad" else "°")
        motion = Motion(**{x: values.pop(x) for x in MEASURED if x in values}, finds=finds)
        m1, m2, M, mu, mu_k, inertia, I = (values[x] for x in ("m1", "m2", "M", "mu", "mu_k", "inertia", "I"))
        for mass in MASSES:
            if values[mass] is None and mass != finds and (not may_lack or mu is None):
                by_motion = finds is not None and finds not in ("axle", DRIVE)
                or_one = ", or one with mu" if may_lack else ", or one with a motion that finds the other"
                fixed = (
                    "" if M is I is None and finds != DRIVE else f"; {mass} = 0 is an end fixed to the pulley"
                )
                refuse(mass, f"{MISSING_MASS}{or_one if may_lack or by_motion else ''}{fixed}")
        if finds is None and len(motion.fall) > 1:
            rule = "give the acceleration, which only solve takes; leave one of them out"
            refuse(motion.fall[1], f"and {motion.fall[0]} {rule}", "two of drop, time and speed")
        if I is not None and inertia is not None:
            refuse("I", "and inertia both describe the pulley; give one of them", "I and inertia")
        if I is None and inertia is None:
            values["inertia"] = Fraction(INERTIA_FACTORS["disk"])
        if m1 == m2 == 0:
            raise SceneError("m1", None, "and m2 are both 0; at least one mass must hang", "no mass")
        if mu is not None and 0 in (m1, m2):
            rule = "is an end of the string that is fixed to the pulley, where mu has no effect; leave mu out"
            refuse("m1" if m1 == 0 else "m2", rule, "friction at a free end")
        if mu_k is not None and mu is None:
            refuse("mu_k", "needs mu, the coefficient that decides whether it slips", "mu_k without mu")
        if mu_k is not None and mu_k > mu:
            alike = to_double(mu_k) == to_double(mu)  # then a float's digits are the point
            both = [Fraction(x) if alike else x for x in (mu_k, mu)]
            sizes = " > ".join(shortened(as_typed(x, inf)) for x in both)
            refuse("mu_k", f"must not be above mu: {sizes}", "mu_k above mu")
        if I is not None and values["R"] is None:
            refuse("I", "needs the radius R as well", "I without R")
        if I is not None and M is not None and not 0 < M < inf:
            rule = f"contradicts M = {shortened(str(inputs['M'].given))}; leave one of them out"
            refuse("I", rule, "I with M = 0 or inf")
        return cls(**values, motion=motion, terms=(*terms.items(),))

    @property
    def lacking(self) -> list[str]:
        """The masses that are neither given nor found."""
        return [mass for mass in MASSES if getattr(self, mass) is None]

    def own(self, x: str) -> Any:
        """Return an input, or what was measured, in its own terms: the mass of a weight that was given."""
        return getattr(self if x in INPUTS else self.motion, x)

    def unit_of(self, x: str) -> str:
        """Return the unit of the number that was given for an input: one of the SI, ° or rad."""
        terms = dict(self.terms).get(x)
        return terms.unit if terms else self.wrap.unit if x == "wrap" else parameter_of(x).unit

    def as_given(self, x: str) -> Any:
        """Return the number given for an input, in that unit: the weight."""
        return self.wrap.number if x == "wrap" else self.in_terms_of(x, self.own(x))

    def in_terms_of(self, x: str, own: Any) -> Any:
        """Return a value of an input in the terms in which the input is given."""
        terms = dict(self.terms).get(x)
        return terms.number(own, getattr(self, terms.by)) if terms else own

    def with_number(self, x: str, number: Any) -> "Scene":
        """Return the scene with another number for an input, or for what was measured, in the same unit.

        What was given in other terms is converted anew, as that number may convert it.
        """
        if x == "wrap":
            return self._replace(wrap=self.wrap._replace(number=number))
        values, terms = {x: number}, dict(self.terms)
        if terms:
            by = {kind.by: getattr(self, kind.by) for kind in terms.values()}
            values = in_own_terms(by | {name: self.as_given(name) for name in terms} | values, terms)
        if measured := {name: values.pop(name) for name in MEASURED if name in values}:
            values["motion"] = self.motion._replace(**measured)
        return self._replace(**values)
