"""Tables of scenes: every format, nothing lost, nothing changed, every error said."""

import bz2
import csv
import gzip
import io
import json
import lzma
import math
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Collection
from fractions import Fraction
from functools import partial
from itertools import count
from pathlib import Path
from random import Random
from typing import Any

import polars as pl
import pytest
from hypothesis import given
from hypothesis import strategies as st

from atwood_cli import SceneError, arrays, solve
from atwood_cli.arrays import solve_and_count
from atwood_cli.batch import formats as tables
from atwood_cli.batch import ndjson, run, solving
from atwood_cli.batch.layout import inputs_among
from atwood_cli.files import FORMATS
from atwood_cli.model.quantities import NAMES, STANDARD
from atwood_cli.model.scene import INPUTS

from .conftest import examples
from .running import HANGS, PIP, Atwood, Ran, hearing, on_terminal, plain, process
from .scenes import FAMILIES, scenes

NEEDS_MU = "atwood: critical_pulley_mass: give mu, the friction coefficient.\n"
SEPARATORS = {"csv": ",", "tsv": "\t"}
WHOLE = 1 << 20
"""A piece of that many bytes is the whole table."""

Batch = Callable[..., Ran]


@pytest.fixture
def batch(atwood: Atwood, tmp_path: Path) -> Batch:
    """Run `atwood batch` on a file with that content; in messages the file is called IN."""

    def call(content: bytes | str, words: str = "", name: str = "in.csv", command: str = "batch") -> Ran:
        path = tmp_path / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        ran = atwood(*command.split(), str(path), *words.replace("OUT", str(tmp_path / "out")).split())
        return ran._replace(err=ran.err.replace(str(path), "IN"))

    return call


def as_csv(rows: list[dict[str, str]], columns: Collection[str] = tuple(INPUTS)) -> str:
    out = io.StringIO()
    writer = csv.DictWriter(out, columns, restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return out.getvalue()


def records(ran: Ran, separator: str = ",") -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(ran.out, newline=""), delimiter=separator))


def errors_of(ran: Ran) -> list[str]:
    return [row["error"] for row in records(ran)]


def near(value: float, exact: float) -> bool:
    """Within 4 units in the last place."""
    return abs(value - exact) <= 4 * math.ulp(exact)


def written(frame: pl.DataFrame, kind: str, path: Path) -> Path:
    if kind in SEPARATORS:
        frame.write_csv(path, separator=SEPARATORS[kind])
    else:
        getattr(frame, f"write_{kind}")(path)
    return path


def read_back(path: Path, kind: str) -> pl.DataFrame:
    if kind in SEPARATORS:
        return pl.read_csv(path, separator=SEPARATORS[kind])
    if kind == "parquet":
        return pl.read_parquet(path)
    return pl.read_ndjson(path, infer_schema_length=None, schema_overrides={"error": pl.String})


# Results

ODD_SCENE = "0.25 .5e0 0.1 1 1.62 1 0.1 90"
SCENES = [
    {"m1": "1", "m2": "3", "mu": "0.3"},
    {"m1": "1", "m2": "3", "M": "10"},
    {"m1": "1", "m2": "3", "M": "100", "mu": "0.3", "mu_k": "0.25"},
    {"m1": "1", "m2": "3", "M": "inf"},
    {"m1": "2", "m2": "2"},
    dict(zip("m1 m2 M mu g inertia R wrap".split(), ODD_SCENE.split(), strict=True)),
]
REGIMES = ["verge", "no-slip", "slip", "no-slip", "no-slip", "no-slip"]
SUMMARY = "atwood: 6 rows: 4 no-slip, 1 verge, 1 slip; no errors.\n"


def test_results_are_those_of_solve(batch: Batch) -> None:
    ran = batch(as_csv(SCENES), "".join(f" --only {name}" for name in NAMES))
    assert ran.status == 0
    assert ran.err.startswith(SUMMARY)
    for scene, row in zip(SCENES, records(ran), strict=True):
        given: dict[str, Any] = {name: float(text) for name, text in scene.items()}
        solution = solve(**given)
        assert row["regime"] == solution.regime
        for name in NAMES[1:]:
            exact = getattr(solution, name)
            assert (row[name] == "") == (exact is None), name
            assert exact is None or near(float(row[name]), exact), name


@pytest.mark.parametrize("accuracy", ["fast", "certified", "exact"])
def test_every_accuracy_is_handed_on(batch: Batch, monkeypatch: pytest.MonkeyPatch, accuracy: str) -> None:
    asked = []

    def spy(given: Any, accuracy: Any, names: Any) -> Any:
        asked.append(accuracy)
        return solve_and_count(given, accuracy, names)

    monkeypatch.setattr(arrays, "solve_and_count", spy)
    assert batch(as_csv(SCENES * 4), f"--accuracy {accuracy}").status == 0
    assert set(asked) == {accuracy}


def test_few_rows_have_the_results_of_many(batch: Batch, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of scenes of every kind, wrong ones too."""
    rows = [dict(zip(INPUTS, cells.split(), strict=False)) for cells in ("0 0", "-1 3", "1 3 1 .1 .2")]
    for family in FAMILIES:
        rows += scenes(family, 40)
    table = pl.DataFrame(rows, dict.fromkeys(INPUTS, pl.String))
    asked = f"--accuracy exact --only {','.join(NAMES)}"
    many = batch(table.write_csv(), asked)
    monkeypatch.setattr(run, "FEW", len(table))
    assert batch(table.write_csv(), asked) == many


def test_few_rows_need_no_numpy(tmp_path: Path) -> None:
    (tmp_path / "in.csv").write_text("m1,m2\n" + "1,3\n" * 20)
    code = "import sys\nfrom atwood_cli.cli import run\nrun()\nprint(*sys.modules, file=sys.stderr)"
    loaded = process("batch", str(tmp_path / "in.csv"), code=code).err.split()
    assert "polars" in loaded
    assert "numpy" not in loaded


FROM_JSON = "--from ndjson"
LINES = [
    '{"id": 1, "m1": 1.0, "m2": 3e0, "tags": [1, "x", {"q": 1.10}], "s": "\\u00e9 \u2028"}',
    '{"m2":"3","big":123456789012345678901234567890,"m1":1, "lone": "\\ud800", "missing": NaN}',
]
ONE = "atwood: 1 row: 1 no-slip; no errors.\n"
LONG = "x" * 200_000
"""Python's own reader of CSV takes 131,072 characters at most."""


@pytest.mark.parametrize(
    ("content", "words", "out"),
    [
        # The seven standard results, or those asked for, in that order.
        ("m1,m2\n1,1\n", "", f"m1,m2,{','.join(STANDARD)},error\n1,1,no-slip,0.0,9.80665,9.80665,0.0,0.0,,\n"),
        ("m1,m2\n1,1\n", "--only tension_2,regime --only tension_2", "m1,m2,tension_2,regime,error\n1,1,9.80665,no-slip,\n"),
        # Empty cells are not given.
        ('m1,m2,M,g,R\n1,3,8,,""\n1,3, ,,\n', "--only acceleration --accuracy exact", 'm1,m2,M,g,R,acceleration,error\n1,3,8,,"",2.4516625,\n1,3, ,,,4.903325,\n'),
        # A header alone, a byte order mark, line ends of Windows, blank lines.
        ("m1,m2", "--only regime", "m1,m2,regime,error\n"),
        ("\ufeffm1,m2\r\n1,3\r\n\r\n\r\n", "--only regime", "m1,m2,regime,error\n1,3,no-slip,\n"),
        # Cells stay as they were, of any length.
        ('id,m1,m2,n\n007,1.10,+3e0,\n1e5, 1 ,3,""\n"a,b",.5,1E0,"""hi"""', "--only regime", 'id,m1,m2,n,regime,error\n007,1.10,+3e0,,no-slip,\n1e5, 1 ,3,"",no-slip,\n"a,b",.5,1E0,"""hi""",no-slip,\n'),
        (f"m1,m2,{LONG}\n1,3,{LONG}\n", "--only regime", f"m1,m2,{LONG},regime,error\n1,3,{LONG},no-slip,\n"),
        # What could not be meant for an input passes.
        ("m1,m2,i,rig,mass,height,weight,a_measured,m3,T1\n1,3,,,,,,,,\n", "--only regime", "m1,m2,i,rig,mass,height,weight,a_measured,m3,T1,regime,error\n1,3,,,,,,,,,no-slip,\n"),
        # NDJSON: lines come out as they were, and values as they are written.
        ('\ufeff{"m1":1,"m2":3}\r\n', f"{FROM_JSON} --only regime", "m1,m2,regime,error\n1,3,no-slip,\n"),
        ("\n\n".join(LINES), f"{FROM_JSON} --to ndjson --only regime", "".join(f'{line[:-1]},"regime":"no-slip","error":null}}\n' for line in LINES)),
        ('{"m1":1.0,"m2":3,"tags":[1,{"q":"é"}]}\n{"m2":3,"m1":1,"new":true}\n', f"{FROM_JSON} --only regime", 'm1,m2,tags,new,regime,error\n1.0,3,"[1,{""q"":""é""}]",,no-slip,\n1,3,,true,no-slip,\n'),
        ('{"m1":1,"m2":3,"x":"é\\ud800"}\n', f"{FROM_JSON} --only regime", "m1,m2,x,regime,error\n1,3,é\\ud800,no-slip,\n"),
    ],
    ids=count(),
)  # fmt: skip
def test_what_comes_out(batch: Batch, content: str, words: str, out: str) -> None:
    ran = batch(content, words)
    assert (ran.status, ran.out) == (0, out)


@pytest.mark.parametrize(
    ("content", "words", "status", "said"),
    [
        ("m1,m2\n", "", 0, "0 rows: no errors."),
        ("m1,m2,M,mu\n5,8,,0.87\n", "", 0, """1 row: 1 no-slip; no errors.
            acceleration, tension_1, tension_2, mu_verge, friction_force: give M, the pulley's mass, which decides here.
            critical_pulley_mass: does not exist, as the string holds on any pulley, however heavy."""),
        ("m1,m2,M,mu\n5,8,,0.87\n5,8,x,0.87\n5,8,10,0.01\n5,8,10\n,8,,\n", "--only acceleration,regime,torque", 1, """5 rows: 1 no-slip, 1 slip; 3 errors.
            acceleration, torque: give M, the pulley's mass, which decides here (in 1 of 5 rows).
            torque: give R, the pulley's radius (in 1 of 5 rows).
            first error, in row 2: M 'x' is not a number; write it like 2, 0.5 or 1.5e-3"""),
        ("m1,m2\n1,x\n", "--allow-errors", 0, """1 row: 1 error.
            first error, in row 1: m2 'x' is not a number; write it like 2, 0.5 or 1.5e-3"""),
        ("m1,m2 (g),M,n\n1,3,NA,x\n1,3,inf,NA\n1, null ,NULL,x\n1,3,na,x\n", "--only regime", 1, """read as: 'm2 (g)' as m2 in g, NA and NULL and null as not given.
            4 rows: 2 no-slip; 2 errors.
            first error, in row 3: m2 is missing; give both masses, m1 and m2"""),
        ("m1,m2\n1e308,1e308\n1,1\n", "--only tension_1,tension_2", 0, "2 rows: 2 no-slip; no errors; 2 values beyond the range of doubles left empty."),
    ],
    ids=count(),
)  # fmt: skip
def test_what_is_said(batch: Batch, content: str, words: str, status: int, said: str) -> None:
    ran = batch(content, words)
    lines = ["atwood: " + line.strip() + "\n" for line in said.splitlines()]
    assert (ran.status, ran.err) == (status, "".join(lines))


def test_values_beyond_the_doubles_are_empty(batch: Batch) -> None:
    ran = batch("m1,m2\n1e308,1e308\n", "--only tension_1")
    assert ran.out == "m1,m2,tension_1,error\n1e308,1e308,,\n"
    assert '"tension_1":null' in batch("m1,m2\n1e308,1e308\n", "--to ndjson").out


@pytest.mark.parametrize(("only", "status"), [("torque", 1), ("torque,tension_1", 1), ("mu_verge", 0)])
@pytest.mark.parametrize("kind", ["csv", "ndjson"])
def test_a_result_that_no_row_has_is_a_status_where_it_was_asked_for(
    batch: Batch, only: str, status: int, kind: str
) -> None:
    content, words = "m1,m2,M,mu\n1,3,,0.3\n1,1.1,,3\n1,x,,3\n", f"--to {kind} --allow-errors"
    ran = batch(content, f"{words} --only {only}")
    assert (ran.status, ran.out.count("\n")) == (status, 4 - (kind == "ndjson"))
    assert batch(content, words).status == 0
    assert batch("m1,m2\nx,1\n", f"{words} --only {only}").status == 0
    assert batch("m1,m2\n", f"--only {only}").status == 0


# Formats


@pytest.mark.parametrize("target", FORMATS)
@pytest.mark.parametrize("source", FORMATS)
def test_every_format_into_every_format(atwood: Atwood, tmp_path: Path, source: str, target: str) -> None:
    frame = pl.read_csv(as_csv(SCENES).encode(), infer_schema=False)
    if source == "parquet":
        frame = frame.cast(pl.Float64)
    out = tmp_path / f"out.{target}"
    start = written(frame, source, tmp_path / f"in.{source}")
    ran = atwood("batch", str(start), "-o", str(out), "--only", "regime")
    assert (ran.status, ran.out, ran.err) == (0, "", SUMMARY)
    result = read_back(out, target)
    assert result.columns == [*INPUTS, "regime", "error"]
    assert result["regime"].to_list() == REGIMES
    assert result["error"].null_count() == 6
    assert result["m1"].cast(pl.Float64).to_list() == [1, 1, 1, 1, 2, 0.25]
    assert list(tmp_path.glob(".*")) == []


TYPED = """
id,m1 (g),m2,M,mu
007,0.10,3e0,inf,NA
1e5," 250 ",1,1.5,
,abc,1,inf,-1
x\u2028,1e-400,nan,10,1e400
y,5
""".lstrip()


def test_inputs_read_from_text_are_written_as_numbers_where_a_format_has_numbers(
    batch: Batch, tmp_path: Path
) -> None:
    rows: list[tuple[Any, ...]] = [
        ("007", 0.1, 3.0, math.inf, None),
        ("1e5", 250.0, 1.0, 1.5, None),
        (None, None, 1.0, math.inf, -1.0),
        ("x\u2028", None, None, 10.0, None),
        ("y", 5.0, None, None, None),
    ]
    batch(TYPED, "-o OUT.parquet --only regime")
    frame = pl.read_parquet(tmp_path / "out.parquet")
    assert frame[:, :5].rows() == rows
    assert frame.dtypes == [pl.String, *[pl.Float64] * 4, pl.String, pl.String]
    lines = batch(TYPED, "--to ndjson --only regime").out.removesuffix("\n").split("\n")
    printed = [json.loads(line) for line in lines]
    in_json = [["inf" if cell == math.inf else cell for cell in row] for row in rows]
    assert [list(row.values())[:5] for row in printed] == in_json
    assert [row["error"] for row in printed] == frame["error"].to_list()
    # A pipe of the one into the other is the same table.
    text = "".join(f"{json.dumps(row)}\n" for row in printed).replace("error", "e").replace("regime", "r")
    batch(text, "-o OUT.parquet --force --only regime", "in.ndjson")
    assert pl.read_parquet(tmp_path / "out.parquet")[:, :5].equals(frame[:, :5])


@pytest.mark.parametrize("kind", FORMATS)
def test_streams(tmp_path: Path, kind: str) -> None:
    path = written(pl.DataFrame({"m1": [1.0], "m2": [3.0]}), kind, tmp_path / "in")
    formats = f"--from {kind} --to {kind}" if kind != "csv" else ""
    ran = process(shell=f"cat {path} | atwood batch - {formats} --only regime > {tmp_path}/out")
    assert (ran.status, ran.err) == (0, ONE)
    assert read_back(tmp_path / "out", kind).rows() == [(1.0, 3.0, "no-slip", None)]


def test_a_pipe_by_any_name_is_csv(tmp_path: Path) -> None:
    written(pl.DataFrame({"m1": [1], "m2": [3]}), "parquet", tmp_path / "in.parquet")
    for line in (
        "atwood batch <(printf 'm1,m2\n1,3\n') --only regime",
        "printf 'm1,m2\n1,3\n' | atwood batch /dev/stdin -o /dev/stdout --only regime",
        f"atwood batch <(cat {tmp_path}/in.parquet) --from parquet --only regime",
    ):
        ran = process(shell=line)
        assert (ran.status, ran.out) == (0, "m1,m2,regime,error\n1,3,no-slip,\n")


@pytest.mark.parametrize("suffix", ["gz", "bz2", "xz"])
@pytest.mark.parametrize("command", ["batch --only regime", "fit"])
def test_compressed_files_are_unpacked_by_their_suffix(
    atwood: Atwood, tmp_path: Path, suffix: str, command: str
) -> None:
    packers: dict[str, Any] = {"gz": gzip.compress, "bz2": bz2.compress, "xz": lzma.compress}
    pack = packers[suffix]
    text = "m1,m2,T (s)\n1,3,1.5\n1,3,1.6\n1,4,1.2\n1,2.5,1.9\n"
    if command == "fit":
        text = text.replace("T (s)", "time")
    path, plain_path = tmp_path / f"in.csv.{suffix}", tmp_path / "in.csv"
    path.write_bytes(pack(text.encode()))
    plain_path.write_text(text)
    words = [*command.split(), *(["--drop", "1"] if command == "fit" else [])]
    assert atwood(*words, str(path)) == (right := atwood(*words, str(plain_path)))
    assert right.status == 0
    path.write_bytes(pack(text.encode())[:-9])
    ran = atwood(*words, str(path))
    assert (ran.status, ran.out) == (1, "")
    assert ran.err.startswith(f"atwood: cannot read {path}: Compressed file ended before")


def test_an_unpacker_that_this_python_lacks(batch: Batch, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "compression.zstd", None)
    why = "atwood: cannot read IN: this Python cannot unpack .zst (3.14 can); unpack it first\n"
    assert batch(TEXT, name="in.csv.zst") == (1, "", why)


SEVERAL = {
    "a.csv": "m1,m2,n\n1,3,a\n",
    "b.csv": "n;m2;m1\nb;3,5;1\nc;x;1\n",
    "c.csv": "m1,m2\n1,3\n",
    "d.csv": "m1,m2,n,x\n1,3,d,e\n",
    "e.ndjson": '{"n":"e","m1":1,"m2":2.5}\n',
    "f.parquet": "",
}


@pytest.mark.parametrize(
    ("words", "out", "said"),
    [
        ("a.csv b.csv e.ndjson --only regime", 'm1,m2,n,regime,error\n1,3,a,no-slip,\n1,"3,5",b,no-slip,\n1,x,c,,"m2 \'x\' is not a number; write it like 2, 0.5 or 1.5e-3"\n1,2.5,e,no-slip,\n', "first error, in row 2 of b.csv: m2 'x' "),
        ("e.ndjson a.csv --only regime --to ndjson", '{"n":"e","m1":1,"m2":2.5,"regime":"no-slip","error":null}\n{"m1":1.0,"m2":3.0,"n":"a","regime":"no-slip","error":null}\n', "2 rows: 2 no-slip; no errors."),
        ("a.csv c.csv", None, "cannot read c.csv: it has no column 'n', which a.csv has"),
        ("a.csv d.csv", None, "cannot read d.csv: it has a column 'x', which a.csv has not"),
        ("a.csv g.csv", None, "cannot read g.csv: No such file or directory"),
        ("f.parquet a.csv -o out.parquet", None, "cannot read a.csv: column 'n' holds String, and in f.parquet Int64"),
        ("a.csv b.csv -o b.csv --force", None, "--output 'b.csv' is the input, which is never overwritten; name another"),
    ],
)  # fmt: skip
def test_several_inputs_become_one_table(
    atwood: Atwood, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, words: str, out: str | None, said: str
) -> None:
    monkeypatch.chdir(tmp_path)
    for name, text in SEVERAL.items():
        Path(name).write_text(text)
    pl.DataFrame({"m1": [1.0], "m2": [3.0], "n": [1]}).write_parquet("f.parquet")
    ran = atwood("batch", *words.split())
    assert f"atwood: {said}" in ran.err
    assert ran.out == out or (out is None and ran.status > 0 and not Path("out.parquet").exists())


def test_a_pipe_of_ndjson_is_answered_row_by_row() -> None:
    words = "batch - --from ndjson --to ndjson --only regime --allow-errors".split()
    with subprocess.Popen(
        [sys.executable, "-m", "atwood_cli", *words],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    ) as child:  # fmt: skip
        assert child.stdin
        assert child.stdout
        answers = ['{"regime":null,"error":"\'x\' is not a line of NDJSON: Expecting value at character 1"}']
        answers += [f'{{"m1":1,"m2":{i},"regime":"no-slip","error":null}}' for i in range(3)]
        child.stdin.write(b"x\n")  # which waits for a line that tells the columns
        for i, answer in enumerate(answers):
            if i:
                child.stdin.write(f'{{"m1":1,"m2":{i - 1}}}\n'.encode())
            child.stdin.flush()
            for line in [answers[0], answer][i != 1 :] if i else []:
                assert child.stdout.readline().decode() == f"{line}\n"
        child.stdin.write(b'{"m1":1,"m2":9}')  # the last has no line end
        assert child.communicate(timeout=HANGS)[0] == b'{"m1":1,"m2":9,"regime":"no-slip","error":null}\n'


# Nothing is changed

ODD_TEXT = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"), max_size=8) | st.text(
    ",\"\n\t ;'\\x", max_size=6
)


@pytest.mark.parametrize("kind", SEPARATORS)
@given(cells=st.lists(st.tuples(ODD_TEXT, ODD_TEXT), max_size=12), size=st.sampled_from([16, 64, WHOLE]))
@examples(60)
def test_other_columns_pass_through(batch: Batch, kind: str, cells: list[tuple[str, str]], size: int) -> None:
    out = io.StringIO(newline="")
    # With this line end, Python quotes a lone \r too, which is one at the end of a row otherwise.
    writer = csv.writer(out, delimiter=SEPARATORS[kind], lineterminator="\r\n")
    writer.writerows([["one", "m1", "m2", "two"], *((a, "1.0", "003", b) for a, b in cells)])
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tables, "PIECE_BYTES", size)
        ran = batch(out.getvalue(), f"--to {kind} --only regime", f"in.{kind}")
    assert ran.err.endswith("no errors.\n")
    assert list(csv.reader(io.StringIO(ran.out, newline=""), delimiter=SEPARATORS[kind])) == [
        ["one", "m1", "m2", "two", "regime", "error"],
        *([a, "1.0", "003", b, "no-slip", ""] for a, b in cells),
    ]


@pytest.mark.parametrize("size", [8, WHOLE])
def test_carriage_returns_in_cells_stay(batch: Batch, monkeypatch: pytest.MonkeyPatch, size: int) -> None:
    monkeypatch.setattr(tables, "PIECE_BYTES", size)
    rows = ["x\r,1,3,p\rq", '\r,1,3,"a,\rb\r"', "\rx,1,3,y\r", "z,1\r,3,"]
    ran = batch("\r\n".join(["id,m1,m2,n", *rows, "\r", ""]), "--only regime")
    got = [[row["id"], row["m1"], row["n"], row["error"]] for row in records(ran)]
    assert got == [
        ["x\r", "1", "p\rq", ""],
        ["\r", "1", "a,\rb\r", ""],
        ["\rx", "1", "y\r", ""],
        ["z", "1\r", "", ""],
    ]


def test_what_json_holds_comes_into_csv_as_typed(batch: Batch) -> None:
    nines = "9" * 5000
    values = ["[1.10,1e400]", '{"m1" : [ {"k":1.0} , "}" ],"b":-0}', nines, "true", f"[{nines}]"]
    rows = [f'{{ "m1":1, "x{{,\\"" : [2] ,"m2":3,"x" :  {value} , "y":0}}' for value in values]
    ran = batch("\n".join(rows), f"{FROM_JSON} --only regime")
    assert ran.status == 0
    assert [row["x"] for row in records(ran)] == values


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
def test_a_bad_row_says_what_is_wrong(batch: Batch, row: dict[str, str], error: str) -> None:
    rows = [{"m1": "1", "m2": "3"}, {"m1": "1", "m2": "3"} | row, {"m1": "3", "m2": "1"}]
    ran = batch(as_csv(rows))
    needs_mu = NEEDS_MU.replace(".", " (in 2 of 3 rows).")
    first = f"atwood: first error, in row 2: {error}\n"
    assert (ran.status, ran.err) == (1, f"atwood: 3 rows: 2 no-slip; 1 error.\n{needs_mu}{first}")
    before, bad, after = records(ran)
    assert bad == dict.fromkeys((*INPUTS, *STANDARD), "") | rows[1] | {"error": error}
    assert (before["error"], after["error"]) == ("", "")
    assert float(before["acceleration"]) == -float(after["acceleration"]) != 0


WHICHEVER = "m1 '1,500' is not a number; write 1500 or 1.500, whichever is meant"
POINT = "m1 '1.500' has a point in a table of decimal commas; write all alike"


@pytest.mark.parametrize(
    ("text", "errors"),
    [
        ("m1;m2\n1.5;3\n1;3\n", ["", ""]),  # no commas: points
        ("m1;m2\n1,5;3\n1.500;3\n", ["", POINT]),
        ("m1;m2\n1,500;3\n", [""]),
        ("m1\tm2\n1,500\t3\n", [WHICHEVER]),
        ("m1\tm2\n1,500\t3\n0,5\t3\n", ["", ""]),
        ('m1,m2\n"1,500",3\n', [WHICHEVER]),
    ],
)
def test_a_comma_is_decimal_only_where_that_is_certain(batch: Batch, text: str, errors: list[str]) -> None:
    ran = batch(text, "--accuracy exact")
    assert errors_of(ran) == errors
    if not any(errors) and "," in text:
        assert float(records(ran)[0]["tension_1"]) == solve(m1=1.5, m2=3).tension_1


def test_a_cell_is_a_number_where_solve_takes_it_for_one(batch: Batch) -> None:
    rng = Random(19)
    words = "0e501 0e-501 -0 -0.0e501 0e0000501 1e501 1E-501 1e0000000001 +.5e+05 5. .5 . e 1e 1e+ 1f".split()
    words += "1_0 0x1 inf INF +inf infinity nan NaN \u0663 \uff11 true 1e5e5 1..5 --1 ١".split()
    words += ["1 e5", "\xa01", "1\u2009", f"0.{'0' * 600}1e600", "1" * 1001, f"{'0' * 1001}1"]
    words += [f"1.{'0' * 1000}", f"1{'0' * 300}e-501"]
    words += ["".join(rng.choices("0159.e-+ _", k=rng.randint(1, 9))).strip() or "0" for _ in range(3000)]
    ran = batch("\n".join(["m1,m2,M", *(f"1,3,{word}" for word in words), ""]), "--accuracy fast")
    for word, error in zip(words, errors_of(ran), strict=True):
        try:
            solve(m1=1, m2=3, M=word)
            taken = True
        except SceneError:
            taken = False
        assert taken == (not error) or error.endswith(BEYOND), word


@pytest.mark.parametrize("value", ["true", "[1, 2]", '{"kg": 1}', '{"1": 1}', '"250 g"', '"\\ud800"', "NaN"])
def test_a_bad_value_in_ndjson_is_a_bad_row(batch: Batch, value: str) -> None:
    ran = batch(f'{{"m1": {value}, "m2": 3}}\n', f"{FROM_JSON} --to ndjson")
    result = json.loads(ran.out)
    assert (ran.status, result["regime"]) == (1, None)
    assert f'"m1": {value}, ' in ran.out
    assert result["error"].startswith("m1 " + repr(value.strip('"')))
    assert "range" not in result["error"]


GOOD = st.sampled_from(["1", "3", "0.5", " 2 ", "1e3", "+4"])
BAD = {
    **{name: ["abc", "-1", "nan", "250g", "1e999", "inf", "1,5", "\u0663"] for name in INPUTS},
    "M": ["abc", "-1", "nan", "-inf", "1e999"],
}


@st.composite
def mixed_rows(draw: st.DrawFn) -> tuple[dict[str, str], str | None]:
    """A row, and the column that is wrong, if one is."""
    row = {"m1": draw(GOOD), "m2": draw(GOOD), "M": draw(st.sampled_from(["", "10", "inf", "0"]))}
    row["mu"] = draw(st.sampled_from(["", "0.3", "0", "nan"]))
    wrong = "mu" if row["mu"] == "nan" else draw(st.sampled_from([None, None, *INPUTS]))
    if wrong is not None and row["mu"] != "nan":
        row[wrong] = draw(st.sampled_from(BAD[wrong]))
    return row, wrong


def as_number(cell: str) -> float | str:
    """A cell of an input as it is written in JSON: a number, unless it is empty or infinite."""
    try:
        return float(cell) if math.isfinite(float(cell)) else cell
    except ValueError:
        return cell


@given(
    rows=st.lists(mixed_rows(), max_size=15),
    size=st.sampled_from([32, WHOLE]),
    kind=st.sampled_from(FORMATS[:3]),
)
@examples(60)
def test_nothing_is_lost_among_bad_rows(
    batch: Batch, rows: list[tuple[dict[str, str], str | None]], size: int, kind: str
) -> None:
    numbered = [{"id": str(i), **row} for i, (row, _) in enumerate(rows)]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tables, "PIECE_BYTES", size)
        ran = batch(as_csv(numbered, ("id", *INPUTS)), f"--to {kind}")
    assert ran.status == any(wrong is not None for _, wrong in rows)
    if kind == "ndjson":
        objects = map(json.loads, ran.out.splitlines())
        printed = [{k: "" if v is None else v for k, v in row.items()} for row in objects]
    else:
        printed = records(ran, SEPARATORS[kind])
    for given_row, (_, wrong), row in zip(numbered, rows, printed, strict=True):
        as_read = {name: as_number(cell) for name, cell in given_row.items() if name != "id"}
        as_read |= {wrong: ""} if wrong and given_row[wrong] != "-1" else {}
        written = given_row | as_read if kind == "ndjson" else given_row
        assert {name: row[name] for name in given_row} == written
        if wrong is None:
            assert row["error"] == ""
            assert row["regime"] in ("no-slip", "verge", "slip")
        else:
            assert row["error"].startswith(f"{wrong} {given_row[wrong].strip()!r} ")
            assert {row[name] for name in STANDARD} == {""}


def test_what_is_wrong_with_rows_that_are_alike_is_found_once(
    batch: Batch, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It takes 25 us a row: two million of them took a minute."""
    asked = []
    why = solving._why

    def watched(row: dict[str, Any], layout: Any) -> str:
        asked.append(row)
        return why(row, layout)

    monkeypatch.setattr(solving, "_why", watched)
    errors = errors_of(batch("m1,m2,note\n" + "1,-1,a\n1,3,b\n1,,c\n" * 50, "--only regime"))
    negative, missing = "m2 '-1' must be 0 or more, and finite", "m2 is missing; give both masses, m1 and m2"
    assert errors == [negative, "", missing] * 50
    assert asked == [{"m1": "1", "m2": "-1"}, {"m1": "1", "m2": None}]


@pytest.mark.parametrize("size", [8, WHOLE])
def test_a_short_row_is_an_error_of_that_row_and_blank_lines_are_none(
    batch: Batch, monkeypatch: pytest.MonkeyPatch, size: int
) -> None:
    monkeypatch.setattr(tables, "PIECE_BYTES", size)
    lines = ['"a,""b\nc",1,3,10,0.3', "", 'x,1,3,10,""', " ", "y,1,3,10", "", ""]
    lines += ['"q,",1,3', "z,1,3,10,", "\t", "w"]
    ran = batch("\r\n".join(["id,m1,m2,M,mu", "", *lines, "", ""]), "--only regime")
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
        sizes = [rng.choice([1, 2, 3, 4, 4, 4]) for _ in range(rng.randint(0, 8))]
        rows = [mark.join(rng.choice(cells) for _ in range(size)) or " " for size in sizes]
        text = end.join([mark.join(["m1", "m2", "M", "n"]), *rows, ""]).encode()
        monkeypatch.setattr(tables, "PIECE_BYTES", rng.choice([4, 17, WHOLE]))
        pieces = list(tables.read_csv(io.BytesIO(text), ",", inputs_among))
        said = [
            piece.errors.get(row, "the row has 4") for piece in pieces for row in range(piece.frame.height)
        ]
        widths = [int(why.split()[3]) for why in said]
        assert widths == [size for size, row in zip(sizes, rows, strict=True) if row.strip(" ")], text


# Tables that are none

OUT_OF_PLACE = 'the row that begins in line {} has a quotation mark out of place; write it "like ""this"""'
LEFT_OPEN = "it ends within quotation marks, in the row that begins in line {}: it is truncated, or one is left open"  # fmt: skip
LABEL = "; or let it pass by --label "
OF_MASS = "it takes one of mass (kg, g, mg, ug, t, lb, lbs, oz, st, slug)"
COMMA = "is there a decimal comma (write a point), or one at its end?"
RENAME = "would be there twice, as a result is named so; rename it, or name other results by --only"
WIDE_HEADER = ",".join(["m1,m2", *(f"x{i}" for i in range(1023))])


@pytest.mark.parametrize(
    ("content", "why"),
    [
        ("", "it is empty"),
        ("\n\r\n", "it is empty"),
        ("a,b\n1,2\n", "column m1 is missing; there are 'a', 'b'"),
        ("m1;m3\n1;2\n", "column m2 is missing; there are 'm1', 'm3'"),
        ("sep=;\nm1;m2\n1,5;2\n", "column m1 is missing; there are 'sep=', ''"),
        ("m1,m2,m2 (g)\n1,2,3\n", "columns 'm2' and 'm2 (g)' are both m2"),
        ("m1,m2,m1\n1,2,3\n", "column 'm1' is there 2 times"),
        ("m1,m2,x,x\n1,2,3,4\n", "column 'x' is there 2 times"),
        ("m1,m2,,\n1,2,,\n", "2 columns have no heading; name them, or delete them"),
        ("m1,m2,regime\n1,2,3\n", f"column 'regime' {RENAME}"),
        ("m1,m2,error\n1,2,3\n", f"column 'error' {RENAME}"),
        (WIDE_HEADER, "it has more than 1024 columns, the most taken"),
        ("m1,m2\n1,2\n1,5,2\n", f"row 2 has 3 cells, and the header 2; {COMMA}"),
        ("m1;m2\n1;2\n1;5;2\n", "row 2 has 3 cells, and the header 2"),
        ("# on Monday\n\nm1,m2\n1,2\n", "row 1 has 2 cells, and the header 1; the headings must come first, without lines above them"),
        ("m1,m2,M\n1,2,3\n1,2", "row 2, the last, stops after 2 of 3 cells, without a line end: it is truncated"),
        (b"m1,m2,n\n1,2,3\n\n1,2,\xe9\n", "line 4 is not UTF-8: byte 0xe9; save it as UTF-8"),
        (b"\nm1,m2,\xe9\n1,2,3\n", "line 2 is not UTF-8: byte 0xe9; save it as UTF-8"),
        ("m1,m2\r1,3\r", "its lines end in carriage returns alone; save it with line feeds"),
        ('m1,"m2\n1,3\n', "the header ends within quotation marks: one is left open"),
        # Quotation marks that would swallow rows
        ('m1,m2,n\n1,3,"said "no" and\n1,3,b\n1,3,c"\n1,3,d\n', OUT_OF_PLACE.format(2)),
        ('m1,m2,n\n1,3,a\n\n1,3,"p\nq"\n1,3,5" wide\n1,3,"p"q\n', OUT_OF_PLACE.format(6)),
        ('m1,m2,n\n1,3,"a"\n1,3,"p"q\n', OUT_OF_PLACE.format(3)),
        ('m1,m2,n\n1,3,"p" \n', OUT_OF_PLACE.format(2)),
        ('m1,m2,n\n1,3, "p"\n', OUT_OF_PLACE.format(2)),
        ('m1,m2,n\n1,3,a"\n1,3,"b\n', OUT_OF_PLACE.format(2)),
        ('m1;m2;n\n1;3;"a","b"\n', OUT_OF_PLACE.format(2)),
        ('\n"m1"x,m2\n1,3\n', OUT_OF_PLACE.format(2)),
        ('m1,m2\n"x\n"",\n"b', OUT_OF_PLACE.format(2)),
        ('m1,m2\n"p\nq",r"\n', OUT_OF_PLACE.format(2)),
        (f'm1,m2,n\n1,3,{LONG}\n1,3,"x"y\n', OUT_OF_PLACE.format(3)),
        ('m1,m2,n\n1,3,"x\ny', LEFT_OPEN.format(2)),
        ('m1,m2,n\n1,3,"x"\n1,3,"x""\n1,3,y\n', LEFT_OPEN.format(3)),
        ('m1,m2\n"1,2\n' + "1,2\n" * 700_000, "the row that begins in line 2 is longer than 1 MB, the most taken; is a quotation mark left open?"),
    ],
    ids=count(),
)  # fmt: skip
def test_unreadable_csv(
    batch: Batch, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, content: str, why: str
) -> None:
    for size in (WHOLE, 4) if OUT_OF_PLACE[-20:] in why or LEFT_OPEN[:20] in why else (WHOLE,):
        monkeypatch.setattr(tables, "PIECE_BYTES", size)
        ran = batch(content, "-o OUT.csv")
        assert (ran.status, ran.out, ran.err) == (1, "", f"atwood: cannot read IN: {why}\n")
    assert [path.name for path in tmp_path.iterdir()] == ["in.csv"]


NOT_NDJSON = "is not a line of NDJSON:"


@pytest.mark.parametrize(
    ("content", "why"),
    [
        ("", "it is empty"),
        ('{"m1":1}\n', "column m2 is missing; there are 'm1'"),
        ("{}\n", "its objects are empty"),
        ('\n{}\n[1]\n"x"\n', f"row 2: '[1]' {NOT_NDJSON} it is no object"),
        ("[" * 100_000, f"row 1: '{'[' * 39}...{'[' * 9}' {NOT_NDJSON} it is nested too deeply"),
        (b'{"m1":1,"m2":2}\n\n{"m1":1,"m2":"\xff"}\n', "line 3 is not UTF-8: byte 0xff; save it as UTF-8"),
        ('{"m1":1,"m2":2}\n{"m1":1,"m2":2,"error":0}\n', f"column 'error' {RENAME}"),
        ("".join(f'{{"k{i}":1}}\n' for i in range(1025)), "it has more than 1024 columns, the most taken"),
    ],
    ids=count(),
)
@pytest.mark.parametrize("target", ["csv", "ndjson"])
def test_unreadable_ndjson(batch: Batch, tmp_path: Path, content: str, why: str, target: str) -> None:
    ran = batch(content, f"-o OUT.{target}", "in.ndjson")
    assert (ran.status, ran.out, ran.err) == (1, "", f"atwood: cannot read IN: {why}\n")
    assert [path.name for path in tmp_path.iterdir()] == ["in.ndjson"]


@pytest.mark.parametrize("target", ["csv", "ndjson", "parquet"])
@pytest.mark.parametrize(
    ("line", "why"),
    [
        ('{"m1":1 "m2":2}', "Expecting ',' delimiter at character 9"),
        ('{"m1":01,"m2":2}', "Expecting ',' delimiter at character 8"),
        ('{"m1":1,"m2":2,"m1":3}', "column 'm1' is there 2 times"),
        ("[1]", "it is no object"),
        ("NaN", "it is no object"),
        ('{"m1":1,"m', "Unterminated string starting at character 9"),
    ],
    ids=count(),
)
@pytest.mark.parametrize("at", [0, 99])
def test_a_line_that_is_no_object_is_an_error_of_its_row(
    batch: Batch, tmp_path: Path, line: str, why: str, at: int, target: str
) -> None:
    lines = ['{"m1":1,"m2":3}'] * 99
    lines.insert(at, line)
    for words, status in ((f"-o OUT.{target} --force", 1), (f"-o OUT.{target} --force --allow-errors", 0)):
        ran = batch("\n".join(lines), f"{words} --only regime", "in.ndjson")
        error = f"{line!r} {NOT_NDJSON} {why}"
        assert (ran.status, ran.out) == (status, "")
        assert (
            ran.err
            == f"atwood: 100 rows: 99 no-slip; 1 error.\natwood: first error, in row {at + 1}: {error}\n"
        )
    rows = read_back(tmp_path / f"out.{target}", target).select("m1", "m2", "regime", "error").rows()
    assert rows.pop(at) == (None, None, None, error)
    assert set(rows) == {(1, 3, "no-slip", None)}


JSON_VALUES = [
    *("1", "-0", "1.0", "1e400", "0.1E-2", "12345678901234567890", "true", "null", '"x"', '"é\u2028\x7f"', '""'),
    *("01", "+1", ".5", "1.", "NaN", "-Infinity", '"\\u0031"', '"a\tb"', '"a\\"b"', '"\\ud800"', "[1, 2]", '{"a" : {}}', ""),
]  # fmt: skip


def test_lines_in_bulk_are_read_as_one_by_one(batch: Batch, monkeypatch: pytest.MonkeyPatch) -> None:
    rng = Random(29)
    more = ["M", "mu", "é (x)", "a.b*", 'q\\"', "\\u0041", " "]
    for _ in range(60):
        keys = ["m1", "m2", *rng.sample(more, rng.randint(0, 4))]
        odd, lines = rng.choice([0.0, 0.01, 0.2]), []
        for _ in range(rng.choice([3, 120])):
            some = [key for key in keys if key in ("m1", "m2") or rng.random() > odd]
            rng.shuffle(some if rng.random() < odd else [])
            pairs = []
            for key in some:
                value = rng.choice(JSON_VALUES if rng.random() < odd else ["1", "3.5", '"2"', "null"])
                pairs.append(f'"{key}"{rng.choice(["", " "])}:{value}')
            pairs += rng.choices(pairs, k=rng.random() < odd / 10)
            line = rng.choice([",", " , "]).join(pairs)
            lines.append(f"{{ {line.replace(chr(92), '') if rng.random() < odd else line}}}")
        content = "\n".join(lines)
        words = f"{FROM_JSON} --only acceleration --to {rng.choice(['csv', 'ndjson'])}"
        monkeypatch.setattr(tables, "PIECE_BYTES", rng.choice([500, WHOLE]))
        came = []
        for fewest in (1, 1000):
            monkeypatch.setattr(ndjson, "FEWEST_LINES", fewest)
            came.append(batch(content, words))
        assert came[0] == came[1]
        assert came[0].status == 1 or len(came[0].out.splitlines()) >= len(lines)


@pytest.mark.parametrize(
    ("content", "why"),
    [
        ('{"m1":1,"m2":3}\n{"m1":1,"m2":3,"\\ud800":1}\n', "the key '\\ud800' is not Unicode; give --to ndjson"),
        ('{"m1":1,"m2":2}\n' * 2 + '{"m1":1,"m2":2,"x":3}\n', "a row after row 2 has 'x', for which there is no column by now; give --to ndjson"),
    ],
    ids=count(),
)  # fmt: skip
@pytest.mark.parametrize("target", ["csv", "parquet"])
def test_what_stays_in_json(
    batch: Batch, monkeypatch: pytest.MonkeyPatch, content: str, why: str, target: str
) -> None:
    monkeypatch.setattr(tables, "PIECE_BYTES", 20 if "x" in content else WHOLE)
    ran = batch(content, f"-o OUT.{target}", "in.ndjson")
    assert (ran.status, ran.err) == (1, f"atwood: cannot read IN: {why}\n")
    ran = batch(content, "--to ndjson --only regime", "in.ndjson")
    assert ran.out == content.replace("}\n", ',"regime":"no-slip","error":null}\n')


WIDE = "in UTF-16 or UTF-32; save it as UTF-8"
PACKED = "compressed; unpack it first"
WORKBOOK = "a workbook (.xlsx, .xls), or an archive; save the sheet as CSV"
ARRAY = "a JSON array; write an object a line, and give --from ndjson to batch"
TEXT = "m1,m2\n1,3\n"


@pytest.mark.parametrize("command", ["batch", "batch --from=ndjson", "fit"])
@pytest.mark.parametrize(
    ("content", "kind"),
    [
        *((TEXT.encode(f"utf-{name}"), WIDE) for name in ("16", "16-le", "16-be", "32")),
        *((pack(TEXT.encode()), PACKED) for pack in (gzip.compress, bz2.compress, lzma.compress)),
        (b"\x28\xb5\x2f\xfd$", PACKED),
        (b"PK\3\4\r\n\r", WORKBOOK),
        (b"\xd0\xcf\x11\xe0\xa1\r", WORKBOOK),
        (b"PAR1\r", "Parquet; batch reads it with --from parquet, and fit reads CSV"),
        (b'[{"m1": 1, "m2": 3}]\n', ARRAY),
        (b'[\n  {"m1": 1}\n]\n', ARRAY),
        (b'{"m1": 1, "m2": 3}\n', "NDJSON; batch reads it with --from ndjson, and fit reads CSV"),
    ],
    ids=count(),
)
def test_a_file_of_another_kind_is_called_what_it_is(
    batch: Batch, command: str, content: bytes, kind: str
) -> None:
    ran = batch(content, command=command)
    if not (kind.startswith("NDJSON") and "ndjson" in command):
        assert (ran.status, ran.out, ran.err) == (1, "", f"atwood: cannot read IN: it is {kind}\n")


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
    atwood: Atwood, tmp_path: Path, name: str, content: bytes
) -> None:
    (tmp_path / name).write_bytes(content)
    ran = atwood("batch", str(tmp_path / name), "-o", str(tmp_path / "\x1b[32m.csv"))
    assert ran.status == 1
    assert re.search(r"\\(x|u00)1b\[31m|quotation mark", ran.err)
    assert "\x1b" not in ran.err


# Memory


def test_quotation_marks_are_written_where_they_are_needed(
    batch: Batch, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tables, "PIECE_BYTES", 16)
    heading = '"a ""b"", c"'
    ran = batch(f"{heading},m1,m2\n" + "x,1,2\n" * 3, "--only regime")
    assert ran.out == f"{heading},m1,m2,regime,error\n" + "x,1,2,no-slip,\n" * 3
    assert batch(heading + ",m1,m2\nx,1,2\n", "--only regime").out == ran.out.replace(
        "x,1,2,no-slip,\n" * 2, ""
    )
    ran = batch("m1;m2\n" + "0,5;1\n" * 3, "--only regime")
    assert ran.out == "m1,m2,regime,error\n" + '"0,5",1,no-slip,\n' * 3


@pytest.mark.parametrize(
    ("limit", "kind", "content", "heights"),
    [
        # As objects, 700,000 rows `{}` are a hundred times as long as as text.
        ("PIECE_ROWS", "ndjson", '\n{"m1":1,"m2":2}\n\n' + '{"m1":1,"m2":3}\n' * 6 + "{}\n", [3, 3, 2]),
        ("PIECE_ROWS", "csv", "m1,m2\n" + "1,3\n" * 4 + "1\n" + "1,3\n" * 3, [3, 3, 2]),
        # Keys that differ make many columns.
        ("PIECE_CELLS", "ndjson", "".join(f'{{"m1":1,"m2":3,"k{i}":{i}}}\n' for i in range(8)), [4, 4]),
        ("PIECE_CELLS", "csv", f"m1,m2{',k' * 8}\n".replace("k", "{}").format(*range(8)) + '1,3,"\n"\n\n1,3\n' * 4, [4, 4]),
    ],
    ids=count(),
)  # fmt: skip
def test_pieces_have_few_rows_and_cells(
    batch: Batch, monkeypatch: pytest.MonkeyPatch, limit: str, kind: str, content: str, heights: list[int]
) -> None:
    words = f"--from {kind} --only regime --allow-errors"
    whole = batch(content, words)
    for module in (tables, ndjson):
        monkeypatch.setattr(module, limit, 3 if limit == "PIECE_ROWS" else 40)
    file = io.BytesIO(content.encode())
    pieces = list(
        tables.read_csv(file, ",", inputs_among)
        if kind == "csv"
        else ndjson.read_ndjson(tables.blocks_of(file), inputs_among, False)
    )
    assert [piece.frame.height for piece in pieces if piece.frame.height] == heights
    assert [piece.size for piece in pieces] == [len(content), *[0] * (len(pieces) - 1)]
    assert batch(content, words) == whole
    assert len(records(whole)) == 8


# What spreadsheets write


@pytest.mark.parametrize("kind", SEPARATORS)
@pytest.mark.parametrize("mark", [";", "\t"])
def test_semicolons_tabs_and_decimal_commas(batch: Batch, kind: str, mark: str) -> None:
    rows = ["run m1 m2 M mu", "a 1,5 3 10 0,3", "b 1 2,25 10 _", "c 1e0 3 1e1 1e-1"]
    content = "\n".join(rows).replace("_", "")
    ran = batch("\ufeff" + content.replace(" ", mark).replace("\n", "\r\n"), "--only tension_1", f"in.{kind}")
    pointed = batch(content.replace(",", ".").replace(" ", ","), "--only tension_1")
    assert [row["tension_1"] for row in records(ran)] == [row["tension_1"] for row in records(pointed)]
    assert [row["m1"] for row in records(ran)] == ["1,5", "1", "1e0"]  # as they were
    parted = f"cells parted by {tables.PARTED_BY[mark]}, " * (mark != SEPARATORS[kind])
    assert ran.err == f"atwood: read as: {parted}decimal commas.\n{pointed.err}"
    assert pointed.err == "atwood: 3 rows: 2 no-slip, 1 slip; no errors.\n"


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
    frame = pl.DataFrame({**{other: [text] * 2 for other, text in row.items()}, heading: [cell] * 2})
    value: Any = exact and float(exact)
    if source == "parquet":
        frame = frame.with_columns(pl.all().str.strip_chars().cast(pl.Float64, strict=False))
        if value and math.isfinite(value):  # the cell is a double already
            value = float(Fraction(float(cell)) * Fraction(str(exact)) / Fraction(cell.strip()))
    start = str(written(frame, source, tmp_path / f"in.{source}"))
    given: dict[str, Any] = {"g": 9.80665, **{other: float(text) for other, text in row.items()}, name: value}
    right = solve(**given)
    for target in ("csv", "ndjson"):
        only = ["--only", "tension_1,torque,mu_verge"]
        ran = atwood("batch", start, "--accuracy", "exact", *only, "--to", target)
        printed = records(ran)[0] if target == "csv" else json.loads(ran.out.splitlines()[0])
        assert not printed["error"]
        assert [float(printed[one]) for one in ("tension_1", "torque")] == [right.tension_1, right.torque]
        unit = heading.strip(f"{name}[( )]-")
        said = f"atwood: read as: {heading!r} as {name}{f' in {unit}' if unit else ''}.\n" * (heading != name)
        assert ran.err.startswith(f"{said}atwood: 2 rows")


def test_what_a_unit_takes_beyond_the_doubles_is_an_error_of_the_row(atwood: Atwood, tmp_path: Path) -> None:
    for factor, cell in (("ug", 1e-323), ("t", 1e308), ("kg t^9/ug^9 t^9/ug^9 t^9/ug^9", 1.0)):
        frame = pl.DataFrame({f"m1 ({factor})": [cell, 0.0], "m2": [1.0, 1.0]})
        ran = atwood("batch", str(written(frame, "parquet", tmp_path / "in.parquet")))
        assert errors_of(ran) == [f"m1 {cell!r} {BEYOND}", ""]


MEANT = {
    "m1": ["m1_g", "mass1", "m₁", "M1"],
    "M": ["pulley_mass", "Pulley mass", "m", "m_pulley", "M_kg"],
    "R": ["radius", "r", "R_cm", "R cm"],
    "wrap": ["wrap_deg", "Wrap", "angle", "φ"],
    "mu": ["μ", "µ", "MU", "mu_s", "friction"],
    "mu_k": ["mu-k", "mu k", "μ_k", "muk"],
    "g": ["G", "gravity"],
    "inertia": ["beta", "Inertia"],
    "I": ["moment of inertia", "Moment of inertia (g cm2)"],
    "axle": ["Axle (N)", "axle_mN", "axle friction"],
}


@pytest.mark.parametrize(("name", "column"), [(name, one) for name, them in MEANT.items() for one in them])
def test_a_column_that_could_be_meant_for_an_input_is_an_error(
    batch: Batch, atwood: Atwood, tmp_path: Path, name: str, column: str
) -> None:
    others = "m2" if name == "m1" else "m1,m2"
    ran = batch(f"{others},{column}\n{'1,' * (others.count(',') + 1)}7\n")
    why = f"could be meant for {name}; name it so, with a unit like 'm1 (g)'{LABEL}{column!r}"
    assert (ran.status, ran.out) == (1, "")
    assert ran.err == f"atwood: cannot read IN: column {column!r} {why}\n"
    (tmp_path / "in.csv").write_text(f"m1,m2,{column}\n1,3,7\n", encoding="utf-8")
    assert atwood("batch", str(tmp_path / "in.csv"), "--label", column).status == 0
    if name not in ("m1", "inertia"):
        assert batch(f"m1,m2,{name},{column}\n1,3,,7\n").status == 0  # it is there, so this is no input


@pytest.mark.parametrize(
    ("column", "why"),
    [
        *((name, "tells of a motion, which only solve takes") for name in ("a", "drop", "time", "Time (s)", "a (m/s2)")),
        *((f"axle ({unit})", "has a unit of torque; it takes one of force (N, mN, kN, lbf, kgf)") for unit in ("mNm", "N m")),
        ("M (cm)", f"has a unit of length; {OF_MASS}"),
        ("M (est.)", "has the unknown unit 'est.'; there are kg, g, mg, ug, t, lb, lbs, oz, st, slug"),
        ("mu (kg)", "must hold plain numbers, without the 'kg'"),
        ("wrap (rad)", "has angles in radians; give degrees or turns"),
        ("M (kg*st^9/lb^9*st^9/lb^9*st^9)", f"has a unit of another dimension; {OF_MASS}"),
    ],
)  # fmt: skip
def test_a_column_that_is_an_input_elsewhere_is_an_error(
    batch: Batch, atwood: Atwood, tmp_path: Path, column: str, why: str
) -> None:
    ran = batch(f"m1,m2,{column}\n1,3,7\n")
    assert (ran.status, ran.out) == (1, "")
    assert ran.err == f"atwood: cannot read IN: column {column!r} {why}{LABEL}{column!r}\n"
    passed = atwood("batch", str(tmp_path / "in.csv"), "--label", column, "--only", "regime")
    assert passed.out == f"m1,m2,{column},regime,error\n1,3,7,no-slip,\n"


@pytest.mark.parametrize("unit", ["*st^9/lb^9" * 10_000, "x" * 100_000, " " * 50_000 + "g kg"])
def test_a_heading_whose_unit_is_long_takes_no_time(batch: Batch, unit: str) -> None:
    ran = batch(f"m1,m2,M (kg{unit})\n1,3,7\n")
    assert (ran.status, ran.out, len(ran.err) < 400) == (1, "", True)
    assert "characters; at most 60 are taken" in ran.err or "another dimension" in ran.err


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
        ("", "Missing argument 'IN...'; atwood batch -h shows how"),
        ("x.csv -o a.csv -o b.csv", "--output is given 2 times; give it once"),
    ],
)
def test_wrong_usage(atwood: Atwood, words: str, message: str) -> None:
    assert atwood("batch", *words.split()) == (2, "", f"atwood: {message}\n")


def test_files_that_cannot_be_read_or_written(
    batch: Batch, atwood: Atwood, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    batch("m1,m2\n1,2\n", "-o OUT.csv")
    monkeypatch.chdir(tmp_path)
    for words, message in [
        ("no.jsonl", "cannot read no.jsonl: No such file or directory"),
        (". --from csv", "cannot read .: Is a directory"),
        ("in.csv -o no/a.csv", "cannot write no/a.csv: No such file or directory"),
        ("in.csv -o out.csv", "cannot write out.csv: it exists already; --force replaces it"),
        *[("/proc/self/mem --from csv", "cannot read /proc/self/mem: Input/output error")]
        * Path("/proc/self/mem").exists(),
    ]:
        assert atwood("batch", *words.split()) == (1, "", f"atwood: {message}\n")
    assert Path("out.csv").read_text().startswith("m1,m2,regime,")
    assert atwood("batch", *"in.csv -o out.csv --force --only torque --allow-errors".split()).status == 1
    assert Path("out.csv").read_text() == "m1,m2,torque,error\n1,2,,\n"


@pytest.mark.parametrize("line", ["in.csv -o in.csv --force", "in.csv -o hard.csv --force", "in.csv -o soft.csv --force", "- -o in.csv --force < in.csv", "in.csv >> in.csv", "- < in.csv >> in.csv", "in.csv 1<> in.csv"])  # fmt: skip
def test_the_input_is_never_overwritten(tmp_path: Path, line: str) -> None:
    scenes = tmp_path / "in.csv"
    scenes.write_text(TEXT)
    (tmp_path / "hard.csv").hardlink_to(scenes)
    (tmp_path / "soft.csv").symlink_to(scenes)
    ran = process(shell=f'cd "{tmp_path}"; atwood batch {line}')
    name = line.split("-o ")[1].split()[0] if "-o" in line else "-"
    why = f"--output {name!r} is the input, which is never overwritten; name another"
    assert (ran.status, ran.out, ran.err) == (2, "", f"atwood: {why}\n")
    assert scenes.read_text() == TEXT


def test_without_polars_one_line_says_what_to_install(batch: Batch, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "polars", None)
    why = f"this needs polars; install it with: {PIP} install 'atwood-cli[batch]'"
    assert batch(TEXT) == (1, "", f"atwood: {why}\n")


def test_help_shows_the_columns_and_examples(atwood: Atwood) -> None:
    ran = atwood("batch", "-h")
    assert ran.status == 0
    for words in ("m1, m2, M, mu, mu_k, g, inertia, I, R", "scenes.csv -o results.csv", "--allow-errors"):
        assert words in ran.out


# How it ends


STATUS = {"SIGKILL": -9, "SIGINT": 130, "SIGTERM": 143, "SIGHUP": 129}
needs_signals = pytest.mark.skipif(os.name == "nt", reason="needs POSIX signals")


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


@needs_signals
@pytest.mark.parametrize("blow", ["SIGINT", "SIGTERM", "SIGHUP"])
def test_a_run_stopped_in_an_import_shows_no_traceback(blow: str) -> None:
    """Classes that are being made, and modules written in C, turn what stops them into other errors."""
    ended = subprocess.run([sys.executable, "-c", TURNED, blow], capture_output=True, check=False)
    assert (ended.returncode, ended.stderr) == (STATUS[blow], b"")


@needs_signals
@pytest.mark.parametrize(
    ("blows", "before"),
    [
        ("SIGKILL", None),
        ("SIGINT", None),
        ("SIGTERM", "as it was"),
        ("SIGHUP", None),
        ("SIGINT SIGINT", None),
    ],
)
def test_a_run_cut_short_leaves_no_output(tmp_path: Path, blows: str, before: str | None) -> None:
    out = tmp_path / "out.csv"
    if before:
        out.write_text(before)
    child = hearing("batch", "-", "-o", str(out), "--force", stdin=subprocess.PIPE)
    assert child.stdin is not None
    child.stdin.write(b"m1,m2,M\n" + b"1,3,10\n" * 1_000_000)  # some pieces are done, more are awaited
    child.stdin.flush()
    while not any(path.stat().st_size for path in tmp_path.glob(".atwood-*")):
        assert child.poll() is None
        time.sleep(0.01)
    for blow in blows.split():
        child.send_signal(signal.Signals[blow])
    _, err = child.communicate(timeout=HANGS)
    assert child.returncode == STATUS[blows.split()[0]]
    assert out.exists() == (before is not None)
    if blows == "SIGKILL":
        assert err == b""
    else:
        assert [path.read_text() for path in tmp_path.iterdir()] == ([before] if before else [])
        is_left = "stays as it was" if before else "was not written"
        said = re.fullmatch(
            rf"atwood: stopped after (\d+) rows; {re.escape(str(out))} {is_left}\n", err.decode()
        )
        assert said
        assert 0 < int(said[1]) <= 1_000_000


@needs_signals
def test_what_is_to_outlive_its_terminal_does(tmp_path: Path) -> None:
    """Under nohup, which has SIGHUP ignored."""
    ignore = partial(signal.signal, signal.SIGHUP, signal.SIG_IGN)
    child = hearing("batch", "-", "-o", str(tmp_path / "out.csv"), stdin=subprocess.PIPE, preexec_fn=ignore)
    while not list(tmp_path.iterdir()):
        time.sleep(0.01)
    child.send_signal(signal.SIGHUP)
    assert child.communicate(TEXT.encode(), HANGS) == (b"", (ONE + NEEDS_MU).encode())
    assert child.returncode == 0


@needs_signals
@pytest.mark.parametrize("kind", ["csv", "parquet"])
def test_a_pipe_that_brings_nothing_is_waited_for_until_it_is_stopped(tmp_path: Path, kind: str) -> None:
    os.mkfifo(tmp_path / "in")
    for blow, is_open in (("SIGTERM", False), ("SIGINT", False), ("SIGINT", True)):
        child = hearing("batch", str(tmp_path / "in"), "--from", kind)
        writer = os.open(tmp_path / "in", os.O_RDWR) if is_open else None
        time.sleep(1)
        child.send_signal(signal.Signals[blow])
        assert child.communicate(timeout=HANGS) == (b"", b"")
        assert child.returncode == STATUS[blow]
        if writer is not None:
            os.close(writer)


def test_a_reader_that_leaves_early_ends_it_quietly(tmp_path: Path) -> None:
    (tmp_path / "in.csv").write_text("m1,m2,M\n" + "1,3,10\n" * 300_000)
    ran = process(shell=f"set -o pipefail; atwood batch {tmp_path}/in.csv --only regime | head -1")
    assert (ran.status, ran.out, ran.err) == (0, "m1,m2,M,regime,error\n", "")


def test_a_full_disk_is_an_error(batch: Batch) -> None:
    if not Path("/dev/full").exists():
        pytest.skip("needs a device that is always full")
    ran = batch(TEXT, "-o /dev/full --to csv")
    assert (ran.status, ran.err) == (1, "atwood: cannot write the output: No space left on device\n")


def test_closed_streams(tmp_path: Path) -> None:
    (tmp_path / "in.csv").write_text("m1,m2\n1,x\n")
    for streams in (">&-", "2>&-", ">&- 2>&-"):
        ran = process(shell=f"atwood batch {tmp_path}/in.csv {streams}")
        assert (ran.status, "Traceback" in ran.err) == (1, False)
    ran = process(shell="atwood batch - <&-")
    assert (ran.status, ran.err) == (1, "atwood: cannot read stdin: it is closed\n")


BAR = """
from itertools import count, repeat
from atwood_cli.__main__ import main
from atwood_cli.batch import formats
from atwood_cli.output import page
formats.PIECE_BYTES = 64
page.monotonic = CLOCK.__next__
main()
"""


def test_a_bar_on_a_terminal_after_a_second(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # A setting of Python is for a process of its own, in which the clock is ours.
    (tmp_path / "in.csv").write_text(TEXT + "1,3\n" * 99)
    words = ["batch", f"{tmp_path}/in.csv", "--force", "-o", f"{tmp_path}/out.csv"]
    said = f"atwood: 100 rows: 100 no-slip; no errors.\n{NEEDS_MU}"
    monkeypatch.setattr("tests.running.QUICK", BAR.replace("CLOCK", "count()"))
    seen = plain(on_terminal(*words, columns=80, PYTHONUTF8="1"))
    assert "━" in seen
    assert "%" in seen
    assert seen.endswith(said)
    monkeypatch.setattr("tests.running.QUICK", BAR.replace("CLOCK", "repeat(0)"))
    assert on_terminal(*words, columns=80, PYTHONUTF8="1") == said
