"""Files and pipes of tables are opened and unpacked. A file of another kind is refused by its name."""

import gzip
import os
import re
import sys
import zlib
from codecs import getincrementaldecoder
from collections.abc import Iterator
from contextlib import ExitStack, suppress
from functools import partial
from io import IncrementalNewlineDecoder
from itertools import chain
from pathlib import Path
from select import select
from time import monotonic
from typing import IO, Any

from ..numbers.text import LONGEST_NAME, in_quotes, shortened
from ..reading.names import read_name
from ..solver.scene import SceneError

FORMATS = ("csv", "tsv", "ndjson", "parquet")
"""The formats of tables, each by its file suffix."""
STDIN = "-"
"""The name of a file that is standard input."""
WORKBOOKS = (".xlsx", ".xlsm", ".ods")
SUFFIXES = {f".{kind}": kind for kind in FORMATS} | {".jsonl": "ndjson"} | dict.fromkeys(WORKBOOKS, "csv")
BLOCK_BYTES = 2 << 20
"""The bytes that are read at a time. A piece of a table takes several times as much memory."""
UTF_16_MARKS = (b"\xff\xfe", b"\xfe\xff")
"""The first bytes of a file in UTF-16, as Excel writes its "Unicode text"."""
GZIP_MARK = b"\x1f\x8b"
MOMENT = 0.05  # seconds
LONGEST_RECORD = 1 << 20
"""The bytes of the longest record: an open quotation mark must not make one of the whole file."""
TOO_LONG = f"is longer than {LONGEST_RECORD >> 20} MB, the most taken"
FOREIGN = {
    rb"\x1f\x8b|BZh|\xfd7zXZ|\x28\xb5\x2f\xfd": "compressed; unpack it first",
    rb"PK\x03\x04|\xd0\xcf\x11\xe0": "a workbook or an archive; give a workbook by its name, .xlsx or .ods",
    rb"\xff\xfe\0\0|.?\0": "in UTF-16 or UTF-32; save it as UTF-8",
    rb"PAR1": "Parquet; batch reads it with --from parquet, and fit reads CSV",
    rb"\[[{\n]": "a JSON array; write an object a line (jq -c '.[]'), and give --from ndjson to batch",
    rb"\{\s*\n": "JSON in several lines; write an object a line (jq -c .), and give --from ndjson to batch",
}
"""Files of other kinds: the patterns of their first bytes, their names, and the way to use them."""
FOREIGN_TO_JSON = {rb"\xff\xfe|\xfe\xff": "in UTF-16; save it as UTF-8"}
FOREIGN_TO_CSV = {rb'\{"': "NDJSON; batch reads it with --from ndjson, and fit reads CSV"}


class Unreadable(Exception):
    """A table cannot be read; the message says why."""


def read_format(given: str | None, path: str) -> str:
    """Return the format named, or else the format of the suffix; CSV for a stream, a pipe or a device.

    A packed file has two suffixes, of which the first counts. Raises SceneError.
    """
    if given is not None:
        return read_name("from", given, FORMATS, "format", {})
    name = Path(path).with_suffix("") if is_packed(path) else Path(path)
    if suffix := SUFFIXES.get(name.suffix.lower()):
        return suffix
    if is_stream(path):
        return "csv"
    raise SceneError("from", None, f"is needed: {in_quotes(path)} ends in none of {', '.join(SUFFIXES)}")


def check_format(path: str, kind: str) -> None:
    """Refuse a file whose suffix does not fit the format that is written. Raises SceneError."""
    suffix = Path(path).suffix.lower()
    fits = suffix == f".{kind}" or (SUFFIXES.get(suffix) == kind and suffix not in WORKBOOKS)
    if suffix and not fits and not is_stream(path):
        raise SceneError("output", path, f"must end in .{kind}, as the results are written in that format")


def is_stream(path: str) -> bool:
    """Return whether the path leads to stdin, stdout, a pipe or a device, not to a file."""
    return path == STDIN or (os.path.exists(path) and not (os.path.isfile(path) or os.path.isdir(path)))


def is_packed(path: str) -> bool:
    """Return whether a file is compressed, by its suffix."""
    return Path(path).suffix.lower() == ".gz"


def opened(source: str, stack: ExitStack) -> IO[bytes]:
    """Return the file of that name, unpacked if it is compressed, or stdin. Raises Unreadable."""
    if source == STDIN:
        if sys.stdin is None:
            raise Unreadable("it is closed")
        return sys.stdin.buffer
    try:
        opener: Any = open
        file: Any = stack.enter_context(opener(source, "rb"))
        if is_packed(source):
            if file.peek(2)[:2] != GZIP_MARK:
                raise Unreadable("it is not compressed, though its name ends in .gz")
            file = gzip.GzipFile(fileobj=file)
        unpacked: IO[bytes] = file
        return unpacked
    except OSError as error:
        raise Unreadable(str(error.strerror)) from None


def cannot_read(source: str, why: Unreadable) -> OSError:
    """Return the error for a file, or stdin, that is no table."""
    name = "stdin" if source == STDIN else shortened(source, LONGEST_NAME)
    return OSError(f"cannot read {name}: {why}")


def blocks_of(file: IO[bytes]) -> Iterator[bytes]:
    """Yield the bytes of a file or a pipe in blocks; a pipe waits a moment at most. Raises Unreadable."""
    read = file.read if file.seekable() else partial(_what_comes, file)
    while True:
        try:
            block = read(BLOCK_BYTES)
        except (OSError, EOFError, zlib.error) as error:
            why = error.strerror if isinstance(error, OSError) else None
            raise Unreadable(why or "it is damaged") from None
        if not block:
            return
        yield block


def _what_comes(pipe: Any, most: int) -> bytes:
    """Return the bytes that come through a pipe within a moment, after the first; none at its end."""
    block: bytes = pipe.read1(most)
    end = monotonic() + MOMENT
    with suppress(OSError):  # on Windows, only sockets can be asked
        while block and len(block) < most and select([pipe], [], [], max(0, end - monotonic()))[0]:
            if not (more := pipe.read1(most)):
                break
            block += more
    return block


def whole_lines(blocks: Iterator[bytes], is_csv: bool, remarks: list[str]) -> Iterator[bytes]:
    """Yield blocks of whole lines in UTF-8. Raises Unreadable for a file that is no CSV, or else no NDJSON.

    The encoding of CSV, if it is another, is added to the remarks.
    """
    first, rest, line = next(blocks, b""), b"", 1
    for pattern, kind in (FOREIGN | (FOREIGN_TO_CSV if is_csv else FOREIGN_TO_JSON)).items():
        if re.match(pattern, first.removeprefix(b"\xef\xbb\xbf"), re.DOTALL):
            raise Unreadable(f"it is {kind}")
    texts = _in_utf8(first, blocks, remarks) if is_csv else chain([first], blocks)
    for block in chain(texts, [b""]):
        rest += block
        end = rest.rfind(b"\n") + 1 if block else len(rest)
        if end:
            yield rest[:end]
            line += rest.count(b"\n", 0, end)
            rest = rest[end:]
        if len(rest) > LONGEST_RECORD:
            raise Unreadable(f"the row that begins in line {line} {TOO_LONG}")


def _in_utf8(first: bytes, blocks: Iterator[bytes], remarks: list[str]) -> Iterator[bytes]:
    """Yield a text in UTF-8, with a line feed for each carriage return that has none.

    The first block tells UTF-16, by its mark, from UTF-8, and from Windows-1252. Raises Unreadable.
    """
    encoding = "UTF-16" if first.startswith(UTF_16_MARKS) else "UTF-8"
    try:
        getincrementaldecoder(encoding)().decode(first)
    except UnicodeDecodeError:
        encoding = "cp1252"
        remarks.append("text in Windows-1252")
    errors = "replace" if encoding == "cp1252" else "strict"
    decoder = IncrementalNewlineDecoder(getincrementaldecoder(encoding)(errors), translate=False)
    try:
        for block in chain([first], blocks, [b""]):
            if text := decoder.decode(block, final=not block):
                yield (re.sub("\r(?!\n)", "\n", text) if "\r" in text else text).encode()
    except UnicodeDecodeError:
        raise Unreadable(f"it is not {encoding}, though it begins so; save it as UTF-8") from None
