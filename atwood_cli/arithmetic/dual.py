"""Dual numbers: automatic differentiation over any other arithmetic.

A `Dual` is value + slope·ε with an infinitesimal ε > 0. One input is given the slope 1; the slope of a
result is then its derivative with respect to that input. Nothing is approximated: over fractions the slope
is a fraction, over enclosures an enclosure of the true one.

Duals of fractions are ordered, so they can be the inputs themselves: 1 + ε is above 1 and below every
greater fraction. Decisions about them (which mass is heavier, whether the pulley has any mass) are those of
a scene one infinitesimal step away, and the slopes are one-sided derivatives to that side.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import TYPE_CHECKING, Any, Generic

from .lazy import lazy
from .protocol import N

if TYPE_CHECKING:
    from .protocol import Arithmetic


class Dual(Generic[N]):
    """value + slope·ε; the slope is None where the value does not depend on the input."""

    __slots__ = ("slope", "value")

    def __init__(self, value: N, slope: N | None = None) -> None:
        self.value, self.slope = value, slope

    def __add__(self, other: Dual[N] | Any) -> Dual[N]:
        other = _dual(other)
        return Dual(self.value + other.value, _sum(self.slope, other.slope))

    __radd__ = __add__

    def __sub__(self, other: Dual[N] | Any) -> Dual[N]:
        other = _dual(other)
        return Dual(self.value - other.value, _difference(self.slope, other.slope))

    def __rsub__(self, other: Any) -> Dual[N]:
        return _dual(other) - self

    def __mul__(self, other: Dual[N] | Any) -> Dual[N]:
        other = _dual(other)
        slope = _sum(_times(other.value, self.slope), _times(self.value, other.slope))
        return Dual(self.value * other.value, slope)

    __rmul__ = __mul__

    def __truediv__(self, other: Dual[N] | Any) -> Dual[N]:
        other = _dual(other)
        quotient = self.value / other.value
        if self.slope is other.slope is None:
            return Dual(quotient)
        return Dual(quotient, _difference(self.slope, _times(quotient, other.slope)) / other.value)

    def __rtruediv__(self, other: Any) -> Dual[N]:
        return _dual(other) / self

    # Of fractions only

    def __mod__(self: Dual[Fraction], other: int) -> Dual[Fraction]:
        return Dual(self.value % other, self.slope)

    @property
    def _place(self) -> tuple[Any, Any]:
        return self.value, self.slope or 0

    def __eq__(self, other: object) -> bool:
        return self._place == _dual(other)._place

    def __lt__(self, other: Dual[N] | Any) -> bool:
        return self._place < _dual(other)._place

    def __gt__(self, other: Dual[N] | Any) -> bool:
        return self._place > _dual(other)._place

    def __bool__(self) -> bool:
        return any(self._place)

    @property
    def numerator(self: Dual[Fraction]) -> int:
        """The value's, so that an arithmetic without slopes takes the dual for its value."""
        return self.value.numerator

    @property
    def denominator(self: Dual[Fraction]) -> int:
        return self.value.denominator


def _dual(x: Any) -> Dual[Any]:
    return x if isinstance(x, Dual) else Dual(x)


def _sum(one: Any, other: Any) -> Any:
    """A sum of slopes."""
    if one is None or other is None:
        return other if one is None else one
    return one + other


def _difference(one: Any, other: Any) -> Any:
    """A difference of slopes."""
    if one is None or other is None:
        return _times(-1, other) if one is None else one
    return one - other


def _times(factor: Any, slope: Any) -> Any:
    return None if slope is None else factor * slope


class Duals(Generic[N]):
    """The arithmetic of duals over another one, ``base``."""

    def __init__(self, base: Arithmetic[N]) -> None:
        self.base = base

    def number(self, q: Fraction | int | Dual[Fraction]) -> Dual[N]:
        if isinstance(q, Dual):
            return Dual(self.base.number(q.value), None if q.slope is None else self.base.number(q.slope))
        return Dual(self.base.number(q))

    def is_zero(self, x: Dual[N]) -> bool:
        """Whether both the value and its slope are 0."""
        return self.base.is_zero(x.value) and (x.slope is None or self.base.is_zero(x.slope))

    @lazy
    def pi(self) -> Dual[N]:
        return Dual(self.base.pi)

    def exp(self, x: Dual[N]) -> Dual[N]:
        value = self.base.exp(x.value)
        return Dual(value, _times(value, x.slope))

    def expm1(self, x: Dual[N]) -> Dual[N]:
        value = self.base.expm1(x.value)
        return Dual(value, None if x.slope is None else (value + 1) * x.slope)

    def log1p(self, x: Dual[N]) -> Dual[N]:
        return Dual(self.base.log1p(x.value), None if x.slope is None else x.slope / (x.value + 1))

    def sqrt(self, x: Dual[N]) -> Dual[N]:
        value = self.base.sqrt(x.value)
        return Dual(value, None if x.slope is None else x.slope / (2 * value))

    def hypot(self, x: Dual[N], y: Dual[N] | int) -> Dual[N]:
        """√(x² + y²). Where that is 0, its slope is the length of the slopes of x and y."""
        y = y if isinstance(y, Dual) else self.number(y)
        value, half_slope = self.base.hypot(x.value, y.value), (x * x + y * y).slope
        if half_slope is None:
            return Dual(value)
        if self.base.is_zero(value):
            zero = self.base.number(0)
            return Dual(value, self.base.hypot(*(zero if z.slope is None else z.slope for z in (x, y))))
        return Dual(value, half_slope / (2 * value))

    def cos_sin(self, x: Dual[N]) -> tuple[Dual[N], Dual[N]]:
        return self._turning(*self.base.cos_sin(x.value), x.slope)

    def cos_sin_of_degrees(self, x: Fraction | Dual[Fraction]) -> tuple[Dual[N], Dual[N]]:
        if not isinstance(x, Dual):
            return self._turning(*self.base.cos_sin_of_degrees(x), None)
        rate = None if x.slope is None else self.base.pi * self.base.number(x.slope / 180)
        return self._turning(*self.base.cos_sin_of_degrees(x.value), rate)

    def _turning(self, cos: N, sin: N, rate: N | None) -> tuple[Dual[N], Dual[N]]:
        """The duals of cosine and sine of an angle whose slope is ``rate``, in radians."""
        return Dual(cos, _times(-1 * sin, rate)), Dual(sin, _times(cos, rate))

    def root(self, f: Callable[[Dual[N]], Dual[N]], end: Dual[N]) -> Dual[N]:
        """The root of f between 0 and ``end``; its slope keeps f at 0."""
        nowhere = self.base.is_zero(end.value)
        value = end.value if nowhere else self.base.root(lambda s: f(Dual(s)).value, end.value)
        alone = f(Dual(value)).slope
        along = f(Dual(value, self.base.number(1))).slope
        return Dual(value, None if alone is None else -1 * alone / _difference(along, alone))
