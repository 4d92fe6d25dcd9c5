"""Whatever is typed, read or given, promises hold; python -m tests.test_fuzz 100000 tries so many of each kind.

A run ends within the limits, without a traceback or a warning, with a status of ours, with stdout empty on an
error and with sentences on stderr. A table comes out with as many rows as were read. What is read steers no
terminal, and nothing long is repeated whole. What a closed stdout loses is said. Hypothesis makes what fails as
small as it can, and tries it first the next time.
"""

import csv
import io
import json
import os
import re
import signal
import subprocess
import sys
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import chdir, contextmanager
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from unicodedata import category
from unittest.mock import patch

import pytest
from hypothesis import given, settings

from atwood_cli import SceneError
from atwood_cli.tradeoff import measure

from . import fuzz, running
from .conftest import many
from .running import Ran, called

BUSY = 15  # seconds of processor time, for any run
MOST_SAID = 2000  # characters of a sentence
STATUSES = (0, 1, 2, 130)
RUNS = {"solve": 600, "contact": 250, "sweep": 250, "batch": 350, "fit": 350, "tradeoff": 20}
"""How many runs of a command are tried with --every-digit; otherwise a quarter."""


@contextmanager
def limited() -> Iterator[None]:
    """Raise TimeoutError in what takes more processor time than BUSY, where the system has alarms."""
    if not hasattr(signal, "setitimer"):
        yield
        return

    def ring(*_: object) -> None:
        raise TimeoutError(f"it takes more than {BUSY} s of processor time")

    before = signal.signal(signal.SIGPROF, ring)
    signal.setitimer(signal.ITIMER_PROF, BUSY)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)


@contextmanager
def at(run: fuzz.Run) -> Iterator[None]:
    """In a folder with the file of the run, where measurements are short and every warning is shown."""
    short = patch.multiple(measure, RUN_SECONDS=1e-5, REPEATS=1, MOST_SCENES=20, MOST=2)
    with TemporaryDirectory() as folder, chdir(folder), short, warnings.catch_warnings(), limited():
        warnings.simplefilter("always")
        Path("in.csv").touch()
        Path(run.source).write_bytes(run.content)
        yield


def check(words: Sequence[str], ran: Ran) -> None:
    """What is promised of any run."""
    assert ran.status in STATUSES
    partly = words[0] == "batch" or "--only" in words  # rows that failed, values that do not exist
    assert not ran.out or ran.status == 0 or (ran.status == 1 and partly), "stdout beside an error"
    assert [line for line in ran.err.splitlines() if not re.match("atwood: .", line)] == []
    assert ran.err or not ran.status, "an error without a word"
    assert "\x1b" not in ran.err
    assert max(map(len, ran.err.splitlines()), default=0) <= MOST_SAID
    if words[0] != "batch" and not {"--csv", "--markdown"} & {*words}:
        assert {c for c in ran.out if category(c) in ("Cc", "Cf")} <= {"\n"}, "it steers a terminal"
    if counted := re.search(r"^atwood: (\d+) rows?: ", ran.err, re.MULTILINE):
        assert rows_out(words, ran.out) in (None, int(counted[1]))
    elsewhere = {"-h", "--help", "-o", "--output", "--version"} & {*words}
    if words[0] != "batch" and ran.status == 0 and "--json" in words and not elsewhere:
        json.loads(ran.out, parse_constant=lambda word: 1 / 0)


def rows_out(words: Sequence[str], printed: str) -> int | None:
    """How many rows a run printed; None where that cannot be told."""
    if {"-o", "--output"} & {*words}:
        return None
    source = next((word for word in words if word in ("-", "in") or word.startswith("in.")), "-")
    kinds = [after for word, after in pairwise(words) if word == "--from"] or [source.rpartition(".")[2]]
    if kinds == ["ndjson"]:
        return printed.count("\n")
    if kinds[0] not in ("csv", "-"):
        return None
    return sum(1 for row in csv.reader(io.StringIO(printed, newline="")) if row) - 1


def try_runs(command: str, count: int) -> None:
    @settings(max_examples=count)
    @given(fuzz.runs(command))
    def keeps_its_promises(run: fuzz.Run) -> None:
        with at(run):
            check(run.words, called(run.words, Path("in.csv").read_bytes()))

    keeps_its_promises()


@pytest.mark.parametrize("command", RUNS)
def test_nothing_that_is_typed_breaks_a_promise(command: str) -> None:
    try_runs(command, many(RUNS[command]))


@pytest.mark.skipif(os.name == "nt", reason="needs a POSIX shell")
@settings(max_examples=2)
@given(fuzz.runs("solve"))
def test_what_a_closed_stdout_loses_is_said(run: fuzz.Run) -> None:
    if any("\0" in word for word in run.words):
        return
    command = ["sh", "-c", 'exec "$@" >&-', "sh", sys.executable, "-m", "atwood_cli", *run.words]
    with at(run), open("in.csv", "rb") as stdin:
        env = running.around({"PYTHONPATH": str(running.TOP)})
        ended = subprocess.run(command, stdin=stdin, stderr=subprocess.PIPE, env=env, check=False)
    assert ended.returncode in STATUSES
    assert b"Traceback" not in ended.stderr
    elsewhere = {"-o", "--output", "-h", "--help", "-V", "--version"} & {*run.words}
    assert ended.returncode or elsewhere, "status 0, though stdout is closed"


@settings(max_examples=many(400))
@given(fuzz.calls())
def test_nothing_that_python_is_given_breaks_a_promise(
    call: tuple[Callable[..., object], dict[str, Any]],
) -> None:
    function, arguments = call
    with limited():
        try:
            function(**arguments)
        except SceneError as error:
            str(error)
        except ValueError as error:
            if "broadcast" not in str(error):
                raise


@pytest.mark.parametrize(
    ("status", "out", "err", "kept"),
    [
        (0, "1\n", "", True),
        (0, "1\n", "atwood: a note\n", True),
        (2, "", "atwood: an error\n", True),
        (1, "1\n", "atwood: an error\n", False),
        (2, "", "", False),
        (120, "", "", False),
        (0, "", "x.py:1: UserWarning: log\n", False),
        (2, "", "atwood: \x1b[31m\n", False),
        (0, "a\x9bm\n", "", False),
        (0, "a\u202eb\n", "", False),
        (2, "", f"atwood: {'x' * 2000}\n", False),
    ],
)
def test_what_a_promise_is(status: int, out: str, err: str, kept: bool) -> None:
    try:
        check(["solve"], Ran(status, out, err))
    except AssertionError:
        assert not kept
    else:
        assert kept


if __name__ == "__main__":
    settings.load_profile("every-digit")
    for name in RUNS:
        try_runs(name, int(sys.argv[1]))
