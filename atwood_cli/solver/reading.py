"""From inputs as they are given, measured and uncertain ones among them, to answers."""

from collections.abc import Mapping
from fractions import Fraction

from ..model.scene import INPUTS, MEASURED, UNMEASURED, Given, Input, Scene, SceneError, read_input
from ..model.units import STANDARD_GRAVITY, read_number
from .answers import Answers


def read_answers(given: Mapping[str, Given | None], digits: int | None) -> Answers:
    """The answers to what is given, with uncertainties where an input has one. Raises SceneError."""
    inputs = {name: read_input(name, given.get(name)) for name in (*INPUTS, *MEASURED)}
    inputs["a"] = _of_gravity(inputs["a"], inputs["g"])
    if all(inputs[name].given is None for name in MEASURED):
        scene, motion = Scene.of(inputs), UNMEASURED
    else:
        from ..model import motion as motions

        scene, motion = motions.read(inputs)
        scene = motions.completed(scene, motion)
    uncertain = {name: one.uncertainty for name, one in inputs.items() if one.uncertainty}
    return Answers(scene, digits, motion, uncertain)


def _of_gravity(a: Input, g: Input) -> Input:
    """An acceleration; if it was typed as a multiple of g, that of the scene. Raises SceneError."""
    if not isinstance(a.given, str) or read_number(a.given, "acceleration").unit != "g":
        return a
    if g.uncertainty:
        raise SceneError("a", a.given, "is a multiple of g, which is uncertain; give it in m/s2")
    factor = g.value / Fraction(STANDARD_GRAVITY)
    return a._replace(value=a.value * factor, uncertainty=a.uncertainty * factor)
