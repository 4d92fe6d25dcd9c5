"""What a new quantity, reason, symbol or unit needs, by the map of the code: whatever lacks is named."""

import re
from collections.abc import Iterator
from pathlib import Path

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
from .tools.scenes import KINDS, inputs, table

OF_MOTION = (
    *("FINDS_ANOTHER", "NEEDS_MOTION", "NEEDS_SPEED", "NEEDS_FALL", "AT_REST", "SLOWS_DOWN"),
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
