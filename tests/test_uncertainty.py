"""Standard uncertainties: how they are typed, propagated, shown, and what is refused."""

import csv
import io
import json
import re
import subprocess
import sys
from collections import Counter
from collections.abc import Mapping
from decimal import Decimal
from fractions import Fraction
from math import exp, hypot, inf, pi, sqrt
from random import Random
from typing import Any

import flint
import mpmath
import pytest
import sympy as sp

from atwood_cli import SceneError, solve
from atwood_cli.arithmetic import interval, rounding
from atwood_cli.arithmetic.rounding import to_digits, to_place, with_uncertainty
from atwood_cli.model.angle import Angle
from atwood_cli.model.quantities import MEASURED_NAMES, NAMES
from atwood_cli.model.scene import Scene, read_input
from atwood_cli.solver.answers import Answers
from atwood_cli.solver.reading import read_answers

from . import oracle
from .conftest import many
from .running import Atwood, on_terminal, plain, process
from .scenes import FAMILIES, of_all_kinds, scenes

UNCERTAIN = ["solve", "--m1", "1.000(2)", "--m2", "3+/-0.01", "--M", "10"]


def inputs(words: str) -> dict[str, str]:
    """The inputs in "m1=1 m2=3"."""
    return dict(word.split("=") for word in words.split())


def uncertain(given: Mapping[str, str], digits: int | None = None) -> Answers:
    return read_answers(given, digits)


# How they are typed


# fmt: off
TEXTS: dict[str, tuple[str | int, str | int]] = {
    "1.000(2)": (1, "0.002"), "1.00(12)": (1, "0.12"), "1.5(2)e-3": ("0.0015", "0.0002"), "1.5(234)": ("1.5", "23.4"),
    ".5(1)": ("0.5", "0.1"), "250(1)": (250, 1), "250.0(5)g": ("0.25", "0.0005"), "250.0(5) g": ("0.25", "0.0005"),
    "1.000±0.002": (1, "0.002"), "1.000+/-0.002": (1, "0.002"), "1 ± .5": (1, "0.5"), "1e-3±2e-5": ("0.001", "0.00002"),
    **dict.fromkeys(["250±1g", "250±1 g", "250 g ± 1 g", "(250±1)g", "(250 +/- 1) g"], ("0.25", "0.001")),
    **dict.fromkeys(["250g±1%", "(250±1%)g", "250 g +/- 1 %", "250g±10E-1%"], ("0.25", "0.0025")),
    "(2.5±0.1)e-1kg": ("0.25", "0.01"), "1/3±1/30": ("1/3", "1/30"), "1/3g±3%": ("1/3000", "1e-5"),
    "0(1)": (0, 1), "1.000": (1, 0), "1.000(0)": (1, 0), "1±0": (1, 0),
}
# fmt: on


@pytest.mark.parametrize("text", TEXTS)
def test_text(text: str) -> None:
    assert read_input("m1", text) == (*(Fraction(x) for x in TEXTS[text]), text)


def test_angles_stay_in_their_unit() -> None:
    radians, turns = (read_input("wrap", typed) for typed in ("3.14(2)rad", "0.5±0.01turn"))
    assert radians[:2] == (Angle(Fraction("3.14"), "rad"), Fraction("0.02"))
    assert turns[:2] == (Angle(Fraction(180)), Fraction("3.6"))
    assert radians.value != Fraction("3.14")


FORMS = "is not a number with its uncertainty; write it like 1.000±0.002, 1.000+/-0.002 or 1.000(2), and a unit after that"
# fmt: off
NO_NUMBERS = [
    "1.0(0.2)", "1.0()", "(1.0)", "1±", "±1", "1±-1", "1±1±1", "1.0(2)(3)", "1 (2)", "1.0(2", "1g±1", "1kg±1g",
    "inf±1", "1±inf", "(1e3±1)", "1,5±1", "1%±1", "1±%", "sin(1)",
]
# fmt: on
REFUSED = {
    **{f"m1 {bad}": FORMS for bad in NO_NUMBERS},
    "g moon±0.1": FORMS,
    "m1 -1.0(2)": "must be 0 or more, and finite",
    "g 0±1": "must be above 0, and finite",
    "m1 1.0(2)kgg": "has the unknown unit 'kgg'; did you mean kg?",
    "mu 0.30(1)kg": "must be a plain number, without the 'kg'",
    "m1 1±1e501": "has an exponent beyond 500 in magnitude",
    "mu_k 0.40(1)": "must not be above mu; exactly, 0.4 > 0.3",
}


@pytest.mark.parametrize("typed", REFUSED)
def test_errors_say_what_was_typed(typed: str) -> None:
    name, _, value = typed.partition(" ")
    with pytest.raises(SceneError) as caught:
        solve(**{"m1": "1", "m2": "3", "mu": "0.30(1)", name: value})
    assert str(caught.value) == f"{name} {value!r} {REFUSED[typed]}"


@pytest.mark.parametrize(
    "arguments", ["contact --m1 1.0(2) --m2 3", "sweep --m1 1.0(2) --m2 3 --M 1:2:3", "batch -"]
)
def test_only_solve_takes_them(arguments: str, atwood: Atwood) -> None:
    rule = "'1.0(2)' carries an uncertainty, which only solve takes; give the value alone"
    if arguments == "batch -":
        ran = process(shell="printf 'm1,m2\\n1.0(2),3\\n' | atwood batch - --only regime")
        assert ran.out == f'm1,m2,regime,error\n1.0(2),3,,"m1 {rule}"\n'
        return
    ran = atwood(*arguments.split())
    assert (ran.status, ran.out, ran.err) == (2, "", f"atwood: --m1 {rule}\n")


# Against derivatives by hand, by mpmath and by SymPy where doubles have nothing left


def test_a_wrap_in_radians_has_its_uncertainty_in_radians() -> None:
    """l e^{μφ} has the slopes μ and φ times itself."""
    found = uncertain(inputs("m1=2 m2=30 mu=0.3±0.01 wrap=3±0.05rad"))
    u = 2 * exp(0.9) * hypot(0.3 * 0.05, 3 * 0.01)
    assert found.uncertainty("least_heavier_mass") == pytest.approx(u, rel=1e-15)
    assert found.budget("least_heavier_mass") == {"mu": pytest.approx(80), "wrap": pytest.approx(20)}


def test_kinetic_friction_that_is_not_given_follows_the_static() -> None:
    slipping = {"m1": "1", "m2": "3", "M": "100", "mu": "0.25(2)"}
    alone = uncertain(slipping, 50).uncertainty("acceleration")
    twin = uncertain(slipping | {"mu": "0.25", "mu_k": "0.25(2)"}, 50).uncertainty("acceleration")
    assert alone == twin != 0
    assert uncertain(slipping | {"mu_k": "0.25"}, 50).uncertainty("acceleration") == 0


def test_the_least_friction_force_against_mpmath() -> None:
    """The least over s of |T_l e^{(μ+i)s} (1 - e^{iδ}) + T_h e^{iφ} - T_l|, differentiated numerically."""
    with mpmath.workdps(60):

        def least(m1: Any, M: Any, mu: Any) -> Any:
            g, m2, phi = mpmath.mpf("9.80665"), mpmath.mpf(3), mpmath.mpf(150) / 180 * mpmath.pi
            a = g * (m2 - m1) / (m1 + m2 + M / 2)
            light, heavy = m1 * (g + a), m2 * (g - a)
            alpha = mpmath.log(heavy / light) / mu
            stuck = 1 - mpmath.expj(phi - alpha)

            def force(s: Any) -> Any:
                return abs(light * mpmath.exp((mu + 1j) * s) * stuck + heavy * mpmath.expj(phi) - light)

            s = mpmath.findroot(lambda s: mpmath.diff(force, s), alpha / 2)
            return mu / mpmath.sqrt(1 + mu**2) * force(s)

        at, us = (mpmath.mpf(1), mpmath.mpf(10), mpmath.mpf("0.3")), ("0.002", "0.1", "0.01")
        gradient = [mpmath.diff(least, at, n=tuple(int(i == j) for j in range(3))) for i in range(3)]
        u = mpmath.sqrt(sum((d * mpmath.mpf(u)) ** 2 for d, u in zip(gradient, us, strict=True)))
    solution = solve(m1="1±0.002", m2="3", M="10±0.1", mu="0.3±0.01", wrap="150")
    assert solution.uncertainty["friction_force_min"] == pytest.approx(float(u), rel=1e-14)


l, h, M, mu, g = sp.symbols("l h M mu g", positive=True)
GRIP = g * (h - l) / (l + h + M / 2)
SLIP = g * (h - l * sp.exp(mu * sp.pi)) / (h + l * sp.exp(mu * sp.pi))
VERGE = sp.log(h * (g - GRIP) / (l * (g + GRIP))) / sp.pi
CRITICAL = 4 * l * h * (sp.exp(mu * sp.pi) - 1) / (h - l * sp.exp(mu * sp.pi))
SYMBOLS = {"m1": l, "m2": h, "M": M, "mu": mu, "g": g}


def by_sympy(formula: sp.Expr, values: dict[str, str], us: dict[str, str]) -> float:
    at = {SYMBOLS[name]: sp.Rational(Fraction(v)) for name, v in {"g": "9.80665", **values}.items()}
    parts = [formula.diff(SYMBOLS[name]).subs(at) * sp.Rational(Fraction(u)) for name, u in us.items()]
    with mpmath.workdps(30):
        return float(mpmath.sqrt(sum(mpmath.mpf(sp.N(part, 30, maxn=5000)) ** 2 for part in parts)))


def critical_mass(digits: int) -> str:
    return str(solve(m1="1", m2="3", mu="0.3", digits=digits).critical_pulley_mass)


K = str(solve(m1="1", m2="3", mu="0.3", digits=60).least_heavier_mass)
BEYOND_K = f"{K[:40]}{int(K[40]) + 1}"  # about 1e-40 above, and not 9 there


EXTREMES: list[tuple[str, sp.Expr, str, str]] = [
    # Nearly equal masses: the kink is 1e-30, 1e-90 and 1e-300 away.
    *(("mu_verge", VERGE, f"m1=1 m2=1.{'0' * zeros}1 M=10", "m1=0.002 M=1") for zeros in (29, 89, 299)),
    ("acceleration", GRIP, f"m1=1 m2=1.{'0' * 99}1 M=10", "M=1"),
    # Nearly critical: the drive is 1e-40 of the masses, and the verge 1e-60 and 1e-150 away.
    ("critical_pulley_mass", CRITICAL, f"m1=1 m2={BEYOND_K} mu=0.3", "mu=0.01 m2=0.1"),
    *(
        ("acceleration", formula, f"m1=1 m2=3 mu=0.3 M={critical_mass(digits)[:-2]}{more}", "M=1 mu=0.01")
        for digits in (60, 150)
        for formula, more in ((GRIP, ""), (SLIP, "99"))
    ),
    # Of scales far apart, and uncertainties far above and below what they are of.
    ("mu_verge", VERGE, "m1=1 m2=3 M=1e-200", "m1=0.01 M=1e-3"),
    ("mu_verge", VERGE, "m1=1 m2=3 M=10", "M=1e-300"),
    ("acceleration", SLIP, "m1=1 m2=3 M=10 mu=1e-100", "mu=1e-101"),
    ("acceleration", GRIP, "m1=1e-200 m2=3e-200 M=1", "m1=1e-202"),
]


@pytest.mark.parametrize(("name", "formula", "values", "us"), EXTREMES)
def test_extremes_against_sympy(name: str, formula: sp.Expr, values: str, us: str) -> None:
    given, u = inputs(values), inputs(us)
    found = uncertain(given | {x: f"{given[x]}±{u[x]}" for x in u}).uncertainty(name)
    assert found == pytest.approx(by_sympy(formula, given, u), rel=1e-15)


@pytest.mark.parametrize("family", FAMILIES)
def test_every_family_against_flint(family: str) -> None:
    """The oracle's own formulas, stepped by 10^-500 with 2,000 digits; every input to 1 %."""
    compared = 0
    for given in scenes(family, many(30)):
        scene = Scene.read(given)
        numbers = scene._asdict() | {"wrap": scene.wrap.number}
        moving = {x: numbers[x] for x in given if numbers[x] != inf}
        found = Answers(scene, 25, uncertain={x: v / 100 for x, v in moving.items()})
        variances: dict[str, Any] = {}
        squares: dict[tuple[str, str], Any] = {}
        for x, v in moving.items():
            moved = (v + v * step for step in (TINY, -TINY))
            stepped: list[Any] = [Angle(number) if x == "wrap" else number for number in moved]
            right, left = (oracle.expected(scene._replace(**{x: number})) for number in stepped)
            flint.ctx.prec = 7000
            for name in CLOSED:
                if right[name] is None or left[name] is None:
                    variances[name] = None
                elif variances.get(name, 0) is not None:
                    slope = (as_ball(right[name]) - as_ball(left[name])) / oracle.ball(TINY) / 200
                    squares[name, x] = slope * slope
                    variances[name] = variances.get(name, 0) + slope * slope
        for name, variance in variances.items():
            u = found.uncertainty(name)
            if (
                u is None or variance is None
            ):  # of what has no value there or beside, or one too large or too small to be written
                assert u is None, (given, name)
                huge = flint.arb(10) ** 10**7
                assert variance is None or not (1 / huge < variance < huge), (given, name)
            else:
                want = abs(variance).sqrt()
                assert abs(flint.arb(str(u)) - want) <= want / 10**18 + oracle.ball(TINY), (given, name)
                for x, share in found.budget(name).items():
                    part = flint.arb(str(share)) / 100 - squares[name, x] / variance
                    assert abs(part) < 1e-18, (given, name, x)
                compared += 1
    assert compared > many(200)


def as_ball(value: oracle.Value) -> flint.arb:
    return oracle.ball(value) if isinstance(value, Fraction) else value()


TINY = Fraction(1, 10**500)
CLOSED = [name for name in NAMES[1:] if name not in ("friction_force_min", "friction_force_max")]


# Ends of domains, kinks, and values that are not there nearby


def test_at_the_end_of_a_domain_the_slope_is_that_inside() -> None:
    solution = solve(m1="1", m2="3", M="0±0.1")
    # c = M/2: a = 2 g/(4 + c), and ln(T2/T1) grows by c (h - l)/(2 l h).
    assert solution.uncertainty["acceleration"] == pytest.approx(9.80665 * 2 / 16 * 0.05, rel=1e-15)
    assert solution.uncertainty["mu_verge"] == pytest.approx(0.05 / 3 / pi, rel=1e-15)
    frictionless = solve(m1="1", m2="3", M="10", mu="0±0.01")
    # a = g (3 - k)/(3 + k) at k = 1.
    assert frictionless.uncertainty["acceleration"] == pytest.approx(9.80665 * 6 / 16 * pi * 0.01, rel=1e-15)


def test_a_slope_that_vanishes_is_zero() -> None:
    assert solve(m1="1", m2="3", M="0±0.1").uncertainty["friction_force_y"] == 0  # as mu_verge squared
    assert solve(m1="1", m2="3", M="10±1").uncertainty["critical_pulley_mass"] is None
    assert solve(m1="1", m2="3", M="10±1", mu="0.3").uncertainty["critical_pulley_mass"] == 0


MOVABLE = {
    "no-slip": "m1=1 m2=2 M=5 mu=0.3 g=9.8 inertia=0.5 R=0.3 drop=1.7",
    "assumed": "m1=1 m2=2 M=5 g=9.8 inertia=0.5",
    "verge": "m1=1 m2=3 mu=0.2 g=9.8 inertia=0.5",
    "slip": "m1=3 m2=1 M=90 mu=0.2 mu_k=0.1 g=9.8 inertia=0.5 R=0.3 drop=1.7",
    "locked": "m1=1 m2=2 M=inf mu=0.4 g=9.8",
    "axle": "m1=1 m2=2 M=5 mu=0.4 g=9.8 inertia=0.5 axle=1",
    "axle that holds": "m1=1 m2=2 M=5 mu=0.4 g=9.8 axle=20",
    "axle in slip": "m1=1 m2=3 M=50 mu=0.1 g=9.8 axle=1",
    "M from a": "m1=1 m2=2 a=1 g=9.8 inertia=0.5 axle=1 drop=1.7",
    "g from a": "m1=1 m2=2 a=1 M=5 inertia=0.5 axle=1 drop=1.7",
    "m1 from a": "m2=2 a=1 M=5 g=9.8 inertia=0.5 drop=1.7",
    "mu_k from a": "m1=1 m2=3 a=2 M=50 mu=0.3 g=9.8 axle=1 drop=1.7",
    "a from time": "m1=1 m2=2 time=2 drop=1.7 g=9.8",
}


@pytest.mark.parametrize("wrap", ["180", "175"])
@pytest.mark.parametrize("name", MOVABLE)
def test_what_does_not_depend_on_an_input_is_certain_at_once(
    name: str, wrap: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Was searched for in ever more digits: friction_force_max does not depend on the wrap."""
    precisions = []

    def enclosures(digits: int) -> interval.Enclosures:
        precisions.append(digits)
        return interval.enclosures(digits)

    monkeypatch.setattr(rounding, "enclosures", enclosures)
    given = inputs(f"{MOVABLE[name]} wrap={wrap}")
    for x in given.keys() - ({"M"} if given.get("M") == "inf" else set()):
        answers = uncertain({**given, x: f"{given[x]}±0.0001"})
        found = {one: answers.uncertainty(one) for one in answers.names[1:]}
        here, beside = (
            uncertain(given, 30),
            uncertain({**given, x: f"{Decimal(given[x]) + Decimal('1e-9')}"}, 30),
        )
        for one, u in found.items():
            if u is not None:
                assert (u > 0) == (here[one] != beside[one]), (x, one)
    assert 17 < max(precisions) <= 6050


def test_equal_masses_have_slopes_where_no_friction_is_needed() -> None:
    found = solve(m1="1.00(2)", m2="1", M="10").uncertainty
    assert found["acceleration"] == pytest.approx(9.80665 / 7 * 0.02, rel=1e-15)
    assert found["friction_force_y"] == 0


OTHER_WRAP = "unknown, as with another wrap it may have no value:"
NOT_SHOWN = {
    "m1=1.00(2) m2=1 M=10": "u_mu_verge, u_tension_ratio, u_friction_force: unknown where the masses are equal, as there it has a kink.",
    # A massless rim moves with the string; one of any mass rests, without friction.
    "M=0±0.1 mu=0±0.01": "u_rim_acceleration, u_critical_lighter_mass: unknown, as with another M it may jump.",
    "M=10 wrap=180±2": f"u_axle_force: {OTHER_WRAP} defined for half a turn of wrap (and whole turns more), where both ends pull downwards.",
    "M=10 mu=0.3 wrap=180±2": f"u_friction_force_min, u_friction_force_max: {OTHER_WRAP} bounds are known for up to half a turn of wrap (180 degrees).",
    "m2=1 M=10±1e-400 g=1e-300": "u_axle_force: not 0 but below the range of doubles; ask for digits (--digits 17) to see it.",
    "M=10 R=1±1e400": "u_torque, u_angular_acceleration: beyond the range of doubles; ask for digits (--digits 17) to see it.",
}


@pytest.mark.parametrize("given", NOT_SHOWN)
def test_why_no_uncertainty_is_shown(given: str) -> None:
    solution = solve(**{"m1": "1", "m2": "3", **inputs(given)})
    names = re.findall(r"u_(\w+)", NOT_SHOWN[given].partition(":")[0])
    assert NOT_SHOWN[given] in solution.notes
    assert None not in [getattr(solution, name) for name in names]
    assert all(solution.uncertainty[name] in (None, 0, inf) for name in names)


def test_no_bend_is_too_near() -> None:
    mass = critical_mass(900)
    found = uncertain({"m1": "1", "m2": "3", "mu": "0.3", "M": f"{mass}±1"}).uncertainty("acceleration")
    slips = solve(m1="1", m2="3", mu="0.3", M=mass).regime == "slip"
    want = 0.0 if slips else by_sympy(GRIP, {"m1": "1", "m2": "3", "M": mass}, {"M": "1"})
    assert found == pytest.approx(want, rel=1e-15)


@pytest.mark.parametrize("wrap", ["180", "120", "90", "17.5"])
def test_friction_beside_a_pulley_without_mass_is_one_sided(wrap: str) -> None:
    """By a pulley of 1e-30 kg, whose greatest friction is μTα with little in the second order."""
    greatest = {"m1": "1", "m2": "3", "mu": "0.3", "wrap": wrap}
    light = solve(**greatest, M="1e-30", digits=25)
    beside = solve(**greatest, M="0±1e-30", digits=25)
    assert light.friction_force_max is not None
    assert light.friction_force_min is not None
    for name in ("friction_force_max", "friction_force_min"):
        here = float(getattr(light, name))
        assert float(beside.uncertainty[name] or 0) == pytest.approx(here, rel=1e-14, abs=1e-50), name


# What only exact slopes tell


def test_as_many_digits_as_are_asked_for() -> None:
    """Was padded with zeros after 60 digits."""
    given = {"m1": "1.0(1)", "m2": "3", "M": "10", "mu": "0.3"}
    u = solve(**given, digits=90).uncertainty["acceleration"]
    # a = g (m2 - m1)/(m1 + m2 + 5), so its slope with m1 is -g (2 m2 + 5)/81.
    assert u == to_digits(90)(Fraction("9.80665") * 11 / 81 / 10)


def test_digits_near_a_pole() -> None:
    """Was wrong from the 21st digit on."""
    near = "2.56633239520813532093526000909794720888329416"
    u = solve(m1="1", mu="0.3", m2=f"{near}±1e-33", digits=30).uncertainty["critical_pulley_mass"]
    at = {l: 1, mu: sp.Rational(3, 10), h: sp.Rational(Fraction(near))}
    slope = -sp.N(CRITICAL.diff(h).subs(at), 45, maxn=5000)
    assert u == Decimal(str(sp.N(slope * sp.Rational(1, 10**33), 30)))


def test_a_slope_however_small_is_not_zero() -> None:
    """Was 0: friction needs so little of the string that its limit hardly matters."""
    given = {"m1": "0.04434406290011144", "m2": "0.0289", "M": "3.3544806468431964e-84"}
    found = solve(**given, mu="0.23315545203923707(2)", digits=20)
    u = found.uncertainty["friction_force_max"]
    # The greatest is μ/√(1+μ²) |T_h e^{iα} - T_l|, with α = ln(T_h/T_l)/μ.
    with mpmath.workdps(700):
        one, two, M = (mpmath.mpf(text) for text in given.values())
        a = mpmath.mpf("9.80665") * (one - two) / (one + two + M / 2)
        light, heavy = two * (mpmath.mpf("9.80665") + a), one * (mpmath.mpf("9.80665") - a)

        def greatest(mu: Any) -> Any:
            alpha = mpmath.log(heavy / light) / mu
            return mu / mpmath.sqrt(1 + mu**2) * abs(heavy * mpmath.expj(alpha) - light)

        slope = mpmath.diff(greatest, mpmath.mpf("0.23315545203923707"), h=mpmath.mpf(10) ** -100)
        assert float(u or 0) == pytest.approx(float(abs(slope) * mpmath.mpf("2e-17")), rel=1e-15)


HOSTILE = {"m1": "1e500", "m2": "3e500", "M": "1e-500", "mu": "1e-500", "R": "1e500", "g": "1e500"}


@pytest.mark.parametrize(
    "given",
    [
        {"m1": "13.36", "m2": "1e-500", "M": "1.79", "R": "710", "wrap": "1e-5", "mu": "4.01e500±1e-500"},
        {"m1": "0.115", "m2": "9.9766", "mu": "0.104438", "M": "0±0.00508", "mu_k": "0±0.0048"},
        {x: f"{v}±1e-500" for x, v in {**HOSTILE, "inertia": "1e-500", "wrap": "1e-500"}.items()},
        {x: f"{v}±1e500" for x, v in {**HOSTILE, "inertia": "1e500", "wrap": "1e500"}.items()},
    ],
)
def test_hostile_uncertainties_come_to_an_end(given: dict[str, str]) -> None:
    """Took up to 53 s."""
    solution = solve(**given, digits=17)
    assert all(value is None or not value < 0 for value in solution.uncertainty.values())
    assert solution.uncertainty["acceleration"] is not None


def test_shares_that_are_rational() -> None:
    """k = e^{μφ} grows alike with the relative errors of both, whatever it is."""
    both = {"m1": "1", "m2": "3", "mu": "0.30±0.03", "wrap": "180±18"}
    assert uncertain(both, 1).budget("least_heavier_mass") == {"mu": 50, "wrap": 50}
    assert uncertain(both | {"wrap": "180"}).budget("least_heavier_mass") == {"mu": 100}


SLIPS, CRITICAL_PULLEY = "Whether the string slips", "Whether there is a critical_pulley_mass"
DOUBTS = {
    "m1=1.00(1) m2=1.02(1)": "Which mass is heavier is in doubt: m2 - m1 = 0.020 ± 0.014 kg",
    "m1=1.00(1) m2=1.03(1)": "",
    "M=10 mu=0.21(1)": f"{SLIPS} is in doubt: mu - mu_verge = 0.004 ± 0.010",
    "M=10 mu=0.20(1)": f"{SLIPS} is in doubt: mu - mu_verge = -0.006 ± 0.010",
    "M=10 mu=0.23(1)": "",
    "M=10(1) mu=0.22": f"{SLIPS} is in doubt: mu - mu_verge = 0.0142 ± 0.0083",
    "M=10(1) mu=0.25": "",
    "M=10(1)": "",
    "mu=0.35(1)": "Whether any pulley can make the string slip is in doubt: mu - mu_verge of a locked pulley = 0.000 ± 0.010",
    "m1=1.0(5) m2=1 M=10 mu=0.1": f"{SLIPS} is in doubt: mu - mu_verge = 0.10 ± 0.11",
    "mu=0.30(1) m1=1(1)e-40 m2=1": "",
    # Equal masses rest on any axle: this one was taken to move, and nothing was settled.
    "m2=1.00(1) M=1 mu=0.2 axle=30": "Which mass is heavier is in doubt: m2 - m1 = 0.000 ± 0.010 kg",
    # What exists only if something can make the string slip: the first mass is 2.57 ± 0.13 away.
    "m1=1.00(5) m2=2.5 M=10 mu=0.3": f"{CRITICAL_PULLEY} is in doubt: mu - mu_verge of a locked pulley = 0.008 ± 0.016",
    "m1=1.00(5) m2=2.6 M=10 mu=0.3": f"{CRITICAL_PULLEY} is in doubt: mu - mu_verge of a locked pulley = -0.004 ± 0.016",
    "m1=1.00(1) M=6.3(1) mu=0.3": "Whether there is a critical_heavier_mass is in doubt: mu - mu_verge under a heavier mass beyond all bounds = -0.0011 ± 0.0037",
}


@pytest.mark.parametrize("given", DOUBTS)
def test_what_is_in_doubt_is_said(given: str) -> None:
    notes = [note for note in solve(**{"m1": "1", "m2": "3", **inputs(given)}).notes if "in doubt" in note]
    within = " is within 2 standard uncertainties of 0 (95 % of a normal distribution). The results are for the inputs as given."
    assert all(note.endswith(within) for note in notes)
    if words := DOUBTS[given]:
        assert f"{words}{within}" in notes
    else:
        assert not notes


MISLED = {
    "M=20(15)": "M is too uncertain for first order: as it goes from 5 kg to 35 kg, acceleration goes from 3.02 m/s² to 0.91 m/s², tension_1 from 12.82 N to 10.72 N, tension_2 from 20.4 N to 26.7 N, and so on for 6 more.",
    "M=20(2)": "",
    "m1=1.00(1) m2=3.00(1) M=10.0(1) g=9.81(1) R=0.100(1)": "",
    # below 0, which no mass is
    "M=2(3)": "M is too uncertain for first order: as it goes from 0 kg to 5 kg, acceleration goes from 4.9 m/s² to 3.0 m/s², tension_1 from 14.7 N to 12.8 N, tension_2 from 14.7 N to 20.4 N, and so on for 7 more.",
    # the string slips at one end
    "M=10 mu=0.21(2) R=1": "mu is too uncertain for first order: as it goes from 0.19 to 0.23, acceleration goes from 2.40971 m/s² to 2.17926 m/s², tension_1 from 12.2164 N to 11.9859 N, tension_2 from 22.1908 N to 22.8822 N, and so on for 7 more.",
    # no pulley makes it slip at the other
    "mu=0.34(2)": "mu is too uncertain for first order: as it goes from 0.32 to 0.36, acceleration goes from 0.46 m/s² to no value, tension_1 from 10.26 N to no value, tension_2 from 28.05 N to no value, and so on for 10 more.",
    "M=3 wrap=2.0(9)rad": "wrap is too uncertain for first order: as it goes from 1.1 rad to 2.9 rad, mu_verge goes from 0.306 to 0.116, friction_force_x from -2.79 N to -3.67 N.",
    "m1=55g m2=60g R=5cm a=0.40+/-0.04": "a is too uncertain for first order: not every value from 0.36 m/s² to 0.44 m/s² is possible.",
}


@pytest.mark.parametrize("given", MISLED)
def test_where_first_order_misleads_the_values_are_said(given: str) -> None:
    notes = solve(**{"m1": "1", "m2": "3", **inputs(given)}).notes
    assert [note for note in notes if "first order" in note] == [MISLED[given]] * bool(MISLED[given])


def test_where_first_order_misleads_is_where_solve_says_otherwise_an_uncertainty_off() -> None:
    """Tried on scenes of all kinds, each input an uncertainty more and less, with no help but `solve`."""
    rng, seen = Random(5), Counter[int]()
    for exact in of_all_kinds(many(60)):
        given = {
            x: value
            for x, value in exact.items()
            if value not in ("hoop", "shell", "moon", "inf", "1.6e-300")
        }
        for x in {*given} - {"wrap", "axle"}:
            u = Fraction(given[x]) * Fraction(10 ** rng.uniform(-2, -0.1)).limit_denominator(100)
            if not u:
                continue
            here = solve(**{**exact, x: f"{exact[x]}±{float(u)!r}"}, digits=30)
            u = read_input(x, f"1±{float(u)!r}").uncertainty
            numbers = [clamped(exact, x, Fraction(exact[x]) + side) for side in (-u, u)]
            off: list[dict[str, Any]] = [{**exact, x: number} for number in numbers]
            ends = [solve(**given_, digits=30) for given_ in off]
            far = [name for name in NAMES[1:] if is_far(here, ends, name)]
            notes = [note for note in here.notes if "first order" in note]
            assert len(notes) == bool(far), (exact, x, u, far)
            named = re.findall(r"(\w+) (?:goes )?from [^,]* to", notes[0].partition(", ")[2]) if notes else []
            assert named == far[:3], (exact, x, u)
            assert not notes or ("and so on for" in notes[0]) == (len(far) > 3)
            seen[len(far)] += 1
    assert seen[0] > many(50)
    assert sum(seen.values()) > seen[0] + many(50)


def clamped(given: Mapping[str, str], x: str, value: Fraction) -> Fraction:
    """The nearest to a value that an input may be."""
    most = Fraction(given["mu"]) if x == "mu_k" else value
    least = Fraction(given.get("mu_k", 0)) if x == "mu" else Fraction(0)
    return max(least, min(value, most))


def is_far(here: Any, ends: list[Any], name: str) -> bool:
    """Whether a quantity is a fifth of its uncertainty off the line, or has no value an uncertainty off."""
    u, (low, value, high) = here.uncertainty[name], (getattr(at, name) for at in (ends[0], here, ends[1]))
    if u is None or None in (low, high):
        return u is not None
    u = u.copy_sign(high - low)
    return bool(5 * max(abs(high - value - u), abs(value - low - u)) > abs(u) + abs(value) / 10**25)


def test_what_is_in_doubt_beside_what_was_measured() -> None:
    """A pulley without mass was followed to scenes beside it, which none fits, and solve ended in an error."""
    notes = solve(m1="1.0(1)", m2=3, g=10, axle=10, a="2.5").notes
    assert notes[-1].endswith("u_pulley_mass: unknown, as inputs a little different fit no pulley.")
    found = solve(m1="1.0(5)", M=5, g=10, a="0.01(1)").notes  # m2, which is as uncertain as m1
    assert any("m2 - m1 = 0.0045 ± 0.0046 kg is within" in note for note in found)


def test_existence_is_in_doubt_only_of_what_is_asked_for(atwood: Atwood) -> None:
    given = ["solve", "--m1", "1.00(5)", "--m2", "2.6", "--M", "10", "--mu", "0.3"]
    assert "in doubt" not in atwood(*given, "--only", "acceleration").err
    ran = atwood(*given, "--only", "critical_pulley_mass")
    assert ran.err.startswith(
        "atwood: critical_pulley_mass = 500 ± 1900 kg\natwood: Whether there is a critical_pulley_mass is in doubt:"
    )


@pytest.mark.parametrize("typed", ["0.3±0.0125", "0.3±0.125", "0.3±345"])
def test_an_uncertainty_between_two_of_two_digits(typed: str) -> None:
    """Of the margin to the verge it is that of mu, a tie, though the margin is irrational."""
    notes = solve(m1="1", m2="3", M="50", mu=typed).notes
    assert any("Whether the string slips is in doubt" in note for note in notes)


# How they are shown


def test_the_table_ends_values_at_the_second_digit_of_their_uncertainty(atwood: Atwood) -> None:
    ran = atwood(*UNCERTAIN)
    assert (ran.status, ran.err) == (0, "")
    assert ran.out.startswith("m1 = 1.000 ± 0.002 kg, m2 = 3.00 ± 0.01 kg, M = 10 kg, g")
    assert re.search(r"│ acceleration +│ +2\.1793 ± 0\.0089 +│", ran.out)
    assert re.search(r"│ tension_2 +│ +22\.882 ± 0\.051 +│", ran.out)
    assert re.search(r"│ axle_force +│ 132\.935 ± 0\.066 +│", atwood(*UNCERTAIN, "--all").out)


def test_what_has_no_uncertainty_is_shown_with_six_digits(atwood: Atwood) -> None:
    assert re.search(r"│ mu_verge +│ +0 +│", atwood("solve", "--m1", "1.000(2)", "--m2", "3").out)
    given = ["solve", "--m1", "1", "--m2", "3", "--M", "10", "--g", "9.81(1)"]
    assert re.search(r"│ mu_verge +│ +0\.205828 +│", atwood(*given).out)
    assert re.search(r"│ mu_verge +│ +0\.2058 +│", atwood(*given, "--digits", "4").out)
    assert re.search(r"│ acceleration +│ +2\.1800 ± 0\.0022 +│", atwood(*given, "--digits", "1").out)


# fmt: off
SIZES = {
    "0.7640266 0.0123": "0.764 ± 0.012", "0.7640266 0.0996": "0.76 ± 0.10", "9.8765 0.994": "9.88 ± 0.99",
    "9.8765 0.995": "9.9 ± 1.0", "1211148 7740": "1211100 ± 7700", "9.80665 98.0665": "10 ± 98",
    "0.00980665 98.0665": "0 ± 98", "-0.0049 0.15": "0.00 ± 0.15", "9.80665e-9 1.96e-10": "(9.81 ± 0.20)e-9",
    "-9.80665e20 1.96e19": "(-9.81 ± 0.20)e20", "1e-30 1e-3": "0.0000 ± 0.0010", "0.25 0.1": "0.25 ± 0.10",
    "0.0125 0.010": "0.012 ± 0.010", "0.0135 0.010": "0.014 ± 0.010",
    "1e-5 1e-450": f"(1.{'0' * 446} ± 0.{'0' * 444}10)e-5",
}
# fmt: on


@pytest.mark.parametrize("numbers", SIZES)
def test_numbers_of_every_size(numbers: str) -> None:
    value, u = map(Decimal, numbers.split())
    assert with_uncertainty(lambda place: to_place(place)(value), u) == SIZES[numbers]
    assert with_uncertainty(lambda place: to_place(place)(Fraction(value)), u) == SIZES[numbers]


def test_the_scene_shows_radians_as_they_are(atwood: Atwood) -> None:
    ran = atwood("solve", "--m1", "1", "--m2", "3", "--wrap", "3.1(1)rad")
    assert "wrap = 3.1 ± 0.1rad\n" in ran.out
    assert "wrap = 180 ± 2°\n" in atwood("solve", "--m1", "1", "--m2", "3", "--wrap", "180(2)").out


def test_ascii_has_plus_minus_too() -> None:
    ran = process(*UNCERTAIN, PYTHONIOENCODING="ascii")
    assert (ran.status, ran.err) == (0, "")
    assert ran.out.isascii()
    assert "m1 = 1.000 +/- 0.002 kg" in ran.out
    assert re.search(r"2\.1793 \+/- 0\.0089 ", ran.out)


def test_a_narrow_terminal_has_it_as_lines() -> None:
    seen = plain(on_terminal(*UNCERTAIN, columns=30))
    assert "acceleration = 2.1793 ± 0.0089" in seen.replace("\n", " ")


def test_json_has_an_object_of_them(atwood: Atwood) -> None:
    result = json.loads(atwood(*UNCERTAIN, "--json").out)
    exact = json.loads(atwood("solve", "--m1", "1", "--m2", "3", "--M", "10", "--json").out)
    assert {**result, "uncertainty": None} == exact
    assert list(result["uncertainty"]) == [*NAMES[1:], *MEASURED_NAMES]
    # a = g (m2 - m1)/(m1 + m2 + 5): by m1, -g (2 m2 + 5)/81, by m2, g (2 m1 + 5)/81.
    expected = 9.80665 / 81 * sqrt((11 * 0.002) ** 2 + (7 * 0.01) ** 2)
    assert result["uncertainty"]["acceleration"] == pytest.approx(expected, rel=1e-15)
    assert result["uncertainty"]["torque"] is None
    only = json.loads(atwood(*UNCERTAIN, "--json", "--only", "regime", "--only", "torque").out)
    assert only == {"regime": "no-slip", "torque": None, "uncertainty": {"torque": None}}
    digits = atwood(*UNCERTAIN, "--json", "--only", "acceleration", "--digits", "3").out
    assert '"acceleration": 2.18,' in digits
    assert '"acceleration": 0.00888' in digits


def test_csv_has_columns_after(atwood: Atwood) -> None:
    ran = atwood(*UNCERTAIN, "--csv", "--only", "regime", "--only", "acceleration", "--only", "torque")
    names, values = csv.reader(io.StringIO(ran.out))
    assert names == ["regime", "acceleration", "torque", "u_acceleration", "u_torque"]
    assert [*values[:3], values[4]] == ["no-slip", "2.1792555555555557", "", ""]
    assert float(values[3]) == pytest.approx(9.80665 / 324 * sqrt(22**2 + 70**2) / 250, rel=1e-15)
    assert ran.err == "atwood: torque: give R, the pulley's radius.\n"
    every = next(csv.reader(io.StringIO(atwood(*UNCERTAIN, "--csv").out)))
    assert every == [*NAMES, *(f"u_{name}" for name in NAMES[1:])]


def test_only_gives_scripts_the_value_and_people_the_doubt(atwood: Atwood) -> None:
    ran = atwood(*UNCERTAIN, "--only", "acceleration", "--only", "mu_verge", "--only", "regime")
    assert (ran.status, ran.out) == (0, "2.1792555555555557\n0.20582781927064067\nno-slip\n")
    assert ran.err == "atwood: acceleration = 2.1793 ± 0.0089 m/s²\natwood: mu_verge = 0.20583 ± 0.00066\n"
    doubtful = atwood(*UNCERTAIN, "--mu", "0.21(1)", "--only", "regime")
    assert (doubtful.status, doubtful.out) == (0, "no-slip\n")
    assert doubtful.err.startswith("atwood: Whether the string slips is in doubt: mu - mu_verge = ")


def test_the_budget_in_a_table_and_in_json(atwood: Atwood) -> None:
    out = atwood(*UNCERTAIN, "--budget").out
    assert "Each input's share of the variance, in percent:" in out
    # (11 · 2)² of (11 · 2)² + (7 · 10)²
    assert re.search(r"│ acceleration +│ +9\.0 │ +91\.0 │", out)
    result = json.loads(
        atwood(*UNCERTAIN, "--budget", "--json", "--only", "acceleration", "--only", "torque").out
    )
    shares = result["budget"]["acceleration"]
    assert shares == {
        "m1": pytest.approx(48400 / 5384, rel=1e-14),
        "m2": pytest.approx(490000 / 5384, rel=1e-14),
    }
    assert result["budget"]["torque"] is None


BUDGETS = {
    "solve --m1 1 --m2 3 --budget": "needs an input with its uncertainty, like --m1 '1.000(2)'",
    f"{' '.join(UNCERTAIN)} --budget --csv": "has no effect with --csv; leave one of them out",
    f"{' '.join(UNCERTAIN)} --budget --only acceleration": "has no place in bare values; take --json",
}


@pytest.mark.parametrize("words", BUDGETS)
def test_a_budget_that_cannot_be(words: str, atwood: Atwood) -> None:
    ran = atwood(*words.split())
    assert (ran.status, ran.out, ran.err) == (2, "", f"atwood: --budget {BUDGETS[words]}\n")


def test_help_says_how_to_type_it(atwood: Atwood) -> None:
    words = " ".join(atwood("solve", "-h").out.split())
    assert "in quotes for the shell, '1.000(2)'" in words


def test_exact_inputs_import_nothing_and_have_an_empty_mapping() -> None:
    code = (
        "import sys; from atwood_cli.cli import run; run(sys.argv[1:]); print(*sys.modules, file=sys.stderr)"
    )
    for words, loaded in ((["--m1", "1"], False), (["--m1", "1(1)"], True)):
        done = subprocess.run(
            [sys.executable, "-c", code, "solve", *words, "--m2", "3", "--json"],
            capture_output=True,
            text=True,
            check=True,
        )
        assert ("atwood_cli.solver.uncertainty" in done.stderr.split()) == loaded
        assert (json.loads(done.stdout)["uncertainty"] is not None) == loaded
    assert solve(m1="1", m2="3").uncertainty == {}
    assert hash(solve(m1="1", m2="3")) == hash(solve(m1="1", m2="3.0"))


def test_digits_give_decimals() -> None:
    assert solve(m1="1.000(2)", m2="3", digits=5).uncertainty["acceleration"] == Decimal("0.0073550")


def test_sentences_beside_uncertainties_are_short(atwood: Atwood) -> None:
    for digits in ([], ["--digits", "9"]):
        ran = atwood("solve", "--m1", "1.000(2)", "--m2", "3", "--M", "10", *digits)
        assert ran.out.splitlines()[1] == "Assumed to hold, without mu: it does if mu is at least 0.206."
