"""Parquet: columns keep their types, damage is a sentence, and groups have a fixed number of rows."""

import io
import math
import re
from collections.abc import Callable
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

from .conftest import examples
from .running import Batch, process


@pytest.fixture
def batch(batch: Batch) -> Batch:
    """Run `atwood batch` on a frame of polars, a table of pyarrow or a file of Parquet."""
    return lambda table, words="": batch(written(table), words, "in.parquet")


def written(table: Any, **more: Any) -> bytes:
    """A table as a file of Parquet, by its own library."""
    if isinstance(table, bytes):
        return table
    file = io.BytesIO()
    if isinstance(table, pl.DataFrame):
        table.write_parquet(file, **more)
    else:
        pq.write_table(table, file)
    return file.getvalue()


def with_scene(column: Any) -> pa.Table:
    return pa.table({"m1": [1.0] * len(column), "m2": [3] * len(column), "x": column})


@given(st.lists(st.tuples(*[st.sampled_from([1.0, 2.0, 0.3, math.nan, math.inf, None])] * 4), max_size=20))
@examples(40)
def test_nan_in_parquet_is_bad_and_null_is_not_given(
    batch: Batch, tmp_path: Path, rows: list[tuple[float | None, ...]]
) -> None:
    columns = ("m1", "m2", "M", "mu")
    frame = pl.DataFrame(rows, schema=dict.fromkeys(columns, pl.Float64), orient="row")
    batch(frame, "-o OUT.parquet --force")
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
    "time of day": pa.array([1, None], pa.time64("ns")),
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


def test_columns_of_every_type_pass_through(batch: Batch, tmp_path: Path) -> None:
    ran = batch(pa.table({"m1": [1.0, 1.0], "m2": [3, 3], **COLUMNS}), "-o OUT.parquet")
    assert (ran.status, ran.err.splitlines()[0]) == (0, "atwood: 2 rows: 2 no-slip; no errors.")
    before, after = (pl.read_parquet(tmp_path / f"{name}.parquet") for name in ("in", "out"))
    assert before.select(*COLUMNS).schema == after.select(*COLUMNS).schema
    assert [name for name in COLUMNS if not before[name].equals(after[name])] == []


@pytest.mark.parametrize(("kind", "minus"), [(pl.Int64, "-1"), (pl.Float64, "-1.0")])
def test_a_number_outside_its_domain_is_an_error_of_its_row(
    batch: Batch, tmp_path: Path, kind: Any, minus: str
) -> None:
    """It ended the run."""
    frame = pl.DataFrame({"m1 (g)": [1, -1, 1], "m2": [3, 3, -1]}).cast(kind)
    ran = batch(frame, "--only regime -o OUT.parquet")
    assert ran.status == 1
    assert ran.err.startswith("atwood: read as: 'm1 (g)' as m1 in g.\natwood: 3 rows: ")
    errors = pl.read_parquet(tmp_path / "out.parquet")["error"].to_list()
    domain = "must be 0 or more, and finite"
    assert errors == [None, f"m1 '{minus}g' {domain}", f"m2 -1.0 {domain}"]


TABLE = pl.DataFrame({
    "id": ["a", "b", "c", None],
    "m1 (g)": [100.0, None, 1.0, 5.0],
    "m2": [3, 1, 1, 2],
    "M": [None, math.inf, math.nan, 8.0],
    "x": [[1], [], [2], None],
})  # fmt: skip


@pytest.mark.parametrize("lazy", [False, True])
@pytest.mark.parametrize("quantities", [None, ["T1", "regime"], "acceleration", ["a", "acceleration"]])
def test_solve_table_appends_what_batch_does(
    batch: Batch, tmp_path: Path, lazy: bool, quantities: list[str] | str | None
) -> None:
    names = [quantities] if isinstance(quantities, str) else quantities or []
    batch(TABLE, f"{''.join(f'--only {name} ' for name in names)}-o OUT.parquet")
    right = pl.read_parquet(tmp_path / "out.parquet")
    frame = solve_table(TABLE.lazy(), quantities).collect() if lazy else solve_table(TABLE, quantities)
    assert frame.equals(right)
    assert frame.schema == right.schema
    assert frame["error"].null_count() == 2


@pytest.mark.parametrize("kind", [pl.String, pl.Categorical])
def test_a_text_that_is_no_number_is_an_error_of_its_row(kind: Any) -> None:
    """It was an exception."""
    table = pl.DataFrame({"m1 (g)": ["100", "x", "", None, " 1e2 ", "NA"], "m2": 3}).cast({"m1 (g)": kind})
    solved = solve_table(table, "regime")
    missing = "m1 is missing; give both masses, m1 and m2"
    wrong = "m1 'x' is not a number; write it like 2, 1.5e-3, 2.0+-0.1 or 2.0(1)"
    assert solved["error"].to_list() == [None, wrong, missing, missing, None, missing]
    assert solved.drop("regime", "error").equals(table)


@pytest.mark.parametrize(
    ("table", "why"),
    [
        (pl.DataFrame({"m1": [True], "m2": [3]}), "cannot read the table: column m1 holds Boolean, not numbers"),
        ([1], "a table is a data frame of polars, eager or lazy, not list"),
        (pl.Series([1]), "a table is a data frame of polars, eager or lazy, not Series"),
        (TABLE.to_arrow(), "a table is a data frame of polars, eager or lazy, not Table"),
        (TABLE.drop("m2"), "cannot read the table: column m2 is missing; there are 'id', 'm1 (g)', 'M', 'x'"),
        (TABLE.rename({"id": "radius"}), "cannot read the table: column 'radius' could be meant for R; rename it"),
        (TABLE.rename({"id": "error"}), "cannot read the table: column 'error' would be there twice, as a result is named so; rename it"),
    ],
)  # fmt: skip
def test_what_solve_table_refuses(table: Any, why: str) -> None:
    with pytest.raises(ValueError, match=f"^{re.escape(why)}$"):
        solve_table(table)


@pytest.mark.parametrize("kind", [pl.Int8, pl.UInt64, pl.Float32, pl.Decimal(10, 2)])
def test_inputs_keep_their_types(batch: Batch, tmp_path: Path, kind: Any) -> None:
    frame = pl.DataFrame({"m1": [1, 2], "m2": [3, None]}).cast(kind)
    assert batch(frame, "-o OUT.parquet").status == 1
    result = pl.read_parquet(tmp_path / "out.parquet")
    assert result.select("m1", "m2").equals(frame)
    assert result.select("m1", "m2").schema == frame.schema
    assert result["error"].to_list() == [None, "m2 is missing; give both masses, m1 and m2"]


def test_whatever_polars_panics_over_is_a_sentence(batch: Batch, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its exception is none of Python's `Exception`."""

    def panic(*_: object, **__: object) -> None:
        raise pl.exceptions.PanicException("out of something\nat all")

    monkeypatch.setattr(pl.LazyFrame, "sink_parquet", panic)
    assert batch(with_scene([1])) == (1, "", f"{NO_PARQUET}out of something\n")


@pytest.mark.parametrize("names", [["m1", "m2", ""], ["", "column_0", "m1", "m2"]])
def test_a_column_keeps_an_empty_name(batch: Batch, tmp_path: Path, names: list[str]) -> None:
    table = pa.table([[float(i)] for i in range(1, len(names) + 1)], names=names)
    assert batch(table, "-o OUT.parquet --only regime").status == 0
    assert pq.read_table(tmp_path / "out.parquet").column_names == [*names, "regime", "error"]


NO_PARQUET = "atwood: cannot read IN: it is not Parquet that polars can read: "


@pytest.mark.parametrize(
    "column", [pa.array([Decimal("1.1")], pa.decimal256(50, 2)), pa.array([[1]], pa.list_view(pa.int8()))]
)
def test_columns_that_cannot_be_carried(batch: Batch, column: pa.Array) -> None:
    try:
        ran = batch(with_scene(column))
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
    whole = written(pl.DataFrame({"m1": [1], "m2": [1]}))
    for content in (whole[:-20], b"m1,m2\n1,2\n", b"PAR1", b""):
        ran = batch(content)
        assert (ran.status, ran.out, ran.err.count("\n")) == (1, "", 1)
        assert ran.err.startswith(NO_PARQUET)


@pytest.mark.parametrize("by", [pl.DataFrame, pa.table])
def test_a_damaged_file_is_an_error(
    batch: Batch, tmp_path: Path, pytestconfig: pytest.Config, by: Callable[..., Any]
) -> None:
    """Whichever byte of it changes: no row is lost in silence, and nothing of polars' reaches stderr."""
    whole = written(
        by({"m1": [1] * 300, "m2": [3] * 300, "s": [None if i % 7 else "abc" for i in range(300)]})
    )
    said, unsaid = set(), 0
    for place in range(5, len(whole), 5 if pytestconfig.getoption("every_digit") else 13):
        damaged = whole[:place] + b"\0" + whole[place + 1 :]
        ran = batch(damaged, "--only regime --allow-errors -o OUT.parquet --force")
        said.add(ran.status)
        unsaid += "and has 0" in ran.err
        assert ran.err.startswith("atwood: 300 rows: " if ran.status == 0 else "atwood: cannot read IN: "), (
            place
        )
        assert ran.status == 1 or len(pl.read_parquet(tmp_path / "out.parquet")) == 300
    assert said == {0, 1}
    assert unsaid < 5  # mostly polars knows what is wrong


def test_rows_that_are_not_there(batch: Batch, tmp_path: Path) -> None:
    content = written(pl.DataFrame({"m1": [1.0] * 300, "m2": [3.0] * 300}))
    footer = len(content) - 8 - int.from_bytes(content[-8:-4], "little")
    number, other = (b"\x16" + bytes([n % 64 * 2 + 128, n // 64]) for n in (300, 301))
    content = content[:footer] + content[footer:].replace(number, other, 1)
    why = "it is damaged: it should have 301 rows, and has 300"
    assert batch(content, "-o OUT.parquet") == (1, "", f"atwood: cannot read IN: {why}\n")
    assert not (tmp_path / "out.parquet").exists()
    assert batch(content).out == ""  # what polars writes of it would look whole


# Groups


@pytest.mark.parametrize("columns", [1, 40])
def test_groups_have_a_fixed_number_of_rows(batch: Batch, tmp_path: Path, columns: int) -> None:
    """Fewer where rows are wide, and as many groups as there are rows for."""
    rows = 150_000 if columns == 1 else 50_000
    frame = pl.DataFrame({"m1": 1.0, "m2": 3.0, "n": range(rows), **{str(i): "x" for i in range(columns)}})
    ran = batch(written(frame, row_group_size=rows // 3), "-o OUT.parquet")
    assert ran.status == 0
    assert ran.err.startswith(f"atwood: {rows} rows: {rows} no-slip; no errors.\n")
    assert pl.read_parquet(tmp_path / "out.parquet").select(frame.columns).equals(frame)
    about = pq.read_metadata(tmp_path / "out.parquet")
    *groups, last = [about.row_group(i).num_rows for i in range(about.num_row_groups)]
    most = min(1 << 16, (1 << 20) // about.num_columns)
    assert set(groups) == {most}
    assert last <= most


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
def test_what_cannot_be_written_ends(tmp_path: Path) -> None:
    """The thread that writes had failed, and the other waited for it."""
    pl.DataFrame({"m1": [1.0] * 300_000, "m2": [3.0] * 300_000}).write_parquet(tmp_path / "in.parquet")
    ran = process("batch", str(tmp_path / "in.parquet"), "-o", "/dev/full")
    assert (ran.status, ran.err) == (1, "atwood: cannot write the output: No space left on device\n")
