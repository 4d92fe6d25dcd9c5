"""The derivation: every equation worked out again from its text, every number against the oracle."""

import re
import zipfile
from collections import Counter
from collections.abc import Iterator
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

import mpmath as mp
import pytest
from hypothesis import given
from hypothesis import strategies as st

from atwood_cli.model.case import Case
from atwood_cli.model.digits import to_digits
from atwood_cli.model.quantities import NAMES, QUANTITIES
from atwood_cli.model.scene import Scene
from atwood_cli.output.text import inputs_in_words
from atwood_cli.output.typeset import as_markdown, as_text, chain
from atwood_cli.output.typeset import law as law_in_text
from atwood_cli.solver.answers import Answers, read_answers
from atwood_cli.solver.equations import Equation, Law
from atwood_cli.solver.equations import plain as in_letters
from atwood_cli.solver.steps import Explanation, explain

from . import oracle
from .conftest import examples, many
from .running import on_terminal, plain, process
from .scenes import FAMILIES, Given, of_all_kinds, scenes

TOP = Path(__file__).parent.parent
NUMBER = r"-?\d+(?:\.\d+)?(?:e-?\d+)?"
KINDS: dict[str, dict[str, str | None]] = {
    "massless": {},
    "given pulley": {"M": "10"},
    "verge": {"mu": "0.3"},
    "no critical mass": {"mu": "0.4"},
    "grips": {"M": "10", "mu": "0.3"},
    "grips on a long wrap": {"M": "10", "mu": "0.3", "wrap": "540"},
    "slips": {"M": "100", "mu": "0.3", "mu_k": "0.25", "R": "0.1"},
    "slides without friction": {"M": "100", "mu": "0.3", "mu_k": "0"},
    "locked": {"M": "inf"},
    "locked and slips": {"M": "inf", "mu": "0.2", "wrap": "1rad"},
    "locked and grips": {"M": "inf", "mu": "0.4"},
    "equal": {"m2": "1", "M": "3", "mu": "0.1", "R": "1"},
    "free end": {"m1": "0", "M": "2"},
    "free end, massless": {"m1": "0"},
    "no friction, no pulley": {"mu": "0"},
    "no friction": {"mu": "0", "M": "5"},
    "massless, rough": {"M": "0", "mu": "0.2"},
    "mirror": {"m1": "3", "m2": "1", "M": "50", "mu": "0.3", "R": "0.1"},
    "inertia": {"M": "50", "mu": "0.3", "R": "0.1", "I": "0.8", "wrap": "100"},
    "inertia alone": {"mu": "0.3", "R": "0.1", "I": "0.3"},
    "hoop": {"M": "10", "inertia": "hoop", "g": "moon"},
    "an axle that rubs": {"M": "10", "axle": "5", "R": "0.1"},
    "an axle that holds": {"M": "10", "R": "0.1", "axle": "2.5Nm"},
    "an axle that holds a free end": {"m1": "0", "m2": "1", "axle": "12"},
    "an axle alone": {"axle": "5"},
    "grips beside an axle": {"M": "10", "mu": "0.3", "axle": "5"},
    "verge beside an axle": {"mu": "0.2", "axle": "5"},
    "always slips beside an axle": {"mu": "0.05", "axle": "5"},
    "slips on an axle that holds": {"mu": "0.05", "axle": "1.2Nm", "R": "0.05", "M": "1"},
    # With c = 5 and g = 9 masses of 1 and 3 have a = 2, and a = 1 beside an axle with 9 N.
    "finds the pulley": {"g": "9", "drop": "9", "time": "3", "R": "0.1"},
    "finds gravity": {"M": "10", "a": "2"},
    "finds gravity beside an axle": {"M": "10", "a": "1", "axle": "0.9Nm", "R": "0.1"},
    "finds the heavier mass": {"m2": None, "M": "10", "g": "9", "a": "2"},
    "finds the lighter mass": {"m1": "3", "m2": None, "M": "10", "g": "9", "a": "-1", "axle": "9"},
    "finds an equal mass": {"m2": None, "M": "10", "a": "0"},
    "finds kinetic friction": {"M": "inf", "g": "10", "a": "2", "drop": "4"},
    "finds no kinetic friction": {"m1": "3", "m2": "1", "M": "100", "mu": "0.2", "g": "10", "a": "-5"},
    "falls": {"M": "10", "g": "9", "drop": "9", "mu": "0.3"},
    "slips beside an axle": {"m1": "3", "m2": "1", "M": "300", "mu": "0.2", "axle": "5"},
}
kinds = pytest.mark.parametrize("kind", KINDS)
UNKNOWN = {"locked and slips", "finds kinetic friction", "finds no kinetic friction"}
"""Kinds that the oracle does not know: a wrap in radians, and friction that is found."""
known_kinds = pytest.mark.parametrize("kind", sorted(KINDS.keys() - UNKNOWN))


def answers_of(kind: str, digits: int | None = None) -> Answers:
    return read_answers({"m1": "1", "m2": "3", **KINDS[kind]}, digits)


def scene_of(kind: str) -> Scene:
    return answers_of(kind).case.scene


def told_of(kind: str, digits: int | None = None) -> Explanation:
    return explain(answers_of(kind, digits))


def told(scene: Scene, digits: int | None = None) -> Explanation:
    return explain(Answers(scene, digits))


def equations(found: Explanation) -> list[Equation]:
    return [part for step in found.steps for part in step.body if isinstance(part, Equation)]


def sentences(found: Explanation) -> list[str]:
    return [*found.answer, *(part for step in found.steps for part in step.body if isinstance(part, str))]


# The equations, read as a person reads them and worked out with another library

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
    """LaTeX as plain text."""
    while r"\frac" in words:
        at = words.index(r"\frac")
        above, then = braced(words, at + 5)
        below, end = braced(words, then)
        words = f"{words[:at]}(({above})/({below})){words[end:]}"
    words = re.sub(r"(\d) \\times 10\^\{(-?\d+)\}", r"\1e\2", words).replace(r"\cdot", "·")
    return re.sub(r"\\(ln|sin)", r"\1", words).replace(r"\sqrt", "√").translate({123: "(", 125: ")"})


def braced(words: str, start: int) -> tuple[str, int]:
    depth = 0
    for i in range(start, len(words)):
        depth += {"{": 1, "}": -1}.get(words[i], 0)
        if not depth:
            return words[start + 1 : i], i + 1
    raise AssertionError(f"braces do not match: {words}")


def check_numbers(equation: Equation, digits: int) -> None:
    """The result is within the range of the numbers put in, those of all digits half a unit off either way."""
    if equation.numbers is None:
        return
    numbers = equation.numbers.values()
    mp.mp.dps = mp.iv.dps = 100 + sum(len(str(number)) + max(0, -2 * number.adjusted()) for number in numbers)
    _, put_in, result = chain(equation)
    shown = Decimal(equation.result)
    assert equation.result in result
    half = Decimal((0, (5,), shown.adjusted() - digits)) if shown and equation.signs[1] == "≈" else Decimal(0)
    value = work_out(put_in[2:], digits + 2, ranges=True)
    wanted = mp.iv.mpf(str(shown)) + mp.iv.mpf([f"-{half}", str(half)])
    assert wanted.a <= value.b, (put_in, result)
    assert value.a <= wanted.b, (put_in, result)
    latex = chain(equation, latex=True)[1]
    sign, _, words = latex.partition(" ")
    assert sign == {"=": "=", "≈": r"\approx"}[equation.signs[0]]
    assert mp.almosteq(work_out(from_latex(words)), work_out(put_in[2:]), rel_eps=mp.mpf(10) ** -80)


@kinds
@pytest.mark.parametrize("digits", [None, 1, 30])
def test_every_line_gives_its_result(kind: str, digits: int | None) -> None:
    found = equations(told_of(kind, digits))
    assert found
    for equation in found:
        assert equation.numbers is not None
        check_numbers(equation, digits or 6)


@examples(60)
@given(st.sampled_from(sorted(FAMILIES)), st.integers(0, 10**9), st.sampled_from([None, 2, 17]))
def test_every_line_gives_its_result_in_any_scene(family: str, seed: int, digits: int | None) -> None:
    scene = Scene.read(next(scenes(family, 1, seed)))
    found = told(scene, digits)
    check_values(found, scene, digits or 6)
    for equation in equations(found):
        # mpmath needs as many digits as a number is small.
        if all(abs(number.adjusted()) < 3000 for number in (equation.numbers or {}).values()):
            check_numbers(equation, digits or 6)
    assert [*as_text([], found, 80)]
    check_markdown([*as_markdown([], found)])


@kinds
def test_the_symbols_say_what_the_numbers_do(kind: str) -> None:
    """The formula as printed, with the oracle's inputs and the results so far, gives each result."""
    mp.mp.dps = 60
    case, names = answers_of(kind).case, {"mu": "μ", "mu_k": "μ_k"}
    scene = case.scene
    exact: dict[str, Fraction | None] = {
        names.get(name, name): q for name, q in scene._asdict().items() if isinstance(q, Fraction)
    }
    exact |= {"M": case.pulley_mass or Fraction(0), "c": case.rim_mass, "β": case.beta}
    exact |= {"f_axle": case.axle_friction, "b": case.axle_mass, "τ_axle": scene.axle and scene.axle.number}
    env = {name: mp.mpf(q.numerator) / q.denominator for name, q in exact.items() if q is not None}
    env |= {
        "π": +mp.pi,
        "φ": mp.radians(mp.mpf(scene.wrap.number.numerator) / scene.wrap.number.denominator),
        "a": mp.mpf(0),
    }
    measured = {"s": case.motion.drop, "t": case.motion.time, "a": case.motion.a}
    env |= {name: mp.mpf(q.numerator) / q.denominator for name, q in measured.items() if q is not None}
    env["|a|"] = abs(env["a"])
    if KINDS[kind].get("wrap") == "1rad":
        env["φ"] = mp.mpf(1)
    if scene.mu == 0 or scene.mu_k == 0:
        k, z = ("k", "z") if scene.mu == 0 else ("k_kin", "z_kin")
        env |= {k: mp.mpf(1), z: mp.mpf(0), "M*": mp.mpf(0)}
    lighter, heavier = ("T2", "T1") if scene.m1 > scene.m2 else ("T1", "T2")
    for equation in equations(told_of(kind, 50)):
        symbols = {spelled(name): value for name, value in env.items()}
        value = work_out(spelled(chain(equation)[0][2:]), **symbols)
        assert mp.almosteq(value, mp.mpf(equation.result), rel_eps=mp.mpf(10) ** -45), equation.left
        left = equation.left
        env[left.removesuffix(" - 1")] = mp.mpf(equation.result) + (1 if left.endswith(" - 1") else 0)
        if " - T" in left:
            env[heavier] = env[lighter] + mp.mpf(equation.result)
        elif left == lighter:  # what is shown of equal tensions
            env.setdefault(heavier, env[lighter])
        if left == "|a|":
            env["a"] = -env["|a|"]


def spelled(words: str) -> str:
    words = words.replace("μ*", "mustar").replace("|a|", "abs_a")
    return re.sub(r"\b([Mml])\*", r"\1_crit", words)


# Every number against the oracle

VALUES = {in_letters(about.symbol): name for name, about in QUANTITIES.items() if name in NAMES}
VALUES["|a|"] = "acceleration"


def stated(found: Explanation) -> Iterator[tuple[str, str]]:
    """Each symbol with the number that it is said to be."""
    for equation in equations(found):
        if equation.signs[1] != ">":
            yield equation.left, equation.result
    for words in sentences(found):
        if not words.startswith("- "):  # what a simpler model gives
            yield from re.findall(rf"`([^`]+)` = ({NUMBER})", words)


def check_values(found: Explanation, scene: Scene, digits: int) -> int:
    expected, checked = oracle.expected(scene), 0
    for symbol, shown in stated(found):
        value = expected.get(VALUES.get(symbol, ""))
        if value is not None:
            right = oracle.correctly_rounded(value, digits)
            assert Decimal(shown) == (abs(right) if symbol == "|a|" else right), symbol
            checked += 1
    return checked


@known_kinds
def test_every_number_is_the_oracles(kind: str) -> None:
    checked = check_values(told_of(kind), scene_of(kind), 6)
    assert checked >= (1 if kind == "no critical mass" else 4)


SIMPLER: dict[str, dict[str, str | None]] = {
    "What if the pulley's mass is ignored?": {"M": "0", "I": None},
    "What if the axle did not rub?": {"axle": None},
    "What if slipping is ignored?": {"mu": None, "mu_k": None},
}
"""What a simpler model is given in place of what the scene is."""


def check_what_if(given: Given) -> set[str]:
    """Every number of the simpler models is that of `solve` with the simpler scene; their titles."""
    answers, titles = Answers(Scene.read(given)), set()
    for step in explain(answers).steps:
        if step.title not in SIMPLER:
            continue
        titles.add(step.title)
        simpler = Answers(Scene.read({**given, **SIMPLER[step.title]}))
        pairs = {
            name: [Decimal(each.to(40)[name]) for each in (simpler, answers)]
            for name in ("acceleration", "tension_1", "tension_2")
        }
        if len(step.body) == 1:
            assert str(step.body[0]).startswith("Nothing changes: ")
            assert all(there == here for there, here in pairs.values()), given
            continue
        for words, (name, (there, here)) in zip(step.body, pairs.items(), strict=True):
            numbers = re.findall(rf"(?<![\w/])[+-]?{NUMBER}", str(words).partition("= ")[2])
            off = [f"{100 * (there - here) / here:.3g}"] if here else []
            expected = [simpler.to(6)[name], answers.to(6)[name], *map(Decimal, off)]
            assert [Decimal(number) for number in numbers] == expected, (given, words)
    return titles


def test_what_simpler_models_give_is_what_solve_gives_for_them() -> None:
    """The pulley without mass had no mu: where the string slips over that, too, the numbers were false."""
    slips: Given = {"m1": "1", "m2": "3", "M": "10", "mu": "0.05", "axle": "6"}
    assert check_what_if(slips) >= {"What if the pulley's mass is ignored?"}
    seen = [title for given in of_all_kinds(many(300)) for title in check_what_if(given)]
    assert all(seen.count(title) > many(40) for title in SIMPLER), Counter(seen)


def known_numbers(given: Given) -> list[Decimal]:
    """All numbers that solve gives for a scene and those that a page compares it with, and its inputs."""
    scene, none = Scene.read(given), dict.fromkeys(("mu", "mu_k"))
    others: list[dict[str, str | None]] = [{}, none, {"axle": None}, {"mu": given.get("mu_k"), "mu_k": None}]
    others += [{"M": "0", "I": None}, {"M": "0", "I": None, **none}, {"M": "inf", "I": None, **none}]
    values: list[Any] = []
    for other in others:
        answers = Answers(Scene.read({**given, **other}), 40)
        values += [answers[name] for name in NAMES[1:]]
    beta, b = Case(scene).beta, Case(scene).axle_mass or 0
    exact = [scene.m1, scene.m2, scene.M, scene.mu, scene.mu_k, beta, b, 1000 * b, scene.wrap.number]
    angle = mp.radians(scene.wrap.number.numerator / mp.mpf(scene.wrap.number.denominator))
    values += [to_digits(40)(q) for q in exact if isinstance(q, Fraction)]
    return [Decimal(str(x)) for x in (*values, 1, 0, angle, mp.sin(angle / 2)) if x is not None]


def test_every_number_in_a_sentence_is_one_that_solve_gives() -> None:
    """But for those of simpler models, which are held to solve above."""
    mp.mp.dps, checked = 40, 0
    for scene in of_all_kinds(many(200), seed=7):
        known = known_numbers(scene)
        for words in sentences(told(Scene.read(scene))):
            if " in place of " in words:
                continue
            values = re.sub(r"\(\d+\)|`[^`]*`|R\^2|\(180 degrees\)|1 and 2", "", words)
            for number in map(Decimal, re.findall(rf"(?<![\w.]){NUMBER}", values)):
                short = number if "." in str(number) else number.normalize()
                unit = Decimal((0, (1,), int(short.as_tuple().exponent)))
                assert any(abs(number - one) < unit or number == one for one in known), (scene, words, number)
                checked += 1
    assert checked > many(2000)


@known_kinds
def test_the_laws_hold(kind: str) -> None:
    """(1) as printed, with the oracle's numbers; (3) is worked out as an equation.

    On the verge the ratio of the tensions gives the critical masses: it holds with each in its place.
    """
    scene, mp.mp.dps = scene_of(kind), 40
    expected = oracle.expected(scene)
    if expected["acceleration"] is None:
        assert kind == "no critical mass"  # whose motion is open
        return

    def number(name: str) -> Any:
        return mp.mpf(str(oracle.correctly_rounded(expected[name], 35)))

    symbols = {
        name: mp.mpf(q.numerator) / q.denominator
        for name, q in scene._asdict().items()
        if name in ("m1", "m2", "g")
    }
    symbols |= {"T1": number("tension_1"), "T2": number("tension_2"), "a": number("acceleration")}
    symbols["abs_a"] = abs(symbols["a"])
    laws = [part for step in told_of(kind).steps for part in step.body if isinstance(part, Law)]
    critical = {
        "M_crit": "critical_pulley_mass",
        "m_crit": "critical_heavier_mass",
        "l_crit": "critical_lighter_mass",
    }
    symbols |= {symbol: number(name) for symbol, name in critical.items() if expected[name] is not None}
    case, light, heavy = Case(scene), *(("m2", "m1") if scene.m1 > scene.m2 else ("m1", "m2"))
    of_the_pulley = {"β": case.beta, "c": case.rim_mass, "b": case.axle_mass}
    symbols |= {
        name: mp.mpf(q.numerator) / q.denominator for name, q in of_the_pulley.items() if q is not None
    }
    if expected["capstan_ratio"] is not None:
        symbols["k"] = number("capstan_ratio")
    checked = 0
    for law in laws:
        words = spelled(law_in_text(law))
        if law.label == "(1)":
            on_the_verge: list[dict[str, Any]] = [{}]
        elif not isinstance(law.words, str):  # one that has the ratio
            replaced = {
                "c": symbols["β"] * symbols["M_crit"] if "M_crit" in symbols else None,
                heavy: None if case.locked else symbols.get("m_crit"),
                light: None if case.stands_until_it_slips else symbols.get("l_crit"),
            }
            named = re.search(r"\w_crit|^T\d/T\d = ", words)
            on_the_verge = [{}] if named else [{name: x} for name, x in replaced.items() if x is not None]
            assert on_the_verge
        else:
            continue
        for other in on_the_verge:
            env = symbols | other
            env["M"] = env["M_crit"] if "c" in other else 2 * env.get("c", 0)
            env["z"] = env[light] * (env.get("k", 1) - 1)
            left, right = (work_out(side, **env) for side in words.split(" = "))
            assert mp.almosteq(left, right, rel_eps=mp.mpf(10) ** -28, abs_eps=mp.mpf(10) ** -28), (
                words,
                other,
            )
            checked += 1
    assert checked >= (11 if kind == "grips" else 2)


# What is said


@kinds
def test_b_marks_the_equations_that_the_axle_enters(kind: str) -> None:
    for step in told_of(kind).steps:
        for part in step.body:
            if not isinstance(part, str):
                words = law_in_text(part) if isinstance(part, Law) else chain(part)[0]
                enters = part.label and re.search(r"\b(b|f_axle)\b", words)
                assert part.label.endswith("+b") == bool(enters), words


def test_what_is_0_whatever_the_numbers_is_exactly_0() -> None:
    """T1 of a free end was ≈ 0."""
    found = equations(told(Scene.read({"m1": "0", "m2": "1", "M": "1"})))
    assert next(equation.signs for equation in found if equation.left == "T1") == "≈="


# On the page


@kinds
@pytest.mark.parametrize("width", [40, 80])
def test_lines_keep_to_the_width_and_numbers_stay_whole(kind: str, width: int) -> None:
    found = told_of(kind, 20)
    lines = [line for line, _ in as_text(["m1 = 1 kg"], found, width)]
    assert all(len(line) <= width or " " not in line.strip() for line in lines)
    words = " ".join(lines).split()
    for equation in equations(found):
        assert any(equation.result in word for word in words)
        for number in (equation.numbers or {}).values():
            shown = str(number).lower().replace("e+", "e")
            assert any(shown in word for word in words)
    assert "\xa0" not in "".join(lines)
    assert not any(re.search(r"^=|\w =$", line) for line in lines)
    assert "`" not in "".join(lines)


@pytest.mark.parametrize("columns", [30, 200])
def test_on_a_terminal(columns: int) -> None:
    seen = on_terminal("solve", "--m1", "1", "--m2", "3", "--mu", "0.3", "--explain", columns=columns)
    assert "\x1b[1m1. The masses" in seen
    assert max(map(len, plain(seen).splitlines())) <= max(40, min(80, columns))
    assert "≈ 43.3419 kg" in re.sub(r"\s+", " ", plain(seen))


@pytest.mark.parametrize("encoding", ["ascii", "cp1252"])
@pytest.mark.parametrize("more", [[], ["--markdown"]])
def test_where_stdout_lacks_symbols_all_else_is_there(more: list[str], encoding: str) -> None:
    words = [*"solve --m1 1 --m2 3 --M 10 --mu 0.3 --R 1 --explain".split(), *more]
    ran, whole = process(*words, PYTHONIOENCODING=encoding), process(*words)
    assert (ran.status, ran.err) == (0, "")
    assert ran.out.replace("\ufffd", "?") == whole.out.encode(encoding, "replace").decode(
        "utf-8", "replace"
    ).replace("\ufffd", "?")


def check_markdown(lines: list[str], title: str = "Atwood's machine, step by step") -> None:
    page = "\n".join(lines)
    assert "`" not in page
    assert "\xa0" not in page
    pieces = page.split("$$")
    assert len(pieces) % 2 == 1
    for display in pieces[1::2]:
        assert display.startswith("\n")
        assert display.endswith("\n")
        assert display.count("{") == display.count("}")
        assert display.count(r"\begin{aligned}") == display.count(r"\end{aligned}") <= 1
        assert display.isascii()
    for prose in pieces[::2]:
        inline = re.sub(r"\\\$", "", prose).split("$")
        assert len(inline) % 2 == 1
        assert all(piece.isascii() and "\n" not in piece for piece in inline[1::2])
    titles = [line for line in lines if line.startswith("#")]
    assert titles[0] == f"# {title}"
    assert all(title.startswith(f"## {i}. ") for i, title in enumerate(titles[1:], 1))


MORE: dict[str, dict[str, str | None]] = {
    "two thirds of a turn": {"M": "10", "mu": "0.3", "wrap": "240"},
    "a wrap in radians": {"M": "10", "mu": "0.9", "wrap": "2rad"},
    "no mass": {"M": "0"},
    "nearly equal": {"m2": "1.00000001", "M": "3", "mu": "0.1"},
    "equal and missing": {"m2": "1", "mu": "0.1"},
    "equal on a locked pulley": {"m2": "1", "M": "inf"},
    "a hub": {"M": "10", "inertia": "2.5", "mu": "0.1", "mu_k": "0.05"},
    "caught": {"M": "10", "mu": "0.3", "mu_k": "0.25"},
    "kinetic and missing": {"mu": "0.4", "mu_k": "0.1"},
    "slides on": {"M": "10", "mu": "0.3", "mu_k": "0.1"},
    "an axle of grams": {"m2": "1.1", "M": "2", "mu": "0.4", "axle": "5"},
    "an axle that is a note": {"m2": "50", "M": "3", "mu": "0.2", "axle": "3"},
    "far apart": {"m1": "1e-30", "m2": "3e30", "M": "1e-5", "mu": "1e3"},
    "inertia beside an axle": {"I": "0.3", "R": "0.1", "axle": "1Nm", "mu": "0.4"},
}
HANDOUTS = {**KINDS, **MORE}
MATHEMATICS = """
    frac sqrt ln sin cdot times approx begin end mathrm qquad ast infty min max mu pi varphi theta alpha beta tau
    le ge
""".split()


def handout(kind: str) -> str:
    return handout_of({"m1": "1", "m2": "3", **HANDOUTS[kind]})


def handout_of(given: dict[str, str | None] | Given) -> str:
    answers = read_answers(given, None)
    case = answers.case
    return "\n".join(as_markdown(inputs_in_words(case.scene, case.motion).values(), explain(answers)))


@pytest.mark.parametrize("kind", HANDOUTS)
def test_a_handout_has_words_and_symbols_only(kind: str) -> None:
    r"""friction\_force\_min stood in its prose, and mu, which is no symbol."""
    page = handout(kind)
    prose = re.sub(r"\$\$.*?\$\$|\$.*?\$", "", page, flags=re.DOTALL)
    assert not re.search(r"[_`$\\]|--|: give |\b(?:mu|inf|m[12]|[MIR])\b", prose.replace("\\<", ""))
    assert {character for character in prose if not character.isascii()} <= {"²", "°"}  # as LaTeX has them
    mathematics = "".join(re.findall(r"\$\$.*?\$\$|\$.*?\$", page, flags=re.DOTALL))
    assert mathematics.isascii()
    assert set(re.findall(r"\\([a-zA-Z]+)", mathematics)) <= set(MATHEMATICS)
    assert "_{mathrm" not in mathematics
    check_markdown(page.split("\n"))


def formulas(page: str) -> Iterator[str]:
    """All that is between dollars, its numbers replaced by 2: what is left has few shapes."""
    for display, inline in re.findall(r"\$\$\n(.*?)\n\$\$|\$([^$]+)\$", page, flags=re.DOTALL):
        yield re.sub(NUMBER, "2", display or inline)


def test_latex_takes_every_formula() -> None:
    """It takes no second superscript: the square of the least coefficient had two."""
    mathml = pytest.importorskip("latex2mathml.converter")
    mathtext = pytest.importorskip("matplotlib.mathtext").MathTextParser("path")
    pages = [*map(handout, HANDOUTS), *map(handout_of, of_all_kinds(many(60)))]
    shapes = {shape: None for page in pages for shape in formulas(page)}
    assert len(shapes) > 200
    for shape in shapes:
        assert mathml.convert(shape).startswith("<math")
        lines = re.sub(r"&|\\(begin|end)\{aligned\}", "", shape)  # mathtext does not know these
        for row in lines.split(r"\\"):
            mathtext.parse(f"${' '.join(row.split())}$")


@pytest.mark.parametrize("kind", ["grips", "an axle alone", "finds the pulley"])
def test_pandoc_makes_other_pages_of_a_handout_without_complaint(kind: str, tmp_path: Path) -> None:
    pypandoc = pytest.importorskip("pypandoc")
    page, strictly = handout(kind), ["--fail-if-warnings", "--standalone", "--metadata=title:Atwood"]
    html = pypandoc.convert_text(page, "html", format="markdown", extra_args=[*strictly, "--mathml"])
    assert html.count("<math") == len(re.findall(r"\$\$.*?\$\$|\$.*?\$", page, flags=re.DOTALL))
    latex = pypandoc.convert_text(page, "latex", format="markdown", extra_args=strictly)
    assert "textbackslash" not in latex
    word = tmp_path / "handout.docx"
    pypandoc.convert_text(page, "docx", format="markdown", extra_args=strictly, outputfile=str(word))
    with zipfile.ZipFile(word) as files:
        assert files.read("word/document.xml").count(b"<m:oMath>") == html.count("<math")


# What cannot be


def test_where_nothing_but_the_axle_tells_the_motion_there_is_no_scene_without_it() -> None:
    """What it would be on an axle that does not rub depends on M, which is not given: a traceback."""
    given = {"m1": "1", "m2": "0.3", "mu": "3", "mu_k": "2.5", "axle": "1e300"}
    titles = [step.title for step in explain(Answers(Scene.read(given), 6)).steps]
    assert "What if the axle did not rub?" not in titles
    with_pulley = [step.title for step in explain(Answers(Scene.read(given | {"M": "1"}), 6)).steps]
    assert "What if the axle did not rub?" in with_pulley
