"""Quotation marks in CSV: where rows end, and whether each mark is in its place. Parsing comes after.

A cell that begins with a quotation mark ends with one, and marks within it are doubled. No other cell has
a quotation mark. From any other text parsers lose rows.

So quotation marks come in pairs. The first of a pair stands where a cell begins or directly after another
pair, and the second where a cell ends or directly before another pair. The patterns match a pair and not a
cell: they repeat a single character, so that no text makes them slow or large. They are not possessive,
because possessive groups fail before Python 3.11.5 (gh-106052).
"""

import re
from collections.abc import Iterator
from itertools import pairwise

from ..files import Unreadable


def last_end(text: bytes) -> int:
    """The index after the last line end outside quotation marks; 0 if there is none."""
    end = text.rfind(b"\n") + 1
    marks = text.count(b'"', 0, end)
    while marks % 2:
        before = text.rfind(b"\n", 0, text.rfind(b'"', 0, end)) + 1
        marks -= text.count(b'"', before, end)
        end = before
    return end


def _ends(text: bytes) -> Iterator[int]:
    """The index after each line end outside quotation marks."""
    start = marks = 0
    while end := text.find(b"\n", start) + 1:
        marks += text.count(b'"', start, end)
        start = end
        if not marks % 2:
            yield end


def first_end(text: bytes) -> int:
    """The index after the first line end outside quotation marks, or the length if there is none."""
    return next(_ends(text), len(text))


def checked(rows: bytes, separator: str, line: int) -> bytes:
    """The rows as polars can parse them. The first begins in that line of the file. Raises Unreadable.

    Cells with a carriage return become quoted, because polars drops one at the end of a bare cell.
    """
    mark = separator.encode()
    if b'"' in rows:
        opens = rb'(?<![^%b\n])"' % mark
        pair = re.compile(rb'(?:%b|(?<=")")[^"]*"(?=%b|\r?\n|\r?\Z|")' % (opens, mark))

        def has_stray(rows: bytes) -> bool:
            return 2 * sum(1 for _ in pair.finditer(rows)) < rows.count(b'"')

        for row in each(rows) if has_stray(rows) else ():
            if has_stray(row):
                where = f"the row that begins in line {line}"
                if row.count(b'"') % 2 and re.search(opens + rb'[^"]*\Z', row.replace(b'""', b"")):
                    how = "it is truncated, or one is left open"
                    raise Unreadable(f"it ends within quotation marks, in {where}: {how}")
                raise Unreadable(f'{where} has a quotation mark out of place; write it "like ""this"""')
            line += row.count(b"\n")
    if b"\r" in rows and rows.count(b"\r") > rows.count(b"\r\n"):
        no_blank_line = rb"(?:(?<=%b)|(?<![^\n])(?!\r+\n))" % mark
        bare = rb'[^"%b\n]*\r(?!\n|\Z)[^"%b\n]*?(?=\r?(?:\n|\Z)|%b)' % (mark, mark, mark)
        either = rb'"[^"]*"|%b(%b)' % (no_blank_line, bare)
        rows = re.sub(either, lambda found: b'"%b"' % found[1] if found[1] else found[0], rows)
    return rows


def each(rows: bytes) -> Iterator[bytes]:
    """Each of the rows; the last one may have no line end."""
    for start, end in pairwise([0, *_ends(rows), len(rows)]):
        if start < end:
            yield rows[start:end]


def split(line: str, separator: str) -> list[str]:
    """The cells of a row."""
    cells = re.findall(rf'(?:\A|{separator})("(?:[^"]|"")*"|[^{separator}]*)', line.rstrip("\r\n"))
    return [cell[1:-1].replace('""', '"') if cell.startswith('"') else cell for cell in cells]


def widths(rows: bytes, separator: str) -> list[int]:
    """The number of cells of each row, 0 for a blank line."""
    mark = separator.encode()
    lines = re.sub(b'"[^"]*"', b'""', rows).split(b"\n")
    return [line.count(mark) + 1 if line.strip() or mark in line else 0 for line in lines]
