"""Rows solved: questions put to them, programs run on them tile by tile, and what is not vouched for gone up.

A block's rows that agree on what is given are parted by their answers until there is a program for them
(see `plan`). What its arithmetic does not vouch for goes up the ladder, for that quantity alone.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from math import nan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arithmetic.double import DOUBLES
from ..arithmetic.expansion import PAIRS, TRIPLES
from ..arithmetic.modular import Irrational, is_sum, residues, tie
from ..arithmetic.tables import Column
from ..model.angle import Angle
from ..model.case import Case
from ..model.quantities import REGIMES
from ..model.scene import Scene
from ..solver.answers import Answers as Single
from .plan import COLUMN, COLUMNS, LADDERS, Accuracy, Answers, Given, halfway, plan, questioning
from .program import Program, Room

ROOM = 10_000_000  # bytes for the columns of a tile
SMALLEST, LARGEST = 8_192, 65_536  # rows of a tile
FEW = 24  # rows: sooner solved one by one than by a program, where that takes many operations
LEAVE = 2_000  # rows of a block that are better solved with those of others

Index = slice | NDArray[np.intp]
Left = tuple[Given, Answers, tuple[str, ...], int]


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
        self.left: dict[Left, list[NDArray[np.intp]]] | None = None
        """Where rows are left that go up, if they are few; else they go up at once."""

    def solve(
        self,
        index: Index,
        given: Given,
        answers: Answers,
        names: tuple[str, ...],
        rung: int,
        along: Index | None = None,
    ) -> None:
        """Write those quantities of rows that agree on those answers.

        Rows ``along`` with them are written over later, and come along where parting would cost more.
        """
        ladder = LADDERS[self.accuracy]
        if self.accuracy == "exact" and rung == 1 and len(names) == 1 and size_of(index) > FEW:
            index = self._settle_ties(index, given, answers, names[0])
            if not size_of(index):
                return
        if rung == len(ladder) or (ladder[rung] == (TRIPLES,) and size_of(index) <= FEW):
            self._solve_one_by_one(index, names, given)
            return
        how = plan(given, answers, names, self.accuracy, rung)
        rows = index if along is None else along
        for name, constant in how.constants:
            self.results[name][rows] = constant
        if how.program:
            doubtful: dict[str, list[NDArray[np.intp]]] = {name: [] for name in how.doubtful}
            for start, *vouched in self._run(how.program, rows, how.quantities, len(how.doubtful)):
                for name, sure in zip(how.doubtful, vouched, strict=True):
                    if np.count_nonzero(sure) < sure.size:
                        doubtful[name].append(np.flatnonzero(~sure) + start)
            for name, some in doubtful.items():
                if some:
                    up = _among(rows, np.concatenate(some))
                    if along is not None and not isinstance(index, slice):
                        up = np.intersect1d(up, index, assume_unique=True)
                    if up.size:
                        self._go_up(up, given, answers, name, rung + 1)
        if how.later:
            self.solve(index, given, answers, how.later, rung + 1)
        if how.asking:
            yes = self._ask(index, given, answers, how.question, rung)
            most = 2 * np.count_nonzero(yes) > yes.size
            for answer in (most, not most):
                members = np.flatnonzero(yes if answer else ~yes)
                if members.size:
                    agreed = answers | {(how.question, bool(answer))}
                    if members.size == yes.size:
                        self.solve(index, given, agreed, how.asking, rung)
                    else:
                        with_others = index if answer == most else None
                        self.solve(_among(index, members), given, agreed, how.asking, rung, with_others)

    def _run(
        self, program: Program, index: Index, names: Sequence[str], more: int
    ) -> Iterator[tuple[Any, ...]]:
        """Run a program on tiles of rows; yields where each starts, and ``more`` columns of yes and no."""
        size, columns_ = size_of(index), len(program.between) + len(program.inputs) + len(names)
        most = min(max(SMALLEST, ROOM // (8 * columns_)), LARGEST)
        for start in range(0, size, most):
            tile = _among(index, slice(start, min(start + most, size)))
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

    def _ask(
        self, index: Index, given: Given, answers: Answers, question: str, rung: int
    ) -> NDArray[np.bool_]:
        """The rows' answers to a question."""
        size = size_of(index)
        yes = np.empty(size, np.bool_)
        far = LADDERS[self.accuracy][rung] == (TRIPLES,)
        ladder = (DOUBLES, PAIRS, TRIPLES)[2 * far :]
        open_: Any = slice(0, size)
        for ar in ladder:
            if ar is not DOUBLES and size_of(open_) <= FEW:
                break
            program = questioning(given, answers, question, self.accuracy, ar)
            rows, unsure = _among(index, open_), []
            for start, says, sure in self._run(program, rows, (), 2):
                yes[_among(open_, slice(start, start + says.size))] = says
                if np.count_nonzero(sure) < sure.size:
                    unsure.append(np.flatnonzero(~sure) + start)
            open_ = _among(open_, np.concatenate(unsure)) if unsure else np.empty(0, np.intp)
            if not open_.size:
                return yes
        every: Any = np.arange(size) if isinstance(open_, slice) else open_
        for row in every.tolist():
            which: Any = question
            yes[row] = Case(self._scene(index, row, given)).beats_friction(which)
        return yes

    def _settle_ties(self, index: Index, given: Given, answers: Answers, name: str) -> Index:
        """Write what is just half-way between two doubles, which no bound tells; returns the other rows."""
        found, size = halfway(given, answers, name), size_of(index)
        open_ = np.ones(size, np.bool_)
        for start in range(0, size if found else 0, SMALLEST):
            assert found is not None
            program, plain = found
            tile = _among(index, slice(start, min(start + SMALLEST, size)))
            inputs = {
                name: column if column.size == 1 else column[tile] for name, column in self.inputs.items()
            }
            first, second = np.empty((2, size_of(tile)))
            between = self.room.columns(program.between, first.size)
            program.run([inputs[name] for name in program.inputs], [first, second], between)
            half, near = tie(first, second)
            rows = np.flatnonzero(near)
            try:
                here = {
                    name: residues(column if column.size == 1 else column[rows])
                    for name, column in inputs.items()
                }
                rows = rows[is_sum(plain, here, first[rows], half[rows])]
            except Irrational:
                break
            self.results[name][_among(tile, rows)] = first[rows] + half[rows]
            open_[rows + start] = False
        return index if open_.all() else _among(index, np.flatnonzero(open_))

    def _go_up(self, index: Index, given: Given, answers: Answers, name: str, rung: int) -> None:
        if self.left is not None and size_of(index) <= LEAVE:
            assert not isinstance(index, slice)
            self.left.setdefault((given, answers, (name,), rung), []).append(index)
        else:
            self.solve(index, given, answers, (name,), rung)

    def _solve_one_by_one(self, index: Index, names: tuple[str, ...], given: Given) -> None:
        for row in range(size_of(index)):
            single = Single(self._scene(index, row, given))
            place = row + index.start if isinstance(index, slice) else index[row]
            for name in names:
                if name == "regime":
                    self.results[name][place] = REGIMES.index(single.case.regime)
                else:
                    value = single[name]
                    self.results[name][place] = nan if value is None else float(value)

    def _scene(self, index: Index, row: int, given: Given) -> Scene:
        """One row as a scene of its own."""
        place = row + index.start if isinstance(index, slice) else int(index[row])
        fields: dict[str, Any] = {}
        for name, value in zip(COLUMNS, given.inputs, strict=True):
            fields[name] = value
            if value == COLUMN:
                column = self.inputs[name]
                fields[name] = Fraction(float(column[0 if column.size == 1 else place]))
        fields["wrap"] = Angle(fields["wrap"])
        return Scene(**fields, I=None)


def size_of(index: Index) -> int:
    """How many rows that are."""
    return index.stop - index.start if isinstance(index, slice) else index.size


def _among(index: Any, some: Any) -> Any:
    """The rows at some places among those."""
    if not isinstance(index, slice):
        return index[some]
    if isinstance(some, slice):
        return slice(index.start + some.start, min(index.start + some.stop, index.stop))
    return some + index.start if index.start else some
