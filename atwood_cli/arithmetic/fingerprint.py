"""Fingerprints of results: one that is made of the same numbers in the same way is the same number.

Enclosures that are ever narrower never show that two numbers are equal. Fingerprints do: nothing is computed,
and each operation gives a hash of itself and of what it is done to.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any


class Fingerprint:
    """The hash of an operation and of its operands."""

    __slots__ = ("hash",)

    def __init__(self, *made_of: Any) -> None:
        self.hash = hash(made_of)

    def __hash__(self) -> int:
        return self.hash

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Fingerprint) and self.hash == other.hash

    def __add__(self, other: Any) -> Fingerprint:
        return other if self == ZERO else self if other == ZERO else Fingerprint("+", self, other)

    def __sub__(self, other: Any) -> Fingerprint:
        return self if other == ZERO else Fingerprint("-", self, other)

    def __mul__(self, other: Any) -> Fingerprint:
        return ZERO if ZERO in (self, other) else Fingerprint("*", self, other)

    def __truediv__(self, other: Any) -> Fingerprint:
        return self if self == ZERO else Fingerprint("/", self, other)

    def __rtruediv__(self, other: Any) -> Fingerprint:
        return Fingerprint("/", other, self)

    __radd__, __rmul__ = __add__, __mul__


ZERO = Fingerprint("number", 0)
"""A limit leaves terms out, such as those of c and b where the pulley stands."""


def _made_by(function: str) -> Callable[..., Fingerprint]:
    return lambda _, *operands: Fingerprint(function, *operands)


class Fingerprints:
    """The arithmetic of fingerprints."""

    pi = Fingerprint("pi")
    exp, expm1, log1p, sqrt, hypot = map(_made_by, ("exp", "expm1", "log1p", "sqrt", "hypot"))

    def number(self, q: Fraction | int) -> Fingerprint:
        return Fingerprint("number", q)

    def is_zero(self, x: Fingerprint) -> bool:
        return x == ZERO

    def not_negative(self, x: Fingerprint) -> Fingerprint:
        return x

    def cos_sin(self, x: Any) -> tuple[Fingerprint, Fingerprint]:
        return Fingerprint("cos", x), Fingerprint("sin", x)

    cos_sin_of_degrees = cos_sin

    def root(self, f: Callable[[Fingerprint], Fingerprint], end: Fingerprint) -> Fingerprint:
        return Fingerprint("root", f(Fingerprint("x")), end)


FINGERPRINTS = Fingerprints()
