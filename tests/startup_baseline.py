"""The baseline of start-up: a bare typer app with one command of eleven options, which prints constants.

It imports decimal and json, and for the table rich's console and one table, as any such program would.
"""

import decimal  # noqa: F401
import json
import sys
from inspect import Parameter, Signature
from typing import Annotated

import typer

OPTIONS = ("m1", "m2", "M", "mu", "mu_k", "g", "inertia", "I", "R", "wrap", "json")

app = typer.Typer(name="atwood")


@app.callback()
def root() -> None: ...


def solve(**given: str | bool | None) -> None:
    if given["json"]:
        print(json.dumps({"acceleration": 0.764026672247107}))
        return
    from rich.console import Console
    from rich.table import Table

    table = Table("Quantity", "Value")
    table.add_row("acceleration", "0.764026672247107")
    Console().print(table)


def option(name: str) -> Parameter:
    flag, kind = f"--{name.replace('_', '-')}", bool if name == "json" else str | None
    about = typer.Option(flag, help="Help.", rich_help_panel="Scene")
    default = False if name == "json" else None
    return Parameter(name, Parameter.KEYWORD_ONLY, default=default, annotation=Annotated[kind, about])


parameters = [option(name) for name in OPTIONS]
solve.__dict__["__signature__"] = Signature(parameters)
solve.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
app.command()(solve)

if __name__ == "__main__":
    sys.exit(app())
