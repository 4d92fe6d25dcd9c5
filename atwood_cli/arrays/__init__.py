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
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arithmetic.double_double import WINDOW
from ..arithmetic.error_free import Column
from ..model.quantities import NAMES, STANDARD
from ..model.scene import MISSING_MASS, PARAMETERS, SceneError
from ..model.units import nearest
from .rows import COLUMNS, Accuracy, Index, Rows

ACCURACIES: tuple[Accuracy, ...] = ("fast", "certified", "exact")
BLOCK = {"fast": 131_072, "certified": 131_072, "exact": 81_920}  # rows, as measured
LET_GO = 4_000_000  # doubles; the GNU C library's limit is 32 MB
LEAVE = 1_000  # rows of a block that are better solved with those of others
THREADS = 4  # more would wait for the interpreter, and hold 30 MB of columns each
FAST_WINDOW = 2.0**-250, 2.0**250  # beyond it, what comes in between may overflow though results do not
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
    left: dict[tuple[tuple[str, ...], int], list[NDArray[np.intp]]] = {}

    def solve_rows(index: Index, names: Sequence[str], rung: int, leave: int) -> None:
        given = {name: _cut(column, shape, index) for name, column in inputs.items()}
        out = {name: flat[name][index] for name in (*names, "status")}
        with np.errstate(all="ignore"):
            for some, higher, within in _solve(given, out, names, accuracy, rung, leave):
                assert isinstance(index, slice)
                left.setdefault((some, higher), []).append(within + index.start)
        if not isinstance(index, slice):
            for name, column in out.items():
                flat[name][index] = column

    blocks = _blocks(prod(shape), BLOCK[accuracy], THREADS)
    leave = LEAVE if len(blocks) > 1 else 0
    _on_threads(lambda block: solve_rows(block, names, 0, leave), blocks)
    for (some, rung), indices in sorted(left.items()):
        index = np.sort(np.concatenate(indices))  # whichever thread was first
        for block in _blocks(index.size, BLOCK[accuracy]):
            solve_rows(index[block], some, rung, 0)
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


def _on_threads(work: Callable[[slice], None], blocks: Sequence[slice]) -> None:
    """NumPy lets go of the interpreter while it computes, so threads share the blocks."""
    if len(blocks) < 2:
        for block in blocks:
            work(block)
        return
    # The GNU C library takes the largest array that was let go of as its measure of what is small. After
    # this one, whose memory is never touched, it keeps a block's memory for the next one, which saves a
    # quarter of a second of page faults in 10 million rows. Others need no such hint.
    np.empty(LET_GO)
    pool = ThreadPoolExecutor(min(THREADS, os.cpu_count() or 1))
    try:
        for _ in pool.map(work, blocks):
            pass
    finally:
        pool.shutdown(cancel_futures=True)


def _solve(
    columns: Mapping[str, Column],
    out: dict[str, NDArray[Any]],
    names: Sequence[str],
    accuracy: Accuracy,
    rung: int,
    leave: int,
) -> Iterator[tuple[tuple[str, ...], int, NDArray[np.intp]]]:
    """Write quantities of scenes, in the arithmetic on that rung or higher; yields what `Rows` leave."""
    given = {name: _InputColumn.of(name, column, accuracy) for name, column in columns.items()}
    out["status"][:] = status = _status(given, len(out["status"]))
    for rows in _agreeing(given, status, accuracy):
        yield from rows.solve(tuple(sorted(names, key=_order)), out, rung, leave)
    if status.any():
        for name in names:
            out[name][status != 0] = -1 if name == "regime" else nan


def _order(name: str) -> int:
    """Where a quantity comes in: first what divides no rows, last what divides them in its own way."""
    return 0 if name == "mu_verge" else 2 if name.startswith("critical") else 1


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

    def field(self, row: int) -> Any:
        """The parameter for the rows of the same kind as this one: a number, or the column."""
        single = self.column.size == 1
        kind = self.kinds if self.kinds is USUAL else self.kinds[0 if single else row]
        if kind == ABSENT:
            return None
        if kind == INFINITE:
            return inf
        if single or kind == ZERO:
            return Fraction(float(self.column[0 if single else row]))
        return self.column


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
    given: Mapping[str, _InputColumn], status: NDArray[np.int8], accuracy: Accuracy
) -> Iterator[Rows]:
    """The rows of a block in parts that agree on what is given and of which kind, and who is heavier."""
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
        fields = dict.fromkeys(COLUMNS) | {name: of.field(row) for name, of in given.items()}
        far = any(
            of.kinds is not USUAL and np.broadcast_to(of.kinds, size)[row] == FAR for of in given.values()
        )
        light, heavy = (float(np.broadcast_to(mass, size)[row]) for mass in (m1, m2))
        sign = (heavy > light) - (heavy < light)
        yield Rows(fields, sign, accuracy, index, far)
