"""Cells of tables as exact numbers, with the units and uncertainties that their headings state."""

import re
from collections.abc import Collection, Iterable, Sequence
from fractions import Fraction
from typing import Any

from ..numbers.text import in_quotes
from ..reading.inputs import read_input
from ..reading.units import PERCENT, SUM
from ..solver.scene import Input, SceneError
from .headings import Heading

EMPTY = ("", "NA", "NULL", "null")
"""The texts of cells without a number: R and databases write a word."""
OWN_UNIT = re.compile(r"(?![eE][+-]?\d)[^\W\d_]|[°:]")
"""The sign that a cell has a unit: a letter that is not an exponent's, or the colon of minutes."""
BARE = "cells of {} without a unit are read in {}."
SHOWN_AS = " shown as "
"""Stands between the number of a cell of a workbook and the way it is shown, if this cannot be understood."""
PART_THOUSANDS = r"^\s*[+-]?[1-9]\d{0,2}(,\d{3})+(\.\d*)?\s*$"


def decimal_commas_in(rows: Iterable[Sequence[str]], places: Collection[int], separator: str) -> bool:
    """Decide whether commas in those places of rows are decimal.

    In a table with semicolons all are. In one with tabs they are, unless each comma separates thousands.
    """
    if separator in ("", ","):
        return False
    with_comma = [cell for row in rows for place in places if (cell := row[place]) and "," in cell]
    return any(separator == ";" or not re.match(PART_THOUSANDS, cell) for cell in with_comma)


def has_unit(cell: object) -> bool:
    """Decide whether a cell has a unit of its own, or a name for a number."""
    return isinstance(cell, str) and bool(OWN_UNIT.search(cell))


def pointed(name: str, cell: str, comma: bool) -> str:
    """Return a cell with a decimal point, without blanks around it. Raises SceneError."""
    number, is_shown, way = cell.partition(SHOWN_AS)
    if is_shown:
        raise SceneError(
            name, number, f"is shown as {in_quotes(way)}; write a plain number, and its unit in the heading"
        )
    if comma and "." in cell:
        raise SceneError(name, cell, "has a point in a table of decimal commas; write all alike")
    return (cell.replace(",", ".") if comma else cell).strip()


def read_cell(heading: Heading, row: Sequence[Any], comma: bool) -> Input | None:
    """Return the number in a column, exact and in SI units, with its uncertainty; None if the cell is empty.

    A unit in the cell goes before the unit of the heading. Raises SceneError.
    """
    cell = row[heading.place]
    text = pointed(heading.name, cell, comma) if isinstance(cell, str) else cell
    if text is None or text in EMPTY:
        return None
    try:
        read = read_input(heading.name, text)
    except SceneError as error:
        raise SceneError(heading.name, cell, error.rule) from None
    if isinstance(text, str) and not read.uncertainty and re.search(SUM, text):
        rule = "is a sum, which options alone may be; write one number, an uncertainty as 1.00±0.02"
        raise SceneError(heading.name, cell, rule)
    if not has_unit(text):
        number, spread = (x * heading.read.size for x in (read.number, read.uncertainty))
        read = read._replace(number=number, uncertainty=spread, unit=heading.read)
    spread = read.uncertainty
    if heading.u and (u := row[heading.u.place].strip()) not in EMPTY:
        if spread:
            raise SceneError(heading.u.column, u, f"is a second uncertainty, beside {in_quotes(cell)}")
        spread = _read_uncertainty(heading.u, u, read.number, comma)
    elif heading.stated and not spread:
        spread = _read_uncertainty(heading._replace(unit=""), heading.stated, read.number, False)
    return read._replace(uncertainty=spread, given=cell)


def _read_uncertainty(heading: Heading, cell: str, value: Fraction, comma: bool) -> Fraction:
    """Return the uncertainty of a value, from the cell in its column of uncertainties. Raises SceneError."""
    number = pointed(heading.column, cell, comma).lstrip("± ")
    relative = number.endswith(PERCENT) or heading.unit == PERCENT
    number = number.removesuffix(PERCENT)
    try:
        spread = read_input(heading.name, f"1±{number}{PERCENT if relative else ''}").uncertainty
    except SceneError:
        raise SceneError(heading.column, cell, "is not an uncertainty; write it like 0.02 or 2%") from None
    if relative:
        return spread * abs(value)
    return spread if has_unit(number) else spread * heading.read.size
