"""Parquet: columns keep their types, damage is a sentence, and memory is bounded however rows are long."""

import base64
import contextlib
import io
import math
import subprocess
import sys
from decimal import Decimal
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import polars as pl
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from atwood_cli.batch import formats, pages, parquet
from atwood_cli.batch.pages import Column, footer_bytes, row_groups

from .running import PIP, Atwood, process


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
@settings(max_examples=40)
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
    assert (ran.status, ran.err) == (0, "atwood: 2 rows: 2 no-slip; no errors.\n")
    before, after = (pl.read_parquet(tmp_path / f"{one}.parquet")["x"] for one in ("in", "out"))
    assert before.dtype == after.dtype
    assert before.to_list() == after.to_list()


@pytest.mark.parametrize(
    ("column", "kind"),
    [
        (pa.array([Decimal("1.1")], pa.decimal256(50, 2)), "decimal256(50, 2)"),
        (pa.array([[1]], pa.list_view(pa.int8())), "list_view<element: int8>"),
    ],
)
def test_columns_that_cannot_be_carried(atwood: Atwood, tmp_path: Path, column: pa.Array, kind: str) -> None:
    path = tmp_path / "in.parquet"
    try:
        pq.write_table(pa.table({"m1": [1.0], "m2": [3.0], "x": column}), path)
    except NotImplementedError:
        pytest.skip("this pyarrow writes no such columns")
    ran = atwood("batch", str(path), "--to", "ndjson")
    assert (ran.status, ran.out) == (1, "")
    assert ran.err == f"atwood: cannot read {path}: column 'x' holds {kind}, which cannot be carried\n"


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
    assert ran.err == f"atwood: cannot read {path}: column 'm2' is there 2 times\n"


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
        assert ran.err.startswith(f"atwood: cannot read {path}: it is not Parquet, or damaged: ")
        assert ran.err.count("\n") == 1


def written(frame: pl.DataFrame, by: str, **more: Any) -> bytes:
    file = io.BytesIO()
    if by == "polars":
        frame.write_parquet(file, **more)
    else:
        pq.write_table(frame.to_arrow(), file, **more)
    return file.getvalue()


@pytest.mark.parametrize("by", ["polars", "pyarrow"])
def test_a_damaged_file_is_an_error(
    atwood: Atwood, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, by: str
) -> None:
    """Whatever byte of it is another: no row is lost in silence, nothing of others' reaches stderr.

    polars lost all rows of one such file, pyarrow ends the process over another as it tells of a column.
    """
    monkeypatch.setattr(pages, "SMALL_BYTES", 0)
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


@pytest.mark.parametrize("seed", range(5))
def test_pages_and_footers_with_any_bytes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, seed: int) -> None:
    """What is said of pages ends, and is numbers or a ValueError, also where all is nonsense."""
    monkeypatch.setattr(pages, "SMALL_BYTES", 0)
    rng = Random(seed)
    frame = pl.DataFrame({"m1": [1.0] * 3000, "s": [f"run {i % 9}" for i in range(3000)]})
    whole = written(frame, "pyarrow", compression="none", use_dictionary=["s"])
    told = 0
    for _ in range(400):
        content = bytearray(whole)
        for _ in range(rng.randint(1, 4)):
            at = rng.choice([rng.randrange(4, 40), rng.randrange(24_000, len(whole) - 8)])
            content[at] = rng.choice([0x1C, 0x19, 0xFF, 0, rng.randrange(256)])
        with contextlib.suppress(ValueError):
            for rows, columns in row_groups(io.BytesIO(content)):
                assert all(isinstance(number, int) for column in columns for number in (rows, *column[:-1]))
                assert all(column.rows_within(100) >= 1 for column in columns)
                told += 1
    assert 0 < told < 400
    nested = bytearray(whole)
    nested[4:20_000] = b"\x1c" * 19_996  # structures without end
    ((_, (unknown, _)),) = row_groups(io.BytesIO(nested))
    assert unknown.pages == [(3000, unknown.decoded)]


def test_a_footer_that_is_malformed(atwood: Atwood, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "in.parquet"
    pl.DataFrame({"m1": [1.0], "m2": [3.0]}).write_parquet(path)
    monkeypatch.setattr(pages, "_groups", lambda _: [{}])  # pyarrow takes none for which it is so
    ran = atwood("batch", str(path))
    why = "it is not Parquet, or damaged: its footer is malformed"
    assert (ran.status, ran.out, ran.err) == (1, "", f"atwood: cannot read {path}: {why}\n")


def test_rows_that_are_not_there(atwood: Atwood, tmp_path: Path) -> None:
    path = tmp_path / "in.parquet"
    pl.DataFrame({"m1": [1.0] * 300, "m2": [3.0] * 300}).write_parquet(path)
    content = path.read_bytes()
    footer = len(content) - 8 - footer_bytes(io.BytesIO(content))
    number, other = (b"\x16" + bytes([n % 64 * 2 + 128, n // 64]) for n in (300, 301))
    path.write_bytes(content[:footer] + content[footer:].replace(number, other, 1))
    ran = atwood("batch", str(path), "-o", str(tmp_path / "out.csv"))
    why = "it is damaged: it should have 301 rows, and has 300"
    assert (ran.status, ran.err) == (1, f"atwood: cannot read {path}: {why}\n")
    assert not (tmp_path / "out.csv").exists()


def test_what_failed_has_no_footer(tmp_path: Path) -> None:
    """It would look whole."""
    rng = Random(1)
    frame = pl.DataFrame({"m1": 1.0, "m2": 3.0, "x": [rng.random() for _ in range(400_000)]})
    damaged = bytearray(written(frame, "pyarrow", row_group_size=10_000, write_page_checksum=True))
    damaged[-len(damaged) // 10] ^= 255
    path, out = tmp_path / "in.parquet", tmp_path / "out.parquet"
    path.write_bytes(damaged)
    ran = process(shell=f"atwood batch '{path}' --to parquet --only regime > '{out}'")
    assert ran.status == 1
    assert ran.err.startswith(f"atwood: cannot read {path}: it is not Parquet, or damaged: ")
    assert out.read_bytes()[:4] == b"PAR1" != out.read_bytes()[-4:]


# Memory


@given(
    lengths=st.lists(st.sampled_from([0, 1, 30, 3000, None]), min_size=1, max_size=120),
    group=st.sampled_from([7, 50, 1000]),
    by=st.sampled_from(["polars", "pyarrow"]),
    categories=st.booleans(),
)
@settings(max_examples=60)
def test_rows_come_in_pieces_of_equal_size(
    tmp_path_factory: pytest.TempPathFactory, lengths: list[int | None], group: int, by: str, categories: bool
) -> None:
    texts = pl.Series([None if n is None else "x" * n for n in lengths], dtype=pl.String)
    frame = pl.DataFrame({"n": range(len(lengths)), "s": texts, "l": [["a", "b"]] * len(lengths)})
    if categories:
        frame = frame.with_columns(pl.col("s").cast(pl.Categorical))
    path = tmp_path_factory.mktemp("pieces") / "in.parquet"
    path.write_bytes(written(frame, by, row_group_size=group))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(parquet, "PIECE_BYTES", 1 << 12)
        patch.setattr(parquet, "LONG_BYTES", 1 << 12)
        with path.open("rb") as file:
            head, *pieces = parquet.read_frames(file)
    assert (head.height, head.schema) == (0, frame.schema)
    assert pl.concat(pieces).to_dicts() == frame.to_dicts()
    sizes = [sum(len(text or "") for text in piece["s"].cast(pl.String)) for piece in pieces]
    assert max(sizes) <= (1 << 12) + 3000
    assert len(pieces) <= 2 + sum(map(bool, lengths)) * 3200 // (1 << 12) + len(lengths) * 128 // (1 << 12)


@pytest.mark.parametrize("rows", [1, 16, 17, 300])
def test_rows_are_written_in_groups_of_equal_size(
    atwood: Atwood, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, rows: int
) -> None:
    monkeypatch.setattr(parquet, "PIECE_BYTES", 1 << 11)
    monkeypatch.setattr(parquet, "GROUP_BYTES", 1 << 13)
    monkeypatch.setattr(parquet, "CHUNK_BYTES", 1 << 10)
    frame = pl.DataFrame({"m1": 1.0, "m2": 3.0, "n": [f"{i}{'x' * (i + 13)}" for i in range(rows)]})
    frame = frame.with_columns(c=pl.col("n").str.head(1).cast(pl.Categorical))
    frame.write_parquet(tmp_path / "in.parquet")
    ran = atwood("batch", str(tmp_path / "in.parquet"), "-o", str(tmp_path / "out.parquet"))
    assert (ran.status, ran.err) == (0, f"atwood: {rows} row{'s' * (rows > 1)}: {rows} no-slip; no errors.\n")
    assert pl.read_parquet(tmp_path / "out.parquet").select(frame.columns).equals(frame)
    about = pq.read_metadata(tmp_path / "out.parquet")
    groups = [about.row_group(at) for at in range(about.num_row_groups)]
    assert max(group.total_byte_size for group in groups) < 1 << 15
    assert len(groups) < 2 + rows * 400 // (1 << 13)


GROWS = [1] * 100_000 + [900_000] * 100
PEAK = """
import resource, subprocess, sys
done = subprocess.run([sys.executable, "-m", "atwood_cli", *sys.argv[1:]], stderr=subprocess.DEVNULL)
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * (1 if sys.platform == "darwin" else 1024))
sys.exit(done.returncode)
"""


@pytest.mark.parametrize("source", ["csv", "parquet"])
def test_rows_that_grow_do_not_fill_the_memory(tmp_path: Path, source: str) -> None:
    """The groups that polars writes have equally many rows, and it reads a group at once: 0.5 to 1.2 GB."""
    pytest.importorskip("resource")
    rng = Random(1)
    texts = [base64.b64encode(rng.randbytes(length * 3 // 4 + 1)).decode() for length in GROWS]
    frame = pl.DataFrame({"m1": 1.0, "m2": 3.0, "s": texts})
    path, out = tmp_path / f"in.{source}", tmp_path / "out.parquet"
    if source == "csv":
        frame.write_csv(path)
    else:  # in one group, of pages of a megabyte or 16 rows
        pq.write_table(frame.to_arrow(), path, use_dictionary=False, write_batch_size=16)
    # By way of a small process, as a child's memory is at least that of its parent.
    words = ["batch", str(path), "-o", str(out), "--only", "regime"]
    done = subprocess.run([sys.executable, "-c", PEAK, *words], capture_output=True, check=True)
    assert int(done.stdout) < 300e6
    assert pl.read_parquet(out, columns=["s"])["s"].equals(frame["s"])


@pytest.mark.parametrize("by", ["polars", "pyarrow"])
@pytest.mark.parametrize("version", ["1.0", "2.0"])
def test_what_is_known_of_pages(monkeypatch: pytest.MonkeyPatch, by: str, version: str) -> None:
    monkeypatch.setattr(pages, "SMALL_BYTES", 0)
    words = [f"run {i % 9}" for i in range(5000)]
    frame = pl.DataFrame({"x": [float(i) for i in range(5000)], "s": words})
    if by == "polars":
        content = written(frame, by, compression="uncompressed", data_page_size=1 << 12, row_group_size=2500)
    else:
        options = {"data_page_size": 1 << 12, "write_batch_size": 16, "use_dictionary": ["s"]}
        content = written(
            frame, by, compression="none", row_group_size=2500, data_page_version=version, **options
        )
    (rows, (numbers, texts)), (other, _) = row_groups(io.BytesIO(content))
    assert rows == other == numbers.values == texts.values == 2500
    assert (numbers.is_text, texts.is_text) == (False, True)
    assert (numbers.dictionary, texts.dictionary) == (0, 9 * (4 + len("run 0")))
    for column in (numbers, texts):
        assert sum(values for values, _ in column.pages) == 2500
    largest = max(size for _, size in numbers.pages)
    assert 1 << 11 < largest <= 1 << 13
    assert 8 * 2500 <= sum(size for _, size in numbers.pages) <= numbers.decoded
    assert largest <= numbers.stored <= largest + 8


def test_a_column_whose_pages_cannot_be_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """At most they are all of it."""
    monkeypatch.setattr(pages, "SMALL_BYTES", 0)
    content = bytearray(written(pl.DataFrame({"s": ["a", "b"] * 500}), "pyarrow", compression="none"))
    ((_, (known,)),) = row_groups(io.BytesIO(content))
    content[4] = 0xFF
    ((_, (unknown,)),) = row_groups(io.BytesIO(content))
    size = known.decoded
    assert unknown == Column(True, 1000, size, size, size, [(1000, size)])
    assert unknown.held == 2 * size  # dictionary and pages are not both all of it
    assert known.pages[0][1] < size
    assert known.held == known.pages[0][1] + 2 * known.dictionary


@given(
    st.lists(st.tuples(st.integers(1, 9), st.integers(0, 30)), min_size=1, max_size=12), st.integers(1, 60)
)
def test_rows_that_are_surely_in_few_pages(parts: list[tuple[int, int]], limit: int) -> None:
    """As many as they are, wherever they begin: one more are not."""
    values = sum(count for count, _ in parts)
    page_of = [page for page, (count, _) in enumerate(parts) for _ in range(count)]

    def most(rows: int) -> int:
        spans = (page_of[start : start + rows] for start in range(values - rows + 1))
        return max(sum(parts[page][1] for page in range(span[0], span[-1] + 1)) for span in spans)

    rows = Column(True, values, 0, 0, 0, parts).rows_within(limit)
    assert rows == 1 or most(rows) <= limit
    assert rows == values or most(rows + 1) > limit


@pytest.mark.parametrize(
    ("limit", "why"),
    [
        (
            "MOST_HELD",
            "the pages of 1000 rows take more than 0 MB, the most taken; write it in smaller row groups",
        ),
        ("MOST_FOOTER", "its footer takes 0 MB, and 0 MB is the most taken; write it in larger row groups"),
    ],
)
def test_limits_of_memory_are_named(
    atwood: Atwood, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, limit: str, why: str
) -> None:
    monkeypatch.setattr(parquet, limit, 500)
    path = tmp_path / "in.parquet"
    pl.DataFrame({"m1": 1.0, "m2": 3.0, "n": [str(i) for i in range(1000)]}).write_parquet(path)
    ran = atwood("batch", str(path))
    assert (ran.status, ran.out, ran.err) == (1, "", f"atwood: cannot read {path}: {why}\n")


class NoPyarrow:
    @staticmethod
    def find_spec(name: str, *_: Any) -> None:
        if name.startswith("pyarrow"):
            raise ModuleNotFoundError(name=name)


def test_more_groups_than_fit_into_memory(
    atwood: Atwood, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name, limit in (("GROUP_BYTES", 1), ("CHUNK_BYTES", 1), ("MOST_CHUNKS", 20)):
        monkeypatch.setattr(parquet, name, limit)
    monkeypatch.setattr(formats, "PIECE_BYTES", 1 << 8)
    (tmp_path / "in.csv").write_text("m1,m2\n" + "1,3\n" * 1000)
    ran = atwood("batch", str(tmp_path / "in.csv"), "-o", str(tmp_path / "out.parquet"), "--only", "regime")
    why = "cannot write more than 20 pieces of columns, the most taken, as parquet; give --to csv"
    assert (ran.status, ran.out, ran.err) == (1, "", f"atwood: {why}\n")
    assert not (tmp_path / "out.parquet").exists()


@pytest.mark.parametrize("source", ["in.parquet", "in.csv"])
def test_without_pyarrow_one_line_says_what_to_install(
    atwood: Atwood, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, source: str
) -> None:
    frame = pl.DataFrame({"m1": [1.0], "m2": [3.0]})
    frame.write_parquet(tmp_path / "in.parquet")
    frame.write_csv(tmp_path / "in.csv")
    for name in [name for name in sys.modules if name.startswith("pyarrow")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setattr(sys, "meta_path", [NoPyarrow, *sys.meta_path])
    out = tmp_path / ("out.csv" if source == "in.parquet" else "out.parquet")
    ran = atwood("batch", str(tmp_path / source), "-o", str(out))
    assert (ran.status, ran.out, out.exists()) == (1, "", False)
    assert ran.err == f"atwood: this needs pyarrow; install it with: {PIP} install 'atwood-cli[batch]'\n"
