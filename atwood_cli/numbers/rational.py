"""What equations need of a number and of its arithmetic; and exact fractions, as which inputs are read.

The protocols exist only for the type checker, as creating them would slow every start of the program.
Modules that name them in annotations leave those unevaluated (`from __future__ import annotations`).
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from math import isqrt
from typing import TYPE_CHECKING, Any, TypeVar, cast

N = TypeVar("N", bound="Field")

if TYPE_CHECKING:
    from typing import Protocol, Self

    class Field(Protocol):
        """A number with + - * and /. Ints may stand on either side, but not before a minus."""

        def __add__(self, other: Any, /) -> Self: ...
        def __radd__(self, other: Any, /) -> Self: ...
        def __sub__(self, other: Any, /) -> Self: ...
        def __mul__(self, other: Any, /) -> Self: ...
        def __rmul__(self, other: Any, /) -> Self: ...
        def __truediv__(self, other: Any, /) -> Self: ...
        def __rtruediv__(self, other: Any, /) -> Self: ...

    class Arithmetic(Protocol[N]):
        """A number type with its transcendental functions; angles are in radians unless named degrees."""

        def number(self, q: Fraction | int) -> N: ...
        def is_zero(self, x: N) -> bool: ...
        def taken_as_not_negative(self, x: N) -> N:
            """Return x, of which the equations say that it is not negative; that saves work in columns."""
            ...

        @property
        def pi(self) -> N: ...
        def expm1(self, x: N) -> N: ...
        def log1p(self, x: N) -> N: ...
        def sqrt(self, x: N) -> N: ...
        def cos_sin(self, x: N) -> tuple[N, N]: ...
        def cos_sin_of_degrees(self, x: Fraction) -> tuple[N, N]: ...
        def root(self, f: Callable[[N], N], end: N) -> N: ...

    class Quantity(Protocol):
        """A number that can be computed in any arithmetic."""

        def __call__(self, arithmetic: Arithmetic[N], /) -> N: ...


class Irrational(ArithmeticError):
    """The result of an operation is not rational: compute in enclosures, or in floating point."""


class OfFloat(Fraction):
    """The exact value of a float, which is shown as the float: 0.3, without the 54 digits that it has."""

    __slots__ = ()

    def __repr__(self) -> str:
        return repr(Fraction(self))


class Rationals:
    """The arithmetic of exact fractions. An operation whose result may not be one raises `Irrational`."""

    def number(self, q: Fraction | int) -> Fraction:
        return Fraction(q) if isinstance(q, int) else q

    def is_zero(self, x: Fraction) -> bool:
        return x == 0

    def taken_as_not_negative(self, x: Fraction) -> Fraction:
        return x

    def sqrt(self, x: Fraction) -> Fraction:
        """Return the square root of x >= 0, if it is rational."""
        root = Fraction(isqrt(x.numerator), isqrt(x.denominator))
        if root * root != x:
            raise Irrational
        return root

    def cos_sin_of_degrees(self, x: Fraction) -> tuple[Fraction, Fraction]:
        if (x / 90).denominator > 1:
            raise Irrational
        cos, sin = ((1, 0), (0, 1), (-1, 0), (0, -1))[x // 90 % 4]
        return Fraction(cos), Fraction(sin)

    def _irrational(self, *_: Any) -> Any:
        raise Irrational

    expm1 = log1p = cos_sin = root = _irrational
    pi = property(_irrational)


EXACT: Arithmetic[Fraction] = cast(Any, Rationals())
