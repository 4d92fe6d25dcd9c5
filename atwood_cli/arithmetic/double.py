"""The arithmetic of doubles, in NumPy: single numbers or columns, a row a scene."""

from collections.abc import Callable
from fractions import Fraction
from functools import cache
from math import pi
from typing import Any

import numpy as np

from .error_free import Column
from .interval import enclosures
from .rational import EXACT, Irrational

ENOUGH = enclosures(80)
"""The arithmetic that constants and tables are computed in, once, before they are rounded."""


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
            cos, sin = precise_cos_sin(x)
            return float(cos), float(sin)
        folded, turn = fold(x)
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


def fold(degrees: Column) -> tuple[Column, Callable[[Any, Any], tuple[Any, Any]]]:
    """The angle less its quarter turns, exactly, and what they do to its cosine and sine."""
    degrees = np.fmod(degrees, 360.0)
    quarters = np.rint(degrees / 90)
    which = quarters.astype(np.int64) % 4

    def turn(cos: Any, sin: Any) -> tuple[Any, Any]:
        return np.choose(which, [cos, -sin, -cos, sin]), np.choose(which, [sin, cos, -sin, -cos])

    return degrees - 90 * quarters, turn


@cache
def precise_cos_sin(degrees: Fraction) -> tuple[Fraction, Fraction]:
    """Cosine and sine to 70 digits, more than twice those of a double-double; exact where rational."""
    try:
        return EXACT.cos_sin_of_degrees(degrees)
    except Irrational:
        cos, sin = ENOUGH.cos_sin_of_degrees(degrees % 360)
        return Fraction(cos.lo), Fraction(sin.lo)
