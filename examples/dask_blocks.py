"""Scenes in dask: blocks of arrays, which dask spreads over cores, or over machines.

Here, how often the string slips if mu and M scatter: what no one array on one machine need hold.
"""

import dask.array as da
import numpy as np

from atwood_cli import REGIMES, solve_arrays


def regime(M: np.ndarray, mu: np.ndarray) -> np.ndarray:
    """The code of the regime, block by block; -1 where a row is no scene."""
    return solve_arrays(1.0, 3.0, M, mu, quantities=["regime"])["regime"]


def share_of_slip(M: da.Array, mu: da.Array) -> float:
    """In which share of those that are scenes the string slips."""
    codes = da.map_blocks(regime, M, mu, dtype="int8")
    slips, scenes = (codes == REGIMES.index("slip")).sum(), (codes >= 0).sum()
    return (slips / scenes).compute(scheduler="threads")


random = da.random.default_rng(2026)
M = 43 + random.normal(size=1_000_000, chunks=250_000)
mu = 0.3 + random.normal(size=1_000_000, chunks=250_000) / 100
share = share_of_slip(M, mu)
print(f"slips in {share:.0%} of the scenes")
