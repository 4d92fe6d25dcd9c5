"""The map's table of what a change touches: in a copy, what it names is enough for the change to be seen."""

import re
from pathlib import Path
from shutil import copytree

import pytest

from .running import TOP, process

MAP = (TOP / "atwood_cli" / "README.md").read_text(encoding="utf-8")
# fmt: off
CHANGES = [
    ("add a quantity", "model/quantities.py", "    # Of a scene whose motion was",
     '    "trial": About("limits", "Q", "kg", "", "both masses"),\n'),
    ("add a quantity", "model/machine.py", "    @property\n    def gravity(",
     "    @property\n    def trial(self) -> N:\n        return self.ar.number(self.case.light) + self.case.heavy\n\n"),
    ("add a quantity", "api.py", "    pulley_mass: T |", "    trial: T | None\n"),
    ("take a unit", "model/units.py", '"kg": "1", ', '"stater": "7", '),
    ("add a form", "output/text.py", '    "csv": Form(',
     '    "lines": Form(".lines", "Print lines.", lambda forms: print(len(forms.json())), True),\n'),
]
"""By the words of the row: in which file, before what, which line is added."""
# fmt: on
SEEN = """
from atwood_cli import Solution, cli, solve, solve_arrays
print("both masses" in Solution.__doc__)
print(solve(m1="1stater", m2=3).trial, *solve_arrays(1, [2, 3], quantities=["trial"])["trial"])
for words in ("solve --only Q", "sweep --M 1:2:2 --only trial --csv", "solve --only trial --lines"):
    cli.run([*words.split(), "--m1", "1stater", "--m2", "3"])
"""


def test_what_the_map_names_is_enough(tmp_path: Path) -> None:
    pytest.importorskip("numpy")
    package = copytree(TOP / "atwood_cli", tmp_path / "atwood_cli")
    for change, name, before, line in CHANGES:
        (row,) = re.findall(rf"^\| {change}.*", MAP, re.MULTILINE)
        text = (package / name).read_text(encoding="utf-8")
        assert (f"`{name}`" in row, text.count(before)) == (True, 1), (name, before)
        (package / name).write_text(text.replace(before, line + before), encoding="utf-8")
    ran = process(code=SEEN, PYTHONPATH=str(tmp_path), PYTHONSAFEPATH="1")
    assert (ran.out, ran.err) == ("True\n10.0 3.0 4.0\n10\nM,trial\n1,10\n2,10\n1\n", "")
