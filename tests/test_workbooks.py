"""Workbooks: a cell counts as what it shows, or is refused; what an archive may hold; what is hostile."""

import csv
import re
from collections.abc import Mapping
from decimal import ROUND_HALF_UP, Decimal
from io import BytesIO, StringIO
from itertools import count
from typing import Any
from zipfile import ZIP_DEFLATED, ZIP_LZMA, ZipFile

import pytest
from hypothesis import given
from hypothesis import strategies as st

from atwood_cli.tables import packages
from atwood_cli.tables.formats import shown_number
from atwood_cli.tables.sources import Unreadable
from atwood_cli.tables.workbooks import workbook_as_csv

from .conftest import examples
from .test_tables import exactly, numbers, read
from .tools.running import Batch

__all__ = ["read"]  # a fixture


def workbook(parts: dict[str, str], packed: int = ZIP_DEFLATED) -> bytes:
    """An archive of these parts."""
    with ZipFile(content := BytesIO(), "w", packed) as archive:
        for name, part in parts.items():
            archive.writestr(name, part)
    return content.getvalue()


ROOT = "<a xmlns:r='R' xmlns:table='T' xmlns:office='urn:office:1.0' xmlns:text='X' xmlns:calcext='C'>%s</a>"
XLSX = {
    "xl/workbook.xml": ROOT % "<sheet name='Old' state='hidden' r:id='a'/><sheet name='Lab' r:id='b'/>",
    "xl/_rels/workbook.xml.rels": ROOT % "<x Id='a' Target='s.xml'/><x Id='b' Target='/xl/t.xml'/><x Id='c' Type='x/styles' Target='styles.xml'/><x Id='d' Type='x/sharedStrings' Target='sharedStrings.xml'/>",
    "xl/styles.xml": ROOT % """<numFmt numFmtId='170' formatCode='0.0" g"'/><cellXfs><xf numFmtId='0'/><xf numFmtId='45'/><xf numFmtId='14'/><xf numFmtId='170'/><xf numFmtId='10'/></cellXfs>""",
    "xl/sharedStrings.xml": ROOT % "<si><t>Lab 3</t></si><si><r><t>m</t></r><r><t>1</t></r><rPh><t>x</t></rPh></si>",
    "xl/s.xml": ROOT % "",
    "xl/t.xml": ROOT % "<row><c r='A1' t='s'><v>0</v></c></row><row><c r='A2' t='s'><v>1</v></c><c r='B2' t='inlineStr'><is><t>m2</t></is></c><c r='C2' t='str'><v>t (s)</v></c><c r='D2' t='str'><v>u(t)</v></c></row><row><c r='A3' s='3'><f>1+1</f><v>200.09999999999999</v></c><c r='B3'><v>0.21</v></c><c r='C3' s='1'><v>4.6180555555555553E-5</v></c><c r='D3' s='4'><v>0.02</v></c></row><row><c r='B4'><v>0.22</v></c><c r='C4'><v>3</v></c><c r='D4'><v>0.1</v></c></row><mergeCells><mergeCell ref='A3:A4'/></mergeCells>",
}  # fmt: skip
ODS = {
    "content.xml": ROOT % "<style table:name='h'><table-properties table:display='false'/></style><table:table table:name='Old' table:style-name='h'/><table:table table:name='Lab'><table:table-row><table:table-cell><text:p>Lab 3</text:p></table:table-cell><table:table-cell table:number-columns-repeated='16000'/></table:table-row><table:table-row><table:table-cell><text:p>m1</text:p></table:table-cell><table:table-cell><text:p>m2</text:p></table:table-cell><table:table-cell><text:p>t (s)</text:p></table:table-cell><table:table-cell><text:p>u(t)</text:p></table:table-cell></table:table-row><table:table-row><table:table-cell table:number-rows-spanned='2' office:value-type='float' office:value='200.1'><text:p>200,1 g</text:p></table:table-cell><table:table-cell office:value-type='float' office:value='0.21'/><table:table-cell office:value-type='time' office:time-value='PT00H00M03.99S'/><table:table-cell office:value-type='percentage' office:value='0.02'/></table:table-row><table:table-row><table:covered-table-cell/><table:table-cell office:value-type='float' office:value='0.22'/><table:table-cell office:value-type='float' office:value='3'/><table:table-cell office:value-type='float' office:value='0.1'/></table:table-row><table:table-row table:number-rows-repeated='1048000'><table:table-cell table:number-columns-repeated='16384'/></table:table-row></table:table>",
}  # fmt: skip


@pytest.mark.parametrize(("name", "parts"), [("runs.xlsx", XLSX), ("runs.ods", ODS)])
def test_a_workbook_is_its_first_sheet_as_shown(read: Any, name: str, parts: dict[str, str]) -> None:
    """A formula has its stored value, a merged cell counts in all rows, a clock, a percentage and a unit are read."""
    runs = read(workbook(parts), name)
    assert numbers(runs) == exactly("0.2001 0.21 3.99 0 0 0.0798", "0.2001 0.22 3 0 0 0.1")
    assert "sheet 'Lab' of 'Old' (hidden), 'Lab'" in runs.remarks[0]
    main = "xl/t.xml" if "xlsx" in name else "content.xml"
    dates = {"<c r='B3'><v>0.21</v>": "<c r='B3' s='2'><v>45000</v>", "office:value='0.21'": "office:date-value='2026-03-05'"}  # fmt: skip
    errors = {"<v>0.21</v>": "<f>A3</f>", "<c r='B3'><v>0.21": "<c r='B3' t='e'><v>#DIV/0!"}
    for old, new in (dates | errors).items():
        part = parts[main].replace(old, new).replace("float' office:date", "date' office:date")
        if part != parts[main]:
            with pytest.raises(
                Unreadable, match=r"row 1: m2 '.*' is (not a number|shown as '(a date|format 14 of Excel)')"
            ):
                read(workbook(parts | {main: part}), name)


def test_sheets_by_name(batch: Batch, read: Any) -> None:
    ran = batch(workbook(ODS), "--only a --sheet Las", "in.ods")
    assert ran.err == "atwood: cannot read IN: there is no sheet 'Las'; there are 'Old' (hidden), 'Lab'\n"
    ran = batch(workbook(ODS), "--only a --sheet Old", "in.ods")
    assert ran.err == "atwood: cannot read IN: sheet 'Old' of 'Old' (hidden), 'Lab' is empty\n"
    notes = workbook({"content.xml": ODS["content.xml"].replace(">m1<", ">Notes<")})
    assert (
        "m1 (0 if nothing hangs there) is missing; sheet 'Lab' of 'Old' (hidden), 'Lab'\n\n"
        in batch(notes, "", "in.ods").err
    )
    with pytest.raises(Unreadable, match=r"m1 .* is missing; sheet 'Lab' of 'Old' "):
        read(notes, "runs.ods")
    plain = ODS["content.xml"].replace("<text:p>Lab 3</text:p>", "")
    ran = batch(workbook({"content.xml": plain}), "--only a --digits 3 --sheet Lab", "in.ods")
    assert ran.out.splitlines()[1:] == ["200.1 g,0.21,3.99 s,2%,0.237,", "200.1 g,0.22,3,0.1,0.465,"]


# What is shown


LINKS = "<R><Relationship Id='a' Type='x/worksheet' Target='%s'/><Relationship Id='b' Type='x/sharedStrings' Target='%s'/><Relationship Id='c' Type='x/styles' Target='styles.xml'/></R>"  # fmt: skip


def xlsx(cells: str, code: str = "General", parts: Mapping[str, str] = {}, after: str = "") -> bytes:
    """A workbook of one sheet, whose cells of style 1 have a number format."""
    code = code.replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")
    usual = {
        "_rels/.rels": "<R><Relationship Id='d' Type='x/officeDocument' Target='xl/workbook.xml'/></R>",
        "xl/workbook.xml": "<w xmlns:r='R'><sheets><sheet name='Lab' r:id='a'/></sheets></w>",
        "xl/_rels/workbook.xml.rels": LINKS % ("w/s.xml", "sharedStrings.xml"),
        "xl/styles.xml": f"<s><numFmts><numFmt numFmtId='200' formatCode=\"{code}\"/></numFmts>"
        "<cellStyleXfs><xf numFmtId='9'/></cellStyleXfs><cellXfs><xf/><xf numFmtId='200'/></cellXfs></s>",
        "xl/w/s.xml": f"<worksheet><sheetData>{cells}</sheetData>{after}</worksheet>",
    }
    return workbook({name: part for name, part in {**usual, **parts}.items() if part})


def ods(cells: str, before: str = "") -> bytes:
    """A workbook of one sheet with one row."""
    line = f"<table:table-row>{cells}</table:table-row>" if "table-row" not in cells else cells
    return workbook({"content.xml": f"<d>{before}<table:table table:name='Lab'>{line}</table:table></d>"})


def text_of(content: bytes) -> str:
    """The cells of the first sheet, with a bar between them."""
    table = workbook_as_csv(BytesIO(content), None)[0].decode()
    return "\n".join("|".join(row) for row in csv.reader(StringIO(table, newline="")))


@pytest.mark.parametrize(
    ("code", "stored", "shown"),
    [
        (r"0.00\ \l\b", "3.25", "3.25 lb"),
        (r"#,##0\ \m\N", "1500", "1500 mN"),
        ('0.000,"kg"', "200", None),
        ("#,##0.0,,", "1234567.5", None),
        ('0.0" g"_)', "12.5", "12.5 g"),
        ('[Blue]0.0* "oz"_-', "3", "3 oz"),
        ("0[$ kN-809]", "4", "4 kN"),
        ('[>=1000]0.0,"kg";0"g"', "1500", None),
        ("[color 12]0.0_s", "0.5", "0.5"),
        ("[Red]0.0", "0.5", "0.5"),
        ('0.0" g";-0.0" kg"', "-3", "-3 kg"),
        ('0.0" g";-0.0" kg"', "3", "3 g"),
        ("0.0;[Red]0.0", "-3", None),
        ("0.0;(0.0)", "-3", None),
        ("+0.0;-0.0;0", "2", "2"),
        ("0.0;-0.0;;@", "0", None),
        ("#.##", "0", None),
        ("#,##0.##", "0.25", "0.25"),
        ("0.0%", "0.021", "2.1%"),
        ('0"%"', "2", "2%"),
        ("0%%", "2", None),
        ("0.00E+00", "0.00025", "0.00025"),
        ("# ?/?", "0.25", None),
        ('"ca. "0.0', "2", None),
        ('0.0" Stück"', "2", None),
        ('0"0"', "2", None),
        ('0.0"', "2", None),
        ("[$$-409]0.00", "2", None),
        ("0 kg", "2", None),
        ("@", "2.5", "2.5"),
        ("mm:ss.00", "4.6180555555555553E-5", "3.99 s"),
        ("[h]:mm:ss", "1.25", "108000 s"),
        ("h:mm:ss", "1.25", None),
        ("[mm]:ss.0", "-0.5", None),
        ("[ss].00", "0.001", None),
        ("h:mm", "0.25", None),
        ("yyyy-mm-dd", "45000", None),
    ],
)
def test_a_number_is_what_its_format_shows_or_is_refused(code: str, stored: str, shown: str | None) -> None:
    cell = f"<row><c s='1'><v>{stored}</v></c></row>"
    want = f"{stored} shown as {code}" if shown is None else shown
    assert text_of(xlsx(cell, code)) == want


def test_a_refused_cell_is_named_with_its_format(batch: Batch) -> None:
    cells = "<row><c t='str'><v>m1</v></c><c t='str'><v>m2</v></c></row>%s"
    ran = batch(
        xlsx(cells % "<row><c s='1'><v>2</v></c><c><v>3</v></c></row>", '0" Stück"'), "--only a", "b.xlsx"
    )
    assert (
        "first error, in row 1: m1 '2' is shown as '0\" Stück\"'; write a plain number, and its unit in the heading"
        in ran.err
    )


@pytest.mark.parametrize(
    ("cell", "shown"),
    [
        ("<c t='str' s='1'><f>B9</f><v></v></c><c><v>1</v></c>", "|1"),
        ("<c s='1'><f>B9</f><v></v></c><c><f>B8</f></c>", "=B9|=B8"),
        ("<c t='e'><f>1/0</f><v>#DIV/0!</v></c><c t='b'><v>1</v></c>", "#DIV/0!|TRUE"),
        ("<c t='d'><v>2026-03-05</v></c><c t='inlineStr'><is><t>a_x000D_\nb_x005F_x</t></is></c>", "2026-03-05 shown as a date|a\nb_x"),
        ("<c t='str' s='1'><v>2.5</v></c>", '2.5 shown as 0;0;0;@" kg"'),
    ],
)  # fmt: skip
def test_other_cells_of_xlsx(cell: str, shown: str) -> None:
    assert text_of(xlsx(f"<row>{cell}</row>", '0;0;0;@" kg"')) == shown


FLOAT = "<table:table-cell office:value-type='%s' office:value='%s'><text:p>%s</text:p></table:table-cell>"
TIME = (
    "<table:table-cell office:value-type='time' office:time-value='%s'><text:p>%s</text:p></table:table-cell>"
)


@pytest.mark.parametrize(
    ("cell", "shown"),
    [
        (FLOAT % ("float", "1234.5678", "1 234,57 g"), "1234.5678 g"),
        (FLOAT % ("float", "1234.5678", "1,234.57"), "1234.5678"),
        (FLOAT % ("float", "-2500", "−2,500"), "-2500"),
        (FLOAT % ("float", "0.00025", "2.50E-04"), "0.00025"),
        (FLOAT % ("float", "1500", "1.5 kN"), "1500 shown as 1.5 kN"),
        (FLOAT % ("float", "1500", "1500 Stück"), "1500 shown as 1500 Stück"),
        (FLOAT % ("float", "0", "#N/A"), "#N/A"),
        (FLOAT % ("float", "0", "Err:502"), "Err:502"),
        (FLOAT % ("percentage", "0.021", "2 %"), "2.1 %"),
        (FLOAT % ("percentage", "0.021", ""), "2.1%"),
        (FLOAT % ("float", "2", "2%"), "2%"),
        (FLOAT % ("currency", "2", ""), "2"),
        (TIME % ("PT1H2M3.5S", "01:02:03,5"), "3723.5 s"),
        (TIME % ("-PT90S", ""), "-90 s"),
        (TIME % ("P1DT2H", ""), "93600 s"),
        (TIME % ("PT26H", "02:00:00"), "PT26H shown as 02:00:00"),
        (TIME % ("P1M", ""), "P1M shown as a time"),
        ("<table:table-cell office:value-type='string' office:string-value='m1'/>", "m1"),
        ("<table:table-cell><text:p>a<text:s text:c='2'/>b<text:tab/>c<text:line-break/>d</text:p></table:table-cell>", "a b\tc\nd"),
        ("<table:table-cell office:value-type='boolean' office:boolean-value='true'/>", "TRUE"),
        ("<table:table-cell table:formula='of:=[.B9]'/>", "=of:=[.B9]"),
        ("<table:table-cell table:formula='of:=[.B9]' office:value-type='string' office:string-value=''/><table:table-cell><text:p>x</text:p></table:table-cell>", "|x"),
        ("<table:table-cell office:value-type='date' office:date-value='2026-03-05'><text:p>5.3.</text:p></table:table-cell>", "2026-03-05 shown as a date"),
        ("<table:table-cell><office:annotation><text:p>note</text:p></office:annotation><text:p>x</text:p></table:table-cell>", "x"),
    ],
)  # fmt: skip
def test_cells_of_ods(cell: str, shown: str) -> None:
    """The shown text and the stored value agree up to rounding, or the cell is refused."""
    assert text_of(ods(cell)) == shown


# What any format shows, by its parts

LITERALS = {
    '" g"': " g", '"kg"': "kg", r"\k\g": "kg", r"\ \k": " k", '"g"': "g", "_)": " ", "* ": " ", "[$ N]": " N",
    "[$-409]": "", " ": " ", '"0"': "0", '"1"': "1", "(": "(", ")": ")", "-": "-", "+": "+", r"\-": "-", '"e3"': "e3",
    '"%"': "%", "%": "%", '"/2"': "/2", "±": "±", "°": "°", r"\;": ";", "_;": " ", '";"': ";", "[$;]": ";", '\\"': '"',
}  # fmt: skip
"""What stands around the digits of a format, and its text."""
DIGITS = "0 0.0 0.00 # #.## #,##0 #,##0.0 0, 0.0, 0,, 0,.0 .00 ?.?? 00 0.0#".split()
LITERAL = st.sampled_from([*LITERALS])
SECTION = st.tuples(
    st.sampled_from(["", "", "[Red]", "[magenta]", "[Color 3]"]),
    st.lists(LITERAL, max_size=1),
    st.sampled_from(DIGITS),
    st.lists(LITERAL, max_size=3),
)


def digits_of(size: Decimal, code: str) -> str:
    """The digits that a section shows."""
    whole, point, decimals = code.partition(".")
    size /= 1000 ** (len(whole + decimals) - len(whole.rstrip(",") + (decimals := decimals.rstrip(","))))
    before, _, after = f"{size.quantize(Decimal(1).scaleb(-len(decimals)), ROUND_HALF_UP):f}".partition(".")
    least = len(decimals.rstrip("#?"))
    return before.lstrip("0").rjust(whole.count("0"), "0") + point + after[:least] + after[least:].rstrip("0")


@given(sections=st.lists(SECTION, min_size=1, max_size=3), number=st.decimals(-9999, 99999, places=4))
@examples(2000)
def test_no_number_but_the_shown_one(sections: Any, number: Decimal) -> None:
    """Where a format is understood, it shows the same sign, digits up to rounding, and unit."""
    code = ";".join("".join([colour, *head, digits, *tail]) for colour, head, digits, tail in sections)
    got = shown_number(str(number), code)
    if "shown as" in got:
        return
    has_own = number < 0 and len(sections) > 1
    _, head, digits, tail = sections[1 if has_own else 2 if number == 0 and len(sections) > 2 else 0]
    around = ["".join(map(LITERALS.__getitem__, some)) for some in (head, tail)]
    size = abs(number) * 100 ** [*head, *tail].count("%")
    shown = f"{'-' * (number < 0 and not has_own)}{digits_of(size, digits).join(around)}"
    ours = re.fullmatch(r"(-?\d+(?:\.\d+)?(?:e-?\d+)?)(.*)", got)
    theirs = re.fullmatch(r"\s*([-+]?)\s*(\d*\.?\d*)(.*)", shown)
    assert ours
    assert theirs
    assert theirs[2].strip("."), (shown, got)
    value = Decimal(theirs[2]).copy_sign(-1 if theirs[1] == "-" else 1)
    step = Decimal(1).scaleb(-len(theirs[2].partition(".")[2]))
    assert abs(Decimal(ours[1]) - value) <= step / 2 + Decimal("1e-9") * abs(value), (shown, got)
    assert ours[2].strip() == theirs[3].strip(), (shown, got)


@pytest.mark.parametrize("code", [r'0\;-0" kg"', "0_;-0", '0";";0', "0[$;];0", "[<0]-0", '[<1]0;-0" kg"'])
def test_a_semicolon_or_a_condition_divides_no_section_by_halves(code: str) -> None:
    """Of the first, -5 was -5 kg, though it has one section."""
    assert shown_number("-5", code) == f"-5 shown as {code}"


# Sheets and packages


def test_what_lies_under_a_merged_cell_does_not_count() -> None:
    cells = "<row><c><v>1</v></c><c><v>2</v></c><c><v>3</v></c></row>" + "<row><c><v>7</v></c><c><v>8</v></c><c><v>9</v></c></row>" * 2  # fmt: skip
    merged = "<mergeCells><mergeCell ref='A1:A2'/><mergeCell ref='B1:C3'/><mergeCell ref='A3'/></mergeCells>"
    assert text_of(xlsx(cells, after=merged)) == "1|2\n7|2"
    one = "<table:table-row><table:table-cell table:number-columns-spanned='2'><text:p>1</text:p></table:table-cell><table:covered-table-cell><text:p>2</text:p></table:covered-table-cell><table:table-cell><text:p>3</text:p></table:table-cell></table:table-row>"  # fmt: skip
    assert text_of(ods(one)) == "1||3"


def test_hidden_rows_and_columns_are_read_and_named(read: Any) -> None:
    cells = "<row r='2'><c t='str'><v>m1</v></c><c t='str'><v>m2</v></c><c t='str'><v>t</v></c></row><row r='3' hidden='1'><c><v>1</v></c><c><v>2</v></c><c><v>3</v></c></row><row r='9' hidden='1'/>"  # fmt: skip
    content = xlsx(f"</sheetData><cols><col min='2' max='2' hidden='true'/></cols><sheetData>{cells}")
    runs = read(content, "runs.xlsx")
    assert numbers(runs) == exactly("1 2 3 0 0 0")
    assert "1 hidden row and 1 hidden column, too" in runs.remarks[0]
    line = "<table:table-row table:visibility='filter' table:number-rows-repeated='2'><table:table-cell><text:p>a</text:p></table:table-cell></table:table-row>"  # fmt: skip
    columns = "<table:table-column/><table:table-column table:visibility='collapse'/>"
    assert workbook_as_csv(BytesIO(ods(columns + line)), None) == (b"a\na\n", ["2 hidden rows, too"])


STRINGS = "<sst><si><t>x</t></si><si><r><t>y</t></r><rPh><t>z</t></rPh></si></sst>"
CELL = "<row><c t='s'><v>1</v></c></row>"


@pytest.mark.parametrize(
    ("cells", "parts", "shown"),
    [
        ("<row><c><v>5</v></c><c r='D1'><v>6</v></c><c><v>7</v></c></row><row r='4'><c><v>8</v></c></row>", {}, "5|||6|7\n8||||"),
        ("<row><c r='B7'><v>5</v></c></row><row><c><v>6</v></c></row>", {}, "|5\n6|"),
        (CELL, {"xl/sharedStrings.xml": STRINGS}, "y"),
        (CELL, {"xl/sharedStrings.xml": STRINGS, "xl/styles.xml": ""}, "y"),
        (CELL, {"xl/_rels/workbook.xml.rels": LINKS % ("./W/../w/S.xml", "/else/Texts.xml"), "else/texts.xml": STRINGS}, "y"),
        ("<row><c t='inlineStr' s='3'><is><t>y</t></is></c></row>", {"xl/styles.xml": ""}, "y"),
    ],
    ids=count(),
)  # fmt: skip
def test_valid_packages(cells: str, parts: dict[str, str], shown: str) -> None:
    """Places may be lacking; parts are found by the links between them, in letters of any size."""
    assert text_of(xlsx(cells, parts=parts)) == shown


def test_the_workbook_may_have_another_name_and_charts() -> None:
    book = (
        "<w xmlns:r='R'><x:sheets><x:sheet name='C' r:id='c'/><x:sheet name='Lab' r:id='a'/></x:sheets></w>"
    )
    links = "<R><Relationship Id='a' Type='x/worksheet' Target='../xl/w/s.xml'/><Relationship Id='c' Type='x/chartsheet' Target='c.xml'/></R>"  # fmt: skip
    root = "<R><Relationship Id='d' Type='x/officeDocument' Target='/office/book.xml'/></R>"
    parts = {"_rels/.rels": root, "office/book.xml": book, "office/_rels/book.xml.rels": links, "xl/workbook.xml": ""}  # fmt: skip
    content = xlsx("<x:row><x:c><x:v>5</x:v></x:c></x:row>", parts=parts)
    assert workbook_as_csv(BytesIO(content), None) == (b"5\n", [])


DAMAGED = "it is damaged, has a password, or is no workbook"
TOO_LARGE = "it has too many or too long cells for a workbook; save the sheet as CSV"
REFUSED = [
    (xlsx("<row><c t='s'><v>9</v></c></row>"), DAMAGED),
    (xlsx("<row><c t='s'><v>-1</v></c></row>", parts={"xl/sharedStrings.xml": STRINGS}), DAMAGED),
    (xlsx("<row><c s='9'><v>1</v></c></row>"), DAMAGED),
    (xlsx("<row><c><v>1e999</v></c></row>"), DAMAGED),
    (xlsx("<row><c><v>x</v></c></row>"), DAMAGED),
    (xlsx("<row><c r='1A'><v>1</v></c></row>"), DAMAGED),
    (xlsx("<row><c>"), DAMAGED),
    (xlsx("", parts={"xl/w/s.xml": ""}), DAMAGED),
    (workbook({"content.xml": "<a>&b;</a>"}), DAMAGED),
    (workbook({"content.xml": "<!DOCTYPE x><a/>"}), DAMAGED),
    (workbook(ODS)[:-30], DAMAGED),
    (re.sub(rb"(PK\x01\x02.{12})....", rb"\g<1>wrng", workbook(ODS), count=1, flags=re.DOTALL), DAMAGED),
    (re.sub(rb"(PK(?:\x03\x04|\x01\x02..)..)\x00", b"\\1\x01", workbook(ODS), flags=re.DOTALL), DAMAGED),  # has a password
    (workbook(ODS)[:60] + b"x" * 400, DAMAGED),
    (b"PK\x03\x04", DAMAGED),
    (b"", DAMAGED),
    (workbook(ODS, ZIP_LZMA), DAMAGED),  # unpacks any number of bytes at once; a damaged one ended in a traceback
    (workbook({"content.xml": "<a/>", "big": "0" * (65 << 20)}), "it has no sheet"),
    (workbook({"content.xml": ODS["content.xml"].replace("<table:covered-table-cell/>", "<table:table-cell table:number-columns-repeated='9000000'><text:p>1</text:p></table:table-cell>")}), TOO_LARGE),
    (workbook(XLSX | {"xl/t.xml": ROOT % "".join(f"<row><c r='XFD{i}'><v>1</v></c></row>" for i in range(1, 900))}), TOO_LARGE),
]  # fmt: skip


@pytest.mark.parametrize(("content", "why"), REFUSED, ids=count())
def test_workbooks_that_are_refused(content: bytes, why: str) -> None:
    """No sentence has the words of Python."""
    with pytest.raises(Unreadable, match=f"^{why}$"):
        text_of(content)


LONG = "x" * 1000
WIDE = "<table:table-row table:number-rows-repeated='%s'><table:table-cell table:number-columns-repeated='%s'><text:p>%s</text:p></table:table-cell></table:table-row>"  # fmt: skip
OVERLAP = "<mergeCells><mergeCell ref='A1:B9'/><mergeCell ref='B1:B9'/></mergeCells>"
HOSTILE = [
    (xlsx("<row>" + "<a>" * 200), TOO_LARGE),
    (xlsx(f"<row>{'<c/>' * 6000}</row>"), TOO_LARGE),
    (xlsx(("<c " + " ".join(f"a{i}=''" for i in range(6000)) + "/>") * 5), TOO_LARGE),
    (xlsx("<!--" + LONG * 300), "a cell of xl/w/s.xml is longer than 1 MB"),
    (xlsx(f"<row><c><v>{LONG * 300}</v></c></row>"), "a cell of xl/w/s.xml is longer than 1 MB"),
    (xlsx(f"<row><c><f>{LONG * 30}</f></c></row>" * 30), TOO_LARGE),
    (xlsx(f"<row><c t='str'><v>{LONG}</v></c></row>" * 300), TOO_LARGE),
    (xlsx(CELL * 300, parts={"xl/sharedStrings.xml": STRINGS.replace("y", LONG)}), TOO_LARGE),
    (xlsx(CELL, parts={"xl/sharedStrings.xml": "<sst>" + "<si/>" * 6000}), TOO_LARGE),
    (ods(WIDE % (300, 1, LONG)), TOO_LARGE),
    (ods(WIDE % (10**30, 1, "x")), TOO_LARGE),
    (ods(WIDE % (1, 10**30, "x")), TOO_LARGE),
    (xlsx("<row><c><v>1</v></c><c><v>2</v></c></row>" * 9, after=OVERLAP * 300), TOO_LARGE),
]  # fmt: skip


@pytest.mark.parametrize(("content", "why"), HOSTILE, ids=count())
def test_hostile_workbooks_end_with_a_sentence(
    content: bytes, why: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The bounds are less here, so that the test is quick."""
    for name, most in (("MOST", 5000), ("LONGEST_RECORD", 100_000)):
        monkeypatch.setattr(packages, name, most)
    with pytest.raises(Unreadable, match=why):
        text_of(content)


def test_an_error_in_the_first_column_is_no_comment(read: Any) -> None:
    head = "<row><c t='str'><v>m1</v></c><c t='str'><v>m2</v></c><c t='str'><v>t</v></c></row>"
    cells = head + "<row><c t='e'><v>#DIV/0!</v></c><c><v>2</v></c><c><v>3</v></c></row>"
    with pytest.raises(Unreadable, match="row 1: m1 '#DIV/0!' is not a number"):
        read(xlsx(cells), "runs.xlsx")


def test_many_sheets_are_named_in_part() -> None:
    tables = "".join(f"<table:table table:name='S{i}'/>" for i in range(200))
    with pytest.raises(Unreadable, match=r"there are 'S0', .*\.\.\..{10}$"):
        workbook_as_csv(BytesIO(workbook({"content.xml": f"<d>{tables}</d>"})), "S")
