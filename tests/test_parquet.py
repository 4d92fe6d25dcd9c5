"""Parquet: columns keep their types, damage is a sentence, and groups have a fixed number of rows."""

import io
import json
import math
import re
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from datetime import timedelta
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import given
from hypothesis import strategies as st

from atwood_cli import solve_table
from atwood_cli.batch.parquet import write_frames

from .conftest import examples
from .running import Atwood, Ran, process

Batch = Callable[..., Ran]


@pytest.fixture
def batch(atwood: Atwood, tmp_path: Path) -> Batch:
    """Run `atwood batch` on a frame or a table of that content; in messages the file is called IN."""

    def call(content: pl.DataFrame | pa.Table | bytes, *words: str) -> Ran:
        path = tmp_path / "in.parquet"
        if isinstance(content, bytes):
            path.write_bytes(content)
        elif isinstance(content, pl.DataFrame):
            content.write_parquet(path)
        else:
            pq.write_table(content, path)
        ran = atwood("batch", str(path), *(word.replace("OUT", str(tmp_path / "out")) for word in words))
        return ran._replace(err=ran.err.replace(str(path), "IN"))

    return call


def with_scene(column: Any) -> pa.Table:
    return pa.table({"m1": [1.0] * len(column), "m2": [3] * len(column), "x": column})


@given(
    st.lists(
        st.tuples(*(st.sampled_from([1.0, 2.0, 0.3, math.nan, math.inf, None]) for _ in range(4))),
        max_size=20,
    )
)
@examples(40)
def test_nan_in_parquet_is_bad_and_null_is_not_given(
    batch: Batch, tmp_path: Path, rows: list[tuple[float | None, ...]]
) -> None:
    columns = ("m1", "m2", "M", "mu")
    frame = pl.DataFrame(rows, schema=dict.fromkeys(columns, pl.Float64), orient="row")
    batch(frame, "-o", "OUT.parquet", "--force")
    solved = pl.read_parquet(tmp_path / "out.parquet")
    assert solved.select(columns).equals(frame)
    for values, error, regime in zip(rows, solved["error"], solved["regime"], strict=True):
        row = {name: value for name, value in zip(columns, values, strict=True) if value is not None}
        wrong = [name for name, x in row.items() if not (x < math.inf or (name, x) == ("M", math.inf))]
        missing = not {"m1", "m2"} <= row.keys()
        assert (error is None) == (not wrong and not missing) == (regime is not None)
        if wrong:
            assert error.startswith(f"{wrong[0]} {row[wrong[0]]} must be") or missing


COLUMNS: dict[str, pa.Array] = {
    "decimal": pa.array([Decimal("1.10"), Decimal("-0.10")], pa.decimal128(38, 2)),
    "bytes": pa.array([b"abc", None], pa.binary(3)),
    "half": pa.array([np.float16(1.5), None], pa.float16()),
    "map": pa.array([[("k", 1)], []], pa.map_(pa.string(), pa.int32())),
    "when": pa.array([1, None], pa.timestamp("ns", "Europe/Berlin")),
    "time": pa.array([1, None], pa.time64("ns")),
    "span": pa.array([1, None], pa.duration("us")),
    "null": pa.nulls(2),
    "truth": pa.array([True, None]),
    "pair": pa.array([[1, 2], [3, 4]], pa.list_(pa.int8(), 2)),
    "category": pa.array(["a", None]).dictionary_encode(),
    "structs": pa.array([[{"a": "x"}], None]),
    "bytes in a list": pa.array([[b"x"], []]),
    "large": pa.array([2**64 - 1, None], pa.uint64()),
    "far date": pa.array([2**31 - 1, None], pa.date32()),
    "structure": pa.array([{"a": 1, "b": "x"}, None]),
}


if hasattr(pa, "json_"):  # from 19
    COLUMNS["json"] = pa.array(["{}", None], pa.json_())


@pytest.mark.parametrize("name", COLUMNS)
def test_columns_of_every_type_pass_through(batch: Batch, tmp_path: Path, name: str) -> None:
    ran = batch(with_scene(COLUMNS[name]), "-o", "OUT.parquet")
    assert ran.status == 0
    assert ran.err.startswith("atwood: 2 rows: 2 no-slip; no errors.\n")
    before, after = (pl.read_parquet(tmp_path / f"{one}.parquet")["x"] for one in ("in", "out"))
    assert before.dtype == after.dtype
    assert before.equals(after)


def test_a_number_outside_its_domain_is_an_error_of_its_row(batch: Batch) -> None:
    """It ended the run."""
    for kind, minus in ((pl.Int64, "-1"), (pl.Float64, "-1.0")):
        frame = pl.DataFrame({"m1 (g)": [1, -1, 1], "m2": [3, 3, -1]}).cast(kind)
        ran = batch(frame, "--only", "regime", "--to", "ndjson")
        errors = [json.loads(line)["error"] for line in ran.out.splitlines()]
        domain = "must be 0 or more, and finite"
        assert (ran.status, errors) == (1, [None, f"m1 '{minus}g' {domain}", f"m2 -1.0 {domain}"])


TABLE = pl.DataFrame(
    {
        "id": ["a", "b", "c", None],
        "m1 (g)": [100.0, None, 1.0, 5.0],
        "m2": [3, 1, 1, 2],
        "M": [None, math.inf, math.nan, 8.0],
        "x": [[1], [], [2], None],
    }
)


@pytest.mark.parametrize("kind", ["polars", "polars lazy", "pandas", "pyarrow"])
@pytest.mark.parametrize("quantities", [None, ["tension_1", "regime"]])
def test_solve_table_appends_what_batch_does(
    batch: Batch, tmp_path: Path, kind: str, quantities: list[str] | None
) -> None:
    only = [word for name in quantities or [] for word in ("--only", name)]
    batch(TABLE, *only, "--accuracy", "exact", "-o", "OUT.parquet", "--force")
    right = pl.read_parquet(tmp_path / "out.parquet")
    if kind == "pandas":
        pd = pytest.importorskip("pandas")
        table = TABLE.to_pandas(use_pyarrow_extension_array=True).set_index(pd.Index([7, 7, 2, 0]))
        solved = solve_table(table, quantities, "exact")
        assert list(solved.index) == [7, 7, 2, 0]
        assert all(solved.dtypes[table.columns] == table.dtypes)
        frame = pl.from_pandas(solved[right.columns[5:]])
        assert solved[table.columns].to_string() == table.to_string()
        frame = right[:, :5].hstack(frame)
    else:
        table = {"polars": TABLE, "polars lazy": TABLE.lazy(), "pyarrow": TABLE.to_arrow()}[kind]
        solved = solve_table(table, quantities, "exact")
        assert type(solved) is type(table)
        frame = pl.DataFrame(solved.lazy().collect() if "polars" in kind else solved)
    assert frame.equals(right)
    assert frame.schema == right.schema
    assert frame["error"].null_count() == 2


@pytest.mark.parametrize(
    ("table", "why"),
    [
        ([1], "a table is a data frame of polars or pandas, or an Arrow table, not list"),
        (pl.Series([1]), "a table is a data frame of polars or pandas, or an Arrow table, not Series"),
        (TABLE.drop("m2"), "cannot read the table: column m2 is missing; there are 'id', 'm1 (g)', 'M', 'x'"),
        (TABLE.rename({"id": "radius"}), "cannot read the table: column 'radius' could be meant for R; name it so, with a unit like 'm1 (g)'"),
        (TABLE.rename({"id": "error"}), "cannot read the table: column 'error' would be there twice, as a result is named so; rename it, or name other results by quantities"),
    ],
)  # fmt: skip
def test_what_solve_table_refuses(table: Any, why: str) -> None:
    with pytest.raises(ValueError, match=f"^{re.escape(why)}$"):
        solve_table(table)


@pytest.mark.parametrize("kind", [pl.Int8, pl.UInt64, pl.Float32, pl.Decimal(10, 2)])
def test_inputs_keep_their_types(batch: Batch, tmp_path: Path, kind: Any) -> None:
    frame = pl.DataFrame({"m1": [1, 2], "m2": [3, None]}).cast(kind)
    assert batch(frame, "-o", "OUT.parquet").status == 1
    result = pl.read_parquet(tmp_path / "out.parquet")
    assert result.select("m1", "m2").equals(frame)
    assert result.select("m1", "m2").schema == frame.schema
    assert result["error"].to_list() == [None, "m2 is missing; give both masses, m1 and m2"]


@pytest.mark.parametrize(
    ("kind", "column", "holds"),
    [
        ("ndjson", [b"x"], "Binary"),
        ("ndjson", [[b"x"]], "List(Binary)"),
        ("csv", [b"x"], "Binary"),
        ("csv", [[1]], "List(Int64)"),
        ("tsv", [{"a": 1}], "Struct({'a': Int64})"),
        ("csv", [timedelta(1)], "Duration(time_unit='us')"),
    ],
)
def test_what_a_format_has_no_place_for(batch: Batch, kind: str, column: list[Any], holds: str) -> None:
    ran = batch(with_scene(pa.array(column)), "--to", kind)
    why = f"cannot write column 'x', which holds {holds}, as {kind}; give --to parquet"
    assert ran == (1, "", f"atwood: {why}\n")


@pytest.mark.parametrize("kind", ["csv", "ndjson"])
def test_a_date_beyond_those_of_polars_is_a_sentence(batch: Batch, kind: str) -> None:
    for one in (pa.array([10**8], pa.date32()), pa.array([-(2**63)], pa.timestamp("us"))):
        ran = batch(with_scene(one), "--to", kind)
        why = "which holds a date beyond the years of polars, -262143 to 262142,"
        assert (ran.status, ran.err) == (
            1,
            f"atwood: cannot write column 'x', {why} as {kind}; give --to parquet\n",
        )
    latest = pa.array([95_026_236], pa.date32())
    assert "+262142-12-31" in batch(with_scene(latest), "--to", kind).out


def test_nested_columns_go_into_json(batch: Batch) -> None:
    ran = batch(with_scene(pa.array([{"Binary": [1]}])), "--to", "ndjson", "--only", "regime")
    assert ran.out == '{"m1":1.0,"m2":3,"x":{"Binary":[1]},"regime":"no-slip","error":null}\n'


def test_whatever_polars_panics_over_is_a_sentence(batch: Batch, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its exception is none of Python's `Exception`."""

    def panic(*_: object, **__: object) -> None:
        raise pl.exceptions.PanicException("out of something\nat all")

    monkeypatch.setattr(pl.DataFrame, "write_csv", panic)
    assert batch(with_scene([1])) == (1, "", "atwood: cannot write csv: out of something\n")


@pytest.mark.parametrize("names", [["m1", "m2", ""], ["", "column_0", "m1", "m2"]])
def test_a_column_keeps_an_empty_name(batch: Batch, tmp_path: Path, names: list[str]) -> None:
    table = pa.table([[float(i)] for i in range(1, len(names) + 1)], names=names)
    assert batch(table, "-o", "OUT.parquet", "--only", "regime").status == 0
    assert pq.read_table(tmp_path / "out.parquet").column_names == [*names, "regime", "error"]


NO_PARQUET = "atwood: cannot read IN: it is not Parquet that polars can read: "


@pytest.mark.parametrize(
    "column",
    [pa.array([Decimal("1.1")], pa.decimal256(50, 2)), pa.array([[1]], pa.list_view(pa.int8()))],
)
def test_columns_that_cannot_be_carried(batch: Batch, column: pa.Array) -> None:
    try:
        ran = batch(with_scene(column), "--to", "ndjson")
    except NotImplementedError:
        pytest.skip("this pyarrow writes no such columns")
    assert (ran.status, ran.out) == (1, "")
    assert ran.err.startswith(NO_PARQUET)


# Damage


def test_what_is_no_table(batch: Batch) -> None:
    twice = pa.Table.from_arrays([pa.array([1.0])] * 3, ["m1", "m2", "m2"])
    assert batch(twice) == (1, "", f"{NO_PARQUET}column with name 'm2' has more than one occurrence\n")
    ran = batch(pl.DataFrame({"m1": [True], "m2": [1]}))
    assert ran == (1, "", "atwood: cannot read IN: column m1 holds Boolean, not numbers\n")
    whole = written(pl.DataFrame({"m1": [1], "m2": [1]}), "polars")
    for content in (whole[:-20], b"m1,m2\n1,2\n", b"PAR1", b""):
        ran = batch(content)
        assert (ran.status, ran.out, ran.err.count("\n")) == (1, "", 1)
        assert ran.err.startswith(NO_PARQUET)


def written(frame: pl.DataFrame, by: str, **more: Any) -> bytes:
    file = io.BytesIO()
    if by == "polars":
        frame.write_parquet(file, **more)
    else:
        pq.write_table(frame.to_arrow(), file, **more)
    return file.getvalue()


@pytest.mark.parametrize("by", ["polars", "pyarrow"])
def test_a_damaged_file_is_an_error(batch: Batch, by: str) -> None:
    """Whichever byte of it changes: no row is lost in silence, and nothing of polars' reaches stderr."""
    columns = {"m1": [1] * 300, "m2": [3] * 300, "s": [None if i % 7 else "abc" for i in range(300)]}
    whole = written(pl.DataFrame(columns), by)
    said = set()
    for at in range(5, len(whole), 5):
        ran = batch(whole[:at] + b"\0" + whole[at + 1 :], "--only", "regime", "--allow-errors")
        said.add(ran.status)
        assert ran.err.startswith("atwood: 300 rows: " if ran.status == 0 else "atwood: cannot read IN: "), at
        assert ran.status == 1 or len(ran.out.splitlines()) == 301
    assert said == {0, 1}


def test_rows_that_are_not_there(batch: Batch, tmp_path: Path) -> None:
    content = written(pl.DataFrame({"m1": [1.0] * 300, "m2": [3.0] * 300}), "polars")
    footer = len(content) - 8 - int.from_bytes(content[-8:-4], "little")
    number, other = (b"\x16" + bytes([n % 64 * 2 + 128, n // 64]) for n in (300, 301))
    content = content[:footer] + content[footer:].replace(number, other, 1)
    why = "it is damaged: it should have 301 rows, and has 300"
    assert batch(content, "-o", "OUT.csv") == (1, "", f"atwood: cannot read IN: {why}\n")
    assert not (tmp_path / "out.csv").exists()
    # What polars writes of it would look whole.
    assert batch(content, "--to", "parquet").out == ""


# Groups


@pytest.mark.parametrize("columns", [1, 100])
def test_groups_have_a_fixed_number_of_rows(batch: Batch, tmp_path: Path, columns: int) -> None:
    """Fewer where rows are wide, and as many groups as there are rows for."""
    rows = 150_000 // columns
    frame = pl.DataFrame({"m1": 1.0, "m2": 3.0, "n": range(rows), **{str(i): "x" for i in range(columns)}})
    ran = batch(written(frame, "polars", row_group_size=rows // 3), "-o", "OUT.parquet")
    assert ran.status == 0
    assert ran.err.startswith(f"atwood: {rows} rows: {rows} no-slip; no errors.\n")
    assert pl.read_parquet(tmp_path / "out.parquet").select(frame.columns).equals(frame)
    about = pq.read_metadata(tmp_path / "out.parquet")
    *groups, last = [about.row_group(at).num_rows for at in range(about.num_row_groups)]
    most = min(1 << 16, (1 << 20) // about.num_columns)
    assert (set(groups) <= {most} and last <= most) or not groups


def test_what_cannot_be_written_ends(tmp_path: Path) -> None:
    """The thread that writes had failed, and the other waited for it."""
    if not Path("/dev/full").exists():
        pytest.skip("needs a device that is full")
    pl.DataFrame({"m1": [1.0] * 300_000, "m2": [3.0] * 300_000}).write_parquet(tmp_path / "in.parquet")
    ran = process("batch", str(tmp_path / "in.parquet"), "--to", "parquet", "-o", "/dev/full")
    assert (ran.status, ran.err) == (1, "atwood: cannot write the output: No space left on device\n")


def test_an_interrupt_as_the_writer_starts_ends_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It waited for frames that nobody would make, for good."""
    submit = ThreadPoolExecutor.submit

    def interrupted(*work: Any, **more: Any) -> None:
        submit(*work, **more)
        raise KeyboardInterrupt

    monkeypatch.setattr(ThreadPoolExecutor, "submit", interrupted)
    with (tmp_path / "out.parquet").open("wb") as file, pytest.raises(KeyboardInterrupt):
        write_frames(file, iter([pl.DataFrame({"m1": [1.0]})]))
