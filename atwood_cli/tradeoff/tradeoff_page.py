"""Times and errors as a table, for JSON, and as a picture."""

from collections.abc import Sequence
from decimal import Decimal
from itertools import groupby
from math import isinf
from operator import attrgetter, itemgetter

from ..explain.given import VERSION
from ..numbers.digits import format_number
from ..output.figure import BLUE, GREEN, PURPLE, RED, saved
from ..output.forms import Picture
from ..output.page import Page
from ..output.text import aligned
from .measure import EXACT_DIGITS, MOST_ROWS, SEED, Measured

COLUMNS = ("Family", "Setting", "Time (µs)", "Median", "Worst", "Wrong")
LEGEND = (
    f"The time of a scene, in a table of up to {MOST_ROWS} rows; the median and the worst error, against"
    f" {EXACT_DIGITS} digits, in units in the last place of a double (ulp, about 1e-16 of it); and the share"
    " of scenes with a wrong regime.",
    "Settings: the same model in plain NumPy, accuracies of solve_arrays, and solve to 50 digits.",
)
LEAST, GREATEST = 1e-3, 1e16
"""The least and the greatest error that is drawn, in ulp; others are drawn as these."""
TICKS = {LEAST: "≤ 0.001", 1.0: "1", 1e4: "10⁴", 1e8: "10⁸", 1e12: "10¹²", GREATEST: "no digit\nright"}


def record(measured: Sequence[Measured], scenes: int) -> dict[str, object]:
    """Return the record for JSON: the seed, the number of scenes, and every setting on every family."""
    settings = [point._asdict() for point in measured]
    return {"version": VERSION, "seed": SEED, "scenes": scenes, "settings": settings}


def print_table(page: Page, measured: Sequence[Measured], scenes: int) -> None:
    """Print a row for each setting on each family."""
    numbers = (
        (short(1e6 * x.seconds, 3) for x in measured),
        (short(x.median_ulp) for x in measured),
        (short(x.worst_ulp) for x in measured),
        (f"{short(100 * x.share_wrong_regime, 3)} %" for x in measured),
    )
    rows = zip(*zip(*(x[:2] for x in measured), strict=True), *map(aligned, numbers), strict=True)
    page.say(f"{scenes} scenes of each family, seed {SEED}")
    page.table(COLUMNS, [[*group] for _, group in groupby(rows, itemgetter(0))])
    page.say(*LEGEND)


def save(measured: Sequence[Measured], picture: Picture) -> None:
    """Draw errors against times to a file, for each family. Raises OSError."""
    families = {family: [*group] for family, group in groupby(measured, attrgetter("family"))}
    title = "Worst error of a scene, in units in the last place of a double (ulp), against its time"
    with saved(picture, [title]) as figure:
        panels = figure.subplots(1, len(families), sharex=True, sharey=True, squeeze=False)[0]
        for axes, (family, settings) in zip(panels, families.items(), strict=True):
            axes.set(title=family, xscale="log", yscale="log", xmargin=0.2)
            axes.set_yticks(list(TICKS), TICKS.values())
            axes.minorticks_off()
            axes.grid(alpha=0.3)
            for point, marker, colour in zip(settings, "oD^v", (RED, BLUE, GREEN, PURPLE), strict=True):
                worst = GREATEST if point.worst_ulp is None else min(max(point.worst_ulp, LEAST), GREATEST)
                axes.plot(point.seconds, worst, marker, color=colour, label=point.setting)
        panels[0].set_ylabel("worst error ε (ulp)")
        panels[len(panels) // 2].set_xlabel("time per scene t (s)")
        figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=4)


def short(value: float | None, digits: int = 2) -> str:
    """Return a number to a few digits; a dash if there is none."""
    if value is None:
        return "-"
    return "inf" if isinf(value) else format_number(Decimal(f"{value:.{digits}g}"))
