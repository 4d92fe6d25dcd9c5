"""Standard uncertainties: from those of the inputs to those of the quantities, to first order.

For inputs x that are known to u(x), independently of each other, u(q)² = Σ (∂q/∂x · u(x))²; this is
(10) in 5.1.2 of the GUM (JCGM 100:2008). No formula is differentiated for it. A slope is a difference
quotient between the scene as given and scenes one step to either side, solved to as many digits as
the steps are short: with steps of about 10^-40 and 110 digits it is right to some 20 digits. Steps are
shorter, and digits more, by as many powers of ten as the scales of the scene are apart: an input that
is 10^-200 of the others moves a quantity by so much less.

Two checks stand in for trust in that. The slopes to the left and to the right must agree to 10 digits,
so that the error of their mean, of second order in the step, is in the 20th; where they do not, the
step reaches over a bend, and is shortened, and where they shrink with it to the end, the slope is 0.
And what the rounding of the values is worth in a slope must be below its 20th digit; where it is not,
because much cancels, digits are added. A slope of 0 is otherwise only believed of values that agree in
all their digits, more than twice as many as the step has powers of ten.

There is one place where no step is short enough: at equal masses the friction needed, which goes with
|m2 - m1|, has a kink, so no slope and no uncertainty. Any other bend (from grip to slip) lies beside the
scene, never on it. An input of 0, which must not be negative, has a right side only; the slope there is
extrapolated from two steps.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from decimal import ROUND_HALF_EVEN, Decimal
from fractions import Fraction
from functools import cache
from math import inf
from typing import Any, NamedTuple

from ..arithmetic.interval import ZERO, decimal_context
from ..arithmetic.rounding import is_infinite, to_place, with_uncertainty
from ..model.case import Case
from ..model.machine import Undetermined
from ..model.scene import Motion, Scene
from .answers import Answers, Spread, Uncertainties

SURE = 20
"""Digits to which a slope is right."""
STEPS = (40, 80, 160, 320, 640)
"""How many powers of ten a step is below the input, where all in the scene is of the same scale."""
COVERAGE = 2
"""How many standard uncertainties from the line between two cases leave the case in doubt."""

AT = decimal_context(3 * SURE, ROUND_HALF_EVEN)
KINK = "unknown where the masses are equal, as there it has a kink"

Uncertain = Mapping[str, Fraction]
"""Standard uncertainties of inputs, in SI units, as they are in the scene."""


class Slope(NamedTuple):
    """A derivative, None at a kink, and the steeper of the slopes to both sides."""

    value: Decimal | None
    steepest: Decimal


def propagate(case: Case, uncertain: Uncertain) -> Uncertainties:
    """The uncertainties of a scene's quantities, each found when asked for."""
    slope = _slopes(case, uncertain)

    def spread(name: str) -> Spread:
        parts = {}
        try:
            for x, u in uncertain.items():
                derivative = slope(name, x).value
                if derivative is None:
                    return Spread(None, reason=KINK)
                parts[x] = AT.multiply(derivative, decimal(u))
        except Undetermined as reason:
            return Spread(None, reason=str(reason))
        total = root_sum_of_squares(parts.values())
        shares = {x: AT.power(AT.divide(part, total), 2) for x, part in parts.items()} if total else {}
        return Spread(total or ZERO, shares)

    return Uncertainties(uncertain, spread, lambda: doubts(case, uncertain))


def doubts(case: Case, uncertain: Uncertain) -> list[str]:
    """Sentences on what may be otherwise: which mass is heavier, whether the string slips."""
    scene, known = case.scene, case.pulley_known
    spread = {x: decimal(u) for x, u in uncertain.items()}
    masses = [spread[x] for x in ("m1", "m2") if x in spread]
    sentences = [_doubt("Which mass is heavier", "m2 - m1", decimal(scene.m2 - scene.m1), masses, " kg")]
    if scene.mu is not None:
        holding = scene._replace(mu=None, mu_k=None, M=scene.M if known else inf)
        slope = _slopes(Case(holding, case.motion), uncertain)
        parts = [
            spread[x] if x == "mu" else AT.multiply(slope("mu_verge", x).steepest, spread[x])
            for x in spread
            if x != "mu_k"
        ]
        margin = AT.subtract(decimal(scene.mu), Answers(holding, AT.prec)["mu_verge"])
        what = "Whether the string slips" if known else "Whether any pulley can make the string slip"
        name = f"mu - mu_verge{'' if known else ' of a locked pulley'}"
        sentences.append(_doubt(what, name, margin, parts))
    return [sentence for sentence in sentences if sentence]


def _doubt(what: str, name: str, value: Decimal, parts: Sequence[Decimal], unit: str = "") -> str:
    """The sentence that what the sign of a value decides is in doubt; empty if it is not."""
    u = root_sum_of_squares(parts)
    if not u or abs(value) > COVERAGE * u:
        return ""
    shown = with_uncertainty(lambda place: to_place(place)(value), u)
    return (
        f"{what} is in doubt: {name} = {shown}{unit} is within {COVERAGE} standard uncertainties of 0"
        " (95 % of a normal distribution). The results are for the inputs as given."
    )


def root_sum_of_squares(parts: Iterable[Decimal]) -> Decimal:
    total = ZERO
    for part in parts:
        total = AT.add(total, AT.multiply(part, part))
    return AT.sqrt(total)


def decimal(q: Fraction) -> Decimal:
    return AT.divide(Decimal(q.numerator), Decimal(q.denominator))


def _slopes(case: Case, uncertain: Uncertain) -> Callable[[str, str], Slope]:
    """The slope of a quantity with an input, by their names; it raises Undetermined."""
    scene, motion = case.scene, case.motion
    closeness, span = _apart(case)

    def given(x: str) -> Fraction:
        value = getattr(scene if x in Scene._fields else motion, x)
        number: Fraction = value.number if x == "wrap" else value
        return number

    @cache
    def answers(x: str, offset: Fraction, digits: int) -> Answers:
        of_scene = x in Scene._fields
        moved: dict[str, Any] = {x: getattr(scene if of_scene else motion, x) + offset}
        if of_scene:
            return answers_of(scene._replace(**moved), motion, digits)
        return answers_of(scene, motion._replace(**moved), digits)

    def at(name: str, x: str, offset: Fraction, digits: int) -> Decimal:
        moved = answers(x, offset, digits)
        value = moved[name]
        if value is None or is_infinite(value):
            beside = f"unknown, as with another {x} it may have no value: " if offset else ""
            raise Undetermined(beside and beside + moved.reasons[name])
        assert isinstance(value, Decimal)
        return value

    def sides(name: str, x: str, exponent: int, digits: int) -> tuple[Decimal, Decimal]:
        """The slopes over the steps of 10^exponent to the right and to the left, or the next right one."""
        value, h = given(x), Fraction(10) ** exponent
        while True:
            here, right, other = (at(name, x, n * h, digits) for n in (0, 1, -1 if value else 2))
            exactly = decimal_context(2 * digits, ROUND_HALF_EVEN)
            rises = (
                exactly.subtract(right, here),
                exactly.subtract(here, other) if value else exactly.subtract(other, right),
            )
            if not any(rises):
                return ZERO, ZERO
            noise = max(q.adjusted() for q in (here, right, other) if q) - digits + 1
            lacking = noise + SURE - max(abs(rise) for rise in rises).adjusted()
            if lacking <= 0:
                first, second = (AT.scaleb(rise, -exponent) for rise in rises)
                return first, second
            digits += lacking

    def slope(name: str, x: str) -> Slope:
        value, before = given(x), Decimal(inf)
        scale = decimal(value or uncertain[x]).adjusted()
        for step in (closeness + number for number in STEPS):
            first, second = sides(name, x, scale - step, 2 * step + span + 30)
            apart, steepest = AT.subtract(first, second), max(abs(first), abs(second))
            if not apart or apart.adjusted() <= steepest.adjusted() - SURE // 2:
                # The mean; at the end of the domain, as much before the first as they are apart, halved.
                half = AT.divide(apart, Decimal(2))
                return Slope(AT.subtract(first, half) if value else AT.add(first, half), steepest)
            shrinks = steepest < AT.scaleb(before, -SURE)
            if scene.m1 == scene.m2 and not shrinks:
                return Slope(None, steepest)
            before = steepest
        if shrinks:
            return Slope(ZERO, ZERO)
        raise Undetermined("unknown, as its slope did not settle")

    return slope


def answers_of(scene: Scene, motion: Motion, digits: int) -> Answers:
    """The answers to a scene in which what follows from the motion is still to be found."""
    if motion.finds is not None:
        from ..model.motion import completed

        scene = completed(scene, motion)
    return Answers(scene, digits, motion)


def _apart(case: Case) -> tuple[int, int]:
    """How many powers of ten a bend may be nearer than all else in the scene, and scales are apart in all."""
    scene, total = case.scene, case.scene.m1 + case.scene.m2
    near = [(scene.m2 - scene.m1) / total, scene.mu]
    other = [scene.m1 / total, scene.m2 / total, (case.rim_mass or 0) / total, scene.wrap.number]
    closeness, span = (
        sum(abs(decimal(Fraction(q)).adjusted()) for q in ratios if q) for ratios in (near, near + other)
    )
    return closeness, span
