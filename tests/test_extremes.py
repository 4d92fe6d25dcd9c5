"""Limits of the model and dangers of numbers, each by its name, and what the program does there.

Every limit is asked for at every door: `solve`, in doubles and to digits, and `solve_arrays`,
certified and exact. What it must be comes from elsewhere: the leading term of the limit, Newton's laws
in 60 digits, the paper's formula as printed in so many digits that nothing it cancels matters.

l and h are the lighter and the heavier mass, c = M/2 is the disk's mass at the rim, k = e^{mu pi}.
"""

from collections.abc import Sequence
from decimal import Context, Decimal
from fractions import Fraction
from math import inf, isnan, ldexp, log, nextafter, pi, ulp
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mpmath import MPContext

from atwood_cli import REGIMES, solve, solve_arrays
from atwood_cli.model.quantities import NAMES

from .conftest import examples

mp: Any = MPContext()
mp.dps = 60

UNIT = 2.0**-53
DOORS = {"digits": 1e-29, "doubles": UNIT, "certified": 2e-14, "exact": UNIT}
"""How far from the truth what they give may be, relative to it."""
G = 9.80665  # as a double: at the door of arrays all numbers are
solve_any: Any = solve  # with inputs that are put together here
arrays_any: Any = solve_arrays

everywhere = pytest.mark.parametrize("door", DOORS)
few = examples(40)

masses = st.floats(1e-3, 1e3)
coefficients = st.floats(0.01, 2)
shares = st.just(0.0) | st.floats(1e-9, 0.99)  # of static friction that is kinetic
unequal = st.tuples(masses, st.floats(1.01, 100)).map(lambda of: (of[0], of[0] * of[1]))


def ask(door: str, names: Sequence[str], **given: Any) -> list[Any]:
    """Quantities of a scene, exactly as they come out there; None where there is none."""
    given = {"g": G} | given
    if door in ("doubles", "digits"):
        one = solve_any(**given, digits=30 if door == "digits" else None)
        values = [getattr(one, name) for name in names]
        return [Fraction(value) if isinstance(value, Decimal) else value for value in values]
    # Fewer rows would be solved one by one where doubles are in doubt.
    columns = {name: np.full(30, value, dtype=float) for name, value in given.items()}
    results = arrays_any(**columns, accuracy=door, quantities=names)
    values = []
    for name in names:
        (value,) = {repr(value): value for value in results[name].tolist()}.values()
        values.append(REGIMES[value] if name == "regime" else None if isnan(value) else value)
    return values


def assert_near(value: Any, law: Any, within: Any) -> None:
    assert abs(mp.convert(value) - law) <= within * abs(law), (value, law)


def exactly(*numbers: Any) -> list[Any]:
    return [mp.convert(number) for number in numbers]


# Equal masses


@everywhere
@few
@given(masses, masses | st.just(inf), st.integers(1, 4))
def test_the_friction_that_nearly_equal_masses_need_is_their_difference_times_a_factor(
    door: str, m1: float, M: float, steps: int
) -> None:
    """ln(T2/T1) is lost in doubles: T2/T1 is 1, or a few units in the last place more.

    Half the pulley's mass and 2 l share what the difference drives; a locked pulley takes it all.
    """
    if door in ("digits", "doubles"):
        m2: Any = Fraction(m1) * (1 + Fraction(steps, 10**300))
    else:
        m2 = m1 + steps * ulp(m1)
    l, c, g, difference = exactly(m1, M / 2, G, Fraction(m2) - Fraction(m1))
    a, mu, friction = ask(door, ["acceleration", "mu_verge", "friction_force"], m1=m1, m2=m2, M=M)
    nearly = DOORS[door] + 4 * difference / l
    assert_near(a, g * difference / (2 * l + c), nearly)
    needed = (1 if M == inf else c / (2 * l + c)) * difference / l / mp.pi
    assert_near(mu, needed, nearly)
    assert_near(friction, needed * 2 * l * g, nearly)


# The pulley's mass: 0 and infinity


@everywhere
@few
@given(unequal, st.integers(20, 300))
def test_the_friction_that_a_light_pulley_needs_is_its_mass_times_a_factor(
    door: str, pair: tuple[float, float], power: int
) -> None:
    """The motion comes to that of a massless pulley, but the friction, however small, keeps its digits."""
    M = 10.0**-power
    names = ["acceleration", "tension_1", "tension_2", "mu_verge", "friction_force"]
    a, t1, t2, mu, friction = ask(door, names, m1=pair[0], m2=pair[1], M=M)
    l, h, c, g = exactly(*pair, M / 2, G)
    nearly = DOORS[door] + M / l
    tension = 2 * l * h * g / (l + h)
    assert_near(a, g * (h - l) / (h + l), nearly)
    assert_near(t1, tension, nearly)
    assert_near(t2, tension, nearly)
    assert_near(mu, c * (h - l) / (2 * l * h) / mp.pi, nearly)
    assert_near(friction, c * (h - l) / (2 * l * h) / mp.pi * 2 * tension, nearly)


@everywhere
@few
@given(unequal, st.integers(20, 300))
def test_a_heavy_pulley_comes_to_the_locked_one(door: str, pair: tuple[float, float], power: int) -> None:
    """Of the motion, what is left goes as 1/M; forces are those of masses at rest."""
    names = ["tension_1", "tension_2", "mu_verge", "friction_force", "acceleration"]
    l, h, c, g = exactly(*pair, 10.0**power / 2, G)
    mu = mp.log(h / l) / mp.pi
    at_rest = [l * g, h * g, mu, mu / mp.sqrt(1 + mu**2) * (l + h) * g]
    for M, slack in ((10.0**power, 8 * h / c), (inf, 0)):
        *values, a = ask(door, names, m1=pair[0], m2=pair[1], M=M)
        for value, law in zip(values, at_rest, strict=True):
            assert_near(value, law, DOORS[door] + slack)
        assert_near(a, g * (h - l) / c if slack else 0, DOORS[door] + slack)


# Friction: none, and more than a double can tell


@everywhere
@few
@given(unequal, st.integers(20, 300), st.floats(0.1, 100))
def test_what_weak_friction_does_is_its_coefficient_times_a_factor(
    door: str, pair: tuple[float, float], power: int, M: float
) -> None:
    """e^{mu pi} - 1 is lost in doubles: the exponential is 1."""
    mu = 10.0**-power
    l, h, c, g, grip = exactly(*pair, M / 2, G, mu)
    grip *= mp.pi
    names = [
        "critical_pulley_mass",
        "least_pulley_mass",
        "acceleration",
        "rim_acceleration",
        "friction_force",
    ]
    critical, least, a, rim, friction = ask(door, names, m1=pair[0], m2=pair[1], M=M, mu=mu)
    tension = 2 * l * h * g / (l + h)
    nearly = DOORS[door] + 200 * grip
    assert_near(critical, 4 * l * h * grip / (h - l), nearly)
    assert_near(least, 4 * l * grip, nearly)
    assert_near(a, g * (h - l) / (h + l), nearly)
    assert_near(rim, tension * grip / c, nearly)
    assert_near(friction, 2 * tension * grip / mp.pi, nearly)


@everywhere
@few
@given(masses, st.integers(8, 14), st.floats(0.1, 0.9))
def test_weak_friction_on_nearly_equal_masses_keeps_its_digits(
    door: str, m1: float, power: int, share: float
) -> None:
    """h - l k is lost where l k is formed first: what it hangs on are digits that l k has no room for."""
    m2 = m1 * (1 + 10.0**-power)
    mu = (m2 - m1) / m1 * share / pi
    l, h = exactly(m1, m2)
    transfer = l * mp.expm1(mu * mp.pi)
    (critical,) = ask(door, ["critical_pulley_mass"], m1=m1, m2=m2, mu=mu)
    assert_near(critical, 4 * h * transfer / (h - l - transfer), DOORS[door])


@everywhere
@few
@given(st.floats(230, 440))
def test_a_string_slips_even_where_the_capstan_ratio_is_beyond_the_doubles(door: str, mu: float) -> None:
    m1, m2 = 2.0**-1000, 2.0**1000
    assert log(m2) - log(m1) > mu * pi > log(2) * 1024
    names = ["regime", "acceleration", "tension_1", "tension_2", "least_heavier_mass"]
    regime, a, t1, t2, least = ask(door, names, m1=m1, m2=m2, M=inf, mu=mu)
    l, h, g, lk = exactly(m1, m2, G, m1)
    lk *= mp.exp(mu * mp.pi)
    assert regime == "slip"
    for value, law in (
        (a, g * (h - lk) / (h + lk)),
        (t1, 2 * l * h * g / (h + lk)),
        (t2, 2 * lk * h * g / (h + lk)),
        (least, lk),
    ):
        assert_near(value, law, DOORS[door])


@everywhere
def test_a_light_mass_brings_a_capstan_ratio_beyond_the_doubles_back(door: str) -> None:
    regime, least = ask(door, ["regime", "least_heavier_mass"], m1=2.0**-110, m2=1.0, M=1.0, mu=235.0)
    assert regime == "no-slip"
    assert_near(least, mp.exp(235 * mp.pi) / 2**110, DOORS[door])


@pytest.mark.parametrize("mu", ["1e6", "1e400"])
def test_a_huge_mu_is_answered_by_logic(mu: str) -> None:
    s = solve(m1=1, m2=3, mu=mu, digits=5)
    assert s.regime == "no-slip"
    assert s.least_heavier_mass == (Decimal("2.2586e1364376") if mu == "1e6" else Decimal("Infinity"))
    assert any("beyond 10^100000000" in note for note in s.notes) == (mu == "1e400")


# The heavier mass that any pulley holds, m1 e^{mu pi}


def doubles_around(x: Any) -> tuple[float, float]:
    """The two next to a real number that is none."""
    nearest = float(x)
    below = nearest if nearest < x else nextafter(nearest, 0)
    return below, nextafter(below, inf)


@everywhere
@few
@given(masses, coefficients)
def test_one_double_holds_on_any_pulley_and_the_next_slips_on_a_heavy_one(
    door: str, m1: float, mu: float
) -> None:
    """Between the two the critical pulley mass goes to infinity: h - l k has lost all digits in doubles."""
    names = ["regime", "critical_pulley_mass"]
    k = mp.exp(mu * mp.pi)
    light, heavy = doubles_around(m1 * k)
    assert ask(door, names, m1=m1, m2=light, mu=mu) == ["no-slip", None]
    assert ask(door, names[:1], m1=m1, m2=light, mu=mu, M=inf) == ["no-slip"]
    regime, critical = ask(door, names, m1=m1, m2=heavy, mu=mu)
    assert regime == "verge"
    assert ask(door, names[:1], m1=m1, m2=heavy, mu=mu, M=inf) == ["slip"]
    l, h = exactly(m1, heavy)
    assert_near(critical, 4 * l * h * (k - 1) / (h - l * k), DOORS[door])  # (34)


@few
@given(masses, coefficients, st.integers(20, 300))
def test_the_critical_pulley_mass_goes_to_infinity_as_1_over_the_excess(
    m1: float, mu: float, power: int
) -> None:
    with mp.workdps(1000):
        k = mp.exp(mu * mp.pi)
        lk = Fraction(mp.nstr(m1 * k, 700))
    excess = Fraction(1, 10**power)
    above, below = (solve(m1=m1, m2=lk * (1 + off), mu=mu) for off in (excess, -excess))
    assert_near(above.critical_pulley_mass, 4 * m1 * (k - 1) * 10**power, UNIT + 2 / mp.mpf(10) ** power)
    assert below.critical_pulley_mass is None
    assert "Holds on any pulley" in below.notes[0]


# The pulley's mass that any heavier mass leaves holding, 4 l (k - 1)


@everywhere
@few
@given(masses, coefficients)
def test_on_one_double_no_heavier_mass_slips_and_on_the_next_a_huge_one_does(
    door: str, m1: float, mu: float
) -> None:
    """Between the two the critical heavier mass goes to infinity."""
    names = ["regime", "critical_heavier_mass"]
    k = mp.exp(mu * mp.pi)
    light, heavy = doubles_around(4 * m1 * (k - 1))
    huge = 1e25 * m1 * k  # beyond what a double next to the limit needs
    assert ask(door, names, m1=m1, m2=huge, M=light, mu=mu) == ["no-slip", None]
    regime, critical = ask(door, names, m1=m1, m2=huge, M=heavy, mu=mu)
    assert regime == "slip"
    l, M = exactly(m1, heavy)
    assert_near(critical, M * l * k / (M - 4 * l * (k - 1)), DOORS[door])  # (35)


# The critical pulley mass

MOTION = ["acceleration", "tension_1", "tension_2", "rim_acceleration"]
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
    k = mp.exp(mu * mp.pi)
    l, h, g = exactly(m1, m2, G)
    a, tension = g * (h - l * k) / (h + l * k), 2 * l * h * g / (h + l * k)
    for name, law in zip(MOTION, [a, tension, tension * k, a], strict=True):
        assert_near(getattr(grips, name), law, UNIT)
        assert getattr(slips, name) == getattr(grips, name)


@everywhere
@few
@given(verges)
def test_neighbouring_doubles_are_on_either_side_of_the_critical_pulley_mass(
    door: str, scene: tuple[float, float, float]
) -> None:
    m1, m2, mu = scene
    k = mp.exp(mu * mp.pi)
    l, h = exactly(m1, m2)
    around = doubles_around(4 * l * h * (k - 1) / (h - l * k))
    answers = [ask(door, ["regime", *MOTION], m1=m1, m2=m2, mu=mu, M=M) for M in around]
    assert [regime for regime, *_ in answers] == ["no-slip", "slip"]
    for grips, slips in zip(*(motion for _, *motion in answers), strict=True):
        assert_near(slips, mp.convert(grips), 2 * DOORS[door] + 4 * UNIT)


@everywhere
@few
@given(verges, shares)
def test_kinetic_friction_below_static_makes_the_motion_jump(
    door: str, scene: tuple[float, float, float], share: float
) -> None:
    """The masses speed up and the rim slows down; the light mass's string tightens, the other slackens."""
    m1, m2, mu = scene
    k, kinetic = mp.exp(mu * mp.pi), mp.expm1(mp.mpf(mu * share) * mp.pi)
    l, h, g = exactly(m1, m2, G)
    pulleys = doubles_around(4 * l * h * (k - 1) / (h - l * k))
    before, after = (ask(door, MOTION, m1=m1, m2=m2, mu=mu, mu_k=mu * share, M=M) for M in pulleys)
    tension = 2 * l * h * g / (h + l + l * kinetic)
    laws = [tension / l - g, tension, tension * (1 + kinetic), tension * kinetic / pulleys[1] * 2]
    for value, law in zip(after, laws, strict=True):
        assert_near(value, law, DOORS[door])
    assert [new > old for new, old in zip(after, before, strict=True)] == [True, True, False, False]


# The same machine in other units, and from behind

DIMENSIONS = {  # of kg, m and s
    **dict.fromkeys(["m1", "m2", "M", *(name for name in NAMES if name.endswith("_mass"))], (1, 0, 0)),
    **dict.fromkeys(["g", "acceleration", "rim_acceleration"], (0, 1, -2)),
    **dict.fromkeys([name for name in NAMES if "force" in name or "tension" in name], (1, 1, -2)),
    "R": (0, 1, 0),
    "I": (1, 2, 0),
    "torque": (1, 2, -2),
    "angular_acceleration": (0, 0, -2),
    "tension_ratio": (0, 0, 0),
}
NONE = (0, 0, 0)


def with_kinetic(mu: float | None, share: float | None, **scene: Any) -> dict[str, float]:
    friction = {} if mu is None else {"mu": mu} if share is None else {"mu": mu, "mu_k": mu * share}
    return scene | friction


scenes: st.SearchStrategy[dict[str, Any]] = st.fixed_dictionaries(
    {
        "m1": masses,
        "m2": masses,
        "g": st.floats(0.1, 100),
        "mu": st.none() | coefficients,
        "share": st.none() | shares,
    },
    optional={
        "M": st.sampled_from([0.0, inf]) | st.floats(1e-3, 1e4),
        "inertia": st.floats(0.1, 2),
        "R": masses,
        "wrap": st.sampled_from([90.0, 360.0]) | st.floats(10, 180),
    },
).map(lambda scene: with_kinetic(**scene))


exponents = st.tuples(*[st.integers(-10, 10)] * 3)


def powers(units: tuple[int, ...], name: str) -> int:
    return sum(n * power for n, power in zip(units, DIMENSIONS.get(name, NONE), strict=True))


@pytest.mark.parametrize("door", [door for door in DOORS if door != "digits"])
@examples(30)
@given(scenes, exponents)
def test_units_smaller_by_powers_of_four_change_no_bit(
    door: str, scene: dict[str, float], units: tuple[int, ...]
) -> None:
    """Of four, as roots are taken on the way."""
    units = tuple(2 * unit for unit in units)
    other = {name: ldexp(value, powers(units, name)) for name, value in scene.items()}
    for name, here, there in zip(NAMES, ask(door, NAMES, **scene), ask(door, NAMES, **other), strict=True):
        assert there == (here if name == "regime" or here is None else ldexp(here, powers(units, name))), name


@examples(30)
@given(scenes, exponents, st.none() | masses)
def test_units_smaller_by_powers_of_ten_move_the_point_alone(
    scene: dict[str, Any], units: tuple[int, ...], moment: float | None
) -> None:
    if moment is not None and "R" in scene and scene.get("M") != inf and "inertia" not in scene:
        scene = {name: value for name, value in scene.items() if name != "M"} | {"I": moment}
    other = {
        name: value if value == inf else Fraction(value) * Fraction(10) ** powers(units, name)
        for name, value in scene.items()
    }
    for name, here, there in zip(
        NAMES, ask("digits", NAMES, **scene), ask("digits", NAMES, **other), strict=True
    ):
        factor = Fraction(10) ** powers(units, name)
        assert there == (here if name == "regime" or here is None else here * factor), name


SIGNED = ("acceleration", "rim_acceleration", "angular_acceleration", "torque")


@everywhere
@examples(30)
@given(scenes)
def test_from_behind_everything_is_mirrored(door: str, scene: dict[str, float]) -> None:
    vector = ("friction_force_x", "friction_force_y") if "wrap" in scene else ()
    names = [name for name in NAMES if name not in vector]
    seen = dict(zip(names, ask(door, names, **scene), strict=True))
    behind = dict(zip(names, ask(door, names, **scene | {"m1": scene["m2"], "m2": scene["m1"]}), strict=True))
    seen["tension_1"], seen["tension_2"] = seen["tension_2"], seen["tension_1"]
    for name, value in seen.items():
        flips = name in SIGNED or name == "friction_force_x"
        assert behind[name] == (-value if flips and value is not None else value), name


# The ends of the doubles


def nearest_double(q: Fraction) -> float:
    try:
        return q.numerator / q.denominator
    except OverflowError:
        return inf


small = st.integers(1, 15)


@everywhere
@few
@given(small, small, small, st.sampled_from([-1074, 1020]), st.none() | coefficients)
def test_masses_at_the_ends_of_the_doubles_move_like_any_others(
    door: str, m1: int, m2: int, M: int, power: int, mu: float | None
) -> None:
    """Sums of the largest overflow, products of the smallest vanish; only results may."""
    given = {} if mu is None else {"mu": mu}
    names = ["regime", "acceleration", "mu_verge", "tension_1", "tension_2", "critical_pulley_mass"]
    there = ask(
        door, names, **{n: ldexp(float(m), power) for n, m in (("m1", m1), ("m2", m2), ("M", M))}, **given
    )
    usual = solve_any(m1=m1, m2=m2, M=M, g=G, digits=200, **given)  # with ties between doubles written out
    assert there[0] == usual.regime
    for name, answer in zip(names[1:], there[1:], strict=True):
        value = getattr(usual, name)
        if value is None:
            assert answer is None
            continue
        scaled = Fraction(value) * Fraction(2) ** powers((power, 0, 0), name)
        if door == "digits":
            assert_near(answer, mp.convert(scaled), 2 * DOORS[door])
        else:
            assert answer == nearest_double(scaled), name


@everywhere
@few
@given(scenes, st.sampled_from([5e-324, 1e-310, 1e-200, 1e200, 1.7e308]))
def test_gravity_at_the_ends_of_the_doubles_scales_the_motion_alone(
    door: str, scene: dict[str, float], g: float
) -> None:
    still = ["regime", "mu_verge", "critical_pulley_mass", "critical_heavier_mass", "least_heavier_mass"]
    usual, extreme = (ask(door, [*still, "acceleration"], **scene | {"g": at}) for at in (G, g))
    for one, other in zip(usual[1:-1], extreme[1:-1], strict=True):
        assert (one is None) == (other is None)
        if one is not None:  # such rows are solved one by one, more accurately
            assert_near(other, mp.convert(one), 2 * DOORS[door])
    assert usual[0] == extreme[0]
    (ratio,) = ask("digits", ["acceleration"], **scene | {"g": 1})
    if ratio is not None:
        law = Fraction(ratio) * Fraction(g)
        if door == "digits":
            assert_near(extreme[-1], mp.convert(law), 2 * DOORS[door])
        else:
            assert extreme[-1] == nearest_double(law)


# One digit, and a thousand


@examples(8)
@given(unequal, masses)
def test_a_thousand_digits_are_all_right_and_one_is_their_rounding(
    pair: tuple[float, float], M: float
) -> None:
    with mp.workdps(1050):
        l, h, c, g = exactly(*pair, M / 2, G)
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
