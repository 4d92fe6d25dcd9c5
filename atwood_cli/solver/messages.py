"""Why a scene does what it does, and why answers are missing or doubtful, in sentences.

Backticks mark names, as in the messages of `Undetermined`: `unmarked` takes them out, and LaTeX output
(`output.typeset`) replaces the names by symbols.
"""

from collections.abc import Mapping, Sequence
from fractions import Fraction
from math import inf

from ..model.case import Case
from ..model.digits import SHOWN_DIGITS, as_typed, is_infinite, text, tidy, to_side_of, to_threshold
from ..model.scene import Scene
from ..model.units import MAX_MAGNITUDE
from .answers import Answers


def unmarked(words: str) -> str:
    """Return a sentence without backticks."""
    return words.replace("`", "")


def notes(answers: Answers, names: Sequence[str]) -> list[str]:
    """Return sentences on the regime and why, and on the quantities named, as `reasons`."""
    said = [verdict(answers), *remarks(answers.shown)]
    return [*map(unmarked, said), *reasons(answers, names)]


def reasons(answers: Answers, names: Sequence[str]) -> list[str]:
    """Return sentences on why quantities or their uncertainties are missing or doubtful."""
    found = {name: answers.answer(name) for name in names if name != "regime"}
    said = reasons_at({(name, one.reason): 1 for name, one in found.items() if one.reason}, 1)
    uncertainties = answers.uncertainties
    if uncertainties is None:
        return said
    beyond = {name: one.uncertainty_reason for name, one in found.items() if one.uncertainty_reason}
    without = [name for name, one in found.items() if one.uncertainty is None and one.value is not None]
    return [
        *said,
        *uncertainties.doubts(),
        *uncertainties.lopsided([name for name, one in found.items() if one.uncertainty]),
        *map(unmarked, uncertainties.open_ended(without)),
        *reasons_at({(f"u_{name}", reason): 1 for name, reason in beyond.items()}, 1),
    ]


def reasons_at(
    counted: Mapping[tuple[str, str], int], points: int, where: str = "at {} of {} points"
) -> list[str]:
    """Return a sentence for each reason that values are missing, without backticks.

    ``counted`` says at how many of the ``points`` a quantity is missing for a reason.
    """
    names: dict[tuple[str, int], list[str]] = {}
    for (name, reason), times in counted.items():
        names.setdefault((reason, times), []).append(name)
    said = []
    for (reason, times), group in names.items():
        place = "" if times == points else f" ({where.format(times, points)})"
        said.append(f"{', '.join(group)}: {unmarked(reason)}{place}.")
    return said


def verdict(answers: Answers) -> str:
    """Say what the string does, and why."""
    answers = answers.shown
    case, scene = answers.case, answers.case.scene
    if case.sign == 0:
        return "At rest: the masses are equal, so no friction is needed."
    if case.regime == "verge":
        return _on_the_verge(answers)
    if case.regime == "slip":
        return _slips(answers)
    if case.axle_holds:
        return f"At rest: the axle holds up to {_held(case)} of difference.{_beside_the_axle(answers)}"
    if case.tensions_equal:
        return "Holds: a pulley without mass needs no friction to turn, so both tensions are equal."
    if not case.light:
        return "Holds: the string's end is fixed to the pulley."
    if scene.mu is None:
        where = " on a pulley without mass" if scene.M is None and scene.I is None else ""
        return f"Assumed to hold, without `mu`: it does{where} if `mu` is at least {_enough(answers)}."
    if case.pulley_known:
        holds = "Holds from rest" if _sliding(answers) else "Holds"
        return f"{holds}: {_given_mu(scene)}, and {_enough(answers)} is enough."
    least = answers.rounded("least_heavier_mass", to_threshold(up=False, given=case.heavy))
    if is_infinite(least) or least.adjusted() > MAX_MAGNITUDE:
        return "Holds on any pulley, under any mass that can be given in place of the heavier one."
    heavy, least_heavy = as_typed(case.heavy), text(least)
    return (
        f"Holds on any pulley: the heavier mass, {heavy} kg, would have to exceed {least_heavy} kg to slip."
    )


def _given_mu(scene: Scene) -> str:
    return "" if scene.mu is None else f"`mu` = {as_typed(scene.mu)}"


def _enough(answers: Answers, name: str = "mu_verge") -> str:
    """Say the least coefficient that holds the string."""
    return _threshold(answers, name, up=True, given=answers.case.scene.mu)


def _beside_the_axle(answers: Answers) -> str:
    """Say what the string does while the axle holds the pulley, "" if it is fixed to the pulley."""
    if not answers.case.light:
        return ""
    if mu := _given_mu(answers.case.scene):
        return f" The string holds: {mu}, and {_enough(answers)} is enough."
    return f" The string is assumed to hold, without `mu`: it does if `mu` is at least {_enough(answers)}."


def _on_the_verge(answers: Answers) -> str:
    if not answers.case.scene.mu:
        return "Slips on any pulley that has mass, for want of friction; the values are for one without."
    massless = answers.with_pulley(Fraction(0))
    return (
        "On the verge of slipping: as `M` is not given, this is for the critical pulley mass,"
        f" {_say(answers, 'critical_pulley_mass')} kg. On a heavier pulley the string slips; on one"
        f" without mass the acceleration is {_say(massless, 'acceleration')} m/s²."
    )


def _slips(answers: Answers) -> str:
    case, scene = answers.case, answers.case.scene
    mu = _given_mu(scene)
    if not mu:
        return "Slides over the locked pulley."
    kinetic = "" if scene.mu_k is None else f", and slides with `mu_k` = {as_typed(scene.mu_k)}"
    if not case.pulley_known:
        return (
            f"Slips on any pulley, for the friction of its axle: {mu} is below the"
            f" {_enough(answers, 'massless_verge')} that would hold it on one without mass{kinetic}."
        )
    slips = "Slips over a pulley that its axle holds" if case.rim_stands and not case.locked else "Slips"
    return f"{slips}: {mu} is below the {_enough(answers)} that would hold it{kinetic}."


def _held(case: Case) -> str:
    """Say the difference that the axle just holds, rounded down, but not below the one that it holds."""
    b, difference = case.axle_mass, case.heavy - case.light
    times, unit = (1000, "g") if b < 1 else (1, "kg")
    return f"{text(to_threshold(up=False, given=times * difference)(times * b))} {unit}"


def remarks(answers: Answers) -> list[str]:
    """Return further sentences on the scene, as far as they apply."""
    return [*odd_inertia(answers), *kinetic(answers), *holding_again(answers), *open_range(answers)]


def odd_inertia(answers: Answers) -> list[str]:
    """Ask whether an inertia factor above 1 is meant, as few pulleys have one."""
    beta = answers.case.beta
    if beta is None or beta <= 1:
        return []
    shown = tidy(to_side_of(Fraction(1), SHOWN_DIGITS)(beta))
    return [
        f"The inertia factor `I/(M R^2)` is {text(shown)}, above 1: the mass lies outside"
        " the rim the string runs on. If that is not so, check `inertia`, `I` and `R`."
    ]


def holding_again(answers: Answers) -> list[str]:
    """Say that a string which slips above the critical mass holds again under much greater ones."""
    if answers.case.scene.mu is None or not answers.case.holds_again:
        return []
    return [
        "Under a much heavier mass it holds again: the more the heavier"
        " mass weighs, the less the friction of the axle counts beside it."
    ]


def open_range(answers: Answers) -> list[str]:
    """Say the range of the motion, if it depends on a pulley mass that is not given."""
    case = answers.case
    if case.scene.mu is None or answers["acceleration"] is not None:
        return []
    ends = [answers.with_pulley(mass) for mass in (Fraction(0), inf)]
    ranges = (
        f"`{name}` from {_say(ends[0], name)} to {_say(ends[1], name)}"
        for name in ("acceleration", "tension_1", "tension_2", "mu_verge")
    )
    return [f"From a massless to a locked pulley: {', '.join(ranges)}."]


def kinetic(answers: Answers) -> list[str]:
    """Say whether a string that slides already goes on sliding, though it does not slip from rest."""
    case, mu_k = answers.case, answers.case.scene.mu_k
    if mu_k is None or case.regime == "slip" or case.tensions_equal:
        return []
    if not case.pulley_known:
        return [
            "`mu_k` has no part in this, which starts from rest; what a sliding string does depends on `M`."
        ]
    sliding = _sliding(answers)
    if sliding is None:
        return [
            f"`mu_k` = {as_typed(mu_k)} is enough, too: a string that slides already is caught by the pulley."
        ]
    verge = _threshold(answers, "mu_verge", up=False, given=mu_k)
    return [
        f"A string that slides already goes on sliding, as `mu_k` = {as_typed(mu_k)} is below {verge}:"
        f" the masses then have the acceleration {_say(sliding, 'acceleration')} m/s²."
    ]


def _sliding(answers: Answers) -> Answers | None:
    """Return the answers if the string slid already, though it holds from rest; None if it would stop."""
    scene = answers.case.scene
    if scene.mu_k is None or not answers.case.pulley_known:
        return None
    sliding = Answers(scene._replace(mu=scene.mu_k), answers.digits)
    return sliding if sliding.case.regime == "slip" else None


def _threshold(answers: Answers, name: str, up: bool, given: Fraction | None = None) -> str:
    """Say a threshold, rounded to the side on which the sentence is true, so that it can be typed back."""
    return text(answers.rounded(name, to_threshold(up, given)))


def _say(answers: Answers, name: str) -> str:
    """Say a value as the table shows it."""
    return text(answers[name])
