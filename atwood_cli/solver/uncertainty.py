"""Standard uncertainties: from those of the inputs to those of the quantities, to first order.

For inputs x that are known to u(x), independently of each other, u(q)² = Σ (∂q/∂x · u(x))²; this is
(10) in 5.1.2 of the GUM (JCGM 100:2008). The slopes are exact: the equations that give a quantity, run on
duals (see `arithmetic.dual`), differentiate themselves. So an uncertainty is a quantity like any other,
one that can be computed in every arithmetic, and its digits are settled like those of a value.

A slope is that towards a scene an infinitesimal step beside the given one, to the right and to the left.
Mostly both are the same, and only the right one is computed. They differ at a kink: the friction needed goes
with |m2 - m1|, so at equal masses it rises to both sides, and has no uncertainty. An input of 0, which must
not be negative, has a right side only. A quantity without a value on one side has no slope there.

First order takes a quantity for linear over ± u(x). That is tried, too: where the quantity at x - u(x) or
x + u(x) is far from where its slope puts it, a sentence gives both values.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Iterator, Mapping, Sequence
from decimal import Decimal
from fractions import Fraction
from functools import cache, partial
from itertools import islice
from operator import attrgetter, itemgetter
from typing import TYPE_CHECKING, Any

from ..arithmetic.dual import Dual, Duals
from ..arithmetic.interval import ZERO, Enclosure, Unsettled, enclosures
from ..arithmetic.lazy import lazy
from ..arithmetic.protocol import N
from ..arithmetic.rounding import (
    GUARD,
    SHOWN_DIGITS,
    as_typed,
    settle,
    text,
    to_digits,
    to_place,
    with_uncertainty,
)
from ..model import physics
from ..model.case import Case, Excess
from ..model.machine import Machine, Undetermined
from ..model.motion import completed, impossible, moved, number_of, with_number
from ..model.quantities import QUANTITIES
from ..model.scene import Scene, parameter_of

if TYPE_CHECKING:
    from ..arithmetic.protocol import Arithmetic, Quantity

OnMachine = Callable[[Machine[Any]], Any]
"""Anything that a machine has, as a function of the machine."""

SURE = 20
"""Digits of the numbers that tell whether a case is in doubt."""
FAR = 5
"""A quantity is far from linear where it is off by more than a fifth of its uncertainty."""
NAMED = 3
"""How many quantities a sentence names."""
COVERAGE = 2
"""A case is in doubt within so many standard uncertainties of the line to another case."""

KINK = "unknown where the masses are equal, as there it has a kink"
KINK_OF_AXLE = "unknown where the axle just holds the difference, as there it has a kink"
JUMP = "unknown, as with another {} it may jump"


class MachineBeside(Machine[Dual[N]]):
    """The model of a case that is infinitesimally beside a scene."""

    ar: Duals[N]

    @lazy
    def friction_force_min(self) -> Dual[N]:
        """Least net friction force (N).

        Where tensions are equal but for that, the arcs at the limit are as little as their difference: one
        of length α pulls with μTα, the greatest force, and halves of it at both ends with cos φ/2 of that.
        """
        if self._bounded() and self.ar.base.is_zero(self.alpha.value):
            return self.friction_force_max * self.scene.wrap.cos_sin(self.ar, 2)[0]
        return super().friction_force_min


class Uncertainties:
    """The standard uncertainties of a scene: of its inputs, ``given`` in SI units, and of its quantities."""

    def __init__(self, case: Case, given: Mapping[str, Fraction]) -> None:
        self.case, self.given = case, given
        self._beside = cache(partial(beside, case))
        self._machine_beside: Callable[..., Machine[Any]] = cache(
            lambda case, ar: MachineBeside(case, Duals(ar))
        )
        self._machine: Callable[..., Machine[Any]] = cache(Machine)

    def of(self, quantity: OnMachine) -> Quantity:
        """The standard uncertainty of a quantity that has a value. It raises Undetermined."""
        return lambda ar: _length(ar, self._parts(quantity, ar).values())

    def percent(self, quantity: OnMachine, x: str) -> Quantity:
        """The share of an input in the variance of a quantity, which must not be 0, in percent."""

        def percent(ar: Arithmetic[N]) -> N:
            parts = self._parts(quantity, ar)
            if x not in parts or len(parts) == 1:
                return ar.number(100 * (x in parts))
            return 100 * _sum_of_squares(ar, [parts[x]]) / _sum_of_squares(ar, parts.values())

        return percent

    def _parts(
        self, quantity: OnMachine, ar: Arithmetic[N], choose: Callable[[list[N]], N] | None = None
    ) -> dict[str, N]:
        """By input x on which the quantity depends, its slope times u(x).

        ``choose`` picks one of the slopes to both sides. Without it a kink raises Undetermined.
        """
        parts = {}
        for x, u in self.given.items():
            slopes = list(self._slopes(quantity, x, ar))
            if any(slope is not None for slope in slopes):
                known = [ar.number(0) if slope is None else slope for slope in slopes]
                if choose is None and any(_size(slope - known[0], least=True) for slope in known):
                    raise Undetermined(KINK_OF_AXLE if self.case.axle_holds else KINK)
                parts[x] = (choose or itemgetter(0))(known) * ar.number(u)
        return parts

    def _slopes(self, quantity: OnMachine, x: str, ar: Arithmetic[N]) -> Iterator[N | None]:
        """The slope of the quantity with an input to its right, and to its left where it may be another."""
        for side, case in self._beside(x):
            try:
                slope: N | None = quantity(self._machine_beside(case, ar)).slope
            except Undetermined as reason:
                raise Undetermined(f"unknown, as with another {x} it may have no value: {reason}") from None
            except ZeroDivisionError:
                raise Undetermined(JUMP.format(x)) from None
            yield None if slope is None else side * slope

    # What may be otherwise

    def doubts(self, asked: Container[str]) -> list[str]:
        """Sentences on what may be otherwise: which mass is heavier, whether the string slips.

        And whether it can, where a quantity is asked for that exists only then. Each is decided by the sign
        of a margin, so it is in doubt where the margin is within its own uncertainty of 0.
        """
        case, difference = self.case, "m1 - m2" if self.case.sign < 0 else "m2 - m1"
        margins: list[tuple[str, str, OnMachine, str]] = [
            ("Which mass is heavier", "m2 - m1", lambda m: m.ar.number(m.scene.m2 - m.scene.m1), " kg")
        ]
        if case.axle_mass is not None:
            what = "Whether the axle holds the difference"
            margins.append((what, f"{difference} - axle/g", lambda m: physics.drive(m.l, m.h, m.b), " kg"))
        if case.scene.mu is not None:
            for excess, what, where in self._ways_to_slip(asked):
                margins.append((what, f"mu - mu_verge{where}", _friction_to_spare(excess), ""))
        return [sentence for margin in margins if (sentence := self._doubt(*margin))]

    def _doubt(self, what: str, name: str, margin: OnMachine, unit: str) -> str:
        """The sentence that what the sign of a margin decides is in doubt; empty if it is not."""

        def value(ar: Arithmetic[N]) -> N:
            here: N = margin(self._machine(self.case, ar))
            return here

        def u(ar: Arithmetic[N]) -> N:
            return _length(ar, self._parts(margin, ar, choose=_steepest).values())

        try:
            shift, spread = (Fraction(settle(one, to_digits(SURE), SURE)) for one in (value, u))
        except Undetermined:  # with inputs beside these there is no such scene
            return ""
        if not spread or abs(shift) > COVERAGE * spread:
            return ""
        shown = with_uncertainty(
            lambda place: settle(value, to_place(place), SURE), settle(u, to_digits(2), 2)
        )
        return (
            f"{what} is in doubt: {name} = {shown}{unit} is within {COVERAGE} standard uncertainties of 0"
            " (95 % of a normal distribution). The results are for the inputs as given."
        )

    def _ways_to_slip(self, asked: Container[str]) -> Iterator[tuple[Excess, str, str]]:
        """By the excess of the tension ratio it depends on: what is in question, and where it slips."""
        case = self.case
        locked, heaviest = " of a locked pulley", " under a heavier mass beyond all bounds"
        if case.pulley_known:
            yield "excess_ratio", "Whether the string slips", ""
        else:
            yield "locked_excess", "Whether any pulley can make the string slip", locked
        if case.pulley_known and not case.stands and "critical_pulley_mass" in asked:
            yield "locked_excess", "Whether there is a critical_pulley_mass", locked
        if case.axle_friction is not None and case.sign and not case.axle_holds:
            yield "massless_excess", "Whether the string slips on any pulley", " of a massless pulley"
        if case.rim_mass is not None and "critical_heavier_mass" in asked:
            yield "heaviest_excess", "Whether there is a critical_heavier_mass", heaviest

    # Where first order misleads

    def misled(self, spread: Mapping[str, float | Decimal], digits: int) -> list[str]:
        """Sentences, by uncertain input, on where first order misleads: the values an uncertainty off.

        ``spread`` has the uncertainties shown, by name of the quantity, settled to so many digits.
        """
        ar = enclosures(digits + GUARD)  # in which the uncertainties were settled
        sentences = []
        for x, u in self.given.items():
            numbers = [_one_off(self.case, x, u * side) for side in (-1, 1)]
            cases = [case for number in numbers if (case := _case_at(self.case, x, number))]
            far = {n: u for n, u in spread.items() if self._is_far(attrgetter(n), x, cases, ar)}
            if far:
                start, end = (_with_unit(self.case, x, number) for number in numbers)
                said = f"as it goes from {start} to {end}, {self._from_end_to_end(far, cases)}"
                if len(cases) < len(numbers):
                    said = f"not every value from {start} to {end} is possible"
                sentences.append(f"{x} is too uncertain for first order: {said}.")
        return sentences

    def _is_far(self, quantity: OnMachine, x: str, cases: Sequence[Case], ar: Arithmetic[Enclosure]) -> bool:
        """Whether first order misleads on the quantity, over the cases an uncertainty of x off.

        It does where the quantity has no value there, or is certainly more than a fifth of its uncertainty
        away from the line q(x) ± q'(x) u(x). Where x has no such case, it does on all that depends on x.
        """
        try:
            parts = self._parts(quantity, ar, choose=itemgetter(0))
            if len(cases) < 2:
                return x in parts
            part, most = parts.get(x, ar.number(0)), _size(_length(ar, parts.values()))
            low, here, high = (quantity(self._machine(case, ar)) for case in (cases[0], self.case, cases[1]))
            return any(_size(FAR * off, least=True) > most for off in (here - low - part, high - here - part))
        except Unsettled:  # nearer to a pole than anything that is measured
            return False
        except (Undetermined, ZeroDivisionError, OverflowError):
            return True

    def _from_end_to_end(self, spread: Mapping[str, float | Decimal], cases: Sequence[Case]) -> str:
        """The values in the cases, of the first few quantities, as a table cuts them in the middle."""
        words: list[str] = []
        for name, u in islice(spread.items(), NAMED):
            exact = Fraction(u) if isinstance(u, float) else u
            round_ = to_place(to_digits(2)(exact).adjusted() - 1) if u else to_digits(SHOWN_DIGITS)
            values = " to ".join(self._in_words(name, case, round_) for case in cases)
            words.append(f"{name} {'goes ' * (not words)}from {values}")
        return ", ".join(words) + f", and so on for {len(spread) - NAMED} more" * (len(spread) > NAMED)

    def _in_words(self, name: str, case: Case, round_: Callable[[Any], Decimal]) -> str:
        """The value of a quantity in a case, with its unit."""

        def value(ar: Arithmetic[N]) -> N:
            there: N = getattr(self._machine(case, ar), name)
            return there

        try:
            shown = settle(value, round_, SURE)
        except (Undetermined, ZeroDivisionError):
            return "no value"
        except OverflowError:  # of a denominator
            shown = Decimal(0)
        number = f"{shown:f}" if -4 <= shown.adjusted() < 16 else text(shown)
        return f"{number} {QUANTITIES[name].unit}".rstrip()


def _friction_to_spare(excess: Excess) -> OnMachine:
    """The friction there is above what is needed at that excess of the tension ratio."""

    def margin(machine: Machine[N]) -> N:
        needed = physics.verge_coefficient(
            machine.ar.log1p(getattr(machine.case, excess)(machine.ar)), machine.phi
        )
        return machine.reference_mu - needed

    return margin


def _sum_of_squares(ar: Arithmetic[N], parts: Iterable[N]) -> N:
    total = ar.number(0)
    for part in parts:
        total += part * part
    return total


def _length(ar: Arithmetic[N], parts: Iterable[N]) -> N:
    return ar.sqrt(_sum_of_squares(ar, parts))


def _steepest(slopes: list[N]) -> N:
    return max(slopes, key=_size)


def _size(x: Any, least: bool = False) -> Fraction | Decimal:
    """How far from 0 a number may be; or is, at least."""
    if not isinstance(x, Enclosure):
        return Fraction(abs(x))
    if least and x.lo <= 0 <= x.hi:
        return ZERO
    return (min if least else max)(x.lo.copy_abs(), x.hi.copy_abs())


def _one_off(case: Case, x: str, u: Fraction) -> Fraction:
    """The number given for an input, with u added, or the nearest to that which an input may be."""
    scene = case.scene
    number: Fraction = number_of(scene, case.motion, x) + u
    least = (x == "mu" and scene.mu_k) or Fraction(0)
    if x == "mu_k" and scene.mu is not None:
        number = min(number, scene.mu)
    return number if x == "a" else max(number, least)


def _case_at(case: Case, x: str, number: Fraction) -> Case | None:
    """The case with that number for an input; None where nothing gives what was measured."""
    scene, motion = with_number(case.scene, case.motion, x, number)
    try:
        if motion.finds and not motion.beyond and impossible(Case(scene, motion), ""):
            return None
        return Case(completed(scene, motion), motion)
    except (Undetermined, ZeroDivisionError):
        return None


def _with_unit(case: Case, x: str, number: Fraction) -> str:
    """An input's number with the unit that it was given in."""
    given = getattr(case.scene if x in Scene._fields else case.motion, x)
    unit = getattr(given, "unit", parameter_of(x).unit)
    return f"{as_typed(number)}{' ' * (unit not in ('', '°'))}{unit}"


def beside(case: Case, x: str) -> list[tuple[int, Case]]:
    """The cases of scenes in which an input is infinitesimally more, and less where that may differ.

    Raises Undetermined where no pulley fits what was measured.
    """
    scene, motion = case.scene, case.motion
    just_held = case.axle_mass is not None and case.heavy - case.light == case.axle_mass
    bends = scene.m1 == scene.m2 or scene.M == 0 or x == "wrap" or just_held
    ends = number_of(scene, motion, x) == 0 and x != "a"
    cases = []
    for side in (1, -1) if bends and not ends else (1,):
        near, measured = moved(scene, motion, x, side)
        cases.append((side, Case(completed(near, measured), measured)))
    return cases
