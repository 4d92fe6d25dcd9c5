"""Which columns of a table hold the quantities of runs, and what the headings of others may mean."""

import re
from collections.abc import Collection, Mapping, Sequence
from shlex import quote
from typing import Literal

from ..numbers.text import in_quotes
from ..solver.scene import INPUTS, MASSES, Input, SceneError
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
LIKE_NUMBER = re.compile(r"\s*[-+±]?[.,]?\d")
LIKE_MASS = re.compile(
    r"(?:\b|_)(?:(?<!\d )m\d*|mass\w*|masas?|масс\w*|gewicht\w*|weights?|hangers?|(?:over|pay)?load|rider"
    r"|beban|peso|poids|\w*груз\w*)(?:\b|_)",
    re.IGNORECASE,
)


def headings_of(sheet: Sheet, labels: Collection[str], named: Mapping[str, str]) -> list[Heading]:
    """Return the columns that hold a quantity. Raises Unreadable, also for tables side by side."""
    known = [x for x in recognised(sheet.columns, VOCABULARY, named) if x not in (*labels, *OF_COLUMN_BEFORE)]
    if len(twice := [x for x in dict.fromkeys(known) if known.count(x) > 1]) > 1:
        raise Unreadable(f"tables stand side by side, with {listed(twice)} in each; put one below the other")
    return read_headings(sheet.columns, VOCABULARY, labels, named)


def numbers_of_rows(sheet: Sheet, headings: Sequence[Heading]) -> list[int]:
    """Return the numbers of rows as the first column has them; none if it has others, or a quantity."""
    cells = [row[0].strip() for row in sheet.rows]
    column = sheet.columns[0]
    is_read = any(heading.place == 0 for heading in headings)
    is_mass = LIKE_MASS.search(column[:LONGEST_HEADING]) or unit_within(column, Heading(0, column, "m1"))
    if is_read or is_mass or not all(re.fullmatch("[0-9]{1,9}", cell) for cell in cells):
        return []
    numbers = [*map(int, cells)]
    return numbers if numbers == sorted({*numbers}) else []


def kind_of_runs(
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
        left = [column for column in left if column not in fitting]
        absent = "--drop HEIGHT" if name == "drop" else f"--column {name}=HEADING"
        options += [f"--column {quote(f'{name}={column}')}" for column, _ in fitting] or [absent]
        if name == "m1" and not fitting:
            compute = "; of a total and a difference, compute m1 and m2 as (total ± difference)/2"
            hints += compute if sums else ", or --m1 0 if m2 alone hangs"
        if name == "t" and not fitting and left:
            compute = "; of a speed v after a fall from rest by h, compute a = v²/(2h)"
            hints += compute if speeds else "; name each column of repeats so" if left[1:] else ""
    return why, f"; give {' '.join(options)}{hints}"


def _fitting(name: str, unread: Sequence[tuple[str, str]]) -> list[tuple[str, str]]:
    """Return the unread columns that may hold a quantity, by name, or else by their unit or that of a cell.

    Of several, the headings differ from the first in a number or a letter alone, as those of repeats do.
    """
    meaning, ranks = Heading(0, "", SPELLINGS.get(name, name)), dict[tuple[str, str], int]()
    for column, cell in unread:
        unit = unit_within(column, meaning)
        fits = is_unit(unit or cell.lstrip("0123456789., "), meaning)
        is_named = 2 * (name_at_start(column, VOCABULARY) == meaning.name)
        is_mass = name in MASSES and LIKE_MASS.search(column[:LONGEST_HEADING])
        ranks[column, cell] = (is_named or int(fits or bool(is_mass))) if fits or not unit else 0
    best = [x for x, rank in ranks.items() if rank == max(ranks.values()) > 0]
    alike = [re.sub(r"\d+(?:st|nd|rd|th)?|\b[A-Za-z]\b", "", column) for column, _ in best]
    return [x for x, words in zip(best, alike, strict=True) if words == alike[0]]


def check_labels(headings: Sequence[Heading], unread: Mapping[int, tuple[str, str]]) -> None:
    """Raise Unreadable for a column of numbers that could hold a quantity, and is no label then."""
    measured = {own.place for own in headings if own.name in MEASURED}
    mass = Heading(0, "", "m1")
    uncertain = [column for column, _ in unread.values() if LIKE_UNCERTAINTY.search(column[:LONGEST_HEADING])]
    for place, (column, _) in unread.items():
        unit = unit_within(column, mass)
        if column in INPUTS:
            raise refused(column, "has no effect on a fit")
        if not column.strip() and place - 1 in measured:
            raise refused(column, "has numbers and no heading, behind a measurement; give it one")
        if column in uncertain:
            others = f", as could {listed(uncertain[1:])}" if uncertain[1:] else ""
            difference = " or a difference" if LIKE_SUM.search(column[:LONGEST_HEADING]) else ""
            raise refused(column, f"could be an uncertainty{difference}{others}; name what of, as in 'u(t)'")
        may_be_mass = (not unit or is_unit(unit, mass)) and LIKE_MASS.search(column[:LONGEST_HEADING])
        if is_mass(column) or may_be_mass:
            if LIKE_SUM.search(column[:LONGEST_HEADING]):
                raise refused(column, NO_MASS)
            way = ", or give it as --hanger if it hangs on both sides"
            raise refused(column, "looks like a mass that is not read; add it to m1 or m2", way)
