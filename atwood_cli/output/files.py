"""Files that are written whole or not at all, and text that is safe to show on a terminal."""

import errno
import os
import re
import stat
import sys
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout, suppress
from pathlib import Path

STDOUT = "-"
"""The name of a file that is standard output."""
STEERING = re.compile("[\0-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")
"""Control characters, characters that change the direction of text, and halves of surrogate pairs."""


def printable(words: str, keep: str = "\n") -> str:
    """Return words with escapes for characters that could steer a terminal, but those to ``keep``.

    All text that the program did not make itself passes through this on its way to a terminal.
    """
    return STEERING.sub(lambda sign: sign[0] if sign[0] in keep else ascii(sign[0])[1:-1], words)


class Stdout:
    """Standard output for tables. Bytes pass unchanged, but for characters that could steer a terminal."""

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


def check_free(path: Path, force: bool) -> None:
    """Raise FileExistsError if there is a file and ``force`` does not let it be replaced."""
    if path.is_file() and not force:
        raise FileExistsError(errno.EEXIST, "it exists already; --force replaces it", str(path))


@contextmanager
def written_beside(path: Path, force: bool = False) -> Iterator[Path]:
    """Yield a file to write beside ``path``, and rename it to that when all went well. Raises OSError.

    A run that fails or is killed leaves ``path`` as it was. An existing file, also one that appears
    meanwhile, is replaced only with ``force``, and its mode is kept. A device or a pipe is written to
    directly.
    """
    if path.exists() and not path.is_file():
        yield path
        return
    check_free(path, force)
    target = Path(os.path.realpath(path))  # a link stays a link
    # Nobody can foresee this name, and it fits in 255 bytes, however long the target's is.
    beside = target.with_name(f".atwood-{os.urandom(8).hex()}")
    mode = None
    try:
        with suppress(FileNotFoundError):
            mode = stat.S_IMODE(target.stat().st_mode)
        os.close(os.open(beside, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666 if mode is None else 0o600))
        yield beside
        if mode is not None:
            beside.chmod(mode)
        check_free(path, force)
        os.replace(beside, target)
    except OSError as error:
        if error.errno and error.filename in (None, str(beside), str(target)):  # nobody asked for this name
            raise type(error)(error.errno, error.strerror, str(path)) from None
        raise
    finally:
        with suppress(FileNotFoundError, NotADirectoryError):
            beside.unlink()


@contextmanager
def stdout_into(file: str | None, force: bool) -> Iterator[None]:
    """Print into a file, unless it is None or -. Raises OSError."""
    if file in (None, STDOUT):
        yield
        return
    with (
        written_beside(Path(file), force) as beside,
        beside.open("w", encoding="utf-8", newline="") as stream,
        redirect_stdout(stream),
    ):
        yield
