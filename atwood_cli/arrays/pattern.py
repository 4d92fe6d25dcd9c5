"""What rows have in common, and selections of rows."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..model.scene import INPUTS, Axle, Scene
from ..model.units import Angle

Column = NDArray[np.float64]
Index = slice | NDArray[np.intp]
"""A selection of rows, in ascending order."""

COLUMN = "column"
"""The entry of a pattern for an input that each row has for itself."""


class Pattern(NamedTuple):
    """What rows have in common before any question: which mass is heavier (`Decisions.sign`), and each input.

    An input is None (not given), inf, a Fraction that is the same in all rows, or COLUMN.
    """

    sign: int
    inputs: tuple[Fraction | float | str | None, ...]

    def scene(self, column: Callable[[str], Any]) -> Scene:
        """Return the scene of a row, or of all rows; ``column`` gives the number of an input by its name."""
        fields: dict[str, Any] = {
            name: column(name) if value == COLUMN else value
            for name, value in zip(INPUTS, self.inputs, strict=True)
        }
        fields["wrap"] = Angle(fields["wrap"])
        fields["axle"] = None if fields["axle"] is None else Axle(fields["axle"])
        return Scene(**fields)


Branches = frozenset[tuple[str, bool]]
"""Questions, each with the answer of a group's rows."""


class Task(NamedTuple):
    """Quantities to compute at a level of precision, for rows with one pattern and the same decisions."""

    pattern: Pattern
    branches: Branches
    names: tuple[str, ...]
    level: int


def size_of(index: Index) -> int:
    """Return the number of rows of a selection."""
    return index.stop - index.start if isinstance(index, slice) else index.size


def select(index: Any, places: Any) -> Any:
    """Return the rows at places of a selection, which are a slice, an array or the number of one place."""
    if not isinstance(index, slice):
        return index[places]
    if isinstance(places, slice):
        return slice(index.start + places.start, min(index.start + places.stop, index.stop))
    return places + index.start if index.start else places
