"""Many scenes at once: arrays in, arrays out, block by block, on threads.

`solve_arrays` checks each row's inputs and puts rows with the same pattern of inputs into one group. `rows`
solves a group. `plan` shows by an example how results are certified.
"""

from __future__ import annotations  # help() shows types by the names written here

import os
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from decimal import Decimal
from fractions import Fraction
from math import inf, nan, prod
from threading import Lock
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..model.quantities import ACCURACIES, STANDARD, Accuracy, read_names
from ..model.scene import COLUMNS, MASSES, MISSING_MASS, PARAMETERS, SceneError
from .double_double import WINDOW
from .plan import COLUMN, LEVELS, Pattern, Task
from .program import Room
from .rows import Index, Rows, size_of
from .tables import Column

BLOCK = 131_072  # rows, as measured
THREADS = 4  # more would wait for the interpreter's lock
FAST_WINDOW = 2.0**-250, 2.0**250  # beyond it, intermediate values may overflow though results do not
SHAPES = ("inertia", "wrap")
"""Inputs whose common value is built into a program: with 1/2 and π it is simpler than with a column."""
MAY_BE_ABSENT = ("M", "mu", "mu_k", "R")
REAL = "biufOSU"
"""NumPy's kinds of arrays that may hold real numbers. It would convert some others to numbers too."""
STATUSES = ("valid", *COLUMNS, "no mass", "friction at a free end", "mu_k without mu", "mu_k above mu")
"""What the codes in ``status`` mean: a parameter outside its domain, or inputs that do not go together."""

Numbers = ArrayLike | Sequence[float | None]
"""A number for all rows, or one for each; None is not given."""


def solve_arrays(
    m1: Numbers,
    m2: Numbers,
    M: Numbers | None = None,
    mu: Numbers | None = None,
    mu_k: Numbers | None = None,
    *,
    g: Numbers = 9.80665,
    inertia: Numbers = 0.5,
    R: Numbers | None = None,
    wrap: Numbers = 180.0,
    accuracy: Accuracy = "certified",
    quantities: Sequence[str] | None = None,
) -> dict[str, NDArray[Any]]:
    """Solve arrays of scenes, broadcast against each other, in doubles.

    Masses are in kg, g in m/s², R in m, wrap in degrees. M = inf locks the pulley. M, mu, mu_k and R are
    not given in rows where they are masked or NaN. ``accuracy`` is "fast" (plain doubles), "certified"
    (every value within 4 units in the last place of the exact one, or 4.5 just below a power of two; every
    regime right), or "exact" (the nearest double). Exact results are the same everywhere. The last place of
    others may depend on NumPy's build and on the other rows.

    Returns arrays by name, of the inputs' common shape. There is one for each of the ``quantities``, or of
    `quantities.STANDARD` if None: NaN where undetermined, ±inf beyond the doubles. A quantity may be asked
    for by its symbol, as "a" or "T1"; its array has its name, "acceleration". ``regime`` is an int8 index
    into `REGIMES`, -1 in an invalid row. There is always ``status``, an int8 index into `STATUSES`, 0 in a
    valid row. An invalid row never stops the others. Raises SceneError for a missing mass, for what is no
    real number or beyond the range of doubles, for an unknown accuracy or quantity, and for shapes that do
    not broadcast.
    """
    given = dict(zip(COLUMNS, (m1, m2, M, mu, mu_k, g, inertia, R, wrap), strict=True))
    return solve_and_count(given, accuracy, quantities)[0]


def solve_and_count(
    given: Mapping[str, Numbers | None], accuracy: Accuracy, quantities: Sequence[str] | None
) -> tuple[dict[str, NDArray[Any]], Counter[tuple[str, str]]]:
    """As `solve_arrays`; and the number of valid rows without a value, by quantity and reason."""
    words = [quantities] if isinstance(quantities, str) else STANDARD if quantities is None else quantities
    names = list(dict.fromkeys(read_names("quantities", map(str, words))))
    if accuracy not in ACCURACIES:
        raise SceneError("accuracy", accuracy, f"must be one of {', '.join(ACCURACIES)}")
    for name, value in given.items():
        if value is None and name not in MAY_BE_ABSENT:
            raise SceneError(
                name,
                None,
                MISSING_MASS if name in MASSES else "is None; give it, or leave it out for the default",
            )
    inputs = {name: _doubles(name, value) for name, value in given.items() if value is not None}
    shape = _common_shape(inputs)
    kinds = {"regime": np.int8, "status": np.int8}
    results = {name: np.empty(shape, kinds.get(name, np.float64)) for name in (*names, "status")}
    flat = {name: column.reshape(-1) for name, column in results.items()}
    left: dict[Task, list[NDArray[np.intp]]] = {}
    counted: list[Counter[tuple[str, str]]] = []

    def solve_block(block: Index, room: Room, task: Task | None) -> None:
        """Solve all rows of a block, or the rows of a task that was left for the end."""
        given = {name: _cut(column, shape, block) for name, column in inputs.items()}
        out = {name: flat[name][block] for name in results}
        rows = Rows(given, out, accuracy, room)
        if task is None:
            assert isinstance(block, slice)
            rows.left = {} if len(blocks) > 1 else None
            _solve(rows, tuple(names))
            for few, some in (rows.left or {}).items():
                left.setdefault(few, []).extend(index + block.start for index in some)
        else:
            rows.solve(slice(0, size_of(block)), task)
        counted.append(rows.reasons)
        if not isinstance(block, slice):
            for name in task.names if task else ():
                flat[name][block] = out[name]

    blocks = _blocks(prod(shape), BLOCK, THREADS)
    _on_threads(solve_block, [(block, None) for block in blocks])
    again: list[tuple[Index, Task | None]] = []
    for task, indices in left.items():
        index = np.sort(np.concatenate(indices))  # the same order whichever thread was first
        again += [(index[block], task) for block in _blocks(index.size, BLOCK)]
    _on_threads(solve_block, again)
    return results, sum(counted, Counter())


def _common_shape(inputs: Mapping[str, Column]) -> tuple[int, ...]:
    """The shape that the columns are broadcast to. Raises SceneError."""
    shape: tuple[int, ...] = ()
    for name, column in inputs.items():
        try:
            shape = np.broadcast_shapes(shape, column.shape)
        except ValueError:
            rule = (
                f"of shape {column.shape} does not broadcast with {shape}, the shape of what comes before it"
            )
            raise SceneError(name, None, rule) from None
    return shape


def _doubles(name: str, value: Numbers) -> Column:
    """A parameter's numbers as doubles, NaN where masked.

    Raises SceneError for what is no real number, and for a number that would round to 0 or inf and is
    neither.
    """
    try:
        array = value if isinstance(value, np.ma.MaskedArray) else np.asarray(value)
        is_text = array.dtype.kind in "SU"  # as objects, so that an error shows 'x', not np.str_('x')
        plain = array.astype(object) if is_text else array
        with np.errstate(over="ignore"):
            doubles: Any = plain.astype(np.float64, copy=False) if array.dtype.kind in REAL else None
    except (TypeError, ValueError, OverflowError) as error:
        raise SceneError(name, None, f"must be real numbers: {error}") from None
    if doubles is None:
        raise SceneError(name, None, f"must be real numbers, not {array.dtype}")
    column = np.asarray(doubles.filled(nan) if isinstance(doubles, np.ma.MaskedArray) else doubles)
    if not np.can_cast(array.dtype, np.float64):
        ends = np.isinf(column) | (column == 0)
        for one, double in zip(np.asarray(array)[ends], column[ends], strict=True):
            text = one.decode() if isinstance(one, bytes) else one
            if (Decimal(text) if isinstance(text, str) else text) != double:
                raise SceneError(name, str(text), "is beyond the range of doubles")
    return column


def _blocks(size: int, most: int, multiple_of: int = 1) -> list[slice]:
    """Slices of nearly the same length; their number is a multiple that threads can share evenly.

    The number of processors plays no part, as the digits must not depend on it.
    """
    count = -(-size // most)
    count = -(-count // multiple_of) * multiple_of if count > 1 else count
    return [slice(size * i // count, size * (i + 1) // count) for i in range(count)]


def _cut(column: Column, shape: tuple[int, ...], rows: Index) -> Column:
    """Rows of a column as if it were broadcast and flat; a single number stays single."""
    if column.size == 1:
        return column.reshape(1)
    if column.shape == shape and column.flags.c_contiguous:
        return column.reshape(-1)[rows]
    return np.broadcast_to(column, shape).flat[rows]


def _on_threads(work: Callable[..., None], parts: Sequence[tuple[Any, ...]]) -> None:
    """Do the parts of the work on threads, which run at once because NumPy releases the interpreter's lock.

    Each thread keeps its own `Room` from part to part.
    """
    waiting = iter(parts)
    taking = Lock()

    def share() -> None:
        room = Room()
        with np.errstate(all="ignore"):
            while True:
                with taking:
                    part = next(waiting, None)
                if part is None:
                    return
                block, task = part
                work(block, room, task)

    count = min(THREADS, os.cpu_count() or 1, len(parts))
    if count < 2:
        share()
        return
    pool = ThreadPoolExecutor(count)
    try:
        for done in [pool.submit(share) for _ in range(count)]:
            done.result()
    finally:
        waiting = iter(())  # stops all threads if one has failed, or at Ctrl-C
        pool.shutdown()


def _solve(rows: Rows, names: tuple[str, ...]) -> None:
    """Write the status of all rows, and the quantities of the valid ones."""
    given = {name: _InputColumn.of(name, column, rows.accuracy) for name, column in rows.inputs.items()}
    rows.results["status"][:] = status = _status(given, len(rows.results["status"]))
    for index, pattern, far in _groups(given, status):
        level = len(LEVELS[rows.accuracy]) - 1 if far else 0
        rows.solve(index, Task(pattern, frozenset(), names, level))
    if status.any():
        for name in names:
            rows.results[name][status != 0] = -1 if name == "regime" else nan


# The pattern of each row's inputs

USUAL, ABSENT, ZERO, INFINITE, FAR = range(5)


class _InputColumn(NamedTuple):
    """A parameter's column and the kind of each number, or just USUAL if all are."""

    name: str
    column: Column
    kinds: Any

    @classmethod
    def of(cls, name: str, column: Column, accuracy: Accuracy) -> _InputColumn:
        low, high = FAST_WINDOW if accuracy == "fast" else WINDOW
        if low < column.min() and column.max() < high:
            return cls(name, column, USUAL)
        far = ((column > 0) & (column <= low)) | ((column >= high) & (column < inf))
        kinds = ABSENT * np.isnan(column) + ZERO * (column == 0) + INFINITE * (column == inf) + FAR * far
        return cls(name, column, kinds)

    @property
    def faults(self) -> Any:
        """Which rows are outside the parameter's domain."""
        parameter, may_be = PARAMETERS[self.name], [USUAL, FAR]
        may_be += (
            [ZERO] * parameter.zero + [INFINITE] * parameter.inf + [ABSENT] * (self.name in MAY_BE_ABSENT)
        )
        return ~np.isin(self.kinds, may_be) | (self.column < 0)

    def in_pattern(self, row: int) -> Any:
        """This input in the `Pattern` of a row."""
        single = self.column.size == 1
        kind = self.kinds if self.kinds is USUAL else self.kinds[0 if single else row]
        if kind == ABSENT:
            return None
        if kind == INFINITE:
            return inf
        if kind == ZERO:
            return Fraction(0)
        return Fraction(float(self.column[0])) if single and self.name in SHAPES else COLUMN


def _status(given: Mapping[str, _InputColumn], size: int) -> NDArray[np.int8]:
    """The index into STATUSES for each row: whether its inputs are in their domains and go together."""
    faults = [(name, one.faults) for name, one in given.items() if one.kinds is not USUAL]
    absent = np.array([nan])
    m1, m2, mu, mu_k = (given[n].column if n in given else absent for n in ("m1", "m2", "mu", "mu_k"))
    if given["m1"].kinds is not USUAL or given["m2"].kinds is not USUAL:
        faults.append(("no mass", (m1 == 0) & (m2 == 0)))
        faults.append(("friction at a free end", ((m1 == 0) | (m2 == 0)) & ~np.isnan(mu)))
    if "mu_k" in given:
        faults.append(("mu_k without mu", ~np.isnan(mu_k) & np.isnan(mu)))
        faults.append(("mu_k above mu", mu_k > mu))
    status = np.zeros(size, np.int8)
    for fault, rows in reversed(faults):  # the first fault overwrites the others
        status[np.broadcast_to(rows, size)] = STATUSES.index(fault)
    return status


def _groups(
    given: Mapping[str, _InputColumn], status: NDArray[np.int8]
) -> Iterator[tuple[Index, Pattern, bool]]:
    """A block's valid rows, grouped by pattern, and whether an input of the group is beyond the window."""
    size, (m1, m2) = len(status), (given["m1"].column, given["m2"].column)
    digits = [(5, one.kinds) for one in given.values() if one.kinds is not USUAL]
    if not (m2 > m1).all():
        digits.append((3, 1 * (m1 > m2) + 2 * (m1 == m2)))
    if status.any():
        digits.append((2, status != 0))
    key, place = np.zeros(1, np.int64), 1
    for base, digit in digits:
        key, place = key + place * digit, place * base
    key = np.broadcast_to(key, size)
    for one in np.unique(key) if digits else key[:1]:
        index = np.flatnonzero(key == one) if digits else slice(0, size)
        row = 0 if isinstance(index, slice) else int(index[0])
        if status[row]:
            continue
        inputs = dict.fromkeys(COLUMNS) | {name: of.in_pattern(row) for name, of in given.items()}
        far = any(
            of.kinds is not USUAL and np.broadcast_to(of.kinds, size)[row] == FAR for of in given.values()
        )
        light, heavy = (float(np.broadcast_to(mass, size)[row]) for mass in (m1, m2))
        yield index, Pattern((heavy > light) - (heavy < light), tuple(inputs.values())), far
