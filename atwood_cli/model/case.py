"""What is decided about a scene before anything is computed, exactly: the heavier side, grip or slip."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any, Literal

from ..arithmetic.lazy import lazy
from ..arithmetic.rational import EXACT
from ..arithmetic.settling import is_positive
from . import physics
from .scene import UNMEASURED, Motion, Scene

if TYPE_CHECKING:
    from ..arithmetic.rational import Arithmetic, N, Quantity

ZERO, ONE = Fraction(0), Fraction(1)
Place = Literal["scene", "locked", "massless", "heaviest", "most_held", "lightest_held"]


def is_zero(value: object) -> bool:
    """Whether an input is exactly 0. Columns are not: rows with a zero are solved apart."""
    return hasattr(value, "numerator") and not value


class Case:
    """What is decided about a scene before anything is computed, exactly."""

    def __init__(self, scene: Scene, motion: Motion = UNMEASURED) -> None:
        self.scene, self.motion = scene, motion
        self._excesses: dict[tuple[Place, Arithmetic[Any]], Any] = {}

    @lazy
    def sign(self) -> int:
        """1 if m2 is the heavier mass, -1 if m1 is, else 0."""
        return (self.scene.m2 > self.scene.m1) - (self.scene.m2 < self.scene.m1)

    @lazy
    def light(self) -> Fraction:
        """The lighter mass (kg)."""
        return self.by_side(self.scene.m1, self.scene.m2)[0]

    @lazy
    def heavy(self) -> Fraction:
        """The heavier mass (kg)."""
        return self.by_side(self.scene.m1, self.scene.m2)[1]

    @property
    def free_end(self) -> bool:
        """Whether nothing hangs from one end, or where an uncertain motion finds a mass, less than that."""
        return hasattr(self.light, "numerator") and self.light <= 0

    @lazy
    def locked(self) -> bool:
        """Whether the pulley cannot turn: M = inf."""
        return isinstance(self.scene.M, float)

    @lazy
    def pulley_mass(self) -> Fraction | None:
        """The pulley's mass; none where it is locked, and 0 where nothing is said of the pulley."""
        M, scene = self.scene.M, self.scene
        if M is None and scene.mu is None and scene.I is None:
            return Fraction(0)
        return None if isinstance(M, float) else M

    @lazy
    def rim_mass(self) -> Fraction | None:
        """The pulley's inertia as a mass at the rim, c = βM; none where it is locked or not known."""
        scene, mass = self.scene, self.pulley_mass
        if scene.I is not None and scene.R is not None:
            return physics.rim_mass_of_inertia(scene.I, scene.R)
        if mass is None or scene.inertia is None:
            return mass
        return scene.inertia * mass

    @lazy
    def beta(self) -> Fraction | None:
        """The inertia factor; none where I is given and M is not."""
        if self.scene.I is None:
            return self.scene.inertia
        return self.rim_mass / self.pulley_mass if self.rim_mass and self.pulley_mass else None

    @lazy
    def axle_friction(self) -> Fraction:
        """The axle's friction as a force at the rim (N), f."""
        axle = self.scene.axle
        if axle is None:
            return ZERO
        force: Fraction = axle.force(self.scene.R)
        return force

    @property
    def rubs(self) -> bool:
        """Whether the axle has friction."""
        return not is_zero(self.axle_friction)

    @lazy
    def axle_mass(self) -> Fraction:
        """That friction as a mass, b = f/g."""
        return physics.axle_mass(self.axle_friction, self.scene.g) if self.rubs else ZERO

    @lazy
    def axle_holds(self) -> bool:
        """Whether the axle holds the difference of unequal masses, and so the pulley at rest."""
        return self.rubs and self.sign != 0 and not self.moves_axle("difference")

    @property
    def difference(self) -> Fraction:
        """The heavier mass less the lighter one (kg)."""
        return self.heavy - self.light

    def moves_axle(self, which: Literal["difference", "heavy"]) -> bool:
        """Whether the difference, or the heavier mass alone, is more than the axle holds."""
        mass: Fraction = getattr(self, which)
        return mass * self.scene.g > self.axle_friction

    @property
    def stands(self) -> bool:
        """Whether nothing that the string does turns the pulley."""
        return self.locked or self.axle_holds

    def by_side(self, of_m1: N, of_m2: N) -> tuple[N, N]:
        """What belongs to the lighter and the heavier mass from what belongs to m1 and m2, or back."""
        return (of_m1, of_m2) if self.sign >= 0 else (of_m2, of_m1)

    @property
    def pulley_known(self) -> bool:
        """Whether the pulley is known enough for the motion of a string that grips."""
        return self.stands or self.rim_mass is not None

    @property
    def turns_freely(self) -> bool:
        """Whether the pulley turns without friction: it has no mass, and its axle does not rub."""
        return is_zero(self.rim_mass) and not self.rubs

    @property
    def tensions_equal(self) -> bool:
        """Whether a string that grips needs no friction."""
        return self.sign == 0 or self.turns_freely

    @lazy
    def regime(self) -> Literal["no-slip", "verge", "slip"]:
        """What the string does; it is assumed to grip where nothing is said of friction."""
        if self.slide_measured:
            return "slip"
        if self.scene.mu is None or self.tensions_equal:
            return "no-slip"
        if not self.pulley_known:
            if not self.can_slip:
                return "no-slip"
            return "slip" if self.always_slips else "verge"
        return "slip" if self.slips else "no-slip"

    @lazy
    def slips(self) -> bool:
        """Whether the string slips on a pulley that is known and friction that is given."""
        return not self.tensions_equal and self.slips_at("locked" if self.stands else "scene")

    @property
    def limiting_mu(self) -> Fraction:
        """The coefficient that friction is at on the verge (static) and in slip (kinetic), if it is given."""
        mu, mu_k = self.scene.mu, self.scene.mu_k
        limit = mu if mu_k is None or self.regime == "verge" else mu_k
        return Fraction(0) if limit is None else limit

    @property
    def mu_assumed(self) -> bool:
        """Whether the friction force is the one at the least coefficient that holds, as none is given."""
        return self.regime == "no-slip" and self.scene.mu is None and not self.tensions_equal

    @property
    def at_static_limit(self) -> bool:
        """Whether the friction that acts, where it is at its limit, is static friction's."""
        return not self.slide_measured and self.limiting_mu is self.scene.mu

    @property
    def slide_measured(self) -> bool:
        """Whether kinetic friction follows from the acceleration of a string that slides."""
        return self.motion.finds == "mu_k"

    @lazy
    def measured_acceleration(self) -> Fraction:
        """The acceleration that was measured (m/s²), positive when the heavier mass descends."""
        return self.motion.acceleration(self.sign)

    @property
    def frictionless(self) -> bool:
        """Whether the string moves, or rests, without friction."""
        if self.slide_measured:
            return not self.slide_excess(EXACT)
        return self.tensions_equal or (self.regime != "no-slip" and is_zero(self.limiting_mu))

    @lazy
    def can_slip(self) -> bool:
        """Whether the string slips on a pulley that is heavy enough: first condition of (36)."""
        # Whatever slips on a pulley slips on a heavier one. If that is not known, the pulley is not read.
        return vars(self).get("slips", False) or self.slips_at("locked")

    @lazy
    def always_slips(self) -> bool:
        """Whether the string slips on any pulley, however light, for the friction of its axle."""
        return self.rubs and self.slips_at("locked" if self.axle_holds else "massless")

    @lazy
    def slips_once_it_moves(self) -> bool:
        """Whether the string slips under the greatest difference that the axle holds, on any pulley."""
        return self.rubs and self.slips_at("most_held")

    @property
    def stands_until_it_slips(self) -> bool:
        """Whether the pulley stands under the lightest mass that the string holds against the heavier."""
        if self.locked or not self.rubs:
            return self.locked
        return not self.moves_axle("heavy") or self.slips_at("lightest_held")

    @lazy
    def can_be_made_slip(self) -> bool:
        """Whether the string slips under some heavier mass: second condition of (36)."""
        return not self.turns_freely and (self.slips_once_it_moves or self.slips_at("heaviest"))

    @lazy
    def holds_again(self) -> bool:
        """Whether it slips under such a mass, but holds under much heavier ones: the axle outweighs c."""
        return self.rim_mass is not None and self.slips_once_it_moves and not self.slips_at("heaviest")

    @lazy
    def rim_stands(self) -> bool:
        """Whether the pulley stands still while the string slips over it."""
        if self.stands:
            return True
        if not self.rubs:
            return False
        # On a pulley without mass the axle takes all that friction makes up.
        if self.slide_measured:
            return not self.slide_excess(EXACT) > self.excess("massless", EXACT)
        return self.slides_at("massless")

    @lazy
    def long_wrap(self) -> bool:
        """Whether the wrap is beyond half a turn."""
        return self.scene.wrap.is_beyond_half_turn

    @lazy
    def ends_hang_down(self) -> bool:
        """Whether both ends of the string leave the pulley downwards."""
        return self.scene.wrap.ends_hang_down

    # Where the string slips

    def excess(self, place: Place, ar: Arithmetic[N]) -> N:
        """T_h/T_l - 1 of a string that grips, kept: decisions and quantities ask for it.

        The place is the scene, or what differs from it in the pulley ("locked", "massless"), in the heavier
        mass (the "heaviest", the "most_held" by the axle) or in the lighter one (the "lightest_held").
        """
        if (place, ar) not in self._excesses:
            self._excesses[place, ar] = self._excess(place, ar)
        excess: N = self._excesses[place, ar]
        return excess

    def _excess(self, place: Place, ar: Arithmetic[N]) -> N:
        l, h, b = self.light, self.heavy, self.axle_mass
        # A limit does not read the pulley's mass: so a sweep of it computes the limit once.
        c = self.rim_mass if place in ("scene", "heaviest") else ZERO
        if place == "heaviest":
            assert c is not None
            return physics.heaviest_excess(*map(ar.number, (l, c, b)))
        if c is None or place == "locked" or (place == "scene" and self.stands):
            return physics.excess_ratio(*map(ar.number, (l, h, ONE, b, ZERO)))
        if place == "lightest_held":
            l = h - b
        elif place == "most_held":
            h = l + b
        return physics.excess_ratio(*map(ar.number, (l, h, c, b, ONE)))

    def slips_at(self, place: Place) -> bool:
        """Whether static friction holds no string there."""
        return self.exceeds(lambda ar: self.excess(place, ar), self.scene.mu)

    def slides_at(self, place: Place) -> bool:
        """The same of the friction that acts, where it is at its limit: kinetic in slip."""
        return self.exceeds(lambda ar: self.excess(place, ar), self.limiting_mu)

    def exceeds(self, excess: Quantity, mu: Fraction | None) -> bool:
        """Whether 1 + excess > e^{μφ}; by logarithms, so that a huge e^{μφ} is never formed."""
        if not mu:
            return excess(EXACT) > 0

        def margin(ar: Arithmetic[N]) -> N:
            return ar.log1p(excess(ar)) - ar.number(mu) * self.scene.wrap.radians(ar)

        return is_positive(margin)

    def slide_excess(self, ar: Arithmetic[N]) -> N:
        """T_h/T_l - 1 of a string that slides with the measured acceleration."""
        a = self.measured_acceleration
        return physics.slide_excess(*map(ar.number, (self.light, self.heavy, a, self.scene.g)))
