"""Workbooks, .xlsx and .ods: a sheet as rows of texts, with numbers as they are shown in full.

Nothing in a workbook is run. A formula has the value that was stored with it, or else stands as a text, which
is an error of its cell where a number is read, as dates are. A cell merged over rows counts in each of them.
"""

import csv
import re
import zlib
from collections.abc import Callable
from contextlib import ExitStack, suppress
from functools import partial
from io import BytesIO, StringIO
from typing import IO
from xml.etree.ElementTree import Element, ParseError, fromstring
from zipfile import BadZipFile, ZipFile

from ..numbers.text import in_quotes
from ..solver.scene import SceneError
from .sources import BLOCK_BYTES, WORKBOOKS, Unreadable, opened

MOST_BYTES = 64 << 20
"""The most bytes of a workbook, or a table of runs, unpacked: a laboratory has thousands of rows."""
MOST_CELLS = 4 << 20
"""The most cells of a sheet, empty ones included: few bytes can stand for very many."""
TOO_MANY = f"it has more than {MOST_CELLS >> 20} million cells"
DAY = 86_400  # seconds
DAMAGE = (BadZipFile, LookupError, ParseError, ValueError, zlib.error, EOFError, OSError, RuntimeError)
"""What is raised for a part that is lacking, damaged, or has a password."""
FORMATS = {9: "%", 10: "%"} | dict.fromkeys((*range(14, 23), *range(27, 37), 45, 46, 47, *range(50, 59)), "h")
"""The formats of percent, and of dates and times, that every .xlsx has, by their numbers."""

Place = tuple[int, int]
"""The row and the column of a cell."""
Cells = tuple[dict[Place, str], dict[Place, int]]
"""The texts of cells that are not empty, and of merged cells the last row, by the place of the first."""
Sheets = dict[str, tuple[bool, Callable[[], Cells]]]
"""Whether a sheet is hidden, and what reads it, by its name."""


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
    """Return the sheet of that name, or the first that is not hidden, as CSV, and a remark if there are more.

    Raises Unreadable for what is no workbook, has a password, or is too large.
    """
    try:
        with ZipFile(file) as archive:
            parts = archive.infolist()
            if sum(part.file_size for part in parts) > MOST_BYTES:
                raise Unreadable(f"it is larger than {MOST_BYTES >> 20} MB, unpacked")
            sheets = (_xlsx if "xl/workbook.xml" in archive.namelist() else _ods)(partial(_part, archive))
            hidden = {sheet: " (hidden)" if is_hidden else "" for sheet, (is_hidden, _) in sheets.items()}
            names = ", ".join(f"{in_quotes(sheet)}{hidden[sheet]}" for sheet in sheets)
            shown = name or next((sheet for sheet in sheets if not hidden[sheet]), next(iter(sheets), ""))
            if shown not in sheets:
                raise Unreadable(f"there is no sheet {in_quotes(shown)}; there are {names}")
            cells, merged = sheets[shown][1]()
    except DAMAGE as error:
        why = getattr(error, "strerror", None) or str(error)
        raise Unreadable(f"it is damaged, has a password, or is no workbook: {why}") from None
    if not cells:
        raise Unreadable(f"sheet {in_quotes(shown)} of {names} is empty")
    rows = sorted({row for row, _ in cells})
    columns = range(1 + max(column for _, column in cells))
    if len(columns) * len(rows) > MOST_CELLS:
        raise Unreadable(TOO_MANY)
    for first in [first for first in merged if first in cells]:
        for row in rows:
            if first[0] < row <= merged[first]:
                cells.setdefault((row, first[1]), cells[first])
    buffer = StringIO()
    lines = ([cells.get((row, column), "") for column in columns] for row in rows)
    csv.writer(buffer, lineterminator="\n").writerows(lines)
    remarks = [f"sheet {in_quotes(shown)} of {names}"] if len(sheets) > 1 else []
    return buffer.getvalue().encode(), remarks


def _part(archive: ZipFile, name: str) -> Element:
    """Return a part of a workbook. It has no more bytes than the archive says."""
    with archive.open(name) as part:
        content = b"".join(iter(partial(part.read, BLOCK_BYTES), b""))
    if b"<!DOCTYPE" in content:  # whose entities may be of any size
        raise ValueError(f"{name} has a document type")
    return fromstring(content)


def _local(tag: str) -> str:
    return tag.rpartition("}")[2]


def _get(element: Element, name: str) -> str:
    """Return an attribute by its name in any namespace, "" if it is not there."""
    return next((value for key, value in element.items() if _local(key) == name), "")


def _number(value: str, code: str = "") -> str:
    """Return a number of 15 digits as its format shows it: in percent, with a unit, as a date or a time."""
    number = float(value)
    signs = re.sub(r'"[^"]*"|\\.|\[[^hms\]][^\]]*\]|General|Standard', "", code)
    if re.search("[dmyhs]", signs, re.IGNORECASE):
        if not 0 <= number < 1:
            return f"a date, day {number:.15g}"
        minutes, seconds = divmod(round(number * DAY, 6), 60)
        return f"{minutes // 60:.0f}:{minutes % 60:02.0f}:{seconds:09.6f}".rstrip("0").rstrip(".")
    if "%" in signs:
        return f"{number * 100:.15g}%"
    unit = re.search(r'(?:"([^"]*)"|\\(.))$', code)
    return f"{number:.15g}{(unit[1] or unit[2] or '') if unit else ''}"


# .xlsx


def _xlsx(part: Callable[[str], Element]) -> Sheets:
    targets = {_get(link, "Id"): _get(link, "Target") for link in part("xl/_rels/workbook.xml.rels")}
    sheets = Sheets()
    for sheet in part("xl/workbook.xml").iterfind(".//{*}sheet"):
        target = targets[_get(sheet, "id")]
        path = target[1:] if target.startswith("/") else f"xl/{target}"
        is_hidden = _get(sheet, "state") not in ("", "visible")
        sheets[_get(sheet, "name")] = is_hidden, partial(_cells_of_xlsx, part, path)
    return sheets


def _cells_of_xlsx(part: Callable[[str], Element], path: str) -> Cells:
    formats, texts = [""], list[str]()
    with suppress(KeyError):  # a workbook may have neither
        formats = _formats(part("xl/styles.xml"))
        texts = [_text_of_xlsx(text) for text in part("xl/sharedStrings.xml").iterfind(".//{*}si")]
    sheet, cells = part(path), dict[Place, str]()
    for cell in sheet.iterfind(".//{*}c"):
        value, formula = cell.findtext("{*}v", ""), cell.findtext("{*}f")
        match _get(cell, "t"):
            case "s":
                value = texts[int(value)]
            case "inlineStr":
                value = "".join(map(_text_of_xlsx, cell.iterfind("{*}is")))
            case "b":
                value = "TRUE" if value == "1" else "FALSE"
            case "" | "n" if value:
                value = _number(value, formats[int(_get(cell, "s") or 0)])
        if value or formula is not None:
            cells[_place(_get(cell, "r"))] = value or f"={formula}"
    corners = [_get(merged, "ref").split(":") for merged in sheet.iterfind(".//{*}mergeCell")]
    return cells, {_place(first): _place(last)[0] for first, last in corners}


def _text_of_xlsx(text: Element) -> str:
    """Return a text, without the ruby characters above it."""
    return "".join(run.text or "" for path in ("{*}t", "{*}r/{*}t") for run in text.iterfind(path))


def _place(reference: str) -> tuple[int, int]:
    """Return the row and the column of a cell: of B3 3 and 1."""
    letters = reference.rstrip("0123456789")
    column = 0
    for letter in letters:
        column = 26 * column + int(letter, 36) - 9
    return int(reference[len(letters) :]), column - 1


def _formats(styles: Element) -> list[str]:
    """Return the format of numbers in each style of cells."""
    named = {
        _get(x, "numFmtId"): _get(x, "formatCode").split(";")[0] for x in styles.iterfind(".//{*}numFmt")
    }
    numbers = (_get(style, "numFmtId") or "0" for style in styles.iterfind(".//{*}cellXfs/*"))
    return [named.get(number) or FORMATS.get(int(number), "") for number in numbers]


# .ods


def _ods(part: Callable[[str], Element]) -> Sheets:
    content = part("content.xml")
    hidden = {
        _get(style, "name")
        for style in content.iterfind(".//{*}style")
        if any(_get(x, "display") == "false" for x in style.iterfind("{*}table-properties"))
    }
    tables = content.iterfind(".//{*}table")
    return {_get(x, "name"): (_get(x, "style-name") in hidden, partial(_cells_of_ods, x)) for x in tables}


def _cells_of_ods(table: Element) -> Cells:
    cells, merged, row = dict[Place, str](), dict[Place, int](), 0
    for line in table.iterfind(".//{*}table-row"):
        column, rows = 0, int(_get(line, "number-rows-repeated") or 1)
        for cell in line:
            columns = int(_get(cell, "number-columns-repeated") or 1)
            if text := "" if _local(cell.tag) == "covered-table-cell" else _text_of_ods(cell):
                if len(cells) + rows * columns > MOST_CELLS:
                    raise Unreadable(TOO_MANY)
                cells |= {(row + i, column + j): text for i in range(rows) for j in range(columns)}
                if spanned := _get(cell, "number-rows-spanned"):
                    merged[row, column] = row + int(spanned) - 1
            column += columns
        row += rows
    return cells, merged


def _text_of_ods(cell: Element) -> str:
    """Return what a cell holds, without its comments."""
    shown = "\n".join("".join(line.itertext()) for line in cell.iterfind("{*}p"))
    match _get(cell, "value-type"):
        case "float" | "currency":
            unit = re.search(r" ?[^\W\d_][^\d]*$", shown)
            return _number(_get(cell, "value")) + (unit[0] if unit else "")
        case "percentage":
            return _number(_get(cell, "value"), "%")
        case "time":
            return ":".join(re.findall(r"[\d.,]+", _get(cell, "time-value")))  # PT00H00M03.99S
        case "date":
            return f"a date, {_get(cell, 'date-value')}"
    formula = _get(cell, "formula")
    return shown or (f"={formula}" if formula else "")
