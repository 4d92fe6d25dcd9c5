"""Tables as spreadsheets, people and Python make them: their headings, their cells, and the runs that these make.

How a table by words of its own is read, and which are refused, stands in `cases/fit.md`.
"""

import gzip
import re
from datetime import timedelta
from fractions import Fraction
from math import nan
from pathlib import Path
from random import Random
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from atwood_cli.batch.solving import Wanted, read_columns
from atwood_cli.laboratory.columns import VOCABULARY
from atwood_cli.laboratory.runs import Runs, read_runs
from atwood_cli.reading.inputs import read_input
from atwood_cli.solver.quantities import NAMES
from atwood_cli.solver.scene import INPUTS, Unit
from atwood_cli.tables import cells, headings, sheets, sources
from atwood_cli.tables.sources import Unreadable

from .conftest import many
from .tools.running import Batch

# Headings and cells: the grammar that `fit` and `batch` share

SCENES = headings.Vocabulary({name.replace("_", ""): name for name in INPUTS})
HEADINGS = {
    "m1": "m1|m_1|m 1|m₁|M1|mass1|Masse 1|Mass 1 (m)|m1 (-)",
    "m1 kg": "m1 kg|m1_kg|m_1_kg|m1,kg|m1, kg|Masse 1, kg|m1 (kg)|m1(kg)|m1 [kg]|m1/kg|m1 / kg|m1 in kg|m₁ (kg)|m_1 [ kg ]|m1\n(kg)|m1\u00a0(kg)|M1/kg",
    "time": "t|T|time|Time|t (-)|time [1]|Time (t)",
    "time s": "t, s|t s|t_s|time,s|t (s)|t [s]|t/s|t in s|Time (s)|Time(s)|time / s|T (s)",
    "time 2": "t2|t_2|t 2|t₂|time2|time 2|Time 2|T2",
    "time 2 ms": "t2_ms|time 2, ms|time 2 ms|t2 (ms)|time 2 [ms]|t_2/ms|Time 2 in ms",
    "a": "a|A|acceleration",
    "a 1": "a1",
    "a m/s²": "a (m/s²)|a/(m/s²)|a [m/s²]|a in m/s²|A (m/s²)|acceleration in m/s²",
    "drop": "drop|h|Height",
    "drop m": "h_m|drop, m|h (m)|H/m|Height in m",
    "u(a)": "u(a)|u (a)|a_err|a err|±|+/-|± (-)",
    "u(a) m/s2": "u(a), m/s2|a_err_m/s2|±, m/s2|u(a) (m/s2)|a_err [m/s2]|u(a)/(m/s2)|u(a) in m/s2|± (m/s2)",
    "": "Δm|t mean|h_fall|t_max|m1+m2|tt|Trial 1 (s)|fall time|u(b)|b_err|a_error|t#2||(s)|mu|TIME",
}


@pytest.mark.parametrize(
    ("want", "heading"), [(want, one) for want, all_ in HEADINGS.items() for one in all_.split("|")]
)
def test_the_grammar_of_headings(want: str, heading: str) -> None:
    found = headings.read_headings(["a" if want.startswith("u") else "Team", heading], VOCABULARY)
    said = [
        " ".join(filter(None, (one.name, one.number, one.unit)))
        if heading == one.column
        else one.u and " ".join(filter(None, (f"u({one.name})", one.u.unit)))
        for one in found
    ]
    assert said == [want] * bool(want)
    assert headings.recognised([heading], VOCABULARY) == [heading] * bool(want)


@pytest.mark.parametrize("columns", ["m1|m_1", "t1|time 1", "m1 (s)", "a|Team|±", "m1|a_err", "a|±|u(a)", "mu (g)", "wrap (kg)"])  # fmt: skip
def test_a_column_that_is_refused_may_pass_as_a_label(columns: str) -> None:
    """Its last could be two things, or has a wrong unit; `cases/fit.md` and `cases/batch.md` have the sentences."""
    *others, last = columns.split("|")
    vocabulary = SCENES if last.startswith(("mu", "wrap")) else VOCABULARY
    words = f"(; rename it|; --label '?{re.escape(last)}'? leaves it unread)$"
    with pytest.raises(Unreadable) as refused:
        headings.read_headings([*others, last], vocabulary)
    assert re.search(words, f"{refused.value}{refused.value.options}")
    assert last not in [one.column for one in headings.read_headings([*others, last], vocabulary, [last])]


DOUBTFUL = """
M: Mass|pulley_mass|Pulley mass (g)|pulley mass, g|m|m_kg|mass of the sheave; g: gravity|G|local gravity
mu: μ|µ|friction|MU|coeff. of friction|f|f (-)|Reibungszahl; mu_k: sliding friction|Gleitreibung; wrap: φ|contact angle (deg)|turns|Umschlingung
wrap: angle of wrap|wraps|alpha (deg)|θ; axle: Axle (N)|Axle_mN|friction in the bearing (N)
inertia: beta|Inertia; I: moment of inertia|Trägheitsmoment; R: radius|radius_cm|r cm|sheave radius
"""


@pytest.mark.parametrize("words", re.split("; |\n", DOUBTFUL.strip()))
def test_a_heading_that_may_mean_an_input_is_refused(words: str) -> None:
    name, headings = words.split(": ")
    for heading in headings.split("|"):
        with pytest.raises(Unreadable, match=re.escape(f"column '{heading}' may mean {name} (")):
            read_columns([*({"m1", "m2"} - {name}), heading], Wanted(NAMES))


GRAMS = headings.Heading(0, "m1 (g)", "m1", unit="g", read=Unit("g", Fraction(1, 1000)))


@pytest.mark.parametrize(
    ("cell", "comma", "value", "uncertainty"),
    [
        ("200", False, "0.2", "0"),
        (" 200,5 ", True, "0.2005", "0"),
        ("0.2kg", False, "0.2", "0"),
        ("2e2", False, "0.2", "0"),
        ("200.0(5)", False, "0.2", "0.0005"),
        ("200±0,5", True, "0.2", "0.0005"),
        ("200 g ± 1%", False, "0.2", "0.002"),
        ("1/3", False, "1/3000", "0"),
        *((empty, False, "", "") for empty in ("", "  ", "NA", "NULL", "null")),
    ],
)
def test_cells_are_read_exactly(cell: str, comma: bool, value: str, uncertainty: str) -> None:
    want = (Fraction(value), Fraction(uncertainty), cell) if value else None
    read = cells.read_cell(GRAMS, [cell], comma)
    assert (read and (read.number, read.uncertainty, read.given)) == want


# Runs

DROP = read_input("drop", "98cm")
TABLE = "m1,m2,time\n0.2,0.207,3.99\n0.201,0.206,5.02\n"
SEMICOLONS = TABLE.replace(",", ";").replace(".", ",")
PARTED = "cells separated by semicolons, decimal commas"
COMMENTS, ABOVE = "lines that begin with # left out", "lines above the headings left out"
BELOW = "units in the row below the headings"


@pytest.fixture
def read(tmp_path: Path) -> Any:
    """The runs of a text."""

    def call(table: str | bytes, name: str = "runs.csv", **named: str) -> Runs:
        (tmp_path / name).write_bytes(table if isinstance(table, bytes) else table.encode())
        return read_runs(tmp_path / name, given={"drop": DROP}, named=named)

    return call


def numbers(runs: Runs) -> list[list[float]]:
    """Of each run m1, m2, what was measured, and the uncertainties of all these."""
    m1, m2 = (np.transpose([columns[x] for columns in (runs.given, runs.u)]) for x in ("m1", "m2"))
    of = [np.transpose([runs.values, runs.u_values])[runs.run == i] for i in range(len(m1))]
    return [np.concatenate([[m1[i], m2[i]], of[i]]).ravel("F").tolist() for i in range(len(m1))]


def exactly(*rows: str) -> list[list[float]]:
    return [[*map(float, row.split())] for row in rows]


def test_uncertainties_are_in_the_unit_of_their_column(read: Any) -> None:
    table = "m1 (g),±,m2 (g),±,t1 (s),t2 (s),u(t) (ms)\n200,± 0.1,207,0.2 g,3.9,4,20\n0,,207,±1%,5,,2e1\n"
    first, second = "0.2 0.207 3.9 4 0.0001 0.0002 0.02 0.02", "0 0.207 5 0 0.00207 0.02"
    assert numbers(runs := read(table)) == exactly(first, second)
    assert runs.remarks == [
        "read as: 'm1 (g)' as m1 in g, '±' as u(m1), 'm2 (g)' as m2 in g, '±' as u(m2), 't1 (s)',"
        " 't2 (s)' as time in s, 'u(t) (ms)' as u(time) in ms."
    ]
    behind, percent = "m1,m2,t1,±,t2,±\n1,2,4,0.1,5,0.2\n", "m1,m2,t1,u(t1) (%),t2,± (%)\n1,2,4,1,5,2%\n"
    assert numbers(read(behind)) == exactly("1 2 4 5 0 0 0.1 0.2")
    assert numbers(read(percent)) == exactly("1 2 4 5 0 0 0.04 0.1")


UNIT_OF_M1 = "'m1 (kg)' as m1 in kg; 'm2' in kg, 'time' in s, as no unit is given"


@pytest.mark.parametrize(
    ("table", "remark"),
    [
        (TABLE, ""),
        ("\ufeff" + TABLE.replace("\n", "\r\n"), ""),
        (TABLE.replace("\n", "\n\n"), ""),
        (TABLE.replace("\n", "\r"), ""),  # as Excel saves CSV for an old Macintosh
        (TABLE.replace("\n", ",,\n", 1), ""),
        (TABLE.replace("\n", ",,\n"), ""),
        (re.sub("(?<=[0-9])\n", ",,\n", TABLE), ""),  # a fit of it ended in a traceback
        (SEMICOLONS, PARTED),
        (TABLE.replace(",", "\t"), ""),
        ("sep=;\r\n" + SEMICOLONS, PARTED),
        ("sep=,\n" + TABLE, ""),
        ("# Group 3\n# it's 5\" high\n" + TABLE, COMMENTS),
        (TABLE.replace("\n0.201", "\n#0.3,0.4,1\n0.201"), COMMENTS),
        (TABLE.replace("\n", "\n#g,g,s\n", 1), COMMENTS),  # two columns called g: a header, it was thought
        ("m1,m2,time\ng,(g),-\n200,207,3.99\n201,206,5.02\n", BELOW),
        ("# " + TABLE, ""),  # as numpy.savetxt writes a header
        ("Atwood's machine, group 3\n\n" + TABLE, ABOVE),
        ('5" drop\n' + TABLE, ABOVE),
        ("Lab 3,,\n,,\n" + TABLE, ABOVE),
        ("\ufeffLab 3;;;;\n" + SEMICOLONS.replace("\n", ";;\n") + ";;;;\n", f"{PARTED}, {ABOVE}"),
        (TABLE.replace("m1", '"m1\n(kg)"'), UNIT_OF_M1),
        (TABLE.encode("utf-16"), ""),  # as Excel saves "Unicode text"
        (b"\xfe\xff" + TABLE.replace(",", "\t").encode("utf-16-be"), ""),
        ("m1,m2,time,mean\n.2,.207,3.99,4\n.201,.206,5.02,5\n", "'mean' as a label"),
        (TABLE.replace("0.2,", "0.2kg,").replace("0.206", "206 g"), ""),
    ],
)
def test_what_stands_around_a_table(read: Any, table: str | bytes, remark: str) -> None:
    runs = read(table)
    assert numbers(runs) == exactly("0.2 0.207 3.99 0 0 0", "0.201 0.206 5.02 0 0 0")
    assert runs.rows == [[1], [2]]
    assert runs.remarks == ([f"read as: {remark}."] if remark else [])


def test_the_step_of_readings_is_that_of_the_last_digit(read: Any) -> None:
    """Times of 10 and 20 s had a step of 10 s."""
    assert [read(f"m1,m2,t\n1,2,{t}\n2,3,20\n").step for t in ("10", "9.5", "8.25")] == [1, 0.1, 0.01]


UNCERTAIN = "error|u|± a|σ|Uncertainty (s)|SD|std dev (s)|dt (s)|Unsicherheit t (s)|Incertitude|Fehler".split(
    "|"
)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("quantity,run 1,run 2\nm1,0.2,0.201\nm2,0.207,0.206\nt,3.99,5.02\n", ": make each run a row, below headings, as m1 (g),m2 (g),t (s)"),
        ("n,mass one (g),Zeit (s),mass two (g)\n1,2,3,4\n", "; give --column 'm1=mass one (g)' --column 'm2=mass two (g)' --column 't=Zeit (s)'"),
        ("m1,m2,t,F (N),SD,Fall t (s),dt (s)\n1,2,3,4,5,6,7\n", "columns 'SD', 'dt (s)' could be an uncertainty; name what of"),
        *((f"m1,m2,t,{column}\n1,2,3,4\n", f"column '{column}' could be an uncertainty") for column in UNCERTAIN),
    ],
)  # fmt: skip
def test_files_that_are_refused_with_a_sentence(read: Any, content: str, words: str) -> None:
    with pytest.raises(Unreadable) as refused:
        read(content)
    assert words in f"{refused.value}{refused.value.options}"


CALLED = {"m1": "m1|M1|mass 1|Masse_1|Größere Masse (m)|Масса груза|Wagen (A)", "drop": "drop|h|Fallhöhe|Weg (h)|альтитуда", "t": "t|Time|Zeit (t)|temps|t mean"}  # fmt: skip
IN_UNITS: dict[str, dict[str, Any]] = {"m1": {"g": "1e-3", "kg": 1, "mg": "1e-6", "lb": "0.45359237", "г": "1e-3"}, "drop": {"cm": "1e-2", "m": 1, "мм": "1e-3", "in": "0.0254"}, "t": {"s": 1, "ms": "1e-3", "с": 1}}  # fmt: skip
WAYS = " (%s)|(%s)| [%s]|/%s| in %s|, %s|,%s| %s|_%s| (%s) (left)| (±1 %s)|(±0.1)%s| ± 2%% (%s)|".split("|")
TRUTH = {"m1": ("0.2", "0.21"), "drop": ("0.9", "1.1"), "t": ("3.5", "2.5")}


def test_no_heading_changes_a_result_without_a_word(tmp_path: Path) -> None:
    """A table reads as it does in SI units, or is refused, or the line "read as" says that no unit is given."""
    rng, same, ways = Random(58), 0, set[bool]()
    for _ in range(many(2000)):
        columns, named = {"m2": ["0.3", "0.4"]}, dict[str, str]()
        for name, truth in TRUTH.items():
            unit, way = rng.choice([*IN_UNITS[name]]), rng.choice(WAYS)
            column = rng.choice(CALLED[name].split("|")) + (way % unit if way else "")
            scale = Fraction(IN_UNITS[name][unit]) if way else 1
            columns[column] = [str(float(Fraction(x) / scale)) for x in truth]
            if rng.random() < 0.7:
                named[column] = name
        try:
            runs = read_runs(columns, named=named)
        except Unreadable as refused:
            ways.add("--" in refused.options)
            continue
        clauses = runs.remarks[0].split("; ")  # the last may have the columns without a unit
        said = clauses[-1] if "as no unit is given" in clauses[-1] else ""
        got = [runs.given["m1"], runs.given["drop"], runs.values]
        for column, truth, values in zip([*columns][1:], TRUTH.values(), got, strict=True):
            right = np.allclose(values, [*map(float, truth)], rtol=1e-9)
            assert right or repr(column) in said, (column, named, runs.remarks)
            same += right
    assert ways == {True}
    assert same > many(2000)


def test_a_small_file_does_not_fill_the_memory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A file of 1 MB with 1 GB of blank lines took 11 GB."""
    (tmp_path / "runs.csv.gz").write_bytes(gzip.compress(b"\n" * (3 << 20)))
    monkeypatch.setattr(sheets, "MOST_BYTES", 1 << 20)
    with pytest.raises(Unreadable, match="it is larger than 1 MB, unpacked, the most that fit reads"):
        read_runs(tmp_path / "runs.csv.gz", given={"drop": DROP})


def test_columns_are_as_a_file_of_them(read: Any, tmp_path: Path) -> None:
    polars = pytest.importorskip("polars")
    columns: Any = {"m1": [0.2, 0.201], "m2": [0.207, 0.206], "t1": [3.99, 5.02], "t2": [4.01, nan]}
    want = read("m1\tm2\tt1\tt2\n0.2\t0.207\t3.99\t4.01\n0.201\t0.206\t5.02\t\n", "runs.tsv")
    assert numbers(want) == exactly("0.2 0.207 3.99 4.01 0 0 0 0", "0.201 0.206 5.02 0 0 0")
    missing = columns | {"t2": [4.01, None]}
    for source in (
        str(tmp_path / "runs.tsv"),
        columns,
        missing,
        {name: np.array(column) for name, column in columns.items()},
        {name: [str(one) for one in column] for name, column in columns.items()},
        polars.DataFrame(columns),
        polars.DataFrame(missing),
    ):
        runs = read_runs(source, given={"drop": DROP})
        assert (numbers(runs), runs.remarks) == (numbers(want), want.remarks)
    pairs = [("m1 (g)", [1000]), ("±", [100]), ("m2", ["2"]), ("±", [0.2]), ("a", [3])]
    pandas = SimpleNamespace(items=lambda: iter(pairs))  # in which several columns may have one heading
    assert numbers(read_runs(pandas)) == exactly("1 2 3 0.1 0.2 0")


def test_lines_are_counted_through_all_pieces(batch: Batch, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sources, "BLOCK_BYTES", 8)
    said = batch("m1,m2\n" + "1,3\n" * 20 + '"p"q,3\n').err
    assert "the row that begins in line 22 has a quotation mark" in said


def test_a_header_may_come_in_two_pieces(batch: Batch, monkeypatch: pytest.MonkeyPatch) -> None:
    """A heading with a line end, from a pipe, was "a quotation mark out of place"."""
    monkeypatch.setattr(sources, "BLOCK_BYTES", 1)
    assert batch('"time\nof day";m1;m2\n9;1;3\n').out.startswith('"time\nof day";m1;m2;regime;')
    assert batch('{"m1":1,"m2":3}\n{"m1":1,"m2":3,"n":9}\n', "--column M=n", "in.ndjson").status == 0


def test_differences_of_times_are_in_seconds(tmp_path: Path) -> None:
    polars, pandas = pytest.importorskip("polars"), pytest.importorskip("pandas")
    masses, times = {"m1": [0.2, 0.201, 0.2], "m2": [0.207, 0.206, 0.21]}, [3.99, 5.02, nan]
    spans = [timedelta(seconds=3.99), timedelta(seconds=5.02), None]
    want = numbers(read_runs(masses | {"t": times}, given={"drop": DROP}))
    for heading in ("t", "t (ms)"):  # the unit of a cell goes first
        for column in (spans, np.array([3990, 5020, "NaT"], "m8[ms]"), np.array(spans, "m8[ns]")):
            assert numbers(read_runs(masses | {heading: column}, given={"drop": DROP})) == want
        for frame in (polars.DataFrame, pandas.DataFrame):
            assert numbers(read_runs(frame(masses | {heading: spans}), given={"drop": DROP})) == want


class ArrowTable:
    """A table as PyArrow has it: columns without names, whose cells are no numbers of Python."""

    column_names = ("m1", "m2", "a")
    columns = tuple(SimpleNamespace(to_pylist=cells.copy) for cells in ([0.2, 0.3], [0.4, 0.5], [1, 2]))


def test_tables_of_other_makers_are_read_or_refused_by_their_type() -> None:
    want = {"m1": ["0.2", "0.3"], "m2": ["0.4", "0.5"], "a": ["1", "2"]}
    assert numbers(read_runs(ArrowTable())) == numbers(read_runs(want))
    with pytest.raises(
        Unreadable, match=r"it is of type SimpleNamespace; give a path, a mapping or a data frame"
    ):
        read_runs(SimpleNamespace(columns=["m1", "m2", "a"]))


ENCODED = "n,m1,m2\nä,1,3\n\nö,2,3\n"


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("size", [5, 1 << 20])
def test_one_rule_for_encodings_and_line_ends(
    batch: Batch, tmp_path: Path, encoding: str, end: str, size: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """`batch` refused what `fit` read."""
    monkeypatch.setattr(sources, "BLOCK_BYTES", size)
    ran = batch(ENCODED.replace("\n", end).encode(encoding), "--only a")
    if (encoding, size) == ("cp1252", 5):  # the first block tells the encoding
        assert "it is not UTF-8, though it begins so; save it as UTF-8" in ran.err
        return
    rows = ["n,m1,m2,acceleration,error", "ä,1,3,4.903325,", "ö,2,3,1.96133,"]
    assert ran.out.removeprefix("\ufeff").split("\r\n" if end == "\r\n" else "\n") == [*rows, ""]
    assert ("read as: text in Windows-1252." in ran.err) == (encoding == "cp1252")
    table = ENCODED.replace("n,", "a (m/s²),").replace("ä", "1").replace("ö", "2").replace("\n", end)
    (tmp_path / "runs.csv").write_bytes(table.encode(encoding))
    runs = read_runs(tmp_path / "runs.csv")
    assert numbers(runs) == exactly("1 3 1 0 0 0", "2 3 2 0 0 0")


@pytest.mark.parametrize(
    ("content", "why"),
    [
        (TABLE.encode("utf-16")[:-1], "it is not UTF-16, though it begins so; save it as UTF-8"),
        (TABLE.encode("utf-32"), "it is in UTF-16 or UTF-32; save it as UTF-8"),
    ],
)
def test_encodings_that_are_refused(batch: Batch, read: Any, content: bytes, why: str) -> None:
    assert why in batch(content).err
    with pytest.raises(Unreadable, match=re.escape(why)):
        read(content)


@pytest.mark.parametrize(
    "damage", [lambda x: x + b"x", lambda x: x[:-8] + b"wrng" + x[-4:], lambda x: x[:-9]]
)
def test_damaged_gzip_is_called_so(batch: Batch, read: Any, damage: Any) -> None:
    """A wrong sum, or bytes behind it, was "not compressed"."""
    content = damage(gzip.compress(TABLE.encode()))
    assert batch(content, "", "in.csv.gz").err == "atwood: cannot read IN: it is damaged\n"
    with pytest.raises(Unreadable, match="it is damaged"):
        read(content, "runs.csv.gz")


def test_a_header_may_have_one_known_heading(batch: Batch) -> None:
    """The row with most words was the header."""
    assert batch("m1,1,2\n0.3,good,bad\n0.4,fair,poor\n", "--m2 1 --only a").out.startswith("m1,1,2,acceleration,error\n0.3,good,bad,")  # fmt: skip
    assert batch("Mass 1\nm1 (kg),quality,m2\n1,good,3\n", "--only a").out.startswith("m1 (kg),quality,m2,acceleration")  # fmt: skip
