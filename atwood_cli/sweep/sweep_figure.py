"""The curves of a sweep, and their picture."""

from collections.abc import Iterable, Sequence
from itertools import chain
from math import inf, isnan, log, nan
from operator import attrgetter
from typing import TYPE_CHECKING, Any, NamedTuple

from ..model.digits import is_infinite
from ..model.quantities import QUANTITIES
from ..model.scene import Scene, SceneError
from ..output.figure import COLOURS, FAINT, INK, axis_words, check_file, page, typeset, write_beside
from ..output.text import wrapped
from ..solver.answers import Answers
from ..solver.messages import unmarked
from .changes import Change, changes
from .ranges import Range, Sweep, steps, with_value

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MAX_CURVES = len(COLOURS)
"""The most curves on one pair of axes: everybody can distinguish six colours."""
LARGEST_DRAWN = 1e100
"""The largest number that is drawn, in any unit."""
UNDRAWABLE = f"draws numbers between {1 / LARGEST_DRAWN} and {LARGEST_DRAWN} in magnitude only, not such {{}}"
CURVE_STEPS = 200
BEGINS = {"slip": "slips", "no-slip": "holds", "verge": "on the verge"}
LINE_STYLES = ("-", "--", "-.", (0, (5, 1, 1, 1, 1, 1)), (0, (1, 1)), (0, (8, 2)))
MARKERS = "osD^vP"
TITLE_CHARACTERS, TICK_CHARACTERS, TICK_POINTS, WIDE = 24, 70, 12, 30
"""The room beside and below an axis, the height of a line, and from which ratio a list is logarithmic."""


class Curve(NamedTuple):
    """A quantity along a range, while all other inputs stay the same.

    ``point`` is that of the other range, in words. ``least`` and ``most`` belong to the values ``xs``: equal
    unless the quantity is not one number, NaN if there is none. ``marks`` are where the regime changes, with
    words. ``locked`` are the least and the most on a locked pulley.
    """

    quantity: str
    point: str
    xs: list[float]
    least: list[float]
    most: list[float]
    marks: list[tuple[float, float, str]]
    locked: list[float]

    @property
    def numbers(self) -> list[float]:
        """Return all numbers that are drawn, the one at the right end last."""
        return [y for y in (*self.locked, *self.least, *self.most) if not isnan(y)]


def _drawable(sweep: Sweep, names: Sequence[str]) -> list[str]:
    """Return the quantities to draw, which are numbers. Raises SceneError if they make no picture."""
    drawn = [name for name in names or ["acceleration"] if name in QUANTITIES]
    if not drawn:
        raise SceneError("only", names[0], "is not a number to draw; name a quantity")
    along = sweep.along
    if along.ends[1] > LARGEST_DRAWN or (along.log and along.ends[0] < 1 / LARGEST_DRAWN):
        raise SceneError("figure", None, UNDRAWABLE.format(along.name))
    if len({*map(float, along.ends)}) < 2:
        raise SceneError(along.name, along.typed, "has no two values that differ in a picture; give others")
    units = [QUANTITIES[name].unit for name in drawn]
    if (count := sweep.total // len(along.points) * max(map(units.count, units))) > MAX_CURVES:
        rule = f"would draw {count} curves on one pair of axes; at most {MAX_CURVES} can be distinguished"
        raise SceneError("figure", None, f"{rule}; name fewer quantities, or give one range fewer points")
    return drawn


def _solve(along: Range, scene: Scene) -> tuple[list[Change], dict[float, Answers]]:
    """Return the changes along a range and the answers at its values: of a list, at its points alone."""
    found, values = list[Change](), [point.exact for point in along.points]
    if not along.is_list:
        corners = attrgetter("regime", "sign", "axle_holds")  # where one of these changes
        found = list(changes(scene, along, what=corners))
        values = [*steps(*along.ends, CURVE_STEPS, along.log)]
        values += [x for change in found for x in (change.last, change.first)]
    return found, {float(x): Answers(with_value(scene, along.name, x)) for x in sorted(values)}


def panels_of(sweep: Sweep, names: Sequence[str]) -> list[list[Curve]]:
    """Return curves, those of one unit together: each along one range, for a point of the other range.

    Raises SceneError if numbers are too large to draw, ArithmeticError if there are none.
    """
    along = sweep.along
    scenes = [
        (typeset(sweep.in_words(place)), *_solve(along, scene)) for scene, place in sweep.scenes(sweep.others)
    ]
    answers = [one for _, _, solved in scenes for one in solved.values()]
    drawn = [name for name in names if not all(isnan(_height(one, name, "max")) for one in answers)]
    if not drawn:
        why = unmarked("; ".join(dict.fromkeys(one.answer(name).reason for name in names for one in answers)))
        raise ArithmeticError(f"{', '.join(names)} exists at no point, so there is nothing to draw: {why}")
    panels: dict[str, list[Curve]] = {}
    for name in drawn:
        curves = [_curve(along, name, *scene) for scene in scenes]
        if max(abs(y) for curve in curves for y in curve.numbers) > LARGEST_DRAWN:
            raise SceneError("figure", None, UNDRAWABLE.format(name))
        panels.setdefault(QUANTITIES[name].unit, []).extend(curves)
    return [*panels.values()]


def _curve(along: Range, name: str, point: str, found: list[Change], solved: dict[float, Answers]) -> Curve:
    """Return the curve of a quantity."""
    locked = {_height(solved[inf], name, edge) for edge in ("min", "max")} if inf in solved else set()
    xs = [x for x in solved if x < inf]
    least, most = ([_height(solved[x], name, edge) for x in xs] for edge in ("min", "max"))
    marks = []
    for change in found:
        if change.before[0] != change.after[0]:
            beside = (_height(solved[float(x)], name, "max") for x in (change.first, change.last))
            height = next((y for y in beside if not isnan(y)), nan)
            words = f"{BEGINS[change.after[0]]} from {along.in_units(change.at)}"
            marks.append((float(change.at.exact), height, words))
    return Curve(name, point, xs, least, most, marks, sorted(y for y in locked if not isnan(y)))


def _height(answers: Answers, name: str, edge: str) -> float:
    """Return a quantity, or an edge of its band; NaN if it does not exist or no double holds it."""
    if name == "friction_force" and answers[name] is None:
        name = f"{name}_{edge}"
    value: Any = answers[name]
    return nan if value is None or is_infinite(value) else float(value)


def axis_title(names: Iterable[str], unit: str = "") -> str:
    """Return the title of an axis: names, symbols and unit, as tension T₁, T₂ (N)."""
    symbols: dict[str, list[str]] = {}
    for words, symbol in map(axis_words, names):
        symbols.setdefault(words, []).append(symbol)
    title = ", ".join(f"{words} {', '.join(of_words)}" for words, of_words in symbols.items())
    return f"{title} ({unit})" if unit else title


def save(sweep: Sweep, names: Sequence[str], path: str, force: bool, bare: bool) -> None:
    """Draw the curves of quantities, or of the acceleration, to a file; if bare, without a caption.

    Raises SceneError, OSError, and ArithmeticError if there is nothing to draw.
    """
    names = _drawable(sweep, names)
    check_file(path, force)
    along, panels = sweep.along, panels_of(sweep, names)
    inputs = [words for name, words in sweep.inputs.items() if name != along.name]
    quantities = [dict.fromkeys(curve.quantity for curve in curves) for curves in panels]
    title = f"{axis_title(chain(*quantities))} against {axis_title([along.name])}"
    above = [title[0].upper() + title[1:], ", ".join(inputs)]
    with page(path, force, above, bare=bare, panels=len(panels)) as figure:
        all_axes = figure.subplots(len(panels), sharex=True, squeeze=False)[:, 0]
        _set_places(all_axes[-1], along)
        for axes, curves, drawn in zip(all_axes, panels, quantities, strict=True):
            words = axis_title(drawn, QUANTITIES[curves[0].quantity].unit)
            axes.set_ylabel("\n".join(wrapped(words, TITLE_CHARACTERS)))
            for place, curve in enumerate(curves):
                _draw(axes, curve, place, along.is_list)
            _set_heights(axes, [y for curve in curves for y in curve.numbers])
        _draw_legend(figure, panels)
        first = panels[0][: len(panels[0]) // len(quantities[0])]
        labels = [(*mark, COLOURS[place]) for place, curve in enumerate(first) for mark in curve.marks]
        for axes, curves in zip(all_axes, panels, strict=True):
            end = axes.get_xlim()[1]
            for place, curve in enumerate(curves):
                labels += [(end, y, "locked", COLOURS[place]) for y in curve.locked]
            write_beside(axes, labels)
            labels = []


def _draw_legend(figure: "Figure", panels: Sequence[Sequence[Curve]]) -> None:
    """Write what curves are, in the order of their right ends, if there is anything to say."""
    most = max(panels, key=lambda curves: len(curves))
    several = any(curves[0].quantity != curves[-1].quantity for curves in panels)
    entries = {}
    for place in sorted(range(len(most)), key=lambda place: -most[place].numbers[-1]):
        alike = [curves[place] for curves in panels if place < len(curves)]
        symbols = [axis_words(curve.quantity)[1] for curve in alike] if several else []
        entries[place] = ", ".join(words for words in (*symbols, alike[0].point) if words)
    lines = {line.get_label(): line for line in figure.axes[panels.index(most)].get_lines()}
    if any(entries.values()):
        handles = [lines[f"{place}"] for place in entries]
        figure.legend(handles, entries.values(), loc="outside right center", handlelength=3, labelspacing=0.3)


def _set_places(axes: "Axes", along: Range) -> None:
    """Set the x axis; that of a list has ticks at the values, with names below each other if close."""
    low, high = map(float, along.ends)
    axes.set_xlabel(axis_title([along.name], along.unit))
    is_wide = along.is_list and 0 < WIDE * low < high
    if along.log or is_wide:
        axes.set_xscale("log")
    if not along.is_list:
        axes.set_xlim(low, high)
        return
    axes.margins(x=0.05)
    names = {float(point.exact): typeset(along.cell(point)) for point in along.finite}
    axes.set_xticks([*names], names.values())
    axes.minorticks_off()
    ends = [-inf]
    for tick in axes.xaxis.get_major_ticks():
        x, width = tick.get_loc(), len(tick.label1.get_text()) + 2
        share = log(x / low) / log(high / low) if is_wide else (x - low) / (high - low)
        start = TICK_CHARACTERS * share - width / 2
        row = next((row for row, end in enumerate(ends) if end < start), len(ends))
        ends[row : row + 1] = [start + width]
        tick.set_pad(3 + TICK_POINTS * row)


def _set_heights(axes: "Axes", numbers: Sequence[float]) -> None:
    """Begin an axis at 0 if that leaves at most half of it empty; draw a line at 0 if it is between."""
    low, high = min(numbers), max(numbers)
    if low < 0 < high:
        axes.axhline(0, color=FAINT, lw=0.8, zorder=0)
    elif 0 <= 2 * low <= high:
        axes.set_ylim(bottom=0)
    elif low <= 2 * high <= 0:
        axes.set_ylim(top=0)


def _draw(axes: "Axes", curve: Curve, place: int, is_list: bool) -> None:
    """Draw a curve, the band where it is not one number, and the changes; or the points of a list."""
    xs, colour, label = curve.xs, COLOURS[place], f"{place}"
    heights = [low if low == high else nan for low, high in zip(curve.least, curve.most, strict=True)]
    if is_list:
        axes.plot(xs, heights, MARKERS[place], color=colour, ms=5, label=label)
        axes.vlines(xs, curve.least, curve.most, color=colour, lw=3, alpha=0.5)
    else:
        axes.plot(xs, heights, color=colour, ls=LINE_STYLES[place], label=label)
        band = [any(map(isnan, heights[max(i - 1, 0) : i + 2])) for i in range(len(xs))]
        look: Any = {"facecolor": (colour, 0.18), "edgecolor": colour, "lw": 0.8}
        axes.fill_between(xs, curve.least, curve.most, band, **look)
    for x, y, _ in curve.marks:
        axes.plot([x], [y], "o", color=INK, ms=4, zorder=3, clip_on=False)
    for y in curve.locked:
        axes.axhline(y, color=colour, ls=(0, (4, 3)), lw=1)
