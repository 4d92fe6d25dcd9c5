"""What a measured motion tells, written out: the pulley, a mass, gravity or kinetic friction, and a fall."""

from collections.abc import Iterator
from typing import Any

from ..arithmetic.symbolic import Formula, Symbol
from ..model import physics
from ..model.quantities import QUANTITIES
from .equations import Derivation, Part

FALLEN = "A height `s` fallen from rest in the time `t` gives the acceleration:"


def found(derivation: Derivation) -> Iterator[Part]:
    """What was not given, from the acceleration that was measured."""
    given, case = derivation.inputs, derivation.case
    finds, a, h, l = case.motion.finds, derivation.names["magnitude"], derivation.heavy, derivation.light
    letters = dict(zip("lh", derivation.masses, strict=True)) | {one: given.get(one) for one in "cgR"}
    letters |= {"a": given[a], "f": given.get("f_axle"), "b": given.get("b")}

    def recorded(law: Any, names: str) -> Any:
        """The formula that an equation gives on symbols; f and b come into it if there are any."""
        return law(*(Formula("symbol", one) for name in names.split() if (one := letters[name])))

    if case.motion.time is not None:
        yield FALLEN
        fall = (Formula("symbol", given[name]) for name in "st")
        recorded_fall: Any = physics.acceleration_of_fall
        yield derivation.worked_out("", a, recorded_fall(*fall), given[a], "m/s²")
    yield from derivation.motion()
    both = f"(1) and {derivation.cite('(3)')}"
    if finds == "M":
        yield f"The sum of {both}, solved for `c`, and with that the mass of the pulley, are"
        yield derivation.worked_out("(4)", "c", recorded(physics.rim_mass, "l h a g b"), given["c"], "kg")
        M = Formula("symbol", given["c"]) / Formula("symbol", given["β"])
        yield derivation.worked_out("", "M", M, given["M"], "kg")
        if derivation.scene.R is not None:
            yield "Its moment of inertia is"
            I, unit = derivation.symbol("moment_of_inertia"), QUANTITIES["moment_of_inertia"].unit
            inertia = recorded(physics.moment_of_inertia, "c R")
            yield derivation.worked_out("", I, inertia, Symbol(I, "moment_of_inertia"), unit)
    elif finds == "g":
        yield f"The sum of {both}, solved for `g`, is"
        yield derivation.worked_out("(4)", "g", recorded(physics.gravity, "l h c a f"), given["g"], "m/s²")
        yield from derivation.axle_mass()
    elif finds == "mu_k":
        yield f"(1) gives both tensions. What `T{h}` exceeds `T{l}` by is a part `x_kin` of `T{l}`:"
        yield from derivation.lines("limiting_k1")
        if case.frictionless:
            yield "So the string slides without friction, `μ_k = 0`."
        else:
            yield "The string slides, so friction is at its limit all along the arc. By (26) for all of it,"
            yield from derivation.lines("mu_k")
    else:
        known = next(name for name in ("m1", "m2") if name != finds)
        falls = case.sign and given[str(finds)] is derivation.masses[1]
        law, names = (physics.heavier_mass, "l c a g f") if falls else (physics.lighter_mass, "h c a g f")
        letters |= {"l": given[known], "h": given[known]}
        yield f"(1) gives the tension on `{known}`, and with {derivation.cite('(3)')} that on `{finds}`. So"
        yield derivation.worked_out("(1), (3)", str(finds), recorded(law, names), given[str(finds)], "kg")


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
