"""Files of Parquet: read in batches, solved, and written in a thread."""

import os
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager, redirect_stderr, suppress
from io import TextIOWrapper
from itertools import takewhile
from threading import Event
from typing import IO, TYPE_CHECKING

from ..numbers.text import counted
from ..output.page import progress
from ..tables.sources import Unreadable
from .frames import with_results
from .solving import ReadColumns, Tally, Wanted, read_columns

if TYPE_CHECKING:
    import polars as pl


def solve_parquet(source: IO[bytes], target: IO[bytes], wanted: Wanted, tally: Tally) -> ReadColumns:
    """Write a file of scenes with their results, in the same order.

    A thread writes while this one waits, as polars would not hear Ctrl-C. Raises Unreadable for a file that
    is no Parquet, or is damaged.
    """
    import polars as pl
    from polars.io.plugins import register_io_source

    stopped = Event()
    with _reading():
        table = pl.scan_parquet(source)
        schema = table.collect_schema()
        total = int(table.select(pl.len()).collect().item())
        columns = read_columns(schema.names(), wanted)
        head = with_results(pl.DataFrame(schema=schema), columns, wanted)
        parts = table.collect_batches(maintain_order=True)
        with progress(parts, total, pl.DataFrame.__len__, pl.DataFrame.__len__) as watched:

            def solved(*_: object) -> "Iterator[pl.DataFrame]":
                for part in takewhile(lambda _: not stopped.is_set(), watched):
                    yield with_results(part, columns, wanted, tally)

            table = register_io_source(solved, schema=head.schema)
            with ThreadPoolExecutor(1) as writer:
                try:
                    writer.submit(table.sink_parquet, target, compression="snappy").result()
                finally:
                    stopped.set()
    if tally.rows != total:
        raise Unreadable(f"it is damaged: it should have {counted(total, 'row')}")
    return columns


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
