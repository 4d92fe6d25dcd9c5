"""Fingerprints of results: where these are the same for some inputs, so are the results.

Enclosures that are ever narrower never show that two numbers are equal. Fingerprints do, but for a chance of
one in 10^18. They are numbers modulo a large prime, as Python's hashes of fractions are, and a function's
value is a hash of its arguments.
"""

from __future__ import annotations

import operator
import sys
from collections.abc import Callable
from fractions import Fraction
from typing import Any

PRIME = sys.hash_info.modulus


def _modulo_prime(operation: Callable[[int, int], int]) -> Any:
    return lambda x, y: Fingerprint(operation(int(x), int(y)) % PRIME)


class Fingerprint(int):
    """A number modulo the prime. A quotient by 0 is 0."""

    __add__ = __radd__ = _modulo_prime(operator.add)
    __sub__ = _modulo_prime(operator.sub)
    __mul__ = __rmul__ = _modulo_prime(operator.mul)
    __truediv__ = _modulo_prime(lambda x, y: x * pow(y, -1, PRIME) if y else 0)
    __rtruediv__ = _modulo_prime(lambda x, y: y * pow(x, -1, PRIME) if x else 0)


def _hashed(*made_of: object) -> Fingerprint:
    return Fingerprint(hash(made_of) % PRIME)


def _function(name: str) -> Callable[..., Fingerprint]:
    return lambda _, *arguments: _hashed(name, *arguments)


class Fingerprints:
    """The arithmetic of fingerprints."""

    pi = _hashed("pi")
    exp, expm1, log1p, sqrt, hypot = map(_function, ("exp", "expm1", "log1p", "sqrt", "hypot"))

    def number(self, q: Fraction | int) -> Fingerprint:
        return Fingerprint(hash(q) % PRIME)

    def is_zero(self, x: Fingerprint) -> bool:
        return x == 0

    def not_negative(self, x: Fingerprint) -> Fingerprint:
        return x

    def cos_sin(self, x: Any) -> tuple[Fingerprint, Fingerprint]:
        return _hashed("cos", x), _hashed("sin", x)

    cos_sin_of_degrees = cos_sin

    def root(self, f: Callable[[Fingerprint], Fingerprint], end: Fingerprint) -> Fingerprint:
        return _hashed("root", f(_hashed("x")), end)


FINGERPRINTS = Fingerprints()
