"""`atwood fit`: what runs require, against SciPy, against data made from the model, and as it is printed."""

import csv
import io
import json
import pydoc
import re
import subprocess
import sys
import warnings
from fractions import Fraction
from math import inf, sqrt
from pathlib import Path
from random import Random
from time import process_time
from typing import Any

import numpy as np
import pytest
from scipy import optimize, stats

from atwood_cli import SceneError, solve
from atwood_cli import fit as laboratory_fit
from atwood_cli.laboratory.fitting import Fitted, as_data, conditions_of, fitted
from atwood_cli.laboratory.headings import Kind
from atwood_cli.laboratory.least_squares import Data, estimate, expected
from atwood_cli.laboratory.numbers import published
from atwood_cli.laboratory.probability import (
    beta_share,
    chi2_beyond,
    fisher_beyond,
    student_beyond,
    student_within,
)
from atwood_cli.laboratory.results import Fit, points
from atwood_cli.laboratory.runs import Run, Runs
from atwood_cli.laboratory.statistics import Alike, sum_of_squares
from atwood_cli.model.scene import Input, read_input

from .conftest import many
from .coverage import DESIGNS, DROP, NOTHING, C, Design, G, counts, drawn, fit_of
from .running import Atwood, labels, misplaced, on_terminal, pages_seen, plain, process
from .test_explain import check_markdown

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


# Shares of probability


def test_shares_are_those_of_scipy() -> None:
    random = Random(16)
    for _ in range(300):
        dof, size = random.choice([1, 2, 3, 5, 13, 40, 300]), 10 ** random.uniform(-3, 2)
        a, b, x = 10 ** random.uniform(-1, 2), 10 ** random.uniform(-1, 2), random.random()
        for mine, theirs in (
            (student_beyond(size, dof), 2 * stats.t.sf(size, dof)),
            (student_beyond(-size, inf), 2 * stats.norm.sf(size)),
            (chi2_beyond(size, dof), stats.chi2.sf(size, dof)),
            (fisher_beyond(size, dof, 7), stats.f.sf(size, dof, 7)),
            (beta_share(a, b, x), stats.beta.cdf(x, a, b)),
        ):
            assert mine == pytest.approx(theirs, rel=1e-9, abs=1e-13)
    for dof in (1, 2, 13, 1000):
        # SciPy's own inverse was off by 2e-11 for long.
        assert 2 * stats.t.sf(student_within(0.95, dof), dof) == pytest.approx(0.05, rel=1e-11)
    assert student_within(0.95, inf) == pytest.approx(1.959963984540054)
    assert (beta_share(2, 3, 0), beta_share(2, 3, 1)) == (0, 1)
    assert chi2_beyond(1500, 1500) == pytest.approx(stats.chi2.sf(1500, 1500), rel=1e-9)  # was 0
    assert chi2_beyond(21000, 20000) == pytest.approx(stats.chi2.sf(21000, 20000), rel=1e-8)
    assert chi2_beyond(0, 3) == 1
    assert fisher_beyond(2, 4, inf) == pytest.approx(stats.chi2.sf(8, 4))


# Data made from the model

F = 0.01


def made(kind: Kind, seed: int, repeats: int = 1, **more: Any) -> Runs:
    """Runs of a pulley and an axle that are known, with normal errors."""
    return drawn(Design(8, repeats, F, kind=kind, **more), np.random.default_rng(seed)).runs()


@pytest.mark.parametrize("kind", ["a", "time"])
def test_what_made_exact_runs_is_found(kind: Kind) -> None:
    sound = drawn(Design(8, 1, F, kind=kind), np.random.default_rng(1))
    runs = sound._replace(values=sound.ideal[:, None]).runs()
    for find, known in ((["rim_mass", "axle"], {}), (["axle", "gravity"], {"M": "40g", "inertia": "1"})):
        inputs = NOTHING | {x: read_input(x, word) for x, word in known.items()}
        best = fitted(runs, conditions_of(inputs, runs), find)
        for name in find:
            assert best.values[name] == pytest.approx(
                {"rim_mass": C, "axle": F, "gravity": G}[name], rel=1e-9
            )
        assert points(best).residual == pytest.approx(0, abs=1e-12)


def test_intervals_hold_the_truth_as_often_as_they_say() -> None:
    """A short `python -m tests.coverage`: each within 3 standard deviations of a binomial of its bar."""
    sets, designs = max(20, many(40)), [design for design in DESIGNS[1::4] if design.seen]
    of = [counts(design, sets) for design in designs]
    shares = np.array([one.within_95 for one in of])
    assert shares.min() > 0.90 - 3 * sqrt(0.90 * 0.10 / sets)
    assert 0.93 < shares.mean() < 0.99
    assert np.mean([one.accused for one in of]) < 0.05
    for one, design in zip(of, designs, strict=True):
        if design.runs > 4:
            assert max(one.width) < 1.8


def test_the_scatter_of_times_is_found_beside_uncertain_masses() -> None:
    """It was taken to be 0, and the same stopwatch had an uncertainty of 0.028 s and of 0.006 s."""
    runs = made("time", 4, given_mass=1e-4)
    best = fitted(runs, conditions_of(NOTHING, runs), [])
    scatter = best.estimate.linear.variance - best.estimate.known
    assert scatter == pytest.approx(scatter[0])
    assert 0.01 < sqrt(scatter[0]) < 0.04
    assert (best.chi2, best.between_runs) == (None, None)


def test_a_massless_pulley_is_not_accused() -> None:
    """Half of its runs are a little faster than one without friction allows."""
    design = Design(8, 1, 0.0, c=0.0, kind="a")
    random = np.random.default_rng(30)
    fits = [fit_of(drawn(design, random)) for _ in range(100)]
    assert sum(bool(fit.odd.runs) for fit in fits) <= 5 + 3 * sqrt(5)
    assert sum("rim_mass" in fit.impossible for fit in fits) <= 2.5 + 3 * sqrt(2.5)


def test_what_strays_is_named() -> None:
    design = Design(20, 5)
    one = counts(design, 60)
    assert min(one.repeat_named, one.row_named) > 0.95 - 3 * sqrt(0.95 * 0.05 / 60)


@pytest.mark.parametrize("repeats", [1, 3])
def test_both_terms_are_fitted_however_small(repeats: int) -> None:
    """A term that was left out as "not significant" falsified the other: its interval covered 48 to 67 %."""
    for seed in range(20):
        runs = made("a", seed, repeats)
        best = fitted(runs, conditions_of(NOTHING, runs), [])
        assert list(best.values) == ["rim_mass", "axle"]


@pytest.mark.parametrize("kind", ["a", "time"])
def test_slopes_are_those_of_differences(kind: Kind) -> None:
    given: dict[str, Any] = {
        "l": np.array([0.2, 0.25]),
        "h": np.array([0.207, 0.26]),
        "drop": np.array([0.98, 0.5]),
        **{"rim_mass": C, "axle": F, "gravity": G},
    }
    names = [name for name in given if kind == "time" or name != "drop"]
    value, slopes = expected(kind, given, names)
    for i in range(2):
        scene = solve(m1=given["l"][i], m2=given["h"][i], M=C, inertia=1, axle=F, g=G)
        assert scene.acceleration is not None
        wanted = scene.acceleration if kind == "a" else sqrt(2 * given["drop"][i] / scene.acceleration)
        assert value[i] == pytest.approx(wanted, rel=1e-13)
    for name in names:
        step = 1e-6 * given[name]
        ends = [expected(kind, given | {name: given[name] + side * step}, [])[0] for side in (-1, 1)]
        assert slopes[name] == pytest.approx((ends[1] - ends[0]) / (2 * step), rel=1e-5)
    nowhere, _ = expected("time", given | {"axle": 1.0}, [])
    assert np.isnan(nowhere).all()


# Against SciPy


def by_scipy(best: Fitted, sigma: Any, absolute: bool) -> tuple[Any, Any]:
    data = best.data

    def ideal(_: Any, c: float, f: float) -> Any:
        a = (best.estimate.values["gravity"] * (data.h - data.l) - f) / (data.h + data.l + c)
        return a if data.kind == "a" else np.sqrt(2 * DROP / a)

    tight = dict.fromkeys(("xtol", "ftol", "gtol"), 1e-14)
    fitted = optimize.curve_fit(
        ideal, data.l, data.measured, [0.03, 0.01], sigma, absolute, maxfev=10_000, **tight
    )
    return fitted[0], fitted[1]


@pytest.mark.parametrize("kind", ["a", "time"])
@pytest.mark.parametrize(("given", "u_mass"), [(False, 0.0), (True, 0.0), (True, 1e-4)])
def test_values_and_uncertainties_are_those_of_scipy(kind: Kind, given: bool, u_mass: float) -> None:
    runs = made(kind, 7, given=given, given_mass=u_mass)
    best = fitted(runs, conditions_of(NOTHING, runs), ["rim_mass", "axle"])
    values, covariance = by_scipy(best, np.sqrt(best.estimate.linear.variance), absolute=given)
    for i, name in enumerate(best.estimate.names):
        assert best.values[name] == pytest.approx(values[i], rel=1e-6)
        assert best.uncertainty(name) == pytest.approx(sqrt(covariance[i, i]), rel=1e-4)
    assert best.correlation is not None
    assert best.correlation[2] == pytest.approx(
        covariance[0, 1] / sqrt(covariance[0, 0] * covariance[1, 1]), rel=1e-4
    )


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
        used = [Run((i,), {}, m1, m2, drop, (one,)) for i, (m1, m2, one) in enumerate(inputs)]
        data = as_data(Runs(kind, used, True, False, [], []), used)
        given = {x: value for x, value in (("rim_mass", 0.0), ("axle", 0.0), ("gravity", G)) if x not in find}
        try:
            best = estimate(data, given, find)
        except Alike:  # an inertia without bounds
            continue
        least = float((data.l + data.h).min())
        assert best.values["rim_mass"] > -least
        assert sum_of_squares(data.measured - best.expected) < 1.01 * by_scipy_from_many(data, given, find)
        fitted_tables += 1
    assert fitted_tables > 2


def by_scipy_from_many(data: Data, given: dict[str, float], find: list[str]) -> float:
    """The least sum of squares that SciPy finds from eight starts."""
    least, random, best = float((data.l + data.h).min()), Random(1), inf

    def rest(values: Any) -> Any:
        by = given | dict(zip(find, values, strict=True))
        a = (by["gravity"] * (data.h - data.l) - by["axle"]) / (data.l + data.h + by["rim_mass"])
        ideal = a if data.kind == "a" else np.sqrt(2 / np.maximum(a, 1e-12))
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
    ran = fit("m1,m2,a\n1,3,3\n1,2,2\n1,4,9\n1,5,5\n", "--json")
    assert found(ran)["uncertainty"]["rim_mass"] is None
    result = found(fit(DRIVEN, "--json"))
    assert (result["rim_mass"], result["axle"], without_nulls(result["uncertainty"])) == (None, None, {})
    driven = "m1,m2,a\n" + "".join(
        f"{m},{m + d},{(9.80665 * d + 0.05) / (2 * m + d + 0.04):.5f}\n" for m, d in APART
    )
    result = found(fit(driven, "--json"))
    assert result["rim_mass"] == pytest.approx(0.04, abs=1e-3)
    assert (result["axle"], list(without_nulls(result["uncertainty"]))) == (None, ["rim_mass"])


# Published runs


def test_times_of_rit(atwood: Atwood) -> None:
    """By SciPy, with the variance between runs at which χ² is its median, about 3 (1 - 2/27)³."""
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

    between = optimize.brentq(lambda x: fitted_with(x)[2] - 3 * (25 / 27) ** 3, 1e-9, 1e-3, xtol=1e-16)
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
    assert result["rim_mass"] == pytest.approx(0.0128, abs=2e-4)
    assert result["uncertainty"]["rim_mass"] == pytest.approx(0.0024, rel=0.05)
    assert (result["chi2"], result["between_runs"], result["dof"]) == (None, None, 6)
    assert result["interval"]["axle"][0] < 0 < result["interval"]["axle"][1]
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


def test_runs_too_few_for_both_say_what_is_assumed(fit: Any) -> None:
    result = found(fit("m1,m2,a\n1,2,2.4\n1,3,3.9\n", "--json"))
    assert (result["axle"], result["dof"]) == (None, 1)
    assert result["rim_mass"] is not None
    alike = found(fit("m1,m2,a\n" + "1,2,2.4\n1,2,2.41\n1,2,2.39\n", "--json"))
    assert alike["axle"] is None


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
    assert one["runs"][0]["rig"] == "A"
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


def test_no_extra_package_is_needed_for_csv() -> None:
    code = (
        "import sys; from atwood_cli.cli import run; status = run(['fit', *sys.argv[1:]]);"
        "sys.exit(status or bool({'polars', 'scipy', 'matplotlib', 'plotille'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code, *RIT[1:], "--json"], capture_output=True, check=False)
    assert done.returncode == 0


# What is given, and what is fitted


def test_what_is_given_is_not_fitted(fit: Any) -> None:
    result = found(fit(SIMMONS, "--M", "26g", "--g", "9.81", "--json"))
    assert (result["rim_mass"], list(without_nulls(result["uncertainty"]))) == (None, ["axle"])
    assert found(fit(SIMMONS, "--M", "26g", "--axle", "1mN", "--json"))["dof"] == 8
    by_moment = found(fit(SIMMONS, "--I", "13 g m2", "--R", "1m", "--g", "9.81", "--json"))
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
    ran = fit(table, "--find", find)
    assert (ran.status, ran.out) == (1, "")
    assert re.fullmatch("atwood: the runs do not separate .*: vary m2 - m1 more, and m1 \\+ m2\n", ran.err)


def test_no_page_warns_of_numpy(fit: Any) -> None:
    """An axle and a gravity of a few runs ended in a RuntimeWarning, and gravity of -0.39."""
    why = "the runs do not separate axle friction from gravity: vary m2 - m1 more, and m1 + m2"
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for drop, name in (((), "a"), (("--drop", "1"), "time")):
            ran = fit(f"m1,m2,{name}\n1,3,1\n1,2,2\n1,4,9\n1,5,5\n", "--find", "axle,gravity", *drop)
            assert ran.err == f"atwood: {why}\n"


def test_what_is_given_and_uncertain_counts_for_all_runs_together(fit: Any) -> None:
    """g is off in all runs alike: c by (S + c)/g times as much, for runs without other errors."""
    masses = ((1.0, 1.25), (1.05, 1.2), (1.0, 1.25), (1.1, 1.15))
    a = [9.81 * (h - l) / (h + l + 0.02) for l, h in masses]
    table = "m1,m2,a\n" + "".join(f"{l},{h},{x}\n" for (l, h), x in zip(masses, a, strict=True))
    result = found(fit(table, "--g", "9.81(2)", "--find", "c", "--json"))
    assert result["uncertainty"]["rim_mass"] == pytest.approx(0.02 / 9.81 * 2.27, rel=1e-6)
    timed = "m1,m2,time\n" + "".join(f"{l},{h},{sqrt(2 / x)}\n" for (l, h), x in zip(masses, a, strict=True))
    result = found(fit(timed, "--g", "9.81", "--drop", "1.00(1)", "--find", "c", "--json"))
    assert result["uncertainty"]["rim_mass"] == pytest.approx(0.01 * 2.27, rel=1e-6)  # a goes with the height
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
TIMED = "m1,m2,time\n0.2,0.207,3.99\n0.2005,0.2065,4.58\n0.201,0.206,5.02\n0.2015,0.2055,6.16\n0.202,0.205,7.873\n"
UNEVEN = "m1,m2,a\n1.00(1),2.00(1),2.50(1)\n1.00(1),3.00(1),4.10(1)\n1.50(1),2.00(1),0.70(1)\n2.0(1),3.0(1),1.7(1)\n"
UNCERTAIN = "m1,m2,time\n1.00(1),2.00(1),1.0\n1.00(1),3.00(1),.8\n1.50(1),2.00(1),1.7\n2.0(1),3.0(1),1.21\n"
FREE = "m1,m2,a\n" + "".join(f"0,{m},{9.80665 * m / (m + 0.5)}\n" for m in (0.05, 0.1, 0.2)) + "0,0,0\n"
RESTING = SIMMONS + 8 * "0.1,0.1,0\n" + "".join(f"0.1,0.10{i},0\n" for i in range(1, 9))

# fmt: off
SENTENCES = [
    (FAST, "", "Row 8 stands out: 48 standard uncertainties from what the others say, and faster than a massless"
        " pulley without friction allows."),
    (FAST, "--R 25mm", "Without row 8: moment of inertia = (6.7 ± 2.2)e-6 kg m², rim mass = 0.0107 ± 0.0035 kg,"
        " axle = 0.0007 ± 0.0014 N. The fit includes it."),
    (TIMED.replace("6.16", "2.1"), "--drop 98cm", "Row 4 stands out: 34 standard uncertainties from what the others say,"
        " and faster than a massless pulley without friction allows."),
    (ODD, "", "standard uncertainties from what the others say."),
    (SIMMONS + "Mean,,\n", "", "Left out below the runs, as it has no numbers: 'Mean'."),
    (STRAYING, "--drop 98cm", "Row 3, time 3 (3.79 s) is far from its siblings: "),
    (STRAYING, "--drop 98cm", "Without row 3, time 3: rim mass = "),
    (STRAYING, "--drop 98cm", "The fit includes it; to leave a measurement out, empty its cell."),
    (SIMMONS + "0.1,0.1,0\n", "", "Row 9 could not be used: its masses are equal, and rest."),
    (SIMMONS + "0.1,0.2,0\n", "", "Row 9 could not be used: nothing moved."),
    (SIMMONS + "0.1,0.2,-1\n", "", "Row 9 could not be used: the lighter side falls."),
    (SIMMONS + "0.1,0.2,\n", "", "Row 9 has no a: it is no run."),
    (RESTING, "", "4 more could not be used."),
    (FREE, "--find c", "Row 4 could not be used: its masses are equal, and rest."),
    (SIMMONS.replace("0.303", "0.503"), "--without 5", "Row 5 was left out, as asked."),
    (SIMMONS, "--mu 0.001", "Row 1 cannot be: the string would slip, as its mu = 0.001 is too small for these masses."),
    (SIMMONS.replace("0.070,0.075,0.310", "0.075,0.070,0.310"), "", "Accelerations have no sign here"),
    (SIMMONS, "--g 9.81", "Axle friction agrees with 0: at most 0.0026 N (95 %)."),
    (SIMMONS, "", "Without repeats nothing separates the scatter of the accelerations from"),
    (SIMMONS, "--M 26g --g 9.81", "8 runs, 8 accelerations. Axle friction agrees with 0: at most 0.00074 N (95 %)."),
    (SIMMONS, "--M 26g --axle 1mN", "Nothing is left to fit: the pulley and its axle are given."),
    (SIMMONS, "--find gravity", "The pulley's inertia is neither fitted nor given, and so taken to be 0: 1 g would add"
        " 61 mm/s² to gravity."),
    (SIMMONS, "--g 9.81 --find rim_mass", "Axle friction is neither fitted nor given, and so taken to be 0: 10 mN would"
        " take 21 g off the pulley's inertia."),
    ("m1,m2,a\n1,2,2.4\n1,3,3.9\n", "", "Axle friction is assumed to be 0: 2 runs are too few"),
    (DRIVEN, "--find c", "kg at its rim, and there is none: masses, heights or gravity are not what they are said to be"),
    ("m1,m2,a\n1,1.5,2.5\n1,2,3.7\n1,3,5.2\n1.1,2.2,3.7\n", "--find f",
        "N, and there is none: there is more mass on the heavier side than the table says"),
    (UNEVEN, "", "of mass more than their uncertainties say, as masses may; chance alone does as much in "),
    (UNCERTAIN, "--drop 1",
        "The uncertainty of a single time is neither given nor shown by repeats: u is the scatter that"),
    ("m1,m2,a\n1,2,2.31(1)\n1,5,5.45(1)\n", "--find c,f",
        "As many runs as results: nothing shows whether the runs differ more than their uncertainties say."),
]
# fmt: on


@pytest.mark.parametrize(("table", "more", "words"), SENTENCES)
def test_what_is_said(fit: Any, table: str, more: str, words: str) -> None:
    notes = found(fit(table, *more.split(), "--json"))["notes"]
    assert any(words in note for note in notes), notes
    assert not any(" --" in note for note in notes)  # the same notes are in Python's result


def test_of_a_pair_that_disagrees_both_are_named(fit: Any) -> None:
    notes = " ".join(found(fit(PAIRS, "--drop", "98cm", "--json"))["notes"])
    for cell in ("Row 3, time 1 (2.71 s)", "Row 3, time 2 (3.73 s)"):
        assert f"{cell} is far from its siblings: " in notes
    assert re.search("Without row 3, time [12] and row 3, time [12]: rim mass = ", notes)


def test_what_is_odd_is_said_above_the_tables_and_marked(fit: Any) -> None:
    out = fit(STRAYING, "--drop", "98cm").out
    assert out.index("is far from its siblings") < out.index("Quantity") < out.index("│ 3 ! │")
    assert "--without" not in out
    assert "The fit includes it.\n--without 5 leaves it out.\n" in fit(ODD).out


def test_rows_are_left_out(fit: Any) -> None:
    left = found(fit(ODD, "--without", "5", "--json"))
    assert left["runs"][4]["expected"] is None
    want = found(fit("\n".join(line for line in SIMMONS.split("\n") if "0.303" not in line), "--json"))
    assert left["interval"] == want["interval"]
    assert found(fit(SIMMONS, "--without", "5,7", "--without", "1", "--json"))["dof"] == 3


def test_a_free_end_is_a_run_too(fit: Any) -> None:
    """A cart on a table: c is its mass and the pulley's."""
    result = found(fit(FREE, "--mu", "0.3", "--find", "c", "--json"))
    assert result["rim_mass"] == pytest.approx(0.5, rel=1e-6)


def test_good_runs_are_not_called_odd(fit: Any) -> None:
    for ran in (fit(SIMMONS, "--g", "9.81", "--mu", "0.3", "--json"), fit(POLAND, "--json")):
        assert not any("Row" in note for note in found(ran)["notes"])


def test_two_runs_with_uncertainties_are_enough(fit: Any) -> None:
    result = found(fit("m1,m2,a\n1,2,2.31(1)\n1,5,5.45(1)\n", "--find", "c,f", "--json"))
    assert (result["dof"], result["chi2"]) == (0, pytest.approx(0, abs=1e-12))
    assert result["between_runs"] is None
    assert result["uncertainty"]["rim_mass"] > 0


TOO_FEW = (
    "1 run is too few for what is to be fitted and its scatter: give more runs, or repeats, or uncertainties"
    " (as 2.05+/-0.02), or what is known (M, axle), or fit one quantity alone (find)"
)
ALL = "rim_mass, axle, gravity, pulley_mass, moment_of_inertia, correlation, chi2, dof, between_runs"
NO_VALUE = "gravity: has no value: it is given, was not to be fitted, or the runs do not determine it."
ONE = "m1,m2,a\n1,2,1\n"
# fmt: off
ERRORS = [
    (ONE, "", 1, TOO_FEW),
    ("m1,m2,a\n" + 3 * "1,2,1(1)\n", "--find c,f", 1, TOO_FEW),
    ("m1,m2,a\n1,3,1\n1.5,2.5,.5\n1.9,2.1,.1\n", "--find c,g", 1,
        "the runs do not separate the pulley's inertia from gravity: vary m1 + m2 as well"),
    # Runs that no pulley explains: the inertia grew until nothing depended on it, which LAPACK did not take.
    ("m1,m2,a\n1.490259450+/-0.01,1.6235554121+/-0.01,0.30892147212+/-0.01\n1.29484570+/-0.01,1.84716075+/-0.01,"
        "1.53359393256+/-0.01\n1.2484303713+/-0.01,1.4557443422+/-0.01,0.60180931160+/-0.01\n", "--R 0.3 --g 0.5", 1,
        "the runs do not determine the pulley's inertia: vary m2 - m1 more, and m1 + m2"),
    ("m1,m2,a\n1,1,1\n", "", 1, "cannot read RUNS: no run can be used: in row 1, its masses are equal, and rest"),
    (ONE, "--axle 10N", 1,
        "cannot read RUNS: no run can be used: in row 1, an axle with the friction given holds its masses"),
    ("m1,m2,a\n1,2,1(1)\n1,3,2\n", "", 1,
        "cannot read RUNS: row 2 has no uncertainty of its a, as others have; give all"),
    ("m1,m2,a1,a2,±\n1,2,3,4,5\n", "", 1,
        "cannot read RUNS: row 1 has no uncertainty of its a, as others have; give all"),
    ("Masse 1;Masse 2;t\n1;2;3\n", "", 1, "cannot read RUNS: columns 'Masse 1', 'Masse 2' are not known; a row is a run,"
        " with m1, m2, and a or time: name them so, with units, as in 'm1 (g)'"),
    (SIMMONS, "--without 9", 2, "--without '9' is no row; there are 1 to 8"),
    (SIMMONS, "--without a", 2, "--without 'a' must be a whole number from 1 to 1000000000"),
    (SIMMONS, "--find mass", 2, "--find 'mass' is no quantity to fit; did you mean rim_mass?"),
    (SIMMONS, "--find g --g 9.8", 2, "--find 'gravity' is known by g; leave one of them out"),
    (SIMMONS, "--find c --M 1", 2, "--find 'rim_mass' is known by M; leave one of them out"),
    (SIMMONS, "--M inf", 2, "--M 'inf' lets nothing move; give the mass of a pulley that turns"),
    (SIMMONS, "--drop 1", 2, "--drop '1' has no part here: the table has a"),
    (SIMMONS, "--g 1e-31", 2, "--g '1e-31' is beyond what a fit computes with, 1e-30 to 1e+30"),
    (TIMED, "--drop 1e31", 2, "--drop '1e31' is beyond what a fit computes with, 1e-30 to 1e+30"),
    (SIMMONS, "--axle 1Nm", 2, "--axle '1Nm' is a torque, which needs the radius R as well"),
    (SIMMONS, "--only mu", 2, f"--only 'mu' is an input, no result; there are {ALL}"),
    (SIMMONS, "--only gravity", 1, NO_VALUE),
    (SIMMONS, "--only pulley_mass", 1,
        "pulley_mass: needs the rim mass to be fitted, and the pulley's shape, --inertia."),
    (SIMMONS, "--markdown", 2, "--markdown needs --explain"),
    (SIMMONS, "--bare", 2, "--bare needs --figure"),
    (SIMMONS, "--explain --json", 2, "--explain has no effect with --json; leave one of them out"),
    (SIMMONS, "--plot --csv", 2, "--plot has no effect with --csv; leave one of them out"),
    (SIMMONS, "--only axle --plot", 2, "--only 'axle' has no effect with --plot; leave one of them out"),
    (SIMMONS, "--figure a.gif", 2, "--figure 'a.gif' must end in one of .svg, .png, .pdf"),
]
# fmt: on


@pytest.mark.parametrize(("table", "more", "status", "error"), ERRORS)
def test_errors(fit: Any, table: str, more: str, status: int, error: str) -> None:
    ran = fit(table, *more.split())
    assert (ran.status, ran.out, ran.err) == (status, "", f"atwood: {error}\n")


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
    assert narrow[-2:] == [
        "  atwood solve --m1 0.2 --m2 0.207 --g 9.804 --M 0.032 \\",
        "    --inertia hoop --axle 0.0159",
    ]
    assert "│ rim_mass │ 0.031824 ± 0.023852 │" in atwood(*RIT, "--digits", "5").out
    with_radius = atwood(*RIT, "--R", "25mm", "--digits", "2").out.splitlines()
    assert with_radius[6].split("│")[1:-1:2] == [" moment_of_inertia ", " kg m² ", " (-2.8 to 6.7)e-5 "]
    assert with_radius[6].split("│")[2] == " (2.0 ± 1.5)e-5 "  # the uncertainty was left out


@pytest.mark.parametrize(
    ("value", "u", "digits", "both", "ends"),
    [
        (7.9652e-6, 2.3e-6, None, "(8.0 ± 2.3)e-6", "(3.4 to 12.6)e-6"),  # was (0.34 to 1.26)e-5
        (1.49e-5, 9e-7, None, "(1.490 ± 0.090)e-5", "(1.310 to 1.670)e-5"),
        (1.49e-5, 9e-7, 3, "(1.49 ± 0.09)e-5", "(1.31 to 1.67)e-5"),
        (-3e-7, 2e-5, None, "(0.0 ± 2.0)e-5", "(-4.0 to 4.0)e-5"),
        (0.764, 0.012, None, "0.764 ± 0.012", "0.740 to 0.788"),
        (0.764, 0.012, 1, "0.76 ± 0.01", "0.74 to 0.79"),  # some uncertainty is left
        (0.0, 0.012, 5, "0.000 ± 0.012", "-0.024 to 0.024"),
        (12345.678, 1200, None, "12300 ± 1200", "9900 to 14700"),
        (9.80665, 1.2e-10, None, "9.8066500000 ± 0.0000000001", "9.8066499998 to 9.8066500002"),
        (9.80665, 1e-14, None, "9.8066500000", ""),
        (0.25, 0.0, None, "0.250000", ""),
        (0.25, 0.0, 2, "0.25", ""),
        (
            2e-9,
            0.5,
            17,
            "0.0000000020000000 ± 0.5000000000000000",
            "-0.9999999979999999 to 1.0000000019999999",
        ),
    ],
)
def test_a_row_is_published_by_one_rule(
    value: float, u: float, digits: int | None, both: str, ends: str
) -> None:
    assert published(value, u, (value - 2 * u, value + 2 * u), digits) == (both, ends)


@pytest.mark.parametrize(
    "more", [(), ("--R", "25mm"), ("--R", "25mm", "--inertia", "disk"), ("--find", "c,f,g")]
)
def test_the_command_that_predicts_does(atwood: Atwood, fit: Any, more: tuple[str, ...]) -> None:
    out = fit(SIMMONS, *more).out
    *_, command = out.splitlines()
    if more[:1] == ("--find",):  # the friction is negative, by nothing
        assert "To predict" not in out
        return
    ran = atwood(*command.split()[1:], "--only", "acceleration")
    assert float(ran.out) == pytest.approx(
        found(fit(SIMMONS, *more, "--json"))["runs"][0]["expected"], rel=1e-3
    )


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
    # As text it is the table, and every note.
    lines = str(result).splitlines()
    assert lines[0].split("  ")[0] == "Quantity"
    assert [line.split()[0] for line in lines[1:4]] == ["moment_of_inertia", "rim_mass", "axle"]
    assert "(1.3 ± 2.6)e-5" in lines[1]
    assert all(note in " ".join(lines) for note in result.notes)
    assert max(map(len, lines)) <= 80
    assert "Quantity" not in str(laboratory_fit(EQUAL, M=1, axle=0))


@pytest.mark.parametrize(
    ("table", "more", "kind", "words"),
    [
        ({"m1": [1]}, {}, ValueError, "cannot read the runs: column m2 is missing; there are 'm1'"),
        (Path("none.csv"), {}, OSError, "cannot read none.csv: No such file or directory"),
        (TOP / "LICENSE", {}, OSError, f"cannot read {TOP / 'LICENSE'}: "),
        (EQUAL, {"find": "mass"}, SceneError, "find 'mass' is no quantity to fit; did you mean rim_mass?"),
        (EQUAL, {"find": ["g"], "g": 9.8}, SceneError, "find 'gravity' is known by g; leave one of them out"),
        (EQUAL, {"find": "c", "I": 1}, SceneError, "find 'rim_mass' is known by I; leave one of them out"),
        (EQUAL, {"without": [9]}, SceneError, "without '9' is no row; there are 1 to 2"),
        (EQUAL, {}, ArithmeticError, "the runs do not determine the pulley's inertia: vary m2 - m1 more, and m1 + m2"),
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
    assert all(
        part in shown for part in ("A row a run", "(wrap in degrees)", "kg, m/s² and s", kind.__name__)
    )


def test_of_many_runs_a_hundred_are_shown(fit: Any) -> None:
    table = "m1,m2,a\n" + "".join(
        f"1,{1.1 + i / 400},{0.45 + i / 900 + i % 3 / 50:.4f}\n" for i in range(120)
    )
    out = fit(table).out
    assert "20 more runs: --csv has all." in out
    assert len(fit(table, "--csv").out.splitlines()) == 121


def test_csv_has_a_row_a_run(atwood: Atwood, fit: Any) -> None:
    ran = atwood(*RIT, "--csv")
    rows = list(csv.DictReader(io.StringIO(ran.out)))
    assert list(rows[0]) == ["rows", "m1", "m2", "drop", "time", "u", "expected", "residual"]
    assert len(rows) == 5
    assert "atwood: rim_mass = 0.032 ± 0.024 kg" in ran.err.splitlines()
    lines = fit("Team,m1,m2,a\nA,1,2,2.4\nA,1,3,3.9\nB,1,1,0\n", "--csv").out.splitlines()
    assert lines[0] == "rows,Team,m1,m2,a,u,expected,residual"
    assert lines[-1] == "3,B,1,1,0,,,"


def test_bare_values(atwood: Atwood) -> None:
    ran = atwood(*RIT, "--only", "c,axle", "--digits", "3")
    assert ran.out == "0.0318\n0.0159\n"
    assert ran.err == "atwood: rim_mass = 0.032 ± 0.024 kg\natwood: axle = 0.0159 ± 0.0018 N\n"
    assert json.loads(atwood(*RIT, "--only", "dof", "--json").out) == {"dof": 3}
    run = json.loads(atwood(*RIT, "--digits", "2", "--json").out)["runs"][1]
    assert (run["m1"], run["time"], run["expected"], run["residual"]) == (0.2005, 4.58, 4.5, 1.1)
    assert atwood(*RIT, "--only", "dof", "--csv").out == "dof\n3\n"


@pytest.mark.parametrize("form", ["", "--json", "--csv", "--only rim_mass,axle,chi2"])
def test_no_result_has_more_digits_than_a_double(atwood: Atwood, form: str) -> None:
    ran = atwood(*RIT, "--R", "25mm", "--digits", "40", *form.split())
    assert ran.out == atwood(*RIT, "--R", "25mm", "--digits", "17", *form.split()).out
    numbers = re.findall(r"\d+\.\d+", ran.out)
    assert max(len(number.replace(".", "").lstrip("0")) for number in numbers) == 17


def test_the_line_is_explained(atwood: Atwood, fit: Any) -> None:
    out = atwood(*RIT, "--explain").out
    words = " ".join(out.split())
    assert "- rim mass: c = 0.032 ± 0.024 kg, 95 % interval -0.044 to 0.108 kg" in words
    assert "4. What was assumed, and what else to know\n" in out
    assert "Row 5 stands out" in fit(ODD, "--explain").out
    assert max(map(len, out.splitlines())) <= 80


LIGHT = "m1,m2,a\n" + "".join(f"{m},{m + d:.3f},{9.80665 * d / (2 * m + d - 0.08):.5f}\n" for m, d in APART)
"""Runs that would need a pulley of -80 g."""


@pytest.mark.parametrize(
    ("table", "more"),
    [
        (SIMMONS, ("--R", "25mm")),
        (ODD, ("--R", "25.0(5)mm", "--inertia", "0.5")),
        (ODD, ("--without", "5", "--M", "20g")),
        (LIGHT, ()),
    ],
)
def test_a_page_for_a_report(fit: Any, table: str, more: tuple[str, ...]) -> None:
    """Its mathematics is what every renderer takes, and nothing of the prose is mistaken for markup."""
    ran = fit(table, "--g", "9.81", *more, "--explain", "--markdown")
    assert (ran.status, ran.err) == (0, "")
    check_markdown(ran.out.splitlines(), "Runs of Atwood's machine")
    latex = [one or other for one, other in re.findall(r"\$\$\n(.*?)\n\$\$|\$(.*?)\$", ran.out, re.DOTALL)]
    prose = re.sub(r"\$\$.*?\$\$|\$.*?\$", "", ran.out, flags=re.DOTALL)
    assert not re.search(r"(?<!\\)(?:[_`$]|--)|±", prose)
    assert ("stands out" in prose, r"\pm" in ran.out.split("## 3")[1]) == (
        table == ODD and "5" not in more,
        table != LIGHT,
    )
    assert ("inertia factor" in prose) == ("--inertia" in more)  # which the moment of inertia is not
    mathtext = pytest.importorskip("matplotlib.mathtext").MathTextParser("path")
    to_mathml = pytest.importorskip("latex2mathml.converter").convert
    for words in latex:
        mathtext.parse(f"${words}$")
        assert "<merror" not in to_mathml(words)
    pypandoc = pytest.importorskip("pypandoc")
    strictly = ["--fail-if-warnings", "--standalone", "--metadata=title:Atwood"]
    html = pypandoc.convert_text(ran.out, "html", format="markdown", extra_args=[*strictly, "--mathml"])
    assert html.count("<math") == len(latex)
    assert "textbackslash" not in pypandoc.convert_text(
        ran.out, "latex", format="markdown", extra_args=strictly
    )


def test_a_page_for_a_report_has_the_results(fit: Any) -> None:
    page = fit(SIMMONS, "--g", "9.81", "--R", "25mm", "--explain", "--markdown").out
    assert (
        r"- moment of inertia: $I = (8.0 \pm 1.5) \times 10^{-6}$ kg m², 95 % interval"
        r" $(4.3~\mathrm{to}~11.6) \times 10^{-6}$ kg m²"
    ) in page
    assert r"- rim mass: $c = 0.0127 \pm 0.0024$ kg, 95 % interval $0.0069~\mathrm{to}~0.0186$ kg" in page
    assert r"- axle friction: $f = 0.0000 \pm 0.0011$ N, 95 % interval" in page
    assert "\nThe string is taken to have no mass, not to stretch and not to slip, the friction" in page


def test_what_is_no_result_is_not_drawn_as_one(fit: Any, tmp_path: Path) -> None:
    """The picture and the plot had a slope ± its uncertainty of a pulley that there is none of."""
    pytest.importorskip("matplotlib")
    assert "slope" not in fit(LIGHT, "--plot").out
    file = tmp_path / "line.svg"
    assert "there is none" in fit(LIGHT, "--figure", str(file)).out
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
    with pages_seen(monkeypatch) as pages:
        assert fit(table, *more, "--figure", str(tmp_path / "line.png")).status == 0
    (page,) = pages
    line = page.axes[0]
    (left, right), (low, high) = line.get_xlim(), line.get_ylim()
    for bars in line.collections:
        for (x, y), (to_x, to_y) in bars.get_segments():
            assert left <= x <= to_x <= right
            assert low <= y <= to_y <= high
    hollow = [one for one in line.lines if one.get_markerfacecolor() == "none" and one.get_markersize() < 9]
    assert [len(one.get_xdata()) for one in hollow] == [int("--without" in more)]
    assert (page.get_suptitle() == "") == bool(more)
    assert "$T_h - T_l$" in line.get_ylabel()
    assert misplaced(page) == []


def test_the_line_is_drawn(atwood: Atwood, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    file = tmp_path / "line.svg"
    assert atwood(*RIT, "--figure", str(file), "--only", "dof").status == 0
    svg = file.read_text(encoding="utf-8")
    texts = " ".join(labels(svg))
    assert all(
        words in texts for words in ("slope", "= 0.032 ± 0.024 kg", "= 0.0159 ± 0.0018 N", "residual (N)")
    )
    again = tmp_path / "again.svg"
    atwood(*RIT, "--figure", str(again), "--only", "dof")
    assert again.read_text(encoding="utf-8") == svg
    assert atwood(*RIT, "--figure", str(file)).status == 1


def test_the_line_is_plotted(atwood: Atwood) -> None:
    pytest.importorskip("plotille")
    out = atwood(*RIT, "--plot").out
    assert " T_h - T_l (N)\n" in out
    assert "slope c = 0.032 ± 0.024 kg.\nintercept f = 0.0159 ± 0.0018 N.\n" in out
    drawn = out[out.index("(N)") : out.index("slope")]
    assert all(digit in drawn for digit in "12345")


@pytest.mark.parametrize(("rows", "repeats"), [(4000, 1), (10, 1000)])
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
    result = found(fit("m1,m2,a,M\n1,2,2.4,heavy\n1,3,3.9,light\n", "--label", "M", "--json"))
    assert [run["M"] for run in result["runs"]] == ["heavy", "light"]


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
