"""Frames of scenes: `solve_table` for frames of polars, eager and lazy, and files of Parquet."""

import os
import re
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager, redirect_stderr, suppress
from functools import partial
from io import TextIOWrapper
from queue import SimpleQueue
from typing import IO, TYPE_CHECKING, TypeVar

from ..output.page import progress
from ..reading.names import read_quantities
from ..tables.sources import Unreadable
from .solving import Layout, Question, Tally, read_layout, solve_cells

if TYPE_CHECKING:
    import polars as pl

Table = TypeVar("Table", "pl.DataFrame", "pl.LazyFrame")
OLDEST_POLARS = "1.41.1"


def check_polars() -> None:
    """Raise ImportError if polars is older than what tables are tested with."""
    import polars as pl

    oldest, version = ([*map(int, re.findall(r"\d+", x)[:3])] for x in (OLDEST_POLARS, pl.__version__))
    if version < oldest:
        found = f"{OLDEST_POLARS} or newer, not {pl.__version__}"
        raise ImportError(f"this needs polars {found}; pip install --upgrade polars")


def solve_table(table: Table, quantities: Sequence[str] | None = None) -> Table:
    """Append its results to each row of a table of scenes, as `atwood batch` does.

    Args:
        table: A data frame of polars, eager or lazy, with a row for each scene. Its columns m1, m2, M, mu and
            so on are inputs, in SI units and degrees, or in the unit of the heading, as "m1 (g)". Other
            columns stay as they are. An input is not given where a value is missing. A NaN is an error of
            its row, and a text that is no number is, too.
        quantities: The names or symbols of quantities, as "acceleration" or "a"; if None, regime,
            acceleration, tension_1, tension_2, mu_verge, friction_force and critical_pulley_mass.

    Returns:
        A table with the same rows, eager or lazy as the other was. Behind the columns of that table it has
        a column for each quantity, the nearest double in SI units, null where a value does not exist or is
        beyond the doubles; and ``error``, a sentence on each bad row, null in the others.

    Raises:
        SceneError: A quantity is not known (a ValueError).
        ValueError: The table is no frame of polars, lacks a mass, or has a column that could be meant for an
            input, holds no numbers, or is named as a result.
        ImportError: polars is missing or too old.
    """
    import polars as pl

    check_polars()
    if not isinstance(table, pl.DataFrame | pl.LazyFrame):
        what = f"the table is of type {type(table).__name__}"
        raise ValueError(f"{what}; give a polars frame, as by pl.from_pandas(frame)")
    asked = Question(read_quantities(quantities))
    schema = table.collect_schema()
    try:
        solve = partial(with_results, layout=read_layout(schema.names(), asked), asked=asked)
        if isinstance(table, pl.DataFrame):
            return solve(table)
        return table.map_batches(solve, schema=solve(pl.DataFrame(schema=schema)).schema, streamable=True)
    except Unreadable as error:
        why = re.sub("[;,] or ([a-z ]+ )?--.*", "", str(error))  # without the options of the command
        raise ValueError(f"cannot read the table: {why}") from None


def with_results(
    frame: "pl.DataFrame", layout: Layout, asked: Question, tally: Tally | None = None
) -> "pl.DataFrame":
    """Return a frame of scenes with their results. Raises Unreadable for a column that holds no numbers."""
    cells = frame.select(frame[heading.column].alias(heading.name) for heading in layout.headings)
    return frame.hstack(solve_cells(cells, layout, asked, tally or Tally(set())))


def solve_parquet(source: IO[bytes], target: IO[bytes], asked: Question, tally: Tally) -> Layout:
    """Write a file of scenes with their results, in the same order.

    Raises Unreadable for a file that is no Parquet, or is damaged.
    """
    import polars as pl

    with _reading():
        table = pl.scan_parquet(source)
        schema = table.collect_schema()
        total = int(table.select(pl.len()).collect().item())
        layout = read_layout(schema.names(), asked)
        head = with_results(pl.DataFrame(schema=schema), layout, asked)
        parts = table.collect_batches(maintain_order=True)
        written = _write(
            (with_results(part, layout, asked, tally) for part in parts), head.schema, target, total
        )
    if written != total:
        raise Unreadable(f"it is damaged: it should have {total} rows, and has {written}")
    return layout


def _write(frames: "Iterator[pl.DataFrame]", schema: "pl.Schema", target: IO[bytes], total: int) -> int:
    """Write frames as Parquet. Returns the number of all rows, which should be the ``total``.

    A thread writes while this one waits and shows progress, as polars would not hear Ctrl-C. An error ends
    the frames, since polars would panic over an exception, and is raised here.
    """
    from polars.io.plugins import register_io_source

    done: SimpleQueue[int | None] = SimpleQueue()
    failed: list[BaseException] = []

    def source(*_: object) -> "Iterator[pl.DataFrame]":
        try:
            while not failed and (frame := next(frames, None)) is not None:
                done.put(frame.height)
                yield frame
        except GeneratorExit:
            raise
        except BaseException as error:
            failed.append(error)

    sink = register_io_source(source, schema=schema).sink_parquet
    with ThreadPoolExecutor(1) as writer:
        writing = writer.submit(sink, target, compression="snappy")
        writing.add_done_callback(lambda _: done.put(None))
        try:
            with progress(iter(done.get, None), total, int, int) as heights:
                written = sum(heights)
        except BaseException as error:
            failed.append(error)
            raise
    if failed:
        raise failed[0]
    writing.result()
    return written


@contextmanager
def _reading() -> Iterator[None]:
    """Raise Unreadable for any error that polars makes of damaged Parquet.

    Its threads that panic write to the descriptor of stderr. So this leads nowhere meanwhile, while
    `sys.stderr` leads where it did.
    """
    import polars as pl

    with ExitStack() as stack:
        with suppress(OSError):  # stderr may be closed
            kept = os.dup(2)
            stack.callback(os.close, kept)
            stack.callback(os.dup2, kept, 2)
            if isinstance(sys.stderr, TextIOWrapper) and sys.stderr is sys.__stderr__:
                encoding = sys.stderr.encoding
                visible = stack.enter_context(open(kept, "w", encoding=encoding, closefd=False))
                stack.enter_context(redirect_stderr(visible))
            os.dup2(stack.enter_context(open(os.devnull, "w")).fileno(), 2)
        try:
            yield
        except (pl.exceptions.PolarsError, pl.exceptions.PanicException, MemoryError) as error:
            why = str(error).splitlines() or ["it does not fit into memory"]
            raise Unreadable(f"it is not Parquet that polars can read: {why[0]}") from None
