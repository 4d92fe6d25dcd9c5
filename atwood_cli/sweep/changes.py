"""Find the values along a range at which the regime changes, exactly.

The regime is decided at a few values, between which each condition that it depends on changes at most once.
If it differs at two of them, it is decided between them until both sides of the change round alike.

**Why no change is missed.** With friction given, the string slips where ln r > μφ. By (1), and (3) with the
friction of the axle, the tension ratio of a string that grips is

    r = (h/l) q,  q = (2l + c + b)/(2h + c - b) if the axle turns, h - l > b, and q = 1 if it holds.

Both agree at h = l + b. On a locked pulley q = 1. If c is not known, the regime depends on the ratios for
c = 0 and for c = ∞. Along one parameter ln r - μφ is monotone, but for a swept mass:

- It falls, or stays, with μ and with φ (the wrap), on which r does not depend.
- It rises, or stays, with c: dq/dc has the sign of h - l - b. So it does along M, β (the inertia) and I.
- It rises, or stays, with b = f/g: q rises to 1. So it rises along f (the axle) and falls along g.
- It falls, or stays, along R: so do c = I/R², if I is given, and b, if the axle's friction is a torque.
- It does not depend on μ_k.
- Along a weight it goes as along its mass. Along g all masses that are given as weights would change, and
  nothing is proven: `ranges` refuses that.
- It falls with l: so do h/l and, if the axle turns, (2l + c + b)/l = 2 + (c + b)/l.
- It rises with h up to l + b, as h/l does. Beyond, r goes with h/(2h + c - b): it rises for c >= b and falls
  for c < b.

So it turns only where a swept mass equals the other mass m, and so becomes the heavier, and where it equals
m + b. These are asked. Between them the sign of m2 - m1, and whether h - l <= b, change at most once, too.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from decimal import Decimal
from fractions import Fraction
from itertools import pairwise
from math import inf
from operator import attrgetter
from typing import Any, NamedTuple

from ..numbers.digits import SHOWN_DIGITS, to_digits
from ..reading.units import MAX_MAGNITUDE
from ..solver.decisions import Decisions
from ..solver.scene import MASSES, Scene
from .ranges import LOCKED, Range

NEIGHBOUR_SHARE = Fraction(1, 10**60)
"""A value's neighbour, at which it is decided whether the regime changes there, is off by this part of it."""
LEAST_INPUT = Fraction(1, 10**MAX_MAGNITUDE)
"""No input but 0 is smaller."""


class Change(NamedTuple):
    """A change along a range, in its unit: ``at`` is the value itself, or the decimal nearest to it.

    ``holds_at`` and ``differs_at`` are the nearest values before and after the change.
    """

    at: Fraction | Decimal
    before: Any
    after: Any
    holds_at: Fraction
    differs_at: Fraction


def changes(
    scene: Scene,
    along: Range,
    digits: int | None = None,
    known: Mapping[Fraction, Any] = {},
    what: Callable[[Decisions], Any] = attrgetter("regime"),
) -> Iterator[Change]:
    """Yield the changes of the regime, or of another decision, along a range, from its least value on.

    ``known`` has the regime at some values, which the changes must not contradict.
    """

    def state(value: Fraction) -> Any:
        return what(Decisions(along.at(value, scene)))

    start, stop = along.ends
    asked = [start, *(value for value in _turns(scene, along) if start < value < stop), stop]
    states = {value: state(value) for value in asked if value not in known} | dict(known)
    for holds_at, other in pairwise(sorted(states)):
        while states[holds_at] != states[other]:
            before = states[holds_at]
            place, holds_at, differs_at = _between(state, before, holds_at, other, digits or SHOWN_DIGITS)
            states.setdefault(differs_at, state(differs_at))
            yield Change(place, before, states[differs_at], holds_at, differs_at)
            holds_at = differs_at


def say_regimes(along: Range, in_order: Sequence[Change], scene: Scene) -> str:
    """Say each regime along a range, and up to which value it holds."""
    parts = []
    for before, change in zip([None, *in_order], in_order, strict=False):
        place = along.in_units(change.at)
        begins = before.at if before else along.ends[0]
        where = "at" if change.at == begins else "up to"
        parts.append(f"{change.before} {where} {place if before else f'{along.label} = {place}'}")
    first_regime = Decisions(along.at(along.ends[0], scene)).regime
    last = in_order[-1].after if in_order else first_regime
    parts.append(f"{last} beyond" if in_order else last)
    locks = along.is_list and LOCKED in along.points
    if locks and (locked := Decisions(scene._replace(M=inf)).regime) != last:
        parts.append(f"{locked} at {along.in_words(LOCKED)}")
    return ", ".join(parts)


def _turns(scene: Scene, along: Range) -> Iterator[Fraction]:
    """Yield the values of an input at which the tension ratio turns from rising to falling, or back."""
    if along.name in MASSES:
        other = scene.m1 if along.name == "m2" else scene.m2
        for mass in (other, other + Decisions(scene).axle_mass):
            yield scene.in_terms_of(along.name, mass) / along.unit.size


def _between(
    state: Callable[[Fraction], Any], before: Any, holds_at: Fraction, differs_at: Fraction, digits: int
) -> tuple[Fraction | Decimal, Fraction, Fraction]:
    """Return a change between two values, and the nearest values on both sides of it.

    The state is ``before`` at ``holds_at``, and another one at ``differs_at``.
    """
    gap = (differs_at - holds_at) / 2
    above = holds_at + min(gap, holds_at * NEIGHBOUR_SHARE or LEAST_INPUT)
    below = differs_at - min(gap, differs_at * NEIGHBOUR_SHARE)
    if state(above) != before:
        return holds_at, holds_at, above
    if state(below) == before:
        return differs_at, below, differs_at
    start, stop = holds_at, differs_at
    while True:
        place = to_digits(digits)(differs_at)
        is_settled = (
            to_digits(digits)(holds_at) == place or differs_at - holds_at < differs_at * NEIGHBOUR_SHARE
        )
        if is_settled and not start < place < stop:  # at the ends it is known that the state holds on
            digits += 1
            continue
        value = Fraction(place) if is_settled else (holds_at + differs_at) / 2
        holds_at, differs_at = (value, differs_at) if state(value) == before else (holds_at, value)
        if is_settled:
            return place, holds_at, differs_at
