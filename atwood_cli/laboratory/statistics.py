"""The statistics of a fit, as in textbooks: weighted least squares, a variance between runs, outliers.

R. C. Paule and J. Mandel, "Consensus values and weighting factors", J. Res. NBS 87 (1982) 377, estimate the
variance between runs; H. D. Patterson and R. Thompson, "Recovery of inter-block information when block sizes
are unequal", Biometrika 58 (1971) 545, have the restricted likelihood; B. Rosner, "Percentage points for a
generalized ESD many-outlier procedure", Technometrics 25 (1983) 165, counts outliers that hide each other.
"""

from collections.abc import Callable, Sequence
from contextlib import suppress
from math import sqrt
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import brentq
from scipy.special import fdtrc, stdtr, stdtrit

from .runs import Column, Places, Selection

NORMAL_DOF = 1e8
"""Degrees of freedom of a variance that is known: Student's t is the normal distribution."""
SINGULAR_RATIO = 1e-7
"""Below this ratio of singular values a linear fit has no unique solution."""
MOST_OUTLIERS = 20
"""Outliers that are looked for; there is at most one for three degrees of freedom."""
LEAST_SHARE = 1e-4
"""The variance of a residual is at least this share of the variance of its value."""


class CannotSeparate(ArithmeticError):
    """The runs do not determine the quantities to be fitted."""


class Line(NamedTuple):
    """Weighted least squares of n values y: the ``coefficients`` b (p) for which J b is nearest to y.

    The variance of y is the ``known`` one, with its degrees of freedom ``known_dof``, and ``scale`` times an
    unknown one, ``between`` runs. ``sigma`` (n) is by their sum, ``covariance`` (p, p) that of b. The values
    have ``dof`` degrees of freedom, n - p, and Student's t of intervals ``t_dof``. ``chi2`` is by the known
    variance.
    """

    J: Any
    y: Column
    known: Column
    scale: Column
    known_dof: float
    coefficients: Column
    covariance: Any
    sigma: Column
    dof: int
    t_dof: float
    chi2: float
    between: float

    @property
    def p_value(self) -> float | None:
        """Return the probability that chance gives a larger χ² (an F test if the variance is an estimate)."""
        return float(fdtrc(self.dof, self.known_dof, self.chi2 / self.dof)) if self.dof else None

    @property
    def u(self) -> list[float]:
        """Return the standard uncertainties of the coefficients."""
        return [*map(float, np.sqrt(self.covariance.diagonal()))]

    @property
    def likelihood(self) -> float:
        """Return the logarithm of the restricted likelihood, but for a constant."""
        rest = (self.y - self.J @ self.coefficients) / self.sigma
        volume = float(np.linalg.slogdet(self.covariance)[1])
        return (volume - sum_of_squares(rest)) / 2 - float(np.log(self.sigma).sum())

    @property
    def times(self) -> float:
        """Return how many standard uncertainties half an interval of 95 % has."""
        return float(stdtrit(self.t_dof, 0.975))

    def part(self, kept: Selection) -> "Line":
        """Return the line of the values that are ``kept``. Raises CannotSeparate."""
        J, y, known, scale = (column[kept] for column in self[:4])
        return fit_line(J, y, known, scale, self.known_dof)


def fit_line(J: Any, y: Column, known: Column, scale: Column, known_dof: float = NORMAL_DOF) -> Line:
    """Return the weighted least squares. Raises CannotSeparate.

    A known variance is taken as it is. If χ² is more than n - p, Paule and Mandel's v makes it equal to that,
    and t has n - p degrees of freedom; else v is 0, and t has those of the known variance as well.
    """
    dof, between = len(y) - int(J.shape[1]), 0.0
    chi2 = _solved(J, y, known)[2]
    if dof and chi2 > dof:
        most = 1.001 * _solved(J, y, scale)[2] / dof  # χ² is less than n - p there
        between = brentq(lambda v: 1 - dof / _solved(J, y, known + v * scale)[2], 0, most, xtol=1e-15 * most)
    variance, t_dof = known + between * scale, dof + (0.0 if between else known_dof)
    b, covariance, _ = _solved(J, y, variance)
    return Line(J, y, known, scale, known_dof, b, covariance, np.sqrt(variance), dof, t_dof, chi2, between)


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


def outliers(judge: Judge, places: Sequence[int] | Places, free: int, level: float) -> dict[int, float]:
    """Return outliers by their places, with distances (in standard deviations) from the others (Rosner).

    The value that is farthest from the fit of those kept is left out, and judged by the fit of the others;
    this goes on, and all values are outliers up to the last that chance does not explain. ``free`` are the
    degrees of freedom with all values, and ``level`` the probability that a sound set has an outlier.
    """
    kept, left_out, distances = np.ones(len(places), dtype=bool), list[int](), dict[int, float]()
    with suppress(CannotSeparate):
        distance, _ = judge(kept)
        for _ in range(min(MOST_OUTLIERS, max(1, free // 3), free - 1)):
            # Two repeats are equally far from each other: of two that differ by rounding, the first counts.
            far = np.abs(distance) * kept
            i = int(np.argmax(far > (1 - 1e-6) * far.max()))
            kept[i] = False
            left_out.append(i)
            distance, dof = judge(kept)
            if stdtr(dof, -np.abs(distance))[i] < level / (2 * len(places)):  # of one value, on one side
                distances = {int(places[j]): float(distance[j]) for j in left_out}
    return distances


def distances_from(line: Line, kept: Selection) -> tuple[Column, Any]:
    """Judge the values of a line by a line of those ``kept``.

    The sum of a known and an estimated variance has the degrees of freedom of Welch and Satterthwaite, but
    few runs may agree by chance, and hide the scatter between runs: at most twice their own and 2.
    """
    J, y, known, scale = line[:4]
    others = line.part(kept)
    between = others.between * scale
    of_line = np.einsum("ij,jk,ik->i", J, others.covariance, J)
    own = known + between
    spread = np.maximum(own + np.where(kept, -1, 1) * of_line, LEAST_SHARE * own)
    share = between / own
    dof = 1 / (share**2 / others.dof + (1 - share) ** 2 / line.known_dof)
    return (y - J @ others.coefficients) / np.sqrt(spread), np.minimum(dof, 2 * others.dof + 2)


def judge_of_repeats(values: Column, u: Column, run: Places, step: float) -> Judge:
    """Judge values by the mean of those kept of the same ``run``; the last that is kept is not judged.

    The scatter is the same in all runs, times ``u``, and at least that of readings rounded to the ``step``.
    """

    def judge(kept: Selection) -> tuple[Column, Any]:
        weight = u**-2 * kept
        total = np.bincount(run, weight)
        others = total[run] - weight
        dof = int(kept.sum()) - int(np.count_nonzero(total))
        mean = np.bincount(run, weight * values) / total
        chi2 = sum_of_squares(((values - mean[run]) / u)[kept])
        spread = (chi2 / max(dof, 1) * u**2 + step**2 / 12) * (1 + u**-2 / others)
        away = (values - mean[run]) * (weight + others) / others
        return np.where((others > 0) & (spread > 0), away / np.sqrt(spread), 0), dof

    return judge


def spread_of_columns(y: Column, block: Places, column: Places, rounding: float) -> tuple[float, float]:
    """Return the p value of columns that differ as a whole within blocks, by an F test, and their range.

    The range is in standard deviations of the rest, whose variance is at least that of ``rounding``.
    """

    def within(x: Column) -> Column:
        return x - (np.bincount(block, x) / np.maximum(np.bincount(block), 1))[block]

    rest = within(y)
    X = np.stack([within((column == kind).astype(float)) for kind in np.unique(column)], 1)
    effects, _, rank, _ = np.linalg.lstsq(X.T @ X, X.T @ rest, rcond=None)
    left, dof = sum_of_squares(rest - X @ effects), len(y) - len({*block}) - int(rank)
    if dof < 1 or not rank:
        return 1.0, 0.0
    variance = max(left / dof, rounding)
    p_value = fdtrc(rank, dof, (sum_of_squares(rest) - left) / int(rank) / variance)
    return float(p_value), float(np.ptp(effects)) / sqrt(variance)
