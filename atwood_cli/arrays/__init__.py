"""Many scenes at once: arrays in, arrays out, by block, on threads.

`solve_arrays` is the door. Here it is also decided, row by row, whether what is given is a scene, and of
which kind its inputs are; rows of the same kind are solved together in `rows`, which argues what the
accuracies promise.
"""

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from fractions import Fraction
from math import inf, nan, prod
from threading import Lock
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arithmetic.double_double import WINDOW
from ..arithmetic.tables import Column
from ..model.quantities import NAMES, STANDARD
from ..model.scene import MISSING_MASS, PARAMETERS, SceneError
from ..model.units import nearest
from .plan import COLUMN, COLUMNS, LADDERS, Accuracy, Given
from .program import Room
from .rows import Index, Left, Rows, size_of

ACCURACIES: tuple[Accuracy, ...] = ("fast", "certified", "exact")
BLOCK = 131_072  # rows, as measured
THREADS = 4  # more would wait for the interpreter
FAST_WINDOW = 2.0**-250, 2.0**250  # beyond it, what comes in between may overflow though results do not
SHAPES = ("inertia", "wrap")
"""Inputs that a program is made for, where all rows share them: 1/2 and π are no mere numbers."""
MASSES, MAY_BE_ABSENT = ("m1", "m2"), ("M", "mu", "mu_k", "R")
REAL = "biufOSU"
"""Kinds of arrays: those of real numbers, and those whose elements may be; NumPy takes others for numbers."""
STATUSES = ("valid", *COLUMNS, "no mass", "friction at a free end", "mu_k without mu", "mu_k above mu")
"""What the codes in ``status`` mean: the parameter outside its domain, or what does not go together."""


def solve_arrays(
    m1: ArrayLike,
    m2: ArrayLike,
    M: ArrayLike | None = None,
    mu: ArrayLike | None = None,
    mu_k: ArrayLike | None = None,
    *,
    g: ArrayLike = 9.80665,
    inertia: ArrayLike = 0.5,
    R: ArrayLike | None = None,
    wrap: ArrayLike = 180.0,
    accuracy: Accuracy = "certified",
    quantities: Sequence[str] | None = None,
) -> dict[str, NDArray[Any]]:
    """`solve` for arrays of scenes, broadcast against each other; all numbers are doubles.

    Masses in kg, g in m/s², R in m, wrap in degrees; M = inf locks the pulley. What is masked or NaN is
    not given for that row, which M, mu, mu_k and R may be. ``accuracy`` is "fast" (doubles), "certified"
    (every value within 4 units in the last place of the exact one, or 4.5 just below a power of two; every
    regime right), or "exact" (the nearest double, and so the same everywhere; else the last place may
    differ between NumPy's builds, or by the rows beside).

    Returns arrays by name, of the inputs' common shape: the ``quantities`` asked for (those of
    `quantities.STANDARD` if None), NaN where undetermined, ±inf beyond the doubles; ``regime`` is an
    int8 index into `REGIMES`, -1 where the row is invalid; and always ``status``, an int8 index into
    `STATUSES`, 0 where it is valid. An invalid row never stops the others. Raises SceneError for a
    missing mass, what is no real number, an unknown accuracy or quantity, ValueError for shapes that do
    not broadcast.
    """
    names = list(STANDARD if quantities is None else dict.fromkeys(quantities))
    for name in names:
        if name not in NAMES:
            raise SceneError("quantities", name, f"is no quantity{nearest(str(name), NAMES)}")
    if accuracy not in ACCURACIES:
        raise SceneError("accuracy", accuracy, f"must be one of {', '.join(ACCURACIES)}")
    given = dict(zip(COLUMNS, (m1, m2, M, mu, mu_k, g, inertia, R, wrap), strict=True))
    for name, value in given.items():
        if value is None and name not in MAY_BE_ABSENT:
            raise SceneError(
                name,
                None,
                MISSING_MASS if name in MASSES else "is None; give it, or leave it out for the default",
            )
    inputs = {name: _doubles(name, value) for name, value in given.items() if value is not None}
    shape = np.broadcast_shapes(*(column.shape for column in inputs.values()))
    kinds = {"regime": np.int8, "status": np.int8}
    results = {name: np.empty(shape, kinds.get(name, np.float64)) for name in (*names, "status")}
    flat = {name: column.reshape(-1) for name, column in results.items()}
    left: dict[Left, list[NDArray[np.intp]]] = {}

    def solve_block(block: Index, room: Room, what: Left | None) -> None:
        """All of a block's rows, or what was left of rows that agree."""
        given = {name: _cut(column, shape, block) for name, column in inputs.items()}
        out = {name: flat[name][block] for name in results}
        rows = Rows(given, out, accuracy, room)
        if what is None:
            assert isinstance(block, slice)
            rows.left = {} if len(blocks) > 1 else None
            _solve(rows, tuple(names))
            for left_rows, some in (rows.left or {}).items():
                left.setdefault(left_rows, []).extend(index + block.start for index in some)
        else:
            rows.solve(slice(0, size_of(block)), *what)
        if not isinstance(block, slice):
            for name in what[2] if what else ():
                flat[name][block] = out[name]

    blocks = _blocks(prod(shape), BLOCK, THREADS)
    _on_threads(solve_block, [(block, None) for block in blocks])
    again: list[tuple[Index, Left | None]] = []
    for what, indices in left.items():
        index = np.sort(np.concatenate(indices))  # whichever thread was first
        again += [(index[block], what) for block in _blocks(index.size, BLOCK)]
    _on_threads(solve_block, again)
    return results


def _doubles(name: str, value: ArrayLike) -> Column:
    """A parameter's numbers as doubles, NaN where masked. Raises SceneError for what is no real number."""
    try:
        array = value if isinstance(value, np.ma.MaskedArray) else np.asarray(value)
        doubles: Any = array.astype(np.float64, copy=False) if array.dtype.kind in REAL else None
    except (TypeError, ValueError, OverflowError) as error:
        raise SceneError(name, None, f"must be real numbers: {error}") from None
    if doubles is None:
        raise SceneError(name, None, f"must be real numbers, not {array.dtype}")
    return np.asarray(doubles.filled(nan) if isinstance(doubles, np.ma.MaskedArray) else doubles)


def _blocks(size: int, most: int, multiple_of: int = 1) -> list[slice]:
    """Slices of nearly the same length, so many that threads share them evenly.

    Not by how many processors there are: the digits must not depend on it.
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
    """NumPy lets go of the interpreter while it computes, so threads share the parts.

    Each keeps a room of its own from part to part.
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
                block, what = part
                work(block, room, what)

    count = min(THREADS, os.cpu_count() or 1, len(parts))
    if count < 2:
        share()
        return
    pool = ThreadPoolExecutor(count)
    try:
        for done in [pool.submit(share) for _ in range(count)]:
            done.result()
    finally:
        waiting = iter(())  # for all threads, should one have failed or Ctrl-C come
        pool.shutdown()


def _solve(rows: Rows, names: tuple[str, ...]) -> None:
    """Write quantities of all rows, and their status."""
    given = {name: _InputColumn.of(name, column, rows.accuracy) for name, column in rows.inputs.items()}
    rows.results["status"][:] = status = _status(given, len(rows.results["status"]))
    for index, agreed, far in _agreeing(given, status):
        rung = len(LADDERS[rows.accuracy]) - 1 if far else 0
        rows.solve(index, agreed, frozenset(), names, rung)
    if status.any():
        for name in names:
            rows.results[name][status != 0] = -1 if name == "regime" else nan


# What is given in each row: which rows agree before any question is asked

USUAL, ABSENT, ZERO, INFINITE, FAR = range(5)


class _InputColumn(NamedTuple):
    """A parameter's column, and of which kind each number is: just USUAL if all are."""

    name: str
    column: Column
    kinds: Any

    @classmethod
    def of(cls, name: str, column: Column, accuracy: Accuracy) -> "_InputColumn":
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

    def agreed(self, row: int) -> Any:
        """What the rows of the same kind as this one agree on: see `Given`."""
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
    """Row by row, whether the inputs are in their domains and go together; see STATUSES."""
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
    for fault, rows in reversed(faults):  # the first one stands
        status[np.broadcast_to(rows, size)] = STATUSES.index(fault)
    return status


def _agreeing(
    given: Mapping[str, _InputColumn], status: NDArray[np.int8]
) -> Iterator[tuple[Index, Given, bool]]:
    """The rows of a block in parts that agree on what is given; and whether that is beyond the window."""
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
        inputs = dict.fromkeys(COLUMNS) | {name: of.agreed(row) for name, of in given.items()}
        far = any(
            of.kinds is not USUAL and np.broadcast_to(of.kinds, size)[row] == FAR for of in given.values()
        )
        light, heavy = (float(np.broadcast_to(mass, size)[row]) for mass in (m1, m2))
        yield index, Given((heavy > light) - (heavy < light), tuple(inputs.values())), far
