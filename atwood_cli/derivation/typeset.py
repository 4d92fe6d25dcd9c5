"""A derivation on a page: as plain text for a terminal, and as Markdown with LaTeX for a handout."""

import re
from collections.abc import Callable, Iterator
from textwrap import wrap

from ..arithmetic.symbolic import in_latex, math, written
from .equations import HELD, Equation, Law, Part
from .steps import Explanation

Spell = Callable[[str], str]


def as_text(scene: str, told: Explanation, width: int, spell: Spell = str) -> Iterator[tuple[str, str]]:
    """Lines, and a style for each, of at most that width but for what has no blank to break at.

    Symbols are as ``spell`` has them.
    """
    room = max(len(part.label) for step in told.steps for part in step.body if not isinstance(part, str))
    for words, style in ((scene, ""), *((words, "bold") for words in told.answer), (told.reading, "")):
        yield from ((line, style) for line in wrapped(spell(in_text(words)), width))
    for number, step in enumerate(told.steps, 1):
        yield "", ""
        yield f"{number}. {step.title}", "bold"
        for part in step.body:
            if isinstance(part, str):
                first, later = ("  ", "    ") if is_item(part) else ("", "")
                lines = wrapped(spell(in_text(part)), width, first, later)
            else:
                lines = _equation_lines(part, width, spell, f"  {part.label:<{room}} ")
            yield from ((line, "") for line in lines)


def is_item(part: Part) -> bool:
    return isinstance(part, str) and part.startswith("- ")


def wrapped(words: str, width: int, first: str = "", later: str = "") -> list[str]:
    """The words in lines, which break at blanks only: a number stays whole."""
    lines = wrap(
        words,
        width,
        initial_indent=first,
        subsequent_indent=later,
        break_long_words=False,
        break_on_hyphens=False,
    )
    return [line.replace(HELD, " ") for line in lines]


def in_text(words: str) -> str:
    """A sentence without its backticks; no line breaks between them, nor beside an = sign."""
    pieces = words.split("`")
    pieces[1::2] = [piece.replace(" ", HELD) for piece in pieces[1::2]]
    return "".join(pieces).replace(" = ", f"{HELD}={HELD}")


def chain(equation: Equation, latex: bool = False) -> list[str]:
    """The sides of an equation from left to right: symbols, numbers put in, result."""
    unit = equation.unit
    if latex:
        unit = unit and rf"\ \mathrm{{{unit.replace('²', '^2').replace(' ', '~')}}}"
    before, after = (sign.replace("≈", r"\approx") if latex else sign for sign in equation.signs)
    sides = [f"= {written(equation.formula, None, latex)}"]
    if equation.numbers is not None:
        sides.append(f"{before} {written(equation.formula, equation.numbers, latex)}")
    result = in_latex(equation.result) if latex else equation.result
    sides.append(f"{after} {result}{'' if latex or not unit else ' '}{unit}")
    return sides


def _equation_lines(part: Law | Equation, width: int, spell: Spell, label: str) -> list[str]:
    if isinstance(part, Law):
        return wrapped(spell(part.words), width, label, " " * (len(label) + 2))
    left, sides = spell(part.left), [spell(side) for side in chain(part)]
    whole = f"{label}{left} {' '.join(sides)}"
    if len(whole) <= width:
        return [whole]
    indent = " " * (len(label) + len(left) + 1)
    if len(indent) > width // 3:
        indent = " " * 4
    first, *others = sides
    lines = wrapped(f"{left} {first}", width, label, indent + "  ")
    for side in others:
        lines += wrapped(side, width, indent, indent + "  ")
    return lines


def as_markdown(scene: str, told: Explanation) -> Iterator[str]:
    """A page of Markdown, its mathematics in LaTeX between dollars."""
    yield "# Atwood's machine, step by step"
    for words in (scene, *told.answer, told.reading):
        yield ""
        yield in_markdown(words)
    for number, step in enumerate(told.steps, 1):
        yield ""
        yield f"## {number}. {step.title}"
        for before, part in zip(["", *step.body], step.body, strict=False):
            if not is_item(part) or not is_item(before):
                yield ""
            if isinstance(part, str):
                yield in_markdown(part)
            else:
                tag = rf" \tag{{{part.label.replace('(', '').replace(')', '')}}}" if part.label else ""
                yield f"$$\n{_aligned(part)}{tag}\n$$"


def _aligned(part: Law | Equation) -> str:
    if isinstance(part, Law):
        return math(part.words)
    sides = chain(part, latex=True)
    rows = " \\\\\n".join(f"&{side}" for side in sides)
    return f"\\begin{{aligned}}\n{math(part.left)} {rows}\n\\end{{aligned}}"


def in_markdown(words: str) -> str:
    """A sentence with its symbols as mathematics, and no character of it mistaken for markup."""
    pieces = words.split("`")
    pieces[::2] = [re.sub(r"([*_|<>$\\])", r"\\\1", piece) for piece in pieces[::2]]
    pieces[1::2] = [f"${math(piece)}$" for piece in pieces[1::2]]
    return "".join(pieces).replace(HELD, " ")
