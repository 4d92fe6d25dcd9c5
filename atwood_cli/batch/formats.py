"""Tables in pieces, so that memory is bounded: CSV, TSV, NDJSON and Parquet (extra ``batch``).

Cells of CSV and NDJSON stay the text they were, the columns of Parquet keep their types.
"""

import json
import os
import re
import sys
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack
from functools import partial
from io import BytesIO
from pathlib import Path
from typing import IO, TYPE_CHECKING, NamedTuple, NoReturn

from ..files import FORMATS, LONGEST_NAME, STREAM, Stdout, Unreadable
from ..model.scene import SceneError
from ..model.units import in_quotes, shortened
from .parquet import PIECE_CELLS, PIECE_ROWS, read_frames, write_frames
from .quoted import checked, first_end, last_end, portions, split, widths

if TYPE_CHECKING:
    import polars as pl

SUFFIXES = {f".{kind}": kind for kind in FORMATS} | {".jsonl": "ndjson"}
SEPARATORS = {"csv": ",", "tsv": "\t"}
PARTED_BY = {",": "commas", "\t": "tabs", ";": "semicolons"}
PIECE_BYTES = 1 << 21
"""What of a table of text is in memory at a time, some times over."""
MOST_COLUMNS = 1024
"""Each column of a piece takes a kilobyte and some microseconds, whatever is in it."""
LONGEST_RECORD = 1 << 20
"""Bytes: a quotation mark that is never closed must not make one record of the whole file."""


WIDE_TEXT = "in UTF-16 or UTF-32; save it as UTF-8"
FOREIGN = {
    b"\x1f\x8b": "compressed by gzip; unpack it first",
    **dict.fromkeys((b"BZh", b"\xfd7zXZ", b"\x28\xb5\x2f\xfd"), "compressed; unpack it first"),
    b"PK\3\4": "a workbook (.xlsx), or another zip archive; save the sheet as CSV",
    b"\xd0\xcf\x11\xe0": "a workbook (.xls); save the sheet as CSV",
    **dict.fromkeys((b"\xff\xfe", b"\xfe\xff"), WIDE_TEXT),
    b"PAR1": "Parquet; batch reads it with --from parquet, and fit reads CSV",
    **dict.fromkeys((b"[{", b"[\n"), "a JSON array; write an object a line, and give --from ndjson to batch"),
}
"""What a file is that begins so, and what to do: no table of CSV or NDJSON does."""
JSON_FOR_CSV = {b'{"': "NDJSON; batch reads it with --from ndjson, and fit reads CSV"}


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
    if is_stream(path):
        return "csv"
    raise SceneError(option, None, f"is needed: {in_quotes(path)} ends in none of {', '.join(SUFFIXES)}")


def is_stream(path: str) -> bool:
    """Whether the path is that of stdin, stdout, a pipe or a device, not of a file."""
    return path == STREAM or (os.path.exists(path) and not (os.path.isfile(path) or os.path.isdir(path)))


def read(kind: str, file: IO[bytes], inputs: Inputs, as_lines: bool) -> Iterator[Piece]:
    """The pieces of a table, at least one, which may have no rows. Raises Unreadable.

    With ``as_lines`` NDJSON comes as lines, and a frame of the inputs.
    """
    if kind == "parquet":
        return _read_parquet(file)
    if kind == "ndjson":
        return _read_ndjson(file, inputs if as_lines else None)
    return _read_csv(file, SEPARATORS[kind], inputs)


def opened(source: str, stack: ExitStack) -> IO[bytes]:
    """The file of that name, or stdin. Raises Unreadable."""
    if source == STREAM:
        if sys.stdin is None:
            raise Unreadable("it is closed")
        return sys.stdin.buffer
    try:
        return stack.enter_context(open(source, "rb"))
    except OSError as error:
        raise Unreadable(error.strerror) from None


def cannot_read(source: str, why: Unreadable) -> OSError:
    """The error of a file, or of stdin, that is no table."""
    return OSError(f"cannot read {'stdin' if source == STREAM else shortened(source, LONGEST_NAME)}: {why}")


def block_of(file: IO[bytes]) -> bytes:
    """The next bytes of a file, none at its end. Raises Unreadable."""
    try:
        return file.read(PIECE_BYTES)
    except OSError as error:
        raise Unreadable(error.strerror or str(error)) from None


def records(file: IO[bytes], quoted: bool) -> Iterator[tuple[bytes, int, int]]:
    """A file in pieces that end where a record ends, with the line each begins in and its line ends."""
    rest, line = b"", 1
    while block := block_of(file):
        if line == 1 and not rest:
            block = block.removeprefix(b"\xef\xbb\xbf")
            _check_start(block, FOREIGN | JSON_FOR_CSV if quoted else FOREIGN)
        rest += block
        end = last_end(rest) if quoted else rest.rfind(b"\n") + 1
        if end:
            lines = rest.count(b"\n", 0, end)
            yield rest[:end], line, lines
            line += lines
            rest = rest[end:]
        elif len(rest) > LONGEST_RECORD:
            hint = "; is a quotation mark left open?" if quoted else ""
            most = f"{LONGEST_RECORD >> 20} MB, the most taken"
            raise Unreadable(f"the row that begins in line {line} is longer than {most}{hint}")
    if rest.strip(b"\r\n"):
        yield rest, line, rest.count(b"\n")


def _check_start(block: bytes, foreign: Mapping[bytes, str]) -> None:
    """Refuse a file that begins as one of another kind."""
    for start, kind in foreign.items():
        if block.startswith(start):
            raise Unreadable(f"it is {kind}")
    if b"\0" in block[:2]:
        raise Unreadable(f"it is {WIDE_TEXT}")


def _check_count(columns: Collection[str]) -> None:
    if len(columns) > MOST_COLUMNS:
        raise Unreadable(f"it has more than {MOST_COLUMNS} columns, the most taken")


def check_distinct(columns: Sequence[str]) -> None:
    """Refuse columns of the same name."""
    for name, times in Counter(columns).items():
        if times > 1:
            unnamed = f"{times} columns have no heading; name them, or delete them"
            raise Unreadable(f"column {in_quotes(name)} is there {times} times" if name else unnamed)


def rows_of_csv(
    file: IO[bytes], usual: str, inputs: Inputs
) -> Iterator[tuple[list[str], str, bytes, int, int]]:
    """The columns, what parts them, rows as a parser takes them; how much of the file it is, and lines."""
    header: list[str] = []
    separator = usual
    for text, line, lines in records(file, quoted=True):
        rows, before = text, 0
        if not header:
            rows = text.lstrip(b"\r\n")
            if not rows:
                continue
            end, before = first_end(rows), lines - rows.count(b"\n")
            header, separator = _header(rows[:end], line + before, usual, inputs)
            before += rows.count(b"\n", 0, end)
            rows = rows[end:]
        yield header, separator, checked(rows, separator, line + before), len(text), lines
    if not header:
        raise Unreadable("it is empty")


def _read_csv(file: IO[bytes], usual: str, inputs: Inputs) -> Iterator[Piece]:
    import polars as pl

    done = 0
    for header, separator, rows, size, lines in rows_of_csv(file, usual, inputs):
        # Stand-ins, as polars renames what is there twice and drops what is empty.
        names = separator.join(map(str, range(len(header)))).encode() + b"\n"
        most = PIECE_CELLS // len(header)
        for part in [rows] if lines <= most else portions(rows, most):
            try:
                frame = pl.read_csv(names + part, separator=separator, infer_schema=False)
            except pl.exceptions.PolarsError as error:
                _refuse_csv(error, part, len(header), done, separator)
            if not part.endswith(b"\n") and part:
                _check_last(part, len(header), done + frame.height, separator)
            frame.columns = _distinct(header)
            frame, short = _without_blank_lines(frame, part, separator)
            done += frame.height
            for start in range(0, max(frame.height, 1), PIECE_ROWS):
                here = {row - start: cells for row, cells in short.items() if 0 <= row - start < PIECE_ROWS}
                yield Piece(header, frame.slice(start, PIECE_ROWS), size, short=here, separator=separator)
                size = 0


def _header(row: bytes, line: int, usual: str, inputs: Inputs) -> tuple[list[str], str]:
    """The columns, and what parts them: what makes most inputs, or most cells, or the usual separator."""
    if row.count(b'"') % 2:
        raise Unreadable("the header ends within quotation marks: one is left open")
    if b"\r" in row.rstrip(b"\r\n"):
        raise Unreadable("its lines end in carriage returns alone; save it with line feeds")
    text = _decode(row, lambda _: "the header")

    def columns(separator: str) -> list[str]:
        try:
            checked(row, separator, line)
        except Unreadable:
            return []
        return split(text, separator)

    def score(separator: str) -> tuple[int, int]:
        return len(inputs(columns(separator))), len(columns(separator))

    separator = max((usual, *PARTED_BY), key=score)
    checked(row, separator, line)
    header = split(text, separator)
    _check_count(header)
    return header, separator


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
    counts = widths(rows, separator)[: frame.height]
    short = {row: cells for row, cells in enumerate(filter(None, counts)) if cells < frame.width}
    return frame if all(counts) else frame.filter(pl.Series(counts) > 0), short


def _distinct(names: list[str]) -> list[str]:
    """The names, or where one is there twice, which `run` refuses later, numbers in their place."""
    return names if len(set(names)) == len(names) else [str(i) for i in range(len(names))]


def _decode(text: bytes, row: Callable[[int], str]) -> str:
    try:
        return text.decode()
    except UnicodeDecodeError as error:
        raise Unreadable(
            f"{row(error.start)} is not UTF-8: byte 0x{text[error.start]:02x}; save it as UTF-8"
        ) from None


def _refuse_csv(error: Exception, rows: bytes, width: int, done: int, separator: str) -> NoReturn:
    """Say in which row, and why, polars could not read it. Raises Unreadable."""
    _decode(rows, partial(_row_of_csv, rows, done, separator))
    for number, cells in enumerate(filter(None, widths(rows, separator)), done + 1):
        if cells > width:
            refuse_long(number, cells, width, separator)
    raise Unreadable(shortened(str(error).splitlines()[0], LONGEST_NAME))


def _row_of_csv(rows: bytes, done: int, separator: str, at: int) -> str:
    """The row in which a byte is."""
    return f"row {done + sum(map(bool, widths(rows[:at] + b'.', separator)))}"


def refuse_long(number: int, cells: int, width: int, separator: str) -> NoReturn:
    how = "; is there a decimal comma (write a point), or one at its end?" if separator == "," else ""
    if width == 1:
        how = "; the headings must come first, without lines above them"
    raise Unreadable(f"row {number} has {cells} cells, and the header {width}{how}")


def _check_last(rows: bytes, width: int, number: int, separator: str) -> None:
    """Refuse a last row that stops short: cut off, it could be read as another scene."""
    *_, cells = widths(rows, separator)
    if 0 < cells < width:
        raise Unreadable(
            f"row {number}, the last, stops after {cells} of {width} cells, without a line end:"
            " it is truncated"
        )


def _read_ndjson(file: IO[bytes], inputs: Inputs | None) -> Iterator[Piece]:
    import polars as pl

    columns: dict[str, None] = {}
    done = 0
    for lines, size in _lines(file):
        rows = [_object(line, number) for number, line in enumerate(lines, done + 1)]
        for number, object_ in enumerate(rows, done + 1):
            if not object_.keys() <= columns.keys():
                new = [name for name in object_ if name not in columns]
                if inputs is None:
                    _check_keys(new, number, late=done > 0)
                columns |= dict.fromkeys(new)
                _check_count(columns)
        wanted = list(columns) if inputs is None else inputs(list(columns))
        most = max(1, PIECE_CELLS // max(1, len(wanted)))
        for start in range(0, len(rows), most):
            part = slice(start, start + most)
            cells = _columns(wanted, rows[part], lines[part], done + 1, inputs is None)
            frame = pl.DataFrame(cells, schema=dict.fromkeys(wanted, pl.String))
            done += frame.height
            yield Piece(list(columns), frame, size, [] if inputs is None else lines[part])
            size = 0
    if not done:
        raise Unreadable("it is empty")


def _lines(file: IO[bytes]) -> Iterator[tuple[list[str], int]]:
    """Lines that are not blank, as many as may be objects at a time, and how much of the file they are."""
    done = 0
    for text, _, _ in records(file, quoted=False):
        texts = _decode(text, partial(_row, text, done)).split("\n")
        lines = [line for line in map(str.strip, texts) if line]
        done, size = done + len(lines), len(text)
        for start in range(0, len(lines), PIECE_ROWS):
            yield lines[start : start + PIECE_ROWS], size
            size = 0


def _row(text: bytes, done: int, at: int) -> str:
    lines = (text[:at] + b".").split(b"\n")
    return f"row {done + sum(1 for line in lines if line.strip())}"


def _check_keys(names: Sequence[str], number: int, late: bool) -> None:
    """Refuse keys that make no columns of a table other than NDJSON."""
    for name in names:
        if not _is_unicode(name):
            why = f"the key {in_quotes(name)}, which is not Unicode; give --to ndjson"
            raise Unreadable(f"row {number} has {why}")
    if late:
        how = "for which there is no column by now; give --to ndjson"
        raise Unreadable(f"row {number} has {in_quotes(names[0])}, {how}")


def _is_unicode(text: str) -> bool:
    """Whether there is no half of a pair of surrogates in it, which JSON takes."""
    try:
        return text.isascii() or bool(text.encode())
    except UnicodeEncodeError:
        return False


def _columns(
    wanted: Sequence[str], rows: Sequence[Mapping[str, object]], lines: Sequence[str], first: int, all_: bool
) -> dict[str, list[str | None]]:
    """The cells of rows; if they are ``all_``, they must be what they were."""
    columns: dict[str, list[str | None]] = {name: [None] * len(rows) for name in wanted}
    for number, row in enumerate(rows):
        for name, value in row.items():
            if value is None or name not in columns:
                continue
            cell = value if isinstance(value, str) else _typed(lines[number], name)
            if not _is_unicode(cell):
                if all_:
                    why = f"a value of {in_quotes(name)} that is not Unicode; give --to ndjson"
                    raise Unreadable(f"row {first + number} has {why}")
                cell = cell.encode(errors="replace").decode()
            columns[name][number] = cell
    return columns


def _typed(line: str, name: str) -> str:
    """The value of a member of a JSON object, as it is written there."""
    at = line.index("{") + 1
    while True:
        key, at = _next(line, at)
        start = line.index(":", at) + 1
        _, end = _next(line, start)
        if key == name:
            return line[start:end].strip()
        at = line.index(",", end) + 1


def _next(line: str, at: int) -> tuple[object, int]:
    """The JSON value there, behind blanks, and where it ends."""
    start = re.compile("[ \t\r]*").match(line, at)
    return _DECODER.raw_decode(line, start.end() if start else at)


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
        twice = next(name for name in names if names.count(name) > 1)
        raise ValueError(f"{in_quotes(twice)} is there twice")
    return row


def _refuse(word: str) -> NoReturn:
    raise ValueError(f"{word} is no number in JSON")


_DECODER = json.JSONDecoder(
    object_pairs_hook=_members, parse_float=str, parse_int=str, parse_constant=_refuse
)


def _read_parquet(file: IO[bytes]) -> Iterator[Piece]:
    for frame in read_frames(file):
        _check_count(frame.columns)
        yield Piece(frame.columns, frame, frame.height)


def write(kind: str, file: IO[bytes] | Stdout, solved: Iterable[tuple[Piece, "pl.DataFrame"]]) -> None:
    """Write a table from its pieces, each with the columns to append. Raises OSError, PolarsError."""
    checked_ = _checked(kind, solved)
    if kind == "parquet":
        assert not isinstance(file, Stdout)  # which gets it once it is whole
        write_frames(file, (piece.frame.hstack(results) for piece, results in checked_))
        return
    encode = partial(_as_csv, SEPARATORS[kind]) if kind in SEPARATORS else _as_ndjson
    with ThreadPoolExecutor(1) as encoder:  # one that only computes: nothing to wait for on Ctrl-C
        last: Future[bytes | memoryview] | None = None
        for piece, results in checked_:
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
        for name, dtype in piece.frame.schema.items() if kind != "parquet" else ():
            bytes_ = re.search(r"\bBinary\b(?!')", str(dtype))  # not the name of a field
            if bytes_ or (kind != "ndjson" and (dtype.is_nested() or dtype == pl.Duration)):
                what = f"column {in_quotes(name)}, which holds {shortened(str(dtype))},"
                raise OSError(f"cannot write {what} as {kind}; give --to parquet")
            if _has_far_year(piece.frame[name]):
                what = f"column {in_quotes(name)}, which has a date beyond the year ±262000,"
                raise OSError(f"cannot write {what} as {kind}; give --to parquet")
        yield piece, results


def _has_far_year(column: "pl.Series") -> bool:
    """Whether a date is so far (as an infinite one is) that polars cannot write it as text, and panics."""
    import polars as pl

    if column.dtype in (pl.List, pl.Array):
        return _has_far_year(column.explode())
    if column.dtype == pl.Struct:
        return any(map(_has_far_year, column.struct.unnest()))
    return column.dtype in (pl.Date, pl.Datetime) and column.dt.year().null_count() > column.null_count()


def _as_csv(separator: str, piece: Piece, results: "pl.DataFrame", first: bool) -> memoryview:
    buffer = BytesIO()
    piece.frame.hstack(results).write_csv(buffer, separator=separator, include_header=first)
    return buffer.getbuffer()


def _as_ndjson(piece: Piece, results: "pl.DataFrame", _: bool) -> bytes:
    if not piece.lines:
        return piece.frame.hstack(results).write_ndjson().encode()
    ends = results.write_ndjson().rstrip("\n").split("\n")
    return "".join(map(_spliced, piece.lines, ends)).encode()


def _spliced(line: str, end: str) -> str:
    """A JSON object as it came, with the members of a second one behind its own."""
    comma = "," if line[1:-1].strip() else ""
    return f"{line[:-1].rstrip()}{comma}{end[1:]}\n"
