"""Tables as spreadsheets, people and Python make them: their headings, their cells, and the runs that these make.

How a table by words of its own is read, and which are refused, stands in `cases/fit.md`.
"""

import gzip
import json
import re
import shlex
from datetime import timedelta
from fractions import Fraction
from itertools import count, pairwise
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
from atwood_cli.reading.units import UNITS
from atwood_cli.solver.quantities import NAMES
from atwood_cli.solver.scene import INPUTS
from atwood_cli.tables import headings, sheets, sources
from atwood_cli.tables.places import NotUnderstood
from atwood_cli.tables.sources import Unreadable

from .conftest import many
from .tools.running import Batch, called

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
        with pytest.raises(Unreadable, match=re.escape(f"'{heading}' ({name}?) is not read, and may matter")):
            read_columns(sheets.Sheet([*({"m1", "m2"} - {name}), heading], ()), Wanted(NAMES))


# Runs

DROP = read_input("drop", "98cm")
TABLE = "m1,m2,time\n0.2,0.207,3.99\n0.201,0.206,5.02\n"
SEMICOLONS = TABLE.replace(",", ";").replace(".", ",")
PARTED = "cells separated by semicolons, decimal commas"
COMMENTS, ABOVE = "lines that begin with # left out", "lines above the headings left out"
BELOW = "'m1 g' as m1 in g, 'm2 (g)' as m2 in g; 'time' in s, as no unit is given"


@pytest.fixture
def read(tmp_path: Path) -> Any:
    """The runs of a text."""

    def call(table: str | bytes, name: str = "runs.csv", words: str = "") -> Runs:
        (tmp_path / name).write_bytes(table if isinstance(table, bytes) else table.encode())
        return read_runs(tmp_path / name, headings.read_naming(words, (), (), VOCABULARY), {"drop": DROP})

    return call


def numbers(runs: Runs) -> list[list[float]]:
    """Of each run m1, m2, what was measured, and the uncertainties of all these."""
    m1, m2 = (np.transpose([columns[x] for columns in (runs.given, runs.u)]) for x in ("m1", "m2"))
    of = [np.transpose([runs.values, runs.u_values])[runs.run == i] for i in range(len(m1))]
    return [np.concatenate([[m1[i], m2[i]], of[i]]).ravel("F").tolist() for i in range(len(m1))]


def exactly(*rows: str) -> list[list[float]]:
    return [[*map(float, row.split())] for row in rows]


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
        ("Measurement of g,,(kg),[s]\n" + TABLE, ABOVE),
        ("\ufeffLab 3;;;;\n" + SEMICOLONS.replace("\n", ";;\n") + ";;;;\n", f"{PARTED}, {ABOVE}"),
        (TABLE.replace("m1", '"m1\n(kg)"'), UNIT_OF_M1),
        (TABLE.encode("utf-16"), ""),  # as Excel saves "Unicode text"
        (b"\xfe\xff" + TABLE.replace(",", "\t").encode("utf-16-be"), ""),
        ("m1,m2,time,mean\n.2,.207,3.99,4\n.201,.206,5.02,5\n", "not read: 'mean'"),
        (TABLE.replace("0.2,", "0.2kg,").replace("0.206", "206 g"), ""),
    ],
)
def test_what_stands_around_a_table(read: Any, table: str | bytes, remark: str) -> None:
    runs = read(table)
    assert numbers(runs) == exactly("0.2 0.207 3.99 0 0 0", "0.201 0.206 5.02 0 0 0")
    assert runs.rows == [[1], [2]]
    said = remark if remark.startswith("not read") else f"read as: {remark}"
    assert [*runs.remarks, *runs.unused] == ([f"{said}."] if remark else [])


def test_the_step_of_readings_is_that_of_the_last_digit(read: Any) -> None:
    """Times of 10 and 20 s had a step of 10 s."""
    assert [read(f"m1,m2,t\n1,2,{t}\n2,3,20\n").step for t in ("10", "9.5", "8.25")] == [1, 0.1, 0.01]


UNCERTAIN = "error|u|± a|σ|Uncertainty (s)|SD|std dev (s)|dt (s)|Unsicherheit t (s)|Incertitude|Fehler"
TITLED = "A (g),B (g),t,Note\n50,53,3,\n,,2.9,\n%s\n50,53,2,\n"
HALF_FILLED = "Scheibe,61 g,\nA,B,t\n.15,,1.9\n,,1.8\n.16,.17,1.4\n"
BY_BLANKS = "m1 (g)  m2 (g)  t (s)\n90  95  3.2\n90  99  2.3\n"
IN_WORDS = "A: 90 g,B: 95 g\nt A: 3 s,t B: 2 s\n"
FOUR = "m1 (g),m2 (g),t.ms,F\n200,210,3000,1\n200,220,2000,1\n"
REFUSED: list[tuple[str, str | bytes, str]] = [
    ("fit -", "quantity,run 1,run 2\nm1,0.2,0.201\nm2,0.207,0.206\nt,3.99,5.02\n", "its runs are columns: make each run a row, below headings, as m1 (g),m2 (g),t (s)"),
    ("fit -", "m1,m2,t\n.2,.21,3\nm1,m2,t\n.2,.22,2\n", "row 2 has headings of a second table; give it a file of its own"),
    ("fit -", "m1,m2,t\n.2,.21,3\n,.22,2\n", "row 2: m1 is missing; write it in each row, or fill by m1+ in columns"),
    ("fit -", "Lauf,m1 (g),m2 (g),t\n1,90,95,2\n2,90,98,1.5\nmit Öl,,,\n1,90,95,1.9\n", "row 3 has words and no time, as a title has; give the rows below a file of their own, or, if it is a note, begin it with #"),
    ("fit -", "Lauf,m1 (g),m2 (g),t\n1,90,95,2\n2,90,98,1.5\nPlan B,80,,\n1,80,85,1.9\n", "row 3 has words and no time, as a title has"),
    ("fit - --columns m1:g+,m2:g+,t", TITLED % "Plan B,,,", "row 3 has words and no time"),  # taken as repeats
    ("fit - --columns m1+,m2+,t", HALF_FILLED, "row 1: m2 is missing"),  # its title was its first row
    *(("fit -", f"m1,m2,t,{column}\n1,2,3,4\n", f"'{column}' is not read, and may matter") for column in UNCERTAIN.split("|")),
    *((f"fit - {options}", table, "no column has such numbers: write a heading above each, as m1 (g),m2 (g), one number a cell, and a comma, a semicolon or a tab between cells\n") for options in ("", "--columns=-", "--columns=?") for table in (BY_BLANKS, IN_WORDS)),
    ("fit - --columns=m2:g --m1=?", BY_BLANKS, "a comma, a semicolon or a tab between cells\n"),  # led back to itself
    ("fit - --columns m1:g,m2:kg,t", FOUR, "--columns does not fit: column 'm2 (g)' has the unit 'g', not 'kg'\n"),
    ("fit - --columns m1,m1:g,t", FOUR, "--columns does not fit: column 'm2 (g)' means m2, not m1\n"),
    ("fit - --columns m1,m2,t:s", FOUR, "--columns does not fit: column 't.ms' has the unit 'ms', not 's'\n"),
    ("fit - --columns m1,m2,t:g", FOUR, "--columns does not fit: column 't.ms' has the unit 'ms', not 'g'\n"),
    ("fit - --columns m1,m2,t,t,t", FOUR, "--columns 'm1,m2,t,t,t' are 5 words, and the table has 4 columns\n"),
    ("fit - --columns m1,m2,x", FOUR, "--columns 'x' is no word for a column: m1, m2, drop, a, time, M, g, inertia, I, R, axle, or - for one that is not read\n"),
    ("fit - --columns m1,m2,t --column t=F", FOUR, "--columns 'm1,m2,t' says what each column is; leave --column out\n"),
    ("batch - --from ndjson --columns m1,m2", '{"m1":1,"m2":2}\n', "--columns takes columns in their order; those of NDJSON have names\n"),
    ("batch - --columns m1+,m2", "1,2\n,3\n", "--columns 'm1+,m2' fills blank cells by +, which are not given in a table of scenes\n"),
    ("fit -", TABLE.encode("utf-16")[:-1], "it is not UTF-16, though it begins so; save it as UTF-8\n"),
    *((f"{command} -", TABLE.encode("utf-32"), "it is in UTF-16 or UTF-32; save it as UTF-8\n") for command in ("fit", "batch")),
]  # fmt: skip


@pytest.mark.parametrize(("command", "content", "why"), REFUSED, ids=count())
def test_what_is_refused_with_a_sentence(command: str, content: str | bytes, why: str) -> None:
    words = [*command.split(), *["--drop", "98cm"] * ("fit" in command)]
    ran = called(words, content if isinstance(content, bytes) else content.encode())
    assert (ran.status, ran.out) == (2 if why.startswith("--columns") else 1, "")
    assert ran.err.endswith(why) if why.endswith("\n") else why in ran.err


ASKED = [
    ("batch --only a", "m1,m2,D (mm)\n1,3,500\n", "'D (mm)' (diameter?) is not read, and may matter", "m1:kg,m2:kg,?"),
    ("batch --only regime", "a,b\n1,2\n", "m1 (0 if nothing hangs there), m2 are missing", "-,?|m1 m2"),
    ("batch --only regime", "m1,m2,m2 (g)\n1,2,3\n", "column 'm2 (g)' holds m2, as 'm2' does; read one", "m1:kg,m2:kg,?"),
    ("batch", "m1,m2,Moment of inertia (g cm2)\n1,3,7\n", "'Moment of inertia (g cm2)' (I?) is not read, and may matter", "m1:kg,m2:kg,?"),
    ("batch", "m1,m2,M (cm)\n1,3,7\n", "column 'M (cm)' has the unit 'cm'; it takes UNITS", "m1:kg,m2:kg,?"),
    ("batch", "m1,m2,mu (kg)\n1,3,7\n", "column 'mu (kg)' must hold plain numbers, without the 'kg'", "m1:kg,m2:kg,?"),
    ("batch --only a --label M_", "m1,m2,M\n1,3,10\n", "there is no column 'M_'; there are 'm1', 'm2', 'M'", "m1:kg,m2:kg,M:kg"),
    ("batch --only a --column M=Rolle", "m1,m2,M,Rolle\n1,3,10,20\n", "column 'Rolle' holds M, as 'M' does; read one", "m1:kg,m2:kg,M:kg,?"),
    ("batch --only a", "\"Mass\n(kg)\",m1,m2\n5,1,3\n", "'Mass (kg)' (M?) is not read, and may matter", "?,m1:kg,m2:kg"),
    ("fit", "m1 (g);Masse 2 (g);t\n200;207,5;3,99\n", "drop is missing", "m1:g,m2:g,t:s|drop"),
    ("fit", "0.2,0.207,3.99\n0.21,0.22,4\n", "m1 (0 if nothing hangs there), m2, t (or a), drop are missing", "?,?,?|m1 m2 drop"),
    ("fit", "m1,m2,t1,time 1\n1,2,3,4\n", "column 'time 1' holds time, as 't1' does; are they repeats?", "m1:kg,m2:kg,t1:s,?|drop"),
    ("fit", "m1,m2,a,t_err\n1,2,3,4\n", "column 't_err' could be an uncertainty, but of no column that is read (- leaves it unread)", "m1:kg,m2:kg,a:m/s2,?"),
    ("fit", "m1,m2,a,±,u(a)\n1,2,3,4,5\n", "column 'u(a)' is a second uncertainty of a", "m1:kg,m2:kg,a:m/s2,a_err,?"),
    ("fit --drop 1m --column 't=Tempo (furlong/h)'", "m1,m2,Tempo (furlong/h)\n1,2,3\n", "column 'Tempo (furlong/h)' has the unit 'furlong/h'; it takes s, ms, us, min, h", "m1:kg,m2:kg,?"),
    ("fit --drop 1", "m1,m2,t,u(t) (zz)\n1,2,3,4\n", "column 'u(t) (zz)' has the unit 'zz'; it takes s, ms, us, min, h", "m1:kg,m2:kg,t:s,?"),
    ("fit", "m1,m2,a,mu\n1,2,3,0.3\n", "'mu' is not read, and may matter", "m1:kg,m2:kg,a:m/s2,?"),
    ("fit --drop 1m", "m1 (N),u(m1) (g),m2,t\n1,1,1,1\n", "column 'u(m1) (g)' has another kind of unit than 'm1 (N)'", "m1:N,?,m2:kg,t:s"),
    ("fit --drop 50cm", "m1;m2;m3;t\n0,09 kg;0,09 kg;0,02 kg;1,1\n0,09 kg;0,09 kg;0,03 kg;0,9\n", "'m3' is not read, and may matter", "m1,m2,?,t:s"),
    ("fit --drop 1m", "m1 (g),m2 (g),Hanger (g),t\n100,110,5,2.2\n100,120,5,1.6\n", "'Hanger (g)' is not read, and may matter", "m1:g,m2:g,?,t:s"),
    ("fit", "M1+M2 (g),M1-M2 (g),a (m/s^2)\n115,5,0.380\n125,5,0.354\n", "m1 (0 if nothing hangs there), m2 are missing", "?,?,a:m/s2|m1 m2"),
    ("fit", "m1 (g),m2 (g),Total mass (g),a\n55,60,115,0.380\n60,65,125,0.354\n", "'Total mass (g)' is not read, and may matter", "m1:g,m2:g,?,a:m/s2"),
    ("fit", "M1(g);M2(g);Beschleunigung\n12;20;2,2 m/s2\n20;30;1,5\n30;40;1,1\n", "t (or a), drop are missing", "m1:g,m2:g,a:m/s2"),
    ("fit --column t=Zeit", "Masse 1;Masse 2;Höhe (cm);Zeit\n1;2;3;4\n", "drop is missing", "m1:kg,m2:kg,drop:cm,t1:s"),
    ("fit", "m1,m2,a theo (cm/s²),a exp (cm/s²)\n1,2,3,4\n", "t (or a), drop are missing", "m1:kg,m2:kg,a:cm/s2?,a:cm/s2?"),
    ("fit --drop 1m", "M (g),m (g),t\n100,110,2.5\n", "m1 (0 if nothing hangs there), m2 are missing", "M:g,?,t:s|m1 m2"),
    ("fit --drop 1m", "m1,m2,Mean (s),Trial 1 (s),Trial 2 (s)\n1,2,3,4,2\n", "t (or a) is missing", "m1:kg,m2:kg,t:s?,t:s?,t:s?"),
    ("fit --drop 1m", "m1,m2,1st trial,2nd trial,Mean\n1,2,3,4,5\n", "t (or a) is missing", "m1:kg,m2:kg,?,?,?"),
    ("fit --drop 1m", "Vikt 1 (g);Vikt 2 (g);Tid 1;Tid 2;v 1 [m/s];v 2 [m/s]\n90;95;2;2,1;1;1\n", "m1 (0 if nothing hangs there), m2, t (or a) are missing", "m1:g?,m2:g?,t:s?,t:s?"),
    ("fit --drop 1m --m1 0", "m (g),2M/m (g),t\n90,95,2\n", "m2 is missing", "?,?,t:s|m2"),
    ("fit --drop 1m --columns ?", "m1,m2,t,h,±\n1,2,3,1,0.1\n", "its columns are to be decided", "m1:kg,m2:kg,t:s,?,?"),
    ("fit", "Beban : 0,09 kg;;;\nr : 0,06 m;;;\nMasa 1 (kg);Masa 2 (kg);Jarak (m);Waktu (s)\n0,09;0,10;0,4;1,5\n", "t (or a), drop are missing", "m1:kg,m2:kg,drop:m,t:s"),
    ("fit --drop 1", "m1,m2,t,,m1,m2,t\n1,2,3,,1,3,2\n", "column 'm1' holds m1, as another of that heading does; read one", "m1:kg,m2:kg,t:s,-,?,?,?"),
    ("fit --drop 0.5", "m1 (g),m2 (g),t,Δm (g)\n200,220,1.72,20\n", "'Δm (g)' is not read, and may matter", "m1:g,m2:g,t:s,?"),
    ("batch --only a", "m1 (g),m2 (g),dm (g),∆m (g),x\n500,510,10,10,7\n", "'dm (g)' (M?), '∆m (g)' (M?) are not read, and may matter", "m1:g,m2:g,?,?"),
    ("fit --drop 0.9", "m1 (g),m2 (g),t (s),t obs (s),t max,v after t (m/s)\n150,165,1.9,2,3,1\n", "'t obs (s)', 't max' are not read, and may matter", "m1:g,m2:g,t:s?,?,?"),
    ("fit --drop 0.5", "m1 (g),m2 (g),t 1st,t 2nd,t\n200,220,1.7,1.74,1.72\n", "column 't' stands beside 't 1st', and one may be computed, as a mean is", "m1:g,m2:g,t1:s,t2:s,?"),
    ("fit --drop 1m", "Wurf;0,02;0,03\n1;1,4;1,2\n", "m1 (0 if nothing hangs there), m2, t (or a) are missing; if headings that are numbers are loads, make each load rows of its own, or type one command a load, as --columns drop:m,-,t --m2 60g", "-,?,?|m1 m2"),
    ("fit --m1 0 --m2 50g --drop 1m", "T (s),T (s)\n1,2\n", "column 'T (s)' holds time, as another of that heading does; are they repeats?", "t:s,?"),
    ("fit --m1 0 --m2 50g --drop 1m --column 't=T(s)'", "T(s),T(s)\n1,2\n", "2 columns have the heading 'T(s)'", "t:s,?"),
    ("fit --drop 1m", "m1 (g);m2 (g);acc. [m/s²];durée [s]\n90;95;0,2;3,2\n90;99;0,4;2,3\n", "t (or a) is missing", "m1:g,m2:g,-,t:s"),
    ("fit", "m1 (g);m2 (g);durée [s];acc. [m/s²]\n90;95;3,2;0,2\n90;99;2,3;0,4\n", "t (or a), drop are missing", "m1:g,m2:g,-,a:m/s2"),
    ("batch --only a", "Gewichte (g),,Rad\nm1,m2,M (g)\n150,165,61\n", "'m1', 'm2' are without a unit, and a line above has one", "m1:g?,m2:g?,M:g"),
    ("fit --drop 1m", "Massen in g;;t in s;\nlinks;rechts;1;2\n150;165;1,9;2\n160;180;1,5;1,6\n", "m1 (0 if nothing hangs there), m2 are missing", "?,?,t:s,?|m1 m2"),
    ("fit --m1 0 --m2 9g --drop 1m", "Gesamt, gr;Dauer\n150;3\n160;2\n", "t (or a) is missing", "?,?"),
    ("fit --m1 0", "drop (m);m2 = 0,03 kg;m2 = 0,05 kg\n0,4;1,2;0,9\n0,6;1,5;1,1\n", "m2, t (or a) are missing", "drop:m,?,?|m2"),
    ("fit --drop 0.7", "Scheibe;61 g;\nLi (g);Re (g);t (s)\n150;165;1,9\n150;175;1,4\n", "m1 (0 if nothing hangs there), m2 are missing", "?,?,t:s|m1 m2"),
    ("fit --m1 0 --m2 9g --drop 1 --columns '?'", "no.\tt (s)\tt ideal (s)\n1\t4\n2\t3\n", "its columns are to be decided", "-,t:s"),
    ("fit --axle 0", "m1,m2,a,g\n1,2,3,9.8\n1,3,4,9.81\n", "'g' is not the same in all rows, as it must be", "m1:kg,m2:kg,a:m/s2,g:m/s2?"),
    ("fit --drop 1m --columns m2:g,-,t", "Last,F (N),t (s)\n50,0.5,2\n60,0.6,1.8\n", "m1 (0 if nothing hangs there) is missing", "m2:g,-,t1:s|m1"),
    ("fit --m1 0 --drop 1m", ",Time (seconds),\nMass (grams),Test 1,Test 2\n50,1.02,1.29\n,.97,1.31\n", "m2, t (or a) are missing", "m2:g+?,t:s?,t:s?"),
    ("fit --drop 1m", "| m1 (g) | m2 (g) | F (N) | t² |\n|---|:-:|---|---|\n| 50 | 60 | 1 | 2 |\n", "t (or a) is missing", "m1:g,m2:g,?,?"),
    ("fit --m1 0 --drop 1m", "Mass, m (kg)\tmean, τ (s)\n0.1\t9.53\n0.2\t17.9\n", "m2, t (or a) are missing", "m2:kg?,t:s"),
    ("batch", "m1,m2,Kąt [°]\n1,3,270\n", "'Kąt [°]' (wrap?) is not read, and may matter", "m1:kg,m2:kg,?"),
]  # fmt: skip
"""Tables that are not understood: why, and the words of --columns to type, with options that are missing behind them."""


@pytest.mark.parametrize(("command", "table", "why", "typed"), ASKED)
def test_what_is_not_understood_is_asked_once(command: str, table: str, why: str, typed: str) -> None:
    """What is to be typed is no error, and where a word is open, the columns are listed again as they were."""
    words, (columns, _, options) = shlex.split(command), typed.partition("|")
    asked = called([words[0], "-", *words[1:]], table.encode())
    why_asked, *listing, last = asked.err.splitlines()
    why = why.replace("UNITS", ", ".join([*UNITS["mass"], *UNITS["force"]]))
    assert why_asked.partition("; lines above")[0] == f"atwood: cannot read stdin: {why}"
    to_type = shlex.split(last)[1:]
    missing = [word[2:] for word, value in pairwise(to_type) if value == "?" and word != "--columns"]
    assert (dict(pairwise(to_type)).get("--columns", ""), " ".join(missing)) == (columns, options)
    again = called(to_type, table.encode())
    assert again.status < 2
    if "?" in to_type:
        assert called(shlex.split(again.err.splitlines()[-1])[1:], table.encode()).status < 2
    assert ("first cells" in again.err) == ("?" in columns or bool(options))
    assert max(map(len, listing)) <= 80


def test_a_height_is_taken_beside_accelerations() -> None:
    """The command of a listing keeps --drop, as a column may be t or a, and this was refused."""
    table = b"m1 (g),m2 (g),acc. (m/s2)\n90,95,0.2\n90,99,0.4\n"
    asked = called(["fit", "-", "--drop", "1m", "--axle", "0", "--only", "rim_mass"], table)
    ran = called(shlex.split(asked.err.splitlines()[-1])[1:], table)
    assert ran.status == 0
    assert "The height of fall: not used, as accelerations were measured." in ran.err


RIM, FRICTION = 0.03, 0.008  # kg, N
LOADS = [("150", "165"), ("155", "185"), ("160", "200"), ("150", "190")]  # g


def fall(m1: str, m2: str, height: float = 0.7, rim: float = RIM) -> float:
    """The time of a fall from rest, by Newton's second law."""
    light, heavy = float(m1) / 1000, float(m2) / 1000
    return float(np.sqrt(2 * height * (heavy + light + rim) / (9.80665 * (heavy - light) - FRICTION)))


TIMES = [[f"{fall(*load) + slip:.4f}" for slip in (-0.002, 0, 0.002)] for load in LOADS]
RUNS = [*zip(LOADS, TIMES, strict=True)]
FORMS = {
    "R's headings, read at once": ("mass1.g,mass2.g,height.cm,time.s\n" + "".join(f"{a},{b},70,{t}\n" for (a, b), ts in RUNS for t in ts), ""),
    "the same by place": ("mass1.g,mass2.g,height.cm,time.s\n" + "".join(f"{a},{b},70,{t}\n" for (a, b), ts in RUNS for t in ts), "--columns m1,m2:g,drop,t"),
    "theory under the same heading": ("Lauf;links (g);rechts (g);a (m/s);±;a (m/s)\n" + "".join(f"{i};{a};{b};{1.4 / float(ts[1]) ** 2:.5f};9%;{i}\n" for i, ((a, b), ts) in enumerate(RUNS)), "--columns -,m1:g,m2:g,a:m/s2"),
    "rows of means": ("essai,m1 (g),m2 (g),t (s)\n" + "".join(f"{i},{a},{b},{t}\n" for i, ((a, b), ts) in enumerate(RUNS) for t in ts) + "moyen.,150,165,9\n中央値,150,165,9\n", "--columns -,m1:g,m2:g,t --drop 0.7"),
    "a column of means": ("Vikt 1 (g)\tVikt 2 (g)\tTid A\tTid B\tTid C\tmedel\n" + "".join(f"{a},{b},{','.join(ts)},9\n".replace(",", "\t") for (a, b), ts in RUNS), "--columns m1:g,m2:g,t,t,t --drop 70cm"),
    "two rows of headings, and merged cells": ("Nr,Gewicht,,Fallweg,Zeit,,\n,A (g),B (g),(cm),1.,2.,3.\n" + "".join(f"{i},{a},{b},{'70' if i == 0 else ''},{','.join(ts)}\n" for i, ((a, b), ts) in enumerate(RUNS)), "--columns -,m1:g,m2:g,drop:cm+,t,t,t"),
    "no headings": ("".join(f"{a};{b};{';'.join(ts)}\n".replace(".", ",") for (a, b), ts in RUNS), "--columns m1:g,m2:g,t,t,t --drop 70cm"),
    "loads across, one of them read": ("h (cm) / F (cN),60,70\n" + "".join(f"{h},{fall('0', '60', h / 100):.4f},{fall('0', '70', h / 100):.4f}\n" for h in (20, 40, 60)), f"--columns drop:cm,-,t --m1 0 --m2 70g --axle {FRICTION}"),
    "bodies under one heading": ("t (s),t (s)\n" + "".join(f"{fall('0', '90') + slip:.4f},{fall('0', '90', rim=0.2) + slip:.4f}\n" for slip in (-0.002, 0, 0.002)), f"--columns t --m1 0 --m2 90g --drop 0.7 --axle {FRICTION}"),
}  # fmt: skip
"""Tables as people keep them, and how they are read."""


@pytest.mark.parametrize("form", FORMS)
def test_tables_of_every_form_give_what_they_were_made_with(form: str) -> None:
    table, options = FORMS[form]
    options += "" if "drop" in options or "height" in table or "a:" in options else " --drop 70cm"
    ran = called(["fit", "-", "--json", *shlex.split(options)], table.encode())
    assert ran.status == 0, ran.err
    results = json.loads(ran.out)
    assert results["rim_mass"] == pytest.approx(RIM, abs=1e-3)
    assert len(results["runs"]) == (3 if "across" in form else 1 if "bodies" in form else 4)


def test_nothing_is_left_out_in_silence(read: Any) -> None:
    """A label, a column to the right, rows of words, and a column that is a mean of the others."""
    table = "Team,m1,m2,t1,t2,t3,t mean\n1.5,1,2,3,5,4,7\n2.5,1,3,2,2.5,2.25,8\n3.5,1,4,1.9,2,1.95,9\nΣx,1,4,1,1,1,\nNA,1,5,1.7,1.8,1.75,x\n"
    assert read(table).unused == [
        "not read: 'Team', 't mean'.",
        "row 4: not used, as 'Team' has a word there, and most rows a number.",
    ]
    assert read(table).doubts[-1].startswith("in each row t3 is the mean of the other repeats")
    assert not any("is the mean" in doubt for doubt in read(table.replace("2.25", "2.24")).doubts)


@pytest.mark.parametrize(
    ("command", "table", "cells"),
    [
        ("fit --only rim_mass", "m1 (g),m2 (g),a\n150,165,40 cm/s2\n150,175,0.6\n0,175,3\n", ["a without a unit are read in m/s²"]),
        ("fit --only rim_mass", "m1,m2 (g),a\n0,165,2\n0,175,2.1\n30 g,185 g,1.9\n", []),
        ("batch --only a", "m1,m2,M,wrap\n150 g,165 g,inf,180\n150,165,,270\n20 N,0,,180\n", ["m1 without a unit are read in kg", "m2 without a unit are read in kg"]),
        ("batch --only a", "m1,m2 (g),g,inertia\n150 g,165,moon,hoop\n0,165 g,9.8,0.5\n", []),
    ],
)  # fmt: skip
def test_a_unit_in_some_cells_alone_is_not_passed_over(command: str, table: str, cells: list[str]) -> None:
    """Grams in the first row were followed by kilograms without a word. 0 needs no unit, and a word is none."""
    words = command.split()
    said = called([words[0], "-", *words[1:]], table.encode()).err
    assert re.findall("ells of (.*)\\.", said) == cells


MEANS_OF_REPEATS = "150,165,1.86|150,165,1.91|150,165,1.885|155,185,1.38|155,185,1.34|155,185,1.36|160,200,1.17|160,200,1.22|160,200,1.195"
MEAN_OF_RUNS = "150,165,1.71,1.73|150,175,1.322,1.301|150,190,1.071,1.066|150,185,1.3677,1.3657"
MARKS = "150,165,.53|150,165,.92|150,190,.35|150,190,.60"
NO_REPEATS = [
    (MEANS_OF_REPEATS, "1.195", "1.197", "In each run the last row is the mean of the others; if it was computed, leave out rows 3, 6, 9."),
    (MEAN_OF_RUNS, "1.3677", "1.3667", "The last row is the mean of the others; if it was computed, leave out row 4."),
    (MARKS, ".92", ".55", "The rows of each run differ as a whole, as marks of one fall do: are they of one height?"),
]  # fmt: skip
"""Runs, a text to replace by another so that they are honest repeats, and what is said else."""


@pytest.mark.parametrize(("rows", "computed", "measured", "doubt"), NO_REPEATS)
def test_rows_that_are_no_repeats_are_doubted(rows: str, computed: str, measured: str, doubt: str) -> None:
    """Rows of means counted as runs, or as repeats, as did times at several heights of one fall."""
    headings = "m1 (g),m2 (g),t1,t2" if rows is MEAN_OF_RUNS else "m1 (g),m2 (g),t"
    table = f"{headings}|{rows}".replace("|", "\n")
    fit = ["fit", "-", "--drop", "70cm", "--axle", "0", "--only", "rim_mass"]
    assert doubt[1:] in called(fit, table.encode()).err
    assert doubt[1:] not in called(fit, table.replace(computed, measured).encode()).err


def test_a_word_that_differs_between_repeats_is_doubted() -> None:
    """Two pulleys were pooled without a word; with --only, no column and no row that is not used was named."""
    table = "Belt,Who,t,m1 (g),m2 (g),All\nold,K1,2,90,95,x\n,K2,1.5,90,99,x\nnew,L1,2.5,90,95,x\n,L2,1.4,90,100,x\n,L3,,90,99,x\n"
    for form in ("--only=rim_mass", "--csv"):
        said = called(["fit", "-", "--drop", "60cm", "--axle", "0", form], table.encode()).err
        assert (
            "'Belt' differs between rows that are taken as repeats: is it another pulley or another load?"
            in said
        )
        assert "Not read: 'Belt', 'Who'.\n" in said
        assert "Row 5: not used, as no time was measured." in said
        assert "'Who' differs" not in said


def test_a_title_within_the_rows_begins_other_runs(read: Any) -> None:
    """Runs of two pulleys were taken as repeats. A note at the end, or a run that failed, is left out and named."""
    assert read(TITLED % "50,53,,jammed", words="m1:g+,m2:g+,t").rows == [[1, 2, 4]]
    assert read("Lauf,m1 (g),m2 (g),t\n1,50,53,3\n2,50,56,2\nmit Öl,,,\n").rows == [[1], [2]]


def test_a_title_with_a_number_is_no_row(read: Any) -> None:
    """It was the first row of runs, or a heading whose unit was read, in the command that was printed itself."""
    runs = read(HALF_FILLED.replace("15,", "15,.165"), words="m1+,m2+,t")
    assert [*runs.given["m1"]] == [0.15, 0.16]
    assert ABOVE in runs.remarks[0]
    one = "fit - --m1 0 --m2 61g --drop 1m --axle 0 --columns -,t --csv".split()
    assert "1 run, 2 times" in called(one, b"Rad:;61 g;\nNr;lap;v\n1;1,9;1\n2;1,8;1\n").err
    headed = HALF_FILLED.replace("Scheibe,61 g,", "Massen (g),,Zeit (ms)").replace("15,", "150,165")
    assert read(headed, words="m1:g+,m2:g+,t").values[0] == 0.0019


def test_uncertainties_by_place(read: Any) -> None:
    """One column for all repeats, or one behind each; an uncertainty in the heading stays."""
    text = "A (±1 g),B,,,,\n200,210,3,0.1,4,0.2\n"
    for words, second in (("t,t_err,t,t_err", 0.2), ("t,t_err,t", 0.1), ("t,+/-,t,u(t2)", 0.2)):
        assert numbers(read(text, words=f"m1:g,m2:g,{words}"))[0][4:] == [0.001, 0, 0.1, second]


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
            runs = read_runs(columns, headings.Naming(named=named))
        except Unreadable as refused:
            ways.add(isinstance(refused, NotUnderstood))
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


def test_a_header_may_have_one_known_heading(batch: Batch) -> None:
    """The row with most words was the header."""
    assert batch("m1,1,2\n0.3,good,bad\n0.4,fair,poor\n", "--m2 1 --only a").out.startswith("m1,1,2,acceleration,error\n0.3,good,bad,")  # fmt: skip
    assert batch("Mass 1\nm1 (kg),quality,m2\n1,good,3\n", "--only a").out.startswith("m1 (kg),quality,m2,acceleration")  # fmt: skip
