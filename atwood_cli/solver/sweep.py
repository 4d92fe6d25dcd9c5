"""Ranges in place of values: the points of a sweep, and the answers there.

A point is the number that is printed, exactly, so that `solve` given that number prints the same row.
Linear ranges step in exact fractions from one end to the other: steps of 0.1 are 0.1. Points that are no
decimals (steps of a third), or at equal ratios, are rounded to as many digits as results are shown with, or
to more if it takes more to tell them apart well. Ends that are decimals are hit exactly.
"""

from collections.abc import Iterator, Mapping, Sequence
from decimal import ROUND_HALF_EVEN, Decimal
from fractions import Fraction
from itertools import product
from math import lcm
from typing import NamedTuple

from ..arithmetic.interval import decimal_context
from ..arithmetic.rounding import exact_decimal, exact_or_rounded, text, tidy, to_digits
from ..model.scene import INPUTS, Scene, SceneError, in_units, read_value, read_whole
from ..model.units import MAX_DIGITS, in_quotes, read_number
from .answers import DOUBLE_DIGITS, SHOWN_DIGITS, Answers

Point = Decimal | str
"""A value of a swept parameter as it is printed; text where it has a unit (an angle in radians, a torque)."""

UNUSUAL = {"rad": "rad", "N m": "Nm"}
"""The units that points carry, as there are others for the same parameter."""
MAX_POINTS, MAX_RANGES = 1_000_000, 2
FORM = "start:stop:count, as 0:10:11, or 1:1000:4:log for equal ratios"


class Range(NamedTuple):
    """A parameter that is swept: as typed, its points, and the unit that they carry, if any."""

    name: str
    typed: str
    points: list[Point]
    log: bool
    suffix: str

    @property
    def words(self) -> str:
        """What a sentence says of it: M from 0 to 50 kg."""
        start, stop = self.points[0], self.points[-1]
        return f"{self.name} from {text(self.bare(start))} to {point_in_units(self.name, stop)}"

    @property
    def unit(self) -> str:
        return self.suffix or INPUTS[self.name].unit

    @property
    def ends(self) -> tuple[Fraction, Fraction]:
        """The first and the last of its values, in its unit."""
        return Fraction(self.bare(self.points[0])), Fraction(self.bare(self.points[-1]))

    def steps(self, count: int) -> Iterator[Fraction]:
        """So many equal steps from one end to the other, about, or equal ratios; with both ends."""
        start, stop = self.ends
        yield start
        for i in range(1, count):
            share = Fraction(i, count)
            yield start * about_power(stop / start, share) if self.log else start + (stop - start) * share
        yield stop

    def point(self, number: Decimal) -> Point:
        """A number as a point of it."""
        return f"{text(number)}{self.suffix}" if self.suffix else number

    def bare(self, point: Point) -> Decimal:
        """A point without its unit."""
        return Decimal(str(point).removesuffix(self.suffix))


class Sweep(NamedTuple):
    """Ranges, the first of which varies slowest, what else was given, and the scene at the first point."""

    ranges: list[Range]
    given: Mapping[str, str | None]
    scene: Scene

    @property
    def total(self) -> int:
        return len(self.ranges[0].points) * (len(self.ranges[1].points) if self.ranges[1:] else 1)

    def along(self, along: Range) -> Iterator[tuple[Scene, dict[str, Point]]]:
        """The scene at each point of the other range, if there is one, and that point."""
        others = [range_ for range_ in self.ranges if range_ is not along]
        for points in product(*(range_.points for range_ in others)):
            at = dict(zip((range_.name for range_ in others), points, strict=True))
            yield scene_at(self.given, {along.name: along.points[0], **at}), at


class Row(NamedTuple):
    """The answers at a point."""

    at: dict[str, Point]
    regime: str
    values: dict[str, object]
    reasons: dict[str, str]


def read_sweep(given: Mapping[str, str | None], digits: int | None = None) -> Sweep:
    """The sweep given: values, of which one or two are ranges, for so many digits. Raises SceneError."""
    typed = {name: words for name in INPUTS if ":" in (words := given.get(name) or "")}
    if not typed:
        raise SceneError("M", None, f"or another option of the scene must carry a range: {FORM}")
    names = list(typed)
    if len(names) > MAX_RANGES:
        third = names[MAX_RANGES]
        raise SceneError(third, typed[third], f"is a third range, after {' and '.join(names[:2])}; give two")
    for name in INPUTS:
        if name not in typed:
            read_value(name, given.get(name))  # what is wrong everywhere is not the first point's fault
    ranges = [read_range(name, words, digits) for name, words in typed.items()]
    # Whatever makes a scene invalid does so at a corner: each rule bounds one value, or one by another.
    ends = [[range_.points[0], range_.points[-1]] for range_ in ranges]
    scene, *_ = (scene_at(given, dict(zip(names, corner, strict=True))) for corner in product(*ends))
    sweep = Sweep(ranges, given, scene)
    if sweep.total > MAX_POINTS:
        rule = f"makes {sweep.total} points with {names[0]}; at most {MAX_POINTS} are taken"
        raise SceneError(names[1], typed[names[1]], rule)
    return sweep


class _End(NamedTuple):
    """An end of a range, the unit that points carry for it, and whether it was typed with a unit."""

    value: Fraction
    suffix: str
    has_unit: bool


def read_range(name: str, typed: str, digits: int | None = None) -> Range:
    """A range of a parameter, its points to about so many digits. Raises SceneError."""
    words = typed.split(":")
    if len(words) not in (3, 4) or words[3:] not in ([], ["log"]) or not all(words):
        raise SceneError(name, typed, f"is no range; write {FORM}")
    one, other = (_read_end(name, typed, word) for word in words[:2])
    start, stop, log = one.value, other.value, len(words) == 4
    if one.has_unit != other.has_unit and start and stop:
        # 100:500g is from 100 kg to half a kilogram: hardly what was meant.
        raise SceneError(name, typed, "has a unit at one end only; write it at both")
    if one.suffix != other.suffix and start and stop:
        raise SceneError(name, typed, "has ends in units of two kinds; write both in the same unit")
    if start == stop:
        raise SceneError(name, typed, "has equal ends; a range runs from one value to another")
    if log and not (start > 0 and stop > 0):
        raise SceneError(name, typed, "has no equal ratios from or to 0; both ends must be above 0")
    try:
        last = read_whole(name, words[2], 2, MAX_POINTS) - 1
    except SceneError as error:
        raise SceneError(name, typed, f"has the count {in_quotes(words[2])}, which {error.rule}") from None
    kept = _digits_kept(start, stop, last, log, digits)
    if kept > MAX_DIGITS:
        rule = f"has points closer together than {MAX_DIGITS} digits can tell"
        raise SceneError(name, typed, f"{rule}; take fewer points, or ends further apart")
    ends = [tidy(exact_or_rounded(end, to_digits(kept))) for end in (start, stop)]
    points = [ends[0], *(_equal_ratios if log else _equal_steps)(start, stop, last, kept), ends[1]]
    suffix = one.suffix if start else other.suffix
    return Range(name, typed, [f"{text(x)}{suffix}" if suffix else x for x in points], log, suffix)


def _read_end(name: str, typed: str, word: str) -> _End:
    """An end of a range. Raises SceneError."""
    if word.strip().lower() in ("inf", *INPUTS[name].names):
        raise SceneError(name, typed, f"has the end {in_quotes(word)}; a range runs between finite numbers")
    value = read_value(name, word)
    has_unit = bool(read_number(word, INPUTS[name].dimension).unit)
    if name in ("wrap", "axle"):
        return _End(value.number, UNUSUAL.get(value.unit, ""), has_unit)
    return _End(value, "", has_unit)


def _digits_kept(start: Fraction, stop: Fraction, last: int, log: bool, digits: int | None) -> int:
    """The significant digits of points: all where ends and steps are decimals, unless fewer are wanted.

    Else as many as are wanted, but three more than it takes to tell neighbours apart.
    """
    if log:  # neighbours differ by at least |ln ratio|/last of their size
        apart = min(abs(1 - start / stop), abs(1 - stop / start)) / last
    else:
        step = (stop - start) / last
        if not digits and None not in (exact_decimal(start), exact_decimal(step)):
            return MAX_DIGITS
        apart = abs(step) / max(abs(start), abs(stop))
    return max(digits or SHOWN_DIGITS, len(str(int(1 / apart))) + 3)


def _equal_steps(start: Fraction, stop: Fraction, last: int, kept: int) -> Iterator[Decimal]:
    """The points between the ends, each of them from integers over one denominator, rounded once."""
    step = (stop - start) / last
    unit = lcm(start.denominator, step.denominator)
    context = decimal_context(kept, ROUND_HALF_EVEN)
    first, by, whole = int(start * unit), int(step * unit), Decimal(unit)
    for i in range(1, last):
        yield tidy(context.divide(Decimal(first + i * by), whole))


def _equal_ratios(start: Fraction, stop: Fraction, last: int, kept: int) -> Iterator[Decimal]:
    """The points between the ends, each the one before times the same factor, in 20 digits more."""
    context, finer = (decimal_context(n, ROUND_HALF_EVEN) for n in (kept, max(kept, DOUBLE_DIGITS) + 20))
    value, whole = (finer.divide(Decimal(q.numerator), Decimal(q.denominator)) for q in (start, stop / start))
    by = finer.exp(finer.divide(finer.ln(whole), Decimal(last)))
    for _ in range(1, last):  # a million factors cost half of the further digits
        value = finer.multiply(value, by)
        yield tidy(context.plus(value))


def about_power(ratio: Fraction, share: Fraction) -> Fraction:
    """A ratio to a power between 0 and 1, to a few digits."""
    context = decimal_context(DOUBLE_DIGITS, ROUND_HALF_EVEN)
    number, exponent = (context.divide(Decimal(q.numerator), Decimal(q.denominator)) for q in (ratio, share))
    return Fraction(context.power(number, exponent))


def point_text(point: Point) -> str:
    """A point as `solve` takes it."""
    return text(point) if isinstance(point, Decimal) else point


def point_in_units(name: str, point: Point) -> str:
    """A point with the unit of its parameter."""
    return in_units(name, text(point)) if isinstance(point, Decimal) else point


def stated_point(name: str, point: Point) -> str:
    """A point with the name and unit of its parameter, for a sentence."""
    return f"{name} = {point_in_units(name, point)}"


def scene_at(given: Mapping[str, str | None], at: Mapping[str, Point]) -> Scene:
    """The scene given, at a point. Raises SceneError."""
    here = {name: point_text(point) for name, point in at.items()}
    try:
        return Scene.read({**given, **here})
    except SceneError as error:
        if error.parameter in here or error.value is None:
            raise
        where = ", ".join(stated_point(name, point) for name, point in at.items())
        raise SceneError(error.parameter, error.value, f"{error.rule} (at {where})") from None


def solve_rows(sweep: Sweep, names: Sequence[str], digits: int | None) -> Iterator[Row]:
    """The quantities named at every point, each point solved by itself."""
    swept = [range_.name for range_ in sweep.ranges]
    for points in product(*(range_.points for range_ in sweep.ranges)):
        at = dict(zip(swept, points, strict=True))
        answers = Answers(scene_at(sweep.given, at), digits)
        values = {name: answers[name] for name in names}
        yield Row(at, answers.case.regime, values, answers.reasons)
