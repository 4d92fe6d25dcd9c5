"""Measure the trade of speed for accuracy, and write it into tradeoff.md with its picture.

From the top of the project: python -m examples.speed "two cores of a cloud machine (Xeon)"
"""

import re
import sys
from datetime import date
from pathlib import Path

from atwood_cli.cli.page import watched
from atwood_cli.cli.tradeoff_figure import save
from atwood_cli.tradeoff.measure import Tradeoff, in_seconds, percent, scientific, short, tradeoff
from atwood_cli.tradeoff.scenes import FAMILIES

HERE = Path(__file__).parent
PAGE, PICTURE = HERE / "tradeoff.md", HERE / "tradeoff.svg"
PLACE = re.compile(r"(<!-- python -m examples.speed writes this -->\n).*(<!-- to here -->)", re.DOTALL)


def table(heads: list[str], rows: list[list[str]]) -> str:
    lines = [heads, ["---"] * len(heads), *rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def arithmetic(outcome: Tradeoff) -> str:
    """A row a setting: its time a scene and the worst error, for each family."""
    rows = []
    for setting in dict.fromkeys(one.setting for one in outcome.measured):
        row = [setting]
        for one in outcome.measured:
            if one.setting == setting:
                wrong = f" ({percent(one.share_wrong_regime)} wrong)" if one.share_wrong_regime else ""
                mark = "**" * one.best
                row.append(f"{in_seconds(one.seconds)}: {mark}{short(one.worst_ulp)}{mark}{wrong}")
        rows.append(row)
    return table(["setting", *FAMILIES], rows)


def elements(outcome: Tradeoff) -> str:
    """A row a number of elements: error, order and time, plain and extrapolated."""
    rows: dict[str, list[str]] = {}
    for one in outcome.marches:
        order = "" if one.order is None else f"{one.order:.2f}"
        error = f"{'**' * one.best}{scientific(one.relative_error)}{'**' * one.best}"
        rows.setdefault(str(one.elements or "closed form"), []).extend(
            [error, order, in_seconds(one.seconds)]
        )
    filled = [[count, *row, *[""] * (6 - len(row))] for count, row in rows.items()]
    return table(["elements", "error", "order", "time", "extrapolated", "order", "time"], filled)


def section(outcome: Tradeoff, machine: str) -> str:
    return (
        f"Measured on {date.today():%d %B %Y}, on {machine}; {outcome.scenes} scenes of each family, seed"
        f" {outcome.seed}.\n\n{arithmetic(outcome)}\n![Error against time]({PICTURE.name})\n\n"
        f"{elements(outcome)}\n{outcome.advice}\n"
    )


def main(machine: str) -> None:
    page = PAGE.read_text(encoding="utf-8")
    if PLACE.search(page) is None:
        raise SystemExit(f"{PAGE.name} holds no place for what is measured")
    outcome = tradeoff(list(FAMILIES), 500, 1, None, watched)
    save(outcome, str(PICTURE), force=True)
    written = PLACE.sub(lambda match: match[1] + section(outcome, machine) + match[2], page)
    PAGE.write_text(written, encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1])
