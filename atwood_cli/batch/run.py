"""Solves files of scenes: they come out with their results, and a row that is no scene with an error."""

import os
import signal
import stat
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
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
from .layout import inputs_among, read_as, read_layout
from .ndjson import read_ndjson
from .parquet import count_rows, read_frames
from .solving import ERROR, Tally, check_clash, solve_frame, with_numbers
from .writing import write

if TYPE_CHECKING:
    import polars as pl

FEW = 20
"""Rows of a table that are solved one by one, without NumPy: a run of one takes half the time."""
Solved = Iterator[tuple[Piece, "pl.DataFrame"]]
"""Pieces, each with the columns to append."""
Watch = Callable[[Solved, int | None, Callable[[tuple[Piece, "pl.DataFrame"]], int]], Solved]
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
    import polars as pl

    if hasattr(signal, "siginterrupt"):  # as it is imported, polars has Ctrl-C wait for a pipe
        signal.siginterrupt(signal.SIGINT, True)
    _check_apart(job)
    sizes = [_size(*source) for source in job.sources]
    solved = _solved(job, tally)
    if job.target != STREAM or not sys.stdout.isatty():
        total = None if None in sizes else sum(filter(None, sizes))
        solved = watch(solved, total, lambda one: one[0].size)
    at_once = any(_is_answered_at_once(job, *source) for source in job.sources)
    with ExitStack() as stack:
        target: IO[bytes] | Stdout = Stdout()
        if job.target != STREAM:
            beside = stack.enter_context(written_beside(Path(job.target), job.force))
            target = stack.enter_context(beside.open("wb"))
        try:
            if job.target_format == "parquet" and is_stream(job.target):
                # polars completes the file even where it fails, so a stream gets it only when it is whole.
                write(job.target_format, whole := BytesIO(), solved, at_once=False)
                target.write(whole.getbuffer())
            else:
                write(job.target_format, target, solved, at_once)
        except (pl.exceptions.PolarsError, pl.exceptions.PanicException) as error:
            why = shortened(str(error).splitlines()[0], LONGEST_NAME)
            raise OSError(f"cannot write {job.target_format}: {why}") from None
        target.flush()


def _check_apart(job: Job) -> None:
    """Refuse an output that is an input, by whatever name. Raises SceneError."""
    for source, _ in job.sources:
        try:
            read = os.stat(source) if source != STREAM else os.fstat(sys.stdin.fileno())
            target = os.stat(job.target) if job.target != STREAM else os.fstat(sys.stdout.fileno())
        except (OSError, ValueError, AttributeError):  # one is closed, or not there yet
            continue
        if stat.S_ISREG(target.st_mode) and os.path.samestat(read, target):
            raise SceneError("output", job.target, "is the input, which is never overwritten; name another")


def _size(source: str, kind: str) -> int | None:
    """The size of an input in the unit of `Piece.size`, None if it is not known. Raises OSError."""
    if is_stream(source):
        return None
    with _reading(source) as file:
        if is_packed(source):
            return None
        return count_rows(file) if kind == "parquet" else os.fstat(file.fileno()).st_size


@contextmanager
def _reading(source: str) -> Iterator[IO[bytes]]:
    """The input, opened. Raises OSError, which names it, for what is Unreadable."""
    try:
        with ExitStack() as stack:
            yield opened(source, stack)
    except Unreadable as error:
        raise cannot_read(source, error) from None


def _is_answered_at_once(job: Job, source: str, kind: str) -> bool:
    """Whether the input is a pipe from which each row is to be answered as it comes."""
    return job.target_format == kind == "ndjson" and is_stream(source)


def _solved(job: Job, tally: Tally) -> Solved:
    """Each piece with its results. Raises OSError for an input that is no table."""
    header: pl.Schema | None = None
    for source, kind in job.sources:
        where = f" of {shortened(source, LONGEST_NAME)}" if len(job.sources) > 1 else ""
        columns: Sequence[str] | None = None
        rows = 0
        tally.not_given.clear()
        with _reading(source) as file:
            for piece in _pieces(job, source, kind, file):
                if piece.columns != columns:
                    columns = piece.columns
                    check_clash(columns, job.names, "--only")
                    layout = read_layout(piece, job.labels)
                few = tally.rows + piece.frame.height <= FEW
                results = solve_frame(piece.frame, layout, job.names, job.accuracy, tally, piece.errors, few)
                if tally.errors and not tally.first_error:
                    row = results[ERROR].is_not_null().arg_max() or 0
                    tally.first_error = f"row {rows + row + 1}{where}: {results[ERROR][row]}"
                rows += results.height
                if not piece.lines:
                    if kind != "parquet" and job.target_format not in SEPARATORS:
                        piece = piece._replace(frame=with_numbers(piece.frame, layout))
                    header = header or piece.frame.schema
                    piece = piece._replace(frame=_in_order(piece.frame, header, job))
                yield piece, results
        words = [f"{' and '.join(sorted(tally.not_given))} as not given"] if tally.not_given else []
        usual = SEPARATORS.get(kind, "")
        tally.remarks += read_as(layout.headings.items(), layout.separator, usual, layout.comma, words)


def _in_order(frame: "pl.DataFrame", header: "pl.Schema", job: Job) -> "pl.DataFrame":
    """The frame with its columns in the order of those of the first. Raises Unreadable if they are others."""
    schema, first = frame.schema, shortened(job.sources[0][0], LONGEST_NAME)
    for name in [*header, *schema]:
        if name not in schema:
            raise Unreadable(f"it has no column {in_quotes(name)}, which {first} has")
        if name not in header:
            raise Unreadable(f"it has a column {in_quotes(name)}, which {first} has not")
        if job.target_format == "parquet" and schema[name] != header[name]:
            raise Unreadable(f"column {in_quotes(name)} holds {schema[name]}, and in {first} {header[name]}")
    return frame[:, list(header)]


def _pieces(job: Job, source: str, kind: str, file: IO[bytes]) -> Iterator[Piece]:
    """A table in pieces: at least one, which may have no rows. Raises Unreadable."""
    inputs = partial(inputs_among, labels=job.labels)
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
            yield from read_ndjson(blocks, inputs, as_lines=job.target_format == "ndjson")
        case _:
            yield from read_csv(file, SEPARATORS[kind], inputs)
