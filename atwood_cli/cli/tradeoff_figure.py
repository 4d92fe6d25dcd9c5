"""What accuracy costs, as a picture: error against time."""

from typing import TYPE_CHECKING

from .figure import BLUE, GREEN, INK, PURPLE, RED, page

if TYPE_CHECKING:
    from ..tradeoff.measure import Tradeoff

FAMILY_COLOURS = (BLUE, RED, GREEN, PURPLE, INK)
MARKERS = "xPs^Do*v"


def save(outcome: "Tradeoff", path: str, force: bool) -> None:
    """Draw error against time to a file, whose suffix is its format. Raises SceneError, OSError."""
    from ..tradeoff.measure import EDGES, MARGIN, drawable, drawable_marches

    marches = drawable_marches(outcome.marches)
    with page(path, force) as figure:
        arithmetic, *rest = figure.subplots(1, 1 + any(marches), squeeze=False)[0]
        families = list(dict.fromkeys(one.family for one in outcome.measured))
        settings = list(dict.fromkeys(one.setting for one in outcome.measured))
        for family, colour in zip(families, FAMILY_COLOURS, strict=False):
            points = [one for one in outcome.measured if one.family == family]
            xs, ys = [one.seconds for one in points], [drawable(one.worst_ulp) for one in points]
            arithmetic.plot(xs, ys, color=colour, lw=0.6, alpha=0.5, label=family)
            for x, y, one in zip(xs, ys, points, strict=True):
                arithmetic.plot([x], [y], MARKERS[settings.index(one.setting)], color=colour)
        for setting, marker in zip(settings, MARKERS, strict=False):
            arithmetic.plot([], [], marker, color="#444444", label=setting)
        arithmetic.axhline(MARGIN, color="#999999", lw=0.8, ls=":", label=f"{MARGIN} ulp")
        arithmetic.set_ylabel("worst error (ulp)")
        for elements in rest:
            kinds = (("elements", BLUE), ("extrapolated", RED))
            for way, (label, colour) in zip(marches, kinds, strict=True):
                if way:
                    elements.plot(*zip(*way, strict=True), color=colour, marker=".", label=label)
            elements.set_ylabel("relative error of $e^{\\mu\\varphi}$")
        for axes in (arithmetic, *rest):
            axes.loglog()
            axes.set_xlabel("time (s)")
            axes.spines[["top", "right"]].set_visible(False)
            axes.legend(frameon=False, fontsize=8)
        figure.suptitle(EDGES, fontsize=10)
