"""What moves and what pulls, written once for every number type; why a quantity may be undetermined."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import TYPE_CHECKING, Generic

from ..arithmetic.lazy import lazy
from ..arithmetic.rational import N
from . import arc, physics
from .case import Case, is_zero

if TYPE_CHECKING:
    from ..arithmetic.rational import Arithmetic

NEEDS_MU = "`give` `mu`, the friction coefficient"
NEEDS_M = "`give` `M`, the pulley's mass, which decides here"
NEEDS_R = "`give` `R`, the pulley's radius"
UNKNOWN_SHAPE = "`give` `M`, the pulley's mass, beside `I`"
FREE_END = "not defined for a free end: the string is fixed to the pulley and no friction holds it"
NOT_BOUNDED = "not one number while the string grips with friction to spare"
NOT_DEFINITE = (
    "between `friction_force_min` and `friction_force_max` while the string grips"
    " (atwood quantities says when)"
)
DEFINITE = "bounds are for a string that grips with friction to spare; here `friction_force` is definite"
LONG_WRAP = "bounds are known for up to half a turn of wrap (180 degrees)"
NO_CRITICAL_MASS = "does not exist, as the string holds on any pulley, however heavy"
NO_CRITICAL_HEAVIER_MASS = "does not exist, as the string holds under any heavier mass"
AXLE_HOLDS = "does not exist, as the axle holds the difference on any pulley"
ALWAYS_SLIPS = "does not exist, as for the friction of the axle the string slips on any pulley, however light"
AXLE_ENOUGH = "no condition here, as the friction of the axle is enough to make the string slip on any pulley"
NO_NEED = "does not exist, as no friction is needed"
NO_WRAP = "does not exist, as without friction no wrap holds"
NOT_APPLICABLE = "conditions (36) do not apply without friction"
LOCKED_AXLE = "not defined for a locked pulley: `M` = `inf` is not its weight"
ONE_SIDED = "defined for half a turn of wrap (and whole turns more), where both ends pull downwards"
NEEDS_A = "`give` `a`, a measured acceleration, in place of `M`"
NEEDS_A_BESIDE_M = "`give` `a`, a measured acceleration, beside `M` and in place of `g`"
NEEDS_A_AND_M = "`give` `a`, a measured acceleration, and `M` in place of `{}`"
NEEDS_A_OF_A_SLIDE = (
    "`give` `a`, a measured acceleration, beside `M` = `inf`, or beside `M` and a `mu` that is too small"
)
NEEDS_DROP = "`give` `drop`, the height that the heavier mass falls from rest"
AT_REST = "does not exist, as nothing moves"


class Undetermined(Exception):
    """The scene does not determine the quantity; the reason says why and what to give.

    What a page of mathematics writes in another way stands between backticks: names of inputs and of
    quantities, and the word "give". `solver.messages` says who takes the backticks out.
    """


class Mechanics(Generic[N]):
    """The motion, the tensions and the friction of a case in one arithmetic.

    ``known`` are quantities known beforehand, by name: they are taken as they are and not computed.
    """

    def __init__(self, case: Case, ar: Arithmetic[N], known: Mapping[str, N] | None = None) -> None:
        self.case, self.scene, self.ar = case, case.scene, ar
        self._arcs: dict[arc.Kind, list[arc.Arc[N]]] = {}
        for name, value in (known or {}).items():
            setattr(self, name, value)

    @lazy
    def l(self) -> N:
        """Lighter mass (kg)."""
        return self.ar.number(self.case.light)

    @lazy
    def h(self) -> N:
        """Heavier mass (kg)."""
        return self.ar.number(self.case.heavy)

    @lazy
    def g(self) -> N:
        """Gravity (m/s²)."""
        return self.ar.number(self.scene.g)

    @property
    def f(self) -> N:
        """The axle's friction as a force at the rim (N)."""
        return self.ar.number(self.case.axle_friction)

    @property
    def b(self) -> N:
        """That friction as a mass (kg)."""
        return self.ar.number(self.case.axle_mass)

    @lazy
    def phi(self) -> N:
        """The angle of wrap φ (rad)."""
        return self.scene.wrap.radians(self.ar)

    # What the quantities are made of

    def _given(self, value: Fraction | None, otherwise: str) -> N:
        if value is None:
            raise Undetermined(otherwise)
        return self.ar.number(value)

    @property
    def mu(self) -> N:
        """Coefficient of static friction, which a free end does not take."""
        return self._given(self.scene.mu, FREE_END if self.case.free_end else NEEDS_MU)

    def _capstan_excess(self, given: Fraction | None, mu: N) -> N:
        """e^{μφ} - 1; without friction no exponential is asked for."""
        return self.ar.number(0) if is_zero(given) else self.ar.expm1(mu * self.phi)

    @lazy
    def k1(self) -> N:
        """Excess k - 1 of the capstan ratio of static friction."""
        return self._capstan_excess(self.scene.mu, self.mu)

    @lazy
    def excess(self) -> N:
        """T_h/T_l - 1 of a string that grips."""
        return self.ar.not_negative(self.case.excess("scene", self.ar))

    @lazy
    def log_ratio(self) -> N:
        """ln(T_h/T_l) of a string that grips."""
        return self.ar.log1p(self.excess)

    @lazy
    def transfer(self) -> N:
        """Transfer z at the limit of static friction (kg); see `physics`."""
        return physics.transfer_at_limit(self.l, self.k1)

    @lazy
    def drive(self) -> N:
        """Drive d at the limit of static friction (kg); see `physics`."""
        return self.ar.not_negative(physics.drive(self.l, self.h, self.transfer))

    @lazy
    def limiting_k1(self) -> N:
        """The excess of the tension ratio in a regime where friction is at its limit."""
        if self.case.slide_measured:
            return self.case.slide_excess(self.ar)
        if self.case.at_static_limit:
            return self.k1
        kinetic = self.case.limiting_mu
        return self._capstan_excess(kinetic, self.ar.number(kinetic))

    @lazy
    def limiting_transfer(self) -> N:
        """Transfer z at the limit of the friction that acts, kinetic in slip (kg)."""
        if self.case.at_static_limit:
            return self.transfer
        return physics.transfer_at_limit(self.l, self.limiting_k1)

    @lazy
    def limiting_drive(self) -> N:
        """Drive d at the limit of the friction that acts, kinetic in slip (kg)."""
        if self.case.at_static_limit:
            return self.drive
        return self.ar.not_negative(physics.drive(self.l, self.h, self.limiting_transfer))

    @lazy
    def gripping_drive(self) -> N:
        """Drive d of a string that grips and moves (kg); see `physics`."""
        return self.ar.not_negative(physics.drive(self.l, self.h, self.b))

    @lazy
    def magnitude(self) -> N:
        """Magnitude of the acceleration (m/s²)."""
        l, h, case = self.l, self.h, self.case
        if case.regime != "no-slip":
            drive, load = self.limiting_drive, physics.load(l, h, self.limiting_transfer)
        elif case.sign == 0 or case.stands:
            return self.ar.number(0)
        else:
            drive = self.gripping_drive
            load = physics.load(l, h, self._given(case.rim_mass, NEEDS_M))
        return physics.acceleration(drive, load, self.g)

    @lazy
    def friction_mu(self) -> N:
        """The μ with which T(θ) = T1 e^{±μθ}, where that is so."""
        if self.case.slide_measured:
            return self.mu_k
        if self.case.regime != "no-slip":
            return self.ar.number(self.case.limiting_mu)
        if self.scene.mu is None or self.case.tensions_equal or not self.case.pulley_known:
            return self.mu_verge
        raise Undetermined(NOT_BOUNDED if self.case.long_wrap else NOT_DEFINITE)

    @lazy
    def friction_vector(self) -> tuple[N, N]:
        """Net friction force on the pulley (N), (x, y), seen from m1."""
        return self.seen_from_m1(arc.friction(self.arcs("exponential")))

    def seen_from_m1(self, vector: tuple[N, N]) -> tuple[N, N]:
        """A vector as it is where m1, not the lighter mass, is at the start of the arc."""
        return vector if self.case.sign >= 0 else physics.mirrored(*vector, *self._direction)

    @lazy
    def alpha(self) -> N:
        """The arc (rad) that friction at its limit needs, where the string grips with some to spare."""
        mu = self.mu
        return physics.limiting_arc(self.log_ratio, mu)

    def arcs(self, kind: arc.Kind) -> list[arc.Arc[N]]:
        """The arc of contact from the light end, in pieces: limiting, stuck or both (see `arc`)."""
        if kind not in self._arcs:
            self._arcs[kind] = self._arrange(kind)
        return self._arcs[kind]

    def _arrange(self, kind: arc.Kind) -> list[arc.Arc[N]]:
        ar, mu, light = self.ar, self.arc_mu(kind), self.light_tension
        if ar.is_zero(mu):  # the tension is the same everywhere: no angle is needed, so no π either
            nowhere = ar.number(0)
            return arc.arcs(ar, kind, mu, [nowhere], light, self._end(nowhere))
        phi = self.phi
        end = self._end(phi)
        if kind == "exponential":
            return arc.arcs(ar, kind, mu, [phi], light, end)
        stuck = phi - self.alpha
        if kind == "creep":
            return arc.arcs(ar, kind, mu, [stuck, self.alpha], light, end)
        lead = arc.least_lead(ar, mu, self.alpha, stuck, light, end)
        return arc.arcs(ar, kind, mu, [lead, stuck, self.alpha - lead], light, end)

    def arc_mu(self, kind: arc.Kind) -> N:
        """The coefficient that the friction of a profile is at, where it is at its limit."""
        return self.friction_mu if kind == "exponential" else self.mu

    def _end(self, angle: N) -> arc.Knot[N]:
        return arc.Knot(angle, *self._direction, self.heavy_tension)

    @lazy
    def resultant_vector(self) -> tuple[N, N]:
        """The force (N) that T1 and T2 would exert on the pulley, x and y."""
        cos, sin = self._direction
        dx, dy = self.heavy_tension * cos - self.light_tension, self.heavy_tension * sin
        return self.seen_from_m1(physics.resultant_vector(dx, dy))

    @lazy
    def _direction(self) -> tuple[N, N]:
        """Cosine and sine of the angle of wrap."""
        return self.scene.wrap.cos_sin(self.ar)

    @lazy
    def half_sine(self) -> N:
        """Sine of half the angle of wrap."""
        return self.scene.wrap.cos_sin(self.ar, 2)[1]

    @lazy
    def difference(self) -> N:
        """Magnitude of T2 - T1 (N)."""
        case = self.case
        if case.regime != "no-slip":
            return physics.difference_of_friction(self.light_tension, self.limiting_k1)
        if case.tensions_equal:
            return self.ar.number(0)
        if case.stands:
            return self.ar.not_negative(physics.difference_of_a_locked_pulley(self.l, self.h, self.g))
        c = self._given(case.rim_mass, NEEDS_M)
        return physics.difference_of_a_pulley(c, self.magnitude, self.f)

    @property
    def tension_difference(self) -> N:
        """T2 - T1 (N)."""
        return self.difference * self.case.sign

    def _bounded(self) -> bool:
        """Whether the friction force is bounded by more than 0; raises where it has no bounds."""
        if self.case.regime != "no-slip":
            raise Undetermined(DEFINITE)
        _ = self.mu_verge  # raises where there is none
        if self.case.tensions_equal:
            return False
        _ = self.mu  # raises if it is not given
        if self.case.long_wrap:
            raise Undetermined(LONG_WRAP)
        return True

    # The quantities

    @property
    def acceleration(self) -> N:
        """Acceleration of the masses (m/s²), positive when m2 descends: (4), in slip (1) with (26)."""
        return self.magnitude if self.case.sign > 0 else self.magnitude * self.case.sign

    @lazy
    def light_tension(self) -> N:
        """Tension on the lighter mass (N), from (1)."""
        return physics.light_tension(self.l, self.magnitude, self.g)

    @lazy
    def heavy_tension(self) -> N:
        """Tension on the heavier mass (N)."""
        return self.light_tension + self.difference

    @property
    def tension_1(self) -> N:
        """Tension of the string at m1 (N): (4), in slip (1) with (26)."""
        return self.case.by_side(self.light_tension, self.heavy_tension)[0]

    @property
    def tension_2(self) -> N:
        """Tension of the string at m2 (N): (4), in slip (1) with (26)."""
        return self.case.by_side(self.light_tension, self.heavy_tension)[1]

    @lazy
    def mu_verge(self) -> N:
        """Friction coefficient at which a string that grips would be on the verge of slipping (27)."""
        case = self.case
        if case.free_end:
            raise Undetermined(FREE_END)
        if case.tensions_equal:
            return self.ar.number(0)
        if not case.pulley_known:
            if case.regime == "verge":
                return self.ar.number(case.limiting_mu)
            raise Undetermined(NEEDS_M)
        phi = self.phi  # first, as fractions give up on π sooner than on the ratio
        return physics.verge_coefficient(self.log_ratio, phi)

    @lazy
    def safety_factor(self) -> N:
        """The coefficient of friction over the one that a string which grips needs."""
        mu = self.mu
        if self.case.tensions_equal or (self.case.regime == "verge" and is_zero(self.scene.mu)):
            raise Undetermined(NO_NEED)
        return physics.safety_factor(mu, self.mu_verge)

    @lazy
    def tension_ratio(self) -> N:
        """The greater tension over the lesser (33)."""
        if self.case.regime != "no-slip":
            return self.limiting_k1 + 1
        if self.case.free_end:
            raise Undetermined(FREE_END)
        if self.case.tensions_equal:
            return self.ar.number(1)
        if not self.case.pulley_known:
            raise Undetermined(NEEDS_M)
        return self.excess + 1

    @lazy
    def capstan_ratio(self) -> N:
        """e^{μφ}, the greatest ratio of tensions that static friction holds (26)."""
        return self.k1 + 1

    @lazy
    def massless_verge(self) -> N:
        """Friction coefficient at which a string that turns an axle without a pulley is on the verge."""
        return physics.verge_coefficient(self.ar.log1p(self.case.excess("massless", self.ar)), self.phi)

    @lazy
    def friction_force(self) -> N:
        """Magnitude of the net friction force on the pulley (N), where it is one number (32)."""
        mu = self.friction_mu
        if self.ar.is_zero(mu):
            return self.ar.number(0)
        if self.case.ends_hang_down:
            force = physics.half_turn_resultant(self.light_tension, self.heavy_tension)
        else:
            force = self._resultant(self.half_sine)
        return physics.friction_magnitude(mu, force, self.ar.hypot)

    def _resultant(self, sin_half: N) -> N:
        """The force (N) of both tensions on an arc, by the sine of its half."""
        light, heavy, ar = self.light_tension, self.heavy_tension, self.ar
        return physics.resultant(light, heavy, self.difference, sin_half, ar.sqrt, ar.hypot)

    @lazy
    def friction_force_x(self) -> N:
        """Net friction force on the pulley (N), towards the side of m1 (31)."""
        return self.friction_vector[0]

    @lazy
    def friction_force_y(self) -> N:
        """Net friction force on the pulley (N), upwards (31)."""
        return self.friction_vector[1]

    @lazy
    def torque(self) -> N:
        """Torque of the string on the pulley (N m), positive the way m2 descends (23)."""
        return self.tension_difference * self._given(self.scene.R, NEEDS_R)

    @lazy
    def rim_acceleration(self) -> N:
        """Acceleration of the pulley's rim (m/s²), which falls behind the string in slip (3)."""
        if self.case.regime != "slip":
            return self.acceleration
        if self.case.rim_stands:
            return self.ar.number(0)
        c = self._given(self.case.rim_mass, NEEDS_M)
        return physics.rim_acceleration(self.difference, c, self.f) * self.case.sign

    @lazy
    def angular_acceleration(self) -> N:
        """Angular acceleration of the pulley (rad/s²), positive the way m2 descends (2)."""
        return self.rim_acceleration / self._given(self.scene.R, NEEDS_R)

    @lazy
    def mu_k(self) -> N:
        """Coefficient of kinetic friction that gives the measured acceleration, from (26)."""
        if not self.case.slide_measured:
            raise Undetermined(NEEDS_A_OF_A_SLIDE)
        return physics.verge_coefficient(self.ar.log1p(self.limiting_k1), self.phi)

    @lazy
    def friction_force_min(self) -> N:
        """Least net friction force (N) of a string that grips, if friction nowhere opposes the rest."""
        if not self._bounded():
            return self.ar.number(0)
        x, y = arc.friction(self.arcs("least"))
        return self.ar.sqrt(x * x + y * y)

    @lazy
    def friction_force_max(self) -> N:
        """Greatest net friction force (N) of a string that grips, if friction nowhere opposes the rest."""
        if not self._bounded():
            return self.ar.number(0)
        _, sin_half = self.ar.cos_sin(self.alpha / 2)
        return physics.friction_magnitude(self.arc_mu("creep"), self._resultant(sin_half), self.ar.hypot)
