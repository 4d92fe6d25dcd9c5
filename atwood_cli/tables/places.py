"""A table that is not understood, as a list of its columns, with a word for each as --columns takes them."""

import re
import shlex
from collections.abc import Callable, Collection, Sequence
from contextlib import suppress

from ..numbers.text import without_blanks
from ..reading.units import symbol_of
from .headings import (
    OPEN,
    UNREAD,
    Heading,
    Naming,
    Vocabulary,
    is_unit,
    listed,
    meaning_of,
    read_headings,
    unit_within,
)
from .sheets import Sheet
from .sources import Unreadable

WIDTH, WIDEST_HEADING, FIRST_CELLS = 80, 26, 3
UNIT_OF_CELL = re.compile(r"[\W\d]*(.*?)[)\]]?")
"""A cell, or what stands where units do: 150 g, (cm)."""
SEVERAL = re.compile(r"\d\s+[-+.,]?\d")
NO_SUCH_NUMBERS = (
    "no column has such numbers: write a heading above each, as m1 (g),m2 (g), and one number a cell"
)
A_NAMING = r""" --(?:\w+ '\?'|(?:columns?|label)[ =](?:'[^']*'|"[^"]*"|[^\s'"])+)"""
"""An option of a command line that says what columns are, or is open."""


class NotUnderstood(Unreadable):
    """A table lacks what is needed, or has what may matter. ``words`` are the best guess at its columns.

    ``options`` are missing, too, and in none of its columns.
    """

    def __init__(self, why: str, sheet: Sheet, words: Sequence[str], options: Sequence[str]) -> None:
        super().__init__(why)
        self.sheet, self.words, self.options = sheet, words, options
        self.typed = re.sub(f"(?:,{UNREAD})+$", "", ",".join(words))

    def listing(self, command: Sequence[str]) -> list[str]:
        """Return lines that show the columns, and what to type in place of this ``command``."""
        from rich.cells import cell_len, set_cell_size

        rows = [("", "heading", "first cells", "read as")]
        for place, (column, word) in enumerate(zip(self.sheet.columns, self.words, strict=True)):
            cells = filter(None, (without_blanks(row[place])[:16] for row in self.sheet.rows))
            rows.append((str(place + 1), without_blanks(column), "  ".join([*cells][:FIRST_CELLS]), word))
        sizes = [max(map(cell_len, texts)) for texts in zip(*rows, strict=True)]
        sizes[1] = min(sizes[1], WIDEST_HEADING)
        sizes[2] = min(sizes[2], WIDTH - sizes[0] - sizes[1] - sizes[3] - 8)
        lines = ["".join(f"  {set_cell_size(*x)}" for x in zip(row, sizes, strict=True)) for row in rows]
        options = "".join(f" --{name} '{OPEN}'" for name in self.options)
        typed = f"{re.sub(A_NAMING, '', shlex.join(command))} --columns {shlex.quote(self.typed)}{options}"
        has_guess = any(word.endswith(OPEN) and word != OPEN for word in self.words)
        guess = (
            [f"  A word before {OPEN} is a guess: take the {OPEN} away if it is right."] if has_guess else []
        )
        other = "other " if has_guess else ""
        hint = f"Replace each {other}{OPEN}, and type ({UNREAD} leaves a column unread):"
        hint = hint if OPEN in self.typed + options else "If this is right, type:"
        return ["", *map(str.rstrip, lines), "", *guess, f"  {hint}", "", f"  {typed}"]


def asked(
    why: str,
    sheet: Sheet,
    naming: Naming,
    vocabulary: Vocabulary,
    given: Collection[str],
    missing_of: Callable[[Collection[str]], Sequence[str]],
    may_matter: Callable[[int], bool],
    doubtful: Collection[int] = (),
) -> Unreadable:
    """Return the error that lists all columns, with words for those that are known or can be guessed.

    ``missing_of`` returns what is missing beside names, as those ``given`` for all rows, and ``may_matter``
    decides on a place. Those that are ``doubtful`` are open, even if they are read. What no column may hold
    is an option.
    """
    why = "; ".join([why, *sheet.remarks])
    if not sheet.rows:  # as of frames and NDJSON, whose columns have names
        return Unreadable(f"{why}; there are {listed(sheet.columns)}")
    said, words = [*sheet.columns], [UNREAD] * len(sheet.columns)
    with suppress(Unreadable):
        said = naming.of(sheet.columns)
    read, headings = [*words], list[Heading]()
    meant = [meaning_of(text, vocabulary) for text in said]
    for i in (i for i, own in enumerate(meant) if own):  # what cannot be read beside those before it is open
        read[i] = said[i]
        try:
            headings = read_headings(sheet.columns, vocabulary, read)
        except Unreadable:
            read[i], words[i] = UNREAD, OPEN
    for own in headings:
        words[own.place] = _word(own, own.name, own.number) + (OPEN if own.place in doubtful else "")
        if own.u:
            words[own.u.place] = _word(own.u, own.name, f"{own.number}_err")
    missing = missing_of({*given, *(own.name for own in meant if own)})
    left = [i for i, word in enumerate(words) if word == UNREAD and sheet.has_numbers(i)]
    left = [i for i in left if i or not sheet.numbers]
    units = {x: {i: unit for i in left if (unit := unit_of_column(sheet, i, x))} for x in missing}
    if units.get("time") and units.get("a"):  # one may be computed from the other
        units["a" if units.get("drop", " ") else "time"] = {}
    options = [x for x in missing if not units[x] and x not in vocabulary.repeated]
    options = [x for x in options if x != "drop" or not units.get("a")]  # without a time no height is needed
    nothing_measured = not any(units.get(x, " ") for x in ("time", "a"))
    is_unclear = {*options} - {"drop"} or nothing_measured
    for i in left:
        fits = [x for x in missing if i in units[x]]
        if len(fits) == 1:
            is_only = len(units[fits[0]]) == 1 and not may_matter(i)
            words[i] = f"{_short(fits[0])}:{units[fits[0]][i]}{'' if is_only else OPEN}"
        elif fits or is_unclear or i in doubtful or (said[i] != UNREAD and may_matter(i)):
            words[i] = OPEN
    is_by_blanks = len(words) == 1 and any(SEVERAL.search(row[0]) for row in sheet.rows)
    if is_by_blanks or (nothing_measured and OPEN not in words):
        return Unreadable(f"{why}; {NO_SUCH_NUMBERS}")
    is_open = OPEN in [words[i] for i in left] and [*missing] != ["drop"]
    return NotUnderstood(why, sheet, words, [] if is_open else options)


def unit_of_column(sheet: Sheet, place: int, name: str) -> str:
    """Return the symbol of a quantity's unit in the heading of a column, or in its cells, or ""."""
    meaning = Heading(0, "", name)
    in_cells = (match[1] for row in sheet.rows if (match := UNIT_OF_CELL.fullmatch(row[place].strip())))
    texts = (unit_within(sheet.columns[place], meaning), *in_cells)
    return next((symbol_of(text) for text in texts if is_unit(text, meaning) and text != "t"), "")


def _word(own: Heading, name: str, end: str) -> str:
    """Return the word for a column: t1:ms, m1_err."""
    return f"{_short(name)}{end}" + (f":{symbol_of(own.unit) or own.unit}" if own.unit else "")


def _short(name: str) -> str:
    return "t" if name == "time" else name
