"""The inputs of a scene as they were given: in words, and as JSON has them."""

from collections.abc import Mapping
from decimal import Decimal
from fractions import Fraction
from math import inf
from typing import Any

from ..numbers.digits import Rounding, as_typed, exact_or_rounded, format_number, to_double
from ..numbers.rational import Typed
from ..solver.decisions import Decisions
from ..solver.scene import INERTIA_FACTORS, INPUTS, MEASURED, Scene, parameter_of, with_unit

VERSION = 3
"""The version of JSON's keys (see `examples/json.md`), which grows when a key goes or changes its meaning."""


def scene_record(scene: Scene, round_: Rounding[Any] = to_double) -> dict[str, object]:
    """Return the inputs for JSON, in SI units and degrees: numbers, or text with a unit.

    A number that is a finite decimal is exact. Others are rounded as results are.
    """
    values = {**scene._asdict(), **scene.motion._asdict(), str(scene.motion.finds): None}
    own = {name: (values[name], "") for name in (*INPUTS, *MEASURED)}
    with_units = {name: given for name, given in _given(scene).items() if name in ("axle", "wrap")}
    return {name: _written(*given, round_) for name, given in (own | with_units).items()}


def terms_record(scene: Scene, round_: Rounding[Any] = to_double) -> dict[str, object]:
    """Return the inputs that were given in other terms than those of `scene_record`, as text with a unit."""
    given = _given(scene)
    return {name: _written(*given[name], round_) for name, _ in scene.terms}


def _written(value: object, unit: str, round_: Rounding[Any]) -> object:
    if not isinstance(value, Fraction):
        return "inf" if value == inf else value
    number = exact_or_rounded(value, round_)
    return f"{format_number(number)}{unit}" if unit else number


def _given(scene: Scene) -> dict[str, tuple[Any, str]]:
    """Return the inputs as they were given, by name, each with its unit if this is not the usual one."""
    given = {name: scene.given_as(name) for name in (*INPUTS, *MEASURED) if name != scene.motion.finds}
    units = {"°": "", "rad": "rad"}
    return {
        name: (getattr(value, "number", value), units.get(unit, f" {unit}") if unit else "")
        for name, value in given.items()
        for unit in [getattr(value, "unit", "")]
    }


def in_unit_typed(value: Fraction) -> tuple[Fraction, str]:
    """Return a number in the unit in which it was typed, and that unit; "" if this is the usual one."""
    if isinstance(value, Typed) and value.in_unit:
        return value / value.factor, value.in_unit.replace("2", "²")
    return value, ""


def inputs_in_words(scene: Scene, uncertain: Mapping[str, Fraction] = {}) -> dict[str, str]:
    """Say each input, as m1 = 1 kg, with at least as many decimals as its uncertainty: 3.00 ± 0.02."""
    parts = {}
    for name, (value, unit) in _given(scene).items():
        words, typed_unit = str(value), ""
        if isinstance(value, Fraction):
            number, typed_unit = in_unit_typed(value)
            words = getattr(value, "quotient", "") or as_typed(number)
        if name in uncertain:
            u = as_typed(uncertain[name] / getattr(value, "factor", 1))
            if not {"e", "/"} & {*words, *u}:
                decimals = max(len(number.partition(".")[2]) for number in (words, u))
                words = f"{Decimal(words):.{decimals}f}"
            words = f"{words} ± {u}"
        if isinstance(value, Fraction):
            unit = "" if typed_unit else unit
            words = f"{words}{unit}" if unit else with_unit(words, typed_unit or parameter_of(name).unit)
        if value is not None:
            parts[name] = f"{name} = {words}"
    return parts


def inputs_with_effect(
    scene: Scene, uncertain: Mapping[str, Fraction] = {}, ranges: Mapping[str, str] = {}
) -> dict[str, str]:
    """Say each input, and ``ranges``, but not the usual shape of a pulley that has no mass or is locked."""
    words, decided = {**inputs_in_words(scene, uncertain), **ranges}, Decisions(scene)
    has_usual_shape = scene.inertia == Fraction(INERTIA_FACTORS["disk"])
    if has_usual_shape and (decided.locked or decided.pulley_mass == 0) and not {"M", "inertia"} & {*ranges}:
        del words["inertia"]
    return words
