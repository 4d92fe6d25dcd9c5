"""Rows that agree: the equations of one scene, run on columns.

A block of rows is divided, as far as the quantities asked for need it, into rows that agree: on
what is given, on which mass is heavier, on whether the string slips. Each such part is one `Case`
and one `Machine`, those of a single scene, in which every number is a column (see `double_double`).

What the accuracies promise, and why they keep it:

- ``fast``: doubles as they come. Whether a string slips is read off doubles too, and what comes of an
  e^{μφ} beyond the doubles is infinite, even where a tiny mass would bring it back.
- ``certified``: a value is within 4 units in the last place (ulp) of the exact one for the given
  doubles, and every regime is right. A row goes up a ladder until an arithmetic vouches for it: rounded,
  quick, and thorough pairs, and at the end the exact arithmetic of a single scene. What may cancel, the
  lowest rung takes from the one above. A pair vouches where its bound is at most 3.49 · 2^-53 of the
  value: that is at most 3.49 ulp, and rounding high + low to a double costs half an ulp more. (Just below
  a power of two half an ulp of the double may be a whole one of the exact value: there it is 4.49 ulp.)
  A question (does it slip?) is answered by doubles where the two sides differ by a 2^-40 of them, far
  more than the few roundings they take can amount to; else by the sign of a thorough difference, if its
  bound is below 1; else by the exact comparison.
- ``exact``: the double nearest to the exact value. A thorough pair vouches where rounding gives the
  same double at both ends of its bound (Ziv's test), or where it is exact.

Rows with an input beyond `double_double.WINDOW` (and not 0), or `FAST_WINDOW`, start at the top of the
ladder: what could overflow on the way is solved one by one, at about a millisecond a row. So, but when
fast, is what comes of an e^{μφ} above e^700, and the friction_force_min of all rows.

Parts wait until those on lower rungs are done, so that what is written last is what was vouched for.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from fractions import Fraction
from math import nan
from operator import attrgetter
from typing import Any, Literal
from weakref import proxy

import numpy as np
from numpy.typing import NDArray

from ..arithmetic.double import FLOATS, Floats
from ..arithmetic.double_double import QUICK, ROUNDED, THOROUGH, Pair, Pairs, Unvouched
from ..arithmetic.error_free import UNIT, Column
from ..arithmetic.lazy import lazy
from ..model.angle import Angle
from ..model.case import Case, Excess, is_zero
from ..model.machine import Machine, Undetermined
from ..model.quantities import REGIMES
from ..model.scene import PARAMETERS, Scene
from ..solver.answers import Answers

Accuracy = Literal["fast", "certified", "exact"]
COLUMNS = tuple(name for name in PARAMETERS if name != "I")
ALONG = {"fast": 1, "certified": 3, "exact": 3}
"""How many times the minority the rows must be for taking it along to cost less than parting."""
ONE_BY_ONE = 3  # rows: quicker so, at 0.2 ms each, than as columns of pairs
CERTIFIED = 3.49 * UNIT
LADDERS: dict[str, tuple[Floats | Pairs, ...]] = {
    "fast": (FLOATS,),
    "certified": (ROUNDED, QUICK, THOROUGH),
    "exact": (THOROUGH,),
}
IN_ALL_REGIMES = {"mu_verge", "critical_pulley_mass", "critical_heavier_mass"}
"""Quantities with one equation in all regimes: they start on the lowest rung, as does what does not slip."""


class Divided(Exception):
    """The rows do not agree on the answer to a question: go on with the majority, later with the minority.

    ``minority`` is the place of its rows among those asked, ``answers`` what it has answered so far.
    """

    def __init__(self, majority: Rows, minority: NDArray[np.intp], answers: Mapping[str, bool]) -> None:
        super().__init__(majority, minority, answers)
        self.majority, self.minority, self.answers = majority, minority, answers


Index = slice | NDArray[np.intp]
Waiting = dict[tuple[tuple[str, ...], int, frozenset[tuple[str, bool]]], list[Any]]


class Rows:
    """Rows that agree on all that was asked of them so far.

    ``given`` are the inputs of many rows, each a Fraction, None or inf where all share it, else a column;
    these rows are the ones at ``index`` of them. ``sign`` says which mass is heavier (see `Case.sign`),
    ``far`` that an input is beyond the window. ``others`` are rows of a minority that came along because to
    leave them out would cost more; what they get is overwritten.
    """

    def __init__(
        self,
        given: Mapping[str, Any],
        sign: int,
        accuracy: Accuracy,
        index: Index,
        far: bool = False,
        waiting: Waiting | None = None,
    ) -> None:
        self._given, self.sign, self.accuracy, self.index, self.far = given, sign, accuracy, index, far
        self.size: int = index.stop - index.start if isinstance(index, slice) else index.size
        self._waiting: Waiting = {} if waiting is None else waiting
        self.others: NDArray[np.intp] | None = None
        self._fields: dict[str, Any] = {}
        self._pairs: dict[str, Pair] = {}
        self._answers: dict[str, bool] = {}
        self._machines: dict[Any, Machine[Any]] = {}
        self._singles: dict[int, Answers] = {}

    def _at(self, index: Index, answers: Mapping[str, bool]) -> Rows:
        """Rows of the same inputs, by their place among all, that agree on those answers."""
        rows = Rows(self._given, self.sign, self.accuracy, index, self.far, self._waiting)
        rows._answers = dict(answers)
        return rows

    def part(self, index: NDArray[np.intp] | None = None) -> Rows:
        """Some of these rows, or all of them once more, to answer a question in another way."""
        if index is None:
            rows = self._at(self.index, self._answers)
            rows._fields, rows._pairs = self._fields, self._pairs
        else:
            rows = self._at(self._within(index), self._answers)
        for arithmetic, machine in self._machines.items():
            # The exponential costs too much to compute it twice.
            if (k1 := machine.known("k1")) is not None:
                rows.machine(arithmetic, {"k1": k1 if index is None else _take(k1, index, self.size)})
        return rows

    def _within(self, index: NDArray[np.intp]) -> NDArray[np.intp]:
        """The place of some of these rows among all."""
        return index + self.index.start if isinstance(self.index, slice) else self.index[index]

    def field(self, name: str) -> Any:
        """An input of these rows."""
        if name not in self._fields:
            given = self._given[name]
            self._fields[name] = given[self.index] if isinstance(given, np.ndarray) else given
        return self._fields[name]

    def number(self, name: str, arithmetic: Any) -> Any:
        """An input as an arithmetic takes it; pairs of all arithmetics share what was made of it."""
        field = self.field(name)
        if not isinstance(field, np.ndarray) or arithmetic is FLOATS:
            return field
        if name not in self._pairs:
            self._pairs[name] = arithmetic.number(field)
        return arithmetic.number(self._pairs[name])

    def rim_mass(self, arithmetic: Any) -> Any:
        """The pulley's βM, where it has a mass; an exact product is the same in all arithmetics of pairs."""
        if arithmetic is ROUNDED:
            return self.rim_mass(QUICK).taken_by(ROUNDED)
        if "c" in self._pairs:
            return self._pairs["c"].high if arithmetic is FLOATS else self._pairs["c"].taken_by(arithmetic)
        inertia, mass = (arithmetic.number(self.number(name, arithmetic)) for name in ("inertia", "M"))
        rim_mass = inertia * mass
        if isinstance(rim_mass, Pair) and rim_mass.exact:
            self._pairs["c"] = rim_mass
        return rim_mass

    def write(self, out: NDArray[Any], values: Any) -> None:
        """Write values of these rows to their place in ``out``."""
        out[self.index] = values

    def write_sum(self, out: NDArray[Any], high: Any, low: Any, signed: bool = False) -> Column:
        """Write high + low, and return it; to add 0.0 makes 0 of -0, which only ``signed`` values can be."""
        there = out[self.index] if isinstance(self.index, slice) else None
        sums: Column = np.add(high, low, out=there)
        if signed:  # the low part may be -0 too
            sums = np.add(sums, 0.0, out=sums)
        if there is None:
            out[self.index] = sums
        return sums

    # Solving

    def solve(
        self, names: tuple[str, ...], out: Mapping[str, NDArray[Any]], rung: int = 0, leave: int = 0
    ) -> Iterator[tuple[tuple[str, ...], int, NDArray[np.intp]]]:
        """Write quantities of all rows, in the arithmetic on that rung of the ladder or higher.

        Of those that have to go up further, no more than ``leave`` are left: yields names, rung, index.
        """
        self._wait(names, rung, {}, self.index)
        while self._waiting:
            what = min(self._waiting, key=lambda what: what[1])
            indices = self._waiting.pop(what)
            index = indices[0] if len(indices) == 1 else np.concatenate(indices)
            some, higher, answers = what
            if higher > rung and index.size <= leave:
                yield some, higher, index
                continue
            rows: Rows | None = self._at(index, dict(answers))
            thorough = LADDERS[self.accuracy][higher:] == (THOROUGH,)
            if thorough and index is not self.index and index.size <= ONE_BY_ONE:
                higher += 1
            while rows is not None:
                rows, some = rows._solve_some(some, out, higher)

    def _wait(self, names: tuple[str, ...], rung: int, answers: Mapping[str, bool], index: Index) -> None:
        """Rows to be solved later, with others that agree with them."""
        self._waiting.setdefault((names, rung, frozenset(answers.items())), []).append(index)

    def _solve_some(
        self, names: tuple[str, ...], out: Mapping[str, NDArray[Any]], rung: int
    ) -> tuple[Rows | None, tuple[str, ...]]:
        """Write quantities until the rows disagree; returns the majority then, and what is left to write."""
        for i, name in enumerate(names):
            try:
                self._solve_one(name, out, rung)
            except Divided as divided:
                self._wait(names[i:], rung, divided.answers, self._within(divided.minority))
                return divided.majority, names[i:]
        return None, ()

    def _solve_one(self, name: str, out: Mapping[str, NDArray[Any]], rung: int) -> None:
        ladder = LADDERS[self.accuracy]
        try:
            if name == "regime":
                self.write(out[name], REGIMES.index(self.machine(FLOATS).case.regime))
            elif self.far or rung == len(ladder):
                self.write(out[name], [self._single(row, name) for row in range(self.size)])
            else:
                rung = self._first_rung(name, rung)
                self._write_vouched(name, out[name], rung, getattr(self.machine(ladder[rung]), name))
        except Undetermined:
            self.write(out[name], nan)
        except Unvouched:
            self._solve_one(name, out, rung + 1)

    def _first_rung(self, name: str, rung: int) -> int:
        """The rung to start on: not the lowest for what slips, which takes too many roundings for it."""
        if self.accuracy != "certified" or name in IN_ALL_REGIMES:
            return rung
        return rung if self.machine(FLOATS).case.regime == "no-slip" else max(rung, 1)

    def _write_vouched(self, name: str, out: NDArray[Any], rung: int, value: Any) -> None:
        """Write a quantity; rows in which it may not be what the accuracy promises have to go up."""
        if not isinstance(value, Pair):
            self.write_sum(out, value, 0.0)
            return
        low = 0.0 if value.low is None else value.low
        rounded = self.write_sum(out, value.high, low, not value.positive)
        vouched = (_certified if self.accuracy == "certified" else _nearest)(value, rounded)
        if np.all(vouched):
            return
        doubtful = np.broadcast_to(np.logical_not(vouched), self.size).copy()
        if self.others is not None:
            doubtful[self.others] = False
        index = np.flatnonzero(doubtful)
        if index.size:
            self._wait((name,), rung + 1, self._answers, self._within(index))

    def machine(self, arithmetic: Any, known: Mapping[str, Any] | None = None) -> Machine[Any]:
        """The model of these rows in an arithmetic, made when first asked for: then ``known`` counts."""
        if arithmetic not in self._machines:
            case = _RowsCase(self, arithmetic)
            if arithmetic is ROUNDED:
                self._machines[arithmetic] = _RoundedMachine(case, self.machine(QUICK), known)
            else:
                self._machines[arithmetic] = Machine(case, arithmetic, known)
        return self._machines[arithmetic]

    def scene(self, row: int) -> Scene:
        """One row as a scene of its own."""
        fields = {name: self.field(name) for name in COLUMNS}
        for name, field in fields.items():
            if isinstance(field, np.ndarray):
                fields[name] = Fraction(float(field[row]))
        fields["wrap"] = Angle(fields["wrap"])
        return Scene(**fields, I=None)

    def _single(self, row: int, name: str) -> float:
        if row not in self._singles:
            self._singles[row] = Answers(self.scene(row))
        value = self._singles[row][name]
        return nan if value is None else float(value)

    # Questions

    def answer(self, question: str) -> bool:
        """The answer of all rows; raises Divided if they differ."""
        if question not in self._answers:
            ask: Any = QUESTIONS.get(question, Rows._beats_friction)
            answers = ask(self, question)
            if np.size(answers) == 1:
                self._answers[question] = bool(answers)
            else:
                self._agree(question, answers)
        return self._answers[question]

    def _agree(self, question: str, answers: NDArray[np.bool_]) -> None:
        """Keep the answer that all rows give, or raise Divided."""
        others = np.empty(0, np.intp) if self.others is None else self.others
        yes = int(np.count_nonzero(answers) - np.count_nonzero(answers[others]))
        if yes in (0, self.size - others.size):
            self._answers[question] = yes > 0
            return
        rarer = 2 * yes < self.size - others.size
        in_minority = answers == rarer
        in_minority[others] = False
        minority = np.flatnonzero(in_minority)
        if ALONG[self.accuracy] * minority.size < self.size:
            majority = self.part()
            majority.others = np.concatenate([others, minority])
        else:
            in_minority[others] = True
            majority = self.part(np.flatnonzero(~in_minority))
        majority._answers[question] = not rarer
        raise Divided(majority, minority, self._answers | {question: rarer})

    def _beats_friction(self, question: Any) -> Any:
        """Whether the excess of the tension ratio is beyond what friction holds, e^{μφ} - 1."""
        if self.far:
            return np.array([self._settled(row, question) for row in range(self.size)])
        excess, held = self._excess(question), self.machine(FLOATS).k1
        if self.accuracy == "fast":
            return excess > held
        ratio = np.broadcast_to(np.divide(excess, held), self.size)
        beaten, not_beaten = ratio > 1 + 2.0**-40, ratio < 1 - 2.0**-40
        if np.count_nonzero(beaten) + np.count_nonzero(not_beaten) < self.size:
            open_ = np.flatnonzero(~(beaten | not_beaten))
            beaten[open_] = self.part(open_)._beats_friction_thoroughly(question)
        return beaten

    def _excess(self, question: Any) -> Any:
        """The excess in doubles, from pairs if they have it already."""
        for machine in self._machines.values():
            if question == "excess_ratio" and (excess := machine.known("excess")) is not None:
                return excess.rounded() if isinstance(excess, Pair) else excess
        machine = self.machine(FLOATS)
        return machine.excess if question == "excess_ratio" else getattr(machine.case, question)(FLOATS)

    def _beats_friction_thoroughly(self, question: Excess) -> Any:
        machine = self.machine(THOROUGH)
        margin = getattr(machine.case, question)(THOROUGH) - machine.k1
        beaten = np.broadcast_to(margin.high > 0, self.size).copy()
        for row in np.flatnonzero(~(np.broadcast_to(margin.bound, self.size) < 0.5)):
            beaten[row] = self._settled(int(row), question)
        return beaten

    def _settled(self, row: int, question: Excess) -> bool:
        return Case(self.scene(row)).beats_friction(question)

    def long_wrap(self, _: str) -> Any:
        return self.field("wrap") > 180

    def ends_hang_down(self, _: str) -> Any:
        return np.fmod(np.asarray(self.field("wrap"), dtype=np.float64), 360) == 180


QUESTIONS: dict[str, Callable[[Rows, str], Any]] = {
    "long_wrap": Rows.long_wrap,
    "ends_hang_down": Rows.ends_hang_down,
}


class _Inputs:
    """A scene whose inputs are columns of one arithmetic, each fetched when it is first used."""

    I = None

    def __init__(self, rows: Rows, arithmetic: Any) -> None:
        self._rows, self._arithmetic = proxy(rows), arithmetic

    def __getattr__(self, name: str) -> Any:
        field = self._rows.number(name, self._arithmetic)
        if name == "wrap":
            field = Angle(field)
        setattr(self, name, field)
        return field


class _RowsCase(Case):
    """A case whose questions are put to rows, which agree on the answers or are divided."""

    def __init__(self, rows: Rows, arithmetic: Any) -> None:
        inputs: Any = _Inputs(rows, arithmetic)
        super().__init__(inputs)
        # The rows own their machines: they must not own them in turn, or columns would outlive their block.
        self._rows: Rows = proxy(rows)
        self.sign, self._arithmetic = rows.sign, arithmetic

    @lazy
    def rim_mass(self) -> Any:
        mass = self.pulley_mass
        if mass is None or is_zero(mass):
            return mass
        return self._rows.rim_mass(self._arithmetic)

    @lazy
    def long_wrap(self) -> bool:
        return self._rows.answer("long_wrap")

    @lazy
    def ends_hang_down(self) -> bool:
        return self._rows.answer("ends_hang_down")

    def beats_friction(self, which: Excess) -> bool:
        return self._rows.answer(which)


class _RoundedMachine(Machine[Any]):
    """A machine whose products are rounded, but for those that come before something cancels."""

    def __init__(self, case: Case, finer: Machine[Any], known: Mapping[str, Any] | None) -> None:
        super().__init__(case, ROUNDED, known)
        self._finer = finer

    phi, k1, excess, transfer, drive = (
        lazy(attrgetter(f"_finer.{name}")) for name in ("phi", "k1", "excess", "transfer", "drive")
    )


def _take(column: Any, index: NDArray[np.intp], size: int) -> Any:
    """Some rows of a column of that size; what is the same in all rows stays."""
    many = getattr(column, "high", column)
    return column.take(index) if isinstance(many, np.ndarray) and many.size == size else column


def _certified(pair: Pair, rounded: Column) -> Any:
    """Which rows, rounded so, are certain to be within 4 ulp of the exact value."""
    enough = CERTIFIED - pair.loss
    vouched = enough >= 0 if pair.doubt is None else pair.doubt <= enough
    # The lower rungs take no e^{μφ} that could leave the doubles.
    return vouched & np.isfinite(rounded) if pair.arithmetic is THOROUGH else vouched


def _nearest(pair: Pair, rounded: Column) -> Any:
    """Which rows, rounded so, are certain to be the doubles nearest to the exact value."""
    if pair.low is None:
        return np.asarray(pair.bound == 0) & np.isfinite(rounded)
    error = np.abs(pair.high) * (pair.bound + 2.0**-104)
    same = (pair.high + (pair.low - error) == rounded) & (pair.high + (pair.low + error) == rounded)
    return (same | (np.asarray(pair.bound) == 0)) & np.isfinite(rounded)
