"""Whether rational formulas of columns are certain numbers: they are worked out modulo primes.

Two rational numbers made of a few doubles differ by a fraction whose numerator has some thousand bits, and so
fewer than a hundred of the 50 million primes of 31 bits as factors. If they are the same modulo six of those
(`PRIMES`) they are the same, but for a chance below 10^-34. So what is half-way between two doubles is told
from what is only near it. (For one scene `residue` does that, with transcendental numbers too.)
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .symbolic import Formula
from .tables import Column

PRIMES = np.array(
    [[p] for p in (1555813163, 2139108259, 1465621397, 1712263937, 1919315581, 1466748197)], np.int64
)
"""From 2^30 to 2^31, so that products have room; drawn at random."""
LEAST, MOST = -1130, 1030
"""Powers of two of which doubles are multiples by whole numbers."""

Residues = NDArray[np.int64]


class Irrational(ArithmeticError):
    """The formula has other operations than + - * and /."""


def residues(column: Column) -> Residues:
    """Doubles modulo the primes, a row a prime."""
    mantissas, exponents = np.frexp(column)
    whole = (mantissas * 2.0**53).astype(np.int64)
    return whole % PRIMES * _powers_of_two()[:, exponents - 53 - LEAST] % PRIMES


def is_sum(
    formula: Formula, inputs: Mapping[str, Residues], first: Column, second: Column
) -> NDArray[np.bool_]:
    """In which rows a formula is the sum of two doubles. Raises Irrational."""
    difference = _worked_out(formula, inputs) - residues(first) - residues(second)
    zero: NDArray[np.bool_] = (difference % PRIMES == 0).all(axis=0)
    return zero


def _worked_out(formula: Formula, inputs: Mapping[str, Residues]) -> Residues:
    if formula.op == "symbol":
        return inputs[formula.parts[0]]
    if formula.op == "number":
        return residues(np.array([float(formula.parts[0])]))
    if formula.op not in ("+", "-", "*", "/"):
        raise Irrational
    x, y = (_worked_out(part, inputs) for part in formula.parts)
    match formula.op:
        case "+":
            return (x + y) % PRIMES
        case "-":
            return (x - y) % PRIMES
        case "*":
            return x * y % PRIMES
    return x * _inverse(y) % PRIMES


def _inverse(x: Residues) -> Residues:
    """1/x, which is x^(p - 2); of 0 it is 0."""
    result, power = np.ones_like(x), x
    for bit in range(31):
        result = np.where((PRIMES - 2) >> bit & 1, result * power % PRIMES, result)
        power = power * power % PRIMES
    return result


@cache
def _powers_of_two() -> Residues:
    rows: list[list[int]] = [[pow(2, e, p) for e in range(LEAST, MOST)] for p in PRIMES[:, 0].tolist()]
    return np.array(rows, np.int64)


def tie(first: Column, second: Column) -> tuple[Any, Any]:
    """The number half-way between two doubles that first + second seems to be, in two parts; and where."""
    half = np.copysign(np.spacing(np.abs(first)) / 2, second)
    return half, np.abs(second - half) < np.abs(half) * NEAR


NEAR = 2.0**-40
