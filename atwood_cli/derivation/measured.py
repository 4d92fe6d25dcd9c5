"""What a measured motion tells, written out: the pulley, a mass, gravity or kinetic friction, and a fall."""

from collections.abc import Iterator
from operator import truediv

from ..model import physics
from .equations import Derivation, Part

FALLEN = "A height `s` fallen from rest in the time `t` gives the acceleration:"


def found(derivation: Derivation) -> Iterator[Part]:
    """What was not given, from the acceleration that was measured."""
    case, finds, turning = derivation.case, str(derivation.case.motion.finds), derivation.cite("(3)")
    l, h = derivation.light, derivation.heavy
    if case.motion.time is not None:
        yield FALLEN
        yield derivation.by(derivation.names["magnitude"], physics.acceleration_of_fall, "s t")
    yield from derivation.motion()
    if finds == "M":
        yield f"The sum of (1) and {turning}, solved for `c`, and with that the mass of the pulley, are"
        yield derivation.by("c", physics.rim_mass, "l h a g b", "(4)")
        yield derivation.by("M", truediv, "c β")
        if derivation.scene.R is not None:
            yield "Its moment of inertia is"
            yield derivation.by("moment_of_inertia", physics.moment_of_inertia, "c R")
    elif finds == "g":
        yield f"The sum of (1) and {turning}, solved for `g`, is"
        yield derivation.by("g", physics.gravity, "l h c a f", "(4)")
        if case.axle_friction is not None:
            yield derivation.by("b", physics.axle_mass, "f g")
    elif finds == "mu_k":
        yield f"(1) gives both tensions. What `T{h}` exceeds `T{l}` by is a part `x_kin` of `T{l}`:"
        yield from derivation.lines("limiting_k1")
        if case.frictionless:
            yield "So the string slides without friction, `μ_k = 0`."
        else:
            yield "The string slides, so friction is at its limit all along the arc. By (26) for all of it,"
            yield from derivation.lines("mu_k")
    else:
        known = "m1" if finds == "m2" else "m2"
        falls = case.sign and finds == f"m{h}"
        yield f"(1) gives the tension on `{known}`, and with {turning} that on `{finds}`. So"
        law = physics.heavier_mass if falls else physics.lighter_mass
        yield derivation.by(finds, law, f"{known} c a g f", "(1), (3)")


def fallen(derivation: Derivation) -> Iterator[Part]:
    """The time and the speed of a fall."""
    motion = derivation.case.motion
    if motion.drop is None or derivation.answers["final_speed"] is None:
        return
    if motion.time is None:
        yield "A fall of the height `s` from rest takes the time `t` and ends with the speed `v`:"
        yield from derivation.lines("fall_time")
    else:
        yield "The fall ends with the speed `v`:"
    yield from derivation.lines("final_speed")
