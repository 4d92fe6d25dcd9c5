"""What is done to rows that agree: the model's own equations, traced once and listed as programs.

The model of one scene (`Machine`) runs on formulas of columns. It asks a few questions on the way, as it
does for one scene: which mass is heavier, does the string slip. Rows that agree on what is given and on the
answers so far share a `Plan`, a question for its rows, or the program that gives their quantities.

What the accuracies promise, and why they keep it:

- ``fast``: doubles as they come. Whether a string slips is read off doubles too, and what comes of an
  e^{μφ} beyond the doubles is infinite, even where a tiny mass would bring it back.
- ``certified``: a value is within 4 units in the last place (ulp) of the exact one for the given
  doubles, and every regime is right. A row goes up a ladder until an arithmetic vouches for it: pairs,
  rounded or quick, whichever is good enough in all rows, then expansions of two and three doubles, and at
  the end the exact arithmetic of a single scene. An arithmetic vouches where its bound is at most
  3.49 · 2^-53 of the value: that is at most 3.49 ulp, and rounding to a double costs half an ulp more.
  (Just below a power of two half an ulp of the double may be a whole one of the exact value: there it is
  4.49 ulp.) A question (does it slip?) is answered by doubles where the two sides differ by a 2^-40 of
  them, far more than the few roundings they take can amount to; else by the sign of a difference, if its
  bound is below 1/2.
- ``exact``: the double nearest to the exact value. An expansion vouches where rounding gives the same
  double at both ends of its bound (Ziv's test), or where it is exact. A value half-way between two doubles
  is no such thing; where it is rational, residues show that it is that tie (see `modular`).

Rows with an input beyond `double_double.WINDOW` (and not 0), or beyond `FAST_WINDOW`, start with triples,
whose range is not that of doubles.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from functools import lru_cache, reduce
from math import inf, nan
from typing import Any, Literal, NamedTuple

from ..arithmetic.double import (
    DOUBLES,
    Conditions,
    Unvouched,
    absolute,
    at_most,
    both,
    either,
    equal,
    is_finite,
    less,
)
from ..arithmetic.double_double import QUICK, ROUNDED, Pair
from ..arithmetic.error_free import UNIT
from ..arithmetic.expansion import PAIRS, TRIPLES, Expansion, times_power_of_two
from ..arithmetic.lazy import lazy
from ..arithmetic.symbolic import Formula, Part, formula
from ..model.angle import Angle
from ..model.case import Case, Excess, is_zero
from ..model.machine import Machine, Undetermined
from ..model.quantities import REGIMES
from ..model.scene import PARAMETERS, Scene
from .program import Program

Accuracy = Literal["fast", "certified", "exact"]
COLUMNS = tuple(name for name in PARAMETERS if name != "I")
CERTIFIED = 3.49 * UNIT
LADDERS: dict[str, tuple[tuple[Any, ...], ...]] = {
    "fast": ((DOUBLES,), (TRIPLES,)),
    "certified": ((ROUNDED, QUICK), (PAIRS,), (TRIPLES,)),
    "exact": ((PAIRS,), (TRIPLES,)),
}
CLEAR = 2.0**-40
"""By how much of it two sides must differ in doubles to answer a question."""
SIGNED = (
    "acceleration",
    "friction_force_x",
    "friction_force_y",
    "torque",
    "rim_acceleration",
    "angular_acceleration",
)

NORMAL = -1021.0  # the power of two below which a double has fewer bits

KEPT = 256  # plans: ten kinds of rows take that many; the longest, of all quantities in triples, has 3 MB

COLUMN = "column"


class Given(NamedTuple):
    """What rows agree on before any question: which mass is heavier (see `Case.sign`), and each input.

    That is None or inf, a Fraction that all share, or COLUMN.
    """

    sign: int
    inputs: tuple[Fraction | float | str | None, ...]


Answers = frozenset[tuple[str, bool]]


class Asked(Exception):
    """The rows have not answered this question yet."""


class _RowsCase(Case):
    """A case whose inputs are columns of an arithmetic, and whose questions have been put to the rows."""

    def __init__(self, given: Given, answers: Answers, ar: Any) -> None:
        inputs: dict[str, Any] = {
            name: ar.number(Formula("symbol", name)) if value == COLUMN else value
            for name, value in zip(COLUMNS, given.inputs, strict=True)
        }
        inputs["wrap"] = Angle(inputs["wrap"])
        super().__init__(Scene(**inputs, I=None))
        self.sign, self._answers = given.sign, dict(answers)
        if isinstance(self.light, Pair) and isinstance(self.heavy, Pair):
            self.heavy.covers = self.light

    @lazy
    def rim_mass(self) -> Any:
        """Without a mass it is 0, whatever the column of its shape."""
        return self.pulley_mass if is_zero(self.pulley_mass) else super().rim_mass

    def _answer(self, question: str) -> bool:
        if question not in self._answers:
            raise Asked(question)
        return self._answers[question]

    @lazy
    def long_wrap(self) -> bool:
        wrap = self.scene.wrap
        return wrap.is_beyond_half_turn if isinstance(wrap.number, Fraction) else self._answer("long_wrap")

    @lazy
    def ends_hang_down(self) -> bool:
        wrap = self.scene.wrap
        return wrap.ends_hang_down if isinstance(wrap.number, Fraction) else self._answer("ends_hang_down")

    def beats_friction(self, which: Excess) -> bool:
        return self._answer(which)


class _ColumnsMachine(Machine[Any]):
    """The model of columns: what is known of the order and signs of numbers saves telling them row by row."""

    @lazy
    def drive(self) -> Any:
        """Asked for only where the string can slip, and so above 0."""
        return _known_positive(super().drive)

    @lazy
    def limiting_drive(self) -> Any:
        return _known_positive(super().limiting_drive)

    @lazy
    def magnitude(self) -> Any:
        """Never above gravity."""
        magnitude = super().magnitude
        if isinstance(magnitude, Pair):
            self.g.covers = magnitude
        return magnitude


def _known_positive(drive: Any) -> Any:
    if isinstance(drive, Pair | Expansion):
        drive.positive = True
    return drive


def _taken(name: str) -> Any:
    """An attribute that a finer machine has."""
    return lazy(lambda machine: ROUNDED.number(getattr(machine.finer, name)))


class _RoundedMachine(_ColumnsMachine):
    """A machine whose products are rounded, but for those that come before something cancels."""

    def __init__(self, finer: Machine[Any]) -> None:
        super().__init__(finer.case, ROUNDED)
        self.finer = finer

    phi, k1, excess, transfer, drive = map(_taken, ("phi", "k1", "excess", "transfer", "drive"))


def _machines(given: Given, answers: Answers, arithmetics: tuple[Any, ...]) -> Iterator[Machine[Any]]:
    """The model in each of those arithmetics."""
    if arithmetics == (ROUNDED, QUICK):
        quick = _ColumnsMachine(_RowsCase(given, answers, QUICK), QUICK)
        yield from (_RoundedMachine(quick), quick)
    else:
        for ar in arithmetics:
            yield _ColumnsMachine(_RowsCase(given, answers, ar), ar)


class Plan(NamedTuple):
    """How rows that agree are solved.

    The program's results are those of the ``quantities``, and whether those that are ``doubtful`` are
    vouched for, which differs from row to row. ``constants`` are the same in all rows, ``later`` is not for
    this rung, and ``asking`` cannot be told before the ``question`` is put to the rows.
    """

    program: Program | None
    quantities: tuple[str, ...]
    doubtful: tuple[str, ...]
    constants: tuple[tuple[str, float], ...]
    later: tuple[str, ...]
    question: str
    asking: tuple[str, ...]


@lru_cache(KEPT)
def plan(given: Given, answers: Answers, names: tuple[str, ...], accuracy: Accuracy, rung: int) -> Plan:
    """The plan for quantities on a rung of the accuracy's ladder, in its first arithmetic that can do all."""
    for machine in _machines(given, answers, LADDERS[accuracy][rung]):
        values: dict[str, Part] = {}
        vouched: dict[str, Formula] = {}
        constants: list[tuple[str, float]] = []
        later, asking, question = [], [], ""
        for name in names:
            try:
                if name == "regime":
                    constants.append((name, REGIMES.index(machine.case.regime)))
                    continue
                values[name], sure = _value(machine, name, accuracy)
            except Asked as asked:
                question = question or str(asked)
                asking.append(name)
            except Undetermined:
                constants.append((name, nan))
            except Unvouched:
                later.append(name)
            else:
                if sure:
                    vouched[name] = reduce(both, sure)
        if not later:
            break
    program = Program([*values.values(), *vouched.values()]) if values else None
    return Plan(
        program, tuple(values), tuple(vouched), tuple(constants), tuple(later), question, tuple(asking)
    )


def _value(machine: Machine[Any], name: str, accuracy: Accuracy) -> tuple[Part, Conditions]:
    """A quantity as doubles, and where it is vouched for. Raises Unvouched, Undetermined, Asked."""
    value = getattr(machine, name)
    if isinstance(value, Formula):
        return value + 0.0 if name in SIGNED else value, ()  # 0.0 makes 0 of -0
    if value.loss > CERTIFIED:
        raise Unvouched
    double = _double(value)
    if accuracy == "fast":
        return double, ()
    if accuracy == "exact":
        return double, (_is_nearest(value, double),)
    sure: Conditions = value.sure if isinstance(value, Pair) else ()
    if value.doubt is not None:
        sure = (*sure, at_most(value.doubt, CERTIFIED - value.loss))
    if value.arithmetic is PAIRS:  # e^{μφ} may leave the doubles
        sure = (*sure, is_finite(double))
    return double, sure


def _double(value: Pair | Expansion) -> Part:
    """The double that a number rounds to."""
    double: Any
    if isinstance(value, Pair):
        double = value.rounded()
    else:
        double = value.parts[0]
        if value.arithmetic.wide:
            double = times_power_of_two(double, value.exponent)
    result: Part = double if value.positive else double + 0.0
    return result


def _is_nearest(value: Expansion, double: Part) -> Formula:
    """Whether a double is the nearest to the exact value: rounding gives it at both ends of the bound."""
    first, second, third = (*value.parts, 0.0, 0.0)[:3]
    wide = value.arithmetic.wide
    error = absolute(first) * (value.bound + 4 * (UNIT**3 if wide else UNIT**2))
    if wide:  # a step from the second part breaks ties, and changes nothing else
        ends = [
            Formula("nextafter", formula(second), formula((third + side * error) * inf))
            for side in (-1.0, 1.0)
        ]
    else:
        ends = [second - error, second + error]
    same = both(*(equal(first + end, first) for end in ends))
    exact = both(equal(value.bound, 0.0), equal(third, 0.0))
    sure = either(same, exact)
    if not wide:  # e^{μφ} may leave the doubles
        return both(sure, is_finite(double))
    # What is below the normal doubles is rounded once more, which is right but on a tie.
    left = absolute(first - times_power_of_two(double, -1.0 * value.exponent))
    half_a_step = times_power_of_two(0.5, -1074.0 - value.exponent)
    return both(sure, either(less(NORMAL, value.exponent), less(left, half_a_step), less(half_a_step, left)))


@lru_cache(KEPT)
def halfway(given: Given, answers: Answers, name: str) -> tuple[Program, Formula] | None:
    """The program that gives a quantity's two doubles, and its formula; none where that is not known yet."""
    try:
        value, plain = (
            getattr(_ColumnsMachine(_RowsCase(given, answers, ar), ar), name) for ar in (PAIRS, DOUBLES)
        )
    except (Asked, Undetermined, Unvouched):
        return None
    return (Program(value.parts), plain) if len(value.parts) == 2 else None


@lru_cache(KEPT)
def questioning(given: Given, answers: Answers, question: str, accuracy: Accuracy, ar: Any) -> Program:
    """The program that tells for each row whether the answer is yes, and whether that is sure."""
    wrap = Formula("symbol", "wrap")
    sure = less(0.0, wrap)
    if question == "long_wrap":
        return Program([less(180.0, wrap), sure])
    if question == "ends_hang_down":
        return Program([equal(Formula("fmod", wrap, formula(360.0)), 180.0), sure])
    case = _RowsCase(given, answers, ar)
    excess, held = getattr(case, question)(ar), Machine[Any](case, ar).k1
    if ar is not DOUBLES:
        margin = excess - held
        return Program([less(0.0, margin.parts[0]), less(margin.bound, 0.5)])
    if accuracy == "fast":
        return Program([less(held, excess), equal(0.0, 0.0)])
    beaten = less(held * (1 + CLEAR), excess)
    return Program([beaten, either(beaten, less(excess, held * (1 - CLEAR)))])
