"""What is given decides the scene: every line and corner of the contract, through `solve`."""

import inspect
import pickle
import pydoc
import re
import subprocess
import sys
from collections.abc import Iterable
from contextlib import suppress
from copy import copy, deepcopy
from dataclasses import fields
from decimal import Context, Decimal, localcontext
from fractions import Fraction
from functools import partial
from math import inf, log, pi
from pathlib import Path
from runpy import run_path
from typing import Any

import pytest

from atwood_cli import REGIMES, Scene, SceneError, Solution, solve, solve_arrays
from atwood_cli.api import Inputs
from atwood_cli.arithmetic.interval import enclosures
from atwood_cli.model.machine import Machine
from atwood_cli.model.quantities import MEASURED_NAMES, NAMES, QUANTITIES
from atwood_cli.model.scene import INPUTS, MEASURED, Motion

from . import oracle
from .scenes import inputs, table

USER_SCRIPT = str(Path(__file__).with_name("user_script.py"))


def nulls(solution: Solution[Any]) -> set[str]:
    return {name for name in oracle.NAMES if getattr(solution, name) is None}


REFERENCE = """
mu=0.3 | verge | 0.764026672247106942 10.5706766722471069 27.1278699832586792 0.3 10.8325976703838104
    43.3419248632108670
M=10 | no-slip | 2.17925555555555556 11.9859055555555556 22.8821833333333333 0.205827819270640686
    7.02946524440111226 None
M=100 mu=0.3 mu_k=0.25 | slip | 1.52335712943225151 11.3300071294322515 24.8498786117032455
    0.326109852384497038 8.77491120196940880 43.3419248632108670
M=inf | no-slip | 0 9.80665 29.41995 0.349699152566059778 12.9485994725957480 None
"""


@pytest.mark.parametrize(("given", "regime", "values"), table(REFERENCE))
def test_reference_values(given: str, regime: str, values: str) -> None:
    solution = solve(**inputs(given), digits=18)
    names = "acceleration tension_1 tension_2 mu_verge friction_force critical_pulley_mass".split()
    assert solution.regime == regime
    for name, value in zip(names, values.split(), strict=True):
        assert getattr(solution, name) == (None if value == "None" else Decimal(value)), name


# The table of what is given, and its corners: scene | results | what a note says

GROUPS = {
    "moving": "acceleration tension_1 tension_2 rim_acceleration",
    "friction": "mu_verge friction_force friction_force_min friction_force_max friction_force_x friction_force_y",
    "conditions": "least_heavier_mass least_pulley_mass",
    "critical": "critical_pulley_mass",
}
CORNERS = """
m1=1                 | regime=no-slip tension_1=14.709975 tension_2=14.709975 friction=0
M=10                 | regime=no-slip                                       | Assumed to hold
mu=0.35              | regime=no-slip moving=None mu_verge=None friction_force=None critical=None | give M
mu=0.35              | | acceleration from 4.90332 to 0, tension_1 from 14.7100 to 9.80665, tension_2 from
mu=0.35              | | tension_2 from 14.7100 to 29.4200, mu_verge from 0 to 0.349699
mu=0.3 M=43.3419     | regime=no-slip critical=43.34192486321087 friction_force=None | Holds
mu=0.3 M=43.3420     | regime=slip critical=43.34192486321087               | Slips
mu=0.3 M=0           | regime=no-slip critical=43.34192486321087 friction=0
mu=0                 | regime=verge critical=0 mu_verge=0 friction_force=0 conditions=None | (36) do not apply
mu=0 M=10            | regime=slip friction_force=0 rim_acceleration=0 acceleration=4.903325
mu=0 M=inf           | regime=slip friction_force=0 rim_acceleration=0 acceleration=4.903325
M=inf mu=0.34969915256605978 | regime=no-slip acceleration=0 rim_acceleration=0 critical_heavier_mass=3 axle_force=None
M=inf mu=0.34969915256605977 | regime=slip rim_acceleration=0 axle_force=None
m1=3                 | regime=no-slip acceleration=0 rim_acceleration=0 friction=0 critical=None | At rest
m1=3 mu=0.2          | regime=no-slip acceleration=0 rim_acceleration=0 friction=0 critical=None | At rest
m1=3 mu=0            | regime=no-slip acceleration=0 rim_acceleration=0 friction=0 critical=None | At rest
m1=3 M=inf           | regime=no-slip acceleration=0 tension_1=29.41995 tension_2=29.41995 friction=0 | At rest
m1=3 M=5 mu=0 R=1    | regime=no-slip torque=0 tension_1=29.41995 tension_2=29.41995 friction=0 | At rest
m1=0                 | acceleration=9.80665 tension_1=0 tension_2=0 friction=None
m1=0 M=0             | acceleration=9.80665 tension_1=0 tension_2=0 friction=None
m1=0 M=2             | acceleration=7.3549875 tension_1=0 tension_2=7.3549875 friction=None
m1=0 M=inf           | acceleration=0 tension_1=0 tension_2=29.41995 friction=None
m1=3 m2=0 M=2        | acceleration=-7.3549875 tension_1=7.3549875 tension_2=0
I=0.2 R=0.2 mu=0.3   | axle_force=None critical=None least_pulley_mass=None | give M, the pulley's mass, beside I
inertia=1.2 M=1      | | above 1
I=5 R=1 M=1          | | above 1
M=10                 | least_wrap=None | least_wrap: give mu
mu=0.4               | least_wrap=None | give M
mu=0 M=1             | least_wrap=None | does not exist, as without friction no wrap holds
m1=0                 | least_wrap=None | least_pulley_mass, least_wrap: not defined for a free end
axle=5N m2=1.2 mu=0.3 M=1 | critical_pulley_mass=None | the axle holds the difference on any
axle=5N m2=3 mu=0.05 | critical_pulley_mass=None | slips on any pulley, however light
axle=5N m2=1.2 mu=0.05 M=1 | critical_pulley_mass=None | slips on any pulley, however light
axle=5N m2=1.2 mu=0 | least_pulley_mass=None | no condition here, as the friction of the axle
axle=5N m2=3 mu=0.05 | least_pulley_mass=None | no condition here, as the friction of the axle
axle=5N m2=3 mu=0.05 | mu_verge=None | give M
axle=5N m2=3 mu=0.3 M=1 | critical_heavier_mass=None | holds under any heavier mass
"""


@pytest.mark.parametrize("corner", table(CORNERS))
def test_what_is_given_decides_what_follows(corner: list[str]) -> None:
    given, expected, note = (*corner, "")[:3]
    solution = solve(**inputs(given))
    for name, value in (word.split("=") for word in expected.split()):
        for one in GROUPS.get(name, name).split():
            wanted = value if name == "regime" else None if value == "None" else float(value)
            assert getattr(solution, one) == wanted, one
    assert note in " ".join(solution.notes)


def test_the_force_of_an_assumed_grip_is_that_of_the_verge() -> None:
    """(32) at mu_verge: what the verge of that very mu gives at that critical mass."""
    s = solve(m1=1, m2=3, M=10)
    at_verge = solve(m1=1, m2=3, mu=s.mu_verge)
    assert s.friction_force == pytest.approx(at_verge.friction_force, rel=1e-14)
    assert at_verge.critical_pulley_mass == pytest.approx(10, rel=1e-14)


def test_mu_alone_gives_the_motion_on_the_critical_pulley() -> None:
    s = solve(m1="1", m2="3", mu="0.3")
    at_critical = solve(m1="1", m2="3", M=solve(m1="1", m2="3", mu="0.3", digits=40).critical_pulley_mass)
    assert (s.acceleration, s.tension_1) == (at_critical.acceleration, at_critical.tension_1)


def test_moment_of_inertia_fixes_the_factor_or_stands_for_the_mass() -> None:
    for one, other in (
        (solve(m1=1, m2=3, M=10, I="0.4", R="0.2"), solve(m1=1, m2=3, M=10, inertia=1, R="0.2")),
        (solve(m1=1, m2=3, I="0.2", R="0.2", mu="0.3"), solve(m1=1, m2=3, M=10, R="0.2", mu="0.3")),
    ):
        alone = ("axle_force", "critical_pulley_mass", "least_pulley_mass")
        names = [name for name in oracle.NAMES if one.scene.M is not None or name not in alone]
        assert [getattr(one, name) for name in names] == [getattr(other, name) for name in names]


EXTREME = [
    {"m2": "3"},
    {"m2": "1.0001"},
    {"m1": "1e-9"},
    {"M": "1e-7"},
    {"M": "1e9"},
    {"M": "7.3", "g": "moon"},
]


@pytest.mark.parametrize("digits", [None, 1, 2, 5, 17])
@pytest.mark.parametrize("given", EXTREME)
def test_the_least_mu_that_a_sentence_names_holds(given: dict[str, Any], digits: int | None) -> None:
    """With mu = 0.20582781927064067, which was said to be enough on a pulley of 10 kg, it slips."""
    scene = {"m1": "1", "m2": "3", "M": "10", **given}
    solution: Any = solve(**scene, digits=digits)
    match = re.fullmatch("Assumed to hold, without mu: it does if mu is at least (.*).", solution.notes[0])
    assert match
    assert solve(**scene, mu=match[1]).regime == "no-slip"
    last = Decimal(1).scaleb(Decimal(match[1]).as_tuple().exponent)  # type: ignore[arg-type]
    assert digits is None or solve(**scene, mu=Decimal(match[1]) - last).regime == "slip"


def test_the_greatest_acceleration_that_an_error_names_is_taken() -> None:
    for m1, m2 in (("1", "3"), ("3", "1"), ("1", "1.1"), ("7", "2.9"), ("0.1", "0.3")):
        sign = 1 if Fraction(m2) > Fraction(m1) else -1
        with pytest.raises(SceneError) as caught:
            solve(m1=m1, m2=m2, M="inf", a=sign * 9)
        match = re.search("without it the acceleration is (.*) m/s²", str(caught.value))
        assert match
        assert solve(m1=m1, m2=m2, M="inf", a=match[1]).mu_k is not None


def test_an_inertia_factor_just_above_one_is_not_shown_as_one() -> None:
    notes = solve(m1=1, m2=3, M=2, inertia="1.0000000000000000001").notes
    assert any("I/(M R^2) is 1.0000000000000000001, above 1" in note for note in notes)


def test_a_free_end_is_not_told_to_give_mu() -> None:
    """It was, and mu is refused there."""
    for scene in ({"m1": 0, "m2": 3}, {"m1": 3, "m2": 0, "M": 2}, {"m1": 0, "m2": 1, "M": "inf"}):
        notes = " ".join(solve(**scene).notes)
        assert "give mu" not in notes
        assert "least_pulley_mass, least_wrap: not defined for a free end" in notes


SLIDING = """
M=50 mu=0.31 mu_k=0.1 | Holds from rest: mu = 0.31, and 0.306 is enough. | A string that slides already
    goes on sliding, as mu_k = 0.1 is below 0.305: the masses then have the acceleration 3.66061 m/s².
M=50 mu=0.31 mu_k=0.306 | Holds: mu = 0.31, and 0.306 is enough. | mu_k = 0.306 is enough, too: a string
    that slides already is caught by the pulley.
mu=0.5 mu_k=0.1 | Holds on any pulley: the heavier mass, 3 kg, would have to exceed 4.81 kg to slip. |
    mu_k has no part in this, which starts from rest; what a sliding string does depends on M.
mu=0.3 mu_k=0.1 | On the verge of slipping: as M is not given, this is for the critical pulley mass,
    43.3419 kg. On a heavier pulley the string slips; on one without mass the acceleration is 4.90332
    m/s². | mu_k has no part in this, which starts from rest; what a sliding string does depends on M.
"""


@pytest.mark.parametrize(("given", "verdict", "note"), table(SLIDING))
def test_what_mu_k_does_where_the_string_holds_is_said(given: str, verdict: str, note: str) -> None:
    notes = solve(**inputs(given), digits=6).notes
    assert notes[0] == verdict
    assert note in notes


def test_critical_heavier_mass_is_where_the_regime_changes() -> None:
    critical = solve(m1=1, m2=3, M=100, mu="0.3", digits=30).critical_heavier_mass
    assert critical is not None
    for offset, regime in ((Decimal("-1e-25"), "no-slip"), (Decimal("1e-25"), "slip")):
        assert solve(m1=1, m2=Fraction(critical) + Fraction(offset), M=100, mu="0.3").regime == regime
    assert solve(m1=1, m2=3, M=6, mu="0.3").critical_heavier_mass is None


@pytest.mark.parametrize("trapped", [False, True])
def test_the_decimal_context_of_the_caller_has_no_part(trapped: bool) -> None:
    """A flag for comparing decimals with floats was set in it; who traps that had an exception."""
    scenes: list[dict[str, Any]] = [
        {"mu": "0.3"},
        {"m1": Decimal("1.0"), "M": Decimal("inf")},
        {"m1": "1.0(1)", "M": "5(1)", "mu": "0.3", "wrap": "175(7)"},
        {"M": "inf", "mu": "9e8"},
        {"M": "1e-500", "mu": "1e-500", "axle": "1e-500"},
        {"a": "1.0(2)", "drop": "1.0(1)"},
        {"m1": Decimal("sNaN")},
        {"m1": Decimal("1e999999")},
    ]
    with localcontext(Context(prec=3, traps=[*Context().flags] if trapped else [])) as context:
        for given in scenes:
            for digits in (None, 5):
                with suppress(SceneError):
                    solve(**{"m1": "1", "m2": "3", **given, "digits": digits})
        assert not any(context.flags.values())


# What every solution has


def test_every_missing_value_has_a_note() -> None:
    scenes: list[dict[str, Any]] = [
        {},
        {"M": 10},
        {"mu": "0.3"},
        {"mu": 2},
        {"M": "inf", "mu": "0.3"},
        {"wrap": 90, "M": 1},
    ]
    for more in scenes:
        s = solve(m1=1, m2=3, **more)
        for name in nulls(s):
            assert any(name in note for note in s.notes), (more, name)


def test_scene_is_as_understood() -> None:
    s = solve(m1="250g", m2="2 lb", R="5cm", g="moon", inertia="hoop")
    assert s.scene.m1 == Fraction(1, 4)
    assert s.scene.m2 == Fraction("0.90718474")
    assert s.scene.R == Fraction(1, 20)
    assert s.scene.g == Fraction("1.62")
    assert s.scene.inertia == 1
    assert s.scene.wrap == 180
    assert s.scene.M is s.scene.mu is None


def test_floats_mean_their_binary_value() -> None:
    exact = solve(m1=0.1, m2=3, M=1, digits=30)
    assert exact == solve(m1=Fraction(0.1), m2=3, M=1, digits=30)
    assert exact.acceleration != solve(m1="0.1", m2=3, M=1, digits=30).acceleration
    assert repr(exact.scene.m1) == repr(Fraction(0.1))


FLOATS = """
mu=0.2 | Slips: mu = 0.2 is below the 0.206 that would hold it.
mu=0.31 mu_k=0.1 M=50 | Holds from rest: mu = 0.31, and 0.306 is enough.
mu=0.5 m2=3.3 M=None | Holds on any pulley: the heavier mass, 3.3 kg, would have to exceed 4.81 kg to slip.
"""


@pytest.mark.parametrize(("given", "said"), table(FLOATS))
def test_notes_show_floats_as_they_are_written(given: str, said: str) -> None:
    """They had all 54 digits of 0.2."""
    words = {name: word and float(word) for name, word in inputs(given).items()}
    scene: Any = {"m1": 1, "m2": 3, "M": 10, **words}
    assert said in " ".join(solve(**scene).notes)


@pytest.mark.parametrize(
    ("mu", "mu_k", "sizes"),
    [(0.3, "0.3", "0.3 > 0.299999999999999988897769753748434595763683319091796875"), (0.2, 0.3, "0.3 > 0.2")],
)
def test_the_digits_of_a_float_are_shown_where_they_decide(mu: float, mu_k: Any, sizes: str) -> None:
    with pytest.raises(SceneError, match=f"must not be above mu; exactly, {sizes}"):
        solve(m1=1, m2=3, mu=mu, mu_k=mu_k)


@pytest.mark.parametrize("digits", [1, 6, 17, 1000])
def test_digits_are_exactly_as_many(digits: int) -> None:
    s = solve(m1=1, m2=3, M=10, digits=digits)
    for value in (s.acceleration, s.mu_verge, s.axle_force):
        assert isinstance(value, Decimal)
        assert len(value.as_tuple().digits) == digits


@pytest.mark.parametrize("digits", [0, -1, 1001, 2.5, "", "six", "99999", True])
def test_digits_out_of_range_are_refused(digits: Any) -> None:
    with pytest.raises(SceneError, match=r"digits .* must be a whole number from 1 to 1000"):
        solve(m1=1, m2=3, digits=digits)


def test_values_beyond_the_doubles_are_infinite_and_said() -> None:
    s = solve(m1="1e400", m2="2e400")
    assert s.tension_1 == inf
    assert s.acceleration == pytest.approx(9.80665 / 3)
    assert any("beyond the range of doubles" in note and "--digits" in note for note in s.notes)
    assert solve(m1="1e400", m2="2e400", digits=5).tension_1 == Decimal("1.3076e401")


def test_values_below_the_doubles_are_zero_and_said() -> None:
    s = solve(m1="1e-400", m2="2e-400")
    assert s.tension_1 == 0
    assert any("below the range of doubles" in note for note in s.notes)


VERDICTS = """
M=43.34192486321087 | Slips: mu = 0.3 is below the 0.301 that would hold it.
m1=1t m2=2t | Holds on any pulley: the heavier mass, 2000 kg, would have to exceed 2560 kg to slip.
M=43 digits=2 | Holds: mu = 0.3, and 0.2997 is enough.
M=43.5 digits=2 | Slips: mu = 0.3 is below the 0.301 that would hold it.
m2=2.566332395208135 | Holds on any pulley: the heavier mass, 2.566332395208135 kg, would have to exceed
    2.5663323952081353 kg to slip.
"""


@pytest.mark.parametrize(("given", "verdict"), table(VERDICTS))
def test_a_verdict_tells_near_numbers_apart(given: str, verdict: str) -> None:
    assert solve(**{"mu": "0.3", **inputs(given)}).notes[0] == verdict


def test_a_verdict_on_a_number_of_millions_of_digits_makes_no_fraction_of_it() -> None:
    """It took 25 s to compare 10^11824595 with 1.5 as fractions."""
    s = solve(m1=1, m2="1.5", mu="2.6e7", wrap=60, digits=40)
    assert s.least_heavier_mass is not None
    assert s.least_heavier_mass.adjusted() == 11824595
    assert s.notes[0].startswith("Holds on any pulley, under any mass that can be given")


def test_a_huge_wrap_in_radians_settles() -> None:
    s = solve(m1=1, m2=3, M=10, mu="0.3", wrap="1e499rad", digits=200)
    assert s.regime == "no-slip"
    assert s.least_heavier_mass == Decimal("Infinity")


def test_nothing_is_divided_by_a_number_too_large_to_be_written() -> None:
    """The quotient was an exact 0: infinity stands for e^{μφ} = e^1000000000."""
    ar = enclosures(20)
    huge = ar.expm1(ar.number(10**9))
    assert huge.lo == huge.hi == Decimal("inf")
    with pytest.raises(OverflowError, match="a denominator is beyond 10\\^100000000"):
        1 / huge


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
    assert set(REGIMES) == {"no-slip", "verge", "slip"}


def test_a_quantity_is_computed_when_it_is_read_and_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Machine, "friction_force_min", property(lambda _: 1 / 0))
    s = solve(m1=1.0, m2=3.0, M=10.0, mu=0.3)
    assert s.acceleration == pytest.approx(9.80665 * 2 / 9)
    with pytest.raises(ZeroDivisionError):
        _ = s.friction_force_min
    monkeypatch.setattr(Machine, "acceleration", property(lambda _: 1 / 0))
    assert s.acceleration == pytest.approx(9.80665 * 2 / 9)


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
        assert repr(other) == repr(s)
        assert other == s
        assert hash(other) == hash(s)
        assert str(other) == str(s)


def test_the_python_door_needs_neither_typer_nor_rich_nor_numpy() -> None:
    code = (
        "import sys; from atwood_cli import solve; solve(m1=1, m2=3, mu=0.3);"
        "sys.exit(bool({'typer', 'rich', 'numpy'} & set(sys.modules)))"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_a_users_script_runs() -> None:
    run_path(USER_SCRIPT)


def test_pyright_knows_what_a_users_script_gets() -> None:
    """mypy checks it with the whole tree."""
    pytest.importorskip("basedpyright")
    options = ["--level", "error", "--pythonpath", sys.executable]
    command = [sys.executable, "-m", "basedpyright", *options, USER_SCRIPT]
    checked = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (checked.returncode, checked.stdout) == (0, "0 errors, 0 warnings, 0 notes\n")


def test_a_shell_completes_the_public_names_before_their_first_use() -> None:
    code = "import atwood_cli; assert not set(atwood_cli.__all__ + ['__version__']) - set(dir(atwood_cli))"
    subprocess.run([sys.executable, "-c", code], check=True)


@pytest.mark.parametrize("function", [solve, solve_arrays])
def test_help_begins_with_what_a_function_does(function: Any) -> None:
    described = " ".join(pydoc.plain(pydoc.render_doc(function)).split())
    assert described.index((function.__doc__ or "").split("\n")[0]) < 500


def test_what_is_registered_is_everywhere() -> None:
    """A quantity or an input that is added fails here, by the places that lack it."""
    everything, of_scenes, inputs_ = (*NAMES, *MEASURED_NAMES), ("scene", "notes"), (*INPUTS, *MEASURED)
    places: dict[str, tuple[Iterable[str], Iterable[str]]] = {
        "quantities.NAMES": (everything, ("regime", *QUANTITIES)),
        "api.Solution": (Solution.__slots__, (*of_scenes, *everything, "uncertainty")),
        "api.Inputs": (("m1", "m2", *Inputs.__annotations__), inputs_),
        "scene.Scene, scene.Motion": ((*Scene._fields, *Motion._fields[:3]), inputs_),
        "machine.Machine": (filter(partial(hasattr, Machine), QUANTITIES), QUANTITIES),
        "oracle.NAMES": (oracle.NAMES, NAMES),
        "solve's signature": (inspect.signature(solve).parameters, (*inputs_, "digits")),
    }
    assert {place: list(has) for place, (has, _) in places.items()} == {
        place: list(wanted) for place, (_, wanted) in places.items()
    }
    described = str(Solution.__doc__)
    for name, about in QUANTITIES.items():
        line = rf"\n    {name} +{re.escape(about.meaning)}.*{re.escape(about.unit)}.*{re.escape(about.equation)}\n"
        assert re.search(line, described), name


def test_solve_takes_no_other_inputs() -> None:
    unknown: Any = {"m1": 1, "m2": 3, "m3": 2}
    with pytest.raises(TypeError, match="unexpected keyword argument 'm3'"):
        solve(**unknown)


def test_how_safe_a_hoist_is_and_how_light_its_counterweight_may_be() -> None:
    s = solve(m1=1, m2=3, M=10, mu="0.3")
    assert s.critical_lighter_mass == 0.674774263967827
    assert s.tension_ratio == 21 / 11
    assert s.safety_factor == pytest.approx(0.3 * pi / log(21 / 11), rel=1e-15)
    assert (s.tension_ratio or 0) < (s.capstan_ratio or 0)
    below, above = (solve(m1=mass, m2=3, M=10, mu="0.3").regime for mass in ("0.6747742", "0.6747743"))
    assert (below, above) == ("slip", "no-slip")


@pytest.mark.parametrize(("digits", "value"), [(None, 0.0), (5, None)])
def test_what_is_too_small_to_be_written_is_not_said_to_be_0(digits: int | None, value: float | None) -> None:
    s: Any = solve(m1=1, m2=3, M=10, mu="1e9", digits=digits)
    assert s.critical_lighter_mass == value
    why = "critical_lighter_mass: not 0 but too small to be written out: about 10^-100000000 or less."
    assert why in s.notes
