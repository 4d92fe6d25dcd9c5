"""A table of runs, from a file or from columns in Python, and the runs that its rows make."""

import re
from collections.abc import Collection, Mapping, Sequence
from contextlib import ExitStack
from fractions import Fraction
from os import PathLike, fspath
from pathlib import Path
from typing import Any, Literal, NamedTuple

from ..model.scene import INPUTS, Input, SceneError
from ..model.units import in_quotes
from ..tables.headings import (
    EMPTY,
    Heading,
    Vocabulary,
    decimal_commas_in,
    read_as,
    read_cell,
    read_headings,
    read_uncertainty,
    refused,
)
from ..tables.sheets import Sheet, read_sheet
from ..tables.sources import Unreadable, blocks_of, opened, whole_lines

Kind = Literal["a", "time"]
MEASURED = {"a": "acceleration", "time": "time"}
"""The quantities that are measured, which may be repeated in further columns."""
TAKEN = ("m1", "m2", "drop", "a", "time")
"""The quantities of a run; what else a scene has is the same in all runs."""
WORDS = {"m1": "m1", "m2": "m2", "drop": "drop h height", "a": "a acceleration", "time": "t time"}
SPELLINGS = {word: name for name, words in WORDS.items() for word in words.split()}
SPELLINGS |= {word.capitalize(): name for word, name in SPELLINGS.items()}
VOCABULARY = Vocabulary(SPELLINGS, repeated=MEASURED, uncertain=True)
NEEDED = {
    "m1": "m1; name it, as --column m1='Masse 1 (g)'",
    "m2": "m2; name it, as --column m2='Masse 2 (g)'",
    "a time": "of times or accelerations; name it, as --column t='Zeit in s'",
}
LIKE_UNCERTAINTY = re.compile(r"±|\+/-|[Δδσ]|\bu(?:[ _(]|$)|(?:\b|_)(?:err|unc)", re.IGNORECASE)
UNSIGNED = "accelerations have no sign here: none is negative, though m1 is the heavier at times."
MISSING = ("nan", "None", "<NA>", "NaT")
"""How Python writes a missing value."""
MEASURABLE = 1e-30, 1e30
BEYOND = f"is beyond what a fit computes with, {MEASURABLE[0]} to {MEASURABLE[1]:.0e}"


class Run(NamedTuple):
    """Masses, the height of fall if there is one, and what was measured, once or more often.

    ``rows`` are the numbers of its rows, which differ only in what was measured; ``left_out`` says that the
    user leaves the run out of the fit.
    """

    rows: tuple[int, ...]
    m1: Input
    m2: Input
    drop: Input | None
    measured: tuple[Input, ...]
    left_out: bool = False

    @property
    def mean(self) -> float:
        """The double nearest to the mean of what was measured."""
        return float(sum((Fraction(one.value) for one in self.measured), Fraction(0)) / len(self.measured))

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
    remarks: Sequence[str]


def read_runs(
    source: Any,
    labels: Collection[str] = (),
    drop: Input | None = None,
    without: Collection[int] = (),
    named: Mapping[str, str] = {},
) -> Runs:
    """The runs of a table, a row a run.

    ``source`` is the path of a CSV or .tsv file, "-" for stdin, or columns by their headings: a mapping or a
    data frame. ``labels`` are headings that belong to no run, ``named`` maps headings to what they mean, and
    ``drop`` is the height of fall of all runs. The rows ``without``, by numbers from 1, are marked as left
    out. Raises Unreadable where it is no table of runs, SceneError for what does not fit the table.
    """
    usual = "\t" if isinstance(source, str | PathLike) and Path(source).suffix.lower() == ".tsv" else ","
    sheet = _sheet_of(source, usual, named)
    headings = _with_unnamed(sheet, read_headings(sheet.columns, VOCABULARY, labels, named))
    kind = _kind_of({one.name for one in headings})
    headings = [one for one in headings if kind == "time" or one.name != "drop"]
    one_drop = "drop" not in [one.name for one in headings]
    _check_drop(drop, kind, one_drop)
    unread = _unread(sheet, headings, labels)
    for number in without:
        if not 1 <= number <= len(sheet.rows):
            raise SceneError("without", f"{number}", f"is no row; there are 1 to {len(sheet.rows)}")
    places = [column.at for one in headings for column in (one, one.u) if column]
    comma = decimal_commas_in(sheet.rows, places, sheet.separator)
    also = [*(f"{in_quotes(column)} as a label" for column in unread), *sheet.remarks]
    remarks = read_as(headings, sheet.separator, usual * bool(sheet.separator), comma, also)
    joined = _joined([_run(n, row, headings, comma, drop) for n, row in enumerate(sheet.rows, 1)], without)
    remarks += [f"Row {run.rows[0]} has no {kind}: it is no run." for run in joined if not run.measured]
    runs = [run for run in joined if run.measured]
    if not runs:
        raise Unreadable("it has no runs")
    signed = any(one.value < 0 for run in runs for one in run.measured)
    if kind == "a" and not signed and any(run.m1.value > run.m2.value for run in runs):
        remarks.append(UNSIGNED)
    return Runs(kind, runs, one_drop, signed, remarks)


def _sheet_of(source: Any, usual: str, named: Mapping[str, str]) -> Sheet:
    """A file, a mapping or a data frame as a table of texts. Raises Unreadable."""
    if isinstance(source, str | PathLike):
        with ExitStack() as stack:
            blocks = blocks_of(opened(fspath(source), stack))
            content = b"".join(lines for lines, _ in whole_lines(blocks, cells=True))
        return read_sheet(content, usual, VOCABULARY, named)
    return _sheet_of_columns(source)


def _sheet_of_columns(source: Any) -> Sheet:
    """A mapping or a data frame as a table of texts. Raises Unreadable."""
    if not hasattr(source, "items") and not hasattr(source, "columns"):
        raise Unreadable(f"it is of type {type(source).__name__}; give a path, a mapping or a data frame")
    columns: list[tuple[str, list[str]]] = []
    for name, cells in (
        source.items() if hasattr(source, "items") else zip(source.columns, source, strict=True)
    ):
        if isinstance(cells, str) or not hasattr(cells, "__iter__"):
            what = f"column {in_quotes(name)} is of type {type(cells).__name__}"
            raise Unreadable(f"{what}; give a sequence of cells")
        columns.append((str(name), ["" if str(cell) in MISSING else str(cell) for cell in cells]))
    if len({len(cells) for _, cells in columns}) > 1:
        lengths = ", ".join(f"{in_quotes(name)} has {len(cells)} cells" for name, cells in columns)
        raise Unreadable(f"its columns differ in length: {lengths}")
    return Sheet([name for name, _ in columns], list(zip(*(cells for _, cells in columns), strict=True)))


def _with_unnamed(sheet: Sheet, headings: Sequence[Heading]) -> list[Heading]:
    """The columns, with repeats that have no heading of their own, as below a merged one.

    Raises Unreadable for any other column of numbers without a heading.
    """
    found = {one.at: one for one in headings}
    for at, column in enumerate(sheet.columns):
        if column.strip() or not _has_numbers(sheet, at):
            continue
        before = found.get(at - 1)
        if not before or before.name not in MEASURED or before.u:
            raise Unreadable(f"column {at + 1} has numbers and no heading; give it one")
        name = f"column {at + 1}"
        found[at] = before._replace(at=at, column=name, number=name)
    return [found[at] for at in sorted(found)]


def _has_numbers(sheet: Sheet, at: int) -> bool:
    """Whether a column has cells that begin as numbers do."""
    return any(re.match(r"\s*[-+±]?[.,]?\d", row[at]) for row in sheet.rows)


def _kind_of(names: set[str]) -> Kind:
    """Whether accelerations or times were measured; Unreadable if a run lacks a column, or has both."""
    if {"a", "time"} <= names:
        raise Unreadable("there are columns a and time; keep one, or let one pass by --label")
    for either, words in NEEDED.items():
        if not names & {*either.split()}:
            raise Unreadable(f"no column {words}")
    return "a" if "a" in names else "time"


def _unread(sheet: Sheet, headings: Sequence[Heading], labels: Collection[str]) -> list[str]:
    """The columns of numbers that hold no quantity, and that the user does not name as such.

    Raises Unreadable for those that could hold one.
    """
    taken = {column.at for one in headings for column in (one, one.u) if column}
    unread: list[str] = []
    for at, column in enumerate(sheet.columns):
        if at in taken or not column.strip() or column in labels:
            continue
        if column in INPUTS:
            option = column.replace("_", "-")
            raise refused(column, f"holds for all runs, so it is an option: give --{option}")
        if _has_numbers(sheet, at):
            if LIKE_UNCERTAINTY.search(column):
                raise refused(column, "could be an uncertainty; name what of, as in 'u(t)'")
            unread.append(column)
    return unread


def _check_drop(drop: Input | None, kind: Kind, one_drop: bool) -> None:
    """Raises Unreadable, SceneError."""
    if kind == "time" and drop is None and one_drop:
        raise Unreadable("times need the height of fall: give drop, or a column of that name")
    if drop is not None and not in_range(drop):
        raise SceneError("drop", drop.given, BEYOND)
    if drop is not None and not (kind == "time" and one_drop):
        has = "drop" if kind == "time" else "a"
        raise SceneError("drop", drop.given, f"has no part here: the table has {has}")


def in_range(one: Input) -> bool:
    """Whether a number, and its uncertainty, are 0 or of a size whose squares are doubles."""
    low, high = MEASURABLE
    sizes = (getattr(one.value, "number", one.value), one.uncertainty)
    return all(low <= abs(size) <= high for size in sizes if size)


def _joined(rows: Sequence[Run], without: Collection[int]) -> list[Run]:
    """The runs of rows: those that differ only in what was measured are one; others are as they are."""
    alike: dict[object, Run] = {}
    for run in rows:
        run = run._replace(left_out=run.rows[0] in without)
        key = (run.m1[:2], run.m2[:2], run.drop and run.drop[:2], run.left_out, run.rows[: not run.measured])
        if first := alike.get(key):
            run = first._replace(rows=first.rows + run.rows, measured=first.measured + run.measured)
        alike[key] = run
    return [*alike.values()]


def _run(
    number: int, row: Sequence[str], headings: Sequence[Heading], comma: bool, drop: Input | None
) -> Run:
    """The run of one row. Raises Unreadable."""
    given, measured = dict[str, Input](), list[Input]()
    try:
        for heading in headings:
            value = _read_cell(heading, row, comma)
            if value and heading.name in MEASURED:
                measured.append(value)
            elif value:
                given[heading.name] = value
            elif heading.name not in MEASURED:
                raise Unreadable(f"row {number} has no {heading.name}")
    except SceneError as error:
        raise Unreadable(f"row {number}: {error}") from None
    m1, m2, drop = given["m1"], given["m2"], given.get("drop", drop)
    return Run((number,), m1, m2, drop, tuple(measured))


def _read_cell(heading: Heading, row: Sequence[str], comma: bool) -> Input | None:
    """A quantity of a row in SI units; None if its cell is empty. Raises SceneError."""
    cell = row[heading.at]
    given = read_cell(heading, cell, comma)
    if given and heading.u and (u := row[heading.u.at].strip()) not in EMPTY:
        if given.uncertainty:
            raise SceneError(heading.u.column, u, f"is a second uncertainty, beside {in_quotes(cell)}")
        given = given._replace(uncertainty=read_uncertainty(heading.u, u, given.value, comma))
    if given and not in_range(given):
        raise SceneError(heading.name, cell, BEYOND)
    return given
