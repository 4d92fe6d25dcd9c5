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
from ..model.angle import Angle
from ..model.case import Case
from ..model.quantities import REGIMES, Accuracy
from ..model.scene import COLUMNS, Scene
from ..solver.answers import Answers
from .double import DOUBLES
from .expansion import PAIRS, TRIPLES
from .gap import gap, ratio
from .plan import COLUMN, LEVELS, Pattern, Plan, Task, in_pairs, plan, questioning
from .program import Program, Room
from .tables import Column

ROOM = 10_000_000  # bytes for the columns of a tile
SMALLEST, LARGEST = 8_192, 65_536  # rows of a tile
FEW = 24  # rows that are solved sooner one by one than by a long program
LEAVE = 2_000  # rows of one block that are solved sooner together with rows of other blocks

Index = slice | NDArray[np.intp]
"""A selection of rows."""


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
        """Write the results of a task for rows of its pattern and decisions.

        The `Plan` divides the task's quantities. Some are computed by its program; rows that are not
        certified go to the next level, for that quantity only. Some cannot be computed at this level and go
        to the next one in all rows. Some need an answer first: the rows of either answer become a new task.
        """
        levels = LEVELS[self.accuracy]
        if task.level == len(levels) or (levels[task.level] is TRIPLES and size_of(index) <= FEW):
            self._solve_one_by_one(index, task)
            return
        how = plan(task, self.accuracy)
        for name, constant in how.constants:
            self.results[name][index] = constant
        for name, reason in how.missing:
            self.results[name][index] = nan
            self.reasons[name, reason] += size_of(index)
        for name, failed in self._run_certified(how, index).items():
            self._to_next_level(failed, task._replace(names=(name,)))
        if how.later:
            self.solve(index, task._replace(names=how.later, level=task.level + 1))
        if how.asking:
            yes = self._ask(index, task, how.question)
            most = bool(2 * np.count_nonzero(yes) > yes.size)
            for answer in (most, not most):  # the larger group first: the other one takes over its columns
                members = np.flatnonzero(yes == answer)
                part = task._replace(decisions=task.decisions | {(how.question, answer)}, names=how.asking)
                if members.size == yes.size:
                    self.solve(index, part)
                elif members.size:
                    self.solve(_select(index, members), part)

    def _run_certified(self, how: Plan, rows: Index) -> dict[str, NDArray[np.intp]]:
        """Run a plan's program; returns the rows in which a quantity is not certified, by its name."""
        failed: dict[str, list[NDArray[np.intp]]] = {name: [] for name in how.conditional}
        if how.program:
            for start, *certified in self._run(how.program, rows, how.quantities, len(how.conditional)):
                for name, sure in zip(how.conditional, certified, strict=True):
                    if np.count_nonzero(sure) < sure.size:
                        failed[name].append(np.flatnonzero(~sure) + start)
        return {name: _select(rows, np.concatenate(some)) for name, some in failed.items() if some}

    def _to_next_level(self, index: NDArray[np.intp], task: Task) -> None:
        """Solve one quantity at the next level of precision, now or with the rows of other blocks."""
        if self.accuracy == "exact" and task.level == 1 and index.size > FEW:
            index = self._settle_ties(index, task)
        if not index.size:
            return
        task = task._replace(level=task.level + 1)
        if self.left is not None and index.size <= LEAVE:
            self.left.setdefault(task, []).append(index)
        else:
            self.solve(index, task)

    def _run(
        self, program: Program, index: Index, names: Sequence[str], more: int
    ) -> Iterator[tuple[Any, ...]]:
        """Run a program tile by tile; yields the start of each tile and its ``more`` columns of booleans."""
        size, columns_ = size_of(index), len(program.between) + len(program.inputs) + len(names)
        most = min(max(SMALLEST, ROOM // (8 * columns_)), LARGEST)
        for start in range(0, size, most):
            tile = _select(index, slice(start, min(start + most, size)))
            rows = size_of(tile)
            inputs = [self.inputs[name] for name in program.inputs]
            direct = isinstance(tile, slice)
            kinds: list[Any] = [] if direct else [np.float64] * (len(inputs) + len(names))
            columns = self.room.columns([*kinds, *[np.bool_] * more, *program.between], rows)
            if direct:
                at = [column if column.size == 1 else column[tile] for column in inputs]
                results = [self.results[name][tile] for name in names]
            else:
                at = [
                    column if column.size == 1 else column.take(tile, out=here, mode="clip")
                    for column, here in zip(inputs, columns, strict=False)
                ]
                results = columns[len(inputs) : len(kinds)]
            answers = columns[len(kinds) : len(kinds) + more]
            program.run(at, [*results, *answers], columns[len(kinds) + more :])
            if not direct:
                for name, column in zip(names, results, strict=True):
                    self.results[name][tile] = column
            yield start, *answers

    def _ask(self, index: Index, task: Task, question: str) -> NDArray[np.bool_]:
        """Each row's answer to a question, at the first level of precision that decides it."""
        size = size_of(index)
        yes = np.empty(size, np.bool_)
        far = LEVELS[self.accuracy][task.level] is TRIPLES
        open_: Any = slice(0, size)
        for ar in (DOUBLES, PAIRS, TRIPLES)[2 * far :]:
            if ar is not DOUBLES and size_of(open_) <= FEW:
                break
            program = questioning(task.pattern, task.decisions, question, self.accuracy, ar)
            rows, unsure = _select(index, open_), []
            for start, says, sure in self._run(program, rows, (), 2):
                yes[_select(open_, slice(start, start + says.size))] = says
                if np.count_nonzero(sure) < sure.size:
                    unsure.append(np.flatnonzero(~sure) + start)
            open_ = _select(open_, np.concatenate(unsure)) if unsure else np.empty(0, np.intp)
            if not open_.size:
                return yes
        every: Any = np.arange(size) if isinstance(open_, slice) else open_
        for row in every.tolist():
            which: Any = question
            yes[row] = Case(self._scene(index, row, task.pattern)).beats_friction(which)
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
            inputs = {
                name: column if column.size == 1 else column[tile] for name, column in self.inputs.items()
            }
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
            place = row + index.start if isinstance(index, slice) else index[row]
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
        place = row + index.start if isinstance(index, slice) else int(index[row])
        fields: dict[str, Any] = {}
        for name, value in zip(COLUMNS, pattern.inputs, strict=True):
            fields[name] = value
            if value == COLUMN:
                column = self.inputs[name]
                fields[name] = Fraction(float(column[0 if column.size == 1 else place]))
        fields["wrap"] = Angle(fields["wrap"])
        return Scene(**fields, I=None)


def size_of(index: Index) -> int:
    """The number of rows of a selection."""
    return index.stop - index.start if isinstance(index, slice) else index.size


def _select(index: Any, some: Any) -> Any:
    """The rows at some places of a selection: two selections made one."""
    if not isinstance(index, slice):
        return index[some]
    if isinstance(some, slice):
        return slice(index.start + some.start, min(index.start + some.stop, index.stop))
    return some + index.start if index.start else some
