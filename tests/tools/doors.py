"""The ways to a value: from Python, the command line and tables, of scenes given as texts or as doubles."""

import csv
import io
import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from decimal import Decimal
from math import isnan, ulp
from typing import Any, NamedTuple

import numpy as np
import polars as pl

from atwood_cli import REGIMES, solve, solve_arrays, solve_table
from atwood_cli.solver.quantities import NAMES as EVERY_SCENE
from atwood_cli.solver.quantities import QUANTITIES, TABLE_NAMES
from atwood_cli.solver.scene import COLUMNS, FALL, INPUTS

from .running import called
from .scenes import Given

Values = Mapping[str, Any]
NAMES = [name for name in TABLE_NAMES if name not in COLUMNS]  # a height is a column that is given
TABLE_INPUTS = [*INPUTS, "drop"]
solve_any: Any = solve  # with inputs that are put together here


class Door(NamedTuple):
    """A way to the values of scenes, and how right they are: to digits, or to the double that is nearest.

    A slow one is tried on every so many scenes. What stands on paper has nothing where a value is infinite.
    Not all of them take measured motions.
    """

    open: Callable[[Sequence[Given]], Iterator[Values]]
    digits: int | None = None
    every: int = 1
    on_paper: bool = False
    certified: bool = False
    takes_motion: bool = True


def within_promise(got: float, nearest: float) -> bool:
    """Whether a double is within 2e-14 of the exact value, to which `nearest` is the nearest double."""
    return got == nearest or abs(got - nearest) <= 2e-14 * abs(nearest) + 0.5 * ulp(nearest)


def words(given: Given) -> list[str]:
    """The options that give the scene."""
    return [f"--{name.replace('_', '-')}={text}" for name, text in given.items()]


def out_of(command: str, given: Given, *more: str) -> str:
    """What the command prints of the scene: nothing where values that are asked for need another input."""
    ran = called([command, *words(given), *more])
    assert ran.status in (0, 1) or "give M" in ran.err, (given, ran.err)
    return ran.out


def of_solutions(
    digits: int | None, names: Sequence[str] = ("regime", *QUANTITIES)
) -> Callable[[Sequence[Given]], Iterator[Values]]:
    def values(scenes: Sequence[Given]) -> Iterator[Values]:
        for given in scenes:
            solution = solve_any(**given, digits=digits)
            yield {name: getattr(solution, name) for name in names}

    return values


def of_json(*more: str) -> Callable[[Sequence[Given]], Iterator[Values]]:
    def values(scenes: Sequence[Given]) -> Iterator[Values]:
        for given in scenes:
            yield json.loads(out_of("solve", given, "--json", *more), parse_float=Decimal, parse_int=Decimal)

    return values


def of_sweeps(scenes: Sequence[Given]) -> Iterator[Values]:
    """The first row of two."""
    for given in scenes:
        both = {"m1", "m2"} <= given.keys()
        swept = given | ({"m2": f"{given['m2']},{given['m1']}"} if both else {"mu": f"{given['mu']},1"})
        yield next(results([given], of_csv(out_of("sweep", swept, "--csv", "--only", ",".join(NAMES)))))


def of_contact(scenes: Sequence[Given]) -> Iterator[Values]:
    for given in scenes:
        found = json.loads(out_of("contact", given, "--json", "--points", "2") or "{}")
        ends = {f"tension_{i}": point["tension"] for i, point in enumerate(found.get("points", []), start=1)}
        yield {"regime": found["regime"], **ends} if found else {}


def of_csv(text: str) -> Iterator[Values]:
    for row in csv.DictReader(io.StringIO(text)):
        yield {x: (cell if x == "regime" else float(cell)) if cell else None for x, cell in row.items()}


def of_batch(scenes: Sequence[Given]) -> Iterator[Values]:
    table = io.StringIO()
    writer = csv.DictWriter(table, TABLE_INPUTS, extrasaction="ignore")
    writer.writeheader()
    writer.writerows(scenes)
    ran = called(["batch", "-", "--only", ",".join(NAMES)], table.getvalue().encode())
    assert "no errors" in ran.err, ran.err
    return results(scenes, of_csv(ran.out))


def of_table(scenes: Sequence[Given]) -> Iterator[Values]:
    columns = {x: [float(given[x]) if x in given else None for given in scenes] for x in TABLE_INPUTS}
    frame = solve_table(pl.DataFrame(columns, schema=dict.fromkeys(TABLE_INPUTS, pl.Float64)), NAMES)
    return results(scenes, frame.iter_rows(named=True))


def results(scenes: Sequence[Given], rows: Iterable[Values]) -> Iterator[Values]:
    """Without the columns of inputs, m1 and so on; nothing of a fall by time or speed, which are no columns."""
    for given, row in zip(scenes, rows, strict=False):
        yield {x: row[x] for x in NAMES if x in EVERY_SCENE or not {"time", "speed"} & given.keys()}


def of_arrays(accuracy: Any) -> Callable[[Sequence[Given]], Iterator[Values]]:
    def values(scenes: Sequence[Given]) -> Iterator[Values]:
        results = solve_arrays(**columns_of(scenes), accuracy=accuracy, quantities=NAMES)
        assert not results["status"].any()
        for i in range(len(scenes)):
            row = {name: results[name][i].item() for name in NAMES}
            values = {name: None if isnan(value) else value for name, value in row.items()}
            yield values | {"regime": REGIMES[row["regime"]]}

    return values


def columns_of(scenes: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """They cannot be written to, so that every test sees that inputs are left alone."""
    columns = {
        name: np.ma.array(
            [float(given.get(name, 0)) for given in scenes], mask=[name not in given for given in scenes]
        )
        for name in COLUMNS
        if name not in FALL or any(name in given for given in scenes)
    }
    for column in columns.values():
        column.flags.writeable = False
    return columns


TEXTS = {
    "doubles": Door(of_solutions(None)),
    "6 digits": Door(of_solutions(6), 6, every=4),
    "40 digits": Door(of_solutions(40), 40, every=2),
    **{f"{digits} digits": Door(of_solutions(digits), digits, every=8) for digits in (1, 17)},
    # The bounds of friction, which are roots, take a second each.
    "1000 digits": Door(
        of_solutions(1000, [name for name in QUANTITIES if "_force_m" not in name]), 1000, every=32
    ),
    "JSON": Door(of_json(), every=16, on_paper=True),
    "JSON, 30 digits": Door(of_json("--digits", "30"), 30, every=16, on_paper=True),
    "a sweep": Door(of_sweeps, every=16, on_paper=True, takes_motion=False),
    "contact": Door(of_contact, every=16, on_paper=True, takes_motion=False),
}
"""Doors for scenes as people type them."""
DOUBLES = {
    "certified": Door(of_arrays("certified"), certified=True),
    "exact": Door(of_arrays("exact")),
    "batch": Door(of_batch, every=4, on_paper=True),
    "a table": Door(of_table, every=4, on_paper=True),
}
"""Doors for scenes whose numbers are doubles."""
