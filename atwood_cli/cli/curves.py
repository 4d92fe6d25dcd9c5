"""The curves of a sweep, for a terminal or a file: what is drawn, and the regimes along it."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any, NamedTuple

from ..arithmetic.rounding import is_infinite
from ..model.quantities import QUANTITIES
from ..model.scene import SceneError
from ..solver.sweep import Row, Sweep, stated_point

MAX_CURVES = 6
LARGEST_DRAWN = 1e100


class Curve(NamedTuple):
    """A quantity along a range, None where it does not exist; the regimes, and where they change."""

    label: str
    xs: list[float]
    ys: list[float | None]
    regimes: list[str]
    changes: list[int]


class Picture(NamedTuple):
    """Curves, and what their axes say."""

    x: str
    y: str
    log: bool
    curves: list[Curve]


def check_drawable(sweep: Sweep, option: str, name: str) -> None:
    """Raises SceneError where the sweep and the quantity make no curves."""
    if name not in QUANTITIES:
        raise SceneError(option, name, "is not a number to draw; name another quantity")
    if min(len(range_.points) for range_ in sweep.ranges) > MAX_CURVES and sweep.ranges[1:]:
        rule = f"would be more than {MAX_CURVES} curves; give one of the ranges at most {MAX_CURVES} points"
        raise SceneError(option, name, rule)


def picture(sweep: Sweep, rows: Sequence[Row], option: str, name: str) -> Picture:
    """Curves of a quantity along the range of more points, one for each point of the other.

    Raises SceneError where numbers are too large to draw, ArithmeticError where there are none.
    """
    x = max(reversed(sweep.ranges), key=lambda range_: len(range_.points))
    parts: dict[str, list[Row]] = {}
    for row in rows:
        label = ", ".join(stated_point(other, point) for other, point in row.at.items() if other != x.name)
        parts.setdefault(label, []).append(row)
    xs = list(map(float, x.bare()))
    curves = [
        Curve(label, xs, [_drawn(row.values[name]) for row in part], regimes(part, x.name), _changes(part))
        for label, part in parts.items()
    ]
    values = [*xs, *(y for curve in curves for y in curve.ys if y is not None)]
    if len(values) == len(xs):
        why = "; ".join({row.reasons[name]: None for row in rows})
        raise ArithmeticError(f"{name} exists at no point, so there is nothing to draw: {why}")
    if max(map(abs, values)) > LARGEST_DRAWN or (x.log and min(xs) < 1 / LARGEST_DRAWN):
        rule = f"draws numbers between {1 / LARGEST_DRAWN} and {LARGEST_DRAWN} in magnitude only"
        raise SceneError(option, name, rule)
    about = QUANTITIES[name]
    return Picture(with_unit(x.name, x.unit), with_unit(name, about.unit), x.log, curves)


def regimes(rows: Sequence[Row], along: str) -> list[str]:
    """Each regime with the first and the last point at which it holds; it changes somewhere between two."""
    starts = [0, *_changes(rows)]
    ends = [*(i - 1 for i in starts[1:]), len(rows) - 1]
    if len(starts) == 1:
        return [rows[0].regime]
    parts = []
    for start, end in zip(starts, ends, strict=True):
        first, last = (stated_point(along, rows[i].at[along]) for i in (start, end))
        where = f"from {first} to {last}"
        if start == end:
            where = f"at {first}"
        elif not start:
            where = f"up to {last}"
        elif end == len(rows) - 1:
            where = f"from {first} on"
        parts.append(f"{rows[start].regime} {where}")
    return parts


def _changes(rows: Sequence[Row]) -> list[int]:
    return [i for i, (before, row) in enumerate(pairwise(rows), 1) if before.regime != row.regime]


def _drawn(value: Any) -> float | None:
    """A value as a coordinate, None where there is none; doubles overflow to none, too."""
    return None if value is None or is_infinite(value) else float(value)


def with_unit(name: str, unit: str) -> str:
    """A name as axes and columns have it."""
    return f"{name} ({unit})" if unit else name
