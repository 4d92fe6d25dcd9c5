"""Files that are there whole or not at all."""

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout
from pathlib import Path

STREAM = "-"
"""The name of a file that is stdin or stdout."""


def check_free(path: Path, force: bool) -> None:
    """Raises FileExistsError where a file is there, unless ``force`` lets it be replaced."""
    if path.is_file() and not force:
        raise FileExistsError(errno.EEXIST, "it exists already; --force replaces it", str(path))


@contextmanager
def written_beside(path: Path, force: bool = False) -> Iterator[Path]:
    """A file to write beside ``path``, which takes its name once all went well.

    A run that fails or is killed leaves ``path`` as it was. A file that is there is replaced only by
    ``force``; what is no file (a device, a pipe) is written to directly. Raises OSError.
    """
    if path.exists() and not path.is_file():
        yield path
        return
    check_free(path, force)
    target = path.resolve()  # a link stays a link
    # The suffix stays, for those who tell the format by it.
    beside = target.with_name(f".{target.stem}.{os.getpid()}{target.suffix}")
    try:
        beside.touch()
        yield beside
        os.replace(beside, target)
    except OSError as error:
        if error.filename == str(beside):  # not the name that was asked for
            raise type(error)(error.errno, error.strerror, str(path)) from None
        raise
    finally:
        beside.unlink(missing_ok=True)


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
