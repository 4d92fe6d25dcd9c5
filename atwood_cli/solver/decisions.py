"""Decide exactly which side is heavier and whether the string slips.

A string slips if the tension ratio r = T_h/T_l that it would have if it gripped exceeds e^{μφ}. The regime is
the result of the first line below that answers. The second table has the scenes whose r is compared, each a
`LimitingCase`: `slips_at` compares with static friction, `slides_at` with that of the regime.

    question                                             decided by                          result
    does kinetic friction follow from a measured a?      motion.finds == "mu_k"              slip
    is mu not given?                                                                         no-slip, assumed
    are both tensions equal without friction?            m1 = m2, or c = 0 and f = 0         no-slip
    is the pulley known, or at rest?                     rim_mass; locked; h - l <= b
      does the string slip on it?                        (33) "as_given", "locked" at rest    slip, or no-slip
    can it slip on no pulley, however heavy?             (36) at "locked"                    no-slip
    does it slip on every pulley, however light?         (33) at "massless"                  slip
    else it slips on a heavy enough pulley               (34) gives its mass                 verge

    as_given, locked, massless as it is; D = 0; c = 0    see above
    massless                   in slip                   is the rim at rest under the string that slips?
    heaviest                   h = ∞                     does it slip under some heavier mass?
    heaviest_at_rest           c = 0, h = l + b          does it slip as soon as the axle turns?
    lightest_at_rest           c = 0, l = h - b          is the pulley at rest at the critical lighter mass?

With an axle that holds the difference, h - l <= b, the pulley is at rest like a locked one. If one mass is 0,
mu cannot be given, and the second line answers.
"""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any, Literal

from ..numbers.lazy import lazy
from ..numbers.rational import EXACT
from ..numbers.settling import is_positive
from . import physics
from .quantities import NEEDS_MASSES, Undetermined
from .scene import DRIVE, Scene

if TYPE_CHECKING:
    from ..numbers.rational import Arithmetic, N, Quantity

ZERO, ONE = Fraction(0), Fraction(1)
REGIME_ASSUMED = "assumed, as mu is not given"
GIVEN_BACK = ("mu_verge", "safety_factor", "least_wrap")
"""What on the verge is mu, 1 and the wrap."""
CRITICAL_ASSUMED = "on the critical pulley, as M is not given; M = inf is a locked pulley"
MASSLESS_ASSUMED = "0, as M is not given and a massless pulley needs no friction; M = inf is a locked pulley"
LimitingCase = Literal["as_given", "locked", "massless", "heaviest", "heaviest_at_rest", "lightest_at_rest"]


def is_number(value: object) -> bool:
    """Decide whether an input is a finite number: not given or infinite, or a column of rows, it is none."""
    return hasattr(value, "numerator")


def is_zero(value: object) -> bool:
    """Decide whether an input is exactly 0. A column is not: rows with a zero are a group of their own."""
    return is_number(value) and not value


class Decisions:
    """The decisions about a scene, and the inputs seen from the lighter and the heavier mass.

    Each is made when it is asked for; the ``lazy`` ones once.
    """

    def __init__(self, scene: Scene) -> None:
        self.scene, self.motion = scene, scene.motion
        self.lacking = scene.lacking
        self.has_one_mass = len(self.lacking) == 1
        self.is_driven = scene.motion.finds == DRIVE
        """Whether a motor or a brake moves the pulley as was measured."""
        of_any_pulley = self.has_one_mass and scene.M is scene.I is None
        self.slips_by_tensions = self.is_driven or of_any_pulley or isinstance(scene.M, float)
        """Whether the ratio of two weights is that of the tensions: limits are those of a pulley at rest."""
        self._ratios: dict[tuple[LimitingCase, Arithmetic[Any]], Any] = {}

    @lazy
    def heavier_side(self) -> int:
        """1 if m2 is the heavier mass, -1 if m1 is, else 0. Equal masses that slow down have one, too.

        On a driven pulley the side with the greater tension counts as the heavier.
        """
        if self.motion.finds == "axle":
            return self.motion.direction
        if self.lacking:
            raise Undetermined(NEEDS_MASSES)
        if self.is_driven:
            a, g = self.motion.acceleration(1), self.scene.g
            difference = physics.difference_of_moving_masses(self.scene.m1, self.scene.m2, a, g)
            return (difference > 0) - (difference < 0)
        return (self.scene.m2 > self.scene.m1) - (self.scene.m2 < self.scene.m1)

    @lazy
    def light(self) -> Fraction:
        """The lighter mass (kg), or the one that is given: limits of the other one take it for either."""
        if self.has_one_mass:
            return self.scene.m2 if self.scene.m1 is None else self.scene.m1
        return self.scene.m1 if self.heavier_side >= 0 else self.scene.m2

    @lazy
    def heavy(self) -> Fraction:
        """The heavier mass (kg), or the one that is given."""
        if self.has_one_mass:
            return self.light
        return self.scene.m2 if self.heavier_side >= 0 else self.scene.m1

    @lazy
    def one_mass_is_0(self) -> bool:
        """Whether one mass is 0; or below, as a mass that is found with an uncertain acceleration may be."""
        return not self.lacking and is_number(self.light) and self.light <= 0

    @lazy
    def locked(self) -> bool:
        """Whether the pulley cannot turn: M = inf."""
        return isinstance(self.scene.M, float)

    @lazy
    def pulley_mass(self) -> Fraction | None:
        """The pulley's mass (kg): None if it is locked or not known, 0 if nothing tells that it has one."""
        M, scene = self.scene.M, self.scene
        if M is None and scene.mu is None and scene.I is None:
            return Fraction(0)
        return None if isinstance(M, float) else M

    @lazy
    def rim_mass(self) -> Fraction | None:
        """The pulley's inertia as a mass at the rim, c (kg); None if it is locked or not known."""
        scene, mass = self.scene, self.pulley_mass
        if scene.I is not None and scene.R is not None:
            return physics.inertia_at_rim(scene.I, scene.R)
        if mass is None or scene.inertia is None:
            return mass
        return Fraction(0) if is_zero(mass) else scene.inertia * mass

    @lazy
    def beta(self) -> Fraction | None:
        """The inertia factor; None if I is given and M is not."""
        if self.scene.I is None:
            return self.scene.inertia
        return self.rim_mass / self.pulley_mass if self.rim_mass and self.pulley_mass else None

    @lazy
    def axle_friction(self) -> Fraction:
        """The axle's friction as a force at the rim, f (N)."""
        return ZERO if self.scene.axle is None else self.scene.axle

    @lazy
    def has_axle_friction(self) -> bool:
        """Whether the axle has friction."""
        return not is_zero(self.axle_friction)

    @lazy
    def axle_mass(self) -> Fraction:
        """The axle's friction as a mass, b = f/g (kg)."""
        return physics.axle_mass(self.axle_friction, self.scene.g) if self.has_axle_friction else ZERO

    @lazy
    def axle_holds(self) -> bool:
        """Whether the axle's friction holds unequal masses at rest, h - l <= b; not masses that slow down."""
        if self.motion.finds in ("axle", DRIVE) or self.lacking:
            return False
        return self.has_axle_friction and self.heavier_side != 0 and not self.moves_axle("difference")

    @lazy
    def difference(self) -> Fraction:
        """The heavier mass less the lighter one (kg)."""
        return self.heavy - self.light

    def moves_axle(self, name: Literal["difference", "heavy"]) -> bool:
        """Decide whether the difference, or the heavier mass alone, exceeds what the axle holds, b."""
        mass: Fraction = getattr(self, name)
        return mass * self.scene.g > self.axle_friction

    @lazy
    def pulley_at_rest(self) -> bool:
        """Whether the pulley is at rest, as it is locked or its axle holds it."""
        return self.locked or self.axle_holds

    @lazy
    def pulley_known(self) -> bool:
        """Whether the motion of a string that grips is known: measured, or the pulley is known or rests."""
        return self.is_driven or self.pulley_at_rest or self.rim_mass is not None

    @lazy
    def pulley_is_ideal(self) -> bool:
        """Whether the pulley has neither mass nor friction in its axle."""
        return is_zero(self.rim_mass) and not self.has_axle_friction and not self.is_driven

    @lazy
    def tensions_equal(self) -> bool:
        """Whether a string that grips needs no friction."""
        return self.heavier_side == 0 or self.pulley_is_ideal

    @lazy
    def regime(self) -> Literal["no-slip", "verge", "slip"]:
        """What the string does, by the table at the head of the module."""
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
        at: LimitingCase = "locked" if self.pulley_at_rest else "as_given"
        return not self.tensions_equal and self.slips_at(at)

    @lazy
    def limiting_mu(self) -> Fraction:
        """The coefficient of friction at its limit: static on the verge, kinetic in slip; 0 if not given."""
        limit = self.scene.mu if self.limit_is_static else self.scene.mu_k
        return ZERO if limit is None else limit

    @lazy
    def assumptions(self) -> dict[str, str]:
        """The quantities that depend on what is only assumed, and the assumption."""
        if self.scene.mu is not None:
            on_verge = not self.lacking and self.regime == "verge" and self.scene.mu
            return dict.fromkeys(GIVEN_BACK, CRITICAL_ASSUMED) if on_verge else {}
        is_massless = self.scene.M is None and self.pulley_mass == 0
        moves = self.heavier_side != 0 and self.tensions_equal and not self.one_mass_is_0
        regime = {"regime": REGIME_ASSUMED} if self.mu_assumed else {}
        return regime | ({"mu_verge": MASSLESS_ASSUMED} if is_massless and moves else {})

    @lazy
    def mu_assumed(self) -> bool:
        """Whether friction is that with the least coefficient that holds the string, as mu is not given."""
        if self.scene.mu is not None or self.one_mass_is_0 or self.tensions_equal:
            return False
        return self.regime == "no-slip"

    @lazy
    def limit_is_static(self) -> bool:
        """Whether friction at its limit is static (mu) or kinetic (mu_k)."""
        return not self.slide_measured and (self.scene.mu_k is None or self.regime == "verge")

    @lazy
    def slide_measured(self) -> bool:
        """Whether kinetic friction follows from a measured acceleration."""
        return self.motion.finds == "mu_k"

    @lazy
    def slides_by_mu_k(self) -> bool:
        """Whether the string slides with the mu_k that is given."""
        return self.regime == "slip" and self.scene.mu_k is not None and not self.slide_measured

    @lazy
    def measured_acceleration(self) -> Fraction:
        """The measured acceleration (m/s²), positive when the heavier mass descends; of equal ones, m2."""
        return self.motion.acceleration(-1 if self.heavier_side < 0 else 1)

    @lazy
    def fall(self) -> dict[str, Fraction]:
        """What is given of height (m), time (s) and speed (m/s) of a fall, without signs."""
        given = {name: getattr(self.motion, name) for name in self.motion.fall}
        return {name: -x if is_number(x) and x < 0 else x for name, x in given.items()}

    @lazy
    def slows_down(self) -> bool:
        """Whether the heavier mass descends ever slower, as the measured acceleration says."""
        return self.motion.finds == "axle" and self.measured_acceleration < 0

    @lazy
    def at_limit(self) -> bool:
        """Whether friction at its limit decides the tensions; on a driven pulley the motion does."""
        return self.regime != "no-slip" and not self.is_driven

    @lazy
    def frictionless(self) -> bool:
        """Whether the string moves, or rests, without friction."""
        if self.slide_measured:
            return not self.slide_ratio_minus_1(EXACT)
        return self.tensions_equal or (self.at_limit and is_zero(self.limiting_mu))

    @lazy
    def can_slip(self) -> bool:
        """Whether the string slips on a pulley that is heavy enough: first condition of (36)."""
        # A string that slips on this pulley slips on a heavier one.
        return (self.pulley_known and self.slips) or self.slips_at("locked")

    @lazy
    def always_slips(self) -> bool:
        """Whether axle friction makes the string slip on any pulley, however light."""
        return self.has_axle_friction and self.slips_at("locked" if self.axle_holds else "massless")

    @lazy
    def slips_once_it_moves(self) -> bool:
        """Whether the string slips under the greatest difference that the axle holds."""
        return self.has_axle_friction and self.slips_at("heaviest_at_rest")

    @lazy
    def pulley_at_rest_until_it_slips(self) -> bool:
        """Whether the pulley rests, or is driven, when the lighter mass is the least that holds."""
        if self.slips_by_tensions or not self.has_axle_friction:
            return self.slips_by_tensions
        return not self.moves_axle("heavy") or self.slips_at("lightest_at_rest")

    @lazy
    def slips_at_rest(self) -> bool:
        """Whether the critical heavier mass makes the string slip on a pulley that is at rest, or driven."""
        return self.slips_by_tensions or self.slips_once_it_moves

    @lazy
    def rim_at_rest(self) -> bool:
        """Whether the pulley is at rest while the string slips over it."""
        if self.pulley_at_rest:
            return True
        if not self.has_axle_friction:
            return False
        # T_h - T_l then does not exceed f, as on a massless pulley that is about to turn.
        if self.slide_measured:
            return not self.slide_ratio_minus_1(EXACT) > self.ratio_minus_1("massless", EXACT)
        return self.slides_at("massless")

    @lazy
    def long_wrap(self) -> bool:
        """Whether the wrap is beyond half a turn."""
        wrap = self.scene.wrap
        if wrap.unit == "°":
            return bool(wrap.number > 180)
        return is_positive(lambda ar: wrap.radians(ar) - ar.pi)

    @lazy
    def ends_hang_down(self) -> bool:
        """Whether both ends of the string hang down: half a turn of wrap, plus whole turns."""
        wrap = self.scene.wrap
        return bool(wrap.unit == "°" and (wrap.number - 180) % 360 == 0)

    # The tension ratio of a string that grips, against e^{μφ}

    def ratio_minus_1(self, at: LimitingCase, ar: Arithmetic[N]) -> N:
        """Return T_h/T_l - 1 of a string that grips, in a case of the table at the head.

        It is kept, as decisions and quantities ask for it.
        """
        if (at, ar) not in self._ratios:
            self._ratios[at, ar] = self._ratio_minus_1(at, ar)
        ratio: N = self._ratios[at, ar]
        return ratio

    def _ratio_minus_1(self, at: LimitingCase, ar: Arithmetic[N]) -> N:
        if self.is_driven:
            return self.slide_ratio_minus_1(ar)
        l, h, b = self.light, self.heavy, self.axle_mass
        # A limit does not read the pulley's mass: in a sweep of it the caches of `interval` have the limit.
        c = self.rim_mass if at in ("as_given", "heaviest") else ZERO
        if at == "heaviest":
            assert c is not None
            return physics.heaviest_ratio_minus_1(*map(ar.number, (l, c, b)))
        if c is None or at == "locked" or (at == "as_given" and self.pulley_at_rest):
            return physics.gripping_ratio_minus_1(*map(ar.number, (l, h, ONE, b, ZERO)))
        if at == "lightest_at_rest":
            l = h - b
        elif at == "heaviest_at_rest":
            h = l + b
        return physics.gripping_ratio_minus_1(*map(ar.number, (l, h, c, b, ONE)))

    def slips_at(self, at: LimitingCase) -> bool:
        """Decide whether the string slips in a limiting case, as static friction cannot hold it."""
        return self.exceeds(lambda ar: self.ratio_minus_1(at, ar), self.scene.mu)

    def slides_at(self, at: LimitingCase) -> bool:
        """Decide whether the string goes on sliding there, with the friction that acts in its regime."""
        return self.exceeds(lambda ar: self.ratio_minus_1(at, ar), self.limiting_mu)

    def exceeds(self, ratio_minus_1: Quantity, mu: Fraction | None) -> bool:
        """Decide whether 1 + ratio_minus_1 > e^{μφ}; by logarithms, so that a huge e^{μφ} is never formed.

        For μ > 0, e^{μφ} is transcendental by Gelfond's theorem if φ is a rational multiple of π, and by
        Lindemann's if φ is rational. A rational ratio never equals it, so the enclosure's sign decides.
        """
        if not mu:
            return ratio_minus_1(EXACT) > 0
        return is_positive(lambda ar: self.margin(ratio_minus_1(ar), mu, ar))

    def margin(self, ratio_minus_1: N, mu: Fraction, ar: Arithmetic[N]) -> N:
        """Return by how much ln(1 + ratio_minus_1) exceeds μφ."""
        return ar.log1p(ratio_minus_1) - ar.number(mu) * self.scene.wrap.radians(ar)

    def slide_ratio_minus_1(self, ar: Arithmetic[N]) -> N:
        """Return T_h/T_l - 1 of masses with the measured acceleration."""
        a = self.measured_acceleration
        return physics.slide_ratio_minus_1(*map(ar.number, (self.light, self.heavy, a, self.scene.g)))
