"""`atwood fit`: what runs require, against SciPy, against data made from the model, and as it is printed."""

import csv
import io
import json
import pydoc
import re
import subprocess
import sys
from fractions import Fraction
from math import inf, sqrt
from pathlib import Path
from random import Random
from time import process_time
from typing import Any

import numpy as np
import pytest
from scipy import optimize, stats

from atwood_cli import Fit, SceneError, solve
from atwood_cli import fit as laboratory_fit
from atwood_cli.laboratory.fitting import Data, as_data, estimate, expected, slopes
from atwood_cli.laboratory.judgement import Fitted, conditions_of, fitted
from atwood_cli.laboratory.published import published
from atwood_cli.laboratory.runs import Kind, Run, Runs
from atwood_cli.laboratory.statistics import Alike, sum_of_squares
from atwood_cli.model.scene import Input, read_input

from .conftest import many
from .coverage import BARS, DELAYED, DROP, NOTHING, C, Design, F, G, blunders_named, counts, drawn
from .running import Atwood, labels, on_terminal, pages_seen, plain, process

pytestmark = pytest.mark.filterwarnings("error")
TOP = Path(__file__).parent.parent
RIT = ["fit", str(TOP / "examples" / "rit.csv"), "--drop", "98cm", "--g", "9.804"]
SIMMONS = """m1,m2,a
0.055,0.060,0.380
0.060,0.065,0.354
0.065,0.070,0.323
0.070,0.075,0.310
0.075,0.080,0.303
0.080,0.085,0.279
0.065,0.075,0.649
0.080,0.095,0.780
"""
ODD = SIMMONS.replace("0.303", "0.103")
POLAND = "m1,m2,a\n0.06,0.066,0.3269176828\n0.06,0.07,0.5183372802\n0.06,0.076,0.8821971763\n"
APART = ((0.1, 0.01), (0.2, 0.012), (0.15, 0.03), (0.3, 0.02), (0.25, 0.04))
EQUAL = {"m1": [1, 2], "m2": [2, 3], "a": [1, 2]}


@pytest.fixture
def fit(atwood: Atwood, tmp_path: Path) -> Any:
    """Run the command on a table."""

    def call(table: str, *words: str, name: str = "runs.csv") -> Any:
        file = tmp_path / name
        file.write_text(table, encoding="utf-8")
        ran = atwood("fit", str(file), *words)
        return ran._replace(err=ran.err.replace(f"{file}", "RUNS"))

    return call


def found(ran: Any) -> Any:
    assert ran.status == 0, ran.err
    return json.loads(ran.out)


# Data made from the model


def made(kind: Kind, seed: int, repeats: int = 1, **more: Any) -> Runs:
    """Runs of a pulley and an axle that are known, with normal errors."""
    design = Design(8, repeats, 0.02 if kind == "time" else 0.005, "vary", kind, **more)
    return drawn(design, np.random.default_rng(seed)).runs()


@pytest.mark.parametrize("kind", ["a", "time"])
def test_what_made_exact_runs_is_found(kind: Kind) -> None:
    exact = drawn(Design(8, 1, 0.0, "vary", kind), np.random.default_rng(1)).runs()
    known = {"M": f"{1000 * C}g", "inertia": "1"}
    for find, given in ((["rim_mass", "axle"], {}), (["axle", "gravity"], known)):
        inputs = NOTHING | {x: read_input(x, word) for x, word in given.items()}
        results = fitted(exact, conditions_of(inputs), find).whole.results
        for name in find:
            truth = {"rim_mass": C, "axle": F, "gravity": G}[name]
            assert results[name].value == pytest.approx(truth, rel=1e-9)
            assert abs(results[name].value - truth) < 10 * results[name].uncertainty < 1e-7


def test_intervals_hold_the_truth_as_often_as_they_say() -> None:
    """A short `python -m tests.coverage`: each within 3 standard deviations of a binomial of its bar."""
    sets = max(20, many(40))
    for bar in BARS[::3]:
        one, least = counts(bar.design, sets), bar.within / 100
        assert min(one.within) / 100 > least - 3 * sqrt(least * (1 - least) / sets), bar.design
        assert not max(one.width) > 1.3 * bar.width, bar.design  # the median of few sets
        assert one.accused / 100 < 0.06 + 3 * sqrt(0.06 * 0.94 / sets), bar.design


def test_two_blunders_of_eight_do_not_hide_each_other() -> None:
    """At most an eighth of the degrees of freedom was open to be named: one of the two in 10 % of sets."""
    none, _, both = blunders_named(40)
    assert none <= 12 + 3 * 3
    assert both >= 10


def test_a_common_delay_is_said_by_its_size() -> None:
    """c was 87 g for 30 g, "significant", and nothing was said of it."""
    notes = laboratory_fit(columns_of(drawn(DELAYED, np.random.default_rng(5)).runs()), drop=DROP).notes
    assert any(
        re.fullmatch("A delay of 0.1 s in all times would change the pulley's inertia by about .* g.*", one)
        for one in notes
    )


def columns_of(runs: Runs) -> dict[str, list[object]]:
    """Runs as columns for Python."""
    table: dict[str, list[object]] = {
        name: [getattr(run, name).value for run in runs.runs] for name in ("m1", "m2")
    }
    times = range(len(runs.runs[0].measured))
    return table | {f"{runs.kind} {k}": [run.measured[k].value for run in runs.runs] for k in times}


def test_the_scatter_of_times_is_found_beside_uncertain_masses() -> None:
    """It was taken to be 0, and the same stopwatch had an uncertainty of 0.028 s and of 0.006 s."""
    runs = made("time", 4)
    runs = runs._replace(
        runs=[run._replace(m1=run.m1._replace(uncertainty=Fraction("1e-4"))) for run in runs.runs]
    )
    whole = fitted(runs, conditions_of(NOTHING), []).whole
    assert 0.01 < sqrt(whole.best.line.between) < 0.04
    assert (whole.chi2, whole.between_runs) == (None, None)


@pytest.mark.parametrize("repeats", [1, 3])
def test_both_terms_are_fitted_however_small(repeats: int) -> None:
    """A term that was left out as "not significant" falsified the other: its interval covered 48 to 67 %."""
    for seed in range(20):
        results = fitted(made("a", seed, repeats), conditions_of(NOTHING), []).whole.results
        assert list(results) in (["rim_mass", "axle"], [])


@pytest.mark.parametrize("kind", ["a", "time"])
def test_slopes_are_those_of_differences(kind: Kind) -> None:
    masses = np.array([0.2, 0.25]), np.array([0.207, 0.26])
    data = as_columns(kind, *masses, np.array([0.98, 0.5]), np.array([4.0, 2.0]))
    values: dict[str, Any] = {"rim_mass": C, "axle": F, "gravity": G}
    for i, (l, h) in enumerate(zip(*masses, strict=True)):
        acceleration = solve(m1=l, m2=h, M=C, inertia=1, axle=F, g=G).acceleration
        assert acceleration is not None
        fallen = sqrt(2 * [0.98, 0.5][i] / float(acceleration))
        assert expected(data, values)[i] == pytest.approx(acceleration if kind == "a" else fallen, rel=1e-13)
    for name in [*values, "l", "h", *["drop"] * (kind == "time")]:
        here: Any = values.get(name, getattr(data, name, None))
        ends = [expected(data, {**values, name: here * (1 + side * 1e-6)}) for side in (-1, 1)]
        assert slopes(data, values, [name])[:, 0] == pytest.approx(
            (ends[1] - ends[0]) / (2e-6 * here), rel=1e-5
        )


def as_columns(kind: Kind, l: Any, h: Any, drop: Any, measured: Any) -> Data:
    ones = np.ones(len(l))
    return Data(l, h, drop if kind == "time" else None, measured, ones, 0 * ones, inf, {})


# Against SciPy


def by_scipy(best: Fitted, sigma: Any) -> tuple[Any, Any]:
    data, gravity = best.whole.best.data, best.whole.best.values["gravity"]

    def ideal(_: Any, c: float, f: float) -> Any:
        a = (gravity * (data.h - data.l) - f) / (data.h + data.l + c)
        return a if data.drop is None else np.sqrt(2 * DROP / a)

    tight = dict.fromkeys(("xtol", "ftol", "gtol"), 1e-14)
    found = optimize.curve_fit(
        ideal, data.l, data.measured, [0.03, 0.01], sigma, False, maxfev=10_000, **tight
    )
    return found[0], found[1]


@pytest.mark.parametrize("kind", ["a", "time"])
@pytest.mark.parametrize(
    "more", [{}, {"stated": 1.0}, {"stated": 1.0, "masses": 2e-4}, {"masses": 2e-4, "repeats": 3}]
)
def test_values_and_uncertainties_are_those_of_scipy(kind: Kind, more: dict[str, Any]) -> None:
    """With the variances found, the covariance is SciPy's own: scaled by χ²/(n - p)."""
    for seed in range(5):
        best = fitted(made(kind, seed, **more), conditions_of(NOTHING), ["rim_mass", "axle"])
        values, covariance = by_scipy(best, np.sqrt(best.whole.best.line.variance))
        for i, (name, one) in enumerate(best.whole.results.items()):
            assert list(best.whole.best.names)[i] == name
            assert one.value == pytest.approx(values[i], rel=1e-6)
            assert one.uncertainty == pytest.approx(sqrt(covariance[i, i]), rel=1e-4)
        assert best.whole.correlation is not None
        both = sqrt(covariance[0, 0] * covariance[1, 1])
        assert best.whole.correlation[2] == pytest.approx(covariance[0, 1] / both, rel=1e-4)


@pytest.mark.parametrize("kind", ["a", "time"])
@pytest.mark.parametrize("find", [["rim_mass"], ["rim_mass", "axle"], ["rim_mass", "axle", "gravity"]])
def test_contradictory_runs_are_fitted_as_well_as_by_scipy(kind: Kind, find: list[str]) -> None:
    """Tables of chance: 24 of 194 were more than 10 % above the best, some beyond m1 + m2 + c = 0."""
    fitted_tables = 0
    for seed in range(25):
        random = Random(seed)
        rows = [(random.randint(1, 6), random.randint(1, 6), random.randint(1, 9)) for _ in range(6)]
        inputs = [[Input(Fraction(x), Fraction(0), None) for x in row] for row in rows if row[0] != row[1]]
        drop = Input(Fraction(1), Fraction(0), None)
        used = [Run((i,), m1, m2, drop, (one,)) for i, (m1, m2, one) in enumerate(inputs)]
        data = as_data(Runs(kind, used, False, []), used)
        given = {x: value for x, value in (("rim_mass", 0.0), ("axle", 0.0), ("gravity", G)) if x not in find}
        try:
            best = estimate(data, given, find)
        except Alike:  # an inertia without bounds
            continue
        least = float((data.l + data.h).min())
        assert best.values["rim_mass"] > -least
        rest = sum_of_squares(data.measured - expected(data, best.values))
        assert rest < 1.01 * by_scipy_from_many(data, given, find)
        fitted_tables += 1
    assert fitted_tables > 2


def by_scipy_from_many(data: Data, given: dict[str, float], find: list[str]) -> float:
    """The least sum of squares that SciPy finds from eight starts."""
    least, random, best = float((data.l + data.h).min()), Random(1), inf

    def rest(values: Any) -> Any:
        by = given | dict(zip(find, values, strict=True))
        a = (by["gravity"] * (data.h - data.l) - by["axle"]) / (data.l + data.h + by["rim_mass"])
        ideal = a if data.drop is None else np.sqrt(2 / np.maximum(a, 1e-12))
        return data.measured - ideal

    for _ in range(8):
        starts = {
            "rim_mass": -least + 10 ** random.uniform(-2, 2),
            "axle": random.uniform(-20, 20),
            "gravity": random.uniform(0, 30),
        }
        low = [-least + 1e-9 if x == "rim_mass" else -inf for x in find]
        found = optimize.least_squares(rest, [starts[x] for x in find], bounds=(low, inf))
        best = min(best, 2 * found.cost)
    return best


def test_what_no_pulley_has_is_no_result(fit: Any) -> None:
    """It printed rim_mass = -4.13 ± 0.57 kg as needed, beyond the pole, and a traceback with --figure."""
    for table, reason in ((LIGHT, "in row "), (NEGATIVE, "the runs would need a pulley of -")):
        result = found(fit(table, "--json"))
        assert (result["rim_mass"], result["axle"], without_nulls(result["uncertainty"])) == (None, None, {})
        assert f"No result: {reason}" in result["notes"][0]


def test_a_height_in_another_unit_is_named(atwood: Atwood) -> None:
    """`--drop 98` for 98 cm asked for a pulley of -0.4 kg."""
    out = " ".join(atwood(*RIT[:2], "--drop", "98").out.split())
    assert (
        "5 runs, 15 times. No result: in row 1 the acceleration is 12.3 m/s², and with neither pulley nor friction"
        " it is 0.169 m/s²: check the height of fall, the masses and their units."
    ) in out


# Published runs


def test_times_of_rit(atwood: Atwood) -> None:
    """By SciPy, with the variance between runs at which χ² is n - p = 3 (Paule and Mandel)."""
    result = found(atwood(*RIT, "--json"))
    assert list(result) == [
        *(
            "version",
            "rim_mass",
            "axle",
            "gravity",
            "pulley_mass",
            "moment_of_inertia",
            "uncertainty",
            "interval",
        ),
        *("correlation", "chi2", "dof", "between_runs", "runs", "notes"),
    ]
    l, h = np.array([200, 200.5, 201, 201.5, 202]) / 1000, np.array([207, 206.5, 206, 205.5, 205]) / 1000
    times = np.array(
        [[4.06, 4.03, 3.88], [4.53, 4.59, 4.62], [5.00, 5.00, 5.06], [6.13, 6.16, 6.19], [8.00, 7.75, 7.87]]
    )
    repeats = times.var(1, ddof=1).mean() / 3

    def ideal(i: Any, c: float, f: float) -> Any:
        i = i.astype(int)
        return np.sqrt(2 * 0.98 * (l[i] + h[i] + c) / (9.804 * (h[i] - l[i]) - f))

    def fitted_with(between: float) -> tuple[Any, Any, float]:
        values, i = np.array([0.04, 0.015]), np.arange(5)
        for _ in range(20):  # the weights follow the values
            slope = ideal(i, *values) / (2 * (9.804 * (h - l) - values[1]))
            sigma = np.sqrt(repeats + between * slope**2)
            values, covariance = optimize.curve_fit(ideal, i, times.mean(1), values, sigma, True, xtol=1e-14)
        return values, covariance, float((((times.mean(1) - ideal(i, *values)) / sigma) ** 2).sum())

    between = optimize.brentq(lambda x: fitted_with(x)[2] - 3, 1e-9, 1e-3, xtol=1e-16)
    values, covariance, _ = fitted_with(between)
    for i, name in enumerate(("rim_mass", "axle")):
        u = sqrt(covariance[i, i])
        assert result[name] == pytest.approx(values[i], rel=1e-5)
        assert result["uncertainty"][name] == pytest.approx(u, rel=1e-5)
        half = stats.t.ppf(0.975, 3) * u
        assert result["interval"][name] == pytest.approx([values[i] - half, values[i] + half], rel=1e-4)
    assert result["between_runs"] == pytest.approx(sqrt(between) / 9.804, rel=1e-5)
    assert result["chi2"] == pytest.approx(fitted_with(0)[2], rel=0.02)  # there with other weights
    assert (result["gravity"], result["dof"]) == (None, 3)
    assert [run["rows"] for run in result["runs"]] == ["1", "2", "3", "4", "5"]
    assert result["runs"][0]["time"] == 3.99


def test_accelerations_of_simmons(fit: Any) -> None:
    """What is not significant is reported with its interval, not left out and not cut at 0."""
    result = found(fit(SIMMONS, "--g", "9.81", "--json", "--R", "25mm", "--inertia", "disk"))
    m1, m2, a = np.array([line.split(",") for line in SIMMONS.split()[1:]], dtype=float).T

    def ideal(_: Any, c: float, f: float) -> Any:
        return (9.81 * (m2 - m1) - f) / (m1 + m2 + c)

    values, covariance = optimize.curve_fit(ideal, m1, a, [0.01, 0.001], xtol=1e-14, ftol=1e-14)
    for i, name in enumerate(("rim_mass", "axle")):
        u = sqrt(covariance[i, i])
        assert result[name] == pytest.approx(values[i], abs=1e-3 * u)
        assert result["uncertainty"][name] == pytest.approx(u, rel=1e-4)
        half = stats.t.ppf(0.975, 6) * u
        assert result["interval"][name] == pytest.approx([values[i] - half, values[i] + half], abs=1e-3 * u)
    assert (result["chi2"], result["between_runs"], result["dof"]) == (None, None, 6)
    assert result["moment_of_inertia"] == pytest.approx(result["rim_mass"] * 0.025**2)
    assert result["pulley_mass"] == pytest.approx(2 * result["rim_mass"])
    assert result["uncertainty"]["pulley_mass"] == pytest.approx(2 * result["uncertainty"]["rim_mass"])


def test_three_runs_of_poland_tell_little(fit: Any) -> None:
    result = found(fit(POLAND, "--g", "9.812", "--json"))
    assert result["dof"] == 1
    for name in ("rim_mass", "axle"):
        low, high = result["interval"][name]
        assert low < 0 < high
        assert high - low == pytest.approx(2 * 12.706 * result["uncertainty"][name], rel=1e-4)


def test_a_free_axle_carries_what_is_said(fit: Any) -> None:
    result = found(fit(SIMMONS, "--g", "9.81", "--find", "rim_mass", "--json"))
    assert (result["axle"], result["dof"]) == (None, 7)
    more = found(fit(SIMMONS, "--g", "9.81", "--axle", "1mN", "--find", "rim_mass", "--json"))
    assert result["rim_mass"] - more["rim_mass"] == pytest.approx(0.0021, rel=0.05)


# How runs are written


def test_repeats_are_columns_or_rows(fit: Any) -> None:
    columns = "rig,m1,m2,time1,time 2,time_3\nA,.2,.207,4.06,4.03,3.88\nB,.201,.206,5,,5.06\nC,.202,.205,8,7.75,7.87\n"
    rows = (
        "rig,m1,m2,time\nA,.2,.207,4.06\nA,.2,.207,4.03\nB,.201,.206,5\nC,.202,.205,8\nA,.2,.207,3.88\n"
        "B,.201,.206,5.06\nC,.202,.205,7.75\nC,.202,.205,7.87\n"
    )
    one, other = (found(fit(table, "--drop", "0.98", "--json")) for table in (columns, rows))
    assert [run.pop("rows") for run in other["runs"]] == ["1 2 5", "3 6", "4 7 8"]
    assert [run.pop("rows") for run in one["runs"]] == ["1", "2", "3"]
    assert one["runs"] == other["runs"]
    assert one["uncertainty"] == other["uncertainty"]


def test_either_side_may_be_the_heavier(fit: Any) -> None:
    swapped = SIMMONS.replace("0.070,0.075,0.310", "0.075,0.070,0.310")
    signed = SIMMONS.replace("0.070,0.075,0.310", "0.075,0.070,-0.310")
    want = found(fit(SIMMONS, "--json"))
    for table in (swapped, signed):
        got = found(fit(table, "--json"))
        assert got["rim_mass"] == pytest.approx(want["rim_mass"], rel=1e-12)
        assert not any("swap the sides" in note for note in got["notes"])
    line = found(fit(signed, "--json"))["runs"][3]
    assert (line["a"], line["expected"] < 0) == (-0.31, True)


def test_stdin() -> None:
    command = "printf 'm1,m2,a\\n1,2,1\\n1,3,2\\n2,3,1\\n' | atwood fit - --only dof"
    ran = process("fit", "-", "--only", "dof", shell=command)
    assert (ran.status, ran.out) == (0, "1\n")


def test_scipy_alone_is_needed() -> None:
    run = "from atwood_cli.cli import run; status = run(['fit', *sys.argv[1:]]);"
    code = f"import sys; {run} sys.exit(status or 10 * bool({{'polars', 'matplotlib'}} & set(sys.modules)))"
    assert (
        subprocess.run(
            [sys.executable, "-W", "error", "-c", code, *RIT[1:]], capture_output=True, check=False
        ).returncode
        == 0
    )
    code = f"import sys; sys.modules['scipy'] = None; {run} sys.exit(status)"
    done = subprocess.run([sys.executable, "-c", code, *RIT[1:]], capture_output=True, check=False, text=True)
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr == "atwood: this needs scipy; install it with: pip install 'atwood-cli[fit]'\n"


# What is given, and what is fitted


def test_what_is_given_is_not_fitted(fit: Any) -> None:
    result = found(fit(SIMMONS, "--M", "26g", "--g", "9.81", "--json"))
    assert (result["rim_mass"], list(without_nulls(result["uncertainty"]))) == (None, ["axle"])
    assert found(fit(SIMMONS, "--M", "26g", "--axle", "1mN", "--json"))["dof"] == 8
    by_moment = found(fit(SIMMONS, "--I", "0.013 kg m2", "--R", "1m", "--g", "9.81", "--json"))
    assert by_moment["dof"] == result["dof"]
    free = found(fit(SIMMONS, "--axle", "0", "--g", "9.81", "--json"))
    assert free["rim_mass"] == pytest.approx(0.0128, abs=1e-4)


def test_gravity_is_fitted_if_asked_for(fit: Any) -> None:
    result = found(fit(SIMMONS, "--find", "g", "--M", "26g", "--axle", "0", "--json"))
    assert result["gravity"] == pytest.approx(9.81, abs=0.1)
    assert (result["rim_mass"], result["axle"]) == (None, None)
    assert fit(SIMMONS, "--find", "gravity").out.startswith("8 runs")  # not with g = 9.80665


@pytest.mark.parametrize("find", ["gravity,rim_mass", "c,f,g"])
def test_what_slopes_do_not_determine_is_refused(fit: Any, find: str) -> None:
    """m1 + m2 that vary by 1 % gave g = 3.0 ± 2.4, whose interval held the truth in 37 to 80 %."""
    random, table = Random(3), "m1,m2,a\n"
    for i in range(8):
        total, difference = 0.4 * (1 + random.uniform(-0.01, 0.01)), 0.01 + 0.004 * i
        a = 9.81 * difference / (total + 0.04) + random.gauss(0, 0.01)
        table += f"{(total - difference) / 2:.6f},{(total + difference) / 2:.6f},{a:.4f}\n"
    result = found(fit(table, "--find", find, "--json"))
    assert result["gravity"] is None
    assert re.search(
        "No result: the runs do not separate .*: vary m2 - m1 more, and m1 \\+ m2[.]", result["notes"][0]
    )


EXACT = [
    ("m1,m2,a\n1,3,3.268883333333333\n1,4,4.20285\n1,5,4.903325\n", ""),
    ("m1,m2,a\n1,2,2\n2,1,-2\n", "--find rim_mass"),
    ("m1,m2,a\n1,3,1\n1,2,2\n1,4,9\n1,5,5\n", "--find axle,gravity"),
    ("m1,m2,t\n1,3,1\n1,2,2\n1,4,9\n1,5,5\n", "--find axle,gravity --drop 1"),
    ("m1,m2,t1,t2\n1,3,1,1\n1,2,2,2\n1,4,.9,.9\n1,5,.5,.5\n", "--drop 1"),
    ("m1,m2,a,±\n1,3,3.268883333333333,1\n1,4,4.20285,1\n1,5,4.903325,1\n", ""),
    ("m1,m2,a\n1e-9,3e-9,4.9\n1e-9,4e-9,5.8\n1e9,5e9,6.5\n", ""),
]


@pytest.mark.parametrize(("table", "more"), EXACT)
def test_rounding_is_no_physics(fit: Any, table: str, more: str) -> None:
    """A simulator's data were "significant (more than any number of standard uncertainties from 0)"; 1.6e31 u."""
    ran = fit(table, *more.split())
    assert ran.status == 0, ran.err
    assert not re.search(r"\d{17}|0{20}|inf|nan|any number", ran.out)
    result = found(fit(table, *more.split(), "--json"))
    assert all(line["residual"] is None or abs(line["residual"]) < 10 for line in result["runs"])
    assert all(u > 0 for u in without_nulls(result["uncertainty"]).values())
    if not more:
        assert (
            result["interval"]["axle"] is None
            or result["interval"]["axle"][0] < 0 < result["interval"]["axle"][1]
        )


def test_what_is_given_and_uncertain_counts_for_all_runs_together(fit: Any) -> None:
    """g is off in all runs alike: c by (S + c)/g times as much, for runs without other errors."""
    masses = ((1.0, 1.25), (1.05, 1.2), (1.0, 1.25), (1.1, 1.15))
    a = [9.81 * (h - l) / (h + l + 0.02) for l, h in masses]
    table = "m1,m2,a\n" + "".join(f"{l},{h},{x}\n" for (l, h), x in zip(masses, a, strict=True))
    result = found(fit(table, "--g", "9.81(2)", "--find", "c", "--json"))
    assert result["uncertainty"]["rim_mass"] == pytest.approx(
        0.02 / 9.81 * 2.27, rel=1e-6
    )  # a step is exact in g
    timed = "m1,m2,time\n" + "".join(f"{l},{h},{sqrt(2 / x)}\n" for (l, h), x in zip(masses, a, strict=True))
    result = found(fit(timed, "--g", "9.81", "--drop", "1.00(1)", "--find", "c", "--json"))
    assert result["uncertainty"]["rim_mass"] == pytest.approx(
        2.27 * (1 / 0.99 - 1 / 1.01) / 2, rel=1e-6
    )  # as a goes with the height
    radius = found(fit(SIMMONS, "--R", "25(1)mm", "--json"))
    share = radius["uncertainty"]["moment_of_inertia"] / radius["moment_of_inertia"]
    c_share = radius["uncertainty"]["rim_mass"] / radius["rim_mass"]
    assert share == pytest.approx(sqrt(c_share**2 + 0.08**2))
    free, axle = (
        found(fit(SIMMONS, "--R", "25(1)mm", "--axle", f"0.05{u}mNm", "--json")) for u in ("", "(1)")
    )
    assert axle["uncertainty"]["rim_mass"] > 1.2 * free["uncertainty"]["rim_mass"]
    assert axle["axle"] is None


# What is said of runs

STRAY = "m1,m2,time 1,time 2,time 3,time 4,time 5\n" + "".join(
    f"{l},{h}," + ",".join(f"{2.15 * k + d:.2f}" for d in (0, 0.01, -0.02, 0.02, -0.01)) + "\n"
    for l, h, k in ((0.2, 0.222, 0.966), (0.21, 0.23, 1.046), (0.22, 0.235, 1.262), (0.15, 0.162, 1.196),
                    (0.25, 0.28, 0.932), (0.3, 0.325, 1.116))
)  # fmt: skip
STRAYING = STRAY.replace("2.69", "3.79")
PAIRS = "m1,m2,time 1,time 2\n" + "".join(
    f"{l},{h},{t:.2f},{t + d:.2f}\n"
    for l, h, t, d in ((0.2, 0.222, 2.08, 0.01), (0.21, 0.23, 2.25, -0.02), (0.22, 0.235, 2.71, 1.02),
                       (0.15, 0.162, 2.57, -0.01), (0.25, 0.28, 2.0, 0.01), (0.3, 0.325, 2.4, 0.02))
)  # fmt: skip
FAST = SIMMONS.replace("0.780", "2.1")
DRIVEN = SIMMONS.replace("0.0", "1.0").replace("0.65,", "1.65,")
UNEVEN = "m1,m2,a\n1.00(1),2.00(1),2.50(1)\n1.00(1),3.00(1),4.10(1)\n1.50(1),2.00(1),0.70(1)\n2.0(1),3.0(1),1.7(1)\n"
UNCERTAIN = "m1,m2,time\n1.00(1),2.00(1),1.0\n1.00(1),3.00(1),.8\n1.50(1),2.00(1),1.7\n2.0(1),3.0(1),1.21\n"
NEGATIVE = "m1,m2,a\n" + "".join(
    f"{m},{m + d:.3f},{(9.80665 * d - 0.01) / (2 * m + d - 0.02):.4f}\n" for m, d in APART
)
"""Runs that would need a pulley of -20 g, and that an axle holds back."""
FREE = "m1,m2,a\n" + "".join(f"0,{m},{9.80665 * m / (m + 0.5)}\n" for m in (0.05, 0.1, 0.2)) + "0,0,0\n"
STATED = SIMMONS.replace("\n", "+/-0.2\n").replace("a+/-0.2", "a")
RESTING = SIMMONS + 8 * "0.1,0.1,0\n" + "".join(f"0.1,0.10{i},0\n" for i in range(1, 9))

# fmt: off
SENTENCES = [
    (FAST, "", "Row 8 is faster than with neither pulley nor friction: 48 standard uncertainties from what the others say."),
    (FAST, "", "8 runs, 8 accelerations."),  # and nothing is called significant that includes it
    (FAST, "--R 25mm", "Without row 8: rim_mass = 0.0107 ± 0.0035 kg, axle = 0.0007 ± 0.0014 N,"
        " moment_of_inertia = (6.7 ± 2.2)e-6 kg m². The fit includes it."),
    (ODD, "", "standard uncertainties from what the others say."),
    (STRAYING, "--drop 98cm", "In row 3, 3.79 s is far from its siblings: "),
    (STRAYING, "--drop 98cm", "Without row 3: rim_mass = "),
    (STRAYING, "--drop 98cm", "The fit includes it."),
    (SIMMONS + "0.1,0.1,0\n", "", "Row 9 could not be used: its masses are equal, and rest."),
    (SIMMONS + "0.1,0.2,0\n", "", "Row 9 could not be used: nothing moved."),
    (SIMMONS + "0.1,0.2,-1\n", "", "Row 9 could not be used: the lighter side falls."),
    (SIMMONS + "0.1,0.2,\n", "", "Row 9 has no a: it is no run."),
    (RESTING, "", "4 more could not be used."),
    (FREE, "--find c", "Row 4 could not be used: its masses are equal, and rest."),
    (SIMMONS.replace("0.303", "0.503"), "--without 5", "Row 5 was left out, as asked."),
    (SIMMONS.replace("0.070,0.075,0.310", "0.075,0.070,0.310"), "", "Accelerations have no sign here"),
    (SIMMONS, "--g 9.81", "8 runs, 8 accelerations. The pulley's inertia is significant. Axle friction agrees with 0."),
    (SIMMONS, "", "Nothing but the runs themselves shows the scatter of a single acceleration."),
    (SIMMONS, "--M 26g --axle 1mN", "Nothing is left to fit: the pulley and its axle are given."),
    (SIMMONS, "--find gravity", "The pulley's inertia is taken to be 0, as it was not to be found."),
    (SIMMONS, "--g 9.81", "1 g more on the side of m2 would change axle friction by about 9.8 mN."),
    (NEGATIVE, "", "kg at its rim, and there is none: masses, heights or gravity are not what they are said to be"),
    (DRIVEN, "", "and with neither pulley nor friction it is 0.0676 m/s²: check the masses and their units."),
    ("m1,m2,a\n1,1.5,1.98\n1,2,3.29\n1,3,4.93\n1.1,2.2,3.29\n", "--find f",
        "N, and there is none: there is more mass on the heavier side than the table says"),
    (UNEVEN, "", "χ² = 9.92 by the uncertainties stated, 2 degrees of freedom: chance exceeds it in 0.7 % of sets;"
        " the runs differ by 35 g of mass beyond that."),
    (STATED, "", "χ² = 0.00708 by the uncertainties stated, 6 degrees of freedom: far too small to be"
        " chance (less than 0.1 % of sets): the uncertainties stated are probably too large."),
    ("m1,m2,a\n1,2,2.31(1)\n1,5,5.45(1)\n", "--find c,f",
        "As many runs as results: nothing shows whether the runs differ more than by the uncertainties stated."),
]
# fmt: on


@pytest.mark.parametrize(("table", "more", "words"), SENTENCES)
def test_what_is_said(fit: Any, table: str, more: str, words: str) -> None:
    notes = found(fit(table, *more.split(), "--json"))["notes"]
    assert any(words in note for note in notes), notes
    assert not any(" --" in note for note in notes)  # the same notes are in Python's result


def test_a_pair_that_disagrees_is_named(fit: Any) -> None:
    notes = " ".join(found(fit(PAIRS, "--drop", "98cm", "--json"))["notes"])
    assert re.search("In row 3, (2.71|3.73) s is far from its siblings: .* Without row 3: rim_mass = ", notes)


def test_what_is_odd_is_said_above_the_tables_and_marked(fit: Any) -> None:
    out = fit(STRAYING, "--drop", "98cm").out
    assert out.index("is far from its siblings") < out.index("Quantity") < out.index("│ 3 ! │")
    assert "The fit includes it.\n--without 5 leaves it out.\n" in fit(ODD).out


def test_rows_are_left_out(fit: Any) -> None:
    left = found(fit(ODD, "--without", "5", "--json"))
    assert left["runs"][4]["expected"] is None
    want = found(fit("\n".join(line for line in SIMMONS.split("\n") if "0.303" not in line), "--json"))
    assert left["interval"] == want["interval"]
    assert found(fit(SIMMONS, "--without", "5,7", "--without", "1", "--json"))["dof"] == 3


def test_a_free_end_is_a_run_too(fit: Any) -> None:
    """A cart on a table: c is its mass and the pulley's."""
    result = found(fit(FREE, "--find", "c", "--json"))
    assert result["rim_mass"] == pytest.approx(0.5, rel=1e-6)


def test_good_runs_are_not_called_odd(fit: Any) -> None:
    for ran in (fit(SIMMONS, "--g", "9.81", "--json"), fit(POLAND, "--json")):
        assert not any("Row" in note for note in found(ran)["notes"])


def test_two_runs_with_uncertainties_are_enough(fit: Any) -> None:
    result = found(fit("m1,m2,a\n1,2,2.31(1)\n1,5,5.45(1)\n", "--find", "c,f", "--json"))
    assert (result["dof"], result["chi2"]) == (0, pytest.approx(0, abs=1e-12))
    assert result["between_runs"] is None
    assert result["uncertainty"]["rim_mass"] > 0


NO_VALUE = "gravity: has no value: it is given, was not to be fitted, or the runs do not determine it."


@pytest.mark.parametrize(
    ("form", "out"), [("--json", '{\n  "gravity": null\n}\n'), ("--csv", 'gravity\n""\n')]
)
def test_a_result_that_is_not_there_is_a_status_in_every_form(fit: Any, form: str, out: str) -> None:
    ran = fit(SIMMONS, "--only", "gravity", form)
    assert (ran.status, ran.out, ran.err) == (1, out, f"atwood: {NO_VALUE}\n")


# How it is printed


def test_the_page_has_the_digits_and_the_width_asked_for(atwood: Atwood) -> None:
    with_all = plain(on_terminal(*RIT, "--R", "25mm", "--inertia", "disk", columns=80)).splitlines()
    assert sum("moment_of_inertia" in line for line in with_all) == 1  # one table
    narrow = plain(on_terminal(*RIT, columns=60)).splitlines()
    assert max(len(line) for line in narrow if not re.match("[│╭├╰]", line)) <= 60
    with_radius = atwood(*RIT, "--R", "25mm").out.splitlines()
    cells = [cell.strip() for cell in with_radius[7].split("│")[1:-1]]
    assert cells == ["moment_of_inertia", "(2.0 ± 1.3)e-5", "kg m²", "I", "(-2.2 to 6.2)e-5"]


@pytest.mark.parametrize(
    ("value", "u", "both", "ends"),
    [
        (7.9652e-6, 2.3e-6, "(8.0 ± 2.3)e-6", "(3.4 to 12.6)e-6"),  # was (0.34 to 1.26)e-5
        (1.49e-5, 9e-7, "(1.490 ± 0.090)e-5", "(1.310 to 1.670)e-5"),
        (-3e-7, 2e-5, "(0.0 ± 2.0)e-5", "(-4.0 to 4.0)e-5"),
        (0.764, 0.012, "0.764 ± 0.012", "0.740 to 0.788"),
        (12345.678, 1200, "12300 ± 1200", "9900 to 14700"),
        (9.80665, 1.2e-10, "9.8066500000 ± 0.0000000001", "9.8066499998 to 9.8066500002"),
        (9.80665, 1e-14, "9.8066500000", ""),
        (0.25, 0.0, "0.250000", ""),
    ],
)
def test_a_row_is_published_by_one_rule(value: float, u: float, both: str, ends: str) -> None:
    assert published(value, u, (value - 2 * u, value + 2 * u)) == (both, ends)


def without_nulls(value: Any) -> Any:
    if isinstance(value, list):
        return [*map(without_nulls, value)]
    if not isinstance(value, dict):
        return value
    return {key: without_nulls(one) for key, one in value.items() if one is not None}


def test_in_python_it_is_what_json_has(atwood: Atwood) -> None:
    rit = Path(RIT[1])
    want = found(atwood(*RIT, "--R", "25mm", "--without", "5", "--json"))
    result: Fit = laboratory_fit(rit, drop="98cm", g="9.804", R="25mm", without=[5])
    printed = {key: one for key, one in want.items() if key != "version"}
    assert without_nulls(json.loads(json.dumps(result._asdict()))) == without_nulls(printed)
    with rit.open() as file:
        header, *rows = csv.reader(file)
    texts: dict[str, list[str]] = dict(zip(header, map(list, zip(*rows, strict=True)), strict=True))
    inertia: float | None = laboratory_fit(texts, drop=0.98, g="9.804", R="25mm", without=(5,)).rim_mass
    assert inertia == pytest.approx(want["rim_mass"])
    frame = pytest.importorskip("polars").read_csv(rit)
    assert laboratory_fit(frame, drop="98cm", g="9.804", find="axle").interval.keys() == {"axle"}
    numbers = {name: [float(cell) for cell in cells] for name, cells in texts.items()}
    assert laboratory_fit(numbers, drop="98cm", find=["f"]).rim_mass is None
    lines = str(result).splitlines()
    assert [line.split()[0] for line in lines[:3]] == ["rim_mass", "axle", "moment_of_inertia"]
    assert lines[2] == "moment_of_inertia = (1.3 ± 2.1)e-5 kg m², 95 %: (-7.9 to 10.5)e-5"
    assert lines[3:] == list(result.notes)


@pytest.mark.parametrize(
    ("table", "more", "kind", "words"),
    [
        ({"m1": [1]}, {}, ValueError, "cannot read the runs: no column m2; name it, as --column m2='Masse 2 (g)'"),
        (Path("none.csv"), {}, OSError, "cannot read none.csv: No such file or directory"),
        (TOP / "LICENSE", {}, OSError, f"cannot read {TOP / 'LICENSE'}: "),
        (EQUAL, {"find": "mass"}, SceneError, "find 'mass' is no quantity to fit; did you mean rim_mass?"),
        (EQUAL, {"find": ["g"], "g": 9.8}, SceneError, "find 'gravity' is known by g; leave one of them out"),
        (EQUAL, {"find": "c", "I": 1}, SceneError, "find 'rim_mass' is known by I; leave one of them out"),
        (EQUAL, {"without": [9]}, SceneError, "without '9' is no row; there are 1 to 2"),
        (EQUAL, {}, ArithmeticError, "2 runs are too few for what is to be fitted and its scatter: "),
    ],
)  # fmt: skip
def test_in_python_errors_say_what_is_wrong(
    table: Any, more: dict[str, Any], kind: type[Exception], words: str
) -> None:
    with pytest.raises(kind) as raised:
        laboratory_fit(table, **more)
    assert str(raised.value).startswith(words)
    with pytest.raises(ValueError, match="it is of type int; give a path, a mapping or a data frame"):
        laboratory_fit(3)  # type: ignore[arg-type]
    shown = pydoc.plain(pydoc.render_doc(laboratory_fit))
    assert all(part in shown for part in ("A row a run", "kg, m/s² and s", kind.__name__))


def test_csv_has_a_row_a_run(atwood: Atwood, fit: Any) -> None:
    ran = atwood(*RIT, "--csv")
    rows = list(csv.DictReader(io.StringIO(ran.out)))
    assert list(rows[0]) == ["rows", "m1", "m2", "drop", "time", "u", "expected", "residual"]
    assert len(rows) == 5
    assert "atwood: rim_mass = 0.032 ± 0.021 kg" in ran.err.splitlines()
    assert (
        fit("Team,m1,m2,a\nA,1,2,2.4\nA,1,3,3.9\nB,1,1,0\n", "--csv", "--find", "c").out.splitlines()[-1]
        == "3,1,1,0,,,"
    )


def test_bare_values(atwood: Atwood) -> None:
    ran = atwood(*RIT, "--only", "c,axle")
    assert [f"{float(word):.3g}" for word in ran.out.split()] == ["0.0323", "0.0159"]
    assert ran.err == "atwood: rim_mass = 0.032 ± 0.021 kg\natwood: axle = 0.0159 ± 0.0016 N\n"
    assert json.loads(atwood(*RIT, "--only", "dof", "--json").out) == {"dof": 3}
    assert atwood(*RIT, "--only", "dof", "--csv").out == "dof\n3\n"


@pytest.mark.parametrize("form", ["", "--json", "--csv", "--only rim_mass,axle,chi2"])
def test_no_result_has_more_digits_than_a_double(atwood: Atwood, form: str) -> None:
    numbers = re.findall(r"\d+\.\d+", atwood(*RIT, "--R", "25mm", *form.split()).out)
    assert max(len(number.replace(".", "").lstrip("0")) for number in numbers) <= 17


LIGHT = "m1,m2,a\n" + "".join(f"{m},{m + d:.3f},{9.80665 * d / (2 * m + d - 0.08):.5f}\n" for m, d in APART)
"""Runs that would need a pulley of -80 g."""


def test_what_is_no_result_is_not_drawn_as_one(fit: Any, tmp_path: Path) -> None:
    """The picture had a slope ± its uncertainty of a pulley that there is none of."""
    pytest.importorskip("matplotlib")
    file = tmp_path / "line.svg"
    assert "No result" in fit(LIGHT, "--figure", str(file)).out
    assert "slope" not in " ".join(labels(file.read_text(encoding="utf-8")))


MANY = "m1,m2,a\n" + "".join(f"1,{1.1 + i / 40},{0.45 + i / 90}\n" for i in range(20))


@pytest.mark.parametrize(
    ("table", "more"),
    [(ODD, ()), (ODD, ("--bare",)), (ODD, ("--without", "5", "--bare")), (SIMMONS, ()), (MANY, ())],
)
def test_nothing_is_cut_from_the_picture(
    fit: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, table: str, more: tuple[str, ...]
) -> None:
    """A bar of an outlier ran off; a run that is left out was not there; --bare has no sentences."""
    with pages_seen() as pages:
        assert fit(table, *more, "--figure", str(tmp_path / "line.png")).status == 0
    (page,) = pages
    line = page.axes[0]
    (left, right), (low, high) = line.get_xlim(), line.get_ylim()
    for bars in line.collections:
        for (x, y), (to_x, to_y) in bars.get_segments():
            assert left <= x <= to_x <= right
            assert low <= y <= to_y <= high
    hollow = [one for one in line.lines if one.get_markerfacecolor() == "none" and one.get_markersize() < 9]
    assert [len(one.get_xdata()) for one in hollow] == [1] * ("--without" in more)
    assert (page.get_suptitle() == "") == bool(more)
    assert "$T_h - T_l$" in line.get_ylabel()


def test_the_line_is_drawn(atwood: Atwood, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    file = tmp_path / "line.svg"
    assert atwood(*RIT, "--figure", str(file), "--only", "dof").status == 0
    svg = file.read_text(encoding="utf-8")
    texts = " ".join(labels(svg))
    assert all(
        words in texts for words in ("slope", "= 0.032 ± 0.021 kg", "= 0.0159 ± 0.0016 N", "residual (N)")
    )
    again = tmp_path / "again.svg"
    atwood(*RIT, "--figure", str(again), "--only", "dof")
    assert again.read_text(encoding="utf-8") == svg
    assert atwood(*RIT, "--figure", str(file)).status == 1


@pytest.mark.parametrize(("rows", "repeats"), [(1500, 1), (10, 400)])
def test_time_grows_as_the_rows_do(rows: int, repeats: int, tmp_path: Path, atwood: Atwood) -> None:
    """20,000 rows took 41 s, as the square of their number; a large part were said to be odd."""
    random, seconds = Random(20_000), []
    for size in (1, 2):
        lines = ["m1,m2," + ",".join(f"time {k}" for k in range(repeats))]
        for _ in range(size * rows):
            m1 = round(random.uniform(0.15, 0.3), 5)
            m2 = round(m1 + random.uniform(0.004, 0.03), 5)
            t = sqrt(2 * 0.98 * (m1 + m2 + C) / (G * (m2 - m1) - F))
            wrong = random.choice([0] * 9 + [1])
            lines.append(
                f"{m1},{m2}," + ",".join(f"{t + wrong + random.gauss(0, 0.02):.3f}" for _ in range(repeats))
            )
        path = tmp_path / f"{size}.csv"
        path.write_text("\n".join(lines) + "\n")
        start = process_time()
        assert atwood("fit", str(path), "--drop", "98cm").status == 0
        seconds.append(process_time() - start)
    assert seconds[1] < 3 * seconds[0] + 0.2


def test_a_label_may_look_like_an_input(fit: Any) -> None:
    table = "m1,m2,a,M\n1,2,2.4,heavy\n1,3,3.9,light\n1,4,4.8,light\n"
    assert found(fit(table, "--label", "M", "--json"))["dof"] == 1


def test_runs_without_any_scatter_require_what_they_show(fit: Any) -> None:
    rows = [
        (m1, m2, solve(m1=m1, m2=m2, M="0", g="10").acceleration)
        for m1, m2 in (("1", "3"), ("2", "3"), ("1", "4"))
    ]
    table = "m1,m2,a\n" + "".join(f"{m1},{m2},{a}\n" for m1, m2, a in rows)
    result = found(fit(table, "--g", "10", "--json"))
    assert max(abs(result[name] or 0) for name in ("rim_mass", "axle")) < 1e-12
    exact = "m1,m2,a\n1,2,2.5\n2,3,1.666666666666666666666666666667\n"  # 10 (2 - 1)/(1 + 2 + 1)
    result = found(fit(exact, "--g", "10", "--axle", "0", "--json"))
    assert result["rim_mass"] == pytest.approx(1, rel=1e-14)
    page = fit(exact, "--g", "10", "--axle", "0").out
    assert "│ rim_mass │ 1.0000000000" in page  # eleven digits, and no uncertainty of rounding


def test_repeats_of_either_sign_are_averaged_with_their_signs(fit: Any) -> None:
    result = found(fit("m1,m2,a 1,a 2\n1,1.01,0.1,-0.02\n1,2,3,3.1\n1,3,4.7,4.8\n", "--find", "c", "--json"))
    assert [run["a"] for run in result["runs"]] == [0.04, 3.05, 4.75]
    assert result["chi2"] is not None
