"""The statistics of a fit: a line by weighted least squares, a variance between runs, and outliers.

R. C. Paule and J. Mandel, "Consensus values and weighting factors", J. Res. NBS 87 (1982) 377, find the
variance between runs; G. Knapp and J. Hartung, "Improved tests for a random effects meta-regression with a
single covariate", Stat. Med. 22 (2003) 2693, the scale of the covariance and Student's t with n - p degrees
of freedom; B. Rosner, "Percentage points for a generalized ESD many-outlier procedure", Technometrics 25
(1983) 165, the number of outliers, though they hide each other.
"""

from collections.abc import Callable, Mapping
from math import inf, sqrt
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays.tables import Column
from .probability import student_beyond

MOST_STEPS = 100
ALIKE = 1e-7
"""Below this ratio of singular values the runs cannot separate the fitted quantities."""
TINY = 1e-300
MOST_STRAYS = 20
"""Outliers that are looked for; there is at most one for eight degrees of freedom."""


class Alike(ArithmeticError):
    """The runs cannot separate the quantities to be fitted."""


class LinearFit(NamedTuple):
    """A linear fit of n values: p coefficients, their covariance, and the variance of each value.

    Covariance and variances are still to be multiplied by the square of ``scale``. ``chi2`` is by the known
    variances alone, and ``between`` the variance estimated beside them; both are None if none is known.
    """

    step: Column
    covariance: Any
    variance: Column
    scale: float
    chi2: float | None
    between: float | None


def fit_line(J: Any, y: Column, known: Column, shape: Column) -> LinearFit:
    """The coefficients b by which J b (n, p) agrees best with y (n); raises Alike.

    The variance of y is ``known`` + v ``shape``. If any is known, v is Paule and Mandel's: the least at which
    χ² does not exceed what it is by chance. That is its median for n - p degrees of freedom (E. B. Wilson and
    M. M. Hilferty), not its mean, by which v is too small more often than not: intervals of 95 % then covered
    89 %. Knapp and Hartung's scale, max(1, χ²/(n - p)), is 1. If no variance is known, v is χ²/(n - p) of
    weights 1/``shape``, which is ordinary least squares.
    """
    dof = len(y) - J.shape[1]
    if not known.any():
        step, half, chi2 = _solved(J, y, shape)
        return LinearFit(step, half @ half.T, shape, sqrt(chi2 / dof) if dof else inf, None, None)
    known = np.maximum(known, 1e-12 * known.max())  # a weight without bound would be no weight for others
    usual = dof * (1 - 2 / (9 * dof)) ** 3 if dof else 0.0
    v, before, first, steps = 0.0, -1.0, None, 0
    while True:
        steps += 1
        variance = known + v * shape
        step, half, chi2 = _solved(J, y, variance)
        first = chi2 if first is None else first
        near = abs(chi2 - usual) < 1e-12 * usual or abs(v - before) <= 1e-15 * v or steps > MOST_STEPS
        if dof < 1 or near or (not v and chi2 <= usual):
            return LinearFit(step, half @ half.T, variance, 1.0, first, v)
        slope = sum_of_squares((y - J @ step) / variance * np.sqrt(shape))
        before, v = v, max(v + (chi2 - usual) * chi2 / (usual * slope), 0.0)  # Newton's step of 1/χ²


def sum_of_squares(column: Any) -> float:
    return float(np.square(column).sum())  # by NumPy alone, whose sums are the same on any number of cores


def _solved(J: Any, y: Column, variance: Column) -> tuple[Column, Any, float]:
    """The weighted solution, a root of its covariance, and χ²; raises Alike."""
    sigma = np.sqrt(variance)
    A, b = J / sigma[:, None], y / sigma
    lengths = np.linalg.norm(A, axis=0)
    if not (lengths > 0).all() or not np.isfinite(lengths).all():
        raise Alike
    U, singular, rows = np.linalg.svd(A / lengths, full_matrices=False)
    if len(singular) < J.shape[1] or (singular < ALIKE * singular.max(initial=0)).any():
        raise Alike
    half = rows.T / singular / lengths[:, None]
    step = half @ (U.T @ b)
    return step, half, sum_of_squares(b - A @ step)


def stray_rows(
    J: Any, y: Column, known: Column, shape: Column, within: float, level: float
) -> Mapping[int, float]:
    """The values far from what the others say, and the distances in standard uncertainties.

    Residuals and leverages show the furthest, without a fit for each; the line of the others judges it.
    The known variance has ``within`` degrees of freedom, 0 if the scatter of repeats is no part of it. The
    estimated one has those of the other values, their sum those of B. L. Welch and F. E. Satterthwaite.
    """

    def furthest(kept: NDArray[np.bool_]) -> tuple[int, float, float]:
        at = np.flatnonzero(kept)
        line = fit_line(J[at], y[at], known[at], shape[at])
        rest = y[at] - J[at] @ line.step
        of_line = np.einsum("ij,jk,ik->i", J[at], line.covariance, J[at])  # the leverage, times the variance
        i = int(at[np.argmax(rest**2 / np.maximum(line.variance - of_line, 1e-9 * line.variance))])
        others = at[at != i]
        line = fit_line(J[others], y[others], known[others], shape[others])
        own = shape[i] if line.between is None else known[i] + line.between * shape[i]
        sigma = line.scale * sqrt(own + float(J[i] @ line.covariance @ J[i]))
        away = float(y[i] - J[i] @ line.step)
        free = len(others) - J.shape[1]
        share = line.between * shape[i] / own if within and own and line.between is not None else 1.0
        inverse = share**2 / free + ((1 - share) ** 2 / within if within else 0)
        return i, away / sigma if sigma else inf * np.sign(away), 1 / inverse if inverse else inf

    return _strays(len(y), J.shape[1], level / max(len(y), 1), furthest)


def stray_repeats(values: Column, u: Column, run: NDArray[np.intp], level: float) -> Mapping[int, float]:
    """The values far from their siblings, those of the same run, and the distances in standard deviations.

    The scatter is the same in all runs, times ``u``, and that of the others judges a value: so it is robust.
    A value without siblings is not judged.
    """
    sibling, weight = np.bincount(run)[run] > 1, u**-2
    order = np.lexsort((values, run))
    gaps = np.diff(values[order])[np.diff(run[order]) == 0]
    finest = gaps[gaps > 0].min(initial=inf)  # of readings that were rounded

    def furthest(kept: NDArray[np.bool_]) -> tuple[int, float, int]:
        total = np.bincount(run, weight * kept)
        means = np.bincount(run, weight * kept * values) / np.maximum(total, TINY)
        share = weight / np.maximum(total[run], TINY)
        rest = (values - means[run]) / u * kept
        judged = np.where(kept & (share < 1 - 1e-9), rest**2 / np.maximum(1 - share, 1e-9), 0)
        i = int(np.argmax(judged))
        dof = int(kept.sum() - np.count_nonzero(total)) - 1
        variance = max(sum_of_squares(rest) - judged[i], 0.0) / max(dof, 1) + (finest / u[i]) ** 2 / 12
        away = np.sign(rest[i]) * sqrt(judged[i])
        return i, away / sqrt(variance) if variance else inf * away, dof

    if finest == inf:
        return {}
    return _strays(len(values), len(set(run.tolist())), level / int(sibling.sum()), furthest)


def _strays(
    count: int, taken: int, chance: float, furthest: Callable[[NDArray[np.bool_]], tuple[int, float, float]]
) -> Mapping[int, float]:
    """The outliers: all up to the last that chance does not explain (Rosner's generalized ESD).

    ``taken`` is the number of values that their fit takes up. ``furthest(kept)`` returns the index of the
    value furthest from the others kept, its distance in standard deviations, and their degrees of freedom.
    """
    kept, found, strays = np.ones(count, dtype=bool), dict[int, float](), 0
    free = count - taken
    for number in range(1, min(MOST_STRAYS, max(1, free // 8), free - 1) + 1):
        try:
            i, away, dof = furthest(kept)
        except Alike:
            break
        kept[i], found[i] = False, away
        if student_beyond(away, dof) < chance:
            strays = number
    return dict(list(found.items())[:strays])
