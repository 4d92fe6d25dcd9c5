"""What must be in memory to read Parquet, by its footer and the headers of its pages.

pyarrow tells nothing of pages, and ends the process where the footer is damaged in what it tells of a column.
Both are written in the compact protocol of Thrift.
"""

from collections.abc import Iterator, Sequence
from typing import IO, Any, NamedTuple

TEXT, DICTIONARY = 6, 2
"""Of what type a column of texts is, and of what kind a page of values that others refer to."""
DATA = {0: 5, 3: 8}
"""Where it is told how many values are in a page, by the kind of that."""
SMALL_BYTES, HEADER_BYTES = 1 << 16, 1 << 13
"""Of a column whose pages need no look, and the most of the header of a page."""


class Column(NamedTuple):
    """Of a column in a row group: whether it holds texts, how many values, and bytes.

    These are of its pages decoded, of its dictionary, and of the largest page as stored. ``pages`` are the
    values and the bytes of each, decoded; where that cannot be told, all of it is one page.
    """

    is_text: bool
    values: int
    decoded: int
    dictionary: int
    stored: int
    pages: Sequence[tuple[int, int]]

    @property
    def held(self) -> int:
        """What is in memory while it is decoded: a page, and the dictionary twice."""
        page = max((size for _, size in self.pages), default=0)
        return min(page + 2 * self.dictionary, 2 * self.decoded)

    def rows_within(self, limit: int) -> int:
        """The most rows in sequence that are surely in pages of no more bytes than that; at least 1."""
        rows, first, values, size = max(1, self.values), 0, 0, 0
        for count, length in self.pages:
            values += count
            size += length
            while size > limit:
                before, short = self.pages[first]
                rows = min(rows, values - before - count + 1)  # more could begin in the first and end in this
                values, size, first = values - before, size - short, first + 1
        return max(1, rows)


def footer_bytes(source: IO[bytes]) -> int:
    """How long the footer of a file is; 0 if it has none."""
    source.seek(max(0, source.seek(0, 2) - 8))
    size, mark = source.read(4), source.read()
    return int.from_bytes(size, "little") if mark == b"PAR1" else 0


def row_groups(source: IO[bytes]) -> Iterator[tuple[int, list[Column]]]:
    """How many rows each row group of a file has, and its columns. Raises ValueError."""
    size = footer_bytes(source)
    source.seek(-8 - size, 2)
    try:
        for group in _groups(source.read(size)):
            yield int(group[3]), [_column(chunk[3], source) for chunk in group[1]]
    except MALFORMED:
        raise ValueError("its footer is malformed") from None


def _groups(footer: bytes) -> Iterator[dict[int, Any]]:
    """One by one, as all of them may not fit into memory."""
    number, kind, at = _field(footer, 0, 0)
    while number != 4:
        _, at = _value(footer, at, kind)
        number, kind, at = _field(footer, at, number)
    size, of, at = _list(footer, at)
    for _ in range(size):
        group, at = _value(footer, at, of)
        yield group


def _column(about: dict[int, Any], source: IO[bytes]) -> Column:
    values, decoded, stored, start = (int(about[field]) for field in (5, 6, 7, 9))
    start = min(start, int(about.get(11, start)))
    coded = decoded * (11 in about)
    whole = Column(about[1] == TEXT, values, decoded, coded, stored, [(values, decoded)])
    if decoded <= SMALL_BYTES:
        return whole
    pages, dictionary, longest = [], 0, 0
    try:
        for header in _headers(source, start, start + stored):
            kind, size, length = (int(header[field]) for field in (1, 2, 3))
            if kind == DICTIONARY:
                dictionary = size
            else:
                pages.append((int(header[DATA[kind]][1]), size))
            longest = max(longest, length)
    except MALFORMED:
        return whole
    return whole._replace(dictionary=dictionary, stored=longest, pages=pages)


def _headers(source: IO[bytes], start: int, end: int) -> Iterator[dict[int, Any]]:
    """Those of the pages between: their kinds are 1, their lengths 2 decoded and 3 as stored."""
    while start < end:
        source.seek(start)
        header, size = _value(source.read(HEADER_BYTES), 0, STRUCT)
        yield header
        start += size + max(0, header[3])


STRUCT = 12
MALFORMED = (LookupError, OSError, OverflowError, RecursionError, TypeError, ValueError)
"""What reading a malformed value leads to."""


def _value(data: bytes, at: int, kind: int) -> tuple[Any, int]:
    """A value of that type, and where it ends; a structure by the numbers of its fields."""
    match kind:
        case 1 | 2:
            return kind == 1, at
        case 3:
            return data[at], at + 1
        case 4 | 5 | 6:
            number, at = _varint(data, at)
            return number >> 1 ^ -(number & 1), at
        case 7:
            return data[at : at + 8], at + 8
        case 8:
            size, at = _varint(data, at)
            return data[at : at + size], at + size
        case 9:
            size, of, at = _list(data, at)
            values = []
            for _ in range(size):
                value, at = _value(data, at, of)
                values.append(value)
            return values, at
        case 12:
            fields: dict[int, Any] = {}
            number = 0
            while data[at]:
                number, of, at = _field(data, at, number)
                fields[number], at = _value(data, at, of)
            return fields, at + 1
    raise ValueError(f"Parquet has no values of type {kind}")


def _field(data: bytes, at: int, number: int) -> tuple[int, int, int]:
    """The number and the type of the field behind one of that number, and where its value begins."""
    step, kind, at = data[at] >> 4, data[at] & 15, at + 1
    if step:
        return number + step, kind, at
    number, at = _value(data, at, 4)
    return number, kind, at


def _list(data: bytes, at: int) -> tuple[int, int, int]:
    """How many values a list has, of what type, and where the first begins."""
    size, of, at = data[at] >> 4, data[at] & 15, at + 1
    if size == 15:
        size, at = _varint(data, at)
    return size, of, at


def _varint(data: bytes, at: int) -> tuple[int, int]:
    """A number of seven bits a byte, the last of which is below 128, and where it ends."""
    number = shift = 0
    while data[at] > 127:
        number |= (data[at] & 127) << shift
        at, shift = at + 1, shift + 7
    return number | data[at] << shift, at + 1
