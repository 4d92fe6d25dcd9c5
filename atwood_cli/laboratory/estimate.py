"""The rim mass c and the axle's friction f that fit runs best, by least squares: T_h - T_l = c a + f."""

from collections.abc import Mapping, Sequence
from fractions import Fraction
from math import inf, sqrt
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from ..model import physics
from ..model.digits import exact_decimal
from ..model.scene import Input
from ..tables.sources import Unreadable
from .runs import MEASURABLE, Run, Runs, rows_in_words
from .statistics import ROUNDING, Column, Line, fit_line, sum_of_squares

SLOWEST = 0.01
"""Below this share of the measured acceleration an expected time goes on along its tangent."""
CLOSE, MOST_STEPS = 1e-11, 50
"""The weights follow the values until these change less than this share of what is measured."""
TINY = 1e-100


class Data(NamedTuple):
    """Runs as columns, light and heavy masses apart.

    ``measured`` are means of so many values as ``counts`` says. ``scatter`` is the standard uncertainty of
    such a mean, ``stated`` or by its repeats, 0 without either. ``repeats`` are χ² and the degrees of
    freedom of the repeats about their means. ``uncertain`` has uncertainties of other columns, by name.
    """

    l: Column
    h: Column
    drop: Column | None
    measured: Column
    counts: Column
    scatter: Column
    stated: bool
    repeats: tuple[float, int]
    uncertain: Mapping[str, Column]


class Estimate(NamedTuple):
    """The fitted values, of these ``names``, and the given ones, with the linear fit at these values.

    ``sigma`` is the standard uncertainty of each run's measurement, scatter between runs included, and
    ``dof`` the number of runs less that of fitted quantities.
    """

    data: Data
    values: Mapping[str, float]
    names: Sequence[str]
    line: Line
    sigma: Column
    dof: int


# Runs as columns


def as_data(runs: Runs, used: Sequence[Run], drop_of_all: Input | None = None) -> Data:
    """Return the runs as columns. Raises Unreadable if only some measurements have an uncertainty."""
    sides = zip(*(sorted((run.m1, run.m2), key=lambda mass: mass.value) for run in used), strict=True)
    (l, u_l), (h, u_h) = map(_columns, sides)
    drop, uncertain = None, {"l": u_l, "h": u_h}
    if runs.kind == "time":
        drop, uncertain["drop"] = _columns([one for run in used if (one := drop_of_all or run.drop)])
    values, u, index = measurements(used)
    if (stated := bool(u.any())) and not u.all():
        name = rows_in_words(used[int(index[np.argmin(u > 0)])].rows)
        raise Unreadable(f"{name} has no uncertainty of its {runs.kind}, as others have; give all")
    weight = u**-2 if stated else np.ones_like(values)
    total = np.bincount(index, weight)
    measured = np.array([abs(run.mean) for run in used])
    if stated:
        measured = np.bincount(index, weight * values) / total
    measured = np.maximum(measured, MEASURABLE[0])  # the mean of accelerations to both sides may be 0
    chi2 = sum_of_squares(np.sqrt(weight) * (values - measured[index]))
    dof = len(values) - len(used)
    factor = chi2 / dof if dof else 0.0  # the variance of a value, in units of what is stated
    if stated:
        factor = max(factor, 1.0)
    variance = factor / total
    if dof and not stated:
        variance = variance + step_of([one for run in used for one in run.measured]) ** 2 / 12
    repeats = (chi2 / factor, dof) if factor else (0.0, 0)
    uncertain = {name: column for name, column in uncertain.items() if column.any()}
    counts = np.bincount(index).astype(float)
    return Data(l, h, drop, measured, counts, np.sqrt(variance), stated, repeats, uncertain)


def measurements(used: Sequence[Run]) -> tuple[Column, Column, NDArray[np.intp]]:
    """Return all measurements, their uncertainties and runs; positive if the heavier side falls."""
    index = np.repeat(np.arange(len(used)), [len(run.measured) for run in used])
    values, u = _columns([one for run in used for one in run.measured])
    return values * np.where(np.bincount(index, values) < 0, -1.0, 1.0)[index], u, index


def step_of(readings: Sequence[Input]) -> float:
    """Return the step of readings, by the last digit that any of them has; 0 if one is no decimal."""
    decimals = [exact_decimal(Fraction(one.value)) for one in readings]
    places = [int(one.as_tuple().exponent) if one is not None else -inf for one in decimals]
    return float(10.0 ** min(places))


def _columns(inputs: Sequence[Input]) -> tuple[Column, Column]:
    """Return the values of inputs, and their uncertainties."""
    values = np.array([float(one.value) for one in inputs])
    return values, np.array([float(one.uncertainty) for one in inputs])


# What is expected of runs


def expected(data: Data, values: Mapping[str, Any]) -> Any:
    """Return the acceleration of the heavier mass, or the time of its fall with the delay, for each run.

    ``values`` are rim_mass, axle, gravity and delay, and may replace columns. If next to nothing would
    move, the time goes on along its tangent, so that a fit finds its way back.
    """
    x: dict[str, Any] = {**data._asdict(), "delay": 0.0, **values}
    drive = physics.drive(x["l"], x["h"], physics.axle_mass(x["axle"], x["gravity"]))
    a = physics.acceleration(drive, physics.load(x["l"], x["h"], x["rim_mass"]), x["gravity"])
    if data.drop is None:
        return a
    least = SLOWEST * accelerations(data, data.measured)
    root: Any = np.sqrt
    moving = np.where(np.real(a) < least, least, a)
    return physics.fall_time(x["drop"], moving, root) * (1 + (moving - a) / (2 * moving)) + x["delay"]


def slopes(data: Data, values: Mapping[str, Any], names: Sequence[str]) -> Any:
    """Return the derivatives of what is expected of each run by each of ``names``: an array (runs, names).

    The imaginary part by an imaginary step is the derivative to the last digit.
    """
    x: dict[str, Any] = {**data._asdict(), "delay": 0.0, **values}
    columns = [expected(data, {**values, name: x[name] + 1j * TINY}).imag / TINY for name in names]
    return np.stack(columns, 1) if names else np.empty((len(data.l), 0))


def accelerations(data: Data, measured: Any, delay: float = 0.0) -> Any:
    """Convert fall times, less the delay, to accelerations; measured accelerations stay as they are."""
    return measured if data.drop is None else physics.acceleration_of_fall(data.drop, measured - delay)


# Least squares


def estimate(
    data: Data, given: Mapping[str, float], names: Sequence[str], near: Mapping[str, float] | None = None
) -> Estimate:
    """Weighted least squares for ``names``, starting at ``near``. Raises CannotSeparate.

    Variances follow the values (effective variance), and least squares the variances.
    """
    values = {**dict.fromkeys(("rim_mass", "axle", "gravity", "delay"), 0.0), **given}
    start = near or _start(data, values, names)
    values |= {x: max(start[x], _lightest(data) / 2) if x == "rim_mass" else start[x] for x in names}
    before = inf
    for _ in range(MOST_STEPS):
        J = slopes(data, values, names)
        line = fit_line(J, data.measured - expected(data, values), *variances(data, values), data.repeats)
        if not names:
            break
        found = _least_squares(data, values, names, np.sqrt(line.variance))
        step = J @ [found[x] - values[x] for x in names]
        share = sqrt(sum_of_squares(step / data.measured) / len(step))
        if share < CLOSE or share >= before:  # nothing but rounding is left
            break
        values, before = values | found, share
    sigma = np.sqrt(line.scale * line.variance)
    return Estimate(data, values, names, line, sigma, len(data.l) - len(names))


def variances(data: Data, values: Mapping[str, float]) -> tuple[Column, Column, Column]:
    """Return the known variance of each run, the shape of the unknown one, and the least of their sum.

    The unknown variance has the shape of a force that differs between runs, or of the scatter of single
    values if nothing shows that.
    """
    known = data.scatter**2
    for name, u in data.uncertain.items():
        known = known + (slopes(data, values, [name])[:, 0] * u) ** 2
    shape = slopes(data, values, ["axle"])[:, 0] ** 2 if data.scatter.any() else 1 / data.counts
    return known, shape, np.square(ROUNDING * data.measured)


def _least_squares(
    data: Data, values: Mapping[str, float], names: Sequence[str], sigma: Column
) -> dict[str, float]:
    """Return the values with the least sum of squares, each run with its standard uncertainty."""

    def at(x: Column) -> dict[str, float]:
        return {**values, **dict(zip(names, x.tolist(), strict=True))}

    found = least_squares(
        lambda x: (expected(data, at(x)) - data.measured) / sigma,
        [values[x] for x in names],
        lambda x: slopes(data, at(x), names) / sigma[:, None],
        bounds=([_lightest(data) if x == "rim_mass" else -inf for x in names], inf),
        x_scale="jac",
        **{"ftol": 1e-15, "xtol": 1e-15, "gtol": None},
    )
    return dict(zip(names, found.x.tolist(), strict=True))


def _lightest(data: Data) -> float:
    """Return the rim mass with which next to nothing would be left to move: less is beyond the pole."""
    return -(1 - 1e-9) * float((data.l + data.h).min())


def _start(data: Data, values: Mapping[str, float], names: Sequence[str]) -> dict[str, float]:
    """Return the values that fit the straight line of forces best."""
    J, y, *_ = line_of_forces(data, values, names)
    solution = np.linalg.lstsq(J, y, rcond=None)[0] if names else np.empty(0)
    return dict(zip(names, solution.tolist(), strict=True))


def line_of_forces(
    data: Data, values: Mapping[str, float], names: Sequence[str]
) -> tuple[Any, Column, Column, Column, Column]:
    """Return the straight line a (l + h) = g (h - l) - c a - f as the arguments of `fit_line`.

    It hardly depends on ``values``, of which c counts for variances. A delay is taken to be small.
    """
    a, load, g = accelerations(data, data.measured), data.l + data.h, values["gravity"]
    inert = load + max(values["rim_mass"], 0.0)
    by_measured = inert if data.drop is None else inert * 2 * a / data.measured
    columns = {"gravity": data.h - data.l, "rim_mass": -a, "axle": -np.ones_like(a), "delay": -by_measured}
    y = a * load - sum(values[x] * column for x, column in columns.items() if x not in names)
    J = np.stack([columns[x] for x in names], 1) if names else np.empty((len(a), 0))
    by_input = {"l": g + a, "h": g - a}
    if data.drop is not None:
        by_input["drop"] = inert * a / data.drop
    known = (data.scatter * by_measured) ** 2
    for name, u in data.uncertain.items():
        known = known + (by_input[name] * u) ** 2
    shape = np.ones_like(a) if data.scatter.any() else by_measured**2 / data.counts
    return J, y, known, shape, np.square(ROUNDING * data.measured * by_measured)
