"""Scenes in dask: blocks of arrays, which dask spreads over cores, or over machines.

Here, how often the string slips if mu and M scatter: what no one array on one machine need hold.
"""

import dask.array as da
import numpy as np

from atwood_cli import REGIMES, solve_arrays


def regime(M: np.ndarray, mu: np.ndarray) -> np.ndarray:
    """The code of the regime, block by block."""
    return solve_arrays(1.0, 3.0, M, mu, quantities=["regime"])["regime"]


random = da.random.default_rng(2026)
M = 43 + random.normal(size=1_000_000, chunks=250_000)
mu = 0.3 + random.normal(size=1_000_000, chunks=250_000) / 100
codes = da.map_blocks(regime, M, mu, dtype="int8")
share = (codes == REGIMES.index("slip")).mean().compute(scheduler="threads")
print(f"slips in {share:.0%} of the scenes")
