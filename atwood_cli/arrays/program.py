"""Formulas are compiled to programs: lists of NumPy operations, run on tiles of rows that fit the cache.

A `Program` is made from the formulas of its results. An expression that occurs twice is computed once, and
the column of an intermediate value is used again after the value's last use.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from threading import local
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..numbers.formula import Formula, Term, formula
from .doubles import Column
from .pairs import cos_sin_in_doubles

Operation = Callable[..., Any]
Value = tuple[str, tuple[Any, ...]]
"""An operation and the numbers of its operands' values; or "symbol" or "number" and what it holds."""
HEAD_MASK = -1 << 27
"""The bits of a double without the last 27 of its mantissa's 53."""


def _head(x: Column, out: Column) -> None:
    bits = out.view(np.int64)
    np.add(x.view(np.int64), -HEAD_MASK >> 1, out=bits)  # adds half of the last bit that stays, to round
    np.bitwise_and(bits, HEAD_MASK, out=bits)


def _take(index: NDArray[np.intp], table: Column, out: Column) -> None:
    """Take entries of a table; an index beyond an end gives the entry there."""
    table.take(index, out=out, mode="clip")


def _copy(x: NDArray[Any], out: NDArray[Any]) -> None:
    out[:] = x


def _where(condition: NDArray[np.bool_], x: Column, y: Column, out: Column) -> None:
    out[:] = y
    np.copyto(out, x, where=condition)


def _with_keyword(operation: Operation) -> Operation:
    """Return an operation of two columns whose result NumPy takes only by keyword."""
    return lambda x, y, out: operation(x, y, out=out)


def _power(exponent: NDArray[np.intp], out: Column) -> None:
    np.ldexp(1.0, exponent.astype(np.intc), out=out)


def _of_degrees(which: int) -> Operation:
    """Return the operation for one double of `cos_sin_in_doubles`; it computes equal angles once."""

    def operation(degrees: Column, out: Column) -> None:
        angles, places = np.unique(degrees, return_inverse=True)
        out[:] = np.array([cos_sin_in_doubles(angle)[which] for angle in angles.tolist()])[places]

    return operation


OPERATIONS: dict[str, Operation] = {
    **{name: getattr(np, name) for name in "sqrt expm1 log1p cos sin rint floor fmod".split()},
    **{"+": np.add, "-": np.subtract, "*": np.multiply, "/": np.divide, "abs": np.absolute},
    **{"<": np.less, "<=": np.less_equal, "==": np.equal, "and": np.logical_and, "or": np.logical_or},
    **{"bits": np.bitwise_and, ">>": np.right_shift, "int": _copy, "head": _head, "power": _power},
    **{"maximum": _with_keyword(np.maximum), "minimum": _with_keyword(np.minimum)},
    **{"where": _where, "take": _take},
    **{"cos°": _of_degrees(0), "rest of cos°": _of_degrees(1)},
    **{"sin°": _of_degrees(2), "rest of sin°": _of_degrees(3)},
}
RESULT_TYPES: dict[str, type[Any]] = {
    **dict.fromkeys(("<", "<=", "==", "and", "or"), np.bool_),
    **dict.fromkeys(("int", "bits", ">>"), np.intp),
}
"""The types of operations' results that are not doubles."""
COMMUTATIVE = {"+", "*"}
NOT_IN_PLACE = ("where", "take")
"""Operations that write results before they have read all operands."""


_OF_THREAD = local()


def columns_for(types: Iterable[type[Any]], size: int) -> list[NDArray[Any]]:
    """Return columns of these types for intermediate values; a thread gets the same ones in its next call.

    New ones would be new pages of memory at each call, which take half as long as the work in them.
    """
    kept: dict[tuple[int, type[Any]], NDArray[Any]] = vars(_OF_THREAD).setdefault("columns", {})
    columns = []
    for place, type_ in enumerate(types):
        column = kept.get((place, type_))
        if column is None or column.size < size:
            column = kept[place, type_] = np.empty(size, type_)
        columns.append(column[:size])
    return columns


class Program:
    """The operations that compute ``results``, by their names, from ``inputs``, the names of columns.

    Operations read and write numbered slots. The slots of inputs, constants and results come first. Those of
    intermediate values follow, whose types are ``between``.
    """

    def __init__(self, results: Mapping[str, Term]) -> None:
        values, wanted = _numbered(map(formula, results.values()))
        self.results = tuple(results)
        # Inputs and constants have the first slots, as they are there before any operation.
        inputs, constants = (
            [value for value, (op, _) in enumerate(values) if op == leaf] for leaf in ("symbol", "number")
        )
        self.inputs: list[str] = [values[value][1][0] for value in inputs]
        self.constants = [values[value][1][0] for value in constants]
        slots = {value: slot for slot, value in enumerate([*inputs, *constants])}
        leaves, copies = set(slots), []
        # Each result has the next slot, in which its value is computed. A value that is there already, as an
        # input or another result, is copied in the end.
        for slot, value in enumerate(wanted, len(leaves)):
            if value in slots:
                copies.append((_copy, (slots[value], slot)))
            else:
                slots[value] = slot
        self.between: list[type[Any]] = []
        self.operations = [*self._operations(values, leaves, slots, len(leaves) + len(wanted)), *copies]

    def _operations(
        self, values: Sequence[Value], leaves: set[int], slots: dict[int, int], first_between: int
    ) -> Iterator[tuple[Operation, tuple[int, ...]]]:
        """Yield the operations with their slots: operands first, the result last."""
        fixed, free = set(slots), dict[type[Any], list[int]]()
        operations = [value for value in range(len(values)) if value not in leaves]
        last_use = {part: value for value in operations for part in values[value][1]}
        types = [RESULT_TYPES.get(op, np.float64) for op, _ in values]
        for value in operations:
            op, parts = values[value]
            # After the last use of an intermediate value its slot is free. Most operations may write in it.
            ended = dict.fromkeys(part for part in parts if last_use[part] == value and part not in fixed)
            in_place = op not in NOT_IN_PLACE
            for part in ended if in_place else ():
                free.setdefault(types[part], []).append(slots[part])
            # The result takes a free slot of its type, or a new one.
            if value not in slots:
                if not free.get(types[value]):
                    free[types[value]] = [first_between + len(self.between)]
                    self.between.append(types[value])
                slots[value] = free[types[value]].pop()
            # The other operations still read their operands while they write.
            for part in () if in_place else ended:
                free.setdefault(types[part], []).append(slots[part])
            yield OPERATIONS[op], (*[slots[part] for part in parts], slots[value])

    def run(
        self,
        inputs: Mapping[str, Column],
        results: Mapping[str, NDArray[Any]],
        between: Iterable[NDArray[Any]],
    ) -> None:
        """Write the results of these inputs; ``between`` are columns for intermediate values."""
        read, written = [inputs[name] for name in self.inputs], [results[name] for name in self.results]
        columns = [*read, *self.constants, *written, *between]
        # Operands are looked up first: Python code between two operations would keep other threads waiting.
        calls = [(operation, [columns[slot] for slot in slots]) for operation, slots in self.operations]
        for operation, operands in calls:
            operation(*operands)


def _numbered(results: Iterable[Formula]) -> tuple[list[Value], list[int]]:
    """Return the distinct values in formulas, operands first, and the number of each formula's value."""
    values: list[Value] = []
    numbers: dict[Value, int] = {}
    number_of: dict[Formula, int] = {}

    def number(op: str, parts: tuple[Any, ...], key: Any = None) -> int:
        place = numbers.setdefault((op, parts if key is None else key), len(values))
        if place == len(values):
            values.append((op, parts))
        return place

    def constant(value: Any) -> int:
        return number(
            "number", (np.asarray(value),), id(value) if isinstance(value, np.ndarray) else repr(value)
        )

    def number_by_operands(node: Formula) -> int:
        if node.op == "symbol":
            return number("symbol", node.parts)
        if node.op == "number":
            return constant(float(node.parts[0]))
        parts = [number_of[part] if isinstance(part, Formula) else constant(part) for part in node.parts]
        return number(node.op, tuple(sorted(parts) if node.op in COMMUTATIVE else parts))

    wanted = []
    for result in results:
        waiting = [result]
        while waiting:  # formulas are too deep for recursion
            top = waiting[-1]
            missing = [part for part in top.parts if isinstance(part, Formula) and part not in number_of]
            waiting += reversed(missing)
            if not missing:
                number_of[waiting.pop()] = number_by_operands(top)
        wanted.append(number_of[result])
    return values, wanted
