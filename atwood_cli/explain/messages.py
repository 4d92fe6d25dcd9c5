"""Why a scene does what it does, and why answers are missing or doubtful, in sentences.

Backticks mark names, as in the messages of `Undetermined`: `unmarked` takes them out, and LaTeX output
(`output.typeset`) replaces the names by symbols.
"""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from decimal import Decimal
from fractions import Fraction
from math import inf
from operator import methodcaller
from typing import Any

from ..numbers.digits import (
    SHOWN_DIGITS,
    Rounding,
    as_typed,
    format_number,
    rounding_apart_from,
    strip_zeros,
    to_digits,
)
from ..reading.units import MAX_MAGNITUDE
from ..solver.answers import ABOVE_DOUBLES, BELOW_DOUBLES, Answers
from ..solver.physics import acceleration, drive, load
from ..solver.quantities import FROM_MOTION, LIMITS_OF_ONE_MASS, NAMES, QUANTITIES
from ..solver.scene import DRIVE, IN_SI, INPUTS, MASSES, Unit, with_unit
from .given import as_given, inputs_in_words, label


def unmarked(words: str) -> str:
    """Return a sentence without backticks."""
    return words.replace("`", "")


def notes(answers: Answers, names: Sequence[str]) -> list[str]:
    """Return sentences on the regime and why, and on the quantities named, as `reasons`."""
    sentences = [verdict(answers), *remarks(answers.to_six_digits)]
    return [*map(unmarked, sentences), *reasons(answers, names)]


def measured_quantities(answers: Answers) -> list[str]:
    """Return the names of the quantities that follow from measurements, the unknown input first."""
    motion = answers.decided.motion
    given = {"fall_time": motion.time, "final_speed": motion.speed}
    names = [name for name in answers.names[len(NAMES) :] if given.get(name) is None]
    if answers.decided.scene.R is None and "final_angular_speed" in names:
        names.remove("final_angular_speed")
    if motion.finds and motion.a is None:
        names.insert(len(FROM_MOTION[motion.finds]), "acceleration")
    if motion.finds == "M":
        names.insert(1, "moment_of_inertia")
    return names


def reasons(answers: Answers, names: Sequence[str]) -> list[str]:
    """Return sentences on why quantities or their uncertainties are missing or doubtful."""
    by_name = {name: answers.answer(name) for name in names if name != "regime"}
    sentences = reasons_in(Counter((x, answer.reason) for x, answer in by_name.items() if answer.reason), 1)
    without = [
        x for x, answer in by_name.items() if answer.value is not None and answers.uncertainty(x) is None
    ]
    sentences += in_typed_units(answers, names)
    return [*sentences, *doubts(answers), *map(unmarked, without_uncertainty(answers, without))]


WITHIN = {1: "one standard uncertainty", 2: "two standard uncertainties"}
"""A decision is in doubt if it differs within so many standard uncertainties of an input."""
DOUBTFUL = {
    "Which mass is heavier": "heavier_side",
    "Whether the axle holds the difference": "axle_holds",
    "Whether the string slips": "regime",
}
"""The decisions that may be in doubt, and their attributes of `Decisions`."""


def ends_nearby(answers: Answers) -> Iterator[tuple[str, str, Any]]:
    """Yield how far an input is off, its name, and the end: within two uncertainties, the nearest first."""
    for n, within in WITHIN.items():
        for x, pair in answers.ends_at(n).items():
            yield from ((within, x, end) for end in pair)


def doubts(answers: Answers) -> list[str]:
    """Say which decisions differ near the scene, and at which nearest end."""
    sentences: dict[str, str] = {}
    if answers.decided.lacking:
        return []
    for within, x, end in ends_nearby(answers):
        for what, name in DOUBTFUL.items():
            if end.answers and getattr(end.answers.decided, name) != getattr(answers.decided, name):
                place = _at(answers, x, end.input)
                sentences.setdefault(
                    what,
                    f"{what} is in doubt: the answer differs within {within}, at {place}."
                    " Results use the inputs as given.",
                )
                break  # others follow from it
    return [*sentences.values(), *_found_below_0(answers)]


def _found_below_0(answers: Answers) -> Iterator[str]:
    """Say at which ends an input that is found would be below 0."""
    if (finds := answers.decided.motion.finds) in INPUTS:
        found = FROM_MOTION[finds][0]
        for x, end in ((x, end) for x, pair in answers.ends_at(1).items() for end in pair):
            if (end.answer(found).value or 0) < 0:
                at = _at(answers, x, end.input)
                yield f"{found} would be below 0 at {at}; uncertainties count that all the same."


def without_uncertainty(answers: Answers, names: Iterable[str]) -> list[str]:
    """Say which quantities have no value at an end of an input, and their value at the other end."""
    groups: dict[str, list[str]] = {}
    for name in names:
        spread = answers.spread(name)
        for x, pair in spread.ends.items() if spread else ():
            if missing := [i for i in (0, 1) if pair[i].value is None]:
                i = missing[0]
                place, other_place = (_at(answers, x, answers.ends_at(1)[x][j].input) for j in (i, 1 - i))
                value, words = pair[1 - i].value, name
                if value is not None and value != spread.here:
                    shown = format_number(strip_zeros(to_digits(SHOWN_DIGITS)(value)))
                    words += f" ({with_unit(shown, answers.unit_of(name))} at {other_place})"
                groups.setdefault(f"at {place}, {pair[i].reason}", []).append(words)
    return [f"No uncertainty of {', '.join(group)}: {reason}." for reason, group in groups.items()]


def _at(answers: Answers, x: str, value: Fraction) -> str:
    """Say a value of an input, with the unit that it was given in: mu = 0.35."""
    scene = answers.decided.scene
    return f"{label(x, dict(scene.terms).get(x))} = {with_unit(as_typed(value), scene.unit_of(x))}"


MASS_LIMITS = ("critical_heavier_mass", "critical_lighter_mass", "least_heavier_mass", *MASSES)
"""The limits of masses, and the masses that are found."""
USUAL_UNITS = ("", "kg", "g", "mg", "ug", "t", "deg", "°", "rad")


def typed_units(answers: Answers) -> dict[str, Unit]:
    """Return the units of limits and masses found that differ from the usual ones, as an input has them."""
    units = dict[str, Unit]()
    for x, limits in (("wrap", ("least_wrap",)), ("m2", MASS_LIMITS), ("m1", MASS_LIMITS)):
        if (unit := answers.typed(x).unit).symbol not in USUAL_UNITS:
            units |= dict.fromkeys(limits, unit)
    return units


def in_typed_units(answers: Answers, names: Sequence[str]) -> Iterator[str]:
    """Say limits and masses found, if they are among the names, in the unusual unit of an input."""
    units = {name: unit for name, unit in typed_units(answers).items() if name not in answers.units}
    there = answers.in_units(units).to_six_digits
    for name in [name for name in names if name in units and answers[name]]:
        as_weight = "a weight of " if units[name].terms else ""
        yield f"{name} is {as_weight}{with_unit(_say(there, name), units[name].in_words)}."


WAYS = dict.fromkeys((ABOVE_DOUBLES, BELOW_DOUBLES), "; ask for digits (--digits 17) to see it")
"""What to type, by the reason that a value is missing."""


def reasons_in(counted: Mapping[tuple[str, str], int], rows: int) -> list[str]:
    """Return a sentence for each reason that values are missing, without backticks.

    ``counted`` says in how many of the ``rows`` a quantity is missing for a reason.
    """
    names: dict[tuple[str, int], list[str]] = {}
    for (name, reason), times in counted.items():
        names.setdefault((reason, times), []).append(name)
    sentences = []
    for (reason, times), group in names.items():
        place = "" if times == rows else f" (in {times} of {rows} rows)"
        sentences.append(f"{', '.join(group)}: {unmarked(reason)}{WAYS.get(reason, '')}{place}.")
    return sentences


def verdict(answers: Answers) -> str:
    """Say what the string does, and why."""
    answers = answers.in_units(IN_SI).to_six_digits
    decided, scene = answers.decided, answers.decided.scene
    if scene.lacking:
        return _what_holds(answers)
    if decided.heavier_side == 0 and not decided.is_driven:
        return "At rest: the masses are equal, so no friction is needed."
    if decided.is_driven and decided.regime == "slip":
        needed = f"`mu` = {as_typed(scene.mu or Fraction(0))} is below the {_enough(answers)} needed"
        return f"Would slip: {needed}, so no motor or brake gives the masses this motion."
    if decided.regime == "verge":
        return _on_the_verge(answers)
    if decided.regime == "slip":
        return _slips(answers)
    if decided.axle_holds or decided.slows_down:
        does = "Slows down, and stops" if decided.slows_down else "At rest"
        most = format_number(_beside(answers, decided.difference)(decided.axle_mass))
        held = f"{does}: axle friction can hold a difference of masses of up to {most} kg."
        return f"{held} {_grips(answers)}" if decided.light else held
    if decided.tensions_equal and not decided.is_driven:
        return "No slip: a massless pulley needs no friction to turn, so both tensions are equal."
    if not decided.light:
        return "No slip: the string's end is fixed to the pulley."
    if scene.mu is None or decided.pulley_known:
        return _grips(answers)
    least = answers.rounded("least_heavier_mass", _beside(answers, decided.heavy))
    if least.is_infinite() or least.adjusted() > MAX_MAGNITUDE:
        return "No slip on any pulley, for any heavier mass that can be typed."
    return (
        "No slip on any pulley: a heavy enough one makes the string slip only if the heavier mass is above"
        f" {format_number(least)} kg."
    )


def _what_holds(answers: Answers) -> str:
    """Say between which limits the string holds, as a mass is not given."""
    decided = answers.decided
    if not decided.has_one_mass:
        return "Neither mass is given: `mu` and the wrap give the `capstan_ratio` alone."
    [mass], [given] = decided.lacking, {*MASSES} - {*decided.lacking}
    unit = answers.typed(given).unit
    answers = answers.in_units(dict.fromkeys(LIMITS_OF_ONE_MASS, unit) if unit.symbol else IN_SI)
    ends = zip(("least", "most"), LIMITS_OF_ONE_MASS, strict=True)
    holds = " and ".join(f"at {end} {_say(answers, x)}" for end, x in ends if answers[x] not in (None, inf))
    size = f"{holds} {unit.in_words or 'kg'}" if holds else "of any size that can be typed"
    on = "" if decided.pulley_known else "on any pulley "
    return f"`{mass}` is not given: {on}the string holds if `{mass}` is {size}."


def _enough(answers: Answers, name: str = "mu_verge") -> str:
    """Say the least coefficient that holds the string."""
    return format_number(answers.rounded(name, _beside(answers, answers.decided.scene.mu)))


def _grips(answers: Answers) -> str:
    """Say why the string does not slip on the pulley, or that this is assumed."""
    decided, scene = answers.decided, answers.decided.scene
    if scene.mu is None:
        no_mass = scene.M is None and scene.I is None and not (decided.axle_holds or decided.is_driven)
        that = "On a massless pulley, that" if no_mass else "That"
        slides = "; for a pulley without friction, give `mu` = 0" if decided.locked else ""
        return f"Without `mu`, no slip is assumed. {that} needs `mu` of at least {_enough(answers)}{slides}."
    return f"No slip: `mu` = {as_typed(scene.mu)}, and at least {_enough(answers)} is needed."


def _on_the_verge(answers: Answers) -> str:
    if not answers.decided.scene.mu:
        return "Slips on any pulley with mass, as `mu` = 0; the values are for a massless pulley."
    massless, locked = (_on_pulley(answers, mass) for mass in (Fraction(0), inf))
    enough = locked.rounded("mu_verge", _beside(answers, answers.decided.scene.mu))
    return (
        "On the verge of slipping: as `M` is not given, this is for the critical pulley mass,"
        f" {_say(answers, 'critical_pulley_mass')} kg. On a heavier pulley the string slips; on a"
        f" massless one the acceleration is {_say(massless, 'acceleration')} m/s². On a locked pulley"
        f" (`--M inf`) it slips: that needs `mu` of at least {format_number(enough)}."
    )


def _slips(answers: Answers) -> str:
    decided, scene = answers.decided, answers.decided.scene
    if scene.mu is None:
        return "Slides over the locked pulley."
    mu = f"`mu` = {as_typed(scene.mu)}"
    kinetic = "" if scene.mu_k is None else f"; it slides with `mu_k` = {as_typed(scene.mu_k)}"
    if not decided.pulley_known:
        return (
            f"Slips on any pulley, because of axle friction: {mu} is below the"
            f" {_enough(answers, 'mu_verge_massless')} needed even on a massless one{kinetic}."
        )
    slips = (
        "Slips over a pulley held by axle friction" if decided.rim_at_rest and not decided.locked else "Slips"
    )
    return f"{slips}: {mu} is below the {_enough(answers)} needed to hold the string{kinetic}."


LOW_GRAVITY, HIGH_GRAVITY = 9.7, 9.9
"""Less or more than this (m/s²) is hardly gravity on Earth."""
LIKE_RADIANS = (0.3, 12.6)
"""The range of degrees that are probably radians, or turns: a short arc, but up to two turns in radians."""

WHOLE_TURN = {"°": 360, "rad": 6.28}
"""A wrap as people type it from which on the string is wound round, as on a drum."""


def remarks(answers: Answers) -> Iterator[str]:
    """Yield further sentences on the scene, as far as they apply."""
    answers = answers.in_units(IN_SI)
    decided, mu_k = answers.decided, answers.decided.scene.mu_k
    if decided.beta is not None and decided.beta > 1:
        rounded = format_number(strip_zeros(_beside(answers, Fraction(1))(decided.beta)))
        shown = as_typed(decided.beta) if decided.scene.I is None else rounded
        yield (
            f"The inertia factor `I/(M R^2)` is {shown}, above 1: some mass must lie outside"
            " the string's rim. If none does, check `inertia`, `I` and `R`."
        )
    yield from (*_on_weights(answers), *on_units(answers), *_on_what_is_found(answers))
    if decided.lacking:
        yield from _without_effect(answers)
        return
    is_wound = decided.scene.wrap.number >= WHOLE_TURN[decided.scene.wrap.unit]
    is_open = decided.scene.M is decided.scene.I is None and decided.motion.finds is None
    if is_wound and is_open and decided.regime != "verge":  # there the verdict says that
        yield "`M` is not given; a drum that does not turn is `--M inf`."
    if mu_k is not None and decided.regime != "slip" and not decided.tensions_equal:
        yield "`mu_k` has no effect here, as the string does not slip."
        if answers["mu_verge"] is not None and answers.settle(lambda m: m.mu_verge - m.ar.number(mu_k)) > 0:
            yield "A string that already slides keeps sliding, as `mu_k` is below `mu_verge`."
    slips_above_a_mass = decided.scene.mu is not None and decided.slips_once_it_moves
    may_turn = decided.rim_mass is not None and not decided.is_driven
    if slips_above_a_mass and may_turn and not decided.slips_at("heaviest"):
        yield "Far above `critical_heavier_mass`, the string holds again, as the pulley turns with it."
    if decided.locked and decided.has_axle_friction and not decided.axle_holds:
        yield "A locked pulley does not turn, so `axle` has no effect."
    if decided.scene.mu is not None and answers["acceleration"] is None:  # it depends on the pulley's mass
        ends = [_on_pulley(answers, mass) for mass in (Fraction(0), inf)]
        ranges = (
            f"`{name}` from {_say(ends[0], name)} to {with_unit(_say(ends[1], name), QUANTITIES[name].unit)}"
            for name in ("acceleration", "tension_1", "tension_2", "mu_verge")
        )
        yield f"As `M` goes from 0 to `inf`: {', '.join(ranges)}."


def _without_effect(answers: Answers) -> Iterator[str]:
    """Say which inputs have no part in what the page has without a mass."""
    decided, scene = answers.decided, answers.decided.scene
    used, wanted = {"mu", "wrap", "g"}, "`capstan_ratio`"
    if answers["moment_of_inertia"] is not None:
        used |= {"M", "inertia", "I", "R"}
    if decided.has_one_mass:
        used, wanted = {*used, *MASSES, "M", "inertia"}, f"limits of `{decided.lacking[0]}`"
        if not decided.slips_by_tensions:
            used |= {"axle", *(terms.by for _, terms in scene.terms)}
    given = (x for x in inputs_in_words(answers) if answers.typed(x).given is not None)
    if idle := [f"`{x}`" for x in given if x not in used]:
        yield f"Without effect on the {wanted}: {', '.join(idle)}."


def _on_what_is_found(answers: Answers) -> Iterator[str]:
    """Say for which pulley a mass is found, what else explains an unusual gravity, and what a sign means."""
    decided, scene = answers.decided, answers.decided.scene
    finds = decided.motion.finds
    if finds in MASSES and scene.M is scene.I is None:
        yield f"`{finds}` is for a massless pulley, as `M` is not given; 0 is an end fixed to the pulley."
    if finds == "axle" and decided.motion.a is None:
        yield "The masses are taken to speed up from rest; if they come to rest, give an `a` below 0."
    falls = decided.motion.fall and not (finds or decided.lacking) and decided.has_axle_friction
    if falls and decided.regime == "no-slip" and decided.rim_mass is not None and answers["acceleration"]:
        rising = answers.settle(lambda m: acceleration(drive(m.l, m.h, -m.b), load(m.l, m.h, m.c), m.g))
        yield f"The fall is from rest; while the mass still rises, `a` is {format_number(rising)} m/s²."
    if finds == "axle" and decided.motion.a == 0:
        yield "As the masses rest, `axle` is the least friction that holds them; it may be more."
    if finds == "g" and not LOW_GRAVITY < scene.g < HIGH_GRAVITY:
        causes = "inertia, axle friction (`--find axle`) or a motor (`--find drive`)"
        yield f"`g` is not the Earth's; {causes} may explain the motion, too."
    if decided.is_driven and (answers["drive_force"] or 0) < 0:
        yield "A `drive_force` below 0 pulls `m2` up."
    grips = decided.is_driven and decided.regime == "no-slip" and decided.rim_mass is not None
    if grips and decided.has_axle_friction:
        forces = (answers.settle(methodcaller("drive_force_against", way)) for way in (1, -1))
        down, up = map(format_number, forces)
        friction = "as the axle's friction opposes the motion"
        yield f"`drive_force` is {down} N if `m2` descends, and {up} N if it rises, {friction}."


PULL = (
    "A pull by hand is not a hanging weight: the tension there is the pull itself, and the acceleration and"
    " the other tension differ."
)


def on_units(answers: Answers) -> Iterator[str]:
    """Say of numbers without a unit what they may have been meant to be: radians, turns, or a weight."""
    scene, wrap, axle = answers.decided.scene, answers.decided.scene.wrap, answers.typed("axle")
    if wrap.unit == "°" and LIKE_RADIANS[0] < wrap.number < LIKE_RADIANS[1]:
        typed = as_typed(wrap.number)
        yield f"The wrap is {typed}°; for radians write {typed}rad, for turns {typed}turn."
    if scene.R is not None and axle.number and not axle.unit.symbol:
        typed = as_typed(axle.number)
        yield f"`axle` is read as a force, {typed} N; a torque is {typed}Nm."
    weights = [x for x, _ in scene.terms if x in MASSES]
    for x in MASSES if weights else ():
        if x not in (*weights, scene.motion.finds) and scene.own(x) and not answers.typed(x).unit.symbol:
            yield f"`{x}` is a mass of {as_given(answers, x)}; for a weight give its unit."
    if any(map(scene.own, weights)) and not scene.lacking and answers["acceleration"] != 0:
        yield PULL


def _on_weights(answers: Answers) -> Iterator[str]:
    """Say the masses of weights, and which way a mass is taken to move."""
    scene, motion = answers.decided.scene, answers.decided.motion
    for x, _ in scene.terms:
        if x in MASSES and (mass := scene.own(x)):
            in_kg = format_number(strip_zeros(_beside(answers, None)(mass)))
            yield f"`{x}` is a weight of {as_given(answers, x)}, the mass {in_kg} kg."
    either_way = motion.finds == DRIVE or (motion.finds in MASSES and 0 not in (scene.m1, scene.m2))
    is_steady = motion.finds == DRIVE and motion.a == 0 and motion.way != 0
    if either_way and (motion.a is None or is_steady):
        name, verb = "speed" if motion.drop is None else "drop", "move" if is_steady else "accelerate"
        way = "upwards, as" if getattr(motion, name) < 0 else "downwards, unless"
        slower = motion.finds == DRIVE and not is_steady
        sentence = f"`m2` is taken to {verb} {way} `{name}` is below 0."
        yield f"{sentence}{IF_SLOWER}" if slower else sentence


IF_SLOWER = " What rises ever slower accelerates downwards, and has the `drive_power` with the other sign."


def _on_pulley(answers: Answers, mass: Fraction | float) -> Answers:
    """Return the answers to the scene on a pulley of that mass (inf: locked), without slip."""
    return Answers(answers.decided.scene._replace(M=mass, mu=None, mu_k=None), answers.digits)


def _beside(answers: Answers, given: Fraction | None) -> Rounding[Decimal]:
    """Return the rounding of tables, or one to more digits in which a number differs from a ``given`` one."""
    return rounding_apart_from(given, answers.digits or SHOWN_DIGITS)


def _say(answers: Answers, name: str) -> str:
    """Say a value as the table shows it."""
    return format_number(answers[name])
