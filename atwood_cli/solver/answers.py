"""The solver: settles the quantities of a scene, each when it is asked for."""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping
from copy import copy
from decimal import Decimal
from fractions import Fraction
from operator import attrgetter
from typing import TYPE_CHECKING, Any

from ..arithmetic.interval import LARGEST_EXPONENT
from ..arithmetic.lazy import lazy
from ..arithmetic.rational import EXACT, Irrational
from ..arithmetic.settling import is_positive, settle
from ..model.case import Case
from ..model.digits import DOUBLE_DIGITS, SHOWN_DIGITS, Rounding, is_infinite, to_digits, to_double
from ..model.machine import Machine
from ..model.quantities import FROM_MOTION, MAIN, NAMES
from ..model.reasons import Undetermined
from ..model.scene import INPUTS, MEASURED, UNMEASURED, Given, Input, Motion, Scene, SceneError, read_input
from ..model.units import STANDARD_GRAVITY, read_number

if TYPE_CHECKING:
    from ..arithmetic.rational import Arithmetic, N, Quantity
    from .uncertainty import OnMachine, Uncertainties

TOO_LARGE = f"beyond 10^{LARGEST_EXPONENT}, the largest number written out"
TOO_SMALL = f"not 0 but too small to be written out: about 10^-{LARGEST_EXPONENT} or less"
ABOVE_DOUBLES = "beyond the range of doubles; ask for digits (--digits 17) to see it"
BELOW_DOUBLES = "not 0 but below the range of doubles; ask for digits (--digits 17) to see it"


class Answers:
    """The quantities of a scene, settled when asked for: to doubles or to ``digits`` digits.

    ``uncertain`` has the standard uncertainties of the inputs that have one. Of the quantities asked for,
    ``reasons`` says by name why one shows no value, ``unsure`` why one shows no uncertainty, ``open_ended``
    names those without a value at an end of an input, and ``spread`` has the uncertainties.
    """

    def __init__(
        self,
        scene: Scene,
        digits: int | None = None,
        motion: Motion = UNMEASURED,
        uncertain: Mapping[str, Fraction] = {},
    ) -> None:
        self.case, self.uncertain = Case(scene, motion), uncertain
        self._machines: dict[Arithmetic[Any], Machine[Any]] = {}
        self._round_to(digits)

    @lazy
    def uncertainties(self) -> Uncertainties | None:
        """The uncertainties of quantities; None where all inputs are exact."""
        if not self.uncertain:
            return None
        from .uncertainty import Uncertainties

        return Uncertainties(self.case, self.uncertain)

    def _round_to(self, digits: int | None) -> None:
        self.digits = digits
        self._computed = max(digits or 0, DOUBLE_DIGITS)  # so that fewer need no second computation
        self.round: Rounding[Any] = to_double if digits is None else to_digits(digits)
        self._values: dict[str, Any] = {}
        self.reasons: dict[str, str] = {}
        self.unsure: dict[str, str] = {}
        self.spread: dict[str, Any] = {}
        self.open_ended: dict[str, None] = {}

    def to(self, digits: int | None) -> Answers:
        """The same quantities to so many digits; they share the machines, and so what these computed."""
        other = copy(self)
        vars(other).pop("shown", None)
        other._round_to(digits)
        return other

    @property
    def given(self) -> tuple[Scene, int | None, Motion, Mapping[str, Fraction]]:
        """What the answers are made from."""
        return self.case.scene, self.digits, self.case.motion, self.uncertain

    @lazy
    def shown(self) -> Answers:
        """The same as tables and sentences show them: to a person, all digits of a double are too many."""
        return self.to(SHOWN_DIGITS) if self.digits is None else self

    @property
    def names(self) -> tuple[str, ...]:
        """The quantities that every scene has, then those that follow from what was measured."""
        motion = self.case.motion
        drop = "drop" if motion.drop is not None else None
        return (*NAMES, *FROM_MOTION.get(motion.finds, ()), *FROM_MOTION.get(drop, ()))

    @property
    def found(self) -> tuple[str, ...]:
        """The quantities that were asked for by what is given of the motion, the unknown parameter first."""
        by_time = {"fall_time": "acceleration"} if self.case.motion.time is not None else {}
        return tuple(by_time.get(name, name) for name in self.names[len(NAMES) :])

    @property
    def main(self) -> tuple[str, ...]:
        """The quantities that the scene is about: what a table shows unless all are asked for."""
        case, scene = self.case, self.case.scene
        has_mu = scene.mu is not None
        bounded = has_mu and "friction_force" in [name for name in MAIN if self[name] is None]
        also = {
            "friction_force_min": bounded,
            "friction_force_max": bounded,
            "axle_force": case.rubs and case.ends_hang_down,
            "torque": scene.R is not None,
            "rim_acceleration": case.regime == "slip",
            "angular_acceleration": scene.R is not None,
            "critical_pulley_mass": has_mu,
            "critical_heavier_mass": has_mu and case.pulley_known,
            "safety_factor": has_mu and case.pulley_known and not case.tensions_equal,
            "least_wrap": has_mu and not scene.wrap.is_half_turn,
        }
        return tuple(name for name in self.names[1:] if also.get(name, name in MAIN or name not in NAMES))

    @property
    def asked(self) -> Container[str]:
        """The quantities asked for so far."""
        return self._values.keys()

    def __getitem__(self, name: str) -> Any:
        """The value of a quantity by its name, None where ``reasons`` says why there is none."""
        if name == "regime":
            return self.case.regime
        if name not in self._values:
            value, reason = self._settled(self._on_machines(attrgetter(name)), self.round)
            if reason:
                self.reasons[name] = reason
            self._values[name] = value
        return self._values[name]

    def _settled(self, quantity: Quantity, round_: Rounding[Any]) -> tuple[Any, str]:
        """The rounded value of a quantity, or None; and if it cannot be shown as it is, why."""
        try:
            value = settle(quantity, round_, self._computed)
        except Undetermined as undetermined:
            return None, str(undetermined)
        except OverflowError:  # of a denominator
            return 0.0 if self.digits is None else None, TOO_SMALL
        if is_infinite(value):
            return value, ABOVE_DOUBLES if self.digits is None else TOO_LARGE
        below = value == 0 and self.digits is None and settle(quantity, to_digits(1), DOUBLE_DIGITS)
        return value, BELOW_DOUBLES if below else ""

    def uncertainty(self, name: str, round_: Rounding[Any] | None = None) -> Any:
        """The standard uncertainty of a quantity; None where there is none, or no value either."""
        value, known, quantity = self[name], self.uncertainties, attrgetter(name)
        if known is None or value is None or self.reasons.get(name) == TOO_SMALL:
            return None
        if is_infinite(value) and is_infinite(self.settle(quantity, to_digits(1))):
            return None
        if not known.exists(quantity):
            self.open_ended[name] = None
            return None
        u, reason = self._settled(known.of(quantity), round_ or self.round)
        if u is not None:
            self.spread[name] = u
        if reason:
            self.unsure[name] = reason
        return u

    def standard_uncertainties(self, names: Iterable[str]) -> dict[str, Any]:
        """The standard uncertainties of the quantities named; empty where all inputs are exact."""
        if self.uncertainties is None:
            return {}
        return {name: self.uncertainty(name) for name in names if name != "regime"}

    def budget(self, name: str, round_: Rounding[Any] | None = None) -> dict[str, Any]:
        """The percentage of each uncertain input in the variance of a quantity; empty if that is 0."""
        known = self.uncertainties
        if known is None or not self.uncertainty(name, to_digits(1)):
            return {}
        percents = {x: known.percent(attrgetter(name), x) for x in known.given}
        return {x: settle(percent, round_ or self.round, self._computed) for x, percent in percents.items()}

    def rounded(self, name: str, round_: Rounding[Decimal]) -> Decimal:
        """The value of a quantity that exists, rounded in another way."""
        return Decimal(self.settle(attrgetter(name), round_))

    def settle(self, quantity: OnMachine, round_: Rounding[Any] | None = None) -> float | Decimal:
        """Anything that a machine has, rounded as quantities are or in another way. Raises Undetermined."""
        value: float | Decimal = settle(self._on_machines(quantity), round_ or self.round, self._computed)
        return value

    def exactly(self, quantity: OnMachine) -> Fraction | None:
        """Anything that a machine has, unrounded; None unless its formula is rational."""
        try:
            value: Fraction = self._on_machines(quantity)(EXACT)
        except Irrational:
            return None
        return value

    def is_positive(self, quantity: OnMachine) -> bool:
        """Whether anything that a machine has, and that is known to be irrational, is positive."""
        return is_positive(self._on_machines(quantity))

    def _on_machines(self, quantity: OnMachine) -> Quantity:
        def of(ar: Arithmetic[N]) -> N:
            if ar not in self._machines:
                self._machines[ar] = Machine(self.case, ar)
            value: N = quantity(self._machines[ar])
            return value

        return of

    def with_pulley(self, mass: Fraction | float) -> Answers:
        """The answers to this scene on a pulley of that mass (inf: locked), with a string that grips."""
        return Answers(self.case.scene._replace(M=mass, mu=None, mu_k=None), self.digits)


def read_answers(given: Mapping[str, Given | None], digits: int | None) -> Answers:
    """The answers to what is given, with uncertainties where an input has one. Raises SceneError."""
    inputs = {name: read_input(name, given.get(name)) for name in (*INPUTS, *MEASURED)}
    inputs["a"] = _of_gravity(inputs["a"], inputs["g"])
    if all(inputs[name].given is None for name in MEASURED):
        scene, motion = Scene.of(inputs), UNMEASURED
    else:
        from ..model import motion as motions

        scene, motion = motions.read(inputs)
        scene = motions.completed(scene, motion)
    uncertain = {name: read.uncertainty for name, read in inputs.items() if read.uncertainty}
    return Answers(scene, digits, motion, uncertain)


def _of_gravity(a: Input, g: Input) -> Input:
    """An acceleration; if it was typed as a multiple of g, that of the scene. Raises SceneError."""
    if not isinstance(a.given, str) or read_number(a.given, "acceleration").unit != "g":
        return a
    if g.uncertainty:
        raise SceneError("a", a.given, "is a multiple of g, which is uncertain; give it in m/s2")
    factor = g.value / Fraction(STANDARD_GRAVITY)
    return a._replace(value=a.value * factor, uncertainty=a.uncertainty * factor)
