"""How uncertain results are, by solving the scene again with each input an uncertainty less, and more.

The step of a quantity q with an input x is half the range of q(x - u), q(x) and q(x + u): if q is
monotonic, that is Kragten's step (GUM, 5.1.3, note 2; J. Kragten, Analyst 119, 1994). The standard
uncertainty of q is the root of the sum of the squared steps. Anybody can redo it with `solve`, and it sees
that a string slips at one end, which no derivative does.

Each value is rounded to `DIGITS` digits, and a range below `NEGLIGIBLE` of the value counts as 0. So an
uncertainty is right to `RIGHT_DIGITS` digits.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from decimal import ROUND_HALF_EVEN, Decimal, localcontext
from fractions import Fraction
from typing import Any, NamedTuple

from ..numbers.digits import Rounding, half_range, is_infinite, to_digits, to_double
from ..numbers.interval import ZERO, decimal_context
from .answers import TOO_SMALL, Answer, Answers
from .inverse import directed, found_inputs
from .quantities import Undetermined
from .scene import parameter_of

DIGITS, RIGHT_DIGITS = 48, 15
NEGLIGIBLE = Decimal("1e-30")
CONTEXT = decimal_context(2 * DIGITS, ROUND_HALF_EVEN)
"""Sums and products of values lose no digit that counts."""

NO_SCENE, NOTHING_FITS = "there is no valid scene", "nothing fits what was measured"


class End(NamedTuple):
    """The scene with an input at an end of its range: the input, and the answers, or why there are none."""

    input: Fraction
    answers: Answers | None
    reason: str = ""

    def answer(self, name: str) -> Answer:
        """Return the value of a quantity; one too small to be written out is 0."""
        if self.answers is None:
            return Answer(None, self.reason)
        try:
            answer = self.answers.answer(name)
        except ZeroDivisionError:
            return Answer(None, "unknown")
        return Answer(ZERO) if answer.reason == TOO_SMALL else answer


class Spread(NamedTuple):
    """A quantity in the scene and at both ends of each input, the steps that are not 0, and the variance."""

    here: Decimal
    ends: Mapping[str, Sequence[Answer]]
    steps: Mapping[str, Decimal]
    variance: Decimal


class UncertainAnswers(Answers):
    """The quantities of a scene with standard uncertainties: of inputs, ``uncertain``, and of quantities."""

    def __init__(self, *given: Any) -> None:
        super().__init__(*given)
        self.uncertain = {x: read.uncertainty for x, read in self.inputs.items() if read.uncertainty}
        self._ends: dict[int, dict[str, tuple[End, End]]] = {}
        self._spreads: dict[str, Spread] = {}

    def ends_at(self, n: int) -> dict[str, tuple[End, End]]:
        """Return each input n standard uncertainties below and above, each solved once."""
        if n not in self._ends:
            self._ends[n] = {
                x: (self._end(x, -n * u), self._end(x, n * u)) for x, u in self.uncertain.items()
            }
        return self._ends[n]

    def _end(self, x: str, step: Fraction) -> End:
        """Solve with an input so much more, kept to the rules of `Scene.of`; what is found may be below 0."""
        scene = self.decided.scene
        number: Fraction = scene.as_given(x) + step
        if x == "mu_k" and scene.mu is not None:
            number = min(number, scene.mu)
        if x != "a":
            number = max(number, Fraction(0)) if scene.as_given(x) >= 0 else min(number, Fraction(0))
            may_be_zero = parameter_of(x).may_be_zero and (x != "M" or scene.I is None)
            if not (number or may_be_zero):
                return End(number, None, NO_SCENE)
        try:
            at_end = scene.with_number(x, number)
            # Equal masses slow down, which tells the direction of their motion: that is kept.
            scene = at_end if scene.m1 == scene.m2 else directed(at_end)
            if x == "mu" and scene.mu_k is not None:
                scene = scene._replace(mu_k=min(scene.mu_k, number))  # it is at most mu
            moved = scene._replace(**found_inputs(scene))
            if 0 in (moved.m1, moved.m2) and (moved.mu is not None or moved.m1 == moved.m2):
                return End(number, None, NO_SCENE)
            answers = Answers(moved, DIGITS, units=self.units)
            _ = answers.decided.axle_mass, answers.decided.rim_mass
        except (Undetermined, ZeroDivisionError):
            return End(number, None, NOTHING_FITS)
        return End(number, answers)

    def spread(self, name: str) -> Spread | None:
        """Compute a quantity at all ends, once; None if it has no finite value in the scene."""
        if name in self._spreads:
            return self._spreads[name]
        here = End(Fraction(0), self.rounded_to(DIGITS)).answer(name).value
        if here is None or is_infinite(here):
            return None
        ends = {x: [end.answer(name) for end in pair] for x, pair in self.ends_at(1).items()}
        steps = {}
        with localcontext(CONTEXT):
            for x, pair in ends.items():
                numbers = [here, *(answer.value for answer in pair if answer.value is not None)]
                step = half_range(numbers)
                if 2 * step > NEGLIGIBLE * max(map(abs, numbers)) or is_infinite(step):
                    steps[x] = step
            variance = sum((step * step for step in steps.values()), ZERO)
        self._spreads[name] = Spread(here, ends, steps, variance)
        return self._spreads[name]

    def uncertainty(self, name: str, digits: int | None = None) -> Any:
        """Return the standard uncertainty of a quantity: a double, or to at most `RIGHT_DIGITS` digits.

        It is None if the quantity has no value at an end of an input, or no finite one in the scene.
        """
        value, reason = self.answer(name)
        has_none = value is None or reason == TOO_SMALL or name == "regime"
        spread = None if has_none else self.spread(name)
        if spread is None or any(answer.value is None for pair in spread.ends.values() for answer in pair):
            return None
        digits = digits or self.digits
        u = to_digits(min(digits or RIGHT_DIGITS, RIGHT_DIGITS))(CONTEXT.sqrt(spread.variance))
        return u if digits else to_double(u)

    def budget(self, name: str, round_: Rounding[Any] | None = None) -> dict[str, Any]:
        spread = self.spread(name) if self.uncertainty(name) else None
        if spread is None or not spread.steps or is_infinite(spread.variance):
            return {}
        with localcontext(CONTEXT):
            shares = {x: 100 * spread.steps.get(x, ZERO) ** 2 / spread.variance for x in self.uncertain}
        return {x: (round_ or self.round)(to_digits(RIGHT_DIGITS)(share)) for x, share in shares.items()}
