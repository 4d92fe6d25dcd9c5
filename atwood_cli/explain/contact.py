"""The forces along the arc of contact, and their sum: the paper's sections 2 to 4 for a scene.

The string acts on the pulley only along the arc: with the normal force nR = T (13) and the friction
fR = dT/dθ (12), both per radian. Their integrals equal the force (20) and the torque (23) that T1 and T2
would exert if they acted on the pulley themselves. Both sides are computed here, each by itself and rounded
correctly, so their digits agree.
"""

from collections.abc import Callable, Collection
from decimal import Decimal
from fractions import Fraction
from typing import Any, Literal, NamedTuple

from ..numbers.digits import format_number, rounding_to_place
from ..numbers.settling import is_positive
from ..reading.inputs import read_whole
from ..solver import arc, physics
from ..solver.answers import Answers
from ..solver.arc import Profile
from ..solver.decisions import Decisions
from ..solver.machine import Machine
from ..solver.scene import SceneError
from .messages import reasons, remarks, unmarked

Rounded = float | Decimal

USUAL_POINTS, MAX_POINTS = 13, 100_000
POINT = {"angle": "°"} | dict.fromkeys(
    "tension normal_per_radian friction_per_radian normal_per_metre friction_per_metre".split(), "N"
)
"""What is computed at a point of the arc, with its unit, or that of its product with a radian or a metre."""
ZERO_DIGITS = 50
"""The digits of a sum that must be 0 if it is to be 0."""

CREEP = (
    "The tension is not unique while the string grips with friction to spare. Shown is that of a slightly"
    " elastic string: friction is at its limit on the {angle}° of the arc next to the greater tension, and 0"
    " elsewhere."
)
WITHOUT_MU = "mu is not given: the forces shown are for the least mu that holds."
WITHOUT_FRICTION = "Both tensions are equal: there is no friction."


class Contact(NamedTuple):
    """The arc of contact: its profile, its points, the units of their columns, the balance, and notes."""

    kind: Profile
    points: list[dict[str, Rounded]]
    units: dict[str, str]
    balance: dict[str, dict[str, Rounded]]
    notes: list[str]


def kind_of(decided: Decisions) -> Profile:
    """Return the profile of the tension along the arc: with friction to spare, the string creeps.

    Raises SceneError if the scene does not determine the arc.
    """
    if not decided.light:
        raise SceneError(
            "m1" if decided.scene.m1 == 0 else "m2",
            0,
            "leaves no arc of contact, as that end is fixed to the pulley; give both masses above 0",
        )
    if decided.regime == "no-slip" and not (decided.pulley_known or decided.heavier_side == 0):
        raise SceneError("M", None, "is missing: the forces depend on the pulley's mass; give M")
    spare = decided.regime == "no-slip" and decided.scene.mu is not None and not decided.tensions_equal
    return "creep" if spare else "exponential"


def contact(answers: Answers, points: int | str = USUAL_POINTS, columns: Collection[str] = POINT) -> Contact:
    """Solve the arc of contact of a scene at so many equally spaced angles.

    Raises SceneError if the scene does not determine the arc.
    """
    kind, units = kind_of(answers.decided), {x: unit.in_words for x, unit in answers.units.items()}
    last = read_whole("points", points, 2, MAX_POINTS) - 1
    rows = [point(answers, kind, Fraction(j, last), columns) for j in range(last + 1)]
    notes = [say_profile(answers, kind), *map(unmarked, remarks(answers.to_six_digits))]
    notes += reasons(answers, ("tension_1", "tension_2"))
    notes += [f"{name} is in {unit}." for name, unit in units.items()]
    return Contact(kind, rows, {x: units.get(x, POINT[x]) for x in columns}, _balance(answers, kind), notes)


def point(answers: Answers, kind: Profile, q: Fraction, columns: Collection[str]) -> dict[str, Rounded]:
    """Return columns, as far as they exist, at the fraction q of the arc, counted from m1's end."""
    scene, sign = answers.decided.scene, answers.decided.heavier_side
    from_light = q if sign >= 0 else 1 - q

    def beyond_the_stuck_piece(machine: Machine[Any]) -> Any:
        return machine.ar.number(from_light) * machine.phi - machine.arcs(kind)[0].end.angle

    stuck = answers.decided.frictionless or (
        kind == "creep" and not is_positive(answers.in_any_arithmetic(beyond_the_stuck_piece))
    )

    def tension(machine: Machine[Any]) -> Any:
        # Tensions at both ends are exact, and so is that of a piece stuck from the light end on.
        if from_light == 0 or stuck:
            return machine.light_tension
        if from_light == 1:
            return machine.heavy_tension
        angle = machine.ar.number(from_light) * machine.phi
        return arc.tension(machine.ar, machine.arcs(kind)[-1], angle)

    def friction(machine: Machine[Any]) -> Any:
        return machine.ar.number(0) if stuck else machine.arc_mu(kind) * tension(machine) * sign

    laws: dict[str, Callable[[Machine[Any]], Any]] = {
        "angle": lambda machine: scene.wrap.degrees(machine.ar, q),
        **{"tension": tension, "normal_per_radian": tension, "friction_per_radian": friction},
    }
    if scene.R is not None:
        laws["normal_per_metre"] = lambda m: tension(m) / _radius(m)
        laws["friction_per_metre"] = lambda m: friction(m) / _radius(m)
    return {x: answers.settle(answers.in_its_unit(x, laws[x])) for x in columns if x in laws}


def _balance(answers: Answers, kind: Profile) -> dict[str, dict[str, Rounded]]:
    """Return forces on the pulley (N) and torques (N m, or N per unit radius), by the arc and by T1, T2."""

    def vector(of: Callable[[Any], tuple[Any, Any]]) -> dict[str, Rounded]:
        return {"x": answers.settle(lambda m: of(m)[0]), "y": answers.settle(lambda m: of(m)[1])}

    def along_the_arc(law: Callable[..., tuple[Any, Any]]) -> Callable[[Machine[Any]], tuple[Any, Any]]:
        return lambda m: m.seen_from_m1(arc.force(m.arcs(kind), law))

    friction, normal = along_the_arc(physics.friction_vector), along_the_arc(physics.normal_vector)
    forces = {"friction": vector(friction), "normal": vector(normal)}
    ends = vector(lambda m: m.resultant_vector)
    magnitude = {"magnitude": answers.settle(lambda m: m.resultant_magnitude)}

    def total(axis: str, place: Literal[0, 1]) -> Rounded:
        """Return a component of the sum, rounded once.

        If it is 0, as that of both ends, its enclosures have other numbers in them, too, however narrow they
        are. It is then 0 if `ZERO_DIGITS` digits of it, counted from those of its terms, are.
        """
        term, end = forces["friction"][axis], ends[axis]
        round_ = rounding_to_place(Decimal(str(term)).adjusted() - ZERO_DIGITS) if term and not end else None
        rounded = answers.settle(lambda m: friction(m)[place] + normal(m)[place], round_)
        return rounded if rounded else end  # a 0 of the type that was asked for

    torque = {
        "contact": answers.settle(
            lambda m: arc.torque_per_radius(m.ar, m.arcs(kind)) * _radius(m) * m.decided.heavier_side
        ),
        "ends": answers.settle(lambda m: m.tension_difference * _radius(m)),
    }
    return {
        **forces,
        "sum": {"x": total("x", 0), "y": total("y", 1)},
        "resultant": ends | magnitude,
        "torque": torque,
    }


def _radius(machine: Machine[Any]) -> Any:
    return machine.ar.number(machine.scene.R or Fraction(1))


def say_profile(answers: Answers, kind: Profile) -> str:
    """Return the sentence on a profile of the tension."""
    if answers.decided.frictionless:
        return WITHOUT_FRICTION
    if answers.decided.mu_assumed:
        return WITHOUT_MU
    if kind == "creep":
        return CREEP.format(angle=format_number(answers.to_six_digits["least_wrap"]))
    mu = "mu_k" if answers.decided.slides_by_mu_k or answers.decided.slide_measured else "mu"
    return f"Friction is at its limit, {mu} n, all along the arc."
