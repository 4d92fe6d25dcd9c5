"""Rows of scenes: their columns are recognised, their cells read, and results or errors found for each."""

import re
from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cache, partial
from math import inf, log10
from typing import TYPE_CHECKING, Any, NamedTuple
from unicodedata import normalize

from ..explain.conditions import Condition, failures_of
from ..explain.messages import LIKE_RADIANS, PULL, reasons_in
from ..explain.tally import EXPECTED, Tally
from ..numbers.digits import to_double
from ..numbers.text import counted, in_quotes, shortened, without_blanks
from ..reading.inputs import NO_UNCERTAINTY, read_exactly
from ..reading.names import input_meant
from ..reading.units import UNITS, symbol_of
from ..solver.answers import Answers
from ..solver.decisions import REGIME_ASSUMED
from ..solver.quantities import REGIMES, STANDARD, TABLE_NAMES
from ..solver.scene import COLUMNS, INPUTS, MASSES, Input, Scene, SceneError, Unit
from ..tables.cells import BARE, EMPTY, has_unit, read_cell
from ..tables.headings import (
    LONGEST_HEADING,
    MASS_NAMES,
    NOTHING_SAID,
    Heading,
    Naming,
    Vocabulary,
    divisions,
    is_mass,
    is_unit,
    listed,
    named,
    places_of,
    unit_within,
)
from ..tables.places import understood
from ..tables.records import LIKE_NUMBER
from ..tables.sheets import Sheet
from ..tables.sources import Unreadable

if TYPE_CHECKING:
    import polars as pl

ERROR = "error"
ASSUMPTION = ("regime", REGIME_ASSUMED)
VOCABULARY = Vocabulary(MASS_NAMES | {name.replace("_", ""): name for name in (*INPUTS, "drop")})

GREEK_SPELLED = str.maketrans({"μ": "mu", "φ": "phi", "ϕ": "phi", "β": "beta", "α": "alpha", "θ": "theta"})
LIKE_INPUTS = {
    "axle": "(axle|bearing|achs|lager).*(frict|reib)|(frict|reib).*(axle|bearing|achse|lager)",
    "mu_k": "(kinetic|sliding|dynamic) (frict|coeff)|gleitreib",
    "mu": r"frict|reib|coeff|koeff|(?-i:^f\b)",
    "wrap": r"wrap|contact|umschling|winkel|\bangle|\bturns?\b|^alpha\b|^theta\b",
    "diameter": r"diameter|durchmesser|\bdia\b|(?-i:^D\b)",
    "R": "radius",
    "M": r"(pulley|sheave|\brolle).*(mass|weight)|(mass|weight).*(pulley|sheave|\brolle)",
    "I": "inertia|trägheit",
    "g": "gravity",
}
"""The inputs that headings may mean by a word or a first letter, as patterns; the first that fits counts."""
LONG_CELL = 100
"""The characters up to which any text of a nonzero double is within the limits of digits and exponents."""


class Wanted(NamedTuple):
    """The quantities wanted of a table, and what the user says of its columns.

    ``conditions`` are expected to hold in each row. ``given`` are inputs that all rows share, and ``digits``
    those to which results are rounded, if any.
    """

    names: Sequence[str]
    naming: Naming = NOTHING_SAID
    conditions: Sequence[Condition] = ()
    given: Mapping[str, str] = {}
    digits: int | None = None

    @property
    def columns(self) -> list[str]:
        """Return the names of the columns that are appended."""
        return [*self.names, *([EXPECTED] if self.conditions else []), ERROR]


class ReadColumns(NamedTuple):
    """The columns of inputs, headings not read, whether commas are decimal, the column that names rows."""

    headings: Sequence[Heading]
    not_read: Sequence[str] = ()
    comma: bool = False
    label: Sequence[Heading] = ()


# Columns


def read_columns(sheet: Sheet, wanted: Wanted, whole: bool = True) -> ReadColumns:
    """Find the inputs among the columns. If the table is not ``whole``, a mass without a column has no cells.

    The rows of the sheet are the first, to show. Raises NotUnderstood if a mass is missing, or a column may
    mean an input; Unreadable if one has the name of a result.
    """
    columns = sheet.columns
    if clash := [column for column in columns if column in wanted.columns]:
        names = f"{listed(clash)}; leave them out to solve a table of results again, or rename them"
        raise Unreadable(f"it has columns with the names of results: {names}")
    given = {x: text for x, text in wanted.given.items() if read_exactly(x, text).number is not None}
    headings = understood(sheet, wanted.naming, VOCABULARY, _doubt, given, whole)
    missing = [x for x in MASSES if x not in {*given, *(heading.name for heading in headings)}]
    if not (headings or missing):
        raise Unreadable(f"no column holds an input; there are {listed(columns)}")
    not_read = [i for i in range(len(columns)) if i not in places_of(headings)]
    has_label = wanted.conditions and columns and all(heading.place for heading in headings)
    label = [Heading(0, columns[0], LABEL)] if has_label else []
    headings += [Heading(-1, mass, mass) for mass in missing]
    return ReadColumns(headings, [named(columns[i], i) for i in not_read], label=label)


def _doubt(sheet: Sheet, place: int, has: Collection[str]) -> str:
    """Name a column that may mean an input."""
    meant = _meant(column := sheet.columns[place])
    is_known = not meant or {"diameter": "R"}.get(meant, meant) in has
    return "" if is_known else f"{named(column, place)} ({meant}?)"


def _meant(column: str) -> str:
    """Return what a heading may mean: in other letters, by another name, with a unit, or by a word in it."""
    for word, unit, is_loose in divisions(without_blanks(column)):
        letters = normalize("NFKC", word).casefold().translate(GREEK_SPELLED)
        meant = input_meant("".join(re.findall("[0-9a-z]+", letters)))
        if meant in INPUTS and not (is_loose and not is_unit(unit, Heading(0, column, meant))):
            return meant
    letters = normalize("NFKC", column[:LONGEST_HEADING]).translate(GREEK_SPELLED)
    words = " ".join(re.findall(r"[^\W\d_]+", letters))
    meanings = (name for name, pattern in LIKE_INPUTS.items() if re.search(pattern, words, re.I))
    is_angle = symbol_of(unit_within(column, Heading(0, column, "wrap"))) in UNITS["angle"]
    return next(meanings, "wrap" if is_angle else "M" if is_mass(column) else "")


# Rows


LABEL = "label"
BEYOND, LIKE, UNLIKE = "beyond the doubles", "like radians", "unlike radians"
IN_UNITS = "in units: "


@dataclass
class TableTally(Tally):
    """The counts of the rows of a table."""

    counts: Counter[str] = field(default_factory=Counter)
    """Of regimes, errors, values and wraps, and of numbers without a unit, and with one."""
    first_error: str = ""

    def add(
        self,
        results: "pl.DataFrame",
        reasons: Mapping[tuple[str, str], int],
        failures: Mapping[int, Mapping[str, str]],
        labels: Sequence[object],
        counts: Mapping[str, int],
    ) -> None:
        """Count the next rows by their results, and what fails in them by their places."""
        for row, failing in sorted(failures.items()):
            name = f" {in_quotes(str(labels[row]))}" if labels[row] else ""
            self.count_failures(f"row {self.rows + row + 1}{name}", failing)
        errors = results[ERROR]
        if errors.count() and not self.first_error:
            row = errors.is_not_null().arg_max() or 0
            self.first_error = f"row {self.rows + row + 1}: {errors[row]}"
        self.counts.update(dict(results["regime"].drop_nulls().value_counts().iter_rows()))
        self.counts.update({ERROR: errors.count(), **counts})
        self.count(results.height, (x.name for x in results if x.count()), reasons)

    def lines(self) -> list[str]:
        """Return the messages: the summary, why results are missing, the most first, and the first error."""
        assumed, errors, beyond = self.reasons[ASSUMPTION], self.counts[ERROR], self.counts[BEYOND]
        parts = [f"{self.counts[regime]} {regime}" for regime in REGIMES if self.counts[regime]]
        if assumed:
            some = f"{assumed} " if assumed < self.counts["no-slip"] else ""
            parts[0] += f" ({some}{REGIME_ASSUMED})"
        counts = [", ".join(parts), counted(errors, "error") if errors else "no errors"]
        if beyond:
            counts.append(f"{counted(beyond, 'value')} beyond the range of doubles left empty")
        lines = [f"{counted(self.rows, 'row')}: {'; '.join(filter(None, counts))}."]
        explained = self.asked or STANDARD[:4]  # the regime and the motion
        ranked = sorted(self.reasons.items(), key=lambda item: (-item[1], TABLE_NAMES.index(item[0][0])))
        lines += reasons_in({x: n for x, n in ranked if x[0] in explained and x != ASSUMPTION}, self.rows)
        if self.counts[LIKE] and not self.counts[UNLIKE]:
            most = f"all wraps are less than {LIKE_RADIANS[1]}°"
            lines.append(f"{most}; if they are in radians or turns, say so, as in wrap (rad).")
        lines += [PULL] if self.counts[PULL] else []
        bare = (x for x in INPUTS if self.counts[x] and self.counts[IN_UNITS + x])
        lines += [BARE.format(x, INPUTS[x].unit) for x in bare]
        lines += [f"first error, in {self.first_error}"] if errors else []
        expected = " and ".join(condition.typed for condition in self.expected)
        if expected and (errors or not self.rows):
            unsolved = f"{errors} of {counted(self.rows, 'row')} could not be solved, so do not meet"
            lines.append(f"{unsolved if errors else 'no row was judged; expected'} {expected}")
        return [*lines, *self.failures_said()]


def solve_cells(
    cells: "pl.DataFrame",
    columns: ReadColumns,
    wanted: Wanted,
    tally: TableTally,
    unread: Mapping[int, str] = {},
) -> "pl.DataFrame":
    """Return the columns to append to rows with these cells: the results, and the errors of bad rows.

    Rows of plain numbers are solved together, those with units in their cells one by one. ``unread`` has the
    errors of rows that could not be read. Raises Unreadable for a column without numbers, SceneError.
    """
    import polars as pl

    labels = cells[LABEL].to_list() if columns.label else [""] * cells.height
    as_texts = pl.selectors.decimal() | pl.selectors.by_dtype(pl.Categorical, pl.Enum)
    cells = cells.select(x.name for x in columns.headings).with_columns(as_texts.cast(pl.String))
    exact = {x: read_exactly(x, wanted.given.get(x)) for x in COLUMNS}
    shared = {x: _double(Heading(0, x, x), False, text) for x, text in wanted.given.items()}
    doubles, singles = _doubles(cells, columns)
    if None in shared.values():  # an option that is no double
        singles = {*range(cells.height)}
    rows, together = pl.int_range(cells.height, eager=True), doubles
    if unread or singles:
        rows = rows.filter(~rows.is_in([*unread, *singles]))
        together = doubles[rows]
    # No row is left here beside an option that is no double.
    given: Any = together.to_dict() | {x: double or 0.0 for x, double in shared.items()}
    values, is_valid, reasons = _solve_together(given, columns, wanted.names)
    values = values.with_columns(row=rows)
    if not is_valid.all():
        values, singles = values.filter(is_valid), singles | {*rows.filter(~is_valid)}
    failures = _judge(doubles, values["row"], columns, shared, wanted.conditions)
    records: list[dict[str, Any]] = [{"row": row, ERROR: error} for row, error in unread.items()]
    solve = cache(partial(_solve_row, columns, exact, wanted))  # as many rows may be alike
    for row in singles - unread.keys():
        record, lacking, failures[row] = solve(cells.row(row))
        records.append({"row": row, **record})
        reasons.update(lacking)
    if records:
        values = pl.concat([values, pl.DataFrame(records, values.schema)]).sort("row")
    numbers = pl.selectors.float()
    beyond = sum(map(sum, values.select(numbers.is_infinite().sum()).iter_rows()))
    results = values.select(pl.when(numbers.is_finite()).then(numbers).name.keep(), "regime", ERROR)
    if wanted.digits:
        to_digits = f"{{:.{wanted.digits - 1}e}}".format
        results = results.with_columns(numbers.map_elements(lambda x: float(to_digits(x)), pl.Float64))
    hints = _hints(cells, doubles, columns, exact, given.get("wrap"), sorted(singles))
    tally.add(results, reasons, failures, labels, {BEYOND: beyond, **hints})
    if wanted.conditions:
        fails = pl.int_range(pl.len()).is_in([x for x in failures if failures[x]])
        results = results.with_columns((~fails & pl.col(ERROR).is_null()).alias(EXPECTED))
    return results.select(wanted.columns)


def _solve_together(
    given: Mapping[str, Any], columns: ReadColumns, names: Sequence[str]
) -> "tuple[pl.DataFrame, pl.Series, Counter[tuple[str, str]]]":
    """Return the results of rows of doubles, whether these are valid, and why results are missing."""
    import polars as pl

    from ..arrays import VALID, solve_and_count

    terms = {heading.name: heading.read.terms for heading in columns.headings if heading.read.terms}
    solved, reasons = solve_and_count(given, "exact", ["regime", *names], terms)
    is_valid = pl.Series(solved.pop("status")) == VALID
    regimes = pl.Series([*REGIMES, None], dtype=pl.String).gather(solved["regime"])
    values = pl.DataFrame({**solved, "regime": regimes}).with_columns(pl.lit(None, pl.String).alias(ERROR))
    return values, is_valid, reasons


def _judge(
    doubles: "pl.DataFrame",
    rows: Iterable[int],
    columns: ReadColumns,
    shared: Mapping[str, float | None],
    conditions: Sequence[Condition],
) -> dict[int, Mapping[str, str]]:
    """Return the conditions that fail in rows of doubles, as what is printed is judged."""
    in_si = ReadColumns([x._replace(unit="", read=Unit(terms=x.read.terms)) for x in columns.headings])
    inputs = {x: read_exactly(x, shared.get(x)) for x in COLUMNS}
    judge = cache(lambda row: failures_of(_answers(in_si, inputs, row), conditions))
    return {row: judge(doubles.row(row)) for row in rows} if conditions else {}


def _hints(
    cells: "pl.DataFrame",
    doubles: "pl.DataFrame",
    columns: ReadColumns,
    shared: Mapping[str, Input],
    wraps: Any,
    singles: Sequence[int],
) -> dict[str, int]:
    """Count wraps of plain degrees that are like radians or not, and numbers without a unit, and with one."""
    import polars as pl

    like = pl.select(pl.lit(wraps).is_between(*LIKE_RADIANS, closed="none")).to_series()
    hints = {LIKE: (most := int(like.sum() or 0)), UNLIKE: len(like) + len(singles) - most}
    masses = [heading for heading in columns.headings if heading.name in MASSES]
    is_weight = any(x.read.terms for x in masses) or any(shared[x].unit.terms for x in MASSES)
    for x in (heading.name for heading in columns.headings if not heading.unit):
        pairs = zip(singles, cells[x][singles], strict=True)
        own = [row for row, cell in pairs if has_unit(cell) and LIKE_NUMBER.match(cell)]
        is_number = doubles[x] != 0
        hints[x] = int(is_number.sum() or 0) - int(is_number[own].sum() or 0)
        hints[IN_UNITS + x] = len(own) + (is_weight and x in MASSES)
    if is_weight:
        hints[PULL] = shared["M"].number != inf
    return hints


def _doubles(cells: "pl.DataFrame", columns: ReadColumns) -> "tuple[pl.DataFrame, set[int]]":
    """Return the inputs by name, null if a cell is empty, and the rows to solve one by one.

    These have a cell with a unit of its own, or one that is no double.
    """
    import polars as pl

    inputs: dict[str, pl.Series] = {}
    single = set[int]()
    for heading, column in zip(columns.headings, cells, strict=True):
        if not (column.dtype.is_numeric() or column.dtype in (pl.String, pl.Null)):
            raise Unreadable(f"column {heading.name} holds {shortened(str(column.dtype))}, not numbers")
        if column.dtype == pl.String:
            column = column.str.strip_chars()
            column = column.set(column.is_in(EMPTY), None)
        doubles = _in_bulk(column, heading, columns.comma)
        rows = (column.is_not_null() & doubles.is_null()).arg_true()
        double_of = cache(partial(_double, heading._replace(place=0), columns.comma))
        others = [double_of(cell) for cell in column[rows]]
        read = zip(rows, column[rows], others, strict=True)
        single |= {row for row, cell, x in read if x is None or (x != inf and has_unit(cell))}
        inputs[heading.name] = doubles.scatter(rows, pl.Series(others, dtype=pl.Float64))
    return pl.DataFrame(inputs), single


def _in_bulk(cells: "pl.Series", heading: Heading, comma: bool) -> "pl.Series":
    """Return the double nearest to each cell of a column, in SI units; null if only `_double` can tell."""
    import polars as pl

    power = round(log10(heading.read.size))
    if heading.read.size != Fraction(10) ** power or heading.read.symbol == "rad":
        return pl.repeat(None, len(cells), dtype=pl.Float64, eager=True)
    if power and not cells.dtype.is_float():
        cells = cells.cast(pl.String)  # a decimal or a long integer would round twice
    if cells.dtype == pl.String:
        texts = cells.set(cells.str.len_bytes() > LONG_CELL, None)
        if comma:
            texts = texts.set(texts.str.contains(".", literal=True), None).str.replace(",", ".", literal=True)
        doubles = (texts + f"e{power}" if power else texts).cast(pl.Float64, strict=False)
    else:
        doubles = cells.cast(pl.Float64, strict=False)
        # A column, as polars would divide by a single number in two steps, and round twice.
        powers = pl.repeat(10.0 ** abs(power), len(cells), eager=True)
        doubles = doubles * powers if power > 0 else doubles / powers
    if (zero := doubles == 0).any():  # a number too small for a double would become 0, another scene
        nonzero = cells.str.contains("[1-9]") if cells.dtype == pl.String else cells != 0
        doubles = doubles.set(zero & nonzero, None)  # the digit may be an exponent's
    return doubles.set(~doubles.is_finite(), None)


def _double(heading: Heading, comma: bool, cell: str | float) -> float | None:
    """Return a cell as the double nearest to it, in SI units or degrees; None if its row is solved by itself.

    It may be no double, no number, uncertain, in radians, or in other terms than those of the heading.
    """
    try:
        read = read_cell(heading, [cell], comma)
    except SceneError:
        return None
    if read is None or read.uncertainty:
        return None
    number, unit = read.number, read.unit
    if unit.terms != heading.read.terms or unit.symbol == "rad" or number == inf:
        return inf if number == inf else None
    double = to_double(number)
    return None if abs(double) == inf or (number and not double) else double


def _solve_row(
    columns: ReadColumns, shared: Mapping[str, Input], wanted: Wanted, cells: Sequence[Any]
) -> tuple[dict[str, Any], Iterable[tuple[str, str]], Mapping[str, str]]:
    """Return the results of a row, or its error, the reasons of those that it lacks, and what fails."""
    try:
        answers = _answers(columns, shared, cells)
    except SceneError as error:
        return {ERROR: str(error)}, (), {}
    each = {name: answers.answer(name) for name in ("regime", *wanted.names)}
    reasons = {name: answer.reason for name, answer in each.items() if answer.reason}
    values = {name: answer.value for name, answer in each.items()}
    lacking = {*reasons.items(), *answers.decided.assumptions.items()}
    return values, lacking, failures_of(answers, wanted.conditions)


def _answers(columns: ReadColumns, shared: Mapping[str, Input], cells: Sequence[Any]) -> Answers:
    """Solve a row, with what all rows share, as `solve` does. Raises SceneError."""
    inputs = {**shared}
    for heading, cell in zip(columns.headings, cells, strict=True):
        if read := read_cell(heading._replace(place=0), [cell], columns.comma):
            if read.uncertainty:
                raise SceneError(heading.name, cell, NO_UNCERTAINTY)
            inputs[heading.name] = read
    return Answers(Scene.of(inputs))
