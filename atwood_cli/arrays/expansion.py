"""Expansions: numbers as sums of two or three doubles with a proven error bound, in columns.

An `Expansion` stands for the sum of its parts. Each part is at most about half a unit in the last place of
the one before, and the relative error of the sum has a bound. `PAIRS` compute with two parts, to about
2^-101, `TRIPLES` with three, to about 2^-151. `TRIPLES` keep a power of two beside the parts, so that only
results can leave the range of doubles.

Let u = 2^-53, and n the number of parts. An operation loses at most `LOSS`, 2^5 u² or 2^8 u³, of its result,
or of both terms in a difference. Terms of about u^i of the result are of order i, and each order is summed on
its own (`_collected`). All orders but the last are summed exactly, as their rounding errors join the next
order. So two things are lost: the rounding errors of the last order, and terms of higher orders. In units of
u^n of the result (or of both terms):

- a sum loses 15. Its last order has two parts and one or two errors from the order before, together at
  most 5 u^(n-1), and is rounded up to three times;
- a product loses 37. Its last order has up to seven terms, together at most 10 u^(n-1). Forming them loses 3,
  adding them 31, and terms of order n, which are left out, 3;
- a quotient loses 52 (n - 1) + 27. It is found part by part, each from the remainder that the ones before
  leave, and off by 3 u of it. The last remainder is at most 9 u, so that is 27. Each remainder is found by a
  sum and a product. A root is found in the same way and loses no more.

So 2^8 is ample for n = 3. For n = 2 the last order is that of u, and the same counts give 3 for a sum, 8 for
a product and 20 for a quotient. Bounds are of first order, under the assumptions of `double_double`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from math import factorial, frexp, inf, ldexp, log
from typing import Any

from ..arithmetic.lazy import lazy
from ..arithmetic.symbolic import Formula, Term, formula
from .double import Uncertified, absolute, both, equal, fold, joined, less, looked_up, maximum, minimum, where
from .error_free import UNIT, two_product, two_sum
from .tables import (
    FINE,
    FINER,
    FIRST_DEGREE,
    STEPS,
    TO_A_DEGREE,
    cosines_and_sines,
    in_parts,
    ln2,
    pi,
    powers,
    precise_cos_sin,
)

LOSS = {2: 2.0**5 * UNIT**2, 3: 2.0**8 * UNIT**3}
LARGEST = {2: 700.0, 3: 5000.0}  # argument of an exponential; beyond 5000 all results are infinite
TINY = -200  # below this power of two, e^x - 1, ln(1 + x) and sin x are x
NOTHING = -1.0e6  # the power of two beside a 0


Parts = tuple[Any, ...]


class Expansion:
    """The sum of ``parts`` times 2^``exponent``, whose relative error is at most ``loss`` + ``doubt``.

    ``positive`` says that no row is negative; ``covers`` is the first part of a number that is larger than
    this one in no row. ``loss`` is the same in all rows. ``doubt`` is a column, or None; it is NaN or
    infinite in rows without a bound.
    """

    covers: Term | None = None

    def __init__(
        self,
        arithmetic: Expansions,
        parts: Sequence[Term],
        loss: float = 0.0,
        doubt: Term | None = None,
        positive: bool = True,
        exponent: Term = 0.0,
    ) -> None:
        self.arithmetic, self.parts, self.exponent = arithmetic, tuple(parts), exponent
        self.loss, self.doubt, self.positive = loss, doubt, positive

    @property
    def bound(self) -> Any:
        return self.loss if self.doubt is None else self.doubt + self.loss

    @property
    def power(self) -> float:
        """The value if it is ±2^n, a factor that causes no rounding; else 0."""
        (first, *others) = self.parts
        if others or isinstance(first, Formula) or isinstance(self.exponent, Formula):
            return 0.0
        return ldexp(first, int(self.exponent)) if abs(frexp(first)[0]) == 0.5 else 0.0

    @property
    def exact(self) -> bool:
        """Whether this is a double, or a column of them."""
        return len(self.parts) == 1 and self.loss == 0 and self.doubt is None

    def __add__(self, other: Expansion | int) -> Expansion:
        return self._plus(other, 1.0)

    __radd__ = __add__

    def __sub__(self, other: Expansion | int) -> Expansion:
        return self._plus(other, -1.0)

    def _plus(self, other: Expansion | int, sign: float) -> Expansion:
        """The sum, or the difference for sign -1.

        Where neither term is ever negative, the sum is no less accurate than the less accurate term: the
        larger loss counts, and the doubts. Otherwise terms may cancel: the absolute errors of both are added
        and compared with what is left, row by row. What is known not to be negative, but came out negative,
        has a doubt of 1 or more.
        """
        ar, one, two = self.arithmetic, self, self.arithmetic.number(other)
        if ar.is_zero(two):
            return one
        if ar.is_zero(one):
            return two * sign
        if sign > 0 and two.covers is one.parts[0]:
            one, two = two, one
        ordered = one.covers is two.parts[0]
        x, y, exponent = ar.aligned(one, two)
        positive = one.positive and two.positive and sign > 0
        parts = ar.sum(x, y, sign, positive, ordered)
        if one.exact and two.exact and not ar.wide:
            return Expansion(ar, parts, positive=positive or ordered)
        if positive:
            doubt = ar.doubt_of_sum(one, two, x[0] / parts[0], y[0] / parts[0])
            return ar.made(parts, max(one.loss, two.loss) + ar.loss, doubt, True, exponent)
        x_size, y_size = (
            first if of.positive and of.doubt is None else absolute(first)
            for first, of in ((x[0], one), (y[0], two))
        )
        error = x_size * (one.bound + ar.loss) + y_size * (two.bound + ar.loss)
        return ar.made(parts, 0.0, ar.relative(error, parts[0]), ordered, exponent)

    def __mul__(self, other: Expansion | Fraction | float) -> Expansion:
        one, two = self, self.arithmetic.number(other)
        if one.power or self.arithmetic.is_zero(two):
            one, two = two, one
        if self.arithmetic.is_zero(one):
            return one
        return one._scaled(two.power) if two.power else one.arithmetic.product(one, two)

    __rmul__ = __mul__

    def _scaled(self, factor: float) -> Expansion:
        """This number times ±2^n."""
        if factor == 1:
            return self
        exponent = self.exponent
        if self.arithmetic.wide:
            mantissa, power = frexp(factor)
            factor, exponent = 2 * mantissa, exponent + (power - 1.0)
        parts = self.parts if factor == 1 else tuple(part * factor for part in self.parts)
        positive = self.positive and factor > 0
        return Expansion(self.arithmetic, parts, self.loss, self.doubt, positive, exponent)

    def __truediv__(self, other: Expansion | int) -> Expansion:
        two = self.arithmetic.number(other)
        if self.arithmetic.is_zero(self):
            return self
        return self._scaled(1 / two.power) if two.power else self.arithmetic.quotient(self, two)

    def __rtruediv__(self, other: int) -> Expansion:
        one: Expansion = self.arithmetic.number(other)
        return one / self


class Expansions:
    """The arithmetic of expansions of ``n`` parts; if ``wide``, with a power of two beside the parts."""

    def __init__(self, n: int, wide: bool) -> None:
        self.n, self.wide, self.loss = n, wide, LOSS[n]

    # Parts, without bounds

    def sum(
        self, x: Parts, y: Parts, sign: float = 1.0, positive: bool = False, ordered: bool = False
    ) -> Parts:
        """x + sign y.

        ``positive`` says that nothing cancels, as no row of either is negative; ``ordered`` that 0 <= y <= x.
        """
        y = tuple(part * sign for part in y)
        return normal(_collected([[parts[i] for parts in (x, y) if i < len(parts)] for i in range(self.n)]))

    def doubt_of_sum(self, one: Expansion, two: Expansion, *shares: Term) -> Any:
        """The doubt of a positive sum; each doubt counts as much as its term is of the sum."""
        doubts = [
            None if of.doubt is None else absolute(share) * of.doubt
            for of, share in zip((one, two), shares, strict=True)
        ]
        return joined(*doubts)

    def relative(self, error: Term, first: Term) -> Any:
        """An error relative to what is left. Without errors the result is exact, even if it is 0."""
        return where(equal(error, 0.0), 0.0, error / absolute(first))

    def multiply(self, x: Parts, y: Parts) -> Parts:
        return self._plus_product((), x, y)

    def _plus_product(self, rest: Parts, x: Parts, y: Parts) -> Parts:
        """rest + x y."""
        orders: list[list[Any]] = [[part] for part in rest] + [[] for _ in range(self.n - len(rest))]
        for i, a in enumerate(x):
            for j, b in enumerate(y[: self.n - i]):
                if i + j == self.n - 1:
                    orders[i + j].append(a * b)
                else:
                    product, error = two_product(a, b)
                    orders[i + j].append(product)
                    orders[i + j + 1].append(error)
        return normal(_collected(orders))

    def divide(self, x: Parts, y: Parts) -> Parts:
        """x/y, part by part: each divides the remainder that the ones before leave."""
        quotients = [x[0] / y[0]]
        for _ in range(self.n - 1):
            x = self._plus_product(x, (-1.0 * quotients[-1],), y)
            quotients.append(x[0] / y[0])
        return normal(quotients)

    def root_of(self, x: Parts) -> Parts:
        """√x, part by part."""
        first = Formula("sqrt", formula(x[0]))
        root: list[Any] = [first]
        for _ in range(self.n - 1):
            left = self._plus_product(x, tuple(-1.0 * part for part in root), tuple(root))
            root.append(left[0] / (2.0 * first))
        return normal(root)

    def _constant(self, q: Fraction) -> Parts:
        """The parts of a number."""
        parts = []
        for _ in range(self.n):
            parts.append(float(q))
            q -= Fraction(parts[-1])
            if not q:
                break
        return tuple(parts)

    # Numbers

    def number(self, q: Any) -> Expansion:
        """The expansion of a number, or of a column of exact doubles."""
        if isinstance(q, Expansion):
            return q
        if isinstance(q, Formula):
            if self.wide:
                return Expansion(self, (Formula("mantissa", q),), exponent=Formula("exponent", q))
            return Expansion(self, (q,))
        q, exponent = Fraction(q), 0
        if self.wide and q:
            exponent = q.numerator.bit_length() - q.denominator.bit_length()
            q /= Fraction(2) ** exponent
        parts = self._constant(q)
        loss = 0.0 if sum(map(Fraction, parts)) == q else self.loss / 2
        return Expansion(self, parts, loss, positive=q >= 0, exponent=float(exponent))

    def is_zero(self, x: Expansion) -> bool:
        return x.parts == (0.0,)

    def aligned(self, one: Expansion, two: Expansion) -> tuple[Parts, Parts, Term]:
        """The parts of both, scaled to one power of two, the larger of theirs."""
        if not self.wide:
            return one.parts, two.parts, 0.0
        exponent = maximum(one.exponent, two.exponent)
        x, y = (tuple(part * power_of_two(of.exponent - exponent) for part in of.parts) for of in (one, two))
        return x, y, exponent

    def made(
        self, parts: Parts, loss: float, doubt: Term | None, positive: bool, exponent: Term
    ) -> Expansion:
        """A number from its parts; if wide, scaled so that the first part is from 1/2 to 1."""
        if self.wide:
            own = Formula("exponent", formula(parts[0]))
            parts = tuple(part * power_of_two(-1.0 * own) for part in parts)
            exponent = exponent + own
        return Expansion(self, parts, loss, doubt, positive, exponent)

    def product(self, x: Expansion, y: Expansion) -> Expansion:
        loss = 0.0 if x.exact and y.exact else self.loss
        return self.of_factors(x, y, self.multiply(x.parts, y.parts), loss, x.exponent + y.exponent)

    def quotient(self, x: Expansion, y: Expansion) -> Expansion:
        return self.of_factors(x, y, self.divide(x.parts, y.parts), self.loss, x.exponent - y.exponent)

    def of_factors(
        self, x: Expansion, y: Expansion, parts: Parts, loss: float, exponent: Term = 0.0
    ) -> Expansion:
        """A product or quotient, from its parts and what the operation itself loses; bounds add up."""
        doubt, positive = joined(x.doubt, y.doubt), x.positive and y.positive
        return self.made(parts, x.loss + y.loss + loss, doubt, positive, exponent)

    def sqrt(self, x: Expansion) -> Expansion:
        """√x for x >= 0."""
        parts, exponent = x.parts, x.exponent
        if self.wide:
            half = Formula("floor", exponent * 0.5)
            parts, exponent = tuple(part * (1.0 + (exponent - 2.0 * half)) for part in parts), half
        doubt = None if x.doubt is None else 0.5 * x.doubt
        return self.made(self.root_of(parts), x.loss / 2 + self.loss, doubt, True, exponent)

    def hypot(self, x: Expansion, y: Expansion | int) -> Expansion:
        return self.sqrt(x * x + y * y)

    @lazy
    def pi(self) -> Expansion:
        return self.number(pi())

    # Functions

    def exp(self, x: Expansion) -> Expansion:
        return self.expm1(x) + 1

    def expm1(self, x: Expansion) -> Expansion:
        """k = e^x - 1 for x >= 0; in pairs it has no bound beyond x = 700 (`LARGEST`).

        The largest multiple of ln 2/65536 that is not above x is split into m ln 2, steps of a table of
        a = 2^(i/16384) - 1, and steps of a table of b = 2^(i/65536) - 1. The rest r < 1.1e-5 of x gives
        s = e^r - 1 by its Taylor series. Then 1 + k = 2^m (1 + a)(1 + b)(1 + s). The factors are joined as
        a + k + a k, where nothing cancels. An error of x counts x + 1 times, as x e^x < (x + 1)(e^x - 1), and
        r loses `LOSS` of x.
        """
        return self._unless_tiny(x, self._expm1)

    def _expm1(self, x: Expansion) -> Expansion:
        first, *others = self._plain(x)
        within = less(first, LARGEST[self.n])
        high = minimum(first, LARGEST[self.n])
        count = Formula("floor", high * (FINE / log(2)))
        r = self._less_multiple(high, [where(within, part, 0.0) for part in others], count, ln2() / FINE, 24)
        k = Expansion(self, self._small_expm1(r), 4 * self.loss)
        number = Formula("int", count)
        for steps, step in (
            (FINE, Formula("bits", number, FINER - 1)),
            (STEPS, Formula("bits", _shifted(number, FINER), STEPS - 1)),
        ):
            factor = Expansion(
                self, [looked_up(table, step) for table in powers(steps, self.n)], self.loss / 2
            )
            k = factor + k + factor * k
        m = Formula("floor", count * (1 / FINE))
        if self.wide:
            k = Expansion(self, k.parts, k.loss, exponent=k.exponent + m)
            k = k + self._whole(two_sum(1.0, -1.0 * power_of_two(-1.0 * m)), m)
        else:
            power = power_of_two(m)
            k = Expansion(self, [part * power for part in k.parts], k.loss)
            k = k + self._whole(two_sum(power, -1.0), 0.0)
        k.doubt = joined(k.doubt, (x.bound + self.loss) * (1.0 + high))
        if not self.wide:
            k.doubt = where(within, k.doubt, inf)
        return k

    def _whole(self, parts: Parts, exponent: Term) -> Expansion:
        """A number without error."""
        return self.made(parts, 0.0, None, True, exponent)

    def _less_multiple(
        self, first: Term, others: Sequence[Term], count: Formula, step: Fraction, bits: int
    ) -> Parts:
        """x minus the multiple of a constant that is near it (argument reduction).

        The constant is split into parts of so many bits, whose multiples are exact, and the rest.
        """
        near, *parts = in_parts(step, bits, 2 * self.n - 1)
        terms = [first - count * near, *(count * -part for part in parts[:-1])]
        orders: list[list[Any]] = [terms, [count * -parts[-1]]] + [[] for _ in range(self.n - 2)]
        for order, part in zip(orders[1:], others, strict=False):
            order.append(part)
        return normal(_collected(orders))

    def _small_expm1(self, r: Parts) -> Parts:
        """e^r - 1 for a small r, by its Taylor series, to 2^-110 or 2^-164 of it."""
        terms, more = {2: (3, 6), 3: (6, 10)}[self.n]
        return self._series(r, r, [Fraction(1, factorial(k)) for k in range(1, more + 1)], terms)

    def _series(self, factor: Parts, x: Parts, coefficients: Sequence[Fraction], terms: int) -> Parts:
        """``factor`` Σ c_k x^k from k = 0; terms from k = ``terms`` on are computed in doubles."""
        total: Any = 0.0
        for c in reversed(coefficients[terms:]):
            total = total * x[0] + float(c)
        parts: Parts = (total,)
        for c in reversed(coefficients[:terms]):
            parts = self._plus_product(self._constant(c), parts, x)
        return self.multiply(parts, factor)

    def log1p(self, x: Expansion) -> Expansion:
        """ln(1 + x) for x >= 0, as a double y and a correction.

        The correction is ln(1 + δ) for δ = (1 + x)/e^y - 1, by ``n`` terms of its series. As y is below 1500
        and off by a few u of it, δ is below 2^-41.
        """
        return self._unless_tiny(x, self._log1p)

    def _log1p(self, x: Expansion) -> Expansion:
        if self.wide:
            small = less(x.exponent, 1000.0)
            plain = x.parts[0] * power_of_two(where(small, x.exponent, 0.0))
            log_of_large = Formula("log", formula(x.parts[0])) + x.exponent * log(2)
            high = where(small, Formula("log1p", plain), log_of_large)
        else:
            high = Formula("log1p", formula(x.parts[0]))
        y = self._whole((high,), 0.0)
        guess = self.expm1(y)
        off = (x - guess) / (guess + 1)
        result = y + off - off * off / 2
        if self.n == 3:
            result = result + off * off * off / 3
        result.positive = True
        return result

    def cos_sin(self, x: Expansion) -> tuple[Expansion, Expansion]:
        """Cosine and sine, 0 <= x <= 4."""
        first, *others = self._plain(x)
        index = Formula("rint", first * float(180 * TO_A_DEGREE / pi()))
        rest = self._less_multiple(first, others, index, pi() / (180 * TO_A_DEGREE), 24)
        return self._cos_sin(index, rest, x, absolute(first) * (x.bound + self.loss))

    def cos_sin_of_degrees(self, x: Any) -> tuple[Expansion, Expansion]:
        """Cosine and sine of an angle in degrees, or of a column of exact ones."""
        if isinstance(x, Fraction):
            cos, sin = map(self.number, precise_cos_sin(x))
            return cos, sin
        (degrees,) = self._plain(x)
        folded, turn = fold(degrees)
        index = Formula("rint", folded * TO_A_DEGREE)
        rest = self.multiply((folded - index * (1 / TO_A_DEGREE),), self._constant(pi() / 180))
        angle = self.number(folded) * self.pi / 180
        cos, sin = self._cos_sin(index, rest, angle, absolute(rest[0]) * self.loss)
        x_parts, y_parts = zip(*(turn(*both) for both in zip(cos.parts, sin.parts, strict=True)), strict=True)
        exponents, doubts = turn(cos.exponent, sin.exponent, False), turn(cos.bound, sin.bound, False)
        return (
            Expansion(self, x_parts, 0.0, doubts[0], False, exponents[0]),
            Expansion(self, y_parts, 0.0, doubts[1], False, exponents[1]),
        )

    def _cos_sin(self, index: Formula, rest: Parts, x: Expansion, error: Term) -> tuple[Expansion, Expansion]:
        """Cosine and sine of x, which is ``index`` steps of the table and a small rest r, with its error.

        cos r - 1 and sin r are summed as series in -r², to 2^-110 or 2^-164 of them, as |r| < 2^-8.8.
        """
        square = self.multiply(tuple(-1.0 * part for part in rest), rest)
        terms, more = {2: (3, 6), 3: (5, 8)}[self.n]
        k, sine = (
            Expansion(
                self,
                self._series(
                    factor, square, [Fraction(1, factorial(2 * k + odd)) for k in range(more)], terms
                ),
                4 * self.loss,
                positive=False,
            )
            for factor, odd in ((square, 2), (rest, 1))
        )
        place = Formula("int", index - float(FIRST_DEGREE * TO_A_DEGREE))
        c, s = (
            Expansion(self, [looked_up(table, place) for table in tables], self.loss / 2, positive=False)
            for tables in cosines_and_sines(self.n)
        )
        cos, sin = c + (c * k - s * sine), s + (s * k + c * sine)
        for one in (cos, sin):
            one.doubt = one.bound + where(equal(error, 0.0), 0.0, error / absolute(self._plain(one)[0]))
            one.loss = 0.0
        return cos, self._unless_tiny(x, lambda _: sin)

    def _unless_tiny(self, x: Expansion, function: Callable[[Expansion], Expansion]) -> Expansion:
        """function(x), or x itself where it is below 2^-200: there they differ by at most 2^-200 of x."""
        if not self.wide:
            return function(x)
        tiny = less(x.exponent, float(TINY))
        usual = Expansion(
            self,
            [where(tiny, 0.5 if i == 0 else 0.0, part) for i, part in enumerate(x.parts)],
            x.loss,
            x.doubt,
            x.positive,
            where(tiny, 0.0, x.exponent),
        )
        y = function(usual)
        own = (*x.parts, *[0.0] * (self.n - len(x.parts)))
        parts = [where(tiny, one, other) for one, other in zip(own, y.parts, strict=True)]
        doubt, exponent = where(tiny, x.bound + self.loss, y.bound), where(tiny, x.exponent, y.exponent)
        return Expansion(self, parts, 0.0, doubt, y.positive, exponent)

    def _plain(self, x: Expansion) -> Parts:
        """The parts of a number within the range of doubles, without a power of two."""
        return tuple(part * power_of_two(x.exponent) for part in x.parts) if self.wide else x.parts

    def root(self, f: Callable[[Expansion], Expansion], end: Expansion) -> Expansion:
        """The root of f between 0 and ``end``, where f is negative before it and positive after.

        First doubles find it, by secants that keep it between two points (N. Anderson and Å. Björck, 1973).
        Then a few steps along the last reliable slope add digits. In the end f is checked to have opposite
        signs closely before and after the root, so the search need not be trusted.
        """
        if self.wide:
            raise Uncertified

        def at(x: Parts) -> Expansion:
            return f(Expansion(self, x))

        def value(x: Term) -> Any:
            return at((x,)).parts[0]

        width = end.parts[0]
        a, b = formula(0.0), width
        f_a, f_b = value(a), value(b)
        slope = (f_b - f_a) / width
        for _ in range(SECANTS):
            c = b - f_b * (b - a) / (f_b - f_a)
            c = where(both(less(0.0, c), less(c, width)), c, b)
            f_c = value(c)
            near = absolute(c - b)
            slope = where(less(near, width * WORTH), slope, (f_c - f_b) / (c - b))
            crossed = less(f_c * f_b, 0.0)
            shrunk = 1.0 - f_c / f_b
            f_a = where(crossed, f_b, f_a * where(less(0.0, shrunk), shrunk, 0.5))
            a, b, f_b = where(crossed, b, a), c, f_c
        x: Parts = (b,)
        for _ in range(STEPS_ALONG):
            x = self.sum(x, (-1.0 * at(x).parts[0] / slope,))
        near_by = at(self.sum(x, (width * NEAR_BY,)))
        blur = near_by.parts[0] * near_by.bound
        aside = width * ASIDE + 4.0 * blur / slope
        before, after = at(self.sum(x, (-1.0 * aside,))), at(self.sum(x, (aside,)))
        sure = both(less(before.parts[0], 0.0), less(0.0, after.parts[0]))
        for one in (before, after):
            sure = both(sure, less(one.bound, 0.5))
        return Expansion(self, x, 0.0, where(sure, aside / x[0], inf))


SECANTS, STEPS_ALONG = 9, 3
WORTH = 2.0**-24
"""The least distance, in whole widths, of two points for the slope between them to be reliable."""
ASIDE, NEAR_BY = 2.0**-85, 2.0**-40
"""Distances from a root, in whole widths: to check the signs of an accurate f, and to read its error."""

PAIRS, TRIPLES = Expansions(2, wide=False), Expansions(3, wide=True)


def _collected(orders: list[list[Any]]) -> Parts:
    """The sum of terms, order by order; the rounding errors of each order join the next one."""
    parts = []
    for i, terms in enumerate(orders):
        if not terms:
            break
        total = terms[0]
        for term in terms[1:]:
            if i == len(orders) - 1:
                total = total + term
            else:
                total, error = two_sum(total, term)
                orders[i + 1].append(error)
        parts.append(total)
    return tuple(parts)


def normal(parts: Sequence[Any]) -> Parts:
    """The same sum, made of parts that are each at most about u times the one before.

    Each pass adds from the last part to the first. One pass a part is enough, even if leading parts cancel.
    """
    parts = list(parts)
    for _ in parts[1:]:
        for i in reversed(range(len(parts) - 1)):
            parts[i], parts[i + 1] = two_sum(parts[i], parts[i + 1])
    return tuple(parts)


def power_of_two(exponent: Term) -> Any:
    """2 to the power of a column of integers; 0 below the range of doubles."""
    return Formula("power", exponent) if isinstance(exponent, Formula) else 2.0**exponent


def times_power_of_two(x: Term, exponent: Term) -> Any:
    """x 2^exponent, rounded once if it is a subnormal double; 0 or infinite beyond the range."""
    half = Formula("floor", formula(exponent * 0.5))
    return x * power_of_two(half) * power_of_two(exponent - half)


def _shifted(number: Formula, steps: int) -> Formula:
    return Formula(">>", number, steps.bit_length() - 1)
