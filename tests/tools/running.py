"""Running the command line, as a process, in a shell, on a terminal, and reading what it shows."""

import os
import re
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import chdir, contextmanager, redirect_stderr, redirect_stdout
from io import BytesIO, TextIOWrapper
from itertools import combinations
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple
from unittest.mock import patch
from xml.etree.ElementTree import fromstring

import pytest

from atwood_cli import cli

HANGS = 600  # seconds: nothing takes so long on any machine
TOP = Path(__file__).parent.parent.parent
FROM = "atwood-cli"
"""What pip is given to install the extras of the program that is installed."""
PAPER = ["solve", "--m1", "1", "--m2", "3", "--mu", "0.3"]


class Ran(NamedTuple):
    """What a run printed and how it ended."""

    status: int
    out: str
    err: str


Atwood = Callable[..., Ran]
Batch = Callable[..., Ran]


HOW_TO_PRINT = ("COLUMNS", "LINES", "FORCE_COLOR", "NO_COLOR")
"""What tells a program in its environment how to print."""


def around(asked: Mapping[str, str]) -> dict[str, str]:
    """The environment of a run, in which nothing tells how to print but what is asked for."""
    ours = {name: value for name, value in os.environ.items() if name not in HOW_TO_PRINT}
    return {**ours, "PYTHON": sys.executable, **asked}


def called(words: Sequence[str], stdin: bytes = b"", on_terminal: bool = False, **asked: str) -> Ran:
    """Call the command line in this process. A terminal shows stderr where it shows stdout, and no progress bar."""
    encoding = asked.pop("PYTHONIOENCODING", "utf-8")
    errors = "surrogateescape" if encoding == "utf-8" else "strict"
    printed = BytesIO()
    said = printed if on_terminal else BytesIO()
    printed.isatty = said.isatty = lambda: on_terminal  # type: ignore[method-assign]
    out = TextIOWrapper(printed, encoding, errors, newline="", write_through=True)
    err = TextIOWrapper(said, encoding, "backslashreplace", newline="", write_through=True)
    with (
        patch("sys.stdin", TextIOWrapper(BytesIO(stdin))),
        patch("sys.__stdout__", out),
        patch("atwood_cli.output.page.monotonic", lambda: 9.0),
        patch.dict(os.environ, around(asked), clear=True),
        redirect_stdout(out),
        redirect_stderr(err),
    ):
        status = cli.run(list(words))
    shown = [buffer.getvalue().decode("utf-8", "replace") for buffer in (printed, said)]
    return Ran(status, shown[0], "" if on_terminal else shown[1])


STARTED = """
import gc, signal, sys
from atwood_cli.__main__ import main
# The first that main calls once it hears signals, which were blocked until then: what Python does before is its own.
gc.disable = lambda: signal.pthread_sigmask(signal.SIG_SETMASK, [])
main()
"""
HEARD = ("SIGINT", "SIGTERM", "SIGHUP")


def hearing(*words: str, **how: Any) -> "subprocess.Popen[bytes]":
    """A run of the program that hears no signal before its own handlers are there."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.Signals[name] for name in HEARD])
    try:
        program = [sys.executable, "-c", STARTED, *words]
        return subprocess.Popen(program, stdout=subprocess.PIPE, stderr=subprocess.PIPE, **how)
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def process(*arguments: str, shell: str = "", code: str = "", stdin: str = "", **asked: Any) -> Ran:
    """Run it as a process if Python or a module looks at what is asked for as it starts, and call it otherwise.

    With ``code``, run that; with ``shell``, a line of bash in which `atwood` is the command.
    """
    if not (shell or code or any(name.startswith(("PYTHON", "LC_", "_", "SHELL")) for name in asked)):
        return called(arguments, **asked)
    words = [sys.executable, *(["-c", code] if code else ["-m", "atwood_cli"]), *arguments]
    if shell:
        words = ["bash", "-c", f'atwood() {{ "$PYTHON" -m atwood_cli "$@"; }}; {shell}']
    done = subprocess.run(words, input=stdin.encode(), capture_output=True, env=around(asked), timeout=HANGS)
    return Ran(done.returncode, *(said.decode("utf-8", "replace") for said in (done.stdout, done.stderr)))


def on_terminal(*arguments: str, columns: int, rows: int = 60, **asked: Any) -> str:
    """What a terminal of that size would get to see."""
    size = {"COLUMNS": str(columns), "LINES": str(rows)}
    return called(arguments, on_terminal=True, **{"TERM": "xterm-256color", **size, **asked}).out


QUICK = """
import sys
from atwood_cli.__main__ import main
from atwood_cli.output import page
page.monotonic = lambda: 9
main()
"""
"""The program as if no second went by: on a slow machine it would show bars."""


LOADED = """
import atexit, sys
from atwood_cli.cli import run
atexit.register(lambda: print(*sys.modules, file=sys.stderr))
run()
"""
"""The program, which names at its end on stderr what it has imported."""
END = b"\0the end"


def on_real_terminal(*arguments: str, columns: int, rows: int = 60, program: str = QUICK) -> str:
    """What a terminal of that size gets to see of a process."""
    pty, fcntl = pytest.importorskip("pty"), pytest.importorskip("fcntl")
    import struct
    import termios

    leader, follower = pty.openpty()
    fcntl.ioctl(follower, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))
    words, env = [sys.executable, "-c", program, *arguments], around({"TERM": "xterm-256color"})
    child = subprocess.Popen(words, stdin=follower, stdout=follower, stderr=follower, env=env)

    def mark_the_end() -> int:
        try:
            return child.wait(HANGS)
        finally:
            os.write(follower, END)

    # The end is a mark, since a terminal closed by its last writer can lose what was written last.
    seen = b""
    with ThreadPoolExecutor(1) as waiting:
        status = waiting.submit(mark_the_end)
        while not seen.endswith(END):
            seen += os.read(leader, 65536)
    os.close(follower)
    os.close(leader)
    assert status.result() >= 0, seen
    return seen.removesuffix(END).decode("utf-8", "replace").replace("\r\n", "\n")


def plain(seen: str) -> str:
    """What a terminal got to see, without its colours."""
    return re.sub(r"\x1b\[[0-9;]*m", "", seen)


def labels(svg: str) -> list[str]:
    """The texts of a picture, in its title and description, too, but for the name of what drew it."""
    names = ("title", "desc", "text")
    texts = ("".join(one.itertext()) for one in fromstring(svg).iter() if one.tag.split("}")[-1] in names)
    # Numbers along axes are set digit by digit by some versions of matplotlib, each in a line.
    whole = ("".join(text.split()) if "\n" in text else text for text in texts)
    return [text for text in whole if not text.startswith("Matplotlib v")]


@contextmanager
def pages_seen() -> Iterator[list[Any]]:
    """The pictures that would be saved meanwhile, as matplotlib has them."""
    pages: list[Any] = []
    figure = pytest.importorskip("matplotlib.figure")
    with patch.object(figure.Figure, "savefig", lambda page, *_, **__: pages.append(page)):
        yield pages


def drawn(line: str, stdin: bytes = b"") -> Any:
    """The picture that a command line has, as matplotlib has it."""
    with TemporaryDirectory() as folder, chdir(folder), pages_seen() as pages:
        ran = called([*line.split(), "--figure", "a.svg"], stdin)
    assert ran.status in (0, 1), ran.err  # 1 if runs give no result
    (page,) = pages
    return page


def words_on(page: Any) -> list[str]:
    """What a picture says, but for the numbers along its axes."""
    from matplotlib.text import Text

    scales = [axis for axes in page.axes for axis in (axes.xaxis, axes.yaxis)]
    numbers = {text for axis in scales for text in axis.findobj(Text) if text is not axis.label}
    texts = (text.get_text() for text in page.findobj(Text) if text not in numbers)
    return [words for text in texts if (words := " ".join(text.split()))]


def misplaced(page: Any) -> list[str]:
    """What nobody could read on a page: words over words, or beyond its edge."""
    from matplotlib.text import Text

    boxes: list[tuple[str, Any]] = []
    draw = Text.draw

    def drawing(text: Any, renderer: Any) -> None:
        draw(text, renderer)
        if text.get_visible() and text.get_text().strip():
            boxes.append((text.get_text(), Text.get_window_extent(text, renderer)))

    with patch.object(Text, "draw", drawing):
        page.draw_without_rendering()
    edge = page.bbox.padded(1)
    beyond = [text for text, box in boxes if not (edge.contains(*box.min) and edge.contains(*box.max))]
    over = [f"{one} | {other}" for (one, box), (other, at) in combinations(boxes, 2) if box.overlaps(at)]
    return [*beyond, *over]
