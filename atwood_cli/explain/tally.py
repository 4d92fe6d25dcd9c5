"""What is said of many scenes after the last: why values are missing, and which conditions fail."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from ..numbers.text import counted
from .messages import reasons_in


@dataclass
class Tally:
    """Counts of scenes, the rows of a table or of a sweep, fed by their results."""

    asked: Sequence[str] = ()
    """The quantities that the user names."""
    had: set[str] = field(default_factory=set)
    """The quantities of which a row has a value."""
    rows: int = 0
    reasons: Counter[tuple[str, str]] = field(default_factory=Counter)
    """In how many rows a value is missing, or only assumed, by quantity and reason."""
    first_failures: dict[str, str] = field(default_factory=dict)
    """By each condition that fails, the first row that fails it, and why."""
    failed: Counter[str] = field(default_factory=Counter)

    def count(self, rows: int, had: Iterable[str], reasons: Mapping[tuple[str, str], int]) -> None:
        """Count the next rows."""
        self.rows += rows
        self.had.update(had)
        self.reasons.update(reasons)

    def count_failures(self, row: str, failures: Mapping[str, str]) -> None:
        """Count a row by the conditions that fail in it, each with what holds instead."""
        for condition, why in failures.items():
            self.first_failures.setdefault(condition, f"{row}: {why}")
        self.failed.update(failures.keys())

    @property
    def missing(self) -> list[str]:
        """Return the quantities that the user names and no row has."""
        return [name for name in self.asked if name not in self.had]

    def reasons_of(self, names: Iterable[str]) -> list[str]:
        """Say why values of some quantities are missing."""
        return reasons_in({key: rows for key, rows in self.reasons.items() if key[0] in {*names}}, self.rows)

    def failures(self) -> list[str]:
        """Say which conditions fail."""
        total = counted(self.rows, "row")
        return [f"{why}; {self.failed[x]} of {total} failed" for x, why in self.first_failures.items()]
