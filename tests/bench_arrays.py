"""solve_arrays beside the paper's formulas in plain NumPy: python -m tests.bench_arrays [ROWS]

One run in turn, medians of the repeats. What counts are the ratios; the cold first calls stand apart. Then
the families of rows that are hard, in rows a second.
"""

import statistics
import sys
import time
import tracemalloc
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from atwood_cli import solve_arrays
from atwood_cli.model.quantities import NAMES
from atwood_cli.tradeoff.baseline import paper_in_numpy

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


class Family(NamedTuple):
    """A kind of rows that is hard: how they are drawn, what is asked for, how accurately."""

    draw: Callable[[int], dict[str, Any]]
    accuracy: Any = "exact"
    quantities: tuple[str, ...] | None = None
    of: int = 50  # this part of all rows


def _named(columns: Columns) -> dict[str, Any]:
    return dict(zip(("m1", "m2", "M", "mu"), columns, strict=True))


def _with(**more: Callable[[Any, int], Any]) -> Callable[[int], dict[str, Any]]:
    """Ordinary rows with other columns beside, or without some."""

    def draw(rows: int) -> dict[str, Any]:
        rng = np.random.default_rng(3)
        given = _named(ordinary(rows)) | {name: of(rng, rows) for name, of in more.items()}
        return {name: column for name, column in given.items() if column is not None}

    return draw


def _anything(rng: Any, rows: int) -> Any:
    return 10.0 ** rng.uniform(-300, 300, rows)


def _tiny(rng: Any, rows: int) -> Any:
    return 10.0 ** rng.uniform(-300, -50, rows)


def _whole(least: int, most: int) -> Callable[[Any, int], Any]:
    return lambda rng, rows: rng.integers(least, most, rows).astype(float)


def _nearly_equal(rows: int) -> dict[str, Any]:
    rng = np.random.default_rng(4)
    m1 = 10 ** rng.uniform(-2, 2, rows)
    m2 = m1 * (1 + 10 ** rng.uniform(-15, -2, rows))
    return {"m1": m1, "m2": m2, "M": 10 ** rng.uniform(-2, 3, rows), "wrap": 360.0}


def _strong(rows: int) -> dict[str, Any]:
    """μφ above 700."""
    rng = np.random.default_rng(6)
    m1, m2, M, _ = ordinary(rows)
    return {"m1": m1, "m2": m2, "M": M, "mu": rng.uniform(225, 400, rows)}


def _light(rows: int) -> dict[str, Any]:
    m1, m2, M, mu = ordinary(rows)
    return {"m1": m1 * 1e-305, "m2": m2 * 1e-305, "M": M * 1e-305, "mu": mu}


def _ties(rows: int) -> dict[str, Any]:
    """A load of six and a drive of three of the lighter mass: a tension is 3 g/2, of 54 bits."""
    m1 = 2.0 ** np.random.default_rng(7).integers(-20, 20, rows)
    return {"m1": m1, "m2": 4 * m1, "M": 2 * m1}


VECTOR = ("friction_force_x", "friction_force_y")
FAMILIES = {
    "near-critical": Family(lambda rows: _named(near_critical(rows)), "certified"),
    "m2 within 1e-15 to 1e-3 of m1 e^{μπ}": Family(lambda rows: _named(at_the_threshold(rows)), "certified"),
    "m2 within 1e-17 to 1e-12 of m1 e^{μπ}": Family(
        lambda rows: _named(at_the_threshold(rows, -17, -12)), "certified"
    ),
    "masses and M over 1e±300": Family(_with(m1=_anything, m2=_anything, M=_anything), "certified"),
    "the same, exact": Family(_with(m1=_anything, m2=_anything, M=_anything)),
    "μφ above 700": Family(_strong, "certified"),
    "ordinary, exact": Family(_with()),
    "exact, wrap a column": Family(_with(wrap=lambda rng, rows: rng.uniform(1, 720, rows))),
    "the same, all quantities": Family(
        _with(
            wrap=lambda rng, rows: rng.uniform(1, 720, rows), R=lambda rng, rows: rng.uniform(0.01, 1, rows)
        ),
        quantities=(
            "acceleration",
            *VECTOR,
            "axle_force",
            "torque",
            "rim_acceleration",
            "angular_acceleration",
            "critical_heavier_mass",
            "least_heavier_mass",
            "least_pulley_mass",
        ),
    ),
    "exact, wrap a column of 180, friction_force_x, y, no mu": Family(
        _with(mu=lambda rng, rows: None, wrap=lambda rng, rows: np.full(rows, 180.0)), quantities=VECTOR
    ),
    "nearly equal masses, wrap 360, friction_force_x, y": Family(_nearly_equal, quantities=VECTOR),
    "exact, friction_force_max": Family(_with(), quantities=("friction_force_max",)),
    "exact, friction_force_min": Family(_with(), quantities=("friction_force_min",)),
    "certified, friction_force_min and max": Family(
        _with(), "certified", ("friction_force_min", "friction_force_max")
    ),
    "exact rows of small integers": Family(
        _with(m1=_whole(1, 20), m2=_whole(1, 20), M=_whole(0, 20), mu=lambda rng, rows: None)
    ),
    "the same, g = 10": Family(
        _with(
            m1=_whole(1, 20),
            m2=_whole(1, 20),
            M=_whole(0, 20),
            mu=lambda rng, rows: None,
            g=lambda rng, rows: 10.0,
        )
    ),
    "exact, every row a tie": Family(_ties),
    "whole turns, weak friction, friction_force_x, y": Family(
        _with(wrap=lambda rng, rows: 360.0, mu=_tiny), quantities=VECTOR, of=20_000
    ),
    "wraps of 1e-300 to 1e-50, friction_force_x, y": Family(_with(wrap=_tiny), quantities=VECTOR, of=20_000),
    "masses of 1e-305, friction_force_min": Family(_light, quantities=("friction_force_min",), of=20_000),
}


SLOWEST = {
    "m1": 2.7370882119628515e136,
    "m2": 9.2198601112921,
    "M": 2.3265701665697617e-119,
    "wrap": 2.27e295,
}
"""The row that took longest of ten thousand drawn from all doubles: of a wrap that long, pi is needed to
as many digits."""


def copied(*columns: Any) -> Any:
    """The ceiling: inputs copied into as many outputs."""
    return [column.copy() for column in (*columns, *columns[:2])], np.zeros(len(columns[0]), np.int8)


def seconds(work: Callable[[], Any]) -> float:
    start = time.perf_counter()
    kept = work()
    taken = time.perf_counter() - start
    del kept
    return taken


def warm(given: dict[str, Any], accuracy: Any, quantities: Any, times: int) -> float:
    """The median of runs but for the first."""

    def work() -> object:
        return solve_arrays(**given, accuracy=accuracy, quantities=quantities)

    work()
    return statistics.median(seconds(work) for _ in range(times))


def beside_the_paper(what: str, scenes: Columns) -> None:
    works: dict[str, Callable[[], Any]] = {
        "paper": lambda: paper_in_numpy(*scenes),
        "fast": lambda: solve_arrays(*scenes, accuracy="fast"),
        "certified": lambda: solve_arrays(*scenes),
        "copy": lambda: copied(*scenes),
    }
    with np.errstate(all="ignore"):
        cold = {name: seconds(work) for name, work in works.items()}
        times = [{name: seconds(work) for name, work in works.items()} for _ in range(REPEATS)]
    print(f"{scenes[0].size} {what} scenes, the seven standard quantities:")
    for name in works:
        warm = statistics.median(one[name] for one in times)
        ratio = statistics.median(one["paper"] / one[name] for one in times)
        print(f"  {name:9}  {warm:6.3f} s, {ratio:5.2f} x the paper's throughput, cold {cold[name]:6.3f} s")


def main(rows: int) -> None:
    beside_the_paper("ordinary", ordinary(rows))
    beside_the_paper("ordinary (mu uniform in 0 to 1)", more_slip(rows))
    print("Rows a second, in families that are hard:")
    for name, family in FAMILIES.items():
        count = rows // family.of
        taken = warm(family.draw(count), family.accuracy, family.quantities, 3)
        print(f"  {name:56} {count / taken:12,.0f}")
    few = _named(ordinary(100))
    for accuracy in ("fast", "certified", "exact"):
        print(f"100 rows, {accuracy}: {warm(few, accuracy, None, 99) * 1e3:.2f} ms")
    for what, names in (("the seven standard quantities", None), ("all quantities", NAMES[1:])):
        print(f"the slowest row known, exact, {what}: {warm(SLOWEST, 'exact', names, 9) * 1e3:.0f} ms")
    tracemalloc.start()
    results = solve_arrays(*ordinary(rows // 5))
    _, peak = tracemalloc.get_traced_memory()
    kept = sum(column.nbytes for column in results.values()) + 6 * 8 * (rows // 5)
    print(
        f"temporaries of a certified run: at most {max(0, peak - kept) / 1e6:.0f} MB beyond inputs and outputs"
    )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 10_000_000)
