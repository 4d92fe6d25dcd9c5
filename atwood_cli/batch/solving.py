"""Rows of scenes: their columns are recognised, their cells read, and results or errors found for each."""

import re
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cache, partial
from math import inf, isfinite
from typing import TYPE_CHECKING, Any, NamedTuple
from unicodedata import normalize

from ..explain.conditions import Condition, failure
from ..explain.messages import reasons_in
from ..numbers.digits import to_double
from ..numbers.text import counted, in_quotes, shortened, without_blanks
from ..reading.inputs import OTHER_NAMES, read_plain, read_scene, read_value
from ..solver.answers import Answers
from ..solver.quantities import NAMES, REGIMES
from ..solver.scene import INPUTS, MASSES, Angle, InTerms, SceneError, parameter_of
from ..tables.headings import (
    EMPTY,
    MASS_NAMES,
    OWN_UNIT,
    Heading,
    Vocabulary,
    divisions,
    is_unit,
    listed,
    pointed,
    read_headings,
    refused,
    unit_within,
)
from ..tables.sources import Unreadable

if TYPE_CHECKING:
    import polars as pl

ERROR = "error"
VOCABULARY = Vocabulary(MASS_NAMES | {name.replace("_", ""): name for name in INPUTS})

GREEK_SPELLED = str.maketrans({"μ": "mu", "φ": "phi", "ϕ": "phi", "β": "beta"})
LONG_CELL = 100
"""The characters up to which any text of a nonzero double is within the limits of digits and exponents."""


class Wanted(NamedTuple):
    """The quantities wanted of a table, its columns that hold no input, and the inputs by other headings.

    ``conditions`` are expected to hold in each row.
    ``given`` are inputs that all rows share, and ``digits`` those to which results are rounded, if any.
    """

    names: Sequence[str]
    labels: Collection[str] = ()
    named: Mapping[str, str] = {}
    conditions: Sequence[Condition] = ()
    given: Mapping[str, str] = {}
    digits: int | None = None


class ReadColumns(NamedTuple):
    """The columns of inputs, the headings of all that are not read, and whether commas are decimal."""

    headings: Sequence[Heading]
    not_read: Sequence[str] = ()
    comma: bool = False


# Columns


def read_columns(columns: Sequence[str], wanted: Wanted, whole: bool = True) -> ReadColumns:
    """Find the inputs among the columns. If the table is not ``whole``, a mass without a column has no cells.

    Raises Unreadable if a column has the name of a result, or may mean an input and is no label.
    """
    if clash := [column for column in columns if column in (*wanted.names, ERROR)]:
        raise Unreadable(f"column {in_quotes(clash[0])} has the name of a result; rename it")
    known = {without_blanks(column): column for column in columns}
    labels = {known.get(without_blanks(label), label) for label in wanted.labels}
    named = {known.get(without_blanks(column), column): name for column, name in wanted.named.items()}
    headings = read_headings(columns, VOCABULARY, labels, named, whole)
    inputs = {heading.name for heading in headings}
    if double := [name for name in wanted.given if name in inputs]:
        raise SceneError(double[0], wanted.given[double[0]], "is a column of the table, too; leave one out")
    inputs |= {name for name, text in wanted.given.items() if read_value(name, text) is not None}
    if not headings and inputs >= {*MASSES}:
        raise Unreadable(f"no column holds an input; there are {listed(columns)}")
    passed = {*labels, *(heading.column for heading in headings)}
    doubtful = {column: name for column in columns if column not in passed and (name := _meant(column))}
    for column, name in doubtful.items():
        if name in INPUTS and not (whole and name in inputs):  # in NDJSON, another row may lack the input
            has_unit = not INPUTS[name].unit or unit_within(column, Heading(0, column, name))
            typed = f"{name}{'' if has_unit else ' (UNIT)'}={column}"
            way = f", or give --column {in_quotes(typed)}"
            raise refused(column, f"may mean {name}; rename it", way)
    missing = [mass for mass in MASSES if mass not in inputs]
    if missing and whole:
        lacking = "columns m1 and m2 are" if missing[1:] else f"column {missing[0]} is"
        way = " ".join(f"--column {mass}=HEADING" for mass in missing)
        way += f", or --{missing[0]} for all rows"
        raise Unreadable(f"{lacking} missing; there are {listed(columns)}", f"; or give {way}")
    if measured := [column for column, name in doubtful.items() if name not in INPUTS]:
        raise refused(measured[0], "has measurements, which only solve takes")
    not_read = [column for column in columns if column not in passed]
    return ReadColumns([*headings, *(Heading(-1, mass, mass) for mass in missing)], not_read)


def _meant(column: str) -> str | None:
    """Return the input that a heading may mean: in other letters, by another name or with a unit behind."""
    for word, unit, is_loose in divisions(without_blanks(column)):
        letters = normalize("NFKC", word).casefold().translate(GREEK_SPELLED)
        meant = OTHER_NAMES.get("_".join(re.findall("[0-9a-z]+", letters)))
        if meant and not (is_loose and not is_unit(unit, Heading(0, column, meant))):
            return meant
    return None


# Rows


@dataclass
class Tally:
    """The counts of a run, and the results that its rows lack."""

    missing: set[str]
    """The results that no row has had."""
    rows: int = 0
    regimes: Counter[str] = field(default_factory=Counter)
    errors: int = 0
    first_error: str = ""
    beyond: int = 0
    reasons: Counter[tuple[str, str]] = field(default_factory=Counter)
    failures: dict[str, str] = field(default_factory=dict)
    """What is expected and fails, with the first row in which it does."""
    failed: int = 0

    def fail(self, row: int, failures: Mapping[str, str]) -> None:
        """Count one of the next rows by what fails in it."""
        self.failed += bool(failures)
        for typed, why in failures.items():
            self.failures.setdefault(typed, f"in row {self.rows + row + 1}: {why}")

    def add(self, results: "pl.DataFrame", regimes: "pl.Series") -> None:
        """Count the next rows by their results."""
        self.missing -= {name for name in self.missing if results[name].null_count() < results.height}
        self.regimes.update({regime: count for regime, count in regimes.value_counts().iter_rows() if regime})
        if bad := results.height - results[ERROR].null_count():
            row = results[ERROR].is_not_null().arg_max() or 0
            self.first_error = self.first_error or f"row {self.rows + row + 1}: {results[ERROR][row]}"
            self.errors += bad
        self.rows += results.height

    def lines(self) -> list[str]:
        """Return the messages: the summary, why results are missing, the most first, and the first error."""
        parts = [f"{self.regimes[regime]} {regime}" for regime in REGIMES if self.regimes[regime]]
        counts = [", ".join(parts)] if parts else []
        counts.append(counted(self.errors, "error") if self.errors else "no errors")
        if self.beyond:
            counts.append(f"{counted(self.beyond, 'value')} beyond the range of doubles left empty")
        lines = [f"{counted(self.rows, 'row')}: {'; '.join(counts)}."]
        ranked = sorted(self.reasons.items(), key=lambda item: (-item[1], NAMES.index(item[0][0])))
        lines += reasons_in(dict(ranked), self.rows)
        lines += [f"first error, in {self.first_error}"] if self.errors else []
        lines += self.failures.values()
        return [*lines, f"{self.failed} of {counted(self.rows, 'row')} failed"] if self.failed else lines


def solve_cells(
    cells: "pl.DataFrame", columns: ReadColumns, wanted: Wanted, tally: Tally, unread: Mapping[int, str] = {}
) -> "pl.DataFrame":
    """Return the columns to append to rows with these cells: the results, and the errors of bad rows.

    Rows of plain numbers are solved together, those with units in their cells one by one. ``unread`` has the
    errors of rows that could not be read. Raises Unreadable for a column without numbers, SceneError.
    """
    import polars as pl

    from ..arrays import VALID, solve_and_count

    shared = {name: _plain(name, text) for name, text in wanted.given.items()}
    doubles, errors, single = _doubles(cells, columns)
    if None in shared.values():
        single = {*range(cells.height)}
    errors |= unread
    rows = pl.int_range(cells.height, eager=True)
    if errors or single:
        rows = rows.filter(~rows.is_in([*errors, *single]))
        doubles = doubles[rows]
    given: Any = doubles.to_dict() | shared
    if "m1" in shared:  # perhaps all inputs are single numbers
        given["m1"] = pl.repeat(shared["m1"], len(rows), dtype=pl.Float64, eager=True)
    terms = {heading.name: heading.terms for heading in columns.headings if heading.terms}
    solved, reasons = solve_and_count(given, "exact", ["regime", *wanted.names], terms)
    single |= {*rows.filter(pl.Series(solved.pop("status")) != VALID)}
    regimes = pl.Series([*REGIMES, None], dtype=pl.String).gather(solved["regime"])
    values = pl.DataFrame({**solved, "regime": regimes})
    places = pl.repeat(None, cells.height, dtype=pl.Int64, eager=True).scatter(rows, range(len(rows)))
    solve_row = cache(partial(_solve_row, columns, wanted))  # as many rows may be alike
    records = list[Mapping[str, Any]]()
    for row in sorted(single - errors.keys()):
        outcome = solve_row(cells.row(row))
        if isinstance(outcome, str):
            errors[row] = outcome
            places[row] = None
        else:
            places[row] = values.height + len(records)
            records.append(outcome[0])
            reasons.update(outcome[1])
    if records or len(rows) < cells.height:
        values = pl.concat([values, pl.DataFrame(records, values.schema)]).select(pl.all().gather(places))
    numbers = pl.selectors.float()
    tally.beyond += sum(map(sum, values.select(numbers.is_infinite().sum()).iter_rows()))
    values = values.select(pl.when(numbers.is_finite()).then(numbers).name.keep(), "regime")
    if wanted.digits:
        to_digits = f"{{:.{wanted.digits - 1}e}}".format
        values = values.with_columns(numbers.map_elements(lambda x: float(to_digits(x)), pl.Float64))
    error = pl.repeat(None, cells.height, dtype=pl.String, eager=True)
    error = error.scatter(list(errors), list(errors.values()))
    results = values.select(*wanted.names, error.alias(ERROR))
    failures = cache(partial(_failures, columns, wanted))
    for row, given_cells in enumerate(cells.iter_rows() if wanted.conditions else ()):
        if row not in errors:
            tally.fail(row, failures(given_cells))
    tally.reasons.update({key: count for key, count in reasons.items() if key[0] in wanted.names})
    tally.add(results, values["regime"])
    return results


def _plain(name: str, text: str) -> float | None:
    """Return the double nearest to an input that all rows share; None if rows are to be solved one by one.

    Raises SceneError.
    """
    value = read_value(name, text)
    if isinstance(value, Angle | InTerms):
        value = value.number if value.unit == "°" else None
    return None if value is None else float(value) if value == inf else to_double(value)


def _doubles(cells: "pl.DataFrame", columns: ReadColumns) -> "tuple[pl.DataFrame, dict[int, str], set[int]]":
    """Return the inputs by name, null if a cell is empty or no plain number.

    With them come the first error of each bad row, and the rows with a cell that may have a unit.
    """
    import polars as pl

    inputs: dict[str, pl.Series] = {}
    errors: dict[int, str] = {}
    single = set[int]()
    for heading, column in zip(columns.headings, cells, strict=True):
        if column.dtype in (pl.Categorical, pl.Enum):
            column = column.cast(pl.String)
        if not (column.dtype.is_numeric() or column.dtype in (pl.String, pl.Null)):
            raise Unreadable(f"column {heading.name} holds {shortened(str(column.dtype))}, not numbers")
        if column.dtype == pl.String:
            column = column.str.strip_chars()
            column = column.set(column.is_in(EMPTY), None)
        doubles = _in_bulk(column, heading, columns.comma)
        rows = (column.is_not_null() & doubles.is_null()).arg_true()
        exact: list[float | None] = []
        for row, cell in zip(rows, column[rows], strict=True):
            try:
                exact.append(_double(heading, cell, columns.comma))
            except SceneError as error:
                exact.append(None)
                if isinstance(cell, str) and OWN_UNIT.search(cell):
                    single.add(row)
                else:
                    errors.setdefault(row, str(error))
        inputs[heading.name] = doubles.scatter(rows, pl.Series(exact, dtype=pl.Float64))
    return pl.DataFrame(inputs), errors, single


def _in_bulk(cells: "pl.Series", heading: Heading, comma: bool) -> "pl.Series":
    """Return the double nearest to each cell of a column, in SI units; null if only `_double` can tell."""
    import polars as pl

    factor = heading.factor
    power = len(str(max(factor, 1 / factor))) - 1
    if max(factor, 1 / factor) != 10**power:
        return pl.repeat(None, len(cells), dtype=pl.Float64, eager=True)
    if power and not cells.dtype.is_float():
        cells = cells.cast(pl.String)  # a decimal or a long integer would round twice
    if cells.dtype == pl.String:
        texts = cells.set(cells.str.len_bytes() > LONG_CELL, None)
        if comma:
            texts = texts.set(texts.str.contains(".", literal=True), None).str.replace(",", ".", literal=True)
        exact = texts + f"e{power if factor > 1 else -power}" if power else texts
        doubles = exact.cast(pl.Float64, strict=False)
    else:
        doubles = cells.cast(pl.Float64, strict=False)
        # A column, as polars would divide by a single number in two steps, and round twice.
        powers = pl.repeat(float(10**power), len(cells), eager=True)
        doubles = doubles * powers if factor > 1 else doubles / powers
    if (zero := doubles == 0).any():  # a number too small for a double would become 0, another scene
        nonzero = cells.str.contains("[1-9]") if cells.dtype == pl.String else cells != 0
        doubles = doubles.set(zero & nonzero, None)  # the digit may be an exponent's
    return doubles.set(~doubles.is_finite(), None)


def _double(heading: Heading, cell: str | float, comma: bool) -> float:
    """Return a cell as the double nearest to it, in SI units. Raises SceneError."""
    name = heading.name
    if isinstance(cell, str):
        exact = read_plain(name, cell, pointed(name, cell, comma))
    else:
        read_value(name, cell)  # raises if it is NaN, or infinite and must not be
        exact = Fraction(cell) if isfinite(cell) else inf
    if exact == inf and parameter_of(name).may_be_infinite:
        return inf
    value = to_double(Fraction(exact) * heading.factor)
    if abs(value) == inf or (exact and not value):
        raise SceneError(name, cell, "is beyond the range of doubles, 4.9e-324 to 1.8e308")
    return value


def _failures(columns: ReadColumns, wanted: Wanted, row: Sequence[Any]) -> Mapping[str, str]:
    """Return what is expected of a row and fails, decided as `solve` does, with what holds instead."""
    answers = _answers(columns, wanted, row)
    return {x.typed: why for x in wanted.conditions if (why := failure(answers, x))}


def _solve_row(
    columns: ReadColumns, wanted: Wanted, row: Sequence[Any]
) -> tuple[dict[str, Any], set[tuple[str, str]]] | str:
    """Return the results of a row and the reasons of those that it lacks, or its error."""
    try:
        answers = _answers(columns, wanted, row)
    except SceneError as error:
        return str(error)
    each = {name: answers.answer(name) for name in wanted.names if name != "regime"}
    reasons = {(name, answer.reason) for name, answer in each.items() if answer.reason}
    values = {"regime": answers.decided.regime} | {name: answer.value for name, answer in each.items()}
    return values, {*reasons, *answers.decided.assumptions.items()}


def _answers(columns: ReadColumns, wanted: Wanted, row: Sequence[Any]) -> Answers:
    """Solve a row, with what all rows share, as `solve` does. Raises SceneError."""
    cells: dict[str, Any] = {**wanted.given}
    for heading, cell in zip(columns.headings, row, strict=True):
        text = pointed(heading.name, cell, columns.comma) if isinstance(cell, str) else cell
        if text is None or text in EMPTY:
            continue
        if heading.unit and not (isinstance(text, str) and OWN_UNIT.search(text)):
            text = f"{text}{heading.unit}"
        cells[heading.name] = text if isinstance(text, str) else float(text)
    return Answers(read_scene(cells))
