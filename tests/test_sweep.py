"""`atwood sweep`: ranges, rows that `solve` repeats, output, files, curves."""

import csv
import re
import sys
from collections.abc import Iterator
from decimal import Decimal
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from typing import Any

import mpmath
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from atwood_cli import solve
from atwood_cli.numbers.digits import SHOWN_DIGITS
from atwood_cli.solver.quantities import STANDARD
from atwood_cli.sweep.ranges import Row, read_range, read_sweep, solve_rows
from atwood_cli.sweep.sweep_figure import Curve, panels_of

from .tools.running import FROM, TOP, Atwood, called, plain

SWEEP = ["sweep", "--m1", "1", "--m2", "3", "--mu", "0.3"]
HELD = ["sweep", "--m1", "1", "--m2", "3"]


# Ranges


decimals = st.decimals(min_value=0, max_value=10**6, allow_nan=False, places=6)


@given(decimals, decimals.filter(bool), st.integers(2, 40), st.booleans())
def test_decimal_steps_are_exact(start: Decimal, step: Decimal, count: int, down: bool) -> None:
    expected = [Fraction(start) + i * Fraction(step) for i in range(count)][:: -1 if down else 1]
    ends = (str(Decimal(q.numerator) / Decimal(q.denominator)).lower() for q in (expected[0], expected[-1]))
    along = read_range("M", f"{':'.join(ends)}:{count}")
    texts = [*map(along.cell, along.points)]
    assert list(map(Fraction, texts)) == expected
    assert max(map(len, texts)) < 20


@given(
    st.integers(1, 10**6), st.integers(1, 10**6), st.integers(3, 2000),
    st.sampled_from([None, 1, 3, 9, 17, 60]), st.booleans(),
)  # fmt: skip
def test_points_a_person_can_read_lie_where_they_should(
    start: int, stop: int, count: int, digits: int | None, log: bool
) -> None:
    """Ends are hit; others are rounded to the digits shown, or as many more as leave them within 1/200 of a step."""
    assume(start != stop)
    along = read_range("M", f"{start}:{stop}:{count}{':log' * log}", digits)
    texts = [*map(along.cell, along.points)]
    values = [*map(Fraction, texts)]
    assert (values[0], values[-1], len(values)) == (Fraction(start), Fraction(stop), count)
    assert all(a != b and (a < b) == (start < stop) for a, b in pairwise(values))
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
    longest = max(len(point.strip("0.").replace(".", "")) for point in texts[1:-1])
    assert longest <= max(13, digits or 0) or not (digits or log)


# Rows


GRIDS = """
--m1 1 --m2 3 --M 0:100:7 --mu 0.3
--m1 0.5:4:8 --m2 2 --M 5 --mu 0.1:0.4:4
--m1 100g:300g:3 --m2 200g --M 1:1000:5:log --R 5cm
--m1 1 --m2 3 --M 50 --mu 0.3 --mu-k 0:0.3:4 --wrap 1rad:7rad:4
--m1 1 --m2 3 --mu 0.1:0.35:6
--m1 1e-400:3e-400:3 --m2 2 --g 1:25:4
--m1 1 --m2 3 --M inf,20,0.1 --mu 0.3 --inertia disk,2/7
--m1 1 --m2 3 --M 1,50 --mu 0.3 --I 1 --R 1
--m1 1 --m2 3 --M 50 --mu 0.3 --g 1:25:3 --axle 2
"""


@pytest.mark.parametrize("more", ["", " --digits 30"])
@pytest.mark.parametrize("grid", GRIDS.strip().splitlines())
def test_every_row_is_what_solve_prints_for_its_values(atwood: Atwood, grid: str, more: str) -> None:
    words = f"{grid}{more} --csv".split()
    swept = {i: words[i - 1][2:].replace("-", "_") for i, word in enumerate(words) if re.search("[:,]", word)}
    rows = [*csv.DictReader(atwood("sweep", *words).out.splitlines())]
    assert list(rows[0]) == [*swept.values(), *STANDARD]
    for row in rows:
        values = {i: row.pop(name) for i, name in swept.items()}
        here = [values.get(i, word) for i, word in enumerate(words)]
        solved = atwood("solve", *here, "--only", ",".join(STANDARD)).out
        assert [*csv.DictReader(solved.splitlines())] == [row]


# Files

RIT = TOP / "examples" / "rit.csv"
FORMS = {
    "": ["a.txt", "a"],
    "--csv": ["a.CSV", "a.csv --csv"],
    "--json": ["a.json", "a --json"],
    "--explain --markdown": ["a.md --explain --markdown"],
}


@pytest.mark.parametrize(
    "typed",
    [
        "contact --m1 1 --m2 3",
        "fit RIT --drop 98cm",
        "quantities",
        "sweep --m1 1 --m2 3 --M 0:100:101 --only tension_1,torque",  # there is no torque
        "solve --m1 1 --m2 3 --M 1",
        "solve --m1 1 --m2 3 --M 1 --only tension_1,torque",
    ],
)
def test_a_file_gets_what_a_pipe_would(tmp_path: Path, typed: str) -> None:
    """Whole and without colours, whatever the terminal is."""
    words = typed.replace("RIT", str(RIT)).split()
    poor: Any = {"COLUMNS": "40", "LINES": "5", "FORCE_COLOR": "1", "TERM": "xterm-256color"}
    for form in FORMS if typed == "solve --m1 1 --m2 3 --M 1" else ("", "--csv", "--json"):
        printed = called([*words, *form.split()])
        assert printed.status == ("torque" in typed)
        assert called([*words, *form.split(), "-o", "-"]) == printed
        for way in FORMS[form]:
            name, *more = way.split()
            ran = called([*words, "-o", f"{tmp_path}/{name}", *more], on_terminal=True, **poor)
            said = f"atwood: wrote {tmp_path}/{name} {printed.err}".split()
            assert (ran.status, plain(ran.out).split()) == (printed.status, said)
            (file,) = tmp_path.iterdir()
            assert (file.name, file.read_bytes().decode()) == (name, printed.out)
            file.unlink()


@pytest.mark.parametrize(
    "typed",
    [
        "sweep --m1 1 --m2 3 --M 1:2:3 --output FILE.csv",
        "solve --m1 1 --m2 3 --mu 0.3 --only M* --csv --output FILE.csv",
        "sweep --m1 1 --m2 3 --M 1:2:3 --figure FILE.svg",
        "contact --m1 1 --m2 3 --M 1 --figure FILE.svg",
        "batch RIT --output FILE.csv",
    ],
)
def test_a_file_is_replaced_only_by_force(atwood: Atwood, tmp_path: Path, typed: str) -> None:
    words = typed.replace("FILE", f"{tmp_path}/a").replace("RIT", str(RIT)).split()
    file = Path(words[-1])
    file.write_text("kept")
    why = f"cannot write {file}: it exists already; --force replaces it"
    assert atwood(*words) == (1, "", f"atwood: {why}\n")
    assert file.read_text() == "kept"
    assert atwood(*words, "--force").status == 0
    assert file.read_text(encoding="utf-8").startswith(("<?xml", "M,", "critical", "m1 (g),"))
    assert list(tmp_path.iterdir()) == [file]


# Curves


def curves(name: str, mu: str, M: str = "0:50:6", **more: str) -> list[Curve]:
    """Those of a quantity, in the one panel that it has."""
    (found,) = panels_of(read_sweep({"m1": "1", "m2": "3", "M": M, "mu": mu, **more}), [name]).values()
    return found


def test_curves_turn_exactly_where_the_regime_changes() -> None:
    """Four curves parted at M = 0 and slipped at 10, 10, 20 and 50: they coincide until then."""
    for curve, mu in zip(curves("acceleration", "0.15:0.3:4"), ("0.15", "0.2", "0.25", "0.3"), strict=True):
        exact = solve(m1="1", m2="3", mu=mu)
        ((*place, words),) = curve.marks
        assert place == pytest.approx([exact.critical_pulley_mass, exact.acceleration], rel=1e-6)
        assert (
            f"no-slip up to M = {words.removeprefix('slips beyond ')}"
            in called([*SWEEP[:-1], mu, "--M", "0:50:6"]).out
        )
        assert len(curve.xs) >= 200
        for x, y in [*zip(curve.xs, curve.ys, strict=True)][::8]:
            assert y == pytest.approx(solve(m1=1, m2=3, M=x, mu=mu).acceleration, rel=1e-6)


def test_a_range_that_runs_down_is_drawn_as_one_that_runs_up() -> None:
    """Beside a string that slips from 43.3 kg on stood that it holds from there."""
    assert curves("acceleration", "0.3") == curves("acceleration", "0.3", M="50:0:6")


def test_a_jump_is_drawn_as_one() -> None:
    (curve,) = curves("acceleration", "0.3", mu_k="0.2")
    steps = [(y2 - y1, b - a) for (a, y1), (b, y2) in pairwise(zip(curve.xs, curve.ys, strict=True))]
    height, width = max(steps)
    assert height > 1 > 1e4 * width


def test_without_its_extra_it_names_the_pip_command(atwood: Atwood, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    for solves in ("sweep_figure.Answers", "sweep_page.solve_rows"):
        monkeypatch.delattr(f"atwood_cli.sweep.{solves}")  # it is told before anything is solved
    why = f"this needs matplotlib; install it with: pip install '{FROM}[figure]'"
    assert atwood(*SWEEP, "--M", "1:2:3", "--figure", "x.svg") == (1, "", f"atwood: {why}\n")


# Errors and streams


@pytest.mark.parametrize("count", ["1000000:log", "999998"])
def test_points_that_no_digits_tell_apart_are_refused_at_once(atwood: Atwood, count: str) -> None:
    start, stop = (f"1.{'3' * 993}{last}" for last in (1, 2))
    ran = atwood(*HELD, "--M", f"{start}:{stop}:{count}", "--csv")
    why = "has points closer together than 1000 digits can tell; take fewer points, or ends further apart"
    assert (ran.status, ran.out, ran.err.endswith(f" {why}\n")) == (2, "", True)
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
