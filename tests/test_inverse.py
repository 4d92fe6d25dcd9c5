"""From a measured acceleration back to the pulley or to gravity, and the fall from rest."""

import csv
import io
import json
import re
from decimal import Decimal
from fractions import Fraction
from math import pi, sqrt
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from atwood_cli import Scene, SceneError, Solution, solve
from atwood_cli.model.angle import Angle
from atwood_cli.model.quantities import MEASURED_NAMES, NAMES

from .running import Atwood, on_terminal, process
from .scenes import inputs, table

masses = st.fractions(min_value=Fraction(1, 10**6), max_value=10**6)


def measured(**given: Any) -> Solution[Any]:
    return solve(**{"m1": "1", "m2": "3", **given})


# The equations are inverses of those that they invert


@given(masses, masses, st.fractions(min_value=0, max_value=10**6), masses, masses, st.booleans())
def test_what_is_found_gives_the_measured_acceleration_exactly(
    l: Fraction, more: Fraction, M: Fraction, g: Fraction, beta: Fraction, mirrored: bool
) -> None:
    m1, m2 = (l + more, l) if mirrored else (l, l + more)
    a = (m2 - m1) * g / (m1 + m2 + beta * M)
    known = {"m1": m1, "m2": m2, "inertia": beta, "a": a}
    for_pulley, for_gravity = solve(**known, g=g, digits=30), solve(**known, M=M, digits=30)
    assert (
        for_pulley.scene
        == for_gravity.scene
        == Scene(m1, m2, M, None, None, g, beta, None, None, Angle(Fraction(180)))
    )
    exact = solve(m1=m1, m2=m2, M=M, g=g, inertia=beta, digits=30)
    for name in NAMES:
        assert getattr(for_pulley, name) == getattr(for_gravity, name) == getattr(exact, name)


@given(masses, masses, st.fractions(min_value=0, max_value=10**6), masses, masses)
def test_a_mass_that_is_found_is_the_one_that_was_taken_away(
    m1: Fraction, m2: Fraction, M: Fraction, g: Fraction, beta: Fraction
) -> None:
    a = (m2 - m1) * g / (m1 + m2 + beta * M)
    exact = solve(m1=m1, m2=m2, M=M, g=g, inertia=beta, digits=30)
    for unknown, known in (("m1", {"m2": m2}), ("m2", {"m1": m1})):
        for pulley in ({"M": M, "inertia": beta}, {"I": beta * M, "R": 1}):
            if pulley.get("I") != 0:
                found = measured(**{"m1": None, "m2": None, **known}, **pulley, a=a, g=g)
                assert getattr(found.scene, unknown) == {"m1": m1, "m2": m2}[unknown]
        again = solve(**known, M=M, inertia=beta, a=a, g=g, digits=30)
        assert all(getattr(again, name) == getattr(exact, name) for name in NAMES)


def test_a_free_end_is_found_where_nothing_else_moves_so() -> None:
    free = measured(m2=None, M="10", a=Fraction("-9.80665") / 6)
    assert (free.m2, free.tension_2, free.mu_verge) == (0, 0, None)


def test_a_slide_finds_kinetic_friction_and_moves_as_that_does() -> None:
    """The issue's: 100 g and 400 g over a locked pulley at 2.141 m/s²."""
    found = measured(m1="100g", m2="400g", M="inf", a="2.141", digits=30)
    assert f"{found.mu_k:.3f}" == "0.300"
    for m1, m2, sign in (("100g", "400g", 1), ("400g", "100g", -1)):
        for more in ({"M": "inf"}, {"M": "inf", "mu": "0.4"}, {"M": "7", "mu": "0.39"}):
            found = measured(m1=m1, m2=m2, a=Decimal("2.141") * sign, digits=30, **more)
            again: Any = solve(m1=m1, m2=m2, **{"mu": found.mu_k, **more}, mu_k=found.mu_k, digits=25)
            assert again.regime == found.regime == "slip"
            for name in NAMES[1:]:
                one, other = getattr(found, name), getattr(again, name)
                if one is not None and name != "least_wrap":
                    assert float(one) == pytest.approx(float(other), rel=1e-15), name
    # The massless acceleration is that of no friction.
    assert measured(m1="1", m2="3", M="inf", a="4.903325").mu_k == 0
    assert measured(m1="1", m2="3", M="inf", a="4.903325").friction_force == 0


def test_a_slide_with_uncertainties_against_uncertainties() -> None:
    unc, umath = pytest.importorskip("uncertainties"), pytest.importorskip("uncertainties.umath")
    m1, m2, a, g = (unc.ufloat(*x) for x in ((0.1, 1e-3), (0.4, 2e-3), (2.141, 5e-3), (9.81, 0.01)))
    wanted = umath.log(m2 * (g - a) / (m1 * (g + a))) / pi
    s = measured(m1="0.100(1)", m2="0.400(2)", a="2.141(5)", g="9.81(1)", M="inf")
    assert s.mu_k == pytest.approx(wanted.nominal_value, rel=1e-14)
    assert s.uncertainty["mu_k"] == pytest.approx(wanted.std_dev, rel=1e-2)


def test_the_wrap_that_just_holds() -> None:
    assert solve(m1="1", m2="400", M="inf", mu="0.3").least_wrap == 1144.285438838495
    for scene in ({"M": "inf"}, {"M": "100"}, {"M": "10"}, {"M": "10", "wrap": "90"}):
        given_: dict[str, Any] = {"m1": "1", "m2": "3", "mu": "0.2", **scene}
        wrap = Fraction(solve(**given_, digits=30).least_wrap or 0)
        for off, regime in ((Fraction("1e-20"), "no-slip"), (Fraction("-1e-20"), "slip")):
            assert solve(**{**given_, "wrap": wrap + off}).regime == regime
    assert solve(m1="1", m2="3", mu="0.3", wrap="170").least_wrap == 170  # the verge itself
    assert solve(m1="1", m2="3", mu="0.3", wrap="3rad", digits=5).least_wrap == Decimal("171.89")
    assert solve(m1="1", m2="3", mu="0.3", M="0").least_wrap == 0


def test_the_results_that_are_found() -> None:
    # c = 2 g - 4 = 15.6133, M = c/β.
    s = measured(a="1", R="0.1", drop="2")
    assert (s.pulley_mass, s.moment_of_inertia, s.gravity) == (31.2266, 0.156133, None)
    assert (s.fall_time, s.final_speed, s.acceleration) == (2, 2, 1)
    assert s.scene.M == Fraction("31.2266")
    # g = 1 (1 + 3 + 5)/2
    s = measured(a="1", M="10")
    assert (s.gravity, s.pulley_mass, s.moment_of_inertia, s.fall_time) == (4.5, None, None, None)
    s = measured(a="1", I="0.2", R="0.2")
    assert (s.gravity, s.pulley_mass) == (4.5, None)
    # A free end on a pulley: a = m2 g/(m2 + c).
    assert measured(m1="0", m2="1", a="4.903325").pulley_mass == 2
    # The massless pulley itself.
    assert measured(a="4.903325").pulley_mass == 0
    assert measured(m1="3", m2="1", a="-4.903325").pulley_mass == 0


def test_a_height_alone_gives_the_fall_of_any_scene() -> None:
    for scene in ({"M": "10"}, {"M": "100", "mu": "0.3"}, {"mu": "0.3"}, {"m1": "5", "M": "10"}):
        s = measured(drop="1.5", **scene)
        assert s.acceleration is not None
        assert s.fall_time == pytest.approx(sqrt(3 / abs(s.acceleration)), rel=1e-15)
        assert s.final_speed == pytest.approx(sqrt(3 * abs(s.acceleration)), rel=1e-15)
        assert s.pulley_mass is s.gravity is None


@pytest.mark.parametrize(
    ("time", "a"), [("2", "1"), ("1.25", "2.56"), ("4/3", "2.25"), ("1.2345678901234567890123", None)]
)
def test_a_time_stands_for_the_acceleration_it_implies(time: str, a: str | None) -> None:
    t = Fraction(time)
    s = measured(drop="2", time=t)
    assert s.fall_time == float(t)
    assert s.final_speed == float(4 / t)
    assert s.acceleration == float(4 / t**2)
    if a is not None:
        assert s.pulley_mass == measured(a=a).pulley_mass
        mirrored = measured(m1="3", m2="1", drop="2", time=t)
        assert (mirrored.acceleration, mirrored.pulley_mass) == (-float(a), s.pulley_mass)


@pytest.mark.parametrize(
    ("drop", "digits", "shown"),
    [
        # √(2 H/1): perfect squares, a tie among them, and one that is none.
        ("3.125", 1, "2"),
        ("6.125", 1, "4"),
        ("3.125", 5, "2.5000"),
        ("1", 30, "1.41421356237309504880168872421"),
    ],
)
def test_roots_are_exact_where_they_are_rational_and_ties_end(drop: str, digits: int, shown: str) -> None:
    s = measured(a="1", drop=drop, digits=digits)
    assert str(s.fall_time) == str(s.final_speed) == shown


# With uncertainties


def test_laboratory_results_against_uncertainties() -> None:
    unc = pytest.importorskip("uncertainties")
    m1, m2, a, g, R, drop = (
        unc.ufloat(*pair)
        for pair in ((0.055, 1e-4), (0.06, 2e-4), (0.38, 4e-3), (9.81, 0.01), (0.05, 1e-3), (0.8, 0.01))
    )
    c = g * (m2 - m1) / a - m1 - m2
    time = (2 * drop / a) ** 0.5
    wanted = {"pulley_mass": 2 * c, "moment_of_inertia": c * R**2, "fall_time": time, "final_speed": a * time}
    wanted |= {
        "tension_1": m1 * (g + a),
        "torque": c * a * R,
        "axle_force": m1 * (g + a) + m2 * (g - a) + 2 * c * g,
    }
    s = measured(m1="55.0(1)g", m2="60.0(2)g", a="0.380(4)", g="9.81(1)", R="5.0(1)cm", drop="0.80(1)")
    timed = measured(m1="55.0(1)g", m2="60.0(2)g", drop="0.80(1)", time="2.00(2)s", M="30(1)g")
    for name, quantity in wanted.items():
        assert getattr(s, name) == pytest.approx(quantity.nominal_value, rel=1e-12), name
        assert s.uncertainty[name] == pytest.approx(quantity.std_dev, rel=1e-2), name
    M, t = unc.ufloat(0.03, 1e-3), unc.ufloat(2, 0.02)
    a = 2 * drop / t**2
    gravity = a * (m1 + m2 + M / 2) / (m2 - m1)
    assert timed.uncertainty["gravity"] == pytest.approx(gravity.std_dev, rel=1e-2)
    assert timed.uncertainty["acceleration"] == pytest.approx(a.std_dev, rel=1e-2)
    assert timed.uncertainty["fall_time"] == pytest.approx(0.02, rel=1e-13)
    assert timed.uncertainty["final_speed"] == pytest.approx((a * t).std_dev, rel=1e-2)
    assert timed.uncertainty["mu_verge"] == pytest.approx(
        solve(m1="55.0(1)g", m2="60.0(2)g", M="30(1)g").uncertainty["mu_verge"], rel=1e-15
    )


def test_an_acceleration_no_pulley_is_light_enough_for_beside_it() -> None:
    s = measured(a="4.903325(10)")
    assert s.pulley_mass == 0
    steps = [9.80665 * 2 / (4.903325 + step) for step in (-1e-5, 1e-5)]
    assert s.uncertainty["pulley_mass"] == pytest.approx(steps[0] - steps[1], rel=1e-6)
    assert s.uncertainty["acceleration"] == 1e-5


def test_a_fall_in_doubt_of_slipping() -> None:
    s = measured(M="10", mu="0.21(1)", drop="2.00(1)")
    doubt = "Whether the string slips is in doubt: it is otherwise at mu = 0.19, 2 standard"
    assert any(note.startswith(doubt) for note in s.notes)


# What cannot be


ERRORS = """
a=inf | a 'inf' must be finite
a=1kg | a '1kg' has the unit 'kg'; it takes m/s2, m s-2, cm/s2, ft/s2, N/kg
drop=0 | drop '0' must be above 0, and finite
drop=1s | drop '1s' has the unit 's'; it takes m, km, dm, cm, mm, um, in, ft, yd
drop=1 time=-1 | time '-1' must be above 0, and finite
time=1 | time '1' needs drop, the height fallen in it
time=1 drop=1 a=1 | time '1' and a both tell the acceleration; give one of them
a=1 mu=0.3 | a '1' has no place beside mu, as a string that slips moves alike on any pulley; leave
    mu out
a=1 I=1 R=1 g=9.8 | a '1' leaves nothing to find beside both I and g; leave one of them out
a=1 m2=None | m2 is missing; give it, or M, beside which a finds it
a=1 m2=None m1=None | m1 is missing; give both masses, m1 and m2
m2=None M=1 | m2 is missing; give both masses, m1 and m2
a=1 m2=None M=1 mu=0.3 | a '1' has no place beside mu, as whether the string slips depends on m2;
    leave mu out
drop=80cm time=0.55 | time '0.55' implies M = -0.583721 kg, which must be 0 or more (inf locks the
    pulley)
a=5.0(1) | a '5.0(1)' implies M = -0.15468 kg, which must be 0 or more (inf locks the pulley)
drop=1 time=1 m2=None M=1 | time '1' does not tell which way m2 moves; give a in its place, positive
    when m2 descends
a=1 m1=0 m2=None M=0 | a '1' tells nothing of m2, which falls freely; give the other mass or M above
    0
a=9.80665 m2=None M=10 | a '9.80665' must be below 9.80665 m/s², that of free fall
a=11 m2=None M=10 | a '11' must be below 9.80665 m/s², that of free fall
a=-1.7 m2=None M=10 | a '-1.7' implies m2 = -0.0341846 kg, which must be 0 or more, and finite
a=-9.9 m1=None M=10 | a '-9.9' must be above -9.80665 m/s², that of free fall
a=0 m1=0 m2=None M=10 | a '0' implies that both masses are 0
a=0 M=inf | a '0' must be above 0, as m2 is the heavier mass
a=5 M=inf | a '5' is too large for any friction: without it the acceleration is 4.90 m/s²
a=-1 M=inf | a '-1' must be above 0, as m2 is the heavier mass
a=1 M=inf m1=0 | a '1' has no place beside M = inf and a free end, which is fixed to the pulley;
    leave it out
a=1 M=inf mu=0.3 mu_k=0.2 | a '1' and mu_k both tell how the string slides; leave one of them out
a=1 M=10 mu=0.3 | a '1' has no place beside mu = 0.3, with which the string does not slip; leave mu
    out
a=0.7 M=inf mu=0.3 | a '0.7' is that of a string with more kinetic friction than mu; check both
a=1 M=inf m2=None | a '1' has no place beside M = inf, which lets nothing move; leave one of them
    out
a=1 M=1 g=9.8 | a '1' leaves nothing to find beside both M and g; leave one of them out
a=1 m2=1 | a '1' tells nothing of equal masses, which rest on any pulley; leave it out
a=0 | a '0' must be above 0, as m2 is the heavier mass
a=-1 | a '-1' must be above 0, as m2 is the heavier mass
a=4.9034 | a '4.9034' implies M = -0.000122364 kg, which must be 0 or more (inf locks the pulley)
a=5.00(3) | a '5.00(3)' implies M = -0.15468 kg, which must be 0 or more (inf locks the pulley)
a=1 m1=3 m2=1 | a '1' must be below 0, as m1 is the heavier mass
drop=1 time=0.500(5) | time '0.500(5)' implies M = -3.09668 kg, which must be 0 or more (inf locks
    the pulley)
a=-1 M=1 | a '-1' must be above 0, as m2 is the heavier mass
a=0 M=1 m1=4 | a '0' must be below 0, as m1 is the heavier mass
a=1.0(0.1) | a '1.0(0.1)' is not a number with its uncertainty; write it like 1.000±0.002, 1.000+-0.002
    or 1.000(2), and a unit after that
"""


@pytest.mark.parametrize(("given", "message"), table(ERRORS))
def test_errors(given: str, message: str) -> None:
    with pytest.raises(SceneError) as caught:
        solve(**inputs(given))
    assert str(caught.value) == message


@pytest.mark.parametrize("a", [float("nan"), float("-inf")])
def test_an_acceleration_is_a_finite_number(a: float) -> None:
    with pytest.raises(SceneError, match=f"^a {a} must be finite$"):
        solve(m1=1, m2=3, a=a)


def test_only_of_what_the_scene_does_not_ask_names_the_option(atwood: Atwood) -> None:
    words = [word for name in MEASURED_NAMES for word in ("--only", name)]
    ran = atwood("solve", "--m1", "1", "--m2", "3", "--M", "10", *words)
    assert (ran.status, ran.out) == (1, "")
    assert ran.err.splitlines() == [
        "atwood: pulley_mass, moment_of_inertia: give a, a measured acceleration, in place of M.",
        "atwood: gravity: give a, a measured acceleration, beside M and in place of g.",
        "atwood: m1: give a, a measured acceleration, and M in place of m1.",
        "atwood: m2: give a, a measured acceleration, and M in place of m2.",
        "atwood: mu_k: give a, a measured acceleration, beside M = inf, or beside M and a mu that is too small.",
        "atwood: fall_time, final_speed: give drop, the height that the heavier mass falls from rest.",
    ]


@pytest.mark.parametrize("given", [["--m2", "1"], ["--m2", "3", "--M", "inf"]])
def test_what_rests_does_not_fall(given: list[str], atwood: Atwood) -> None:
    ran = atwood("solve", "--m1", "1", *given, "--drop", "1", "--only", "fall_time", "--only", "final_speed")
    assert (ran.status, ran.out) == (1, "")
    assert ran.err == "atwood: fall_time, final_speed: does not exist, as nothing moves.\n"


def test_a_fall_that_needs_the_pulley(atwood: Atwood) -> None:
    ran = atwood("solve", "--m1", "1", "--m2", "3", "--mu", "0.4", "--drop", "1", "--only", "fall_time")
    assert (ran.status, ran.err) == (1, "atwood: fall_time: give M, the pulley's mass, which decides here.\n")


# How they are shown


FROM_PULLEY_AND_FALL = ("pulley_mass", "moment_of_inertia", "fall_time", "final_speed")
LAB = ["solve", "--m1", "1", "--m2", "3", "--a", "1.00(1)", "--R", "10cm", "--drop", "2"]


def test_the_scene_shows_what_was_measured_and_not_what_was_found(atwood: Atwood) -> None:
    ran = atwood(*LAB)
    assert (ran.status, ran.err) == (0, "")
    assert "wrap = 180°, a = 1.00 ± 0.01 m/s²,\ndrop = 2 m\n" in ran.out
    assert ", M = " not in ran.out.splitlines()[0]


def test_json_has_null_for_what_was_not_found_and_csv_has_no_column(atwood: Atwood) -> None:
    def found(printed: dict[str, Any]) -> set[str]:
        return {name for name in MEASURED_NAMES if printed[name] is not None}

    printed = json.loads(atwood(*LAB, "--json").out)
    assert found(printed) == set(FROM_PULLEY_AND_FALL)
    assert printed["scene"]["M"] is None
    assert (printed["scene"]["a"], printed["scene"]["drop"], printed["scene"]["time"]) == (1, 2, None)
    gravity = json.loads(atwood("solve", "--m1", "1", "--m2", "3", "--M", "7", "--a", "1.5", "--json").out)
    assert found(gravity) == {"gravity"}
    assert (gravity["scene"]["g"], gravity["gravity"]) == (None, 5.625)
    names, values = csv.reader(io.StringIO(atwood(*LAB, "--csv").out))
    here = [*NAMES, *FROM_PULLEY_AND_FALL]
    assert names == [*here, *(f"u_{name}" for name in here[1:])]
    assert dict(zip(names, values, strict=True))["pulley_mass"] == "31.2266"


# By T = m (g ± a), and M/2 = (T_h - T_l)/a.
FOUND = """
--m1 1 --m2 3 --M 0 --a 2                | gravity = 4.00000 m/s²
--m1 1 --m2 3 --a 2                      | pulley_mass = 11.6133 kg
--m1 1 --M 0.8 --a 4.903325              | m2 = 3.40000 kg
--m2 3 --M 0 --a 4.903325                | m1 = 1.00000 kg
--m1 1 --m2 3 --M inf --a 4.903325       | mu_k = 0
--m1 1 --m2 3 --M 0 --g 8 --drop 2       | fall_time = 1.00000 s, final_speed = 4.00000 m/s
--m1 1 --m2 3 --M 0 --drop 1 --time 1    | gravity = 4.00000 m/s², acceleration = 2.00000 m/s²,
    final_speed = 2.00000 m/s
--m1 1 --m2 3 --M 0 --a 2 --drop 1 --all | gravity = 4.00000 m/s², fall_time = 1.00000 s,
    final_speed = 2.00000 m/s
--m1 1 --m2 3 --a 1.00(1) --R 10cm --drop 2 | pulley_mass = 31.23 ± 0.39 kg,
    moment_of_inertia = 0.1561 ± 0.0020 kg m², fall_time = 2.000 ± 0.010 s, final_speed = 2.000 ± 0.010 m/s
"""


@pytest.mark.parametrize(("words", "found"), table(FOUND))
def test_what_was_found_is_the_first_line_below_the_scene(atwood: Atwood, words: str, found: str) -> None:
    out = atwood("solve", *words.split()).out
    scene, below = out.split("\nFound: ")
    assert re.fullmatch(r"(\S+ = [^=]+)+", scene)
    assert below.replace("\n", " ").startswith(f"{found}. ")
    rows = re.findall(r"│ (\w+) ", out)
    assert "mu_verge" in rows
    assert not {*rows} & {*MEASURED_NAMES, *re.findall(r"(\w+) =", found)}


def test_it_is_bold_on_a_terminal() -> None:
    seen = on_terminal("solve", *"--m1 1 --m2 3 --M 0 --a 2".split(), columns=80)
    assert "\x1b[1mFound: gravity = 4.00000 m/s².\x1b[0m" in seen


def test_a_pulley_mass_without_a_decimal_is_no_trouble_for_json(atwood: Atwood) -> None:
    ran = atwood("solve", "--m1", "1", "--m2", "3", "--a", "0.3", "--json", "--only", "pulley_mass")
    assert json.loads(ran.out) == {"pulley_mass": float(2 * (Fraction("9.80665") * 2 / Fraction("0.3") - 4))}
    assert (
        json.loads(atwood("solve", "--m1", "1", "--m2", "3", "--a", "0.3", "--json").out)["scene"]["M"]
        is None
    )


def test_other_commands_and_solutions_know_nothing_of_them(atwood: Atwood) -> None:
    assert not any(getattr(solve(m1=1, m2=3, M=10), name) for name in MEASURED_NAMES)
    ran = atwood("sweep", "--m1", "1", "--m2", "3", "--M", "1:2:3", "--only", "fall_time")
    assert ran.err.startswith("atwood: --only 'fall_time' is no quantity; ")
    assert "No such option: --drop" in atwood("contact", "--m1", "1", "--m2", "3", "--drop", "1").err
    batch = process(shell="printf 'm1,m2\\n1,3\\n' | atwood batch - --only pulley_mass")
    assert batch.err.startswith("atwood: --only 'pulley_mass' is no quantity; ")


def test_help_has_a_panel_for_them(atwood: Atwood) -> None:
    words = atwood("solve", "-h").out
    assert all(option in words for option in ("Measured", "--a ", "--drop", "--time"))


def test_digits_and_signs() -> None:
    s = measured(m1="3", m2="1", a="-1", drop="1", digits=20)
    assert s.pulley_mass == Decimal("31.226600000000000000")
    assert s.fall_time == Decimal("1.4142135623730950488")
