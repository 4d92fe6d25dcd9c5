"""The arithmetics of columns, a row a scene: doubles, and pairs of doubles that know their error.

`Floats` are plain NumPy doubles. `Pairs` carry about twice their digits: a `Pair` stands for
value + rest, with a proven bound on its relative error, so that whoever rounds it can tell whether
four units in the last place, or the nearest double, is what came out. Let u = 2^-53.

What is assumed: IEEE 754 double arithmetic, round to nearest, in NumPy's + - * / and sqrt, on any
platform and with any SIMD path; that its log1p, cos and sin are within one unit in the last place,
2u of the value (`LIBRARY`; 0.7 was the most that `tests` measured); and that inputs are 0 or within
2^±120 (`WINDOW`), so that no product of the equations leaves the normal doubles, but for squares
that do not matter beside what they are added to. Whoever calls sees to the last.

The error of a sum of two doubles is a double, found by six more additions (D. E. Knuth); that of a
product, by splitting each factor into halves of 26 bits (T. J. Dekker); that of a quotient from its
remainder. What is lost is of second order: the rounding of what is added up into rest, and the product
of two rests. If |rest| <= u |value|, as after `normal`, that is in units of u² of the result

- sum: two additions into rest, to at most 2u each: 4 (of both terms, in a difference);
- product: two products, 1 each, their additions, to at most 2u and 3u, and the rests': 8; with only one
  rest 1 + 2; without, nothing is lost;
- quotient: what is added to the remainder, 2 + 1 + 3, its division, 3, and that by the value alone, 3: 12.
  A root has fewer.

One more each covers what is of third order. Without `normal`, |rest| grows by u per operation on the
way; no quantity takes more than 60, so `LOOSE` = 2^14 covers the losses.

Bounds add up in products and quotients. A sum of what is not negative inherits the larger one. In a
difference, they count as much as the terms weigh beside what is left, row by row: a row that
cancels is told from its neighbours, and only such rows pay for more digits.

e^x - 1 is put together from (1 + a)(1 + b) - 1 = a + b + ab, in which nothing cancels for x >= 0:
factors 2^(i/4096) (and 2^(i/65536) if thorough) from tables, and the Taylor series of what is left,
r < 0.00017 (1.1e-5), cut off where the next term is below 2^-71 r (2^-110 r). The first term is a
pair, the others, at most r²/2 <= 2^-13 r, are plain doubles with errors of some 6u: 2^-62 r in all.
If thorough, the terms up to r³/6 are pairs, the others below 2^-53 r, 2^-102 r in all. A multiple n
of ln 2/4096 (ln 2/65536) comes off x in parts, of 30 bits (24) each as n has at most 23 (27), so that
only the product with the last part is rounded: x 2^-83 (x 2^-125) is lost, and u² x for each time that
a part adds to what x has as rest. An error of x counts x + 1 times, as x e^x < (x + 1)(e^x - 1).
"""

from collections.abc import Callable
from fractions import Fraction
from functools import cache, cached_property
from math import frexp, ldexp, pi
from threading import local
from typing import Any, Literal, Union

import numpy as np
from numpy.typing import NDArray

from .arithmetic import EXACT, Irrational, enclosures

Column = NDArray[np.float64]

UNIT = 2.0**-53
LIBRARY = 2 * UNIT
MANY = 256  # single numbers kept
LOOSE = 2**14  # losses in u² where rests are not kept normal
WINDOW = 2.0**-120, 2.0**120
LARGEST = 700.0  # argument of an exponential
COARSE, FINER = 4096, 16  # steps of its tables to a factor of 2, and to a coarse step
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

    Columns have the shape (n,), single numbers (1,). ``positive`` says that no row is negative.
    """

    __slots__ = ("bound", "positive", "power", "rest", "value", "within")

    def __init__(
        self,
        within: "Pairs",
        value: Column,
        rest: Column | None = None,
        bound: Any = 0.0,
        positive: bool = True,
    ) -> None:
        self.within, self.value, self.rest, self.bound, self.positive = within, value, rest, bound, positive
        self.power = 0.0  # the value, where it is a single power of two: a factor that rounds nothing

    def _lift(self, other: Union["Pair", Fraction, int]) -> "Pair":
        return other if isinstance(other, Pair) else self.within.number(other)

    def __add__(self, other: Union["Pair", int]) -> "Pair":
        return self._plus(self._lift(other), np.add)

    __radd__ = __add__

    def __sub__(self, other: Union["Pair", int]) -> "Pair":
        return self._plus(self._lift(other), np.subtract)

    def _plus(self, other: "Pair", add: Any) -> "Pair":
        """The sum, or the difference if ``add`` is np.subtract."""
        x, y = self.value, other.value
        value, rest = _sum(x, y, add)
        if self.rest is not None:
            rest += self.rest
        if other.rest is not None:
            add(rest, other.rest, out=rest)
        sum_, loss = Pair(self.within, value, rest), self.within.sum_loss
        together = self.positive and other.positive and add is np.add
        plain = isinstance(self.bound, float) and isinstance(other.bound, float)
        if together and plain and not self.within.thorough:
            sum_.bound = max(self.bound, other.bound) + loss
            return sum_
        sum_.normal()
        sum_.positive = together or bool(sum_.value.min() >= 0)
        if not (self._exact and other._exact):
            size = sum_.value if sum_.positive else np.abs(sum_.value)
            weighed = self._weighed(loss) + other._weighed(loss)
            sum_.bound = weighed / size
            if np.isnan(sum_.bound.min()):  # 0 plus or minus 0 is 0
                sum_.bound = np.where(weighed == 0, 0.0, sum_.bound)
        return sum_

    def _weighed(self, loss: float) -> Any:
        """How far this may be off, and what adding it may lose."""
        return (self.value if self.positive else np.abs(self.value)) * (self.bound + loss)

    @property
    def _exact(self) -> bool:
        return self.rest is None and isinstance(self.bound, float) and self.bound == 0

    def normal(self) -> "Pair":
        """The same with a rest of at most half a unit in the last place."""
        assert self.rest is not None
        value = np.add(self.value, self.rest, out=_room(self.value))
        rest = np.subtract(value, self.value, out=self.value)
        np.subtract(self.rest, rest, out=self.rest)
        self.value = value
        return self

    def _scaled(self, factor: float) -> "Pair":
        """Times a power of two, or -1."""
        rest = None if self.rest is None else self.rest * factor
        return Pair(self.within, self.value * factor, rest, self.bound, self.positive and factor > 0)

    def __mul__(self, other: Union["Pair", Fraction, int]) -> "Pair":
        other = self._lift(other)
        for one, factor in ((self, other), (other, self)):
            if factor.power:
                return one._scaled(factor.power)
        x, y = self.value, other.value
        value, rest = self.within.product(x, y)
        terms = [(a, b) for a, b in ((x, other.rest), (y, self.rest)) if b is not None]
        loss = self.within.product_loss[len(terms)]
        for a, b in terms:
            term = np.multiply(a, b, out=_room(value))
            rest = term if rest is None else np.add(rest, term, out=rest)
        return self._of_factors(other, value, rest, loss)

    __rmul__ = __mul__

    def __truediv__(self, other: Union["Pair", int]) -> "Pair":
        other = self._lift(other)
        x, y = self.value, other.value
        if other.power:
            return self._scaled(1 / other.power)
        value = np.divide(x, y, out=_room(x, y))
        rest = self.rest
        if self.within.exact_products:
            product, error = _product(value, y)
            remainder = np.subtract(x, product, out=product)
            remainder -= error
            rest = remainder if rest is None else np.add(remainder, rest, out=remainder)
        if other.rest is not None:
            term = np.multiply(value, other.rest, out=_room(value))
            rest = np.subtract(0.0 if rest is None else rest, term, out=term)
        if rest is not None:
            rest = np.divide(rest, y, out=_room(value))
        return self._of_factors(other, value, rest, self.within.quotient_loss)

    def _of_factors(self, other: "Pair", value: Column, rest: Column | None, loss: float) -> "Pair":
        """The product or quotient of two pairs, in which so much is lost."""
        within = self.within
        bound = self.bound + other.bound + loss
        found = Pair(within, value, rest, bound, self.positive and other.positive)
        return found.normal() if within.thorough else found

    def __rtruediv__(self, other: int) -> "Pair":
        return self._lift(other) / self

    def take(self, index: NDArray[np.intp]) -> "Pair":
        """Some of the rows."""
        rest = None if self.rest is None else self.rest.take(index)
        bound = self.bound if isinstance(self.bound, float) else self.bound.take(index)
        return Pair(self.within, self.value.take(index), rest, bound, self.positive)

    def rounded(self) -> Column:
        """The double that value + rest round to."""
        return self.value + (0.0 if self.rest is None else self.rest)


class Pairs:
    """Pairs, on one of three levels, from the fastest to the most accurate.

    0: products and quotients are rounded to a double. 1: they are exact but for what is said above.
    2: so are exponentials and logarithms, and every rest is kept normal.
    """

    def __init__(self, level: Literal[0, 1, 2]) -> None:
        self.exact_products, self.thorough = level > 0, level > 1
        self._singles: dict[Fraction, Pair] = {}
        rounding = 0.0 if self.exact_products else UNIT
        # By the number of factors that have a rest: a product of exact doubles is exact.
        losses = (0, 4, 9) if self.thorough else (0, LOOSE, LOOSE)
        self.product_loss = [rounding + loss * UNIT**2 for loss in losses]
        self.quotient_loss = rounding + (13 if self.thorough else LOOSE) * UNIT**2
        self.sum_loss = (5 if self.thorough else LOOSE) * UNIT**2

    def number(self, q: Any) -> Any:
        """A number, or a column of exact doubles."""
        if isinstance(q, Pair):
            return q
        if isinstance(q, np.ndarray):
            return Pair(self, q)
        q = Fraction(q)
        single = self._singles.get(q)
        if single is None:
            if len(self._singles) > MANY:
                self._singles.clear()
            single = self._singles[q] = self._single(q)
        return single

    def _single(self, q: Fraction) -> Pair:
        value = float(q)
        rest = float(q - Fraction(value))
        if rest:
            left = abs(float((q - Fraction(value) - Fraction(rest)) / q)) * 1.001
            return Pair(self, np.array([value]), np.array([rest]), left, value >= 0)
        number = Pair(self, np.array([value]), positive=value >= 0)
        number.power = value if abs(frexp(value)[0]) == 0.5 else 0.0
        return number

    def product(self, x: Column, y: Column) -> tuple[Column, Column | None]:
        """x y, and the error of that, as far as this level has it."""
        return _product(x, y) if self.exact_products else (np.multiply(x, y, out=_room(x, y)), None)

    def is_zero(self, x: Pair) -> bool:
        return x.value.size == 1 and x._exact and x.value[0] == 0

    @cached_property
    def pi(self) -> Pair:
        return self._single(_pi())

    def sqrt(self, x: Pair) -> Pair:
        value = np.sqrt(x.value, out=_room(x.value))
        product, error = _product(value, value)
        rest = np.subtract(x.value, product, out=product)
        rest -= error
        if x.rest is not None:
            rest += x.rest
        rest /= 2 * value
        root = Pair(self, value, rest, x.bound / 2 + self.quotient_loss)
        return root.normal() if self.thorough else root

    def hypot(self, x: Pair, y: Pair | int) -> Pair:
        return self.sqrt(x * x + y * y)

    def exp(self, x: Pair) -> Pair:
        return self.expm1(x) + 1

    def expm1(self, x: Pair) -> Pair:
        """e^x - 1 for x >= 0; unvouched beyond e^700."""
        value, steps = np.minimum(x.value, LARGEST), FINE if self.thorough else COARSE
        count = np.floor(value * (steps / np.log(2)))
        first, *parts = _ln2_in_parts(steps)
        left = value - count * first  # exact: the two are near each other
        rest = np.zeros_like(left) if x.rest is None else x.rest.copy()
        for part in parts:
            left, error = _sum(left, count * part, np.subtract)
            rest += error
        k = self._small_expm1(Pair(self, left, rest).normal())
        number = count.astype(np.int64)
        if self.thorough:
            k, number = self._compound(k, FINE, number % FINER), number // FINER
        k, number = self._compound(k, COARSE, number % COARSE), number // COARSE
        if number.max() > 0:
            power = np.ldexp(1.0, np.arange(1024)).take(number, mode="clip")
            assert k.rest is not None
            # Exact: k times a power of two, and that power less one.
            scaled = Pair(self, k.value * power, k.rest * power, k.bound)
            k = scaled + Pair(self, *_sum(power, np.array([-1.0])))
        k.bound = k.bound + (x.bound + 4 * UNIT**2) * (1 + x.value)
        return k if np.max(x.value) < LARGEST else self._unvouched(k, x.value >= LARGEST)

    def _unvouched(self, x: Pair, where: Any) -> Pair:
        x.bound = np.where(where, np.inf, x.bound)
        return x

    def _small_expm1(self, r: Pair) -> Pair:
        """e^r - 1 for what the tables leave."""
        x = r.value
        if self.thorough:
            square = r * r / 2
            rest = x * x * x * x * (1 / 24 + x * (1 / 120 + x / 720))
            k = r + square + square * r / 3
            assert k.rest is not None
            k.rest += rest
            k.bound += self.sum_loss
            return k.normal()
        rest = x * x * (1 / 2 + x * (1 / 6 + x * (1 / 24 + x / 120)))
        if r.rest is not None:
            rest += r.rest
        return Pair(self, x, rest, 2.0**-62).normal()

    def _compound(self, k: Pair, steps: int, index: NDArray[np.int64]) -> Pair:
        """(1 + k) 2^(index/steps) - 1."""
        values, rests = _powers(steps)
        factor = Pair(self, values.take(index, mode="clip"), rests.take(index, mode="clip"), UNIT**2 / 2)
        if self.thorough:
            return factor + k + factor * k
        # k < 2^-12: rounding the product loses 2^-65 of the whole.
        assert k.rest is not None
        product = factor.value * k.value
        sum_ = _sum(factor.value, k.value)
        total = _sum(sum_[0], product)
        rest = np.add(sum_[1], total[1], out=total[1])
        rest += factor.rest
        rest += k.rest * (1 + factor.value)
        return Pair(self, total[0], rest, k.bound)

    def log1p(self, x: Pair) -> Pair:
        """ln(1 + x) for x >= 0."""
        value = np.log1p(x.value, out=_room(x.value))
        if not self.thorough:
            rest = None if x.rest is None else x.rest / (1 + x.value)
            # With no more digits than a double has: exact products from here on gain nothing.
            return Pair(ROUNDED, value, rest, LIBRARY + x.bound)
        guess = self.expm1(Pair(self, value))
        off = (x - guess) / (guess + 1)
        found = Pair(self, value) + off - off * off / 2
        found.positive = True
        return found

    def cos_sin(self, x: Pair) -> tuple[Pair, Pair]:
        """Cosine and sine, |x| <= 4."""
        cos, sin = np.cos(x.value), np.sin(x.value)
        error = np.abs(x.value) * (x.bound + self.sum_loss)
        rest = 0.0 if x.rest is None else x.rest
        return (
            Pair(self, cos, -sin * rest, LIBRARY + error / np.abs(cos), positive=False),
            Pair(self, sin, cos * rest, LIBRARY + error / np.abs(sin), positive=False),
        )

    def cos_sin_of_degrees(self, x: Any) -> tuple[Pair, Pair]:
        """Cosine and sine of a number of degrees, or of a column of exact ones."""
        if isinstance(x, Fraction):
            cos, sin = map(self.number, _cos_sin_of_degrees(x))
            return cos, sin
        folded, turn = _fold(x.value)
        angle = self.pi * Pair(self, folded, positive=False) / 180
        cos, sin = self.cos_sin(angle)
        sin.bound = np.where(folded == 0, 0.0, sin.bound)
        values, rests, bounds = (
            turn(getattr(cos, part), getattr(sin, part)) for part in ("value", "rest", "bound")
        )
        cos, sin = (
            Pair(self, value, rest, np.abs(bound), positive=False)
            for value, rest, bound in zip(values, rests, bounds, strict=True)
        )
        return cos, sin

    def root(self, f: Callable[[Pair], Pair], end: Pair) -> Pair:
        raise Unvouched


ROUNDED, QUICK, THOROUGH = Pairs(0), Pairs(1), Pairs(2)


def _room(like: Column, or_like: Column | None = None) -> Column:
    """Where to put a result, at a multiple of 64 bytes: SIMD is twice as fast there."""
    size = like.size if or_like is None else max(like.size, or_like.size)
    room = np.empty(size + 7)
    ahead: int = -(room.__array_interface__["data"][0] >> 3) & 7
    return room[ahead : ahead + size]


_scratch = local()


def _aside(count: int, size: int) -> list[Column]:
    """Rooms for what is soon forgotten: each thread has its own, which the processor has at hand."""
    rooms: list[Column] = getattr(_scratch, "rooms", [])
    if not rooms or rooms[0].size < size:
        _scratch.rooms = rooms = [_room(np.empty(size)) for _ in range(5)]
    return [room[:size] for room in rooms[:count]]


def _sum(x: Column, y: Column, add: Any = np.add) -> tuple[Column, Column]:
    """x + y, or x - y if ``add`` is np.subtract, rounded, and the error of that, exactly."""
    total = add(x, y, out=_room(x, y))
    error = _room(total)
    if y.min() >= 0 and (y <= x).all():  # then two operations do (T. J. Dekker)
        np.subtract(x, total, out=error)
        return total, add(error, y, out=error)
    (added,) = _aside(1, total.size)
    np.subtract(total, x, out=added)
    np.subtract(total, added, out=error)
    np.subtract(x, error, out=error)
    if add is np.add:
        np.subtract(y, added, out=added)
        error += added
    else:
        added += y
        error -= added
    return total, error


def _product(x: Column, y: Column) -> tuple[Column, Column]:
    """x y, rounded, and the error of that, exactly."""
    product = np.multiply(x, y, out=_room(x, y))
    part, *rooms = _aside(5, product.size)
    x_high, x_low = _halves(x, *rooms[:2])
    y_high, y_low = _halves(y, *rooms[2:])
    error = np.multiply(x_high, y_high, out=_room(product))
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
    values = [Fraction(power, 2**bits) for power in exact]
    heads = [float(value) for value in values]
    return np.array(heads), np.array([float(v - Fraction(h)) for v, h in zip(values, heads, strict=True)])
