"""`atwood batch`: a table of scenes, solved row by row."""

from collections.abc import Mapping
from typing import Annotated

from typer import Context

from ..explain.conditions import read_condition
from ..numbers.text import counted
from ..output.files import STDOUT
from ..output.forms import FORMS
from ..output.text import say, say_written
from ..reading.inputs import read_whole
from ..reading.names import read_names
from ..solver.quantities import STANDARD
from ..solver.scene import INPUTS, SceneError
from ..tables.sources import FORMATS, Unreadable, check_format, read_format
from .options import (
    COULD_NOT,
    DONE,
    FALL,
    SCENE,
    TABLE,
    Columns,
    Expect,
    Force,
    Layout,
    argument,
    option,
    refuse,
    with_options,
)

Table = Annotated[
    str,
    argument(
        "Files",
        "IN",
        "Table of scenes: .csv, .tsv, .ndjson, .jsonl, .parquet, or compressed, as .csv.gz; .xlsx, .ods;"
        " - for stdin; a pipe is read as CSV.",
    ),
]
OutTable = Annotated[
    str | None,
    option(
        "Files",
        "--output",
        "-o",
        metavar="OUT",
        help="Write to this file, in the format of IN; - for stdout, if not given.",
    ),
]
From = Annotated[
    str | None,
    option("Files", "--from", metavar="|".join(FORMATS), help="Format of IN, if not that of its suffix."),
]
Rounded = Annotated[
    str | None,
    option("Output", metavar="N", help="Round results, the nearest doubles, to N digits, 1 to 17."),
]
HELP = f"""Solve a table of scenes and append the results.

\b
Examples:
  atwood batch scenes.csv -o results.csv
  atwood batch scenes.parquet -o results.parquet
  atwood batch scenes.csv --only regime --only acceleration | head
  generate | atwood batch - --from ndjson --allow-errors

Columns {", ".join(INPUTS)} and drop are the options of solve, which give what
all rows share: numbers in SI units, wrap in degrees, or in the unit of the heading, as m1 (g), M [kg], R/cm.
An empty cell, NA, NULL or null is not given. Other columns are kept and named as not read; one that may mean
an input, like radius without R, is asked for, and --columns says what each is, with or without headings.
Results follow each row; a row with too few or too many cells is an error. Piped rows are solved as they come.
Cells become doubles in SI units; solve reads 0.1 as exactly 1/10, so last digits may differ. A row with a
unit or radians in a cell is solved by itself, exactly as typed.

The usual seven results are {", ".join(STANDARD)}.
The exit status is 1 if a row has an error, if a quantity that --only names has no value in any solved row, or
if there is no row or one that does not meet what is expected. In NDJSON a bad line is a bad row.
"""


@with_options(SCENE | FALL, TABLE)
def batch(
    context: Context,
    table: Table,
    given: Mapping[str, str | None],
    layout: Layout,
    *,
    output: OutTable = None,
    from_: From = None,
    only: Columns = None,
    expect: Expect = None,
    digits: Rounded = None,
    markdown: Annotated[bool, option("Output", "--markdown", help=FORMS["markdown"].help)] = False,
    allow_errors: Annotated[
        bool, option("Output", "--allow-errors", help="Exit 0 though rows have errors.")
    ] = False,
    force: Force = False,
) -> int:
    from ..batch.run import Job, run_batch
    from ..batch.solving import ERROR, VOCABULARY, TableTally, Wanted
    from ..tables.headings import OPEN, read_naming

    asked = list(dict.fromkeys(read_names("only", only or [])))
    kind = read_format(from_, table)
    if markdown and kind not in ("csv", "tsv"):
        raise SceneError("markdown", None, "takes a table of CSV or .tsv, or a workbook")
    output = output or STDOUT
    check_format(output, "md" if markdown else kind)
    conditions = [*map(read_condition, expect or [])]
    shared = {name: value for name, value in given.items() if value not in (None, OPEN)}
    rounded_to = None if digits is None else read_whole("digits", digits, 1, 17)
    columns, named, labels, sheet = layout
    naming = read_naming(columns, named, labels, VOCABULARY)
    if naming.filled:
        rule = "fills blank cells by +, which are not given in a table of scenes"
        raise SceneError("columns", columns, rule)
    wanted = Wanted(asked or STANDARD, naming, conditions, shared, rounded_to)
    job = Job(table, kind, output, force, wanted, sheet, markdown)
    tally = TableTally(asked, conditions)
    try:
        remarks = run_batch(job, tally)
    except Unreadable as error:
        return refuse(context, table, error)
    except KeyboardInterrupt:
        if tally.rows:
            say(f"stopped after {counted(tally.rows, 'row')}")
        raise
    if output != STDOUT:
        say_written(output)
    say(*remarks, *tally.lines())
    errors = tally.counts[ERROR]
    missing = tally.missing and tally.rows > errors
    unmet = conditions and (tally.failures or errors or not tally.rows)
    return COULD_NOT if missing or unmet or (errors and not allow_errors) else DONE
