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
DAY = 86_400  # seconds
DATES = {*range(14, 23), *range(27, 37), *range(45, 48), *range(50, 59)}
"""The formats of dates and times that every .xlsx has, by their numbers."""
PERCENTS = {9, 10}

Rows = dict[int, dict[int, str]]
"""The texts of cells that are not empty, by row and column."""
Merged = dict[tuple[int, int], int]
"""The last rows of merged cells, by the place of the first."""
Cells = tuple[Rows, Merged]
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
            rows, merged = sheets[shown][1]()
    except (BadZipFile, LookupError, ParseError, ValueError, zlib.error, EOFError, OSError) as error:
        why = getattr(error, "strerror", None) or str(error)
        raise Unreadable(f"it is damaged, has a password, or is no workbook: {why}") from None
    except (RuntimeError, NotImplementedError):
        raise Unreadable("it has a password") from None
    width = 1 + max((column for row in rows.values() for column in row), default=0)
    if width * len(rows) > MOST_CELLS:
        raise Unreadable(f"sheet {in_quotes(shown)} has more than {MOST_CELLS >> 20} million cells")
    _fill(rows, merged)
    buffer = StringIO()
    cells = ([rows[row].get(column, "") for column in range(width)] for row in sorted(rows))
    csv.writer(buffer, lineterminator="\n").writerows(cells)
    return buffer.getvalue().encode(), [f"sheet {in_quotes(shown)} of {names}"][: len(sheets) - 1]


def _part(archive: ZipFile, name: str) -> Element:
    """Return a part of a workbook. It has no more bytes than the archive says."""
    with archive.open(name) as part:
        content = b"".join(iter(partial(part.read, BLOCK_BYTES), b""))
    if b"<!DOCTYPE" in content:  # whose entities may be of any size
        raise ValueError(f"{name} has a document type")
    return fromstring(content)


def _fill(rows: Rows, merged: Merged) -> None:
    """Give cells that are merged over rows the text of the first."""
    above: dict[int, tuple[int, str]] = {}
    for number, row in sorted(rows.items()):
        for column, (last, text) in above.items():
            if number <= last:
                row.setdefault(column, text)
        above |= {x: (merged[number, x], row[x]) for x in row if merged.get((number, x), 0) > number}


def _local(tag: str) -> str:
    return tag.rpartition("}")[2]


def _get(element: Element, name: str) -> str:
    """Return an attribute by its name in any namespace, "" if it is not there."""
    return next((value for key, value in element.items() if _local(key) == name), "")


def _number(value: str, kind: str, suffix: str = "") -> str:
    """Return a number as it is shown in full: of 15 digits, in percent, or as a date or a time of day."""
    number = float(value)
    if kind == "date" and not 0 <= number < 1:
        return f"a date, day {number:.15g}"
    if kind == "date":
        minutes, seconds = divmod(round(number * DAY, 6), 60)
        return f"{minutes // 60:.0f}:{minutes % 60:02.0f}:{seconds:09.6f}".rstrip("0").rstrip(".")
    return f"{number * 100:.15g}%" if kind == "percent" else f"{number:.15g}{suffix}"


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
    kinds, texts = [("", "")], list[str]()
    with suppress(KeyError):  # a workbook may have neither
        kinds = _formats(part("xl/styles.xml"))
        texts = [_text_of_xlsx(text) for text in part("xl/sharedStrings.xml").iterfind(".//{*}si")]
    sheet, rows = part(path), Rows()
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
                value = _number(value, *kinds[int(_get(cell, "s") or 0)])
        if value or formula is not None:
            row, column = _place(_get(cell, "r"))
            rows.setdefault(row, {})[column] = value or f"={formula}"
    corners = [_get(merged, "ref").split(":") for merged in sheet.iterfind(".//{*}mergeCell")]
    return rows, {_place(first): _place(last)[0] for first, last in corners}


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


def _formats(styles: Element) -> list[tuple[str, str]]:
    """Return for each style of cells whether it shows dates or percent, and the words behind a number."""
    codes = {int(_get(x, "numFmtId")): _get(x, "formatCode") for x in styles.iterfind(".//{*}numFmt")}
    formats = []
    for style in styles.iterfind(".//{*}cellXfs/*"):
        number = int(_get(style, "numFmtId") or 0)
        code = codes.get(number, "").split(";")[0]
        bare = re.sub(r'"[^"]*"|\\.|\[[^hms\]][^\]]*\]|General|Standard', "", code)
        is_date = number in DATES or re.search("[dmyhs]", bare, re.IGNORECASE)
        is_percent = number in PERCENTS or "%" in bare
        words = re.search(r'(?:"([^"]*)"|\\(.))$', code)
        kind = "date" if is_date else "percent" if is_percent else ""
        formats.append((kind, (words[1] or words[2] or "") if words else ""))
    return formats


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
    rows, merged, number, count = Rows(), Merged(), 0, 0
    for row in table.iterfind(".//{*}table-row"):
        column, cells = 0, dict[int, str]()
        rows_alike = int(_get(row, "number-rows-repeated") or 1)
        for cell in row:
            text = "" if _local(cell.tag) == "covered-table-cell" else _text_of_ods(cell)
            repeat = int(_get(cell, "number-columns-repeated") or 1)
            merged[number, column] = number + int(_get(cell, "number-rows-spanned") or 1) - 1
            if text:
                count += repeat * rows_alike
                if count > MOST_CELLS:
                    raise Unreadable(f"it has more than {MOST_CELLS >> 20} million cells")
                cells |= dict.fromkeys(range(column, column + repeat), text)
            column += repeat
        rows |= {number + i: {**cells} for i in range(rows_alike if cells else 0)}
        number += rows_alike
    return rows, merged


def _text_of_ods(cell: Element) -> str:
    """Return what a cell holds, without its comments."""
    shown = "\n".join("".join(line.itertext()) for line in cell.iterfind("{*}p"))
    match next((value for key, value in cell.items() if key.endswith("office:1.0}value-type")), ""):
        case "float" | "currency":
            unit = re.search(r" ?[^\W\d_][^\d]*$", shown)
            return _number(_get(cell, "value"), "", unit[0] if unit else "")
        case "percentage":
            return _number(_get(cell, "value"), "percent")
        case "time":
            clock = re.fullmatch(r"PT(\d+)H(\d+)M([\d.,]+)S", _get(cell, "time-value"))
            return ":".join(clock.groups()) if clock else shown
        case "date":
            return f"a date, {_get(cell, 'date-value')}"
    formula = _get(cell, "formula")
    return shown or (f"={formula}" if formula else "")
