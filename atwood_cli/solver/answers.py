"""The solver: settles the quantities of a scene, each when it is asked for."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from copy import copy
from decimal import Decimal
from fractions import Fraction
from functools import partial
from operator import attrgetter
from typing import TYPE_CHECKING, Any, NamedTuple

from ..numbers.digits import DOUBLE_DIGITS, SHOWN_DIGITS, Rounding, is_infinite, to_digits, to_double
from ..numbers.interval import LARGEST_EXPONENT
from ..numbers.settling import settle
from .decisions import Decisions
from .machine import Machine
from .quantities import FROM_MOTION, NAMES, NEED_BOTH_MASSES, NEEDS_MASSES, QUANTITIES, Undetermined
from .scene import IN_SI, NOT_GIVEN, Input, Scene, Unit, Units

if TYPE_CHECKING:
    from ..numbers.rational import Arithmetic, N, Quantity

    OnMachine = Callable[[Machine[Any]], Any]
    """A function of a machine in any arithmetic."""

TOO_LARGE = f"beyond 10^{LARGEST_EXPONENT}, the largest number written out"
TOO_SMALL = f"not 0 but too small to be written out: about 10^-{LARGEST_EXPONENT} or less"
ABOVE_DOUBLES = "beyond the range of doubles"
BELOW_DOUBLES = "not 0 but below the range of doubles"


class Answer(NamedTuple):
    """A quantity: its value, and why that is None or cannot be shown as it is."""

    value: Any
    reason: str = ""


def _in_unit(quantity: OnMachine, unit: Unit, machine: Machine[N]) -> N:
    """Return a number in another unit, which may be one of other terms."""
    value = quantity(machine)
    if unit.terms:
        value = unit.terms.number(value, machine.ar.number(getattr(machine.scene, unit.terms.by)))
    in_unit: N = value / machine.ar.number(unit.size)
    return in_unit


class Answers:
    """The quantities of a scene, each computed when it is asked for: as doubles, or to ``digits`` digits.

    Of the ``inputs`` as they were given, none of which is needed here, pages have the units. Values are in
    SI units and degrees, or those in ``units`` in another unit.
    """

    def __init__(
        self, scene: Scene, digits: int | None = None, inputs: Mapping[str, Input] = {}, units: Units = IN_SI
    ) -> None:
        self.decided, self.inputs, self.units = Decisions(scene), inputs, units
        self._machines: dict[Arithmetic[Any], Machine[Any]] = {}
        self._by_digits: dict[int | None, Answers] = {}
        self._round_to(digits)

    def _round_to(self, digits: int | None) -> None:
        self.digits = digits
        self._computed = max(digits or 0, DOUBLE_DIGITS)  # so that fewer need no second computation
        self.round: Rounding[Any] = to_double if digits is None else to_digits(digits)
        self._answers: dict[str, Answer] = {}

    def rounded_to(self, digits: int | None) -> Answers:
        """Return the same quantities to so many digits; all that the machines computed is shared."""
        if digits not in self._by_digits:
            self._by_digits[digits] = copy(self)
            self._by_digits[digits]._round_to(digits)
        return self._by_digits[digits]

    def in_units(self, units: Units) -> Answers:
        """Return the same quantities in these units, others in SI units and degrees."""
        if units == self.units:
            return self
        return type(self)(self.decided.scene, self.digits, self.inputs, units)

    def unit_of(self, name: str) -> str:
        """Return the unit of a quantity's value."""
        return self.units[name].in_words if name in self.units else QUANTITIES[name].unit

    def quantity(self, name: str) -> OnMachine:
        """Return a quantity as a number of a machine, in its unit."""
        return self.in_its_unit(name, attrgetter(name))

    def in_its_unit(self, name: str, quantity: OnMachine) -> OnMachine:
        """Return a number of a machine in the unit in which what has this name is asked for."""
        return partial(_in_unit, quantity, self.units[name]) if name in self.units else quantity

    def typed(self, x: str) -> Input:
        """Return an input as it was given."""
        return self.inputs.get(x, NOT_GIVEN)

    @property
    def to_six_digits(self) -> Answers:
        """The same answers to six digits, unless digits were asked for."""
        return self.rounded_to(SHOWN_DIGITS) if self.digits is None else self

    @property
    def names(self) -> tuple[str, ...]:
        """The quantities that every scene has, then those that follow from measurements."""
        motion = self.decided.motion
        fall = (x for x in FROM_MOTION["fall"] if motion.fall and (x != "drop" or motion.drop is None))
        return (*NAMES, *FROM_MOTION.get(motion.finds, ()), *fall)

    def __getitem__(self, name: str) -> Any:
        """Return the value of a quantity by its name, None if it has none."""
        return self.answer(name).value

    def answer(self, name: str) -> Answer:
        """Return the value of a quantity, and why it is missing."""
        if self.decided.lacking and name in NEED_BOTH_MASSES:
            return Answer(None, NEEDS_MASSES)
        if name == "regime":
            return Answer(self.decided.regime)
        if name not in self._answers:
            self._answers[name] = Answer(*self._settled(self.quantity(name)))
        return self._answers[name]

    def _settled(self, quantity: OnMachine) -> tuple[Any, str]:
        """Return the rounded value of a quantity, or None, and why it cannot be shown as it is."""
        in_any_arithmetic = self.in_any_arithmetic(quantity)
        try:
            value = settle(in_any_arithmetic, self.round, self._computed)
        except Undetermined as undetermined:
            return None, str(undetermined)
        except OverflowError:  # of a denominator
            return 0.0 if self.digits is None else None, TOO_SMALL
        if is_infinite(value):
            return value, ABOVE_DOUBLES if self.digits is None else TOO_LARGE
        below = value == 0 and self.digits is None and settle(in_any_arithmetic, to_digits(1), DOUBLE_DIGITS)
        return value, BELOW_DOUBLES if below else ""

    # Inputs are exact. `UncertainAnswers` has another answer to these.

    uncertain: Mapping[str, Fraction] = {}
    """The standard uncertainties of inputs that have one."""

    def uncertainty(self, name: str, digits: int | None = None) -> Any:
        """Return the standard uncertainty of a quantity, None if it has none."""
        return None

    def budget(self, name: str, round_: Rounding[Any] | None = None) -> dict[str, Any]:
        """Return the percentage of each uncertain input in a variance, {} if there is none or it is 0."""
        return {}

    def ends_at(self, n: int) -> Mapping[str, tuple[Any, Any]]:
        """Return the scenes with each uncertain input n standard uncertainties less, and more."""
        return {}

    def spread(self, name: str) -> Any:
        """Return the values of a quantity at these ends, None if there are none."""
        return None

    def rounded(self, name: str, round_: Rounding[Decimal]) -> Decimal:
        """Return the value of a quantity that exists, rounded in another way."""
        return Decimal(self.settle(self.quantity(name), round_))

    def settle(self, quantity: OnMachine, round_: Rounding[Any] | None = None) -> float | Decimal:
        """Return any number of a machine, rounded as quantities are or by ``round_``. Raises Undetermined."""
        value: float | Decimal = settle(
            self.in_any_arithmetic(quantity), round_ or self.round, self._computed
        )
        return value

    def in_any_arithmetic(self, quantity: OnMachine) -> Quantity:
        """Return any number of a machine as a function of the arithmetic."""

        def of(ar: Arithmetic[N]) -> N:
            if ar not in self._machines:
                self._machines[ar] = Machine(self.decided, ar)
            value: N = quantity(self._machines[ar])
            return value

        return of
