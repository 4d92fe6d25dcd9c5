"""Solves a data frame of scenes: its results, and for a row that is no scene an error."""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, partial
from math import inf, nan
from typing import TYPE_CHECKING, Any, TypeVar

from ..files import Unreadable
from ..model.quantities import NAMES, REGIMES, STANDARD, Accuracy
from ..model.scene import Given, Scene, SceneError
from ..model.units import STANDARD_GRAVITY, counted, in_quotes, shortened
from ..solver.answers import Answers
from ..solver.messages import reasons_at
from .formats import Piece
from .layout import NOT_GIVEN, Layout, inputs_among, read_layout

if TYPE_CHECKING:
    import polars as pl

ERROR = "error"
Table = TypeVar("Table")


def solve_table(
    table: Table, quantities: Sequence[str] | None = None, accuracy: Accuracy = "certified"
) -> Table:
    """A table of scenes with results appended, and the error of each bad row: what `atwood batch` makes.

    ``table`` is a data frame of polars (lazy too) or pandas, or an Arrow table, and so is what comes back.
    Its columns m1, m2, M, mu and so on are inputs, in SI units or in those of the heading, as "m1 (g)"; other
    columns stay as they are. An input is not given where a value is missing. A NaN is an error of its row, in
    pandas too: where it stands for a missing value, pass ``table.convert_dtypes()``.

    For ``quantities`` and ``accuracy`` see `solve_arrays`. Raises SceneError for one that is not known,
    ValueError for a table that lacks a mass or has a column that could be meant for an input.
    """
    import polars as pl

    names = list(dict.fromkeys(STANDARD if quantities is None else quantities))
    solved = partial(_results, names=names, accuracy=accuracy)
    whole: Any = table
    match type(table).__module__.split(".")[0]:
        case "polars" if isinstance(whole, pl.LazyFrame):
            kinds = {name: pl.String if name == "regime" else pl.Float64 for name in names}
            schema = {**whole.collect_schema(), **kinds, ERROR: pl.String}
            solve = partial(solve_table, quantities=names, accuracy=accuracy)
            whole = whole.map_batches(solve, schema=schema, streamable=True)
        case "polars" if isinstance(whole, pl.DataFrame):
            whole = whole.hstack(solved(whole.columns, whole.get_column))
        case "pandas" if hasattr(whole, "columns"):
            import pandas as pd

            columns = [name for name in whole.columns if isinstance(name, str)]
            results = solved(columns, lambda name: pl.from_pandas(whole[name], nan_to_null=False)).to_pandas()
            whole = pd.concat([whole, results.set_index(whole.index)], axis=1)
        case "pyarrow" if hasattr(whole, "append_column"):
            results = solved(whole.column_names, lambda name: pl.from_arrow(whole.column(name)))
            for name in results.columns:
                whole = whole.append_column(name, results[name].to_arrow())
        case _:
            raise ValueError(
                f"a table is a data frame of polars or pandas, or an Arrow table, not {type(table).__name__}"
            )
    solution: Table = whole
    return solution


def _results(
    columns: Sequence[str], column: Callable[[str], Any], names: Sequence[str], accuracy: Accuracy
) -> "pl.DataFrame":
    """The columns to append to a table with those columns. Raises ValueError, SceneError."""
    import polars as pl

    try:
        check_clash(columns, names, "quantities")
        frame = pl.DataFrame([column(name).alias(name) for name in inputs_among(columns)])
        return solve_frame(frame, read_layout(Piece(columns, frame, 0)), names, accuracy, Tally(set(names)))
    except Unreadable as error:
        why, _, _ = str(error).partition("; or let it pass by --label")
        raise ValueError(f"cannot read the table: {why}") from None


@dataclass
class Tally:
    """The counts of a run, and how its tables were read.

    ``missing`` are the results that no row has, and ``not_given`` the words that stand for an empty cell of
    the table that is read now.
    """

    missing: set[str]
    rows: int = 0
    regimes: Counter[str] = field(default_factory=Counter)
    errors: int = 0
    first_error: str = ""
    beyond: int = 0
    reasons: Counter[tuple[str, str]] = field(default_factory=Counter)
    not_given: set[str] = field(default_factory=set)
    remarks: list[str] = field(default_factory=list)

    def lines(self) -> list[str]:
        """The messages: remarks, the summary, why valid rows lack results, the first error."""
        parts = [f"{self.regimes[regime]} {regime}" for regime in REGIMES if self.regimes[regime]]
        counts = [", ".join(parts)] if parts else []
        counts.append(counted(self.errors, "error") if self.errors else "no errors")
        if self.beyond:
            counts.append(f"{counted(self.beyond, 'value')} beyond the range of doubles left empty")
        summary = f"{counted(self.rows, 'row')}: {'; '.join(counts)}."
        first = [f"first error, in {self.first_error}"] if self.errors else []
        # Threads count in any order: the most frequent reason first.
        reasons = sorted(self.reasons.items(), key=lambda one: (-one[1], NAMES.index(one[0][0]), one[0][1]))
        missing = reasons_at(dict(reasons), self.rows, "in {} of {} rows")
        return [*dict.fromkeys(self.remarks), summary, *missing, *first]


def check_clash(columns: Sequence[str], names: Sequence[str], option: str) -> None:
    """Refuse a table with a column that is named as a result. Raises Unreadable."""
    if clash := [name for name in columns if name in (*names, ERROR)]:
        how = f"as a result is named so; rename it, or name other results by {option}"
        raise Unreadable(f"column {in_quotes(clash[0])} would be there twice, {how}")


def solve_frame(
    frame: "pl.DataFrame",
    layout: Layout,
    names: Sequence[str],
    accuracy: Accuracy,
    tally: Tally,
    others: Mapping[int, str] = {},
    few: bool = False,
) -> "pl.DataFrame":
    """The columns to append: the results, which are empty in rows that failed, and the errors.

    ``others`` are errors of rows that could not be read. A ``few`` rows are solved without NumPy.
    """
    import polars as pl

    doubles, errors, words = _doubles(frame, layout)
    errors |= others
    doubles["m1"].scatter(list(errors), None)  # such a row has no results
    tally.not_given |= {*NOT_GIVEN} & words
    solve = _one_by_one if few else _at_once
    columns, reasons = solve(doubles, list(dict.fromkeys(["regime", *names])), accuracy)
    regimes = columns["regime"]
    bad = [row for row in regimes.is_null().arg_true() if row not in errors]
    inputs = _inputs(frame, layout)[bad]

    @cache  # as many rows may be alike
    def why(*cells: Any) -> str:
        return _why(dict(zip(inputs.columns, cells, strict=True)), layout)

    errors |= {row: why(*cells) for row, cells in zip(bad, inputs.iter_rows(), strict=True)}
    error = pl.repeat(None, frame.height, dtype=pl.String, eager=True)
    error = error.scatter(list(errors), list(errors.values()))
    values = pl.selectors.float()
    tally.beyond += sum(map(sum, columns.select(values.is_infinite().sum()).iter_rows()))
    results = columns.select(pl.when(values.is_finite()).then(values).name.keep(), "regime")
    tally.missing -= {name for name in names if results[name].null_count() < frame.height}
    tally.regimes.update({regime: count for regime, count in regimes.value_counts().iter_rows() if regime})
    tally.reasons += reasons
    tally.errors += len(errors)
    tally.rows += frame.height
    return results.select(*names, error.alias(ERROR))


def _at_once(
    doubles: Mapping[str, "pl.Series"], names: Sequence[str], accuracy: Accuracy
) -> "tuple[pl.DataFrame, Counter[tuple[str, str]]]":
    """The results of all rows, where that of a bad row has no regime; in how many others one is missing, by
    its name and the reason.
    """
    import polars as pl

    from ..arrays import solve_and_count

    columns: Any = doubles
    results, reasons = solve_and_count(columns, accuracy, names)
    regimes = pl.Series([*REGIMES, None]).gather(results["regime"])
    return pl.DataFrame({**results, "regime": regimes}), reasons


def _one_by_one(
    doubles: Mapping[str, "pl.Series"], names: Sequence[str], accuracy: Accuracy
) -> "tuple[pl.DataFrame, Counter[tuple[str, str]]]":
    """As `_at_once`, but without NumPy, and exact whatever the accuracy."""
    import polars as pl

    rows: list[dict[str, Any]] = []
    reasons: Counter[tuple[str, str]] = Counter()
    for row in pl.DataFrame(doubles).iter_rows(named=True):
        row["g"] = float(STANDARD_GRAVITY) if row.get("g") is None else row["g"]
        try:
            answers = Answers(Scene.read(row))
        except SceneError:
            rows.append({})
            continue
        rows.append({name: answers[name] for name in names})
        reasons.update((name, answers.reasons[name]) for name in names if answers[name] is None)
    kinds = {name: pl.String if name == "regime" else pl.Float64 for name in names}
    return pl.DataFrame(rows, kinds), reasons


def _inputs(frame: "pl.DataFrame", layout: Layout) -> "pl.DataFrame":
    """The columns of inputs, renamed to the inputs."""
    import polars as pl

    return frame.select(pl.col(heading.column).alias(name) for name, heading in layout.headings.items())


def with_numbers(frame: "pl.DataFrame", layout: Layout) -> "pl.DataFrame":
    """A frame of texts with its inputs as numbers in the units of the headings, null where a cell is none."""
    doubles, _, _ = _doubles(frame, layout.as_it_stands())
    return frame.with_columns(
        doubles[name].alias(heading.column) for name, heading in layout.headings.items()
    )


def _doubles(
    frame: "pl.DataFrame", layout: Layout
) -> "tuple[dict[str, pl.Series], dict[int, str], set[str]]":
    """The inputs by name, null where a cell is empty or wrong; the first error of each row that has one; and
    cells that are no numbers.
    """
    import polars as pl

    columns: dict[str, pl.Series] = {}
    errors: dict[int, str] = {}
    words: set[str] = set()
    for name, cells in zip(layout.headings, _inputs(frame, layout), strict=True):
        if not (cells.dtype.is_numeric() or cells.dtype in (pl.String, pl.Null)):
            raise Unreadable(f"column {name} holds {shortened(str(cells.dtype))}, not numbers")
        columns[name] = layout.as_doubles(name, cells)
        odd = _odd_cells(cells, columns[name])
        for row, cell in odd.items():
            try:
                odd[row] = layout.double(name, cell)
            except SceneError as error:
                odd[row] = nan
                errors.setdefault(row, str(error))
            if odd[row] != odd[row]:
                odd[row] = None
                words.add(str(cell).strip())
        columns[name].scatter(list(odd), pl.Series(odd.values(), dtype=pl.Float64))
    return columns, errors, words


LONG = 100
"""Characters: a shorter text that is a nonzero double is within the limits of digits and exponents."""


def _odd_cells(cells: "pl.Series", doubles: "pl.Series") -> dict[int, Any]:
    """The cells, by row, that may not be equal to the doubles that polars read."""
    import polars as pl

    text = cells.dtype == pl.String
    odd = cells.is_not_null() & ~doubles.is_finite().fill_null(False)
    if (zero := doubles == 0).any():  # what is too small for a double would be another scene
        odd |= zero & (cells.str.contains("[1-9]") if text else cells != 0)  # it may be an exponent's, too
    if text:
        odd |= cells.str.len_bytes() > LONG
    rows = odd.arg_true()
    return dict(zip(rows, cells[rows], strict=True))


def _why(row: Mapping[str, Any], layout: Layout) -> str:
    """The error of a row, in the words of `solve`; cells that are numbers are quoted as typed."""
    cells: dict[str, Given | None] = {}
    for name, cell in row.items():
        unit = layout.headings[name].unit
        text = layout.pointed(cell).strip() if isinstance(cell, str) else cell
        if text is None or text in ("", *NOT_GIVEN):
            continue
        if (layout.double(name, cell) if isinstance(cell, str) else cell) == inf:
            cells[name] = inf
        else:
            cells[name] = f"{text}{unit}" if unit or isinstance(text, str) else float(text)
    try:
        Scene.read(cells)
    except SceneError as error:
        return str(error)
    return "this row cannot be solved"
