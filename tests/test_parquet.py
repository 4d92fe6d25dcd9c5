"""Parquet: columns keep their types, damage is a sentence, and groups have a fixed number of rows."""

import io
import math
from concurrent.futures import ThreadPoolExecutor
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

from atwood_cli.batch.parquet import write_frames

from .conftest import examples
from .running import Atwood, process


def test_parquet_keeps_its_types(atwood: Atwood, tmp_path: Path) -> None:
    frame = pl.DataFrame(
        {
            "m1": [1, 2],
            "m2": [3.0, None],
            "M": [math.inf, math.nan],
            "list": [[1], None],
            "struct": [{"a": 1, "b": "x"}, None],
            "when": [None, None],
        },
        schema_overrides={"m1": pl.Int32, "when": pl.Date},
    )
    frame.write_parquet(tmp_path / "in.parquet")
    ran = atwood("batch", str(tmp_path / "in.parquet"), "-o", str(tmp_path / "out.parquet"))
    assert ran.status == 1
    result = pl.read_parquet(tmp_path / "out.parquet")
    assert result.select(frame.columns).equals(frame)
    assert result.select(frame.columns).schema == frame.schema
    assert result["regime"].to_list() == ["no-slip", None]
    assert result["error"].to_list() == [None, "M nan must be 0 or more (inf locks the pulley)"]


@given(
    st.lists(
        st.tuples(*(st.sampled_from([1.0, 2.0, 0.3, math.nan, math.inf, None]) for _ in range(4))),
        max_size=20,
    )
)
@examples(40)
def test_nan_in_parquet_is_bad_and_null_is_not_given(
    atwood: Atwood, tmp_path: Path, rows: list[tuple[float | None, ...]]
) -> None:
    columns = ("m1", "m2", "M", "mu")
    frame = pl.DataFrame(rows, schema=dict.fromkeys(columns, pl.Float64), orient="row")
    frame.write_parquet(tmp_path / "in.parquet")
    atwood("batch", str(tmp_path / "in.parquet"), "-o", str(tmp_path / "out.parquet"), "--force")
    solved = pl.read_parquet(tmp_path / "out.parquet")
    assert solved.select(columns).equals(frame)
    for values, error, regime in zip(rows, solved["error"], solved["regime"], strict=True):
        row = dict(zip(columns, values, strict=True))
        wrong = [
            name
            for name, x in row.items()
            if x is not None and not (x < math.inf or (name, x) == ("M", math.inf))
        ]
        missing = [name for name in ("m1", "m2") if row[name] is None]
        assert (error is None) == (not wrong and not missing) == (regime is not None)
        if wrong:
            assert error.startswith(f"{wrong[0]} {row[wrong[0]]} must be") or missing


def test_nested_columns_do_not_go_into_csv(atwood: Atwood, tmp_path: Path) -> None:
    pl.DataFrame({"m1": [1], "m2": [1], "n": [[1]]}).write_parquet(tmp_path / "in.parquet")
    ran = atwood("batch", str(tmp_path / "in.parquet"))
    assert (ran.status, ran.out) == (1, "")
    assert ran.err == "atwood: cannot write column 'n', which holds List(Int64), as csv; give --to parquet\n"


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
}


if hasattr(pa, "json_"):  # from 19
    COLUMNS["json"] = pa.array(["{}", None], pa.json_())


@pytest.mark.parametrize("name", COLUMNS)
def test_columns_of_every_type_pass_through(atwood: Atwood, tmp_path: Path, name: str) -> None:
    pq.write_table(pa.table({"m1": [1.0, 1.0], "m2": [3, 3], "x": COLUMNS[name]}), tmp_path / "in.parquet")
    ran = atwood("batch", str(tmp_path / "in.parquet"), "-o", str(tmp_path / "out.parquet"))
    assert ran.status == 0
    assert ran.err.startswith("atwood: 2 rows: 2 no-slip; no errors.\n")
    before, after = (pl.read_parquet(tmp_path / f"{one}.parquet")["x"] for one in ("in", "out"))
    assert before.dtype == after.dtype
    assert before.to_list() == after.to_list()


FAR = {
    "infinite": pa.array([2**63 - 1, 0], pa.timestamp("us")),
    "infinite in the past": pa.array([None, 1 - 2**63], pa.timestamp("ms", "UTC")),
    "date": pa.array([2**31 - 1, None], pa.date32()),
    "in a list": pa.array([[0, 2**63 - 1], None], pa.list_(pa.timestamp("us"))),
    "in a structure": pa.array(
        [{"a": 1, "b": [-(2**31)]}, None], pa.struct({"a": pa.int8(), "b": pa.list_(pa.date32())})
    ),
}


@pytest.mark.parametrize("name", FAR)
def test_far_dates_are_kept_or_a_sentence(tmp_path: Path, name: str) -> None:
    path, out = tmp_path / "in.parquet", tmp_path / "out.parquet"
    pq.write_table(pa.table({"m1": [1.0, 1.0], "m2": [3, 3], "x": FAR[name]}), path)
    assert process("batch", str(path), "-o", str(out)).status == 0
    assert pq.read_table(out)["x"].cast(FAR[name].type).combine_chunks() == FAR[name]
    for kind in ("ndjson", *["csv"] * (not pa.types.is_nested(FAR[name].type))):
        ran = process("batch", str(path), "--to", kind)
        why = (
            f"cannot write column 'x', which has a date beyond the year ±262000, as {kind}; give --to parquet"
        )
        assert (ran.status, ran.out, ran.err) == (1, "", f"atwood: {why}\n")


def test_whatever_polars_panics_over_is_a_sentence(
    atwood: Atwood, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its exception is none of Python's `Exception`."""

    def panic(*_: object, **__: object) -> None:
        raise pl.exceptions.PanicException("out of something\nat all")

    monkeypatch.setattr(pl.DataFrame, "write_csv", panic)
    pl.DataFrame({"m1": [1.0], "m2": [3.0]}).write_parquet(tmp_path / "in.parquet")
    ran = atwood("batch", str(tmp_path / "in.parquet"))
    assert (ran.status, ran.err) == (1, "atwood: cannot write csv: out of something\n")


def test_a_setting_that_has_polars_panic_changes_nothing(tmp_path: Path) -> None:
    pl.DataFrame({"m1": ["1", "x"], "m2": [3, 3]}).write_csv(tmp_path / "in.csv")
    ran = process("batch", str(tmp_path / "in.csv"), "--only", "regime", POLARS_PANIC_ON_ERR="1")
    assert (ran.status, ran.out.splitlines()[1]) == (1, "1,3,no-slip,")
    assert "panicked" not in ran.err


@pytest.mark.parametrize("names", [["m1", "m2", ""], ["", "column_0", "m1", "m2"]])
def test_a_column_keeps_an_empty_name(atwood: Atwood, tmp_path: Path, names: list[str]) -> None:
    path, out = tmp_path / "in.parquet", tmp_path / "out.parquet"
    pq.write_table(pa.table([[float(i)] for i in range(1, len(names) + 1)], names=names), path)
    assert atwood("batch", str(path), "-o", str(out), "--only", "regime").status == 0
    assert pq.read_table(out).column_names == [*names, "regime", "error"]


@pytest.mark.parametrize(
    "column",
    [pa.array([Decimal("1.1")], pa.decimal256(50, 2)), pa.array([[1]], pa.list_view(pa.int8()))],
)
def test_columns_that_cannot_be_carried(atwood: Atwood, tmp_path: Path, column: pa.Array) -> None:
    path = tmp_path / "in.parquet"
    try:
        pq.write_table(pa.table({"m1": [1.0], "m2": [3.0], "x": column}), path)
    except NotImplementedError:
        pytest.skip("this pyarrow writes no such columns")
    ran = atwood("batch", str(path), "--to", "ndjson")
    assert (ran.status, ran.out) == (1, "")
    assert ran.err.startswith(f"atwood: cannot read {path}: it is not Parquet that polars can read: ")


def test_bytes_do_not_go_into_json(atwood: Atwood, tmp_path: Path) -> None:
    path = tmp_path / "in.parquet"
    pq.write_table(pa.table({"m1": [1.0], "m2": [3.0], "x": pa.array([[b"x"]])}), path)
    ran = atwood("batch", str(path), "--to", "ndjson")
    assert (ran.status, ran.out) == (1, "")
    assert (
        ran.err == "atwood: cannot write column 'x', which holds List(Binary), as ndjson; give --to parquet\n"
    )
    pq.write_table(pa.table({"m1": [1.0], "m2": [3.0], "x": pa.array([{"Binary": 1}])}), path)
    ran = atwood("batch", str(path), "--to", "ndjson", "--only", "regime")
    assert ran.out == '{"m1":1.0,"m2":3.0,"x":{"Binary":1},"regime":"no-slip","error":null}\n'


def test_a_column_that_is_there_twice(atwood: Atwood, tmp_path: Path) -> None:
    path = tmp_path / "in.parquet"
    pq.write_table(pa.Table.from_arrays([pa.array([1.0])] * 3, ["m1", "m2", "m2"]), path)
    ran = atwood("batch", str(path))
    assert (ran.status, ran.out) == (1, "")
    why = "it is not Parquet that polars can read: column with name 'm2' has more than one occurrence"
    assert ran.err == f"atwood: cannot read {path}: {why}\n"


# Damage


def test_what_is_no_parquet(atwood: Atwood, tmp_path: Path) -> None:
    path = tmp_path / "in.parquet"
    pl.DataFrame({"m1": [True], "m2": [1]}).write_parquet(path)
    whole = path.read_bytes()
    assert atwood("batch", str(path)).err.endswith("in.parquet: column m1 holds Boolean, not numbers\n")
    for content in (whole[:-20], b"m1,m2\n1,2\n", b"PAR1", b""):
        path.write_bytes(content)
        ran = atwood("batch", str(path))
        assert (ran.status, ran.out) == (1, "")
        assert ran.err.startswith(f"atwood: cannot read {path}: it is not Parquet that polars can read: ")
        assert ran.err.count("\n") == 1


def written(frame: pl.DataFrame, by: str, **more: Any) -> bytes:
    file = io.BytesIO()
    if by == "polars":
        frame.write_parquet(file, **more)
    else:
        pq.write_table(frame.to_arrow(), file, **more)
    return file.getvalue()


@pytest.mark.parametrize("by", ["polars", "pyarrow"])
def test_a_damaged_file_is_an_error(atwood: Atwood, tmp_path: Path, by: str) -> None:
    """Whichever byte of it changes: no row is lost in silence, and nothing of polars' reaches stderr."""
    path = tmp_path / "in.parquet"
    columns = {"m1": [1] * 300, "m2": [3] * 300, "s": [None if i % 7 else "abc" for i in range(300)]}
    whole = written(pl.DataFrame(columns), by)
    said = set()
    for at in range(5, len(whole), 5):
        path.write_bytes(whole[:at] + b"\0" + whole[at + 1 :])
        ran = atwood("batch", str(path), "--only", "regime", "--allow-errors")
        said.add(ran.status)
        start = "300 rows: " if ran.status == 0 else f"cannot read {path}: "
        assert ran.err.startswith(f"atwood: {start}"), at
        assert ran.status == 1 or len(ran.out.splitlines()) == 301
    assert said == {0, 1}


def test_rows_that_are_not_there(atwood: Atwood, tmp_path: Path) -> None:
    path = tmp_path / "in.parquet"
    pl.DataFrame({"m1": [1.0] * 300, "m2": [3.0] * 300}).write_parquet(path)
    content = path.read_bytes()
    footer = len(content) - 8 - int.from_bytes(content[-8:-4], "little")
    number, other = (b"\x16" + bytes([n % 64 * 2 + 128, n // 64]) for n in (300, 301))
    path.write_bytes(content[:footer] + content[footer:].replace(number, other, 1))
    ran = atwood("batch", str(path), "-o", str(tmp_path / "out.csv"))
    why = "it is damaged: it should have 301 rows, and has 300"
    assert (ran.status, ran.err) == (1, f"atwood: cannot read {path}: {why}\n")
    assert not (tmp_path / "out.csv").exists()
    # What polars writes of it would look whole.
    assert atwood("batch", str(path), "--to", "parquet").out == ""


# Groups


@pytest.mark.parametrize("columns", [1, 100])
def test_groups_have_a_fixed_number_of_rows(atwood: Atwood, tmp_path: Path, columns: int) -> None:
    """Fewer where rows are wide, and as many groups as there are rows for."""
    rows = 150_000 // columns
    frame = pl.DataFrame({"m1": 1.0, "m2": 3.0, "n": range(rows), **{str(i): "x" for i in range(columns)}})
    frame.write_parquet(tmp_path / "in.parquet", row_group_size=rows // 3)
    ran = atwood("batch", str(tmp_path / "in.parquet"), "-o", str(tmp_path / "out.parquet"))
    assert ran.status == 0
    assert ran.err.startswith(f"atwood: {rows} rows: {rows} no-slip; no errors.\n")
    assert pl.read_parquet(tmp_path / "out.parquet").select(frame.columns).equals(frame)
    about = pq.read_metadata(tmp_path / "out.parquet")
    *groups, last = [about.row_group(at).num_rows for at in range(about.num_row_groups)]
    assert (
        set(groups) <= {min(1 << 16, (1 << 20) // about.num_columns)} >= {max([last, *groups])} or not groups
    )


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
