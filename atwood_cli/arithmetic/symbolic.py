"""Formulas as an arithmetic: the equations of `physics`, run on symbols, write themselves down.

A `Formula` is what the model computes with where it is not to compute: the same functions that give
a number in fractions or enclosures give here the tree of what they do, and that is written out with
symbols or with numbers put in, as plain text or as LaTeX, and worked out again to check the numbers.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from decimal import Decimal
from fractions import Fraction
from operator import add, mul, sub, truediv
from typing import Any, NamedTuple, Union, cast

from .interval import Enclosure, Enclosures
from .rounding import text

OPERATORS = {"+": add, "-": sub, "*": mul, "/": truediv}


class Symbol(NamedTuple):
    """A symbol, for an input (its exact value) or for something that a machine has (its name)."""

    name: str
    of: Fraction | str


class Formula:
    """An operation on formulas, a `Symbol` or an integer."""

    def __init__(self, op: str, *parts: Any) -> None:
        self.op, self.parts = op, parts

    def __add__(self, other: Union["Formula", int]) -> "Formula":
        return Formula("+", self, _formula(other))

    def __sub__(self, other: "Formula") -> "Formula":
        return Formula("-", self, other)

    def __mul__(self, other: Union["Formula", int]) -> "Formula":
        return self if other == 1 else Formula("*", self, _formula(other))

    def __rmul__(self, other: int) -> "Formula":
        return Formula("*", _formula(other), self)

    def __truediv__(self, other: Union["Formula", int]) -> "Formula":
        return Formula("/", self, _formula(other))

    def symbols(self) -> set[Symbol]:
        """The symbols it is made of."""
        if self.op in ("symbol", "integer"):
            return {self.parts[0]} if self.op == "symbol" else set()
        return set().union(*(part.symbols() for part in self.parts))

    def worked_out(self, ar: Enclosures, values: Mapping[Symbol, Decimal]) -> Enclosure:
        """Its value, with exactly those numbers for the symbols."""
        if self.op == "symbol":
            return Enclosure(ar, values[self.parts[0]], values[self.parts[0]])
        if self.op == "integer":
            return ar.number(self.parts[0])
        parts = [part.worked_out(ar, values) for part in self.parts]
        if self.op == "square":
            return cast(Enclosure, parts[0] * parts[0])
        if self.op in OPERATORS:
            return cast(Enclosure, OPERATORS[self.op](*parts))
        return cast(Enclosure, ar.cos_sin(*parts)[1] if self.op == "sin" else getattr(ar, self.op)(*parts))


def _formula(part: Formula | int) -> Formula:
    return Formula("integer", part) if isinstance(part, int) else part


class Symbols:
    """The arithmetic of formulas, with what of `arithmetic.Arithmetic` their lines are made of."""

    def __init__(self, inputs: Sequence[Symbol]) -> None:
        self.inputs = inputs

    def number(self, q: Fraction | int) -> Formula:
        """The symbol of an input, which is told by identity: two inputs may be equal."""
        for symbol in self.inputs:
            if symbol.of is q:
                return Formula("symbol", symbol)
        raise LookupError(f"{q} is no input with a symbol")

    def is_zero(self, x: Formula) -> bool:
        return bool(x.op == "symbol" and x.parts[0].of == 0)

    def expm1(self, x: Formula) -> Formula:
        return Formula("expm1", x)

    def log1p(self, x: Formula) -> Formula:
        return Formula("log1p", x)

    def sqrt(self, x: Formula) -> Formula:
        return Formula("sqrt", x)

    def hypot(self, x: Formula, y: Formula | int) -> Formula:
        return Formula("hypot", x, _formula(y))

    def cos_sin(self, x: Formula) -> tuple[Formula, Formula]:
        return Formula("cos", x), Formula("sin", x)


# Writing it down

SUM, PRODUCT, ATOM = range(3)
"""How tightly a text holds together: what is looser than its place asks is put in parentheses."""

Written = tuple[str, int]


def written(formula: Formula, numbers: Mapping[Symbol, Decimal] | None = None, latex: bool = False) -> str:
    """The formula, with symbols or with numbers for them, as plain text or as LaTeX."""
    return _write(formula, numbers, latex)[0]


def _write(f: Formula, numbers: Mapping[Symbol, Decimal] | None, latex: bool) -> Written:
    def write(part: Formula) -> Written:
        return _write(part, numbers, latex)

    def tight(part: Formula, level: int = ATOM) -> str:
        words, its_level = write(part)
        return words if its_level >= level else f"({words})"

    match f.op:
        case "symbol":
            if numbers is not None:
                return _number(text(numbers[f.parts[0]]), latex)
            name = f.parts[0].name
            return math(name) if latex else name, SUM if " " in name else ATOM
        case "integer":
            return _number(str(f.parts[0]), latex)
        case "+" | "-":
            left, right = f.parts
            return f"{write(left)[0]} {f.op} {tight(right, PRODUCT)}", SUM
        case "*" | "/":
            return _quotient(f, write, numbers is not None, latex)
        case "square":
            return f"{tight(f.parts[0])}^2", ATOM
        case "hypot":
            inside = " + ".join(tight(part) + "^2" * (part.op != "integer") for part in f.parts)
            return (rf"\sqrt{{{inside}}}" if latex else f"√({inside})"), ATOM
        case "expm1":
            power = write(f.parts[0])[0]
            return (f"e^{{{power}}} - 1" if latex else f"e^({power}) - 1"), SUM
        case "sqrt" if latex:
            return rf"\sqrt{{{write(f.parts[0])[0]}}}", ATOM
    inside = f"1 + {tight(f.parts[0], PRODUCT)}" if f.op == "log1p" else write(f.parts[0])[0]
    function = {"log1p": "ln", "sqrt": "√"}.get(f.op, f.op)
    return (rf"\{function}({inside})" if latex else f"{function}({inside})"), ATOM


def _quotient(f: Formula, write: Callable[[Formula], Written], numbers: bool, latex: bool) -> Written:
    above, below = _factors(f)
    minus = above[0].op == "integer" and above[0].parts[0] < 0
    if minus:
        above = above[1:]
    times = (r" \cdot " if latex else " · ") if numbers else (r" \, " if latex else " ")

    def product(factors: list[Formula], alone: bool) -> str:
        words = [(word if level == ATOM else f"({word})") for word, level in map(write, factors)]
        return write(factors[0])[0] if alone and not factors[1:] else times.join(words)

    upper = product(above, alone=latex and bool(below))
    lower = product(below, alone=latex) if below else ""
    if below and latex:
        quotient = rf"\frac{{{upper}}}{{{lower}}}"
    else:
        quotient = upper + (f"/({lower})" if below[1:] else f"/{lower}" if below else "")
    return f"{'-' * minus}{quotient}", SUM if minus else PRODUCT


def _factors(f: Formula) -> tuple[list[Formula], list[Formula]]:
    """What is multiplied, whole numbers first, and what it is divided by."""
    if f.op not in ("*", "/"):
        return [f], []
    (a, b), (c, d) = map(_factors, f.parts)
    above, below = (a + c, b + d) if f.op == "*" else (a + d, b + c)
    return sorted(above, key=lambda part: part.op != "integer"), below


def _number(digits: str, latex: bool) -> Written:
    level = SUM if digits.startswith("-") else ATOM
    return (in_latex(digits), min(level, PRODUCT)) if latex and "e" in digits else (digits, level)


def in_latex(digits: str) -> str:
    """A number as LaTeX has it."""
    mantissa, _, exponent = digits.partition("e")
    return rf"{mantissa} \times 10^{{{exponent}}}" if exponent else digits


GREEK = {
    "μ": r"\mu",
    "π": r"\pi",
    "φ": r"\varphi",
    "θ": r"\theta",
    "α": r"\alpha",
    "β": r"\beta",
    "τ": r"\tau",
}


def math(words: str) -> str:
    """A symbol or a plain equation as LaTeX: indices lowered, Greek letters and powers spelled."""
    words = re.sub(r"_(\w+)", r"_{\\mathrm{\1}}", words)
    words = re.sub(r"\b([A-Za-z])(\d)", r"\1_\2", words)
    words = re.sub(r" (min|max)\b", r"_{\\\1}", words)
    words = re.sub(r"\^\(([^()]*)\)", r"^{\1}", words)
    words = words.replace("*", r"^{\ast}").replace("√", r"\sqrt")
    words = re.sub("[" + "".join(GREEK) + "]", lambda m: GREEK[m[0]] + " ", words)
    return re.sub(r" +([ })^_]|$)", r"\1", words)
