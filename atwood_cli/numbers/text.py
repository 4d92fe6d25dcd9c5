"""Texts as messages show them."""

from collections.abc import Iterable

LONGEST_NAME = 255
"""The most characters of a file name that a message shows."""


def shortened(text: str, most: int = 60) -> str:
    """Return the text as a message shows it: if it is too long, only its beginning and its end."""
    return text if len(text) <= most else f"{text[: most - 20]}...{text[-10:]}"


def in_quotes(value: object) -> str:
    """Return what was typed or read, as a message shows it."""
    words = repr(str(value)) if isinstance(value, str) else " ".join(repr(value).split())
    return shortened(words)  # not np.str_("hoop")


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
    """Return a hint at the words probably meant, those that begin so, or else one; "" if none is near."""
    from difflib import get_close_matches

    word, words = word.lower(), list(words) if word else []
    close = [longer for longer in words if longer.startswith(word)][:3] or get_close_matches(word, words, n=1)
    return f"; did you mean {' or '.join(close)}?" if close else ""
