"""Where along a range the regime changes: the exact place, not the two points beside it.

The regime is asked for at few values, between which each condition that it depends on changes at most once.
Where it differs between two of them, the decision of `Case`, which is exact, is asked at the middle until
what is left rounds to one number.

**Why no change is missed.** With friction given, the string slips where ln r > μφ. By (1), and (3) with the
friction of the axle, the tension ratio of a string that grips is

    r = (h/l) q,  q = (2l + c + b)/(2h + c - b) where the axle lets go, h - l > b, and q = 1 where it holds.

Both agree at h = l + b. On a locked pulley q = 1. If c is not known, the regime depends on the ratios for
c = 0 and for c = ∞. Along one parameter ln r - μφ is monotone, but for a swept mass:

- It falls, or stays, with μ and with φ (the wrap), on which r does not depend.
- It rises, or stays, with c: dq/dc has the sign of h - l - b. So it does along M, β (the inertia) and I.
- It rises, or stays, with b = f/g: q rises to 1. So it rises along f (the axle) and falls along g.
- It falls, or stays, along R: so do c = I/R², where I is given, and b, where the axle's friction is a torque.
- It does not depend on μ_k.
- It falls with l: so do h/l and, where the axle lets go, (2l + c + b)/l = 2 + (c + b)/l.
- It rises with h up to l + b, as h/l does. Beyond, r goes with h/(2h + c - b): it rises for c >= b and falls
  for c < b.

So it turns only where a swept mass equals the other mass m, as it becomes the heavier one there, and where
it equals m + b. These are asked. Between them the sign of m2 - m1, and whether h - l <= b, change at most
once, too. A condition that changes at most once, and is the same at both ends, is the same between them.
"""

from collections.abc import Callable, Iterator, Mapping
from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal
from fractions import Fraction
from itertools import pairwise
from operator import attrgetter
from typing import Any, NamedTuple

from ..arithmetic.rounding import tidy, to_digits
from ..model.case import Case
from ..model.motion import with_number
from ..model.scene import MASSES, UNMEASURED, Scene
from ..model.units import MAX_MAGNITUDE
from .answers import SHOWN_DIGITS
from .sweep import Point, Range, about_power

CLOSER = 50
"""Digits, beyond those shown, to which both sides of a change agree where it is just at a number shown."""
SMALLEST = Fraction(1, 10**MAX_MAGNITUDE)


class Change(NamedTuple):
    """Where something changes along a range, rounded towards what was before; the last value and the next."""

    at: Point
    before: Any
    after: Any
    last: Fraction
    first: Fraction


def with_value(scene: Scene, name: str, value: Fraction) -> Scene:
    """The scene with another value of a parameter, in the unit that it has there."""
    return with_number(scene, UNMEASURED, name, value)[0]


def changes(
    scene: Scene,
    along: Range,
    digits: int | None = None,
    known: Mapping[Fraction, str] = {},
    what: Callable[[Case], Any] = attrgetter("regime"),
) -> Iterator[Change]:
    """The changes of regime along a range, in its direction, or of anything else about its cases.

    ``known`` is what it is at some values.
    """

    def there(value: Fraction) -> Any:
        return what(Case(with_value(scene, along.name, value)))

    start, stop = along.ends
    turns = (value for value in _turns(scene, along.name) if min(start, stop) < value < max(start, stop))
    seen = {value: there(value) for value in (start, *turns, stop) if value not in known} | dict(known)
    firm = start  # the last value of which a sentence should say no other than is so
    for last, other in pairwise(sorted(seen, reverse=start > stop)):
        firm = last if last in known else firm
        while seen[last] != seen[other]:
            before = seen[last]
            at, last, first = _between(there, before, last, other, firm, digits)
            seen[first] = there(first)
            yield Change(along.point(at), before, seen[first], last, first)
            last = firm = first


def _turns(scene: Scene, name: str) -> Iterator[Fraction]:
    """Values of a parameter at which the tension ratio turns."""
    if name in MASSES:
        other = scene.m1 if name == "m2" else scene.m2
        yield other
        yield other + (Case(scene).axle_mass or 0)


def _between(
    there: Callable[[Fraction], Any],
    before: Any,
    last: Fraction,
    first: Fraction,
    firm: Fraction,
    digits: int | None,
) -> tuple[Decimal, Fraction, Fraction]:
    """Where what is so at ``last`` ends, before ``first``: rounded, not beyond ``firm``; and both sides."""
    up, least = last < first, digits or SHOWN_DIGITS
    rounding, kept = ROUND_FLOOR if up else ROUND_CEILING, least
    while max(last, first) > SMALLEST and abs(first - last) * 10 ** (kept + CLOSER) > max(last, first):
        at, other = (to_digits(kept, rounding)(value) for value in (last, first))
        if at == other:
            if firm <= at if up else at <= firm:
                return tidy(at) if at == last else at, last, first
            if kept == least + CLOSER:  # just at a number that is no decimal, as a third
                return to_digits(least, rounding)(last), last, first
            kept += 1
            continue
        middle = _middle(last, first)
        last, first = (middle, first) if there(middle) == before else (last, middle)
    return tidy(to_digits(kept)(first if max(last, first) > SMALLEST else Fraction(0))), last, first


def _middle(one: Fraction, other: Fraction) -> Fraction:
    """A value between two; where their sizes differ much, between their logarithms."""
    low, high = sorted((one, other))
    if low and high < 16 * low:
        return (low + high) / 2
    return high * about_power(low / high if low else Fraction(1, 2**128), Fraction(1, 2))
