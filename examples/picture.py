"""Draw the table of the README: python examples/picture.py, from the top of the project."""

import io
from pathlib import Path

from rich.console import Console

from atwood_cli import Scene
from atwood_cli.cli.solve import print_table
from atwood_cli.solver.answers import Answers


def picture() -> str:
    """The main job's output as SVG."""
    console = Console(record=True, width=88, file=io.StringIO(), force_terminal=True, highlight=False)
    print_table(Answers(Scene.read({"m1": "1", "m2": "3", "mu": "0.3"})), console=console)
    return console.export_svg(title="atwood solve --m1 1 --m2 3 --mu 0.3", unique_id="atwood")


if __name__ == "__main__":
    (Path(__file__).parent / "solve.svg").write_text(picture(), encoding="utf-8")
