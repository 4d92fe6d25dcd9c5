"""Friction in the axle: Newton's laws in exact fractions, every digit, and what is said of it."""

import json
from decimal import Decimal
from fractions import Fraction
from itertools import pairwise
from typing import Any

import pytest
from hypothesis import strategies as st

from atwood_cli import SceneError, solve
from atwood_cli.arithmetic.rational import EXACT
from atwood_cli.model.case import Case
from atwood_cli.model.quantities import AXLE_ENTERS
from atwood_cli.model.scene import Axle, Scene

from . import oracle
from .running import Atwood
from .scenes import inputs, table

masses = st.fractions(min_value=Fraction(1, 10**6), max_value=10**6)
forces = st.fractions(min_value=Fraction(1, 10**6), max_value=10**6)
NAMES = [name for name in oracle.NAMES[1:] if name not in ("friction_force_min", "friction_force_max")]


def test_the_ratio_grows_with_the_pulley_and_bends_where_the_axle_lets_go() -> None:
    l, b = Fraction(1), Fraction(1, 2)
    for c in (Fraction(1, 4), Fraction(1, 2), Fraction(3)):
        steps = [
            Case(Scene.read({"m1": l, "m2": l + b * h, "M": c, "inertia": "1", "g": 1, "axle": b}))
            for h in (Fraction(1, 2), 1, Fraction(3, 2), 10, 10**6)
        ]
        ratios_ = [case.excess("scene", EXACT) for case in steps]
        assert ratios_[:2] == [b / 2, b]  # the axle holds
        falls = [later < earlier for earlier, later in pairwise(ratios_[1:])]
        assert falls == [c < b] * 3
        assert abs(ratios_[-1] - (c + b) / 2) < Fraction(1, 10**5)


# What is said of it


VERDICTS = """
m1=200g m2=201g axle=16mN | At rest: the axle holds up to 1.63 g of difference. The string is assumed to
    hold, without mu: it does if mu is at least 0.00159.
m1=200g m2=201g axle=16mN mu=0.1 | At rest: the axle holds up to 1.63 g of difference. The string holds:
    mu = 0.1, and 0.00159 is enough.
m1=0 m2=1g axle=16mN | At rest: the axle holds up to 1.63 g of difference.
m1=0 m2=2g axle=16mN | Holds: the string's end is fixed to the pulley.
m1=0 m2=1.63153g axle=16mN | At rest: the axle holds up to 1.63154 g of difference.
m1=0 m2=1 axle=9.80665 | At rest: the axle holds up to 1.00 kg of difference.
m1=1 m2=3 M=inf axle=5N mu=0.2 | Slips: mu = 0.2 is below the 0.350 that would hold it.
m1=1 m2=1.2 axle=5N mu=0.01 mu_k=0.005 | Slips over a pulley that its axle holds: mu = 0.01 is below the
    0.0581 that would hold it, and slides with mu_k = 0.005.
m1=1 m2=3 M=300 axle=5N mu=0.2 mu_k=0.1 | Slips over a pulley that its axle holds: mu = 0.2 is below the
    0.344 that would hold it, and slides with mu_k = 0.1.
m1=1 m2=3 M=300 axle=5N mu=0.2 | Slips: mu = 0.2 is below the 0.344 that would hold it.
m1=1 m2=3 axle=5N mu=0.05 | Slips on any pulley, for the friction of its axle: mu = 0.05 is below the
    0.101 that would hold it on one without mass.
m1=1 m2=3 axle=5N mu=0 | Slips on any pulley, for the friction of its axle: mu = 0 is below the 0.101
    that would hold it on one without mass.
m1=1 m2=1 axle=5N | At rest: the masses are equal, so no friction is needed.
"""


@pytest.mark.parametrize(("given_", "verdict"), table(VERDICTS))
def test_verdicts(given_: str, verdict: str) -> None:
    """What the axle holds is rounded down, but not below what it does hold: 1.63 g would not be enough."""
    assert solve(**inputs(given_), digits=6).notes[0] == verdict


def test_the_rim_turns_or_is_held_in_slip() -> None:
    turning, held = (
        solve(m1="1", m2="3", M="300", axle="5N", mu="0.2", mu_k=mu_k, R="0.1") for mu_k in ("0.2", "0.1")
    )
    assert turning.torque is not None
    assert turning.rim_acceleration == pytest.approx((turning.torque / 0.1 - 5) / 150, rel=1e-12)
    assert held.torque is not None
    assert held.torque < 0.5
    assert held.rim_acceleration == held.angular_acceleration == 0
    mirrored = solve(m1="3", m2="1", M="300", axle="5N", mu="0.2", R="0.1")
    assert mirrored.rim_acceleration == -(turning.rim_acceleration or 0)
    a = (turning.acceleration or 0) + 1e-9
    measured: Any = solve(m1="1", m2="3", M="300", axle="5N", mu="0.2", a=a)
    assert measured.mu_k == pytest.approx(0.2)
    assert measured.rim_acceleration == pytest.approx(turning.rim_acceleration)
    measured = solve(m1="1", m2="3", M="300", axle="5N", mu="0.2", a=held.acceleration)
    assert measured.rim_acceleration == 0


def test_the_least_heavier_mass_exists_without_friction_of_the_string() -> None:
    """It was said that (36) does not apply, which is so of the verge on a pulley that turns freely."""
    for m2, mass in (("1", 1), ("1.2", 1), ("2", 1), ("0.9", 0.9)):
        s = solve(m1="1", m2=m2, axle="3", mu="0")
        assert s.least_heavier_mass == mass
        assert not any("do not apply" in note for note in s.notes)
    assert solve(m1="1", m2="2", mu="0").least_heavier_mass is None


def test_where_no_pulley_is_given_the_least_mu_is_that_of_one_without_mass() -> None:
    notes = solve(m1="1", m2="3", axle="2").notes
    assert (
        notes[0] == "Assumed to hold, without mu: it does on a pulley without mass if mu is at least 0.0420."
    )
    for pulley in ({"M": "0"}, {"M": "0.1"}, {"I": "1", "R": "1"}, {"M": "inf"}, {"a": "1"}):
        notes = solve(m1="1", m2="3", axle="2", **pulley).notes
        assert notes[0].startswith("Assumed to hold, without mu: it does if mu is at least ")


def test_a_light_pulley_slips_only_under_middling_masses() -> None:
    """The axle outweighs the pulley: the ratio falls with the heavier mass, once that moves."""
    given_: dict[str, Any] = {"m1": "1", "M": "0.1", "axle": "3", "mu": "0.08"}
    s: Any = solve(**given_, m2="1.5", digits=20)
    assert s.critical_heavier_mass == s.least_heavier_mass
    assert any("Under a much heavier mass it holds again" in note for note in s.notes)
    for mass, regime in (
        (s.critical_heavier_mass * Decimal("0.999999"), "no-slip"),
        (s.critical_heavier_mass * Decimal("1.000001"), "slip"),
        ("1.52", "slip"),
        ("1.53", "no-slip"),
        (1000, "no-slip"),
    ):
        assert solve(**given_, m2=mass).regime == regime
    assert not any("holds again" in note for note in solve(**{**given_, "M": "10"}, m2="1.5").notes)


def test_an_axle_of_no_friction_is_none() -> None:
    freely, zero = (solve(m1="1", m2="3", M="50", mu="0.3", axle=axle) for axle in (None, "0"))
    assert all(getattr(freely, name) == getattr(zero, name) for name in oracle.NAMES)
    assert freely.notes == zero.notes
    assert zero.scene.axle == Axle(Fraction(0))


# How it is given


@pytest.mark.parametrize(
    ("axle", "newtons"),
    [
        ("0.0153", "0.0153"),
        ("15.3mN", "0.0153"),
        ("2 N", "2"),
        ("0.001kN", "1"),
        ("1kgf", "9.80665"),
        ("1 lbf", "4.4482216152605"),
        ("0.5Nm", "10"),
        ("0.5 N m", "10"),
        ("20mNm", "0.4"),
        ("20 mN·m", "0.4"),
        ("1 lbf in", Fraction("4.4482216152605") * Fraction("0.0254") / Fraction("0.05")),
        (Decimal("0.5"), "0.5"),
        (Axle(Fraction(1, 2), "N m"), "10"),
    ],
)
def test_it_is_a_force_at_the_rim_or_a_torque(axle: Any, newtons: Any) -> None:
    scene = solve(m1="1", m2="3", R="5cm", axle=axle).scene
    assert Case(scene).axle_friction == Fraction(newtons)


@pytest.mark.parametrize(("name", "given_"), [("axle", (1, "N")), ("R", Axle(1))])
def test_what_is_no_number_is_refused(name: str, given_: Any) -> None:
    with pytest.raises(
        SceneError, match=rf"^{name} .* must be text or a number \(str, int, float, Decimal, Fr"
    ):
        solve(**{"m1": 1, "m2": 3, name: given_})


def test_not_given_nothing_of_it_shows(atwood: Atwood) -> None:
    words = ["--m1", "1", "--m2", "3", "--M", "10", "--R", "5cm"]
    for more in ([], ["--json"], ["--csv"], ["--explain"]):
        # "friction of the axle" is what the last step of an explanation says is not modelled.
        shown = (
            atwood("solve", *words, *more).out.replace("axle_force", "").replace("friction in the axle", "")
        )
        assert '"axle"' not in shown.replace('"axle": null', "")
        assert "axle = " not in shown
    assert json.loads(atwood("solve", *words, "--axle", "1N", "--json").out)["scene"]["axle"] == 1
    record = json.loads(atwood("solve", *words, "--axle", "20mNm", "--json").out)["scene"]
    assert record["axle"] == "0.02 Nm"
    assert solve(**{name: value for name, value in record.items() if value is not None}).scene.axle == Axle(
        Fraction("0.02"), "N m"
    )


def test_the_arc_beside_it_is_in_balance(atwood: Atwood) -> None:
    ran = atwood(
        *("contact", "--m1", "1", "--m2", "1.2", "--M", "1", "--axle", "5N", "--mu", "0.3", "--json"),
        *("--digits", "10"),
    )
    balance = json.loads(ran.out)["balance"]
    assert balance["torque"]["ends"] == pytest.approx(0.2 * 9.80665)  # held: the weights differ by that
    assert abs(balance["torque"]["residual"]) < 1e-8


# The inverse, and uncertainties


def test_whether_the_axle_holds_may_be_in_doubt() -> None:
    s = solve(m1="200g", m2="201.5(1)g", axle="16(2)mN")
    assert s.acceleration == 0
    assert s.uncertainty["acceleration"] == pytest.approx((9.80665 * 0.0015 - 0.014) / 0.4015 / 2)
    doubt = "Whether the axle holds the difference is in doubt: it is otherwise at m2 = 0.2017 kg"
    assert any(note.startswith(doubt) for note in s.notes)
    bend = solve(m1="1", m2="2.0(1)", g="10", axle="10N")
    assert bend.uncertainty["acceleration"] == pytest.approx(1 / 3.1 / 2)
    none = solve(m1="1", m2="3", M="10", axle="0.0(1)N")
    assert none.uncertainty["acceleration"] == pytest.approx(0.1 / 9 / 2)


def test_the_table_marks_the_equations_that_the_axle_enters(atwood: Atwood) -> None:
    rows = [
        line.split("│")
        for line in atwood(*"solve --m1 1 --m2 3 --M 10 --mu 0.3 --axle 5N --all".split()).out.splitlines()
    ]
    marked = {row[1].strip() for row in rows if len(row) > 5 and "+b" in row[5]}
    assert marked == AXLE_ENTERS & set(NAMES)


def test_on_a_pulley_without_mass_the_axle_alone_makes_the_string_slip() -> None:
    """A trial gave 0, which is so only of an axle without friction, and no test failed."""
    given: Any = {"m2": "3", "M": "0", "mu": "0.3", "axle": "5N"}
    critical = solve(m1="1", **given).critical_lighter_mass
    assert critical is not None
    assert round(critical, 6) == 0.189081
    regimes = [solve(m1=str(critical * factor), **given).regime for factor in (0.999, 1.001)]
    assert regimes == ["slip", "no-slip"]
    assert solve(m1="1", **{**given, "axle": None}).critical_lighter_mass == 0
