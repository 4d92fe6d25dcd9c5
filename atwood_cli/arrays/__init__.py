"""Many scenes at once: arrays in, arrays out, block by block, on threads.

`inputs` checks each row's inputs, and puts rows with the same pattern of inputs into one group. `rows` solves
a group. `plan` shows by an example how results are certified.
"""

from __future__ import annotations  # help() shows types by the names written here

import os
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from math import nan, prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..model.quantities import Accuracy, read_accuracy, read_quantities
from ..model.scene import INPUTS, MASSES, MISSING_MASS, SceneError
from .inputs import DEFAULTS, GivenColumn, Numbers, groups, input_columns, read_column
from .inputs import STATUSES as STATUSES
from .pattern import Index, Task
from .plan import LEVELS
from .rows import Rows

BLOCK = 131_072  # rows, as measured
THREADS = 4  # more would wait for the interpreter's lock
CODES = {"regime": np.int8, "status": np.int8}


def solve_arrays(
    m1: Numbers,
    m2: Numbers,
    M: Numbers | None = None,
    mu: Numbers | None = None,
    mu_k: Numbers | None = None,
    *,
    g: Numbers = DEFAULTS["g"],
    inertia: Numbers | None = None,
    I: Numbers | None = None,
    R: Numbers | None = None,
    wrap: Numbers = DEFAULTS["wrap"],
    axle: Numbers | None = None,
    accuracy: Accuracy = "certified",
    quantities: Sequence[str] | None = None,
) -> dict[str, NDArray[Any]]:
    """Solve arrays of scenes in doubles.

    An input is a number, a sequence, an array or a polars column. All are broadcast against each other. An
    input is not given in rows where it is masked (`numpy.ma`), None, or a null of polars. A NaN is an error
    of its row.

    Args:
        m1, m2: The masses, in kg.
        M: The pulley's mass, in kg; inf locks it.
        mu, mu_k: The coefficients of static and of kinetic friction.
        g: Gravity, in m/s².
        inertia: I/(M R²); 0.5, a disk's, in rows where neither it nor I is given.
        I, R: The moment of inertia, in kg m², and the radius, in m.
        wrap: The angle that the string wraps, in degrees.
        axle: The friction of the axle as a force at the rim, in N.
        accuracy: "certified" (every regime right, every value proven within 2e-14 of itself), whose last
            places may depend on NumPy's build and on the other rows; or "exact" (the nearest double), which
            is the same everywhere.
        quantities: The names or symbols of quantities, as "acceleration" or "a"; if None, the names in
            `quantities.STANDARD`.

    Returns:
        Arrays by the names of the quantities, in SI units, of the common shape of the inputs: NaN where a
        value is undetermined, ±inf where it is beyond the doubles. ``regime`` is an int8 index into
        `REGIMES`, -1 in an invalid row. There is always ``status``, an int8 index into `STATUSES`, 0 in a
        valid row. An invalid row never stops the others.

    Raises:
        SceneError: A mass is missing, an input is no real number or beyond the range of doubles, an accuracy
            or quantity is not known, or shapes do not broadcast (a ValueError).
    """
    values = (m1, m2, M, mu, mu_k, g, inertia, I, R, wrap, axle)
    return solve_and_count(dict(zip(INPUTS, values, strict=True)), accuracy, quantities)[0]


def solve_and_count(
    given: Mapping[str, Numbers | None], accuracy: Accuracy, quantities: Sequence[str] | None
) -> tuple[dict[str, NDArray[Any]], Counter[tuple[str, str]]]:
    """As `solve_arrays`; and the number of valid rows without a value, by quantity and reason."""
    names = tuple(read_quantities(quantities))
    accuracy = read_accuracy(accuracy)
    inputs, shape = _read(given)
    results = {name: np.empty(shape, CODES.get(name, np.float64)) for name in (*names, "status")}
    flat = {name: column.reshape(-1) for name, column in results.items()}
    left: dict[Task, list[NDArray[np.intp]]] = {}
    counted: list[Counter[tuple[str, str]]] = []

    def rows_at(index: Index) -> tuple[Rows, dict[str, GivenColumn]]:
        given = {name: one.cut(shape, index) for name, one in inputs.items()}
        columns = {name: one.column for name, one in given.items()}
        rows = Rows(columns, {name: flat[name][index] for name in results}, accuracy)
        counted.append(rows.reasons)
        return rows, given

    def solve_block(block: slice) -> None:
        """Solve all rows of a block, but for the tasks that are left for the end."""
        rows, given = rows_at(block)
        rows.left = {} if len(blocks) > 1 else None
        _solve(rows, given, names)
        for task, some in (rows.left or {}).items():
            left.setdefault(task, []).extend(index + block.start for index in some)

    def solve_left(index: NDArray[np.intp], task: Task) -> None:
        rows, _ = rows_at(index)
        rows.solve(slice(0, index.size), task)
        for name in task.names:
            flat[name][index] = rows.results[name]

    blocks = _blocks(prod(shape))
    _on_threads(solve_block, [(block,) for block in blocks])
    # Sorted, for the same digits whichever thread was first.
    _on_threads(solve_left, [(np.sort(np.concatenate(some)), task) for task, some in left.items()])
    return results, sum(counted, Counter())


def _read(given: Mapping[str, Numbers | None]) -> tuple[dict[str, GivenColumn], tuple[int, ...]]:
    """The inputs as columns, and the shape that they are broadcast to. Raises SceneError."""
    for mass in MASSES:
        if given.get(mass) is None:
            raise SceneError(mass, None, MISSING_MASS)
    inputs = {name: read_column(name, given.get(name)) for name in INPUTS}
    shape: tuple[int, ...] = ()
    for name, (column, _) in inputs.items():
        try:
            shape = np.broadcast_shapes(shape, column.shape)
        except ValueError:
            before = f"{shape}, the shape of what comes before it"
            raise SceneError(
                name, None, f"of shape {column.shape} does not broadcast with {before}"
            ) from None
    return inputs, shape


def _blocks(size: int) -> list[slice]:
    """Slices of nearly the same length; if there are several, threads can share them evenly.

    The number of processors plays no part, as the digits must not depend on it.
    """
    count = -(-size // BLOCK)
    count = -(-count // THREADS) * THREADS if count > 1 else count
    return [slice(size * i // count, size * (i + 1) // count) for i in range(count)]


def _on_threads(work: Callable[..., None], parts: Sequence[tuple[Any, ...]]) -> None:
    """Do the parts of the work on threads, which run at once as NumPy releases the interpreter's lock."""

    def quiet(part: tuple[Any, ...]) -> None:
        with np.errstate(all="ignore"):
            work(*part)

    if len(parts) < 2:
        for part in parts:
            quiet(part)
        return
    pool = ThreadPoolExecutor(min(THREADS, os.cpu_count() or 1))
    try:
        for done in [pool.submit(quiet, part) for part in parts]:
            done.result()
    finally:
        pool.shutdown(cancel_futures=True)  # where one has failed, or at Ctrl-C


def _solve(rows: Rows, given: Mapping[str, GivenColumn], names: tuple[str, ...]) -> None:
    """Write the status of all rows, and the quantities: those of invalid rows have no value."""
    size = len(rows.results["status"])
    for index, status, pattern, far in groups(input_columns(given), size):
        rows.results["status"][index] = status
        if pattern:
            level = len(LEVELS[rows.accuracy]) if far else 0
            rows.solve(index, Task(pattern, frozenset(), names, level))
            continue
        for name in names:
            rows.results[name][index] = -1 if name == "regime" else nan
