"""What is given decides the scene: every line and corner of the contract, through `solve`."""

import json
import pickle
import pydoc
import re
from collections.abc import Callable, Iterable
from contextlib import suppress
from copy import copy, deepcopy
from dataclasses import fields
from decimal import Context, Decimal, localcontext
from fractions import Fraction
from inspect import Signature, signature
from pathlib import Path
from runpy import run_path
from typing import Any

import pytest

import atwood_cli
from atwood_cli import Fit, Scene, SceneError, Solution, fit, solve, solve_arrays, solve_table
from atwood_cli.__main__ import INTERRUPTED
from atwood_cli.cli import COMMANDS
from atwood_cli.cli.options import COULD_NOT, DONE, WRONG_USAGE
from atwood_cli.solver.machine import Machine
from atwood_cli.solver.quantities import NAMES, QUANTITIES, STANDARD

from .tools import oracle
from .tools.running import TOP, Atwood, process
from .tools.scenes import inputs, table

# The table of what is given, and its corners

GROUPS = {
    "moving": "acceleration tension_1 tension_2 rim_acceleration",
    "friction": "mu_verge friction_force friction_force_min friction_force_max friction_force_x friction_force_y",
    "conditions": "least_heavier_mass least_pulley_mass",
    "critical": "critical_pulley_mass",
}
CORNERS = (Path(__file__).parent / "cases" / "corners.md").read_text(encoding="utf-8").split("```")[1]


@pytest.mark.parametrize("corner", table(CORNERS)[1:])
def test_what_is_given_decides_what_follows(corner: list[str]) -> None:
    given, expected, note = (*corner, "")[:3]
    solution = solve(**inputs(given))
    for name, value in (word.split("=") for word in expected.split()):
        for one in GROUPS.get(name, name).split():
            wanted = value if name == "regime" else None if value == "None" else float(value)
            assert getattr(solution, one) == wanted, one
    assert note in " ".join(solution.notes)


@pytest.mark.parametrize("masses", ["m1=1", "m1=3 m2=1", "m2=1.1", "m1=7 m2=2.9", "m1=0.1 m2=0.3"])
def test_about_the_greatest_acceleration_that_an_error_names_is_taken(masses: str) -> None:
    given = inputs(f"{masses} M=inf")
    with pytest.raises(SceneError, match="without friction the acceleration is") as caught:
        solve(**given, a=9 if Fraction(given["m2"]) > Fraction(given["m1"]) else -9)
    [greatest] = re.findall("the acceleration is (.*) m/s²", str(caught.value))
    assert solve(**given, a=Fraction(greatest) * Fraction("0.99999")).mu_k is not None


@pytest.mark.parametrize("trapped", [False, True])
def test_the_decimal_context_of_the_caller_has_no_part(trapped: bool) -> None:
    """A flag for comparing decimals with floats was set in it; who traps that had an exception."""
    decimals: list[dict[str, Any]] = [
        {"m1": Decimal(text), "M": Decimal("inf")} for text in ("1.0", "sNaN", "1e999999")
    ]
    typed = "mu=.3;m1=1.0(1) M=5(1) mu=.3 wrap=175(7);M=inf mu=9e8;M=1e-500 mu=1e-500 axle=1e-500;a=1.0(2) drop=1.0(1)"
    with localcontext(Context(prec=3, traps=[*Context().flags] if trapped else [])) as context:
        for given in (*decimals, *map(inputs, typed.split(";"))):
            for digits in (None, 5):
                with suppress(SceneError):
                    solve(**{"m1": "1", "m2": "3", **given, "digits": digits})
        assert not any(context.flags.values())


# What every solution has


def test_notes_show_floats_as_they_are_written() -> None:
    """They had all 54 digits of 0.2."""
    slips, holds = (solve(m1=1.0, m2=3.3, M=9.5, mu=mu, mu_k=mu_k) for mu, mu_k in ((0.2, None), (0.31, 0.1)))
    assert slips.notes[0] == "Slips: mu = 0.2 is below the 0.214620 needed to hold the string."
    assert holds.notes[0] == "No slip: mu = 0.31, and at least 0.214620 is needed."
    assert "heavier mass is 3.3 kg," in solve(m1=1.0, m2=3.3, mu=0.5).notes[0]


def test_an_inertia_factor_of_thousands_of_digits_is_written_shortly() -> None:
    notes = solve(m1=1, m2=3, I=Fraction(7**1700), R=Fraction(1, 3**3000), M=Fraction(1, 11**1300)).notes
    assert any("The inertia factor I/(M R^2) is 1.60209e5653, above 1" in note for note in notes)


def test_solution_is_a_record() -> None:
    s = solve(m1=1, m2=3)
    assert s == solve(m1="1.0", m2="3")
    assert s != solve(m1=1, m2=3, M=0)
    with pytest.raises(AttributeError):
        s.regime = "slip"  # type: ignore[misc]
    with pytest.raises(AttributeError, match="'Solution' object has no attribute 'pulley_weight'"):
        s.pulley_weight  # type: ignore[attr-defined]  # noqa: B018


def test_a_quantity_is_computed_when_it_is_read_and_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Machine, "friction_force_min", property(lambda _: 1 / 0))
    s = solve(m1=1.0, m2=3.0, M=10.0, mu=0.3)
    acceleration = s.acceleration
    with pytest.raises(ZeroDivisionError):
        _ = s.friction_force_min
    monkeypatch.setattr(Machine, "acceleration", property(lambda _: 1 / 0))
    assert s.acceleration is acceleration


@pytest.mark.parametrize(
    "given",
    ["mu=0.3", "M=100 mu=0.3 mu_k=0.25 digits=5", "M=10(1) mu=0.2(1)", "a=1.0(1) drop=2", "drop=2 I=1 R=1"],
)
def test_a_solution_is_the_same_however_it_is_read(given: str) -> None:
    s, backwards = (solve(**inputs(given)) for _ in range(2))
    for one in reversed(fields(backwards)):
        getattr(backwards, one.name)
    pickled = pickle.loads(pickle.dumps(solve(**inputs(given))))
    for other in (backwards, pickled, copy(pickled), deepcopy(backwards)):
        assert (repr(other), other, hash(other), str(other)) == (repr(s), s, hash(s), str(s))


def test_the_python_door_is_light_and_shells_complete_its_names_before_their_first_use() -> None:
    code = """
import sys, atwood_cli
assert not set(atwood_cli.__all__ + ["__version__"]) - set(dir(atwood_cli))
atwood_cli.solve(m1=1, m2=3, mu=0.3)
assert not {"typer", "rich", "numpy"} & set(sys.modules)
"""
    assert process(code=code) == (0, "", "")


def test_a_users_script_runs() -> None:
    """`mypy` checks its types."""
    run_path(str(TOP / "tests" / "tools" / "user_script.py"))


@pytest.mark.parametrize("function", [solve, solve_arrays])
def test_help_begins_with_what_a_function_does(function: Any) -> None:
    described = " ".join(pydoc.plain(pydoc.render_doc(function)).split())
    assert described.index((function.__doc__ or "").split("\n")[0]) < 500


@pytest.mark.parametrize("function", [solve_arrays, solve_table])
def test_a_docstring_names_the_usual_quantities(function: Any) -> None:
    assert f"if None, {', '.join(STANDARD[:-1])} and {STANDARD[-1]}." in " ".join(function.__doc__.split())


# What a version promises: an entry may be added, but none goes or changes its meaning

VALUES = """
    acceleration tension_1 tension_2 mu_verge safety_factor tension_ratio capstan_ratio friction_force
    friction_force_min friction_force_max friction_force_x friction_force_y axle_force torque rim_acceleration
    angular_acceleration critical_pulley_mass critical_heavier_mass critical_lighter_mass least_heavier_mass
    least_pulley_mass least_wrap pulley_mass moment_of_inertia gravity m1 m2 mu_k fall_time final_speed"""
SCENE = "m1 m2 M mu mu_k g inertia I R wrap axle"
FITTED = """rim_mass axle gravity delay pulley_mass moment_of_inertia uncertainty interval correlation chi2 dof
    between_runs runs notes"""
RIT = Path(__file__).parent.parent / "examples" / "rit.csv"
JSON = {
    "solve --m1 1 --m2 3": f"version scene regime {VALUES} uncertainty budget notes",
    "sweep --m1 1:2:2 --m2 3": "version scene rows notes",
    "contact --m1 1 --m2 3": "version scene regime profile points balance notes",
    f"fit {RIT} --drop 98cm": f"version {FITTED}",
}
"""The keys of JSON at its top; `test_json` has the keys below."""


def parameters(function: Callable[..., Any]) -> list[str]:
    """Return its parameters as they are written, without types, and `?` for those that are None if not given."""
    bare = [one.replace(annotation=one.empty) for one in signature(function).parameters.values()]
    return str(Signature(bare))[1:-1].replace("=None", "?").split(", ")


PYTHON: dict[str, tuple[Iterable[str], str]] = {
    "atwood_cli": (
        atwood_cli.__all__,
        "Solution solve STATUSES solve_arrays solve_table REGIMES Fit fit Scene SceneError",
    ),
    "solve": (
        parameters(solve),
        "m1? m2? * M? mu? mu_k? g? inertia? I? R? wrap? axle? a? drop? time? digits?",
    ),
    "solve_arrays": (
        parameters(solve_arrays),
        "m1 m2 M? mu? mu_k? * g? inertia? I? R? wrap=180.0 axle? accuracy='certified' quantities?",
    ),
    "solve_table": (parameters(solve_table), "table quantities?"),
    "fit": (parameters(fit), "runs * drop? g? M? inertia? I? R? axle? find? without=()"),
    "Solution": ([one.name for one in fields(Solution)], f"scene notes regime {VALUES} uncertainty"),
    "Scene": (Scene._fields, f"{SCENE} motion"),
    "Fit": (Fit._fields, FITTED),
    "REGIMES": (atwood_cli.REGIMES, "no-slip verge slip"),
    "STATUSES": (
        [status.replace(" ", "_") for status in atwood_cli.STATUSES],
        """valid m1 m2 M mu mu_k g inertia R wrap no_mass friction_at_a_free_end mu_k_without_mu mu_k_above_mu
        NaN I axle I_and_inertia I_without_R I_with_M_=_0_or_inf""",
    ),
    "commands": (COMMANDS, "solve sweep contact fit batch quantities tradeoff"),
    "quantities": (QUANTITIES, VALUES),
    "quantities of every scene": (oracle.NAMES, " ".join(NAMES)),
}


@pytest.mark.parametrize("name", PYTHON)
def test_what_a_version_promises_to_python(name: str) -> None:
    has, promised = PYTHON[name]
    assert [*has] == promised.split()


@pytest.mark.parametrize("words", JSON)
def test_what_a_version_promises_in_json(atwood: Atwood, words: str) -> None:
    assert [*json.loads(atwood(*words.split(), "--json").out)] == JSON[words].split()


def test_what_a_version_promises_of_statuses_and_csv(atwood: Atwood) -> None:
    assert (DONE, COULD_NOT, WRONG_USAGE, INTERRUPTED) == (0, 1, 2, 130)
    scene = ["--m1", "1", "--m2", "3"]
    assert atwood("solve", *scene).status == DONE
    assert atwood("solve", *scene, "--expect", "slip").status == COULD_NOT
    assert atwood("solve", "--m1", "-1", "--m2", "3").status == WRONG_USAGE
    columns = atwood("sweep", "--m1", "1:2:2", "--m2", "3", "--csv").out.split()[0]
    assert columns == f"m1,regime,{','.join(VALUES.split()[:4])},friction_force,critical_pulley_mass"


def test_every_quantity_is_described() -> None:
    for name, about in QUANTITIES.items():
        line = rf"\n    {name} +{re.escape(about.meaning)}.*{re.escape(about.unit)}.*{re.escape(about.equation)}\n"
        assert re.search(line, str(Solution.__doc__)), name


def test_solve_takes_no_other_inputs() -> None:
    unknown: Any = {"m1": 1, "m2": 3, "m3": 2}
    with pytest.raises(TypeError, match="unexpected keyword argument 'm3'"):
        solve(**unknown)
