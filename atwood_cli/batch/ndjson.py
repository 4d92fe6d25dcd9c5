"""NDJSON, an object a line, read as texts: in bulk where lines are plain, and one by one where not.

A line is plain if its values are numbers, words, and texts without a backslash. Plain lines with the same
keys in the same order match one pattern, by which polars takes them apart; `json` of Python reads the others.
Both give the same: numbers, and values within values, as they are written.
"""

import json
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from itertools import chain
from json.decoder import JSONDecodeError
from typing import TYPE_CHECKING, NamedTuple

from ..files import Unreadable
from ..model.units import in_quotes
from .formats import Inputs, Piece, check_count, check_distinct, decoded, records
from .layout import has_masses
from .parquet import PIECE_CELLS, PIECE_ROWS

if TYPE_CHECKING:
    import polars as pl

MOST_PATTERNS = 8
"""Lines that match none of so many patterns are read one by one."""
FEWEST_LINES = 50
"""To take fewer lines apart by a pattern would take longer."""
MOST_KEYS = 100
"""A pattern for objects with more keys would take long to compile."""
MOST_HELD = 1000
"""Lines that wait for the columns of both masses."""
PLAIN_KEY = re.compile(r'[^"\\\x00-\x1f\ud800-\udfff]*')
BLANKS = r"[ \t\r]*"
TEXT = r'[^"\\\x00-\x1f]*'
BARE = r"-?(?:0|[1-9][0-9]*)(?:\.[0-9]+)?(?:[eE][+-]?[0-9]+)?|true|false"


class Block(NamedTuple):
    """Lines with what was read of them: by pattern frames, each with the places of its lines, or objects."""

    lines: list[str]
    columns: Sequence[str]
    frames: "Sequence[tuple[pl.Series, pl.DataFrame]]"
    objects: Mapping[int, Mapping[str, object]]
    errors: Mapping[int, str]


def read_ndjson(blocks: Iterable[bytes], inputs: Inputs, as_lines: bool) -> Iterator[Piece]:
    """The rows as texts of all columns, or ``as_lines`` and a frame of the ``inputs``. Raises Unreadable.

    A line that is no object is an error of its row. The first rows wait until there are both masses.
    """
    wanted: Inputs = inputs if as_lines else list
    columns: dict[str, None] = {}
    held: list[str] = []
    done = size = 0
    for lines, read in chain(_lines(blocks), [([], 0)]):
        held, size = held + lines if held else lines, size + read
        if not held:
            break
        block = _block(held, wanted)
        new = [name for name in block.columns if name not in columns]
        if new and done and not as_lines:
            how = "for which there is no column by now; give --to ndjson"
            raise Unreadable(f"a row after row {done} has {in_quotes(new[0])}, {how}")
        columns |= dict.fromkeys(new)
        check_count(list(columns))
        if lines and len(held) < MOST_HELD and not has_masses(inputs(list(columns))):
            continue
        if not columns:
            why = [f"row {row + 1}: {error}" for row, error in block.errors.items()]
            raise Unreadable(why[0] if why else "its objects are empty")
        for row in block.errors:
            held[row] = "{}"
        names = wanted(list(columns))
        most = PIECE_CELLS // max(1, len(names))
        for start in range(0, len(held), most):
            rows = range(start, min(start + most, len(held)))
            errors = {row - start: why for row, why in block.errors.items() if row in rows}
            texts = held[start : rows.stop] if as_lines else ()
            yield Piece(list(columns), _frame(block, rows, names), size, errors, lines=texts)
            size = 0
        done += len(held)
        held = []
    if not done:
        raise Unreadable("it is empty")


def _lines(blocks: Iterable[bytes]) -> Iterator[tuple[list[str], int]]:
    """Lines that are not blank, few enough to be objects at once, and the bytes read for them."""
    for text, first, _ in records(blocks, quoted=False):
        lines = list(filter(None, map(str.strip, decoded(text, first).split("\n"))))
        for start in range(0, len(lines), PIECE_ROWS):
            yield lines[start : start + PIECE_ROWS], 0 if start else len(text)


def _block(lines: list[str], wanted: Inputs) -> Block:
    """The lines with the ``wanted`` values of plain ones in frames."""
    import polars as pl

    columns: dict[str, None] = {}
    frames: list[tuple[pl.Series, pl.DataFrame]] = []
    objects: dict[int, Mapping[str, object]] = {}
    errors: dict[int, str] = {}
    texts, left = pl.Series(lines, dtype=pl.String), pl.int_range(len(lines), eager=True)

    def read(place: int) -> list[str]:
        try:
            objects[place] = _object(lines[place])
        except Unreadable as error:
            objects[place], errors[place] = {}, str(error)
        columns.update(dict.fromkeys(objects[place]))  # in order: each line read stands below the last one
        return list(objects[place])

    for _ in range(MOST_PATTERNS):
        if len(left) < FEWEST_LINES:
            break
        keys, left = read(left[0]), left[1:]
        if not 0 < len(keys) <= MOST_KEYS or not all(map(PLAIN_KEY.fullmatch, keys)):
            continue
        names = wanted(keys)
        groups = texts.gather(left).str.extract_groups(_pattern(keys, names)).struct.unnest()
        matching = groups[:, -1].is_not_null()
        frame = groups.filter(matching).select(
            pl.coalesce(pl.nth(2 * i), pl.nth(2 * i + 1)).alias(name) for i, name in enumerate(names)
        )
        frames.append((left.filter(matching), frame))
        left = left.filter(~matching)
    for place in left:
        read(place)
    return Block(lines, list(columns), frames, objects, errors)


def _pattern(keys: Collection[str], wanted: Collection[str]) -> str:
    """What plain lines with those keys match: two groups for each wanted value, and one for the end."""
    values = {True: rf'(?:"({TEXT})"|({BARE})|null)', False: rf'(?:"{TEXT}"|{BARE}|null)'}
    members = [rf'"{re.escape(key)}"{BLANKS}:{BLANKS}{values[key in wanted]}' for key in keys]
    return rf"^\{{{BLANKS}{f'{BLANKS},{BLANKS}'.join(members)}{BLANKS}(\}})$"


def _frame(block: Block, rows: range, wanted: Sequence[str]) -> "pl.DataFrame":
    """The wanted columns of some of the rows. Raises Unreadable."""
    import polars as pl

    schema = dict.fromkeys(wanted, pl.String())
    some = [(place, row) for place, row in block.objects.items() if place in rows]
    cells = {name: [_text(row.get(name), block.lines[place], name) for place, row in some] for name in wanted}
    places = [pl.Series([place for place, _ in some], dtype=pl.Int64)]
    try:
        frames = [pl.DataFrame(cells, schema=schema)]
    except UnicodeEncodeError as error:
        raise Unreadable(f"the key {in_quotes(error.object)} is not Unicode; give --to ndjson") from None
    for at, frame in block.frames:
        start, end = at.search_sorted(rows.start), at.search_sorted(rows.stop)
        places.append(at[start:end])
        frames.append(frame[start:end])
    return pl.concat(frames, how="diagonal")[pl.concat(places).arg_sort()]


def _object(line: str) -> Mapping[str, object]:
    """The object of a line, with numbers as they are written. Raises Unreadable."""
    why = "it is no object"
    try:
        row = _DECODER.decode(line)
        if isinstance(row, dict):
            return row
    except RecursionError:
        why = "it is nested too deeply"
    except JSONDecodeError as error:
        why = f"{error.msg.removesuffix(' at')} at character {error.colno}"
    except Unreadable as error:
        why = str(error)
    raise Unreadable(f"{in_quotes(line)} is not a line of NDJSON: {why}")


def _members(pairs: Sequence[tuple[str, object]]) -> dict[str, object]:
    row = dict(pairs)
    if len(row) < len(pairs):
        check_distinct([name for name, _ in pairs])
    return row


_DECODER = json.JSONDecoder(object_pairs_hook=_members, parse_float=str, parse_int=str, parse_constant=str)


def _text(value: object, line: str, name: str) -> str | None:
    """A value as text: as it is written in its line unless it is text, a number or null."""
    if value is None:
        return None
    if isinstance(value, str):  # halves of surrogate pairs, which UTF-8 does not have, are written as in JSON
        return value if value.isascii() else value.encode(errors="backslashreplace").decode()
    at = line.index("{") + 1
    while True:
        key, at = _value(line, at)
        start = line.index(":", at) + 1
        _, end = _value(line, start)
        if key == name:
            return line[start:end].strip()
        at = line.index(",", end) + 1


def _value(line: str, at: int) -> tuple[object, int]:
    """The JSON value there, after blanks, and where it ends."""
    while line[at] in " \t\r":
        at += 1
    return _DECODER.raw_decode(line, at)
