"""Formulas compiled to programs: lists of NumPy operations, run on tiles of rows that fit the cache.

A `Program` is made from the formulas of its results. A subexpression that occurs twice is computed once, and
a temporary column is reused after its last use.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from threading import local
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arithmetic.symbolic import Formula, Term, formula
from .constants import cos_sin_in_doubles
from .pattern import Column

Operation = Callable[..., Any]
HEAD = -1 << 27  # masks the last 27 of the 53 bits of a double


def _head(x: Column, out: Column) -> None:
    bits = out.view(np.int64)
    np.add(x.view(np.int64), -HEAD >> 1, out=bits)  # half of the last bit that stays: its size is rounded
    np.bitwise_and(bits, HEAD, out=bits)


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


def _power(exponent: NDArray[np.intp], out: Column) -> None:
    np.ldexp(1.0, exponent.astype(np.intc), out=out)


def _of_degrees(part: int) -> Operation:
    """One of the doubles of `cos_sin_in_doubles`: each angle that occurs is computed once, to 70 digits."""

    def operation(degrees: Column, out: Column) -> None:
        angles, places = np.unique(degrees, return_inverse=True)
        out[:] = np.array([cos_sin_in_doubles(angle)[part] for angle in angles.tolist()])[places]

    return operation


OPERATIONS: dict[str, Operation] = {
    "+": np.add,
    "-": np.subtract,
    "*": np.multiply,
    "/": np.divide,
    "sqrt": np.sqrt,
    "expm1": np.expm1,
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
    "bits": np.bitwise_and,
    ">>": np.right_shift,
    "maximum": _maximum,
    "minimum": _minimum,
    "where": _where,
    "take": _take,
    "int": _integer,
    "head": _head,
    "power": _power,
    "cos°": _of_degrees(0),
    "rest of cos°": _of_degrees(1),
    "sin°": _of_degrees(2),
    "rest of sin°": _of_degrees(3),
}
KINDS: dict[str, type[Any]] = dict.fromkeys(("<", "<=", "==", "and", "or"), np.bool_) | dict.fromkeys(
    ("int", "bits", ">>"), np.intp
)
"""The type of an operation's results, if they are not doubles."""
NOT_IN_PLACE = ("where", "take")
"""Operations that write results before they have read all operands."""


_KEPT = local()


def columns_for(kinds: Iterable[type[Any]], size: int) -> list[NDArray[Any]]:
    """Columns for intermediate values, of each of those types: a thread gets the same ones in its next call.

    New ones would be new pages of memory each time, which takes as long as half of what is computed in them.
    """
    kept: dict[tuple[int, type[Any]], NDArray[Any]] = vars(_KEPT).setdefault("columns", {})
    columns = []
    for place in enumerate(kinds):
        if place not in kept or kept[place].size < size:
            kept[place] = np.empty(size, place[1])
        columns.append(kept[place][:size])
    return columns


class Program:
    """The operations that compute ``results``, by their names, from ``inputs``, the names of columns.

    Operations read and write numbered slots. The slots of inputs, constants and results come first, then
    those of intermediate values, whose types are ``between``.
    """

    def __init__(self, results: Mapping[str, Term]) -> None:
        values = _Values()
        wanted = [values.number(formula(result)) for result in results.values()]
        self.results = tuple(results)
        inputs, constants = (
            [n for n, (op, _) in enumerate(values.all) if op == kind] for kind in ("symbol", "number")
        )
        self.inputs: list[str] = [values.all[n][1][0] for n in inputs]
        self.constants = [values.all[n][1][0] for n in constants]
        slots = {n: slot for slot, n in enumerate([*inputs, *constants])}
        leaves, copies = set(slots), []
        for slot, n in enumerate(wanted, len(leaves)):
            if n in slots:
                copies.append((_copy, (slots[n], slot)))
            else:
                slots[n] = slot
        self.between: list[type[Any]] = []
        self.operations = [*self._operations(values, leaves, slots, len(leaves) + len(wanted)), *copies]

    def _operations(
        self, values: _Values, leaves: set[int], slots: dict[int, int], first: int
    ) -> Iterator[tuple[Operation, tuple[int, ...]]]:
        """The operations with their slots. A slot is free after the last use of its value."""
        fixed, free = set(slots), dict[type[Any], list[int]]()
        last_use = {part: n for n, (_, parts) in enumerate(values.all) if n not in leaves for part in parts}
        kinds = [KINDS.get(op, np.float64) for op, _ in values.all]
        for n, (op, parts) in enumerate(values.all):
            if n in leaves:
                continue
            done = dict.fromkeys(part for part in parts if last_use[part] == n and part not in fixed)
            in_place = op not in NOT_IN_PLACE
            for part in done if in_place else ():
                free.setdefault(kinds[part], []).append(slots[part])
            if n not in slots:
                if not free.get(kinds[n]):
                    free[kinds[n]] = [first + len(self.between)]
                    self.between.append(kinds[n])
                slots[n] = free[kinds[n]].pop()
            for part in () if in_place else done:
                free.setdefault(kinds[part], []).append(slots[part])
            yield OPERATIONS[op], (*[slots[part] for part in parts], slots[n])

    def run(
        self,
        inputs: Mapping[str, Column],
        results: Mapping[str, NDArray[Any]],
        between: Iterable[NDArray[Any]],
    ) -> None:
        """Write the results of these inputs; ``between`` are columns for intermediate values."""
        given, found = [inputs[name] for name in self.inputs], [results[name] for name in self.results]
        at = [*given, *self.constants, *found, *between]
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
