"""The arc of contact: identities, bounds against a linear programme, output, figure."""

import re
import shlex
import warnings
from collections import Counter
from fractions import Fraction
from itertools import pairwise
from math import pi
from pathlib import Path
from typing import Any, cast

import mpmath
import numpy as np
import pytest
from scipy.optimize import linprog, minimize_scalar
from scipy.sparse import diags_array, vstack

from atwood_cli import Scene, SceneError, solve
from atwood_cli.solver.answers import Answers
from atwood_cli.solver.balance import Contact, contact

from . import doors, oracle
from .conftest import many
from .regenerate import CASES
from .running import TOP, called, drawn, misplaced, process
from .scenes import inputs, of_all_kinds


def arc(points: int = 13, digits: int | None = None, **given: Any) -> Contact:
    return contact(Answers(Scene.read(given), digits), points)


def test_forces_along_the_arc_add_up_and_keep_to_the_limits_of_friction() -> None:
    """(20), (23) and (26), to the last digits; where friction is to spare, it is all at the heavier mass's end."""
    mpmath.mp.dps, kinds = 60, Counter[str]()
    for scene in of_all_kinds(many(240)):
        try:
            seen = arc(points=7, digits=30, **scene)
        except SceneError:  # a free end, or a motion that is open
            continue
        kinds[seen.kind] += 1
        s, balance = solve(**scene, digits=40), cast(Any, seen.balance)
        numbers = (s.tension_1, s.tension_2, scene.get("R", 1), scene.get("mu", 0), scene.get("wrap", 180))
        t1, t2, radius, mu, wrap = (mpmath.mpf(str(number)) for number in numbers)
        largest = max(abs(force) for name in ("friction", "normal") for force in balance[name].values())
        # Three roundings to 30 digits, half a unit each, of numbers no larger than that.
        assert all(abs(balance["residual"][axis]) <= 2 * largest / 10**29 for axis in "xy"), scene
        ends, residual = (mpmath.mpf(str(balance["torque"][name])) for name in ("ends", "residual"))
        assert abs(residual) <= abs(ends) / 10**29
        assert abs(ends - (t2 - t1) * radius) <= 2 * max(t1, t2) * radius / 10**29
        low, high, sign, phi = min(t1, t2), max(t1, t2), 1 if t1 <= t2 else -1, mpmath.radians(wrap)
        for i, point in enumerate(seen.points):
            from_light = mpmath.mpf(i if sign > 0 else 6 - i) / 6
            if seen.kind == "exponential":
                tension, friction = low * (high / low) ** from_light, mpmath.log(high / low) / phi
            else:
                creeping = high * mpmath.exp(-mu * phi * (1 - from_light))
                tension, friction = (creeping, mu) if creeping > low else (low, 0)
            per_radian = {"normal": tension, "friction": sign * friction * tension}
            wanted = {"angle": wrap * i / 6, "tension": tension}
            for unit, each in (("radian", 1), *[("metre", radius)] * ("R" in scene)):
                wanted |= {f"{name}_per_{unit}": force / each for name, force in per_radian.items()}
            for name, value in wanted.items():
                there = mpmath.mpf(str(point[name]))
                assert mpmath.almosteq(there, value, rel_eps=mpmath.mpf(10) ** -28), (scene, name)
    assert min(kinds["exponential"], kinds["creep"]) > many(40), kinds


# The bounds of the friction force


GRIPPING = """
m1=3.152 m2=3.735 M=24.299 mu=2.592 wrap=30
m1=3.295 m2=2.697 M=33.193 mu=1.459 wrap=180
m1=3.28 m2=4.514 M=0.219 mu=0.505 wrap=180
m1=1.966 m2=0.6 M=0.56 mu=1.25 wrap=60
m1=0.78 m2=3.126 M=0.24 mu=0.101 wrap=180
m1=1.126 m2=1.156 M=88.565 mu=2.035 wrap=90
m1=1 m2=3 M=10 mu=0.4 wrap=150
""".strip().splitlines()
HARDLY_LOADED = "m1=1 m2=3 M=1e-30 mu=1 wrap=180"
JUST_HOLDS = "m1=1 m2=3 M=10 mu=0.20582781927064069 wrap=180"
"""Where the verge is at 0.205827819270640686: both bounds meet in (32) there."""


@pytest.mark.parametrize("words", GRIPPING)
def test_bounds_against_a_linear_programme(words: str) -> None:
    """All profiles on elements with T_j <= T_{j+1} <= e^{μΔ} T_j, friction at each one's middle.

    The force in a direction is linear in T, so a linear programme finds its extremes; the greatest
    force is the greatest of those over all directions, the least (the distance of a convex set from
    the origin) the greatest of their minima.
    """
    scene: dict[str, Any] = {name: float(x) for name, x in inputs(words).items()}
    solution = solve(**scene)
    low, high = sorted((float(solution.tension_1 or 0), float(solution.tension_2 or 0)))
    count = 150
    # Elements shrink towards the ends, where the limiting arcs of the least force lie.
    nodes = scene["wrap"] * pi / 360 * (1 - np.cos(pi * np.arange(count + 1) / count))
    steps, middle = np.diff(nodes), (nodes[1:] + nodes[:-1]) / 2
    unit = np.stack([-np.sin(middle), np.cos(middle)])
    no_fall, no_slip = (
        diags_array([-growth * sign, sign * np.ones(count)], offsets=[0, 1], shape=(count, count + 1))
        for growth, sign in ((np.ones(count), -1), (np.exp(scene["mu"] * steps), 1))
    )
    bounds = [(low, low), *[(low, high)] * (count - 1), (high, high)]

    def extreme(angle: float, sign: int) -> float:
        along = np.array([np.cos(angle), np.sin(angle)]) @ unit
        costs = sign * (np.concatenate([[0], along]) - np.concatenate([along, [0]]))
        result = linprog(costs, A_ub=vstack([no_fall, no_slip]), b_ub=np.zeros(2 * count), bounds=bounds)
        assert result.status == 0
        return sign * float(result.fun)

    def best(sign: int) -> float:
        """The greatest over all directions, near the greatest of a few."""
        around = max(np.arange(0, 2 * pi, 0.4), key=lambda angle: extreme(angle, sign))
        near = {"bounds": (around - 0.4, around + 0.4), "method": "bounded", "options": {"xatol": 1e-3}}
        return -float(minimize_scalar(lambda angle: -extreme(angle, sign), **near).fun)

    # What elements misplace is of second order in their size, what the direction's search misses too.
    tolerance = (high - low) * (steps.max() ** 2 + 1e-5)
    assert solution.friction_force_min == pytest.approx(best(1), abs=tolerance)
    assert solution.friction_force_max == pytest.approx(best(-1), abs=tolerance)


@pytest.mark.parametrize("words", [HARDLY_LOADED, JUST_HOLDS, *GRIPPING[:3]])
def test_bounds_to_the_last_digit(words: str) -> None:
    """Both bounds from their definitions, the least one by minimising it, at 300 digits."""
    scene = inputs(words)
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


# The figure

FIGURE = "--m1 1 --m2 3 --M 10 --mu 0.3"
MIRRORED = "--m1 3 --m2 1 --M 10 --mu 0.3"


DRAWING = """
import sys
from atwood_cli.cli import run
for file in ("a.svg", "a.png", "a.pdf"):
    assert run([*sys.argv[1:], "--figure", file]) == 0
"""


def test_a_figure_is_the_same_to_the_byte_whenever_and_wherever_it_is_drawn(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It has no date, nor settings of matplotlib: neither those of the folder nor of the environment."""
    pytest.importorskip("matplotlib")
    for place, asked in (("here", {}), ("there", {"MPLBACKEND": "nonsense", "SOURCE_DATE_EPOCH": "abc"})):
        (tmp_path / place).mkdir()
        monkeypatch.chdir(tmp_path / place)
        Path("matplotlibrc").write_text("text.usetex: True\nlines.linewidth: 9\nbackend: bad\nnonsense: 1\n")
        if asked:
            ran = process("contact", *FIGURE.split(), code=DRAWING, PYTHONPATH=str(TOP), **asked)
            assert (ran.status, ran.err) == (0, "")
        else:
            for file in ("a.svg", "a.png", "a.pdf"):
                assert called(["contact", *FIGURE.split(), "--figure", file]).status == 0
    for file, start in (("a.svg", b"<?xml"), ("a.png", b"\x89PNG"), ("a.pdf", b"%PDF")):
        here, there = ((tmp_path / place / file).read_bytes() for place in ("here", "there"))
        assert here == there
        assert here.startswith(start)
        assert b"Date" not in here


LEGIBLE = f"""
{"|".join(f"contact {FIGURE} --wrap {wrap}" for wrap in (1, 76, 90, 181, 225, 251, 269, 345, 2000))}
contact {MIRRORED} --wrap 120
contact {MIRRORED} --axle 3 --wrap 300
contact --m1 2 --m2 2 --M 3 --mu 0.1 --wrap 300
contact --m1 1 --m2 3 --mu 0
contact --m1 1 --m2 3 --M inf --mu 5 --wrap 1e9
contact --m1 1 --m2 3 --M 1 --wrap 1e-99rad
contact --m1 1e-90 --m2 3e90 --M 1 --mu 0.1 --wrap 1e6
contact --m1 1 --m2 3 --M 100 --mu 0.3 --mu-k 0.25 --digits 12
contact --m1 1000 --m2 1 --M 5 --wrap 1440
contact --m1 1.00000000000000000000001 --m2 1 --M 0.3 --mu 0.3
contact --m1 1.{"123456789" * 60} --m2 2.{"123456789" * 60} --M 3.{"1" * 500} --mu 0.{"3" * 500}
"""
(PICTURES,) = (page.read_text(encoding="utf-8") for page in CASES if page.stem == "pictures")
SHOWN = re.findall(r"^\$ atwood ((?:contact|solve) .*) --figure", PICTURES, re.MULTILINE)
"""Pictures whose words stand on a page, and which are looked at here, too."""


@pytest.mark.parametrize("line", [*LEGIBLE.strip().replace("|", "\n").split("\n"), *SHOWN])
def test_all_of_a_figure_can_be_read(line: str) -> None:
    """No words lie over others, and strings leave the pulley along tangents: m1's straight down on the left."""
    page = drawn(line)
    assert misplaced(page) == []
    assert page.get_supxlabel().count("\n") <= 1
    machine = page.axes[0]
    (string,) = (one.get_xydata() @ [1, 1j] for one in machine.lines if one.get_linewidth() == 2.2)
    if "--m1 0 " not in line:
        assert string[0].real == string[1].real == -1
    if "--m2 0 " not in line:
        assert abs(((string[-1] - string[-2]) * string[-2].conjugate()).real) < 0.03  # along the tangent
    assert 0.999 < min(abs(string[1:-1])) <= max(abs(string[1:-1])) < 1.001
    for arrows in machine.collections:
        lengths = np.abs(arrows.U + 1j * arrows.V)
        assert np.all((lengths > 0.01) & (lengths < 0.55))


@pytest.mark.parametrize(("masses", "sign"), [("m1=1 m2=1.5", 1), ("m1=1.5 m2=1", -1)])
@pytest.mark.parametrize("axle", [2, 30])
def test_what_arrows_show(masses: str, sign: int, axle: int) -> None:
    """By their colours: forces where they act, to one scale; accelerations; an axle's friction, which may hold."""
    figure = pytest.importorskip("atwood_cli.output.figure")
    from matplotlib.colors import to_hex

    scene = inputs(f"{masses} M=10 mu=0.4 axle={axle}")
    axes = drawn(" ".join(["solve", *doors.words(scene)])).axes[0]
    (turn,) = (text for text in axes.texts if not text.get_text())
    assert turn.xy[1] == turn.xyann[1] < 0  # below the axle
    assert sign * (turn.xy[0] - turn.xyann[0]) > 0
    arrows: dict[str, list[tuple[complex, complex]]] = {}
    for alike in axes.collections:
        pairs = zip(alike.XY @ [1, 1j], alike.U + 1j * alike.V, strict=True)
        arrows.setdefault(to_hex(alike.get_facecolor()[0]), []).extend(pairs)
    normal, friction = arrows.pop(figure.BLUE), arrows.pop(figure.RED)
    left_to_right = {colour: sorted(pairs, key=lambda pair: pair[0].real) for colour, pairs in arrows.items()}
    up = {colour: [way.imag for _, way in pairs] for colour, pairs in left_to_right.items()}
    s: Any = solve(**scene)
    scale = up[figure.INK][0] / s.tension_1
    assert up.pop(figure.INK) == pytest.approx([scale * s.tension_1, scale * s.tension_2])
    assert up.pop(figure.GREEN) == pytest.approx([-scale * float(scene[m]) * 9.80665 for m in ("m1", "m2")])
    assert [np.sign(way) for way in up.pop(figure.PURPLE, [])] == ([sign, -sign] if axle == 2 else [])
    assert up == {}
    inwards = [-(way * start.conjugate()).real / abs(start) for start, way in normal]
    assert inwards == pytest.approx([abs(way) for _, way in normal])
    assert [min(inwards), max(inwards)] == pytest.approx(sorted([scale * s.tension_1, scale * s.tension_2]))
    around = [-(way * start.conjugate()).imag / abs(start) for start, way in friction]  # clockwise
    assert sign * np.array(around) == pytest.approx([abs(way) for _, way in friction])


@pytest.mark.parametrize("words", ["M=10 mu=0.3", "m1=3 m2=1 M=10 mu=0.3", "mu=0.3"])
def test_curves_are_those_of_the_table_with_a_step_where_the_string_is_stuck(words: str) -> None:
    scene = inputs(words)
    axes = drawn(" ".join(["contact", *doors.words(scene)])).axes[1]
    curves = {line.get_label(): line.get_xydata() for line in axes.lines}
    colours = [line.get_color() for line in axes.lines if line.get_label() in ("nR = T(θ)", "fR = dT/dθ")]
    assert len({*colours}) == 2
    for name, column in (("nR = T(θ)", "tension"), ("fR = dT/dθ", "friction_per_radian")):
        for point in arc(**scene).points:
            drawn_at = np.interp(float(point["angle"]), *curves[name].T)
            assert drawn_at == pytest.approx(float(point[column]), rel=1e-5)
    # Friction begins at its limit where the string begins to creep, and the arc before is grey.
    beside = [(here, there) for (x, here), (at, there) in pairwise(curves["fR = dT/dθ"]) if at - x < 1e-9]
    s: Any = solve(**scene)
    step = float(scene["mu"]) * min(s.tension_1, s.tension_2) * np.sign(s.acceleration)
    steps = [max(two, key=abs) for two in beside if 0 in two and any(two)]
    assert steps == pytest.approx([step] * ("M" in scene), rel=1e-6)
    (grey,) = [patch.get_extents() for patch in axes.patches] if steps else [None]
    if grey:
        edge = axes.transData.inverted().transform([(grey.x0, 0), (grey.x1, 0)])[:, 0]
        assert 180 * (scene["m1"] == "3") in edge


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
"""
NO_MATPLOTLIB = 'import sys; sys.modules["matplotlib"] = None'
INSTALL = "this needs matplotlib; install it with: pip install 'atwood-cli[figure]'"


@pytest.mark.parametrize("error", ["cannot write {}: File too large", INSTALL])
def test_a_figure_that_cannot_be_made_is_a_sentence_and_no_file(tmp_path: Path, error: str) -> None:
    pytest.importorskip("matplotlib")
    pytest.importorskip("resource")
    setting, file = NO_MATPLOTLIB if error == INSTALL else SMALL_DISK, tmp_path / "a.svg"
    code = f"{setting}\nfrom atwood_cli.__main__ import main\nsys.exit(main())"
    ran = process("contact", *FIGURE.split(), "--figure", str(file), code=code)
    assert ran == (1, "", f"atwood: {error.format(file)}\n")
    assert list(tmp_path.iterdir()) == []


def test_a_figure_is_not_drawn_where_standard_output_goes(tmp_path: Path) -> None:
    there = shlex.quote(str(tmp_path))
    ran = process(shell=f"cd {there}; atwood contact --m1 1 --m2 3 --M 10 --figure a.svg --force > a.svg")
    why = "atwood: --figure 'a.svg' is where standard output goes; name another\n"
    assert (ran.status, ran.err, (tmp_path / "a.svg").read_text()) == (2, why, "")
