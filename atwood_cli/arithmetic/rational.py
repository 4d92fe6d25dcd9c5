"""Exact fractions. Every input is one, and every quantity that is rational is computed in them."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from math import isqrt


class Irrational(ArithmeticError):
    """An operation leaves the rational numbers: compute in enclosures, or in floating point."""


class OfFloat(Fraction):
    """The exact value of a float, which texts show as the float: 0.3, without the 54 digits that it has."""

    __slots__ = ()

    def __repr__(self) -> str:
        return repr(Fraction(self))


class Rationals:
    """The arithmetic of exact fractions; an operation that may leave them raises `Irrational`."""

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
        return self.sqrt(x * x + y * y)

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
