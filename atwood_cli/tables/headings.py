"""One grammar of headings, for tables of runs and of scenes; the vocabulary is handed in.

A heading is `name [number] [(unit) | [unit] | /unit | in unit]`: m1, "m1 (g)", "time 2 [s]", a/(m/s²).
Uncertainties stand in a column u(name) or name_err, or ± behind that of the quantity; a unit of their own may
follow. Blanks and underscores in names do not count. Any other heading is named by the user, as by
--column t='Fallzeit (s)'.
"""

import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from typing import NamedTuple
from unicodedata import normalize

from ..model.scene import Input, SceneError, parameter_of, read_input
from ..model.units import PERCENT, Malformed, in_quotes, read_unit, symbol_of, without_blanks
from .sources import Unreadable

PARTED_BY = {",": "commas", "\t": "tabs", ";": "semicolons"}
NO_UNIT = ("", "-", "1")
EMPTY = ("", "NA", "NULL", "null")
"""Cells without a number: besides those that are empty, what R and databases write."""
LONGEST = 80
"""Characters of a heading that may be recognised: the patterns take long for long texts."""
DIVIDED = (r"(.+?)[ /]*[(\[]([^()\[\]]*)[)\]]", r"([^/]+?) ?(?:/| in ) ?(.+)")
"""A name and its unit: m1 (g), m1 [g], a/(m/s²); m1/g, m1 in g."""
UNCERTAINTY = re.compile(r"u ?\((.+)\)|(.+?)[ _]err")
BEHIND = ("±", "+/-")
"""The heading of uncertainties of the column before."""
OWN_UNIT = re.compile(r"(?![eE][+-]?\d)[^\W\d_]|°")
"""In a cell: a letter that is not an exponent's."""
PART_THOUSANDS = r"^\s*[+-]?[1-9]\d{0,2}(,\d{3})+(\.\d*)?\s*$"
ONE = Fraction(1)


class Vocabulary(NamedTuple):
    """The quantities that columns may hold.

    ``names`` maps each spelling, without blanks and underscores, to a parameter of the model. Columns of a
    quantity that is ``repeated`` may have numbers. Columns of uncertainties are known if ``uncertain``.
    """

    names: Mapping[str, str]
    repeated: Collection[str] = ()
    uncertain: bool = False


class Heading(NamedTuple):
    """A column that holds a quantity: its place, its heading, the unit of its cells, that unit in SI units.

    ``number`` says which of several columns of the quantity it is, ``u`` is the column of its uncertainties.
    """

    at: int
    column: str
    name: str
    number: str = ""
    unit: str = ""
    factor: Fraction = ONE
    u: "Heading | None" = None


class _Meaning(NamedTuple):
    """What a heading says. Without a name it is the uncertainty of the column before."""

    name: str
    number: str
    unit: str
    uncertain: bool


# Headings


def read_headings(
    columns: Sequence[str],
    vocabulary: Vocabulary,
    labels: Collection[str] = (),
    named: Mapping[str, str] = {},
) -> list[Heading]:
    """The columns that hold a quantity, in their order, each with its column of uncertainties.

    ``labels`` are headings that hold no quantity, whatever they look like, and ``named`` maps headings to
    names of this grammar. Raises Unreadable where two columns hold the same, a unit is wrong or an
    uncertainty belongs to no column, SceneError where the table lacks a heading that is ``named``.
    """
    if absent := [heading for heading in named if heading not in columns]:
        word = f"{named[absent[0]]}={absent[0]}"
        raise SceneError("column", word, f"is not there; there are {listed(columns)}")
    headings: dict[tuple[str, str], Heading] = {}
    uncertain: list[tuple[int, _Meaning]] = []
    for at, column in enumerate(columns):
        meaning = None if column in labels else _meaning(column, vocabulary, named)
        if meaning and meaning.uncertain:
            uncertain.append((at, meaning))
        elif meaning:
            key = meaning.name, meaning.number
            if column in named and key in headings and meaning.name in vocabulary.repeated:
                key = meaning.name, column  # a repeat that its user did not number
            if key in headings:
                number = f"number what is repeated, as '{key[0]} 1'" * (key[0] in vocabulary.repeated)
                two = f"{in_quotes(headings[key].column)} and {in_quotes(column)} are both {key[0]}"
                raise Unreadable(f"columns {two}; {number or 'rename one'}{_let_pass(column)}")
            factor = unit_factor(key[0], meaning.unit, column)
            headings[key] = Heading(at, column, *key, meaning.unit, factor)
    for at, meaning in uncertain:
        _add_uncertainty(headings, at, columns[at], meaning)
    return list(headings.values())


def recognised(columns: Sequence[str], vocabulary: Vocabulary, named: Mapping[str, str] = {}) -> list[str]:
    """The columns that the vocabulary knows, or that are named."""
    return [column for column in columns if _meaning(column, vocabulary, named)]


def read_named(words: Iterable[str], vocabulary: Vocabulary) -> dict[str, str]:
    """The names by headings, of options --column NAME=HEADING. Raises SceneError."""
    named: dict[str, str] = {}
    for word in words:
        name, equals, heading = word.partition("=")
        if not equals or not heading or heading in named:
            raise SceneError("column", word, "must be NAME=HEADING, as t='Fallzeit (s)', each heading once")
        if not (meaning := _meaning(name, vocabulary, {})) or not meaning.name:
            there = ", ".join(dict.fromkeys(vocabulary.names.values()))
            raise SceneError("column", word, f"has no name of a quantity before =; there are {there}")
        named[heading] = name
    return named


def _meaning(column: str, vocabulary: Vocabulary, named: Mapping[str, str]) -> _Meaning | None:
    """What a heading says; None if it is not known."""
    name = without_blanks(named.get(column, column))
    meanings = (_named(word, unit, vocabulary) for word, unit in divisions(name))
    meaning = next(filter(None, meanings), None)
    if meaning and column in named and not meaning.unit:  # the heading itself may have one
        *_, (_, unit) = divisions(without_blanks(column))
        return meaning._replace(unit=unit)
    return meaning


def divisions(text: str) -> Iterator[tuple[str, str]]:
    """The ways to read a heading as a name and a unit, first as a name alone."""
    yield text, ""
    found = (re.fullmatch(pattern, text) for pattern in DIVIDED if len(text) <= LONGEST)
    if match := next(filter(None, found), None):
        unit = match[2].strip()
        yield match[1].strip(), "" if unit in NO_UNIT else unit


def _named(word: str, unit: str, vocabulary: Vocabulary) -> _Meaning | None:
    """What a name without its unit says."""
    uncertain = False
    if vocabulary.uncertain:
        if word in BEHIND:
            return _Meaning("", "", unit, True)
        if found := UNCERTAINTY.fullmatch(word):
            word, uncertain = found[1] or found[2], True
    key = re.sub(r"[\s_]", "", normalize("NFKC", word))
    if name := vocabulary.names.get(key):
        return _Meaning(name, "", unit, uncertain)
    letters = key.rstrip("0123456789")
    name = vocabulary.names.get(letters, "")
    return _Meaning(name, key[len(letters) :], unit, uncertain) if name in vocabulary.repeated else None


def _add_uncertainty(
    headings: dict[tuple[str, str], Heading], at: int, column: str, meaning: _Meaning
) -> None:
    """Give quantities their column of uncertainties. Raises Unreadable."""
    name, number, unit, _ = meaning
    of = [
        key
        for key, own in headings.items()
        if (own.name == name and number in ("", own.number) if name else own.at == at - 1)
    ]
    if not of:
        raise refused(column, "could be an uncertainty, but no column is what it would be of")
    for key in of:
        own = headings[key]
        if own.u:
            raise refused(column, f"is a second uncertainty of {own.name}")
        factor = unit_factor(own.name, unit, column) if unit not in ("", PERCENT) else own.factor
        headings[key] = own._replace(u=Heading(at, column, own.name, own.number, unit, factor))


def unit_factor(name: str, unit: str, column: str) -> Fraction:
    """The factor from the unit of a column to the SI, or to degrees. Raises Unreadable."""
    if not unit:
        return ONE
    dimension = "force" if name == "axle" else parameter_of(name).dimension
    try:
        if dimension is None:
            raise Malformed(f"must hold plain numbers, without the {in_quotes(unit)}")
        if symbol_of(unit) == "rad":
            raise Malformed("has angles in radians; give degrees or turns")
        return read_unit(unit, dimension)
    except Malformed as error:
        raise refused(column, str(error)) from None


def refused(column: str, why: str) -> Unreadable:
    """The error for a heading, with the way to let it pass."""
    return Unreadable(f"column {in_quotes(column)} {why}{_let_pass(column)}")


def _let_pass(column: str) -> str:
    return f"; or let it pass by --label {in_quotes(column)}"


def listed(names: Sequence[str], most: int = 12) -> str:
    """Headings in a sentence."""
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return f"{', '.join(map(in_quotes, names[:most]))}{more}"


def read_as(
    headings: Iterable[Heading], separator: str, usual: str, comma: bool, others: Iterable[str] = ()
) -> list[str]:
    """A line that says how a table was read; none if it was as usual."""
    parts = [f"cells parted by {PARTED_BY[separator]}"] if separator != usual else []
    parts += ["decimal commas"] if comma else []
    said = {one.at: (one.column, one.name, one.unit) for one in headings}
    said |= {one.u.at: (one.u.column, f"u({one.name})", one.u.unit) for one in headings if one.u}
    for _, (column, name, unit) in sorted(said.items()):
        if column != name:
            parts.append(f"{in_quotes(column)} as {name}{f' in {unit}' if unit else ''}")
    parts += others
    return [f"read as: {', '.join(parts)}."] if parts else []


# Cells


def decimal_commas_in(rows: Iterable[Sequence[str]], places: Collection[int], separator: str) -> bool:
    """Whether commas in those places of rows are decimal: between semicolons all are, and between tabs
    unless each separates thousands.
    """
    if separator in ("", ","):
        return False
    with_comma = [cell for row in rows for at in places if (cell := row[at]) and "," in cell]
    return any(separator == ";" or not re.match(PART_THOUSANDS, cell) for cell in with_comma)


def pointed(name: str, cell: str, comma: bool) -> str:
    """A cell with a decimal point, without blanks around it. Raises SceneError."""
    if comma and "." in cell:
        raise SceneError(name, cell, "has a point in a table of decimal commas; write all alike")
    return (cell.replace(",", ".") if comma else cell).strip()


def read_cell(heading: Heading, cell: str, comma: bool) -> Input | None:
    """The number in a cell, exact and in SI units, with its uncertainty; None if the cell is empty.

    A unit in the cell goes before that of the heading. Raises SceneError.
    """
    text = pointed(heading.name, cell, comma)
    if text in EMPTY:
        return None
    try:
        value, uncertainty, _ = read_input(heading.name, text)
    except SceneError as error:
        raise SceneError(heading.name, cell, error.rule) from None
    factor = ONE if OWN_UNIT.search(text) else heading.factor
    return Input(value * factor, uncertainty * factor, cell)


def read_uncertainty(heading: Heading, cell: str, value: Fraction, comma: bool) -> Fraction:
    """The uncertainty of a value, by the cell in the column of its uncertainties. Raises SceneError."""
    number = pointed(heading.column, cell, comma).lstrip("± ")
    relative = number.endswith(PERCENT) or heading.unit == PERCENT
    number = number.removesuffix(PERCENT)
    try:
        spread = read_input(heading.name, f"1±{number}{PERCENT * relative}").uncertainty
    except SceneError:
        raise SceneError(heading.column, cell, "is no uncertainty; write it like 0.02 or 2%") from None
    return spread * (abs(value) if relative else ONE if OWN_UNIT.search(number) else heading.factor)
