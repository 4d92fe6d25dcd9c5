"""Solved scenes as a table, JSON, CSV or bare values. rich is imported only for the table."""

import json
import sys
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from decimal import Decimal
from fractions import Fraction
from itertools import chain, groupby, product
from math import inf
from operator import attrgetter, itemgetter
from shutil import get_terminal_size
from time import monotonic
from typing import TYPE_CHECKING, Any, TextIO, TypeVar

from ..arithmetic.rounding import as_typed, is_infinite, text, with_uncertainty
from ..model.quantities import QUANTITIES
from ..model.scene import MEASURED, UNMEASURED, Motion, Scene, stated
from ..solver.answers import Answers
from ..solver.messages import notes, reasons_at, verdict

if TYPE_CHECKING:
    from rich.console import Console

    from ..solver.contact import Contact
    from ..solver.elements import Elements
    from ..solver.sweep import Row, Sweep
    from ..solver.uncertainty import Uncertainties
    from ..tradeoff.measure import March, Measured, Tradeoff

T = TypeVar("T")

COLUMN_UNITS = {
    "angle": "°",
    "tension": "N",
    "normal_per_radian": "N/rad",
    "friction_per_radian": "N/rad",
    "normal_per_metre": "N/m",
    "friction_per_metre": "N/m",
}
REGIME_STYLES = {"no-slip": "green", "verge": "yellow", "slip": "red"}
ASCII = str.maketrans(
    {"μ": "mu", "µ": "u", "φ": "phi", "β": "beta", "π": "pi", "τ": "tau", "α": "alpha", "θ": "theta"}
    | {
        "₁": "1",
        "₂": "2",
        "²": "^2",
        "°": "deg",
        "·": "*",
        "±": "+/-",
        "≤": "<=",
        "≥": ">=",
        "≈": "~",
        "√": "sqrt",
    }
)


def for_stream(words: str, stream: TextIO | None) -> str:
    """The words as the stream can take them: symbols are spelled out where it is not Unicode."""
    return words if takes_unicode(stream) else words.translate(ASCII).encode("ascii", "replace").decode()


def takes_unicode(stream: TextIO | None) -> bool:
    encoding = getattr(stream, "encoding", None) or "ascii"
    return encoding.lower().startswith("utf")


def print_json(
    answers: Answers, only: Sequence[str], found: "Uncertainties | None" = None, budget: bool = False
) -> None:
    """All quantities with scene and notes, or only those named; uncertainties where inputs have some."""
    results: dict[str, object] = {name: answers[name] for name in only or answers.names}
    if found:
        results["uncertainty"] = found.rounded(answers)
        if budget:
            results["budget"] = {
                name: {x: answers.round(100 * share) for x, share in spread.shares.items()} or None
                for name, spread in found.spreads.items()
            }
    if not only:
        every = [*notes(answers), *(found.notes if found else [])]
        results = {"scene": _scene(answers.case.scene, answers.case.motion), **results, "notes": every}
    print(_json(results))


def _scene(scene: Scene, motion: Motion = UNMEASURED) -> dict[str, object]:
    """The inputs as JSON has them: numbers in SI units and degrees, or text where JSON has no number."""
    given: dict[str, object] = scene._asdict()
    if motion != UNMEASURED:
        given |= {name: getattr(motion, name) for name in MEASURED}
        given |= {motion.finds: None} if motion.finds else {}
    if scene.M == inf:
        given["M"] = "inf"
    wrap = scene.wrap
    given["wrap"] = wrap.number if wrap.unit == "°" else f"{as_typed(wrap.number)}rad"
    return given


def _json(value: object, indent: str = "\n") -> str:
    inner = indent + "  "
    match value:
        case Mapping():
            items = (f"{json.dumps(key)}: {_json(item, inner)}" for key, item in value.items())
            return f"{{{inner}{f',{inner}'.join(items)}{indent}}}"
        case []:
            return "[]"
        case list():
            items = (_json(item, inner) for item in value)
            return f"[{inner}{f',{inner}'.join(items)}{indent}]"
        case Fraction():
            return as_typed(value)
        case float() | Decimal():
            return "null" if is_infinite(value) else text(value)
    return json.dumps(value)


def print_csv(answers: Answers, only: Sequence[str], found: "Uncertainties | None" = None) -> None:
    """A line of names and a line of values, then of uncertainties; what does not exist is empty."""
    spreads = found.rounded(answers) if found else {}
    values = {name: answers[name] for name in only or answers.names}
    print_records_csv([values | {f"u_{name}": u for name, u in spreads.items()}])


def cell(value: object) -> str:
    """A value as bare text, empty where it does not exist or no double can hold it."""
    match value:
        case float() | Decimal():
            return "" if is_infinite(value) else text(value)
        case bool():
            return str(value).lower()
    return str(value or "")


def describe(scene: Scene, ranges: Mapping[str, object] = {}, found: "Uncertainties | None" = None) -> str:
    """The scene in one line, as understood, with uncertainties, and with ranges as typed."""
    parts = []
    for name, value in {**_scene(scene), **ranges}.items():
        u = as_typed(found.given[name]) if found and name in found.given else ""
        spread = f" ± {u}" if u else ""
        if isinstance(value, Fraction):
            parts.append(stated(name, f"{_as_fine(as_typed(value), u)}{spread}"))
        elif value is not None:
            parts.append(f"{name} = {str(value).replace('rad', f'{spread}rad')}")
    return ", ".join(parts)


def _as_fine(number: str, other: str) -> str:
    """The number with as many decimals as the other, zeros if it has fewer: 3 beside 0.02 is 3.00."""
    decimals = len(other.partition(".")[2]) - len(number.partition(".")[2])
    if decimals <= 0 or "e" in number + other or "/" in number + other:
        return number
    return f"{number}{'' if '.' in number else '.'}{'0' * decimals}"


class Page:
    """Where tables and sentences go: the terminal, or a pipe that takes any width."""

    def __init__(self, console: "Console | None" = None, plain: bool = False) -> None:
        from rich.console import Console

        # rich itself takes COLUMNS=0 at its word, and every dumb terminal for one of 80 columns.
        width, height = get_terminal_size()
        self.console = console or Console(
            highlight=False, force_terminal=False if plain else None, width=width, height=height
        )
        self.room = self.console.width if self.console.is_terminal else None

    def say(self, words: str, style: str = "") -> None:
        """A sentence: piped it is a line, on a terminal its lines break between words."""
        from rich.text import Text

        self.console.print(Text(for_stream(words, sys.stdout), style), soft_wrap=self.room is None)

    def line(self, words: str, style: str = "") -> None:
        """A line as it is."""
        from rich.text import Text

        self.console.print(Text(words, style), soft_wrap=True)

    def head(self, answers: Answers, found: "Uncertainties | None" = None) -> None:
        """The scene and the verdict."""
        scene, motion = answers.case.scene, answers.case.motion
        self.say(describe(scene, _scene(scene, motion), found))
        self.say(verdict(answers), f"bold {REGIME_STYLES[answers.case.regime]}")

    def table(self, columns: Sequence[str], groups: Sequence[Sequence[Sequence[str]]], keys: int = 1) -> None:
        """A table, with a line between groups of rows, and as wide as its numbers ask.

        Columns that a terminal has no room for go into a table below, beside the first ``keys`` again.
        """
        from rich import box
        from rich.table import Table
        from rich.text import Text

        fit = len(columns)
        while self.room and fit > keys + 1 and _width(columns[:fit], groups) > self.room:
            fit -= 1
        if fit < len(columns):
            for part in (slice(keys, fit), slice(fit, None)):
                rows = [[[*row[:keys], *row[part]] for row in group] for group in groups]
                self.table([*columns[:keys], *columns[part]], rows, keys)
            return
        table = Table(*columns, box=box.ROUNDED, show_lines=True)
        for group in groups:
            # One row a group, its lines joined: rich takes five times as long over a row a line.
            table.add_row(*(Text("\n".join(column)) for column in zip(*group, strict=True)))
        room = self.console.width
        self.console.width = max(room, _width(columns, groups))
        self.console.print(table)
        self.console.width = room


def print_table(
    answers: Answers,
    console: "Console | None" = None,
    found: "Uncertainties | None" = None,
    budget: bool = False,
) -> None:
    """The scene, the verdict, the quantities that exist, the notes, and the budget if asked for."""
    page = Page(console)
    groups, told = _rows(answers, found), answers
    if found and answers.digits is None:  # in sentences: what is uncertain has no seventeen digits to tell
        told = Answers(answers.case.scene, UNCERTAIN_DIGITS, answers.case.motion)
        _ = [told[name] for name in told.names]
    _, *others = notes(told)
    page.head(told, found)
    columns = list(COLUMNS)
    while page.room and _width(columns, groups) > page.room:
        columns.pop()
        groups = [[row[: len(columns)] for row in group] for group in groups]
    if groups and "Unit" in columns:
        page.table(columns, groups)
    else:  # no number without its unit: a plain line a quantity
        for name, value, unit, *_ in chain.from_iterable(_rows(answers, found)):
            page.console.out(f"{name} = {value.lstrip()} {unit}".rstrip())
    for note in [*others, *(found.notes if found else [])]:
        page.say(note)
    if found and budget:
        _print_budget(page, found)


READABLE = 80  # columns: longer lines of text are hard to follow
NARROWEST = 40


def print_explanation(answers: Answers, markdown: bool) -> None:
    """The derivation, step by step: on a terminal in its columns, or as Markdown."""
    from ..derivation.steps import explain
    from ..derivation.typeset import as_markdown, as_text

    scene, told = describe(answers.case.scene), explain(answers)
    if markdown:
        for line in as_markdown(scene, told):
            print(for_stream(line, sys.stdout))
        return
    page = Page()
    width = max(NARROWEST, min(READABLE, page.room or READABLE))
    for line, style in as_text(scene, told, width, lambda words: for_stream(words, sys.stdout)):
        page.line(line, style)


UNCERTAIN_DIGITS = 6
COLUMNS = ("Quantity", "Value", "Unit", "Symbol", "Equation")


def _rows(answers: Answers, found: "Uncertainties | None") -> list[list[list[str]]]:
    """The cells of the table, a row for each quantity that exists, by group."""
    values = {
        name: shown for name in answers.names[1:] if (shown := _cell_with_uncertainty(answers, name, found))
    }
    groups: dict[str, list[list[str]]] = {}
    for name, value in zip(values, _aligned(values.values()), strict=True):
        about = QUANTITIES[name]
        equation = about.equation
        if answers.case.regime == "slip" and about.equation_in_slip is not None:
            equation = about.equation_in_slip
        row = [name, value, about.unit, about.symbol, equation]
        groups.setdefault(about.group, []).append([for_stream(word, sys.stdout) for word in row])
    return list(groups.values())


def _cell_with_uncertainty(answers: Answers, name: str, found: "Uncertainties | None") -> str:
    shown = cell(answers[name])
    u = found.spreads[name].u if found and shown else None
    return with_uncertainty(lambda place: answers.cut(name, place), u) if u else shown


def _print_budget(page: Page, found: "Uncertainties") -> None:
    """By quantity, each uncertain input's share of the variance."""
    page.say("Each input's share of the variance, in percent:")
    spreads = {name: spread.shares for name, spread in found.spreads.items() if spread.shares}
    columns = [_aligned(f"{100 * shares[x]:.1f}" for shares in spreads.values()) for x in found.given]
    rows = zip(spreads.items(), zip(*columns, strict=True), strict=True)
    by_group = groupby(rows, lambda row: QUANTITIES[row[0][0]].group)
    page.table(["Quantity", *found.given], [[[name, *cells] for (name, _), cells in g] for _, g in by_group])


def _aligned(numbers: Iterable[str]) -> list[str]:
    """The numbers with their decimal points below each other."""
    numbers = list(numbers)
    point = max(map(_integer_part, numbers), default=0)
    return [" " * (point - _integer_part(number)) + number for number in numbers]


def _width(columns: Sequence[str], groups: Sequence[Sequence[Sequence[str]]]) -> int:
    """The width of the table with those columns, told ten times as fast as by rich."""
    rows = [columns, *chain.from_iterable(groups)]
    return 1 + sum(3 + max(len(row[i]) for row in rows) for i in range(len(columns)))


def print_arc(answers: Answers, arc: "Contact") -> None:
    """The scene, the verdict, the points along the arc, the balance of forces, and the notes."""
    page = Page()
    page.head(answers)
    heads = [f"{name.partition('_per_')[0]} ({COLUMN_UNITS[name]})" for name in arc.points[0]]
    columns = [_aligned(cell(point[name]) for point in arc.points) for name in arc.points[0]]
    page.table([for_stream(head, sys.stdout) for head in heads], [list(zip(*columns, strict=True))])
    names, forces = zip(*((name, row) for name, row in arc.balance.items() if "x" in row), strict=True)
    xs, ys = (_aligned(cell(force[axis]) for force in forces) for axis in "xy")
    force_rows = list(zip(names, xs, ys, strict=True))
    page.table(["Force on the pulley", "x (N)", "y (N)"], [force_rows[:2], force_rows[2:]])
    unit = "N m" if answers.case.scene.R is not None else "N, per unit radius"
    torques = _aligned(map(cell, arc.balance["torque"].values()))
    kinds = ("friction along the arc", "R (T2 - T1)", "residual")
    page.table([f"Torque on the pulley ({unit})", ""], [list(zip(kinds, torques, strict=True))])
    for note in arc.notes:
        page.say(note)


def print_arc_json(answers: Answers, arc: "Contact") -> None:
    """Scene, regime, profile, points, balance and notes."""
    print(
        _json(
            {
                "scene": _scene(answers.case.scene),
                "regime": answers.case.regime,
                "profile": arc.kind,
                "points": arc.points,
                "balance": arc.balance,
                "notes": [verdict(answers), *arc.notes],
            }
        )
    )


def print_records_csv(records: Sequence[Mapping[str, object]]) -> None:
    """A line of names and a line for each record."""
    from csv import writer

    rows = [[cell(value) for value in record.values()] for record in records]
    writer(sys.stdout, lineterminator="\n").writerows([list(records[0]), *rows])


def print_elements(answers: Answers, found: "Elements") -> None:
    """What the elements give beside the exact values, and the notes."""
    page = Page()
    page.head(answers)
    names, errors = [row.name for row in found.rows], [cell(row.error) for row in found.rows]
    values, exact = (_aligned(cell(row[i]) for row in found.rows) for i in (1, 2))
    page.table(
        ["Quantity", "Elements", "Exact", "Relative error"],
        [list(zip(names, values, exact, errors, strict=True))],
    )
    for note in found.notes:
        page.say(note)


def print_elements_json(answers: Answers, found: "Elements") -> None:
    """Scene, regime, the rows by name, and the notes."""
    rows = {row.name: {"value": row.value, "exact": row.exact, "error": row.error} for row in found.rows}
    scene, notes = _scene(answers.case.scene), [verdict(answers), *found.notes]
    print(_json({"scene": scene, "regime": answers.case.regime, "elements": rows, "notes": notes}))


def print_sweep(sweep: "Sweep", rows: "Sequence[Row]", names: Sequence[str], plain: bool) -> None:
    """The scene, a table with a row a point, and the notes; columns without a value are left out."""
    from ..solver.sweep import groups, heads, regimes

    page, scene, others = Page(plain=plain), sweep_head(sweep), sweep_notes(rows, names)
    shown = [name for name in names if any(cell(row.values[name]) for row in rows)]
    columns = [_aligned(map(text, points)) for points in _swept(sweep)]
    columns += [_column(name, rows) for name in shown]
    lines = zip(*columns, strict=True)
    parts = [[next(lines) for _ in group] for group in groups(sweep, rows)]
    left_out = 0
    if page.room and sys.stdout.isatty():  # a person reads: the table's frame and all else take lines too
        sentences = sum(1 + len(line) // page.room for line in (scene, *others))
        parts, left_out = _trimmed(parts, page.console.height - sentences - FRAME)
    page.say(scene)
    if not sweep.ranges[1:]:
        page.say(f"Regimes: {', '.join(regimes(rows, sweep.ranges[0].name))}.")
    page.table([for_stream(head, sys.stdout) for head in heads(sweep, shown)], parts, len(sweep.ranges))
    if left_out:
        page.say(f"{left_out} rows in the middle are left out; a pipe or -o FILE has them all.")
    for note in others:
        page.say(note)


FRAME = 7  # lines: the table's frame and head, regimes, the sentence on what is left out, the prompt


def _swept(sweep: "Sweep") -> list[list[Decimal]]:
    """The swept parameters as columns."""
    return [list(column) for column in zip(*product(*(r.bare() for r in sweep.ranges)), strict=True)]


def sweep_head(sweep: "Sweep") -> str:
    """The scene in one line, with ranges as typed."""
    return describe(sweep.scene, _typed_ranges(sweep))


def _typed_ranges(sweep: "Sweep") -> dict[str, str]:
    return {range_.name: range_.typed for range_ in sweep.ranges}


def _column(name: str, rows: "Sequence[Row]") -> list[str]:
    cells = [cell(row.values[name]) for row in rows]
    return cells if name == "regime" else _aligned(cells)


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


def sweep_notes(rows: "Sequence[Row]", names: Sequence[str]) -> list[str]:
    """Why values are missing, and at how many points."""
    found = Counter(item for row in rows for item in row.reasons.items() if item[0] in names)
    return reasons_at(found, len(rows))


def print_sweep_csv(sweep: "Sweep", rows: "Sequence[Row]", names: Sequence[str]) -> None:
    """A line of names and a line a point."""
    print_records_csv(_records(sweep, rows, names))


def _records(sweep: "Sweep", rows: "Sequence[Row]", names: Sequence[str]) -> list[dict[str, object]]:
    return [{**row.at, **{name: row.values[name] for name in names}} for row in rows]


def print_sweep_json(sweep: "Sweep", rows: "Sequence[Row]", names: Sequence[str]) -> None:
    """The scene, with ranges as typed, a record a point, and the notes."""
    scene = _scene(sweep.scene) | _typed_ranges(sweep)
    records = _records(sweep, rows, names)
    print(_json({"scene": scene, "rows": records, "notes": sweep_notes(rows, names)}))


def print_tradeoff(found: "Tradeoff") -> None:
    """A table of the settings for each family of scenes, one of string elements, and what follows."""
    from ..tradeoff.measure import ELEMENTS_LEGEND, LEGEND
    from ..tradeoff.scenes import FAMILIES

    page = Page()
    for family, measured in groupby(found.measured, attrgetter("family")):
        meaning = FAMILIES[family].meaning if family in FAMILIES else describe(found.scene)
        page.say(f"{family}: {meaning}", "bold")
        _print_measured(page, list(measured))
    page.say(LEGEND)
    if found.marches:
        page.say(f"String elements: e^(μφ) of {describe(found.scene)}", "bold")
        _print_marches(page, found.marches)
        page.say(ELEMENTS_LEGEND)
    for note in found.notes:
        page.say(note)
    page.say(found.advice, "bold")


def _print_measured(page: Page, measured: "Sequence[Measured]") -> None:
    from ..tradeoff.measure import in_seconds, percent, short

    columns = {
        "  Setting": [f"{'*' if one.best else ' '} {one.setting}" for one in measured],
        "Time": [in_seconds(one.seconds) for one in measured],
        "±": [percent(one.spread) for one in measured],
        "Worst": [short(one.worst_ulp) for one in measured],
        "99 %": [short(one.percentile_99_ulp) for one in measured],
        "Over 4": [percent(one.share_over_4_ulp) for one in measured],
        "Regime": [percent(one.share_wrong_regime) for one in measured],
    }
    _print_columns(page, list(columns), list(columns.values()))


def _print_marches(page: Page, marches: "Sequence[March]") -> None:
    from ..tradeoff.measure import in_seconds, scientific

    by_count: dict[int | None, dict[bool, March]] = {}
    for one in marches:
        by_count.setdefault(one.elements, {})[one.extrapolated] = one
    columns = [[str(count or "closed form") for count in by_count]]
    for extrapolated in (False, True):
        found = [both.get(extrapolated) for both in by_count.values()]
        columns += [
            [f"{'*' if one.best else ' '} {scientific(one.relative_error)}" if one else "" for one in found],
            [f"{one.order:.2f}" if one and one.order is not None else "" for one in found],
            [in_seconds(one.seconds) if one else "" for one in found],
        ]
    heads = ["Elements", "Error", "Order", "Time", "Extrapolated", "Order", "Time"]
    _print_columns(page, heads, columns)


def _print_columns(page: Page, heads: Sequence[str], columns: Sequence[Sequence[str]]) -> None:
    """A table whose columns but the first are flush right."""
    words = [
        [for_stream(word, sys.stdout) for word in column]
        for column in ([head, *rows] for head, rows in zip(heads, columns, strict=True))
    ]
    flush = [words[0], *([word.rjust(max(map(len, column))) for word in column] for column in words[1:])]
    lines = list(zip(*flush, strict=True))
    page.table(lines[0], [lines[1:]])


def print_tradeoff_json(found: "Tradeoff") -> None:
    """What was measured, the seed or the scene, the notes and the advice."""
    about: dict[str, object] = {"scene": _scene(found.scene)}
    if found.seed is not None:
        about = {"seed": found.seed, "scenes": found.scenes}
    arithmetic = [one._asdict() for one in found.measured]
    elements = [one._asdict() for one in found.marches]
    parts = {"arithmetic": arithmetic, "elements": elements, "notes": found.notes, "advice": found.advice}
    print(_json(about | parts))


def print_tradeoff_csv(found: "Tradeoff") -> None:
    """A line for each setting and family, and for each number of elements."""
    records = [one._asdict() for one in found.measured]
    for one in found.marches:
        records.append({"setting": "elements" if one.elements else "closed form"} | one._asdict())
    names = dict.fromkeys(name for record in records for name in record)
    print_records_csv([{name: record.get(name) for name in names} for record in records])


def watched(parts: Iterator[T], total: int | None, size: Callable[[T], int] = lambda _: 1) -> Iterator[T]:
    """The parts, with a bar on a terminal's stderr once they take longer than a second."""
    start, done = monotonic(), 0
    for part in parts:
        yield part
        done += size(part)
        if monotonic() - start > 1 and sys.stderr.isatty():
            yield from _with_bar(parts, done, total, size)


def _with_bar(parts: Iterator[T], done: int, total: int | None, size: Callable[[T], int]) -> Iterator[T]:
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True, redirect_stdout=False) as bar:
        task = bar.add_task("", total=total, completed=done)
        for part in parts:
            yield part
            bar.advance(task, size(part))


def _integer_part(value: str) -> int:
    return len(value.partition(" ")[0].partition(".")[0].partition("e")[0])


def print_only(answers: Answers, only: Iterable[str]) -> None:
    """Bare values, one a line, nothing for one that does not exist."""
    for name in only:
        if shown := cell(answers[name]):
            print(shown)
