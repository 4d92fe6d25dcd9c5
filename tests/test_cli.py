"""The command line as scripts and people meet it: in process where that suffices, else as a process."""

import csv
import io
import json
import marshal
import re
import subprocess
import sys
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from atwood_cli import solve
from atwood_cli.__main__ import main
from atwood_cli.model.quantities import ASCII, MEASURED_NAMES, QUANTITIES, read_names

from . import oracle
from .running import PAPER, Atwood, on_terminal, plain, process
from .scenes import inputs

LOADED = "import sys; from atwood_cli.cli import run; run(sys.argv[1:]); print(*sys.modules, file=sys.stderr)"


# The table


def test_the_main_job(atwood: Atwood) -> None:
    ran = atwood(*PAPER)
    assert (ran.status, ran.err) == (0, "")
    lines = ran.out.splitlines()
    assert lines[0] == "m1 = 1 kg, m2 = 3 kg, mu = 0.3, g = 9.80665 m/s², inertia = 0.5, wrap = 180°"
    assert " ".join(lines[1:3]) == (
        "On the verge of slipping: as M is not given, this is for the critical pulley mass, 43.3419 kg."
        " On a heavier pulley the string slips; on one without mass the acceleration is 4.90332 m/s²."
    )
    row = next(line for line in lines if "critical_pulley_mass" in line)
    assert row.split("│")[1:-1] == [
        " critical_pulley_mass ",
        " 43.3419   ",
        " kg   ",
        " M*     ",
        " (34)     ",
    ]
    assert lines[-1].startswith("╰")


def test_the_main_job_takes_one_screen() -> None:
    """A teacher's projector: the verdict and the prompt below the table in sight."""
    seen = plain(on_terminal(*PAPER, columns=80, rows=24))
    assert seen.count("\n") < 24
    assert max(map(len, seen.splitlines())) <= 80


SHOWN = """
m1=1 m2=3 mu=0.3
m1=1.0(1) m2=3 M=10 mu=0.3 R=5cm
m1=55g m2=60g a=0.38(1) digits=20
m1=1 m2=3 M=inf mu=1e10 wrap=3rad
m1=1e-400 m2=3 M=10 mu=1e8 digits=9
"""


@pytest.mark.parametrize("given", SHOWN.strip().splitlines())
def test_a_solution_shows_itself_as_the_command_does(atwood: Atwood, given: str) -> None:
    typed = ["solve", *(word for one in given.split() for word in f"--{one}".split("="))]
    solution: Any = solve(**inputs(given))
    assert f"{solution}\n" == atwood(*typed).out
    number: Any = str if "digits" in given else float
    shown = json.loads(atwood(*typed, "--json").out, parse_float=number, parse_int=number)
    assert json.loads(json.dumps(solution.to_dict(), allow_nan=False)) == {**shown, "version": 2}


def test_a_printed_solution_fits_the_terminal_and_has_no_colours(monkeypatch: pytest.MonkeyPatch) -> None:
    solution = solve(m1=1, m2=3, M="10(1)")
    monkeypatch.setenv("COLUMNS", "60")
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True, raising=False)
    assert max(map(len, str(solution).splitlines())) <= 60
    assert "\x1b" not in str(solution)


MAIN = "acceleration tension_1 tension_2 mu_verge friction_force"


@pytest.mark.parametrize(
    ("words", "names"),
    [
        ("--m1 1 --m2 3", MAIN),
        ("--m1 1 --m2 3 --mu 0.3", f"{MAIN} critical_pulley_mass"),
        ("--m1 1 --m2 3 --M 10 --R 1", f"{MAIN} torque angular_acceleration"),
        (
            "--m1 1 --m2 3 --M 10 --mu 0.3",
            "acceleration tension_1 tension_2 mu_verge safety_factor friction_force_min friction_force_max"
            " critical_pulley_mass critical_heavier_mass",
        ),
        (
            "--m1 1 --m2 3 --M 50 --mu 0.3 --wrap 170",
            "acceleration tension_1 tension_2 mu_verge safety_factor friction_force rim_acceleration"
            " critical_pulley_mass critical_heavier_mass least_wrap",
        ),
        ("--m1 1 --m2 3 --M 10 --axle 1N", f"{MAIN} axle_force"),
        ("--m1 1 --m2 3 --axle 1N --wrap 170", MAIN),
        ("--m1 1 --m2 3 --a 1 --R 1", f"{MAIN} torque angular_acceleration"),
        ("--m1 1 --m2 3 --drop 1 --time 1", MAIN.removeprefix("acceleration ")),
        ("--m1 0 --m2 3 --M 10", "acceleration tension_1 tension_2"),
    ],
)
def test_the_table_shows_what_the_scene_is_about(atwood: Atwood, words: str, names: str) -> None:
    shown = re.findall(r"│ (\w+) ", atwood("solve", *words.split()).out)
    assert [name for name in shown if name in QUANTITIES] == names.split()


@pytest.mark.parametrize(
    ("words", "shown", "absent"),
    [
        ("--m1 1 --m2 3 --M 10 --mu 0.3", r"\nfriction_force: between friction_force_min", "torque"),
        (
            "--m1 1 --m2 3 --M 10 --mu 0.5",
            "critical_pulley_mass: does not exist, as the string holds",
            "least_pulley_mass",
        ),
        ("--m1 1 --m2 3 --M 100 --mu 0.3", r"│ acceleration .*\(1\), \(26\)", "…"),  # equations of the regime
        ("--m1 1 --m2 3 --M 10 --mu 0.3", r"│ acceleration .*\(4\)", "…"),
        # Without mu, F holds at the least coefficient that is enough; the row says so.
        (
            "--m1 1 --m2 3 --M 10 --all",
            r"│ friction_force at mu_verge .*\n│ friction_force_x at mu_verge ",
            "…",
        ),
        ("--m1 1 --m2 3 --M inf --a 4", r"│ friction_force +│", "at mu_verge"),
        ("--m1 1 --m2 3 --mu 0.3", r"│ friction_force +│", "at mu_verge"),
        ("--m1 1 --m2 3", r"│ friction_force +│", "at mu_verge"),
        ("--m1 1 --m2 3 --mu 1e9", "^m1 = 1 kg", "│"),  # a table without rows is none
        ("--m1 1 --m2 3 --mu 0.3 --json", '"acceleration": 0.764026672247107,', "…"),
        ("--m1 1 --m2 3 --mu 0.3 --json --digits 4", '"acceleration": 0.7640,', "…"),
        ("--m1 2 --m2 2 --json", '"acceleration": 0,', "…"),
    ],
)
def test_what_is_shown(atwood: Atwood, words: str, shown: str, absent: str) -> None:
    ran = atwood("solve", *words.split())
    assert (ran.status, ran.err) == (0, "")
    assert re.search(shown, ran.out)
    assert absent not in ran.out


def test_with_all_the_table_shows_what_exists_and_the_notes_the_rest(atwood: Atwood) -> None:
    solution = solve(m1="1", m2="3", mu="0.3")
    table, notes = atwood(*PAPER, "--all").out.split("╰")
    for name in oracle.NAMES[1:]:
        exists = getattr(solution, name) is not None
        assert bool(re.search(rf"│ {name} ", table)) == exists
        assert exists or name in notes


@pytest.mark.parametrize("digits", ["1", "40", "300"])
@pytest.mark.parametrize("columns", [10, 40, 60, 80, 200])
def test_no_width_cuts_a_number_off(columns: int, digits: str) -> None:
    seen = on_terminal(*PAPER, "--all", "--digits", digits, columns=columns)
    unwrapped = plain(seen).replace("\n", "")
    solution = solve(m1="1", m2="3", mu="0.3", digits=int(digits))
    for value in (solution.acceleration, solution.friction_force_y, solution.critical_pulley_mass):
        assert str(value).lower().replace("e+", "e") in unwrapped
    assert "…" not in seen


@pytest.mark.parametrize(
    "words", ["", "--M 10 --R 2", "--M 10 --mu-k 0.2 --all", "--axle 1N", "--m2 3.00(1)"]
)
def test_at_40_columns_no_sentence_splits_a_word_or_a_unit(words: str) -> None:
    options = [*PAPER, *words.split()]
    if "--m2" in words:
        options = ["solve", "--m1", "1", "--mu", "0.3", *words.split()]
    lines = [line for line in plain(on_terminal(*options, columns=40)).splitlines() if line[0] not in "╭├│╰"]
    assert max(map(len, lines)) <= 40
    for line, after in pairwise(lines):
        assert not re.search(r"\d$", line) or not re.match(r"(kg|N|m/s²|rad/s²)\b", after)
    whole = process(*options).out.split()
    assert {word for line in lines for word in line.split()} - set(whole) <= {"="}


def test_piped_no_line_of_text_is_longer_than_100_columns(atwood: Atwood) -> None:
    for words in (["solve"], ["solve", "--all"], ["contact"], ["sweep", "--g", "1:10:4"]):
        ran = atwood(*words, "--m1", "1", "--m2", "3", "--M", "10.25", "--mu", "0.3", "--mu-k", "0.29")
        assert (ran.status, ran.err) == (0, "")
        assert max(map(len, ran.out.splitlines())) <= 100


def test_piped_the_table_is_whole_whatever_the_width(atwood: Atwood, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "30")
    out = atwood(*PAPER, "--digits", "300").out
    assert str(solve(m1="1", m2="3", mu="0.3", digits=300).acceleration) in out
    assert "Equation" in out


def test_colour_only_on_a_terminal_that_wants_it(atwood: Atwood) -> None:
    assert "\x1b" not in atwood(*PAPER).out
    assert "\x1b[1;33mOn the verge" in on_terminal(*PAPER, columns=90)
    assert "\x1b[1mOn the verge" in on_terminal(*PAPER, columns=90, NO_COLOR="1")
    assert "\x1b" not in on_terminal(*PAPER, columns=90, TERM="dumb")


# JSON


def test_json_holds_every_name_the_scene_and_the_notes(atwood: Atwood) -> None:
    ran = atwood("solve", "--m1", "1", "--m2", "3", "--M", "inf", "--mu", "0.3", "--g", "moon", "--json")
    assert (ran.status, ran.err) == (0, "")
    result = json.loads(ran.out, parse_constant=lambda word: pytest.fail(word))
    beside = ["uncertainty", "budget"]
    assert list(result) == ["version", "scene", *oracle.NAMES, *MEASURED_NAMES, *beside, "notes"]
    assert result["scene"] == {
        **{"m1": 1, "m2": 3, "M": "inf", "mu": 0.3, "mu_k": None, "g": 1.62},
        **{"inertia": 0.5, "I": None, "R": None, "wrap": 180, "axle": None},
        **{"a": None, "drop": None, "time": None},
    }
    solution = solve(m1="1", m2="3", M="inf", mu="0.3", g="moon")
    assert {name: result[name] for name in oracle.NAMES} == {
        name: getattr(solution, name) for name in oracle.NAMES
    }
    assert result["notes"] == list(solution.notes)
    assert ran.out.isascii()


@pytest.mark.parametrize(("digits", "g"), [((), 8.333333333333334), (("--digits", "4"), 8.333)])
@pytest.mark.parametrize("command", [["solve"], ["contact", "--M", "1"], ["sweep", "--M", "1:2:2"]])
def test_json_has_numbers_that_are_no_decimals_as_results(
    atwood: Atwood, command: list[str], digits: tuple[str, ...], g: float
) -> None:
    """A decimal is exact, whatever --digits."""
    more = [] if command == ["solve"] else ["--R", "1", "--axle", "25/324 Nm"]
    given = ["--m1", "1.0000000000000000001", "--m2", "3", "--g", "25/3"]
    ran = atwood(*command, *given, *more, *digits, "--json")
    assert '"m1": 1.0000000000000000001,\n' in ran.out
    scene = json.loads(ran.out)["scene"]
    assert scene["g"] == g
    assert scene["axle"] is None or float(scene["axle"].removesuffix(" Nm")) == pytest.approx(25 / 324, 1e-3)
    assert "/" not in str(scene.get("axle"))


def test_json_never_says_infinity(atwood: Atwood) -> None:
    ran = atwood("solve", "--m1", "1e400", "--m2", "2e400", "--json")
    result = json.loads(ran.out, parse_constant=lambda word: pytest.fail(word))
    assert result["tension_1"] is None
    assert any("tension_1" in note and "--digits" in note for note in result["notes"])
    assert '"m1": 1e400,' in ran.out
    wide = atwood("solve", "--m1", "1e400", "--m2", "2e400", "--json", "--digits", "5")
    assert '"tension_1": 1.3076e401,' in wide.out


# CSV


def test_csv_is_a_line_of_names_and_a_line_of_values(atwood: Atwood) -> None:
    ran = atwood(*PAPER, "--csv")
    assert ran.status == 0
    names, values = csv.reader(io.StringIO(ran.out))
    assert names == list(oracle.NAMES)
    row = dict(zip(names, values, strict=True))
    assert row["regime"] == "verge"
    assert row["critical_pulley_mass"] == "43.34192486321087"
    assert row["torque"] == ""
    assert "atwood: torque, angular_acceleration: give R, the pulley's radius.\n" in ran.err


# --only


NO_RADIUS = "atwood: torque: give R, the pulley's radius.\n"


@pytest.mark.parametrize(
    ("words", "out", "err", "status"),
    [
        ("--only regime --only tension_1 --digits 5", "verge\n10.571\n", "", 0),
        ("--only torque --only mu_verge", "\n0.3\n", NO_RADIUS, 1),  # each on the line of its name
        ("--only torque", "", NO_RADIUS, 1),
        ("--csv --only tension_2,regime", "tension_2,regime\n27.12786998325868,verge\n", "", 0),
        ("--json --only mu_verge,torque", '{\n  "mu_verge": 0.3,\n  "torque": null\n}\n', NO_RADIUS, 1),
        ("--only acceleration,tension_1,mu_verge --digits 3", "0.764\n10.6\n0.300\n", "", 0),
        ("--only a,T₁ --only μ* --digits 3", "0.764\n10.6\n0.300\n", "", 0),
        ("--only a,T1,mu* --digits 3", "0.764\n10.6\n0.300\n", "", 0),
    ],
)
def test_only(atwood: Atwood, words: str, out: str, err: str, status: int) -> None:
    assert atwood(*PAPER, *words.split()) == (status, out, err)


@pytest.mark.parametrize("name", QUANTITIES)
def test_every_symbol_names_its_quantity(name: str) -> None:
    symbol = QUANTITIES[name].symbol
    plain = symbol.translate(ASCII)
    ways = [symbol, plain, plain.replace(" ", "_"), plain.replace(" ", ""), name, name.replace("_", "-")]
    assert read_names("only", ways, QUANTITIES) == [name] * len(ways)


def test_only_of_a_value_below_the_doubles_is_its_double_with_a_note(atwood: Atwood) -> None:
    ran = atwood("solve", "--m1", "1e-400", "--m2", "3e-400", "--only", "tension_1")
    assert (ran.status, ran.out) == (0, "0\n")
    assert "not 0 but below the range of doubles" in ran.err
    beyond = atwood("solve", "--m1", "1e400", "--m2", "3e400", "--only", "tension_1")
    assert (beyond.status, beyond.out) == (1, "")


# Errors


WRONG_USAGE = """
solve => --m1 is missing; give both masses, m1 and m2
solve --m1 1 => --m2 is missing; give both masses, m1 and m2
solve --m1 1,5 --m2 2 => --m1 '1,5' is not a number; write it with a decimal point, 1.5
solve --m1 1,5,0 --m2 2 => --m1 '1,5,0' is not a number; write it like 2, 1.5e-3, 2.0+-0.1 or 2.0(1)
solve --m1 1 --m2 2 --M 0:10:3 => --M '0:10:3' is a range, not a number; atwood sweep takes ranges
solve --m1 -1 --m2 2 => --m1 '-1' must be 0 or more, and finite
solve --m1 1 --m2 2 --mu-k 1 => --mu-k '1' needs mu, the coefficient that decides whether it slips
solve --m1 1 --m2 2 --digits 0 => --digits '0' must be a whole number from 1 to 1000
solve --m1 1 --m2 2 --digits 1.5 => --digits '1.5' must be a whole number from 1 to 1000
contact --m1 1 --m2 2 --force => --force needs --output or --figure
solve --m1 1 --m2 2 --force => --force needs --output or --figure
solve --m1 1 --m2 2 -o a.md => --output 'a.md' must end in one of .txt, .json, .csv
solve --m1 1 --m2 2 -o a.json --explain => --output 'a.json' must end in one of .txt
solve --m1 1 --m2 2 -o a.pdf --explain --markdown => --output 'a.pdf' would hold Markdown; name it a.md; then pandoc a.md -o a.pdf makes the other
solve --m1 1 --m2 2 --bare => --bare needs --figure
solve --m1 0 --m2 1e-400 --M 1 --figure a.svg => --figure 'a.svg' draws forces between 1e-100 and 1e+100 N only
solve --m1 1 --m2 2 --figure a.gif => --figure 'a.gif' must end in one of .svg, .png, .pdf
solve --m1 1 --m2 2 --mu 2 --figure a.svg => --figure 'a.svg' draws the tensions, which are not known: give M, the pulley's mass, which decides here
solve --m1 1 --m2 2 --mu 0.1 --mu-k 0.2 => --mu-k '0.2' must not be above mu; exactly, 0.2 > 0.1
solve --m1 1 --m2 2 --all --json => --all has no effect with --json; leave one of them out
solve --m1 1 --m2 2 --all --csv => --all has no effect with --csv; leave one of them out
solve --m1 1 --m2 2 --all --only a => --all has no effect with --only; leave one of them out
solve --m1 1 --m2 2 --all --explain => --all has no effect with --explain; leave one of them out
sweep --m1 1:2:3 => --m2 is missing; give both masses, m1 and m2
sweep --m1 1 --m2 3 --M 1:2:3 --figure => Option '--figure' requires an argument
solve --m1 1 --m2 2 --json --csv => --json has no effect with --csv; leave one of them out
solve --m1 1 --m2 2 --only tention_1 => --only 'tention_1' is no quantity; did you mean tension_1?
solve --m1 1 --m2 2 --only accel => --only 'accel' is no quantity; did you mean acceleration?
solve --m1 1 --m2 2 --only t1 => --only 't1' is no quantity; did you mean tension_1?
solve --m1 1 --m2 2 --only zzz => --only 'zzz' is no quantity; atwood quantities lists them
solve --m1 1 --m2 2 --only wrap => --only 'wrap' is an input, no quantity; atwood quantities lists them
solve --m1 1 --m2 2 --radus 3 => No such option: --radus (Possible options: --a, --radius, --wrap); atwood solve -h shows how
solve --zzz => No such option: --zzz; atwood solve -h shows how
solve --bogus 1 => No such option: --bogus (Possible options: --g); atwood solve -h shows how
solve --Digit 1 => No such option: --Digit (Possible options: --digits, --g); atwood solve -h shows how
solve --m1 1 --m2 3 --wrap 3.14 --mu x => --mu 'x' is not a number; write it like 2, 1.5e-3, 2.0+-0.1 or 2.0(1)
solve --m1 => Option '--m1' requires an argument
solve --m1 1 --m2 3 --M --mu 0.3 => --M lacks its value: what follows is the option --mu
solve --m1 1 --m2 3 --M --mu=0.3 => --M lacks its value: what follows is the option --mu=0.3
solve --m1 1 --m2 3 --only --json => --only lacks its value: what follows is the option --json
solve --m1 1 --m2 3 --M= => --M '' is empty; give a value, or leave it out
solve --m1 200 g --m2 300 g => Got unexpected extra arguments (g g); atwood solve -h shows how
solve -m1 1 --m2 3 => No such option: -m1. Did you mean --m1?; atwood solve -h shows how
solve --m1 1 -M 3 => No such option: -M. Did you mean --M?; atwood solve -h shows how
solve —m1 1 --m2 3 => No such option: —m1. Did you mean --m1?; atwood solve -h shows how
solve m1=1 m2=3 => Got unexpected extra arguments (m1=1 m2=3); atwood solve -h shows how
solve 1 3 => Got unexpected extra arguments (1 3); atwood solve -h shows how
slove => No such command 'slove'. Did you mean 'solve'?; atwood -h shows how
"""


@pytest.mark.parametrize("line", WRONG_USAGE.strip().splitlines())
def test_wrong_usage(atwood: Atwood, line: str) -> None:
    arguments, message = line.split(" => ")
    ran = atwood(*arguments.split())
    assert (ran.status, ran.out) == (2, "")
    # typer words its own complaints a little differently from version to version.
    assert ran.err.replace("argument(s)", "arguments") == f"atwood: {message}\n"


@pytest.mark.parametrize("wrap", ["3.14159", "3.1", "6.28", " 1.57 ", "1e0"])
def test_an_angle_that_looks_like_radians_is_remarked_on(atwood: Atwood, wrap: str) -> None:
    for words in (["solve", "--only", "mu_verge"], ["contact", "--csv"], ["sweep", "--g", "1:2:2", "--csv"]):
        ran = atwood(*words, "--m1", "1", "--m2", "3", "--M", "10", "--wrap", wrap)
        assert ran.status == 0
        assert ran.err.endswith(
            f"atwood: --wrap {wrap} was taken for degrees; if it is in radians, write rad behind it, as 3.14rad\n"
        )


@pytest.mark.parametrize("wrap", ["180", "3.14159rad", "3deg", "3°", "0.5turn", "12.6", "4e-6", "90:180:3"])
def test_other_angles_are_not(atwood: Atwood, wrap: str) -> None:
    command = "sweep" if ":" in wrap else "solve"
    ran = atwood(command, "--m1", "1", "--m2", "3", "--M", "10", "--wrap", wrap)
    assert (ran.status, ran.err) == (0, "")


ESCAPE = "\x1b]0;owned\x07\n"


@pytest.mark.parametrize(
    ("words", "status"),
    [
        ("batch {}.csv", 1),
        ("batch {}.pdf", 2),
        ("batch {}.csv -o x/{}", 1),
        ("sweep --m1 1 --m2 3 --M 0:1:2 -o x/{}.csv", 1),
        ("contact --m1 1 --m2 3 --M 1 --figure x/{}.svg", 1),
        ("solve {}", 2),
        ("solve --{}", 2),
        ("solve --m1 1 --m2 2 --only {}", 2),
        ("{}", 2),
    ],
)
def test_no_name_that_is_typed_steers_the_terminal(atwood: Atwood, words: str, status: int) -> None:
    ran = atwood(*(word.format(ESCAPE) for word in words.split()))
    assert (ran.status, ran.out) == (status, "")
    assert "\x1b" not in ran.err
    assert ran.err.count("\n") == 1
    assert r"\x1b]0;owned\x07" in ran.err


LONG = [
    "a" * 100_000,
    "1 kg" + "*st^9" * 20_000,
    "1" * 100_000,
    "1," * 50_000 + "1",
    "x " * 50_000,
    "-" * 100_000,
]


@pytest.mark.parametrize("long", LONG, ids=lambda word: word[:8])
def test_no_message_repeats_all_that_was_typed(atwood: Atwood, long: str) -> None:
    """Nor does it take long: an unknown unit of 100 kB took a minute."""
    scene = ["--m1", "1", "--m2", "3"]
    for words in (
        *(
            [command, *scene, name, long]
            for command in ("solve", "contact")
            for name in ("--M", "--wrap", "--I")
        ),
        *(["sweep", *scene, "--M", word] for word in (long, f"{long}:2:3", f"1:2:{long}", f"1:2:3:{long}")),
        *(["sweep", *scene, "--M", "1:2:3", name, long] for name in ("--only", "--figure", "-o", "--digits")),
        *([*words, long] for words in ([], ["solve"], ["solve", *scene], ["solve", *scene, "--M", "1"])),
        *(["solve", *scene, word] for word in (f"--{long}", f"--json={long}", f"-{long}=1")),
        *(["solve", *scene, "--M", f"--mu={long}"], ["solve", *scene, *["x"] * 20_000]),
        ["contact", *scene, "--figure", long],
        *([command, long] for command in ("batch", "fit")),
        *(["batch", "-", name, long] for name in ("--from", "--only", "--accuracy")),
        *(["fit", "-", name, long] for name in ("--find", "--only", "--drop")),
        ["tradeoff", "--family", long],
    ):
        ran = atwood(*words)
        assert ran.status in (1, 2)
        assert ran.out == ""
        assert ran.err.count("\n") == 1
        assert len(ran.err) < 700, words[:5]


# How it begins and ends


def test_version_and_help(atwood: Atwood) -> None:
    assert re.fullmatch(r"atwood \d+\.\d+\.\d+\n", atwood("--version").out)
    assert atwood("-V") == atwood("--version")
    assert atwood("help", "sweep") == atwood("sweep", "-h") == atwood("sweep", "--help")
    assert atwood("help", "slove").status == 2


@pytest.mark.parametrize("output", ["--json", "--csv", "--only acceleration", ""])
def test_only_what_is_needed_is_imported(output: str) -> None:
    loaded = set(process(*PAPER, *output.split(), code=LOADED).err.split())
    ours = {name for name in loaded if name.startswith(("atwood_cli.cli.", "atwood_cli.output."))}
    assert ours - {"atwood_cli.output.page"} == {
        f"atwood_cli.{name}" for name in ("cli.options", "cli.solve", "output.scene_page", "output.text")
    }
    assert "numpy" not in loaded
    assert ("rich" in loaded) == ("atwood_cli.output.page" in ours) == (output == "")


ASKED = ["--only", "torque", "--only", "mu_verge"]


@pytest.mark.parametrize("form", [[], ["--json"], ["--csv"]])
def test_what_only_names_and_no_row_has_is_a_status_in_every_form(atwood: Atwood, form: list[str]) -> None:
    """The README's rule, whose output is the same with a radius but for the torque."""
    for command in (["solve", "--M", "1"], ["sweep", "--M", "1:2:2"]):
        words = [*command, "--m1", "1", "--m2", "3", *form]
        without, given = atwood(*words, *ASKED), atwood(*words, *ASKED, "--R", "1")
        assert (without.status, given.status) == (1, 0)
        assert without.out.strip()
        assert "give R, the pulley's radius" in without.out + without.err
        assert without.err.startswith("atwood: torque")
        assert atwood(*words).status == 0  # which lacks it too, but nobody asked


def test_what_only_names_and_one_row_has_is_there(atwood: Atwood) -> None:
    words = ["--m1", "1", "--m2", "3", "--mu", "0.1:0.4:4", "--only", "critical_pulley_mass", "--csv"]
    ran = atwood("sweep", *words)
    assert ran.status == 0
    assert ran.out.endswith("\n0.4,\n")


def test_the_door_opens_before_anything_is_loaded() -> None:
    """So that Ctrl-C while the rest loads finds the handler in place."""
    loaded = process(code="import sys, atwood_cli.__main__; print(*sys.modules)").out.split()
    assert "atwood_cli.__main__" in loaded
    assert not {"atwood_cli.cli", "atwood_cli.solver", "atwood_cli.model", "typer"} & set(loaded)


def test_numbers_may_be_as_long_in_any_environment() -> None:
    words = ["solve", "--m1", f"1.{'3' * 900}", "--m2", "3", "--digits", "1000", "--csv"]
    ran = process(*words, PYTHONINTMAXSTRDIGITS="640")
    assert (ran.status, ran.err) == (0, process(*words).err)


def test_an_error_that_is_no_interrupt_is_raised(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail() -> int:
        raise ImportError("numpy._core.multiarray failed to import")

    monkeypatch.setattr("atwood_cli.cli.run", fail)
    monkeypatch.setattr("signal.signal", lambda *_: None)  # this process goes on
    with pytest.raises(ImportError):
        main()


def test_a_compiled_module_that_was_cut_off_is_no_interrupt(
    atwood: Atwood, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Python raises this as it loads one, and typer takes it for Ctrl-D: it ended with 130, without a word."""
    monkeypatch.setattr("atwood_cli.cli.solve.read_answers", lambda *_: marshal.loads(b""))
    ran = atwood(*PAPER)
    assert (ran.status, ran.out) == (1, "")
    assert ran.err.lstrip() == "atwood: a file of the program is damaged; install it again\n"


def test_python_dash_m_and_the_command_are_one() -> None:
    command = Path(sys.executable).with_name("atwood")
    if not command.exists():
        pytest.skip("not installed")
    words = [str(command), *PAPER, "--json"]
    assert (
        subprocess.run(words, capture_output=True, text=True, check=True).stdout
        == process(*PAPER, "--json").out
    )


# As a program


ENDING = """
import atexit, sys
from atwood_cli.__main__ import main
atexit.register(lambda: print("at exit"))
sys.stdout.write("before ")
status = main()
sys.stdout.write("after ")
sys.exit(status)
"""


@pytest.mark.parametrize(("words", "status", "out"), [("--only regime", 0, "verge\n"), ("--zzz", 2, "")])
def test_what_is_left_to_do_at_exit_is_done(words: str, status: int, out: str) -> None:
    """main freezes what the garbage collector would look through; handlers run and streams are flushed."""
    ran = process(*PAPER, *words.split(), code=ENDING)
    assert (ran.status, ran.out) == (status, f"before {out}after at exit\n")


def test_the_program_collects_garbage_and_a_library_is_left_alone() -> None:
    code = "import gc, sys; {}; print(gc.isenabled(), gc.get_freeze_count() > 0, file=sys.stderr)"
    solved = "from atwood_cli import cli, solve; solve(m1=1, m2=3); cli.run(['--version'])"
    program = "from atwood_cli.__main__ import main; sys.argv[1:] = ['--version']; main()"
    for what, seen in ((solved, "True False\n"), (program, "True True\n")):
        assert process(code=code.format(what)).err == seen
