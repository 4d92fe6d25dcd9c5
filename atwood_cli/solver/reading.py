"""From inputs as they are given, measured and uncertain ones among them, to answers."""

from collections.abc import Mapping

from ..model.scene import INPUTS, MEASURED, UNMEASURED, Given, Scene, read_input
from .answers import Answers


def read_answers(given: Mapping[str, Given | None], digits: int | None) -> Answers:
    """The answers to what is given, with uncertainties where an input has one. Raises SceneError."""
    inputs = {name: read_input(name, given.get(name)) for name in (*INPUTS, *MEASURED)}
    if all(inputs[name].given is None for name in MEASURED):
        scene, motion = Scene.of(inputs), UNMEASURED
    else:
        from ..model import motion as motions

        scene, motion = motions.read(inputs)
        scene = motions.completed(scene, motion)
    answers = Answers(scene, digits, motion)
    if uncertain := {name: one.uncertainty for name, one in inputs.items() if one.uncertainty}:
        from .uncertainty import Uncertainties

        answers.uncertainties = Uncertainties(answers.case, uncertain)
    return answers
