"""A table that is not understood, as a list of its columns, with a word for each as --columns takes them."""

import re
import shlex
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from contextlib import suppress
from functools import partial
from unicodedata import normalize

from ..numbers.text import without_blanks
from ..reading.units import symbol_of
from ..solver.scene import MASSES, SceneError, parameter_of
from .cells import has_unit
from .headings import (
    FILLED,
    LONGEST_HEADING,
    OPEN,
    UNREAD,
    Heading,
    Naming,
    Vocabulary,
    divisions,
    is_unit,
    listed,
    meaning_of,
    named,
    places_of,
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
    "no column has such numbers: write a heading above each, as m1 (g),m2 (g), one number a cell,"
    " and a comma, a semicolon or a tab between cells"
)
LACKING = {"m1": "m1 (0 if nothing hangs there)", "time": "t (or a)"}
"""What is missing, in other words than its name."""
Doubt = Callable[[Sheet, int, Collection[str]], str]
"""Names the column in a place that is not read if it may matter beside names that are there, else ""."""
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
        hint = f"Replace each {OPEN} ({UNREAD} is not read), or take it away from a right guess, and type:"
        hint = hint if OPEN in self.typed + options else "If this is right, type:"
        return ["", *map(str.rstrip, lines), "", f"  {hint}", "", f"  {typed}"]


def understood(
    sheet: Sheet,
    naming: Naming,
    vocabulary: Vocabulary,
    doubt: Doubt,
    given: Mapping[str, str],
    whole: bool = True,
) -> list[Heading]:
    """Return the columns that hold quantities, beside what is ``given`` for all rows.

    A table that is not ``whole`` may lack some. Raises NotUnderstood, Unreadable, SceneError.
    """
    ask = partial(_asked, sheet=sheet, naming=naming, vocabulary=vocabulary, doubt=doubt, given=given)
    if naming.is_open:
        raise ask("its columns are to be decided")
    try:
        said = naming.of(sheet.columns, whole)
        headings = read_headings(sheet.columns, vocabulary, said)
    except Unreadable as error:
        if naming.words:
            raise SceneError("columns", None, f"does not fit: {error}") from None
        raise ask(str(error)) from None
    has, places = {own.name for own in headings}, places_of(headings)
    if double := [x for x in given if x in has]:
        raise SceneError(double[0], given[double[0]], "is a column of the table, too; leave one out")
    has = {*given, *has} if whole else set()
    missing = [x for x in _missing(has, vocabulary) if x != "a"] if whole else []
    varying = [own for own in headings if not naming.words and _varies(sheet, own, vocabulary)]
    unread = [i for i, word in enumerate(said) if not missing and i not in places and word != UNREAD]
    measured = [own for own in headings if own.name in vocabulary.repeated and not own.number]
    rivals = {i: own.place for i in unread for own in measured if _is_alike(sheet, i, own, vocabulary)}
    doubts = {i: doubt(sheet, i, has) for i in unread} | {i: named(sheet.columns[i], i) for i in rivals}
    bare = [own for own in headings if _unit_above(sheet, own)]
    for which, what in (
        ([LACKING.get(x, x) for x in missing], "missing"),
        ([named(own.column, own.place) for own in varying], "not the same in all rows, as it must be"),
        ([*filter(None, doubts.values())], "not read, and may matter"),
        ([named(own.column, own.place) for own in bare], "without a unit, and a line above has one"),
    ):
        if which:
            are, doubtful = "is" if len(which) == 1 else "are", {*rivals, *rivals.values()}
            raise ask(f"{', '.join(which)} {are} {what}", doubtful=doubtful)
    return headings


def _missing(has: Collection[str], vocabulary: Vocabulary) -> list[str]:
    """Return what is needed beside these: both masses, and of runs a, or t with the height of fall."""
    missing = [mass for mass in MASSES if mass not in has]
    if vocabulary.repeated and "a" not in has:
        missing += ["time", "a"] if "time" not in has else []
        missing += ["drop"] if "drop" not in has else []
    return missing


def _is_alike(sheet: Sheet, place: int, own: Heading, vocabulary: Vocabulary) -> bool:
    """Decide whether a heading has the name of what was measured, too, so that either may be computed."""
    column = sheet.columns[place]
    words, unit = re.split(r"[\W_]+", column[:LONGEST_HEADING]), unit_within(column, own)
    has_name = own.name in map(vocabulary.names.get, words) and sheet.has_numbers(place)
    return has_name and (not unit or is_unit(unit, own))


def _unit_above(sheet: Sheet, own: Heading) -> str:
    """Return the unit above all headings, if not the usual one, of a column that has none, also in cells."""
    if own.unit or (sheet.rows and all(has_unit(row[own.place]) for row in sheet.rows)):
        return ""
    divided = (division for text in sheet.above for division in divisions(without_blanks(text)))
    texts = (unit or word.strip("()[]") for word, unit, is_loose in divided if not is_loose)
    return _unit_among((text for text in texts if text != parameter_of(own.name).unit), own)


def _asked(
    why: str,
    sheet: Sheet,
    naming: Naming,
    vocabulary: Vocabulary,
    doubt: Doubt,
    given: Collection[str],
    doubtful: Collection[int] = (),
) -> Unreadable:
    """Return the error that lists all columns, with words for those that are known or can be guessed.

    What no column surely holds is an option, too. Columns that are ``doubtful`` are open, even if they are
    read; those that the user leaves unread are not asked for again.
    """
    why, repeated = "; ".join([why, *sheet.remarks]), {*vocabulary.repeated}
    if not sheet.rows:  # as of frames and NDJSON, whose columns have names
        return Unreadable(f"{why}; there are {listed(sheet.columns)}")
    said = [*sheet.columns]
    with suppress(Unreadable):
        said = naming.of(sheet.columns)
    words, headings = _words_known(sheet, said, vocabulary, given, doubtful)
    for i in naming.filled:
        words[i] = words[i].removesuffix(OPEN)
    missing = _missing({*given, *(own.name for own in headings)}, vocabulary)
    left = [i for i, word in enumerate(words) if word == UNREAD and sheet.has_numbers(i)]
    is_unmeasured = not repeated.isdisjoint(missing)  # then one of those left unread must be it
    left = [i for i in left if (is_unmeasured or said[i] != UNREAD) and (i or not sheet.numbers)]
    units = _guesses(sheet, left, missing)
    is_measured = any(units.get(x) for x in repeated)
    lacking = {x for x in missing if not (units[x] or (x in repeated and is_measured))}
    needed = {x for x in missing if x != "drop" or not units.get("a")}  # without a time no height is needed
    lacking, options = lacking & needed, needed - repeated
    for i in left:
        fits = [x for x in missing if i in units[x]]
        is_merged = missing and repeated and not sheet.columns[i].strip()
        may_matter = is_merged or i in doubtful or doubt(sheet, i, ()) != ""
        rivals = len(units[fits[0]]) if len(fits) == 1 else 0
        if rivals == 1 or (rivals and fits[0] in repeated):
            own = Heading(i, "", fits[0], unit=units[fits[0]][i])
            words[i] = _word(sheet, own, vocabulary, rivals > 1 or may_matter)
            options -= {own.name}
        elif fits or lacking - {"drop"} or may_matter:
            words[i] = OPEN
    if lacking & repeated and OPEN not in words:  # one that may be a mass may be a time
        words = [OPEN if i in left else word for i, word in enumerate(words)]
    is_by_blanks = len(words) == 1 and any(SEVERAL.search(row[0]) for row in sheet.rows)
    if is_by_blanks or (lacking & repeated and OPEN not in words):
        return Unreadable(f"{why}; {NO_SUCH_NUMBERS}")
    return NotUnderstood(why, sheet, words, [x for x in missing if x in options])


def _words_known(
    sheet: Sheet,
    said: Sequence[str],
    vocabulary: Vocabulary,
    given: Collection[str],
    doubtful: Collection[int],
) -> tuple[list[str], list[Heading]]:
    """Return the words of columns, UNREAD for those not known by what is ``said``, and what is read.

    What cannot be read beside those before it, or is given for all rows, too, is open.
    """
    words, read, headings = [UNREAD] * len(said), [UNREAD] * len(said), list[Heading]()
    for i in (i for i, text in enumerate(said) if meaning_of(text, vocabulary)):
        read[i] = said[i]
        try:
            headings = read_headings(sheet.columns, vocabulary, read)
        except Unreadable:
            read[i], words[i] = UNREAD, OPEN
    for own in headings:
        unit = _unit_above(sheet, own)
        is_open = bool(unit) or own.place in doubtful or _varies(sheet, own, vocabulary)
        word = _word(sheet, own._replace(unit=own.unit or unit), vocabulary, is_open)
        words[own.place] = OPEN if own.name in given else word
        if own.u:
            its_u = own.u._replace(name=own.name, number=f"{own.number}_err")
            words[own.u.place] = OPEN if own.name in given else _word(sheet, its_u, vocabulary, False)
    return words, headings


def _guesses(sheet: Sheet, left: Sequence[int], missing: Sequence[str]) -> dict[str, dict[int, str]]:
    """Return the places that may hold what is missing, each with its unit."""
    units = {x: {i: unit for i in left if (unit := unit_of_column(sheet, i, x))} for x in missing}
    if units.get("time") and units.get("a"):  # one may be computed from the other
        units["a" if units.get("drop", " ") else "time"] = {}
    stems = [re.sub(r"\d", "", normalize("NFKC", column)) for column in sheet.columns]
    counts = Counter({sheet.columns[i]: stems[i] for i in left}.values())  # a heading twice is no repeat
    alike = [i for i in left if counts[stems[i]] > 1 and re.search(r"[^\W\d_]", stems[i])]
    if "time" in missing and not units["time"] and not units["a"]:
        others = {i for places in units.values() for i in places}
        others |= {i for i in alike if unit_within(sheet.columns[i], Heading(0, "", "time"))}
        units["time"] = {i: "" for i in alike if i not in others}
    masses = [i for i in alike if i in units.get("m1", {}) and i in units.get("m2", {})]
    if len(masses) == 2:
        units |= {mass: {i: units[mass][i]} for mass, i in zip(MASSES, masses, strict=True)}
    return units


def unit_of_column(sheet: Sheet, place: int, name: str) -> str:
    """Return the symbol of a quantity's unit in the heading of a column, or in its cells, or ""."""
    meaning = Heading(0, "", name)
    in_cells = (match[1] for row in sheet.rows if (match := UNIT_OF_CELL.fullmatch(row[place].strip())))
    return _unit_among([unit_within(sheet.columns[place], meaning), *in_cells], meaning)


def _unit_among(texts: Iterable[str], meaning: Heading) -> str:
    """Return the symbol of the first unit of a quantity, or ""; t is rather a time, and g a mass."""
    other = "g" if meaning.name == "a" else "t"
    return next((symbol_of(text) for text in texts if text != other and is_unit(text, meaning)), "")


def _varies(sheet: Sheet, own: Heading, vocabulary: Vocabulary) -> bool:
    """Decide whether a column of what is one for all rows has different cells."""
    return own.name in vocabulary.constant and len({row[own.place].strip() for row in sheet.rows}) > 1


def _word(sheet: Sheet, own: Heading, vocabulary: Vocabulary, is_open: bool) -> str:
    """Return the word for a column: t1:ms, m1_err, m1:g?, or m2:g+? if cells below its first are blank.

    The unit is that which is assumed, if there is none.
    """
    name, cells = "t" if own.name == "time" else own.name, [row[own.place].strip() for row in sheet.rows]
    assumed = "" if own.uncertain or any(map(has_unit, cells)) else parameter_of(own.name).unit
    unit = symbol_of(own.unit) or own.unit or symbol_of(assumed)
    blanks = "".join("x" if cell else " " for cell in cells).lstrip()
    is_filled = own.name not in vocabulary.repeated and " " in blanks
    marks = (FILLED if is_filled else "") + (OPEN if is_filled or is_open else "")
    return f"{name}{own.number}" + (f":{unit}" if unit else "") + marks
