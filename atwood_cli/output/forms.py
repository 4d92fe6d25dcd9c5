"""A result in each form that may be asked for: a page, Markdown, JSON, CSV, or bare values."""

import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import NamedTuple

from .files import Stdout, stdout_into
from .page import Page
from .text import as_json, cell, say_written


class Report(NamedTuple):
    """A result in all forms that may be asked for. Each is made when it is asked for.

    ``json`` returns the record, ``records`` the lines of CSV, and ``page`` prints on a page. ``bare`` are the
    values that --only names, and ``below`` prints the lines after them. ``notes`` are for forms without any.
    """

    json: Callable[[], Mapping[str, object]]
    records: Callable[[], Iterable[Mapping[str, object]]]
    page: Callable[[Page], None]
    notes: Callable[[], Sequence[str]] = list
    bare: Sequence[str] = ()
    below: Callable[[Page], None] | None = None


class Form(NamedTuple):
    """A form: its files' suffix, its option's help, its printer, if it has the notes, if it is a page."""

    suffix: str
    help: str
    write: Callable[[Report], None]
    has_notes: bool
    is_page: bool = False


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


def _write_page(print_on: Callable[[Page], None], is_markdown: bool = False) -> None:
    """Print on a page, which is written at once: others may write to the same pipe."""
    with (page := Page(is_markdown=is_markdown)).console:
        print_on(page)


FORMS = {
    "json": Form(".json", "Print JSON.", _write_json, True),
    "csv": Form(".csv", "Print CSV, with a line of names first.", _write_csv, False),
    "markdown": Form(
        ".md", "Print the page as Markdown.", lambda report: _write_page(report.page, True), True, True
    ),
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
            if report.below:
                _write_page(report.below)
        else:
            _write_page(report.page)
        sys.stdout.flush()
    if target.file is not None:
        say_written(target.file)
    return report.notes() if report.bare or (form and not form.has_notes) else ()
