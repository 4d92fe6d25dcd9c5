"""Where along a range the regime changes: the exact place, not the two points beside it.

Between two values in different regimes the decision of `Case`, which is exact, is asked at the middle until
what is left rounds to one number. So it holds for any parameter, and needs no formula.
"""

from collections.abc import Callable, Iterator, Mapping
from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal
from fractions import Fraction
from itertools import pairwise
from operator import attrgetter
from typing import Any, NamedTuple

from ..arithmetic.rounding import tidy, to_digits
from ..model.angle import Angle
from ..model.axle import Axle
from ..model.case import Case
from ..model.scene import Scene
from ..model.units import MAX_MAGNITUDE
from .answers import SHOWN_DIGITS
from .sweep import Point, Range, about_power

PROBES = 64
"""Steps at least in which a range is searched, so that what begins and ends between points is seen."""
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
    if name == "wrap":
        return scene._replace(wrap=Angle(value, scene.wrap.unit))
    if name == "axle" and scene.axle is not None:
        return scene._replace(axle=Axle(value, scene.axle.unit))
    new: Any = {name: value}
    return scene._replace(**new)


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

    seen = {value: known[value] if value in known else there(value) for value in _probes(scene, along)}
    seen |= known
    start, stop = along.ends
    firm = start  # the last value of which a sentence should say no other than is so
    for last, other in pairwise(sorted(seen, reverse=start > stop)):
        firm = last if last in known else firm
        while seen[last] != seen[other]:
            before = seen[last]
            at, last, first = _between(there, before, last, other, firm, digits)
            seen[first] = there(first)
            yield Change(along.point(at), before, seen[first], last, first)
            last = firm = first


def _probes(scene: Scene, along: Range) -> Iterator[Fraction]:
    """Values at which the regime is asked for, in any order."""
    yield from along.steps(PROBES)
    start, stop = along.ends
    equal = {"m1": scene.m2, "m2": scene.m1}.get(along.name)
    if equal is not None and min(start, stop) < equal < max(start, stop):
        yield equal


def _between(
    there: Callable[[Fraction], Any],
    before: Any,
    last: Fraction,
    first: Fraction,
    firm: Fraction,
    digits: int | None,
) -> tuple[Decimal, Fraction, Fraction]:
    """Where what is so at ``last`` ends, before ``first``: rounded, not beyond ``firm``; and both sides."""
    up = last < first
    rounding, kept = ROUND_FLOOR if up else ROUND_CEILING, digits or SHOWN_DIGITS
    while max(last, first) > SMALLEST and abs(first - last) * 10 ** (kept + CLOSER) > max(last, first):
        at, other = (to_digits(kept, rounding)(value) for value in (last, first))
        if at == other:
            if firm <= at if up else at <= firm:
                return tidy(at) if at == last else at, last, first
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
