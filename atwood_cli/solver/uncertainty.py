"""How uncertain results are, by solving the scene again with each input an uncertainty less, and more.

The step of a quantity q with an input x is half the range of q(x - u), q(x) and q(x + u): where q is
monotonic, that is Kragten's step (GUM, 5.1.3, note 2; J. Kragten, Analyst 119, 1994). The standard
uncertainty of q is the root of the sum of the squared steps. Anybody can redo it with `solve`, and it sees
that a string slips at one end, which no derivative does.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from decimal import Decimal
from fractions import Fraction
from functools import cache
from itertools import starmap
from operator import attrgetter, itemgetter
from typing import TYPE_CHECKING, Any, NamedTuple

from ..arithmetic.fingerprint import FINGERPRINTS
from ..arithmetic.interval import Enclosure, Unsettled, enclosures
from ..arithmetic.rational import N
from ..arithmetic.settling import GUARD_DIGITS, settle
from ..model.case import Case
from ..model.digits import SHOWN_DIGITS, as_typed, is_infinite, text, tidy, to_digits, to_place, to_threshold
from ..model.digits import with_uncertainty as with_both
from ..model.machine import Machine
from ..model.motion import completed, number_of, with_number
from ..model.quantities import QUANTITIES
from ..model.reasons import Undetermined
from ..model.scene import INPUTS, MEASURED, Scene, parameter_of

if TYPE_CHECKING:
    from ..arithmetic.rational import Arithmetic, Quantity

OnMachine = Callable[[Machine[Any]], Any]
"""Anything that a machine has, as a function of the machine."""

SURE = 20
"""Digits of the numbers in sentences before they are rounded."""
LOPSIDED = 5
"""A sentence says so where the steps to both sides differ by more than this part of the uncertainty."""
NAMED = 3
"""How many quantities a sentence names."""
COVERAGE = 2
"""The regime is in doubt where it differs within so many standard uncertainties of an input."""
REGIME = {"no-slip": "holds", "verge": "on the verge", "slip": "slips"}


class End(NamedTuple):
    """What an input may be in place of its value, and the case of that scene; or why there is none."""

    number: Fraction
    case: Case | None
    reason: str = ""


class Uncertainties:
    """The standard uncertainties of a scene: of its inputs, ``given`` in SI units, and of its quantities."""

    def __init__(self, case: Case, given: Mapping[str, Fraction]) -> None:
        self.case, self.given = case, given
        self._machine: Callable[..., Machine[Any]] = cache(Machine)
        self.ends = {x: [end_of(case, x, -u), end_of(case, x, u)] for x, u in given.items()}

    def of(self, quantity: OnMachine) -> Quantity:
        """The standard uncertainty of a quantity that has a value at all ends."""
        return lambda ar: ar.sqrt(_sum_of_squares(ar, self._steps(quantity, ar)))

    def percent(self, quantity: OnMachine, x: str) -> Quantity:
        """The share of an input in the variance of a quantity, which must not be 0, in percent."""

        def percent(ar: Arithmetic[N]) -> N:
            steps = self._steps(quantity, ar)
            if x not in steps or len(steps) == 1:
                return ar.number(100 * (x in steps))
            return 100 * steps[x] * steps[x] / _sum_of_squares(ar, steps)

        return percent

    def _steps(self, quantity: OnMachine, ar: Arithmetic[N]) -> dict[str, N]:
        """By input x on which the quantity depends: half the range of its values at x and at both ends."""
        return {
            x: _half_range(*(self._value(quantity, case, ar) for case in self._cases(x)))
            for x in self.given
            if len({self._value(quantity, case, FINGERPRINTS) for case in self._cases(x)}) > 1
        }

    def _cases(self, x: str) -> list[Case]:
        """The case of the scene, and those at the ends of an input."""
        return [self.case, *(end.case for end in self.ends[x] if end.case)]

    def _value(self, quantity: OnMachine, case: Case, ar: Arithmetic[N]) -> N:
        value: N = quantity(self._machine(case, ar))
        return value

    def _missing(self, quantity: OnMachine, end: End) -> str:
        """Why a quantity has no value at an end; empty if it has one."""
        if end.case is None:
            return end.reason
        try:
            self._value(quantity, end.case, FINGERPRINTS)
        except Undetermined as undetermined:
            return str(undetermined)
        except ZeroDivisionError:
            return "unknown"
        return ""

    def exists(self, quantity: OnMachine) -> bool:
        """Whether a quantity has a value at all ends."""
        return not any(self._missing(quantity, end) for ends in self.ends.values() for end in ends)

    # In sentences

    def doubts(self) -> list[str]:
        """Which mass is heavier, and what the string does, where that is otherwise two uncertainties off."""
        said: dict[str, str] = {}
        for x, u in self.given.items():
            for side in (-COVERAGE, COVERAGE):
                end = end_of(self.case, x, side * u)
                if end.case and (what := _otherwise(self.case, end.case)) and what not in said:
                    said[what] = (
                        f"{what} is in doubt: it is otherwise at {_at(self.case, x, end)},"
                        f" {COVERAGE} standard uncertainties off. The results are for the inputs as given."
                    )
        return [*said.values()]

    def open_ended(self, names: Iterable[str]) -> list[str]:
        """Sentences on quantities that have no value at an end, and on what they are at the other one."""
        found: dict[tuple[str, str], list[tuple[str, End]]] = {}
        for name in names:
            for x, ends in self.ends.items():
                for end, other in zip(ends, reversed(ends), strict=True):
                    if why := self._missing(attrgetter(name), end):
                        found.setdefault((_at(self.case, x, end), why), []).append((name, other))
                        break
        return [
            f"{_listed(self._one_sided, without)}: at {place} {'it ' * why.startswith('does')}{why}."
            for (place, why), without in found.items()
        ]

    def _one_sided(self, name: str, other: End) -> str:
        """A value without an uncertainty, and the one at the only end where it has one."""
        here = self._settled(name, self.case)
        said = f"{name} is {_with_unit(name, tidy(to_digits(SHOWN_DIGITS)(here)))}"
        if self._missing(attrgetter(name), other) or other.case is None:
            return said
        there = self._settled(name, other.case)
        if there == here:
            return said
        bound = to_threshold(up=there > here)(there)
        return f"{said}, {_with_unit(name, bound)} or {'more' if there < here else 'less'}"

    def lopsided(self, spread: Mapping[str, float | Decimal], digits: int) -> list[str]:
        """Sentences on quantities that change by more to one side, or in which the regime or a sign changes.

        ``spread`` has the uncertainties shown, by name of the quantity, settled to so many digits.
        """
        ar = enclosures(digits + GUARD_DIGITS)
        finite = [name for name, u in spread.items() if u and not is_infinite(u)]
        found = {
            x: [(name, x) for name in finite if self._is_lopsided(attrgetter(name), x, ar)]
            for x in self.given
        }
        return [
            f"{_listed(self._from_end_to_end, names)}, as {x} is uncertain."
            for x, names in found.items()
            if names
        ]

    def _is_lopsided(self, quantity: OnMachine, x: str, ar: Arithmetic[Enclosure]) -> bool:
        """Whether one step differs from half the range by more than a fifth of the uncertainty, or worse."""
        cases = self._cases(x)
        try:
            steps = self._steps(quantity, ar)
            if x not in steps:
                return False
            if any(_otherwise(self.case, case) for case in cases):
                return True
            here, *there = (self._value(quantity, case, ar) for case in cases)
            u = ar.sqrt(_sum_of_squares(ar, steps))
        except (Unsettled, ZeroDivisionError, OverflowError):  # nearer to a pole than anything measured
            return False
        if any((end * here).hi < 0 for end in there):
            return True
        return any((LOPSIDED * abs(abs(here - end) - steps[x]) - u).lo > 0 for end in there)

    def _from_end_to_end(self, name: str, x: str) -> str:
        """A quantity with its uncertainty, and from where to where it goes with an input."""
        values = sorted(((self._settled(name, case), case) for case in self._cases(x)), key=itemgetter(0))
        short = settle(self.of(attrgetter(name)), to_digits(2), 2)
        here, unit = self._settled(name, self.case), QUANTITIES[name].unit
        both = with_both(lambda place: to_place(place)(here), short)
        round_ = to_place(short.adjusted() - 1)
        changes = any(case.regime != self.case.regime for _, case in values)
        low, high = (
            f"{text(tidy(round_(value)))}{f' ({REGIME[case.regime]})' * changes}"
            for value, case in (values[0], values[-1])
        )
        return f"{name} is {both}{f' {unit}' * bool(unit)}, from {low} to {high}"

    def _settled(self, name: str, case: Case) -> Decimal:
        """A value to many digits."""
        quantity = attrgetter(name)
        return settle(lambda ar: self._value(quantity, case, ar), to_digits(SURE), SURE)


def end_of(case: Case, x: str, step: Fraction) -> End:
    """The scene with an input so much more: as far as it may be, and with what was found going on below 0."""
    scene, motion = case.scene, case.motion
    number: Fraction = number_of(scene, motion, x) + step
    limits = INPUTS | MEASURED
    if x == "mu_k" and scene.mu is not None:
        number = min(number, scene.mu)
    if x != "a":
        number = max(number, (x == "mu" and scene.mu_k) or Fraction(0))
    if not number and x != "a" and not limits[x].zero:
        return End(number, None, "there is no such scene")
    there, measured = with_number(scene, motion, x, number)
    try:
        there = completed(there, measured)
        if 0 in (there.m1, there.m2) and (there.mu is not None or there.m1 == there.m2):
            return End(number, None, "there is no such scene")
        found = Case(there, measured)
        _ = found.axle_mass, found.rim_mass
    except (Undetermined, ZeroDivisionError):
        return End(number, None, "nothing fits what was measured")
    return End(number, found)


DOUBTFUL = {
    "Which mass is heavier": "sign",
    "Whether the axle holds the difference": "axle_holds",
    "Whether the string slips": "regime",
}
"""What may be otherwise at an end of an input, and the attribute of `Case` that says so."""


def _otherwise(case: Case, other: Case) -> str:
    """What is otherwise in another case; empty if nothing is."""
    return next((what for what, x in DOUBTFUL.items() if getattr(case, x) != getattr(other, x)), "")


def _at(case: Case, x: str, end: End) -> str:
    """An input at an end, with its unit: "mu = 0.35"."""
    given = getattr(case.scene if x in Scene._fields else case.motion, x)
    unit = getattr(given, "unit", parameter_of(x).unit)
    return f"{x} = {as_typed(end.number)}{' ' * (unit not in ('', '°'))}{unit}"


def _with_unit(name: str, value: Decimal) -> str:
    """A value in a sentence, with its unit."""
    return f"{text(value)} {QUANTITIES[name].unit}".rstrip()


def _listed(say: Callable[..., str], things: Sequence[Iterable[Any]]) -> str:
    """What is said of the first things, and how many more there are."""
    more = f", and so on for {len(things) - NAMED} more" * (len(things) > NAMED)
    return "; ".join(starmap(say, things[:NAMED])) + more


def _sum_of_squares(ar: Arithmetic[N], steps: Mapping[str, N]) -> N:
    return sum((step * step for step in steps.values()), ar.number(0))


def _half_range(a: Any, b: Any, c: Any) -> Any:
    return (abs(a - b) + abs(b - c) + abs(c - a)) / 4
