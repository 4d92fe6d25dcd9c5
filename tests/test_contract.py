"""What a version promises to those who build on it: an entry may be added, but none goes or changes its meaning."""

import json
from collections.abc import Callable, Iterable
from dataclasses import fields
from inspect import Signature, signature
from typing import Any

import pytest
import typer

import atwood_cli
from atwood_cli import Fit, Scene, Solution, fit, solve, solve_arrays, solve_table
from atwood_cli.__main__ import INTERRUPTED
from atwood_cli.cli import COMMANDS, program
from atwood_cli.cli.options import COULD_NOT, DONE, WRONG_USAGE
from atwood_cli.solver.quantities import NAMES, QUANTITIES
from atwood_cli.solver.scene import FINDABLE

from .tools import oracle
from .tools.running import TOP, Atwood, Batch

PROGRAM: dict[str, Any] = program().commands
VALUES = """
    acceleration tension_1 tension_2 tension_difference mu_verge safety_factor tension_ratio capstan_ratio friction_force
    friction_force_min friction_force_max friction_force_x friction_force_y axle_force torque rim_acceleration
    angular_acceleration critical_pulley_mass critical_heavier_mass critical_lighter_mass least_heavier_mass
    least_pulley_mass least_wrap pulley_mass moment_of_inertia gravity m1 m2 mu_k axle axle_torque drive_force drive_torque drive_power drop fall_time final_speed
    final_angular_speed kinetic_energy"""
SCENE = "m1 m2 M mu mu_k g inertia I R wrap axle"
FITTED = """rim_mass axle gravity delay pulley_mass moment_of_inertia uncertainty interval correlation chi2 dof
    interval_dof between_runs between_runs_unit runs notes"""
RIT = TOP / "examples" / "rit.csv"
JSON = {
    "solve --m1 1 --m2 3": f"version scene terms found regime {VALUES} uncertainty budget notes",
    "sweep --m1 1:2:2 --m2 3": "version scene rows notes",
    "contact --m1 1 --m2 3": "version scene regime profile points balance notes",
    f"fit {RIT} --drop 98cm": f"version {FITTED}",
}
"""The keys of JSON at its top; `test_json` has the keys below."""
ON_PAPER, DRAWN = "json csv markdown output force", "figure bare symbols"
GIVEN = f"{SCENE} drop time speed".replace("_", "-")
OPTIONS = {
    "solve": f"{GIVEN} a find only expect all digits budget explain {ON_PAPER} {DRAWN}",
    "sweep": f"{GIVEN} only expect digits {ON_PAPER} {DRAWN}",
    "contact": f"{SCENE.replace('_', '-')} only points digits {ON_PAPER} {DRAWN}",
    "fit": f"drop m1 m2 hanger g M inertia I R axle find without columns column label sheet only {ON_PAPER} {DRAWN}",
    "batch": f"{GIVEN} from columns column label sheet only expect digits markdown allow-errors output force",
    "quantities": ON_PAPER,
    "tradeoff": f"family scenes json output force {DRAWN}",
}


def parameters(function: Callable[..., Any]) -> list[str]:
    """Return its parameters as they are written, without types, and `?` for those that are None if not given."""
    bare = [one.replace(annotation=one.empty) for one in signature(function).parameters.values()]
    return str(Signature(bare))[1:-1].replace("=None", "?").split(", ")


PYTHON: dict[str, tuple[Iterable[str], str]] = {
    "atwood_cli": (
        atwood_cli.__all__,
        "Solution solve STATUSES solve_arrays solve_table REGIMES Fit fit Scene SceneError QUANTITIES",
    ),
    "solve": (
        parameters(solve),
        "m1? m2? * M? mu? mu_k? g? inertia? I? R? wrap? axle? a? drop? time? speed? find? digits?",
    ),
    "solve_arrays": (
        parameters(solve_arrays),
        "m1 m2 M? mu? mu_k? * g? inertia? I? R? wrap=180.0 axle? drop? time? speed? accuracy='certified' quantities?",
    ),
    "solve_table": (parameters(solve_table), "table quantities?"),
    "fit": (
        parameters(fit),
        "runs * drop? m1? m2? hanger? g? M? inertia? I? R? axle? find? without=() columns? sheet?",
    ),
    "Solution": ([one.name for one in fields(Solution)], f"scene notes regime {VALUES} uncertainty"),
    "Scene": (Scene._fields, f"{SCENE} motion terms"),
    "Fit": (Fit._fields, FITTED),
    "REGIMES": (atwood_cli.REGIMES, "no-slip verge slip"),
    "STATUSES": (
        [status.replace(" ", "_") for status in atwood_cli.STATUSES],
        """valid m1 m2 M mu mu_k g inertia R wrap no_mass friction_at_a_free_end mu_k_without_mu mu_k_above_mu
        NaN I axle I_and_inertia I_without_R I_with_M_=_0_or_inf drop time speed two_of_drop,_time_and_speed""",
    ),
    "commands": (COMMANDS, "solve sweep contact fit batch quantities tradeoff"),
    "find": (FINDABLE, "m1 m2 M g mu_k axle drive"),
    "quantities": (QUANTITIES, VALUES),
    "quantities of every scene": (sorted(oracle.NAMES), " ".join(sorted(NAMES))),
}


@pytest.mark.parametrize("name", PYTHON)
def test_what_a_version_promises_to_python(name: str) -> None:
    has, promised = PYTHON[name]
    assert [*has] == promised.split()


@pytest.mark.parametrize("command", OPTIONS)
def test_what_a_version_promises_of_options(command: str) -> None:
    params = PROGRAM[command].get_params(typer.Context(PROGRAM[command]))
    has = {name.removeprefix("--") for one in params for name in one.opts[:1] if name.startswith("--")}
    assert has == {*OPTIONS[command].split(), "help"}


@pytest.mark.parametrize("words", JSON)
def test_what_a_version_promises_in_json(atwood: Atwood, words: str) -> None:
    assert [*json.loads(atwood(*words.split(), "--json").out)] == JSON[words].split()


def test_what_a_version_promises_of_statuses_and_csv(atwood: Atwood, batch: Batch) -> None:
    assert (DONE, COULD_NOT, WRONG_USAGE, INTERRUPTED) == (0, 1, 2, 130)
    scene = ["--m1", "1", "--m2", "3"]
    assert atwood("solve", *scene).status == DONE
    assert atwood("solve", *scene, "--expect", "slip").status == COULD_NOT
    assert atwood("solve", "--m1", "-1", "--m2", "3").status == WRONG_USAGE
    main = "acceleration,tension_1,tension_2,mu_verge,friction_force,critical_pulley_mass"
    swept = atwood("sweep", "--m1", "1:2:2", "--m2", "3", "--csv", "--expect", "a<9")
    assert swept.out.split()[0] == f"m1,regime,{main},expected"
    judged = batch("1,3,2\n", "--columns m1,m2,M --only a --expect a<9")
    assert judged.out == "m1,m2,M,acceleration,expected,error\n1,3,2,3.92266,true,\n"
    in_units = atwood("solve", *scene, "--only", "T2 in lbf", "--csv").out
    assert in_units == "tension_2\n3.3069339327731635\n"
