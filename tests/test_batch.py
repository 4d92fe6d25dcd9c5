"""Tables of scenes: every format, nothing lost, nothing changed, every error said."""

import csv
import gzip
import io
import json
import re
import subprocess
import sys
from contextlib import redirect_stdout
from fractions import Fraction
from functools import partial
from itertools import count
from pathlib import Path
from random import Random
from typing import Any
from unittest.mock import patch

import polars as pl
import pytest
from hypothesis import given
from hypothesis import strategies as st

from atwood_cli import SceneError, solve, solve_table
from atwood_cli.cli import run
from atwood_cli.reading.units import UNITS
from atwood_cli.tables import sources

from .conftest import examples, many
from .tools.running import (
    FROM,
    HANGS,
    TOP,
    Atwood,
    Batch,
    Ran,
    called,
    on_real_terminal,
    on_terminal,
    plain,
    process,
)

TEXT = "m1,m2\n1,3\n"


def errors_of(ran: Ran) -> list[str]:
    return [row["error"] for row in csv.DictReader(io.StringIO(ran.out, newline=""))]


# Formats

AS_LINES: Any = {"infer_schema_length": None, "schema_overrides": {"error": pl.String}}
KINDS: dict[str, tuple[Any, Any]] = {
    "csv": (pl.DataFrame.write_csv, pl.read_csv),
    "tsv": (partial(pl.DataFrame.write_csv, separator="\t"), partial(pl.read_csv, separator="\t")),
    "ndjson": (pl.DataFrame.write_ndjson, partial(pl.read_ndjson, **AS_LINES)),
    "parquet": (pl.DataFrame.write_parquet, pl.read_parquet),
}
"""How another library writes and reads a table of each kind."""
SCENES = """m1,m2,M,mu,mu_k,g,inertia,R,wrap
1,3,,0.3,,,,,
1,3,10,,,,,,
1,3,100,0.3,0.25,,,,
1,3,inf,,,,,,
2,2,,,,,,,
0.25,.5e0,0.1,1,,1.62,1,0.1,90
"""
REGIMES = ["verge", "no-slip", "slip", "no-slip", "no-slip", "no-slip"]
SUMMARY = "atwood: 6 rows: 4 no-slip (2 assumed, as mu is not given), 1 verge, 1 slip; no errors.\n"


@pytest.mark.parametrize("kind", sources.FORMATS)
def test_every_format(atwood: Atwood, tmp_path: Path, kind: str) -> None:
    frame = pl.read_csv(SCENES.encode(), infer_schema=kind == "parquet")
    start, out = (tmp_path / f"{name}.{kind}" for name in ("in", "out"))
    write, read = KINDS[kind]
    write(frame, start)
    written = f"atwood: wrote {out}\n"
    assert atwood("batch", str(start), "-o", str(out), "--only", "regime") == (0, "", written + SUMMARY)
    result = read(out)
    assert result.columns == [*frame.columns, "regime", "error"]
    assert (result["regime"].to_list(), result["error"].null_count()) == (REGIMES, 6)
    assert result["m1"].cast(pl.Float64).to_list() == [1, 1, 1, 1, 2, 0.25]
    assert list(tmp_path.glob(".*")) == []


@pytest.mark.parametrize(
    ("line", "kind"),
    [("atwood batch <(cat in)", "csv"), ("cat in | atwood batch - --from parquet", "parquet")],
)
def test_streams(tmp_path: Path, line: str, kind: str) -> None:
    """A pipe by any name is CSV, if nothing else is said."""
    write, read = KINDS[kind]
    write(pl.DataFrame({"m1": [1.0], "m2": [3.0]}), tmp_path / "in")
    ran = process(shell=f"cd {tmp_path}; {line} --only regime > out")
    assert ran == (0, "", "atwood: 1 row: 1 no-slip; no errors.\n")
    assert read(tmp_path / "out").rows() == [(1.0, 3.0, "no-slip", None)]


@pytest.mark.parametrize("kind", ["csv", "ndjson", "parquet"])
def test_compressed_files_are_unpacked_by_their_suffix(batch: Batch, tmp_path: Path, kind: str) -> None:
    KINDS[kind][0](pl.DataFrame({"m1": [1.0, -2.0], "m2": [3.0, 1.0]}), tmp_path / "frame")
    content = (tmp_path / "frame").read_bytes()
    packed = gzip.compress(content)
    ran = batch(content, f"-o OUT.{kind} --force", f"in.{kind}")
    whole = (tmp_path / f"out.{kind}").read_bytes()
    assert batch(packed, f"-o OUT.{kind} --force", f"in.{kind}.gz") == ran
    assert (tmp_path / f"out.{kind}").read_bytes() == whole
    for damaged in (packed[:-9], packed + b"x", packed[:-8] + b"wrng" + packed[-4:]):
        assert batch(damaged, "", f"in.{kind}.gz") == (1, "", "atwood: cannot read IN: it is damaged\n")
    unpacked = batch(content, "", f"in.{kind}.gz")
    assert unpacked.err == "atwood: cannot read IN: it is not compressed, though its name ends in .gz\n"


def test_a_pipe_of_ndjson_is_answered_row_by_row() -> None:
    command = [sys.executable, "-m", "atwood_cli", "batch", "-", "--from", "ndjson", "--only", "regime"]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=pipe, encoding="utf-8") as child:
        assert child.stdin
        assert child.stdout
        masses = [f'"m1":1,"m2":{m2}' for m2 in range(4)]
        wrong = "line 1: 'x' is not a line of NDJSON: Expecting value at character 1"
        answers = {"x": f'{{"unreadable":"x","regime":null,"error":"{wrong}"}}'}
        answers |= {f"{{{row}}}": f'{{{row},"regime":"no-slip","error":null}}' for row in masses}
        *first, last = answers
        for line in first:
            child.stdin.write(f"{line}\n")
            child.stdin.flush()
            assert child.stdout.readline() == f"{answers[line]}\n"
        # The last has no line end.
        assert child.communicate(last, HANGS)[0] == f"{answers[last]}\n"


# Bad rows


def test_a_cell_is_a_number_where_solve_takes_it_for_one(batch: Batch) -> None:
    rng = Random(19)
    words = "0e501 0e-501 -0 -0.0e501 0e0000501 1e501 1E-501 1e0000000001 +.5e+05 5. .5 . e 1e 1e+ 1f".split()
    words += "1_0 0x1 inf INF +inf infinity nan NaN \u0663 \uff11 true 1e5e5 1..5 --1 ١".split()
    words += ["1 e5", "\xa01", "1\u2009", f"0.{'0' * 600}1e600", "1" * 1001, f"{'0' * 1001}1"]
    words += [f"1.{'0' * 1000}", f"1{'0' * 300}e-501"]
    words += ["".join(rng.choices("0159.e-+ _", k=rng.randint(1, 9))).strip() or "0" for _ in range(1500)]
    ran = batch("\n".join(["m1,m2,M", *(f"1,3,{word}" for word in words), ""]))
    for word, error in zip(words, errors_of(ran), strict=True):
        try:
            solve(m1=1, m2=3, M=word)
            taken = True
        except SceneError:
            taken = False
        assert taken == (not error) or "has an uncertainty" in error or "is a sum" in error, word


LABELS = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\r"), max_size=4)


@examples(100)
@given(
    st.lists(st.tuples(LABELS, LABELS), min_size=1),
    st.sampled_from(",;\t"),
    st.sampled_from([1 << 20, 1, 17]),
)
def test_cells_come_out_as_they_went_in(labels: list[tuple[str, str]], separator: str, piece: int) -> None:
    """By the standard library's reader, however many bytes are read at a time."""
    table = io.StringIO(newline="")
    rows = [["m1", "m2", "n", "p q"], *(["1", "3", *row] for row in labels)]
    csv.writer(table, delimiter=separator, lineterminator="\n").writerows(rows)
    kind = "tsv" if separator == "\t" else "csv"
    with patch.object(sources, "BLOCK_BYTES", piece):
        ran = called(["batch", "-", "--from", kind, "--only", "a"], table.getvalue().encode())
    came = [*csv.reader(io.StringIO(ran.out, newline=""), delimiter=separator)]
    assert [row[:4] for row in came] == rows
    assert {(a, error) for *_, a, error in came[1:]} == {("4.903325", "")}


# Tables that are none


LONG = "x" * 200_000
"""Python's own reader of CSV takes 131,072 characters at most."""
MANY = ",".join(["m1,m2", *(f"x{i}" for i in range(1022))])
LEFT_OPEN = 'has a quotation mark that is left open or out of place; write it "like ""this"""'


@pytest.mark.parametrize(
    ("content", "why"),
    [
        ('m1,m2\n"1,2\n' + "1,2\n" * 700_000, f"the row that begins in line 2 {LEFT_OPEN}"),
        ("m1,m2\n" + "1" * (4 << 20), "the row that begins in line 2 is longer than 1 MB, the most taken"),
        ("m1," + "1" * (4 << 20), "the row that begins in line 1 is longer than 1 MB, the most taken"),
    ],
    ids=count(),
)  # fmt: skip
def test_what_is_too_large(batch: Batch, tmp_path: Path, content: str, why: str) -> None:
    ran = batch(content, "-o OUT.csv")
    assert (ran.status, ran.out, ran.err) == (1, "", f"atwood: cannot read IN: {why}\n")
    assert [path.name for path in tmp_path.iterdir()] == ["in.csv"]


def test_what_is_large_and_a_table(batch: Batch) -> None:
    assert batch(f"{MANY}\n1,3\n", "--only a").err.endswith("the header has 1024\n")
    head, *rows = f"m1,m2,{LONG}", f"1,3,{LONG}", f'1,3,"{LONG}\n{LONG}"'
    answered = "".join([f"{head},regime,error\n", *(f"{row},no-slip,\n" for row in rows)])
    assert batch("\n".join([head, *rows]), "--only regime").out == answered
    assert batch(f"m1,m2,M ({'kg' * 100_000})\n1,3,7\n", "--only regime").out.endswith("\n1,3,7,no-slip,\n")
    for deep in ("[" * 100_000, f'{{"m1":1,"m2":{"[" * 900}1{"]" * 900}}}'):  # the second took 19 GB
        row = batch(f'{{"m1":1,"m2":3}}\n{deep}', "--only regime", "in.ndjson").out.splitlines()[1]
        assert json.loads(row)["error"].endswith(
            ("it is nested too deeply", "is not a number; write it like 2, 1/3 or 1.5e-3")
        )


def test_one_bad_line_of_ndjson_is_one_bad_row(batch: Batch, tmp_path: Path) -> None:
    """The key error in line 500,001 ended the stream, and 21,573 good rows before it were lost."""
    most, bad = (
        many(1_000_000),
        {"[1]", '{"m1":1,"error":"x"}', '{"id":7,"radius":2}', '{"Mass":1}', '{"m1":1,"m1":2}'},
    )
    lines = [f'{{"id":{i},"m1":1,"m2":{i % 7}}}' for i in range(most)]
    places = dict(zip(sorted(Random(4).sample(range(1, most), 5)), sorted(bad), strict=True))
    for i, line in places.items():
        lines[i] = line
    ran = batch("\n".join(lines), "--only a -o OUT.ndjson", "in.ndjson")
    assert (ran.status, f"{most} rows: {most - 5} no-slip" in ran.err) == (1, True)
    for i, line in enumerate((tmp_path / "out.ndjson").read_text().splitlines()):
        assert line.startswith((lines[i][:-1], '{"unreadable":') if i in places else lines[i][:-1])
        assert (f'"error":"line {i + 1}: ' in line) == (i in places) == ('"error":null' not in line)
    assert i + 1 == most


def test_the_first_error_is_that_of_the_whole_table(batch: Batch, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sources, "BLOCK_BYTES", 8)
    table = "m1,m2\n" + "1,3\n" * 9 + "1,x\n" + "1,3\n" * 8 + "3,1\n1,y\n"
    ran = batch(table, "--only regime --expect a>0")
    assert "atwood: row 19: expected a>0; it is -4.9" in ran.err
    said = "atwood: 20 rows: 18 no-slip; 2 errors.\natwood: first error, in row 10: m2 'x' is"
    assert ran.err.startswith(said)


# Units


@pytest.mark.parametrize("kind", [pl.String, pl.Float64])
@pytest.mark.parametrize("unit", UNITS["mass"])
def test_a_cell_is_the_double_nearest_to_it_in_the_si(unit: str, kind: Any) -> None:
    """It is not a product that was rounded twice: of equal masses, a tension is mg."""
    rng = Random(unit)
    cells = [rng.uniform(0.01, 10) for _ in range(100)]
    kg = Fraction(UNITS["mass"][unit])
    masses = [float(Fraction(repr(cell) if kind == pl.String else cell) * kg) for cell in cells]
    table = pl.DataFrame({f"{name} ({unit})": cells for name in ("m1", "m2")}).cast(kind)
    solved = solve_table(table, ["tension_1", "torque"])
    assert solved["error"].null_count() == 100
    assert solved["tension_1"].to_list() == [float(Fraction("9.80665") * Fraction(mass)) for mass in masses]


def test_a_number_beyond_the_doubles_is_taken_as_solve_takes_it() -> None:
    for unit, cell in (("ug", 1e-323), ("t", 1e308)):
        solved = solve_table(pl.DataFrame({f"m1 ({unit})": [cell, 0.0], "m2": [1.0, 1.0]}), ["a", "T2"])
        exact = solve(Fraction(cell) * Fraction(UNITS["mass"][unit]), 1)
        assert solved.rows()[0][2:] == (exact.acceleration, exact.tension_2, None)


# Usage and files


def test_results_are_not_added_to_the_input(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """They would be read as scenes, and their results, too, without end."""
    scenes = tmp_path / "a.csv"
    scenes.write_text("m1,m2\n1,3\n")
    with scenes.open("a") as out, redirect_stdout(out):
        assert run(["batch", str(scenes)]) == 2
    refused = "atwood: --output '-' is the input, which would grow without end; name another file\n"
    assert (capsys.readouterr().err, scenes.read_text()) == (refused, "m1,m2\n1,3\n")


def test_a_polars_that_is_too_old_or_missing_is_named(batch: Batch, monkeypatch: pytest.MonkeyPatch) -> None:
    (oldest,) = re.findall("polars>=([0-9.]+)", (TOP / "pyproject.toml").read_text(encoding="utf-8"))
    monkeypatch.setattr(pl, "__version__", oldest)
    assert batch(TEXT, "--only a").status == 0
    monkeypatch.setattr(pl, "__version__", "1.9.0")
    why = f"this needs polars {oldest} or newer, not 1.9.0; pip install --upgrade polars"
    assert batch(TEXT) == (1, "", f"atwood: {why}\n")
    with pytest.raises(ImportError, match=re.escape(why)):
        solve_table(pl.DataFrame({"m1": [1.0], "m2": [3.0]}))
    monkeypatch.setitem(sys.modules, "polars", None)
    why = f"this needs polars; install it with: pip install '{FROM}[batch]'"
    assert batch(TEXT) == (1, "", f"atwood: {why}\n")
    with pytest.raises(ImportError, match=re.escape(why)):
        solve_table([])


# How it ends


def test_a_closed_stdin_is_an_error() -> None:
    ran = process(shell="atwood batch - <&-")
    assert ran == (1, "", "atwood: cannot read stdin: it is closed\n")


BAR = """
from itertools import count
from atwood_cli.__main__ import main
from atwood_cli.output import page
from atwood_cli.tables import sources
sources.BLOCK_BYTES = 64
page.monotonic = count().__next__
main()
"""


def test_a_bar_on_a_terminal_after_a_second(tmp_path: Path) -> None:
    (tmp_path / "in.csv").write_text(TEXT + "1,3\n" * 99)
    words = ["batch", f"{tmp_path}/in.csv", "--force", "-o", f"{tmp_path}/out.csv", "--only", "a"]
    said = "atwood: 100 rows: 100 no-slip; no errors.\n"
    written = on_terminal(*words, columns=80).removesuffix(said)
    bar, end = plain(on_real_terminal(*words, columns=80, program=BAR)).split(said)
    assert ("━" in bar, "%" in bar, bool(re.search(r"[1-9]\d? rows ", bar)), end) == (True, True, True, "")
    assert " ".join(written.split()) == f"atwood: wrote {tmp_path}/out.csv"
    for form in ("", " --json"):  # into whose rows a bar would run
        swept = f"sweep --m1 1 --m2 3 --M 1:9:9{form}".split()
        assert ("%" in on_real_terminal(*swept, columns=80, program=BAR)) == (not form)
