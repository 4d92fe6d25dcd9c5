"""A solved scene, and the forces along its arc, as tables and JSON show them."""

import sys
from collections import Counter
from collections.abc import Sequence
from decimal import Decimal
from itertools import groupby
from typing import TYPE_CHECKING

from ..explain.given import VERSION, inputs_with_effect, scene_record, terms_record
from ..explain.messages import measured_quantities, notes, reasons, reasons_in, remarks, unmarked, verdict
from ..numbers.digits import rounding_to_place, rounding_to_uncertainty, strip_zeros, with_uncertainty
from ..solver.answers import Answers
from ..solver.quantities import LIMITS_OF_ONE_MASS, MEASURED_NAMES, QUANTITIES, cited
from ..solver.scene import with_unit
from .page import Page
from .text import aligned, cell

if TYPE_CHECKING:
    from ..explain.contact import Contact


def record(answers: Answers, only: Sequence[str] = (), budget: bool = False) -> dict[str, object]:
    """Return the record for JSON: all quantities with scene and notes, or only the quantities named."""
    names = only or answers.names
    results: dict[str, object] = {name: answers[name] for name in names}
    uncertainty = _uncertainties(answers, names) or None
    shares = {name: answers.budget(name) or None for name in names if name != "regime"} if budget else None
    uncertain = {"uncertainty": uncertainty, "budget": shares}
    if only:
        return results | {key: values for key, values in uncertain.items() if values is not None}
    absent = dict.fromkeys(QUANTITIES)
    return {
        "version": VERSION,
        "scene": scene_record(answers.decided.scene, answers.round),
        "terms": terms_record(answers.decided.scene, answers.round),
        "found": [answers.decided.motion.finds] if answers.decided.motion.finds else [],
        "regime": answers["regime"],
        **absent,
        **results,
        **{key: values and absent | values for key, values in uncertain.items()},
        "notes": notes(answers, answers.names),
    }


def csv_record(answers: Answers, names: Sequence[str], budget: bool) -> dict[str, object]:
    """Return the record for CSV: values, then uncertainties, then each input's share of the variances."""
    values = {name: answers[name] for name in names}
    uncertainties = _uncertainties(answers, names)
    columns = [(name, given) for name in uncertainties for given in answers.uncertain if budget]
    shares = {f"budget_{name}_{given}": answers.budget(name).get(given) for name, given in columns}
    return values | {f"u_{name}": u for name, u in uncertainties.items()} | shares


def _uncertainties(answers: Answers, names: Sequence[str]) -> dict[str, object]:
    """Return the standard uncertainties of the quantities named, {} if all inputs are exact."""
    uncertain = [name for name in names if answers.uncertain and name != "regime"]
    return {name: answers.uncertainty(name) for name in uncertain}


def notes_on_stderr(answers: Answers, names: Sequence[str], values: bool) -> list[str]:
    """Return the sentences that CSV and bare values leave out on the quantities named, or on all.

    With ``values``, uncertain ones are said with their uncertainties.
    """
    assumed = Counter((name, why) for name, why in answers.decided.assumptions.items() if name in names)
    sentences = reasons_in(assumed, 1)
    sentences += [quantity_in_words(answers, name) for name in names if values and answers.uncertainty(name)]
    sentences += [f"{name} is in {answers.unit_of(name)}." for name in answers.units]
    sentences += map(unmarked, remarks(answers.to_six_digits))
    return sentences + reasons(answers, names or answers.names)


MAIN = ("acceleration", "tension_1", "tension_2", "mu_verge", "friction_force")
"""The quantities that every table of a scene shows."""


def main_quantities(answers: Answers) -> list[str]:
    """Return the names of the quantities that a table shows unless all are asked for."""
    decided, scene = answers.decided, answers.decided.scene
    if scene.lacking:
        return ["capstan_ratio", *(LIMITS_OF_ONE_MASS if decided.has_one_mass else ())]
    has_mu = scene.mu is not None
    bounded = has_mu and answers["friction_force"] is None
    also = {
        "friction_force_min": bounded,
        "friction_force_max": bounded,
        "axle_force": decided.has_axle_friction and decided.ends_hang_down,
        "torque": scene.R is not None,
        "rim_acceleration": decided.regime == "slip" and not decided.is_driven,
        **dict.fromkeys(("angular_acceleration", "final_angular_speed"), scene.R is not None),
        "critical_pulley_mass": has_mu and not decided.slips_by_tensions,
        "critical_heavier_mass": has_mu and decided.pulley_known,
        "critical_lighter_mass": has_mu and decided.slips_by_tensions,
        "safety_factor": has_mu and decided.pulley_known and not decided.tensions_equal,
        "least_wrap": has_mu and (decided.slips_by_tensions or not scene.wrap.is_half_turn),
    }
    return [name for name in answers.names[1:] if also.get(name, name in MAIN or name in MEASURED_NAMES)]


REGIME_STYLES = {"no-slip": "green", "verge": "yellow", "slip": "red", None: "yellow"}
COLUMNS = ("Quantity", "Value", "Unit", "Symbol", "Equation")
WHOSE = {"kinetic_energy": " (masses and pulley)"}
"""What is easily taken for that of the load alone."""


def print_table(
    page: Page, answers: Answers, only: Sequence[str] | bool = False, budget: bool = False
) -> None:
    """Print the scene, the verdict, the main quantities or ``only`` some (True: all), notes, the budget."""
    answers = answers.to_six_digits
    names = main_quantities(answers)
    if only:
        names = [name for name in answers.names[1:] if only is True or name in only]
    measured = measured_quantities(answers)
    groups = _rows(answers, [name for name in names if name not in (*MEASURED_NAMES, *measured)])
    found = [name for name in measured if cell(answers[name])]
    stated = ", ".join(quantity_in_words(answers, name) + WHOSE.get(name, "") for name in found)
    _print_head(page, answers, f"Found: {stated}." if stated else "")
    if groups:
        page.table(COLUMNS, groups)
    lacking = dict.fromkeys([*names, *measured])
    if cell(answers["friction_force_min"]):  # the table has the bounds
        lacking.pop("friction_force", None)
    page.say(*map(unmarked, remarks(answers)), *reasons(answers, list(lacking)))
    if budget:
        print_budget(page, answers, names)


def _print_head(page: Page, answers: Answers, measured: str = "") -> None:
    """Print the scene, a sentence on the quantities found from a motion, and the verdict."""
    given = inputs_with_effect(answers)
    page.say(", ".join(given.values()))
    if measured:
        page.say(measured, style="bold")
    page.say(unmarked(verdict(answers)), style=f"bold {REGIME_STYLES[answers['regime']]}")


def page_as_text(answers: Answers) -> str:
    """Return the page as text without colours, in the width and the characters of standard output."""
    page = Page(is_plain=True)
    with page.console.capture() as captured:
        print_table(page, answers)
    encoding = getattr(sys.stdout, "encoding", None) or "utf-8"
    return captured.get().rstrip("\n").encode(encoding, "replace").decode(encoding)


def _rows(answers: Answers, names: Sequence[str]) -> list[list[list[str]]]:
    """Return the cells of the table: a row for each quantity that exists, by group."""
    values = {name: shown for name in names if (shown := _with_uncertainty(answers, name))}
    groups: dict[str, list[list[str]]] = {}
    for name, value in zip(values, aligned(values.values()), strict=True):
        about, decided = QUANTITIES[name], answers.decided
        slips = answers["regime"] == "slip" and not decided.is_driven
        axle_enters = decided.has_axle_friction and not decided.slips_by_tensions
        equation = cited(name, slips, axle_enters, decided.is_driven)
        at_limit = name.startswith("friction_force") and decided.mu_assumed  # and has a single value then
        shown = f"{name} at mu_verge" if at_limit else name
        row = [shown, value, answers.unit_of(name), about.symbol, equation]
        groups.setdefault(about.group, []).append(row)
    return list(groups.values())


def quantity_in_words(answers: Answers, name: str) -> str:
    """Say a quantity with its value, uncertainty and unit."""
    return f"{name} = {with_unit(_with_uncertainty(answers, name), answers.unit_of(name))}"


def _with_uncertainty(answers: Answers, name: str) -> str:
    """Return a value, with its uncertainty if it has one; "" if it has no value."""
    shown = cell(answers[name])
    u = answers.uncertainty(name, 2) if shown else None
    if not u:
        return shown
    round_ = rounding_to_uncertainty(u)
    return with_uncertainty(answers.rounded(name, round_), round_(u))[0]


def print_budget(page: Page, answers: Answers, names: Sequence[str]) -> None:
    """Print each uncertain input's share of the variance of each quantity."""
    names = [name for name in names if name != "regime"]
    budgets = {name: shares for name in names if (shares := answers.budget(name, rounding_to_place(-1)))}
    if not budgets:
        return
    page.say("Each input's share of the variance, in percent:")
    columns = [aligned(str(shares[given]) for shares in budgets.values()) for given in answers.uncertain]
    rows = ([name, *cells] for name, *cells in zip(budgets, *columns, strict=True))
    by_group = groupby(rows, lambda row: QUANTITIES[row[0]].group)
    page.table(["Quantity", *answers.uncertain], [list(group) for _, group in by_group])


def print_steps(page: Page, answers: Answers, names: Sequence[str]) -> None:
    """Print the derivation of these quantities, or of all."""
    from ..explain.derivation import explain
    from .typeset import print_explanation

    print_explanation(page, inputs_with_effect(answers).values(), explain(answers, names))


# The arc of contact

HEADS = {
    "angle": "angle ({})",
    "tension": "tension T = nR ({})",
    "normal_per_radian": "normal nR ({}/rad)",
    "friction_per_radian": "friction fR ({}/rad)",
    "normal_per_metre": "normal n ({}/m)",
    "friction_per_metre": "friction f ({}/m)",
}
"""The headings of a point's columns, for their units."""
FORCES = {"friction": "friction", "normal": "normal force", "sum": "sum"}
"""The forces in the balance, in words."""


def contact_record(answers: Answers, arc: "Contact") -> dict[str, object]:
    """Return the record of an arc for JSON."""
    return {
        "version": VERSION,
        "scene": scene_record(answers.decided.scene, round_=answers.round),
        "regime": answers.decided.regime,
        "profile": arc.kind,
        "points": [{name: point.get(name) for name in arc.units} for point in arc.points],
        "balance": arc.balance,
        "notes": [unmarked(verdict(answers)), *arc.notes],
    }


def print_contact(page: Page, answers: Answers, arc: "Contact", tables: bool) -> None:
    """Print the scene, the verdict, with ``tables`` the forces along the arc and their sum, and the notes."""
    _print_head(page, answers)
    if not tables:
        page.say(*arc.notes)
        return
    # The normal force by angle is the tension, (13).
    is_double = arc.units.get("tension") == arc.units.get("normal_per_radian")
    columns = {}
    for name in [x for x in arc.points[0] if x != "normal_per_radian" or not is_double]:
        values = [point[name] for point in arc.points]
        numbers = [strip_zeros(Decimal(value)) for value in values] if name == "angle" else values
        columns[HEADS[name].format(arc.units[name])] = aligned(map(cell, numbers))
    page.table(list(columns), [list(zip(*columns.values(), strict=True))])
    forces = {words: arc.balance[name] for name, words in FORCES.items()}
    forces["compare: T1 + T2 as vectors"] = arc.balance["resultant"]
    xs, ys = (aligned(cell(force[axis]) for force in forces.values()) for axis in "xy")
    force_rows = list(zip(forces, xs, ys, strict=True))
    heads = ["Force of the string on the pulley", "x towards m1 (N)", "y upwards (N)"]
    page.table(heads, [force_rows[:2], force_rows[2:3], force_rows[3:]])
    page.say(f"The magnitude of the sum is {cell(arc.balance['resultant']['magnitude'])} N.")
    torques = aligned(map(cell, arc.balance["torque"].values()))
    head, ends = ("Torque on the pulley / R (N)", "T2 - T1")
    if answers.decided.scene.R is not None:
        head, ends = ("Torque on the pulley (N m)", "R (T2 - T1)")
    page.table([head, ""], [[("friction along the arc", torques[0])], [(f"compare: {ends}", torques[1])]])
    page.say(*arc.notes)
