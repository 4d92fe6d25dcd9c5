"""`atwood sweep`: ranges, rows that `solve` repeats, output, files, curves."""

import csv
import io
import re
import sys
from collections.abc import Iterator
from decimal import Decimal
from fractions import Fraction
from itertools import pairwise
from math import isnan
from operator import itemgetter
from pathlib import Path
from typing import Any

import mpmath
import pytest
from hypothesis import given
from hypothesis import strategies as st

from atwood_cli import solve
from atwood_cli.model.digits import SHOWN_DIGITS
from atwood_cli.model.quantities import STANDARD
from atwood_cli.model.scene import INPUTS
from atwood_cli.sweep.ranges import Row, read_list, read_range, read_sweep, solve_rows
from atwood_cli.sweep.sweep_figure import Curve, picture

from .running import Atwood, drawn, misplaced, on_terminal, plain, process

SWEEP = ["sweep", "--m1", "1", "--m2", "3", "--mu", "0.3"]
HELD = ["sweep", "--m1", "1", "--m2", "3"]


def points(typed_range: str) -> list[str]:
    return [point.text for point in read_range("M", typed_range).points]


# Ranges


@given(st.fractions("1/99", 100), st.fractions(1, 100), st.integers(2, 9), st.sampled_from(["", "rad"]))
def test_a_point_is_exactly_what_is_printed(start: Fraction, stop: Fraction, count: int, unit: str) -> None:
    if start == stop:
        return
    range_ = read_range("wrap", f"{start}{unit}:{stop}{unit}:{count}")
    for point in [*range_.points, *read_list("wrap", f"{start}{unit},{stop}{unit}").points]:
        assert Fraction(point.text.removesuffix("rad")) == point.exact


decimals = st.decimals(min_value=0, max_value=10**6, allow_nan=False, places=6)


@given(decimals, decimals.filter(bool), st.integers(2, 40), st.booleans())
def test_decimal_steps_are_exact(start: Decimal, step: Decimal, count: int, down: bool) -> None:
    expected = [Fraction(start) + i * Fraction(step) for i in range(count)]
    if down:
        expected.reverse()
    ends = (str(Decimal(q.numerator) / Decimal(q.denominator)).lower() for q in (expected[0], expected[-1]))
    texts = points(f"{':'.join(ends)}:{count}")
    assert list(map(Fraction, texts)) == expected
    assert max(map(len, texts)) < 20


@given(decimals, decimals, st.integers(2, 50), st.booleans())
def test_ends_are_hit_and_points_advance(start: Decimal, stop: Decimal, count: int, log: bool) -> None:
    if start == stop or (log and 0 in (start, stop)):
        return
    values = list(map(Fraction, points(f"{start:f}:{stop:f}:{count}{':log' * log}")))
    assert (values[0], values[-1], len(values)) == (Fraction(start), Fraction(stop), count)
    assert all((a < b) == (start < stop) and a != b for a, b in pairwise(values))


@given(
    st.integers(1, 10**6), st.integers(1, 10**6), st.integers(3, 2000),
    st.sampled_from([None, 1, 3, 9, 17, 60]), st.booleans(),
)  # fmt: skip
def test_points_a_person_can_read_lie_where_they_should(
    start: int, stop: int, count: int, digits: int | None, log: bool
) -> None:
    """Rounded to the digits shown, or as many more as leave them within a two-hundredth of a step."""
    if start == stop:
        return
    texts = [point.text for point in read_range("M", f"{start}:{stop}:{count}{':log' * log}", digits).points]
    with mpmath.workdps(90):
        for i in range(0, count - 1, count // 50 + 1):
            shares = [mpmath.mpf(i) / (count - 1), mpmath.mpf(i + 1) / (count - 1)]
            right, after = (
                start * (mpmath.mpf(stop) / start) ** share if log else start + (stop - start) * share
                for share in shares
            )
            off = abs(mpmath.mpf(texts[i]) - right)
            assert off <= abs(after - right) / 199
            assert off <= right * 5.000001 * mpmath.mpf(10) ** -(digits or SHOWN_DIGITS)
    if digits or log:
        longest = max(len(point.strip("0.").replace(".", "")) for point in texts[1:-1])
        assert longest <= max(13, digits or 0)


# Rows


GRIDS = [
    {"m1": "1", "m2": "3", "mu": "0.3", "M": "0:100:7"},
    {"m1": "0.5:4:8", "m2": "2", "M": "5", "mu": "0.1:0.4:4"},
    {"m1": "100g:300g:3", "m2": "200g", "M": "1:1000:5:log", "R": "5cm"},
    {"m1": "1", "m2": "3", "mu": "0.3", "mu_k": "0:0.3:4", "M": "50", "wrap": "1rad:7rad:4"},
    {"m1": "1", "m2": "3", "mu": "0.1:0.35:6"},
    {"m1": "1e-400:3e-400:3", "m2": "2", "g": "1:25:4"},
    {"m1": "1", "m2": "3", "M": "inf,20,0.1", "inertia": "disk,2/7", "mu": "0.3"},
    {"m1": "1", "m2": "3", "M": "1,50", "I": "1", "R": "1", "mu": "0.3"},
    {"m1": "1", "m2": "3", "M": "50", "mu": "0.3", "g": "1:25:3", "axle": "2"},
]


@pytest.mark.parametrize("digits", [None, "30"])
@pytest.mark.parametrize("grid", GRIDS, ids=str)
def test_every_row_is_what_solve_prints_for_its_values(
    atwood: Atwood, grid: dict[str, str], digits: str | None
) -> None:
    options = [f"--digits={digits}"] if digits else []
    words = {name: f"--{name.replace('_', '-')}" for name in grid}
    ran = atwood("sweep", *(f"{words[n]}={grid[n]}" for n in grid), *options, "--csv")
    assert ran.status == 0
    rows = list(csv.DictReader(io.StringIO(ran.out)))
    swept = [name for name in INPUTS if re.search("[:,]", grid.get(name, ""))]
    assert list(rows[0]) == [*swept, *STANDARD]
    for row in rows:
        scene = grid | {name: row[name] for name in swept}
        only = [f"--only={name}" for name in STANDARD]
        one = atwood("solve", *(f"{words[n]}={scene[n]}" for n in grid), *options, *only, "--csv")
        assert next(csv.DictReader(io.StringIO(one.out))) == {name: row[name] for name in STANDARD}


def test_only_what_is_asked_for_is_computed() -> None:
    (row, _) = solve_rows(read_sweep({"m1": "1", "m2": "3", "M": "1:2:2"}), ["tension_1"], None)
    assert list(row.values) == ["tension_1"]


# Output


@pytest.mark.parametrize("environment", [{}, {"FORCE_COLOR": "1"}, {"COLUMNS": "40", "LINES": "5"}])
def test_a_pipe_gets_every_row(environment: dict[str, str]) -> None:
    ran = process(*SWEEP, "--M", "0:100:101", "--only", "regime", **environment)
    assert len(re.findall(r"^│ +\d+ ", ran.out, re.MULTILINE)) == 101
    assert "..." not in ran.out


@pytest.mark.parametrize("columns", [30, 60, 110])
def test_a_terminal_gets_every_row_and_every_column(columns: int) -> None:
    """Of 12 rows the six in the middle were left out, and columns went into a table below."""
    seen = plain(on_terminal(*HELD, "--mu", "0:0.33:12", columns=columns, rows=10))
    rows = [line for line in seen.splitlines() if re.match(r"│ +\d", line)]
    assert len(rows) == 12
    assert {row.count("│") for row in rows} == {8}
    assert ("critical_pulley_mass" in seen) == (columns == 110)


def test_only_what_is_needed_is_imported() -> None:
    code = (
        "import sys; from atwood_cli.cli import run; run(sys.argv[1:]); print(*sys.modules, file=sys.stderr)"
    )
    words = [*HELD, "--M", "1:2:2", "--only", "tension_1", "--csv"]
    assert not {"rich", "numpy", "matplotlib"} & set(process(*words, code=code).err.split())


# Files


@pytest.mark.parametrize(
    "typed",
    [
        "contact --m1 1 --m2 3",
        "fit {rit} --drop 98cm",
        "quantities",
        "sweep --m1 1 --m2 3 --M 1:2:3 --only tension_1,torque",  # there is no torque
        "solve --m1 1 --m2 3 --M 1 --only tension_1,torque",
    ],
)
def test_a_file_gets_what_stdout_would(atwood: Atwood, tmp_path: Path, typed: str) -> None:
    words = typed.format(rit=Path(__file__).parent.parent / "examples" / "rit.csv").split()
    for printed_by, ways in {
        "": ["a.txt", "a"],
        "--csv": ["a.csv", "a.CSV", "a.csv --csv"],
        "--json": ["a.json", "a --json"],
    }.items():
        printed = atwood(*words, *printed_by.split())
        assert printed.status == ("torque" in typed)
        assert atwood(*words, *printed_by.split(), "-o", "-") == printed
        for way in ways:
            assert atwood(*words, "-o", *f"{tmp_path}/{way}".split()) == printed._replace(out="")
            (file,) = tmp_path.iterdir()
            assert (file.name, file.read_bytes().decode()) == (way.split()[0], printed.out)
            file.unlink()


def test_what_is_in_a_file_is_whole_and_uncoloured(tmp_path: Path) -> None:
    solve_ = ["solve", *HELD[1:], "--M", "1"]
    for name, words in {
        "a.md": [*solve_, "--explain", "--markdown"],
        "a.txt": [*solve_, "--explain"],
        "b.txt": solve_,
        "c.txt": [*SWEEP, "--M", "0:100:101"],
    }.items():
        file = tmp_path / name
        assert on_terminal(*words, "-o", str(file), columns=40, rows=5, FORCE_COLOR="1") == ""
        assert file.read_text(encoding="utf-8") == process(*words).out


def test_a_file_that_cannot_be_written(atwood: Atwood, tmp_path: Path) -> None:
    for file, reason in (
        (tmp_path / "no" / "a.csv", "No such file or directory"),
        (Path(__file__) / "a.csv", "Not a directory"),
        (tmp_path, "Is a directory"),
    ):
        ran = atwood(*HELD, "--M", "1:2:3", "--output", str(file))
        assert (ran.status, ran.out, ran.err) == (1, "", f"atwood: cannot write {file}: {reason}\n")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
def test_a_device_is_written_to_as_it_is(atwood: Atwood) -> None:
    ran = atwood(*HELD, "--M", "1:2:3", "-o", "/dev/full")
    assert (ran.status, ran.err) == (1, "atwood: cannot write the output: No space left on device\n")
    assert not Path("/dev/full").is_file()


@pytest.mark.parametrize(
    "words",
    [
        "sweep --M 1:2:3 --output FILE",
        "solve --mu 0.3 --only M* --csv --output FILE",
        "sweep --M 1:2:3 --figure FILE",
        "contact --M 1 --figure FILE",
    ],
)
def test_a_file_is_replaced_only_by_force(atwood: Atwood, tmp_path: Path, words: str) -> None:
    pytest.importorskip("matplotlib")
    file = tmp_path / ("a.svg" if "figure" in words else "a.csv")
    file.write_text("kept")
    command, *rest = words.replace("FILE", str(file)).split()
    ran = atwood(command, "--m1", "1", "--m2", "3", *rest)
    assert (ran.status, ran.out) == (1, "")
    assert ran.err == f"atwood: cannot write {file}: it exists already; --force replaces it\n"
    assert file.read_text() == "kept"
    assert atwood(command, "--m1", "1", "--m2", "3", *rest, "--force").status == 0
    assert file.read_text(encoding="utf-8").startswith(("<?xml", "M,", "critical"))
    assert list(tmp_path.iterdir()) == [file]


# Curves


def curves(name: str, mu: str, M: str = "0:50:6", **more: str) -> list[Curve]:
    """Those of a quantity, in the one panel that it has."""
    (found,) = picture(read_sweep({"m1": "1", "m2": "3", "M": M, "mu": mu, **more}), [name]).panels.values()
    return found


@pytest.mark.parametrize(
    "words",
    [
        "a,T1,T2 --m1 1 --m2 3 --M 0:50:6 --mu 0.2,0.3,0.25",
        "T1,T2,mu_verge --m1 1000 --m2 400:1000:3 --mu 0.1,0.2 --M 100",
        "friction_force,mu_verge,a --m1 1 --m2 3 --M 1:1000:6:log --mu 0.3 --inertia disk,hoop,1/3",
        "acceleration --m1 1 --m2 3 --M 0:50:6 --mu 0.15:0.3:4",
        "acceleration --m1 1 --m2 3 --M 0:50:6 --mu 0.3",
        "acceleration --m1 1 --m2 3 --M 1:1000:6:log --mu 0.1:0.34:6",
        "friction_force --m1 1 --m2 3 --M 0:50:6 --mu 0.3",
        "friction_force --m1 1 --m2 0.2:5:6 --M 5 --mu 0.1:0.3:3",
        "mu_verge --m1 1 --m2 3 --mu 0.3 --M 0:60:3",
        "rim_acceleration --m1 0.1:30:9 --m2 3 --M 50 --mu 0.05:0.3:6",
        "tension_2 --m1 1 --m2 3 --mu 0:0.5:9",
        "acceleration --m1 1 --m2 1.5 --M 1 --mu 0.1 --axle 0:5:6",
        "acceleration --m1 1 --m2 3 --M 20 --mu 0.3 --mu-k 0.2 --wrap 1rad:7rad:5",
        "torque --m1 1 --m2 3 --M 1e-20:2e-20:3 --R 1e-5",
        "tension_1 --m1 1 --m2 1 --g 1:25:3",
    ],
)
def test_no_words_of_a_figure_overlap_or_run_off(words: str) -> None:
    assert misplaced(drawn(f"sweep --csv --only {words}")) == []


def test_with_twelve_marks_a_legend_says_each() -> None:
    (axes,) = drawn("sweep --m1 0.1:30:9 --m2 3 --M 50 --mu 0.05:0.3:6 --csv").axes
    dots = [line.get_color() for line in axes.lines if line.get_marker() == "o"]
    curves = [line.get_color() for line in axes.get_legend().get_lines()]
    assert (len(dots), len({*dots}), len({*dots, *curves})) == (12, 1, 7)
    names = [text.get_text() for text in axes.get_legend().get_texts()]
    assert names[-1] == "μ = 0.3, holds from 1.02 kg, slips from 12.3 kg"
    assert [name.split(",")[0] for name in names] == [f"μ = {mu}" for mu in (0.05, 0.1, 0.15, 0.2, 0.25, 0.3)]


def test_a_scene_looks_the_same_in_all_panels() -> None:
    page = drawn("sweep --m1 1 --m2 3 --M 0:50:6 --mu 0.2,0.3 --only a,T1,T2 --csv")
    one, two = [
        [(line.get_color(), line.get_linestyle()) for line in axes.get_legend().get_lines()]
        for axes in page.axes
    ]
    assert (one, len({*two})) == (two[:2], 4)


def test_an_axis_starts_at_0_where_no_more_than_half_of_it_is_empty() -> None:
    for words, starts, ends in (
        ("--m1 1 --m2 3 --M 0:50:6", True, False),
        ("--m1 3 --m2 1 --M 0:50:6", False, True),
        ("--m1 1 --m2 3 --M 0:1:6", False, False),
    ):
        low, high = drawn(f"sweep {words}").axes[0].get_ylim()
        assert (low == 0, high == 0) == (starts, ends), words


def test_curves_turn_exactly_where_the_regime_changes() -> None:
    """Four curves parted at M = 0 and slipped at 10, 10, 20 and 50: they coincide until then."""
    shown = curves("acceleration", "0.15:0.3:4")
    slips = {"0.15": "5.17", "0.2": "9.32", "0.25": "17.8", "0.3": "43.3"}
    assert [curve.name for curve in shown] == [f"μ = {mu}, slips from {M} kg" for mu, M in slips.items()]
    for curve, mu in zip(shown, slips, strict=True):
        exact = solve(m1="1", m2="3", mu=mu)
        ((x, y),) = curve.marks
        assert x == pytest.approx(exact.critical_pulley_mass, rel=1e-6)
        assert y == pytest.approx(exact.acceleration, rel=1e-6)
        assert len(curve.xs) > 200
        for x, y in [*zip(curve.xs, curve.heights, strict=True)][::8]:
            assert y == pytest.approx(solve(m1=1, m2=3, M=x, mu=mu).acceleration, rel=1e-6)


def test_a_range_that_runs_down_is_drawn_as_one_that_runs_up() -> None:
    """Beside a string that slips from 43.3 kg on stood that it holds from there."""
    up, down = (curves("acceleration", "0.3", M) for M in ("0:50:6", "50:0:6"))
    assert up == down
    assert down[0].name == "slips from 43.3 kg"


def test_a_jump_is_drawn_as_one() -> None:
    (curve,) = curves("acceleration", "0.3", mu_k="0.2")
    steps = [(b - a, y2 - y1) for (a, y1), (b, y2) in pairwise(zip(curve.xs, curve.heights, strict=True))]
    width, height = max(steps, key=itemgetter(1))
    assert height > 1
    assert width < 1e-4


def test_a_figure_of_friction_has_a_band_where_it_is_not_one_number() -> None:
    (curve,) = curves("friction_force", "0.3")
    band, at_ten = [*zip(curve.least, curve.most, strict=True)], curve.xs.index(10.0)
    ys = curve.heights
    assert isnan(ys[at_ten])
    assert band[at_ten] == pytest.approx((5.405688718651033, 8.94931775365255))
    assert band[0] == (0, 0)
    assert band[-1] == (ys[-1], ys[-1])


def test_without_its_extra_it_names_the_pip_command(atwood: Atwood, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    for solves in ("sweep_figure.Answers", "sweep_page.solve_rows"):
        monkeypatch.delattr(f"atwood_cli.sweep.{solves}")  # it is told before anything is solved
    how = "install it with: pip install 'atwood-cli[figure]'"
    ran = atwood(*SWEEP, "--M", "1:2:3", "--figure", "x.svg")
    assert ran == (1, "", f"atwood: this needs matplotlib; {how}\n")


# Errors and streams


@pytest.mark.parametrize("count", ["1000000:log", "999998"])
def test_points_that_no_digits_tell_apart_are_refused_at_once(atwood: Atwood, count: str) -> None:
    start, stop = (f"1.{'3' * 993}{last}" for last in (1, 2))
    ran = atwood(*HELD, "--M", f"{start}:{stop}:{count}", "--csv")
    why = "has points closer together than 1000 digits can tell; take fewer points, or ends further apart"
    assert (ran.status, ran.out) == (2, "")
    assert ran.err.endswith(f" {why}\n")
    assert atwood(*HELD, "--M", f"{start}:{stop}:3:log", "--csv").status == 0


def test_rows_of_csv_are_written_as_they_come(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], atwood: Atwood
) -> None:
    """None is held: of a million rows there is one at a time."""
    words = [*SWEEP, "--M", "0:50:6", "--csv"]
    whole = atwood(*words)
    seen = []

    def watching(*given: Any) -> Iterator[Row]:
        for row in solve_rows(*given):
            seen.append(capsys.readouterr().out)
            yield row

    monkeypatch.setattr("atwood_cli.sweep.sweep_page.solve_rows", watching)
    rest = atwood(*words)
    assert [text.count("\n") for text in seen] == [0, 2, 1, 1, 1, 1]
    assert ("".join(seen) + rest.out, rest.err) == (whole.out, whole.err)
    assert whole.err == ""  # of the usual columns, nobody asked for one
