"""A table of runs, from a file or from columns in Python, and the runs that its rows make."""

import re
from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from decimal import Decimal
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..numbers.digits import ALL_DIGITS
from ..numbers.text import shortened
from ..solver.scene import MASSES, Input, SceneError, parameter_of
from ..tables.cells import BARE, EMPTY, OWN_UNIT, has_unit, read_cell
from ..tables.headings import NOTHING_SAID, Heading, Naming, named, read_as, refused
from ..tables.records import LIKE_NUMBER
from ..tables.sheets import Sheet, filled_down, sheet_of
from ..tables.sources import Unreadable
from .columns import CONDITIONS, MEASURED, VOCABULARY, Columns, Kind, columns_of

Column = NDArray[np.float64]
Places = NDArray[np.intp]
Selection = NDArray[np.bool_]
STATISTIC = re.compile(
    r"(?i)\s*(?:(?:avg|average|mean|mittel(?:wert)?|moyenne|promedio|m[eé]dia)\b|s\.?d\.?"
    r"|st(?:d|andard)?\.? ?dev\w*)\W*"
)
"""The cells by which a row is known to be computed from others, also where no row has a number there."""
LIKE_WORD = re.compile(r"\D*(?:[^\W\d_]\W*[^\W\d_]|[^\W\d_a-zA-Z])\D*")
"""A cell with a word; one letter may be a mark."""
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
MEASURABLE = Fraction("1e-30"), Fraction("1e30")
BY_CHANCE = 1e-3
"""The probability below which numbers that are the means of others are taken to be computed."""
OF_RUNS = (*MASSES, "drop")
"""What a run gives; rows with the same numbers are one run."""
OUT_OF_RANGE = "is beyond what a fit computes with, 1e-30 to 1e+30"


class Runs(NamedTuple):
    """The n runs of a table, and all their measurements, run by run.

    Columns of runs (n): ``given`` has m1 and m2 (kg), and drop (m) if times were measured, ``u`` their
    uncertainties; ``rows`` are the numbers of their rows, ``mean`` is that of the values. Columns of
    measurements: ``values`` as typed (m/s² or s), ``u_values`` (0 if no uncertainty is stated), the ``run``
    of each, and ``cells``, where they stand: 8:t2. ``step`` is that of the last digit of any value.
    ``remarks`` say how the table was read, ``unused`` what was not, and ``doubts`` what may be wrong with its
    numbers. ``common`` has the uncertainties of a mass, or a hanger, that is one in all runs. ``same`` are
    conditions that the table has, the same in all rows.
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
    unused: Sequence[str] = ()
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


class Row(NamedTuple):
    """A row by its number: its cells by where they stand, as 8:t2 or 8:m1, and why it is no run, or ""."""

    number: int
    cells: Mapping[str, tuple[Heading, Input]]
    unused: str = ""


Number = tuple[Fraction, Fraction]
"""An exact value in SI units, and its standard uncertainty."""
RowsOfRuns = Mapping[tuple[tuple[str, Number], ...], Sequence[Row]]
"""The rows of each run, by what it gives: the masses, and the height of a fall."""


def read_runs(
    source: Any,
    naming: Naming = NOTHING_SAID,
    given: Mapping[str, Input] = {},
    without: Collection[int | str] = (),
    sheet_name: str | None = None,
) -> Runs:
    """Return the runs of a table; rows that differ only in what was measured are one run.

    ``source`` is the path of a file, with the name of its sheet, "-" for stdin, or columns by their headings.
    ``naming`` has what the user says of columns, and ``given`` what all runs share, such as m1 or drop, and
    perhaps a hanger, which is added to m1 and m2.
    Rows ``without``, by their numbers, and their cells, as 8:t2, are left out. Raises Unreadable if it is no
    table of runs, SceneError for what does not fit the table.
    """
    sheet = sheet_of(source, VOCABULARY, naming, sheet_name)
    columns = columns_of(sheet, naming, given)
    _check_titles(sheet, columns)
    sheet = filled_down(sheet, naming.filled)
    by = {x: given[x].number for x in ("R", "g") if x in given and not given[x].uncertainty}
    shared = {x: _in_own_terms(x, given[x], by) for x in (*MASSES, "hanger", "drop") if x in given}
    common = {x: float(read.uncertainty) for x, read in shared.items() if read.uncertainty and x != "drop"}
    hanger = shared.pop("hanger", Input(Fraction(0)))
    others = [f"{named(sheet.columns[0], 0)} as the numbers of rows"] if columns.has_numbers else []
    if hanger.given is not None:
        others.append(f"{shortened(str(hanger.given))} of hanger added to m1 and m2")
    others += sheet.remarks
    remarks = read_as(columns.headings, sheet.separator, columns.comma, others, columns.with_units)
    unread = ", ".join(named(sheet.columns[i], i) for i in columns.unread)
    unused = [f"not read: {unread}."] if unread else []
    if columns.kind == "a" and "drop" in shared:
        del shared["drop"]
        unused.append("the height of fall: not used, as accelerations were measured.")
    left_out = [*map(str, without)]
    rows = [*_rows_of(sheet, columns, by, left_out)]
    same = _same_in_all(rows)
    for reason in dict.fromkeys(row.unused for row in rows if row.unused):
        numbers = (row.number for row in rows if row.unused == reason)
        unused.append(f"{in_words(*numbers)}: not used, as {reason}.")
    used = [row for row in rows if not row.unused]
    heights = {read[:2] for row in used for own, read in row.cells.values() if own.name == "drop"}
    if len(heights) == 1:  # if it is wrong, it is so in all runs alike
        same["drop"] = shared["drop"] = Input(*heights.pop())
    if not (runs := _runs_of(used, shared, hanger)):
        raise Unreadable(f"it has no runs{behind_an_error([*remarks, *unused])}")
    _check_uncertainties(rows, left_out)
    remarks += [f"left out, as asked: {', '.join(map(in_words, left_out))}."] if left_out else []
    result = _as_columns(columns, runs, left_out)
    in_units = {own.name for own in columns.headings if own.unit or own.place in columns.with_units}
    doubts = [*_doubts(result, {**given, **same}, in_units), *_words_apart(sheet, columns, runs)]
    doubts += _bare_beside_units(used)
    return result._replace(remarks=remarks, unused=unused, doubts=doubts, common=common, same=same)


def _same_in_all(rows: Sequence[Row]) -> dict[str, Input]:
    """Return the conditions that the table has. Raises Unreadable if one differs between rows."""
    same = dict[str, Input]()
    for own, read in (cell for row in rows for cell in row.cells.values()):
        if own.name in CONDITIONS and same.setdefault(own.name, read)[:2] != read[:2]:
            why = f"differs between rows; a fit takes one {own.name}, so fit the rows of each apart"
            raise refused(own.column, why)
    return same


def _check_uncertainties(rows: Sequence[Row], left_out: Collection[str]) -> None:
    """Raise Unreadable if a quantity has an uncertainty in some cells alone; a mass of 0 needs none."""
    used = [row for row in rows if str(row.number) not in left_out]
    cells = [(own.name, place, read) for row in used for place, (own, read) in row.cells.items()]
    cells = [cell for cell in cells if cell[1] not in left_out and (cell[0] in MEASURED or cell[2].number)]
    stated = {name for name, _, read in cells if read.uncertainty}
    if lacking := [place for name, place, read in cells if name in stated and not read.uncertainty]:
        none = f"{in_words(lacking[0])} has no uncertainty, or one of 0"
        raise Unreadable(f"{none}; give one above 0, as others have")


def _doubts(runs: Runs, given: Mapping[str, Input], has_unit: Collection[str]) -> list[str]:
    """Say which large numbers without a unit may be in a smaller one, and that m1 may be a cart."""
    sizes: dict[str, Any] = {x: read.number for x, read in given.items()}
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
    return [*doubts.values(), *_means_among_repeats(runs)]


def _words_apart(sheet: Sheet, columns: Columns, runs: RowsOfRuns) -> list[str]:
    """Say which column has other words in rows of one run, unless each row of the table has its own."""
    filled = dict(zip(columns.numbers, filled_down(sheet, columns.unread).rows, strict=True))
    apart = list[str]()
    for i in columns.unread:
        of_runs = ({filled[row.number][i].strip() for row in rows} - {""} for rows in runs.values())
        is_name = sheet.has_numbers(i) or len({row[i] for row in sheet.rows}) == len(sheet.rows)
        if not is_name and any(len(words) > 1 for words in of_runs):
            what = f"{named(sheet.columns[i], i)} differs between rows that are taken as repeats"
            apart.append(f"{what}: is it another pulley or another load?")
    return apart


def _runs_of(rows: Iterable[Row], shared: Mapping[str, Input], hanger: Input) -> RowsOfRuns:
    """Return runs: rows that differ only in what was measured."""
    runs = defaultdict[tuple[tuple[str, Number], ...], list[Row]](list)
    for row in rows:
        given_by = {own.name: read[:2] for own, read in row.cells.values() if own.name in OF_RUNS}
        given_by |= {x: (read.number, Fraction(0)) for x, read in shared.items()}
        given_by |= {x: (given_by[x][0] + hanger.number, given_by[x][1]) for x in MASSES}
        runs[tuple(given_by.items())].append(row)
    return runs


def _bare_beside_units(rows: Sequence[Row]) -> list[str]:
    """Say which quantities have cells without a unit beside some with one, under a heading without one."""
    cells = [cell for row in rows for cell in row.cells.values() if cell[1].number and not cell[0].unit]
    in_units, bare = ({own.name for own, x in cells if has_unit(x.given) is which} for which in (True, False))
    return [BARE.format(x, parameter_of(x).unit) for x in sorted(in_units & bare)]


def _means_among_repeats(runs: Runs) -> list[str]:
    """Say which column, last row of each run, or last row of all is the mean of the others."""
    rows = defaultdict[int, dict[str, float]](dict)
    for cell, value in zip(runs.cells, runs.values.tolist(), strict=True):
        row, _, word = cell.partition(":")
        rows[int(row)][word] = value
    words = sorted({word for cells in rows.values() for word in cells})
    whole = [cells for cells in rows.values() if len(cells) == len(words)]
    for word in words:
        if _end_in_means([[*(cells[x] for x in words if x != word), cells[word]] for cells in whole]):
            what = f"in each row {word} is the mean of the other repeats"
            return [f"{what}; if it was computed, it is no repeat: leave it unread."]
    of_runs = [used for run in runs.rows if len(used := [row for row in run if row in rows]) > 2]
    for what, blocks in (("in each run the last row", of_runs), ("the last row", [sorted(rows)])):
        ends = [(word, block) for block in blocks for word in rows[block[-1]]]
        if _end_in_means([[rows[x][word] for x in block if word in rows[x]] for word, block in ends]):
            left_out = in_words(*(block[-1] for block in blocks))
            return [f"{what} is the mean of the others; if it was computed, leave out {left_out}."]
    return []


def _end_in_means(blocks: Sequence[Sequence[float]]) -> bool:
    """Decide whether the last number of each block is the mean of the others, more often than by chance."""
    step, chance = _step(block[-1] for block in blocks), 1.0
    for *others, value in blocks:
        if len(others) < 2 or abs(value - sum(others) / len(others)) > 0.51 * step:
            return False
        chance *= min(1.0, step / (2.5 * float(np.std(others)) or step))  # at the peak of a normal density
    return chance < BY_CHANCE


def _step(values: Iterable[float]) -> float:
    """Return the step of the last digit of any of these values."""
    exponents = (ALL_DIGITS.normalize(Decimal(str(x))).as_tuple().exponent for x in values)
    return 10.0 ** min([0, *map(int, exponents)])


def _in_own_terms(name: str, read: Input, by: Mapping[str, Any]) -> Input:
    """Return an input, converted ``by`` R or g if it is in other terms. Raises SceneError."""
    terms = read.unit.terms
    if not terms:
        return read
    if terms.by not in by:
        rule = f"is {terms.words}, which needs {terms.by} without an uncertainty"
        raise SceneError(name, read.given, rule)
    number, uncertainty = (terms.own(x, by[terms.by]) for x in (read.number, read.uncertainty))
    return Input(number, uncertainty, read.given)


def _as_columns(columns: Columns, runs: RowsOfRuns, left_out: Collection[str]) -> Runs:
    """Return runs without the rows and cells that are left out, unless all of a run are."""
    measured = [
        {place: read[:2] for row in rows for place, (own, read) in row.cells.items() if own.name in MEASURED}
        for rows in runs.values()
    ]
    known = {*map(str, columns.numbers), *(place for cells in measured for place in cells)}
    if absent := [word for word in left_out if word not in known]:
        ends = f"{columns.numbers[0]} to {columns.numbers[-1]}"
        rule = f"is neither a row, {ends}, nor a measurement, as {next(iter(measured[0]))}"
        raise SceneError("without", absent[0], rule)
    kept = [{x: cells[x] for x in cells if {x, x.split(":")[0]}.isdisjoint(left_out)} for cells in measured]
    used = [some or cells for some, cells in zip(kept, measured, strict=True)]
    values, u_values = np.array([number for some in used for number in some.values()], float).T
    given = {x: np.array([dict(run)[x] for run in runs], float).T for x, _ in next(iter(runs))}
    return Runs(
        columns.kind,
        {x: column for x, (column, _) in given.items()},
        {x: u for x, (_, u) in given.items()},
        [[row.number for row in rows] for rows in runs.values()],
        np.array([not some for some in kept]),
        np.array([sum(value for value, _ in some.values()) / len(some) for some in used], float),
        values,
        u_values,
        np.repeat(np.arange(len(used)), [*map(len, used)]),
        [place for some in used for place in some],
        _step(values),
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
    return all(low <= abs(size) <= high for size in (read.number, read.uncertainty) if size)


def _no_run(row: Sequence[str], headings: Sequence[Heading]) -> str:
    """Return why a row is no run, as where a trace of positions begins, or "" """
    if not any(row[own.place].strip() for own in headings):
        return "nothing that is read stands there"
    if any(map(STATISTIC.fullmatch, row)):
        return "a mean or a standard deviation is no run"
    cells = [(own.name, row[own.place].strip()) for own in headings if own.name in ("drop", "time")]
    begins = len({name for name, _ in cells}) == 2 and all(ZERO.fullmatch(cell) for _, cell in cells)
    what = "0" if any(cell for _, cell in cells) else "empty"
    return f"the height and the time are {what}" if begins else ""


def _rows_by_words(sheet: Sheet, places: Iterable[int]) -> dict[int, str]:
    """Return why rows with a word, as of a mean, where most have a number are no runs, by their places."""
    why = dict[int, str]()
    for place in places:
        cells = [row[place].strip() for row in sheet.rows]
        words = [i for i, cell in enumerate(cells) if cell not in EMPTY and LIKE_WORD.fullmatch(cell)]
        if sum(map(bool, map(LIKE_NUMBER.match, cells))) > len(words):
            what = f"{named(sheet.columns[place], place)} has a word there, and most rows a number"
            why |= dict.fromkeys(words, what)
    return why


def _check_titles(sheet: Sheet, columns: Columns) -> None:
    """Raise Unreadable if a row between runs has words and no measurement: what follows repeats no run."""
    by_words, used = _rows_by_words(sheet, columns.unread), list[int]()
    for i, row in enumerate(sheet.rows):
        numbers = [own.name in MEASURED for own in columns.headings if LIKE_NUMBER.match(row[own.place])]
        if any(numbers) or (numbers and i not in by_words):
            used.append(i)
    between = {*range(used[0], used[-1])} - {*used} if used else ()
    for i in sorted(between):
        if any(has_unit(cell) and cell.strip() not in EMPTY for cell in sheet.rows[i]):
            what = f"row {columns.numbers[i]} has words and no {MEASURED[columns.kind]}, as a title has"
            raise Unreadable(
                f"{what}; give the rows below a file of their own, or, if it is a note, begin it with #"
            )


def _rows_of(
    sheet: Sheet, columns: Columns, by: Mapping[str, Any], left_out: Collection[str]
) -> Iterator[Row]:
    """Yield the rows of a table, without those that cannot be read and are left out. Raises Unreadable."""
    by_words = _rows_by_words(sheet, columns.unread)
    for i, (number, row) in enumerate(zip(columns.numbers, sheet.rows, strict=True)):
        if why := by_words.get(i) or _no_run(row, columns.headings):
            yield Row(number, {}, why)
            continue
        try:
            read = _read_row(row, columns, by)
        except SceneError as error:
            if str(number) in left_out:
                continue
            raise Unreadable(f"row {number}: {error}; {NO_RUN}") from None
        words = [f"{x.name[0]}{x.number}" if x.name in MEASURED else x.name for x, _ in read]
        cells = {f"{number}:{word}": cell for word, cell in zip(words, read, strict=True)}
        is_measured = any(own.name in MEASURED for own, _ in read)
        yield Row(number, cells, "" if is_measured else f"no {MEASURED[columns.kind]} was measured")


def _read_row(row: Sequence[str], columns: Columns, by: Mapping[str, Any]) -> list[tuple[Heading, Input]]:
    """Return the cells of a row that are not empty, as measurements may be. Raises SceneError.

    Numbers in other terms are converted ``by`` R or g, or by that of the row.
    """
    cells: list[tuple[Heading, Input]] = []
    for heading in sorted(columns.headings, key=lambda heading: heading.name not in CONDITIONS):
        name = heading.name
        if not (cell := read_cell(heading, row, columns.comma)):
            if name in MEASURED:
                continue
            raise SceneError(name, None, f"is missing; write it in each row, or fill by {name}+ in columns")
        if name in CONDITIONS:
            by = {**by, name: cell.number}
        else:
            cell = _in_own_terms(name, cell, by)
        if not in_range(cell):
            raise SceneError(name, cell.given, OUT_OF_RANGE)
        cells.append((heading, cell))
    return cells
