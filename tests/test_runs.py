"""Tables of runs as spreadsheets, people and Python make them, and what is read from them."""

import io
import json
import sys
from fractions import Fraction
from math import nan
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from atwood_cli.laboratory.runs import VOCABULARY, Runs, read_runs
from atwood_cli.model.scene import SceneError, read_input
from atwood_cli.tables.headings import read_named
from atwood_cli.tables.sources import Unreadable

from .running import Atwood

DROP = read_input("drop", "98cm")


@pytest.fixture
def read(tmp_path: Path) -> Any:
    """The runs of a text."""

    def call(table: str | bytes, drop: Any = DROP) -> Runs:
        path = tmp_path / "runs.csv"
        path.write_bytes(table if isinstance(table, bytes) else table.encode())
        return read_runs(path, (), drop)

    return call


def numbers(runs: Runs) -> Any:
    """Of each run m1, m2, what was measured, and the uncertainties of all these."""
    inputs = [(run.m1, run.m2, *run.measured) for run in runs.runs]
    return [[one.value for one in some] + [one.uncertainty for one in some] for some in inputs]


def exactly(*words: str) -> list[Fraction]:
    return [Fraction(word) for word in words]


# Headings

HEADINGS = {
    "time": "t|T (s)|Time (s)|time 1|t_5|t in s|T1",
    "a": "a|A (m/s²)|acceleration in m/s²|a1",
    "m1": "m1|M1/kg|m_1 [kg]",
    "drop": "drop|h (m)|H/m|Height in m",
    "u(a)": "u(a)|a_err|±|u(a) (m/s²)",
}
EXAMPLE = {
    "m1": "0.2",
    "m2": "0.207",
    "time": "3.99",
    "a": "0.12",
    "drop": "0.98",
    "u(a)": "0.01",
    "Team": "A",
}


@pytest.mark.parametrize(
    ("name", "heading"), [(name, one) for name, words in HEADINGS.items() for one in words.split("|")]
)
def test_the_words_of_a_run(read: Any, name: str, heading: str) -> None:
    """The grammar itself has its tests in `test_headings`."""
    measured = ["a"] if name == "a" else ["a", name, "Team"] if name == "u(a)" else ["drop", "time"]
    names = ["m1", "m2", *measured]
    header = ";".join(heading if one == name else one for one in names)
    runs = read(f"{header}\n{';'.join(EXAMPLE[one] for one in names)}\n", drop=None)
    (run,) = runs.runs
    value, u = EXAMPLE["a" if "a" in names else "time"], "0.01" if name == "u(a)" else "0"
    assert numbers(runs) == [exactly("0.2", "0.207", value, "0", "0", u)]
    assert (run.drop and run.drop.value) == (None if "a" in names else Fraction("0.98"))
    assert heading == name or f"{heading!r} as {name}" in runs.remarks[0]


def test_what_no_word_is_known_for_is_named(tmp_path: Path) -> None:
    path = tmp_path / "runs.csv"
    path.write_text(
        "Masse 1 (g);Masse 2 (g);Zeit A;Zeit B;Fehler (s);Ort\n200;207,5;3,9;4,1;0,1;Ulm\n", encoding="cp1252"
    )
    words = ["m1=Masse 1 (g)", "m2=Masse 2 (g)", "t=Zeit A", "t=Zeit B", "u(t)=Fehler (s)"]
    runs = read_runs(path, (), DROP, (), read_named(words, VOCABULARY))
    assert numbers(runs) == [exactly("0.2", "0.2075", "3.9", "4.1", "0", "0", "0.1", "0.1")]
    assert runs.remarks == [
        f"read as: {PARTED}, 'Masse 1 (g)' as m1 in g, 'Masse 2 (g)' as m2 in g, 'Zeit A' as time, 'Zeit B' as time,"
        " 'Fehler (s)' as u(time) in s."
    ]


def test_columns_below_a_merged_heading_are_repeats(read: Any) -> None:
    """Two thirds of the data were dropped in silence, and c changed from 10.4 to 5.4 g."""
    table = "m1 in g;m2 in g;t in s;;;Bemerkung\n200;207;3,9;4;4,1;\n201;206;5;;5,2;warm\n"
    runs = read(table)
    assert [[float(one.value) for one in run.measured] for run in runs.runs] == [[3.9, 4.0, 4.1], [5.0, 5.2]]
    assert runs.remarks == [
        f"read as: {PARTED}, 'm1 in g' as m1 in g, 'm2 in g' as m2 in g, 't in s' as time in s, 'column 4' as time in s,"
        " 'column 5' as time in s."
    ]


def test_uncertainties_are_in_the_unit_of_their_column(read: Any) -> None:
    table = "m1 (g),±,m2 (g),±,t1 (s),t2 (s),u(t) (ms)\n200,0.1,207,0.2 g,3.9,4,20\n201,,207,±1%,5,,2e1\n"
    runs = read(table)
    assert numbers(runs) == [
        exactly("0.2", "0.207", "3.9", "4", "0.0001", "0.0002", "0.02", "0.02"),
        exactly("0.201", "0.207", "5", "0", "0.00207", "0.02"),
    ]
    assert runs.remarks == [
        "read as: 'm1 (g)' as m1 in g, '±' as u(m1), 'm2 (g)' as m2 in g, '±' as u(m2), 't1 (s)' as time in s,"
        " 't2 (s)' as time in s, 'u(t) (ms)' as u(time) in ms."
    ]
    behind = read("m1,m2,t1,±,t2,±\n1,2,4,0.1,5,0.2\n")
    assert numbers(behind) == [exactly("1", "2", "4", "5", "0", "0", "0.1", "0.2")]
    percent = read("m1,m2,t1,u(t1) (%),t2,± (%)\n1,2,4,1,5,2%\n")
    assert numbers(percent) == [exactly("1", "2", "4", "5", "0", "0", "0.04", "0.1")]


# fmt: off
NO_COLUMNS: list[tuple[Any, str]] = [
    (3, "it is of type int; give a path, a mapping or a data frame"),
    ([[1, 2, 3]], "it is of type list; give a path, a mapping or a data frame"),
    ({"m1": [1], "m2": [2, 3]}, "its columns differ in length: 'm1' has 1 cells, 'm2' has 2 cells"),
    ({"m1": 1, "m2": [2]}, "column 'm1' is of type int; give a sequence of cells"),
    ({"m1": "12", "m2": [2]}, "column 'm1' is of type str; give a sequence of cells"),
    ({"m1": [], "m2": [], "a": []}, "it has no runs"),
    ({"m1": [1], "m2": [True], "a": [1]}, "row 1: m2 'True' is not a number; write it like 2, 1.5e-3, 2.0+-0.1 or 2.0(1)"),
    ({"m1": [1], "m2": [None], "a": [1]}, "row 1 has no m2"),
]
# fmt: on


@pytest.mark.parametrize(("table", "error"), NO_COLUMNS)
def test_what_is_no_table_of_columns_is_refused(table: Any, error: str) -> None:
    """Texts that are no table are in `cases/fit.md`."""
    with pytest.raises(Unreadable) as raised:
        read_runs(table)
    assert str(raised.value) == error


# What stands around a table

TABLE = "m1,m2,time\n0.2,0.207,3.99\n0.201,0.206,5.02\n"
SEMICOLONS = TABLE.replace(",", ";").replace(".", ",")
ABOVE = "lines above the headings left out"
PARTED = "cells parted by semicolons, decimal commas"


# fmt: off
AROUND: list[tuple[Any, str]] = [
    (TABLE, ""),
    ("\ufeff" + TABLE.replace("\n", "\r\n"), ""),
    (TABLE.replace("\n", "\n\n"), ""),
    (TABLE.replace("\n", ",,\n", 1), ""),
    (TABLE.replace("\n", ",,\n"), ""),
    (SEMICOLONS, PARTED),
    (TABLE.replace(",", "\t"), "cells parted by tabs"),
    ("sep=;\r\n" + SEMICOLONS, PARTED),
    ("sep=,\n" + TABLE, ""),
    ("# Group 3\n# it's 5\" high\n" + TABLE, "lines that begin with # left out"),
    (TABLE.replace("\n0.201", "\n#0.3,0.4,1\n0.201"), "lines that begin with # left out"),
    ("# " + TABLE, ""),  # as numpy.savetxt writes a header
    ("Atwood's machine, group 3\n\n" + TABLE, ABOVE),
    ('5" drop\n' + TABLE, ABOVE),
    ("Lab 3,,\n,,\n" + TABLE, ABOVE),
    ("\ufeffLab 3;;;;\n" + SEMICOLONS.replace("\n", ";;\n") + ";;;;\n", f"{PARTED}, {ABOVE}"),
    ('"m1\n(kg)",m2,time\n' + TABLE.partition("\n")[2], r"'m1\n(kg)' as m1 in kg"),
    (TABLE.replace("0.2,", "0.2kg,").replace("0.206", "206 g"), ""),
]
# fmt: on


@pytest.mark.parametrize(("table", "remark"), AROUND)
def test_what_stands_around_a_table(read: Any, table: str, remark: str) -> None:
    runs = read(table)
    assert numbers(runs) == numbers(read(TABLE))
    assert [run.rows for run in runs.runs] == [(1,), (2,)]
    assert runs.remarks == ([f"read as: {remark}."] if remark else [])


def test_windows_1252(read: Any) -> None:
    table = "Gruppe;m1 (g);m2 (g);a (m/s²);±\nMüller;200;207;0,12;0,01\n"
    runs = read(table.encode("cp1252"), drop=None)
    assert numbers(runs) == [exactly("0.2", "0.207", "0.12", "0", "0", "0.01")]
    assert runs.remarks == [
        f"read as: {PARTED}, 'm1 (g)' as m1 in g, 'm2 (g)' as m2 in g,"
        " 'a (m/s²)' as a in m/s², '±' as u(a), text in Windows-1252."
    ]


def test_what_is_no_text_stays_what_it_is(read: Any) -> None:
    with pytest.raises(Unreadable, match="UTF-8"):
        read(TABLE.encode("utf-16"))


def test_paths_and_stdin(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "runs.tsv"
    path.write_text(TABLE.replace(",", "\t"), encoding="utf-8")
    want = read_runs(path, drop=DROP)
    assert want.remarks == []
    assert read_runs(str(path), drop=DROP) == want
    monkeypatch.setattr(sys, "stdin", SimpleNamespace(buffer=io.BytesIO(TABLE.encode())))
    assert read_runs("-", drop=DROP) == want


def test_the_command_reads_what_a_spreadsheet_saves(atwood: Atwood, tmp_path: Path) -> None:
    rows = "0,055;0,060;0,380|0,060;0,065;0,354|0,065;0,070;0,323|0,070;0,075;0,310|0,065;0,075;0,649|0,08;0,095;0,78"
    path = tmp_path / "runs.csv"
    for header in ("m1 (kg);m2 (kg);a (m/s²)", "M1/kg;M2/kg;Acceleration in m/s²"):
        path.write_bytes("\r\n".join(["Lab;;", header, *rows.split("|"), ";;", ""]).encode("cp1252"))
        ran = atwood("fit", str(path), "--g", "9.81", "--find", "c", "--json")
        assert json.loads(ran.out)["rim_mass"] == pytest.approx(0.0128, rel=0.05)


# Columns in Python


class Frame:
    """The part of a pandas data frame that is read: columns, of which several may have one heading."""

    def __init__(self, *columns: tuple[str, Any]) -> None:
        self.items = lambda: iter(columns)


COLUMNS = {"m1": [0.2, 0.201], "m2": [0.207, 0.206], "t1": [3.99, 5.02], "t2": [4.01, nan]}


def test_columns_are_as_a_file_of_them(read: Any) -> None:
    want = numbers(read("m1,m2,t1,t2\n0.2,0.207,3.99,4.01\n0.201,0.206,5.02,\n"))
    polars = pytest.importorskip("polars")
    for source in (
        COLUMNS,
        {name: np.array(column) for name, column in COLUMNS.items()},
        {name: [str(one) for one in column] for name, column in COLUMNS.items()},
        COLUMNS | {"t2": [4.01, None]},
        {f"{name} (g)" if "m" in name else name: [1000 * one if "m" in name else one for one in column]
         for name, column in COLUMNS.items()} | {"m1 (g)": [200, 201]},
        polars.DataFrame(COLUMNS),
        polars.DataFrame(COLUMNS | {"t2": [4.01, None]}),
        Frame(*COLUMNS.items()),
    ):  # fmt: skip
        assert numbers(read_runs(source, drop=DROP)) == want
    pairs = Frame(("m1", [1]), ("±", [0.1]), ("m2", [2]), ("±", [0.2]), ("a", [3]))
    assert numbers(read_runs(pairs)) == [exactly("1", "2", "3", "0.1", "0.2", "0")]


def test_rows_left_out_are_marked() -> None:
    runs = read_runs(COLUMNS, drop=DROP, without=[2])
    assert [(run.rows, run.left_out) for run in runs.runs] == [((1,), False), ((2,), True)]
    with pytest.raises(SceneError, match="without '3' is no row; there are 1 to 2"):
        read_runs(COLUMNS, drop=DROP, without=[3])


def test_many_rows_of_the_same_masses_are_one_run() -> None:
    many = 3000
    runs = read_runs({"m1": [1] * many, "m2": [2] * many, "a": [3] * many})
    assert [len(run.measured) for run in runs.runs] == [many]
    assert runs.runs[0].rows == tuple(range(1, many + 1))
