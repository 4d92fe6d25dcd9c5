"""Standard uncertainties: how they are typed, propagated, shown, and what is refused."""

import json
import re
from collections.abc import Mapping
from decimal import Decimal, localcontext
from fractions import Fraction
from itertools import chain
from math import inf
from random import Random
from typing import Any

import pytest

from atwood_cli import SceneError, solve
from atwood_cli.numbers.digits import rounding_to_uncertainty, to_digits, with_uncertainty
from atwood_cli.reading.inputs import read_input
from atwood_cli.solver.scene import Input

from .conftest import many
from .tools.running import LOADED, process
from .tools.scenes import any_scene, inputs

# How they are typed


# fmt: off
TEXTS: dict[str, tuple[str | int, str | int]] = {
    "1.000(2)": (1, "0.002"), "1.00(12)": (1, "0.12"), "1.5(2)e-3": ("0.0015", "0.0002"), "1.5(234)": ("1.5", "23.4"),
    ".5(1)": ("0.5", "0.1"), "250(1)": (250, 1), "250.0(5)g": ("0.25", "0.0005"), "250.0(5) g": ("0.25", "0.0005"),
    "1.000±0.002": (1, "0.002"), "1.000+/-0.002": (1, "0.002"), "1 ± .5": (1, "0.5"), "1e-3±2e-5": ("0.001", "0.00002"),
    **dict.fromkeys(["250±1g", "250±1 g", "250 g ± 1 g", "(250±1)g", "(250 +/- 1) g"], ("0.25", "0.001")),
    **dict.fromkeys(["250g±1%", "(250±1%)g", "250 g +/- 1 %", "250g±10E-1%"], ("0.25", "0.0025")),
    "(2.5±0.1)e-1kg": ("0.25", "0.01"), "1/3±1/30": ("1/3", "1/30"), "1/3g±3%": ("1/3000", "1e-5"),
    "0(1)": (0, 1), "1.000": (1, 0), "1.000(0)": (1, 0), "1±0": (1, 0),
}
# fmt: on


@pytest.mark.parametrize("text", TEXTS)
def test_text(text: str) -> None:
    read = read_input("m1", text)
    assert (read.number, read.uncertainty, read.given) == (*map(Fraction, TEXTS[text]), text)


# Against steps that `solve` makes


MEASURED = """
m1=1 m2=2 a=1 g=9.8 inertia=0.5 axle=1 drop=1.7
m1=1 m2=3 a=2 M=50 mu=0.3 g=9.8 axle=1 drop=1.7
m1=1 m2=2 time=2 drop=1.7 g=9.8 R=0.3
m1=1 m2=1.0005 a=-0.0001 M=1 g=9.8 find=axle
""".strip().splitlines()


def drawn(rng: Random) -> dict[str, str]:
    """A scene of any kind, with uncertainties from tiny to those that change the regime."""
    measured = inputs(rng.choice(MEASURED))
    exact = rng.choice([any_scene(rng, "ordinary"), any_scene(rng, "ordinary"), measured])
    if "mu" not in exact and exact is not measured and rng.random() < 0.2:
        exact["m2"] = "0"
    if "mu" in exact and exact is not measured and rng.random() < 0.4:
        exact["mu_k"] = repr(float(exact["mu"]) * rng.choice([0.3, 0.99]))
    if "wrap" in exact and rng.random() < 0.5:
        exact["wrap"] = rng.choice(["2.5rad", "0.4turn"])
    typed = dict(exact)
    for x, value in exact.items():
        number = re.fullmatch(r"([\d.e+-]+)( ?(?:Nm?|rad|turn))?", value)
        if number and float(number[1]) and rng.random() < 0.6:
            sizes = [rng.uniform(-9, -2), -3 if exact is measured else rng.uniform(-1.5, -0.1)]
            u = abs(float(number[1])) * 10 ** rng.choice(sizes)
            typed[x] = f"{number[1]}±{u:.2g}{number[2] or ''}"
    return typed


def ends_of(x: str, given: Mapping[str, Any], step: Fraction) -> dict[str, Any]:
    """What is given, with an input so much more, but not below 0, and mu_k at most mu."""
    least, most = -inf if x == "a" else 0, given["mu"].number if x == "mu_k" else inf
    number = min(max(given[x].number + step, least), most)
    there = {**given, x: given[x]._replace(number=number)}
    mu_k = min(given["mu_k"].number, number) if x == "mu" and "mu_k" in given else None
    return there if mu_k is None else {**there, "mu_k": given["mu_k"]._replace(number=mu_k)}


def as_typed(read: Input) -> Any:
    """A number in the unit that it was read in, which is one of the SI."""
    in_si = not (read.unit.terms or read.unit.symbol == "rad")
    return read.number if in_si else f"{read.number}{read.unit.symbol}"


def solved(given: Mapping[str, Any]) -> Any:
    finds: Any = {"find": given["find"].given} if "find" in given else {}
    return solve(**{x: as_typed(read) for x, read in given.items() if x != "find"}, **finds, digits=70)


def solved_if_valid(given: Mapping[str, Any]) -> Any:
    try:
        return solved(given)
    except SceneError:
        return None


def test_an_uncertainty_is_made_of_steps_that_solve_makes() -> None:
    """To the last digit: half the range of three values for each input, and the root of their squares."""
    rng, compared, regimes = Random(7), 0, 0
    with localcontext() as context:
        context.prec = 100
        for _ in range(many(160)):
            typed = drawn(rng)
            read = {
                x: Input(given=value) if x == "find" else read_input(x, value) for x, value in typed.items()
            }
            here, found = solved(read), solve(**typed, digits=15)
            ends = {}
            for x, one in read.items():
                if one.uncertainty:
                    off = (-one.uncertainty, one.uncertainty)
                    ends[x] = [solved_if_valid(ends_of(x, read, step)) for step in off]
            regimes += any(end and end.regime != here.regime for pair in ends.values() for end in pair)
            for name, u in found.uncertainty.items():
                values: Any = [[getattr(end, name, None) for end in pair] for pair in ends.values()]
                value: Any = getattr(here, name)
                if value is None or None in chain(*values) or value.is_infinite():
                    assert u is None, (typed, name)
                elif any(one.is_infinite() for one in chain(*values)):
                    assert u is not None
                    assert u.is_infinite()
                else:
                    assert u is not None
                    steps = [(max(value, *pair) - min(value, *pair)) / 2 for pair in values]
                    want = sum((step * step for step in steps), Decimal(0)).sqrt()
                    assert abs(u - want) <= abs(want) * Decimal("1e-14"), (typed, name)
                    compared += 1
    assert compared > many(500)
    assert regimes > 0


# Ends


@pytest.mark.parametrize("u", ["0.1", "1e-9", "1e-29", "1e-31", "1e-400"])
def test_at_most_15_digits_and_none_below_1e_30_of_the_value(u: str) -> None:
    """Were padded with zeros after 60 digits."""
    given = {"m1": f"1±{u}", "m2": "3", "M": "10", "mu": "0.3"}
    found = solve(**given, digits=90).uncertainty["acceleration"]
    # a = g (3 - m1)/(m1 + 8)
    ends = [(3 - m1) / (m1 + 8) for m1 in (1 - Fraction(u), 1 + Fraction(u))]
    want = to_digits(15)(Fraction("9.80665") * (ends[0] - ends[1]) / 2)
    assert found == (want if Fraction(u) > Fraction("1e-30") else 0)
    assert solve(**given, digits=3).uncertainty["acceleration"] == to_digits(3)(found)


# How they are shown


# fmt: off
SIZES = {
    "0.7640266 0.0123": "0.764 ± 0.012", "0.7640266 0.0996": "0.76 ± 0.10", "9.8765 0.994": "9.88 ± 0.99",
    "9.8765 0.995": "9.9 ± 1.0", "1211148 7740": "1211100 ± 7700", "9.80665 98.0665": "10 ± 98",
    "0.00980665 98.0665": "0 ± 98", "-0.0049 0.15": "0.00 ± 0.15", "9.80665e-9 1.96e-10": "(9.81 ± 0.20)e-9",
    "-9.80665e20 1.96e19": "(-9.81 ± 0.20)e20", "1e-30 1e-3": "0.0000 ± 0.0010", "0.25 0.1": "0.25 ± 0.10",
    "0.0125 0.010": "0.012 ± 0.010", "0.0135 0.010": "0.014 ± 0.010",
    "1e-5 1e-450": f"(1.{'0' * 446} ± 0.{'0' * 444}10)e-5",
}
# fmt: on


@pytest.mark.parametrize("numbers", SIZES)
def test_numbers_of_every_size(numbers: str) -> None:
    value, u = map(Decimal, numbers.split())
    round_ = rounding_to_uncertainty(u)
    for exact in (value, Fraction(value)):
        assert with_uncertainty(round_(exact), round_(u))[0] == SIZES[numbers]


def test_exact_inputs_import_nothing_and_have_an_empty_mapping() -> None:
    for m1, loaded in (("1", False), ("1(1)", True)):
        ran = process("solve", "--m1", m1, "--m2", "3", "--json", code=LOADED)
        assert ("atwood_cli.solver.uncertainty" in ran.err.split()) == loaded
        assert (json.loads(ran.out)["uncertainty"] is not None) == loaded
    assert solve(m1="1", m2="3").uncertainty == {}
    assert hash(solve(m1="1", m2="3")) == hash(solve(m1="1", m2="3.0"))
