"""What is said of many scenes after the last: why values are missing, and which conditions fail."""

from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from ..numbers.text import counted
from .conditions import Condition
from .messages import reasons_in

EXPECTED = "expected"  # the column that says whether a row meets all conditions
MOST_ROWS_NAMED = 10


@dataclass
class Tally:
    """Counts of scenes, the rows of a table or of a sweep, fed by their results."""

    asked: Sequence[str] = ()
    """The quantities that the user names."""
    expected: Sequence[Condition] = ()
    had: set[str] = field(default_factory=set)
    """The quantities of which a row has a value."""
    rows: int = 0
    reasons: Counter[tuple[str, str]] = field(default_factory=Counter)
    """In how many rows a value is missing, or only assumed, by quantity and reason."""
    first_failures: dict[str, str] = field(default_factory=dict)
    """By each condition that fails, the first row that fails it, and why."""
    failures: dict[str, list[str]] = field(default_factory=lambda: defaultdict(list))
    """By each condition that fails, the names of all rows that fail it."""

    def count(self, rows: int, had: Iterable[str], reasons: Mapping[tuple[str, str], int]) -> None:
        """Count the next rows."""
        self.rows += rows
        self.had.update(had)
        self.reasons.update(reasons)

    def count_failures(self, row: str, failures: Mapping[str, str]) -> None:
        """Count a row by the conditions that fail in it, each with what holds instead."""
        for condition, why in failures.items():
            self.first_failures.setdefault(condition, f"{row}: {why}")
            self.failures[condition].append(row)

    @property
    def missing(self) -> list[str]:
        """Return the quantities that the user names and no row has. What is expected of others is judged."""
        known = self.had | {condition.name for condition in self.expected}
        return [name for name in self.asked if name not in known]

    def reasons_of(self, names: Iterable[str]) -> list[str]:
        """Say why values of some quantities are missing."""
        return reasons_in({key: rows for key, rows in self.reasons.items() if key[0] in {*names}}, self.rows)

    def failures_said(self) -> list[str]:
        """Say which conditions fail, and in which rows."""
        sentences = []
        for condition, rows in self.failures.items():
            named, more = ", ".join(rows[:MOST_ROWS_NAMED]), len(rows) - MOST_ROWS_NAMED
            which = f": {named}{f' and {more} more' if more > 0 else ''}" if len(rows) > 1 else ""
            failed = f"{len(rows)} of {counted(self.rows, 'row')} failed{which}"
            sentences.append(f"{self.first_failures[condition]}; {failed}")
        return sentences
