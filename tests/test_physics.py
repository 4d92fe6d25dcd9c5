"""The equations against what they come from: Newton's laws, exactly, and SymPy on the closed forms."""

from collections.abc import Callable
from fractions import Fraction

import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from atwood_cli import physics

masses = st.fractions(min_value=Fraction(1, 10**6), max_value=10**6)
l, h, c, g, mu, phi, t1, t2, beta = sp.symbols("l h c g mu phi T1 T2 beta", positive=True)
k = sp.exp(mu * phi)
k1 = k - 1


@given(masses, masses, st.fractions(min_value=0, max_value=10**6), masses)
def test_newtons_equations_hold_exactly_without_slip(
    a: Fraction, b: Fraction, c: Fraction, g: Fraction
) -> None:
    l, h = sorted((a, b))
    w, v = physics.shares(h, c)
    z, d = v * (h - l), w * (h - l)
    x = l + z
    acceleration = physics.acceleration(h, x, d, g)
    t_l, t_h = physics.light_tension(l, h, x, g), physics.heavy_tension(h, x, g)
    assert w + v == 1
    assert t_l - l * g == l * acceleration  # (1a)
    assert h * g - t_h == h * acceleration  # (1b)
    assert t_h - t_l == c * acceleration  # (3), M/2 = c
    assert physics.tension_difference(h, x, z, g) == t_h - t_l


@given(masses, masses, st.fractions(min_value=1, max_value=10), masses)
def test_newtons_equations_hold_exactly_in_slip(
    a: Fraction, b: Fraction, ratio: Fraction, g: Fraction
) -> None:
    l, h = sorted((a, b))
    z = physics.transfer_at_limit(l, ratio - 1)
    x, d = l + z, physics.surplus_at_limit(l, h, ratio - 1)
    acceleration = physics.acceleration(h, x, d, g)
    t_l, t_h = physics.light_tension(l, h, x, g), physics.heavy_tension(h, x, g)
    assert t_l - l * g == l * acceleration
    assert h * g - t_h == h * acceleration
    assert t_h == ratio * t_l
    assert physics.tension_difference(h, x, z, g) == t_h - t_l


def _no_slip() -> tuple[sp.Expr, sp.Expr, sp.Expr]:
    w, v = physics.shares(h, c)
    z, d = v * (h - l), w * (h - l)
    return z, d, l + z


def test_state_is_equation_4() -> None:
    _, d, x = _no_slip()
    total = l + h + c
    assert sp.simplify(physics.acceleration(h, x, d, g) - (h - l) * g / total) == 0
    assert sp.simplify(physics.light_tension(l, h, x, g) - (2 * h + c) * l * g / total) == 0
    assert sp.simplify(physics.heavy_tension(h, x, g) - (2 * l + c) * h * g / total) == 0


def test_verge_coefficient_solves_26() -> None:
    ratio = sp.Symbol("r", positive=True)
    verge = physics.verge_coefficient(sp.log(ratio), phi)
    assert sp.simplify(sp.exp(verge * phi) - ratio) == 0


def test_critical_pulley_mass_solves_33() -> None:
    mass = physics.critical_pulley_mass(l, h, k1, h - l * k, beta)
    ratio = ((2 * l + c) * h / ((2 * h + c) * l)).subs(c, beta * mass)
    assert sp.simplify(ratio - k) == 0
    paper = 4 * l * h * (sp.exp(mu * sp.pi) - 1) / (h - l * sp.exp(mu * sp.pi))
    assert sp.simplify((mass - paper).subs({beta: sp.Rational(1, 2), phi: sp.pi})) == 0


def test_critical_heavier_mass_solves_33() -> None:
    heavy = physics.critical_heavier_mass(l, c, k1)
    ratio = ((2 * l + c) * h / ((2 * h + c) * l)).subs(h, heavy)
    assert sp.simplify(ratio - k) == 0


def test_conditions_36_are_where_34_and_35_diverge() -> None:
    least = physics.least_heavier_mass(l, k1)
    assert (
        sp.simplify(1 / physics.critical_pulley_mass(l, h, k1, h - l * k, beta)).subs(h, least).simplify()
        == 0
    )
    pulley = physics.least_pulley_mass(l, k1, beta)
    assert sp.simplify((1 / physics.critical_heavier_mass(l, c, k1)).subs(c, beta * pulley)) == 0


theta = sp.Symbol("theta", positive=True)
tension = t1 * sp.exp(mu * theta)
ends = (
    (tension * sp.cos(theta)).subs(theta, phi) - t1,
    (tension * sp.sin(theta)).subs(theta, phi),
)


def test_friction_vector_is_the_integral_28() -> None:
    # Force on the pulley per radian: dT/dtheta along the unit tangent (-sin, cos), (6), (12).
    x = sp.integrate(-mu * tension * sp.sin(theta), (theta, 0, phi))
    y = sp.integrate(mu * tension * sp.cos(theta), (theta, 0, phi))
    fx, fy = physics.friction_vector(mu, *ends)
    assert sp.simplify(fx - x) == 0
    assert sp.simplify(fy - y) == 0


def test_normal_vector_is_the_integral_18() -> None:
    # Force on the pulley per radian: T inwards (13), on a stuck arc too.
    for coefficient in (mu, sp.Integer(0)):
        there = tension.subs(mu, coefficient)
        differences = [e.subs(mu, coefficient) for e in ends]
        nx, ny = physics.normal_vector(coefficient, *differences)
        assert sp.simplify(nx + sp.integrate(there * sp.cos(theta), (theta, 0, phi))) == 0
        assert sp.simplify(ny + sp.integrate(there * sp.sin(theta), (theta, 0, phi))) == 0


def test_friction_and_normal_force_make_the_resultant_19() -> None:
    fx, fy = physics.friction_vector(mu, *ends)
    nx, ny = physics.normal_vector(mu, *ends)
    rx, ry = physics.resultant_vector(*ends)
    assert sp.simplify(fx + nx - rx) == 0
    assert sp.simplify(fy + ny - ry) == 0
    over_half_a_turn = [e.subs(phi, sp.pi) for e in ends]
    assert physics.resultant_vector(*over_half_a_turn) == (0, -t1 - t1 * sp.exp(mu * sp.pi))  # (20)


def test_friction_over_half_a_turn_is_31_and_32() -> None:
    fx, fy = physics.friction_vector(mu, -t2 - t1, sp.Integer(0))
    assert sp.simplify(fx + mu / (1 + mu**2) * (t1 + t2)) == 0
    assert sp.simplify(fy + mu**2 / (1 + mu**2) * (t1 + t2)) == 0
    force = physics.friction_magnitude(
        mu, physics.resultant(t1, t2, t2 - t1, sp.Integer(1), sp.sqrt), sp.sqrt
    )
    assert sp.simplify(force**2 - fx**2 - fy**2) == 0


def test_magnitude_is_that_of_the_vector_at_any_wrap() -> None:
    fx, fy = physics.friction_vector(mu, t2 * sp.cos(phi) - t1, t2 * sp.sin(phi))
    resultant = physics.resultant(t1, t2, t2 - t1, sp.sin(phi / 2), sp.sqrt)
    assert sp.simplify(sp.expand_trig(resultant**2 - t1**2 - t2**2 + 2 * t1 * t2 * sp.cos(phi))) == 0
    assert sp.simplify(physics.friction_magnitude(mu, resultant, sp.sqrt) ** 2 - fx**2 - fy**2) == 0


def test_mirrored_vector_is_the_one_seen_from_behind() -> None:
    x, y, angle = sp.symbols("x y theta", real=True)
    # A point at theta goes to phi - theta, and back.
    mx, my = physics.mirrored(sp.cos(angle), sp.sin(angle), sp.cos(phi), sp.sin(phi))
    assert sp.simplify(mx - sp.cos(phi - angle)) == 0
    assert sp.simplify(my - sp.sin(phi - angle)) == 0
    twice = physics.mirrored(*physics.mirrored(x, y, sp.cos(phi), sp.sin(phi)), sp.cos(phi), sp.sin(phi))
    assert [sp.simplify(v) for v in twice] == [x, y]


def test_least_friction_slope_is_the_derivative_of_the_friction() -> None:
    s, stuck = sp.symbols("s delta", positive=True)
    dx, dy = t2 * sp.cos(phi) - t1, t2 * sp.sin(phi)
    bridge = t1 * sp.exp((mu + sp.I) * s) * (1 - sp.exp(sp.I * stuck))
    x, y = sp.re(sp.expand_complex(bridge)) + dx, sp.im(sp.expand_complex(bridge)) + dy
    slope = physics.least_friction_slope(
        mu, 2 * t1 * sp.sin(stuck / 2), sp.exp(mu * s), sp.cos(s + stuck / 2), sp.sin(s + stuck / 2), dx, dy
    )
    # Up to the positive factor chord e^{mu s}.
    square = sp.diff(x**2 + y**2, s) / 2
    values = {t1: 2, t2: 7, mu: sp.Rational(3, 10), s: sp.Rational(4, 5), stuck: sp.Rational(1, 3), phi: 3}
    factor = 2 * t1 * sp.sin(stuck / 2) * sp.exp(mu * s)
    assert abs(sp.N((square - slope * factor).subs(values), 60)) < 1e-50


def test_axle_carries_tensions_and_pulley() -> None:
    assert physics.axle_force(t1, t2, c, g) == t1 + t2 + c * g


def test_locked_pulley_is_the_limit() -> None:
    z, d, x = _no_slip()
    limits: list[tuple[sp.Expr, sp.Expr]] = [
        (physics.acceleration(h, x, d, g), sp.Integer(0)),
        (physics.light_tension(l, h, x, g), l * g),
        (physics.heavy_tension(h, x, g), h * g),
        (physics.tension_difference(h, x, z, g), (h - l) * g),
    ]
    for value, limit in limits:
        assert sp.simplify(sp.limit(value, c, sp.oo) - limit) == 0


def test_equations_run_in_floats_too() -> None:
    functions: list[Callable[..., float]] = [physics.light_tension, physics.least_pulley_mass]
    assert functions[0](1.0, 3.0, 2.0, 10.0) == 12.0
    assert functions[1](1.0, 0.5, 0.5) == 2.0
