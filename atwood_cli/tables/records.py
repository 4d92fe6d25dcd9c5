"""Tables of text: each record stays as it came, and the cells of its quantities are read beside it.

A record of CSV is a row, which may have several lines. A record of NDJSON is a line. Cells are texts, too.
"""

import csv
import json
from collections import Counter
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from io import StringIO
from typing import TYPE_CHECKING, NamedTuple

from ..numbers.text import counted, in_quotes
from . import sources
from .headings import SEPARATORS, Heading, best_header
from .sources import LONGEST_RECORD, TOO_LONG, Unreadable, whole_lines

if TYPE_CHECKING:
    import polars as pl

MOST_LINES = 50
"""The most lines of a cell: a note has fewer, and a quotation mark that is left open makes more."""
UNREADABLE = "unreadable"
"""The member that has the text of a line of NDJSON that cannot be read."""
BYTE_ORDER_MARK = "\ufeff"
STRAY_RETURN = "new-line"
"""The word by which `csv` means a carriage return without a line feed."""
ERRORS_OF_CSV = {
    "end of data": "has a quotation mark that is left open, or the file is truncated",
    "limit": f"{TOO_LONG}; is a quotation mark left open?",
    STRAY_RETURN: "has a carriage return without a line feed; save it with line feeds, or put its cell in"
    " quotation marks",
    "": 'has a quotation mark out of place; write it "like ""this"""',
}
"""What is wrong with a row, by a word in the error of `csv`."""


class Piece(NamedTuple):
    """Consecutive records of a table without their line ends, and the cells of quantities by their names.

    ``errors`` are the reasons of records that cannot be read, by their place. ``size`` is the length of the
    piece in the file, to show progress.
    """

    texts: "pl.Series"
    cells: "pl.DataFrame"
    errors: Mapping[int, str]
    size: int


class Csv:
    """A table of cells with a separator between them, under a header.

    Records without a quotation mark, and with as many cells as the header, are split at the separators in
    bulk. Elsewhere Python's `csv` splits them, and is strict about quotation marks.
    """

    def __init__(self, blocks: Iterator[bytes], known: Callable[[Sequence[str]], Collection[str]]):
        """Read the header by the separator that makes most ``known`` columns, then most columns."""
        csv.field_size_limit(LONGEST_RECORD)
        self._texts = map(_decoded, whole_lines(blocks, is_csv=True))
        text = next(self._texts, "")
        mark = BYTE_ORDER_MARK if text.startswith(BYTE_ORDER_MARK) else ""
        text = text.removeprefix(BYTE_ORDER_MARK)
        while text.count('"') % 2 and len(text) < LONGEST_RECORD and (more := next(self._texts, "")):
            text += more  # the header may have line ends
        self._text, self._line = _lines(text), 1
        self.separator = max(SEPARATORS, key=lambda mark: best_header(text, mark, known))
        _, header, self.columns = next(self._records(), (1, "", []))
        if not header:
            raise Unreadable("it is empty")
        self.header = mark + header.rstrip("\r\n")
        self.line_end = "\r\n" if header.endswith("\r\n") else "\n"

    def pieces(self, headings: Sequence[Heading]) -> Iterator[Piece]:
        """Yield the records below the header. Raises Unreadable."""
        while text := self._text.read() or next(self._texts, ""):
            if piece := self._in_bulk(text, headings):
                self._line += len(piece.texts)
            else:
                self._text = _lines(text)
                piece = self._by_csv(headings)
            if len(piece.texts):
                yield piece

    def _in_bulk(self, text: str, headings: Sequence[Heading]) -> Piece | None:
        """Return the records of a text if all of them are plain, else None."""
        import polars as pl

        if '"' in text or ("\r" in text and text.count("\r") > text.count("\r\n")):
            return None
        lines = pl.Series([text.removesuffix("\n")]).str.split("\n").explode().str.strip_suffix("\r")
        cells = lines.str.split(self.separator)
        if not (cells.list.len() == len(self.columns)).all():
            return None
        frame = pl.DataFrame({heading.name: cells.list.get(heading.place) for heading in headings})
        return Piece(lines, frame, {}, len(text))

    def _by_csv(self, headings: Sequence[Heading]) -> Piece:
        """Return the records from here to the first that ends where a text ends, or to the end of a block."""
        import polars as pl

        width = len(self.columns)
        texts: list[str] = []
        rows: list[list[str]] = []
        errors: dict[int, str] = {}
        size = 0
        for line, record, cells in self._records():
            text, lacking = record.rstrip("\r\n"), width - len(cells)
            if error := self._error_of(line, cells):
                errors[len(texts)] = error
            if lacking < 0:  # the last cell takes the rest, so that results stand in their columns
                text = self._written([*cells[: width - 1], self.separator.join(cells[width - 1 :])])
            texts.append(text + self.separator * lacking)
            cells += [""] * lacking
            rows.append([cells[heading.place] for heading in headings])
            size += len(record)
            if size > sources.BLOCK_BYTES:
                break
        frame = pl.DataFrame(rows, [(heading.name, pl.String) for heading in headings], orient="row")
        return Piece(pl.Series(texts, dtype=pl.String), frame, errors, size)

    def _records(self) -> Iterator[tuple[int, str, list[str]]]:
        """Yield rows that are not blank up to the first that ends where a text ends.

        Each has the number of its first line, its text and its cells. Raises Unreadable.
        """
        taken: list[str] = []

        def lines() -> Iterator[str]:
            while True:
                for line in self._text:
                    taken.append(line)
                    yield line
                if not taken or not (text := next(self._texts, "")):
                    return
                self._text = _lines(text)

        try:
            for cells in csv.reader(lines(), delimiter=self.separator, strict=True):
                line, record = self._line, "".join(taken)
                if "\r\r" in record[-3:]:  # csv would take both for line ends
                    raise csv.Error(STRAY_RETURN)
                self._line += len(taken)
                taken.clear()
                if record.strip() or len(cells) > 1:
                    yield line, record, cells
        except csv.Error as error:
            why = next(why for word, why in ERRORS_OF_CSV.items() if word in str(error))
            raise Unreadable(f"the row that begins in line {self._line} {why}") from None

    def _error_of(self, line: int, cells: Sequence[str]) -> str | None:
        """Say what is wrong with the row that begins in that line; None if nothing is."""
        for cell in cells:
            if (ends := cell.count("\n")) >= MOST_LINES:
                most = f"the most is {MOST_LINES}; is a quotation mark left open?"
                return f"the cell that begins in line {line} has {ends + 1} lines, and {most}"
            line += ends
        width = len(self.columns)
        if len(cells) == width:
            return None
        error = f"the row has {counted(len(cells), 'cell')}; the header has {width}"
        if len(cells) > width and self.separator == ",":
            error += "; is there a decimal comma (write a point), or a comma at the end of the row?"
        return error

    def _written(self, cells: Sequence[str]) -> str:
        """Return cells as a row of the table, in quotation marks if they need them."""
        buffer = StringIO()
        # Without a line end of its own, the writer would not quote the line breaks of cells.
        csv.writer(buffer, delimiter=self.separator).writerow(cells)
        return buffer.getvalue().removesuffix("\r\n")


def _decoded(text: bytes) -> str:
    """Return bytes as text. Raises Unreadable."""
    try:
        return text.decode()
    except UnicodeDecodeError as error:
        before = in_quotes(text[: error.start].decode().rpartition("\n")[2][-20:])
        byte = f"byte 0x{text[error.start]:02x} behind {before}"
        raise Unreadable(f"it is not UTF-8: {byte}; save it as UTF-8") from None


def _lines(text: str) -> StringIO:
    """Return a text to read by lines, which end with a line feed."""
    return StringIO(text, newline="\n")


# NDJSON


def read_ndjson(
    blocks: Iterator[bytes], headings: Callable[[Sequence[str]], Sequence[Heading]]
) -> Iterator[Piece]:
    """Read the lines that are not blank. Raises Unreadable.

    A line that cannot be read is an error of its record, which has the line's text as its only member.
    ``headings`` finds the quantities among the keys, and is called again when there are more keys.
    """
    import polars as pl

    keys: dict[str, object] = {}
    known = -1
    wanted: Sequence[Heading] = ()
    for text in whole_lines(blocks, is_csv=False):
        lines: list[str] = []
        objects: list[dict[str, object]] = []
        errors: dict[int, str] = {}
        for raw in text.split(b"\n"):
            if not (line := raw.decode(errors="backslashreplace").strip(BYTE_ORDER_MARK + " \t\r")):
                continue
            try:
                row = _object(raw, line)
            except Unreadable as error:
                errors[len(lines)] = str(error)
                line, row = _COMPACT.encode({UNREADABLE: line}), {}
            lines.append(line)
            objects.append(row)
            keys.update(row)
        if not lines:
            continue
        if len(keys) > known:
            known = len(keys)
            wanted = headings(list(keys))
        cells = {heading.name: [_text(row.get(heading.column)) for row in objects] for heading in wanted}
        frame = pl.DataFrame(cells, dict.fromkeys(cells, pl.String))
        yield Piece(pl.Series(lines), frame, errors, len(text))
    if known < 0:
        raise Unreadable("it is empty")


def _object(raw: bytes, line: str) -> dict[str, object]:
    """Return the object in a line, with its numbers as texts. Raises Unreadable."""
    why = "it is not an object"
    try:
        _decoded(raw)
        row = _DECODER.decode(line)
        if isinstance(row, dict):
            return row
    except RecursionError:
        why = "it is nested too deeply"
    except json.JSONDecodeError as error:
        why = f"{error.msg.removesuffix(' at')} at character {error.colno}"
    except ValueError as error:
        why = str(error)
    raise Unreadable(f"{in_quotes(line)} is not a line of NDJSON: {why}")


def _members(pairs: Sequence[tuple[str, object]]) -> dict[str, object]:
    row = dict(pairs)
    if len(row) < len(pairs):
        name, times = Counter(name for name, _ in pairs).most_common()[0]
        raise ValueError(f"column {in_quotes(name)} is there {times} times")
    return row


def _no_number(word: str) -> str:
    raise ValueError(f"{word} is not a number in JSON; write null for what is not given")


class _Number(str):
    """A number of JSON, as it stands."""


_DECODER = json.JSONDecoder(
    object_pairs_hook=_members, parse_float=_Number, parse_int=_Number, parse_constant=_no_number
)
_COMPACT = json.JSONEncoder(ensure_ascii=False, separators=(",", ":"))


def _text(value: object) -> str | None:
    """Return a value as a cell, one that is neither a text nor null as JSON."""
    if value is None:
        return None
    try:
        text = value if isinstance(value, str) else _in_json(value)
    except RecursionError:
        text = "[...]"
    return text.encode(errors="backslashreplace").decode()  # UTF-8 has no halves of surrogate pairs


def _in_json(value: object) -> str:
    """Return a value as JSON, in which numbers stand as they were read."""
    match value:
        case _Number():
            return value
        case list():
            return f"[{','.join(map(_in_json, value))}]"
        case dict():
            members = (f"{_COMPACT.encode(key)}:{_in_json(item)}" for key, item in value.items())
            return f"{{{','.join(members)}}}"
    return _COMPACT.encode(value)
