"""Headings as laboratories write them: which columns of a table are what runs are made of.

A heading is known by its spelling and its unit alone. What could be two things is refused.
"""

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import combinations
from typing import Literal, NamedTuple
from unicodedata import normalize

from ..batch.layout import NO_UNIT, Heading, is_unit, listed, meant, refused, unit_factor
from ..files import Unreadable
from ..model.scene import parameter_of
from ..model.units import PERCENT, in_quotes, without_blanks

Kind = Literal["a", "time"]

RESULTS = ("rows", "u", "expected", "residual")
"""What else is said of a run, by names that no label may have."""
TAKEN = ("m1", "m2", "drop", "a", "time")
"""What a run is made of; what else a scene has is the same in all of them."""
MEASURED = ("a", "time")
"""What may be measured more than once, in numbered columns."""
MASSES = {"m1": (1, 0), "m2": (0, 1), "m1+m2": (1, 1), "m2-m1": (-1, 1), "m1-m2": (1, -1)}
"""Multiples of m1 and m2 that a column may hold. Two such columns are taken, the first of these."""
SPELLINGS = {
    spelling: name
    for name, spellings in {
        "m1": "m1 M1 mass1 massm1 lightermass mlight",
        "m2": "m2 M2 mass2 massm2 heaviermass mheavy",
        "m1+m2": "m1+m2 m2+m1 mtotal mtot totalmass masstotal",
        "m2-m1": "m2-m1 dm deltam massdifference mdiff",
        "m1-m2": "m1-m2",
        "drop": "drop dropheight dropdistance height heighth fallheight heightoffall distance fall",
        "a": "a acc accel acceleration accelerationa aexp ameas ameasured measuredacceleration",
        "time": "t time timet times falltime timeoffall droptime",
    }.items()
    for spelling in spellings.split()
}
"""What a heading may call it, as `_key` writes it."""
WITH_UNIT = SPELLINGS | {"T": "time", "A": "a", "h": "drop", "H": "drop", "s": "drop", "d": "drop"}
"""The same with letters that have other meanings too, but for their unit."""
EITHER = ("dm", "deltam")
"""A difference or an uncertainty."""
REWRITTEN = (
    (r"(?:latest|data ?set(?: ?\d+)?) ?[:|](.*)", r"\1"),
    (r"(run ?#?\d+) ?[:|]([^(\[]+)(.*)", r"\2 \1 \3"),
    (r"([^(\[]+)([(\[].*[)\]]) ((?:run|trial)? ?#?\d+)", r"\1 \3 \2"),
)
"""Headings of loggers: `Latest: Time (s)` and `Run 1: Time (s)` (Vernier), `Time (s) Run #1` (PASCO)."""
DIVIDED = (
    r"(.+?)[ /]*[(\[{]([^()\[\]{}]*)[)\]}]",
    r"(.+)[ _](kg|g|mg|m|cm|mm|s|ms|c?m/s(?:\^?2|²)|%)",
    r"([^/,]+?)(?:[/,]| in )(.+)",
)
"""A name and its unit: m1 (g), m1 [g], a/(m/s²); m1_g; m1/g, "m1, g" and m1 in g."""
LONGEST = 80
"""Characters of a heading that may be known: the patterns take long for long texts."""
NUMBERED = re.compile(r"(.*?)((?:run|trial)?#?)(\d+)")
ALONE = ("±", "+/-", "+-", "u", "uncertainty")
"""The uncertainty of the column before."""
_U = r"(?:uncertainty|uncert|unc|u|error|err|delta|sigma|±|\+/-|\+-)"
UNCERTAIN = re.compile(rf"(?:{_U}|d)(?:of|in)?(?P<behind>\w.*)|{_U}\((?P<within>.+)\)|(?P<before>.+?){_U}")
"""u_a, u(a) and a_u, in all ways to say u."""
MINUS, GREEK = str.maketrans("−", "-"), str.maketrans({"δ": "delta", "σ": "sigma"})


class Named(NamedTuple):
    """What a heading says: a quantity, the number of a repeat, a unit; each is empty if it says none.

    If ``uncertain`` it is the uncertainty of that quantity, without a name that of the column before.
    """

    name: str
    number: str
    unit: str
    uncertain: bool = False


class Quantity(NamedTuple):
    """A column that runs are made of, with the place and heading of the column of its uncertainties."""

    at: int
    name: str
    number: str
    heading: Heading
    u: tuple[int, Heading] | None = None


def _named(heading: str) -> Named | None:
    """What a heading says of a run; None if it is not known."""
    text = without_blanks(heading)
    if len(text) > LONGEST:
        return None
    for pattern, order in REWRITTEN:
        if found := re.fullmatch(pattern, text, re.IGNORECASE):
            text = without_blanks(found.expand(order))
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
    """The ways in which a heading may be a name and a unit."""
    yield text, ""
    for pattern in DIVIDED:
        if found := re.fullmatch(pattern, text):
            unit = found[2].strip()
            yield found[1].strip(), "" if unit in NO_UNIT else unit


def _key(name: str) -> str:
    """A name in small letters, but for one capital alone (a tension T), without blanks, dots, underscores."""
    plain = re.sub(r"[\s_.]+(?!\()", "", normalize("NFKC", name).translate(MINUS))
    return plain if re.fullmatch(r"[A-Z]\d*", plain) else plain.casefold().translate(GREEK)


def _quantity(key: str, known: Mapping[str, str], unit: str = "") -> tuple[str, str] | None:
    """The quantity that a key names, and its number, empty if it has none."""
    if name := known.get(key) or known.get(key.replace("-", "")):
        return name, ""
    if not (found := NUMBERED.fullmatch(key)):
        return None
    base, run, number = found.groups()
    name = known.get(base.rstrip("-"))
    if run and not base and unit:  # Trial 1 (s)
        name = next((one for one in MEASURED if is_unit(unit, one)), None)
    return (name, number) if name and (run or name in MEASURED) else None


def recognised(columns: Sequence[str]) -> list[str]:
    return [column for column in columns if _named(column)]


def as_parameter(name: str) -> str:
    """The parameter that has the unit and the domain of a quantity."""
    return "m1" if name in MASSES else name


def quantities_among(
    columns: Sequence[str], labels: Collection[str]
) -> tuple[list[Quantity], dict[str, int]]:
    """What is taken of the columns, and the places of all others that have a heading. Raises Unreadable."""
    quantities: list[Quantity] = []
    others: dict[str, int] = {}
    uncertain: list[tuple[int, Named]] = []
    for at, column in enumerate(columns):
        named = None if column in labels else _named(column)
        if named and named.uncertain:
            uncertain.append((at, named))
        elif named:
            for one in quantities:
                if one.name == named.name and (one.number == named.number or one.name not in MEASURED):
                    both = (
                        f"columns {in_quotes(one.heading.column)} and {in_quotes(column)} are both {one.name}"
                    )
                    repeats = "number what is repeated, as in 'time 1', or " * (one.name in MEASURED)
                    raise Unreadable(f"{both}; {repeats}let one pass by --label {in_quotes(column)}")
            factor = unit_factor(as_parameter(named.name), named.unit, column)
            quantities.append(Quantity(at, named.name, named.number, Heading(column, named.unit, factor)))
        elif column.strip():
            if column in others:
                raise Unreadable(f"column {in_quotes(column)} is there {columns.count(column)} times")
            if column in RESULTS:
                raise Unreadable(
                    f"column {in_quotes(column)} would be there twice, as a result is named so; rename it"
                )
            if column not in labels:
                _check_unknown(column)
            others[column] = at
    for at, named in uncertain:
        quantities = _with_uncertainty(quantities, at, columns[at], named)
    for one in quantities:
        if one.u and any(one.name == other.name and not other.u for other in quantities):
            how = f"name it u({one.name}) if it is that of each {one.name}"
            raise refused(
                one.u[1].column, f"is the uncertainty of {in_quotes(one.heading.column)} alone; {how}"
            )
    return quantities, others


def _with_uncertainty(quantities: list[Quantity], at: int, column: str, named: Named) -> list[Quantity]:
    """The quantities, one or more of them with that column as their uncertainty. Raises Unreadable."""

    def belongs(one: Quantity) -> bool:
        if not named.name:
            return one.at == at - 1
        return one.name == named.name and named.number in ("", one.number)

    of = [one for one in quantities if belongs(one)]
    if not of:
        why = f"no column is {named.name}" if named.name else "the column before is no part of a run"
        raise refused(column, f"could be an uncertainty, but {why}")
    name = of[0].name
    if name not in TAKEN:
        raise refused(column, f"is an uncertainty of {name}, which is not taken; give m1 and m2 with theirs")
    if any(one.u for one in of):
        raise refused(column, f"is a second uncertainty of {name}")
    factor = unit_factor(name, named.unit, column) if named.unit not in ("", PERCENT) else None
    return [
        one._replace(u=(at, Heading(column, named.unit, factor or one.heading.factor))) if one in of else one
        for one in quantities
    ]


def _check_unknown(column: str) -> None:
    """Refuse a heading that is likely to be no label. Raises Unreadable."""
    if len(column) > LONGEST:
        return
    key = _key(column)
    if letter := _quantity(key, WITH_UNIT):
        like = f"{column} ({parameter_of(letter[0]).unit})"
        raise refused(column, f"could be meant for {letter[0]}; give its unit, as in {in_quotes(like)}")
    if any(re.fullmatch(_U, _key(name)) for name, _ in _divisions(without_blanks(column))):
        raise refused(column, "could be an uncertainty; name what of, as in 'u(a)'")
    name = meant(column)
    if name in TAKEN:
        like = f"{name} ({parameter_of(name).unit})"
        raise refused(column, f"could be meant for {name}; name it so, with a unit like {in_quotes(like)}")
    if name is not None:
        raise refused(column, f"holds for all runs, so it is an option: give --{name.replace('_', '-')}")


def _missing(what: str, unknown: Sequence[str], columns: Sequence[str]) -> Unreadable:
    """The error where no column is what a run needs: of headings that are not known, one may be it."""
    if not unknown:
        return Unreadable(f"column {what} is missing; there are {listed(columns) or 'none'}")
    how = "a row is a run, with m1, m2, and a or time: name them so, with units, as in 'm1 (g)'"
    return Unreadable(f"{not_known(unknown)}; {how}")


def not_known(unknown: Sequence[str]) -> str:
    many = len(unknown) > 1
    return f"column{'s' * many} {listed(unknown)} {'are' if many else 'is'} not known"


def two_of_masses(
    quantities: Sequence[Quantity], unknown: Sequence[str], columns: Sequence[str]
) -> tuple[Quantity, Quantity]:
    """The two columns that tell the masses. Raises Unreadable."""
    there = {one.name: one for one in quantities}
    pairs = combinations([there[name] for name in MASSES if name in there], 2)
    pair = next((pair for pair in pairs if determinant(*pair)), None)
    if pair is None:
        raise _missing(next(name for name in MASSES if name not in there), unknown, columns)
    for one in there.values():
        if one not in pair and any(_key(name) in EITHER for name, _ in _divisions(one.heading.column)):
            how = "name it m2-m1, or u(m1) and u(m2)"
            raise refused(
                one.heading.column, f"could be the difference of the masses, or their uncertainty; {how}"
            )
    return pair


def determinant(one: Quantity, other: Quantity) -> int:
    (a, b), (c, d) = MASSES[one.name], MASSES[other.name]
    return a * d - b * c


def kind_of(quantities: Sequence[Quantity], unknown: Sequence[str], columns: Sequence[str]) -> Kind:
    names = [one.name for one in quantities]
    if "a" in names and "time" in names:
        raise Unreadable(
            "columns a and time both tell the acceleration; keep one, or let one pass by --label"
        )
    if "a" not in names and "time" not in names:
        raise _missing("a or time", unknown, columns)
    return "a" if "a" in names else "time"
