"""How arrays are certified: what is done for a group of rows, and why the results keep what is promised.

Take the row m1 = 1, m2 = 3, M = 100, mu = 0.3, and its acceleration, certified. (u = 2^-53)

1. The row joins all rows with the same `Pattern`: m2 is heavier, M and mu are given, nothing is zero.
2. The model of one scene (`Machine`) runs on formulas of columns. It asks: does the string slip? That is, is
   T_h/T_l - 1 = 1.786 of a string that grips above e^{μφ} - 1 = 1.566? Doubles suffice to say yes here. The
   rows that say yes go on as a group, of which the model asks nothing more.
3. The formulas become a `Program` of some hundred NumPy operations. It computes with double-doubles, which
   have an error bound. For this row it gives 0.764026672247107, off by at most 0.03 u of that. The bound is
   below 3.49 u, so the value is certified. (The exact one is 0.76402667224710707.)
4. Beside it, the row M = 1e6, mu = 0.34969 hardly slips: m2 - e^{μφ} m1 = 8.6e-5 has lost too many digits,
   and the bound is 146 u. Only this row, and only this quantity, goes to the next level of precision. There
   an expansion of two doubles is off by at most 1.7e-25 of the value.

What each accuracy promises, and why it holds:

- ``fast``: plain doubles, without bounds. They also decide whether a string slips. An e^{μφ} beyond the
  doubles makes results infinite, even where a tiny mass would bring them back.
- ``certified``: every regime is right, and every value within 4 units in the last place (ulp) of the exact
  one for the given doubles. The levels are double-doubles (`ROUNDED` if that suffices in all rows, else
  `QUICK`), expansions of two and of three doubles (`PAIRS`, `TRIPLES`), and in the end the exact arithmetic
  of a single scene. A value is certified where its bound is at most 3.49 u of it: that is at most 3.49 ulp,
  and to round to a double costs half an ulp more.
  (Just below a power of two, half an ulp of the double may be a whole one of the exact value: there it is
  4.49 ulp.) A question is answered by doubles where its sides differ by a 2^-40 of them, far more than their
  few roundings; else by the sign of the difference, if its bound is below 1/2.
- ``exact``: the double nearest to the exact value, by the same levels. A value is certified where both ends
  of its bound round to the same double (Ziv's test), or where it is exact. A tie, half-way between two
  doubles, never passes. A rational value that is nearer to a tie than it could be without being one (see
  `gap`) is that tie.

Rows with an input beyond `double_double.WINDOW` (or `FAST_WINDOW`), other than 0, start with expansions of
three doubles, whose range is wider than that of doubles.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import lru_cache
from math import inf
from typing import Any, Literal, NamedTuple

from ..arithmetic.lazy import lazy
from ..arithmetic.symbolic import Formula, Term, formula
from ..model.angle import Angle
from ..model.axle import Axle
from ..model.case import Case, Excess, is_zero
from ..model.machine import Machine, Undetermined
from ..model.quantities import REGIMES, Accuracy
from ..model.scene import INPUTS, Scene
from .double import (
    DOUBLES,
    Uncertified,
    absolute,
    at_most,
    both,
    either,
    equal,
    is_finite,
    less,
)
from .double_double import QUICK, ROUNDED
from .error_free import UNIT
from .expansion import PAIRS, TRIPLES, Expansion, Parts, normal, times_power_of_two
from .program import Program

LEVELS: dict[str, tuple[Any, ...]] = {
    "fast": (DOUBLES, TRIPLES),
    "certified": (QUICK, PAIRS, TRIPLES),
    "exact": (QUICK, PAIRS, TRIPLES),
}
"""The arithmetics of each accuracy's levels of precision."""
LIMITS = {"fast": inf, "certified": 3.49 * UNIT, "exact": UNIT / 16}
"""The largest bound to be certified. With a larger one few rows would pass for exact."""
CLEAR = 2.0**-40
"""The relative difference of two sides at which doubles answer a question."""
CANCELS = "beats_friction lightest_held_excess"
"""The question that doubles do not answer, as the heavier mass less what the axle holds may cancel."""
FINE = 2.0**-104
"""Of a value, more than the rounding errors of the ends of its bound, and than all parts after the second."""
NORMAL = -1021.0  # below this power of two a double has fewer bits

SIGNED = (
    "acceleration",
    "friction_force_x",
    "friction_force_y",
    "torque",
    "rim_acceleration",
    "angular_acceleration",
)

KEPT = 256  # plans: enough for ten patterns; the longest, of all quantities in triples, takes 3 MB

COLUMN = "column"


class Pattern(NamedTuple):
    """What rows have in common before any question: which mass is heavier (`Case.sign`), and each input.

    An input is None (not given), inf, a Fraction that is the same in all rows, or COLUMN.
    """

    sign: int
    inputs: tuple[Fraction | float | str | None, ...]

    def scene(self, column: Callable[[str], Any]) -> Scene:
        """The scene of a row, or of all of them; ``column`` gives the number of an input that is a column."""
        fields: dict[str, Any] = {
            name: column(name) if value == COLUMN else value
            for name, value in zip(INPUTS, self.inputs, strict=True)
        }
        fields["wrap"] = Angle(fields["wrap"])
        fields["axle"] = None if fields["axle"] is None else Axle(fields["axle"])
        return Scene(**fields)


Decisions = frozenset[tuple[str, bool]]
"""Questions, and what the rows of a group have answered."""


class Task(NamedTuple):
    """Quantities to compute, at a level of precision, for the rows of one pattern and the same decisions."""

    pattern: Pattern
    decisions: Decisions
    names: tuple[str, ...]
    level: int


class Asked(Exception):
    """The model asks a question that the rows have not answered yet."""


class _GroupCase(Case):
    """The case of a group of rows: its inputs are columns, and its decisions are those of the group."""

    def __init__(self, pattern: Pattern, decisions: Decisions, ar: Any) -> None:
        super().__init__(pattern.scene(lambda name: ar.number(Formula("symbol", name))))
        self.sign, self._decisions = pattern.sign, dict(decisions)
        _covers(self.heavy, self.light)

    @lazy
    def rim_mass(self) -> Any:
        """A pulley without mass has none at its rim, even where its inertia factor is a column."""
        return self.pulley_mass if is_zero(self.pulley_mass) else super().rim_mass

    def _decided(self, question: str) -> bool:
        if question not in self._decisions:
            raise Asked(question)
        return self._decisions[question]

    @lazy
    def long_wrap(self) -> bool:
        wrap = self.scene.wrap
        return wrap.is_beyond_half_turn if isinstance(wrap.number, Fraction) else self._decided("long_wrap")

    @lazy
    def ends_hang_down(self) -> bool:
        wrap = self.scene.wrap
        return wrap.ends_hang_down if isinstance(wrap.number, Fraction) else self._decided("ends_hang_down")

    def beats_friction(self, which: Excess) -> bool:
        return self._decided(f"beats_friction {which}")

    def beats_limit(self, which: Excess) -> bool:
        return self.beats_friction(which) if self.at_static_limit else self._decided(f"beats_limit {which}")

    def moves_axle(self, which: Literal["difference", "heavy"]) -> bool:
        return self._decided(f"moves_axle {which}")


def _covers(larger: Any, smaller: Any) -> None:
    """State that a number is less than another one in no row."""
    if isinstance(larger, Expansion) and isinstance(smaller, Expansion):
        larger.covers = smaller.parts[0]


def _never_negative(name: str) -> Any:
    """An attribute of `Machine`, with the statement that no row is negative."""

    def stated(machine: _ColumnsMachine) -> Any:
        number = getattr(super(_ColumnsMachine, machine), name)
        if isinstance(number, Expansion):
            number.positive = True
        return number

    return lazy(stated)


class _ColumnsMachine(Machine[Any]):
    """The model of columns. It states what is never negative or never the larger, to save work."""

    drive, limiting_drive, gripping_drive, excess = map(
        _never_negative, ("drive", "limiting_drive", "gripping_drive", "excess")
    )

    @lazy
    def magnitude(self) -> Any:
        """The acceleration without its sign, which is never above g."""
        magnitude = super().magnitude
        _covers(self.g, magnitude)
        return magnitude


def _from_finer(name: str) -> Any:
    """An attribute that is computed by the finer machine and then rounded."""
    return lazy(lambda machine: ROUNDED.number(getattr(machine.finer, name)))


class _RoundedMachine(_ColumnsMachine):
    """A machine with rounded products. What enters a difference that cancels comes from a finer machine."""

    def __init__(self, finer: Machine[Any]) -> None:
        super().__init__(finer.case, ROUNDED)
        self.finer = finer

    phi, k1, excess, transfer, drive = map(_from_finer, ("phi", "k1", "excess", "transfer", "drive"))


class Plan(NamedTuple):
    """What is done for a task.

    The program gives the ``quantities``, and then, for each of the ``conditional`` ones, whether a row is
    certified. ``constants`` have the same value in all rows, ``missing`` have none, for a reason. ``later``
    cannot be computed at this level. Those that are ``asking`` need the answer to the ``question`` first. If
    there is one, the program gives in the end whether the answer is certain, and whether it is yes.
    """

    program: Program | None
    quantities: tuple[str, ...]
    conditional: tuple[str, ...]
    constants: tuple[tuple[str, float], ...]
    missing: tuple[tuple[str, str], ...]
    later: tuple[str, ...]
    question: str
    asking: tuple[str, ...]


@lru_cache(KEPT)
def plan(task: Task, accuracy: Accuracy) -> Plan:
    """The plan for a task. Certified values come with rounded products if these suffice for all of them.

    Beside an axle they are not tried, as more differences of products cancel there.
    """
    arithmetic = LEVELS[accuracy][task.level]
    machine = _ColumnsMachine(_GroupCase(task.pattern, task.decisions, arithmetic), arithmetic)
    if arithmetic is QUICK and accuracy == "certified" and machine.f is None:
        rounded = _planned(task, accuracy, _RoundedMachine(machine))
        if not rounded.later:
            return rounded
    return _planned(task, accuracy, machine)


def _planned(task: Task, accuracy: Accuracy, machine: Machine[Any]) -> Plan:
    """The plan for a task with the model in this arithmetic."""
    values: dict[str, Term] = {}
    certified: dict[str, Formula] = {}
    constants: list[tuple[str, float]] = []
    missing: list[tuple[str, str]] = []
    later, asking, question = [], [], ""
    for name in task.names:
        try:
            if name == "regime":
                constants.append((name, REGIMES.index(machine.case.regime)))
                continue
            value, condition = _value(machine, name, accuracy)
        except Asked as asked:
            question = question or str(asked)
            asking.append(name)
        except Undetermined as undetermined:
            missing.append((name, str(undetermined)))
        except Uncertified:
            later.append(name)
        else:
            values[name] = value
            if condition is not None:
                certified[name] = condition
    formulas = [*values.values(), *certified.values()]
    if question:
        formulas += _answer(task, question, accuracy, levels_of(question, task.level, accuracy)[0])
    program = Program(formulas) if formulas else None
    fixed = tuple(constants), tuple(missing)
    return Plan(program, tuple(values), tuple(certified), *fixed, tuple(later), question, tuple(asking))


def _value(machine: Machine[Any], name: str, accuracy: Accuracy) -> tuple[Term, Formula | None]:
    """A quantity as a double, and the condition under which a row's double is certified; None for none.

    The model gives the quantity as a number with an error bound. What must hold depends on the accuracy:
    nothing (fast), that the bound is within its limit (certified), or that the whole interval of the bound
    rounds to the same double (exact). Raises Uncertified where the bound is too large in all rows,
    Undetermined for a quantity without a value, Asked for an open question.
    """
    value = getattr(machine, name)
    if isinstance(value, Formula):  # a double already, and without a bound
        return value + 0.0 if name in SIGNED else value, None  # 0.0 makes 0 of -0
    limit = LIMITS[accuracy]
    if value.loss > limit:
        raise Uncertified
    wide = value.arithmetic.wide
    parts = normal(value.parts)
    double: Any = times_power_of_two(parts[0], value.exponent) if wide else parts[0]
    double = double if value.positive else double + 0.0
    if accuracy == "fast":
        return double, None
    if accuracy == "exact":
        return double, _is_nearest(double, parts, value)
    small = None if value.doubt is None else at_most(value.doubt, limit - value.loss)
    if value.arithmetic is not PAIRS:
        return double, small
    finite = is_finite(double)  # e^{μφ} may leave the doubles
    return double, finite if small is None else both(small, finite)


def _is_nearest(double: Term, parts: Parts, value: Expansion) -> Formula:
    """Whether a double is the nearest to the exact value: both ends of the error bound round to it.

    ``parts`` are the value's, normalized: the first one is the double, but for a power of two.
    """
    first, second, third = (*parts, 0.0, 0.0)[:3]
    error = absolute(first) * (value.bound + FINE)
    same = both(equal(first + (second - error), first), equal(first + (second + error), first))
    exact = both(equal(value.bound, 0.0), equal(third, 0.0))
    sure = either(same, exact)
    if not value.arithmetic.wide:
        return sure
    # Below the normal doubles the result is rounded a second time. That is right unless it is then a tie.
    left = absolute(first - times_power_of_two(double, -1.0 * value.exponent))
    half_a_step = times_power_of_two(0.5, -1074.0 - value.exponent)
    no_tie = either(less(left, half_a_step), less(half_a_step, left))
    return both(sure, either(less(NORMAL, value.exponent), no_tie))


@lru_cache(KEPT)
def in_pairs(pattern: Pattern, decisions: Decisions, name: str) -> tuple[Program, Formula]:
    """The program for a quantity's two doubles and the bound on their error, and its plain formula."""
    value, plain = (
        getattr(_ColumnsMachine(_GroupCase(pattern, decisions, ar), ar), name) for ar in (PAIRS, DOUBLES)
    )
    first, second = (*value.parts, 0.0)[:2]
    return Program([first, second, absolute(first) * value.bound]), plain


def levels_of(question: str, level: int, accuracy: Accuracy) -> tuple[Any, ...]:
    """The arithmetics that answer a question of a task of that level, one after the other."""
    if LEVELS[accuracy][level] is TRIPLES:
        return (TRIPLES,)
    return (PAIRS, TRIPLES) if question == CANCELS and accuracy != "fast" else (DOUBLES, PAIRS, TRIPLES)


@lru_cache(KEPT)
def questioning(task: Task, question: str, accuracy: Accuracy, ar: Any) -> Program:
    """The program that answers a question in each row: whether that is certain, and whether it is yes."""
    return Program(_answer(task, question, accuracy, ar))


def _answer(task: Task, question: str, accuracy: Accuracy, ar: Any) -> tuple[Formula, Formula]:
    """Whether the answer to a question is certain, and whether it is yes."""
    wrap = Formula("symbol", "wrap")
    sure = less(0.0, wrap)
    if question == "long_wrap":
        return sure, less(180.0, wrap)
    if question == "ends_hang_down":
        return sure, equal(Formula("fmod", wrap, formula(360.0)), 180.0)
    case = _GroupCase(task.pattern, task.decisions, ar)
    machine, (method, which) = Machine[Any](case, ar), question.split()
    one: Any
    other: Any
    if method == "moves_axle":
        one, other = getattr(case, which) * machine.g, machine.f
    else:
        one = getattr(case, which)(ar)
        other = machine.k1 if method == "beats_friction" else machine.limiting_k1
    if ar is not DOUBLES:
        margin = one - other
        return less(margin.bound, 0.5), less(0.0, margin.parts[0])
    if accuracy == "fast":
        return equal(0.0, 0.0), less(other, one)
    clear = less(other * (1 + CLEAR), one)
    return either(clear, less(one, other * (1 - CLEAR))), clear
