"""The outputs that are kept in files, and what prints each: python -m tests.regenerate brings them up to date."""

import re
import shlex
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout
from functools import partial
from io import BytesIO, TextIOWrapper
from pathlib import Path
from typing import NamedTuple
from unittest.mock import patch

from atwood_cli import cli
from atwood_cli.cli import COMMANDS

from .running import labels, process

TOP = Path(__file__).parent.parent
EXAMPLES = TOP / "examples"
PAGES = [TOP / "README.md", *sorted(EXAMPLES.glob("*.md"))]
SCRIPTS = sorted(EXAMPLES.glob("*.sh"))
ENGINES = [EXAMPLES / f"{name}.py" for name in ("dask_tables", "polars_lazy")]
CASES = Path(__file__).parent / "batch.txt"
ESCAPES = {rb"\n": b"\n", rb"\r": b"\r", rb"\t": b"\t", b"\\\\": b"\\", b"%%": b"%"}
"""What stands for bytes in the words of printf, besides \\xHH."""
UNSEEN = "[\0-\x09\x0b-\x1f\x7f\xa0\u2009\u2028\ufeff]"
SCENE = "--m1 1 --m2 3 --M 10 --mu 0.3"

HELP = 'echo "$ atwood${of:+ $of} -h"; atwood $of -h; echo'
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


def answered(block: str) -> str:
    """The block as its command gives it, which runs here: stdout, stderr, and the status if it is not 0."""
    line = block.splitlines()[0]
    found = re.fullmatch(r"\$ printf '(.*)' \| atwood (.*)", line)
    assert found, line

    def byte(escaped: re.Match[bytes]) -> bytes:
        return bytes([int(escaped[1], 16)]) if escaped[1] else ESCAPES[escaped[0]]

    content = re.sub(rb"\\x(..)|\\.|%%", byte, found[1].encode())
    out, err = (TextIOWrapper(BytesIO(), "utf-8", newline="") for _ in range(2))
    with patch("sys.stdin", TextIOWrapper(BytesIO(content))), redirect_stdout(out), redirect_stderr(err):
        status = cli.run(shlex.split(found[2]))
    printed = "".join(stream.detach().getvalue().decode() for stream in (out, err))
    shown = re.sub(UNSEEN, lambda one: "".join(f"\\x{unit:02x}" for unit in one[0].encode()), printed)
    return f"{line}\n{shown}{f'[{status}]' if status else ''}\n".replace("\n\n", "\n")


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
    whole(EXAMPLES / "help.txt", f"for of in '' {' '.join(COMMANDS)}; do {HELP}; done"),
    *(
        Kept(CASES, block, partial(answered, block))
        for block in re.findall(
            r"^\$ .*\n(?:(?![$#] |\n).*\n)*", CASES.read_text(encoding="utf-8"), re.MULTILINE
        )
    ),
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
