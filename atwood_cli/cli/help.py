"""Help as plain text, without rich: examples first, options by group, nothing cut off at any width.

HELP in the module of a command is its text: paragraphs, and commands, a line each, after a line that ends
in a colon. It is no docstring, as ``python -OO`` has none. LISTED, if a module has it, is a heading and
lines of a name, a tab and its meaning, which come last.
"""

import os
import re
import shutil
import sys
from collections.abc import Iterator
from textwrap import wrap
from typing import Any

from ..output.text import for_stream

NARROWEST, WIDEST = 24, 100
LEAST_BESIDE = 40
"""Columns: if fewer are left beside the names of options, their meaning stands below them."""
LONGEST_NAME, BELOW = 28, 6
LAST = ("Output", "Files", "String elements", "Help")
"""Groups of options that stand behind a command's own."""


def page(command: Any, context: Any) -> str:
    """The help of a command, for stdout as it is."""
    commands = getattr(command, "commands", {})
    arguments = [param.metavar for param in command.params if not param.opts[0].startswith("-")]
    usage = " ".join([context.command_path, *["COMMAND"] * bool(commands), *arguments, "[OPTIONS]"])
    parts = [[f"Usage: {usage}"], *_paragraphs(command)]
    if commands:
        rows = [(name, " ".join(one.help.split("\n\n")[0].split())) for name, one in commands.items()]
        parts.append(["Commands:", *_pairs(rows)])
    groups: dict[str, list[tuple[str, str]]] = {}
    for param in command.get_params(context):
        panel = getattr(param, "rich_help_panel", None) or ("Help" if context.parent else "Options")
        groups.setdefault(panel, []).append((_names(param), param.help or ""))
    column = _column([row for rows in groups.values() for row in rows])
    panels = sorted(groups, key=lambda panel: LAST.index(panel) if panel in LAST else -1)
    parts += [[f"{panel}:", *_pairs(groups[panel], column)] for panel in panels]
    if command.epilog:
        head, *rows = command.epilog.splitlines()
        pairs = [(name, meaning) for name, _, meaning in (row.partition("\t") for row in rows)]
        parts.append([head, *_pairs(pairs)])
    return "\n\n".join("\n".join(_heading(for_stream(line, sys.stdout)) for line in part) for part in parts)


def _heading(line: str) -> str:
    """Headings are bold where a terminal can do that; their colon marks them anyway."""
    bold = sys.stdout.isatty() and os.environ.get("TERM", "dumb") not in ("dumb", "unknown")
    is_heading = line.endswith(":") and not line.startswith(" ")
    return f"\x1b[1m{line}\x1b[0m" if bold and is_heading and os.name != "nt" else line


def _width() -> int:
    # One column stays free: some terminals break the line behind a full one.
    return max(NARROWEST, min(shutil.get_terminal_size().columns - 1, WIDEST))


def _paragraphs(command: Any) -> list[list[str]]:
    lines = []
    for paragraph in (command.help or "").split("\n\n"):
        head, *rest = paragraph.replace("\b\n", "").splitlines()
        if head.endswith(":"):
            lines.append([head, *(part for line in rest for part in command_lines(line, _width()))])
        else:
            lines.append(_filled(" ".join([head, *rest])))
    return lines


def _filled(text: str, indent: str = "") -> list[str]:
    return wrap(
        text,
        _width(),
        initial_indent=indent,
        subsequent_indent=indent,
        break_long_words=False,
        break_on_hyphens=False,
    )


def command_lines(line: str, width: int) -> Iterator[str]:
    """A command; one that does not fit is continued as a shell takes it, an option beside its value."""
    glued = re.sub(r" (?![-|])", "\xa0", line.strip())
    room = width - (2 if len(glued) + 2 <= width else 6)
    *first, last = wrap(glued, room, break_long_words=False, break_on_hyphens=False)
    lines = [*(f"{part} \\" for part in first), last]
    return (f"{'    ' if number else '  '}{part}".replace("\xa0", " ") for number, part in enumerate(lines))


def _names(param: Any) -> str:
    flags = sorted(param.opts, key=lambda flag: flag.startswith("--"))  # -o before --output
    is_option = flags[-1].startswith("-")
    return " ".join(filter(None, [", ".join(flags) if is_option else "", param.metavar]))


def _column(rows: list[tuple[str, str]]) -> int:
    """Where the meanings begin."""
    column = 4 + max(len(name) for name, _ in rows if len(name) <= LONGEST_NAME)
    return column if _width() - column >= LEAST_BESIDE else BELOW


def _pairs(rows: list[tuple[str, str]], column: int | None = None) -> Iterator[str]:
    """Names with their meanings, beside them or below."""
    column = column or _column(rows)
    for name, meaning in rows:
        lines = _filled(meaning, " " * column)
        start = f"  {name}"
        if len(start) + 2 <= column:
            lines = [start + line[len(start) :] for line in lines[:1]] + lines[1:]
        else:
            lines.insert(0, start)
        yield from lines
