"""The arithmetics of columns: every bound holds, and what is assumed of NumPy does; and their programs."""

from collections import Counter
from collections.abc import Callable, Sequence
from fractions import Fraction
from math import frexp, isfinite
from random import Random
from typing import Any

import flint
import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from atwood_cli import solve_arrays
from atwood_cli.arithmetic.symbolic import Formula, Term
from atwood_cli.arrays import doubles as doubles_
from atwood_cli.arrays import pairs as pairs_
from atwood_cli.arrays.doubles import DOUBLES, LIBRARY, LIMIT, PROMISE, UNIT, Bounded, Doubles, certified
from atwood_cli.arrays.pairs import PAIRS, STEP, TABLE_STEPS, head_of, powers, two_product
from atwood_cli.arrays.plan import COLUMN, Pattern, Task, answering
from atwood_cli.arrays.program import OPERATIONS, Program
from atwood_cli.model.quantities import ACCURACIES, Accuracy
from atwood_cli.model.scene import INPUTS

from . import oracle
from .conftest import examples

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


def _many(x: Any, y: Any) -> Any:
    """As many products and quotients as a quantity may take, 60: tails grow with each."""
    z = x + y
    for _ in range(15):
        z = z / (x + y) * x / y * (x + y)
    return z


OPERATIONS_: dict[str, tuple[Callable[[Any, Any, Any], Any], Callable[..., flint.arb]]] = {
    "one constant": (lambda ar, x, y: ar.number(Fraction(1, 3)), lambda x, y: arb(Fraction(1, 3))),
    "one sum": (lambda ar, x, y: (x + y) + (y + 1), lambda x, y: x + 2 * y + 1),
    "one product": (lambda ar, x, y: x * y, lambda x, y: x * y),
    "one quotient": (lambda ar, x, y: x / y, lambda x, y: x / y),
    "one root": (lambda ar, x, y: ar.sqrt(x), lambda x, y: x.sqrt()),
    "sum": (lambda ar, x, y: x / y + y, lambda x, y: x / y + y),
    "difference": (lambda ar, x, y: x / y - y, lambda x, y: x / y - y),
    "of both signs": (
        lambda ar, x, y: (y - x) + (x - 2 * y) / 3 - x,
        lambda x, y: y - x + (x - 2 * y) / 3 - x,
    ),
    "cancelling": (lambda ar, x, y: (x + y) - x, lambda x, y: y),
    "product": (lambda ar, x, y: x * y * (x / y), lambda x, y: x * x),
    "quotient": (lambda ar, x, y: x / (x + y) / (x * y), lambda x, y: x / (x + y) / (x * y)),
    "scaled": (lambda ar, x, y: -1 * (2 * x / 8) - y / 4, lambda x, y: -x / 4 - y / 4),
    "root": (lambda ar, x, y: ar.sqrt(x / y), lambda x, y: (x / y).sqrt()),
    "hypotenuse": (lambda ar, x, y: ar.hypot(x, y), lambda x, y: (x * x + y * y).sqrt()),
    "log1p": (lambda ar, x, y: ar.log1p(x / y), lambda x, y: (x / y).log1p()),
    "many": (lambda ar, x, y: _many(x, y), lambda x, y: _many(x, y)),
    "pi": (lambda ar, x, y: ar.pi * x + y, lambda x, y: flint.arb.pi() * x + y),
}


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize("operation", OPERATIONS_)
def test_bounds_hold(level: str, operation: str) -> None:
    ar = LEVELS[level]
    ours, exact = OPERATIONS_[operation]
    off(ours(ar, *symbols(ar, 2)), exact, X, Y, sure=0.5 if operation == "cancelling" else 0.95)


@pytest.mark.parametrize("level", LEVELS)
def test_bounds_of_exponentials_hold(level: str) -> None:
    ar = LEVELS[level]
    most = 57  # π times which is below 180
    (x,) = symbols(ar, 1)
    for column in (SMALL, USUAL, rng.uniform(0, 1e-3, 400), rng.uniform(0, most, 400)):
        off(ar.expm1(x * ar.pi), lambda x: (x * flint.arb.pi()).expm1(), column)
        off(ar.exp(x), lambda x: x.exp(), column, sure=0.9)
    off(ar.expm1(x), lambda x: x.expm1(), rng.uniform(50, 180, 400))
    off(ar.log1p(x), lambda x: x.log1p(), SMALL)


def off_if_doubtful(ar: Doubles, by: Fraction, in_all_rows: bool) -> None:
    """Assert the bounds of functions of numbers that are as far off as their fixed_error, or their row_errors, allow."""
    x, y = symbols(ar, 2)
    most = float(by) * (1 + 2.0**-20)  # a little more, as bounds are kept in first order
    fixed_error, row_error = (most, 0.0) if in_all_rows else (0.0, x.parts[0] * 0.0 + most)
    doubtful = Bounded(ar, x.parts, fixed_error, row_error)
    off(ar.expm1(doubtful), lambda x: (x * arb(1 + by)).expm1(), rng.uniform(1, 30, 400))
    off(ar.log1p(doubtful), lambda x: (x * arb(1 + by)).log1p(), X)
    off(ar.sqrt(doubtful), lambda x: (x * arb(1 + by)).sqrt(), X)
    off(doubtful + doubtful * doubtful, lambda x: x * arb(1 + by) + (x * arb(1 + by)) ** 2, X)
    off(doubtful / y - y, lambda x, y: x * arb(1 + by) / y - y, X, Y)
    off(y / doubtful + y, lambda x, y: y / (x * arb(1 + by)) + y, X, Y)


@pytest.mark.parametrize("level", LEVELS)
def test_bounds_of_functions_of_doubtful_numbers_hold(level: str) -> None:
    for in_all_rows in (False, True):
        off_if_doubtful(LEVELS[level], Fraction(1, 2**56), in_all_rows)
        off_if_doubtful(LEVELS[level], Fraction(1, 2**40), in_all_rows)  # beside which rounding is nothing


def test_there_is_no_bound_where_an_exponential_is_too_large() -> None:
    """In doubles the bound grows with the argument instead: nothing is certified from μφ = 90 on."""
    (x,) = symbols(PAIRS, 1)
    _, bounds = values(PAIRS.expm1(x) + 1, np.array([1.0, 181.0, 1e300]))
    assert [isfinite(bound) for bound in bounds] == [True, False, False]
    (mu,) = symbols(DOUBLES, 1)
    _, bounds = values(DOUBLES.expm1(mu * DOUBLES.pi), np.array([10.0, 90.0, 1e10]) / np.pi)
    assert [bound < LIMIT for bound in bounds] == [True, False, False]


@pytest.mark.parametrize("level", LEVELS)
def test_bounds_of_angles_hold(level: str) -> None:
    ar = LEVELS[level]
    (x,) = symbols(ar, 1)
    cos, sin = ar.cos_sin_of_degrees(x)
    off(cos, lambda x: _straight(x / 180 + arb(Fraction(1, 2))), DEGREES)
    off(sin, lambda x: _straight(x / 180), DEGREES)


def test_the_rounding_of_an_angle_is_in_its_bound(monkeypatch: pytest.MonkeyPatch) -> None:
    """Also beside a library that is no better than it must be."""
    monkeypatch.setattr(doubles_, "LIBRARY", 1.2 * UNIT)
    test_bounds_of_angles_hold("doubles")


def _straight(half_turns: flint.arb) -> flint.arb:
    """sin πx, exactly 0 where it is."""
    return flint.arb.sin_pi(half_turns)


def _without_amplification(x: Bounded) -> Bounded:
    return Bounded(DOUBLES, (Formula("expm1", x.parts[0]),), LIBRARY, 0.0 * x.parts[0] + x.bound)


def bounds_hold(level: str) -> None:
    for operation in OPERATIONS_:
        test_bounds_hold(level, operation)
    test_bounds_of_exponentials_hold(level)
    test_bounds_of_functions_of_doubtful_numbers_hold(level)
    test_bounds_of_angles_hold(level)
    test_there_is_no_bound_where_an_exponential_is_too_large()


@pytest.mark.parametrize(
    ("where", "name", "wrong"),
    [
        *(
            (DOUBLES, f"error_of_{of}", UNIT / 2)
            for of in ("constant", "sum", "product", "quotient", "root", "doubles")
        ),
        (doubles_, "LIBRARY", UNIT / 2),
        (DOUBLES, "expm1", _without_amplification),
        *(
            (PAIRS, f"error_of_{of}", 0.0)
            for of in ("constant", "sum", "product", "quotient", "root", "series")
        ),
        (pairs_, "BOUNDED_EXPONENT", 1000.0),
    ],
)
def test_a_smaller_constant_does_not_hold(
    where: Any, name: str, wrong: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(where, name, wrong)
    monkeypatch.delitem(vars(DOUBLES), "pi", raising=False)
    with pytest.raises(AssertionError):
        bounds_hold("pairs" if where in (PAIRS, pairs_) else "doubles")


# fmt: off
FAR: dict[str, tuple[Callable[[Any, Any], Any], str]] = {
    "sum": (lambda x, y: x + y, "1.0cfac0eb59eccp-1 1.815a935b4c670p-56 1.00000000cecb1p+2 1.fff2e48e8a71ep-52"),
    "product": (lambda x, y: x * y, "1.29cde852fd9a2p+0 1.fffffffffffffp-54 1.00000000084d2p-2 1.fffffffffffffp-56"),
    "quotient": (lambda x, y: x / y, "1.00ab6c4000000p+0 -1.ff7ced916872bp-54 1.0000024694000p-2 1.fff2e48e8a71ep-56"),
    "root": (lambda x, _: mpmath.sqrt(x), "1.00000000db1bdp+0 1.fff2e48e8a71ep-54 1p+0 0p+0"),
}
# fmt: on
"""The pairs, of a million drawn, whose results are farthest off: by 2.7, 5.9, 8.0 and 3.1 units squared."""


@pytest.mark.parametrize("name", FAR)
def test_bounds_of_pairs_are_hardly_larger_than_errors(name: str) -> None:
    mpmath.mp.dps = 60
    operation, digits = FAR[name]
    parts = [float.fromhex(part) for part in digits.split()]
    x, y = (Bounded(PAIRS, tuple(Formula("symbol", f"x{i}") for i in some)) for some in ((0, 1), (2, 3)))
    number = PAIRS.sqrt(x) if name == "root" else operation(x, y)
    ((got,), (bound,)) = values(number, *(np.array([part]) for part in parts))
    exact = operation(*(mpmath.mpf(first) + mpmath.mpf(rest) for first, rest in (parts[:2], parts[2:])))
    assert bound / 3 < abs(mpmath.mpf(got.numerator) / got.denominator / exact - 1) <= bound


def test_the_limit_leaves_room_for_what_bounds_leave_out() -> None:
    """Products of two bounds, and the rounding of a pair to a double."""
    assert LIMIT * (1 + 100 * LIMIT) + UNIT < PROMISE


def test_bounds_are_as_tight_as_they_need_be() -> None:
    x, y = symbols(PAIRS, 2)
    for number in (PAIRS.expm1(x * PAIRS.pi), PAIRS.log1p(x / y), PAIRS.sqrt(x / y)):
        assert max(values(number, SMALL, Y)[1]) < 2.0**-90


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
    _, condition = certified(Bounded(DOUBLES, x.parts, fixed_error, column), "certified")
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
    double, condition = certified(value, "exact")
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


def test_a_question_is_open_where_the_bound_says_nothing() -> None:
    """h - b cancels; and where e^{μφ} is infinite, the answer is a sure no."""
    shared: dict[str, Any] = {"inertia": Fraction(1, 2), "wrap": Fraction(180)}
    inputs = {"m1": [1.0] * 4, "m2": [3.0] * 4, "M": [10.0] * 4, "mu": [0.2, 0.3, 400.0, 0.3], "g": [1.0] * 4}
    inputs["axle"] = [0.5, 0.5, 0.5, 3.0 * (1 - 2.0**-53)]
    pattern = Pattern(1, tuple(COLUMN if name in inputs else shared.get(name) for name in INPUTS))
    task = Task(pattern, frozenset({("moves_axle difference", True)}), (), 0)
    found = {}
    for question in ("scene", "lightest_at_rest"):
        program = answering(task, f"slips_at {question}", DOUBLES)
        found[question] = {name: np.empty(4, np.bool_) for name in program.results}
        columns = {name: np.array(column) for name, column in inputs.items()}
        program.run(columns, found[question], [np.empty(4, kind) for kind in program.between])
    assert found["scene"]["sure"].tolist() == [True] * 4
    assert found["scene"]["answer"].tolist() == [True, False, False, True]
    assert found["lightest_at_rest"]["sure"].tolist() == [True, True, True, False]


# Programs


BINARY, UNARY = ["+", "-", "*", "/", "maximum"], ["abs", "rint", "sqrt"]


def random_formulas(rng: Random, count: int) -> list[Formula]:
    """Formulas that share what they are made of, some of them twice the same."""
    made = [Formula("symbol", "x0"), Formula("symbol", "x1"), Formula("number", 3.0)]
    for _ in range(count):
        op = rng.choice([*BINARY, *UNARY, "where"])
        one, two, three = (rng.choice(made[-12:]) for _ in range(3))
        if op == "where":
            made.append(Formula(op, Formula("<", one, two), two, three))
        else:
            made.append(Formula(op, one, two) if op in BINARY else Formula(op, one))
    return [rng.choice(made) for _ in range(6)]


def plainly(one: Any, columns: dict[str, Any]) -> Any:
    if one.op == "symbol":
        return columns[one.parts[0]]
    if one.op == "number":
        return np.full(5, one.parts[0])
    parts = [plainly(part, columns) for part in one.parts]
    out: Any = np.empty(5, np.bool_ if one.op == "<" else np.float64)
    OPERATIONS[one.op](*parts, out)
    return out


@pytest.mark.parametrize("seed", range(60))
def test_programs_compute_what_formulas_say(seed: int) -> None:
    """Whatever is shared, written over or written in place."""
    chance = Random(seed)
    formulas = random_formulas(chance, chance.choice([1, 5, 14]))
    columns = {name: np.array([chance.uniform(-9, 9) for _ in range(5)]) for name in ("x0", "x1")}
    with np.errstate(all="ignore"):
        for one, got in zip(formulas, worked_out(formulas, **columns), strict=True):
            np.testing.assert_array_equal(got, plainly(one, columns))


def test_programs_do_nothing_twice_and_nothing_in_vain() -> None:
    x, y = Formula("symbol", "x0"), Formula("symbol", "x1")
    program = Program({"a": (x + y) * (y + x), "b": (x + y) * (x + y), "c": x * 2.0})
    done = [operation.__name__ for operation, _ in program.operations]
    assert done == ["add", "multiply", "multiply", "_copy"]
    assert len(program.between) == 1
    assert program.inputs == ["x0", "x1"]


@pytest.mark.parametrize("accuracy", ACCURACIES)
def test_a_result_that_is_too_small_to_be_written_out_is_0(accuracy: Accuracy) -> None:
    given: Any = {"M": [10.0], "mu": [1e9], "axle": [1.0], "quantities": ["critical_lighter_mass"]}
    assert solve_arrays([1.0], [3.0], accuracy=accuracy, **given)["critical_lighter_mass"].tolist() == [0.0]
