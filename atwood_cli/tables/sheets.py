"""A table as spreadsheets and people write it: its headings found, its cells as texts."""

import csv
import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from io import StringIO
from itertools import islice
from typing import NamedTuple

from .headings import PARTED_BY, Vocabulary, recognised
from .sources import Unreadable

MOST_ABOVE = 40
"""Rows in which headings are looked for, as titles may stand above them."""
COMMENTS = "lines that begin with # left out"


class Sheet(NamedTuple):
    """A table of texts: its headings, its rows, the separator of its cells, and how else it was read."""

    columns: Sequence[str]
    rows: Sequence[Sequence[str]]
    separator: str = ""
    remarks: Sequence[str] = ()


def read_sheet(content: bytes, usual: str, vocabulary: Vocabulary, named: Mapping[str, str]) -> Sheet:
    """The table in a text, without blank rows; each row has as many cells as there are headings.

    The separator is that by which most headings are known, the ``usual`` one if several are as good. Raises
    Unreadable.
    """
    remarks: list[str] = []
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = content.decode("cp1252", "replace")
        remarks.append("text in Windows-1252")

    def header(text: str, separator: str) -> tuple[int, int, int]:
        """How many headings the text has by that separator, how many cells, and in which of its rows."""
        best = (0, 0, 0)
        with suppress(csv.Error):
            rows = filter(any, csv.reader(StringIO(text, newline=""), delimiter=separator))
            for i, row in enumerate(islice(rows, MOST_ABOVE)):
                found = len(recognised(row, vocabulary, named)), len(row), i
                if found[0] > 1:
                    return found
                best = best if i else found
        return best

    lines = re.sub(r'\A"?sep=[,;\t]"?\r?\n', "", text, flags=re.IGNORECASE).split("\n")
    for i in [i for i, line in enumerate(lines) if line.lstrip().startswith("#")]:
        bare = lines[i].lstrip("# \t")  # NumPy writes headings so
        is_header = max(header(bare, mark)[0] for mark in PARTED_BY) > 1
        lines[i] = bare if is_header else ""
        remarks += [] if is_header or COMMENTS in remarks else [COMMENTS]
    text = "\n".join(lines)
    separator = max((usual, *PARTED_BY), key=lambda mark: header(text, mark)[:2])
    start = header(text, separator)[2]
    remarks += ["lines above the headings left out"] * (start > 0)
    return Sheet(*_rows(text, separator, start), separator, remarks)


def _rows(text: str, separator: str, start: int) -> tuple[list[str], list[list[str]]]:
    """The headings in that row of a text, and the rows below. Raises Unreadable."""
    reader = csv.reader(StringIO(text, newline=""), delimiter=separator, strict=True)
    try:
        columns, *rows = [row for row in reader if any(row)][start:]
    except csv.Error as error:
        raise Unreadable(f"line {reader.line_num}: {error}") from None
    except ValueError:
        raise Unreadable("it is empty") from None
    rows = [row for row in rows if "".join(row).strip()]
    for number, row in enumerate(rows, 1):
        if any(map(str.strip, [*columns[len(row) :], *row[len(columns) :]])):
            comma = "; is there a decimal comma (write a point), or one at its end?"
            hint = comma * (separator == "," and len(row) > len(columns))
            raise Unreadable(f"row {number} has {len(row)} cells, and the header {len(columns)}{hint}")
        row += [""] * (len(columns) - len(row))
    return columns, rows
