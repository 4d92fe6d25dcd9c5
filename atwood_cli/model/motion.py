"""From a measured acceleration back to what was not given; all of it is rational, but kinetic friction.

Without slip a = g d/s, with the load s = l + h + c: what of M, g and a mass is not given follows from a. In
slip the pulley's mass has no part in the motion, so that a tells nothing of it, but of the friction.
"""

from collections.abc import Mapping
from fractions import Fraction
from math import inf
from typing import Any

from ..arithmetic.dual import Dual
from ..arithmetic.rounding import (
    SHOWN_DIGITS,
    as_typed,
    settle,
    text,
    tidy,
    to_digits,
    to_double,
    to_side_of,
    to_threshold,
)
from . import physics
from .angle import Angle
from .axle import Axle
from .case import Case
from .machine import Undetermined
from .scene import MASSES, MEASURED, Input, Motion, Scene, SceneError

AGREES = 3
"""An acceleration that is too large by more standard uncertainties is refused (99.7 % of a normal
distribution are within)."""

NO_PULLEY = "unknown, as inputs a little different fit no pulley"
NO_MASS = "unknown, as inputs a little different fit no mass"


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
    if not rule and (rule := impossible(Case(scene, motion), name)):
        uncertain = {x: one.uncertainty for x, one in inputs.items() if one.uncertainty}
        if beyond := _beyond(scene, motion, uncertain):
            return scene, motion._replace(beyond=beyond)
    if rule:
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
        if not _known_mass(scene, finds) and not Case(scene).rim_mass:
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


def _known_mass(scene: Scene, unknown: str) -> Fraction:
    """The other mass than the one to be found."""
    return scene.m1 if unknown == "m2" else scene.m2


def impossible(case: Case, name: str) -> str:
    """Why no value of the unknown parameter gives the acceleration; empty if one does."""
    motion = case.motion
    if motion.finds in MASSES:
        return _impossible_for_a_mass(case, motion.finds)
    a, most = case.measured_acceleration, _most(case)
    if a > 0 and (motion.finds == "g" or a <= most):
        if motion.finds == "mu_k" and case.scene.mu is not None and case.beats_friction("slide_excess"):
            return "is that of a string with more kinetic friction than mu; check both"
        return ""
    implied = f"implies a = {_beside(case.sign * a, case.sign * most)} m/s², which " * (name == "time")
    heavier = f"as {'m2' if case.sign > 0 else 'm1'} is the heavier mass"
    if motion.finds == "g":
        return f"{implied}must be {'above' if case.sign > 0 else 'below'} 0, {heavier}"
    limit = text(to_threshold(up=case.sign < 0)(case.sign * most))  # so that the limit itself is taken
    least, greatest = ENDS[motion.finds]
    return f"{implied}must be between 0 ({least}) and {limit} m/s² ({greatest}), {heavier}"


ENDS: Mapping[str | None, tuple[str, str]] = {
    "M": ("a locked pulley: M = inf", "a massless one"),
    "mu_k": ("a string that holds", "no friction"),
}
"""The scenes of the least and the greatest possible acceleration, by the parameter that is found."""


def _impossible_for_a_mass(case: Case, unknown: str) -> str:
    """Why no value of the unknown mass gives the acceleration; empty if one does."""
    scene, known = case.scene, _known_mass(case.scene, unknown)
    found = _mass(case, unknown)
    if found is not None and (found > 0 or (found == 0 and known)):
        return ""
    assert case.rim_mass is not None
    lifted = 1 if unknown == "m2" else -1
    drive = known if case.axle_mass is None else max(known - case.axle_mass, Fraction(0))
    least = physics.acceleration(drive, physics.load(known, Fraction(0), case.rim_mass), scene.g)
    ends = [
        f"{text(to_threshold(up=lifted > 0)(-lifted * least))} (no {unknown} at all)",
        f"{text(to_double(lifted * scene.g))} m/s² ({unknown} in free fall)",
    ]
    return f"must be between {ends[0]} and {ends[1]}"


def _mass(case: Case, unknown: str) -> Fraction | None:
    """The mass that moves with the measured acceleration; None beyond its free fall."""
    scene, known, a = case.scene, _known_mass(case.scene, unknown), case.motion.a
    assert a is not None
    assert case.rim_mass is not None
    down = a if unknown == "m2" else -1 * a
    if not scene.g > down:
        return None
    if down > 0:
        return physics.heavier_mass(known, case.rim_mass, down, scene.g, case.axle_friction)
    return physics.lighter_mass(known, case.rim_mass, -1 * down, scene.g, case.axle_friction)


def _most(case: Case) -> Fraction:
    """The magnitude of the acceleration on a massless pulley, or of a slide without friction."""
    l, h = case.light, case.heavy
    drive = physics.drive(l, h, None if case.slide_measured else case.axle_mass)
    return physics.acceleration(drive, physics.load(l, h, Fraction(0)), case.scene.g)


def _beyond(scene: Scene, motion: Motion, uncertain: Mapping[str, Fraction]) -> str:
    """Why there is no pulley mass, if the acceleration is too large by its uncertainty only; else empty."""
    case = Case(scene, motion)
    over, variance = case.measured_acceleration - _most(case), Fraction(0)
    if motion.finds != "M" or over <= 0:
        return ""
    for x, u in uncertain.items():
        near = Case(*moved(scene, motion, x, 1))
        slope = getattr(near.measured_acceleration - _most(near), "slope", None)
        variance += (u * (slope or 0)) ** 2
    if over**2 > AGREES**2 * variance:
        return ""
    times = settle(lambda ar: ar.sqrt(ar.number(over**2 / variance)), to_digits(2), 2)
    found, limit = (case.sign * one for one in (case.measured_acceleration, _most(case)))
    a, most = _beside(found, limit), _beside(limit, found)
    return (
        f"none, as a = {a} m/s² is beyond the {most} m/s² of a massless pulley; it agrees with M = 0, which"
        f" the other results are for, within {text(times)} standard uncertainties"
    )


def _beside(value: Fraction, other: Fraction) -> str:
    """A number in a sentence, with so many digits that it lies on its side of another."""
    return text(tidy(to_side_of(other, SHOWN_DIGITS)(value)))


def number_of(scene: Scene, motion: Motion, x: str) -> Any:
    """The number given for an input, in the unit that it was given in."""
    value = getattr(scene if x in Scene._fields else motion, x)
    return getattr(value, "number", value)


def moved(scene: Scene, motion: Motion, x: str, side: int) -> tuple[Scene, Motion]:
    """The scene, and what was measured, with one input changed infinitesimally, up or down."""
    return with_number(scene, motion, x, Dual(number_of(scene, motion, x), Fraction(side)))


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
    """The scene with what follows from the motion in it. Raises Undetermined."""
    if motion.finds in (None, "mu_k"):
        return scene
    if motion.beyond:
        return scene._replace(M=Fraction(0))
    case = Case(scene, motion)
    if motion.finds in MASSES:
        mass = _mass(case, motion.finds)
        if mass is None or mass < 0:
            raise Undetermined(NO_MASS)
        return scene._replace(m1=mass) if motion.finds == "m1" else scene._replace(m2=mass)
    l, h, a = case.light, case.heavy, case.measured_acceleration
    if motion.finds == "g":
        assert case.rim_mass is not None
        return scene._replace(g=physics.gravity(l, h, case.rim_mass, a, case.axle_friction))
    c = physics.rim_mass(l, h, a, scene.g, case.axle_mass)
    if c < 0:
        raise Undetermined(NO_PULLEY)
    assert scene.inertia is not None
    return scene._replace(M=c / scene.inertia)
