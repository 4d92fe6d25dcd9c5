"""Least squares: what of the pulley and its axle agrees best with runs, and how well it is known."""

from collections.abc import Mapping, Sequence
from math import inf, sqrt
from typing import Any, NamedTuple

import numpy as np

from ..model import physics
from .model import Column, expected
from .runs import Kind

CLOSE = 1e-10
"""Steps that change less than this share of what is measured go on as long as each is half the last."""
MOST_STEPS, MOST_HALVINGS = 200, 60
ALIKE = 1e-7
"""Below this ratio of singular values the runs do not tell what is fitted apart."""


class Alike(ArithmeticError):
    """The runs do not tell apart what is to be fitted."""


class Data(NamedTuple):
    """Runs as columns, light and heavy masses apart.

    ``measured`` are means of ``times`` values each. ``spread`` is the standard uncertainty of one such
    value, ``within`` their χ² about the means, and ``uncertain`` what else is uncertain in each run, by name.
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
    """Values by name, those ``found`` and those that were known, and the covariance of the former.

    That is for the weights as given, not yet scaled. ``sigma`` is the uncertainty of each run's measurement,
    with that of its masses and height; ``leverage`` its share in its own fit; ``by_known`` what a change in
    something known changes in what is found.
    """

    values: Mapping[str, float]
    found: Sequence[str]
    covariance: Any
    expected: Column
    sigma: Column
    leverage: Column
    chi2: float
    by_known: Mapping[str, Any]

    def uncertainty(self, name: str) -> float:
        """The standard uncertainty of what was found, by the weights as given."""
        i = self.found.index(name)
        return sqrt(self.covariance[i, i])

    def correlation(self, one: str, other: str) -> float:
        i, j = self.found.index(one), self.found.index(other)
        return float(self.covariance[i, j] / (self.uncertainty(one) * self.uncertainty(other)))


def estimate(data: Data, known: Mapping[str, float], found: Sequence[str]) -> Estimate:
    """The values of what is to be found that agree best with the runs; raises Alike.

    Gauss's steps, halved where they lead away; weights follow the values (effective variance).
    """
    values = dict(known) | _start(data, known, found)
    before = inf
    for _ in range(MOST_STEPS):
        ideal, slopes, sigma = _state(data, values)
        left = (data.measured - ideal) / sigma
        step = _step(slopes, sigma, found, left)
        moved = sqrt(sum_of_squares(sum(slopes[x] * by for x, by in zip(found, step, strict=True)) / sigma))
        share = moved / sqrt(sum_of_squares(data.measured / sigma))
        if share < CLOSE and share >= before / 2:  # nothing but rounding is left
            break
        before = share
        values = _walked(data, values, dict(zip(found, step, strict=True)), sigma, left)
    ideal, slopes, sigma = _state(data, values)
    J = np.stack([slopes[x] for x in found], 1) / sigma[:, None] if found else np.empty((len(sigma), 0))
    covariance = _inverse(J)
    by_known = {x: -covariance @ J.T @ (slope / sigma) for x, slope in slopes.items() if x not in found}
    return Estimate(
        values,
        found,
        covariance,
        ideal,
        sigma,
        np.einsum("ij,jk,ik->i", J, covariance, J),
        data.within + sum_of_squares((data.measured - ideal) / sigma),
        by_known,
    )


def sum_of_squares(column: Any) -> float:
    return float(column @ column)


def _state(data: Data, values: Mapping[str, float]) -> tuple[Column, dict[str, Column], Column]:
    """What is expected of the runs, its slopes, and the uncertainty of the measurement beside it."""
    given: dict[str, Any] = {"l": data.l, "h": data.h, "drop": data.drop, **values}
    shared = ["drop"] if data.kind == "time" else []
    ideal, slopes = expected(data.kind, given, ["rim_mass", "axle", "gravity", *data.uncertain, *shared])
    variance = data.spread**2 / data.times
    for x, u in data.uncertain.items():
        variance = variance + (slopes[x] * u) ** 2
    return ideal, slopes, np.sqrt(variance)


def _step(slopes: Mapping[str, Column], sigma: Column, found: Sequence[str], left: Column) -> Any:
    if not found:
        return np.empty(0)
    directions, lengths = _directions(np.stack([slopes[x] for x in found], 1) / sigma[:, None])
    return np.linalg.lstsq(directions, left, rcond=None)[0] / lengths


def _directions(J: Any) -> tuple[Any, Column]:
    """The columns at length 1, and their lengths; raises Alike where one says nothing, or too much."""
    lengths = np.linalg.norm(J, axis=0)
    if not (lengths > 0).all() or not np.isfinite(lengths).all():
        raise Alike
    return J / lengths, lengths


def _inverse(J: Any) -> Any:
    """(JᵀJ)⁻¹; raises Alike where a combination of columns says nothing."""
    if not J.shape[1]:
        return np.empty((0, 0))
    directions, lengths = _directions(J)
    _, singular, rows = np.linalg.svd(directions, full_matrices=False)
    if len(singular) < J.shape[1] or singular[-1] < ALIKE * singular[0]:
        raise Alike
    half = rows.T / singular / lengths[:, None]
    return half @ half.T


def _walked(
    data: Data, values: dict[str, float], step: Mapping[str, float], sigma: Column, left: Column
) -> dict[str, float]:
    """The values a step on, or part of it, so that the sum of squares does not grow."""
    before, share = sum_of_squares(left), 1.0
    for _ in range(MOST_HALVINGS):
        there = {name: value + share * step.get(name, 0.0) for name, value in values.items()}
        cost = sum_of_squares((data.measured - _state(data, there)[0]) / sigma)
        if cost <= before * (1 + 1e-12) and cost < inf:
            return there
        share /= 2
    return values


def _start(data: Data, known: Mapping[str, float], found: Sequence[str]) -> dict[str, float]:
    """A start: the line g (h - l) - c a - f = a (l + h), which is straight in all three."""
    a = data.measured
    if data.drop is not None and data.kind == "time":
        a = physics.acceleration_of_fall(data.drop, data.measured)
    columns = {"gravity": data.h - data.l, "rim_mass": -a, "axle": np.full_like(a, -1.0)}
    rest = a * (data.l + data.h) - sum(known[x] * column for x, column in columns.items() if x in known)
    if not found:
        return {}
    A = np.stack([columns[x] for x in found], 1)
    values = dict(zip(found, map(float, np.linalg.lstsq(A, rest, rcond=None)[0]), strict=True))
    if np.isfinite(_state(data, dict(known) | values)[0]).all():
        return values
    fast = 2 * known.get("axle", 0.0) / float((data.h - data.l).min())  # enough for all to move
    easy = {"gravity": max(9.8, fast), "rim_mass": 0.0, "axle": 0.0}
    return {x: easy[x] for x in found}
