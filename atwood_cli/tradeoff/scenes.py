"""Families of scenes that are hard on doubles, drawn from a seed.

Every platform draws the same doubles: mantissas and exponents are drawn one by one, so that no library's
powers or logarithms have a say, and what has to lie near the verge is first solved exactly. All scenes have
M and mu.
"""

from collections.abc import Callable
from math import ldexp
from random import Random
from typing import Any, NamedTuple

from ..model.scene import Scene
from ..solver.answers import Answers

Inputs = dict[str, Any]
"""The inputs of a scene by parameter, as doubles."""


def _between(rng: Random, low: int, high: int) -> float:
    """A number from 2^low to 2^high, its exponent uniform; the same double on every platform."""
    return ldexp(1 + rng.random(), rng.randrange(low, high))


def _ordinary(rng: Random) -> Inputs:
    m1 = _between(rng, -7, 7)
    m2 = m1 * (1 + _between(rng, -7, 7))
    return {"m1": m1, "m2": m2, "M": _between(rng, -7, 10), "mu": _between(rng, -7, 1)}


def _nearly_equal(rng: Random) -> Inputs:
    scene = _ordinary(rng)
    return scene | {"m2": scene["m1"] * (1 + _between(rng, -50, -7)), "mu": _between(rng, -60, -7)}


def _light_pulley(rng: Random) -> Inputs:
    scene = _ordinary(rng) | {"M": _between(rng, -100, -10)}
    return scene | {"mu": _between(rng, -100, -10)} if rng.random() < 0.5 else scene


def _near_critical(rng: Random) -> Inputs:
    """Beside the critical pulley mass, or beside the least heavier mass that can slip."""
    m1, mu = _between(rng, -7, 7), _between(rng, -7, 0)
    off = 1 + rng.choice((-1, 1)) * _between(rng, -50, -10)
    least: Any = _nearest("least_heavier_mass", m1=m1, m2=2 * m1, mu=mu)
    if rng.random() < 0.3:
        return {"m1": m1, "m2": least * off, "M": _between(rng, 0, 57), "mu": mu}
    m2 = least * (1 + _between(rng, -10, 4))
    return {"m1": m1, "m2": m2, "M": _nearest("critical_pulley_mass", m1=m1, m2=m2, mu=mu) * off, "mu": mu}


def _nearest(name: str, **given: float) -> Any:
    """The double nearest to a quantity of a scene."""
    return Answers(Scene.read(given))[name]


def _whole_range(rng: Random) -> Inputs:
    m1, m2, M = (_between(rng, -1074, 1024) for _ in range(3))
    return {"m1": min(m1, m2), "m2": max(m1, m2), "M": M, "mu": _between(rng, -1074, 10)}


class Family(NamedTuple):
    """A kind of scenes: the function that draws one, and what they are in words."""

    draw: Callable[[Random], Inputs]
    meaning: str


FAMILIES = {
    "ordinary": Family(
        _ordinary, "masses 0.01 to 100 kg, 1 % to a hundredfold apart; pulleys 0.01 to 1000 kg"
    ),
    "nearly-equal": Family(_nearly_equal, "masses apart by 1e-15 to 1e-2 of themselves, little friction"),
    "light-pulley": Family(_light_pulley, "pulleys of 1e-30 to 1e-3 kg"),
    "near-critical": Family(_near_critical, "M, or m2, within 1e-15 to 1e-3 of where the string slips"),
    "whole-range": Family(_whole_range, "masses from 5e-324 to 1e308 kg"),
}


def draw_scenes(family: str, count: int, seed: int) -> list[Inputs]:
    """So many scenes of a family; the same seed draws the same ones, and fewer the first of them."""
    rng = Random(f"{family} {seed}")
    return [FAMILIES[family].draw(rng) for _ in range(count)]
