"""Derive what a scene determines, step by step.

`derivation.md` has the sentences, with the equations below them. Here its conditions are decided, and each
paragraph that applies is filled in. `typeset` puts it on a page.

A paragraph of `derivation.md` is sentences, each in a line, and indented equations. Words in brackets are
conditions, which must all hold; before a title they are those of the step. One that `_holds` and
`_conditions` do not have is an attribute of `Decisions`. A paragraph with equations goes if none is left.
Whatever an equation rests on stands above it; (1) is in every derivation. An equation is one of
- `(27) mu_verge`: a value of the model, with its formula and numbers, if it exists and was not shown;
- `half_sine from φ`: a value without its formula, and the symbols that it rests on;
- `(4) c = rim_mass(m1 m2 a g b)`: an input that follows by a function of `physics`, with numbers put in;
- `(33') gripping_ratio_minus_1(m1 m2 c b D) = k - 1`: the formula for a symbol, without numbers;
- `(1) T1 - m1 g = m1 a`, or `α = 0 from b`: letters as they are, and the symbols that they rest on.
"""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from importlib.resources import files
from itertools import combinations
from operator import mul, truediv
from typing import Any, NamedTuple

from ..solver import physics
from ..solver.answers import Answers
from ..solver.quantities import REGIMES
from ..solver.scene import FALL
from .equations import EXTRA_DIGITS, MOTION, Derivation, Equation
from .messages import measured_quantities, remarks, verdict


class Paragraph(NamedTuple):
    """Sentences of a step, and the equations that they introduce. In sentences, backticks mark symbols."""

    title: str
    sentences: list[str]
    equations: list[Equation]


class Explanation(NamedTuple):
    """The answer, how to read what follows, and the paragraphs that lead to the answer, by step."""

    answer: list[str]
    reading: str
    paragraphs: list[Paragraph]


def explain(answers: Answers, only: Sequence[str] = ()) -> Explanation:
    """Derive what a scene determines, or ``only`` the quantities of these names and what they need.

    Digits are those of ``answers``, or as many as tables show.
    """
    answers, derivation = answers.to_six_digits, Derivation(answers.to_six_digits)
    digits, paragraphs = derivation.digits, [*_paragraphs(derivation)]
    names = dict.fromkeys(only or [*measured_quantities(answers), *MOTION])
    known = [name for name in names if name != "regime" and derivation.exists(name)]
    if only:
        wanted = [*known]
        if "regime" in only:  # which these decide
            known_pulley, unknown_pulley = ["mu_verge"], ["least_heavier_mass", "mu_verge_massless"]
            wanted += known_pulley if derivation.decided.pulley_known else unknown_pulley
        paragraphs = _needed(paragraphs, {*map(derivation.symbol, wanted)})
    answer = [verdict(answers)]
    if known:
        answer.append(f"{', '.join(map(derivation.say, known))}.")
    if not only:
        answer += remarks(answers)
    reading = (
        f"Numbers after = are exact. Results after ≈ have {digits} significant digits; numbers that are put"
        f" into formulas have {digits + EXTRA_DIGITS}. Equation numbers are those of de Oliveira and Lemos,"
        " Force and torque of a string on a pulley, arXiv:1706.10139."
    )
    return Explanation(answer, reading, paragraphs)


CITATION = re.compile(r"\(\d+'?\)")
SYMBOL = re.compile(r"[^\W\d]\w*\*?")
LINE = re.compile(r"^(#* *)(?:\[(.*?)\] )?(.+)$", re.MULTILINE)
EQUATION = re.compile(r"((?:\(\d+'?\),? )*)(.*?)(?: = (.*?))?(?: from (.*))?")
LAW = re.compile(r"([a-z_][a-z_0-9]{2,})\((.*)\)")


def _needed(paragraphs: Sequence[Paragraph], wanted: set[str]) -> list[Paragraph]:
    """Keep (1), the equations that give the symbols wanted, and what these rest on, which stands above them.

    An equation rests on its symbols, and on the symbols and equations that its label and the sentences before
    it mention. A number refers to the first paragraph that has it. Sentences alone lead to what is below.
    """
    first = {
        equation.label: paragraph for paragraph in reversed(paragraphs) for equation in paragraph.equations
    }
    kept = list[Paragraph]()

    def is_wanted(equation: Equation, place: Paragraph) -> bool:
        return equation.left in wanted or (equation.label in wanted and first[equation.label] is place)

    for paragraph in reversed(paragraphs):
        leads = not paragraph.equations and kept and kept[0].title == paragraph.title
        if not leads and not any(is_wanted(equation, paragraph) for equation in paragraph.equations):
            continue
        words, chosen = " ".join(paragraph.sentences), list[Equation]()
        wanted |= {"(1)", *CITATION.findall(words), *SYMBOL.findall(" ".join(words.split("`")[1::2]))}
        for equation in reversed(paragraph.equations):
            if is_wanted(equation, paragraph):
                chosen.insert(0, equation)
                wanted = wanted - {equation.left} | equation.needs.union(CITATION.findall(equation.label))
        kept.insert(0, paragraph._replace(equations=chosen))
    return kept


def _paragraphs(derivation: Derivation) -> Iterator[Paragraph]:
    text = files(__package__).joinpath("derivation.md").read_text("utf-8")
    conditions, title = _conditions(derivation), ""
    for block in text.format_map(_fields(derivation)).split("\n\n"):
        if not title and not block.startswith("#"):
            continue  # as the conditions of its step do not hold
        lines = [
            (start, content)
            for start, words, content in LINE.findall(block)
            if all(_holds(derivation, condition, conditions) for condition in words.split(", ") if condition)
        ]
        if block.startswith("#"):
            title = lines[0][1] if lines else ""
            continue
        sentences = [content for start, content in lines if not start]
        equations = [
            equation for start, content in lines if start for equation in _equation(derivation, content)
        ]
        if equations or (sentences and "\n    " not in block):
            yield Paragraph(title, sentences, equations)


def _equation(derivation: Derivation, line: str) -> Iterator[Equation]:
    """Yield the equation that a line of `derivation.md` stands for, if there is one to show."""
    parts = EQUATION.fullmatch(line)
    assert parts
    label, left, right, symbols = (part or "" for part in parts.groups())
    label, follows = label.rstrip(), tuple(symbols.split(", ")) if symbols else ()
    if not right:
        yield from derivation.values(label, left, follows)
    elif law := LAW.fullmatch(right):
        yield derivation.by(label, left, FUNCTIONS[law[1]], law[2])
    elif law := LAW.fullmatch(left):
        yield Equation(label, derivation.formula(right), derivation.record(FUNCTIONS[law[1]], law[2]))
    else:
        yield Equation(label, left, right, follows)


FUNCTIONS: Mapping[str, Callable[..., Any]] = {**vars(physics), "product": mul, "quotient": truediv}
"""Functions that equations of `derivation.md` name."""


def _fields(derivation: Derivation) -> dict[str, str]:
    """Return what stands between braces in `derivation.md`."""
    slides_by_mu_k = derivation.decided.slides_by_mu_k
    return derivation.words | {
        "kinetic": "kinetic " if slides_by_mu_k else "",
        "limiting_": "limiting_" if slides_by_mu_k else "",
        "limiting_symbol": derivation.symbol("limiting_k_minus_1"),
        "verdict": verdict(derivation.answers),
    }


def _holds(derivation: Derivation, condition: str, conditions: Mapping[str, bool]) -> bool:
    """Decide a condition: on an input, a regime, one of ``conditions``, or an attribute of `Decisions`."""
    decided = derivation.decided
    match condition.split():
        case ["not", *others]:
            return not _holds(derivation, " ".join(others), conditions)
        case [name, "is", "given"]:
            given = {**derivation.inputs, **decided.scene._asdict(), **decided.motion._asdict()}
            return given.get(name) is not None
        case ["finds", name]:
            return decided.motion.finds == name
        case [name, "exists"]:
            return derivation.answers[name] is not None
        case [regime] if regime in REGIMES:
            return ("no-slip" if decided.is_driven else decided.regime) == regime
    return conditions[condition] if condition in conditions else bool(getattr(decided, condition))


def _conditions(derivation: Derivation) -> dict[str, bool]:
    """Decide the conditions of `derivation.md` that are made of several decisions."""
    decided, scene, answers = derivation.decided, derivation.scene, derivation.answers
    motion = decided.motion
    by = motion.fall if motion.finds and motion.a is None else ()
    at_rest = decided.heavier_side == 0 or decided.pulley_at_rest
    grips, moves = not decided.at_limit, answers["acceleration"] is not None
    critical_pulley, heavier, lighter = (
        answers[f"critical_{name}_mass"] is not None for name in ("pulley", "heavier", "lighter")
    )
    by_heavier = heavier and not decided.slips_at_rest
    by_lighter = lighter and not (decided.pulley_is_ideal or decided.pulley_at_rest_until_it_slips)
    return {
        "equal masses": decided.heavier_side == 0 and not decided.is_driven,
        "m1 is heavier": decided.heavier_side < 0,
        "half a turn": scene.wrap.is_half_turn,
        **{f"a by {x} and {y}": by == (x, y) for x, y in combinations(FALL, 2)},
        "falls": bool(motion.fall),
        "ratio is known": decided.pulley_known and not decided.tensions_equal,
        "mu is positive": bool(scene.mu),
        "held by the axle": decided.axle_holds and not decided.locked,
        "turning": decided.is_driven or not (decided.pulley_at_rest or decided.tensions_equal),
        "speeds up downwards": decided.is_driven and motion.way > 0,
        "speeds up upwards": decided.is_driven and motion.way < 0,
        "would slip": decided.is_driven and decided.regime == "slip",
        "masses at rest": grips and at_rest and not decided.motion.finds,
        "a is computed": moves and grips and not at_rest and not decided.motion.finds,
        "a from friction": not grips and not decided.slide_measured,
        "rim at rest": not grips
        and decided.regime == "slip"
        and (decided.rim_at_rest or decided.frictionless),
        "verge by the ratio": critical_pulley or by_heavier or by_lighter,
    }
