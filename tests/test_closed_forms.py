"""The equations against what they come from: SymPy on the closed forms."""

import pytest

from atwood_cli.model import physics

pytest.importorskip("sympy", reason="needs sympy, which knows the closed forms")

import sympy as sp

l, h, c, b, g, mu, phi, t1, t2, beta = sp.symbols("l h c b g mu phi T1 T2 beta", positive=True)
zero = sp.Integer(0)
k = sp.exp(mu * phi)
k_minus_1 = k - 1


def _no_slip() -> tuple[sp.Expr, sp.Expr, sp.Expr]:
    a = physics.acceleration(h - l, physics.load(l, h, c), g)
    t_l = physics.light_tension(l, a, g)
    return a, t_l, t_l + physics.difference_of_a_pulley(c, a, zero)


def test_motion_is_equation_4() -> None:
    a, t_l, t_h = _no_slip()
    total = l + h + c
    assert sp.simplify(a - (h - l) * g / total) == 0
    assert sp.simplify(t_l - (2 * h + c) * l * g / total) == 0
    assert sp.simplify(t_h - (2 * l + c) * h * g / total) == 0


def test_verge_coefficient_solves_26() -> None:
    ratio = sp.Symbol("r", positive=True)
    verge = physics.verge_coefficient(sp.log(ratio), phi)
    assert sp.simplify(sp.exp(verge * phi) - ratio) == 0


def _critical_pulley_mass() -> sp.Expr:
    return physics.critical_pulley_mass(l, h, l * k_minus_1, physics.drive(l, h, l * k_minus_1), beta, zero)


def test_critical_pulley_mass_solves_33() -> None:
    mass = _critical_pulley_mass()
    ratio = ((2 * l + c) * h / ((2 * h + c) * l)).subs(c, beta * mass)
    assert sp.simplify(ratio - k) == 0
    paper = 4 * l * h * (sp.exp(mu * sp.pi) - 1) / (h - l * sp.exp(mu * sp.pi))
    assert sp.simplify((mass - paper).subs({beta: sp.Rational(1, 2), phi: sp.pi})) == 0


def test_conditions_36_are_where_34_and_35_diverge() -> None:
    least = physics.least_heavier_mass(l, l * k_minus_1)
    assert sp.simplify(1 / _critical_pulley_mass()).subs(h, least).simplify() == 0
    pulley = physics.least_pulley_mass(l * k_minus_1, beta, zero)
    assert (
        sp.simplify((1 / physics.critical_heavier_mass(l, c, l * k_minus_1, zero)).subs(c, beta * pulley))
        == 0
    )


theta = sp.Symbol("theta", positive=True)
tension = t1 * sp.exp(mu * theta)
ends = ((tension * sp.cos(theta)).subs(theta, phi) - t1, (tension * sp.sin(theta)).subs(theta, phi))


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


def _hypot(x: sp.Expr, y: sp.Expr | int) -> sp.Expr:
    return sp.sqrt(x**2 + y**2)


def test_friction_over_half_a_turn_is_31_and_32() -> None:
    fx, fy = physics.friction_vector(mu, -t2 - t1, sp.Integer(0))
    assert sp.simplify(fx + mu / (1 + mu**2) * (t1 + t2)) == 0
    assert sp.simplify(fy + mu**2 / (1 + mu**2) * (t1 + t2)) == 0
    resultant = physics.resultant(t1, t2, t2 - t1, sp.Integer(1), sp.sqrt, _hypot)
    force = physics.friction_magnitude(mu, resultant, _hypot)
    assert sp.simplify(force**2 - fx**2 - fy**2) == 0


def test_magnitude_is_that_of_the_vector_at_any_wrap() -> None:
    fx, fy = physics.friction_vector(mu, t2 * sp.cos(phi) - t1, t2 * sp.sin(phi))
    resultant = physics.resultant(t1, t2, t2 - t1, sp.sin(phi / 2), sp.sqrt, _hypot)
    assert sp.simplify(sp.expand_trig(resultant**2 - t1**2 - t2**2 + 2 * t1 * t2 * sp.cos(phi))) == 0
    assert sp.simplify(physics.friction_magnitude(mu, resultant, _hypot) ** 2 - fx**2 - fy**2) == 0


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


def test_locked_pulley_is_the_limit() -> None:
    a, t_l, t_h = _no_slip()
    limits: list[tuple[sp.Expr, sp.Expr]] = [
        (a, sp.Integer(0)),
        (t_l, l * g),
        (t_h, h * g),
        (t_h - t_l, physics.difference_of_moving_masses(l, h, 0, g)),
        (
            physics.gripping_ratio_minus_1(l, h, c, b, sp.Integer(1)),
            physics.gripping_ratio_minus_1(l, h, c, b, zero),
        ),
    ]
    for value, limit in limits:
        assert sp.simplify(sp.limit(value, c, sp.oo) - limit) == 0


def test_heaviest_mass_is_the_limit() -> None:
    ratio = sp.limit(physics.gripping_ratio_minus_1(l, h, c, b, sp.Integer(1)), h, sp.oo)
    assert sp.simplify(ratio - physics.heaviest_ratio_minus_1(l, c, b)) == 0


def test_they_undo_the_fall_and_the_slide() -> None:
    H, a, R = sp.symbols("H a R", positive=True)
    # Constant acceleration: H = a t²/2 and v = a t.
    t, v = physics.fall_time(H, a, sp.sqrt), physics.final_speed(H, a, sp.sqrt)
    assert sp.simplify(a * t**2 / 2 - H) == 0
    assert sp.simplify(v - a * t) == 0
    assert sp.simplify(physics.acceleration_of_fall(H, t) - a) == 0
    z = physics.friction_at_limit(l, k_minus_1)
    slide = physics.acceleration(physics.drive(l, h, z), physics.load(l, h, z), g)
    assert sp.simplify(physics.slide_ratio_minus_1(l, h, slide, g) - k_minus_1) == 0
    # A disk: I = M R²/2, c = M/2.
    assert physics.moment_of_inertia(c, R) == c * R**2
