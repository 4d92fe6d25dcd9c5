"""From a measured acceleration back to what was not given; all of it is rational, but kinetic friction.

Without slip a = g d/s, with the load s = l + h + c: whichever of M, g and a mass is not given follows from a.
In slip the pulley's mass does not enter the motion, so that a gives the kinetic friction instead.
"""

from collections.abc import Mapping
from fractions import Fraction
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
    FALL,
    INPUTS,
    MASSES,
    MEASURED,
    Input,
    Motion,
    Scene,
    SceneError,
    checked,
    own_values,
    parameter_of,
)

Values = Any
"""The exact values of inputs as attributes; one is None if it is not given, or is to be found."""

MOTOR = "for a motor or a brake see examples/hoist.md"
IF_IT_SLOWS_DOWN = "for masses that slow down give a and --find axle"
NOT_BELOW_0 = "must be above 0, unless a mass is found from it: then it is below 0 if m2 rises"


def read_motion(inputs: Mapping[str, Input], find: str | None = None) -> Scene:
    """Return the scene, with the input that follows from what was measured. Raises SceneError.

    ``find`` names that input; without it, the one that is lacking is found.
    """
    given = [name for name in MEASURED if inputs[name].given is not None]
    fall = [name for name in given if name in FALL]
    is_measured = "a" in given or len(fall) > 1
    if find and not is_measured:
        raise SceneError("find", find, f"needs a measured motion: a, or two of {', '.join(FALL)}")
    if len(fall) > 1 and (excess := [name for name in given if name not in fall[:2]]):
        rule = f"is one too many beside {fall[0]} and {fall[1]}, which give the acceleration; leave one out"
        raise SceneError(excess[0], inputs[excess[0]].given, rule)
    name = "a" if "a" in given else fall[-1]
    finds = _unknown(inputs, find, name) if is_measured else None
    values = SimpleNamespace(**checked(inputs, finds or ""))
    measured, terms = own_values(inputs, MEASURED)
    values.terms += (*terms.items(),)
    values.motion = Motion(**measured, finds=finds, direction=_direction(values, measured["a"], finds))
    one_falls = finds in MASSES and "a" not in given and 0 not in (values.m1, values.m2)
    if below_0 := [x for x in fall if measured[x] < 0 and not one_falls]:
        raise SceneError(below_0[0], inputs[below_0[0]].given, NOT_BELOW_0)
    if not finds:
        return Scene(**vars(values))
    if by_g := [(x, terms.words) for x, (_, terms) in values.terms if finds == terms.by]:
        x, words = by_g[0]
        rule = f"is {words}, and g is to be found; give g, or {x} in {parameter_of(x).unit}"
        raise SceneError(x, inputs[x].given, rule)
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


def _unknown(inputs: Mapping[str, Input], find: str | None, name: str) -> str:
    """Return the input that a motion finds: the one that is asked for, or is lacking. Raises SceneError."""
    if find:
        if inputs[find].given is not None:
            raise SceneError("find", find, f"conflicts with {find}, which is given; leave one of them out")
        return find
    M, has_pulley = inputs["M"].value, not (inputs["M"].value is None is inputs["I"].value)
    missing = [mass for mass in MASSES if inputs[mass].value is None]
    if len(missing) == 1:
        if not has_pulley:
            raise SceneError(missing[0], None, f"is missing; give it, or M, with which {name} finds it")
        return missing[0]
    slides = M == inf or (inputs["mu"].value is not None and M is not None)
    return "mu_k" if slides else "g" if has_pulley else "M"


def _direction(values: Values, a: Fraction | None, finds: str | None) -> int:
    """Return the direction of a motion that the masses do not tell, as `Motion` has it."""
    if finds in MASSES:
        return -1 if values.m2 == 0 else 1  # only m1 can fall beside an end fixed to the pulley
    if finds != "axle":
        return 0
    sign = (values.m2 > values.m1) - (values.m2 < values.m1)
    return sign or ((a < 0) - (a > 0) if a else 0)  # equal masses move only if they slow down


def _contradiction(values: Values, g_given: bool) -> str:
    """Return why what was measured contradicts the other inputs, "" if it does not."""
    motion, M, I, mu = values.motion, values.M, values.I, values.mu
    decided, finds = Decisions(values), motion.finds
    if mu is not None and finds != "mu_k":
        return f"finds {finds} by assuming that the string does not slip; leave mu out"
    if finds in MASSES:
        if M == inf or (motion.a == 0 and decided.has_axle_friction):
            return f"says nothing about {finds} on a pulley at rest; give {finds}"
        if 0 in (values.m1, values.m2) and not decided.rim_mass and not decided.has_axle_friction:
            return f"says nothing about {finds}, which falls freely; give the other mass or M above 0"
        return ""
    if finds == "axle" and M == inf:
        return "says nothing about the axle of a locked pulley; leave M out"
    if finds == "mu_k" and M != inf and (mu is None or M is I is None):
        return "finds mu_k only if the string slips: give M = inf, or M and mu"
    if finds == "M" and I is not None:
        return "finds no M beside I, which is the pulley's inertia; leave I out"
    if finds == "g" and g_given:
        pulley = "I" if M is None else "M"
        return (
            f"leaves nothing to find if both {pulley} and g are given; leave one of them out,"
            " or ask for the axle's friction: --find axle"
        )
    if decided.sign == 0:
        return f"says nothing about equal masses, which rest on any pulley; {IF_IT_SLOWS_DOWN}"
    if finds == "axle":
        return ""
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
    a = motion.acceleration({"m2": 1, "m1": -1}.get(finds) or decided.sign)
    if finds != "g" and (a >= g or (finds == "axle" and -a >= g)):
        raise Undetermined(f"must be slower than free fall, {as_typed(g)} m/s²")
    if finds in MASSES:
        known = m1 if finds == "m2" else m2
        if a > 0:
            return {finds: physics.heavier_mass(known, c, a, g, f)}
        return {finds: physics.lighter_mass(known, c, -a, g, f)}
    l, h = decided.light, decided.heavy
    if finds == "axle":
        return {"axle": physics.axle_friction(l, h, c, a, g)}
    if a <= 0:
        heavier, side = ("m2", "above") if m2 > m1 else ("m1", "below")
        raise Undetermined(f"must be {side} 0, as {heavier} is the heavier mass; {IF_IT_SLOWS_DOWN}")
    if finds == "M":
        return {"M": physics.rim_mass(l, h, a, g, b) / values.inertia}
    if finds == "g":
        return {"g": physics.gravity(l, h, c, a, f)}
    return {}
