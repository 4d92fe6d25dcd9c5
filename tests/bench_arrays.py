"""solve_arrays beside the paper's formulas in plain NumPy: python -m tests.bench_arrays [ROWS]

One run in turn, medians of the repeats. What counts are the ratios; the cold first calls stand apart.
"""

import statistics
import sys
import time
import tracemalloc
from collections.abc import Callable
from typing import Any

import numpy as np

from atwood_cli import solve_arrays
from atwood_cli.tradeoff.baseline import paper_in_numpy

REPEATS = 5
Columns = tuple[Any, Any, Any, Any]


def ordinary(rows: int) -> Columns:
    rng = np.random.default_rng(2026)
    m1 = 10 ** rng.uniform(-2, 2, rows)
    m2 = m1 * (1 + 10 ** rng.uniform(-2, 2, rows))
    return m1, m2, 10 ** rng.uniform(-2, 3, rows), 10 ** rng.uniform(-2, 0.3, rows)


def near_critical(rows: int) -> Columns:
    """Within 1e-15 to 1e-3 of the critical pulley mass (70 %), or of m2 = m1 e^{μπ}, on both sides."""
    rng = np.random.default_rng(2026)
    m1, mu = 10 ** rng.uniform(-2, 2, rows), 10 ** rng.uniform(-2, 0, rows)
    k = np.exp(mu * np.pi)
    off = 1 + rng.choice([-1, 1], rows) * 10 ** rng.uniform(-15, -3, rows)
    m2 = m1 * k * (1 + 10 ** rng.uniform(-3, 1, rows))
    M = 4 * m1 * m2 * (k - 1) / (m2 - m1 * k) * off
    at_threshold = rng.random(rows) < 0.3
    m2, M = (
        np.where(at_threshold, m1 * k * off, m2),
        np.where(at_threshold, 10 ** rng.uniform(0, 17, rows), M),
    )
    return m1, m2, M, mu


def copied(*columns: Any) -> Any:
    """The ceiling: inputs copied into as many outputs."""
    return [column.copy() for column in (*columns, *columns[:2])], np.zeros(len(columns[0]), np.int8)


def seconds(work: Callable[[], Any]) -> float:
    start = time.perf_counter()
    kept = work()
    taken = time.perf_counter() - start
    del kept
    return taken


def main(rows: int) -> None:
    scenes = ordinary(rows)
    works: dict[str, Callable[[], Any]] = {
        "paper": lambda: paper_in_numpy(*scenes),
        "fast": lambda: solve_arrays(*scenes, accuracy="fast"),
        "certified": lambda: solve_arrays(*scenes),
        "copy": lambda: copied(*scenes),
    }
    with np.errstate(all="ignore"):
        cold = {name: seconds(work) for name, work in works.items()}
        times = [{name: seconds(work) for name, work in works.items()} for _ in range(REPEATS)]
    print(f"{rows} ordinary scenes, the seven standard quantities:")
    for name in works:
        warm = statistics.median(one[name] for one in times)
        ratio = statistics.median(one["paper"] / one[name] for one in times)
        print(f"  {name:9}  {warm:6.3f} s, {ratio:5.2f} x the paper's throughput, cold {cold[name]:6.3f} s")
    scenes = near_critical(rows // 10)
    taken = statistics.median(seconds(works["certified"]) for _ in range(REPEATS))
    print(f"{rows // 10} near-critical scenes, certified: {rows / 10 / taken / 1e6:.2f} million a second")
    tracemalloc.start()
    results = solve_arrays(*ordinary(rows // 5))
    _, peak = tracemalloc.get_traced_memory()
    kept = sum(column.nbytes for column in results.values()) + 6 * 8 * (rows // 5)
    print(
        f"temporaries of a certified run: at most {max(0, peak - kept) / 1e6:.0f} MB beyond inputs and outputs"
    )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 10_000_000)
