"""The inertia of the pulley and the friction of its axle that agree best with runs: T_h - T_l = c a + f."""

from collections.abc import Mapping, Sequence
from math import inf, sqrt
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from ..model import physics
from ..model.scene import Input
from ..tables.sources import Unreadable
from .runs import Run, Runs
from .statistics import ROUNDING, Column, Line, fit_line, sum_of_squares

SLOWEST = 0.01
"""Below this share of the measured acceleration an expected time goes on along its tangent."""
CLOSE, MOST_STEPS = 1e-11, 50
"""The weights follow the values until these change less than this share of what is measured."""
TINY = 1e-100
GRAM, DELAY, LARGE = 1e-3, 0.1, 1 / 3
"""Errors that all runs may share (kg, s), and the share of an interval from which they matter."""


class Data(NamedTuple):
    """Runs as columns, light and heavy masses apart.

    ``measured`` are means of ``times`` values each. ``scatter`` is the standard uncertainty of such a mean,
    stated or by its repeats, 0 where there is neither; ``within`` are the degrees of freedom it is known by.
    ``uncertain`` is what else is uncertain in each run, by name.
    """

    l: Column
    h: Column
    drop: Column | None
    measured: Column
    times: Column
    scatter: Column
    within: float
    uncertain: Mapping[str, Column]


class Estimate(NamedTuple):
    """The fitted values, of these ``names``, and the given ones, with the linear fit at these values.

    ``sigma`` is the standard uncertainty of each run's measurement, by all that varies from run to run, and
    ``dof`` the degrees of freedom: the runs less the fitted quantities.
    """

    data: Data
    values: Mapping[str, float]
    names: Sequence[str]
    line: Line
    sigma: Column
    dof: int


def estimate(
    data: Data, given: Mapping[str, float], names: Sequence[str], near: Mapping[str, float] | None = None
) -> Estimate:
    """The values of the quantities so called that agree best with the runs, ``near`` others. Raises Alike.

    Variances follow the values (effective variance), and least squares the variances.
    """
    values = {"axle": 0.0, "rim_mass": 0.0, **given}
    start = near or straight(data, values, names)
    values |= {x: max(start[x], _lightest(data) / 2) if x == "rim_mass" else start[x] for x in names}
    before = inf
    for _ in range(MOST_STEPS):
        J = slopes(data, values, names)
        line = fit_line(J, data.measured - expected(data, values), *variances(data, values))
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


def expected(data: Data, values: Mapping[str, Any]) -> Any:
    """The acceleration of the heavier mass, or the time of its fall, for each run.

    ``values`` are rim_mass, axle and gravity, and may replace columns. Where next to nothing would move, the
    time goes on along its tangent, so that a fit finds its way back.
    """
    x: dict[str, Any] = {**data._asdict(), **values}
    drive = physics.drive(x["l"], x["h"], physics.axle_mass(x["axle"], x["gravity"]))
    a = physics.acceleration(drive, physics.load(x["l"], x["h"], x["rim_mass"]), x["gravity"])
    if data.drop is None:
        return a
    least = SLOWEST * accelerations(data, data.measured)
    root: Any = np.sqrt
    moving = np.where(np.real(a) < least, least, a)
    return physics.fall_time(x["drop"], moving, root) * (1 + (moving - a) / (2 * moving))


def slopes(data: Data, values: Mapping[str, Any], names: Sequence[str]) -> Any:
    """The change of what is expected of each run by each of the named: an array (runs, names).

    The imaginary part by an imaginary step is the derivative to the last digit.
    """
    x: dict[str, Any] = {**data._asdict(), **values}
    columns = [expected(data, {**values, name: x[name] + 1j * TINY}).imag / TINY for name in names]
    return np.stack(columns, 1) if names else np.empty((len(data.l), 0))


def variances(data: Data, values: Mapping[str, float]) -> tuple[Column, Column, Column]:
    """The known variance of each run, the shape of the unknown one, as of a force or of each value, and the
    least that their sum may be.
    """
    known = data.scatter**2
    for name, u in data.uncertain.items():
        known = known + (slopes(data, values, [name])[:, 0] * u) ** 2
    shape = slopes(data, values, ["axle"])[:, 0] ** 2 if data.scatter.any() else 1 / data.times
    return known, shape, np.square(ROUNDING * data.measured)


def accelerations(data: Data, measured: Any) -> Any:
    """What is measured, or would be, as accelerations."""
    return measured if data.drop is None else physics.acceleration_of_fall(data.drop, measured)


def _least_squares(
    data: Data, values: Mapping[str, float], names: Sequence[str], sigma: Column
) -> dict[str, float]:
    """The values with the least sum of squares, each run with its standard uncertainty."""

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
    """The rim mass with which next to nothing would be left to move: less is beyond the pole."""
    return -(1 - 1e-9) * float((data.l + data.h).min())


def straight(
    data: Data, values: Mapping[str, float], names: Sequence[str], weight: Any = 1.0
) -> dict[str, float]:
    """The straight line g (h - l) - c a - f = a (l + h), by weighted least squares of these forces."""
    a, load = accelerations(data, data.measured), data.l + data.h
    columns = {"gravity": data.h - data.l, "rim_mass": -a, "axle": np.full_like(a, -1.0)}
    rest = a * load - sum(values[x] * column for x, column in columns.items() if x not in names)
    if not names:
        return {}
    sides = np.stack([columns[x] * weight for x in names], 1)
    return dict(zip(names, np.linalg.lstsq(sides, rest * weight, rcond=None)[0].tolist(), strict=True))


def uncertain_accelerations(data: Data, sigma: Column) -> Column:
    """The standard uncertainties of accelerations, by those of what is measured."""
    return sigma if data.drop is None else sigma * 2 * accelerations(data, data.measured) / data.measured


def shared_error(
    best: Estimate, right: NDArray[np.bool_], widths: Mapping[str, float]
) -> tuple[str, dict[str, float]]:
    """An error that all runs may have in common, and how much it would change the values.

    Of the usual ones it is that which changes a value most beside the width of its interval; changes that are
    small beside that are left out. ``right`` says in which runs m2 is the heavier mass.
    """
    data, names = best.data, best.names
    errors = {"1 g more on the side of m2": data._replace(l=data.l + GRAM * ~right, h=data.h + GRAM * right)}
    if data.drop is not None and data.measured.min() > 2 * DELAY:
        errors[f"a delay of {DELAY:g} s in all times"] = data._replace(measured=data.measured - DELAY)
        errors["1 % more height in all falls"] = data._replace(drop=1.01 * data.drop)
    u_force = uncertain_accelerations(data, best.sigma) * (data.l + data.h + best.values["rim_mass"])
    line, *moved = (straight(one, best.values, names, 1 / u_force) for one in (data, *errors.values()))
    changes = {
        words: {x: abs(there[x] - line[x]) for x in names} for words, there in zip(errors, moved, strict=True)
    }
    worst = max(
        changes, key=lambda words: max((by / widths[x] for x, by in changes[words].items()), default=0)
    )
    return worst, {x: by for x, by in changes[worst].items() if by > LARGE * widths[x]}


def as_data(runs: Runs, used: Sequence[Run], drop_of_all: Input | None = None) -> Data:
    """The runs as columns. Raises Unreadable where only some measurements have an uncertainty."""
    sides = zip(*(sorted((run.m1, run.m2), key=lambda mass: mass.value) for run in used), strict=True)
    (l, u_l), (h, u_h) = map(_columns, sides)
    drop, uncertain = None, {"l": u_l, "h": u_h}
    if runs.kind == "time":
        drop, uncertain["drop"] = _columns([one for run in used if (one := drop_of_all or run.drop)])
    values, u, index = measurements(used)
    if (stated := bool(u.any())) and not u.all():
        name = used[int(index[np.argmin(u > 0)])].name
        raise Unreadable(f"{name} has no uncertainty of its {runs.kind}, as others have; give all")
    weight = u**-2 if stated else np.ones_like(values)
    total = np.bincount(index, weight)
    exact = np.array([abs(run.mean) for run in used])
    measured = np.bincount(index, weight * values) / total if stated else exact
    squares = sum_of_squares(np.sqrt(weight) * (values - measured[index]))
    repeated = len(values) - len(used)
    scatter = sqrt(squares / repeated) if repeated else 0.0  # by what is stated, if anything is
    scatters = (max(scatter, 1.0) if stated else scatter) / np.sqrt(total)
    within = inf if stated or not squares else repeated
    uncertain = {name: column for name, column in uncertain.items() if column.any()}
    return Data(l, h, drop, measured, np.bincount(index).astype(float), scatters, within, uncertain)


def measurements(used: Sequence[Run]) -> tuple[Column, Column, NDArray[np.intp]]:
    """All measurements, positive where the heavier side falls, their uncertainties, and the run of each."""
    index = np.repeat(np.arange(len(used)), [len(run.measured) for run in used])
    values, u = _columns([one for run in used for one in run.measured])
    return values * np.where(np.bincount(index, values) < 0, -1.0, 1.0)[index], u, index


def _columns(inputs: Sequence[Input]) -> tuple[Column, Column]:
    """The values of inputs, and their uncertainties."""
    values = np.array([float(one.value) for one in inputs])
    return values, np.array([float(one.uncertainty) for one in inputs])
