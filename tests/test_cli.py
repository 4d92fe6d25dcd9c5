"""The command line as scripts and people meet it: in process where that suffices, else as a process."""

import json
import os
import re
import subprocess
import sys
from errno import EINVAL
from html import escape
from pathlib import Path
from shutil import copytree
from types import SimpleNamespace
from typing import Any
from unittest.mock import Mock
from zipapp import create_archive

import pytest

from atwood_cli import cli, solve
from atwood_cli.__main__ import main
from atwood_cli.reading.names import SPELLED, read_names
from atwood_cli.solver.quantities import QUANTITIES

from .tools.running import LOADED, PAPER, TOP, Atwood, called, process
from .tools.scenes import inputs

# The table

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
    assert json.loads(json.dumps(solution.to_dict(), allow_nan=False)) == {**shown, "version": 3}
    assert list(solution.to_dict()) == list(shown)
    assert solution._repr_html_() == f"<pre>{escape(str(solution))}</pre>"


def test_a_printed_solution_fits_the_terminal_and_has_no_colours(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "60")
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True, raising=False)
    shown = str(solve(m1=1, m2=3, M="10(1)"))
    assert max(map(len, shown.splitlines())) <= 60
    assert "\x1b" not in shown


# --only


def test_every_symbol_names_its_quantity() -> None:
    for name, about in QUANTITIES.items():
        plain = "".join(SPELLED.get(sign, sign) for sign in about.symbol)
        ways = [about.symbol, plain, *(plain.replace(" ", blank) for blank in ("_", "")), name]
        assert {*read_names("only", [*ways, name.replace("_", "-")], QUANTITIES)} == {name}


# How it begins and ends


def test_version_and_help(atwood: Atwood) -> None:
    assert re.fullmatch(r"atwood \d+\.\d+\.\d+(rc\d+)?\n", atwood("--version").out)
    assert atwood("-V") == atwood("--version")
    assert atwood("help", "sweep") == atwood("sweep", "-h") == atwood("sweep", "--help")
    assert atwood("help", "slove").status == 2


NEEDED = "cli.options cli.solve output.files output.forms output.page output.scene_page output.text"


@pytest.mark.parametrize(
    "words", ["--json", "--csv", "--only acceleration", "", "contact --csv", "sweep --M 1:2:2 --csv"]
)
def test_only_what_is_needed_is_imported(words: str) -> None:
    solves = words[:1] in ("-", "")
    ran = process(*(["solve"] if solves else []), *words.split(), *PAPER[1:], code=LOADED)
    modules = {*ran.err.split()}
    assert ran.out
    assert not {"numpy", "matplotlib", *(["rich"] if words else [])} & modules
    if solves:
        ours = {name for name in modules if name.startswith(("atwood_cli.cli.", "atwood_cli.output."))}
        assert ours == {f"atwood_cli.{name}" for name in NEEDED.split()}
        assert ("rich" in modules) == (words == "")


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
    monkeypatch.setattr("atwood_cli.cli.run", Mock(side_effect=ImportError("numpy failed to import")))
    monkeypatch.setattr("signal.signal", lambda *_: None)  # this process goes on
    with pytest.raises(ImportError):
        main()


def test_python_dash_m_and_the_command_are_one() -> None:
    command = Path(sys.executable).with_name("atwood")
    if not command.exists():
        pytest.skip("not installed")
    ran = subprocess.run([str(command), *PAPER, "--json"], capture_output=True, text=True, check=True)
    assert ran.stdout == process(*PAPER, "--json").out


# As a program


def test_a_lack_of_memory_is_a_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("atwood_cli.cli.solve.read_answers", Mock(side_effect=MemoryError))
    assert called(PAPER) == (1, "", "atwood: there is not enough memory\n")


def test_a_pipe_that_is_closed_on_windows_ends_a_run_quietly(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("atwood_cli.cli.solve.read_answers", Mock(side_effect=OSError(EINVAL, "Invalid")))
    monkeypatch.setattr("atwood_cli.cli.drop", Mock())
    assert called(PAPER).status == 1
    monkeypatch.setattr(cli, "os", SimpleNamespace(name="nt", environ=os.environ))
    assert cli.run(PAPER) == 0


NUMPY = """
try:
    import numpy._compiled
except ImportError:
    import os
    os.listdir(os.path.dirname(__file__))
"""
"""A package with a compiled part that a zip file cannot give, which it looks for as NumPy does."""


def test_a_zipapp_keeps_the_status_and_says_that_numpy_cannot_be_in_it(tmp_path: Path) -> None:
    """It said that NumPy's folder could not be written."""
    copytree(TOP / "atwood_cli", tmp_path / "app" / "atwood_cli")
    (tmp_path / "app" / "numpy").mkdir()
    (tmp_path / "app" / "numpy" / "__init__.py").write_text(NUMPY)
    create_archive(tmp_path / "app", tmp_path / "atwood.pyz", main="atwood_cli.__main__:main")
    fit = ["fit", str(TOP / "examples" / "rit.csv")]
    for words, status in (([*PAPER, "--explain"], 0), ([*PAPER, "--mu"], 2), (fit, 1)):
        command = [sys.executable, str(tmp_path / "atwood.pyz"), *words]
        ran = subprocess.run(command, capture_output=True, check=False)
        assert (ran.returncode, bool(ran.stdout)) == (status, not status)
    assert ran.stderr.startswith(b"atwood: No module named 'numpy._compiled'")
    assert ran.stderr.endswith(b": what is compiled cannot be imported from a zip file\n")


ENDING = """
import atexit, gc, sys
from atwood_cli.__main__ import main
frozen = gc.get_freeze_count()
atexit.register(lambda: print("at exit", gc.isenabled(), gc.get_freeze_count() > frozen))
sys.stdout.write("before ")
main()
"""
LIBRARY = """
import gc
frozen = gc.get_freeze_count()
from atwood_cli import cli, solve
solve(m1=1, m2=3)
cli.run(["--version"])
print(gc.isenabled(), gc.get_freeze_count() > frozen)
"""


def test_what_is_left_to_do_at_exit_is_done_and_a_library_is_left_alone() -> None:
    """main freezes what the garbage collector would look through; handlers run and streams are flushed."""
    for words, status, out in (("--only regime", 0, "verge\n"), ("--zzz", 2, "")):
        ran = process(*PAPER, *words.split(), code=ENDING)
        assert (ran.status, ran.out) == (status, f"before {out}at exit True True\n")
    assert process(code=LIBRARY).out.endswith("\nTrue False\n")
