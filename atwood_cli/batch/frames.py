"""Frames of scenes: `solve_table` for frames of polars, eager and lazy, of pandas and of dask.

An eager frame is solved by one call of `with_results`, in the caller's thread, with all its rows: pieces of
2^20 rows go to a pool of `solve_arrays`. For a lazy frame polars calls `with_results` when it is collected:
with batches of about 100,000 rows, in threads of its own, often in two at once, so that our pool has no part.
A file of Parquet comes in such batches, too, one after the other, from the thread that writes.
"""

import re
from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, TypeVar, cast

from ..output.text import naming_the_extra
from ..reading.names import read_quantities
from ..tables.sheets import Sheet
from ..tables.sources import Unreadable
from .solving import ReadColumns, TableTally, Wanted, read_columns, solve_cells

if TYPE_CHECKING:
    import polars as pl

Table = TypeVar("Table")
OLDEST_POLARS = (1, 41, 1)


def check_polars() -> None:
    """Raise ImportError for an older polars than the extra asks for: it reads a repeated column as one."""
    import polars as pl

    if tuple(map(int, re.findall(r"\d+", pl.__version__)[:3])) < OLDEST_POLARS:
        versions = f"{'.'.join(map(str, OLDEST_POLARS))} or newer, not {pl.__version__}"
        raise ImportError(f"this needs polars {versions}; pip install --upgrade polars")


def solve_table(table: Table, quantities: Sequence[str] | None = None) -> Table:
    """Append its results to each row of a table of scenes, as `atwood batch` does.

    Args:
        table: A data frame of polars (a lazy one, too), pandas or dask, with a row for each scene. Its
            columns m1, m2, M, mu and so on are inputs, in SI units and degrees, or in the unit of the
            heading, as "m1 (g)". Other columns stay as they are. An input is not given where a value is
            missing; in pandas, NaN is. A NaN in polars is an error of its row, as a text that is no number.
        quantities: The names or symbols of quantities, as "acceleration" or "a"; if None, regime,
            acceleration, tension_1, tension_2, mu_verge, friction_force and critical_pulley_mass.

    Returns:
        A table of the same kind with the same rows. Behind the columns of that table it has
        a column for each quantity, the nearest double in SI units, null where a value does not exist or is
        beyond the doubles; and ``error``, a sentence on each bad row, null in the others. Their types are
        the same for any rows, or none: texts are strings, in pandas of the type "string".

    Raises:
        SceneError: A quantity is not known (a ValueError).
        ValueError: The table is no frame of these, lacks a mass, or has a column that could be
            meant for an input, holds no numbers, or is named as a result.
        ImportError: polars is missing or too old.
    """
    with naming_the_extra():
        import polars as pl

    check_polars()
    frame: Any = table
    wanted = Wanted(read_quantities(quantities))
    try:
        if hasattr(frame, "iloc") and hasattr(frame, "columns"):
            if not hasattr(frame, "map_partitions"):
                return cast(Table, _solve_pandas(frame, wanted))
            meta = solve_table(frame._meta, quantities)
            return cast(Table, frame.map_partitions(solve_table, quantities, meta=meta))
        if not isinstance(frame, pl.DataFrame | pl.LazyFrame):
            what = f"the table is of type {type(table).__name__}"
            raise ValueError(f"{what}; give a data frame of polars, pandas or dask")
        schema = frame.collect_schema()
        solve = partial(with_results, columns=read_columns(Sheet(schema.names(), ()), wanted), wanted=wanted)
        if isinstance(frame, pl.DataFrame):
            return cast(Table, solve(frame))
        schema = solve(pl.DataFrame(schema=schema)).schema
        return cast(Table, frame.map_batches(solve, schema=schema, streamable=True))
    except Unreadable as error:
        raise ValueError(f"cannot read the table: {error}") from None


def _solve_pandas(frame: Any, wanted: Wanted) -> Any:
    """Return a frame of pandas with its results; polars would take it as a whole only with pyarrow."""
    import polars as pl

    columns, cells = read_columns(Sheet([*map(str, frame.columns)], ()), wanted), {}
    for heading in columns.headings:
        column = frame.iloc[:, heading.place]
        of_numbers = column.dtype.kind in "iuf"  # others may hold numbers and texts
        pairs = zip(column.tolist(), column.isna(), strict=True)
        cells[heading.name] = [
            None if absent else cell if of_numbers else str(cell) for cell, absent in pairs
        ]
    results = solve_cells(pl.DataFrame(cells), columns, wanted, TableTally())
    texts = [x.name for x in results.iter_columns() if x.dtype == pl.String]
    values = {x.name: x.to_list() if x.name in texts else x.to_numpy() for x in results.iter_columns()}
    return frame.assign(**values).astype(dict.fromkeys(texts, "string"))


def with_results(
    frame: "pl.DataFrame", columns: ReadColumns, wanted: Wanted, tally: TableTally | None = None
) -> "pl.DataFrame":
    """Return a frame of scenes with their results. Raises Unreadable for a column that holds no numbers."""
    cells = frame.select(frame[x.column].alias(x.name) for x in (*columns.headings, *columns.label))
    return frame.hstack(solve_cells(cells, columns, wanted, tally or TableTally()))
