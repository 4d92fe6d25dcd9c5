"""Files of Parquet: read in batches, solved, and written in a thread."""

import os
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager, redirect_stderr, suppress
from io import TextIOWrapper
from queue import SimpleQueue
from typing import IO, TYPE_CHECKING

from ..output.page import progress
from ..tables.sources import Unreadable
from .frames import with_results
from .solving import ReadColumns, Tally, Wanted, read_columns

if TYPE_CHECKING:
    import polars as pl


def solve_parquet(source: IO[bytes], target: IO[bytes], wanted: Wanted, tally: Tally) -> ReadColumns:
    """Write a file of scenes with their results, in the same order.

    Raises Unreadable for a file that is no Parquet, or is damaged.
    """
    import polars as pl

    with _reading():
        table = pl.scan_parquet(source)
        schema = table.collect_schema()
        total = int(table.select(pl.len()).collect().item())
        columns = read_columns(schema.names(), wanted)
        head = with_results(pl.DataFrame(schema=schema), columns, wanted)
        parts = table.collect_batches(maintain_order=True)
        written = _write(
            (with_results(part, columns, wanted, tally) for part in parts), head.schema, target, total
        )
    if written != total:
        raise Unreadable(f"it is damaged: it should have {total} rows, and has {written}")
    return columns


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
