"""Record operations: run on symbols, the equations of the model give expression trees.

The same functions that give a number in fractions or enclosures give a `Formula` here. It can be written
out, with symbols or with numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any, NamedTuple


class Symbol(NamedTuple):
    """A symbol and what it stands for: an input's exact value, or the name of an attribute of `Machine`."""

    name: str
    of: Fraction | str


class Formula:
    """An operation ``op`` on its ``parts``, which are formulas, numbers or tables; or a symbol or a number.

    The part of a ``"symbol"`` is a `Symbol`, or the name of a column; that of a ``"number"`` an int or float.
    """

    __slots__ = ("op", "parts")

    def __init__(self, op: str, *parts: Any) -> None:
        self.op, self.parts = op, parts

    def __add__(self, other: Term) -> Formula:
        if is_number(self, 0) or is_number(other, 0):
            return formula(other) if is_number(self, 0) else self
        return Formula("+", self, formula(other))

    def __radd__(self, other: float) -> Formula:
        return formula(other) + self

    def __sub__(self, other: Term) -> Formula:
        return self if is_number(other, 0) else Formula("-", self, formula(other))

    def __rsub__(self, other: float) -> Formula:
        return formula(other) - self

    def __mul__(self, other: Term) -> Formula:
        for term, factor in ((self, other), (other, self)):
            if is_number(term, 0) or is_number(factor, 1):
                return formula(term)
        return self if other == 1 else Formula("*", self, formula(other))

    def __rmul__(self, other: float) -> Formula:
        return self if other == 1 else formula(other) * self

    def __truediv__(self, other: Term) -> Formula:
        if is_number(self, 0) or is_number(other, 1) or other == 1:
            return self
        return Formula("/", self, formula(other))

    def __rtruediv__(self, other: float) -> Formula:
        return formula(other) / self

    def symbols(self) -> set[Symbol]:
        """Return the symbols in the formula."""
        if self.op in ("symbol", "number"):
            return {self.parts[0]} if self.op == "symbol" else set()
        return set().union(*(part.symbols() for part in self.parts))


Term = Formula | float
"""An operand in formulas of columns: a column's formula, or a number that is the same in all rows."""


def formula(part: Term | Fraction) -> Formula:
    """Return the formula itself, or the formula of a number."""
    if isinstance(part, Formula):
        return part
    return Formula("number", float(part) if isinstance(part, Fraction) else part)


def is_number(part: Term, number: int) -> bool:
    """Decide whether a formula is that number, which means a limit: a 0 that is added is not written."""
    return isinstance(part, Formula) and part.op == "number" and bool(part.parts[0] == number)


def factors(f: Formula) -> tuple[list[Formula], list[Formula]]:
    """Return the factors of a product or quotient, whole numbers first, and those that divide it."""
    if f.op not in ("*", "/"):
        return [f], []
    (a, b), (c, d) = map(factors, f.parts)
    above, below = (a + c, b + d) if f.op == "*" else (a + d, b + c)
    return sorted(above, key=lambda part: part.op != "number"), below


def _recorded(function: str) -> Callable[[Any, Formula], Formula]:
    return lambda _, x: Formula(function, x)


class Symbols:
    """The part of `Arithmetic` that derivations need, with symbols for inputs. Functions are recorded."""

    pi = Formula("symbol", Symbol("π", "ar.pi"))
    expm1, log1p, sqrt = map(_recorded, ("expm1", "log1p", "sqrt"))

    def __init__(self, inputs: Sequence[Symbol]) -> None:
        self.inputs = inputs

    def number(self, q: Fraction | int) -> Formula:
        """Return the symbol of an input, which is this object, as two may be equal; or else the number."""
        symbols = (Formula("symbol", symbol) for symbol in self.inputs if symbol.of is q)
        return next(symbols, formula(int(q) if q == int(q) else q))

    def is_zero(self, x: Formula) -> bool:
        return is_number(x, 0) or bool(x.op == "symbol" and x.parts[0].of == 0)

    def taken_as_not_negative(self, x: Formula) -> Formula:
        return x

    def cos_sin(self, x: Formula) -> tuple[Formula, Formula]:
        return Formula("cos", x), Formula("sin", x)
