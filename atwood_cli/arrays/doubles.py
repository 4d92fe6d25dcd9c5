"""Doubles in columns, each with a proven bound on its error: the first level of `certified`.

Each operation on columns gives a `Number`: formulas of doubles, and a bound on the relative error of their
sum. The bound has two parts. Its *loss* is the same in all rows and is known before any row is computed; its
*doubt* is a column. Here a number is one double; in `pairs` it is the sum of two.

The proof. Let u = 2^-53.

- Doubles follow IEEE 754 and round to nearest, in Python and NumPy on any platform: the result of + - * / or
  a root is off by at most u of itself. The double of a constant is, too.
- NumPy's expm1, log1p, sin and cos are off by at most 4 u (`LIBRARY`) of the result. (The tests measure 1.2.)
- In a product or quotient the bounds of both operands add up, and a root halves the bound. A sum of two
  numbers that are never negative has at most the larger bound of the two.
- In any other sum the terms may cancel. Their absolute errors are added and divided by the size of the sum,
  row by row: that is the doubt. A sum that cannot be negative may come out negative; its doubt is 1 or more
  then.
- An error of x counts (1 + x) times in e^x - 1, as x e^x < (1 + x) (e^x - 1), at most once in ln(1 + x), and
  at most once in the sine and cosine of an angle that is folded to 45° or less.
- Inputs are 0 or within 2^±120 (`WINDOW`). I/R² and f/g are, too, which stand for I and the axle's friction.
  The caller checks this. A value whose μφ is 90 or more is not certified, as its bound is (1 + x) times as
  large. So no operation on a certified value leaves the normal doubles, but for squares that are negligible
  beside the term to which they are added.
- Bounds are of first order: products of two bounds are left out. They are below 1e-27, and the limit that
  bounds are compared with is 5e-16 below the promise (`LIMIT`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from math import frexp
from typing import Any

import numpy as np

from ..arithmetic.lazy import lazy
from ..arithmetic.symbolic import Formula, Term, formula
from ..model.quantities import Accuracy
from .constants import pi, precise_cos_sin

UNIT = 2.0**-53
"""u, the largest relative error of a rounded double."""
LIBRARY = 4 * UNIT
"""The largest relative error that is assumed of NumPy's functions."""
WINDOW = 2.0**-120, 2.0**120
"""The range of inputs for which the bounds hold, in SI units."""
PROMISE = 2e-14
"""The largest relative error of a value that is certified."""
LIMIT = PROMISE - 5e-16
"""The largest bound that is certified. Bounds leave out products of two, and the rounding of a pair."""
END_ERROR = 2.0**-104
"""A bound on the relative rounding error of the ends between which a value lies."""

Parts = tuple[Any, ...]


class NoProgram(ArithmeticError):
    """No arithmetic of columns has an operation: each row is to be solved alone."""


# Operations that formulas of columns have beside + - * /


def _operation(op: str) -> Callable[[Term, Term], Formula]:
    return lambda x, y: Formula(op, formula(x), formula(y))


maximum, minimum, equal, both, either = map(_operation, ("maximum", "minimum", "==", "and", "or"))
less, at_most = map(_operation, ("<", "<="))
"""x < y and x <= y, which are false where either is NaN."""


def absolute(x: Term) -> Any:
    """The size of x."""
    return Formula("abs", x) if isinstance(x, Formula) else abs(x)


def where(condition: Formula, x: Term, y: Term) -> Formula:
    """x where the condition holds, else y."""
    return Formula("where", condition, formula(x), formula(y))


def looked_up(table: Any, index: Formula) -> Formula:
    """The entries of a table of doubles at a column of indices; beyond an end, the entry at that end."""
    return Formula("take", index, table)


def joined(x: Term | None, y: Term | None) -> Any:
    """The sum of two columns, where None stands for 0."""
    return y if x is None else x if y is None else x + y


class Number:
    """A column of numbers: sums of ``parts``, whose relative error is at most ``loss`` + ``doubt``.

    ``loss`` is the same in all rows. ``doubt`` is a column, or None; it is NaN or infinite in rows without a
    bound. ``positive`` says that no row is negative.
    """

    def __init__(
        self,
        arithmetic: Doubles,
        parts: Sequence[Term],
        loss: float = 0.0,
        doubt: Term | None = None,
        positive: bool = True,
    ) -> None:
        self.arithmetic, self.parts = arithmetic, tuple(parts)
        self.loss, self.doubt, self.positive = loss, doubt, positive

    @property
    def bound(self) -> Any:
        return self.loss if self.doubt is None else self.doubt + self.loss

    @property
    def size(self) -> Any:
        """The absolute value, to a double."""
        return self.parts[0] if self.positive and self.doubt is None else absolute(self.parts[0])

    @property
    def power(self) -> float:
        """The value if it is ±2^n, a factor that causes no rounding; else 0."""
        (first, *others) = self.parts
        if others or isinstance(first, Formula) or self.loss or abs(frexp(first)[0]) != 0.5:
            return 0.0
        return first

    @property
    def exact(self) -> bool:
        """Whether each row is a double without an error."""
        return len(self.parts) == 1 and self.loss == 0 and self.doubt is None

    def __add__(self, other: Number | int) -> Number:
        return self._plus(other, 1.0)

    __radd__ = __add__

    def __sub__(self, other: Number | int) -> Number:
        return self._plus(other, -1.0)

    def _plus(self, other: Number | int, sign: float) -> Number:
        """The sum, or the difference for sign -1."""
        ar, left, right = self.arithmetic, self, self.arithmetic.number(other)
        if ar.is_zero(right):
            return left
        if ar.is_zero(left):
            return right * sign
        positive = sign > 0 and left.positive and right.positive
        parts = ar.sum(left.parts, right.parts, sign, positive)
        if left.exact and right.exact:
            return Number(ar, parts, ar.loss_of_doubles, None, positive)
        if positive and (ar.roughly or (left.doubt is None and right.doubt is None)):
            doubts = [term.doubt for term in (left, right) if term.doubt is not None]
            doubt = maximum(*doubts) if len({*map(id, doubts)}) == 2 else doubts[0] if doubts else None
            return Number(ar, parts, max(left.loss, right.loss) + ar.loss_of_sum, doubt)
        error = joined(ar.error(left), ar.error(right))
        return Number(ar, parts, ar.loss_of_doubles, error / absolute(parts[0]), positive)

    def __mul__(self, other: Number | Fraction | float) -> Number:
        ar, left, right = self.arithmetic, self, self.arithmetic.number(other)
        if left.power or ar.is_zero(right):
            left, right = right, left
        if ar.is_zero(left):
            return left
        if right.power:
            return left._scaled(right.power)
        loss = ar.loss_of_doubles if left.exact and right.exact else ar.loss_of_product
        return left._joined(right, ar.multiply, loss)

    __rmul__ = __mul__

    def __truediv__(self, other: Number | int) -> Number:
        ar, two = self.arithmetic, self.arithmetic.number(other)
        if ar.is_zero(self):
            return self
        return self._scaled(1 / two.power) if two.power else self._joined(two, ar.divide, ar.loss_of_quotient)

    def __rtruediv__(self, other: int) -> Number:
        dividend: Number = self.arithmetic.number(other)
        return dividend / self

    def _scaled(self, factor: float) -> Number:
        """This number times ±2^n."""
        if factor == 1:
            return self
        parts = [part * factor for part in self.parts]
        return Number(self.arithmetic, parts, self.loss, self.doubt, self.positive and factor > 0)

    def _joined(self, other: Number, operation: Any, loss: float) -> Number:
        """A product or quotient: the bounds add up."""
        parts, doubt = operation(self.parts, other.parts), joined(self.doubt, other.doubt)
        positive = self.positive and other.positive
        return Number(self.arithmetic, parts, self.loss + other.loss + loss, doubt, positive)


class Doubles:
    """The arithmetic of numbers that are one double."""

    loss_of_constant = loss_of_sum = loss_of_product = loss_of_quotient = loss_of_root = UNIT
    """The relative errors of operations, and of a constant that is no double."""
    loss_of_doubles = UNIT
    """The relative error of a sum of two doubles, whatever cancels, and of a product of two doubles."""
    roughly = True
    """Whether the larger doubt of two terms is taken for the doubt of their sum, as this takes less time."""

    def error(self, x: Number) -> Any:
        """The absolute error of a term that may cancel, and of adding it; None if there is none."""
        return None if x.exact else x.size * x.bound

    # Parts, without bounds

    def sum(self, x: Parts, y: Parts, sign: float, positive: bool) -> Parts:
        """x + sign y; ``positive`` says that nothing cancels, as no row of either is negative."""
        return (x[0] + y[0] if sign > 0 else x[0] - y[0],)

    def multiply(self, x: Parts, y: Parts) -> Parts:
        return (x[0] * y[0],)

    def divide(self, x: Parts, y: Parts) -> Parts:
        return (x[0] / y[0],)

    def root_of(self, x: Parts) -> Parts:
        return (Formula("sqrt", formula(x[0])),)

    def constant(self, q: Fraction) -> Parts:
        return (float(q),)

    # Numbers

    def number(self, q: Any) -> Number:
        """The number of a fraction, or of a column of exact doubles."""
        if isinstance(q, Number):
            return q
        if isinstance(q, Formula):
            return Number(self, (q,))
        exact = Fraction(q)
        parts = self.constant(exact)
        loss = 0.0 if sum(map(Fraction, parts)) == exact else self.loss_of_constant
        return Number(self, parts, loss, positive=exact >= 0)

    def is_zero(self, x: Number) -> bool:
        return x.parts == (0.0,)

    def not_negative(self, x: Number) -> Number:
        x.positive = True
        return x

    def sqrt(self, x: Number) -> Number:
        """√x for x >= 0."""
        doubt = None if x.doubt is None else 0.5 * x.doubt
        return Number(self, self.root_of(x.parts), x.loss / 2 + self.loss_of_root, doubt)

    def hypot(self, x: Number, y: Number | int) -> Number:
        return self.sqrt(x * x + y * y)

    @lazy
    def pi(self) -> Number:
        return self.number(pi())

    def exp(self, x: Number) -> Number:
        return self.expm1(x) + 1

    def expm1(self, x: Number) -> Number:
        """e^x - 1 for x >= 0."""
        first = formula(x.parts[0])
        return Number(self, (Formula("expm1", first),), LIBRARY, (1.0 + first) * x.bound)

    def log1p(self, x: Number) -> Number:
        """ln(1 + x) for x >= 0."""
        return Number(self, (Formula("log1p", formula(x.parts[0])),), LIBRARY + x.loss, x.doubt)

    def cos_sin_of_degrees(self, angle: Any) -> tuple[Number, Number]:
        """Cosine and sine of an angle in degrees, or of a column of exact angles."""
        if isinstance(angle, Fraction):
            cos, sin = map(self.number, precise_cos_sin(angle))
            return cos, sin
        return self.cos_sin_of_column(angle.parts[0])

    def cos_sin_of_column(self, degrees: Formula) -> tuple[Number, Number]:
        """The cosine and the sine of angles in degrees, which are exact.

        The quarter turns of an angle are taken off, exactly. Their number says whether the two are exchanged,
        and which signs they have.
        """
        degrees = Formula("fmod", degrees, formula(360.0))
        quarters = Formula("rint", degrees / 90)
        number = Formula("int", quarters)
        odd = equal(Formula("bits", number, 1), 1.0)
        angle = Number(self, (degrees - 90 * quarters,), positive=False) * (self.pi / 180)
        cos, sin = (Formula(name, angle.parts[0]) for name in ("cos", "sin"))
        folded = where(odd, sin, cos), where(odd, cos, sin)
        signed = (
            value * looked_up(signs, Formula("bits", number, 3))
            for value, signs in zip(folded, SIGNS, strict=True)
        )
        x, y = (Number(self, (value,), LIBRARY + angle.loss, positive=False) for value in signed)
        return x, y

    def cos_sin(self, *_: Any) -> Any:
        raise NoProgram

    root = cos_sin


SIGNS = np.array([1.0, -1.0, -1.0, 1.0]), np.array([1.0, 1.0, -1.0, -1.0])
"""The signs of cosine and sine, by the number of quarter turns."""

DOUBLES = Doubles()


# When a double is right: within the promise of `certified`, or nearest to the exact value


def certified(value: Number, accuracy: Accuracy) -> tuple[Term, Formula | None]:
    """A value as a double, and the condition under which it is right in a row; None if it always is."""
    double: Any = value.parts[0] if value.positive else value.parts[0] + 0.0  # 0.0 makes 0 of -0
    if accuracy == "exact":
        return double, is_nearest(value)
    if value.doubt is None and value.loss <= LIMIT:
        return double, None
    return double, at_most(value.bound, LIMIT)


def is_nearest(value: Number) -> Formula:
    """Whether the first part is the double nearest to the exact value: both ends of the bound round to it."""
    first, second = (*value.parts, 0.0)[:2]
    error = absolute(first) * (value.bound + END_ERROR)
    ends_round_to_it = both(equal(first + (second - error), first), equal(first + (second + error), first))
    return either(ends_round_to_it, equal(value.bound, 0.0))
