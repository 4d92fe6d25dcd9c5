"""What is odd about runs, and how uncertain they are, by hand."""

from math import sqrt

import numpy as np
import pytest

pytest.importorskip("scipy")

from scipy.special import stdtr

from atwood_cli.laboratory.fitting import accelerations, as_data, uncertain_accelerations
from atwood_cli.laboratory.runs import read_runs
from atwood_cli.laboratory.statistics import stray_repeats
from atwood_cli.model.scene import read_input


def test_a_repeat_is_odd_if_chance_makes_one_as_far_on_either_side_too_seldom() -> None:
    """The scatter of its siblings is at least that of their last digit."""
    values, u, run = np.array([1.0, 1.1, 0.9, 1.05, 2.0]), np.ones(5), np.zeros(5, dtype=np.intp)
    scatter = np.var(values[:4]) * 4 / 3 + 0.05**2 / 12
    ((odd, away),) = stray_repeats(values, u, run, 5.0).items()
    assert odd == 4
    assert away == pytest.approx((2 - values[:4].mean()) * sqrt(4 / 5 / scatter))
    chance = 5 * 2 * float(stdtr(3, -away))  # of any of five
    assert [len(stray_repeats(values, u, run, chance * by)) for by in (0.99, 1.01)] == [0, 1]


def test_the_uncertainty_of_a_time_is_that_of_an_acceleration() -> None:
    runs = read_runs({"m1": [1, 2], "m2": [2, 5], "t": ["1.1", "0.7"]}, drop=read_input("drop", "1"))
    data, u = as_data(runs, runs.runs), 1e-6
    slow, fast = (accelerations(data, data.measured + by) for by in (u, -u))
    found = uncertain_accelerations(data, np.full(2, u))
    assert found.tolist() == pytest.approx(((fast - slow) / 2).tolist(), rel=1e-5)
