"""What is given: columns of doubles, the faults of each row, and the rows that are solved together."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from decimal import Decimal
from enum import IntEnum
from fractions import Fraction
from math import inf, isnan, nan
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..reading.inputs import is_missing, read_exactly
from ..solver.scene import (
    COLUMNS,
    DEFAULTS,
    FALL,
    INERTIA_FACTORS,
    MASSES,
    Scene,
    SceneError,
    Terms,
    Unit,
    in_own_terms,
)
from .doubles import WINDOW, Column
from .plan import COLUMN, Pattern

Index = slice | NDArray[np.intp]
"""A selection of rows, in ascending order."""
Numbers = ArrayLike | Sequence[str | float | Decimal | Fraction | None]
"""The types that a column may have: whatever NumPy makes an array of, as columns of polars and pandas."""
DISK = INERTIA_FACTORS["disk"]
IF_ABSENT = {name: Fraction(default) for name, default in {**DEFAULTS, "inertia": DISK}.items()}
"""The exact values of inputs that always have one, in SI units and degrees."""
ABSENT = {name: read_exactly(name, None) for name in COLUMNS}
"""Inputs as they are read in rows in which they are not given."""
WHERE_ABSENT = {**{name: float(default) for name, default in IF_ABSENT.items()}, "axle": 0.0}
"""The doubles in columns of inputs for rows in which they are not given; for other inputs it is NaN."""
NEARLY_EQUAL = 1e-14
"""The share of a mass by which doubles cannot tell a weight's mass from another mass."""
BUILT_IN = ("inertia", "wrap")
"""Inputs whose common value is built into a program: with 1/2 and π it is simpler than with a column."""
REAL_KINDS = "iufOSU"
"""NumPy's kinds of arrays that may hold real numbers. NumPy would convert some other kinds, too."""
STATUSES = (
    *("valid", "m1", "m2", "M", "mu", "mu_k", "g", "inertia", "R", "wrap"),
    *("no mass", "friction at a free end", "mu_k without mu", "mu_k above mu"),
    *("NaN", "I", "axle", "I and inertia", "I without R", "I with M = 0 or inf"),
    *(*FALL, "two of drop, time and speed"),
)
"""The meanings of the codes in ``status``: an input that is outside its domain (or a mass that is not given),
inputs that do not go together, or one that is not a number."""
VALID = STATUSES.index("valid")


class GivenColumn(NamedTuple):
    """The doubles of an input, and the rows in which it is not given; None if it is given in all."""

    doubles: Column
    absent: NDArray[np.bool_] | None

    def cut(self, shape: tuple[int, ...], rows: Index) -> GivenColumn:
        """Return rows of the column as if it were broadcast and flat; a single number stays single."""
        absent = None if self.absent is None else _cut(self.absent, shape, rows)
        return GivenColumn(_cut(self.doubles, shape, rows), absent)

    def lacks(self, row: int) -> bool:
        """Decide whether the input is not given in a row."""
        return self.absent is not None and bool(_number(self.absent, row))


def _cut(column: NDArray[Any], shape: tuple[int, ...], rows: Index) -> NDArray[Any]:
    if column.size == 1:
        return column.reshape(())
    if column.shape == shape and column.flags.c_contiguous:
        return column.reshape(-1)[rows]
    return np.broadcast_to(column, shape).flat[rows]


def read_column(name: str, value: Numbers | None) -> GivenColumn:
    """Return an input as doubles.

    Raises SceneError for what is no real number, and for another number than 0 or inf that would round to one
    of these.
    """
    default = WHERE_ABSENT.get(name, nan)
    if is_missing(value):
        return GivenColumn(np.array(default), np.array(True))
    try:
        kind_of_items = object if _holds_masked(value) else None
        array = value.data if isinstance(value, np.ma.MaskedArray) else np.asarray(value, kind_of_items)
        is_text = array.dtype.kind in "SU"  # as objects, so that an error shows 'x', not np.str_('x')
        plain = array.astype(object) if is_text else array
        absent = _absent(value, plain)
        if absent is not None and plain.dtype == object:
            plain = np.where(absent, nan, plain)
        with np.errstate(over="ignore"):
            doubles: Any = plain.astype(np.float64, copy=False) if array.dtype.kind in REAL_KINDS else None
    except (TypeError, ValueError, OverflowError) as error:
        raise SceneError(name, None, f"must be real numbers: {error}") from None
    items: Any = plain.flat if plain.dtype == object else ()
    if isinstance(value, list | tuple):
        items = value
    if doubles is None or any(isinstance(item, bool | np.bool_) for item in items):
        kind = array.dtype if doubles is None else "bool"
        raise SceneError(name, None, f"must be real numbers, not {kind}")
    if absent is not None:
        doubles = np.where(absent, default, doubles)
    if not np.can_cast(array.dtype, np.float64):
        is_end = np.isinf(doubles) | (doubles == 0)
        is_end &= True if absent is None else ~absent
        for number, double in zip(plain[is_end], doubles[is_end], strict=True):
            exact = number.decode() if isinstance(number, bytes) else number
            if (Decimal(exact) if isinstance(exact, str) else exact) != double:
                raise SceneError(name, str(exact), "is beyond the range of doubles")
    return GivenColumn(doubles, absent)


def _holds_masked(value: object) -> bool:
    """Decide whether a list has an item that is masked, which NumPy would take for NaN, with a warning."""
    return isinstance(value, list | tuple) and any(x is np.ma.masked or _holds_masked(x) for x in value)


def _absent(value: Any, array: NDArray[Any]) -> NDArray[np.bool_] | None:
    """Return where items are missing: masked, None, null of polars, NA or NaN of pandas; None if nowhere."""
    absent: Any = np.array(False)
    if isinstance(value, np.ma.MaskedArray):
        absent = np.ma.getmaskarray(value)
    elif hasattr(value, "is_null"):  # polars
        absent = np.asarray(value.is_null(), np.bool_)
    elif hasattr(value, "isna"):  # pandas
        absent = np.asarray(value.isna(), np.bool_)
    if array.dtype == object:
        absent = absent | np.asarray(np.frompyfunc(is_missing, 1, 1)(array), np.bool_)
    return absent if absent.any() else None


# The pattern of each row's inputs


class Kind(IntEnum):
    """The kinds of numbers that an input may be in a row; a usual one is positive and within the window."""

    USUAL, ABSENT, NAN, NEGATIVE, ZERO, INFINITE, BEYOND_WINDOW = range(7)


SAME_IN_ALL: dict[int, Any] = {Kind.ABSENT: None, Kind.ZERO: Fraction(0), Kind.INFINITE: inf}
"""The values that stand in a `Pattern` for the numbers of a kind; for other kinds it has a column."""


class Group(NamedTuple):
    """Rows of a chunk with the same status, and of valid rows the pattern that they have in common."""

    rows: Index
    status: int
    pattern: Pattern | None
    beyond_window: bool
    """Whether an input is beyond the window of `doubles`."""


def _kinds(name: str, given: Mapping[str, GivenColumn], own: Mapping[str, Column]) -> NDArray[np.int_]:
    """Return the kind of each number of an input, or the one kind of all, without dimension.

    The equations take I as the mass I/R² and the axle's friction as the mass f/g. So these must be within the
    window, as must an input in its ``own`` terms.
    """
    (doubles, absent), (low, high) = given[name], WINDOW
    if absent is not None and absent.all():
        return np.array(Kind.ABSENT)
    sizes = [doubles] if own[name] is doubles else [doubles, own[name]]
    if name == "I":
        sizes.append(own["I"] / own["R"] / own["R"])
    if name == "axle":
        sizes.append(own[name] / own["g"])
    if absent is None and all(low < size.min() and size.max() < high for size in sizes):
        return np.array(Kind.USUAL)
    is_kind = [
        *([] if absent is None else [(Kind.ABSENT, absent)]),
        (Kind.NAN, np.isnan(doubles)),
        (Kind.NEGATIVE, doubles < 0),
        (Kind.ZERO, doubles == 0),
        (Kind.INFINITE, doubles == inf),
        *((Kind.BEYOND_WINDOW, (size <= low) | (size >= high)) for size in sizes),
    ]
    kinds = np.array(Kind.USUAL)
    for kind, rows in reversed(is_kind):  # the first kind overwrites the others
        if rows.any():
            kinds = np.where(rows, kind, kinds)
    return kinds


def _heavier(
    given: Mapping[str, GivenColumn], own: Mapping[str, Column], terms: Mapping[str, Terms], size: int
) -> NDArray[np.int_]:
    """Return 1 where m2 is the heavier mass, -1 where m1 is, else 0."""
    if terms.get("m1") == terms.get("m2"):
        m1, m2 = (given[name].doubles for name in MASSES)
        return np.array(1) if (is_m2 := m2 > m1).all() else 1 * is_m2 - (m2 < m1)
    m1, m2 = (np.broadcast_to(own[name], size) for name in MASSES)
    order = 1 * (m2 > m1) - (m2 < m1)
    of_masses = {name: terms[name] for name in MASSES if name in terms}
    for row in np.flatnonzero(np.abs(m2 - m1) <= NEARLY_EQUAL * m1).tolist():  # a weight beside a mass
        exact = in_own_terms({name: _exact(name, given[name], row) for name in (*MASSES, "g")}, of_masses)
        order[row] = (exact["m2"] > exact["m1"]) - (exact["m2"] < exact["m1"])
    return order


def _exact(name: str, given: GivenColumn, row: int) -> Fraction:
    return IF_ABSENT[name] if given.lacks(row) else Fraction(float(_number(given.doubles, row)))


def groups(given: Mapping[str, GivenColumn], size: int, terms: Mapping[str, Terms]) -> Iterator[Group]:
    """Yield the rows of a chunk, grouped by their status and pattern."""
    mu, mu_k = (given[name].doubles for name in ("mu", "mu_k"))
    own = in_own_terms({name: column.doubles for name, column in given.items()}, terms)
    columns = {name: _kinds(name, given, own) for name in given}
    heavier = _heavier(given, own, terms, size)
    mu_k_above = mu_k > mu  # to split groups: `Scene.of` has the rule. NaN, which is not given, is not above
    # Rows differ by the digits of a key, each with its base: kinds, the heavier mass, a mu_k above mu.
    digits: list[tuple[int, NDArray[Any]]] = [(len(Kind), kinds) for kinds in columns.values() if kinds.ndim]
    if not (heavier == 1).all():
        digits.append((3, heavier + 1))
    if mu_k_above.any():
        digits.append((2, mu_k_above))
    keys, weight = np.zeros(1, np.int64), 1
    for base, digit in digits:
        keys, weight = keys + weight * digit, weight * base
    keys = np.broadcast_to(keys, size)
    # A group's first row stands for all of them.
    for key in np.unique(keys) if digits else keys[:1]:
        rows = np.flatnonzero(keys == key) if digits else slice(0, size)
        row = 0 if isinstance(rows, slice) else int(rows[0])
        if status := STATUSES.index(_fault(given, row, terms)):
            yield Group(rows, status, None, False)
            continue
        kinds = {name: int(_number(column, row)) for name, column in columns.items()}
        pattern = {name: _in_pattern(name, kinds[name], column.doubles) for name, column in given.items()}
        if pattern["I"] is not None:
            pattern["inertia"] = None
        sign, beyond_window = int(_number(heavier, row)), Kind.BEYOND_WINDOW in kinds.values()
        in_terms = tuple((name, terms[name]) for name in terms if pattern[name] == COLUMN)
        yield Group(rows, status, Pattern(sign, tuple(pattern.values()), in_terms), beyond_window)


def _number(column: NDArray[Any], row: int) -> Any:
    """Return the number in a row of a column, or the single number that is the same in all rows."""
    return column[row] if column.ndim else column[()]


def _fault(given: Mapping[str, GivenColumn], row: int, terms: Mapping[str, Terms]) -> str:
    """Return the first fault of a row, as the scene of it would have it; "valid" if it has none."""
    numbers = {name: _number(column.doubles, row) for name, column in given.items() if not column.lacks(row)}
    if any(map(isnan, numbers.values())):
        return "NaN"
    try:
        read = ((name, read_exactly(name, number)) for name, number in numbers.items())
        Scene.of(ABSENT | {name: one._replace(unit=Unit(terms=terms.get(name))) for name, one in read})
    except SceneError as error:
        return error.fault
    return "valid"


def _in_pattern(name: str, kind: int, doubles: Column) -> Fraction | float | str | None:
    """Return an input in the `Pattern` of a row."""
    if kind == Kind.ABSENT and name in IF_ABSENT:
        return IF_ABSENT[name]  # exact; the doubles have the nearest one
    if kind in SAME_IN_ALL:
        return None if name == "axle" else SAME_IN_ALL[kind]  # an axle without friction is none
    return Fraction(float(doubles)) if name in BUILT_IN and not doubles.ndim else COLUMN
