"""Help and completion, as people and shells ask for them."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import typer

from atwood_cli import cli
from atwood_cli.files import FORMATS
from atwood_cli.model.quantities import ACCURACIES, NAMES
from atwood_cli.model.scene import BODIES, INERTIA_FACTORS
from atwood_cli.tradeoff.scenes import FAMILIES
from examples.help import pages

from .running import on_terminal, process

TOP = Path(__file__).parent.parent
GROUP: Any = cli.program()
PAGES = ["-h", *(f"{command} -h" for command in cli.COMMANDS)]
ATWOOD = Path(sys.executable).with_name("atwood")


def test_the_help_kept_is_todays() -> None:
    """With `python -OO`, too, which has no docstrings: help was a traceback."""
    kept = (TOP / "examples" / "help.txt").read_bytes()
    assert pages().encode() == kept, "python -m examples.help > examples/help.txt"
    optimized = [sys.executable, "-OO", "-m", "examples.help"]
    assert subprocess.run(optimized, stdout=subprocess.PIPE, cwd=TOP, check=True).stdout == kept
    assert process() == process("-h") == process("help")


@pytest.mark.parametrize("command", GROUP.commands)
def test_every_option_says_what_it_means_and_in_which_group(command: str) -> None:
    *params, the_help = GROUP.commands[command].get_params(typer.Context(GROUP.commands[command]))
    assert "--help" in the_help.opts
    assert all(param.help.endswith(".") for param in params)
    assert {param.rich_help_panel for param in params} <= {
        "Scene",
        "Arc",
        "String elements",
        "Measured",
        "Measurement",
        "Output",
        "Files",
    }
    assert all(getattr(param, "is_flag", False) or param.metavar for param in params)


@pytest.mark.parametrize("columns", [10, 24, 40, 80, 200])
@pytest.mark.parametrize("words", PAGES)
def test_no_width_loses_a_word_of_help(words: str, columns: int) -> None:
    out, whole = (process(*words.split(), COLUMNS=str(width)).out for width in (columns, 100))
    assert sorted(out.replace("\\\n", "\n").split()) == sorted(whole.split())
    assert columns < 40 or max(map(len, out.splitlines())) <= min(columns - 1, 100)


@pytest.mark.parametrize("words", PAGES)
def test_help_is_bold_on_a_terminal_and_says_the_same(words: str) -> None:
    seen, plain = on_terminal(*words.split(), columns=70), process(*words.split(), COLUMNS="70").out
    assert "\x1b[1mExamples:\x1b[0m" in seen
    assert re.sub(r"\x1b\[[01]m", "", seen) == plain
    assert on_terminal(*words.split(), columns=70, TERM="dumb") == plain


def test_a_long_example_is_continued_as_a_shell_takes_it() -> None:
    out = process("solve", "-h", COLUMNS="40").out
    assert "  atwood solve --m1 1 --m2 3 --mu 0.3\n" in out
    assert "  atwood solve --m1 250g --m2 300g \\\n    --M 100g --R 5cm --all\n" in out


@pytest.mark.parametrize("words", ["batch -h", "solve --only te", "sweep --only a"])
def test_help_and_completion_import_little(words: str) -> None:
    code = (
        "import sys, atexit; from atwood_cli.cli import run;"
        " atexit.register(lambda: print(*sys.modules, file=sys.stderr)); run()"
    )
    asked = {"COMP_WORDS": f"atwood {words}", "COMP_CWORD": "3", "_ATWOOD_COMPLETE": "complete_bash"}
    ran = process(*words.split(), code=code, **({} if "-h" in words else asked))
    assert ran.out
    assert "atwood_cli.cli" in ran.err
    assert not {"rich", "numpy", "polars"} & set(ran.err.split())


# Completion


def completed(*words: str, shell: str = "bash") -> list[str]:
    """What the program offers for the last of the words, by the protocol of the shell."""
    typed = ("\n" if "2 lb" in "".join(words) else " ").join(["atwood", *words])
    asked = {
        "COMP_WORDS": typed,
        "COMP_CWORD": str(len(words)),
        "_TYPER_COMPLETE_ARGS": typed,
        "_TYPER_COMPLETE_WORD_TO_COMPLETE": words[-1],
        "_TYPER_COMPLETE_FISH_ACTION": "get-args",
    }
    ran = process(**asked, _ATWOOD_COMPLETE=f"complete_{shell}")
    assert (ran.status, ran.err) == (0, "")
    return [line for line in ran.out.splitlines() if line]


@pytest.mark.parametrize(
    ("words", "offered"),
    [
        ("s", ["solve", "sweep"]),
        ("solve --mu", ["--mu", "--mu-k"]),
        ("solve --m1 1 --m1 2 --cs", ["--csv"]),
        ("solve --only ten", ["tension_1", "tension_2", "tension_ratio"]),
        ("solve --only fall", ["fall_time"]),
        ("sweep --only ", list(NAMES)),
        ("batch in.csv --only reg", ["regime"]),
        ("sweep --plot --figure a", []),
        ("contact --figure a", []),
        ("solve --g ", list(BODIES)),
        ("contact --inertia ", list(INERTIA_FACTORS)),
        ("solve --M ", ["inf"]),
        ("contact --profile ", ["creep", "least"]),
        ("batch in.csv --accuracy ", list(ACCURACIES)),
        ("batch in.csv --from ", list(FORMATS)),
        ("batch in.csv --to p", ["parquet"]),
        ("batch ", []),
        ("fit ", []),
        ("fit runs.csv --find ", ["rim_mass", "axle", "gravity"]),
        ("fit runs.csv --only mo", ["moment_of_inertia"]),
        ("tradeoff --family ", list(FAMILIES)),
    ],
)
def test_completion(words: str, offered: list[str]) -> None:
    assert completed(*words.split(" ")) == offered


@pytest.mark.parametrize(
    ("words", "shell", "offered"),
    [
        ("solve --only=ten", "fish", ["--only=tension_1", "--only=tension_2", "--only=tension_ratio"]),
        ("solve --only=ten", "bash", ["--only=tension_1", "--only=tension_2", "--only=tension_ratio"]),
        ("solve --only = ten", "bash", ["tension_1", "tension_2", "tension_ratio"]),
        ("solve --m1=1 --g=mo", "fish", ["--g=moon"]),
        ("sweep --only =", "bash", list(NAMES)),
        ("solve --m1 = 1 --only = ten", "bash", ["tension_1", "tension_2", "tension_ratio"]),
        ("solve --m1=", "bash", []),
        ("solve --g=moon --inertia ", "fish", list(INERTIA_FACTORS)),
        ("solve\n--m1\n'2 lb'\n--g\n=\nmo", "bash", ["moon"]),
    ],
)
def test_values_behind_an_equals_sign_are_completed(words: str, shell: str, offered: list[str]) -> None:
    """As one word, or as three where bash breaks words at the sign."""
    found = completed(*words.split("\n" if "\n" in words else " "), shell=shell)
    assert [line.split("\t")[0] for line in found] == offered


def test_every_shell_gets_names_with_what_they_mean() -> None:
    words = ("solve", "--only", "tor")
    assert completed(*words) == ["torque"]
    assert completed(*words, shell="fish") == ["torque\ttorque of the string on the pulley"]
    assert completed(*words, shell="zsh") == [
        '_arguments \'*: :(("torque":"torque of the string on the pulley"))\''
    ]
    assert completed(*words, shell="powershell") == ["torque:::torque of the string on the pulley"]


@pytest.mark.parametrize(("words", "status"), [("solve --only tor", 0), ("batch in", 1)])
def test_fish_is_told_where_files_are_to_be_completed(words: str, status: int) -> None:
    asked = {"_TYPER_COMPLETE_ARGS": f"atwood {words}", "_TYPER_COMPLETE_FISH_ACTION": "is-args"}
    assert process(**asked, _ATWOOD_COMPLETE="complete_fish") == (status, "", "")


@pytest.mark.parametrize(
    "asked", [{}, {"COMP_WORDS": "atwood"}, {"COMP_WORDS": "atwood s", "COMP_CWORD": "s"}]
)
def test_completion_without_the_words_of_the_shell_is_an_error(asked: dict[str, str]) -> None:
    ran = process("solve", **asked, _ATWOOD_COMPLETE="complete_bash")
    assert (ran.status, ran.out) == (2, "")
    assert ran.err == (
        "atwood: _ATWOOD_COMPLETE is set, by which a shell asks for words,"
        " but not COMP_WORDS and COMP_CWORD; unset it\n"
    )


def in_shell(shell: str, script: str, **environment: str) -> str:
    """Run a script in a shell that has the program on its path."""
    if not (ATWOOD.exists() and shutil.which(shell)):
        pytest.skip(f"needs {shell} and the installed program")
    env = os.environ | {"PATH": f"{ATWOOD.parent}{os.pathsep}{os.environ['PATH']}"} | environment
    done = subprocess.run([shell, "-c", script], capture_output=True, text=True, check=True, env=env)
    assert done.stderr == ""
    return done.stdout


STARTS = {"bash": ".bashrc", "zsh": ".zshrc"}


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_installing_completion_writes_nothing_else(tmp_path: Path, shell: str) -> None:
    """typer added the start of zsh's completion and a style of menus to .zshrc."""
    home = {"HOME": str(tmp_path), "ZDOTDIR": "", "XDG_CONFIG_HOME": "", "SHELL": f"/usr/bin/{shell}"}
    start = tmp_path / STARTS.get(shell, ".profile")
    start.write_text("alias ll='ls -l'")
    first, again = process("--install-completion", **home), process("--install-completion", shell, **home)
    assert first == again
    assert (first.status, first.err) == (0, "")
    (file,) = (path for path in tmp_path.rglob("*") if path.is_file() and path != start)
    assert f"Completion for {shell} is in {file}" in first.out
    line = f"\nsource {file}\n" if shell in STARTS else ""
    assert start.read_text() == f"alias ll='ls -l'{line}"
    assert file.read_text() == process("--show-completion", shell, **home).out
    assert "_ATWOOD_COMPLETE=complete_" in file.read_text()
    assert "zstyle" not in file.read_text()


@pytest.mark.parametrize("option", ["show", "install"])
@pytest.mark.parametrize(
    ("shell", "why"),
    [("bahs", "did you mean bash?"), ("tcsh", "there are bash, zsh, fish, powershell, pwsh")],
)
def test_other_shells_are_refused(option: str, shell: str, why: str) -> None:
    ran = process(f"--{option}-completion", shell)
    assert (ran.status, ran.out) == (2, "")
    assert ran.err == f"atwood: --{option}-completion '{shell}' is no shell with completion; {why}\n"


def test_powershell_has_its_script_and_keeps_its_tab_key() -> None:
    shown = process("--show-completion", "pwsh").out
    assert shown.startswith("$scriptblock = {")
    assert "PSReadLine" not in shown
    ran = process("--install-completion", "pwsh")
    assert (ran.status, ran.out) == (2, "")
    assert ran.err.endswith("; run there: atwood --show-completion pwsh >> $PROFILE\n")


def test_bash_completes() -> None:
    script = """
    eval "$(_ATWOOD_COMPLETE=source_bash atwood)"
    COMP_WORDS=(atwood solve --only ten) COMP_CWORD=3
    _atwood_completion atwood
    echo "${COMPREPLY[@]}"
    complete -p atwood
    """
    shown = in_shell("bash", script)
    assert shown == "tension_1 tension_2 tension_ratio\ncomplete -o default -F _atwood_completion atwood\n"


def test_bash_completes_behind_an_equals_sign() -> None:
    script = """
    eval "$(_ATWOOD_COMPLETE=source_bash atwood)"
    COMP_WORDS=(atwood solve --only = acc) COMP_CWORD=4
    _atwood_completion atwood
    echo "${COMPREPLY[@]}"
    """
    assert in_shell("bash", script) == "acceleration\n"


def test_fish_completes(tmp_path: Path) -> None:
    (tmp_path / "scenes.csv").touch()
    script = f"""
    _ATWOOD_COMPLETE=source_fish atwood | source
    cd {tmp_path}
    complete -C "atwood solve --only ten"
    complete -C "atwood batch sc"
    """
    shown = in_shell("fish", script, HOME=str(tmp_path))
    names, file = shown.splitlines()[:3], shown.splitlines()[3:]
    assert [line.split("\t")[0] for line in names] == ["tension_1", "tension_2", "tension_ratio"]
    assert file == ["scenes.csv"]


def test_zsh_takes_what_it_is_offered(tmp_path: Path) -> None:
    """Its completion needs a terminal; what it evaluates there is recorded here."""
    script = """
    compdef() { }
    _arguments() { print -r -- "$@" }
    _files() { print files }
    eval "$(_ATWOOD_COMPLETE=source_zsh atwood)"
    words=(atwood solve --only ten) CURRENT=4; _atwood_completion
    words=(atwood solve --g) CURRENT=3; _atwood_completion
    words=(atwood batch sc) CURRENT=3; _atwood_completion
    """
    shown = in_shell("zsh", script, HOME=str(tmp_path))
    lines = shown.splitlines()
    assert "tension_1" in lines[0]
    assert "--g" in shown
    assert lines[-1] == "files"
