"""The inputs of a scene as they were given: in words, and as JSON has them."""

from collections.abc import Mapping
from decimal import Decimal
from fractions import Fraction
from math import inf
from typing import Any

from ..numbers.digits import Rounding, as_typed, exact_or_rounded, format_number, to_double
from ..solver.answers import Answers
from ..solver.scene import INERTIA_FACTORS, INPUTS, MEASURED, WEIGHT, Scene, Terms, parameter_of, with_unit

VERSION = 3
"""The version of JSON's keys (see `examples/json.md`), which grows when a key goes or changes its meaning."""


def scene_record(scene: Scene, round_: Rounding[Any] = to_double) -> dict[str, object]:
    """Return the inputs for JSON, in SI units and degrees: numbers, or text with a unit.

    A number that is a finite decimal is exact. Others are rounded as results are.
    """
    own = {name: _rounded(scene.own(name), round_) for name in (*INPUTS, *MEASURED)}
    with_units = {name: _as_given(scene, name, round_) for name in ("wrap", "axle")}
    return own | with_units | dict.fromkeys(filter(None, [scene.motion.finds]))


def terms_record(scene: Scene, round_: Rounding[Any] = to_double) -> dict[str, object]:
    """Return the inputs that were given in other terms than those of `scene_record`, as text with a unit."""
    return {name: _as_given(scene, name, round_) for name, _ in scene.terms}


def _as_given(scene: Scene, name: str, round_: Rounding[Any]) -> object:
    """Return the number given for an input, as text with its unit if this is not the usual one."""
    number, unit = _rounded(scene.as_given(name), round_), scene.unit_of(name)
    if number is None or unit == parameter_of(name).unit:
        return number
    return f"{format_number(number)}{'' if unit == 'rad' else ' '}{unit}"


def _rounded(value: Any, round_: Rounding[Any]) -> Any:
    if isinstance(value, Fraction):
        return exact_or_rounded(value, round_)
    return "inf" if value == inf else value


WEIGHTS = {"m1": "W1", "m2": "W2", "M": "W_M"}
"""The names of weights, by those of masses."""


def label(x: str, terms: Terms | None) -> str:
    """Return the name of the number of an input in these terms: W1 if they are weights of m1."""
    return WEIGHTS[x] if terms == WEIGHT else x


def inputs_in_words(answers: Answers) -> dict[str, str]:
    """Say each input, as m1 = 1 kg or W1 = 20 N."""
    scene = answers.decided.scene
    given = [x for x in (*INPUTS, *MEASURED) if scene.as_given(x) is not None and x != scene.motion.finds]
    return {x: f"{label(x, dict(scene.terms).get(x))} = {as_given(answers, x)}" for x in given}


def as_given(answers: Answers, x: str) -> str:
    """Say the number given for an input, with at least as many decimals as its uncertainty: 3.00 ± 0.02."""
    typed, scene = answers.typed(x), answers.decided.scene
    if (number := scene.as_given(x)) == inf:
        return "inf"
    words = typed.quotient or as_typed(number / typed.unit.size)
    if typed.uncertainty:
        u = as_typed(typed.uncertainty / typed.unit.size)
        if not {"e", "/"} & {*words, *u}:
            decimals = max(len(number.partition(".")[2]) for number in (words, u))
            words = f"{Decimal(words):.{decimals}f}"
        words = f"{words} ± {u}"
    return with_unit(words, typed.unit.in_words or scene.unit_of(x))


def inputs_with_effect(answers: Answers, ranges: Mapping[str, str] = {}) -> dict[str, str]:
    """Say each input, and ``ranges``, but not the usual shape of a pulley that has no mass or is locked."""
    words, decided = {**inputs_in_words(answers), **ranges}, answers.decided
    has_usual_shape = decided.scene.inertia == Fraction(INERTIA_FACTORS["disk"])
    if has_usual_shape and (decided.locked or decided.pulley_mass == 0) and not {"M", "inertia"} & {*ranges}:
        del words["inertia"]
    return words
