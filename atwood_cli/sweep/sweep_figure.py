"""The curves of a sweep, and their picture."""

from collections.abc import Mapping, Sequence
from fractions import Fraction
from math import isnan, nan
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from ..model.case import Case
from ..model.digits import is_infinite, tidy, to_digits
from ..model.quantities import QUANTITIES
from ..model.scene import Scene, SceneError
from ..output.figure import (
    AXIS_WORDS,
    BLUE,
    GREEN,
    INK,
    ORANGE,
    PURPLE,
    RED,
    SKY,
    axis_words,
    check_file,
    cut,
    legend_beside,
    page,
    say_above,
)
from ..output.text import wrapped
from ..solver.answers import Answers
from ..solver.messages import reasons_at, unmarked
from .changes import Change, changes
from .ranges import LOCKED, Point, Range, Sweep, exact_point, with_value

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MAX_CURVES = 6
"""The most on one pair of axes: there are six colours that everybody can distinguish."""
USUAL = ["acceleration"]
"""What is drawn if nothing is named."""
LARGEST_DRAWN = 1e100
STEPS = 240
"""Of a curve, so that it is smooth however few points the sweep has."""
MARK_DIGITS, DRAWN_DIGITS = 3, 12
BEGINS = {"slip": "slips", "no-slip": "holds", "verge": "on the verge"}

COLOURS = (BLUE, RED, GREEN, PURPLE, ORANGE, SKY)
DASHES = ("-", "--", "-.", (0, (5, 1, 1, 1, 1, 1)), (0, (1, 1)), (0, (8, 2)))
POWERS = (-3, 5)  # of ten: beyond, numbers on axes have a power of ten behind them
PANEL = 3.5  # inches, for each pair of axes more
TITLE = 40  # characters: more do not fit beside an axis


class Curve(NamedTuple):
    """A quantity along a range in one scene.

    ``name`` tells it from the other curves, and says where the string begins to slip or to hold. ``heights``
    are at the values ``xs``; where the quantity is not one number, ``least`` and ``most`` are the edges of a
    band. NaN is where there is no number. ``marks`` are the places at which the regime changes.
    """

    name: str
    xs: list[float]
    heights: list[float]
    least: list[float]
    most: list[float]
    marks: list[tuple[float, float]]


class Picture(NamedTuple):
    """Panels over one x axis: the curves of quantities of one unit, by what their y axis says.

    ``notes`` say why something is missing.
    """

    title: str
    x: str
    log: bool
    panels: dict[str, list[Curve]]
    notes: list[str]


def drawable(sweep: Sweep, names: Sequence[str]) -> list[str]:
    """The quantities to draw: the numbers among those named. Raises SceneError where they make no picture."""
    drawn = [name for name in names or USUAL if name in QUANTITIES]
    if not drawn:
        raise SceneError("only", names[0], "is no number to draw, the table shows it; name a quantity")
    x = longest(sweep)
    if len(x.finite) < 2:
        raise SceneError(x.name, x.typed, "has one finite value, which makes no axis; give another")
    if x.ends[1] > LARGEST_DRAWN or (x.log and x.ends[0] < 1 / LARGEST_DRAWN):
        raise _undrawable(x.name)
    if len({*map(float, x.ends)}) < 2:
        raise SceneError(x.name, x.typed, "has ends too close together to draw what is between them")
    scenes, units = sweep.total // len(x.points), [QUANTITIES[name].unit for name in drawn]
    if (count := scenes * max(map(units.count, units))) > MAX_CURVES:
        rule = f"would draw {count} curves on one pair of axes, more than {MAX_CURVES}"
        fewer = f"give one of the ranges at most {MAX_CURVES} points" * (count == scenes)
        raise SceneError("figure", None, f"{rule}; {fewer or 'name fewer quantities, or give fewer points'}")
    return drawn


def _undrawable(name: str) -> SceneError:
    rule = f"draws numbers between {1 / LARGEST_DRAWN} and {LARGEST_DRAWN} in magnitude only"
    return SceneError("figure", None, f"{rule}, not such {name}")


def longest(sweep: Sweep) -> Range:
    """The range along which curves run: if two come into question, the one of more points."""
    return max(reversed(sweep.ranges), key=lambda one: (one.rank, len(one.finite)))


class _Along(NamedTuple):
    """A scene along a range: what tells it from the others, its changes, and its answers at many values."""

    point: str
    changes: list[Change]
    xs: list[float]
    answers: list[Answers]


def _along(x: Range, scene: Scene, point: str) -> _Along:
    found = list(changes(scene, x, DRAWN_DIGITS, what=_state))
    values = sorted({*x.steps(STEPS), *(value for one in found for value in (one.last, one.first))})
    answers = [Answers(with_value(scene, x.name, value)) for value in values]
    return _Along(point, found, [*map(float, values)], answers)


def _state(case: Case) -> tuple[str, int, bool]:
    """A curve may have a corner where this changes."""
    return case.regime, case.sign, case.axle_holds


def picture(sweep: Sweep, names: Sequence[str]) -> Picture:
    """Curves of quantities along one range, for each point of the other.

    Raises SceneError where numbers are too large to draw, ArithmeticError where there are none.
    """
    x = longest(sweep)
    scenes = [_along(x, scene, _in_symbols(sweep, at)) for scene, at in sweep.along(x)]
    every = [answers for scene in scenes for answers in scene.answers]
    lacking = [(name, one) for one in every for name in names if isnan(_height(one, name, "max"))]
    reasons = {(name, one.reasons[name]): 1 for name, one in lacking if one[name] is None}
    drawn = [name for name in names if any(not isnan(_height(one, name, "max")) for one in every)]
    if not drawn:
        why = unmarked("; ".join(dict.fromkeys(reason for _, reason in reasons)))
        raise ArithmeticError(f"{', '.join(names)} exists at no point, so there is nothing to draw: {why}")
    panels = {}
    for unit in dict.fromkeys(QUANTITIES[name].unit for name in drawn):
        here = [name for name in drawn if QUANTITIES[name].unit == unit]
        curves = [_curve(x, scene, name, here, name == drawn[0]) for name in here for scene in scenes]
        if max(abs(y) for curve in curves for y in curve.most if not isnan(y)) > LARGEST_DRAWN:
            raise _undrawable(" or ".join(here))
        panels[axis_title(here, unit)] = curves
    return Picture(
        title=f"{axis_title(drawn)} against {axis_title([x.name])}",
        x=axis_title([x.name], x.unit),
        log=x.log,
        panels=panels,
        notes=[*[f"{x.stated(LOCKED)} has no place on the axis."] * x.locks, *reasons_at(reasons, 1)],
    )


def _curve(x: Range, along: _Along, name: str, here: Sequence[str], first: bool) -> Curve:
    """A quantity's curve in a scene; ``here`` are the quantities on its axes, the ``first`` says changes."""
    heights, least, most = (
        [_height(one, name, edge) for one in along.answers] for edge in ("", "min", "max")
    )
    changed = [one for one in along.changes if one.before[0] != one.after[0]]
    symbol = axis_words(name)[1] * bool(here[1:])
    begins = [_begins(x, one) for one in changed] if first else []
    marks = []
    for one in changed:
        beside = [most[along.xs.index(float(value))] for value in (one.first, one.last)]
        marks.append((float(one.first), next((y for y in beside if not isnan(y)), nan)))
    said = ", ".join(filter(None, [symbol, along.point, *begins]))
    return Curve(said, along.xs, heights, least, most, marks)


def _height(answers: Answers, name: str, edge: str = "") -> float:
    """A quantity as a coordinate, or an edge of its band; NaN if there is none or no double holds it."""
    if edge and name == "friction_force" and answers[name] is None:
        name = f"{name}_{edge}"
    value: Any = answers[name]
    return nan if value is None or is_infinite(value) else float(value)


def _begins(along: Range, change: Change) -> str:
    """What begins at a change, in a few words."""
    number = tidy(to_digits(MARK_DIGITS)(change.first))
    return f"{BEGINS[change.after[0]]} from {along.in_units(exact_point(Fraction(number), along.suffix))}"


def axis_title(names: Sequence[str], unit: str = "") -> str:
    """What an axis says: names, symbols and unit, as tension T₁, T₂ (N)."""
    symbols: dict[str, list[str]] = {}
    for words, symbol in map(axis_words, names):
        symbols.setdefault(words, []).append(symbol)
    said = ", ".join(f"{words} {', '.join(them)}" for words, them in symbols.items())
    return f"{said}{f' ({unit})' * bool(unit)}"


def _in_symbols(sweep: Sweep, at: Mapping[str, Point]) -> str:
    """What tells a scene from the others of a sweep: μ = 0.2, or disk; empty where it is the only one."""
    ranges = [range_ for range_ in sweep.ranges if range_.name in at]
    points = [(range_, at[range_.name]) for range_ in ranges]
    said = (
        point.name or f"{AXIS_WORDS[range_.name][1]} = {range_.in_units(point)}" for range_, point in points
    )
    return cut("".join(said))


def save(sweep: Sweep, names: Sequence[str], path: str, force: bool, bare: bool) -> None:
    """Draw the curves of quantities to a file, below a caption unless it is to be bare.

    Raises SceneError, OSError, and ArithmeticError where there is nothing to draw.
    """
    check_file(path, force)
    drawn = picture(sweep, names)
    with page(path, force) as figure:
        if more := len(drawn.panels) - 1:
            figure.set_figheight(figure.get_figheight() + more * PANEL)
        panels = figure.subplots(len(drawn.panels), 1, sharex=True, squeeze=False)[:, 0]
        panels[-1].set_xlabel(drawn.x)
        for axes, (title, curves) in zip(panels, drawn.panels.items(), strict=True):
            axes.set_xscale("log" if drawn.log else "linear")
            axes.set_xlim(curves[0].xs[0], curves[0].xs[-1])
            axes.set_ylabel("\n".join(wrapped(title, TITLE)))
            axes.spines[["top", "right"]].set_visible(False)
            axis: Literal["y", "both"] = "y" if drawn.log else "both"
            axes.ticklabel_format(axis=axis, scilimits=POWERS, useMathText=True)
            _draw(axes, curves)
        if not bare:
            say_above(figure, _caption(sweep, drawn))


def _draw(axes: "Axes", curves: Sequence[Curve]) -> None:
    """Draw curves on one pair of axes, from 0 on where that leaves no more than half of the y axis empty."""
    for curve, colour, dash in zip(curves, COLOURS, DASHES, strict=False):
        axes.plot(curve.xs, curve.heights, lw=1.8, label=curve.name, color=colour, ls=dash)
        band = [any(map(isnan, curve.heights[max(i - 1, 0) : i + 2])) for i in range(len(curve.xs))]
        look: Any = {"facecolor": (colour, 0.18), "edgecolor": colour, "lw": 0.8}
        axes.fill_between(curve.xs, curve.least, curve.most, band, **look)
        for x, y in curve.marks:
            axes.plot([x], [y], "o", color=INK, ms=4, zorder=3)
    numbers = [y for curve in curves for y in (*curve.heights, *curve.least, *curve.most) if not isnan(y)]
    low, high = min(numbers), max(numbers)
    if 0 <= 2 * low <= high:
        axes.set_ylim(bottom=0)
    elif low <= 2 * high <= 0:
        axes.set_ylim(top=0)
    if any(curve.name for curve in curves):
        legend_beside(axes)


def _caption(sweep: Sweep, drawn: Picture) -> str:
    """What a picture shows, in sentences."""
    words = sweep.inputs
    words.pop(longest(sweep).name)
    others = ", ".join(f"{axis_words(name)[1]}{said[len(name) :]}" for name, said in words.items())
    title = drawn.title[0].upper() + drawn.title[1:]
    return " ".join([f"{title}: {others}.", *drawn.notes])
