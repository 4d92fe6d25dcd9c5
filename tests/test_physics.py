"""The oracle against what it comes from: Newton's laws and the balance of energy. Examples of all equations."""

from collections import Counter
from doctest import DocTestFinder, DocTestRunner
from fractions import Fraction
from inspect import isfunction
from math import inf
from typing import Any

import flint
import pytest

from atwood_cli.reading.scenes import read_answers
from atwood_cli.solver import physics

from .conftest import many
from .tools.oracle import expected, measured, rational, side
from .tools.scenes import MEASURED, ON_AN_AXLE, scenes

FALL = {"drop": "drop", "time": "fall_time", "speed": "final_speed"}


def same(left: Any, right: Any) -> bool:
    """Whether numbers are equal: fractions are, balls overlap and are narrow."""
    apart, size = abs(flint.arb(left - right)), abs(flint.arb(left))
    return bool(apart.contains(0) and apart <= size / 2**60)


def laws(scene: Any) -> dict[str, bool]:
    """Whether the oracle's values keep to each law, by its name."""
    found, g, M = expected(scene), rational(scene.g), scene.M
    regime = found.pop("regime")
    flint.ctx.prec = 2000
    value = {name: x() if callable(x) else rational(x) for name, x in found.items()}
    m1, m2, f, phi = (
        *map(rational, (scene.m1, scene.m2, scene.axle or Fraction(0))),
        flint.arb.pi() * rational(scene.wrap.number) / 180,
    )
    l, h = min(m1, m2), max(m1, m2)
    driven, force = scene.motion.finds == "drive", value["drive_force"]
    if M is None and scene.mu is None:
        M = Fraction(0)
    beta = rational(scene.I / scene.R**2 / M if scene.I and M else scene.inertia)
    M = value["critical_pulley_mass"] if regime == "verge" else None if M == inf else rational(M)
    c = rational(scene.I / scene.R**2) if scene.I else None if M is None else beta * M
    a, t1, t2, rim = (value[x] for x in "acceleration tension_1 tension_2 rim_acceleration".split())

    if driven and t1 > t2:
        l, h = m2, m1
    elif driven:
        l, h = m1, m2

    def ratio(l: Any, h: Any, c: Any = c) -> Any:
        if driven:
            away = value["acceleration"] * (-1 if t1 > t2 else 1)
            return h * (g - away) / (l * (g + away))
        left = (h - l) * g - f
        a = left / (h + l + c) if left > 0 and c is not None else 0
        return h * (g - a) / (l * (g + a))

    kept = {}
    if a is not None:
        kept["(1)"] = same(m1 * (g + a), t1) and same(m2 * (g - a), t2)
    if driven and force is not None:
        moves = side(a or scene.motion.speed or scene.motion.drop or 0)
        kept["(3) with a drive"] = same(t2 - t1 + force, c * a + moves * f)
    elif rim is not None and c is not None and not driven:
        way = side(m2 - m1) or -side(a)  # equal masses only slow down
        kept["(3)"] = bool(abs(t2 - t1) <= f) if rim == 0 else same(t2 - t1, c * rim + way * f)
    v, turning = value["final_speed"], value["final_angular_speed"]
    if value["kinetic_energy"] is not None and scene.R and c is not None:
        at_rim = turning * rational(scene.R)
        kept["kinetic energy"] = same(value["kinetic_energy"], (m1 + m2) * v**2 / 2 + c * at_rim**2 / 2)
    if v is not None and driven and force is not None:
        drop = abs(value["drop"] or rational(scene.motion.drop))
        given = side(a) * ((m2 - m1) * g + force) * drop
        kept["power of a drive"] = same(value["drive_power"], side(a) * force * v)
        kept["energy with a drive"] = same((m1 + m2 + c) * v**2 / 2, given - f * drop)
    if v is not None and regime == "no-slip" and not driven:
        drop, time, speed = (abs(value[x] or rational(getattr(scene.motion, y))) for y, x in FALL.items())
        kept["mean speed"] = same(speed * time / 2, drop)
        kept["energy"] = same((l + h + c) * speed**2 / 2, ((h - l) * g - f) * drop)
    if driven and regime == "slip":
        kept["would slip"] = bool(max(t1, t2) > min(t1, t2) * value["capstan_ratio"])
    elif regime != "no-slip":
        given = scene.mu if regime == "verge" or scene.mu_k is None else scene.mu_k
        mu = rational(given) if value["mu_k"] is None else value["mu_k"]
        kept["(26)"] = same(max(t1, t2), min(t1, t2) * (mu * phi).exp())
    k = value["capstan_ratio"]
    if value["critical_heavier_mass"] is not None:
        kept["(35)"] = same(ratio(l, value["critical_heavier_mass"]), k)
    if value["critical_lighter_mass"]:
        kept["lighter"] = same(ratio(value["critical_lighter_mass"], h), k)
    if value["critical_pulley_mass"] is not None:
        kept["(34)"] = same(ratio(l, h, beta * value["critical_pulley_mass"]), k)
    return kept


@pytest.mark.parametrize("more", ["", ON_AN_AXLE, MEASURED, ON_AN_AXLE + MEASURED])
@pytest.mark.parametrize("family", ["ordinary", "nearly_equal", "near_critical"])
def test_the_oracle_keeps_to_the_laws(family: str, more: str) -> None:
    """An oracle may err as the package does: it has solutions, and the laws are equations."""
    tried = Counter[str]()
    for given in scenes(family + more, max(8, many(200)), seed=2):
        kept = laws(measured(read_answers(given, None).decided.scene)[1])
        assert all(kept.values()), (given, kept)
        tried.update(kept)
    assert {"(1)", "(3)"} <= {*tried}


@pytest.mark.parametrize("name", [name for name, one in vars(physics).items() if isfunction(one)])
def test_every_equation_has_an_example_that_holds(name: str) -> None:
    [example] = DocTestFinder(recurse=False).find(getattr(physics, name), name, physics)
    report: list[str] = []
    DocTestRunner().run(example, out=report.append)
    assert example.examples
    assert not report, "".join(report)
