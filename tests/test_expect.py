"""`solve --expect`: conditions are decided exactly, and what does not hold is said with its value."""

from fractions import Fraction
from operator import eq, ge, gt, le, lt

import mpmath
from hypothesis import given
from hypothesis import strategies as st

from atwood_cli.explain.conditions import failure, read_condition
from atwood_cli.reading.scenes import read_answers
from atwood_cli.solver.quantities import QUANTITIES

from .conftest import examples

MASSES = st.integers(1, 10**6)


@examples(200)
@given(MASSES, MASSES, st.integers(0, 10**6), st.sampled_from([-1, 0, 1]), st.integers(1, 60))
def test_it_is_decided_exactly(m1: int, m2: int, M: int, off: int, digits: int) -> None:
    """Beside a rational acceleration, and beside an irrational mass to sixty digits."""
    a = Fraction("9.80665") * (m2 - m1) / (m1 + m2 + Fraction(M, 2))
    answers = read_answers({"m1": m1, "m2": m2, "M": M, "mu": "1e3"}, None)
    bound = a + off * Fraction(1, 10**digits)
    for sign, holds in {"<": lt, "<=": le, ">": gt, ">=": ge, "==": eq}.items():
        assert (not failure(answers, read_condition(f"a {sign} {bound}"))) == holds(a, bound)
    for share in (Fraction(1), Fraction(999, 1000)):  # up to the quantity, or not quite
        within = read_condition(f"a == {bound}±{abs(bound - a) * share}")
        assert (not failure(answers, within)) == (share == 1 or off == 0)
    answers = read_answers({"m1": 1, "m2": 2, "mu": "0.01"}, None)
    with mpmath.workdps(digits + 30):
        k = mpmath.exp(mpmath.pi / 100)
        critical, off_by = 8 * (k - 1) / (2 - k), mpmath.mpf(10) ** -digits
        below, above = (mpmath.nstr(critical * (1 + part * off_by), digits + 20) for part in (-1, 1))
    assert not failure(answers, read_condition(f"M* > {below}"))
    assert not failure(answers, read_condition(f"M*<{above}"))
    assert failure(answers, read_condition(f"M* >= {above}")).startswith("expected M* >= ")


def test_a_value_with_the_sign_of_the_motion_says_so() -> None:
    """Where the masses are exchanged, its sign changes; that of a component of friction is another matter."""
    there, here = (read_answers({"m1": m, "m2": 4 - m, "M": 99, "mu": "0.3", "R": 1}, None) for m in (1, 3))
    for name in QUANTITIES.keys() - {"friction_force_x"}:
        if there[name] and here[name]:
            said = failure(here, read_condition(f"{name} == {there[name]}"))
            assert said.endswith("; it is positive when m2 descends") == (here[name] == -there[name]), name
