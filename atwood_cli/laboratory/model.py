"""What is expected of runs, by the model's own equations, and how it changes with what they depend on."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ..arithmetic.dual import Dual, Duals
from ..arrays.tables import Column
from ..model import physics
from .headings import Kind

NUMPY: Any = np
DUALS: Duals[Any] = Duals(NUMPY)
"""Of columns of doubles, for as much as the equation of a run needs."""


def expected(kind: Kind, given: Mapping[str, Any], to: Sequence[str]) -> tuple[Column, dict[str, Column]]:
    """The acceleration of the heavier mass, or the time of its fall, and its slopes with some of the given.

    ``given`` are columns or numbers: the masses l and h, rim_mass, axle, gravity, and the height drop. NaN
    where nothing would move in a time.
    """
    with np.errstate(all="ignore"):
        value = _expected(kind, {name: Dual(one) for name, one in given.items()}).value
        slopes = {x: _expected(kind, _moving(given, x)).slope for x in to}
    size = np.shape(value)
    return value, {x: np.broadcast_to(0.0 if one is None else one, size) for x, one in slopes.items()}


def _moving(given: Mapping[str, Any], x: str) -> dict[str, Dual[Any]]:
    return {name: Dual(one, 1.0 if name == x else None) for name, one in given.items()}


def _expected(kind: Kind, x: Mapping[str, Dual[Any]]) -> Dual[Any]:
    b = physics.axle_mass(x["axle"], x["gravity"])
    drive = physics.drive(x["l"], x["h"], b)
    a = physics.acceleration(drive, physics.load(x["l"], x["h"], x["rim_mass"]), x["gravity"])
    return a if kind == "a" else physics.fall_time(x["drop"], a, DUALS.sqrt)
