"""Files are there whole or not at all."""

import os
import socket
import subprocess
import sys
from contextlib import suppress
from itertools import count
from pathlib import Path
from typing import Any

import pytest

from atwood_cli.output.files import written_beside

from .tools.running import HANGS, around


def test_an_error_leaves_all_as_it_was(tmp_path: Path) -> None:
    file = tmp_path / "a.txt"
    file.write_text("before")
    with suppress(ZeroDivisionError), written_beside(file, force=True) as beside:
        beside.write_text("half")
        raise ZeroDivisionError
    assert file.read_text() == "before"
    assert list(tmp_path.iterdir()) == [file]


def test_written_beside_follows_links(tmp_path: Path) -> None:
    (tmp_path / "data").mkdir()
    file, link, circle = tmp_path / "data" / "a.txt", tmp_path / "link.txt", tmp_path / "circle.txt"
    try:
        link.symlink_to(file)
        circle.symlink_to(circle)
    except OSError:
        pytest.skip("no links here")
    with written_beside(link) as beside:
        assert beside.parent == file.parent
        beside.write_text("whole")
    assert (link.is_symlink(), file.read_text()) == (True, "whole")
    for path in (tmp_path / "none" / "a.txt", circle):
        with pytest.raises(OSError, match=r"No such file|symbolic links") as caught, written_beside(path):
            pass
        assert caught.value.filename == str(path)


def test_written_beside_replaces_only_by_force(tmp_path: Path) -> None:
    file = tmp_path / "a.txt"
    for before in ("", "kept"):  # a file that is there, or that appears meanwhile
        file.unlink(missing_ok=True)
        with pytest.raises(FileExistsError, match="--force replaces it"):  # noqa: PT012
            if before:
                file.write_text(before)
            with written_beside(file) as beside:
                beside.write_text("ours")
                file.write_text("kept")
        assert file.read_text() == "kept"
    with written_beside(file, force=True) as beside:
        assert (file.read_text(), beside.parent) == ("kept", tmp_path)
        beside.write_text("new")
    assert file.read_text() == "new"
    assert list(tmp_path.iterdir()) == [file]


@pytest.mark.skipif(os.name == "nt", reason="needs modes")
@pytest.mark.parametrize("mode", [0o600, 0o640, 0o444])
def test_what_is_replaced_keeps_its_mode(tmp_path: Path, mode: int) -> None:
    file, new, usual = (tmp_path / name for name in ("a.txt", "new.txt", "usual.txt"))
    file.touch()
    file.chmod(mode)
    with written_beside(file, force=True) as beside, written_beside(new):
        assert beside.stat().st_mode & 0o777 == 0o600  # nobody else reads it before it is there
    assert file.stat().st_mode & 0o777 == mode
    usual.touch()
    assert new.stat().st_mode == usual.stat().st_mode


def test_the_name_beside_is_foreseen_by_nobody(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "a.txt"
    with written_beside(tmp_path / "b.txt") as one, written_beside(file) as other:
        assert one != other
    monkeypatch.setattr(os, "urandom", bytes)
    with written_beside(file, force=True) as foreseen:
        pass
    foreseen.symlink_to(tmp_path / "precious")
    with pytest.raises(FileExistsError), written_beside(file, force=True):
        pass
    assert not (tmp_path / "precious").exists()


@pytest.mark.parametrize("suffix", [".txt", "." + "x" * 240])
def test_a_name_of_any_length_is_taken(tmp_path: Path, suffix: str) -> None:
    file = tmp_path / f"{'a' * (255 - len(suffix))}{suffix}"
    with written_beside(file) as beside:
        beside.write_text("whole")
    assert file.read_text() == "whole"


# Several processes that share a pipe


@pytest.mark.skipif(os.name == "nt", reason="needs sockets of Unix")
@pytest.mark.parametrize("unbuffered", ["", "1"])
@pytest.mark.parametrize(
    ("words", "outputs", "errors"),
    [
        ("solve --m1 1 --m2 3 --only a,T1", 1, 0),
        ("solve --m1 1.0(1) --m2 3 --only a --budget", 1, 1),
        ("solve --m1 1 --m2 3 --M 10 --explain", 1, 0),
        ("sweep --m1 1 --m2 3 --M 1:9:200 --csv", 1, 1),
        ("sweep --m1 1 --m2 3 --M 1:9:200 --json", 1, 0),
        ("batch -", 1, 1),
        ("quantities", 1, 0),
        ("solve --m1 x", 0, 1),
        ("-h", 1, 0),
    ],
    ids=count(),
)
def test_each_output_and_each_message_is_one_write(
    words: str, outputs: int, errors: int, unbuffered: str
) -> None:
    """Lines of processes that ran side by side were torn, most under PYTHONUNBUFFERED, as in containers."""
    ends: Any = [socket.socketpair(socket.AF_UNIX, socket.SOCK_DGRAM) for _ in range(2)]  # a datagram a write
    (out, stdout), (err, stderr) = ends
    command = [sys.executable, "-m", "atwood_cli", *words.split()]
    scene = b"m1,m2\n1,3\n"
    subprocess.run(
        command,
        input=scene,
        stdout=stdout,
        stderr=stderr,
        env=around({"PYTHONUNBUFFERED": unbuffered}),
        timeout=HANGS,
    )
    for end, expected in ((out, outputs), (err, errors)):
        end.setblocking(False)
        messages = []
        with suppress(BlockingIOError):
            while True:
                messages.append(end.recv(1 << 20))
        assert len(messages) == expected
        assert all(message.endswith(b"\n") for message in messages)
    for end in (out, err, stdout, stderr):
        end.close()
