"""From a measured acceleration back to what was not given; all of it is rational, but kinetic friction.

Without slip a = g d/s, with the load s = l + h + c: what of M, g and a mass is not given follows from a. In
slip the pulley's mass has no part in the motion, so that a tells nothing of it, but of the friction.
"""

from collections.abc import Mapping
from fractions import Fraction
from math import inf
from typing import Any

from ..arithmetic.rational import EXACT
from . import physics
from .angle import Angle
from .case import Case
from .digits import SHOWN_DIGITS, as_typed, text, tidy, to_digits, to_double, to_threshold
from .reasons import Undetermined
from .scene import INPUTS, MASSES, MEASURED, Axle, Input, Motion, Scene, SceneError


def read(inputs: Mapping[str, Input]) -> tuple[Scene, Motion]:
    """The scene, without what is to be found, and what was measured. Raises SceneError."""
    a, drop, time = (inputs[name].value for name in MEASURED)
    motion, measured = Motion(a, drop, time), a is not None or time is not None
    missing = [mass for mass in MASSES if inputs[mass].value is None]
    name = "a" if time is None else "time"
    if measured and len(missing) == 1:
        if inputs["M"].value is None is inputs["I"].value:
            raise SceneError(missing[0], None, f"is missing; give it, or M, beside which {name} finds it")
        motion = motion._replace(finds=missing[0])
        inputs = {**inputs, missing[0]: SOME_MASS}
    scene = Scene.of(inputs)
    if time is not None and drop is None:
        raise SceneError("time", inputs["time"].given, "needs drop, the height fallen in it")
    if time is not None and a is not None:
        raise SceneError("time", inputs["time"].given, "and a both tell the acceleration; give one of them")
    if not measured:
        return scene, motion
    motion = motion._replace(finds=motion.finds or _what_follows(scene))
    rule = _contradiction(scene, motion, inputs["g"].given is not None)
    if rule := rule or _refused(scene, motion):
        raise SceneError(name, inputs[name].given, rule)
    return scene, motion


SOME_MASS = Input(Fraction(1), Fraction(0), None)
"""Stands for the mass that is to be found."""


def _what_follows(scene: Scene) -> str:
    """The parameter that an acceleration tells of, where both masses are given."""
    if scene.M == inf or (scene.mu is not None and scene.M is not None):
        return "mu_k"
    return "M" if scene.M is None and scene.I is None else "g"


def _contradiction(scene: Scene, motion: Motion, g_given: bool) -> str:
    """Why an acceleration contradicts the other inputs; empty if it does not."""
    finds, pulley = motion.finds, "M" if scene.M is not None else "I"
    if scene.mu is not None and finds != "mu_k":
        why = "a string that slips moves alike on any pulley"
        if finds in MASSES:
            why = f"whether the string slips depends on {finds}"
        return f"has no place beside mu, as {why}; leave mu out"
    if finds in MASSES:
        if scene.M == inf:
            return "has no place beside M = inf, which lets nothing move; leave one of them out"
        if not motion.a and scene.axle is not None:
            return f"tells nothing of {finds}, as the axle holds a difference at rest; leave one of them out"
        if motion.time is not None:
            return f"does not tell which way {finds} moves; give a in its place, positive when m2 descends"
        known = scene.m1 if finds == "m2" else scene.m2
        if not known and not Case(scene).rim_mass:
            return f"tells nothing of {finds}, which falls freely; give the other mass or M above 0"
        return ""
    if finds == "M" and Case(scene).axle_holds:
        return "has no place beside an axle whose friction holds the masses at rest; leave one of them out"
    if finds == "g" and g_given:
        return f"leaves nothing to find beside both {pulley} and g; leave one of them out"
    if scene.m1 == scene.m2:
        return "tells nothing of equal masses, which rest on any pulley; leave it out"
    if finds == "mu_k" and not scene.m1 * scene.m2:
        return "has no place beside M = inf and a free end, which is fixed to the pulley; leave it out"
    if scene.mu_k is not None:
        return "and mu_k both tell how the string slides; leave one of them out"
    if scene.mu is not None and not Case(scene).slips:
        mu = as_typed(scene.mu)
        return f"has no place beside mu = {mu}, with which the string does not slip; leave mu out"
    return ""


def _refused(scene: Scene, motion: Motion) -> str:
    """Why what follows from the motion makes no scene; empty if it does."""
    finds, case = str(motion.finds), Case(scene, motion)
    try:
        found = completed(scene, motion)
    except Undetermined as undetermined:
        return str(undetermined)
    if finds == "mu_k":
        if case.slide_excess(EXACT) < 0:
            return "is too large for any friction: without it the acceleration is " + _free_slide(case)
        if scene.mu is not None and case.exceeds(case.slide_excess, scene.mu):
            return "is that of a string with more kinetic friction than mu; check both"
        return ""
    if found.m1 == found.m2 == 0:
        return "implies that both masses are 0"
    value, domain = getattr(found, finds), INPUTS[finds]
    if value >= 0:  # 0 is a mass
        return ""
    shown = text(tidy(to_digits(SHOWN_DIGITS)(value)))
    return f"implies {finds} = {shown} {domain.unit}, which {domain.domain}"


def _free_slide(case: Case) -> str:
    """The acceleration of a slide without friction, in a sentence."""
    l, h = case.light, case.heavy
    none = Fraction(0)
    most = physics.acceleration(physics.drive(l, h, none), physics.load(l, h, none), case.scene.g)
    return f"{text(to_threshold(up=case.sign < 0)(case.sign * most))} m/s²"


def number_of(scene: Scene, motion: Motion, x: str) -> Any:
    """The number given for an input, in the unit that it was given in."""
    value = getattr(scene if x in Scene._fields else motion, x)
    return getattr(value, "number", value)


def with_number(scene: Scene, motion: Motion, x: str, number: Any) -> tuple[Scene, Motion]:
    """The scene, and what was measured, with another number for an input, in the same unit."""
    of_scene = x in Scene._fields
    value = getattr(scene if of_scene else motion, x)
    if isinstance(value, Angle | Axle):
        number = type(value)(number, value.unit)  # type: ignore[arg-type]
    if of_scene:
        return scene._replace(**{x: number}), motion
    return scene, motion._replace(**{x: number})


def completed(scene: Scene, motion: Motion) -> Scene:
    """The scene with what follows from the motion in it, which may be below 0. Raises Undetermined."""
    if motion.finds is None:
        return scene
    case = Case(scene, motion)
    if motion.finds in MASSES:
        mass = _mass(case, motion.finds)
        return scene._replace(m1=mass) if motion.finds == "m1" else scene._replace(m2=mass)
    l, h, a = case.light, case.heavy, case.measured_acceleration
    if a <= 0:
        heavier, side = ("m2", "above") if case.sign > 0 else ("m1", "below")
        raise Undetermined(f"must be {side} 0, as {heavier} is the heavier mass")
    if motion.finds == "g":
        assert case.rim_mass is not None
        return scene._replace(g=physics.gravity(l, h, case.rim_mass, a, case.axle_friction))
    if motion.finds == "mu_k":
        return scene
    assert scene.inertia is not None
    return scene._replace(M=physics.rim_mass(l, h, a, scene.g, case.axle_mass) / scene.inertia)


def _mass(case: Case, unknown: str) -> Fraction:
    """The mass that moves with the measured acceleration. Raises Undetermined beyond its free fall."""
    known, g, a = case.scene.m1 if unknown == "m2" else case.scene.m2, case.scene.g, case.motion.a
    assert a is not None
    assert case.rim_mass is not None
    down = a if unknown == "m2" else -a
    if down >= g:
        side, limit = ("below", g) if unknown == "m2" else ("above", -g)
        raise Undetermined(f"must be {side} {text(to_double(limit))} m/s², that of free fall")
    if down > 0:
        return physics.heavier_mass(known, case.rim_mass, down, g, case.axle_friction)
    return physics.lighter_mass(known, case.rim_mass, -down, g, case.axle_friction)
