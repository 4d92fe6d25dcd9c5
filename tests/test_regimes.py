"""Where along a range the regime changes: the place found without a formula is that of the formulas."""

from fractions import Fraction
from itertools import chain, pairwise
from math import log, pi
from random import Random

from hypothesis import given
from hypothesis import strategies as st

from atwood_cli import solve
from atwood_cli.numbers.digits import SHOWN_DIGITS
from atwood_cli.solver.decisions import Decisions
from atwood_cli.sweep.changes import LEAST_INPUT, changes
from atwood_cli.sweep.ranges import read_sweep

from .conftest import examples
from .tools import oracle
from .tools.scenes import G, any_scene


def check_with_oracle(words: dict[str, str], *places: float) -> int:
    """Hold what is said of a range to the oracle, there and within all that it says; how much it says."""
    swept = read_sweep(words)
    (along,) = swept.ranges
    said = list(changes(swept.scene, along))
    low, high = along.ends
    ends = chain.from_iterable((change.holds_at, change.differs_at) for change in said)
    stretches = list(pairwise([low, *ends, high]))
    in_turn = [said[0].before if said else Decisions(swept.scene).regime, *(change.after for change in said)]
    assert in_turn[:-1] == [change.before for change in said]
    for change in said:
        assert change.at in (change.holds_at, change.differs_at)
        a_digit = change.differs_at / 10 ** (SHOWN_DIGITS - 1)
        assert 0 < change.differs_at - change.holds_at <= max(a_digit, LEAST_INPUT), (words, change)
    for (start, stop), there in zip(stretches[::2], in_turn, strict=True):
        values = [start + (stop - start) * Fraction(i, 5) for i in range(6)]
        for value in [*values, *(Fraction(x) for x in places if start < x < stop)]:
            found = oracle.expected(along.at(value, swept.scene))["regime"]
            assert found == there, (words, float(value))
    return len(said)


@examples(300)
@given(st.integers(0), st.sampled_from(["m1", "m2"]), st.booleans())
def test_windows_narrower_than_any_step_are_found(seed: int, name: str, down: bool) -> None:
    """With b > c the tension ratio peaks where the axle lets go of a swept mass, at m + b."""
    rng = Random(seed)
    m, b = round(10 ** rng.uniform(-2, 2), 4), round(10 ** rng.uniform(-2, 1), 4)
    highest = log(1 + b / m) / pi
    mu = highest * (1 - 10 ** rng.uniform(-12, -3))
    ends = [m + b * rng.uniform(0, 0.9), (m + b) * 10 ** rng.uniform(0.5, 4)]
    words = {"m1": repr(m), "m2": repr(m), "mu": repr(mu)}
    words |= {"M": f"{b * rng.random():.6f}", "g": "10", "axle": repr(10 * b)}
    words[name] = ":".join(map(repr, sorted(ends, reverse=down))) + ":5"
    assert check_with_oracle(words, m + b) == 2


# fmt: off
RANGES = {
    "m1": "0.05:50", "m2": "60:0.02", "M": "0:400", "mu": "0:1.5", "g": "0.5:200", "inertia": "0.01:9",
    "I": "0.0001:30", "R": "0.01:5", "wrap": "1:1000", "axle": "0:90",
}
# fmt: on
NOT_BESIDE = {"inertia": ["I"], "I": ["M", "inertia"], "M": ["I"]}


@examples(400)
@given(st.integers(0), st.sampled_from(sorted(RANGES)), st.sampled_from(["", ":log"]))
def test_what_is_said_of_any_parameter_is_so(seed: int, name: str, log_: str) -> None:
    words = {"mu": "0.2", "R": "0.3"} | any_scene(Random(seed), "ordinary")
    for other in ["mu_k", *NOT_BESIDE.get(name, [])]:
        words.pop(other, None)
    unit = {"m1": "lb", "M": "oz", "R": "in", "wrap": "turn"}.get(name, "")
    if "Nm" in words.get(name, ""):
        unit = "Nm"
    ends = [end if end != "0" or not log_ else "0.001" for end in RANGES[name].split(":")]
    words[name] = ":".join(f"{end}{unit}" for end in ends) + f":4{log_}"
    check_with_oracle(words)


@examples(40)
@given(st.floats(1e-3, 1e3), st.floats(1.01, 100), st.floats(0.01, 0.99))
def test_motion_is_continuous_where_slip_begins(m1: float, ratio: float, share: float) -> None:
    """On which side of it a pulley is, is decided at any closeness."""
    m2, mu = m1 * ratio, share * log(ratio) / pi
    critical = solve(m1=m1, m2=m2, mu=mu, digits=1000).critical_pulley_mass or 0
    pulleys = (Fraction(critical) + Fraction(off, 10**900) for off in (-1, 1))
    grips, slips = (solve(m1=m1, m2=m2, mu=mu, g=G, M=pulley) for pulley in pulleys)
    assert (grips.regime, slips.regime) == ("no-slip", "slip")
    for name in ("acceleration", "tension_1", "tension_2", "rim_acceleration"):
        assert getattr(slips, name) == getattr(grips, name)
