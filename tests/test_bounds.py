"""The arithmetics of arrays: every bound holds, and what is assumed of NumPy does; and their programs."""

from collections import Counter
from collections.abc import Callable, Sequence
from fractions import Fraction
from math import frexp, isfinite
from typing import Any

import flint
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from atwood_cli import solve_arrays
from atwood_cli.arrays import doubles as doubles_
from atwood_cli.arrays.doubles import DOUBLES, LIBRARY, MOST_ERROR, PROMISE, UNIT, Bounded, proven_double
from atwood_cli.arrays.pairs import PAIRS, STEP, TABLE_STEPS, head_of, powers, two_product
from atwood_cli.arrays.program import Program
from atwood_cli.numbers.formula import Formula, Term
from atwood_cli.solver.quantities import ACCURACIES, Accuracy

from .conftest import examples
from .tools import oracle

LEVELS: dict[str, Any] = {"doubles": DOUBLES, "pairs": PAIRS}
rng = np.random.default_rng(2026)
X, Y = 10 ** rng.uniform(-9, 9, (2, 400))
SMALL = 10 ** rng.uniform(-30, 0.8, 400)
USUAL = 10 ** rng.uniform(-1.5, 0.8, 400)
DEGREES = np.concatenate(
    [rng.uniform(0, 800, 390), [90.0, 180.0, 270.0, 360.0, 450.0, 30.0, 60.0, 150.0, 1e-9, 720.0]]
)


def arb(x: Any) -> flint.arb:
    q = Fraction(x)
    return flint.arb(flint.fmpq(q.numerator, q.denominator))


def worked_out(formulas: Sequence[Term], **columns: Any) -> list[Any]:
    """The columns of formulas."""
    named = {str(i): one for i, one in enumerate(formulas)}
    program = Program(named)
    size = max((column.size for column in columns.values()), default=1)
    results = {name: np.empty(size) for name in named}
    with np.errstate(all="ignore"):
        program.run(columns, results, [np.empty(size, kind) for kind in program.between])
    return [*results.values()]


def symbols(ar: Any, count: int) -> list[Any]:
    return [ar.number(Formula("symbol", f"x{i}")) for i in range(count)]


def values(number: Bounded, *columns: Any) -> tuple[list[Fraction], list[float]]:
    """The exact values of a number's rows, and their bounds, which are NaN where the value is."""
    *parts, bounds = worked_out(
        [*number.parts, number.bound + 0.0 * number.parts[0]],
        **{f"x{i}": column for i, column in enumerate(columns)},
    )
    exact = [
        sum((Fraction(float(part)) for part in row), Fraction(0)) if all(map(isfinite, row)) else Fraction(0)
        for row in zip(*parts, strict=True)
    ]
    return exact, bounds.tolist()


def off(number: Bounded, exact: Callable[..., flint.arb], *columns: Any, sure: float = 1.0) -> None:
    """Assert that each row is within its bound, and that at least a share ``sure`` of the rows has one."""
    flint.ctx.prec = 1400
    exactly, bounds = values(number, *columns)
    for got, bound, *row in zip(exactly, bounds, *columns, strict=True):
        if isfinite(bound):
            want = exact(*(arb(float(x)) for x in row))
            assert abs(arb(got) - want) <= arb(bound) * abs(want) + arb(Fraction(1, 10**400)), row
    assert np.mean(np.isfinite(bounds)) >= sure


class Balls:
    """The operations of an arithmetic on FLINT's numbers."""

    number, sqrt, log1p, expm1 = map(staticmethod, (arb, flint.arb.sqrt, flint.arb.log1p, flint.arb.expm1))
    pi = property(lambda _: flint.arb.pi())


def bound_holds(ar: Any, operation: Callable[..., Any], *columns: Any, sure: float = 1.0) -> None:
    exact = Balls()
    off(operation(ar, *symbols(ar, len(columns))), lambda *row: operation(exact, *row), *columns, sure=sure)


def _many(x: Any, y: Any) -> Any:
    """As many products and quotients as a quantity may take, 60: tails grow with each."""
    z = x + y
    for _ in range(15):
        z = z / (x + y) * x / y * (x + y)
    return z


OPERATIONS_: dict[str, Callable[[Any, Any, Any], Any]] = {
    "constant": lambda ar, x, y: ar.number(Fraction(1, 3)),
    "sum": lambda ar, x, y: x + y,
    "product": lambda ar, x, y: x * y,
    "quotient": lambda ar, x, y: x / y,
    "root": lambda ar, x, y: ar.sqrt(x),
    "sums": lambda ar, x, y: (x + y) + (y + 1) + x / y,
    "of both signs": lambda ar, x, y: (y - x) + (x - 2 * y) / 3 - x,
    "cancelling": lambda ar, x, y: (x + y) - x,
    "products": lambda ar, x, y: x * y * (x / y),
    "quotients": lambda ar, x, y: x / (x + y) / (x * y),
    "scaled": lambda ar, x, y: -1 * (2 * x / 8) - y / 4,
    "root of a quotient": lambda ar, x, y: ar.sqrt(x / y),
    "hypotenuse": lambda ar, x, y: ar.sqrt(x * x + y * y),
    "log1p": lambda ar, x, y: ar.log1p(x / y),
    "many": lambda ar, x, y: _many(x, y),
    "pi": lambda ar, x, y: ar.pi * x + y,
}


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize("operation", OPERATIONS_)
def test_bounds_hold(level: str, operation: str) -> None:
    sure = 0.5 if operation == "cancelling" else 0.95
    bound_holds(LEVELS[level], OPERATIONS_[operation], X, Y, sure=sure)


@pytest.mark.parametrize("level", LEVELS)
def test_bounds_of_exponentials_hold(level: str) -> None:
    ar, most = LEVELS[level], 57  # π times which is below 180
    for column in (SMALL, USUAL, rng.uniform(0, 1e-3, 400), rng.uniform(0, most, 400)):
        bound_holds(ar, lambda ar, x: ar.expm1(x * ar.pi), column)
        bound_holds(ar, lambda ar, x: ar.expm1(x) + 1, column, sure=0.9)
    bound_holds(ar, lambda ar, x: ar.expm1(x), rng.uniform(50, 180, 400))
    bound_holds(ar, lambda ar, x: ar.log1p(x), SMALL)


@pytest.mark.parametrize("in_all_rows", [False, True])
@pytest.mark.parametrize("bits", [56, 40])  # beside 2^-40 rounding is nothing
@pytest.mark.parametrize("level", LEVELS)
def test_bounds_of_functions_of_doubtful_numbers_hold(level: str, bits: int, in_all_rows: bool) -> None:
    """They are as far off as their fixed_error, or their row_error, allows."""
    ar, exact, by = LEVELS[level], Balls(), Fraction(1, 2**bits)
    x, y = symbols(ar, 2)
    most = float(by) * (1 + 2.0**-20)  # a little more, as bounds are kept in first order
    fixed_error, row_error = (most, 0.0) if in_all_rows else (0.0, x.parts[0] * 0.0 + most)
    doubtful = Bounded(ar, x.parts, fixed_error, row_error)
    operations: list[tuple[Callable[[Any, Any, Any], Any], Any]] = [
        (lambda ar, x, y: ar.expm1(x), rng.uniform(1, 30, 400)),
        (lambda ar, x, y: ar.log1p(x), X),
        (lambda ar, x, y: ar.sqrt(x), X),
        (lambda ar, x, y: x + x * x, X),
        (lambda ar, x, y: x / y - y, X),
        (lambda ar, x, y: y / x + y, X),
    ]
    for operation, column in operations:
        off(operation(ar, doubtful, y), lambda x, y, of=operation: of(exact, x * arb(1 + by), y), column, Y)


def test_there_is_no_bound_where_an_exponential_is_too_large() -> None:
    """In doubles the bound grows with the argument instead: nothing is certified from μφ = 90 on."""
    (x,) = symbols(PAIRS, 1)
    _, bounds = values(PAIRS.expm1(x) + 1, np.array([1.0, 181.0, 1e300]))
    assert [isfinite(bound) for bound in bounds] == [True, False, False]
    (mu,) = symbols(DOUBLES, 1)
    _, bounds = values(DOUBLES.expm1(mu * DOUBLES.pi), np.array([10.0, 90.0, 1e10]) / np.pi)
    assert [bound < MOST_ERROR for bound in bounds] == [True, False, False]


@pytest.mark.parametrize("level", LEVELS)
def test_bounds_of_angles_hold(level: str) -> None:
    ar = LEVELS[level]
    cos, sin = ar.cos_sin_of_degrees(*symbols(ar, 1))
    off(cos, lambda x: flint.arb.sin_pi(x / 180 + arb(Fraction(1, 2))), DEGREES)  # exactly 0 where it is
    off(sin, lambda x: flint.arb.sin_pi(x / 180), DEGREES)


def test_the_rounding_of_an_angle_is_in_its_bound(monkeypatch: pytest.MonkeyPatch) -> None:
    """Also beside a library that is no better than it must be."""
    monkeypatch.setattr(doubles_, "LIBRARY", 1.2 * UNIT)
    test_bounds_of_angles_hold("doubles")


def test_the_limit_leaves_room_for_what_bounds_leave_out() -> None:
    """Products of two bounds, and the rounding of a pair to a double."""
    assert MOST_ERROR * (1 + 100 * MOST_ERROR) + UNIT < PROMISE


doubles = st.floats(2.0**-120, 2.0**120)


@examples(100)
@given(doubles, doubles)
def test_sums_of_doubles_are_exact_pairs(x: float, y: float) -> None:
    a, b = symbols(PAIRS, 2)
    for number, exact in ((a + b, Fraction(x) + Fraction(y)), (a - b, Fraction(x) - Fraction(y))):
        assert values(number, np.array([x]), np.array([y])) == ([exact], [0.0])


@examples(200)
@given(doubles, doubles)
def test_a_product_of_doubles_comes_with_its_error(x: float, y: float) -> None:
    product, error = two_product(x, y)
    assert Fraction(product) + Fraction(error) == Fraction(x) * Fraction(y)
    assert values(symbols(PAIRS, 1)[0] * PAIRS.number(y), np.array([x]))[1] == [0.0]


@given(doubles | doubles.map(lambda x: -x))
def test_numbers_are_as_columns_of_them(x: float) -> None:
    """What is the same in all rows is computed once, with Python's doubles."""
    (head,) = worked_out([head_of(Formula("symbol", "x0"))], x0=np.array([x]))
    assert head_of(x) == head[0]


def test_the_library_is_within_its_assumed_bound() -> None:
    """On this machine."""
    flint.ctx.prec = 300
    wide, angles = 10 ** rng.uniform(-300, 300, 4000), rng.uniform(-np.pi / 4, np.pi / 4, 4000)
    worst = {}
    for name, column in (("log1p", wide), ("expm1", wide[wide < 80]), ("cos", angles), ("sin", angles)):
        got = getattr(np, name)(column)
        worst[name] = max(
            float(abs(arb(one) / getattr(arb(x), name)() - 1))
            for x, one in zip(column.tolist(), got.tolist(), strict=True)
        )
    assert max(worst.values()) <= LIBRARY / 2, worst


def test_tables_are_what_they_say() -> None:
    flint.ctx.prec = 300
    for i in (0, 1, 3, 16_383):
        got = sum(Fraction(float(column[i])) for column in powers())
        assert abs(arb(got) - (arb(Fraction(i, 16_384)) * arb(2).log()).expm1()) <= 2.0**-106
    assert all((part * 2.0 ** (24 - frexp(part)[1])).is_integer() for part in STEP[:3])
    assert abs(arb(sum(map(Fraction, STEP))) - arb(2).log() / TABLE_STEPS) <= 2.0**-146


@pytest.mark.parametrize(("fixed_error", "row_error", "right"), [(1.9e-14, 0, True), (9e-15, 9e-15, True), (9e-15, 1.1e-14, False), (2e-14, 0, False)])  # fmt: skip
def test_what_may_be_off_by_more_than_promised_is_not_certified(
    fixed_error: float, row_error: float, right: bool
) -> None:
    (x,) = symbols(DOUBLES, 1)
    column = x.parts[0] * row_error if row_error else 0.0
    _, condition = proven_double(Bounded(DOUBLES, x.parts, fixed_error, column), "certified")
    if condition is None:
        assert (right, row_error) == (True, 0)
    else:
        assert [bool(one[0]) for one in worked_out([condition], x0=np.ones(1))] == [right]


def test_exact_takes_a_double_just_where_both_ends_of_the_bound_round_to_it() -> None:
    """Beside a boundary of rounding by 2^-54 to 2^-106, with bounds of any size, and infinite."""
    count = 4_000
    first = rng.uniform(0.5, 1, count) * rng.choice([-1, 1], count)
    first = np.where(rng.random(count) < 0.1, np.copysign(0.5, first), first)  # its neighbours differ
    half = np.spacing(np.abs(first)) / 2
    beside = 2.0 ** -rng.uniform(1, 54, count) * rng.choice([-1, 0, 1], count)
    second = half * np.where(rng.random(count) < 0.3, rng.uniform(-1, 1, count), 1 + beside)
    first, second = first + second, second - ((first + second) - first)
    bound = 2.0 ** -rng.uniform(1, 170, count)
    to_the_boundary = np.abs(half * rng.choice([-1, 1], count) - second) / np.abs(first)
    bound = np.where((rng.random(count) < 0.2) & (to_the_boundary > 0), to_the_boundary, bound)
    bound = rng.choice([1.0, 0.0, np.inf, np.nan], count, p=[0.9, 0.05, 0.025, 0.025]) * bound
    columns = [first, second, bound]
    *parts, row_error = (Formula("symbol", f"x{i}") for i in range(3))
    value = Bounded(PAIRS, parts, 0.0, row_error, False)
    double, condition = proven_double(value, "exact")
    assert condition is not None
    doubles, sure = worked_out([double, condition], **{f"x{i}": x for i, x in enumerate(columns)})
    taken = Counter[str]()
    for got, accepted, *row in zip(doubles.tolist(), sure.tolist(), *columns, strict=True):
        *row_parts, bound_of_row = map(float, row)
        if not isfinite(bound_of_row):
            assert not accepted
            continue
        for name, more in (("as bounded", 0.0), ("by far", 2.0**-100)):
            off_by = abs(Fraction(row_parts[0])) * (Fraction(bound_of_row) + Fraction(more))
            ends = [sum(map(Fraction, row_parts)) + side * off_by for side in (-1, 1)]
            right = all(oracle.round_exact(end, None) == got for end in ends)
            taken[name] += right
            assert right or name == "by far" or not accepted, row
            assert accepted or name == "as bounded" or not right, row
    assert taken["by far"] > count / 4


@pytest.mark.parametrize("accuracy", ACCURACIES)
def test_a_result_that_is_too_small_to_be_written_out_is_0(accuracy: Accuracy) -> None:
    given: Any = {"M": [10.0], "mu": [1e9], "axle": [1.0], "quantities": ["critical_lighter_mass"]}
    assert solve_arrays([1.0], [3.0], accuracy=accuracy, **given)["critical_lighter_mass"].tolist() == [0.0]
