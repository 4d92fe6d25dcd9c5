"""Double-doubles, pairs of doubles that know their error, for the least cost that four digits more allow.

A `Pair` stands for high + low, about twice the digits of a double, with a proven bound on its relative
error, the same in all rows, but for those in which terms cancelled: it is vouched for where certain
conditions hold. Two arithmetics compute with pairs and differ in cost and in loss: products are *rounded*
to a double, or *quick*, by heads of 26 bits. Each class argues its bounds, and each method what it loses
beyond them. (`expansion` has what is thorough.) The parts of a pair are formulas of columns, or numbers.

Let u = 2^-53. What is assumed: IEEE 754 double arithmetic, as in `error_free`; that NumPy's log1p, cos
and sin are within one unit in the last place, 2u of the value (`LIBRARY`; 0.7 was the most that `tests`
measured); and that inputs are 0 or within 2^±120 (`WINDOW`), so that no product of the equations leaves
the normal doubles, but for squares that do not matter beside what they are added to. To check the inputs
is up to the caller.

Bounds are kept in first order. What conditions are made of is taken as it is computed: that is of second
order, as is the product of two bounds, and whoever compares a bound leaves room for it.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from math import frexp, log
from typing import Any

from .double import (
    Conditions,
    Unvouched,
    absolute,
    at_most,
    joined,
    looked_up,
    maximum,
    minimum,
    with_all,
)
from .error_free import (
    UNIT,
    fast_two_difference,
    fast_two_sum,
    head_of,
    two_difference,
    two_sum,
)
from .lazy import lazy
from .symbolic import Formula, Part, formula
from .tables import STEPS, heads_and_tails, in_parts, ln2, pi, precise_cos_sin, whole_powers

WINDOW = 2.0**-120, 2.0**120
LIBRARY = 2 * UNIT
LOOSE = 2**14 * UNIT**2  # of second order, lost by a rounded operation
LOSS = 2.0**-67  # lost by a quick one
NEARLY = 0.4 * UNIT  # off, a constant such as π may be divided by as if it were a double
LARGEST = 36.0  # argument of an exponential
TOLERANCE = 2.0**-55
"""What a difference may be off by; rows in which it may be more are not vouched for."""


class Pair:
    """high + low, off by at most ``loss`` + ``doubt`` of itself where it is ``sure``.

    ``low`` is None where high is exact. ``positive`` says that no row is negative, ``covers`` names a number
    that is larger than this in no row. Of the relative error bound, ``loss`` is the same in all rows, and
    ``doubt`` a column, or None. It adds up in products and quotients; for sums see `_plus`. ``sure`` are
    conditions, in rows that meet all of which the bound holds.
    """

    def __init__(
        self,
        arithmetic: Quick,
        high: Part,
        low: Part | None = None,
        loss: float = 0.0,
        doubt: Part | None = None,
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
        """The value, where it is a power of two, or -1 times one: a factor that rounds nothing; else 0."""
        if isinstance(self.high, Formula) or not self.exact:
            return 0.0
        return self.high if abs(frexp(self.high)[0]) == 0.5 else 0.0

    def _meet(self, other: Pair | Fraction | int) -> tuple[Pair, Pair]:
        """Both, as the less accurate of their arithmetics takes them."""
        two = other if isinstance(other, Pair) else self.arithmetic.number(other)
        if two.arithmetic is self.arithmetic:
            return self, two
        return self.rounding(), two.rounding()

    def rounding(self) -> Pair:
        """This number as `ROUNDED` takes it."""
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
        """The sum or difference.

        A sum of what is not negative inherits the larger bound; of a term that is the smaller one in all
        rows, which is at most half of the sum, half the bound counts beside half the other's. In a difference
        bounds count as much as the terms weigh beside what is left: where that is more than `TOLERANCE` it
        is not sure.
        """
        one, two = self._meet(other)
        if two.is_zero:
            return one
        ordered = one.covers is not None and one.covers.high is two.high
        if not difference and two.covers is not None and two.covers.high is one.high:
            one, two, ordered = two, one, True
        positive = one.positive and two.positive
        together = positive and not difference
        if ordered:
            high, low = (fast_two_difference if difference else fast_two_sum)(one.high, two.high)
        elif together:
            high, low = fast_two_sum(maximum(one.high, two.high), minimum(one.high, two.high))
        else:
            high, low = (two_difference if difference else two_sum)(one.high, two.high)
        if one.low is not None:
            low = low + one.low
        if two.low is not None:
            low = low - two.low if difference else low + two.low
        sum_ = Pair(one.arithmetic, high, low, positive=together or (ordered and positive))
        sum_.sure = with_all(one.sure, two.sure)
        if one.exact and two.exact:
            return sum_
        loss = one.arithmetic.sum_loss
        if together:
            smaller = (one.loss + two.loss) / 2 if ordered else two.loss
            sum_.loss = max(one.loss, smaller) + loss
            for term in (one, two):
                if term.doubt is not None:
                    sum_.sure = with_all(sum_.sure, (at_most(term.doubt, TOLERANCE),))
                    sum_.loss += TOLERANCE
            return sum_
        sum_ = sum_.normal()
        off = one.off_by(loss) + two.off_by(loss)
        sum_.loss, sum_.doubt = TOLERANCE, None
        sum_.sure = with_all(sum_.sure, (at_most(off, absolute(sum_.high) * TOLERANCE),))
        return sum_

    def normal(self) -> Pair:
        """This number with a low part of at most half a unit in the last place."""
        assert self.low is not None
        high = self.rounded()
        low = (self.high - high) + self.low
        return Pair(self.arithmetic, high, low, self.loss, self.doubt, self.positive, self.sure)

    def off_by(self, more: float) -> Any:
        """How far this may be off, and more of itself."""
        return (self.high if self.positive else absolute(self.high)) * joined(self.doubt, self.loss + more)

    def halved(self) -> Pair:
        """This number, where its high part is known to have 26 bits: it is split already."""
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
        """This number times a power of two, or -1 times one."""
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

    def of_factors(self, other: Pair, high: Part, low: Part | None, loss: float) -> Pair:
        """The product or quotient of two pairs, from its parts and what is lost in it."""
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
    """Products, quotients, roots and exponentials by heads of 26 bits; logarithms as NumPy has them.

    Factors are split into a head of 26 bits, the double with its other bits cut off, and a tail: the
    product of the heads is exact. So low parts are not small, but |low| <= t |high|, where each product,
    quotient and root adds 2^-25 for every head that it cuts to what its operands have; a sum has no more
    than its terms, and a difference is made normal. As no quantity takes more than 60 operations on the
    way, t < 2^-18. Every rounding is one of a tail or a remainder, none of them above 2t of the result.
    A product has 7 times u t of them, a quotient 9, a root or sum fewer: each loses less than 2^-67 of the
    result, or of both terms in a difference (`LOSS`).

    Where a difference leaves less than t of its terms, `normal` may round as well, 2 u t of the terms, and
    what is left may have a low part beyond t: its bound, at least 2^-66/t, is so large that whoever looks
    at it asks for more digits anyway, and is larger than what that low part loses.
    """

    sum_loss = LOSS  # what a sum loses

    def number(self, q: Any) -> Pair:
        """The pair for a number, or for a column of exact doubles."""
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
        raise Unvouched

    def cos_sin_of_degrees(self, x: Any) -> tuple[Pair, Pair]:
        """Cosine and sine of a number of degrees that is the same in all rows."""
        if not isinstance(x, Fraction):
            raise Unvouched
        cos, sin = map(self.number, precise_cos_sin(x))
        return cos, sin

    def root(self, f: Callable[[Pair], Pair], end: Pair) -> Pair:
        raise Unvouched

    def product(self, x: Pair, y: Pair) -> Pair:
        """The product of the heads, and as low part (head tail + tail whole).

        Roundings: the tails, one whole, two products, their sum, 7 times u t.
        """
        if x.low is None:
            x, y = y, x  # so that y, of whom the whole is needed, has it at hand
        (x_head, x_tail), (y_head, y_tail) = x.halves(), y.halves()
        return x.of_factors(y, x_head * y_head, x_head * y_tail + x_tail * y.rounded(), LOSS)

    def quotient(self, x: Pair, y: Pair) -> Pair:
        """The head q of the rounded quotient, and as low part ((x - q head) - q tail)/whole.

        Roundings: those of a product and two divisions, 9 times u t.
        """
        whole, (head, tail) = y.rounded(), y.halves()
        high = head_of(x.high / whole)
        return x.of_factors(y, high, _rest(x, high * head, high * tail) / whole, LOSS).halved()

    def sqrt(self, x: Pair) -> Pair:
        """The head v of the rounded root w, and as low part (x - v²)/(w + v) ≈ √x - v."""
        root = Formula("sqrt", formula(x.rounded()))
        high = head_of(root)
        doubt = None if x.doubt is None else x.doubt / 2
        low = _rest(x, high * high, None) / (high + root)
        return Pair(self, high, low, x.loss / 2 + LOSS, doubt, sure=x.sure).halved()

    def expm1(self, x: Pair) -> Pair:
        """e^x - 1 for x >= 0; beyond e^36 (`LARGEST`) its bound is no number.

        1 + k = (1 + a)(1 + r), with n the nearest multiple of ln 2/16384 to x and a = 2^(n/16384) - 1 from a
        table, so |r| < 2^-15.5, and k = a + r (1 + a), in which nothing cancels. With a 2^m, and 2^m - 1, as
        a head that is exact for x <= 36 and a tail, 1 + a is rounded twice, r and their product once each:
        4 u r, less than 2^-66 of e^x, which is 2^-66 (1 + 1/k) of k. The other terms, below r², are doubles
        and lose less than 2^-66 of r; the next one would be 2^-69 r. Where n = 0, a = 0 and r (1 + a) is
        exact: that is all. An error of x counts x + 1 times, as x e^x < (x + 1)(e^x - 1), with u t x for
        each time that a part of the multiple of ln 2 adds to what x has as low part.
        """
        # What is too large stays so, as no whole number has that many bits.
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
        """ln(1 + x) for x >= 0 as NumPy has it, with no more digits than a double."""
        x = x if x.low is None else x.normal()
        high = Formula("log1p", formula(x.high))
        low = None if x.low is None else x.low / (x.high + 1.0)
        # Exact products gain nothing from here on.
        return Pair(ROUNDED, high, low, LIBRARY + x.loss + LOOSE, x.doubt, sure=x.sure)


def _rest(x: Pair, product: Part, more: Part | None) -> Any:
    """What of x is beyond a product in one or two parts."""
    rest = x.high - product if more is None else x.high - product - more
    return rest if x.low is None else rest + x.low


class Rounded(Quick):
    """Products and quotients are rounded to a double, and low parts small.

    Each product or quotient loses u, and what is of second order: low parts are a few u, as they start with
    at most half a unit in the last place (`Pair.normal`) and grow by u per operation. A low part counts
    once, in first order: 60² u² and the roundings of low parts are less than `LOOSE` = 2^14 u². What comes
    from a quick operation is made normal first.
    """

    sum_loss = LOOSE

    def product(self, x: Pair, y: Pair) -> Pair:
        high, low = x.high * y.high, None
        for a, b in (x.high, y.low), (y.high, x.low):
            if b is not None:
                low = a * b if low is None else low + a * b
        return x.of_factors(y, high, low, UNIT + LOOSE)

    def quotient(self, x: Pair, y: Pair) -> Pair:
        """x/y. The low part of a constant y counts as lost if it is less than 0.4 u of it; π's is 0.35."""
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
