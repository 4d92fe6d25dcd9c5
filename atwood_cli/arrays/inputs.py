"""What is given: columns of doubles, the faults of each row, and the rows that are solved together."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping, Sequence
from decimal import Decimal
from fractions import Fraction
from math import inf, nan
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..model.quantities import Accuracy
from ..model.scene import INPUTS, MASSES, SceneError
from .double_double import WINDOW
from .plan import COLUMN, Pattern
from .rows import Index
from .tables import Column

Numbers = ArrayLike | Sequence[str | float | Decimal | Fraction | None]
"""What a column may be: whatever NumPy makes an array of. A data frame's column is one too."""
DEFAULTS = {"g": 9.80665, "inertia": 0.5, "wrap": 180.0}
"""Inputs that always have a value."""
WHERE_ABSENT = DEFAULTS | {"axle": 0.0}
"""What stands for an input in rows where it is not given; NaN for the others."""
FAST_WINDOW = 2.0**-250, 2.0**250  # beyond it, intermediate values may overflow though results do not
SHAPES = ("inertia", "wrap")
"""Inputs whose common value is built into a program: with 1/2 and π it is simpler than with a column."""
REAL = "biufOSU"
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
        return column.reshape(1)
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
    if column is None:
        raise SceneError(name, None, f"must be real numbers, not {array.dtype}")
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
    """Where nothing is given: what is masked, None, and a missing value of a data frame's column.

    A NaN is none of these, nor in a pandas column of NumPy's own type, where it may be meant as one.
    """
    absent: Any = None
    if isinstance(value, np.ma.MaskedArray):
        absent = np.ma.getmaskarray(value)
    elif hasattr(value, "is_null"):  # polars and Arrow
        absent = np.asarray(value.is_null(), np.bool_)
    elif hasattr(value, "isna") and not isinstance(value.dtype, np.dtype):  # pandas
        absent = np.asarray(value.isna(), np.bool_)
    if array.dtype == object:
        missing = getattr(sys.modules.get("pandas"), "NA", None)
        is_missing = np.frompyfunc(lambda one: one is None or one is missing, 1, 1)
        nothing = np.asarray(is_missing(array), np.bool_)
        absent = nothing if absent is None else absent | nothing
    return None if absent is None or not absent.any() else absent


# The pattern of each row's inputs

USUAL, ABSENT, ZERO, INFINITE, FAR = range(5)


class InputColumn(NamedTuple):
    """An input in the rows of a block: its column, and the kind of each number, or just USUAL if all are."""

    name: str
    column: Column
    kinds: Any
    absent: NDArray[np.bool_] | None

    @property
    def given(self) -> Any:
        """In which rows it is given."""
        return np.array(True) if self.absent is None else ~self.absent

    @property
    def faults(self) -> Any:
        """Which rows are outside the parameter's domain."""
        may_be = [USUAL, ABSENT, FAR, *[ZERO] * INPUTS[self.name].zero, *[INFINITE] * INPUTS[self.name].inf]
        return ~np.isin(self.kinds, may_be) | (self.column < 0)

    def kind(self, row: int) -> Any:
        return self.kinds if self.kinds is USUAL else self.kinds[0 if self.kinds.size == 1 else row]

    def in_pattern(self, row: int) -> Any:
        """This input in the `Pattern` of a row."""
        kind = self.kind(row)
        if kind == ABSENT or (kind == ZERO and self.name == "axle"):  # no friction is no axle
            return None
        if kind == INFINITE:
            return inf
        if kind == ZERO:
            return Fraction(0)
        return Fraction(float(self.column[0])) if self.column.size == 1 and self.name in SHAPES else COLUMN


def input_columns(given: Mapping[str, GivenColumn], accuracy: Accuracy) -> dict[str, InputColumn]:
    """The inputs of a block, with the kinds of their numbers.

    The equations take I as the mass I/R² and the axle's friction as the mass f/g. So these must be within the
    window too.
    """
    low, high = FAST_WINDOW if accuracy == "fast" else WINDOW
    columns = {}
    for name, (column, absent) in given.items():
        sizes = [column]
        if name == "I" and "R" in given:
            sizes.append(column / given["R"].column / given["R"].column)
        if name == "axle":
            sizes.append(column / given["g"].column)
        if all(low < size.min() and size.max() < high for size in sizes):
            kinds: Any = USUAL
        else:
            kinds = ZERO * (column == 0) + INFINITE * (column == inf)
            for size in sizes:
                kinds = np.where((kinds == USUAL) & ((size <= low) | (size >= high)), FAR, kinds)
            if absent is not None and name not in WHERE_ABSENT:
                kinds = np.where(absent, ABSENT, kinds)
        columns[name] = InputColumn(name, column, kinds, absent)
    return columns


def status_of(inputs: Mapping[str, InputColumn], size: int) -> NDArray[np.int8]:
    """The index into STATUSES for each row: whether its inputs are in their domains and go together."""

    def given(name: str) -> Any:
        return inputs[name].given if name in inputs else np.array(False)

    def column(name: str) -> Column:
        return inputs[name].column if name in inputs else np.array(nan)

    unusual = {name: one for name, one in inputs.items() if one.kinds is not USUAL}
    faults = [("NaN", np.isnan(one.column) & (one.kinds != ABSENT)) for one in unusual.values()]
    faults += [(name, one.faults) for name, one in unusual.items()]
    faults += [(name, ~given(name)) for name in MASSES if inputs[name].absent is not None]
    if "I" in inputs:
        faults.append(("I and inertia", given("I") & given("inertia")))
    if not unusual.keys().isdisjoint(MASSES):
        m1, m2 = column("m1"), column("m2")
        faults.append(("no mass", (m1 == 0) & (m2 == 0)))
        faults.append(("friction at a free end", ((m1 == 0) | (m2 == 0)) & given("mu")))
    if "mu_k" in inputs:
        faults.append(("mu_k without mu", given("mu_k") & ~given("mu")))
        faults.append(("mu_k above mu", column("mu_k") > column("mu")))
    if "I" in inputs:
        faults.append(("I without R", given("I") & ~given("R")))
        faults.append(("I with M = 0 or inf", given("I") & ((column("M") == 0) | (column("M") == inf))))
    status = np.zeros(size, np.int8)
    for fault, rows in reversed(faults):  # the first fault overwrites the others
        status[np.broadcast_to(rows, size)] = STATUSES.index(fault)
    return status


def groups(
    inputs: Mapping[str, InputColumn], status: NDArray[np.int8]
) -> Iterator[tuple[Index, Pattern, bool]]:
    """A block's valid rows, grouped by pattern, and whether an input of the group is beyond the window."""
    size, (m1, m2) = len(status), (inputs["m1"].column, inputs["m2"].column)
    digits = [(5, one.kinds) for one in inputs.values() if one.kinds is not USUAL]
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
        pattern = dict.fromkeys(INPUTS) | {name: of.in_pattern(row) for name, of in inputs.items()}
        if pattern["I"] is not None:
            pattern["inertia"] = None
        far = any(of.kind(row) == FAR for of in inputs.values())
        light, heavy = (float(np.broadcast_to(mass, size)[row]) for mass in (m1, m2))
        yield index, Pattern((heavy > light) - (heavy < light), tuple(pattern.values())), far
