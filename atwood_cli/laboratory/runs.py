"""A table of runs, from a file or from columns in Python, and the runs that its rows make."""

import re
from collections.abc import Collection, Mapping, Sequence
from contextlib import ExitStack
from fractions import Fraction
from functools import cache, partial
from math import fsum
from os import PathLike, fspath
from pathlib import Path
from typing import Any, NamedTuple

from ..batch.formats import opened
from ..batch.layout import Heading, decimal_commas_in, listed, read_as
from ..files import Unreadable
from ..model.scene import Input, SceneError, read_input
from ..model.units import PERCENT, in_quotes
from .cells import Cells, read_cells, whole_rows
from .headings import (
    MASSES,
    Quantity,
    as_parameter,
    determinant,
    kind_of,
    not_known,
    quantities_among,
    recognised,
    two_of_masses,
)
from .headings import Kind as Kind  # others have it from here

PLAIN = re.compile(r"(\d{1,15})(?:\.(\d{1,15}))?", re.ASCII)
"""A number in a cell that is within all bounds unless it is 0."""
OWN_UNIT = re.compile(r"(?![eE][+-]?\d)[^\W\d_]|°")
"""In a cell: a letter that is not an exponent's."""
EMPTY = ("nan", "None", "<NA>", "NaT", "--")
"""How Python writes what is missing."""

MEASURABLE = 1e-30, 1e30
BEYOND = f"is beyond what a fit computes with, {MEASURABLE[0]} to {MEASURABLE[1]:.0e}"


def in_range(one: Input) -> bool:
    """Whether a number, and its uncertainty, are 0 or of a size that no square of them leaves the doubles."""
    low, high = MEASURABLE
    sizes = (getattr(one.value, "number", one.value), one.uncertainty)
    try:
        return all(low <= abs(float(size)) <= high for size in sizes if size)
    except OverflowError:
        return False


class Run(NamedTuple):
    """Masses, the height of fall if there is one, and what was measured once or more often.

    ``rows`` are the numbers of its rows, which are alike but for what was measured and for ``labels``;
    ``cells`` say where each measurement stands. ``left_out`` says that nobody wants it fitted.
    """

    rows: tuple[int, ...]
    labels: Mapping[str, str]
    m1: Input
    m2: Input
    drop: Input | None
    measured: tuple[Input, ...]
    cells: tuple[str, ...] = ()
    left_out: bool = False

    @property
    def mean(self) -> float:
        """The mean of what was measured, the double nearest to it."""
        first, *others = (Fraction(one.value) for one in self.measured)
        return float(sum(others, first) / len(self.measured) if others else first)

    @property
    def sign(self) -> int:
        """That of the mean."""
        total = fsum([float(one.value) for one in self.measured])
        return (total > 0) - (total < 0)

    def without(self, places: Collection[int]) -> "Run":
        """The run without some of its measurements."""
        kept = tuple(one for i, one in enumerate(self.measured) if i not in places)
        return self._replace(measured=kept)

    @property
    def name(self) -> str:
        """How a sentence calls it."""
        return f"row {self.rows[0]}" if len(self.rows) == 1 else f"rows {', '.join(map(str, self.rows))}"


class Runs(NamedTuple):
    """The runs of a table, and how it was read.

    ``one_drop`` says that they share their height of fall, ``signed`` that accelerations have signs, as one
    of them is negative: they are positive when m2 descends.
    """

    kind: Kind
    runs: Sequence[Run]
    one_drop: bool
    signed: bool
    labels: Sequence[str]
    remarks: Sequence[str]


def read_runs(
    source: Any, labels: Collection[str] = (), drop: Input | None = None, without: Collection[int] = ()
) -> Runs:
    """The runs of a table, a row a run.

    Args:
        source: The path of a CSV or .tsv file, "-" for stdin, a mapping of columns of equal length by their
            headings, or a data frame of pandas or polars, in which None, NaN and null are empty cells.
        labels: Headings of columns that are no part of a run, whatever they look like.
        drop: The height of fall of all runs, if no column has it.
        without: Numbers of rows, from 1, that are read and marked as left out.

    Raises:
        Unreadable: It is no table of runs; the message says why.
        SceneError: The ``drop`` is not needed, or a row is not there.
    """
    if not isinstance(source, str | PathLike):
        return _runs(_cells_of(source), "", labels, drop, without)
    usual = "\t" if Path(source).suffix.lower() == ".tsv" else ","
    with ExitStack() as stack:
        cells = read_cells(opened(fspath(source), stack), usual, recognised)
    return _runs(cells, usual, labels, drop, without)


def _cells_of(frame: Any) -> Cells:
    """A mapping or a data frame as a table of texts. Raises Unreadable."""
    if not hasattr(frame, "items") and not hasattr(frame, "columns"):
        raise Unreadable(f"it is of type {type(frame).__name__}; give a path, a mapping or a data frame")
    columns: list[tuple[str, list[str]]] = []
    for name, cells in frame.items() if hasattr(frame, "items") else zip(frame.columns, frame, strict=True):
        if isinstance(cells, str) or not hasattr(cells, "__iter__"):
            raise Unreadable(
                f"column {in_quotes(name)} is of type {type(cells).__name__}; give a sequence of cells"
            )
        columns.append((str(name), ["" if str(cell) in EMPTY else str(cell) for cell in cells]))
    if len({len(cells) for _, cells in columns}) > 1:
        lengths = ", ".join(f"{in_quotes(name)} has {len(cells)} cells" for name, cells in columns)
        raise Unreadable(f"its columns differ in length: {lengths}")
    return Cells([name for name, _ in columns], list(zip(*(cells for _, cells in columns), strict=True)), "")


def _runs(
    cells: Cells, usual: str, labels: Collection[str], drop: Input | None, without: Collection[int]
) -> Runs:
    """The runs of a table of texts. Raises Unreadable, SceneError."""
    quantities, others = quantities_among(cells.columns, labels)
    unknown = [column for column in others if column not in labels]
    masses = two_of_masses(quantities, unknown, cells.columns)
    kind = kind_of(quantities, unknown, cells.columns)
    needed = (*(one.name for one in masses), *["drop"] * (kind == "time"), kind)
    spare = [one for one in quantities if one.name not in needed]
    quantities = [one for one in quantities if one.name in needed]
    one_drop = "drop" not in [one.name for one in quantities]
    _check_drop(drop, kind, one_drop, unknown)
    places = [at for one in quantities for at in (one.at, *(one.u or ())[:1])]
    rows, remarks = _without_totals(whole_rows(cells), places)
    comma = decimal_commas_in(rows, places, cells.separator)
    others |= {one.heading.column: one.at for one in spare}
    labelled = [f"{in_quotes(column)} as a label" for column in others if column not in labels]
    also = (*labelled, *cells.remarks)
    remarks = [*read_as(_understood(quantities), cells.separator, usual, comma, also), *remarks]
    for number in without:
        if not 1 <= number <= len(rows):
            raise SceneError("without", f"{number}", f"is no row; there are 1 to {len(rows)}")
    alike: dict[object, list[Run]] = {}
    readers = [(one, cache(partial(_read, one, comma=comma))) for one in quantities]  # most numbers repeat
    several = [one.name for one in quantities].count(kind) > 1
    for number, row in enumerate(rows, 1):
        try:
            read = [(one, reader(row[one.at], row[one.u[0]] if one.u else "")) for one, reader in readers]
            given = {one.name: value for one, value in read if value is not None}
            for one in quantities:
                if one.name not in given and one.name != kind:
                    raise Unreadable(f"row {number} has no {one.name}")
            m1, m2 = _masses(*((one, given[one.name]) for one in masses))
        except SceneError as error:
            raise Unreadable(f"row {number}: {error}") from None
        measured = [(value, one.heading.column) for one, value in read if one.name == kind and value]
        if not measured:
            remarks.append(f"Row {number} has no {kind}: it is no run.")
            continue
        values = tuple(value for value, _ in measured)
        names = tuple(f"row {number}" + f", {column}" * several for _, column in measured)
        said = {name: row[at] for name, at in others.items()}
        run = Run((number,), said, m1, m2, given.get("drop", drop), values, names, number in without)
        key = (_ratios(m1), _ratios(m2), run.drop and _ratios(run.drop), run.left_out)
        alike.setdefault(key, []).append(run)
    if not alike:
        raise Unreadable("it has no runs")
    runs = [_joined(repeats) for repeats in alike.values()]
    negative = any(one.value < 0 for run in runs for one in run.measured)
    if kind == "a" and not negative and any(run.m1.value > run.m2.value for run in runs):
        remarks.append(
            "accelerations have no sign here: none is negative, though m1 is the heavier at times."
        )
    return Runs(kind, runs, one_drop, negative, list(others), remarks)


def _check_drop(drop: Input | None, kind: Kind, one_drop: bool, unknown: Sequence[str]) -> None:
    """Raises Unreadable, SceneError."""
    if kind == "time" and drop is None and one_drop:
        why = "times need the height of fall: a column drop, or --drop"
        raise Unreadable(f"{why}; {not_known(unknown)}" if unknown else why)
    if drop is not None and not in_range(drop):
        raise SceneError("drop", drop.given, BEYOND)
    if drop is not None and not (kind == "time" and one_drop):
        has = "drop" if kind == "time" else "a"
        raise SceneError("drop", drop.given, f"has no part here: the table has {has}")


def _ratios(one: Input) -> tuple[object, object]:
    """An input as integers, whose hash takes a tenth of the time."""
    return one.value.as_integer_ratio(), one.uncertainty.as_integer_ratio()


def _joined(repeats: Sequence[Run]) -> Run:
    """One run of rows that repeat it."""
    if not repeats[1:]:
        return repeats[0]
    rows, measured, cells = (
        tuple(one for part in some for one in part)
        for some in zip(*((run.rows, run.measured, run.cells) for run in repeats), strict=True)
    )
    return repeats[0]._replace(rows=rows, measured=measured, cells=cells)


def _understood(quantities: Sequence[Quantity]) -> list[tuple[str, Heading]]:
    """What is said of each column, in their order."""
    said = {one.at: (one.name, one.heading) for one in quantities}
    for one in quantities:
        if one.u:
            many = one.u[0] in said
            said[one.u[0]] = (f"u of each {one.name}" if many else f"u({one.name})", one.u[1])
    return [said[at] for at in sorted(said)]


def _without_totals(
    rows: Sequence[Sequence[str]], places: Collection[int]
) -> tuple[list[Sequence[str]], list[str]]:
    """The rows without the last ones if these have no numbers, and what is said of those."""
    end = len(rows)
    while end > 1 and not any(re.search(r"\d", rows[end - 1][at]) for at in places):
        end -= 1
    totals = [" ".join(filter(None, row)) for row in rows[end:]]
    remarks = [f"left out below the runs, as it has no numbers: {listed(totals)}."] if totals else []
    return list(rows[:end]), remarks


def _masses(one: tuple[Quantity, Input], other: tuple[Quantity, Input]) -> tuple[Input, Input]:
    """m1 and m2, by what two columns say. Raises SceneError."""
    (first, x), (second, y) = one, other
    if second.name == "m2":
        return x, y
    (a, b), (c, d), of = MASSES[first.name], MASSES[second.name], determinant(first, second)
    m1, m2 = (x.value * d - y.value * b) / of, (y.value * a - x.value * c) / of
    for column, value in one, other:
        if value.uncertainty:
            rule = "has an uncertainty, which is taken of m1 and m2 alone"
            raise SceneError(column.name, value.given, rule)
    if min(m1, m2) < 0:
        raise SceneError(second.name, y.given, f"and {first.name} {in_quotes(x.given)} make a mass negative")
    return Input(m1, Fraction(0), None), Input(m2, Fraction(0), None)


def _read(one: Quantity, cell: str, u: str, comma: bool) -> Input | None:
    """A quantity in SI units by its cell and that of its uncertainty; None if empty. Raises SceneError."""
    if not cell.strip():
        return None
    number = _pointed(one.name, cell, comma).strip()
    negative = one.name in ("m2-m1", "m1-m2") and number.startswith("-")
    number = number.removeprefix("-" * negative)
    if (plain := PLAIN.fullmatch(number)) and (digits := int(plain[1] + (plain[2] or ""))):
        value, spread = Fraction(digits, 10 ** len(plain[2] or "")), Fraction(0)  # in a fifth of the time
    else:
        try:
            value, spread, _ = read_input(as_parameter(one.name), number)
        except SceneError as error:
            raise SceneError(one.name, cell, error.rule) from None
    if one.heading.unit and not OWN_UNIT.search(cell):
        value, spread = value * one.heading.factor, spread * one.heading.factor
    if one.u and u.strip():
        if spread:
            raise SceneError(one.u[1].column, u, f"is a second uncertainty, beside {in_quotes(cell)}")
        spread = _spread(one, u.strip(), value, comma)
    given = Input(-value if negative else value, spread, cell)
    if not (plain and not spread) and not in_range(given):
        raise SceneError(one.name, cell, BEYOND)
    return given


def _spread(one: Quantity, cell: str, value: Fraction, comma: bool) -> Fraction:
    """The uncertainty of a value that the cell of another column holds. Raises SceneError."""
    assert one.u
    heading = one.u[1]
    number = _pointed(heading.column, cell, comma).lstrip("± ").removesuffix(PERCENT)
    relative = cell.endswith(PERCENT) or heading.unit == PERCENT
    try:
        spread = read_input(as_parameter(one.name), f"1±{number}{PERCENT * relative}").uncertainty
    except SceneError:
        raise SceneError(heading.column, cell, "is no uncertainty; write it like 0.02 or 2%") from None
    return spread * (abs(value) if relative else 1 if OWN_UNIT.search(cell) else heading.factor)


def _pointed(name: str, cell: str, comma: bool) -> str:
    """A cell with a decimal point. Raises SceneError."""
    if comma and "." in cell:
        raise SceneError(name, cell, "has a point in a table of decimal commas; write all alike")
    return cell.replace(",", ".") if comma else cell
