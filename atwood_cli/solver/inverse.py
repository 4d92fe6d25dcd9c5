"""From a measured acceleration back to what was not given; all of it is rational, but kinetic friction.

Without slip a = g d/s, with the load s = l + h + c: whichever of M, g and a mass is not given follows from a.
In slip the pulley's mass does not enter the motion, so that a gives the kinetic friction instead.
"""

from collections.abc import Mapping
from math import inf
from types import SimpleNamespace
from typing import Any

from ..numbers.digits import (
    SHOWN_DIGITS,
    as_typed,
    format_number,
    rounding_apart_from,
    strip_zeros,
    to_digits,
)
from ..numbers.rational import EXACT
from . import physics
from .decisions import ZERO, Decisions
from .quantities import Undetermined
from .scene import (
    INPUTS,
    MASSES,
    MEASURED,
    UNMEASURED,
    Angle,
    Axle,
    Input,
    Motion,
    Scene,
    SceneError,
    checked,
)

Values = Any
"""The exact values of inputs as attributes; one is None if it is not given, or is to be found."""

MOTOR = "for a motor or a brake see examples/hoist.md"


def read_motion(inputs: Mapping[str, Input]) -> Scene:
    """Return the scene, with the input that follows from what was measured. Raises SceneError."""
    a, drop, time = (inputs[name].value for name in MEASURED)
    if a is None and time is None:
        return Scene.of(inputs)._replace(motion=Motion(drop=drop))
    name = "a" if time is None else "time"
    missing = [mass for mass in MASSES if inputs[mass].value is None]
    unknown = missing[0] if len(missing) == 1 else ""
    if unknown and inputs["M"].value is None is inputs["I"].value:
        raise SceneError(unknown, None, f"is missing; give it, or M, with which {name} finds it")
    values = SimpleNamespace(**checked(inputs, unknown), motion=UNMEASURED)
    if unknown:
        finds = unknown
    elif values.M == inf or (values.mu is not None and values.M is not None):
        finds = "mu_k"
    else:
        finds = "M" if values.M is None and values.I is None else "g"
    values.motion = Motion(a, drop, time, finds)
    rule = _contradiction(values, inputs["g"].given is not None)
    if not rule:
        try:
            scene = Scene(**{**vars(values), **found_inputs(values)})
            rule = _impossible(scene)
        except Undetermined as undetermined:
            rule = str(undetermined)
    if rule:
        raise SceneError(name, inputs[name].given, rule)
    return scene


def _contradiction(values: Values, g_given: bool) -> str:
    """Return why what was measured contradicts the other inputs, "" if it does not."""
    motion, M, mu = values.motion, values.M, values.mu
    decided, finds = Decisions(values), motion.finds
    if motion.time is not None and motion.drop is None:
        return "needs drop, the height of that fall"
    if motion.time is not None and motion.a is not None:
        return "and a both give the acceleration; leave one of them out"
    if mu is not None and finds != "mu_k":
        return f"finds {finds} by assuming that the string does not slip; leave mu out"
    if finds in MASSES:
        if motion.time is not None:
            return f"does not tell which way {finds} moves; give a instead, positive when m2 descends"
        if M == inf or (motion.a == 0 and decided.has_axle_friction):
            return f"says nothing about {finds} on a pulley at rest; give {finds}"
        if 0 in (values.m1, values.m2) and not decided.rim_mass and not decided.has_axle_friction:
            return f"says nothing about {finds}, which falls freely; give the other mass or M above 0"
        return ""
    if finds == "g" and g_given:
        pulley = "I" if M is None else "M"
        return f"leaves nothing to find if both {pulley} and g are given; leave one of them out"
    if decided.sign == 0:
        return "says nothing about equal masses, which rest on any pulley; leave it out"
    if finds == "mu_k" and not decided.light:
        return "conflicts with M = inf and a mass of 0, an end that is fixed to the pulley; leave it out"
    if values.mu_k is not None:
        return "and mu_k both say how the string slides; leave one of them out"
    if mu is not None and not decided.slips:
        return f"needs a string that slips; with mu = {as_typed(mu)} it does not: leave mu out, or {MOTOR}"
    return ""


def _impossible(scene: Scene) -> str:
    """Return why the scene that follows from a motion is none, "" if it is one."""
    decided = Decisions(scene)
    motion, finds = decided.motion, str(decided.motion.finds)
    if finds == "mu_k":
        if decided.slide_ratio_minus_1(EXACT) < 0:
            drive, load = (of(decided.light, decided.heavy, ZERO) for of in (physics.drive, physics.load))
            apart = rounding_apart_from(decided.sign * motion.acceleration(decided.sign), SHOWN_DIGITS)
            most = apart(decided.sign * physics.acceleration(drive, load, scene.g))
            return f"is too large: without friction the acceleration is {format_number(most)} m/s²; {MOTOR}"
        if scene.mu is not None and decided.exceeds(decided.slide_ratio_minus_1, scene.mu):
            return "needs more kinetic friction than mu; check both"
    elif scene.m1 == scene.m2 == 0:
        return "implies that both masses are 0"
    elif getattr(scene, finds) < 0:  # 0 is a mass
        shown = format_number(strip_zeros(to_digits(SHOWN_DIGITS)(getattr(scene, finds))))
        return f"implies {finds} = {shown} {INPUTS[finds].unit}, which cannot be negative; check all inputs"
    return ""


def given_as(scene: Scene, x: str) -> Any:
    """Return an input, or what was measured, as it was given."""
    return getattr(scene if x in INPUTS else scene.motion, x)


def number_of(scene: Scene, x: str) -> Any:
    """Return the number given for an input, in the unit that it was given in."""
    value = given_as(scene, x)
    return getattr(value, "number", value)


def with_number(scene: Scene, x: str, number: Any) -> Scene:
    """Return the scene with another number for an input, or for what was measured, in the same unit."""
    if x not in INPUTS:
        return scene._replace(motion=scene.motion._replace(**{x: number}))
    value: Any = getattr(scene, x)
    given: Any = value._replace(number=number) if isinstance(value, Angle | Axle) else number
    return scene._replace(**{x: given})


def found_inputs(values: Values) -> dict[str, Any]:
    """Return the input that follows from a motion, by its name; it may be below 0. Raises Undetermined.

    Kinetic friction is no rational number: the machine computes it.
    """
    m1, m2, g, motion = values.m1, values.m2, values.g, values.motion
    finds = motion.finds
    if finds is None:
        return {}
    decided: Any = Decisions(values)  # about the pulley, as a mass may be missing
    c, f, b = decided.rim_mass, decided.axle_friction, decided.axle_mass
    a = motion.acceleration({"m2": 1, "m1": -1}.get(finds) or (m2 > m1) - (m2 < m1))
    if finds != "g" and a >= g:
        raise Undetermined(f"must be slower than free fall, {as_typed(g)} m/s²")
    if finds in MASSES:
        known = m1 if finds == "m2" else m2
        if a > 0:
            return {finds: physics.heavier_mass(known, c, a, g, f)}
        return {finds: physics.lighter_mass(known, c, -a, g, f)}
    if a <= 0:
        heavier, side = ("m2", "above") if m2 > m1 else ("m1", "below")
        raise Undetermined(f"must be {side} 0, as {heavier} is the heavier mass")
    l, h = sorted((m1, m2))
    if finds == "M":
        return {"M": physics.rim_mass(l, h, a, g, b) / values.inertia}
    if finds == "g":
        return {"g": physics.gravity(l, h, c, a, f)}
    return {}
