"""Equations solved for an unknown, written out: masses on the verge of slipping, and what a motion tells."""

from collections.abc import Callable, Iterable, Iterator
from fractions import Fraction
from functools import reduce
from operator import mul, truediv
from typing import Any

from ..arithmetic.symbolic import Formula, factors
from ..model import physics
from ..model.quantities import QUANTITIES
from .equations import Derivation, Law, Part


def critical(derivation: Derivation, name: str) -> Iterator[Part]:
    """The equation of a critical mass, and the way to it."""
    l, h = derivation.light, derivation.heavy
    if name in derivation.shown or derivation.answers[name] is None:
        return
    symbol = derivation.symbol(name)
    unknown, stands = {
        "critical_pulley_mass": (f"c = β {symbol}", False),
        "critical_heavier_mass": (f"m{h} = {symbol}", derivation.slips_at_rest),
        "critical_lighter_mass": (f"m{l} = {symbol}", derivation.case.stands_until_it_slips),
    }[name]
    yield f"`{symbol}` is the {QUANTITIES[name].meaning}."
    if stands:
        yield "The pulley stands until then, so the tensions are the weights: their ratio reaches `k` at"
        yield from derivation.lines("k1", "transfer", name)
        return
    if "verge" not in derivation.shown:
        derivation.shown.add("verge")
        yield from _on_the_verge(derivation)
    yield f"All terms with `{unknown}` on one side, this becomes"
    above, below = factors(derivation.formula(name, expanded="drive"))
    yield Law("", (_product([*below, derivation.letter(symbol)]), _product(above)))
    if name == "critical_pulley_mass":
        yield f"`m{h} - m{l} - z` is the drive `d`, what friction at its limit leaves to drive the masses."
        yield from derivation.lines("drive")
    yield "So"
    yield from derivation.lines(name)
    yield from in_the_paper(derivation, name)


def _on_the_verge(derivation: Derivation) -> Iterator[Part]:
    """The ratio of the tensions where friction is at its limit, and the same without a denominator."""
    l = derivation.light
    if _is_the_papers(derivation):
        yield "On the verge the ratio of the tensions is `k`. For a disk, as in the paper, that is"
        ratio = derivation.record(physics.ratio_in_the_paper, "l h M")
        yield Law(QUANTITIES["tension_ratio"].equation, (ratio, derivation.letter("k")))
        yield "Less 1 on both sides, and with `c` = `M/2`, this becomes"
    else:
        label = derivation.cite(QUANTITIES["tension_ratio"].equation)
        yield f"On the verge the ratio {label} of the tensions is `k`. Less 1 on both sides, that is"
    excess = derivation.record(physics.excess_ratio, "l h c b D")
    yield Law("", (excess, derivation.letter("k - 1")))
    if transfer := [*derivation.lines("k1", "transfer")]:
        yield f"Friction at its limit adds a mass `z` to `m{l}`:"
        yield from transfer
    yield f"Multiplied out, with `z` for `m{l} (k - 1)`, the ratio is"
    above, (_, *below) = factors(excess)  # what is left out is l
    yield Law("", (_product(above), _product([derivation.letter("z"), *below])))


def _product(factors: Iterable[Formula]) -> Formula:
    return reduce(mul, factors)


IN_THE_PAPER: dict[str, tuple[Callable[..., Any], str]] = {
    "tension_ratio": (physics.ratio_in_the_paper, "l h M"),
    "critical_pulley_mass": (physics.pulley_mass_in_the_paper, "l h k"),
    "critical_heavier_mass": (physics.heavier_mass_in_the_paper, "l M k"),
}
"""Quantities that the paper has in another form, for a disk: that form, and what it is made of."""


def in_the_paper(derivation: Derivation, name: str) -> Iterator[Part]:
    """The paper's own form of a quantity, where the machine is the paper's and its pulley turns."""
    if name not in IN_THE_PAPER or not _is_the_papers(derivation) or derivation.case.stands:
        return
    law, letters = IN_THE_PAPER[name]
    if derivation.case.pulley_mass is not None or "M" not in letters:
        yield "or, as the paper has it, for a disk,"
        sides = derivation.letter(derivation.symbol(name)), derivation.record(law, letters)
        yield Law(QUANTITIES[name].equation, sides)


def _is_the_papers(derivation: Derivation) -> bool:
    """Whether the pulley is a disk, and its axle does not rub, as in the paper."""
    disk = derivation.scene.I is None and derivation.scene.inertia == Fraction(1, 2)
    return disk and not derivation.case.rubs


# What follows from a measured motion


def found(derivation: Derivation) -> Iterator[Part]:
    """What was not given, from the acceleration that was measured."""
    case, finds, turning = derivation.case, str(derivation.case.motion.finds), derivation.cite("(3)")
    l, h = derivation.light, derivation.heavy
    if case.motion.time is not None:
        yield "A height `s` fallen from rest in the time `t` gives the acceleration:"
        yield derivation.by(derivation.symbol("magnitude"), physics.acceleration_of_fall, "s t")
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
        if case.rubs:
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
        falls = finds == f"m{h}"
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
