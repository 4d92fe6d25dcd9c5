"""The registry: every quantity's name, symbol, unit, equation and meaning, once."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from decimal import Decimal
from itertools import chain
from typing import Any, Generic, NamedTuple, TypeVar

from .scene import Scene

T = TypeVar("T", float, Decimal)

REGIMES = ("no-slip", "verge", "slip")


class About(NamedTuple):
    """How a quantity is shown, and the paper's equation for it, if it has one."""

    group: str
    symbol: str
    unit: str
    equation: str
    meaning: str
    equation_in_slip: str | None = None


def quantity(*about: str) -> Any:
    return field(default=None, metadata={"about": About(*about)})


@dataclass(frozen=True, slots=True, kw_only=True)
class Solution(Generic[T]):
    """The state of a scene: floats, or Decimals if digits were asked for; None if undetermined.

    ``scene`` is what was given, ``notes`` say why the regime is what it is and why a value is None.
    ``uncertainty`` has the standard uncertainty of every quantity by name, and is empty if all that
    was given is exact; one is None, with a note, where there is none to first order.
    Forces are on the pulley, x from the axle to where m1's string meets it, y up; accelerations,
    torque and angles are positive the way m2 descends.
    """

    scene: Scene
    notes: tuple[str, ...]
    regime: str
    # fmt: off
    acceleration: T | None = quantity("motion", "a", "m/s²", "(4)", "acceleration, positive when m2 descends", "(1), (26)")
    tension_1: T | None = quantity("motion", "T₁", "N", "(4)", "tension of the string at m1", "(1), (26)")
    tension_2: T | None = quantity("motion", "T₂", "N", "(4)", "tension of the string at m2", "(1), (26)")
    mu_verge: T | None = quantity("friction", "μ*", "", "(27)", "friction coefficient below which the string slips")
    friction_force: T | None = quantity("friction", "F", "N", "(32)", "net friction force on the pulley")
    friction_force_min: T | None = quantity("friction", "F min", "N", "", "least net friction force of a string that grips")
    friction_force_max: T | None = quantity("friction", "F max", "N", "", "greatest net friction force of a string that grips")
    friction_force_x: T | None = quantity("friction", "Fx", "N", "(31)", "net friction force, towards m1's side")
    friction_force_y: T | None = quantity("friction", "Fy", "N", "(31)", "net friction force, upwards")
    axle_force: T | None = quantity("pulley", "A", "N", "(20)", "force on the axle, with the pulley's weight")
    torque: T | None = quantity("pulley", "τ", "N m", "(23)", "torque of the string on the pulley")
    rim_acceleration: T | None = quantity("pulley", "a rim", "m/s²", "(3)", "acceleration of the pulley's rim")
    angular_acceleration: T | None = quantity("pulley", "α", "rad/s²", "(2)", "angular acceleration of the pulley")
    critical_pulley_mass: T | None = quantity("limits", "M*", "kg", "(34)", "pulley mass above which the string slips")
    critical_heavier_mass: T | None = quantity("limits", "m*", "kg", "(35)", "heavier mass above which the string slips")
    least_heavier_mass: T | None = quantity("limits", "m min", "kg", "(36)", "what the heavier mass must exceed to slip")
    least_pulley_mass: T | None = quantity("limits", "M min", "kg", "(36)", "what the pulley's mass must exceed to slip")
    # fmt: on
    uncertainty: Mapping[str, T | None] = field(default_factory=dict, hash=False)


def abouts(solution: type[Solution[Any]]) -> dict[str, About]:
    """How the quantities of a kind of solution are shown, by name."""
    return {f.name: f.metadata["about"] for f in fields(solution) if "about" in f.metadata}


QUANTITIES = abouts(Solution)
NAMES = ("regime", *QUANTITIES)
FOUND: dict[str | None, tuple[str, ...]] = {
    "M": ("pulley_mass", "moment_of_inertia"),
    "g": ("gravity",),
    "drop": ("fall_time", "final_speed"),
}
"""Quantities that only some scenes have, by the parameter that is found there, or given."""
FOUND_NAMES = tuple(chain.from_iterable(FOUND.values()))


def about(name: str) -> About:
    """How a quantity is shown, whether every scene has it or only some."""
    if name in QUANTITIES:
        return QUANTITIES[name]
    from .motion import MeasuredSolution

    return abouts(MeasuredSolution)[name]


STANDARD = (
    "regime",
    "acceleration",
    "tension_1",
    "tension_2",
    "mu_verge",
    "friction_force",
    "critical_pulley_mass",
)
"""The quantities of many scenes in a table, unless others are named."""
