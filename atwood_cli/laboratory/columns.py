"""Which columns of a table hold the quantities of runs, and what the headings of others may mean."""

import re
from collections.abc import Collection, Mapping, Sequence
from functools import partial
from typing import Literal, NamedTuple

from ..solver.scene import INPUTS, MASSES, Input, SceneError
from ..tables.cells import EMPTY, decimal_commas_in, has_unit
from ..tables.headings import (
    LONGEST_HEADING,
    MASS_NAMES,
    UNREAD,
    Heading,
    Naming,
    Vocabulary,
    is_unit,
    may_be_mass,
    meaning_of,
    named,
    read_headings,
    recognised,
    unit_within,
)
from ..tables.places import asked
from ..tables.sheets import Sheet
from ..tables.sources import Unreadable

Kind = Literal["a", "time"]
ONE_LOAD = "type one command a load, as --columns drop:m,-,t --m2 60g"
MEASURED = {"a": "acceleration", "time": "time"}
"""The quantities that are measured, which may be repeated in further columns."""
WORDS = {"m1": "m1", "m2": "m2", "drop": "drop h height", "a": "a acceleration", "time": "t time"}
"""The quantities of a run, by the words of headings."""
CONDITIONS = {"M": "M", "g": "g", "inertia": "inertia", "I": "I", "R": "R radius", "axle": "axle"}
"""The quantities that are the same in all runs: options, or columns with one number in all rows."""
SPELLINGS = {word: name for name, words in {**WORDS, **CONDITIONS}.items() for word in words.split()}
SPELLINGS |= {word.capitalize(): name for word, name in SPELLINGS.items()}
VOCABULARY = Vocabulary(MASS_NAMES | SPELLINGS, repeated=MEASURED, uncertain=True)
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
    may_matter = partial(_may_matter, sheet.columns)
    ask = partial(asked, sheet=sheet, naming=naming, vocabulary=VOCABULARY, given=given)
    ask = partial(ask, missing_of=_missing, may_matter=may_matter)
    if naming.is_open:
        raise ask("its columns are to be decided")
    try:
        said = naming.of(sheet.columns)
        headings = read_headings(sheet.columns, VOCABULARY, said)
    except Unreadable as error:
        if naming.words:
            raise SceneError("columns", None, f"does not fit: {error}") from None
        raise ask(str(error)) from None
    places = [column.place for heading in headings for column in (heading, heading.u) if column]
    numbers = [] if 0 in places or not sheet.columns else sheet.numbers
    others = [i for i in range(1 if numbers else 0, len(sheet.columns)) if i not in places]
    unread = [i for i in others if sheet.has_numbers(i) or len({row[i].strip() for row in sheet.rows}) > 1]
    names = {heading.name for heading in headings}
    if why := _lacking(names, given):
        if len(recognised([row[0] for row in sheet.rows], VOCABULARY)) > 1:
            raise Unreadable(f"{why}: make each run a row, below headings, as m1 (g),m2 (g),t (s)")
        if sum(bool(re.fullmatch(r"\d*[.,]\d+", column)) for column in sheet.columns) > 1:
            why += f"; if headings that are numbers are loads, {ONE_LOAD}"
        raise ask(why)
    not_said = [i for i in unread if sheet.has_numbers(i) and said[i] != UNREAD]
    rivals = {i: own.place for i in not_said for own in headings if _is_alike(sheet.columns[i], own)}
    if doubts := [i for i in not_said if i in rivals or may_matter(i)]:
        which = ", ".join(named(sheet.columns[i], i) for i in doubts)
        why = f"{which} may matter, and {'is' if len(doubts) == 1 else 'are'} not read"
        raise ask(why, doubtful={*rivals, *rivals.values()})
    kind: Kind = "a" if "a" in names else "time"
    if kind == "a":  # a height has no effect
        headings = [heading for heading in headings if heading.name != "drop"]
    comma = decimal_commas_in(sheet.rows, places, sheet.separator)
    with_units = [x for x in places if all(row[x] in EMPTY or has_unit(row[x]) for row in sheet.rows)]
    rows = numbers or range(1, len(sheet.rows) + 1)
    return Columns(headings, kind, rows, bool(numbers), comma, with_units, unread)


def _lacking(names: Collection[str], given: Mapping[str, Input]) -> str:
    """Return what runs lack, in words. Raises SceneError for what the table and the options both have."""
    if double := [x for x in given if x in names and given[x].given is not None]:
        rule = f"is not needed, as the table has {double[0]}; leave it out"
        raise SceneError(double[0], given[double[0]].given, rule)
    missing = ", ".join(_missing({*names, *given})).replace("m1", "m1 (0 if nothing hangs there)")
    if missing == "time, a":
        return "say which columns are t or a"
    missing = missing.replace("time, a, drop", "a (or t and drop)").replace("time, a", "t (or a)")
    return f"{missing} {'are' if ', ' in missing else 'is'} missing" if missing else ""


def _missing(has: Collection[str]) -> list[str]:
    """Return what runs need beside these: both masses, and a, or t with the height of fall."""
    missing = [mass for mass in MASSES if mass not in has]
    missing += ["time", "a"] if MEASURED.keys().isdisjoint(has) else []
    return missing if {"a", "drop"} & {*has} else [*missing, "drop"]


def _may_matter(columns: Sequence[str], place: int) -> bool:
    """Decide whether a column of numbers may be a mass, an uncertainty or a repeat, or has no effect."""
    column, before = columns[place], columns[place - 1] if place else ""
    if place and not column.strip():  # as below a heading that is merged
        own = meaning_of(before, VOCABULARY)
        return own.name in MEASURED if own else not before.strip() and _may_matter(columns, place - 1)
    return column in INPUTS or may_be_mass(column) or bool(LIKE_UNCERTAINTY.search(column[:LONGEST_HEADING]))


def _is_alike(column: str, own: Heading) -> bool:
    """Decide whether a heading has the name of a quantity that is read, too, so that one may be computed."""
    words, unit = re.split(r"[\W_]+", column[:LONGEST_HEADING]), unit_within(column, own)
    is_of_others = own.number or own.name in (
        *MASSES,
        *CONDITIONS,
    )  # as a mean of repeats, or a sum of masses
    has_name = own.name in map(VOCABULARY.names.get, words)
    return has_name and not is_of_others and (not unit or is_unit(unit, own))
