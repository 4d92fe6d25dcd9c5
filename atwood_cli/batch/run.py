"""Solves files of scenes: they come out with their results, and a row that is no scene with an error."""

import os
import signal
import stat
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from functools import partial
from io import BytesIO
from pathlib import Path
from typing import IO, TYPE_CHECKING

from ..files import LONGEST_NAME, STREAM, Stdout, Unreadable, written_beside
from ..model.quantities import Accuracy
from ..model.scene import SceneError
from ..model.units import in_quotes, shortened
from .formats import (
    SEPARATORS,
    Piece,
    blocks_as_they_come,
    blocks_of,
    cannot_read,
    check_count,
    is_packed,
    is_stream,
    opened,
    read_csv,
)
from .layout import has_masses, inputs_among, read_as, read_layout
from .ndjson import read_ndjson
from .parquet import count_rows, read_frames
from .solving import Tally, check_clash, solve_frame, with_numbers
from .writing import write

if TYPE_CHECKING:
    import polars as pl

Watch = Callable[[Iterator[Piece], int | None, Callable[[Piece], int]], Iterator[Piece]]
"""Passes pieces on, and may show progress: its arguments are the pieces, the size of all, and of one."""


@dataclass(frozen=True)
class Job:
    """The files with their formats, and the results wanted with their accuracy."""

    sources: Sequence[tuple[str, str]]
    target: str
    target_format: str
    names: Sequence[str]
    accuracy: Accuracy
    force: bool
    labels: Sequence[str] = ()


def run_batch(job: Job, watch: Watch, tally: Tally) -> None:
    """Solve tables of scenes; ``watch`` shows progress unless results go to a terminal. Raises OSError."""
    _check_apart(job)
    with ExitStack() as stack:
        import polars as pl

        if hasattr(signal, "siginterrupt"):  # as it is imported, polars has Ctrl-C wait for a pipe
            signal.siginterrupt(signal.SIGINT, True)
        try:
            sizes = []
            for tally.source, kind in job.sources:
                sizes.append(_size(tally.source, kind))
            total = None if None in sizes else sum(filter(None, sizes))
            at_once = any(_is_answered_at_once(job, *source) for source in job.sources)
            target = _target(job, stack)
            solved = _solved(job, total, tally, watch)
            if job.target_format == "parquet" and is_stream(job.target):
                # polars completes the file even where it fails, so a stream gets it only when it is whole.
                write(job.target_format, whole := BytesIO(), solved, at_once=False)
                target.write(whole.getbuffer())
            else:
                write(job.target_format, target, solved, at_once)
        except Unreadable as error:
            raise cannot_read(tally.source, error) from None
        except (pl.exceptions.PolarsError, pl.exceptions.PanicException) as error:
            why = shortened(str(error).splitlines()[0], LONGEST_NAME)
            raise OSError(f"cannot write {job.target_format}: {why}") from None
        target.flush()


def _check_apart(job: Job) -> None:
    """Refuse an output that is an input, by whatever name. Raises SceneError."""
    for source, _ in job.sources:
        try:
            read = _about(source)
            target = os.stat(job.target) if job.target != STREAM else os.fstat(sys.stdout.fileno())
        except (OSError, ValueError, AttributeError):  # one is closed, or not there yet
            continue
        if stat.S_ISREG(target.st_mode) and os.path.samestat(read, target):
            raise SceneError("output", job.target, "is the input, which is never overwritten; name another")


def _about(source: str) -> os.stat_result:
    return os.fstat(sys.stdin.fileno()) if source == STREAM else os.stat(source)


def _size(source: str, kind: str) -> int | None:
    """The size of an input in the unit of `Piece.size`, None if it is not known. Raises Unreadable."""
    try:
        about = _about(source)
    except (OSError, ValueError, AttributeError) as error:
        raise Unreadable(getattr(error, "strerror", None) or "it is closed") from None
    if not stat.S_ISREG(about.st_mode) or is_packed(source):
        return None
    if kind != "parquet":
        return about.st_size
    with ExitStack() as stack:
        return None if source == STREAM else count_rows(opened(source, stack))


def _is_answered_at_once(job: Job, source: str, kind: str) -> bool:
    """Whether the input is a pipe from which each row is to be answered as it comes."""
    return (kind, job.target_format) == ("ndjson", "ndjson") and not stat.S_ISREG(_about(source).st_mode)


def _target(job: Job, stack: ExitStack) -> IO[bytes] | Stdout:
    """The output, under its name once it is whole."""
    if job.target == STREAM:
        return Stdout()
    return stack.enter_context(open(stack.enter_context(written_beside(Path(job.target), job.force)), "wb"))


def _solved(
    job: Job, total: int | None, tally: Tally, watch: Watch
) -> "Iterator[tuple[Piece, pl.DataFrame]]":
    """Each piece with its results."""
    pieces = _pieces(job, tally)
    if job.target != STREAM or not sys.stdout.isatty():
        pieces = watch(pieces, total, lambda piece: piece.size)
    known: object = None
    header: pl.Schema | None = None
    for piece in pieces:
        if (tally.source, piece.columns) != known:
            known = tally.source, piece.columns
            check_clash(piece.columns, job.names, "--only")
            layout = read_layout(piece, job.labels)
            usual = SEPARATORS.get(dict(job.sources)[tally.source], "")
            tally.remarks[tally.source] = partial(
                read_as, layout.headings.items(), layout.separator, usual, layout.comma
            )
        results = solve_frame(piece.frame, layout, job.names, job.accuracy, tally, piece.errors)
        if not piece.lines:
            is_text = dict(job.sources)[tally.source] != "parquet"
            if is_text and job.target_format not in SEPARATORS:
                piece = piece._replace(frame=with_numbers(piece.frame, layout))
            header = header or piece.frame.schema
            piece = piece._replace(frame=_in_order(piece.frame, header, job))
        yield piece, results


def _in_order(frame: "pl.DataFrame", header: "pl.Schema", job: Job) -> "pl.DataFrame":
    """The frame with its columns in the order of those of the first. Raises Unreadable if they are others."""
    import polars as pl

    schema = frame.schema
    if list(schema.items()) == list(header.items()):
        return frame
    first = shortened(job.sources[0][0], LONGEST_NAME)
    for name in header:
        if name not in schema:
            raise Unreadable(f"it has no column {in_quotes(name)}, which {first} has")
        if job.target_format == "parquet" and schema[name] != header[name]:
            raise Unreadable(f"column {in_quotes(name)} holds {schema[name]}, and in {first} {header[name]}")
    for name in schema:
        if name not in header:
            raise Unreadable(f"it has a column {in_quotes(name)}, which {first} has not")
    return pl.DataFrame([frame.get_column(name) for name in header])


def _pieces(job: Job, tally: Tally) -> Iterator[Piece]:
    """The tables in pieces: at least one of each, which may have no rows. Raises Unreadable."""
    inputs = partial(inputs_among, labels=job.labels)
    for source, kind in job.sources:
        tally.source, tally.rows_before = source, tally.rows
        tally.where = f" of {shortened(source, LONGEST_NAME)}" if len(job.sources) > 1 else ""
        with ExitStack() as stack:
            file = opened(source, stack)
            match kind:
                case "parquet":
                    if is_stream(source) or is_packed(source):  # it is not read from front to back
                        file = BytesIO(b"".join(blocks_of(file)))
                    for frame in read_frames(file):
                        check_count(frame.columns)
                        yield Piece(frame.columns, frame, frame.height)
                case "ndjson":
                    at_once = _is_answered_at_once(job, source, kind)
                    blocks = blocks_as_they_come(file) if at_once else blocks_of(file)
                    is_table = partial(has_masses, labels=job.labels)
                    yield from read_ndjson(blocks, inputs, job.target_format == "ndjson", is_table)
                case _:
                    yield from read_csv(file, SEPARATORS[kind], inputs)
