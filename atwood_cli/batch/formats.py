"""Tables of scenes, read in pieces so that memory is bounded (extra ``batch``): the formats, and CSV.

The cells of CSV, TSV and NDJSON keep their text, and the columns of Parquet their types.
"""

import os
import re
import sys
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from importlib import import_module
from pathlib import Path
from select import select
from time import monotonic
from typing import IO, TYPE_CHECKING, Any, NamedTuple, NoReturn

from ..files import FORMATS, LONGEST_NAME, STREAM, Unreadable
from ..model.scene import SceneError
from ..model.units import counted, in_quotes, shortened
from .csv_quotes import checked, first_end, last_end, split, widths
from .parquet import PIECE_CELLS, PIECE_ROWS

if TYPE_CHECKING:
    import polars as pl

SUFFIXES = {f".{kind}": kind for kind in FORMATS} | {".jsonl": "ndjson"}
SEPARATORS = {"csv": ",", "tsv": "\t"}
PARTED_BY = {",": "commas", "\t": "tabs", ";": "semicolons"}
PIECE_BYTES = 3 << 20
"""The bytes of text that are read at a time; a piece takes several times as much memory."""
MOST_COLUMNS = 1024
"""Each column of a piece takes a kilobyte and some microseconds, however few its rows."""
LONGEST_RECORD = 1 << 20
"""Bytes. A quotation mark that is never closed must not make the whole file one record."""
FOREIGN = {
    rb"\x1f\x8b|BZh|\xfd7zXZ|\x28\xb5\x2f\xfd": "compressed; unpack it first",
    rb"PK\x03\x04|\xd0\xcf\x11\xe0": "a workbook (.xlsx, .xls), or an archive; save the sheet as CSV",
    rb"\xff\xfe|\xfe\xff|.?\0": "in UTF-16 or UTF-32; save it as UTF-8",
    rb"PAR1": "Parquet; batch reads it with --from parquet, and fit reads CSV",
    rb"\[[{\n]": "a JSON array; write an object a line, and give --from ndjson to batch",
}
"""How files of other kinds begin, what they are, and what to do."""
JSON_FOR_CSV = {rb'\{"': "NDJSON; batch reads it with --from ndjson, and fit reads CSV"}
PACKED = {".gz": "gzip", ".bz2": "bz2", ".xz": "lzma", ".zst": "compression.zstd"}
"""The modules that read compressed files, by suffix; that of .zst came with Python 3.14."""
MOMENT = 0.05
"""Seconds in which what a pipe brings is taken together."""
Inputs = Callable[[Sequence[str]], Sequence[str]]
"""A function that picks the inputs among columns."""


class Piece(NamedTuple):
    """Some rows of a table.

    ``columns`` are those met so far, and ``size`` is how much of the input the piece is, in bytes (rows of
    Parquet). ``lines`` are rows of NDJSON that are to be written as they came: the frame then has the columns
    of inputs only. ``errors`` are those of rows that cannot be read. Where a piece is ``bare``, no cell has a
    quotation mark or needs one.
    """

    columns: Sequence[str]
    frame: "pl.DataFrame"
    size: int
    errors: Mapping[int, str] = {}
    separator: str = ""
    lines: Sequence[str] = ()
    bare: bool = False


def read_format(option: str, given: str | None, path: str) -> str:
    """The format named, or that of the suffix, which in a compressed input stands before another; CSV for a
    stream, a pipe or a device. Raises SceneError.
    """
    if given is not None:
        if given not in FORMATS:
            raise SceneError(option, given, f"is no format; there are {', '.join(FORMATS)}")
        return given
    name = Path(path)
    if option == "from" and is_packed(path):
        name = name.with_suffix("")
    if suffix := SUFFIXES.get(name.suffix.lower()):
        return suffix
    if is_stream(path):
        return "csv"
    raise SceneError(option, None, f"is needed: {in_quotes(path)} ends in none of {', '.join(SUFFIXES)}")


def is_stream(path: str) -> bool:
    """Whether the path is that of stdin, stdout, a pipe or a device, not of a file."""
    return path == STREAM or (os.path.exists(path) and not (os.path.isfile(path) or os.path.isdir(path)))


def is_packed(path: str) -> bool:
    """Whether a file is compressed, by its suffix."""
    return Path(path).suffix.lower() in PACKED


def opened(source: str, stack: ExitStack) -> IO[bytes]:
    """The file of that name, unpacked if it is compressed, or stdin. Raises Unreadable."""
    if source == STREAM:
        if sys.stdin is None:
            raise Unreadable("it is closed")
        return sys.stdin.buffer
    suffix = Path(source).suffix.lower()
    try:
        opener: Any = import_module(PACKED[suffix]).open if suffix in PACKED else open
        file: IO[bytes] = stack.enter_context(opener(source, "rb"))
        return file
    except ImportError:
        raise Unreadable(f"this Python cannot unpack {suffix} (3.14 can); unpack it first") from None
    except OSError as error:
        raise Unreadable(error.strerror) from None


def cannot_read(source: str, why: Unreadable) -> OSError:
    """The error for a file, or stdin, that is no table."""
    return OSError(f"cannot read {'stdin' if source == STREAM else shortened(source, LONGEST_NAME)}: {why}")


def blocks_of(file: IO[bytes]) -> Iterator[bytes]:
    """The bytes of a file, in blocks. Raises Unreadable."""
    with _reading():
        while block := file.read(PIECE_BYTES):
            yield block


def blocks_as_they_come(file: Any) -> Iterator[bytes]:
    """The bytes of a pipe, in blocks of what it brings within a moment. Raises Unreadable."""
    with _reading():
        while block := file.read1(PIECE_BYTES):
            end = monotonic() + MOMENT
            while len(block) < PIECE_BYTES and _has_more(file, end - monotonic()):
                if not (more := file.read1(PIECE_BYTES)):
                    break
                block += more
            yield block


def _has_more(pipe: IO[bytes], seconds: float) -> bool:
    """Whether a pipe brings something within some seconds; no where the system cannot tell, as on Windows."""
    with suppress(OSError):
        return bool(select([pipe], [], [], max(0, seconds))[0])
    return False


@contextmanager
def _reading() -> Iterator[None]:
    """Raises Unreadable for whatever the modules that unpack make of damaged files."""
    try:
        yield
    except Exception as error:  # each has one of its own
        said = getattr(error, "strerror", None) or str(error)
        raise Unreadable(said) from None


def check_count(columns: Sequence[str]) -> None:
    if len(columns) > MOST_COLUMNS:
        raise Unreadable(f"it has more than {MOST_COLUMNS} columns, the most taken")


def check_distinct(columns: Sequence[str]) -> None:
    for name, times in Counter(columns).items():
        if times > 1:
            unnamed = f"{times} columns have no heading; name them, or delete them"
            raise Unreadable(f"column {in_quotes(name)} is there {times} times" if name else unnamed)


# Text


def records(blocks: Iterable[bytes], quoted: bool) -> Iterator[tuple[bytes, int, int]]:
    """Blocks of text in pieces that end where a record ends, each with its first line and its line ends.

    Line ends within quotation marks do not count where records may be ``quoted``. Raises Unreadable.
    """
    rest, line = b"", 1
    for block in blocks:
        if line == 1 and not rest:
            block = block.removeprefix(b"\xef\xbb\xbf")
            for start, kind in (FOREIGN | JSON_FOR_CSV if quoted else FOREIGN).items():
                if re.match(start, block, re.DOTALL):
                    raise Unreadable(f"it is {kind}")
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


def decoded(text: bytes, line: int) -> str:
    """The text, which begins in that line of the file. Raises Unreadable."""
    try:
        return text.decode()
    except UnicodeDecodeError as error:
        line += text.count(b"\n", 0, error.start)
        byte = text[error.start]
        raise Unreadable(f"line {line} is not UTF-8: byte 0x{byte:02x}; save it as UTF-8") from None


# CSV


def rows_of_csv(
    file: IO[bytes], usual: str, inputs: Inputs
) -> Iterator[tuple[list[str], str, bytes, int, int]]:
    """The columns, the separator and some rows; how many bytes and line ends of the file these are."""
    header: list[str] = []
    separator = usual
    for text, line, lines in records(blocks_of(file), quoted=True):
        rows = text
        if not header:
            rows = text.lstrip(b"\r\n")
            if not rows:
                continue
            end = first_end(rows)
            header, separator = _header(rows[:end], line + lines - rows.count(b"\n"), usual, inputs)
            rows = rows[end:]
            line += lines - rows.count(b"\n")
        yield header, separator, checked(rows, separator, line), len(text), lines
    if not header:
        raise Unreadable("it is empty")


def _header(row: bytes, line: int, usual: str, inputs: Inputs) -> tuple[list[str], str]:
    """The columns, by the separator that makes most inputs, or else most cells, or else is usual."""
    if row.count(b'"') % 2:
        raise Unreadable("the header ends within quotation marks: one is left open")
    if b"\r" in row.rstrip(b"\r\n"):
        raise Unreadable("its lines end in carriage returns alone; save it with line feeds")
    text = decoded(row, line)

    def score(separator: str) -> tuple[int, int]:
        try:
            checked(row, separator, line)
        except Unreadable:
            return 0, 0
        return len(inputs(split(text, separator))), len(split(text, separator))

    separator = max((usual, *PARTED_BY), key=score)
    checked(row, separator, line)
    header = split(text, separator)
    check_count(header)
    return header, separator


def read_csv(file: IO[bytes], usual: str, inputs: Inputs) -> Iterator[Piece]:
    done, line = 0, 1
    for header, separator, rows, size, lines in rows_of_csv(file, usual, inputs):
        check_distinct(header)
        line += lines
        try:
            frame, errors = _parsed(rows, header, separator, done)
        except Unreadable:
            decoded(rows, line - rows.count(b"\n"))  # polars does not say where it is not UTF-8
            raise
        done += frame.height
        most = min(PIECE_ROWS, PIECE_CELLS // len(header))
        for start in range(0, max(1, frame.height), most):
            part = frame[start : start + most]
            its = {row - start: why for row, why in errors.items() if 0 <= row - start < most}
            yield Piece(header, part, size, its, separator, bare=b'"' not in rows)
            size = 0


def _parsed(
    rows: bytes, header: Sequence[str], separator: str, done: int
) -> "tuple[pl.DataFrame, dict[int, str]]":
    """The rows as a frame, and the errors of those with too few cells. Raises Unreadable."""
    import polars as pl

    width, mark, why = len(header), separator.encode(), ""
    # Numbers stand in for the names: polars drops an empty one.
    names = separator.join(map(str, range(width))).encode() + b"\n"
    try:
        frame = pl.read_csv(names + rows, separator=separator, infer_schema=False, new_columns=header)
        # Short rows and blank lines end in an empty cell.
        if not frame[:, -1].null_count():
            return frame, {}
        if b'"' not in rows and rows.count(mark) == (width - 1) * frame.height:
            return frame, {}
    except pl.exceptions.PolarsError as error:
        why = shortened(str(error).splitlines()[0], LONGEST_NAME)
    lines = widths(rows, separator)
    counts = [cells for cells in lines if cells]
    for number, cells in enumerate(counts, done + 1):
        if cells > width:
            refuse_long(number, cells, width, separator)
    if why:
        raise Unreadable(why)
    if 0 < lines[-1] < width:  # what follows the last line end could be read as another scene
        stops = f"stops after {lines[-1]} of {width} cells, without a line end: it is truncated"
        raise Unreadable(f"row {done + len(counts)}, the last, {stops}")
    frame = frame.filter(pl.Series(lines[: frame.height], dtype=pl.Int64) > 0)
    return frame, {
        row: f"the row has {counted(cells, 'cell')}, and the header {width}"
        for row, cells in enumerate(counts)
        if cells < width
    }


def refuse_long(number: int, cells: int, width: int, separator: str) -> NoReturn:
    """Refuse a row of more cells than there are columns."""
    how = "; is there a decimal comma (write a point), or one at its end?" if separator == "," else ""
    if width == 1:
        how = "; the headings must come first, without lines above them"
    raise Unreadable(f"row {number} has {cells} cells, and the header {width}{how}")
