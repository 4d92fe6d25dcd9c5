"""Tables and sentences on the terminal or in a pipe, by rich, which is imported where they are needed."""

import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import chain, groupby, zip_longest
from shutil import get_terminal_size
from time import monotonic
from typing import TYPE_CHECKING, TypeVar

from ..solver.answers import Answers
from ..solver.messages import unmarked, verdict
from .text import describe, for_stream, spelled, wrapped

if TYPE_CHECKING:
    from rich.console import Console

    from ..derivation.steps import Explanation

T = TypeVar("T")
Groups = Sequence[Sequence[Sequence[str]]]
"""The rows of a table, each a row of cells, in groups."""

PIPED, READABLE, NARROWEST = 100, 80, 40
"""Columns of text: where there is no terminal, and the most and the least of a derivation."""
FRAME = 5
"""Lines of a table with one line of heads, beside its rows."""
REGIME_STYLES = {"no-slip": "green", "verge": "yellow", "slip": "red"}


class Page:
    """Where tables and sentences go: the terminal, or a pipe that takes any width."""

    def __init__(self, console: "Console | None" = None) -> None:
        from rich.console import Console

        # rich itself takes COLUMNS=0 at its word, and every dumb terminal for one of 80 columns.
        width, height = get_terminal_size()
        # FORCE_COLOR is for what a terminal is shown, not for the file of --output.
        force = None if sys.stdout is sys.__stdout__ else False
        self.console = console or Console(highlight=False, force_terminal=force, width=width, height=height)
        self.room = self.console.width if self.console.is_terminal else None
        self.width = self.room or PIPED

    def say(self, *sentences: str, style: str = "") -> None:
        """Sentences, in lines no longer than the terminal is wide, or than a page in a pipe."""
        for line in self.lines(*sentences):
            self.line(line, style)

    def lines(self, *sentences: str) -> list[str]:
        """The lines of sentences."""
        return [line for words in sentences for line in wrapped(for_stream(words, sys.stdout), self.width)]

    def line(self, words: str, style: str = "") -> None:
        """A line as it is, however long."""
        from rich.text import Text

        self.console.print(Text(for_stream(words, sys.stdout), style), soft_wrap=True)

    def head(self, answers: Answers, found: Sequence[str] = ()) -> None:
        """The scene, sentences on what was found of it, and the verdict."""
        scene, motion, known = answers.case.scene, answers.case.motion, answers.uncertainties
        self.say(describe(scene, motion, known.given if known else {}))
        self.say(*found, style="bold")
        bold = "bold " * (not found)
        self.say(unmarked(verdict(answers)), style=f"{bold}{REGIME_STYLES[answers.case.regime]}")

    def table(self, columns: Sequence[str], groups: Groups, keys: int = 1, beside: int | None = None) -> int:
        """A table, with a line between groups of rows, and as wide as its numbers ask.

        Columns for which there is no room go into a table below, beside the first ``keys`` again. Where
        ``beside`` says how many other lines a terminal is to show, rows in the middle are left out until
        all fits. Returns how many.
        """
        from rich import box
        from rich.table import Table
        from rich.text import Text

        tables, left_out = list(self._parts(columns, groups, keys)), 0
        for heads, rows in tables:
            if beside is not None and self.room and sys.stdout.isatty():
                rows, left_out = _shortened(rows, (self.console.height - beside) // len(tables) - FRAME)
            table = Table(box=box.ROUNDED, show_lines=True)
            for head in heads:
                table.add_column(Text(head))  # not as markup, which a file's heading may look like
            for group in rows:
                # One row a group, its lines joined: rich takes five times as long over a row a line.
                table.add_row(*(Text("\n".join(column)) for column in zip(*group, strict=True)))
            width = self.console.width
            self.console.width = max(width, table_width(heads, rows))
            self.console.print(table)
            self.console.width = width
        return left_out

    def _parts(
        self, columns: Sequence[str], groups: Groups, keys: int
    ) -> Iterator[tuple[Sequence[str], Groups]]:
        """The table, divided so that each part fits the width, if one column beside the keys does."""
        columns = [for_stream(head, sys.stdout) for head in columns]
        groups = [
            [[for_stream(word, sys.stdout).replace("\n", r"\n") for word in row] for row in group]
            for group in groups
        ]
        fit = len(columns)
        while fit > keys + 1 and table_width(columns[:fit], groups) > self.width:
            fit -= 1
        if fit == len(columns):
            yield columns, groups
            return
        for part in (slice(keys, fit), slice(fit, None)):
            rows = [[[*row[:keys], *row[part]] for row in group] for group in groups]
            yield from self._parts([*columns[:keys], *columns[part]], rows, keys)


def print_explanation(given: Sequence[str], explanation: "Explanation", markdown: bool) -> None:
    """A derivation, step by step: on a terminal in its columns, or as Markdown."""
    from ..derivation.typeset import as_markdown, as_text

    if markdown:
        for line in as_markdown(given, explanation):
            print(for_stream(line, sys.stdout))
        return
    page = Page()
    width = max(NARROWEST, min(READABLE, page.room or READABLE))
    for line, style in as_text(given, explanation, width, lambda words: spelled(words, sys.stdout)):
        page.line(line, style)


def table_width(columns: Sequence[str], groups: Groups) -> int:
    """The width of a table, computed ten times as fast as by rich."""
    rows = [
        *zip_longest(*(column.split("\n") for column in columns), fillvalue=""),
        *chain.from_iterable(groups),
    ]
    return 1 + sum(3 + max(len(row[i]) for row in rows) for i in range(len(columns)))


def aligned(numbers: Iterable[str]) -> list[str]:
    """The numbers with their decimal points below each other; words are left as they are."""
    numbers = list(numbers)
    point = max(map(_integer_part, numbers), default=0)
    return [" " * (point - _integer_part(one)) + one if _is_number(one) else one for one in numbers]


def _is_number(value: str) -> bool:
    return value.lstrip("(+-.")[:1].isdigit()


def _integer_part(value: str) -> int:
    return len(value.partition(" ")[0].partition(".")[0].partition("e")[0]) if _is_number(value) else 0


def _shortened(groups: Groups, room: int) -> tuple[Groups, int]:
    """The first and the last rows, as many as so many lines hold, and how many rows are left out."""
    lines = [line for group in groups for line in (*group, None)][:-1]  # None is the line between groups
    if len(lines) <= room:
        return groups, 0
    half = max((room - 3) // 2, 1)
    kept = [*lines[:half], None, ["..."] * len(groups[0][0]), None, *lines[-half:]]
    shown = [[line for line in part if line] for is_row, part in groupby(kept, bool) if is_row]
    return shown, sum(map(len, groups)) + 1 - sum(map(len, shown))


def watched(parts: Iterator[T], total: int | None, size: Callable[[T], int] = lambda _: 1) -> Iterator[T]:
    """The parts, with a bar on a terminal's stderr once they take longer than a second."""
    start, done = monotonic(), 0
    for part in parts:
        yield part
        done += size(part)
        if monotonic() - start > 1 and sys.stderr.isatty():
            break
    else:
        return
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True, redirect_stdout=False) as bar:
        task = bar.add_task("", total=total, completed=done)
        for part in parts:
            yield part
            bar.advance(task, size(part))
