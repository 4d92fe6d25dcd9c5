"""What ends a run early: files are whole or as they were, and nobody sees a traceback.

python -m tests.test_kills 3000 has so many runs that write a file get a signal at a random instant, some of them
two. The file is then as it was, or whole, and but for SIGKILL nothing is left beside it.
"""

import os
import re
import signal
import subprocess
import sys
import time
from contextlib import chdir
from functools import cache, partial
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory

import polars as pl
import pytest

from .running import HANGS, TOP, around, hearing

pytestmark = pytest.mark.skipif(os.name == "nt", reason="needs POSIX signals")

STATUS = {"SIGINT": 130, "SIGTERM": 143, "SIGHUP": 129, "SIGKILL": -9}
SCENE = "--m1 1 --m2 3"
ENVIRONMENT = around({"PYTHONPATH": str(TOP)})


def blown(code: str, *words: str) -> tuple[int, bytes, bytes]:
    """How code ends that sends itself a signal: status, stdout, stderr."""
    done = subprocess.run(
        [sys.executable, "-c", code, *words], capture_output=True, check=False, timeout=HANGS
    )
    return done.returncode, done.stdout, done.stderr


# Wherever it is, it ends quietly

SLOW = """
import sys, time
import atwood_cli.cli.contact, atwood_cli.solver.answers, atwood_cli.sweep.ranges, atwood_cli.batch.run
from atwood_cli.__main__ import main
def slow(*_, **__):
    print("started", file=sys.stderr, flush=True)
    while True:  # as a signal that comes while Python enters a call is seen only behind it
        time.sleep(0.01)
atwood_cli.cli.contact.Answers = atwood_cli.solver.answers.Answers = slow
atwood_cli.sweep.ranges.Answers = atwood_cli.batch.run.run_batch = slow
sys.exit(main())
"""


@pytest.mark.parametrize(
    ("typed", "blow"),
    [
        (f"solve {SCENE} --mu 0.3 --json", "SIGHUP"),
        (f"contact {SCENE} --mu 0.3", "SIGTERM"),
        (f"sweep {SCENE} --M 0:100:9", "SIGINT"),
        ("batch -", "SIGINT"),
    ],
)
def test_what_ends_it_ends_it_quietly(typed: str, blow: str) -> None:
    command = [sys.executable, "-c", SLOW, *typed.split()]
    child = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert child.stderr is not None
    assert child.stderr.readline() == b"started\n"
    child.send_signal(signal.Signals[blow])
    out, err = child.communicate(timeout=HANGS)
    assert (child.returncode, out, err) == (STATUS[blow], b"", b"")


DROPPING = """
import os, signal, sys, time
from atwood_cli import cli
from atwood_cli.__main__ import main
class Dropped:
    def __del__(self):
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(0)
def run():
    Dropped()
    while True:
        time.sleep(0.01)
cli.run = run
sys.exit(main())
"""


def test_a_signal_is_not_lost_where_python_can_raise_nothing() -> None:
    assert blown(DROPPING) == (143, b"", b"")


TURNED = """
import os, signal, sys, time
from atwood_cli import cli
class Part:
    def __set_name__(self, owner, name):
        os.kill(os.getpid(), getattr(signal, sys.argv.pop()))
        time.sleep(9)
def run():
    try:
        type("Imported", (), {"part": Part()})
    except KeyboardInterrupt as error:  # since Python 3.12; before, a RuntimeError
        raise ImportError("numpy._core.multiarray failed to import") from error
cli.run = run
from atwood_cli.__main__ import main
sys.exit(main())
"""


@pytest.mark.parametrize("blow", ["SIGINT", "SIGTERM", "SIGHUP"])
def test_a_run_stopped_in_an_import_shows_no_traceback(blow: str) -> None:
    """Classes that are being made, and modules written in C, turn what stops them into other errors."""
    assert blown(TURNED, blow) == (STATUS[blow], b"", b"")


@pytest.mark.parametrize("kind", ["csv", "parquet"])
def test_a_pipe_that_brings_nothing_is_waited_for_until_it_is_stopped(tmp_path: Path, kind: str) -> None:
    os.mkfifo(tmp_path / "in")
    for blow, is_open in (("SIGTERM", False), ("SIGINT", True)):
        child = hearing("batch", str(tmp_path / "in"), "--from", kind)
        writer = os.open(tmp_path / "in", os.O_RDWR) if is_open else None
        time.sleep(0.5)
        child.send_signal(signal.Signals[blow])
        assert child.communicate(timeout=HANGS) == (b"", b"")
        assert child.returncode == STATUS[blow]
        if writer is not None:
            os.close(writer)


# What it was writing


@pytest.mark.parametrize(
    ("blows", "before"),
    [("SIGKILL", ""), ("SIGINT", ""), ("SIGTERM", "as it was"), ("SIGHUP", ""), ("SIGINT SIGINT", "")],
)
def test_a_run_cut_short_leaves_no_output(tmp_path: Path, blows: str, before: str) -> None:
    out = tmp_path / "out.csv"
    if before:
        out.write_text(before)
    child = hearing("batch", "-", "-o", str(out), "--force", stdin=subprocess.PIPE)
    assert child.stdin is not None
    child.stdin.write(b"m1,m2,M\n" + b"1,3.1,10\n" * 300_000)  # some pieces are done, more are awaited
    child.stdin.flush()
    while not any(path.stat().st_size for path in tmp_path.glob(".atwood-*")):
        assert child.poll() is None
        time.sleep(0.01)
    for blow in blows.split():
        child.send_signal(signal.Signals[blow])
    _, err = child.communicate(timeout=HANGS)
    assert child.returncode == STATUS[blows.split()[0]]
    assert out.exists() == bool(before)
    if blows == "SIGKILL":
        assert err == b""
    else:
        assert [path.read_text() for path in tmp_path.iterdir()] == [before] * bool(before)
        is_left = "stays as it was" if before else "was not written"
        said = re.fullmatch(
            rf"atwood: stopped after (\d+) rows; {re.escape(str(out))} {is_left}\n", err.decode()
        )
        assert said
        assert 0 < int(said[1]) <= 300_000


def test_what_is_to_outlive_its_terminal_does(tmp_path: Path) -> None:
    """Under nohup, which has SIGHUP ignored."""
    ignore = partial(signal.signal, signal.SIGHUP, signal.SIG_IGN)
    child = hearing("batch", "-", "-o", str(tmp_path / "out.csv"), stdin=subprocess.PIPE, preexec_fn=ignore)
    while not list(tmp_path.iterdir()):
        time.sleep(0.01)
    child.send_signal(signal.SIGHUP)
    said = b"atwood: 1 row: 1 no-slip; no errors.\n"
    assert child.communicate(b"m1,m2\n1,3\n", HANGS) == (b"", said)
    assert child.returncode == 0


RUNS = [
    "batch in.csv -o out.csv",
    "batch in.ndjson -o out.ndjson",
    "batch in.parquet -o out.parquet --accuracy exact",
    f"sweep {SCENE} --M 1:100:2000 -o out.csv",
    f"sweep {SCENE} --M 1:100:20 -o out.json",
    f"sweep {SCENE} --M 1:100:20 --figure out.svg",
    f"contact {SCENE} --mu 0.3 --figure out.svg",
]


def start(line: str) -> "subprocess.Popen[bytes]":
    """A run of the program, here, which hears no signal before its own handlers are there."""
    scenes = pl.DataFrame({"m1": [1.0] * 50_000, "m2": [3.0] * 50_000, "n": range(50_000)})
    if "batch" in line:
        for kind in ("csv", "ndjson", "parquet"):
            getattr(scenes, f"write_{kind}")(f"in.{kind}")
    return hearing(*line.split(), "--force", env=ENVIRONMENT)


@cache
def whole(line: str) -> tuple[bytes, float]:
    """What a run writes that is left alone, and how long it takes."""
    with TemporaryDirectory() as folder, chdir(folder):
        begun = time.perf_counter()
        start(line).communicate()
        taken = time.perf_counter() - begun
        (out,) = Path().glob("out.*")
        return out.read_bytes(), taken


def kill(run: int) -> None:
    """Send a run its signals, and look at what is left."""
    random = Random(run)
    line, blow = random.choice(RUNS), random.choice(list(STATUS))
    whole_file, seconds = whole(line)
    delays = [random.uniform(0, 1.2 * seconds), *random.choice([[], [random.uniform(0, 0.02)]])]
    before = random.choice([None, b"as it was"])
    with TemporaryDirectory() as folder, chdir(folder):
        out = Path(next(word for word in line.split() if word.startswith("out.")))
        if before is not None:
            out.write_bytes(before)
        child = start(line)
        for delay in delays:
            time.sleep(delay)
            child.send_signal(signal.Signals[blow])
        _, said = child.communicate(timeout=HANGS)
        left = {path.name for path in Path().iterdir()} - {"in.csv", "in.ndjson", "in.parquet", str(out)}
        after = out.read_bytes() if out.exists() else None
    what = f"run {run}, {line} and {blow} after {delays} s: {said!r}"
    assert child.returncode in (0, STATUS[blow]), what
    assert after in (before, whole_file), what
    assert child.returncode or after == whole_file, what
    assert not left or (blow == "SIGKILL" and all(name.startswith(".atwood-") for name in left)), what
    assert all(line.startswith(b"atwood: ") for line in said.splitlines()), what


@pytest.mark.parametrize("run", range(3))
def test_what_is_killed_at_any_instant_leaves_its_file_whole_or_as_it_was(run: int) -> None:
    kill(run)


if __name__ == "__main__":
    for number in range(int(sys.argv[1])):
        kill(number)
