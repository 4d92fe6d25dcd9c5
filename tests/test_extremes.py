"""Limits of the model: what the program says there comes to a leading term that it does not know.

The scenes are dangers that go through all doors in test_doors, which are held to the oracle.
"""

from collections.abc import Callable
from decimal import Decimal
from fractions import Fraction
from math import log, pi
from random import Random
from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from mpmath import MPContext

from atwood_cli import solve
from atwood_cli.reading.inputs import read_scene
from atwood_cli.solver.answers import Answers
from atwood_cli.solver.quantities import NAMES, QUANTITIES
from atwood_cli.solver.scene import INPUTS

from .conftest import examples, many
from .tools.doors import solve_any
from .tools.scenes import FAMILIES, ON_AN_AXLE, G, scenes

mp: Any = MPContext()
mp.dps = 60

DIGITS = 30
UNIT = mp.mpf(10) ** (1 - DIGITS)
Terms = tuple[dict[str, Any], Any]
"""What quantities come to, and how far from it they may be, relative to it, for what the leading term leaves out."""


def masses_a_few_doubles_apart(x: Any) -> Terms:
    """Half the pulley's mass and 2 l share what the difference drives; ln(T2/T1) is lost in doubles."""
    difference = x.h - x.l
    needed = x.c / (2 * x.l + x.c) * difference / x.l / x.phi
    return {"acceleration": x.g * difference / (2 * x.l + x.c), "mu_verge": needed}, 4 * difference / x.l


def pulley_of_hardly_any_mass(x: Any) -> Terms:
    """The motion comes to that of a massless pulley, but the friction, however small, keeps its digits."""
    needed = x.c * (x.h - x.l) / (2 * x.l * x.h) / x.phi
    motion = {"acceleration": x.massless, "tension_1": x.pull, "tension_2": x.pull}
    return motion | {"mu_verge": needed}, 2 * x.c / x.l


def heavy_pulley(x: Any) -> Terms:
    """Of the motion, what is left goes as 1/M; forces are those of masses at rest, on a locked one exactly."""
    mu = mp.log(x.h / x.l) / x.phi
    resultant = mu / mp.sqrt(1 + mu**2) * (x.l + x.h) * x.g  # (32)
    still = {"tension_1": x.l * x.g, "tension_2": x.h * x.g, "mu_verge": mu, "friction_force": resultant}
    return still | {"acceleration": x.g * (x.h - x.l) / x.c}, 8 * x.h / x.c


def weak_friction(x: Any) -> Terms:
    """e^{mu phi} - 1 is lost in doubles: the exponential is 1."""
    critical = 4 * x.l * x.h * x.mu * x.phi / (x.h - x.l)
    motion = {"acceleration": x.massless, "critical_pulley_mass": critical}
    if x.c:
        motion |= {
            "rim_acceleration": x.pull * x.mu * x.phi / x.c,
            "least_pulley_mass": 4 * x.l * x.mu * x.phi,
        }
    return motion, 200 * x.mu * x.phi


LIMITS = [masses_a_few_doubles_apart, pulley_of_hardly_any_mass, heavy_pulley, weak_friction]


@pytest.mark.parametrize("limit", LIMITS)
def test_answers_come_to_the_leading_term(limit: Callable[[Any], Terms]) -> None:
    for drawn in scenes(limit.__name__, many(100), seed=3):
        with mp.workdps(400):  # tiny numbers beside ordinary ones
            given = {"M": "0", "mu": "0", "wrap": "180"} | drawn
            x = SimpleNamespace(**{name: mp.mpf(text) for name, text in given.items()})
            x.l, x.h, x.c, x.phi = x.m1, x.m2, x.M / 2, x.wrap * mp.pi / 180
            x.massless, x.pull = x.g * (x.h - x.l) / (x.l + x.h), 2 * x.l * x.h * x.g / (x.l + x.h)
            terms, slack = limit(x)
            found = solve_any(**drawn, digits=DIGITS)
            for name, term in terms.items():
                got = mp.convert(getattr(found, name))
                assert abs(got - term) <= (UNIT + slack) * abs(term), (drawn, name)


@pytest.mark.parametrize("mu", ["1e6", "1e400"])
def test_a_huge_mu_is_answered_by_logic(mu: str) -> None:
    s = solve(m1=1, m2=3, mu=mu, digits=5)
    assert s.regime == "no-slip"
    assert s.least_heavier_mass == (Decimal("2.2586e1364376") if mu == "1e6" else Decimal("Infinity"))
    assert any("beyond 10^100000000" in note for note in s.notes) == (mu == "1e400")


@examples(40)
@given(st.floats(1e-3, 1e3), st.floats(1.01, 100), st.floats(0.01, 0.99))
def test_the_motion_is_continuous_where_the_string_begins_to_slip(
    m1: float, ratio: float, share: float
) -> None:
    """On which side of it a pulley is, is decided at any closeness."""
    m2, mu = m1 * ratio, share * log(ratio) / pi
    critical = solve(m1=m1, m2=m2, mu=mu, digits=1000).critical_pulley_mass
    assert critical is not None
    grips, slips = (
        solve(m1=m1, m2=m2, mu=mu, g=G, M=Fraction(critical) + Fraction(off, 10**900)) for off in (-1, 1)
    )
    assert (grips.regime, slips.regime) == ("no-slip", "slip")
    for name in ("acceleration", "tension_1", "tension_2", "rim_acceleration"):
        assert getattr(slips, name) == getattr(grips, name)


# The same machine in other units

DIMENSIONS: dict[str, tuple[int, int, int]] = {  # of kg, m and s
    **{"kg": (1, 0, 0), "m": (0, 1, 0), "m/s²": (0, 1, -2), "rad/s²": (0, 0, -2)},
    **{"N": (1, 1, -2), "N m": (1, 2, -2), "kg m²": (1, 2, 0)},
}
UNITS = {x: one.unit for x, one in INPUTS.items()} | {x: one.unit for x, one in QUANTITIES.items()}
DIMENSIONS |= {x: DIMENSIONS.get(unit, (0, 0, 0)) for x, unit in UNITS.items()}


@pytest.mark.parametrize("family", [f"{family}{axle}" for axle in ("", ON_AN_AXLE) for family in FAMILIES])
def test_in_units_smaller_by_powers_of_ten_the_point_alone_moves(family: str) -> None:
    rng = Random(family)
    for drawn in scenes(family, many(40), seed=4):
        units = [rng.randint(-10, 10) for _ in range(3)]

        def factor(name: str, units: list[int] = units) -> Fraction:
            powers = zip(units, DIMENSIONS.get(name, (0, 0, 0)), strict=True)
            return Fraction(10) ** sum(unit * power for unit, power in powers)

        scene = read_scene(drawn)
        numbers: dict[str, Any] = {
            name: value * factor(name) for name, value in scene._asdict().items() if type(value) is Fraction
        }
        here, there = Answers(scene, DIGITS), Answers(scene._replace(**numbers), DIGITS)
        for name in NAMES:
            moved = isinstance(here[name], Decimal) and here[name].is_finite()
            assert there[name] == (Fraction(here[name]) * factor(name) if moved else here[name]), (
                drawn,
                name,
            )
