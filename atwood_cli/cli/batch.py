"""`atwood batch`: a file of scenes, the same file with their results."""

import os
from typing import Annotated, Any

import typer

from ..files import FORMATS, LONGEST_NAME
from ..model.quantities import ACCURACIES, STANDARD, read_name, read_names
from ..model.scene import INPUTS
from ..model.units import counted, shortened
from ..output.text import say
from .options import COULD_NOT, DONE, Columns, Force, Labels, option

Tables = Annotated[
    list[str],
    typer.Argument(
        metavar="IN...",
        rich_help_panel="Files",
        help="Tables of scenes, with the same columns: .csv, .tsv, .ndjson, .jsonl, .parquet, or compressed, "
        "as .csv.gz; - for stdin; a pipe is read as CSV.",
        show_default=False,
    ),
]
OutTable = Annotated[
    str,
    option("Files", "--output", "-o", metavar="OUT", help="Write to this file; - for stdout, if not given."),
]
FromFormat = Annotated[
    str | None,
    option("Files", "--from", metavar="|".join(FORMATS), help="Format of IN, if not that of its suffix."),
]
ToFormat = Annotated[
    str | None,
    option(
        "Files",
        "--to",
        metavar="|".join(FORMATS),
        help="Format of OUT, if not that of its suffix; stdout: csv.",
    ),
]
Accuracy = Annotated[
    str,
    option(
        "Output",
        metavar="|".join(ACCURACIES),
        help="How accurate results are; certified, within 4 units in the last place, if not given. A table of"
        " at most 20 rows is exact.",
    ),
]
AllowErrors = Annotated[bool, option("Output", "--allow-errors", help="Exit 0 though rows have errors.")]


HELP = f"""Solve a table of scenes: the same table with results appended, and the error of each bad row.

Examples:
  atwood batch scenes.csv -o results.csv
  atwood batch scenes.parquet -o results.parquet --accuracy exact
  atwood batch scenes.csv --only regime --only acceleration | head
  atwood batch a.csv b.csv.gz -o all.csv
  generate | atwood batch - --from ndjson --to ndjson --allow-errors

Columns {", ".join(INPUTS)} are the options of solve, in SI units or
in those of the heading, as m1 (g) or M [kg]; axle is a force, not a torque. An empty cell, NA, NULL or null
is not given. Other columns stay as they are, but what could be meant for an input, like radius, is refused.
Cells may be parted by semicolons or tabs, and have decimal commas then. CSV into CSV keeps the text of each
cell; into NDJSON and Parquet the inputs go as numbers, null where a cell is none. NDJSON from a pipe into
NDJSON is answered line by line, as it comes. A cell is read as the double nearest to it, as is g: so even
exact can differ in the last digit from solve, which takes 0.1 for a tenth.
"""


def batch(
    tables: Tables,
    *,
    output: OutTable = "-",
    from_: FromFormat = None,
    to: ToFormat = None,
    label: Labels = None,
    only: Columns = None,
    accuracy: Accuracy = "certified",
    allow_errors: AllowErrors = False,
    force: Force = False,
) -> int:
    from ..batch.formats import is_stream, read_format
    from ..batch.run import Job, run_batch
    from ..batch.solving import Tally
    from ..output.page import watched

    names = list(dict.fromkeys(read_names("only", only or STANDARD)))
    known: Any = read_name("accuracy", accuracy, ACCURACIES, "accuracy")
    sources = [(table, read_format("from", from_, table)) for table in tables]
    job = Job(sources, output, read_format("to", to, output), names, known, force, label or ())
    tally = Tally(set(names))
    before = _stamp(output)
    try:
        run_batch(job, watched, tally)
    except KeyboardInterrupt:
        if not is_stream(output) and _stamp(output) == before:
            is_left = "stays as it was" if before else "was not written"
            say(f"stopped after {counted(tally.rows, 'row')}; {shortened(output, LONGEST_NAME)} {is_left}")
        raise
    say(*tally.lines())
    failed = tally.errors and not allow_errors
    missing = only and tally.missing and tally.rows > tally.errors
    return COULD_NOT if failed or missing else DONE


def _stamp(path: str) -> tuple[int, int] | None:
    """What tells a file from one that took its place; None if there is none."""
    try:
        about = os.stat(path)
        return about.st_ino, about.st_mtime_ns
    except (OSError, ValueError):
        return None
