"""Parquet in pieces, by pyarrow, which reads page by page and writes groups of as many rows as it is given.

polars holds a row group whole, and all groups it writes have equally many rows: 4 million texts in one group
took 0.7 GB, and rows that grow from a few bytes to 900 KB took 2.4 GB.
"""

import os
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from io import BytesIO
from itertools import pairwise
from typing import IO, TYPE_CHECKING, Any

from .pages import Column, footer_bytes, row_groups
from .quoted import Unreadable

if TYPE_CHECKING:
    import polars as pl

PIECE_BYTES, GROUP_BYTES = 1 << 21, 3 << 21
"""About what a piece that is read takes in memory, and a row group that is written."""
CHUNK_BYTES, MOST_CHUNKS = 1 << 14, 25_000
"""Of columns in row groups that are written: what they have at least, and how many there may be, at 2 KB."""
MOST_ROWS, FEW_ROWS, LONG_BYTES = 1 << 17, 1 << 4, 1 << 24
"""Rows decoded at a time; few where a column has so much text that they may have a megabyte each."""
FETCHED_BYTES, BATCH_BYTES = 1 << 16, 1 << 11
"""Of a column at a time; and what a batch takes that has hardly a row."""
MOST_HELD, MOST_FOOTER = 92 << 20, 10 << 20
"""Bytes: of one page of each column with dictionaries, and of the footer, which takes 20 times that."""


@contextmanager
def _decoding() -> Iterator[None]:
    """Whatever is made of damaged Parquet is Unreadable, and nothing of it goes to stderr."""
    import polars as pl
    import pyarrow as pa

    with _nothing_on_stderr():
        try:
            yield
        except (
            pa.ArrowException,
            pl.exceptions.PolarsError,
            pl.exceptions.PanicException,
            OSError,
            LookupError,
            MemoryError,
            NotImplementedError,
            ValueError,
        ) as error:
            why = str(error).splitlines() or ["it does not fit into memory"]
            raise Unreadable(f"it is not Parquet, or damaged: {why[0]}") from None


@contextmanager
def _nothing_on_stderr() -> Iterator[None]:
    """Threads of Rust that panic write to the descriptor, and know no sys.stderr."""
    try:
        kept = os.dup(2)
    except OSError:  # it is closed
        yield
        return
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 2)
    os.close(nowhere)
    try:
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)


def count_rows(file: IO[bytes]) -> int:
    """How many rows a file says that it has. Raises Unreadable."""
    from pyarrow.parquet import read_metadata

    with _decoding():
        if (size := footer_bytes(file)) > MOST_FOOTER:
            most = f"{size >> 20} MB, and {MOST_FOOTER >> 20} MB is the most taken"
            raise Unreadable(f"its footer takes {most}; write it in larger row groups")
        return int(read_metadata(file).num_rows)


def read_frames(file: IO[bytes]) -> "Iterator[pl.DataFrame]":
    """The rows of a file in pieces, behind a frame of none. Raises Unreadable."""
    from pyarrow.parquet import ParquetFile

    total, done = count_rows(file), 0
    with _decoding():
        table = ParquetFile(
            file, buffer_size=FETCHED_BYTES, pre_buffer=False, page_checksum_verification=True
        )
        _check_columns(table.schema_arrow)
        head = _as_frame(table.schema_arrow.empty_table())
    yield head
    with _decoding():
        rows = [_rows_at_once(*group, table.schema) for group in row_groups(file)]
    pieces = _cut(_decoded(table, rows))
    while True:
        with _decoding():
            piece = next(pieces, None)
            frame = None if piece is None else _as_frame(piece)
        if frame is None:
            break
        done += frame.height
        yield frame
    if done != total:
        raise Unreadable(f"it is damaged: it should have {total} rows, and has {done}")


def _check_columns(schema: Any) -> None:
    """Refuse columns that polars cannot have."""
    import pyarrow as pa

    for field in schema:
        if schema.names.count(field.name) > 1:
            raise Unreadable(f"column {field.name!r} is there {schema.names.count(field.name)} times")
        try:
            with _decoding():
                _as_frame(pa.table({field.name: pa.nulls(1, field.type)}))
        except Unreadable:
            raise Unreadable(f"column {field.name!r} holds {field.type}, which cannot be carried") from None


def _as_frame(table: Any) -> "pl.DataFrame":
    import polars as pl

    table.validate(full=True)  # polars takes it on trust that text is UTF-8
    frame = pl.from_arrow(table)
    assert isinstance(frame, pl.DataFrame)
    return frame


def _decoded(file: Any, rows: Sequence[int]) -> Iterator[Any]:
    """Tables of as many rows as make a piece, or more where they are short, decoded so many at a time."""
    import pyarrow as pa

    batches, size = [], 0
    for group, at_once in enumerate(rows):
        for batch in file.iter_batches(at_once, row_groups=[group], use_threads=False):
            batches.append(batch)
            size += BATCH_BYTES + batch.get_total_buffer_size()
            if size >= PIECE_BYTES:
                yield pa.Table.from_batches(batches).combine_chunks()
                del batch, batches[:]
                size = 0
                pa.default_memory_pool().release_unused()
    if batches:
        yield pa.Table.from_batches(batches).combine_chunks()


def _rows_at_once(rows: int, columns: Sequence[Column], schema: Any) -> int:
    """How many rows of a group can be decoded at a time, however long its texts are, and where."""
    held = sum(column.held for column in columns) + max((column.stored for column in columns), default=0)
    if held > MOST_HELD:
        most = f"{MOST_HELD >> 20} MB, the most taken"
        raise Unreadable(f"the pages of {rows} rows take more than {most}; write it in smaller row groups")
    texts = [column for column in columns if column.is_text]
    even, nested, longest = 1, 0, 1 + sum(column.dictionary for column in texts)
    for at, column in enumerate(columns):
        leaf = schema.column(at)
        if leaf.max_repetition_level:
            each = max(8, leaf.length) + column.is_text * column.dictionary
            nested += each * column.values + column.is_text * column.decoded
        else:
            even += max(8, leaf.length)
    if nested > LONG_BYTES:
        return FEW_ROWS
    fit = min(MOST_ROWS, PIECE_BYTES // even, LONG_BYTES // longest)
    if sum(column.decoded for column in texts) > LONG_BYTES:
        fit = min(fit, *(column.rows_within(LONG_BYTES // len(texts)) for column in texts))
    return max(FEW_ROWS, fit)


def _cut(tables: Iterable[Any]) -> Iterator[Any]:
    """The rows in pieces of about equal size, whatever the sizes of their texts."""
    import numpy as np
    import pyarrow as pa

    parts: list[Any] = []
    total = number = 0
    for table in tables:
        ends = total + np.cumsum(_row_bytes(table))
        numbers = ends // PIECE_BYTES  # of the pieces that rows belong to
        starts = [0, *np.flatnonzero(np.diff(numbers)) + 1, table.num_rows]
        for start, end in pairwise(starts):
            if parts and numbers[start] != number:
                yield pa.concat_tables(parts)
                parts.clear()
            parts.append(table.slice(start, end - start))
            number = numbers[start]
        total = ends[-1]
        del table  # it must not be there while the next one is decoded
    if parts:
        yield pa.concat_tables(parts)


def _is_text(type_: Any) -> bool:
    import pyarrow as pa

    return type_ in (pa.string(), pa.large_string(), pa.binary(), pa.large_binary())


def _row_bytes(table: Any) -> Any:
    """About what each row takes as a frame."""
    import numpy as np
    import pyarrow as pa
    from pyarrow import compute

    even, sizes = 8 * table.num_columns, np.zeros(table.num_rows, np.int64)
    for column in table.columns:
        if pa.types.is_dictionary(column.type) and _is_text(column.type.value_type):
            lengths = pa.chunked_array(
                [compute.binary_length(part.dictionary).take(part.indices) for part in column.chunks]
            )
        elif _is_text(column.type):
            lengths = compute.binary_length(column)
        else:
            even += column.nbytes // max(1, len(column))
            continue
        sizes += compute.fill_null(lengths, 0).to_numpy()
    return sizes + even


class RowGroups:
    """Rows as the bytes of a Parquet file, which come as soon as there are enough rows for a group."""

    def __init__(self) -> None:
        from pyarrow.parquet import ParquetWriter

        self._written = BytesIO()  # not the file itself, which would get a footer though something failed
        self._begin = partial(ParquetWriter, self._written, compression="snappy")  # which all can read
        self._writer: Any = None
        self._waiting: list[Any] = []
        self._size = self._chunks = 0

    def add(self, frame: "pl.DataFrame") -> bytes:
        """Add rows; the bytes that are ready."""
        table = frame.to_arrow()
        self._waiting.append(table)
        self._size += table.nbytes
        if self._size >= max(GROUP_BYTES, CHUNK_BYTES * frame.width):
            self._write_group()
        return self._ready()

    def end(self) -> bytes:
        """The rest of the bytes."""
        if self._waiting:
            self._write_group()
        self._writer.close()
        return self._ready()

    def _write_group(self) -> None:
        import pyarrow as pa

        table = pa.concat_tables(self._waiting)
        self._waiting.clear()
        self._size = 0
        self._chunks += table.num_columns
        if self._chunks > MOST_CHUNKS:
            most = f"{MOST_CHUNKS} pieces of columns, the most taken"
            raise OSError(f"cannot write more than {most}, as parquet; give --to csv")
        if self._writer is None:
            # Not numbers, which it would take thrice the time to write.
            texts = [field.name for field in table.schema if _is_text(field.type)]
            self._writer = self._begin(table.schema, use_dictionary=texts)
        self._writer.write_table(table, row_group_size=max(1, table.num_rows))
        pa.default_memory_pool().release_unused()

    def _ready(self) -> bytes:
        ready = self._written.getvalue()
        self._written.seek(0)
        self._written.truncate()
        return ready
