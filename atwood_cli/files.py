"""Files that are there whole or not at all, and what of a table a terminal gets to see."""

import errno
import os
import re
import stat
import sys
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout
from io import TextIOBase
from pathlib import Path

FORMATS = ("csv", "tsv", "ndjson", "parquet")
"""Of tables, each with the suffix of that name."""
STREAM = "-"
"""The name of a file that is stdin or stdout."""
LONGEST_NAME = 255
"""Characters of a file's name that a message shows."""


STEERING = re.compile("[\0-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")
"""Control characters, those that change the direction of others, and halves of pairs."""


def printable(words: str, keep: str = "\n") -> str:
    """The words as a terminal may see them: what could steer it is spelled out, but for what is to keep.

    Whatever the program did not make itself goes through here on its way to a terminal.
    """
    return STEERING.sub(lambda found: found[0] if found[0] in keep else ascii(found[0])[1:-1], words)


class Unreadable(Exception):
    """What was given is no table; the message says why."""


class Stdout:
    """Standard output for tables: the bytes as they are, but for what could steer a terminal."""

    def __init__(self) -> None:
        sys.stdout.flush()
        self.file, self.is_terminal = sys.stdout.buffer, sys.stdout.isatty()

    def write(self, cells: str | bytes | memoryview) -> None:
        if self.is_terminal:
            words = cells if isinstance(cells, str) else bytes(cells).decode(errors="replace")
            cells = printable(words, "\n\t").encode(sys.stdout.encoding, "replace")
        self.file.write(cells.encode() if isinstance(cells, str) else cells)

    def flush(self) -> None:
        self.file.flush()


class ClosedStdout(TextIOBase):
    """What stands for a standard output that the caller closed: nothing can be written to it."""

    @property
    def buffer(self) -> "ClosedStdout":
        return self

    def write(self, words: object) -> int:
        raise OSError("cannot write the output: stdout is closed")


def check_free(path: Path, force: bool) -> None:
    """Raises FileExistsError where a file is there, unless ``force`` lets it be replaced."""
    if path.is_file() and not force:
        raise FileExistsError(errno.EEXIST, "it exists already; --force replaces it", str(path))


def is_stdout(path: str) -> bool:
    """Whether a file is the one that standard output goes to, by whatever name."""
    try:
        return os.path.isfile(path) and os.path.samestat(os.stat(path), os.fstat(sys.stdout.fileno()))
    except (OSError, ValueError, AttributeError):  # one is closed, or not there yet
        return False


@contextmanager
def written_beside(path: Path, force: bool = False) -> Iterator[Path]:
    """A file to write beside ``path``, which takes its name once all went well.

    A run that fails or is killed leaves ``path`` as it was. A file that is there, or comes to be there
    meanwhile, is replaced only by ``force``, and keeps its mode; what is no file (a device, a pipe) is
    written to directly. Raises OSError.
    """
    if path.exists() and not path.is_file():
        yield path
        return
    check_free(path, force)
    target = Path(os.path.realpath(path))  # a link stays a link
    # A name that nobody can foresee, and of no more than 255 bytes however long the other is.
    beside = target.with_name(f".atwood-{os.urandom(8).hex()}")
    try:
        mode = _mode(target)
        os.close(os.open(beside, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666 if mode is None else 0o600))
        yield beside
        if mode is not None:
            beside.chmod(mode)
        check_free(path, force)
        os.replace(beside, target)
    except OSError as error:
        if error.errno and error.filename in (None, str(beside), str(target)):  # not the name asked for
            raise type(error)(error.errno, error.strerror, str(path)) from None
        raise
    finally:
        beside.unlink(missing_ok=True)


def _mode(target: Path) -> int | None:
    """The permissions of a file, None if there is none. Raises OSError, as where a link leads to itself."""
    try:
        return stat.S_IMODE(target.stat().st_mode)
    except FileNotFoundError:
        return None


@contextmanager
def stdout_into(file: str | None, force: bool = False) -> Iterator[None]:
    """What is printed goes to the file, if one is named, other than -. Raises OSError."""
    if file in (None, STREAM):
        yield
        return
    with (
        written_beside(Path(file), force) as beside,
        beside.open("w", encoding="utf-8", newline="") as stream,
        redirect_stdout(stream),
    ):
        yield
