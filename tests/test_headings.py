"""Headings and cells of tables: the grammar that `fit` and `batch` share."""

import re
from fractions import Fraction

import pytest

from atwood_cli.model.scene import INPUTS
from atwood_cli.tables.headings import (
    Heading,
    Vocabulary,
    decimal_commas_in,
    read_as,
    read_cell,
    read_headings,
    read_named,
    read_uncertainty,
    recognised,
)
from atwood_cli.tables.sources import Unreadable

RUNS = Vocabulary(
    {"m1": "m1", "m2": "m2", "t": "time", "time": "time", "Time": "time", "a": "a"}, ("time", "a"), True
)
SCENES = Vocabulary({name.replace("_", ""): name for name in INPUTS})
HEADINGS = {
    "m1": "m1|m_1|m 1|m₁",
    "m1 kg": "m1 (kg)|m1(kg)|m1 [kg]|m1/kg|m1 / kg|m1 in kg|m₁ (kg)|m_1 [ kg ]|m1\n(kg)|m1\u00a0(kg)",
    "time": "t|time|Time|t (-)|time [1]",
    "time s": "t (s)|t [s]|t/s|t in s|Time (s)|Time(s)|time / s",
    "time 2": "t2|t_2|t 2|t₂|time2|time 2|Time 2",
    "time 2 ms": "t2 (ms)|time 2 [ms]|t_2/ms|Time 2 in ms",
    "a m/s²": "a (m/s²)|a/(m/s²)|a [m/s²]|a in m/s²",
    "u(a)": "u(a)|u (a)|a_err|a err|±|+/-|± (-)",
    "u(a) m/s2": "u(a) (m/s2)|a_err [m/s2]|u(a)/(m/s2)|u(a) in m/s2|± (m/s2)",
    "": "mass1|Masse 1|Δm|m1+m2|tt|T|M1|Trial 1 (s)|fall time|u(b)|b_err|a_error|t#2||(s)|m1 kg|mu",
}


@pytest.mark.parametrize(
    ("want", "heading"), [(want, one) for want, all_ in HEADINGS.items() for one in all_.split("|")]
)
def test_the_grammar_of_headings(want: str, heading: str) -> None:
    behind = "a" if want.startswith("u") else "Team"
    found = read_headings([behind, heading], RUNS)
    said = [
        " ".join(filter(None, (one.name, one.number, one.unit)))
        if heading == one.column
        else one.u and " ".join(filter(None, (f"u({one.name})", one.u.unit)))
        for one in found
    ]
    assert said == [want] * bool(want)
    assert recognised([heading], RUNS) == [heading] * bool(want)


def test_names_of_scenes_tell_capitals_apart() -> None:
    columns = "m1 (g)|m2 [g]|M|m|mu|mu_k|g|G|R/cm|r|wrap (turn)|axle (mN)|u(m1)".split("|")
    found = {one.column: (one.name, one.factor) for one in read_headings(columns, SCENES)}
    thousandth = Fraction(1, 1000)
    masses = {"m1 (g)": ("m1", thousandth), "m2 [g]": ("m2", thousandth)}
    plain = {name: (name, 1) for name in ("M", "mu", "mu_k", "g")}
    units = {"R/cm": ("R", Fraction(1, 100)), "wrap (turn)": ("wrap", 360), "axle (mN)": ("axle", thousandth)}
    assert found == masses | plain | units


def test_what_the_grammar_does_not_know_is_named() -> None:
    words = "m1=Masse 1 (g)|m2 [g]=Masse (rechts)|t=Zeit A (s)|t=Zeit B (s)|u(t)=Fehler = 1σ".split("|")
    named = read_named(words, RUNS)
    columns = ["Masse 1 (g)", "Masse (rechts)", "Zeit A (s)", "Zeit B (s)", "Fehler = 1σ", "m1"]
    found = read_headings(columns, RUNS, ["m1"], named)
    said = [f"{one.place} {one.name} {one.unit}" for one in found]
    assert said == ["0 m1 g", "1 m2 g", "2 time s", "3 time s"]
    assert [one.u and one.u.place for one in found] == [None, None, 4, 4]
    assert read_as(found, ";", ",", True) == [
        "read as: cells parted by semicolons, decimal commas, 'Masse 1 (g)' as m1 in g, 'Masse (rechts)' as m2 in g,"
        " 'Zeit A (s)' as time in s, 'Zeit B (s)' as time in s, 'Fehler = 1σ' as u(time)."
    ]
    assert read_as(read_headings(["m1", "t"], RUNS), ",", ",", False) == ["read as: 't' as time."]
    assert read_as(read_headings(["m1", "a"], RUNS), ",", ",", False) == []


PASS = "; or let it pass by --label"
REFUSED = ["m1|m_1", "t1|time 1", "m1 (s)", "a|Team|±", "m1|a_err", "a|±|u(a)"]
"""Columns whose last could be two things; `cases/fit.md` has the sentences."""


@pytest.mark.parametrize("columns", REFUSED)
def test_a_column_that_is_refused_may_pass_as_a_label(columns: str) -> None:
    *others, last = columns.split("|")
    with pytest.raises(Unreadable, match=re.escape(f"{PASS} '{last}'")):
        read_headings([*others, last], RUNS)
    assert last not in [one.column for one in read_headings([*others, last], RUNS, [last])]


@pytest.mark.parametrize(
    ("column", "why"),
    [
        ("mu (g)", "must hold plain numbers, without the 'g'"),
        ("wrap (rad)", "has angles in radians; give degrees or turns"),
    ],
)
def test_units_of_scenes_that_are_refused(column: str, why: str) -> None:
    with pytest.raises(Unreadable) as raised:
        read_headings([column], SCENES)
    assert str(raised.value) == f"column {column!r} {why}{PASS} {column!r}"


def test_a_heading_is_looked_at_quickly() -> None:
    """The patterns took a minute for such a one."""
    for heading in (50_000 * "/" + "(", "m1 " + 50_000 * "(", 50_000 * "m1 in "):
        assert read_headings([heading], RUNS) == []


GRAMS = Heading(0, "m1 (g)", "m1", unit="g", factor=Fraction(1, 1000))


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
    ],
)
def test_cells_are_read_exactly(cell: str, comma: bool, value: str, uncertainty: str) -> None:
    read = read_cell(GRAMS, cell, comma)
    assert read is not None
    assert (read.value, read.uncertainty, read.given) == (Fraction(value), Fraction(uncertainty), cell)


@pytest.mark.parametrize("cell", ["", "  ", "NA", "NULL", "null"])
def test_cells_may_be_empty(cell: str) -> None:
    assert read_cell(GRAMS, cell, False) is None


@pytest.mark.parametrize(
    ("cell", "unit", "uncertainty"),
    [("2", "", "0.002"), ("± 2", "", "0.002"), ("2mg", "", "2e-6"), ("1%", "", "0.002"), ("1", "%", "0.002")],
)
def test_cells_of_uncertainties(cell: str, unit: str, uncertainty: str) -> None:
    assert read_uncertainty(GRAMS._replace(column="±", unit=unit), cell, Fraction("0.2"), False) == Fraction(
        uncertainty
    )


@pytest.mark.parametrize(
    ("cells", "separator", "decimal"),
    [
        ("1,5", ";", True),
        ("1,5", "\t", True),
        ("1,500", ";", True),
        ("1,500", "\t", False),
        ("1,5", ",", False),
        ("1.5", ";", False),
    ],
)
def test_commas_that_are_decimal(cells: str, separator: str, decimal: bool) -> None:
    assert decimal_commas_in([["x,y", cells]], [1], separator) is decimal
