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

from atwood_cli.files import Unreadable
from atwood_cli.laboratory.runs import Runs, read_runs
from atwood_cli.model.scene import SceneError, read_input

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
    "time": (
        "t|t (s)|t [s]|t/s|t, s|t in s|t_s|T (s)|Time (s)|Time(s)|Fall time (s)|fall_time|Time t / s|Trial 1 (s)|"
        "t1 [s]|t_1|t5|T1 (s)|time1|time 1|Time Trial 2 (s)|t₁ (s)|Latest: Time (s)|Data Set 1: Time (s)|"
        "Run 1: t (s)|Run 1: t/s|Time (s) Run #1|Time (s) Run 1|t (s) 2"
    ),
    "a": (
        "a|a (m/s^2)|a (m/s²)|a [m/s2]|a/(m/s²)|a / m s^-2|a/(m·s⁻²)|a in m/s²|a_m/s2|acceleration (m/s^2)|"
        "a_exp|A (m/s²)|measured acceleration|a1|Acceleration (m/s²) Run #1|Latest: Acceleration (m/s²)"
    ),
    "m1": "m1|m1/kg|M1|m_1|M_1 [kg]|mass1|Mass 1 (kg)|mass m1 (kg)|m₁ (kg)|m1_kg|m1 kg|m1 (kg) Run #1",
    "m2": "m2|m2/kg|M2|m_2|mass2 (kg)|m2, kg",
    "drop": "drop|h (m)|h/m|h_m|H (m)|s (m)|d (m)|height (m)|Height h (m)|distance|drop height (m)|Drop_Height",
    "u(a)": (
        "u(a)|u_a|u a|a_u|a_err|err_a|a error|error in a|delta_a|Δa|δa|σ_a|sigma_a|± a|±a|a ±|+/- a|da|unc_a|"
        "a uncertainty|uncertainty of a|±|+/-|u|Uncertainty|u(a) (m/s²)|u(a)/(m/s²)|± (m/s²)|u [m/s2]"
    ),
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
def test_headings_as_laboratories_write_them(read: Any, name: str, heading: str) -> None:
    names = [
        "m1",
        "m2",
        *(["a", name, "Team"] if name == "u(a)" else ["a"] if name == "a" else ["drop", "time"]),
    ]
    header = ";".join(f'"{heading}"' if one == name else one for one in names)
    runs = read(f"{header}\n{';'.join(EXAMPLE[one] for one in names)}\n", drop=None)
    (run,) = runs.runs
    measured = "a" if "a" in names else "time"
    u = "0.01" if name == "u(a)" else "0"
    assert numbers(runs) == [exactly("0.2", "0.207", EXAMPLE[measured], "0", "0", u)]
    assert (run.drop and run.drop.value) == (None if measured == "a" else Fraction("0.98"))
    assert run.labels == {one: "A" for one in names if one == "Team"}
    assert heading == name or f"{heading!r} as {name}" in runs.remarks[0]


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
    percent = read("m1,m2,t1,u(t1) %,t2,± (%)\n1,2,4,1,5,2%\n")
    assert numbers(percent) == [exactly("1", "2", "4", "5", "0", "0", "0.04", "0.1")]


# fmt: off
WASHERS = [
    ("total mass (g),dm (g)", "407,7"),
    ("m1+m2 (g),Δm (g)", "407,7"),
    ("m1 + m2,m2 − m1", "0.407,0.007"),
    ("m_2 (g),m_tot (g)", "207,407"),
    ("m1,m1+m2", "0.2,0.407"),
    ("mass difference (g),m1 (g)", "7,200"),
    ("m2,m2-m1 (g)", "0.207,7 g"),
    ("m1,m1+m2,m2,m2-m1", "0.2,9,0.207,9"),  # the others are labels
]
# fmt: on


@pytest.mark.parametrize(("header", "cells"), WASHERS)
def test_two_columns_determine_the_masses(read: Any, header: str, cells: str) -> None:
    runs = read(f"{header},Run 1: t (s),Run 2: t (s)\n{cells},3.99,4\n")
    assert numbers(runs) == [exactly("0.2", "0.207", "3.99", "4", "0", "0", "0", "0")]


def test_a_difference_has_a_sign(read: Any) -> None:
    runs = read("m1+m2;m2-m1;a\n0,4; -0,01;-0,2\n0,4;0,01;0,2\n", drop=None)
    assert [one[:2] for one in numbers(runs)] == [exactly("0.205", "0.195"), exactly("0.195", "0.205")]
    assert runs.signed
    assert runs.remarks == [f"read as: {PARTED}."]


def test_a_heading_is_looked_at_quickly(read: Any) -> None:
    """The patterns took a minute for this one."""
    heading = 50_000 * "/" + "("
    assert read(f"m1,m2,a,{heading}\n1,2,3,4\n", drop=None).labels == [heading]


NOT_KNOWN = "not known; a row is a run, with m1, m2, and a or time: name them so, with units, as in 'm1 (g)'"
ROW = "\n1,2,3,4\n"
HEIGHT = "times need the height of fall: give drop, or a column of that name"
POINT = "; is there a decimal comma (write a point), or one at its end?"
MASS = "kg, g, mg, ug, t, lb, lbs, oz, st, slug"


def column(name: str, why: str) -> str:
    return f"column '{name}' {why}; or let it pass by --label '{name}'"


# fmt: off
NO_TABLES: list[tuple[Any, str]] = [
    # Columns that are missing, or there twice
    ("m1,m2\n1,2\n", "column a or time is missing; there are 'm1', 'm2'"),
    ("m1,a\n1,2\n", "column m2 is missing; there are 'm1', 'a'"),
    (";;\n", "column m1 is missing; there are none"),
    ("Masse 1;Masse 2;Zeit\n0,2;0,207;3,99\n", f"columns 'Masse 1', 'Masse 2', 'Zeit' are {NOT_KNOWN}"),
    ("m1 (g);Masse 2 (g);t\n200;207,5;3,99\n", f"column 'Masse 2 (g)' is {NOT_KNOWN}"),
    ("m1,m2,Zeit\n1,2,3\n", f"column 'Zeit' is {NOT_KNOWN}"),
    ("0.2,0.207,3.99\n0.21,0.22,4\n", f"columns '0.2', '0.207', '3.99' are {NOT_KNOWN}"),
    ("m1,m2,time\n1,2,1\n", HEIGHT),
    ("m1,m2,Fallhöhe,t" + ROW, f"{HEIGHT}; column 'Fallhöhe' is not known"),
    ("m1,m2,a,time\n1,2,1,1\n", "there are columns a and time; keep one, or let one pass by --label"),
    ("m1,m2,a,m_1" + ROW, "columns 'm1' and 'm_1' are both m1; let one pass by --label 'm_1'"),
    ("m1,m2,t1,time 1" + ROW, "columns 't1' and 'time 1' are both time; number what is repeated, as in 'time 1', or"
        " let one pass by --label 'time 1'"),
    ("m1,m2,a,Team,Team\n1,2,1,x,y\n", "column 'Team' is there 2 times"),
    ("m1,m2,a,rows\n1,2,1,1\n", "column 'rows' is called as a result is; rename it"),
    # Columns that could be two things
    ("m1,m2,h,t" + ROW, column("h", "could be meant for drop; name it so, with a unit, like 'drop (m)'")),
    ("m1,m2,a,T1" + ROW, column("T1", "could be meant for time; name it so, with a unit, like 'time (s)'")),
    ("m1,m2,a,M\n1,2,1,1\n", column("M", "holds for all runs, so it is an option: give --M")),
    ("m1,m2,Δm,a" + ROW, column("Δm", "could be an uncertainty; name what of, as in 'u(a)'")),
    ("m1+m2,a\n1,2\n", "column m1 is missing; there are 'm1+m2', 'a'"),
    ("m1 (kg),m1 (kg) Run #2,m2,a" + ROW,
        "columns 'm1 (kg)' and 'm1 (kg) Run #2' are both m1; let one pass by --label 'm1 (kg) Run #2'"),
    ("m1,m2,a,error" + ROW, column("error", "could be an uncertainty; name what of, as in 'u(a)'")),
    ("m1,m2,a,Δt" + ROW, column("Δt", "could be an uncertainty, but no column is what it would be of")),
    ("m1,m2,a,Team,±\n1,2,3,A,1\n", column("±", "could be an uncertainty, but no column is what it would be of")),
    ("m1,m2,a,±,u(a)\n1,2,3,4,5\n", column("u(a)", "is a second uncertainty of a")),
    ("m1,m2,T1 (N),a" + ROW, column("T1 (N)", "has a unit of force; it takes one of time (s, ms, min, h)")),
    ("m1 (s),m2,a\n1,2,1\n", column("m1 (s)", f"has a unit of time; it takes one of mass ({MASS})")),
    # Rows
    ("", "it is empty"),
    ("m1,m2,a\n", "it has no runs"),
    ("m1,m2,a\n1,2\n", "row 1 has 2 cells, and the header 3"),
    ("m1,m2,a\n1,2,3\n1,2,1,5\n", f"row 2 has 4 cells, and the header 3{POINT}"),
    ("Lab 3\nmass a,mass b,t\n1,2,3\n",
        "row 1 has 3 cells, and the header 1; the headings must come first, without lines above them"),
    ("m1,m2,a\n1,,1\n", "row 1 has no m2"),
    ("m1,m2,a\n1,x,1\n", "row 1: m2 'x' is not a number; write it like 2, 0.5 or 1.5e-3"),
    ("m1,m2,a\n1,2,3\nMean,,3\n", "row 2: m1 'Mean' is not a number; write it like 2, 0.5 or 1.5e-3"),
    ("m1,m2,a\n1,2,3\nSeries 2,,\n1,2,3\n",
        "row 2: m1 'Series 2' is not a number; write it like 2, 0.5 or 1.5e-3"),
    ("m1+m2,dm,a\n1,2,3\n", "row 1: m2-m1 '2' and m1+m2 '1' make a mass negative"),
    ("m1+m2,dm,a\n3,1(1),3\n", "row 1: m2-m1 '1(1)' has an uncertainty, which is taken of m1 and m2 alone"),
    ("m1+m2,±,dm,a\n3,1,1,3\n", "row 1: m1+m2 '3' has an uncertainty, which is taken of m1 and m2 alone"),
    ("m1+m2,dm,a\n3,x,3\n", "row 1: m2-m1 'x' is not a number; write it like 2, 0.5 or 1.5e-3"),
    ("m1+m2,dm,a\n3,,3\n", "row 1 has no m2-m1"),
    ("m1,m2,a\n1e31,2,1\n", "row 1: m1 '1e31' is beyond what a fit computes with, 1e-30 to 1e+30"),
    ("m1;m2;a\n1,5;2.5;1\n", "row 1: m2 '2.5' has a point in a table of decimal commas; write all alike"),
    ("m1,m2,a,u\n1,2,3,-1\n", "row 1: u '-1' is no uncertainty; write it like 0.02 or 2%"),
    ("m1,m2,a,u\n1,2,3(1),1\n", "row 1: u '1' is a second uncertainty, beside '3(1)'"),
    ('m1,m2,a\n1,"2,1\n', "it ends within quotation marks, in the row that begins in line 2: it is truncated, or one is"
        " left open"),
    # Columns in Python
    (3, "it is of type int; give a path, a mapping or a data frame"),
    ([[1, 2, 3]], "it is of type list; give a path, a mapping or a data frame"),
    ({"m1": [1], "m2": [2, 3]}, "its columns differ in length: 'm1' has 1 cells, 'm2' has 2 cells"),
    ({"m1": 1, "m2": [2]}, "column 'm1' is of type int; give a sequence of cells"),
    ({"m1": "12", "m2": [2]}, "column 'm1' is of type str; give a sequence of cells"),
    ({"m1": [], "m2": [], "a": []}, "it has no runs"),
    ({"m1": [1], "m2": [True], "a": [1]}, "row 1: m2 'True' is not a number; write it like 2, 0.5 or 1.5e-3"),
    ({"m1": [1], "m2": [None], "a": [1]}, "row 1 has no m2"),
]
# fmt: on


@pytest.mark.parametrize(("table", "error"), NO_TABLES)
def test_what_is_no_table_of_runs_is_refused(read: Any, table: Any, error: str) -> None:
    with pytest.raises(Unreadable) as raised:
        read(table, drop=None) if isinstance(table, str) else read_runs(table)
    assert str(raised.value) == error


# What stands around a table

TABLE = "m1,m2,time\n0.2,0.207,3.99\n0.201,0.206,5.02\n"
SEMICOLONS = TABLE.replace(",", ";").replace(".", ",")
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
    ("Atwood's machine, group 3\n\n" + TABLE, "header in line 3"),
    ('5" drop\n' + TABLE, "header in line 2"),
    ("Lab 3,,\n,,\n" + TABLE, "header in line 3"),
    ("\ufeffLab 3;;;;\n" + SEMICOLONS.replace("\n", ";;\n") + ";;;;\n", f"{PARTED}, header in line 2"),
    (",m1,m2,time\n0,0.2,0.207,3.99\n1,0.201,0.206,5.02\n", ""),  # as pandas writes its index
    ('"m1\n(kg)",m2,time\n' + TABLE.partition("\n")[2], r"'m1\n(kg)' as m1 in kg"),
    (TABLE.replace("0.2,", "0.2kg,").replace("0.206", "206 g"), ""),
]
# fmt: on


TOTALS = [
    ("Mean,,\n", ["'Mean'"]),
    ("Total,,\n,,\nby Anna,x,\n", ["'Total'", "'by Anna x'"]),
]


@pytest.mark.parametrize(("below", "names"), TOTALS)
def test_totals_without_numbers_are_left_out(read: Any, below: str, names: list[str]) -> None:
    runs = read(TABLE + below)
    assert numbers(runs) == numbers(read(TABLE))
    assert runs.remarks == [f"left out below the runs, as it has no numbers: {name}." for name in names]


@pytest.mark.parametrize(("table", "remark"), AROUND)
def test_what_stands_around_a_table(read: Any, table: str, remark: str) -> None:
    runs = read(table)
    assert numbers(runs) == numbers(read(TABLE))
    assert [run.rows for run in runs.runs] == [(1,), (2,)]
    assert runs.remarks == ([f"read as: {remark}."] if remark else [])


def test_windows_1252(read: Any) -> None:
    table = "Gruppe;m1 (g);m2 (g);a (m/s²);± a\nMüller;200;207;0,12;0,01\n"
    runs = read(table.encode("cp1252"), drop=None)
    assert numbers(runs) == [exactly("0.2", "0.207", "0.12", "0", "0", "0.01")]
    assert runs.runs[0].labels == {"Gruppe": "Müller"}
    assert runs.remarks == [
        f"read as: {PARTED}, 'm1 (g)' as m1 in g, 'm2 (g)' as m2 in g,"
        " 'a (m/s²)' as a in m/s², '± a' as u(a), 'Gruppe' as a label, text in Windows-1252."
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
        path.write_bytes("\r\n".join(["Lab;;", header, *rows.split("|"), "Total;;", ""]).encode("cp1252"))
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


def test_a_data_frame_of_pandas() -> None:
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame(COLUMNS | {"Team": ["A", pandas.NA]})
    runs = read_runs(frame, drop=DROP)
    assert numbers(runs) == numbers(read_runs(COLUMNS, drop=DROP))
    assert [run.labels for run in runs.runs] == [{"Team": "A"}, {"Team": ""}]


def test_rows_left_out_are_marked() -> None:
    runs = read_runs(COLUMNS, drop=DROP, without=[2])
    assert [(run.rows, run.left_out) for run in runs.runs] == [((1,), False), ((2,), True)]
    assert runs.runs[0].cells == ("row 1, t1", "row 1, t2")
    with pytest.raises(SceneError, match="without '3' is no row; there are 1 to 2"):
        read_runs(COLUMNS, drop=DROP, without=[3])


def test_many_rows_of_the_same_masses_are_one_run() -> None:
    many = 3000
    runs = read_runs({"m1": [1] * many, "m2": [2] * many, "a": [3] * many})
    assert [len(run.measured) for run in runs.runs] == [many]
    assert runs.runs[0].rows == tuple(range(1, many + 1))
