"""Text without rich: cells, lines, tables of Markdown, JSON, sentences on stderr, and what to install."""

import json
import os
import re
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from decimal import Decimal
from typing import Any, TextIO

from ..numbers.digits import format_number, is_infinite
from ..numbers.text import LONGEST_NAME, shortened
from .files import printable


def say(*messages: str) -> None:
    """Print each message on stderr, on a line that begins with the name of the program."""
    for message in messages:
        line = f"atwood: {printable(message, keep='')}"
        if sys.stderr.isatty():
            from shutil import get_terminal_size

            line = "\n".join(wrapped(line, get_terminal_size().columns))
        with suppress(OSError):  # there is nobody else to tell
            sys.stderr.write(f"{line}\n")


def say_written(file: str) -> None:
    say(f"wrote {shortened(file, LONGEST_NAME)}")


A_UNIT = r"kg|g|m/s²|rad/s²|m/s\^2|m|[mnµ]?s|m?Nm?|ulp"
UNBROKEN = rf" (?=[±=])|(?<=[±=]) |(?<=[\d)]) (?=(?:{A_UNIT})\b)|(?<=\bN) (?=m\b)|(?<=\bkg) (?=m[²^])"
"""The blanks at which no line breaks, as they join a name, its value, its uncertainty and its unit."""


def wrapped(words: str, width: int, first: str = "", later: str = "") -> list[str]:
    """Return words in lines of at most that width; a number too long for it has a line of its own.

    ``first`` stands before the first line, and ``later`` before every other line.
    """
    from textwrap import wrap

    pieces = re.sub(UNBROKEN, "\xa0", words).split(" ")
    pieces = [piece if len(piece) <= width else piece.replace("=\xa0", "= ") for piece in pieces]
    whole: Any = {"break_long_words": False, "break_on_hyphens": False}
    lines = wrap(" ".join(pieces), max(width, 1), initial_indent=first, subsequent_indent=later, **whole)
    return [line.replace("\xa0", " ") for line in lines]


EXTRAS = {"matplotlib": "figure", "polars": "batch", "scipy": "fit"}
"""The extras that bring optional packages."""


@contextmanager
def naming_the_extra() -> Iterator[None]:
    """Let the error for an optional package that is missing say how to install it."""
    try:
        yield
    except ModuleNotFoundError as error:
        package = str(error.name).partition(".")[0]
        if package not in EXTRAS:
            raise
        way = f"install it with: pip install 'atwood-cli[{EXTRAS[package]}]'"
        raise ModuleNotFoundError(f"this needs {package}; {way}", name=error.name) from None


def finish() -> None:
    """Flush both streams now, as an error while Python closes them would change the exit status."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except OSError:
            drop(stream)


def drop(stream: TextIO) -> None:
    """Discard all that a stream has buffered, and all that follows."""
    with suppress(OSError):  # the stream may have no file
        number = stream.fileno()
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, number)
        os.close(nowhere)


def markdown_table(rows: Iterable[Sequence[str]]) -> Iterator[str]:
    """Yield the lines of a table in Markdown, whose first row is its header."""
    for number, row in enumerate(rows):
        cells = (re.sub(r"([|\\])", r"\\\1", " ".join(cell.split())) for cell in row)
        yield f"| {' | '.join(cells)} |"
        if not number:
            yield f"|{' --- |' * len(row)}"


def as_json(value: object, indent: str = "\n") -> Iterator[str]:
    """Yield a value as JSON, piece by piece, so that the items of an iterator are written as they come.

    An infinite number is null.
    """
    inner = indent + "  "
    match value:
        case Mapping():
            start, end, items = "{", "}", ((f"{json.dumps(key)}: ", item) for key, item in value.items())
        case list() | Iterator():
            start, end, items = "[", "]", (("", item) for item in value)
        case float() | Decimal():
            yield cell(value) or "null"
            return
        case _:
            yield json.dumps(value)
            return
    for key, item in items:
        yield f"{start}{inner}{key}"
        yield from as_json(item, inner)
        start = ","
    yield "[]" if start == "[" else f"{start.removeprefix(',')}{indent}{end}"


def cell(value: object) -> str:
    """Return a value as bare text, "" if there is none or it is infinite."""
    match value:
        case float() | Decimal():
            return "" if is_infinite(value) else format_number(value)
        case bool():
            return str(value).lower()
    return "" if value is None else str(value)


def aligned(numbers: Iterable[str]) -> list[str]:
    """Return numbers with their decimal points below each other; words are left as they are."""
    numbers = list(numbers)
    point = max(map(_integer_part, numbers), default=0)
    return [" " * (point - _integer_part(cell)) + cell if is_number(cell) else cell for cell in numbers]


def is_number(value: str) -> bool:
    return value.lstrip("(+-.")[:1].isdigit()


def _integer_part(value: str) -> int:
    return len(value.partition(" ")[0].partition(".")[0].partition("e")[0]) if is_number(value) else 0
