"""The derivation for a scene, step by step in the paper's order: the words around the equations.

Every number and every equation with numbers comes from `equations`, the words on the regime and on what is
missing from the solver's `messages`. `typeset` puts it on a page.
"""

from collections.abc import Iterable, Iterator
from fractions import Fraction
from operator import mul, truediv
from typing import Any, NamedTuple

from ..model import physics
from ..model.digits import as_typed, is_infinite
from ..model.quantities import QUANTITIES
from .answers import Answers
from .critical import critical, fallen, found, in_the_paper
from .equations import MOTION, Derivation, Law, Part
from .messages import holding_again, kinetic, odd_inertia, open_range, verdict


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
    motion = [*[found] * bool(case.motion.finds), _motion]
    if not case.light:
        middle = motion
    elif case.regime == "no-slip":
        middle = [*motion, _grip, _friction]
    else:
        middle = [_grip, *motion, _friction]
    limits = [_limits] if case.scene.mu and case.sign else []
    first = [Step(TITLES[body], [*body(derivation)]) for body in (_masses, _pulley, *middle, *limits)]
    model = Step("What is modelled", [*_model(derivation)])

    def values(names: Iterable[str]) -> str:
        return ", ".join(derivation.say(name) for name in names if answers[name] is not None)

    told, main = values(answers.found), values(name for name in MOTION if name not in answers.found)
    return Explanation(
        [*[f"Found: {told}."] * bool(told), verdict(answers), *[f"{main}."] * bool(main)],
        "After = both sides are exactly equal, after ≈ the result is rounded to"
        f" {derivation.digits} significant digits; numbers put in have two more. Numbers of equations are"
        " those of de Oliveira and Lemos, Force and torque of a string on a pulley, arXiv:1706.10139.",
        [*first, *_simpler(derivation), model],
    )


def _masses(derivation: Derivation) -> Iterator[Part]:
    l, h, a = derivation.light, derivation.heavy, derivation.symbol("magnitude")
    yield (
        "Two forces act on each mass: its weight, downwards, and the tension of the string it hangs on,"
        " upwards. The string does not stretch, so both masses have the same acceleration."
    )
    if derivation.case.sign == 0:
        yield "Neither is the heavier, so neither descends: `a` = 0."
    else:
        yield f"`m{h}` is the heavier and descends, `m{l}` rises:"
    yield Law("(1)", f"T{l} - m{l} g = m{l} {a}")
    yield Law("(1)", f"m{h} g - T{h} = m{h} {a}")
    if derivation.case.sign < 0:
        yield "(The paper has `m2` for the heavier mass; here 1 and 2 change places.)"


def _pulley(derivation: Derivation) -> Iterator[Part]:
    case, difference = derivation.case, derivation.symbol("difference")
    yield (
        "`T1` and `T2` do not act on the pulley. They act on the string, at the two points where it"
        " leaves the pulley. What acts on the pulley is the contact force of the string, all along the"
        " arc on which it lies: friction `f`, along the rim, and the normal force `n`, towards the axle,"
        " both per metre of string. The string has no mass, so the forces on each element of it cancel."
        " From that follows"
    )
    yield Law("(12)", "f R = dT/dθ")
    yield Law("(13)", "n R = T(θ)")
    yield (
        "Friction makes the tension change along the arc, and the change of tension is the friction."
        f" All of it together is the force{', downwards,' * case.ends_hang_down} and the torque that `T1` and"
        " `T2` would have if they did act on the pulley. That is a result and not an assumption:"
    )
    if case.ends_hang_down:
        yield Law("(20)", "F_pulley = T1 + T2")
    yield Law("(23)", f"τ = R ({difference})")
    if not case.light:
        yield (
            "Here the string is fixed to the pulley and nothing hangs from its free end. It pulls where it is"
            " fixed, too, and with that the torque is the same."
        )
    yield from _turning(derivation)
    yield from _with_the_rim(derivation)


def _with_the_rim(derivation: Derivation) -> Iterator[Part]:
    """How the pulley goes along with the masses, (3), and its inertia as a mass at the rim."""
    case, difference = derivation.case, derivation.symbol("difference")
    if case.axle_holds and not case.locked:
        yield "The axle holds the difference of the masses, which is no more than `b`: `α = 0`."
    elif case.sign == 0:
        yield "The masses are at rest, and the pulley with them: equal tensions do not turn it."
    elif case.locked:
        yield "`M` = `inf` is a pulley that is locked: `α = 0`, whatever the torque."
    elif case.tensions_equal:
        yield (
            "Without mass `I = 0`, so `c = I/R^2 = 0`, and it takes no torque to turn the pulley:"
            " the tensions are equal."
        )
    else:
        while_ = "While" if derivation.scene.mu is not None else "As"
        yield (
            f"{while_} the string does not slip, the rim has the acceleration of the masses, `α = a/R`. With"
            " `c = I/R^2`, the pulley's inertia as a mass at the rim (`M/2` for the disk of the paper),"
        )
        friction = " + f_axle" * case.rubs
        yield Law(derivation.cite("(3)"), f"{difference} = c {derivation.symbol('magnitude')}{friction}")
        if case.rim_mass is None:
            yield f"where `c = β M` and `β` = {as_typed(derivation.scene.inertia or Fraction(1))}."
        elif derivation.scene.I is not None:
            yield derivation.by("c", lambda I, R: I / (R * R), "I R")
        elif case.motion.finds != "M":
            yield derivation.by("c", mul, "β M")
        yield from odd_inertia(derivation.answers)


def _turning(derivation: Derivation) -> Iterator[Part]:
    """What turns the pulley, (2), and what the friction of its axle takes of that."""
    difference = derivation.symbol("difference")
    if not derivation.case.rubs:
        yield "The pulley's weight and the force of the axle act at the axle and do not turn it. So"
        yield Law("(2)", f"({difference}) R = I α")
        return
    yield (
        "The pulley's weight acts at the axle and does not turn it. The axle rubs: its friction opposes the"
        " turning like a force `f_axle` at the rim. So, while the pulley turns,"
    )
    yield Law(derivation.cite("(2)"), f"({difference} - f_axle) R = I α")
    known = derivation.case.motion.finds != "g"
    words = "and it stands while the tensions differ by no more than `f_axle`, the weight of a mass `b`"
    yield f"{words}{':' if known else '.'}"
    if derivation.scene.axle and derivation.scene.axle.unit == "N m":
        yield derivation.by("f_axle", truediv, "τ_axle R")
    if known:
        yield derivation.by("b", physics.axle_mass, "f g")
    yield (
        "(+b marks an equation of the paper that this friction enters. The axle of the paper does not rub:"
        " its equations are those here with `f_axle = 0` and `b = 0`.)"
    )


def _motion(derivation: Derivation) -> Iterator[Part]:
    case, answers = derivation.case, derivation.answers
    if case.regime != "no-slip":
        yield from _motion_at_the_limit(derivation)
    elif answers["acceleration"] is None:
        yield "The motion depends on the pulley's mass, which is not given."
        yield from open_range(answers)
        return
    elif case.sign == 0 or case.stands:
        yield "At rest, `a` = 0, each tension is the weight that hangs on it."
    elif case.motion.finds:
        yield f"With the measured acceleration, (1) and {derivation.cite('(3)')} give the tensions."
    else:
        yield (
            f"The sum of (1) and {derivation.cite('(3)')} has only the acceleration left. It gives the"
            " tensions."
        )
        yield from derivation.motion("magnitude")
    yield from derivation.lines("light_tension")
    if case.frictionless:
        yield Law("", f"T{derivation.heavy} = T{derivation.light}")
    else:
        yield from derivation.lines("difference", "heavy_tension")
    yield from _rim(derivation)
    yield from fallen(derivation)
    if derivation.scene.R is not None and case.sign:
        yield "On the pulley, that makes"
        turns = case.regime != "slip" or not case.rim_stands
        yield from derivation.lines("torque", *["angular_acceleration"] * turns)
    if answers["axle_force"] is not None:
        yield "The axle bears both tensions, as (20) says, and the pulley's weight:"
        yield from derivation.lines("axle_force")


def _motion_at_the_limit(derivation: Derivation) -> Iterator[Part]:
    case, scene, l, h = derivation.case, derivation.scene, derivation.light, derivation.heavy
    if case.slide_measured:
        yield "With the measured acceleration, (1) and this ratio give the tensions."
        yield from derivation.motion()
        return
    kinetic = case.regime == "slip" and scene.mu_k is not None
    k, z, d = ("k_kin", "z_kin", "d_kin") if kinetic else ("k", "z", "d")
    limiting = "limiting_" * kinetic
    if case.regime == "slip":
        yield (
            "The string slides, so friction is at its limit all along the arc"
            f"{', that of kinetic friction' * kinetic}. The tensions have the ratio `{k}`, and the mass of"
            " the pulley does not enter."
        )
    elif case.limiting_mu:
        yield "On a pulley of the critical mass, friction is just at its limit all along the arc."
    if not case.limiting_mu:
        yield f"Without friction `{k} = 1`, and the pulley has no part in the motion."
    else:
        if kinetic:
            yield Law("(26)", f"T{h} = T{l} {k}")
        yield from derivation.lines(f"{limiting}k1")
    yield (
        f"The lighter mass counts as `m{l} {k}` = `m{l} + {z}`. What is left of the heavier one, `{d}`,"
        " drives them."
    )
    yield from derivation.motion(f"{limiting}transfer", f"{limiting}drive", "magnitude")


def _rim(derivation: Derivation) -> Iterator[Part]:
    """What becomes of the pulley while the string slips."""
    case = derivation.case
    if case.regime != "slip":
        return
    if not case.limiting_mu:
        yield "Nothing turns the pulley."
    elif case.locked:
        yield "The pulley is locked: its rim stands still."
    elif case.rim_stands:
        yield "The tensions differ by less than `f_axle`: the axle holds the pulley."
    else:
        yield f"Friction turns the pulley by {derivation.cite('(3)')}, but its rim falls behind the string:"
        yield from derivation.lines("rim_acceleration")


def _grip(derivation: Derivation) -> Iterator[Part]:
    case, scene, answers = derivation.case, derivation.scene, derivation.answers
    l, h = derivation.light, derivation.heavy
    if case.tensions_equal:
        yield "Equal tensions need no friction along the arc. So the string holds, whatever `μ` is."
        return
    yield "Friction can be `μ n` and no more. Where it is that, with (12) and (13),"
    yield Law("(24)", "f = μ n")
    yield Law("(25)", "dT/dθ = μ T")
    yield Law("(26)", f"T(θ) = T{l} e^(μ θ)")
    angle = "" if derivation.scene.wrap.is_half_turn else f", where {derivation.say('phi')}"
    called = ""
    if scene.mu is not None:
        value = "" if is_infinite(answers["capstan_ratio"]) else f": {derivation.say('capstan_ratio')}"
        called = f" This capstan ratio is called `k`{value}."
    yield (
        f"so at the most, friction makes `T{h}` as large as `e^(μ {derivation.symbol('phi')})`"
        f" times `T{l}`{angle}.{called}"
    )
    if not scene.mu and scene.mu is not None:
        yield "Without friction `k = 1`: the tensions are equal and nothing turns the pulley."
        if case.regime == "verge" and derivation.answers["critical_pulley_mass"] is not None:
            yield f"Only without mass does it go along: {derivation.say('critical_pulley_mass')}."
    elif case.pulley_known:
        yield from _least_grip(derivation)
    else:
        yield from _grip_on_any_pulley(derivation)
    yield verdict(answers)
    if scene.mu and case.pulley_known:
        yield f"There is {derivation.say('safety_factor')} times the friction that is needed."
    yield from kinetic(answers)


def _least_grip(derivation: Derivation) -> Iterator[Part]:
    """The ratio of the tensions of a string that holds, and the least coefficient that allows it."""
    case, l, h = derivation.case, derivation.light, derivation.heavy
    if case.stands:
        held = "a locked pulley" if case.locked else "a pulley that the axle holds"
        have = f"On {held} the tensions of a string that holds are the weights. Their ratio is"
    elif case.regime == "no-slip":
        have = f"By {derivation.cite('(4)')} the tensions have the ratio"
    else:
        have = f"If the string held, the tensions would by {derivation.cite('(4)')} have the ratio"
    yield f"{have} `T{h}/T{l}` = `1 + x`, with"
    yield from derivation.lines("excess")
    if case.regime == "no-slip":
        yield "so the ratio is"
        yield from derivation.lines("tension_ratio")
        yield from in_the_paper(derivation, "tension_ratio")
    yield "The least coefficient that allows it is, by (26) for the whole arc,"
    yield from derivation.lines("mu_verge")


def _grip_on_any_pulley(derivation: Derivation) -> Iterator[Part]:
    case, l, h = derivation.case, derivation.light, derivation.heavy
    yield from derivation.lines("k1", "transfer")
    yield (
        f"The heavier the pulley, the larger the ratio; on a locked one it is `m{h}/m{l}`."
        f" If it is to slip on any pulley at all, `m{h}` must exceed `m{l} k` = `m{l} + z`."
    )
    yield from derivation.lines("least_heavier_mass")
    if case.always_slips:
        yield (
            "It does. But the axle takes a ratio of its own: even on a pulley without mass, the least"
            " coefficient that holds the string is"
        )
        yield from derivation.lines("massless_verge")
    elif case.can_slip:
        yield "It does."
        yield from critical(derivation, "critical_pulley_mass")


def _friction(derivation: Derivation) -> Iterator[Part]:
    case, answers = derivation.case, derivation.answers
    if case.frictionless:
        yield "There is none."
    elif answers["friction_force"] is not None:
        where = "Friction is at its limit"
        if case.regime == "no-slip":
            where = "How friction is spread depends on `μ`. If that is just `μ*`, it is at its limit"
        yield f"{where} all along the arc, so `T(θ)` is known, and the net force on the pulley is"
        yield from derivation.lines("friction_force")
        axes = "`x` towards the side of `m1` and `y` upwards"
        if not case.ends_hang_down:
            yield f"with {derivation.say('half_sine')}."
            axes = "`x` towards where `m1`'s string meets the pulley and `y` a quarter turn on along the arc"
        vector = ", ".join(map(derivation.say, ("friction_force_x", "friction_force_y")))
        yield f"As a vector, {axes}, it is {vector} by (31)."
        if case.ends_hang_down:
            yield "Its `x` component is not 0: no symmetry cancels it, as the tension changes along the arc."
    elif not case.pulley_known:
        yield "It depends on the pulley's mass, which is not given."
    else:
        derivation.explained.add("friction_force")
        yield (
            f"The {QUANTITIES['friction_force'].meaning} is {answers.answer('friction_force').reason}. (So"
            " the paper says after (17), as `T(θ)` is not known.)"
        )
        if answers["friction_force_max"] is not None:
            yield (
                "To make up the ratio of the tensions, friction is needed at its limit on a part of the arc"
                " only,"
            )
            yield from derivation.lines("alpha")
            yield "Its net force is the greatest if that is one piece of the arc,"
            yield from derivation.lines("friction_force_max")
            yield (
                "and the least if it is a piece at each end; how long each is, is found by search:"
                f" {derivation.say('friction_force_min')}."
            )


def _limits(derivation: Derivation) -> Iterator[Part]:
    answers = derivation.answers
    if not derivation.case.tensions_equal:
        for name in ("critical_pulley_mass", "critical_heavier_mass", "critical_lighter_mass"):
            yield from critical(derivation, name)
    if least := [*derivation.lines("least_heavier_mass", "least_pulley_mass")]:
        pulley = " and the pulley's mass `M min`" * (answers["least_pulley_mass"] is not None)
        yield f"For the verge, the heavier mass must exceed `m min`{pulley}."
        yield from derivation.lines("k1", "transfer")
        yield from least
    yield from holding_again(answers)


def _simpler(derivation: Derivation) -> Iterator[Step]:
    """What simpler models would give for this scene, and how far off."""
    case = derivation.case
    if case.sign == 0 or derivation.answers["acceleration"] is None:
        return

    def instead(title: str, **changes: Any) -> Iterator[Step]:
        other = Answers(derivation.scene._replace(**changes), derivation.digits)
        if other["acceleration"] is None:
            return
        body = [*derivation.compared(other)]
        if other.case.regime == case.regime == "slip":
            body = ["Nothing changes: the string slips over a pulley without mass, too, as its axle rubs."]
        yield Step(title, body)

    if (case.rubs or not case.frictionless) and not case.axle_holds and case.rim_mass != 0:
        massless = {"M": Fraction(0), "I": None, "inertia": Fraction(1)}
        yield from instead("What if the pulley's mass is ignored?", **massless)
    if case.rubs and case.regime == "no-slip" and not case.locked:
        yield from instead("What if the axle did not rub?", axle=None)
    if case.regime == "slip" and case.pulley_known:
        yield from instead("What if slipping is ignored?", mu=None, mu_k=None)


def _model(derivation: Derivation) -> Iterator[Part]:
    case, rubs = derivation.case, derivation.case.rubs
    massless = case.tensions_equal and case.sign
    pulley = "a pulley without mass" if massless else "a pulley with its moment of inertia"
    axle = "an axle with constant friction" if rubs else "an axle without friction"
    sheaves = "" if case.ends_hang_down else ", guide sheaves without mass or friction"
    friction = ", Coulomb friction between the two" if derivation.scene.mu is not None else ""
    yield f"Modelled: a string without mass that does not stretch, {pulley}, {axle}{sheaves}{friction}."
    rubbing = "" if rubs else " friction in the axle,"
    yield f"Not modelled: the string's mass, stretch and stiffness,{rubbing} air."


TITLES = {
    _masses: "The masses",
    _pulley: "The pulley",
    found: "What the measured acceleration tells",
    _motion: "The motion",
    _grip: "Does the string hold?",
    _friction: "The friction on the pulley",
    _limits: "The critical masses",
}
