"""Rows solved, group by group: questions are put to them, and programs run on tiles that fit the cache.

`plan` shows by an example what is done for a group, and why. Here it is done.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from math import nan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arithmetic.rational import Irrational
from ..model.case import Case
from ..model.quantities import REGIMES, Accuracy
from ..model.scene import Scene
from ..solver.answers import Answers
from .expansion import PAIRS, TRIPLES
from .gap import gap, ratio
from .plan import LEVELS, Pattern, Plan, Task, in_pairs, levels_of, plan, questioning
from .program import Program, Room
from .tables import Column

ROOM = 10_000_000  # bytes for the columns of a tile
SMALLEST, LARGEST = 8_192, 65_536  # rows of a tile
FEW = 24  # rows that are solved sooner one by one than by a long program
LEAVE = 2_000  # rows of one block that are solved sooner together with rows of other blocks

Index = slice | NDArray[np.intp]
"""A selection of rows."""
Waiting = tuple[Index, Task, Index]
"""Rows, their task, and the rows that its program runs on."""


class Rows:
    """Some rows: their inputs, and where their results go, by name."""

    def __init__(
        self,
        inputs: Mapping[str, Column],
        results: Mapping[str, NDArray[Any]],
        accuracy: Accuracy,
        room: Room,
    ) -> None:
        self.inputs, self.results, self.accuracy, self.room = inputs, results, accuracy, room
        self.left: dict[Task, list[NDArray[np.intp]]] | None = None
        """Tasks with few rows, kept for the end of all blocks; None where they are solved at once."""
        self.reasons: Counter[tuple[str, str]] = Counter()
        """In how many rows a quantity has no value, by its name and the reason."""

    def solve(self, index: Index, task: Task) -> None:
        """Write the results of a task for rows of its pattern and decisions."""
        waiting: list[Waiting] = [(index, task, index)]
        while waiting:
            waiting += self._solved_but_for(*waiting.pop())

    def _solved_but_for(self, index: Index, task: Task, rows: Index) -> list[Waiting]:
        """Solve what a task's level of precision can; returns what is left to do, and for which rows.

        The `Plan` divides the task's quantities. Some are computed by its program: where one is not
        certified, it is left to the next level. Some cannot be computed at this level and are left to the
        next one in all rows. Some need an answer first: the rows of either answer become a new task.

        The program runs on ``rows``, which may be more than those of ``index``, but not twice as many, where
        that is cheaper than to select them. The results of the other rows are overwritten afterwards.
        """
        levels = LEVELS[self.accuracy]
        if task.level == len(levels) or (levels[task.level] is TRIPLES and size_of(index) <= FEW):
            self._solve_one_by_one(index, task)
            return []
        how = plan(task, self.accuracy)
        for name, constant in how.constants:
            self.results[name][rows] = constant
        for name, reason in how.missing:
            self.results[name][rows] = nan
            self.reasons[name, reason] += size_of(index)
        left: list[Waiting] = []
        if how.later:
            left.append((index, task._replace(names=how.later, level=task.level + 1), index))
        yes, all_failed = self._run_plan(how, rows)
        for name, failed in all_failed.items():
            if rows is not index and not isinstance(index, slice):
                failed = np.intersect1d(failed, index, assume_unique=True)
            if name == how.question:
                yes[_places(rows, failed)] = self._ask(failed, task, name)
                continue
            one = task._replace(names=(name,), level=task.level + 1)
            if self.accuracy == "exact" and levels[task.level] is PAIRS and failed.size > FEW:
                failed = self._settle_ties(failed, one)
            if self.left is not None and failed.size <= LEAVE:
                self.left.setdefault(one, []).append(failed)
            elif failed.size:
                left.append((failed, one, failed))
        if how.asking:
            if rows is not index and not isinstance(index, slice):
                yes = yes[_places(rows, index)]
            most = bool(2 * np.count_nonzero(yes) > yes.size)
            for answer in (not most, most):  # the larger group is solved first, the other one overwrites
                members = np.flatnonzero(yes == answer)
                if members.size:
                    own = index if members.size == yes.size else _select(index, members)
                    part = task._replace(
                        decisions=task.decisions | {(how.question, answer)}, names=how.asking
                    )
                    wide = answer == most and isinstance(rows, slice) and 2 * members.size > size_of(rows)
                    left.append((own, part, rows if wide else own))
        return left

    def _run_plan(self, how: Plan, index: Index) -> tuple[NDArray[np.bool_], dict[str, NDArray[np.intp]]]:
        """Run a plan's program.

        Returns the rows' answers to the plan's question, and the rows in which the answer, or a quantity, is
        not certified, by the question or the name.
        """
        asked = [how.question] if how.question else []
        yes = np.empty(size_of(index) if asked else 0, np.bool_)
        names = (*how.conditional, *asked)
        failed: dict[str, list[NDArray[np.intp]]] = {name: [] for name in names}
        if how.program:
            for start, *columns in self._run(how.program, index, how.quantities, len(names) + len(asked)):
                for name, sure in zip(names, columns, strict=False):
                    if np.count_nonzero(sure) < sure.size:
                        failed[name].append(np.flatnonzero(~sure) + start)
                if asked:
                    yes[start : start + columns[-1].size] = columns[-1]
        return yes, {name: _select(index, np.concatenate(some)) for name, some in failed.items() if some}

    def _run(
        self, program: Program, index: Index, names: Sequence[str], more: int
    ) -> Iterator[tuple[Any, ...]]:
        """Run a program tile by tile; yields the start of each tile and its ``more`` columns of booleans.

        In rows that follow each other, results are written where they belong. Others are gathered first.
        """
        size, columns = size_of(index), len(program.between) + len(program.inputs) + len(names)
        most = min(max(SMALLEST, ROOM // (8 * columns)), LARGEST)
        for start in range(0, size, most):
            tile = _select(index, slice(start, min(start + most, size)))
            direct = isinstance(tile, slice)
            inputs = [self.inputs[name] for name in program.inputs]
            floats = 0 if direct else len(inputs) + len(names)
            kinds: list[Any] = [*[np.bool_] * more, *[np.float64] * floats, *program.between]
            room = iter(self.room.columns(kinds, size_of(tile)))
            answers = [next(room) for _ in range(more)]
            if direct:
                inputs = [column[tile] if column.ndim else column for column in inputs]
                results = [self.results[name][tile] for name in names]
            else:
                inputs = [
                    column.take(tile, out=here, mode="clip") if column.ndim else column
                    for column, here in zip(inputs, room, strict=False)
                ]
                results = [next(room) for _ in names]
            program.run(inputs, [*results, *answers], list(room))
            if not direct:
                for name, column in zip(names, results, strict=True):
                    self.results[name][tile] = column
            yield start, *answers

    def _ask(self, index: NDArray[np.intp], task: Task, question: str) -> NDArray[np.bool_]:
        """Each row's answer to a question that the task's plan leaves open."""
        yes = np.empty(index.size, np.bool_)
        open_ = np.arange(index.size)
        for ar in levels_of(question, task.level, self.accuracy)[1:]:
            if open_.size <= FEW:
                break
            program = questioning(task, question, self.accuracy, ar)
            unsure = []
            for start, sure, says in self._run(program, index[open_], (), 2):
                tile = open_[start : start + says.size]
                yes[tile] = says
                unsure.append(tile[~sure])
            open_ = np.concatenate(unsure)
        for row in open_.tolist():
            method, which = question.split()
            yes[row] = getattr(Case(self._scene(index, row, task.pattern)), method)(which)
        return yes

    def _settle_ties(self, index: NDArray[np.intp], task: Task) -> NDArray[np.intp]:
        """Write the task's quantity where it is a tie, half-way between two doubles; returns the other rows.

        No error bound shows that a value is a tie, but the `gap` does.
        """
        (name,) = task.names
        program, plain = in_pairs(task.pattern, task.decisions, name)
        open_ = np.ones(index.size, np.bool_)
        for start in range(0, index.size, SMALLEST):
            tile = index[start : start + SMALLEST]
            inputs = {name: column[tile] if column.ndim else column for name, column in self.inputs.items()}
            try:
                bits = ratio(plain, inputs)
            except Irrational:
                return index
            first, second, error = np.empty((3, tile.size))
            between = self.room.columns(program.between, tile.size)
            program.run([inputs[name] for name in program.inputs], [first, second, error], between)
            half = np.copysign(np.spacing(np.abs(first)) / 2, second)
            tied = np.abs(second - half) + error < gap(bits, half)
            self.results[name][tile[tied]] = (first + half)[tied]
            open_[start : start + SMALLEST] = ~tied
        return index[open_]

    def _solve_one_by_one(self, index: Index, task: Task) -> None:
        """Solve each row as a scene of its own, exactly."""
        for row in range(size_of(index)):
            answers = Answers(self._scene(index, row, task.pattern))
            place = _select(index, row)
            for name in task.names:
                if name == "regime":
                    self.results[name][place] = REGIMES.index(answers.case.regime)
                else:
                    value = answers[name]
                    self.results[name][place] = nan if value is None else float(value)
                    if value is None:
                        self.reasons[name, answers.reasons[name]] += 1

    def _scene(self, index: Index, row: int, pattern: Pattern) -> Scene:
        """One row as a scene of its own."""
        place = _select(index, row)

        def exactly(name: str) -> Fraction:
            column = self.inputs[name]
            return Fraction(float(column[place] if column.ndim else column))

        return pattern.scene(exactly)


def size_of(index: Index) -> int:
    """The number of rows of a selection."""
    return index.stop - index.start if isinstance(index, slice) else index.size


def _select(index: Any, some: Any) -> Any:
    """The rows at some places of a selection, or the row at one place: two selections made one."""
    if not isinstance(index, slice):
        return index[some]
    if isinstance(some, slice):
        return slice(index.start + some.start, min(index.start + some.stop, index.stop))
    return some + index.start if index.start else some


def _places(index: Index, rows: NDArray[np.intp]) -> NDArray[np.intp]:
    """The places of some rows in a selection, which is in ascending order: the reverse of `_select`."""
    if not isinstance(index, slice):
        return np.searchsorted(index, rows)
    return rows - index.start if index.start else rows
