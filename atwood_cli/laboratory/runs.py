"""A table of runs, from a file or from columns in Python, and the runs that its rows make."""

import re
from collections import defaultdict
from collections.abc import Collection, Mapping, Sequence
from decimal import Decimal
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..numbers.digits import ALL_DIGITS
from ..numbers.text import in_quotes, shortened
from ..reading.names import divided
from ..solver.scene import MASSES, Input, InTerms, SceneError
from ..tables.cells import EMPTY, OWN_UNIT, decimal_commas_in, read_cell
from ..tables.headings import Heading, read_as, refused
from ..tables.sheets import sheet_of, units_in_cells
from ..tables.sources import Unreadable
from .columns import (
    CONDITIONS,
    LIKE_NUMBER,
    MEAN,
    MEASURED,
    VOCABULARY,
    Kind,
    check_labels,
    headings_of,
    kind_of_runs,
    numbers_of_rows,
)

Column = NDArray[np.float64]
Places = NDArray[np.intp]
Selection = NDArray[np.bool_]
STATISTIC = re.compile(rf"\s*(?:{MEAN}|s\.?d\.?|st(?:d|andard)?\.? ?dev\w*)\W*", re.IGNORECASE)
"""The cells by which a row is known to be computed from others."""
NO_RUN = "if the row is no run, begin it with # (units stand in headings, as m1 (g))"
LARGE_MASSES = 0.5, "some masses are 0.5 kg or more", "g"
LARGE = {
    "m1": LARGE_MASSES,
    "m2": LARGE_MASSES,
    "drop": (10, "some heights of fall are 10 m or more", "cm"),
    "time": (1000, "some times are 1000 s or more", "ms"),
    "R": (1, "the radius is 1 m or more", "cm"),
}
"""The numbers, in SI units, from which a laboratory may have left out a smaller unit, and what to say."""
CART = 5
"""The ratio of m1 to each m2 above which m1 may be a cart, or a cylinder that is turned."""
ZERO = re.compile(r"[+-]?0+([.,]0*)?( ?[^\W\d_]+)?|")
MEASURABLE = 1e-30, 1e30
REACHES_0 = "has an uncertainty that reaches 0"
OUT_OF_RANGE = f"is beyond what a fit computes with, {MEASURABLE[0]} to {MEASURABLE[1]:.0e}"


class Runs(NamedTuple):
    """The n runs of a table, and all their measurements, run by run.

    Columns of runs (n): ``given`` has m1 and m2 (kg), and drop (m) if times were measured, ``u`` their
    uncertainties; ``rows`` are the numbers of their rows, ``mean`` is that of the values. Columns of
    measurements: ``values`` as typed (m/s² or s), ``u_values`` (0 if no uncertainty is stated), the ``run``
    of each, and ``cells``, where they stand: 8:t2. ``step`` is that of the last digit of any value.
    ``remarks`` say how the table was read, and ``doubts`` what may be wrong with its numbers. ``common`` has
    the uncertainties of a mass, or a hanger, that is one in all runs. ``same`` are conditions that the table
    has, the same in all rows.
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
    doubts: Sequence[str] = ()
    common: Mapping[str, float] = {}
    same: Mapping[str, Input] = {}

    @property
    def sign(self) -> Column:
        """Return 1 for each run, but -1 if m1 is the heavier mass and some acceleration is negative."""
        has_signs = (self.values[~self.left_out[self.run]] < 0).any()
        return np.where(has_signs & (self.given["m2"] < self.given["m1"]), -1.0, 1.0)

    def rows_in_words(self, *runs: int) -> str:
        """Return the rows of these runs for a sentence: row 1, or rows 1, 2."""
        return in_words(*sorted(row for i in runs for row in self.rows[i]))


Number = tuple[Fraction, Fraction]
"""An exact value in SI units, and its standard uncertainty."""
RowsOfRuns = dict[tuple[tuple[str, Number], ...], tuple[list[int], dict[str, Number]]]
"""The rows of a run and its measurements by their cells; the key is what the run gives, by name."""


def read_runs(
    source: Any,
    labels: Collection[str] = (),
    given: Mapping[str, Input] = {},
    without: Collection[int | str] = (),
    named: Mapping[str, str] = {},
    sheet_name: str | None = None,
) -> Runs:
    """Return the runs of a table; rows that differ only in what was measured are one run.

    ``source`` is the path of a file, with the name of its sheet, "-" for stdin, or columns by their headings.
    ``labels`` are headings that belong to no run, and ``named`` maps headings to what they mean. ``given``
    has what all runs share, such as m1 or drop, and perhaps a hanger, which is added to m1 and m2.
    Rows ``without``, by their numbers, and their cells, as 8:t2, are left out. Raises Unreadable if it is no
    table of runs, SceneError for what does not fit the table.
    """
    sheet = units_in_cells(sheet_of(source, VOCABULARY, named, sheet_name))
    labels = divided(labels, sheet.columns)
    headings = headings_of(sheet, labels, named)
    numbers = numbers_of_rows(sheet, headings)
    places = [column.place for heading in headings for column in (heading, heading.u) if column]
    known = {*places, 0} if numbers else {*places}
    unread = {  # columns of numbers, by their places: the heading, and the first number
        place: (column, cell)
        for place, (column, *cells) in enumerate(zip(sheet.columns, *sheet.rows, strict=True))
        if not (place in known or column in labels) and (cell := next(filter(LIKE_NUMBER.match, cells), ""))
    }
    kind = kind_of_runs(sheet, headings, unread, given, named)
    if kind == "a":  # a height has no effect
        headings = [heading for heading in headings if heading.name != "drop"]
    check_labels(headings, unread)
    comma = decimal_commas_in(sheet.rows, places, sheet.separator)
    words = [f"{in_quotes(sheet.columns[0])} as the numbers of rows"] if numbers else []
    words += [f"{in_quotes(column)} as a label" for column, _ in unread.values()]
    by = {x: given[x].value for x in ("R", "g") if x in given and not given[x].uncertainty}
    shared = {x: _in_own_terms(x, given[x], by) for x in (*MASSES, "hanger", "drop") if x in given}
    common = {x: float(u) for x, (_, u, _) in shared.items() if u and x != "drop"}
    if wide := [x for x in common if shared[x].uncertainty >= shared[x].value]:
        raise SceneError(wide[0], given[wide[0]].given, REACHES_0)
    hanger = shared.pop("hanger", Input(Fraction(0), Fraction(0), None))
    if hanger.given is not None:
        words.append(f"{shortened(str(hanger.given))} of hanger added to m1 and m2")
    added = {**dict.fromkeys(MASSES, hanger.value), "drop": Fraction(0)}
    for_all = {x: (read.value + added[x], Fraction(0)) for x, read in shared.items()}
    with_units = [x for x in places if all(row[x] in EMPTY or OWN_UNIT.search(row[x]) for row in sheet.rows)]
    remarks = read_as(headings, sheet.separator, comma, [*words, *sheet.remarks], with_units)
    left_out = [*map(str, without)]
    same, runs, unused = dict[str, Input](), RowsOfRuns(), defaultdict[str, list[int]](list)
    u_of = defaultdict[str, dict[str, Fraction]](dict)  # by names and places
    numbers = numbers or list(range(1, len(sheet.rows) + 1))
    for number, row in zip(numbers, sheet.rows, strict=True):
        if why := _no_run(row, headings):
            unused[why].append(number)
            continue
        inputs, measured = dict[str, Number](), dict[str, Number]()
        try:
            cells = _read_row(number, row, headings, comma, by)
        except Unreadable:
            if str(number) not in left_out:
                raise
            continue
        for heading, cell in cells:
            is_measured = heading.name in MEASURED
            place = f"{number}:{f'{kind[0]}{heading.number}' if is_measured else heading.name}"
            if (is_measured or cell.value) and {str(number), place}.isdisjoint(left_out):  # no mass is exact
                u_of[heading.name][place] = cell.uncertainty
            if is_measured:
                measured[place] = cell[:2]
            elif heading.name not in CONDITIONS:
                inputs[heading.name] = cell.value + added[heading.name], cell.uncertainty
            elif same.setdefault(heading.name, cell)[:2] != cell[:2]:
                why = f"differs between rows; a fit takes one {heading.name}, so fit the rows of each apart"
                raise refused(heading.column, why)
        if measured:
            rows, measurements = runs.setdefault(tuple({**inputs, **for_all}.items()), ([], {}))
            rows.append(number)
            measurements.update(measured)
        else:
            unused[f"no {MEASURED[kind]} was measured"].append(number)
    remarks += [f"{in_words(*rows)}: not used, as {reason}." for reason, rows in unused.items()]
    if not runs:
        raise Unreadable(f"it has no runs{behind_an_error(remarks)}")
    for of_places in u_of.values():
        lacking = [place for place, u in of_places.items() if not u]
        if 0 < len(lacking) < len(of_places):
            none = f"{in_words(lacking[0])} has no uncertainty, or one of 0"
            raise Unreadable(f"{none}; give one above 0, as others have")
    if left_out:
        remarks.append(f"left out, as asked: {', '.join(map(in_words, left_out))}.")
    result = _as_columns(kind, runs, numbers, left_out)
    heights = {dict(run).get("drop") for run in runs}
    if "drop" not in given and len(heights) == 1 and (height := heights.pop()):
        same["drop"] = Input(*height, None)  # if it is wrong, it is so in all runs alike
        result.u["drop"][:] = 0
    has_unit = {own.name for own in headings if own.unit or own.place in with_units}
    doubts = _doubts(result, {**given, **same}, has_unit)
    return result._replace(remarks=remarks, doubts=doubts, common=common, same=same)


def _doubts(runs: Runs, given: Mapping[str, Input], has_unit: Collection[str]) -> list[str]:
    """Say which large numbers without a unit may be in a smaller one, and that m1 may be a cart."""
    sizes: dict[str, Any] = {x: read.value for x, read in given.items()}
    sizes |= {x: max(column) for x, column in {**runs.given, runs.kind: runs.values}.items()}
    doubts = dict[str, str]()
    for x, (least, what, unit) in LARGE.items():
        typed = str(given[x].given or "") if x in given else ""
        if not (x in has_unit or OWN_UNIT.search(typed)) and sizes.get(x, 0) >= least:
            example = f"{typed}{unit}" if typed else f"{x} ({unit})"
            doubts.setdefault(what, f"{what}; if {unit} are meant, say so, as in {example}.")
    m1, m2 = (runs.given[mass] for mass in MASSES)
    if min(m1) == max(m1) > CART * max(m2):
        doubts[""] = f"m1 is {m1[0]:.6g} kg in all rows, far above m2; if it does not hang, give 0 for m1."
    return [*doubts.values()]


def _in_own_terms(name: str, read: Input, by: Mapping[str, Any]) -> Input:
    """Return an input, converted ``by`` R or g if it is in other terms. Raises SceneError."""
    if not isinstance(read.value, InTerms):
        return read
    number, terms = read.value
    if terms.by not in by:
        rule = f"is {terms.words}, which needs {terms.by} without an uncertainty"
        raise SceneError(name, read.given, rule)
    value, uncertainty = (terms.own(x, by[terms.by]) for x in (number, read.uncertainty))
    return Input(value, uncertainty, read.given)


def _as_columns(kind: Kind, runs: RowsOfRuns, numbers: Sequence[int], words: Sequence[str]) -> Runs:
    """Return runs without the rows and cells of these words, unless all of a run are left out."""
    measured = [cells for _, cells in runs.values()]
    known = {*map(str, numbers), *(cell for cells in measured for cell in cells)}
    if absent := [word for word in words if word not in known]:
        ends = f"{numbers[0]} to {numbers[-1]}"
        rule = f"is neither a row, {ends}, nor a measurement, as {next(iter(measured[0]))}"
        raise SceneError("without", absent[0], rule)
    kept = [{x: cells[x] for x in cells if {x, x.split(":")[0]}.isdisjoint(words)} for cells in measured]
    used = [some or cells for some, cells in zip(kept, measured, strict=True)]
    cells = [cell for some in used for cell in some]
    values, u_values = np.array([number for some in used for number in some.values()], float).T
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
    return "".join(f"; {remark.rstrip('.')}" for remark in remarks)


# Rows


def in_words(*places: int | str) -> str:
    """Return rows, or where a measurement stands, for a sentence: row 1, rows 1, 2, or row 8: t2."""
    return f"row{'s' if places[1:] else ''} {', '.join(map(str, places)).replace(':', ': ', 1)}"


def in_range(read: Input) -> bool:
    """Decide if a number, and its uncertainty, are 0 or of a size whose squares are doubles."""
    low, high = MEASURABLE
    sizes = (getattr(read.value, "number", read.value), read.uncertainty)
    return all(low <= abs(size) <= high for size in sizes if size)


def _no_run(row: Sequence[str], headings: Sequence[Heading]) -> str:
    """Return why a row is no run, as where a trace of positions begins, or "" """
    if any(map(STATISTIC.fullmatch, row)):
        return "a mean or a standard deviation is no run"
    cells = [(own.name, row[own.place].strip()) for own in headings if own.name in ("drop", "time")]
    begins = len({name for name, _ in cells}) == 2 and all(ZERO.fullmatch(cell) for _, cell in cells)
    return "the height and the time are 0" if begins else ""


def _read_row(
    number: int, row: Sequence[str], headings: Sequence[Heading], comma: bool, by: Mapping[str, Any]
) -> list[tuple[Heading, Input]]:
    """Return the cells of a row that are not empty, as measurements may be. Raises Unreadable.

    Numbers in other terms are converted ``by`` R or g, or by that of the row.
    """
    cells: list[tuple[Heading, Input]] = []
    for heading in sorted(headings, key=lambda heading: heading.name not in CONDITIONS):
        name = heading.name
        try:
            if not (cell := read_cell(heading, row, comma)):
                if name in MEASURED:
                    continue
                raise SceneError(name, None, "is missing; write it in each row")
            if name in CONDITIONS:
                by = {**by, name: cell.value}
            else:
                cell = _in_own_terms(name, cell, by)
            if not in_range(cell):
                raise SceneError(name, cell.given, OUT_OF_RANGE)
        except SceneError as error:
            raise Unreadable(f"row {number}: {error}; {NO_RUN}") from None
        cells.append((heading, cell))
    return cells
