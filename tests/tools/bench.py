"""Long tables, beside the same model in plain doubles: python -m tests.tools.bench [ROWS]

For each family of rows, the nanoseconds of processor time a row: the least of some runs, which take turns. Behind
these, the median of the ratios to plain doubles, run by run. Plain doubles run on whole arrays, and in tiles that fit
the cache. Where rows take long, they are fewer. Brackets have nanoseconds on the clock, as there are threads. Then
`atwood batch` on files of so many ordinary rows: rows a second of processor time, and the largest memory.
`atwood tradeoff` measures shorter tables, also very near to slipping.
"""

import subprocess
import sys
from collections.abc import Callable
from functools import partial
from statistics import median
from tempfile import TemporaryDirectory
from time import perf_counter, process_time
from typing import Any

import numpy as np
import polars as pl

from atwood_cli import solve_arrays
from atwood_cli.solver.quantities import ACCURACIES, STANDARD
from atwood_cli.tradeoff.measure import in_numpy

Columns = dict[str, Any]
ROUNDS, LONG = 5, 0.3  # seconds: rows that take as long are enough
TILE_ROWS = 8192


def uniform(least: float, most: float, rows: int) -> Any:
    return np.random.default_rng(3).uniform(least, most, rows)


def ordinary(rows: int) -> Columns:
    rng = np.random.default_rng(2026)
    m1 = 10 ** rng.uniform(-2, 2, rows)
    m2 = m1 * (1 + 10 ** rng.uniform(-2, 2, rows))
    return {"m1": m1, "m2": m2, "M": 10 ** rng.uniform(-2, 3, rows), "mu": 10 ** rng.uniform(-2, 0.3, rows)}


FAMILIES: dict[str, Callable[[int], Columns]] = {
    "ordinary": lambda rows: {},
    "beside an axle": lambda rows: {"axle": 10 ** uniform(-2, 3, rows)},
    "a wrap each row": lambda rows: {"wrap": uniform(1, 720, rows)},
    "M over 1e±300": lambda rows: {"M": 10 ** uniform(-300, 300, rows)},
    "bounds of friction": lambda rows: {"quantities": ["friction_force_min", "friction_force_max"]},
}
"""What rows have that are not ordinary."""


def taken_by(work: Callable[[], object]) -> tuple[float, float]:
    """Seconds of processor time, and on the clock, without the end of its results."""
    clock, processor = perf_counter(), process_time()
    kept = work()
    taken = process_time() - processor, perf_counter() - clock
    del kept
    return taken


def in_tiles(**columns: Any) -> Columns:
    """Plain doubles, so many rows at a time that intermediate values stay in the cache."""
    results = {name: np.empty(len(columns["m1"])) for name in STANDARD}
    for start in range(0, len(columns["m1"]), TILE_ROWS):
        rows = slice(start, start + TILE_ROWS)
        for name, values in in_numpy(**{x: column[rows] for x, column in columns.items()}).items():
            results[name][rows] = values
    return results


def compared(more: Callable[[int], Columns], accuracy: Any, most: int) -> tuple[int, Any]:
    """The rows that are enough, and by run what they take in plain doubles, in tiles, and with an accuracy."""
    rows = 10
    while True:
        rows = min(10 * rows, most)
        plain = ordinary(rows)
        ours = partial(solve_arrays, **plain | more(rows), accuracy=accuracy)
        if rows == most or taken_by(ours)[1] >= LONG:
            works = (partial(in_numpy, **plain), partial(in_tiles, **plain), ours)
            return rows, np.array([[taken_by(work) for work in works] for _ in range(ROUNDS + 1)][1:])


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
    for family, more in FAMILIES.items():
        for accuracy in ACCURACIES:
            rows, runs = compared(more, accuracy, most)
            (plain, tiles, ours), (*_, on_clock) = (runs.min(0) * 1e9 / rows).T
            ratio = median(runs[:, 2, 0] / runs[:, 0, 0])
            print(
                f"{family:18} {accuracy:9} {rows:8} rows: {ours:9.1f} ns a row ({on_clock:.1f}),"
                f" plain {plain:5.1f}, in tiles {tiles:5.1f}: {ratio:.3f} of plain"
            )
    print(*(batch(kind, most) for kind in ("csv", "parquet")), sep="\n")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000)
