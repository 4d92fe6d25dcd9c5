"""The quantities that a fit gives: one table for options, results, tables and sentences."""

from typing import NamedTuple


class Quantity(NamedTuple):
    """What a quantity is called; with a letter it can be fitted, unless the inputs ``given_by`` give it."""

    symbol: str
    unit: str
    words: str
    letter: str = ""
    small_unit: str = ""
    given_by: tuple[str, ...] = ()


QUANTITIES = {
    "rim_mass": Quantity("c=I/R²", "kg", "the pulley's inertia", "c", "g", ("M", "I")),
    "axle": Quantity("f", "N", "axle friction", "f", "mN", ("axle",)),
    "gravity": Quantity("g", "m/s²", "gravity", "g", "mm/s²", ("g",)),
    "pulley_mass": Quantity("M", "kg", "the pulley's mass, if its shape is given"),
    "moment_of_inertia": Quantity("I", "kg m²", "the moment of inertia, if R is given"),
}
FITTED = [name for name, one in QUANTITIES.items() if one.letter]
USUAL = FITTED[:2]
"""Those that are fitted unless the user asks for others."""
SYMBOLS = {one.letter or one.symbol: name for name, one in QUANTITIES.items()}
SMALL = 1e-3
"""A small unit in units."""
