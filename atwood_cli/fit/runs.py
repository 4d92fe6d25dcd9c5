"""A table of runs: which columns are masses, heights and measurements, and the runs that its rows make."""

import re
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from fractions import Fraction
from typing import Literal, NamedTuple

from ..batch.formats import Cells
from ..batch.layout import Heading, decimal_commas_in, divided, listed, meant, read_as, refused, unit_factor
from ..batch.quoted import Unreadable
from ..model.scene import Input, SceneError, parameter_of, read_input

Kind = Literal["a", "time"]

RESULTS = ("rows", "u", "expected", "residual")
"""What else is said of a run, by names that no label may have."""
TAKEN = ("m1", "m2", "drop", "a", "time")
"""What a run is made of; what else a scene has is the same in all of them."""
REPEATED = re.compile(r"(a|time)[ _]?\d+")
ALSO_CALLED = {
    **dict.fromkeys(("t", "t1", "t_1", "times", "fall_time"), "time"),
    **dict.fromkeys(("h", "height", "distance", "fall", "drop_height", "s"), "drop"),
    **dict.fromkeys(("acceleration", "acc"), "a"),
}
"""In small letters, what else people call them."""
OWN_UNIT = re.compile(r"(?![eE][+-]?\d)[^\W\d_]|°")
"""In a cell: a letter that is not an exponent's."""


MEASURABLE = 1e-30, 1e30
BEYOND = f"is beyond what a fit computes with, {MEASURABLE[0]} to {MEASURABLE[1]:.0e}"


def in_range(one: Input) -> bool:
    """Whether a number, and its uncertainty, are 0 or of a size that no square of them leaves the doubles."""
    low, high = MEASURABLE
    sizes = (abs(getattr(one.value, "number", one.value)), one.uncertainty)
    return all(size == 0 or low <= size <= high for size in sizes)


class Run(NamedTuple):
    """Masses, the height of fall if there is one, and what was measured once or more often.

    ``rows`` are the numbers of its rows, which are alike but for what was measured and for ``labels``.
    """

    rows: tuple[int, ...]
    labels: Mapping[str, str]
    m1: Input
    m2: Input
    drop: Input | None
    measured: tuple[Input, ...]

    @property
    def name(self) -> str:
        """How a sentence calls it."""
        return f"row {self.rows[0]}" if len(self.rows) == 1 else f"rows {', '.join(map(str, self.rows))}"


class Runs(NamedTuple):
    """The runs of a table, and how it was read.

    ``one_drop`` says that they share their height of fall, ``signed`` that accelerations have signs, as one
    of them is negative: they are positive when m2 descends.
    """

    kind: Kind
    runs: Sequence[Run]
    one_drop: bool
    signed: bool
    labels: Sequence[str]
    remarks: Sequence[str]


def inputs_of_runs(columns: Sequence[str]) -> list[str]:
    """The columns that are named as what a run is made of."""
    return [column for column in columns if _taken(divided(column)[0])]


def _taken(name: str) -> str:
    """What a run has by that name, which may be numbered; empty if it is none of it."""
    repeated = REPEATED.fullmatch(name)
    return repeated[1] if repeated else name if name in TAKEN else ""


def read_runs(cells: Cells, usual: str, labels: Collection[str] = (), drop: Input | None = None) -> Runs:
    """The runs of a table, whose height of fall may be ``drop`` for all of them; SceneError, Unreadable."""
    headings = _headings(cells.columns, labels)
    kind = _kind(headings, cells.columns)
    one_drop = "drop" not in [name for name, _ in headings]
    if kind == "time" and drop is None and one_drop:
        raise Unreadable("times need the height of fall: a column drop, or --drop")
    if drop is not None and not in_range(drop):
        raise SceneError("drop", drop.given, BEYOND)
    if drop is not None and not (kind == "time" and one_drop):
        raise SceneError(
            "drop", drop.given, "has no part here: the table has " + ("drop" if kind == "time" else "a")
        )
    taken = [heading.column for _, heading in headings]
    comma = decimal_commas_in(cells, taken)
    others = [column for column in cells.columns if column not in taken]
    runs: dict[object, Run] = {}
    remarks = read_as(headings, cells.separator, usual, comma)
    for number, row in enumerate(cells.rows, 1):
        words = dict(zip(cells.columns, row, strict=True))
        try:
            read = [(name, _read(name, heading, words[heading.column], comma)) for name, heading in headings]
        except SceneError as error:
            raise Unreadable(f"row {number}: {error}") from None
        one = {name: value for name, value in read if value is not None}
        for name in ("m1", "m2", *["drop"] * (kind == "time" and not one_drop)):
            if name not in one:
                raise Unreadable(f"row {number} has no {name}")
        measured = tuple(value for name, value in read if name == kind and value is not None)
        if not measured:
            remarks.append(f"Row {number} has no {kind}: it is no run.")
            continue
        height = one.get("drop", drop) if kind == "time" else None
        run = Run((number,), {name: words[name] for name in others}, one["m1"], one["m2"], height, measured)
        key = (run.m1[:2], run.m2[:2], run.drop and run.drop[:2])
        if before := runs.get(key):  # a repeat
            run = before._replace(rows=(*before.rows, number), measured=(*before.measured, *measured))
        runs[key] = run
    if not runs:
        raise Unreadable("it has no runs")
    negative = any(one.value < 0 for run in runs.values() for one in run.measured)
    if kind == "a" and not negative and any(run.m1.value > run.m2.value for run in runs.values()):
        remarks.append(
            "accelerations have no sign here: none is negative, though m1 is the heavier at times."
        )
    return Runs(kind, list(runs.values()), one_drop, negative, others, remarks)


def _headings(columns: Sequence[str], labels: Collection[str]) -> list[tuple[str, Heading]]:
    """What is taken of the columns, in their order; a measurement may have several. Raises Unreadable."""
    headings: list[tuple[str, Heading]] = []
    for column, times in Counter(columns).items():
        if times > 1:
            raise Unreadable(f"column {column!r} is there {times} times")
        if column in RESULTS:
            raise Unreadable(f"column {column!r} would be there twice, as a result is named so; rename it")
        if column in labels:
            continue
        name, unit = divided(column)
        if taken := _taken(name):
            if name in [divided(other.column)[0] for _, other in headings]:
                raise Unreadable(f"two columns are both {name!r}; number what is repeated, as in 'time 1'")
            headings.append((taken, Heading(column, unit, unit_factor(taken, unit, column))))
            continue
        also = ALSO_CALLED.get("_".join(re.split("[^a-z0-9]+", name.lower())))
        if (other := also or meant(column)) in TAKEN:
            like = f"{other} ({parameter_of(other).unit})"
            raise refused(column, f"could be meant for {other}; name it so, with a unit like {like!r}")
        if other is not None:
            raise refused(column, f"holds for all runs, so it is an option: give --{other.replace('_', '-')}")
    return headings


def _kind(headings: Sequence[tuple[str, Heading]], columns: Sequence[str]) -> Kind:
    names = [name for name, _ in headings]
    for name in ("m1", "m2"):
        if name not in names:
            raise Unreadable(f"column {name} is missing; there are {listed(columns)}")
    if "a" in names and "time" in names:
        raise Unreadable(
            "columns a and time both tell the acceleration; keep one, or let one pass by --label"
        )
    if "a" not in names and "time" not in names:
        raise Unreadable(f"column a or time is missing; there are {listed(columns)}")
    return "a" if "a" in names else "time"


def _read(name: str, heading: Heading, cell: str, comma: bool) -> Input | None:
    """What a cell says in SI units, with its uncertainty; None if it is empty. Raises SceneError."""
    if not cell.strip():
        return None
    if comma and "." in cell:
        raise SceneError(name, cell, "has a point in a table of decimal commas; write all alike")
    try:
        one = read_input(name, cell.replace(",", ".") if comma else cell)
    except SceneError as error:
        raise SceneError(name, cell, error.rule) from None
    factor = Fraction(1) if OWN_UNIT.search(cell) else heading.factor
    if name == "time" and one.value == 0:
        raise SceneError(name, cell, parameter_of(name).domain)
    read = Input(one.value * factor, one.uncertainty * factor, cell)
    if not in_range(read):
        raise SceneError(name, cell, BEYOND)
    return read
