"""Headings as laboratories write them: which columns of a table make a run.

A heading is recognised by its spelling and its unit. What could be two things is refused.
"""

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Literal, NamedTuple
from unicodedata import normalize

from ..batch.layout import NO_UNIT, Heading, is_unit, listed, meant, refused, unit_factor
from ..files import Unreadable
from ..model.scene import parameter_of
from ..model.units import PERCENT, in_quotes, without_blanks

Kind = Literal["a", "time"]

TAKEN = ("m1", "m2", "drop", "a", "time")
"""The quantities of a run; what else a scene has is the same in all runs."""
MASSES = {"m1": (1, 0), "m2": (0, 1), "m1+m2": (1, 1), "m2-m1": (-1, 1)}
"""The multiples of m1 and m2 that a column may hold. Two such columns determine both masses."""
MEASURED = {"a": "acceleration", "time": "time"}
"""The quantities that are measured, which may be repeated in numbered columns."""
RESULTS = ("rows", "u", "expected", "residual")
"""The other columns of results, which no label may be called."""
SPELLINGS = {
    spelling: name
    for name, spellings in {
        "m1": "m1 M1 mass1 massm1 lightermass mlight",
        "m2": "m2 M2 mass2 massm2 heaviermass mheavy",
        "m1+m2": "m1+m2 m2+m1 mtotal mtot totalmass masstotal",
        "m2-m1": "m2-m1 dm deltam massdifference mdiff",
        "drop": "drop dropheight dropdistance height heighth fallheight heightoffall distance fall",
        "a": "a acc accel acceleration accelerationa aexp ameas ameasured measuredacceleration",
        "time": "t time timet times falltime timeoffall droptime",
    }.items()
    for spelling in spellings.split()
}
"""The quantities by their names, written as `_key` writes them."""
WITH_UNIT = SPELLINGS | {"T": "time", "A": "a", "h": "drop", "H": "drop", "s": "drop", "d": "drop"}
"""The same with letters that are clear only beside a unit."""
DIVIDED = (
    r"(.+?)[ /]*[(\[{]([^()\[\]{}]*)[)\]}]",
    r"(.+)[ _](kg|g|mg|m|cm|mm|s|ms|c?m/s(?:\^?2|²)|%)",
    r"([^/,]+?)(?:[/,]| in )(.+)",
)
"""A name and its unit: m1 (g), m1 [g], a/(m/s²); m1_g; m1/g, "m1, g" and m1 in g."""
LONGEST = 80
"""Characters of a heading that may be recognised: the patterns take long for long texts."""
LOGGED = re.compile(
    r"(?:latest|(?:run|data ?set) ?#?(\d*)) ?[:|](.+)|(.+[)\]}]) (?:(?:run|trial) ?)?#?(\d+)", re.IGNORECASE
)
"""Headings of data loggers: Latest: t (s), Data Set 1: t (s), Run 1: t (s), t (s) Run #1, t (s) 1."""
NUMBERED = re.compile(r"(.*?)((?:run|trial)?#?)(\d+)")
ALONE = ("±", "+/-", "+-", "u", "uncertainty")
"""The uncertainty of the column before."""
_U = r"(?:uncertainty|uncert|unc|u|error|err|delta|sigma|±|\+/-|\+-)"
UNCERTAIN = re.compile(rf"(?:{_U}|d)(?:of|in)?(?P<behind>\w.*)|{_U}\((?P<within>.+)\)|(?P<before>.+?){_U}")
"""u_a, u(a) and a_u, in all ways to write u."""
UNCERTAIN_OF_WHAT = re.compile(rf"{_U}|dm|deltam")
"""Δm is the difference of the masses, or an uncertainty."""
MINUS, GREEK = str.maketrans("−", "-"), str.maketrans({"δ": "delta", "σ": "sigma"})


class Named(NamedTuple):
    """What a heading names: a quantity, the number of a repeat, a unit; each is empty if there is none.

    If ``uncertain`` it is the uncertainty of that quantity, without a name that of the column before.
    """

    name: str
    number: str
    unit: str
    uncertain: bool = False


class Quantity(NamedTuple):
    """A column of a run, with the place and heading of the column of its uncertainties."""

    at: int
    name: str
    number: str
    heading: Heading
    u: tuple[int, Heading] | None = None


class Header(NamedTuple):
    """The columns of a table: those of a run, and the places of all others, by their headings."""

    kind: Kind
    quantities: Sequence[Quantity]
    others: Mapping[str, int]


def _named(heading: str) -> Named | None:
    """What a heading names; None if it is not recognised."""
    text = without_blanks(heading)
    if len(text) > LONGEST:
        return None
    if found := LOGGED.fullmatch(text):
        before, behind, heading, after = found.groups()
        if named := _named(behind or heading):
            number = before or after or named.number
            return named._replace(number=number if named.name in MEASURED else "")
    for name, unit in _divisions(text):
        key = _key(name)
        if key in ALONE:
            return Named("", "", unit, True)
        if quantity := _quantity(key, WITH_UNIT if unit else SPELLINGS, unit):
            return Named(*quantity, unit)
        if found := UNCERTAIN.fullmatch(key):
            within, beside = found["within"], found["behind"] or found["before"]
            # u(s) is rather in seconds than of the height s
            if quantity := _quantity(within, SPELLINGS) if within else _quantity(beside, WITH_UNIT):
                return Named(*quantity, unit, True)
    return None


def _divisions(text: str) -> Iterator[tuple[str, str]]:
    """The ways to read a heading as a name and a unit."""
    yield text, ""
    for pattern in DIVIDED:
        if found := re.fullmatch(pattern, text):
            unit = found[2].strip()
            yield found[1].strip(), "" if unit in NO_UNIT else unit


def _key(name: str) -> str:
    """A name in small letters (but for one capital alone, as T) without blanks, dots and underscores."""
    plain = re.sub(r"[\s_.]+(?!\()", "", normalize("NFKC", name).translate(MINUS))
    return plain if re.fullmatch(r"[A-Z]\d*", plain) else plain.casefold().translate(GREEK)


def _quantity(key: str, spellings: Mapping[str, str], unit: str = "") -> tuple[str, str] | None:
    """The quantity that a key names, and the number of its repeat, empty if it has none."""
    if name := spellings.get(key) or spellings.get(key.replace("-", "")):
        return name, ""
    if not (found := NUMBERED.fullmatch(key)):
        return None
    base, run, number = found.groups()
    name = spellings.get(base.rstrip("-"))
    if run and not base and unit:  # Trial 1 (s)
        name = next((one for one in MEASURED if is_unit(unit, one)), None)
    return (name, number) if name in MEASURED else None


def as_input(name: str) -> str:
    """The input that has the unit and the bounds of a quantity."""
    return "m1" if name in MASSES else name


def recognised(columns: Sequence[str]) -> list[str]:
    return [column for column in columns if _named(column)]


def read_header(columns: Sequence[str], labels: Collection[str]) -> Header:
    """The columns by what they are; ``labels`` belong to no run, however they look. Raises Unreadable."""
    quantities: dict[tuple[str, str], Quantity] = {}
    others: dict[str, int] = {}
    uncertain: list[tuple[int, Named]] = []
    for at, column in enumerate(columns):
        named = None if column in labels else _named(column)
        if named and named.uncertain:
            uncertain.append((at, named))
        elif named:
            if other := quantities.get(named[:2]):
                two = (
                    f"columns {in_quotes(other.heading.column)} and {in_quotes(column)} are both {named.name}"
                )
                repeats = "number what is repeated, as in 'time 1', or " * (named.name in MEASURED)
                raise Unreadable(f"{two}; {repeats}let one pass by --label {in_quotes(column)}")
            heading = Heading(column, named.unit, unit_factor(as_input(named.name), named.unit, column))
            quantities[named[:2]] = Quantity(at, named.name, named.number, heading)
        elif column.strip():
            if column in others:
                raise Unreadable(f"column {in_quotes(column)} is there {columns.count(column)} times")
            if column in RESULTS:
                raise Unreadable(f"column {in_quotes(column)} is called as a result is; rename it")
            if column not in labels:
                _check_label(column)
            others[column] = at
    for at, named in uncertain:
        _add_uncertainty(quantities, at, columns[at], named)
    names = {name for name, _ in quantities}
    kind = _kind_of(names, [x for x in others if x not in labels], columns)
    needed = [*[name for name in MASSES if name in names][:2], kind, *["drop"] * (kind == "time")]
    taken = [one for one in quantities.values() if one.name in needed]
    for one in quantities.values():
        if one.name not in needed:
            _check_uncertain(one.heading.column)
            others[one.heading.column] = one.at
    return Header(kind, taken, others)


def _add_uncertainty(quantities: dict[tuple[str, str], Quantity], at: int, column: str, named: Named) -> None:
    """Give quantities their column of uncertainties. Raises Unreadable."""
    of = [
        key
        for key, one in quantities.items()
        if (one.name == named.name and named.number in ("", one.number) if named.name else one.at == at - 1)
    ]
    if not of:
        raise refused(column, "could be an uncertainty, but no column is what it would be of")
    for key in of:
        one = quantities[key]
        if one.u:
            raise refused(column, f"is a second uncertainty of {one.name}")
        own_unit = named.unit not in ("", PERCENT)
        factor = unit_factor(as_input(one.name), named.unit, column) if own_unit else one.heading.factor
        quantities[key] = one._replace(u=(at, Heading(column, named.unit, factor)))


def _check_uncertain(column: str) -> None:
    """Refuse a heading that may be an uncertainty, but does not say of what. Raises Unreadable."""
    if any(UNCERTAIN_OF_WHAT.fullmatch(_key(name)) for name, _ in _divisions(without_blanks(column))):
        raise refused(column, "could be an uncertainty; name what of, as in 'u(a)'")


def _check_label(column: str) -> None:
    """Refuse a heading that is likely to be no label. Raises Unreadable."""
    if len(column) > LONGEST:
        return
    _check_uncertain(column)
    letter = _quantity(_key(column), WITH_UNIT)
    name = letter[0] if letter else meant(column)
    if name in TAKEN:
        like = f"{name} ({parameter_of(name).unit})"
        raise refused(column, f"could be meant for {name}; name it so, with a unit, like {in_quotes(like)}")
    if name is not None:
        raise refused(column, f"holds for all runs, so it is an option: give --{name.replace('_', '-')}")


def _kind_of(names: Collection[str], unknown: Sequence[str], columns: Sequence[str]) -> Kind:
    """Whether accelerations or times were measured; Unreadable if a run lacks a column, or has both."""
    if "a" in names and "time" in names:
        raise Unreadable("there are columns a and time; keep one, or let one pass by --label")
    kind: Kind = "a" if "a" in names else "time"
    missing = [name for name in MASSES if name not in names][:-2]  # two of the four determine both masses
    missing += ["a or time"] * (kind not in names)
    if missing and unknown:
        how = "a row is a run, with m1, m2, and a or time: name them so, with units, as in 'm1 (g)'"
        raise Unreadable(f"{not_recognised(unknown)}; {how}")
    if missing:
        raise Unreadable(f"column {missing[0]} is missing; there are {listed(columns) or 'none'}")
    return kind


def not_recognised(unknown: Sequence[str]) -> str:
    many = len(unknown) > 1
    return f"column{'s' * many} {listed(unknown)} {'are' if many else 'is'} not known"
