"""The tension along the arc of contact, in any arithmetic.

The arc is seen from the lighter mass: the angle starts where its string meets the pulley, and the tension
grows from T_l to T_h = T_l e^{μα}. Friction at its limit needs the arc α for that. If the arc of contact φ is
longer, the string is stuck over the rest, δ = φ - α, which begins after a *lead* s of limiting arc. The
profiles differ in s:

- exponential: α = φ, nothing is stuck. On the verge, in slip, and with the least μ that holds.
- creep: s = 0. A slightly elastic string creeps over one arc, on the side where it leaves the pulley
  (O. Reynolds, 1875; F. Grashof, 1883), the heavier mass's. Of all profiles in which friction acts one way,
  this has the greatest net friction.
- least: the s with the least net friction, the root of `physics.least_friction_slope`.
"""

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Generic, Literal, NamedTuple

from ..numbers.rational import N
from . import physics

if TYPE_CHECKING:
    from ..numbers.rational import Arithmetic

Profile = Literal["exponential", "creep", "least"]


class Knot(NamedTuple, Generic[N]):
    """A point of the arc: its angle (rad) with cosine and sine, and the tension there (N)."""

    angle: N
    cos: N
    sin: N
    tension: N


class Arc(NamedTuple, Generic[N]):
    """A piece of the arc over which T grows as e^{μθ}; ``mu`` is 0 if the string is stuck over it."""

    mu: N
    start: Knot[N]
    end: Knot[N]


def arcs(ar: "Arithmetic[N]", pieces: Sequence[tuple[N, N]], light: N, end: Knot[N]) -> list[Arc[N]]:
    """Return pieces, each of a μ and a length (rad), from the light end with its tension (N) to ``end``."""
    zero = ar.number(0)
    knots = [Knot(zero, ar.number(1), zero, light)]
    for mu, length in pieces[:-1]:
        angle = knots[-1].angle + length
        growth = ar.expm1(mu * length) + 1
        knots.append(Knot(angle, *ar.cos_sin(angle), knots[-1].tension * growth))
    ends = pairwise([*knots, end])
    return [Arc(mu, *both) for (mu, _), both in zip(pieces, ends, strict=True)]


def least_lead(ar: "Arithmetic[N]", mu: N, limiting: N, stuck: N, light: N, end: Knot[N]) -> N:
    """Return the lead s (rad) of the profile with the least net friction; needs φ <= π."""
    _, half_sine = ar.cos_sin(stuck / 2)
    chord = 2 * light * half_sine
    dx, dy = end.tension * end.cos - light, end.tension * end.sin

    def slope(s: N) -> N:
        cos, sin = ar.cos_sin(s + stuck / 2)
        return physics.least_friction_slope(mu, chord, ar.expm1(mu * s) + 1, cos, sin, dx, dy)

    return ar.root(slope, limiting)


def force(pieces: Sequence[Arc[N]], law: Callable[[N, N, N], tuple[N, N]]) -> tuple[N, N]:
    """Return the net friction or normal force on the pulley (N), (x, y), by its law in `physics`."""
    forces = []
    for arc in pieces:
        start, end = arc.start, arc.end
        dx = end.tension * end.cos - start.tension * start.cos
        dy = end.tension * end.sin - start.tension * start.sin
        forces.append(law(arc.mu, dx, dy))
    (x, *xs), (y, *ys) = zip(*forces, strict=True)
    return sum(xs, start=x), sum(ys, start=y)


def torque_per_radius(ar: "Arithmetic[N]", pieces: Sequence[Arc[N]]) -> N:
    """Return ∫ dT/dθ dθ (N), the torque of friction on the pulley over its radius, arc by arc; (23)."""
    terms = [arc.start.tension * ar.expm1(arc.mu * (arc.end.angle - arc.start.angle)) for arc in pieces]
    return sum(terms, start=ar.number(0))


def tension(ar: "Arithmetic[N]", arc: Arc[N], angle: N) -> N:
    """Return T (N) at an angle within the arc; also nR, the normal force per radian (13)."""
    return arc.start.tension * (ar.expm1(arc.mu * (angle - arc.start.angle)) + 1)
