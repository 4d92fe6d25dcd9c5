"""Results as text, for which rich is not needed: cells, JSON, CSV, sentences on stderr."""

import json
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from decimal import Decimal
from fractions import Fraction
from math import inf
from typing import Any, NamedTuple, TextIO

from ..arithmetic.rounding import Rounding, as_typed, exact_or_rounded, is_infinite, text, to_double
from ..files import Stdout, printable
from ..model.angle import Angle
from ..model.axle import Axle
from ..model.scene import MEASURED, UNMEASURED, Motion, Scene, stated

SPELLED = "mu u phi beta pi tau alpha theta chi 1 2 ^2 deg * +/- <= >= ~ sqrt"
ASCII = str.maketrans(dict(zip("μµφβπταθχ₁₂²°·±≤≥≈√", SPELLED.split(), strict=True)))


def for_stream(words: str, stream: TextIO | None) -> str:
    """The words as the stream can take them, a terminal too: what is read or typed does not steer it."""
    return spelled(printable(words), stream)


def spelled(words: str, stream: TextIO | None) -> str:
    """The words with their symbols spelled out where the stream is not Unicode."""
    return words if takes_unicode(stream) else words.translate(ASCII).encode("ascii", "replace").decode()


def takes_unicode(stream: TextIO | None) -> bool:
    """Whether symbols can be written to the stream."""
    encoding = getattr(stream, "encoding", None) or "ascii"
    return encoding.lower().startswith("utf")


def say(*messages: str) -> None:
    """Each message on stderr, as the program's, a line."""
    for message in messages:
        line = for_stream(f"atwood: {printable(message, keep='')}", sys.stderr)
        if sys.stderr.isatty():
            from shutil import get_terminal_size

            line = "\n".join(wrapped(line, get_terminal_size().columns))
        with suppress(OSError):  # there is nobody else to tell
            print(line, file=sys.stderr)


UNITS = r"kg|g|m/s²|rad/s²|m/s\^2|m|[mnµ]?s|m?Nm?|ulp"
BESIDE = rf"(?<=[\d)]) (?=(?:{UNITS})\b)|(?<=\bN) (?=m\b)|(?<=\bkg) (?=m[²^])"
"""The blank between a number and its unit, and within units."""
HELD, LOOSE = "\xa0", "\u2007"  # blanks at which no line breaks, or only where it must


def wrapped(words: str, width: int) -> list[str]:
    """The words in lines, none longer than that if words are not: no number is parted from its unit."""
    import re
    from textwrap import wrap

    held = re.sub(" ?[=±] ?", lambda sign: sign[0].replace(" ", LOOSE), re.sub(BESIDE, HELD, words))
    held = " ".join(w.replace(LOOSE, " ") if len(w) > width else w for w in held.split(" "))
    lines = wrap(held, max(width, 1), break_long_words=False, break_on_hyphens=False)
    return [line.replace(HELD, " ").replace(LOOSE, " ") for line in lines]


def finish() -> None:
    """Flush what is left; what cannot be would change the exit status as Python closes the streams."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except OSError:
            drop(stream)


def drop(stream: TextIO) -> None:
    """Send what is still buffered, and whatever comes, nowhere."""
    with suppress(OSError):  # no file is behind it
        number = stream.fileno()
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, number)
        os.close(nowhere)


class Forms(NamedTuple):
    """A result in the forms in which it may be asked for: each is made only if it is.

    ``json`` and ``records`` (of which CSV has a line each) give what is to be printed; ``page`` prints.
    """

    json: Callable[[], Mapping[str, object]]
    records: Callable[[], Iterable[Mapping[str, object]]]
    page: Callable[[], None]
    notes: Callable[[], Sequence[str]]


def show(forms: Forms, json: bool, csv: bool, bare: bool = False) -> Sequence[str]:
    """Print a result as JSON, as CSV or as a page; what comes back is left to say on stderr.

    That is the notes, for which CSV has no place, nor has any form in which a result is ``bare``. The
    result is out by then, so that they follow it where both go into one pipe. Raises OSError.
    """
    if json:
        sys.stdout.writelines(as_json(forms.json()))
        print()
    elif csv:
        print_csv(forms.records())
    else:
        forms.page()
    sys.stdout.flush()
    return forms.notes() if csv or bare else ()


def as_json(value: object, indent: str = "\n") -> Iterator[str]:
    """A value as JSON, piece by piece: of an iterator, each item as it comes.

    Numbers are as they are printed everywhere; those that no double can hold are null.
    """
    inner = indent + "  "
    match value:
        case Mapping():
            yield "{"
            for i, (key, item) in enumerate(value.items()):
                yield f"{',' * bool(i)}{inner}{json.dumps(key)}: "
                yield from as_json(item, inner)
            yield f"{indent}}}"
        case list() | Iterator():
            yield "["
            empty = True
            for item in value:
                yield inner if empty else f",{inner}"
                yield from as_json(item, inner)
                empty = False
            yield "]" if empty else f"{indent}]"
        case float() | Decimal():
            yield "null" if is_infinite(value) else text(value)
        case _:
            yield json.dumps(value)


def print_csv(records: Iterable[Mapping[str, object]]) -> None:
    """A line of names and a line for each record, as they come."""
    from csv import writer

    table = writer(Stdout(), lineterminator="\n")
    for number, record in enumerate(records):
        if not number:
            table.writerow(record)
        table.writerow(map(cell, record.values()))


def cell(value: object) -> str:
    """A value as bare text, empty where it does not exist or no double can hold it."""
    match value:
        case float() | Decimal():
            return "" if is_infinite(value) else text(value)
        case bool():
            return str(value).lower()
    return "" if value is None else str(value)


def scene_record(
    scene: Scene, motion: Motion = UNMEASURED, round_: Rounding[Any] = to_double
) -> dict[str, object]:
    """The inputs as JSON has them: numbers in SI units and degrees, or text where JSON has no number.

    A number is exact where it is a decimal, or else rounded as results are.
    """

    def written(value: object, unit: str) -> object:
        if not isinstance(value, Fraction):
            return value
        number = exact_or_rounded(value, round_)
        return f"{text(number)}{unit}" if unit else number

    return {name: written(*one) for name, one in _given(scene, motion).items()}


def _given(scene: Scene, motion: Motion) -> dict[str, tuple[Any, str]]:
    """The inputs by name, each with its unit where that is not the usual one."""
    given: dict[str, Any] = scene._asdict()
    if motion != UNMEASURED:
        given |= {name: getattr(motion, name) for name in MEASURED}
        given |= {motion.finds: None} if motion.finds else {}
    if scene.M == inf:
        given["M"] = "inf"
    if scene.axle is None:
        del given["axle"]  # nothing of it shows
    units = {"rad": "rad", "N m": " Nm"}
    return {
        name: (value.number, units.get(value.unit, "")) if isinstance(value, Angle | Axle) else (value, "")
        for name, value in given.items()
    }


def describe(scene: Scene, motion: Motion = UNMEASURED, uncertain: Mapping[str, Fraction] = {}) -> str:
    """The scene in one line, as understood, with uncertainties."""
    return ", ".join(inputs_in_words(scene, motion, uncertain).values())


def inputs_in_words(
    scene: Scene, motion: Motion = UNMEASURED, uncertain: Mapping[str, Fraction] = {}
) -> dict[str, str]:
    """What is said of each input: m1 = 1 kg."""
    parts = {}
    for name, (value, unit) in _given(scene, motion).items():
        u = as_typed(uncertain[name]) if name in uncertain else ""
        if isinstance(value, Fraction):
            number = f"{_as_fine(as_typed(value), u)}{f' ± {u}' * bool(u)}"
            parts[name] = f"{name} = {number}{unit}" if unit else stated(name, number)
        elif value is not None:
            parts[name] = f"{name} = {value}"
    return parts


def _as_fine(number: str, other: str) -> str:
    """The number with as many decimals as the other, zeros if it has fewer: 3 beside 0.02 is 3.00."""
    decimals = len(other.partition(".")[2]) - len(number.partition(".")[2])
    if decimals <= 0 or "e" in number + other or "/" in number + other:
        return number
    return f"{number}{'' if '.' in number else '.'}{'0' * decimals}"
