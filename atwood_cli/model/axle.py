"""The friction of an axle, exact, as it is given: a force at the rim, or a torque."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple


class Axle(NamedTuple):
    """A force at the rim (N), or a torque (N m): kept as it was given, as the radius may be uncertain."""

    number: Any
    unit: Literal["N", "N m"] = "N"

    def force(self, R: Any) -> Any:
        """The friction as a force at the rim (N) of a pulley of radius R (m)."""
        return self.number / R if self.unit == "N m" else self.number
