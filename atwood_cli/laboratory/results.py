"""The quantities that a fit gives, and their numbers as published: cut where their uncertainty begins."""

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any, NamedTuple

from ..explain.given import VERSION
from ..numbers.digits import format_number, rounding_to_uncertainty, strip_zeros, to_digits, with_uncertainty
from ..numbers.text import counted


class Quantity(NamedTuple):
    """The names of a quantity; with a ``letter`` it can be fitted, unless inputs ``given_by`` give it."""

    symbol: str
    unit: str
    words: str
    letter: str = ""
    given_by: tuple[str, ...] = ()


QUANTITIES = {
    "rim_mass": Quantity("c=I/R²", "kg", "the pulley's inertia", "c", ("M", "I")),
    "axle": Quantity("f_axle", "N", "axle friction", "f", ("axle",)),
    "gravity": Quantity("g", "m/s²", "gravity", "g", ("g",)),
    "delay": Quantity("Δt", "s", "a delay of all times", "delay"),
    "pulley_mass": Quantity("M", "kg", "the pulley's mass, if its shape is given"),
    "moment_of_inertia": Quantity("I", "kg m²", "the moment of inertia, if R is given"),
}
FITTED = [name for name, quantity in QUANTITIES.items() if quantity.letter]
USUAL = FITTED[:2]
"""Those that are fitted unless the user asks for others."""
SYMBOLS = {quantity.letter or quantity.symbol: name for name, quantity in QUANTITIES.items()}
RESULTS = {
    **{name: quantity.words for name, quantity in QUANTITIES.items()},
    "correlation": "the correlation of two results",
    "chi2": "χ² of the runs by the uncertainties stated, or by the scatter of repeats",
    "dof": "degrees of freedom: the runs less what is fitted",
    "interval_dof": "degrees of freedom of Student's t of intervals; none is the normal distribution",
    "between_runs": "the standard deviation between runs beyond that, of times, or of forces as masses",
    "between_runs_unit": "the unit of between_runs, s or kg",
    "runs": "each run, with what is expected of it",
}


class Result(NamedTuple):
    """A value, its standard uncertainty, and its interval of 95 %."""

    value: float
    uncertainty: float
    interval: tuple[float, float]


def published(value: float, uncertainty: float, interval: Sequence[float] = ()) -> tuple[str, str]:
    """Return a value ± its uncertainty, and its interval, all cut at the second digit of the uncertainty."""
    round_ = rounding_to_uncertainty(Fraction(uncertainty))
    value_, u, *ends = (round_(Fraction(x)) for x in (value, uncertainty, *interval))
    return with_uncertainty(value_, u, ends)


def as_determined(value: float, scale: float) -> float:
    """Return a value rounded at the seventh digit of an uncertainty: beyond, machines differ."""
    _, _, exponent = f"{scale:.16e}".partition("e")
    return round(value, 6 - int(exponent)) + 0.0


def equation(name: str, value: float, uncertainty: float) -> str:
    """Return a result in a line."""
    return f"{name} = {published(value, uncertainty)[0]} {QUANTITIES[name].unit}"


def cut(value: float | None, uncertainty: float | None) -> str:
    """Return a value cut at the second digit of an uncertainty, "" without either."""
    if value is None or not uncertainty:
        return ""
    number = rounding_to_uncertainty(Fraction(uncertainty))(Fraction(value))
    return f"{number:f}" if not number or number.adjusted() > -6 else f"{number:e}"


def rounded(value: float, digits: int = 2) -> str:
    """Return a value with a few digits, as people write it."""
    return format_number(strip_zeros(to_digits(digits)(Fraction(value))))


def in_python(option: str, value: str = "") -> str:
    """Return an option as a program has it: find='axle,delay'."""
    return f"{option}={value!r}" if value else option


class Fit(NamedTuple):
    """The results of a fit by name, in SI units; None if the runs do not determine a result.

    ``uncertainty`` and ``interval`` have the standard uncertainty of a result and both ends of its interval
    of 95 %. All times are too long by ``delay``, and ``notes`` say what is to be known besides.

    """

    rim_mass: float | None
    axle: float | None
    gravity: float | None
    delay: float | None
    pulley_mass: float | None
    moment_of_inertia: float | None
    uncertainty: Mapping[str, float]
    interval: Mapping[str, Sequence[float]]
    correlation: float | None
    chi2: float | None
    dof: int
    interval_dof: float | None
    between_runs: float | None
    between_runs_unit: str | None
    runs: Sequence[Mapping[str, Any]]
    notes: Sequence[str]

    def to_dict(self) -> dict[str, Any]:
        """Return the record that ``--json`` prints, for `json`."""
        from .columns import WORDS

        record: dict[str, Any] = {"version": VERSION, **self._asdict()}
        record |= {name: dict.fromkeys(QUANTITIES) | record[name] for name in ("uncertainty", "interval")}
        return record | {"runs": [{**dict.fromkeys(WORDS), **run} for run in self.runs]}

    def __repr__(self) -> str:
        results = [equation(x, getattr(self, x), u) for x, u in self.uncertainty.items()]
        return f"<Fit of {'; '.join([counted(len(self.runs), 'run'), *results])}>"

    def _repr_html_(self) -> str:
        from html import escape

        return f"<pre>{escape(str(self))}</pre>"

    def __str__(self) -> str:
        lines = [
            f"{equation(x, getattr(self, x), u)}, 95 %: {published(getattr(self, x), u, self.interval[x])[1]}"
            for x, u in self.uncertainty.items()
        ]
        return "\n".join([*lines, *self.notes])


Fit.__doc__ = f"{Fit.__doc__}{'; '.join(f'{name}: {words}' for name, words in RESULTS.items())}."
