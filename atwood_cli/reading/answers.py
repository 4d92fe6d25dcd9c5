"""Read what is given, and return its answers."""

from __future__ import annotations

from collections.abc import Mapping

from ..solver.answers import Answers
from ..solver.scene import INPUTS, MEASURED, Given, Input, Scene, SceneError
from .inputs import read_input
from .units import GRAVITY, read_number


def read_answers(given: Mapping[str, Given | None], digits: int | None) -> Answers:
    """Read the inputs, which may have uncertainties, and return the answers. Raises SceneError."""
    inputs = {name: read_input(name, given.get(name)) for name in (*INPUTS, *MEASURED)}
    inputs["a"] = _of_gravity(inputs["a"], inputs["g"])
    if all(inputs[name].given is None for name in MEASURED):
        scene = Scene.of(inputs)
    else:
        from ..solver.inverse import read_motion

        scene = read_motion(inputs)
    uncertain = {name: read.uncertainty for name, read in inputs.items() if read.uncertainty}
    if not uncertain:
        return Answers(scene, digits)
    from ..solver.uncertainty import UncertainAnswers

    return UncertainAnswers(scene, digits, uncertain)


def _of_gravity(a: Input, g: Input) -> Input:
    """Return an acceleration; one typed as a multiple of g is of the scene's. Raises SceneError."""
    if not isinstance(a.given, str):
        return a
    number = read_number(a.given, "acceleration")
    if g.uncertainty and number.unit == GRAVITY:
        raise SceneError("a", a.given, "is a multiple of g, which is uncertain; give it in m/s2")
    value, _, uncertainty = number.with_gravity(g.value)
    return a._replace(value=value, uncertainty=uncertainty)
