"""What is typed at random: a few of the runs of which `python -m tests.fuzz 100000` makes many."""

import signal
import sys
from pathlib import Path

import pytest

from atwood_cli import cli

from . import fuzz


@pytest.mark.parametrize("first", range(0, 400, 50))
def test_nothing_that_is_typed_breaks_a_promise(first: int) -> None:
    assert list(fuzz.faults(range(first, first + 50))) == []


@pytest.mark.skipif(not hasattr(signal, "pthread_sigmask"), reason="needs POSIX signals")
def test_what_is_killed_at_any_instant_leaves_its_file_whole_or_as_it_was() -> None:
    assert list(fuzz.faults(range(3), fuzz.wrong_with_killed)) == []


def test_a_fault_is_found_and_can_be_had_again(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def crash(*_: object) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr(cli, "run", crash)
    assert fuzz.main(20, 3) == 1
    *found, last = capsys.readouterr().out.split("\nrun ")
    assert last.endswith(f"\n20 runs, {len(found) + 1} faults\n")
    assert fuzz.main(1, int(last.split(",")[0])) == 1


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="needs POSIX signals")
def test_a_run_that_is_busy_for_long_is_a_fault(monkeypatch: pytest.MonkeyPatch) -> None:
    def busy(*_: object) -> None:
        while True:
            pass

    monkeypatch.setattr(cli, "run", busy)
    monkeypatch.setattr(fuzz, "BUSY", 0.1)
    run = next(run for run in range(99) if fuzz.Dice(run).random() >= 0.2)  # no call from Python
    (fault,) = fuzz.faults([run])
    assert "TimeoutError: it takes more than 0.1 s of processor time" in fault


@pytest.mark.parametrize(
    ("status", "out", "err", "wrong"),
    [
        (0, "1\n", "", ""),
        (0, "1\n", "atwood: a note\n", ""),
        (2, "", "atwood: an error\n", ""),
        (1, "1\n", "atwood: an error\n", "status 1 beside '1\\n' on stdout"),
        (2, "", "", "status 2 without a word"),
        (120, "", "", "status 120"),
        (0, "", "x.py:1: UserWarning: log\n", "on stderr: 'x.py:1: UserWarning: log'"),
        (2, "", "atwood: \x1b[31m\n", "an escape sequence on stderr: 'atwood: \\x1b[31m\\n'"),
        (0, "a\x9bm\n", "", "'\\x9b' on stdout, which steers a terminal"),
        (0, "a\u202eb\n", "", "'\\u202e' on stdout, which steers a terminal"),
        (2, "", f"atwood: {'x' * 2000}\n", f"2008 characters in a line of stderr: 'atwood: {'x' * 90}"),
    ],
)
def test_what_a_promise_is(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, status: int, out: str, err: str, wrong: str
) -> None:
    def run(_: list[str]) -> int:
        print(out, end="")
        print(err, end="", file=sys.stderr)
        return status

    monkeypatch.setattr(cli, "run", run)
    monkeypatch.chdir(tmp_path)
    Path("in.csv").touch()
    assert fuzz.wrong_with_line(["solve"]) == wrong
