"""What acts along the arc of contact, and that it adds up: the paper's sections 2 to 4 for a scene.

The string acts on the pulley only along the arc: with the normal force nR = T (13) and the friction
fR = dT/dθ (12), both per radian. Integrated, they are what T1 and T2 would be if they acted on the
pulley themselves: a force (20) and a torque (23). Here both sides are computed, each rounded
correctly, and the residuals are exact differences of the printed numbers.
"""

from collections.abc import Callable
from decimal import Decimal
from fractions import Fraction
from math import inf
from typing import Any, NamedTuple

from ..model import arc
from ..model.arc import Kind
from ..model.case import Case
from ..model.digits import is_infinite
from ..model.machine import Machine
from ..model.reasons import FREE_END, NEEDS_M
from ..model.scene import SceneError, read_whole
from .answers import Answers
from .messages import unmarked

Number = float | Decimal

MAX_POINTS = 100_000

ABOUT_KIND = {
    "creep": (
        "The tension is not unique while friction is to spare. Shown is that of a slightly elastic"
        " string: it creeps, with friction at its limit, only at the heavier mass's end of the arc."
    ),
    "exponential": "Friction is at its limit all along the arc.",
}
WITHOUT_MU = "Without mu, shown is the string on the verge, with the least mu that holds it."
ROUNDING = "Residuals are differences of the rounded numbers shown."
RESIDUALS = (("residual", "x"), ("residual", "y"), ("torque", "residual"))
WITHOUT_FRICTION = "Both tensions are equal: there is no friction."


class Contact(NamedTuple):
    """The arc of contact: the profile, its points by column, and the balance."""

    kind: Kind
    points: list[dict[str, Number]]
    balance: dict[str, dict[str, Number]]
    notes: list[str]


def check_arc(case: Case) -> None:
    """Raises SceneError where the string touches nothing, as one of its ends is free."""
    if not case.light:
        raise SceneError("m1" if case.scene.m1 == 0 else "m2", 0, f"leaves no arc: {FREE_END}")


def kind_of(case: Case) -> Kind:
    """How the tension runs along the arc: where friction is to spare, as the string creeps.

    Raises SceneError where the scene does not determine the arc.
    """
    check_arc(case)
    if case.regime == "no-slip" and not (case.pulley_known or case.sign == 0):
        raise SceneError("M", None, f"is missing: {unmarked(NEEDS_M)}")
    spare = case.regime == "no-slip" and case.scene.mu is not None and not case.tensions_equal
    return "creep" if spare else "exponential"


def contact(answers: Answers, points: int | str = 13) -> Contact:
    """The arc of contact of a scene at so many equally spaced angles.

    Raises SceneError where the scene does not determine the arc.
    """
    kind = kind_of(answers.case)
    last = read_whole("points", points, 2, MAX_POINTS) - 1
    rows = [point(answers, kind, Fraction(j, last)) for j in range(last + 1)]
    balance = _balance(answers, kind)
    return Contact(kind, rows, balance, _notes(answers, kind, balance))


def point(answers: Answers, kind: Kind, q: Fraction) -> dict[str, Number]:
    """The columns at the fraction q of the arc, counted from m1's end."""
    scene, sign = answers.case.scene, answers.case.sign
    from_light = q if sign >= 0 else 1 - q
    piece = _piece(answers, kind, from_light)
    stuck = arc.STUCK[kind][piece] or answers.case.frictionless

    def tension(machine: Machine[Any]) -> Any:
        # Both ends are exact, and so is the string stuck to the pulley from the light end on.
        if from_light == 0 or (piece == 0 and stuck):
            return machine.light_tension
        if from_light == 1:
            return machine.heavy_tension
        angle = machine.ar.number(from_light) * machine.phi
        return arc.tension(machine.ar, machine.arcs(kind)[piece], angle)

    def friction(machine: Machine[Any]) -> Any:
        return machine.ar.number(0) if stuck else machine.arc_mu(kind) * tension(machine) * sign

    def per_metre(of: Callable[[Machine[Any]], Any]) -> Number:
        return answers.settle(lambda machine: of(machine) / _radius(machine))

    row = {
        "angle": answers.settle(lambda machine: scene.wrap.degrees(machine.ar, q)),
        "tension": answers.settle(tension),
        "normal_per_radian": answers.settle(tension),
        "friction_per_radian": answers.settle(friction),
    }
    if scene.R is not None:
        row |= {"normal_per_metre": per_metre(tension), "friction_per_metre": per_metre(friction)}
    return row


def _piece(answers: Answers, kind: Kind, from_light: Fraction) -> int:
    """Which piece of the profile holds the point at that fraction of the arc from the light end."""
    last = len(arc.STUCK[kind]) - 1
    for piece in range(last):

        def beyond(machine: Machine[Any], piece: int = piece) -> Any:
            angle = machine.ar.number(from_light) * machine.phi
            return angle - machine.arcs(kind)[piece].end.angle

        if not answers.is_positive(beyond):
            return piece
    return last


def _balance(answers: Answers, kind: Kind) -> dict[str, dict[str, Number]]:
    """The forces on the pulley (N) and torques (N m, or N per unit radius), along the arc and by the ends."""

    def vector(of: Callable[[Any], tuple[Any, Any]]) -> dict[str, Number]:
        return {"x": answers.settle(lambda m: of(m)[0]), "y": answers.settle(lambda m: of(m)[1])}

    friction = vector(lambda m: m.seen_from_m1(arc.friction(m.arcs(kind))))
    normal = vector(lambda m: m.seen_from_m1(arc.normal(m.arcs(kind))))
    ends = vector(lambda m: m.resultant_vector)
    together = {axis: _sum(answers, friction[axis], normal[axis]) for axis in "xy"}
    by_contact = answers.settle(
        lambda m: arc.torque_per_radius(m.ar, m.arcs(kind)) * _radius(m) * m.case.sign
    )
    by_ends = answers.settle(lambda m: m.tension_difference * _radius(m))
    return {
        "friction": friction,
        "normal": normal,
        "sum": together,
        "resultant": ends,
        "residual": {axis: _sum(answers, together[axis], ends[axis], -1) for axis in "xy"},
        "torque": {
            "contact": by_contact,
            "ends": by_ends,
            "residual": _sum(answers, by_contact, by_ends, -1),
        },
    }


def _radius(machine: Machine[Any]) -> Any:
    return machine.ar.number(machine.scene.R or Fraction(1))


def _sum(answers: Answers, a: Number, b: Number, sign: int = 1) -> Number:
    """a + sign·b of two printed numbers, exact but for its own rounding; infinite where one of them is."""
    if is_infinite(a) or is_infinite(b):
        return inf
    value: Number = answers.round(Fraction(a) + sign * Fraction(b))
    return value


def about(case: Case, kind: Kind) -> str:
    """How the tension runs along the arc, in a sentence."""
    without_mu = case.regime == "no-slip" and case.scene.mu is None
    return WITHOUT_FRICTION if case.frictionless else WITHOUT_MU if without_mu else ABOUT_KIND[kind]


def _notes(answers: Answers, kind: Kind, balance: dict[str, dict[str, Number]]) -> list[str]:
    notes = [about(answers.case, kind)]
    for name in ("tension_1", "tension_2"):
        if answers[name] is not None and name in answers.reasons:
            notes.append(f"{name}: {answers.reasons[name]}.")
    if any(balance[name][part] for name, part in RESIDUALS):
        notes.append(ROUNDING)
    return notes
