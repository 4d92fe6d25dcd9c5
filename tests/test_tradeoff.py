"""`atwood tradeoff`: what it measures is held against an oracle, and broken formulas do not pass it."""

import csv
import io
import json
import re
import sys
from collections.abc import Iterator
from decimal import Decimal
from fractions import Fraction
from math import inf, nextafter, ulp
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest

from atwood_cli import solve_arrays
from atwood_cli.arithmetic.symbolic import Formula
from atwood_cli.arrays.double_double import Quick
from atwood_cli.arrays.expansion import Expansion, Expansions
from atwood_cli.arrays.plan import plan, questioning
from atwood_cli.arrays.program import OPERATIONS
from atwood_cli.cli import tradeoff as command
from atwood_cli.model.scene import Scene
from atwood_cli.tradeoff import measure as tradeoff
from atwood_cli.tradeoff.measure import (
    COUNTS,
    DECIMALS,
    SETTINGS,
    VALUES,
    March,
    Measured,
    Setting,
    counts,
    errors,
    marches,
    measure,
    timed,
    with_orders,
)
from atwood_cli.tradeoff.outcome import (
    ELEMENTS_LEGEND,
    PAPERS_SCENE,
    STARS,
    Tradeoff,
    advice,
    elements_in_words,
    front,
    in_seconds,
    legend,
    overall,
    percent,
    scientific,
    short,
    with_best,
)
from atwood_cli.tradeoff.scenes import FAMILIES, draw_scenes

from . import oracle
from .running import Atwood, misplaced, pages_seen, plain

NAMES = [setting.name for setting in SETTINGS]
G = 9.80665


@pytest.fixture
def briefly(monkeypatch: pytest.MonkeyPatch) -> None:
    """Few repeats of short runs: these tests are about the errors."""
    monkeypatch.setattr(tradeoff, "REPEATS", 2)
    monkeypatch.setattr(tradeoff, "RUN_SECONDS", 1e-4)
    monkeypatch.setattr(tradeoff, "TABLE", 0)
    monkeypatch.setattr(tradeoff, "COUNTS", (4, 10, 100, 1000))


def of(measured: list[Measured], setting: str) -> Measured:
    (one,) = [one for one in measured if one.setting == setting]
    return one


# Scenes


@pytest.mark.parametrize("family", FAMILIES)
def test_scenes_come_from_the_seed(family: str) -> None:
    first = draw_scenes(family, 30, 1)
    assert first == draw_scenes(family, 30, 1)
    assert first[:7] == draw_scenes(family, 7, 1)
    assert not any(row in first for row in draw_scenes(family, 30, 2))


def test_scenes_are_the_same_on_every_platform() -> None:
    """Exponents and mantissas are drawn apart, so that no library's power or logarithm has a say."""
    (ordinary,), (near,) = (draw_scenes(family, 1, 1) for family in ("ordinary", "near-critical"))
    assert list(ordinary.values()) == [
        0.16445123133464037,
        0.20210789773600948,
        0.8335547957401686,
        0.014586684315688787,
    ]
    assert list(near.values()) == [8.82546756886875, 1214.438866204906, 513.4088800424233, 0.8413462820148073]


def test_families_are_what_they_say() -> None:
    drawn = {family: draw_scenes(family, 300, 1) for family in FAMILIES}
    for rows in drawn.values():
        assert all(row["m1"] <= row["m2"] for row in rows)
    for row in drawn["ordinary"]:
        assert 0.007 < row["m1"] < 128
        assert 1.007 < row["m2"] / row["m1"] < 129
        assert 0.007 < row["M"] < 1024
    apart = [float(Fraction(row["m2"]) / Fraction(row["m1"]) - 1) for row in drawn["nearly-equal"]]
    assert 0 < min(apart) < 1e-14
    assert 1e-3 < max(apart) < 0.01
    assert 7e-31 < min(row["M"] for row in drawn["light-pulley"]) < 1e-28
    assert 1e-4 < max(row["M"] for row in drawn["light-pulley"]) < 1e-3
    exponents = [np.log10(row["m1"]) for row in drawn["whole-range"]]
    assert min(exponents) < -320 < 250 < max(exponents)
    near = drawn["near-critical"]
    m1, m2, M, mu = (np.array([row[name] for row in near]) for name in ("m1", "m2", "M", "mu"))
    critical = solve_arrays(m1, m2, mu=mu)["critical_pulley_mass"]
    least = solve_arrays(m1, 2 * m1, mu=mu, quantities=["least_heavier_mass"])["least_heavier_mass"]
    off = np.fmin(abs(M / critical - 1), abs(m2 / least - 1))
    assert 0 < off.min() < 1e-13
    assert off.max() < 1.1e-3


# Errors


@pytest.mark.usefixtures("briefly")
@pytest.mark.parametrize("family", FAMILIES)
def test_errors_are_those_against_the_oracle_and_promises_hold(family: str) -> None:
    rows = draw_scenes(family, 50, 4)
    measured = measure(family, rows)
    assert [(one.family, one.setting) for one in measured] == [(family, name) for name in NAMES]
    for one, setting in zip(measured[:-2], SETTINGS, strict=False):  # the oracle's balls end at 17 digits
        solved = setting.read(rows, setting.run(setting.prepare(rows, len(rows))))
        want = [oracle_error(row, values) for row, values in zip(rows, solved, strict=True)]
        off = sorted(error for error in want if error is not None)
        assert one.seconds > 0 <= one.spread
        assert one.share_wrong_regime == want.count(None) / len(rows)
        assert one.worst_ulp == pytest.approx(off[-1], rel=1e-9, abs=1e-12)
        assert one.share_over_4_ulp == sum(error > 4 for error in off) / len(off)
        assert one.percentile_99_ulp is not None
        assert off[int(0.98 * len(off)) - 1] <= one.percentile_99_ulp * (1 + 1e-9) <= off[-1] * (1 + 2e-9)
    # Half a unit in the last of the digits, of a number whose ulp is at least 2^-53 of it.
    most = {f"{digits} digits": 0.5 * 10.0 ** (1 - digits) * 2**53 for digits in DECIMALS}
    for name, ulps in {"certified": 4, "exact": 0.5, **most}.items():
        assert (of(measured, name).worst_ulp or 0) <= ulps
        assert of(measured, name).share_wrong_regime == 0
    assert of(measured, "paper, float64").share_wrong_regime > 0.1
    assert (of(measured, "paper, float32").worst_ulp or 0) > 1e6


def oracle_error(row: dict[str, float], got: dict[str, Any]) -> float | None:
    want = oracle.expected(Scene.read({"g": G, **row}))
    if got["regime"] != want["regime"]:
        return None
    worst = 0.0
    for name in VALUES:
        if want[name] is not None:
            nearest: Any = oracle.correctly_rounded(want[name], None)
            precise = Fraction(oracle.correctly_rounded(want[name], 60))
            value = got[name]
            if nearest == inf or abs(value) == inf or value != value:
                worst = max(worst, 0.0 if value == nearest else inf)
            else:
                worst = max(worst, float(abs(Fraction(value) - precise) / Fraction(ulp(nearest))))
    return worst


def test_what_is_lost_is_infinitely_wrong() -> None:
    right: dict[str, Any] = {"regime": "no-slip"} | dict.fromkeys(VALUES, 1.5)
    exact: dict[str, Any] = {"regime": "no-slip"} | dict.fromkeys(VALUES, Decimal("1.5"))
    for lost in (inf, -inf, float("nan")):
        assert errors([right | {"tension_1": lost}], [exact]) == [inf]
    assert errors([right | {"regime": "slip"}], [exact]) == []
    assert errors([right | {"tension_1": nextafter(1.5, inf)}], [exact]) == [1.0]
    assert errors([right], [dict.fromkeys(VALUES) | {"regime": "no-slip"}]) == [0.0]


# Measuring


class Clock:
    """A clock that runs only as it is told to."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.now = 0.0
        monkeypatch.setattr(tradeoff, "perf_counter", lambda: self.now)

    def passes(self, seconds: float) -> None:
        self.now += seconds


@pytest.mark.parametrize("interrupted", [None, 0, 1, 2, 5000, 20_000])
def test_an_interruption_does_not_count(interrupted: int | None, monkeypatch: pytest.MonkeyPatch) -> None:
    """One made so few calls be timed that it was the first call that counted."""
    clock, calls = Clock(monkeypatch), 0

    def run() -> None:
        nonlocal calls
        clock.passes(1e-6 + (calls == interrupted))
        calls += 1

    ((seconds, _),) = timed([run])
    assert seconds == pytest.approx(1e-6)
    assert calls > 5 * 0.9 * tradeoff.RUN_SECONDS / 1e-6


@pytest.mark.parametrize("seconds", [1e-7, 1e-5, 1e-3, 0.02, 1.0])
def test_rows_that_take_long_are_few(seconds: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """A table of 10,000 rows of 20 ms each was run eight times: half an hour."""
    clock, sizes = Clock(monkeypatch), []

    def run(size: int) -> None:
        clock.passes(size * seconds)
        sizes.append(size)

    slow = Setting("slow", lambda _, size: size, run, lambda rows, _: [{"regime": "slip"} for _ in rows])
    monkeypatch.setattr(tradeoff, "SETTINGS", [slow])
    (found,) = measure("any", [{"m1": 1.0, "m2": 3.0, "M": 10.0, "mu": 0.3}])
    assert found.seconds == pytest.approx(seconds)
    assert max(sizes) == tradeoff.TABLE or max(sizes) * seconds >= tradeoff.LONG_SECONDS
    assert clock.now < 200 or max(sizes) == tradeoff.SAMPLE


def test_the_best_are_those_that_none_beats() -> None:
    one = Measured("any", "one", 2.0, 0, 2.0, 2.0, 0, 0.0)
    lost = one._replace(worst_ulp=None, share_wrong_regime=1.0, seconds=1.0)
    some_wrong = one._replace(worst_ulp=9.0, share_wrong_regime=0.01, seconds=1.5)
    assert front([one, one]) == [one, one]
    for beaten in (
        one._replace(seconds=3.0),
        one._replace(worst_ulp=3.0),
        one._replace(worst_ulp=0.0, share_wrong_regime=0.01),
        one._replace(worst_ulp=None, share_wrong_regime=1.0),
    ):
        assert front([beaten, one]) == [one]
    for other in (one._replace(seconds=1.0, worst_ulp=3.0), lost, some_wrong):
        assert front([one, other]) == [other, one]
    assert front([one, some_wrong, lost, one._replace(seconds=3.0)]) == [lost, some_wrong, one]
    best = [one.setting for one in whole() if one.family == "whole-range" and one.best]
    assert best == [NAMES[0], "certified", "exact", "17 digits", "50 digits", "200 digits"]


def test_the_advice_is_from_the_numbers() -> None:
    times = dict(zip(NAMES, (1e-8, 2e-8, 4e-8, 2e-7, 5e-7, 3e-4, 3.5e-4, 5e-4), strict=True))
    off = dict(zip(NAMES, (inf, 1e9, 39.2, 1.8, 0.5, 0.4, 1e-34, 1e-184), strict=True))
    measured = [
        Measured(
            "ordinary", name, times[name], 0.1, off[name], off[name], 0.0, 0.3 * name.startswith("paper")
        )
        for name in NAMES
    ]
    assert advice(measured) == (
        "Take certified for results within 4 ulp (200 ns a scene), exact for the nearest double (500 ns),"
        " 50 digits for more digits (350 µs); fast (40 ns) was up to 39 ulp off."
    )
    wrong = [
        one._replace(family="b", share_wrong_regime=0.008) if one.setting == "fast" else one
        for one in measured
    ]
    assert advice([*measured, *wrong]).endswith("39 ulp off and mistook up to 0.8 % of the regimes.")
    hard = [
        one._replace(family="hard", seconds=6 * one.seconds) for one in measured if one.setting == "exact"
    ]
    assert "exact for the nearest double (500 ns, 3 µs if hard)," in advice([*measured, *hard])
    better = [one._replace(worst_ulp=0.3) if one.setting == "fast" else one for one in measured]
    assert advice(better) == (
        "Take fast for results within 4 ulp and the nearest double (40 ns a scene), 50 digits for more digits (350 µs)."
    )


def test_numbers_are_short() -> None:
    times = (4.1e-8, 2.5e-6, 0.000999999, 999.4e-6, 1e-6, 1.0, 1.5, 2e4)
    assert [in_seconds(x) for x in times] == "41 ns|2.5 µs|1 ms|999 µs|1 µs|1 s|1.5 s|2e4 s".split("|")
    shown = (None, inf, 0.0, 0.4999, 39.17, 5.2e14, 3.5e-184)
    assert [short(x) for x in shown] == "- inf 0 0.5 39 5.2e14 3.5e-184".split()
    assert [percent(x) for x in (0.0, 0.0084, 1.0, 1.3)] == ["0 %", "0.84 %", "100 %", "130 %"]
    assert [scientific(x) for x in (0.0, 8.46e-5, 0.058)] == ["0.0e0", "8.5e-5", "5.8e-2"]


# String elements


def test_elements_converge_until_rounding_takes_over(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tradeoff, "REPEATS", 1)
    monkeypatch.setattr(tradeoff, "RUN_SECONDS", 1e-4)
    marched = with_orders(list(marches(Scene.read(PAPERS_SCENE))))
    plain_, extrapolated = (
        [one for one in marched if one.extrapolated == way and one.elements] for way in (0, 1)
    )
    orders = {way: {one.elements: one.order for one in by} for way, by in ((2, plain_), (4, extrapolated))}
    assert all(orders[2][count] == pytest.approx(2, abs=0.02) for count in (30, 100, 300, 1000, 3000, 10000))
    assert all(orders[4][count] == pytest.approx(4, abs=0.07) for count in (30, 100, 300))
    for by in (plain_, extrapolated):
        (best,) = [one for one in by if one.best]
        assert best.relative_error == min(one.relative_error for one in by)
        assert best is not by[-1]
    closed = marched[-1]
    assert (closed.elements, closed.best) == (None, True)
    assert closed.relative_error < 2**-52
    with mpmath.workdps(30):
        tangent = mpmath.mpf("0.3") * mpmath.tan(mpmath.pi / 200)
        ratio = ((1 + tangent) / (1 - tangent)) ** 100
        error = ratio / mpmath.exp(mpmath.mpf("0.3") * mpmath.pi) - 1
    (hundred,) = [one for one in plain_ if one.elements == 100]
    assert hundred.relative_error == pytest.approx(float(error), rel=1e-8)


def test_ten_million_elements_only_if_asked() -> None:
    assert (COUNTS[0], COUNTS[-1], counts()[-1]) == (4, 10_000_000, 1_000_000)
    assert [counts(most)[-1] for most in (4, 9, 10, 5000, 10_000_000)] == [4, 4, 10, 3000, 10_000_000]


def test_orders_are_those_of_the_number_before() -> None:
    errors_ = {4: 1e-2, 40: 1e-4, 400: 0.0, 4000: 1e-3}
    marched = with_orders([March(count, False, 1.0, 0.0, error) for count, error in errors_.items()])
    assert [one.order for one in marched] == [None, pytest.approx(2), None, None]
    assert [one.best for one in marched] == [False, False, True, False]


# Broken formulas do not pass


@pytest.fixture
def traced_anew() -> Iterator[None]:
    """Programs are kept: what is broken shows in new ones, and must not in later ones."""
    for traced in (plan, questioning):
        traced.cache_clear()
    yield
    for traced in (plan, questioning):
        traced.cache_clear()


def plain_logarithm(x: Any, out: Any) -> None:
    np.log(1 + x, out)


def plain_exponential(x: Any, out: Any) -> None:
    np.exp(x, out)
    out -= 1


@pytest.mark.usefixtures("briefly", "traced_anew")
@pytest.mark.parametrize(
    ("name", "broken", "settings"),
    [("log1p", plain_logarithm, ["fast", "certified"]), ("expm1", plain_exponential, ["fast"])],
)
def test_plain_functions_show(
    name: str, broken: Any, settings: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    rows = draw_scenes("nearly-equal", 60, 1)
    assert (of(measure("nearly-equal", rows), "fast").worst_ulp or 0) < 100
    plan.cache_clear()
    monkeypatch.setitem(OPERATIONS, name, broken)
    after = measure("nearly-equal", rows)
    assert all((of(after, setting).worst_ulp or 0) > 1e6 for setting in settings)


@pytest.mark.usefixtures("briefly", "traced_anew")
def test_a_plain_exponential_shows_in_certified(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(self: Any, x: Any) -> Any:
        return Expansion(self, [Formula("exp", x.parts[0]) - 1.0], 2.0**-53)

    rows = draw_scenes("nearly-equal", 60, 1)
    for arithmetic in (Quick, Expansions):
        monkeypatch.setattr(arithmetic, "expm1", broken)
    after = of(measure("nearly-equal", rows), "certified")
    assert (after.worst_ulp or 0) > 1e6


# The command


@pytest.fixture
def brief(briefly: None) -> list[str]:
    return ["tradeoff", "--scenes", "6"]


def test_all_the_tables(atwood: Atwood, brief: list[str]) -> None:
    ran = atwood(*brief, "--all")
    assert (ran.status, ran.err) == (0, "")
    for family, about in FAMILIES.items():
        assert f"{family}: {about.meaning}\n" in ran.out
    for name in NAMES:
        assert len(re.findall(rf"│ [* ] {name} +│", ran.out)) == len(FAMILIES)
    assert f"{STARS} {legend()}" in in_one_line(ran.out)
    assert in_one_line(ELEMENTS_LEGEND) in in_one_line(ran.out)
    assert re.search(r"│ closed form │ \* \d\.\de-1[67] │", ran.out)
    # Which one is the fastest, a busy machine may tell otherwise.
    right = f"({'|'.join(name for name in NAMES if name not in ('fast', NAMES[0], NAMES[1]))})"
    assert re.search(rf"Take {right} for results within 4 ulp ", in_one_line(ran.out))


def in_one_line(words: str) -> str:
    return " ".join(words.split())


TIMES = (1.2e-8, 2.4e-8, 4.1e-8, 2.1e-7, 5.2e-7, 2.37e-4, 2.61e-4, 4.06e-4)
OFF = (8.5e14, 5e5, 39.2, 1.58, 0.499, 0.36, 4.2e-34, 3.5e-184)


def settings(family: str, seconds: Any = TIMES, off: Any = OFF, wrong: Any = [0.0] * 8) -> list[Measured]:
    """Every setting on a family, as if it had been measured so."""
    rows = zip(NAMES, seconds, off, wrong, strict=True)
    return with_best([Measured(family, name, t, 0.1, e, e, 0.0, w) for name, t, e, w in rows])


def whole() -> list[Measured]:
    """All families, about as they are."""
    slow = [*TIMES[:2], 1.71e-5, 1.47e-5, 1.54e-5, 7.91e-4, 8.51e-4, 1.12e-3]
    return [
        *settings("ordinary", wrong=[0.27, 0.27, *[0.0] * 6]),
        *settings("nearly-equal", off=[inf, 3.9e16, 7.8, *OFF[3:]], wrong=[0.484, 0.484, *[0.0] * 6]),
        *settings("light-pulley", off=[1.7e16, 1.5e16, 13.9, *OFF[3:]], wrong=[0.2, 0.2, *[0.0] * 6]),
        *settings(
            "near-critical", off=[inf, 4e14, 1.9e14, *OFF[3:]], wrong=[0.434, 0.434, 0.006, *[0.0] * 5]
        ),
        *settings("whole-range", slow, [inf, inf, 1.1, 0.676, *OFF[4:]], [0.868, 0.868, *[0.0] * 6]),
    ]


MARCHED = with_orders(
    [
        *(
            March(count, halved, 2e-5 + 1e-8 * count * (1 + halved), 0.1, max(error, 1e-12 / count**0.1))
            for count in counts()
            for halved, error in ((False, 0.9 / count**2), (True, 3.0 / count**4))
        ),
        March(None, False, 4.6e-8, 0.1, 6.1e-17),
    ]
)


def outcome(measured: list[Measured], marched: Any = MARCHED, notes: Any = (), scene: Any = None) -> Tradeoff:
    count, seed = (500, 1) if scene is None else (1, None)
    return Tradeoff(Scene.read(scene or PAPERS_SCENE), count, seed, measured, marched, list(notes))


HEAVY = {"m1": "1", "m2": "3", "M": "10", "mu": "0.3"}
OUTCOMES = {
    "all families": outcome(whole()),
    "a scene": outcome(settings("scene"), scene=HEAVY),
    "all lost": outcome(
        settings("ordinary", off=[inf] * 3 + [None, *OFF[4:]], wrong=[0.5, 1.0, 1.0, 1.0, *[0.0] * 4])
    ),
    "all alike": outcome(settings("scene", [1e-6] * 8, [0.1] * 6 + [1e-34, 1e-184]), scene=HEAVY),
    "no error": outcome(settings("scene", off=[0.0] * 8), scene=HEAVY),
    "no elements": outcome(
        whole()[16:32], [], ["String elements run in doubles, which this scene is too large for."]
    ),
}


@pytest.fixture
def screen(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Any:
    """The lines that a terminal of 80 columns shows of an outcome."""
    for name, value in (("FORCE_COLOR", "1"), ("TERM", "xterm"), ("COLUMNS", "80"), ("LINES", "24")):
        monkeypatch.setenv(name, value)

    def lines(shown: Tradeoff, everything: bool = False) -> list[str]:
        monkeypatch.setattr(sys, "__stdout__", sys.stdout)
        command._forms(shown, everything).page()
        return [line.rstrip() for line in plain(capsys.readouterr().out).splitlines()]

    return lines


@pytest.mark.parametrize("name", OUTCOMES)
def test_the_answer_is_on_one_screen(name: str, screen: Any) -> None:
    """24 lines of 80 columns, one of them for the prompt."""
    shown = screen(OUTCOMES[name])
    assert len(shown) <= 23
    assert max(map(len, shown)) <= 80
    assert OUTCOMES[name].advice in " ".join(shown)


def test_the_table_is_of_what_none_beats(screen: Any) -> None:
    shown = screen(OUTCOMES["all families"])
    assert shown[:12] == [
        "Settings that no other beats (--all shows the rest): 500 scenes each of",
        "ordinary, nearly-equal, light-pulley, near-critical, whole-range (seed 1)",
        "╭────────────────┬────────┬─────────────────────┬─────────────┬────────╮",
        "│ Setting        │   Time │      Slowest family │ Error (ulp) │  Wrong │",
        "├────────────────┼────────┼─────────────────────┼─────────────┼────────┤",
        "│ paper, float32 │  12 ns │                     │         inf │ 86.8 % │",
        "│ fast           │  41 ns │ 17.1 µs whole-range │      1.9e14 │  0.6 % │",
        "│ certified      │ 210 ns │ 14.7 µs whole-range │         1.6 │    0 % │",
        "│ exact          │ 520 ns │ 15.4 µs whole-range │         0.5 │    0 % │",
        "│ 17 digits      │ 237 µs │                     │        0.36 │    0 % │",
        "│ 50 digits      │ 261 µs │                     │     4.2e-34 │    0 % │",
        "│ 200 digits     │ 406 µs │                     │    3.5e-184 │    0 % │",
    ]
    rest = in_one_line(" ".join(shown[13:]))
    assert rest == f"{advice(whole())} {legend(5)} {elements_in_words(MARCHED)}"
    assert "Time: of one scene of the first family. Error: of the worst result, " in rest
    assert "Time: of one scene. Error: " in in_one_line(" ".join(screen(OUTCOMES["a scene"])))
    shown = screen(OUTCOMES["a scene"])
    assert in_one_line(" ".join(shown[:2])) == (
        "Settings that no other beats (--all shows the rest): scene: m1 = 1 kg, m2 = 3 kg, M = 10 kg, mu = 0.3,"
        " g = 9.80665 m/s², inertia = 0.5, wrap = 180°"
    )
    assert shown[3] == "│ Setting        │   Time │ Error (ulp) │ Wrong │"
    assert "String elements run in doubles, which this scene is too large for." in screen(
        OUTCOMES["no elements"]
    )


def test_all_families_count_together() -> None:
    by_name = {one.setting: one for one in overall(whole())}
    assert list(by_name) == NAMES
    fast, certified = by_name["fast"], by_name["certified"]
    assert (fast.seconds, fast.slowest, fast.longest) == (4.1e-8, "whole-range", 1.71e-5)
    assert (fast.worst_ulp, fast.share_wrong_regime) == (1.9e14, 0.006)
    assert (certified.worst_ulp, certified.share_wrong_regime) == (1.58, 0.0)
    assert by_name["17 digits"].slowest is None  # no five times as long
    (lost, *_) = [
        one for one in overall([*settings("a"), *settings("b", off=[None] * 8)]) if one.setting == "fast"
    ]
    assert lost.worst_ulp == 39.2
    assert [one.setting for one in front(overall(whole()))] == [name for name in NAMES if "64" not in name]


def test_the_elements_in_a_sentence() -> None:
    marched = with_orders(
        [
            March(1000, False, 3.35e-5, 0.1, 8.4e-7),
            March(300_000, False, 0.0169, 0.1, 3.0e-11),
            March(3000, True, 9.96e-5, 0.1, 4.1e-13),
            March(None, False, 5.47e-8, 0.1, 6.1e-17),
        ]
    )
    assert elements_in_words(marched) == (
        "At best, 300,000 string elements give e^(μφ) to 3.0e-11 (16.9 ms), 3,000 extrapolated to 4.1e-13"
        " (99.6 µs); the closed form to 6.1e-17 (54.7 ns)."
    )
    assert elements_in_words(marched[-1:]) == "The closed form gives e^(μφ) to 6.1e-17 (54.7 ns)."
    exactly = [one._replace(relative_error=0.0, best=True) for one in marched]
    assert elements_in_words([exactly[0], exactly[-1]]) == (
        "At best, 1,000 string elements give e^(μφ) exactly (33.5 µs); the closed form exactly (54.7 ns)."
    )


def test_json(atwood: Atwood, brief: list[str]) -> None:
    ran = atwood(*brief, "--json", "--seed", "7", "--family", "whole-range", "--family", "ordinary")
    printed = json.loads(ran.out)
    assert (printed["seed"], printed["scenes"], printed["notes"]) == (7, 6, [])
    assert [(one["family"], one["setting"]) for one in printed["arithmetic"]] == [
        (family, name) for family in ("whole-range", "ordinary") for name in NAMES
    ]
    assert list(printed["arithmetic"][0]) == list(Measured._fields)
    assert [list(one) for one in printed["elements"]] == [list(March._fields)] * 9
    lost = printed["arithmetic"][0]
    assert lost["worst_ulp"] is None  # infinite
    again = json.loads(
        atwood(*brief, "--json", "--seed", "7", "--family", "ordinary", "--elements", "99").out
    )
    assert [one["elements"] for one in again["elements"]] == [4, 4, 10, 10, None]
    kept = [name for name in Measured._fields if name not in ("seconds", "spread", "best")]
    for one, other in zip(printed["arithmetic"][len(NAMES) :], again["arithmetic"], strict=True):
        assert [one[name] for name in kept] == [other[name] for name in kept]


def test_csv(atwood: Atwood, brief: list[str]) -> None:
    ran = atwood(*brief, "--csv", "--family", "near-critical")
    rows = list(csv.DictReader(io.StringIO(ran.out)))
    assert [row["setting"] for row in rows] == [*NAMES, *["elements"] * 8, "closed form"]
    assert {row["best"] for row in rows} == {"true", "false"}
    assert float(rows[NAMES.index("exact")]["worst_ulp"]) <= 0.5
    assert ran.err.startswith("atwood: Take ")


@pytest.mark.usefixtures("briefly")
def test_a_scene_of_ones_own(atwood: Atwood) -> None:
    printed, mirrored = (
        json.loads(atwood("tradeoff", *f"{masses} --M 10 --mu 0.3 --json".split()).out)
        for masses in ("--m1 1 --m2 3", "--m1 3 --m2 1")
    )
    assert printed["scene"]["M"] == 10
    assert {one["family"] for one in printed["arithmetic"]} == {"scene"}
    assert printed["arithmetic"][1]["worst_ulp"] < 10
    for one, other in zip(printed["arithmetic"], mirrored["arithmetic"], strict=True):
        assert one["worst_ulp"] == other["worst_ulp"]


@pytest.mark.usefixtures("briefly")
@pytest.mark.parametrize(
    ("given", "wrong"),
    [
        ("--m1 1 --m2 3", 0),
        ("--m1 1 --m2 3 --mu 0.3", 0),
        ("--m1 1 --m2 3 --M 1e-9", 0),
        ("--m1 2 --m2 2 --M 1", 0),
        ("--m1 1 --m2 3 --M inf --mu 0.2", 1),  # it slips, which the paper's formulas do not know
        ("--m1 1 --m2 3 --M 500 --mu 0.3 --mu-k 0.2 --inertia hoop --wrap 3.5rad --R 5cm --g moon", 1),
    ],
)
def test_scenes_of_every_kind(given: str, wrong: int, atwood: Atwood) -> None:
    printed = json.loads(atwood("tradeoff", *given.split(), "--json").out)
    for one in printed["arithmetic"]:
        if one["setting"] in ("certified", "exact") or "digits" in one["setting"]:
            assert one["share_wrong_regime"] == 0
            assert one["worst_ulp"] <= (4 if one["setting"] == "certified" else 0.5)
    assert printed["arithmetic"][1]["share_wrong_regime"] == wrong
    assert (printed["arithmetic"][1]["worst_ulp"] is None) == bool(wrong)


@pytest.mark.usefixtures("briefly")
@pytest.mark.parametrize(
    ("given", "note"),
    [
        (
            "--m1 0",
            "String elements: not defined for a free end: the string is fixed to the pulley and no friction holds it.",
        ),
        *(
            (f"--m1 1 --mu {mu}", "String elements run in doubles, which this scene is too large for.")
            for mu in ("700", "7e7", "1e9")
        ),
    ],
)
def test_where_no_elements_can_be(given: str, note: str, atwood: Atwood) -> None:
    words = ["tradeoff", "--m2", "3", "--M", "1", *given.split()]
    printed = json.loads(atwood(*words, "--json").out)
    assert (printed["elements"], printed["notes"]) == ([], [note])
    assert note in in_one_line(atwood(*words).out)


@pytest.mark.parametrize("name", OUTCOMES)
def test_a_figure_can_be_read(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """No words lie over others; each stands by its own point, or has a line to it."""
    pytest.importorskip("matplotlib")
    from matplotlib.text import Text

    from atwood_cli.output.tradeoff_figure import save

    shown = OUTCOMES[name]
    with pages_seen(monkeypatch) as pages:
        save(shown, str(tmp_path / "a.svg"), force=False)
    (page,) = pages
    assert misplaced(page) == []
    drawn = [line for text in page.findobj(Text) for line in text.get_text().splitlines()]
    for setting in NAMES:
        assert drawn.count(setting) == len(shown.families), setting
    caption = in_one_line(" ".join(drawn))
    assert f"{shown.advice} Hollow: another setting is both faster and more accurate." in caption
    assert ("m₁ = 1 kg, m₂ = 3 kg" in caption) == (shown.seed is None)
    assert {"worst error ε (ulp)", "time of one scene t (s)"} <= set(drawn)
    elements = {
        "e^(μφ) by string elements",
        "relative error δ",
        "time t (s)",
        "closed form",
        "plain",
        "N = 10",
    }
    assert (elements <= set(drawn)) == bool(shown.marches)
    assert shown.seed is None or set(shown.families) <= set(drawn)
    points = [
        line
        for axes in page.axes
        for line in axes.lines
        if line.get_marker() == "o" and len(line.get_xdata()) == 1
    ]
    assert len(points) == len(shown.measured)
    hollow = [line for line in points if line.get_markerfacecolor() == "white"]
    assert len(hollow) == sum(not one.best for one in shown.measured)
    for axes in page.axes[: len(shown.families)]:
        names = [text for text in axes.texts if text.get_text() != "4 ulp"]
        places = [axes.transData.transform(text.xy) for text in names]
        for text, own in zip(names, places, strict=True):
            box = Text.get_window_extent(text)
            off = [np.hypot(*(place - place.clip(box.min, box.max))) for place in (own, *places)]
            assert text.arrow_patch or off[0] == min(off)


@pytest.mark.usefixtures("briefly")
@pytest.mark.parametrize("more", ["--M 10 --wrap 1e-300 --mu 1e-300", "--mu 0 --bare", "--M 10 --mu 400"])
def test_elements_without_an_error_have_no_place_on_a_logarithmic_axis(
    atwood: Atwood, tmp_path: Path, more: str
) -> None:
    pytest.importorskip("matplotlib")
    words = ["tradeoff", "--m1", "1", "--m2", "3", *more.split()]
    figure = atwood(*words, "--figure", str(tmp_path / "a.svg"))
    assert (figure.status, figure.err) == (0, "")
    assert ("Hollow" in (tmp_path / "a.svg").read_text(encoding="utf-8")) == ("--bare" not in more)


ERRORS = """
--family ordinry -> --family 'ordinry' is no family of scenes; did you mean ordinary?
--family x -> --family 'x' is no family of scenes; there are ordinary, nearly-equal, light-pulley, near-critical, whole-range
--all --json -> --all has no effect with --json; leave one of them out
--csv --all -> --all has no effect with --csv; leave one of them out
--elements 3 -> --elements '3' must be a whole number from 4 to 10000000
--elements 10000001 -> --elements '10000001' must be a whole number from 4 to 10000000
--scenes 0 -> --scenes '0' must be a whole number from 1 to 100000
--seed -1 -> --seed '-1' must be a whole number from 0 to 1000000000
--m1 1 --m2 3 --seed 1 -> --seed '1' has no effect with --m1; leave one of them out
--m1 1 --m2 3 --scenes 9 -> --scenes '9' has no effect with --m1; leave one of them out
--m1 1 --m2 3 --family ordinary -> --family 'ordinary' has no effect with --m1; leave one of them out
--m1 1 -> --m2 is missing; give both masses, m1 and m2
--m1 1e400 --m2 3 -> --m1 '1e400' is beyond the doubles, which are measured here
--m1 1 --m2 3 --M 1e-400 -> --M '1e-400' is beyond the doubles, which are measured here
--m1 1 --m2 3 --I 2 --R 1 -> --I '2' is not measured, as the paper's formulas do not take it; give --inertia
--figure x.gif -> --figure 'x.gif' must end in one of .svg, .png, .pdf
--json --csv -> --json has no effect with --csv; leave one of them out
"""


@pytest.mark.parametrize("line", ERRORS.strip().splitlines())
def test_errors(line: str, atwood: Atwood) -> None:
    arguments, error = line.split(" -> ")
    ran = atwood("tradeoff", *arguments.split())
    assert (ran.status, ran.out, ran.err) == (2, "", f"atwood: {error}\n")
