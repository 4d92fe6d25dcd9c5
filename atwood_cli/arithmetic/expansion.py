"""Expansions: numbers as sums of two or three doubles that know their error, in columns, a row a scene.

An `Expansion` stands for the sum of its parts, each at most about half a unit in the last place of the one
before, with a proven bound on its relative error. `PAIRS` compute with two parts, to about 2^-101; `TRIPLES`
with three, to about 2^-151, times a power of two that is kept beside them, so that nothing leaves the range
of doubles but results.

Let u = 2^-53, and n the number of parts. An operation loses at most `LOSS`, 2^5 u² or 2^8 u³, of its
result, or of both terms in a difference. Terms are summed by their order, those of about u^i of the result
apart (`_collected`): sums of all orders but the last are exact, as what they round off joins the next. So
what is lost are roundings of the last order, and what is of higher ones. In units of u^n, of the size of
the result (or of both terms):

- a sum adds two parts to the one or two errors that arrive: the last order has up to five terms of u^(n-1)
  in all, rounded up to three times: 15;
- a product has up to seven terms of at most 10 u^(n-1) in all, rounded as they are formed, 3, and added,
  31, and what is of order n is left out, 3: 37;
- a quotient is found part by part, each from what the ones before leave of the dividend, and off by 3 u of
  that. What they leave is at most 3, 9 u; to find it loses as much as a sum and a product, for each part
  but the last: 52 (n - 1), and 27. A root is found in the same way and loses no more.

So 2^8 is ample for n = 3. For n = 2 the last order is that of u: 3 for a sum, 8 for a product, 20 for a
quotient. Bounds are kept in first order, as in `double_double`, whose assumptions hold here too.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from math import factorial, frexp, inf, ldexp, log
from typing import Any

from .double import Unvouched, absolute, both, equal, fold, joined, less, looked_up, maximum, minimum, where
from .error_free import UNIT, two_product, two_sum
from .lazy import lazy
from .symbolic import Formula, Part, formula
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
LARGEST = {2: 700.0, 3: 5000.0}  # argument of an exponential; beyond the latter all results are infinite
TINY = -200  # power of two below which e^x - 1, ln(1 + x) and sin x are x
NOTHING = -1.0e6  # the power of two beside a 0

Parts = tuple[Any, ...]


class Expansion:
    """The sum of ``parts`` times 2^``exponent``, off by at most ``loss`` + ``doubt`` of itself.

    ``positive`` says that no row is negative. Of the bound ``loss`` is the same in all rows, and ``doubt`` a
    column, or None; it is no number, or infinite, where there is no bound.
    """

    def __init__(
        self,
        arithmetic: Expansions,
        parts: Sequence[Part],
        loss: float = 0.0,
        doubt: Part | None = None,
        positive: bool = True,
        exponent: Part = 0.0,
    ) -> None:
        self.arithmetic, self.parts, self.exponent = arithmetic, tuple(parts), exponent
        self.loss, self.doubt, self.positive = loss, doubt, positive

    @property
    def bound(self) -> Any:
        return self.loss if self.doubt is None else self.doubt + self.loss

    @property
    def power(self) -> float:
        """The value, where it is a power of two, or -1 times one: a factor that rounds nothing; else 0."""
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
        """The sum, or the difference for sign -1; bounds count as much as the terms weigh beside it."""
        ar, one, two = self.arithmetic, self, self.arithmetic.number(other) * sign
        if ar.is_zero(two):
            return one
        if ar.is_zero(one):
            return two
        x, y, exponent = ar.aligned(one, two)
        parts = ar.sum(x, y)
        positive = one.positive and two.positive
        if one.exact and two.exact and not ar.wide:
            return Expansion(ar, parts, positive=positive)
        if positive:
            weighed = [_times(first / parts[0], of.doubt) for first, of in ((x[0], one), (y[0], two))]
            return ar.made(parts, max(one.loss, two.loss) + ar.loss, joined(*weighed), True, exponent)
        off = absolute(x[0]) * (one.bound + ar.loss) + absolute(y[0]) * (two.bound + ar.loss)
        # What cancels to nothing without an error is exact.
        doubt = where(equal(off, 0.0), 0.0, off / absolute(parts[0]))
        return ar.made(parts, 0.0, doubt, False, exponent)

    def __mul__(self, other: Expansion | Fraction | float) -> Expansion:
        one, two = self, self.arithmetic.number(other)
        if one.power or self.arithmetic.is_zero(two):
            one, two = two, one
        if self.arithmetic.is_zero(one):
            return one
        return one._scaled(two.power) if two.power else one.arithmetic.product(one, two)

    __rmul__ = __mul__

    def _scaled(self, factor: float) -> Expansion:
        """This number times a power of two, or -1 times one."""
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
    """Expansions of ``n`` parts; wide ones keep a power of two beside them."""

    def __init__(self, n: int, wide: bool) -> None:
        self.n, self.wide, self.loss = n, wide, LOSS[n]

    # Parts, without bounds

    def sum(self, x: Parts, y: Parts) -> Parts:
        orders: list[list[Any]] = [[] for _ in range(self.n)]
        for parts in (x, y):
            for order, part in zip(orders, parts, strict=False):
                order.append(part)
        return _collected(orders)

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
        return _collected(orders)

    def divide(self, x: Parts, y: Parts) -> Parts:
        """Part by part, each from what the ones before leave."""
        quotients = [x[0] / y[0]]
        for _ in range(self.n - 1):
            x = self._plus_product(x, (-1.0 * quotients[-1],), y)
            quotients.append(x[0] / y[0])
        return _normal(quotients)

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

    def aligned(self, one: Expansion, two: Expansion) -> tuple[Parts, Parts, Part]:
        """The parts of both beside one power of two, the larger one."""
        if not self.wide:
            return one.parts, two.parts, 0.0
        exponent = maximum(one.exponent, two.exponent)
        x, y = (tuple(part * power_of_two(of.exponent - exponent) for part in of.parts) for of in (one, two))
        return x, y, exponent

    def made(
        self, parts: Parts, loss: float, doubt: Part | None, positive: bool, exponent: Part
    ) -> Expansion:
        """A number from its parts; if wide, made so that the first is from 1/2 to 1."""
        if self.wide:
            own = Formula("exponent", formula(parts[0]))
            parts = tuple(part * power_of_two(-1.0 * own) for part in parts)
            exponent = exponent + own
        return Expansion(self, parts, loss, doubt, positive, exponent)

    def product(self, x: Expansion, y: Expansion) -> Expansion:
        loss = 0.0 if x.exact and y.exact else self.loss
        return self._of_factors(x, y, self.multiply(x.parts, y.parts), x.exponent + y.exponent, loss)

    def quotient(self, x: Expansion, y: Expansion) -> Expansion:
        return self._of_factors(x, y, self.divide(x.parts, y.parts), x.exponent - y.exponent, self.loss)

    def _of_factors(self, x: Expansion, y: Expansion, parts: Parts, exponent: Part, loss: float) -> Expansion:
        doubt, positive = joined(x.doubt, y.doubt), x.positive and y.positive
        return self.made(parts, x.loss + y.loss + loss, doubt, positive, exponent)

    def sqrt(self, x: Expansion) -> Expansion:
        """√x for x >= 0, part by part."""
        rest, exponent = x.parts, x.exponent
        if self.wide:
            half = Formula("floor", exponent * 0.5)
            rest, exponent = tuple(part * (1.0 + (exponent - 2.0 * half)) for part in rest), half
        first = Formula("sqrt", formula(rest[0]))
        root: list[Any] = [first]
        for _ in range(self.n - 1):
            left = self._plus_product(rest, tuple(-1.0 * part for part in root), tuple(root))
            root.append(left[0] / (2.0 * first))
        return self.made(_normal(root), x.loss / 2 + self.loss, _times(0.5, x.doubt), True, exponent)

    def hypot(self, x: Expansion, y: Expansion | int) -> Expansion:
        return self.sqrt(x * x + y * y)

    @lazy
    def pi(self) -> Expansion:
        return self.number(pi())

    # Functions

    def exp(self, x: Expansion) -> Expansion:
        return self.expm1(x) + 1

    def expm1(self, x: Expansion) -> Expansion:
        """e^x - 1 for x >= 0; in pairs it has no bound beyond e^700 (`LARGEST`).

        1 + k = 2^m (1 + a)(1 + b)(1 + r'), with n, the next lower multiple of ln 2/65536 to x, told apart
        into m, steps of a table of a = 2^(i/16384) - 1 and of one of b = 2^(i/65536) - 1, and r' = e^r - 1
        by the Taylor series of what is left of x, r < 1.1e-5. Nothing cancels on the way: a + k + a k. An
        error of x counts x + 1 times, as x e^x < (x + 1)(e^x - 1), and `LOSS` of x is lost in r.
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

    def _whole(self, parts: Parts, exponent: Part) -> Expansion:
        """A number that is exact."""
        return self.made(parts, 0.0, None, True, exponent)

    def _less_multiple(
        self, first: Part, others: Sequence[Part], count: Formula, step: Fraction, bits: int
    ) -> Parts:
        """x less a multiple of a constant that is near it.

        The constant comes in parts of so many bits, of which the multiples are exact, and the rest.
        """
        near, *parts = in_parts(step, bits, 2 * self.n - 1)
        terms = [first - count * near, *(count * -part for part in parts[:-1])]
        orders: list[list[Any]] = [terms, [count * -parts[-1]]] + [[] for _ in range(self.n - 2)]
        for order, part in zip(orders[1:], others, strict=False):
            order.append(part)
        return _collected(orders)

    def _small_expm1(self, r: Parts) -> Parts:
        """e^r - 1 for what the tables leave, by its Taylor series, to 2^-110 or 2^-164 of it."""
        terms, more = {2: (3, 6), 3: (6, 10)}[self.n]
        return self._series(r, r, [Fraction(1, factorial(k)) for k in range(1, more + 1)], terms)

    def _series(self, factor: Parts, x: Parts, coefficients: Sequence[Fraction], terms: int) -> Parts:
        """``factor`` Σ c_k x^k, from k = 0; the terms of higher order than ``terms`` - 1 in doubles."""
        total: Any = 0.0
        for c in reversed(coefficients[terms:]):
            total = total * x[0] + float(c)
        parts: Parts = (total,)
        for c in reversed(coefficients[:terms]):
            parts = self._plus_product(self._constant(c), parts, x)
        return self.multiply(parts, factor)

    def log1p(self, x: Expansion) -> Expansion:
        """ln(1 + x) for x >= 0: a double y, and ln(1 + δ), δ = (1 + x)/e^y - 1, by ``n`` terms of its series.

        As y is off by a few u of it, and is below 1500, δ is below 2^-41.
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
        """Cosine and sine of a number of degrees, or of a column of exact ones."""
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

    def _cos_sin(self, index: Formula, rest: Parts, x: Expansion, error: Part) -> tuple[Expansion, Expansion]:
        """Cosine and sine of x, which is ``index`` steps of the table and a small rest, with that error.

        cos r - 1 and sin r are series in -r², with |r| < 2^-8.8, to 2^-110 or 2^-164 of them.
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
        """What a function gives that is x itself, but for 2^-200 of it, where x is as tiny as that."""
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
        """The parts of a number that doubles can hold."""
        return tuple(part * power_of_two(x.exponent) for part in x.parts) if self.wide else x.parts

    def root(self, f: Callable[[Expansion], Expansion], end: Expansion) -> Expansion:
        """The root of f between 0 and ``end``, where f is negative before it and positive after.

        Found in doubles, by secants that keep to either side of it (N. Anderson and Å. Björck, 1973), and
        then in steps along the last slope that is worth its name. That f has opposite signs a little to both
        sides is checked, so the search need not be trusted.
        """
        if self.wide:
            raise Unvouched

        def at(x: Parts) -> Expansion:
            return f(Expansion(self, x))

        def value(x: Part) -> Any:
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
"""How far apart, beside the whole width, points must be for the slope between them to be worth its name."""
ASIDE, NEAR_BY = 2.0**-85, 2.0**-40
"""How far beside a root, in whole widths, signs are checked where f is sharp, and its blur is seen."""

PAIRS, TRIPLES = Expansions(2, wide=False), Expansions(3, wide=True)


def _collected(orders: list[list[Any]]) -> Parts:
    """The sum of terms, those of each order apart; what a sum rounds off joins the next order."""
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
    return _normal(parts)


def _normal(parts: Sequence[Any]) -> Parts:
    """The same sum, of parts that are at most about u times the one before, or its first.

    From the last to the first, as often as parts may have cancelled and left only what is below them.
    """
    parts = list(parts)
    for _ in parts[1:]:
        for i in reversed(range(len(parts) - 1)):
            parts[i], parts[i + 1] = two_sum(parts[i], parts[i + 1])
    return tuple(parts)


def power_of_two(exponent: Part) -> Any:
    """2 to the power of a column of whole numbers; 0 below the range of doubles."""
    return Formula("power", exponent) if isinstance(exponent, Formula) else 2.0**exponent


def times_power_of_two(x: Part, exponent: Part) -> Any:
    """x 2^exponent, at once to a subnormal double, to 0 or to infinity."""
    half = Formula("floor", formula(exponent * 0.5))
    return x * power_of_two(half) * power_of_two(exponent - half)


def _times(factor: Part, doubt: Part | None) -> Any:
    """A bound's column as it weighs; there may be none."""
    return None if doubt is None else factor * doubt


def _shifted(number: Formula, steps: int) -> Formula:
    return Formula(">>", number, steps.bit_length() - 1)
