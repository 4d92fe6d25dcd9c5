"""The forces along the arc of contact, as tables and JSON show them."""

from decimal import Decimal

from ..model.digits import tidy
from ..solver.answers import Answers
from ..solver.balance import Contact
from ..solver.messages import unmarked, verdict
from .text import VERSION, cell, scene_record

COLUMN_UNITS = {
    "angle": "°",
    "tension": "N",
    "normal_per_radian": "N/rad",
    "friction_per_radian": "N/rad",
    "normal_per_metre": "N/m",
    "friction_per_metre": "N/m",
}


def record(answers: Answers, arc: Contact) -> dict[str, object]:
    """The record for JSON."""
    return {
        "version": VERSION,
        "scene": scene_record(answers.case.scene, round_=answers.round),
        "regime": answers.case.regime,
        "profile": arc.kind,
        "points": [{name: point.get(name) for name in COLUMN_UNITS} for point in arc.points],
        "balance": arc.balance,
        "notes": [unmarked(verdict(answers)), *arc.notes],
    }


def print_table(answers: Answers, arc: Contact) -> None:
    """The scene, the verdict, the points along the arc, the balance of forces, and the notes."""
    from .page import Page, aligned

    page = Page()
    page.head(answers)
    heads = [f"{name.partition('_per_')[0]} ({COLUMN_UNITS[name]})" for name in arc.points[0]]
    columns = [
        aligned(cell(tidy(Decimal(point[name])) if name == "angle" else point[name]) for point in arc.points)
        for name in arc.points[0]
    ]
    page.table(heads, [list(zip(*columns, strict=True))])
    forces = {name: row for name, row in arc.balance.items() if "x" in row}
    xs, ys = (aligned(cell(force[axis]) for force in forces.values()) for axis in "xy")
    force_rows = list(zip(forces, xs, ys, strict=True))
    page.table(["Force on the pulley", "x (N)", "y (N)"], [force_rows[:2], force_rows[2:]])
    unit = "N m" if answers.case.scene.R is not None else "N, per unit radius"
    torques = aligned(map(cell, arc.balance["torque"].values()))
    kinds = ("friction along the arc", "R (T2 - T1)", "residual")
    page.table([f"Torque on the pulley ({unit})", ""], [list(zip(kinds, torques, strict=True))])
    page.say(*arc.notes)
