"""Running the command line, as a process, in a shell, on a terminal, and reading what it shows."""

import os
import re
import shlex
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import combinations
from typing import Any, NamedTuple

import pytest

PIP = f"{shlex.quote(sys.executable)} -m pip"
HANGS = 600  # seconds: nothing takes so long on any machine
PAPER = ["solve", "--m1", "1", "--m2", "3", "--mu", "0.3"]


QUICK = """
import sys
from atwood_cli.__main__ import main
from atwood_cli.output import page
page.monotonic = lambda: 0
sys.exit(main())
"""
"""The program as if no second went by: on a slow machine it would show bars."""


class Ran(NamedTuple):
    """What a run printed and how it ended."""

    status: int
    out: str
    err: str


Atwood = Callable[..., Ran]


def process(*arguments: str, shell: str = "", stdin: Any = None, **environment: str) -> Ran:
    """Run it as a process; with ``shell``, a bash line in which `atwood` is the command."""
    env = {k: v for k, v in os.environ.items() if k not in ("COLUMNS", "FORCE_COLOR", "NO_COLOR")}
    env |= {"PYTHON": sys.executable, **environment}
    words = [sys.executable, "-m", "atwood_cli", *arguments]
    if shell:
        words = ["bash", "-c", f'atwood() {{ "$PYTHON" -m atwood_cli "$@"; }}; {shell}']
    done = subprocess.run(words, stdin=stdin, capture_output=True, env=env, check=False, timeout=HANGS)
    return Ran(
        done.returncode, done.stdout.decode("utf-8", "replace"), done.stderr.decode("utf-8", "replace")
    )


def on_terminal(*arguments: str, columns: int, rows: int = 60, **environment: str) -> str:
    """What a terminal of that size gets to see."""
    pty, fcntl = pytest.importorskip("pty"), pytest.importorskip("fcntl")
    import struct
    import termios

    leader, follower = pty.openpty()
    fcntl.ioctl(follower, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))
    env = {k: v for k, v in os.environ.items() if k not in ("COLUMNS", "LINES", "NO_COLOR")}
    env |= {"TERM": "xterm-256color", **environment}
    command = [sys.executable, "-c", QUICK, *arguments]
    child = subprocess.Popen(command, stdin=follower, stdout=follower, stderr=follower, env=env)
    os.close(follower)
    seen = b""
    while True:
        try:
            piece = os.read(leader, 65536)
        except OSError:
            break
        if not piece:
            break
        seen += piece
    child.wait(HANGS)
    os.close(leader)
    return seen.decode("utf-8").replace("\r\n", "\n")


def plain(seen: str) -> str:
    """What a terminal got to see, without its colours."""
    return re.sub(r"\x1b\[[0-9;]*m", "", seen)


def labels(svg: str) -> list[str]:
    """The texts of a figure, which matplotlib writes beside their outlines."""
    return re.findall(r"<!-- (.*?) -->", svg, re.DOTALL)


@contextmanager
def pages_seen(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[Any]]:
    """The pictures that would be saved meanwhile, as matplotlib has them."""
    figure = pytest.importorskip("matplotlib.figure")
    pages: list[Any] = []
    with monkeypatch.context() as patching:
        patching.setattr(figure.Figure, "savefig", lambda page, *_, **__: pages.append(page))
        yield pages


def misplaced(page: Any) -> list[str]:
    """What nobody could read on a page: words over words, or beyond its edge."""
    from matplotlib.text import Text

    boxes: list[tuple[str, Any]] = []
    draw = Text.draw

    def drawing(text: Any, renderer: Any) -> None:
        draw(text, renderer)
        if text.get_visible() and text.get_text().strip():
            boxes.append((text.get_text(), Text.get_window_extent(text, renderer)))

    Text.draw = drawing  # type: ignore
    try:
        page.draw(page.canvas.get_renderer())
    finally:
        Text.draw = draw  # type: ignore
    edge = page.bbox.padded(1)
    beyond = [text for text, box in boxes if not (edge.contains(*box.min) and edge.contains(*box.max))]
    over = [f"{one} | {other}" for (one, box), (other, at) in combinations(boxes, 2) if box.overlaps(at)]
    return [*beyond, *over]
