"""A sweep as a table with its regimes, as JSON and as CSV."""

import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import nullcontext
from fractions import Fraction
from itertools import groupby

from ..explain.conditions import Condition
from ..explain.given import VERSION, scene_record
from ..explain.messages import on_units, typed_units, unmarked
from ..explain.tally import EXPECTED, Tally
from ..numbers.digits import SHOWN_DIGITS, to_digits, to_double
from ..output.page import Page, progress
from ..output.text import aligned, cell
from ..solver.answers import Answers
from ..solver.quantities import FROM_MOTION, LIMITS_OF_ONE_MASS, STANDARD
from ..solver.scene import Scene, with_unit
from .changes import changes, say_regimes
from .ranges import LOCKED, Row, Sweep, solve_rows


class SweepPage:
    """A sweep as a page, JSON and CSV. Rows of JSON and CSV are written as they come."""

    def __init__(
        self, sweep: Sweep, names: Sequence[str], digits: int | None, conditions: Sequence[Condition] = ()
    ) -> None:
        self.sweep, self.digits, self.conditions = sweep, digits, conditions
        self.tally = Tally(names, conditions)
        """The counts of the rows that are solved and, as JSON or CSV, written."""
        self.names = names or usual_quantities(sweep.scene)
        # If a sentence says the regimes, they have a column only if it is asked for.
        self.columns = [name for name in self.names if names or len(sweep.ranges) > 1 or name != "regime"]
        self.assumed: list[str] = []
        greatest = sweep.scene
        for range_ in sweep.ranges:
            greatest = range_.at(range_.ends[1], greatest)
        self.remarks = [*map(unmarked, on_units(Answers(greatest, None, sweep.fixed).to_six_digits))]

    def _rows(self, names: Sequence[str], digits: int | None, watch: bool = True) -> Iterator[Row]:
        """Yield the rows, and count them."""
        rows = solve_rows(self.sweep, names, digits, self.conditions)
        with progress(rows, self.sweep.total, rows=lambda row: 1) if watch else nullcontext(rows) as rows:
            for row in rows:
                self.assumed = [ASSUMED] if row.mu_assumed else self.assumed
                yield row
                had = [name for name in self.tally.missing if cell(row.values[name])]
                self.tally.count(1, had, dict.fromkeys(row.reasons.items(), 1))
                if row.failures:
                    self.tally.count_failures(f"at {self.sweep.in_words(row.at)}", row.failures)

    def notes(self) -> list[str]:
        """Say why values are missing, after all rows."""
        return [*self.remarks, *self.tally.reasons_of(self.names)]

    def _all_notes(self) -> Iterator[str]:
        """Say what is assumed and why values are missing: an iterator that begins after all rows."""
        yield from [*self.assumed, *self.notes()]

    def json(self) -> Mapping[str, object]:
        ranges = {range_.name: range_.typed for range_ in self.sweep.ranges}
        rounding = to_double if self.digits is None else to_digits(self.digits)
        return {
            "version": VERSION,
            "scene": scene_record(self.sweep.scene, round_=rounding) | ranges,
            "rows": self.records(),
            "notes": self._all_notes(),
        }

    def records(self) -> Iterator[dict[str, object]]:
        # Without the bar, into which rows on a terminal would run.
        for row in self._rows(self.names, self.digits, watch=not sys.stdout.isatty()):
            points = {range_.name: range_.printed(row.at[range_.name]) for range_ in self.sweep.ranges}
            judged = {EXPECTED: not row.failures} if self.conditions else {}
            yield points | {name: row.values[name] for name in self.names} | judged

    def print(self, page: Page, table: bool = True) -> None:
        """Print the scene, its regimes, values that all rows share, and the notes.

        With ``table``, a table has a row for each point. Columns without a value are left out.
        """
        # Limits are in the unit of the mass or the wrap, if that is unusual.
        units = typed_units(Answers(self.sweep.scene, None, self.sweep.fixed)) | dict(self.sweep.units)
        self.sweep = sweep = self.sweep._replace(units=units)
        names, lacks = list(self.columns), bool(sweep.scene.lacking)
        if sweep.scene.M is None and sweep.scene.mu is not None and PULLEY not in names and not lacks:
            names.append(PULLEY)
        rows = list(self._rows(names, self.digits or SHOWN_DIGITS))
        unit_of = Answers(sweep.scene, units=units).unit_of
        cells = {name: [cell(row.values[name]) for row in rows] for name in names}
        shown = {name: column for name, column in cells.items() if any(column)}
        same = {name: column[0] for name, column in shown.items() if len(set(column)) == 1}
        above = [", ".join(sweep.inputs.values()), *self.assumed]
        above += [] if lacks else _regimes(sweep, rows, self.digits)
        if PULLEY not in same and any(row.regime == "verge" for row in rows):
            above.append(PULLEYS)
        numbers = [name for name in same if name != "regime"]
        if shared := [f"{name} = {with_unit(same[name], unit_of(name))}" for name in numbers]:
            above.append(f"In all rows: {', '.join(shared)}.")
        page.say(*above)
        if table and (len(same) < len(shown) or not shown):
            columns = {}
            for range_ in sweep.ranges:
                points = [range_.cell(row.at[range_.name]) for row in rows]
                named = any(point.name for point in range_.points)
                columns[_head(range_.label, range_.unit.in_words)] = points if named else aligned(points)
            for name in [name for name in shown if name not in same]:
                columns[_head(name, "" if name == "regime" else unit_of(name))] = aligned(shown[name])
            lines = zip(*columns.values(), strict=True)
            # Groups are the points of the range that varies slowly, or the regimes along a single range.
            slow = sweep.ranges[0].name
            groups = groupby(rows, lambda row: row.at[slow] if len(sweep.ranges) > 1 else row.regime)
            parts = [[next(lines) for _ in group] for _, group in groups]
            page.table(list(columns), parts, keys=len(sweep.ranges))
        page.say(*self.remarks, *self.tally.reasons_of([*self.tally.asked, *shown]))


def usual_quantities(scene: Scene) -> Sequence[str]:
    """Return the quantities of a sweep unless others are named: the usual ones, and those of a fall."""
    if scene.lacking:
        return ["capstan_ratio", *(LIMITS_OF_ONE_MASS if len(scene.lacking) == 1 else ())]
    return [name for name in Answers(scene).names if name in (*STANDARD, *FROM_MOTION["fall"][:3])]


PULLEY = "critical_pulley_mass"
MOST_SENTENCES = 6
"""The most points of a second range for each of which a sentence says the regimes."""
ASSUMED = "Without mu, no slip is assumed."
PULLEYS = "M is not given, so each row on the verge has its own critical pulley mass."


def _regimes(sweep: Sweep, rows: Sequence[Row], digits: int | None) -> Iterator[str]:
    """Say the regimes along one range, for each point of the other range, if these are few."""
    along, sentences = sweep.along, dict[str, str]()
    if sweep.total <= MOST_SENTENCES * len(along.points):
        for scene, place in sweep.scenes(sweep.others):
            here = [row for row in rows if place.items() <= row.at.items() and row.at[along.name] != LOCKED]
            known = {Fraction(row.at[along.name].value): row.regime for row in here}
            sentences[sweep.in_words(place)] = say_regimes(
                along, list(changes(scene, along, digits, known)), scene
            )
        if len({*sentences.values()}) == 1:
            sentences = {"Regimes": next(iter(sentences.values()))}
        yield from (f"{where}: {words}." for where, words in sentences.items())
    elif len({row.regime for row in rows}) == 1:
        yield f"Regime of all rows: {rows[0].regime}."


def _head(name: str, unit: str) -> str:
    return f"{name}\n({unit})" if unit else f"{name}\n"
