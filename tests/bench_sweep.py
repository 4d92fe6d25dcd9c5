"""Rows of `atwood sweep` beside the same rows by `solve`, one by one: python -m tests.bench_sweep [PAIRS] [ROWS]

Both in one process, in turn, in processor time; what counts is the median of the ratios, pair by pair.
"""

import statistics
import sys
import time
from collections.abc import Callable

from atwood_cli import solve
from atwood_cli.model.quantities import STANDARD
from atwood_cli.solver.sweep import point_text, read_sweep, solve_rows

PAPER = {"m1": "1", "m2": "3", "M": "20", "mu": "0.3"}
RANGES = {"M": "0:50", "mu": "0:0.6", "m1": "0.5:2.5", "g": "1:25"}


def by_sweep(given: dict[str, str]) -> list[list[object]]:
    return [list(row.values.values()) for row in solve_rows(read_sweep(given), STANDARD, None)]


def by_solve(given: dict[str, str]) -> list[list[object]]:
    (range_,) = read_sweep(given).ranges
    scenes = [solve(**given | {range_.name: point_text(point)}) for point in range_.points]
    return [[getattr(scene, name) for name in STANDARD] for scene in scenes]


def seconds(rows: Callable[[dict[str, str]], list[list[object]]], given: dict[str, str]) -> float:
    start = time.process_time()
    rows(given)
    return time.process_time() - start


def main(pairs: int, rows: int) -> None:
    for name, ends in RANGES.items():
        given = PAPER | {name: f"{ends}:{rows}"}
        assert by_sweep(given) == by_solve(given)
        times = [(seconds(by_sweep, given), seconds(by_solve, given)) for _ in range(pairs)]
        swept, solved = (statistics.median(t[i] for t in times) / rows * 1e6 for i in (0, 1))
        ratio = statistics.median(a / b for a, b in times)
        print(f"{name} = {ends}: sweep {swept:.0f} µs a row, solve {solved:.0f} µs, ratio {ratio:.2f}")


if __name__ == "__main__":
    main(*(int(word) for word in [*sys.argv[1:], *["7", "2000"][len(sys.argv) - 1 :]]))
