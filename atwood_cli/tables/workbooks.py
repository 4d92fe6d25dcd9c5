"""Workbooks, .xlsx and .ods: a sheet as rows of texts, with numbers as they are shown, in full.

Nothing in a workbook is run. A formula has the value that was stored with it, or else stands as a text, which
is an error of its cell where a number is read. So are a date, and a number in a format that is not wholly
understood. A cell merged over rows counts in each of them.
"""

import csv
import re
from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Mapping, Sequence
from contextlib import ExitStack
from functools import lru_cache
from io import BytesIO, StringIO
from itertools import chain
from posixpath import dirname
from string import digits
from typing import IO, NamedTuple
from zipfile import ZipFile

from ..numbers.text import counted, in_quotes, shortened
from ..solver.scene import SceneError
from .formats import BUILT_IN, DATE, FIRST_OWN, GENERAL, agreed, duration, shown_number, shown_text
from .packages import DAMAGE, MOST_BYTES, MOST_CELLS, TOO_MUCH_TEXT, UNFIT, Package, resolved
from .sources import WORKBOOKS, Unreadable, opened

MOST_ROWS, MOST_COLUMNS = 1 << 20, 1 << 14
"""The size of a sheet in Excel and in LibreOffice."""
LONGEST_LIST = 500
"""The most characters of a message that name sheets."""
TOO_MANY = f"it has more than {MOST_CELLS >> 20} million cells"
TRUE = ("1", "true")
VISIBLE = "visible"
CELLS = ("table-cell", "covered-table-cell")
_ESCAPED = re.compile("_x(000[9AaDd]|00[2-7][0-9A-Fa-f])_")
"""A tab, a line break, or a sign of ASCII in the texts of .xlsx."""


class Grid(NamedTuple):
    """The texts of a sheet by row and column, and what is merged or hidden.

    A merged cell has its first row and column, and its last.
    """

    rows: dict[int, dict[int, str]]
    merged: list[tuple[int, int, int, int]]
    hidden_rows: set[int]
    hidden_columns: set[int]


Book = tuple[dict[str, bool], str, Grid]
"""Whether a sheet is hidden, by its name; the name of the sheet that is read, and what it holds."""


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
    rows = _unmerged(grid.rows, grid.merged)
    if not rows:
        raise Unreadable(f"sheet {in_quotes(shown)} of {names} is empty")
    width = 1 + max(map(max, rows.values()))
    if width * len(rows) > MOST_CELLS:
        raise Unreadable(TOO_MANY)
    if sum(len(text) for cells in rows.values() for text in cells.values()) > MOST_BYTES:
        raise Unreadable(TOO_MUCH_TEXT)
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


def _unmerged(
    rows: Mapping[int, dict[int, str]], merged: Iterable[tuple[int, int, int, int]]
) -> dict[int, dict[int, str]]:
    """Return rows in which a merged cell shows the same in each row; what lies under it does not count.

    A row that shows nothing else is left out. Raises Unreadable for too many merged cells.
    """
    shown, numbers, fillings, steps = dict(rows), sorted(rows), list[tuple[int, int, str]](), 0
    for top, left, bottom, right in merged:
        text = rows.get(top, {}).get(left, "")
        for number in numbers[bisect_left(numbers, top) : bisect_right(numbers, bottom)]:
            row, first = shown[number], left + 1 if number == top else left
            shown[number] = {column: x for column, x in row.items() if not first <= column <= right}
            fillings.append((number, left, text))
            steps += 1 + len(row)
            if steps > MOST_CELLS:
                raise Unreadable("it has too many merged cells, or they overlap")
    shown = {number: cells for number, cells in shown.items() if cells}
    for number, column, text in fillings:
        if text and number in shown:
            shown[number][column] = text
    return shown


def _chosen(hidden: Mapping[str, bool], wanted: str | None) -> str:
    """Return the sheet that is wanted, or the first that is not hidden, or the first."""
    return wanted or next(chain((x for x in hidden if not hidden[x]), hidden), "")


# .xlsx


def _xlsx(package: Package, wanted: str | None) -> Book:
    """Read the names of the sheets, and the cells of one."""
    book = dict(package.links("").values()).get("officeDocument", "xl/workbook.xml")
    links, hidden, paths = package.links(book), dict[str, bool](), dict[str, str]()
    for _, name, sheet, _ in package.elements(book):
        if name == "sheet" and links[sheet["id"]][0] in ("worksheet", ""):  # and no chart
            hidden[sheet["name"]] = sheet.get("state", VISIBLE) != VISIBLE
            paths[sheet["name"]] = links[sheet["id"]][1]
    if (shown := _chosen(hidden, wanted)) not in paths:
        return hidden, shown, Grid({}, [], set(), set())
    if paths[shown].lower() not in package.parts:
        raise LookupError
    usual = {kind: resolved(dirname(book), f"{kind}.xml") for kind in ("styles", "sharedStrings")}
    parts = usual | dict(links.values())
    codes, texts = _codes(package, parts["styles"]), _texts(package, parts["sharedStrings"])
    return hidden, shown, _cells_of_xlsx(package, paths[shown], codes, texts)


def _codes(package: Package, path: str) -> list[str]:
    """Return the format of numbers in each style of cells."""
    own, numbers = dict[str, str](), list[str]()
    for parent, name, style, _ in package.elements(path):
        if name == "numFmt" and parent != "dxf":
            own[style["numFmtId"]] = style["formatCode"] or GENERAL
        elif name == "xf" and parent == "cellXfs":
            numbers.append(style.get("numFmtId", "0"))
    others = {x: GENERAL if int(x) >= FIRST_OWN else f"number {x} of Excel's formats" for x in numbers}
    codes = others | BUILT_IN | own
    return [codes[x] for x in numbers]


def _texts(package: Package, path: str) -> list[str]:
    """Return the texts that cells share, without the ruby characters above them."""
    texts, runs = list[str](), list[str]()
    for parent, name, _, text in package.elements(path):
        if name == "t" and parent in ("si", "r"):
            runs.append(text or "")
        elif name == "si":
            texts.append(_unescaped("".join(runs)))
            runs.clear()
            if len(texts) > MOST_CELLS:
                raise Unreadable(TOO_MANY)
    return texts


def _unescaped(text: str) -> str:
    """Return a text with the characters that _x000D_ and the like stand for, and with usual line breaks."""
    if "_x" in text:
        text = _ESCAPED.sub(lambda m: chr(int(m[1], 16)), text)
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _cells_of_xlsx(package: Package, path: str, codes: Sequence[str], texts: Sequence[str]) -> Grid:
    """Return the cells of a sheet. Those without a place follow the one before."""
    grid, row, column, held, runs = Grid({}, [], set(), set()), 0, -1, dict[str, str](), list[str]()
    for parent, name, attributes, text in package.elements(path, begins=["row"]):
        if text is None:
            row, column = int(attributes.get("r") or row + 1), -1
            if attributes.get("hidden") in TRUE:
                grid.hidden_rows.add(row)
        elif name == "t" and parent in ("is", "r"):
            runs.append(text)
        elif parent == "c":
            held[name] = text
        elif name == "c":
            column += 1
            if place := attributes.get("r"):
                row, column = _place(place)
            if shown := _shown_in_xlsx(attributes, held, "".join(runs), codes, texts):
                grid.rows.setdefault(row, {})[column] = shown
            held.clear()
            runs.clear()
        elif name == "mergeCell":
            first, _, last = attributes["ref"].partition(":")
            grid.merged.append((*_place(first), *_place(last or first)))
        elif name == "col" and attributes.get("hidden") in TRUE:
            most = min(int(attributes["max"]), MOST_COLUMNS)
            grid.hidden_columns.update(range(int(attributes["min"]) - 1, most))
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
            return f"{DATE}{value}"
        case "e":
            return value
    raise ValueError  # there is no such kind, or text


# .ods


def _ods(package: Package, wanted: str | None) -> Book:
    """Read the names of the sheets and, in one go, the cells of one."""
    hidden, styles, is_hidden, shown = dict[str, bool](), set[str](), False, wanted or ""
    grid, row, column, columns, is_shown = Grid({}, [], set(), set()), 0, 0, 0, False
    paragraphs, cells = list[str](), dict[int, str]()
    for parent, name, attributes, text in package.elements("content.xml", begins=["table"]):
        if text is None and parent != "dde-link":
            sheet = attributes.get("name", "")
            hidden[sheet] = attributes.get("style-name") in styles
            if not shown and not hidden[sheet]:
                shown = sheet
            is_shown = sheet == shown
        elif name == "table-properties":
            is_hidden = attributes.get("display") == "false"
        elif name == "style" and is_hidden:
            styles.add(attributes.get("name", ""))
            is_hidden = False
        elif name == "table":
            is_shown = False
        elif name == "p" and parent in CELLS:
            paragraphs.append(text or "")
        elif name in CELLS:
            last = column + _count(attributes, "columns-repeated")
            if is_shown and name == CELLS[0] and (text := _shown_in_ods(attributes, "\n".join(paragraphs))):
                if last > MOST_COLUMNS:
                    raise Unreadable(TOO_MANY)
                cells |= dict.fromkeys(range(column, last), text)
                bottom, right = (_count(attributes, f"{x}-spanned") - 1 for x in ("rows", "columns"))
                if bottom or right:
                    grid.merged.append((row, column, row + bottom, column + right))
            column = last
            paragraphs.clear()
        elif is_shown and name == "table-row":
            last = row + _count(attributes, "rows-repeated")
            if cells and last > MOST_ROWS:
                raise Unreadable(TOO_MANY)
            if cells:
                grid.rows.update(dict.fromkeys(range(row, last), cells))
                if attributes.get("visibility", VISIBLE) != VISIBLE:
                    grid.hidden_rows.update(range(row, last))
            row, column, cells = last, 0, {}
        elif is_shown and name == "table-column":
            last = columns + _count(attributes, "columns-repeated")
            if attributes.get("visibility", VISIBLE) != VISIBLE:
                grid.hidden_columns.update(range(columns, min(last, MOST_COLUMNS)))
            columns = last
    if hidden and not shown:
        return _ods(package, _chosen(hidden, None))
    return hidden, shown, grid


def _count(attributes: Mapping[str, str], things: str) -> int:
    return int(attributes.get(f"number-{things}") or 1)


def _shown_in_ods(cell: Mapping[str, str], shown: str) -> str:
    """Return what a cell shows, a number in full; the formula if no value is stored with it."""
    match cell.get("value-type"):
        case "float" | "currency" | "percentage" as kind:
            if shown.strip():
                return agreed(cell["value"], shown.strip())
            return shown_number(cell["value"], {"float": GENERAL, "percentage": "0%"}.get(kind, "¤"))
        case "time":
            return duration(cell["time-value"], shown)
        case "date":
            return f"{DATE}{cell['date-value']}"
        case "boolean":
            return shown or cell["boolean-value"].upper()
        case None if not shown and "formula" in cell:
            return f"={cell['formula']}"
    return shown or cell.get("string-value", "")
