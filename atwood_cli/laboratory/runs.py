"""A table of runs, from a file or from columns in Python, and the runs that its rows make."""

import re
from collections import defaultdict
from collections.abc import Collection, Mapping, Sequence
from decimal import Decimal
from fractions import Fraction
from shlex import quote
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..numbers.digits import ALL_DIGITS
from ..numbers.text import in_quotes, shortened
from ..reading.units import UNITS, symbol_of
from ..solver.scene import INPUTS, MASSES, Input, InTerms, SceneError
from ..tables.headings import (
    EMPTY,
    LONGEST_HEADING,
    MASS_NAMES,
    OF_COLUMN_BEFORE,
    OWN_UNIT,
    Heading,
    Vocabulary,
    decimal_commas_in,
    is_unit,
    listed,
    name_at_start,
    read_as,
    read_cell,
    read_headings,
    recognised,
    refused,
    unit_within,
)
from ..tables.sheets import Sheet, sheet_of, units_in_cells
from ..tables.sources import Unreadable

Column = NDArray[np.float64]
Places = NDArray[np.intp]
Selection = NDArray[np.bool_]
Kind = Literal["a", "time"]
MEASURED = {"a": "acceleration", "time": "time"}
"""The quantities that are measured, which may be repeated in further columns."""
WORDS = {"m1": "m1", "m2": "m2", "drop": "drop h height", "a": "a acceleration", "time": "t time"}
"""The quantities of a run, by the words of headings."""
CONDITIONS = {"M": "M", "g": "g", "inertia": "inertia", "I": "I", "R": "R radius", "axle": "axle"}
"""The quantities that are the same in all runs: options, or columns with one number in all rows."""
SPELLINGS = {word: name for name, words in {**WORDS, **CONDITIONS}.items() for word in words.split()}
SPELLINGS |= {word.capitalize(): name for word, name in SPELLINGS.items()}
VOCABULARY = Vocabulary(MASS_NAMES | SPELLINGS, repeated=MEASURED, uncertain=True)
LIKE_UNCERTAINTY = re.compile(
    r"±|\+/-|[Δδσ]|delta|sigma|\bu(?:[ _(]|$)|(?:\b|_)(?:err|unc|incert|fehler|s\.?d\b|d[tamh]\d?\b)"
    r"|(?:\b|_)(?:st(?:d|andard)\.?[ _-]?(?:dev|abw)|tolerance|unsicherheit)",
    re.IGNORECASE,
)
LIKE_SUM = re.compile(r"total|gesamt|\bsum|somme|diff|dif[ei]r|^\W*[Σ∑Δ]|\bm[\w ]*[-–−+] ?m", re.IGNORECASE)
"""The headings of sums and of differences."""
LIKE_THEORY = re.compile("theo|teór|calc|expect|predict", re.IGNORECASE)
MEAN = r"\b(?:avg|average|mean|mittel(?:wert)?|moyenne|promedio|m[eé]dia)\b"
LIKE_MEAN = re.compile(MEAN, re.IGNORECASE)
STATISTIC = re.compile(rf"\s*(?:{MEAN}|s\.?d\.?|st(?:d|andard)?\.? ?dev\w*)\W*", re.IGNORECASE)
"""The cells by which a row is known to be computed from others."""
LIKE_NUMBER = re.compile(r"\s*[-+±]?[.,]?\d")
NO_RUN = "if the row is no run, begin it with # (units stand in headings, as m1 (g))"
LIKE_MASS = re.compile(
    r"(?:\b|_)(?:m\d*|mass\w*|masas?|масс\w*|gewicht\w*|weights?|hangers?|(?:over|pay)?load|rider|beban|peso|poids"
    r"|\w*груз\w*)(?:\b|_)",
    re.IGNORECASE,
)
LARGE_MASSES = 0.5, "some masses are 0.5 kg or more", "g"
LARGE = {
    "m1": LARGE_MASSES,
    "m2": LARGE_MASSES,
    "drop": (10, "some heights of fall are 10 m or more", "cm"),
    "time": (1000, "some times are 1000 s or more", "ms"),
}
"""The numbers, in SI units, from which a laboratory may have left out a smaller unit, and what to say."""
CART = 5
"""The ratio of m1 to each m2 above which m1 may be a cart, or a cylinder that is turned."""
ZERO = re.compile(r"[+-]?0+([.,]0*)?( ?[^\W\d_]+)?|")
MEASURABLE = 1e-30, 1e30
OUT_OF_RANGE = f"is beyond what a fit computes with, {MEASURABLE[0]} to {MEASURABLE[1]:.0e}"


class Runs(NamedTuple):
    """The n runs of a table, and all their measurements, run by run.

    Columns of runs (n): ``given`` has m1 and m2 (kg), and drop (m) if times were measured, ``u`` their
    uncertainties; ``rows`` are the numbers of their rows, ``mean`` is that of the values. Columns of
    measurements: ``values`` as typed (m/s² or s), ``u_values`` (0 if no uncertainty is stated), the ``run``
    of each, and ``cells``, where they stand: 8:t2. ``step`` is that of the last digit of any value. ``same``
    are conditions that the table has, the same in all rows.
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
    headings = _headings(sheet, labels, named)
    numbers = _numbers_of_rows(sheet, headings)
    places = [column.place for heading in headings for column in (heading, heading.u) if column]
    known = {*places, 0} if numbers else {*places}
    unread = {  # columns of numbers, by their places: the heading, and the first number
        place: (column, cell)
        for place, (column, *cells) in enumerate(zip(sheet.columns, *sheet.rows, strict=True))
        if not (place in known or column in labels) and (cell := next(filter(LIKE_NUMBER.match, cells), ""))
    }
    kind = _check(sheet, headings, unread, given, named)
    if kind == "a":  # a height has no effect
        headings = [heading for heading in headings if heading.name != "drop"]
    _check_labels(headings, unread)
    comma = decimal_commas_in(sheet.rows, places, sheet.separator)
    words = [f"{in_quotes(sheet.columns[0])} as the numbers of rows"] if numbers else []
    words += [f"{in_quotes(column)} as a label" for column, _ in unread.values()]
    by = {x: given[x].value for x in ("R", "g") if x in given and not given[x].uncertainty}
    given = {x: _in_own_terms(x, read, by) for x, read in given.items() if x in (*MASSES, "drop", "hanger")}
    hanger = given.get("hanger")
    extra = hanger.value if hanger else Fraction(0)
    if hanger:
        words.append(f"{shortened(str(hanger.given))} of hanger added to m1 and m2")
    with_units = [x for x in places if all(row[x] in EMPTY or OWN_UNIT.search(row[x]) for row in sheet.rows)]
    remarks = read_as(headings, sheet.separator, comma, [*words, *sheet.remarks], with_units)
    # The uncertainty of what is shared counts for all runs together.
    shared = {
        x: (read.value + extra * (x in MASSES), Fraction(0)) for x, read in given.items() if x != "hanger"
    }
    # What has no unit may have been meant in a smaller one.
    bare = {heading.name for heading in headings if not heading.unit and heading.place not in with_units}
    bare |= {x for x, read in given.items() if not OWN_UNIT.search(str(read.given))}
    same, runs, unused = dict[str, Input](), RowsOfRuns(), defaultdict[str, list[int]](list)
    numbers = numbers or list(range(1, len(sheet.rows) + 1))
    for number, row in zip(numbers, sheet.rows, strict=True):
        if _begins_trace(row, headings):
            unused["the height and the time are 0"].append(number)
            continue
        if any(map(STATISTIC.fullmatch, row)):
            unused["a mean or a standard deviation is no run"].append(number)
            continue
        inputs, measured = dict[str, Number](), dict[str, Number]()
        for heading, cell in _read_row(number, row, headings, comma, by):
            if heading.name in MEASURED:
                measured[f"{number}:{heading.name[0]}{heading.number}"] = cell[:2]
            elif heading.name not in CONDITIONS:
                inputs[heading.name] = cell.value + extra * (heading.name in MASSES), cell.uncertainty
            elif same.setdefault(heading.name, cell)[:2] != cell[:2]:
                why = f"differs between rows; a fit takes one {heading.name}, so fit the rows of each apart"
                raise refused(heading.column, why)
        if measured:
            rows, measurements = runs.setdefault(tuple({**inputs, **shared}.items()), ([], {}))
            rows.append(number)
            measurements.update(measured)
        else:
            unused[f"no {MEASURED[kind]} was measured"].append(number)
    remarks += [f"{in_words(*rows)}: not used, as {reason}." for reason, rows in unused.items()]
    if not runs:
        raise Unreadable(f"it has no runs{behind_an_error(remarks)}")
    left_out = [*map(str, without)]
    if left_out:
        remarks.append(f"left out, as asked: {', '.join(map(in_words, left_out))}.")
    result = _as_columns(kind, runs, numbers, left_out)
    columns = {**result.given, kind: result.values}
    for x, (least, what, unit) in LARGE.items():
        if x in bare and max(columns.get(x, [0])) >= least and not any(what in remark for remark in remarks):
            example = f"{given[x].given}{unit}" if x in given else f"{x} ({unit})"
            remarks.append(f"{what}; if they are in {unit}, say so, as in {example}.")
    heights = {dict(run).get("drop") for run in runs}
    if "drop" not in given and len(heights) == 1 and (height := heights.pop()):
        same["drop"] = Input(*height, None)  # if it is wrong, it is so in all runs alike
        result.u["drop"][:] = 0
    m1, m2 = (result.given[mass] for mass in MASSES)
    if min(m1) == max(m1) > CART * max(m2):
        remarks.append(f"m1 is {m1[0]:.6g} kg in all rows, far above m2; if it does not hang, give 0 for m1.")
    return result._replace(remarks=remarks, same=same)


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
        rows = f"{numbers[0]} to {numbers[-1]}"
        rule = f"is neither a row, {rows}, nor a measurement, as {next(iter(measured[0]))}"
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
    return "".join(f"; {remark.rstrip('.')}" for remark in remarks)


# Headings


def _headings(sheet: Sheet, labels: Collection[str], named: Mapping[str, str]) -> list[Heading]:
    """Return the columns that hold a quantity. Raises Unreadable, also for tables side by side."""
    known = [x for x in recognised(sheet.columns, VOCABULARY, named) if x not in (*labels, *OF_COLUMN_BEFORE)]
    if len(twice := [x for x in dict.fromkeys(known) if known.count(x) > 1]) > 1:
        raise Unreadable(f"tables stand side by side, with {listed(twice)} in each; put one below the other")
    return read_headings(sheet.columns, VOCABULARY, labels, named)


def _numbers_of_rows(sheet: Sheet, headings: Sequence[Heading]) -> list[int]:
    """Return the numbers of rows as the first column has them; none if it has others, or a quantity."""
    cells = [row[0].strip() for row in sheet.rows]
    column = sheet.columns[0]
    is_read = any(heading.place == 0 for heading in headings)
    is_mass = LIKE_MASS.search(column[:LONGEST_HEADING]) or unit_within(column, Heading(0, column, "m1"))
    if is_read or is_mass or not all(re.fullmatch("[0-9]{1,9}", cell) for cell in cells):
        return []
    numbers = [*map(int, cells)]
    return numbers if numbers == sorted({*numbers}) else []


def _check(
    sheet: Sheet,
    headings: Sequence[Heading],
    unread: Mapping[int, tuple[str, str]],
    given: Mapping[str, Input],
    named: Mapping[str, str],
) -> Kind:
    """Return what was measured, if runs have all columns. Raises Unreadable, SceneError."""
    names = {heading.name for heading in headings}
    measured = [heading for heading in headings if heading.name in MEASURED]
    kinds = {(bool(heading.number), heading.name): heading.column for heading in measured}
    if len(kinds) > 1:
        column, beside, *_ = (kinds[kind] for kind in sorted(kinds))
        why = "may be computed, as a mean is; number repeats, as t1, t2"
        raise refused(column, f"stands beside {in_quotes(beside)} and {why}")
    typed = [x for x in given if given[x].given is not None]
    has = {x: "a" if x == "drop" and "a" in names else x for x in typed}
    if double := [x for x in has if has[x] in names]:
        rule = f"is not needed, as the table has {has[double[0]]}; leave it out"
        raise SceneError(double[0], given[double[0]].given, rule)
    left, missing = [*unread.values()], [mass for mass in MASSES if mass not in {*names, *given}]
    if missing[1:]:  # M may be one of them
        left += [(heading.column, "") for heading in headings if heading.name == "M"]
    if not kinds:
        missing.append("a" if _fitting("a", left) and not _fitting("t", left) else "t")
    if not {"a", "drop"} & {*names, *given, *missing}:
        missing.append("drop")
    if missing:
        raise Unreadable(*_missing(missing, sheet, left, named))
    return "a" if "a" in names else "time"


def _missing(
    missing: Sequence[str], sheet: Sheet, left: Sequence[tuple[str, str]], named: Mapping[str, str]
) -> tuple[str, str]:
    """Return which columns runs need, those of the table, and options that name what is missing."""
    why = f"runs need m1, m2, and a, or t with the height of fall, drop; there are {listed(sheet.columns)}"
    why += f"; {', '.join(missing)} {'are' if missing[1:] else 'is'} missing"
    is_turned = left and all(LIKE_NUMBER.match(column) for column, _ in left)
    if is_turned or len(recognised([row[0] for row in sheet.rows], VOCABULARY)) > 1:
        return f"{why}: make each run a row, below headings, as m1 (g),m2 (g),t (s)", ""
    sums = [column for column in left if LIKE_SUM.search(column[0][:LONGEST_HEADING])]
    left = [column for column in left if column not in sums and not LIKE_THEORY.search(column[0])]
    left.sort(key=lambda column: bool(LIKE_MEAN.search(column[0])))
    speeds = [x for x in left if re.match(r"(v|speed)\b", x[0], re.IGNORECASE) or _fitting("speed", [x])]
    options, hints = [f"--column {quote(f'{name}={column}')}" for column, name in named.items()], ""
    for name in missing:
        fitting = _fitting(name, left)[: None if name in ("t", "a") else 1]
        left = [column for column in left if column not in fitting]
        absent = "--drop HEIGHT" if name == "drop" else f"--column {name}=HEADING"
        options += [f"--column {quote(f'{name}={column}')}" for column, _ in fitting] or [absent]
        if name == "m1" and not fitting:
            compute = "; of a total and a difference, compute m1 and m2 as (total ± difference)/2"
            hints += compute if sums else ", or --m1 0 if m2 alone hangs"
        if name == "t" and not fitting and left:
            compute = "; of a speed v after a fall from rest by h, compute a = v²/(2h)"
            hints += compute if speeds else "; name each column of repeats so" if left[1:] else ""
    return why, f"; give {' '.join(options)}{hints}"


def _fitting(name: str, unread: Sequence[tuple[str, str]]) -> list[tuple[str, str]]:
    """Return the unread columns that may hold a quantity, by name, or else by their unit or that of a cell.

    Of several, the headings differ from the first in a number or a letter alone, as those of repeats do.
    """
    meaning, ranks = Heading(0, "", SPELLINGS.get(name, name)), dict[tuple[str, str], int]()
    for column, cell in unread:
        unit = unit_within(column, meaning)
        fits = is_unit(unit or cell.lstrip("0123456789., "), meaning)
        is_named = 2 * (name_at_start(column, VOCABULARY) == meaning.name)
        is_mass = name in MASSES and LIKE_MASS.search(column[:LONGEST_HEADING])
        ranks[column, cell] = (is_named or int(fits or bool(is_mass))) if fits or not unit else 0
    best = [x for x, rank in ranks.items() if rank == max(ranks.values()) > 0]
    alike = [re.sub(r"\d+|\b[A-Za-z]\b", "", column) for column, _ in best]
    return [x for x, words in zip(best, alike, strict=True) if words == alike[0]]


def _check_labels(headings: Sequence[Heading], unread: Mapping[int, tuple[str, str]]) -> None:
    """Raise Unreadable for a column of numbers that could hold a quantity, and is no label then."""
    measured = {own.place for own in headings if own.name in MEASURED}
    mass = Heading(0, "", "m1")
    uncertain = [column for column, _ in unread.values() if LIKE_UNCERTAINTY.search(column[:LONGEST_HEADING])]
    for place, (column, _) in unread.items():
        unit = unit_within(column, mass)
        is_mass = unit != "t" and symbol_of(unit) in UNITS["mass"]  # that is a time, rather than a tonne
        if column in INPUTS:
            raise refused(column, "has no effect on a fit")
        if not column.strip() and place - 1 in measured:
            raise refused(column, "has numbers and no heading, behind a measurement; give it one")
        if column in uncertain:
            others = f", as could {listed(uncertain[1:])}" if uncertain[1:] else ""
            raise refused(column, f"could be an uncertainty{others}; name what of, as in 'u(t)'")
        may_be_mass = (not unit or is_unit(unit, mass)) and LIKE_MASS.search(column[:LONGEST_HEADING])
        if is_mass or may_be_mass:
            if LIKE_SUM.search(column[:LONGEST_HEADING]):
                raise refused(column, "looks like a sum or a difference of masses, which is not read")
            way = ", or give it as --hanger if it hangs on both sides"
            raise refused(column, "looks like a mass that is not read; add it to m1 or m2", way)


# Rows


def in_words(*places: int | str) -> str:
    """Return rows, or where a measurement stands, for a sentence: row 1, rows 1, 2, or row 8: t2."""
    return f"row{'s' if places[1:] else ''} {', '.join(map(str, places)).replace(':', ': ', 1)}"


def in_range(read: Input) -> bool:
    """Decide if a number, and its uncertainty, are 0 or of a size whose squares are doubles."""
    low, high = MEASURABLE
    sizes = (getattr(read.value, "number", read.value), read.uncertainty)
    return all(low <= abs(size) <= high for size in sizes if size)


def _begins_trace(row: Sequence[str], headings: Sequence[Heading]) -> bool:
    """Decide whether a row has a height and a time of 0, as where a trace of positions begins."""
    cells = [(heading.name, row[heading.place]) for heading in headings if heading.name in ("drop", "time")]
    return len({name for name, _ in cells}) == 2 and all(ZERO.fullmatch(cell.strip()) for _, cell in cells)


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
