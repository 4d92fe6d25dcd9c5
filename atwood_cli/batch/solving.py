"""Solves a data frame of scenes: its results, and for a row that is no scene an error."""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, partial
from math import inf, nan
from typing import TYPE_CHECKING, Any, TypeVar

from ..arrays import solve_and_count
from ..files import Unreadable
from ..model.quantities import NAMES, REGIMES, STANDARD, Accuracy
from ..model.scene import Given, Scene, SceneError
from ..model.units import counted, in_quotes, shortened
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
) -> "pl.DataFrame":
    """The columns to append: the results, which are empty in rows that failed, and the errors.

    ``others`` are errors of rows that could not be read.
    """
    import numpy as np
    import polars as pl

    doubles, errors, words = _doubles(frame, layout)
    errors |= others
    doubles["m1"][list(errors)] = nan  # such a row has no results
    scenes: Any = {name: np.ma.array(values, mask=np.isnan(values)) for name, values in doubles.items()}
    tally.not_given |= {*NOT_GIVEN} & words
    wanted = list(dict.fromkeys(["regime", *names]))
    results, reasons = solve_and_count(scenes, accuracy, wanted)
    bad = [row for row in results["status"].nonzero()[0].tolist() if row not in errors]
    inputs = _inputs(frame, layout)[bad]

    @cache  # as many rows may be alike
    def why(*cells: Any) -> str:
        return _why(dict(zip(inputs.columns, cells, strict=True)), layout)

    errors |= {row: why(*cells) for row, cells in zip(bad, inputs.iter_rows(), strict=True)}
    columns = {
        "regime": _regimes(results["regime"], tally),
        **{name: _finite(results[name], tally) for name in wanted[1:]},
        ERROR: pl.repeat(None, frame.height, dtype=pl.String, eager=True).scatter(
            list(errors), list(errors.values())
        ),
    }
    tally.missing -= {name for name in names if columns[name].null_count() < frame.height}
    tally.reasons += reasons
    tally.errors += len(errors)
    tally.rows += frame.height
    return pl.DataFrame({name: columns[name] for name in [*names, ERROR]})


def _regimes(codes: Any, tally: Tally) -> "pl.Series":
    """A column of the regimes' names, empty in rows that failed; the tally counts them."""
    import numpy as np
    import polars as pl

    _, *counts = np.bincount(codes + 1, minlength=len(REGIMES) + 1).tolist()  # -1 is the code of an error
    tally.regimes.update(dict(zip(REGIMES, counts, strict=True)))
    return pl.Series([*REGIMES, None]).gather(codes)


def _finite(values: Any, tally: Tally) -> "pl.Series":
    """A column of results, empty where a value does not exist or no double can hold it."""
    import numpy as np
    import polars as pl

    beyond = np.isinf(values)
    tally.beyond += int(beyond.sum())
    return pl.Series(np.where(beyond, nan, values), nan_to_null=True)


def _inputs(frame: "pl.DataFrame", layout: Layout) -> "pl.DataFrame":
    """The columns of inputs, renamed to the inputs."""
    import polars as pl

    return frame.select(pl.col(heading.column).alias(name) for name, heading in layout.headings.items())


def with_numbers(frame: "pl.DataFrame", layout: Layout) -> "pl.DataFrame":
    """A frame of texts with its inputs as numbers in the units of the headings, null where a cell is none."""
    import polars as pl

    doubles, _, _ = _doubles(frame, layout.as_it_stands())
    return frame.with_columns(
        pl.Series(heading.column, doubles[name], nan_to_null=True)
        for name, heading in layout.headings.items()
    )


def _doubles(frame: "pl.DataFrame", layout: Layout) -> tuple[dict[str, Any], dict[int, str], set[str]]:
    """The inputs by name, NaN where a cell is empty or wrong; the first error of each row that has one; and
    cells that are no numbers.
    """
    import polars as pl

    cells = _inputs(frame, layout)
    for name, kind in cells.schema.items():
        if not (kind.is_numeric() or kind in (pl.String, pl.Null)):
            raise Unreadable(f"column {name} holds {shortened(str(kind))}, not numbers")
    frame = cells.select(layout.as_doubles(name, kind) for name, kind in cells.schema.items())
    doubles = {name: frame[name].to_numpy(writable=True) for name in cells.columns}
    errors: dict[int, str] = {}
    words: set[str] = set()
    for name, values in doubles.items():
        for row, cell in _odd_cells(cells[name], values).items():
            try:
                values[row] = layout.double(name, cell)
            except SceneError as error:
                values[row] = nan
                errors.setdefault(row, str(error))
            if values[row] != values[row]:
                words.add(str(cell).strip())
    return doubles, errors, words


LONG = 100
"""Characters: a shorter text that is a nonzero double is within the limits of digits and exponents."""


def _odd_cells(cells: "pl.Series", values: Any) -> dict[int, Any]:
    """The cells, by row, that may not be equal to the doubles that polars read."""
    import numpy as np
    import polars as pl

    text = cells.dtype == pl.String
    odd = ~np.isfinite(values)
    if odd.any():
        odd &= cells.is_not_null().to_numpy()
    if (zero := values == 0).any():  # what is too small for a double would be another scene
        some = cells.str.contains("[1-9]") if text else cells != 0  # in an exponent it may be beyond bounds
        odd |= zero & some.fill_null(False).to_numpy()
    if text:
        odd |= (cells.str.len_bytes() > LONG).fill_null(False).to_numpy()
    rows = odd.nonzero()[0]
    return dict(zip(rows.tolist(), cells.gather(rows).to_list(), strict=True)) if len(rows) else {}


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
