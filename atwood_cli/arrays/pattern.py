"""What rows have in common, and selections of rows."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..model.angle import Angle
from ..model.scene import INPUTS, Axle, Scene

Column = NDArray[np.float64]
Index = slice | NDArray[np.intp]
"""A selection of rows, in ascending order."""

COLUMN = "column"


class Pattern(NamedTuple):
    """What rows have in common before any question: which mass is heavier (`Case.sign`), and each input.

    An input is None (not given), inf, a Fraction that is the same in all rows, or COLUMN.
    """

    sign: int
    inputs: tuple[Fraction | float | str | None, ...]

    def scene(self, column: Callable[[str], Any]) -> Scene:
        """The scene of a row, or of all of them; ``column`` gives the number of an input that is a column."""
        fields: dict[str, Any] = {
            name: column(name) if value == COLUMN else value
            for name, value in zip(INPUTS, self.inputs, strict=True)
        }
        fields["wrap"] = Angle(fields["wrap"])
        fields["axle"] = None if fields["axle"] is None else Axle(fields["axle"])
        return Scene(**fields)


Decisions = frozenset[tuple[str, bool]]
"""Questions, and what the rows of a group have answered."""


class Task(NamedTuple):
    """Quantities to compute, at a level of precision, for the rows of one pattern and the same decisions."""

    pattern: Pattern
    decisions: Decisions
    names: tuple[str, ...]
    level: int


def size_of(index: Index) -> int:
    """The number of rows of a selection."""
    return index.stop - index.start if isinstance(index, slice) else index.size


def select(index: Any, some: Any) -> Any:
    """The rows at some places of a selection, or the row at one place: two selections made one."""
    if not isinstance(index, slice):
        return index[some]
    if isinstance(some, slice):
        return slice(index.start + some.start, min(index.start + some.stop, index.stop))
    return some + index.start if index.start else some
