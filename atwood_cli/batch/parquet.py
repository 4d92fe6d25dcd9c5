"""Parquet by polars, read and written one row group at a time: the largest group must fit into memory."""

import os
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager, suppress
from itertools import chain
from queue import SimpleQueue
from typing import IO, TYPE_CHECKING

from ..files import Unreadable

if TYPE_CHECKING:
    import polars as pl

PIECE_ROWS, PIECE_CELLS = 1 << 16, 1 << 20
"""The most rows and cells of a piece of any format, and of a row group that is written."""


@contextmanager
def _decoding() -> Iterator[None]:
    """Raises Unreadable for whatever polars makes of damaged Parquet.

    Its threads that panic write to the descriptor of stderr, which meanwhile leads nowhere.
    """
    import polars as pl

    with ExitStack() as stack:
        with suppress(OSError):  # stderr may be closed
            kept = os.dup(2)
            stack.callback(os.close, kept)
            stack.callback(os.dup2, kept, 2)
            os.dup2(stack.enter_context(open(os.devnull, "w")).fileno(), 2)
        try:
            yield
        except (pl.exceptions.PolarsError, pl.exceptions.PanicException, OSError, MemoryError) as error:
            why = str(error).splitlines() or ["it does not fit into memory"]
            raise Unreadable(f"it is not Parquet that polars can read: {why[0]}") from None


def count_rows(file: IO[bytes]) -> int:
    """The number of rows by the footer of a file. Raises Unreadable."""
    import polars as pl

    with _decoding():
        return int(pl.scan_parquet(file).select(pl.len()).collect().item())


def read_frames(file: IO[bytes]) -> "Iterator[pl.DataFrame]":
    """The rows of a file in pieces, after a frame without rows. Raises Unreadable."""
    import polars as pl

    total, done = count_rows(file), 0
    with _decoding():
        table = pl.scan_parquet(file)
        head = pl.DataFrame(schema=table.collect_schema())
        groups = table.collect_batches(maintain_order=True)
    yield head
    while True:
        with _decoding():
            group = next(groups, None)
        if group is None:
            break
        done += group.height
        yield from group.iter_slices(_rows_of(head))
    if done != total:
        raise Unreadable(f"it is damaged: it should have {total} rows, and has {done}")


def _rows_of(frame: "pl.DataFrame") -> int:
    return max(1, min(PIECE_ROWS, PIECE_CELLS // max(1, frame.width)))


def write_frames(file: IO[bytes], frames: "Iterator[pl.DataFrame]") -> None:
    """Write frames with the columns of the first, in groups of a fixed number of rows. Raises PolarsError.

    polars asks for frames from threads of its own, where Ctrl-C is not heard. So a thread writes, and this
    one makes the frames and hands them over.
    """
    from polars.io.plugins import register_io_source

    first = next(frames)
    # Of this kind of queue alone, whoever waits can be interrupted and leaves no lock behind.
    asked: SimpleQueue[bool] = SimpleQueue()
    handed: SimpleQueue[pl.DataFrame | None] = SimpleQueue()

    def source(*_: object) -> "Iterator[pl.DataFrame]":
        asked.put(True)
        while (frame := handed.get()) is not None:
            yield frame
            asked.put(True)

    table = register_io_source(source, schema=first.schema)
    with ExitStack() as stack:
        writer = stack.enter_context(ThreadPoolExecutor(1))
        stack.callback(handed.put, None)  # whatever happens from here on, before the writer is waited for
        writing = writer.submit(
            table.sink_parquet, file, compression="snappy", row_group_size=_rows_of(first)
        )
        writing.add_done_callback(lambda _: asked.put(False))  # one that failed asks no more
        for frame in chain([first], frames):
            if not asked.get():
                break
            handed.put(frame)
        handed.put(None)
        writing.result()
