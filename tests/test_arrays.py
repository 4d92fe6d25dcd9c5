"""Many scenes at once: against the oracle, against one scene at a time, and on odd rows."""

import tracemalloc
from collections import Counter
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from datetime import date
from decimal import Decimal
from fractions import Fraction
from functools import cache
from itertools import islice
from math import inf, isfinite, isnan, nan, ulp
from random import Random
from sys import maxsize
from threading import Barrier
from time import process_time
from typing import Any
from unittest.mock import Mock

import numpy as np
import polars as pl
import pytest
from hypothesis import given
from hypothesis import strategies as st

from atwood_cli import REGIMES, SceneError, arrays, solve, solve_arrays
from atwood_cli.arithmetic.lazy import lazy
from atwood_cli.arrays import STATUSES
from atwood_cli.arrays.plan import plan
from atwood_cli.model.case import Case
from atwood_cli.model.quantities import ACCURACIES, NAMES, STANDARD, Accuracy
from atwood_cli.model.scene import INPUTS, MASSES, Scene
from atwood_cli.solver.answers import Answers

from . import oracle
from .conftest import examples
from .running import HANGS
from .scenes import FAMILIES, scenes, with_axle

Row = dict[str, float]
solve_any: Any = solve  # with inputs that are put together here
G = 9.80665


def row_of(given: dict[str, str]) -> Row | None:
    """A scene's inputs as the doubles nearest to them, None if these are no such scene."""
    scene = Scene.read(given)
    numbers = scene._asdict() | {"wrap": scene.wrap.number, "axle": Case(scene).axle_friction}
    try:
        row = {name: float(value) for name, value in numbers.items() if value is not None}
    except OverflowError:
        return None
    return row if all(row.get(name, 1) for name in ("m1", "m2", "g", "I")) else None


@cache
def drawn(family: str, axle: bool) -> tuple[list[Row], Iterator[Row]]:
    """The rows of a family that were asked for, and those to come."""
    rng, given = Random(f"axles of {family}"), scenes(family, maxsize)
    read = map(row_of, (with_axle(rng, one) for one in given) if axle else given)
    return [], (row for row in read if row and (axle or "I" not in row))


def rows(family: str, count: int, axle: bool = False) -> list[Row]:
    """Without ``axle``, the pulley is given by its mass, and turns freely; with it, as it may be."""
    known, coming = drawn(family, axle)
    known += islice(coming, max(0, count - len(known)))
    return known[:count]


def columns(of: list[Row]) -> dict[str, Any]:
    """They cannot be written to, so that every test sees that inputs are left alone."""
    given = {
        name: np.ma.array([row.get(name, 0.0) for row in of], mask=[name not in row for row in of])
        for name in INPUTS
    }
    for column in given.values():
        column.flags.writeable = False
    return given


def within_promise(got: float, nearest: float) -> bool:
    """Whether a double is within 2e-14 of the exact value, to which `nearest` is the nearest double."""
    return got == nearest or abs(got - nearest) <= 2e-14 * abs(nearest) + 0.5 * ulp(nearest)


@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.parametrize("axle", [False, True])
def test_values_of_each_accuracy(family: str, axle: bool, pytestconfig: pytest.Config) -> None:
    """20,000 rows with --every-digit, as .ci/run has it; a quarter of them otherwise."""
    share = 1 if pytestconfig.getoption("every_digit") else 4
    given = rows(family, (1000 if axle else 3000) // share, axle)
    certified, exact = (solve_arrays(**columns(given), accuracy=accuracy) for accuracy in ACCURACIES)
    regimes: Counter[str] = Counter()
    for i, row in enumerate(given):
        want = oracle.expected(Scene.read(row))
        regimes[want["regime"]] += 1
        for results in (certified, exact):
            assert results["status"][i] == 0
            assert REGIMES[results["regime"][i]] == want["regime"], row
        for name in STANDARD[1:]:
            value = want[name]
            assert isnan(certified[name][i]) == isnan(exact[name][i]) == (value is None), (row, name)
            if value is not None:
                nearest = float(oracle.correctly_rounded(value, None))
                assert exact[name][i] == nearest, (row, name)
                assert within_promise(certified[name][i], nearest), (row, name, certified[name][i])
    assert min(regimes["slip"], regimes["no-slip"]) > 50 / share


def assert_is_solve(results: Any, i: int, row: Row, accuracy: str) -> None:
    """A row's results are those of `solve`: to the bit if exact, within 2e-14 if certified."""
    one = solve_any(**{"g": G} | row)
    for name, column in results.items():
        got, value = column[i].item(), getattr(one, name, 0)
        want = nan if value is None else value
        if name in ("regime", "status"):
            assert (REGIMES[got] == want) if name == "regime" else got == 0, row
        elif accuracy == "exact" or not isfinite(want):
            assert repr(got) == repr(want), (row, name)
        else:
            assert within_promise(got, want), (row, name, got)


@pytest.mark.parametrize("accuracy", ACCURACIES)
@pytest.mark.parametrize("family", FAMILIES)
def test_rows_are_as_one_scene(family: str, accuracy: Accuracy, pytestconfig: pytest.Config) -> None:
    given = rows(family, 150 if pytestconfig.getoption("every_digit") else 50)
    results = solve_arrays(**columns(given), accuracy=accuracy, quantities=NAMES)
    for i, row in enumerate(given):
        assert_is_solve(results, i, row, accuracy)


Columns = dict[str, Any]
Drawing = np.random.Generator


def _tiny(rng: Drawing, least: float = 12, most: float = 305) -> Any:
    """From about 2^-40 to beyond 2^-1000."""
    return rng.uniform(1, 2, CANCELLING_ROWS) * 10.0 ** -rng.uniform(least, most, CANCELLING_ROWS)


def _near_1(rng: Drawing, closest: float) -> Any:
    """Beside 1, by 1e-8 or less."""
    return 1 + rng.choice([-1, 1], CANCELLING_ROWS) * 10.0 ** -rng.uniform(8, closest, CANCELLING_ROWS)


def _usual(rng: Drawing, least: float = -1, most: float = 1) -> Any:
    return 10 ** rng.uniform(least, most, CANCELLING_ROWS)


def _masses(rng: Drawing) -> Columns:
    m1 = _usual(rng)
    return {"m1": m1, "m2": m1 * (1 + _usual(rng, -2)), "R": _usual(rng)}


def _turns(rng: Drawing) -> Any:
    return 360.0 * rng.integers(1, 4, CANCELLING_ROWS)


def light_pulley_whole_turns(rng: Drawing) -> Columns:
    return _masses(rng) | {"M": _tiny(rng), "wrap": _turns(rng)}


def light_pulley_short_wrap(rng: Drawing) -> Columns:
    return _masses(rng) | {"M": _tiny(rng, most=150), "wrap": _tiny(rng, 1, 150)}


def slip_on_a_short_wrap(rng: Drawing) -> Columns:
    return _masses(rng) | {"M": _usual(rng), "wrap": _tiny(rng, 4), "mu": _usual(rng, -1, 0)}


def slip_with_weak_friction(rng: Drawing) -> Columns:
    return _masses(rng) | {"M": _usual(rng), "wrap": _turns(rng), "mu": _tiny(rng)}


def verge_with_weak_friction(rng: Drawing) -> Columns:
    return _masses(rng) | {"wrap": _turns(rng), "mu": _tiny(rng)}


def masses_a_few_doubles_apart(rng: Drawing) -> Columns:
    m1, M = _usual(rng), _usual(rng) * _tiny(rng, 0, 20)
    m2 = m1 + np.spacing(m1) * rng.integers(1, 1000, CANCELLING_ROWS)
    return {"m1": m1, "m2": m2, "R": 1.0, "M": M, "wrap": _turns(rng)}


def near_the_least_heavier_mass(rng: Drawing) -> Columns:
    m1 = _usual(rng)
    apart = _tiny(rng, 0, 15)
    mu = np.log1p(apart) / np.pi * _near_1(rng, 16)
    return {"m1": m1, "m2": m1 * (1 + apart), "mu": mu, "M": _usual(rng, 0, 30), "R": 1.0}


def near_the_least_pulley_mass(rng: Drawing) -> Columns:
    given, mu = _masses(rng), _usual(rng, -10, 0)
    return given | {"mu": mu, "M": 4 * given["m1"] * np.expm1(mu * np.pi) * _near_1(rng, 16)}


def grip_with_little_to_spare(rng: Drawing) -> Columns:
    given, M = _masses(rng), _usual(rng)
    excess = (given["m2"] / given["m1"] - 1) * M / (4 * given["m2"] + M)
    return given | {"M": M, "mu": np.log1p(excess) / np.pi * (1 + _tiny(rng, 2, 15))}


def friction_straight_up(rng: Drawing) -> Columns:
    """Its part x changes its sign between two doubles of wrap."""
    given = _masses(rng) | {"mu": _usual(rng, -2, -0.5)}
    low, high = np.full((2, CANCELLING_ROWS), [[200.0], [500.0]])
    for _ in range(60):
        wrap = (low + high) / 2
        before = solve_arrays(**given, wrap=wrap, quantities=["friction_force_x"])["friction_force_x"] < 0
        low, high = np.where(before, wrap, low), np.where(before, high, wrap)
    return given | {"wrap": low}


def axle_that_just_holds(rng: Drawing) -> Columns:
    given = _masses(rng)
    return given | {"M": _usual(rng), "axle": G * (given["m2"] - given["m1"]) * _near_1(rng, 16)}


def axle_that_just_moves_on_a_rough_string(rng: Drawing) -> Columns:
    given, M = _masses(rng), rng.choice([0.0, inf, 3.0], CANCELLING_ROWS)
    axle = G * (given["m2"] - given["m1"]) * (1 - abs(1 - _near_1(rng, 15)))
    return given | {"M": M, "mu": _usual(rng, -2, 0), "axle": axle}


def slip_on_any_pulley_or_hardly(rng: Drawing) -> Columns:
    """Where the critical pulley mass is about 0."""
    given, mu = _masses(rng), _usual(rng, -3, -1)
    m1, m2 = given["m1"], given["m2"]
    z = m1 * np.expm1(mu * np.pi)
    return given | {"mu": mu, "axle": G * 2 * m2 * z / (m1 + m2 + z) * _near_1(rng, 16)}


def slip_on_an_axle_that_just_turns(rng: Drawing) -> Columns:
    given, mu = _masses(rng), _usual(rng, -3, -2)
    m1, m2, k = given["m1"], given["m2"], np.exp(mu * np.pi / 2)
    axle = (k - 1) * 2 * m1 * m2 * G / (m2 + m1 * k) * _near_1(rng, 16)
    return given | {"M": 1e3 * m2, "mu": mu, "mu_k": mu / 2, "axle": axle}


def axle_that_just_bears_the_heavier_mass(rng: Drawing) -> Columns:
    given = _masses(rng)
    return given | {"M": _usual(rng), "mu": _usual(rng), "axle": G * given["m2"] * _near_1(rng, 12)}


def pulley_of_a_tiny_moment_of_inertia(rng: Drawing) -> Columns:
    given = _masses(rng)
    return given | {"I": _tiny(rng, 4, 60), "axle": G * _tiny(rng, 4, 60), "wrap": _turns(rng), "mu": 0.2}


CANCELLING_ROWS = 48  # too many to be solved one by one from the start
CANCELLING: list[Callable[[Drawing], Columns]] = [
    light_pulley_whole_turns,
    light_pulley_short_wrap,
    slip_on_a_short_wrap,
    slip_with_weak_friction,
    verge_with_weak_friction,
    masses_a_few_doubles_apart,
    near_the_least_heavier_mass,
    near_the_least_pulley_mass,
    grip_with_little_to_spare,
    friction_straight_up,
    axle_that_just_holds,
    axle_that_just_moves_on_a_rough_string,
    slip_on_any_pulley_or_hardly,
    slip_on_an_axle_that_just_turns,
    axle_that_just_bears_the_heavier_mass,
    pulley_of_a_tiny_moment_of_inertia,
]


@pytest.mark.parametrize("family", CANCELLING, ids=lambda family: family.__name__)
def test_what_cancels_is_solve_to_the_bit(
    family: Callable[[Drawing], Columns], pytestconfig: pytest.Config
) -> None:
    """From 2^-40 to beyond 2^-1000: all quantities, and what FLINT has of them."""
    given = family(np.random.default_rng(24))
    results = {a: solve_arrays(**given, accuracy=a, quantities=NAMES) for a in ACCURACIES}
    for i, columns_ in enumerate(zip(*np.broadcast_arrays(*given.values()), strict=True)):
        row = {"g": G} | dict(zip(given, map(float, columns_), strict=True))
        for accuracy, found in results.items():
            assert_is_solve(found, i, row, accuracy)
        if i % 4 == 0 or pytestconfig.getoption("every_digit"):
            for name, independent in oracle.expected(Scene.read(row)).items():
                if name in NAMES[1:] and independent is not None:
                    assert results["exact"][name][i] == oracle.correctly_rounded(independent, None), (
                        row,
                        name,
                    )


@cache
def hostile() -> list[tuple[Columns, Columns]]:
    """Rows that lose digits, and ordinary ones, with their exact results."""
    rng = np.random.default_rng(24)
    ordinary = _masses(rng) | {"M": _usual(rng, -2, 3), "mu": _usual(rng, -2, 0.3)}
    without_mu = {name: column for name, column in ordinary.items() if name != "mu"}
    families = [
        *(family(rng) for family in CANCELLING),
        ordinary | {"axle": _usual(rng, -2, 2)},
        without_mu | {"wrap": rng.uniform(1, 720, CANCELLING_ROWS)},
        ordinary | {"wrap": rng.uniform(1, 720, CANCELLING_ROWS)},
        ordinary | {"mu": _usual(rng, 0, 1.5)},
    ]
    names = [name for name in NAMES if name not in ("regime", "friction_force_min", "friction_force_max")]
    return [(given, solve_arrays(**given, accuracy="exact", quantities=names)) for given in families]


@pytest.mark.parametrize("limit", [5e-16, 2e-15, 5e-15, 2e-14])
def test_errors_are_within_any_limit_that_bounds_are(limit: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Not only within the promise, from which most are far: so a bound that is too small shows."""
    monkeypatch.setattr(arrays.certified, "LIMIT", limit)
    plan.cache_clear()
    worst = 0.0
    for inputs, exact in hostile():
        certified = solve_arrays(**inputs, quantities=[*exact][:-1])
        for name, wanted in exact.items():
            finite = np.isfinite(wanted) & (wanted != 0)
            off = np.abs(certified[name][finite] / wanted[finite] - 1)
            assert (off <= limit + 2.0**-51).all(), (name, inputs.keys())
            worst = max([worst, *off])
    plan.cache_clear()
    assert worst > limit / 8


def test_the_papers_scene() -> None:
    results = solve_arrays(1, 3, mu=0.3, accuracy="exact")
    one = solve(m1=1.0, m2=3.0, mu=0.3, g=9.80665)  # 0.3 is a double here, not three tenths
    assert REGIMES[results["regime"]] == one.regime == "verge"
    assert [results[name].item() for name in STANDARD[1:]] == [getattr(one, name) for name in STANDARD[1:]]
    assert results["critical_pulley_mass"] == pytest.approx(43.34192486321087, rel=1e-15)
    assert results["status"] == 0
    assert {name: column.shape for name, column in results.items()} == dict.fromkeys(
        [*STANDARD, "status"], ()
    )


ODD = [nan, -1.0, -0.0, 0.0, 5e-324, 1e-200, 0.3, 0.5, 1.0, 3.0, 10.0, 1e200, 1.7e308, inf, -inf]
odd_rows = st.fixed_dictionaries(
    {"m1": st.sampled_from(ODD), "m2": st.sampled_from(ODD)},
    optional={name: st.sampled_from(ODD) for name in INPUTS if name not in MASSES},
)


usual = st.floats(0.1, 10)
mixed_rows = st.fixed_dictionaries(
    {"m1": usual, "m2": usual},
    optional={
        "M": st.sampled_from([0.0, inf, 1e-40]) | st.floats(0.1, 100),
        "mu": st.sampled_from([0.0, 500.0]) | st.floats(0.01, 1),
        "R": usual,
        "inertia": st.floats(0.1, 1),
        "wrap": st.sampled_from([17.5, 90.0, 180.0, 270.0, 360.0, 540.0]) | st.floats(1, 400),
        "axle": st.sampled_from([0.0, 1e-40]) | st.floats(0.1, 100),
    },
)


@examples(40)
@given(st.lists(odd_rows | mixed_rows, min_size=1, max_size=30), st.permutations(NAMES))
def test_any_rows_side_by_side(some: list[dict[str, float]], names: list[str]) -> None:
    """Bad rows get a code and stop nobody, and whoever stands beside whom, each gets its own."""
    for accuracy in ACCURACIES:
        results = solve_arrays(**columns(some), accuracy=accuracy, quantities=names)
        for i, row in enumerate(some):
            fault = _fault(row)
            if fault is None:
                assert_is_solve(results, i, row, accuracy)
            else:
                assert fault == STATUSES[results["status"][i]], row
                assert results["regime"][i] == -1
                assert all(isnan(results[name][i]) for name in NAMES[1:])


def _fault(row: Row) -> str | None:
    if any(map(isnan, row.values())):
        return "NaN"
    try:
        Scene.read(row)
    except SceneError as error:
        return next((fault for rule, fault in FAULTS.items() if error.rule.startswith(rule)), error.parameter)
    return None


FAULTS = {
    "and m2 are both 0; at least one mass must hang": "no mass",
    "is a free end, which friction cannot hold; leave mu out": "friction at a free end",
    "needs mu, the coefficient that decides whether it slips": "mu_k without mu",
    "must not be above": "mu_k above mu",
    "and inertia both describe the pulley": "I and inertia",
    "needs the radius R as well": "I without R",
    "contradicts M": "I with M = 0 or inf",
}


numbers = st.floats(1e-3, 1e3)


@examples(30)
@given(
    st.lists(numbers, min_size=3, max_size=3),
    st.lists(numbers, min_size=4, max_size=4),
    numbers | st.none(),
    st.lists(st.floats(0, 2) | st.none(), min_size=12, max_size=12),
)
def test_inputs_are_broadcast(
    m1: list[float], m2: list[float], M: float | None, mu: list[float | None]
) -> None:
    grid = np.array(mu, object).reshape(3, 4)
    results = solve_arrays(np.array(m1)[:, None], m2, M, grid)
    for i in range(3):
        for j in range(4):
            one = solve_arrays(m1[i], m2[j], M, grid[i, j])
            for name, column in results.items():
                assert column.shape == (3, 4)
                np.testing.assert_array_equal(column[i, j], one[name])


@pytest.mark.parametrize("accuracy", ACCURACIES)
def test_a_number_is_a_column_of_it(accuracy: Any) -> None:
    row = {
        "m1": 1.25,
        "m2": 3.7,
        "M": 40.0,
        "mu": 0.31,
        "mu_k": 0.2,
        "g": 9.81,
        "inertia": 0.4,
        "wrap": 170.0,
        "axle": 2.5,
    }
    whole = solve_arrays(**{k: np.full(5, v) for k, v in row.items()}, accuracy=accuracy, quantities=NAMES)
    for name in row:
        mixed: dict[str, Any] = row | {name: np.full(5, row[name])}
        results = solve_arrays(**mixed, accuracy=accuracy, quantities=NAMES)
        for quantity in NAMES:
            np.testing.assert_allclose(results[quantity], whole[quantity], rtol=1e-14, atol=0)


@pytest.mark.parametrize("accuracy", ACCURACIES)
@pytest.mark.parametrize("block", [7, arrays.BLOCK_ROWS])
def test_why_values_are_missing_is_counted(
    accuracy: Any, block: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As each row's own scene says it, whichever rows are solved together."""
    monkeypatch.setattr(arrays, "BLOCK_ROWS", block)
    rng = Random(5)
    numbers = {"m1": (1, 2, 0), "m2": (1, 2, 3), "M": (None, 0, 1, 100, inf), "mu": (None, 0, 0.1, 1)}
    numbers |= {"R": (None, 1), "wrap": (90, 180, 360, 540), "axle": (*[None] * 4, 0, 10)}
    given = [{name: rng.choice(some) for name, some in numbers.items()} for _ in range(60)]
    counted: Counter[tuple[str, str]] = Counter()
    for row in given:
        if row["m1"] or row["mu"] is None:
            answers = Answers(Scene.read(row))
            counted.update((name, answers.reasons[name]) for name in NAMES if answers[name] is None)
    whole: dict[str, Any] = {name: [row[name] for row in given] for name in numbers}
    results, reasons = arrays.solve_and_count(whole, accuracy, NAMES)
    assert reasons == counted
    for name in NAMES[1:]:
        missing = int(np.isnan(results[name][results["status"] == 0]).sum())
        assert missing == sum(times for (of, _), times in reasons.items() if of == name)


@pytest.mark.parametrize("wraps", [180.0, [90.0, 180.0] * 50])
def test_rows_that_are_computed_in_vain_are_not_counted(wraps: Any) -> None:
    """Of 100 rows most hold: their program runs on all of them, and what it says of the others is dropped."""
    rng = np.random.default_rng(7)
    given: Columns = {"m1": 1.0, "m2": rng.uniform(1.1, 3, 100), "M": 10.0, "mu": rng.uniform(0, 0.8, 100)}
    given |= {"wrap": wraps, "axle": rng.uniform(0, 15, 100)}
    rows_ = [
        dict(zip(given, map(float, row), strict=True))
        for row in zip(*np.broadcast_arrays(*given.values()), strict=True)
    ]
    solved = [Answers(Scene.read(row | {"g": G})) for row in rows_]
    counted = Counter((name, one.reasons[name]) for name in NAMES for one in solved if one[name] is None)
    assert 10 < sum(one.case.regime == "slip" for one in solved) < 45
    assert arrays.solve_and_count(given, "certified", NAMES)[1] == counted


def test_a_quantity_without_a_program_is_not_traced_for_long() -> None:
    """Of 50 patterns it took 8 to 12 s."""
    rng = np.random.default_rng(8)
    given: Columns = {"m1": 1.0, "m2": 3.0, "M": rng.uniform(1, 10, 48), "mu": 0.9}
    given["axle"], given["mu_k"], given["inertia"], given["R"] = (
        np.ma.array(np.full(48, 0.3), mask=np.arange(48) // size % 2 == 0) for size in (1, 2, 4, 8)
    )
    before = process_time()
    solve_arrays(**given, quantities=["friction_force_min", "friction_force_max", "friction_force_x"])
    assert process_time() - before < 2


@pytest.mark.parametrize("accuracy", ACCURACIES)
def test_blocks_do_not_show(accuracy: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    given = columns(rows("ordinary", 100) + rows("near_critical", 100))
    whole = solve_arrays(**given, accuracy=accuracy)
    every_other: dict[str, Any] = {name: np.repeat(c, 2)[::2] for name, c in given.items()}
    strided = solve_arrays(**every_other, accuracy=accuracy)
    monkeypatch.setattr(arrays, "BLOCK_ROWS", 7)
    monkeypatch.setattr(arrays.rows, "FEWEST_TILE_ROWS", 3)
    monkeypatch.setattr(arrays.rows, "TILE_BYTES", 0)
    in_blocks = solve_arrays(**given, accuracy=accuracy)
    for name in whole:
        np.testing.assert_array_equal(whole[name], in_blocks[name])
        np.testing.assert_array_equal(whole[name], strided[name])


def test_blocks_are_the_same_on_any_number_of_processors(monkeypatch: pytest.MonkeyPatch) -> None:
    """And so is which rows are solved together: the last place could depend on it."""
    monkeypatch.setattr(arrays, "BLOCK_ROWS", 7)
    on_threads = Mock(wraps=arrays._on_threads)
    monkeypatch.setattr(arrays, "_on_threads", on_threads)
    for count in (None, 1, 3, 16):
        monkeypatch.setattr("os.cpu_count", Mock(return_value=count))
        solve_arrays(np.ones(100), 3.0, 10.0, 0.3)
    first, *others = (call.args[1] for call in on_threads.call_args_list if call.args[1])
    assert len(first) == 16
    assert others == [first] * 3


def test_single_numbers_keep_no_columns() -> None:
    m1, mu = np.linspace(0.1, 2.9, 20_000), np.linspace(0.1, 1.0, 20_000)
    solve_arrays(m1, 3.0, 10 * m1, mu)
    tracemalloc.start()
    try:
        before, _ = tracemalloc.get_traced_memory()
        for _ in range(5):
            solve_arrays(m1, 3.0, 10 * m1, mu)
        after, _ = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert after - before < m1.nbytes


def test_what_leaves_the_doubles_is_infinite() -> None:
    """e^{μφ} is within them and l e^{μφ} is not."""
    mu, names = 690 / np.pi, ["least_heavier_mass", "least_pulley_mass"]
    for m1 in (*(2.0**power for power in range(26, 32)), 2.0**100, 2.0**-100):
        given: dict[str, Any] = {"m1": [m1] * 40, "m2": 2 * m1, "M": 1.0, "mu": mu, "quantities": names}
        one = solve_any(m1=m1, m2=2 * m1, M=1.0, mu=mu)
        for accuracy, ulps in (("certified", 180), ("exact", 0)):
            results = solve_arrays(**given, accuracy=accuracy)  # type: ignore[arg-type]
            for name in names:
                np.testing.assert_array_max_ulp(results[name], np.full(40, float(getattr(one, name))), ulps)


def test_many_rows_beside_the_least_mass_that_slips_are_solved() -> None:
    """Their critical pulley mass alone goes to the next level, where it asks a question of its own."""
    mu = np.linspace(0.02, 0.2, 100)
    (least, _) = solve_arrays(1.0, 2.0, mu=mu, accuracy="exact", quantities=["least_heavier_mass"]).values()
    given: dict[str, Any] = {"m1": 1.0, "m2": np.nextafter(least, inf), "M": 4e16, "mu": mu}
    results = solve_arrays(**given, accuracy="exact")
    for i in range(0, 100, 9):
        assert_is_solve(results, i, given | {"m2": float(given["m2"][i]), "mu": float(mu[i])}, "exact")


def test_rows_of_the_next_level_are_solved_wherever_they_wait(monkeypatch: pytest.MonkeyPatch) -> None:
    """Many are solved with their block, few with those of all blocks; and some need two more levels."""
    given = columns(rows("ordinary", 200) + rows("near_critical", 800))
    exact = solve_arrays(**given, accuracy="exact")
    monkeypatch.setattr(arrays, "BLOCK_ROWS", 100)
    for leave in (0, 1, 10, 1000):
        monkeypatch.setattr(arrays.rows, "ROWS_LEFT", leave)
        results = solve_arrays(**given)
        for name in exact:
            np.testing.assert_allclose(results[name], exact[name], 2e-14, 0)


def test_a_weight_that_is_a_tie_is_settled_in_columns(monkeypatch: pytest.MonkeyPatch) -> None:
    """3 g has 55 bits: half-way between two doubles, for a quarter of the values of g."""
    rng = np.random.default_rng(1)
    load, odd = 3 * 2.0 ** rng.integers(-20, 20, 100), 9.80665 + 2.0**-49 * np.arange(100)
    given: dict[str, Any] = {"m1": load, "m2": 4 * load, "M": np.inf, "g": odd}
    monkeypatch.setattr(arrays.rows.Rows, "_solve_one_by_one", Mock(side_effect=AssertionError))
    (tension, _) = solve_arrays(**given, accuracy="exact", quantities=["tension_1"]).values()
    exact = [Fraction(float(g)) * Fraction(float(m)) for g, m in zip(odd, load, strict=True)]
    assert tension.tolist() == [float(e) for e in exact]
    halves = [abs(Fraction(float(e)) - e) == Fraction(ulp(float(e))) / 2 for e in exact]
    assert sum(halves) > 20


def test_other_ties_are_settled_one_by_one() -> None:
    """With load 6 and drive 3 a tension is 3 g/2, of 54 bits: half-way between two doubles, for an odd g."""
    rng = np.random.default_rng(1)
    m1, odd = 2.0 ** rng.integers(-20, 20, 100), 9.80665 + 2.0**-49 * np.arange(100)
    given: dict[str, Any] = {"m1": m1, "m2": 4 * m1, "M": 2 * m1, "g": odd}
    results = solve_arrays(**given, accuracy="exact")
    exact = [Fraction(float(g)) * Fraction(3, 2) * Fraction(float(m)) for g, m in zip(odd, m1, strict=True)]
    assert results["tension_1"].tolist() == [float(e) for e in exact]
    assert sum(Fraction(float(t)) != e for t, e in zip(results["tension_1"], exact, strict=True)) > 20


def test_what_is_beside_a_tie_is_rounded_to_its_own_side() -> None:
    """With a tiny M the tension is 3 g/2 but for 2^-112 of it; and a tie below 2^n has nearer neighbours."""
    odd = 9.80665 + 2.0**-49 * np.arange(100)
    below_8 = np.full(100, float((2**54 - 1) // 3) * 2.0**-50)
    for g, M in ((odd, 2.0**-110), (odd, 2.0**-90), (below_8, 0.0)):
        given: dict[str, Any] = {"m1": 1.0, "m2": 3.0, "M": M, "g": g}
        results = solve_arrays(**given, accuracy="exact")
        for i in range(100):
            assert_is_solve(results, i, given | {"g": float(g[i])}, "exact")


@pytest.mark.parametrize("name", NAMES)
def test_far_rows_are_solved_for_one_quantity_too(name: str) -> None:
    """From 1e-300 to 1e300."""
    rng = np.random.default_rng(2)
    given = {x: 10.0 ** rng.uniform(-300, 300, 40) for x in ("m1", "m2", "M")} | {"mu": rng.uniform(0, 2, 40)}
    results = solve_arrays(**given, accuracy="exact", quantities=[name])
    for i in range(0, 40, 7):
        assert_is_solve(results, i, {x: float(column[i]) for x, column in given.items()}, "exact")


def test_threads_do_not_wait_for_each_others_attributes() -> None:
    """Until Python 3.12 functools' own holds a lock for all objects of a class: blocks waited for ever."""
    both = Barrier(2, timeout=HANGS)

    class Block:
        @lazy
        def attribute(self) -> int:
            return both.wait()

    with ThreadPoolExecutor(2) as pool:
        seen = list(pool.map(lambda block: (block.attribute, block.attribute), [Block(), Block()]))
    assert sorted(seen) == [(0, 0), (1, 1)]
    assert isinstance(Block.attribute, lazy)
    assert all(isinstance(vars(Case)[name], lazy) for name in ("regime", "slips", "can_slip"))


NO_NUMBERS = [
    [1 + 2j],
    np.complex64(3),
    np.array([3 + 0j], dtype=object),
    np.array(["2020-01-01"], dtype="M8[D]"),
    np.timedelta64(3, "s"),
    [date(2020, 1, 1)],
    np.array([(1.0,)], dtype=[("kg", float)]),
    [1, [2, 3]],
    "heavy",
    10**400,
    {1: 2},
    True,
    [True, 2.0],
    np.array([True]),
    np.array([2.0, True], dtype=object),
]


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("name", [name for name in INPUTS if name != "mu_k"])
@pytest.mark.parametrize("value", NO_NUMBERS, ids=repr)
def test_what_is_no_real_number_is_an_error_that_names_it(name: str, value: Any) -> None:
    """NumPy takes the real part of a complex number, the days of a date, the only field of a record, 1 for True."""
    with pytest.raises(SceneError) as error:
        solve_arrays(**{"m1": 1.0, "m2": 3.0, name: value})
    assert error.value.parameter == name
    assert error.value.rule.startswith(("must be real numbers, not ", "must be real numbers: "))


LONG = np.longdouble(2) ** 3000  # infinite where a long double is a double
BEYOND = [
    *([LONG, 1 / LONG, np.array([1, LONG]), np.array([LONG], dtype=object)] if LONG < np.inf else []),
    *([Decimal("1e400")], [1, Decimal("-1e-400")], [Fraction(1, 10**400)], Decimal("2e-324")),
    *(["3", "1e400"], "1e-400", [b"1e400"], "1.7976931348623159e308"),
]


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("value", BEYOND, ids=repr)
def test_what_is_beyond_the_doubles_is_neither_0_nor_infinite(value: Any) -> None:
    """M = inf would lock the pulley, and M = 0 take it away."""
    with pytest.raises(SceneError, match=r"^M .* is beyond the range of doubles$"):
        solve_arrays(1.0, 3.0, M=value)
    masked = np.ma.array(np.atleast_1d(value), mask=True)
    assert solve_arrays(1.0, 3.0, M=masked)["acceleration"][-1] == solve_arrays(1.0, 3.0)["acceleration"]


@pytest.mark.parametrize(
    "value", [0, -0.0, "0", b"-0", "0e500", Decimal(0), Fraction(0), np.longdouble(0)], ids=repr
)
def test_0_and_infinity_of_any_type_are_themselves(value: Any) -> None:
    infinite: Any = [Decimal("inf"), "-inf", np.longdouble("inf")]
    for same, double in ((value, 0.0), (infinite, np.array([inf, -inf, inf]))):
        found, wanted = (solve_arrays(1.0, 3.0, M=M) for M in (same, double))
        np.testing.assert_array_equal(found["status"], wanted["status"])
        np.testing.assert_array_equal(found["acceleration"], wanted["acceleration"])


NOT_GIVEN: dict[str, Any] = {
    "numpy.ma": np.ma.array([0.25, 7.0, nan], mask=[False, True, False]),
    "of integers": np.ma.array([1, 7, 1], mask=[False, True, False]),
    "of texts": np.ma.array(["0.25", "x", "nan"], mask=[False, True, False]),
    "list": [0.25, None, nan],
    "objects": np.array([Decimal("0.25"), None, nan]),
    "polars": pl.Series([0.25, None, nan]),
    "polars, integers": pl.Series([1, None, 1]),
    "polars, texts": pl.Series(["0.25", None, "NaN"]),
}


@pytest.mark.parametrize("name", INPUTS)
@pytest.mark.parametrize("column", NOT_GIVEN.values(), ids=NOT_GIVEN.keys())
def test_what_is_missing_is_not_given_and_nan_is_an_error(name: str, column: Any) -> None:
    given: dict[str, Any] = {"m1": 1.0, "m2": 3.0, "M": 5.0, "mu": 1.0, "R": 1.0}
    found = solve_arrays(**given | {name: column})
    assert not any(isinstance(values, np.ma.MaskedArray) for values in found.values())
    for i, value in enumerate(getattr(column, "values", None) or list(column)):
        row = {key: x for key, x in given.items() if key != name}
        if value is None or value is np.ma.masked:
            status = name if name in MASSES else "valid"
        else:
            row[name] = float(value)
            status = "NaN" if isnan(row[name]) else "valid"
        assert STATUSES[found["status"][i]] == status
        if status == "valid":
            assert_is_solve(found, i, row, "certified")


@pytest.mark.parametrize("name", INPUTS)
@pytest.mark.parametrize("accuracy", ACCURACIES)
def test_not_given_in_all_rows_is_not_given(name: str, accuracy: Accuracy) -> None:
    """As `None` in `solve`, it leaves the usual value."""
    given: dict[str, Any] = {"m1": 1.0, "m2": 3.0, "M": 5.0, "mu": 0.5, "R": 0.1, "axle": 2.0}
    masked = solve_arrays(**given | {name: np.ma.masked}, accuracy=accuracy)
    if name in MASSES:
        assert masked["status"] == STATUSES.index(name)
    else:
        for other in (given | {name: None}, {key: x for key, x in given.items() if key != name}):
            np.testing.assert_equal(solve_arrays(**other, accuracy=accuracy), masked)


def test_either_inertia_or_moment_of_inertia_in_a_row() -> None:
    found = solve_arrays(
        *(1, 3, [8, None, 8, None, None]),
        inertia=[1, None, None, 1, None],
        I=[None, 0.08, 0.08, 0.08, None],
        R=0.1,
        accuracy="exact",
    )
    assert found["status"].tolist() == [0, 0, 0, STATUSES.index("I and inertia"), 0]
    assert found["acceleration"][:3].tolist() == [solve(m1=1, m2=3, M=8, inertia=1, g=G).acceleration] * 3
    assert found["acceleration"][4] == G / 2


def test_status_codes_are_a_contract() -> None:
    """New ones come last."""
    words = (
        "valid m1 m2 M mu mu_k g inertia R wrap no_mass friction_at_a_free_end mu_k_without_mu mu_k_above_mu"
    )
    words += " NaN I axle I_and_inertia I_without_R I_with_M_=_0_or_inf"
    assert [status.replace(" ", "_") for status in STATUSES] == words.split()


def test_a_table_of_many_kinds_is_planned_once() -> None:
    """Of 128 plans none was left when it was wanted again: 100 rows took 4 s each time, not 0.5."""
    given = columns(rows("ordinary", 100) + rows("ordinary", 30, axle=True))
    plan.cache_clear()
    solve_arrays(**given)
    planned = plan.cache_info().misses
    assert planned > 128
    solve_arrays(**given)
    assert plan.cache_info().misses == planned


def test_sums_of_negative_forces() -> None:
    """The smaller in size, not in value, must come second where two operations give a sum's error."""
    row = {"m1": 1.7564649058808377, "m2": 865.29649231545, "mu": 0.7514867515890271, "wrap": 270.0}
    for accuracy in ACCURACIES:
        results = solve_arrays(**row, accuracy=accuracy, quantities=NAMES)
        one = solve_any(**row, g=9.80665)
        for name in ("friction_force_x", "friction_force_y"):
            assert abs(results[name].item() - getattr(one, name)) <= (0 if accuracy == "exact" else 1e-12)


def test_no_rows() -> None:
    results = solve_arrays([], [], mu=0.3)
    assert {column.shape for column in results.values()} == {(0,)}


def test_only_what_is_asked_for() -> None:
    results = solve_arrays([1, 3], [3, 1], 10, quantities=["torque", "acceleration"], R=[0.1, None])
    assert list(results) == ["torque", "acceleration", "status"]
    assert results["torque"][0] == pytest.approx(1.0896277777777778, rel=1e-15)
    assert isnan(results["torque"][1])


def test_temporaries_are_bounded() -> None:
    n = 1_000_000
    given: dict[str, Any] = {
        name: np.full(n, value) for name, value in (("m1", 1.0), ("m2", 3.0), ("M", 10.0), ("mu", 0.3))
    }
    tracemalloc.start()
    results = solve_arrays(**given)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak - sum(column.nbytes for column in results.values()) < 200e6


@pytest.mark.parametrize("words", [["a", "T1", "acceleration", "F_min"], "a,T₁,F min"])
def test_quantities_by_their_symbols_have_their_names(words: Any) -> None:
    results = solve_arrays(1, 3, M=10, mu=0.3, quantities=words)
    assert [*results] == ["acceleration", "tension_1", "friction_force_min", "status"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"accuracy": "best"}, "accuracy 'best' is no accuracy; there are certified, exact"),
        (
            {"accuracy": "fast"},
            "accuracy 'fast' is no longer there, as certified takes hardly longer; take that",
        ),
        ({"quantities": ["tension"]}, "quantities 'tension' is no quantity; did you mean tension_2?"),
        ({"quantities": "a,t1"}, "quantities 't1' is no quantity; did you mean tension_1?"),
        ({"quantities": [["torque"]]}, r"quantities .*torque.* is no quantity.*"),
    ],
)
def test_errors(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(SceneError, match="^" + message.replace("?", "[?]") + "$"):
        solve_arrays(1, 3, **arguments)


@pytest.mark.parametrize("accuracy", ACCURACIES)
def test_a_mirrored_zero_is_no_negative_zero(accuracy: Any) -> None:
    """The rest of a pair that is turned round is -0 as well, and -0 and -0 is -0."""
    signed = ["torque", "friction_force_x", "friction_force_y", "rim_acceleration", "angular_acceleration"]
    for masses in ((2.0, 1.0), (1.0, 2.0)):
        for rows_ in (1, 5):
            results = solve_arrays(
                np.full(rows_, masses[0]), masses[1], mu=0.0, R=1.0, accuracy=accuracy, quantities=signed
            )
            for name in signed:
                assert [repr(x) for x in results[name].tolist() if x == 0] == ["0.0"] * sum(
                    results[name] == 0
                )
            assert [repr(x) for x in results["torque"].tolist()] == ["0.0"] * rows_


def test_a_mass_that_is_missing() -> None:
    missing: Any = None
    for mass, masses in (("m1", (missing, 3)), ("m2", (1, missing))):
        with pytest.raises(SceneError, match=f"^{mass} is missing; give both masses, m1 and m2$"):
            solve_arrays(*masses)


def test_an_error_shows_text_as_it_was_given() -> None:
    """Was np.str_('hoop')."""
    with pytest.raises(SceneError, match=r"^inertia must be real numbers: .*: 'hoop'$"):
        solve_arrays(1.0, 3.0, M=2.0, inertia=[np.str_("hoop")])


def test_shapes_that_do_not_broadcast() -> None:
    why = r"^M of shape \(2,\) does not broadcast with \(3,\), the shape of what comes before it$"
    with pytest.raises(SceneError, match=why):
        solve_arrays([1, 2, 3], 2, M=[1, 2])
