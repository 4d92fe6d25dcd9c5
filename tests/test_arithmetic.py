"""Enclosures enclose, and rounding rounds."""

from __future__ import annotations

import decimal
from collections.abc import Callable
from decimal import Decimal
from fractions import Fraction
from math import inf
from typing import TYPE_CHECKING, Any

import mpmath
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from atwood_cli.numbers import settling
from atwood_cli.numbers.digits import as_typed, share_exponent, strip_zeros, to_digits, to_double
from atwood_cli.numbers.digits import format_number as text_of
from atwood_cli.numbers.interval import Enclosure, Enclosures, NeedsMoreDigits, enclosures
from atwood_cli.numbers.rational import EXACT, Irrational
from atwood_cli.numbers.settling import settle

if TYPE_CHECKING:
    from atwood_cli.numbers.rational import Arithmetic, N, Quantity

precisions = st.sampled_from([20, 25, 50, 97, 200, 1000])
rationals = st.fractions().filter(lambda q: abs(q) < 10**30)


@st.composite
def positive(draw: st.DrawFn, low: int = -400, high: int = 4) -> Fraction:
    digits = draw(st.integers(1, 10**20))
    return Fraction(digits) * Fraction(10) ** (draw(st.integers(low, high)) - 20)


def contains(enclosure: Enclosure, exact: mpmath.mpf) -> bool:
    lo, hi = (mpmath.mpf(str(x)) for x in (enclosure.lo, enclosure.hi))
    return bool(lo <= exact <= hi)


def tight(enclosure: Enclosure, digits: int) -> bool:
    width = Fraction(enclosure.hi) - Fraction(enclosure.lo)
    return width <= abs(Fraction(enclosure.lo)) * Fraction(10) ** (4 - digits)


@given(precisions, rationals, rationals, st.integers(-9, 9))
def test_field_operations_enclose(digits: int, p: Fraction, q: Fraction, n: int) -> None:
    at = enclosures(digits)
    a, b = at.number(p), at.number(q)
    results = [(a + b, p + q), (a - b, p - q), (a * b, p * q), (n * a, n * p), (n + a, n + p), (a - n, p - n)]
    if q > 0:
        results.append((a / b, p / q))
    for enclosure, exact in results:
        assert Fraction(enclosure.lo) <= exact <= Fraction(enclosure.hi)


@given(precisions, positive())
def test_functions_enclose_tightly(digits: int, q: Fraction) -> None:
    at = enclosures(digits)
    x = at.number(q)
    with mpmath.workdps(digits + 900):
        exact = mpmath.mpf(q.numerator) / q.denominator
        for name in ("expm1", "log1p"):
            enclosure = getattr(at, name)(x)
            assert contains(enclosure, getattr(mpmath, name)(exact)), name
            # The argument's own width counts too, times the exponential's condition, |x|.
            slack = max(0, x.hi.adjusted() + 1) if "exp" in name else 0
            assert tight(enclosure, digits - slack), name
        root = at.sqrt(x)  # may be exact, which no power of two is
        assert Fraction(root.lo) ** 2 <= q <= Fraction(root.hi) ** 2
        assert tight(root, digits)
        for enclosure, value in zip(at.cos_sin(x), (mpmath.cos(exact), mpmath.sin(exact)), strict=True):
            assert contains(enclosure, value)


class Unrounded(Enclosures):
    """Keeps values, their bounds and bits from before they are rounded to digits, which hides errors of 2^40."""

    def _fixed(self, value: int, error: int, bits: int) -> Enclosure:
        vars(self).setdefault("kept", []).append((value, error, bits))
        return super()._fixed(value, error, bits)


@pytest.mark.parametrize("digits", [20, 50, 151, 200, 1000])
@given(positive(-9, 3))
def test_functions_and_constants_are_within_the_bounds_of_their_proofs(digits: int, q: Fraction) -> None:
    """With 151 digits, π is cut from one that has but a single bit more, and those that guard it."""
    at = Unrounded(digits)
    angle, power = at.number(q).lo, at.number(q / 1024).lo
    at.cos_sin(Enclosure(at, angle, angle))
    at.expm1(Enclosure(at, power, power))
    _ = at.pi
    with mpmath.workdps(digits + 400):
        x, y = mpmath.mpf(str(angle)), mpmath.mpf(str(power))
        exact = mpmath.cos(x), mpmath.sin(x), mpmath.expm1(y), mpmath.pi()
        for (value, error, bits), function in zip(vars(at)["kept"], exact, strict=True):
            assert abs(value - function * mpmath.mpf(2) ** bits) <= error


@given(precisions, st.integers(), st.integers(0), st.integers(0, 40))
def test_a_fixed_point_number_is_enclosed_with_its_error(
    digits: int, value: int, error: int, bits: int
) -> None:
    """Rounding to digits hides an end that lacks the error, unless the number is short."""
    found = enclosures(digits)._fixed(value, error, bits)
    assert Fraction(found.lo) <= Fraction(value - error, 2**bits)
    assert Fraction(found.hi) >= Fraction(value + error, 2**bits)


@pytest.mark.parametrize("wrong", ["-0.3", "-1e-9", "1e-9", "0.3"])
@given(precisions, positive(-3, 4))
def test_a_logarithm_is_enclosed_whatever_is_guessed(wrong: str, digits: int, q: Fraction) -> None:
    at = Enclosures(digits)
    guessed = enclosures(28).log1p(enclosures(28).number(q)).lo
    at._log1p_guess = lambda y: guessed * (1 + Decimal(wrong))  # type: ignore
    with mpmath.workdps(digits + 20):
        assert contains(at.log1p(at.number(q)), mpmath.log1p(mpmath.mpf(q.numerator) / q.denominator))


def test_roots_and_zero_are_exact_where_they_can_be() -> None:
    at = enclosures(30)
    for root in ("0", "0.0125", "345", "1e-400"):
        found = at.sqrt(at.number(Fraction(root) ** 2))
        assert found.lo == found.hi == Decimal(root)
    for result in (at.expm1(at.number(0)), at.log1p(at.number(0))):
        assert result.lo == 0 <= result.hi <= Decimal("1e-20")


@pytest.mark.parametrize("factor", ["-3", "0", "2"])
@pytest.mark.parametrize("signs", [(-5, -2), (-5, 2), (2, 5)])
@pytest.mark.parametrize("others", [(-7, -1), (-7, 1), (1, 7), (0, 0)])
def test_products_of_every_sign(signs: tuple[int, int], others: tuple[int, int], factor: str) -> None:
    at = enclosures(9)
    one, other = (Enclosure(at, Decimal(lo), Decimal(hi)) for lo, hi in (signs, others))
    products, product = [a * b for a in signs for b in others], one * other
    assert [product.lo, product.hi] == [min(products), max(products)]
    scaled = sorted(int(factor) * end for end in signs)
    assert [(int(factor) * one).lo, (int(factor) * one).hi] == scaled


@given(precisions, st.integers(5, 8), st.integers(1, 9))
def test_large_exponentials_enclose(digits: int, power: int, digit: int) -> None:
    at, q = enclosures(digits), digit * 10**power // 10
    with mpmath.workdps(digits + 50):
        assert contains(at.expm1(at.number(q)), mpmath.expm1(q))
    at = enclosures(30)
    beyond = at.expm1(at.number(10**9))  # exactly: a width of 0 times infinity would be nan
    assert beyond.lo == beyond.hi == inf


def test_division_by_what_may_be_zero_asks_for_digits() -> None:
    at = enclosures(20)
    third = at.number(Fraction(1, 3))
    for doubtful in (third - third, Enclosure(at, Decimal(0), Decimal(1))):
        with pytest.raises(NeedsMoreDigits):
            at.number(1) / doubtful
    with pytest.raises(ZeroDivisionError):
        at.number(1) / at.number(0)


def test_exact_fractions_refuse_to_leave_the_rationals() -> None:
    for call in ("expm1", "log1p", "sqrt", "cos_sin"):
        with pytest.raises(Irrational):
            getattr(EXACT, call)(Fraction(1, 2))
    with pytest.raises(Irrational):
        _ = EXACT.pi


@given(st.fractions(Fraction(1, 100), Fraction(99, 100)))
def test_a_root_is_enclosed_where_the_function_is_flat(exact: Fraction) -> None:
    """Signs of (s - r)³, multiplied out, are certain only a third of the digits away from r."""
    at = enclosures(40)
    r = at.number(exact)
    root = at.root(lambda s: s * s * s - 3 * r * s * s + 3 * r * r * s - r * r * r, at.number(1))
    assert Fraction(root.lo) <= exact <= Fraction(root.hi)


def test_a_quantity_that_never_settles_is_an_error_and_no_hang() -> None:
    def undecided(ar: Arithmetic[N]) -> N:
        root = ar.sqrt(ar.number(2))
        return root - root

    with pytest.raises(ArithmeticError, match="not settled within 50000 digits"):
        settling.is_positive(undecided)


@given(st.fractions())
def test_to_double_is_pythons_exact_division(q: Fraction) -> None:
    assert to_double(q) == q.numerator / q.denominator


# fmt: off
DOUBLES: list[tuple[Fraction | Decimal, float]] = [
    (Fraction(10) ** 400, inf), (-(Fraction(10) ** 400), -inf), (Fraction(1, 10**400), 0.0),
    (Decimal("1e400"), inf), (Decimal("-1e-400"), 0.0), (Decimal("4.9e-324"), 5e-324),
]
ROUNDED: dict[str, tuple[Fraction | Decimal, int]] = {
    "2": (Fraction(5, 2), 1), "4": (Fraction(7, 2), 1),  # ties go to the even digit
    "3.000": (Fraction(3), 4), "0.66667": (Fraction(2, 3), 5), "-1.0e-9": (Fraction(-1, 10**9), 2),
    "1.00e5": (Fraction(99999), 3), "10.0": (Decimal("9.995"), 3),
}
SHORTEST = {1.0: "1", 0.1: "0.1", 1e16: "1e16", 1e22: "1e22", 5e-324: "5e-324", 0.0: "0", 1.5e-7: "1.5e-7"}
AS_TYPED = {
    Fraction(3): "3", Fraction(1, 3): "1/3", Fraction(1, 8): "0.125", Fraction(10) ** 400: "1e400",
    Fraction(1, 10**9): "1e-9", Fraction(100): "100", Fraction(10**15): "1000000000000000",
    Fraction(10**16): "1e16", Fraction(3 * 10**16): "3e16",
    Fraction(1, 12960): "1/12960", Fraction(2 * 10**9, 3 * 10**9 + 1): "0.66666666644444444",
}
# fmt: on


def test_a_power_of_ten_stands_behind_numbers_from_1e16_on() -> None:
    for numbers, digits, shown in (
        ("1E15 1E14", 15, f"1{'0' * 15} ± 1{'0' * 14}"),
        ("1.0E16 1E15", 16, "(1.0 ± 0.1)e16"),
    ):
        assert share_exponent("{:f} ± {:f}", tuple(map(Decimal, numbers.split())), digits) == shown


@example(Fraction(0), Fraction(2), Fraction(1))
@given(st.fractions(0, 20), st.fractions(0, 6), st.fractions(0, 1))
def test_functions_of_a_wide_argument_enclose(lo: Fraction, width: Fraction, share: Fraction) -> None:
    """What an argument's width adds is bounded up to 1, and beyond that both ends are evaluated."""
    at = enclosures(25)
    x = Enclosure(at, at.number(lo).lo, at.number(lo + width).hi)
    inside = lo + share * width
    with mpmath.workdps(60):
        exact = mpmath.mpf(inside.numerator) / inside.denominator
        for name in ("expm1", "log1p", "sqrt"):
            assert contains(getattr(at, name)(x), getattr(mpmath, name)(exact)), name
        cos, sin = at.cos_sin(x)
        assert contains(cos, mpmath.cos(exact))
        assert contains(sin, mpmath.sin(exact))


def enclosed_to(value: str, width: Callable[[int], int]) -> Quantity:
    """An irrational quantity whose enclosures of so many digits are as wide as a power of ten."""

    def quantity(ar: Any) -> Any:
        if ar is EXACT:
            raise Irrational
        with decimal.localcontext(prec=20_000):
            half = Decimal((0, (1,), width(ar.digits)))
            return Enclosure(ar, Decimal(value) - half, Decimal(value) + half)

    return quantity


def test_wide_enclosures_are_not_taken_for_a_tie() -> None:
    near = f"2.5{'0' * 30}1"
    settled = settle(enclosed_to(near, lambda digits: -8000 if digits > 7000 else -20), to_digits(1), 1)
    assert settled == 3
    tie = settle(enclosed_to("2.5", lambda digits: -digits), to_digits(1), 1)
    assert tie == 2  # to even


def test_a_difference_that_is_0_in_all_its_digits_is_0() -> None:
    def quantity(ar: Any) -> Any:
        if ar is EXACT:
            raise Irrational
        return Enclosure(ar, Decimal(0), Decimal((0, (1,), -ar.digits)))

    assert settle(quantity, to_digits(3), 3) == 0


def test_text_is_what_people_write() -> None:
    assert [str(to_double(value)) for value, _ in DOUBLES] == [str(double) for _, double in DOUBLES]
    assert [text_of(to_digits(digits)(q)) for q, digits in ROUNDED.values()] == [*ROUNDED]
    assert {str(to_digits(4)(zero)) for zero in (Fraction(0), Decimal("-0"), Decimal("0e-12"))} == {"0"}
    assert {value: text_of(value) for value in SHORTEST} == SHORTEST
    assert {q: as_typed(q) for q in AS_TYPED} == AS_TYPED
    whole = {q: typed for q, typed in AS_TYPED.items() if q.denominator == 1}
    assert {q: text_of(strip_zeros(Decimal(int(q)))) for q in whole} == whole


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_text_reads_back_to_the_same_double(value: float) -> None:
    assert float(text_of(value)) == value
    assert len(text_of(value)) <= len(repr(value))
