"""One grammar of headings, for tables of runs and of scenes; each brings its vocabulary.

A heading is `name [number]`, and perhaps a unit: `(unit)`, `[unit]`, `/unit`, `in unit`, or behind a comma, a
blank or an underscore: m1, "m1 (g)", "time 2 [s]", a/(m/s²), "h, cm". A column of uncertainties is u(name)
or name_err, or ± behind the column of the quantity; a unit may follow. Blanks and underscores in names do not
count. The user names others by place, as m1:g,-,t, or by heading. What a heading says is used, or named in
the line "read as", or asked for.
"""

import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from typing import NamedTuple
from unicodedata import decomposition, normalize

from ..numbers.text import counted, in_quotes, without_blanks
from ..reading.names import MASS_WORDS, divided
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
LIKE_MASS = re.compile(
    r"(?:\b|[_ΔΣ∑])(?:(?<!\d )m\d*|mass\w*|masas?|масс\w*|gewicht\w*|weights?|hangers?|(?:over|pay)?load"
    r"|rider|beban|peso|poids|\w*груз\w*)(?:\b|_)",
    re.IGNORECASE,
)
UNCERTAINTY = re.compile(r"u ?\((.+)\)|(.+?)[ _]err")
OF_COLUMN_BEFORE = ("±", "+/-")
"""The names of columns that hold the uncertainties of the column before."""
UNREAD, OPEN, FILLED = "-", "?", "+"
"""The word for a column that is not read; the ends of one to be decided, and of one with blanks to fill."""


class Vocabulary(NamedTuple):
    """The quantities that columns may hold.

    ``names`` maps each spelling, without blanks and underscores, to a parameter of the model. A quantity in
    ``repeated`` may have several columns, with numbers; one in ``constant`` is the same in all rows. Columns
    of uncertainties are known if ``uncertain``.
    """

    names: Mapping[str, str]
    repeated: Collection[str] = ()
    constant: Collection[str] = ()
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


class Naming(NamedTuple):
    """What a user says of columns: a word for each from the left, or names and labels by their headings.

    Rows above the first number in the ``decisive`` places are headings. Blank cells of places that are
    ``filled`` have what stands above them.
    """

    words: Sequence[str] = ()
    decisive: Collection[int] = ()
    filled: Collection[int] = ()
    named: Mapping[str, str] = {}
    labels: Collection[str] = ()

    @property
    def is_open(self) -> bool:
        """Return whether a word is left open, so that the columns are to be listed."""
        return any(word.endswith(OPEN) for word in self.words)

    def of(self, columns: Sequence[str], whole: bool = True) -> list[str]:
        """Return what each column is read by: its word, UNREAD, or its own heading.

        Raises SceneError for words that do not fit, and Unreadable if a ``whole`` table lacks a heading.
        """
        if self.words:
            words = [*self.words, *[OPEN if self.is_open else UNREAD] * (len(columns) - len(self.words))]
            if len(words) > len(columns):
                rule = f"are {len(words)} words, and the table has {counted(len(columns), 'column')}"
                raise SceneError("columns", ",".join(words), rule)
            return [x if word.endswith(OPEN) else word for x, word in zip(columns, words, strict=True)]
        headings = [*map(without_blanks, columns)]
        labels = divided(self.labels, headings)
        if both := [label for label in labels if label in self.named]:
            raise SceneError("label", both[0], "is also named by --column; leave one of them out")
        if whole and (absent := [x for x in (*self.named, *labels) if x not in headings]):
            raise Unreadable(f"there is no column {in_quotes(absent[0])}; there are {listed(columns)}")
        if whole and (twice := [x for x in self.named if headings.count(x) > 1]):
            raise Unreadable(f"{headings.count(twice[0])} columns have the heading {in_quotes(twice[0])}")
        said = zip(columns, headings, strict=True)
        return [UNREAD if x in labels else self.named.get(x, column) for column, x in said]


NOTHING_SAID = Naming()


# Headings


def read_headings(
    columns: Sequence[str], vocabulary: Vocabulary, said: Sequence[str] | None = None
) -> list[Heading]:
    """Return the columns that hold a quantity, in their order, each with its column of uncertainties.

    ``said`` has what each column is read by, as `Naming.of` returns it. Raises Unreadable if two columns hold
    the same, a unit is wrong, or an uncertainty belongs to no column.
    """
    headings: dict[tuple[str, str], Heading] = {}
    uncertain: list[Heading] = []
    for place, (column, word) in enumerate(zip(columns, said or columns, strict=True)):
        if word == UNREAD or not (heading := meaning_of(column, vocabulary, word)):
            continue
        if heading.stated and not vocabulary.uncertain and column == word:
            raise refused(column, "states an uncertainty, which only solve and fit take")
        heading = heading._replace(place=place)
        name, number = heading.name, heading.number
        if heading.uncertain:
            uncertain.append(heading)
            continue
        is_repeat = name in vocabulary.repeated
        if is_repeat and column != word and not number:  # its user may name repeats alike
            number = str(1 + sum(own.name == name for own in headings.values()))
        if same := headings.get((name, number)):
            other = "another of that heading" if same.column == column else in_quotes(same.column)
            way = "are they repeats?" if is_repeat else "read one"
            raise refused(column, f"holds {name}, as {other} does; {way}")
        kind = next((own for own in headings.values() if own.name in vocabulary.repeated), None)
        if kind and is_repeat and (kind.name, bool(kind.number)) != (name, bool(number)):
            why = f"stands beside {in_quotes(kind.column)}, and one may be computed, as a mean is"
            raise refused(column, why)
        headings[name, number] = heading._replace(number=number, read=unit_of(heading))
    for heading in uncertain:
        _add_uncertainty(headings, heading)
    return list(headings.values())


def places_of(headings: Iterable[Heading]) -> list[int]:
    """Return the places of columns that are read, with those of uncertainties."""
    return [own.place for heading in headings for own in (heading, heading.u) if own]


def recognised(columns: Sequence[str], vocabulary: Vocabulary, named: Mapping[str, str] = {}) -> list[str]:
    """Return the columns that the vocabulary knows, or that the user has named."""
    said = [named.get(without_blanks(column), column) for column in columns]
    return [x for x, word in zip(columns, said, strict=True) if meaning_of(x, vocabulary, word)]


def read_naming(
    words: str | Sequence[str], named: Iterable[str], labels: Iterable[str], vocabulary: Vocabulary
) -> Naming:
    """Read what a user says of columns, NAME:UNIT by place, or NAME=HEADING. Raises SceneError."""
    by_heading: dict[str, str] = {}
    names = ", ".join(dict.fromkeys(vocabulary.names.values()))
    for word in named:
        name, _, heading = word.partition("=")
        meaning, heading = meaning_of(name, vocabulary), without_blanks(heading)
        if not heading or heading in by_heading or not meaning or not meaning.name:
            rule = f"must be NAME=HEADING, as m1='Masse 1 (g)', each heading once; names are {names}"
            raise SceneError("column", word, rule)
        by_heading[heading] = name
    typed = words.split(",") if isinstance(words, str) and words else words
    by_place = [without_blanks(word) or UNREAD for word in typed]
    if by_place and by_heading:
        raise SceneError("columns", ",".join(by_place), "says what each column is; leave --column out")
    filled = [place for place, word in enumerate(by_place) if word.endswith(FILLED)]
    read = [re.sub(r"^([^:]+):([^?]+)$", r"\1 (\2)", word.removesuffix(FILLED)) for word in by_place]
    decided = [UNREAD if word.endswith(OPEN) else word for word in read]
    meanings = {i: own for i, word in enumerate(decided) if (own := meaning_of(word, vocabulary))}
    for i, word in enumerate(decided):
        if i not in meanings and word != UNREAD:
            rule = f"is no word for a column: {names}, or {UNREAD} for one that is not read"
            raise SceneError("columns", by_place[i], rule)
    twice = {word for i, word in enumerate(read) if i in meanings and read.count(word) > 1}
    for i, own in meanings.items():  # t,t_err,t,t_err: each of the one before
        if own.uncertain and read[i] in twice:
            read[i] = f"± ({own.unit})" if own.unit else "±"
    single = [i for i, own in meanings.items() if not (own.uncertain or own.name in vocabulary.repeated)]
    return Naming(read, single or [*meanings], filled, by_heading, [*map(without_blanks, labels)])


def meaning_of(column: str, vocabulary: Vocabulary, said: str | None = None) -> Heading | None:
    """Return what a column holds, by what is ``said`` of it or by its heading; None if it is not known.

    Its place and the unit as read are not set. Raises Unreadable if the heading contradicts what is said.
    """
    text, stated, its_unit = _apart(column)
    is_said = said is not None and said != column
    for word, unit, is_loose in divisions(without_blanks(said if said is not None and is_said else text)):
        meaning = _named(word, vocabulary)
        if meaning and not (is_loose and not is_unit(unit, meaning)):
            if is_said:
                unit = _unit_beside(column, text, meaning, unit, vocabulary)
            # It may be the symbol of the quantity, as in time (t) or Mass (m).
            is_symbol = unit == meaning.name[:1] or vocabulary.names.get(unit) == meaning.name
            if unit in NO_UNIT or (is_symbol and not is_unit(unit, meaning)):
                unit = ""
            if not unit and is_unit(its_unit, meaning):
                unit = its_unit
            return meaning._replace(column=column, unit=unit, stated=stated + its_unit)
    return None


def _unit_beside(column: str, text: str, said: Heading, unit: str, vocabulary: Vocabulary) -> str:
    """Return the unit that is said, or else that of the heading. Raises Unreadable if the two contradict.

    A heading of one letter, as M or T, may mean anything.
    """
    own = meaning_of(column, vocabulary)
    if own and own.name not in ("", said.name) and not re.match(r"[^\W\d_](?![^\W_])", column):
        raise refused(column, f"means {own.name}, not {said.name}")
    within = unit_within(text, said)
    if unit and is_unit(within, said) and symbol_of(within) != symbol_of(unit):
        raise refused(column, f"has the unit {in_quotes(within)}, not {in_quotes(unit)}")
    return unit or within


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
        for mark in re.finditer("[., _]+", text):
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
    typed = (match[1] or match[2]) if match else word
    if any(decomposition(sign).startswith("<super>") for sign in typed):  # t² is no t2
        return None
    key = re.sub(r"[\s_]", "", normalize("NFKC", typed))
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
        raise refused(u.column, "could be an uncertainty, but of no column that is read (- leaves it unread)")
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
        raise refused(heading.column, str(error)) from None


def is_mass(column: str) -> bool:
    """Decide whether a heading has a unit of mass; t is a time, rather than a tonne."""
    unit = unit_within(column, Heading(0, column, "m1"))
    return unit != "t" and symbol_of(unit) in UNITS["mass"]


def may_be_mass(column: str) -> bool:
    """Decide whether a heading has a unit of mass, or a word for a mass and no other unit."""
    unit = unit_within(column, mass := Heading(0, column, "m1"))
    is_free = not unit or is_unit(unit, mass)
    return is_mass(column) or (is_free and bool(LIKE_MASS.search(column[:LONGEST_HEADING])))


def refused(column: str, why: str) -> Unreadable:
    """Return the error for a heading."""
    return Unreadable(f"column {in_quotes(column)} {why}")


def are_units(row: Sequence[str]) -> bool:
    """Decide whether a row below the headings has units and nothing else."""
    units = [cell.strip(" ()[]") for cell in row]
    return all(unit in ("", "-", PERCENT) or symbol_of(unit) for unit in units) and any(map(symbol_of, units))


def named(column: str, place: int) -> str:
    """Return a heading as messages show it, or the number of a column that has none."""
    return in_quotes(column) if column.strip() else f"column {place + 1}"


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
            alike.setdefault((bool(usual), words), []).append(named(column, place))
    given, assumed = (
        [", ".join(names) + words for (is_assumed, words), names in alike.items() if is_assumed is which]
        for which in (False, True)
    )
    marks = {"cells separated by semicolons": separator == ";", "decimal commas": comma}
    clauses = [", ".join([*(mark for mark, has_it in marks.items() if has_it), *given, *others])]
    clauses += [", ".join([*assumed, "as no unit is given"])] if assumed else []
    return [f"read as: {'; '.join(filter(None, clauses))}."] if any(clauses) else []
