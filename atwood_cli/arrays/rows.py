"""Rows are solved group by group: questions are put to them, and programs run on tiles that fit the cache.

`plan` shows by an example how a group is solved, and why. This module does it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from fractions import Fraction
from functools import partial
from math import nan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..solver.answers import Answers
from ..solver.decisions import Decisions
from ..solver.quantities import REGIMES, Accuracy
from .doubles import Column
from .inputs import Index
from .pairs import PAIRS
from .plan import LEVELS, Task, answering, condition_of, nearest_double, plan
from .program import Program, columns_for

TILE_ROWS = 65_536
"""The most rows of a tile: the columns of a program's intermediate values have as many."""
ROWS_ONE_BY_ONE = 4
"""The most rows that are solved one by one, as making a program would take longer."""

Flags = NDArray[np.bool_]


class Rows:
    """Rows: the columns of their inputs, and the columns that take their results, by name."""

    def __init__(
        self, inputs: Mapping[str, Column], results: Mapping[str, NDArray[Any]], accuracy: Accuracy
    ) -> None:
        self.inputs, self.results, self.accuracy = inputs, results, accuracy
        self.levels = LEVELS[accuracy]
        self.reasons: Counter[tuple[str, str]] = Counter()
        """The number of rows in which a value is missing, or the regime assumed, by quantity and reason."""

    def solve(self, rows: Index, task: Task) -> None:
        """Write the results of a task for rows of its pattern and decisions."""
        waiting = [(rows, task)]
        while waiting:
            rows, task = waiting.pop()
            if not size_of(rows):
                continue
            if task.level == len(self.levels) or (task.level and size_of(rows) <= ROWS_ONE_BY_ONE):
                self._solve_one_by_one(rows, task)
            else:
                waiting += self._follow_plan(rows, task)

    def _follow_plan(self, rows: Index, task: Task) -> Iterator[tuple[Index, Task]]:
        """Do what the plan of a task says, and yield the tasks that remain, each with its rows."""
        plan_ = plan(task, self.accuracy)
        # Some quantities need no program: the rows have one value, or none.
        for name, constant in plan_.constants.items():
            self.results[name][rows] = constant
        for name, reason in plan_.missing.items():
            self.results[name][rows] = nan
            self.reasons[name, reason] += size_of(rows)
        flags: dict[str, Flags] = {}
        if plan_.program:
            others = set(plan_.program.results).difference(plan_.computed)
            flags = {name: np.empty(size_of(rows), np.bool_) for name in others}
            self._run(plan_.program, rows, plan_.computed, flags)
        # A quantity that is not certified in a row goes to the next level.
        for name in plan_.computed:
            if (condition := condition_of(name)) in flags:
                failed = select(rows, np.flatnonzero(~flags[condition]))
                yield failed, task._replace(names=(name,), level=task.level + 1)
        # A quantity that no program gives goes to the last level at once.
        if plan_.row_by_row:
            yield rows, task._replace(names=plan_.row_by_row, level=len(self.levels))
        # The question splits the rows: either part goes on, with its answer and the quantities that asked.
        if plan_.question:
            answers, unsure = flags["answer"], np.flatnonzero(~flags["sure"])
            answers[unsure] = self._ask(select(rows, unsure), task, plan_.question)
            for answer in (False, True):
                places = np.flatnonzero(answers == answer)
                answered = rows if places.size == answers.size else select(rows, places)
                decisions = task.branches | {(plan_.question, answer)}
                yield answered, task._replace(branches=decisions, names=plan_.asking)

    def _run(
        self, program: Program, rows: Index, quantities: tuple[str, ...], flags: Mapping[str, Flags]
    ) -> None:
        """Run a program tile by tile. ``flags`` are columns for those results that are no quantities."""
        adjoin, size = isinstance(rows, slice), size_of(rows)
        gathered = [] if adjoin else [np.float64] * (len(program.inputs) + len(quantities))
        tile_size = min(TILE_ROWS, size)
        scratch = columns_for([*gathered, *program.between], tile_size)
        for start in range(0, size, tile_size):
            places = slice(start, min(start + tile_size, size))
            tile = select(rows, places)
            columns = [column[: size_of(tile)] for column in scratch]
            free, between = iter(columns), columns[len(gathered) :]
            # Where rows adjoin each other, the program reads inputs and writes quantities in place.
            # Elsewhere, both are gathered in columns of their own.
            inputs = {name: _rows_of(self.inputs[name], tile, free) for name in program.inputs}
            results = {name: self.results[name][tile] if adjoin else next(free) for name in quantities}
            program.run(inputs, results | {name: flags[name][places] for name in flags}, between)
            if not adjoin:
                for name in quantities:
                    self.results[name][tile] = results[name]

    def _ask(self, rows: NDArray[np.intp], task: Task, question: str) -> Flags:
        """Return each row's answer to a question that doubles leave open."""
        answers, sure = np.empty((2, rows.size), np.bool_)
        sure[:] = False
        # Pairs may decide it. They are not worth a program for few rows.
        if rows.size > ROWS_ONE_BY_ONE:
            self._run(answering(task, question, PAIRS), rows, (), {"answer": answers, "sure": sure})
        # Exact arithmetic decides the rest.
        for place in np.flatnonzero(~sure).tolist():
            method, point = question.split()
            decided = Decisions(task.pattern.scene(partial(self.number, rows[place])))
            answers[place] = getattr(decided, method)(point)
        return answers

    def _solve_one_by_one(self, rows: Index, task: Task) -> None:
        """Solve rows as scenes of their own, exactly. Rows that are alike are solved once: in tables of whole
        numbers there are many."""
        columns = [column for column in self.inputs.values() if column.ndim]
        alike: dict[tuple[float, ...], list[int]] = {}
        for place in range(size_of(rows)):
            row = select(rows, place)
            alike.setdefault(tuple(column[row] for column in columns), []).append(row)
        for same in alike.values():
            number = partial(self.number, same[0])
            # What the group has decided spares a single quantity all questions, if it suffices.
            if task.branches and len(task.names) == 1:
                double = nearest_double(task, task.names[0], number)
                if double is not None:
                    self.results[task.names[0]][same] = double
                    continue
            answers = Answers(task.pattern.scene(number))
            for name in task.names:
                if name == "regime":
                    self.results[name][same] = REGIMES.index(answers.decided.regime)
                    continue
                value = answers[name]
                self.results[name][same] = nan if value is None else float(value)
                if value is None:
                    self.reasons[name, answers.answer(name).reason] += len(same)

    def number(self, row: int, name: str) -> Fraction:
        """Return an input of a row, exactly."""
        column = self.inputs[name]
        return Fraction(float(column[row] if column.ndim else column))


def _rows_of(column: Column, rows: Index, free: Iterator[Column]) -> Column:
    """Return rows of a column, copied to a free one unless they adjoin each other; a number stays single."""
    if not column.ndim:
        return column
    return column[rows] if isinstance(rows, slice) else column.take(rows, out=next(free), mode="clip")


def size_of(index: Index) -> int:
    """Return the number of rows of a selection."""
    return index.stop - index.start if isinstance(index, slice) else index.size


def select(index: Any, places: Any) -> Any:
    """Return the rows at places of a selection, which are a slice, an array or the number of one place."""
    if not isinstance(index, slice):
        return index[places]
    if isinstance(places, slice):
        return slice(index.start + places.start, min(index.start + places.stop, index.stop))
    return places + index.start if index.start else places
