"""Derive what a scene determines, step by step in the paper's order.

`derivation.md` has the sentences, with the equations below them. Here its conditions are decided, and each
paragraph that applies is filled in. `typeset` puts it on a page.

A paragraph of `derivation.md` is sentences, each in a line, and indented equations. Words in brackets are
conditions, which must all hold. A paragraph with equations goes if none is left. An equation is one of
- `tension_ratio`: a value of the model, with its formula and numbers, if it exists and was not shown;
- `half_sine from φ`: a value without its formula, and the symbols that it rests on;
- `(4) c = rim_mass(l h a g b)`: an input that follows by a function of `physics`, with numbers put in;
- `(34) pulley_mass_in_the_paper(l h k) = M*`: the formula for a symbol, without numbers;
- `(1) T1 - m1 g = m1 a`, or `α = 0 from b`: letters as they are, and the symbols that they rest on.
"""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from fractions import Fraction
from importlib.resources import files
from operator import mul, truediv
from typing import Any, NamedTuple

from ..model import physics
from .answers import Answers
from .equations import GUARD_DIGITS, MOTION, Derivation, Equation, Part
from .messages import remarks, verdict


class Step(NamedTuple):
    """A title, and sentences and equations in turn."""

    title: str
    body: list[Part]


class Paragraph(NamedTuple):
    """Sentences of a step, and the equations that they introduce."""

    title: str
    sentences: list[str]
    equations: list[Equation]


class Explanation(NamedTuple):
    """The answer, how to read what follows, and the steps to the answer."""

    answer: list[str]
    reading: str
    steps: list[Step]


def explain(answers: Answers, only: Sequence[str] = ()) -> Explanation:
    """Derive what a scene determines, or ``only`` the quantities of these names and what they need.

    Digits are those of ``answers``, or as many as tables show.
    """
    derivation = Derivation(answers.shown)
    answers, digits, paragraphs = answers.shown, derivation.digits, [*_paragraphs(derivation)]
    names = [name for name in only if name != "regime"]
    if only:
        wanted = [name for name in names if derivation.exists(name)]
        if "regime" in only:
            wanted += (
                ["mu_verge"] if derivation.case.pulley_known else ["least_heavier_mass", "massless_verge"]
            )
        paragraphs = _needed(paragraphs, {*map(derivation.symbol, wanted)})
    else:
        names = [*answers.found, *(name for name in MOTION if name not in answers.found)]
    answer = [verdict(answers)]
    if values := [derivation.say(name) for name in names if derivation.exists(name)]:
        answer.append(f"{', '.join(values)}.")
    if not only:
        answer += remarks(answers)
    reading = (
        f"The sign = is exact; ≈ means rounded to {digits} significant digits, or {digits + GUARD_DIGITS}"
        " for numbers put in. Equation numbers are those of de Oliveira and Lemos, Force and torque of a"
        " string on a pulley, arXiv:1706.10139."
    )
    steps: dict[str, list[Part]] = {}
    for title, sentences, equations in paragraphs:
        steps.setdefault(title, []).extend([*sentences, *equations])
    return Explanation(answer, reading, [Step(title, body) for title, body in steps.items()])


CITATION = re.compile(r"\(\d+\)")
LINE = re.compile(r"^( *)(?:\[(.*?)\] )?(.+)$", re.MULTILINE)
LAW = re.compile(r"([a-z_][a-z_0-9]{2,})\((.*)\)")


def _needed(paragraphs: Sequence[Paragraph], wanted: set[str]) -> list[Paragraph]:
    """Keep the equations that give the symbols wanted, and all that these rest on.

    An equation rests on its symbols, and on the equations whose numbers its label or the sentences before
    it cite: a number refers to the first paragraph that has it. A law gives a symbol if no value does.
    """
    first: dict[str, int] = {}
    for i, paragraph in enumerate(paragraphs):
        for equation in paragraph.equations:
            first.setdefault(equation.label, i)
    valued = {equation.left for _, _, equations in paragraphs for equation in equations if equation.result}
    kept, before = dict[tuple[int, int], Equation](), -1
    while len(kept) > before:
        before = len(kept)
        for i, (_, sentences, equations) in enumerate(paragraphs):
            for j, equation in enumerate(equations):
                gives = equation.left in wanted and (equation.result or equation.left not in valued)
                if gives or (first[equation.label] == i and equation.label in wanted):
                    kept[i, j] = equation
                    wanted |= equation.needs.union(CITATION.findall(" ".join([equation.label, *sentences])))
    chosen = (
        Paragraph(title, sentences, [kept[i, j] for j in range(len(equations)) if (i, j) in kept])
        for i, (title, sentences, equations) in enumerate(paragraphs)
    )
    return [paragraph for paragraph in chosen if paragraph.equations]


def _paragraphs(derivation: Derivation) -> Iterator[Paragraph]:
    """Yield the paragraphs that apply to a scene, in its order of steps."""
    steps: dict[str, list[str]] = {}
    for step in files(__package__).joinpath("derivation.md").read_text("utf-8").split("## ")[1:]:
        title, _, body = step.partition("\n")
        steps[title] = body.strip("\n").split("\n\n")
    conditions, fields = _conditions(derivation), _fields(derivation)
    for title in _titles(derivation):
        for block in steps[title]:
            sentences, equations = list[str](), list[Equation]()
            for indent, words, content in LINE.findall(block.format_map(fields)):
                if not all(_holds(condition, conditions) for condition in words.split(", ") if condition):
                    continue
                if indent:
                    equations.extend(_equation(derivation, content))
                else:
                    sentences.append(content)
            if equations or (sentences and "\n    " not in block):
                yield Paragraph(title, sentences, equations)
    for title, simpler in _simpler(derivation):
        if None not in (derivation.answers["acceleration"], simpler["acceleration"]):
            yield Paragraph(title, [*derivation.compared(simpler)], [])


def _equation(derivation: Derivation, line: str) -> Iterator[Equation]:
    """Yield the equation that a line of `derivation.md` stands for, if there is one to show."""
    sides, _, symbols = line.partition(" from ")
    follows = tuple(symbols.split(", ")) if symbols else ()
    label = "".join(CITATION.findall(sides)[:1]) if sides.startswith("(") else ""
    left, _, right = sides.removeprefix(label).strip().partition(" = ")
    if not right:
        yield from derivation.values(left, follows)
    elif law := LAW.fullmatch(right):
        yield derivation.by(left, FUNCTIONS[law[1]], law[2], label)
    elif law := LAW.fullmatch(left):
        yield Equation(label, derivation.letter(right), derivation.record(FUNCTIONS[law[1]], law[2]))
    else:
        yield Equation(label, left, right, follows)


def _holds(condition: str, conditions: Mapping[str, bool]) -> bool:
    """Decide a condition, which may begin with "not"."""
    return conditions[condition.removeprefix("not ")] != condition.startswith("not ")


FUNCTIONS: Mapping[str, Callable[..., Any]] = {**vars(physics), "product": mul, "quotient": truediv}
"""Functions that equations of `derivation.md` name."""


def _titles(derivation: Derivation) -> list[str]:
    """Return the titles of the steps, the grip before a motion that follows from friction at its limit."""
    case = derivation.case
    motion, grip, friction = ["The motion"], ["Does the string hold?"], ["The friction on the pulley"]
    limits = ["The critical masses"] if case.scene.mu is not None else []
    if case.motion.finds:
        motion.insert(0, "What the measured acceleration gives")
    order = [*motion, *grip, *friction, *limits]
    if not case.light:
        order = motion
    elif case.regime == "slip":
        order = [*grip, *motion, *friction, *limits]
    elif case.regime == "verge":
        order = [*grip, *limits, *motion, *friction]
    return ["The masses", "The pulley", *order, "What is modelled"]


def _fields(derivation: Derivation) -> dict[str, str]:
    """Return what stands between braces in `derivation.md`."""
    case, scene = derivation.case, derivation.scene
    is_kinetic = case.regime == "slip" and scene.mu_k is not None and not case.slide_measured
    limiting = "limiting_" if is_kinetic else ""
    pulley = "without mass" if case.tensions_equal and case.sign else "with its moment of inertia"
    axle = "with constant" if case.has_axle_friction else "without"
    more = "" if case.ends_hang_down else ", guide sheaves without mass or friction"
    if scene.mu is not None:
        more += ", Coulomb friction between string and pulley"
    return {
        "l": derivation.light,
        "h": derivation.heavy,
        "a": derivation.symbol("magnitude"),
        "difference": derivation.symbol("difference"),
        "phi": derivation.symbol("phi"),
        "kinetic": "kinetic " if is_kinetic else "",
        "kin": "_kin" if is_kinetic else "",
        "limiting_": limiting,
        "limiting_symbol": derivation.symbol(
            "limiting_k_minus_1" if case.slide_measured else f"{limiting}k_minus_1"
        ),
        "modelled": f"a pulley {pulley}, an axle {axle} friction{more}",
        "verdict": verdict(derivation.answers),
    }


def _conditions(derivation: Derivation) -> dict[str, bool]:
    """Decide the conditions of `derivation.md`."""
    case, scene, motion = derivation.case, derivation.scene, derivation.case.motion
    is_disk = scene.I is None and scene.inertia == Fraction(1, 2)
    given = {
        "equal masses": case.sign == 0,
        "m1 is heavier": case.sign < 0,
        "one mass is 0": not case.light,
        "ends hang down": case.ends_hang_down,
        "half a turn": scene.wrap.is_half_turn,
        "axle friction": case.has_axle_friction,
        "axle torque": case.has_axle_friction and scene.axle is not None and scene.axle.unit == "N m",
        "locked": case.locked,
        "paper's pulley": is_disk and not case.has_axle_friction and not case.pulley_at_rest,
        "pulley is known": case.pulley_known,
        "c is known": case.rim_mass is not None,
        "ratio is known": case.pulley_known and not case.tensions_equal,
        "turns freely": case.pulley_is_ideal,
        "I is given": scene.I is not None,
        "R is given": scene.R is not None,
        "mu is given": scene.mu is not None,
        "mu is positive": bool(scene.mu),
        "time is given": motion.time is not None,
        "drop is given": motion.drop is not None,
        **{f"finds {name}": motion.finds == name for name in ("M", "g", "mu_k")},
        "finds the heavier mass": motion.finds == f"m{derivation.heavy}",
        "finds the lighter mass": motion.finds == f"m{derivation.light}",
    }
    return given | _behaviour(derivation) | _critical_masses(derivation)


def _behaviour(derivation: Derivation) -> dict[str, bool]:
    """Decide the conditions on the regime, the motion and the friction."""
    case, answers = derivation.case, derivation.answers
    grips, slips, moves = case.regime == "no-slip", case.regime == "slip", answers["acceleration"] is not None
    at_rest = case.sign == 0 or case.pulley_at_rest
    rim_at_rest = slips and (case.rim_at_rest or case.frictionless)
    definite = answers["friction_force"] is not None
    return {
        "grips": grips,
        "slips": slips,
        "verge": case.regime == "verge",
        "pulley at rest": case.pulley_at_rest,
        "held by the axle": case.axle_holds and not case.locked,
        "turning": not (at_rest or case.tensions_equal),
        "masses at rest": grips and at_rest,
        "tensions equal": case.tensions_equal,
        "can slip on some pulley": bool(case.scene.mu) and not case.pulley_known and case.can_slip,
        "slips on any pulley": slips and not case.pulley_known,
        "a is known": moves,
        "a is computed": moves and grips and not at_rest and not case.motion.finds,
        "a from friction": not grips and not case.slide_measured,
        "friction acts": not case.frictionless,
        "friction is definite": definite and not case.frictionless,
        "friction is open": not definite and case.pulley_known,
        "rim at rest": rim_at_rest,
        "rim turns": slips and not rim_at_rest,
    }


def _critical_masses(derivation: Derivation) -> dict[str, bool]:
    """Decide which critical masses exist, and at which of them the pulley is at rest."""
    case, answers = derivation.case, derivation.answers
    names = [f"critical_{name}_mass" for name in ("pulley", "heavier", "lighter")]
    pulley, heavier, lighter = (answers[name] is not None for name in names)
    lighter = lighter and not case.pulley_is_ideal
    heavier_at_rest = heavier and derivation.case.slips_at_rest
    lighter_at_rest = lighter and case.pulley_at_rest_until_it_slips
    return {
        "M* exists": pulley,
        "m* exists": heavier,
        "l* exists": lighter,
        "m* at rest": heavier_at_rest,
        "l* at rest": lighter_at_rest,
        "verge by the ratio": pulley or heavier != heavier_at_rest or lighter != lighter_at_rest,
    }


def _simpler(derivation: Derivation) -> Iterator[tuple[str, Answers]]:
    """Yield questions on simpler models, and what these give for the scene."""
    case, scene, digits = derivation.case, derivation.scene, derivation.digits
    if case.has_axle_friction and case.regime == "no-slip" and case.sign and not case.locked:
        yield "What if the axle had no friction?", Answers(scene._replace(axle=None), digits)
    if case.regime == "slip" and case.pulley_known:
        yield "What if slipping is ignored?", Answers(scene._replace(mu=None, mu_k=None), digits)
