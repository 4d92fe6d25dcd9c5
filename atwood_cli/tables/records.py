"""The records of CSV: a row, which may have several lines, at the separator that makes most headings."""

import csv
import re
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import suppress
from io import StringIO
from itertools import islice, pairwise
from typing import NamedTuple

from ..numbers.text import counted, without_blanks
from .headings import are_units
from .sources import LONGEST_RECORD, Unreadable

SEPARATORS = ",\t;|"
MOST_ABOVE = 40
"""The most rows of titles above the headings."""
LIKE_NUMBER = re.compile(r"\s*[-+±]?[.,]?\d+(?!\d|st|nd|rd|th)")
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


class Layout(NamedTuple):
    """The separator of a table, the rows above its headings, those of headings, and how many are known."""

    separator: str
    above: int
    heads: int
    known: int = 0

    def headings(self, rows: Sequence[Sequence[str]], width: int) -> list[str]:
        """Return the headings in the first of these rows: cells below each other are one.

        A cell above others holds to the right over blank ones, as a merged one does.
        """
        *upper, last = [
            [*row, *[""] * width][:width] for row in rows[self.above : self.above + self.heads]
        ] or [[""] * width]
        for row in upper:
            for place in range(1, width):
                if last[place].strip() and not row[place].strip():
                    row[place] = row[place - 1]
        columns = (
            [cell for cell in cells if cell.strip() != "-"] for cells in zip(*upper, last, strict=True)
        )
        return [without_blanks(" ".join(cells)) for cells in columns]

    def above_headings(self, rows: Sequence[Sequence[str]]) -> list[str]:
        """Return the cells above the last row of headings."""
        return [cell for row in rows[: self.above + self.heads][:-1] for cell in row]


def find_header(
    text: str, known: Callable[[Sequence[str]], Collection[str]], decisive: Collection[int] = ()
) -> Layout:
    """Find the headings of a table, and its separator, by which most are known, or else are words.

    The header is the first row with two that are ``known``, or else one among several cells, or else with
    most words; a row of units below belongs to it. With ``decisive`` columns, it is the last row of words
    there above the numbers, perhaps none. If fewer than two are known, so do further rows of words.
    """
    csv.field_size_limit(LONGEST_RECORD)
    lines = [line for line in islice(StringIO(text), MOST_ABOVE) if line.strip()]
    usual = next((x for x in SEPARATORS[1:] if 2 * sum(x in line for line in lines) > len(lines)), ",")
    if decisive:
        rows = [cells for *_, cells in islice(records_of(text, usual), MOST_ABOVE) if any(cells)]
        read = [[row[x].strip() for x in decisive if x < len(row)] for row in rows]
        counts = [sum(bool(LIKE_NUMBER.match(cell)) for cell in cells) for cells in read]
        if not any(counts):
            raise GoesOn("it has no numbers in the columns that --columns reads")
        full = counts.index(max(counts))
        worded = [i for i, count in enumerate(counts[:-1]) if not count and all(read[i])]
        heads = [i for i in worded if i < full] or [i for i in worded if i == full + 1]  # below a title
        first = heads[-1] + 1 if heads else next(i for i, count in enumerate(counts) if count)
        while not counts[first] and _has_words(rows[first]):
            first += 1
        above = max(first - 1, 0)
        above -= above > 0 and _has_words(rows[above - 1])
        return Layout(usual, above, first - above)
    headers: list[tuple[tuple[int, ...], Layout]] = []
    for separator in SEPARATORS:
        with suppress(csv.Error):
            table = filter(any, csv.reader(StringIO(text, newline=""), delimiter=separator))
            rows = [*islice(table, MOST_ABOVE + 2)]
            is_even = 2 * sum(len(row) == len(below) > 1 for row, below in pairwise(rows)) > len(rows) - 1
            for place, row in enumerate(rows[:MOST_ABOVE]):
                count, words = len(known(row)), sum(bool(re.search(r"[^\W\d_]", cell)) for cell in row)
                if place and are_units(row) and _has_words(rows[place - 1]):
                    continue
                is_known = count > 1 or sum(map(bool, row)) > 1  # a title may have the name of a quantity
                rank = count if is_known else 0, is_even, words, separator == usual, len(row)
                last = place
                if words and count < 2 and rows[place + 2 :] and _has_words(rows[place + 1]):
                    last += 1
                if words and rows[last + 1 :] and are_units(rows[last + 1]):
                    last += 1
                above = place - (place > 0 and count < 2 and _has_words(rows[place - 1]))
                headers.append((rank, Layout(separator, above, last + 1 - above if words else 0, count)))
                if count > 1:
                    break
    return max(headers, key=lambda header: header[0], default=((), Layout(SEPARATORS[0], 0, 1)))[1]


def _has_words(row: Sequence[str]) -> bool:
    """Decide whether a row has cells beside the first, and no number, as headings have, and no title has."""
    return any(map(str.strip, row[1:])) and not any(map(LIKE_NUMBER.match, row))


def wrong_width(cells: int, width: int, separator: str) -> str:
    """Say that a row has more or fewer cells than the header, with the usual cause."""
    hint = ""
    if cells > width and separator == ",":
        hint = "; is there a decimal comma (write a point), or a comma at the end of the row?"
    return f"has {counted(cells, 'cell')}; the header has {width}{hint}"
