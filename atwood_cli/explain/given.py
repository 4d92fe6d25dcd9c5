"""The inputs of a scene as they were given: in words, and as JSON has them."""

from collections.abc import Mapping
from decimal import Decimal
from fractions import Fraction
from math import inf
from typing import Any

from ..numbers.digits import Rounding, as_typed, exact_or_rounded, format_number, to_double
from ..solver.answers import Answers
from ..solver.scene import INERTIA_FACTORS, INPUTS, MEASURED, Scene, parameter_of, with_unit

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
    number, unit = _rounded(scene.number_of(name), round_), scene.unit_of(name)
    if number is None or unit == parameter_of(name).unit:
        return number
    return f"{format_number(number)}{'' if unit == 'rad' else ' '}{unit}"


def _rounded(value: Any, round_: Rounding[Any]) -> Any:
    if isinstance(value, Fraction):
        return exact_or_rounded(value, round_)
    return "inf" if value == inf else value


def inputs_in_words(answers: Answers) -> dict[str, str]:
    """Say each input, as m1 = 1 kg, with at least as many decimals as its uncertainty: 3.00 ± 0.02."""
    parts, scene = {}, answers.decided.scene
    for name in (*INPUTS, *MEASURED):
        number = scene.number_of(name)
        if number is None or name == scene.motion.finds:
            continue
        typed = answers.typed(name)
        words = typed.quotient or (as_typed(number / typed.unit.size) if number != inf else "inf")
        if typed.uncertainty:
            u = as_typed(typed.uncertainty / typed.unit.size)
            if not {"e", "/"} & {*words, *u}:
                decimals = max(len(number.partition(".")[2]) for number in (words, u))
                words = f"{Decimal(words):.{decimals}f}"
            words = f"{words} ± {u}"
        unit = typed.unit.in_words or scene.unit_of(name)
        parts[name] = f"{name} = {words if number == inf else with_unit(words, unit)}"
    return parts


def inputs_with_effect(answers: Answers, ranges: Mapping[str, str] = {}) -> dict[str, str]:
    """Say each input, and ``ranges``, but not the usual shape of a pulley that has no mass or is locked."""
    words, decided = {**inputs_in_words(answers), **ranges}, answers.decided
    has_usual_shape = decided.scene.inertia == Fraction(INERTIA_FACTORS["disk"])
    if has_usual_shape and (decided.locked or decided.pulley_mass == 0) and not {"M", "inertia"} & {*ranges}:
        del words["inertia"]
    return words
