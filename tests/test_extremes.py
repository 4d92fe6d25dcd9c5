"""Limits of the model and dangers of numbers: what the program says there obeys a law that it does not know.

The law is the leading term of the limit, or the paper's formula as printed, in so many digits that nothing which it
cancels matters; and how far from it an answer may be, relative to it. Its scenes are those that go through all doors
in test_doors, which are held to the oracle.
"""

from collections.abc import Callable
from decimal import Context, Decimal
from fractions import Fraction
from math import inf, log, pi
from random import Random
from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from mpmath import MPContext

from atwood_cli import solve
from atwood_cli.model.quantities import NAMES
from atwood_cli.model.scene import Scene
from atwood_cli.solver.answers import Answers

from .conftest import examples, many
from .doors import solve_any
from .scenes import DANGERS, FAMILIES, ON_AN_AXLE, G, Given, scenes

mp: Any = MPContext()
mp.dps = 60

DIGITS = 30
UNIT = mp.mpf(10) ** (1 - DIGITS)
few = examples(40)

masses = st.floats(1e-3, 1e3)
coefficients = st.floats(0.01, 2)
unequal = st.tuples(masses, st.floats(1.01, 100)).map(lambda of: (of[0], of[0] * of[1]))

Law = tuple[dict[str, Any], Any]
"""What quantities are, and how far from it they may be for what the law leaves out."""


def numbers(given: Given) -> SimpleNamespace:
    """The lighter and the heavier mass l and h, c of the rim, the axle's f, the grip mu phi, k = e^grip, and k - 1."""
    x = SimpleNamespace(
        **{name: mp.mpf(given.get(name, "0")) for name in ("m1", "m2", "g", "mu", "M", "axle")}
    )
    x.phi = mp.mpf(given.get("wrap", "180")) * mp.pi / 180
    (x.l, x.h), x.c = sorted((x.m1, x.m2)), x.M / 2
    if "I" in given:
        x.c = mp.mpf(given["I"]) / mp.mpf(given["R"]) ** 2
    x.grip = x.mu * x.phi
    x.k, x.k_minus_1 = mp.exp(x.grip), mp.expm1(x.grip)
    x.slide = mp.exp(mp.mpf(given.get("mu_k", given.get("mu", "0"))) * x.phi)
    x.massless, x.pull = x.g * (x.h - x.l) / (x.l + x.h), 2 * x.l * x.h * x.g / (x.l + x.h)
    return x


def masses_a_few_doubles_apart(x: Any) -> Law:
    """Half the pulley's mass and 2 l share what the difference drives; ln(T2/T1) is lost in doubles."""
    difference = x.h - x.l
    needed = x.c / (2 * x.l + x.c) * difference / x.l / x.phi
    return {"acceleration": x.g * difference / (2 * x.l + x.c), "mu_verge": needed}, 4 * difference / x.l


def light_pulley(x: Any) -> Law:
    """The motion comes to that of a massless pulley, but the friction, however small, keeps its digits."""
    needed = x.c * (x.h - x.l) / (2 * x.l * x.h) / x.phi
    motion = {"acceleration": x.massless, "tension_1": x.pull, "tension_2": x.pull}
    return motion | {"mu_verge": needed}, x.M / x.l


def heavy_pulley(x: Any) -> Law:
    """Of the motion, what is left goes as 1/M; forces are those of masses at rest, on a locked one exactly."""
    mu = mp.log(x.h / x.l) / x.phi
    resultant = mu / mp.sqrt(1 + mu**2) * (x.l + x.h) * x.g  # (32)
    still = {"tension_1": x.l * x.g, "tension_2": x.h * x.g, "mu_verge": mu, "friction_force": resultant}
    return still | {"acceleration": x.g * (x.h - x.l) / x.c}, 8 * x.h / x.c


def slip_with_weak_friction(x: Any) -> Law:
    """e^{mu phi} - 1 is lost in doubles: the exponential is 1."""
    motion = {"acceleration": x.massless, "rim_acceleration": x.pull * x.grip / x.c}
    limits = {
        "critical_pulley_mass": 4 * x.l * x.h * x.grip / (x.h - x.l),
        "least_pulley_mass": 4 * x.l * x.grip,
    }
    return motion | limits, 200 * x.grip


def verge_with_weak_friction(x: Any) -> Law:
    critical = 4 * x.l * x.h * x.grip / (x.h - x.l)
    return {"acceleration": x.massless, "critical_pulley_mass": critical}, 200 * x.grip


def critical_pulley_mass(x: Any) -> Law:
    """h - l k is lost where l k is formed first: what it hangs on are digits that l k has no room for."""
    holds = x.l * x.k > x.h
    critical = None if holds else 4 * x.l * x.h * x.k_minus_1 / (x.h - x.l * x.k)  # (34)
    return {"regime": "no-slip" if holds else "verge", "critical_pulley_mass": critical}, 0


def beside_the_pulley_that_any_mass_leaves_holding(x: Any) -> Law:
    """Between two doubles the critical heavier mass goes to infinity."""
    holds = x.M < 4 * x.l * x.k_minus_1
    critical = None if holds else x.M * x.l * x.k / (x.M - 4 * x.l * x.k_minus_1)  # (35)
    return {"regime": "no-slip" if holds else "slip", "critical_heavier_mass": critical}, 0


def motion(x: Any) -> Law:
    """(1) and (3) with the axle's friction, if k allows the ratio of tensions; else T_h = k T_l, and (1)."""
    rests = x.c == inf or x.g * (x.h - x.l) <= x.axle
    a = mp.mpf(0) if rests else (x.g * (x.h - x.l) - x.axle) / (x.h + x.l + x.c)
    light, heavy = x.l * (x.g + a), x.h * (x.g - a)
    if not x.mu or heavy / light - 1 <= x.k_minus_1:
        return {"regime": "no-slip", "a": a, "rim": a, "light": light, "heavy": heavy}, 0
    light = 2 * x.l * x.h * x.g / (x.h + x.l * x.slide)
    left = light * (x.slide - 1) - x.axle
    rim = left / x.c if left > 0 and not rests else mp.mpf(0)
    return {"regime": "slip", "a": light / x.l - x.g, "rim": rim, "light": light, "heavy": light * x.slide}, 0


def slip_on_any_pulley_or_hardly(x: Any) -> Law:
    """At the verge (1) gives a, and (3) what pulley that takes."""
    a = x.g * (x.h - x.l * x.k) / (x.h + x.l * x.k)
    c = (x.l * (x.g + a) * x.k_minus_1 - x.axle) / a
    if x.g * (x.h - x.l) <= x.axle or x.l * x.k > x.h:
        return {"critical_pulley_mass": None}, 0
    return {"regime": "verge", "critical_pulley_mass": 2 * c} if c > 0 else {"regime": "slip"}, 0


def friction_straight_up(x: Any) -> Law:
    """Of the resultant of both tensions friction is the share sin(arctan mu)."""
    if x.l * x.k > x.h:
        return {"regime": "no-slip"}, 0
    light = 2 * x.l * x.h * x.g / (x.h + x.l * x.k)
    resultant = light * mp.sqrt(1 + x.k**2 - 2 * x.k * mp.cos(x.phi))
    return {"friction_force": x.mu / mp.sqrt(1 + x.mu**2) * resultant}, 0


def capstan_ratio_beyond_the_doubles(x: Any) -> Law:
    lk = x.l * x.k
    tensions = {"tension_1": 2 * x.l * x.h * x.g / (x.h + lk), "tension_2": 2 * lk * x.h * x.g / (x.h + lk)}
    motion = {"regime": "slip", "acceleration": x.g * (x.h - lk) / (x.h + lk)}
    return motion | tensions | {"least_heavier_mass": lk}, 0


def capstan_ratio_that_a_mass_brings_back(x: Any) -> Law:
    return {"regime": "no-slip", "least_heavier_mass": x.l * x.k}, 0


LAWS: dict[str, Callable[[Any], Law]] = {
    "masses_a_few_doubles_apart": masses_a_few_doubles_apart,
    "light_pulley_whole_turns": light_pulley,
    "light_pulley_short_wrap": light_pulley,
    "heavy_pulley": heavy_pulley,
    "slip_with_weak_friction": slip_with_weak_friction,
    "verge_with_weak_friction": verge_with_weak_friction,
    "weak_friction_on_nearly_equal_masses": critical_pulley_mass,
    "beside_the_mass_that_any_pulley_holds": critical_pulley_mass,
    "beside_the_pulley_that_any_mass_leaves_holding": beside_the_pulley_that_any_mass_leaves_holding,
    "slip_on_any_pulley_or_hardly": slip_on_any_pulley_or_hardly,
    "friction_straight_up": friction_straight_up,
    "capstan_ratio_beyond_the_doubles": capstan_ratio_beyond_the_doubles,
    "capstan_ratio_that_a_mass_brings_back": capstan_ratio_that_a_mass_brings_back,
}


"""The others obey those of motion."""
SIDES = {"a": "acceleration", "rim": "rim_acceleration", "light": "tension_1", "heavy": "tension_2"}
MIRRORED = SIDES | {"light": "tension_2", "heavy": "tension_1"}


def near(value: Any, law: Any, within: Any) -> bool:
    return bool(abs(mp.convert(value) - law) <= within * abs(law))


@pytest.mark.parametrize("danger", DANGERS)
def test_answers_obey_the_law_of_a_danger(danger: str) -> None:
    for drawn in scenes(danger, many(100), seed=3):
        with mp.workdps(400):  # tiny numbers beside ordinary ones
            x = numbers(drawn)
            law, slack = LAWS.get(danger, motion)(x)
            found = solve_any(**drawn, digits=DIGITS)
            mirrored = x.m1 > x.m2
            for name, value in law.items():
                got = getattr(found, (MIRRORED if mirrored else SIDES).get(name, name))
                want = -value if mirrored and name in ("a", "rim") else value
                exact = value is None or isinstance(value, str)
                assert got == value if exact else near(got, want, UNIT + slack), (drawn, name)


@pytest.mark.parametrize("mu", ["1e6", "1e400"])
def test_a_huge_mu_is_answered_by_logic(mu: str) -> None:
    s = solve(m1=1, m2=3, mu=mu, digits=5)
    assert s.regime == "no-slip"
    assert s.least_heavier_mass == (Decimal("2.2586e1364376") if mu == "1e6" else Decimal("Infinity"))
    assert any("beyond 10^100000000" in note for note in s.notes) == (mu == "1e400")


@few
@given(masses, coefficients, st.integers(20, 300))
def test_the_critical_pulley_mass_goes_to_infinity_as_1_over_the_excess(
    m1: float, mu: float, power: int
) -> None:
    with mp.workdps(1000):
        k = mp.exp(mu * mp.pi)
        lk = Fraction(mp.nstr(m1 * k, 700))
    excess = Fraction(1, 10**power)
    above, below = (solve(m1=m1, m2=lk * (1 + off), mu=mu, digits=DIGITS) for off in (excess, -excess))
    assert near(above.critical_pulley_mass, 4 * m1 * (k - 1) * 10**power, UNIT + 2 / mp.mpf(10) ** power)
    assert below.critical_pulley_mass is None
    assert "No slip on any pulley" in below.notes[0]


verges = st.tuples(unequal, st.floats(0.01, 0.99)).map(
    lambda of: (*of[0], of[1] * log(of[0][1] / of[0][0]) / pi)
)
"""m1, m2 and a mu that a heavy enough pulley beats."""


@few
@given(verges)
def test_the_motion_is_continuous_where_the_string_begins_to_slip(scene: tuple[float, float, float]) -> None:
    """On which side of it a pulley is, is decided at any closeness."""
    m1, m2, mu = scene
    critical = solve(m1=m1, m2=m2, mu=mu, digits=1000).critical_pulley_mass
    assert critical is not None
    grips, slips = (
        solve(m1=m1, m2=m2, mu=mu, g=G, M=Fraction(critical) + Fraction(off, 10**900)) for off in (-1, 1)
    )
    assert (grips.regime, slips.regime) == ("no-slip", "slip")
    for name in ("acceleration", "tension_1", "tension_2", "rim_acceleration"):
        assert getattr(slips, name) == getattr(grips, name)


# The same machine in other units, and from behind

DIMENSIONS = {  # of kg, m and s
    **dict.fromkeys(["m1", "m2", "M", *(name for name in NAMES if name.endswith("_mass"))], (1, 0, 0)),
    **dict.fromkeys(["g", "acceleration", "rim_acceleration"], (0, 1, -2)),
    **dict.fromkeys([name for name in NAMES if "force" in name or "tension" in name], (1, 1, -2)),
    **{"R": (0, 1, 0), "I": (1, 2, 0), "N": (1, 1, -2), "N m": (1, 2, -2), "torque": (1, 2, -2)},
    **{"angular_acceleration": (0, 0, -2), "tension_ratio": (0, 0, 0)},
}
everywhere = pytest.mark.parametrize("family", [*FAMILIES, *(f"{family}{ON_AN_AXLE}" for family in FAMILIES)])


@everywhere
def test_in_units_smaller_by_powers_of_ten_the_point_alone_moves(family: str) -> None:
    rng = Random(family)
    for drawn in scenes(family, many(40), seed=4):
        units = [rng.randint(-10, 10) for _ in range(3)]

        def factor(name: str, units: list[int] = units) -> Fraction:
            powers = zip(units, DIMENSIONS.get(name, (0, 0, 0)), strict=True)
            return Fraction(10) ** sum(unit * power for unit, power in powers)

        scene = Scene.read(drawn)
        numbers: dict[str, Any] = {
            name: value * factor(name) for name, value in scene._asdict().items() if type(value) is Fraction
        }
        if scene.axle:
            numbers["axle"] = scene.axle._replace(number=scene.axle.number * factor(scene.axle.unit))
        here, there = Answers(scene, DIGITS), Answers(scene._replace(**numbers), DIGITS)
        for name in NAMES:
            moved = isinstance(here[name], Decimal) and here[name].is_finite()
            assert there[name] == (Fraction(here[name]) * factor(name) if moved else here[name]), (
                drawn,
                name,
            )


SIGNED = ("acceleration", "rim_acceleration", "angular_acceleration", "torque", "friction_force_x")
TURNED = ("friction_force_x", "friction_force_y")  # with the arc, unless it is half a turn


@everywhere
def test_from_behind_everything_is_mirrored(family: str) -> None:
    for drawn in scenes(family, many(40), seed=5):
        front, behind = solve_any(**drawn), solve_any(**drawn | {"m1": drawn["m2"], "m2": drawn["m1"]})
        mirrored = {"tension_1": front.tension_2, "tension_2": front.tension_1}
        for name in NAMES:
            if name not in TURNED or "wrap" not in drawn:
                value = mirrored.get(name, getattr(front, name))
                assert getattr(behind, name) == (-value if name in SIGNED and value else value), (drawn, name)


# One digit, and a thousand


@examples(8)
@given(unequal, masses)
def test_a_thousand_digits_are_all_right_and_one_is_their_rounding(
    pair: tuple[float, float], M: float
) -> None:
    with mp.workdps(1050):
        l, h, c, g = (mp.convert(number) for number in (*pair, M / 2, G))
        light, heavy = ((2 * one + c) * other * g / (l + h + c) for one, other in ((h, l), (l, h)))
        mu = mp.log(heavy / light) / mp.pi
        laws = {
            "acceleration": g * (h - l) / (l + h + c),
            "mu_verge": mu,
            "friction_force": mu / mp.sqrt(1 + mu**2) * (light + heavy),
        }
        wanted = {name: Decimal(mp.nstr(law, 1040, strip_zeros=False)) for name, law in laws.items()}
    for digits in (1000, 1):
        solution = solve_any(m1=pair[0], m2=pair[1], M=M, g=G, digits=digits)
        for name, value in wanted.items():
            assert getattr(solution, name) == Context(prec=digits).plus(value), name
