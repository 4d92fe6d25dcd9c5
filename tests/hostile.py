"""Tables of text that are hardly any, and what `batch` makes of them, cell for cell: python -m tests.hostile [RUNS [FIRST]]

A table is made from the number of its run, read here character by character, and solved by the paper's formula
for two masses. What comes out must be the same records, in the same order, each with its own result behind it,
whatever the size of the pieces in which they are read; or a refusal, where a quotation mark is out of place.
"""

import json
import re
import sys
from contextlib import redirect_stderr, redirect_stdout
from fractions import Fraction
from io import BytesIO, TextIOWrapper
from random import Random
from unittest.mock import patch

from atwood_cli import cli
from atwood_cli.tables import records, sources

Rows = list[tuple[str, list[str]]]
G = Fraction(9.80665)
LABELS = [
    '"',
    '""',
    '"""',
    '"a"',
    '"a""b"',
    '"x,y;z\tw"',
    '"p\nq"',
    '"p\r\nq"',
    '"\n"',
    "a\rb",
    "\r",
    'a"',
    '5" d',
    '"a"b',
]
LABELS += ["", "", "", " ", "x", "µ", "\u2028", "\x00", "a,b", "\t", ";", "\x85", "#", "m1", "NA"]
LINES = [
    "",
    " ",
    "[1]",
    "x",
    "{}",
    "null",
    '{"m1":1',
    '{"m1":1,"m1":2,"m2":3}',
    '{"m1":NaN,"m2":3}',
    '{"m1":1,"m2":3}}',
    "\xff",
]


def rows_of(text: str, separator: str) -> Rows | None:
    """The records of CSV with their cells, without blank lines; None where one is malformed.

    A quotation mark opens a cell where one begins, and closes it where one ends; elsewhere in a cell that is
    not quoted it stands for itself.
    """
    rows: Rows = []
    record, cells, cell, state = "", [], "", "begin"
    for i, one in enumerate([*text, ""]):
        follows = text[i + 1 : i + 2]
        if state == "quoted":
            if not one:
                return None
            state, cell = ("closed", cell) if one == '"' else (state, cell + one)
        elif one == '"' and state in ("begin", "closed"):
            cell, state = (cell + '"' if state == "closed" else cell), "quoted"
        elif one in (separator, "\n", "") or (one == "\r" and follows in ("\n", "")):
            if one == "\r":
                continue
            cells.append(cell)
            cell, state = "", "begin"
            if one != separator:
                if record.strip() or len(cells) > 1:
                    rows.append((record, cells))
                record, cells = "", []
                continue
        elif state == "closed" or one == "\r":
            return None
        else:
            cell, state = cell + one, "bare"
        record += one
    return rows


def table(random: Random) -> tuple[str, str]:
    """CSV of two masses, numbered columns of labels and a separator, more or less whole."""
    separator, end = random.choice(",,,;\t"), random.choice(["\n", "\n", "\r\n"])
    odd = random.choice([0.0, 0.03, 0.3])
    columns = ["m1", "m2", *random.sample(["n", "o", "p q", '"r\ns"'], random.randint(0, 3))]
    random.shuffle(columns)
    rows = [columns]
    for _ in range(random.choice([0, 1, 3, 10, 40])):
        row = [str(random.randint(0, 9)) if name in ("m1", "m2") else "abc" for name in columns]
        row = [random.choice(LABELS) if random.random() < odd else cell for cell in row]
        if random.random() < odd / 5:
            row = random.choice([row[:-1], row * 2, [], [" "], row[:1]])
        rows.append(row)
    text = end.join(separator.join(row) for row in rows) + end * random.randint(0, 2)
    return random.choice(["", "\ufeff"]) + text, separator


def lines(random: Random) -> list[str]:
    """NDJSON of two masses, more or less whole."""
    odd = random.choice([0.0, 0.03, 0.3])
    made = []
    for _ in range(random.choice([1, 3, 40])):
        row: dict[str, object] = {"m1": random.randint(0, 9), "n": [{"q": '"}'}], "m2": random.randint(0, 9)}
        row |= (
            random.choice([{}, {}, {"m1": None}, {"m2": "x"}, {"M": None}]) if random.random() < odd else {}
        )
        made.append(random.choice(LINES) if random.random() < odd else json.dumps(row))
    return made


def answer(cells: list[str] | None) -> str:
    """The acceleration of two masses in the fewest digits; empty where there is none."""
    if (
        cells is None
        or not all(re.fullmatch(r"\s*\d\s*", cell) for cell in cells)
        or set(map(int, cells)) == {0}
    ):
        return ""
    m1, m2 = map(int, cells)
    return repr(float(G * (m2 - m1) / (m1 + m2)))


def ran(content: bytes, words: str) -> tuple[int, str, str]:
    out, err = (TextIOWrapper(BytesIO(), "utf-8", newline="") for _ in range(2))
    with patch("sys.stdin", TextIOWrapper(BytesIO(content))), redirect_stdout(out), redirect_stderr(err):
        status = cli.run(["batch", "-", "--only", "a", *words.split()])
    printed, said = (stream.detach().getvalue().decode() for stream in (out, err))
    return status, printed, said


def wrong_with_csv(random: Random) -> str:
    """What is wrong with the answer to a table of cells; empty if nothing is."""
    text, separator = table(random)
    status, out, err = ran(text.encode(), "--from tsv" if separator == "\t" else "")
    rows = rows_of(text.removeprefix("\ufeff"), separator)
    refused = not rows or any(len(cells) > len(rows[0][1]) for _, cells in rows)
    if refused or not rows:
        return "" if "cannot read" in err and status == 1 else f"{text!r} was read: {out!r}"
    if out.startswith("\ufeff") != text.startswith("\ufeff"):
        return f"{text!r}: its byte order mark is lost"
    (head, columns), *rest = rows
    wanted = [(head + separator, [*columns, "acceleration", "error"])]
    for record, cells in rest:
        lacking = len(columns) - len(cells)
        masses = None if lacking else [cells[columns.index(name)] for name in ("m1", "m2")]
        wanted.append((record + separator * lacking, [*cells, *[""] * lacking, answer(masses)]))
    got = rows_of(out.removeprefix("\ufeff"), separator) or []
    if len(got) != len(wanted):
        return f"{text!r}: {len(got)} records for {len(wanted)}: {out!r}"
    for (record, cells), (start, begin) in zip(got, wanted, strict=True):
        if separator != ",":  # results have the decimal mark of the table
            cells[-2] = cells[-2].replace(",", ".")
        has_error = bool(cells[-1]) == (begin[-1] == "")
        if (
            not record.startswith(start)
            or cells[: len(begin)] != begin
            or (begin[-1] != "error" and not has_error)
        ):
            return f"{text!r}: {record!r} for {start!r} and {begin}"
    return ""


def wrong_with_ndjson(random: Random) -> str:
    """What is wrong with the answer to lines of objects; empty if nothing is."""
    made = lines(random)
    content = "\n".join(made).encode("latin-1") + b"\n" * random.randint(0, 2)
    _, out, err = ran(content, "--from ndjson")
    made = [line for line in made if line.strip()]
    if not made:
        return "" if "it is empty" in err else f"{content!r} was read"
    got = out.split("\n")[:-1]
    if len(got) != len(made):
        return f"{content!r}: {len(got)} lines for {len(made)}"
    for line, answered in zip(made, got, strict=True):
        result = json.loads(answered)
        try:
            row = json.loads(line, parse_constant=lambda word: 1 / 0)
            whole = isinstance(row, dict) and line.count('"m1"') < 2
        except (ValueError, ZeroDivisionError):
            whole = False
        masses = (
            [str(row.get(name) or "" if row.get(name) != 0 else 0) for name in ("m1", "m2")]
            if whole
            else None
        )
        number = "" if result["acceleration"] is None else repr(result["acceleration"])
        if number != answer(masses) or bool(result["error"]) == bool(number):
            return f"{content!r}: {answered!r} for {line!r}"
        if whole and not answered.startswith(line.removesuffix("}")):
            return f"{content!r}: {line!r} was changed to {answered!r}"
    return ""


def wrong_with(run: int) -> str:
    """What is wrong with the run of that number, and the run itself."""
    random = Random(run)
    size = random.choice([1, 3, 17, 1 << 20])
    with patch.object(sources, "BLOCK", size), patch.object(records, "BLOCK", size):
        wrong = random.choice([wrong_with_csv, wrong_with_csv, wrong_with_ndjson])(random)
    return wrong and f"run {run}, in pieces of {size}: {wrong}"


def main(runs: int = 1000, first: int = 0) -> int:
    faults = [wrong for run in range(first, first + runs) if (wrong := wrong_with(run))]
    print(*faults, f"{runs} runs, {len(faults)} faults", sep="\n")
    return min(len(faults), 1)


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:])))
