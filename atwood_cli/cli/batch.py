"""`atwood batch`: a table of scenes, solved row by row."""

import os
from typing import Annotated

import typer

from ..model.quantities import ACCURACIES, STANDARD, read_accuracy, read_names
from ..model.scene import INPUTS
from ..model.units import LONGEST_NAME, counted, shortened
from ..output.text import say
from ..tables.sources import FORMATS, check_format, is_stream, read_format
from .options import COULD_NOT, DONE, Columns, Force, Labels, option

Table = Annotated[
    str,
    typer.Argument(
        metavar="IN",
        rich_help_panel="Files",
        help="Table of scenes: .csv, .tsv, .ndjson, .jsonl, .parquet, or compressed, as .csv.gz; - for stdin;"
        " a pipe is read as CSV.",
        show_default=False,
    ),
]
OutTable = Annotated[
    str,
    option(
        "Files",
        "--output",
        "-o",
        metavar="OUT",
        help="Write to this file, in the format of IN; - for stdout, if not given.",
    ),
]
FromFormat = Annotated[
    str | None,
    option("Files", "--from", metavar="|".join(FORMATS), help="Format of IN, if not that of its suffix."),
]
Accuracy = Annotated[
    str, option("Output", metavar="|".join(ACCURACIES), help="How accurate results are; exact, if not given.")
]
Headings = Annotated[
    list[str] | None,
    option(
        "Files",
        "--column",
        metavar="NAME=HEADING",
        help="What a column holds, if its heading does not say, as R='radius in m'; repeatable.",
    ),
]
AllowErrors = Annotated[bool, option("Output", "--allow-errors", help="Exit 0 though rows have errors.")]


HELP = f"""Solve a table of scenes: the same table, with results.

\b
Examples:
  atwood batch scenes.csv -o results.csv
  atwood batch scenes.parquet -o results.parquet --accuracy certified
  atwood batch scenes.csv --only regime --only acceleration | head
  generate | atwood batch - --from ndjson --allow-errors

Columns {", ".join(INPUTS)} are the options of solve, in SI units or
in those of the heading, as m1 (g), M [kg] or R/cm; axle is a force, not a torque. An empty cell, NA, NULL or
null is not given. Other columns stay as they are, but what could be meant for an input, like radius, is
refused. Each row stays as it came, and its results follow, with semicolons or tabs between them and decimal
commas where the table has these. A pipe is answered as it comes. A cell is read as the double nearest to it,
as is g: so a result can differ in the last digit from solve, which takes 0.1 for a tenth.
"""


def batch(
    table: Table,
    *,
    output: OutTable = "-",
    from_: FromFormat = None,
    column: Headings = None,
    label: Labels = None,
    only: Columns = None,
    accuracy: Accuracy = "exact",
    allow_errors: AllowErrors = False,
    force: Force = False,
) -> int:
    from ..batch.run import Job, run_batch
    from ..batch.solving import VOCABULARY, Question, Tally
    from ..output.page import watched
    from ..tables.headings import read_named

    names = list(dict.fromkeys(read_names("only", only or STANDARD)))
    kind = read_format(from_, table)
    check_format(output, kind)
    named = read_named(column or (), VOCABULARY)
    job = Job(table, kind, output, force, Question(names, read_accuracy(accuracy), label or (), named))
    tally = Tally(set(names))
    before = _stamp(output)
    try:
        remarks = run_batch(job, watched, tally)
    except KeyboardInterrupt:
        if not is_stream(output) and _stamp(output) == before:
            _say_stopped(tally.rows, output, "stays as it was" if before else "was not written")
        raise
    if not only:
        tally.reasons.clear()  # nobody asked for these quantities
    say(*remarks, *tally.lines())
    missing = only and tally.missing and tally.rows > tally.errors
    return COULD_NOT if missing or (tally.errors and not allow_errors) else DONE


def _say_stopped(rows: int, output: str, is_left: str) -> None:
    say(f"stopped after {counted(rows, 'row')}; {shortened(output, LONGEST_NAME)} {is_left}")


def _stamp(path: str) -> tuple[int, int] | None:
    """The identity of a file and the time of its last change; None if there is no file."""
    try:
        about = os.stat(path)
        return about.st_ino, about.st_mtime_ns
    except (OSError, ValueError):
        return None
