"""CSV before it is parsed: where its rows end, and whether every quotation mark is in its place.

A cell that begins with a quotation mark ends with one, and those within are doubled; no other cell has
one. What parsers make of anything else loses rows.

So quotation marks come in pairs, of which the first stands where a cell begins or right behind the pair
before, and the second where a cell ends or right before the next pair. Patterns here match a pair, not
cells: what is repeated is a character, so that no text makes them slow, or hungry for memory. Nor are
they possessive: over groups those went wrong until Python 3.11.5 (gh-106052).
"""

import re
from collections.abc import Iterator
from itertools import islice, pairwise

from ..files import Unreadable


def last_end(text: bytes) -> int:
    """Behind the last line end that is not within quotation marks."""
    end = text.rfind(b"\n") + 1
    marks = text.count(b'"', 0, end)
    while marks % 2:
        before = text.rfind(b"\n", 0, text.rfind(b'"', 0, end)) + 1
        marks -= text.count(b'"', before, end)
        end = before
    return end


def _ends(text: bytes) -> Iterator[int]:
    """Behind each line end that is not within quotation marks."""
    start = marks = 0
    while end := text.find(b"\n", start) + 1:
        marks += text.count(b'"', start, end)
        start = end
        if not marks % 2:
            yield end


def first_end(text: bytes) -> int:
    """Behind the first line end that is not within quotation marks, or behind all if there is none."""
    return next(_ends(text), len(text))


def checked(rows: bytes, separator: str, line: int) -> bytes:
    """The rows, the first of which is in that line of the file, as a parser takes them.

    Cells with a carriage return are quoted: polars drops one at the end of a cell. Raises Unreadable.
    """
    mark = separator.encode()
    if b'"' in rows:
        opens = rb'(?<![^%b\n])"' % mark
        pair = re.compile(rb'(?:%b|(?<=")")[^"]*"(?=%b|\r?\n|\r?\Z|")' % (opens, mark))

        def has_stray(rows: bytes) -> bool:
            return 2 * sum(1 for _ in pair.finditer(rows)) < rows.count(b'"')

        for row in portions(rows, 1) if has_stray(rows) else ():
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


def portions(rows: bytes, lines: int) -> list[bytes]:
    """The rows in parts of so many lines at most, or more where they are in one cell."""
    cuts = [0, *islice(_ends(rows), lines - 1, None, lines), len(rows)]
    return [rows[start:end] for start, end in pairwise(cuts) if start < end]


def split(line: str, separator: str) -> list[str]:
    """The cells of a row."""
    cells = re.findall(rf'(?:\A|{separator})("(?:[^"]|"")*"|[^{separator}]*)', line.rstrip("\r\n"))
    return [cell[1:-1].replace('""', '"') if cell.startswith('"') else cell for cell in cells]


def widths(rows: bytes, separator: str) -> list[int]:
    """How many cells each line has that ends a row; none in a blank one."""
    mark = separator.encode()
    lines = re.sub(b'"[^"]*"', b'""', rows).split(b"\n")
    return [line.count(mark) + 1 if line.strip() or mark in line else 0 for line in lines]
