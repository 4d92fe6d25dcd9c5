"""Solves a table of scenes: it comes out with its results, and a row that is no scene with an error."""

import os
import signal
import stat
import sys
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from functools import cache, partial
from io import BytesIO
from math import inf, nan
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

from ..arrays import solve_and_count
from ..files import LONGEST_NAME, STREAM, Stdout, Unreadable, written_beside
from ..model.quantities import NAMES, REGIMES, Accuracy
from ..model.scene import Given, Scene, SceneError
from ..model.units import counted, in_quotes, shortened
from ..solver.messages import reasons_at
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
from .layout import NOT_GIVEN, Layout, has_masses, inputs_among, read_as, read_layout
from .ndjson import read_ndjson
from .parquet import count_rows, read_frames
from .writing import write

if TYPE_CHECKING:
    import polars as pl

Watch = Callable[[Iterator[Piece], int | None, Callable[[Piece], int]], Iterator[Piece]]
"""Passes pieces on, and may show progress: its arguments are the pieces, the size of all, and of one."""

ERROR = "error"


@dataclass
class Tally:
    """The counts of a run. ``missing`` are the results that no row has.

    ``source`` is the input that is read now, after ``rows_before`` of others. By input, ``not_given`` are the
    words that stand for an empty cell, and ``remarks`` make a line of them on how it was read.
    """

    missing: set[str]
    rows: int = 0
    regimes: Counter[str] = field(default_factory=Counter)
    errors: int = 0
    first_error: str = ""
    beyond: int = 0
    reasons: Counter[tuple[str, str]] = field(default_factory=Counter)
    source: str = ""
    rows_before: int = 0
    not_given: dict[str, set[str]] = field(default_factory=dict)
    remarks: dict[str, Callable[[list[str]], list[str]]] = field(default_factory=dict)

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
        remarks = []
        for source, words in self.not_given.items():
            others = [f"{' and '.join(sorted(words))} as not given"] if words else []
            remarks += self.remarks[source](others)
        return [*dict.fromkeys(remarks), summary, *missing, *first]


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
            if clash := [name for name in piece.columns if name in (*job.names, ERROR)]:
                how = "as a result is named so; rename it, or name other results by --only"
                raise Unreadable(f"column {in_quotes(clash[0])} would be there twice, {how}")
            layout = read_layout(piece, job.labels)
            usual = SEPARATORS.get(dict(job.sources)[tally.source], "")
            tally.remarks[tally.source] = partial(
                read_as, layout.headings.items(), layout.separator, usual, layout.comma
            )
        piece, results = _solve(piece, layout, job, tally)
        if not piece.lines:
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
        tally.not_given[source] = set()
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


def _solve(piece: Piece, layout: Layout, job: Job, tally: Tally) -> "tuple[Piece, pl.DataFrame]":
    """The piece as it is to be written, and the columns to append: the results, which are empty in rows that
    failed, and the errors.
    """
    import polars as pl

    frame = piece.frame
    scenes, errors, words = _scenes(frame, layout)
    errors |= piece.errors
    scenes["m1"][list(errors)] = nan  # such a row has no results
    tally.not_given[tally.source] |= {*NOT_GIVEN} & words
    wanted = list(dict.fromkeys(["regime", *job.names]))
    results, reasons = solve_and_count(scenes, job.accuracy, wanted)
    bad = [row for row in results["status"].nonzero()[0].tolist() if row not in errors]
    inputs = _inputs(frame, layout)[bad]

    @cache  # as many rows may be alike
    def why(*cells: Any) -> str:
        return _why(dict(zip(inputs.columns, cells, strict=True)), layout)

    errors |= {row: why(*cells) for row, cells in zip(bad, inputs.iter_rows(), strict=True)}
    if errors and not tally.errors:
        of = f" of {shortened(tally.source, LONGEST_NAME)}" if len(job.sources) > 1 else ""
        row = tally.rows - tally.rows_before + min(errors) + 1
        tally.first_error = f"row {row}{of}: {errors[min(errors)]}"
    columns = {
        "regime": _regimes(results["regime"], tally),
        **{name: _finite(results[name], tally) for name in wanted[1:]},
        ERROR: pl.repeat(None, frame.height, dtype=pl.String, eager=True).scatter(
            list(errors), list(errors.values())
        ),
    }
    tally.missing -= {name for name in job.names if columns[name].null_count() < frame.height}
    tally.reasons += reasons
    tally.errors += len(errors)
    tally.rows += frame.height
    is_text = dict(job.sources)[tally.source] != "parquet"
    if is_text and job.target_format not in SEPARATORS and not piece.lines:
        piece = piece._replace(frame=_with_numbers(frame, layout))
    return piece, pl.DataFrame({name: columns[name] for name in [*job.names, ERROR]})


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


def _with_numbers(frame: "pl.DataFrame", layout: Layout) -> "pl.DataFrame":
    """A frame of texts with its inputs as numbers in the units of the headings, null where a cell is none."""
    import polars as pl

    doubles, _, _ = _doubles(frame, layout.as_it_stands())
    return frame.with_columns(
        pl.Series(heading.column, doubles[name], nan_to_null=True)
        for name, heading in layout.headings.items()
    )


def _scenes(frame: "pl.DataFrame", layout: Layout) -> tuple[dict[str, Any], dict[int, str], set[str]]:
    """As `_doubles`, but masked where a cell is empty or wrong."""
    import numpy as np

    doubles, errors, words = _doubles(frame, layout)
    for name, values in doubles.items():
        if (empty := np.isnan(values)).any():
            doubles[name] = np.ma.array(values, mask=empty)
    return doubles, errors, words


def _doubles(frame: "pl.DataFrame", layout: Layout) -> tuple[dict[str, Any], dict[int, str], set[str]]:
    """The inputs by name, NaN where a cell is empty or wrong; the first error of each row that has one; and
    cells that are no numbers.
    """
    import polars as pl

    cells = _inputs(frame, layout)
    for name, kind in cells.schema.items():
        if not (kind.is_numeric() or kind in (pl.String, pl.Null)):
            raise Unreadable(f"column {name} holds {shortened(str(kind))}, not numbers")
    doubles = cells.select(
        layout.as_doubles(name, kind) for name, kind in cells.schema.items()
    )  # in parallel
    scenes: dict[str, Any] = {}
    errors: dict[int, str] = {}
    words: set[str] = set()
    for name in cells.columns:
        values = scenes[name] = doubles[name].to_numpy(writable=True)
        for row, cell in _odd_cells(cells[name], values).items():
            try:
                values[row] = layout.double(name, cell)
            except SceneError as error:
                values[row] = nan
                errors.setdefault(row, str(error))
            if values[row] != values[row]:
                words.add(str(cell).strip())
    return scenes, errors, words


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
    if text and (cells.str.len_bytes().max() or 0) > LONG:  # type: ignore[operator]
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
        if layout.double(name, cell) == inf:
            cells[name] = inf
        else:
            cells[name] = f"{text}{unit}" if unit or isinstance(text, str) else float(text)
    try:
        Scene.read(cells)
    except SceneError as error:
        return str(error)
    return "this row cannot be solved"
