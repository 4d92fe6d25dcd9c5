"""The solver: picks the model that a scene needs and settles the quantities asked for.

`Case` holds what is decided once and exactly: who is heavier, whether the string grips. `Machine`
is the model, written once for every number type; it computes nothing that is not asked for, and a
quantity that the scene does not determine raises `Undetermined` with the reason. `Answers` rounds.
"""

from decimal import Decimal
from fractions import Fraction
from functools import cached_property
from math import inf
from typing import TYPE_CHECKING, Any, Generic, Literal, overload

from . import physics, words
from .arithmetic import (
    LARGEST_EXPONENT,
    Arithmetic,
    Rounding,
    is_infinite,
    is_positive,
    settle,
    to_digits,
    to_double,
)
from .physics import N
from .quantities import NAMES, Solution
from .scene import Given, Scene, read_digits

if TYPE_CHECKING:
    from typing import TypedDict, Unpack

    class Inputs(TypedDict, total=False):
        m1: Given
        m2: Given
        M: Given | None
        mu: Given | None
        mu_k: Given | None
        g: Given
        inertia: Given | None
        I: Given | None
        R: Given | None
        wrap: Given


DOUBLE_DIGITS = 17

NEEDS_MU = "give mu, the friction coefficient"
NEEDS_M = "give M, the pulley's mass, which decides here"
NEEDS_R = "give R, the pulley's radius"
UNKNOWN_SHAPE = "give M, the pulley's mass, beside I"
FREE_END = "not defined for a free end: the string is fixed to the pulley and no friction holds it"
NO_CRITICAL_MASS = "does not exist, as the string holds on any pulley, however heavy"
NO_CRITICAL_HEAVIER_MASS = "does not exist, as the string holds under any heavier mass"
NOT_DEFINITE = "not one number while the string grips with friction to spare; see its bounds"
DEFINITE = "bounds are for a string that grips with friction to spare; here friction_force is definite"
NOT_APPLICABLE = "conditions (36) do not apply without friction"
LOCKED_AXLE = "not defined for a locked pulley: M = inf is not its weight"
ONE_SIDED = "defined for half a turn of wrap (and whole turns more), where both ends pull downwards"
TOO_LARGE = f"beyond 10^{LARGEST_EXPONENT}, the largest number written out"
ABOVE_DOUBLES = "beyond the range of doubles; ask for digits (--digits 17) to see it"
BELOW_DOUBLES = "not 0 but below the range of doubles; ask for digits (--digits 17) to see it"


class Undetermined(Exception):
    """The scene does not determine the quantity; the message says why and what to give."""


class Case:
    """What is decided about a scene before anything is computed, exactly."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.light, self.heavy = sorted((scene.m1, scene.m2))
        self.sign = (scene.m2 > scene.m1) - (scene.m2 < scene.m1)
        self.locked = scene.M == inf
        self.pulley_mass = scene.M if isinstance(scene.M, Fraction) else None
        self.beta = scene.inertia
        self.rim_mass: Fraction | None = None  # c = βM
        if scene.I is not None and scene.R is not None:
            self.rim_mass = scene.I / scene.R**2
            self.beta = self.rim_mass / self.pulley_mass if self.pulley_mass else None
        elif self.pulley_mass is not None and scene.inertia is not None:
            self.rim_mass = scene.inertia * self.pulley_mass
        elif scene.mu is None and not self.locked:
            self.pulley_mass = self.rim_mass = Fraction(0)

    @property
    def pulley_known(self) -> bool:
        """Whether the pulley is known enough for the motion of a string that grips."""
        return self.locked or self.rim_mass is not None

    @property
    def tensions_equal(self) -> bool:
        """Whether a string that grips needs no friction."""
        return self.sign == 0 or self.rim_mass == 0

    @cached_property
    def regime(self) -> Literal["no-slip", "verge", "slip"]:
        if self.scene.mu is None or self.tensions_equal:
            return "no-slip"
        if not self.pulley_known:
            return "verge" if self.can_slip else "no-slip"
        return "slip" if self._beats_friction(self.excess_ratio(self.rim_mass)) else "no-slip"

    @cached_property
    def can_slip(self) -> bool:
        """Whether the string slips on a pulley that is heavy enough: first condition of (36)."""
        return self._beats_friction(self.excess_ratio(None))

    @cached_property
    def can_be_made_slip(self) -> bool:
        """Whether it slips under a heavier mass that is heavy enough: second condition of (36)."""
        return self.rim_mass is None or self._beats_friction(self.rim_mass / (2 * self.light))

    def excess_ratio(self, c: Fraction | None) -> Fraction:
        """T_h/T_l - 1 of a string that grips a pulley with c = βM; None is a locked one."""
        share = Fraction(1) if c is None else physics.shares(self.heavy, c)[1]
        return share * (self.heavy - self.light) / self.light

    def _beats_friction(self, excess: Fraction) -> bool:
        """Whether 1 + excess > e^{μφ}; by logarithms, so that a huge e^{μφ} is never formed."""
        mu = self.scene.mu
        if not mu or not excess:
            return excess > 0

        def margin(ar: Arithmetic[N]) -> N:
            return ar.log1p(ar.number(excess)) - ar.number(mu) * wrap_angle(ar, self.scene)

        return is_positive(margin)


def wrap_angle(ar: Arithmetic[N], scene: Scene) -> N:
    """The angle of wrap φ in radians."""
    return ar.pi * ar.number(scene.wrap / 180)


class Machine(Generic[N]):
    """The model of a case in one arithmetic. Its properties are the quantities, by their names."""

    def __init__(self, case: Case, ar: Arithmetic[N]) -> None:
        self.case, self.scene, self.ar = case, case.scene, ar
        self.l, self.h, self.g = map(ar.number, (case.light, case.heavy, case.scene.g))

    # What the quantities are made of

    def _given(self, value: Fraction | None, otherwise: str) -> N:
        if value is None:
            raise Undetermined(otherwise)
        return self.ar.number(value)

    def _capstan_excess(self, mu: Fraction) -> N:
        """e^{μφ} - 1; without friction no exponential is asked for."""
        if not mu:
            return self.ar.number(0)
        return self.ar.expm1(self.ar.number(mu) * wrap_angle(self.ar, self.scene))

    @cached_property
    def _k1(self) -> N:
        """The excess of the capstan ratio of static friction."""
        if self.scene.mu is None:
            raise Undetermined(NEEDS_MU)
        return self._capstan_excess(self.scene.mu)

    @cached_property
    def _limiting_mu(self) -> Fraction:
        """The coefficient that the friction is at: static on the verge, kinetic in slip."""
        scene = self.scene
        mu = scene.mu if self.case.regime == "verge" or scene.mu_k is None else scene.mu_k
        return mu or Fraction(0)

    @cached_property
    def _state(self) -> tuple[N, N, N]:
        """Transfer z, surplus d and effective mass x; see `physics`."""
        case, difference = self.case, self.h - self.l
        if case.regime != "no-slip":
            z = physics.transfer_at_limit(self.l, self._capstan_excess(self._limiting_mu))
            return z, difference - z, self.l + z
        if case.sign == 0:
            w, v = self.ar.number(1), self.ar.number(0)
        elif case.locked:
            w, v = self.ar.number(0), self.ar.number(1)
        else:
            w, v = physics.shares(self.h, self._given(case.rim_mass, NEEDS_M))
        return v * difference, w * difference, self.l + v * difference

    @cached_property
    def _friction_mu(self) -> N:
        """The μ with which T(θ) = T1 e^{±μθ}, where that is so."""
        if self.case.regime != "no-slip":
            return self.ar.number(self._limiting_mu)
        mu = self.mu_verge
        if self.scene.mu is not None and not self.case.tensions_equal:
            raise Undetermined(NOT_DEFINITE)
        return mu

    @cached_property
    def _friction_vector(self) -> tuple[N, N]:
        mu = self._friction_mu * self.case.sign
        cos, sin = self._direction
        return physics.friction_vector(mu, self.tension_1, self.tension_2, cos, sin)

    @cached_property
    def _direction(self) -> tuple[N, N]:
        """Cosine and sine of the angle of wrap; exact at multiples of 90°."""
        quarters = self.scene.wrap / 90
        if quarters.denominator > 1:
            return self.ar.cos_sin(wrap_angle(self.ar, self.scene))
        cos, sin = ((1, 0), (0, 1), (-1, 0), (0, -1))[quarters.numerator % 4]
        return self.ar.number(cos), self.ar.number(sin)

    @cached_property
    def _tension_difference(self) -> N:
        z, _, x = self._state
        return physics.tension_difference(self.h, x, z, self.g) * self.case.sign

    def _friction_bound(self) -> N:
        if self.case.regime != "no-slip":
            raise Undetermined(DEFINITE)
        verge = self.mu_verge
        if self.case.tensions_equal:
            return verge
        raise Undetermined(NEEDS_MU)

    # The quantities

    @cached_property
    def acceleration(self) -> N:
        _, d, x = self._state
        return physics.acceleration(self.h, x, d, self.g) * self.case.sign

    @cached_property
    def tension_1(self) -> N:
        return self._tensions[0]

    @cached_property
    def tension_2(self) -> N:
        return self._tensions[1]

    @cached_property
    def _tensions(self) -> tuple[N, N]:
        _, _, x = self._state
        light = physics.light_tension(self.l, self.h, x, self.g)
        heavy = physics.heavy_tension(self.h, x, self.g)
        return (light, heavy) if self.case.sign >= 0 else (heavy, light)

    @cached_property
    def mu_verge(self) -> N:
        case = self.case
        if not case.light:
            raise Undetermined(FREE_END)
        if case.tensions_equal:
            return self.ar.number(0)
        if case.regime == "verge":
            return self.ar.number(self._limiting_mu)
        if not case.pulley_known:
            raise Undetermined(NEEDS_M)
        ratio = self.ar.number(case.excess_ratio(case.rim_mass))
        return physics.verge_coefficient(self.ar.log1p(ratio), wrap_angle(self.ar, self.scene))

    @cached_property
    def friction_force(self) -> N:
        mu = self._friction_mu
        if self.ar.is_zero(mu):
            return self.ar.number(0)
        cos, _ = self._direction
        force = physics.resultant(self.tension_1, self.tension_2, cos, self.ar.sqrt)
        return physics.friction_magnitude(mu, force, self.ar.sqrt)

    @cached_property
    def friction_force_x(self) -> N:
        return self._friction_vector[0]

    @cached_property
    def friction_force_y(self) -> N:
        return self._friction_vector[1]

    @cached_property
    def axle_force(self) -> N:
        if (self.scene.wrap - 180) % 360:
            raise Undetermined(ONE_SIDED)
        if self.case.locked:
            raise Undetermined(LOCKED_AXLE)
        if self.case.regime == "verge":
            mass = self.critical_pulley_mass
        else:
            mass = self._given(self.case.pulley_mass, NEEDS_M)
        return physics.axle_force(self.tension_1, self.tension_2, mass, self.g)

    @cached_property
    def torque(self) -> N:
        return self._tension_difference * self._given(self.scene.R, NEEDS_R)

    @cached_property
    def rim_acceleration(self) -> N:
        if self.case.regime != "slip":
            return self.acceleration
        if self.case.rim_mass is None:
            return self.ar.number(0)
        return self._tension_difference / self.ar.number(self.case.rim_mass)

    @cached_property
    def angular_acceleration(self) -> N:
        return self.rim_acceleration / self._given(self.scene.R, NEEDS_R)

    @cached_property
    def critical_pulley_mass(self) -> N:
        k1 = self._k1
        if not self.case.can_slip:
            raise Undetermined(NO_CRITICAL_MASS)
        beta = self._given(self.case.beta, UNKNOWN_SHAPE)
        surplus = self.h - self.l - physics.transfer_at_limit(self.l, k1)
        return physics.critical_pulley_mass(self.l, self.h, k1, surplus, beta)

    @cached_property
    def critical_heavier_mass(self) -> N:
        k1 = self._k1
        if self.case.locked:
            return self.least_heavier_mass
        c = self._given(self.case.rim_mass, NEEDS_M)
        if not self.case.can_be_made_slip:
            raise Undetermined(NO_CRITICAL_HEAVIER_MASS)
        return physics.critical_heavier_mass(self.l, c, k1)

    @cached_property
    def least_heavier_mass(self) -> N:
        k1 = self._k1
        if not (self.scene.mu or self.case.pulley_known):
            raise Undetermined(NOT_APPLICABLE)
        return physics.least_heavier_mass(self.l, k1)

    @cached_property
    def least_pulley_mass(self) -> N:
        k1 = self._k1
        if not (self.scene.mu or self.case.pulley_known):
            raise Undetermined(NOT_APPLICABLE)
        return physics.least_pulley_mass(self.l, k1, self._given(self.case.beta, UNKNOWN_SHAPE))

    @cached_property
    def friction_force_min(self) -> N:
        return self._friction_bound()

    @cached_property
    def friction_force_max(self) -> N:
        return self._friction_bound()


class Answers:
    """The quantities of a scene, settled when asked for: to doubles or to ``digits`` digits."""

    def __init__(self, scene: Scene, digits: int | None = None) -> None:
        self.case = Case(scene)
        self.digits = digits
        self._round: Rounding[Any] = to_double if digits is None else to_digits(digits)
        self._machines: dict[Arithmetic[Any], Machine[Any]] = {}
        self._values: dict[str, Any] = {"regime": self.case.regime}
        self.reasons: dict[str, str] = {}

    def __getitem__(self, name: str) -> Any:
        """The value of a quantity by its name, None where ``reasons`` says why there is none."""
        if name not in self._values:
            try:
                self._values[name] = self._settle(name)
            except Undetermined as reason:
                self._values[name] = None
                self.reasons[name] = str(reason)
        return self._values[name]

    def _settle(self, name: str) -> float | Decimal:
        def quantity(ar: Arithmetic[N]) -> N:
            if ar not in self._machines:
                self._machines[ar] = Machine(self.case, ar)
            value: N = getattr(self._machines[ar], name)
            return value

        value: float | Decimal = settle(quantity, self._round, self.digits or DOUBLE_DIGITS)
        if is_infinite(value):
            self.reasons[name] = ABOVE_DOUBLES if self.digits is None else TOO_LARGE
        elif value == 0 and self.digits is None and settle(quantity, to_digits(1), 1):
            self.reasons[name] = BELOW_DOUBLES
        return value

    def with_pulley(self, mass: Fraction | float) -> "Answers":
        """The same scene on a pulley of that mass (inf: locked), with a string that grips."""
        return Answers(self.case.scene._replace(M=mass, mu=None, mu_k=None), self.digits)


@overload
def solve(*, digits: None = None, **given: "Unpack[Inputs]") -> Solution[float]: ...
@overload
def solve(*, digits: int | str, **given: "Unpack[Inputs]") -> Solution[Decimal]: ...
def solve(
    *,
    m1: Given | None = None,
    m2: Given | None = None,
    M: Given | None = None,
    mu: Given | None = None,
    mu_k: Given | None = None,
    g: Given | None = None,
    inertia: Given | None = None,
    I: Given | None = None,
    R: Given | None = None,
    wrap: Given | None = None,
    digits: int | str | None = None,
) -> Any:
    """The state of Atwood's machine: m1 and m2 on a rough string over a pulley.

    Masses in kg, R in m, I in kg m², g in m/s², wrap in degrees; text may carry a unit ("250g",
    "5cm") or name a body or shape (g="moon", inertia="hoop"). What is given decides the model:
    no M, a massless pulley, or with mu the one that brings the string to the verge of slipping.
    Defaults: g standard gravity, inertia that of a disk (1/2), wrap 180, mu_k = mu.

    Floats come back, each the double nearest to the exact value; with ``digits=N`` Decimals, each
    correctly rounded to N significant digits. Raises SceneError (a ValueError) on bad input.
    """
    given = {key: value for key, value in locals().items() if key != "digits"}
    answers = Answers(Scene.read(given), read_digits(digits))
    values = {name: answers[name] for name in NAMES}
    return Solution(scene=answers.case.scene, notes=tuple(words.notes(answers)), **values)
