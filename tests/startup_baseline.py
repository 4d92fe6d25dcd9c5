"""The yardstick of start-up: a bare typer app with the options of `atwood`, which prints constants.

It imports decimal and json, and for the table rich's console and one table, as any such program would.
"""

import decimal  # noqa: F401
import json
import sys
from typing import Annotated

import typer

app = typer.Typer(name="atwood", invoke_without_command=True)


def option(*flags: str) -> typer.models.OptionInfo:
    info: typer.models.OptionInfo = typer.Option(
        *flags, help="Help.", metavar="NUMBER", rich_help_panel="Scene"
    )
    return info


@app.callback()
def root(version: Annotated[bool, option("--version")] = False) -> None: ...


@app.command()
def solve(
    m1: Annotated[str | None, option("--m1")] = None,
    m2: Annotated[str | None, option("--m2")] = None,
    M: Annotated[str | None, option("--M", "--pulley-mass")] = None,
    mu: Annotated[str | None, option("--mu")] = None,
    mu_k: Annotated[str | None, option("--mu-k")] = None,
    g: Annotated[str | None, option("--g")] = None,
    inertia: Annotated[str | None, option("--inertia")] = None,
    I: Annotated[str | None, option("--I")] = None,
    R: Annotated[str | None, option("--R", "--radius")] = None,
    wrap: Annotated[str | None, option("--wrap")] = None,
    a: Annotated[str | None, option("--a")] = None,
    drop: Annotated[str | None, option("--drop")] = None,
    time: Annotated[str | None, option("--time")] = None,
    digits: Annotated[str | None, option("--digits")] = None,
    as_json: Annotated[bool, option("--json")] = False,
    csv: Annotated[bool, option("--csv")] = False,
    only: Annotated[list[str] | None, option("--only")] = None,
    budget: Annotated[bool, option("--budget")] = False,
    explain: Annotated[bool, option("--explain")] = False,
    markdown: Annotated[bool, option("--markdown")] = False,
) -> None:
    if as_json:
        print(json.dumps({"acceleration": 0.764026672247107}))
        return
    from rich.console import Console
    from rich.table import Table

    table = Table("Quantity", "Value")
    table.add_row("acceleration", "0.764026672247107")
    Console().print(table)


@app.command()
def sweep(
    m1: Annotated[str | None, option("--m1")] = None,
    m2: Annotated[str | None, option("--m2")] = None,
    M: Annotated[str | None, option("--M", "--pulley-mass")] = None,
    mu: Annotated[str | None, option("--mu")] = None,
    mu_k: Annotated[str | None, option("--mu-k")] = None,
    g: Annotated[str | None, option("--g")] = None,
    inertia: Annotated[str | None, option("--inertia")] = None,
    I: Annotated[str | None, option("--I")] = None,
    R: Annotated[str | None, option("--R", "--radius")] = None,
    wrap: Annotated[str | None, option("--wrap")] = None,
    plot: Annotated[str | None, option("--plot")] = None,
    figure: Annotated[tuple[str, str] | None, option("--figure")] = None,
    output: Annotated[str | None, option("--output", "-o")] = None,
    force: Annotated[bool, option("--force")] = False,
    digits: Annotated[str | None, option("--digits")] = None,
    as_json: Annotated[bool, option("--json")] = False,
    csv: Annotated[bool, option("--csv")] = False,
    only: Annotated[list[str] | None, option("--only")] = None,
) -> None: ...


@app.command()
def contact(
    m1: Annotated[str | None, option("--m1")] = None,
    m2: Annotated[str | None, option("--m2")] = None,
    M: Annotated[str | None, option("--M", "--pulley-mass")] = None,
    mu: Annotated[str | None, option("--mu")] = None,
    mu_k: Annotated[str | None, option("--mu-k")] = None,
    g: Annotated[str | None, option("--g")] = None,
    inertia: Annotated[str | None, option("--inertia")] = None,
    I: Annotated[str | None, option("--I")] = None,
    R: Annotated[str | None, option("--R", "--radius")] = None,
    wrap: Annotated[str | None, option("--wrap")] = None,
    points: Annotated[str, option("--points")] = "13",
    profile: Annotated[str | None, option("--profile")] = None,
    elements: Annotated[str | None, option("--elements")] = None,
    extrapolate: Annotated[bool, option("--extrapolate")] = False,
    figure: Annotated[str | None, option("--figure")] = None,
    force: Annotated[bool, option("--force")] = False,
    digits: Annotated[str | None, option("--digits")] = None,
    as_json: Annotated[bool, option("--json")] = False,
    csv: Annotated[bool, option("--csv")] = False,
) -> None: ...


@app.command()
def tradeoff(
    m1: Annotated[str | None, option("--m1")] = None,
    m2: Annotated[str | None, option("--m2")] = None,
    M: Annotated[str | None, option("--M", "--pulley-mass")] = None,
    mu: Annotated[str | None, option("--mu")] = None,
    mu_k: Annotated[str | None, option("--mu-k")] = None,
    g: Annotated[str | None, option("--g")] = None,
    inertia: Annotated[str | None, option("--inertia")] = None,
    I: Annotated[str | None, option("--I")] = None,
    R: Annotated[str | None, option("--R", "--radius")] = None,
    wrap: Annotated[str | None, option("--wrap")] = None,
    family: Annotated[list[str] | None, option("--family")] = None,
    scenes: Annotated[str | None, option("--scenes")] = None,
    seed: Annotated[str | None, option("--seed")] = None,
    plot: Annotated[bool, option("--plot")] = False,
    figure: Annotated[str | None, option("--figure")] = None,
    force: Annotated[bool, option("--force")] = False,
    as_json: Annotated[bool, option("--json")] = False,
    csv: Annotated[bool, option("--csv")] = False,
) -> None: ...


@app.command()
def batch(
    table: str,
    output: Annotated[str, option("--output", "-o")] = "-",
    from_: Annotated[str | None, option("--from")] = None,
    to: Annotated[str | None, option("--to")] = None,
    only: Annotated[list[str] | None, option("--only")] = None,
    accuracy: Annotated[str, option("--accuracy")] = "certified",
    allow_errors: Annotated[bool, option("--allow-errors")] = False,
    force: Annotated[bool, option("--force")] = False,
) -> None: ...


if __name__ == "__main__":
    sys.exit(app())
