"""Measure the trade of speed for accuracy, and put it into README with its picture.

From the top of the project: python -m examples.speed "two cores of a cloud machine (Xeon)"
"""

import re
import sys
from datetime import date
from pathlib import Path

from atwood_cli.cli.figure import save_tradeoff
from atwood_cli.cli.page import watched
from atwood_cli.tradeoff.measure import Tradeoff, in_seconds, percent, scientific, short, tradeoff
from atwood_cli.tradeoff.scenes import FAMILIES

TOP = Path(__file__).parent.parent
README, PICTURE = TOP / "README.md", TOP / "examples" / "tradeoff.svg"
PLACE = re.compile(r"(<!-- python -m examples.speed writes this -->\n).*(<!-- to here -->)", re.DOTALL)


def table(heads: list[str], rows: list[list[str]]) -> str:
    lines = [heads, ["---"] * len(heads), *rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def arithmetic(found: Tradeoff) -> str:
    """A row a setting: its time for an ordinary scene, and for each family the worst error."""
    rows = []
    for setting in dict.fromkeys(one.setting for one in found.measured):
        by_family = {one.family: one for one in found.measured if one.setting == setting}
        ordinary = by_family["ordinary"]
        row = [setting, f"{in_seconds(ordinary.seconds)} ± {percent(ordinary.spread)}"]
        for one in by_family.values():
            wrong = f" ({percent(one.share_wrong_regime)} wrong)" if one.share_wrong_regime else ""
            row.append(f"{'**' * one.best}{short(one.worst_ulp)}{'**' * one.best}{wrong}")
        rows.append(row)
    return table(["setting", "time of an ordinary scene", *FAMILIES], rows)


def elements(found: Tradeoff) -> str:
    """A row a number of elements: error, order and time, plain and extrapolated."""
    rows: dict[str, list[str]] = {}
    for one in found.marches:
        order = "" if one.order is None else f"{one.order:.2f}"
        error = f"{'**' * one.best}{scientific(one.relative_error)}{'**' * one.best}"
        rows.setdefault(str(one.elements or "closed form"), []).extend(
            [error, order, in_seconds(one.seconds)]
        )
    filled = [[count, *row, *[""] * (6 - len(row))] for count, row in rows.items()]
    return table(["elements", "error", "order", "time", "extrapolated", "order", "time"], filled)


def section(found: Tradeoff, machine: str) -> str:
    return (
        f"Measured on {date.today():%d %B %Y}, on {machine}; {found.scenes} scenes of each family, seed"
        f" {found.seed}.\n\n{arithmetic(found)}\n![Error against time](examples/{PICTURE.name})\n\n"
        f"{elements(found)}\n{found.advice}\n"
    )


def main(machine: str) -> None:
    found = tradeoff(list(FAMILIES), 500, 1, None, watched)
    readme = README.read_text(encoding="utf-8")
    written = PLACE.sub(lambda match: match[1] + section(found, machine) + match[2], readme)
    if PLACE.search(readme) is None:
        raise SystemExit("README.md holds no place for what is measured")
    save_tradeoff(found, str(PICTURE), force=True)
    README.write_text(written, encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1])
