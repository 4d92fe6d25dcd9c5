"""Doubles in columns, each with a proven bound on its error: the first level of `certified`.

Each operation on columns gives a `Bounded`: formulas of doubles, and a bound on the relative error of their
sum. The bound has two parts. The *fixed error* is the same in all rows and is known before any row is
computed. The *row error* is a column. Here a number is one double; in `pairs` it is the sum of two.

The proof. Let u = 2^-53.

- Doubles follow IEEE 754 and round to nearest, in Python and NumPy on any platform: the result of + - * / or
  a root is off by at most u of itself. The double of a constant is, too.
- NumPy's expm1, log1p, sin and cos are off by at most 4 u (`LIBRARY`) of the result. (The tests measure 1.2.)
- In a product or quotient the bounds of both operands add up, and a root halves the bound. A sum of two
  numbers that are never negative has at most the larger bound of the two.
- In any other sum the terms may cancel. The row error is the sum of their absolute errors, divided by the
  size of the sum, row by row. A sum that cannot be negative may come out negative; its row error is then 1
  or more.
- An error of x counts (1 + x) times in e^x - 1, as x e^x < (1 + x) (e^x - 1), at most once in ln(1 + x), and
  at most once in the sine and cosine of an angle that is folded to 45° or less.
- Inputs are 0 or within 2^±120 (`WINDOW`). I/R² and f/g are, too, which stand for I and the axle's friction.
  `inputs` checks this. A value whose μφ is 90 or more is not certified, as its bound is (1 + x) times as
  large. So no operation on a certified value leaves the normal doubles, but for squares that are negligible
  beside the term to which they are added.
- Bounds are of first order: products of two bounds are left out. They are below 1e-27, and the limit that
  bounds are compared with is 5e-16 below the promise (`MOST_ERROR`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from math import frexp
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..numbers.formula import Formula, Term, formula
from ..numbers.interval import enclosures
from ..numbers.lazy import lazy
from ..numbers.rational import EXACT, Irrational
from ..solver.quantities import Accuracy

UNIT = 2.0**-53
"""u, the largest relative error of a rounded double."""
LIBRARY = 4 * UNIT
"""The largest relative error that is assumed of NumPy's functions."""
WINDOW = 2.0**-120, 2.0**120
"""The range of inputs for which the bounds hold, in SI units."""
PROMISE = 2e-14
"""The largest relative error of a value that is certified."""
MOST_ERROR = PROMISE - 5e-16
"""The largest bound that is certified. Bounds leave out products of two, and the rounding of a pair."""
END_ERROR = 2.0**-104
"""A bound on the relative rounding error of the ends between which a value lies."""

EIGHTY_DIGITS = enclosures(80)
"""The arithmetic of constants, which are computed once."""

Column = NDArray[np.float64]
Parts = tuple[Any, ...]


class NoProgram(ArithmeticError):
    """No arithmetic of columns has an operation: each row is to be solved by itself."""


# Operations that formulas of columns have beside + - * /


def _operation(op: str) -> Callable[..., Formula]:
    return lambda *operands: Formula(op, *map(formula, operands))


maximum, minimum, equal, both, either = map(_operation, ("maximum", "minimum", "==", "and", "or"))
less, at_most = map(_operation, ("<", "<="))
"""x < y and x <= y, which are false if either is NaN."""
where = _operation("where")
"""Take x if a condition holds, else y: where(condition, x, y)."""


def absolute(x: Term) -> Any:
    """Return the size of x."""
    return Formula("abs", x) if isinstance(x, Formula) else abs(x)


def larger(x: Term, y: Term) -> Term:
    """Return the larger of two row errors."""
    if isinstance(x, Formula) and isinstance(y, Formula) and x is not y:
        return maximum(x, y)
    return x if isinstance(x, Formula) else y


class Bounded:
    """A column of numbers with a bound on their relative error: ``fixed_error`` + ``row_error``.

    A number is the sum of its ``parts``. ``fixed_error`` is the same in all rows. ``row_error`` is a column,
    or 0; it is NaN or infinite in rows without a bound. ``positive`` says that no row is negative.
    """

    def __init__(
        self,
        arithmetic: Doubles,
        parts: Sequence[Term],
        fixed_error: float = 0.0,
        row_error: Term = 0.0,
        positive: bool = True,
    ) -> None:
        self.arithmetic, self.parts = arithmetic, tuple(parts)
        self.fixed_error, self.row_error, self.positive = fixed_error, row_error, positive

    @property
    def bound(self) -> Any:
        return self.row_error + self.fixed_error

    @property
    def size(self) -> Any:
        """The absolute value, to a double."""
        certain = self.positive and not isinstance(self.row_error, Formula)
        return self.parts[0] if certain else absolute(self.parts[0])

    @property
    def power(self) -> float:
        """The value if it is ±2^n, a factor that causes no rounding; else 0."""
        (first, *others) = self.parts
        if others or isinstance(first, Formula) or self.fixed_error or abs(frexp(first)[0]) != 0.5:
            return 0.0
        return first

    @property
    def exact(self) -> bool:
        """Whether each row is a double without an error."""
        return len(self.parts) == 1 and self.bound == 0.0

    def __add__(self, other: Bounded | int) -> Bounded:
        return self._plus(other, 1.0)

    __radd__ = __add__

    def __sub__(self, other: Bounded | int) -> Bounded:
        return self._plus(other, -1.0)

    def _plus(self, other: Bounded | int, sign: float) -> Bounded:
        """Return the sum, or the difference for sign -1."""
        ar, left, right = self.arithmetic, self, self.arithmetic.number(other)
        if ar.is_zero(right):
            return left
        if ar.is_zero(left):
            return right * sign
        positive = sign > 0 and left.positive and right.positive
        parts = ar.sum(left.parts, right.parts, sign, positive)
        if left.exact and right.exact:
            return Bounded(ar, parts, ar.error_of_doubles, positive=positive)
        certain = not isinstance(left.row_error, Formula) and not isinstance(right.row_error, Formula)
        if positive and (ar.sums_take_larger_error or certain):
            fixed_error = max(left.fixed_error, right.fixed_error) + ar.error_of_sum
            return Bounded(ar, parts, fixed_error, larger(left.row_error, right.row_error))
        error = ar.error(left) + ar.error(right)
        return Bounded(ar, parts, ar.error_of_doubles, error / absolute(parts[0]), positive)

    def __mul__(self, other: Bounded | Fraction | float) -> Bounded:
        ar, left, right = self.arithmetic, self, self.arithmetic.number(other)
        if left.power or ar.is_zero(right):
            left, right = right, left
        if ar.is_zero(left):
            return left
        if right.power:
            return left._scaled(right.power)
        fixed_error = ar.error_of_doubles if left.exact and right.exact else ar.error_of_product
        return left._joined(right, ar.multiply, fixed_error)

    __rmul__ = __mul__

    def __truediv__(self, other: Bounded | int) -> Bounded:
        ar, two = self.arithmetic, self.arithmetic.number(other)
        if ar.is_zero(self):
            return self
        return (
            self._scaled(1 / two.power) if two.power else self._joined(two, ar.divide, ar.error_of_quotient)
        )

    def __rtruediv__(self, other: int) -> Bounded:
        dividend: Bounded = self.arithmetic.number(other)
        return dividend / self

    def _scaled(self, factor: float) -> Bounded:
        """Return this number times ±2^n."""
        parts = [part * factor for part in self.parts]
        return Bounded(self.arithmetic, parts, self.fixed_error, self.row_error, self.positive and factor > 0)

    def _joined(self, other: Bounded, operation: Any, fixed_error: float) -> Bounded:
        """Return a product or quotient: the bounds add up."""
        parts, row_error = operation(self.parts, other.parts), self.row_error + other.row_error
        positive = self.positive and other.positive
        return Bounded(
            self.arithmetic, parts, self.fixed_error + other.fixed_error + fixed_error, row_error, positive
        )


class Doubles:
    """The arithmetic of numbers that are one double."""

    error_of_constant = error_of_sum = error_of_product = error_of_quotient = error_of_root = UNIT
    """The relative errors of operations, and of a constant that is no double."""
    error_of_doubles = UNIT
    """The relative error of a sum of two doubles, whatever cancels, and of a product of two doubles."""
    sums_take_larger_error = True
    """Whether the row error of a sum is the larger one of its terms: a weaker bound that takes less time."""

    def error(self, x: Bounded) -> Any:
        """Return the absolute error of a term that may cancel, and of adding it."""
        return 0.0 if x.exact else x.size * x.bound

    # Parts, without bounds

    def sum(self, x: Parts, y: Parts, sign: float, positive: bool) -> Parts:
        """Return x + sign y; ``positive`` says that nothing cancels, as no row of either is negative."""
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

    def number(self, q: Any) -> Bounded:
        """Return the number of a fraction, or of a column of exact doubles."""
        if isinstance(q, Bounded):
            return q
        if isinstance(q, Formula):
            return Bounded(self, (q,))
        exact = Fraction(q)
        parts = self.constant(exact)
        fixed_error = 0.0 if sum(map(Fraction, parts)) == exact else self.error_of_constant
        return Bounded(self, parts, fixed_error, positive=exact >= 0)

    def is_zero(self, x: Bounded) -> bool:
        return x.parts == (0.0,)

    def taken_as_not_negative(self, x: Bounded) -> Bounded:
        return Bounded(self, x.parts, x.fixed_error, x.row_error)

    def sqrt(self, x: Bounded) -> Bounded:
        """Return √x for x >= 0."""
        error = x.fixed_error / 2 + self.error_of_root
        return Bounded(self, self.root_of(x.parts), error, 0.5 * x.row_error)

    @lazy
    def pi(self) -> Bounded:
        return self.number(Fraction(EIGHTY_DIGITS.pi.lo))

    def expm1(self, x: Bounded) -> Bounded:
        """Return e^x - 1 for x >= 0."""
        first = formula(x.parts[0])
        return Bounded(self, (Formula("expm1", first),), LIBRARY, (1.0 + first) * x.bound)

    def log1p(self, x: Bounded) -> Bounded:
        """Return ln(1 + x) for x >= 0."""
        return Bounded(self, (Formula("log1p", formula(x.parts[0])),), LIBRARY + x.fixed_error, x.row_error)

    def cos_sin_of_degrees(self, angle: Any) -> tuple[Bounded, Bounded]:
        """Return cosine and sine of an angle in degrees, or of a column of exact angles."""
        if isinstance(angle, Fraction):
            cos, sin = map(self.number, precise_cos_sin(angle))
            return cos, sin
        return self.cos_sin_of_column(angle.parts[0])

    def cos_sin_of_column(self, degrees: Formula) -> tuple[Bounded, Bounded]:
        """Return the cosine and the sine of angles in degrees, which are exact.

        The quarter turns of an angle are taken off, exactly. Their number says whether the two are exchanged,
        and which signs they have.
        """
        degrees = Formula("fmod", degrees, formula(360.0))
        quarters = Formula("rint", degrees / 90)
        number = Formula("int", quarters)
        odd = equal(Formula("bits", number, 1), 1.0)
        angle = Bounded(self, (degrees - 90 * quarters,), positive=False) * (self.pi / 180)
        cos, sin = (Formula(name, angle.parts[0]) for name in ("cos", "sin"))
        folded = where(odd, sin, cos), where(odd, cos, sin)
        signed = (
            value * Formula("take", Formula("bits", number, 3), signs)
            for value, signs in zip(folded, SIGNS, strict=True)
        )
        x, y = (Bounded(self, (value,), LIBRARY + angle.fixed_error, positive=False) for value in signed)
        return x, y

    def cos_sin(self, *_: Any) -> Any:
        raise NoProgram

    root = cos_sin


SIGNS = np.array([1.0, -1.0, -1.0, 1.0]), np.array([1.0, 1.0, -1.0, -1.0])
"""The signs of cosine and sine, by the number of quarter turns."""

DOUBLES = Doubles()


def precise_cos_sin(degrees: Fraction) -> tuple[Fraction, Fraction]:
    """Return cosine and sine to 70 digits; exact if they are rational."""
    try:
        return EXACT.cos_sin_of_degrees(degrees)
    except Irrational:
        cos, sin = EIGHTY_DIGITS.cos_sin_of_degrees(degrees % 360)
        return Fraction(cos.lo), Fraction(sin.lo)


# When a double is right: within the promise of `certified`, or nearest to the exact value


def proven_double(value: Bounded, accuracy: Accuracy) -> tuple[Term, Formula | None]:
    """Return a value as a double, and the condition that it is right in a row; None if it always is.

    A double is the nearest one if both ends of the bound round to it.
    """
    double: Any = value.parts[0] if value.positive else value.parts[0] + 0.0  # 0.0 makes 0 of -0
    if accuracy == "exact":
        first, second = (*value.parts, 0.0)[:2]
        error = absolute(first) * (value.bound + END_ERROR)
        ends = [equal(first + (second - error), first), equal(first + (second + error), first)]
        return double, either(both(*ends), equal(value.bound, 0.0))
    if not isinstance(value.row_error, Formula) and value.fixed_error <= MOST_ERROR:
        return double, None
    return double, at_most(value.row_error, MOST_ERROR - value.fixed_error)
