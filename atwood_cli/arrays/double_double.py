"""Double-doubles: pairs of doubles with a proven error bound, at the least cost for about four more digits.

A `Pair` stands for high + low, with up to twice the digits of a double. The bound on its relative error is
the same in all rows. It holds in rows that meet certain conditions, which fail where terms cancel. Two
arithmetics compute with pairs. `ROUNDED` rounds products to a double, which is cheaper; `QUICK` multiplies by
heads of 26 bits, which loses less. Each class derives its bounds, and each method what it adds to them.
(`expansion` is dearer and more accurate.) The parts of a pair are formulas of columns, or numbers.

Let u = 2^-53. Three things are assumed. Doubles follow IEEE 754, as in `error_free`. NumPy's log1p is within
one unit in the last place, 2u of the value (`LIBRARY`; the tests measure at most 0.7 units). And inputs are 0
or within 2^±120 (`WINDOW`), which the caller checks. So no product of the equations leaves the normal
doubles, but for squares that are negligible beside what they are added to.

Bounds are of first order. Products of two bounds are left out, and so are the rounding errors of the columns
that conditions compare. That is of second order: the limits that bounds are compared with leave room for it.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from math import frexp, log
from typing import Any

from ..arithmetic.lazy import lazy
from ..arithmetic.symbolic import Formula, Term, formula
from .double import Conditions, Uncertified, absolute, at_most, joined, looked_up, maximum, minimum, with_all
from .error_free import UNIT, fast_two_difference, fast_two_sum, head_of, two_difference, two_sum
from .tables import STEPS, heads_and_tails, in_parts, ln2, pi, precise_cos_sin, whole_powers

WINDOW = 2.0**-120, 2.0**120
LIBRARY = 2 * UNIT
LOOSE = 2**14 * UNIT**2  # the second-order error of a rounded operation
LOSS = 2.0**-67  # the error of a quick operation
NEARLY = 0.4 * UNIT  # a divisor this close to a double, such as π, is taken for the double
LARGEST = 36.0  # argument of an exponential
TOLERANCE = 2.0**-55
"""The bound of a difference; rows in which its error may be larger are not certified."""


class Pair:
    """high + low, with a relative error up to ``loss`` + ``doubt`` in rows that meet the conditions ``sure``.

    ``low`` is None where there is none. ``positive`` says that no row is negative; ``covers`` is a number
    that is larger than this one in no row. ``loss`` is the same in all rows, and ``doubt`` is a column, or
    None. Bounds add up in products and quotients; for sums see `_plus`.
    """

    def __init__(
        self,
        arithmetic: Quick,
        high: Term,
        low: Term | None = None,
        loss: float = 0.0,
        doubt: Term | None = None,
        positive: bool = True,
        sure: Conditions = (),
    ) -> None:
        self.arithmetic, self.high, self.low = arithmetic, high, low
        self.loss, self.doubt, self.positive, self.sure = loss, doubt, positive, sure
        self.covers: Pair | None = None
        self._halves: tuple[Any, Any] | None = None

    @property
    def exact(self) -> bool:
        """Whether this is a double, or a column of them."""
        return self.low is None and self.loss == 0

    @property
    def is_zero(self) -> bool:
        return self.exact and not isinstance(self.high, Formula) and self.high == 0

    @property
    def power(self) -> float:
        """The value if it is ±2^n, a factor that causes no rounding; else 0."""
        if isinstance(self.high, Formula) or not self.exact:
            return 0.0
        return self.high if abs(frexp(self.high)[0]) == 0.5 else 0.0

    def _meet(self, other: Pair | Fraction | int) -> tuple[Pair, Pair]:
        """Both numbers in one arithmetic: `ROUNDED` if theirs differ."""
        two = other if isinstance(other, Pair) else self.arithmetic.number(other)
        if two.arithmetic is self.arithmetic:
            return self, two
        return self.rounding(), two.rounding()

    def rounding(self) -> Pair:
        """This number in the arithmetic `ROUNDED`."""
        if self.arithmetic is ROUNDED:
            return self
        own = self if self.exact or self.low is None else self.normal()
        pair = Pair(ROUNDED, own.high, own.low, own.loss, own.doubt, own.positive, own.sure)
        pair.covers = self.covers
        return pair

    def __add__(self, other: Pair | int) -> Pair:
        return self._plus(other, difference=False)

    __radd__ = __add__

    def __sub__(self, other: Pair | int) -> Pair:
        return self._plus(other, difference=True)

    def _plus(self, other: Pair | int, difference: bool) -> Pair:
        """The sum or difference, and its error bound.

        The high parts are added with their rounding error, which joins the low parts. How that is done, and
        what the bound is, depends on what is known of the terms. Where neither is negative, their sum is no
        less accurate than the less accurate term. (Where one term is known to be the smaller one, it is at
        most half of the sum, so only half of its bound counts, beside half of the other's.) A difference may
        cancel: the errors of both terms are added and compared with what is left. The bound of a difference
        is `TOLERANCE`, on condition that they are within it.
        """
        one, two = self._meet(other)
        if two.is_zero:
            return one
        if not difference and two.is_never_below(one):
            one, two = two, one
        ordered = one.is_never_below(two)
        positive = one.positive and two.positive
        if ordered:
            high, low = (fast_two_difference if difference else fast_two_sum)(one.high, two.high)
        elif positive and not difference:
            high, low = fast_two_sum(maximum(one.high, two.high), minimum(one.high, two.high))
        else:
            high, low = (two_difference if difference else two_sum)(one.high, two.high)
        if one.low is not None:
            low = low + one.low
        if two.low is not None:
            low = low - two.low if difference else low + two.low
        sure, own_loss = with_all(one.sure, two.sure), one.arithmetic.sum_loss
        result = Pair(one.arithmetic, high, low, positive=positive and (ordered or not difference), sure=sure)
        if one.exact and two.exact:
            return result
        if positive and not difference:
            smaller = (one.loss + two.loss) / 2 if ordered else two.loss
            result.loss = max(one.loss, smaller) + own_loss
            for term in (one, two):
                if term.doubt is not None:
                    result.sure = with_all(result.sure, (at_most(term.doubt, TOLERANCE),))
                    result.loss += TOLERANCE
            return result
        result = result.normal()
        result.loss = TOLERANCE
        error = one.error(own_loss) + two.error(own_loss)
        result.sure = with_all(sure, (at_most(error, absolute(result.high) * TOLERANCE),))
        return result

    def is_never_below(self, other: Pair) -> bool:
        """Whether it is known that this number is at least the other one in all rows."""
        return self.covers is not None and self.covers.high is other.high

    def normal(self) -> Pair:
        """This number with a low part of at most half a unit in the last place."""
        assert self.low is not None
        high = self.rounded()
        low = (self.high - high) + self.low
        return Pair(self.arithmetic, high, low, self.loss, self.doubt, self.positive, self.sure)

    def error(self, more: float) -> Any:
        """The bound on the absolute error, if the relative error is larger by ``more``."""
        return (self.high if self.positive else absolute(self.high)) * joined(self.doubt, self.loss + more)

    def halved(self) -> Pair:
        """This number, whose high part is known to have 26 bits, so that it need not be split."""
        self._halves = self.high, self.low
        return self

    def halves(self) -> tuple[Any, Any]:
        """Two columns, head and tail, that add up to this; the head has 26 bits."""
        if self._halves is None:
            head = head_of(self.high)
            tail = self.high - head
            self._halves = head, tail if self.low is None else tail + self.low
        return self._halves

    def rounded(self) -> Any:
        """The double that high + low round to."""
        return self.high if self.low is None else self.high + self.low

    def _scaled(self, factor: float) -> Pair:
        """This number times ±2^n."""
        low = None if self.low is None else self.low * factor
        positive = self.positive and factor > 0
        return Pair(self.arithmetic, self.high * factor, low, self.loss, self.doubt, positive, self.sure)

    def __mul__(self, other: Pair | Fraction | int) -> Pair:
        one, two = self._meet(other)
        for factor, of in ((one, two), (two, one)):
            if factor.is_zero:
                return factor
            if factor.power:
                return of if factor.power == 1 else of._scaled(factor.power)
        return one.arithmetic.product(one, two)

    __rmul__ = __mul__

    def __truediv__(self, other: Pair | int) -> Pair:
        one, two = self._meet(other)
        if two.power:
            return one._scaled(1 / two.power)
        return one.arithmetic.quotient(one, two)

    def __rtruediv__(self, other: int) -> Pair:
        one: Pair = self.arithmetic.number(other)
        return one / self

    def of_factors(self, other: Pair, high: Term, low: Term | None, loss: float) -> Pair:
        """The product or quotient of two pairs, from its parts and the loss of the operation itself."""
        return Pair(
            self.arithmetic,
            high,
            low,
            self.loss + other.loss + loss,
            joined(self.doubt, other.doubt),
            self.positive and other.positive,
            with_all(self.sure, other.sure),
        )


class Quick:
    """Products, quotients, roots and exponentials by heads of 26 bits; logarithms by NumPy.

    A factor is split into its head, the first 26 bits of the high part, and the tail, which is the rest. The
    product of two heads is exact. So low parts are not small: |low| <= t |high|. Each product, quotient and
    root adds 2^-25 to t for every head that it cuts. A sum has no larger t than its terms, and a difference
    is made normal. No quantity takes more than 60 operations, so t < 2^-18. Only tails and remainders are
    rounded, and none of them is above 2t of the result. A product loses 7 u t, a quotient 9 u t, a root or
    sum less. That is below 2^-67 (`LOSS`) of the result, or of both terms in a difference.

    Where a difference leaves less than t of its terms, `normal` may round off 2 u t of the terms, and the low
    part that is left may exceed t. The bound, at least 2^-66/t, is larger than what that loses. It is also so
    large that the row is not certified, and more digits are asked for.
    """

    sum_loss = LOSS  # of a sum, beside the losses of its terms

    def number(self, q: Any) -> Pair:
        """The pair of a number, or of a column of exact doubles."""
        if isinstance(q, Pair):
            return q.rounding() if self is ROUNDED else q
        if isinstance(q, Formula):
            return Pair(self, q)
        high = float(q)
        rest = q - Fraction(high)
        low = float(rest)
        if not low:
            return Pair(self, high, positive=high >= 0)
        left = abs(float((rest - Fraction(low)) / q)) * 1.001
        return Pair(self, high, low, left, positive=high >= 0)

    def is_zero(self, x: Pair) -> bool:
        return x.is_zero

    @lazy
    def pi(self) -> Pair:
        return self.number(pi())

    def hypot(self, x: Pair, y: Pair | int) -> Pair:
        return self.sqrt(x * x + y * y)

    def exp(self, x: Pair) -> Pair:
        return self.expm1(x) + 1

    def cos_sin(self, x: Any) -> tuple[Pair, Pair]:
        raise Uncertified

    def cos_sin_of_degrees(self, x: Any) -> tuple[Pair, Pair]:
        """Cosine and sine of an angle in degrees that is the same in all rows."""
        if not isinstance(x, Fraction):
            raise Uncertified
        cos, sin = map(self.number, precise_cos_sin(x))
        return cos, sin

    def root(self, f: Callable[[Pair], Pair], end: Pair) -> Pair:
        raise Uncertified

    def product(self, x: Pair, y: Pair) -> Pair:
        """High is the product of the heads, and low is head · tail + tail · whole.

        Rounded are the tails, one whole, two products and their sum: 7 u t.
        """
        if x.low is None:
            x, y = y, x  # the second factor's parts are added up: without a low part that costs nothing
        (x_head, x_tail), (y_head, y_tail) = x.halves(), y.halves()
        return x.of_factors(y, x_head * y_head, x_head * y_tail + x_tail * y.rounded(), LOSS)

    def quotient(self, x: Pair, y: Pair) -> Pair:
        """High is the head q of the rounded quotient, and low is ((x - q · head) - q · tail)/whole.

        Rounded are the steps of a product and two divisions: 9 u t.
        """
        whole, (head, tail) = y.rounded(), y.halves()
        high = head_of(x.high / whole)
        return x.of_factors(y, high, _rest(x, high * head, high * tail) / whole, LOSS).halved()

    def sqrt(self, x: Pair) -> Pair:
        """High is the head v of the rounded root w, and low is (x - v²)/(w + v) ≈ √x - v."""
        root = Formula("sqrt", formula(x.rounded()))
        high = head_of(root)
        doubt = None if x.doubt is None else x.doubt / 2
        low = _rest(x, high * high, None) / (high + root)
        return Pair(self, high, low, x.loss / 2 + LOSS, doubt, sure=x.sure).halved()

    def expm1(self, x: Pair) -> Pair:
        """k = e^x - 1 for x >= 0; beyond x = 36 (`LARGEST`) its bound is NaN.

        Let n ln 2/16384 be the multiple nearest to x, a = 2^(n/16384) - 1, from a table, and r = e^y - 1 for
        the rest y of x, |y| < 2^-15.5. Then 1 + k = (1 + a)(1 + r), so k = a + r (1 + a), where nothing
        cancels. a is a head, exact for x <= 36, and a tail. 1 + a is rounded twice, r and their product once
        each: 4 u r, below 2^-66 of e^x, which is 2^-66 (1 + 1/k) of k. The terms of r's series after the
        first are doubles and lose less than 2^-66 of r; the first one left out is 2^-69 r. Where n = 0, a = 0
        and r (1 + a) is exact, so only these losses count. An error of x counts x + 1 times, because
        x e^x < (x + 1)(e^x - 1); each part of the multiple of ln 2 that joins x's low part adds u t x to it.
        """
        # At 2 `LARGEST` the table of whole powers has ended, so larger numbers give NaN as well.
        count = Formula("rint", minimum(x.rounded(), 2 * LARGEST) * (STEPS / log(2)))
        first, last = in_parts(ln2() / STEPS, 30, 1)
        low = count * -last if x.low is None else count * -last + x.low
        rest = Pair(self, x.high - count * first, low).normal()
        r: Any = rest.high
        terms = (((r * (1 / 24) + 1 / 6) * r + 1 / 2) * r) * r + rest.low
        number = Formula("int", count)
        step = Formula("bits", number, STEPS - 1)
        power = looked_up(whole_powers(), Formula(">>", number, STEPS.bit_length() - 1))
        heads, tails = heads_and_tails()
        head = looked_up(heads, step) * power + (power - 1.0)
        tail = looked_up(tails, step) * power
        factor = head + 1.0 + tail
        high, low = fast_two_sum(head, factor * r)
        loss = 2.0**-66 + (x.loss + LOSS) * (1 + LARGEST)
        k = Pair(self, high, low + factor * terms + tail, loss, sure=x.sure)
        k.doubt = minimum(count, 1.0) * 2.0**-66 / k.rounded()
        if x.doubt is not None:
            k.doubt = k.doubt + x.doubt * (1 + LARGEST)
        return k.normal()

    def log1p(self, x: Pair) -> Pair:
        """ln(1 + x) for x >= 0 by NumPy, with no more digits than a double."""
        x = x if x.low is None else x.normal()
        high = Formula("log1p", formula(x.high))
        low = None if x.low is None else x.low / (x.high + 1.0)
        # From here on a quick product would be no more accurate than a rounded one.
        return Pair(ROUNDED, high, low, LIBRARY + x.loss + LOOSE, x.doubt, sure=x.sure)


def _rest(x: Pair, product: Term, more: Term | None) -> Any:
    """x minus a product, which comes in one or two parts."""
    rest = x.high - product if more is None else x.high - product - more
    return rest if x.low is None else rest + x.low


class Rounded(Quick):
    """Products and quotients are rounded to a double, and low parts are small.

    Each product or quotient loses u, and an error of second order. Low parts are a few u: they start with at
    most half a unit in the last place (`Pair.normal`) and grow by u per operation. In 60 operations the
    products of two low parts and the roundings of low parts come to less than `LOOSE` = 2^14 u². Results of
    quick operations are made normal first.
    """

    sum_loss = LOOSE

    def product(self, x: Pair, y: Pair) -> Pair:
        high, low = x.high * y.high, None
        for a, b in (x.high, y.low), (y.high, x.low):
            if b is not None:
                low = a * b if low is None else low + a * b
        return x.of_factors(y, high, low, UNIT + LOOSE)

    def quotient(self, x: Pair, y: Pair) -> Pair:
        """x/y. The low part of a constant y counts as loss if it is below 0.4 u of y, as the 0.35 u of π."""
        high: Any = x.high / y.high
        low: Any = x.low
        loss = UNIT + LOOSE
        if y.low is not None:
            near = y.loss + (1.0 if isinstance(y.low, Formula) else absolute(y.low / y.high))
            if near < NEARLY:
                loss += near
            else:
                low = -1.0 * high * y.low if low is None else low - high * y.low
        if low is not None:
            low = low / y.high
        return x.of_factors(y, high, low, loss)

    def sqrt(self, x: Pair) -> Pair:
        return super().sqrt(x).normal()

    def expm1(self, x: Pair) -> Pair:
        return super().expm1(x).normal()


ROUNDED, QUICK = Rounded(), Quick()
