"""Every value right, whichever way it is asked for: each door of the program against the oracle.

With `pytest --every-digit`, as .ci/run has it, four times as many scenes are tried.
"""

import sys
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields
from decimal import ROUND_UP, Context, Decimal, localcontext
from fractions import Fraction
from functools import lru_cache
from math import inf
from typing import Any

import polars as pl
import pytest

from atwood_cli import SceneError, fit, solve, solve_arrays, solve_table
from atwood_cli.reading.scenes import read_answers

from .conftest import many
from .tools import oracle
from .tools.doors import DOUBLES, TEXTS, Door, solve_any, within_promise
from .tools.regenerate import CASES, KEPT, essence
from .tools.scenes import DANGERS, FALLING, FAMILIES, LACKING, MEASURED, ON_AN_AXLE, Given, as_doubles, scenes

USUAL = [f"{family}{axle}" for axle in ("", ON_AN_AXLE) for family in FAMILIES]
INFINITE = (inf, -inf)


def right(door: Door, got: Any, want: float | Decimal | None) -> bool:
    if want is None or (door.on_paper and want in INFINITE):
        return got is None
    if isinstance(want, float) and got is not None:
        near = door.certified and want not in INFINITE and within_promise(got, want)
        return near or repr(float(got)) == repr(want + 0.0)  # never -0.0
    whole = not want or want in INFINITE or len(got.as_tuple().digits) == door.digits
    return bool(got == want and whole)


def check(door: Door, tried: Sequence[Given], truths: Sequence[Mapping[str, Any]]) -> None:
    checked, tried, truths = Counter[str](), tried[:: door.every], truths[:: door.every]
    for given, truth, values in zip(tried, truths, door.open(tried), strict=True):
        for name in truth.keys() & values.keys():
            want = truth[name] if name == "regime" else oracle.shown(truth[name], door.digits)
            got = values[name]
            assert got == want if name == "regime" else right(door, got, want), (given, name, got, want)
            checked[name] += got is not None
    assert checked["acceleration"] or checked["tension_1"] or checked["capstan_ratio"] or len(tried) < 4


def truth(given: Given) -> dict[str, Any]:
    found = oracle.expected(read_answers(given, None).decided.scene)
    return {name: value for name, value in found.items() if name not in oracle.BOUNDS}


def count_of(family: str) -> int:
    return max(8, many(1000 if family in FAMILIES else 400 if family in USUAL else 96))


@pytest.mark.parametrize("family", [*USUAL, *DANGERS])
def test_values_of_what_is_typed(family: str) -> None:
    tried = list(scenes(family, count_of(family)))
    truths = [truth(given) for given in tried]
    for door in TEXTS.values():
        check(door, tried, truths)
    regimes = Counter(found["regime"] for found in truths)
    assert family not in FAMILIES or min(regimes["slip"], regimes["no-slip"]) >= many(50)


@pytest.mark.parametrize(
    "family", [f"{family}{axle}{MEASURED}" for axle in ("", ON_AN_AXLE) for family in FAMILIES]
)
def test_values_of_measured_motions(family: str) -> None:
    tried = list(scenes(family, max(8, many(200))))
    truths = [truth(given) for given in tried]
    for door in TEXTS.values():
        if door.takes_motion:
            check(door, tried, truths)


@pytest.mark.parametrize("family", [f"{family}{LACKING}" for family in USUAL])
def test_values_without_masses(family: str) -> None:
    tried = list(scenes(family, max(16, many(96))))
    truths = [truth(given) for given in tried]
    for name, door in TEXTS.items():
        if name != "contact":
            check(door, tried, truths)


@pytest.mark.parametrize("family", [*USUAL, *DANGERS, *(f"{family}{FALLING}" for family in USUAL)])
def test_values_of_doubles(family: str) -> None:
    """In columns, where rows that are alike are solved together. In every other one gravity is not given."""
    drawn = map(as_doubles, scenes(family, max(many(64), count_of(family) // 2), seed=1))
    tried: list[Given] = [row for row in drawn if row is not None]
    tried[::2] = [{name: text for name, text in row.items() if name != "g"} for row in tried[::2]]
    truths = [truth(given) for given in tried]
    for given, found in zip(tried, truths, strict=True):
        one = {name: getattr(solve_any(**given), name) for name in oracle.BOUNDS}
        found |= {name: value and Fraction(value) for name, value in one.items() if value not in (0, inf)}
    for door in DOUBLES.values():
        check(door, tried, truths)


# Whatever the caller's decimal context


def read(solution: Any) -> list[Any]:
    return [solution.to_dict(), str(solution), *(getattr(solution, one.name) for one in fields(solution))]


def refused(given: Mapping[str, Any]) -> str:
    with pytest.raises(SceneError) as caught:
        solve(**{"m1": 1, "m2": 3, **given})
    return str(caught.value)


UNCERTAIN: dict[str, Any] = {"m1": "1.00(2)", "m2": "3±0.1", "mu": "0.3", "R": "5cm"}
FALLS: Any = {
    "m1": [0.10, 0.10, Decimal("0.1"), 0.1, 0.1],
    "m2": [0.12, 0.13, 0.14, Decimal("0.15"), Fraction(4, 25)],
    "t": ["2.05(2)", "1.7(1)", "1.45(2)", "1.34(2)", "1.24(2)"],
}
SCENES = pl.DataFrame({"m1 (g)": [Decimal("1.25"), Decimal("2.5")], "m2": [3, 4], "mu": ["0.3", "0.4"]})
COLUMNS: Any = [Decimal(1), 2, 0.3, 1e-200], 3, [Decimal("10.5"), 10**300, 1e300, 0], 0.3
PYTHON: dict[str, Callable[[], Any]] = {
    "doubles": lambda: read(solve("1", "3", mu="0.3")),
    "digits": lambda: read(solve(Decimal("1.23456789012345678901"), "3e5", M="1e400", mu=0.3, digits=30)),
    "limits": lambda: read(solve(1, 3, M="1e-500", mu="1e-500", axle="1e-500", wrap="1.5rad")),
    "uncertain": lambda: read(solve(**UNCERTAIN, I=Decimal("1e-5"))),
    "uncertain, to digits": lambda: read(solve(**UNCERTAIN, M=100, digits=40)),
    "measured": lambda: read(solve("55.0(1)g", "60+-0.1g", a="0.380", R="5cm")),
    "refused": lambda: [refused({"m1": Decimal(number)}) for number in ("sNaN", "inf", "1e999999")],
    "certified": lambda: [column.tolist() for column in solve_arrays(*COLUMNS).values()],
    "exact": lambda: [column.tolist() for column in solve_arrays(*COLUMNS, accuracy="exact").values()],
    "table": lambda: solve_table(SCENES).rows(),
    "fit": lambda: [*(made := fit(FALLS, drop="1.1(1)")), str(made)],
}
STRICT = Context(1, ROUND_UP, Emin=0, Emax=0, clamp=1, traps=[*Context().flags])
"""What is computed in it is rounded to a digit, and whatever is rounded or unusual is an exception."""


def forget() -> None:
    """Clear what is kept of earlier calls."""
    ours = [module for name, module in sys.modules.items() if name.startswith("atwood_cli")]
    for kept in (value for module in ours for value in vars(module).values()):
        if isinstance(kept, type(lru_cache(read))):
            kept.cache_clear()


def test_the_decimal_context_of_the_caller_changes_nothing() -> None:
    """Who trapped a decimal made of a float had an exception."""
    transcripts = [kept for kept in KEPT if kept.file in CASES and not kept.lacks][:: 800 // many(100)]
    texts = {kept.text: lambda kept=kept: essence(kept.today()) for kept in transcripts}
    for name, door in (PYTHON | texts).items():
        wanted = essence(name) if name in texts else door()
        forget()
        with localcontext(STRICT) as context:
            context.clear_flags()
            got = door()
        assert repr(got) == repr(wanted), name
        assert not any(context.flags.values()) or name in texts, name
    forget()
