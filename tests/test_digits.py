"""Every digit right: 10,000 scenes of all families and regimes against the oracle.

Every scene is solved to doubles, 6 and 40 digits, every eighth at the other precisions too; with
`pytest --every-digit` (as .ci/run has it) every scene at every precision.
"""

from collections import Counter
from math import isinf

import pytest

from atwood_cli.model.scene import Scene
from atwood_cli.solver.answers import Answers

from . import oracle
from .scenes import FAMILIES, scenes

NAMES = [name for name in oracle.NAMES[1:] if name not in ("friction_force_min", "friction_force_max")]
DIGITS = (None, 1, 6, 17, 40, 200)
USUAL = (None, 6, 40)
SLICES = 8


@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.parametrize("part", range(SLICES))
def test_every_digit(family: str, part: int, pytestconfig: pytest.Config) -> None:
    every = 1 if pytestconfig.getoption("every_digit") else 8
    wrong = []
    regimes: Counter[str] = Counter()
    for number, given in enumerate(scenes(family, 2000)):
        if number % SLICES != part:
            continue
        scene = Scene.read(given)
        expected = oracle.expected(scene)
        regimes[expected["regime"]] += 1
        for digits in DIGITS if number // SLICES % every == 0 else USUAL:
            # What solve() gives attribute by attribute, less the bounds of the friction force:
            # they have no closed form to compare with here, and test_contact checks them.
            answers = Answers(scene, digits)
            assert answers["regime"] == expected["regime"], given
            for name in NAMES:
                got, want = answers[name], expected[name]
                if (got is None) != (want is None):
                    wrong.append((given, digits, name, got, want))
                elif got is not None:
                    rounded = oracle.correctly_rounded(want, digits)
                    if got != rounded:
                        wrong.append((given, digits, name, got, rounded))
                    if digits is not None and got and not isinf(got):
                        assert len(got.as_tuple().digits) == digits
    assert not wrong, f"{len(wrong)} wrong, such as {wrong[0]}"
    assert regimes.total() == 2000 // SLICES
    # Each family reaches slip and no-slip in every slice, so that none is tested by name only.
    assert regimes["slip"] > 10
    assert regimes["no-slip"] > 10
