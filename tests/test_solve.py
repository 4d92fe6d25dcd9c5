"""`solve` from Python: what is given decides the scene, by `cases/corners.md`, and what every solution does."""

import pickle
import re
from copy import copy, deepcopy
from dataclasses import fields
from fractions import Fraction
from pathlib import Path
from pydoc import plain, render_doc
from runpy import run_path
from typing import Any

import pytest

from atwood_cli import QUANTITIES, solve
from atwood_cli.solver.machine import Machine

from .tools.running import TOP, process
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


# What every solution has


def test_notes_show_floats_as_they_are_written() -> None:
    """They had all 54 digits of 0.2."""
    slips, holds = (solve(m1=1.0, m2=3.3, M=9.5, mu=mu, mu_k=mu_k) for mu, mu_k in ((0.2, None), (0.31, 0.1)))
    assert slips.notes[0] == "Slips: mu = 0.2 is below the 0.214620 needed to hold the string."
    assert holds.notes[0] == "No slip: mu = 0.31, and at least 0.214620 is needed."


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


def test_python_asks_for_the_budget_for_units_and_for_types() -> None:
    s = solve("1.0(1)", 3, M="10(1)")
    assert s.to_dict()["budget"] is None
    assert s.to_dict(budget=True) == s.to_dict() | {"budget": s.to_dict(budget=True)["budget"]}
    assert sum(s.to_dict(budget=True)["budget"]["acceleration"].values()) == pytest.approx(100)
    assert (QUANTITIES["torque"].unit, QUANTITIES["mu_verge"].unit) == ("N m", "")
    text = " ".join(plain(render_doc(solve)).split())  # with a line for each from 3.13 on
    assert "m1: 'Given | None' = None, m2: 'Given | None' = None, *, M: 'Given | None' = None" in text
    assert re.search("digits: 'int [|] str [|] None' = None,? ?[)] -> 'Solution'", text)


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


def test_solve_takes_no_other_inputs() -> None:
    unknown: Any = {"m1": 1, "m2": 3, "m3": 2}
    with pytest.raises(TypeError, match="unexpected keyword argument 'm3'"):
        solve(**unknown)
    with pytest.raises(TypeError, match=r"'drive'; did you mean find='drive'\?$"):
        solve(**{"m1": 1, "m2": 3, "drive": 5})
