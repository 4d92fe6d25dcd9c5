"""`atwood solve`: one scene, as a table, JSON, CSV, bare values, or with its derivation."""

from collections.abc import Mapping, Sequence
from typing import Annotated

from ..files import stdout_into
from ..model.quantities import MEASURED_NAMES, NAMES, QUANTITIES, read_names
from ..model.scene import SceneError, read_digits
from ..output.solution import beside_bare, print_table, record
from ..output.text import Forms, cell, inputs_in_words, say, show
from ..solver.answers import Answers
from ..solver.messages import reasons, unmarked
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
    OutputFile,
    check,
    form_of,
    option,
    quantities,
    scene_option,
    takes_scene,
)


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
    output: OutputFile = None,
    force: Force = False,
) -> int:
    json, csv = form_of(locals())
    check(locals())
    names = read_names("only", only or [], known=(*NAMES, *MEASURED_NAMES))
    answers = read_answers({**given, "a": a, "drop": drop, "time": time}, read_digits(digits))
    if budget and not answers.uncertainties:
        raise SceneError("budget", None, "needs an input with its uncertainty, like --m1 '1.000(2)'")
    if budget and names and not json:
        raise SceneError("budget", None, "has no place in bare values; take --json")
    if explain and answers.uncertainties:
        raise SceneError("explain", None, "shows exact numbers; leave their uncertainties out")
    forms = Forms(
        json=lambda: record(answers, names, budget),
        records=lambda: [_line(answers, names or answers.names)],
        page=lambda: _explain(answers, markdown) if explain else print_table(answers, all, budget),
        notes=lambda: [*([] if json or csv else beside_bare(answers, names)), *reasons(answers)],
        bare=[cell(answers[name]) for name in names],
    )
    with stdout_into(output, force):
        if figure is not None:
            _draw(answers, figure, m1_side, bare, force)
        aside = show(forms, json, csv)
    say(*aside)
    return COULD_NOT if "" in forms.bare else DONE


def _explain(answers: Answers, markdown: bool) -> None:
    from ..derivation.steps import explain
    from ..output.page import print_explanation

    given = inputs_in_words(answers.case.scene, answers.case.motion)
    print_explanation([*given.values()], explain(answers), markdown)


def _draw(answers: Answers, path: str, m1_side: str | None, bare: bool, force: bool) -> None:
    """Draw the machine. Raises SceneError where the scene leaves its tensions open, OSError."""
    from ..output.arc_figure import save
    from ..solver.contact import kind_of

    if answers["tension_1"] is None:
        why = unmarked(answers.reasons["tension_1"])
        raise SceneError("figure", path, f"draws the tensions, which are not known: {why}")
    save(answers, kind_of(answers.case) if answers.case.light else None, path, force, m1_side, bare)


def _line(answers: Answers, names: Sequence[str]) -> dict[str, object]:
    """The record for CSV: values, then uncertainties."""
    values = {name: answers[name] for name in names}
    return values | {f"u_{name}": u for name, u in answers.standard_uncertainties(names).items()}
