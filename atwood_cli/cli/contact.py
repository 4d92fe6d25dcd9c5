"""`atwood contact`: what acts along the arc, as a table, JSON, CSV or a figure, or by string elements."""

from collections.abc import Callable, Mapping, Sequence
from decimal import Decimal
from typing import Annotated, Any

from ..arithmetic.rounding import tidy
from ..model.scene import Scene, read_digits
from ..output.text import VERSION, Forms, cell, say, scene_record, show
from ..solver.answers import Answers
from ..solver.contact import TO_SPARE, Contact
from ..solver.contact import contact as solve_contact
from ..solver.elements import EXACT
from ..solver.elements import Elements as Solved
from ..solver.elements import elements as march_elements
from ..solver.messages import unmarked, verdict
from .options import (
    DONE,
    AsCsv,
    AsJson,
    Bare,
    Digits,
    FigureFile,
    Force,
    M1Side,
    check,
    option,
    takes_scene,
)

DEFAULT_POINTS = 13
Points = Annotated[
    str | None,
    option(
        "Arc",
        metavar="N",
        help=f"Angles along the arc to show, with both ends; {DEFAULT_POINTS} if not given.",
    ),
]
Profile = Annotated[
    str | None,
    option(
        "Arc",
        metavar="|".join(TO_SPARE),
        help="Which tension, where friction to spare leaves it open: that of a slightly elastic string"
        " (creep, if not given), or that with the least net friction.",
    ),
]
Elements = Annotated[
    str | None,
    option(
        "String elements",
        metavar="N",
        help="Instead, solve the arc by N elements of string, in doubles, beside the exact values.",
    ),
]
Extrapolate = Annotated[
    bool,
    option("String elements", "--extrapolate", help="Extrapolate from N/2 and N elements (Richardson)."),
]
COLUMN_UNITS = {
    "angle": "°",
    "tension": "N",
    "normal_per_radian": "N/rad",
    "friction_per_radian": "N/rad",
    "normal_per_metre": "N/m",
    "friction_per_metre": "N/m",
}


HELP = """Show what acts along the arc of contact, and that it adds up.

Examples:
  atwood contact --m1 1 --m2 3 --mu 0.3
  atwood contact --m1 1 --m2 3 --M 10 --mu 0.3 --profile least
  atwood contact --m1 1 --m2 3 --mu 0.3 --elements 1000 --extrapolate
  atwood contact --m1 1 --m2 200 --M inf --mu 0.2 --wrap 2.5turn --csv
"""


@takes_scene
def contact(
    given: Mapping[str, str | None],
    *,
    points: Points = None,
    profile: Profile = None,
    elements: Elements = None,
    extrapolate: Extrapolate = False,
    figure: FigureFile = None,
    m1_side: M1Side = None,
    bare: Bare = False,
    force: Force = False,
    digits: Digits = None,
    json: AsJson = False,
    csv: AsCsv = False,
) -> int:
    check(locals())
    answers = Answers(Scene.read(given), read_digits(digits))
    if not (json or csv):
        answers = answers.shown
    if elements is not None:
        solved = march_elements(answers, elements, extrapolate)
        rows = [row._asdict() for row in solved.rows]
        by_name = {row.pop("name"): row for row in map(dict, rows)}
        found: dict[str, Any] = {"elements": {name: by_name.get(name) for name in EXACT}}
        forms = _forms(answers, solved.notes, found, rows, lambda: _print_elements(answers, solved))
    else:
        arc = solve_contact(answers, points or DEFAULT_POINTS, profile)
        points_found = [{name: point.get(name) for name in COLUMN_UNITS} for point in arc.points]
        found = {"profile": arc.kind, "points": points_found, "balance": arc.balance}
        forms = _forms(answers, arc.notes, found, arc.points, lambda: _print_arc(answers, arc))
        if figure is not None:
            from ..output.arc_figure import save

            save(answers, arc.kind, figure, force, m1_side, bare, curves=True)
    say(*show(forms, json, csv))
    return DONE


def _forms(
    answers: Answers,
    notes: list[str],
    found: Mapping[str, object],
    records: Sequence[Mapping[str, object]],
    page: Callable[[], None],
) -> Forms:
    return Forms(
        json=lambda: {
            "version": VERSION,
            "scene": scene_record(answers.case.scene, round_=answers.round),
            "regime": answers.case.regime,
            **found,
            "notes": [unmarked(verdict(answers)), *notes],
        },
        records=lambda: records,
        page=page,
        notes=lambda: notes,
    )


def _print_arc(answers: Answers, arc: Contact) -> None:
    """The scene, the verdict, the points along the arc, the balance of forces, and the notes."""
    from ..output.page import Page, aligned

    page = Page()
    page.head(answers)
    heads = [f"{name.partition('_per_')[0]} ({COLUMN_UNITS[name]})" for name in arc.points[0]]
    columns = [
        aligned(cell(tidy(Decimal(point[name])) if name == "angle" else point[name]) for point in arc.points)
        for name in arc.points[0]
    ]
    page.table(heads, [list(zip(*columns, strict=True))])
    names, forces = zip(*((name, row) for name, row in arc.balance.items() if "x" in row), strict=True)
    xs, ys = (aligned(cell(force[axis]) for force in forces) for axis in "xy")
    force_rows = list(zip(names, xs, ys, strict=True))
    page.table(["Force on the pulley", "x (N)", "y (N)"], [force_rows[:2], force_rows[2:]])
    unit = "N m" if answers.case.scene.R is not None else "N, per unit radius"
    torques = aligned(map(cell, arc.balance["torque"].values()))
    kinds = ("friction along the arc", "R (T2 - T1)", "residual")
    page.table([f"Torque on the pulley ({unit})", ""], [list(zip(kinds, torques, strict=True))])
    page.say(*arc.notes)


def _print_elements(answers: Answers, solved: Solved) -> None:
    """What the elements give beside the exact values, and the notes."""
    from ..output.page import Page, aligned

    page = Page()
    page.head(answers)
    names, errors = [row.name for row in solved.rows], [cell(row.error) for row in solved.rows]
    values, exact = (aligned(cell(row[i]) for row in solved.rows) for i in (1, 2))
    page.table(
        ["Quantity", "Elements", "Exact", "Relative error"],
        [list(zip(names, values, exact, errors, strict=True))],
    )
    page.say(*solved.notes)
