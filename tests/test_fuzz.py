"""Whatever is typed or read, promises hold; python -m tests.test_fuzz 100000 tries so many of each kind.

A run ends within the limits, without a traceback or a warning, with a status of ours, with stdout empty on an
error and with sentences on stderr. A table comes out with the records that went in, cell for cell, each with its
own result behind it. What is read steers no terminal, and nothing long is repeated whole. Hypothesis makes what
fails as small as it can, and tries it first the next time.
"""

import json
import re
import sys
import warnings
from contextlib import chdir
from datetime import timedelta
from itertools import product
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time
from unicodedata import category
from unittest.mock import patch

import pytest
from hypothesis import given, settings

from atwood_cli.tradeoff import measure

from .conftest import many
from .tools import fuzz
from .tools.running import called

BUSY = timedelta(minutes=1)  # for any run, on a busy machine
MOST_SAID = 2000  # characters of a sentence


# What is typed


def check_run(run: fuzz.Run) -> None:
    """What is promised of a run in a folder with its file; measurements are short, every warning is shown.

    A result may stand beside status 1: a part, where rows, values or fits failed, or one that was not expected.
    """
    short = patch.multiple(measure, FEWEST_ROWS=1, REPEATS=1, MOST_SCENES=20, MOST_ROWS=2)
    with TemporaryDirectory() as folder, chdir(folder), short, warnings.catch_warnings():
        warnings.simplefilter("always")
        Path("in.csv").touch()
        Path(run.source).write_bytes(run.content)
        words, ran = run.words, called(run.words, Path("in.csv").read_bytes())
    assert ran.status in (0, 1, 2, 130)
    partly = words[0] in ("batch", "fit") or {"--only", "--expect"} & {*words}
    assert not ran.out or ran.status == 0 or (ran.status == 1 and partly), "stdout beside an error"
    # A table that is not understood is listed below its error, indented.
    said = [line for line in ran.err.splitlines() if not re.match("  |$", line)]
    assert [line for line in said if not re.match("atwood: .", line)] == []
    # The page of a fit says itself why there is no result.
    explained = ran.err or (words[0] == "fit" and ran.out)
    assert explained or not ran.status, "an error without a word"
    assert "\x1b" not in ran.err
    assert max(map(len, ran.err.splitlines()), default=0) <= MOST_SAID
    if words[0] != "batch" and not {"--csv", "--markdown"} & {*words}:
        assert {c for c in ran.out if category(c) in ("Cc", "Cf")} <= {"\n"}, "it steers a terminal"
    elsewhere = {"-h", "--help", "-o", "--output", "--version"} & {*words}
    if words[0] != "batch" and ran.status == 0 and "--json" in words and not elsewhere:
        json.loads(ran.out, parse_constant=lambda word: 1 / 0)


# Long texts

LONG = 10_000
CELLS = ["m1,m2\nLONG,3\n", "m1,LONG\n1,3\n", 'm1,m2,n\n1,3,"LONG\n', "LONG"]
HELD = [
    *product(["batch -", "fit -"], CELLS),
    *product(["batch - --from ndjson"], ['{"m1":"LONG","m2":3}\n', "LONG"]),
]


@pytest.mark.parametrize("unit", ["9", " ", "(", "1/", "1(2)", "1,", "a_", "pi", '"', "kg*", "m1 in "])
def test_a_long_text_in_a_file_takes_no_long_time(unit: str) -> None:
    """Eleven kinds, wherever a pattern meets what a file holds; what is typed stands in `test_terminal`."""
    for command, content in HELD:
        begun = process_time()
        called(command.split(), content.replace("LONG", (unit * LONG)[:LONG]).encode())
        assert process_time() - begun < 1, command  # 10,000 characters took some patterns minutes


RUNS = {"solve": 400, "contact": 160, "sweep": 200, "batch": 280, "fit": 280, "tradeoff": 20}
"""How many of each command are tried with --every-digit; otherwise a quarter."""


def try_many(command: str, count: int) -> None:
    settings(max_examples=count, deadline=BUSY)(given(fuzz.runs(command))(check_run))()


@pytest.mark.parametrize("command", RUNS)
def test_nothing_that_is_typed_or_read_breaks_a_promise(command: str) -> None:
    try_many(command, many(RUNS[command]))


if __name__ == "__main__":
    settings.load_profile("every-digit")
    for command in RUNS:
        try_many(command, int(sys.argv[1]))
