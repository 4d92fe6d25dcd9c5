"""What is given: columns of doubles, the faults of each row, and the rows that are solved together."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from decimal import Decimal
from fractions import Fraction
from math import inf, nan
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..model.scene import INPUTS, MASSES, SceneError
from .doubles import WINDOW
from .pattern import COLUMN, Column, Index, Pattern

Numbers = ArrayLike | Sequence[str | float | Decimal | Fraction | None]
"""What a column may be: whatever NumPy makes an array of. A polars column is one too."""
DEFAULTS = {"g": 9.80665, "inertia": 0.5, "wrap": 180.0}
"""Inputs that always have a value."""
WHERE_ABSENT = DEFAULTS | {"axle": 0.0}
"""What stands for an input in rows where it is not given; NaN for the others."""
SHAPES = ("inertia", "wrap")
"""Inputs whose common value is built into a program: with 1/2 and π it is simpler than with a column."""
REAL = "iufOSU"
"""NumPy's kinds of arrays that may hold real numbers. It would convert some others to numbers too."""
STATUSES = (
    *("valid", "m1", "m2", "M", "mu", "mu_k", "g", "inertia", "R", "wrap"),
    *("no mass", "friction at a free end", "mu_k without mu", "mu_k above mu"),
    *("NaN", "I", "axle", "I and inertia", "I without R", "I with M = 0 or inf"),
)
"""What the codes in ``status`` mean: an input that is outside its domain (or a mass that is not given),
inputs that do not go together, or one that is not a number."""


class GivenColumn(NamedTuple):
    """The doubles of an input, and the rows in which it is not given; None if it is given in all."""

    column: Column
    absent: NDArray[np.bool_] | None

    def cut(self, shape: tuple[int, ...], rows: Index) -> GivenColumn:
        """Rows of the column as if it were broadcast and flat; a single number stays single."""
        absent = None if self.absent is None else _cut(self.absent, shape, rows)
        return GivenColumn(_cut(self.column, shape, rows), absent)


def _cut(column: NDArray[Any], shape: tuple[int, ...], rows: Index) -> NDArray[Any]:
    if column.size == 1:
        return column.reshape(())
    if column.shape == shape and column.flags.c_contiguous:
        return column.reshape(-1)[rows]
    return np.broadcast_to(column, shape).flat[rows]


def read_column(name: str, value: Numbers | None) -> GivenColumn:
    """An input as doubles.

    Raises SceneError for what is no real number, and for a number that would round to 0 or inf and is
    neither.
    """
    default = WHERE_ABSENT.get(name, nan)
    if value is None:
        return GivenColumn(np.array(default), np.array(True))
    try:
        array = value.data if isinstance(value, np.ma.MaskedArray) else np.asarray(value)
        is_text = array.dtype.kind in "SU"  # as objects, so that an error shows 'x', not np.str_('x')
        plain = array.astype(object) if is_text else array
        absent = _absent(value, plain)
        if absent is not None and plain.dtype == object:
            plain = np.where(absent, nan, plain)
        with np.errstate(over="ignore"):
            column: Any = plain.astype(np.float64, copy=False) if array.dtype.kind in REAL else None
    except (TypeError, ValueError, OverflowError) as error:
        raise SceneError(name, None, f"must be real numbers: {error}") from None
    items = value if isinstance(value, list | tuple) else plain.flat if plain.dtype == object else ()
    if column is None or any(isinstance(one, bool | np.bool_) for one in items):
        kind = array.dtype if column is None else "bool"
        raise SceneError(name, None, f"must be real numbers, not {kind}")
    if absent is not None:
        column = np.where(absent, default, column)
    if not np.can_cast(array.dtype, np.float64):
        ends = np.isinf(column) | (column == 0)
        ends &= True if absent is None else ~absent
        for one, double in zip(plain[ends], column[ends], strict=True):
            text = one.decode() if isinstance(one, bytes) else one
            if (Decimal(text) if isinstance(text, str) else text) != double:
                raise SceneError(name, str(text), "is beyond the range of doubles")
    return GivenColumn(column, absent)


def _absent(value: Any, array: NDArray[Any]) -> NDArray[np.bool_] | None:
    """Where nothing is given: what is masked, None, and a null of a polars column. A NaN is none of these."""
    absent: Any = None
    if isinstance(value, np.ma.MaskedArray):
        absent = np.ma.getmaskarray(value)
    elif hasattr(value, "is_null"):  # polars
        absent = np.asarray(value.is_null(), np.bool_)
    if array.dtype == object:
        nothing = np.asarray(np.frompyfunc(lambda one: one is None, 1, 1)(array), np.bool_)
        absent = nothing if absent is None else absent | nothing
    return None if absent is None or not absent.any() else absent


# The pattern of each row's inputs

KINDS = USUAL, ABSENT, NAN, NEGATIVE, ZERO, INFINITE, FAR = range(7)
OUTSIDE = {
    name: {NEGATIVE, *[ZERO] * (not domain.zero), *[INFINITE] * (not domain.inf)}
    for name, domain in INPUTS.items()
}
"""Of each input, the kinds of numbers that are outside its domain."""
SAME_IN_ALL = {ABSENT: None, ZERO: Fraction(0), INFINITE: inf}
"""What stands in a `Pattern` for numbers of a kind, if not their column."""


class InputColumn(NamedTuple):
    """An input in the rows of a block: its numbers, and the kind of each, or the one kind of all."""

    column: Column
    kinds: int | NDArray[np.int_]

    def kind(self, row: int) -> int:
        return self.kinds if isinstance(self.kinds, int) else int(self.kinds[row])


def input_columns(given: Mapping[str, GivenColumn]) -> dict[str, InputColumn]:
    """The inputs of a block, with the kinds of their numbers."""
    return {name: InputColumn(one.column, _kinds(name, given)) for name, one in given.items()}


def _kinds(name: str, given: Mapping[str, GivenColumn]) -> int | NDArray[np.int_]:
    """The kind of each number of an input, or the one kind of all.

    The equations take I as the mass I/R² and the axle's friction as the mass f/g. So these must be within the
    window too.
    """
    (column, absent), (low, high) = given[name], WINDOW
    if absent is not None and absent.all():
        return ABSENT
    sizes = [column]
    if name == "I":
        sizes.append(column / given["R"].column / given["R"].column)
    if name == "axle":
        sizes.append(column / given["g"].column)
    if absent is None and all(low < size.min() and size.max() < high for size in sizes):
        return USUAL
    is_kind = [
        *([] if absent is None else [(ABSENT, absent)]),
        (NAN, np.isnan(column)),
        (NEGATIVE, column < 0),
        (ZERO, column == 0),
        (INFINITE, column == inf),
        *((FAR, (size <= low) | (size >= high)) for size in sizes),
    ]
    kinds = np.array(USUAL)
    for kind, rows in reversed(is_kind):  # the first kind overwrites the others
        if rows.any():
            kinds = np.where(rows, kind, kinds)
    return kinds if kinds.ndim else int(kinds)


def groups(inputs: Mapping[str, InputColumn], size: int) -> Iterator[tuple[Index, int, Pattern | None, bool]]:
    """A block's rows, grouped by pattern, and whether an input of the group is beyond the window.

    Each group comes with its status; where that is no valid one, without a pattern.
    """
    m1, m2, mu, mu_k = (inputs[name].column for name in ("m1", "m2", "mu", "mu_k"))
    digits: list[tuple[int, NDArray[Any]]] = [
        (len(KINDS), one.kinds) for one in inputs.values() if not isinstance(one.kinds, int)
    ]
    above = np.array(False) if inputs["mu_k"].kinds is ABSENT else mu_k > mu
    if not (m2 > m1).all():
        digits.append((3, 1 * (m1 > m2) + 2 * (m1 == m2)))
    if above.any():
        digits.append((2, above))
    key, place = np.zeros(1, np.int64), 1
    for base, digit in digits:
        key, place = key + place * digit, place * base
    key = np.broadcast_to(key, size)
    for one in np.unique(key) if digits else key[:1]:
        index = np.flatnonzero(key == one) if digits else slice(0, size)
        row = 0 if isinstance(index, slice) else int(index[0])
        kinds = {name: one.kind(row) for name, one in inputs.items()}
        if status := STATUSES.index(_fault(kinds, bool(_at(above, row)))):
            yield index, status, None, False
            continue
        pattern = {name: _in_pattern(name, kinds[name], one.column) for name, one in inputs.items()}
        if pattern["I"] is not None:
            pattern["inertia"] = None
        sign = int(_at(m2, row) > _at(m1, row)) - int(_at(m2, row) < _at(m1, row))
        yield index, status, Pattern(sign, tuple(pattern.values())), FAR in kinds.values()


def _at(column: NDArray[Any], row: int) -> Any:
    """The item of a row."""
    return column[row] if column.ndim else column[()]


def _fault(kinds: Mapping[str, int], mu_k_above_mu: bool) -> str:
    """The first fault of inputs of these kinds: whether they are in their domains and go together."""
    given = {name for name, kind in kinds.items() if kind != ABSENT}
    zero = {name for name, kind in kinds.items() if kind == ZERO}
    faults = [
        *(("NaN", kind == NAN) for kind in kinds.values()),
        *((name, kind in OUTSIDE[name]) for name, kind in kinds.items()),
        *((name, name not in given) for name in MASSES),
        ("I and inertia", given >= {"I", "inertia"}),
        ("no mass", zero >= {"m1", "m2"}),
        ("friction at a free end", bool(zero & {"m1", "m2"}) and "mu" in given),
        ("mu_k without mu", "mu_k" in given and "mu" not in given),
        ("mu_k above mu", mu_k_above_mu),
        ("I without R", "I" in given and "R" not in given),
        ("I with M = 0 or inf", "I" in given and kinds["M"] in (ZERO, INFINITE)),
        ("valid", True),
    ]
    return next(fault for fault, is_so in faults if is_so)


def _in_pattern(name: str, kind: int, column: Column) -> Fraction | float | str | None:
    """An input in the `Pattern` of a row."""
    if kind in SAME_IN_ALL and not (kind == ABSENT and name in DEFAULTS):
        return None if name == "axle" else SAME_IN_ALL[kind]  # no friction is no axle
    return Fraction(float(column)) if name in SHAPES and not column.ndim else COLUMN
