"""Values that are rational though their formulas are not: they are rounded as what they are."""

from collections.abc import Callable
from decimal import ROUND_HALF_EVEN, Context, Decimal
from fractions import Fraction
from math import inf
from typing import Any

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from atwood_cli import solve, solve_arrays
from atwood_cli.explain.contact import contact
from atwood_cli.numbers.digits import to_digits
from atwood_cli.numbers.settling import settle
from atwood_cli.reading.scenes import read_answers
from atwood_cli.solver.answers import Answers

from .tools.scenes import read_scene

F = Fraction


def degrees(ar: Any, x: int) -> tuple[Any, Any]:
    cos, sin = ar.cos_sin_of_degrees(F(x))
    return cos, sin


def root(ar: Any, q: Fraction, share: Fraction) -> Any:
    """q^share, as tensions along the arc are computed."""
    return ar.expm1(ar.log1p(ar.number(q - 1)) / ar.pi * ar.number(share) * ar.pi) + 1


def turned(ar: Any, mu: Fraction) -> Any:
    """The capstan ratio over half a turn."""
    return ar.expm1(ar.number(mu) * ar.pi) + 1


Quantity = Callable[[Any], Any]

RATIONAL: dict[str, tuple[Quantity, Fraction]] = {
    "cos 60°": (lambda ar: degrees(ar, 60)[0], F(1, 2)),
    "sin 330°": (lambda ar: degrees(ar, 330)[1], F(-1, 2)),
    "cos 36° cos 72°": (lambda ar: degrees(ar, 36)[0] * degrees(ar, 72)[0], F(1, 4)),
    "cos 45° - sin 45°": (lambda ar: degrees(ar, 45)[0] - degrees(ar, 45)[1], F(0)),
    "cos² + sin² of 1 rad": (lambda ar: sum(x * x for x in ar.cos_sin(ar.number(1))), F(1)),
    "√(sin² 60°) · sin 60°": (
        lambda ar: ar.sqrt(degrees(ar, 60)[1] * degrees(ar, 60)[1]) * degrees(ar, 60)[1],
        F(3, 4),
    ),
    "4^(1/2)": (lambda ar: root(ar, F(4), F(1, 2)), F(2)),
    "(27/8)^(4/3)": (lambda ar: root(ar, F(27, 8), F(4, 3)), F(81, 16)),
    "e^(0.3π)/e^(0.1π)/e^(0.2π)": (
        lambda ar: turned(ar, F(3, 10)) / turned(ar, F(1, 10)) / turned(ar, F(1, 5)),
        F(1),
    ),
    "(2 k + 6)/(k + 3)": (lambda ar: (2 * ar.expm1(ar.pi) + 8) / (ar.expm1(ar.pi) + 4), F(2)),
}


@pytest.mark.parametrize("name", RATIONAL)
def test_a_rational_value_is_rounded_as_what_it_is(name: str) -> None:
    """Moved by a rational number, the value becomes a tie, or lies beside one by 10^-40."""
    quantity, value = RATIONAL[name]
    tie, tiny = F(1, 8), F(1, 10**40)
    for wanted, shown in ((tie, "0.12"), (tie + tiny, "0.13"), (tie - tiny, "0.12"), (F(0), "0")):
        rounded = settle(lambda ar, by=wanted - value: quantity(ar) + ar.number(by), to_digits(2), 2)
        assert rounded == Decimal(shown)


@pytest.mark.parametrize(
    "more",
    ["0" * 38 + "21097506749098184734729225660769629110149", "0" * 300 + "1", "0" * 990 + "1"],
    ids=["a multiple of a known prime", "300 digits", "990 digits"],
)
def test_a_tie_cannot_be_faked(more: str) -> None:
    """Half-way between 2 s and 3 s is the fall of 6.25 m at 2 m/s², and of no other height."""

    def fall_time(drop: str) -> Any:
        return read_answers({"m1": "1", "m2": "3", "g": "4", "drop": drop}, 1)["fall_time"]

    assert fall_time("6.25") == 2
    assert fall_time(f"6.25{more}") == 3


# Ties in what is printed: the oracle has 60 digits, and calls a tie what agrees with one in 45


ANGLES = st.sampled_from([30, 45, 60, 90, 120, 135, 150, 210, 240, 300, 330])


@given(ANGLES, st.integers(1, 40), st.integers(1, 40), st.integers(1, 5))
def test_resultants_at_angles_with_rational_cosines(wrap: int, m1: int, more: int, digits: int) -> None:
    """On a locked pulley the tensions are rational, and with them half of the resultants."""
    mpmath.mp.dps = 60
    g, m2 = F("1.25"), m1 + more
    balance = contact(Answers(read_scene({"m1": m1, "m2": m2, "M": inf, "wrap": wrap, "g": g}), digits), 2)
    t1, t2, phi = m1 * mpmath.mpf(1.25), m2 * mpmath.mpf(1.25), mpmath.radians(wrap)
    for axis, value in {"x": -t2 * mpmath.sin(phi), "y": t2 * mpmath.cos(phi) - t1}.items():
        exact = Context(45).create_decimal(mpmath.nstr(value, 50, strip_zeros=False))
        want = 0 if abs(value) < 1e-50 else Context(digits, ROUND_HALF_EVEN).plus(exact)
        assert balance.balance["resultant"][axis] == want


@given(st.integers(1, 9), st.integers(1, 9), st.sampled_from([2, 3, 4]), st.integers(1, 6))
def test_tensions_that_are_powers_of_a_rational_ratio(a: int, b: int, parts: int, digits: int) -> None:
    """Where r = (b/a)^n, T_l r^(j/n) is rational."""
    mpmath.mp.dps = 60
    m1, m2 = F(a**parts), F(b**parts)
    answers = Answers(read_scene({"m1": m1, "m2": m2, "M": inf, "g": "0.5"}), digits)
    points = contact(answers, parts + 1).points
    for j, point in enumerate(points):
        exact = F(1, 2) * F(a) ** (parts - j) * F(b) ** j
        assert point["tension"] == to_digits(digits)(exact)


@given(st.integers(1, 60), st.integers(3, 9), st.integers(1, 3))
def test_friction_in_which_the_capstan_ratio_cancels(l: int, q: int, digits: int) -> None:
    """At 90° of wrap with μ = l/h, friction_force_x is -2lgμ/(1 + μ²)."""
    mu, g = F(1, q), F("5.3125")
    found = solve(m1=l, m2=l * q, mu=mu, wrap=90, g=g, M="inf", digits=digits).friction_force_x
    exact = -2 * l * g * mu / (1 + mu * mu)
    assert found == to_digits(digits)(exact)


def test_a_tie_in_an_array_stops_no_other_row() -> None:
    g = 6004799503160661 * 2.0**-49
    rows: dict[str, Any] = {"M": [inf, 2.0], "mu": [0.25, 0.3], "wrap": [90, 180], "g": g}
    solved = solve_arrays([51, 1], [204, 3], **rows, accuracy="exact", quantities=["friction_force_x"])
    found = solved["friction_force_x"]
    exact = -2 * 51 * F(g) * F(1, 4) / (1 + F(1, 16))
    assert found[0] == float(exact)
    assert np.isnan(found[1])  # friction to spare
