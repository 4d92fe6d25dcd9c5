"""Files of scenes: each record comes out as it went in, followed by its results."""

import csv
import os
import signal
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import (
    AbstractContextManager,
    ExitStack,
    contextmanager,
    nullcontext,
    redirect_stderr,
    suppress,
)
from decimal import Decimal
from functools import partial
from io import BytesIO, StringIO, TextIOWrapper
from itertools import chain, islice, takewhile
from pathlib import Path
from threading import Event
from typing import IO, TYPE_CHECKING, NamedTuple

from ..numbers.digits import format_number, to_digits
from ..numbers.text import counted, without_blanks
from ..output.files import STDOUT, Stdout, written_beside
from ..output.page import progress
from ..output.text import markdown_table
from ..solver.quantities import QUANTITIES
from ..solver.scene import SceneError
from ..tables.cells import decimal_commas_in
from ..tables.headings import ABOVE, Heading, listed, read_as, recognised
from ..tables.sheets import Sheet
from ..tables.sources import Unreadable, blocks_of, is_packed, is_stream
from ..tables.workbooks import opened_table
from .frames import check_polars, with_results
from .pieces import ROWS_SHOWN, Csv, Piece, read_ndjson
from .solving import ERROR, VOCABULARY, ReadColumns, TableTally, Wanted, read_columns, solve_cells

if TYPE_CHECKING:
    import polars as pl


class Job(NamedTuple):
    """A table and its format, the file that it goes to, what is wanted of it, the sheet of a workbook.

    With ``markdown`` the table is written in Markdown.
    """

    source: str
    kind: str
    target: str
    force: bool
    wanted: Wanted
    sheet: str | None = None
    markdown: bool = False


def run_batch(job: Job, tally: TableTally) -> list[str]:
    """Solve a table of scenes. Returns sentences on how it was read. Raises OSError, Unreadable."""
    check_polars()
    # As polars is imported, it takes Ctrl-C: a pipe would be waited for, and an interrupt raised twice.
    signal.signal(signal.SIGINT, signal.getsignal(signal.SIGINT))
    how: list[str] = []
    if job.target == STDOUT and _is_stdout(Path(job.source)):
        raise SceneError("output", STDOUT, "is the input, which would grow without end; name another file")
    with ExitStack() as stack:
        try:
            source, how = opened_table(job.source, job.sheet, stack)
            target: IO[bytes] | Stdout = Stdout()
            if job.target != STDOUT:
                beside = stack.enter_context(written_beside(Path(job.target), job.force))
                target = stack.enter_context(beside.open("wb"))
            solve = {"parquet": _solve_parquet, "ndjson": _solve_ndjson}.get(job.kind, _solve_csv)
            remarks = solve(job, source, target, tally)
            target.flush()
        except Unreadable as error:
            after = f" (after {counted(tally.rows, 'row')})" if tally.rows else ""
            why = "; ".join([f"{error}{after}", *how])
            error.args = (why,)
            raise
    return [*(f"read: {remark}." for remark in how), *remarks]


def _is_stdout(path: Path) -> bool:
    """Decide whether a file is standard output, as in atwood batch a.csv >> a.csv."""
    with suppress(OSError, ValueError):  # there is no such file, or stdout is none
        return path.is_file() and os.path.samestat(path.stat(), os.fstat(sys.stdout.fileno()))
    return False


def _watched(pieces: Iterator[Piece], job: Job, source: IO[bytes]) -> AbstractContextManager[Iterator[Piece]]:
    """Show how far it is while pieces pass, unless results go to a terminal."""
    if job.target == STDOUT and sys.stdout.isatty():
        return nullcontext(pieces)
    is_known = not (is_stream(job.source) or is_packed(job.source) or isinstance(source, BytesIO))
    size = os.fstat(source.fileno()).st_size if is_known else None
    return progress(pieces, size, lambda piece: piece.size, lambda piece: len(piece.texts))


def _solve_csv(job: Job, source: IO[bytes], target: IO[bytes] | Stdout, tally: TableTally) -> list[str]:
    """Solve rows of cells: results follow with the separator and the decimal mark of the table."""
    wanted = job.wanted
    known = partial(recognised, vocabulary=VOCABULARY, named=wanted.naming.named)
    table = Csv(blocks_of(source), known, wanted.naming)
    columns = read_columns(table.begin, wanted)
    pieces = table.pieces([*columns.headings, *columns.label])
    first = [*islice(pieces, 1)]
    in_first = ((piece.cells.iter_rows(), range(len(columns.headings))) for piece in first)
    columns = columns._replace(comma=any(decimal_commas_in(*cells, table.separator) for cells in in_first))
    units = _units(wanted) if job.markdown else {}
    names = [f"{x} ({units[x]})" if x in units else x for x in wanted.columns]
    rows = BytesIO() if job.markdown else target
    rows.write(f"{table.separator.join([table.header, *names])}{table.line_end}".encode())
    with _watched(chain(first, pieces), job, source) as watched:
        for piece in watched:
            results = solve_cells(piece.cells, columns, wanted, tally, piece.errors)
            rows.write(_csv(piece, results, table, columns.comma, wanted.digits))
            rows.flush()
    if isinstance(rows, BytesIO):
        text = StringIO(rows.getvalue().decode("utf-8-sig"), newline="")
        lines = markdown_table(csv.reader(text, delimiter=table.separator))
        target.write("".join(f"{line}\n" for line in lines).encode())
    return _remarks(columns, wanted, table)


def _csv(piece: Piece, results: "pl.DataFrame", table: Csv, comma: bool, digits: int | None) -> memoryview:
    """Return records with their results, which have trailing zeros if they are rounded to ``digits``."""
    import polars as pl

    error, mark = pl.col(ERROR), table.separator
    quoted = '"' + error.str.replace_all('"', '""', literal=True) + '"'
    special = error.str.contains(f'[{mark}"\r\n]')
    rows = results.with_columns(pl.when(special).then(quoted).otherwise(error).alias(ERROR))
    if digits:
        number, round_ = pl.selectors.float(), to_digits(digits)
        texts = number.map_elements(lambda x: format_number(round_(Decimal(x))), pl.String)
        rows = rows.with_columns(texts.str.replace(".", "," if comma else ".", literal=True))
    pl.DataFrame([piece.texts.alias("")]).hstack(rows).write_csv(
        buffer := BytesIO(),
        include_header=False,
        separator=mark,
        quote_style="never",
        line_terminator=table.line_end,
        decimal_comma=comma,
    )
    return buffer.getbuffer()


def _solve_ndjson(job: Job, source: IO[bytes], target: IO[bytes] | Stdout, tally: TableTally) -> list[str]:
    """Solve lines, each of which is an object: results become its last members."""
    columns, wanted = ReadColumns([]), job.wanted
    if wanted.naming.words:
        raise SceneError("columns", None, "takes columns in their order; those of NDJSON have names")

    def headings(keys: Sequence[str]) -> Sequence[Heading]:
        nonlocal columns
        columns = read_columns(Sheet(keys, ()), wanted, whole=False)
        return [*columns.headings, *columns.label]

    with _watched(read_ndjson(blocks_of(source), headings, wanted.columns), job, source) as watched:
        for piece in watched:
            target.write(_ndjson(piece, solve_cells(piece.cells, columns, wanted, tally, piece.errors)))
            target.flush()
    keys = [*(heading.column for heading in columns.headings if heading.place >= 0), *columns.not_read]
    known = {*map(without_blanks, keys)}  # any line may have what --column names
    if absent := [column for column in wanted.naming.named if without_blanks(column) not in known]:
        raise Unreadable(f"there is no column {listed(absent[:1])}; there are {listed(keys)}")
    return _remarks(columns, wanted)


def _ndjson(piece: Piece, results: "pl.DataFrame") -> memoryview:
    """Return objects, each with its results as its last members."""
    import polars as pl

    line, members = pl.col("line"), pl.struct(results.columns).struct.json_encode().str.slice(1)
    comma = pl.when(line.str.contains(r"^\{\s*\}$")).then(pl.lit("")).otherwise(pl.lit(","))
    lines = results.with_columns(line=piece.texts).select(line.str.strip_suffix("}") + comma + members)
    lines.write_csv(buffer := BytesIO(), include_header=False, quote_style="never")
    return buffer.getbuffer()


def _solve_parquet(job: Job, source: IO[bytes], target: IO[bytes] | Stdout, tally: TableTally) -> list[str]:
    """Solve Parquet, whose columns keep their types. Raises Unreadable, also for a file that is damaged.

    A thread writes while this one waits, as polars would not hear Ctrl-C.
    """
    import polars as pl
    from polars.io.plugins import register_io_source

    # Parquet is not read from front to back, nor written so: a stream goes through memory.
    if is_stream(job.source) or is_packed(job.source):
        source = BytesIO(b"".join(blocks_of(source)))
    whole, stopped = BytesIO(), Event()
    file = whole if isinstance(target, Stdout) or is_stream(job.target) else target
    with _reading():
        table = pl.scan_parquet(source)
        schema = table.collect_schema()
        total = int(table.select(pl.len()).collect().item())
        head = table.head(ROWS_SHOWN).collect()
        # Values of other types say nothing of an input, and Python may have none that are so large.
        texts = (x.to_list() if x.dtype.is_numeric() or x.dtype == pl.String else [""] * len(x) for x in head)
        first = [[*map(str, row)] for row in zip(*texts, strict=True)]
        columns = read_columns(Sheet(schema.names(), first), job.wanted)
        head = with_results(pl.DataFrame(schema=schema), columns, job.wanted)
        parts = table.collect_batches(maintain_order=True)
        with progress(parts, total, pl.DataFrame.__len__, pl.DataFrame.__len__) as watched:

            def solved(*_: object) -> "Iterator[pl.DataFrame]":
                for part in takewhile(lambda _: not stopped.is_set(), watched):
                    yield with_results(part, columns, job.wanted, tally)

            table = register_io_source(solved, schema=head.schema)
            with ThreadPoolExecutor(1) as writer:
                try:
                    writer.submit(table.sink_parquet, file, compression="snappy").result()
                finally:
                    stopped.set()
    if tally.rows != total:
        raise Unreadable(f"it is damaged: it should have {counted(total, 'row')}")
    target.write(whole.getbuffer())
    return _remarks(columns, job.wanted)


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


def _remarks(columns: ReadColumns, wanted: Wanted, table: Csv | None = None) -> list[str]:
    """Return sentences on how a table was read, if not as usual, and on the units of results then."""
    headings = [heading for heading in columns.headings if heading.place >= 0]
    above = [ABOVE] if table and table.has_titles else []
    how = [*table.remarks, *above] if table else []
    remarks = read_as(headings, table.separator if table else "", columns.comma, how)
    units = _units(wanted)
    if units and any(heading.read.size != 1 or heading.read.terms for heading in headings):
        remarks.append(f"results: {', '.join(f'{x} in {unit}' for x, unit in units.items())}.")
    if columns.not_read:
        remarks.append(f"not read: {', '.join(columns.not_read)}.")
    return remarks


def _units(wanted: Wanted) -> dict[str, str]:
    """Return the units of results, by their names."""
    return {x: unit for x in wanted.names if x in QUANTITIES and (unit := QUANTITIES[x].unit)}
