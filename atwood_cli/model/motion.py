"""From a measured acceleration back to the pulley's mass, or to gravity; all of it is rational.

Without slip a = g d/s, with the load s = l + h + c: what of M and g is not given follows from a. In slip,
and with friction at its limit, the pulley's mass has no part in the motion, so that a tells nothing of it.
"""

from collections.abc import Mapping
from fractions import Fraction
from math import inf
from typing import Any

from ..arithmetic.dual import Dual
from ..arithmetic.rounding import settle, text, to_digits, to_double, to_side
from . import physics
from .angle import Angle
from .case import Case
from .machine import Undetermined
from .scene import MEASURED, Input, Motion, Scene, SceneError

AGREES = 3
"""Beyond how many standard uncertainties (99.7 % of a normal distribution) what cannot be is refused."""

NO_PULLEY = "unknown, as inputs a little different fit no pulley"


def read(inputs: Mapping[str, Input]) -> tuple[Scene, Motion]:
    """The scene, without what is to be found, and what was measured. Raises SceneError."""
    a, drop, time = (inputs[name].value for name in MEASURED)
    motion, scene = Motion(a, drop, time), Scene.of(inputs)
    if time is not None and drop is None:
        raise SceneError("time", inputs["time"].given, "needs drop, the height fallen in it")
    if time is not None and a is not None:
        raise SceneError("time", inputs["time"].given, "and a both tell the acceleration; give one of them")
    if a is None and time is None:
        return scene, motion
    name = "a" if time is None else "time"
    motion = motion._replace(finds="M" if scene.M is None else "g")
    g_given = inputs["g"].given is not None
    rule = _contradiction(scene, g_given)
    if not rule and (rule := _impossible(Case(scene, motion), name)):
        uncertain = {x: one.uncertainty for x, one in inputs.items() if one.uncertainty}
        if beyond := _beyond(scene, motion, uncertain):
            return scene, motion._replace(beyond=beyond)
    if rule:
        raise SceneError(name, inputs[name].given, rule)
    return scene, motion


def _contradiction(scene: Scene, g_given: bool) -> str:
    """Why an acceleration has no place beside what else is given; empty if it has."""
    if scene.mu is not None:
        return "has no place beside mu, as a string that slips moves alike on any pulley; leave mu out"
    if scene.I is not None:
        return "has no place beside I, which already tells how the pulley turns; leave I out"
    if scene.M == inf:
        return "has no place beside M = inf, which lets nothing move; leave one of them out"
    if scene.M is not None and g_given:
        return "leaves nothing to find beside both M and g; leave one of them out"
    if scene.m1 == scene.m2:
        return "tells nothing of equal masses, which rest on any pulley; leave it out"
    return ""


def _impossible(case: Case, name: str) -> str:
    """Why no pulley, or no gravity, gives the acceleration; empty if one does."""
    motion, a, most = case.motion, _signed(case), _most(case)
    downhill = case.sign * a > 0
    if downhill and (motion.finds == "g" or case.sign * a <= most):
        return ""
    implied = f"implies a = {text(to_double(a))} m/s², which " * (name == "time")
    heavier = f"as {'m2' if case.sign > 0 else 'm1'} is the heavier mass"
    if motion.finds == "g":
        return f"{implied}must be {'above' if case.sign > 0 else 'below'} 0, {heavier}"
    limit = text(to_side(None, up=case.sign < 0)(case.sign * most))  # so that the limit itself is taken
    return (
        f"{implied}must be between 0 (a locked pulley: M = inf) and {limit} m/s² (a massless one), {heavier}"
    )


def _most(case: Case) -> Fraction:
    """The magnitude of the acceleration on a massless pulley."""
    l, h = case.light, case.heavy
    return physics.acceleration(h - l, physics.load(l, h, Fraction(0)), case.scene.g)


def _beyond(scene: Scene, motion: Motion, uncertain: Mapping[str, Fraction]) -> str:
    """How far a measured acceleration is beyond what it can be, if that is little enough; else empty."""
    case = Case(scene, motion)
    over, variance = case.sign * _signed(case) - _most(case), Fraction(0)
    if motion.finds != "M" or over <= 0:
        return ""
    for x, u in uncertain.items():
        near = Case(*moved(scene, motion, x, 1))
        slope = getattr(near.sign * _signed(near) - _most(near), "slope", None)
        variance += (u * (slope or 0)) ** 2
    if over**2 > AGREES**2 * variance:
        return ""
    times = settle(lambda ar: ar.sqrt(ar.number(over**2 / variance)), to_digits(2), 2)
    a, most = (text(to_double(value)) for value in (_signed(case), case.sign * _most(case)))
    return (
        f"none, as a = {a} m/s² is beyond the {most} m/s² of a massless pulley; it agrees with M = 0, which"
        f" the other results are for, within {text(times)} standard uncertainties"
    )


def moved(scene: Scene, motion: Motion, x: str, side: int) -> tuple[Scene, Motion]:
    """The scene, and what was measured, with an input that is infinitesimally more, or less."""
    of_scene = x in Scene._fields
    value = getattr(scene if of_scene else motion, x)
    beside: Any = Dual(value.number if isinstance(value, Angle) else value, Fraction(side))
    if isinstance(value, Angle):
        beside = Angle(beside, value.unit)
    if of_scene:
        return scene._replace(**{x: beside}), motion
    return scene, motion._replace(**{x: beside})


def _signed(case: Case) -> Fraction:
    """The measured acceleration, positive when m2 descends."""
    motion = case.motion
    if motion.a is not None:
        return motion.a
    assert motion.drop is not None
    assert motion.time is not None
    return case.sign * physics.acceleration_of_fall(motion.drop, motion.time)


def completed(scene: Scene, motion: Motion) -> Scene:
    """The scene with what follows from the motion in it. Raises Undetermined."""
    if motion.finds is None:
        return scene
    if motion.beyond:
        return scene._replace(M=Fraction(0))
    case = Case(scene, motion)
    l, h, a = case.light, case.heavy, case.sign * _signed(case)
    if motion.finds == "g":
        assert case.rim_mass is not None
        return scene._replace(g=physics.gravity_under(h - l, physics.load(l, h, case.rim_mass), a))
    c = physics.added_load(l, h, physics.load_under(h - l, a, scene.g))
    if c < 0:
        raise Undetermined(NO_PULLEY)
    assert scene.inertia is not None
    return scene._replace(M=c / scene.inertia)
