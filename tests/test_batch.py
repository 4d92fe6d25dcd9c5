"""Tables of scenes: every format, nothing lost, nothing changed, every error said."""

import bz2
import csv
import gzip
import io
import json
import lzma
import math
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from datetime import timedelta
from fractions import Fraction
from pathlib import Path
from random import Random
from typing import Any

import polars as pl
import pytest
from hypothesis import given
from hypothesis import strategies as st

from atwood_cli import SceneError, solve
from atwood_cli.arrays import solve_and_count
from atwood_cli.batch import formats as tables
from atwood_cli.batch.layout import inputs_among
from atwood_cli.files import FORMATS
from atwood_cli.model.quantities import NAMES, STANDARD
from atwood_cli.model.scene import COLUMNS

from .conftest import examples
from .running import HANGS, PIP, Atwood, Ran, plain, process

SCENES = [
    {"m1": "1", "m2": "3", "mu": "0.3"},
    {"m1": "1", "m2": "3", "M": "10"},
    {"m1": "1", "m2": "3", "M": "100", "mu": "0.3", "mu_k": "0.25"},
    {"m1": "1", "m2": "3", "M": "inf"},
    {"m1": "2", "m2": "2"},
    {
        "m1": "0.25",
        "m2": ".5e0",
        "M": "0.1",
        "mu": "1",
        "g": "1.62",
        "inertia": "1",
        "R": "0.1",
        "wrap": "90",
    },
]
REGIMES = ["verge", "no-slip", "slip", "no-slip", "no-slip", "no-slip"]
SUMMARY = "atwood: 6 rows: 4 no-slip, 1 verge, 1 slip; no errors.\n"

NEEDS_MU = "atwood: critical_pulley_mass: give mu, the friction coefficient.\n"

Table = Callable[..., str]


@pytest.fixture
def table(tmp_path: Path) -> Table:
    """A file of that name with those bytes; its path."""

    def write(content: bytes | str, name: str = "in.csv") -> str:
        path = tmp_path / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return str(path)

    return write


def as_csv(rows: list[dict[str, str]], columns: tuple[str, ...] = COLUMNS) -> str:
    out = io.StringIO()
    writer = csv.DictWriter(out, columns, restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return out.getvalue()


def records(ran_or_text: Ran | str) -> list[dict[str, str]]:
    text = ran_or_text if isinstance(ran_or_text, str) else ran_or_text.out
    return list(csv.DictReader(io.StringIO(text, newline="")))


def near(value: float, exact: float) -> bool:
    """Within 4 units in the last place."""
    return abs(value - exact) <= 4 * math.ulp(exact)


def doubles(scene: dict[str, str]) -> dict[str, Any]:
    return {name: float(text) for name, text in scene.items() if text and name in COLUMNS}


# Results


def test_results_are_those_of_solve(atwood: Atwood, table: Table) -> None:
    only = [word for name in NAMES for word in ("--only", name)]
    ran = atwood("batch", table(as_csv(SCENES)), *only)
    assert ran.status == 0
    assert ran.err.startswith(SUMMARY)
    for scene, row in zip(SCENES, records(ran), strict=True):
        solution = solve(**doubles(scene))
        assert row["regime"] == solution.regime
        for name in NAMES[1:]:
            exact = getattr(solution, name)
            assert (row[name] == "") == (exact is None), name
            assert exact is None or near(float(row[name]), exact), name


def test_why_valid_rows_lack_results_is_said(atwood: Atwood, table: Table) -> None:
    ran = atwood("batch", table("m1,m2,M,mu\n5,8,,0.87\n"))
    assert ran.err == (
        "atwood: 1 row: 1 no-slip; no errors.\n"
        "atwood: acceleration, tension_1, tension_2, mu_verge, friction_force:"
        " give M, the pulley's mass, which decides here.\n"
        "atwood: critical_pulley_mass: does not exist, as the string holds on any pulley, however heavy.\n"
    )
    bad = "m1,m2,M,mu\n5,8,,0.87\n5,8,x,0.87\n5,8,10,0.01\n5,8,10\n,8,,\n"
    only = ["--only", "acceleration", "--only", "regime", "--only", "torque"]
    ran = atwood("batch", table(bad), *only)
    assert ran.err == (
        "atwood: 5 rows: 1 no-slip, 1 slip; 3 errors.\n"
        "atwood: acceleration, torque: give M, the pulley's mass, which decides here (in 1 of 5 rows).\n"
        "atwood: torque: give R, the pulley's radius (in 1 of 5 rows).\n"
        "atwood: first error, in row 2: M 'x' is not a number; write it like 2, 0.5 or 1.5e-3\n"
    )


def test_the_seven_standard_results_and_the_error_are_appended(atwood: Atwood, table: Table) -> None:
    ran = atwood("batch", table(as_csv(SCENES)))
    assert list(records(ran)[0]) == [*COLUMNS, *STANDARD, "error"]
    assert [row["regime"] for row in records(ran)] == REGIMES
    assert [row["error"] for row in records(ran)] == [""] * 6


def test_only_picks_and_orders_results(atwood: Atwood, table: Table) -> None:
    words = ["--only", "tension_2", "--only", "regime", "--only", "tension_2"]
    ran = atwood("batch", table("m1,m2\n1,1\n"), *words)
    assert ran.out == "m1,m2,tension_2,regime,error\n1,1,9.80665,no-slip,\n"


@pytest.mark.parametrize("accuracy", ["fast", "certified", "exact"])
def test_every_accuracy_is_handed_on(
    atwood: Atwood, table: Table, monkeypatch: pytest.MonkeyPatch, accuracy: str
) -> None:
    asked = []

    def spy(given: Any, accuracy: Any, names: Any) -> Any:
        asked.append(accuracy)
        return solve_and_count(given, accuracy, names)

    monkeypatch.setattr("atwood_cli.batch.run.solve_and_count", spy)
    assert atwood("batch", table(as_csv(SCENES)), "--accuracy", accuracy).status == 0
    assert set(asked) == {accuracy}


def test_values_beyond_the_doubles_are_empty_and_counted(atwood: Atwood, table: Table) -> None:
    scene = table("m1,m2\n1e308,1e308\n1,1\n")
    ran = atwood("batch", scene, "--only", "tension_1", "--only", "tension_2")
    assert ran.out == "m1,m2,tension_1,tension_2,error\n1e308,1e308,,,\n1,1,9.80665,9.80665,\n"
    assert "; 2 values beyond the range of doubles left empty." in ran.err
    assert '"tension_1":null' in atwood("batch", scene, "--to", "ndjson").out


def test_empty_cells_are_not_given(atwood: Atwood, table: Table) -> None:
    ran = atwood("batch", table('m1,m2,M,g,wrap,inertia\n1,3,10,,,""\n1,3, ,,,\n'), "--only", "acceleration")
    given, without = (float(row["acceleration"]) for row in records(ran))
    assert near(given, 2.1792555555555555)
    assert near(without, 4.903325)


# Formats


@pytest.mark.parametrize("target", FORMATS)
@pytest.mark.parametrize("source", FORMATS)
def test_every_format_into_every_format(
    atwood: Atwood, tmp_path: Path, table: Table, source: str, target: str
) -> None:
    frame = pl.read_csv(as_csv(SCENES).encode(), infer_schema=False)
    start, out = tmp_path / f"in.{source}", tmp_path / f"out.{target}"
    {
        "csv": lambda: frame.write_csv(start),
        "tsv": lambda: frame.write_csv(start, separator="\t"),
        "ndjson": lambda: frame.write_ndjson(start),
        "parquet": lambda: frame.cast(pl.Float64).write_parquet(start),
    }[source]()
    ran = atwood("batch", str(start), "-o", str(out), "--only", "regime")
    assert (ran.status, ran.out, ran.err) == (0, "", SUMMARY)
    result = {
        "csv": lambda: pl.read_csv(out),
        "tsv": lambda: pl.read_csv(out, separator="\t"),
        "ndjson": lambda: pl.read_ndjson(out, infer_schema_length=None),
        "parquet": lambda: pl.read_parquet(out),
    }[target]()
    assert result.columns == [*COLUMNS, "regime", "error"]
    assert result["regime"].to_list() == REGIMES
    assert result["error"].null_count() == 6
    assert result["m1"].cast(pl.Float64).to_list() == [1, 1, 1, 1, 2, 0.25]
    assert list(tmp_path.glob(".*")) == []


@pytest.mark.parametrize("source", FORMATS)
def test_streams(tmp_path: Path, source: str) -> None:
    frame = pl.DataFrame({"m1": [1.0], "m2": [3.0]})
    path = tmp_path / "in"
    {
        "csv": lambda: frame.write_csv(path),
        "tsv": lambda: frame.write_csv(path, separator="\t"),
        "ndjson": lambda: frame.write_ndjson(path),
        "parquet": lambda: frame.write_parquet(path),
    }[source]()
    given = f"--from {source} --to {source}" if source != "csv" else ""
    ran = process(shell=f"cat {path} | atwood batch - {given} --only regime > {tmp_path}/out")
    assert (ran.status, ran.err) == (0, "atwood: 1 row: 1 no-slip; no errors.\n")
    out = tmp_path / "out"
    result = {
        "csv": lambda: pl.read_csv(out),
        "tsv": lambda: pl.read_csv(out, separator="\t"),
        "ndjson": lambda: pl.read_ndjson(out, schema_overrides={"error": pl.String}),
        "parquet": lambda: pl.read_parquet(out),
    }[source]()
    assert result.rows() == [(1.0, 3.0, "no-slip", None)]


def test_jsonl_is_ndjson(atwood: Atwood, table: Table) -> None:
    ran = atwood("batch", table('{"m1":1,"m2":3}', "in.jsonl"), "--only", "regime")
    assert ran.out == "m1,m2,regime,error\n1,3,no-slip,\n"


def test_bom_crlf_and_blank_lines_at_the_ends(atwood: Atwood, table: Table) -> None:
    ran = atwood("batch", table("\ufeffm1,m2\r\n1,3\r\n\r\n\r\n"), "--only", "regime")
    assert (ran.out, ran.status) == ("m1,m2,regime,error\n1,3,no-slip,\n", 0)
    ran = atwood("batch", table('\ufeff{"m1":1,"m2":3}\r\n', "in.ndjson"), "--only", "regime")
    assert (ran.out, ran.status) == ("m1,m2,regime,error\n1,3,no-slip,\n", 0)


def test_a_header_alone_is_an_empty_table(atwood: Atwood, table: Table) -> None:
    for text in ("m1,m2\n", "m1,m2"):
        ran = atwood("batch", table(text), "--only", "regime")
        assert (ran.status, ran.out, ran.err) == (0, "m1,m2,regime,error\n", "atwood: 0 rows: no errors.\n")


# Nothing is changed

ODD_TEXT = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"), max_size=8) | st.text(
    ",\"\n\t ;'\\x", max_size=6
)


@pytest.mark.parametrize("kind", ["csv", "tsv"])
@given(cells=st.lists(st.tuples(ODD_TEXT, ODD_TEXT), max_size=12), size=st.sampled_from([16, 64, 1 << 20]))
@examples(60)
def test_other_columns_pass_through(
    atwood: Atwood, table: Table, kind: str, cells: list[tuple[str, str]], size: int
) -> None:
    separator = {"csv": ",", "tsv": "\t"}[kind]
    out = io.StringIO(newline="")
    # With this line end, Python quotes a lone \r too, which is one at the end of a row otherwise.
    writer = csv.writer(out, delimiter=separator, lineterminator="\r\n")
    writer.writerows([["one", "m1", "m2", "two"], *((a, "1.0", "003", b) for a, b in cells)])
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tables, "PIECE_BYTES", size)
        path = table(out.getvalue(), f"in.{kind}")
        ran = atwood("batch", path, "--to", kind, "--only", "regime")
    assert ran.err == f"atwood: {len(cells)} row{'s' * (len(cells) != 1)}: " + (
        f"{len(cells)} no-slip; no errors.\n" if cells else "no errors.\n"
    )
    printed = list(csv.reader(io.StringIO(ran.out, newline=""), delimiter=separator))
    assert printed == [
        ["one", "m1", "m2", "two", "regime", "error"],
        *([a, "1.0", "003", b, "no-slip", ""] for a, b in cells),
    ]


def test_plain_cells_come_out_byte_for_byte(atwood: Atwood, table: Table) -> None:
    lines = ["id,m1,m2,note", "007,1.10,+3e0,", '1e5, 1 ,3,""', '"a,b",.5,1E0,"say ""hi"""', "é,1,3,x y"]
    ran = atwood("batch", table("\n".join(lines)), "--only", "regime")
    assert ran.out.splitlines() == [f"{lines[0]},regime,error", *(f"{line},no-slip," for line in lines[1:])]


def test_ndjson_lines_come_out_byte_for_byte(atwood: Atwood, table: Table) -> None:
    lines = [
        '{"id": 1, "m1": 1.0, "m2": 3e0, "tags": [1, "x", {"q": 1.10}], "s": "\\u00e9 \u2028"}',
        '{"m2":"3","big":123456789012345678901234567890,"m1":1, "lone": "\\ud800"}',
    ]
    ran = atwood("batch", table("\n\n".join(lines), "in.ndjson"), "--to", "ndjson", "--only", "regime")
    assert ran.out.split("\n") == [*(f'{line[:-1]},"regime":"no-slip","error":null}}' for line in lines), ""]


def test_ndjson_as_csv_keeps_the_text_of_numbers(atwood: Atwood, table: Table) -> None:
    rows = '{"m1":1.0,"m2":3,"tags":[1,{"q":"é"}]}\n{"m2":3,"m1":1,"new":true}\n'
    ran = atwood("batch", table(rows, "in.ndjson"), "--only", "regime")
    assert [*csv.reader(io.StringIO(ran.out))] == [
        ["m1", "m2", "tags", "new", "regime", "error"],
        ["1.0", "3", '[1,{"q":"é"}]', "", "no-slip", ""],
        ["1", "3", "", "true", "no-slip", ""],
    ]


# Bad rows

NOT_A_NUMBER = "is not a number; write it like 2, 0.5 or 1.5e-3"
BEYOND = "is beyond the range of doubles, 4.9e-324 to 1.8e308"


@pytest.mark.parametrize(
    ("row", "error"),
    [
        ({"m1": "abc"}, f"m1 'abc' {NOT_A_NUMBER}"),
        ({"m1": "1,5"}, "m1 '1,5' is not a number; write it with a decimal point, 1.5"),
        ({"m1": "0x10"}, f"m1 '0x10' {NOT_A_NUMBER}"),
        ({"m1": "1_000"}, f"m1 '1_000' {NOT_A_NUMBER}"),
        ({"g": "moon"}, f"g 'moon' {NOT_A_NUMBER}"),
        ({"inertia": "disk"}, f"inertia 'disk' {NOT_A_NUMBER}"),
        ({"m2": "250g"}, "m2 '250g' must be a plain number, without the 'g'"),
        ({"R": "5 cm"}, "R '5 cm' must be a plain number, without the 'cm'"),
        ({"wrap": "3rad"}, "wrap '3rad' must be a plain number, without the 'rad'"),
        ({"m1": ""}, "m1 is missing; give both masses, m1 and m2"),
        ({"m2": "  "}, "m2 is missing; give both masses, m1 and m2"),
        ({"m1": "-1"}, "m1 '-1' must be 0 or more, and finite"),
        ({"m1": "nan"}, "m1 'nan' must be 0 or more, and finite"),
        ({"m1": "inf"}, "m1 'inf' must be 0 or more, and finite"),
        ({"M": "-inf"}, "M '-inf' must be 0 or more (inf locks the pulley)"),
        ({"M": "Infinity"}, "M 'Infinity' must be 0 or more (inf locks the pulley)"),
        ({"m1": "1e400"}, f"m1 '1e400' {BEYOND}"),
        ({"M": "1e309"}, f"M '1e309' {BEYOND}"),
        ({"m1": "1e-400"}, f"m1 '1e-400' {BEYOND}"),
        ({"mu": "-0.1"}, "mu '-0.1' must be 0 or more, and finite"),
        ({"g": "0"}, "g '0' must be above 0, and finite"),
        ({"inertia": "0"}, "inertia '0' must be above 0, and finite"),
        ({"R": "-1"}, "R '-1' must be above 0, and finite"),
        ({"wrap": "0"}, "wrap '0' must be above 0, and finite"),
        ({"mu_k": "0.1"}, "mu_k '0.1' needs mu, the coefficient that decides whether it slips"),
        ({"mu": "0.1", "mu_k": "0.2"}, "mu_k '0.2' must not be above mu; exactly, 0.2 > 0.1"),
        ({"m1": "0", "m2": "0"}, "m1 and m2 are both 0; at least one mass must hang"),
        ({"m1": "0", "mu": "1"}, "m1 '0' is a free end, which friction cannot hold; leave mu out"),
        ({"m1": "x", "m2": "y"}, f"m1 'x' {NOT_A_NUMBER}"),
    ],
)
def test_a_bad_row_says_what_is_wrong(atwood: Atwood, table: Table, row: dict[str, str], error: str) -> None:
    rows = [{"m1": "1", "m2": "3"}, {"m1": "1", "m2": "3"} | row, {"m1": "3", "m2": "1"}]
    ran = atwood("batch", table(as_csv(rows)))
    assert ran.status == 1
    needs_mu = NEEDS_MU.replace(".", " (in 2 of 3 rows).")
    assert (
        ran.err == f"atwood: 3 rows: 2 no-slip; 1 error.\n{needs_mu}atwood: first error, in row 2: {error}\n"
    )
    before, bad, after = records(ran)
    assert bad == dict.fromkeys((*COLUMNS, *STANDARD), "") | rows[1] | {"error": error}
    assert (before["error"], after["error"]) == ("", "")
    assert float(before["acceleration"]) == -float(after["acceleration"]) != 0


def test_a_cell_is_a_number_where_solve_takes_it_for_one(atwood: Atwood, table: Table) -> None:
    rng = Random(19)
    words = [
        *"0e501 0e-501 -0 -0.0e501 0e0000501 1e501 1E-501 1e0000000001 +.5e+05 5. .5 . e 1e 1e+ 1f 1_0 0x1".split()
    ]
    words += [
        *"inf INF +inf infinity nan NaN \u0663 \uff11 true 1e5e5 1..5 --1 ١".split(),
        "1 e5",
        "\xa01",
        "1\u2009",
    ]
    words += [
        "0." + "0" * 600 + "1e600",
        "1" * 1001,
        "0" * 1001 + "1",
        "1." + "0" * 1000,
        "1" + "0" * 300 + "e-501",
    ]
    words += ["".join(rng.choices("0159.e-+ _", k=rng.randint(1, 9))).strip() or "0" for _ in range(3000)]
    path = table("\n".join(["m1,m2,M", *(f"1,3,{word}" for word in words), ""]))
    for word, row in zip(words, records(atwood("batch", path, "--accuracy", "fast")), strict=True):
        try:
            solve(m1=1, m2=3, M=word)
            taken = True
        except SceneError:
            taken = False
        assert taken == (not row["error"]) or row["error"].endswith(BEYOND), word


@pytest.mark.parametrize("value", ["true", "[1, 2]", '{"kg": 1}', '{"1": 1}', '"250 g"'])
def test_a_bad_value_in_ndjson_is_a_bad_row(atwood: Atwood, table: Table, value: str) -> None:
    ran = atwood("batch", table(f'{{"m1": {value}, "m2": 3}}\n', "in.ndjson"), "--to", "ndjson")
    result = json.loads(ran.out)
    assert (ran.status, result["m1"], result["regime"]) == (1, json.loads(value), None)
    shown = json.loads(value) if value.startswith('"') else value
    assert result["error"].startswith(f"m1 {shown!r} ")
    assert "range" not in result["error"]


GOOD = st.sampled_from(["1", "3", "0.5", " 2 ", "1e3", "+4"])
BAD = {
    **{name: ["abc", "-1", "nan", "250g", "1e999", "inf", "1,5", "\u0663"] for name in COLUMNS},
    "M": ["abc", "-1", "nan", "-inf", "1e999"],
}


@st.composite
def mixed_rows(draw: st.DrawFn) -> tuple[dict[str, str], str | None]:
    """A row, and the column that is wrong, if one is."""
    row = {"m1": draw(GOOD), "m2": draw(GOOD), "M": draw(st.sampled_from(["", "10", "inf", "0"]))}
    row["mu"] = draw(st.sampled_from(["", "0.3", "0", "nan"]))
    if row["mu"] == "nan":
        return row, "mu"
    wrong = draw(st.sampled_from([None, None, *COLUMNS]))
    if wrong is not None:
        row[wrong] = draw(st.sampled_from(BAD[wrong]))
    return row, wrong


@given(
    rows=st.lists(mixed_rows(), max_size=15),
    size=st.sampled_from([32, 1 << 20]),
    kind=st.sampled_from(FORMATS[:3]),
)
@examples(60)
def test_nothing_is_lost_among_bad_rows(
    atwood: Atwood, table: Table, rows: list[tuple[dict[str, str], str | None]], size: int, kind: str
) -> None:
    numbered = [{"id": str(i), **row} for i, (row, _) in enumerate(rows)]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tables, "PIECE_BYTES", size)
        ran = atwood("batch", table(as_csv(numbered, ("id", *COLUMNS))), "--to", kind)
    failed = sum(wrong is not None for _, wrong in rows)
    assert ran.status == (1 if failed else 0)
    if kind == "ndjson":
        printed = [
            {k: "" if v is None else v for k, v in json.loads(line).items()} for line in ran.out.splitlines()
        ]
    else:
        printed = list(csv.DictReader(io.StringIO(ran.out), delimiter={"csv": ",", "tsv": "\t"}[kind]))
    assert len(printed) == len(rows)
    for given_row, (_, wrong), row in zip(numbered, rows, printed, strict=True):
        assert {name: row[name] for name in given_row} == given_row
        if wrong is None:
            assert row["error"] == ""
            assert row["regime"] in ("no-slip", "verge", "slip")
        else:
            assert row["error"].startswith(f"{wrong} {given_row[wrong].strip()!r} ")
            assert {row[name] for name in STANDARD} == {""}


def test_what_is_wrong_with_rows_that_are_alike_is_found_once(
    atwood: Atwood, table: Table, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It takes 25 us a row: two million of them took a minute."""
    from atwood_cli.batch import run

    asked = []
    why = run._why

    def watched(row: dict[str, Any], layout: Any) -> str:
        asked.append(row)
        return why(row, layout)

    monkeypatch.setattr(run, "_why", watched)
    ran = atwood("batch", table("m1,m2,note\n" + "1,-1,a\n1,3,b\n1,,c\n" * 50), "--only", "regime")
    errors = [row["error"] for row in records(ran)]
    assert (
        errors
        == ["m2 '-1' must be 0 or more, and finite", "", "m2 is missing; give both masses, m1 and m2"] * 50
    )
    assert asked == [{"m1": "1", "m2": "-1"}, {"m1": "1", "m2": None}]
    assert len({why for why in errors if why}) == 2


def test_exit_status_with_allow_errors(atwood: Atwood, table: Table) -> None:
    path = table("m1,m2\n1,x\n")
    assert atwood("batch", path).status == 1
    ran = atwood("batch", path, "--allow-errors")
    assert ran.status == 0
    assert "1 row: 1 error." in ran.err


# Tables that are none


@pytest.mark.parametrize(
    ("content", "why"),
    [
        (b"", "it is empty"),
        (b"\n\r\n", "it is empty"),
        (b"a,b\n1,2\n", "column m1 is missing; there are 'a', 'b'"),
        (b"m1,m3\n1,2\n", "column m2 is missing; there are 'm1', 'm3'"),
        (b"m1;m3\n1;2\n", "column m2 is missing; there are 'm1', 'm3'"),
        (b"m1,m2,m2 (g)\n1,2,3\n", "columns 'm2' and 'm2 (g)' are both m2"),
        (b"m1,m2,m1\n1,2,3\n", "column 'm1' is there 2 times"),
        (b"m1,m2,x,x\n1,2,3,4\n", "column 'x' is there 2 times"),
        (
            b"m1,m2,regime\n1,2,3\n",
            "column 'regime' would be there twice, as a result is named so; rename it, or name other results by --only",
        ),
        (b"m1,m2,error\n1,2,3\n", "column 'error' would be there twice, as a result is named so; rename it"),
        (
            b"m1,m2\n1,2\n1,5,2\n",
            "row 2 has 3 cells, and the header 2; is there a decimal comma (write a point), or one at its end?",
        ),
        (
            b"# on Monday\n\nm1,m2\n1,2\n",
            "row 1 has 2 cells, and the header 1; the headings must come first, without lines above them",
        ),
        (
            b"sep=;\nm1;m2\n1,5;2\n",
            "column m1 is missing; there are 'sep=', ''",
        ),
        (b"m1,m2,,\n1,2,,\n", "2 columns have no heading; name them, or delete them"),
        (
            b"m1,m2,M\n1,2,3\n1,2",
            "row 2, the last, stops after 2 of 3 cells, without a line end: it is truncated",
        ),
        (b"m1,m2,n\n1,2,3\n1,2,\xe9\n", "row 2 is not UTF-8: byte 0xe9; save it as UTF-8"),
        (b"m1,m2,\xe9\n1,2,3\n", "the header is not UTF-8: byte 0xe9; save it as UTF-8"),
        (
            b",".join([b"m1,m2", *(b"x%d" % i for i in range(1023))]),
            "it has more than 1024 columns, the most taken",
        ),
    ],
)
def test_unreadable_csv(atwood: Atwood, table: Table, tmp_path: Path, content: bytes, why: str) -> None:
    path = table(content)
    ran = atwood("batch", path, "-o", str(tmp_path / "out.csv"))
    assert (ran.status, ran.out, ran.err) == (1, "", f"atwood: cannot read {path}: {why}\n")
    assert list(tmp_path.iterdir()) == [Path(path)]


@pytest.mark.parametrize(
    ("content", "why"),
    [
        (b"", "it is empty"),
        (b'{"m1":1}\n', "column m2 is missing; there are 'm1'"),
        (
            b'{"m1":1,"m2":2}\n{"m1":1,"m',
            "row 2 is not a line of NDJSON: Unterminated string starting at character 9",
        ),
        (b'{"m1":1,"m2":2}\n\n[1]\n', "row 2 is not a line of NDJSON: it is no object"),
        (b'{"m1":1,"m2":2,"m1":3}\n', "row 1 is not a line of NDJSON: 'm1' is there twice"),
        (b'{"m1":NaN,"m2":2}\n', "row 1 is not a line of NDJSON: NaN is no number in JSON"),
        (b"[" * 100_000, "row 1 is not a line of NDJSON: it is nested too deeply"),
        (b'{"m1":1,"m2":2}\n{"m1":1,"m2":"\xff"}\n', "row 2 is not UTF-8: byte 0xff; save it as UTF-8"),
        (
            b'{"m1":1,"m2":2}\n{"m1":1,"m2":2,"error":0}\n',
            "column 'error' would be there twice, as a result is named so; rename it",
        ),
    ],
)
def test_unreadable_ndjson(atwood: Atwood, table: Table, tmp_path: Path, content: bytes, why: str) -> None:
    path = table(content, "in.ndjson")
    ran = atwood("batch", path, "-o", str(tmp_path / "out.ndjson"))
    assert (ran.status, ran.out, ran.err) == (1, "", f"atwood: cannot read {path}: {why}\n")
    assert list(tmp_path.iterdir()) == [Path(path)]


OUT_OF_PLACE = 'the row that begins in line {} has a quotation mark out of place; write it "like ""this"""'
LEFT_OPEN = (
    "it ends within quotation marks, in the row that begins in line {}: it is truncated, or one is left open"
)


@pytest.mark.parametrize(
    ("rows", "why", "line"),
    [
        ('1,3,"said "no" and\n1,3,b\n1,3,c"\n1,3,d\n', OUT_OF_PLACE, 2),
        ('1,3,a\n\n1,3,"p\nq"\n1,3,5" wide\n1,3,"p"q\n', OUT_OF_PLACE, 6),
        ('1,3,"a"\n1,3,"p"q\n', OUT_OF_PLACE, 3),
        ('1,3,"p" \n', OUT_OF_PLACE, 2),
        ('1,3, "p"\n', OUT_OF_PLACE, 2),
        ('1,3,a"\n1,3,"b\n', OUT_OF_PLACE, 2),
        ('1,3,"a","b"\n'.replace(",", ";").replace('";"', '","'), OUT_OF_PLACE, 2),
        ('1,3,"x\ny', LEFT_OPEN, 2),
        ('\n"m1"x,m2\n1,3\n', OUT_OF_PLACE, 2),
        ('1,3,"x"\n1,3,"x""\n1,3,y\n', LEFT_OPEN, 3),
    ],
)
@pytest.mark.parametrize("size", [4, 1 << 20])
def test_malformed_quoting_swallows_no_rows(
    atwood: Atwood, table: Table, monkeypatch: pytest.MonkeyPatch, rows: str, why: str, line: int, size: int
) -> None:
    monkeypatch.setattr(tables, "PIECE_BYTES", size)
    header = "" if "m1" in rows else "m1;m2;n\n" if ";" in rows else "m1,m2,n\n"
    path = table(header + rows)
    ran = atwood("batch", path, "-o", f"{path}.csv")
    assert (ran.status, ran.err) == (1, f"atwood: cannot read {path}: {why.format(line)}\n")


@pytest.mark.parametrize("size", [8, 1 << 20])
def test_carriage_returns_in_cells_stay(
    atwood: Atwood, table: Table, monkeypatch: pytest.MonkeyPatch, size: int
) -> None:
    monkeypatch.setattr(tables, "PIECE_BYTES", size)
    rows = ["x\r,1,3,p\rq", '\r,1,3,"a,\rb\r"', "\rx,1,3,y\r", "z,1\r,3,"]
    ran = atwood("batch", table("\r\n".join(["id,m1,m2,n", *rows, "\r", ""])), "--only", "regime")
    got = [[row["id"], row["m1"], row["n"], row["error"]] for row in records(ran)]
    assert got == [
        ["x\r", "1", "p\rq", ""],
        ["\r", "1", "a,\rb\r", ""],
        ["\rx", "1", "y\r", ""],
        ["z", "1\r", "", ""],
    ]


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("e.tsv", b'm1\tm2\tz\n1\t"\x1b[31mX\t"x\n'),
        ("\x1b[31m.csv", b"m1,m2\n1\n1,3,4\n"),
        ("e.csv", b"m1,m2,M (\x1b[31m)\n1,3,4\n"),
        ("e.ndjson", b'{"m1":1,"m2":3,"\\u001b[31m":1,"\\u001b[31m":2}\n'),
        ("e.csv", b"m1,m2\n1,3\x1b[31m\n"),
        ("\x1b[31m.parquet", b"no table"),
    ],
)
def test_what_a_file_holds_or_is_called_steers_no_terminal(
    atwood: Atwood, table: Table, tmp_path: Path, name: str, content: bytes
) -> None:
    ran = atwood("batch", table(content, name), "-o", str(tmp_path / "\x1b[32m.csv"))
    assert ran.status == 1
    assert "\\x1b[31m" in ran.err or "quotation mark" in ran.err
    assert "\x1b" not in ran.err


def test_a_long_cell_is_read(atwood: Atwood, table: Table) -> None:
    """Python's own reader of CSV takes 131,072 characters at most, which is no concern of ours."""
    long = "x" * 200_000
    ran = atwood("batch", table(f"m1,m2,{long}\n1,3,{long}\n"), "--only", "regime")
    assert (ran.status, ran.out) == (0, f"m1,m2,{long},regime,error\n1,3,{long},no-slip,\n")
    ran = atwood("batch", table(f'm1,m2,n\n1,3,{long}\n1,3,"x"y\n'))
    assert ran.err.endswith(f"{OUT_OF_PLACE.format(3)}\n")
    runs = "".join(f"{m},3,{a},{long}\n" for m, a in ((1, 4), (1.5, 3), (2, 1.5)))
    ran = atwood("fit", table(f"m1,m2,a,note\n{runs}"), "--only", "dof")
    assert (ran.status, ran.out) == (0, "1\n")


def test_what_json_holds_comes_into_csv_as_typed(atwood: Atwood, table: Table) -> None:
    values = [
        "[1.10,1e400]",
        '{"m1" : [ {"k":1.0} , "}" ],"b":-0}',
        "9" * 5000,
        "true",
        "[" + "9" * 5000 + "]",
    ]
    rows = [f'{{ "m1":1, "x{{,\\"" : [2] ,"m2":3,"x" :  {value} , "y":0}}' for value in values]
    ran = atwood("batch", table("\n".join(rows), "in.ndjson"), "--only", "regime")
    assert ran.status == 0
    assert [row["x"] for row in records(ran)] == values


@pytest.mark.parametrize(
    ("row", "why"),
    [
        ('{"m1":1,"m2":3,"\\ud800":1}', "the key '\\ud800', which is not Unicode; give --to ndjson"),
        ('{"m1":1,"m2":3,"x":"a\\ud800"}', "a value of 'x' that is not Unicode; give --to ndjson"),
    ],
)
@pytest.mark.parametrize("target", ["csv", "parquet"])
def test_what_is_not_unicode_stays_in_json(
    atwood: Atwood, table: Table, tmp_path: Path, row: str, why: str, target: str
) -> None:
    path = table(f'{{"m1":1,"m2":3}}\n{row}\n', "in.ndjson")
    ran = atwood("batch", path, "-o", str(tmp_path / f"out.{target}"))
    assert (ran.status, ran.err) == (1, f"atwood: cannot read {path}: row 2 has {why}\n")
    ran = atwood("batch", path, "--to", "ndjson", "--only", "regime")
    assert ran.out.splitlines()[1] == f'{row[:-1]},"regime":"no-slip","error":null}}'


def test_keys_that_differ_do_not_fill_the_memory(
    atwood: Atwood, table: Table, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = table("".join(f'{{"m1":1,"m2":3,"k{i}":1}}\n' for i in range(2000)), "in.ndjson")
    for target in FORMATS[:3]:
        ran = atwood("batch", path, "--to", target)
        why = "it has more than 1024 columns, the most taken"
        assert (ran.status, ran.out, ran.err) == (1, "", f"atwood: cannot read {path}: {why}\n")
    sizes = []

    def spy(scenes: Any, *args: Any) -> Any:
        sizes.append(len(scenes["m1"]))
        return solve_and_count(scenes, *args)

    monkeypatch.setattr("atwood_cli.batch.run.solve_and_count", spy)
    monkeypatch.setattr(tables, "PIECE_CELLS", 40)
    keyed = table("".join(f'{{"m1":1,"m2":3,"k{i}":{i}}}\n' for i in range(8)), "in.ndjson")
    short = table("m1,m2," + ",".join(f"k{i}" for i in range(8)) + "\n" + '1,3,"\n"\n\n1,3\n' * 4)
    for path in (keyed, short):
        sizes.clear()
        ran = atwood("batch", path, "--only", "regime")
        assert len(records(ran)) == 8
        assert (max(sizes), sum(sizes)) == (4 if path == keyed else 3, 8)
    assert [row["k3"] for row in records(atwood("batch", keyed))] == ["", "", "", "3", "", "", "", ""]


def test_short_rows_of_ndjson_are_objects_a_few_at_a_time(
    atwood: Atwood, table: Table, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As objects, 700,000 rows `{}` are a hundred times as long as as text."""
    monkeypatch.setattr(tables, "PIECE_ROWS", 3)
    path = Path(table('\n{"m1":1,"m2":2}\n\n' + '{"m1":1,"m2":3}\n' * 6 + "{}\n", "in.ndjson"))
    with path.open("rb") as file:
        pieces = list(tables.read("ndjson", file, inputs_among, as_lines=True))
    assert [piece.frame.height for piece in pieces] == [3, 3, 2]
    assert [piece.size for piece in pieces] == [path.stat().st_size, 0, 0]
    ran = atwood("batch", str(path), "--only", "regime", "--allow-errors")
    assert [row["m2"] for row in records(ran)] == ["2", *["3"] * 6, ""]


def test_a_key_that_comes_too_late_for_a_column(
    atwood: Atwood, table: Table, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tables, "PIECE_BYTES", 20)
    path = table('{"m1":1,"m2":2}\n{"m1":1,"m2":2}\n{"m1":1,"m2":2,"x":3}\n', "in.ndjson")
    ran = atwood("batch", path)
    why = "row 3 has 'x', for which there is no column by now; give --to ndjson"
    assert (ran.status, ran.err) == (1, f"atwood: cannot read {path}: {why}\n")
    assert atwood("batch", path, "--to", "ndjson").status == 0


def test_a_quotation_mark_left_open_does_not_fill_the_memory(
    atwood: Atwood, table: Table, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tables, "PIECE_BYTES", 1 << 16)
    monkeypatch.setattr(tables, "LONGEST_RECORD", 1 << 20)
    ran = atwood("batch", table('m1,m2\n"1,2\n' + "1,2\n" * 300_000))
    assert ran.status == 1
    why = "the row that begins in line 2 is longer than 1 MB, the most taken; is a quotation mark left open?"
    assert ran.err.endswith(f": {why}\n")


# What spreadsheets write


def solved(ran: Ran, name: str = "acceleration") -> list[float]:
    return [float(row[name]) for row in records(ran)]


@pytest.mark.parametrize(
    ("name", "mark"), [("in.csv", ";"), ("in.csv", "\t"), ("in.tsv", ";"), ("in.tsv", "\t")]
)
def test_semicolons_tabs_and_decimal_commas(atwood: Atwood, table: Table, name: str, mark: str) -> None:
    rows = [
        ["run", "m1", "m2", "M", "mu"],
        ["a", "1,5", "3", "10", "0,3"],
        ["b", "1", "2,25", "10", ""],
        ["c", "1e0", "3", "1e1", "1e-1"],
    ]
    path = table("\ufeff" + "\r\n".join(map(mark.join, rows)) + "\r\n", name)
    ran = atwood("batch", path, "--only", "tension_1")
    pointed = [[cell.replace(",", ".") for cell in row] for row in rows]
    plain_ran = atwood("batch", table("\n".join(map(",".join, pointed)), "plain.csv"), "--only", "tension_1")
    assert solved(ran, "tension_1") == solved(plain_ran, "tension_1")
    parted = {";": "cells parted by semicolons, ", "\t": "cells parted by tabs, "}[mark]
    parted *= {"in.csv": ",", "in.tsv": "\t"}[name] != mark
    summary = "3 rows: 2 no-slip, 1 slip; no errors."
    assert ran.err == f"atwood: read as: {parted}decimal commas.\natwood: {summary}\n"
    assert [row["m1"] for row in records(ran)] == ["1,5", "1", "1e0"]  # as they were


@pytest.mark.parametrize(
    ("text", "errors"),
    [
        ("m1;m2\n1.5;3\n1;3\n", ["", ""]),  # no commas: points
        (
            "m1;m2\n1,5;3\n1.500;3\n",
            ["", "m1 '1.500' has a point in a table of decimal commas; write all alike"],
        ),
        ("m1;m2\n1,500;3\n", [""]),
        ("m1\tm2\n1,500\t3\n", ["m1 '1,500' is not a number; write 1500 or 1.500, whichever is meant"]),
        ("m1\tm2\n1,500\t3\n0,5\t3\n", ["", ""]),
        ('m1,m2\n"1,500",3\n', ["m1 '1,500' is not a number; write 1500 or 1.500, whichever is meant"]),
    ],
)
def test_a_comma_is_decimal_only_where_that_is_certain(
    atwood: Atwood, table: Table, text: str, errors: list[str]
) -> None:
    ran = atwood("batch", table(text))
    assert [row["error"] for row in records(ran)] == errors
    if not any(errors) and "," in text:
        assert solved(ran, "tension_1")[0] == solve(m1=1.5, m2=3).tension_1


@pytest.mark.parametrize(
    ("heading", "cell", "name", "exact"),
    [
        ("m1 (g)", "250.1", "m1", "0.2501"),
        ("m1[g]", "2.501e2", "m1", "0.2501"),
        ("M [kg]", "2", "M", "2"),
        ("M (t)", "0.1", "M", "100"),
        ("M (lb)", "3", "M", "1.36077711"),
        ("M (kg t^9/g^9)", "1.1e-54", "M", "1.1"),  # of ten, a power that is no double
        ("M (g)", "inf", "M", "inf"),
        ("R (cm)", "2.7", "R", "0.027"),
        ("g (cm/s²)", "981.3", "g", "9.813"),
        ("g (ft/s2)", "32.3", "g", "9.84504"),
        ("wrap (turn)", "0.3", "wrap", "108"),
        ("wrap (deg)", "90", "wrap", "90"),
        ("mu (-)", "0.3", "mu", "0.3"),
        ("mu_k []", "", "mu_k", None),
        (" m1 ", " 1E-1 ", "m1", "0.1"),
        ("M", "1.", "M", "1"),
        ("M", "INF", "M", "inf"),
        ("M", "\xa02\xa0", "M", "2"),
    ],
)
@pytest.mark.parametrize("source", ["csv", "ndjson", "parquet"])
def test_units_in_headings(
    atwood: Atwood, tmp_path: Path, source: str, heading: str, cell: str, name: str, exact: str | None
) -> None:
    """A cell is the double nearest to it in the SI, not a product that was rounded twice."""
    row = {"m1": "1", "m2": "3", "R": "1"}
    row.pop(name, None)
    frame = pl.DataFrame({**{other: [text] for other, text in row.items()}, heading: [cell]})
    start = tmp_path / f"in.{source}"
    value: Any = exact and float(exact)
    if source == "parquet":
        frame = frame.with_columns(pl.all().str.strip_chars().cast(pl.Float64, strict=False))
        if value and math.isfinite(value):  # the cell is a double already
            value = float(Fraction(float(cell)) * Fraction(str(exact)) / Fraction(cell.strip()))
    getattr(frame, f"write_{source}")(start)
    given: dict[str, Any] = {"g": 9.80665, **{other: float(text) for other, text in row.items()}, name: value}
    for target in ("csv", "ndjson"):
        ran = atwood(
            "batch", str(start), "--accuracy", "exact", "--only", "tension_1,torque,mu_verge", "--to", target
        )
        printed = records(ran)[0] if target == "csv" else json.loads(ran.out)
        assert not printed["error"]
        right = solve(**given)
        assert [float(printed[one]) for one in ("tension_1", "torque")] == [right.tension_1, right.torque]
        unit = heading.strip(f"{name}[( )]-")
        said = f"atwood: read as: {heading!r} as {name}{f' in {unit}' if unit else ''}.\n" * (heading != name)
        assert ran.err.startswith(f"{said}atwood: 1 row")


def test_what_a_unit_takes_beyond_the_doubles_is_an_error_of_the_row(atwood: Atwood, tmp_path: Path) -> None:
    for factor, cell in (("ug", 1e-323), ("t", 1e308), ("kg t^9/ug^9 t^9/ug^9 t^9/ug^9", 1.0)):
        pl.DataFrame({f"m1 ({factor})": [cell, 0.0], "m2": [1.0, 1.0]}).write_parquet(tmp_path / "in.parquet")
        ran = atwood("batch", str(tmp_path / "in.parquet"))
        assert [row["error"] for row in records(ran)] == [f"m1 {cell!r} {BEYOND}", ""]


LABEL = "; or let it pass by --label "


@pytest.mark.parametrize(
    ("column", "why"),
    [
        *((name, "could be meant for M") for name in ("pulley_mass", "Pulley mass", "m", "m_pulley", "M_kg")),
        *((name, "could be meant for R") for name in ("radius", "r", "R_cm", "R cm")),
        *((name, "could be meant for wrap") for name in ("wrap_deg", "Wrap", "angle", "φ")),
        *((name, "could be meant for mu") for name in ("μ", "µ", "MU", "mu_s", "friction")),
        *((name, "could be meant for mu_k") for name in ("mu-k", "mu k", "μ_k", "muk")),
        *((name, "could be meant for g") for name in ("G", "gravity")),
        *((name, "could be meant for inertia") for name in ("beta", "Inertia")),
    ],
)
def test_a_column_that_could_be_meant_for_an_input_is_an_error(
    atwood: Atwood, table: Table, column: str, why: str
) -> None:
    path = table(f"m1,m2,{column}\n1,3,7\n")
    ran = atwood("batch", path)
    said = f"{why}; name it so, with a unit like 'm1 (g)'{LABEL}{column!r}"
    assert (ran.status, ran.out, ran.err) == (
        1,
        "",
        f"atwood: cannot read {path}: column {column!r} {said}\n",
    )
    assert atwood("batch", path, "--label", column).status == 0
    name = why.split()[-1]
    if name != "inertia":
        both = table(f"m1,m2,{name},{column}\n1,3,,7\n", "both.csv")  # it is there, so this is no input
        assert atwood("batch", both).status == 0


@pytest.mark.parametrize(
    ("column", "why"),
    [
        *(
            (name, "tells of a motion, which only solve takes")
            for name in ("a", "drop", "time", "Time (s)", "a (m/s2)")
        ),
        *(
            (name, "is not taken here; give inertia, I/(M R^2)")
            for name in ("I", "I (kg m2)", "moment of inertia")
        ),
        ("M (cm)", "has a unit of length; it takes one of mass (kg, g, mg, ug, t, lb, lbs, oz, st)"),
        ("M (est.)", "has the unknown unit 'est.'; there are kg, g, mg, ug, t, lb, lbs, oz, st"),
        ("mu (kg)", "must hold plain numbers, without the 'kg'"),
        ("wrap (rad)", "has angles in radians; give degrees or turns"),
        (
            "M (kg*st^9/lb^9*st^9/lb^9*st^9)",
            "has a unit of another dimension; it takes one of mass (kg, g, mg, ug, t, lb, lbs, oz, st)",
        ),
    ],
)
def test_a_column_that_is_an_input_elsewhere_is_an_error(
    atwood: Atwood, table: Table, column: str, why: str
) -> None:
    path = table(f"m1,m2,{column}\n1,3,7\n")
    ran = atwood("batch", path)
    assert (ran.status, ran.out, ran.err) == (
        1,
        "",
        f"atwood: cannot read {path}: column {column!r} {why}{LABEL}{column!r}\n",
    )
    passed = atwood("batch", path, "--label", column, "--only", "acceleration")
    assert passed.out == f"m1,m2,{column},acceleration,error\n1,3,7,4.903325,\n"


def test_masses_by_other_names_are_told(atwood: Atwood, table: Table) -> None:
    for column in ("m1_g", "mass1", "m₁", "M1"):
        ran = atwood("batch", table(f"{column},m2\n1,3\n"))
        assert f"column {column!r} could be meant for m1; name it so" in ran.err


@pytest.mark.parametrize(
    "name", ["i", "rig", "mass", "height", "weight", "acceleration_measured", "m3", "T1"]
)
def test_other_columns_are_labels(atwood: Atwood, table: Table, name: str) -> None:
    assert atwood("batch", table(f"m1,m2,{name}\n1,3,7\n")).status == 0


@pytest.mark.parametrize("size", [8, 1 << 20])
def test_a_short_row_is_an_error_of_that_row_and_blank_lines_are_none(
    atwood: Atwood, table: Table, monkeypatch: pytest.MonkeyPatch, size: int
) -> None:
    monkeypatch.setattr(tables, "PIECE_BYTES", size)
    lines = [
        '"a,""b\nc",1,3,10,0.3',
        "",
        'x,1,3,10,""',
        " ",
        "y,1,3,10",
        "",
        "",
        '"q,",1,3',
        "z,1,3,10,",
        "\t",
        "w",
    ]
    ran = atwood("batch", table("\r\n".join(["id,m1,m2,M,mu", "", *lines, "", ""])), "--only", "regime")
    assert [(row["id"], row["regime"], row["error"]) for row in records(ran)] == [
        ('a,"b\nc', "no-slip", ""),
        ("x", "no-slip", ""),
        ("y", "", "the row has 4 cells, and the header 5"),
        ("q,", "", "the row has 3 cells, and the header 5"),
        ("z", "no-slip", ""),
        ("w", "", "the row has 1 cell, and the header 5"),
    ]
    assert ran.err.endswith("first error, in row 3: the row has 4 cells, and the header 5\n")


def test_no_cell_hides_a_short_row(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever stands in quotation marks, and however the file comes in pieces."""
    rng = Random(14)
    cells = ["1", "", '""', '"a,b"', '"x\ny"', '"q""r"', " 1", '"\n"', '";"']
    for _ in range(1000):
        mark, end = rng.choice(",;\t"), rng.choice(["\n", "\r\n"])
        rows = [
            [rng.choice(cells) for _ in range(rng.choice([1, 2, 3, 4, 4, 4]))]
            for _ in range(rng.randint(0, 8))
        ]
        lines = [mark.join(row) or " " for row in rows]
        text = end.join([mark.join(["m1", "m2", "M", "n"]), *lines, ""]).encode()
        monkeypatch.setattr(tables, "PIECE_BYTES", rng.choice([4, 17, 1 << 20]))
        pieces = list(tables.read("csv", io.BytesIO(text), inputs_among, as_lines=False))
        widths = [piece.short.get(row, 4) for piece in pieces for row in range(piece.frame.height)]
        assert widths == [len(row) for row, line in zip(rows, lines, strict=True) if line.strip(" ")], text


def test_a_pipe_by_any_name_is_csv(tmp_path: Path) -> None:
    ran = process(shell="atwood batch <(printf 'm1,m2\n1,3\n') --only acceleration")
    assert (ran.status, ran.out) == (0, "m1,m2,acceleration,error\n1,3,4.903325,\n")
    ran = process(shell="printf 'm1,m2\n1,3\n' | atwood batch /dev/stdin -o /dev/stdout --only regime")
    assert (ran.status, ran.out) == (0, "m1,m2,regime,error\n1,3,no-slip,\n")
    pl.DataFrame({"m1": [1], "m2": [3]}).write_parquet(tmp_path / "in.parquet")
    ran = process(shell=f"atwood batch <(cat {tmp_path}/in.parquet) --from parquet --only regime")
    assert (ran.status, ran.out) == (0, "m1,m2,regime,error\n1,3,no-slip,\n")


# Usage and files


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("x.txt", "--from is needed: 'x.txt' ends in none of .csv, .tsv, .ndjson, .parquet, .jsonl"),
        ("x.csv -o y", "--to is needed: 'y' ends in none of .csv, .tsv, .ndjson, .parquet, .jsonl"),
        ("x --from xml", "--from 'xml' is no format; there are csv, tsv, ndjson, parquet"),
        ("x.csv --to CSV", "--to 'CSV' is no format; there are csv, tsv, ndjson, parquet"),
        ("x.csv --accuracy certifed", "--accuracy 'certifed' is no accuracy; did you mean certified?"),
        ("x.csv --accuracy best", "--accuracy 'best' is no accuracy; there are fast, certified, exact"),
        ("x.csv --only accel", "--only 'accel' is no quantity; did you mean acceleration?"),
        ("", "Missing argument 'IN'; atwood batch -h shows how"),
        ("x.csv -o a.csv -o b.csv", "--output is given 2 times; give it once"),
    ],
)
def test_wrong_usage(atwood: Atwood, words: str, message: str) -> None:
    ran = atwood("batch", *words.split())
    assert (ran.status, ran.out, ran.err) == (2, "", f"atwood: {message}\n")


def test_files_that_cannot_be_read_or_written(atwood: Atwood, table: Table, tmp_path: Path) -> None:
    path = table("m1,m2\n1,2\n")
    for words, message in [
        ([f"{tmp_path}/no.csv"], f"cannot read {tmp_path}/no.csv: No such file or directory"),
        ([str(tmp_path), "--from", "csv"], f"cannot read {tmp_path}: Is a directory"),
        (
            [path, "-o", f"{tmp_path}/no/out.csv"],
            f"cannot write {tmp_path}/no/out.csv: No such file or directory",
        ),
    ]:
        ran = atwood("batch", *words)
        assert (ran.status, ran.out, ran.err) == (1, "", f"atwood: {message}\n")


def test_an_existing_file_is_replaced_only_by_force(atwood: Atwood, table: Table, tmp_path: Path) -> None:
    path, out = table("m1,m2\n1,2\n"), tmp_path / "out.csv"
    out.write_text("precious")
    ran = atwood("batch", path, "-o", str(out))
    assert (ran.status, ran.err) == (
        1,
        f"atwood: cannot write {out}: it exists already; --force replaces it\n",
    )
    assert out.read_text() == "precious"
    assert atwood("batch", path, "-o", str(out), "--force").status == 0
    assert out.read_text().startswith("m1,m2,regime")


@pytest.mark.parametrize("link", ["in.csv", "hard.csv", "soft.csv"])
def test_the_input_is_never_overwritten(atwood: Atwood, table: Table, tmp_path: Path, link: str) -> None:
    path = table("m1,m2\n1,2\n")
    (tmp_path / "hard.csv").hardlink_to(path)
    (tmp_path / "soft.csv").symlink_to(path)
    out = str(tmp_path / link)
    ran = atwood("batch", path, "-o", out, "--force")
    message = f"--output {out!r} is the input, which is never overwritten; name another\n"
    assert (ran.status, ran.out) == (2, "")
    assert ran.err.startswith("atwood: --output ")
    assert ran.err.endswith(message[-55:])
    assert Path(path).read_text() == "m1,m2\n1,2\n"


@pytest.mark.parametrize("line", ["in.csv >> in.csv", "- < in.csv >> in.csv", "in.csv 1<> in.csv"])
def test_an_input_that_is_stdout_is_not_overwritten(table: Table, tmp_path: Path, line: str) -> None:
    path = table("m1,m2\n1,2\n")
    ran = process(shell=f'cd "{tmp_path}"; atwood batch {line}')
    assert (ran.status, ran.out) == (2, "")
    assert ran.err == "atwood: --output '-' is the input, which is never overwritten; name another\n"
    assert Path(path).read_text() == "m1,m2\n1,2\n"


def test_an_error_while_reading_says_so(atwood: Atwood) -> None:
    if not Path("/proc/self/mem").exists():
        pytest.skip("needs a file that cannot be read")
    ran = atwood("batch", "/proc/self/mem", "--from", "csv")
    assert (ran.status, ran.err) == (1, "atwood: cannot read /proc/self/mem: Input/output error\n")


@pytest.mark.parametrize("unit", ["*st^9/lb^9" * 10_000, "x" * 100_000, " " * 50_000 + "g kg"])
def test_a_heading_whose_unit_is_long_takes_no_time(atwood: Atwood, table: Table, unit: str) -> None:
    path = table(f"m1,m2,M (kg{unit})\n1,3,7\n")
    ran = atwood("batch", path)
    assert (ran.status, ran.out) == (1, "")
    assert len(ran.err) < 400
    assert "characters; at most 60 are taken" in ran.err or "another dimension" in ran.err


@pytest.mark.parametrize(("only", "status"), [("torque", 1), ("torque,tension_1", 1), ("mu_verge", 0)])
@pytest.mark.parametrize("kind", ["csv", "ndjson"])
def test_a_result_that_no_row_has_is_a_status_where_it_was_asked_for(
    atwood: Atwood, table: Table, only: str, status: int, kind: str
) -> None:
    path = table("m1,m2,M,mu\n1,3,,0.3\n1,1.1,,3\n1,x,,3\n")
    ran = atwood("batch", path, "--only", only, "--to", kind, "--allow-errors")
    assert ran.status == status
    assert ran.out.count("\n") == 4 - (kind == "ndjson")
    assert atwood("batch", path, "--to", kind, "--allow-errors").status == 0
    assert atwood("batch", table("m1,m2\nx,1\n"), "--only", only, "--allow-errors").status == 0
    assert atwood("batch", table("m1,m2\n"), "--only", only).status == 0


def test_polars_does_not_panic_where_it_is_told_to(atwood: Atwood, table: Table) -> None:
    path = table("m1,m2\n1,3\n1,2,3\n")
    ran = process("batch", path, POLARS_PANIC_ON_ERR="1")
    assert (ran.status, ran.err) == (1, atwood("batch", path).err)


@pytest.mark.parametrize("threads", ["x", "0", "-1", ""])
def test_threads_that_polars_panics_over(
    atwood: Atwood, table: Table, monkeypatch: pytest.MonkeyPatch, threads: str
) -> None:
    monkeypatch.setenv("POLARS_MAX_THREADS", threads)
    ran = atwood("batch", table("m1,m2\n1,2\n"))
    why = f"POLARS_MAX_THREADS is set to {threads!r}; it must be a whole number from 1, or unset"
    assert (ran.status, ran.out, ran.err) == (1, "", f"atwood: {why}\n")


def test_what_polars_warns_of_reaches_nobody(table: Table) -> None:
    ran = process("batch", table("m1,m2\n1,2\n"), POLARS_ENGINE_AFFINITY="x")
    assert (ran.status, ran.err) == (0, f"atwood: 1 row: 1 no-slip; no errors.\n{NEEDS_MU}")


def test_without_polars_one_line_says_what_to_install(
    atwood: Atwood, table: Table, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "polars", None)
    ran = atwood("batch", table("m1,m2\n1,2\n"))
    assert (ran.status, ran.out) == (1, "")
    assert ran.err == f"atwood: this needs polars; install it with: {PIP} install 'atwood-cli[batch]'\n"


# How it ends


def lots(path: Path, rows: int) -> str:
    path.write_text("m1,m2,M\n" + "1,3,10\n" * rows)
    return str(path)


def waiting(*words: str) -> "subprocess.Popen[bytes]":
    """A run in the middle of its input: some pieces are done, more are awaited."""
    command = [sys.executable, "-m", "atwood_cli", "batch", "-", *words]
    child = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert child.stdin is not None
    child.stdin.write(b"m1,m2,M\n" + b"1,3,10\n" * 1_000_000)
    child.stdin.flush()
    return child


TURNED = """
import os, signal, sys, time
from atwood_cli import cli
class Part:
    def __set_name__(self, owner, name):
        os.kill(os.getpid(), getattr(signal, sys.argv.pop()))
        time.sleep(9)
def run():
    try:
        type("Imported", (), {"part": Part()})
    except KeyboardInterrupt as error:  # since Python 3.12; before, a RuntimeError
        raise ImportError("numpy._core.multiarray failed to import") from error
cli.run = run
from atwood_cli.__main__ import main
sys.exit(main())
"""


@pytest.mark.skipif(os.name == "nt", reason="needs POSIX signals")
@pytest.mark.parametrize(("blow", "status"), [("SIGINT", 130), ("SIGTERM", 143), ("SIGHUP", 129)])
def test_a_run_stopped_in_an_import_shows_no_traceback(blow: str, status: int) -> None:
    """Classes that are being made, and modules written in C, turn what stops them into other errors."""
    ended = subprocess.run([sys.executable, "-c", TURNED, blow], capture_output=True, check=False)
    assert (ended.returncode, ended.stderr) == (status, b"")


@pytest.mark.skipif(os.name == "nt", reason="needs POSIX signals")
@pytest.mark.parametrize("blows", ["SIGKILL", "SIGINT", "SIGTERM", "SIGHUP", "SIGINT SIGINT"])
def test_a_run_cut_short_leaves_no_output(tmp_path: Path, blows: str) -> None:
    out = tmp_path / "out.csv"
    child = waiting("-o", str(out))
    while not any(path.stat().st_size for path in tmp_path.iterdir()):
        assert child.poll() is None
        time.sleep(0.01)
    for blow in blows.split():
        child.send_signal(signal.Signals[blow])
    _, err = child.communicate(timeout=HANGS)
    status = {"SIGINT": 130, "SIGTERM": 143, "SIGHUP": 129, "SIGKILL": -9}[blows.split()[0]]
    assert (child.returncode, err) == (status, b"")
    assert not out.exists()
    if blows != "SIGKILL":
        assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(os.name == "nt", reason="needs POSIX signals")
def test_what_is_to_outlive_its_terminal_does(tmp_path: Path) -> None:
    """Under nohup, which has SIGHUP ignored."""
    code = "import signal, runpy; signal.signal(signal.SIGHUP, signal.SIG_IGN); runpy.run_module('atwood_cli', run_name='__main__')"
    out = tmp_path / "out.csv"
    words = [sys.executable, "-c", code, "batch", "-", "-o", str(out)]
    child = subprocess.Popen(words, stdin=subprocess.PIPE, stderr=subprocess.PIPE)
    while not list(tmp_path.iterdir()):
        time.sleep(0.01)
    child.send_signal(signal.SIGHUP)
    _, err = child.communicate(b"m1,m2\n1,3\n", timeout=HANGS)
    assert (child.returncode, err) == (0, f"atwood: 1 row: 1 no-slip; no errors.\n{NEEDS_MU}".encode())


@pytest.mark.skipif(os.name == "nt", reason="needs POSIX signals")
@pytest.mark.parametrize("kind", ["csv", "parquet"])
def test_a_pipe_that_brings_nothing_is_waited_for_until_it_is_stopped(tmp_path: Path, kind: str) -> None:
    os.mkfifo(tmp_path / "in")
    for number, writers in ((signal.SIGTERM, 0), (signal.SIGINT, 0), (signal.SIGINT, 1)):
        words = [sys.executable, "-m", "atwood_cli", "batch", str(tmp_path / "in"), "--from", kind]
        child = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        writer = os.open(tmp_path / "in", os.O_RDWR) if writers else None
        time.sleep(1)
        child.send_signal(number)
        assert child.communicate(timeout=HANGS) == (b"", b"")
        assert child.returncode == {signal.SIGTERM: 143, signal.SIGINT: 130}[number]
        if writer is not None:
            os.close(writer)


def test_a_reader_that_leaves_early_ends_it_quietly(tmp_path: Path) -> None:
    path = lots(tmp_path / "in.csv", 300_000)
    ran = process(shell=f"set -o pipefail; atwood batch {path} --only regime | head -1")
    assert (ran.status, ran.out, ran.err) == (0, "m1,m2,M,regime,error\n", "")


def test_a_full_disk_is_an_error(table: Table) -> None:
    if not Path("/dev/full").exists():
        pytest.skip("needs a device that is always full")
    ran = process("batch", table("m1,m2\n1,2\n"), "-o", "/dev/full", "--to", "csv")
    assert ran.status == 1
    assert ran.err.endswith("No space left on device\n")


def test_closed_streams(table: Table) -> None:
    path = table("m1,m2\n1,x\n")
    for streams in (">&-", "2>&-", ">&- 2>&-"):
        ran = process(shell=f"atwood batch {path} {streams}")
        assert (ran.status, "Traceback" in ran.err) == (1, False)
    ran = process(shell="atwood batch - <&-")
    assert (ran.status, ran.err) == (1, "atwood: cannot read stdin: it is closed\n")


BAR = """
import sys
from atwood_cli.output import page
from atwood_cli.batch import formats as tables
tables.PIECE_BYTES = 64
clock = CLOCK
page.monotonic = lambda: next(clock)
sys.argv[0] = "atwood"
from atwood_cli.__main__ import main
sys.exit(main())
"""


def test_a_bar_on_a_terminal_after_a_second(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    script, path = tmp_path / "atwood_slow.py", lots(tmp_path / "in.csv", 100)

    def seen_by(clock: str) -> str:
        script.write_text(BAR.replace("CLOCK", clock))
        return clocked_on_terminal(script, ["batch", path, "--force", "-o", str(tmp_path / "out.csv")])

    seen = seen_by("iter(range(10**6))")
    assert "━" in seen
    assert "%" in seen
    assert "100 rows: 100 no-slip; no errors." in plain(seen)
    needs_mu = NEEDS_MU.replace("\n", "\r\n")
    assert seen_by("iter([0] * 10**6)") == f"atwood: 100 rows: 100 no-slip; no errors.\r\n{needs_mu}"


def clocked_on_terminal(script: Path, words: list[str]) -> str:
    """What a terminal sees of a run whose clock is the script's."""
    pty = pytest.importorskip("pty")
    leader, follower = pty.openpty()
    child = subprocess.Popen(
        [sys.executable, str(script), *words], stdin=follower, stdout=follower, stderr=follower
    )
    os.close(follower)
    seen = b""
    try:
        while piece := os.read(leader, 65536):
            seen += piece
    except OSError:
        pass
    assert child.wait(HANGS) == 0
    os.close(leader)
    return seen.decode()


def test_help_shows_the_columns_and_examples(atwood: Atwood) -> None:
    ran = atwood("batch", "-h")
    assert ran.status == 0
    for words in (
        "m1, m2, M, mu, mu_k, g, inertia, R",
        "atwood batch scenes.csv -o results.csv",
        "--allow-errors",
    ):
        assert words in ran.out


def test_a_redirected_input_is_not_overwritten_either(tmp_path: Path) -> None:
    scenes = tmp_path / "in.csv"
    scenes.write_text("m1,m2\n1,3\n")
    ran = process(shell=f'cd "{tmp_path}"; atwood batch - -o in.csv --force < in.csv')
    assert (ran.status, ran.out) == (2, "")
    assert ran.err == "atwood: --output 'in.csv' is the input, which is never overwritten; name another\n"
    assert scenes.read_text() == "m1,m2\n1,3\n"


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("m1,m2\r1,3\r", "its lines end in carriage returns alone; save it with line feeds"),
        ('m1,"m2\n1,3\n', "the header ends within quotation marks: one is left open"),
    ],
)
def test_a_header_never_swallows_the_rows(text: str, why: str, tmp_path: Path) -> None:
    scenes = tmp_path / "in.csv"
    scenes.write_bytes(text.encode())
    ran = process("batch", str(scenes))
    assert (ran.status, ran.out, ran.err) == (1, "", f"atwood: cannot read {scenes}: {why}\n")


TEXT = "m1,m2\n1,3\n"
WIDE = "in UTF-16 or UTF-32; save it as UTF-8"
ARRAY = "a JSON array; write an object a line, and give --from ndjson to batch"


@pytest.mark.parametrize("command", ["batch", "batch --from ndjson", "fit"])
@pytest.mark.parametrize(
    ("content", "kind"),
    [
        (TEXT.encode("utf-16"), WIDE),
        (TEXT.encode("utf-16-le"), WIDE),
        (TEXT.encode("utf-16-be"), WIDE),
        (TEXT.encode("utf-32"), WIDE),
        (gzip.compress(TEXT.encode(), mtime=0), "compressed by gzip; unpack it first"),
        (bz2.compress(TEXT.encode()), "compressed; unpack it first"),
        (lzma.compress(TEXT.encode()), "compressed; unpack it first"),
        (b"\x28\xb5\x2f\xfd$", "compressed; unpack it first"),
        (b"PK\3\4\r\n\r", "a workbook (.xlsx), or another zip archive; save the sheet as CSV"),
        (b"\xd0\xcf\x11\xe0\xa1\r", "a workbook (.xls); save the sheet as CSV"),
        (b"PAR1\r", "Parquet; batch reads it with --from parquet, and fit reads CSV"),
        (b'[{"m1": 1, "m2": 3}]\n', ARRAY),
        (b'[\n  {"m1": 1}\n]\n', ARRAY),
    ],
)
def test_a_file_of_another_kind_is_called_what_it_is(
    command: str, content: bytes, kind: str, tmp_path: Path
) -> None:
    path = tmp_path / "in"
    path.write_bytes(content)
    ran = process(*command.split(), "-", stdin=path.open("rb"))
    assert (ran.status, ran.out, ran.err) == (1, "", f"atwood: cannot read stdin: it is {kind}\n")


@pytest.mark.parametrize("command", ["batch", "fit"])
def test_ndjson_for_csv_is_called_so(command: str, table: Table) -> None:
    path = table('{"m1": 1, "m2": 3}\n')
    why = "it is NDJSON; batch reads it with --from ndjson, and fit reads CSV"
    ran = process(command, path)
    assert (ran.status, ran.out, ran.err) == (1, "", f"atwood: cannot read {path}: {why}\n")


@pytest.mark.parametrize(
    ("kind", "column", "holds"),
    [
        ("ndjson", [b"x"], "Binary"),
        ("csv", [b"x"], "Binary"),
        ("tsv", [[1]], "List(Int64)"),
        ("csv", [timedelta(1)], "Duration(time_unit='us')"),
    ],
)
def test_what_a_format_has_no_place_for(kind: str, column: list[Any], holds: str, tmp_path: Path) -> None:
    pl.DataFrame({"m1": [1.0], "m2": [3.0], "b": column}).write_parquet(tmp_path / "in.parquet")
    ran = process("batch", str(tmp_path / "in.parquet"), "--to", kind)
    message = f"atwood: cannot write column 'b', which holds {holds}, as {kind}; give --to parquet\n"
    assert (ran.status, ran.out, ran.err) == (1, "", message)
