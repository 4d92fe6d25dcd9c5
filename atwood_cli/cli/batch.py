"""`atwood batch`: a file of scenes, the same file with their results."""

from typing import Annotated, Any

import typer

from ..files import FORMATS
from ..model.quantities import ACCURACIES, STANDARD, read_name, read_names
from ..model.scene import INPUTS
from ..output.text import say
from .options import COULD_NOT, DONE, Columns, Force, Labels, option

Table = Annotated[
    str,
    typer.Argument(
        metavar="IN",
        rich_help_panel="Files",
        help="Table of scenes: .csv, .tsv, .ndjson, .jsonl or .parquet; - for stdin; a pipe is read as CSV.",
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
        help="How accurate results are; certified, within 4 units in the last place, if not given.",
    ),
]
AllowErrors = Annotated[bool, option("Output", "--allow-errors", help="Exit 0 though rows have errors.")]


HELP = f"""Solve a table of scenes: the same table with results appended, and the error of each bad row.

Examples:
  atwood batch scenes.csv -o results.csv
  atwood batch scenes.parquet -o results.parquet --accuracy exact
  atwood batch scenes.csv --only regime --only acceleration | head
  generate | atwood batch - --from ndjson --to ndjson --allow-errors

Columns {", ".join(INPUTS)} are the options of solve, in SI units or
in those of the heading, as m1 (g) or M [kg]; axle is a force, not a torque. An empty cell, NA, NULL or null
is not given. Other columns stay as they are, but what could be meant for an input, like radius, is refused.
Cells may be parted by semicolons or tabs, and have decimal commas then. CSV into CSV keeps the text of each
cell; into NDJSON and Parquet the inputs go as numbers, null where a cell is none. A cell is read as the
double nearest to it, as is g: so even exact can differ in the last digit from solve, which takes 0.1 for a
tenth.
"""


def batch(
    table: Table,
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
    from ..batch.formats import read_format
    from ..batch.run import Job, run_batch
    from ..output.page import watched

    names = list(dict.fromkeys(read_names("only", only or STANDARD)))
    known: Any = read_name("accuracy", accuracy, ACCURACIES, "accuracy")
    formats = read_format("from", from_, table), read_format("to", to, output)
    job = Job(table, formats[0], output, formats[1], names, known, force, label or ())
    tally = run_batch(job, watched)
    say(*tally.lines())
    failed = tally.errors and not allow_errors
    missing = only and tally.missing and tally.rows > tally.errors
    return COULD_NOT if failed or missing else DONE
