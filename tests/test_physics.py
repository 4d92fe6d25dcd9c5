"""The equations against what they come from: Newton's laws, in exact fractions."""

from doctest import DocTestFinder, DocTestRunner
from fractions import Fraction
from inspect import isfunction

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from atwood_cli.solver import physics

masses = st.fractions(min_value=Fraction(1, 10**6), max_value=10**6)
axles = st.just(Fraction(0)) | masses
one = Fraction(1)


@given(masses, masses, st.fractions(min_value=0, max_value=10**6), masses, axles)
def test_newtons_equations_hold_exactly_without_slip(
    l: Fraction, more: Fraction, c: Fraction, g: Fraction, f: Fraction
) -> None:
    b = physics.axle_mass(f, g)
    h = l + b + more
    a = physics.acceleration(physics.drive(l, h, b), physics.load(l, h, c), g)
    t_l = physics.light_tension(l, a, g)
    t_h = t_l + physics.difference_of_a_pulley(c, a, f)
    assert a > 0
    assert t_l - l * g == l * a  # (1a)
    assert h * g - t_h == h * a  # (1b)
    assert t_h - t_l == c * a + f  # (3), M/2 = c
    assert t_l * (1 + physics.gripping_ratio_minus_1(l, h, c, b, one)) == t_h
    assert physics.rim_mass(l, h, a, g, b) == c
    assert physics.gravity(l, h, c, a, f) == g
    assert physics.heavier_mass(l, c, a, g, f) == h
    assert physics.lighter_mass(h, c, a, g, f) == l


@given(masses, masses, masses, axles, masses)
def test_limits_are_points_of_the_one_formula(
    l: Fraction, more: Fraction, C: Fraction, b: Fraction, D: Fraction
) -> None:
    h, g, none = l + b + more, Fraction(9), Fraction(0)
    ratio_minus_1 = physics.gripping_ratio_minus_1
    assert ratio_minus_1(l, h, C, b, D) == ratio_minus_1(l, h, C / D, b, one)
    for heavy in (h, l + b, l + b / 2):  # a pulley that stands, and tensions that are weights
        assert l * (1 + ratio_minus_1(l, heavy, C, b, none)) == heavy
    assert ratio_minus_1(l, l + b, C, b, D) == b / l  # the greatest difference that is held
    assert ratio_minus_1(h - b, h, C, b, D) == b / (h - b)  # the lightest mass that is held
    # Without mass the pulley passes on all but what the axle takes.
    a = physics.acceleration(physics.drive(l, h, b), physics.load(l, h, none), g)
    assert physics.light_tension(l, a, g) * ratio_minus_1(l, h, none, b, D) == b * g
    # Under a mass beyond all bounds all falls freely, so T_l = 2 l g.
    assert 2 * l * g * physics.heaviest_ratio_minus_1(l, C, b) == C * g + b * g


@given(masses, masses, st.fractions(min_value=1, max_value=20), masses, axles, masses)
def test_newtons_equations_hold_exactly_at_the_verge_and_in_slip(
    l: Fraction, more: Fraction, k: Fraction, g: Fraction, f: Fraction, beta: Fraction
) -> None:
    b, z = physics.axle_mass(f, g), physics.friction_at_limit(l, k - 1)
    h = l * k + more
    d = physics.drive(l, h, z)
    a = physics.acceleration(d, physics.load(l, h, z), g)
    t_l = physics.light_tension(l, a, g)
    difference = physics.friction_at_limit(t_l, k - 1)
    assert t_l - l * g == l * a
    assert h * g - (t_l + difference) == h * a
    assert t_l + difference == k * t_l
    c = beta * physics.critical_pulley_mass(l, h, z, d, beta, b)
    assert difference == c * a + f  # what is left for the pulley is its inertia
    assert (c > 0) == (difference > f)
    if c > 0:
        assert physics.rim_acceleration(difference, c, f) == a
        assert physics.rim_acceleration(difference, 2 * c, f) * 2 == a


@given(masses, st.fractions(min_value=1, max_value=20), masses, axles)
def test_the_critical_heavier_mass_is_where_the_ratio_is_the_capstans(
    l: Fraction, k: Fraction, c: Fraction, b: Fraction
) -> None:
    z = l * (k - 1)
    assume(c != b and c + b != 2 * z)
    h = physics.critical_heavier_mass(l, c, z, b)
    if h - l > b:
        assert physics.gripping_ratio_minus_1(l, h, c, b, one) == k - 1
    if 2 * z > b:
        pulley = physics.least_pulley_mass(z, Fraction(1, 2), b)
        assert physics.heaviest_ratio_minus_1(l, pulley / 2, b) == k - 1


@pytest.mark.parametrize("name", [name for name, one in vars(physics).items() if isfunction(one)])
def test_every_equation_has_an_example_that_holds(name: str) -> None:
    [example] = DocTestFinder(recurse=False).find(getattr(physics, name), name, physics)
    report: list[str] = []
    DocTestRunner().run(example, out=report.append)
    assert example.examples
    assert not report, "".join(report)
