"""How the line of a fit follows from (1)-(3), with the numbers of its runs."""

from collections.abc import Iterator
from fractions import Fraction

from ..arithmetic.rounding import text, to_digits
from ..derivation.equations import Law, Part
from ..derivation.steps import Explanation, Step
from ..solver.answers import SHOWN_DIGITS
from .fitting import UNITS, WORDS, Fit, away
from .line import points
from .sentences import far, few, notes, shown, verdict


def explained(fit: Fit) -> Explanation:
    """The derivation of the line, and what became of it."""
    return Explanation(
        [verdict(fit)],
        f"Numbers are rounded to {SHOWN_DIGITS} significant digits.",
        [
            Step("The equations of a run", list(_equations())),
            Step("The runs as points", list(_points(fit))),
            Step("The line", list(_line(fit))),
            Step("What is needed", [*_needed(fit), *notes(fit)]),
        ],
    )


def _equations() -> Iterator[Part]:
    yield "`l` is the lighter mass and `h` the heavier, which descends with the acceleration `a`:"
    yield Law("(1)", "T_l - l g = l a")
    yield Law("(1)", "h g - T_h = h a")
    yield (
        "The difference of the tensions turns the pulley, whose inertia counts as a mass `c = I/R^2` at its"
        " rim, against the friction of the axle, a force `f` there:"
    )
    yield Law("(3)", "T_h - T_l = c a + f")
    yield "The sum of both (1) has that difference in it, and apart from it only what is measured:"
    yield Law("", "y = T_h - T_l = (h - l) g - a (h + l)")
    yield (
        "So `y` against `a` is a straight line, for whatever masses. Its slope is `c`, and where it meets the"
        " axis, at `a` = 0, it is `f`: what the weights must differ by before anything moves."
    )


def _points(fit: Fit) -> Iterator[Part]:
    if fit.runs.kind == "time":
        yield "A height `s` fallen from rest in the time `t` tells the acceleration:"
        yield Law("", "a = 2 s/t^2")
    g = fit.estimate.values["gravity"]
    yield f"With `g` = {text(g)} m/s² the runs are"
    at = points(fit)
    for run, x, y in zip(fit.used, at.x, at.y, strict=True):
        yield f"- {run.name}: `a` = {_number(x)} m/s², `y` = {_number(y)} N"


def _line(fit: Fit) -> Iterator[Part]:
    c, f = fit.estimate.values["rim_mass"], fit.estimate.values["axle"]
    yield Law("", f"y = c a + f, c = {_number(c)} kg, f = {_number(f)} N")
    what = {"a": "accelerations", "time": "times"}[fit.runs.kind]
    yield (
        f"This line is the one by which the {what} are as close as can be to those measured: the sum of the"
        f" squares of what is left, each in its standard uncertainty, is the least. It is not that of `y`, as"
        f" {what} were measured and not `y`, which has their errors multiplied."
    )


def _needed(fit: Fit) -> Iterator[Part]:
    if fit.asked:
        yield "What to fit was said (--find), so nothing was left out."
        return
    for one in fit.dropped:
        yield (
            f"- {WORDS[one.name]}: {shown(one.value, one.uncertainty)} {UNITS[one.name]},"
            f" {far(away(one.value, one.uncertainty))} standard uncertainties from 0: left out"
        )
    for name, value in fit.values.items():
        yield (
            f"- {WORDS[name]}: {shown(value, fit.uncertainty(name))} {UNITS[name]}, {far(fit.away(name))}"
            f" standard uncertainties from 0; chance stays within {few(fit.times, 3)} in 95 % of all cases:"
            " needed"
        )


def _number(value: float) -> str:
    return text(to_digits(SHOWN_DIGITS)(Fraction(float(value))))
