"""CSV before it is parsed: where its rows end, and whether every quotation mark is in its place.

A cell that begins with a quotation mark ends with one, and those within are doubled; no other cell has
one. What parsers make of anything else loses rows.
"""

import re

QUOTED = rb'"(?:[^"]++|"")*+"'
LEFT_OPEN = rb'"(?:[^"]++|"")*+'


class Unreadable(Exception):
    """What was given is no table; the message says why."""


def last_end(text: bytes) -> int:
    """Behind the last line end that is not within quotation marks."""
    end = text.rfind(b"\n") + 1
    marks = text.count(b'"', 0, end)
    while marks % 2:
        before = text.rfind(b"\n", 0, text.rfind(b'"', 0, end)) + 1
        marks -= text.count(b'"', before, end)
        end = before
    return end


def first_end(text: bytes) -> int:
    """Behind the first line end that is not within quotation marks, or behind all if there is none."""
    line = re.match(rb'(?:[^"\n]++|"[^"]*+")*+\n', text)
    return line.end() if line else len(text)


def checked(rows: bytes, separator: str, line: int) -> bytes:
    """The rows, the first of which is in that line of the file, as a parser takes them.

    Cells with a carriage return are quoted: polars drops one at the end of a cell. Raises Unreadable.
    """
    mark = separator.encode()
    start = rb"(?<![^%b\n])" % mark
    if b'"' in rows:
        cell = start + QUOTED + rb"(?=%b|\r?\n|\r?\Z)" % mark
        well = re.match(rb'(?:[^"]*+%b)*+[^"]*+' % cell, rows)
        stray = well.end() if well else 0
        if stray < len(rows):
            line += rows.count(b"\n", 0, stray)
            if re.compile(start + LEFT_OPEN).fullmatch(rows, stray):
                how = "it is truncated, or one is left open"
                raise Unreadable(f"it ends within quotation marks opened in line {line}: {how}")
            raise Unreadable(f'line {line} has a quotation mark out of place; write it "like ""this"""')
    if b"\r" in rows and rows.count(b"\r") > rows.count(b"\r\n"):
        no_blank_line = rb"(?:(?<=%b)|(?<![^\n])(?!\r+\n))" % mark
        bare = rb'[^"%b\r\n]*+(?:\r(?!\n|\Z)[^"%b\r\n]*+)++' % (mark, mark)
        either = rb"%b%b|%b(%b)" % (start, QUOTED, no_blank_line, bare)
        rows = re.sub(either, lambda found: b'"%b"' % found[1] if found[1] else found[0], rows)
    return rows


def portions(rows: bytes, lines: int) -> list[bytes]:
    """The rows in parts of so many lines at most, or more where they are in one cell."""
    row = rb'(?:[^"\n]++|"[^"]*+")*+\n'
    parts = [found[0] for found in re.finditer(rb"(?:%b){1,%d}+" % (row, lines), rows)]
    rest = rows[sum(map(len, parts)) :]
    return [*parts, rest] if rest else parts


def split(line: str, separator: str) -> list[str]:
    """The cells of a row."""
    cells = re.findall(rf'(?:\A|{separator})("(?:[^"]|"")*"|[^{separator}]*)', line.rstrip("\r\n"))
    return [cell[1:-1].replace('""', '"') if cell.startswith('"') else cell for cell in cells]


def widths(rows: bytes, separator: str) -> list[int]:
    """How many cells each line has that ends a row; none in a blank one."""
    mark = separator.encode()
    lines = re.sub(b'"[^"]*"', b'""', rows).split(b"\n")
    return [line.count(mark) + 1 if line.strip() or mark in line else 0 for line in lines]
