"""The derivation for a scene, step by step in the paper's order: the words around the equations.

Every number and every equation with numbers comes from `equations`, the words on the regime and on what is
missing from the solver's `messages`. `typeset` puts it on a page.
"""

from collections.abc import Iterator
from fractions import Fraction
from typing import NamedTuple

from ..model.quantities import QUANTITIES
from ..solver.answers import Answers
from ..solver.messages import (
    conditions,
    holding_again,
    kinetic,
    missing,
    odd_inertia,
    open_range,
    verdict,
)
from .equations import Derivation, Law, Part


class Step(NamedTuple):
    """A step: its title, and sentences and equations in turn.

    Symbols in sentences stand between backticks; a sentence after "- " is an item of a list.
    """

    title: str
    body: list[Part]


class Explanation(NamedTuple):
    """The answer first, how to read what follows, and the steps to it; a page has a title."""

    answer: list[str]
    reading: str
    steps: list[Step]
    title: str = "Atwood's machine, step by step"


def explain(answers: Answers) -> Explanation:
    """The derivation for a scene, to the digits of ``answers``, or as many as tables show."""
    answers = answers.shown
    derivation = Derivation(answers)
    case = answers.case
    steps = [_masses(derivation), _pulley(derivation)]
    if not case.light:
        steps += [_motion(derivation)]
    elif case.regime == "no-slip":
        steps += [_motion(derivation), _grip(derivation), _friction(derivation)]
    else:
        steps += [_grip(derivation), _motion(derivation), _friction(derivation)]
    if case.scene.mu and case.sign:
        steps.append(_limits(derivation))
    steps += [*_simpler(derivation), _model(derivation)]
    known = [name for name in ("acceleration", "tension_1", "tension_2") if answers[name] is not None]
    answer = [verdict(answers), ", ".join(map(derivation.say, known)) + "."] if known else [verdict(answers)]
    return Explanation(
        answer,
        "After = both sides are exactly equal, after ≈ the result is rounded to"
        f" {derivation.digits} significant digits. Numbers put in have as many digits as it takes to give the"
        " result.",
        steps,
    )


def _masses(derivation: Derivation) -> Step:
    l, h = derivation.light, derivation.heavy
    body: list[Part] = [
        "Two forces act on each mass: its weight, downwards, and the tension of the string it hangs on,"
        " upwards. The string does not stretch, so both masses have the same acceleration."
    ]
    a = derivation.names["magnitude"]
    if derivation.case.sign == 0:
        body.append("Neither is the heavier, so neither descends: `a` = 0.")
    else:
        body.append(f"`m{h}` is the heavier and descends, `m{l}` rises:")
    body += [Law("(1)", f"T{l} - m{l} g = m{l} {a}"), Law("(1)", f"m{h} g - T{h} = m{h} {a}")]
    if derivation.case.sign < 0:
        body.append("(The paper has `m2` for the heavier mass; here 1 and 2 change places.)")
    return Step("The masses", body)


def _pulley(derivation: Derivation) -> Step:
    case = derivation.case
    difference, rubs = derivation.names["difference"], case.axle_friction is not None
    body: list[Part] = [
        "`T1` and `T2` do not act on the pulley. They act on the string, at the two points where it"
        " leaves the pulley. What acts on the pulley is the contact force of the string, all along the"
        " arc on which it lies: friction `f`, along the rim, and the normal force `n`, towards the axle,"
        " both per metre of string. The string has no mass, so the forces on each element of it cancel."
        " From that follows",
        Law("(12)", "f R = dT/dθ"),
        Law("(13)", "n R = T(θ)"),
        "Friction makes the tension change along the arc, and the change of tension is the friction."
        f" All of it together is the force{', downwards,' * case.ends_hang_down} and the torque that `T1` and"
        " `T2` would have if they did act on the pulley. That is a result and not an assumption:",
    ]
    if case.ends_hang_down:
        body.append(Law("(20)", "F_pulley = T1 + T2"))
    body.append(Law("(23)", f"τ = R ({difference})"))
    if not case.light:
        body.append(
            "Here the string is fixed to the pulley and nothing hangs from its free end. It pulls where it is"
            " fixed, too, and with that the torque is the same."
        )
    body += _turning(derivation)
    if case.axle_holds and not case.locked:
        body.append("The axle holds the difference of the masses, which is no more than `b`: `α = 0`.")
    elif case.sign == 0:
        body.append("The masses are at rest, and the pulley with them: equal tensions do not turn it.")
    elif case.locked:
        body.append("`M` = `inf` is a pulley that is locked: `α = 0`, whatever the torque.")
    elif case.tensions_equal:
        body.append(
            "Without mass `I = 0`, so `c = I/R^2 = 0`, and it takes no torque to turn the pulley:"
            " the tensions are equal."
        )
    else:
        grips = (
            "While the string does not slip"
            if derivation.scene.mu is not None
            else "As the string does not slip"
        )
        body += [
            f"{grips}, the rim has the acceleration of the masses, `α = a/R`. With `c = I/R^2`, the pulley's"
            " inertia as a mass at the rim (`M/2` for the disk of the paper),",
            Law("(3)", f"{difference} = c {derivation.names['magnitude']}{' + f_axle' * rubs}"),
            *derivation.rim_mass(),
            *odd_inertia(derivation.answers),
        ]
    return Step("The pulley", body)


def _turning(derivation: Derivation) -> Iterator[Part]:
    """What turns the pulley, (2), and what the friction of its axle takes of that."""
    difference = derivation.names["difference"]
    if derivation.case.axle_friction is None:
        yield "The pulley's weight and the force of the axle act at the axle and do not turn it. So"
        yield Law("(2)", f"({difference}) R = I α")
        return
    yield (
        "The pulley's weight acts at the axle and does not turn it. The axle rubs: its friction opposes the"
        " turning like a force `f_axle` at the rim. So, while the pulley turns,"
    )
    yield Law("(2)", f"({difference} - f_axle) R = I α")
    yield "and it stands while the tensions differ by no more than `f_axle`, the weight of a mass `b`:"
    yield from derivation.axle()
    yield "(The axle of the paper does not rub: its equations are those here with `f_axle = 0` and `b = 0`.)"


def _motion(derivation: Derivation) -> Step:
    case, answers = derivation.case, derivation.answers
    body: list[Part] = []
    if case.regime != "no-slip":
        return Step("The motion", [*_motion_at_the_limit(derivation), *derivation.extras()])
    if answers["acceleration"] is None:
        return Step(
            "The motion",
            ["The motion depends on the pulley's mass, which is not given.", *open_range(answers)],
        )
    if case.sign == 0 or case.stands:
        body += ["At rest, `a` = 0, each tension is the weight that hangs on it."]
    else:
        body += ["The sum of (1) and (3) has only the acceleration left. It gives the tensions."]
        body += derivation.lines("magnitude")
        body += derivation.direction()
    return Step("The motion", [*body, *derivation.tensions(), *derivation.extras()])


def _motion_at_the_limit(derivation: Derivation) -> Iterator["Part"]:
    case, scene, l, h = derivation.case, derivation.scene, derivation.light, derivation.heavy
    kinetic = case.regime == "slip" and scene.mu_k is not None
    k = "k_kin" if kinetic else "k"
    if case.regime == "slip":
        yield (
            "The string slides, so friction is at its limit all along the arc"
            + (", that of kinetic friction" if kinetic else "")
            + f". The tensions have the ratio `{k}`, and the mass of the pulley does not enter."
        )
    elif case.limiting_mu:
        yield "On a pulley of the critical mass, friction is just at its limit all along the arc."
    if case.limiting_mu:
        if kinetic:
            yield Law("(26)", f"T{h} = T{l} {k}")
        yield from derivation.lines("k1" if not kinetic else "limiting_k1")
    else:
        yield f"Without friction `{k} = 1`, and the pulley has no part in the motion."
    z, d = ("z_kin", "d_kin") if kinetic else ("z", "d")
    yield (
        f"The lighter mass counts as `m{l} {k}` = `m{l} + {z}`. What is left of the heavier one,"
        f" `{d}`, drives"
        " them."
    )
    yield from derivation.lines(
        *(("limiting_transfer", "limiting_drive") if kinetic else ("transfer", "drive"))
    )
    yield from derivation.lines("magnitude")
    yield from derivation.direction()
    yield from derivation.tensions()
    if case.regime == "slip" and case.limiting_mu:
        if case.locked:
            yield "The pulley is locked: its rim stands still."
        elif case.rim_stands:
            yield "The tensions differ by less than `f_axle`: the axle holds the pulley."
        else:
            yield "Friction turns the pulley by (3), but its rim falls behind the string:"
            yield from derivation.lines("rim_acceleration")
    elif case.regime == "slip":
        yield "Nothing turns the pulley."


def _grip(derivation: Derivation) -> Step:
    case, scene, l, h = derivation.case, derivation.scene, derivation.light, derivation.heavy
    body: list[Part] = []
    if case.tensions_equal:
        body.append("Equal tensions need no friction along the arc. So the string holds, whatever `μ` is.")
        return Step("Does the string hold?", body)
    body += [
        "Friction can be `μ n` and no more. Where it is that, with (12) and (13),",
        Law("(24)", "f = μ n"),
        Law("(25)", "dT/dθ = μ T"),
        Law("(26)", f"T(θ) = T{l} e^(μ θ)"),
        f"so at the most, friction makes `T{h}` as large as `k` = `e^(μ {derivation.names['phi']})`"
        f" times `T{l}`"
        + (f", where {derivation.value('phi', 'rad')}." if not derivation.half_turn else "."),
    ]
    if not scene.mu and scene.mu is not None:
        body.append("Without friction `k = 1`: the tensions are equal and nothing turns the pulley.")
        if case.regime == "verge" and derivation.answers["critical_pulley_mass"] is not None:
            body.append(f"Only without mass does it go along: {derivation.say('critical_pulley_mass')}.")
    elif case.pulley_known:
        if_held = (
            "By (4) the tensions have"
            if case.regime == "no-slip"
            else "If the string held, the tensions would by (4) have"
        )
        held = "a locked pulley" if case.locked else "a pulley that the axle holds"
        standing = f"On {held} the tensions are the weights. Their ratio is `T{h}/T{l}` = `1 + x`, with"
        moving = f"{if_held} the ratio `T{h}/T{l}` = `1 + x`, with"
        body += [standing if case.stands else moving, *derivation.lines("excess")]
        body += ["and the least coefficient that allows it is", *derivation.lines("mu_verge")]
    else:
        body += [*derivation.lines("k1", "transfer")]
        body += [
            f"The heavier the pulley, the larger the ratio; on a locked one it is `m{h}/m{l}`."
            f" If it is to slip on any pulley at all, `m{h}` must exceed `m{l} k` = `m{l} + z`.",
            *derivation.lines("least_heavier_mass"),
        ]
        if case.always_slips:
            body += [
                "It does. But the axle takes a ratio of its own: even on a pulley without mass, the least"
                " coefficient that holds the string is",
                *derivation.lines("massless_verge"),
            ]
        elif case.can_slip:
            body += ["It does, by", *derivation.lines("drive")]
            body += [
                "The ratio (33) is `k` on a pulley of the critical mass,",
                *derivation.lines("critical_pulley_mass"),
            ]
    return Step("Does the string hold?", [*body, verdict(derivation.answers), *kinetic(derivation.answers)])


def _friction(derivation: Derivation) -> Step:
    case, answers = derivation.case, derivation.answers
    body: list[Part] = []
    if case.frictionless:
        return Step("The friction on the pulley", ["There is none."])
    if answers["friction_force"] is not None:
        if case.regime == "no-slip":
            body.append("How friction is spread depends on `μ`. If that is just `μ*`, it is at its limit")
        else:
            body.append("Friction is at its limit")
        body[-1] = f"{body[-1]} all along the arc, so `T(θ)` is known, and the net force on the pulley is"
        body += derivation.lines("friction_force")
        body += [] if case.ends_hang_down else [f"with {derivation.value('half_sine')}."]
        axes = "`x` towards the side of `m1` and `y` upwards"
        if not case.ends_hang_down:
            axes = "`x` towards where `m1`'s string meets the pulley and `y` a quarter turn on along the arc"
        body.append(
            f"As a vector, {axes}, it is"
            f" {derivation.say('friction_force_x')},"
            f" {derivation.say('friction_force_y')} by (31)."
        )
        if case.ends_hang_down:
            body.append(
                "Its `x` component is not 0: no symmetry cancels it, as the tension changes along the arc."
            )
    elif not case.pulley_known:
        body.append("It depends on the pulley's mass, which is not given.")
    else:
        meaning = QUANTITIES["friction_force"].meaning
        body.append(
            f"The {meaning} is {derivation.reason('friction_force')}. (So the paper says after (17), as"
            " `T(θ)` is not known.)"
        )
        if answers["friction_force_max"] is not None:
            body += [
                "To make up the ratio of the tensions, friction is needed at its limit on a part of"
                " the arc only,",
                *derivation.lines("alpha"),
                "Its net force is the greatest if that is one piece of the arc,",
                *derivation.lines("friction_force_max"),
                "and the least if it is a piece at each end; how long each is, is found by search:"
                f" {derivation.say('friction_force_min')}.",
            ]
    return Step("The friction on the pulley", body)


def _limits(derivation: Derivation) -> Step:
    body: list[Part] = []
    if masses := [*derivation.lines("critical_pulley_mass", "critical_heavier_mass")]:
        if derivation.case.regime != "verge":
            body.append("Static friction at its limit all along the arc makes the ratio (33) equal to `k`.")
        meanings = (f"`{mass.left}` is the {derivation.meaning(mass.left)}" for mass in masses)
        body.append(f"{', '.join(meanings)}.")
        body += [*derivation.lines("k1", "transfer", *["drive"] * derivation.case.can_slip), *masses]
    if least := [*derivation.lines("least_heavier_mass", "least_pulley_mass")]:
        pulley = " and the pulley's mass `M min`" * (derivation.answers["least_pulley_mass"] is not None)
        body.append(f"For the verge, the heavier mass must exceed `m min`{pulley}.")
        body += [*derivation.lines("k1", "transfer"), *least]
    answers = derivation.answers
    return Step("The critical masses", [*body, *holding_again(answers), *conditions(answers)])


def _simpler(derivation: Derivation) -> Iterator[Step]:
    """What simpler models would give for this scene, and how far off."""
    case, scene, digits = derivation.case, derivation.scene, derivation.digits
    if case.sign == 0 or derivation.answers["acceleration"] is None:
        return
    massless = Answers(scene._replace(M=Fraction(0), I=None, inertia=Fraction(1)), digits)
    runs_freely = case.frictionless and case.axle_friction is None
    if not (runs_freely or case.axle_holds or case.rim_mass == 0):
        body = [*derivation.compared(massless)]
        if case.regime == massless.case.regime == "slip":
            body = ["Nothing changes: the string slips over a pulley without mass, too, as its axle rubs."]
        yield Step("What if the pulley's mass is ignored?", body)
    if case.axle_friction is not None and case.regime == "no-slip" and not case.locked:
        freely = Answers(scene._replace(axle=None), digits)
        if freely["acceleration"] is not None:
            yield Step("What if the axle did not rub?", [*derivation.compared(freely)])
    if case.regime == "slip" and case.pulley_known:
        holding = scene._replace(mu=None, mu_k=None)
        yield Step("What if slipping is ignored?", [*derivation.compared(Answers(holding, digits))])


def _model(derivation: Derivation) -> Step:
    case, scene = derivation.case, derivation.scene
    pulley = (
        "a pulley without mass"
        if case.tensions_equal and case.sign
        else "a pulley with its moment of inertia"
    )
    sheaves = "" if case.ends_hang_down else ", guide sheaves without mass or friction"
    friction = ", Coulomb friction between the two" if scene.mu is not None else ""
    rubs = case.axle_friction is not None
    axle = "an axle with constant friction" if rubs else "an axle without friction"
    missing_axle = "" if rubs else " friction in the axle,"
    reasons = {item: 1 for item in derivation.answers.reasons.items() if item[0] not in derivation.explained}
    return Step(
        "What is modelled and what is not",
        [
            f"Modelled: a string without mass that does not stretch, {pulley}, {axle}{sheaves}{friction}.",
            f"Not modelled: the string's mass, stretch and stiffness,{missing_axle} air."
            " Nothing in these numbers says how much they matter.",
            *missing(reasons),
        ],
    )
