"""Many scenes at once: arrays in, arrays out.

`inputs` checks the inputs of each row and groups the rows by what is given. `rows` solves a group. `plan`
shows by an example how results are certified.
"""

from __future__ import annotations  # help() shows types by the names written here

import os
from collections import Counter
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from math import nan, prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..reading.names import read_name, read_quantities
from ..solver.decisions import Decisions
from ..solver.quantities import ACCURACIES, Accuracy
from ..solver.scene import COLUMNS, MASSES, MISSING_MASS, SceneError, Terms
from .inputs import STATUSES as STATUSES
from .inputs import VALID as VALID
from .inputs import GivenColumn, Numbers, groups, read_column
from .plan import LEVELS, Task
from .rows import Rows, select, size_of

CHUNK_ROWS = 1 << 20
"""The most rows that one thread solves by itself. Smaller chunks would run each program more often."""
CODE_TYPES = {"regime": np.int8, "status": np.int8}
"""The types of results that are codes; all others are doubles."""


def solve_arrays(
    m1: Numbers,
    m2: Numbers,
    M: Numbers | None = None,
    mu: Numbers | None = None,
    mu_k: Numbers | None = None,
    *,
    g: Numbers | None = None,
    inertia: Numbers | None = None,
    I: Numbers | None = None,
    R: Numbers | None = None,
    wrap: Numbers = 180.0,
    axle: Numbers | None = None,
    drop: Numbers | None = None,
    time: Numbers | None = None,
    speed: Numbers | None = None,
    accuracy: Accuracy = "certified",
    quantities: Sequence[str] | None = None,
) -> dict[str, NDArray[Any]]:
    """Solve arrays of scenes in doubles.

    An input is a number, a sequence, an array, or a column of polars or pandas. All are broadcast against
    each other. A text is read as a number; units are for `solve` and `solve_table`. An input is not given in
    rows where it is masked (`numpy.ma`), None, a null of polars, or NA or NaN in a column of pandas. Any
    other NaN is an error of its row.

    Args:
        m1, m2: The masses, in kg.
        M: The pulley's mass, in kg; inf locks it.
        mu, mu_k: The coefficients of static and of kinetic friction.
        g: Gravity, in m/s²; exactly 9.80665 in rows where it is not given.
        inertia: I/(M R²); 0.5, a disk's, in rows where neither it nor I is given.
        I, R: The moment of inertia, in kg m², and the radius, in m.
        wrap: The angle that the string wraps, in degrees.
        axle: The friction of the axle as a force at the rim, in N.
        drop, time, speed: Of a fall from rest the height, in m, the time, in s, or the speed at its end, in
            m/s; one gives the others.
        accuracy: "certified" (every regime right, every relative error proven below 2e-14), whose last
            places may depend on NumPy's build and on the other rows; or "exact" (the nearest double), which
            is the same everywhere.
        quantities: The names or symbols of quantities, as "acceleration" or "a"; if None, regime,
            acceleration, tension_1, tension_2, mu_verge, friction_force and critical_pulley_mass.

    Returns:
        Arrays by the names of the quantities, in SI units, of the common shape of the inputs: NaN where a
        value is undetermined, ±inf where it is beyond the doubles. ``regime`` is an int8 index into
        `REGIMES`, -1 in an invalid row. There is always ``status``, an int8 index into `STATUSES`, 0 in a
        valid row. An invalid row never stops the others.

    Raises:
        SceneError: A mass is missing, an input is no real number or beyond the range of doubles, an accuracy
            or quantity is not known, or shapes do not broadcast (a ValueError).
    """
    values = (m1, m2, M, mu, mu_k, g, inertia, I, R, wrap, axle, drop, time, speed)
    return solve_and_count(dict(zip(COLUMNS, values, strict=True)), accuracy, quantities)[0]


def solve_and_count(
    given: Mapping[str, Numbers | None],
    accuracy: Accuracy,
    quantities: Sequence[str] | None,
    terms: Mapping[str, Terms] = {},
) -> tuple[dict[str, NDArray[Any]], Counter[tuple[str, str]]]:
    """Solve as `solve_arrays`, and count the rows by what is missing, or only assumed, and why.

    ``terms`` are those of inputs that are given in others than their own, as weights.
    """
    names = tuple(read_quantities(quantities))
    read_name("accuracy", str(accuracy), ACCURACIES, "accuracy", {})  # raises if it is none
    inputs, shape = _read(given)
    results = {name: np.empty(shape, CODE_TYPES.get(name, np.float64)) for name in (*names, "status")}
    flat = {name: column.reshape(-1) for name, column in results.items()}
    size = prod(shape)

    def solve_chunk(start: int) -> Counter[tuple[str, str]]:
        """Solve a chunk of rows, and count its rows without a value."""
        chunk = slice(start, min(start + CHUNK_ROWS, size))
        given_columns = {name: column.cut(shape, chunk) for name, column in inputs.items()}
        doubles = {name: column.doubles for name, column in given_columns.items()}
        rows = Rows(doubles, {name: flat[name][chunk] for name in results}, accuracy)
        with np.errstate(all="ignore"):
            _solve(rows, given_columns, names, terms)
        return rows.reasons

    # Chunks have a fixed size, so that no digit depends on the number of cores.
    starts = range(0, size, CHUNK_ROWS)
    if len(starts) < 2:
        return results, sum(map(solve_chunk, starts), Counter())
    # NumPy releases the interpreter's lock. At an error or Ctrl-C, `map` cancels the chunks that wait.
    with ThreadPoolExecutor(min(len(starts), os.cpu_count() or 1)) as pool:
        return results, sum(pool.map(solve_chunk, starts), Counter())


def _read(given: Mapping[str, Numbers | None]) -> tuple[dict[str, GivenColumn], tuple[int, ...]]:
    """Return the inputs as columns, and the shape to which they are broadcast. Raises SceneError."""
    for mass in MASSES:
        if given.get(mass) is None:
            raise SceneError(mass, None, MISSING_MASS)
    inputs = {name: read_column(name, given.get(name)) for name in COLUMNS}
    shape: tuple[int, ...] = ()
    for name, (doubles, _) in inputs.items():
        try:
            shape = np.broadcast_shapes(shape, doubles.shape)
        except ValueError:
            before = f"{shape}, the shape of what comes before it"
            rule = f"of shape {doubles.shape} does not broadcast with {before}"
            raise SceneError(name, None, rule) from None
    return inputs, shape


def _solve(
    rows: Rows, given: Mapping[str, GivenColumn], names: tuple[str, ...], terms: Mapping[str, Terms]
) -> None:
    """Write the status of all rows, and the quantities, which have no value in invalid rows."""
    size = len(rows.results["status"])
    for group in groups(given, size, terms):
        rows.results["status"][group.rows] = group.status
        if group.pattern:
            level = len(LEVELS[rows.accuracy]) if group.beyond_window else 0
            row = partial(rows.number, select(group.rows, 0))
            for assumption in Decisions(group.pattern.scene(row)).assumptions.items():
                rows.reasons[assumption] += size_of(group.rows)
            rows.solve(group.rows, Task(group.pattern, frozenset(), names, level))
            continue
        for name in names:
            rows.results[name][group.rows] = -1 if name == "regime" else nan
