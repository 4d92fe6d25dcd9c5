"""Every value right, whichever way it is asked for: each door of the program against the oracle.

With `pytest --every-digit`, as .ci/run has it, four times as many scenes are tried.
"""

from collections import Counter
from collections.abc import Mapping, Sequence
from decimal import Decimal
from fractions import Fraction
from math import inf
from random import Random
from typing import Any

import pytest

from atwood_cli.reading.inputs import read_scene
from atwood_cli.solver.quantities import NAMES

from .conftest import many
from .tools import oracle
from .tools.doors import DOUBLES, TEXTS, Door, of_solutions, solve_any, within_promise
from .tools.scenes import DANGERS, FAMILIES, ON_AN_AXLE, Given, as_doubles, scenes

BOUNDS = ("friction_force_min", "friction_force_max")
"""They have no closed form: test_contact checks those of `solve`, with which the other doors must agree."""
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
    assert checked["acceleration"] or checked["tension_1"] or len(tried) < 4


def truth(given: Given) -> dict[str, Any]:
    found = oracle.expected(read_scene(given))
    return {name: found[name] for name in NAMES if name not in BOUNDS}


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


@pytest.mark.parametrize("family", [*USUAL, *DANGERS])
def test_values_of_doubles(family: str) -> None:
    """In columns, where rows that are alike are solved together. In every other one gravity is not given."""
    drawn = map(as_doubles, scenes(family, max(many(64), count_of(family) // 2), seed=1))
    tried: list[Given] = [row for row in drawn if row is not None]
    tried[::2] = [{name: text for name, text in row.items() if name != "g"} for row in tried[::2]]
    truths = [truth(given) for given in tried]
    for given, found in zip(tried, truths, strict=True):
        one = {name: getattr(solve_any(**given), name) for name in BOUNDS}
        found |= {name: value and Fraction(value) for name, value in one.items() if value not in (0, inf)}
    for door in DOUBLES.values():
        check(door, tried, truths)


def test_whole_numbers_have_one_answer_at_every_door() -> None:
    """They are the same as texts and as doubles, gravity is exact where it is not given, and 1000 digits are right."""
    rng = Random(43)
    tried: list[Given] = [
        dict(zip(("m1", "m2", "M"), map(str, rng.sample(range(1, 21), 3)), strict=True))
        | {"mu": rng.choice(["0.25", "0.5", "2"])}
        for _ in range(many(200))
    ]
    truths = [truth(given) for given in tried]
    for door in (*TEXTS.values(), *DOUBLES.values(), Door(of_solutions(1000), 1000, every=10)):
        check(door, tried, truths)
