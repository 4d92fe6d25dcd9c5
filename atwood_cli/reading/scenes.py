"""Read what is given, and return its answers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ..solver.answers import Answers
from ..solver.scene import FINDABLE, INPUTS, MEASURED, Scene
from .inputs import read_input
from .names import OTHER_NAMES, read_name


def read_answers(given: Mapping[str, Any], digits: int | None) -> Answers:
    """Read the inputs, which may have uncertainties, and what to find. Raises SceneError."""
    signed = ("drop", "speed")  # below 0 if m2 rises
    inputs = {name: read_input(name, given.get(name), name in signed) for name in (*INPUTS, *MEASURED)}
    find = given.get("find")
    if find is None and all(inputs[name].given is None for name in MEASURED):
        scene = Scene.of(inputs, may_lack=True)
    else:
        from ..solver.inverse import read_motion

        if find is not None:
            find = read_name("find", str(find), FINDABLE, "input that a motion finds", OTHER_NAMES)
        scene = read_motion(inputs, find)
    if not any(read.uncertainty for read in inputs.values()):
        return Answers(scene, digits, inputs)
    from ..solver.uncertainty import UncertainAnswers

    return UncertainAnswers(scene, digits, inputs)
