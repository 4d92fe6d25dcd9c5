"""Compute critical masses, inputs found from a measured motion, and the time and the speed of a fall.

`Machine` is the model of a scene in one arithmetic. It inherits the acceleration, the tensions and the
friction from `Mechanics`. It computes nothing that is not asked for. A quantity that the scene does not
determine raises `Undetermined` with the reason.
"""

from __future__ import annotations

from ..arithmetic.lazy import lazy
from ..arithmetic.rational import N
from . import physics, quantities
from .decisions import is_zero
from .mechanics import Mechanics
from .quantities import Undetermined


class Machine(Mechanics[N]):
    """The model of a scene in one arithmetic. Its properties are the quantities, as `quantities` has them."""

    @lazy
    def axle_force(self) -> N:
        if not self.case.ends_hang_down:
            raise Undetermined(quantities.ONE_SIDED)
        if self.case.locked:
            raise Undetermined(quantities.LOCKED_AXLE)
        if self.case.regime == "verge":
            mass = self.critical_pulley_mass
        else:
            mass = self._given(self.case.pulley_mass, quantities.NEEDS_M)
        return physics.axle_force(self.tension_1, self.tension_2, mass, self.g)

    @lazy
    def critical_pulley_mass(self) -> N:
        _ = self.mu  # raises if it is not given
        if not self.case.can_slip:
            raise Undetermined(quantities.AXLE_HOLDS if self.case.axle_holds else quantities.NO_CRITICAL_MASS)
        if self.case.always_slips:
            raise Undetermined(quantities.ALWAYS_SLIPS)
        friction_mass = self.friction_mass
        beta = self._given(self.case.beta, quantities.UNKNOWN_SHAPE)
        return physics.critical_pulley_mass(self.l, self.h, friction_mass, self.drive, beta, self.b)

    @lazy
    def critical_heavier_mass(self) -> N:
        friction_mass = self.friction_mass
        if self.case.slips_at_rest:
            return self.least_heavier_mass
        c = self._given(self.case.rim_mass, quantities.NEEDS_M)
        if self.case.pulley_is_ideal or not self.case.slips_at("heaviest"):
            raise Undetermined(quantities.NO_CRITICAL_HEAVIER_MASS)
        return physics.critical_heavier_mass(self.l, c, friction_mass, self.b)

    @lazy
    def critical_lighter_mass(self) -> N:
        """Lighter mass below which the string slips (kg); 0 if it slips under none."""
        k_minus_1, h = self.k_minus_1, self.h
        if self.case.pulley_at_rest_until_it_slips:
            return physics.lighter_mass_at_rest(h, self.capstan_ratio)
        c = self._given(self.case.rim_mass, quantities.NEEDS_M)
        if self.case.pulley_is_ideal:
            return self.ar.number(0)
        return physics.critical_lighter_mass(h, c, k_minus_1, self.b)

    @lazy
    def least_heavier_mass(self) -> N:
        self._check_applicable()
        return physics.least_heavier_mass(self.l, self.friction_mass)

    @lazy
    def least_pulley_mass(self) -> N:
        self._check_applicable()
        friction_mass = self.friction_mass
        if self.case.slips_once_it_moves:
            raise Undetermined(quantities.AXLE_ENOUGH)
        beta = self._given(self.case.beta, quantities.UNKNOWN_SHAPE)
        return physics.least_pulley_mass(friction_mass, beta, self.b)

    def _check_applicable(self) -> None:
        """Raise Undetermined if the critical pulley has no mass, so that (36) has no meaning."""
        if is_zero(self.scene.mu) and not self.case.pulley_known and not self.case.has_axle_friction:
            raise Undetermined(quantities.NOT_APPLICABLE)

    @lazy
    def least_wrap(self) -> N:
        _ = self.mu  # raises if it is not given
        if not self._tensions_differ():
            return self.ar.number(0)
        if not self.case.pulley_known:
            return self.scene.wrap.degrees(self.ar)
        if is_zero(self.scene.mu):
            raise Undetermined(quantities.NO_WRAP)
        return self.alpha * 180 / self.ar.pi

    def _found(self, name: str, otherwise: str) -> N:
        """Return the input that follows from the measured acceleration, if it is this one."""
        if self.case.motion.finds != name:
            raise Undetermined(otherwise)
        return self.ar.number(getattr(self.scene, name))

    @property
    def pulley_mass(self) -> N:
        return self._found("M", quantities.NEEDS_A)

    @property
    def moment_of_inertia(self) -> N:
        _ = self.pulley_mass  # raises unless it follows from the motion
        R = self._given(self.scene.R, quantities.NEEDS_R)
        return physics.moment_of_inertia(self._given(self.case.rim_mass, quantities.NEEDS_M), R)

    @property
    def gravity(self) -> N:
        return self._found("g", quantities.NEEDS_A_BESIDE_M)

    @property
    def m1(self) -> N:
        return self._found("m1", quantities.NEEDS_A_AND_M.format("m1"))

    @property
    def m2(self) -> N:
        return self._found("m2", quantities.NEEDS_A_AND_M.format("m2"))

    @property
    def fall_time(self) -> N:
        return physics.fall_time(*self._fall(), self.ar.sqrt)

    @property
    def final_speed(self) -> N:
        return physics.final_speed(*self._fall(), self.ar.sqrt)

    def _fall(self) -> tuple[N, N]:
        """Return the height fallen (m), and the acceleration (m/s²)."""
        drop = self._given(self.case.motion.drop, quantities.NEEDS_DROP)
        if self.ar.is_zero(self.magnitude):
            raise Undetermined(quantities.AT_REST)
        return drop, self.magnitude
