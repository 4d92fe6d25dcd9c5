"""A table of runs, from a file or from columns in Python, and the runs that its rows make."""

import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from fractions import Fraction
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
from ..tables.sheets import Sheet, sheet_of
from ..tables.sources import Unreadable

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
    "m1": "no column m1; name it, as --column m1='Masse 1 (g)'",
    "m2": "no column m2; name it, as --column m2='Masse 2 (g)'",
    "a time": "no column of times or accelerations; name it, as --column t='Zeit in s'",
    "a drop": "times need the height of fall: give drop, or a column of that name",
}
"""The columns of which a run needs one, and what is said if there is none."""
LIKE_UNCERTAINTY = re.compile(r"±|\+/-|[Δδσ]|\bu(?:[ _(]|$)|(?:\b|_)(?:err|unc)", re.IGNORECASE)
UNSIGNED = "accelerations have no sign here: none is negative, though m1 is the heavier at times."
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

    ``signed`` means that accelerations have signs, as one is negative: they are positive when m2 descends.
    """

    kind: Kind
    runs: Sequence[Run]
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
    sheet = sheet_of(source, VOCABULARY, named)
    headings = read_headings(sheet.columns, VOCABULARY, labels, named)
    names = {heading.name for heading in headings}
    kind: Kind = "a" if "a" in names else "time"
    headings = [heading for heading in headings if kind == "time" or heading.name != "drop"]
    headings, others = _with_unnamed(sheet, headings, labels)
    _check(names, drop)
    for number in without:
        if not 1 <= number <= len(sheet.rows):
            raise SceneError("without", f"{number}", f"is no row; there are 1 to {len(sheet.rows)}")
    places = [column.place for heading in headings for column in (heading, heading.u) if column]
    comma = decimal_commas_in(sheet.rows, places, sheet.separator)
    remarks = read_as(headings, sheet.separator, sheet.usual, comma, [*others, *sheet.remarks])
    common = drop and drop._replace(uncertainty=Fraction(0))  # what counts for all runs together
    rows = [_run(i, row, headings, comma, common, i in without) for i, row in enumerate(sheet.rows, 1)]
    remarks += [f"Row {run.rows[0]} has no {kind}: it is no run." for run in rows if not run.measured]
    runs = _joined(run for run in rows if run.measured)
    if not runs:
        raise Unreadable("it has no runs")
    signed = any(one.value < 0 for run in runs for one in run.measured)
    if kind == "a" and not signed and any(run.m1.value > run.m2.value for run in runs):
        remarks.append(UNSIGNED)
    return Runs(kind, runs, signed, remarks)


def _with_unnamed(
    sheet: Sheet, headings: Sequence[Heading], labels: Collection[str]
) -> tuple[list[Heading], list[str]]:
    """The columns, with repeats that have no heading of their own, as below a merged one; and what is said of
    other columns of numbers, which hold no quantity.

    Raises Unreadable for a column that could hold one, unless it is one of the ``labels``.
    """
    found = {heading.place: heading for heading in headings}
    taken = {*found, *(heading.u.place for heading in headings if heading.u)}
    others: list[str] = []
    for place, column in enumerate(sheet.columns):
        if place in taken or column in labels:
            continue
        if column in INPUTS:
            option = column.replace("_", "-")
            raise refused(column, f"holds for all runs, so it is an option: give --{option}")
        if not any(re.match(r"\s*[-+±]?[.,]?\d", row[place]) for row in sheet.rows):
            continue
        if not column.strip():
            before, name = found.get(place - 1), f"column {place + 1}"
            if not before or before.name not in MEASURED or before.u:
                raise Unreadable(f"{name} has numbers and no heading; give it one")
            found[place] = before._replace(place=place, column=name, number=name)
        elif LIKE_UNCERTAINTY.search(column):
            raise refused(column, "could be an uncertainty; name what of, as in 'u(t)'")
        else:
            others.append(f"{in_quotes(column)} as a label")
    return [found[place] for place in sorted(found)], others


def _check(names: Collection[str], drop: Input | None) -> None:
    """Raises Unreadable if a run lacks a column, or has times and accelerations; SceneError for a drop."""
    if "a" in names and "time" in names:
        raise Unreadable("there are columns a and time; keep one, or let one pass by --label")
    given = [*names, *["drop"] * (drop is not None)]
    for either, words in NEEDED.items():
        if not any(name in given for name in either.split()):
            raise Unreadable(words)
    if drop is not None and (has := next((name for name in ("a", "drop") if name in names), "")):
        raise SceneError("drop", drop.given, f"has no part here: the table has {has}")


def in_range(one: Input) -> bool:
    """Whether a number, and its uncertainty, are 0 or of a size whose squares are doubles."""
    low, high = MEASURABLE
    sizes = (getattr(one.value, "number", one.value), one.uncertainty)
    return all(low <= abs(size) <= high for size in sizes if size)


def _joined(rows: Iterable[Run]) -> list[Run]:
    """The runs of rows: those that differ only in what was measured are one."""
    alike: dict[object, Run] = {}
    for run in rows:
        key = run.m1[:2], run.m2[:2], run.drop and run.drop[:2], run.left_out
        if first := alike.get(key):
            run = first._replace(rows=first.rows + run.rows, measured=first.measured + run.measured)
        alike[key] = run
    return [*alike.values()]


def _run(
    number: int,
    row: Sequence[str],
    headings: Sequence[Heading],
    comma: bool,
    drop: Input | None,
    left_out: bool,
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
    return Run((number,), given["m1"], given["m2"], given.get("drop", drop), tuple(measured), left_out)


def _read_cell(heading: Heading, row: Sequence[str], comma: bool) -> Input | None:
    """A quantity of a row in SI units; None if its cell is empty. Raises SceneError."""
    cell = row[heading.place]
    given = read_cell(heading, cell, comma)
    if given and heading.u and (u := row[heading.u.place].strip()) not in EMPTY:
        if given.uncertainty:
            raise SceneError(heading.u.column, u, f"is a second uncertainty, beside {in_quotes(cell)}")
        given = given._replace(uncertainty=read_uncertainty(heading.u, u, given.value, comma))
    if given and not in_range(given):
        raise SceneError(heading.name, cell, BEYOND)
    return given
