"""Workbooks, .xlsx and .ods: a sheet as rows of texts, with numbers as they are shown in full.

Nothing in a workbook is run. A formula has the value that was stored with it, or else stands as a text, which
is an error of its cell where a number is read, as dates are. A cell merged over rows counts in each of them.
"""

import csv
import re
import zlib
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from functools import partial
from io import BytesIO, StringIO
from typing import IO
from xml.etree.ElementTree import Element, ParseError, fromstring
from zipfile import BadZipFile, ZipFile

from ..numbers.text import in_quotes
from ..solver.scene import SceneError
from .sources import BLOCK_BYTES, WORKBOOKS, Unreadable, opened

MOST_BYTES = 64 << 20
"""The most bytes of a workbook, unpacked."""
MOST_CELLS = 4 << 20
"""The most cells of a sheet, empty ones included: few bytes can stand for very many."""
DAY = 86_400  # seconds
DATES = {*range(14, 23), *range(27, 37), *range(45, 48), *range(50, 59)}
"""The formats of dates and times that every .xlsx has, by their numbers."""
PERCENTS = {9, 10}

Rows = dict[int, dict[int, str]]
"""The texts of cells that are not empty, by row and column."""
Sheets = dict[str, tuple[bool, Callable[[], Rows]]]
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
            there = ", ".join(f"{in_quotes(sheet)}{hidden[sheet]}" for sheet in sheets)
            shown = name or next((sheet for sheet in sheets if not hidden[sheet]), next(iter(sheets), ""))
            if shown not in sheets:
                raise Unreadable(f"there is no sheet {in_quotes(shown)}; there are {there}")
            rows = sheets[shown][1]()
    except (BadZipFile, LookupError, ParseError, ValueError, zlib.error, EOFError, OSError) as error:
        why = getattr(error, "strerror", None) or str(error)
        raise Unreadable(f"it is damaged, has a password, or is no workbook: {why}") from None
    except (RuntimeError, NotImplementedError):
        raise Unreadable("it has a password") from None
    width = 1 + max((column for row in rows.values() for column in row), default=0)
    if width * len(rows) > MOST_CELLS:
        raise Unreadable(f"sheet {in_quotes(shown)} has more than {MOST_CELLS >> 20} million cells")
    buffer = StringIO()
    cells = ([rows[row].get(column, "") for column in range(width)] for row in sorted(rows))
    csv.writer(buffer, lineterminator="\n").writerows(cells)
    return buffer.getvalue().encode(), [f"sheet {in_quotes(shown)} of {there}"][: len(sheets) - 1]


def _part(archive: ZipFile, name: str) -> Element:
    """Return a part of a workbook. It has no more bytes than the archive says."""
    with archive.open(name) as part:
        content = b"".join(iter(partial(part.read, BLOCK_BYTES), b""))
    if b"<!DOCTYPE" in content:  # whose entities may be of any size
        raise ValueError(f"{name} has a document type")
    return fromstring(content)


def _each(element: Element, *names: str) -> Iterator[Element]:
    """Yield the elements within one that have these names in any namespace."""
    return (inner for inner in element.iter() if _local(inner.tag) in names)


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
    targets = {_get(one, "Id"): _get(one, "Target") for one in part("xl/_rels/workbook.xml.rels")}
    sheets = Sheets()
    for sheet in _each(part("xl/workbook.xml"), "sheet"):
        target = targets[_get(sheet, "id")]
        path = target[1:] if target.startswith("/") else f"xl/{target}"
        sheets[_get(sheet, "name")] = _get(sheet, "state") not in ("", "visible"), partial(_rows, part, path)
    return sheets


def _rows(part: Callable[[str], Element], path: str) -> Rows:
    """Return the cells of a sheet of .xlsx."""
    kinds, texts = [("", "")], list[str]()
    try:
        kinds = _formats(part("xl/styles.xml"))
        texts = ["".join(_runs(text)) for text in _each(part("xl/sharedStrings.xml"), "si")]
    except KeyError:  # a workbook may have neither
        pass
    sheet, rows = part(path), Rows()
    for cell in _each(sheet, "c"):
        value = "".join(inner.text or "" for inner in _each(cell, "v"))
        formula = [f"={inner.text or ''}" for inner in _each(cell, "f")]
        match _get(cell, "t"):
            case "s":
                value = texts[int(value)]
            case "inlineStr":
                value = "".join(text for inner in _each(cell, "is") for text in _runs(inner))
            case "b":
                value = "TRUE" if value == "1" else "FALSE"
            case "" | "n" if value:
                value = _number(value, *kinds[int(_get(cell, "s") or 0)])
        if value or formula:
            row, column = _place(_get(cell, "r"))
            rows.setdefault(row, {})[column] = value or formula[0]
    for merged in _each(sheet, "mergeCell"):
        (top, column), (bottom, _) = (_place(corner) for corner in _get(merged, "ref").split(":"))
        for row in rows.keys() & set(range(top + 1, bottom + 1)):
            rows[row].setdefault(column, rows.get(top, {}).get(column, ""))
    return rows


def _runs(text: Element) -> Iterator[str]:
    """Yield the runs of a text, without the ruby characters above it."""
    for child in text:
        yield from (inner.text or "" for inner in _each(child, "t") if _local(child.tag) in ("t", "r"))


def _place(reference: str) -> tuple[int, int]:
    """Return the row and the column of a cell: of B3 3 and 1."""
    letters = reference.rstrip("0123456789")
    column = 0
    for letter in letters:
        column = 26 * column + int(letter, 36) - 9
    return int(reference[len(letters) :]), column - 1


def _formats(styles: Element) -> list[tuple[str, str]]:
    """Return for each style of cells whether it shows dates or percent, and the words behind a number."""
    codes = {int(_get(one, "numFmtId")): _get(one, "formatCode") for one in _each(styles, "numFmt")}
    formats = []
    for style in (style for cells in _each(styles, "cellXfs") for style in cells):
        number = int(_get(style, "numFmtId") or 0)
        code = codes.get(number, "").split(";")[0]
        bare = re.sub(r'"[^"]*"|\\.|\[[^hms\]][^\]]*\]|General|Standard', "", code)
        is_percent = number in PERCENTS or "%" in bare
        kind = (
            "date" if number in DATES or re.search("[dmyhs]", bare, re.IGNORECASE) else "percent" * is_percent
        )
        words = re.search(r'(?:"([^"]*)"|\\(.))$', code)
        formats.append((kind, (words[1] or words[2] or "") if words else ""))
    return formats


# .ods


def _ods(part: Callable[[str], Element]) -> Sheets:
    content = part("content.xml")
    hidden = {
        _get(style, "name")
        for style in _each(content, "style")
        if any(_get(inner, "display") == "false" for inner in _each(style, "table-properties"))
    }
    tables = _each(content, "table")
    return {_get(one, "name"): (_get(one, "style-name") in hidden, partial(_table, one)) for one in tables}


def _table(table: Element) -> Rows:
    """Return the cells of a sheet of .ods."""
    rows, number, count = Rows(), 0, 0
    above: dict[int, tuple[int, str]] = {}
    for row in _each(table, "table-row"):
        column, cells = 0, dict[int, str]()
        for cell in row:
            text, repeat = _text(cell), int(_get(cell, "number-columns-repeated") or 1)
            if _local(cell.tag) == "covered-table-cell" and above.get(column, (0, ""))[0] > number:
                text = above[column][1]
            if spanned := int(_get(cell, "number-rows-spanned") or 0):
                above[column] = number + spanned, text
            count += repeat if text else 0
            if count > MOST_CELLS:
                raise Unreadable(f"it has more than {MOST_CELLS >> 20} million cells")
            cells |= dict.fromkeys(range(column, column + repeat), text) if text else {}
            column += repeat
        repeat = int(_get(row, "number-rows-repeated") or 1)
        count += len(cells) * (repeat - 1)
        if cells and count <= MOST_CELLS:
            rows |= {number + i: cells for i in range(repeat)}
        number += repeat
    if count > MOST_CELLS:
        raise Unreadable(f"it has more than {MOST_CELLS >> 20} million cells")
    return rows


def _text(cell: Element) -> str:
    """Return what a cell of .ods holds, without its comments."""
    shown = "\n".join("".join(line.itertext()) for line in cell if _local(line.tag) == "p")
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
