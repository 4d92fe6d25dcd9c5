"""From a measured acceleration back to what was not given; all of it is rational, but kinetic friction.

Without slip a = g d/s, with the load s = l + h + c: whichever of M, g and a mass is not given follows from a.
In slip the pulley's mass does not enter the motion, so that a gives the kinetic friction instead.
"""

from collections.abc import Mapping
from math import inf
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
from .scene import DRIVE, FALL, INPUTS, MASSES, MEASURED, Input, Scene, SceneError, parameter_of

MOTOR = "for a motor or a brake find the drive"
IF_IT_SLOWS_DOWN = f"for masses that axle friction slows down give a and find axle, {MOTOR}"
IF_IT_RESTS = "for masses that rest give a and find axle"
LOADS_HELD = "without a motion and find, mu tells between which values of {} the string holds"
NOT_BELOW_0 = "must be above 0; below 0, where m2 accelerates upwards, it finds a mass or the drive"


def read_motion(inputs: Mapping[str, Input], find: str | None = None) -> Scene:
    """Return the scene, with the input that follows from what was measured. Raises SceneError.

    ``find`` names that input; without it, the one that is lacking is found.
    """
    given = [name for name in MEASURED if inputs[name].given is not None]
    fall = [name for name in given if name in FALL]
    is_measured = "a" in given or len(fall) > 1
    if find and not is_measured:
        beside_a_load = find in MASSES and not inputs[find].number and any(inputs[x].number for x in MASSES)
        loads = f"; {LOADS_HELD.format(find)}" if beside_a_load else ""
        raise SceneError("find", find, f"needs a measured motion: a, or two of {', '.join(FALL)}{loads}")
    if len(fall) > 1 and (excess := [name for name in given if name not in fall[:2]]):
        rule = f"is one too many beside {fall[0]} and {fall[1]}, which give the acceleration; leave one out"
        raise SceneError(excess[0], inputs[excess[0]].given, rule)
    name = "a" if "a" in given else fall[-1]
    finds = _unknown(inputs, find) if is_measured else None
    scene = directed(Scene.of(inputs, finds, may_lack=not is_measured))
    m2_may_rise = (scene.motion.a or 0) <= 0 if finds == DRIVE else finds in MASSES and "a" not in given
    m2_may_rise &= finds == DRIVE or 0 not in (scene.m1, scene.m2)
    if below_0 := [x for x in fall if getattr(scene.motion, x) < 0 and not m2_may_rise]:
        raise SceneError(below_0[0], inputs[below_0[0]].given, NOT_BELOW_0)
    if by_g := [(x, terms.words) for x, terms in scene.terms if finds == terms.by]:
        x, words = by_g[0]
        rule = f"is {words}, and g is to be found; give g, or {x} in {parameter_of(x).unit}"
        raise SceneError(x, inputs[x].given, rule)
    if not finds:
        return scene
    rule = _contradiction(scene, inputs["g"].given is not None)
    if not rule:
        try:
            scene = scene._replace(**found_inputs(scene))
            rule = _impossible(scene)
        except Undetermined as undetermined:
            rule = str(undetermined)
    if rule:
        raise SceneError(name, inputs[name].given, rule)
    return scene


def _unknown(inputs: Mapping[str, Input], find: str | None) -> str:
    """Return the input that a motion finds: the one that is asked for, or is lacking. Raises SceneError."""
    if find:
        if find != DRIVE and inputs[find].given is not None:
            raise SceneError("find", find, f"conflicts with {find}, which is given; leave one of them out")
        return find
    M, has_pulley = inputs["M"].number, not (inputs["M"].number is None is inputs["I"].number)
    missing = [mass for mass in MASSES if inputs[mass].number is None]
    if len(missing) == 1:
        return missing[0]
    slides = M == inf or (inputs["mu"].number is not None and M is not None)
    return "mu_k" if slides else "g" if has_pulley else "M"


def directed(scene: Scene) -> Scene:
    """Return the scene with the direction of its motion."""
    return scene._replace(motion=scene.motion._replace(direction=_direction(scene)))


def _direction(scene: Scene) -> int:
    """Return the direction of a motion that the masses do not tell, as `Motion` has it."""
    finds, a = scene.motion.finds, scene.motion.a
    if finds in MASSES:
        return -1 if scene.m2 == 0 else 1  # only m1 can fall beside an end fixed to the pulley
    if finds == DRIVE:
        return 1
    if finds != "axle":
        return 0
    sign = (scene.m2 > scene.m1) - (scene.m2 < scene.m1)
    return sign or ((a < 0) - (a > 0) if a else 0)  # equal masses move only if they slow down


def _contradiction(scene: Scene, g_given: bool) -> str:
    """Return why what was measured contradicts the other inputs, "" if it does not."""
    decided, finds = Decisions(scene), scene.motion.finds
    M, I, mu, has_axle_friction = scene.M, scene.I, scene.mu, decided.has_axle_friction
    match finds:
        case "m1" | "m2" if M == inf or (scene.motion.a == 0 and has_axle_friction):
            way = LOADS_HELD.format(finds) if scene.m1 or scene.m2 else f"give {finds}"
            return f"says nothing about {finds} on a pulley at rest; {way}"
        case "M" | "g" | "m1" | "m2" | "axle" if mu is not None:
            held = finds in MASSES and scene.motion.a == 0
            way = LOADS_HELD.format(finds) if held else "leave mu out"
            return f"finds {finds} by assuming that the string does not slip; {way}"
        case "m1" | "m2" if 0 in (scene.m1, scene.m2) and not (decided.rim_mass or has_axle_friction):
            return f"says nothing about {finds}, which falls freely; give the other mass or M above 0"
        case "drive" if M == inf:
            return "is that of a pulley, which M = inf locks; leave M out, or give its mass"
        case "axle" if M == inf:
            return "says nothing about the axle of a locked pulley; leave M out"
        case "mu_k" if M != inf and (mu is None or M is I is None):
            return "finds mu_k only if the string slips: give M = inf, or M and mu"
        case "M" if I is not None:
            return "finds no M beside I, which is the pulley's inertia; leave I out"
        case "g" if g_given:
            pulley = "I" if M is None else "M"
            nothing = f"leaves nothing to find if both {pulley} and g are given"
            return f"{nothing}; leave one of them out, or ask for the axle's friction: find axle"
        case "M" | "g" | "mu_k" if decided.heavier_side == 0:
            return f"says nothing about equal masses, which rest on any pulley; {IF_IT_SLOWS_DOWN}"
        case "mu_k" if not decided.light:
            return "conflicts with M = inf and a mass of 0, an end that is fixed to the pulley; leave it out"
        case "mu_k" if scene.mu_k is not None:
            return "and mu_k both say how the string slides; leave one of them out"
        case "mu_k" if mu is not None and not decided.slips:
            without = f"leave mu out, or {MOTOR}"
            return f"needs a string that slips; with mu = {as_typed(mu)} it does not: {without}"
    return ""


def _impossible(scene: Scene) -> str:
    """Return why the scene that follows from a motion is none, "" if it is one."""
    decided = Decisions(scene)
    finds = str(scene.motion.finds)
    if finds == "mu_k":
        if decided.slide_ratio_minus_1(EXACT) < 0:
            drive, load = (of(decided.light, decided.heavy, ZERO) for of in (physics.drive, physics.load))
            apart = rounding_apart_from(decided.heavier_side * decided.measured_acceleration, SHOWN_DIGITS)
            most = apart(decided.heavier_side * physics.acceleration(drive, load, scene.g))
            return f"is too large: without friction the acceleration is {format_number(most)} m/s²; {MOTOR}"
        if scene.mu is not None and decided.exceeds(decided.slide_ratio_minus_1, scene.mu):
            return "needs more kinetic friction than mu; check both"
    elif scene.m1 == scene.m2 == 0:
        return "implies that both masses are 0"
    elif finds != DRIVE and getattr(scene, finds) < 0:  # 0 is a mass
        shown = format_number(strip_zeros(to_digits(SHOWN_DIGITS)(getattr(scene, finds))))
        rule = f"implies {finds} = {shown} {INPUTS[finds].unit}, which cannot be negative; check all inputs"
        rises = f"; if the heavier mass still rises, axle friction is {shown[1:]} N"
        return rule + (rises if finds == "axle" else "")
    return ""


def found_inputs(scene: Scene) -> dict[str, Any]:
    """Return the input that follows from a motion, by its name; it may be below 0. Raises Undetermined.

    The machine computes kinetic friction, which is no rational number, and the drive, which is no input.
    """
    m1, m2, g, finds = scene.m1, scene.m2, scene.g, scene.motion.finds
    if finds is None:
        return {}
    decided: Any = Decisions(scene)  # about the pulley, as a mass may be missing
    c, f, b = decided.rim_mass, decided.axle_friction, decided.axle_mass
    a = scene.motion.acceleration({"m2": 1, "m1": -1}.get(finds) or decided.heavier_side)
    if finds == "axle" and decided.heavier_side == 0:
        raise Undetermined("says nothing about the axle: equal masses that begin at rest stay there on any")
    is_braked = finds == "axle" or (finds == DRIVE and decided.light > 0)
    if finds != "g" and (a >= g or (is_braked and -a >= g)):
        fall = format_number(strip_zeros(to_digits(SHOWN_DIGITS)(abs(a))))
        gives = f"gives {fall} m/s², and " if scene.motion.a is None else ""
        raise Undetermined(f"{gives}must be slower than free fall, {as_typed(g)} m/s²")
    if finds in MASSES:
        known = m1 if finds == "m2" else m2
        if a > 0:
            return {finds: physics.heavier_mass(known, c, a, g, f)}
        return {finds: physics.lighter_mass(known, c, -a, g, f)}
    l, h = decided.light, decided.heavy
    if finds == "axle":
        return {finds: physics.axle_friction(l, h, c, a, g)}
    if a <= 0 and finds != DRIVE:
        heavier, side = ("m2", "above") if m2 > m1 else ("m1", "below")
        way = "" if finds == "mu_k" else f"; {IF_IT_SLOWS_DOWN if a else IF_IT_RESTS}"
        raise Undetermined(f"must be {side} 0, as {heavier} is the heavier mass{way}")
    if finds == "M":
        return {finds: physics.rim_mass(l, h, a, g, b) / decided.beta}
    assert finds in ("g", "mu_k", DRIVE), finds  # the machine computes the others
    return {finds: physics.gravity(l, h, c, a, f)} if finds == "g" else {}
