"""Workbooks, .xlsx and .ods: a sheet as rows of texts, with numbers as they are shown, in full.

Nothing in a workbook is run. A formula has the value that was stored with it, or else stands as a text, which
is an error of its cell where a number is read. So are a date, and a number in a format that is not wholly
understood. A cell merged over rows counts in each of them.
"""

import csv
import re
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from functools import lru_cache
from io import BytesIO, StringIO
from itertools import chain
from string import digits
from typing import IO
from zipfile import ZipFile

from ..numbers.text import counted, in_quotes, shortened
from ..solver.scene import SceneError
from .formats import BUILT_IN, GENERAL, agreed, duration, refused, shown_number, shown_text
from .packages import DAMAGE, UNFIT, Package
from .sources import WORKBOOKS, Unreadable, opened

LONGEST_LIST = 500
"""The most characters of a message that name sheets."""
TRUE = ("1", "true")
VISIBLE = "visible"
CELLS = ("table-cell", "covered-table-cell")
_ESCAPED = re.compile("_x(000[9AaDd]|00[2-7][0-9A-Fa-f])_")
"""A tab, a line break, or a sign of ASCII in the texts of .xlsx."""


@dataclass
class Grid:
    """The texts of a sheet by row and column, what is merged, with its first and last cell, and hidden."""

    rows: dict[int, dict[int, str]] = field(default_factory=dict)
    merged: list[tuple[int, int, int, int]] = field(default_factory=list)
    hidden_rows: set[int] = field(default_factory=set)
    hidden_columns: set[int] = field(default_factory=set)


def opened_table(source: str, sheet: str | None, stack: ExitStack) -> tuple[IO[bytes], list[str]]:
    """Return the file of that name, stdin, or a sheet of a workbook as CSV, and how it was read.

    Raises Unreadable, SceneError.
    """
    file = opened(source, stack)
    if source.lower().endswith(WORKBOOKS):
        content, remarks = workbook_as_csv(file, sheet)
        return BytesIO(content), remarks
    if sheet is not None:
        raise SceneError("sheet", sheet, f"needs a workbook: {', '.join(WORKBOOKS)}")
    return file, []


def workbook_as_csv(file: IO[bytes], name: str | None) -> tuple[bytes, list[str]]:
    """Return the sheet of that name, or the first that is not hidden, as CSV, and remarks on it.

    Raises Unreadable for what is no workbook, has a password, or is too large.
    """
    try:
        with ZipFile(file) as archive:
            package = Package(archive)
            hidden, shown, grid = (_ods if "content.xml" in package.parts else _xlsx)(package, name)
    except DAMAGE:
        raise Unreadable(UNFIT) from None
    each = (in_quotes(x) + (" (hidden)" if hidden[x] else "") for x in hidden)
    names = shortened(", ".join(each), LONGEST_LIST)
    if shown not in hidden:
        raise Unreadable(
            f"there is no sheet {in_quotes(shown)}; there are {names}" if names else "it has no sheet"
        )
    rows = _unmerged(package, grid)
    if not rows:
        raise Unreadable(f"sheet {in_quotes(shown)} of {names} is empty")
    width = 1 + max(map(max, rows.values()))
    package.count(width * len(rows))
    remarks = [f"sheet {in_quotes(shown)} of {names}"] if len(hidden) > 1 else []
    columns = {column for column in grid.hidden_columns if column < width}
    counts = {"hidden row": len(grid.hidden_rows & rows.keys()), "hidden column": len(columns)}
    if any(counts.values()):
        remarks.append(f"{' and '.join(counted(n, thing) for thing, n in counts.items() if n)}, too")
    buffer = StringIO()
    plain = csv.writer(buffer, lineterminator="\n")
    quoted = csv.writer(buffer, lineterminator="\n", quoting=csv.QUOTE_ALL)
    for number in sorted(rows):
        cells = [rows[number].get(column, "") for column in range(width)]
        is_like_comment = cells[0].lstrip().startswith("#")  # an error, as #DIV/0!
        (quoted if is_like_comment else plain).writerow(cells)
    return buffer.getvalue().encode(), remarks


def _unmerged(package: Package, grid: Grid) -> dict[int, dict[int, str]]:
    """Return rows in which a merged cell shows the same in each row; what lies under it does not count.

    A row that shows nothing else is left out.
    """
    shown, fillings = dict(grid.rows), list[tuple[int, int, str]]()
    for top, left, bottom, right in grid.merged:
        text = grid.rows.get(top, {}).get(left, "")
        package.count(bottom - top)
        for number in shown.keys() & range(top, bottom + 1):
            row, first = shown[number], left + 1 if number == top else left
            package.count(1 + len(row))
            shown[number] = {column: x for column, x in row.items() if not first <= column <= right}
            fillings.append((number, left, text))
    shown = {number: cells for number, cells in shown.items() if cells}
    for number, column, text in fillings:
        if text and number in shown:
            shown[number][column] = text
    return shown


def _chosen(hidden: Mapping[str, bool], wanted: str | None) -> str:
    """Return the sheet that is wanted, or the first that is not hidden, or the first."""
    return wanted or next(chain((x for x in hidden if not hidden[x]), hidden), "")


# .xlsx


def _xlsx(package: Package, wanted: str | None) -> tuple[dict[str, bool], str, Grid]:
    """Return whether each sheet is hidden, by its name, the name of that which is read, and its cells."""
    book = dict(package.links("").values()).get("officeDocument", "xl/workbook.xml")
    links, hidden, paths = package.links(book), dict[str, bool](), dict[str, str]()
    for _, name, sheet, _ in package.elements(book):
        if name == "sheet" and links[sheet["id"]][0] in ("worksheet", ""):  # and no chart
            hidden[sheet["name"]] = sheet.get("state", VISIBLE) != VISIBLE
            paths[sheet["name"]] = links[sheet["id"]][1]
    if (shown := _chosen(hidden, wanted)) not in paths:
        return hidden, shown, Grid()
    if paths[shown].lower() not in package.parts:
        raise LookupError
    parts = dict(links.values())
    codes, texts = _codes(package, parts.get("styles", "")), _texts(package, parts.get("sharedStrings", ""))
    return hidden, shown, _cells_of_xlsx(package, paths[shown], codes, texts)


def _codes(package: Package, path: str) -> list[str]:
    """Return the format of numbers in each style of cells."""
    own, numbers = dict[str, str](), list[str]()
    for parent, name, style, _ in package.elements(path):
        if name == "numFmt" and parent != "dxf":
            own[style["numFmtId"]] = style["formatCode"] or GENERAL
        elif name == "xf" and parent == "cellXfs":
            numbers.append(style.get("numFmtId", "0"))
    codes = BUILT_IN | own
    return [codes.get(x, f"format {x} of Excel") for x in numbers]


def _texts(package: Package, path: str) -> list[str]:
    """Return the texts that cells share, without the ruby characters above them."""
    texts, runs = list[str](), list[str]()
    for parent, name, _, text in package.elements(path):
        if name == "t" and parent in ("si", "r"):
            runs.append(text or "")
        elif name == "si":
            texts.append(_unescaped("".join(runs)))
            package.count(1, texts[-1])
            runs.clear()
    return texts


def _unescaped(text: str) -> str:
    """Return a text with the characters that _x000D_ and the like stand for, and with usual line breaks."""
    if "_x" in text:
        text = _ESCAPED.sub(lambda m: chr(int(m[1], 16)), text)
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _cells_of_xlsx(package: Package, path: str, codes: Sequence[str], texts: Sequence[str]) -> Grid:
    """Return the cells of a sheet. Those without a place follow the one before."""
    grid, row, column, cells, held, runs = Grid(), 1, -1, dict[int, str](), dict[str, str](), list[str]()
    for parent, name, attributes, text in package.elements(path):
        if name == "t" and parent in ("is", "r"):
            runs.append(text)
        elif parent == "c":
            held[name] = text
        elif name == "c":
            column += 1
            if place := attributes.get("r"):
                row, column = _place(place)
            if shown := _shown_in_xlsx(attributes, held, "".join(runs), codes, texts):
                cells[column] = shown
                package.count(1, shown)
            held.clear()
            runs.clear()
        elif name == "row":
            row = int(attributes.get("r") or row)
            if cells:
                grid.rows[row] = cells
            if attributes.get("hidden") in TRUE:
                grid.hidden_rows.add(row)
            row, column, cells = row + 1, -1, {}
        elif name == "mergeCell":
            first, _, last = attributes["ref"].partition(":")
            grid.merged.append((*_place(first), *_place(last or first)))
        elif name == "col" and attributes.get("hidden") in TRUE:
            first_column, last_column = int(attributes["min"]) - 1, int(attributes["max"])
            package.count(last_column - first_column)
            grid.hidden_columns.update(range(first_column, last_column))
    return grid


def _place(reference: str) -> tuple[int, int]:
    """Return the row and the column of a cell: of B3 3 and 1. Raises ValueError."""
    letters = reference.rstrip(digits)
    return int(reference[len(letters) :]), _column(letters)


@lru_cache(1024)
def _column(letters: str) -> int:
    if not re.fullmatch("[A-Z]{1,3}", letters):
        raise ValueError
    column = 0
    for letter in letters:
        column = 26 * column + int(letter, 36) - 9
    return column - 1


def _shown_in_xlsx(
    cell: Mapping[str, str], held: Mapping[str, str], inline: str, codes: Sequence[str], texts: Sequence[str]
) -> str:
    """Return what a cell shows; the formula if no value is stored with it. Raises ValueError, LookupError."""
    kind, value = cell.get("t", "n"), held.get("v", "")
    if not value and kind != "inlineStr" and not (kind == "str" and "v" in held):
        return f"={held['f']}" if "f" in held else ""
    code = codes[int(cell.get("s", 0))] if codes else GENERAL
    match kind:
        case "n":
            return shown_number(value, code)
        case "s" if value.isdecimal():
            return shown_text(texts[int(value)], code)
        case "str" | "inlineStr":
            return shown_text(_unescaped(value or inline), code)
        case "b":
            return "TRUE" if value in TRUE else "FALSE"
        case "d":
            return refused(value, "a date")
        case "e":
            return value
    raise ValueError  # there is no such kind, or text


# .ods


def _ods(package: Package, wanted: str | None) -> tuple[dict[str, bool], str, Grid]:
    """Return what `_xlsx` does, of a part that has all sheets."""
    hidden, styles, is_hidden = dict[str, bool](), set[str](), False
    shown, kept, grid, row, column, columns = "", Grid(), Grid(), 0, 0, 0
    paragraphs, cells = list[str](), dict[int, str]()
    for parent, name, attributes, text in package.elements("content.xml"):
        if name == "table-properties":
            is_hidden = attributes.get("display") == "false"
        elif name == "style" and is_hidden:
            styles.add(attributes.get("name", ""))
            is_hidden = False
        elif name == "p" and parent in CELLS:
            paragraphs.append(text)
        elif name in CELLS:
            last = column + _count(attributes, "columns-repeated")
            if name == CELLS[0] and (text := _shown_in_ods(attributes, "\n".join(paragraphs))):
                package.count(last - column)
                cells |= dict.fromkeys(range(column, last), text)
                bottom, right = (_count(attributes, f"{x}-spanned") - 1 for x in ("rows", "columns"))
                if bottom or right:
                    grid.merged.append((row, column, row + bottom, column + right))
            column = last
            paragraphs.clear()
        elif name == "table-row":
            last = row + _count(attributes, "rows-repeated")
            if cells:
                package.count(last - row, "".join(cells.values()))
                grid.rows.update(dict.fromkeys(range(row, last), cells))
                if attributes.get("visibility", VISIBLE) != VISIBLE:
                    grid.hidden_rows.update(range(row, last))
            row, column, cells = last, 0, {}
        elif name == "table-column":
            last = columns + _count(attributes, "columns-repeated")
            if attributes.get("visibility", VISIBLE) != VISIBLE:
                package.count(last - columns)
                grid.hidden_columns.update(range(columns, last))
            columns = last
        elif name == "table":
            package.count(4)
            sheet = attributes.get("name", "")
            if parent != "dde-link":
                hidden[sheet] = attributes.get("style-name") in styles
                shown = _chosen(hidden, wanted)
                kept = grid if sheet == shown else kept
            grid, row, columns = Grid(), 0, 0
    return hidden, shown, kept


def _count(attributes: Mapping[str, str], things: str) -> int:
    return int(attributes.get(f"number-{things}") or 1)


def _shown_in_ods(cell: Mapping[str, str], shown: str) -> str:
    """Return what a cell shows, a number in full; the formula if no value is stored with it."""
    match cell.get("value-type"):
        case "float" | "currency" | "percentage" as kind:
            return agreed(cell["value"], shown.strip(), kind == "percentage")
        case "time":
            return duration(cell["time-value"], shown)
        case "date":
            return refused(cell["date-value"], "a date")
        case "boolean":
            return shown or cell["boolean-value"].upper()
        case None if not shown and "formula" in cell:
            return f"={cell['formula']}"
    return shown or cell.get("string-value", "")
