"""The curves of a sweep, for a terminal or a file, and the regimes along them."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from ..arithmetic.rounding import is_infinite, tidy, to_digits
from ..model.case import Case
from ..model.quantities import QUANTITIES
from ..model.scene import Scene, SceneError
from ..solver.answers import Answers
from ..solver.messages import reasons_at, unmarked
from ..solver.regimes import Change, changes, with_value
from ..solver.sweep import Range, Sweep, point_in_units, stated_point

MAX_CURVES = 6
LARGEST_DRAWN = 1e100
STEPS = 240
"""Of a curve, so that it is smooth however few points the sweep has."""
MARK_DIGITS, DRAWN_DIGITS = 3, 12
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
}
"""Names and symbols on axes, of parameters and of quantities whose own name says less."""
BEGINS = {"slip": "slips", "no-slip": "holds", "verge": "on the verge"}


class Mark(NamedTuple):
    """A point of a curve at which the regime changes, and what begins there."""

    x: float
    y: float | None
    words: str


class Curve(NamedTuple):
    """A quantity along a range: ``ys`` is None where it has no value; ``band`` are its bounds, if it has any.

    ``label`` says which of several curves it is, ``symbols`` says it in symbols.
    """

    label: str
    symbols: str
    xs: list[float]
    ys: list[float | None]
    band: list[tuple[float | None, float | None]]
    regimes: list[str]
    marks: list[Mark]

    @property
    def lines(self) -> list[list[float | None]]:
        """The curve and both edges of its band."""
        return [self.ys, [low for low, _ in self.band], [high for _, high in self.band]]


class Picture(NamedTuple):
    """Curves, what their axes say, and why something is missing."""

    x: str
    y: str
    log: bool
    curves: list[Curve]
    notes: list[str]


def check_drawable(sweep: Sweep, option: str, name: str) -> None:
    """Raises SceneError where the sweep and the quantity make no curves."""
    if name not in QUANTITIES:
        raise SceneError(option, name, "is not a number to draw; name another quantity")
    if min(len(range_.points) for range_ in sweep.ranges) > MAX_CURVES and sweep.ranges[1:]:
        rule = f"would be more than {MAX_CURVES} curves; give one of the ranges at most {MAX_CURVES} points"
        raise SceneError(option, name, rule)


def longest(sweep: Sweep) -> Range:
    """The range of more points, along which curves run."""
    return max(reversed(sweep.ranges), key=lambda range_: len(range_.points))


def picture(sweep: Sweep, option: str, name: str, digits: int | None) -> Picture:
    """Curves of a quantity along the range of more points, one for each point of the other.

    Raises SceneError where numbers are too large to draw, ArithmeticError where there are none.
    """
    x = longest(sweep)
    reasons: dict[tuple[str, str], int] = {}
    curves = [_curve(x, at, name, digits, reasons) for at in sweep.along(x)]
    ys = [y for curve in curves for line in curve.lines for y in line if y is not None]
    if not ys:
        why = unmarked("; ".join(dict.fromkeys(reason for _, reason in reasons)))
        raise ArithmeticError(f"{name} exists at no point, so there is nothing to draw: {why}")
    xs = curves[0].xs
    if max(map(abs, [*xs, *ys])) > LARGEST_DRAWN or (x.log and min(xs) < 1 / LARGEST_DRAWN):
        rule = f"draws numbers between {1 / LARGEST_DRAWN} and {LARGEST_DRAWN} in magnitude only"
        raise SceneError(option, name, rule)
    titles = (axis_title(x.name, x.unit), axis_title(name, QUANTITIES[name].unit))
    return Picture(*titles, x.log, curves, reasons_at(reasons, 1))


def _curve(
    x: Range, fixed: tuple[Scene, Mapping[str, Any]], name: str, digits: int | None, reasons: dict[Any, int]
) -> Curve:
    scene, at = fixed
    corners = list(changes(scene, x, DRAWN_DIGITS, what=_state))
    values = [*x.steps(STEPS), *(value for one in corners for value in (one.last, one.first))]
    xs, ys, band = [], [], []
    for value in sorted(set(values), reverse=x.ends[0] > x.ends[1]):
        answers = Answers(with_value(scene, x.name, value))
        xs.append(float(value))
        ys.append(_drawn(answers[name]))
        bounds = _bounds(answers, name)
        band.append(bounds)
        if answers[name] is None and bounds == (None, None):
            reasons[name, answers.reasons[name]] = 1
    marks = [
        Mark(float(one.first), _height(one, xs, ys, band), _begins(x, one))
        for one in corners
        if one.before[0] != one.after[0]
    ]
    label = ", ".join(stated_point(other, point) for other, point in at.items())
    symbols = ", ".join(f"{AXES[other][1]} = {point_in_units(other, point)}" for other, point in at.items())
    return Curve(label, symbols, xs, ys, band, regimes(x, list(changes(scene, x, digits)), scene), marks)


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


def _height(
    change: Change,
    xs: Sequence[float],
    ys: Sequence[float | None],
    band: Sequence[tuple[float | None, float | None]],
) -> float | None:
    """The height of a curve at a change, None where neither side of it has one."""
    beside = [i for i, x in enumerate(xs) if x in (float(change.first), float(change.last))]
    heights = [y for i in beside for y in (ys[i], band[i][1]) if y is not None]
    return heights[-1] if heights else None


def _begins(along: Range, change: Change) -> str:
    """What begins at a change, in a few words."""
    number = tidy(to_digits(MARK_DIGITS)(change.first))
    return f"{BEGINS[change.after[0]]} from {point_in_units(along.name, along.point(number))}"


def regimes(along: Range, found: Sequence[Change], scene: Scene) -> list[str]:
    """Each regime along a range, and up to where it holds."""
    if not found:
        return [Case(with_value(scene, along.name, along.ends[0])).regime]
    parts = []
    for before, one in zip([None, *found], found, strict=False):
        place = point_in_units(along.name, one.at)
        where = "at" if one.at == (before.at if before else along.points[0]) else "up to"
        parts.append(f"{one.before} {where} {f'{along.name} = ' * (before is None)}{place}")
    return [*parts, f"{found[-1].after} beyond"]


def _drawn(value: Any) -> float | None:
    """A value as a coordinate, None if there is none or no double holds it."""
    return None if value is None or is_infinite(value) else float(value)


def axis_words(name: str) -> tuple[str, str]:
    """The name and the symbol of a parameter or a quantity."""
    if name in AXES:
        return AXES[name]
    return name.rstrip("_12").replace("_", " "), QUANTITIES[name].symbol


def axis_title(name: str, unit: str) -> str:
    """What an axis says: name, symbol and unit."""
    return f"{' '.join(axis_words(name))}{f' ({unit})' * bool(unit)}"
