"""The outputs that are kept in files, and what prints each: python -m tests.regenerate brings them up to date."""

import re
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import NamedTuple

from .running import labels, process

TOP = Path(__file__).parent.parent
EXAMPLES = TOP / "examples"
PAGES = [TOP / "README.md", *sorted(EXAMPLES.glob("*.md"))]
SCRIPTS = sorted(EXAMPLES.glob("*.sh"))
ENGINES = [EXAMPLES / f"{name}.py" for name in ("dask_blocks", "dask_tables", "polars_lazy")]
SCENE = "--m1 1 --m2 3 --M 10 --mu 0.3"

PICTURES = {
    "contact.svg": f"contact {SCENE}",
    "tensions.svg": "sweep --m1 1 --m2 3 --mu 0.3 --M 0:60:4 --only T1,T2",
}


class Kept(NamedTuple):
    """A text that is a part of a file or all of it, and what it is today."""

    file: Path
    text: str
    today: Callable[[], str]


def printed(line: str) -> str:
    """What a line of bash prints at the top of the project, without an error."""
    ran = process(shell=f"set -eu; cd '{TOP}'; {line}", PYTHONIOENCODING="utf-8")
    assert (ran.status, ran.err) == (0, ""), ran
    return ran.out


def transcript(block: str) -> str:
    """The block as running its commands gives it, stderr where a terminal would show it."""
    commands = re.findall(r"^\$ (.*)", block, re.MULTILINE)
    return "".join(f"$ {command}\n{printed(f'{{ {command}; }} 2>&1 || true')}" for command in commands)


def whole(file: Path, line: str) -> Kept:
    return Kept(file, file.read_text(encoding="utf-8") if file.exists() else "", partial(printed, line))


KEPT = [
    *(
        Kept(page, block, partial(transcript, block))
        for page in PAGES
        for block in re.findall(r"```console\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
    ),
    # The scripts call `atwood` and `python3`; both are this interpreter here.
    *(
        whole(script.with_suffix(".txt"), f'python3() {{ "$PYTHON" "$@"; }}; . "{script}"')
        for script in SCRIPTS
    ),
    *(whole(engine.with_suffix(".txt"), f'"$PYTHON" "{engine}"') for engine in ENGINES),
    whole(EXAMPLES / "help.txt", '"$PYTHON" -m examples.help'),
    whole(EXAMPLES / "handout.md", f"atwood solve {SCENE} --explain --markdown"),
    *(
        whole(
            EXAMPLES / name,
            f'cd $(mktemp -d); atwood {words} --figure {name} > table; cat {name}; rm -r "$PWD"',
        )
        for name, words in PICTURES.items()
    ),
]


def essence(text: str) -> object:
    """What must stay the same: of a picture its words, as each version of a library draws its own lines."""
    return (labels(text), re.findall(r"<text[^>]*>([^<]*)</text>", text)) if "<svg" in text else text


if __name__ == "__main__":
    for file, text, today in KEPT:
        if essence(fresh := today()) != essence(text):
            page = file.read_text(encoding="utf-8") if file.exists() else ""
            file.write_text(page.replace(text, fresh, 1), encoding="utf-8", newline="\n")
            print(file.relative_to(TOP))
