"""Quotation marks of CSV: the patterns that check them against a plain automaton, on any Python."""

import csv
from io import StringIO

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from atwood_cli.batch.csv_quotes import checked, each, first_end
from atwood_cli.files import Unreadable

texts = st.text(st.sampled_from('""",,\n\r\nax'), max_size=16)


def is_well_formed(text: str) -> bool:
    """A mark opens a cell only where one begins, and closes it only where one ends; within it is doubled."""
    state = "begin"
    for i, character in enumerate([*text, ""]):
        if state == "quoted":
            state = "closed" if character == '"' else state if character else "open"
        elif state == "closed" and character == '"':
            state = "quoted"
        elif character == '"':
            if state != "begin":
                return False
            state = "quoted"
        elif state == "closed" and character == "\r":
            if text[i + 1 : i + 2] not in ("\n", ""):
                return False
            state = "bare"
        elif character in (",", "\n"):
            state = "begin"
        elif state == "closed" and character:
            return False
        elif character:
            state = "bare"
    return state != "open"


@given(texts)
@example('1,3,"p"q\n')
@example('1,3,"x\ny')
@example('"a""b",c\n')
@example('"a""b"c\n')
@example('x","y\n')
def test_marks_out_of_place_are_found(text: str) -> None:
    """Python before 3.11.5 found none of them: its possessive quantifiers were wrong over groups."""
    if is_well_formed(text):
        assert checked(text.encode(), ",", 1).decode().count("\n") == text.count("\n")
    else:
        with pytest.raises(Unreadable):
            checked(text.encode(), ",", 1)


@given(texts.filter(is_well_formed))
@example('a\n"x\ny"')  # a last row without a line end was cut within its marks
def test_each_is_a_whole_row(text: str) -> None:
    rows = [row.decode() for row in each(text.encode())]
    assert "".join(rows) == text
    assert all(row and row.count('"') % 2 == 0 for row in rows)
    read = [len(list(csv.reader(StringIO(row, newline=""), strict=True))) for row in rows if "\r" not in text]
    assert max(read, default=0) <= 1
    first = first_end(text.encode())
    assert text[:first].count('"') % 2 == 0
    assert first == len(text) or text[first - 1] == "\n"
