"""A user's script. It runs, and mypy, which checks the whole tree, must know of each result what it is."""

from collections.abc import Mapping
from contextlib import suppress
from decimal import Decimal
from fractions import Fraction
from typing import Any, Literal, assert_type

import numpy as np

from atwood_cli import REGIMES, STATUSES, Fit, Solution, fit, solve, solve_arrays


def of_a_form(a: str | None, digits: int | None) -> Solution[float] | Solution[Decimal]:
    return solve(m1=1, m2="3", a=a, M=None, digits=digits)


plain = solve(m1="250g", m2=np.int64(3), M=np.float32(10), mu=Fraction(1, 3), g=Decimal(10))
assert_type(plain, Solution[float])
assert_type(plain.acceleration, float | None)
assert_type(plain.uncertainty, Mapping[str, float | None])
assert_type(solve(1, 3, mu=None, digits=20), Solution[Decimal])

found = solve(m1=1, m2=3, a="1.0(1)")
assert_type(found, Solution[float])
assert_type(found.pulley_mass, float | None)
assert_type(solve(m1=1, m2=3, a=1, digits=9).moment_of_inertia, Decimal | None)
assert_type(solve(m1=1, m2=3, drop="1m", time=2, digits="20").fall_time, Decimal | None)
assert_type(solve(m1=1, m2=3, M=10, a=None, drop=1, time=None), Solution[float])

numbers: dict[str, float] = {"m1": 1.0, "m2": 3.0, "M": 10.0}
texts: dict[str, str | None] = {"m1": "250g", "m2": "3", "mu": None}
assert_type(solve(**numbers).regime, Literal["no-slip", "verge", "slip"] | None)
assert_type(solve(**texts).uncertainty, Mapping[str, Any | None])
with suppress(TypeError):
    solve(m1=1, m2=3, mas=10)  # type: ignore[call-overload]

arrays = solve_arrays(1, [3, 4], M=[10.0, None], mu=np.array([1, 2]), g=np.float64(10))
assert_type(REGIMES[int(arrays["regime"][0])], Literal["no-slip", "verge", "slip"])
assert_type([STATUSES[int(code)] for code in arrays["status"]], list[str])

runs: dict[str, list[Any]] = {"m1 (g)": [55, 60, 65], "m2 (g)": [60, 65, 70], "a": [0.380, 0.354, None]}
assert_type(fit(runs, find=["rim_mass"], axle=0), Fit)

print(of_a_form("1.5", None).regime, plain.notes, found.pulley_mass, arrays["status"])
