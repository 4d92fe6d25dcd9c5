"""Solved scenes as a table, JSON, CSV or bare values. rich is imported only for the table."""

import json
import sys
from collections.abc import Iterable, Mapping, Sequence
from decimal import Decimal
from fractions import Fraction
from itertools import chain
from math import inf
from typing import TYPE_CHECKING, TextIO

from .arithmetic import as_typed, is_infinite, text
from .quantities import NAMES, QUANTITIES
from .scene import PARAMETERS, Radians, Scene
from .solver import Answers
from .words import notes

if TYPE_CHECKING:
    from rich.console import Console

REGIME_STYLES = {"no-slip": "green", "verge": "yellow", "slip": "red"}
ASCII = str.maketrans(
    {"μ": "mu", "φ": "phi", "β": "beta", "π": "pi", "τ": "tau", "α": "alpha", "θ": "theta"}
    | {"₁": "1", "₂": "2", "²": "^2", "°": " deg", "·": "*", "±": "+/-", "≤": "<=", "≥": ">="}
)


def for_stream(words: str, stream: TextIO) -> str:
    """The words as the stream can take them: symbols are spelled out where it is not Unicode."""
    unicode = (stream.encoding or "ascii").lower().startswith("utf")
    return words if unicode else words.translate(ASCII).encode("ascii", "replace").decode()


def print_json(answers: Answers, only: Sequence[str]) -> None:
    """All quantities with scene and notes, or only those named."""
    results: dict[str, object] = {name: answers[name] for name in only or NAMES}
    if not only:
        results = {"scene": _scene(answers.case.scene), **results, "notes": notes(answers)}
    print(_json(results))


def _scene(scene: Scene) -> dict[str, object]:
    """The inputs as JSON has them: numbers in SI units and degrees, or text where JSON has no number."""
    given: dict[str, object] = scene._asdict()
    if scene.M == inf:
        given["M"] = "inf"
    if isinstance(scene.wrap, Radians):
        given["wrap"] = f"{as_typed(scene.wrap)}rad"
    return given


def _json(value: object, indent: str = "\n") -> str:
    inner = indent + "  "
    match value:
        case Mapping():
            items = (f"{json.dumps(key)}: {_json(item, inner)}" for key, item in value.items())
            return f"{{{inner}{f',{inner}'.join(items)}{indent}}}"
        case list():
            items = (_json(item, inner) for item in value)
            return f"[{inner}{f',{inner}'.join(items)}{indent}]"
        case Fraction():
            return as_typed(value)
        case float() | Decimal():
            return "null" if is_infinite(value) else text(value)
    return json.dumps(value)


def print_csv(answers: Answers, only: Sequence[str]) -> None:
    """A line of names and a line of values; a value that does not exist is empty."""
    from csv import writer

    names = only or NAMES
    writer(sys.stdout, lineterminator="\n").writerows([names, [cell(answers[name]) for name in names]])


def cell(value: str | float | Decimal | None) -> str:
    """A value as bare text, empty where it does not exist or no double can hold it."""
    if value is None or isinstance(value, str):
        return value or ""
    return "" if is_infinite(value) else text(value)


def describe(scene: Scene) -> str:
    """The scene in one line, as understood."""
    parts = []
    for name, value in _scene(scene).items():
        if value is not None:
            unit = PARAMETERS[name].unit if isinstance(value, Fraction) else ""
            shown = as_typed(value) if isinstance(value, Fraction) else value
            parts.append(f"{name} = {shown}{' ' * (unit not in ('', '°'))}{unit}")
    return ", ".join(parts)


def print_table(answers: Answers, console: "Console | None" = None) -> None:
    """The scene, the verdict, a table of the quantities that exist, and the notes."""
    from rich.console import Console
    from rich.text import Text

    class OurConsole(Console):
        def on_broken_pipe(self) -> None:
            raise BrokenPipeError  # rich would exit with status 1

    console = console or OurConsole(highlight=False)

    def say(words: str, style: str = "") -> None:
        # Piped, a sentence is a line; on a terminal, lines break between words.
        console.print(Text(for_stream(words, sys.stdout), style), soft_wrap=not console.is_terminal)

    groups = _rows(answers)
    verdict, *others = notes(answers)
    say(describe(answers.case.scene))
    say(verdict, f"bold {REGIME_STYLES[answers.case.regime]}")
    _print_groups(groups, console)
    for note in others:
        say(note)


COLUMNS = ("Quantity", "Value", "Unit", "Symbol", "Equation")


def _rows(answers: Answers) -> list[list[dict[str, str]]]:
    """The cells of the table by column, a row for each quantity that exists, by group."""
    values = {name: shown for name in QUANTITIES if (shown := cell(answers[name]))}
    point = max(map(_integer_part, values.values()))
    groups: dict[str, list[dict[str, str]]] = {}
    for name, value in values.items():
        about = QUANTITIES[name]
        in_slip = answers.case.regime == "slip" and about.equation_in_slip is not None
        row = (
            name,
            " " * (point - _integer_part(value)) + value,
            about.unit,
            about.symbol,
            about.equation_in_slip if in_slip else about.equation,
        )
        words = (for_stream(word or "", sys.stdout) for word in row)
        groups.setdefault(about.group, []).append(dict(zip(COLUMNS, words, strict=True)))
    return list(groups.values())


def _width(groups: list[list[dict[str, str]]], columns: Sequence[str]) -> int:
    """The width of the table with those columns, told ten times as fast as by rich."""
    cells = [{c: c for c in columns}, *chain.from_iterable(groups)]
    return 1 + sum(3 + max(len(row[c]) for row in cells) for c in columns)


def _print_groups(groups: list[list[dict[str, str]]], console: "Console") -> None:
    """The table with the columns that a terminal has room for, or else a plain line a quantity."""
    from rich import box
    from rich.table import Table
    from rich.text import Text

    columns = list(COLUMNS)
    while (width := _width(groups, columns)) > console.width and console.is_terminal:
        columns.pop()
        if len(columns) < 2:
            for row in chain.from_iterable(groups):
                console.out(f"{row['Quantity']} = {row['Value'].lstrip()} {row['Unit']}".rstrip())
            return
    table = Table(*columns, box=box.ROUNDED, show_lines=True)
    for group in groups:
        # One row a group, its lines joined: rich takes five times as long over a row a quantity.
        table.add_row(*(Text("\n".join(row[c] for row in group)) for c in columns))
    console.width = max(console.width, width)
    console.print(table)


def _integer_part(value: str) -> int:
    return len(value.partition(".")[0].partition("e")[0])


def print_only(answers: Answers, only: Iterable[str]) -> None:
    """Bare values, one a line, nothing for one that does not exist."""
    for name in only:
        if shown := cell(answers[name]):
            print(shown)
