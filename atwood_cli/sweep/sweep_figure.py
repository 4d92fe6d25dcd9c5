"""The curves of a sweep, and their picture."""

from collections import Counter
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
"""The most curves on one pair of axes: everybody can distinguish six colours."""
DRAWN_UNNAMED = ["acceleration"]
"""The quantities that are drawn if none is named."""
LARGEST_DRAWN = 1e100
"""The largest number that is drawn, in any unit."""
CURVE_STEPS = 240
"""The steps of a curve, with which it is smooth however few points the sweep has."""
MARK_DIGITS, DRAWN_DIGITS = 3, 12
"""The digits of a place at which the regime changes: in words, and as it is drawn."""
BEGINS = {"slip": "slips", "no-slip": "holds", "verge": "on the verge"}

COLOURS = (BLUE, RED, GREEN, PURPLE, ORANGE, SKY)
LINE_STYLES = ("-", "--", "-.", (0, (5, 1, 1, 1, 1, 1)), (0, (1, 1)), (0, (8, 2)))
PLAIN_POWERS = (-3, 5)
"""The powers of ten between which numbers on axes are written without one."""
PANEL_INCHES = 3.5
"""The height of each pair of axes after the first."""
TITLE_CHARACTERS = 40
"""The most characters of a line beside an axis."""


class Curve(NamedTuple):
    """A quantity along a range, while all other inputs stay the same.

    ``name`` differs from the other curves' names, and says where the string begins to slip or to hold.
    ``heights`` belong to the values ``xs``. Where the quantity is not one number, ``least`` and ``most`` are
    the edges of a band. NaN stands where there is no number. ``marks`` are the places of changes of regime.
    """

    name: str
    xs: list[float]
    heights: list[float]
    least: list[float]
    most: list[float]
    marks: list[tuple[float, float]]


class Picture(NamedTuple):
    """Panels over one x axis: curves of quantities with the same unit, by the title of their y axis.

    ``notes`` say why something is missing.
    """

    title: str
    x: str
    log: bool
    panels: dict[str, list[Curve]]
    notes: list[str]


def drawable(sweep: Sweep, names: Sequence[str]) -> list[str]:
    """The quantities to draw: the names that are of numbers. Raises SceneError where they make no picture."""
    drawable_names = [name for name in names or DRAWN_UNNAMED if name in QUANTITIES]
    if not drawable_names:
        raise SceneError("only", names[0], "is no number to draw, the table shows it; name a quantity")
    along = longest(sweep)
    if len(along.finite) < 2:
        raise SceneError(along.name, along.typed, "has one finite value, which makes no axis; give another")
    if along.ends[1] > LARGEST_DRAWN or (along.log and along.ends[0] < 1 / LARGEST_DRAWN):
        raise _undrawable(along.name)
    if len({*map(float, along.ends)}) < 2:
        raise SceneError(along.name, along.typed, "has ends too close together to draw what is between them")
    scenes, units = sweep.total // len(along.points), [QUANTITIES[name].unit for name in drawable_names]
    if (count := scenes * max(map(units.count, units))) > MAX_CURVES:
        rule = f"would draw {count} curves on one pair of axes, more than {MAX_CURVES}"
        fewer = f"give one of the ranges at most {MAX_CURVES} points" * (count == scenes)
        raise SceneError("figure", None, f"{rule}; {fewer or 'name fewer quantities, or give fewer points'}")
    return drawable_names


def _undrawable(name: str) -> SceneError:
    rule = f"draws numbers between {1 / LARGEST_DRAWN} and {LARGEST_DRAWN} in magnitude only"
    return SceneError("figure", None, f"{rule}, not such {name}")


def longest(sweep: Sweep) -> Range:
    """The range along which curves run; of two that come into question it has more points."""
    return max(reversed(sweep.ranges), key=lambda range_: (range_.rank, len(range_.finite)))


class _Along(NamedTuple):
    """A scene along a range: the point of the other range, the changes, and the answers at many values."""

    point: str
    changes: list[Change]
    xs: list[float]
    answers: list[Answers]


def _along(along: Range, scene: Scene, point: str) -> _Along:
    found = list(changes(scene, along, DRAWN_DIGITS, what=_state))
    beside = (value for change in found for value in (change.last, change.first))
    values = sorted({*along.steps(CURVE_STEPS), *beside})
    answers = [Answers(with_value(scene, along.name, value)) for value in values]
    return _Along(point, found, [*map(float, values)], answers)


def _state(case: Case) -> tuple[str, int, bool]:
    """A curve may have a corner where this changes."""
    return case.regime, case.sign, case.axle_holds


def picture(sweep: Sweep, names: Sequence[str]) -> Picture:
    """Curves of quantities along one range, for each point of the other range.

    Raises SceneError where numbers are too large to draw, ArithmeticError where there are none.
    """
    along = longest(sweep)
    scenes = [_along(along, scene, _in_symbols(sweep, points)) for scene, points in sweep.along(along)]
    all_answers = [answers for scene in scenes for answers in scene.answers]
    lacking = [
        (name, answers) for answers in all_answers for name in names if isnan(_height(answers, name, "max"))
    ]
    reasons = {(name, answers.answer(name).reason): 1 for name, answers in lacking if answers[name] is None}
    absent = Counter(name for name, _ in lacking)
    drawn = [name for name in names if absent[name] < len(all_answers)]
    if not drawn:
        why = unmarked("; ".join(dict.fromkeys(reason for _, reason in reasons)))
        raise ArithmeticError(f"{', '.join(names)} exists at no point, so there is nothing to draw: {why}")
    panels = {}
    for unit in dict.fromkeys(QUANTITIES[name].unit for name in drawn):
        of_unit = [name for name in drawn if QUANTITIES[name].unit == unit]
        curves = [
            _curve(along, scene, name, name == drawn[0], alone=not of_unit[1:])
            for name in of_unit
            for scene in scenes
        ]
        if max(abs(y) for curve in curves for y in curve.most if not isnan(y)) > LARGEST_DRAWN:
            raise _undrawable(" or ".join(of_unit))
        panels[axis_title(of_unit, unit)] = curves
    return Picture(
        title=f"{axis_title(drawn)} against {axis_title([along.name])}",
        x=axis_title([along.name], along.unit),
        log=along.log,
        panels=panels,
        notes=[*[f"{along.stated(LOCKED)} has no place on the axis."] * along.locks, *reasons_at(reasons, 1)],
    )


def _curve(along: Range, scene: _Along, name: str, first: bool, alone: bool) -> Curve:
    """The curve of a quantity, ``alone`` on its axes or not; the ``first`` quantity says the changes."""
    heights, least, most = (
        [_height(answers, name, edge) for answers in scene.answers] for edge in ("", "min", "max")
    )
    changed = [change for change in scene.changes if change.before[0] != change.after[0]]
    symbol = axis_words(name)[1] * (not alone)
    begins = [_begins(along, change) for change in changed] if first else []
    marks = []
    for change in changed:
        beside = [most[scene.xs.index(float(value))] for value in (change.first, change.last)]
        marks.append((float(change.first), next((y for y in beside if not isnan(y)), nan)))
    label = ", ".join(filter(None, [symbol, scene.point, *begins]))
    return Curve(label, scene.xs, heights, least, most, marks)


def _height(answers: Answers, name: str, edge: str = "") -> float:
    """A quantity as a coordinate, or an edge of its band; NaN if it does not exist or no double holds it."""
    if edge and name == "friction_force" and answers[name] is None:
        name = f"{name}_{edge}"
    value: Any = answers[name]
    return nan if value is None or is_infinite(value) else float(value)


def _begins(along: Range, change: Change) -> str:
    """The regime that begins at a change, and the place, in a few words."""
    number = tidy(to_digits(MARK_DIGITS)(change.first))
    return f"{BEGINS[change.after[0]]} from {along.in_units(exact_point(Fraction(number), along.suffix))}"


def axis_title(names: Sequence[str], unit: str = "") -> str:
    """The title of an axis: names, symbols and unit, as tension T₁, T₂ (N)."""
    symbols: dict[str, list[str]] = {}
    for words, symbol in map(axis_words, names):
        symbols.setdefault(words, []).append(symbol)
    title = ", ".join(f"{words} {', '.join(of_words)}" for words, of_words in symbols.items())
    return f"{title}{f' ({unit})' * bool(unit)}"


def _in_symbols(sweep: Sweep, at: Mapping[str, Point]) -> str:
    """The point by which a scene of a sweep differs from others: μ = 0.2, or disk; empty without others."""
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
    content = picture(sweep, names)
    with page(path, force) as figure:
        if more := len(content.panels) - 1:
            figure.set_figheight(figure.get_figheight() + more * PANEL_INCHES)
        panels = figure.subplots(len(content.panels), 1, sharex=True, squeeze=False)[:, 0]
        panels[-1].set_xlabel(content.x)
        for axes, (title, curves) in zip(panels, content.panels.items(), strict=True):
            axes.set_xscale("log" if content.log else "linear")
            axes.set_xlim(curves[0].xs[0], curves[0].xs[-1])
            axes.set_ylabel("\n".join(wrapped(title, TITLE_CHARACTERS)))
            axes.spines[["top", "right"]].set_visible(False)
            axis: Literal["y", "both"] = "y" if content.log else "both"
            axes.ticklabel_format(axis=axis, scilimits=PLAIN_POWERS, useMathText=True)
            _draw(axes, curves)
        if not bare:
            say_above(figure, _caption(sweep, content))


def _draw(axes: "Axes", curves: Sequence[Curve]) -> None:
    """Draw curves on one pair of axes, whose y axis has a 0 if that leaves at most half of it empty."""
    for curve, colour, style in zip(curves, COLOURS, LINE_STYLES, strict=False):
        axes.plot(curve.xs, curve.heights, lw=1.8, label=curve.name, color=colour, ls=style)
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


def _caption(sweep: Sweep, content: Picture) -> str:
    """Sentences on the content of a picture."""
    inputs = sweep.inputs
    inputs.pop(longest(sweep).name)
    in_symbols = ", ".join(f"{axis_words(name)[1]}{words[len(name) :]}" for name, words in inputs.items())
    title = content.title[0].upper() + content.title[1:]
    return " ".join([f"{title}: {in_symbols}.", *content.notes])
