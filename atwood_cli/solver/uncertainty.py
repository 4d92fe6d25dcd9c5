"""How uncertain results are, by solving the scene again with each input an uncertainty less, and more.

The step of a quantity q with an input x is half the range of q(x - u), q(x) and q(x + u): if q is
monotonic, that is Kragten's step (GUM, 5.1.3, note 2; J. Kragten, Analyst 119, 1994). The standard
uncertainty of q is the root of the sum of the squared steps. Anybody can redo it with `solve`, and it sees
that a string slips at one end, which no derivative does.

Each value is rounded to `DIGITS` digits, and a range below `NEGLIGIBLE` of the value counts as 0. So an
uncertainty is right to `RIGHT_DIGITS` digits.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from decimal import ROUND_HALF_EVEN, Decimal
from fractions import Fraction
from operator import attrgetter, itemgetter
from typing import TYPE_CHECKING, NamedTuple

from ..arithmetic.interval import ZERO, decimal_context
from ..model.decisions import Decisions
from ..model.digits import (
    SHOWN_DIGITS,
    as_typed,
    format_number,
    is_infinite,
    rounding_to_place,
    strip_zeros,
    to_digits,
    with_uncertainty,
)
from ..model.motion import found_inputs, number_of, with_number
from ..model.quantities import QUANTITIES, Undetermined
from ..model.scene import Motion, Scene, parameter_of, with_unit

if TYPE_CHECKING:
    from .answers import Answers

DIGITS, RIGHT_DIGITS = 48, 15
NEGLIGIBLE = Decimal("1e-30")
CONTEXT = decimal_context(2 * DIGITS, ROUND_HALF_EVEN)
"""Sums and products of values lose no digit that counts."""

UNEVEN_SHARE = Decimal("0.2")
"""A sentence says so if the steps to both sides differ by more than this part of the uncertainty."""
MOST_NAMED = 3
"""The most quantities that a sentence names."""
COVERAGE = 2
"""The regime is in doubt if it differs within so many standard uncertainties of an input."""
REGIME_WORDS = {"no-slip": "no slip", "verge": "on the verge", "slip": "slips"}
NO_SCENE, NO_FIT = "makes no valid scene", "nothing fits what was measured"


class Value(NamedTuple):
    """The value of a quantity, or why it has none; and the decisions about the scene that it is of."""

    number: Decimal | None
    reason: str = ""
    case: Decisions | None = None


class End(NamedTuple):
    """The scene with an input at an end of its range: the input, and the answers, or why there are none."""

    input: Fraction
    answers: Answers | None
    reason: str = ""

    def value(self, name: str) -> Value:
        """Return the value of a quantity; one too small to be written out is 0."""
        if self.answers is None:
            return Value(None, self.reason)
        try:
            number = Decimal(self.answers.settle(attrgetter(name)))
        except Undetermined as undetermined:
            return Value(None, str(undetermined))
        except ZeroDivisionError:
            return Value(None, "unknown")
        except OverflowError:  # of a denominator
            number = ZERO
        return Value(number, case=self.answers.case)


class Spread(NamedTuple):
    """A quantity in the scene and at both ends of each input, the steps that are not 0, and the variance."""

    here: Decimal
    ends: Mapping[str, Sequence[Value]]
    steps: Mapping[str, Decimal]
    variance: Decimal


class Uncertainties:
    """The standard uncertainties of a scene: of its inputs, ``given`` in SI units, and of its quantities.

    ``solve`` returns the answers to a scene, to so many digits, with a motion.
    """

    def __init__(
        self, case: Decisions, given: Mapping[str, Fraction], solve: Callable[[Scene, int, Motion], Answers]
    ) -> None:
        self.case, self.given, self._solve = case, given, solve
        self._here = End(Fraction(0), solve(case.scene, DIGITS, case.motion))
        self._ends = {x: (self._end(x, -u), self._end(x, u)) for x, u in given.items()}
        self._spreads: dict[str, Spread | None] = {}

    def _end(self, x: str, step: Fraction) -> End:
        """Solve the scene with an input so much more, as far as it may be; what is found may go below 0."""
        scene, motion = self.case.scene, self.case.motion
        number: Fraction = number_of(scene, motion, x) + step
        if x == "mu_k" and scene.mu is not None:
            number = min(number, scene.mu)
        if x != "a":
            least = scene.mu_k if x == "mu" and scene.mu_k is not None else Fraction(0)
            number = max(number, least)
        if not number and x != "a" and not parameter_of(x).zero:
            return End(number, None, NO_SCENE)
        try:
            scene, motion = with_number(scene, motion, x, number)
            there = scene._replace(**found_inputs(scene, motion))
            if 0 in (there.m1, there.m2) and (there.mu is not None or there.m1 == there.m2):
                return End(number, None, NO_SCENE)
            answers = self._solve(there, DIGITS, motion)
            _ = answers.case.axle_mass, answers.case.rim_mass
        except (Undetermined, ZeroDivisionError):
            return End(number, None, NO_FIT)
        return End(number, answers)

    def _spread(self, name: str) -> Spread | None:
        """Compute a quantity at all ends, once; None if it has no finite value in the scene."""
        if name not in self._spreads:
            here = self._here.value(name).number
            self._spreads[name] = None if here is None or is_infinite(here) else self._measure(name, here)
        return self._spreads[name]

    def _measure(self, name: str, here: Decimal) -> Spread:
        ends = {x: [end.value(name) for end in pair] for x, pair in self._ends.items()}
        steps, variance = {}, ZERO
        for x, values in ends.items():
            numbers = [here, *(value.number for value in values if value.number is not None)]
            least, most = min(numbers), max(numbers)
            size = CONTEXT.subtract(most, least)
            scale = max(least.copy_abs(), most.copy_abs())
            if size > CONTEXT.multiply(NEGLIGIBLE, scale) or is_infinite(size):
                steps[x] = CONTEXT.divide(size, Decimal(2))
                variance = CONTEXT.fma(steps[x], steps[x], variance)
        return Spread(here, ends, steps, variance)

    def of(self, name: str, digits: int | None = None) -> Decimal | None:
        """Return the standard uncertainty of a quantity, to `RIGHT_DIGITS` digits or to fewer.

        It is None if the quantity has no value at an end of an input, or no finite one in the scene.
        """
        spread = self._spread(name)
        if spread is None or any(value.number is None for pair in spread.ends.values() for value in pair):
            return None
        return to_digits(min(digits or RIGHT_DIGITS, RIGHT_DIGITS))(CONTEXT.sqrt(spread.variance))

    def percents(self, name: str) -> dict[str, Decimal]:
        """Return the share of each input in the variance of a quantity, if that is finite and not 0."""
        spread = self._spread(name)
        if spread is None or not spread.steps or is_infinite(spread.variance):
            return {}
        steps = {x: spread.steps.get(x, ZERO) for x in self.given}
        shares = {
            x: CONTEXT.divide(CONTEXT.multiply(step, step), spread.variance) for x, step in steps.items()
        }
        return {x: to_digits(RIGHT_DIGITS)(share.scaleb(2, CONTEXT)) for x, share in shares.items()}

    # In sentences

    def doubts(self) -> list[str]:
        """Say that the heavier mass, or the regime, is another within two standard uncertainties."""
        said: dict[str, str] = {}
        for x, u in self.given.items():
            for side in (-COVERAGE, COVERAGE):
                end = self._end(x, side * u)
                what = _otherwise(self.case, end.answers.case) if end.answers else ""
                if what and what not in said:
                    said[what] = (
                        f"{what} is in doubt: the answer differs at {self._at(x, end)},"
                        f" {COVERAGE} standard uncertainties away. Results use the inputs as given."
                    )
        return [*said.values()]

    def other_regimes(self) -> list[str]:
        """Return the regimes, other than the scene's, within two standard uncertainties of an input."""
        ends = (self._end(x, side * u) for x, u in self.given.items() for side in (-COVERAGE, COVERAGE))
        found = dict.fromkeys(end.answers.case.regime for end in ends if end.answers)
        return [regime for regime in found if regime != self.case.regime]

    def open_ended(self, names: Iterable[str]) -> list[str]:
        """Say which quantities have no value at an end of an input, and which they have at the other one."""
        found: dict[tuple[str, str], list[str]] = {}
        for name in names:
            spread = self._spread(name)
            if spread is None:
                continue
            for x, values in spread.ends.items():
                missing = [i for i in (0, 1) if values[i].number is None]
                if missing:
                    i = missing[0]
                    place = self._at(x, self._ends[x][i]), values[i].reason
                    found.setdefault(place, []).append(_one_sided(name, spread.here, values[1 - i]))
        return [
            f"{_first_of(sentences)}: {place} {why}."
            if why == NO_SCENE
            else f"{_first_of(sentences)}: at {place}, {why}."
            for (place, why), sentences in found.items()
        ]

    def lopsided(self, names: Iterable[str]) -> list[str]:
        """Say which quantities change by more to one side, or change sign or regime within an uncertainty."""
        found: dict[str, list[str]] = {}
        for x in self.given:
            for name in names:
                spread, u = self._spread(name), self.of(name)
                if spread and u and self._is_lopsided(spread, x, u):
                    found.setdefault(x, []).append(self._from_end_to_end(name, spread, x))
        return [f"{_first_of(sentences)}, as {x} varies by ±u." for x, sentences in found.items()]

    def _is_lopsided(self, spread: Spread, x: str, u: Decimal) -> bool:
        if x not in spread.steps or is_infinite(u):
            return False
        for value in spread.ends[x]:
            if value.case and _otherwise(self.case, value.case):
                return True
            if value.number is not None:
                changes_sign = CONTEXT.multiply(value.number, spread.here) < 0
                change = CONTEXT.subtract(spread.here, value.number).copy_abs()
                uneven = CONTEXT.subtract(change, spread.steps[x]).copy_abs()
                if changes_sign or uneven > CONTEXT.multiply(UNEVEN_SHARE, u):
                    return True
        return False

    def _from_end_to_end(self, name: str, spread: Spread, x: str) -> str:
        """Say a quantity with its uncertainty, and from where to where it goes with an input."""
        short = self.of(name, 2)
        assert short is not None
        unit, round_ = QUANTITIES[name].unit, rounding_to_place(short.adjusted() - 1)
        both = with_uncertainty(lambda place: rounding_to_place(place)(spread.here), short)
        values = [(spread.here, self.case)]
        values += [(end.number, end.case) for end in spread.ends[x] if end.number is not None and end.case]
        values.sort(key=itemgetter(0))
        changes = any(case.regime != self.case.regime for _, case in values)
        ends = []
        for value, case in (values[0], values[-1]):
            regime = f" ({REGIME_WORDS[case.regime]})" if changes else ""
            ends.append(f"{format_number(strip_zeros(round_(value)))}{regime}")
        return f"{name} is {with_unit(both, unit)}, from {ends[0]} to {ends[1]}"

    def _at(self, x: str, end: End) -> str:
        """Say an input at an end, with its unit: "mu = 0.35"."""
        given = getattr(self.case.scene if x in Scene._fields else self.case.motion, x)
        unit = getattr(given, "unit", parameter_of(x).unit)
        return f"{x} = {with_unit(as_typed(end.input), unit)}"


DOUBTFUL = {
    "Which mass is heavier": "sign",
    "Whether the axle holds the difference": "axle_holds",
    "Whether the string slips": "regime",
}
"""The decisions that may differ at an end of an input, and their attributes of `Decisions`."""


def _otherwise(case: Decisions, other: Decisions) -> str:
    """Name the first decision that differs between two scenes, "" if none does."""
    return next((what for what, x in DOUBTFUL.items() if getattr(case, x) != getattr(other, x)), "")


def _one_sided(name: str, here: Decimal, other: Value) -> str:
    """Say a value without an uncertainty, and the one at the only end that has one."""
    unit = QUANTITIES[name].unit
    said = f"{name} is {with_unit(format_number(strip_zeros(to_digits(SHOWN_DIGITS)(here))), unit)}"
    if other.number is None or other.number == here:
        return said
    bound = with_unit(format_number(strip_zeros(to_digits(SHOWN_DIGITS)(other.number))), unit)
    return f"{said}, at {'least' if other.number < here else 'most'} {bound}"


def _first_of(sentences: Sequence[str]) -> str:
    """Join the first sentences, and count the others."""
    joined = "; ".join(sentences[:MOST_NAMED])
    others = len(sentences) - MOST_NAMED
    return f"{joined}, and so on for {others} more" if others > 0 else joined
