"""Results as text, without rich: cells, JSON, CSV, and sentences on stderr."""

import json
import os
import re
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from contextvars import ContextVar
from decimal import Decimal
from typing import Any, NamedTuple, TextIO

from ..numbers.digits import format_number, is_infinite
from ..numbers.text import LONGEST_NAME, shortened
from .files import Stdout, printable, stdout_into


def say(*messages: str) -> None:
    """Print each message on stderr, on a line that begins with the name of the program."""
    for message in messages:
        line = f"atwood: {printable(message, keep='')}"
        if sys.stderr.isatty():
            from shutil import get_terminal_size

            line = "\n".join(wrapped(line, get_terminal_size().columns))
        with suppress(OSError):  # there is nobody else to tell
            print(line, file=sys.stderr)


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


class Report(NamedTuple):
    """A result in all forms that may be asked for. Each is made when it is asked for.

    ``json`` returns the record, and ``records`` the lines of CSV. ``page`` prints the page. ``bare`` are the
    values that --only names, and ``below`` prints the lines after them. ``notes`` are for forms without any.
    """

    json: Callable[[], Mapping[str, object]]
    records: Callable[[], Iterable[Mapping[str, object]]]
    page: Callable[[], None]
    notes: Callable[[], Sequence[str]] = list
    bare: Sequence[str] = ()
    below: Callable[[], None] = lambda: None


class Form(NamedTuple):
    """A form for programs: its files' suffix, its option's help, its printer, whether it has the notes."""

    suffix: str
    help: str
    write: Callable[[Report], None]
    has_notes: bool


def _write_json(report: Report) -> None:
    sys.stdout.writelines(as_json(report.json()))
    print()


def _write_csv(report: Report) -> None:
    """Print a line of names, and a line for each record when it comes."""
    from csv import writer

    table = writer(Stdout(), lineterminator="\n")
    for number, record in enumerate(report.records()):
        if not number:
            table.writerow(record)
        table.writerow(map(cell, record.values()))


IN_MARKDOWN = ContextVar("markdown", default=False)
"""Whether pages are printed as Markdown."""


def _write_markdown(report: Report) -> None:
    token = IN_MARKDOWN.set(True)
    try:
        report.page()
    finally:
        IN_MARKDOWN.reset(token)


def markdown_table(rows: Iterable[Sequence[str]]) -> Iterator[str]:
    """Yield the lines of a table in Markdown, whose first row is its header."""
    for number, row in enumerate(rows):
        cells = (re.sub(r"([|\\])", r"\\\1", " ".join(cell.split())) for cell in row)
        yield f"| {' | '.join(cells)} |"
        if not number:
            yield f"|{' --- |' * len(row)}"


FORMS = {
    "json": Form(".json", "Print JSON.", _write_json, True),
    "csv": Form(".csv", "Print CSV, with a line of names first.", _write_csv, False),
    "markdown": Form(".md", "Print the page as Markdown.", _write_markdown, True),
}
"""The forms, by the name of their option. Without such an option a page is printed, or bare values."""


class Destination(NamedTuple):
    """The form of a result, "" for a page, and the file that it goes to, None for stdout."""

    form: str = ""
    file: str | None = None
    force: bool = False


class Picture(NamedTuple):
    """The file of a picture, and whether it is without a title, or has only symbols, without numbers."""

    file: str
    force: bool = False
    bare: bool = False
    symbols: bool = False


def show(report: Report, target: Destination) -> Sequence[str]:
    """Print a result in a form, as bare values or as a page, whole or not at all. Raises OSError.

    Returns the notes if the form has no place for them, as CSV and bare values: they are to be said on
    stderr, after the result, which is flushed by then.
    """
    form = FORMS.get(target.form)
    with stdout_into(target.file, target.force):
        if form:
            form.write(report)
        elif report.bare:
            if any(report.bare):  # an empty line for each value that does not exist
                print(*report.bare, sep="\n")
            report.below()
        else:
            report.page()
        sys.stdout.flush()
    if target.file is not None:
        say_written(target.file)
    return report.notes() if report.bare or (form and not form.has_notes) else ()


def as_json(value: object, indent: str = "\n") -> Iterator[str]:
    """Yield a value as JSON, piece by piece, so that the items of an iterator are written as they come.

    An infinite number is null.
    """
    inner = indent + "  "
    match value:
        case Mapping():
            yield "{"
            comma = ""
            for key, item in value.items():
                yield f"{comma}{inner}{json.dumps(key)}: "
                yield from as_json(item, inner)
                comma = ","
            yield f"{indent}}}"
        case list() | Iterator():
            start = "["
            for item in value:
                yield f"{start}{inner}"
                yield from as_json(item, inner)
                start = ","
            yield "[]" if start == "[" else f"{indent}]"
        case float() | Decimal():
            yield cell(value) or "null"
        case _:
            yield json.dumps(value)


def cell(value: object) -> str:
    """Return a value as bare text, "" if there is none or it is infinite."""
    match value:
        case float() | Decimal():
            return "" if is_infinite(value) else format_number(value)
        case bool():
            return str(value).lower()
    return "" if value is None else str(value)


def in_html(words: str) -> str:
    """Return a page of text as a notebook shows it."""
    from html import escape

    return f"<pre>{escape(words)}</pre>"
