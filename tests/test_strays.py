"""Outliers, by hand."""

from math import sqrt

import numpy as np
import pytest

pytest.importorskip("scipy")

from scipy.special import stdtr

from atwood_cli.laboratory.statistics import judge_of_line, judge_of_repeats, outliers


def test_a_repeat_is_an_outlier_if_chance_makes_one_as_far_on_either_side_too_seldom() -> None:
    """The scatter of the others is at least that of their last digit."""
    values, u, run = np.array([1.0, 1.1, 0.9, 1.05, 2.0]), np.ones(5), np.zeros(5, dtype=np.intp)
    scatter = np.var(values[:4]) * 4 / 3 + 0.05**2 / 12
    judge = judge_of_repeats(values, u, run, 0.05)
    ((outlier, distance),) = outliers(judge, 5, 4, 5.0).items()
    assert outlier == 4
    assert distance == pytest.approx((2 - values[:4].mean()) / sqrt(scatter * 5 / 4))
    chance = 5 * 2 * float(stdtr(3, -distance))  # of any of five
    assert [len(outliers(judge, 5, 4, chance * by)) for by in (0.99, 1.01)] == [0, 1]


def test_a_run_is_judged_by_the_line_of_the_others() -> None:
    """Its distance is over the uncertainty of its own prediction: a t statistic of n - p - 1 = 3."""
    x, y = np.arange(6.0), np.array([0.1, 0.9, 2.1, 2.9, 9.0, 5.1])
    J, none = np.stack([np.ones(6), x], 1), np.zeros(6)
    ((outlier, distance),) = outliers(
        judge_of_line(J, y, none, none + 1, none + 1e-20, (0.0, 0)), 6, 4, 0.01
    ).items()
    others = x != 4
    fit, covariance = np.polyfit(x[others], y[others], 1, cov=True)
    rest = y[others] - np.polyval(fit, x[others])
    own = np.array([4, 1]) @ covariance @ np.array([4, 1]) + rest @ rest / 3
    assert outlier == 4
    assert distance == pytest.approx((y[4] - np.polyval(fit, 4)) / sqrt(own))
