"""Least squares: the pulley and the axle that agree best with runs, by the model's own equations."""

from collections.abc import Iterator, Mapping, Sequence
from math import inf, sqrt
from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.dual import Dual, Duals
from ..arrays.tables import Column
from ..model import physics
from .headings import Kind
from .statistics import Alike, LinearFit, fit_line, sum_of_squares

NUMPY: Any = np
DUALS: Duals[Any] = Duals(NUMPY)
"""Columns of doubles with their slopes; NumPy has what the equations of a run need."""
CLOSE = 1e-10
"""Steps that change less than this share of what is measured go on as long as each is half the last."""
MOST_STEPS, MOST_TRIES = 200, 40
STARTS = (1e-3, 0.03, 0.3, 0.7, 1, 1.5, 3, 10, 100)
"""Loads m1 + m2 + c, in those of the lightest masses alone, at which a fit may begin."""


class Data(NamedTuple):
    """Runs as columns, light and heavy masses apart.

    ``measured`` are means of ``times`` values each. ``spread`` is the standard uncertainty of one such value,
    given or by its repeats, 0 where there is neither; ``within`` are the degrees of freedom it is known by.
    ``uncertain`` is what else is uncertain in each run, by name.
    """

    kind: Kind
    l: Column
    h: Column
    drop: Column | None
    measured: Column
    times: Column
    spread: Column
    within: float
    uncertain: Mapping[str, Column]


class Estimate(NamedTuple):
    """The fitted values, of these ``names``, and the given ones, and the linear fit at these values.

    For each run ``expected`` is what these values give, with its ``slopes``; ``known`` is the known variance
    of its measurement, and ``shape`` the unknown one but for a factor. ``by_given`` is the change of the
    fitted values by a change of a given one.
    """

    values: Mapping[str, float]
    names: Sequence[str]
    linear: LinearFit
    slopes: Any
    expected: Column
    known: Column
    shape: Column
    by_given: Mapping[str, Any]

    def uncertainty(self, name: str) -> float:
        """The standard uncertainty of a fitted value, by the runs alone."""
        i = self.names.index(name)
        return self.linear.scale * sqrt(self.linear.covariance[i, i])

    def correlation(self, one: str, other: str) -> float:
        i, j = self.names.index(one), self.names.index(other)
        covariance = self.linear.covariance
        return float(covariance[i, j] / sqrt(covariance[i, i] * covariance[j, j]))


def estimate(data: Data, given: Mapping[str, float], names: Sequence[str]) -> Estimate:
    """The values of the quantities so called that agree best with the runs. Raises Alike.

    Gauss's steps, shortened where they lead away (Levenberg and Marquardt), within m1 + m2 + c > 0. Weights
    follow the values (effective variance).
    """
    values = dict(given) | _start(data, given, names)
    before = inf
    for _ in range(MOST_STEPS):
        ideal, J, known, shape = _state(data, values, names)
        rest = data.measured - ideal
        line = fit_line(J, rest, known, shape)
        weight = 1 / np.sqrt(line.variance)
        share = sqrt(sum_of_squares(J @ line.step * weight) / sum_of_squares(data.measured * weight))
        if share < CLOSE and share >= before / 2:  # nothing but rounding is left
            break
        before = share
        values = _moved(data, values, names, J * weight[:, None], rest * weight, weight)
    shared = ("rim_mass", "axle", "gravity", "drop")[: 4 if data.kind == "time" else 3]
    _, slopes = expected_of(data, values, [x for x in shared if x not in names])
    by_given = {x: -line.covariance @ J.T @ (slope / line.variance) for x, slope in slopes.items()}
    return Estimate(values, names, line, J, ideal, known, shape, by_given)


def expected(kind: Kind, given: Mapping[str, Any], to: Sequence[str]) -> tuple[Column, dict[str, Column]]:
    """The acceleration of the heavier mass, or the time of its fall, and its slopes ``to`` some of the given.

    ``given`` are columns or numbers: the masses l and h, rim_mass, axle, gravity, and the height drop. NaN
    where nothing would move in a time.
    """

    def at(moving: str = "") -> Dual[Any]:
        x = {name: Dual(one, 1.0 if name == moving else None) for name, one in given.items()}
        drive = physics.drive(x["l"], x["h"], physics.axle_mass(x["axle"], x["gravity"]))
        a = physics.acceleration(drive, physics.load(x["l"], x["h"], x["rim_mass"]), x["gravity"])
        return a if kind == "a" else physics.fall_time(x["drop"], a, DUALS.sqrt)

    with np.errstate(all="ignore"):
        value, slopes = at().value, {x: at(x).slope for x in to}
    size = np.shape(value)
    return value, {x: np.broadcast_to(0.0 if one is None else one, size) for x, one in slopes.items()}


def expected_of(
    data: Data, values: Mapping[str, float], to: Sequence[str]
) -> tuple[Column, Mapping[str, Column]]:
    """What is expected of the runs, not finite where no pulley is so light, and its slopes."""
    if values["rim_mass"] <= -(data.l + data.h).min():
        return np.full_like(data.l, inf), {}
    return expected(data.kind, {"l": data.l, "h": data.h, "drop": data.drop, **values}, to)


def _state(
    data: Data, values: Mapping[str, float], names: Sequence[str]
) -> tuple[Column, Any, Column, Column]:
    """What is expected of the runs, its slopes, the known variance, and the shape of the unknown one."""
    ideal, slopes = expected_of(data, values, [*{*names, *data.uncertain, "axle"}])
    J = np.stack([slopes[x] for x in names], 1) if names else np.empty((len(ideal), 0))
    known = data.spread**2 / data.times
    for x, u in data.uncertain.items():
        known = known + (slopes[x] * u) ** 2
    return ideal, J, known, slopes["axle"] ** 2 if data.spread.any() else 1 / data.times


def _moved(
    data: Data, values: dict[str, float], names: Sequence[str], A: Any, rest: Column, weight: Column
) -> dict[str, float]:
    """The values after a step, damped as much as it takes for the sum of squares not to grow."""
    lengths, before, damping = np.linalg.norm(A, axis=0), sum_of_squares(rest), 0.0
    zeros = np.zeros(len(names))
    for _ in range(MOST_TRIES):
        damped = np.vstack([A / lengths, np.diag(zeros + sqrt(damping))])
        step = np.linalg.lstsq(damped, np.append(rest, zeros), rcond=None)[0] / lengths
        there = values | {x: values[x] + float(by) for x, by in zip(names, step, strict=True)}
        cost = sum_of_squares((data.measured - expected_of(data, there, [])[0]) * weight)
        if cost <= before * (1 + 1e-12):
            return there
        damping = max(1e-4, 5 * damping)
    return values


def _start(data: Data, given: Mapping[str, float], names: Sequence[str]) -> dict[str, float]:
    """A start: of some guesses, that by which the measurements are closest to what is expected."""
    best, least = dict[str, float](), inf
    for guess in _guesses(data, given, names):
        there = dict(given) | guess
        cost = sum_of_squares((data.measured - expected_of(data, there, [])[0]) * np.sqrt(data.times))
        if not best or cost < least:
            best, least = guess, cost
    if names and least == inf:
        raise Alike
    return best


def _guesses(data: Data, given: Mapping[str, float], names: Sequence[str]) -> Iterator[dict[str, float]]:
    """The line g (h - l) - c a - f = a (l + h), which is straight in all three, also with c as it may be."""
    a = data.measured
    if data.drop is not None and data.kind == "time":
        a = physics.acceleration_of_fall(data.drop, data.measured)
    load = data.l + data.h
    columns = {"gravity": data.h - data.l, "rim_mass": -a, "axle": np.full_like(a, -1.0)}
    least = float(load.min())
    assumed: list[dict[str, float]] = [{}]
    if "rim_mass" in names:
        assumed += [{"rim_mass": (share - 1) * least} for share in STARTS]
    for some in assumed:
        known = dict(given) | some
        left = [x for x in names if x not in some]
        rest = a * load - sum(known[x] * column for x, column in columns.items() if x not in left)
        if not left:
            yield some
            continue
        A = np.stack([columns[x] for x in left], 1)
        yield some | dict(zip(left, map(float, np.linalg.lstsq(A, rest, rcond=None)[0]), strict=True))
        if data.kind == "time":  # with an axle that lets all move
            fast = 2 * known.get("axle", 0.0) / float((data.h - data.l).min())
            easy = {"gravity": max(9.8, fast), "rim_mass": 0.0, "axle": 0.0}
            yield some | {x: easy[x] for x in left}
