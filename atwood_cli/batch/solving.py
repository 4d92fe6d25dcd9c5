"""Rows of scenes: their columns are recognised, their cells read, and results or errors found for each."""

import re
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
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
from ..reading.units import Malformed, read_unit
from ..solver.answers import Answers
from ..solver.quantities import NAMES, REGIMES
from ..solver.scene import INPUTS, MASSES, Scene, SceneError, parameter_of
from ..tables.headings import EMPTY, Heading, Vocabulary, divisions, listed, pointed, read_headings, refused
from ..tables.sources import Unreadable

if TYPE_CHECKING:
    import polars as pl

ERROR = "error"
VOCABULARY = Vocabulary({name.replace("_", ""): name for name in INPUTS}, in_terms=True)

GREEK_SPELLED = str.maketrans({"μ": "mu", "φ": "phi", "ϕ": "phi", "β": "beta"})
LONG_CELL = 100
"""The characters up to which any text of a nonzero double is within the limits of digits and exponents."""


class Wanted(NamedTuple):
    """The quantities wanted of a table, its columns that hold no input, and the inputs by other headings.

    ``conditions`` are expected to hold in each row.
    """

    names: Sequence[str]
    labels: Collection[str] = ()
    named: Mapping[str, str] = {}
    conditions: Sequence[Condition] = ()


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
    named = {known.get(without_blanks(one), one): name for one, name in wanted.named.items()}
    headings = read_headings(columns, VOCABULARY, labels, named, whole)
    inputs = {heading.name for heading in headings}
    passed = {*labels, *(heading.column for heading in headings)}
    doubtful = {column: name for column in columns if column not in passed and (name := _meant(column))}
    for column, name in doubtful.items():
        if name in INPUTS and not (whole and name in inputs):  # in NDJSON, another row may lack the input
            *_, (_, unit) = divisions(without_blanks(column))
            asked_unit = "" if unit or not INPUTS[name].unit else " (UNIT)"
            way = f", or give --column {in_quotes(f'{name}{asked_unit}={column}')}"
            raise refused(column, f"may mean {name}; rename it", way)
    missing = [mass for mass in MASSES if mass not in inputs]
    if missing and whole:
        lacking = f"column {missing[0]} is" if len(missing) == 1 else "columns m1 and m2 are"
        way = " ".join(f"--column {mass}=HEADING" for mass in missing)
        raise Unreadable(f"{lacking} missing; there are {listed(columns)}", f"; or give {way}")
    for column, name in doubtful.items():
        if name not in INPUTS:
            raise refused(column, "has measurements, which only solve takes")
    not_read = [column for column in columns if column not in passed]
    return ReadColumns([*headings, *(Heading(-1, mass, mass) for mass in missing)], not_read)


def _meant(column: str) -> str | None:
    """Return the input that a heading may mean: in other letters, by another name or with a unit behind."""
    *_, (name, _) = divisions(without_blanks(column))
    letters = normalize("NFKC", name).casefold().translate(GREEK_SPELLED)
    words = [word for word in re.split("[^0-9a-z]+", letters) if word]
    if meant := OTHER_NAMES.get("_".join(words)):
        return meant
    if (meant := OTHER_NAMES.get("_".join(words[:-1]))) and (dimension := parameter_of(meant).dimensions):
        with suppress(Malformed):
            read_unit(re.split(r"[\W_]+", name)[-1], dimension)
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
        said = [f"{counted(self.rows, 'row')}: {'; '.join(counts)}."]
        ranked = sorted(self.reasons.items(), key=lambda item: (-item[1], NAMES.index(item[0][0])))
        said += reasons_in(dict(ranked), self.rows)
        said += [f"first error, in {self.first_error}"] if self.errors else []
        failed = f"{self.failed} of {counted(self.rows, 'row')} failed"
        return [*said, *self.failures.values(), *([failed] if self.failed else [])]


def solve_cells(
    cells: "pl.DataFrame", columns: ReadColumns, wanted: Wanted, tally: Tally, unread: Mapping[int, str] = {}
) -> "pl.DataFrame":
    """Return the columns to append to rows with these cells: the results, and the errors of bad rows.

    ``unread`` has the errors of rows that could not be read. Raises Unreadable for a column without numbers.
    """
    import polars as pl

    from ..arrays import VALID, solve_and_count

    doubles, errors = _doubles(cells, columns)
    errors |= unread
    rows = pl.int_range(cells.height, eager=True)
    if errors:  # only rows that could be read are solved
        rows = rows.filter(~rows.is_in([*errors]))
        doubles = doubles[rows]
    given: Any = doubles.to_dict()
    terms = {one.name: one.terms for one in columns.headings if one.terms}
    solved, reasons = solve_and_count(given, "exact", ["regime", *wanted.names], terms)
    bad = rows.filter(pl.Series(solved.pop("status")) != VALID)
    why = cache(partial(_why, columns))  # as many rows may be alike
    errors |= dict(zip(bad, map(why, cells[bad].iter_rows()), strict=True))
    regimes = pl.Series([*REGIMES, None], dtype=pl.String).gather(solved["regime"])
    values = pl.DataFrame({**solved, "regime": regimes})
    if len(rows) < cells.height:
        places = pl.repeat(None, cells.height, dtype=pl.Int64, eager=True)
        values = values.select(pl.all().gather(places.scatter(rows, range(len(rows)))))
    numbers = pl.selectors.float()
    beyond = sum(map(sum, values.select(numbers.is_infinite().sum()).iter_rows()))
    values = values.select(pl.when(numbers.is_finite()).then(numbers).name.keep(), "regime")
    error = pl.repeat(None, cells.height, dtype=pl.String, eager=True)
    error = error.scatter(list(errors), list(errors.values()))
    results = values.select(*wanted.names, error.alias(ERROR))
    failures = cache(partial(_failures, columns, wanted.conditions))
    for row, given_cells in enumerate(cells.iter_rows() if wanted.conditions else ()):
        if row not in errors:
            tally.fail(row, failures(given_cells))
    tally.beyond += beyond
    tally.reasons.update({key: count for key, count in reasons.items() if key[0] in wanted.names})
    tally.add(results, values["regime"])
    return results


def _doubles(cells: "pl.DataFrame", columns: ReadColumns) -> "tuple[pl.DataFrame, dict[int, str]]":
    """Return the inputs by name, null if a cell is empty or wrong, and the first error of each bad row."""
    import polars as pl

    inputs: dict[str, pl.Series] = {}
    errors: dict[int, str] = {}
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
        found: list[float | None] = []
        for row, cell in zip(rows, column[rows], strict=True):
            try:
                found.append(_double(heading, cell, columns.comma))
            except SceneError as error:
                found.append(None)
                errors.setdefault(row, str(error))
        inputs[heading.name] = doubles.scatter(rows, pl.Series(found, dtype=pl.Float64))
    return pl.DataFrame(inputs), errors


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


def _why(columns: ReadColumns, row: Sequence[Any]) -> str:
    """Return the error of a row, in the words of `solve`. It quotes numbers as they were typed."""
    try:
        _scene_of(columns, row)
    except SceneError as error:
        return str(error)
    return "this row cannot be solved"


def _failures(columns: ReadColumns, conditions: Sequence[Condition], row: Sequence[Any]) -> Mapping[str, str]:
    """Return what is expected of a row and fails, decided as `solve` does, with what holds instead."""
    answers = Answers(_scene_of(columns, row))
    return {x.typed: why for x in conditions if (why := failure(answers, x))}


def _scene_of(columns: ReadColumns, row: Sequence[Any]) -> Scene:
    """Read a row as `solve` does. Raises SceneError."""
    cells: dict[str, Any] = {}
    for heading, cell in zip(columns.headings, row, strict=True):
        text = pointed(heading.name, cell, columns.comma) if isinstance(cell, str) else cell
        if text is None or text in EMPTY:
            continue
        if heading.unit and str(text).lower() != "inf":
            text = f"{text}{heading.unit}"
        cells[heading.name] = text if isinstance(text, str) else float(text)
    return read_scene(cells)
