"""Tables of text: each record stays as it came, and the cells of its quantities are read beside it.

A record of CSV is a row, which may have several lines. A record of NDJSON is a line. Cells are texts, too.
"""

import csv
import json
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import suppress
from io import StringIO
from typing import TYPE_CHECKING, NamedTuple

from ..model.units import counted, in_quotes
from . import sources
from .headings import SEPARATOR_NAMES, Heading
from .sources import LONGEST_RECORD, Unreadable, decoded, too_long, whole_lines

if TYPE_CHECKING:
    import polars as pl

MOST_COLUMNS = 1024
MOST_LINES = 50
"""The most lines of a cell: a note has fewer, and a quotation mark that is left open makes more."""
UNREADABLE = "unreadable"
"""The member that has the text of a line of NDJSON that cannot be read."""
BYTE_ORDER_MARK = "\ufeff"
STRAY_MARK = 'has a quotation mark out of place; write it "like ""this"""'
STRAY_RETURN = (
    "has a carriage return without a line feed; save it with line feeds, or put its cell in quotation marks"
)


class Piece(NamedTuple):
    """Consecutive records of a table."""

    texts: "pl.Series"
    """The records without their line ends."""
    cells: "pl.DataFrame"
    """The cells of columns that hold a quantity, by its name."""
    errors: Mapping[int, str]
    """The reasons of records that cannot be read, by their place."""
    size: int
    """The length of the piece in the file, to show progress."""

    @property
    def rows(self) -> int:
        return len(self.texts)


class Csv:
    """A table of cells with a separator between them, under a header.

    Records without a quotation mark, and with as many cells as the header, are split at the separators in
    bulk. Elsewhere Python's `csv` splits them, and is strict about quotation marks.
    """

    def __init__(
        self, blocks: Iterator[bytes], usual: str, known: Callable[[Sequence[str]], Collection[str]]
    ):
        """Read the header by the separator that makes most ``known`` columns, then most columns.

        If several are as good, it is the ``usual`` one.
        """
        csv.field_size_limit(LONGEST_RECORD)
        self._texts = (decoded(*lines) for lines in whole_lines(blocks, cells=True))
        self._text, self._at, self._line = next(self._texts, ""), 0, 1
        self.mark = BYTE_ORDER_MARK if self._text.startswith(BYTE_ORDER_MARK) else ""
        self._text = self._text.removeprefix(BYTE_ORDER_MARK)
        while self._text.count('"') % 2 and len(self._text) < LONGEST_RECORD:  # the header may have line ends
            if not (more := next(self._texts, "")):
                break
            self._text += more

        def score(separator: str) -> tuple[int, int]:
            cells = _first_row(self._text, separator)
            return len(known(cells)), len(cells)

        self.separator = max((usual, *SEPARATOR_NAMES), key=score)
        header, self.columns = next(self._records(), ("", []))
        if not header:
            raise Unreadable("it is empty")
        if len(self.columns) > MOST_COLUMNS:
            raise Unreadable(f"it has more than {MOST_COLUMNS} columns, the most taken")
        self.header = self.mark + header.rstrip("\r\n")
        self.line_end = "\r\n" if header.endswith("\r\n") else "\n"
        self._line += header.count("\n")

    def pieces(self, headings: Sequence[Heading]) -> Iterator[Piece]:
        """Yield the records below the header. Raises Unreadable."""
        while text := self._text[self._at :] or next(self._texts, ""):
            self._text, self._at = text, 0
            if piece := self._in_bulk(headings):
                self._line += len(piece.texts)
                self._at = len(text)
                yield piece
            else:
                yield from self._by_csv(headings)

    def _in_bulk(self, headings: Sequence[Heading]) -> Piece | None:
        """Return the records of the text if all of them are plain, else None."""
        import polars as pl

        text = self._text
        if '"' in text or ("\r" in text and text.count("\r") > text.count("\r\n")):
            return None
        lines = pl.Series([text.removesuffix("\n")]).str.split("\n").explode()
        if "\r" in text:
            lines = lines.str.strip_suffix("\r")
        cells = lines.str.split(self.separator)
        if not (cells.list.len() == len(self.columns)).all():
            return None
        frame = pl.DataFrame({heading.name: cells.list.get(heading.place) for heading in headings})
        return Piece(lines, frame, {}, len(text))

    def _by_csv(self, headings: Sequence[Heading]) -> Iterator[Piece]:
        """Yield the records from here to the first that ends where a text ends."""
        import polars as pl

        width = len(self.columns)
        texts: list[str] = []
        rows: list[list[str]] = []
        errors: dict[int, str] = {}
        size = 0

        def piece() -> Piece:
            types = dict.fromkeys((heading.name for heading in headings), pl.String)
            frame = pl.DataFrame(rows, types, orient="row")
            return Piece(pl.Series(texts, dtype=pl.String), frame, errors, size)

        for record, cells in self._records():
            text, lacking = record.rstrip("\r\n"), width - len(cells)
            if error := self._error_of(record, cells):
                errors[len(texts)] = error
            if lacking < 0:  # the last cell takes the rest, so that results stand in their columns
                text = self._written([*cells[: width - 1], self.separator.join(cells[width - 1 :])])
            texts.append(text + self.separator * lacking)
            cells += [""] * lacking
            rows.append([cells[heading.place] for heading in headings])
            size += len(record)
            if size > sources.BLOCK_BYTES:
                yield piece()
                texts, rows, errors, size = [], [], {}, 0
        if texts:
            yield piece()

    def _records(self) -> Iterator[tuple[str, list[str]]]:
        """Yield rows that are not blank, with their cells, up to the first that ends where a text ends."""
        taken: list[str] = []

        def lines() -> Iterator[str]:
            while True:
                while self._at < len(self._text):
                    end = self._text.find("\n", self._at) + 1 or len(self._text)
                    taken.append(self._text[self._at : end])
                    self._at = end
                    yield taken[-1]
                if not taken or not (text := next(self._texts, "")):
                    return
                self._text, self._at = text, 0

        try:
            for cells in csv.reader(lines(), delimiter=self.separator, strict=True):
                record = "".join(taken)
                taken.clear()
                if "\r\r" in record[-3:]:  # csv would take both for line ends
                    raise csv.Error("new-line")
                if record.strip() or len(cells) > 1:
                    yield record, cells
                self._line += record.count("\n")
        except csv.Error as error:
            raise self._refused(str(error)) from None

    def _refused(self, error: str) -> Unreadable:
        """Return the error for a row whose quotation marks are wrong, by the error of `csv`."""
        row = f"the row that begins in line {self._line}"
        if "end of data" in error:
            return Unreadable(f"a quotation mark is left open in {row}, or the file is truncated")
        if "limit" in error:
            return Unreadable(f"{too_long(self._line)}; is a quotation mark left open?")
        why = STRAY_RETURN if "new-line" in error else STRAY_MARK
        return Unreadable(f"{row} {why}")

    def _error_of(self, record: str, cells: Sequence[str]) -> str | None:
        """Say what is wrong with the row that was read last; None if nothing is."""
        if record.count("\n") > MOST_LINES:
            line = self._line
            for cell in cells:
                if (lines := cell.count("\n") + 1) > MOST_LINES:
                    most = f"the most is {MOST_LINES}; is a quotation mark left open?"
                    return f"the cell that begins in line {line} has {lines} lines, and {most}"
                line += lines - 1
        width = len(self.columns)
        if len(cells) == width:
            return None
        error = f"the row has {counted(len(cells), 'cell')}; the header has {width}"
        if len(cells) > width and self.separator == ",":
            error += ": write decimal points, and no comma at its end"
        return error

    def _written(self, cells: Sequence[str]) -> str:
        """Return cells as a row of the table, in quotation marks if they need them."""
        buffer = StringIO()
        csv.writer(buffer, delimiter=self.separator, lineterminator="").writerow(cells)
        return buffer.getvalue()


def _first_row(text: str, separator: str) -> list[str]:
    """Return the cells of the first row that is not blank, if the table has that separator."""
    rows = csv.reader(StringIO(text, newline="\n"), delimiter=separator)
    try:
        return next((cells for cells in rows if len(cells) > 1 or "".join(cells).strip()), [])
    except csv.Error:
        return []


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
    for text, _ in whole_lines(blocks, cells=False):
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
        if len(keys) > MOST_COLUMNS:
            raise Unreadable(f"it has more than {MOST_COLUMNS} columns, the most taken")
        if len(keys) > known:
            known = len(keys)
            wanted = headings(list(keys))
        columns = {heading.name: [row.get(heading.column) for row in objects] for heading in wanted}
        cells = {name: _column(values) for name, values in columns.items()}
        yield Piece(pl.Series(lines), pl.DataFrame(cells), errors, len(text))
    if known < 0:
        raise Unreadable("it is empty")


def _object(raw: bytes, line: str) -> dict[str, object]:
    """Return the object in a line, with its numbers as texts. Raises Unreadable."""
    why = "it is not an object"
    try:
        raw.decode()
        row = _DECODER.decode(line)
        if isinstance(row, dict):
            return row
    except RecursionError:
        why = "it is nested too deeply"
    except UnicodeDecodeError as error:
        why = f"it is not UTF-8: byte 0x{raw[error.start]:02x}"
    except json.JSONDecodeError as error:
        why = f"{error.msg.removesuffix(' at')} at character {error.colno}"
    except ValueError as error:
        why = str(error)
    raise Unreadable(f"{in_quotes(line)} is not a line of NDJSON: {why}")


def _members(pairs: Sequence[tuple[str, object]]) -> dict[str, object]:
    row = dict(pairs)
    if len(row) < len(pairs):
        names = [name for name, _ in pairs]
        twice = next(name for name in names if names.count(name) > 1)
        raise ValueError(f"column {in_quotes(twice)} is there {names.count(twice)} times")
    return row


def _no_number(word: str) -> str:
    raise ValueError(f"{word} is not a number in JSON; write null for what is not given")


_DECODER = json.JSONDecoder(
    object_pairs_hook=_members, parse_float=str, parse_int=str, parse_constant=_no_number
)
_COMPACT = json.JSONEncoder(ensure_ascii=False, separators=(",", ":"))


def _column(values: Sequence[object]) -> "pl.Series":
    """Return values as texts. A value that is neither a text nor null is written as JSON."""
    import polars as pl

    if all(value is None or type(value) is str for value in values):  # polars takes long for nested lists
        with suppress(UnicodeEncodeError):  # halves of surrogate pairs, which UTF-8 does not have
            return pl.Series(values, dtype=pl.String, strict=True)
    return pl.Series(map(_text, values), dtype=pl.String)


def _text(value: object) -> str | None:
    text = value if value is None or isinstance(value, str) else json.dumps(value, ensure_ascii=False)
    return None if text is None else text.encode(errors="backslashreplace").decode()
