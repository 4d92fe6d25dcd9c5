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
from decimal import ROUND_FLOOR, Decimal
from fractions import Fraction
from itertools import pairwise
from operator import attrgetter
from typing import Any, NamedTuple

from ..arithmetic.rounding import tidy, to_digits
from ..model.case import Case
from ..model.scene import MASSES, Scene
from ..model.units import MAX_MAGNITUDE
from .answers import SHOWN_DIGITS
from .sweep import Point, Range, about_power, with_value

CLOSER = 50
"""Both sides of a change at a number itself are narrowed to so many digits beyond those shown."""
SMALLEST = Fraction(1, 10**MAX_MAGNITUDE)
"""No input but 0 is smaller."""


class Change(NamedTuple):
    """A change along a range: ``at`` its place, rounded down, and its bracket.

    At ``last`` is still what was ``before``, at ``first`` what is ``after``.
    """

    at: Point
    before: Any
    after: Any
    last: Fraction
    first: Fraction


def changes(
    scene: Scene,
    along: Range,
    digits: int | None = None,
    known: Mapping[Fraction, str] = {},
    what: Callable[[Case], Any] = attrgetter("regime"),
) -> Iterator[Change]:
    """The changes of regime along a range, from its least value on, or of anything else about its cases.

    ``known`` is what it is at some values, which a place of a change must not contradict.
    """

    def state(value: Fraction) -> Any:
        return what(Case(with_value(scene, along.name, value)))

    start, stop = along.ends
    asked = [start, *(value for value in _turns(scene, along.name) if start < value < stop), stop]
    states = {value: state(value) for value in asked if value not in known} | dict(known)
    bound = start
    for last, other in pairwise(sorted(states)):
        bound = last if last in known else bound
        while states[last] != states[other]:
            before = states[last]
            at, last, first = _between(state, before, last, other, bound, digits or SHOWN_DIGITS)
            states[first] = state(first)
            yield Change(along.point(at), before, states[first], last, first)
            last = bound = first


def _turns(scene: Scene, name: str) -> Iterator[Fraction]:
    """Values of a parameter at which the tension ratio turns."""
    if name in MASSES:
        other = scene.m1 if name == "m2" else scene.m2
        yield other
        yield other + (Case(scene).axle_mass or 0)


def _between(
    state: Callable[[Fraction], Any],
    before: Any,
    last: Fraction,
    first: Fraction,
    bound: Fraction,
    digits: int,
) -> tuple[Decimal, Fraction, Fraction]:
    """A change between two values: its place, and both sides of it.

    The interval from ``last``, where the state is the one ``before``, to ``first``, where it is not, is
    halved until the place of the change can be written down. That ends in one of these ways:

    - Both sides, rounded down, have the same digits. These are the place, unless they lie before
      ``bound``: a row there says otherwise, so more digits are taken.
    - Both sides agree in far more digits than are shown, and still round to two numbers. Then the change is
      at a number of so few digits itself, like that of a regime at one point.
    - The same where the number is no decimal, as 1/14 kg: however many digits are taken, rounded they lie
      before ``bound``. Then the digits asked for have to do.
    - Both sides are smaller than any input: the change is at 0.
    """
    shown = digits
    while first > SMALLEST:
        at, other = (to_digits(shown, ROUND_FLOOR)(value) for value in (last, first))
        if at != other:
            if (first - last) * 10 ** (shown + CLOSER) <= first:
                return tidy(to_digits(shown)(first)), last, first
            middle = _middle(last, first)
            last, first = (middle, first) if state(middle) == before else (last, middle)
        elif bound <= at:
            return tidy(at) if at == last else at, last, first
        elif shown == digits + CLOSER:
            return to_digits(digits, ROUND_FLOOR)(last), last, first
        else:
            shown += 1
    return Decimal(0), last, first


def _middle(one: Fraction, other: Fraction) -> Fraction:
    """A value between two; where their sizes differ much, between their logarithms."""
    low, high = sorted((one, other))
    if low and high < 16 * low:
        return (low + high) / 2
    return high * about_power(low / high if low else Fraction(1, 2**128), Fraction(1, 2))
