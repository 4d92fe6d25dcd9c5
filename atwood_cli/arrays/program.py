"""Formulas compiled to programs: lists of NumPy operations, run on tiles of rows that fit the cache.

A `Program` is made from the formulas of its results. A subexpression that occurs twice is computed once, and
a temporary column is reused after its last use.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arithmetic.symbolic import Formula, Term, formula
from .expansion import NOTHING
from .tables import HEAD, Column

Operation = Callable[..., Any]


def _head(x: Column, out: Column) -> None:
    np.bitwise_and(x.view(np.int64), HEAD, out=out.view(np.int64))


def _take(index: NDArray[np.intp], table: Column, out: Column) -> None:
    table.take(index, out=out, mode="clip")


def _copy(x: NDArray[Any], out: NDArray[Any]) -> None:
    out[:] = x


def _integer(x: Column, out: NDArray[np.intp]) -> None:
    out[:] = x


def _where(condition: NDArray[np.bool_], x: Column, y: Column, out: Column) -> None:
    out[:] = y
    np.copyto(out, x, where=condition)


def _maximum(x: Column, y: Column, out: Column) -> None:
    np.maximum(x, y, out=out)  # NumPy deprecates giving it in third place


def _minimum(x: Column, y: Column, out: Column) -> None:
    np.minimum(x, y, out=out)


def _mantissa(x: Column, out: Column) -> None:
    out[:] = np.frexp(x)[0]


def _exponent(x: Column, out: Column) -> None:
    out[:] = np.frexp(x)[1]
    np.copyto(out, NOTHING, where=x == 0)


def _power(exponent: Column, out: Column) -> None:
    POWERS.take((exponent + 1075.0).astype(np.intp), out=out, mode="clip")


POWERS = np.array([0.0, *(2.0**e for e in range(-1074, 1024))])
"""2^e from e = -1075, where it is 0 as no double is so small, to e = 1023."""


OPERATIONS: dict[str, Operation] = {
    "+": np.add,
    "-": np.subtract,
    "*": np.multiply,
    "/": np.divide,
    "sqrt": np.sqrt,
    "exp": np.exp,
    "expm1": np.expm1,
    "log": np.log,
    "log1p": np.log1p,
    "cos": np.cos,
    "sin": np.sin,
    "abs": np.absolute,
    "rint": np.rint,
    "floor": np.floor,
    "fmod": np.fmod,
    "<": np.less,
    "<=": np.less_equal,
    "==": np.equal,
    "and": np.logical_and,
    "or": np.logical_or,
    "finite": np.isfinite,
    "bits": np.bitwise_and,
    ">>": np.right_shift,
    "maximum": _maximum,
    "minimum": _minimum,
    "where": _where,
    "take": _take,
    "int": _integer,
    "head": _head,
    "mantissa": _mantissa,
    "exponent": _exponent,
    "power": _power,
}
KINDS: dict[str, type[Any]] = dict.fromkeys(
    ("<", "<=", "==", "and", "or", "finite"), np.bool_
) | dict.fromkeys(("int", "bits", ">>"), np.intp)
"""The type of an operation's results, if they are not doubles."""
NOT_IN_PLACE = ("where", "take", "exponent")
"""Operations that write results before they have read all operands."""


class Room:
    """Columns for intermediate values, kept from tile to tile. Each thread needs its own."""

    def __init__(self) -> None:
        self._kept: dict[tuple[type[Any], int], NDArray[Any]] = {}

    def columns(self, kinds: Sequence[type[Any]], size: int) -> list[NDArray[Any]]:
        """A column of each of those types; the same ones again in the next call."""
        count: dict[type[Any], int] = {}
        columns = []
        for kind in kinds:
            place = kind, count.setdefault(kind, 0)
            count[kind] += 1
            if place not in self._kept or self._kept[place].size < size:
                self._kept[place] = np.empty(size, kind)
            columns.append(self._kept[place][:size])
        return columns


class Program:
    """The operations that compute ``results`` from ``inputs``, which are names of columns.

    Operations read and write numbered slots. The slots of inputs, constants and results come first, then
    those of intermediate values, whose types are ``between``.
    """

    def __init__(self, results: Sequence[Term]) -> None:
        values = _Values()
        wanted = [values.number(formula(result)) for result in results]
        inputs, constants = (
            [n for n, (op, _) in enumerate(values.all) if op == kind] for kind in ("symbol", "number")
        )
        self.inputs = [values.all[n][1][0] for n in inputs]
        self.constants = [values.all[n][1][0] for n in constants]
        slots = {n: slot for slot, n in enumerate([*inputs, *constants])}
        leaves = set(slots)
        copies = []
        for slot, n in enumerate(wanted, len(leaves)):
            if n in slots:
                copies.append((_copy, (slots[n], slot)))
            else:
                slots[n] = slot
        self.between: list[type[Any]] = []
        self.operations: list[tuple[Operation, tuple[int, ...]]] = []
        fixed, first = set(slots), len(leaves) + len(wanted)
        free: dict[type[Any], list[int]] = {}
        last_use = {part: n for n, (_, parts) in enumerate(values.all) if n not in leaves for part in parts}
        kinds = [KINDS.get(op, np.float64) for op, _ in values.all]
        for n, (op, parts) in enumerate(values.all):
            if n in leaves:
                continue
            done = [part for part in parts if last_use[part] == n and part not in fixed]
            if len(done) > 1:
                done = list(dict.fromkeys(done))
            in_place = op not in NOT_IN_PLACE
            for part in done if in_place else ():
                free.setdefault(kinds[part], []).append(slots[part])
            if n not in slots:
                kind = kinds[n]
                if not free.get(kind):
                    free[kind] = [first + len(self.between)]
                    self.between.append(kind)
                slots[n] = free[kind].pop()
            for part in () if in_place else done:
                free.setdefault(kinds[part], []).append(slots[part])
            self.operations.append((OPERATIONS[op], (*[slots[part] for part in parts], slots[n])))
        self.operations += copies

    def run(
        self, inputs: Sequence[Column], results: Sequence[NDArray[Any]], between: Sequence[NDArray[Any]]
    ) -> None:
        """Write the results of these inputs; ``between`` are columns for intermediate values."""
        at = [*inputs, *self.constants, *results, *between]
        # Look up operands first: Python code between two operations would keep other threads waiting.
        bound = [(operation, [at[slot] for slot in slots]) for operation, slots in self.operations]
        for operation, columns in bound:
            operation(*columns)


class _Values:
    """The distinct values in formulas, numbered so that operands come before their operations."""

    def __init__(self) -> None:
        self.all: list[tuple[str, tuple[Any, ...]]] = []
        self._numbers: dict[tuple[str, tuple[Any, ...]], int] = {}
        self._of: dict[Formula, int] = {}

    def number(self, root: Formula) -> int:
        """The number of a formula's value. Formulas are too deep for recursion."""
        numbers, waiting = self._of, [root]
        while waiting:
            one = waiting[-1]
            if one in numbers:
                waiting.pop()
                continue
            missing = [part for part in one.parts if isinstance(part, Formula) and part not in numbers]
            if missing:
                waiting += reversed(missing)
            else:
                numbers[waiting.pop()] = self._numbered(one)
        return numbers[root]

    def _numbered(self, one: Formula) -> int:
        if one.op == "symbol":
            return self._kept("symbol", one.parts)
        if one.op == "number":
            return self._constant(float(one.parts[0]))
        numbers = self._of
        parts = [numbers[part] if isinstance(part, Formula) else self._constant(part) for part in one.parts]
        return self._kept(one.op, tuple(sorted(parts) if one.op in "+*" else parts))

    def _constant(self, value: Any) -> int:
        if isinstance(value, np.ndarray):  # a table
            return self._kept("number", (value,), id(value))
        return self._kept("number", (np.array(value),), (str(float(value)), type(value) is int))

    def _kept(self, op: str, parts: tuple[Any, ...], key: Any = None) -> int:
        key = op, parts if key is None else key
        number = self._numbers.setdefault(key, len(self.all))
        if number == len(self.all):
            self.all.append((op, parts))
        return number
