"""A table of runs, from a file or from columns in Python, and the runs that its rows make."""

import re
from collections.abc import Collection, Mapping, Sequence
from contextlib import ExitStack
from fractions import Fraction
from os import PathLike, fspath
from pathlib import Path
from typing import Any, NamedTuple

from ..batch.formats import opened
from ..batch.layout import Heading, decimal_commas_in, read_as
from ..files import Unreadable
from ..model.scene import Input, SceneError, read_input
from ..model.units import PERCENT, in_quotes
from .cells import Cells, read_cells
from .headings import MASSES, Header, Kind, Quantity, as_input, not_recognised, read_header, recognised

OWN_UNIT = re.compile(r"(?![eE][+-]?\d)[^\W\d_]|°")
"""In a cell: a letter that is not an exponent's."""
EMPTY = ("nan", "None", "<NA>", "NaT", "--")
"""How Python and pandas write a missing value."""

MEASURABLE = 1e-30, 1e30
BEYOND = f"is beyond what a fit computes with, {MEASURABLE[0]} to {MEASURABLE[1]:.0e}"


def in_range(one: Input) -> bool:
    """Whether a number, and its uncertainty, are 0 or of a size whose squares are doubles."""
    low, high = MEASURABLE
    sizes = (getattr(one.value, "number", one.value), one.uncertainty)
    return all(low <= abs(size) <= high for size in sizes if size)


class Run(NamedTuple):
    """Masses, the height of fall if there is one, and what was measured, once or more often.

    ``rows`` are the numbers of its rows, which differ only in what was measured and in ``labels``. ``cells``
    says where each measurement stands, ``left_out`` that the user leaves the run out of the fit.
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
        """The double nearest to the mean of what was measured."""
        return float(sum((Fraction(one.value) for one in self.measured), Fraction(0)) / len(self.measured))

    @property
    def sign(self) -> int:
        """The sign of the mean."""
        return (self.mean > 0) - (self.mean < 0)

    def without(self, places: Collection[int]) -> "Run":
        """The run without some of its measurements."""
        kept = tuple(one for i, one in enumerate(self.measured) if i not in places)
        return self._replace(measured=kept)

    @property
    def name(self) -> str:
        """Its rows, for a sentence."""
        return f"row {self.rows[0]}" if len(self.rows) == 1 else f"rows {', '.join(map(str, self.rows))}"


class Runs(NamedTuple):
    """The runs of a table, and how it was read.

    ``one_drop`` means that all have the same height of fall, ``signed`` that accelerations have signs, as one
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
        labels: Headings of columns that belong to no run, whatever they look like.
        drop: The height of fall of all runs, if no column has it.
        without: Numbers of rows, from 1, that are read and marked as left out.

    Raises:
        Unreadable: It is no table of runs; the message says why.
        SceneError: The ``drop`` is not needed, or a row is not there.
    """
    if isinstance(source, str | PathLike):
        usual = "\t" if Path(source).suffix.lower() == ".tsv" else ","
        with ExitStack() as stack:
            cells = read_cells(opened(fspath(source), stack), usual, recognised)
    else:
        usual, cells = "", _cells_of(source)
    header = read_header(cells.columns, labels)
    quantities, kind = header.quantities, header.kind
    one_drop = "drop" not in [one.name for one in quantities]
    unknown = [column for column in header.others if column not in labels]
    _check_drop(drop, kind, one_drop, unknown)
    places = [at for one in quantities for at in (one.at, *(one.u or ())[:1])]
    end = len(cells.rows)
    while end > 1 and not any(re.search(r"\d", cells.rows[end - 1][at]) for at in places):
        end -= 1
    rows, totals = cells.rows[:end], cells.rows[end:]
    for number in without:
        if not 1 <= number <= end:
            raise SceneError("without", f"{number}", f"is no row; there are 1 to {end}")
    comma = decimal_commas_in(rows, places, cells.separator)
    also = [*(f"{in_quotes(column)} as a label" for column in unknown), *cells.remarks]
    remarks = read_as(_understood(quantities), cells.separator, usual, comma, also)
    said = (in_quotes(" ".join(filter(None, row))) for row in totals)
    remarks += [f"left out below the runs, as it has no numbers: {words}." for words in said]
    alike: dict[object, list[Run]] = {}
    for number, row in enumerate(rows, 1):
        run = _run(number, row, header, comma, drop)._replace(left_out=number in without)
        if run.measured:
            key = (run.m1[:2], run.m2[:2], run.drop and run.drop[:2], run.left_out)
            alike.setdefault(key, []).append(run)
        else:
            remarks.append(f"Row {number} has no {kind}: it is no run.")
    if not alike:
        raise Unreadable("it has no runs")
    runs = [_joined(repeats) for repeats in alike.values()]
    negative = any(one.value < 0 for run in runs for one in run.measured)
    if kind == "a" and not negative and any(run.m1.value > run.m2.value for run in runs):
        remarks.append(
            "accelerations have no sign here: none is negative, though m1 is the heavier at times."
        )
    return Runs(kind, runs, one_drop, negative, list(header.others), remarks)


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


def _check_drop(drop: Input | None, kind: Kind, one_drop: bool, unknown: Sequence[str]) -> None:
    """Raises Unreadable, SceneError."""
    if kind == "time" and drop is None and one_drop:
        why = "times need the height of fall: give drop, or a column of that name"
        raise Unreadable(f"{why}; {not_recognised(unknown)}" if unknown else why)
    if drop is not None and not in_range(drop):
        raise SceneError("drop", drop.given, BEYOND)
    if drop is not None and not (kind == "time" and one_drop):
        has = "drop" if kind == "time" else "a"
        raise SceneError("drop", drop.given, f"has no part here: the table has {has}")


def _understood(quantities: Sequence[Quantity]) -> list[tuple[str, Heading]]:
    """What each column was read as, in their order."""
    said = {one.at: (one.name, one.heading) for one in quantities}
    said |= {one.u[0]: (f"u({one.name})", one.u[1]) for one in quantities if one.u}
    return [said[at] for at in sorted(said)]


def _run(number: int, row: Sequence[str], header: Header, comma: bool, drop: Input | None) -> Run:
    """The run of one row. Raises Unreadable."""
    quantities, kind = header.quantities, header.kind
    try:
        read = [(one, value) for one in quantities if (value := _read(one, row, comma))]
        given = {one.name: value for one, value in read}
        for one in quantities:
            if one.name not in (*given, kind):
                raise Unreadable(f"row {number} has no {one.name}")
        m1, m2 = _masses(given)
    except SceneError as error:
        raise Unreadable(f"row {number}: {error}") from None
    measured = [(value, one.heading.column) for one, value in read if one.name == kind]
    several = [one.name for one in quantities].count(kind) > 1
    return Run(
        (number,),
        {name: row[at] for name, at in header.others.items()},
        m1,
        m2,
        given.get("drop", drop),
        tuple(value for value, _ in measured),
        tuple(f"row {number}" + f", {column}" * several for _, column in measured),
    )


def _masses(given: Mapping[str, Input]) -> tuple[Input, Input]:
    """m1 and m2, by the two columns that determine them. Raises SceneError."""
    one, other = (name for name in MASSES if name in given)
    x, y = given[one], given[other]
    if other == "m2":
        return x, y
    for name in (one, other):
        if given[name].uncertainty:
            why = "has an uncertainty, which is taken of m1 and m2 alone"
            raise SceneError(name, given[name].given, why)
    (a, b), (c, d) = MASSES[one], MASSES[other]
    of = a * d - b * c
    m1, m2 = (x.value * d - y.value * b) / of, (y.value * a - x.value * c) / of
    if min(m1, m2) < 0:
        raise SceneError(other, y.given, f"and {one} {in_quotes(x.given)} make a mass negative")
    return Input(m1, Fraction(0), None), Input(m2, Fraction(0), None)


def _joined(repeats: Sequence[Run]) -> Run:
    """One run of rows that repeat it."""
    rows, measured, cells = (
        tuple(one for part in some for one in part)
        for some in zip(*((run.rows, run.measured, run.cells) for run in repeats), strict=True)
    )
    return repeats[0]._replace(rows=rows, measured=measured, cells=cells)


def _read(one: Quantity, row: Sequence[str], comma: bool) -> Input | None:
    """A quantity of a row in SI units; None if its cell is empty. Raises SceneError."""
    cell = row[one.at]
    if not cell.strip():
        return None
    number = _pointed(one.name, cell, comma).strip()
    sign = -1 if one.name == "m2-m1" and number.startswith("-") else 1
    try:
        value, spread, _ = read_input(as_input(one.name), number[sign < 0 :])
    except SceneError as error:
        raise SceneError(one.name, cell, error.rule) from None
    if one.heading.unit and not OWN_UNIT.search(cell):
        value, spread = value * one.heading.factor, spread * one.heading.factor
    if one.u and (u := row[one.u[0]].strip()):
        if spread:
            raise SceneError(one.u[1].column, u, f"is a second uncertainty, beside {in_quotes(cell)}")
        spread = _spread(one.name, one.u[1], u, value, comma)
    given = Input(sign * value, spread, cell)
    if not in_range(given):
        raise SceneError(one.name, cell, BEYOND)
    return given


def _spread(name: str, heading: Heading, cell: str, value: Fraction, comma: bool) -> Fraction:
    """The uncertainty of a value, from a column of uncertainties. Raises SceneError."""
    number = _pointed(heading.column, cell, comma).lstrip("± ").removesuffix(PERCENT)
    relative = cell.endswith(PERCENT) or heading.unit == PERCENT
    try:
        spread = read_input(as_input(name), f"1±{number}{PERCENT * relative}").uncertainty
    except SceneError:
        raise SceneError(heading.column, cell, "is no uncertainty; write it like 0.02 or 2%") from None
    return spread * (abs(value) if relative else 1 if OWN_UNIT.search(cell) else heading.factor)


def _pointed(name: str, cell: str, comma: bool) -> str:
    """A cell with a decimal point. Raises SceneError."""
    if comma and "." in cell:
        raise SceneError(name, cell, "has a point in a table of decimal commas; write all alike")
    return cell.replace(",", ".") if comma else cell
