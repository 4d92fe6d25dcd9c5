"""The map's table of what a change touches: in a copy, what it names is enough for the change to be seen."""

import os
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from shutil import copytree, ignore_patterns
from subprocess import run

import pytest

from atwood_cli import Solution
from atwood_cli.output.typeset import IN_LATEX
from atwood_cli.reading.scenes import read_answers
from atwood_cli.reading.units import UNITS, dimension_of
from atwood_cli.solver import quantities
from atwood_cli.solver.machine import Machine
from atwood_cli.solver.quantities import QUANTITIES

from .test_inputs import BY_DEFINITION
from .test_sentences import REASONS
from .tools import oracle
from .tools.running import TOP, process
from .tools.scenes import KINDS, inputs, table

MAP = (TOP / "atwood_cli" / "README.md").read_text(encoding="utf-8")
# fmt: off
CHANGES = [
    ("add a quantity", "oracle.py", '    out["regime"] = regime\n', '    out["trial"] = l + h\n'),
    ("add a quantity", "oracle.py", '\n""".split()', " trial"),
    ("add a quantity", "test_contract", "pulley_mass moment_of_inertia gravity m1", "trial "),
    ("take a unit", "test_inputs", "kg 1 g 0.001 mg", "stater 7 "),
    ("take a unit", "examples/hoist.md", "kg, g, mg, ug", "stater, "),
    ("add a quantity", "solver/quantities.py", "    # Of a scene whose motion was",
     '    "trial": About("limits", "Q", "kg", "", "both masses"),\n'),
    ("add a quantity", "solver/machine.py", "    @property\n    def moment_of_inertia(",
     "    @property\n    def trial(self) -> N:\n        return self.ar.number(self.decided.light) + self.decided.heavy\n\n"),
    ("add a quantity", "api.py", "    pulley_mass: T |", "    trial: T | None\n"),
    ("take a unit", "reading/units.py", '"kg": "1", ', '"stater": "7", '),
    ("add an input", "solver/scene.py", '}\n"""The inputs of a scene, which columns',
     '    "brake": Parameter("friction of a brake", "f_brake", "brake", "N", may_be_zero=True, dimension="force"),\n'),
    ("add an input", "solver/scene.py", "    motion: Motion = Motion()\n    terms: ", "    brake: Fraction | None = None\n"),
    ("add an input", "solver/decisions.py", "        return ZERO if self.scene.axle is None else self.scene.axle\n",
     "        if self.scene.brake is not None:\n            return self.scene.brake + (self.scene.axle or ZERO)\n"),
    ("add an input", "api.py", "    a: Given | None\n", "    brake: Given | None\n"),
    ("add an input", "arrays/__init__.py", '    accuracy: Accuracy = "certified",\n    quantities: ', "    brake: Numbers | None = None,\n"),
    ("add an input", "arrays/__init__.py", ", drop, time, speed)\n    return solve_and_count(dict(zip(COLUMNS", ", brake"),
    ("add an input", "arrays/inputs.py", ')\n"""The meanings of the codes in', '    "brake",\n'),
    ("add an input", "test_contract", '"\nFITTED = ', " brake"),
    ("add an input", "test_contract", " a? drop? time? speed? find?", " brake?"),
    ("add an input", "test_contract", " accuracy='certified' quantities?", " brake?"),
    ("add an input", "test_contract", '""",\n    ),\n    "commands"', " brake"),
    ("add an input", "oracle.py", "    rests = 0 < (h - l) * g <= f",
     "    f += rational(scene.brake) if scene.brake else 0\n"),
    ("add a form", "output/forms.py", '    "csv": Form(',
     '    "lines": Form(".lines", "Print lines.", lambda forms: print(len(forms.json())), True),\n'),
]
"""By the words of the row: in which file, before what, which line is added."""
# fmt: on
SEEN = """
from atwood_cli import Solution, cli, solve, solve_arrays
print("both masses" in Solution.__doc__)
print(solve(m1="1stater", m2=3).trial, *solve_arrays(1, [2, 3], quantities=["trial"])["trial"])
print(solve(1, 3, M=2, brake="1N").acceleration == solve(1, 3, M=2, axle=1).acceleration)
print(*solve_arrays(1, 3, M=2, brake=[1, -1])["acceleration"], *solve_arrays(1, 3, brake=-1)["status"].flat)
for words in ("solve --M 2 --axle .5 --brake .5N --only a", "solve --only Q", "sweep --M 1:2:2 --only trial --csv", "solve --only trial --lines"):
    cli.run([*words.split(), "--m1", "1stater", "--m2", "3"])
"""


@pytest.fixture
def changed(tmp_path: Path) -> Path:
    """A copy of the project with all these changes."""
    ignored = ignore_patterns(".git", "*venv*", ".*cache", "__pycache__")
    copied = copytree(TOP, tmp_path / "copy", ignore=ignored)
    for change, name, before, line in CHANGES:
        (row,) = re.findall(rf"^\| {change}.*", MAP, re.MULTILINE)
        file = name if "." in name else f"{name}.py"
        (path,) = (path for path in copied.rglob(Path(file).name) if path.as_posix().endswith(f"/{file}"))
        text = path.read_text(encoding="utf-8")
        assert (f"`{name}`" in row, text.count(before)) == (True, 1), (name, before)
        path.write_text(text.replace(before, line + before), encoding="utf-8")
    return copied


def test_the_suite_passes_with_what_the_map_names(changed: Path, pytestconfig: pytest.Config) -> None:
    if not pytestconfig.getoption("every_digit"):
        pytest.skip("a suite in the suite: --every-digit")
    for words in ("tests.tools.regenerate --accept", "pytest --quick --ignore tests/test_map.py"):
        command, env = [sys.executable, "-m", *words.split()], {**os.environ, "PYTHONPATH": str(changed)}
        ran = run(command, cwd=changed, env=env, capture_output=True, text=True)
        assert ran.returncode == 0, ran.stdout[-2000:]


def test_what_the_map_names_is_enough(changed: Path) -> None:
    ran = process(code=SEEN, PYTHONPATH=str(changed), PYTHONSAFEPATH="1")
    seen = "True\n10.0 3.0 4.0\nTrue\n3.72266 nan 24\n-3.4751454545454545\n10\nM,trial\n1,10\n2,10\n1\n"
    assert (ran.out, ran.err) == (seen, "")


OF_MOTION = (
    *("FINDS_ANOTHER", "NEEDS_MOTION", "NEEDS_FALL", "AT_REST", "SLOWS_DOWN"),
    *("WOULD_SLIP", "ANY_DRIVEN", "EITHER_WAY", "NEEDS_MASSES"),
)
"""How reasons of quantities begin that a measurement gives: no scene lacks them."""


def lacking() -> Iterator[str]:
    """What quantities, reasons, symbols and units lack, in sentences: in which file what is to be added."""
    scenes = [read_answers(inputs(words), None).decided.scene for _, words in table(KINDS)]
    judged = {x for scene in scenes for x, value in oracle.expected(scene).items() if value is not None}
    for name, about in QUANTITIES.items():
        if name not in judged and name not in oracle.BOUNDS:
            yield f"`expected` in tests/tools/oracle.py has no value of {name!r} in any scene of KINDS in scenes.py."
        if not hasattr(Machine, name):
            yield f"`Machine` in atwood_cli/solver/machine.py has no property {name!r}."
        if name not in Solution.__dataclass_fields__:
            yield f"`Solution` in atwood_cli/api.py has no field {name!r}."
        if about.unit and not dimension_of(about.unit):
            yield f"UNITS in atwood_cli/reading/units.py has no {about.unit!r}, which --expect could read."
        for sign in about.letters:
            if not sign.isascii() and ord(sign) not in IN_LATEX:
                yield f"SIGNS in atwood_cli/output/typeset.py has no LaTeX of {sign!r}."
    source = Path(quantities.__file__).read_text(encoding="utf-8")
    reasons = source.partition("# Why")[2].partition("# Names")[0]
    for name in re.findall(r"^([A-Z_]+) = ", reasons, re.MULTILINE):
        reason = getattr(quantities, name)
        if not name.startswith(OF_MOTION) and reason not in REASONS:
            yield f"REASONS in tests/test_sentences.py has no {name}."
    for dimension, units in UNITS.items():
        for unit in units:
            if unit.replace(" ", "_") not in BY_DEFINITION[dimension].split():
                yield f"BY_DEFINITION in tests/test_inputs.py has no {unit!r}."


def test_nothing_lacks_what_a_change_needs() -> None:
    """The first word on a change, in full: without it, 185 tests failed with a KeyError."""
    if lacks := [*lacking()]:
        pytest.fail("\n".join(lacks), pytrace=False)
