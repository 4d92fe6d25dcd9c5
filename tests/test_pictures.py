"""Pictures: what they show is what the pages say, to scale, and can be read. Their words stand in `cases/pictures.md`."""

import csv
import json
import re
import shlex
import warnings
from itertools import chain, pairwise
from pathlib import Path
from typing import Any, cast
from unittest.mock import patch

import numpy as np
import pytest

from atwood_cli import solve
from atwood_cli.output import figure
from atwood_cli.output.forms import Picture
from atwood_cli.tradeoff.measure import FAMILIES, SETTINGS, Measured
from atwood_cli.tradeoff.tradeoff_page import GREATEST, LEAST
from atwood_cli.tradeoff.tradeoff_page import save as save_tradeoff

from .tools import doors, running
from .tools.regenerate import CASES
from .tools.running import TOP, called, labels, misplaced, pages_seen, process, words_on
from .tools.scenes import inputs

(PICTURES,) = (page.read_text(encoding="utf-8") for page in CASES if page.stem == "pictures")
KEPT = re.findall(r"^\$ (?:printf '(.*)' \| )?atwood (.*) --figure \S+([^|\n]*)", PICTURES, re.MULTILINE)
FIGURE = "--m1 1 --m2 3 --M 10 --mu 0.3"
MORE = f"""
{"|".join(f"contact {FIGURE} --wrap {wrap}" for wrap in (1, 76, 225, 300, 345, 2000))}
contact --m1 3 --m2 1 --M 10 --mu 0.3 --wrap 120 --bare
contact --m1 3 --m2 1 --M 10 --mu 0.3 --axle 3 --wrap 300
contact --m1 2 --m2 2 --M 3 --mu 0.1 --wrap 300
contact --m1 1 --m2 3 --mu 0
contact --m1 0.5 --m2 0.51 --M 0.05
contact --m1 1 --m2 3 --M inf --mu 5 --wrap 1e9
contact --m1 1 --m2 3 --M 1 --wrap 1e-99rad
contact --m1 1e-90 --m2 3e90 --M 1 --mu 0.1 --wrap 1e6
contact --m1 1 --m2 3 --M 100 --mu 0.3 --mu-k 0.25 --digits 12
contact --m1 1.00000000000000000000001 --m2 1 --M 0.3 --mu 0.3
contact --m1 1.{"123456789" * 60} --m2 2.{"123456789" * 60} --M 3.{"1" * 500} --mu 0.{"3" * 500}
solve --m1 1 --m2 3 --M 10 --drop 1 --time 1.2|solve --m1 3 --m2 1 --M 10 --mu 0.3|solve --m1 1 --m2 3 --M 10 --mu 50
solve --m1 0 --m2 3|solve --m1 0 --m2 3 --M 6|solve --m1 1 --m2 3 --M inf --mu 0.3 --axle 2
solve --m1 1 --m2 3 --g 1.2345 --M 10 --digits 3
sweep --m1 1 --m2 3 --axle 0:3:4 --M 10|sweep --m1 1 --m2 3 --mu 0.3 --M 10,inf
sweep --only T1,T2,mu_verge --m1 1000 --m2 400:1000:3 --mu 0.1,0.2 --M 100
sweep --only friction_force,mu_verge,a --m1 1 --m2 3 --M 1:1000:6:log --mu 0.3 --inertia disk,1/3
sweep --only friction_force --m1 1 --m2 3 --M 0:50:6 --mu 0.15:0.4:6
sweep --only tension_2 --m1 1 --m2 3 --mu 0:0.5:9
sweep --m1 1 --m2 3 --M 20 --mu 0.3 --mu-k 0.2 --wrap 1rad:7rad:5
sweep --only torque --m1 1 --m2 3 --M 1e-20:2e-20:3 --R 1e-5
sweep --m1 1 --m2 3 --M 1,9.9,10,10.1,11,1000,inf --mu 0.2,0.3
sweep --only critical_pulley_mass --m1 1 --m2 3 --M 1:10:3 --mu 0.1,0.6
sweep --m1 1 --m2 3 --M 1:1.00000000000000000001:3
"""
LINES = [("", line) for line in MORE.strip().replace("|", "\n").split("\n")]
LINES += [(table, words + rest) for table, words, rest in KEPT]


def drawn(line: str, table: str = "") -> Any:
    """The picture that a command line has, with fewer steps of curves than usual."""
    with patch("atwood_cli.sweep.sweep_figure.CURVE_STEPS", 20):
        return running.drawn(line, table.encode().decode("unicode_escape").encode())


@pytest.mark.parametrize(("table", "line"), LINES)
def test_all_of_a_picture_can_be_read(table: str, line: str) -> None:
    """No words lie over others or run off, and titles are no smaller than ticks."""
    page = drawn(" ".join(shlex.split(line)), table)
    assert misplaced(page) == []
    panels = 1 if line.startswith("solve") else len(page.axes)
    assert page.get_size_inches().tolist() == [6.4, 4 + 2 * (panels - 1)]
    title = page._suptitle.get_fontsize()
    ticks = [text for axes in page.axes for text in (*axes.get_xticklabels(), *axes.get_yticklabels())]
    assert all(text.get_fontsize() <= title for text in ticks)
    said = " ".join(words_on(page))
    assert not re.search(r"(?<![\w.)])-\d|\de[-\d]|10⁰|\bmu\b|\bm1\b|[a-z]_[a-z]", said), said
    assert [*chain(*map(crossed, page.axes))] == []
    if "--symbols" in line:
        assert not re.search(r"\d", re.split("acceleration a|Friction is|Drawn", said)[0]), said


def crossed(axes: Any) -> list[str]:
    """The words through which a curve, an error bar or an arrow runs."""
    paths = [way for one in axes.collections if hasattr(one, "get_segments") for way in one.get_segments()]
    for line in axes.lines if axes.axison else ():
        if line.get_linestyle() != "None" and line.get_zorder() > 0 and len(line.get_xdata()) > 2:
            paths.append(line.get_xydata())
    for start, way in chain(*arrows_of(axes).values()):
        paths.append(np.column_stack([np.real([start, start + way]), np.imag([start, start + way])]))
    steps, points = np.linspace(0, 1, 50)[:, None, None], [np.empty((0, 2))]
    for path in map(axes.transData.transform, paths):
        points.append((path[:-1] + steps * np.diff(path, axis=0)).reshape(-1, 2))
    drawn_on = np.concatenate(points)
    boxes = [(text.get_text(), text.get_window_extent()) for text in axes.texts if text.get_text()]
    return [text for text, box in boxes if ((drawn_on > box.min) & (drawn_on < box.max)).all(axis=1).any()]


# The machine


def arrows_of(axes: Any) -> dict[str, list[tuple[complex, complex]]]:
    """The arrows by colour, from left to right: where each begins, and its vector."""
    from matplotlib.colors import to_hex

    arrows: dict[str, list[tuple[complex, complex]]] = {}
    for alike in (one for one in axes.collections if hasattr(one, "XY")):
        pairs = zip(alike.XY @ [1, 1j], alike.U + 1j * alike.V, strict=True)
        arrows.setdefault(to_hex(alike.get_facecolor()[0]), []).extend(pairs)
    return {colour: sorted(pairs, key=lambda pair: pair[0].real) for colour, pairs in arrows.items()}


@pytest.mark.parametrize(("masses", "sign"), [("m1=1 m2=1.5", 1), ("m1=1.5 m2=1", -1)])
@pytest.mark.parametrize("axle", [2, 30])
def test_what_arrows_show(masses: str, sign: int, axle: int) -> None:
    """Weights point down and tensions up the string, to one scale; a pulley turns, or its axle holds it."""
    scene = inputs(f"{masses} M=10 mu=0.4 axle={axle}")
    axes = drawn(" ".join(["solve", *doors.words(scene)])).axes[0]
    arrows, s = arrows_of(axes), cast(Any, solve(**scene))
    weights = [float(scene[m]) * 9.80665 for m in ("m1", "m2")]
    scale = 0.84 / max(weights)
    up = [way for _, way in arrows.pop(figure.INK)]
    assert up == pytest.approx([1j * scale * s.tension_1, 1j * scale * s.tension_2])
    assert [way for _, way in arrows.pop(figure.GREEN)] == pytest.approx([-1j * scale * W for W in weights])
    normal, friction = arrows.pop(figure.BLUE), arrows.pop(figure.RED)
    inwards = [-(way * start.conjugate()).real / abs(start) for start, way in normal]
    assert inwards == pytest.approx([abs(way) for _, way in normal])
    assert min(inwards) / max(inwards) == pytest.approx(min(up, key=abs).imag / max(up, key=abs).imag)
    around = [-(way * start.conjugate()).imag / abs(start) for start, way in friction]  # clockwise
    assert sign * np.array(around) == pytest.approx([abs(way) for _, way in friction])
    between = abs(normal[0][0] + normal[0][1] - normal[1][0] - normal[1][1])  # of places on the rim
    assert max(inwards) == pytest.approx(max(map(abs, around))) == pytest.approx(0.9 * between, rel=0.06)
    assert arrows == {}
    paths = [line.get_xydata() @ [1, 1j] for line in axes.lines if line.get_color() == figure.PURPLE]
    motions = [(path[0], path[-1]) for path in paths if len(path) > 1]
    assert [path[0] for path in paths if len(path) == 1] == [end for _, end in motions]  # the heads
    if axle == 30:
        assert motions == []
        return
    turning, *moving = sorted(motions, key=lambda ends: -ends[0].imag)
    assert np.sign((turning[1] - turning[0]).real) == sign  # above the axle
    ways = [end - start for start, end in sorted(moving, key=lambda ends: ends[0].real)]
    assert [np.sign(way.imag) for way in ways] == [sign, -sign]


@pytest.mark.parametrize("wrap", [1, 90, 200, 270, 345, 1441])
@pytest.mark.parametrize("masses", ["--m1 1 --m2 3", "--m1 3 --m2 1"])
def test_on_other_wraps_the_tensions_pull_along_the_tangents(wrap: int, masses: str) -> None:
    """At 200° a block lay over the pulley, on a slanted string, with a weight along it."""
    page = drawn(f"solve {masses} --M 10 --mu 0.3 --wrap {wrap}")
    axes = page.axes[0]
    arrows = dict(arrows_of(axes)[figure.INK])
    last = -np.exp(-1j * np.radians(wrap))
    at_1, at_2 = (arrows[min(arrows, key=lambda start: abs(start - end))] for end in (-1, last))
    assert at_1 == pytest.approx(-1j * abs(at_1))
    assert at_2 == pytest.approx(-1j * last * abs(at_2))  # on from the arc, which runs clockwise
    assert figure.GREEN not in arrows_of(axes)
    assert len(axes.patches) == 1
    assert not [text for text in axes.texts if text.get_text().startswith(("m", "W", "a"))]
    assert "What hangs on the string is not drawn." in " ".join(page.get_supxlabel().split())


def test_blocks_are_in_proportion_to_the_masses() -> None:
    for heavier, ratio in (("4", 4), ("9", 9), ("1000", 9)):
        axes = drawn(f"solve --m1 1 --m2 {heavier} --M 1").axes[0]
        boxes = [one.get_paths()[0].get_extents() for one in axes.collections if not hasattr(one, "XY")]
        small, large = sorted(box.width * box.height for box in boxes)
        assert large / small == pytest.approx(ratio)


@pytest.mark.parametrize("words", ["M=10 mu=0.3", "m1=3 m2=1 M=10 mu=0.3", "mu=0.3"])
def test_curves_are_those_of_the_table_with_a_step_where_the_string_is_stuck(words: str) -> None:
    scene = inputs(words)
    line = " ".join(["contact", *doors.words(scene)])
    axes = drawn(line).axes[1]
    normal, friction = (one.get_xydata() for one in axes.lines[1:])
    for row in csv.DictReader(called([*line.split(), "--csv"]).out.splitlines()):
        for curve, column in ((normal, "tension"), (friction, "friction_per_radian")):
            there = np.interp(float(row["angle"]), *curve.T)
            assert there == pytest.approx(float(row[column]), rel=1e-5)
    # Friction begins at its limit where the string begins to creep, and the arc before is grey.
    beside = [(here, there) for (x, here), (at, there) in pairwise(friction) if at - x < 1e-9]
    s: Any = solve(**scene)
    step = float(scene["mu"]) * min(s.tension_1, s.tension_2) * np.sign(s.acceleration)
    steps = [max(two, key=abs) for two in beside if 0 in two and any(two)]
    assert steps == pytest.approx([step] * ("M" in scene), rel=1e-6)
    stuck = [text for text in axes.texts if text.get_text() == "no friction"]
    if steps:
        (grey,), (text,) = axes.patches, stuck
        box, band = text.get_window_extent(), grey.get_window_extent()
        assert band.x0 < box.x0 < box.x1 < band.x1
        edge = axes.transData.inverted().transform([(band.x0, 0), (band.x1, 0)])[:, 0]
        assert 180 * (scene["m1"] == "3") in edge.round(9)
    assert (axes.get_ylim()[0] == 0) == (s.acceleration > 0)
    assert (axes.get_xlim(), axes.get_xticks().tolist()) == ((0, 180), [0, 30, 60, 90, 120, 150, 180])


# Sweeps


def test_a_legend_has_the_order_of_the_curves_at_the_right_end_and_what_their_dots_are() -> None:
    """Twelve dots of this picture crowd. What marks say is held to the table in `test_sweep`."""
    page = drawn("sweep --m1 0.1:30:7 --m2 3 --M 50 --mu 0.05:0.3:6")
    (axes,) = page.axes
    curves = [line for line in axes.lines if len(line.get_xdata()) > 2]
    ends = [line.get_label() for line in sorted(curves, key=lambda line: -line.get_ydata()[-1])]
    entries = [text.get_text() for text in axes.get_legend().get_texts()]
    assert entries[::3] == ends
    assert all(re.match("holds from", entry) for entry in entries[1::3])
    assert all(re.match("slips beyond", entry) for entry in entries[2::3])
    assert sum(line.get_marker() == "o" for line in axes.lines) == 12 == 2 * len(ends)


def test_a_scene_looks_the_same_in_all_panels() -> None:
    page = drawn("sweep --m1 1 --m2 3 --mu 0.2,0.3 --M 10:60:2 --only a,T1,tension_2 --csv")
    one, two = (
        {line.get_label(): (line.get_color(), line.get_linestyle()) for line in axes.get_legend().get_lines()}
        for axes in page.axes
    )
    assert "slips beyond 43.3419 kg" in one
    one, two = ({x: look for x, look in panel.items() if "slips" not in x} for panel in (one, two))
    assert {*one} == {"μ = 0.2", "μ = 0.3"}
    assert {*two} == {f"{T}, {scene}" for T in ("T₁", "T₂") for scene in one}
    assert [two[f"T₁, {scene}"] for scene in one] == [*one.values()]


@pytest.mark.parametrize(
    ("words", "zero"),
    [
        ("--m1 1 --m2 3 --M 0:50:6", "low"),
        ("--m1 3 --m2 1 --M 0:50:6", "high"),
        ("--m1 1 --m2 3 --M 0:1:6", ""),
        ("--m1 1 --m2 0.5:3:6 --M 1", "within"),
    ],
)
def test_an_axis_starts_at_0_where_no_more_than_half_of_it_is_empty(words: str, zero: str) -> None:
    page = drawn(f"sweep {words}")
    (low, high), lines = page.axes[0].get_ylim(), page.axes[0].lines
    crossed_at_0 = any({*line.get_ydata()} == {0} for line in lines)
    assert (low == 0, high == 0, crossed_at_0) == (zero == "low", zero == "high", zero == "within")
    assert page.axes[0].get_legend() is None  # of a single curve


def test_lists_are_points_with_names_at_equal_distances_a_locked_pulley_too() -> None:
    planets = drawn("sweep --m1 1 --m2 3 --g earth,moon,uranus,venus --only a").axes[0]
    assert [text.get_text() for text in planets.get_xticklabels()] == ["earth", "moon", "uranus", "venus"]
    (points,) = planets.lines
    assert (points.get_linestyle(), points.get_marker()) == ("None", "o")
    assert points.get_ydata() == pytest.approx([g / 2 for g in (9.80665, 1.62, 8.87, 8.87)])
    masses = drawn("sweep --m1 1 --m2 3 --M 1,10,1000,inf --mu 0.3").axes[0]
    assert [text.get_text() for text in masses.get_xticklabels()] == ["1", "10", "1000", "locked"]
    assert masses.lines[0].get_xdata().tolist() == [0, 1, 2, 3]
    assert masses.lines[0].get_ydata()[3] == solve(m1="1", m2="3", M="inf", mu="0.3").acceleration


# Fits


MADE = "m1,m2,a\n0.1,0.11,0.334\n0.2,0.212,0.2230\n0.15,0.18,0.770\n0.3,0.32,0.2740\n0.05,0.06,0.580\n"


@pytest.mark.parametrize(
    ("find", "words"),
    [
        ("rim_mass,axle", "slope c|intercept f"),
        ("gravity --M 0.05 --axle 0.02", "g"),
        ("gravity,rim_mass,axle", "slope c|intercept f|g"),
    ],
)
def test_the_line_has_the_fitted_slope_and_intercept(find: str, words: str) -> None:
    fit = json.loads(called(f"fit - --find {find} --json".split(), MADE.encode()).out)
    line, rest = drawn(f"fit - --find {find}", MADE).axes
    (x0, y0), (x1, y1) = line.lines[0].get_xydata()
    c, f = fit["rim_mass"], fit["axle"]
    assert ((y1 - y0) / (x1 - x0), y0) == pytest.approx((0.025, 0.02) if c is None else (c, f))
    said = next(text.get_text() for text in line.texts if " ± " in text.get_text())
    assert [one.split(" = ")[0] for one in said.splitlines()] == words.split("|")
    residuals = [run["residual"] for run in fit["runs"]]
    (points,) = (one for one in rest.lines if len(one.get_xdata()) == 5)
    assert points.get_ydata() == pytest.approx(residuals)
    assert {y for one in rest.lines for y in one.get_ydata()} >= {-2, 0, 2}


# Files

DRAWING = """
import sys
from atwood_cli.cli import run
for file in sys.argv[1:]:
    run(["solve", *"--m1 1 --m2 3 --M 10 --mu 0.3".split(), "--figure", file, "--force"])
"""


def test_a_picture_is_the_same_to_the_byte_whenever_and_wherever_it_is_drawn(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It has no date, nor settings of matplotlib: neither those of the folder nor of the environment."""
    monkeypatch.chdir(tmp_path)
    starts = {"a.svg": b"<?xml", "a.png": b"\x89PNG", "a.pdf": b"%PDF"}
    here = {}
    for file in starts:
        assert called(["solve", *FIGURE.split(), "--figure", file]).status == 0
        here[file] = Path(file).read_bytes()
    Path("matplotlibrc").write_text("text.usetex: True\nlines.linewidth: 9\nbackend: bad\nnonsense: 1\n")
    strange = {"MPLBACKEND": "nonsense", "SOURCE_DATE_EPOCH": "abc", "PYTHONPATH": str(TOP)}
    ran = process(*starts, code=DRAWING, **strange)
    assert (ran.status, ran.err) == (0, "".join(f"atwood: wrote {file}\n" for file in starts))
    for file, start in starts.items():
        assert Path(file).read_bytes() == here[file]
        assert here[file].startswith(start)
        assert b"Date" not in here[file]
    assert int.from_bytes(here["a.png"][16:20]) == 6.4 * 300
    assert b"/FontFile2" in here["a.pdf"]  # TrueType, type 42
    assert b"/Type3" not in here["a.pdf"]


CROWDED = "sweep --m1 0.1:30:7 --m2 3 --M 50 --mu 0.05:0.3:6 --only a,friction_force"


@pytest.mark.parametrize("line", [f"contact {FIGURE} --wrap 2.5turn", CROWDED])
def test_an_svg_is_small_has_its_text_as_text_a_title_and_a_description(tmp_path: Path, line: str) -> None:
    from matplotlib.figure import Figure

    file = tmp_path / "a.svg"
    with patch.object(Figure, "savefig", autospec=True, side_effect=Figure.savefig) as saved:
        assert called([*line.split(), "--figure", str(file)]).status == 0
    svg, page = file.read_text(encoding="utf-8"), saved.call_args.args[0]
    assert len(svg) < 50_000
    title, described, *texts = labels(svg)
    said = [text for axes in page.axes for text in (axes.xaxis.label, axes.yaxis.label, *axes.texts)]
    assert {words for text in said for words in text.get_text().splitlines()} <= {*texts}
    around = f"{page.get_suptitle()}{page.get_supxlabel()}"
    assert "".join(f"{title}{described}".split()) == "".join(around.split())


@pytest.mark.filterwarnings("error")
def test_what_matplotlib_warns_of_reaches_nobody(monkeypatch: pytest.MonkeyPatch) -> None:
    from matplotlib.figure import Figure

    monkeypatch.setattr(Figure, "suptitle", lambda *_, **__: warnings.warn("a line", stacklevel=1))
    running.drawn(f"solve {FIGURE}")


# The picture of tradeoff


def test_the_picture_of_tradeoff_has_a_panel_for_each_family(tmp_path: Path) -> None:
    names = [*SETTINGS]
    off = dict(zip(names, (None, 39.2, 0.499, 4.2e-34), strict=True))
    measured = [Measured(family, name, 1e-7, None, off[name], 0.0) for family in FAMILIES for name in names]
    for bare in (False, True):
        with pages_seen() as pages:
            save_tradeoff(measured, Picture(str(tmp_path / "a.svg"), force=True, bare=bare))
        (page,) = pages
        assert misplaced(page) == []
        assert bool(page.get_suptitle()) != bare
        assert [axes.get_title() for axes in page.axes] == list(FAMILIES)
        assert all(axes.title.get_fontsize() < page._suptitle.get_fontsize() for axes in page.axes)
        assert len([axes for axes in page.axes if axes.get_xlabel()]) == 1
        (legend,) = page.legends
        assert [text.get_text() for text in legend.get_texts()] == names
        for axes in page.axes:
            assert [line.get_ydata()[0] for line in axes.lines] == [GREATEST, 39.2, 0.499, LEAST]
