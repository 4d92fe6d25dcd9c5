"""`atwood contact`: what acts along the arc, as a table, JSON, CSV or a figure."""

from collections.abc import Mapping
from decimal import Decimal
from typing import Annotated

from ..model.digits import tidy
from ..model.scene import Scene, read_digits
from ..output.text import VERSION, Forms, Target, cell, say, scene_record, show
from ..solver.answers import Answers
from ..solver.balance import Contact
from ..solver.balance import contact as solve_contact
from ..solver.messages import unmarked, verdict
from .options import DONE, RESULTS, SCENE, Bare, Digits, FigureFile, option, takes

DEFAULT_POINTS = 13
Points = Annotated[
    str | None,
    option(
        "Arc",
        metavar="N",
        help=f"Angles along the arc to show, with both ends; {DEFAULT_POINTS} if not given.",
    ),
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

\b
Examples:
  atwood contact --m1 1 --m2 3 --mu 0.3
  atwood contact --m1 1 --m2 3 --M 10 --mu 0.3 --figure arc.svg
  atwood contact --m1 1 --m2 200 --M inf --mu 0.2 --wrap 2.5turn --csv
"""


@takes(SCENE, RESULTS, needs={"bare": "figure"})
def contact(
    given: Mapping[str, str | None],
    target: Target,
    *,
    points: Points = None,
    digits: Digits = None,
    figure: FigureFile = None,
    bare: Bare = False,
) -> int:
    answers = Answers(Scene.read(given), read_digits(digits))
    if not target.form:
        answers = answers.shown
    arc = solve_contact(answers, points or DEFAULT_POINTS)
    if figure is not None:
        from ..output.scene_figure import save

        save(answers, arc.kind, figure, target.force, bare, curves=True)
    forms = Forms(
        json=lambda: _record(answers, arc),
        records=lambda: arc.points,
        page=lambda: _print_arc(answers, arc),
        notes=lambda: arc.notes,
    )
    say(*show(forms, target))
    return DONE


def _record(answers: Answers, arc: Contact) -> dict[str, object]:
    return {
        "version": VERSION,
        "scene": scene_record(answers.case.scene, round_=answers.round),
        "regime": answers.case.regime,
        "profile": arc.kind,
        "points": [{name: point.get(name) for name in COLUMN_UNITS} for point in arc.points],
        "balance": arc.balance,
        "notes": [unmarked(verdict(answers)), *arc.notes],
    }


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
