"""The meaning of a table: its columns, their units, and whether its commas are decimal.

`m1`, `M [kg]` and `m1 (g)` are inputs. `pulley_mass` could be meant for one, and is refused with a hint.
"""

import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from fractions import Fraction
from math import inf, isfinite, nan
from typing import TYPE_CHECKING, NamedTuple
from unicodedata import normalize

from ..arithmetic.rounding import to_double
from ..files import Unreadable
from ..model.scene import INPUTS, MASSES, MEASURED, SceneError, parameter_of, read_plain, read_value
from ..model.units import Malformed, in_quotes, read_unit, symbol_of, without_blanks
from .formats import PARTED_BY, Piece

if TYPE_CHECKING:
    import polars as pl

NO_UNIT = ("", "-", "1")
NOT_GIVEN = ("NA", "NULL", "null")
"""What programs write into cells that are empty: of R, and of databases."""

# fmt: off
OTHER_NAMES = {
    **{"m_1": "m1", "mass1": "m1", "mass_1": "m1", "m_2": "m2", "mass2": "m2", "mass_2": "m2"},
    **dict.fromkeys(("m", "mp", "m_p", "m_pulley", "pulley", "pulley_mass", "mass_pulley"), "M"),
    **dict.fromkeys(("mu_s", "mus", "mu_static", "friction", "static_friction"), "mu"),
    **dict.fromkeys(("friction_coefficient", "coefficient_of_friction"), "mu"),
    **dict.fromkeys(("muk", "mu_kinetic", "kinetic_friction"), "mu_k"),
    **{"gravity": "g", "beta": "inertia", "inertia_factor": "inertia", "moment_of_inertia": "I"},
    **dict.fromkeys(("axle_friction", "bearing_friction"), "axle"),
    **{"r": "R", "radius": "R", "pulley_radius": "R", "wrap_angle": "wrap", "angle": "wrap", "phi": "wrap"},
}
# fmt: on
"""Other names of the inputs, in small ASCII letters."""
GREEK = str.maketrans({"μ": "mu", "φ": "phi", "ϕ": "phi", "β": "beta"})
LARGEST_POWER = 22
"""The largest power of ten that is a double."""


class Heading(NamedTuple):
    """The column of an input and the unit of its cells, with its factor to the SI (or to degrees)."""

    column: str
    unit: str = ""
    factor: Fraction = Fraction(1)


class Layout(NamedTuple):
    """The heading of each input, the separator of cells, and whether a comma is a decimal point."""

    headings: Mapping[str, Heading]
    separator: str = ""
    comma: bool = False

    def as_it_stands(self) -> "Layout":
        """The layout with numbers in the units of the headings, not in the SI."""
        headings = {name: Heading(heading.column) for name, heading in self.headings.items()}
        return self._replace(headings=headings)

    def pointed(self, cell: str) -> str:
        """A cell with a decimal point."""
        return cell.replace(",", ".") if self.comma else cell

    def as_doubles(self, name: str, cells: "pl.Series") -> "pl.Series":
        """The double nearest to each cell of a column, null where only `double` can tell."""
        import polars as pl

        factor = self.headings[name].factor
        power = len(str(max(factor, 1 / factor))) - 1
        if power > LARGEST_POWER or max(factor, 1 / factor) != 10**power:
            return pl.repeat(None, len(cells), dtype=pl.Float64, eager=True)
        if cells.dtype != pl.String:
            doubles = cells.cast(pl.Float64, strict=False)
            # A column, as polars would divide by a single number in two steps, and round twice.
            powers = pl.repeat(float(10**power), len(cells), eager=True)
            return doubles * powers if factor > 1 else doubles / powers
        if self.comma:
            cells = cells.set(cells.str.contains(".", literal=True), None)
            cells = cells.str.replace(",", ".", literal=True)

        def read(cells: pl.Series) -> pl.Series:
            exact = cells + f"e{power if factor > 1 else -power}" if power else cells
            return exact.cast(pl.Float64, strict=False)

        doubles = read(cells)
        # Blanks around a number are no part of it.
        return doubles if doubles.null_count() == cells.null_count() else read(cells.str.strip_chars())

    def double(self, name: str, cell: str | float) -> float:
        """A cell as the double nearest to it in the SI, NaN if it is not given. Raises SceneError."""
        if isinstance(cell, str):
            cell = cell.strip()
            if not cell or cell in NOT_GIVEN:
                return nan
            if self.comma and "." in cell:
                raise SceneError(name, cell, "has a point in a table of decimal commas; write all alike")
            exact = read_plain(name, cell, self.pointed(cell))
        else:
            read_value(name, cell)  # raises where it is NaN, or infinite and must not be
            exact = Fraction(cell) if isfinite(cell) else inf
        if exact == inf and parameter_of(name).inf:
            return inf
        value = to_double(Fraction(exact) * self.headings[name].factor)
        if abs(value) == inf or (exact and not value):
            raise SceneError(name, cell, "is beyond the range of doubles, 4.9e-324 to 1.8e308")
        return value


def read_layout(piece: Piece, labels: Collection[str] = ()) -> Layout:
    """How to read a table, by its columns and first rows. Raises Unreadable.

    A column that could be meant for an input and is none must be among the ``labels``.
    """
    headings = _headings(piece.columns, labels)
    others = {column: meant(column) for column in piece.columns if column not in (*labels, *INPUTS)}
    for column, name in others.items():
        if name in INPUTS and name not in headings:
            raise refused(column, f"could be meant for {name}; name it so, with a unit like 'm1 (g)'")
    for name in MASSES:
        if name not in headings:
            raise Unreadable(f"column {name} is missing; there are {listed(piece.columns)}")
    for column, name in others.items():
        if name in MEASURED:
            raise refused(column, "tells of a motion, which only solve takes")
    cells = piece.frame.select(heading.column for heading in headings.values())
    comma = decimal_commas_in(cells.iter_rows(), range(cells.width), piece.separator)
    return Layout(headings, piece.separator, comma)


def read_as(
    headings: Iterable[tuple[str, Heading]],
    separator: str,
    usual: str,
    comma: bool,
    others: Iterable[str] = (),
) -> list[str]:
    """A line that says how a table was read; none if it was as usual."""
    parts = [f"cells parted by {PARTED_BY[separator]}"] if separator != usual else []
    parts += ["decimal commas"] if comma else []
    for name, (column, unit, _) in headings:
        if column != name:
            parts.append(f"{in_quotes(column)} as {name}{f' in {unit}' if unit else ''}")
    parts += others
    return [f"read as: {', '.join(parts)}."] if parts else []


PART_THOUSANDS = r"^\s*[+-]?[1-9]\d{0,2}(,\d{3})+(\.\d*)?\s*$"


def decimal_commas_in(rows: Iterable[Sequence[str]], places: Collection[int], separator: str) -> bool:
    """Whether commas in those places of rows are decimal: between semicolons all are, and between tabs
    unless each separates thousands.
    """
    if separator in ("", ","):
        return False
    with_comma = [cell for row in rows for at in places if (cell := row[at]) and "," in cell]
    return any(separator == ";" or not re.match(PART_THOUSANDS, cell) for cell in with_comma)


def inputs_among(columns: Sequence[str], labels: Collection[str] = ()) -> list[str]:
    """The columns with the name of an input, with any unit, that are not labels."""
    return [column for column in columns if column not in labels and divided(column)[0] in INPUTS]


def has_masses(inputs: Iterable[str]) -> bool:
    """Whether columns of inputs include both masses, as a table must."""
    return {*MASSES} <= {divided(column)[0] for column in inputs}


def _headings(columns: Sequence[str], labels: Collection[str]) -> dict[str, Heading]:
    """The inputs among the columns, by name. Raises Unreadable."""
    headings: dict[str, Heading] = {}
    for column in inputs_among(columns, labels):
        name, unit = divided(column)
        if name in headings:
            two = " and ".join(map(in_quotes, (headings[name].column, column)))
            raise Unreadable(f"columns {two} are both {name}")
        headings[name] = Heading(column, unit, unit_factor(name, unit, column))
    return headings


def divided(column: str) -> tuple[str, str]:
    """The name in a heading, and the unit in brackets after it, empty if there is none."""
    word = without_blanks(column)
    for opening, closing in ("()", "[]"):
        name, bracket, unit = word.removesuffix(closing).partition(opening)
        if bracket and word.endswith(closing):
            return name.strip(), "" if unit.strip() in NO_UNIT else unit.strip()
    return word, ""


def unit_factor(name: str, unit: str, column: str) -> Fraction:
    """The factor from the unit of a column to the SI, or to degrees. Raises Unreadable."""
    if not unit:
        return Fraction(1)
    dimension = "force" if name == "axle" else parameter_of(name).dimension
    try:
        if dimension is None:
            raise Malformed(f"must hold plain numbers, without the {in_quotes(unit)}")
        if symbol_of(unit) == "rad":
            raise Malformed("has angles in radians; give degrees or turns")
        return read_unit(unit, dimension)
    except Malformed as error:
        raise refused(column, str(error)) from None


def meant(column: str) -> str | None:
    """The input that a heading could be meant for: with other letters, another name, or a unit after it."""
    name = divided(column)[0]
    if name in ("I", "i"):  # i may count rows
        return name if name == "I" else None
    letters = normalize("NFKC", name).casefold().translate(GREEK)
    words = [word for word in re.split("[^0-9a-z]+", letters) if word]
    for key in ("_".join(words), "_".join(words[:-1])):
        known = {one.lower(): one for one in (*reversed(INPUTS), *MEASURED)}
        meant = OTHER_NAMES.get(key) or known.get(key)
        if meant and (key == "_".join(words) or is_unit(words[-1], meant)):
            return meant
    return None


def is_unit(word: str, name: str) -> bool:
    """Whether an input may be given in that unit."""
    dimension = parameter_of(name).dimension
    try:
        return dimension is not None and bool(read_unit(word, dimension))
    except Malformed:
        return False


def refused(column: str, why: str) -> Unreadable:
    return Unreadable(f"column {in_quotes(column)} {why}; or let it pass by --label {in_quotes(column)}")


def listed(names: Sequence[str], most: int = 12) -> str:
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return f"{', '.join(map(in_quotes, names[:most]))}{more}"
