"""Curves in the terminal: needs plotille (extra ``plot``), which sets the dots; the axes are drawn here."""

import sys
from collections.abc import Sequence
from decimal import Decimal
from fractions import Fraction
from itertools import pairwise
from math import ceil, floor, log10
from typing import Any

from plotille import Canvas

from .output import Page, for_stream, sweep_head, sweep_notes, takes_unicode
from .rounding import as_typed
from .sweep import Curve, Picture, Row, Sweep, picture

PIPE_WIDTH, HEIGHT = 80, 20
LEAST_WIDTH, LEAST_HEIGHT = 10, 5
LEAST_TICKS = 3  # asking for fewer may give none
AROUND = 9  # lines above and below the curves, with the prompt
COLOURS = ("cyan", "magenta", "green", "blue", "red", "bright_cyan")
MARK = "yellow"
LETTERS = "abcdef"
DOTS = range(0x2800, 0x2900)
UPPER, LOWER = 0x1B, 0xE4  # the bits of the dots in the upper and the lower half of a braille character
FRAME = str.maketrans("┤│└┬─", "||++-")


class Axis:
    """Where numbers lie between the first and the last of ``dots``, and the ticks among them."""

    def __init__(self, values: list[float], dots: int, ticks: int, log: bool = False) -> None:
        self.dots, self.log = dots, log
        low, high = min(values), max(values)
        if self._place(low) == self._place(high):
            low, high = low - (abs(low) or 1) / 2, high + (abs(high) or 1) / 2
        self.low, self.high = self._place(low), self._place(high)
        self.ticks = _decades(low, high, ticks) if log else _steps(Decimal(low), Decimal(high), ticks)

    def _place(self, value: float) -> float:
        return log10(value) if self.log else value

    def dot(self, value: float) -> int:
        return round((self._place(value) - self.low) / (self.high - self.low) * (self.dots - 1))


def _steps(low: Decimal, high: Decimal, most: int) -> list[Decimal]:
    """About as many round numbers between two as wanted."""
    span = high - low
    power = Decimal(1).scaleb((span / most).adjusted())
    step = next(power * m for m in (1, 2, 5, 10) if span <= power * m * most)
    return [step * k for k in range(ceil(low / step), floor(high / step) + 1)]


def _decades(low: float, high: float, most: int) -> list[Decimal]:
    """Powers of ten between two numbers, or else the two."""
    powers = range(ceil(log10(low)), floor(log10(high)) + 1)
    if len(powers) < 2:
        return [Decimal(repr(low)), Decimal(repr(high))]
    return [Decimal(1).scaleb(power) for power in powers[:: ceil(len(powers) / most)]]


def print_plot(sweep: Sweep, rows: Sequence[Row], name: str, plain: bool) -> None:
    """The scene, the curves with their regimes and dotted lines where those change, and the notes."""
    from rich.text import Text

    page, drawn = Page(plain=plain), picture(sweep, rows, "plot", name)
    page.say(sweep_head(sweep))
    height = min(HEIGHT, max(page.console.height - AROUND, LEAST_HEIGHT)) if page.room else HEIGHT
    for line in _lines(drawn, page.room or PIPE_WIDTH, height):
        shown = line.translate(PLAIN) if takes_unicode(sys.stdout) else for_stream(_ascii(line), sys.stdout)
        page.console.print(Text.from_ansi(shown.rstrip()), soft_wrap=True)
    for note in [*_legend(drawn), *sweep_notes(rows, [name])]:
        page.say(note)


PLAIN = {DOTS[0]: " "}


def _ascii(line: str) -> str:
    halves = {(False, False): " ", (True, False): "'", (False, True): ".", (True, True): ":"}
    dots = {c: halves[bool(c & UPPER), bool(c & LOWER)] for c in DOTS}
    return line.translate(FRAME).translate(dots)


def _lines(drawn: Picture, room: int, height: int) -> list[str]:
    ys = [y for curve in drawn.curves for y in curve.ys if y is not None]
    y_axis = Axis(ys, 4 * height, max(height // 4, LEAST_TICKS))
    labels = {y_axis.dot(float(tick)) // 4: _label(tick) for tick in y_axis.ticks}
    margin = max(map(len, labels.values()), default=0)
    width = max(room - margin - 3, LEAST_WIDTH)
    x_axis = Axis(drawn.curves[0].xs, 2 * width, max(width // 12, LEAST_TICKS), drawn.log)
    canvas = Canvas(width, height, 0, 0, 2 * width, 4 * height)
    several = len(drawn.curves) > 1
    for curve in drawn.curves:
        for i in curve.changes:
            y = curve.ys[i]
            top = y_axis.dot(y) if several and y is not None else y_axis.dots
            for dot in range(0, top, 3):
                canvas.point(x_axis.dot(curve.xs[i]), dot, color=MARK)
    for number, curve in enumerate(drawn.curves):
        _draw_curve(canvas, curve, x_axis, y_axis, number, several)
    rows = canvas.plot("\n").split("\n")
    left = [f" {labels.get(i, ''):>{margin}} {'┤' if i in labels else '│'}" for i in range(height)]
    ticks = {x_axis.dot(float(tick)) // 2: _label(tick) for tick in x_axis.ticks}
    bottom = "".join("┬" if i in ticks else "─" for i in range(width))
    return [
        f" {drawn.y}",
        *(start + row for start, row in zip(reversed(left), rows, strict=True)),
        f" {'':>{margin}} └{bottom}",
        f" {'':>{margin}}  {_under(ticks, width)}",
        f" {'':>{margin}}  {drawn.x:>{width}}",
    ]


def _draw_curve(canvas: Any, curve: Curve, x_axis: Axis, y_axis: Axis, number: int, several: bool) -> None:
    colour = COLOURS[number]
    dots = [
        None if y is None else (x_axis.dot(x), y_axis.dot(y)) for x, y in zip(curve.xs, curve.ys, strict=True)
    ]
    for dot in filter(None, dots):
        canvas.point(*dot, color=colour)
    for start, end in pairwise(dots):
        if start and end:
            canvas.line(*start, *end, color=colour)
    there = [dot for dot in dots if dot]
    if several and there:  # letters tell the curves apart without colour, each at its own place
        canvas.point(*there[(2 * number + 1) * len(there) // 12], color=colour, marker=LETTERS[number])


def _label(tick: Decimal) -> str:
    return as_typed(Fraction(tick))


def _under(ticks: dict[int, str], width: int) -> str:
    """The labels below their ticks, without those that would touch the one before."""
    line = ""
    for column, label in sorted(ticks.items()):
        start = max(0, min(column - len(label) // 2, width - len(label)))
        if not line or start > len(line):
            line = line.ljust(start) + label
    return line


def _legend(drawn: Picture) -> list[str]:
    """The regimes along each curve, after its letter if there are several."""
    regimes = [", ".join(curve.regimes) for curve in drawn.curves]
    if len(regimes) == 1:
        return [f"Regimes: {regimes[0]}."]
    curves = zip(LETTERS, drawn.curves, regimes, strict=False)
    return [f"{letter}: {curve.label}: {words}" for letter, curve, words in curves]
