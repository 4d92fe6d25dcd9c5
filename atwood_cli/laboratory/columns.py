"""Which columns of a table hold the quantities of runs, and what the headings of others may mean."""

import re
from collections import defaultdict
from collections.abc import Collection, Mapping, Sequence
from shlex import quote
from typing import Literal, NamedTuple

from ..numbers.text import in_quotes
from ..solver.scene import INPUTS, MASSES, Input, SceneError
from ..tables.cells import EMPTY, decimal_commas_in, has_unit
from ..tables.headings import (
    LIKE_SUM,
    LONGEST_HEADING,
    MASS_NAMES,
    NO_MASS,
    OF_COLUMN_BEFORE,
    Heading,
    Vocabulary,
    is_mass,
    is_unit,
    left_unread,
    listed,
    name_at_start,
    read_headings,
    recognised,
    refused,
    unit_within,
)
from ..tables.sheets import Sheet
from ..tables.sources import Unreadable

Kind = Literal["a", "time"]
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
LIKE_THEORY = re.compile("theo|teór|calc|expect|predict", re.IGNORECASE)
MEAN = r"\b(?:avg|average|mean|mittel(?:wert)?|moyenne|promedio|m[eé]dia)\b"
LIKE_MEAN = re.compile(MEAN, re.IGNORECASE)
LIKE_NUMBER = re.compile(r"\s*[-+±]?[.,]?\d+(?!\d|st|nd|rd|th)")
MASS_NOT_READ = "could be a mass that is not read; add it to m1 or m2"
LIKE_MASS = re.compile(
    r"(?:\b|[_ΔΣ∑])(?:(?<!\d )m\d*|mass\w*|masas?|масс\w*|gewicht\w*|weights?|hangers?|(?:over|pay)?load"
    r"|rider|beban|peso|poids|\w*груз\w*)(?:\b|_)",
    re.IGNORECASE,
)


class Columns(NamedTuple):
    """The columns of runs: those of quantities, what was measured, the numbers of rows, and decimal commas.

    Cells of the places ``with_units`` all have a unit. ``others`` says how columns of no quantity are read.
    """

    headings: Sequence[Heading]
    kind: Kind
    numbers: Sequence[int]
    comma: bool
    with_units: Collection[int]
    others: Sequence[str]

    @property
    def has_unit(self) -> set[str]:
        """Return the quantities whose heading, or each of whose cells, has a unit."""
        return {own.name for own in self.headings if own.unit or own.place in self.with_units}


def columns_of(
    sheet: Sheet, labels: Collection[str], given: Mapping[str, Input], named: Mapping[str, str]
) -> Columns:
    """Return the columns of runs. Raises Unreadable, SceneError."""
    names = [x for x in recognised(sheet.columns, VOCABULARY, named) if x not in (*labels, *OF_COLUMN_BEFORE)]
    if len(twice := [x for x in dict.fromkeys(names) if names.count(x) > 1]) > 1:
        raise Unreadable(f"tables stand side by side, with {listed(twice)} in each; put one below the other")
    headings = read_headings(sheet.columns, VOCABULARY, labels, named)
    places = [column.place for heading in headings for column in (heading, heading.u) if column]
    numbers = [] if 0 in places or not sheet.columns else _numbers_of_rows(sheet)
    known = {*places, 0} if numbers else {*places}
    unread = {  # columns of numbers, by their places: the heading, and the first number
        place: (column, cell)
        for place, (column, *cells) in enumerate(zip(sheet.columns, *sheet.rows, strict=True))
        if not (place in known or column in labels) and (cell := next(filter(LIKE_NUMBER.match, cells), ""))
    }
    kind = _kind_of_runs(sheet, headings, unread, given, named)
    _check_labels(headings, unread)
    others = [f"{in_quotes(sheet.columns[0])} as the numbers of rows"] if numbers else []
    others += [f"{in_quotes(column)} as a label" for column, _ in unread.values()]
    if kind == "a":  # a height has no effect
        headings = [heading for heading in headings if heading.name != "drop"]
    comma = decimal_commas_in(sheet.rows, places, sheet.separator)
    with_units = [x for x in places if all(row[x] in EMPTY or has_unit(row[x]) for row in sheet.rows)]
    return Columns(headings, kind, numbers or range(1, len(sheet.rows) + 1), comma, with_units, others)


def _numbers_of_rows(sheet: Sheet) -> list[int]:
    """Return the numbers of rows as the first column has them; none if it has others, or a mass."""
    cells, column = [row[0].strip() for row in sheet.rows], sheet.columns[0]
    is_mass = LIKE_MASS.search(column[:LONGEST_HEADING]) or unit_within(column, Heading(0, column, "m1"))
    if is_mass or not all(re.fullmatch("[0-9]{1,9}", cell) for cell in cells):
        return []
    numbers = [*map(int, cells)]
    return numbers if numbers == sorted({*numbers}) else []


def _kind_of_runs(
    sheet: Sheet,
    headings: Sequence[Heading],
    unread: Mapping[int, tuple[str, str]],
    given: Mapping[str, Input],
    named: Mapping[str, str],
) -> Kind:
    """Return what was measured, if runs have all columns. Raises Unreadable, SceneError."""
    names = {heading.name for heading in headings}
    measured = [heading for heading in headings if heading.name in MEASURED]
    kinds = {(bool(heading.number), heading.name): heading.column for heading in measured}
    if len(kinds) > 1:
        column, beside, *_ = (kinds[kind] for kind in sorted(kinds))
        why = "may be computed, as a mean is; number repeats, as t1, t2"
        raise refused(column, f"stands beside {in_quotes(beside)} and {why}")
    typed = [x for x in given if given[x].given is not None]
    has = {x: "a" if x == "drop" and "a" in names else x for x in typed}
    if double := [x for x in has if has[x] in names]:
        rule = f"is not needed, as the table has {has[double[0]]}; leave it out"
        raise SceneError(double[0], given[double[0]].given, rule)
    left, missing = [*unread.values()], [mass for mass in MASSES if mass not in {*names, *given}]
    if missing[1:]:  # M may be one of them
        left += [(heading.column, "") for heading in headings if heading.name == "M"]
    if not kinds:
        missing.append("a" if _fitting("a", left) and not _fitting("t", left) else "t")
    if not {"a", "drop"} & {*names, *given, *missing}:
        missing.append("drop")
    if missing:
        raise Unreadable(*_missing(missing, sheet, left, named))
    return "a" if "a" in names else "time"


def _missing(
    missing: Sequence[str], sheet: Sheet, left: Sequence[tuple[str, str]], named: Mapping[str, str]
) -> tuple[str, str]:
    """Return which columns runs need, those of the table, and options that name what is missing."""
    why = f"runs need m1, m2, and a, or t with the height of fall, drop; there are {listed(sheet.columns)}"
    why += "".join(f"; {remark}" for remark in sheet.remarks)
    why += f"; {', '.join(missing)} {'are' if missing[1:] else 'is'} missing"
    is_turned = left and all(LIKE_NUMBER.match(column) for column, _ in left)
    if is_turned or len(recognised([row[0] for row in sheet.rows], VOCABULARY)) > 1:
        return f"{why}: make each run a row, below headings, as m1 (g),m2 (g),t (s)", ""
    sums = [column for column in left if LIKE_SUM.search(column[0][:LONGEST_HEADING])]
    left = [column for column in left if column not in sums and not LIKE_THEORY.search(column[0])]
    left.sort(key=lambda column: bool(LIKE_MEAN.search(column[0])))
    speeds = [x for x in left if re.match(r"(v|speed)\b", x[0], re.IGNORECASE) or _fitting("speed", [x])]
    options, hints = [f"--column {quote(f'{name}={column}')}" for column, name in named.items()], ""
    for name in missing:
        fitting = _fitting(name, left)[: None if name in ("t", "a") else 1]
        if name == "t" and not fitting:  # columns that are numbered alone are repeats
            repeats = _alike([column for column in left if column not in speeds])
            fitting = repeats if repeats[1:] else []
        left = [column for column in left if column not in fitting]
        absent = "--drop HEIGHT" if name == "drop" else f"--column {name}=HEADING"
        options += [f"--column {quote(f'{name}={column}')}" for column, _ in fitting] or [absent]
        if name == "m1" and not fitting:
            compute = "; of a total and a difference, compute m1 and m2 as (total ± difference)/2"
            hints += compute if sums else ", or --m1 0 if m2 alone hangs"
        if name == "t" and not fitting and speeds:
            hints += "; of a speed v after a fall from rest by h, compute a = v²/(2h)"
    return why, f"; give {' '.join(options)}{hints}"


def _fitting(name: str, unread: Sequence[tuple[str, str]]) -> list[tuple[str, str]]:
    """Return the unread columns that may hold a quantity by name, or else by their unit or that of a cell."""
    meaning, ranks = Heading(0, "", SPELLINGS.get(name, name)), dict[tuple[str, str], int]()
    for column, cell in unread:
        unit = unit_within(column, meaning)
        fits = is_unit(unit or cell.lstrip("0123456789., "), meaning)
        is_named = 2 * (name_at_start(column, VOCABULARY) == meaning.name)
        is_mass = name in MASSES and LIKE_MASS.search(column[:LONGEST_HEADING])
        ranks[column, cell] = (is_named or int(fits or bool(is_mass))) if fits or not unit else 0
    return _alike([x for x, rank in ranks.items() if rank == max(ranks.values()) > 0])


def _alike(columns: Sequence[tuple[str, str]]) -> list[tuple[str, str]]:
    """Return the most columns whose headings differ in a number or a letter alone, as those of repeats do."""
    words = [re.sub(r"\b[A-Za-z]\b", "", re.sub(r"\d+(?:st|nd|rd|th)?", "#", x)) or x for x, _ in columns]
    most = max(words, key=words.count, default="")
    return [x for x, rest in zip(columns, words, strict=True) if rest == most]


def _check_labels(headings: Sequence[Heading], unread: Mapping[int, tuple[str, str]]) -> None:
    """Raise Unreadable for columns of numbers that could hold a quantity, and are no labels then."""
    measured = {own.place for own in headings if own.name in MEASURED}
    of_columns = {x: why for i, (x, _) in unread.items() if (why := _doubt(x, is_behind=i - 1 in measured))}
    doubts = defaultdict[str, list[str]](list)
    for column, why in of_columns.items():
        doubts[why].append(in_quotes(column))
    if doubts:
        way = "; give what hangs on both sides as --hanger" if MASS_NOT_READ in doubts else ""
        whys = (f"column{'s' if x[1:] else ''} {', '.join(x)} {why}" for why, x in doubts.items())
        raise Unreadable("; ".join(whys), f"{way}{left_unread(*of_columns)}")


def _doubt(column: str, is_behind: bool) -> str:
    """Return what a column of numbers could be, "" for a label; it may stand behind a measurement."""
    text, mass = column[:LONGEST_HEADING], Heading(0, "", "m1")
    unit = unit_within(column, mass)
    may_be_mass = is_mass(column) or ((not unit or is_unit(unit, mass)) and LIKE_MASS.search(text))
    uncertainty = "an uncertainty; name what of, as in 'u(t)'" * bool(LIKE_UNCERTAINTY.search(text))
    if column in INPUTS:
        return "would have no effect on a fit"
    if not column.strip() and is_behind:
        return "could be a measurement; give it a heading"
    if may_be_mass and LIKE_SUM.search(text):
        return f"{NO_MASS}, or {uncertainty}" if uncertainty else NO_MASS
    if uncertainty:
        return f"could be {uncertainty}"
    return MASS_NOT_READ if may_be_mass else ""
