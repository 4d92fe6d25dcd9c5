"""What accuracy costs, as a picture: error against time, of the settings and of string elements."""

from collections.abc import Callable, Sequence
from itertools import groupby
from math import ceil, hypot
from operator import attrgetter
from typing import TYPE_CHECKING, Any

from .figure import BLUE, FAINT, GREEN, GREY, RED, page
from .labels import Label, write_labels
from .text import describe, wrapped

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ..tradeoff.measure import March, Measured
    from ..tradeoff.outcome import Tradeoff

CAPTION_WIDTH = 130  # characters: more do not fit the page
COLUMNS, TALL = 3, 7.5  # panels beside each other; inches, where there are two rows of them
OVER = 17  # pixels: points that are so close share one label
MARGINS = (3, 30)  # times the least and the greatest time: with room for words
TICKS = {
    1e-3: "$\\leq 10^{-3}$",
    1.0: "1",
    1e4: "$10^4$",
    1e8: "$10^8$",
    1e12: "$10^{12}$",
    1e16: "no digit\nright",
}
WAYS = ((BLUE, "o"), (RED, "s"))  # plain, extrapolated
COUNTED = (10, 1000, 100_000)  # elements: numbers that are written beside their points
HOLLOW = "Hollow: another setting is both faster and more accurate."


def save(outcome: "Tradeoff", path: str, force: bool) -> None:
    """Draw error against time to a file, whose suffix is its format. Raises SceneError, OSError."""
    from ..tradeoff.outcome import drawable_marches

    families = [list(group) for _, group in groupby(outcome.measured, attrgetter("family"))]
    marches = drawable_marches(outcome.marches)
    with page(path, force) as figure:
        about = [] if outcome.seed is not None else [describe(outcome.scene)]
        caption = [
            part for line in (*about, f"{outcome.advice} {HOLLOW}") for part in wrapped(line, CAPTION_WIDTH)
        ]
        figure.suptitle("\n".join(caption), fontsize=10)
        panels = _panels(figure, len(families) + any(marches))
        times = [one.seconds for one in outcome.measured]
        for number, (axes, settings) in enumerate(zip(panels, families, strict=False)):
            axes.set_xlim(min(times) / MARGINS[0], max(times) * MARGINS[1])
            axes.set_title(settings[0].family if outcome.seed is not None else "", fontsize=11)
            _draw_settings(axes, settings, first=number % COLUMNS == 0)
        for axes in panels[len(families) :]:
            _draw_elements(axes, outcome.marches, marches)
        figure.draw_without_rendering()  # which decides what lies close together
        for axes, settings in zip(panels, families, strict=False):
            write_labels(axes, _names(axes, settings))
        for axes in panels[len(families) :]:
            write_labels(axes, _numbers(outcome.marches, marches))


def _panels(figure: "Figure", count: int) -> "list[Axes]":
    """So many axes, both logarithmic, in rows of COLUMNS."""
    if count > COLUMNS:
        figure.set_figheight(TALL)
    grid = figure.subplots(ceil(count / COLUMNS), min(count, COLUMNS), squeeze=False).flatten()
    for axes in grid[count:]:
        axes.remove()
    for axes in grid[:count]:
        axes.loglog()
        axes.spines[["top", "right"]].set_visible(False)
        axes.tick_params(axis="x", pad=7)  # else labels may touch in the corner
    return list(grid[:count])


def _draw_settings(axes: "Axes", settings: "Sequence[Measured]", first: bool) -> None:
    """A point for each setting, hollow where another beats it; only the first of a row says its errors."""
    from ..tradeoff.measure import MARGIN
    from ..tradeoff.outcome import GREATEST_DRAWN, LEAST_DRAWN

    axes.axhline(MARGIN, color=FAINT, lw=0.8, ls=":")
    end = axes.get_yaxis_transform()
    axes.text(1, MARGIN, f"{MARGIN} ulp", transform=end, ha="right", va="bottom", size=9, color=GREY)
    for one in settings:
        axes.plot(
            *_place(one), "o", color=BLUE if one.best else GREY, mfc=None if one.best else "white", ms=6
        )
    axes.set_ylim(LEAST_DRAWN / 1e5, GREATEST_DRAWN * 1e2)  # with room for words
    axes.set_yticks(list(TICKS), TICKS.values())
    axes.set_yticks([], minor=True)
    axes.set_xlabel("time of one scene $t$ (s)")
    if first:
        axes.set_ylabel("worst error $\\varepsilon$ (ulp)")
    else:
        axes.tick_params(labelleft=False)


def _place(one: "Measured") -> tuple[float, float]:
    from ..tradeoff.outcome import drawable

    return one.seconds, drawable(one.worst_ulp)


def _names(axes: "Axes", settings: "Sequence[Measured]") -> list[Label]:
    """The name of each setting; points over each other have one label."""
    places = [_place(one) for one in settings]
    dots: Any = axes.transData.transform(places)
    return [
        Label("\n".join(settings[i].setting for i in group), *places[group[0]])
        for group in _joined(len(settings), lambda i, j: hypot(*(dots[i] - dots[j])) < OVER)
    ]


def _joined(count: int, close: Callable[[int, int], bool]) -> list[list[int]]:
    """Numbers in groups: each is close to another of its group, and to none of the others."""
    groups: list[list[int]] = []
    for i in range(count):
        near = [group for group in groups if any(close(i, j) for j in group)]
        groups = [
            *(group for group in groups if group not in near),
            [*(j for group in near for j in group), i],
        ]
    return groups


def _draw_elements(axes: "Axes", run: "Sequence[March]", marches: "Sequence[Sequence[March]]") -> None:
    """A line over the numbers of elements, plain and extrapolated, and the closed form as a point."""
    for ones, (colour, shape) in zip(marches, WAYS, strict=True):
        places = [(one.seconds, one.relative_error) for one in ones]
        axes.plot(
            *zip(*places, strict=True) if places else ([], []), color=colour, marker=shape, ms=5, lw=1.2
        )
    for one in _closed(run):
        axes.plot(one.seconds, one.relative_error, "D", color=GREEN, ms=6.5)
    axes.set_title("$e^{\\mu\\varphi}$ by string elements", fontsize=11)
    axes.margins(0.12)
    times = [one.seconds for one in run]
    axes.set_xlim(min(times) / MARGINS[0], max(times) * MARGINS[1])
    axes.set_xlabel("time $t$ (s)")
    axes.set_ylabel("relative error $\\delta$")


def _closed(run: "Sequence[March]") -> "list[March]":
    """The closed form, where it has an error: of none, there is no logarithm."""
    return [one for one in run if one.elements is None and one.relative_error]


def _numbers(run: "Sequence[March]", marches: "Sequence[Sequence[March]]") -> list[Label]:
    """What the point and the lines are, and how many elements make some points of the lines."""
    plain, extrapolated = marches

    def beside(one: "March", words: str, colour: str) -> Label:
        return Label(words, one.seconds, one.relative_error, colour)

    return [
        *(beside(one, "closed form", GREEN) for one in _closed(run)),
        *(beside(one, f"extrapolated, {_number(one)}", RED) for one in extrapolated if one.best),
        *(beside(one, "plain", BLUE) for one in plain[len(plain) // 2 :][:1]),
        *(beside(one, _number(one), BLUE) for one in plain if one.elements in COUNTED),
    ]


def _number(one: "March") -> str:
    return f"$N$ = {one.elements:,}"
