"""The curves of a sweep, for a terminal or a file, and the regimes along them."""

from collections.abc import Sequence
from fractions import Fraction
from math import inf
from typing import Any, NamedTuple

from ..arithmetic.rounding import is_infinite, text, tidy, to_digits
from ..model.case import Case
from ..model.quantities import QUANTITIES
from ..model.scene import Scene, SceneError
from ..solver.answers import Answers
from ..solver.messages import reasons_at, unmarked
from ..solver.regimes import Change, changes
from ..solver.sweep import LOCKED, Point, Range, Sweep, point_in_units, with_value

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
AXES = {
    "m1": ("mass", "m₁"),
    "m2": ("mass", "m₂"),
    "M": ("pulley mass", "M"),
    "mu": ("friction coefficient", "μ"),
    "mu_k": ("kinetic friction coefficient", "μₖ"),
    "g": ("gravity", "g"),
    "inertia": ("inertia factor", "β"),
    "I": ("moment of inertia", "I"),
    "R": ("radius", "R"),
    "wrap": ("angle of wrap", "φ"),
    "axle": ("friction of the axle", "f"),
    "mu_verge": ("verge coefficient", "μ*"),
    "friction_force_min": ("least friction force", "F min"),
    "friction_force_max": ("greatest friction force", "F max"),
    "friction_force_x": ("horizontal friction force", "Fx"),
    "friction_force_y": ("vertical friction force", "Fy"),
}
"""Names and symbols on axes, of parameters and of quantities whose own name says less."""
BEGINS = {"slip": "slips", "no-slip": "holds", "verge": "on the verge"}


class Mark(NamedTuple):
    """A point of a curve at which the regime changes, and what begins there, unless another curve says it."""

    x: float
    y: float | None
    words: str


class Curve(NamedTuple):
    """A quantity along a range: its heights and those of both edges of its band; None where there is none.

    ``label`` says which of several curves it is, ``symbols`` says it in symbols. ``colour`` is the number
    of its scene, ``style`` that of its quantity; where one of these is the same for all, both are the other.
    """

    label: str
    symbols: str
    colour: int
    style: int
    xs: list[float]
    lines: list[list[float | None]]
    marks: list[Mark]


class Panel(NamedTuple):
    """The curves on one pair of axes, of quantities of one unit, and what the y axis says."""

    names: list[str]
    y: str
    curves: list[Curve]

    @property
    def ys(self) -> list[float]:
        """All heights."""
        return [y for curve in self.curves for line in curve.lines for y in line if y is not None]


class Picture(NamedTuple):
    """Panels over one x axis.

    ``regimes`` says for each scene which one it is, and its regimes along the axis; ``missing`` are the
    quantities that exist at no point, and ``notes`` say why something is missing.
    """

    title: str
    x: str
    log: bool
    panels: list[Panel]
    regimes: list[tuple[str, str]]
    missing: set[str]
    notes: list[str]

    @property
    def xs(self) -> list[float]:
        return self.panels[0].curves[0].xs


def drawable(sweep: Sweep, option: str, names: Sequence[str]) -> list[str]:
    """The quantities to draw: the numbers among those named. Raises SceneError where they make no picture."""
    drawn = [name for name in names or USUAL if name in QUANTITIES]
    if not drawn:
        raise SceneError("only", names[0], "is no number to draw, the table shows it; name a quantity")
    x = longest(sweep)
    if len(x.finite) < 2:
        raise SceneError(x.name, x.typed, "has one finite value, which makes no axis; give another")
    if x.ends[1] > LARGEST_DRAWN or (x.log and x.ends[0] < 1 / LARGEST_DRAWN):
        raise _undrawable(option, x.name)
    if len({*map(float, x.ends)}) < 2:
        raise SceneError(x.name, x.typed, "has ends too close together to draw what is between them")
    scenes, units = sweep.total // len(x.points), [QUANTITIES[name].unit for name in drawn]
    if (count := scenes * max(map(units.count, units))) > MAX_CURVES:
        rule = f"would draw {count} curves on one pair of axes, more than {MAX_CURVES}"
        fewer = f"give one of the ranges at most {MAX_CURVES} points" * (count == scenes)
        raise SceneError(option, None, f"{rule}; {fewer or 'name fewer quantities, or give fewer points'}")
    return drawn


def _undrawable(option: str, name: str) -> SceneError:
    rule = f"draws numbers between {1 / LARGEST_DRAWN} and {LARGEST_DRAWN} in magnitude only"
    return SceneError(option, None, f"{rule}, not such {name}")


def longest(sweep: Sweep) -> Range:
    """The range along which curves run: if two come into question, the one of more points."""
    return max(reversed(sweep.ranges), key=lambda one: (one.rank, len(one.finite)))


def picture(sweep: Sweep, option: str, names: Sequence[str], digits: int | None) -> Picture:
    """Curves of quantities along one range, for each point of the other.

    Raises SceneError where numbers are too large to draw, ArithmeticError where there are none.
    """
    x = longest(sweep)
    reasons: dict[tuple[str, str], int] = {}
    scenes, places = zip(*sweep.along(x), strict=True)
    sampled = [_sampled(x, scene, names, reasons) for scene in scenes]
    drawn = [name for name in names if any(map(_has_values, (one.lines[name] for one in sampled)))]
    if not drawn:
        why = unmarked("; ".join(dict.fromkeys(reason for _, reason in reasons)))
        raise ArithmeticError(f"{', '.join(names)} exists at no point, so there is nothing to draw: {why}")
    which = [sweep.stated(at) for at in places]
    symbols = _in_symbols(next(one for one in sweep.ranges if one is not x)) if sweep.ranges[1:] else [""]
    panels = []
    for unit in dict.fromkeys(QUANTITIES[name].unit for name in drawn):
        here = [name for name in drawn if QUANTITIES[name].unit == unit]
        curves = [
            Curve(
                label=_joined(name * bool(here[1:]), which[i]),
                symbols=_joined(axis_words(name)[1] * bool(here[1:]), symbols[i]),
                colour=i if scenes[1:] else number,
                style=number if here[1:] else i,
                xs=one.xs,
                lines=one.lines[name],
                marks=[
                    Mark(
                        float(c.first),
                        _height(c, one.xs, one.lines[name]),
                        _begins(x, c) if name == drawn[0] else "",
                    )
                    for c in one.corners
                    if c.before[0] != c.after[0]
                ],
            )
            for number, name in enumerate(here)
            for i, one in enumerate(sampled)
        ]
        panels.append(Panel(here, axis_title(here, unit), curves))
    for one in panels:
        if max(map(abs, one.ys)) > LARGEST_DRAWN:
            raise _undrawable(option, " or ".join(one.names))
    return Picture(
        title=f"{', '.join(axis_title(panel.names) for panel in panels)} against {axis_title([x.name])}",
        x=axis_title([x.name], x.unit),
        log=x.log,
        panels=panels,
        regimes=[
            (one, ", ".join(regimes(x, list(changes(scene, x, digits)), scene)))
            for one, scene in zip(which, scenes, strict=True)
        ],
        missing=set(names) - set(drawn),
        notes=[*[f"{x.stated(LOCKED)} has no place on the axis."] * x.locks, *reasons_at(reasons, 1)],
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


def _joined(*words: str) -> str:
    return ", ".join(filter(None, words))


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
    return f"{BEGINS[change.after[0]]} from {point_in_units(along.name, along.point(number))}"


def regimes(along: Range, found: Sequence[Change], scene: Scene) -> list[str]:
    """Each regime along a range, and up to where it holds."""
    parts = []
    for before, one in zip([None, *found], found, strict=False):
        place = point_in_units(along.name, one.at)
        where = "at" if one.at == (before.at if before else along.finite[0]) else "up to"
        parts.append(f"{one.before} {where} {f'{along.name} = ' * (before is None)}{place}")
    last = found[-1].after if found else Case(with_value(scene, along.name, along.ends[0])).regime
    parts.append(f"{last} beyond" if found else last)
    if along.locks and (locked := Case(scene._replace(M=inf)).regime) != last:
        parts.append(f"{locked} at {along.stated(LOCKED)}")
    return parts


def _drawn(value: Any) -> float | None:
    """A value as a coordinate, None if there is none or no double holds it."""
    return None if value is None or is_infinite(value) else float(value)


def axis_words(name: str) -> tuple[str, str]:
    """The name and the symbol of a parameter or a quantity."""
    if name in AXES:
        return AXES[name]
    return name.rstrip("_12").replace("_", " "), QUANTITIES[name].symbol


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
    name = range_.name

    def shown(point: Point, digits: int) -> str:
        short = point if point == LOCKED else range_.point(tidy(to_digits(digits)(range_.number(point))))
        return range_.names.get(point) or f"{AXES[name][1]} = {point_in_units(name, short)}"

    digits = LABEL_DIGITS
    while len(said := dict.fromkeys(shown(point, digits) for point in range_.points)) < len(range_.points):
        digits += 1
    return list(said)
