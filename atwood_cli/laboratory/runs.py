"""A table of runs, from a file or from columns in Python, and the runs that its rows make."""

import re
from collections.abc import Collection, Mapping, Sequence
from decimal import Decimal
from fractions import Fraction
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..numbers.digits import ALL_DIGITS
from ..numbers.text import in_quotes
from ..solver.scene import INPUTS, Input, SceneError
from ..tables.headings import (
    Heading,
    Vocabulary,
    decimal_commas_in,
    listed,
    read_as,
    read_cell,
    read_headings,
    recognised,
    refused,
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
NO_RUN = "if the row is no run, begin it with # (units stand in headings, as m1 (g))"
HEAVY = 10
"""The mass (kg) above which a laboratory may have left out a unit."""
MEASURABLE = 1e-30, 1e30
OUT_OF_RANGE = f"is beyond what a fit computes with, {MEASURABLE[0]} to {MEASURABLE[1]:.0e}"


class Runs(NamedTuple):
    """The n runs of a table, and all their measurements, run by run.

    Columns of runs (n): ``given`` has m1 and m2 (kg), and drop (m) if times were measured, ``u`` their
    uncertainties; ``rows`` are the numbers of their rows, ``mean`` is that of the values. Columns of
    measurements: ``values`` as typed (m/s² or s), ``u_values`` (0 if no uncertainty is stated), the ``run``
    of each, and ``cells``, where they stand: 8:t2. ``step`` is that of the last digit of any value.
    """

    kind: Kind
    given: Mapping[str, Column]
    u: Mapping[str, Column]
    rows: Sequence[Sequence[int]]
    left_out: Selection
    mean: Column
    values: Column
    u_values: Column
    run: Places
    cells: Sequence[str]
    step: float
    remarks: Sequence[str] = ()

    @property
    def sign(self) -> Column:
        """Return 1 for each run, but -1 if m1 is the heavier mass and some acceleration is negative."""
        has_signs = (self.values[~self.left_out[self.run]] < 0).any()
        return np.where(has_signs & (self.given["m2"] < self.given["m1"]), -1.0, 1.0)

    def rows_in_words(self, *runs: int) -> str:
        """Return the rows of these runs for a sentence: row 1, or rows 1, 2."""
        rows = [str(row) for i in runs for row in self.rows[i]]
        return f"row{'s' if rows[1:] else ''} {', '.join(rows)}"


Number = tuple[Fraction, Fraction]
"""An exact value in SI units, and its standard uncertainty."""
Numbers = dict[str, Number]
RowsOfRuns = dict[tuple[tuple[str, Number], ...], tuple[list[int], Numbers]]
"""The rows of a run and its measurements by their cells; the key is what the run gives, by name."""


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
    kind: Kind = "a" if any(heading.name == "a" for heading in headings) else "time"
    if kind == "a":  # a height has no effect
        labels = [*labels, *(one.u.column for one in headings if one.name == "drop" and one.u)]
        headings = [one for one in headings if one.name != "drop"]
    places = [column.place for heading in headings for column in (heading, heading.u) if column]
    others = _others(sheet, places, labels)
    _check(sheet, headings, others, drop)
    comma = decimal_commas_in(sheet.rows, places, sheet.separator)
    labelled = [f"{in_quotes(column)} as a label" for column in others]
    remarks = read_as(headings, sheet.separator, comma, [*labelled, *sheet.remarks])
    shared = {"drop": (drop.value, Fraction(0))} if drop else {}  # its uncertainty counts for all together
    runs = RowsOfRuns()
    for number, row in enumerate(sheet.rows, 1):
        given, measured = _read_row(number, row, headings, comma)
        if measured:
            rows, cells = runs.setdefault(tuple({**given, **shared}.items()), ([], {}))
            rows.append(number)
            cells.update(measured)
        else:
            remarks.append(f"row {number} has no {kind}: it is not used.")
    if not runs:
        raise Unreadable(f"it has no runs{behind_an_error(remarks)}")
    words = [*map(str, without)]
    if words:
        remarks.append(f"left out, as asked: {', '.join(map(in_words, words))}.")
    found = _as_columns(kind, runs, len(sheet.rows), words)
    if max(found.given["m1"].max(), found.given["m2"].max()) > HEAVY:
        remarks.append(
            f"some masses are above {HEAVY} kg; if they are in g, add that to both headings, as in m1 (g)."
        )
    return found._replace(remarks=remarks)


def _as_columns(kind: Kind, runs: RowsOfRuns, count: int, words: Sequence[str]) -> Runs:
    """Return runs without the rows and cells of these words, unless all of a run are left out."""
    measured = [cells for _, cells in runs.values()]
    there = {*map(str, range(1, count + 1)), *(cell for cells in measured for cell in cells)}
    if absent := [word for word in words if word not in there]:
        rule = f"is neither a row, 1 to {count}, nor a measurement, as {next(iter(measured[0]))}"
        raise SceneError("without", absent[0], rule)
    kept = [{x: cells[x] for x in cells if {x, x.split(":")[0]}.isdisjoint(words)} for cells in measured]
    used = [some or cells for some, cells in zip(kept, measured, strict=True)]
    cells = [cell for some in used for cell in some]
    values, u_values = np.array([number for some in used for number in some.values()], float).T
    lacking = [cell for some in kept for cell, (_, u) in some.items() if not u]
    if 0 < len(lacking) < sum(map(len, kept)):
        none = f"{in_words(lacking[0])} has no uncertainty, or one of 0"
        raise Unreadable(f"{none}; give one above 0, as others have")
    given = {x: np.array([dict(run)[x] for run in runs], float).T for x, _ in next(iter(runs))}
    return Runs(
        kind,
        {x: column for x, (column, _) in given.items()},
        {x: u for x, (_, u) in given.items()},
        [rows for rows, _ in runs.values()],
        np.array([not some for some in kept]),
        np.array([sum(value for value, _ in some.values()) / len(some) for some in used], float),
        values,
        u_values,
        np.repeat(np.arange(len(used)), [*map(len, used)]),
        cells,
        10.0 ** min(0, *(int(ALL_DIGITS.normalize(Decimal(str(x))).as_tuple().exponent) for x in values)),
    )


def behind_an_error(remarks: Sequence[str]) -> str:
    """Return how the table was read, and which rows are not used, to stand behind an error."""
    return "".join(f"; {one.rstrip('.')}" for one in remarks)


# Headings


def _others(sheet: Sheet, places: Collection[int], labels: Collection[str]) -> list[str]:
    """Return the columns of numbers that hold no quantity, unless they are ``labels``.

    Raises Unreadable for one that could hold a quantity.
    """
    others: list[str] = []
    for place, (column, *cells) in enumerate(zip(sheet.columns, *sheet.rows, strict=True)):
        if place in places or column in labels or not any(map(LIKE_NUMBER.match, cells)):
            continue
        if column in INPUTS:
            option = column.replace("_", "-")
            raise refused(column, "holds for all runs, so it is an option", f": give --{option}")
        if not column.strip():
            raise refused(column, "has numbers and no heading; give it one")
        if LIKE_UNCERTAINTY.search(column):
            raise refused(column, "could be an uncertainty; name what of, as in 'u(t)'")
        others.append(column)
    return others


def _check(sheet: Sheet, headings: Sequence[Heading], others: Sequence[str], drop: Input | None) -> None:
    """Check that runs have all columns, and times or accelerations. Raises Unreadable, SceneError."""
    names = {heading.name for heading in headings}
    kinds = {(bool(one.number), one.name): one.column for one in headings if one.name in MEASURED}
    if len(kinds) > 1:
        column, beside, *_ = (kinds[kind] for kind in sorted(kinds))
        why = "may be computed, as a mean is; number repeats, as t1, t2"
        raise refused(column, f"stands beside {in_quotes(beside)} and {why}")
    missing = [name for name in ("m1", "m2") if name not in names]
    if not kinds:
        missing.append("t")
    if missing:
        raise Unreadable(*_missing(missing, sheet, others))
    if drop is None and not names & {"a", "drop"}:
        raise Unreadable("the height of fall is missing: give drop, or a column of that name")
    if drop is not None and (has := names & {"a", "drop"}):
        raise SceneError("drop", drop.given, f"is not needed, as the table has {min(has)}; leave it out")


def _missing(missing: Sequence[str], sheet: Sheet, others: Sequence[str]) -> tuple[str, str]:
    """Return which columns runs need, those of the table, and options that name what is missing."""
    said = f"runs need columns m1, m2, and t or a; there are {listed(sheet.columns)}"
    if all(map(LIKE_NUMBER.match, others)) or len(recognised([row[0] for row in sheet.rows], VOCABULARY)) > 1:
        return f"{said}; make each run a row, below headings, as m1 (g),m2 (g),t (s)", ""
    repeats = ", and likewise each repeat" if "t" in missing else ""
    return said, f"; name them, as {' '.join(f'--column {name}=HEADING' for name in missing)}{repeats}"


# Rows


def in_words(cell: str) -> str:
    """Return where a measurement stands, for a sentence: row 8: t2."""
    return f"row {cell.replace(':', ': ', 1)}"


def in_range(one: Input) -> bool:
    """Decide if a number, and its uncertainty, are 0 or of a size whose squares are doubles."""
    low, high = MEASURABLE
    sizes = (getattr(one.value, "number", one.value), one.uncertainty)
    return all(low <= abs(size) <= high for size in sizes if size)


def _read_row(
    number: int, row: Sequence[str], headings: Sequence[Heading], comma: bool
) -> tuple[Numbers, Numbers]:
    """Return what a row gives, by the quantity, and measures, by the cell. Raises Unreadable."""
    given, measured = Numbers(), Numbers()
    for heading in headings:
        try:
            one = read_cell(heading, row, comma)
            if not one and heading.name not in MEASURED:
                raise SceneError(heading.name, None, "is missing; write it in each row")
            if one and not in_range(one):
                raise SceneError(heading.name, one.given, OUT_OF_RANGE)
        except SceneError as error:
            raise Unreadable(f"row {number}: {error}; {NO_RUN}") from None
        if one and heading.name in MEASURED:
            measured[f"{number}:{heading.name[0]}{heading.number}"] = one[:2]
        elif one:
            given[heading.name] = one[:2]
    return given, measured
