"""Solved scenes as a table, JSON, CSV or bare values. rich is imported only for the table."""

import json
import sys
from collections.abc import Iterable, Mapping, Sequence
from decimal import Decimal
from fractions import Fraction
from itertools import chain
from math import inf
from typing import TYPE_CHECKING, TextIO

from .quantities import NAMES, QUANTITIES
from .rounding import as_typed, is_infinite, text
from .scene import PARAMETERS, Radians, Scene
from .solver import Answers
from .words import notes, verdict

if TYPE_CHECKING:
    from rich.console import Console

    from .contact import Contact
    from .elements import Elements

COLUMN_UNITS = {
    "angle": "°",
    "tension": "N",
    "normal_per_radian": "N/rad",
    "friction_per_radian": "N/rad",
    "normal_per_metre": "N/m",
    "friction_per_metre": "N/m",
}
REGIME_STYLES = {"no-slip": "green", "verge": "yellow", "slip": "red"}
ASCII = str.maketrans(
    {"μ": "mu", "φ": "phi", "β": "beta", "π": "pi", "τ": "tau", "α": "alpha", "θ": "theta"}
    | {"₁": "1", "₂": "2", "²": "^2", "°": "deg", "·": "*", "±": "+/-", "≤": "<=", "≥": ">="}
)


def for_stream(words: str, stream: TextIO | None) -> str:
    """The words as the stream can take them: symbols are spelled out where it is not Unicode."""
    encoding = getattr(stream, "encoding", None) or "ascii"
    unicode = encoding.lower().startswith("utf")
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
    print_records_csv([{name: answers[name] for name in only or NAMES}])


def cell(value: object) -> str:
    """A value as bare text, empty where it does not exist or no double can hold it."""
    if isinstance(value, float | Decimal):
        return "" if is_infinite(value) else text(value)
    return str(value or "")


def describe(scene: Scene) -> str:
    """The scene in one line, as understood."""
    parts = []
    for name, value in _scene(scene).items():
        if value is not None:
            unit = PARAMETERS[name].unit if isinstance(value, Fraction) else ""
            shown = as_typed(value) if isinstance(value, Fraction) else value
            parts.append(f"{name} = {shown}{' ' * (unit not in ('', '°'))}{unit}")
    return ", ".join(parts)


class Page:
    """Where tables and sentences go: the terminal, or a pipe that takes any width."""

    def __init__(self, console: "Console | None" = None) -> None:
        from rich.console import Console

        self.console = console or Console(highlight=False)
        self.room = self.console.width if self.console.is_terminal else None

    def say(self, words: str, style: str = "") -> None:
        """A sentence: piped it is a line, on a terminal its lines break between words."""
        from rich.text import Text

        self.console.print(Text(for_stream(words, sys.stdout), style), soft_wrap=self.room is None)

    def head(self, answers: Answers) -> None:
        """The scene and the verdict."""
        self.say(describe(answers.case.scene))
        self.say(verdict(answers), f"bold {REGIME_STYLES[answers.case.regime]}")

    def table(self, columns: Sequence[str], groups: Sequence[Sequence[Sequence[str]]]) -> None:
        """A table, with a line between groups of rows, and as wide as its numbers ask.

        Columns that a terminal has no room for go into a table below, beside the first column again.
        """
        from rich import box
        from rich.table import Table
        from rich.text import Text

        fit = len(columns)
        while self.room and fit > 2 and _width(columns[:fit], groups) > self.room:
            fit -= 1
        if fit < len(columns):
            for part in (slice(1, fit), slice(fit, None)):
                rows = [[[row[0], *row[part]] for row in group] for group in groups]
                self.table([columns[0], *columns[part]], rows)
            return
        table = Table(*columns, box=box.ROUNDED, show_lines=True)
        for group in groups:
            # One row a group, its lines joined: rich takes five times as long over a row a line.
            table.add_row(*(Text("\n".join(column)) for column in zip(*group, strict=True)))
        room = self.console.width
        self.console.width = max(room, _width(columns, groups))
        self.console.print(table)
        self.console.width = room


def print_table(answers: Answers, console: "Console | None" = None) -> None:
    """The scene, the verdict, a table of the quantities that exist, and the notes."""
    page = Page(console)
    groups = _rows(answers)
    _, *others = notes(answers)
    page.head(answers)
    columns = list(COLUMNS)
    while page.room and _width(columns, groups) > page.room:
        columns.pop()
        groups = [[row[: len(columns)] for row in group] for group in groups]
    if groups and len(columns) > 1:
        page.table(columns, groups)
    else:  # not even two columns fit: a plain line a quantity
        for name, value, unit, *_ in chain.from_iterable(_rows(answers)):
            page.console.out(f"{name} = {value.lstrip()} {unit}".rstrip())
    for note in others:
        page.say(note)


COLUMNS = ("Quantity", "Value", "Unit", "Symbol", "Equation")


def _rows(answers: Answers) -> list[list[list[str]]]:
    """The cells of the table, a row for each quantity that exists, by group."""
    values = {name: shown for name in QUANTITIES if (shown := cell(answers[name]))}
    groups: dict[str, list[list[str]]] = {}
    for name, value in zip(values, _aligned(values.values()), strict=True):
        about = QUANTITIES[name]
        equation = about.equation
        if answers.case.regime == "slip" and about.equation_in_slip is not None:
            equation = about.equation_in_slip
        row = [name, value, about.unit, about.symbol, equation]
        groups.setdefault(about.group, []).append([for_stream(word, sys.stdout) for word in row])
    return list(groups.values())


def _aligned(numbers: Iterable[str]) -> list[str]:
    """The numbers with their decimal points below each other."""
    numbers = list(numbers)
    point = max(map(_integer_part, numbers), default=0)
    return [" " * (point - _integer_part(number)) + number for number in numbers]


def _width(columns: Sequence[str], groups: Sequence[Sequence[Sequence[str]]]) -> int:
    """The width of the table with those columns, told ten times as fast as by rich."""
    rows = [columns, *chain.from_iterable(groups)]
    return 1 + sum(3 + max(len(row[i]) for row in rows) for i in range(len(columns)))


def print_arc(answers: Answers, arc: "Contact") -> None:
    """The scene, the verdict, the points along the arc, the balance of forces, and the notes."""
    page = Page()
    page.head(answers)
    heads = [f"{name.partition('_per_')[0]} ({COLUMN_UNITS[name]})" for name in arc.points[0]]
    columns = [_aligned(cell(point[name]) for point in arc.points) for name in arc.points[0]]
    page.table([for_stream(head, sys.stdout) for head in heads], [list(zip(*columns, strict=True))])
    names, forces = zip(*((name, row) for name, row in arc.balance.items() if "x" in row), strict=True)
    xs, ys = (_aligned(cell(force[axis]) for force in forces) for axis in "xy")
    force_rows = list(zip(names, xs, ys, strict=True))
    page.table(["Force on the pulley", "x (N)", "y (N)"], [force_rows[:2], force_rows[2:]])
    unit = "N m" if answers.case.scene.R is not None else "N, per unit radius"
    torques = _aligned(map(cell, arc.balance["torque"].values()))
    kinds = ("friction along the arc", "R (T2 - T1)", "residual")
    page.table([f"Torque on the pulley ({unit})", ""], [list(zip(kinds, torques, strict=True))])
    for note in arc.notes:
        page.say(note)


def print_arc_json(answers: Answers, arc: "Contact") -> None:
    """Scene, regime, profile, points, balance and notes."""
    print(
        _json(
            {
                "scene": _scene(answers.case.scene),
                "regime": answers.case.regime,
                "profile": arc.kind,
                "points": arc.points,
                "balance": arc.balance,
                "notes": [verdict(answers), *arc.notes],
            }
        )
    )


def print_records_csv(records: Sequence[Mapping[str, object]]) -> None:
    """A line of names and a line for each record."""
    from csv import writer

    rows = [[cell(value) for value in record.values()] for record in records]
    writer(sys.stdout, lineterminator="\n").writerows([list(records[0]), *rows])


def print_elements(answers: Answers, found: "Elements") -> None:
    """What the elements give beside the exact values, and the notes."""
    page = Page()
    page.head(answers)
    names, errors = [row.name for row in found.rows], [cell(row.error) for row in found.rows]
    values, exact = (_aligned(cell(row[i]) for row in found.rows) for i in (1, 2))
    page.table(
        ["Quantity", "Elements", "Exact", "Relative error"],
        [list(zip(names, values, exact, errors, strict=True))],
    )
    for note in found.notes:
        page.say(note)


def print_elements_json(answers: Answers, found: "Elements") -> None:
    """Scene, regime, the rows by name, and the notes."""
    rows = {row.name: {"value": row.value, "exact": row.exact, "error": row.error} for row in found.rows}
    scene, notes = _scene(answers.case.scene), [verdict(answers), *found.notes]
    print(_json({"scene": scene, "regime": answers.case.regime, "elements": rows, "notes": notes}))


def _integer_part(value: str) -> int:
    return len(value.partition(".")[0].partition("e")[0])


def print_only(answers: Answers, only: Iterable[str]) -> None:
    """Bare values, one a line, nothing for one that does not exist."""
    for name in only:
        if shown := cell(answers[name]):
            print(shown)
