"""The straight line that runs lie on: T_h - T_l against a, whose slope is c and whose intercept is f."""

from typing import Any, NamedTuple

import numpy as np

from ..model import physics
from .fitting import Fit
from .model import Column


class Points(NamedTuple):
    """Runs as points (a, T_h - T_l), with standard uncertainties, and what the line is.

    Those of ``y`` come from those of ``x``, so that the residuals, y less the line, have their own.
    """

    x: Column
    y: Column
    u_x: Column
    u_y: Column
    residual: Column
    u_residual: Column
    slope: float
    intercept: float


def points(fit: Fit) -> Points:
    """The runs that were used, as points."""
    data, values = fit.data, fit.estimate.values
    a, u = data.measured, fit.estimate.sigma * fit.scale
    if data.kind == "time" and data.drop is not None:
        a = physics.acceleration_of_fall(data.drop, data.measured)
        u = u * 2 * a / data.measured
    c, f = values["rim_mass"], values["axle"]
    y: Any = physics.difference_of_moving_masses(data.l, data.h, a, np.float64(values["gravity"]))
    line: Any = physics.difference_beside_axle(np.float64(c), a, np.float64(f))
    masses = data.l + data.h
    return Points(a, y, u, masses * u, y - line, (masses + c) * u, c, f)
