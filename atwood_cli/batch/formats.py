"""Tables in pieces, so that memory is bounded: CSV, TSV, NDJSON and Parquet, by polars (extra ``batch``).

Cells of CSV and NDJSON stay the text they were, the columns of Parquet keep their types.
"""

import csv
import json
import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from functools import partial
from io import BytesIO, StringIO
from itertools import chain
from pathlib import Path
from typing import IO, TYPE_CHECKING, NamedTuple, NoReturn

from ..files import STREAM
from ..model.scene import SceneError

if TYPE_CHECKING:
    import polars as pl

FORMATS = ("csv", "tsv", "ndjson", "parquet")
SUFFIXES = {f".{kind}": kind for kind in FORMATS} | {".jsonl": "ndjson"}
SEPARATORS = {"csv": ",", "tsv": "\t"}
PARTED_BY = {",": "commas", "\t": "tabs", ";": "semicolons"}
PIECE_BYTES, PIECE_ROWS = 1 << 21, 1 << 16
LONGEST_RECORD = 1 << 26
"""Bytes: a quotation mark that is never closed must not make one record of the whole file."""


class Unreadable(Exception):
    """What was given is no table; the message says why."""


Inputs = Callable[[Sequence[str]], Sequence[str]]
"""Which of some columns are inputs."""


class Piece(NamedTuple):
    """Some rows of a table as a frame, the columns met so far, and how much of the input it is.

    ``size`` is in bytes, or in rows of Parquet. ``lines`` are rows of NDJSON as they came; the frame has then
    only the columns of inputs. ``short`` says of rows that lack cells how many they have, and ``separator``
    what parts the cells of CSV.
    """

    columns: Sequence[str]
    frame: "pl.DataFrame"
    size: int
    lines: Sequence[str] = ()
    short: Mapping[int, int] = {}
    separator: str = ""


def read_format(option: str, given: str | None, path: str) -> str:
    """The format named, or that of the suffix; CSV for a stream, a pipe or a device. Raises SceneError."""
    if given is not None:
        if given not in FORMATS:
            raise SceneError(option, given, f"is no format; there are {', '.join(FORMATS)}")
        return given
    if suffix := SUFFIXES.get(Path(path).suffix.lower()):
        return suffix
    if path == STREAM or is_stream(path):
        return "csv"
    raise SceneError(option, None, f"is needed: {path!r} ends in none of {', '.join(SUFFIXES)}")


def is_stream(path: str) -> bool:
    """Whether the path is that of a pipe or a device, not of a file."""
    return os.path.exists(path) and not (os.path.isfile(path) or os.path.isdir(path))


def read(kind: str, file: IO[bytes], inputs: Inputs, as_lines: bool) -> Iterator[Piece]:
    """The pieces of a table, at least one, which may have no rows. Raises Unreadable.

    With ``as_lines`` NDJSON comes as lines, and a frame of the inputs.
    """
    if kind == "parquet":
        return _read_parquet(file)
    if kind == "ndjson":
        return _read_ndjson(file, inputs if as_lines else None)
    return _read_csv(file, SEPARATORS[kind], inputs)


def _records(file: IO[bytes], quoted: bool) -> Iterator[bytes]:
    """A file in pieces that end where a record ends, without blank lines at its end."""
    rest = b""
    while block := file.read(PIECE_BYTES):
        rest += block
        whole = rest[: _last_end(rest, quoted)].rstrip(b"\r\n")
        if whole:
            end = rest.index(b"\n", len(whole)) + 1
            yield rest[:end]
            rest = rest[end:]
        elif len(rest) > LONGEST_RECORD:
            raise Unreadable(
                f"a row is longer than {LONGEST_RECORD >> 20} MB; is a quotation mark left open?"
            )
    if rest.strip(b"\r\n"):
        yield rest


def _last_end(text: bytes, quoted: bool) -> int:
    """Behind the last line end that is not within quotation marks."""
    end = text.rfind(b"\n") + 1
    marks = text.count(b'"', 0, end) if quoted else 0
    while marks % 2:
        before = text.rfind(b"\n", 0, text.rfind(b'"', 0, end)) + 1
        marks -= text.count(b'"', before, end)
        end = before
    return end


def _first_end(text: bytes) -> int:
    """Behind the first line end that is not within quotation marks."""
    end, marks = 0, 1
    while marks % 2 and end < len(text):
        end = text.find(b"\n", end) + 1 or len(text)
        marks = text.count(b'"', 0, end)
    return end


def _read_csv(file: IO[bytes], usual: str, inputs: Inputs) -> Iterator[Piece]:
    import polars as pl

    header: list[str] = []
    names, done, separator = b"", 0, usual
    for text in _records(file, quoted=True):
        rows = text
        if not header:
            rows = text.removeprefix(b"\xef\xbb\xbf").lstrip(b"\r\n")
            if not rows:  # but a byte order mark
                continue
            end = _first_end(rows)
            if rows.count(b'"', 0, end) % 2:
                raise Unreadable("the header ends within quotation marks: one is left open")
            if b"\r" in rows[:end].rstrip(b"\r\n"):
                raise Unreadable("its lines end in carriage returns alone; save it with line feeds")
            line = _decode(rows[:end], lambda _: "the header")
            headers = {mark: next(_cells(line, mark)) for mark in (usual, *PARTED_BY)}
            separator = max(
                headers, key=lambda mark: len(inputs(headers[mark]))
            )  # the usual one, if it will do
            header = headers[separator]
            # Stand-ins, as polars renames what is there twice and drops what is empty.
            names = separator.join(map(str, range(len(header)))).encode() + b"\n"
            rows = rows[end:]
        try:
            frame = pl.read_csv(names + rows, separator=separator, infer_schema=False)
        except pl.exceptions.PolarsError as error:
            _refuse_csv(error, rows, len(header), done, separator)
        if not rows.endswith(b"\n") and rows:
            _check_last(rows, len(header), done + frame.height, separator)
        frame.columns = _distinct(header)
        frame, short = _without_blank_lines(frame, rows, separator)
        done += frame.height
        for start in range(0, max(frame.height, 1), PIECE_ROWS):
            here = {row - start: cells for row, cells in short.items() if 0 <= row - start < PIECE_ROWS}
            part, size = frame.slice(start, PIECE_ROWS), 0 if start else len(text)
            yield Piece(header, part, size, short=here, separator=separator)
    if not header:
        raise Unreadable("it is empty")


def _without_blank_lines(
    frame: "pl.DataFrame", rows: bytes, separator: str
) -> "tuple[pl.DataFrame, dict[int, int]]":
    """The frame without the rows that polars makes of blank lines, and by row how many cells a short one has.

    Either ends in an empty cell, so that most tables need no second look.
    """
    import polars as pl

    mark = separator.encode()
    if not frame[:, -1].null_count() or (
        b'"' not in rows and rows.count(mark) == (frame.width - 1) * frame.height
    ):
        return frame, {}
    lines = re.sub(b'"[^"]*"', b'""', rows).split(b"\n")[: frame.height]
    full = [bool(line.strip()) or mark in line for line in lines]
    counts = [line.count(mark) + 1 for line, is_full in zip(lines, full, strict=True) if is_full]
    short = {row: cells for row, cells in enumerate(counts) if cells < frame.width}
    return frame if all(full) else frame.filter(pl.Series(full)), short


def _distinct(names: list[str]) -> list[str]:
    """The names, or where one is there twice, which `run` refuses later, numbers in their place."""
    return names if len(set(names)) == len(names) else [str(i) for i in range(len(names))]


def _cells(text: str, separator: str) -> Iterator[list[str]]:
    return csv.reader(StringIO(text, newline=""), delimiter=separator)


def _count(text: bytes, separator: str) -> int:
    """How many rows the text begins."""
    return sum(1 for cells in _cells(f"{text.decode(errors='replace')}.", separator) if cells)


def _decode(text: bytes, row: Callable[[int], str]) -> str:
    try:
        return text.decode()
    except UnicodeDecodeError as error:
        raise Unreadable(
            f"{row(error.start)} is not UTF-8: byte 0x{text[error.start]:02x}; save it as UTF-8"
        ) from None


def _refuse_csv(error: Exception, rows: bytes, width: int, done: int, separator: str) -> NoReturn:
    """Say in which row, and why, polars could not read it. Raises Unreadable."""

    def row(at: int) -> str:
        return f"row {done + _count(rows[:at], separator)}"

    text = _decode(rows, row)
    mark = rf'[^{separator}\n"]"[^{separator}\r\n"]'
    if stray := re.search(mark, text):
        before = text[: stray.start() + 1].encode()
        raise Unreadable(f'{row(len(before))} has a quotation mark out of place; write it "like ""this"""')
    if rows.count(b'"') % 2:
        raise Unreadable("it ends within quotation marks: it is truncated, or one is left open")
    for number, cells in enumerate(filter(None, _cells(text, separator)), done + 1):
        if len(cells) > width:
            how = "; is there a decimal comma? write a point" if separator == "," else ""
            raise Unreadable(f"row {number} has {len(cells)} cells, and the header {width}{how}")
    raise Unreadable(str(error).splitlines()[0])


def _check_last(rows: bytes, width: int, number: int, separator: str) -> None:
    """Refuse a last row that stops short: cut off, it could be read as another scene."""
    *_, cells = _cells(rows[_last_end(rows, quoted=True) :].decode(), separator)
    if len(cells) < width and "".join(cells).strip():
        raise Unreadable(
            f"row {number}, the last, stops after {len(cells)} of {width} cells, without a line end:"
            " it is truncated"
        )


def _read_ndjson(file: IO[bytes], inputs: Inputs | None) -> Iterator[Piece]:
    import polars as pl

    columns: dict[str, None] = {}
    done = 0
    for text in _records(file, quoted=False):
        lines = [
            line for line in map(str.strip, _decode(text, partial(_row, text, done)).split("\n")) if line
        ]
        rows = [_object(line, number) for number, line in enumerate(lines, done + 1)]
        for number, object_ in enumerate(rows, done + 1):
            if not object_.keys() <= columns.keys():
                if done and inputs is None:
                    new = next(name for name in object_ if name not in columns)
                    raise Unreadable(
                        f"row {number} has {new!r}, for which there is no column by now; give --to ndjson"
                    )
                columns |= dict.fromkeys(object_)
        wanted = list(columns) if inputs is None else inputs(list(columns))
        cells = {name: list(map(partial(_cell, name), rows, lines)) for name in wanted}
        frame = pl.DataFrame(cells, schema=dict.fromkeys(wanted, pl.String))
        done += len(rows)
        yield Piece(list(columns), frame, len(text), [] if inputs is None else lines)
    if not done:
        raise Unreadable("it is empty")


def _row(text: bytes, done: int, at: int) -> str:
    return f"row {done + sum(1 for line in (text[:at] + b'.').splitlines() if line.strip())}"


def _object(line: str, number: int) -> Mapping[str, object]:
    """A row of NDJSON, numbers as they are written."""
    try:
        row = _DECODER.decode(line)
        why = "it is no object"
    except RecursionError:
        row, why = None, "it is nested too deeply"
    except json.JSONDecodeError as error:
        row, why = None, f"{error.msg.removesuffix(' at')} at character {error.colno}"
    except ValueError as error:
        row, why = None, str(error)
    if not isinstance(row, dict):
        raise Unreadable(f"row {number} is not a line of NDJSON: {why}")
    return row


def _members(pairs: Sequence[tuple[str, object]]) -> dict[str, object]:
    row = dict(pairs)
    if len(row) < len(pairs):
        names = [name for name, _ in pairs]
        raise ValueError(f"{next(name for name in names if names.count(name) > 1)!r} is there twice")
    return row


def _refuse(word: str) -> NoReturn:
    raise ValueError(f"{word} is no number in JSON")


_DECODER = json.JSONDecoder(
    object_pairs_hook=_members, parse_float=str, parse_int=str, parse_constant=_refuse
)


def _cell(name: str, row: Mapping[str, object], line: str) -> str | None:
    """A value as the text of a cell; what is neither text nor number stays JSON."""
    value = row.get(name)
    if value is None:
        return None
    text = value if isinstance(value, str) else json.dumps(json.loads(line)[name], ensure_ascii=False)
    return text if text.isascii() else text.encode(errors="replace").decode()


def _read_parquet(file: IO[bytes]) -> Iterator[Piece]:
    import polars as pl

    try:
        table = pl.scan_parquet(file.name, glob=False)
        columns = table.collect_schema().names()
        yield Piece(columns, table.head(0).collect(), 0)
        for frame in table.collect_batches(chunk_size=PIECE_ROWS):
            yield Piece(columns, frame, frame.height)
    except pl.exceptions.PolarsError as error:
        raise Unreadable(f"it is not Parquet, or truncated: {str(error).splitlines()[0]}") from None


def write(kind: str, file: IO[bytes], solved: Iterable[tuple[Piece, "pl.DataFrame"]]) -> None:
    """Write a table from its pieces, each with the columns to append. Raises OSError."""
    if kind == "parquet":
        _write_parquet(file, (piece.frame.hstack(results) for piece, results in solved))
        return
    solved = _checked(kind, solved)
    if kind == "ndjson":
        for piece, results in solved:
            file.write(_as_ndjson(piece, results))
        return
    encode = partial(_as_csv, SEPARATORS[kind])
    with ThreadPoolExecutor(1) as encoder:  # one that only computes: nothing to wait for on Ctrl-C
        last: Future[memoryview] | None = None
        for piece, results in solved:
            ready, last = last, encoder.submit(encode, piece, results, last is None)
            if ready:
                file.write(ready.result())
        if last:
            file.write(last.result())


def _checked(
    kind: str, solved: Iterable[tuple[Piece, "pl.DataFrame"]]
) -> Iterator[tuple[Piece, "pl.DataFrame"]]:
    """Hand on pieces once it is certain that the format has a place for their columns. Raises OSError."""
    import polars as pl

    for piece, results in solved:
        for name, dtype in piece.frame.schema.items():
            if dtype == pl.Binary or (kind != "ndjson" and dtype.is_nested()):
                raise OSError(
                    f"cannot write column {name!r}, which holds {dtype}, as {kind}; give --to parquet"
                )
        yield piece, results


def _as_csv(separator: str, piece: Piece, results: "pl.DataFrame", first: bool) -> memoryview:
    buffer = BytesIO()
    piece.frame.hstack(results).write_csv(buffer, separator=separator, include_header=first)
    return buffer.getbuffer()


def _as_ndjson(piece: Piece, results: "pl.DataFrame") -> bytes:
    if not piece.lines:
        return piece.frame.hstack(results).write_ndjson().encode()
    ends = results.write_ndjson().rstrip("\n").split("\n")
    return "".join(map(_spliced, piece.lines, ends)).encode()


def _spliced(line: str, end: str) -> str:
    """A JSON object as it came, with the members of a second one behind its own."""
    comma = "," if line[1:-1].strip() else ""
    return f"{line[:-1].rstrip()}{comma}{end[1:]}\n"


def _write_parquet(file: IO[bytes], frames: Iterator["pl.DataFrame"]) -> None:
    from polars.io.plugins import register_io_source

    first, failed = next(frames), []

    def source(*_: object) -> Iterator["pl.DataFrame"]:
        try:
            yield from chain([first], frames)
        except BaseException as error:  # polars would make another one of it
            failed.append(error)

    register_io_source(source, schema=first.schema).sink_parquet(file)
    for error in failed:
        raise error
