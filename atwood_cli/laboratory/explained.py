"""How the line of a fit follows from (1)-(3), with the numbers of its runs."""

from collections.abc import Iterator
from fractions import Fraction

from ..arithmetic.rounding import text, tidy, to_digits
from ..derivation.equations import Law, Part
from ..derivation.measured import FALLEN
from ..derivation.steps import Explanation, Step
from ..solver.answers import SHOWN_DIGITS
from .fitting import Fitted
from .headings import MEASURED
from .numbers import few, rows_of
from .results import points
from .sentences import head, notes


def explained(fit: Fitted) -> Explanation:
    """The derivation of the line, its results, and what was assumed."""
    return Explanation(
        head(fit),
        f"Numbers are rounded to {SHOWN_DIGITS} significant digits.",
        [
            Step("The equations of a run", EQUATIONS),
            Step("The runs as points", list(_points(fit))),
            Step("The line", list(_line(fit))),
            Step("What was assumed, and what else to know", [ASSUMED, *notes(fit)]),
        ],
        "Runs of Atwood's machine",
    )


ASSUMED = (
    "The string is taken to have no mass, not to stretch and not to slip, the friction of the axle to be the"
    " same in all runs, and what is given without an uncertainty to be exact."
)
EQUATIONS: list[Part] = [
    "`l` is the lighter mass and `h` the heavier, which descends with the acceleration `a`:",
    Law("(1)", "T_l - l g = l a"),
    Law("(1)", "h g - T_h = h a"),
    "The difference of the tensions turns the pulley, whose inertia counts as a mass `c = I/R^2` at its"
    " rim, against the friction of the axle, a force `f` there:",
    Law("(3)", "T_h - T_l = c a + f"),
    "The sum of both (1) gives that difference by what is measured:",
    Law("", "y = T_h - T_l = (h - l) g - a (h + l)"),
    "So `y` against `a` is a straight line, for whatever masses. Its slope is `c`, and where it meets the"
    " axis, at `a` = 0, it is `f`: what the weights must differ by before anything moves.",
]


def _points(fit: Fitted) -> Iterator[Part]:
    timed = fit.runs.kind == "time"
    if timed:
        yield FALLEN
        yield Law("", "a = 2 s/t^2")
    yield f"With `g` = {text(fit.estimate.values['gravity'])} m/s² the runs are"
    at, data = points(fit), fit.data
    for run, l, h, t, x, y in zip(fit.used, data.l, data.h, data.measured, at.x, at.y, strict=True):
        fall = f", `t = {_number(t)}` s" * timed
        masses = f"`l = {text(float(l))}` kg, `h = {text(float(h))}` kg"
        yield f"- {run.name}: {masses}{fall}: `a = {_number(x)}` m/s², `y = {_number(y)}` N"


def _line(fit: Fitted) -> Iterator[Part]:
    yield Law("", "y = c a + f")
    what = f"{MEASURED[fit.runs.kind]}s"
    yield (
        f"This line is the one by which the {what} are as close as can be to those measured: the sum of the"
        f" squares of what is left, each in its standard uncertainty, is the least. It is not that of `y`, as"
        f" {what} were measured and not `y`, which has their errors multiplied."
    )
    rows = rows_of(fit.results)
    for name, value, unit, symbol, ends in rows:
        words = "axle friction" if name == "axle" else name.replace("_", " ")
        within = f", 95 % interval `{ends}` {unit}" * bool(ends)
        yield f"- {words}: `{symbol[0]} = {value}` {unit}{within}"
    if rows:
        yield f"Uncertainties are standard ones; intervals have {few(fit.times, 3)} of them on either side."


def _number(value: float) -> str:
    return text(tidy(to_digits(SHOWN_DIGITS)(Fraction(float(value)))))
