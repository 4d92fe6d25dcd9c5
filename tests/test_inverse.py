"""From a measured acceleration back to the pulley or to gravity, and the fall from rest."""

import re
from decimal import Decimal
from fractions import Fraction
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from atwood_cli import SceneError, Solution, solve
from atwood_cli.reading.inputs import read_scene
from atwood_cli.solver.answers import Answers
from atwood_cli.solver.quantities import NAMES
from atwood_cli.solver.scene import Motion

from .tools.doors import solve_any
from .tools.scenes import inputs

masses = st.fractions(min_value=Fraction(1, 10**6), max_value=10**6)


def measured(**given: Any) -> Solution[Any]:
    return solve(**{"m1": "1", "m2": "3", **given})


masses_or_0 = masses | st.just(Fraction(0))


@given(masses, masses, masses_or_0, masses, masses, masses_or_0, st.booleans())
def test_what_is_found_gives_the_measured_acceleration_exactly(
    l: Fraction, more: Fraction, M: Fraction, g: Fraction, beta: Fraction, f: Fraction, mirrored: bool
) -> None:
    h = l + f / g + more
    a = (g * (h - l) - f) / (h + l + beta * M) * (-1 if mirrored else 1)
    m1, m2 = (h, l) if mirrored else (l, h)
    known: dict[str, Any] = {"m1": m1, "m2": m2, "M": M, "g": g, "axle": f, "inertia": beta}
    exact = solve(**known, digits=30)
    assert exact.acceleration == Answers(read_scene(known), 30).round(a)
    for unknown in ("m1", "m2", "M", "g"):
        found: Any = solve(**{**known, unknown: None}, a=a, digits=30)
        assert found.scene._replace(motion=Motion()) == exact.scene
        assert all(getattr(found, name) == getattr(exact, name) for name in NAMES)
    for unknown in ("m1", "m2") if M else ():
        known_masses = {**known, "M": None, "inertia": None, unknown: None}
        found = solve(**known_masses, I=beta * M, R=1, a=a)
        assert getattr(found.scene, unknown) == known[unknown]


def test_a_slide_finds_kinetic_friction_and_moves_as_that_does() -> None:
    """The issue's: 100 g and 400 g over a locked pulley at 2.141 m/s²."""
    axles = [{"M": "30", "mu": "0.39", "axle": axle} for axle in ("0.3", "2.5")]  # 2.5 N holds the pulley
    found = measured(m1="100g", m2="400g", M="inf", a="2.141", digits=30)
    assert f"{found.mu_k:.3f}" == "0.300"
    for m1, m2, sign in (("100g", "400g", 1), ("400g", "100g", -1)):
        for more in ({"M": "inf"}, {"M": "inf", "mu": "0.4"}, {"M": "7", "mu": "0.39"}, *axles):
            found = measured(m1=m1, m2=m2, a=Decimal("2.141") * sign, digits=30, **more)
            again: Any = solve(m1=m1, m2=m2, **{"mu": found.mu_k, **more}, mu_k=found.mu_k, digits=25)
            assert again.regime == found.regime == "slip"
            for name in NAMES[1:]:
                one, other = getattr(found, name), getattr(again, name)
                if one is not None and name != "least_wrap":
                    assert float(one) == pytest.approx(float(other), rel=1e-15), name
    massless = measured(M="inf", a="4.903325")  # as fast as without friction
    assert (massless.mu_k, massless.friction_force) == (0, 0)


@pytest.mark.parametrize("masses", ["m1=1", "m1=3 m2=1", "m2=1.1", "m1=7 m2=2.9", "m1=0.1 m2=0.3"])
def test_about_the_greatest_acceleration_that_an_error_names_is_taken(masses: str) -> None:
    given = inputs(f"{masses} M=inf")
    with pytest.raises(SceneError, match="without friction the acceleration is") as caught:
        solve(**given, a=9 if Fraction(given["m2"]) > Fraction(given["m1"]) else -9)
    [greatest] = re.findall("the acceleration is (.*) m/s²", str(caught.value))
    assert solve(**given, a=Fraction(greatest) * Fraction("0.99999")).mu_k is not None


sizes = st.builds(lambda mass, power: mass * Fraction(10) ** power, masses, st.integers(-150, 150))


@given(masses | sizes, masses_or_0 | sizes, masses_or_0, masses | sizes, masses_or_0 | sizes, st.booleans())
def test_axle_friction_is_that_of_newtons_equations_also_where_masses_slow_down(
    l: Fraction, more: Fraction, M: Fraction, g: Fraction, f: Fraction, mirrored: bool
) -> None:
    """h descends, with T_h - T_l - f = c a, whatever its speed; equal masses only slow down."""
    h, c = l + more, M / 2
    a = (g * (h - l) - f) / (h + l + c)
    if not -g < a or (not more and not f):
        return
    m1, m2, sign = (h, l, -1) if mirrored else (l, h, 1)
    found = solve_any(m1=m1, m2=m2, M=M, g=g, a=sign * a, find="axle", R=2, digits=40)
    exact = {"axle": f, "axle_torque": 2 * f, "acceleration": sign * a, "torque": sign * 2 * (c * a + f)}
    exact |= {"tension_1": m1 * (g + sign * a), "tension_2": m2 * (g - sign * a)}
    assert found.scene.axle == f
    for name, value in exact.items():
        assert getattr(found, name) == Answers(found.scene, 40).round(value), name
    assert ("Slows down" in found.notes[0]) == (a < 0)


@given(masses, masses, masses, masses, st.booleans(), st.booleans())
def test_two_of_a_fall_give_the_acceleration_and_one_gives_the_others(
    l: Fraction, more: Fraction, c: Fraction, t: Fraction, mirrored: bool, finds_heavier: bool
) -> None:
    a = more / (2 * l + more + c)  # with g = 1
    fall = {"drop": a * t * t / 2, "time": t, "speed": a * t}
    m1, m2 = (l + more, l) if mirrored else (l, l + more)
    known: dict[str, Any] = {"m1": m1, "m2": m2, "M": c, "inertia": 1, "g": 1, "digits": 30}
    results = {"drop": "drop", "time": "fall_time", "speed": "final_speed"}
    for name in fall:
        other = solve_any(**known, **{name: fall[name]})
        two = {x: value for x, value in fall.items() if x != name}
        pulley = solve_any(**known | {"M": None}, **two)
        unknown = "m1" if finds_heavier == mirrored else "m2"
        signed = {x: -value if mirrored and x != "time" else value for x, value in two.items()}
        mass = solve_any(**known | {unknown: None}, **signed)
        assert (pulley.scene.M, getattr(mass.scene, unknown)) == (c, known[unknown])
        for x, result in results.items():
            nearest = mass._answers.round(fall[x])
            for solution in (other, pulley, mass):
                value = getattr(solution, result)
                assert value == nearest or (value is None and x == "drop" and solution.scene.motion.drop), x
