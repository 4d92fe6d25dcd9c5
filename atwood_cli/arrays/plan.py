"""How arrays are solved: what is done for a group of rows, and why the results keep what is promised.

Take the row m1 = 1, m2 = 3, M = 100, mu = 0.3, and its acceleration, certified.

1. The row joins all rows with the same `Pattern`: m2 is heavier, M and mu are given, nothing is zero.
2. The model of one scene (`Machine`) runs on formulas of columns. It asks: does the string slip? That is, is
   ln(T_h/T_l) = 1.025 of a string that grips above μφ = 0.942? The rows that say yes go on as a group, of
   which the model asks nothing more.
3. The formulas become a `Program` of some twenty NumPy operations on doubles, with a bound on their error
   (see `doubles`). For this row it gives 0.764026672247107, off by at most 6e-15 of that. The bound is below
   2e-14, so the value is certified.
4. Another row of the group, M = 1e6, mu = 0.34969, hardly slips: m2 - e^{μφ} m1 = 8.6e-5 has lost too many
   digits, and the bound is 3e-11. This quantity of this row goes to the next level of precision: sums of two
   doubles (see `pairs`) are off by at most 3e-26 of the value. Up to four such rows are solved one by one
   instead, exactly, as `solve` does it.

What each accuracy promises, and why it holds:

- ``certified``: every regime is right, and every relative error below 2e-14. The levels are doubles, pairs,
  and in the end the exact arithmetic of a single scene. A value is certified where its bound is within the
  limit. A question is answered by the sign of a difference, if its bound is below 1/4.
- ``exact``: the double nearest to the exact value, by pairs and then by a single scene. A value is certified
  where both ends of its bound round to the same double (Ziv's test), or where it is the product of two
  inputs, whose pair is exact. Other ties, half-way between two doubles, are left to a single scene.
  Questions are asked in doubles first here, too.

Rows with an input beyond `doubles.WINDOW`, other than 0, are solved one by one at once. Quantities are, too,
if they need the sine of an angle that is computed, not given in degrees: the least and the greatest friction
force.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import lru_cache
from math import nan
from typing import Any, Literal, NamedTuple, cast

from ..numbers.digits import to_double
from ..numbers.formula import Formula, Term, formula
from ..numbers.lazy import lazy
from ..numbers.settling import settle
from ..solver.decisions import Decisions, LimitingCase
from ..solver.machine import Machine
from ..solver.quantities import REGIMES, Accuracy, Undetermined
from ..solver.scene import COLUMNS, FALL, Angle, Motion, Scene, Terms, in_own_terms
from .doubles import DOUBLES, Doubles, NoProgram, equal, less, proven_double
from .pairs import PAIRS
from .program import Program

LEVELS: dict[str, tuple[Doubles, ...]] = {"certified": (DOUBLES, PAIRS), "exact": (PAIRS,)}
"""The arithmetics of each accuracy's levels of precision."""
ENOUGH_DIGITS = 32
"""The digits of a first computation: they settle most rows that doubles cannot certify."""
KEPT_PLANS = 256
"""The number of plans that are kept: enough for ten patterns."""

COLUMN = "column"
"""The entry of a pattern for an input that each row has for itself."""


class Pattern(NamedTuple):
    """What rows have in common before any question: their `Decisions.heavier_side`, and each input.

    An input is None (not given), inf, a Fraction that is the same in all rows, or COLUMN. ``terms`` are those
    of columns that are not in the terms of their input.
    """

    heavier_side: int
    inputs: tuple[Fraction | float | str | None, ...]
    terms: tuple[tuple[str, Terms], ...] = ()

    def scene(self, column: Callable[[str], Any]) -> Scene:
        """Return the scene of a row, or of all rows; ``column`` gives the number of an input by its name."""
        fields: dict[str, Any] = {
            name: column(name) if value == COLUMN else value
            for name, value in zip(COLUMNS, self.inputs, strict=True)
        }
        fields["wrap"] = Angle(fields["wrap"])
        own = in_own_terms(fields, dict(self.terms))
        return Scene(motion=Motion(**{name: own.pop(name) for name in FALL}), **own)


USUALLY_SO = ("moves_axle difference", "moves_axle heavy")
"""The questions that most rows answer with yes; others they answer with no."""
Branches = frozenset[tuple[str, bool]]
"""Questions, each with the answer of a group's rows."""


class Task(NamedTuple):
    """Quantities to compute at a level of precision, for rows with one pattern and the same decisions."""

    pattern: Pattern
    branches: Branches
    names: tuple[str, ...]
    level: int


class Undecided(Exception):
    """The model needs the answer to a question that is not among the decisions of a group of rows.

    `plan` catches it, and the program of the plan answers the question in each row. The model then runs again
    for the rows with either answer, which is then among their decisions.
    """


class _GroupDecisions(Decisions):
    """The decisions about a group of rows, or about a row in it, which has those of its group."""

    def __init__(self, task: Task, number: Callable[[str], Any]) -> None:
        super().__init__(task.pattern.scene(number))
        self.heavier_side, self._branches = task.pattern.heavier_side, dict(task.branches)

    def _branch(self, question: str) -> bool:
        if question not in self._branches:
            raise Undecided(question)
        return self._branches[question]

    @lazy
    def long_wrap(self) -> bool:
        is_column = not isinstance(self.scene.wrap.number, Fraction)
        return self._branch("long_wrap") if is_column else super().long_wrap

    @lazy
    def ends_hang_down(self) -> bool:
        is_column = not isinstance(self.scene.wrap.number, Fraction)
        return self._branch("ends_hang_down") if is_column else super().ends_hang_down

    def slips_at(self, at: LimitingCase) -> bool:
        return self._branch(f"slips_at {at}")

    def slides_at(self, at: LimitingCase) -> bool:
        return self.slips_at(at) if self.limit_is_static else self._branch(f"slides_at {at}")

    def moves_axle(self, name: Literal["difference", "heavy"]) -> bool:
        return self._branch(f"moves_axle {name}")


def _machine_of_columns(task: Task, ar: Doubles) -> Machine[Any]:
    return Machine(_GroupDecisions(task, lambda name: ar.number(Formula("symbol", name))), ar)


class Step(NamedTuple):
    """What a plan does for those quantities of a task that need no more answers than the task has."""

    task: Task
    to_certify: tuple[str, ...]
    """Quantities of which the program says by `condition_of` in which rows they are certified."""
    missing: dict[str, str]
    """The reasons of quantities without a value."""
    row_by_row: tuple[str, ...]
    """Quantities that no program gives: rows are solved one by one."""
    question: str
    """A question, or "". The program gives each row's answer, and says by `condition_of` if it is sure."""
    tasks_by_answer: list[tuple[bool, Task]]
    """Answers, and the tasks of rows with these. Rows with another answer go on to the plan's next step."""


def condition_of(name: str) -> str:
    """Return the name of a program's result that says whether a quantity is certified, or an answer sure."""
    return f"{name} is certified"


@lru_cache(KEPT_PLANS)
def plan(task: Task, accuracy: Accuracy, adjoin: bool) -> tuple[Program, list[Step]]:
    """Return the plan for a task: its steps, and one program for all of them.

    Where rows adjoin each other, a next step is about those with the usual answer: in doubles it takes less
    time to compute it in all rows than to gather the columns of these.
    """
    steps, formulas, tasks = list[Step](), dict[str, Term](), [task]
    for step_task in tasks:
        step = _step(step_task, accuracy, formulas)
        if step.question and adjoin and LEVELS[accuracy][task.level] is DOUBLES:
            usual, by_answer = step.question in USUALLY_SO, step.tasks_by_answer
            tasks += [usual_task for answer, usual_task in by_answer if answer == usual]
            step = step._replace(tasks_by_answer=[other for other in by_answer if other[0] != usual])
        steps.append(step)
    return Program(formulas), steps


def _step(task: Task, accuracy: Accuracy, formulas: dict[str, Term]) -> Step:
    """Return a step, made by running the model on columns quantity by quantity, and add its formulas."""
    machine = _machine_of_columns(task, LEVELS[accuracy][task.level])
    missing: dict[str, str] = {}
    to_certify, row_by_row, asking, question = [], [], [], ""
    for name in task.names:
        try:
            if name == "regime":
                formulas[name] = REGIMES.index(machine.decided.regime)
                continue
            formulas[name], condition = proven_double(getattr(machine, name), accuracy)
        except Undecided as undecided:
            question = question or str(undecided)
            asking.append(name)
        except Undetermined as undetermined:
            formulas[name], missing[name] = nan, str(undetermined)
        except NoProgram:
            row_by_row.append(name)
        else:
            if condition is not None:
                formulas[condition_of(name)] = condition
                to_certify.append(name)
    tasks_by_answer = []
    if question:
        formulas |= _answer(task, question, DOUBLES)
        for answer in (False, True):
            branches = task.branches | {(question, answer)}
            tasks_by_answer.append((answer, task._replace(branches=branches, names=(*asking,))))
    return Step(task, (*to_certify,), missing, (*row_by_row,), question, tasks_by_answer)


@lru_cache(KEPT_PLANS)
def answering(task: Task, question: str) -> Program:
    """Return the program that answers a question in pairs, and says by `condition_of` whether it is sure."""
    return Program(_answer(task, question, PAIRS))


def _answer(task: Task, question: str, ar: Doubles) -> dict[str, Term]:
    wrap = Formula("symbol", "wrap")
    if question == "long_wrap":
        return {condition_of(question): less(0.0, wrap), question: less(180.0, wrap)}
    if question == "ends_hang_down":
        is_half_turn = equal(Formula("fmod", wrap, formula(360.0)), 180.0)
        return {condition_of(question): less(0.0, wrap), question: is_half_turn}
    machine, (method, point) = _machine_of_columns(task, ar), question.split()
    decided = machine.decided
    if method == "moves_axle":
        margin: Any = getattr(decided, point) * machine.g - machine.f
    else:
        mu = decided.scene.mu if method == "slips_at" else decided.limiting_mu
        margin = decided.margin(decided.ratio_minus_1(cast(LimitingCase, point), ar), cast(Fraction, mu), ar)
    sure = less(margin.row_error, 0.25 - margin.fixed_error)
    return {condition_of(question): sure, question: less(0.0, margin.parts[0])}


def nearest_double(task: Task, name: str, number: Callable[[str], Any]) -> float | None:
    """Solve one quantity of one row exactly, by its group's decisions; None if they do not suffice."""
    decided = _GroupDecisions(task, number)
    try:
        return settle(lambda ar: getattr(Machine(decided, ar), name), to_double, ENOUGH_DIGITS)
    except (Undecided, Undetermined, OverflowError):
        return None
