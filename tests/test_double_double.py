"""The arithmetics of double-doubles: every bound holds, and what is assumed of NumPy does."""

from collections.abc import Callable
from fractions import Fraction
from typing import Any

import flint
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from atwood_cli.arithmetic.double import FLOATS
from atwood_cli.arithmetic.double_double import QUICK, ROUNDED, THOROUGH, Pairs
from atwood_cli.arithmetic.error_free import UNIT

LEVELS = {"rounded": ROUNDED, "quick": QUICK, "thorough": THOROUGH}
rng = np.random.default_rng(2026)
X, Y = 10 ** rng.uniform(-9, 9, (2, 400))
SMALL = 10 ** rng.uniform(-30, 0.8, 400)
USUAL = 10 ** rng.uniform(-1.5, 0.8, 400)
DEGREES = np.concatenate([rng.uniform(0, 800, 395), [90.0, 180.0, 270.0, 360.0, 1e-9]])


def arb(x: float | Fraction) -> flint.arb:
    q = Fraction(x)
    return flint.arb(flint.fmpq(q.numerator, q.denominator))


def off(pair: Any, exact: Callable[..., flint.arb], *columns: Any) -> None:
    """Assert that each row is within its bound, and the bound no wider than what it is for."""
    flint.ctx.prec = 400
    bounds = np.broadcast_to(pair.bound, pair.high.shape)
    lows = np.zeros_like(pair.high) if pair.low is None else pair.low
    for high, low, bound, *row in zip(pair.high, lows, bounds, *columns, strict=True):
        want = exact(*(arb(float(x)) for x in row))
        error = abs(arb(Fraction(high) + Fraction(low)) - want)
        assert error <= arb(float(bound)) * abs(want), row


def _many(x: Any, y: Any) -> Any:
    """As many products and quotients as a quantity may take, 60: tails grow with each."""
    z = x + y
    for _ in range(15):
        z = z / (x + y) * x / y * (x + y)
    return z


OPERATIONS: dict[str, tuple[Callable[[Any, Any, Any], Any], Callable[..., flint.arb]]] = {
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
@pytest.mark.parametrize("operation", OPERATIONS)
def test_bounds_hold(level: str, operation: str) -> None:
    ar = LEVELS[level]
    ours, exact = OPERATIONS[operation]
    off(ours(ar, ar.number(X), ar.number(Y)), exact, X, Y)


@pytest.mark.parametrize("level", LEVELS)
def test_bounds_of_ordered_terms_hold(level: str) -> None:
    """Where roundings weigh most: products just above 1, beside terms that are larger in all rows."""
    ar = LEVELS[level]
    x, y = rng.uniform(1, 1.01, 400), rng.uniform(1, 1.01, 400)
    z = x * y * (1 + 1e-9)
    a, b, c = map(ar.number, (x, y, z))
    off(c + a * b, lambda x, y, z: z + x * y, x, y, z)
    off(ar.number(Fraction(3)) - a * b, lambda x, y: 3 - x * y, x, y)
    near = Fraction(21, 10)  # off its double by 0.38 units
    off(ar.number(2.1 * x) / ar.number(near), lambda x: x / arb(near), 2.1 * x)
    if ar is not THOROUGH:
        assert (c + a * b).bound <= (a * b).bound / 2 + ar.sum_loss


@pytest.mark.parametrize("level", LEVELS)
def test_bounds_of_exponentials_hold(level: str) -> None:
    ar = LEVELS[level]
    most = 220 if ar is THOROUGH else 11  # π times which is below 700, or 36
    for x in (SMALL, USUAL, rng.uniform(0, most, 400)):
        off(ar.expm1(ar.number(x) * ar.pi), lambda x: (x * flint.arb.pi()).expm1(), x)
        off(ar.exp(ar.number(x)), lambda x: x.exp(), x)
    off(ar.log1p(ar.number(SMALL)), lambda x: x.log1p(), SMALL)
    assert np.isinf(ar.expm1(ar.number(np.array([1.0, 800.0]))).bound).tolist() == [False, True]


@pytest.mark.parametrize("level", LEVELS)
def test_bounds_of_angles_hold(level: str) -> None:
    ar = LEVELS[level]
    with np.errstate(all="ignore"):  # a sine of 0 has no relative error
        cos, sin = ar.cos_sin_of_degrees(ar.number(DEGREES))
    radians = [lambda x: (x * flint.arb.pi() / 180).cos(), lambda x: (x * flint.arb.pi() / 180).sin()]
    keep = DEGREES % 90 != 0
    for part, exact in zip((cos, sin), radians, strict=True):
        off(part.take(np.flatnonzero(keep)), exact, DEGREES[keep])
    turns = np.array([90.0, 180.0, 270.0, 360.0, 450.0])
    with np.errstate(all="ignore"):
        cos, sin = ar.cos_sin_of_degrees(ar.number(turns))
    assert sin.rounded()[[1, 3]].tolist() == [0, 0]
    assert cos.rounded()[[1, 3]].tolist() == [-1, 1]


def test_bounds_are_as_tight_as_they_need_be() -> None:
    x = QUICK.number(X) * QUICK.number(Y)
    assert x.bound < 2.0**-66
    assert QUICK.expm1(QUICK.number(USUAL)).bound < 2.0**-60
    assert QUICK.expm1(QUICK.number(SMALL)).bound.max() < 2.0**-50
    assert THOROUGH.expm1(THOROUGH.number(SMALL) * THOROUGH.pi).bound.max() < 2.0**-94
    assert THOROUGH.log1p(THOROUGH.number(X) / THOROUGH.number(Y)).bound.max() < 2.0**-94
    assert ROUNDED.number(X).high is X  # nothing is copied before it must be


@settings(max_examples=200)
@given(st.floats(2.0**-120, 2.0**120), st.floats(2.0**-120, 2.0**120), st.sampled_from(list(LEVELS.values())))
def test_sums_and_thorough_products_of_doubles_are_exact(x: float, y: float, ar: Pairs) -> None:
    a, b = ar.number(np.array([x])), ar.number(np.array([y]))
    products = [(a * b, Fraction(x) * Fraction(y))] if ar is THOROUGH else []
    for pair, exact in (
        (a + b, Fraction(x) + Fraction(y)),
        (a - b, Fraction(x) - Fraction(y)),
        *products,
    ):
        assert pair.low is not None
        assert Fraction(pair.high[0]) + Fraction(pair.low[0]) == exact


def test_the_library_is_within_its_assumed_bound() -> None:
    """log1p, cos and sin of NumPy, on this machine, within one unit in the last place."""
    flint.ctx.prec = 200
    angles = rng.uniform(-4, 4, 20_000)
    functions: list[tuple[Any, Callable[[flint.arb], flint.arb], Any]] = [
        (np.log1p, lambda x: x.log1p(), 10 ** rng.uniform(-300, 300, 20_000)),
        (np.cos, lambda x: x.cos(), angles),
        (np.sin, lambda x: x.sin(), angles),
    ]
    for ours, exact, columns in functions:
        worst = max(
            float(abs(arb(got) - exact(arb(x))) / np.spacing(abs(got)))
            for x, got in zip(columns.tolist(), ours(columns).tolist(), strict=True)
        )
        assert worst <= 1


def test_doubles_have_the_same_names() -> None:
    cos, sin = FLOATS.cos_sin_of_degrees(DEGREES)
    np.testing.assert_allclose(cos, np.cos(np.radians(DEGREES)), atol=1e-14)
    np.testing.assert_allclose(sin, np.sin(np.radians(DEGREES)), atol=1e-14)
    assert FLOATS.cos_sin_of_degrees(Fraction(180)) == (-1, 0)
    assert FLOATS.root(lambda x: x * x - 2, np.array([2.0]))[0] == pytest.approx(2**0.5, rel=1e-15)
    assert UNIT == np.finfo(float).eps / 2
