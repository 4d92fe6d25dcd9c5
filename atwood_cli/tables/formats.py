"""Numbers as the cells of a workbook show them: by a number format of .xlsx, beside a text in .ods.

A number has up to 15 digits, and the unit that is shown. What is not wholly understood stands behind
`SHOWN_AS`, and is an error where a number is read: no part of a format is used while another is dropped.
"""

import re
from contextlib import suppress
from functools import lru_cache
from math import inf, isfinite

from ..reading.units import PERCENT, Malformed, read_number, symbol_of
from .cells import SHOWN_AS

DAY, HOUR = 86_400, 3600  # seconds
GENERAL = "General"
PLAIN = (GENERAL, "@")
"""The formats that show a number, or a text, as it is."""
BUILT_IN = {
    **{"0": GENERAL, "49": "@", "21": "h:mm:ss", "45": "mm:ss", "46": "[h]:mm:ss", "47": "mm:ss.0"},
    **dict.fromkeys(("1", "2", "3", "4", "11", "48"), "0") | dict.fromkeys(("9", "10"), "0%"),
    **dict.fromkeys(("37", "38", "39", "40"), "0_);(0)"),
}
"""The formats that every .xlsx has, by their numbers, but for the digits, and for dates."""
HALF = 0.5000001
"""Half a step of the last digit, and a little for doubles."""

_PADDING = r"_.|\* "
_LITERAL = rf'"[^"]*"|\\.|\[\$[^\]-]*(?:-[^\]]*)?\]|{_PADDING}|[^\w\s"\\;\[\]#?.,%@*]| '
"""What is shown as it stands: quoted, escaped, a currency, other signs; padding is a blank."""
_TEXT_OF = re.compile(r'"([^"]*)"|\\(.)|\[\$([^\]-]*)[^\]]*\]|[_*].|(.)', re.DOTALL)
_COLOUR = r"(?:\[(?i:black|blue|cyan|green|magenta|red|white|yellow|color ?\d+)\])*"
_CLOCK = r"(?i:(?:(?:\[h+\]|hh?):mm|\[m+\]|mm?):ss(?:\.0+)?)"
_NUMBER = r"(?i:general)|(?:[#0?]+(?:,[#0?]+)*)?(?:\.[#0?]*)?(?:[Ee][+-]0+)?"
_SECTION = re.compile(
    rf"{_COLOUR}((?:{_LITERAL})*)(?:({_CLOCK})|({_NUMBER}))((?:{_LITERAL})*)(%?)((?:{_LITERAL})*)",
    re.ASCII | re.DOTALL,
)
_AS_TEXT = re.compile(
    rf"(?:[^;@]*;){{0,2}}[^;@]*|(?:.*;)?{_COLOUR}(?:{_PADDING})*@(?:{_PADDING})*", re.DOTALL
)
"""The formats that show a text as it is: without a section for texts, or with one that adds nothing."""
_NOT_DIVIDED = re.compile(r'\[(?:[<>=]|[^\]]*;)|[\\_*][";]')
"""A condition on a section, a semicolon that ends none, or a quotation mark that quotes nothing."""
_SHOWN = re.compile(r"([+-]?)([0-9.,'’\s]*[0-9])[.,]?(?:[eE]([+-]?[0-9]{1,2}))?(?![0-9])(.*)", re.DOTALL)
_COUNT = r"([0-9]+(?:\.[0-9]*)?)"
_DURATION = re.compile(rf"(-?)P(?:{_COUNT}D)?(?:T(?:{_COUNT}H)?(?:{_COUNT}M)?(?:{_COUNT}S)?)?")


@lru_cache(1024)
def _rule_for(order: int, code: str) -> tuple[int, str, float] | None:
    """Return how a format shows numbers above 0 (1), 0, or below (-1): times a factor, with a unit.

    A clock shows them up to so many seconds. None if it is not wholly understood, or may show nothing.
    No format with a semicolon that ends no section is understood.
    """
    sections = code.split(";")
    has_own = len(sections) > 1 and order < 0
    match = _SECTION.fullmatch(sections[1 if has_own else 2 if len(sections) > 2 and order == 0 else 0])
    is_divided = not any(section.count('"') % 2 for section in sections)
    if not (match and is_divided) or _NOT_DIVIDED.search(code):
        return None
    before, clock, number, literals, percent, after = match.groups(default="")
    unit = (_text_of(literals) + percent + _text_of(after)).rstrip()
    signs = ["-"] if has_own else [""] if order < 0 else ["", "+"]
    if _text_of(before).strip() not in signs:
        return None
    if not is_shown_unit(unit) or (percent and unit.lstrip() != PERCENT):
        return None
    if clock:
        turn = inf if "[" in clock else DAY if clock[0] in "hH" else HOUR
        return None if unit else (1, "", turn)
    shows_zero = "0" in re.split("[Ee][+-]", number)[0] or number.lower() == "general"
    return (100 if percent else 1, unit, 0) if shows_zero else None


def _text_of(literals: str) -> str:
    return _TEXT_OF.sub(lambda m: m[1] or m[2] or m[3] or m[4] or (" " if m[0][0] in "_*" else ""), literals)


@lru_cache(1024)
def is_shown_unit(text: str) -> bool:
    """Decide whether what is shown behind a number is nothing, a unit, or percent."""
    return text.strip() in ("", PERCENT) or bool(symbol_of(text.strip()))


def shown_number(stored: str, code: str) -> str:
    """Return a number as its format shows it: in percent, with a unit, as a duration in seconds."""
    value = _finite(stored)
    if code in PLAIN:
        return f"{value + 0.0:.15g}"
    if rule := _rule_for((value > 0) - (value < 0), code):
        factor, unit, turn = rule
        if not turn:
            return f"{value * factor + 0.0:.15g}{unit}"
        if 0 <= (seconds := round(value * DAY, 6)) < turn:
            return f"{seconds:.15g} s"
    return refused(f"{value:.15g}", code)


def shown_text(text: str, code: str) -> str:
    """Return a text, with its format if that shows more than the text or less."""
    return text if not text or _AS_TEXT.fullmatch(code) else refused(text, code)


def refused(value: str, way: str) -> str:
    """Return a cell that is no number, with the way it is shown, for the error."""
    return f"{value}{SHOWN_AS}{way}"


def agreed(value: str, shown: str, in_percent: bool) -> str:
    """Return a number with its unit, if it is what is shown up to rounding; else as an error."""
    number = _finite(value) * (100 if in_percent else 1)
    if not shown or (shown == value and not in_percent):
        return f"{number + 0.0:.15g}{PERCENT if in_percent else ''}"
    if not (match := _SHOWN.fullmatch(shown.replace("−", "-"))):
        return shown
    sign, digits, power, unit = match.groups(default="")
    for mark in ".," if is_shown_unit(unit) else "":
        whole, *decimals = re.sub(f"[^0-9{mark}]", "", digits).split(mark)
        shown_value = float(f"{sign}{whole}.{''.join(decimals)}e{power or 0}")
        step = 10.0 ** (int(power or 0) - sum(map(len, decimals)))
        if not decimals[1:] and abs(number - shown_value) <= step * HALF:
            return f"{number + 0.0:.15g}{unit.rstrip()}"
    return refused(value, shown)


def duration(value: str, shown: str) -> str:
    """Return a duration, as PT1H2M3.5S, in seconds, if a clock that is shown agrees with it."""
    match, clock = _DURATION.fullmatch(value), shown.replace(",", ".")
    with suppress(Malformed):
        if match and any(match.groups()[1:]):
            days, hours, minutes, seconds = (float(count or 0) for count in match.groups()[1:])
            total = _finite(f"{match[1]}{((days * 24 + hours) * 60 + minutes) * 60 + seconds}")
            step = 10.0 ** -len(clock.partition(".")[2])
            if not re.search("[0-9]", clock) or abs(read_number(clock, "time").number - total) < step:
                return f"{total:.15g} s"
    return refused(value, shown or "a time")


def _finite(value: str) -> float:
    """Return a number that a workbook stores. Raises ValueError."""
    if not isfinite(number := float(value)):
        raise ValueError
    return number
