"""solve_arrays beside the same model in plain doubles: python -m tests.tools.bench_arrays [ROWS]

For each family of rows, the nanoseconds of processor time a row: the least of some runs, which take turns. Behind
these, the median of the ratios to plain doubles, run by run. Plain doubles run on whole arrays, and in tiles that fit
the cache. Where rows take long, they are fewer. Brackets have nanoseconds on the clock, as there are threads.
"""

import sys
import time
from collections.abc import Callable, Mapping
from statistics import median
from typing import Any, NamedTuple, TypeVar

import numpy as np

from atwood_cli import solve_arrays
from atwood_cli.solver.quantities import ACCURACIES, STANDARD
from atwood_cli.tradeoff.measure import in_numpy

Columns = dict[str, Any]
T = TypeVar("T")
ROUNDS, LONG = 5, 0.3  # seconds: rows that take as long are enough
TILE_ROWS = 8192
BOUNDS = {"quantities": ["friction_force_min", "friction_force_max"]}


def ordinary(rows: int) -> Columns:
    rng = np.random.default_rng(2026)
    m1 = 10 ** rng.uniform(-2, 2, rows)
    m2 = m1 * (1 + 10 ** rng.uniform(-2, 2, rows))
    return {"m1": m1, "m2": m2, "M": 10 ** rng.uniform(-2, 3, rows), "mu": 10 ** rng.uniform(-2, 0.3, rows)}


def near_critical(rows: int) -> Columns:
    """Within 1e-15 to 1e-3 of the critical pulley mass (70 %), or of m2 = m1 e^{μπ}, on both sides."""
    rng = np.random.default_rng(2026)
    m1, mu = 10 ** rng.uniform(-2, 2, rows), 10 ** rng.uniform(-2, 0, rows)
    k = np.exp(mu * np.pi)
    off = 1 + rng.choice([-1, 1], rows) * 10 ** rng.uniform(-15, -3, rows)
    m2 = m1 * k * (1 + 10 ** rng.uniform(-3, 1, rows))
    M = 4 * m1 * m2 * (k - 1) / (m2 - m1 * k) * off
    at_threshold = rng.random(rows) < 0.3
    m2 = np.where(at_threshold, m1 * k * off, m2)
    return {"m1": m1, "m2": m2, "M": np.where(at_threshold, 10 ** rng.uniform(0, 17, rows), M), "mu": mu}


def uniform(least: float, most: float, rows: int) -> Any:
    return np.random.default_rng(3).uniform(least, most, rows)


FAMILIES: dict[str, Callable[[int], Columns]] = {
    "ordinary": ordinary,
    "near-critical": near_critical,
    "beside an axle": lambda rows: ordinary(rows) | {"axle": 10 ** uniform(-2, 3, rows)},
    "a wrap each row": lambda rows: ordinary(rows) | {"wrap": uniform(1, 720, rows)},
    "M over 1e±300": lambda rows: ordinary(rows) | {"M": 10 ** uniform(-300, 300, rows)},
    "bounds of friction": lambda rows: ordinary(rows) | BOUNDS,
}


class Taken(NamedTuple):
    """Seconds of processor time, and on the clock."""

    processor: float
    clock: float


def taken_by(work: Callable[[], object]) -> Taken:
    """What a run takes, without the end of its results."""
    clock, processor = time.perf_counter(), time.process_time()
    kept = work()
    taken = Taken(time.process_time() - processor, time.perf_counter() - clock)
    del kept
    return taken


def in_turn(works: Mapping[str, Callable[[], T]], rounds: int) -> dict[str, list[T]]:
    """What each run gives in so many rounds A B C A B C ..., after one that does not count."""
    turns = [{name: work() for name, work in works.items()} for _ in range(rounds + 1)]
    return {name: [turn[name] for turn in turns[1:]] for name in works}


def in_tiles(*columns: Any) -> Columns:
    """Plain doubles, so many rows at a time that intermediate values stay in the cache."""
    results = {name: np.empty(len(columns[0])) for name in STANDARD}
    for start in range(0, len(columns[0]), TILE_ROWS):
        rows = slice(start, start + TILE_ROWS)
        for name, values in in_numpy(*(column[rows] for column in columns)).items():
            results[name][rows] = values
    return results


def compared(draw: Callable[[int], Columns], accuracy: Any, most: int) -> tuple[int, list[list[Taken]]]:
    """The rows that are enough, and what they take in plain doubles, in tiles, and with an accuracy."""
    given = draw(rows := 100)
    works: dict[str, Callable[[], Taken]] = {
        "plain": lambda: taken_by(lambda: in_numpy(*(given[x] for x in ("m1", "m2", "M", "mu")))),
        "in tiles": lambda: taken_by(lambda: in_tiles(*(given[x] for x in ("m1", "m2", "M", "mu")))),
        accuracy: lambda: taken_by(lambda: solve_arrays(**given, accuracy=accuracy)),
    }
    while rows < most and works[accuracy]().clock < LONG:
        given = draw(rows := min(10 * rows, most))
    return rows, [*in_turn(works, ROUNDS).values()]


def main(most: int) -> None:
    for family, draw in FAMILIES.items():
        for accuracy in ACCURACIES:
            rows, runs = compared(draw, accuracy, most)
            plain, tiles, ours = (1e9 * min(run.processor for run in times) / rows for times in runs)
            on_clock = 1e9 * min(run.clock for run in runs[2]) / rows
            ratio = median(b.processor / a.processor for a, b in zip(runs[0], runs[2], strict=True))
            print(
                f"{family:18} {accuracy:9} {rows:8} rows: {ours:9.1f} ns a row ({on_clock:.1f}),"
                f" plain {plain:5.1f}, in tiles {tiles:5.1f}: {ratio:.3f} of plain"
            )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 10_000_000)
