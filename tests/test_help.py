"""Help and completion, as people, shells and Python ask for them."""

import re
import subprocess
import sys
from typing import Any

import pytest
import typer

from atwood_cli import Solution, cli, solve_arrays, solve_table
from atwood_cli.solver.quantities import NAMES, QUANTITIES, STANDARD
from atwood_cli.solver.scene import BODIES, INERTIA_FACTORS

from .tools.running import LOADED, TOP, process

GROUP: Any = cli.program()


def test_help_without_docstrings() -> None:
    """With `python -OO`, which has none, help was a traceback."""
    words = [sys.executable, "-OO", "-m", "atwood_cli", "solve", "-h"]
    optimized = subprocess.run(words, capture_output=True, text=True, check=True)
    assert optimized.stdout == process("solve", "-h").out
    assert process() == process("-h") == process("help")


@pytest.mark.parametrize("command", GROUP.commands)
def test_every_option_says_what_it_means_and_in_which_group(command: str) -> None:
    *params, the_help = GROUP.commands[command].get_params(typer.Context(GROUP.commands[command]))
    assert "--help" in the_help.opts
    assert all(param.help.endswith(".") for param in params)
    groups = "Scene Arc Measured Measurement Output Files".split()
    assert {param.rich_help_panel for param in params} <= {*groups}
    assert all(getattr(param, "is_flag", False) or param.metavar for param in params)


def test_help_fits_a_screen() -> None:
    """At 80 columns; a page has 60 lines at most. The pages are kept, one behind the other."""
    pages = (TOP / "examples" / "help.txt").read_text(encoding="utf-8").split("$ atwood ")[1:]
    assert len(pages) == len(cli.COMMANDS) + 1
    for page in pages:
        lines = page.splitlines()[1:]
        assert len(lines) <= 60 + 1
        assert max(map(len, lines)) <= 80
        assert "..." not in page.replace("[ARGS]...", "").replace("[NAME]...", "")  # no sentence is cut


@pytest.mark.parametrize("words", ["batch -h", "solve --only te", "sweep --only a"])
def test_help_and_completion_import_little(words: str) -> None:
    asked = {"COMP_WORDS": f"atwood {words}", "COMP_CWORD": "3", "_ATWOOD_COMPLETE": "complete_bash"}
    ran = process(*words.split(), code=LOADED, **({} if "-h" in words else asked))
    assert ran.out
    assert "atwood_cli.cli" in ran.err
    assert not {"rich", "numpy", "polars"} & set(ran.err.split())


# Completion


OFFERED = {
    "s": "solve sweep",
    "solve --mu": "--mu --mu-k",
    "solve --m1 1 --m1 2 --cs": "--csv",
    "solve --only ten": "tension_1 tension_2 tension_difference tension_ratio",
    "solve --only fall": "fall_time",
    "sweep --only ": " ".join(NAMES),
    "batch in.csv --only reg": "regime",
    "contact --figure a": "",
    "solve --g ": " ".join(BODIES),
    "contact --inertia ": " ".join(INERTIA_FACTORS),
    "batch ": "",
    "fit ": "",
    "fit runs.csv --find ": "rim_mass axle gravity delay",
    "fit runs.csv --only mo": "moment_of_inertia",
}
COMPLETING = """
import os, sys
from atwood_cli.cli import run
shell, *lines = sys.argv[1:]
for words in lines:
    typed, last = f"atwood {words}", words.split(" ")[-1]
    os.environ |= {"COMP_WORDS": typed, "COMP_CWORD": str(len(words.split(" "))), "_TYPER_COMPLETE_ARGS": typed}
    os.environ |= {"_TYPER_COMPLETE_WORD_TO_COMPLETE": last, "_TYPER_COMPLETE_FISH_ACTION": "get-args"}
    sys.argv = ["atwood"]
    run()
    print("")
"""


def completed(shell: str, *lines: str) -> list[str]:
    """What the program offers for the last word of each line, by the protocol of the shell; all in one process."""
    ran = process(shell, *lines, code=COMPLETING, _ATWOOD_COMPLETE=f"complete_{shell}")
    assert (ran.status, ran.err) == (0, "")
    return [" ".join(offered.split()) for offered in ran.out.split("\n\n")[: len(lines)]]


def test_every_shell_gets_names_with_what_they_mean() -> None:
    """With fish, by the status, where files are to be completed."""
    assert completed("bash", *OFFERED) == [*OFFERED.values()]
    meaning = "torque of the string on the pulley"
    for shell, offered in {
        "fish": f"torque {meaning}",
        "zsh": f"""_arguments '*: :(("torque":"{meaning}"))'""",
        "powershell": f"torque:::{meaning}",
    }.items():
        assert completed(shell, "solve --only tor") == [offered]
    for words, status in (("solve --only tor", 0), ("batch in", 1)):
        asked = {"_TYPER_COMPLETE_ARGS": f"atwood {words}", "_TYPER_COMPLETE_FISH_ACTION": "is-args"}
        assert process(**asked, _ATWOOD_COMPLETE="complete_fish") == (status, "", "")


# Python's help


@pytest.mark.parametrize("function", [solve_arrays, solve_table])
def test_a_docstring_names_the_usual_quantities(function: Any) -> None:
    assert f"if None, {', '.join(STANDARD[:-1])} and {STANDARD[-1]}." in " ".join(function.__doc__.split())


def test_every_quantity_is_described() -> None:
    for name, about in QUANTITIES.items():
        line = rf"\n    {name} +{re.escape(about.meaning)}.*{re.escape(about.unit)}.*{re.escape(about.equation)}\n"
        assert re.search(line, str(Solution.__doc__)), name
