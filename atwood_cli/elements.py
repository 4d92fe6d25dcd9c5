"""The arc as a simulator sees it: N string elements, each in balance, marched one after another.

The balance (8) of one element with friction at its limit makes the tension at its end
(1 + μ tan(Δθ/2))/(1 - μ tan(Δθ/2)) times that at its start. This runs in doubles, on purpose: it
shows what finite elements cost in accuracy beside the limit Δθ → 0 that the rest of the program
takes. The error falls as N^-2, with Richardson's extrapolation as N^-4, until rounding takes over.
"""

from decimal import Decimal
from fractions import Fraction
from math import atan2, cos, floor, hypot, inf, isfinite, tan
from typing import NamedTuple

from . import physics
from .machine import wrap_angle
from .rounding import to_digits
from .scene import SceneError, read_whole
from .solver import Answers, OnMachine

BLOCK = 1 << 16  # elements at a time: arrays of half a megabyte, which stay in the cache
MAX_ELEMENTS = 10_000_000
EXACT_DIGITS = 20


class Row(NamedTuple):
    """A quantity from the elements, its exact value, and the relative error (absolute if that is 0)."""

    name: str
    value: float | Decimal
    exact: float | Decimal
    error: Decimal


def march(mu: float, phi: float, count: int) -> tuple[float, float, float]:
    """k_N, the tension ratio over ``count`` elements, and the net friction (x, y) over T_l.

    Raises SceneError where the elements are too few for friction to hold one in balance.
    """
    import numpy as np

    if not _balanced(mu, phi, count):
        rule = f"are too few for this mu and wrap, which take at least {_least(mu, phi)}"
        raise SceneError("elements", count, rule)
    step = phi / count
    grip = mu * tan(step / 2)
    tension, x, y = 1.0, 0.0, 0.0
    for first in range(0, count, BLOCK):
        ends = np.full(min(BLOCK, count - first), (1 + grip) / (1 - grip))
        ends[0] *= tension
        np.multiply.accumulate(ends, out=ends)
        # (8a): the friction of an element is (F2 - F1) cos(Δθ/2), tangential at its middle.
        friction = np.diff(ends, prepend=tension) * cos(step / 2)
        middle = (np.arange(first, first + len(ends)) + 0.5) * step
        x -= float(friction @ np.sin(middle))
        y += float(friction @ np.cos(middle))
        tension = float(ends[-1])
    return tension, x, y


def _balanced(mu: float, phi: float, count: int) -> bool:
    """Whether μ tan(Δθ/2) < 1."""
    return phi / (2 * count) < atan2(1, mu)


def _least(mu: float, phi: float) -> int:
    least = floor(phi / (2 * atan2(1, mu)))
    while not _balanced(mu, phi, max(1, least)):
        least += 1
    return max(1, least)


def elements(answers: Answers, count: int | str, extrapolate: bool = False) -> list[Row]:
    """What friction at its limit decides, from ``count`` elements, beside the exact values.

    With ``extrapolate``, Richardson's, from half as many elements too. Raises SceneError.
    """
    count = read_whole("elements", count, 1, MAX_ELEMENTS)
    if extrapolate and count % 2:
        raise SceneError("elements", count, "must be even, to extrapolate from half as many")
    doubles, exact = Answers(answers.case.scene), Answers(answers.case.scene, EXACT_DIGITS)
    values = _by_elements(doubles, count)
    if extrapolate:
        coarse = _by_elements(doubles, count // 2)
        values = {name: (4 * value - coarse[name]) / 3 for name, value in values.items()}
    rows = []
    for name, value in values.items():
        if isfinite(value):
            right, shown = Fraction(exact.settle(EXACT[name])), Fraction(value)
            error = to_digits(3)((shown - right) / right if right else shown)
            rows.append(Row(name, answers.round(shown), answers.settle(EXACT[name]), error))
    return rows


EXACT: dict[str, OnMachine] = {
    "capstan_ratio": lambda machine: machine.capstan_ratio,
    "tension_ratio": lambda machine: machine.tension_2 / machine.tension_1,
    "critical_pulley_mass": lambda machine: machine.critical_pulley_mass,
    "friction_force": lambda machine: machine.friction_force,
}


def _by_elements(answers: Answers, count: int) -> dict[str, float]:
    case, scene = answers.case, answers.case.scene

    def double(of: OnMachine) -> float:
        value = float(answers.settle(of))
        if not isfinite(value):
            raise SceneError("elements", count, "run in doubles, which this scene is too large for")
        return value

    phi = double(lambda machine: wrap_angle(machine.ar, scene))
    mu = double(lambda machine: machine.reference_mu)
    k, x, y = march(mu, phi, count)
    found = {"capstan_ratio": k}
    l, h = (double(lambda machine: machine.l), double(lambda machine: machine.h))
    if answers["critical_pulley_mass"] is not None:
        beta = double(lambda machine: machine.ar.number(case.beta or 0))
        surplus = h - l - physics.transfer_at_limit(l, k - 1)
        # Few elements overrate friction, and may find no pulley heavy enough.
        mass = physics.critical_pulley_mass(l, h, k - 1, surplus, beta) if surplus > 0 else inf
        found["critical_pulley_mass"] = mass
    if answers["friction_force"] is None:
        return found
    if case.regime == "slip" and scene.mu_k is not None:
        k, x, y = march(double(lambda machine: machine.arc_mu("exponential")), phi, count)
    light = double(lambda machine: machine.light_tension)
    if case.regime != "no-slip":
        effective = l + physics.transfer_at_limit(l, k - 1)
        light = physics.light_tension(l, h, effective, double(lambda machine: machine.g))
    found["tension_ratio"] = k if case.sign >= 0 else 1 / k
    found["friction_force"] = light * hypot(x, y)
    return found
