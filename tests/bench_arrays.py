"""solve_arrays beside the paper's formulas in plain NumPy: python -m tests.bench_arrays [ROWS]

One run in turn: medians of the repeats, and the least processor time of a row. What counts are the ratios;
the cold first calls stand apart. Then the families of rows that are hard, in rows a second. Last, `solve`
scene by scene, in processor time: one quantity beside all of them.
"""

import statistics
import sys
import time
import tracemalloc
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from atwood_cli import solve, solve_arrays
from atwood_cli.model.quantities import ACCURACIES, NAMES
from atwood_cli.tradeoff.measure import in_numpy

REPEATS = 5
Columns = tuple[Any, Any, Any, Any]


def ordinary(rows: int, mu: Any = None) -> Columns:
    rng = np.random.default_rng(2026)
    m1 = 10 ** rng.uniform(-2, 2, rows)
    m2 = m1 * (1 + 10 ** rng.uniform(-2, 2, rows))
    return m1, m2, 10 ** rng.uniform(-2, 3, rows), 10 ** rng.uniform(-2, 0.3, rows) if mu is None else mu


def more_slip(rows: int) -> Columns:
    return ordinary(rows, np.random.default_rng(27).uniform(0, 1, rows))


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


def at_the_threshold(rows: int, least: float = -15.0, most: float = -3.0) -> Columns:
    """Within that power of ten of m2 = m1 e^{μπ}."""
    rng = np.random.default_rng(5)
    m1, mu = 10 ** rng.uniform(-2, 2, rows), rng.uniform(0.01, 2, rows)
    off = 1 + rng.choice([-1, 1], rows) * 10 ** rng.uniform(least, most, rows)
    return m1, m1 * np.exp(mu * np.pi) * off, 10 ** rng.uniform(-2, 3, rows), mu


def named(columns: Columns) -> dict[str, Any]:
    return dict(zip(("m1", "m2", "M", "mu"), columns, strict=True))


Column = Callable[[Any, int], Any]


def powers(least: float, most: float) -> Column:
    """Powers of ten."""
    return lambda rng, rows: 10.0 ** rng.uniform(least, most, rows)


def uniform(least: float, most: float) -> Column:
    return lambda rng, rows: rng.uniform(least, most, rows)


def whole(least: int, most: int) -> Column:
    return lambda rng, rows: rng.integers(least, most, rows).astype(float)


def one_of(*values: float) -> Column:
    return lambda rng, rows: rng.choice(values, rows)


def same(value: Any) -> Column:
    return lambda rng, rows: value


def ties(rows: int) -> dict[str, Any]:
    """A load of six and a drive of three of the lighter mass: a tension is 3 g/2, of 54 bits."""
    m1 = 2.0 ** np.random.default_rng(7).integers(-20, 20, rows)
    return {"m1": m1, "m2": 4 * m1, "M": 2 * m1}


class Family(NamedTuple):
    """A kind of rows that is hard: how accurate, what is asked for, and columns that ordinary rows have not."""

    accuracy: Any = "exact"
    quantities: str | None = None
    others: Mapping[str, Column] = MappingProxyType({})
    draw: Callable[[int], Any] = lambda rows: named(ordinary(rows))
    of: int = 50  # this part of all rows

    def rows(self, count: int) -> dict[str, Any]:
        rng = np.random.default_rng(3)
        given = self.draw(count) | {name: draw(rng, count) for name, draw in self.others.items()}
        return {name: column for name, column in given.items() if column is not None}

    @property
    def names(self) -> list[str] | None:
        return self.quantities.split() if self.quantities else None


VECTOR = "friction_force_x friction_force_y"
ANY = powers(-300, 300)
FAR = {"m1": ANY, "m2": ANY, "M": ANY}
SMALL = {"m1": whole(1, 20), "m2": whole(1, 20), "M": whole(0, 20), "mu": same(None)}
FAMILIES = {
    "near-critical": Family("certified", draw=lambda rows: named(near_critical(rows))),
    "m2 within 1e-15 to 1e-3 of m1 e^{μπ}": Family(
        "certified", draw=lambda rows: named(at_the_threshold(rows))
    ),
    "m2 within 1e-17 to 1e-12 of m1 e^{μπ}": Family(
        "certified", draw=lambda rows: named(at_the_threshold(rows, -17, -12))
    ),
    "masses and M over 1e±300": Family("certified", None, FAR, of=5_000),
    "beside an axle": Family("certified", None, {"axle": powers(-2, 3)}),
    "the same, I for M": Family(
        "certified", None, {"axle": powers(-2, 3), "M": same(None), "I": powers(-4, 1), "R": same(0.1)}
    ),
    "μφ above 700": Family("certified", None, {"mu": uniform(225, 400)}),
    "ordinary, exact": Family(),
    "exact, wraps of 90, 180 and 270": Family("exact", None, {"wrap": one_of(90.0, 180.0, 270.0)}),
    "certified, a wrap each row": Family("certified", None, {"wrap": uniform(1, 720)}),
    "exact, a wrap each row": Family("exact", None, {"wrap": uniform(1, 720)}, of=5_000),
    "exact, wraps of 90, 180 and 270, many quantities": Family(
        "exact",
        f"acceleration {VECTOR} axle_force torque rim_acceleration angular_acceleration critical_heavier_mass"
        " least_heavier_mass least_pulley_mass",
        {"wrap": one_of(90.0, 180.0, 270.0), "R": uniform(0.01, 1)},
    ),
    "exact, wrap a column of 180, friction_force_x, y, no mu": Family(
        "exact", VECTOR, {"mu": same(None), "wrap": uniform(180, 180)}
    ),
    "nearly equal masses, wrap 360, friction_force_x, y": Family(
        "exact",
        VECTOR,
        {"m1": same(1.0), "m2": lambda *a: 1 + powers(-15, -2)(*a), "mu": same(None), "wrap": same(360.0)},
    ),
    "friction_force_min and max": Family("exact", "friction_force_min friction_force_max", of=20_000),
    "exact rows of small integers": Family("exact", None, SMALL),
    "the same, g = 10": Family("exact", None, SMALL | {"g": same(10.0)}),
    "exact, every row a tie": Family("exact", draw=ties),
    "whole turns, weak friction, friction_force_x, y": Family(
        "exact", VECTOR, {"wrap": same(360.0), "mu": powers(-300, -50)}, of=20_000
    ),
    "wraps of 1e-300 to 1e-50, friction_force_x, y": Family(
        "exact", VECTOR, {"wrap": powers(-300, -50)}, of=20_000
    ),
}


LONG_WRAP = {
    "m1": 2.7370882119628515e136,
    "m2": 9.2198601112921,
    "M": 2.3265701665697617e-119,
    "wrap": 2.27e295,
}
"""Of a wrap that long, pi is needed to 300 digits."""


def copied(*columns: Any) -> Any:
    """The ceiling: inputs copied into as many outputs."""
    return [column.copy() for column in (*columns, *columns[:2])], np.zeros(len(columns[0]), np.int8)


class Taken(NamedTuple):
    wall: float
    processor: float


def taken_by(work: Callable[[], Any]) -> Taken:
    """The seconds that a run takes, without those for the end of its results."""
    wall, processor = time.perf_counter(), time.process_time()
    kept = work()
    taken = Taken(time.perf_counter() - wall, time.process_time() - processor)
    del kept
    return taken


def warm(given: dict[str, Any], accuracy: Any, quantities: Any, times: int) -> float:
    """The median of runs but for the first."""

    def work() -> object:
        return solve_arrays(**given, accuracy=accuracy, quantities=quantities)

    work()
    return statistics.median(taken_by(work).wall for _ in range(times))


def beside_the_paper(what: str, scenes: Columns) -> None:
    works: dict[str, Callable[[], Any]] = {
        "paper": lambda: in_numpy(dict(zip(("m1", "m2", "M", "mu"), scenes, strict=True))),
        "certified": lambda: solve_arrays(*scenes),
        "copy": lambda: copied(*scenes),
    }
    with np.errstate(all="ignore"):
        cold = {name: taken_by(work) for name, work in works.items()}
        times = [{name: taken_by(work) for name, work in works.items()} for _ in range(REPEATS)]
    rows = scenes[0].size
    print(f"{rows} {what} scenes, the seven standard quantities:")
    least = {name: min(one[name].processor for one in times) for name in works}
    for name in works:
        warm = statistics.median(one[name].wall for one in times)
        print(
            f"  {name:9}  {warm:6.3f} s, cold {cold[name].wall:6.3f} s; {least[name] / rows * 1e9:5.1f} ns of processor"
            f" time a row: {least['paper'] / least[name]:4.2f} x the paper's throughput"
        )


def one_by_one(count: int) -> None:
    """Scenes of floats, one quantity read of each, beside all of them with the notes."""
    columns = named(ordinary(count))
    rows = np.stack(list(columns.values()), axis=1).tolist()
    scenes = [dict(zip(columns, row, strict=True)) for row in rows]
    works = {
        "acceleration": lambda: [solve(**scene).acceleration for scene in scenes],
        "all quantities, and notes": lambda: [solve(**scene).notes for scene in scenes],
    }
    times = [{name: taken_by(work).processor for name, work in works.items()} for _ in range(REPEATS)]
    one, everything = (min(turn[name] for turn in times) for name in works)
    for name, taken in zip(works, (one, everything), strict=True):
        print(f"{count} scenes by solve, {name}: {taken / count * 1e3:.2f} ms each")
    print(f"  acceleration takes {one / everything:.3f} of the time of all quantities")


def main(rows: int) -> None:
    beside_the_paper("ordinary", ordinary(rows))
    beside_the_paper("ordinary (mu uniform in 0 to 1)", more_slip(rows))
    print("Rows a second, in families that are hard:")
    for name, family in FAMILIES.items():
        count = rows // family.of
        taken = warm(family.rows(count), family.accuracy, family.names, 3)
        print(f"  {name:56} {count / taken:12,.0f}")
    few = named(ordinary(100))
    for accuracy in ACCURACIES:
        print(f"100 rows, {accuracy}: {warm(few, accuracy, None, 99) * 1e3:.2f} ms")
    for what, names in (("the seven standard quantities", None), ("all quantities", NAMES[1:])):
        print(f"a wrap of 1e295 degrees, exact, {what}: {warm(LONG_WRAP, 'exact', names, 9) * 1e3:.0f} ms")
    one_by_one(10_000)
    tracemalloc.start()
    results = solve_arrays(*ordinary(rows // 5))
    _, peak = tracemalloc.get_traced_memory()
    kept = sum(column.nbytes for column in results.values()) + 6 * 8 * (rows // 5)
    print(
        f"temporaries of a certified run: at most {max(0, peak - kept) / 1e6:.0f} MB beyond inputs and outputs"
    )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 10_000_000)
