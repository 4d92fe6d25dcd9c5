"""`atwood quantities`: the quantities that can be asked for by name."""

from ..output.text import VERSION, Destination, Report, show
from ..solver.quantities import QUANTITIES, REGIMES
from .options import DONE, OUTPUT, with_options

HELP = """List the quantities: symbols, units, meanings, equations.

\b
Examples:
  atwood quantities
  atwood quantities --json
"""
ON_FRICTION = (
    "Friction acts along the string, which bends around the pulley, so its vector sum, friction_force, is not"
    " T2 - T1. While a string grips with friction to spare, the tension along its arc is not unique."
    " friction_force is then between friction_force_min and friction_force_max, if friction nowhere reverses"
    " along the arc. Without mu, friction_force is the one at mu_verge."
)


@with_options(OUTPUT)
def quantities(target: Destination) -> int:
    """Run the command."""
    columns = ("name", "symbol", "unit", "meaning", "equation")
    rows = [("regime", "", "", f"what the string does: {', '.join(REGIMES)}", "")]
    rows += [
        (name, *(getattr(about, column) for column in columns[1:])) for name, about in QUANTITIES.items()
    ]
    records = [dict(zip(columns, row, strict=True)) for row in rows]

    def print_page() -> None:
        from ..output.page import Page

        page = Page()
        page.table([column.capitalize() for column in columns], [rows])
        page.say(ON_FRICTION)

    show(Report(lambda: {"version": VERSION, "quantities": records}, lambda: records, print_page), target)
    return DONE
