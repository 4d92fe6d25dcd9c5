"""A table of runs as texts: CSV as spreadsheets and people write it."""

import csv
import re
from collections.abc import Sequence
from io import BytesIO, StringIO
from typing import IO, NamedTuple

from ..batch.csv_quotes import split
from ..batch.formats import (
    LONGEST_RECORD,
    PARTED_BY,
    PIECE_BYTES,
    Inputs,
    blocks_of,
    records,
    refuse_long,
    rows_of_csv,
)
from ..files import Unreadable

MOST_ABOVE = 40
"""The header is looked for in so many lines, as titles may stand above it."""


class Cells(NamedTuple):
    """A table: its columns, its rows, the separator of its cells, and how else it was read."""

    columns: Sequence[str]
    rows: Sequence[Sequence[str]]
    separator: str
    remarks: Sequence[str] = ()


def read_cells(file: IO[bytes], usual: str, recognised: Inputs) -> Cells:
    """A table without its blank rows; each row has as many cells as the header, or more. Raises Unreadable.

    ``recognised`` returns those of some headings that a run is made of.
    """
    text, remarks = _tidied(
        b"".join(lines for lines, _, _ in records(blocks_of(file), quoted=False)), recognised
    )
    columns: list[str] = []
    rows: list[list[str]] = []
    separator = usual
    csv.field_size_limit(LONGEST_RECORD + PIECE_BYTES)  # no row is longer, and by default it would be less
    for header, separator, piece, _, _ in rows_of_csv(BytesIO(text), usual, recognised):
        columns = header
        parsed = csv.reader(StringIO(piece.decode(), newline=""), delimiter=separator)
        rows += [row for row in parsed if "".join(row).strip()]
    while columns and not columns[-1].strip():
        columns = columns[:-1]
    for number, row in enumerate(rows, 1):
        if len(row) < len(columns):
            raise Unreadable(f"row {number} has {len(row)} cells, and the header {len(columns)}")
        if any(cell.strip() for cell in row[len(columns) :]):
            refuse_long(number, len(row), len(columns), separator)
    return Cells(columns, rows, separator, remarks)


def _tidied(text: bytes, recognised: Inputs) -> tuple[bytes, list[str]]:
    """The text in UTF-8, its header first, and how it was read.

    Titles and comments become blank lines, so that the other lines keep their numbers.
    """
    remarks: list[str] = []
    try:
        lines = text.decode("utf-8-sig").split("\n")
    except UnicodeDecodeError:
        lines = text.decode("cp1252", "replace").split("\n")
        remarks.append("text in Windows-1252")
    if re.fullmatch(r'"?sep=[,;\t]"?\r?', lines[0], re.IGNORECASE):  # Excel's
        lines[0] = ""
    filled = [i for i, line in enumerate(lines) if line.strip()]
    comments = [i for i in filled if lines[i].lstrip().startswith("#")]
    plain = [i for i in filled[:MOST_ABOVE] if i not in comments]

    def is_header(i: int) -> bool:
        line = lines[i].lstrip("# \t")
        return line.count('"') % 2 == 0 and any(len(recognised(split(line, mark))) > 1 for mark in PARTED_BY)

    # NumPy writes the header as a comment. Where there seems to be none, the first line is called one.
    header = next(filter(is_header, [*plain, *comments]), min(plain, default=0))
    titles = [i for i in plain if i < header]
    if titles:
        remarks.append(f"header in line {header + 1}")
    if set(comments) - {header}:
        remarks.append("lines that begin with # left out")
    if header in comments:
        lines[header] = lines[header].lstrip("# \t")
    for i in {*titles, *comments} - {header}:
        lines[i] = ""
    return "\n".join(lines).encode(), remarks
