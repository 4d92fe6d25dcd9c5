"""The equations of a scene, each as the model has it, with numbers put in that give its result.

No equation is written here, and nothing is computed but how many digits a line needs: an equation is what
the model does with symbols (`symbolic`), and the numbers are the solver's.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from decimal import Decimal
from fractions import Fraction
from functools import reduce
from operator import attrgetter, mul
from typing import TYPE_CHECKING, Any, NamedTuple

from ..arithmetic.interval import LARGEST_EXPONENT, Unsettled, enclosures
from ..arithmetic.rounding import as_typed, is_infinite, settle, text, to_digits
from ..arithmetic.symbolic import Formula, Symbol, Symbols, factors
from ..model import physics
from ..model.machine import Machine
from ..model.quantities import QUANTITIES
from ..solver.answers import SHOWN_DIGITS, Answers

if TYPE_CHECKING:
    from ..arithmetic.protocol import Arithmetic, N

DOUBT = 3
"""Significant digits of a relative error (%)."""
TYPED = 17
"""Digits up to which an input is put in as it was typed."""
LONGEST = 1000
"""Most digits that a number put in may have beyond those of the result; a difference may take many."""


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


HELD = "\x1f"
"""Stands for a blank at which no line breaks: an ASCII character, which every stream takes."""

Part = str | Law | Equation


INTERMEDIATE = {
    "k1": ("(26)", ""),
    "limiting_k1": ("(26)", ""),
    "transfer": ("", "kg"),
    "limiting_transfer": ("", "kg"),
    "drive": ("", "kg"),
    "limiting_drive": ("", "kg"),
    "excess": ("", ""),
    "massless_verge": ("(27)", ""),
    "alpha": ("", "rad"),
}
"""The paper's number, if it is the paper's equation, and the unit of what is not in the registry."""
IN_THE_PAPER: dict[str, tuple[Callable[..., Any], str]] = {
    "tension_ratio": (physics.ratio_in_the_paper, "l h M"),
    "critical_pulley_mass": (physics.pulley_mass_in_the_paper, "l h k"),
    "critical_heavier_mass": (physics.heavier_mass_in_the_paper, "l M k"),
}
"""Quantities that the paper has in another form, for a disk: that form, and what it is made of."""


class Derivation:
    """The equations of a scene, each as the model has it, with the solver's numbers.

    ``names`` are the symbols of what the model computes, ``inputs`` those of what is given, of which
    ``found`` follow from a measured motion, ``light`` and ``heavy`` the indices of the masses.
    ``shown`` are the equations written so far, by name, ``explained`` the quantities whose absence has been
    explained.
    """

    def __init__(self, answers: Answers) -> None:
        self.answers, self.case, self.scene = answers, answers.case, answers.case.scene
        self.digits = answers.digits or SHOWN_DIGITS
        self._finer = {self.digits: answers}
        self.shown: set[str] = set()
        self.explained: set[str] = set()
        case, scene = self.case, self.scene
        self.light, self.heavy = ("2", "1") if case.sign < 0 else ("1", "2")
        magnitude = "a" if case.sign >= 0 else "|a|"
        values = {
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
            "f_axle": case.axle_friction,
            "b": case.axle_mass,
            magnitude: case.measured_acceleration if case.motion.finds else None,
            "s": case.motion.drop,
            "t": case.motion.time,
        }
        self.inputs = {name: Symbol(name, value) for name, value in values.items() if value is not None}
        self.found = {"c", "M"} if case.motion.finds == "M" else {case.motion.finds}
        if case.motion.time is not None:
            self.found.add(magnitude)
        names = {
            "phi": "π" if self.half_turn else "φ",
            "half_sine": "sin(φ/2)",
            "magnitude": magnitude,
            "light_tension": f"T{self.light}",
            "heavy_tension": f"T{self.heavy}",
            "difference": f"T{self.heavy} - T{self.light}",
            "rim_acceleration": "a_rim" if case.regime == "slip" else "a",
            "excess": "x",
            "mu_verge": "μ*",
            "massless_verge": "μ_0",
            "k1": "k - 1",
            "capstan_ratio": "k",
            "tension_ratio": f"T{self.heavy}/T{self.light}",
            "transfer": "z",
            "drive": "d",
            "alpha": "φ_lim",
            "critical_pulley_mass": "M*",
        }
        if case.regime == "slip" and scene.mu_k is not None:
            names |= {"limiting_k1": "k_kin - 1", "limiting_transfer": "z_kin", "limiting_drive": "d_kin"}
        if case.regime == "verge":
            del names["mu_verge"]  # it is the coefficient given
        if case.slide_measured:
            names |= {"limiting_k1": "x_kin", "mu_k": "μ_k"}
        self.names = names

    @property
    def masses(self) -> tuple[Symbol, Symbol]:
        """The symbols of the lighter and the heavier mass."""
        return self.inputs[f"m{self.light}"], self.inputs[f"m{self.heavy}"]

    def symbol(self, name: str) -> str:
        """What equations write for a quantity."""
        return self.names.get(name) or plain(QUANTITIES[name].symbol)

    @property
    def half_turn(self) -> bool:
        return self.scene.wrap.is_half_turn

    def formula(self, name: str, expanded: str = "") -> Formula:
        """The model's formula for a quantity, in the symbols of the inputs and of what else has a name.

        What is ``expanded`` is put in by its own formula.
        """
        arithmetic: Any = Symbols(list(self.inputs.values()))
        known = {
            other: Formula("symbol", Symbol(symbol, other))
            for other, symbol in self.names.items()
            if other not in (name, expanded)
        }
        formula: Formula = getattr(Machine(self.case, arithmetic, known), name)
        return formula

    def equation(self, name: str) -> Equation:
        """The equation of anything that the scene determines."""
        grips, moves = self.case.regime == "no-slip", not self.case.stands
        own = INTERMEDIATE | {
            "magnitude": ("(4)" if grips else "(1), (26)", "m/s²"),
            "light_tension": ("(1)", "N"),
            "heavy_tension": ("", "N"),
            "difference": (("(3)" if moves else "(1)") if grips else "(26)", "N"),
            "tension_ratio": ("", ""),
        }
        if name in own:
            label, unit = own[name]
        else:
            label, unit = QUANTITIES[name].equation, QUANTITIES[name].unit
        if name == "critical_heavier_mass" and self.slips_at_rest:
            label = QUANTITIES["least_heavier_mass"].equation
        if name == "limiting_k1" and self.case.slide_measured:
            label = "(1)"
        symbol = self.symbol(name)
        return self.worked_out(label, symbol, self.formula(name), Symbol(symbol, name), unit)

    def worked_out(self, label: str, left: str, formula: Formula, result: Symbol, unit: str) -> Equation:
        """The equation with numbers put in, each with as many digits as give the result shown.

        No numbers where they would be too large to write, or longer than anybody reads. The paper's number
        is marked where the friction of the axle enters its equation.
        """
        if label and any(symbol.name in ("b", "f_axle") for symbol in formula.symbols()):
            label = self.cite(label)
        value, exact = self.number(result, self.digits, self.digits)
        if is_infinite(value):
            return Equation(label, left, formula, None, "=>", f"10^{LARGEST_EXPONENT}", unit)
        symbols, digits = sorted(formula.symbols()), self.digits
        while True:
            rounded = {symbol: self.number(symbol, digits, max(digits, TYPED)) for symbol in symbols}
            numbers = {symbol: number for symbol, (number, _) in rounded.items()}
            if any(map(is_infinite, numbers.values())) or digits > self.digits + LONGEST:
                return Equation(label, left, formula, None, "=≈", text(value), unit)
            if self._gives(formula, numbers, value):
                break
            digits += 1 + digits // 16
        put_in = "=" if all(is_exact for _, is_exact in rounded.values()) else "≈"
        signs = put_in + ("=" if exact and (put_in == "=" or not value) else "≈")
        return Equation(label, left, formula, numbers, signs, text(value), unit)

    def _gives(self, formula: Formula, numbers: Mapping[Symbol, Decimal], result: Decimal) -> bool:
        """Whether the formula of these numbers gives the printed result, to half a unit of its last digit."""
        longest = max((len(number.as_tuple().digits) for number in numbers.values()), default=0)
        precision = 2 * (longest + self.digits) + 20
        try:
            value = formula.worked_out(enclosures(precision), numbers)
        except (Unsettled, ZeroDivisionError):  # rounded, c - 2z can be 0 or less, which it is not
            return False
        if not result:
            return value.lo == value.hi == 0
        at = enclosures(precision).up
        half = at.multiply(Decimal("0.500001"), Decimal((0, (1,), result.adjusted() - self.digits + 1)))
        return at.subtract(value.hi, result) <= half and at.subtract(result, value.lo) <= half

    def number(self, symbol: Symbol, digits: int, typed: int) -> tuple[Decimal, bool]:
        """The number to put in for a symbol, and whether it is exact.

        An exact one of no more digits than wanted stays as it is, else it is correctly rounded to ``digits``.
        For an input ``typed`` digits are few enough, for a computed quantity ``digits``.
        """
        if isinstance(symbol.of, Fraction):
            exact: Fraction | None = symbol.of
            keep = digits if symbol.name in self.found else typed
        else:
            exact, keep = self.answers.exactly(attrgetter(str(symbol.of))), digits
        if exact is not None:
            rounded = to_digits(keep)(exact)
            if Fraction(rounded) == exact:
                return Decimal(as_typed(exact)), True
            return to_digits(digits)(exact), False
        if digits not in self._finer:
            self._finer[digits] = self.answers.to(digits)
        value = self._finer[digits].settle(attrgetter(str(symbol.of)))
        return Decimal(value), False

    def cite(self, label: str) -> str:
        """The number of an equation of the paper, marked if the axle rubs, which it does not there."""
        return label if self.case.axle_friction is None else f"{label}+b"

    @property
    def slips_at_rest(self) -> bool:
        """Whether the critical heavier mass makes the string slip on a pulley that stands."""
        return self.case.locked or self.case.slips_once_it_moves

    @property
    def is_the_papers(self) -> bool:
        """Whether the pulley is a disk, and its axle does not rub, as in the paper."""
        disk = self.scene.I is None and self.scene.inertia == Fraction(1, 2)
        return disk and self.case.axle_friction is None

    def ratio_in_the_paper(self) -> Law:
        """The ratio of tensions as (33) has it, where friction is at its limit."""
        symbols: list[Any] = [Formula("symbol", one) for one in (*self.masses, Symbol("M", "pulley_mass"))]
        ratio: Any = physics.ratio_in_the_paper(*symbols)
        return Law(QUANTITIES["tension_ratio"].equation, (ratio, Formula("symbol", Symbol("k", "k1"))))

    def ratio_at_the_limit(self) -> Law:
        """The ratio of tensions less 1 on both sides, where friction is at its limit."""
        return Law("", (self._excess, Formula("symbol", Symbol("k - 1", "k1"))))

    def multiplied_out(self) -> Law:
        """The same without a denominator, and with the transfer z = l (k - 1) in it."""
        above, (_, *below) = factors(self._excess)  # what is left out is l
        return Law("", (product(above), product([Formula("symbol", Symbol("z", "transfer")), *below])))

    def collected(self, name: str) -> Law:
        """The equation of a critical mass, multiplied out."""
        above, below = factors(self.formula(name, expanded="drive"))
        critical = Formula("symbol", Symbol(self.symbol(name), name))
        return Law("", (product([*below, critical]), product(above)))

    @property
    def _excess(self) -> Formula:
        """T_h/T_l - 1 of a string that grips, whatever the pulley."""
        given = self.inputs
        c, b = given.get("c") or Symbol("c", "rim_mass"), given.get("b")
        l, h, *others = (Formula("symbol", one) for one in (*self.masses, c, b) if one is not None)
        excess: Any = physics.excess_ratio
        ratio: Formula = excess(l, h, *others)
        return ratio

    def in_the_paper(self, name: str) -> Iterator[Equation]:
        """A quantity in the paper's own form, which is for a disk whose axle does not rub."""
        case = self.case
        if name not in IN_THE_PAPER or not self.is_the_papers or case.stands:
            return
        if case.pulley_mass is None and name != "critical_pulley_mass":
            return
        of_the_paper, symbols = IN_THE_PAPER[name]
        l, h = self.masses
        made_of = {"l": l, "h": h, "M": self.inputs.get("M"), "k": Symbol("k", "capstan_ratio")}
        formula = of_the_paper(*(Formula("symbol", made_of[one]) for one in symbols.split()))
        about, symbol = QUANTITIES[name], self.symbol(name)
        yield self.worked_out(about.equation, symbol, formula, Symbol(symbol, name), about.unit)

    def lines(self, *names: str) -> Iterator[Equation]:
        """The equations of those that exist and have not been shown yet."""
        for name in names:
            if name in self.shown or (name in QUANTITIES and self.answers[name] is None):
                continue
            self.shown.add(name)
            yield self.equation(name)

    def rim_mass(self) -> Iterator[Part]:
        """The equation of c, the pulley's inertia as a mass at the rim."""
        given, c = self.inputs, self.case.rim_mass
        if c is None:
            yield f"where `c = β M` and `β` = {as_typed(self.scene.inertia or Fraction(1))}."
            return
        names = ("I", "R") if self.scene.I is not None else ("β", "M")
        one, other = (Formula("symbol", given[name]) for name in names)
        formula = one / (other * other) if self.scene.I is not None else one * other
        yield self.worked_out("", "c", formula, given["c"], "kg")

    def axle_force(self) -> Iterator[Part]:
        """The equation of the axle's friction as a force at the rim, if it is given as a torque."""
        given, axle = self.inputs, self.scene.axle
        if axle is not None and axle.unit == "N m":
            torque, R = (Formula("symbol", one) for one in (Symbol("τ_axle", axle.number), given["R"]))
            yield self.worked_out("", "f_axle", torque / R, given["f_axle"], "N")

    def axle_mass(self) -> Iterator[Part]:
        """The equation of that friction as a mass, if there is any."""
        given = self.inputs
        if "b" in given:
            symbols: list[Any] = [Formula("symbol", given[name]) for name in ("f_axle", "g")]
            mass: Any = physics.axle_mass(*symbols)
            yield self.worked_out("", "b", mass, given["b"], "kg")

    def motion(self, *names: str) -> Iterator[Part]:
        """The equations that end with the acceleration's magnitude, and its sign where it is negative."""
        yield from self.lines(*names)
        if self.case.sign < 0:
            yield f"`a` is positive when `m2` descends, so here it is negative, {self.say('acceleration')}."

    def tensions(self) -> Iterator[Part]:
        """The tensions, from the acceleration."""
        yield from self.lines("light_tension")
        if self.case.frictionless:
            yield Law("", f"T{self.heavy} = T{self.light}")
        else:
            yield from self.lines("difference", "heavy_tension")

    def extras(self) -> Iterator[Part]:
        """The torque and angular acceleration, if a radius is given, and the force on the axle."""
        if self.scene.R is not None and self.case.sign:
            yield "On the pulley, that makes"
            stands = self.case.regime == "slip" and self.case.rim_stands
            yield from self.lines("torque", *["angular_acceleration"] * (not stands))
        if self.answers["axle_force"] is not None:
            yield "The axle bears both tensions, as (20) says, and the pulley's weight:"
            yield from self.lines("axle_force")

    def compared(self, other: Answers) -> Iterator[Part]:
        """What another scene gives in place of this one, and by how much that is off."""
        for name in ("acceleration", "tension_1", "tension_2"):
            about, value = QUANTITIES[name], self.answers[name]
            off = f" ({self.off(other, name)} %)" if value and not is_infinite(value) else ""
            yield (
                f"- `{plain(about.symbol)}` = {in_words(other[name], about.unit)} in place of"
                f" {in_words(value, about.unit)}{off}"
            )

    def off(self, other: Answers, name: str) -> str:
        """The relative error (%) of another scene's quantity, with its sign."""

        def error(ar: Arithmetic[N]) -> N:
            here, there = (
                getattr(Machine(answers.case, ar), {"acceleration": "magnitude"}.get(name, name))
                for answers in (self.answers, other)
            )
            percent: N = 100 * (there - here) / here
            return percent

        shown = text(settle(error, to_digits(DOUBT), DOUBT))
        return shown if shown.startswith("-") or shown == "0" else f"+{shown}"

    def reason(self, name: str) -> str:
        """Why there is no such value; what is explained here is not listed again at the end."""
        self.explained.add(name)
        return self.answers.reasons[name]

    def value(self, name: str, unit: str = "") -> str:
        """A symbol of the model with its value, for a sentence."""
        symbol = self.names[name]
        number, _ = self.number(Symbol(symbol, name), self.digits, self.digits)
        return _is(symbol, number, unit)

    def meaning(self, symbol: str) -> str:
        """What the symbol of a quantity stands for, in words."""
        return next(about.meaning for about in QUANTITIES.values() if about.symbol == symbol)

    def say(self, name: str) -> str:
        """A symbol with its value, for a sentence."""
        about = QUANTITIES[name]
        return _is(self.symbol(name), self.answers[name], about.unit)


def product(factors: Iterable[Formula]) -> Formula:
    """The formula of a product."""
    return reduce(mul, factors)


def _is(symbol: str, value: Any, unit: str) -> str:
    """A symbol and its value, on one line."""
    return f"`{symbol}`{HELD}={HELD}{in_words(value, unit).replace(' ', HELD)}"


def in_words(value: Any, unit: str) -> str:
    """A value with its unit."""
    return f"{text(value)}{' ' * bool(unit)}{unit}"


def plain(symbol: str) -> str:
    """The registry's symbol in plain letters, as equations write it."""
    letters = {"T₁": "T1", "T₂": "T2", "m₁": "m1", "m₂": "m2"}
    letters |= {"a rim": "a_rim", "Fx": "F_x", "Fy": "F_y", "μ kin": "μ_k"}
    return letters.get(symbol, symbol)
