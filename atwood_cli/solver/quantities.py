"""Every quantity, once: name, symbol, unit, equation, meaning; why one has no value; names as typed."""

from itertools import chain
from typing import Literal, NamedTuple, get_args


class Undetermined(Exception):
    """The scene does not determine a quantity; the message says why and what to give.

    Backticks mark names, and the word "give", which LaTeX output replaces by symbols and words. Other output
    takes them out (`explain.messages.unmarked`).
    """


Regime = Literal["no-slip", "verge", "slip"]
REGIMES: tuple[Regime, ...] = get_args(Regime)
Accuracy = Literal["certified", "exact"]
ACCURACIES: tuple[Accuracy, ...] = get_args(Accuracy)
"""The accuracies of arrays."""


class About(NamedTuple):
    """How a quantity is shown, and the paper's equation for it, "" if it has none.

    ``in_equations`` is the symbol that equations write, unless that is the usual one with plain digits.
    ``axis`` are the words on an axis, unless those are the quantity's name.
    """

    group: str
    symbol: str
    unit: str
    equation: str
    meaning: str
    equation_in_slip: str | None = None
    in_equations: str = ""
    axis: str = ""

    @property
    def letters(self) -> str:
        """The symbol as equations write it: T1, F_x."""
        return self.in_equations or self.symbol.translate(PLAIN_DIGITS)


PLAIN_DIGITS = str.maketrans("₁₂", "12")


# fmt: off
QUANTITIES = {
    "acceleration": About("motion", "a", "m/s²", "(4)", "acceleration, positive when m2 descends", "(1), (26)"),
    "tension_1": About("motion", "T₁", "N", "(4)", "tension of the string at m1", "(1), (26)"),
    "tension_2": About("motion", "T₂", "N", "(4)", "tension of the string at m2", "(1), (26)"),
    "tension_difference": About("motion", "T₂ - T₁", "N", "(3)", "difference of the tensions", "(26)"),
    "mu_verge": About("friction", "μ*", "", "(27)", "friction coefficient below which the string slips", axis="verge coefficient"),
    "safety_factor": About("friction", "μ/μ*", "", "", "ratio of friction coefficients, mu over mu_verge; below 1 it slips"),
    "tension_ratio": About("friction", "r", "", "(33)", "ratio of the tensions, the greater over the lesser", "(26)"),
    "capstan_ratio": About("friction", "k", "", "(26)", "greatest ratio of tensions that friction holds"),
    "friction_force": About("friction", "F", "N", "(32)", "magnitude of the vector sum of friction along the arc"),
    "friction_force_min": About("friction", "F min", "N", "", "least friction_force while the string grips", axis="least friction force"),
    "friction_force_max": About("friction", "F max", "N", "", "greatest friction_force while the string grips", axis="greatest friction force"),
    "friction_force_x": About("friction", "Fx", "N", "(31)", "component of friction_force towards m1's side", None, "F_x", "horizontal friction force"),
    "friction_force_y": About("friction", "Fy", "N", "(31)", "component of friction_force upwards", None, "F_y", "vertical friction force"),
    "axle_force": About("pulley", "A", "N", "(20)", "force on the axle, with the pulley's weight"),
    "torque": About("pulley", "τ", "N m", "(23)", "torque of the string on the pulley"),
    "rim_acceleration": About("pulley", "a rim", "m/s²", "(3)", "acceleration of the pulley's rim", None, "a_rim"),
    "angular_acceleration": About("pulley", "α", "rad/s²", "(2)", "angular acceleration of the pulley"),
    "critical_pulley_mass": About("limits", "M*", "kg", "(34)", "pulley mass above which the string slips"),
    "critical_heavier_mass": About("limits", "m*", "kg", "(35)", "heavier mass above which the string slips"),
    "critical_lighter_mass": About("limits", "l*", "kg", "", "lighter mass below which the string slips"),
    "least_heavier_mass": About("limits", "m min", "kg", "(36)", "heavier mass up to which the string holds on any pulley"),
    "least_pulley_mass": About("limits", "M min", "kg", "(36)", "critical_pulley_mass if the heavier mass were infinite"),
    "least_wrap": About("limits", "φ*", "°", "(27)", "angle of wrap below which the string slips"),
    # Of a scene whose motion was measured:
    "pulley_mass": About("measured", "M", "kg", "(4)", "pulley mass that gives the measured acceleration"),
    "moment_of_inertia": About("pulley", "I", "kg m²", "", "moment of inertia of the pulley"),
    "gravity": About("measured", "g", "m/s²", "(4)", "gravity that gives the measured acceleration"),
    "m1": About("measured", "m₁", "kg", "(1), (3)", "mass m1 that gives the measured acceleration"),
    "m2": About("measured", "m₂", "kg", "(1), (3)", "mass m2 that gives the measured acceleration"),
    "mu_k": About("measured", "μ kin", "", "(26)", "mu_k that gives the measured acceleration", None, "μ_k"),
    "axle": About("measured", "f", "N", "", "axle friction that gives the measured acceleration", in_equations="f_axle"),
    "axle_torque": About("measured", "τ axle", "N m", "", "the same as a torque", in_equations="τ_axle"),
    "drive_force": About("measured", "F drive", "N", "(3)", "force of a motor or brake at the rim, positive if it helps m2 down", None, "F_drive"),
    "drive_torque": About("measured", "τ drive", "N m", "", "the same as a torque", in_equations="τ_drive"),
    "drive_power": About("measured", "P drive", "W", "", "power of the drive at the final speed; that of a brake is below 0", in_equations="P_drive"),
    "drop": About("measured", "s", "m", "", "height of the fall from rest"),
    "fall_time": About("measured", "t", "s", "", "time of that fall"),
    "final_speed": About("measured", "v", "m/s", "", "speed at its end"),
    "final_angular_speed": About("measured", "ω", "rad/s", "", "angular speed of the pulley at its end"),
    "kinetic_energy": About("measured", "E kin", "J", "", "kinetic energy of masses and pulley at its end", in_equations="E_kin"),
}
# fmt: on

AXLE_ENTERS = {
    *("acceleration", "tension_1", "tension_2", "tension_difference", "tension_ratio", "rim_acceleration"),
    *("critical_pulley_mass", "critical_heavier_mass", "least_pulley_mass"),
    *("pulley_mass", "gravity", "m1", "m2"),
}
"""The quantities whose equation has an additional term if the axle has friction."""


def cited(name: str, slips: bool, has_axle_friction: bool, is_driven: bool) -> str:
    """Return the paper's equation for a quantity in a regime, and say if axle friction adds a term."""
    about = QUANTITIES[name]
    if is_driven and about.group == "motion":
        return "(1)"
    if slips and about.equation_in_slip is not None:
        return about.equation_in_slip
    return f"{about.equation} with axle" if has_axle_friction and name in AXLE_ENTERS else about.equation


FROM_MOTION: dict[str | None, tuple[str, ...]] = {
    "M": ("pulley_mass",),
    "g": ("gravity",),
    "m1": ("m1",),
    "m2": ("m2",),
    "mu_k": ("mu_k",),
    "axle": ("axle", "axle_torque"),
    "drive": ("drive_force", "drive_torque", "drive_power"),
    "fall": ("drop", "fall_time", "final_speed", "final_angular_speed", "kinetic_energy"),
}
"""The quantities that only a measurement gives: by the input that it finds, or of a fall."""
MEASURED_NAMES = tuple(chain.from_iterable(FROM_MOTION.values()))
NAMES = ("regime", *(name for name in QUANTITIES if name not in MEASURED_NAMES))
"""The quantities that every scene has."""
LIMITS_OF_ONE_MASS = ("critical_lighter_mass", "critical_heavier_mass")
"""The least and the greatest mass that the string holds beside a given one."""
OF_ONE_MASS = "capstan_ratio least_heavier_mass least_pulley_mass moment_of_inertia".split()
NEED_BOTH_MASSES = {*NAMES} - {*LIMITS_OF_ONE_MASS, *OF_ONE_MASS}
"""What no scene has that lacks a mass."""
TABLE_NAMES = (*NAMES, *FROM_MOTION["fall"])
"""The quantities of many scenes: those of every scene, and of a fall."""
UNITS = {"regime": ""} | {name: about.unit for name, about in QUANTITIES.items()}
"""All quantities with their units."""
STANDARD = (*"regime acceleration tension_1 tension_2 mu_verge friction_force critical_pulley_mass".split(),)
"""The quantities of many scenes in a table, unless others are named."""

# Why a scene does not determine a quantity, and what to give.

NEEDS_MASSES = "`give` both masses, `m1` and `m2`"
NEEDS_MU = "`give` `mu`, the friction coefficient"
NEEDS_M = "`give` `M`, the pulley's mass"
NEEDS_R = "`give` `R`, the pulley's radius"
UNKNOWN_SHAPE = "`give` `M`, the pulley's mass, with `I`"
FIXED_END = "not defined, as the string's end is fixed to the pulley and no friction holds it"
NOT_BOUNDED = "not unique while the string grips; as the wrap exceeds half a turn, no bounds are known"
NOT_DEFINITE = "not unique while the string grips; `friction_force_min` and `friction_force_max` bound its magnitude if friction nowhere reverses along the arc"
DEFINITE = "no value, as `friction_force` is unique"
LONG_WRAP = "known only up to half a turn of wrap (180 degrees)"
NO_CRITICAL_MASS = "no value, as the string holds on any pulley, however heavy"
NO_CRITICAL_HEAVIER_MASS = "no value, as on this pulley the string holds, whatever the heavier mass"
AXLE_HOLDS = "no value, as the axle holds the difference on any pulley"
ALWAYS_SLIPS = "no value, as axle friction makes the string slip on any pulley, however light"
AXLE_ENOUGH = "no value, as with axle friction the string slips on every pulley, under some heavier mass"
NO_NEED = "no value, as no friction is needed"
NO_WRAP = "no value, as without friction no wrap holds"
LOCKED_AXLE = "no value, as the weight of a pulley with `M` = `inf` is not known; atwood contact has the force of the string"
LOCKED_I = "no value, as the inertia of a pulley with `M` = `inf` is not known"
ONE_SIDED = "not computed unless both ends pull downwards (half a turn of wrap, plus whole turns); atwood contact has the force of the string"
NEEDS_MOTION = "`give` `a`, or two of `drop`, `time` and `speed`, {}"
FINDS_ANOTHER = "no value, as the motion finds `{}`; it finds one unknown at a time"
TO_FIND: dict[str, str] = {
    "g": "without `g` and `mu`",
    **{
        x: f"without `{x}` and `mu`; see also `critical_lighter_mass` and `critical_heavier_mass`"
        for x in ("m1", "m2")
    },
    "M": "without `M`, `I` and `mu`; see also `critical_pulley_mass`",
    "mu_k": "with `M` = `inf`, or with `M` and a `mu` that is too small",
    "axle": "without `mu`, and find `axle`",
    "drive": "and find the drive",
}
"""What a measured motion needs besides, by what it is to find."""
WOULD_SLIP = "no value, as the string would slip at this motion"
ANY_DRIVEN = "no value, as the mass of a driven pulley does not decide whether the string slips"
EITHER_WAY = "not unique, as axle friction opposes the motion, which `a` = 0 does not tell"
NEEDS_FALL = (
    "`give` `drop`, the height that the heavier mass falls from rest, or `time` or `speed` of that fall"
)
NEEDS_SPEED = "`give` `speed`"
AT_REST = "no value, as the acceleration is 0"
SLOWS_DOWN = "no value, as the masses slow down and do not start from rest"
