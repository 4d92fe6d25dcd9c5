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
            if task.level == len(self.levels) or (task.level and size_of(rows) <= ROWS_ONE_BY_ONE):
                self._solve_one_by_one(rows, task)
            else:
                waiting += [part for part in self._follow_plan(rows, task) if size_of(part[0])]

    def _follow_plan(self, rows: Index, task: Task) -> Iterator[tuple[Index, Task]]:
        """Do what the plan of a task says, and yield the tasks that remain, each with its rows."""
        program, steps = plan(task, self.accuracy, isinstance(rows, slice))
        flags = self._run(program, rows)
        remain = np.ones(size_of(rows), np.bool_)
        for step in steps:
            for name, reason in step.missing.items():
                self.reasons[name, reason] += int(np.count_nonzero(remain))
            # A quantity that is not certified in a row goes to the next level.
            for name in step.to_certify:
                failed = select(rows, np.flatnonzero(remain & ~flags[condition_of(name)]))
                yield failed, step.task._replace(names=(name,), level=task.level + 1)
            # A quantity that no program gives goes to the last level at once.
            if step.row_by_row:
                last = step.task._replace(names=step.row_by_row, level=len(self.levels))
                yield select(rows, np.flatnonzero(remain)), last
            # The question splits the rows: some leave, and what asked is then written over in them.
            if question := step.question:
                answers, unsure = flags[question], np.flatnonzero(remain & ~flags[condition_of(question)])
                answers[unsure] = self._ask(select(rows, unsure), step.task, question)
                for answer, other_task in step.tasks_by_answer:
                    places = np.flatnonzero(remain & (answers == answer))
                    yield rows if places.size == answers.size else select(rows, places), other_task
                    remain &= answers != answer

    def _run(self, program: Program, rows: Index) -> dict[str, Flags]:
        """Run a program tile by tile, and return the columns of those results that are no quantities."""
        adjoin, size = isinstance(rows, slice), size_of(rows)
        quantities = self.results.keys() & program.results
        flags = {name: np.empty(size, np.bool_) for name in set(program.results) - quantities}
        types = [*(self.results[name].dtype.type for name in quantities), *[np.float64] * len(program.inputs)]
        gathered = [] if adjoin else types
        tile_size = min(TILE_ROWS, size)
        scratch = columns_for([*gathered, *program.between], tile_size)
        for start in range(0, size, tile_size):
            places = slice(start, min(start + tile_size, size))
            tile = select(rows, places)
            columns = [column[: size_of(tile)] for column in scratch]
            free, between = iter(columns), columns[len(gathered) :]
            # Where rows adjoin each other, the program reads inputs and writes quantities in place.
            # Elsewhere, both are gathered in columns of their own.
            results = {name: self.results[name][tile] if adjoin else next(free) for name in quantities}
            inputs = {name: self.inputs[name] for name in program.inputs}
            for name, column in inputs.items():
                if column.ndim:
                    inputs[name] = column[tile] if adjoin else column.take(tile, out=next(free), mode="clip")
            program.run(inputs, results | {name: flags[name][places] for name in flags}, between)
            if not adjoin:
                for name in quantities:
                    self.results[name][tile] = results[name]
        return flags

    def _ask(self, rows: NDArray[np.intp], task: Task, question: str) -> Flags:
        """Return each row's answer to a question that doubles leave open."""
        answers, sure = np.zeros((2, rows.size), np.bool_)
        # Pairs may decide it. They are not worth a program for few rows.
        if rows.size > ROWS_ONE_BY_ONE:
            flags = self._run(answering(task, question), rows)
            answers, sure = flags[question], flags[condition_of(question)]
        # Exact arithmetic decides the rest. There is none about the wrap, as those answers are all sure.
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
