"""Probabilities that a fit needs: of Student's t, Fisher's F and χ²."""

from functools import cache
from math import erfc, exp, inf, lgamma, log, log1p, sqrt

TINY = 1e-300
"""In place of 0 in a continued fraction (W. J. Lentz)."""
MOST_TERMS = 10_000
SURE = 0.95
"""The probability that an interval holds the true value."""


def beta_share(a: float, b: float, x: float) -> float:
    """I_x(a, b), the probability of the beta distribution below x."""
    if x <= 0 or x >= 1:
        return float(x >= 1)
    if x > (a + 1) / (a + b + 2):  # where its continued fraction is slow
        return 1 - beta_share(b, a, 1 - x)
    front = exp(lgamma(a + b) - lgamma(a) - lgamma(b) + a * log(x) + b * log1p(-x)) / a
    fraction, c, d = 1.0, 1.0, 0.0
    for term in range(MOST_TERMS):
        m = term // 2
        if term == 0:
            step = 1.0
        elif term % 2:
            step = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1))
        else:
            step = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m))
        d = 1 / (1 + step * d or TINY)
        c = 1 + step / c or TINY
        fraction *= c * d
        if abs(c * d - 1) < 1e-15:
            break
    return front * (fraction - 1)


def student_beyond(t: float, dof: float) -> float:
    """The probability that t is beyond this one, to either side; the normal one for dof = inf."""
    if dof == inf:
        return erfc(abs(t) / sqrt(2))
    return beta_share(dof / 2, 0.5, dof / (dof + t * t))


@cache
def student_within(share: float, dof: float) -> float:
    """The t for which that share of the distribution lies between -t and t."""
    low, high = 0.0, 1.0
    while student_beyond(high, dof) > 1 - share:
        low, high = high, 2 * high
    while high - low > 1e-12 * high:
        middle = (low + high) / 2
        low, high = (middle, high) if student_beyond(middle, dof) > 1 - share else (low, middle)
    return high


def chi2_beyond(chi2: float, dof: int) -> float:
    """The probability that χ² is beyond this one: a sum of dof/2 terms, each by its logarithm."""
    half, first = chi2 / 2, dof % 2 / 2
    if not half:
        return 1.0
    terms = (exp((first + j) * log(half) - half - lgamma(first + j + 1)) for j in range(dof // 2))
    return sum(terms, erfc(sqrt(half)) if first else 0.0)


def fisher_beyond(ratio: float, dof: int, dof_below: float) -> float:
    """The probability that a ratio of variances is beyond this one; dof_below may be inf."""
    if dof_below == inf:
        return chi2_beyond(ratio * dof, dof)
    return beta_share(dof_below / 2, dof / 2, dof_below / (dof_below + dof * ratio))
