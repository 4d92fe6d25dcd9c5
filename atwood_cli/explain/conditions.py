"""Decide exactly what a script expects: a regime, or a quantity compared with a number."""

import operator
import re
from collections.abc import Callable, Iterable
from decimal import Decimal
from fractions import Fraction
from typing import Any, NamedTuple

from ..numbers.digits import (
    SHOWN_DIGITS,
    as_typed,
    format_number,
    is_infinite,
    rounding_apart_from,
    to_digits,
)
from ..numbers.text import in_quotes
from ..reading.names import NAMES_BY_SYMBOL, read_name
from ..reading.units import OTHER_TERMS, Malformed, dimension_of, read_number
from ..solver.answers import TOO_SMALL, Answers
from ..solver.decisions import REGIME_ASSUMED
from ..solver.quantities import NO_NEED, QUANTITIES, REGIMES, Undetermined
from ..solver.scene import INPUTS, MEASURED, NOT_GIVEN, Angle, Input, SceneError, with_unit
from .messages import ends_nearby, unmarked

COMPARISON = "([^<>=]*)(<=|>=|==|<|>)([^<>=]*)"
OPERATORS: dict[str, Callable[[Any, Any], bool]] = {
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
}
HOW_TO_EXPECT = "no-slip, slip or verge, or a comparison by < <= > >= ==, as 'safety_factor >= 1.5'"

SIGNED = ("acceleration", "tension_difference", "torque", "rim_acceleration", "angular_acceleration")
"""The quantities with the sign of the motion."""
COMPARED_TERMS = OTHER_TERMS | {measured.unit: measured.terms for measured in MEASURED.values()}
"""The other terms in which a quantity may be compared, by its unit. Those of measurements may need R."""


class Condition(NamedTuple):
    """What is expected: the text that was typed, a regime, or a quantity with a comparison and a number."""

    typed: str
    name: str
    sign: str = ""
    bound: Input = NOT_GIVEN


def read_condition(typed: str) -> Condition:
    """Read a condition. Raises SceneError."""
    if (regime := re.sub(r"^\s*regime\s*==", "", typed).strip()) in REGIMES:
        return Condition(typed.strip(), regime)
    if not (match := re.fullmatch(COMPARISON, typed)):
        raise SceneError("expect", typed, f"must be {HOW_TO_EXPECT}")
    word, sign, number = map(str.strip, match.groups())
    name = read_name("expect", word, QUANTITIES, "quantity", NAMES_BY_SYMBOL)
    unit = QUANTITIES[name].unit
    try:
        bound = read_number(number, dimension_of(unit), COMPARED_TERMS.get(unit, ()))
    except Malformed as error:
        raise SceneError("expect", typed, f"compares with {in_quotes(number)}, which {error}") from None
    if bound.uncertainty and sign != "==":
        rule = "compares with an uncertain number, which only == takes: it holds within the uncertainty"
        raise SceneError("expect", typed, rule)
    return Condition(typed.strip(), name, sign, bound)


def failures_of(answers: Answers, conditions: Iterable[Condition]) -> dict[str, str]:
    """Return the conditions that fail, as typed, each with what holds instead."""
    return {condition.typed: why for condition in conditions if (why := failure(answers, condition))}


def failure(answers: Answers, expected: Condition) -> str:
    """Say what holds instead of what is expected, "" if that holds."""
    ends, terms = [end.answers for _, _, end in ends_nearby(answers)], expected.bound.unit.terms
    if terms and getattr(answers.decided.scene, terms.by) is None:
        return f"expected {expected.typed}; {terms.words} needs {terms.by}"
    if not _holds(answers, expected):
        instead = unmarked(_instead(answers, expected))
    elif not all(end and _holds(end, expected) for end in ends):
        instead = "within two standard uncertainties it may fail"
    elif expected.name in REGIMES and any(scene.decided.mu_assumed for scene in (answers, *ends) if scene):
        instead = f"that is only {REGIME_ASSUMED}"
    else:
        return ""
    return f"expected {expected.typed}; {instead}"


def _holds(answers: Answers, expected: Condition) -> bool:
    """Decide whether a condition is true; a comparison is not if the quantity has no finite value."""
    if expected.name in REGIMES:
        return bool(answers["regime"] == expected.name)
    bound = expected.bound
    try:
        if expected.sign == "==":
            least, most = (
                bound._replace(number=bound.number + u) for u in (-bound.uncertainty, bound.uncertainty)
            )
            return bool(_above(answers, expected.name, most) <= 0 <= _above(answers, expected.name, least))
        return bool(OPERATORS[expected.sign](_above(answers, expected.name, bound), 0))
    except Undetermined as undetermined:
        return str(undetermined) == NO_NEED and ">" in expected.sign
    except ArithmeticError:
        return False


def _instead(answers: Answers, expected: Condition) -> str:
    """Say the regime, or the value of the quantity, or why it has none."""
    if expected.name in REGIMES and answers["regime"]:
        return f"it is {answers['regime']}"
    if expected.name in INPUTS and expected.name != answers.decided.motion.finds:
        return f"{expected.name} is an input, and no measured motion finds it"
    name = "regime" if expected.name in REGIMES else expected.name
    value, reason = answers.answer(name)
    if value is None or reason == TOO_SMALL:
        why = reason if reason.startswith("no value") else f"no value: {reason}"
        return f"{name} has {why}"
    bound = expected.bound
    given = None if bound.unit.symbol == "rad" else _in_its_unit(answers, bound)
    if given is not None and not _above(answers, expected.name, bound):
        # Digits would not show that the two are equal.
        shown = as_typed(given)
    else:
        value = answers.rounded(expected.name, rounding_apart_from(given, answers.digits or SHOWN_DIGITS))
        shown = "too large to be written out" if is_infinite(value) else format_number(value)
    is_exact = expected.sign == "==" and given and not bound.uncertainty
    hint = "; a rounded number takes its uncertainty, as 'a == 2.17926(1)' or 2.179±0.001" if is_exact else ""
    if expected.name in SIGNED and value < 0 < bound.number:
        hint = "; it is positive when m2 descends"
    return f"it is {with_unit(shown, QUANTITIES[expected.name].unit)}{hint}"


def _above(answers: Answers, name: str, bound: Input) -> float | Decimal:
    """Return a quantity less the number that it is compared with, to one digit. Raises Undetermined."""

    def difference(machine: Any) -> Any:
        number: Any = _in_its_unit(answers, bound)
        angle = Angle(number, "rad" if bound.unit.symbol == "rad" else "°")
        return getattr(machine, name) - angle.degrees(machine.ar)

    return answers.settle(difference, to_digits(1))


def _in_its_unit(answers: Answers, bound: Input) -> Fraction:
    """Return the number in the unit of the quantity; radians stay radians."""
    number, kind = Fraction(bound.number), bound.unit.terms
    return kind.own(number, getattr(answers.decided.scene, kind.by)) if kind else number
