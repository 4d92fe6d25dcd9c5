"""Rows solved, group by group: questions are put to them, and programs run on tiles that fit the cache.

`plan` shows by an example what is done for a group, and why. Here it is done.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from fractions import Fraction
from math import nan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..model.case import Case
from ..model.quantities import REGIMES, Accuracy
from ..solver.answers import Answers
from .pairs import PAIRS
from .pattern import Column, Index, Task, select, size_of
from .plan import LEVELS, Plan, answering, condition_of, nearest_double, plan
from .program import Program, columns_for

ROOM = 2_000_000  # bytes for the columns of a tile
SMALLEST, LARGEST = 8_192, 32_768  # rows of a tile
FEW = 24  # rows that are solved sooner one by one than by a program that is yet to be made
LEAVE = 2_000  # rows of one block that are solved sooner together with rows of other blocks

Flags = NDArray[np.bool_]


class Rows:
    """Some rows: their inputs, and where their results go, by name."""

    def __init__(
        self, inputs: Mapping[str, Column], results: Mapping[str, NDArray[Any]], accuracy: Accuracy
    ) -> None:
        self.inputs, self.results, self.accuracy = inputs, results, accuracy
        self.levels = LEVELS[accuracy]
        self.left: dict[Task, list[NDArray[np.intp]]] | None = None
        """Tasks with few rows, kept for the end of all blocks; None where they are solved at once."""
        self.reasons: Counter[tuple[str, str]] = Counter()
        """In how many rows a quantity has no value, by its name and the reason."""

    def solve(self, rows: Index, task: Task) -> None:
        """Write the results of a task for rows of its pattern and decisions."""
        waiting = [(rows, task)]
        while waiting:
            rows, task = waiting.pop()
            if not size_of(rows):
                continue
            if task.level == len(self.levels) or (task.level and size_of(rows) <= FEW):
                self._solve_one_by_one(rows, task)
            else:
                waiting += self._solved_but_for(rows, task)

    def _solved_but_for(self, rows: Index, task: Task) -> Iterator[tuple[Index, Task]]:
        """Do what the plan of a task says; yields what is left to do.

        A row and quantity that is not certified is left to the next level.
        """
        how = plan(task, self.accuracy)
        for name, constant in how.constants.items():
            self.results[name][rows] = constant
        for name, reason in how.missing.items():
            self.results[name][rows] = nan
            self.reasons[name, reason] += size_of(rows)
        found = self._run_plan(how, rows)
        for name in how.conditional:
            failed = select(rows, np.flatnonzero(~found[condition_of(name)]))
            again = task._replace(names=(name,), level=task.level + 1)
            if self.left is None or failed.size > LEAVE:
                yield failed, again
            elif failed.size:
                self.left.setdefault(again, []).append(failed)
        if how.alone:
            yield rows, task._replace(names=how.alone, level=len(self.levels))
        if how.question:
            yes, unsure = found["yes"], np.flatnonzero(~found["sure"])
            yes[unsure] = self._ask(select(rows, unsure), task, how.question)
            for answer in (False, True):
                places = np.flatnonzero(yes == answer)
                answered = rows if places.size == yes.size else select(rows, places)
                decisions = task.decisions | {(how.question, answer)}
                yield answered, task._replace(decisions=decisions, names=how.asking)

    def _run_plan(self, how: Plan, rows: Index) -> dict[str, Flags]:
        """Run a plan's program; returns what it says beside the quantities, by name."""
        if how.program is None:
            return {}
        flags = [name for name in how.program.results if name not in how.computed]
        found = {name: np.empty(size_of(rows), np.bool_) for name in flags}
        self._run(how.program, rows, how.computed, found)
        return found

    def _run(
        self, program: Program, rows: Index, quantities: tuple[str, ...], others: Mapping[str, NDArray[Any]]
    ) -> None:
        """Run a program tile by tile. ``others`` are columns for those results that are no quantities.

        In rows that follow each other, quantities are written where they belong. Others are gathered first.
        """
        follow, size = isinstance(rows, slice), size_of(rows)
        columns = [np.float64] * (len(program.inputs) + len(quantities)) + program.between
        most = min(max(SMALLEST, ROOM // (8 * len(columns))), LARGEST, size)
        room = columns_for(program.between if follow else columns, most)
        for start in range(0, size, most):
            part = slice(start, min(start + most, size))
            tile = select(rows, part)
            free = iter([column[: size_of(tile)] for column in room])
            results = {name: column[part] for name, column in others.items()}
            if follow:
                inputs = {
                    name: self.inputs[name][tile] if self.inputs[name].ndim else self.inputs[name]
                    for name in program.inputs
                }
                results |= {name: self.results[name][tile] for name in quantities}
            else:
                inputs = {name: _gathered(self.inputs[name], tile, next(free)) for name in program.inputs}
                results |= {name: next(free) for name in quantities}
            program.run(inputs, results, free)
            if not follow:
                for name in quantities:
                    self.results[name][tile] = results[name]

    def _ask(self, rows: NDArray[np.intp], task: Task, question: str) -> Flags:
        """Each row's answer to a question that doubles leave open."""
        yes, sure = np.empty((2, rows.size), np.bool_)
        sure[:] = False
        if rows.size > FEW:
            self._run(answering(task, question, PAIRS), rows, (), {"yes": yes, "sure": sure})
        for place in np.flatnonzero(~sure).tolist():
            method, which = question.split()
            case = Case(task.pattern.scene(self._number(rows[place])))
            yes[place] = getattr(case, method)(which)
        return yes

    def _solve_one_by_one(self, rows: Index, task: Task) -> None:
        """Solve rows as scenes of their own, exactly; those that are alike, as in tables of a few whole
        numbers, once."""
        columns = [column for column in self.inputs.values() if column.ndim]
        alike: dict[tuple[float, ...], list[int]] = {}
        for place in range(size_of(rows)):
            row = select(rows, place)
            alike.setdefault(tuple(column[row] for column in columns), []).append(row)
        for same in alike.values():
            self._solve_scene(same, task)

    def _solve_scene(self, rows: list[int], task: Task) -> None:
        """Solve the scene that is in these rows."""
        number = self._number(rows[0])
        if len(task.names) == 1 and task.decisions:
            value = nearest_double(task, task.names[0], number)
            if value is not None:
                self.results[task.names[0]][rows] = value
                return
        answers = Answers(task.pattern.scene(number))
        for name in task.names:
            if name == "regime":
                self.results[name][rows] = REGIMES.index(answers.case.regime)
            else:
                value = answers[name]
                self.results[name][rows] = nan if value is None else float(value)
                if value is None:
                    self.reasons[name, answers.reasons[name]] += len(rows)

    def _number(self, row: int) -> Callable[[str], Fraction]:
        """The inputs of a row, exactly, by their names."""

        def number(name: str) -> Fraction:
            column = self.inputs[name]
            return Fraction(float(column[row] if column.ndim else column))

        return number


def _gathered(column: Column, rows: NDArray[np.intp], room: Column) -> Column:
    """The rows of a column, in the room for them; a single number stays single."""
    return column.take(rows, out=room, mode="clip") if column.ndim else column
