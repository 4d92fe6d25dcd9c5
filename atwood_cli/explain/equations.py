"""Write the equations of a scene, each as the model has it, with numbers put in.

An equation is what the model does with symbols (`formula`), and the numbers are the solver's.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from decimal import Decimal
from fractions import Fraction
from operator import attrgetter
from typing import Any, NamedTuple

from ..numbers.digits import SHOWN_DIGITS, as_typed, format_number, is_infinite, to_digits
from ..numbers.formula import Formula, Symbol, Symbols, formula
from ..numbers.rational import EXACT, Irrational
from ..solver.answers import Answers
from ..solver.machine import Machine
from ..solver.quantities import QUANTITIES
from ..solver.scene import FALL
from .given import WEIGHTS

INPUT_DIGITS = 17
"""Digits up to which an input is put in as it was typed."""
EXTRA_DIGITS = 2
"""Digits that a number put in has beyond those of the result."""


class Equation(NamedTuple):
    """An equation with the paper's number: a law, or a value worked out.

    A side is a formula, or letters, and the right one of a value may be missing. A law has no ``result``.
    ``numbers`` are those of the symbols in the formula of a value. ``signs``, = or ≈, stand before the
    numbers and before the result. ``follows`` are symbols that it rests on besides those of its formulas.
    """

    label: str
    left: str | Formula
    right: str | Formula | None
    follows: tuple[str, ...] = ()
    numbers: Mapping[Symbol, Decimal] = {}
    signs: str = "=="
    result: str = ""
    unit: str = ""

    @property
    def needs(self) -> set[str]:
        """The symbols that the equation rests on."""
        formulas = [side for side in (self.left, self.right) if isinstance(side, Formula)]
        symbols = {symbol.name for side in formulas for symbol in side.symbols()}
        return symbols.union(self.follows)


MOTION = ("acceleration", "tension_1", "tension_2")
"""Quantities that a derivation gives first."""
INTERMEDIATE = {
    "half_sine": ("sin(φ/2)", ""),
    "phi": ("{phi}", "rad"),
    "ratio_minus_1": ("x", ""),
    "mu_verge_massless": ("μ_0", ""),
    "limiting_arc": ("φ_lim", "rad"),
    "k_minus_1": ("k - 1", ""),
    "friction_mass": ("z", "kg"),
    "drive": ("d", "kg"),
    "limiting_k_minus_1": ("k{kin} - 1", ""),
    "limiting_friction_mass": ("z{kin}", "kg"),
    "limiting_drive": ("d{kin}", "kg"),
    "magnitude": ("{a}", "m/s²"),
    "light_tension": ("T{l}", "N"),
    "heavy_tension": ("T{h}", "N"),
    "difference": ("T{h} - T{l}", "N"),
    "tension_ratio": ("T{h}/T{l}", ""),
}
"""The symbols and units of intermediate values, by the machine's names; braces hold `Derivation.words`."""
UNIT_BY_SYMBOL = {
    **{"M": "kg", "c": "kg", "b": "kg", "f_axle": "N", "I": "kg m²", "g": "m/s²", "v": "m/s"},
    **dict.fromkeys(("a", "|a|", "a_1"), "m/s²"),
}
"""The units of inputs."""
REFERRED_TO = ("capstan_ratio", "critical_pulley_mass", "mu_verge")
"""Quantities that equations of others refer to."""
WITHOUT_AXLE_FRICTION = {"f_axle": 0, "b": 0, "D": 1}
"""Values of symbols if the axle has no friction."""


class Derivation:
    """Write the equations of a scene, each once, with the solver's numbers.

    ``inputs`` are the symbols with their values. ``words`` are parts of symbols that depend on the scene, as
    l and h, the indices of the masses. ``shown`` are the names of equations written.
    """

    def __init__(self, answers: Answers) -> None:
        self.answers, self.decided, self.scene = answers, answers.decided, answers.decided.scene
        self.digits = answers.digits or SHOWN_DIGITS
        self.shown: set[str] = set()
        self.words = self._words()
        self.symbols = self._symbols()
        self.inputs = {name: Symbol(name, x) for name, x in self._values().items() if x is not None}

    def _values(self) -> dict[str, Fraction | None]:
        """Return what is given or found, by symbol."""
        decided, scene, motion = self.decided, self.scene, self.decided.motion
        terms = {
            WEIGHTS.get(x, kind.symbol): scene.as_given(x) * decided.heavier_side
            if x == "a"
            else abs(scene.as_given(x))
            for x, kind in scene.terms
        }
        return {
            **{name: getattr(scene, name) for name in ("m1", "m2", "g", "I", "R")},
            "M": decided.pulley_mass,
            "c": decided.rim_mass,
            "β": decided.beta,
            "μ": scene.mu,
            "μ_k": scene.mu_k,
            "f_axle": decided.axle_friction if decided.has_axle_friction else None,
            "b": decided.axle_mass if decided.has_axle_friction else None,
            self.words["a"]: decided.measured_acceleration if motion.finds else None,
            **{symbol: decided.fall.get(name) for symbol, name in zip("stv", FALL, strict=True)},
            **terms,
        }

    def _words(self) -> dict[str, str]:
        decided = self.decided
        m1_is_heavier, may_be_negative = decided.heavier_side < 0, decided.slows_down or decided.is_driven
        return {
            "l": "2" if m1_is_heavier else "1",
            "h": "1" if m1_is_heavier else "2",
            "a": ("a_1" if may_be_negative else "|a|") if m1_is_heavier else "a",
            "phi": "π" if self.scene.wrap.is_half_turn else "φ",
            "kin": "_kin" if decided.slides_by_mu_k else "",
        }

    def _symbols(self) -> dict[str, str]:
        """Return the symbols that are not in the table of quantities, or differ from it in this scene."""
        decided = self.decided
        fall = {"drop": decided.motion.drop, "final_speed": decided.motion.speed}
        referred_to = [*REFERRED_TO, *(name for name, given in fall.items() if given is None)]
        symbols = {name: symbol.format(**self.words) for name, (symbol, _) in INTERMEDIATE.items()} | {
            "rim_acceleration": "a_rim" if decided.regime == "slip" else "a",
            **{name: QUANTITIES[name].letters for name in referred_to},
        }
        if decided.is_driven:
            symbols |= {"acceleration": "a", "tension_difference": "T2 - T1", "drive_force": "F_drive"}
        if decided.slide_measured:
            symbols |= {"limiting_k_minus_1": "x_kin", "mu_k": "μ_k"}
        return symbols

    def symbol(self, name: str) -> str:
        return self.symbols.get(name) or QUANTITIES[name].letters

    def formula(self, symbol: str) -> Formula:
        """Return the formula of a symbol, or of its value without axle friction."""
        if symbol in WITHOUT_AXLE_FRICTION and symbol not in self.inputs:
            return formula(WITHOUT_AXLE_FRICTION[symbol])
        return Formula("symbol", self.inputs.get(symbol, Symbol(symbol, symbol)))

    def record(self, law: Callable[..., Any], symbols: str) -> Formula:
        """Return the formula that an equation of `physics` gives on symbols."""
        recorded: Formula = law(*map(self.formula, symbols.split()))
        return recorded

    def _formula(self, name: str) -> Formula:
        """Return the model's formula for a quantity, in the symbols of inputs and of other quantities."""
        arithmetic: Any = Symbols([*self.inputs.values()])
        known = {other: Formula("symbol", Symbol(symbol, other)) for other, symbol in self.symbols.items()}
        known.pop(name, None)
        recorded: Formula = getattr(Machine(self.decided, arithmetic, known), name)
        return recorded

    def by(self, label: str, name: str, law: Callable[..., Any], symbols: str) -> Equation:
        """Return the equation of an input that follows from others, or of a quantity, by a law."""
        result = self.inputs[name] if name in self.inputs else Symbol(self.symbol(name), name)
        return self._worked_out(label, result, self.record(law, symbols))

    def _worked_out(
        self, label: str, result: Symbol, recorded: Formula | None, follows: tuple[str, ...] = ()
    ) -> Equation:
        """Return the equation with numbers put in; without a formula if there is none, or no symbol in it."""
        value, exact = self.number(result, self.digits)
        rounded = {
            symbol: self.number(symbol, self.digits + EXTRA_DIGITS, INPUT_DIGITS)
            for symbol in (sorted(recorded.symbols()) if recorded else ())
        }
        numbers = {symbol: number for symbol, (number, _) in rounded.items()}
        put_in = "=" if all(is_exact for _, is_exact in rounded.values()) else "≈"
        signs = put_in + ("=" if not value or (exact and put_in == "=") else "≈")
        unit = unit_of(result.of if isinstance(result.of, str) else result.name)
        right = recorded if numbers else None
        return Equation(label, result.name, right, follows, numbers, signs, format_number(value), unit)

    def number(self, symbol: Symbol, digits: int, typed: int = 0) -> tuple[Decimal, bool]:
        """Return the number to put in for a symbol, and whether it is exact.

        An exact one of no more digits than wanted stays as it is, else it is correctly rounded to ``digits``.
        More than ``digits`` are wanted of an input, up to ``typed``.
        """
        keep = digits
        if isinstance(symbol.of, Fraction):
            exact, keep = symbol.of, max(digits, typed)
        else:
            quantity = attrgetter(symbol.of)
            try:
                exact = self.answers.in_any_arithmetic(quantity)(EXACT)
            except Irrational:
                return Decimal(self.answers.rounded_to(digits).settle(quantity)), False
        if Fraction(to_digits(keep)(exact)) == exact:
            return Decimal(as_typed(exact)), True
        return to_digits(digits)(exact), False

    def exists(self, name: str) -> bool:
        """Decide whether the scene determines a value that can be written out."""
        if name in QUANTITIES and self.answers[name] is None:
            return False
        return not is_infinite(self.number(Symbol("", name), self.digits)[0])

    def values(self, label: str, name: str, follows: tuple[str, ...] = ()) -> Iterator[Equation]:
        """Yield the equation of a value that exists, can be written out and has not been shown yet.

        Only the result is shown if it is said from which symbols it ``follows``.
        """
        if name in self.shown or not self.exists(name):
            return
        self.shown.add(name)
        recorded = None if follows else self._formula(name)
        yield self._worked_out(label, Symbol(self.symbol(name), name), recorded, follows)

    def say(self, name: str) -> str:
        """Return a quantity's symbol with its value, for a sentence."""
        value, exact = self.number(Symbol("", name), self.digits)
        sign = "=" if exact or not value else "≈"
        return f"`{self.symbol(name)}` {sign} {format_number(value)} {unit_of(name)}".rstrip()


def unit_of(name: str) -> str:
    """Return the unit of a quantity, an intermediate value or an input."""
    if name in QUANTITIES:
        return QUANTITIES[name].unit
    return INTERMEDIATE[name][1] if name in INTERMEDIATE else UNIT_BY_SYMBOL.get(name, "")
