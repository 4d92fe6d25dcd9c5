"""`atwood solve`: one scene, as a table, JSON, CSV, bare values, or with its derivation."""

import sys
from collections.abc import Mapping, Sequence
from itertools import chain, groupby
from typing import TYPE_CHECKING, Annotated

from ..arithmetic.rounding import to_digits, to_place, with_uncertainty
from ..model.quantities import MEASURED_NAMES, NAMES, QUANTITIES, cited, read_names
from ..model.scene import SceneError, read_digits
from ..output.text import Forms, cell, for_stream, inputs_in_words, say, scene_record, show
from ..solver.answers import Answers
from ..solver.messages import conditions, notes, reasons, remarks, unmarked
from ..solver.reading import read_answers
from .options import (
    COULD_NOT,
    DONE,
    AsCsv,
    AsJson,
    Bare,
    Digits,
    Force,
    M1Side,
    Markdown,
    check,
    option,
    quantities,
    scene_option,
    takes_scene,
)

if TYPE_CHECKING:
    from rich.console import Console

    from ..output.page import Page


def _answers() -> Mapping[str, str]:
    return {**quantities(), **dict.fromkeys(MEASURED_NAMES, "found from what was measured")}


A = Annotated[str | None, scene_option("a", "Measured")]
Drop = Annotated[str | None, scene_option("drop", "Measured")]
Time = Annotated[str | None, scene_option("time", "Measured")]
Only = Annotated[
    list[str] | None,
    option(
        "Output",
        metavar="NAME",
        words=_answers,
        help="Print only this quantity, by name or symbol; repeatable, or a,b.",
    ),
]
All = Annotated[
    bool,
    option(
        "Output",
        "--all",
        help="Show all quantities, and why others are missing, not just those that the scene is about.",
    ),
]
Budget = Annotated[
    bool,
    option("Output", "--budget", help="Also print each uncertain input's share of every result's variance."),
]
Explain = Annotated[
    bool,
    option(
        "Output",
        "--explain",
        help="Instead, show how it follows: step by step, with the numbers put in.",
    ),
]
Figure = Annotated[
    str | None,
    option(
        "Files",
        metavar="FILE",
        help="Also draw the machine and its forces to FILE.svg, .png or .pdf (extra: figure).",
    ),
]

HELP = """Solve one scene: acceleration, tensions, friction, critical masses.

Examples:
  atwood solve --m1 1 --m2 3 --mu 0.3
  atwood solve --m1 250g --m2 300g --M 100g --R 5cm --all
  atwood solve --m1 1 --m2 3 --M 100 --mu 0.3 --mu-k 0.25 --json
  atwood solve --m1 1 --m2 3 --M 10 --only acceleration --only mu_verge
  atwood solve --m1 '1.000(2)' --m2 3+/-0.01 --M 10 --budget
  atwood solve --m1 55g --m2 60g --R 5cm --a 0.380+/-0.004
  atwood solve --m1 55g --m2 60g --drop 80cm --time '2.05(2)'
  atwood solve --m1 1 --m2 3 --mu 0.3 --explain

Any number may have its standard uncertainty, as 1.000+/-0.002 or, in quotes for the shell, '1.000(2)'.
Results then have theirs, to first order, and a table ends each value at the second digit of it,
whatever --digits.
"""
LISTED = "\n".join(
    [
        "Quantities, for --only:",
        *(
            f"{name}\t{about.symbol}{f' ({about.unit})' * bool(about.unit)}: {about.meaning}"
            for name, about in QUANTITIES.items()
        ),
        "regime\tno-slip, verge or slip",
    ]
)


@takes_scene
def solve(
    given: Mapping[str, str | None],
    *,
    a: A = None,
    drop: Drop = None,
    time: Time = None,
    digits: Digits = None,
    json: AsJson = False,
    csv: AsCsv = False,
    only: Only = None,
    all: All = False,  # noqa: A002 - as the option is called
    budget: Budget = False,
    explain: Explain = False,
    markdown: Markdown = False,
    figure: Figure = None,
    m1_side: M1Side = None,
    bare: Bare = False,
    force: Force = False,
) -> int:
    check(locals())
    names = read_names("only", only or [], known=(*NAMES, *MEASURED_NAMES))
    answers = read_answers({**given, "a": a, "drop": drop, "time": time}, read_digits(digits))
    if budget and not answers.uncertainties:
        raise SceneError("budget", None, "needs an input with its uncertainty, like --m1 '1.000(2)'")
    if budget and names and not json:
        raise SceneError("budget", None, "has no place in bare values; take --json")
    if explain and answers.uncertainties:
        raise SceneError("explain", None, "shows exact numbers; leave their uncertainties out")
    if figure is not None:
        _draw(answers, figure, m1_side, bare, force)
    if explain:
        from ..derivation.steps import explain as explained
        from ..output.page import print_explanation

        given_in_words = inputs_in_words(answers.case.scene, answers.case.motion)
        print_explanation([*given_in_words.values()], explained(answers), markdown)
        return DONE
    forms = Forms(
        json=lambda: _record(answers, names, budget),
        records=lambda: [_line(answers, names or answers.names)],
        page=lambda: print_table(answers, all, budget),
        notes=lambda: [*([] if json or csv else _beside_bare(answers, names)), *reasons(answers)],
        bare=[cell(answers[name]) for name in names],
    )
    say(*show(forms, json, csv))
    return COULD_NOT if "" in forms.bare else DONE


def _draw(answers: Answers, path: str, m1_side: str | None, bare: bool, force: bool) -> None:
    """Draw the machine. Raises SceneError where the scene leaves its tensions open, OSError."""
    from ..output.arc_figure import save
    from ..solver.contact import kind_of

    if answers["tension_1"] is None:
        why = unmarked(answers.reasons["tension_1"])
        raise SceneError("figure", path, f"draws the tensions, which are not known: {why}")
    save(answers, kind_of(answers.case) if answers.case.light else None, path, force, m1_side, bare)


def _record(answers: Answers, only: Sequence[str], budget: bool) -> dict[str, object]:
    """The record for JSON: all quantities with scene and notes, or only those named."""
    names = only or answers.names
    results: dict[str, object] = {name: answers[name] for name in names}
    if answers.uncertainties:
        results["uncertainty"] = answers.standard_uncertainties(names)
    if budget:
        results["budget"] = {name: answers.budget(name) or None for name in names if name != "regime"}
    if only:
        return results
    scene = scene_record(answers.case.scene, answers.case.motion, answers.round)
    return {"scene": scene, **results, "notes": notes(answers)}


def _line(answers: Answers, names: Sequence[str]) -> dict[str, object]:
    """The record for CSV: values, then uncertainties."""
    values = {name: answers[name] for name in names}
    return values | {f"u_{name}": u for name, u in answers.standard_uncertainties(names).items()}


def _beside_bare(answers: Answers, only: Sequence[str]) -> list[str]:
    """The uncertain values with their uncertainties, which bare values leave out."""
    uncertain = [name for name in only if answers.standard_uncertainties([name]).get(name)]
    return [_stated(answers, name) for name in uncertain]


COLUMNS = ("Quantity", "Value", "Unit", "Symbol", "Equation")
AT_LIMIT = ("friction_force", "friction_force_x", "friction_force_y")
"""What is one number only where friction is at its limit."""


def print_table(
    answers: Answers, whole: bool = False, budget: bool = False, console: "Console | None" = None
) -> None:
    """Print the scene, what was found, the verdict, quantities, main or ``whole``, notes, and the budget."""
    from ..output.page import Page, table_width

    answers, page, columns = answers.shown, Page(console), list(COLUMNS)
    names = answers.names[1:] if whole else answers.main
    tabled = [name for name in names if name not in (*MEASURED_NAMES, *answers.found)]
    groups, found = _rows(answers, tabled), _found(answers)
    page.head(answers, found)
    while page.room and table_width(columns, groups) > page.room:
        columns.pop()
        groups = [[row[: len(columns)] for row in group] for group in groups]
    if groups and "Unit" in columns:
        page.table(columns, groups)
    else:  # no number without its unit: a plain line a quantity
        page.say(*(_stated(answers, name) for name, *_ in chain.from_iterable(_rows(answers, tabled))))
    said = [*remarks(answers), *(conditions(answers) if whole else ()), *reasons(answers)]
    page.say(*(unmarked(one) for one in said if one not in found))
    if budget:
        _print_budget(page, answers, names)


def _found(answers: Answers) -> list[str]:
    """Sentences on what follows from what was measured; one may say that no pulley does."""
    found = [_stated(answers, name) for name in answers.found if cell(answers[name])]
    none = answers.case.motion.beyond
    said = [one for one in reasons(answers) if none and none in one]
    return [*said, *[f"Found: {', '.join(found)}."] * bool(found)]


def _rows(answers: Answers, names: Sequence[str]) -> list[list[list[str]]]:
    """The cells of the table: a row for each quantity that exists, by group."""
    from ..output.page import aligned

    values = {name: shown for name in names if (shown := _with_uncertainty(answers, name))}
    groups: dict[str, list[list[str]]] = {}
    for name, value in zip(values, aligned(values.values()), strict=True):
        about, case = QUANTITIES[name], answers.case
        equation = cited(name, case.regime == "slip", case.axle_friction is not None)
        at = " at mu_verge" * (name in AT_LIMIT and case.mu_assumed)
        row = [f"{name}{at}", value, about.unit, about.symbol, equation]
        groups.setdefault(about.group, []).append([for_stream(word, sys.stdout) for word in row])
    return list(groups.values())


def _stated(answers: Answers, name: str) -> str:
    """A quantity with its value, uncertainty and unit."""
    return f"{name} = {_with_uncertainty(answers, name)} {QUANTITIES[name].unit}".rstrip()


def _with_uncertainty(answers: Answers, name: str) -> str:
    """A value, and its uncertainty if it has one; empty if it does not exist."""
    shown = cell(answers[name])
    u = answers.uncertainty(name, to_digits(2)) if shown else None
    return with_uncertainty(lambda place: answers.rounded(name, to_place(place)), u) if u else shown


def _print_budget(page: "Page", answers: Answers, names: Sequence[str]) -> None:
    """Each uncertain input's share of the variance of each quantity."""
    from ..output.page import aligned

    page.say("Each input's share of the variance, in percent:")
    shares = {name: one for name in names if (one := answers.budget(name, to_place(-1)))}
    inputs = list(answers.uncertainties.given) if answers.uncertainties else []
    columns = [aligned(str(one[x]) for one in shares.values()) for x in inputs]
    rows = ([name, *cells] for name, *cells in zip(shares, *columns, strict=True))
    by_group = groupby(rows, lambda row: QUANTITIES[row[0]].group)
    page.table(["Quantity", *inputs], [list(group) for _, group in by_group])
