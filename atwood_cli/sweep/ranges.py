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
from operator import attrgetter
from typing import Any, NamedTuple

from ..explain.conditions import Condition, failures_of
from ..numbers.digits import (
    DOUBLE_DIGITS,
    SHOWN_DIGITS,
    as_typed,
    exact_decimal,
    exact_or_rounded,
    format_number,
    strip_zeros,
    to_digits,
)
from ..numbers.interval import decimal_context
from ..numbers.text import in_quotes
from ..output.text import inputs_with_effect
from ..reading.inputs import read_exactly, read_value, read_whole
from ..reading.units import MAX_DIGITS, read_number
from ..solver.answers import Answers
from ..solver.scene import INPUTS, Input, Scene, SceneError, with_unit

MAX_POINTS, MAX_RANGES = 1_000_000, 2
FORM = "start:stop:count, as 0:10:11, or 1:1000:4:log for equal ratios"
MORE_DIGITS = 20
"""The digits by which points at equal ratios are more precise before they are rounded."""
MOST_VALUES_SAID = 6
"""The most values of a list that a sentence writes out."""


class Point(NamedTuple):
    """A value of a swept parameter, exactly (inf is a locked pulley), as it is printed, and as it was named.

    It is printed as text if it has a unit (an angle in radians, a torque) or is no decimal (1/3, inf).
    """

    exact: Fraction | float
    printed: Decimal | str
    name: str = ""

    @property
    def text(self) -> str:
        """Return the point as `solve` takes it."""
        return self.printed if isinstance(self.printed, str) else format_number(self.printed)


LOCKED = Point(inf, "inf")


def exact_point(value: Fraction | float, suffix: str, name: str = "") -> Point:
    """Return a number as a point: a decimal if it is one, else text."""
    if isinstance(value, float):
        return LOCKED
    number, words = exact_decimal(value), as_typed(value)
    if suffix or number is None:
        return Point(Fraction(words), f"{words}{suffix}", name)
    return Point(value, strip_zeros(number), name)


def decimal_point(value: Decimal, suffix: str) -> Point:
    """Return a decimal as a point."""
    return Point(Fraction(value), f"{format_number(value)}{suffix}" if suffix else value)


class Range(NamedTuple):
    """An input that is swept over a range or a list: as typed, its points, the unit that they carry."""

    name: str
    typed: str
    points: list[Point]
    log: bool
    suffix: str

    @property
    def is_list(self) -> bool:
        return "," in self.typed

    @property
    def words(self) -> str:
        """Return the range in a sentence: M from 0 to 50 kg, or M = 0 kg, 10 kg or inf."""
        if not self.is_list:
            start, stop = self.points[0], self.points[-1]
            return f"{self.name} from {self.cell(start)} to {self.in_units(stop)}"
        values = zip(self.points, map(self.in_units, self.points), strict=True)
        texts = [f"{point.name} ({value})" if point.name else value for point, value in values]
        first = texts[:-1] if len(texts) <= MOST_VALUES_SAID else [*texts[:2], "..."]
        return f"{self.name} = {', '.join(first)} or {texts[-1]}"

    @property
    def unit(self) -> str:
        return self.suffix or INPUTS[self.name].unit

    @property
    def finite(self) -> list[Point]:
        """Return the finite points, in ascending order."""
        return sorted((point for point in self.points if point != LOCKED), key=attrgetter("exact"))

    @property
    def ends(self) -> tuple[Fraction, Fraction]:
        """Return the least and the greatest finite value, in the unit of the range."""
        points = self.finite
        return Fraction(points[0].exact), Fraction(points[-1].exact)

    def cell(self, point: Point) -> str:
        """Return a point as a table shows it, which has the unit in a head."""
        return point.name or point.text.removesuffix(self.suffix)

    def in_units(self, point: Point) -> str:
        """Return a point with its unit."""
        bare = self.suffix or point == LOCKED
        return point.text if bare else with_unit(point.text, INPUTS[self.name].unit)

    def in_words(self, point: Point) -> str:
        """Return a point in a sentence: M = 10 kg, or disk."""
        return point.name or f"{self.name} = {self.in_units(point)}"


class Sweep(NamedTuple):
    """Ranges, the first of which varies slowest, and the scene at their first finite values."""

    ranges: list[Range]
    scene: Scene

    @property
    def total(self) -> int:
        return prod(len(range_.points) for range_ in self.ranges)

    @property
    def inputs(self) -> dict[str, str]:
        """Return the inputs, and the ranges, in words."""
        ranges = {range_.name: range_.words for range_ in self.ranges}
        return inputs_with_effect(self.scene, ranges=ranges)

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
                place[range_.name], scene = point, scene.with_number(range_.name, point.exact)
            yield scene, place

    def in_words(self, place: Mapping[str, Point]) -> str:
        """Return a place of a sweep in a sentence."""
        ranges = (range_ for range_ in self.ranges if range_.name in place)
        return ", ".join(range_.in_words(place[range_.name]) for range_ in ranges)


class Row(NamedTuple):
    """The regime, the values asked for, why some are missing, and what fails that is expected, at a point."""

    at: dict[str, Point]
    regime: str
    mu_assumed: bool
    values: dict[str, object]
    reasons: dict[str, str]
    failures: dict[str, str]


def read_sweep(given: Mapping[str, str | None], digits: int | None = None) -> Sweep:
    """Read a sweep: values, with one or two ranges or lists, for so many digits. Raises SceneError."""
    typed = {name: words for name in INPUTS if re.search("[:,]", words := given.get(name) or "")}
    # An input that is wrong at every point is an error before there are points.
    fixed = {name: read_exactly(name, given.get(name)) for name in INPUTS if name not in typed}
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
    corners = ([x.finite[0], x.finite[-1], max(x.points, key=attrgetter("exact"))] for x in ranges)
    scene, *_ = (scene_at(fixed, ranges, corner) for corner in product(*corners))
    if "g" in typed and (weights := [x for x, given in scene.terms if given.terms.by == "g"]):
        rule = (
            f"cannot be swept beside {weights[0]}, a weight, whose mass would change; give {weights[0]} in kg"
        )
        raise SceneError("g", typed["g"], rule)
    sweep = Sweep(ranges, scene)
    if sweep.total > MAX_POINTS:
        rule = f"makes {sweep.total} points with {names[0]}; at most {MAX_POINTS} are taken"
        raise SceneError(names[1], typed[names[1]], rule)
    return sweep


def read_range(name: str, typed: str, digits: int | None = None) -> Range:
    """Read a range of an input, with points of about so many digits. Raises SceneError."""
    words = typed.split(":")
    if len(words) not in (3, 4) or words[3:] not in ([], ["log"]) or not all(words):
        raise SceneError(name, typed, f"is not a range; write {FORM}")
    if any(word.strip().lower() in (LOCKED.text, *INPUTS[name].names) for word in words[:2]):
        raise SceneError(name, typed, "must run between finite numbers, not to or from inf or a name")
    (start, stop), suffix = _read_numbers(name, typed, words[:2])
    log = len(words) == 4
    if start == stop:
        raise SceneError(name, typed, "has equal ends; a range runs from one value to another")
    if log and not (start > 0 and stop > 0):
        raise SceneError(name, typed, "has no equal ratios from or to 0; both ends must be above 0")
    try:
        last = read_whole(name, words[2], 2, MAX_POINTS) - 1
    except SceneError as error:
        rule = f"has the count {in_quotes(words[2])}, which {error.rule}, as in 0:60:4 or 10g:1kg:5:log"
        raise SceneError(name, typed, rule) from None
    kept = _digits_kept(start, stop, last, log, digits)
    if kept > MAX_DIGITS:
        rule = f"has points closer together than {MAX_DIGITS} digits can tell"
        raise SceneError(name, typed, f"{rule}; take fewer points, or ends further apart")
    round_ = to_digits(kept)
    first, *inner, end = steps(start, stop, last, log, kept + MORE_DIGITS)
    points = [exact_or_rounded(first, round_), *map(round_, inner), exact_or_rounded(end, round_)]
    return Range(name, typed, [decimal_point(strip_zeros(x), suffix) for x in points], log, suffix)


def read_list(name: str, typed: str) -> Range:
    """Read a list of values of an input. Raises SceneError."""
    words = [word.strip() for word in typed.split(",")]
    if ":" in typed:
        raise SceneError(
            name, typed, "has a comma in a range; numbers take a point, and a list takes no colon"
        )
    if name not in ("M", "wrap") and re.fullmatch(r"0,\d+", typed.strip()):
        decimal, spaced = typed.strip().replace(",", "."), ", ".join(words)
        raise SceneError(name, typed, f"can mean {decimal} or a list; write {decimal}, or '{spaced}'")
    if odd := [word for word in words[1:] if re.match(r"0\d", word)]:
        rule = "numbers take no comma, and values of a list no 0 before them"
        raise SceneError(name, typed, f"has {in_quotes(odd[0])} in it; {rule}")
    values, suffix = _read_numbers(name, typed, words)
    if min(values) == inf:
        raise SceneError(name, typed, "has no finite value; give one")
    named = [word.lower() if word.lower() in INPUTS[name].names else "" for word in words]
    points = [exact_point(value, suffix, word) for value, word in zip(values, named, strict=True)]
    return Range(name, typed, points, False, suffix)


def _read_numbers(name: str, typed: str, words: Sequence[str]) -> tuple[list[Any], str]:
    """Read the numbers of a range or a list, and the unit that their points carry. Raises SceneError."""
    values = [read_value(name, word) for word in words]
    numbers = [getattr(value, "number", value) for value in values]
    named = (LOCKED.text, *INPUTS[name].names)
    # A name is typed neither with a unit nor without, and 0 is 0 in any.
    plain = [i for i, word in enumerate(words) if numbers[i] and word.strip().lower() not in named]
    if len({bool(read_number(words[i], INPUTS[name].dimensions or None).unit) for i in plain}) > 1:
        # 100:500g is from 100 kg to half a kilogram: hardly what was meant.
        raise SceneError(name, typed, "has a unit at some numbers only; write it at each")
    suffixes = {getattr(values[i], "unit", "").replace("°", "") for i in plain}  # "" is the usual unit
    if len(suffixes) > 1:
        raise SceneError(name, typed, "has units of two kinds; write all numbers in the same unit")
    return numbers, next(iter(suffixes), "")


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


def scene_at(fixed: Mapping[str, Input], ranges: Sequence[Range], points: Sequence[Point]) -> Scene:
    """Return the scene of fixed inputs and those at a point, read as by `solve`. Raises SceneError."""
    place = list(zip(ranges, points, strict=True))
    here = {range_.name: read_exactly(range_.name, point.text) for range_, point in place}
    try:
        return Scene.of({**fixed, **here})
    except SceneError as error:
        if error.parameter in here or error.value is None:
            raise
        where = ", ".join(f"{range_.name} = {range_.in_units(point)}" for range_, point in place)
        raise SceneError(error.parameter, error.value, f"{error.rule} (at {where})") from None


def solve_rows(
    sweep: Sweep, names: Sequence[str], digits: int | None, conditions: Sequence[Condition] = ()
) -> Iterator[Row]:
    """Yield the quantities named at every point, each point solved by itself.

    The critical pulley mass is the same on all pulleys, unless their shapes differ, as of a given I.
    """
    of_any_pulley = Answers(sweep.scene, digits)
    is_same = [range_.name for range_ in sweep.ranges] == ["M"] and sweep.scene.I is None
    for scene, place in sweep.scenes(sweep.ranges):
        answers = Answers(scene, digits)
        by_name = {
            name: (of_any_pulley if is_same and name == "critical_pulley_mass" else answers).answer(name)
            for name in names
        }
        reasons = {name: answer.reason for name, answer in by_name.items() if answer.reason}
        decided, values = answers.decided, {name: answer.value for name, answer in by_name.items()}
        failures = failures_of(answers, conditions)
        yield Row(place, decided.regime, decided.mu_assumed, values, reasons, failures)
