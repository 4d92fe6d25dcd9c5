"""A table as spreadsheets, people and Python have it: its headings found, its cells as texts."""

import re
from collections.abc import Collection, Iterable, Sequence
from contextlib import ExitStack
from functools import partial
from os import PathLike, fspath
from typing import IO, Any, NamedTuple

from ..numbers.text import in_quotes
from .headings import (
    ABOVE,
    NOTHING_SAID,
    Heading,
    Naming,
    Vocabulary,
    are_units,
    may_be_mass,
    recognised,
    unit_within,
)
from .records import LIKE_NUMBER, Layout, find_header, records_of, wrong_width
from .sources import Unreadable, blocks_of, whole_lines
from .workbooks import opened_table

MOST_BYTES = 64 << 20
"""The most bytes of a table of runs, unpacked."""
COMMENTS = "lines that begin with # left out"
MISSING = ("nan", "NaN", "None", "<NA>", "NaT", "--")
"""How Python writes a missing value, and NumPy a masked one."""


RULE = re.compile(r"[\s|:+-]*--[\s|:+-]*")
"""A line of Markdown and the like below headings, or between rows."""


class Sheet(NamedTuple):
    """A table of texts, its separator, how it was read, and the cells above its last row of headings."""

    columns: Sequence[str]
    rows: Sequence[Sequence[str]]
    separator: str = ""
    remarks: Sequence[str] = ()
    above: Sequence[str] = ()

    @property
    def numbers(self) -> list[int]:
        """Return the numbers of rows as the first column has them; none if it has others, or a mass."""
        cells, column = [row[0].strip() for row in self.rows], self.columns[0]
        is_quantity = may_be_mass(column) or unit_within(column, Heading(0, column, "m1"))
        if is_quantity or not all(re.fullmatch("[0-9]{1,9}", cell) for cell in cells):
            return []
        numbers = [*map(int, cells)]
        return numbers if numbers == sorted({*numbers}) else []

    def has_numbers(self, place: int) -> bool:
        return any(LIKE_NUMBER.match(row[place]) for row in self.rows)


def sheet_of(source: Any, vocabulary: Vocabulary, naming: Naming, name: str | None = None) -> Sheet:
    """Read a file by its path, stdin by "-", a mapping or a data frame as texts. Raises Unreadable.

    ``name`` is that of a sheet, in a workbook.
    """
    if isinstance(source, str | PathLike):
        with ExitStack() as stack:
            file, remarks = opened_table(fspath(source), name, stack)
            text = _content(file, remarks)
        sheet = read_sheet(text, vocabulary, naming)
        return sheet._replace(remarks=[*remarks, *sheet.remarks])
    columns: list[tuple[str, list[str]]] = []
    for heading, cells in _columns(source):
        if isinstance(cells, str) or not hasattr(cells, "__iter__"):
            what = f"column {in_quotes(heading)} is of type {type(cells).__name__}"
            raise Unreadable(f"{what}; give a sequence of cells")
        columns.append((str(heading), [_text(cell) for cell in cells]))
    if len({len(cells) for _, cells in columns}) > 1:
        lengths = ", ".join(f"{in_quotes(name)} has {len(cells)} cells" for name, cells in columns)
        raise Unreadable(f"its columns differ in length: {lengths}")
    names, *rows = [*zip(*([name, *cells] for name, cells in columns), strict=True)] or [()]
    heads = 1 + (are_units(rows[0]) if rows else False)
    return Sheet(Layout("", 0, heads).headings([names, *rows], len(names)), rows[heads - 1 :])


def _columns(source: Any) -> Iterable[tuple[object, Any]]:
    """Return the headings and cells of a mapping, or a table of pandas, polars or PyArrow.

    Raises Unreadable for any other type.
    """
    if hasattr(source, "items"):
        pairs: Iterable[tuple[object, Any]] = source.items()
        return pairs
    if hasattr(source, "get_columns"):  # polars
        return ((column.name, column) for column in source.get_columns())
    if hasattr(source, "column_names"):  # PyArrow
        return zip(source.column_names, (column.to_pylist() for column in source.columns), strict=True)
    raise Unreadable(f"it is of type {type(source).__name__}; give a path, a mapping or a data frame")


def _text(cell: Any) -> str:
    """Return a cell as text: a difference of times in seconds, "" for a missing value."""
    if str(cell) in MISSING:
        return ""
    if hasattr(cell, "total_seconds"):
        return f"{cell.total_seconds()} s"
    if getattr(getattr(cell, "dtype", None), "kind", "") == "m":  # of NumPy
        return f"{cell / type(cell)(1, 's')} s"
    return str(cell)


def filled_down(sheet: Sheet, places: Collection[int]) -> Sheet:
    """Return a table whose blank cells in these places have what stands above, as merged cells do."""
    rows, above = list[list[str]](), [""] * len(sheet.columns)
    for row in sheet.rows:
        above = [above[i] if i in places and not cell.strip() else cell for i, cell in enumerate(row)]
        rows.append(above)
    return sheet._replace(rows=rows)


def _content(file: IO[bytes], remarks: list[str]) -> str:
    """Return the text of a small file, and add how it was read to the remarks. Raises Unreadable."""
    content = b""
    for lines in whole_lines(blocks_of(file), True, remarks):
        content += lines
        if len(content) > MOST_BYTES:
            raise Unreadable(f"it is larger than {MOST_BYTES >> 20} MB, unpacked, the most that fit reads")
    return content.decode("utf-8-sig")


def read_sheet(text: str, vocabulary: Vocabulary, naming: Naming = NOTHING_SAID) -> Sheet:
    """Return the table in a text, without blank rows; each row has as many cells as there are headings.

    The separator is that by which most headings are known. Raises Unreadable.
    """
    remarks: list[str] = []
    known = partial(recognised, vocabulary=vocabulary, named=naming.named)
    text = re.sub(r'\A"?sep=[,;\t]"?\n', "", text.replace("\r\n", "\n"), flags=re.IGNORECASE)
    lines = [line for line in text.split("\n") if not RULE.fullmatch(line)]
    if 2 * sum("|" in line for line in lines) > len(lines):
        lines = [re.sub(r"^\s*\||\|\s*$", "", line) for line in lines]
    for i in [i for i, line in enumerate(lines) if line.lstrip().startswith("#")]:
        bare = re.sub(r"^\s*#[# \t]*(?![,;])", "", lines[i])  # NumPy writes headings so; # may be one, too
        is_first = not "".join(lines[:i]).strip()
        is_header = is_first and find_header(bare, known).known > 1
        lines[i] = bare if is_header else ""
        if not is_header and COMMENTS not in remarks:
            remarks.append(COMMENTS)
    text = "\n".join(lines)
    layout = find_header(text, known, naming.decisive)
    if layout.above:
        remarks.append(ABOVE)
    columns, rows, above = _rows(text, layout, naming)
    return Sheet(columns, rows, layout.separator, remarks, above)


def _rows(text: str, layout: Layout, naming: Naming) -> tuple[list[str], list[list[str]], list[str]]:
    """Return the headings in a text, the rows below, and the cells above the last row of headings.

    Raises Unreadable.
    """
    first = layout.above + layout.heads
    records = [cells for *_, cells in records_of(text, layout.separator) if any(cells)]
    rows = [row for row in records[first:] if "".join(row).strip()]
    by_heading = layout.heads and not (naming.decisive or naming.is_open)
    width = max(map(len, records[layout.above : first] if by_heading else records), default=0)
    if not width:
        raise Unreadable("it is empty")
    columns = layout.headings(records, width)
    for number, row in enumerate(rows, 1):
        if any(map(str.strip, row[width:])) or (by_heading and any(map(str.strip, columns[len(row) :]))):
            raise Unreadable(f"row {number} {wrong_width(len(row), width, layout.separator)}")
        row[width:] = [""] * (width - len(row))
    return columns, rows, layout.above_headings(records)
