"""The arc of contact: identities, bounds against a linear programme, output, figure."""

import json
import shlex
import subprocess
import sys
import warnings
from decimal import Decimal
from fractions import Fraction
from itertools import pairwise
from math import pi
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import linprog, minimize_scalar
from scipy.sparse import diags_array, vstack

from atwood_cli import Scene, solve
from atwood_cli.model.arc import friction
from atwood_cli.solver.answers import Answers
from atwood_cli.solver.balance import Contact, contact

from . import oracle
from .conftest import examples
from .running import Atwood, drawn, labels, misplaced, process

PAPER = ["contact", "--m1", "1", "--m2", "3", "--mu", "0.3"]
KEPT = Path(__file__).parent.parent / "examples" / "contact.svg"


def arc(points: int = 13, digits: int | None = None, **given: Any) -> Contact:
    return contact(Answers(Scene.read(given), digits), points)


@st.composite
def scenes(draw: st.DrawFn) -> dict[str, str]:
    """Scenes of every regime whose arc is determined, either mass heavier, wraps up to 180°."""
    number = st.decimals(Decimal("0.01"), Decimal("50"), allow_nan=False, places=4).map(str)
    scene = {"m1": draw(number), "m2": draw(number), "M": draw(number)}
    if draw(st.booleans()):
        scene["mu"] = draw(st.decimals(Decimal("0.001"), 3, places=3).map(str))
    if draw(st.booleans()):
        scene["wrap"] = draw(st.sampled_from(["30", "90", "123.4", "180", "2rad"]))
    if draw(st.booleans()):
        scene["R"] = draw(number)
    return scene


@given(scenes())
def test_contact_forces_add_up_to_what_the_tensions_would_do(scene: dict[str, str]) -> None:
    """(20) and (23), to the last digits, for every regime and mirrored scene."""
    digits = 30
    balance = arc(points=2, digits=digits, **scene).balance
    largest = max(abs(Fraction(v)) for name in ("friction", "normal") for v in balance[name].values())
    for axis in "xy":
        # Three roundings to 30 digits, half a unit each, of numbers no larger than that.
        assert abs(Fraction(balance["residual"][axis])) <= 2 * largest * Fraction(10) ** (1 - digits)
    torque = balance["torque"]
    assert abs(Fraction(torque["residual"])) <= abs(Fraction(torque["ends"])) * Fraction(10) ** (1 - digits)
    solution, radius = solve(**scene, digits=digits), Fraction(scene.get("R", 1))
    t1, t2 = Fraction(solution.tension_1 or 0), Fraction(solution.tension_2 or 0)
    rounding = max(t1, t2) * radius * Fraction(10) ** (1 - digits)
    assert abs(Fraction(torque["ends"]) - (t2 - t1) * radius) <= 2 * rounding


@examples(30)
@given(scenes())
def test_tension_runs_from_t1_to_t2_within_the_limits_of_friction(scene: dict[str, str]) -> None:
    solution = solve(**scene)
    points = contact(Answers(Scene.read(scene)), 25).points
    assert points[0]["tension"] == solution.tension_1
    assert points[-1]["tension"] == solution.tension_2
    assert points[0]["angle"] == 0
    tensions = [float(p["tension"]) for p in points]
    assert tensions in (sorted(tensions), sorted(tensions, reverse=True))
    mu = float(scene.get("mu", solution.mu_verge or 0))
    for p in points:
        assert p["normal_per_radian"] == p["tension"]
        assert abs(float(p["friction_per_radian"])) <= mu * float(p["tension"]) * (1 + 1e-12)
        if "R" in scene:
            assert float(p["normal_per_metre"]) == pytest.approx(float(p["tension"]) / float(scene["R"]))


def test_the_exponential_profile_against_mpmath() -> None:
    with mpmath.workdps(60):
        t1 = mpmath.mpf(str(solve(m1=1, m2=3, mu="0.3", digits=50).tension_1))
        for point in arc(points=7, digits=40, m1=1, m2=3, mu="0.3").points:
            theta = mpmath.radians(mpmath.mpf(str(point["angle"])))
            expected = t1 * mpmath.exp(mpmath.mpf("0.3") * theta)
            assert abs(mpmath.mpf(str(point["tension"])) / expected - 1) < mpmath.mpf(10) ** -39
            friction = mpmath.mpf(str(point["friction_per_radian"]))
            assert abs(friction / (expected * mpmath.mpf("0.3")) - 1) < mpmath.mpf(10) ** -39


@pytest.mark.parametrize(
    "given", [{"mu": 0, "M": 1}, {"mu": 0}, {"M": 0}, {"mu": 1, "mu_k": 0, "M": 10**6, "m2": 300}]
)
def test_without_friction_the_tension_is_exact_even_at_a_tie(given: dict[str, Any]) -> None:
    """14.709975 N to 7 digits is a tie, which no enclosure would settle."""
    seen = arc(points=4, digits=7, **{"m1": 1, "m2": 3, **given})
    if "m2" not in given:
        assert {point["tension"] for point in seen.points} == {Decimal("14.70998")}
    assert {point["friction_per_radian"] for point in seen.points} == {0}
    assert seen.balance["torque"]["contact"] == seen.balance["torque"]["ends"] == 0
    assert seen.notes == ["Both tensions are equal: there is no friction."]


def test_creep_is_where_the_string_leaves_the_pulley() -> None:
    for m1, m2, quiet, busy in ((1, 3, 0, -1), (3, 1, -1, 0)):
        points = arc(m1=m1, m2=m2, M=10, mu="0.3").points
        assert points[quiet]["friction_per_radian"] == 0
        assert abs(float(points[busy]["friction_per_radian"])) == pytest.approx(0.3 * 22.8821833333)


# The bounds of the friction force


GRIPPING = [
    dict(zip(("m1", "m2", "M", "mu", "wrap"), row, strict=True))
    for row in (
        (3.152, 3.735, 24.299, 2.592, 30),
        (3.295, 2.697, 33.193, 1.459, 180),
        (3.28, 4.514, 0.219, 0.505, 180),
        (1.966, 0.6, 0.56, 1.25, 60),
        (0.78, 3.126, 0.24, 0.101, 180),
        (1.126, 1.156, 88.565, 2.035, 90),
        (1, 3, 10, 0.4, 150),
    )
]
"""Scenes whose friction is to spare."""


def direction(answers: Answers, kind: Any) -> float:
    """The angle of the net friction (rad) where the tension runs along the arc in this way."""
    x, y = (answers.settle(lambda m, i=i: m.seen_from_m1(friction(m.arcs(kind)))[i]) for i in (0, 1))  # type: ignore
    return float(np.arctan2(float(y), float(x)))


@pytest.mark.parametrize("scene", GRIPPING, ids=str)
def test_bounds_against_a_linear_programme(scene: dict[str, Any]) -> None:
    """All profiles on elements with T_j <= T_{j+1} <= e^{μΔ} T_j, friction at each one's middle.

    The force in a direction is linear in T, so a linear programme finds its extremes; the greatest
    force is the greatest of those over all directions, the least (the distance of a convex set from
    the origin) the greatest of their minima.
    """
    solution = solve(**scene)
    low, high = sorted((float(solution.tension_1 or 0), float(solution.tension_2 or 0)))
    count = 150
    # Elements shrink towards the ends, where the limiting arcs of the least force lie.
    nodes = scene["wrap"] * pi / 360 * (1 - np.cos(pi * np.arange(count + 1) / count))
    steps, middle = np.diff(nodes), (nodes[1:] + nodes[:-1]) / 2
    unit = np.stack([-np.sin(middle), np.cos(middle)])
    growth = np.exp(scene["mu"] * steps)
    ones = np.ones(count)
    no_fall = diags_array([ones, -ones], offsets=[0, 1], shape=(count, count + 1))
    no_slip = diags_array([-growth, ones], offsets=[0, 1], shape=(count, count + 1))
    bounds = [(low, low), *[(low, high)] * (count - 1), (high, high)]

    def extreme(angle: float, sign: int) -> float:
        along = np.array([np.cos(angle), np.sin(angle)]) @ unit
        costs = sign * (np.concatenate([[0], along]) - np.concatenate([along, [0]]))
        result = linprog(costs, A_ub=vstack([no_fall, no_slip]), b_ub=np.zeros(2 * count), bounds=bounds)
        assert result.status == 0
        return sign * float(result.fun)

    def best(sign: int, around: float) -> float:
        search = minimize_scalar(
            lambda angle: -extreme(angle, sign),
            bounds=(around - 1, around + 1),
            method="bounded",
            options={"xatol": 1e-3},
        )
        return -float(search.fun)

    angle = {kind: direction(Answers(Scene.read(scene)), kind) for kind in ("creep", "least")}
    if scene["m1"] > scene["m2"]:  # the programme's angle starts at the light end
        angle = {k: scene["wrap"] * pi / 180 - a for k, a in angle.items()}
    # What elements misplace is of second order in their size, what the direction's search misses too.
    tolerance = (high - low) * (steps.max() ** 2 + 1e-5)
    assert solution.friction_force_min == pytest.approx(best(1, angle["least"]), abs=tolerance)
    # Any place of the arc gives the greatest force; the programme finds the best of them.
    greatest = max(best(-1, a) for a in (angle["creep"], scene["wrap"] * pi / 360 + pi / 2))
    assert solution.friction_force_max == pytest.approx(greatest, abs=tolerance)


HARDLY_LOADED = {"m1": 1, "m2": 3, "M": "1e-30", "mu": 1, "wrap": 180}


@pytest.mark.parametrize("scene", [HARDLY_LOADED, *GRIPPING[:4]], ids=str)
def test_bounds_to_the_last_digit(scene: dict[str, Any]) -> None:
    """Both bounds from their definitions, the least one by minimising it, at 300 digits."""
    scene = {name: str(value) for name, value in scene.items()}
    with mpmath.workdps(300):
        s = solve(**scene, digits=300)
        low, high = sorted((mpmath.mpf(str(s.tension_1)), mpmath.mpf(str(s.tension_2))))
        mu, phi = mpmath.mpf(scene["mu"]), mpmath.radians(mpmath.mpf(scene["wrap"]))
        alpha = mpmath.log(high / low) / mu
        share = mu / mpmath.sqrt(1 + mu**2)

        def squared(lead: Any) -> Any:
            bridge = low * mpmath.exp(mpmath.mpc(mu, 1) * lead) * (1 - mpmath.expj(phi - alpha))
            return abs(bridge + high * mpmath.expj(phi) - low) ** 2

        # The square's derivative, from its definition; a root of it is found by bisection.
        def falls(lead: Any) -> bool:
            h = alpha * mpmath.mpf(10) ** -100
            return bool(squared(lead + h) < squared(lead - h))

        assert falls(alpha / 10**9)
        assert not falls(alpha)
        low_lead, high_lead = mpmath.mpf(0), alpha
        for _ in range(230):
            lead = (low_lead + high_lead) / 2
            low_lead, high_lead = (lead, high_lead) if falls(lead) else (low_lead, lead)
        least = share * mpmath.sqrt(squared(lead))
        greatest = share * abs(high * mpmath.expj(alpha) - low)
        for digits in (None, 40):
            t = solve(**scene, digits=digits)
            for got, want in ((t.friction_force_min, least), (t.friction_force_max, greatest)):
                # (mpmath's own nstr would round a near tie the wrong way, at M = 1e-30.)
                mantissa, exponent = want.man_exp
                assert got == oracle.round_exact(Fraction(mantissa) * Fraction(2) ** exponent, digits)


def test_bounds_meet_32_as_mu_falls_to_the_verge() -> None:
    verge = solve(m1=1, m2=3, M=10, digits=60)
    assert verge.mu_verge is not None
    assert verge.friction_force is not None
    for power in (5, 20, 40):
        mu = Fraction(verge.mu_verge) * (1 + Fraction(1, 10**power))
        s = solve(m1=1, m2=3, M=10, mu=mu, digits=60)
        assert s.friction_force_min is not None
        assert s.friction_force_max is not None
        assert s.friction_force_min < s.friction_force_max
        for bound in (s.friction_force_min, s.friction_force_max):
            assert abs(bound / verge.friction_force - 1) < Decimal(10) ** (1 - power)


def test_bounds_end_at_half_a_turn_and_the_notes_say_what_they_assume() -> None:
    s = solve(m1=1, m2=3, M=10, mu=1, wrap="181")
    assert s.friction_force_min is s.friction_force_max is None
    assert any("up to half a turn of wrap (180 degrees)" in note for note in s.notes)
    assert solve(m1=1, m2=3, M=10, mu=1, wrap="3.15rad").friction_force_min is None
    assert solve(m1=1, m2=3, M=10, mu=1, wrap="3.14rad").friction_force_min is not None
    inside = solve(m1=1, m2=3, M=10, mu=1)
    assert any("between friction_force_min and friction_force_max" in note for note in inside.notes)


def test_least_friction_of_a_hardly_loaded_string_is_found() -> None:
    """The least force is of second order in the load: 600 digits cancel here."""
    heavier, lighter = (
        solve(m1=1, m2=3, M=M, mu=1, digits=17).friction_force_min for M in ("1e-30", "1e-300")
    )
    assert heavier is not None
    assert lighter == heavier.scaleb(-540)
    assert solve(m1=1, m2=3, M="1e-300", mu=1).friction_force_min == 0


# Wrap


def test_wrap_has_units() -> None:
    for wrap, same in (("1.5turn", 540), ("90deg", 90), ("90°", 90), ("0.5turn", 180)):
        assert solve(m1=1, m2=3, M=1, wrap=wrap) == solve(m1=1, m2=3, M=1, wrap=same)


def test_wrap_in_radians_is_exact() -> None:
    with mpmath.workdps(60):
        mu = mpmath.log(mpmath.mpf(3)) / 2
        s = solve(m1=1, m2=3, M="inf", wrap="2rad", digits=50)
        assert s.mu_verge == Decimal(mpmath.nstr(mu, 50, strip_zeros=False))
    assert s.axle_force is None


def test_turns_multiply_the_grip() -> None:
    """A capstan: each further turn multiplies what can be held by e^{2πμ}."""
    least = [solve(m1=1, m2=2, mu="0.2", wrap=f"{n}.5turn").least_heavier_mass for n in range(3)]
    assert least[1] == pytest.approx(least[0] * np.exp(0.4 * pi))
    assert least[2] == pytest.approx(least[0] * np.exp(0.8 * pi))


# The command


@pytest.mark.parametrize(
    "given",
    [
        {"mu": "1e300", "M": 10},
        {"mu": "0.3", "M": 10, "wrap": "1e100"},
        {"m1": "1e-300", "m2": "1e300", "M": 1, "mu": 1000},
        {"m1": "1e307", "m2": "3e308", "M": "1e308", "mu": 4},
        {"mu": "0.3", "M": 10, "wrap": "1e400rad"},
    ],
)
def test_contact_where_few_digits_overflow(given: dict[str, Any]) -> None:
    """The width of an enclosure, times a huge mu, is an infinite e^x until there are digits enough."""
    for digits in (None, 10):
        seen = arc(points=3, digits=digits, **{"m1": 1, "m2": 3, **given})
        assert seen.balance["torque"]["contact"] == seen.balance["torque"]["ends"]


def test_solving_needs_no_numpy_for_the_arc() -> None:
    code = "import sys; from atwood_cli.cli import run; run(sys.argv[1:]); sys.exit('numpy' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code, *PAPER, "--csv"], capture_output=True, check=False)
    assert done.returncode == 0


# The figure

FIGURE = "--m1 1 --m2 3 --M 10 --mu 0.3"
MIRRORED = "--m1 3 --m2 1 --M 10 --mu 0.3"


@pytest.mark.parametrize(
    ("suffix", "start", "settings"),
    [
        ("svg", b"<?xml", b"text.usetex: True\nlines.linewidth: 9\n"),
        ("png", b"\x89PNG", b"nonsense: 1\nbackend: bad\n"),
        ("pdf", b"%PDF", b"\xff"),
    ],
)
def test_a_figure_is_the_same_to_the_byte_whenever_and_wherever_it_is_drawn(
    atwood: Atwood, tmp_path: Path, suffix: str, start: bytes, settings: bytes
) -> None:
    """It has no date, nor settings of matplotlib: neither those of the folder nor of the environment."""
    pytest.importorskip("matplotlib")
    file = tmp_path / f"a.{suffix}"
    assert atwood("contact", *FIGURE.split(), "--figure", str(file)).status == 0
    first = file.read_bytes()
    (tmp_path / "matplotlibrc").write_bytes(settings)
    command = f'cd "{tmp_path}"; atwood contact {FIGURE} --figure a.{suffix} --force'
    ran = process(shell=command, MPLBACKEND="nonsense", SOURCE_DATE_EPOCH="abc")
    assert (ran.status, ran.err) == (0, "")
    assert file.read_bytes() == first
    assert first.startswith(start)
    assert b"Date" not in first
    if suffix == "svg":
        kept = labels(KEPT.read_text(encoding="utf-8"))
        assert labels(first.decode()) == kept
        assert {"T₁ = 11.99 N", "W₂ = 29.42 N", "normal force nR", "m₁"} <= set(kept)


LEGIBLE = [
    *(
        f"{FIGURE} --wrap {w}"
        for w in (1, 30, 76, 90, 180, 181, 225, 251, 269, 270, 300, 345, 360, 540, 2000)
    ),
    f"{MIRRORED} --wrap 120",
    f"{MIRRORED} --axle 3 --wrap 300",
    "--m1 2 --m2 2",
    "--m1 2 --m2 2 --M 3 --mu 0.1 --wrap 300",
    "--m1 1 --m2 3 --mu 0",
    "--m1 1 --m2 3 --M 10 --mu 50",
    "--m1 1 --m2 3 --M inf --mu 5 --wrap 1e9",
    "--m1 1 --m2 3 --M 1 --wrap 1e-99rad",
    "--m1 1e-90 --m2 3e90 --M 1 --mu 0.1 --wrap 1e6",
    "--m1 1 --m2 3 --M 100 --mu 0.3 --mu-k 0.25 --digits 12",
    "--m1 1000 --m2 1 --M 5 --wrap 1440",
    "--m1 1.00000000000000000000001 --m2 1 --M 0.3 --mu 0.3",
    f"--m1 1.{'123456789' * 60} --m2 2.{'123456789' * 60} --M 3.{'1' * 500} --mu 0.{'3' * 500}",
]


@pytest.mark.parametrize("words", LEGIBLE)
def test_all_of_a_figure_can_be_read(words: str) -> None:
    """No words lie over others, and strings leave the pulley along tangents: m1's straight down on the left."""
    page = drawn(f"contact {words}")
    assert misplaced(page) == []
    assert page.get_supxlabel().count("\n") <= 1
    machine = page.axes[0]
    (string,) = (line.get_xydata() @ [1, 1j] for line in machine.lines if line.get_linewidth() == 2.2)
    assert string[0].real == string[1].real == -1
    assert abs(((string[-1] - string[-2]) * string[-2].conjugate()).real) < 0.03  # along the tangent
    assert 0.999 < min(abs(string[1:-1])) <= max(abs(string[1:-1])) < 1.001
    for arrows in machine.collections:
        lengths = np.abs(arrows.U + 1j * arrows.V)
        assert np.all((lengths > 0.01) & (lengths < 0.55))


ALONE = [
    FIGURE,
    "--m1 1 --m2 3 --M 10 --mu 0.3 --only a --bare",
    "--m1 3 --m2 1 --mu 0.3 --explain",
    "--m1 1 --m2 3 --M inf --mu 0.3 --axle 2",
    "--m1 2 --m2 2 --M 1 --axle 3",
    "--m1 55g --m2 60g --a 0.380+/-0.004",
    "--m1 1 --m2 3 --M 10 --drop 1 --time 1.2",
    "--m1 1 --m2 3 --I 0.02 --R 0.1 --mu 0.1 --wrap 250 --axle 0.1Nm",
    "--m1 0 --m2 3 --M 6",
    "--m1 3 --m2 0 --M 1 --wrap 400 --axle 3",
    "--m1 0 --m2 3",
    "--m1 1 --m2 3 --M 10 --axle 30 --mu 0.8 --wrap 270",
    "--m1 1 --m2 3 --M 10 --axle 30 --mu 0.3 --mu-k 0.2",
    "--m1 1 --m2 3 --mu 0.01 --wrap 250 --axle 5",
    "--m1 1 --m2 1000 --mu 0.2 --axle 5 --M 3 --wrap 76",
    "--m1 1 --m2 3 --M 10 --mu 0.3 --wrap 1000 --axle 5 --bare",
]


@pytest.mark.parametrize("words", ALONE)
def test_all_of_the_machine_alone_can_be_read(words: str) -> None:
    page = drawn(f"solve {words}")
    assert misplaced(page) == []
    assert page.get_supxlabel().count("\n") <= 1


@pytest.mark.parametrize("command", ["contact", "solve"])
@pytest.mark.parametrize(("masses", "sign"), [("--m1 1 --m2 3", 1), ("--m1 3 --m2 1", -1)])
@pytest.mark.parametrize("axle", [2, 30])
def test_the_heavier_mass_descends_and_the_axle_turns_against_it(
    masses: str, sign: int, axle: int, command: str
) -> None:
    """It does so too where it holds the pulley, and then there is no acceleration to be drawn."""
    figure = pytest.importorskip("atwood_cli.output.figure")
    from matplotlib.colors import same_color

    axes = drawn(f"{command} {masses} --M 10 --mu 0.4 --axle {axle}").axes[0]
    (turn,) = (text for text in axes.texts if not text.get_text())
    assert turn.xy[1] == turn.xyann[1] < 0  # below the axle
    assert sign * (turn.xy[0] - turn.xyann[0]) > 0
    boxes = {1: -1.0, 2: 1.0}  # where the masses hang
    ways = {
        which: np.sign(arrows.V[0])
        for arrows in axes.collections
        for which, x in boxes.items()
        if same_color(arrows.get_facecolor(), figure.PURPLE) and abs(arrows.X[0] - x) < 0.4
    }
    assert ways == ({1: sign, 2: -sign} if axle == 2 else {})


@pytest.mark.parametrize(
    ("words", "ends", "step"),
    [
        (FIGURE, [0, 6.864655], 3.595773),
        (MIRRORED, [0, -6.864655], -3.595773),
        ("--m1 1 --m2 3 --mu 0.3", [3.171200, 8.138364], 0),
    ],
)
def test_curves_are_those_of_the_table_with_a_step_where_the_string_is_stuck(
    words: str, ends: list[float], step: float
) -> None:
    """Of friction: its values at the lighter and at the heavier mass, and where it begins between them."""
    curves = {line.get_label(): line.get_xydata() for line in drawn(f"contact {words}").axes[1].lines}
    angles, frictions = curves["fR = dT/dθ"].T
    assert [*frictions[[0, -1]]] == pytest.approx(ends[:: -1 if words == MIRRORED else 1], rel=1e-6)
    beside = [(one, two) for (x, one), (at, two) in pairwise(curves["fR = dT/dθ"]) if at - x < 1e-9]
    steps = [max(two, key=abs) for two in beside if 0 in two and any(two)]
    assert steps == pytest.approx([step] * bool(step), rel=1e-6)
    drawn_at = curves["nR = T(θ)"][np.argsort(angles, kind="stable")].T
    options = dict(zip(*[iter(words.replace("--", "").split())] * 2, strict=True))
    for point in arc(**options).points:
        assert np.interp(float(point["angle"]), *drawn_at) == pytest.approx(float(point["tension"]), rel=1e-5)


@pytest.mark.filterwarnings("error")
def test_what_matplotlib_warns_of_reaches_nobody(monkeypatch: pytest.MonkeyPatch) -> None:
    figure = pytest.importorskip("matplotlib.figure")
    monkeypatch.setattr(figure.Figure, "suptitle", lambda *_, **__: warnings.warn("a line", stacklevel=1))
    drawn(f"contact {FIGURE}")


SMALL_DISK = """
import resource, signal, sys
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
sys.dont_write_bytecode = True  # which would be cut off, too
resource.setrlimit(resource.RLIMIT_FSIZE, (3000, 3000))
from atwood_cli.__main__ import main
sys.exit(main())
"""
NO_MATPLOTLIB = """
import sys
sys.modules["matplotlib"] = None
from atwood_cli.__main__ import main
sys.exit(main())
"""


@pytest.mark.parametrize(
    ("program", "error"),
    [
        pytest.param(
            SMALL_DISK,
            "cannot write {file}: File too large",
            marks=pytest.mark.skipif(sys.platform == "win32", reason="needs limits of resources"),
        ),
        (NO_MATPLOTLIB, "this needs matplotlib; install it with: pip install 'atwood-cli[figure]'"),
    ],
)
def test_a_figure_that_cannot_be_made_is_a_sentence_and_no_file(
    tmp_path: Path, program: str, error: str
) -> None:
    pytest.importorskip("matplotlib")
    file = tmp_path / "a.svg"
    words = [sys.executable, "-c", program, "contact", *FIGURE.split(), "--figure", str(file)]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr == f"atwood: {error.format(file=file)}\n"
    assert list(tmp_path.iterdir()) == []


def test_a_figure_is_not_drawn_where_standard_output_goes(tmp_path: Path) -> None:
    there = shlex.quote(str(tmp_path))
    ran = process(shell=f"cd {there}; atwood contact --m1 1 --m2 3 --M 10 --figure a.svg --force > a.svg")
    why = "atwood: --figure 'a.svg' is where standard output goes; name another\n"
    assert (ran.status, ran.err, (tmp_path / "a.svg").read_text()) == (2, why, "")


def test_a_sum_of_which_one_term_is_beyond_doubles(atwood: Atwood) -> None:
    ran = atwood(*"contact --m1 9e306 --m2 1e307 --M 1e307 --mu 0.1 --json".split())
    balance = json.loads(ran.out)["balance"]
    assert balance["friction"]["y"] == pytest.approx(-2.0267e306, rel=1e-4)
    assert [balance[name]["y"] for name in ("normal", "sum", "resultant", "residual")] == [None] * 4
