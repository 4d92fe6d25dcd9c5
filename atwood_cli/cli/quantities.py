"""`atwood quantities`: the quantities that can be asked for by name."""

from operator import attrgetter
from typing import Annotated

from ..explain.given import VERSION
from ..output.forms import Destination, Report, show
from ..output.page import Page
from ..reading.names import read_names
from ..solver.quantities import QUANTITIES, REGIMES
from .options import DONE, OUTPUT, argument, with_options

HELP = """List the quantities: symbols, units, meanings, equations.

\b
Examples:
  atwood quantities
  atwood quantities mu_verge a
  atwood quantities --json
"""
Names = Annotated[list[str] | None, argument("Output", "[NAMES]", "Only these quantities.")]


@with_options(OUTPUT)
def quantities(target: Destination, names: Names = None) -> int:
    columns = ("name", "symbol", "unit", "meaning", "equation")
    rows = [("regime", "", "", f"what the string does: {', '.join(REGIMES)}", "")]
    rows += [(name, *attrgetter(*columns[1:])(about)) for name, about in QUANTITIES.items()]
    if names:
        wanted = read_names("NAME", names, ("regime", *QUANTITIES))
        rows = [row for row in rows if row[0] in wanted]
    records = [dict(zip(columns, row, strict=True)) for row in rows]

    def print_page(page: Page) -> None:
        page.table([column.capitalize() for column in columns], [rows])

    show(Report(lambda: {"version": VERSION, "quantities": records}, lambda: records, print_page), target)
    return DONE
