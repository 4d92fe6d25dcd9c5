"""A folder of Parquet files, solved by dask on a cluster: each task is one solve_table, on one file.

Here the cluster is two processes on this machine; on many machines, another of dask's takes its place. It
needs `pip install distributed`, beside the extra `batch`.
"""

from collections.abc import Iterable
from pathlib import Path
from tempfile import TemporaryDirectory

import polars as pl
from distributed import Client, Future, LocalCluster

from atwood_cli import solve_table


def solved(file: Path) -> pl.DataFrame:
    """Return the scenes of a file with their results."""
    return solve_table(pl.read_parquet(file), ["regime", "acceleration"])


def tasks(client: Client, files: Iterable[Path]) -> list[Future]:
    """Start a task for each file. If a worker is lost, dask has another one do its tasks again."""
    return client.map(solved, sorted(files))


def write_scenes(folder: str, files: int, rows: int) -> None:
    """Write scenes with pulleys from 0 to 100 kg; mu is 0.3, or not given in every tenth scene."""
    for i in range(files):
        M = [100 * (i * rows + row) / (files * rows) for row in range(rows)]
        mu = [None if row % 10 == 0 else 0.3 for row in range(rows)]
        pl.DataFrame({"m1": 1.0, "m2": 3.0, "M": M, "mu": mu}).write_parquet(Path(folder, f"{i}.parquet"))


if __name__ == "__main__":
    cluster = LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None)
    with TemporaryDirectory() as folder, cluster, Client(cluster) as client:
        write_scenes(folder, files=8, rows=10_000)
        scenes = pl.concat(client.gather(tasks(client, Path(folder).iterdir())))
        print(scenes.group_by("regime").len().sort("regime").write_csv(), end="")
