"""Tables of scenes, written piece by piece with their results (extra ``batch``)."""

import re
from collections.abc import Iterable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from io import BytesIO
from typing import IO, TYPE_CHECKING, Any

from ..files import Stdout
from ..model.units import in_quotes, shortened
from .formats import SEPARATORS, Piece
from .parquet import write_frames
from .solving import ERROR

if TYPE_CHECKING:
    import polars as pl


def write(
    kind: str, file: IO[bytes] | Stdout, solved: Iterable[tuple[Piece, "pl.DataFrame"]], at_once: bool
) -> None:
    """Write a table from its pieces, each with the columns to append. Raises OSError, PolarsError.

    ``at_once``, a piece is written before the next is asked for, else while it is made.
    """
    if kind == "parquet":
        assert not isinstance(file, Stdout)  # which gets it once it is whole
        write_frames(file, (piece.frame.hstack(results) for piece, results in solved))
        return
    with ThreadPoolExecutor(1) as encoder:  # one that only computes: nothing to wait for on Ctrl-C
        waiting: list[Future[bytes | memoryview]] = []
        for number, (piece, results) in enumerate(solved):
            waiting.append(encoder.submit(_encoded, kind, piece, results, number == 0))
            if at_once or number:
                file.write(waiting.pop(0).result())
                file.flush()
        for last in waiting:
            file.write(last.result())


def _encoded(kind: str, piece: Piece, results: "pl.DataFrame", first: bool) -> bytes | memoryview:
    """A piece and its results as text, under a header if it is the first. Raises OSError, PolarsError."""
    import polars as pl

    if piece.lines:
        return _spliced(piece.lines, results)
    for column in piece.frame:
        dtype = column.dtype
        has_bytes = re.search(r"\bBinary\b(?!')", str(dtype))  # not the name of a field
        holds = ""
        if has_bytes or (kind != "ndjson" and (dtype.is_nested() or dtype == pl.Duration)):
            holds = shortened(str(dtype))
        elif dtype in (pl.Date, pl.Datetime) and column.dt.year().null_count() > column.null_count():
            holds = "a date beyond the years of polars, -262143 to 262142"
        if holds:
            what = f"column {in_quotes(column.name)}, which holds {holds},"
            raise OSError(f"cannot write {what} as {kind}; give --to parquet")
    frame = piece.frame.hstack(results)
    if kind == "ndjson":
        return _as_ndjson(frame).encode()
    buffer, separator = BytesIO(), SEPARATORS[kind]
    # Whether a cell needs quotation marks is looked for in each, unless it is known.
    no_error = results[ERROR].null_count() == results.height
    bare = piece.bare and piece.separator == separator and no_error and not first
    style: Any = "never" if bare else "necessary"
    frame.write_csv(buffer, separator=separator, include_header=first, quote_style=style)
    return buffer.getbuffer()


def _as_ndjson(frame: "pl.DataFrame") -> str:
    """A frame as NDJSON. JSON has no infinity, and null would be another scene: it is written as text."""
    import polars as pl

    for column in frame.select(pl.selectors.float()):
        infinite = column.is_infinite().fill_null(False)
        if infinite.any():
            as_text = frame.filter(infinite).with_columns(column.filter(infinite).cast(pl.String))
            texts, numbers = (
                iter(_as_ndjson(some).split("\n")) for some in (as_text, frame.filter(~infinite))
            )
            return "".join(f"{next(texts if one else numbers)}\n" for one in infinite)
    return frame.write_ndjson()


def _spliced(lines: Sequence[str], results: "pl.DataFrame") -> bytes | memoryview:
    """JSON objects as they came, each followed by the members of its results."""
    import polars as pl

    line, members = pl.col("line"), pl.struct(results.columns).struct.json_encode().str.slice(1)
    comma = pl.when(line.str.contains(r"^\{\s*\}$")).then(pl.lit("")).otherwise(pl.lit(","))
    start = line.str.strip_suffix("}").str.strip_chars_end()
    table = results.with_columns(line=pl.Series(lines))
    buffer = BytesIO()
    table.select(start + comma + members).write_csv(buffer, include_header=False, quote_style="never")
    return buffer.getbuffer()
