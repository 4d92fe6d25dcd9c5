"""A derivation is set in type: plain text for a terminal, Markdown with LaTeX for a handout.

The first half writes formulas, with symbols or with numbers. The second half makes a page of sentences and
equations.
"""

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from decimal import Decimal
from typing import Any

from ..arithmetic.symbolic import Formula, Symbol, factors
from ..model.digits import text
from ..model.quantities import QUANTITIES
from ..model.scene import INPUTS
from ..solver.equations import Equation, Law, Part, plain
from ..solver.steps import Explanation
from .text import wrapped

Written = tuple[str, int]
"""A formula as text, and its precedence, which decides where it needs parentheses."""
SUM, PRODUCT, POWER, ATOM = range(4)
"""The precedences, from the lowest on."""
GREEK_IN_LATEX = {
    "μ": r"\mu",
    "π": r"\pi",
    "φ": r"\varphi",
    "θ": r"\theta",
    "α": r"\alpha",
    "β": r"\beta",
    "τ": r"\tau",
}


def written(formula: Formula, numbers: Mapping[Symbol, Decimal] | None = None, latex: bool = False) -> str:
    """The formula, with symbols or with numbers for them, as plain text or as LaTeX."""
    return _write(formula, numbers, latex)[0]


def _write(node: Formula, numbers: Mapping[Symbol, Decimal] | None, latex: bool) -> Written:
    def write(part: Formula) -> Written:
        return _write(part, numbers, latex)

    def tight(part: Formula, level: int = ATOM) -> str:
        words, its_level = write(part)
        return words if its_level >= level else f"({words})"

    match node.op:
        case "symbol":
            if numbers is not None:
                return _write_number(text(numbers[node.parts[0]]), latex)
            name = node.parts[0].name
            level = SUM if " " in name else POWER if "*" in name else ATOM  # LaTeX takes one superscript
            return in_math(name) if latex else name, level
        case "number":
            return _write_number(str(node.parts[0]), latex)
        case "+" | "-":
            left, right = node.parts
            level = SUM if node.op == "+" == right.op else PRODUCT
            return f"{write(left)[0]} {node.op} {tight(right, level)}", SUM
        case "*" | "/":
            return _quotient(node, write, numbers is not None, latex)
        case "square":
            return f"{tight(node.parts[0])}^2", POWER
        case "hypot":
            inside = " + ".join(tight(part) + "^2" * (part.op != "number") for part in node.parts)
            return (rf"\sqrt{{{inside}}}" if latex else f"√({inside})"), ATOM
        case "expm1":
            power = write(node.parts[0])[0]
            return (f"e^{{{power}}} - 1" if latex else f"e^({power}) - 1"), SUM
        case "sqrt" if latex:
            return rf"\sqrt{{{write(node.parts[0])[0]}}}", ATOM
    inside = f"1 + {tight(node.parts[0], PRODUCT)}" if node.op == "log1p" else write(node.parts[0])[0]
    function = {"log1p": "ln", "sqrt": "√"}.get(node.op, node.op)
    return (rf"\{function}({inside})" if latex else f"{function}({inside})"), ATOM


def _quotient(node: Formula, write: Callable[[Formula], Written], numbers: bool, latex: bool) -> Written:
    """A product or quotient of all its factors: a minus stands in front, and all divisors below one line."""
    above, below = factors(node)
    minus = above[0].op == "number" and above[0].parts[0] < 0
    if minus:
        above = above[1:]
    times = (r" \cdot " if latex else " · ") if numbers else (r"\," if latex else " ")

    def product(factors: list[Formula], alone: bool) -> str:
        factors = _powers(factors)
        words = [(word if level >= POWER else f"({word})") for word, level in map(write, factors)]
        return write(factors[0])[0] if alone and not factors[1:] else times.join(words)

    upper = product(above, alone=latex and bool(below))
    lower = product(below, alone=latex) if below else ""
    if below and latex:
        quotient = rf"\frac{{{upper}}}{{{lower}}}"
    else:
        quotient = upper + (f"/({lower})" if _powers(below)[1:] else f"/{lower}" if below else "")
    return f"{'-' * minus}{quotient}", SUM if minus else PRODUCT


def _powers(factors: list[Formula]) -> list[Formula]:
    """The factors, with the square of a symbol that is there twice."""
    powers: dict[Any, Formula] = {}
    for factor in factors:
        same = factor.parts if factor.op == "symbol" else factor
        powers[same] = Formula("square", factor) if same in powers else factor
    return [*powers.values()]


def _write_number(digits: str, latex: bool) -> Written:
    level = SUM if digits.startswith("-") else ATOM
    return (number_in_latex(digits), min(level, PRODUCT)) if latex and "e" in digits else (digits, level)


def number_in_latex(digits: str) -> str:
    """A number as LaTeX writes it, with its power of ten."""
    mantissa, _, exponent = digits.partition("e")
    return rf"{mantissa} \times 10^{{{exponent}}}" if exponent else digits


def in_math(words: str) -> str:
    """A symbol or a plain equation as LaTeX: indices lowered, Greek letters, powers and functions spelled."""
    words = re.sub(r"(?<=[\d)])e(-?\d+)", r" \\times 10^{\1}", words)
    words = re.sub(r"_(\w+)", r"_{\\mathrm{\1}}", words)
    words = re.sub(r"\b([A-Za-z])(\d)", r"\1_\2", words)
    words = re.sub(r" (min|max)\b", r"_{\\\1}", words)
    words = re.sub(r"\^\(([^()]*)\)", r"^{\1}", words)
    words = re.sub(r"\b(ln|sin)\(", r"\\\1(", words)
    words = words.replace("*", r"^{\ast}").replace("√", r"\sqrt").replace("∞", r"\infty ")
    words = words.replace("≈", r"\approx ").replace("≤", r"\le ").replace("≥", r"\ge ")
    words = words.replace("±", r"\pm ").replace(" to ", r"~\mathrm{to}~")
    words = re.sub("[" + "".join(GREEK_IN_LATEX) + "]", lambda found: GREEK_IN_LATEX[found[0]] + " ", words)
    return re.sub(r" +([ })^_]|$)", r"\1", words)


# The page


def as_text(given: Iterable[str], explanation: Explanation, width: int) -> Iterator[tuple[str, str]]:
    """Lines of at most that width, each with its style; a longer word has a line of its own.

    ``given`` has each input in words, as "m1 = 1 kg".
    """
    parts = (part for step in explanation.steps for part in step.body)
    label_width = max(len(part.label) for part in parts if not isinstance(part, str))
    above = [(", ".join(given), ""), *((words, "bold") for words in explanation.answer)]
    for words, style in (*above, (explanation.reading, "")):
        yield from ((line, style) for line in wrapped(in_text(words), width))
    for number, step in enumerate(explanation.steps, 1):
        yield "", ""
        yield f"{number}. {step.title}", "bold"
        for part in step.body:
            if isinstance(part, str):
                first, later = ("  ", "    ") if is_item(part) else ("", "")
                lines = wrapped(in_text(part), width, first, later)
            else:
                lines = _equation_lines(part, width, f"  {part.label:<{label_width}} ")
            yield from ((line, "") for line in lines)


def is_item(part: Part) -> bool:
    """Whether a part of a step is an item of a list."""
    return isinstance(part, str) and part.startswith("- ")


def in_text(words: str) -> str:
    """A sentence without its backticks, between which no line breaks."""
    pieces = words.split("`")
    pieces[1::2] = [piece.replace(" ", "\xa0") for piece in pieces[1::2]]
    return "".join(pieces)


def law(law: Law, latex: bool = False) -> str:
    """A law in a line."""
    if isinstance(law.words, str):
        return in_math(law.words) if latex else law.words
    return " = ".join(written(side, None, latex) for side in law.words)


def chain(equation: Equation, latex: bool = False) -> list[str]:
    """The sides of an equation from left to right: symbols, numbers put in, result."""
    unit = equation.unit
    if latex:
        unit = unit and rf"\ \mathrm{{{unit.replace('²', '^2').replace(' ', '~')}}}"
    before, after = (sign.replace("≈", r"\approx") if latex else sign for sign in equation.signs)
    sides = [f"= {written(equation.formula, None, latex)}"]
    if equation.numbers is not None:
        sides.append(f"{before} {written(equation.formula, equation.numbers, latex)}")
    result = number_in_latex(equation.result) if latex else equation.result
    sides.append(f"{after} {result}{'' if latex or not unit else ' '}{unit}")
    return sides


def _equation_lines(part: Law | Equation, width: int, label: str) -> list[str]:
    """An equation in one line if it fits, else in a line for each of its sides."""
    if isinstance(part, Law):
        return wrapped(law(part), width, label, " " * (len(label) + 2))
    first, *others = chain(part)
    whole = f"{label}{part.left} {' '.join([first, *others])}"
    if len(whole) <= width:
        return [whole]
    indent = " " * (len(label) + len(part.left) + 1)
    if len(indent) > width // 3:
        indent = " " * 4
    lines = wrapped(f"{part.left} {first}", width, label, indent + "  ")
    for side in others:
        lines += wrapped(side, width, indent, indent + "  ")
    return lines


def as_markdown(given: Iterable[str], explanation: Explanation) -> Iterator[str]:
    """A page of Markdown, its mathematics in LaTeX between dollars."""
    yield f"# {explanation.title}"
    inputs = (words.partition(" = ") for words in given)
    scene = ", ".join(f"`{name}` = {PRINTED.get(value, value)}" for name, _, value in inputs)
    for words in (scene, *explanation.answer, explanation.reading):
        yield ""
        yield in_markdown(words)
    for number, step in enumerate(explanation.steps, 1):
        yield ""
        yield f"## {number}. {step.title}"
        for before, part in zip(["", *step.body], step.body, strict=False):
            if not is_item(part) or not is_item(before):
                yield ""
            if isinstance(part, str):
                yield in_markdown(part)
            else:
                label = rf" \qquad {part.label}" if part.label else ""  # not every reader knows \tag
                yield f"$$\n{_aligned(part)}{label}\n$$"


def _aligned(part: Law | Equation) -> str:
    """An equation in LaTeX, its = signs below each other."""
    if isinstance(part, Law):
        return law(part, latex=True)
    sides = chain(part, latex=True)
    rows = " \\\\\n".join(f"&{side}" for side in sides)
    return f"\\begin{{aligned}}\n{in_math(part.left)} {rows}\n\\end{{aligned}}"


def in_markdown(words: str) -> str:
    """A sentence with its names and symbols as mathematics, in which no character is taken for markup.

    Characters that are not ASCII are mathematics, except in units, so that any LaTeX can set them.
    """
    named = re.sub("`([^`]*)`", lambda name: PRINTED.get(name[1], name[0]), words)
    if words.startswith("`"):
        named = f"{named[0].upper()}{named[1:]}"
    pieces = MATHEMATICS.split(named)
    pieces[::2] = (re.sub(r"([][*_|<>$\\^~@#]|-(?=-))", r"\\\1", piece) for piece in pieces[::2])
    pieces[1::2] = (f"${in_math(piece.strip('`'))}$" for piece in pieces[1::2])
    return "".join(pieces)


MATHEMATICS = re.compile(r"(`[^`]*`|\(-?[\d.]+ ± [\d.]+\)e-?\d+|-?[\d.]+ ± [\d.]+|[μπφθαβτ≈≤≥√±])")
"""The mathematics in a sentence: words between backticks, uncertain numbers, and signs that are not ASCII."""
IN_WORDS = {
    "tension_1": "tension",
    "tension_2": "tension",
    "mu_verge": "least friction coefficient",
    "friction_force_min": "least friction force",
    "friction_force_max": "greatest friction force",
    "friction_force_x": "friction force",
    "friction_force_y": "friction force",
}
"""The words for a quantity whose name with blanks says less."""
PRINTED = {
    name: f"the {IN_WORDS.get(name, name.replace('_', ' '))} `{plain(about.symbol)}`"
    for name, about in QUANTITIES.items()
    if name not in INPUTS
} | {
    "mu": "`μ`",
    "mu_k": "`μ_k`",
    "inertia": "inertia factor `β`",
    "wrap": "angle of wrap `φ`",
    "axle": "axle friction",
    "drop": "height of fall `s`",
    "time": "time of fall `t`",
    "inf": "`∞`",
    "give": "not known without",
}
"""The words on a page for names of the program; a name that is not here is its own symbol."""
