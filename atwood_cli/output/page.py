"""Tables and sentences on the terminal or in a pipe, by rich, which is imported only when it is needed."""

import re
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from itertools import chain, islice
from shutil import get_terminal_size
from time import monotonic
from typing import Any, TypeVar

from ..numbers.text import counted
from .files import printable
from .text import is_number, markdown_table, wrapped

Part = TypeVar("Part")
Groups = Sequence[Sequence[Sequence[str]]]
"""Groups of rows of cells."""

MOST_WIDTH = 80
"""The width of sentences, in characters, on a wider terminal and in a pipe."""


class Page:
    """A printer of tables and sentences, to a terminal or to a pipe, which takes any width."""

    def __init__(self, is_plain: bool = False, is_markdown: bool = False) -> None:
        """Make a page for standard output, without colours if it ``is_plain``, or as Markdown."""
        from rich.console import Console

        self.is_markdown = is_markdown
        # rich itself would take COLUMNS=0 at its word, and any dumb terminal to be 80 columns wide.
        width, height = get_terminal_size()
        # FORCE_COLOR concerns the terminal, not the file of --output.
        force = None if is_plain or sys.stdout is sys.__stdout__ else False
        colours: Any = None if is_plain else "auto"
        self.console = Console(
            highlight=False, color_system=colours, force_terminal=force, width=width, height=height
        )
        self.room = self.console.width if self.console.is_terminal else None
        self.width = min(self.room or MOST_WIDTH, MOST_WIDTH)

    def say(self, *sentences: str, style: str = "") -> None:
        """Print sentences, in lines no longer than the terminal is wide, nor than a page."""
        if self.is_markdown:
            print("".join(f"{printable(words)}\n\n" for words in sentences), end="")
            return
        for words in sentences:
            for line in wrapped(printable(words), self.width):
                self.line(line, style)

    def heading(self, words: str) -> None:
        """Print the heading of a step."""
        if self.is_markdown:
            self.say(f"## {words}")
        else:
            self.line("")
            self.line(words, "bold")

    def line(self, words: str, style: str = "") -> None:
        """Print a line as it is, however long."""
        from rich.text import Text

        self.console.print(Text(printable(words), style), soft_wrap=True)

    def table(self, columns: Sequence[str], groups: Groups, keys: int = 1) -> None:
        """Print a table, with a line between groups of rows.

        On a terminal it is no wider than that: words are wrapped at blanks, and columns for which there is
        no room follow below, with the first ``keys`` columns again. Numbers and names are never broken.
        """
        rows = [[printable(word, keep="") for word in row] for row in chain.from_iterable(groups)]
        if self.is_markdown:
            print(*markdown_table([columns, *rows]), sep="\n", end="\n\n")
            return
        heads, cells = [printable(head) for head in columns], list(zip(*rows, strict=True))
        widths, blocks = list(map(_widest, heads, cells)), [list(range(len(heads)))]
        if self.room and _width(widths) > self.room:
            heads = [re.sub("_(?=[a-z])", "_\n", head) for head in heads]
            widths = list(map(_narrowest, heads, cells))
            blocks = _blocks(widths, keys, self.room)
        sizes = list(map(len, groups))
        for block in blocks:
            self._print_table([(heads[i], cells[i], widths[i]) for i in block], sizes)

    def _print_table(self, columns: Sequence[tuple[str, Sequence[str], int]], sizes: Sequence[int]) -> None:
        """Print columns, each a heading, cells and the least width, in groups of these numbers of rows."""
        from rich import box
        from rich.table import Table
        from rich.text import Text

        self.console.width = max(self.console.width, _width(width for *_, width in columns))
        table = Table(box=box.ROUNDED)
        wraps = [_widest("", cells) > width for _, cells, width in columns]
        for (head, _, width), wrap in zip(columns, wraps, strict=True):
            # Not as markup, which a file's heading may look like.
            table.add_column(Text(head), no_wrap=not wrap, min_width=width)
        left = zip(*(cells for _, cells, _ in columns), strict=True)
        for size in sizes:
            lines = list(islice(left, size))
            # Rows are joined if none is wrapped, as rich takes five times as long over single ones.
            parts = [[line] for line in lines] if any(wraps) else [lines]
            for number, part in enumerate(parts, 1):
                joined = (Text("\n".join(column)) for column in zip(*part, strict=True))
                table.add_row(*joined, end_section=number == len(parts))
        self.console.print(table, crop=False)


def _width(columns: Iterable[int]) -> int:
    """Return the width of a table with columns of these widths."""
    return 1 + sum(3 + width for width in columns)


def _widest(head: str, cells: Iterable[str]) -> int:
    return max(len(line) for words in (head, *cells) for line in words.split("\n"))


def _narrowest(head: str, cells: Sequence[str]) -> int:
    """Return the least width of a column: only words may be wrapped, and only at blanks."""
    if any(map(is_number, cells)):
        return _widest(head, cells)
    return _widest(head, chain.from_iterable(cell.split(" ") for cell in cells))


def _blocks(widths: Sequence[int], keys: int, room: int) -> list[list[int]]:
    """Return the columns of tables that stand below each other, each with the first ``keys`` columns."""
    first = list(range(keys))
    blocks = [first]
    for column in range(keys, len(widths)):
        block = blocks.pop()
        if block != first and _width(widths[i] for i in (*block, column)) > room:
            blocks.append(block)
            block = first
        blocks.append([*block, column])
    return blocks


@contextmanager
def progress(
    parts: Iterator[Part],
    total: int | None,
    size: Callable[[Part], int] = lambda part: 1,
    rows: Callable[[Part], int] | None = None,
) -> Iterator[Iterator[Part]]:
    """Pass the parts on, with a bar on a terminal's stderr once they take longer than a second.

    The bar shows the share of ``total`` by the ``size`` of parts, and counts their ``rows`` if they have any.
    """
    start = monotonic()

    def passed_on(stack: ExitStack) -> Iterator[Part]:
        done, count, bar = 0, 0, None
        for part in parts:
            yield part
            done += size(part)
            count += rows(part) if rows else 0
            so_far = counted(count, "row") if rows else ""
            if bar:
                bar.update(bar.task_ids[0], completed=done, description=so_far)
            elif monotonic() - start > 1 and sys.stderr.isatty():
                from rich.console import Console
                from rich.progress import Progress

                console = Console(stderr=True)
                bar = stack.enter_context(Progress(console=console, transient=True, redirect_stdout=False))
                bar.add_task(so_far, total=total, completed=done)

    # Closed here, as Python shows a traceback of a signal that comes while it drops a generator with a bar.
    with ExitStack() as stack:
        yield passed_on(stack)
