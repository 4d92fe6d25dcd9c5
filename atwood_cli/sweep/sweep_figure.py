"""The curves of a sweep, and their picture."""

from collections.abc import Iterable, Sequence
from functools import partial
from itertools import chain
from math import isnan, nan
from operator import attrgetter
from typing import TYPE_CHECKING, Any, NamedTuple

from ..explain.messages import unmarked
from ..numbers.digits import is_infinite
from ..output.figure import COLOURS, FAINT, INK, axis_words, saved, typeset
from ..output.forms import Picture
from ..output.text import wrapped
from ..solver.answers import Answers
from ..solver.quantities import QUANTITIES
from ..solver.scene import Scene, SceneError
from .changes import Change, changes
from .ranges import LOCKED, Range, Sweep, steps

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MAX_CURVES = len(COLOURS)
"""The most curves on one pair of axes: everybody can distinguish six colours."""
LARGEST_DRAWN = 1e100
"""The largest number that is drawn, in any unit."""
UNDRAWABLE = f"draws numbers between {1 / LARGEST_DRAWN} and {LARGEST_DRAWN} in magnitude only, not such {{}}"
CURVE_STEPS = 200
BEGINS = {"slip": "slips beyond", "no-slip": "holds from", "verge": "on the verge from"}
LINE_STYLES = ("-", "--", "-.", (0, (5, 1, 1, 1, 1, 1)), (0, (1, 1)), (0, (8, 2)))
MARKERS = "osD^vP"
TITLE_CHARACTERS, TICK_CHARACTERS = 24, 60
"""The room beside and below an axis."""


class Curve(NamedTuple):
    """A quantity along a range or a list, while all other inputs stay the same.

    ``point`` is that of the other range, in words. ``ys`` belong to the values ``xs`` of a range, or to the
    numbers of a list's places; NaN if there is none. ``marks`` are where the regime changes, with words.
    """

    quantity: str
    point: str
    xs: list[float]
    ys: list[float]
    marks: list[tuple[float, float, str]]


def _drawable(sweep: Sweep, names: Sequence[str]) -> list[str]:
    """Return the quantities to draw, which are numbers. Raises SceneError if they make no picture."""
    drawn = [name for name in names or ["acceleration"] if name in QUANTITIES]
    if not drawn:
        raise SceneError("only", names[0], "is not a number to draw; name a quantity")
    along, (low, high) = sweep.along, sweep.along.ends
    if not along.is_list and (high > LARGEST_DRAWN or (along.log and low < 1 / LARGEST_DRAWN)):
        raise SceneError("figure", None, UNDRAWABLE.format(along.name))
    units = [*map(Answers(sweep.scene, units=sweep.units).unit_of, drawn)]
    if (count := sweep.total // len(along.points) * max(map(units.count, units))) > MAX_CURVES:
        rule = f"would draw {count} curves on one pair of axes; at most {MAX_CURVES} can be distinguished"
        raise SceneError("figure", None, f"{rule}; name fewer quantities, or give one range fewer points")
    return drawn


def _solve(sweep: Sweep, scene: Scene, digits: int | None) -> tuple[list[Change], dict[float, Answers]]:
    """Return the changes along a range, and the answers at its values; those of a list are by place."""
    along, answers = sweep.along, partial(Answers, units=sweep.units)
    if along.is_list:
        scenes = (along.at(point.value, scene) for point in along.points)
        return [], {float(place): answers(at_value) for place, at_value in enumerate(scenes)}
    corners = attrgetter("regime", "heavier_side", "axle_holds")  # where one of these changes
    in_order = [] if scene.lacking else list(changes(scene, along, digits, what=corners))
    values = [*steps(*along.ends, CURVE_STEPS, along.log)]
    values += [x for change in in_order for x in (change.holds_at, change.differs_at)]
    return in_order, {float(x): answers(along.at(x, scene)) for x in sorted(values)}


def panels_of(sweep: Sweep, names: Sequence[str], digits: int | None = None) -> dict[str, list[Curve]]:
    """Return curves by their unit: each along one range, for a point of the other range.

    Raises SceneError if numbers are too large to draw, ArithmeticError if there are none.
    """
    along, others = sweep.along, sweep.scenes(sweep.others)
    scenes = [(typeset(sweep.in_words(place)), *_solve(sweep, scene, digits)) for scene, place in others]
    panels, unit_of = dict[str, list[Curve]](), Answers(sweep.scene, units=sweep.units).unit_of
    for name in names:
        curves = [_curve(along, name, *scene) for scene in scenes]
        numbers = [abs(y) for y in _numbers(curves)]
        if max(numbers, default=0) > LARGEST_DRAWN:
            raise SceneError("figure", None, UNDRAWABLE.format(name))
        if numbers:
            panels.setdefault(unit_of(name), []).extend(curves)
    if not panels:
        answers = [answer for _, _, solved in scenes for answer in solved.values()]
        reasons = dict.fromkeys(answer.answer(name).reason for name in names for answer in answers)
        why = unmarked("; ".join(reasons))
        raise ArithmeticError(f"{', '.join(names)} exists at no point, so there is nothing to draw: {why}")
    return panels


def _numbers(curves: Sequence[Curve]) -> list[float]:
    return [y for curve in curves for y in curve.ys if not isnan(y)]


def _curve(
    along: Range, name: str, point: str, in_order: list[Change], solved: dict[float, Answers]
) -> Curve:
    heights = {x: _height(answers[name]) for x, answers in solved.items()}
    marks = []
    for change in in_order:
        if change.before[0] != change.after[0]:
            places = [change.holds_at, change.differs_at]
            if change.after[0] != "slip":
                places.reverse()  # the string holds there
            if there := [y for x in places if not isnan(y := heights[float(x)])]:
                words = f"{BEGINS[change.after[0]]} {along.in_units(change.at)}"
                marks.append((float(change.at), there[0], words))
    return Curve(name, point, [*heights], [*heights.values()], marks)


def _height(value: Any) -> float:
    """Return a value as a double; NaN if there is none or no double holds it."""
    return nan if value is None or is_infinite(value) else float(value)


def axis_title(names: Iterable[str], unit: str = "") -> str:
    """Return the title of an axis: names, symbols and unit, as tension T₁, T₂ (N)."""
    symbols: dict[str, list[str]] = {}
    for words, symbol in map(axis_words, names):
        symbols.setdefault(words, []).append(symbol)
    title = ", ".join(f"{words} {', '.join(of_words)}".rstrip() for words, of_words in symbols.items())
    return f"{title} ({unit})" if unit else title


def save_sweep(sweep: Sweep, names: Sequence[str], digits: int | None, picture: Picture) -> None:
    """Draw the curves of quantities, or of the acceleration, to a file.

    Raises SceneError, OSError, and ArithmeticError if there is nothing to draw.
    """
    names = _drawable(sweep, names)
    along, by_unit = sweep.along, panels_of(sweep, names, digits)
    panels = [*by_unit.values()]
    inputs = [words for name, words in sweep.inputs.items() if name != along.name]
    quantities = [dict.fromkeys(curve.quantity for curve in curves) for curves in panels]
    title = f"{axis_title(chain(*quantities))} against {axis_title([along.label])}"
    above = [title[0].upper() + title[1:], ", ".join(inputs)]
    with saved(picture, above, panels=len(panels)) as figure:
        all_axes = figure.subplots(len(panels), sharex=True, squeeze=False)[:, 0]
        _set_places(all_axes[-1], along)
        for axes, (unit, curves), drawn in zip(all_axes, by_unit.items(), quantities, strict=True):
            words = axis_title(drawn, unit)
            axes.set_ylabel("\n".join(wrapped(words, TITLE_CHARACTERS)))
            # Curves are drawn, and stand in the legend, in the order of their right ends.
            for place, curve in sorted(
                enumerate(curves), key=lambda numbered: numbered[1].ys[-1], reverse=True
            ):
                symbols = [axis_words(curve.quantity)[1]] if drawn.keys() - {curve.quantity} else []
                _draw(axes, curve, place, ", ".join(filter(None, [*symbols, curve.point])), along.is_list)
            _set_heights(axes, _numbers(curves))
            _add_legend(axes)


def _add_legend(axes: "Axes") -> None:
    """Explain the curves beside the axes, if they need it."""
    handles, labels = axes.get_legend_handles_labels()
    if entries := dict(zip(labels, handles, strict=True)):  # each once
        look: Any = {"bbox_to_anchor": (1, 0.5), "handlelength": 3, "labelspacing": 0.3}
        axes.legend(entries.values(), entries, loc="center left", **look)


def _set_places(axes: "Axes", along: Range) -> None:
    """Set the x axis; that of a list has its values at equal distances, upright if there is no room."""
    axes.set_xlabel(axis_title([along.label], along.unit.in_words))
    if along.is_list:
        names = ["locked" if point == LOCKED else typeset(along.cell(point)) for point in along.points]
        rotation = 90 if len("  ".join(names)) > TICK_CHARACTERS else 0
        axes.set_xticks(range(len(names)), names, rotation=rotation)
        return
    if along.log:
        axes.set_xscale("log")
    axes.set_xlim(*map(float, along.ends))


def _set_heights(axes: "Axes", numbers: Sequence[float]) -> None:
    """Begin an axis at 0 if that leaves at most half of it empty; draw a line at 0 if it is between."""
    low, high = min(numbers), max(numbers)
    if low < 0 < high:
        axes.axhline(0, color=FAINT, lw=0.8, zorder=0)
    elif 0 <= 2 * low <= high:
        axes.set_ylim(bottom=0)
    elif low <= 2 * high <= 0:
        axes.set_ylim(top=0)


def _draw(axes: "Axes", curve: Curve, place: int, label: str, is_list: bool) -> None:
    """Draw a curve and the changes, or the points of a list."""
    if is_list:
        axes.plot(curve.xs, curve.ys, MARKERS[place], color=COLOURS[place], ms=5, label=label)
    else:
        axes.plot(curve.xs, curve.ys, color=COLOURS[place], ls=LINE_STYLES[place], label=label)
    for x, y, words in curve.marks:
        axes.plot([x], [y], "o", color=INK, ms=4, label=words, zorder=3, clip_on=False)
