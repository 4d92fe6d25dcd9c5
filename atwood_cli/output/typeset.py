"""Set a derivation in type: plain text for a terminal, Markdown with LaTeX for a handout."""

import re
from collections.abc import Callable, Iterable, Mapping
from decimal import Decimal
from functools import partial
from itertools import groupby
from operator import attrgetter
from typing import Any

from ..explain.derivation import Explanation
from ..explain.equations import Equation
from ..numbers.digits import format_number
from ..numbers.formula import Formula, Symbol, factors
from ..solver.quantities import QUANTITIES
from ..solver.scene import INPUTS, MEASURED
from .page import Page
from .text import wrapped

Written = tuple[str, int]
"""A formula as text, and its precedence, which decides where it needs parentheses."""
SUM, PRODUCT, POWER, ATOM = range(4)
"""The precedences, from the lowest on."""
SIGNS = dict(zip("μπφθαβτω≈∞", "mu pi varphi theta alpha beta tau omega approx infty".split(), strict=True))
IN_LATEX = str.maketrans({sign: f"\\{name} " for sign, name in SIGNS.items()} | {"*": r"^{\ast}"})
"""Signs in symbols, and how LaTeX writes them."""
UNITS_IN_LATEX = str.maketrans({"²": "^2", "°": r"^{\circ}", " ": "~"})


def written(side: str | Formula, numbers: Mapping[Symbol, Decimal] | None = None, latex: bool = False) -> str:
    """Return a side of an equation, with symbols or with numbers for them, as plain text or as LaTeX."""
    if isinstance(side, str):
        return in_math(side) if latex else side
    return _write(side, numbers, latex)[0]


def _write(node: Formula, numbers: Mapping[Symbol, Decimal] | None, latex: bool) -> Written:
    write = partial(_write, numbers=numbers, latex=latex)

    def tight(part: Formula, level: int = ATOM) -> str:
        words, its_level = write(part)
        return words if its_level >= level else f"({words})"

    match node.op:
        case "symbol" | "number":
            return _write_atom(node.parts[0], numbers, latex)
        case "+" | "-":
            left, right = node.parts
            level = SUM if node.op == "+" == right.op else PRODUCT
            return f"{write(left)[0]} {node.op} {tight(right, level)}", SUM
        case "*" | "/":
            by_symbols, by_numbers = (r"\,", r" \cdot ") if latex else (" ", " · ")
            return _quotient(node, tight, by_symbols if numbers is None else by_numbers, latex)
        case "square":
            return f"{tight(node.parts[0])}^2", POWER
        case "expm1":
            power = write(node.parts[0])[0]
            return f"{f'e^{{{power}}}' if latex else f'e^({power})'} - 1", SUM
        case "log1p":
            inside = f"1 + {tight(node.parts[0], PRODUCT)}"
        case _:
            inside = write(node.parts[0])[0]
    function = {"log1p": "ln", "sqrt": "√"}.get(node.op, node.op)
    if not latex:
        return f"{function}({inside})", ATOM
    return (rf"\sqrt{{{inside}}}" if function == "√" else rf"\{function}({inside})"), ATOM


def _write_atom(atom: Any, numbers: Mapping[Symbol, Decimal] | None, latex: bool) -> Written:
    """Return a symbol, the number for it, or a number."""
    if isinstance(atom, Symbol):
        words = atom.name if numbers is None else format_number(numbers[atom])
    else:
        words = str(atom)
    if " " in words or words.startswith("-"):
        level = SUM
    elif "*" in words:
        level = POWER  # LaTeX takes one superscript
    else:
        level = PRODUCT if latex and re.search(r"\de", words) else ATOM
    return in_math(words) if latex else words, level


def _quotient(node: Formula, tight: Callable[[Formula, int], str], times: str, latex: bool) -> Written:
    """Return a product or quotient of all its factors, a minus in front, and all divisors below one line."""
    above, below = map(_powers, factors(node))
    minus = "-" if above[0].op == "number" and above[0].parts[0] < 0 else ""
    if minus:
        del above[0]
    upper, lower = (
        times.join(tight(factor, SUM if latex and below and len(part) == 1 else POWER) for factor in part)
        for part in (above, below)
    )
    if below and latex:
        upper = rf"\frac{{{upper}}}{{{lower}}}"
    elif below:
        upper += f"/({lower})" if len(below) > 1 else f"/{lower}"
    return minus + upper, SUM if minus else PRODUCT


def _powers(factors: list[Formula]) -> list[Formula]:
    """Return the factors, with the square of a symbol that is there twice."""
    powers: dict[Any, Formula] = {}
    for factor in factors:
        same = factor.parts if factor.op == "symbol" else factor
        powers[same] = Formula("square", factor) if same in powers else factor
    return [*powers.values()]


def in_math(words: str) -> str:
    """Return a symbol or a plain equation as LaTeX: indices lowered, powers and functions spelled."""
    words = re.sub(r"(?<=\d)e(-?\d+)", r" \\times 10^{\1}", words)
    words = re.sub(r"_(\w+)", r"_{\\mathrm{\1}}", words)
    words = re.sub(r"\b([A-Za-z])(\d)", r"\1_\2", words)
    words = re.sub(r" (min|max)\b", r"_{\\\1}", words)
    words = re.sub(r"\^\(([^()]*)\)", r"^{\1}", words)
    words = re.sub(r"\b(ln|sin)\(", r"\\\1(", words)
    return re.sub(r" +([ })^_]|$)", r"\1", words.translate(IN_LATEX))


# The page


def print_explanation(page: Page, given: Iterable[str], explanation: Explanation) -> None:
    """Print a derivation as text, or as Markdown with its mathematics in LaTeX between dollars.

    ``given`` has each input in words, as "m1 = 1 kg".
    """
    labels = [equation.label for paragraph in explanation.paragraphs for equation in paragraph.equations]
    label_width, in_words = max(map(len, labels), default=0), in_markdown if page.is_markdown else in_text
    if page.is_markdown:
        page.say("# Atwood's machine, step by step")
    page.say(in_words(scene(given)))
    page.say(*map(in_words, explanation.answer), style="bold")
    page.say(in_words(explanation.reading))
    steps = groupby(explanation.paragraphs, attrgetter("title"))
    for number, (title, paragraphs) in enumerate(steps, 1):
        page.heading(f"{number}. {title}")
        for _, sentences, equations in paragraphs:
            page.say(*map(in_words, sentences))
            for equation in equations:
                if page.is_markdown:  # not every reader knows \tag
                    label = rf" \qquad {equation.label}" if equation.label else ""
                    page.say(f"$$\n{_aligned(equation)}{label}\n$$")
                    continue
                for line in _equation_lines(equation, page.width, f"  {equation.label:<{label_width}} "):
                    page.line(line)


def scene(given: Iterable[str]) -> str:
    """Return the inputs as a sentence, their names between backticks."""
    pairs = (words.partition(" = ") for words in given)
    return ", ".join(f"`{name}` = {'`∞`' if value == 'inf' else value}" for name, _, value in pairs)


def with_symbols(words: str) -> str:
    """Return a sentence with symbols for the program's names, both between backticks."""
    return re.sub("`([^`]*)`", lambda name: IN_PROSE.get(name[1], name[0]), words)


def in_text(words: str) -> str:
    """Return a sentence without its backticks, between which no line breaks."""
    return re.sub("`([^`]*)`", lambda symbol: symbol[1].replace(" ", "\xa0"), with_symbols(words))


def in_markdown(words: str) -> str:
    """Return a sentence with its symbols as mathematics, in which no character is taken for markup.

    Characters that are not ASCII are mathematics, except in units, so that any LaTeX can set them.
    """
    pieces = re.split("(`[^`]*`|[μπφθαβτ≈])", with_symbols(words))
    pieces[::2] = (re.sub(r"([][*_|<>$\\^~@#]|-(?=-))", r"\\\1", piece) for piece in pieces[::2])
    pieces[1::2] = (f"${in_math(piece.strip('`'))}$" for piece in pieces[1::2])
    return "".join(pieces)


def chain(equation: Equation, latex: bool = False) -> list[str]:
    """Return the right sides of an equation, each with its sign: symbols, numbers put in, result."""
    before, after, result = (
        in_math(words) if latex else words for words in (*equation.signs, equation.result)
    )
    sides = []
    if equation.right is not None:
        sides.append(f"= {written(equation.right, None, latex)}")
    if isinstance(equation.right, Formula) and result:
        sides.append(f"{before} {written(equation.right, equation.numbers, latex)}")
    if result and latex and equation.unit:
        sides.append(rf"{after} {result}\ \mathrm{{{equation.unit.translate(UNITS_IN_LATEX)}}}")
    elif result:
        sides.append(f"{after} {result} {equation.unit}".rstrip())
    return sides


def _equation_lines(equation: Equation, width: int, label: str) -> list[str]:
    """Return an equation in one line if it fits, else in a line for each of its sides."""
    left = written(equation.left)
    first, *others = chain(equation)
    whole = f"{label}{left} {' '.join([first, *others])}"
    if len(whole) <= width:
        return [whole]
    room = len(label) + len(left) + 1
    indent = " " * (room if room <= width // 3 else 4)
    lines = wrapped(f"{left} {first}", width, label, indent + "  ")
    for side in others:
        lines += wrapped(side, width, indent, indent + "  ")
    return lines


def _aligned(equation: Equation) -> str:
    """Return an equation in LaTeX, its = signs below each other."""
    left, sides = written(equation.left, latex=True), chain(equation, latex=True)
    if len(sides) == 1:
        return f"{left} {sides[0]}"
    rows = " \\\\\n".join(f"&{side}" for side in sides)
    return f"\\begin{{aligned}}\n{left} {rows}\n\\end{{aligned}}"


IN_PROSE = (
    {name: f"`{about.letters}`" for name, about in QUANTITIES.items() if name not in INPUTS}
    # Names of one or two letters are symbols themselves.
    | {name: f"{about.axis} `{about.symbol}`" for name, about in (INPUTS | MEASURED).items() if len(name) > 2}
    | {"mu": "`μ`", "mu_k": "`μ_k`", "axle": "axle friction", "inf": "`∞`", "--M inf": "`M` = `∞`"}
)
"""Symbols for names of the program; a name that is not here is its own symbol."""
