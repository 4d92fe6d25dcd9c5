"""The derivation: every equation worked out again from its text, every number known; `cases/explain.md` has pages."""

import re
import zipfile
from collections.abc import Iterable
from contextlib import redirect_stdout
from decimal import Decimal
from fractions import Fraction
from io import StringIO
from pathlib import Path
from typing import Any

import mpmath as mp
import pytest
from hypothesis import given
from hypothesis import strategies as st

from atwood_cli.explain.derivation import Explanation, explain
from atwood_cli.explain.equations import Derivation, Equation
from atwood_cli.explain.given import WEIGHTS, inputs_in_words
from atwood_cli.numbers.digits import is_infinite
from atwood_cli.output.page import Page
from atwood_cli.output.typeset import chain, print_explanation, written
from atwood_cli.reading.scenes import read_answers
from atwood_cli.solver.answers import Answers
from atwood_cli.solver.quantities import NAMES, QUANTITIES
from atwood_cli.solver.scene import INPUTS, Scene

from .conftest import examples, many
from .tools import oracle
from .tools.scenes import FAMILIES, KINDS, inputs, read_scene, scenes, table

NUMBER = r"-?\d+(?:\.\d+)?(?:e-?\d+)?"
SCENES = {kind: inputs(words) for kind, words in table(KINDS)}
kinds = pytest.mark.parametrize("kind", SCENES)


def told_of(kind: str, digits: int | None = None) -> Explanation:
    return explain(read_answers(SCENES[kind], digits))


def printed(given: Iterable[str], found: Explanation, width: int | None = None) -> str:
    """The derivation as text of that width, or as Markdown."""
    with redirect_stdout(StringIO()) as out:
        page = Page(is_plain=True, is_markdown=width is None)
        page.width = width or page.width
        print_explanation(page, given, found)
    return out.getvalue()


def all_equations(found: Explanation) -> list[Equation]:
    return [one for paragraph in found.paragraphs for one in paragraph.equations]


def equations(found: Explanation) -> list[Equation]:
    """Those that end with a number."""
    return [equation for equation in all_equations(found) if equation.result]


def sentences(found: Explanation) -> list[str]:
    return [*found.answer, *(words for paragraph in found.paragraphs for words in paragraph.sentences)]


# Each line gives its result: read as a person reads it, and worked out with another library

FUNCTIONS = {"ln": mp.log, "sqrt": mp.sqrt, "sin": mp.sin, "N": mp.mpf}
OF_RANGES = {"ln": mp.iv.log, "sqrt": mp.iv.sqrt, "sin": mp.iv.sin}


def work_out(words: str, rounded: int = 0, ranges: bool = False, **symbols: Any) -> Any:
    """The value of an expression as printed; or its range, where numbers of so many digits are rounded."""

    def of_range(digits: str) -> Any:
        x, half = Decimal(digits), Decimal(0)
        if len(x.as_tuple().digits) >= rounded:
            half = Decimal((0, (5,), x.adjusted() - rounded))
        return mp.iv.mpf(digits) + mp.iv.mpf([f"-{half}", str(half)])

    words = words.replace("·", "*").replace("√", "sqrt").replace("e^", "E^")
    words = re.sub(r"(?<![\w.])(\d+(?:\.\d+)?(?:e-?\d+)?)", r"N('\1')", words)
    words = re.sub(r"(?<=[\w)]) (?=[\w(])", "*", words).replace("^", "**")
    if ranges:
        return eval(words, {**OF_RANGES, "N": of_range, "E": mp.iv.e})
    return eval(words, {**FUNCTIONS, "E": mp.e, **symbols})


def from_latex(words: str) -> str:
    """LaTeX as plain text, what is in the innermost braces first."""
    words = re.sub(r"(\d) \\times 10\^\{(-?\d+)\}", r"\1e\2", words).replace(r"\cdot", "·")
    for _ in range(words.count("{")):
        words = re.sub(r"\\frac\{([^{}]*)\}\{([^{}]*)\}", r"((\1)/(\2))", words)
        words = re.sub(r"(\^|\\sqrt)\{([^{}]*)\}", r"\1(\2)", words)
    return re.sub(r"\\(ln|sin)", r"\1", words).replace(r"\sqrt", "√")


def check_numbers(equation: Equation, digits: int) -> None:
    """The result is within the range of the numbers put in, those of all digits half a unit off either way."""
    numbers = equation.numbers.values()
    # mpmath needs as many digits as a number is small.
    if not equation.numbers or any(abs(number.adjusted()) >= 3000 for number in numbers):
        return
    mp.mp.dps = mp.iv.dps = 100 + sum(len(str(number)) + max(0, -2 * number.adjusted()) for number in numbers)
    _, put_in, result = chain(equation)
    shown = Decimal(equation.result)
    assert equation.result in result
    assert shown or equation.signs[1] == "="  # what is 0 whatever the numbers is exactly 0
    half = Decimal((0, (5,), shown.adjusted() - digits)) if shown and equation.signs[1] == "≈" else Decimal(0)
    value = work_out(put_in[2:], digits + 2, ranges=True)
    wanted = mp.iv.mpf(str(shown)) + mp.iv.mpf([f"-{half}", str(half)])
    assert wanted.a <= value.b, (put_in, result)
    assert value.a <= wanted.b, (put_in, result)
    latex = chain(equation, latex=True)[1]
    sign, _, words = latex.partition(" ")
    assert sign == {"=": "=", "≈": r"\approx"}[equation.signs[0]]
    assert mp.almosteq(work_out(from_latex(words)), work_out(put_in[2:]), rel_eps=mp.mpf(10) ** -80)


def symbol_of(equation: Equation) -> str:
    return written(equation.left)


VALUES = {about.letters: name for name, about in QUANTITIES.items() if name in NAMES}
VALUES["|a|"] = "acceleration"


def check_results(found: Explanation, scene: Scene, digits: int) -> None:
    """Results, and what sentences say that a symbol is, are the oracle's."""
    expected = oracle.expected(scene)
    stated = [(symbol_of(one), one.result) for one in equations(found)]
    for words in sentences(found):
        stated += re.findall(rf"`([^`]+)` = ({NUMBER})", words)
    for symbol, shown in stated:
        if (value := expected.get(VALUES.get(symbol, ""))) is not None:
            right = oracle.correctly_rounded(value, digits)
            assert Decimal(shown) == (abs(right) if symbol == "|a|" else right), symbol


@kinds
def test_every_line_gives_its_result(kind: str) -> None:
    for digits in (None, 1, 30):
        found = equations(told_of(kind, digits))
        assert found or kind == "nothing but the axle tells the motion"
        for equation in found:
            check_numbers(equation, digits or 6)
    check_handout(handout(SCENES[kind]))


@examples(60)
@given(st.sampled_from(sorted(FAMILIES)), st.integers(0, 10**9), st.sampled_from([None, 2, 17]))
def test_every_line_gives_its_result_in_any_scene(family: str, seed: int, digits: int | None) -> None:
    scene = read_scene(next(scenes(family, 1, seed)))
    answers = Answers(scene, digits)
    found = explain(answers)
    check_lesson(answers, found, (NAMES[seed % len(NAMES)], "tension_1"))
    check_results(found, scene, digits or 6)
    for equation in equations(found):
        check_numbers(equation, digits or 6)
    assert printed([], found, 80)
    check_handout(printed([], found))


# Symbols agree


def exact(q: Fraction) -> Any:
    return mp.mpf(q.numerator) / q.denominator


@kinds
def test_the_symbols_say_what_the_numbers_do(kind: str) -> None:
    """The formula as printed, with what is given and the results so far, gives each result; the laws hold."""
    mp.mp.dps = 60
    decided = read_answers(SCENES[kind], None).decided
    scene, motion, wrap = decided.scene, decided.motion, exact(decided.scene.wrap.number)
    names = {"mu": "μ", "mu_k": "μ_k", "drop": "s", "time": "t", "speed": "v"}
    given = {x: getattr(scene, x) for x in INPUTS} | motion._asdict()
    sizes = {name: abs(q) if name in ("drop", "speed") and q else q for name, q in given.items()}
    known = {names.get(name, name): q for name, q in sizes.items() if q is not None}
    known |= {
        "M": decided.pulley_mass or Fraction(0),
        "c": decided.rim_mass,
        "β": decided.beta,
        "b": decided.axle_mass,
    }
    known |= {"f_axle": decided.axle_friction}
    for x, terms in scene.terms:
        known[WEIGHTS.get(x, terms.symbol)] = scene.as_given(x) * (decided.heavier_side if x == "a" else 1)
    env = {name: exact(q) for name, q in ({"a": Fraction(0)} | known).items() if isinstance(q, Fraction)}
    env |= {
        "π": +mp.pi,
        "φ": wrap if scene.wrap.unit == "rad" else mp.radians(wrap),
        "|a|": abs(env["a"]),
        "a_1": -env["a"],
    }
    if scene.mu == 0 or scene.mu_k == 0:
        k, z = ("k", "z") if scene.mu == 0 else ("k_kin", "z_kin")
        env |= {k: mp.mpf(1), z: mp.mpf(0), "M*": mp.mpf(0)}
    lighter, heavier = ("T2", "T1") if decided.heavier_side < 0 else ("T1", "T2")
    found = told_of(kind, 50)
    for equation in equations(found):
        left = symbol_of(equation)
        if equation.right is not None:
            words = spelled(written(equation.right))
            value = work_out(words, **{spelled(name): x for name, x in env.items()})
            assert mp.almosteq(value, mp.mpf(equation.result), rel_eps=mp.mpf(10) ** -45), left
        env[left.removesuffix(" - 1")] = mp.mpf(equation.result) + left.endswith(" - 1")
        if " - T" in left:
            sign = 1 if left.startswith(heavier) else -1
            env[heavier] = env[lighter] + sign * mp.mpf(equation.result)
        elif left == lighter:  # what is shown of equal tensions
            env.setdefault(heavier, env[lighter])
        if left == "|a|":
            env["a"] = -env["|a|"]
        elif left == "a":
            env["a_1"] = -env["a"]
    check_laws(found, {spelled(name): x for name, x in env.items()})


def spelled(words: str) -> str:
    words = words.replace("μ*", "mustar").replace("|a|", "abs_a")
    return re.sub(r"\b([Mml])\*", r"\1_crit", words)


def check_laws(found: Explanation, env: dict[str, Any]) -> None:
    """The laws hold that are not about friction at its limit, of which there may be less."""
    for equation in all_equations(found):
        words = spelled(f"{symbol_of(equation)} = {chain(equation)[0][2:]}")
        # Of what stands in letters, (1), what friction makes of (26) and what is 0 is of this scene alone.
        if isinstance(equation.right, str) and not re.search("g - T|- m. g|T. k|= 0|^T. = T.$", words):
            continue
        if equation.result or words.startswith("k - 1") or re.search("a_rim|α", words) or "T1" not in env:
            continue
        left, right = (work_out(side, **env) for side in words.split(" = "))
        close = mp.mpf(10) ** -28
        assert mp.almosteq(left, right, rel_eps=close, abs_eps=close), words


# One lesson


def check_lesson(answers: Answers, full: Explanation, names: tuple[str, ...]) -> None:
    """Each quantity that exists is derived; what a step uses or mentions is, too: it had z, and not what z is."""
    lesson = explain(answers, names)
    known = {*Derivation(answers).inputs} - derived(full)
    known |= {"π", "φ"} | {side for one in all_equations(full) for side in [symbol_of(one)] if not one.needs}
    known |= {"c"} if answers.decided.locked else set()  # (33) is solved for it
    known |= {"a"} if answers.decided.motion.a is not None else set()  # of `m1`, it is -a
    for equation in all_equations(lesson):
        assert equation.needs - derived(lesson) <= known, (answers.decided.scene, names, equation)
    introduced = {*"m1 m2 T1 T2 a a_1 α I M c f_axle F_drive".split()}  # before (1) to (3)
    left_out = derived(full) - derived(lesson) - known - introduced
    for _, words, formulas in lesson.paragraphs:
        marked = [*" ".join(words).split("`")[1::2], *(chain(one)[0] for one in formulas)]
        mentioned = re.findall(r"\(\d+\)", " ".join(words)) + re.findall(r"[^\W\d]\w*\*?", " ".join(marked))
        assert not left_out.intersection(mentioned), (answers.decided.scene, names, words)
    for name in names:
        value = answers.to_six_digits[name]
        if name != "regime" and value is not None and not is_infinite(value):
            symbol = Derivation(answers).symbol({"acceleration": "magnitude"}.get(name, name))
            assert symbol in derived(lesson) | known, (answers.decided.scene, name)


def derived(found: Explanation) -> set[str]:
    return {name for one in all_equations(found) for name in (one.label, symbol_of(one))}


@kinds
def test_a_lesson_derives_what_is_asked_for_and_what_that_needs(kind: str) -> None:
    answers = read_answers(SCENES[kind], None)
    full = explain(answers)
    step = 100 // many(100)  # of every kind other names
    for name in answers.names[len(kind) % step :: step]:
        check_lesson(answers, full, (name,))
    check_lesson(answers, full, ("acceleration", "tension_1"))


# No line is too wide


@kinds
def test_lines_keep_to_the_width_and_numbers_stay_whole(kind: str) -> None:
    found = told_of(kind, 20)
    for width in (40, 80):
        lines = printed(["m1 = 1 kg"], found, width).splitlines()
        # A number is not parted from its unit, and twenty digits may then be too wide.
        assert all(len(line) <= width or re.fullmatch(r" *(\S*\d )?\S+", line) for line in lines)
        words = " ".join(lines).split()
        for equation in equations(found):
            for number in (equation.result, *equation.numbers.values()):
                assert any(str(number).lower().replace("e+", "e") in word for word in words)
        assert not re.search("[\xa0`]", "".join(lines))
        assert not any(re.search(r"^=|\w =$", line) for line in lines)
        # After a rename, `gripping_ratio_minus_1(l h c b D)` stood where (33) stands.
        assert not re.search(r"[a-z]_[a-z_0-9]+\(", "".join(lines))


# A handout


MATHEMATICS = """
frac sqrt ln sin cdot times approx begin end mathrm qquad ast infty min max mu pi varphi theta alpha beta tau omega circ
"""
IN_MATHEMATICS = re.compile(r"\$\$.*?\$\$|\$.*?\$", re.DOTALL)


def handout(given: Any) -> str:
    answers = read_answers(given, None)
    return printed(inputs_in_words(answers).values(), explain(answers))


def check_handout(page: str) -> None:
    r"""It has words and symbols only: friction\_force\_min stood in its prose, and mu, which is no symbol."""
    formulas, prose = IN_MATHEMATICS.findall(page), re.sub(r"\\[<^]", "", IN_MATHEMATICS.sub("", page))
    assert not re.search(r"[\xa0_`$\\]|--|: give |\b(?:mu|inf|m[12]|[MIR])\b", prose)
    assert {character for character in prose if not character.isascii()} <= {"²", "°"}  # as LaTeX has them
    for formula in formulas:
        assert re.fullmatch(r"\$\$\n[^$]*\n\$\$|\$[^$\n]+\$", formula)
        assert formula.isascii()
        assert formula.count("{") == formula.count("}")
        assert formula.count(r"\begin{aligned}") == formula.count(r"\end{aligned}") <= 1
        assert set(re.findall(r"\\([a-zA-Z]+)", formula)) <= {*MATHEMATICS.split()}
        assert not re.search(r"\^(\w|\{[^{}]*\})\^", formula)  # LaTeX takes no second superscript
        assert not re.search(r"`|_\{mathrm|(?<!\\)\b(sin|ln)\(", formula)
    titles = re.findall("^#.*", page, re.MULTILINE)
    assert titles[0] == "# Atwood's machine, step by step"
    assert all(title.startswith(f"## {i}. ") for i, title in enumerate(titles[1:], 1))


def test_pandoc_makes_other_pages_of_a_handout_without_complaint(tmp_path: Path) -> None:
    pypandoc = pytest.importorskip("pypandoc")
    page = "\n\n".join(handout(SCENES[kind]) for kind in ("grips", "an axle alone", "finds the pulley"))
    strictly = ["--fail-if-warnings", "--standalone", "--metadata=title:Atwood"]

    def converted(to: str, *more: str, **how: str) -> str:
        return str(pypandoc.convert_text(page, to, "markdown-auto_identifiers", [*strictly, *more], **how))

    html, latex = converted("html", "--mathml"), converted("latex")
    assert html.count("<math") == len(IN_MATHEMATICS.findall(page))
    assert "textbackslash" not in latex
    word = tmp_path / "handout.docx"
    converted("docx", outputfile=str(word))
    with zipfile.ZipFile(word) as files:
        assert files.read("word/document.xml").count(b"<m:oMath>") == html.count("<math")
