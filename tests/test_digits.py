"""Every digit right: scenes of all families and regimes against the oracle.

With `pytest --every-digit`, as .ci/run has it, that is 10,000 scenes, each to doubles and to five numbers of
digits. Otherwise it is every fourth of them to doubles, 6 and 40 digits, and every 32nd to the others.
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
SLICES = 4


@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.parametrize("part", range(SLICES))
def test_every_digit(family: str, part: int, pytestconfig: pytest.Config) -> None:
    every, all_digits_every = (1, 1) if pytestconfig.getoption("every_digit") else (4, 8)
    wrong = []
    regimes: Counter[str] = Counter()
    tried = list(scenes(family, 2000))[part :: SLICES * every]
    for number, given in enumerate(tried):
        scene = Scene.read(given)
        expected = oracle.expected(scene)
        regimes[expected["regime"]] += 1
        for digits in DIGITS if number % all_digits_every == 0 else USUAL:
            # What solve() gives attribute by attribute, less the bounds of the friction force:
            # they have no closed form to compare with here, and test_contact checks them.
            answers = Answers(scene, digits)
            assert answers["regime"] == expected["regime"], given
            for name in NAMES:
                got, want = answers[name], expected[name]
                rounded = oracle.shown(want, digits)
                if got != rounded:
                    wrong.append((given, digits, name, got, rounded))
                if digits is not None and got and not isinf(got):
                    assert len(got.as_tuple().digits) == digits
    assert not wrong, f"{len(wrong)} wrong, such as {wrong[0]}"
    assert regimes.total() == 500 // every
    # Each family reaches slip and no-slip in every slice, so that none is tested by name only.
    assert regimes["slip"] > 10
    assert regimes["no-slip"] > 10
