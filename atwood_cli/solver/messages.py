"""A solved scene in words: what the string does and why, and what is missing and why."""

from collections import Counter
from collections.abc import Mapping
from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal
from fractions import Fraction
from math import inf

from ..arithmetic.interval import LARGEST_EXPONENT
from ..arithmetic.rounding import as_typed, is_infinite, text, to_digits, to_double, to_side
from ..model.case import Case
from ..model.units import MAX_DIGITS, MAX_MAGNITUDE
from .answers import DOUBLE_DIGITS, Answers


def notes(answers: Answers) -> list[str]:
    """Sentences on the regime and why, on conditions (36), on what is missing and what is in doubt."""
    return [verdict(answers), *remarks(answers.shown), *conditions(answers.shown), *reasons(answers)]


def reasons(answers: Answers) -> list[str]:
    """What there is to say of the values asked for so far: why some are missing, what is in doubt."""
    missing = reasons_at(Counter(answers.reasons.items()), 1)
    uncertainties = answers.uncertainties
    if uncertainties is None:
        return missing
    unsure = {(f"u_{name}", reason): 1 for name, reason in answers.unsure.items()}
    return [*missing, *uncertainties.doubts(answers.asked), *reasons_at(unsure, 1)]


def reasons_at(counted: Mapping[tuple[str, str], int], points: int) -> list[str]:
    """Why values are missing: a sentence a reason, with the names, and at how many of the points."""
    names: dict[tuple[str, int], list[str]] = {}
    for (name, reason), times in counted.items():
        names.setdefault((reason, times), []).append(name)
    return [
        f"{', '.join(group)}: {reason}{'' if times == points else f' (at {times} of {points} points)'}."
        for (reason, times), group in names.items()
    ]


def verdict(answers: Answers) -> str:
    """What the string does, and why, in a sentence."""
    answers = answers.shown
    case, scene = answers.case, answers.case.scene
    heavy = as_typed(case.heavy)
    if case.sign == 0:
        return "At rest: the masses are equal, so no friction is needed."
    if case.axle_holds and case.regime == "no-slip":
        return f"At rest: the axle holds up to {_held(case)} of difference.{_string_at_rest(answers)}"
    if case.regime == "verge" and not scene.mu:
        return "Slips on any pulley that has mass, for want of friction; the values are for one without."
    if case.regime == "verge":
        massless = answers.with_pulley(Fraction(0))
        return (
            "On the verge of slipping: as M is not given, this is for the critical pulley mass,"
            f" {_say(answers, 'critical_pulley_mass')} kg. On a heavier pulley the string slips; on one"
            f" without mass the acceleration is {_say(massless, 'acceleration')} m/s²."
        )
    if case.slide_measured and scene.mu is None:
        return f"Slides over the locked pulley, with mu_k = {_say(answers, 'mu_k')}."
    if case.regime == "slip" and scene.mu is not None:
        mu_k = _say(answers, "mu_k") if case.slide_measured else scene.mu_k and as_typed(scene.mu_k)
        kinetic = "" if mu_k is None else f", and slides with mu_k = {mu_k}"
        if not case.pulley_known:
            verge = _apart(answers, "massless_verge", scene.mu, above=True, up=True)
            return (
                f"Slips on any pulley, for the friction of its axle: mu = {as_typed(scene.mu)} is below the"
                f" {verge} that would hold it on one without mass{kinetic}."
            )
        verge = _apart(answers, "mu_verge", scene.mu, above=True, up=True)
        where = " over a pulley that its axle holds" * (case.rim_stands and not case.locked)
        return f"Slips{where}: mu = {as_typed(scene.mu)} is below the {verge} that would hold it{kinetic}."
    if case.tensions_equal:
        return "Holds: a pulley without mass needs no friction to turn, so both tensions are equal."
    if not case.light:
        return "Holds: the string's end is fixed to the pulley."
    if scene.mu is None:
        return (
            f"Assumed to hold, without mu: it does if mu is at least {_bound(answers, 'mu_verge', up=True)}."
        )
    if case.pulley_known:
        verge = _apart(answers, "mu_verge", scene.mu, above=False, up=True)
        at_rest = " from rest" * (_sliding(answers) is not None)
        return f"Holds{at_rest}: mu = {as_typed(scene.mu)}, and {verge} is enough."
    least = _apart(answers, "least_heavier_mass", case.heavy, above=True, up=False)
    return f"Holds on any pulley: the heavier mass, {heavy} kg, would have to exceed {least} kg to slip."


HELD_DIGITS = 3
"""Significant digits of what an axle holds, where those tell it from the difference of the masses."""


def _held(case: Case) -> str:
    """The difference that the axle just holds, rounded down, but not below what it does hold."""
    b, difference, digits = case.axle_mass or Fraction(0), case.heavy - case.light, HELD_DIGITS
    times, unit = (1000, "g") if b < 1 else (1, "kg")
    while (held := to_side(digits, up=False)(times * b)) < times * difference and digits < MAX_DIGITS:
        digits *= 2
    return f"{text(held)} {unit}"


def _string_at_rest(answers: Answers) -> str:
    """The sentence on the string of masses that an axle holds; empty if its end is fixed."""
    mu = answers.case.scene.mu
    if not answers.case.light:
        return ""
    if mu is None:
        least = _bound(answers, "mu_verge", up=True)
        return f" The string is assumed to hold, without mu: it does if mu is at least {least}."
    verge = _apart(answers, "mu_verge", mu, above=False, up=True)
    return f" The string holds: mu = {as_typed(mu)}, and {verge} is enough."


def remarks(answers: Answers) -> list[str]:
    """What else there is to say of the scene."""
    return [*odd_inertia(answers), *kinetic(answers), *holding_again(answers), *open_range(answers)]


def odd_inertia(answers: Answers) -> list[str]:
    """A doubt about an inertia factor that few pulleys have."""
    beta = answers.case.beta
    if beta is None or beta <= 1:
        return []
    shown = f"{to_double(beta):.6g}"
    if shown == "1":
        shown = text(to_side(None, up=True)(beta))
    return [
        f"The inertia factor I/(M R^2) is {shown}, above 1: the mass lies outside"
        " the rim the string runs on. If that is not so, check inertia, I and R."
    ]


def holding_again(answers: Answers) -> list[str]:
    """That a string which slips under the critical mass holds under much heavier ones, if it does."""
    if answers.case.scene.mu is None or not answers.case.holds_again:
        return []
    return [
        f"Under more than {_say(answers, 'holding_heavier_mass')} kg it holds again: the more the heavier"
        " mass weighs, the less the friction of the axle counts beside it."
    ]


def open_range(answers: Answers) -> list[str]:
    """Between what the motion lies where it depends on the pulley's mass and that is not given."""
    case = answers.case
    if case.scene.mu is None or case.regime != "no-slip" or answers["acceleration"] is not None:
        return []
    ends = [answers.with_pulley(mass) for mass in (Fraction(0), inf)]
    ranges = (
        f"{name} from {_say(ends[0], name)} to {_say(ends[1], name)}"
        for name in ("acceleration", "tension_1", "tension_2", "mu_verge")
    )
    return [f"From a massless to a locked pulley: {', '.join(ranges)}."]


def kinetic(answers: Answers) -> list[str]:
    """What mu_k does though the string does not slip: whether one that slides already goes on sliding."""
    case, mu_k = answers.case, answers.case.scene.mu_k
    if mu_k is None or case.regime == "slip" or case.tensions_equal:
        return []
    if not case.pulley_known:
        return ["mu_k has no part in this, which starts from rest; what a sliding string does depends on M."]
    sliding = _sliding(answers)
    if sliding is None:
        return [
            f"mu_k = {as_typed(mu_k)} is enough, too: a string that slides already is caught by the pulley."
        ]
    verge = _apart(answers, "mu_verge", mu_k, above=True, up=False)
    return [
        f"A string that slides already goes on sliding, as mu_k = {as_typed(mu_k)} is below {verge}:"
        f" the masses then have the acceleration {_say(sliding, 'acceleration')} m/s²."
    ]


def _sliding(answers: Answers) -> Answers | None:
    """The answers to a scene that holds from rest, were the string sliding; None where it would not go on."""
    scene = answers.case.scene
    if scene.mu_k is None or not answers.case.pulley_known:
        return None
    sliding = Answers(scene._replace(mu=scene.mu_k), answers.digits)
    return sliding if sliding.case.regime == "slip" else None


def conditions(answers: Answers) -> list[str]:
    """Both conditions of (36), necessary for the verge: threshold, and whether it is met."""
    if answers.case.scene.mu is None or answers["least_heavier_mass"] is None:
        return []
    case, mass = answers.case, answers.case.scene.M
    met = {True: "met", False: "not met"}
    least = _apart(answers, "least_heavier_mass", case.heavy, above=not case.can_slip, up=False)
    parts = [f"the heavier mass, {as_typed(case.heavy)} kg, must exceed {least} kg ({met[case.can_slip]})"]
    if answers["least_pulley_mass"] is None:
        pass  # the pulley's shape is not known
    elif mass is None:
        least, answer = _bound(answers, "least_pulley_mass", up=False), "open without M"
        if case.can_slip:
            answer = "met by the critical one"
        parts.append(f"the pulley's mass must exceed {least} kg ({answer})")
    elif isinstance(mass, Fraction):
        heavy = case.can_be_made_slip
        least = _apart(answers, "least_pulley_mass", mass, above=not heavy, up=False)
        parts.append(f"the pulley's mass, {as_typed(mass)} kg, must exceed {least} kg ({met[heavy]})")
    else:
        least = _bound(answers, "least_pulley_mass", up=False)
        parts.append(f"the pulley's mass, infinite, must exceed {least} kg (met)")
    return [f"Conditions (36) for the verge: {'; '.join(parts)}."]


def _apart(answers: Answers, name: str, other: Fraction, above: bool, up: bool) -> str:
    """A threshold, rounded up or down, with digits enough to show on which side of another number it is."""
    finer, least = answers, answers.digits or DOUBLE_DIGITS
    digits = least
    while not is_infinite(value := finer[name]):
        near, shown = Decimal(text(value)), Decimal(text(finer.bound(name, up)))
        if shown.adjusted() > MAX_MAGNITUDE:
            return text(shown)  # beyond any input; a fraction of it might have millions of digits
        for kept in range(least, digits + 1):
            pair = to_digits(kept)(near), to_digits(kept, ROUND_CEILING if up else ROUND_FLOOR)(shown)
            if all(Fraction(one) != other and (Fraction(one) > other) == above for one in pair):
                return text(pair[1])
        if digits == MAX_DIGITS:  # the same number, or as good as
            break
        digits = min(2 * digits, MAX_DIGITS)
        finer = answers.to(digits)
    return _bound(answers, name, up)


def _bound(answers: Answers, name: str, up: bool) -> str:
    """A threshold, rounded to the side on which the sentence is true of the number shown."""
    return _say(answers, name) if is_infinite(answers[name]) else text(answers.bound(name, up))


def _say(answers: Answers, name: str) -> str:
    """A value as the output shows it, for a sentence."""
    value = answers[name]
    if is_infinite(value):
        return "over 1.8e308" if answers.digits is None else f"over 10^{LARGEST_EXPONENT}"
    return text(value)
