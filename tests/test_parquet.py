"""Parquet and frames of polars: columns keep their types, and damage is a sentence."""

import io
import math
import re
from collections.abc import Callable
from itertools import count
from math import nan
from pathlib import Path
from typing import Any

import polars as pl
import pytest

from atwood_cli import solve, solve_table
from atwood_cli.reading.units import UNITS

from .tools.running import Batch, Ran, process

NO_PARQUET = "atwood: cannot read IN: it is not Parquet that polars can read: "


ARROW = (Path(__file__).parent / "cases" / "arrow.parquet").read_bytes()
"""As pyarrow 26 writes it: two rows of all its types, those too that polars does not write, as maps and float16."""


def written(frame: pl.DataFrame) -> bytes:
    frame.write_parquet(file := io.BytesIO())
    return file.getvalue()


@pytest.fixture
def solved(batch: Batch, tmp_path: Path) -> Callable[..., tuple[Ran, Any]]:
    """Run `atwood batch` on a table: how it ended, and the frame that it wrote, if any."""

    def call(table: Any, words: str = "") -> tuple[Ran, Any]:
        (out := tmp_path / "out.parquet").unlink(missing_ok=True)
        content = table if isinstance(table, bytes) else written(table)
        ran = batch(content, f"-o OUT.parquet {words}", "in.parquet")
        assert ran.out == ""
        ran = ran._replace(err=ran.err.removeprefix(f"atwood: wrote {out}\n"))
        return ran, pl.read_parquet(out) if out.exists() else None

    return call


MISSING = "{} is missing; give both masses, m1 and m2"
NO_NUMBER = "{} 'x' is not a number; write it like 2, 1/3 or 1.5e-3"


@pytest.mark.parametrize(
    ("kind", "bad", "error"),
    [
        *((kind, -1, f"{{}} {shown} must be 0 or more, and finite") for kind, shown in [(pl.Int8, "-1"), (pl.Int64, "-1"), (pl.Float32, "-1.0"), (pl.Float64, "-1.0"), (pl.Decimal(10, 2), "'-1.00'")]),
        *((kind, None, MISSING) for kind in (pl.UInt64, pl.String)),
        *((kind, "x", NO_NUMBER) for kind in (pl.String, pl.Categorical)),
        *((kind, " NA ", MISSING) for kind in (pl.String, pl.Categorical)),
    ],
    ids=count(),
)  # fmt: skip
def test_inputs_keep_their_types_and_what_is_wrong_is_an_error_of_its_row(
    solved: Any, kind: Any, bad: Any, error: str
) -> None:
    cells = {"m1 (g)": [1, bad, 2], "m2": [3, 3, bad]}
    frame = pl.DataFrame({name: [cell and str(cell) for cell in cells[name]] for name in cells}).cast(kind)
    ran, result = solved(frame, "--only regime")
    assert ran.status == 1
    assert ran.err.startswith("atwood: read as: 'm1 (g)' as m1 in g")
    assert result.drop("regime", "error").equals(frame)
    assert result.drop("regime", "error").schema == frame.schema
    assert result["error"].to_list() == [None, error.format("m1"), error.format("m2")]
    assert solve_table(frame, "regime").equals(result)


def test_decimals_in_another_unit_are_rounded_once() -> None:
    """They were divided as doubles, and a string slipped that holds."""
    texts = pl.DataFrame({"m1 (g)": ["120879.946"], "m2": [120.879946], "M": [1e15], "mu": [1e-17]})
    numbers = texts.cast({"m1 (g)": pl.Decimal(12, 3)})
    assert solve_table(numbers).drop("m1 (g)").equals(solve_table(texts).drop("m1 (g)"))


@pytest.mark.parametrize(
    "content", [ARROW, written(pl.DataFrame({"m1": [1, 2], "m2": 3, "": "a"}))], ids=["arrow", "polars"]
)
def test_columns_of_every_name_and_type_pass_through(solved: Any, content: bytes) -> None:
    ran, after = solved(content, "--only regime")
    assert (ran.status, ran.err.splitlines()[-1]) == (0, "atwood: 2 rows: 2 no-slip; no errors.")
    before = pl.read_parquet(content)
    assert after.columns == [*before.columns, "regime", "error"]
    assert before.schema == after.drop("regime", "error").schema
    assert [name for name in before.columns if not before[name].equals(after[name])] == []


TABLE = pl.DataFrame({
    "id": ["a", "b", "c", None],
    "m1 (g)": [100.0, None, 1.0, 5.0],
    "m2": [3, 1, 1, 2],
    "M": [None, math.inf, math.nan, 8.0],
    "x": [[1], [], [2], None],
})  # fmt: skip


@pytest.mark.parametrize("quantities", [None, ["T1", "regime"], "acceleration", ["a", "acceleration"]])
def test_solve_table_appends_what_batch_does(solved: Any, quantities: list[str] | str | None) -> None:
    names = [quantities] if isinstance(quantities, str) else quantities or []
    for table in (TABLE, TABLE.clear()):
        _, right = solved(table, " ".join(f"--only {name}" for name in names))
        for frame in (solve_table(table, quantities), solve_table(table.lazy(), quantities).collect()):
            assert frame.equals(right)
            assert frame.schema == right.schema
            assert frame["error"].null_count() == len(table) // 2


def test_a_frame_of_pandas_keeps_its_index_and_its_columns() -> None:
    pd = pytest.importorskip("pandas")
    columns = {"m1 (g)": [250, 300], "m2": ["1/2", "x"], "M": [0.1, nan], "when": pd.Timestamp("2026-11-27")}
    frame = pd.DataFrame(columns, index=[7, 9])
    solved = solve_table(frame, ["regime", "a"])
    assert solved[list(frame)].equals(frame)
    assert [*solved["acceleration"]][:1] == [solve("250g", "0.5", M=0.1).acceleration]
    assert solved["acceleration"].dtype == float
    assert solved.loc[9, ["regime", "acceleration"]].isna().all()
    assert "is not a number" in solved.loc[9, "error"]


def test_a_frame_of_dask_is_solved_when_it_is_computed() -> None:
    """It ended in an AttributeError."""
    pd = pytest.importorskip("pandas")
    pytest.importorskip("pyarrow")
    from_pandas = pytest.importorskip("dask.dataframe").from_pandas
    frame = pd.DataFrame({"m1": [1.0, 2.0, -1.0, 1.0], "m2": 3.0, "mu": [nan, 0.3, 0.3, 0.3]})
    lazy = solve_table(from_pandas(frame, npartitions=2), ["regime", "a"])
    assert type(lazy).__module__.startswith("dask.")
    right = solve_table(frame, ["regime", "a"])
    assert lazy.compute().equals(right)
    assert dict(lazy.dtypes) == dict(right.dtypes)
    with pytest.raises(ValueError, match=r"^cannot read the table: m2 is missing; there are 'm1'$"):
        solve_table(from_pandas(frame[["m1"]], npartitions=1))
    for series in (frame["m1"], from_pandas(frame, npartitions=1)["m1"]):
        with pytest.raises(
            ValueError, match=r"^the table is of type Series; give a data frame of polars, pandas or dask$"
        ):
            solve_table(series)


AGAIN = "it has columns with the names of results: 'error'; leave them out to solve a table of results again, or rename them"


@pytest.mark.parametrize(
    ("table", "why"),
    [
        *((table, f"the table is of type {type(table).__name__}; give a data frame of polars, pandas or dask") for table in ([1], pl.Series([1]), TABLE.to_dict())),
        (TABLE.with_columns(m2=True), "cannot read the table: column m2 holds Boolean, not numbers"),
        (TABLE.drop("m2"), "cannot read the table: m2 is missing; there are 'id', 'm1 (g)', 'M', 'x'"),
        (TABLE.rename({"M": "M (u)"}), f"cannot read the table: column 'M (u)' has the unit 'u'; it takes {', '.join([*UNITS['mass'], *UNITS['force']])}; there are 'id', 'm1 (g)', 'm2', 'M (u)', 'x'"),
        (TABLE.rename({"id": "radius"}), "cannot read the table: 'radius' (R?) is not read, and may matter; there are 'radius', 'm1 (g)', 'm2', 'M', 'x'"),
        (TABLE.rename({"id": "error"}), f"cannot read the table: {AGAIN}"),
    ],
)  # fmt: skip
def test_what_solve_table_refuses(table: Any, why: str) -> None:
    with pytest.raises(ValueError, match=f"^{re.escape(why)}$"):
        solve_table(table)


# Damage


def test_what_is_no_table(solved: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    twice = ARROW.replace(b"\x18\x010", b"\x18\x011")  # in its footer, column 0 is named 1
    assert solved(twice)[0].err == f"{NO_PARQUET}column with name '1' has more than one occurrence\n"
    wrong = "atwood: cannot read IN: column m1 holds Boolean, not numbers\n"
    assert solved(TABLE.with_columns(m1=True).drop("m1 (g)")) == ((1, "", wrong), None)
    whole = written(TABLE)
    for content in (whole[:-20], b"m1,m2\n1,2\n", b"PAR1", b""):
        ran, result = solved(content)
        assert (ran.status, ran.err.count("\n"), result) == (1, 1, None)
        assert ran.err.startswith(NO_PARQUET)

    def panic(*_: object, **__: object) -> None:
        raise pl.exceptions.PanicException("out of something\nat all")  # none of Python's `Exception`

    monkeypatch.setattr(pl.LazyFrame, "sink_parquet", panic)
    assert solved(whole)[0] == (1, "", f"{NO_PARQUET}out of something\n")


THREE = pl.DataFrame({"m1": [1] * 300, "m2": [3] * 300, "s": [None if i % 7 else "abc" for i in range(300)]})


@pytest.mark.parametrize(("whole", "rows"), [(written(THREE), 300), (ARROW, 2)], ids=["polars", "arrow"])
def test_damage_is_an_error(solved: Any, pytestconfig: pytest.Config, whole: bytes, rows: int) -> None:
    """Whichever byte of it changes: no row is lost in silence, and nothing of polars' reaches stderr."""
    said, unsaid = set(), 0
    for place in range(5, len(whole), len(whole) // (250 if pytestconfig.getoption("every_digit") else 50)):
        ran, result = solved(whole[:place] + b"\0" + whole[place + 1 :], "--only regime --allow-errors")
        said.add(ran.status)
        unsaid += "it should have" in ran.err
        read = rf"not read: .*[.]\natwood: {rows} rows: "  # a column's name may change
        assert re.match(f"atwood: {'cannot read IN: ' if ran.status else read}", ran.err), place
        assert ran.status == 1 or len(result) == rows
    assert said == {0, 1}
    assert unsaid < 10  # mostly polars knows what is wrong


def test_rows_that_are_not_there(batch: Batch, solved: Any) -> None:
    content = written(pl.DataFrame({"m1": [1.0] * 300, "m2": [3.0] * 300}))
    footer = len(content) - 8 - int.from_bytes(content[-8:-4], "little")
    number, other = (b"\x16" + bytes([n % 64 * 2 + 128, n // 64]) for n in (300, 301))
    content = content[:footer] + content[footer:].replace(number, other, 1)
    why = "it is damaged: it should have 301 rows (after 300 rows)"
    assert solved(content) == ((1, "", f"atwood: cannot read IN: {why}\n"), None)
    assert batch(content, "", "in.parquet").out == ""  # what polars writes of it would look whole


# What is written


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
def test_what_cannot_be_written_ends(tmp_path: Path) -> None:
    """The thread that writes had failed, and the other waited for it."""
    pl.DataFrame({"m1": [1.0] * 300_000, "m2": [3.0] * 300_000}).write_parquet(tmp_path / "in.parquet")
    ran = process(shell=f"atwood batch {tmp_path}/in.parquet -o /dev/full")
    assert (ran.status, ran.err) == (1, "atwood: cannot write the output: No space left on device\n")
