"""`atwood sweep`: ranges of scenes, as a table with its regimes, JSON, CSV, curves or a figure."""

import os
import sys
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import groupby, product
from operator import itemgetter
from typing import Annotated, Any

from ..arithmetic.rounding import text
from ..files import STREAM, stdout_into
from ..model.quantities import QUANTITIES, STANDARD
from ..model.scene import SceneError, read_digits
from ..solver.messages import reasons_at
from ..solver.sweep import Row, Sweep, read_sweep, solve_rows
from .curves import check_drawable, picture, regimes, with_unit
from .options import (
    DONE,
    ONE_FORM,
    PLOT_IS_TEXT,
    AsCsv,
    AsJson,
    Columns,
    Digits,
    Force,
    Rule,
    check,
    check_extras,
    numbers,
    option,
    read_name,
    read_names,
    takes_scene,
)
from .page import Page, aligned, watched
from .text import Forms, cell, describe, for_stream, say, scene_record, show

Plot = Annotated[
    str | None,
    option(
        "Output",
        metavar="NAME",
        words=numbers,
        help="Draw this quantity's curve in place of the table (extra: plot).",
    ),
]
SweepFigure = Annotated[
    tuple[str, str] | None,
    option(
        "Files",
        "--figure",
        metavar="FILE NAME",
        words=numbers,
        help="Also draw this quantity's curve to FILE.svg, .png or .pdf (extra: figure).",
    ),
]
OutputFile = Annotated[
    str | None,
    option(
        "Files",
        "--output",
        "-o",
        metavar="FILE",
        help="Write to FILE, whole or not at all: as CSV (.csv), JSON (.json) or as shown (.txt).",
    ),
]
SUFFIXES = ("", ".txt", ".csv", ".json")

FILE_TO_REPLACE = Rule("force", "output figure", "needs --output or --figure", without=True)
RULES = (
    *PLOT_IS_TEXT,
    Rule("only", "plot", "has no say beside --plot; leave one of them out"),
)


HELP = """Solve a range of scenes: one or two options carry start:stop:count or start:stop:count:log.

Examples:
  atwood sweep --m1 1 --m2 3 --M 0:50:6 --mu 0.3 --digits 6
  atwood sweep --m1 1 --m2 3 --M 1:1000:4:log --mu 0.2:0.4:3 --only regime
  atwood sweep --m1 100g:500g:5 --m2 300g --M 50g --csv
  atwood sweep --m1 1 --m2 3 --M 0:60:61 --mu 0.3 --plot acceleration
  atwood sweep --m1 1 --m2 3 --M 0:60:61 --figure a.svg mu_verge -o a.csv
"""


@takes_scene
def sweep(
    given: Mapping[str, str | None],
    *,
    plot: Plot = None,
    figure: SweepFigure = None,
    output: OutputFile = None,
    force: Force = False,
    digits: Digits = None,
    json: AsJson = False,
    csv: AsCsv = False,
    only: Columns = None,
) -> int:
    options = dict(locals())
    check([ONE_FORM, FILE_TO_REPLACE], options)
    json, csv = _form_for(output, json, csv)
    names = list(dict.fromkeys(read_names("only", only or STANDARD)))
    swept, precision = read_sweep(given), read_digits(digits)
    asked = {"plot": plot, "figure": figure and figure[1]}
    drawn = {where: read_name(where, word) for where, word in asked.items() if word is not None}
    for where, name in drawn.items():
        check_drawable(swept, where, name)
    plot = drawn.get("plot")
    check(RULES, {**options, "json": json, "csv": csv})
    check_extras(plot, figure and figure[0], force)
    if figure and output and os.path.realpath(figure[0]) == os.path.realpath(output):
        raise SceneError("figure", figure[0], "is the file of --output; name another")
    if plot is not None:
        names = [plot]
    wanted = list(dict.fromkeys([*names, *drawn.values()]))
    reasons: Reasons = Counter()
    solved = _noted(solve_rows(swept, wanted, precision), reasons)
    with stdout_into(output, force):
        if not (csv and output is None and sys.stdout.isatty()):  # where rows would run into the bar
            solved = watched(solved, swept.total)
        rows: Iterable[Row] = solved if csv else list(solved)
        if figure is not None:
            from .sweep_figure import save

            rows = held = list(rows)
            save(picture(swept, held, "figure", drawn["figure"]), _head(swept), figure[0], force)
        aside = show(_forms(swept, rows, reasons, names, plot, _is_file(output)), json, csv)
    say(*aside)
    return DONE


Reasons = Counter[tuple[str, str]]
"""By quantity and why it has no value, at how many points."""


def _noted(rows: Iterable[Row], reasons: Reasons) -> Iterator[Row]:
    """The rows, while reasons are counted."""
    for row in rows:
        reasons.update(row.reasons.items())
        yield row


def _is_file(output: str | None) -> bool:
    return output not in (None, STREAM)


def _form_for(output: str | None, json: bool, csv: bool) -> tuple[bool, bool]:
    """Whether to print JSON or CSV, by the options or else by the suffix of the file to write."""
    if output is None or not _is_file(output) or json or csv:
        return json, csv
    suffix = os.path.splitext(output)[1].lower()
    if suffix not in SUFFIXES:
        rule = f"must end in one of {', '.join(filter(None, SUFFIXES))}, or name --json or --csv"
        raise SceneError("output", output, rule)
    return suffix == ".json", suffix == ".csv"


def _forms(
    sweep: Sweep, rows: Iterable[Row], reasons: Reasons, names: Sequence[str], plot: str | None, plain: bool
) -> Forms:
    """``plain``: what is printed goes to a file, though stdout may be a terminal.

    Rows that come one by one, for CSV, are those of which no other form can be had.
    """

    def notes() -> list[str]:
        """Why values are missing, and at how many points."""
        counted = Counter({about: count for about, count in reasons.items() if about[0] in names})
        return reasons_at(counted, sweep.total)

    def page() -> None:
        if plot is None:
            _print_table(sweep, list(rows), names, notes(), plain)
        else:
            from .plot import print_plot

            curves = picture(sweep, list(rows), "plot", plot)
            print_plot(Page(plain=plain), _head(sweep), curves, notes())

    return Forms(
        json=lambda: {
            "scene": scene_record(sweep.scene) | _typed_ranges(sweep),
            "rows": list(_records(rows, names)),
            "notes": notes(),
        },
        records=lambda: _records(rows, names),
        page=page,
        notes=notes,
    )


def _records(rows: Iterable[Row], names: Sequence[str]) -> Iterator[dict[str, object]]:
    return ({**row.at, **{name: row.values[name] for name in names}} for row in rows)


def _head(sweep: Sweep) -> str:
    """The scene in one line, with ranges as typed."""
    return describe(sweep.scene, _typed_ranges(sweep))


def _typed_ranges(sweep: Sweep) -> dict[str, str]:
    return {range_.name: range_.typed for range_ in sweep.ranges}


def _print_table(
    sweep: Sweep, rows: Sequence[Row], names: Sequence[str], notes: Sequence[str], plain: bool
) -> None:
    """The scene, its regimes, a row a point, and the notes; columns without a value are left out."""
    page, scene = Page(plain=plain), _head(sweep)
    shown = [name for name in names if any(cell(row.values[name]) for row in rows)]
    columns = [
        aligned(map(text, points)) for points in zip(*product(*(r.bare() for r in sweep.ranges)), strict=True)
    ]
    columns += [_column(name, rows) for name in shown]
    lines = zip(*columns, strict=True)
    groups = [[next(lines) for _ in group] for group in _groups(sweep, rows)]
    left_out = 0
    if page.room and sys.stdout.isatty():  # a person reads: the table's frame and all else take lines too
        sentences = sum(1 + len(line) // page.room for line in (scene, *notes))
        groups, left_out = _trimmed(groups, page.console.height - sentences - FRAME)
    page.say(scene)
    if not sweep.ranges[1:]:
        page.say(f"Regimes: {', '.join(regimes(rows, sweep.ranges[0].name))}.")
    page.table([for_stream(head, sys.stdout) for head in _heads(sweep, shown)], groups, len(sweep.ranges))
    if left_out:
        page.say(f"{left_out} rows in the middle are left out; a pipe or -o FILE has them all.")
    for note in notes:
        page.say(note)


FRAME = 7  # lines: the table's frame and head, regimes, the sentence on what is left out, the prompt


def _column(name: str, rows: Sequence[Row]) -> list[str]:
    cells = [cell(row.values[name]) for row in rows]
    return cells if name == "regime" else aligned(cells)


def _groups(sweep: Sweep, rows: Sequence[Row]) -> list[list[Row]]:
    """The rows in the parts that a table shows: by the slow range, or else by the regime."""
    slow = sweep.ranges[0].name
    return [
        list(group)
        for _, group in groupby(rows, lambda row: row.at[slow] if sweep.ranges[1:] else row.regime)
    ]


def _heads(sweep: Sweep, names: Sequence[str]) -> list[str]:
    """The names of parameters and quantities, with their units."""
    swept = [with_unit(range_.name, range_.unit) for range_ in sweep.ranges]
    return swept + [with_unit(n, QUANTITIES[n].unit if n in QUANTITIES else "") for n in names]


def _trimmed(groups: list[list[Any]], room: int) -> tuple[list[list[Any]], int]:
    """The first and the last rows, as many as fit with the lines between groups, and how many do not."""
    rows = [(i, row) for i, group in enumerate(groups) for row in group]
    if len(rows) + len(groups) - 1 <= room:
        return groups, 0
    # At least one row is kept at each end, and a row of dots takes three lines.
    for kept in range(max(2, min(room, len(rows) - 1)), 1, -1):
        halves = rows[: (kept + 1) // 2], rows[-(kept // 2) :]
        ends = [[[row for _, row in g] for _, g in groupby(half, itemgetter(0))] for half in halves]
        if kept == 2 or kept + len(ends[0]) + len(ends[1]) + 1 <= room:
            break
    dots = ["..."] * len(rows[0][1])
    return [*ends[0], [dots], *ends[1]], len(rows) - kept
