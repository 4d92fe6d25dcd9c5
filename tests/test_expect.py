"""`solve --expect`: conditions are decided exactly, and what does not hold is said with its value."""

from fractions import Fraction

import mpmath
import pytest
from hypothesis import given
from hypothesis import strategies as st

from atwood_cli.solver.answers import read_answers
from atwood_cli.solver.expected import failure, read_condition

from .conftest import examples
from .running import Atwood
from .scenes import inputs, table

NEEDS_MU = "safety_factor has no value: give mu, the friction coefficient"
CASES = """
M=10 mu=0.3               | no-slip                   |
M=10 mu=0.3               | verge                     | it is no-slip
M=10                      | no-slip                   | it is assumed, as mu is not given
M=10                      | slip                      | it is no-slip
axle=30N                  | no-slip                   | it is assumed, as mu is not given
wrap=180                  | no-slip                   |
m1=0 M=10                 | no-slip                   |
M=100 mu=0.3              | slip                      |
mu=0.3                    | verge                     |
M=10 mu=0.3               | safety_factor >= 1.5      | it is 1.45753
M=10 mu=0.3               | μ/μ*>1.4                  |
M=10                      | safety_factor >= 1.5      | safety_factor has no value: give mu, the friction coefficient
M=10                      | torque > 1                | torque has no value: give R, the pulley's radius
M=8                       | a == g/4                  |
M=8                       | a < 0.25g                 | it is 2.4516625 m/s²
M=9 g=10                  | a < 40/17                 | it is 40/17 m/s²
M=8 g=moon                | a == 0.25g                |
M=8                       | T1 > 1kgf                 |
M=8                       | tension_2 < 4 lbf         | it is 22.0650 N
M=10 mu=0.3               | least_wrap < 2rad         | it is 123.497°
M=10 mu=0.3               | least_wrap >= 0.3turn     |
m1=2 m2=2 M=1             | a == 0                    |
M=8 mu=1e9                | capstan_ratio < 9         | it is too large to be written out
M=8 mu=1e9                | critical_lighter_mass > 0 | critical_lighter_mass has no value: not 0 but too small to be written out: about 10^-100000000 or less
m1=55g m2=60g a=0.38      | pulley_mass < 30g         |
M=10                      | gravity > 1               | gravity has no value: give a, a measured acceleration, beside M and in place of g
"""


@pytest.mark.parametrize(("words", "typed", "why"), table(CASES))
def test_what_is_expected(atwood: Atwood, words: str, typed: str, why: str) -> None:
    typed_in = [word for name, value in inputs(words).items() for word in (f"--{name}", value)]
    plain, ran = (atwood("solve", *typed_in, *more) for more in ((), ("--expect", typed)))
    said = f"atwood: expected {typed}; {why}\n" if why else ""
    assert (ran.status, ran.out, ran.err) == (bool(why), plain.out, plain.err + said)


@examples(200)
@given(
    st.integers(1, 10**6),
    st.integers(1, 10**6),
    st.integers(0, 10**6),
    st.sampled_from([-1, 0, 1]),
    st.integers(1, 60),
)
def test_it_is_decided_exactly(m1: int, m2: int, M: int, off: int, digits: int) -> None:
    """Beside a rational acceleration, and beside an irrational mass to sixty digits."""
    a = Fraction("9.80665") * (m2 - m1) / (m1 + m2 + Fraction(M, 2))
    answers = read_answers({"m1": m1, "m2": m2, "M": M, "mu": "1e3"}, None)
    bound = a + off * Fraction(1, 10**digits)
    for sign, holds in {
        "<": a < bound,
        "<=": a <= bound,
        ">": a > bound,
        ">=": a >= bound,
        "==": a == bound,
    }.items():
        assert (not failure(answers, read_condition(f"a {sign} {bound}"))) == holds
    with mpmath.workdps(digits + 30):
        k = mpmath.exp(mpmath.pi / 100)
        critical = 2 * mpmath.mpf(2) * (k - 1) / (2 - k) * 2
        below, above = (
            mpmath.nstr(critical * (1 + part * mpmath.mpf(10) ** -digits), digits + 20) for part in (-1, 1)
        )
    answers = read_answers({"m1": 1, "m2": 2, "mu": "0.01"}, None)
    assert not failure(answers, read_condition(f"M* > {below}"))
    assert not failure(answers, read_condition(f"M*<{above}"))
    assert failure(answers, read_condition(f"M* >= {above}")).startswith("expected M* >= ")


ERRORS = """
holds     | 'holds' must be no-slip, slip, verge, or a quantity and a number with < <= > >= or == between, as 'safety_factor >= 1.5'
a > 1 > 0 | 'a > 1 > 0' must be no-slip, slip, verge, or a quantity and a number with < <= > >= or == between, as 'safety_factor >= 1.5'
a > 1kg   | 'a > 1kg' compares with '1kg', which has the unit 'kg'; it takes m/s2, m s-2, cm/s2, ft/s2, N/kg
a >       | 'a >' compares with '', which is not a number; write it like 2, 1.5e-3, 2.0+-0.1 or 2.0(1)
mu > 1    | 'mu' is an input, no quantity
a > 1(1)  | 'a > 1(1)' compares with an uncertain number; leave its uncertainty out
"""


@pytest.mark.parametrize(("typed", "why"), table(ERRORS))
def test_conditions_that_cannot_be_read(atwood: Atwood, typed: str, why: str) -> None:
    ran = atwood("solve", "--m1", "1", "--m2", "3", "--expect", typed)
    assert (ran.status, ran.out) == (2, "")
    assert ran.err.startswith(f"atwood: --expect {why}")


@pytest.mark.parametrize("form", [[], ["--json"], ["--csv"]])
def test_only_regime_says_that_it_is_assumed(atwood: Atwood, form: list[str]) -> None:
    ran = atwood("solve", "--m1", "1", "--m2", "3", "--M", "10", "--only", "regime", *form)
    assert (ran.status, ran.err) == (0, "atwood: regime: assumed, as mu is not given.\n")
