"""Error against time of every setting, as a picture: a pane a family."""

from collections.abc import Sequence
from itertools import groupby
from operator import attrgetter

from ..output.figure import BLUE, GREEN, PURPLE, RED, page, say_above
from .measure import SETTINGS, Measured

LEAST, GREATEST = 1e-3, 1e16
"""Errors (ulp) beyond these are drawn as these."""
TICKS = {
    LEAST: "$\\leq 10^{-3}$",
    1.0: "1",
    1e4: "$10^4$",
    1e8: "$10^8$",
    1e12: "$10^{12}$",
    GREATEST: "no digit\nright",
}
NAMES = (setting.name for setting in SETTINGS)
MARKS = dict(zip(NAMES, zip("oD^v", (RED, BLUE, GREEN, PURPLE), strict=True), strict=True))


def save(measured: Sequence[Measured], path: str, force: bool, bare: bool = False) -> None:
    """Draw it to a file, whose suffix is its format; ``bare`` leaves the sentence out. Raises OSError."""
    families = {family: [*group] for family, group in groupby(measured, attrgetter("family"))}
    with page(path, force) as figure:
        if not bare:
            say_above(
                figure,
                "Worst error of a scene, in units in the last place of a double (ulp), against its time",
            )
        panes = figure.subplots(1, len(families), sharex=True, sharey=True, squeeze=False)[0]
        for pane, (family, settings) in zip(panes, families.items(), strict=True):
            pane.set(title=family, xscale="log", yscale="log", xlabel="time of a scene t (s)")
            pane.set_yticks(list(TICKS), TICKS.values())
            pane.set_yticks([], minor=True)
            pane.grid(alpha=0.3)
            for one in settings:
                worst = GREATEST if one.worst_ulp is None else min(max(one.worst_ulp, LEAST), GREATEST)
                mark, colour = MARKS[one.setting]
                pane.plot(one.seconds, worst, mark, color=colour, label=one.setting)
        panes[0].set_ylabel("worst error ε (ulp)")
        figure.legend(*panes[0].get_legend_handles_labels(), loc="outside lower center", ncols=len(SETTINGS))
