"""A solved scene as tables and JSON show it."""

import sys
from collections.abc import Sequence
from html import escape
from itertools import chain, groupby
from typing import TYPE_CHECKING

from ..arithmetic.rounding import to_digits, to_place, with_uncertainty
from ..model.quantities import MEASURED_NAMES, QUANTITIES, cited
from ..solver.answers import Answers
from ..solver.messages import conditions, notes, reasons, remarks, unmarked, verdict
from .text import VERSION, cell, describe, for_stream, scene_record

if TYPE_CHECKING:
    from rich.console import Console

    from .page import Page


def record(answers: Answers, only: Sequence[str] = (), budget: bool = False) -> dict[str, object]:
    """The record for JSON: all quantities with scene and notes, or only those named."""
    names = only or answers.names
    results: dict[str, object] = {name: answers[name] for name in names}
    uncertainty = answers.standard_uncertainties(names) or None
    shares = {name: answers.budget(name) or None for name in names if name != "regime"} if budget else None
    beside = {"uncertainty": uncertainty, "budget": shares}
    if only:
        return results | {name: one for name, one in beside.items() if one is not None}
    absent = dict.fromkeys(QUANTITIES)
    return {
        "version": VERSION,
        "scene": scene_record(answers.case.scene, answers.case.motion, answers.round),
        "regime": answers.case.regime,
        **absent,
        **results,
        **{name: one and absent | one for name, one in beside.items()},
        "notes": notes(answers),
    }


def beside_bare(answers: Answers, only: Sequence[str]) -> list[str]:
    """The uncertain values with their uncertainties, which bare values leave out."""
    uncertain = [name for name in only if answers.standard_uncertainties([name]).get(name)]
    return [_stated(answers, name) for name in uncertain]


COLUMNS = ("Quantity", "Value", "Unit", "Symbol", "Equation")
AT_LIMIT = ("friction_force", "friction_force_x", "friction_force_y")
"""What is one number only where friction is at its limit."""


def print_table(
    answers: Answers, whole: bool = False, budget: bool = False, console: "Console | None" = None
) -> None:
    """Print the scene, what was found, the verdict, quantities, main or ``whole``, notes, and the budget."""
    from .page import Page, table_width

    answers, page, columns = answers.shown, Page(console), list(COLUMNS)
    names = answers.names[1:] if whole else answers.main
    found, groups, said = _parts(answers, names, whole)
    rows = [*chain.from_iterable(groups)]
    page.head(answers, found)
    while page.room and table_width(columns, groups) > page.room:
        columns.pop()
        groups = [[row[: len(columns)] for row in group] for group in groups]
    if groups and "Unit" in columns:
        page.table(columns, groups)
    else:  # no number without its unit: a plain line a quantity
        page.say(*(f"{name} = {value.strip()} {unit}".rstrip() for name, value, unit, *_ in rows))
    page.say(*said)
    if budget:
        _print_budget(page, answers, names)


def _parts(
    answers: Answers, names: Sequence[str], whole: bool
) -> tuple[list[str], list[list[list[str]]], list[str]]:
    """What was found, in sentences; the rows of the table, by group; and the sentences below it."""
    groups = _rows(answers, [name for name in names if name not in (*MEASURED_NAMES, *answers.found)])
    found = _found(answers)
    said = [*remarks(answers), *(conditions(answers) if whole else ()), *reasons(answers)]
    return found, groups, [unmarked(one) for one in said if one not in found]


def _found(answers: Answers) -> list[str]:
    """Sentences on what follows from what was measured; one may say that no pulley does."""
    found = [_stated(answers, name) for name in answers.found if cell(answers[name])]
    none = answers.case.motion.beyond
    said = [one for one in reasons(answers) if none and none in one]
    return [*said, *[f"Found: {', '.join(found)}."] * bool(found)]


def as_text(answers: Answers) -> str:
    """The same page as text, in the symbols and the width of where the program prints, without colours."""
    from shutil import get_terminal_size

    from rich.console import Console

    width, height = get_terminal_size()
    console = Console(highlight=False, color_system=None, width=width, height=height)
    with console.capture() as captured:
        print_table(answers, console=console)
    return captured.get().rstrip("\n")


def as_html(answers: Answers) -> str:
    """The same for a notebook."""
    answers = answers.shown
    scene, motion, known = answers.case.scene, answers.case.motion, answers.uncertainties
    found, groups, said = _parts(answers, answers.main, whole=False)
    head = [describe(scene, motion, known.given if known else {}), *found, unmarked(verdict(answers))]
    rows = [_html_row(row, "td") for row in chain.from_iterable(groups)]
    table = ["<table>", _html_row(COLUMNS, "th"), *rows, "</table>"] if rows else []
    return "\n".join([*map(_html_paragraph, head), *table, *map(_html_paragraph, said)])


def _html_paragraph(words: str) -> str:
    return f"<p>{escape(words)}</p>"


def _html_row(row: Sequence[str], tag: str) -> str:
    """A row of the table without its last column, the equations."""
    return f"<tr>{''.join(f'<{tag}>{escape(word.strip())}</{tag}>' for word in row[:-1])}</tr>"


def _rows(answers: Answers, names: Sequence[str]) -> list[list[list[str]]]:
    """The cells of the table: a row for each quantity that exists, by group."""
    from .page import aligned

    values = {name: shown for name in names if (shown := _with_uncertainty(answers, name))}
    groups: dict[str, list[list[str]]] = {}
    for name, value in zip(values, aligned(values.values()), strict=True):
        about, case = QUANTITIES[name], answers.case
        equation = cited(name, case.regime == "slip", case.axle_friction is not None)
        at = " at mu_verge" * (name in AT_LIMIT and case.mu_assumed)
        row = [f"{name}{at}", value, about.unit, about.symbol, equation]
        groups.setdefault(about.group, []).append([for_stream(word, sys.stdout) for word in row])
    return list(groups.values())


def _stated(answers: Answers, name: str) -> str:
    """A quantity with its value, uncertainty and unit."""
    return f"{name} = {_with_uncertainty(answers, name)} {QUANTITIES[name].unit}".rstrip()


def _with_uncertainty(answers: Answers, name: str) -> str:
    """A value, and its uncertainty if it has one; empty if it does not exist."""
    shown = cell(answers[name])
    u = answers.uncertainty(name, to_digits(2)) if shown else None
    return with_uncertainty(lambda place: answers.rounded(name, to_place(place)), u) if u else shown


def _print_budget(page: "Page", answers: Answers, names: Sequence[str]) -> None:
    """Each uncertain input's share of the variance of each quantity."""
    from .page import aligned

    page.say("Each input's share of the variance, in percent:")
    shares = {name: one for name in names if (one := answers.budget(name, to_place(-1)))}
    inputs = list(answers.uncertainties.given) if answers.uncertainties else []
    columns = [aligned(str(one[x]) for one in shares.values()) for x in inputs]
    rows = ([name, *cells] for name, *cells in zip(shares, *columns, strict=True))
    by_group = groupby(rows, lambda row: QUANTITIES[row[0]].group)
    page.table(["Quantity", *inputs], [list(group) for _, group in by_group])
