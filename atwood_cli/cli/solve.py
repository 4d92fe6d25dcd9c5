"""`atwood solve`: one scene, as a table, JSON, CSV, bare values, or with its derivation."""

from collections.abc import Mapping, Set
from functools import partial
from typing import Annotated

from ..explain.conditions import failure, read_condition
from ..explain.messages import reasons
from ..output.forms import Destination, Picture, Report, show
from ..output.scene_page import csv_record, notes_on_stderr, print_budget, print_steps, print_table, record
from ..output.text import cell, say
from ..reading.inputs import read_digits
from ..reading.names import read_results
from ..reading.scenes import read_answers
from ..solver.quantities import FROM_MOTION, MEASURED_NAMES, UNITS
from ..solver.scene import FALL, FINDABLE, INPUTS, SceneError
from .options import (
    COULD_NOT,
    DONE,
    FIGURE,
    MOTION,
    OUTPUT,
    SCENE,
    Digits,
    Expect,
    option,
    quantity_meanings,
    with_options,
)

Only = Annotated[
    list[str] | None,
    option(
        "Output",
        metavar="NAME",
        words=lambda: {**quantity_meanings(), **dict.fromkeys(MEASURED_NAMES, "found from measurements")},
        help="Print only these: a,'T2 in lbf'; see atwood quantities.",
    ),
]
Find = Annotated[
    str | None,
    option(
        "Measured",
        metavar="NAME",
        words=lambda: {x: INPUTS[x].meaning if x in INPUTS else "a motor or a brake" for x in FINDABLE},
        help="What the motion finds: m1, m2, M, g, mu_k, axle or drive.",
    ),
]


def implied(asked: Set[str], given: Mapping[str, str | None]) -> str | None:
    """Return what a measured motion is to find, as a result of its own is asked for and it is not given."""
    finds = [x for x in FINDABLE if given.get(x) is None and not asked.isdisjoint(FROM_MOTION[x])]
    has_motion = given["a"] is not None or sum(given[x] is not None for x in FALL) > 1
    return finds[0] if has_motion and len(finds) == 1 else None


HELP = """Solve one scene: acceleration, tensions, friction.

\b
Examples:
  atwood solve --m1 1 --m2 3 --mu 0.3
  atwood solve --m1 250g --m2 300g --M 100g --R 5cm --all
  atwood solve --m1 '55.0(1)g' --m2 60+-0.1g --a 0.380 --R 5cm
  atwood solve --m1 1 --m2 3 --M 10 --mu 0.3 --explain

Any number may carry its uncertainty. A sheave whose brake is set is --M inf; a safety_factor below 1 slips.
"""


@with_options(SCENE | MOTION, OUTPUT, FIGURE)
def solve(
    given: Mapping[str, str | None],
    target: Destination,
    picture: Picture | None,
    *,
    find: Find = None,
    only: Only = None,
    expect: Expect = None,
    all_: Annotated[
        bool, option("Output", "--all", help="Show all quantities, and why any are missing.")
    ] = False,
    digits: Digits = None,
    budget: Annotated[
        bool, option("Output", "--budget", help="Also print each uncertain input's share of the variance.")
    ] = False,
    explain: Annotated[
        bool, option("Output", "--explain", help="Show the derivation instead, with numbers put in.")
    ] = False,
) -> int:
    names, units = read_results("only", only or [], UNITS)
    conditions = [read_condition(typed) for typed in expect or []]
    asked = {*names, *(condition.name for condition in conditions)}
    answers = read_answers({**given, "find": find or implied(asked, given)}, read_digits(digits))
    if budget and not answers.uncertain:
        raise SceneError("budget", None, "needs an input with its uncertainty, like --m1 '1.000(2)'")
    if explain and answers.uncertain:
        raise SceneError("explain", None, "shows exact numbers; leave their uncertainties out")
    if explain and units:
        raise SceneError("explain", None, "is in SI units; leave the units of --only out")
    if picture is not None:
        from ..output.scene_figure import save_scene

        save_scene(answers, picture)
    shown = answers.in_units(units)
    values = [cell(shown[name]) for name in names]
    table = partial(print_table, answers=shown, only=names or all_, budget=budget)
    report = Report(
        json=lambda: record(shown, names, budget),
        records=lambda: [csv_record(shown, names or answers.names, budget)],
        page=partial(print_steps, answers=answers, names=names) if explain else table,
        notes=lambda: notes_on_stderr(shown, names, values=not target.form),
        bare=[] if explain else values,
        below=(lambda page: print_budget(page, answers, names)) if budget else None,
    )
    aside = [*show(report, target), *(reasons(answers.to_six_digits, names) if explain else [])]
    failures = [why for condition in conditions if (why := failure(answers, condition))]
    say(*aside, *failures)
    judged = {condition.name for condition in conditions}  # some conditions hold for one without a value
    lacking = {name for name, value in zip(names, values, strict=True) if not value} - judged
    return COULD_NOT if lacking or failures else DONE
