"""Double-doubles, pairs of doubles that know their error; columns, a row a scene.

A `Pair` stands for high + low, about twice the digits of a double, with a proven bound on its relative
error, so that whoever rounds it can tell whether four units in the last place, or the nearest double, is
what came out. Three arithmetics compute with pairs and differ in cost and in loss: products are *rounded*
to a double, *quick*, by heads of 26 bits, or *thorough*. Each class argues its bounds, and each method
what it loses beyond them.

Let u = 2^-53. What is assumed: IEEE 754 double arithmetic, as in `error_free`; that NumPy's log1p, cos
and sin are within one unit in the last place, 2u of the value (`LIBRARY`; 0.7 was the most that `tests`
measured); and that inputs are 0 or within 2^±120 (`WINDOW`), so that no product of the equations leaves
the normal doubles, but for squares that do not matter beside what they are added to. To check the inputs
is up to the caller.

Bounds are kept in first order. What they are made of is taken as it is computed: sizes from results, the
weights of terms from values. That is of second order, as is the product of two bounds, and whoever
compares a bound leaves room for it.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import cache
from math import frexp, ldexp
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .double import ENOUGH, fold, precise_cos_sin
from .error_free import UNIT, Column, fast_two_sum, head_of, scratch, two_product, two_sum
from .lazy import lazy

WINDOW = 2.0**-120, 2.0**120
LIBRARY = 2 * UNIT
LOOSE = 2**14 * UNIT**2  # of second order, lost by a rounded operation
LOSS = 2.0**-67  # lost by a quick one
NEARLY = 0.4 * UNIT  # off, a constant such as π may be divided by as if it were a double
LARGE, LARGEST = 36.0, 700.0  # argument of an exponential, quick and thorough
COARSE, FINER = 16_384, 4  # steps of its tables to a factor of 2, and to a coarse step
FINE = COARSE * FINER
MANY = 256  # single numbers kept


class Unvouched(ArithmeticError):
    """This arithmetic has no bound for the operation: take a more accurate one."""


class Pair:
    """high + low, off by at most ``bound`` of itself; ``low``, the low part, is None where high is exact.

    Columns have the shape (n,), single numbers (1,). ``positive`` says that no row is negative. The error
    bound is ``loss``, the same in all rows, and ``doubt``, a column or None, where terms cancelled. It adds
    up in products and quotients; for sums see `_plus`.
    """

    __slots__ = ("_kept", "arithmetic", "doubt", "high", "loss", "low", "near", "positive", "power")

    def __init__(
        self,
        arithmetic: Pairs,
        high: Column,
        low: Column | None = None,
        loss: float = 0.0,
        doubt: Column | None = None,
        positive: bool = True,
    ) -> None:
        self.arithmetic, self.high, self.low, self.positive = arithmetic, high, low, positive
        self.loss, self.doubt = loss, doubt
        self.power = 0.0  # the value, where it is a single power of two: a factor that rounds nothing
        self.near = 1.0  # how far the high part of a constant is off by itself
        # What was made of it; shared by all arithmetics if it has lost nothing.
        self._kept: dict[Any, Any] = {}

    @property
    def bound(self) -> Any:
        return self.loss if self.doubt is None else self.doubt + self.loss

    def _meet(self, other: Pair | Fraction | int) -> tuple[Pair, Pair]:
        """Both, as the less accurate of their arithmetics takes them."""
        two = other if isinstance(other, Pair) else self.arithmetic.number(other)
        if two.arithmetic is self.arithmetic:
            return self, two
        arithmetic = min(self.arithmetic, two.arithmetic, key=LEVELS.index)
        return self.taken_by(arithmetic), two.taken_by(arithmetic)

    def taken_by(self, arithmetic: Pairs) -> Pair:
        """This number in another arithmetic; made normal unless it has lost nothing."""
        if self.arithmetic is arithmetic:
            return self
        lossless = self.loss == 0 and self.doubt is None
        own = self if lossless or self.low is None else self.normal()
        pair = Pair(arithmetic, own.high, own.low, own.loss, own.doubt, own.positive)
        pair.power, pair.near = own.power, own.near
        if lossless:
            pair._kept = own._kept
        return pair

    def __add__(self, other: Pair | int) -> Pair:
        return self._plus(other, np.add)

    __radd__ = __add__

    def __sub__(self, other: Pair | int) -> Pair:
        return self._plus(other, np.subtract)

    def _plus(self, other: Pair | int, add: Any) -> Pair:
        """The sum, or the difference if ``add`` is np.subtract.

        A sum of what is not negative inherits the larger bound; of a term that is the smaller one in all
        rows, which is at most half of the sum, half the bound counts beside half the other's. In a
        difference, and a sum of what is off by more than a few u in more than a few rows, bounds count as
        much as the terms weigh beside what is left, row by row: a row that cancels is told from its
        neighbours, and only such rows pay for more digits.
        """
        one, two = self._meet(other)
        if add is np.add and two.high[0] > one.high[0]:
            one, two = two, one
        doubles = one.exact and two.exact
        key = add, id(two._kept)
        if doubles and key in one._kept:
            kept: Pair = one._kept[key][0]
            return kept.taken_by(one.arithmetic)
        positive = one.positive and two.positive
        ordered = positive and one._covers(two)
        together, loss = positive and add is np.add, one.arithmetic.sum_loss
        if ordered:
            high, low = fast_two_sum(one.high, two.high, add)
        elif together:
            larger, smaller = scratch(2, max(one.high.size, two.high.size))
            np.maximum(one.high, two.high, out=larger)
            high, low = fast_two_sum(larger, np.minimum(one.high, two.high, out=smaller))
        else:
            high, low = two_sum(one.high, two.high, add)
        if one.low is not None:
            low += one.low
        if two.low is not None:
            add(low, two.low, out=low)
        sum_ = Pair(one.arithmetic, high, low)
        if doubles:
            sum_.positive = together or ordered or bool(high.min() >= 0)
            sum_._kept["whole"] = high
            if one.high.size > 1:  # single numbers outlive their rows
                one._kept[key] = sum_, two._kept  # which keeps its number
        elif together and one.arithmetic.trusts(one) and one.arithmetic.trusts(two):
            sum_.loss = max(one.loss, (one.loss + two.loss) / 2 if ordered else two.loss) + loss
            sum_.doubt = one.doubt if one.doubt is two.doubt else _both(one.doubt, two.doubt, np.maximum)
        else:
            sum_ = sum_.normal()
            sum_.positive = together or bool(sum_.high.min() >= 0)
            weighed = one._weighed(
                one.bound + loss, two.bound + loss, None if ordered and not together else two
            )
            sum_.doubt = weighed / (sum_.high if sum_.positive else np.abs(sum_.high))
            if np.isnan(sum_.doubt.min()):  # 0 plus or minus 0 is 0
                sum_.doubt = np.where(weighed == 0, 0.0, sum_.doubt)
        return sum_

    def _covers(self, two: Pair) -> bool:
        """Whether no row of the other is larger, where neither has negative ones."""
        x, y = self.high, two.high
        if (np.subtract, id(two._kept)) in self._kept:
            difference: Pair = self._kept[np.subtract, id(two._kept)][0]
            return difference.positive
        if not (y[:16] <= x[:16]).all():
            return False
        return bool(y.max() <= x[0] if x.size == 1 else (y <= x).all())

    def _weighed(self, bound: Any, other: Any, two: Pair | None) -> Any:
        """How far a sum may be off, from the bounds of its terms; None for one that is no larger."""
        size = self.high if self.positive else np.abs(self.high)
        if two is None:
            return size * (bound + other)
        return size * bound + (two.high if two.positive else np.abs(two.high)) * other

    @property
    def exact(self) -> bool:
        """Whether this is a double, or a column of them."""
        return self.low is None and self.doubt is None and self.loss == 0

    def normal(self) -> Pair:
        """This number with a low part of at most half a unit in the last place."""
        assert self.low is not None
        high = self.rounded()
        if high is self.high:
            return self
        low = self.high - high
        low += self.low
        normal = Pair(self.arithmetic, high, low, self.loss, self.doubt, self.positive)
        normal._kept["whole"] = high
        return normal

    def halved(self) -> Pair:
        """This number, where its high part is known to have 26 bits: it is split already."""
        assert self.low is not None
        self._kept["halves"] = self.high, self.low
        return self

    def halves(self) -> tuple[Column, Column]:
        """Two columns, head and tail, that add up to this; the head has 26 bits."""
        if "halves" not in self._kept:
            head = head_of(self.high)
            tail = self.high - head
            if self.low is not None:
                tail += self.low
            self._kept["halves"] = head, tail
        halves: tuple[Column, Column] = self._kept["halves"]
        return halves

    def rounded(self) -> Column:
        """The double that high + low round to."""
        if self.low is None:
            return self.high
        if "whole" not in self._kept:
            self._kept["whole"] = self.high + self.low
        whole: Column = self._kept["whole"]
        return whole

    def _scaled(self, factor: float) -> Pair:
        """This number times a power of two, or -1."""
        low = None if self.low is None else self.low * factor
        positive = self.positive and factor > 0
        scaled = Pair(self.arithmetic, self.high * factor, low, self.loss, self.doubt, positive)
        scaled.near = self.near
        return scaled

    def __mul__(self, other: Pair | Fraction | int) -> Pair:
        one, two = self._meet(other)
        for factor, of in ((one, two), (two, one)):
            if factor.power:
                return of._scaled(factor.power)
        return one.arithmetic.product(one, two)

    __rmul__ = __mul__

    def __truediv__(self, other: Pair | int) -> Pair:
        one, two = self._meet(other)
        if two.power:
            return one._scaled(1 / two.power)
        return one.arithmetic.quotient(one, two)

    def of_factors(self, other: Pair, high: Column, low: Column | None, loss: float) -> Pair:
        """The product or quotient of two pairs, from its parts and what is lost in it."""
        doubt = _both(self.doubt, other.doubt, np.add)
        positive = self.positive and other.positive
        return Pair(self.arithmetic, high, low, self.loss + other.loss + loss, doubt, positive)

    def __rtruediv__(self, other: int) -> Pair:
        one: Pair = self.arithmetic.number(other)
        return one / self

    def take(self, index: NDArray[np.intp]) -> Pair:
        """This number in some of its rows."""
        low, doubt = (None if part is None else part.take(index) for part in (self.low, self.doubt))
        return Pair(self.arithmetic, self.high.take(index), low, self.loss, doubt, self.positive)


class Pairs:
    """What the arithmetics of pairs have in common; ``sum_loss`` is what a sum loses."""

    sum_loss: float

    def __init__(self) -> None:
        self._singles: dict[tuple[int, int], Pair] = {}

    def product(self, x: Pair, y: Pair) -> Pair:
        raise NotImplementedError

    def quotient(self, x: Pair, y: Pair) -> Pair:
        raise NotImplementedError

    def sqrt(self, x: Pair) -> Pair:
        raise NotImplementedError

    def expm1(self, x: Pair) -> Pair:
        """e^x - 1 for x >= 0."""
        raise NotImplementedError

    def log1p(self, x: Pair) -> Pair:
        """ln(1 + x) for x >= 0."""
        raise NotImplementedError

    def trusts(self, x: Pair) -> bool:
        """Whether so few rows of a term are off by more than a few u that a sum need not weigh its terms."""
        return x.doubt is None or 50 * int(np.count_nonzero(x.doubt > 3 * UNIT)) <= x.doubt.size

    def number(self, q: Any) -> Any:
        """The pair for a number, or for a column of exact doubles."""
        if isinstance(q, Pair):
            return q.taken_by(self) if q.exact else q
        if isinstance(q, np.ndarray):
            return Pair(self, q)
        key = q.numerator, q.denominator  # to hash a Fraction takes longer
        single = self._singles.get(key)
        if single is None:
            if len(self._singles) > MANY:
                self._singles.clear()
            single = self._singles[key] = self._single(Fraction(q))
        return single

    def _single(self, q: Fraction) -> Pair:
        high = float(q)
        low = float(q - Fraction(high))
        if low:
            left = abs(float((q - Fraction(high) - Fraction(low)) / q)) * 1.001
            pair = Pair(self, np.array([high]), np.array([low]), left, positive=high >= 0)
            pair.near = abs(low / high) + left
            return pair
        number = Pair(self, np.array([high]), positive=high >= 0)
        number.power = high if abs(frexp(high)[0]) == 0.5 else 0.0
        return number

    def is_zero(self, x: Pair) -> bool:
        return x.high.size == 1 and x.exact and x.high[0] == 0

    @lazy
    def pi(self) -> Pair:
        return self._single(_pi())

    def hypot(self, x: Pair, y: Pair | int) -> Pair:
        return self.sqrt(x * x + y * y)

    def exp(self, x: Pair) -> Pair:
        return self.expm1(x) + 1

    def cos_sin(self, x: Pair) -> tuple[Pair, Pair]:
        """Cosine and sine, |x| <= 4."""
        x = x if x.low is None else x.normal()
        cos, sin = np.cos(x.high), np.sin(x.high)
        error = np.abs(x.high) * (x.bound + self.sum_loss)
        low = 0.0 if x.low is None else x.low
        return (
            Pair(self, cos, -sin * low, LIBRARY, error / np.abs(cos), positive=False),
            Pair(self, sin, cos * low, LIBRARY, error / np.abs(sin), positive=False),
        )

    def cos_sin_of_degrees(self, x: Any) -> tuple[Pair, Pair]:
        """Cosine and sine of a number of degrees, or of a column of exact ones."""
        if isinstance(x, Fraction):
            cos, sin = map(self.number, precise_cos_sin(x))
            return cos, sin
        folded, turn = fold(x.high)
        angle = self.pi * Pair(self, folded, positive=False) / 180
        cos, sin = self.cos_sin(angle)
        bounds = cos.bound, np.where(folded == 0, 0.0, sin.bound)
        highs, lows = (turn(getattr(cos, part), getattr(sin, part)) for part in ("high", "low"))
        cos, sin = (
            Pair(self, high, low, doubt=np.abs(bound), positive=False)
            for high, low, bound in zip(highs, lows, turn(*bounds), strict=True)
        )
        return cos, sin

    def root(self, f: Callable[[Pair], Pair], end: Pair) -> Pair:
        raise Unvouched


class Quick(Pairs):
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

    sum_loss = LOSS

    def product(self, x: Pair, y: Pair) -> Pair:
        """The product of the heads, and as low part (head tail + tail whole).

        Roundings: the tails, one whole, two products, their sum, 7 times u t.
        """
        if x.low is None:
            x, y = y, x  # so that y, of whom the whole is needed, has it at hand
        (x_head, x_tail), (y_head, y_tail) = x.halves(), y.halves()
        high = x_head * y_head
        low = x_head * y_tail
        low += np.multiply(x_tail, y.rounded(), out=scratch(1, high.size)[0])
        return x.of_factors(y, high, low, LOSS)

    def quotient(self, x: Pair, y: Pair) -> Pair:
        """The head q of the rounded quotient, and as low part ((x - q head) - q tail)/whole.

        Roundings: those of a product and two divisions, 9 times u t.
        """
        whole, (head, tail) = y.rounded(), y.halves()
        high = x.high / whole
        high = head_of(high, out=high)
        product, more = scratch(2, high.size)
        np.multiply(high, head, out=product)
        low = self._low_part(x, product, np.multiply(high, tail, out=more), whole)
        return x.of_factors(y, high, low, LOSS).halved()

    def sqrt(self, x: Pair) -> Pair:
        """The head v of the rounded root w, and as low part (x - v²)/(w + v) ≈ √x - v."""
        root = np.sqrt(x.rounded())
        high = head_of(root)
        (product,) = scratch(1, high.size)
        low = self._low_part(x, np.multiply(high, high, out=product), None, np.add(high, root, out=root))
        doubt = None if x.doubt is None else x.doubt / 2
        return Pair(self, high, low, x.loss / 2 + LOSS, doubt).halved()

    def _low_part(self, x: Pair, product: Column, more: Column | None, by: Column) -> Column:
        """The remainder x - product - more, divided: the low part of a quotient or root."""
        low = x.high - product
        if more is not None:
            low -= more
        if x.low is not None:
            low += x.low
        low /= by
        return low

    def expm1(self, x: Pair) -> Pair:
        """e^x - 1 for x >= 0; beyond e^36 (`LARGE`) its bound is infinite.

        As `_powers` says, with n the nearest, so |r| < 2^-15.5. With a 2^m, and 2^m - 1, as a head that is
        exact for x <= 36 and a tail, 1 + a is rounded twice, r and their product once each: 4 u r, less
        than 2^-66 of e^x, which is 2^-66 (1 + 1/x) of e^x - 1. The other terms, below r², are doubles and
        lose less than 2^-66 of r; the next one would be 2^-69 r. Where n = 0, a = 0 and r (1 + a) is
        exact: that is all. An error of x counts x + 1 times, with u t x for each time that a part of the
        multiple of ln 2 adds to what x has as low part.
        """
        whole = x.rounded()
        least, most = float(whole.min()), float(whole.max())
        if most > LARGE:
            off = whole > LARGE
            low = None if x.low is None else np.where(off, 0.0, x.low)
            k = self.expm1(Pair(self, np.where(off, 1.0, x.high), low, x.loss, x.doubt))
            k.doubt = np.where(off, np.inf, 0.0 if k.doubt is None else k.doubt)
            return k
        count = whole * (COARSE / np.log(2))
        np.rint(count, out=count)
        first, last = _ln2_in_parts(COARSE)
        (near,) = scratch(1, count.size)
        low = count * -last
        if x.low is not None:
            low += x.low
        left = Pair(self, x.high - np.multiply(count, first, out=near), low).normal()
        assert left.low is not None
        r = left.high
        terms = r * (1 / 24)
        terms += 1 / 6
        terms *= r
        terms += 1 / 2
        terms *= r
        terms *= r
        terms += left.low
        number = count.astype(np.int64)
        head, tail = (part.take(number & (COARSE - 1)) for part in _short_powers())
        if number.max() >= COARSE:
            power = 2.0 ** np.arange(64)
            power = power.take(number >> COARSE.bit_length() - 1)
            head *= power
            tail *= power
            head += power - 1
        factor = head + 1.0
        factor += tail
        high, low = fast_two_sum(head, np.multiply(factor, r, out=near))
        low += np.multiply(factor, terms, out=terms)
        low += tail
        loss = 2.0**-66
        doubt = None
        if least > 2.0**-6:
            loss += 2.0**-66 / least
        else:
            doubt = np.where(count == 0, 0.0, 2.0**-66 / whole)
        loss += (x.loss + LOSS) * (1 + most)
        if x.doubt is not None:
            doubt = _both(doubt, x.doubt * (1 + most), np.add)
        k = Pair(self, high, low, loss, doubt)
        return k if doubt is None else k.normal()

    def log1p(self, x: Pair) -> Pair:
        """ln(1 + x) for x >= 0 as NumPy has it, with no more digits than a double."""
        if x.low is not None:
            x = x.normal()
        high = np.log1p(x.high)
        low = None if x.low is None else x.low / (1 + x.high)
        # Exact products gain nothing from here on.
        return Pair(ROUNDED, high, low, LIBRARY + x.loss + LOOSE, x.doubt)


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
                term = a * b
                low = term if low is None else np.add(low, term, out=low)
        return x.of_factors(y, high, low, UNIT + LOOSE)

    def quotient(self, x: Pair, y: Pair) -> Pair:
        """x/y. The low part of a constant y counts as lost if it is less than 0.4 u of it; π's is 0.35."""
        high = x.high / y.high
        low, loss = x.low, UNIT + LOOSE
        if y.low is not None:
            if y.near < NEARLY:
                loss += y.near
            else:
                term = high * y.low
                low = np.subtract(0.0 if low is None else low, term, out=term)
        if low is not None:
            low = low / y.high
        return x.of_factors(y, high, low, loss)

    def sqrt(self, x: Pair) -> Pair:
        return super().sqrt(x).normal()

    def expm1(self, x: Pair) -> Pair:
        return super().expm1(x).normal()


class Thorough(Pairs):
    """Everything to about twice the digits of a double, and every result made normal.

    The errors of products are doubles too (`two_product`). What each operation loses is counted in units of
    u², one more of them each for what is of third order. A sum has two additions into the low part, to at
    most 2u each: 4 (of both terms, in a difference).
    """

    sum_loss = 5 * UNIT**2

    def trusts(self, x: Pair) -> bool:
        return False

    def product(self, x: Pair, y: Pair) -> Pair:
        """x y. In u², two products, 1 each, their additions, to at most 2u and 3u, and the low parts': 8.

        With only one low part 1 + 2; without, nothing is lost.
        """
        high, low = two_product(x.high, y.high)
        terms = [(a, b) for a, b in ((x.high, y.low), (y.high, x.low)) if b is not None]
        for a, b in terms:
            low += a * b
        return x.of_factors(y, high, low, (0, 4, 9)[len(terms)] * UNIT**2).normal()

    def quotient(self, x: Pair, y: Pair) -> Pair:
        """x/y. In u², what is added to the remainder, 2 + 1 + 3, its division, 3, by y.high alone, 3: 12."""
        high = x.high / y.high
        low = self._remainder(x, high, y.high)
        if y.low is not None:
            low -= high * y.low
        low /= y.high
        return x.of_factors(y, high, low, 13 * UNIT**2).normal()

    def sqrt(self, x: Pair) -> Pair:
        """√x, with the loss of a quotient, which is more than it has."""
        high = np.sqrt(x.high)
        low = self._remainder(x, high, high)
        low /= 2 * high
        doubt = None if x.doubt is None else x.doubt / 2
        return Pair(self, high, low, x.loss / 2 + 13 * UNIT**2, doubt).normal()

    def _remainder(self, x: Pair, a: Column, b: Column) -> Column:
        """x - a b, which is small."""
        product, error = two_product(a, b)
        low = np.subtract(x.high, product, out=product)
        low -= error
        if x.low is not None:
            low += x.low
        return low

    def expm1(self, x: Pair) -> Pair:
        """e^x - 1 for x >= 0; beyond e^700 (`LARGEST`) its bound is infinite.

        As `_powers` says, with n the next lower, so r < 1.1e-5. An error of x counts x + 1 times, with u² x
        for each time that a part of the multiple of ln 2 adds to what x has as low part.
        """
        high = np.minimum(x.high, LARGEST)
        count = np.floor(high * (FINE / np.log(2)))
        first, *parts = _ln2_in_parts(FINE)
        left = high - count * first  # exact: the two are near each other
        low = np.zeros_like(left) if x.low is None else x.low.copy()
        for part in parts:
            left, error = two_sum(left, count * part, np.subtract)
            low += error
        k = self._small_expm1(Pair(self, left, low).normal())
        number = count.astype(np.int64)
        for steps, among in (FINE, FINER), (COARSE, COARSE):
            k, number = self._compound(k, steps, number % among), number // among
        if number.max() > 0:
            power = np.ldexp(1.0, np.arange(1024)).take(number, mode="clip")
            assert k.low is not None
            # Exact: k times a power of two, and that power less one.
            scaled = Pair(self, k.high * power, k.low * power, k.loss, k.doubt)
            k = scaled + Pair(self, *two_sum(power, np.array([-1.0])))
        off = (x.bound + 4 * UNIT**2) * (1 + x.high)
        k.doubt = _both(k.doubt, np.where(x.high < LARGEST, off, np.inf), np.add)
        return k

    def _small_expm1(self, r: Pair) -> Pair:
        """e^r - 1 for what the tables leave, by its Taylor series.

        The terms up to r³/6 are pairs, the others below 2^-53 r, 2^-102 r in all, and the next one would be
        below 2^-110 r.
        """
        x = r.high
        square = r * r / 2
        low = x * x * x * x * (1 / 24 + x * (1 / 120 + x / 720))
        k = r + square + square * r / 3
        assert k.low is not None
        return Pair(self, k.high, k.low + low, k.loss + self.sum_loss, k.doubt).normal()

    def _compound(self, k: Pair, steps: int, index: NDArray[np.int64]) -> Pair:
        """(1 + k) 2^(index/steps) - 1."""
        highs, lows = _powers(steps)
        factor = Pair(self, highs.take(index, mode="clip"), lows.take(index, mode="clip"), UNIT**2 / 2)
        return factor + k + factor * k

    def log1p(self, x: Pair) -> Pair:
        """ln(1 + x) for x >= 0: NumPy's y, and ln(1 + δ), δ = (1 + x)/e^y - 1, by two terms of its series."""
        high = np.log1p(x.high)
        guess = self.expm1(Pair(self, high))
        off = (x - guess) / (guess + 1)
        log = Pair(self, high) + off - off * off / 2
        log.positive = True
        return log


ROUNDED, QUICK, THOROUGH = LEVELS = Rounded(), Quick(), Thorough()


@cache
def _pi() -> Fraction:
    return Fraction(ENOUGH.pi.lo)


@cache
def _ln2() -> Fraction:
    return Fraction(ENOUGH.log1p(ENOUGH.number(1)).lo)


@cache
def _ln2_in_parts(steps: int) -> tuple[float, ...]:
    """ln 2/steps as a sum: 30 bits and the rest, or thrice 24 and the rest.

    A multiple n of it comes off an exponential's argument x in these parts. As n has at most 20 bits (27
    for the finer steps), only the product with the last part is rounded: x 2^-83 (x 2^-125) is lost.
    """
    rest, parts = _ln2() / steps, []
    for bits in (30,) if steps == COARSE else (24, 24, 24):
        mantissa, exponent = frexp(float(rest))
        parts.append(ldexp(round(ldexp(mantissa, bits)), exponent - bits))
        rest -= Fraction(parts[-1])
    return (*parts, float(rest))


@cache
def _powers(steps: int) -> tuple[Column, Column]:
    """2^(i/steps) - 1 from i = 0 up to the next coarser table's step, as pairs: high and low parts.

    e^x - 1 is put together from (1 + a)(1 + b) - 1 = a + b (1 + a), in which nothing cancels for x >= 0:
    tables of a = 2^(i/16384) - 1 and (if thorough) of 2^(i/65536) - 1, i < 4, and the Taylor series of
    what is left of x, r, when n ln 2/16384 (n ln 2/65536) is taken off. An error of x counts x + 1 times,
    as x e^x < (x + 1)(e^x - 1).
    """
    bits, exact = 200, [0]
    count = COARSE if steps == COARSE else FINER
    step = int(Fraction(ENOUGH.expm1(ENOUGH.number(_ln2() / steps)).lo) * 2**bits)
    for _ in range(count - 1):
        exact.append(exact[-1] + step + (exact[-1] * step >> bits))
    highs = [float(power) for power in exact]
    lows = [float(power - int(high)) for power, high in zip(exact, highs, strict=True)]
    return np.array(highs) * 2.0**-bits, np.array(lows) * 2.0**-bits


@cache
def _short_powers() -> tuple[Column, Column]:
    """The coarse table as heads and tails."""
    highs, lows = _powers(COARSE)
    heads = head_of(highs)
    return heads, highs - heads + lows


def _both(x: Any, y: Any, join: Any) -> Any:
    """Two columns joined, either of which may be None."""
    return y if x is None else x if y is None else join(x, y)
