"""One grammar of headings, for tables of runs and of scenes; each brings its vocabulary.

A heading is `name [number]`, and perhaps a unit: `(unit)`, `[unit]`, `/unit`, `in unit`, or behind a comma, a
blank or an underscore: m1, "m1 (g)", "time 2 [s]", a/(m/s²), "h, cm". A column of uncertainties is u(name)
or name_err, or ± behind the column of the quantity; a unit may follow. Blanks and underscores in names do not
count. The user names others, as by --column t='Fallzeit (s)'. What a heading says is used, or named in the
line "read as", or refused with what to type.
"""

import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from shlex import quote
from typing import NamedTuple
from unicodedata import normalize

from ..numbers.text import in_quotes, without_blanks
from ..reading.names import MASS_WORDS
from ..reading.units import PERCENT, UNITS, Malformed, read_unit, symbol_of
from ..solver.scene import SceneError, Unit, parameter_of
from .sources import Unreadable

NO_UNIT = ("", "-", "1")
LONGEST_HEADING = 80
"""The most characters of a heading that has a unit: the patterns take long for long texts."""
ABOVE = "lines above the headings left out"
SIGN = r"(?:±|\+/?-)"
STATED = re.compile(rf",?\s*{SIGN}\s*([\d.,]*\d(?:[eE]-?\d+)?)\s*(%|[^\W\d_][^\s()\[\],]*)?")
"""An uncertainty of all cells in a heading, and the word behind it, perhaps its unit: m1 (±1 g)."""
BRACKET = r"[(\[]([^()\[\]]*)[)\]]"
DIVIDED = (rf"(.+?)[ /]*{BRACKET}", r"([^/]+?) ?(?:/| in ) ?(.+)")
"""The patterns of a name with its unit: m1 (g), m1 [g], a/(m/s²); m1/g, m1 in g."""
LIKE_UNIT = re.compile(r"\w ?/ ?\w|\^|[²³]|s-[12]$")
"""The signs of a unit in brackets, also of one that is not known."""
MASS_NAMES = {f"{word}{n}": f"m{n}" for x in MASS_WORDS for word in (x, x.capitalize()) for n in (1, 2)}
"""The masses by names that can mean nothing else, without blanks."""
LIKE_SUM = re.compile(r"(?i)total|gesamt|\bsum|somme|dif(f|[ei]r)|^\W*([Σ∑Δ∆]|delta|dm\b)|\bm[\w ]*[-–−+] ?m")
"""The headings of sums and of differences."""
NO_MASS = "could be a sum or a difference of masses, which is not read"
UNCERTAINTY = re.compile(r"u ?\((.+)\)|(.+?)[ _]err")
OF_COLUMN_BEFORE = ("±", "+/-")
"""The names of columns that hold the uncertainties of the column before."""


class Vocabulary(NamedTuple):
    """The quantities that columns may hold.

    ``names`` maps each spelling, without blanks and underscores, to a parameter of the model. A quantity in
    ``repeated`` may have several columns, with numbers. Columns of uncertainties are known if ``uncertain``.
    """

    names: Mapping[str, str]
    repeated: Collection[str] = ()
    uncertain: bool = False


class Heading(NamedTuple):
    """A column that holds a quantity: its place, its heading, the unit of its cells as written and as read.

    ``number`` tells several columns of the quantity apart. ``u`` is the column of its uncertainties, which is
    ``uncertain``; without a name it belongs to the column before. ``stated`` is an uncertainty of all cells.
    """

    place: int
    column: str
    name: str
    number: str = ""
    unit: str = ""
    read: Unit = Unit()
    u: "Heading | None" = None
    uncertain: bool = False
    stated: str = ""


# Headings


def read_headings(
    columns: Sequence[str],
    vocabulary: Vocabulary,
    labels: Collection[str] = (),
    named: Mapping[str, str] = {},
    whole: bool = True,
) -> list[Heading]:
    """Return the columns that hold a quantity, in their order, each with its column of uncertainties.

    ``labels`` are headings of columns without a quantity, whatever they look like. ``named`` maps headings to
    names of this grammar. Raises Unreadable if two columns hold the same, a unit is wrong, an uncertainty
    belongs to no column, or a ``whole`` table lacks one of these headings; SceneError if a label is named.
    """
    if both := [label for label in labels if label in named]:
        raise SceneError("label", both[0], "is also named by --column; leave one of them out")
    if whole and (absent := [heading for heading in (*named, *labels) if heading not in columns]):
        raise Unreadable(f"there is no column {in_quotes(absent[0])}; there are {listed(columns)}")
    headings: dict[tuple[str, str], Heading] = {}
    uncertain: list[Heading] = []
    for place, column in enumerate(columns):
        heading = None if column in labels else _meaning(column, vocabulary, named)
        if not heading:
            continue
        if heading.stated and not vocabulary.uncertain:
            raise refused(column, "states an uncertainty, which only solve and fit take")
        heading = heading._replace(place=place)
        name, number = heading.name, heading.number
        if heading.uncertain:
            uncertain.append(heading)
            continue
        is_repeat = name in vocabulary.repeated
        if is_repeat and column in named and not number:  # its user may name repeats alike
            number = str(1 + sum(own.name == name for own in headings.values()))
        if same := headings.get((name, number)):
            way = "give each repeat its own number" if is_repeat else "rename one"
            which, other = (same.column, column) if column in named else (column, same.column)
            why = f"holds {name}, as {in_quotes(other)} does; {way}"
            raise refused(which, why) if which != other else Unreadable(f"column {in_quotes(which)} {why}")
        headings[name, number] = heading._replace(number=number, read=unit_of(heading))
    for heading in uncertain:
        _add_uncertainty(headings, heading)
    return list(headings.values())


def recognised(columns: Sequence[str], vocabulary: Vocabulary, named: Mapping[str, str] = {}) -> list[str]:
    """Return the columns that the vocabulary knows, or that the user has named."""
    return [column for column in columns if _meaning(column, vocabulary, named)]


def read_named(words: Iterable[str], vocabulary: Vocabulary) -> dict[str, str]:
    """Return the names by their headings, from options --column NAME=HEADING. Raises SceneError."""
    named: dict[str, str] = {}
    for word in words:
        name, _, heading = word.partition("=")
        meaning = _meaning(name, vocabulary, {})
        if not heading or heading in named or not meaning or not meaning.name:
            names = ", ".join(dict.fromkeys(vocabulary.names.values()))
            rule = f"must be NAME=HEADING, as m1='Masse 1 (g)', each heading once; names are {names}"
            raise SceneError("column", word, rule)
        named[heading] = name
    return named


def _meaning(column: str, vocabulary: Vocabulary, named: Mapping[str, str]) -> Heading | None:
    """Return what a column holds, without its place and unit as read; None if the heading is not known."""
    text, stated, its_unit = _apart(column)
    for word, unit, is_loose in divisions(without_blanks(named.get(column, text))):
        meaning = _named(word, vocabulary)
        if meaning and not (is_loose and not is_unit(unit, meaning)):
            if column in named and (own := unit_within(text, meaning)) != unit:
                if unit and is_unit(own, meaning):
                    why = f"has the unit {in_quotes(own)}, not {in_quotes(unit)}"
                    raise refused(column, f"{why}; give --column without a unit")
                unit = unit or own
            # It may be the symbol of the quantity, as in time (t) or Mass (m).
            is_symbol = unit == meaning.name[:1] or vocabulary.names.get(unit) == meaning.name
            if unit in NO_UNIT or (is_symbol and not is_unit(unit, meaning)):
                unit = ""
            if not unit and is_unit(its_unit, meaning):
                unit = its_unit
            return meaning._replace(column=column, unit=unit, stated=stated + its_unit)
    return None


def _apart(column: str) -> tuple[str, str, str]:
    """Return a heading without the uncertainty of all cells that it states, this number, and its unit."""
    if not (match := STATED.search(column[:LONGEST_HEADING])):
        return column, "", ""
    number, word = match.groups(default="")
    unit = word if word == PERCENT or symbol_of(word) else ""
    rest = f"{column[: match.start()]} {word.removeprefix(unit)}{column[match.end() :]}"
    rest = re.sub(r"^[(\[](.*?)[)\]]|[(\[]\s*[)\]]", r"\1 ", rest)  # (m1±1)g is m1 g
    return without_blanks(rest), number.replace(",", "."), unit


def divisions(text: str) -> Iterator[tuple[str, str, bool]]:
    """Yield the ways to read a heading as a name and a unit, first as a name alone.

    What stands loosely, behind a blank or an underscore, may be a unit or a part of the name.
    """
    yield text, "", False
    if len(text) <= LONGEST_HEADING:
        if match := next(filter(None, (re.fullmatch(pattern, text) for pattern in DIVIDED)), None):
            yield match[1].strip(), match[2].strip(), False
        for mark in re.finditer("[, _]+", text):
            yield text[: mark.start()], text[mark.end() :], "," not in mark[0]


def unit_within(column: str, meaning: Heading) -> str:
    """Return the unit in a heading that the user has named; brackets without a unit are a part of the name.

    A unit of another dimension, which is refused then, counts if there is none of the quantity.
    """
    column = column if len(column) <= LONGEST_HEADING else ""
    bare = without_blanks(re.sub(BRACKET, "", column))
    units = [(unit.strip(), False) for unit in reversed(re.findall(BRACKET, column))]
    if not any(symbol_of(unit) for unit, _ in units):
        units += [(unit, is_loose) for _, unit, is_loose in divisions(bare)]
    fitting = [unit for unit, _ in units if is_unit(unit, meaning)]
    others = [
        unit for unit, is_loose in units if not is_loose and (symbol_of(unit) or LIKE_UNIT.search(unit))
    ]
    return next(iter([*fitting, *others]), "")


def name_at_start(column: str, vocabulary: Vocabulary) -> str:
    """Return the quantity that a heading begins with, as m1 of (m1 ± Δm1) (g), or a of a_measured, or ""."""
    before = re.match(rf"\W*(.+?)(?:\s*{SIGN}|[ _,(\[])", column[:LONGEST_HEADING])
    meaning = before and _named(before[1], vocabulary)
    return meaning.name if meaning else ""


def is_unit(unit: str, meaning: Heading) -> bool:
    """Decide whether a text is a unit of the quantity; of uncertainties also percent, or of any quantity."""
    if meaning.uncertain and (unit == PERCENT or not meaning.name):
        return unit == PERCENT or bool(symbol_of(unit))
    parameter = parameter_of(meaning.name)
    with suppress(Malformed):
        return bool(parameter.dimension and read_unit(unit, parameter.dimension, parameter.terms))
    return False


def _named(word: str, vocabulary: Vocabulary) -> Heading | None:
    """Return the meaning of a name without its unit; None if it is not known."""
    if vocabulary.uncertain and word in OF_COLUMN_BEFORE:
        return Heading(0, "", "", uncertain=True)
    match = UNCERTAINTY.fullmatch(word) if vocabulary.uncertain else None
    key = re.sub(r"[\s_]", "", normalize("NFKC", (match[1] or match[2]) if match else word))
    bare = re.sub(r"(?<=\d)(?:st|nd|rd|th)$", "", key)  # t 1st is t1
    letters = key if key in vocabulary.names else bare.rstrip("0123456789")
    name = vocabulary.names.get(letters, "")
    if not name or (letters != key and name not in vocabulary.repeated):
        return None
    return Heading(0, "", name, bare[len(letters) :], uncertain=bool(match))


def _add_uncertainty(headings: dict[tuple[str, str], Heading], u: Heading) -> None:
    """Give quantities their column of uncertainties. Raises Unreadable."""
    owners = [
        own
        for own in headings.values()
        if (own.name == u.name and u.number in ("", own.number) if u.name else own.place == u.place - 1)
    ]
    if not owners:
        raise refused(u.column, "could be an uncertainty, but no column is what it would be of")
    for own in owners:
        if own.u:
            raise refused(u.column, f"is a second uncertainty of {own.name}")
        its_u = u._replace(name=own.name, number=own.number)
        if u.unit in ("", PERCENT):
            its_u = its_u._replace(read=own.read)
        else:
            its_u = its_u._replace(read=unit_of(its_u))
            if its_u.read.terms != own.read.terms:
                raise refused(u.column, f"has another kind of unit than {in_quotes(own.column)}")
        headings[own.name, own.number] = own._replace(u=its_u)


def unit_of(heading: Heading) -> Unit:
    """Return the unit of a column. Raises Unreadable if its quantity has no such unit."""
    parameter = parameter_of(heading.name)
    if not heading.unit:
        return Unit()
    try:
        if not parameter.dimension:
            raise Malformed(f"must hold plain numbers, without the {in_quotes(heading.unit)}")
        return read_unit(heading.unit, parameter.dimension, parameter.terms)
    except Malformed as error:
        way = naming(heading) if parameter.dimension else ""
        raise refused(heading.column, f"{error}; rename it", way) from None


def naming(heading: Heading) -> str:
    """Return the words on an option that names a column, with a unit if its quantity has one."""
    unit, column = parameter_of(heading.name).unit, heading.column
    name = f"u({heading.name})" if heading.uncertain else heading.name
    has_unit = not unit or is_unit(unit_within(column, heading), heading)
    typed = f"{name}={column}" if has_unit else f"{name} ({unit})={column}"
    return f", or give --column {_as_typed(typed)}{'' if has_unit else ', with the unit of its cells'}"


def is_mass(column: str) -> bool:
    """Decide whether a heading has a unit of mass; t is a time, rather than a tonne."""
    unit = unit_within(column, Heading(0, column, "m1"))
    return unit != "t" and symbol_of(unit) in UNITS["mass"]


def refused(column: str, why: str, way: str = "") -> Unreadable:
    """Return the error for a heading; a user of the command may go another ``way``, or label the column."""
    return Unreadable(f"column {in_quotes(column)} {why}", f"{way}{left_unread(column)}")


def left_unread(*columns: str) -> str:
    """Return the options that leave columns unread, to stand behind an error."""
    labels = " ".join(f"--label {_as_typed(column)}" for column in columns)
    return f"; {labels} {'leaves it' if len(columns) == 1 else 'leave them'} unread"


def _as_typed(word: str) -> str:
    """Return a word with a heading as a shell takes it, or with escapes."""
    word = without_blanks(word)
    return quote(word) if word.isprintable() and len(word) <= LONGEST_HEADING else in_quotes(word)


def units_in(row: Sequence[str]) -> list[str]:
    """Return the units in a row below the headings that has nothing else, none if there is no such row."""
    units = [cell.strip(" ()[]") for cell in row]
    is_row_of_units = all(unit in ("", "-", PERCENT) or symbol_of(unit) for unit in units)
    return units if is_row_of_units and any(map(symbol_of, units)) else []


def listed(names: Sequence[str]) -> str:
    """Return headings in a sentence, the first of many; none if there are none."""
    most = 12
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return f"{', '.join(map(in_quotes, names[:most])) or 'none'}{more}"


def read_as(
    headings: Iterable[Heading],
    separator: str,
    comma: bool,
    others: Iterable[str] = (),
    with_units: Collection[int] | None = None,
) -> list[str]:
    """Return a line that says how a table was read; none if there is nothing to say.

    It names the units of columns, those that are assumed, too. The cells of places ``with_units`` have their
    own; if this is not known (None), or no column has another heading, those headed by their own name are
    left out.
    """
    stated = {own.place: f" ± {own.stated}" for own in headings if own.stated}
    columns = {own.place: (own.column, own.name, own.unit) for own in headings}
    columns |= {own.u.place: (own.u.column, f"u({own.name})", own.u.unit) for own in headings if own.u}
    alike = dict[tuple[bool, str], list[str]]()
    has_all = with_units is not None and any(column != name for column, name, _ in columns.values())
    for place, (column, name, unit) in sorted(columns.items()):
        is_open = not unit and "(" not in name and place not in (with_units or ())
        usual = parameter_of(name).unit if is_open else ""
        if column != name or (usual and has_all):
            words = f" as {name}" if column != name else ""
            words += (f" in {unit or usual}" if unit or usual else "") + stated.get(place, "")
            alike.setdefault((bool(usual), words), []).append(in_quotes(column))
    given, assumed = (
        [", ".join(names) + words for (is_assumed, words), names in alike.items() if is_assumed is which]
        for which in (False, True)
    )
    marks = {"cells separated by semicolons": separator == ";", "decimal commas": comma}
    clauses = [", ".join([*(mark for mark, has_it in marks.items() if has_it), *given, *others])]
    clauses += [", ".join([*assumed, "as no unit is given"])] if assumed else []
    return [f"read as: {'; '.join(filter(None, clauses))}."] if any(clauses) else []
