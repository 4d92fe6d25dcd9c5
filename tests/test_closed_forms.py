"""The equations against what they come from: SymPy on the closed forms."""

from typing import Any

import pytest

from atwood_cli.solver import physics

pytest.importorskip("sympy", reason="needs sympy, which knows the closed forms")

import sympy as sp

l, h, c, b, g, mu, phi, t1, t2, beta = sp.symbols("l h c b g mu phi T1 T2 beta", positive=True)
theta, r, s, stuck, A, H, R = sp.symbols("theta r s delta A H R", positive=True)
zero, one, half = sp.Integer(0), sp.Integer(1), sp.Rational(1, 2)
k = sp.exp(mu * phi)
z = l * (k - 1)


def differing(forms: dict[str, tuple[Any, Any]]) -> list[str]:
    """The names of equations whose value, or vector, is not what it must be."""
    pairs = {name: [sp.Matrix([side]) for side in sides] for name, sides in forms.items()}
    return [name for name, (value, wanted) in pairs.items() if not sp.simplify(value - wanted).is_zero_matrix]


def test_motion_and_its_limits() -> None:
    a = physics.acceleration(h - l, physics.load(l, h, c), g)
    light = physics.light_tension(l, a, g)
    heavy = light + physics.difference_of_a_pulley(c, a, zero)
    grip = physics.gripping_ratio_minus_1(l, h, c, b, one)
    slide = physics.acceleration(physics.drive(l, h, z), physics.load(l, h, z), g)
    at_rest = physics.difference_of_moving_masses(l, h, 0, g)
    fall = physics.fall_time(H, A, sp.sqrt)
    paper = [(h - l) * g, (2 * h + c) * l * g, (2 * l + c) * h * g]
    forms = {
        "(4)": ([a, light, heavy], [one / (l + h + c) for one in paper]),
        "locked": ([sp.limit(x, c, sp.oo) for x in (a, light, heavy, heavy - light)], [0, l * g, h * g, at_rest]),
        "locked ratio": (sp.limit(grip, c, sp.oo), physics.gripping_ratio_minus_1(l, h, c, b, zero)),
        "heaviest ratio": (sp.limit(grip, h, sp.oo), physics.heaviest_ratio_minus_1(l, c, b)),
        "k of a slide": (physics.slide_ratio_minus_1(l, h, slide, g), k - 1),
        "H = a t²/2": (A * fall**2 / 2, H),
        "v = a t": (physics.final_speed(H, A, sp.sqrt), A * fall),
        "a = 2 H/t²": (physics.acceleration_of_fall(H, fall), A),
        "I = c R²": (physics.moment_of_inertia(c, R), c * R**2),
        "c = I/R²": (physics.inertia_at_rim(c * R**2, R), c),
    }  # fmt: skip
    assert not differing(forms)


def test_verge_and_critical_masses() -> None:
    critical = physics.critical_pulley_mass(l, h, z, physics.drive(l, h, z), beta, zero)
    heavier = physics.critical_heavier_mass(l, c, z, zero)
    least = physics.least_pulley_mass(z, beta, zero)
    forms = {
        "(26)": (sp.exp(physics.verge_coefficient(sp.log(r), phi) * phi), r),
        "(33)": (((2 * l + c) * h / ((2 * h + c) * l)).subs(c, beta * critical), k),
        "(34)": (critical.subs(beta, half), 4 * l * h * (k - 1) / (h - l * k)),
        # Conditions (36) are where (34) and (35) diverge.
        "(36), heavier mass": (sp.simplify(1 / critical).subs(h, physics.least_heavier_mass(l, z)), 0),
        "(36), pulley mass": ((1 / heavier).subs(c, beta * least), 0),
    }
    assert not differing(forms)


def test_forces_on_the_pulley_are_the_integrals_along_the_arc() -> None:
    """Per radian: dT/dθ along the tangent (-sin, cos), (6), (12), and T inwards (13), on a stuck arc too."""
    tension = t1 * sp.exp(mu * theta)
    inwards, tangent = (
        sp.Matrix([[-sp.cos(theta), -sp.sin(theta)]]),
        sp.Matrix([[-sp.sin(theta), sp.cos(theta)]]),
    )

    def integral(density: Any) -> Any:
        return sp.integrate(density, (theta, 0, phi))

    end = [(tension * x).subs(theta, phi) for x in (sp.cos(theta), sp.sin(theta))]
    dx, dy = end[0] - t1, end[1]
    friction, normal = physics.friction_vector(mu, dx, dy), physics.normal_vector(mu, dx, dy)
    both = physics.resultant_vector(dx, dy)
    forms = {
        "(28)": (friction, integral(tangent * mu * tension)),
        "(18)": (normal, integral(inwards * tension)),
        "(18), stuck": (physics.normal_vector(zero, dx.subs(mu, 0), dy.subs(mu, 0)), integral(inwards * t1)),
        "(19)": ([sum(axis) for axis in zip(friction, normal, strict=True)], both),
        "(20)": ([x.subs(phi, sp.pi) for x in both], [0, -t1 - t1 * sp.exp(mu * sp.pi)]),
        "mirrored": (
            physics.mirrored(sp.cos(theta), sp.sin(theta), sp.cos(phi), sp.sin(phi)),
            [sp.cos(phi - theta), sp.sin(phi - theta)],
        ),
    }
    assert not differing(forms)


def test_the_magnitude_is_that_of_the_vector() -> None:
    both = physics.resultant(t1, t2, t2 - t1, sp.sin(phi / 2), sp.sqrt)
    square = physics.friction_magnitude(mu, both, sp.sqrt) ** 2
    x, y = physics.friction_vector(mu, t2 * sp.cos(phi) - t1, t2 * sp.sin(phi))
    paper = -mu * (t1 + t2) / (1 + mu**2)
    forms = {
        "resultant": (sp.expand_trig(both**2 - t1**2 - t2**2 + 2 * t1 * t2 * sp.cos(phi)), 0),
        "friction": (square - x**2 - y**2, 0),
        "(31)": ([x.subs(phi, sp.pi), y.subs(phi, sp.pi)], [paper, mu * paper]),
        "(32)": (square.subs(phi, sp.pi), mu**2 / (1 + mu**2) * (t1 + t2) ** 2),
    }
    assert not differing(forms)


def test_least_friction_slope_is_the_derivative_of_the_friction() -> None:
    dx, dy = t2 * sp.cos(phi) - t1, t2 * sp.sin(phi)
    bridge = t1 * sp.exp((mu + sp.I) * s) * (1 - sp.exp(sp.I * stuck))
    x, y = sp.re(sp.expand_complex(bridge)) + dx, sp.im(sp.expand_complex(bridge)) + dy
    at, chord = s + stuck / 2, 2 * t1 * sp.sin(stuck / 2)
    slope = physics.least_friction_slope(mu, chord, sp.exp(mu * s), sp.cos(at), sp.sin(at), dx, dy)
    square = sp.diff(x**2 + y**2, s) / 2
    values = {t1: 2, t2: 7, mu: sp.Rational(3, 10), s: sp.Rational(4, 5), stuck: sp.Rational(1, 3), phi: 3}
    assert abs(sp.N((square - slope * chord * sp.exp(mu * s)).subs(values), 60)) < 1e-50
