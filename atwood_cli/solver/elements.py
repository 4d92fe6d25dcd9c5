"""The arc as a simulator sees it: N string elements, each in balance, marched one after another.

The balance (8) of one element with friction at its limit makes the tension at its end
(1 + μ tan(Δθ/2))/(1 - μ tan(Δθ/2)) times that at its start. This runs in doubles, on purpose: it
shows what finite elements cost in accuracy beside the limit Δθ → 0 that the rest of the program
takes. The error falls as N^-2, with Richardson's extrapolation as N^-4, until rounding takes over.
"""

from __future__ import annotations

from collections.abc import Iterator
from decimal import Decimal
from fractions import Fraction
from math import atan2, cos, floor, hypot, inf, isfinite, tan
from typing import TYPE_CHECKING, Any, NamedTuple

from ..arithmetic.rounding import DOUBLE_DIGITS, to_digits
from ..model import physics
from ..model.machine import Machine
from ..model.scene import SceneError, read_whole
from .answers import Answers
from .contact import check_arc

if TYPE_CHECKING:
    from .uncertainty import OnMachine

BLOCK = 1 << 16  # elements at a time: arrays of half a megabyte, which stay in the cache
MAX_ELEMENTS = 10_000_000
ERROR_DIGITS = 3


class Comparison(NamedTuple):
    """A quantity from the elements, its exact value, and the relative error (absolute if that is 0)."""

    name: str
    value: float | Decimal
    exact: float | Decimal
    error: Decimal


class Elements(NamedTuple):
    """The quantities that the elements give, and notes on those they do not."""

    rows: list[Comparison]
    notes: list[str]


TOO_LARGE = "run in doubles, which this scene is too large for"
TOO_SMALL = "run in doubles, which this scene is too small for"
NOT_LIMITING = "tension_ratio, friction_force: not decided by mu while friction is to spare."
NO_MASS = "critical_pulley_mass: so few elements overrate friction, and find no pulley heavy enough."


def march(mu: float, phi: float, count: int) -> tuple[float, float, float, float]:
    """k_N, the tension ratio over ``count`` elements, k_N - 1, and the net friction (x, y) over T_l.

    Elements must be so many that μ tan(Δθ/2) < 1. Raises SceneError where k_N is no double.
    """
    import numpy as np

    step = phi / count
    grip = mu * tan(step / 2)
    k1, x, y, first = 0.0, 0.0, 0.0, 0
    for ends in _tensions(mu, phi, count):
        # F2 - F1 in terms of F2, as the difference of nearly equal tensions has lost its digits.
        rises = ends * (2 * grip / (1 + grip))
        # (8a): the friction of an element is (F2 - F1) cos(Δθ/2), tangential at its middle.
        friction = rises * cos(step / 2)
        middle = (np.arange(first, first + len(ends)) + 0.5) * step
        k1 += float(rises.sum())
        x -= float(friction @ np.sin(middle))
        y += float(friction @ np.cos(middle))
        first += len(ends)
    return float(ends[-1]), k1, x, y


def march_ratio(mu: float, phi: float, count: int) -> float:
    """k_N alone, as `march` has it."""
    for ends in _tensions(mu, phi, count):
        last = ends[-1]
    return float(last)


def _tensions(mu: float, phi: float, count: int) -> Iterator[Any]:
    """The tensions over T_l at the ends of the elements, a block at a time."""
    import numpy as np

    grip = mu * tan(phi / count / 2)
    tension = 1.0
    for first in range(0, count, BLOCK):
        ends = np.full(min(BLOCK, count - first), (1 + grip) / (1 - grip))
        ends[0] *= tension
        with np.errstate(over="ignore"):
            np.multiply.accumulate(ends, out=ends)
        tension = ends[-1]
        if not isfinite(tension):
            raise SceneError("elements", count, TOO_LARGE)
        yield ends


def extrapolated(fine: float, coarse: float) -> float:
    """Richardson's extrapolation of what ``coarse`` gives with half the elements, to errors as N^-4."""
    return (4 * fine - coarse) / 3


def balanced(mu: float, phi: float, count: int) -> bool:
    """Whether μ tan(Δθ/2) < 1."""
    return phi / (2 * count) < atan2(1, mu)


def _check_count(machine: _Doubles, count: int, times: int) -> None:
    """Refuse elements that are too few for a balance, and name the least number that will do.

    ``times`` is 2 where half of them must balance, too. Raises SceneError.
    """
    mu, phi = machine.mu, machine.phi
    if balanced(mu, phi, count // times):
        return
    cause = f"{'mu_verge' if machine.case.scene.mu is None else 'mu'} and wrap"
    least, most = max(1, floor(phi / (2 * atan2(1, mu)))), MAX_ELEMENTS // times
    while least <= most and not balanced(mu, phi, least):
        least += 1
    limit = (
        f"which take at least {times * least}" if least <= most else f"and so are {MAX_ELEMENTS}, the most"
    )
    raise SceneError("elements", count, f"are too few for this {cause}, {limit}")


def elements(answers: Answers, count: int | str, extrapolate: bool = False) -> Elements:
    """What friction at its limit decides, from ``count`` elements, beside the exact values.

    With ``extrapolate``, Richardson's, from half as many elements too. Raises SceneError.
    """
    count = read_whole("elements", count, 1, MAX_ELEMENTS)
    if extrapolate and count % 2:
        raise SceneError("elements", count, "must be even, to extrapolate from half as many")
    check_arc(answers.case)
    machine, rough = _Doubles(Answers(answers.case.scene), count), Answers(answers.case.scene, ERROR_DIGITS)
    _check_count(machine, count, 2 if extrapolate else 1)
    values = machine.solve(count)
    if extrapolate:
        coarse = machine.solve(count // 2)
        values = {name: extrapolated(value, coarse[name]) for name, value in values.items()}
    # A double has no more digits.
    round_ = answers.round if answers.digits is None else to_digits(min(answers.digits, DOUBLE_DIGITS))
    rows, notes = [], []
    for name, value in values.items():
        if not isfinite(value):
            notes.append(NO_MASS)
            continue
        shown, exact = Fraction(value), EXACT[name]
        if not shown and rough.settle(exact):
            raise SceneError("elements", count, TOO_SMALL)
        rows.append(Comparison(name, round_(shown), answers.settle(exact), _error(rough, exact, shown)))
    if "friction_force" not in values:
        notes.append(NOT_LIMITING)
    return Elements(rows, notes)


def _error(rough: Answers, exact: OnMachine, shown: Fraction) -> Decimal:
    """The relative error of a value, correctly rounded: that of the error, not of two rounded numbers."""
    if not rough.settle(exact):
        return to_digits(ERROR_DIGITS)(shown)

    def error(machine: Machine[Any]) -> Any:
        right = exact(machine)
        return (machine.ar.number(shown) - right) / right

    return Decimal(rough.settle(error))


EXACT: dict[str, OnMachine] = {
    "capstan_ratio": lambda machine: machine.reference_ratio,
    "tension_ratio": lambda machine: machine.tension_ratio,
    "critical_pulley_mass": lambda machine: machine.critical_pulley_mass,
    "friction_force": lambda machine: machine.friction_force,
}


class _Doubles:
    """A scene in doubles, solved by elements."""

    def __init__(self, answers: Answers, count: int) -> None:
        self.answers, self.case, self.count = answers, answers.case, count
        self.phi = self._double(lambda machine: machine.phi)
        self.mu = self._double(lambda machine: machine.reference_mu)

    def _double(self, of: OnMachine) -> float:
        value = float(self.answers.settle(of))
        if not isfinite(value):
            raise SceneError("elements", self.count, TOO_LARGE)
        return value

    def solve(self, count: int) -> dict[str, float]:
        case, answers = self.case, self.answers
        k, k1, x, y = march(self.mu, self.phi, count)
        values = {"capstan_ratio": k}
        l, h = self._double(lambda machine: machine.l), self._double(lambda machine: machine.h)
        if answers["critical_pulley_mass"] is not None:
            beta = self._double(lambda machine: machine.ar.number(case.beta or 0))
            transfer = physics.transfer_at_limit(l, k1)
            drive = physics.drive(l, h, transfer)
            b = None if case.axle_mass is None else self._double(lambda machine: machine.b)
            mass = physics.critical_pulley_mass(l, h, transfer, drive, beta, b) if drive > 0 else inf
            values["critical_pulley_mass"] = mass
        if answers["friction_force"] is None:
            return values
        if case.regime == "slip" and case.scene.mu_k is not None:
            kinetic = self._double(lambda machine: machine.arc_mu("exponential"))
            k, k1, x, y = march(kinetic, self.phi, count)
        light = self._double(lambda machine: machine.light_tension)
        if case.regime != "no-slip":
            transfer, g = physics.transfer_at_limit(l, k1), self._double(lambda machine: machine.g)
            drive, load = physics.drive(l, h, transfer), physics.load(l, h, transfer)
            light = physics.light_tension(l, physics.acceleration(drive, load, g), g)
        values["tension_ratio"] = k
        values["friction_force"] = light * hypot(x, y)
        return values
