"""A table of runs as texts: CSV as spreadsheets, loggers and people write it."""

import csv
import re
from collections.abc import Sequence
from io import BytesIO, StringIO
from typing import IO, NamedTuple

from ..batch.csv_quotes import split
from ..batch.formats import LONGEST_RECORD, PARTED_BY, PIECE_BYTES, Inputs, records, refuse_long, rows_of_csv
from ..files import Unreadable

MOST_ABOVE = 40
"""The header is looked for in so many lines, as titles may stand above it."""


class Cells(NamedTuple):
    """A table: its columns, its rows, the separator of its cells, and how else it was read."""

    columns: Sequence[str]
    rows: Sequence[Sequence[str]]
    separator: str
    remarks: Sequence[str] = ()


def read_cells(file: IO[bytes], usual: str, inputs: Inputs) -> Cells:
    """A table, without its blank rows. Raises Unreadable."""
    text = b"".join(lines for lines, _, _ in records(file, quoted=False))
    text, usual, remarks = _tidied(text, usual, inputs)
    rows: list[list[str]] = []
    columns: list[str] = []
    separator = usual
    csv.field_size_limit(LONGEST_RECORD + PIECE_BYTES)  # no row is longer, and by default it would be less
    for header, separator, piece, _, _ in rows_of_csv(BytesIO(text), usual, inputs):
        parsed = csv.reader(StringIO(piece.decode(), newline=""), delimiter=separator)
        rows += [row for row in parsed if "".join(row).strip()]
        columns = header
    while columns and not columns[-1].strip():
        columns = columns[:-1]
    return Cells(columns, rows, separator, remarks)


def whole_rows(cells: Cells) -> list[Sequence[str]]:
    """The rows, of as many cells as there are columns. Raises Unreadable.

    A row may be shorter if it has no numbers: it could be a remark below the table, and is not cut off.
    """
    rows: list[Sequence[str]] = []
    width = len(cells.columns)
    for number, row in enumerate(cells.rows, 1):
        if any(cell.strip() for cell in row[width:]):
            refuse_long(number, len(row), width, cells.separator)
        if len(row) < width and re.search(r"\d", "".join(row)):
            raise Unreadable(f"row {number} has {len(row)} cells, and the header {width}")
        rows.append([*row[:width], *[""] * (width - len(row))])
    return rows


def _tidied(text: bytes, usual: str, inputs: Inputs) -> tuple[bytes, str, list[str]]:
    """A text in UTF-8 that begins with its header, its usual separator, and how it was read.

    Lines that are left out become blank, so that all keep their numbers. Raises Unreadable.
    """
    remarks: list[str] = []
    try:
        lines = text.decode("utf-8-sig").split("\n")
    except UnicodeDecodeError as error:
        try:
            lines = text.decode("cp1252").split("\n")
        except UnicodeDecodeError:
            number, byte = text.count(b"\n", 0, error.start) + 1, text[error.start]
            raise Unreadable(f"line {number} is not UTF-8: byte 0x{byte:02x}; save it as UTF-8") from None
        remarks.append("text in Windows-1252")
    first = next((i for i, line in enumerate(lines) if line.strip()), 0)
    if found := re.fullmatch(r'"?sep=([,;\t])"?\r?', lines[first], re.IGNORECASE):
        usual, lines[first] = found[1], ""
    comments: dict[int, str] = {}
    marks = 0
    for i, line in enumerate(lines):
        if line.lstrip().startswith("#") and not marks % 2:
            comments[i], lines[i] = line.lstrip("# \t"), ""
        marks += lines[i].count('"')

    def score(i: int) -> tuple[int, int]:
        """How many inputs a line has, and how many cells that begin with a letter."""
        line = comments.get(i, lines[i])
        # A heading in quotation marks may be of two lines.
        ends = (line, *("\n".join(lines[i:end]) for end in range(i + 2, i + MOST_ABOVE)))
        line = next((text for text in ends if text.count('"') % 2 == 0), line)
        rows = [split(line, mark) for mark in PARTED_BY]
        return max((len(inputs(row)), sum(cell.strip()[:1].isalpha() for cell in row)) for row in rows)

    above = [i for i, line in enumerate(lines[:MOST_ABOVE]) if line.strip()]
    header = next((i for i in (*above, *comments) if score(i)[0] > 1), None)
    if header is None:
        header = max(above, key=score, default=0)
    lines[header] = comments.pop(header, lines[header])
    if any(i < header for i in above):
        lines[:header] = [""] * header
        remarks.append(f"header in line {header + 1}")
    if comments:
        remarks.append("lines that begin with # left out")
    return "\n".join(lines).encode(), usual, remarks
