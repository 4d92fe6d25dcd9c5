"""The equations of a scene, each as the model has it, with numbers put in.

No equation is written here and nothing is computed: an equation is what the model does with symbols
(`symbolic`), and the numbers are the solver's.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from decimal import Decimal
from fractions import Fraction
from operator import attrgetter
from typing import TYPE_CHECKING, Any, NamedTuple

from ..arithmetic.interval import LARGEST_EXPONENT
from ..arithmetic.settling import settle
from ..arithmetic.symbolic import Formula, Symbol, Symbols, formula
from ..model.digits import SHOWN_DIGITS, as_typed, is_infinite, text, to_digits
from ..model.machine import Machine
from ..model.quantities import QUANTITIES
from .answers import Answers

if TYPE_CHECKING:
    from ..arithmetic.rational import Arithmetic, N

DOUBT = 3
"""Significant digits of a relative error (%)."""
TYPED = 17
"""Digits up to which an input is put in as it was typed."""
GUARD = 2
"""Digits that a number put in has beyond those of the result."""


class Law(NamedTuple):
    """An equation that no number is put into: in letters, or as its two sides."""

    label: str
    words: str | tuple[Formula, Formula]


class Equation(NamedTuple):
    """An equation worked out: symbols, the numbers put in, the result.

    ``numbers`` is None where they are too large to write. ``signs``, = or ≈, stand before the numbers
    and before the result.
    """

    label: str
    left: str
    formula: Formula
    numbers: Mapping[Symbol, Decimal] | None
    signs: str
    result: str
    unit: str


Part = str | Law | Equation


MOTION = ("acceleration", "tension_1", "tension_2")
"""What a scene answers first, and what simpler models are compared by."""
UNITS = {
    name: unit
    for unit, names in {
        "kg": "transfer limiting_transfer drive limiting_drive M c b",
        "N": "light_tension heavy_tension difference f_axle",
        "m/s²": "magnitude a |a| g",
        "rad": "phi alpha",
    }.items()
    for name in names.split()
}
"""Of what is not in the registry: of what the model computes by its name, of inputs by their symbols."""


NAMED = {
    "half_sine": "sin(φ/2)",
    "excess": "x",
    "massless_verge": "μ_0",
    "k1": "k - 1",
    "capstan_ratio": "k",
    "transfer": "z",
    "drive": "d",
    "alpha": "φ_lim",
    "critical_pulley_mass": "M*",
}
"""Symbols of what the model computes on the way, in every scene."""
LIMITS = {"f": 0, "b": 0, "D": 1}
"""What letters of `physics` stand for unless the axle rubs."""


class Derivation:
    """The equations of a scene, each as the model has it, with the solver's numbers.

    ``symbols`` are by the names that the model or `physics` has for them; those of inputs hold their values.
    ``found`` are those of inputs that follow from a measured motion. ``light`` and ``heavy`` are the
    indices of the masses. ``shown`` are the equations written so far, by name, ``explained`` the quantities
    whose absence has been explained.
    """

    def __init__(self, answers: Answers) -> None:
        self.answers, self.case, self.scene = answers, answers.case, answers.case.scene
        self.digits = answers.digits or SHOWN_DIGITS
        self.shown: set[str] = set()
        self.explained: set[str] = set()
        self.light, self.heavy = ("2", "1") if self.case.sign < 0 else ("1", "2")
        self.computed = self._symbols_of_the_machine()
        values = self._values()
        self.inputs = [Symbol(name, value) for name, value in values.items() if value is not None]
        motion = self.case.motion
        self.found = {"c", "M"} if motion.finds == "M" else {motion.finds}
        if motion.time is not None:
            self.found.add(self.computed["magnitude"])

    def _values(self) -> dict[str, Fraction | None]:
        """What is given or found, by the symbols of equations."""
        case, scene, motion = self.case, self.scene, self.case.motion
        return {
            "m1": scene.m1,
            "m2": scene.m2,
            "M": case.pulley_mass,
            "c": case.rim_mass,
            "β": case.beta,
            "μ": scene.mu,
            "μ_k": scene.mu_k,
            "g": scene.g,
            "I": scene.I,
            "R": scene.R,
            "f_axle": case.axle_friction if case.rubs else None,
            "b": case.axle_mass if case.rubs else None,
            self.computed["magnitude"]: case.measured_acceleration if motion.finds else None,
            "s": motion.drop,
            "t": motion.time,
            "τ_axle": scene.axle.number if scene.axle and scene.axle.unit == "N m" else None,
        }

    def _symbols_of_the_machine(self) -> dict[str, str]:
        """The symbols of what the model computes in this scene."""
        case, scene = self.case, self.scene
        symbols = NAMED | {
            "phi": "π" if scene.wrap.is_half_turn else "φ",
            "magnitude": "a" if case.sign >= 0 else "|a|",
            "light_tension": f"T{self.light}",
            "heavy_tension": f"T{self.heavy}",
            "difference": f"T{self.heavy} - T{self.light}",
            "tension_ratio": f"T{self.heavy}/T{self.light}",
            "rim_acceleration": "a_rim" if case.regime == "slip" else "a",
        }
        if case.regime != "verge":  # there it is the coefficient given
            symbols["mu_verge"] = "μ*"
        if case.slide_measured:
            symbols |= {"limiting_k1": "x_kin", "mu_k": "μ_k"}
        elif case.regime == "slip" and scene.mu_k is not None:
            kinetic = {"limiting_k1": "k_kin - 1", "limiting_transfer": "z_kin", "limiting_drive": "d_kin"}
            symbols |= kinetic
        return symbols

    def symbol(self, name: str) -> str:
        """What equations write for a quantity."""
        return self.computed.get(name) or plain(QUANTITIES[name].symbol)

    def formula(self, name: str, expanded: str = "") -> Formula:
        """The model's formula for a quantity, in the symbols of the inputs and of what else has a name.

        What is ``expanded`` is put in by its own formula.
        """
        arithmetic: Any = Symbols(self.inputs)
        known = {
            other: Formula("symbol", Symbol(symbol, other))
            for other, symbol in self.computed.items()
            if other not in (name, expanded)
        }
        formula: Formula = getattr(Machine(self.case, arithmetic, known), name)
        return formula

    def letter(self, letter: str) -> Formula:
        """The symbol for a letter of `physics`, or the number that it is in the limit at hand."""
        called = {
            "l": f"m{self.light}",
            "h": f"m{self.heavy}",
            "a": self.computed["magnitude"],
            "f": "f_axle",
        }
        name = called.get(letter, letter)
        given = {symbol.name: symbol for symbol in self.inputs}
        if letter in LIMITS and name not in given:
            return formula(LIMITS[letter])
        return Formula("symbol", given.get(name) or Symbol(name, name))

    def record(self, law: Callable[..., Any], letters: str) -> Formula:
        """The formula that an equation of `physics` gives on symbols."""
        recorded: Formula = law(*map(self.letter, letters.split()))
        return recorded

    def equation(self, name: str) -> Equation:
        """The equation of anything that the scene determines."""
        case, grips = self.case, self.case.regime == "no-slip"
        labels = {
            "magnitude": "(4)" if grips else "(1), (26)",
            "light_tension": "(1)",
            "difference": "(26)" if not grips else "(1)" if case.stands else "(3)",
            "tension_ratio": "",
            "k1": "(26)",
            "limiting_k1": "(1)" if case.slide_measured else "(26)",
            "massless_verge": "(27)",
        }
        if name == "critical_heavier_mass" and self.slips_at_rest:
            labels[name] = QUANTITIES["least_heavier_mass"].equation
        label = QUANTITIES[name].equation if name in QUANTITIES else ""
        return self.worked_out(Symbol(self.symbol(name), name), self.formula(name), labels.get(name, label))

    def by(self, name: str, law: Callable[..., Any], letters: str, label: str = "") -> Equation:
        """The equation of an input that follows from others, or of a quantity, as ``law`` gives it."""
        given = {symbol.name: symbol for symbol in self.inputs}
        result = given.get(name) or Symbol(self.symbol(name), name)
        return self.worked_out(result, self.record(law, letters), label)

    def worked_out(self, result: Symbol, formula: Formula, label: str) -> Equation:
        """The equation with numbers put in, unless they would be too large to write.

        The paper's number is marked where the friction of the axle enters its equation.
        """
        symbols = sorted(formula.symbols())
        if label and {"b", "f_axle"} & {symbol.name for symbol in symbols}:
            label = self.cite(label)
        left, unit = result.name, unit_of(result.of if isinstance(result.of, str) else result.name)
        value, exact = self.number(result, self.digits)
        if is_infinite(value):
            return Equation(label, left, formula, None, "=>", f"10^{LARGEST_EXPONENT}", unit)
        rounded = {symbol: self.number(symbol, self.digits + GUARD, TYPED) for symbol in symbols}
        numbers = {symbol: number for symbol, (number, _) in rounded.items()}
        if any(map(is_infinite, numbers.values())):
            return Equation(label, left, formula, None, "=≈", text(value), unit)
        put_in = "=" if all(is_exact for _, is_exact in rounded.values()) else "≈"
        signs = put_in + ("=" if exact and (put_in == "=" or not value) else "≈")
        return Equation(label, left, formula, numbers, signs, text(value), unit)

    def number(self, symbol: Symbol, digits: int, typed: int = 0) -> tuple[Decimal, bool]:
        """The number to put in for a symbol, and whether it is exact.

        An exact one of no more digits than wanted stays as it is, else it is correctly rounded to ``digits``.
        More than ``digits`` are wanted of an input, up to ``typed``.
        """
        if isinstance(symbol.of, Fraction):
            exact: Fraction | None = symbol.of
            keep = digits if symbol.name in self.found else max(digits, typed)
        else:
            exact, keep = self.answers.exactly(attrgetter(symbol.of)), digits
        if exact is not None and Fraction(to_digits(keep)(exact)) == exact:
            return Decimal(as_typed(exact)), True
        if isinstance(symbol.of, Fraction):
            return to_digits(digits)(symbol.of), False
        return Decimal(self.answers.to(digits).settle(attrgetter(symbol.of))), False

    def cite(self, label: str) -> str:
        """The number of an equation of the paper, marked if the axle rubs, which it does not there."""
        return f"{label}+b" if self.case.rubs else label

    @property
    def slips_at_rest(self) -> bool:
        """Whether the critical heavier mass makes the string slip on a pulley that stands."""
        return self.case.locked or self.case.slips_once_it_moves

    def lines(self, *names: str) -> Iterator[Equation]:
        """The equations of those that exist and have not been shown yet."""
        for name in names:
            if name in self.shown or (name in QUANTITIES and self.answers[name] is None):
                continue
            self.shown.add(name)
            yield self.equation(name)

    def motion(self, *names: str) -> Iterator[Part]:
        """The equations that end with the acceleration's magnitude, and its sign where it is negative."""
        yield from self.lines(*names)
        if self.case.sign < 0:
            yield f"`a` is positive when `m2` descends, so here it is negative, {self.say('acceleration')}."

    def compared(self, other: Answers) -> Iterator[Part]:
        """What another scene gives in place of this one, and by how much that is off."""
        for name in MOTION:
            here, there = (in_words(name, answers[name]) for answers in (self.answers, other))
            value = self.answers[name]
            off = f" ({self.off(other, name)} %)" if value else ""
            yield f"- `{plain(QUANTITIES[name].symbol)}` = {there} in place of {here}{off}"

    def off(self, other: Answers, name: str) -> str:
        """The relative error (%) of another scene's quantity, with its sign."""
        of = "magnitude" if name == "acceleration" else name

        def error(ar: Arithmetic[N]) -> N:
            here, there = (getattr(Machine(one.case, ar), of) for one in (self.answers, other))
            percent: N = 100 * (there - here) / here
            return percent

        shown = text(settle(error, to_digits(DOUBT), DOUBT))
        return shown if shown.startswith("-") else f"+{shown}"

    def say(self, name: str) -> str:
        """A symbol with its value, for a sentence."""
        known = name in QUANTITIES
        value = self.answers[name] if known else self.number(Symbol("", name), self.digits)[0]
        return f"`{self.symbol(name)}` = {in_words(name, value)}"


def unit_of(name: str) -> str:
    """The unit of a quantity, of what else the model computes, or of an input."""
    return QUANTITIES[name].unit if name in QUANTITIES else UNITS.get(name, "")


def in_words(name: str, value: Any) -> str:
    """A value with its unit."""
    return f"{text(value)} {unit_of(name)}".rstrip()


def plain(symbol: str) -> str:
    """The registry's symbol in plain letters, as equations write it."""
    letters = {"T₁": "T1", "T₂": "T2", "m₁": "m1", "m₂": "m2", "μ kin": "μ_k"}
    letters |= {"a rim": "a_rim", "Fx": "F_x", "Fy": "F_y"}
    return letters.get(symbol, symbol)
