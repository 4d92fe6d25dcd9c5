"""A folder of Parquet files, solved by dask on a cluster: solve_table is a function of one data frame.

Here the cluster is two processes on this machine; on many machines, another of dask's takes its place.
"""

from pathlib import Path
from tempfile import TemporaryDirectory

import dask.dataframe as dd
import pandas as pd
from distributed import Client, LocalCluster

from atwood_cli import solve_table


def solved(folder: str) -> dd.DataFrame:
    """The scenes with their results; with Arrow's types, a value that is missing is not taken for a NaN."""
    scenes = dd.read_parquet(folder, dtype_backend="pyarrow")
    return scenes.map_partitions(solve_table, ["regime", "acceleration"])


def write_scenes(folder: str, files: int, rows: int) -> None:
    """Pulleys from 0 to 100 kg with friction; every tenth scene has none."""
    for i in range(files):
        M = [100 * (i * rows + row) / (files * rows) for row in range(rows)]
        mu = [None if row % 10 == 0 else 0.3 for row in range(rows)]
        scenes = pd.DataFrame({"m1": 1.0, "m2": 3.0, "M": M, "mu": mu})
        scenes.to_parquet(Path(folder, f"{i}.parquet"))


if __name__ == "__main__":
    cluster = LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None)
    with TemporaryDirectory() as folder, cluster, Client(cluster):
        write_scenes(folder, files=8, rows=10_000)
        print(solved(folder).groupby("regime").size().compute().sort_index().to_string())
