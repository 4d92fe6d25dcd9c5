"""Times and errors as a table and for JSON."""

from collections.abc import Sequence
from decimal import Decimal
from itertools import chain, groupby
from math import isinf
from operator import attrgetter

from ..model.digits import text
from ..output.page import Page
from ..output.text import VERSION
from .measure import SETTINGS, Measured

LEGEND = (
    "Of each family: the time of a scene, the worst error in units in the last place of a double (ulp),"
    " 1e-16 of it, and the share of scenes of which it is mistaken whether the string slips.",
    "Settings: the paper's formulas in NumPy, accuracies of solve_arrays, and solve with so many digits.",
)
SECONDS = {"ns": 1e-9, "µs": 1e-6, "ms": 1e-3, "s": 1.0}


def record(measured: Sequence[Measured], scenes: int, seed: int) -> dict[str, object]:
    """The record for JSON: the seed, the number of scenes, and every setting on every family."""
    settings = [point._asdict() for point in measured]
    return {"version": VERSION, "seed": seed, "scenes": scenes, "settings": settings}


def print_table(measured: Sequence[Measured], scenes: int, seed: int) -> None:
    """Print a column for each setting, with its time, error and share of wrong regimes on each family."""
    groups = []
    for family, group in groupby(measured, attrgetter("family")):
        heads = [family, "  error (ulp)", "  wrong"]
        cells = (
            [in_seconds(point.seconds), short(point.worst_ulp), percent(point.share_wrong_regime)]
            for point in group
        )
        groups.append([list(row) for row in zip(heads, *cells, strict=True)])
    widths = [max(map(len, column)) for column in zip(*chain(*groups), strict=True)]
    for row in chain(*groups):
        row[1:] = map(str.rjust, row[1:], widths[1:])
    page = Page()
    page.say(f"{scenes} scenes of each family, seed {seed}")
    page.table(["Family", *(setting.name for setting in SETTINGS)], groups)
    page.say(*LEGEND)


def in_seconds(seconds: float) -> str:
    """A time to three digits, in the unit that fits."""
    shown = {unit: float(f"{seconds / factor:.3g}") for unit, factor in SECONDS.items()}
    unit = next((unit for unit, number in shown.items() if number < 1000), "s")
    return f"{short(shown[unit], 3)} {unit}"


def short(value: float | None, digits: int = 2) -> str:
    """A number to a few digits; a dash where there is none."""
    if value is None or isinf(value):
        return "-" if value is None else "inf"
    return text(Decimal(f"{value:.{digits}g}"))


def percent(share: float) -> str:
    """A share in percent, to three digits."""
    return f"{short(100 * share, 3)} %"
