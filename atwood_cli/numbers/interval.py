"""Interval arithmetic in decimals: enclosures lo <= value <= hi, which certainly contain the true value.

Sums, products and quotients round lo down and hi up, which the standard library's `decimal` does correctly on
every platform. So the true value always lies in the enclosure; cancellation only makes it wider. `settling`
takes the digits from enclosures.

Each function derives its own error bound. Constants and series are summed in integers, in units of 2^-w. A
function is evaluated only at the lower end of its argument. Over an argument's width δ <= 1, ln(1 + y),
cosine and sine change by at most δ, and e^x by at most 2δ e^x.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from decimal import ROUND_CEILING, ROUND_FLOOR, ROUND_HALF_EVEN, Context, Decimal
from fractions import Fraction
from functools import lru_cache

from .lazy import lazy
from .rational import EXACT, Irrational

# Far beyond any input (1e±1500), far within what `decimal` takes on a 32-bit machine.
LARGEST_EXPONENT = 10**8
LARGEST_ARGUMENT = LARGEST_EXPONENT * 2_302_585_092 // 10**9  # of an exponential: times ln 10
ZERO, TWO, INFINITY = Decimal(0), Decimal(2), Decimal("inf")
VALUES_KEPT = 256  # values of a function: quantities ask for the same ones
DOUBLE_EXPONENT = 300  # the largest exponent of a number that is taken for a double
LOG10_E = Decimal("0.434294481903")  # rounded down, so that the rest of an argument is not negative


class NeedsMoreDigits(ArithmeticError):
    """The enclosure is too wide to go on: compute with more digits, with so many if the number is known."""


def decimal_context(digits: int, rounding: str) -> Context:
    """Return a context that does not depend on the caller's, with an ample range of exponents."""
    limit = 2 * LARGEST_EXPONENT
    return Context(prec=digits, rounding=rounding, Emin=-limit, Emax=limit, traps=[])


class Enclosure:
    """A pair lo <= value <= hi of decimals, with arithmetic that keeps it so."""

    __slots__ = ("arithmetic", "hi", "lo")

    def __init__(self, arithmetic: Enclosures, lo: Decimal, hi: Decimal) -> None:
        self.arithmetic, self.lo, self.hi = arithmetic, lo, hi

    def _lift(self, other: Enclosure | int) -> Enclosure:
        return other if isinstance(other, Enclosure) else self.arithmetic.number(other)

    def __add__(self, other: Enclosure | int) -> Enclosure:
        other, ar = self._lift(other), self.arithmetic
        return Enclosure(ar, ar.down.add(self.lo, other.lo), ar.up.add(self.hi, other.hi))

    __radd__ = __add__

    def __sub__(self, other: Enclosure | int) -> Enclosure:
        other, ar = self._lift(other), self.arithmetic
        return Enclosure(ar, ar.down.subtract(self.lo, other.hi), ar.up.subtract(self.hi, other.lo))

    def __mul__(self, other: Enclosure | int) -> Enclosure:
        other, ar = self._lift(other), self.arithmetic
        if self.lo >= ZERO and other.lo >= ZERO:
            return Enclosure(ar, ar.down.multiply(self.lo, other.lo), ar.up.multiply(self.hi, other.hi))
        x, y = (other, self) if self.lo < 0 < self.hi else (self, other)
        if x.lo >= 0:
            lo = ar.down.multiply(x.lo if y.lo >= 0 else x.hi, y.lo)
            hi = ar.up.multiply(x.hi if y.hi >= 0 else x.lo, y.hi)
        elif x.hi <= 0:
            lo = ar.down.multiply(x.lo if y.hi >= 0 else x.hi, y.hi)
            hi = ar.up.multiply(x.hi if y.lo >= 0 else x.lo, y.lo)
        else:
            lo = min(ar.down.multiply(x.lo, y.hi), ar.down.multiply(x.hi, y.lo))
            hi = max(ar.up.multiply(x.lo, y.lo), ar.up.multiply(x.hi, y.hi))
        return Enclosure(ar, lo, hi)

    __rmul__ = __mul__

    def __truediv__(self, other: Enclosure | int) -> Enclosure:
        """Return the quotient by a positive number, as every denominator of the equations is.

        Raises NeedsMoreDigits for a denominator that may be zero, ZeroDivisionError for one that is.
        Raises OverflowError for one beyond 10^LARGEST_EXPONENT, which is infinity: a quotient would be 0.
        """
        other, ar = self._lift(other), self.arithmetic
        if other.lo == INFINITY:
            raise OverflowError(f"a denominator is beyond 10^{LARGEST_EXPONENT}")
        if other.lo <= ZERO:
            raise ZeroDivisionError if other.hi == 0 == other.lo else NeedsMoreDigits
        lo = ar.down.divide(self.lo, other.hi if self.lo >= ZERO else other.lo)
        return Enclosure(ar, lo, ar.up.divide(self.hi, other.lo if self.hi >= ZERO else other.hi))

    def __rtruediv__(self, other: int) -> Enclosure:
        return self._lift(other) / self


class Enclosures:
    """Enclosures of about ``digits`` significant digits."""

    def __init__(self, digits: int) -> None:
        self.digits = digits
        self.down, self.up = decimal_context(digits, ROUND_FLOOR), decimal_context(digits, ROUND_CEILING)

    def number(self, q: Fraction | int) -> Enclosure:
        return _quotient(self, q.numerator, q.denominator)

    def is_zero(self, x: Enclosure) -> bool:
        return x.lo == x.hi == 0

    def taken_as_not_negative(self, x: Enclosure) -> Enclosure:
        return x

    def _fixed(self, value: int, error: int, bits: int) -> Enclosure:
        """Return the enclosure value ± error, both in units of 2^-bits."""
        unit = Decimal(1 << bits)
        lo, hi = Decimal(value - error), Decimal(value + error)
        return Enclosure(self, self.down.divide(lo, unit), self.up.divide(hi, unit))

    def _from_zero(self, x: Enclosure) -> Enclosure:
        """Return the enclosure without its part below 0, for a value that is known not to be negative."""
        return x if x.lo >= 0 else Enclosure(self, ZERO, x.hi)

    def _width(self, x: Enclosure) -> Enclosure:
        """Return the enclosure of how far a value in x can be above its lower end."""
        return Enclosure(self, ZERO, self.up.subtract(x.hi, x.lo))

    @lazy
    def pi(self) -> Enclosure:
        bits = _bits(self.digits)
        return self._fixed(_constant(PI, bits), 2, bits)

    def sqrt(self, x: Enclosure) -> Enclosure:
        """Return the square root of x >= 0, exact if it is a decimal of so many digits.

        `decimal` rounds the root correctly, so one step outwards encloses it. The square of an end shows
        whether the step is needed.
        """
        x = self._from_zero(x)
        lo, hi = self.down.sqrt(x.lo), self.up.sqrt(x.hi)
        lo = lo if self.up.multiply(lo, lo) <= x.lo else self.down.next_minus(lo)
        return Enclosure(self, lo, hi if self.down.multiply(hi, hi) >= x.hi else self.up.next_plus(hi))

    def cos_sin(self, x: Enclosure) -> tuple[Enclosure, Enclosure]:
        """Return cosine and sine of x >= 0."""
        x = self._from_zero(x)
        if self.is_zero(x):
            return self.number(1), x
        (cos, sin), slack = _cos_sin(self, x.lo), self._width(x)
        return cos + slack - slack, sin + slack - slack

    def cos_sin_of_degrees(self, x: Fraction) -> tuple[Enclosure, Enclosure]:
        """Return cosine and sine of x >= 0, exact at multiples of 90°."""
        try:
            cos, sin = EXACT.cos_sin_of_degrees(x)
        except Irrational:
            return self.cos_sin(self.pi * self.number(x / 180))
        return self.number(cos), self.number(sin)

    def root(self, f: Callable[[Enclosure], Enclosure], end: Enclosure) -> Enclosure:
        """Return the root of f between 0 and ``end``; f is negative before it and positive after.

        Secants find it, with bisection where they fail (T. J. Dekker, 1969). In the end f is checked to have
        opposite signs at both ends of the result, so the search need not be trusted.
        """

        def f_at(x: Decimal) -> Enclosure:
            return f(Enclosure(self, x, x))

        near = decimal_context(self.digits, ROUND_HALF_EVEN)
        # A root at 10^-n of the scale of f's terms takes 2n more digits.
        wanted = self.digits + 2 * max(0, -end.lo.adjusted())
        a, b = ZERO, end.lo
        f_a, f_b = f_at(a), f_at(b)
        if not f_a.hi < 0 < f_b.lo:
            raise NeedsMoreDigits(wanted)
        x, f_x, y, f_y, blur = a, f_a.hi, b, f_b.lo, self._width(f_b).hi
        slope = near.divide(near.subtract(f_y, f_x), b)
        for _ in range(8 * self.digits):
            c, rise = near.divide(near.add(a, b), TWO), near.subtract(f_y, f_x)
            if rise:
                step = near.divide(near.multiply(f_y, near.subtract(y, x)), rise)
                if step.copy_abs() < near.scaleb(y, 2 - self.digits):
                    break
                secant = near.subtract(y, step)
                c = secant if a < secant < b else c
            f_c = f_at(c)
            x, f_x, y, f_y, blur = y, f_y, c, f_c.lo, self._width(f_c).hi
            if f_c.lo <= 0 <= f_c.hi:
                break
            a, b = (c, b) if f_c.hi < 0 else (a, c)
        # The distance from y at which f, if nearly straight, has a certain sign; then larger ones.
        error = near.scaleb(near.add(near.divide(blur, slope), near.scaleb(y, -self.digits)), 1)
        while error < end.lo:
            lo, hi = self.down.subtract(y, error), self.up.add(y, error)
            if lo > 0 and f_at(lo).hi < 0 < f_at(hi).lo:
                return Enclosure(self, lo, hi)
            error = near.scaleb(error, self.digits // 8)
        raise NeedsMoreDigits(wanted)

    def expm1(self, x: Enclosure) -> Enclosure:
        """Return e^x - 1 for x >= 0; beyond 10^LARGEST_EXPONENT it is infinite."""
        x = self._from_zero(x)
        at_lo, width = _expm1(self, x.lo), self._width(x)
        if width.hi > 1 or at_lo.lo == INFINITY:
            return Enclosure(self, at_lo.lo, _expm1(self, x.hi).hi)
        return Enclosure(self, at_lo.lo, (at_lo + 2 * width * (at_lo + 1)).hi)

    def log1p(self, x: Enclosure) -> Enclosure:
        """Return ln(1 + x) for x > -1; an x that may be 0 is taken not to be negative."""
        if x.hi < 0:
            return -1 * self.log1p(-1 * x / (x + 1))
        x = self._from_zero(x)
        at_lo = _log1p(self, x.lo)
        return Enclosure(self, at_lo.lo, (at_lo + self._width(x)).hi)

    def _log1p_guess(self, y: Decimal) -> Decimal:
        """Return ln(1 + y) to about half the digits: each step of `_log1p` doubles them."""
        if self.digits > 28:
            return _log1p(enclosures(self.digits // 2 + 2), y).lo
        if -DOUBLE_EXPONENT < y.adjusted() < DOUBLE_EXPONENT:
            return Decimal.from_float(math.log1p(float(y)))
        return y if y < 1 else decimal_context(self.digits // 2 + 12, ROUND_HALF_EVEN).ln(y)


@lru_cache(maxsize=64)
def enclosures(digits: int) -> Enclosures:
    """Return the arithmetic of enclosures with so many digits; always the same object, which keeps π."""
    return Enclosures(digits)


@lru_cache(maxsize=VALUES_KEPT)
def _quotient(ar: Enclosures, n: int, d: int) -> Enclosure:
    over, under = Decimal(n), Decimal(d)
    return Enclosure(ar, ar.down.divide(over, under), ar.up.divide(over, under))


@lru_cache(maxsize=VALUES_KEPT)
def _cos_sin(ar: Enclosures, x: Decimal) -> tuple[Enclosure, Enclosure]:
    """Return cosine and sine of a number x >= 0.

    n quarter turns are taken off, which leaves an angle within ±π/4. The series are summed for this angle
    divided by 2^s, and the angle is doubled s times. 4 (w + n) units cover the error of the series, as in
    `_expm1`. A doubling squares c + is: it doubles the error and adds at most two units. So
    2^s · 8 (w + n) units cover all.
    """
    n, d = x.as_integer_ratio()
    bits = _bits(ar.digits + max(0, -x.adjusted()))
    halvings = math.isqrt(bits) // 2
    w = bits + halvings + 2 * bits.bit_length() + (n // d).bit_length() + 8
    angle, quarter = (n << w) // d, _constant(PI, w) >> 1
    turns = (angle + (quarter >> 1)) // quarter
    sums = _exponential_series((angle - turns * quarter) >> halvings, w)
    c, s = sums[0] - sums[2], sums[1] - sums[3]
    for _ in range(halvings):
        c, s = (c + s) * (c - s) >> w, c * s >> (w - 1)
    c, s = ((c, s), (-s, c), (-c, -s), (s, -c))[turns % 4]
    error = 8 * (w + turns) << halvings
    return ar._fixed(c, error, w), ar._fixed(s, error, w)


@lru_cache(maxsize=VALUES_KEPT)
def _expm1(ar: Enclosures, x: Decimal) -> Enclosure:
    """Return e^x - 1 for a number x >= 0, to the relative precision of the result.

    All is computed in integers, in units of 2^-w. x - n ln 10 is in [0, 2.4), off by at most 2n + 2
    units. It is divided by 2^s, which gives r, and e^r - 1 = r + r²/2 + ... is summed. Then s doublings
    follow, each by e^{2r} - 1 = u (2 + u) with u = e^r - 1. A term inherits at most its predecessor's
    error and is truncated twice by less than one unit, so t terms are off by at most 3t units. A doubling
    multiplies the error by 2 (1 + u) and adds at most one unit; the product of the factors is 2^s e^{2.4}
    < 12 · 2^s. So the result is off by fewer than 12 · 2^s (3t + s + 2n + 4) units, less than 2^(s + 8)
    (w + n), as t and s are below w.
    """
    if x == 0:
        return Enclosure(ar, ZERO, ZERO)
    if x > LARGEST_ARGUMENT:
        return Enclosure(ar, INFINITY, INFINITY)
    tens = int(ar.down.multiply(x, LOG10_E)) if x > 2 else 0
    bits = _bits(ar.digits + max(0, -x.adjusted()))
    halvings = math.isqrt(bits)
    w = bits + halvings + 2 * bits.bit_length() + tens.bit_length() + 8
    n, d = x.as_integer_ratio()
    rest = (n << w) // d - (tens * _constant(LN10, w) if tens else 0)
    u = sum(_exponential_series(rest >> halvings, w)) - (1 << w)
    for _ in range(halvings):
        u = u * ((2 << w) + u) >> w
    small = ar._fixed(u, (w + tens) << (halvings + 8), w)
    if not tens:
        return small
    k = small + 1
    return Enclosure(ar, ar.down.scaleb(k.lo, tens), ar.up.scaleb(k.hi, tens)) - 1


@lru_cache(maxsize=VALUES_KEPT)
def _log1p(ar: Enclosures, y: Decimal) -> Enclosure:
    """Return ln(1 + y) for a number y >= 0, from a guess y0, with no series.

    ln(1 + y) = y0 + ln(1 + δ) with δ = (1 + y)/e^{y0} - 1, and δ/(1 + δ) <= ln(1 + δ) <= δ for δ > -1.
    That encloses the value for any guess, and tightly for a good one.
    """
    if y == 0:
        return Enclosure(ar, ZERO, ZERO)
    guess = ar._log1p_guess(y)
    at_guess, exactly = _expm1(ar, guess), Enclosure(ar, y, y)
    delta = (exactly - at_guess) / (at_guess + 1)
    inner = delta / (delta + 1)
    middle = Enclosure(ar, guess, guess)
    return Enclosure(ar, (middle + inner).lo, (middle + delta).hi)


def _bits(digits: int) -> int:
    """Return the number of bits for so many digits, and a few more."""
    return digits * 10 // 3 + 8


def _exponential_series(r: int, w: int) -> list[int]:
    """Return the terms r^n/n! added up for n = 0, 1, 2 and 3 modulo 4; all in units of 2^-w."""
    sums, term, n = [0, 0, 0, 0], 1 << w, 0
    while term:
        sums[n % 4] += term
        n += 1
        term = (term * r >> w) // n
    return sums


def _inverse(q: int, sign: int, w: int) -> int:
    """Return atan(1/q) for sign -1, atanh(1/q) for sign 1, in units of 2^-w."""
    power = (1 << w) // q
    total, n = power, 1
    while power:
        power //= q * q
        n += 2
        total += power // n if sign > 0 or n % 4 == 1 else -(power // n)
    return total


PI = ((16, 5, -1), (-4, 239, -1))
"""π as terms of `_constant` (J. Machin, 1706)."""
LN10 = ((46, 31, 1), (34, 49, 1), (20, 161, 1))
"""ln 10: 10 = (32/30)^23 (50/48)^17 (162/160)^10."""
GUARD_BITS = 40
LEAST_BITS = 256


def _constant(terms: tuple[tuple[int, int, int], ...], bits: int) -> int:
    """Return the sum of factor · `_inverse`(q, sign) for terms (factor, q, sign), to two units of 2^-bits.

    It is kept with a power of two of bits, so that precisions share it. The series have fewer than w terms,
    each truncated by less than two units of 2^-w, and the factors add up to at most 100. The 40 extra bits
    (`GUARD_BITS`) absorb that up to w = 2^32.
    """
    wide = GUARD_BITS + (1 << max(LEAST_BITS, bits).bit_length())
    return _wide_constant(terms, wide) >> (wide - bits)


@lru_cache
def _wide_constant(terms: tuple[tuple[int, int, int], ...], w: int) -> int:
    return sum(factor * _inverse(q, sign, w) for factor, q, sign in terms)
