"""`atwood quantities`: the quantities that can be asked for by name."""

from collections.abc import Sequence

from ..model.quantities import QUANTITIES, REGIMES
from ..output.text import VERSION, Destination, Report, show
from .options import DONE, OUTPUT, with_options

HELP = """List the quantities: symbols, units, meanings, equations.

\b
Examples:
  atwood quantities
  atwood quantities --json
"""
ON_FRICTION = (
    "While a string grips with friction to spare, the tension along its arc is not unique. friction_force is"
    " then between friction_force_min and friction_force_max, if all friction acts one way; tension locked in"
    " when the string is laid on widens that range. Without mu, friction_force is the one at mu_verge."
)


@with_options(OUTPUT)
def quantities(target: Destination) -> int:
    """Run the command."""
    columns = ("name", "symbol", "unit", "meaning", "equation")
    rows = [
        ("regime", "", "", f"what the string does: {', '.join(REGIMES)}", ""),
        *(
            (name, about.symbol, about.unit, about.meaning, about.equation)
            for name, about in QUANTITIES.items()
        ),
    ]
    records = [dict(zip(columns, row, strict=True)) for row in rows]
    show(
        Report(lambda: {"version": VERSION, "quantities": records}, lambda: records, lambda: _print(rows)),
        target,
    )
    return DONE


def _print(rows: Sequence[Sequence[str]]) -> None:
    from ..output.page import Page

    page = Page()
    page.table(["Name", "Symbol", "Unit", "Meaning", "Equation"], [rows])
    page.say(ON_FRICTION)
