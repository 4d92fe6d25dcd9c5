"""Tables of text in pieces: each record stays as it came, and the cells of its quantities are read beside it.

A record of CSV is a row, which may have several lines. A record of NDJSON is a line. Cells are texts, too.
"""

import csv
import json
from collections import Counter
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from functools import partial
from io import StringIO
from itertools import chain, islice
from typing import TYPE_CHECKING, Any, NamedTuple

from ..numbers.text import in_quotes
from ..solver.scene import SceneError
from ..tables.headings import UNREAD, Heading, Naming
from ..tables.records import GoesOn, find_header, records_of, wrong_width
from ..tables.sheets import Sheet
from ..tables.sources import Unreadable, whole_lines

if TYPE_CHECKING:
    import polars as pl

MOST_LINES = 50
"""The most lines of a cell: a note has fewer. A quotation mark that is left open would swallow rows."""
ROWS_SHOWN = 3
UNREADABLE = "unreadable"
"""The member that has the text of a line of NDJSON that cannot be read."""
BYTE_ORDER_MARK = "\ufeff"


class Piece(NamedTuple):
    """Consecutive records of a table without their line ends, and the cells of quantities by their names.

    ``errors`` are the reasons of records that cannot be read, by their place. ``size`` is the length of the
    piece in the file, to show progress.
    """

    texts: "pl.Series"
    cells: "pl.DataFrame"
    errors: Mapping[int, str]
    size: int


# CSV


class Csv:
    """A table of cells with a separator between them, under a header.

    Records without a quotation mark, and with as many cells as the header, are split at the separators in
    bulk. Elsewhere Python's `csv` splits them, and is strict about quotation marks.
    """

    def __init__(
        self, blocks: Iterator[bytes], known: Callable[[Sequence[str]], Collection[str]], naming: Naming
    ):
        """Read the header, by its ``known`` columns or by place. Titles above it are left out."""
        self.remarks: list[str] = []
        self._texts = map(bytes.decode, whole_lines(blocks, True, self.remarks))
        self._rest = self._whole("", partial(self._below_header, known, naming))

    def pieces(self, headings: Sequence[Heading]) -> Iterator[Piece]:
        """Yield the records below the header. Raises Unreadable."""
        for text in chain([self._rest], self._texts):
            piece = self._in_bulk(text, headings) or self._whole(text, partial(self._by_csv, headings))
            if len(piece.texts):
                yield piece

    def _whole(self, text: str, read: Callable[[str], Any]) -> Any:
        """Read a text, with as much as follows that it ends with a row. Raises Unreadable."""
        while True:
            try:
                return read(text)
            except GoesOn:
                if not (more := next(self._texts, "")):
                    raise
                text += more

    def _below_header(
        self, known: Callable[[Sequence[str]], Collection[str]], naming: Naming, text: str
    ) -> str:
        """Read the header, and return the text below it. Raises Unreadable, GoesOn."""
        mark = BYTE_ORDER_MARK if text.startswith(BYTE_ORDER_MARK) else ""
        text = text.removeprefix(BYTE_ORDER_MARK)
        if not text.strip():
            raise GoesOn("it is empty")
        layout = find_header(text, known, naming.decisive)
        self.separator, self.has_titles = layout.separator, layout.above > 0
        first = layout.above + layout.heads
        records = [*islice((x for x in records_of(text, self.separator) if any(x[2])), first + ROWS_SHOWN)]
        rows = [cells for *_, cells in records]
        width = max(map(len, rows[layout.above : first] or rows[first:]))
        self.columns, above = layout.headings(rows, width), layout.above_headings(rows)
        first_rows = [[*row, *[""] * width][:width] for row in rows[first:]]
        self.begin = Sheet(self.columns, first_rows, above=above)
        line, header, _ = records[first - 1] if first else (1, "", [])
        self._line = line + header.count("\n")
        self.line_end = "\r\n" if records[max(first - 1, 0)][1].endswith("\r\n") else "\n"
        if not layout.heads and naming.decisive:
            self.columns = ["" if word == UNREAD else word for word in naming.of(self.columns)]
        self.header = mark + (header.rstrip("\r\n") if layout.heads == 1 else self._written(self.columns))
        return text.split("\n", line - 1)[-1].removeprefix(header)

    def _in_bulk(self, text: str, headings: Sequence[Heading]) -> Piece | None:
        """Return the records of a text if all of them are plain, else None."""
        import polars as pl

        width = len(self.columns)
        if '"' in text or width == 1 or ("\r" in text and text.count("\r") > text.count("\r\n")):
            return None
        lines = pl.Series([text.removesuffix("\n")]).str.split("\n").explode().str.strip_suffix("\r")
        cells = lines.str.split(self.separator)
        if not (cells.list.len() == width).all():
            return None
        self._line += len(lines)
        frame = pl.DataFrame({heading.name: cells.list.get(heading.place) for heading in headings})
        return Piece(lines, frame, {}, len(text))

    def _by_csv(self, headings: Sequence[Heading], text: str) -> Piece:
        """Return the records of a text. Raises Unreadable, GoesOn."""
        import polars as pl

        width = len(self.columns)
        texts: list[str] = []
        rows: list[list[str]] = []
        errors: dict[int, str] = {}
        for line, record, cells in records_of(text, self.separator, self._line):
            bare, lacking = record.rstrip("\r\n"), width - len(cells)
            if (most := 1 + max(cell.count("\n") for cell in cells)) > MOST_LINES:
                why = f"has {most} lines, and the most is {MOST_LINES}; is a quotation mark left open?"
                errors[len(texts)] = f"a cell of the row that begins in line {line} {why}"
            elif lacking:
                errors[len(texts)] = f"the row {wrong_width(len(cells), width, self.separator)}"
            if lacking < 0:  # the last cell takes the rest, so that results stand in their columns
                bare = self._written([*cells[: width - 1], self.separator.join(cells[width - 1 :])])
            texts.append(bare + self.separator * lacking)
            cells += [""] * lacking
            rows.append([cells[heading.place] for heading in headings])
        self._line += text.count("\n")
        frame = pl.DataFrame(rows, [(heading.name, pl.String) for heading in headings], orient="row")
        return Piece(pl.Series(texts, dtype=pl.String), frame, errors, len(text))

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


# NDJSON


def read_ndjson(
    blocks: Iterator[bytes], headings: Callable[[Sequence[str]], Sequence[Heading]], results: Sequence[str]
) -> Iterator[Piece]:
    """Read the lines that are not blank. Raises Unreadable, also for the keys of the first object.

    Any other line whose text or keys cannot be read is an error of its record. Its text becomes the only
    member if it is no object, or has one of the ``results``. ``headings`` finds quantities among the keys.
    """
    import polars as pl

    keys: dict[str, object] = {}
    wanted: Sequence[Heading] = ()
    number = 0
    for text in whole_lines(blocks, False, []):
        lines: list[str] = []
        objects: list[dict[str, object]] = []
        errors: dict[int, str] = {}
        for raw in text.removesuffix(b"\n").split(b"\n"):
            number += 1
            if not (line := raw.decode(errors="backslashreplace").strip(BYTE_ORDER_MARK + " \t\r")):
                continue
            row: dict[str, object] = {}
            try:
                row = _object(raw, line)
                if not row.keys() <= keys.keys():
                    wanted = headings([*keys, *(key for key in row if key not in keys)])
                    keys.update(row)
            except (Unreadable, SceneError) as error:
                if row and not keys:
                    raise
                errors[len(lines)] = f"line {number}: {error}"
                if not row or any(name in row for name in results):
                    line = _COMPACT.encode({UNREADABLE: line})
                row = {}
            lines.append(line)
            objects.append(row)
        if lines:
            wanted = wanted or headings([])
            cells = {heading.name: [_text(row.get(heading.column)) for row in objects] for heading in wanted}
            frame = pl.DataFrame(cells, dict.fromkeys(cells, pl.String))
            yield Piece(pl.Series(lines), frame, errors, len(text))
    if not wanted:
        raise Unreadable("it is empty")


def _object(raw: bytes, line: str) -> dict[str, object]:
    """Return the object in a line, with its numbers as texts. Raises Unreadable."""
    why = "it is not an object"
    try:
        _decoded(raw)
        is_nested = "[" in line or line.rfind("{") > 0
        row = (_NESTED_DECODER if is_nested else _DECODER).decode(line)
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
    """A number of JSON, as it stands, within a list or an object."""

    __repr__ = str.__str__


_DECODER, _NESTED_DECODER = (
    json.JSONDecoder(object_pairs_hook=_members, parse_float=x, parse_int=x, parse_constant=_no_number)
    for x in (str, _Number)  # which takes twice the time
)
_COMPACT = json.JSONEncoder(ensure_ascii=False, separators=(",", ":"))


def _text(value: object) -> str | None:
    """Return a value as a cell, None for null."""
    if value is None:
        return None
    text = str(value).lower() if isinstance(value, bool) else str(value)
    return text.encode(errors="backslashreplace").decode()  # UTF-8 has no halves of surrogate pairs
