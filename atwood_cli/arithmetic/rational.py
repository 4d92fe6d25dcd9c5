"""Exact fractions, which every input is: what stays rational is computed in them."""

from collections.abc import Callable
from fractions import Fraction
from math import isqrt


class Irrational(ArithmeticError):
    """The quantity leaves the rational numbers: compute it in enclosures."""


class Rationals:
    """Exact fractions; whatever would leave them raises `Irrational`."""

    def number(self, q: Fraction | int) -> Fraction:
        return Fraction(q) if isinstance(q, int) else q

    def is_zero(self, x: Fraction) -> bool:
        return x == 0

    @property
    def pi(self) -> Fraction:
        raise Irrational

    def expm1(self, x: Fraction) -> Fraction:
        raise Irrational

    exp = log1p = expm1

    def sqrt(self, x: Fraction) -> Fraction:
        """Square root of x >= 0, where it is rational."""
        root = Fraction(isqrt(x.numerator), isqrt(x.denominator))
        if root * root != x:
            raise Irrational
        return root

    def hypot(self, x: Fraction, y: Fraction | int) -> Fraction:
        raise Irrational

    def cos_sin(self, x: Fraction) -> tuple[Fraction, Fraction]:
        raise Irrational

    def cos_sin_of_degrees(self, x: Fraction) -> tuple[Fraction, Fraction]:
        if (x / 90).denominator > 1:
            raise Irrational
        cos, sin = ((1, 0), (0, 1), (-1, 0), (0, -1))[x // 90 % 4]
        return Fraction(cos), Fraction(sin)

    def root(self, f: Callable[[Fraction], Fraction], end: Fraction) -> Fraction:
        raise Irrational


EXACT = Rationals()
