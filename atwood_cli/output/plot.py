"""Curves in the terminal: plotille (extra ``plot``) sets the dots, the axes are drawn here."""

import sys
from collections.abc import Callable, Sequence
from decimal import Decimal
from fractions import Fraction
from itertools import chain, pairwise
from math import ceil, floor, log10
from typing import TYPE_CHECKING, Any

from plotille import Canvas

from ..arithmetic.rounding import as_typed
from .curves import EMPTY_X, EMPTY_Y, Curve, Panel, Picture, axis_ends, with_break
from .page import Page
from .text import for_stream, takes_unicode

if TYPE_CHECKING:
    from ..laboratory.fitting import Fitted

PIPE_WIDTH, HEIGHT = 80, 20
LEAST_WIDTH, LEAST_HEIGHT = 10, 5
LEAST_TICKS = 3  # asking for fewer may give none
LONGEST_POWER = 4  # of ten, written out
AROUND = 4  # lines above and below the curves on one pair of axes
COLOURS = ("cyan", "magenta", "green", "blue", "red", "bright_cyan")
MARK = "yellow"
LETTERS = "abcdefgh"
EMPTY, *DOTS = map(chr, range(0x2800, 0x2900))  # characters of braille, of which a plot is made
NOT_UNICODE = str.maketrans(dict(zip("┤│└┬─", "||++-", strict=True)) | dict.fromkeys(DOTS, "*"))


class Axis:
    """Where numbers lie on an axis of so many ``dots``, and its ticks and title."""

    def __init__(
        self, title: str, ends: tuple[float, float], dots: int, ticks: int, log: bool = False
    ) -> None:
        self.dots, self.log = dots, log
        low, high = ends
        self.title = title if log else with_break(title, low, high)
        if self._place(low) == self._place(high):
            low, high = low - (abs(low) or 1) / 2, high + (abs(high) or 1) / 2
        self.low, self.high = self._place(low), self._place(high)
        self.ticks = _decades(low, high, ticks) if log else _steps(Decimal(low), Decimal(high), ticks)

    def _place(self, value: float) -> float:
        return log10(value) if self.log else value

    def dot(self, value: float) -> int:
        return round((self._place(value) - self.low) / (self.high - self.low) * (self.dots - 1))


def _steps(low: Decimal, high: Decimal, most: int) -> list[Decimal]:
    """Round numbers between two, about as many as ``most``."""
    span = high - low
    power = Decimal(1).scaleb((span / most).adjusted())
    step = next(power * m for m in (1, 2, 5, 10) if span <= power * m * most)
    return [step * k for k in range(ceil(low / step), floor(high / step) + 1)]


def _decades(low: float, high: float, most: int) -> list[Decimal]:
    """Powers of ten between two numbers; the two where there are fewer."""
    powers = range(ceil(log10(low)), floor(log10(high)) + 1)
    if len(powers) < 2:
        return [Decimal(repr(low)), Decimal(repr(high))]
    return [Decimal(1).scaleb(power) for power in powers[:: ceil(len(powers) / most)]]


def print_plot(page: Page, head: str, drawn: Picture) -> None:
    """The panels below their head, with dotted lines where regimes change; then the regimes and the notes."""
    legends = [_lettered([curve.label for curve in one.curves] * bool(one.names[1:])) for one in drawn.panels]
    said = [f"{which or 'Regimes'}: {words}{'.' * (not which)}" for which, words in drawn.regimes]
    if said[1:] and not any(legends):
        said = _lettered(said)
    said += drawn.notes
    height = HEIGHT
    if page.room:
        beside = 1 + len(page.lines(head, *chain(*legends), *said))  # with the prompt
        height = (page.console.height - beside) // len(drawn.panels) - AROUND
    page.say(head)
    for panel, legend in zip(drawn.panels, legends, strict=True):
        _print_panel(page, drawn, panel, max(LEAST_HEIGHT, min(height, HEIGHT)))
        page.say(*legend)
    page.say(*said)


def _lettered(names: Sequence[str]) -> list[str]:
    """What curves are called, each after its letter."""
    return [f"{letter}: {name}" for letter, name in zip(LETTERS, names, strict=False)]


def _print_panel(page: Page, drawn: Picture, panel: Panel, height: int) -> None:
    """The curves on one pair of axes."""
    several = len(panel.curves) > 1

    def draw(canvas: Any, x_axis: Axis, y_axis: Axis) -> None:
        for curve in panel.curves:
            for x, y, _ in curve.marks:
                top = y_axis.dot(y) if several and y is not None else y_axis.dots
                for dot in range(0, top, 3):
                    canvas.point(x_axis.dot(x), dot, color=MARK)
        for number, curve in enumerate(panel.curves):
            _draw_curve(canvas, curve, x_axis, y_axis, LETTERS[number] if several else "")

    _print_axes(page, (drawn.x, panel.y), (drawn.xs, panel.ys), height, draw, drawn.log)


def print_fit_plot(page: Page, head: Sequence[str], fit: "Fitted") -> None:
    """Runs as points, and their line; then what it is."""
    from ..laboratory.results import points
    from ..laboratory.sentences import coefficients

    at = points(fit)
    end = 1.06 * float(max(at.x))
    ends = [(0.0, at.intercept), (end, at.intercept + at.slope * end)]

    def draw(canvas: Any, x_axis: Axis, y_axis: Axis) -> None:
        start, stop = ((x_axis.dot(x), y_axis.dot(y)) for x, y in ends)
        canvas.line(*start, *stop, color=COLOURS[0])
        for run, x, y in zip(fit.used, at.x, at.y, strict=True):
            canvas.point(x_axis.dot(float(x)), y_axis.dot(float(y)), marker=str(run.rows[0])[-1], color=MARK)

    values = [x for x, _ in ends], [y for _, y in ends]
    xs, ys = (list(map(float, [*one, *other])) for one, other in zip(values, (at.x, at.y), strict=True))
    page.say(head[0])
    page.say(*head[1:], style="bold")
    titles = ("a (m/s²)", "T_h - T_l (N)")
    _print_axes(page, titles, (xs, [0.0, *ys]), HEIGHT, draw)
    page.say(*(f"{words.replace('$', '')}." for words in coefficients(fit)))
    page.say("Points are the last digits of their rows.")


def _print_axes(
    page: Page,
    titles: tuple[str, str],
    values: tuple[list[float], list[float]],
    height: int,
    draw: Callable[[Any, Axis, Axis], None],
    log: bool = False,
) -> None:
    """Print axes over the values in x and y, and what is drawn on them; ``log`` is of the x axis."""
    from rich.text import Text

    y_axis = Axis(titles[1], axis_ends(values[1], EMPTY_Y), 4 * height, max(height // 4, LEAST_TICKS))
    labels = {y_axis.dot(float(tick)) // 4: _label(tick) for tick in y_axis.ticks}
    margin = max(map(len, labels.values()), default=0)
    width = max((page.room or PIPE_WIDTH) - margin - 3, LEAST_WIDTH)
    x_ends = axis_ends(values[0], 0 if log else EMPTY_X)
    x_axis = Axis(titles[0], x_ends, 2 * width, max(width // 12, LEAST_TICKS), log)
    canvas = Canvas(width, height, 0, 0, 2 * width, 4 * height)
    draw(canvas, x_axis, y_axis)
    rows = canvas.plot("\n").split("\n")
    left = [f" {labels.get(i, ''):>{margin}} {'┤' if i in labels else '│'}" for i in range(height)]
    ticks = {x_axis.dot(float(tick)) // 2: _label(tick) for tick in x_axis.ticks}
    bottom = "".join("┬" if i in ticks else "─" for i in range(width))
    for line in (
        f" {y_axis.title}",
        *(start + row for start, row in zip(reversed(left), rows, strict=True)),
        f" {'':>{margin}} └{bottom}",
        f" {'':>{margin}}  {_under(ticks, width)}",
        f" {'':>{margin}}  {x_axis.title:>{width}}",
    ):
        shown = line.replace(EMPTY, " ").rstrip()
        if not takes_unicode(sys.stdout):
            shown = for_stream(shown.translate(NOT_UNICODE), sys.stdout)
        page.console.print(Text.from_ansi(shown), soft_wrap=True)


def _draw_curve(canvas: Any, curve: Curve, x_axis: Axis, y_axis: Axis, letter: str) -> None:
    colour = COLOURS[curve.colour]
    for line in curve.lines:
        dots = [
            None if y is None else (x_axis.dot(x), y_axis.dot(y)) for x, y in zip(curve.xs, line, strict=True)
        ]
        for dot in filter(None, dots):
            canvas.point(*dot, color=colour)
        for start, end in pairwise(dots):
            if start and end:
                canvas.line(*start, *end, color=colour)
        there = [dot for dot in dots if dot]
        if letter and there:  # letters tell the curves apart without colour, each at its own place
            place = there[-1 - (2 * LETTERS.index(letter) + 1) * len(there) // 24]
            canvas.point(*place, color=colour, marker=letter)


def _label(tick: Decimal) -> str:
    sign, digits, power = tick.normalize().as_tuple()
    if len(digits) == 1 and abs(int(power)) > LONGEST_POWER:
        return f"{'-' * sign}{digits[0]}e{power}"
    return as_typed(Fraction(tick))


def _under(ticks: dict[int, str], width: int) -> str:
    """The labels below their ticks; one that would touch the label before it is left out."""
    line = ""
    for column, label in sorted(ticks.items()):
        start = max(0, min(column - len(label) // 2, width - len(label)))
        if not line or start > len(line):
            line = line.ljust(start) + label
    return line
