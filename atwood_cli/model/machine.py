"""Every quantity by its name: the masses at which the string begins to slip, and what a motion tells.

`Machine` is the model of a `Case` in one arithmetic. It computes nothing that is not asked for, and a
quantity that the scene does not determine raises `Undetermined` with the reason.
"""

from __future__ import annotations

from ..arithmetic.lazy import lazy
from ..arithmetic.rational import N
from . import physics
from .case import is_zero
from .mechanics import (
    ALWAYS_SLIPS,
    AT_REST,
    AXLE_ENOUGH,
    AXLE_HOLDS,
    LOCKED_AXLE,
    NEEDS_A,
    NEEDS_A_AND_M,
    NEEDS_A_BESIDE_M,
    NEEDS_DROP,
    NEEDS_M,
    NEEDS_R,
    NO_CRITICAL_HEAVIER_MASS,
    NO_CRITICAL_MASS,
    NO_WRAP,
    NOT_APPLICABLE,
    ONE_SIDED,
    UNKNOWN_SHAPE,
    Mechanics,
    Undetermined,
)


class Machine(Mechanics[N]):
    """The model of a case in one arithmetic. Its properties are the quantities, by their names."""

    @lazy
    def axle_force(self) -> N:
        """Force on the axle (N): both tensions (20), and the pulley's weight."""
        if not self.case.ends_hang_down:
            raise Undetermined(ONE_SIDED)
        if self.case.locked:
            raise Undetermined(LOCKED_AXLE)
        if self.case.regime == "verge":
            mass = self.critical_pulley_mass
        else:
            mass = self._given(self.case.pulley_mass, NEEDS_M)
        return physics.axle_force(self.tension_1, self.tension_2, mass, self.g)

    @lazy
    def critical_pulley_mass(self) -> N:
        """Pulley mass above which the string slips (kg) (34)."""
        _ = self.mu  # raises if it is not given
        if not self.case.can_slip:
            raise Undetermined(AXLE_HOLDS if self.case.axle_holds else NO_CRITICAL_MASS)
        if self.case.always_slips:
            raise Undetermined(ALWAYS_SLIPS)
        transfer = self.transfer
        beta = self._given(self.case.beta, UNKNOWN_SHAPE)
        return physics.critical_pulley_mass(self.l, self.h, transfer, self.drive, beta, self.b)

    @lazy
    def critical_heavier_mass(self) -> N:
        """Heavier mass above which the string slips on this pulley (kg) (35)."""
        transfer = self.transfer
        if self.case.locked or self.case.slips_once_it_moves:
            return self.least_heavier_mass
        c = self._given(self.case.rim_mass, NEEDS_M)
        if not self.case.can_be_made_slip:
            raise Undetermined(NO_CRITICAL_HEAVIER_MASS)
        return physics.critical_heavier_mass(self.l, c, transfer, self.b)

    @lazy
    def critical_lighter_mass(self) -> N:
        """Lighter mass below which the string slips (kg); 0 where it holds under any."""
        k1, h = self.k1, self.h
        if self.case.stands_until_it_slips:
            return physics.lightest_held(h, self.capstan_ratio)
        c = self._given(self.case.rim_mass, NEEDS_M)
        if is_zero(self.case.rim_mass) and not self.case.rubs:
            return self.ar.number(0)
        return physics.critical_lighter_mass(h, c, k1, self.b)

    @lazy
    def least_heavier_mass(self) -> N:
        """What the heavier mass must exceed for any pulley to make the string slip (kg) (36)."""
        self._check_applicable()
        return physics.least_heavier_mass(self.l, self.transfer)

    @lazy
    def least_pulley_mass(self) -> N:
        """What the pulley's mass must exceed for any heavier mass to make the string slip (kg) (36)."""
        self._check_applicable()
        transfer = self.transfer
        if self.case.slips_once_it_moves:
            raise Undetermined(AXLE_ENOUGH)
        beta = self._given(self.case.beta, UNKNOWN_SHAPE)
        return physics.least_pulley_mass(transfer, beta, self.b)

    def _check_applicable(self) -> None:
        """Raise Undetermined where (36) has no meaning: where the critical pulley has no mass."""
        if is_zero(self.scene.mu) and not self.case.pulley_known and not self.case.rubs:
            raise Undetermined(NOT_APPLICABLE)

    @lazy
    def least_wrap(self) -> N:
        """Angle of wrap below which the string slips (°): (27), solved for the angle."""
        _ = self.mu  # raises if it is not given
        if self.case.tensions_equal:
            return self.ar.number(0)
        if not self.case.pulley_known:
            if self.case.regime == "verge":
                return self.scene.wrap.degrees(self.ar)
            raise Undetermined(NEEDS_M)
        if is_zero(self.scene.mu):
            raise Undetermined(NO_WRAP)
        return self.alpha * 180 / self.ar.pi

    def _check_found(self) -> None:
        """Raise Undetermined unless the motion tells of the pulley."""
        motion = self.case.motion
        if motion.finds != "M":
            raise Undetermined(NEEDS_A)

    @property
    def pulley_mass(self) -> N:
        """Pulley mass that gives the measured acceleration (kg)."""
        self._check_found()
        return self._given(self.case.pulley_mass, NEEDS_M)

    @property
    def moment_of_inertia(self) -> N:
        """Moment of inertia of the pulley that gives the measured acceleration (kg m²)."""
        self._check_found()
        R = self._given(self.scene.R, NEEDS_R)
        return physics.moment_of_inertia(self._given(self.case.rim_mass, NEEDS_M), R)

    @property
    def gravity(self) -> N:
        """Gravity that gives the measured acceleration (m/s²)."""
        if self.case.motion.finds != "g":
            raise Undetermined(NEEDS_A_BESIDE_M)
        return self.g

    @property
    def m1(self) -> N:
        """Mass m1 that gives the measured acceleration (kg)."""
        return self._found_mass("m1")

    @property
    def m2(self) -> N:
        """Mass m2 that gives the measured acceleration (kg)."""
        return self._found_mass("m2")

    def _found_mass(self, name: str) -> N:
        if self.case.motion.finds != name:
            raise Undetermined(NEEDS_A_AND_M.format(name))
        return self.ar.number(getattr(self.scene, name))

    @property
    def fall_time(self) -> N:
        """Time in which the heavier mass falls the height from rest (s)."""
        return physics.fall_time(*self._fall(), self.ar.sqrt)

    @property
    def final_speed(self) -> N:
        """Speed of the masses after that fall (m/s)."""
        return physics.final_speed(*self._fall(), self.ar.sqrt)

    def _fall(self) -> tuple[N, N]:
        """The height fallen, and the acceleration."""
        drop = self._given(self.case.motion.drop, NEEDS_DROP)
        if self.ar.is_zero(self.magnitude):
            raise Undetermined(AT_REST)
        return drop, self.magnitude
