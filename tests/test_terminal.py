"""Every command wherever it may run: terminals of any width, without colour, without Unicode, without room."""

import re
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from time import process_time
from typing import Any

import pytest

from atwood_cli.output.text import wrapped

from .tools import running
from .tools.running import PAPER, TOP, called, on_real_terminal, plain, process

SCENE = "--m1 1 --m2 3"
COMMANDS = {
    "solve": f"solve {SCENE} --M 10 --mu 0.3 --R 5cm --digits 30",
    "all": f"solve {SCENE} --mu 0.3 --all --digits 300",
    "kinetic": f"solve {SCENE} --M 10 --mu 0.3 --mu-k 0.2 --axle 1N --all",
    "json": f"solve {SCENE} --mu 0.3 --json",
    "budget": f"solve {SCENE} --M 10+/-0.01 --mu 0.3 --budget",
    "explain": f"solve {SCENE} --M 10 --mu 0.3 --R 1 --explain",
    "markdown": f"solve {SCENE} --M 10 --mu 0.3 --R 1 --explain --markdown",
    "contact": f"contact {SCENE} --M 10 --mu 0.3 --R 5cm --points 4 --digits 30",
    "sweep": f"sweep {SCENE} --M 0:100:9 --mu 0.3 --digits 30",
    "fit": f"fit {TOP}/examples/rit.csv --drop 98cm",
    "batch": "batch {table}",
    "help": "",
    "helps": "sweep -h",
    "error": "solve --m1 1 --m2 µ",
    "usage": "solve --zzz",
}
"""A command of each kind; others that come are added here."""
NO_PROSE = ("json", "markdown", "batch", "help", "helps")
"""Those that print lines for programs, or that typer breaks."""
PLACES: dict[str, Any] = {
    "forced colour": {"FORCE_COLOR": "1"},
    "no colour": {"NO_COLOR": "1"},
    "dumb": {"TERM": "dumb"},
    "ascii": {"PYTHONIOENCODING": "ascii"},
    "cp1252": {"PYTHONIOENCODING": "cp1252"},
}
DISK = pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")


piped, on_terminal = cache(process), cache(running.on_terminal)  # what several tests compare with is run once


@pytest.fixture(scope="module")
def table(tmp_path_factory: pytest.TempPathFactory) -> str:
    file = tmp_path_factory.mktemp("terminal") / "in.csv"
    file.write_text("m1,m2,M,mu\n1,3,10,0.3\n1,3,100,0.3\n")
    return str(file)


def words(command: str, table: str) -> list[str]:
    return COMMANDS[command].format(table=table).split()


def numbers(text: str) -> set[str]:
    """The long ones, whatever lies between them."""
    return set(re.findall(r"\d+\.\d{7,}", text))


@pytest.mark.parametrize("command", COMMANDS)
def test_no_width_loses_a_digit_or_parts_a_word(command: str, table: str) -> None:
    typed = words(command, table)
    usual = piped(*typed)
    assert usual.status == (2 if command in ("error", "usage") else 0)
    for columns in (10, 40, 60, 80, 100, 200):
        seen = plain(on_terminal(*typed, columns=columns, rows=10))  # rows were left out
        assert numbers(usual.out + usual.err) <= numbers(seen), (columns, seen)
        assert "…" not in seen
        # No cell is folded: `no-slip` was `no-sli` and `p`. Each row has a number, or begins a group.
        assert not re.search(r"no-sli +│", seen)
        assert columns < 60 or not re.search(r"^│ +│.*│ +-?\d", seen, re.MULTILINE)
        prose = [line for line in seen.splitlines() if line and line[0] not in "╭├│╰"]
        assert prose
        if command not in NO_PROSE and columns > 10:
            assert all(len(line) <= columns or numbers(line) for line in prose)
            if command != "explain":
                whole = {*(usual.out + usual.err).split(), "="}
                assert {word for line in prose for word in line.split()} <= whole
    for width in ("0", "30", "80"):
        ran = piped(*typed, COLUMNS=width, LINES="5")
        assert (ran.status, numbers(ran.out)) == (usual.status, numbers(usual.out))


@pytest.mark.parametrize("command", COMMANDS)
def test_every_place_says_the_same(command: str, table: str) -> None:
    """What colour tells, words tell: without it the text is the same, but for symbols that a stream lacks."""
    typed = words(command, table)
    everywhere = plain(on_terminal(*typed, columns=100))
    told = {word for word in everywhere.split() if word.isascii() and word.isalpha()}
    usual = piped(*typed)
    for place, environment in PLACES.items():
        seen = on_terminal(*typed, columns=100, **environment)
        if encoding := environment.get("PYTHONIOENCODING"):
            assert numbers(seen) == numbers(everywhere), place
            assert told <= set(re.findall(r"[A-Za-z]+", plain(seen))), place
            if command in ("explain", "markdown"):  # which have no frames
                lacking = usual.out.encode(encoding, "replace").decode("utf-8", "replace")
                seen, lacking = called(typed, **environment).out, lacking.replace("\ufffd", "?")
                assert seen.replace("\ufffd", "?") == lacking
        else:
            assert plain(seen) == everywhere, place
        if place in ("no colour", "dumb"):
            assert not re.search(r"\x1b\[[0-9;]*3[0-9]" if place == "no colour" else "\x1b", seen)
    assert "\x1b" not in usual.out + usual.err


def test_output_in_a_poor_environment_is_that_of_any_other(table: str) -> None:
    for typed in (words(command, table) for command in ("solve", "batch", "help")):
        assert process(*typed, LC_ALL="C") == piped(*typed)


def test_the_main_job_takes_one_screen() -> None:
    """A teacher's projector: the verdict and the prompt below the table in sight."""
    seen = plain(on_real_terminal(*PAPER, columns=80, rows=24))
    assert seen == plain(on_terminal(*PAPER, columns=80, rows=24))
    assert seen.count("\n") < 24
    assert max(map(len, seen.splitlines())) <= 80


def test_what_stands_out() -> None:
    assert "\x1b[1;33mOn the verge" in on_terminal(*PAPER, columns=90)
    assert "\x1b[1mOn the verge" in on_terminal(*PAPER, columns=90, NO_COLOR="1")
    for columns, width in ((30, 40), (200, 80)):
        seen = on_terminal(*PAPER, "--explain", columns=columns)
        assert "\x1b[1m1. The masses" in seen
        assert max(map(len, plain(seen).splitlines())) <= width


def test_lines_break_between_words_and_not_within_quantities() -> None:
    whole = "1 kg|9.81 m/s²|0.1 m|2 kg m²|3 N m|0.2 N|93.5 ns|4 ulp|7 g".split("|")
    words = "m1 = 1 kg, g = 9.81 m/s², R = 0.1 m, I = 2 kg m², torque 3 N m, 1.5 ± 0.2 N, 93.5 ns a scene, 4 ulp, 7 g"
    for width in range(12, 120):
        lines = wrapped(words, width)
        assert (" ".join(lines), max(map(len, lines)) <= width) == (words, True)
        assert all(any(quantity in line for line in lines) for quantity in whole), width
    assert wrapped("m1 = 1234567890 kg", 14) == ["m1 =", "1234567890 kg"]
    assert wrapped("m1 = 12345678901234567890 kg", 5) == ["m1 =", "12345678901234567890 kg"]
    assert wrapped("", 5) == wrapped("", 0) == []


# Nothing steers the terminal

HOSTILE = "\x1b[31mRED\x1b]0;owned\x07 \x9b2J\x9d \u202eesrever\u2066\u2069 \x08"
"""What would colour, name, clear or reverse a terminal: C0 and C1 controls, and overrides of the direction."""
STEERS = re.compile("[\0-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]")
RUNS = f'm1,m2,a,[/b] l {HOSTILE}\n1,3,3,x\n1,2,2.1,"{HOSTILE}\r2"\n1,4,4.4,[/b][link=http://a.b]z :smile:\n'
SCENES = f'm1,m2,l {HOSTILE}\n1,3,"{HOSTILE}\r2"\n1,x{HOSTILE},z\n'


@pytest.mark.parametrize(
    ("typed", "content"),
    [
        *((f"fit {{}}.csv{form}", RUNS) for form in ("", " --csv", " --json")),
        *((f"batch {{}}.csv --from {kind}", SCENES) for kind in ("csv", "tsv", "ndjson", "parquet")),
        ("batch {}.csv -o {}2.csv --force", SCENES),
        ("batch {}.csv", SCENES.replace(",l ", ",M ")),
        ("batch {}.ndjson", '{"m1": 1, "m2": 3, "\x9b2J": "\u202e\x9d"}\n'),
        ("batch {}.none", SCENES),
        ("fit {}.none", "m1"),
    ],
)
def test_nothing_of_a_file_does(tmp_path: Path, typed: str, content: str) -> None:
    file = f"{tmp_path}/\x1b[31m\x9b2J\u202e"
    words = [word.replace("{}", file) for word in typed.split()]
    Path(words[1]).write_text(content, newline="", encoding="utf-8")
    seen = plain(on_terminal(*words, columns=100, TERM="dumb"))
    assert seen.strip()
    assert not STEERS.findall(seen.replace("\r\n", "\n"))
    assert "Traceback" not in seen


TYPED = ["a" * 10**5, "1 kg" + "*st^9" * 20_000, "1" * 10**5, "1," * 20_000 + "x", "x " * 50_000, "-" * 10**5]
UNITS = ("9", " ", "(", "1/", "1(2)", "1,", "a_", "pi", '"', "kg*", "m1 in ")
TYPED += [text for unit in UNITS for text in (unit * 10_000, f"1{unit * 2500}x")]
TYPED += ["\x1b[31m\x1b]0;a\x07\x9b2J\u202e\nx"]
LINES = """
solve --m1 1 --m2 3 --M {}|solve --m1 1 --m2 3 --wrap {}|solve --m1 1 --m2 3 --I {}|solve --m1 1 --m2 3 --axle {}
solve --m1 1 --m2 3 --g {}|solve --m1 1 --m2 3 --expect {}|batch - --column {}|fit - --without {}|contact --m1 1 --m2 3 --M {}
sweep --m1 1 --m2 3 --M {}|sweep --m1 1 --m2 3 --M {}:2:3|sweep --m1 1 --m2 3 --M 1:2:{}|sweep --m1 1 --m2 3 --M 1:2:3:{}
sweep --m1 1 --m2 3 --M 1:2:3 --only {}|sweep --m1 1 --m2 3 --M 1:2:3 --figure {}|sweep --m1 1 --m2 3 --M 1:2:3 -o x/{}.csv
sweep --m1 1 --m2 3 --M 1:2:3 --digits {}|{}|solve {}|solve --m1 1 --m2 3 {}|solve --m1 1 --m2 3 --M 1 {}
solve --m1 1 --m2 3 --{}|solve --m1 1 --m2 3 --json={}|solve --m1 1 --m2 3 -{}=1|solve --m1 1 --m2 3 --M --mu={}
contact --m1 1 --m2 3 --figure x/{}.svg|batch {}|fit {}|batch - --from {}|batch - --only {}|batch in.csv -o x/{}
fit - --find {}|fit - --only {}|fit - --drop {}|tradeoff --family {}
"""


@pytest.mark.parametrize("typed", TYPED, ids=lambda typed: ascii(typed[:8]))
def test_nothing_typed_does_or_is_repeated_in_full(typed: str) -> None:
    """Nor does it break the line, or take long: an unknown unit of 100 kB took a minute, 2,000 blanks 16 s."""
    for line in (*LINES.strip().replace("\n", "|").split("|"), "solve" + " x" * 20_000):
        begun = process_time()
        ran = called([word.format(typed) for word in line.split()])
        assert process_time() - begun < 1, line
        assert (ran.status in (1, 2), ran.out, ran.err.count("\n")) == (True, "", 1), line
        assert ran.err.startswith("atwood: "), line
        assert len(ran.err) < 700, line
        assert not STEERS.findall(ran.err), line


def test_in_a_pipe_or_a_file_a_table_keeps_its_bytes(tmp_path: Path) -> None:
    (tmp_path / "in.csv").write_text(SCENES, newline="", encoding="utf-8")
    for encoding in ("utf-8", "ascii"):
        ran = called(["batch", str(tmp_path / "in.csv"), "--allow-errors"], PYTHONIOENCODING=encoding)
        assert ran.status == 0
        assert ran.out.count(HOSTILE) >= 2


# How it ends

OUTPUTS = ["json", "sweep", "batch", "help"]
"""Lines, rich's, bytes, typer's."""
FULL = "atwood: cannot write the output: No space left on device\n"
CLOSED = "atwood: cannot write the output: stdout is closed\n"


def buffered(names: Sequence[str], *at_once: str) -> pytest.MarkDecorator:
    """Each of the names, for which Python keeps what is printed until there is more; some hand it on at once."""
    both = [(name, "") for name in names] + [(name, "1") for name in at_once]
    return pytest.mark.parametrize(("typed", "unbuffered"), both)


@pytest.mark.parametrize("command", OUTPUTS)
def test_a_reader_that_leaves_is_no_error(command: str, table: str) -> None:
    for reader, lines in (("head -1", 2), *([("true", 1)] if command == "json" else ())):
        line = f"atwood {' '.join(words(command, table))} | {reader}; echo ${{PIPESTATUS[0]}}"
        ran = process(shell=line)
        assert (ran.status, ran.out.splitlines()[-1], len(ran.out.splitlines())) == (0, "0", lines)
        assert not re.search("Traceback|Broken", ran.err)


@buffered(OUTPUTS, "sweep")
def test_an_output_that_cannot_be_written_is_an_error(typed: str, unbuffered: str, table: str) -> None:
    line = " ".join(words(typed, table))
    for stdout, error in ((">&-", CLOSED), *([("> /dev/full", FULL)] if Path("/dev/full").exists() else ())):
        ran = process(shell=f"atwood {line} {stdout}", PYTHONUNBUFFERED=unbuffered)
        assert (ran.status, ran.out, ran.err) == (1, "", error)


def test_a_closed_stdout_is_none_where_nothing_goes_there(tmp_path: Path, table: str) -> None:
    for typed in (f"sweep {SCENE} --M 1:2:2 --mu 0.3 --csv", f"batch {table}"):
        ran = process(shell=f"atwood {typed} -o {tmp_path}/{typed[:5]}.csv >&-")
        assert (ran.status, "cannot" in ran.err) == (0, False)
        assert (tmp_path / f"{typed[:5]}.csv").read_text().count("\n") == 3


@DISK
@buffered(["json", "batch", "error"], "error")
def test_a_full_stderr_changes_neither_status_nor_output(typed: str, unbuffered: str, table: str) -> None:
    line, usual = " ".join(words(typed, table)), piped(*words(typed, table))
    for stderr in ("2> /dev/full", "2>&-"):
        ran = process(shell=f"atwood {line} {stderr}", PYTHONUNBUFFERED=unbuffered)
        assert (ran.status, ran.out, ran.err) == (usual.status, usual.out, "")
    both = process(shell=f"atwood {line} > /dev/full 2>&1", PYTHONUNBUFFERED=unbuffered)
    assert both.status == (usual.status or 1)


NOTED = ["solve {} --csv", "sweep {} --M 0:9:2 --csv --only F", "batch {table}"]


@buffered(NOTED, NOTED[0])
def test_notes_follow_their_results_into_one_pipe(typed: str, unbuffered: str, table: str) -> None:
    typed = typed.format(f"{SCENE} --M 10 --mu 0.3", table=table)
    ran = process(shell=f"atwood {typed} 2>&1", PYTHONUNBUFFERED=unbuffered)
    notes = [line.startswith("atwood: ") for line in ran.out.splitlines()]
    assert True in notes
    assert notes == sorted(notes)
