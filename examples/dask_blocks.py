"""Scenes in dask: blocks of arrays, which dask spreads over cores, or over machines.

Here, how often the string slips if mu and M scatter: what no one array on one machine need hold.
"""

import dask.array as da
import numpy as np

from atwood_cli import REGIMES, solve_arrays


def regime(M: np.ndarray, mu: np.ndarray) -> np.ndarray:
    """The code of the regime, block by block; -1 where a row is no scene.

    What is masked is not given, as M below where it is beyond the scales. A NaN is an error of its row.
    """
    return solve_arrays(1.0, 3.0, M, mu, quantities=["regime"])["regime"]


def share_of_slip(M: da.Array, mu: da.Array) -> float:
    """In which share of the scenes with a known pulley the string slips."""
    codes = da.map_blocks(regime, M, mu, dtype="int8")
    slips, holds = ((codes == REGIMES.index(name)).sum() for name in ("slip", "no-slip"))
    return (slips / (slips + holds)).compute(scheduler="threads")


random = da.random.default_rng(2026)
M = da.ma.masked_greater(43 + random.normal(size=1_000_000, chunks=250_000), 45)
mu = 0.3 + random.normal(size=1_000_000, chunks=250_000) / 100
share = share_of_slip(M, mu)
print(f"slips in {share:.0%} of the scenes")
