"""Long tables, beside the same model in plain doubles: python -m tests.tools.bench [ROWS]

For each family of rows, the nanoseconds of processor time a row, the least of some runs, and the median of its ratios
to plain doubles, run by run, as the runs take turns. Then `atwood batch` on files of so many ordinary rows: rows a
second of processor time, and the largest memory. `atwood tradeoff` measures shorter tables, also very near to slipping.
"""

import subprocess
import sys
from collections.abc import Callable
from statistics import median
from tempfile import TemporaryDirectory
from time import process_time
from typing import Any

import numpy as np
import polars as pl

from atwood_cli import solve_arrays
from atwood_cli.solver.quantities import ACCURACIES
from atwood_cli.tradeoff.measure import in_numpy

Columns = dict[str, Any]
ROUNDS = 5


def uniform(least: float, most: float, rows: int) -> Any:
    return np.random.default_rng(3).uniform(least, most, rows)


def ordinary(rows: int) -> Columns:
    rng = np.random.default_rng(2026)
    m1 = 10 ** rng.uniform(-2, 2, rows)
    m2 = m1 * (1 + 10 ** rng.uniform(-2, 2, rows))
    return {"m1": m1, "m2": m2, "M": 10 ** rng.uniform(-2, 3, rows), "mu": 10 ** rng.uniform(-2, 0.3, rows)}


FAMILIES: dict[str, tuple[int, Callable[[int], Columns]]] = {
    "ordinary": (1, lambda rows: {}),
    "beside an axle": (1, lambda rows: {"axle": 10 ** uniform(-2, 3, rows)}),
    "a wrap each row": (10, lambda rows: {"wrap": uniform(1, 720, rows)}),
    "M over 1e±300": (100, lambda rows: {"M": 10 ** uniform(-300, 300, rows)}),
    "bounds of friction": (5000, lambda rows: {"quantities": ["friction_force_min", "friction_force_max"]}),
}
"""By how many times fewer the rows are, as they take long, and what they have that is not ordinary."""


def taken_by(solve: Callable[..., object], columns: Columns) -> float:
    """Seconds of processor time, without the end of the results."""
    begun = process_time()
    kept = solve(**columns)
    taken = process_time() - begun
    del kept
    return taken


def batch(kind: str, rows: int) -> str:
    """What whole processes took that solve a file, and the peak memory of any."""
    from os import wait4

    with TemporaryDirectory() as folder:
        getattr(pl.DataFrame(ordinary(rows)), f"write_{kind}")(f"{folder}/in.{kind}")
        words = ["batch", f"{folder}/in.{kind}", "-o", f"{folder}/out.{kind}", "--force"]
        runs = []
        for _ in range(ROUNDS):
            child = subprocess.Popen([sys.executable, "-m", "atwood_cli", *words], stderr=subprocess.DEVNULL)
            _, status, usage = wait4(child.pid, 0)
            assert status == 0, words
            runs.append((usage.ru_utime + usage.ru_stime, usage.ru_maxrss // 1024))
    seconds, memory = min(runs)[0], max(memory for _, memory in runs)
    return f"{kind:8} {seconds:6.2f} s, {rows / seconds:10,.0f} rows a second, {memory} MB"


def main(most: int) -> None:
    for family, (fewer, more) in FAMILIES.items():
        rows = most // fewer
        plain = ordinary(rows)
        for accuracy in ACCURACIES:
            ours = plain | more(rows) | {"accuracy": accuracy}
            runs = [(taken_by(in_numpy, plain), taken_by(solve_arrays, ours)) for _ in range(ROUNDS + 1)][1:]
            least, ratio = min(taken for _, taken in runs), median(taken / plainly for plainly, taken in runs)
            print(
                f"{family:18} {accuracy:9} {rows:8} rows: {least * 1e9 / rows:9.1f} ns a row, {ratio:.3f} of plain"
            )
    print(*(batch(kind, most) for kind in ("csv", "parquet")), sep="\n")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000)
