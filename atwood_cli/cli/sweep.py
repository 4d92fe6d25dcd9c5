"""`atwood sweep`: ranges and lists of scenes, as a table with its regimes, JSON, CSV, curves or a figure."""

import sys
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby, pairwise
from operator import attrgetter

from ..arithmetic.rounding import to_digits, to_double
from ..files import stdout_into
from ..model.quantities import QUANTITIES, STANDARD, read_names
from ..model.scene import read_digits
from ..output.curves import MAX_CURVES, Picture, axis_words, drawable, longest, picture, regimes
from ..output.page import Page, aligned, watched
from ..output.text import VERSION, Forms, cell, inputs_in_words, say, scene_record, show
from ..solver.answers import SHOWN_DIGITS
from ..solver.messages import reasons_at
from ..solver.regimes import changes
from ..solver.sweep import Row, Sweep, read_sweep, solve_rows
from .options import (
    COULD_NOT,
    DONE,
    AsCsv,
    AsJson,
    Bare,
    Columns,
    Digits,
    FigureFile,
    Force,
    OutputFile,
    Plot,
    check,
    check_extras,
    form_of,
    takes_scene,
)

HELP = """Solve a range of scenes: one or two options carry start:stop:count[:log], or a list, as 0,1,10.

Examples:
  atwood sweep --m1 1 --m2 3 --M 0:50:6 --mu 0.3
  atwood sweep --m1 1 --m2 3 --M 1:1000:4:log --mu 0.2:0.4:3 --only regime
  atwood sweep --m1 100g:500g:5 --m2 300g --M 50g --csv
  atwood sweep --m1 1 --m2 3 --M 0,1,10,inf --inertia disk,hoop
  atwood sweep --m1 1 --m2 3 --M 0:60:2 --mu 0.3 --plot
  atwood sweep --m1 1 --m2 3 --M 0:60:61 --only tension_1,tension_2 --figure t.svg

--plot and --figure draw what --only names, or the acceleration: quantities of one unit on one pair of axes,
others below each other. Curves run along a range; a second one, or a list, is a curve for each value.
"""


@takes_scene
def sweep(
    given: Mapping[str, str | None],
    *,
    plot: Plot = False,
    figure: FigureFile = None,
    bare: Bare = False,
    output: OutputFile = None,
    force: Force = False,
    digits: Digits = None,
    json: AsJson = False,
    csv: AsCsv = False,
    only: Columns = None,
) -> int:
    json, csv = form_of(locals())
    check(locals())
    names = list(dict.fromkeys(read_names("only", only or [])))
    precision = read_digits(digits)
    swept = read_sweep(given, precision)
    drawing = "plot" if plot else "figure" if figure is not None else ""
    drawn = drawable(swept, drawing, names) if drawing else []
    check_extras(plot, figure, force)
    with stdout_into(output, force):
        curves = picture(swept, drawing, drawn, precision) if drawn else None
        if figure is not None and curves is not None:
            from ..output.sweep_figure import save

            save(curves, "" if bare else _caption(swept, curves), figure, force)
        forms = _Forms(swept, names, precision, curves if plot else None)
        aside = show(Forms(forms.json, forms.records, forms.page, lambda: [*forms.notes()]), json, csv)
    say(*aside or [f"{name} has no value in any row" for name in names if name in forms.missing])
    return COULD_NOT if forms.missing else DONE


class _Forms:
    """A sweep in the forms in which it may be asked for; rows of JSON and CSV are written as they come."""

    def __init__(
        self, sweep: Sweep, names: Sequence[str], digits: int | None, curves: Picture | None
    ) -> None:
        self.sweep, self.digits, self.curves = sweep, digits, curves
        # The quantities asked for that no row has, or no curve.
        self.missing = set(names) & curves.missing if curves else set(names)
        self.names = names or STANDARD
        # Where a sentence tells the regimes, a column of them must be asked for.
        self.columns = self.names if names or sweep.ranges[1:] else STANDARD[1:]
        self.reasons: Counter[tuple[str, str]] = Counter()

    def _rows(self, names: Sequence[str], digits: int | None, watch: bool = True) -> Iterator[Row]:
        """The rows, while it is counted why values are missing."""
        rows = solve_rows(self.sweep, names, digits)
        for row in watched(rows, self.sweep.total) if watch else rows:
            self.reasons.update(row.reasons.items())
            self.missing = {name for name in self.missing if not cell(row.values[name])}
            yield row

    def notes(self) -> Iterator[str]:
        """Why values are missing, and at how many points; to be asked when all rows are out."""
        yield from reasons_at(self.reasons, self.sweep.total)

    def json(self) -> Mapping[str, object]:
        ranges = {range_.name: range_.typed for range_ in self.sweep.ranges}
        rounding = to_double if self.digits is None else to_digits(self.digits)
        return {
            "version": VERSION,
            "scene": scene_record(self.sweep.scene, round_=rounding) | ranges,
            "rows": self.records(),
            "notes": self.notes(),
        }

    def records(self) -> Iterator[dict[str, object]]:
        # Where rows would run into the bar, there is none.
        rows = self._rows(self.names, self.digits, watch=not sys.stdout.isatty())
        return ({**row.at, **{name: row.values[name] for name in self.names}} for row in rows)

    def page(self) -> None:
        page, head = Page(), ", ".join(_inputs(self.sweep).values())
        if self.curves:
            from ..output.plot import print_plot

            print_plot(page, head, self.curves)
        else:
            self._print_table(page, head)

    def _print_table(self, page: Page, head: str) -> None:
        """The scene, its regimes, what is the same in all rows, a row a point, and the notes.

        Columns without a value are left out.
        """
        sweep, names = self.sweep, list(self.columns)
        if sweep.scene.M is None and sweep.scene.mu is not None and PULLEY not in names:
            names.append(PULLEY)
        rows = list(self._rows(names, self.digits or SHOWN_DIGITS))
        cells = {name: [cell(row.values[name]) for row in rows] for name in names}
        shown = {name: column for name, column in cells.items() if any(column)}
        same = {name: column[0] for name, column in shown.items() if len(set(column)) == 1}
        above = [head, *_regimes(sweep, rows, self.digits)]
        if PULLEY not in same and any(row.regime == "verge" for row in rows):
            above.append(PULLEYS)
        if once := [_stated(name, value) for name, value in same.items() if name != "regime"]:
            above.append(f"In all rows: {', '.join(once)}.")
        notes = list(self.notes())
        page.say(*above)
        if len(same) < len(shown) or not shown:
            columns = {}
            for range_ in sweep.ranges:
                points = [range_.cell(row.at[range_.name]) for row in rows]
                unit = _in_brackets(range_.unit)
                columns[f"{range_.name}\n{unit}"] = points if range_.names else aligned(points)
            for name in [name for name in shown if name not in same]:
                unit = _in_brackets(QUANTITIES[name].unit) if name in QUANTITIES else ""
                columns[f"{name}\n{unit}"] = aligned(shown[name])
            lines = zip(*columns.values(), strict=True)
            slow = sweep.ranges[0].name  # groups are of its points, or of regimes
            groups = groupby(rows, lambda row: row.at[slow] if sweep.ranges[1:] else row.regime)
            table = [[next(lines) for _ in group] for _, group in groups]
            # Beside the table: the sentences, the units in its head, what is left out, the prompt.
            beside = 3 + len(page.lines(*above, *notes))
            if left_out := page.table(list(columns), table, len(sweep.ranges), beside):
                page.say(f"{left_out} rows in the middle are left out; a pipe or -o FILE has them all.")
        page.say(*notes)


PULLEY = "critical_pulley_mass"
PULLEYS = "As M is not given, each row that is on the verge has a pulley of its own: the critical one."


def _regimes(sweep: Sweep, rows: Sequence[Row], digits: int | None) -> Iterator[str]:
    """The regimes along one range, that which varies fast if two come into question.

    There is a sentence for each point of the other, if these are few.
    """
    along = max(reversed(sweep.ranges), key=attrgetter("rank"))
    if len({row.regime for row in rows}) == 1 and sweep.ranges[1:]:
        yield f"Regimes: {rows[0].regime}."
    elif sweep.total // len(along.points) <= MAX_CURVES:
        for scene, at in sweep.along(along):
            part = [row for row in rows if at.items() <= row.at.items()]
            if along.is_list:
                part = [row for point in along.finite for row in part if row.at[along.name] == point]
            beside = [two for two in pairwise(part) if two[0].regime != two[1].regime]
            known = {along.number(row.at[along.name]): row.regime for two in beside for row in two}
            words = ", ".join(regimes(along, list(changes(scene, along, digits, known)), scene))
            yield f"{sweep.stated(at) or 'Regimes'}: {words}."


def _stated(name: str, value: str) -> str:
    return f"{name} = {value} {QUANTITIES[name].unit}".rstrip()


def _in_brackets(unit: str) -> str:
    return f"({unit})" if unit else ""


def _inputs(sweep: Sweep) -> dict[str, str]:
    """Each input in words, and the ranges."""
    return inputs_in_words(sweep.scene) | {range_.name: range_.words for range_ in sweep.ranges}


def _caption(sweep: Sweep, curves: Picture) -> str:
    """What a picture shows, in sentences."""
    words = _inputs(sweep)
    words.pop(longest(sweep).name)
    others = ", ".join(f"{axis_words(name)[1]}{said[len(name) :]}" for name, said in words.items())
    title = curves.title[0].upper() + curves.title[1:]
    return " ".join([f"{title}: {others}.", *curves.notes])
