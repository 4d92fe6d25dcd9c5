"""`atwood fit`: what runs require, against SciPy, against data made from the model, and as it is printed."""

import csv
import io
import json
import re
import subprocess
import sys
from fractions import Fraction
from math import inf, sqrt
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest
from scipy import optimize, stats

from atwood_cli import solve
from atwood_cli.fit import model
from atwood_cli.fit.fitting import Fit, fitted, known_of
from atwood_cli.fit.line import points
from atwood_cli.fit.runs import Kind, Run, Runs
from atwood_cli.fit.student import beta_share, chi2_beyond, fisher_beyond, student_beyond, student_within
from atwood_cli.model.scene import INPUTS, Input, read_input

from .running import Atwood, labels, misplaced, on_terminal, pages_seen, plain, process

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
POLAND = "m1,m2,a\n0.06,0.066,0.3269176828\n0.06,0.07,0.5183372802\n0.06,0.076,0.8821971763\n"
NOTHING = {name: read_input(name, None) for name in INPUTS}


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


# Data made from the model

MASSES = ((0.2, 0.207), (0.2, 0.206), (0.25, 0.256), (0.15, 0.155), (0.202, 0.205), (0.3, 0.31), (0.207, 0.2))
C, F, G, DROP = 0.042, 0.0153, 9.80665, 0.98


def made(
    kind: Kind, random: Random, u: float, given: bool, u_mass: float = 0, repeats: int = 1, c: float = C
) -> Runs:
    """Runs of a pulley and an axle that are known, with normal errors; repeats share those of masses."""

    def exact(value: float, uncertainty: float = 0) -> Input:
        return Input(Fraction(value), Fraction(uncertainty), None)

    runs = []
    for number, masses in enumerate(MASSES, 1):
        l, h = (mass + random.gauss(0, u_mass) for mass in sorted(masses))
        a = (G * (h - l) - F) / (h + l + c)
        measured = a if kind == "a" else sqrt(2 * DROP / a)
        values = tuple(exact(measured + random.gauss(0, u), u * given) for _ in range(repeats))
        m1, m2 = (exact(mass, u_mass) for mass in masses)
        runs.append(Run((number,), {}, m1, m2, exact(DROP) if kind == "time" else None, values))
    return Runs(kind, runs, True, False, [], [])


@pytest.mark.parametrize("kind", ["a", "time"])
def test_what_made_exact_runs_is_found(kind: Kind) -> None:
    runs = made(kind, Random(1), 0, False)
    for find, known in ((["rim_mass", "axle"], {}), (["axle", "gravity"], {"M": "42g", "inertia": "1"})):
        inputs = NOTHING | {x: read_input(x, word) for x, word in known.items()}
        best = fitted(runs, known_of(inputs, runs), find)
        for name in find:
            assert best.values[name] == pytest.approx(
                {"rim_mass": C, "axle": F, "gravity": G}[name], rel=1e-9
            )
        assert points(best).residual == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize("kind", ["a", "time"])
@pytest.mark.parametrize(
    ("given", "u_mass", "repeats"), [(False, 0, 1), (False, 0, 3), (True, 0, 1), (True, 1e-4, 3)]
)
def test_intervals_of_95_percent_cover_95_percent(
    kind: Kind, given: bool, u_mass: float, repeats: int
) -> None:
    random, count, hits = Random(f"{kind}{given}{u_mass}{repeats}"), 200, [0, 0]
    for _ in range(count):
        runs = made(kind, random, {"a": 0.002, "time": 0.06}[kind], given, u_mass, repeats)
        best = fitted(runs, known_of(NOTHING, runs), ["rim_mass", "axle"])
        for i, (name, true) in enumerate((("rim_mass", C), ("axle", F))):
            hits[i] += abs(best.values[name] - true) < best.times * (best.uncertainty(name) or 0)
    for hit in hits:  # within 3 standard deviations of a binomial; scaling makes it a little more
        assert abs(hit / count - 0.95) < 3 * sqrt(0.95 * 0.05 / count) + 0.01


def test_what_is_not_there_is_left_out_in_95_percent() -> None:
    random, count, needed = Random(95), 300, 0
    for _ in range(count):
        runs = made("a", random, 0.002, True, c=0)
        needed += "rim_mass" in fitted(runs, known_of(NOTHING, runs), []).values
    assert abs(needed / count - 0.05) < 3 * sqrt(0.95 * 0.05 / count)


@pytest.mark.parametrize("kind", ["a", "time"])
def test_slopes_are_those_of_differences(kind: Kind) -> None:
    given: dict[str, Any] = {
        "l": np.array([0.2, 0.25]),
        "h": np.array([0.207, 0.26]),
        "drop": np.array([0.98, 0.5]),
        **{"rim_mass": C, "axle": F, "gravity": G},
    }
    names = [name for name in given if kind == "time" or name != "drop"]
    value, slopes = model.expected(kind, given, names)
    for i in range(2):
        scene = solve(m1=given["l"][i], m2=given["h"][i], M=C, inertia=1, axle=F, g=G)
        assert scene.acceleration is not None
        wanted = scene.acceleration if kind == "a" else sqrt(2 * given["drop"][i] / scene.acceleration)
        assert value[i] == pytest.approx(wanted, rel=1e-13)
    for name in names:
        step = 1e-6 * given[name]
        ends = [model.expected(kind, given | {name: given[name] + side * step}, [])[0] for side in (-1, 1)]
        assert slopes[name] == pytest.approx((ends[1] - ends[0]) / (2 * step), rel=1e-5)
    nowhere, _ = model.expected("time", given | {"axle": 1.0}, [])
    assert np.isnan(nowhere).all()


# Against SciPy


def by_scipy(best: Fit, sigma: Any, absolute: bool) -> tuple[Any, Any]:
    data = best.data

    def ideal(_: Any, c: float, f: float) -> Any:
        a = (best.estimate.values["gravity"] * (data.h - data.l) - f) / (data.h + data.l + c)
        return a if data.kind == "a" else np.sqrt(2 * DROP / a)

    return optimize.curve_fit(  # type: ignore[no-any-return]
        ideal,
        data.l,
        data.measured,
        [0.03, 0.01],
        sigma,
        absolute,
        xtol=1e-14,
        ftol=1e-14,
        gtol=1e-14,
        maxfev=10_000,
    )


@pytest.mark.parametrize("kind", ["a", "time"])
@pytest.mark.parametrize(("given", "u_mass"), [(False, 0.0), (True, 0.0), (True, 1e-4)])
def test_values_and_uncertainties_are_those_of_scipy(kind: Kind, given: bool, u_mass: float) -> None:
    runs = made(kind, Random(7), {"a": 0.002, "time": 0.06}[kind], given, u_mass)
    best = fitted(runs, known_of(NOTHING, runs), ["rim_mass", "axle"])
    values, covariance = by_scipy(best, best.estimate.sigma, absolute=given)
    for i, name in enumerate(best.estimate.found):
        assert best.values[name] == pytest.approx(values[i], rel=1e-6)
        assert (best.uncertainty(name) or 0) / best.scale**given == pytest.approx(
            sqrt(covariance[i, i]), rel=1e-4
        )
    assert best.correlation is not None
    assert best.correlation[2] == pytest.approx(
        covariance[0, 1] / sqrt(covariance[0, 0] * covariance[1, 1]), rel=1e-4
    )


# Published runs


def test_times_of_rit(atwood: Atwood) -> None:
    """Fifteen times by SciPy, each alike: c = 42 ± 11 g, f = 15.3 ± 0.5 mN."""
    result = found(atwood(*RIT, "--json"))
    assert list(result) == [
        *("rim_mass", "axle", "gravity", "uncertainty", "correlation", "chi2", "dof", "runs", "notes")
    ]
    l, h = np.array([200, 200.5, 201, 201.5, 202]) / 1000, np.array([207, 206.5, 206, 205.5, 205]) / 1000
    times = [4.06, 4.03, 3.88, 4.53, 4.59, 4.62, 5.00, 5.00, 5.06, 6.13, 6.16, 6.19, 8.00, 7.75, 7.87]

    def ideal(i: Any, c: float, f: float) -> Any:
        i = i.astype(int)
        return np.sqrt(2 * 0.98 * (l[i] + h[i] + c) / (9.804 * (h[i] - l[i]) - f))

    values, covariance = optimize.curve_fit(ideal, np.repeat(np.arange(5), 3), times, [0.04, 0.015])
    for i, name in enumerate(("rim_mass", "axle")):
        assert result[name] == pytest.approx(values[i], rel=1e-4)
        assert result["uncertainty"][name] == pytest.approx(sqrt(covariance[i, i]), rel=1e-3)
    assert (f"{result['rim_mass']:.3f}", f"{result['axle']:.4f}") == ("0.042", "0.0153")
    assert (f"{result['uncertainty']['rim_mass']:.3f}", f"{result['uncertainty']['axle']:.4f}") == (
        "0.011",
        "0.0005",
    )
    assert (result["gravity"], result["dof"]) == (None, 13)
    assert result["correlation"] == pytest.approx(-0.913, abs=1e-3)
    assert [run["rows"] for run in result["runs"]] == ["1", "2", "3", "4", "5"]
    assert result["runs"][0]["time"] == 3.99
    assert result["notes"][0] == (
        "5 runs, 15 times. Axle friction is needed (33 standard uncertainties from 0); so is the pulley's inertia"
        " (4.0)."
    )
    about = " ".join(result["notes"])
    assert "may as well be 1.6 g of mass unaccounted for on the lighter side" in about
    assert "swap the sides to tell" in about
    assert "scatter 2.2 times as much as their repeats explain, which chance would do in 2.2 %" in about
    assert "m1 + m2 is the same in all runs" in about


def test_accelerations_of_simmons_need_no_axle(fit: Any) -> None:
    result = found(fit(SIMMONS, "--g", "9.81", "--json", "--R", "25mm", "--inertia", "disk"))
    assert result["rim_mass"] == pytest.approx(0.0128, abs=2e-4)
    assert result["uncertainty"]["rim_mass"] == pytest.approx(8e-4, rel=0.05)
    assert (result["axle"], result["correlation"], result["chi2"], result["dof"]) == (None, None, None, 7)
    assert result["moment_of_inertia"] == pytest.approx(result["rim_mass"] * 0.025**2)
    assert result["pulley_mass"] == pytest.approx(2 * result["rim_mass"])
    assert result["uncertainty"]["pulley_mass"] == pytest.approx(2 * result["uncertainty"]["rim_mass"])
    assert "Axle friction is not (0.025), and left out." in result["notes"][0]


def test_three_runs_of_poland_do_not_tell_the_two_apart(fit: Any) -> None:
    result = found(fit(POLAND, "--g", "9.812", "--json"))
    assert result["axle"] is None
    assert any(
        "do not tell the pulley's inertia from axle friction: axle friction alone would do, too, axle = 0.0280"
        " ± 0.0057 N. To tell, vary m2 - m1 more, and m1 + m2." in note
        for note in result["notes"]
    )


# How runs are written

PLAIN = "m1,m2,time\n0.2,0.207,3.99\n0.2005,0.2065,4.58\n0.201,0.206,5.02\n0.2015,0.2055,6.16\n0.202,0.205,7.873\n"


@pytest.mark.parametrize(
    "table",
    [
        PLAIN.replace(",", ";").replace(".", ","),
        PLAIN.replace(",", "\t"),
        "\ufeff" + PLAIN.replace("\n", "\r\n"),
        PLAIN.replace("\n", "\n\n"),
        PLAIN.replace("time", "Team,time 1").replace("\n0", "\nA,0").replace("m1,m2,Team", "Team,m1,m2"),
        re.sub(r"^(0.2\d*),(0.2\d*)", lambda m: f"{m[1]}kg,{1000 * float(m[2]):g} g", PLAIN, flags=re.M),
        PLAIN.replace("time", "time,drop")
        .replace("\n0", ",98 cm\n0")
        .replace("873\n", "873,0.98\n")
        .replace("drop,98 cm", "drop"),
        PLAIN.replace("m1,m2,time", "m2,m1,time_1"),
    ],
)
def test_what_spreadsheets_write_is_the_same(fit: Any, table: str) -> None:
    drop = [] if "drop" in table else ["--drop", "98cm"]
    both = ["--find", "c,f", "--json"]
    want, got = found(fit(PLAIN, "--drop", "98cm", *both)), found(fit(table, *drop, *both))
    for name in ("rim_mass", "axle", "uncertainty", "dof"):
        assert got[name] == pytest.approx(want[name], rel=1e-12)


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
    assert "accelerations have no sign here" in " ".join(found(fit(swapped, "--json"))["notes"]).lower()
    line = found(fit(signed, "--json"))["runs"][3]
    assert (line["a"], line["expected"] < 0) == (-0.31, True)


def test_stdin() -> None:
    ran = process(
        "fit",
        "-",
        "--only",
        "dof",
        shell="printf 'm1,m2,a\\n1,2,1\\n1,3,2\\n2,3,1\\n' | atwood fit - --only dof",
    )
    assert (ran.status, ran.out) == (0, "2\n")


def test_no_extra_package_is_needed_for_csv() -> None:
    code = (
        "import sys; from atwood_cli.cli import run; status = run(['fit', *sys.argv[1:]]);"
        "sys.exit(status or bool({'polars', 'scipy', 'matplotlib', 'plotille'} & set(sys.modules)))"
    )

    assert (
        subprocess.run(
            [sys.executable, "-c", code, *RIT[1:], "--json"], stdout=subprocess.DEVNULL, check=False
        ).returncode
        == 0
    )


# What is known, and what is to be found


def test_what_is_known_is_not_fitted(fit: Any) -> None:
    result = found(fit(SIMMONS, "--M", "26g", "--g", "9.81", "--json"))
    assert (result["rim_mass"], result["axle"], result["uncertainty"]) == (None, None, {})
    assert result["notes"][0] == (
        "8 runs, 8 accelerations. Axle friction (0.23 standard uncertainties from 0) is not needed."
    )
    both = found(fit(SIMMONS, "--M", "26g", "--axle", "1mN", "--json"))
    assert "Nothing is left to find: the pulley and its axle are known." in both["notes"][0]
    assert both["dof"] == 8
    by_moment = found(fit(SIMMONS, "--I", "13 g m2", "--R", "1m", "--g", "9.81", "--json"))
    assert by_moment["dof"] == result["dof"]
    assert found(fit(SIMMONS, "--axle", "0", "--g", "9.81", "--json"))["rim_mass"] == pytest.approx(
        0.0128, abs=1e-4
    )


def test_gravity_is_found_if_asked_for(fit: Any) -> None:
    result = found(fit(SIMMONS, "--find", "g", "--M", "26g", "--axle", "0", "--json"))
    assert result["gravity"] == pytest.approx(9.81, abs=0.1)
    assert (result["rim_mass"], result["axle"]) == (None, None)
    alone = found(fit(SIMMONS, "--find", "gravity", "--json"))
    assert "Neither fitted nor given, and so taken to be 0: rim_mass, axle." in alone["notes"]
    three = found(fit(SIMMONS, "--find", "c,f,g", "--json"))
    assert set(three["uncertainty"]) == {"rim_mass", "axle", "gravity"}
    assert any("hardly tell the pulley's inertia from gravity" in note for note in three["notes"])


def test_what_is_known_and_uncertain_counts_for_all_runs_together(fit: Any) -> None:
    """g is off in all runs alike: c by (S + c)/g times as much, for runs without other errors."""
    table = "m1,m2,a\n" + "".join(
        f"{l},{h},{9.81 * (h - l) / (h + l + 0.02)}\n"
        for l, h in ((1.0, 1.25), (1.05, 1.2), (1.0, 1.25), (1.1, 1.15))
    )
    result = found(fit(table, "--g", "9.81(2)", "--find", "c", "--json"))
    assert result["uncertainty"]["rim_mass"] == pytest.approx(0.02 / 9.81 * 2.27, rel=1e-6)
    timed = "m1,m2,time\n" + "".join(
        f"{l},{h},{sqrt(2 * (h + l + 0.02) / (9.81 * (h - l)))}\n"
        for l, h in ((1.0, 1.25), (1.05, 1.2), (1.1, 1.15))
    )
    result = found(fit(timed, "--g", "9.81", "--drop", "1.00(1)", "--find", "c", "--json"))
    assert result["uncertainty"]["rim_mass"] == pytest.approx(0.01 * 2.27, rel=1e-6)  # a goes with the height
    radius = found(fit(SIMMONS, "--R", "25(1)mm", "--json"))
    share = radius["uncertainty"]["moment_of_inertia"] / radius["moment_of_inertia"]
    c_share = radius["uncertainty"]["rim_mass"] / radius["rim_mass"]
    assert share == pytest.approx(sqrt(c_share**2 + 0.08**2))
    axle = found(fit(SIMMONS, "--R", "25(1)mm", "--axle", "0.05(1)mNm", "--json"))
    assert axle["uncertainty"]["rim_mass"] > 1.2 * radius["uncertainty"]["rim_mass"]
    assert axle["axle"] is None


# What is odd about runs


def noted(ran: Any, words: str) -> bool:
    return any(words in note for note in found(ran)["notes"])


@pytest.mark.parametrize(
    ("table", "more", "words"),
    [
        (
            SIMMONS.replace("0.780", "2.1"),
            (),
            "Row 8 cannot be: it is faster than a massless pulley without friction allows, whose acceleration is at"
            " most 0.8406 m/s^2.",
        ),
        (
            SIMMONS.replace("0.780", "2.1"),
            (),
            "Without row 8: rim_mass = 0.01244 ± 0.00096 kg. None was left out",
        ),
        (
            PLAIN.replace("6.16", "2.1"),
            ("--drop", "98cm"),
            "Row 4 cannot be: it is faster than a massless pulley without friction allows, whose time is at least"
            " 4.510 s.",
        ),
        (SIMMONS + "0.1,0.1,0\n", (), "Row 9 could not be used: its masses are equal, and rest."),
        (SIMMONS + "0.1,0.2,0\n", (), "Row 9 could not be used: nothing moved."),
        (SIMMONS + "0.1,0.2,-1\n", (), "Row 9 could not be used: the lighter side falls."),
        (
            SIMMONS.replace("0.303", "0.203"),
            (),
            "Row 5 stands out: 4.9 standard uncertainties from what the others say.",
        ),
        (SIMMONS.replace("0.303", "0.203"), (), "Without row 5: rim_mass ="),
        (
            SIMMONS,
            ("--mu", "0.001"),
            "Row 1 cannot be: the string would slip, as its mu = 0.001 is too small for these masses.",
        ),
        (
            "m1,m2,a\n1,1.05,.02\n1,1.5,1.301\n1,2,2.516\n1,3,4.136\n1.1,2.2,2.5756\n",
            (),
            "Row 1 cannot be: by the friction that was found, the axle would hold its masses (up to",
        ),
        (
            SIMMONS.replace("0.0", "1.0").replace("0.65,", "1.65,"),
            ("--find", "c"),
            "No pulley has a negative inertia:",
        ),
        (
            "m1,m2,a\n1,1.5,2.5\n1,2,3.7\n1,3,5.2\n1.1,2.2,3.7\n",
            ("--find", "f"),
            "No axle has a negative friction:",
        ),
        (
            "m1,m2,a\n1,2,1\n1,3,2\n2,3,-1\n3,2,-2\n",
            ("--find", "g"),
            "could not be used: the lighter side falls.",
        ),
        (
            "m1,m2,a\n1.00(1),2.00(1),2.50(1)\n1.00(1),3.00(1),4.10(1)\n1.50(1),2.00(1),0.70(1)\n2.0(1),3.0(1),1.7(1)\n",
            (),
            "times as much as their uncertainties say (chi-squared",
        ),
        (
            "m1,m2,a\n1,2,2.31(1)\n1,2.01,2.32(1)\n",
            (),
            "axle friction alone would do, too, axle = 2.899 ± 0.021 N. To tell, vary m2 - m1, and m1 + m2.",
        ),
    ],
)
def test_what_is_odd_is_said(fit: Any, table: str, more: tuple[str, ...], words: str) -> None:
    notes = found(fit(table, *more, "--json"))["notes"]
    assert any(words in note for note in notes), notes


def test_a_free_end_is_a_run_too(fit: Any) -> None:
    """A cart on a table: c is its mass and the pulley's."""
    table = "m1,m2,a\n" + "".join(f"0,{m},{9.80665 * m / (m + 0.5)}\n" for m in (0.05, 0.1, 0.2)) + "0,0,0\n"
    result = found(fit(table, "--mu", "0.3", "--find", "c", "--json"))
    assert result["rim_mass"] == pytest.approx(0.5, rel=1e-6)
    assert "Row 4 could not be used: its masses are equal, and rest." in result["notes"]


def test_good_runs_are_not_called_odd(fit: Any) -> None:
    for ran in (fit(SIMMONS, "--g", "9.81", "--mu", "0.3", "--json"), fit(POLAND, "--json")):
        assert not any("Row" in note for note in found(ran)["notes"])


def test_two_runs_with_uncertainties_are_enough(fit: Any) -> None:
    result = found(fit("m1,m2,a\n1,2,2.31(1)\n1,5,5.45(1)\n", "--find", "c,f", "--json"))
    assert (result["dof"], result["chi2"]) == (0, pytest.approx(0, abs=1e-12))
    assert result["uncertainty"]["rim_mass"] > 0


@pytest.mark.parametrize(
    ("table", "more", "error"),
    [
        ("m1,m2\n1,2\n", (), "column a or time is missing; there are 'm1', 'm2'"),
        ("m1,a\n1,2\n", (), "column m2 is missing; there are 'm1', 'a'"),
        (
            "m1,m2,a,time\n1,2,1,1\n",
            (),
            "columns a and time both tell the acceleration; keep one, or let one pass by --label",
        ),
        ("m1,m2,time\n1,2,1\n", (), "times need the height of fall: a column drop, or --drop"),
        ("m1,m2,a,a\n1,2,1,1\n", (), "column 'a' is there 2 times"),
        (
            "m1,m2,a,a (m/s2)\n1,2,1,1\n",
            (),
            "two columns are both 'a'; number what is repeated, as in 'time 1'",
        ),
        ("m1,m2,a,Team,Team\n1,2,1,x,y\n", (), "column 'Team' is there 2 times"),
        ("m1,m2,a,u\n1,2,1,1\n", (), "column 'u' would be there twice, as a result is named so; rename it"),
        ("m1,m2,a\n", (), "it has no runs"),
        ("m1,m2,a\n1,1,1\n", (), "no run can be used: in row 1, its masses are equal, and rest"),
        ("m1,m2,a\n1,x,1\n", (), "row 1: m2 'x' is not a number; write it like 2, 0.5 or 1.5e-3"),
        ("m1,m2,a\n1,,1\n", (), "row 1 has no m2"),
        ("m1,m2,a\n1,2\n", (), "row 1 has 2 cells, and the header 3"),
        (
            "m1,m2,a\n1,2,1,5\n",
            (),
            "row 1 has 4 cells, and the header 3; is there a decimal comma? write a point",
        ),
        (
            "m1;m2;a\n1,5;2.5;1\n",
            (),
            "row 1: m2 '2.5' has a point in a table of decimal commas; write all alike",
        ),
        (
            "m1,m2,a,M\n1,2,1,1\n",
            (),
            "column 'M' holds for all runs, so it is an option: give --M; or let it pass by --label 'M'",
        ),
        (
            "m1,m2,t\n1,2,1\n",
            (),
            "column 't' could be meant for time; name it so, with a unit like 'time (s)'; or let it pass by --label 't'",
        ),
        (
            "m1,mass2,a\n1,2,1\n",
            (),
            "column 'mass2' could be meant for m2; name it so, with a unit like 'm2 (kg)'; or let it pass by --label 'mass2'",
        ),
        (
            "m1 (s),m2,a\n1,2,1\n",
            (),
            "column 'm1 (s)' has a unit of time; it takes one of mass (kg, g, mg, ug, t, lb, lbs, oz, st); or let it pass by --label 'm1 (s)'",
        ),
        (
            "m1,m2,a\n1,2,1(1)\n1,3,2\n",
            (),
            "row 2 has no uncertainty of its a, as others have; give all",
        ),
        (
            "m1,m2,a\n1(1),2,1\n1,3,2\n",
            (),
            "row 2 has no uncertainty, and others have one; give all of them, or none",
        ),
        (
            'm1,m2,a\n1,"2,1\n',
            (),
            "it ends within quotation marks opened in line 2: it is truncated, or one is left open",
        ),
        ("", (), "it is empty"),
        ("m1,m2,a\n1e31,2,1\n", (), "row 1: m1 '1e31' is beyond what a fit computes with, 1e-30 to 1e+30"),
        (
            "m1,m2,a\n1,2,1\n",
            ("--axle", "10N"),
            "no run can be used: in row 1, an axle with the friction given holds its masses",
        ),
    ],
)
def test_a_table_that_is_none(fit: Any, table: str, more: tuple[str, ...], error: str) -> None:
    ran = fit(table, *more)
    assert (ran.status, ran.out, ran.err) == (1, "", f"atwood: cannot read RUNS: {error}\n")


@pytest.mark.parametrize(
    ("table", "more", "status", "error"),
    [
        (
            "m1,m2,a\n1,2,1\n1,3,2\n",
            (),
            1,
            "2 measurements are too few for what is to be fitted and its scatter: give more, or their uncertainties (as 2.05+/-0.02), or what is known (--M, --axle), or name one thing to --find",
        ),
        (
            "m1,m2,a\n" + 3 * "1,2,1\n",
            (),
            1,
            "the runs do not tell the pulley's inertia from axle friction: vary m2 - m1, and m1 + m2",
        ),
        (
            "m1,m2,a\n1,3,1\n1.5,2.5,.5\n1.9,2.1,.1\n",
            ("--find", "c,g"),
            1,
            "the runs do not tell the pulley's inertia from gravity: vary m1 + m2 as well",
        ),
        (SIMMONS, ("--find", "mass"), 2, "--find 'mass' is nothing to fit; did you mean rim_mass?"),
        (
            SIMMONS,
            ("--find", "g", "--g", "9.8"),
            2,
            "--find 'gravity' is known by --g; leave one of them out",
        ),
        (SIMMONS, ("--find", "c", "--M", "1"), 2, "--find 'rim_mass' is known by --M; leave one of them out"),
        (SIMMONS, ("--M", "inf"), 2, "--M 'inf' lets nothing move; give the mass of a pulley that turns"),
        (SIMMONS, ("--drop", "1"), 2, "--drop '1' has no part here: the table has a"),
        (SIMMONS, ("--g", "1e-31"), 2, "--g '1e-31' is beyond what a fit computes with, 1e-30 to 1e+30"),
        (PLAIN, ("--drop", "1e31"), 2, "--drop '1e31' is beyond what a fit computes with, 1e-30 to 1e+30"),
        (SIMMONS, ("--axle", "1Nm"), 2, "--axle '1Nm' is a torque, which needs the radius R as well"),
        (
            SIMMONS,
            ("--only", "mu"),
            2,
            "--only 'mu' is no result; there are rim_mass, axle, gravity, chi2, dof, moment_of_inertia, pulley_mass",
        ),
        (SIMMONS, ("--only", "gravity"), 1, "gravity: was not needed, or is known, and so not fitted."),
        (
            SIMMONS,
            ("--only", "pulley_mass"),
            1,
            "pulley_mass: needs the rim mass to be fitted, and the pulley's shape, --inertia.",
        ),
        (SIMMONS, ("--explain", "--json"), 2, "--explain has no part in --json; leave one of them out"),
        (SIMMONS, ("--plot", "--csv"), 2, "--plot draws text, not CSV; leave one of them out"),
        (
            SIMMONS,
            ("--only", "axle", "--plot"),
            2,
            "--only 'axle' has no say beside --plot; leave one of them out",
        ),
        (SIMMONS, ("--figure", "a.gif"), 2, "--figure 'a.gif' must end in one of .svg, .png, .pdf"),
    ],
)
def test_errors(fit: Any, table: str, more: tuple[str, ...], status: int, error: str) -> None:
    ran = fit(table, *more)
    assert (ran.status, ran.out, ran.err) == (status, "", f"atwood: {error}\n")


def test_a_row_without_a_measurement_is_no_run(fit: Any) -> None:
    assert noted(fit(SIMMONS + "0.1,0.2,\n", "--json"), "Row 9 has no a: it is no run.")


# How it is printed


def test_the_page(atwood: Atwood) -> None:
    ran = atwood(*RIT)
    assert (ran.status, ran.err) == (0, "")
    lines = ran.out.splitlines()
    assert lines[0] == "g = 9.804 m/s², drop = 0.98 m"
    assert lines[6] == "│ rim_mass │ 0.042 ± 0.011     │ kg   │ c      │ 0.019 to 0.065     │"
    assert "│ 1   │ 0.2     │ 0.207   │ 3.990 ± 0.061 │ 4.063        │ -1.19      │" in lines
    assert lines[-2:] == [
        "To predict:",
        "  atwood solve --m1 0.2 --m2 0.207 --g 9.804 --M 0.042 --inertia hoop --axle 0.01529",
    ]
    narrow = plain(on_terminal(*RIT, columns=60)).splitlines()
    assert narrow[-2:] == [
        "  atwood solve --m1 0.2 --m2 0.207 --g 9.804 --M 0.042 \\",
        "    --inertia hoop --axle 0.01529",
    ]
    assert "│ rim_mass │ 0.042210 │" in atwood(*RIT, "--digits", "5").out


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


def test_csv_has_a_row_a_run(atwood: Atwood, fit: Any) -> None:
    ran = atwood(*RIT, "--csv")
    rows = list(csv.DictReader(io.StringIO(ran.out)))
    assert list(rows[0]) == ["rows", "m1", "m2", "drop", "time", "u", "expected", "residual"]
    assert len(rows) == 5
    assert "atwood: rim_mass = 0.042 ± 0.011 kg" in ran.err.splitlines()
    unusable = fit(
        "Team," + SIMMONS.replace("\n", "\nA,").rstrip("A,") + "B,1,1,0\n", "--csv"
    ).out.splitlines()
    assert unusable[0] == "rows,Team,m1,m2,a,u,expected,residual"
    assert unusable[-1] == "9,B,1,1,0,,,"


def test_bare_values(atwood: Atwood) -> None:
    ran = atwood(*RIT, "--only", "rim_mass,axle", "--digits", "3")
    assert ran.out == "0.0422\n0.0153\n"
    assert ran.err == "atwood: rim_mass = 0.042 ± 0.011 kg\natwood: axle = 0.01529 ± 0.00047 N\n"
    assert json.loads(atwood(*RIT, "--only", "dof", "--json").out) == {"dof": 13}
    run = json.loads(atwood(*RIT, "--digits", "2", "--json").out)["runs"][1]
    assert (run["m1"], run["time"], run["expected"], run["residual"]) == (0.2005, 4.58, 4.5, 1.3)
    assert atwood(*RIT, "--only", "dof", "--csv").out == "dof\n13\n"


def test_the_line_is_explained(atwood: Atwood, fit: Any) -> None:
    out = atwood(*RIT, "--explain").out
    assert "  (3) T_h - T_l = c a + f\n" in out
    assert "      y = T_h - T_l = (h - l) g - a (h + l)\n" in out
    assert "  - row 1: a = 0.123115 m/s², y = 0.0185203 N\n" in out
    assert "y = c a + f, c = 0.0422098 kg, f = 0.0152931 N" in out
    assert (
        "4.0 standard uncertainties from 0;\n    chance stays within 2.16 in 95 % of all cases: needed" in out
    )
    assert "  - axle friction: -0.00003 ± 0.00101 N" not in out
    assert "left out" in fit(SIMMONS, "--explain").out
    assert "What to fit was said (--find)" in fit(SIMMONS, "--find", "c", "--explain").out
    assert max(map(len, out.splitlines())) <= 80


def test_the_line_is_drawn(atwood: Atwood, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    file = tmp_path / "line.svg"
    assert atwood(*RIT, "--figure", str(file), "--only", "dof").status == 0
    svg = file.read_text(encoding="utf-8")
    texts = " ".join(labels(svg))
    assert "slope" in texts
    assert "= 0.042 ± 0.011 kg" in texts
    assert "= 0.01529 ± 0.00047 N" in texts
    assert "residual (N)" in texts
    again = tmp_path / "again.svg"
    atwood(*RIT, "--figure", str(again), "--only", "dof")
    assert again.read_text(encoding="utf-8") == svg
    assert atwood(*RIT, "--figure", str(file)).status == 1


def test_no_words_of_the_line_overlap_or_run_off(
    fit: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    many = "m1,m2,a\n" + "".join(f"1,{1.1 + i / 40},{0.45 + i / 90}\n" for i in range(20))
    for i, table in enumerate((SIMMONS, many)):
        with pages_seen(monkeypatch) as pages:
            assert fit(table, "--figure", str(tmp_path / f"{i}.png")).status == 0
        assert [misplaced(page) for page in pages] == [[]]


def test_the_line_is_plotted(atwood: Atwood) -> None:
    pytest.importorskip("plotille")
    out = atwood(*RIT, "--plot").out
    assert " T_h - T_l (N)\n" in out
    assert "slope c = 0.042 ± 0.011 kg.\nintercept f = 0.01529 ± 0.00047 N.\n" in out
    drawn = out[out.index("(N)") : out.index("slope")]
    assert all(digit in drawn for digit in "12345")


def test_of_many_odd_runs_five_have_a_sentence(fit: Any) -> None:
    notes = found(
        fit(SIMMONS + 8 * "0.1,0.1,0\n" + "".join(f"0.1,0.10{i},0\n" for i in range(1, 9)), "--json")
    )["notes"]
    assert sum("could not be used" in note for note in notes) == 6
    assert "4 more could not be used: rows 21, 22, 23, 24." in notes


def test_many_runs_are_not_compared_with_each_other() -> None:
    """20,000 rows took five minutes: whether any run has a sign was asked for each of them."""
    random = Random(20_000)
    runs = [made("a", random, 0.002, False) for _ in range(600)]
    many = runs[0]._replace(runs=[run._replace(rows=(i,)) for i, one in enumerate(runs) for run in one.runs])
    best = fitted(many, known_of(NOTHING, many), [])
    assert len(best.lines) == 4200
    assert best.values["rim_mass"] == pytest.approx(C, abs=4 * (best.uncertainty("rim_mass") or 0))


def test_a_label_may_look_like_an_input(fit: Any) -> None:
    table = (
        SIMMONS.replace("m1,m2,a", "m1,m2,a,M").replace("\n0", ",heavy\n0").replace("M,heavy", "M").rstrip()
        + ",light\n"
    )
    result = found(fit(table, "--label", "M", "--json"))
    assert [run["M"] for run in result["runs"]] == ["heavy"] * 7 + ["light"]


def test_runs_without_any_scatter_require_what_they_show(fit: Any) -> None:
    """What is known without any uncertainty was left out, as if it were known with all of it."""
    rows = [
        (m1, m2, solve(m1=m1, m2=m2, M="0", g="10").acceleration)
        for m1, m2 in (("1", "3"), ("2", "3"), ("1", "4"))
    ]
    table = "m1,m2,a\n" + "".join(f"{m1},{m2},{a}\n" for m1, m2, a in rows)
    result = found(fit(table, "--g", "10", "--json"))
    assert max(abs(result[name] or 0) for name in ("rim_mass", "axle")) < 1e-12
    exact = "m1,m2,a\n1,2,2.5\n1,2,2.5\n"  # 10 (2 - 1)/(1 + 2 + 1)
    result = found(fit(exact, "--g", "10", "--axle", "0", "--json"))
    assert result["rim_mass"] == 1
    assert "is needed (more than any number of standard uncertainties from 0)" in result["notes"][0]


def test_repeats_of_either_sign_are_averaged_with_their_signs(fit: Any) -> None:
    result = found(fit("m1,m2,a 1,a 2\n1,1.01,0.1,-0.02\n1,2,3,3.1\n1,3,4.7,4.8\n", "--find", "c", "--json"))
    assert [run["a"] for run in result["runs"]] == [0.04, 3.05, 4.75]
    assert result["chi2"] is not None


def test_an_inertia_that_runs_away_is_not_told(atwood: Atwood, tmp_path: Path) -> None:
    """Runs that no pulley explains: it grew until nothing depended on it, which LAPACK did not take."""
    path = tmp_path / "runs.csv"
    path.write_text(
        "m1,m2,a\n"
        "1.4902594501435225+/-0.01,1.6235554121487294+/-0.01,0.3089214721279846+/-0.01\n"
        "1.294845704527006+/-0.01,1.8471607525147582+/-0.01,1.5335939325623844+/-0.01\n"
        "1.2484303713661655+/-0.01,1.455744342272462+/-0.01,0.6018093116086901+/-0.01\n"
    )
    ran = atwood("fit", str(path), "--R", "0.3", "--g", "0.5")
    assert (ran.status, ran.out) == (1, "")
    assert ran.err == "atwood: the runs do not tell the pulley's inertia: vary m2 - m1 more, and m1 + m2\n"
