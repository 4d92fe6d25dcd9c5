"""Many scenes at once: against the oracle, against one scene at a time, and on odd rows."""

import tracemalloc
from collections import Counter
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from datetime import date
from decimal import Decimal
from fractions import Fraction
from functools import cache
from math import inf, isfinite, isnan, nan, ulp
from random import Random
from threading import Barrier
from time import sleep
from typing import Any
from unittest.mock import Mock

import numpy as np
import polars as pl
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from atwood_cli import REGIMES, SceneError, arrays, solve_arrays
from atwood_cli.arrays import STATUSES
from atwood_cli.arrays.plan import plan
from atwood_cli.numbers.lazy import lazy
from atwood_cli.solver.answers import Answers
from atwood_cli.solver.decisions import REGIME_ASSUMED, Decisions
from atwood_cli.solver.quantities import ACCURACIES, NAMES, Accuracy
from atwood_cli.solver.scene import INPUTS, MASSES, TORQUE, WEIGHT

from .conftest import examples
from .tools.doors import columns_of, solve_any, within_promise
from .tools.running import HANGS
from .tools.scenes import DANGERS, ON_AN_AXLE, Given, Row, as_doubles, read_scene, scenes

Columns = dict[str, Any]


def assert_is_solve(results: Any, i: int, row: Row, accuracy: str) -> None:
    """A row's results are those of `solve`: to the bit if exact, within 2e-14 if certified."""
    one = solve_any(**row)
    for name, column in results.items():
        got, value = column[i].item(), getattr(one, name, 0)
        want = nan if value is None else value
        if name in ("regime", "status"):
            assert (REGIMES[got] == want) if name == "regime" else got == 0, row
        elif accuracy == "exact" or not isfinite(want) or want == 0:  # never -0
            assert repr(got) == repr(want), (row, name)
        else:
            assert within_promise(got, want), (row, name, got)


def alike(family: str, count: int) -> list[Given]:
    """Scenes of doubles."""
    return [row for given in scenes(family, count) if (row := as_doubles(given))]


@cache
def hostile() -> list[tuple[Columns, Columns]]:
    """Rows that lose digits, and ordinary ones, with their exact results."""
    rng = np.random.default_rng(24)
    m1, M, mu, f = (10 ** rng.uniform(low, high, 24) for low, high in ((-1, 1), (-2, 3), (-2, 0.3), (-2, 2)))
    masses = {"m1": m1, "m2": m1 * (1 + 10 ** rng.uniform(-2, 1, 24)), "M": M, "R": 1.0}
    wrap = {"wrap": rng.uniform(1, 720, 24)}
    families = [
        *(columns_of(alike(danger, 24)) for danger in DANGERS),
        masses | {"mu": mu, "axle": f},
        masses | wrap,
        masses | wrap | {"mu": mu},
        masses | {"mu": 10 ** rng.uniform(0, 1.5, 24)},
    ]
    names = [name for name in NAMES if name not in ("regime", "friction_force_min", "friction_force_max")]
    return [(given, solve_arrays(**given, accuracy="exact", quantities=names)) for given in families]


@pytest.mark.parametrize("limit", [5e-16, 2e-15])
def test_errors_are_within_any_limit_that_bounds_are(limit: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Not only within the promise, from which most are far: so a bound that is too small shows."""
    monkeypatch.setattr(arrays.doubles, "MOST_ERROR", limit)
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


ODD = [nan, -1.0, -0.0, 0.0, 5e-324, 1e-200, 0.3, 0.5, 1.0, 3.0, 10.0, 1e200, 1.7e308, inf, -inf]
odd_rows = st.fixed_dictionaries(
    {"m1": st.sampled_from(ODD), "m2": st.sampled_from(ODD)},
    optional={name: st.sampled_from(ODD) for name in INPUTS if name not in MASSES},
)


MIRRORED = {"m1": 2.0, "m2": 1.0, "mu": 0.0, "R": 1.0}  # without a -0 in its results
usual = st.floats(0.1, 10)
mixed_rows = st.fixed_dictionaries(
    {"m1": usual, "m2": usual},
    optional={
        "M": st.sampled_from([0.0, inf, 1e-40]) | st.floats(0.1, 100),
        "mu": st.sampled_from([0.0, 500.0]) | st.floats(0.01, 1),
        "R": usual,
        "inertia": st.floats(0.1, 1),
        "I": st.floats(0.1, 1),
        "wrap": st.sampled_from([17.5, 90.0, 180.0, 270.0, 360.0, 540.0]) | st.floats(1, 400),
        "axle": st.sampled_from([0.0, 1e-40]) | st.floats(0.1, 100),
    },
)


@example([{"m1": 1.0, "m2": 3.0, "M": M, "I": 0.08, "R": 0.1} for M in (8.0, inf, 0.0)], ["torque"])
@example([MIRRORED], NAMES)
@example([MIRRORED] * 5, NAMES)
@examples(40)
@given(
    st.lists(odd_rows | mixed_rows, min_size=1, max_size=30),
    st.lists(st.sampled_from(NAMES), min_size=1, unique=True),
)
def test_any_rows_side_by_side(some: list[dict[str, float]], names: list[str]) -> None:
    """Bad rows get a code and stop nobody, and whoever stands beside whom, each gets its own."""
    for accuracy in ACCURACIES:
        results = solve_arrays(**columns_of(some), accuracy=accuracy, quantities=names)
        for i, row in enumerate(some):
            fault = _fault(row)
            if fault is None:
                assert_is_solve(results, i, row, accuracy)
            else:
                assert fault == STATUSES[results["status"][i]], row
                for name in names:
                    assert results[name][i] == -1 if name == "regime" else isnan(results[name][i])


def _fault(row: Row) -> str | None:
    if any(map(isnan, row.values())):
        return "NaN"
    try:
        read_scene(row)
    except SceneError as error:
        return next((fault for rule, fault in FAULTS.items() if error.rule.startswith(rule)), error.parameter)
    return None


FAULTS = {
    "and m2 are both 0; at least one mass must hang": "no mass",
    "is an end of the string that is fixed to the pulley, where mu has no effect; leave mu out": "friction at a free end",
    "needs mu, the coefficient that decides whether it slips": "mu_k without mu",
    "must not be above": "mu_k above mu",
    "and inertia both describe the pulley": "I and inertia",
    "needs the radius R as well": "I without R",
    "contradicts M": "I with M = 0 or inf",
}


TERMS = {"m1": WEIGHT, "m2": WEIGHT, "M": WEIGHT, "axle": TORQUE}


@pytest.mark.parametrize("accuracy", ACCURACIES)
@pytest.mark.parametrize("names", [["m1", "m2"], ["m2"], ["m1", "M"], ["axle"], [*TERMS]])
def test_weights_and_torques_are_converted_exactly(names: list[str], accuracy: Accuracy) -> None:
    """Also a weight beside the mass that it is, or is nearly; g is absent in some rows, and M infinite."""
    rng, rows = Random(str(names)), list[dict[str, float]]()
    for _ in range(120):
        sizes = {x: 10 ** rng.uniform(-2, 2) * rng.choice([1, 1, 1e-200, 1e150]) for x in TERMS}
        row = {**sizes, "R": rng.uniform(0.01, 1), "mu": rng.choice([0.1, 0.3, 1.0])}
        row |= {"g": rng.choice([9.81, 8.0])} if rng.random() < 0.7 else {}
        row |= {"m2": row["m1"] * rng.choice([8.0, 9.80665, 9.81])} if rng.random() < 0.4 else {}
        rows.append(row | {"M": inf} if rng.random() < 0.1 else row)
    terms = {name: TERMS[name] for name in names}
    results, _ = arrays.solve_and_count(columns_of(rows), accuracy, [*NAMES], terms)
    for i, row in enumerate(rows):
        exact: dict[str, Any] = {x: value if value == inf else Fraction(value) for x, value in row.items()}
        by = {"g": exact.get("g", Fraction("9.80665")), "R": exact["R"]}
        own = {x: t.own(exact[x], by[t.by]) for x, t in terms.items() if exact[x] != inf}
        assert_is_solve(results, i, exact | own, accuracy)


numbers = st.floats(1e-3, 1e3)
OTHERS = {"mu_k": 0.2, "g": 9.81, "inertia": 0.4, "wrap": 170.0, "axle": 2.5}


@examples(30)
@given(
    st.lists(numbers, min_size=3, max_size=3),
    st.lists(numbers, min_size=4, max_size=4),
    numbers | st.none(),
    st.lists(st.floats(0.2, 2) | st.none(), min_size=12, max_size=12),
    st.sets(st.sampled_from([*OTHERS])),
)
def test_inputs_are_broadcast(
    m1: list[float], m2: list[float], M: float | None, mu: list[float | None], columns: set[str]
) -> None:
    """A number is a column of it."""
    grid = np.array(mu, object).reshape(3, 4)
    others: Any = OTHERS if None not in mu else {x: OTHERS[x] for x in OTHERS if x != "mu_k"}
    mixed: Any = {x: np.full(4, value) if x in columns else value for x, value in others.items()}
    results = solve_arrays(np.array(m1)[:, None], m2, M, grid, **mixed, quantities=NAMES)
    for i in range(3):
        for j in range(4):
            one = solve_arrays(m1[i], m2[j], M, grid[i, j], **others, quantities=NAMES)
            for name, column in results.items():
                assert column.shape == (3, 4)
                np.testing.assert_allclose(column[i, j], one[name], rtol=4e-14)


def reasons_of(rows: list[Row]) -> Counter[tuple[str, str]]:
    """Why quantities have no value, and that a regime is assumed, as each row's own scene says it, counted."""
    solved = [Answers(read_scene(row)) for row in rows]
    found = Counter((name, one.answer(name).reason) for name in NAMES for one in solved if one[name] is None)
    return found + Counter({("regime", REGIME_ASSUMED): sum(one.decided.mu_assumed for one in solved)})


@pytest.mark.parametrize("accuracy", ACCURACIES)
@pytest.mark.parametrize("chunk", [7, arrays.CHUNK_ROWS])
def test_missing_values_are_counted(accuracy: Any, chunk: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """By why they are missing, whichever rows are solved together."""
    monkeypatch.setattr(arrays, "CHUNK_ROWS", chunk)
    rng = Random(5)
    numbers = {"m1": (1, 2, 0), "m2": (1, 2, 3), "M": (None, 0, 1, 100, inf), "mu": (None, 0, 0.1, 1)}
    numbers |= {"R": (None, 1), "wrap": (90, 180, 360, 540), "axle": (*[None] * 4, 0, 10)}
    given: list[Any] = [{name: rng.choice(some) for name, some in numbers.items()} for _ in range(60)]
    heavy = {"m1": 1, "m2": 3, "M": 1e300}  # solved one by one
    given += [given[0] | heavy | {"mu": mu} for mu in (0.9, None) for _ in range(5)]
    whole: dict[str, Any] = {name: [row[name] for row in given] for name in numbers}
    results, reasons = arrays.solve_and_count(whole, accuracy, NAMES)
    assert reasons == reasons_of([row for row in given if row["m1"] or row["mu"] is None])
    for name in NAMES[1:]:
        missing = int(np.isnan(results[name][results["status"] == 0]).sum())
        assert missing == sum(times for (of, _), times in reasons.items() if of == name)


@pytest.mark.parametrize("accuracy", ACCURACIES)
def test_chunks_tiles_and_the_number_of_processors_do_not_show(
    accuracy: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    given = columns_of(alike("ordinary", 100) + alike("near_critical", 100))
    whole = solve_arrays(**given, accuracy=accuracy)
    every_other: dict[str, Any] = {name: np.repeat(c, 2)[::2] for name, c in given.items()}
    strided = solve_arrays(**every_other, accuracy=accuracy)
    monkeypatch.setattr(arrays, "CHUNK_ROWS", 70)
    monkeypatch.setattr(arrays.rows, "TILE_ROWS", 3)
    in_chunks = solve_arrays(**given, accuracy=accuracy)
    for name in whole:
        if accuracy == "exact":
            np.testing.assert_array_equal(whole[name], in_chunks[name])
        np.testing.assert_allclose(whole[name], in_chunks[name], 4e-14, 0)
        np.testing.assert_array_equal(whole[name], strided[name])
    for count in (None, 1, 2, 8):
        monkeypatch.setattr("os.cpu_count", Mock(return_value=count))
        again = solve_arrays(**given, accuracy=accuracy)
        assert {name: c.tobytes() for name, c in again.items()} == {
            name: c.tobytes() for name, c in in_chunks.items()
        }


@pytest.mark.parametrize("error", [KeyboardInterrupt, MemoryError])
def test_an_error_in_a_chunk_cancels_those_that_wait(
    error: type[BaseException], monkeypatch: pytest.MonkeyPatch
) -> None:
    """So does Ctrl-C, which is raised where the results of chunks are awaited."""
    monkeypatch.setattr(arrays, "CHUNK_ROWS", 1)
    monkeypatch.setattr("os.cpu_count", Mock(return_value=1))
    begun = Mock(side_effect=[None, error, *[None] * 998])

    def solve_chunk(*_: Any) -> None:
        sleep(0.01)
        begun()

    monkeypatch.setattr(arrays, "_solve", solve_chunk)
    with pytest.raises(error):
        solve_arrays(np.ones(1000), 3.0)
    assert begun.call_count < 10


def memory_of(run: Callable[[], Any]) -> tuple[int, int]:
    """The bytes that a run leaves, and the most that it takes."""
    tracemalloc.start()
    try:
        kept = run()
        return tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
        del kept


def test_single_numbers_keep_no_columns() -> None:
    m1, mu = np.linspace(0.1, 2.9, 20_000), np.linspace(0.1, 1.0, 20_000)

    def run() -> Any:
        return list(solve_arrays(m1, 3.0, 10 * m1, mu))

    run()
    assert memory_of(lambda: [run() for _ in range(5)])[0] < m1.nbytes


def test_temporaries_are_bounded() -> None:
    given = [np.full(300_000, value) for value in (1.0, 3.0, 10.0, 0.3)]
    left, most = memory_of(lambda: solve_arrays(*given))
    assert most - left < 60e6


def test_a_weight_that_is_a_tie_is_settled_in_columns(monkeypatch: pytest.MonkeyPatch) -> None:
    """3 g has 55 bits: half-way between two doubles, for a quarter of the values of g."""
    given: dict[str, Any] = {"m1": 3.0, "M": np.inf, "g": 9.80665 + 2.0**-49 * np.arange(100)}
    monkeypatch.setattr(arrays.rows.Rows, "_solve_one_by_one", Mock(side_effect=AssertionError))
    (tension, _) = solve_arrays(m2=4.0, **given, accuracy="exact", quantities=["tension_1"]).values()
    exact = [3 * Fraction(float(g)) for g in given["g"]]
    assert tension.tolist() == [float(e) for e in exact]
    assert sum(abs(Fraction(float(e)) - e) == Fraction(ulp(float(e))) / 2 for e in exact) > 20


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
    assert all(isinstance(vars(Decisions)[name], lazy) for name in ("regime", "slips", "can_slip"))


# fmt: off
NO_NUMBERS = [
    [1 + 2j], np.complex64(3), np.array([3 + 0j], dtype=object), np.array(["2020-01-01"], dtype="M8[D]"),
    np.timedelta64(3, "s"), [date(2020, 1, 1)], np.array([(1.0,)], dtype=[("kg", float)]), [1, [2, 3]], "heavy", 10**400,
    {1: 2}, True, [True, 2.0], np.array([True]), np.array([2.0, True], dtype=object),
]
# fmt: on


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


@pytest.mark.parametrize("value", [0, -0.0, "0", b"-0", "0e500", Decimal(0), Fraction(0), np.longdouble(0)])
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
    "list of masked": [0.25, np.ma.masked, nan],  # NumPy made NaN of it, with a warning
    "tuple of texts": ("0.25", np.ma.masked, "nan"),
    "objects": np.array([Decimal("0.25"), None, nan]),
    "polars": pl.Series([0.25, None, nan]),
    "polars, integers": pl.Series([1, None, 1]),
    "polars, texts": pl.Series(["0.25", None, "NaN"]),
}


@pytest.mark.filterwarnings("error")
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


def test_a_table_of_many_kinds_is_planned_once() -> None:
    """Of 128 plans none was left when it was wanted again: 100 rows took 4 s each time, not 0.5."""
    given = columns_of(alike("ordinary", 100) + alike(f"ordinary{ON_AN_AXLE}", 30))
    plan.cache_clear()
    solve_arrays(**given)
    planned = plan.cache_info().misses
    assert planned > 128
    solve_arrays(**given)
    assert plan.cache_info().misses == planned


@pytest.mark.parametrize("words", [["a", "T1", "acceleration", "F_min"], "a,T₁,F min"])
def test_quantities_by_their_symbols_have_their_names(words: Any) -> None:
    results = solve_arrays(1, 3, M=10, mu=0.3, quantities=words)
    assert [*results] == ["acceleration", "tension_1", "friction_force_min", "status"]
    assert {column.shape for column in solve_arrays([], [], mu=0.3).values()} == {(0,)}


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"accuracy": "best"}, "accuracy 'best' is not an accuracy; there are certified, exact"),
        (
            {"quantities": ["tension"]},
            "quantities 'tension' is not a quantity; did you mean tension_1 or tension_2 or tension_difference?",
        ),
        ({"quantities": "a,t1"}, "quantities 't1' is not a quantity; did you mean tension_1?"),
        ({"quantities": [["torque"]]}, r"quantities .*torque.* is not a quantity.*"),
        ({"m1": None}, "m1 is missing; give both masses, m1 and m2"),
        ({"m2": None}, "m2 is missing; give both masses, m1 and m2"),
        ({"inertia": [np.str_("hoop")]}, "inertia must be real numbers: .*: 'hoop'"),  # was np.str_('hoop')
        ({"m1": [1] * 3, "M": [1] * 2}, r"M of shape \(2,\) does not broadcast with \(3,\), the shape of .*"),
    ],
)
def test_errors(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(SceneError, match="^" + message.replace("?", "[?]") + "$"):
        solve_arrays(**{"m1": 1, "m2": 3, **arguments})
