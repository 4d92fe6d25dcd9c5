"""Times and errors as a table, for JSON, and as a picture."""

from collections.abc import Sequence
from decimal import Decimal
from itertools import chain, groupby
from math import isinf
from operator import attrgetter

from ..explain.given import VERSION
from ..numbers.digits import format_number
from ..output.figure import BLUE, GREEN, PURPLE, RED, saved
from ..output.forms import Picture
from ..output.page import Page
from .measure import EXACT_DIGITS, MOST_ROWS, SEED, SETTINGS, Measured

LEGEND = (
    f"Each family has the time per scene in µs, in a table of up to {MOST_ROWS} rows; the median and the"
    f" worst error, against {EXACT_DIGITS} digits, in units in the last place of a double (ulp, about 1e-16"
    " of it); and the share of scenes with a wrong regime.",
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
    """Print a column for each setting, with its time, error and share of wrong regimes on each family."""
    groups = []
    for family, group in groupby(measured, attrgetter("family")):
        heads = [family, "  median (ulp)", "  worst (ulp)", "  wrong"]
        cells = (
            [
                short(1e6 * setting.seconds, 3),
                short(setting.median_ulp),
                short(setting.worst_ulp),
                f"{short(100 * setting.share_wrong_regime, 3)} %",
            ]
            for setting in group
        )
        groups.append([list(row) for row in zip(heads, *cells, strict=True)])
    widths = [max(map(len, column)) for column in zip(*chain(*groups), strict=True)]
    for row in chain(*groups):
        row[1:] = map(str.rjust, row[1:], widths[1:])
    page.say(f"{scenes} scenes of each family, seed {SEED}")
    page.table(["Family", *SETTINGS], groups)
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
