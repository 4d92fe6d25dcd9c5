"""The statistics of a fit, as in textbooks: weighted least squares, a variance between runs, outliers.

R. C. Paule and J. Mandel, "Consensus values and weighting factors", J. Res. NBS 87 (1982) 377, estimate the
variance between runs; G. Knapp and J. Hartung, "Improved tests for a random effects meta-regression with a
single covariate", Stat. Med. 22 (2003) 2693, scale the covariance and use Student's t with n - p degrees of
freedom; B. Rosner, "Percentage points for a generalized ESD many-outlier procedure", Technometrics 25 (1983)
165, counts outliers that hide each other.
"""

from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import brentq
from scipy.special import stdtr

from .runs import Column, Places, Selection

NORMAL_DOF = 1e8
"""Degrees of freedom of a variance that is known: Student's t is the normal distribution."""
SINGULAR_RATIO = 1e-7
"""Below this ratio of singular values a linear fit has no unique solution."""
MOST_OUTLIERS = 20
"""Outliers that are looked for; there is at most one for three degrees of freedom."""


class CannotSeparate(ArithmeticError):
    """The runs do not determine the quantities to be fitted."""


class Linear(NamedTuple):
    """A linear fit of n values: the coefficients b (p) for which J b is nearest to y, with J (n, p).

    The variance of y is ``known`` + v ``shape`` with an unknown v, and at least ``least``. ``repeats`` are
    χ² and the degrees of freedom of repeats about their means, by which a variance is known.
    """

    J: Any
    y: Column
    known: Column
    shape: Column
    least: float
    repeats: tuple[float, int] = (0.0, 0)


class Line(NamedTuple):
    """The result of a linear fit: p coefficients, their covariance, and the variance of each value.

    Covariance and variances are still to be multiplied by ``scale``, which is known with ``dof`` degrees of
    freedom. ``between`` is the factor v of the shape, and ``chi2`` is by the known variance alone.
    """

    coefficients: Column
    covariance: Any
    variance: Column
    scale: float
    dof: float
    chi2: float
    between: float


def fit_line(linear: Linear) -> Line:
    """Return the weighted least squares. Raises CannotSeparate.

    Paule and Mandel's v makes χ² equal to n - p; it is 0 if χ² is no more than that without it. Knapp and
    Hartung's scale is χ²/(n - p). If v is 0, χ² and degrees of freedom of the repeats are pooled with those
    of the line.
    """
    J, y, known, shape, least, (pooled_chi2, pooled_dof) = linear
    dof, between = len(y) - int(J.shape[1]), 0.0
    chi2 = _solved(J, y, known)[2]
    if dof and chi2 > dof:
        most = 1.001 * _solved(J, y, shape)[2] / dof  # χ² is less than n - p there
        between = brentq(lambda v: 1 - dof / _solved(J, y, known + v * shape)[2], 0, most, xtol=1e-15 * most)
        pooled_chi2, pooled_dof = 0.0, 0
    variance = known + between * shape
    coefficients, covariance, rest = _solved(J, y, variance)
    dof += pooled_dof
    scale = max((rest + pooled_chi2) / dof if dof else 1.0, least / float(variance.min()))
    return Line(coefficients, covariance, variance, scale, dof or NORMAL_DOF, chi2, between)


def _solved(J: Any, y: Column, variance: Column) -> tuple[Column, Any, float]:
    """Return the weighted solution, its covariance, and χ². Raises CannotSeparate."""
    sigma = np.sqrt(variance)
    A, b = J / sigma[:, None], y / sigma
    lengths = np.linalg.norm(A, axis=0)
    if not (lengths > 0).all() or not np.isfinite(lengths).all():
        raise CannotSeparate
    U, singular, rows = np.linalg.svd(A / lengths, full_matrices=False)
    if len(singular) < J.shape[1] or (singular < SINGULAR_RATIO * singular.max(initial=0)).any():
        raise CannotSeparate
    half = rows.T / singular / lengths[:, None]
    solution = half @ (U.T @ b)
    return solution, half @ half.T, sum_of_squares(b - A @ solution)


def sum_of_squares(column: Any) -> float:
    return float(np.square(column).sum())


Judge = Callable[[Selection], tuple[Column, Any]]
"""Return how many standard deviations each value is from a fit of those kept, and degrees of freedom."""


def outliers(judge: Judge, count: int, free: int, level: float) -> Mapping[int, float]:
    """Return outliers among ``count`` values, by distances (in standard deviations) from the others (Rosner).

    The value that is farthest from the fit of those kept is left out, and judged by the fit of the others;
    this goes on, and all values are outliers up to the last that chance does not explain. ``free`` are the
    degrees of freedom with all values, and ``level`` the probability that a sound set has an outlier.
    """
    kept, left_out, found = np.ones(count, dtype=bool), list[int](), dict[int, float]()
    with suppress(CannotSeparate):
        distance, _ = judge(kept)
        for _ in range(min(MOST_OUTLIERS, max(1, free // 3), free - 1)):
            # Two repeats are equally far from each other: float32 keeps their order.
            i = int(np.argmax((np.abs(distance) * kept).astype(np.float32)))
            kept[i] = False
            left_out.append(i)
            distance, dof = judge(kept)
            if stdtr(dof, -np.abs(distance))[i] < level / (2 * count):  # of one value, on one side
                found = {j: float(distance[j]) for j in left_out}
    return found


def judge_of_line(linear: Linear) -> Judge:
    """Judge values by the line of those kept.

    The sum of a known and an estimated variance has the degrees of freedom of Welch and Satterthwaite.
    """

    def judge(kept: Selection) -> tuple[Column, Any]:
        J, y, known, shape = (column[kept] for column in linear[:4])
        line = fit_line(Linear(J, y, known, shape, linear.least, linear.repeats))
        between = line.between * linear.shape
        of_line = np.einsum("ij,jk,ik->i", linear.J, line.covariance, linear.J)
        spread = line.scale * (linear.known + between + np.where(kept, -1, 1) * of_line)
        distance = (linear.y - linear.J @ line.coefficients) / np.sqrt(np.maximum(spread, linear.least))
        share = between / (linear.known + between)
        dof = 1 / (share**2 / line.dof + (1 - share) ** 2 / (linear.repeats[1] or NORMAL_DOF))
        return distance, dof if line.between else line.dof

    return judge


def judge_of_repeats(values: Column, u: Column, run: Places, step: float) -> Judge:
    """Judge values by the mean of those kept of the same ``run``; the last that is kept is not judged.

    The scatter is the same in all runs, times ``u``, and at least that of readings rounded to the ``step``.
    """

    def judge(kept: Selection) -> tuple[Column, Any]:
        weight = u**-2 * kept
        total = np.bincount(run, weight)
        others = total[run] - weight
        dof = int(kept.sum()) - int(np.count_nonzero(total))
        with np.errstate(divide="ignore", invalid="ignore"):
            mean = np.bincount(run, weight * values) / total
            chi2 = sum_of_squares(((values - mean[run]) / u)[kept])
            spread = (chi2 / max(dof, 1) * u**2 + step**2 / 12) * (1 + u**-2 / others)
            away = (values - mean[run]) * (weight + others) / others
            return np.where((others > 0) & (spread > 0), away / np.sqrt(spread), 0), dof

    return judge
