"""The baseline of start-up: a bare typer app with one command of eleven options, which prints constants.

It imports decimal and json, and for the table rich's console and one table, as any such program would.
"""

import decimal  # noqa: F401
import json
import sys
from typing import Annotated

import typer

Text = Annotated[str | None, typer.Option(help="Help.", rich_help_panel="Scene")]
Json = Annotated[bool, typer.Option("--json", help="Help.", rich_help_panel="Scene")]
app = typer.Typer(name="atwood")


@app.callback()
def root() -> None: ...


@app.command()
def solve(
    *,
    m1: Text = None,
    m2: Text = None,
    M: Text = None,
    mu: Text = None,
    mu_k: Text = None,
    g: Text = None,
    inertia: Text = None,
    I: Text = None,
    R: Text = None,
    wrap: Text = None,
    as_json: Json = False,
) -> None:
    if as_json:
        print(json.dumps({"acceleration": 0.764026672247107}))
        return
    from rich.console import Console
    from rich.table import Table

    table = Table("Quantity", "Value")
    table.add_row("acceleration", "0.764026672247107")
    Console().print(table)


if __name__ == "__main__":
    sys.exit(app())
