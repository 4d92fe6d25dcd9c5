"""Double-doubles at the least cost: two doubles with about four more digits than one, and a proven bound.

Most rows need no more to be certified. `Quick` computes with the same `Expansion` as `expansion` does, but
with fewer operations, which lose more: 2^-67 of the result, not 2^-101. `Rounded` loses 2^-53 in a product.

A number is high + low. A factor is split into its head, the first 26 bits of high, and its tail, which is the
rest. The product of two heads is exact, and only what is multiplied by a tail is rounded. So low parts are
not small: |low| <= t |high|. Each product, quotient and root adds 2^-25 to t for every head that it cuts. A
positive sum has no larger t than its terms, and a difference is normalized. No quantity takes more than 60
operations, so t < 2^-18. Only tails and remainders are rounded, and none of them is above 2t of the result. A
product loses 7 u t, a quotient 9 u t, a root or sum less. That is below 2^-67 (`LOSS`) of the result, or of
both terms in a difference.

Where a difference leaves less than t of its terms, the normalization may round off 2 u t of the terms, and
the low part that is left may exceed t. The bound, at least 2^-66/t, is larger than what that loses. It is
also so large that the row is not certified, and more digits are asked for.

Three things are assumed here and in `expansion`. Doubles follow IEEE 754, as in `error_free`. NumPy's log1p
is within one unit in the last place, 2u of the value (`LIBRARY`; the tests measure at most 0.7 units); only
`Quick` relies on it. And inputs are 0 or within 2^±120 (`WINDOW`), as are I/R² and f/g, which stand for I and
the axle's friction: the caller checks that. So no product of the equations leaves the normal doubles, but for
squares that are negligible beside what they are added to. (`TRIPLES` need no window.) Bounds are of first
order: products of two bounds are left out. The limits that bounds are compared with leave room for them.
"""

from __future__ import annotations

from math import log
from operator import add, sub
from typing import Any

from ..arithmetic.symbolic import Formula, Term, formula
from .double import Uncertified, absolute, joined, looked_up, maximum, minimum
from .error_free import UNIT, fast_two_sum, head_of, two_sum
from .expansion import Expansion, Expansions, Parts
from .tables import STEPS, heads_and_tails, in_parts, ln2, whole_powers

WINDOW = 2.0**-120, 2.0**120
LIBRARY = 2 * UNIT
LOSS = 2.0**-67  # the error of an operation
NEARLY = 0.4 * UNIT  # a divisor this close to a double, such as π, is taken for the double
LARGEST = 36.0  # argument of an exponential


class Quick(Expansions):
    """Products, quotients, roots and exponentials by heads of 26 bits; logarithms by NumPy."""

    def __init__(self) -> None:
        super().__init__(2, wide=False)
        self.loss = LOSS

    def sum(
        self, x: Parts, y: Parts, sign: float = 1.0, positive: bool = False, ordered: bool = False
    ) -> Parts:
        (a, *low), (b, *more) = x, y
        plus = add if sign > 0 else sub
        if ordered:
            high = plus(a, b)
            error = plus(a - high, b)
        elif positive:
            high, error = fast_two_sum(maximum(a, b), minimum(a, b))
        else:
            high, error = two_sum(a, b * sign)
        for part in low:
            error = error + part
        for part in more:
            error = plus(error, part)
        return fast_two_sum(high, error) if (low or more) and not positive else (high, error)

    def normal(self, x: Parts) -> Parts:
        """The same number, with a low part of at most half a unit in the last place."""
        return fast_two_sum(*x) if len(x) == 2 else x

    def doubt_of_sum(self, one: Expansion, two: Expansion, *_: Term) -> Any:
        """Each doubt counts in full, which costs less."""
        return one.doubt if one.doubt is two.doubt else joined(one.doubt, two.doubt)

    def relative(self, error: Term, first: Term) -> Any:
        return error / absolute(first)

    def product(self, x: Expansion, y: Expansion) -> Expansion:
        """High is the product of the heads, and low is head · tail + tail · whole.

        Rounded are the tails, one whole, two products and their sum: 7 u t.
        """
        a, b = (x.parts, y.parts) if len(y.parts) == 1 else (y.parts, x.parts)  # b may be whole already
        (a_head, a_tail), (b_head, b_tail) = _halves(a), _halves(b)
        return self.of_factors(x, y, (a_head * b_head, a_head * b_tail + a_tail * _whole(b)), LOSS)

    def divide(self, x: Parts, y: Parts) -> Parts:
        """High is the head q of the rounded quotient, and low is ((x - q · head) - q · tail)/whole.

        Rounded are the steps of a product and two divisions: 9 u t.
        """
        whole, (head, tail) = _whole(y), _halves(y)
        high = head_of(x[0] / whole)
        return high, _less(x, high * head, high * tail) / whole

    def root_of(self, x: Parts) -> Parts:
        """High is the head v of the rounded root w, and low is (x - v²)/(w + v) ≈ √x - v."""
        root = Formula("sqrt", formula(_whole(x)))
        high = head_of(root)
        return high, _less(x, high * high) / (high + root)

    def expm1(self, x: Expansion) -> Expansion:
        """k = e^x - 1 for x >= 0; NaN beyond x = 36 (`LARGEST`).

        Let n ln 2/16384 be the multiple nearest to x, a = 2^(n/16384) - 1, from a table, and r = e^y - 1 for
        the rest y of x, |y| < 2^-15.5. Then 1 + k = (1 + a)(1 + r), so k = a + r + a r, where nothing
        cancels, and a <= 2 k. a is a head, exact for x <= 36, and a tail. The head and y are added with their
        rounding error. Rounded are a r and the terms of r after y, thrice each, as they are formed and as
        they are added: 12 u 2^-15.5 k and less, below 2^-64 of k. The first term left out is 2^-69 y. An
        error of x counts x + 1 times, because x e^x < (x + 1)(e^x - 1); each part of the multiple of ln 2
        that joins x's low part adds u t x to it.
        """
        # At 2 `LARGEST` the table of whole powers has ended, so larger numbers give NaN as well.
        count = Formula("rint", minimum(_whole(x.parts), 2 * LARGEST) * (STEPS / log(2)))
        first, last = in_parts(ln2() / STEPS, 30, 1)
        low = _less((count * -last, *x.parts[1:]))
        y, rest = fast_two_sum(x.parts[0] - count * first, low)
        terms = (((y * (1 / 24) + 1 / 6) * y + 1 / 2) * y) * y + rest
        number = Formula("int", count)
        step = Formula("bits", number, STEPS - 1)
        power = looked_up(whole_powers(), Formula(">>", number, STEPS.bit_length() - 1))
        heads, tails = heads_and_tails()
        head = looked_up(heads, step) * power + (power - 1.0)
        tail = looked_up(tails, step) * power
        high, error = fast_two_sum(head, y)
        parts = fast_two_sum(high, (head + tail) * (y + terms) + terms + tail + error)
        doubt = parts[0] * 0.0  # or NaN
        if x.doubt is not None:
            doubt = doubt + x.doubt * (1 + LARGEST)
        return Expansion(self, parts, 2.0**-64 + (x.loss + LOSS) * (1 + LARGEST), doubt)

    def log1p(self, x: Expansion) -> Expansion:
        """ln(1 + x) for x >= 0 by NumPy, with no more digits than a double."""
        high, *low = self.normal(x.parts)
        parts = (Formula("log1p", formula(high)), *(part / (high + 1.0) for part in low))
        return Expansion(self, parts, LIBRARY + x.loss + LOSS, x.doubt)

    def _cos_sin(self, *_: Any) -> tuple[Expansion, Expansion]:
        raise Uncertified

    def root(self, *_: Any) -> Expansion:
        raise Uncertified


class Rounded(Quick):
    """Products and quotients are rounded to a double, which costs less than heads, and loses u each.

    Low parts are a few u: they start with at most half a unit in the last place (`normal`), and each
    operation adds at most u. So in 60 operations the products of two low parts, and the roundings of low
    parts, come to less than 2^14 u², far below `LOSS`.
    """

    def number(self, q: Any) -> Expansion:
        x = super().number(q)
        if x.arithmetic is self:
            return x
        own = Expansion(self, self.normal(x.parts), x.loss, x.doubt, x.positive)
        own.covers = x.covers
        return own

    def product(self, x: Expansion, y: Expansion) -> Expansion:
        (a, *low), (b, *more) = x.parts, y.parts
        terms = [part * b for part in low] + [part * a for part in more]
        return self.of_factors(x, y, (a * b, *_total(terms)), UNIT + LOSS)

    def quotient(self, x: Expansion, y: Expansion) -> Expansion:
        """x/y. The low part of a constant y counts as loss if it is below 0.4 u of y, as the 0.35 u of π."""
        (a, *low), (b, *more) = x.parts, y.parts
        high, loss = a / b, UNIT + LOSS
        ratio: Any = more[0] / b if more else 1.0
        if not isinstance(ratio, Formula) and abs(ratio) < NEARLY:
            more, loss = [], loss + abs(ratio)
        terms = low + [-1.0 * part * high for part in more]
        return self.of_factors(x, y, (high, *(part / b for part in _total(terms))), loss)

    def root_of(self, x: Parts) -> Parts:
        return self.normal(super().root_of(x))


QUICK, ROUNDED = Quick(), Rounded()


def _total(terms: list[Any]) -> list[Any]:
    """The sum of one or two terms, if there are any."""
    return [terms[0] + terms[1]] if len(terms) == 2 else terms


def _whole(x: Parts) -> Any:
    """The double that a number rounds to."""
    return x[0] if len(x) == 1 else x[0] + x[1]


def _halves(x: Parts) -> tuple[Any, Any]:
    """Two columns, head and tail, that add up to x; the head has 26 bits."""
    high, *low = x
    head = head_of(high)
    if head is high:  # as quotients and roots have it
        return head, *low
    return head, _less((high - head, *low))


def _less(x: Parts, *products: Term) -> Any:
    """x minus a product, which comes in one or two parts, rounded to a double."""
    rest = x[0]
    for product in products:
        rest = rest - product
    return rest + x[1] if len(x) == 2 else rest
