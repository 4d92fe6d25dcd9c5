"""Which columns of a table hold the quantities of runs, and what the headings of others may mean."""

import re
from collections.abc import Collection, Mapping, Sequence
from typing import Literal, NamedTuple

from ..solver.scene import INPUTS, Input
from ..tables.cells import EMPTY, decimal_commas_in, has_unit
from ..tables.headings import (
    LONGEST_HEADING,
    MASS_NAMES,
    Heading,
    Naming,
    Vocabulary,
    may_be_mass,
    meaning_of,
    named,
    places_of,
    recognised,
)
from ..tables.places import understood
from ..tables.sheets import Sheet
from ..tables.sources import Unreadable

Kind = Literal["a", "time"]
ONE_LOAD = "make each load rows of its own, or type one command a load, as --columns drop:m,-,t --m2 60g"
MEASURED = {"a": "acceleration", "time": "time"}
"""The quantities that are measured, which may be repeated in further columns."""
WORDS = {"m1": "m1", "m2": "m2", "drop": "drop h height", "a": "a acceleration", "time": "t time"}
"""The quantities of a run, by the words of headings."""
CONDITIONS = {"M": "M", "g": "g", "inertia": "inertia", "I": "I", "R": "R radius", "axle": "axle"}
"""The quantities that are the same in all runs: options, or columns with one number in all rows."""
SPELLINGS = {word: name for name, words in {**WORDS, **CONDITIONS}.items() for word in words.split()}
SPELLINGS |= {word.capitalize(): name for word, name in SPELLINGS.items()}
VOCABULARY = Vocabulary(MASS_NAMES | SPELLINGS, repeated=MEASURED, constant=CONDITIONS, uncertain=True)
LIKE_UNCERTAINTY = re.compile(
    r"±|\+/-|[Δδσ]|delta|sigma|\bu(?:[ _(]|$)|(?:\b|_)(?:err|unc|incert|fehler|s\.?d\b|d[tamh]\d?\b)"
    r"|(?:\b|_)(?:st(?:d|andard)\.?[ _-]?(?:dev|abw)|tolerance|unsicherheit)",
    re.IGNORECASE,
)


class Columns(NamedTuple):
    """The columns of runs: those of quantities, what was measured, and the numbers of rows.

    ``has_numbers`` says that the first column has these, ``comma`` that commas are decimal. Cells of the
    places ``with_units`` all have a unit. ``unread`` are other columns that differ between rows.
    """

    headings: Sequence[Heading]
    kind: Kind
    numbers: Sequence[int]
    has_numbers: bool
    comma: bool
    with_units: Collection[int]
    unread: Sequence[int]


def columns_of(sheet: Sheet, naming: Naming, given: Mapping[str, Input]) -> Columns:
    """Return the columns of runs. Raises NotUnderstood, Unreadable, SceneError."""
    for number, row in enumerate(sheet.rows, 1):
        if sum(cell[:1].isalpha() for cell in row) > 1 and len(recognised(row, VOCABULARY)) > 1:
            raise Unreadable(f"row {number} has headings of a second table; give it a file of its own")
    first, is_headed = [row[0] for row in sheet.rows], len(recognised(sheet.columns, VOCABULARY)) > 1
    if not (naming.words or is_headed) and len(recognised(first, VOCABULARY)) > 1:
        raise Unreadable("its runs are columns: make each run a row, below headings, as m1 (g),m2 (g),t (s)")
    is_load = sum(bool(re.fullmatch(r"\d*[.,]\d+", column)) for column in sheet.columns) > 1
    loads = [f"if headings that are numbers are loads, {ONE_LOAD}"] if is_load else []
    typed = {x: str(read.given) for x, read in given.items() if read.given is not None}
    asked = sheet._replace(remarks=[*sheet.remarks, *loads])
    headings = understood(asked, naming, VOCABULARY, _doubt, typed)
    places = places_of(headings)
    numbers = [] if 0 in places else sheet.numbers
    others = [i for i in range(1 if numbers else 0, len(sheet.columns)) if i not in places]
    unread = [i for i in others if sheet.has_numbers(i) or len({row[i].strip() for row in sheet.rows}) > 1]
    kind: Kind = "a" if any(own.name == "a" for own in headings) else "time"
    if kind == "a":  # a height has no effect
        headings = [heading for heading in headings if heading.name != "drop"]
    numeric = [i for i in range(len(sheet.columns)) if sheet.has_numbers(i)]
    comma = decimal_commas_in(sheet.rows, numeric, sheet.separator)
    with_units = [x for x in places if all(row[x] in EMPTY or has_unit(row[x]) for row in sheet.rows)]
    rows = numbers or range(1, len(sheet.rows) + 1)
    return Columns(headings, kind, rows, bool(numbers), comma, with_units, unread)


def _doubt(sheet: Sheet, place: int, _: Collection[str]) -> str:
    """Name a column of numbers that may be a mass, an uncertainty or a repeat, or has no effect."""
    if not sheet.has_numbers(place) or (place == 0 and sheet.numbers):
        return ""
    column, before = sheet.columns[place], sheet.columns[place - 1] if place else ""
    if place and not column.strip():  # as below a heading that is merged
        own = meaning_of(before, VOCABULARY)
        is_merged = not before.strip() and _doubt(sheet, place - 1, ()) != ""
        may_matter = own.name in MEASURED if own else is_merged
    else:
        may_matter = column in INPUTS or may_be_mass(column)
        may_matter |= bool(LIKE_UNCERTAINTY.search(column[:LONGEST_HEADING]))
    return named(column, place) if may_matter else ""
