"""Ranges and lists in place of values: the points of a sweep, and the answers there.

A point is exactly the number that is printed, so that `solve` given that number prints the same row. Steps of
0.1 are 0.1. Points that are no decimals, or at equal ratios, are rounded to the digits of results, or to more
if neighbours would look alike; ends and the values of a list are not rounded.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from decimal import ROUND_HALF_EVEN, Decimal
from fractions import Fraction
from itertools import product
from math import inf, prod
from typing import NamedTuple

from ..explain.conditions import Condition, failures_of
from ..explain.given import inputs_with_effect, label
from ..numbers.digits import (
    DOUBLE_DIGITS,
    SHOWN_DIGITS,
    as_typed,
    exact_decimal,
    exact_or_rounded,
    format_number,
    to_digits,
)
from ..numbers.interval import decimal_context
from ..numbers.text import in_quotes
from ..reading.inputs import read_exactly, read_whole
from ..reading.units import MAX_DIGITS
from ..solver.answers import Answers
from ..solver.scene import COLUMNS, IN_SI, Input, Scene, SceneError, Unit, Units, parameter_of, with_unit

MAX_POINTS, MAX_RANGES = 1_000_000, 2
FORM = "start:stop:count, as 0:10:11, or 1:1000:4:log for equal ratios"
MORE_DIGITS = 20
"""The digits by which points at equal ratios are more precise before they are rounded."""
MOST_VALUES_SAID = 6
"""The most values of a list that a sentence writes out."""


class Point(NamedTuple):
    """A value of a range, exact and in its unit (inf is a locked pulley), and the name that stood for it."""

    value: Fraction | float
    name: str = ""


LOCKED = Point(inf)


def as_text(value: Fraction | Decimal | float) -> str:
    """Return a number as text; a decimal keeps its zeros."""
    return as_typed(value) if isinstance(value, Fraction) else format_number(value)


class Range(NamedTuple):
    """An input that is swept over a range or a list: as typed, its points, and their unit."""

    name: str
    typed: str
    points: list[Point]
    unit: Unit

    @property
    def is_list(self) -> bool:
        return "," in self.typed

    @property
    def label(self) -> str:
        """The name in sentences and titles: W1 for weights of m1."""
        return label(self.name, self.unit.terms)

    @property
    def log(self) -> bool:
        return self.typed.endswith("log")

    @property
    def words(self) -> str:
        """Return the range in a sentence: M from 0 to 50 kg, or M = 0 kg, 10 kg or inf."""
        if not self.is_list:
            start, stop = self.points[0], self.points[-1]
            return f"{self.label} from {self.cell(start)} to {self.in_units(stop.value)}"
        values = zip(self.points, (self.in_units(point.value) for point in self.points), strict=True)
        texts = [f"{point.name} ({value})" if point.name else value for point, value in values]
        first = texts[:-1] if len(texts) <= MOST_VALUES_SAID else [*texts[:2], "..."]
        return f"{self.label} = {', '.join(first)} or {texts[-1]}"

    @property
    def finite(self) -> list[Fraction]:
        """Return the finite values, in ascending order."""
        return sorted(x.value for x in self.points if isinstance(x.value, Fraction))

    @property
    def ends(self) -> tuple[Fraction, Fraction]:
        """Return the least and the greatest finite value."""
        finite = self.finite
        return finite[0], finite[-1]

    def at(self, value: Fraction | float, scene: Scene) -> Scene:
        """Return the scene at a value of the range."""
        return scene.with_number(self.name, value * self.unit.size)

    def text(self, value: Fraction | float) -> str:
        """Return a value as `solve` takes it without a unit that is typed."""
        is_usual = value == inf or not (self.unit.terms or self.unit.symbol == "rad")
        return f"{as_text(value * self.unit.size)}{'' if is_usual else _si_unit(self.name, self.unit)}"

    def printed(self, point: Point) -> Decimal | str:
        """Return a point for JSON and CSV, as text if it has a unit or is no decimal (1/3, inf)."""
        words = self.text(point.value)
        return Decimal(words) if re.fullmatch("[-0-9.e]+", words) else words

    def cell(self, point: Point) -> str:
        """Return a point as a table shows it, which has the unit in a head."""
        return point.name or as_text(point.value)

    def in_units(self, value: Fraction | Decimal | float) -> str:
        """Return a value with its unit."""
        return as_text(value) if value == inf else with_unit(as_text(value), self.unit.in_words)

    def in_words(self, point: Point) -> str:
        """Return a point in a sentence: M = 10 kg, or disk."""
        return point.name or f"{self.label} = {self.in_units(point.value)}"


class Sweep(NamedTuple):
    """Ranges, the first of which varies slowest, the scene at their first finite values, and other inputs.

    ``units`` are those of results, by name, that are asked for in another than their own.
    """

    ranges: list[Range]
    scene: Scene
    fixed: Mapping[str, Input]
    units: Units

    @property
    def total(self) -> int:
        return prod(len(range_.points) for range_ in self.ranges)

    @property
    def inputs(self) -> dict[str, str]:
        """Return the inputs, and the ranges, in words."""
        ranges = {range_.name: range_.words for range_ in self.ranges}
        return inputs_with_effect(Answers(self.scene, None, self.fixed), ranges)

    @property
    def along(self) -> Range:
        """Return the range along which curves run: if possible of numbers and no list, and the longest."""
        named = {range_.name: any(point.name for point in range_.points) for range_ in self.ranges}
        return max(self.ranges[::-1], key=lambda x: (not x.is_list, not named[x.name], len(x.finite)))

    @property
    def others(self) -> list[Range]:
        """Return the other range, if there is one."""
        return [range_ for range_ in self.ranges if range_ is not self.along]

    def scenes(self, ranges: Sequence[Range]) -> Iterator[tuple[Scene, dict[str, Point]]]:
        """Yield the scene at each point of some of the ranges, and that point."""
        for points in product(*(range_.points for range_ in ranges)):
            scene, place = self.scene, dict[str, Point]()
            for range_, point in zip(ranges, points, strict=True):
                place[range_.name], scene = point, range_.at(point.value, scene)
            yield scene, place

    def in_words(self, place: Mapping[str, Point]) -> str:
        """Return a place of a sweep in a sentence."""
        ranges = (range_ for range_ in self.ranges if range_.name in place)
        return ", ".join(range_.in_words(place[range_.name]) for range_ in ranges)


class Row(NamedTuple):
    """The regime, the values asked for, why some are missing, and what fails that is expected, at a point."""

    at: dict[str, Point]
    regime: str | None
    mu_assumed: bool
    values: dict[str, object]
    reasons: dict[str, str]
    failures: dict[str, str]


def read_sweep(given: Mapping[str, str | None], digits: int | None = None, units: Units = IN_SI) -> Sweep:
    """Read a sweep: values, with one or two ranges or lists, for so many digits. Raises SceneError."""
    typed = {name: words for name in COLUMNS if re.search("[:,]", words := given.get(name) or "")}
    # An input that is wrong at every point is an error before there are points.
    fixed = {name: read_exactly(name, given.get(name)) for name in COLUMNS if name not in typed}
    if not typed:
        rule = f"or another option of the scene must carry a list, as 0,1,10, or a range: {FORM}"
        raise SceneError("M", None, rule)
    names = list(typed)
    if len(names) > MAX_RANGES:
        third = names[MAX_RANGES]
        rule = f"is a third range or list, after {' and '.join(names[:2])}; give two"
        raise SceneError(third, typed[third], rule)
    ranges = [
        read_list(name, words) if "," in words else read_range(name, words, digits)
        for name, words in typed.items()
    ]
    # Whatever makes a scene invalid does so at a corner: each rule bounds one value, or one by another.
    corners = ([(x, value) for value in (*x.ends, max(x.points).value)] for x in ranges)
    scene, *_ = (scene_at(fixed, corner) for corner in product(*corners))
    if "g" in typed and (weights := [x for x, kind in scene.terms if kind.by == "g"]):
        rule = (
            f"cannot be swept beside {weights[0]}, a weight, whose mass would change; give {weights[0]} in kg"
        )
        raise SceneError("g", typed["g"], rule)
    fixed |= {x.name: Input(unit=x.unit) for x in ranges if x.unit.terms or x.unit.size != 1}
    sweep = Sweep(ranges, scene, fixed, units)
    if sweep.total > MAX_POINTS:
        rule = f"makes {sweep.total} points with {names[0]}; at most {MAX_POINTS} are taken"
        raise SceneError(names[1], typed[names[1]], rule)
    return sweep


def read_range(name: str, typed: str, digits: int | None = None) -> Range:
    """Read a range of an input, with points of about so many digits. Raises SceneError."""
    words = typed.split(":")
    if len(words) not in (3, 4) or words[3:] not in ([], ["log"]) or not all(words):
        raise SceneError(name, typed, f"is not a range; write {FORM}")
    ends = _read_points(name, typed, words[:2])
    if any(end == LOCKED or end.name for end in ends.points):
        raise SceneError(name, typed, "must run between finite numbers, not to or from inf or a name")
    start, stop = (Fraction(end.value) for end in ends.points)
    if start == stop:
        raise SceneError(name, typed, "has equal ends; a range runs from one value to another")
    if ends.log and not (start > 0 and stop > 0):
        raise SceneError(name, typed, "has no equal ratios from or to 0; both ends must be above 0")
    try:
        last = read_whole(name, words[2], 2, MAX_POINTS) - 1
    except SceneError as error:
        rule = f"has the count {in_quotes(words[2])}, which {error.rule}, as in 0:60:4 or 10g:1kg:5:log"
        raise SceneError(name, typed, rule) from None
    kept = _digits_kept(start, stop, last, ends.log, digits)
    if kept > MAX_DIGITS:
        rule = f"has points closer together than {MAX_DIGITS} digits can tell"
        raise SceneError(name, typed, f"{rule}; take fewer points, or ends further apart")
    round_ = to_digits(kept)
    first, *inner, end = steps(start, stop, last, ends.log, kept + MORE_DIGITS)
    points = [exact_or_rounded(first, round_), *map(round_, inner), exact_or_rounded(end, round_)]
    return ends._replace(points=[Point(Fraction(point)) for point in points])


def read_list(name: str, typed: str) -> Range:
    """Read a list of values of an input. Raises SceneError."""
    if re.search(r":|,0\d", typed) or (name not in ("M", "wrap") and re.fullmatch(r"0,\d+", typed)):
        rule = "may have a decimal comma; write a point, or a blank behind the comma of a list"
        raise SceneError(name, typed, rule)
    values = _read_points(name, typed, [word.strip() for word in typed.split(",")])
    if not values.finite:
        raise SceneError(name, typed, "has no finite value; give one")
    return values


def _read_points(name: str, typed: str, words: Sequence[str]) -> Range:
    """Read the numbers or names of a range or a list, as its points. Raises SceneError.

    They are in the unit that they all have, if that leaves them decimals in the SI.
    """
    read = [read_exactly(name, word) for word in words]
    numbers = [x.number for x in read]
    names = [word.lower() if word.lower() in parameter_of(name).names else "" for word in words]
    # A name is typed neither with a unit nor without, and 0 is 0 in any.
    typed_units = {x.unit for x, word in zip(read, names, strict=True) if not (word or x.number in (0, inf))}
    if any(unit.symbol == "rpm" for unit in typed_units):
        raise SceneError(name, typed, "is in rpm, which are no decimals in rad/s; sweep it in rad/s")
    # 100:500g is from 100 kg to half a kilogram: hardly what was meant.
    if len({(_si_unit(name, unit), not unit.symbol) for unit in typed_units}) > 1:
        raise SceneError(name, typed, "mixes units; write the same unit at each number")
    unit = next(iter(typed_units), Unit())
    is_decimal = None not in (exact_decimal(x) for x in (*numbers, unit.size) if x != inf)
    if typed_units != {unit} or unit.size == 1 or not is_decimal:
        unit = Unit(_si_unit(name, unit), terms=unit.terms)
    exact = (number if number == inf else Fraction(as_typed(number / unit.size)) for number in numbers)
    points = [Point(value, word) for value, word in zip(exact, names, strict=True)]
    return Range(name, typed, points, unit)


def _si_unit(name: str, unit: Unit) -> str:
    """Return the unit of the SI, or ° or rad, for numbers of an input in a unit."""
    if unit.terms:
        return unit.terms.unit
    return "rad" if unit.symbol == "rad" else parameter_of(name).unit


def _digits_kept(start: Fraction, stop: Fraction, last: int, log: bool, digits: int | None) -> int:
    """Return the significant digits of points: all if ends and steps are decimals, unless digits are wanted.

    Else as many as are wanted, but at least three more than neighbours have in common.
    """
    if log:  # neighbours differ by at least |ln ratio|/last of their size
        apart = min(abs(1 - start / stop), abs(1 - stop / start)) / last
    else:
        step = (stop - start) / last
        if not digits and None not in (exact_decimal(start), exact_decimal(step)):
            return MAX_DIGITS
        apart = abs(step) / max(abs(start), abs(stop))
    return max(digits or SHOWN_DIGITS, len(str(int(1 / apart))) + 3)


def steps(
    start: Fraction, stop: Fraction, count: int, log: bool, digits: int = DOUBLE_DIGITS
) -> Iterator[Fraction]:
    """Yield the ends of so many equal steps, or to so many digits those of equal ratios."""
    yield start
    for i in range(1, count):
        share = Fraction(i, count)
        yield start * power(stop / start, share, digits) if log else start + (stop - start) * share
    yield stop


def power(ratio: Fraction, share: Fraction, digits: int = DOUBLE_DIGITS) -> Fraction:
    """Return a ratio to a power between 0 and 1, to so many digits."""
    context = decimal_context(digits, ROUND_HALF_EVEN)
    number, exponent = (context.divide(Decimal(q.numerator), Decimal(q.denominator)) for q in (ratio, share))
    return Fraction(context.power(number, exponent))


def scene_at(fixed: Mapping[str, Input], place: Sequence[tuple[Range, Fraction | float]]) -> Scene:
    """Return the scene of fixed inputs and those at a point, read as by `solve`. Raises SceneError."""
    here = {range_.name: read_exactly(range_.name, range_.text(value)) for range_, value in place}
    try:
        return Scene.of({**fixed, **here}, may_lack=True)
    except SceneError as error:
        if error.parameter in here or error.value is None:
            raise
        where = ", ".join(range_.in_words(Point(value)) for range_, value in place)
        raise SceneError(error.parameter, error.value, f"{error.rule} (at {where})") from None


def solve_rows(
    sweep: Sweep, names: Sequence[str], digits: int | None, conditions: Sequence[Condition] = ()
) -> Iterator[Row]:
    """Yield the quantities named at every point, each point solved by itself.

    The critical pulley mass is the same on all pulleys, unless their shapes differ, as of a given I.
    """
    of_any_pulley = Answers(sweep.scene, digits, units=sweep.units)
    is_same = [range_.name for range_ in sweep.ranges] == ["M"] and sweep.scene.I is None
    for scene, place in sweep.scenes(sweep.ranges):
        answers = Answers(scene, digits, units=sweep.units)
        by_name = {
            name: (of_any_pulley if is_same and name == "critical_pulley_mass" else answers).answer(name)
            for name in names
        }
        reasons = {name: answer.reason for name, answer in by_name.items() if answer.reason}
        decided, values = answers.decided, {name: answer.value for name, answer in by_name.items()}
        failures = failures_of(answers.in_units(IN_SI), conditions)
        regime = None if decided.lacking else decided.regime
        yield Row(place, regime, decided.mu_assumed, values, reasons, failures)
