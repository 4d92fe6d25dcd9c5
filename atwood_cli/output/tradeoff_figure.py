"""What accuracy costs, as a picture: error against time, of the settings and of string elements."""

from collections.abc import Sequence
from itertools import groupby
from math import ceil
from operator import attrgetter
from typing import TYPE_CHECKING

from ..tradeoff.measure import MARGIN, March, Measured
from ..tradeoff.outcome import Tradeoff
from .figure import BLUE, FAINT, GREEN, GREY, RED, page, say_above
from .labels import Label, write_labels
from .text import describe

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLUMNS, TALL = 3, 7.5  # panels beside each other; inches, where there are two rows of them
OVER = 13  # pixels: points that are so close share one label
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
COUNTED = (10, 1000, 100_000)  # elements: numbers that are written beside their points
HOLLOW = "Hollow: another setting is both faster and more accurate."


def save(outcome: Tradeoff, path: str, force: bool, bare: bool = False) -> None:
    """Draw error against time to a file, whose suffix is its format, below sentences unless it is to be bare.

    Raises SceneError, OSError.
    """
    families = [list(group) for _, group in groupby(outcome.measured, attrgetter("family"))]
    # Of no error there is no logarithm.
    marches = [one for one in outcome.marches if one.relative_error]
    with page(path, force) as figure:
        if not bare:
            about = [] if outcome.seed is not None else [describe(outcome.scene)]
            say_above(figure, *about, f"{outcome.advice} {HOLLOW}")
        panels = _panels(figure, len(families) + any(one.elements for one in marches))
        labels = {}
        for number, (axes, settings) in enumerate(zip(panels, families, strict=False)):
            _set_times(axes, "time of one scene", [one.seconds for one in outcome.measured])
            axes.set_title(settings[0].family if outcome.seed is not None else "", fontsize=11)
            labels[axes] = _draw_settings(axes, settings, first=number % COLUMNS == 0)
        for axes in panels[len(families) :]:
            _set_times(axes, "time", [one.seconds for one in outcome.marches])
            labels[axes] = _draw_elements(axes, marches)
        write_labels(figure, labels)


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


def _set_times(axes: "Axes", words: str, times: Sequence[float]) -> None:
    """The axis of time, with room for words."""
    axes.set_xlim(min(times) / 3, max(times) * 30)
    axes.set_xlabel(f"{words} t (s)")


def _draw_settings(axes: "Axes", settings: Sequence[Measured], first: bool) -> list[Label]:
    """A point for each setting, hollow where another beats it; only the first of a row says its errors.

    Points that are close share one label.
    """
    axes.axhline(MARGIN, color=FAINT, lw=0.8, ls=":")
    end = axes.get_yaxis_transform()
    axes.text(1, MARGIN, f"{MARGIN} ulp", transform=end, ha="right", va="bottom", size=9, color=GREY)
    axes.set_ylim(LEAST / 1e5, GREATEST * 1e2)  # with room for words
    axes.set_yticks(list(TICKS), TICKS.values())
    axes.set_yticks([], minor=True)
    if first:
        axes.set_ylabel("worst error ε (ulp)")
    else:
        axes.tick_params(labelleft=False)
    groups: list[list[tuple[complex, Label]]] = []
    for one in settings:
        worst = GREATEST if one.worst_ulp is None else min(max(one.worst_ulp, LEAST), GREATEST)
        axes.plot(
            one.seconds, worst, "o", color=BLUE if one.best else GREY, mfc=None if one.best else "white"
        )
        dot = complex(*axes.transData.transform((one.seconds, worst)))
        near = [group for group in groups if any(abs(dot - other) < OVER for other, _ in group)]
        joined = [each for group in near for each in group]
        groups = [group for group in groups if group not in near]
        groups.append([*joined, (dot, Label(one.setting, one.seconds, worst))])
    return [group[0][1]._replace(words="\n".join(label.words for _, label in group)) for group in groups]


def _draw_elements(axes: "Axes", marches: Sequence[March]) -> list[Label]:
    """A line over the numbers of elements, plain and extrapolated, and the closed form as a point."""
    axes.set_title("e^(μφ) by string elements", fontsize=11)
    axes.set_ylabel("relative error δ")
    axes.margins(0.12)

    def label(one: March, words: str, colour: str) -> Label:
        return Label(words, one.seconds, one.relative_error, colour)

    labels = []
    for extrapolated, colour, shape in ((False, BLUE, "o"), (True, RED, "s")):
        ones = [one for one in marches if one.elements and one.extrapolated == extrapolated]
        times, errors = [one.seconds for one in ones], [one.relative_error for one in ones]
        axes.plot(times, errors, color=colour, marker=shape, ms=5, lw=1.2)
        if extrapolated:
            labels += [label(one, f"extrapolated, N = {one.elements:,}", RED) for one in ones if one.best]
        else:
            labels += [label(one, "plain", BLUE) for one in ones[len(ones) // 2 :][:1]]
            labels += [label(one, f"N = {one.elements:,}", BLUE) for one in ones if one.elements in COUNTED]
    for one in marches:
        if one.elements is None:
            axes.plot(one.seconds, one.relative_error, "D", color=GREEN, ms=6.5)
            labels.append(label(one, "closed form", GREEN))
    return labels
