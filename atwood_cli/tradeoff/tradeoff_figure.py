"""Error against time of every setting, as a picture: a pane a family."""

from collections.abc import Sequence
from itertools import groupby
from operator import attrgetter

from ..output.figure import BLUE, GREEN, PURPLE, RED, page, say_above
from .measure import SETTINGS, Measured

LEAST, GREATEST = 1e-3, 1e16
"""The least and the greatest error that is drawn, in ulp; others are drawn as these."""
TICKS = {
    LEAST: "$\\leq 10^{-3}$",
    1.0: "1",
    1e4: "$10^4$",
    1e8: "$10^8$",
    1e12: "$10^{12}$",
    GREATEST: "no digit\nright",
}
LOOKS = zip("oD^v", (RED, BLUE, GREEN, PURPLE), strict=True)
MARKS = {setting.name: look for setting, look in zip(SETTINGS, LOOKS, strict=True)}


def save(measured: Sequence[Measured], path: str, force: bool, bare: bool = False) -> None:
    """Draw errors against times to a file, whose suffix is its format. Raises OSError.

    ``bare`` leaves the sentence out.
    """
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
            for point in settings:
                worst = GREATEST if point.worst_ulp is None else min(max(point.worst_ulp, LEAST), GREATEST)
                mark, colour = MARKS[point.setting]
                pane.plot(point.seconds, worst, mark, color=colour, label=point.setting)
        panes[0].set_ylabel("worst error ε (ulp)")
        figure.legend(*panes[0].get_legend_handles_labels(), loc="outside lower center", ncols=len(SETTINGS))
