"""The arithmetic of plain doubles, as formulas of columns; and the operations that all such formulas use."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from math import pi
from typing import Any

import numpy as np

from ..arithmetic.symbolic import Formula, Formulas, Term, formula
from .tables import precise_cos_sin


class Uncertified(ArithmeticError):
    """This arithmetic cannot certify the result in any row: take a more accurate one."""


def maximum(x: Term, y: Term) -> Any:
    """The larger of the two."""
    return Formula("maximum", formula(x), formula(y))


def minimum(x: Term, y: Term) -> Any:
    """The smaller of the two."""
    return Formula("minimum", formula(x), formula(y))


def absolute(x: Term) -> Any:
    """The size of x."""
    return Formula("abs", x) if isinstance(x, Formula) else abs(x)


def at_most(x: Term, y: Term) -> Formula:
    """Whether x <= y; false where either is NaN."""
    return Formula("<=", formula(x), formula(y))


def less(x: Term, y: Term) -> Formula:
    """Whether x < y."""
    return Formula("<", formula(x), formula(y))


def equal(x: Term, y: Term) -> Formula:
    """Whether x = y."""
    return Formula("==", formula(x), formula(y))


def both(x: Formula, y: Formula) -> Formula:
    """Whether both conditions hold."""
    return Formula("and", x, y)


def either(x: Formula, y: Formula) -> Formula:
    """Whether one of the conditions holds."""
    return Formula("or", x, y)


def is_finite(x: Term) -> Formula:
    """Whether x is neither infinite nor NaN."""
    return Formula("finite", formula(x))


def joined(x: Term | None, y: Term | None) -> Any:
    """The sum of two columns, either of which may be None."""
    return y if x is None else x if y is None else x + y


def where(condition: Formula, x: Term, y: Term) -> Formula:
    """x where the condition holds, else y."""
    return Formula("where", condition, formula(x), formula(y))


def looked_up(table: Any, index: Formula) -> Formula:
    """The entries of a table of doubles at a column of indices; beyond an end, the entry at that end."""
    return Formula("take", index, table)


class Doubles(Formulas):
    """Plain double arithmetic, without bounds."""

    pi = formula(pi)

    def number(self, q: Any) -> Formula:
        return formula(q)

    def is_zero(self, x: Formula) -> bool:
        return bool(x.op == "number" and x.parts[0] == 0)

    def hypot(self, x: Formula, y: Formula | int) -> Formula:
        """√(x² + y²). NumPy's own function, which avoids overflow, takes ten times as long."""
        return self.sqrt(x * x + y * y)

    def cos_sin_of_degrees(self, x: Any) -> tuple[Formula, Formula]:
        if isinstance(x, Fraction):
            cos, sin = precise_cos_sin(x)
            return formula(cos), formula(sin)
        folded, turn = fold(x)
        return turn(*self.cos_sin(folded * (pi / 180)))

    def root(self, f: Callable[[Formula], Formula], end: Formula) -> Formula:
        """By bisection, to the last place but one."""
        low, high = formula(0.0), end
        for _ in range(54):
            half = (low + high) / 2
            before = less(f(half), 0.0)
            low, high = where(before, half, low), where(before, high, half)
        return (low + high) / 2


DOUBLES = Doubles()


def fold(degrees: Formula) -> tuple[Formula, Callable[..., tuple[Any, Any]]]:
    """The angle less its quarter turns, exactly, and the function that puts these into its cosine and sine.

    The function exchanges the two after an odd number of quarter turns, and sets their signs if ``signed``.
    """
    degrees = Formula("fmod", degrees, formula(360.0))
    quarters = Formula("rint", degrees / 90)
    which = Formula("int", quarters)
    odd = Formula("==", Formula("bits", which, 1), formula(1.0))
    signs = [looked_up(table, Formula("bits", which, 3)) for table in SIGNS]

    def turn(cos: Term, sin: Term, signed: bool = True) -> tuple[Any, Any]:
        x, y = where(odd, sin, cos), where(odd, cos, sin)
        return (x * signs[0], y * signs[1]) if signed else (x, y)

    return degrees - 90 * quarters, turn


SIGNS = np.array([1.0, -1.0, -1.0, 1.0]), np.array([1.0, 1.0, -1.0, -1.0])
"""The signs of cosine and sine, by the number of quarter turns."""
