"""The motion, the tensions and the friction, written once for every number type."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import TYPE_CHECKING, Any, Generic

from ..numbers.lazy import lazy
from ..numbers.rational import N
from . import arc, physics, quantities
from .decisions import Decisions, is_zero
from .quantities import Undetermined
from .scene import DRIVE, MASSES

if TYPE_CHECKING:
    from ..numbers.rational import Arithmetic


def _found(name: str) -> Any:
    """Return the quantity that is an input, if the measured motion finds it."""

    def quantity(machine: Machine[N]) -> N:
        machine.check_finds(name)
        return machine.ar.number(getattr(machine.scene, name))

    return property(quantity)


class Machine(Generic[N]):
    """The motion, the tensions and the friction of a scene in one arithmetic.

    ``known`` has values by the names of attributes, which are then not computed.

    The acceleration is a = g d/s, with a drive d and a load s (see `physics`), and T_l = l (g + a):

        state      drive d                load s                       T_h - T_l
        at rest    0                                                   g (h - l)
        no slip    h - l - b              h + l + c                    c a + f
        verge      h - l - z              h + l + z                    (k - 1) T_l
        slip       the same with μ_k

    On the verge and in slip, d, z and k - 1 are those of friction at its limit (`limiting_drive` and so on).
    Critical masses are made of those of static friction (`drive` and so on).
    """

    def __init__(self, decided: Decisions, ar: Arithmetic[N], known: Mapping[str, N] = {}) -> None:
        self.decided, self.scene, self.ar = decided, decided.scene, ar
        # The axle's friction as a force at the rim (N), and as a mass (kg).
        self.f, self.b = map(ar.number, (decided.axle_friction, decided.axle_mass))
        self._arcs: dict[arc.Profile, list[arc.Arc[N]]] = {}
        for name, value in known.items():
            setattr(self, name, value)

    @lazy
    def l(self) -> N:
        return self.ar.number(self.decided.light)

    @lazy
    def h(self) -> N:
        return self.ar.number(self.decided.heavy)

    @lazy
    def g(self) -> N:
        """Gravity (m/s²), read only where it enters: in a sweep of it `interval` keeps the rest."""
        return self.ar.number(self.scene.g)

    @lazy
    def phi(self) -> N:
        """The angle of wrap φ (rad), as in e^{μφ}. `_direction` and decisions read the wrap in degrees."""
        return self.scene.wrap.radians(self.ar)

    # Intermediate values

    def _given(self, value: Fraction | None, otherwise: str) -> N:
        if value is None:
            raise Undetermined(otherwise)
        return self.ar.number(value)

    @lazy
    def mu(self) -> N:
        """Coefficient of static friction; not given if one mass is 0."""
        reason = quantities.FIXED_END if self.decided.one_mass_is_0 else quantities.NEEDS_MU
        return self._given(self.scene.mu, reason)

    @lazy
    def c(self) -> N:
        """The pulley's inertia as a mass at its rim (kg)."""
        return self._given(self.decided.rim_mass, quantities.NEEDS_M)

    def _capstan_ratio_minus_1(self, given: Fraction | None, mu: N) -> N:
        """Return e^{μφ} - 1, exactly 0 without friction."""
        return self.ar.number(0) if is_zero(given) else self.ar.expm1(mu * self.phi)

    @lazy
    def k_minus_1(self) -> N:
        """k - 1 = e^{μφ} - 1 of static friction."""
        return self._capstan_ratio_minus_1(self.scene.mu, self.mu)

    @lazy
    def ratio_minus_1(self) -> N:
        """T_h/T_l - 1 of a string that grips, (33)."""
        return self.ar.taken_as_not_negative(self.decided.ratio_minus_1("as_given", self.ar))

    @lazy
    def log_ratio(self) -> N:
        """ln(T_h/T_l) of a string that grips; over φ it is mu_verge, over μ the limiting arc."""
        return self.ar.log1p(self.ratio_minus_1)

    @lazy
    def friction_mass(self) -> N:
        """z = l (k - 1) of static friction (kg)."""
        return physics.friction_at_limit(self.l, self.k_minus_1)

    @lazy
    def drive(self) -> N:
        """Drive at the limit of static friction (kg)."""
        return self.ar.taken_as_not_negative(physics.drive(self.l, self.h, self.friction_mass))

    @lazy
    def limiting_k_minus_1(self) -> N:
        """T_h/T_l - 1 on the verge and in slip, as friction is at its limit."""
        if self.decided.slide_measured:
            return self.decided.slide_ratio_minus_1(self.ar)
        if self.decided.limit_is_static:
            return self.k_minus_1
        mu = self.decided.limiting_mu
        return self._capstan_ratio_minus_1(mu, self.ar.number(mu))

    @lazy
    def limiting_friction_mass(self) -> N:
        """z on the verge and in slip (kg)."""
        return physics.friction_at_limit(self.l, self.limiting_k_minus_1)

    @lazy
    def limiting_drive(self) -> N:
        """Drive on the verge and in slip (kg)."""
        return self.ar.taken_as_not_negative(physics.drive(self.l, self.h, self.limiting_friction_mass))

    @lazy
    def magnitude(self) -> N:
        """Acceleration of the heavier mass (m/s²): below 0 only of masses that are braked or driven."""
        l, h, decided = self.l, self.h, self.decided
        if decided.is_driven:
            return self.ar.number(decided.measured_acceleration)
        if decided.at_limit:
            drive, load = self.limiting_drive, physics.load(l, h, self.limiting_friction_mass)
        elif decided.heavier_side == 0 or decided.pulley_at_rest:
            return self.ar.number(0)
        else:
            drive = physics.drive(l, h, self.b)
            drive = drive if decided.slows_down else self.ar.taken_as_not_negative(drive)
            load = physics.load(l, h, self.c)
        return physics.acceleration(drive, load, self.g)

    @lazy
    def friction_mu(self) -> N:
        """The μ of T(θ) = T1 e^{±μθ}. Raises Undetermined if the string grips with friction to spare."""
        if self.decided.slide_measured:
            return self.mu_k
        if self.decided.at_limit:
            return self.ar.number(self.decided.limiting_mu)
        self._check_grips()
        if self.scene.mu is None or self.decided.tensions_equal or not self.decided.pulley_known:
            return self.mu_verge
        raise Undetermined(quantities.NOT_BOUNDED if self.decided.long_wrap else quantities.NOT_DEFINITE)

    @lazy
    def friction_vector(self) -> tuple[N, N]:
        """Net friction force on the pulley (N), (x, y), seen from m1."""
        return self.seen_from_m1(arc.force(self.arcs("exponential"), physics.friction_vector))

    def seen_from_m1(self, vector: tuple[N, N]) -> tuple[N, N]:
        """Return a vector that is given from the lighter mass's end of the arc as seen from m1's end."""
        return vector if self.decided.heavier_side >= 0 else physics.mirrored(*vector, *self._direction)

    @lazy
    def limiting_arc(self) -> N:
        """The arc (rad) over which friction at its limit makes up the ratio of the tensions."""
        return physics.verge_coefficient(self.log_ratio, self.mu)

    def arcs(self, kind: arc.Profile) -> list[arc.Arc[N]]:
        """Return the arc of contact from the light end, in limiting and stuck pieces (see `arc`)."""
        if kind not in self._arcs:
            self._arcs[kind] = self._arrange(kind)
        return self._arcs[kind]

    def _arrange(self, kind: arc.Profile) -> list[arc.Arc[N]]:
        ar, mu, light, zero = self.ar, self.arc_mu(kind), self.light_tension, self.ar.number(0)
        # Without friction the tension is the same everywhere: no angle is needed, so no π either.
        phi = zero if ar.is_zero(mu) else self.phi
        end = arc.Knot(phi, *self._direction, self.heavy_tension)
        if kind == "exponential":
            return arc.arcs(ar, [(mu, phi)], light, end)
        stuck = phi - self.limiting_arc
        if kind == "creep":
            return arc.arcs(ar, [(zero, stuck), (mu, self.limiting_arc)], light, end)
        lead = arc.least_lead(ar, mu, self.limiting_arc, stuck, light, end)
        return arc.arcs(ar, [(mu, lead), (zero, stuck), (mu, self.limiting_arc - lead)], light, end)

    def arc_mu(self, kind: arc.Profile) -> N:
        """Return the coefficient of a profile's friction at its limit."""
        return self.friction_mu if kind == "exponential" else self.mu

    @lazy
    def resultant_vector(self) -> tuple[N, N]:
        """The force (N), (x, y), that T1 and T2 would exert on the pulley."""
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
        decided = self.decided
        if decided.at_limit:
            return physics.friction_at_limit(self.light_tension, self.limiting_k_minus_1)
        if decided.tensions_equal:
            return self.ar.number(0)
        if decided.pulley_at_rest or decided.is_driven:
            a = self.magnitude if decided.is_driven else self.ar.number(0)
            difference = physics.difference_of_moving_masses(self.l, self.h, a, self.g)
            return self.ar.taken_as_not_negative(difference)
        return physics.difference_of_a_pulley(self.c, self.magnitude, self.f)

    @lazy
    def tension_difference(self) -> N:
        """T2 - T1 (N)."""
        return self.difference * self.decided.heavier_side

    def _tensions_differ(self) -> bool:
        """Decide whether a string that grips has unequal tensions. Raises Undetermined if they are not known.

        If they differ and the pulley is not known, they are those on the verge.
        """
        if self.decided.one_mass_is_0:
            raise Undetermined(quantities.FIXED_END)
        if self.decided.tensions_equal:
            return False
        if not self.decided.pulley_known and self.decided.regime != "verge":
            raise Undetermined(quantities.NEEDS_M)
        return True

    def _bounded(self) -> bool:
        """Decide whether the friction force has bounds above 0. Raises Undetermined if it has none."""
        if self.decided.at_limit:
            raise Undetermined(quantities.DEFINITE)
        self._check_grips()
        if not self._tensions_differ():
            return False
        _ = self.mu  # raises if it is not given
        if self.decided.long_wrap:
            raise Undetermined(quantities.LONG_WRAP)
        return True

    def check_finds(self, name: str) -> None:
        """Raise Undetermined unless the measured motion finds an input, or the drive."""
        motion = self.decided.motion
        if motion.finds == name:
            return
        if motion.finds:
            raise Undetermined(quantities.FINDS_ANOTHER.format(motion.finds))
        raise Undetermined(quantities.NEEDS_MOTION.format(quantities.TO_FIND[name]))

    def _check_grips(self) -> None:
        """Raise Undetermined if the string would slip over a driven pulley."""
        if self.decided.is_driven and self.decided.regime == "slip":
            raise Undetermined(quantities.WOULD_SLIP)

    # The quantities

    @lazy
    def acceleration(self) -> N:
        side = self.decided.heavier_side
        return self.magnitude if side >= 0 else self.magnitude * side

    @lazy
    def light_tension(self) -> N:
        """Tension on the lighter mass (N), from (1)."""
        return physics.light_tension(self.l, self.magnitude, self.g)

    @lazy
    def heavy_tension(self) -> N:
        """Tension on the heavier mass (N)."""
        return self.light_tension + self.difference

    @lazy
    def tension_1(self) -> N:
        return self.light_tension if self.decided.heavier_side >= 0 else self.heavy_tension

    @lazy
    def tension_2(self) -> N:
        return self.heavy_tension if self.decided.heavier_side >= 0 else self.light_tension

    @lazy
    def mu_verge(self) -> N:
        if not self._tensions_differ():
            return self.ar.number(0)
        if not self.decided.pulley_known:
            return self.ar.number(self.decided.limiting_mu)
        phi = self.phi  # before the ratio, which is not worth computing in fractions: they have no π
        return physics.verge_coefficient(self.log_ratio, phi)

    @lazy
    def safety_factor(self) -> N:
        mu = self.mu
        if self.decided.tensions_equal or (self.decided.regime == "verge" and is_zero(self.scene.mu)):
            raise Undetermined(quantities.NO_NEED)
        return mu / self.mu_verge

    @lazy
    def tension_ratio(self) -> N:
        if self.decided.at_limit:
            return self.limiting_k_minus_1 + 1
        return self.ratio_minus_1 + 1 if self._tensions_differ() else self.ar.number(1)

    @lazy
    def capstan_ratio(self) -> N:
        return self.k_minus_1 + 1

    @lazy
    def mu_verge_massless(self) -> N:
        """Friction coefficient at which the string is on the verge over a massless pulley."""
        ratio_minus_1 = self.decided.ratio_minus_1("massless", self.ar)
        return physics.verge_coefficient(self.ar.log1p(ratio_minus_1), self.phi)

    @lazy
    def friction_force(self) -> N:
        mu = self.friction_mu
        if self.ar.is_zero(mu):
            return self.ar.number(0)
        return physics.friction_magnitude(mu, self.resultant_magnitude, self.ar.sqrt)

    @property
    def resultant_magnitude(self) -> N:
        """Magnitude of the force (N) that T1 and T2 would exert on the pulley."""
        if self.decided.ends_hang_down:
            return self.light_tension + self.heavy_tension  # (20)
        return self._resultant(self.half_sine)

    def _resultant(self, sin_half: N) -> N:
        """Return the force (N) of both tensions on an arc, by the sine of its half."""
        light, heavy, ar = self.light_tension, self.heavy_tension, self.ar
        return physics.resultant(light, heavy, self.difference, sin_half, ar.sqrt)

    @lazy
    def friction_force_x(self) -> N:
        return self.friction_vector[0]

    @lazy
    def friction_force_y(self) -> N:
        return self.friction_vector[1]

    @lazy
    def torque(self) -> N:
        return self.tension_difference * self._given(self.scene.R, quantities.NEEDS_R)

    @lazy
    def rim_acceleration(self) -> N:
        if self.decided.regime != "slip":
            return self.acceleration
        self._check_grips()
        if self.decided.rim_at_rest:
            return self.ar.number(0)
        return physics.rim_acceleration(self.difference, self.c, self.f) * self.decided.heavier_side

    @lazy
    def angular_acceleration(self) -> N:
        return self.rim_acceleration / self._given(self.scene.R, quantities.NEEDS_R)

    @lazy
    def mu_k(self) -> N:
        self.check_finds("mu_k")
        return physics.verge_coefficient(self.ar.log1p(self.limiting_k_minus_1), self.phi)

    @lazy
    def friction_force_min(self) -> N:
        """Least net friction force (N) of a string that grips, if all friction acts one way."""
        if not self._bounded():
            return self.ar.number(0)
        x, y = arc.force(self.arcs("least"), physics.friction_vector)
        return self.ar.sqrt(x * x + y * y)

    @lazy
    def friction_force_max(self) -> N:
        """Greatest net friction force (N) of a string that grips, if all friction acts one way."""
        if not self._bounded():
            return self.ar.number(0)
        _, sin_half = self.ar.cos_sin(self.limiting_arc / 2)
        return physics.friction_magnitude(self.arc_mu("creep"), self._resultant(sin_half), self.ar.sqrt)

    # Limits, what follows from a measured motion, and a fall

    @lazy
    def axle_force(self) -> N:
        if not self.decided.ends_hang_down:
            raise Undetermined(quantities.ONE_SIDED)
        if self.decided.locked:
            raise Undetermined(quantities.LOCKED_AXLE)
        on_verge, given = self.decided.regime == "verge", self.decided.pulley_mass
        mass = self.critical_pulley_mass if on_verge else self._given(given, quantities.NEEDS_M)
        return physics.axle_force(self.tension_1, self.tension_2, mass, self.g)

    @lazy
    def critical_pulley_mass(self) -> N:
        """Pulley mass (kg) above which the string slips; also if the pulley given is locked."""
        decided, _ = self.decided, (self.decided.heavier_side, self.mu)  # raise if one is not given
        if decided.is_driven:
            raise Undetermined(quantities.ANY_DRIVEN)
        if not decided.can_slip:
            raise Undetermined(quantities.AXLE_HOLDS if decided.axle_holds else quantities.NO_CRITICAL_MASS)
        if decided.always_slips:
            raise Undetermined(quantities.ALWAYS_SLIPS)
        beta = self._given(self.decided.beta, quantities.UNKNOWN_SHAPE)
        return physics.critical_pulley_mass(self.l, self.h, self.friction_mass, self.drive, beta, self.b)

    @lazy
    def critical_heavier_mass(self) -> N:
        friction_mass = self.friction_mass
        if self.decided.slips_at_rest:
            return self.least_heavier_mass
        c = self.c
        if self.decided.pulley_is_ideal or not self.decided.slips_at("heaviest"):
            raise Undetermined(quantities.NO_CRITICAL_HEAVIER_MASS)
        return physics.critical_heavier_mass(self.l, c, friction_mass, self.b)

    @lazy
    def critical_lighter_mass(self) -> N:
        """Lighter mass below which the string slips (kg); 0 if it slips under none."""
        k_minus_1, h = self.k_minus_1, self.h
        if self.decided.is_driven:
            least = physics.lighter_mass_at_rest(self.heavy_tension, self.capstan_ratio)
            return physics.mass_of_tension(least, self.magnitude, self.g)
        if self.decided.pulley_at_rest_until_it_slips:
            return physics.lighter_mass_at_rest(h, self.capstan_ratio)
        if self.decided.pulley_is_ideal:
            return self.ar.number(0)
        return physics.critical_lighter_mass(h, self.c, k_minus_1, self.b)

    @lazy
    def least_heavier_mass(self) -> N:
        if not self.decided.is_driven:
            return physics.least_heavier_mass(self.l, self.friction_mass)
        return physics.mass_of_tension(self.light_tension * self.capstan_ratio, -1 * self.magnitude, self.g)

    @lazy
    def least_pulley_mass(self) -> N:
        friction_mass = self.friction_mass
        if self.decided.is_driven:
            raise Undetermined(quantities.ANY_DRIVEN)
        if self.decided.slips_once_it_moves:
            raise Undetermined(quantities.AXLE_ENOUGH)
        beta = self._given(self.decided.beta, quantities.UNKNOWN_SHAPE)
        return physics.least_pulley_mass(friction_mass, beta, self.b)

    @lazy
    def least_wrap(self) -> N:
        _ = self.mu  # raises if it is not given
        if not self._tensions_differ():
            return self.ar.number(0)
        no_friction = is_zero(self.scene.mu)
        if not self.decided.pulley_known:  # without friction the pulley on the verge has no mass
            return self.ar.number(0) if no_friction else self.scene.wrap.degrees(self.ar)
        if no_friction:
            raise Undetermined(quantities.NO_WRAP)
        return self.limiting_arc * 180 / self.ar.pi

    pulley_mass, gravity, m1, m2, axle = map(_found, ("M", "g", *MASSES, "axle"))

    @property
    def moment_of_inertia(self) -> N:
        if self.scene.M is self.scene.I is None:
            raise Undetermined(quantities.NEEDS_M)
        c = self._given(self.decided.rim_mass, quantities.LOCKED_I)
        return physics.moment_of_inertia(c, self._given(self.scene.R, quantities.NEEDS_R))

    @property
    def axle_torque(self) -> N:
        torque: N = self.axle * self._given(self.scene.R, quantities.NEEDS_R)
        return torque

    @lazy
    def drive_force(self) -> N:
        self.check_finds(DRIVE)
        self._check_grips()
        way = self.decided.motion.way
        if self.decided.has_axle_friction and not way:
            raise Undetermined(quantities.EITHER_WAY)
        return self.drive_force_against(way)

    def drive_force_against(self, direction: int) -> N:
        """Return the drive (N) of a pulley that turns with m2 downwards (1) or upwards (-1); (3) with it."""
        turns = physics.difference_of_a_pulley(self.c, self.acceleration, self.f * direction)
        return turns - self.tension_difference

    @property
    def drive_torque(self) -> N:
        torque: N = self.drive_force * self._given(self.scene.R, quantities.NEEDS_R)
        return torque

    @property
    def drive_power(self) -> N:
        force, given = self.drive_force, self.decided.fall
        if "speed" not in given and not (given and self.decided.measured_acceleration):
            raise Undetermined(quantities.NEEDS_SPEED)
        speed = self.ar.number(given["speed"]) if "speed" in given else self.final_speed
        power: N = force * speed
        return power if self.decided.motion.way >= 0 else power * -1

    @lazy
    def fall_time(self) -> N:
        a, given = self._fall()
        if "time" in given:
            return given["time"]
        if "speed" in given:
            return physics.time_or_acceleration(given["speed"], a)
        return physics.fall_time(given["drop"], a, self.ar.sqrt)

    @lazy
    def final_speed(self) -> N:
        a, given = self._fall()
        return given["speed"] if "speed" in given else physics.speed_after(a, self.fall_time)

    @lazy
    def drop(self) -> N:
        a, given = self._fall()
        return given["drop"] if "drop" in given else physics.height_or_acceleration(self.final_speed, a)

    @property
    def final_angular_speed(self) -> N:
        return self._of_rim(self.final_speed) / self._given(self.scene.R, quantities.NEEDS_R)

    @property
    def kinetic_energy(self) -> N:
        a, rim_distance = self._fall()[0], self._of_rim(self.drop)
        energy = physics.kinetic_energy(self.l + self.h, a, self.drop)
        if self.decided.regime == "slip" and self.decided.rim_at_rest:
            return energy
        on_verge, beta = self.decided.regime == "verge", self.decided.beta
        c = self.critical_pulley_mass * self._given(beta, quantities.NEEDS_M) if on_verge else self.c
        return energy + physics.kinetic_energy(c, self._of_rim(a), rim_distance)

    def _of_rim(self, motion: N) -> N:
        """Return what the rim has of an acceleration, a speed or a distance: less if the string slips."""
        if self.decided.regime != "slip":
            return motion
        return motion * (self.rim_acceleration * self.decided.heavier_side / self.magnitude)

    def _fall(self) -> tuple[N, dict[str, N]]:
        """Return the acceleration (m/s²), and what is given of a fall."""
        if not self.decided.motion.fall:
            raise Undetermined(quantities.NEEDS_FALL)
        if self.decided.slows_down:
            raise Undetermined(quantities.SLOWS_DOWN)
        lighter_falls = self.decided.is_driven and self.decided.measured_acceleration < 0
        a = self.magnitude * -1 if lighter_falls else self.magnitude
        if self.ar.is_zero(a):
            raise Undetermined(quantities.AT_REST)
        return a, {name: self.ar.number(x) for name, x in self.decided.fall.items()}
