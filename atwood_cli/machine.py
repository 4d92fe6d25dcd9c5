"""The model of a scene, written once for every number type.

`Case` holds what is decided once and exactly: who is heavier, whether the string grips. `Machine` is
the model in one arithmetic; it computes nothing that is not asked for, and a quantity that the scene
does not determine raises `Undetermined` with the reason.
"""

from fractions import Fraction
from functools import cached_property
from math import inf
from typing import Generic, Literal

from . import physics, profile
from .arithmetic import Arithmetic
from .physics import N
from .rounding import is_positive
from .scene import Radians, Scene

NEEDS_MU = "give mu, the friction coefficient"
NEEDS_M = "give M, the pulley's mass, which decides here"
NEEDS_R = "give R, the pulley's radius"
UNKNOWN_SHAPE = "give M, the pulley's mass, beside I"
FREE_END = "not defined for a free end: the string is fixed to the pulley and no friction holds it"
NO_CRITICAL_MASS = "does not exist, as the string holds on any pulley, however heavy"
NO_CRITICAL_HEAVIER_MASS = "does not exist, as the string holds under any heavier mass"
NOT_BOUNDED = "not one number while the string grips with friction to spare"
NOT_DEFINITE = (
    f"{NOT_BOUNDED}: between friction_force_min and"
    " friction_force_max if friction nowhere opposes the rest; tension locked in on laying the string"
    " widens that range"
)
DEFINITE = "bounds are for a string that grips with friction to spare; here friction_force is definite"
NOT_APPLICABLE = "conditions (36) do not apply without friction"
LOCKED_AXLE = "not defined for a locked pulley: M = inf is not its weight"
ONE_SIDED = "defined for half a turn of wrap (and whole turns more), where both ends pull downwards"
LONG_WRAP = "bounds are known for up to half a turn of wrap (180 degrees)"


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

    @property
    def limiting_mu(self) -> Fraction:
        """The coefficient that friction is at on the verge (static) and in slip (kinetic)."""
        mu, mu_k = self.scene.mu, self.scene.mu_k
        return (mu if self.regime == "verge" or mu_k is None else mu_k) or Fraction(0)

    @property
    def frictionless(self) -> bool:
        """Whether the string moves, or rests, without friction."""
        return self.tensions_equal or (self.regime != "no-slip" and not self.limiting_mu)

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
    if isinstance(scene.wrap, Radians):
        return ar.number(scene.wrap)
    return ar.pi * ar.number(scene.wrap / 180)


def exceeds_half_a_turn(scene: Scene) -> bool:
    """Whether the wrap is beyond 180°."""
    if not isinstance(scene.wrap, Radians):
        return scene.wrap > 180

    def excess(ar: Arithmetic[N]) -> N:
        return wrap_angle(ar, scene) - ar.pi

    return is_positive(excess)


class Machine(Generic[N]):
    """The model of a case in one arithmetic. Its properties are the quantities, by their names."""

    def __init__(self, case: Case, ar: Arithmetic[N]) -> None:
        self.case, self.scene, self.ar = case, case.scene, ar
        self._arcs: dict[profile.Kind, list[profile.Arc[N]]] = {}
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
    def _state(self) -> tuple[N, N, N]:
        """Transfer z, surplus d and effective mass x; see `physics`."""
        case, difference = self.case, self.h - self.l
        if case.regime != "no-slip":
            k1 = self._capstan_excess(case.limiting_mu)
            z = physics.transfer_at_limit(self.l, k1)
            return z, physics.surplus_at_limit(self.l, self.h, k1), self.l + z
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
            return self.ar.number(self.case.limiting_mu)
        mu = self.mu_verge
        if self.scene.mu is not None and not self.case.tensions_equal:
            raise Undetermined(NOT_BOUNDED if exceeds_half_a_turn(self.scene) else NOT_DEFINITE)
        return mu

    @cached_property
    def friction_vector(self) -> tuple[N, N]:
        return self.seen_from_m1(profile.friction(self.arcs("exponential")))

    def seen_from_m1(self, vector: tuple[N, N]) -> tuple[N, N]:
        """A vector as it is where m1, not the lighter mass, is at the start of the arc."""
        return vector if self.case.sign >= 0 else physics.mirrored(*vector, *self._direction)

    @cached_property
    def alpha(self) -> N:
        """The arc (rad) that friction at its limit needs, where the string grips with some to spare."""
        if self.scene.mu is None:
            raise Undetermined(NEEDS_MU)
        log_ratio = self.mu_verge * wrap_angle(self.ar, self.scene)
        return physics.limiting_arc(log_ratio, self.ar.number(self.scene.mu))

    def arcs(self, kind: profile.Kind) -> list[profile.Arc[N]]:
        """The arc of contact from the light end, in pieces: limiting, stuck or both (see `profile`)."""
        if kind not in self._arcs:
            self._arcs[kind] = self._arrange(kind)
        return self._arcs[kind]

    def _arrange(self, kind: profile.Kind) -> list[profile.Arc[N]]:
        ar, mu, light = self.ar, self.arc_mu(kind), self.light_tension
        if ar.is_zero(mu):  # the tension is the same everywhere: no angle is needed, so no π either
            nowhere = ar.number(0)
            return profile.arcs(ar, kind, mu, [nowhere], light, self._end(nowhere))
        phi = wrap_angle(ar, self.scene)
        end = self._end(phi)
        if kind == "exponential":
            return profile.arcs(ar, kind, mu, [phi], light, end)
        stuck = phi - self.alpha
        if kind == "creep":
            return profile.arcs(ar, kind, mu, [stuck, self.alpha], light, end)
        lead = profile.least_lead(ar, mu, self.alpha, stuck, light, end)
        return profile.arcs(ar, kind, mu, [lead, stuck, self.alpha - lead], light, end)

    def arc_mu(self, kind: profile.Kind) -> N:
        """The coefficient that the friction of a profile is at, where it is at its limit."""
        return self._friction_mu if kind == "exponential" else self._given(self.scene.mu, NEEDS_MU)

    @property
    def reference_mu(self) -> N:
        """Static friction, or where it is not given the least that holds."""
        return self.mu_verge if self.scene.mu is None else self.ar.number(self.scene.mu)

    @property
    def capstan_ratio(self) -> N:
        """e^{μφ} at that coefficient; the tension ratio itself where that is what holds."""
        return self.heavy_tension / self.light_tension if self.scene.mu is None else self._k1 + 1

    def _end(self, angle: N) -> profile.Knot[N]:
        return profile.Knot(angle, *self._direction, self.heavy_tension)

    @cached_property
    def resultant_vector(self) -> tuple[N, N]:
        """The force (N) that T1 and T2 would exert on the pulley, x and y."""
        cos, sin = self._direction
        dx, dy = self.heavy_tension * cos - self.light_tension, self.heavy_tension * sin
        return self.seen_from_m1(physics.resultant_vector(dx, dy))

    @cached_property
    def _direction(self) -> tuple[N, N]:
        """Cosine and sine of the angle of wrap; exact at multiples of 90°."""
        quarters = self.scene.wrap / 90
        if isinstance(self.scene.wrap, Radians) or quarters.denominator > 1:
            return self.ar.cos_sin(wrap_angle(self.ar, self.scene))
        cos, sin = ((1, 0), (0, 1), (-1, 0), (0, -1))[quarters.numerator % 4]
        return self.ar.number(cos), self.ar.number(sin)

    @cached_property
    def tension_difference(self) -> N:
        z, _, x = self._state
        return physics.tension_difference(self.h, x, z, self.g) * self.case.sign

    def _bounded(self) -> bool:
        """Whether the friction force is bounded by more than 0; raises where it has no bounds."""
        if self.case.regime != "no-slip":
            raise Undetermined(DEFINITE)
        _ = self.mu_verge
        if self.case.tensions_equal:
            return False
        if self.scene.mu is None:
            raise Undetermined(NEEDS_MU)
        if exceeds_half_a_turn(self.scene):
            raise Undetermined(LONG_WRAP)
        return True

    # The quantities

    @cached_property
    def acceleration(self) -> N:
        _, d, x = self._state
        return physics.acceleration(self.h, x, d, self.g) * self.case.sign

    @cached_property
    def light_tension(self) -> N:
        _, _, x = self._state
        return physics.light_tension(self.l, self.h, x, self.g)

    @cached_property
    def heavy_tension(self) -> N:
        _, _, x = self._state
        return physics.heavy_tension(self.h, x, self.g)

    @property
    def tension_1(self) -> N:
        return self.light_tension if self.case.sign >= 0 else self.heavy_tension

    @property
    def tension_2(self) -> N:
        return self.heavy_tension if self.case.sign >= 0 else self.light_tension

    @cached_property
    def mu_verge(self) -> N:
        case = self.case
        if not case.light:
            raise Undetermined(FREE_END)
        if case.tensions_equal:
            return self.ar.number(0)
        if case.regime == "verge":
            return self.ar.number(self.case.limiting_mu)
        if not case.pulley_known:
            raise Undetermined(NEEDS_M)
        ratio = self.ar.number(case.excess_ratio(case.rim_mass))
        return physics.verge_coefficient(self.ar.log1p(ratio), wrap_angle(self.ar, self.scene))

    @cached_property
    def friction_force(self) -> N:
        mu = self._friction_mu
        if self.ar.is_zero(mu):
            return self.ar.number(0)
        halves = self.scene.wrap / 360
        if isinstance(self.scene.wrap, Radians) or halves.denominator > 2:
            _, sin_half = self.ar.cos_sin(wrap_angle(self.ar, self.scene) / 2)
        else:
            sin_half = self.ar.number(halves.denominator - 1)
        return self._limiting_friction(mu, sin_half)

    def _limiting_friction(self, mu: N, sin_half: N) -> N:
        """The friction force (N) of one arc over which it is at its limit, by the sine of its half."""
        light, heavy, difference = self.light_tension, self.heavy_tension, self.tension_difference
        force = physics.resultant(light, heavy, difference, sin_half, self.ar.sqrt)
        return physics.friction_magnitude(mu, force, self.ar.sqrt)

    @cached_property
    def friction_force_x(self) -> N:
        return self.friction_vector[0]

    @cached_property
    def friction_force_y(self) -> N:
        return self.friction_vector[1]

    @cached_property
    def axle_force(self) -> N:
        if isinstance(self.scene.wrap, Radians) or (self.scene.wrap - 180) % 360:
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
        return self.tension_difference * self._given(self.scene.R, NEEDS_R)

    @cached_property
    def rim_acceleration(self) -> N:
        if self.case.regime != "slip":
            return self.acceleration
        if self.case.rim_mass is None:
            return self.ar.number(0)
        return self.tension_difference / self.ar.number(self.case.rim_mass)

    @cached_property
    def angular_acceleration(self) -> N:
        return self.rim_acceleration / self._given(self.scene.R, NEEDS_R)

    @cached_property
    def critical_pulley_mass(self) -> N:
        k1 = self._k1
        if not self.case.can_slip:
            raise Undetermined(NO_CRITICAL_MASS)
        beta = self._given(self.case.beta, UNKNOWN_SHAPE)
        surplus = physics.surplus_at_limit(self.l, self.h, k1)
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
        if not self._bounded():
            return self.ar.number(0)
        x, y = profile.friction(self.arcs("least"))
        return self.ar.sqrt(x * x + y * y)

    @cached_property
    def friction_force_max(self) -> N:
        if not self._bounded():
            return self.ar.number(0)
        _, sin_half = self.ar.cos_sin(self.alpha / 2)
        return self._limiting_friction(self.arc_mu("creep"), sin_half)
