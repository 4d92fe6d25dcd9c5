"""The arithmetics of columns, a row a scene: doubles, and pairs of doubles that know their error.

`Floats` are plain NumPy doubles. `Pairs` carry about twice their digits: a `Pair` stands for
value + rest, with a proven bound on its relative error, so that whoever rounds it can tell whether
four units in the last place, or the nearest double, is what came out. Let u = 2^-53.

What is assumed: IEEE 754 double arithmetic, round to nearest, in NumPy's + - * / and sqrt, on any
platform and with any SIMD path; that its log1p, cos and sin are within one unit in the last place,
2u of the value (`LIBRARY`; 0.7 was the most that `tests` measured); and that inputs are 0 or within
2^±120 (`WINDOW`), so that no product of the equations leaves the normal doubles, but for squares
that do not matter beside what they are added to. Whoever calls sees to the last.

The error of a sum of two doubles is a double, found by six more additions (D. E. Knuth), or by two
where the first is known to be the larger one (T. J. Dekker).

Bounds add up in products and quotients. A sum of what is not negative inherits the larger one; of a
term that is the smaller one in all rows, which is at most half of the sum, half the bound counts beside
half the other's. In a difference, and a sum of what is off by more than a few u in more than a few rows,
they count as much as the terms weigh beside what is left, row by row: a row that cancels is told from its
neighbours, and only such rows pay for more digits. Weights are taken from values, and sizes from results,
as they are computed; that is of second order, as is the product of two bounds, and whoever compares a
bound leaves room for it.

Products come in three kinds, that differ in cost: *rounded*, to a double; *quick*, by halves; *thorough*.

A quick product splits both factors into a head of 26 bits, the double with its other bits cut off, and a
tail. The product of the heads is exact, and is the value; the rest is (head tail + tail whole). A quick
quotient is the head q of the rounded one, and as rest the remainder divided: (x - q head) - q tail over
the whole; a quick root is the head v of the rounded root w, and (x - v²)/(w + v). So rests are not small
but |rest| <= t |value|, where each product, quotient and root adds 2^-25 for every head that it cuts to
what its operands have; a sum has no more than its terms, and a difference is made normal. As no quantity
takes more than 60 operations on the way, t < 2^-18. Every rounding is one of a tail or a remainder, none
of them above 2t of the result: the tails, one whole, two products, their sum: 7 times u t in a product;
9 in a quotient, with its two divisions; fewer in a root or sum. Each is below 2^-67 of the result, or of
both terms in a difference (`LOSS`). Where a difference leaves less than t of its terms, `normal` may round
as well, 2 u t of the terms, and what is left may have a rest beyond t: its bound, at least 2^-66/t, is so
large that whoever looks at it asks for more digits anyway, and is larger than what that rest loses.

Rounded products and quotients lose u each, and what is of second order: their rests are a few u, as they
start with at most half a unit in the last place (`normal`) and grow by u per operation. A rest counts once,
in first order: 60² u² and the roundings of rests are less than `LOOSE` = 2^14 u². What comes from a quick
operation is made normal first. The rest of a constant that is divided by counts as lost, not as a rest, if
it is less than 0.4 u of it; that of π is 0.35.

If thorough, the errors of products are doubles too, found by splitting each factor into halves of 26 bits,
the lower one with a sign (T. J. Dekker), and every result is made normal. What is lost is, in units of u²,

- sum: two additions into rest, to at most 2u each: 4 (of both terms, in a difference);
- product: two products, 1 each, their additions, to at most 2u and 3u, and the rests': 8; with only one
  rest 1 + 2; without, nothing is lost;
- quotient: what is added to the remainder, 2 + 1 + 3, its division, 3, and that by the value alone, 3: 12.
  A root has fewer.

One more each covers what is of third order.

e^x - 1 is put together from (1 + a)(1 + b) - 1 = a + b (1 + a), in which nothing cancels for x >=
0: a table of a = 2^(i/16384) - 1 (if thorough, also of 2^(i/65536) - 1, i < 4), and the Taylor
series of what is left, r. A multiple n of ln 2/16384 (ln 2/65536) comes off x in parts, of 30 bits
(24) each as n has at most 20 (27), so that only the product with the last part is rounded: x 2^-83
(x 2^-125) is lost, and u² x (if quick, u t x) for each time that a part adds to what x has as rest.
An error of x counts x + 1 times, as x e^x < (x + 1)(e^x - 1).

- Quick: n is the nearest, so |r| < 2^-15.5. With a 2^m, and 2^m - 1, as a head that is exact for x
  <= 36 (`LARGE`) and a tail, 1 + a is rounded twice, r and their product once each: 4 u r, less
  than 2^-66 of e^x, which is 2^-66 (1 + 1/x) of e^x - 1. The other terms, below r², are doubles and
  lose less than 2^-66 of r; the next one would be 2^-69 r. Where n = 0, a = 0 and r (1 + a) is
  exact: that is all.
- Thorough: n is the next lower, so r < 1.1e-5. The terms up to r³/6 are pairs, the others below
  2^-53 r, 2^-102 r in all, and the next one would be below 2^-110 r.
"""

from collections.abc import Callable
from fractions import Fraction
from functools import cache
from math import frexp, ldexp, pi
from threading import local
from typing import Any, Union

import numpy as np
from numpy.typing import NDArray

from .interval import enclosures
from .lazy import lazy
from .rational import EXACT, Irrational

Column = NDArray[np.float64]

UNIT = 2.0**-53
LIBRARY = 2 * UNIT
MANY = 256  # single numbers kept
LOOSE = 2**14 * UNIT**2  # of second order, lost by a rounded operation
LOSS = 2.0**-67  # lost by a quick one
NEARLY = 0.4 * UNIT  # off, a constant such as π may be divided by as if it were a double
HEAD = -1 << 27  # masks the last 27 of the 53 bits
WINDOW = 2.0**-120, 2.0**120
LARGE, LARGEST = 36.0, 700.0  # argument of an exponential, quick and thorough
COARSE, FINER = 16_384, 4  # steps of its tables to a factor of 2, and to a coarse step
FINE = COARSE * FINER


class Unvouched(ArithmeticError):
    """This arithmetic has no bound for the operation: take a more accurate one."""


class Floats:
    """Doubles, as they come."""

    pi = pi

    def number(self, q: Any) -> Any:
        return float(q) if isinstance(q, Fraction | int) else q

    def is_zero(self, x: Any) -> bool:
        return isinstance(x, float) and x == 0

    exp, expm1, log1p, sqrt = np.exp, np.expm1, np.log1p, np.sqrt

    def hypot(self, x: Any, y: Any) -> Any:
        return np.sqrt(x * x + y * y)  # NumPy's own, which minds overflow, takes ten times as long

    def cos_sin(self, x: Any) -> tuple[Any, Any]:
        return np.cos(x), np.sin(x)

    def cos_sin_of_degrees(self, x: Any) -> tuple[Any, Any]:
        if isinstance(x, Fraction):
            cos, sin = _cos_sin_of_degrees(x)
            return float(cos), float(sin)
        folded, turn = _fold(x)
        return turn(*self.cos_sin(folded * (pi / 180)))

    def root(self, f: Callable[[Any], Any], end: Any) -> Any:
        """By bisection, to the last place but one."""
        low, high = np.zeros_like(end), np.array(end)
        for _ in range(54):
            half = (low + high) / 2
            before = f(half) < 0
            low, high = np.where(before, half, low), np.where(before, high, half)
        return (low + high) / 2


FLOATS = Floats()


class Pair:
    """value + rest, relative error at most ``bound``; ``rest`` is None where value is exact.

    Columns have the shape (n,), single numbers (1,). ``positive`` says that no row is negative. The
    bound is ``loss``, the same in all rows, and ``doubt``, a column or None, where terms cancelled.
    """

    __slots__ = ("_kept", "doubt", "loss", "near", "positive", "power", "rest", "value", "within")

    def __init__(
        self,
        within: "Pairs",
        value: Column,
        rest: Column | None = None,
        loss: float = 0.0,
        doubt: Column | None = None,
        positive: bool = True,
    ) -> None:
        self.within, self.value, self.rest, self.positive = within, value, rest, positive
        self.loss, self.doubt = loss, doubt
        self.power = 0.0  # the value, where it is a single power of two: a factor that rounds nothing
        self.near = 1.0  # how far the value of a constant alone is off
        self._kept: dict[
            Any, Any
        ] = {}  # what was made of it; shared by all arithmetics if it has lost nothing

    @property
    def bound(self) -> Any:
        return self.loss if self.doubt is None else self.doubt + self.loss

    def _meet(self, other: Union["Pair", Fraction, int]) -> tuple["Pair", "Pair"]:
        """Both, as the less accurate of their arithmetics takes them."""
        two = other if isinstance(other, Pair) else self.within.number(other)
        if two.within is self.within:
            return self, two
        within = min(self.within, two.within, key=LEVELS.index)
        return self.taken_by(within), two.taken_by(within)

    def taken_by(self, within: "Pairs") -> "Pair":
        """The same in another arithmetic; what has lost nothing is the same in all of them."""
        if self.within is within:
            return self
        lossless = self.loss == 0 and self.doubt is None
        own = self if lossless or self.rest is None else self.normal()
        pair = Pair(within, own.value, own.rest, own.loss, own.doubt, own.positive)
        pair.power, pair.near = own.power, own.near
        if lossless:
            pair._kept = own._kept
        return pair

    def __add__(self, other: Union["Pair", int]) -> "Pair":
        return self._plus(other, np.add)

    __radd__ = __add__

    def __sub__(self, other: Union["Pair", int]) -> "Pair":
        return self._plus(other, np.subtract)

    def _plus(self, other: Union["Pair", int], add: Any) -> "Pair":
        """The sum, or the difference if ``add`` is np.subtract."""
        one, two = self._meet(other)
        if add is np.add and two.value[0] > one.value[0]:
            one, two = two, one
        doubles = one.exact and two.exact
        key = add, id(two._kept)
        if doubles and key in one._kept:
            kept: Pair = one._kept[key][0]
            return kept.taken_by(one.within)
        positive = one.positive and two.positive
        ordered = positive and one._covers(two)
        together, loss = positive and add is np.add, one.within.sum_loss
        if ordered:
            value, rest = _fast_sum(one.value, two.value, add)
        elif together:
            larger, smaller = _aside(2, max(one.value.size, two.value.size))
            np.maximum(one.value, two.value, out=larger)
            value, rest = _fast_sum(larger, np.minimum(one.value, two.value, out=smaller))
        else:
            value, rest = _sum(one.value, two.value, add)
        if one.rest is not None:
            rest += one.rest
        if two.rest is not None:
            add(rest, two.rest, out=rest)
        sum_ = Pair(one.within, value, rest)
        if doubles:
            sum_.positive = together or ordered or bool(value.min() >= 0)
            sum_._kept["whole"] = value
            if one.value.size > 1:  # single numbers outlive their rows
                one._kept[key] = sum_, two._kept  # which keeps its number
        elif together and one.within.trusts(one) and one.within.trusts(two):
            sum_.loss = max(one.loss, (one.loss + two.loss) / 2 if ordered else two.loss) + loss
            sum_.doubt = one.doubt if one.doubt is two.doubt else _both(one.doubt, two.doubt, np.maximum)
        else:
            sum_ = sum_.normal()
            sum_.positive = together or bool(sum_.value.min() >= 0)
            weighed = one._weighed(
                one.bound + loss, two.bound + loss, None if ordered and not together else two
            )
            sum_.doubt = weighed / (sum_.value if sum_.positive else np.abs(sum_.value))
            if np.isnan(sum_.doubt.min()):  # 0 plus or minus 0 is 0
                sum_.doubt = np.where(weighed == 0, 0.0, sum_.doubt)
        return sum_

    def _covers(self, two: "Pair") -> bool:
        """Whether no row of the other is larger, where neither has negative ones."""
        x, y = self.value, two.value
        if (np.subtract, id(two._kept)) in self._kept:
            found: bool = self._kept[np.subtract, id(two._kept)][0].positive
            return found
        if not (y[:16] <= x[:16]).all():
            return False
        return bool(y.max() <= x[0] if x.size == 1 else (y <= x).all())

    def _weighed(self, bound: Any, other: Any, two: "Pair | None") -> Any:
        """How far a sum may be off, from the bounds of its terms; None for one that is no larger."""
        size = self.value if self.positive else np.abs(self.value)
        if two is None:
            return size * (bound + other)
        return size * bound + (two.value if two.positive else np.abs(two.value)) * other

    @property
    def exact(self) -> bool:
        """Whether this is a double, or a column of them."""
        return self.rest is None and self.doubt is None and self.loss == 0

    def normal(self) -> "Pair":
        """The same with a rest of at most half a unit in the last place."""
        assert self.rest is not None
        value = self.rounded()
        if value is self.value:
            return self
        rest = self.value - value
        rest += self.rest
        normal = Pair(self.within, value, rest, self.loss, self.doubt, self.positive)
        normal._kept["whole"] = value
        return normal

    def halved(self) -> "Pair":
        """The same, whose value is known to have 26 bits."""
        assert self.rest is not None
        self._kept["halves"] = self.value, self.rest
        return self

    def halves(self) -> tuple[Column, Column]:
        """Two columns that add up to this, the first of 26 bits."""
        if "halves" not in self._kept:
            head = _head(self.value)
            tail = self.value - head
            if self.rest is not None:
                tail += self.rest
            self._kept["halves"] = head, tail
        halves: tuple[Column, Column] = self._kept["halves"]
        return halves

    def rounded(self) -> Column:
        """The double that value + rest round to."""
        if self.rest is None:
            return self.value
        if "whole" not in self._kept:
            self._kept["whole"] = self.value + self.rest
        whole: Column = self._kept["whole"]
        return whole

    def _scaled(self, factor: float) -> "Pair":
        """Times a power of two, or -1."""
        rest = None if self.rest is None else self.rest * factor
        positive = self.positive and factor > 0
        scaled = Pair(self.within, self.value * factor, rest, self.loss, self.doubt, positive)
        scaled.near = self.near
        return scaled

    def __mul__(self, other: Union["Pair", Fraction, int]) -> "Pair":
        one, two = self._meet(other)
        for factor, of in ((one, two), (two, one)):
            if factor.power:
                return of._scaled(factor.power)
        return one.within.product(one, two)

    __rmul__ = __mul__

    def __truediv__(self, other: Union["Pair", int]) -> "Pair":
        one, two = self._meet(other)
        if two.power:
            return one._scaled(1 / two.power)
        return one.within.quotient(one, two)

    def of_factors(self, other: "Pair", value: Column, rest: Column | None, loss: float) -> "Pair":
        """The product or quotient of two pairs, in which so much is lost."""
        doubt = _both(self.doubt, other.doubt, np.add)
        positive = self.positive and other.positive
        return Pair(self.within, value, rest, self.loss + other.loss + loss, doubt, positive)

    def __rtruediv__(self, other: int) -> "Pair":
        one: Pair = self.within.number(other)
        return one / self

    def take(self, index: NDArray[np.intp]) -> "Pair":
        """Some of the rows."""
        rest, doubt = (None if part is None else part.take(index) for part in (self.rest, self.doubt))
        return Pair(self.within, self.value.take(index), rest, self.loss, doubt, self.positive)


class Pairs:
    """What the arithmetics of pairs have in common."""

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
        """Whether few rows of a term are off so much that a sum should weigh it."""
        return x.doubt is None or 50 * int(np.count_nonzero(x.doubt > 3 * UNIT)) <= x.doubt.size

    def number(self, q: Any) -> Any:
        """A number, or a column of exact doubles."""
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
        value = float(q)
        rest = float(q - Fraction(value))
        if rest:
            left = abs(float((q - Fraction(value) - Fraction(rest)) / q)) * 1.001
            pair = Pair(self, np.array([value]), np.array([rest]), left, positive=value >= 0)
            pair.near = abs(rest / value) + left
            return pair
        number = Pair(self, np.array([value]), positive=value >= 0)
        number.power = value if abs(frexp(value)[0]) == 0.5 else 0.0
        return number

    def is_zero(self, x: Pair) -> bool:
        return x.value.size == 1 and x.exact and x.value[0] == 0

    @lazy
    def pi(self) -> Pair:
        return self._single(_pi())

    def hypot(self, x: Pair, y: Pair | int) -> Pair:
        return self.sqrt(x * x + y * y)

    def exp(self, x: Pair) -> Pair:
        return self.expm1(x) + 1

    def cos_sin(self, x: Pair) -> tuple[Pair, Pair]:
        """Cosine and sine, |x| <= 4."""
        x = x if x.rest is None else x.normal()
        cos, sin = np.cos(x.value), np.sin(x.value)
        error = np.abs(x.value) * (x.bound + self.sum_loss)
        rest = 0.0 if x.rest is None else x.rest
        return (
            Pair(self, cos, -sin * rest, LIBRARY, error / np.abs(cos), positive=False),
            Pair(self, sin, cos * rest, LIBRARY, error / np.abs(sin), positive=False),
        )

    def cos_sin_of_degrees(self, x: Any) -> tuple[Pair, Pair]:
        """Cosine and sine of a number of degrees, or of a column of exact ones."""
        if isinstance(x, Fraction):
            cos, sin = map(self.number, _cos_sin_of_degrees(x))
            return cos, sin
        folded, turn = _fold(x.value)
        angle = self.pi * Pair(self, folded, positive=False) / 180
        cos, sin = self.cos_sin(angle)
        bounds = cos.bound, np.where(folded == 0, 0.0, sin.bound)
        values, rests = (turn(getattr(cos, part), getattr(sin, part)) for part in ("value", "rest"))
        cos, sin = (
            Pair(self, value, rest, doubt=np.abs(bound), positive=False)
            for value, rest, bound in zip(values, rests, turn(*bounds), strict=True)
        )
        return cos, sin

    def root(self, f: Callable[[Pair], Pair], end: Pair) -> Pair:
        raise Unvouched


class Quick(Pairs):
    """Products, quotients, roots and exponentials by halves; logarithms as NumPy has them."""

    sum_loss = LOSS

    def product(self, x: Pair, y: Pair) -> Pair:
        if x.rest is None:
            x, y = y, x  # so that y, of whom the whole is needed, has it at hand
        (x_head, x_tail), (y_head, y_tail) = x.halves(), y.halves()
        value = x_head * y_head
        rest = x_head * y_tail
        rest += np.multiply(x_tail, y.rounded(), out=_aside(1, value.size)[0])
        return x.of_factors(y, value, rest, LOSS)

    def quotient(self, x: Pair, y: Pair) -> Pair:
        whole, (head, tail) = y.rounded(), y.halves()
        value = x.value / whole
        value = _head(value, out=value)
        product, more = _aside(2, value.size)
        np.multiply(value, head, out=product)
        rest = self._rest(x, product, np.multiply(value, tail, out=more), whole)
        return x.of_factors(y, value, rest, LOSS).halved()

    def sqrt(self, x: Pair) -> Pair:
        root = np.sqrt(x.rounded())
        value = _head(root)
        # As x - value² = (root - value) (root + value).
        (product,) = _aside(1, value.size)
        rest = self._rest(x, np.multiply(value, value, out=product), None, np.add(value, root, out=root))
        doubt = None if x.doubt is None else x.doubt / 2
        return Pair(self, value, rest, x.loss / 2 + LOSS, doubt).halved()

    def _rest(self, x: Pair, product: Column, more: Column | None, by: Column) -> Column:
        """What is left of x less a product in two parts, divided: the rest of a quotient or root."""
        rest = x.value - product
        if more is not None:
            rest -= more
        if x.rest is not None:
            rest += x.rest
        rest /= by
        return rest

    def expm1(self, x: Pair) -> Pair:
        """e^x - 1 for x >= 0; unvouched beyond e^36."""
        whole = x.rounded()
        least, most = float(whole.min()), float(whole.max())
        if most > LARGE:
            off = whole > LARGE
            rest = None if x.rest is None else np.where(off, 0.0, x.rest)
            k = self.expm1(Pair(self, np.where(off, 1.0, x.value), rest, x.loss, x.doubt))
            k.doubt = np.where(off, np.inf, 0.0 if k.doubt is None else k.doubt)
            return k
        count = whole * (COARSE / np.log(2))
        np.rint(count, out=count)
        first, last = _ln2_in_parts(COARSE)
        (near,) = _aside(1, count.size)
        rest = count * -last
        if x.rest is not None:
            rest += x.rest
        left = Pair(self, x.value - np.multiply(count, first, out=near), rest).normal()
        assert left.rest is not None
        r = left.value
        terms = r * (1 / 24)
        terms += 1 / 6
        terms *= r
        terms += 1 / 2
        terms *= r
        terms *= r
        terms += left.rest
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
        value, rest = _fast_sum(head, np.multiply(factor, r, out=near))
        rest += np.multiply(factor, terms, out=terms)
        rest += tail
        loss = 2.0**-66
        doubt = None
        if least > 2.0**-6:
            loss += 2.0**-66 / least
        else:
            doubt = np.where(count == 0, 0.0, 2.0**-66 / whole)
        loss += (x.loss + LOSS) * (1 + most)
        if x.doubt is not None:
            doubt = _both(doubt, x.doubt * (1 + most), np.add)
        k = Pair(self, value, rest, loss, doubt)
        return k if doubt is None else k.normal()

    def log1p(self, x: Pair) -> Pair:
        if x.rest is not None:
            x = x.normal()
        value = np.log1p(x.value)
        rest = None if x.rest is None else x.rest / (1 + x.value)
        # With no more digits than a double has: exact products from here on gain nothing.
        return Pair(ROUNDED, value, rest, LIBRARY + x.loss + LOOSE, x.doubt)


class Rounded(Quick):
    """Products and quotients are rounded to a double, and rests small: what is lost is of the first order."""

    sum_loss = LOOSE

    def product(self, x: Pair, y: Pair) -> Pair:
        value, rest = x.value * y.value, None
        for a, b in (x.value, y.rest), (y.value, x.rest):
            if b is not None:
                term = a * b
                rest = term if rest is None else np.add(rest, term, out=rest)
        return x.of_factors(y, value, rest, UNIT + LOOSE)

    def quotient(self, x: Pair, y: Pair) -> Pair:
        value = x.value / y.value
        rest, loss = x.rest, UNIT + LOOSE
        if y.rest is not None:
            if y.near < NEARLY:
                loss += y.near
            else:
                term = value * y.rest
                rest = np.subtract(0.0 if rest is None else rest, term, out=term)
        if rest is not None:
            rest = rest / y.value
        return x.of_factors(y, value, rest, loss)

    def sqrt(self, x: Pair) -> Pair:
        return super().sqrt(x).normal()

    def expm1(self, x: Pair) -> Pair:
        return super().expm1(x).normal()


class Thorough(Pairs):
    """Everything to about twice the digits of a double, and every rest kept normal."""

    sum_loss = 5 * UNIT**2

    def trusts(self, x: Pair) -> bool:
        return False

    def product(self, x: Pair, y: Pair) -> Pair:
        value, rest = _product(x.value, y.value)
        terms = [(a, b) for a, b in ((x.value, y.rest), (y.value, x.rest)) if b is not None]
        for a, b in terms:
            rest += a * b
        return x.of_factors(y, value, rest, (0, 4, 9)[len(terms)] * UNIT**2).normal()

    def quotient(self, x: Pair, y: Pair) -> Pair:
        value = x.value / y.value
        rest = self._remainder(x, value, y.value)
        if y.rest is not None:
            rest -= value * y.rest
        rest /= y.value
        return x.of_factors(y, value, rest, 13 * UNIT**2).normal()

    def sqrt(self, x: Pair) -> Pair:
        value = np.sqrt(x.value)
        rest = self._remainder(x, value, value)
        rest /= 2 * value
        doubt = None if x.doubt is None else x.doubt / 2
        return Pair(self, value, rest, x.loss / 2 + 13 * UNIT**2, doubt).normal()

    def _remainder(self, x: Pair, a: Column, b: Column) -> Column:
        """x - a b, which is small."""
        product, error = _product(a, b)
        rest = np.subtract(x.value, product, out=product)
        rest -= error
        if x.rest is not None:
            rest += x.rest
        return rest

    def expm1(self, x: Pair) -> Pair:
        """e^x - 1 for x >= 0; unvouched beyond e^700."""
        value = np.minimum(x.value, LARGEST)
        count = np.floor(value * (FINE / np.log(2)))
        first, *parts = _ln2_in_parts(FINE)
        left = value - count * first  # exact: the two are near each other
        rest = np.zeros_like(left) if x.rest is None else x.rest.copy()
        for part in parts:
            left, error = _sum(left, count * part, np.subtract)
            rest += error
        k = self._small_expm1(Pair(self, left, rest).normal())
        number = count.astype(np.int64)
        for steps, among in (FINE, FINER), (COARSE, COARSE):
            k, number = self._compound(k, steps, number % among), number // among
        if number.max() > 0:
            power = np.ldexp(1.0, np.arange(1024)).take(number, mode="clip")
            assert k.rest is not None
            # Exact: k times a power of two, and that power less one.
            scaled = Pair(self, k.value * power, k.rest * power, k.loss, k.doubt)
            k = scaled + Pair(self, *_sum(power, np.array([-1.0])))
        off = (x.bound + 4 * UNIT**2) * (1 + x.value)
        k.doubt = _both(k.doubt, np.where(x.value < LARGEST, off, np.inf), np.add)
        return k

    def _small_expm1(self, r: Pair) -> Pair:
        """e^r - 1 for what the tables leave."""
        x = r.value
        square = r * r / 2
        rest = x * x * x * x * (1 / 24 + x * (1 / 120 + x / 720))
        k = r + square + square * r / 3
        assert k.rest is not None
        return Pair(self, k.value, k.rest + rest, k.loss + self.sum_loss, k.doubt).normal()

    def _compound(self, k: Pair, steps: int, index: NDArray[np.int64]) -> Pair:
        """(1 + k) 2^(index/steps) - 1."""
        values, rests = _powers(steps)
        factor = Pair(self, values.take(index, mode="clip"), rests.take(index, mode="clip"), UNIT**2 / 2)
        return factor + k + factor * k

    def log1p(self, x: Pair) -> Pair:
        value = np.log1p(x.value)
        guess = self.expm1(Pair(self, value))
        off = (x - guess) / (guess + 1)
        found = Pair(self, value) + off - off * off / 2
        found.positive = True
        return found


ROUNDED, QUICK, THOROUGH = LEVELS = Rounded(), Quick(), Thorough()


_scratch = local()


def _aside(count: int, size: int) -> list[Column]:
    """Rooms for what is soon forgotten: each thread has its own, which the processor has at hand."""
    rooms: list[Column] = getattr(_scratch, "rooms", [])
    if not rooms or rooms[0].size < size:
        _scratch.rooms = rooms = [np.empty(size) for _ in range(5)]
    return [room[:size] for room in rooms[:count]]


def _sum(x: Column, y: Column, add: Any = np.add) -> tuple[Column, Column]:
    """x + y, or x - y if ``add`` is np.subtract, rounded, and the error of that, exactly (D. E. Knuth)."""
    total = add(x, y)
    (added,) = _aside(1, total.size)
    np.subtract(total, x, out=added)
    error = total - added
    np.subtract(x, error, out=error)
    if add is np.add:
        np.subtract(y, added, out=added)
        error += added
    else:
        added += y
        error -= added
    return total, error


def _fast_sum(x: Column, y: Column, add: Any = np.add) -> tuple[Column, Column]:
    """The same where no row of y is the larger one in size: then two operations do (T. J. Dekker)."""
    total = add(x, y)
    error = x - total
    return total, add(error, y, out=error)


def _head(x: Column, out: Column | None = None) -> Column:
    """The first 26 bits."""
    head: NDArray[np.int64] = np.bitwise_and(
        x.view(np.int64), HEAD, out=None if out is None else out.view(np.int64)
    )
    return head.view(np.float64)


def _both(x: Any, y: Any, join: Any) -> Any:
    """Two columns joined, either of which may be None."""
    return y if x is None else x if y is None else join(x, y)


def _product(x: Column, y: Column) -> tuple[Column, Column]:
    """x y, rounded, and the error of that, exactly."""
    product = x * y
    part, *rooms = _aside(5, product.size)
    x_high, x_low = _halves(x, *rooms[:2])
    y_high, y_low = _halves(y, *rooms[2:])
    error = x_high * y_high
    error -= product
    error += np.multiply(x_low, y_high, out=part)
    error += np.multiply(x_high, y_low, out=part)
    error += np.multiply(x_low, y_low, out=part)
    return product, error


def _halves(x: Column, high: Column, low: Column) -> tuple[Column, Column]:
    """Two columns of 26 bits that add up to this one, in the rooms given."""
    high, low = high[: x.size], low[: x.size]
    np.multiply(x, 2.0**27 + 1, out=low)
    np.subtract(low, x, out=high)
    np.subtract(low, high, out=high)
    return high, np.subtract(x, high, out=low)


def _fold(degrees: Column) -> tuple[Column, Callable[[Any, Any], tuple[Any, Any]]]:
    """The angle less its quarter turns, exactly, and what they do to its cosine and sine."""
    degrees = np.fmod(degrees, 360.0)
    quarters = np.rint(degrees / 90)
    which = quarters.astype(np.int64) % 4

    def turn(cos: Any, sin: Any) -> tuple[Any, Any]:
        return np.choose(which, [cos, -sin, -cos, sin]), np.choose(which, [sin, cos, -sin, -cos])

    return degrees - 90 * quarters, turn


ENOUGH = enclosures(80)


@cache
def _pi() -> Fraction:
    return Fraction(ENOUGH.pi.lo)


@cache
def _ln2() -> Fraction:
    return Fraction(ENOUGH.log1p(ENOUGH.number(1)).lo)


@cache
def _cos_sin_of_degrees(x: Fraction) -> tuple[Fraction, Fraction]:
    """To 70 digits, as a Pair takes 32."""
    try:
        return EXACT.cos_sin_of_degrees(x)
    except Irrational:
        cos, sin = ENOUGH.cos_sin_of_degrees(x % 360)
        return Fraction(cos.lo), Fraction(sin.lo)


@cache
def _ln2_in_parts(steps: int) -> tuple[float, ...]:
    """ln 2 / steps as a sum: 30 bits and a rest, or thrice 24 and a rest; see the docstring above."""
    rest, parts = _ln2() / steps, []
    for bits in (30,) if steps == COARSE else (24, 24, 24):
        mantissa, exponent = frexp(float(rest))
        parts.append(ldexp(round(ldexp(mantissa, bits)), exponent - bits))
        rest -= Fraction(parts[-1])
    return (*parts, float(rest))


@cache
def _powers(steps: int) -> tuple[Column, Column]:
    """2^(i/steps) - 1 from i = 0 up to the next coarser table's step, as pairs."""
    bits, exact = 200, [0]
    count = COARSE if steps == COARSE else FINER
    step = int(Fraction(ENOUGH.expm1(ENOUGH.number(_ln2() / steps)).lo) * 2**bits)
    for _ in range(count - 1):
        exact.append(exact[-1] + step + (exact[-1] * step >> bits))
    heads = [float(power) for power in exact]
    rests = [float(power - int(head)) for power, head in zip(exact, heads, strict=True)]
    return np.array(heads) * 2.0**-bits, np.array(rests) * 2.0**-bits


@cache
def _short_powers() -> tuple[Column, Column]:
    """The coarse table by halves."""
    values, rests = _powers(COARSE)
    heads = _head(values)
    return heads, values - heads + rests
