"""An angle of wrap, exact, in any arithmetic."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

from ..arithmetic.settling import is_positive

if TYPE_CHECKING:
    from ..arithmetic.rational import Arithmetic, N


class Angle:
    """A number of degrees, or of radians: kept as it was given, since no rational angle is both.

    ``number`` is a Fraction; in arrays, a column of degrees. An angle in degrees equals its number.
    """

    __slots__ = ("number", "unit")

    def __init__(self, number: Any, unit: Literal["°", "rad"] = "°") -> None:
        self.number, self.unit = number, unit

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Angle):
            return bool((self.number, self.unit) == (other.number, other.unit))
        return bool(self.unit == "°" and self.number == other)

    def __hash__(self) -> int:
        return hash(self.number if self.unit == "°" else (self.number, self.unit))

    def __repr__(self) -> str:
        return f"Angle({self.number!r}, {self.unit!r})"

    def radians(self, ar: Arithmetic[N]) -> N:
        """The angle in radians."""
        if self.unit == "rad":
            return ar.number(self.number)
        return ar.pi * ar.number(self.number / 180)

    def degrees(self, ar: Arithmetic[N], share: Any = 1) -> N:
        """A share of the angle in degrees; none of it is exactly 0."""
        number = ar.number(share * self.number)
        return number * 180 / ar.pi if self.unit == "rad" and share else number

    def cos_sin(self, ar: Arithmetic[N], parts: int = 1) -> tuple[N, N]:
        """Cosine and sine of an equal part of the angle; exact at multiples of 90°."""
        if self.unit == "rad":
            return ar.cos_sin(ar.number(self.number) / parts)
        return ar.cos_sin_of_degrees(self.number / parts)

    @property
    def is_half_turn(self) -> bool:
        return self == 180

    @property
    def is_beyond_half_turn(self) -> bool:
        if self.unit == "°":
            return bool(self.number > 180)
        return is_positive(lambda ar: self.radians(ar) - ar.pi)

    @property
    def ends_hang_down(self) -> bool:
        """Whether both ends of the string leave the pulley downwards: half a turn, and whole turns more."""
        return bool(self.unit == "°" and (self.number - 180) % 360 == 0)
