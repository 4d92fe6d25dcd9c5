"""The curves of a sweep, and their picture."""

from collections.abc import Iterator, Sequence
from fractions import Fraction
from math import isnan, nan
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from ..model.case import Case
from ..model.digits import is_infinite, text, tidy, to_digits
from ..model.quantities import QUANTITIES
from ..model.scene import Scene, SceneError
from ..output.figure import (
    AXES,
    BLUE,
    FAINT,
    GREEN,
    INK,
    ORANGE,
    PURPLE,
    RED,
    SKY,
    axis_words,
    check_file,
    name_ends,
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
    from matplotlib.lines import Line2D

MAX_CURVES = 6
"""The most on one pair of axes: there are six colours that everybody can distinguish."""
USUAL = ["acceleration"]
"""What is drawn if nothing is named."""
EMPTY_X, EMPTY_Y = 0.25, 0.5
"""The shares of axes that may be empty for them to start at 0."""
LARGEST_DRAWN = 1e100
STEPS = 240
"""Of a curve, so that it is smooth however few points the sweep has."""
MARK_DIGITS, LABEL_DIGITS, DRAWN_DIGITS = 3, 4, 12
BEGINS = {"slip": "slips", "no-slip": "holds", "verge": "on the verge"}


COLOURS = (BLUE, RED, GREEN, PURPLE, ORANGE, SKY)
DASHES = ("-", "--", "-.", (0, (5, 1, 1, 1, 1, 1)), (0, (1, 1)), (0, (8, 2)))

MARGIN = 0.1  # of the height, above and below the curves
POWERS = (-3, 5)  # of ten: beyond, numbers on axes have a power of ten behind them
MOST_LINES = 6  # from places on curves down to the axis: more are a thicket
PANEL = 3.5  # inches, for each pair of axes more
TITLE = 40  # characters: more do not fit beside an axis


class Curve(NamedTuple):
    """A quantity along a range in one scene.

    ``name`` tells it from the other curves, and says where the string begins to slip or to hold; ``colour``
    and ``dash`` are the same in all panels. ``heights`` are at the values ``xs``; where the quantity is not
    one number, its ``least`` and ``most`` are the edges of a band. None is where there is no number.
    ``marks`` are the places at which the regime changes.
    """

    name: str
    colour: int
    dash: int
    xs: list[float]
    heights: list[float | None]
    least: list[float | None]
    most: list[float | None]
    marks: list[tuple[float, float | None]]


class Panel(NamedTuple):
    """The curves on one pair of axes, of quantities of one unit, and what the y axis says."""

    names: list[str]
    y: str
    curves: list[Curve]

    @property
    def ys(self) -> list[float]:
        """All heights."""
        lines = [line for curve in self.curves for line in (curve.heights, curve.least, curve.most)]
        return [y for line in lines for y in line if y is not None]


class Picture(NamedTuple):
    """Panels over one x axis.

    ``notes`` say why something is missing.
    """

    title: str
    x: str
    log: bool
    panels: list[Panel]
    notes: list[str]

    @property
    def xs(self) -> list[float]:
        return self.panels[0].curves[0].xs


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


def picture(sweep: Sweep, names: Sequence[str]) -> Picture:
    """Curves of quantities along one range, for each point of the other.

    Raises SceneError where numbers are too large to draw, ArithmeticError where there are none.
    """
    x = longest(sweep)
    reasons: dict[tuple[str, str], int] = {}
    scenes = [scene for scene, _ in sweep.along(x)]
    sampled = [_sampled(x, scene, names, reasons) for scene in scenes]
    drawn = [name for name in names if any(map(_has_values, (one.lines[name] for one in sampled)))]
    if not drawn:
        why = unmarked("; ".join(dict.fromkeys(reason for _, reason in reasons)))
        raise ArithmeticError(f"{', '.join(names)} exists at no point, so there is nothing to draw: {why}")
    points = _in_symbols(next(one for one in sweep.ranges if one is not x)) if sweep.ranges[1:] else [""]
    units = [QUANTITIES[name].unit for name in drawn]
    panels = []
    for unit in dict.fromkeys(units):
        here = [name for name in drawn if QUANTITIES[name].unit == unit]
        curves = [curve for name in here for curve in _curves(name, here, drawn, x, sampled, points)]
        panels.append(Panel(here, axis_title(here, unit), curves))
    for panel in panels:
        if max(map(abs, panel.ys)) > LARGEST_DRAWN:
            raise _undrawable(" or ".join(panel.names))
    return Picture(
        title=f"{', '.join(axis_title(panel.names) for panel in panels)} against {axis_title([x.name])}",
        x=axis_title([x.name], x.unit),
        log=x.log,
        panels=panels,
        notes=[*[f"{x.stated(LOCKED)} has no place on the axis."] * x.locks, *reasons_at(reasons, 1)],
    )


def _curves(
    name: str,
    here: Sequence[str],
    drawn: Sequence[str],
    x: Range,
    sampled: "Sequence[_Sampled]",
    points: Sequence[str],
) -> Iterator[Curve]:
    """A quantity's curves, one a scene; ``here`` are those on its pair of axes, of all that are ``drawn``."""
    symbol = axis_words(name)[1] * bool(here[1:])
    together = len({QUANTITIES[one].unit for one in drawn}) < len(drawn)  # on some pair of axes
    number = drawn.index(name)
    for i, (one, point) in enumerate(zip(sampled, points, strict=True)):
        changed = [c for c in one.corners if c.before[0] != c.after[0]]
        begins = [_begins(x, c) for c in changed] if not number else []
        heights, least, most = one.lines[name]
        yield Curve(
            name=", ".join(filter(None, [symbol, point, *begins])),
            colour=i if sampled[1:] else number,
            dash=number if together or not sampled[1:] else i,
            xs=one.xs,
            heights=heights,
            least=least,
            most=most,
            marks=[(float(c.first), _height(c, one.xs, one.lines[name])) for c in changed],
        )


class _Sampled(NamedTuple):
    """Quantities along a range in one scene: at which values, their lines, where these may have corners."""

    xs: list[float]
    lines: dict[str, list[list[float | None]]]
    corners: list[Change]


def _sampled(x: Range, scene: Scene, names: Sequence[str], reasons: dict[Any, int]) -> _Sampled:
    """The answers at many values; ``reasons`` gets why some are missing."""
    corners = list(changes(scene, x, DRAWN_DIGITS, what=_state))
    values = {*x.steps(STEPS), *(value for one in corners for value in (one.last, one.first))}
    sampled = _Sampled([], {name: [[], [], []] for name in names}, corners)
    for value in sorted(values):
        answers = Answers(with_value(scene, x.name, value))
        sampled.xs.append(float(value))
        for name in names:
            heights = [_drawn(answers[name]), *_bounds(answers, name)]
            for line, height in zip(sampled.lines[name], heights, strict=True):
                line.append(height)
            if answers[name] is None and not any(height is not None for height in heights):
                reasons[name, answers.reasons[name]] = 1
    return sampled


def _has_values(lines: list[list[float | None]]) -> bool:
    return any(height is not None for line in lines for height in line)


def _state(case: Case) -> tuple[str, int, bool]:
    """A curve may have a corner where this changes."""
    return case.regime, case.sign, case.axle_holds


def _bounds(answers: Answers, name: str) -> tuple[float | None, float | None]:
    """The bounds of the friction force; both are its value where it is one number."""
    if name != "friction_force":
        return None, None
    if answers[name] is not None:
        return _drawn(answers[name]), _drawn(answers[name])
    return _drawn(answers["friction_force_min"]), _drawn(answers["friction_force_max"])


def _height(change: Change, xs: Sequence[float], lines: Sequence[Sequence[float | None]]) -> float | None:
    """The height of a curve, or of its band, at a change; None where neither side of it has one."""
    beside = [i for i, x in enumerate(xs) if x in (float(change.first), float(change.last))]
    heights = [line[i] for i in beside for line in lines if line[i] is not None]
    return heights[-1] if heights else None


def _begins(along: Range, change: Change) -> str:
    """What begins at a change, in a few words."""
    number = tidy(to_digits(MARK_DIGITS)(change.first))
    return f"{BEGINS[change.after[0]]} from {along.in_units(exact_point(Fraction(number), along.suffix))}"


def _drawn(value: Any) -> float | None:
    """A value as a coordinate, None if there is none or no double holds it."""
    return None if value is None or is_infinite(value) else float(value)


def axis_title(names: Sequence[str], unit: str = "") -> str:
    """What an axis says: names, symbols and unit, as tension T₁, T₂ (N)."""
    symbols: dict[str, list[str]] = {}
    for words, symbol in map(axis_words, names):
        symbols.setdefault(words, []).append(symbol)
    said = ", ".join(f"{words} {', '.join(them)}" for words, them in symbols.items())
    return f"{said}{f' ({unit})' * bool(unit)}"


def axis_ends(values: Sequence[float], empty: float) -> tuple[float, float]:
    """The ends of an axis over some values: from 0 if that leaves no more than a share of it empty."""
    low, high = min(values), max(values)
    if low == high and empty:
        return min(low, 0.0), max(high, 0.0)
    return 0.0 if 0 < low <= empty * high else low, 0.0 if 0 > high >= empty * low else high


def with_break(title: str, low: float, high: float) -> str:
    """The title of an axis, which says so if 0 is not on it."""
    if low <= 0 <= high:
        return title
    end = tidy(to_digits(MARK_DIGITS)(Fraction(low if low > 0 else high)))
    return f"{title}, the axis {'starts' if low > 0 else 'ends'} at {text(end)}"


def _in_symbols(range_: Range) -> list[str]:
    """What tells each point from the others, in symbols and in few digits: μ = 0.1333, or disk."""

    def shown(point: Point, digits: int) -> str:
        if point != LOCKED:
            number = Fraction(tidy(to_digits(digits)(Fraction(point.exact))))
            point = exact_point(number, range_.suffix, point.name)
        return point.name or f"{AXES[range_.name][1]} = {range_.in_units(point)}"

    digits = LABEL_DIGITS
    while len(said := dict.fromkeys(shown(point, digits) for point in range_.points)) < len(range_.points):
        digits += 1
    return list(said)


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
        low, high = axis_ends(drawn.xs, 0 if drawn.log else EMPTY_X)
        panels[-1].set_xlabel(drawn.x if drawn.log else with_break(drawn.x, low, high))
        ends = []
        for axes, panel in zip(panels, drawn.panels, strict=True):
            axes.set_xscale("log" if drawn.log else "linear")
            if low < high:
                axes.set_xlim(low, high)  # where the curve has gaps, too
            axes.spines[["top", "right"]].set_visible(False)
            axis: Literal["y", "both"] = "y" if drawn.log else "both"
            axes.ticklabel_format(axis=axis, scilimits=POWERS, useMathText=True)
            ends.append(_draw(axes, panel))
        if not bare:
            say_above(figure, _caption(sweep, drawn))
        for axes, named in zip(panels, ends, strict=True):
            name_ends(axes, named)


def _draw(axes: "Axes", panel: Panel) -> list[tuple["Line2D", float, float]]:
    """Draw the curves on one pair of axes; those that have names, and where they end."""
    low, high = axis_ends(panel.ys, EMPTY_Y)
    room = MARGIN * (high - low)
    axes.set_ylim(low - room * (low != 0), (high + room * (high != 0)) or 1)
    if low > 0:
        low = max(tick for tick in axes.get_yticks() if tick <= low)
        axes.set_ylim(bottom=low)
    axes.set_ylabel("\n".join(wrapped(with_break(panel.y, low, axes.get_ylim()[1]), TITLE)))
    bottom, _ = axes.get_ylim()
    ends = []
    few = sum(len(curve.marks) for curve in panel.curves) <= MOST_LINES
    for curve in panel.curves:
        look: Any = {"color": COLOURS[curve.colour % len(COLOURS)], "ls": DASHES[curve.dash % len(DASHES)]}
        lines = (curve.heights, curve.least, curve.most)
        ys, least, most = ([nan if y is None else y for y in line] for line in lines)
        (line,) = axes.plot(curve.xs, ys, lw=1.8, label=curve.name, **look)
        axes.fill_between(curve.xs, least, most, color=look["color"], alpha=0.18, lw=0)
        for edge in (least, most):
            axes.plot(curve.xs, edge, lw=0.8, **look)
        there = [(x, y) for x, *both in zip(curve.xs, ys, most, strict=True) for y in both if not isnan(y)]
        if curve.name and there:
            ends.append((line, *max(there)))
        for x, height in curve.marks:
            y = bottom if height is None else height
            axes.plot([x], [y], "o", color=INK, ms=4, zorder=3)
            if few:
                axes.plot([x, x], [bottom, y], color=FAINT, lw=0.8, ls=":")
    return ends


def _caption(sweep: Sweep, drawn: Picture) -> str:
    """What a picture shows, in sentences."""
    words = sweep.inputs
    words.pop(longest(sweep).name)
    others = ", ".join(f"{axis_words(name)[1]}{said[len(name) :]}" for name, said in words.items())
    title = drawn.title[0].upper() + drawn.title[1:]
    return " ".join([f"{title}: {others}.", *drawn.notes])
