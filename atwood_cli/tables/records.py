"""The records of CSV: a row, which may have several lines, at the separator that makes most headings."""

import csv
import re
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import suppress
from io import StringIO
from itertools import islice

from ..numbers.text import counted
from .sources import LONGEST_RECORD, Unreadable

SEPARATORS = ",\t;"
MOST_ABOVE = 40
"""The most rows of titles above the headings."""
QUOTATION = 'has a quotation mark that is left open or out of place; write it "like ""this"""'


class GoesOn(Unreadable):
    """A text of CSV ends within a row, or before the first. More of it may help."""


def records_of(text: str, separator: str, line: int = 1) -> Iterator[tuple[int, str, list[str]]]:
    """Yield the rows of CSV that are not blank: the number of the first line, the text, and the cells.

    ``line`` is the number of the text's first line. Raises Unreadable, GoesOn.
    """
    taken: list[str] = []

    def lines() -> Iterator[str]:
        for text_of_line in StringIO(text, newline="\n"):
            taken.append(text_of_line)
            yield text_of_line

    try:
        for cells in csv.reader(lines(), delimiter=separator, strict=True):
            record = "".join(taken)
            if record.strip() or len(cells) > 1:
                yield line, record, cells
            line += len(taken)
            taken.clear()
    except csv.Error as error:
        kind = GoesOn if "end of data" in str(error) else Unreadable
        raise kind(f"the row that begins in line {line} {QUOTATION}") from None


def find_header(text: str, known: Callable[[Sequence[str]], Collection[str]]) -> tuple[int, str, int]:
    """Return how many headings of a table are ``known``, its separator, and the number of rows above them.

    The header is the first row with two known headings, or else one among several cells, or else with most
    words, by the separator that makes most known headings, or else most words.
    """
    csv.field_size_limit(LONGEST_RECORD)
    headers: list[tuple[tuple[int, int, int], int, str, int]] = []
    for separator in SEPARATORS:
        with suppress(csv.Error):
            rows = filter(any, csv.reader(StringIO(text, newline=""), delimiter=separator))
            for above, row in enumerate(islice(rows, MOST_ABOVE + 1)):
                count, words = len(known(row)), sum(bool(re.search(r"[^\W\d_]", cell)) for cell in row)
                is_known = count > 1 or sum(map(bool, row)) > 1  # a title may have the name of a quantity
                headers.append(((count if is_known else 0, words, len(row)), count, separator, above))
                if count > 1:
                    break
    return max(headers, key=lambda header: header[0], default=(0, 0, SEPARATORS[0], 0))[1:]


def wrong_width(cells: int, width: int, separator: str) -> str:
    """Say that a row has more or fewer cells than the header, with the usual cause."""
    hint = ""
    if cells > width and separator == ",":
        hint = "; is there a decimal comma (write a point), or a comma at the end of the row?"
    return f"has {counted(cells, 'cell')}; the header has {width}{hint}"
