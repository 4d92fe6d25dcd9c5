"""A table of runs, from a file or from columns in Python, and the runs that its rows make."""

import re
from collections.abc import Collection, Iterable, Mapping, Sequence, Set
from contextlib import suppress
from fractions import Fraction
from shlex import quote
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..model.digits import exact_decimal
from ..model.scene import INPUTS, Input, SceneError
from ..model.units import in_quotes
from ..tables.headings import (
    EMPTY,
    Heading,
    Vocabulary,
    decimal_commas_in,
    divisions,
    listed,
    read_as,
    read_cell,
    read_headings,
    read_uncertainty,
    recognised,
    refused,
    unit_factor,
)
from ..tables.sheets import Sheet, sheet_of
from ..tables.sources import Unreadable

Column = NDArray[np.float64]
Places = NDArray[np.intp]
Selection = NDArray[np.bool_]
Kind = Literal["a", "time"]
MEASURED = {"a": "acceleration", "time": "time"}
"""The quantities that are measured, which may be repeated in further columns."""
WORDS = {"m1": "m1", "m2": "m2", "drop": "drop h height", "a": "a acceleration", "time": "t time"}
"""The quantities of a run, by the words of headings; all others are the same in all runs."""
SPELLINGS = {word: name for name, words in WORDS.items() for word in words.split()}
SPELLINGS |= {word.capitalize(): name for word, name in SPELLINGS.items()}
VOCABULARY = Vocabulary(SPELLINGS, repeated=MEASURED, uncertain=True)
LIKE_UNCERTAINTY = re.compile(r"±|\+/-|[Δδσ]|\bu(?:[ _(]|$)|(?:\b|_)(?:err|unc)", re.IGNORECASE)
LIKE_NUMBER = re.compile(r"\s*[-+±]?[.,]?\d")
NO_RUN = "a line of words, means or units is no run: begin it with # (units go into headings, as m1 (g))"
HEAVY = 10
"""The mass (kg) above which a laboratory may have left out a unit."""
MEASURABLE = 1e-30, 1e30
OUT_OF_RANGE = f"is beyond what a fit computes with, {MEASURABLE[0]} to {MEASURABLE[1]:.0e}"


class Runs(NamedTuple):
    """The n runs of a table, and all their measurements, run by run.

    Columns of runs (n): ``given`` has m1 and m2 (kg), and drop (m) if times were measured, ``u`` their
    uncertainties; ``rows`` are the numbers of their rows. Columns of measurements: ``values``, ``u_values``
    (0 if no uncertainty is stated), the ``run`` of each, and ``cells``, where they stand, as --without takes
    it: 8:t2. ``step`` is that of the last digit of any, 0 if one is no decimal.

    If an acceleration is negative, all have signs, and the ``sign`` of a run is that of m2 - m1: values and
    their ``mean`` are multiplied by it, so that they are positive if the heavier side falls.
    """

    kind: Kind
    given: Mapping[str, Column]
    u: Mapping[str, Column]
    rows: Sequence[Sequence[int]]
    left_out: Selection
    sign: Column
    mean: Column
    values: Column
    u_values: Column
    run: Places
    cells: Sequence[str]
    step: float = 0.0
    remarks: Sequence[str] = ()

    def rows_in_words(self, *runs: int) -> str:
        """Return the rows of these runs for a sentence: row 1, or rows 1, 2."""
        rows = [str(row) for i in runs for row in self.rows[i]]
        return f"row{'s' if rows[1:] else ''} {', '.join(rows)}"


Row = tuple[int, Mapping[str, Input], Mapping[str, Input]]
"""The number of a row, its masses and its height by name, and its measurements by their cells."""


def read_runs(
    source: Any,
    labels: Collection[str] = (),
    drop: Input | None = None,
    without: Collection[int | str] = (),
    named: Mapping[str, str] = {},
) -> Runs:
    """Return the runs of a table; rows that differ only in what was measured are one run.

    ``source`` is the path of a CSV or .tsv file, "-" for stdin, or columns by their headings: a mapping or a
    data frame. ``labels`` are headings that belong to no run, ``named`` maps headings to what they mean, and
    ``drop`` is the height of fall of all runs. Rows ``without``, by numbers from 1, and their cells, as 8:t2,
    are left out. Raises Unreadable if it is no table of runs, SceneError for what does not fit the table.
    """
    sheet = sheet_of(source, VOCABULARY, named)
    headings = read_headings(sheet.columns, VOCABULARY, labels, named)
    _check(sheet, headings, drop, named)
    kind: Kind = "a" if any(heading.name == "a" for heading in headings) else "time"
    headings = [heading for heading in headings if kind == "time" or heading.name != "drop"]
    others = _labels(sheet, headings, labels)
    places = [column.place for heading in headings for column in (heading, heading.u) if column]
    comma = decimal_commas_in(sheet.rows, places, sheet.separator)
    remarks = read_as(headings, sheet.separator, comma, [*others, *sheet.remarks])
    left_out = _read_without(without, len(sheet.rows), headings)
    try:
        rows = [_read_row(number, row, headings, comma) for number, row in enumerate(sheet.rows, 1)]
    except Unreadable as error:
        raise Unreadable(f"{error}{behind_an_error(remarks)}") from None
    remarks += [f"row {number} has no {kind}: it is not used." for number, _, cells in rows if not cells]
    if without:
        remarks.append(f"left out, as asked: {', '.join(in_words(str(word)) for word in without)}.")
    same: dict[object, list[Row]] = {}
    for row in rows:
        if row[2]:
            same.setdefault(tuple(one[:2] for one in row[1].values()), []).append(row)
    if not same:
        raise Unreadable("it has no runs")
    return _as_columns(kind, [*same.values()], drop, left_out, remarks)


def _as_columns(
    kind: Kind, runs: Sequence[Sequence[Row]], drop: Input | None, left_out: Set[str], remarks: Sequence[str]
) -> Runs:
    """Return runs of some rows as columns, without the cells that are left out, unless all of a run are."""
    given = {name: [rows[0][1][name] for rows in runs] for name in runs[0][0][1]}
    if drop:
        given["drop"] = [drop._replace(uncertainty=Fraction(0))] * len(runs)  # it counts for all together
    measured = [{cell: one for *_, cells in rows for cell, one in cells.items()} for rows in runs]
    kept = [{cell: one for cell, one in cells.items() if cell not in left_out} for cells in measured]
    used = [some or cells for some, cells in zip(kept, measured, strict=True)]
    inputs, cells = [one for some in used for one in some.values()], [cell for some in used for cell in some]
    values, u_values = _column(one.value for one in inputs), _column(one.uncertainty for one in inputs)
    if u_values.any() and not u_values.all():
        lacking = in_words(cells[int(np.argmin(u_values))])
        raise Unreadable(f"{lacking} has no uncertainty, as others have; give all")
    columns = {name: _column(one.value for one in some) for name, some in given.items()}
    if max(columns["m1"].max(), columns["m2"].max()) > HEAVY:
        remarks = [*remarks, f"some masses are above {HEAVY} kg; if they are in g, write m1 (g)."]
    sign, run = np.ones(len(runs)), np.repeat(np.arange(len(used)), [*map(len, used)])
    if (values < 0).any():
        sign = np.where(columns["m2"] < columns["m1"], -1.0, 1.0)
    means = (sum(Fraction(one.value) for one in some.values()) / len(some) for some in used)
    decimals = [exact_decimal(Fraction(one.value)) for one in inputs]
    step = 0.0 if None in decimals else 10.0 ** min(int(one.as_tuple().exponent) for one in decimals if one)
    return Runs(
        kind,
        columns,
        {name: _column(one.uncertainty for one in some) for name, some in given.items()},
        [[number for number, *_ in rows] for rows in runs],
        np.array([not some for some in kept]),
        sign,
        sign * _column(means),
        sign[run] * values,
        u_values,
        run,
        cells,
        step,
        remarks,
    )


def _column(numbers: Iterable[Any]) -> Column:
    return np.array([float(number) for number in numbers])


def behind_an_error(remarks: Sequence[str]) -> str:
    """Return how the table was read, and which rows are not used, to stand behind an error."""
    return "".join(f"; {one.rstrip('.')}" for one in remarks)


# Headings


def _check(sheet: Sheet, headings: Sequence[Heading], drop: Input | None, named: Mapping[str, str]) -> None:
    """Check that runs have all columns, and times or accelerations. Raises Unreadable, SceneError."""
    names = {heading.name for heading in headings}
    measured = [heading for heading in headings if heading.name in MEASURED and heading.column not in named]
    alone = [heading.column for heading in measured if not heading.number]
    if alone and len(measured) > len(alone):
        raise refused(alone[0], "stands beside repeats and may be their mean; number it if it is a repeat")
    if names >= MEASURED.keys():
        raise Unreadable("there are columns a and time; keep one, or let one pass by --label")
    missing = [name for name in ("m1", "m2") if name not in names]
    if not names & MEASURED.keys():
        missing.append("time")
    if missing:
        raise Unreadable(_missing(sheet, missing))
    if drop is None and not names & {"a", "drop"}:
        raise Unreadable("the height of fall is missing: give drop, or a column of that name")
    if drop is not None and (has := next((name for name in ("a", "drop") if name in names), "")):
        raise SceneError("drop", drop.given, f"is not needed, as the table has {has}; leave it out")


def _missing(sheet: Sheet, missing: Sequence[str]) -> str:
    """Return which columns are missing, the table's own headings, and options that name some of them."""
    shown = {"m1": "m1", "m2": "m2", "time": "t (or a)"}
    said = f"no column{'s' if missing[1:] else ''} {', '.join(shown[name] for name in missing)}"
    if all(map(LIKE_NUMBER.match, filter(str.strip, sheet.columns))):
        return f"{said}: give the columns headings, as m1 (g),m2 (g),t (s)"
    if len(recognised([row[0] for row in sheet.rows], VOCABULARY)) > 1:
        return f"{said}: quantities stand in the first column; make each run a row, with headings above"
    known, options = recognised(sheet.columns, VOCABULARY), dict[str, str]()
    for place, column in enumerate(sheet.columns):
        if column.strip() and column not in known and _has_numbers(sheet, place):
            *_, (_, unit) = divisions(column)
            for name in [name for name in missing if name not in options][:1]:
                with suppress(Unreadable):  # it has the unit of something else
                    unit_factor(name, unit, column)
                    options[name] = f"--column {'t' if name == 'time' else name}={quote(column)}"
    said += f"; there {'are' if sheet.columns[1:] else 'is'} {listed(sheet.columns)}"
    if not options:
        return said
    named = f"{said}; name {'them' if missing[1:] else 'it'}, as {' '.join(options.values())}"
    return f"{named}, and --column t= for each repeat" if "time" in options else named


def _has_numbers(sheet: Sheet, place: int) -> bool:
    return any(LIKE_NUMBER.match(row[place]) for row in sheet.rows)


def _labels(sheet: Sheet, headings: Sequence[Heading], labels: Collection[str]) -> list[str]:
    """Return in words the columns of numbers that hold no quantity.

    Raises Unreadable for one that could hold a quantity, unless it is one of the ``labels``.
    """
    taken = {column.place for heading in headings for column in (heading, heading.u) if column}
    others: list[str] = []
    for place, column in enumerate(sheet.columns):
        if place in taken or column in labels:
            continue
        if column in INPUTS:
            option = column.replace("_", "-")
            raise refused(column, f"holds for all runs, so it is an option: give --{option}")
        if _has_numbers(sheet, place):
            if not column.strip():
                raise Unreadable(f"column {place + 1} has numbers and no heading; give it one")
            if LIKE_UNCERTAINTY.search(column):
                raise refused(column, "could be an uncertainty; name what of, as in 'u(t)'")
            others.append(f"{in_quotes(column)} as a label")
    return others


# Rows


def _read_without(words: Collection[int | str], rows: int, headings: Sequence[Heading]) -> set[str]:
    """Return the cells to leave out, all that are measured for a whole row.

    Raises SceneError for a row or a column that is not there.
    """
    measured = [heading for heading in headings if heading.name in MEASURED]
    found: set[str] = set()
    for word in map(str, words):
        number, colon, column = word.partition(":")
        if not (number.isascii() and number.isdigit() and 1 <= int(number[:9]) <= rows):
            raise SceneError("without", word, f"is not a row; there are 1 to {rows}, and a cell is 1:t2")
        cells = [one for one in measured if not colon or column.strip() in (one.column, _short_name(one))]
        if not cells:
            there = ", ".join(map(_short_name, measured))
            raise SceneError("without", word, f"names no column that is measured; there are {there}")
        found |= {_cell(int(number), one) for one in cells}
    return found


def _cell(row: int, heading: Heading) -> str:
    """Return where a measurement stands, as --without takes it: 8:t2."""
    return f"{row}:{quote(_short_name(heading))}"


def _short_name(heading: Heading) -> str:
    """Return the name of a measured column in --without: t2, or its heading if the user has named it."""
    letter = "t" if heading.name == "time" else heading.name
    return f"{letter}{heading.number}" if re.fullmatch(r"\d*", heading.number) else heading.column


def in_words(cell: str) -> str:
    """Return where a measurement stands, for a sentence: row 8: t2."""
    return f"row {cell.replace(':', ': ', 1)}"


def in_range(one: Input) -> bool:
    """Decide if a number, and its uncertainty, are 0 or of a size whose squares are doubles."""
    low, high = MEASURABLE
    sizes = (getattr(one.value, "number", one.value), one.uncertainty)
    return all(low <= abs(size) <= high for size in sizes if size)


def _read_row(number: int, row: Sequence[str], headings: Sequence[Heading], comma: bool) -> Row:
    """Return what a row gives and measures. Raises Unreadable."""
    given, measured = dict[str, Input](), dict[str, Input]()
    try:
        for heading in headings:
            one = _read_cell(heading, row, comma)
            if heading.name not in MEASURED:
                if not one:
                    raise Unreadable(f"row {number} has no {heading.name}; write it in each row")
                given[heading.name] = one
            elif one:
                measured[_cell(number, heading)] = one
    except SceneError as error:
        why = f"; {NO_RUN}" if not LIKE_NUMBER.match(f"{error.value}") else ""
        raise Unreadable(f"row {number}: {error}{why}") from None
    return number, given, measured


def _read_cell(heading: Heading, row: Sequence[str], comma: bool) -> Input | None:
    """Return a quantity of a row in SI units; None if its cell is empty. Raises SceneError."""
    cell = row[heading.place]
    given = read_cell(heading, cell, comma)
    if given and heading.u and (u := row[heading.u.place].strip()) not in EMPTY:
        if given.uncertainty:
            raise SceneError(heading.u.column, u, f"is a second uncertainty, beside {in_quotes(cell)}")
        given = given._replace(uncertainty=read_uncertainty(heading.u, u, given.value, comma))
    if given and not in_range(given):
        raise SceneError(heading.name, cell, OUT_OF_RANGE)
    return given
