"""What ends a run early: files are whole or as they were, and what a signal ends shows no traceback."""

import os
import signal
import subprocess
import sys
import time
from functools import partial
from itertools import count
from pathlib import Path

import pytest

from .tools.running import HANGS, hearing

pytestmark = pytest.mark.skipif(os.name == "nt", reason="needs POSIX signals")

STATUS = {"SIGINT": 130, "SIGTERM": 143, "SIGHUP": 129, "SIGKILL": -9}
SCENE = "--m1 1 --m2 3"


def blown(
    child: "subprocess.Popen[bytes]", blow: str, times: int = 1, stdin: bytes | None = None
) -> tuple[int, bytes, bytes]:
    """How a run ends that gets a signal: status, stdout, stderr."""
    for _ in range(times):
        child.send_signal(signal.Signals[blow])
    out, err = child.communicate(stdin, HANGS)
    return child.returncode, out, err


# Wherever it is, it ends quietly

RUN = """
import os, signal, sys, time
from atwood_cli import cli
from atwood_cli.__main__ import main
number = getattr(signal, sys.argv.pop(1))
def blow(*_, **__):
    os.kill(os.getpid(), number)
    while True:  # as a signal that comes while Python enters a call is seen only behind it
        time.sleep(0.01)
{}
main()
"""
SOLVING = """
import atwood_cli.solver.answers, atwood_cli.sweep.ranges, atwood_cli.batch.run
atwood_cli.solver.answers.Answers = atwood_cli.sweep.ranges.Answers = blow
"""
# Where Python drops an object, it can raise no interrupt.
DROPPED = "cli.run = lambda: {type('Dropped', (), {'__del__': blow})()}.clear() or time.sleep(60)"
# A second signal comes while the bar of progress is closed.
CLOSING = """
import atwood_cli.batch.run, contextlib
atwood_cli.output.page.ExitStack = type("Closing", (contextlib.ExitStack,), {"__exit__": blow})
atwood_cli.batch.run.solve_cells = blow
"""
# Modules in C may turn the interrupt into another error while they are imported.
TURNED = """
class Part:
    __set_name__ = blow
def run():
    try:
        type("Imported", (), {"part": Part()})
    except KeyboardInterrupt as error:  # since Python 3.12; before, a RuntimeError
        raise ImportError("numpy._core.multiarray failed to import") from error
cli.run = run
"""


@pytest.mark.parametrize(
    ("code", "blow", "typed"),
    [
        (SOLVING, "SIGHUP", f"solve {SCENE} --mu 0.3 --json"),
        (SOLVING, "SIGINT", f"sweep {SCENE} --M 0:100:9"),
        (DROPPED, "SIGINT", ""),
        (CLOSING, "SIGINT", "batch -"),
        (TURNED, "SIGTERM", ""),
    ],
    ids=count(),
)
def test_a_signal_ends_it_quietly(code: str, blow: str, typed: str) -> None:
    command = [sys.executable, "-c", RUN.format(code), blow, *typed.split()]
    ended = subprocess.run(command, input=b"m1,m2\n1,3\n", capture_output=True, check=False, timeout=HANGS)
    assert (ended.returncode, ended.stdout, ended.stderr) == (STATUS[blow], b"", b"")


def test_a_pipe_that_brings_nothing_is_waited_for_until_it_is_stopped(tmp_path: Path) -> None:
    """Both at once, as each has to be waited for; to write, only the second pipe was opened."""
    children = {}
    for kind, blow in (("csv", "SIGTERM"), ("parquet", "SIGINT")):
        os.mkfifo(pipe := tmp_path / kind)
        children[hearing("batch", str(pipe), "--from", kind)] = blow
    opened = os.open(pipe, os.O_RDWR)
    time.sleep(1)
    for child, blow in children.items():
        assert child.poll() is None
        assert blown(child, blow) == (STATUS[blow], b"", b"")
    os.close(opened)


# What it was writing


@pytest.mark.parametrize(
    ("blow", "times", "before"), [("SIGKILL", 1, ""), ("SIGHUP", 1, "as it was"), ("SIGINT", 2, "")]
)  # fmt: skip
def test_a_run_cut_short_leaves_no_output(tmp_path: Path, blow: str, times: int, before: str) -> None:
    out = tmp_path / "out.csv"
    if before:
        out.write_text(before)
    child = hearing("batch", "-", "-o", str(out), "--force", stdin=subprocess.PIPE)
    assert child.stdin is not None
    child.stdin.write(b"m1,m2,M\n" + b"1,3.1,10\n" * 1000)  # these are solved, and more are awaited
    child.stdin.flush()
    while not any(path.stat().st_size > 50_000 for path in tmp_path.glob(".atwood-*")):
        assert child.poll() is None
        time.sleep(0.01)
    status, _, err = blown(child, blow, times)
    assert (status, out.exists()) == (STATUS[blow], bool(before))
    assert err == (b"" if blow == "SIGKILL" else b"atwood: stopped after 1000 rows\n")
    assert blow == "SIGKILL" or [path.read_text() for path in tmp_path.iterdir()] == [before] * bool(before)


def test_what_is_to_outlive_its_terminal_does(tmp_path: Path) -> None:
    """Under nohup, which has SIGHUP ignored."""
    ignore = partial(signal.signal, signal.SIGHUP, signal.SIG_IGN)
    words = ["batch", "-", "--only", "a", "-o", str(tmp_path / "out.csv")]
    child = hearing(*words, stdin=subprocess.PIPE, preexec_fn=ignore)
    while not list(tmp_path.iterdir()):
        time.sleep(0.01)
    ended = blown(child, "SIGHUP", stdin=b"m1,m2\n1,3\n")
    assert (ended[0], ended[2].splitlines()[-1]) == (0, b"atwood: 1 row: 1 no-slip; no errors.")
