"""The command line as scripts and people meet it: in process where that suffices, else as a process."""

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
from atwood_cli.model.quantities import ASCII, QUANTITIES, read_names

from . import oracle
from .running import PAPER, Atwood, on_real_terminal, on_terminal, plain, process
from .scenes import inputs

LOADED = "import sys; from atwood_cli.cli import run; run(sys.argv[1:]); print(*sys.modules, file=sys.stderr)"


# The table


def test_the_main_job_takes_one_screen() -> None:
    """A teacher's projector: the verdict and the prompt below the table in sight."""
    seen = plain(on_real_terminal(*PAPER, columns=80, rows=24))
    assert seen == plain(on_terminal(*PAPER, columns=80, rows=24))
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


# --only


@pytest.mark.parametrize("name", QUANTITIES)
def test_every_symbol_names_its_quantity(name: str) -> None:
    symbol = QUANTITIES[name].symbol
    plain = symbol.translate(ASCII)
    ways = [symbol, plain, plain.replace(" ", "_"), plain.replace(" ", ""), name, name.replace("_", "-")]
    assert read_names("only", ways, QUANTITIES) == [name] * len(ways)


# Errors


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
        f"atwood_cli.{name}"
        for name in ("cli.options", "cli.solve", "output.files", "output.scene_page", "output.text")
    }
    assert "numpy" not in loaded
    assert ("rich" in loaded) == ("atwood_cli.output.page" in ours) == (output == "")


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
