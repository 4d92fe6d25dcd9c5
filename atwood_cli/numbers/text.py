"""Texts as messages show them."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import NamedTuple

EXTRAS = {"matplotlib": "figure", "polars": "batch", "scipy": "fit"}
"""The extras that bring optional packages."""
LONGEST_NAME = 255
"""The most characters of a file name that a message shows."""


def shortened(text: str, most: int = 60) -> str:
    """Return the text as a message shows it: if it is too long, only its beginning and its end."""
    return text if len(text) <= most else f"{text[: most - 20]}...{text[-10:]}"


class Option(NamedTuple):
    """An option that a message names: --find a,b on the command line, find='a,b' in Python."""

    name: str
    value: str = ""


Message = tuple[str | Option, ...]
"""A message in parts, without a capital and a period, so that each door has its own words for options."""


def sentence(message: Message, in_python: bool = False) -> str:
    """Return a message as the command line words it, or as Python does."""
    words = []
    for part in message:
        if isinstance(part, str):
            words.append(part)
        elif in_python:
            words.append(f"{part.name}={part.value!r}" if part.value else part.name)
        else:
            words.append(f"--{part.name} {part.value}".rstrip())
    return "".join(words)


def joined(messages: Iterable[Message], between: str) -> Message:
    """Return messages as one."""
    return sum(((between, *message) for message in messages), Message())[1:]


def in_quotes(value: object) -> str:
    """Return what was typed or read, as a message shows it."""
    return shortened(repr(str(value) if isinstance(value, str) else value))  # not np.str_("hoop")


def counted(count: int, thing: str) -> str:
    """Return a count with its noun: 1 row, 2 rows."""
    return f"{count} {thing}" if count == 1 else f"{count} {thing}s"


def without_blanks(text: str) -> str:
    """Return the text without blanks around it, with single spaces within, and with accents joined (NFC)."""
    text = " ".join(text.split())
    if text.isascii():
        return text
    from unicodedata import normalize

    return normalize("NFC", text)


def nearest(word: str, words: Iterable[str]) -> str:
    """Return a hint at the word that was probably meant, "" if none is near."""
    from difflib import get_close_matches

    words = list(words) if word else []
    close = get_close_matches(word.lower(), words, n=1) or [w for w in words if w.startswith(word.lower())]
    return f"; did you mean {close[0]}?" if close else ""


@contextmanager
def naming_the_extra() -> Iterator[None]:
    """Let the error for an optional package that is missing say how to install it."""
    try:
        yield
    except ModuleNotFoundError as error:
        package = str(error.name).partition(".")[0]
        if package not in EXTRAS:
            raise
        way = f"install it with: pip install 'atwood-cli[{EXTRAS[package]}]'"
        raise ModuleNotFoundError(f"this needs {package}; {way}", name=error.name) from None
