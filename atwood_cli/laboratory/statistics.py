"""The statistics of a fit, as in textbooks: weighted least squares, a variance between runs, outliers.

R. C. Paule and J. Mandel, "Consensus values and weighting factors", J. Res. NBS 87 (1982) 377, find the
variance between runs; G. Knapp and J. Hartung, "Improved tests for a random effects meta-regression with a
single covariate", Stat. Med. 22 (2003) 2693, the scale of the covariance, and Student's t with n - p degrees
of freedom; B. Rosner, "Percentage points for a generalized ESD many-outlier procedure", Technometrics 25
(1983) 165, the number of outliers, though they hide each other.
"""

from collections.abc import Callable, Mapping
from math import inf, sqrt
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.special import stdtr

Column = NDArray[np.float64]
NORMAL = 1e8
"""Degrees of freedom with which Student's t is the normal distribution."""
ALIKE = 1e-7
"""Below this ratio of singular values the runs cannot separate the fitted quantities."""
ROUNDING = 1e-12
"""The least standard uncertainty of a measured number, as a share of it."""
TINY = 1e-300
MOST_STRAYS = 20
"""Outliers that are looked for; there is at most one for three degrees of freedom."""


class Alike(ArithmeticError):
    """The runs cannot separate the quantities to be fitted."""


class Line(NamedTuple):
    """A linear fit of n values: p coefficients, their covariance, and the variance of each value.

    Covariance and variances are still to be multiplied by ``scale``. ``between`` is the estimated part of the
    variance, and ``chi2`` is by the known part alone, None if there is none.
    """

    coefficients: Column
    covariance: Any
    variance: Column
    scale: float
    chi2: float | None
    between: float


def fit_line(J: Any, y: Column, known: Column, shape: Column, least: Column) -> Line:
    """The coefficients b by which J b (n, p) agrees best with y (n); raises Alike.

    The variance of y is ``known`` + v ``shape``. Paule and Mandel's v is that at which χ² is n - p, or 0 if
    χ² is no more than that without it. Knapp and Hartung's scale is χ²/(n - p). Without known variances the
    shape alone is scaled, which is ordinary least squares. No variance comes out below the ``least``.
    """
    dof, between, chi2, variance = len(y) - int(J.shape[1]), 0.0, None, shape
    if known.any():
        floor: Column = np.maximum(known, ROUNDING * known.max())  # no weight is without bound

        def excess(v: float) -> float:
            return _solved(J, y, floor + v * shape)[2] - dof

        chi2 = excess(0.0) + dof
        if dof and chi2 > dof:
            most = float((floor / shape).min())
            while excess(most) > 0:
                most *= 10
            between = float(brentq(excess, 0, most, xtol=1e-15 * most))
        variance = floor + between * shape
    coefficients, covariance, rest = _solved(J, y, variance)
    scale = max(rest / dof if dof else 1.0, float((least / variance).max()))
    return Line(coefficients, covariance, variance, scale, chi2, between)


def _solved(J: Any, y: Column, variance: Column) -> tuple[Column, Any, float]:
    """The weighted solution, its covariance, and χ²; raises Alike."""
    sigma = np.sqrt(variance)
    A, b = J / sigma[:, None], y / sigma
    lengths = np.linalg.norm(A, axis=0)
    if not (lengths > 0).all() or not np.isfinite(lengths).all():
        raise Alike
    U, singular, rows = np.linalg.svd(A / lengths, full_matrices=False)
    if len(singular) < J.shape[1] or (singular < ALIKE * singular.max(initial=0)).any():
        raise Alike
    half = rows.T / singular / lengths[:, None]
    solution = half @ (U.T @ b)
    return solution, half @ half.T, sum_of_squares(b - A @ solution)


def sum_of_squares(column: Any) -> float:
    return float(np.square(column).sum())


def stray_rows(
    J: Any, y: Column, known: Column, shape: Column, least: Column, within: float, level: float
) -> Mapping[int, float]:
    """The values far from what the others say, and the distances in standard uncertainties.

    Residuals and leverages show the furthest, without a fit for each; the line of the others judges it. The
    known variance has ``within`` degrees of freedom and is not scaled. The estimated one has those of the
    other values, their sum those of B. L. Welch and F. E. Satterthwaite.
    """

    def line_of(rows: Any) -> Line:
        return fit_line(J[rows], y[rows], known[rows], shape[rows], least[rows])

    def furthest(kept: NDArray[np.bool_]) -> tuple[int, float, float]:
        rows = np.flatnonzero(kept)
        line = line_of(rows)
        rest = y[rows] - J[rows] @ line.coefficients
        of_line = np.einsum("ij,jk,ik->i", J[rows], line.covariance, J[rows])  # leverage, times the variance
        i = int(rows[np.argmax(rest**2 / np.maximum(line.variance - of_line, 1e-9 * line.variance))])
        others = rows[rows != i]
        line = line_of(others)
        own, share, scale = float(shape[i]), 1.0, line.scale
        if line.chi2 is not None:
            own = float(known[i] + line.between * shape[i])
            share, scale = line.between * float(shape[i]) / own, 1.0
        variance = max(scale * (own + float(J[i] @ line.covariance @ J[i])), float(least[i]))
        inverse = share**2 / (len(others) - J.shape[1]) + (1 - share) ** 2 / within
        return i, float(y[i] - J[i] @ line.coefficients) / sqrt(variance), 1 / inverse if inverse else inf

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
        return i, float(np.sign(rest[i])) * sqrt(judged[i] / variance), dof

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
    for number in range(1, min(MOST_STRAYS, max(1, free // 3), free - 1) + 1):
        try:
            i, away, dof = furthest(kept)
        except Alike:
            break
        kept[i], found[i] = False, away
        if 2 * stdtr(min(dof, NORMAL), -abs(away)) < chance:
            strays = number
    return dict(list(found.items())[:strays])
