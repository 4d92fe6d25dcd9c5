"""`atwood tradeoff`: what it measures is held against an oracle."""

import json
from fractions import Fraction
from hashlib import sha256
from math import inf, isfinite, ulp
from statistics import median
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from atwood_cli.solver.quantities import REGIMES, STANDARD
from atwood_cli.tradeoff import measure as tradeoff
from atwood_cli.tradeoff.measure import FAMILIES, SETTINGS, draw_scenes, measure
from atwood_cli.tradeoff.tradeoff_page import LEGEND, short

from .tools import oracle
from .tools.running import Atwood, called
from .tools.scenes import read_scene

NAMES = [*SETTINGS]


@pytest.fixture
def briefly(monkeypatch: pytest.MonkeyPatch) -> None:
    """Few repeats of short runs: these tests are about the errors."""
    for name, few in {"REPEATS": 2, "FEWEST_ROWS": 1, "MOST_ROWS": 1}.items():
        monkeypatch.setattr(tradeoff, name, few)


# Scenes


DRAWN = {
    "ordinary": "b15316416f4a6df0",
    "nearly-equal": "0422e1f9e933e982",
    "light-pulley": "7fa0d5951d16ba92",
    "near-critical": "d1f66368602dcd5d",
    "whole-range": "92bfbf5e55692c31",
}
"""How the SHA-256 of 300 scenes begins."""


@pytest.mark.parametrize("family", FAMILIES)
def test_scenes_come_from_the_seed_the_same_on_every_platform(family: str) -> None:
    """Exponents and mantissas are drawn apart, so that no library's power or logarithm has a say."""
    rows = draw_scenes(family, 300, 1)
    assert sha256(repr(rows).encode()).hexdigest().startswith(DRAWN[family])
    assert draw_scenes(family, 7, 1) == rows[:7]
    assert not any(row in rows for row in draw_scenes(family, 30, 2))


# Errors


@pytest.mark.usefixtures("briefly")
@pytest.mark.parametrize("family", FAMILIES)
def test_errors_are_those_against_the_oracle_and_promises_hold(family: str) -> None:
    rows = draw_scenes(family, 50, 4)
    measured = measure(family, rows)
    assert [(one.family, one.setting) for one in measured] == [(family, name) for name in NAMES]
    columns = {name: np.array([row[name] for row in rows]) for name in rows[0]}
    rights = [oracle.expected(read_scene(row)) for row in rows]
    by_setting = {one.setting: one for one in measured}
    for one in measured[:-1]:  # the oracle's balls end before 50 digits
        solved = SETTINGS[one.setting](**columns)
        got = zip(*(solved[name] for name in STANDARD), strict=True)
        off = [*map(oracle_error, rights, got)]
        assert one.seconds > 0
        assert one.share_wrong_regime == pytest.approx(off.count(None) / len(rows))
        right = [ulps for ulps in off if ulps is not None]
        for measured_ulp, ulps in ((one.worst_ulp, max(right)), (one.median_ulp, median(right))):
            assert measured_ulp == pytest.approx(ulps, rel=1e-9, abs=1e-12)
    # Half a unit in the last of the digits, of a number whose ulp is at least 2^-53 of it.
    for name, ulps in {"certified": 2e-14 * 2**53, "exact": 0.5, "50 digits": 0.5e-49 * 2**53}.items():
        assert (by_setting[name].worst_ulp or 0) <= ulps
        assert by_setting[name].share_wrong_regime == 0
    plain = by_setting["plain doubles"]
    if family in ("ordinary", "light-pulley", "whole-range"):  # of others, a few in a hundred are wrong
        assert (plain.share_wrong_regime > 0) == (family != "ordinary")
    assert (plain.median_ulp or 0) > 4
    assert (plain.median_ulp or 0) < 1e4 or family != "ordinary"  # it is the same model


def oracle_error(right: dict[str, Any], got: tuple[Any, ...]) -> float | None:
    """The worst error of a scene, in ulps; None where the regime is not right."""
    if REGIMES[got[0]] != right["regime"]:
        return None
    worst = 0.0
    for name, value in zip(STANDARD[1:], map(float, got[1:]), strict=True):
        if right[name] is not None:
            nearest: Any = oracle.correctly_rounded(right[name], None)
            precise = Fraction(oracle.correctly_rounded(right[name], 60))
            if isfinite(nearest) and isfinite(value):
                worst = max(worst, float(abs(Fraction(value) - precise) / Fraction(ulp(nearest))))
            elif value != nearest:
                worst = inf
    return worst


# Measuring


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    """It runs only as it is told to."""
    clock = SimpleNamespace(now=0.0)
    monkeypatch.setattr(tradeoff, "perf_counter", lambda: clock.now)
    return clock


@pytest.mark.parametrize("seconds", [1e-7, 1e-5, 1e-3, 0.02, 1.0])
def test_rows_that_take_long_are_few_and_an_interruption_does_not_count(
    seconds: float, clock: SimpleNamespace, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A table of 10,000 rows of 20 ms each was run eight times: half an hour."""
    sizes: list[int] = []

    def run(m1: Any, **_: Any) -> Any:
        sizes.append(len(m1))
        clock.now += sizes[-1] * seconds + (len(sizes) == 3)
        return dict.fromkeys(STANDARD, [0] * sizes[-1])

    monkeypatch.setattr(tradeoff, "SETTINGS", {"slow": run})
    (found,) = measure("any", [{"m1": 1.0, "m2": 3.0, "M": 10.0, "mu": 0.3}])
    assert found.seconds == pytest.approx(seconds)
    assert max(sizes) == tradeoff.MOST_ROWS or max(sizes) * seconds >= tradeoff.RUN_SECONDS - seconds
    assert sum(sizes) * seconds < 200 or max(sizes) == tradeoff.FEWEST_ROWS


def test_numbers_are_short() -> None:
    assert [short(x, 3) for x in (0.0138, 0.9999, 374.9, 1162.0)] == "0.0138 1 375 1.16e3".split()
    shown = (None, inf, 0.0, 0.4999, 39.17, 5.2e14, 3.5e-184)
    assert [short(x) for x in shown] == "- inf 0 0.5 39 5.2e14 3.5e-184".split()


# The command


@pytest.mark.usefixtures("briefly")
def test_one_table_family_by_setting() -> None:
    ran = called(["tradeoff", "--scenes", "6"], COLUMNS="80")
    assert (ran.status, ran.err) == (0, "")
    lines = ran.out.splitlines()
    assert lines[0] == "6 scenes of each family, seed 1"
    rows = [[cell.strip() for cell in line.strip("│").split("│")] for line in lines if line.startswith("│")]
    assert [row[:2] for row in rows[1:]] == [[family, name] for family in FAMILIES for name in NAMES]
    assert all(0.001 < float(row[2]) < 1e5 for row in rows[1:])
    assert all(float(row[4]) <= 0.5 for row in rows if row[1] == "exact")
    assert all(row[5] == "0 %" for row in rows if row[1] == "certified")
    assert max(len(line) for line in lines if line[0] in "│╭╰├") <= 80
    assert " ".join(" ".join(lines).split()).endswith(" ".join(LEGEND))


@pytest.mark.usefixtures("briefly")
def test_json(atwood: Atwood) -> None:
    printed, again = (
        json.loads(atwood(*f"tradeoff --scenes 40 --json {more} --family ordinary".split()).out)
        for more in ("--family whole-range", "")
    )
    assert (printed["seed"], printed["scenes"]) == (1, 40)
    found = [one | {"seconds": 0} for one in printed["settings"]]
    assert [one["family"] for one in found] == ["whole-range"] * len(NAMES) + ["ordinary"] * len(NAMES)
    assert found[0]["worst_ulp"] is None  # infinite
    assert found[len(NAMES) :] == [one | {"seconds": 0} for one in again["settings"]]
