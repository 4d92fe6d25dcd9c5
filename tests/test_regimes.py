"""Where along a range the regime changes: the place found without a formula is that of the formulas."""

from decimal import Decimal
from fractions import Fraction
from itertools import pairwise
from math import log, pi
from random import Random
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from atwood_cli import solve
from atwood_cli.model.case import Case
from atwood_cli.sweep.changes import changes
from atwood_cli.sweep.ranges import read_sweep, with_value

from . import oracle
from .conftest import examples
from .scenes import with_friction


def found(digits: int | None = None, **given: str) -> list[tuple[str, str, str]]:
    swept = read_sweep(given)
    return [(one.before, one.at.text, one.after) for one in changes(swept.scene, swept.ranges[0], digits)]


positive = st.decimals(Decimal("0.01"), Decimal(100), places=4, allow_nan=False)


@given(positive, positive, st.decimals(Decimal("0.01"), 1, places=3), st.booleans(), st.integers(1, 30))
def test_it_is_the_critical_mass(
    light: Decimal, heavy: Decimal, mu: Decimal, down: bool, digits: int
) -> None:
    """Upwards, whichever way the range runs: "slip up to M = 43.3 kg" was said of one from 50 to 0."""
    critical = solve(m1=light, m2=heavy, mu=mu, digits=40).critical_pulley_mass
    ends = ("1e9", "0") if down else ("0", "1e9")
    places = found(digits, m1=str(light), m2=str(heavy), mu=str(mu), M=":".join([*ends, "2"]))
    if critical is None or critical > 10**9:
        assert places == []
        return
    ((before, at, after),) = places
    assert (before, after) == ("no-slip", "slip")
    place, unit = Decimal(at), Decimal(10) ** (critical.adjusted() - digits + 1)
    assert abs(place - critical) < unit
    assert place <= critical
    assert len(place.as_tuple().digits) == digits


@pytest.mark.parametrize(
    ("given", "quantity"),
    [
        ({"m2": "3.5:9:2", "M": "10", "mu": "0.3"}, "critical_heavier_mass"),
        ({"m2": "3", "M": "10", "mu": "0.01:1:2:log"}, "mu_verge"),
        ({"m2": "3", "M": "10", "mu": "0.3", "wrap": "30:330:2"}, "least_wrap"),
        ({"m2": "3", "mu": "0.01:1:2"}, None),
    ],
)
def test_it_is_what_the_formula_gives(given: dict[str, str], quantity: str | None) -> None:
    ((_, at, _),) = found(12, m1="1", **given)
    fixed: Any = {name: words for name, words in given.items() if ":" not in words} | {"m1": "1"}
    swept = next(name for name in given if ":" in given[name])
    if quantity is None:  # on a locked pulley
        exact = solve(**fixed, M="inf", digits=30).mu_verge
    else:
        exact = getattr(solve(**fixed, **{swept: given[swept].split(":")[0]}, digits=30), quantity)
    assert float(at) == pytest.approx(float(exact or 0), rel=1e-11)


def test_both_sides_are_in_their_regimes() -> None:
    swept = read_sweep({"m1": "0.1:30:5", "m2": "3", "M": "50", "mu": "0.1"})
    places = list(changes(swept.scene, swept.ranges[0]))
    assert [(one.before, one.after) for one in places] == [("slip", "no-slip"), ("no-slip", "slip")]
    for one in places:
        regimes = [Case(with_value(swept.scene, "m1", value)).regime for value in (one.last, one.first)]
        assert regimes == [one.before, one.after]
        assert one.at.exact <= one.last < one.first


def test_what_begins_and_ends_between_two_points_is_found() -> None:
    assert found(m1="1", m2="0.5:1.5:2", M="100", mu="0.01") == [
        ("slip", "0.967875", "no-slip"),
        ("no-slip", "1.03323", "slip"),
    ]


def test_a_window_of_slip_where_the_tension_ratio_turns_is_found() -> None:
    """Steps of a 64th of the range missed it."""
    assert found(m1="1", m2="0.5:70:4", M="0.5", mu="0.205", axle="9.8") == [
        ("slip", "0.525173", "no-slip"),
        ("no-slip", "1.90413", "slip"),
        ("slip", "2.55268", "no-slip"),
    ]


def check_with_oracle(words: dict[str, str], *places: float) -> int:
    """Hold what is said of a range to the oracle, there and within all that it says; how much it says."""
    swept = read_sweep(words)
    (along,) = swept.ranges
    said = list(changes(swept.scene, along))
    low, high = along.ends
    stretches = list(pairwise([low, *(end for one in said for end in (one.last, one.first)), high]))[::2]
    in_turn = [said[0].before if said else None, *(one.after for one in said)]
    for one in said:
        there = oracle.expected(with_value(swept.scene, along.name, one.at.exact))["regime"]
        assert there == (one.after if one.at.exact == one.first else one.before), (words, one)
    for (start, stop), regime in zip(stretches, in_turn, strict=True):
        values = [start + (stop - start) * Fraction(i, 5) for i in range(6)]
        for value in [*values, *(Fraction(x) for x in places if start < x < stop)]:
            there = oracle.expected(with_value(swept.scene, along.name, value))["regime"]
            assert there == (regime or Case(swept.scene).regime), (words, float(value))
    return len(said)


@examples(300)
@given(st.integers(0), st.sampled_from(["m1", "m2"]), st.booleans())
def test_windows_narrower_than_any_step_are_found(seed: int, name: str, down: bool) -> None:
    """With b > c the tension ratio peaks where the axle lets go of a swept mass, at m + b."""
    rng = Random(seed)
    m, b = round(10 ** rng.uniform(-2, 2), 4), round(10 ** rng.uniform(-2, 1), 4)
    highest = log(1 + b / m) / pi
    mu = highest * (1 - 10 ** rng.uniform(-12, -3))
    ends = [m + b * rng.uniform(0, 0.9), (m + b) * 10 ** rng.uniform(0.5, 4)]
    words = {"m1": repr(m), "m2": repr(m), "mu": repr(mu)}
    words |= {"M": f"{b * rng.random():.6f}", "g": "10", "axle": repr(10 * b)}
    words[name] = ":".join(map(repr, sorted(ends, reverse=down))) + ":5"
    assert check_with_oracle(words, m + b) == 2


# fmt: off
RANGES = {
    "m1": "0.05:50", "m2": "60:0.02", "M": "0:400", "mu": "0:1.5", "g": "0.5:200", "inertia": "0.01:9",
    "I": "0.0001:30", "R": "0.01:5", "wrap": "1:1000", "axle": "0:90",
}
# fmt: on
NOT_BESIDE = {"inertia": ["I"], "I": ["M", "inertia"], "M": ["I"]}


@examples(400)
@given(st.integers(0), st.sampled_from(sorted(RANGES)), st.sampled_from(["", ":log"]))
def test_what_is_said_of_any_parameter_is_so(seed: int, name: str, log_: str) -> None:
    words = {"mu": "0.2", "R": "0.3"} | with_friction(Random(seed))
    for other in NOT_BESIDE.get(name, []):
        words.pop(other, None)
    unit = "Nm" if name == "axle" and "Nm" in words.get("axle", "") else ""
    ends = [end if end != "0" or not log_ else "0.001" for end in RANGES[name].split(":")]
    words[name] = ":".join(f"{end}{unit}" for end in ends) + f":4{log_}"
    check_with_oracle(words)


def test_a_regime_of_one_point_that_no_decimal_is_is_said_exactly() -> None:
    """It was "no-slip at 0.0714285 kg", where the string slips."""
    ends = [("slip", "1/14", "no-slip"), ("no-slip", "1/14", "slip")]
    assert found(m1="0.05:0.5:3", m2="1/14", M="1", mu="0") == ends
    assert found(m1="1:2:2", m2="4/3", M="10", mu="0") == [
        ("slip", "4/3", "no-slip"),
        ("no-slip", "4/3", "slip"),
    ]


def test_a_regime_of_one_point_is_found_and_is_exactly_there() -> None:
    assert found(m1="1", m2="0.5:1.7:2", M="100", mu="0") == [
        ("slip", "1", "no-slip"),
        ("no-slip", "1", "slip"),
    ]
    assert found(m1="1", m2="3", M="0:50:2", mu="0") == [("no-slip", "0", "slip")]
    assert found(m1="1", m2="3", M="50:0:2", mu="0") == [("no-slip", "0", "slip")]


def test_places_at_the_ends_of_all_sizes() -> None:
    assert found(m1="1e-200", m2="1e-199", mu="0.3", M="0:1e300:6") == [("no-slip", "8.42831e-200", "slip")]
    assert found(m1="1e400", m2="3e400", mu="0.3", M="1e-400:1e450:9:log") == [
        ("no-slip", "4.33419e401", "slip")
    ]


def test_more_digits_where_fewer_would_say_what_a_row_denies() -> None:
    """The string holds at 43.34191 and slips at 43.34193: that it does from 43.3419 on would be wrong."""
    assert found(3, m1="1", m2="3", mu="0.3", M="43.34191:43.34193:2") == [("no-slip", "43.34192", "slip")]
    swept = read_sweep({"m1": "1", "m2": "3", "mu": "0.3", "M": "0:50:2"})
    (one,) = changes(swept.scene, swept.ranges[0], 3, {Fraction("43.3419"): "no-slip", Fraction(44): "slip"})
    assert one.at.text == "43.3419"


def test_an_axle_and_units_of_their_own() -> None:
    assert found(m1="1", m2="1.5", M="1", mu="0.1", axle="0:5:6") == [("no-slip", "3.56115", "slip")]
    assert found(m1="1", m2="3", M="20", mu="0.3", wrap="1rad:4rad:3") == [("slip", "2.70310rad", "no-slip")]
    torque = found(m1="1", m2="1.5", M="1", mu="0.1", R="0.5", axle="0Nm:2.5Nm:6")
    assert torque == [("no-slip", "1.78057Nm", "slip")]


def test_what_is_known_is_not_asked_again() -> None:
    swept = read_sweep({"m1": "1", "m2": "3", "M": "0:40:2", "mu": "0.3"})
    said = {Fraction(0): "slip"}  # as if
    (one,) = changes(swept.scene, swept.ranges[0], known=said)
    assert (one.before, one.at.exact, one.after) == ("slip", 0, "no-slip")
