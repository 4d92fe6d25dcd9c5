"""Measure the trade of speed for accuracy, and write it into tradeoff.md with its picture.

From the top of the project: python -m examples.speed "two cores of a cloud machine (Xeon)"
"""

import re
import sys
from collections.abc import Sequence
from datetime import date
from io import StringIO
from pathlib import Path
from statistics import median

from rich.console import Console

from atwood_cli.cli.tradeoff import print_front
from atwood_cli.output.page import Page, watched
from atwood_cli.output.tradeoff_figure import save
from atwood_cli.tradeoff.measure import USUAL_ELEMENTS
from atwood_cli.tradeoff.outcome import Tradeoff, in_seconds, percent, scientific, short, tradeoff, with_best
from atwood_cli.tradeoff.scenes import FAMILIES

HERE = Path(__file__).parent
PAGE, PICTURE = HERE / "tradeoff.md", HERE / "tradeoff.svg"
PLACE = re.compile(r"(<!-- python -m examples.speed writes this -->\n).*(<!-- to here -->)", re.DOTALL)


RUNS = 5


def typical(runs: Sequence[Tradeoff]) -> Tradeoff:
    """Runs as one, each time the median of theirs; the errors are the same in all."""
    together = zip(*(run.measured for run in runs), strict=True)
    measured = [ones[0]._replace(seconds=median(one.seconds for one in ones)) for ones in together]
    marches = [
        ones[0]._replace(seconds=median(one.seconds for one in ones))
        for ones in zip(*(run.marches for run in runs), strict=True)
    ]
    return runs[0]._replace(measured=with_best(measured), marches=marches)


def screen(outcome: Tradeoff) -> str:
    """What `atwood tradeoff` shows on a terminal of 80 columns."""
    shown = StringIO()
    print_front(outcome, Page(Console(file=shown, width=80, force_terminal=True, color_system=None)))
    return "".join(f"{line.rstrip()}\n" for line in shown.getvalue().splitlines())


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
        f" {outcome.seed}; times are medians of {RUNS} runs.\n\n"
        f"```text\n$ atwood tradeoff\n{screen(outcome)}```\n\n"
        f"![Error against time]({PICTURE.name})\n\n{arithmetic(outcome)}\n{elements(outcome)}"
    )


def main(machine: str) -> None:
    page = PAGE.read_text(encoding="utf-8")
    if PLACE.search(page) is None:
        raise SystemExit(f"{PAGE.name} holds no place for what is measured")
    outcome = typical([tradeoff(list(FAMILIES), 500, 1, None, USUAL_ELEMENTS, watched) for _ in range(RUNS)])
    save(outcome, str(PICTURE), force=True)
    written = PLACE.sub(lambda match: match[1] + section(outcome, machine) + match[2], page)
    PAGE.write_text(written, encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1])
