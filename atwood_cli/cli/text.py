"""Results as text, for which rich is not needed: cells, JSON, CSV, sentences on stderr."""

import json
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from decimal import Decimal
from fractions import Fraction
from math import inf
from typing import NamedTuple, TextIO

from ..arithmetic.rounding import as_typed, is_infinite, text
from ..model.scene import MEASURED, UNMEASURED, Motion, Scene, stated

ASCII = str.maketrans(
    {
        "μ": "mu",
        "µ": "u",
        "φ": "phi",
        "β": "beta",
        "π": "pi",
        "τ": "tau",
        "α": "alpha",
        "θ": "theta",
        "χ": "chi",
    }
    | {
        "₁": "1",
        "₂": "2",
        "²": "^2",
        "°": "deg",
        "·": "*",
        "±": "+/-",
        "≤": "<=",
        "≥": ">=",
        "≈": "~",
        "√": "sqrt",
    }
)


def for_stream(words: str, stream: TextIO | None) -> str:
    """The words as the stream can take them: symbols are spelled out where it is not Unicode."""
    return words if takes_unicode(stream) else words.translate(ASCII).encode("ascii", "replace").decode()


def takes_unicode(stream: TextIO | None) -> bool:
    """Whether symbols can be written to the stream."""
    encoding = getattr(stream, "encoding", None) or "ascii"
    return encoding.lower().startswith("utf")


def say(*messages: str) -> None:
    """Each message on stderr, as the program's, a line; what is typed or read steers no terminal."""
    for message in messages:
        shown = "".join(c if c.isprintable() else repr(c)[1:-1] for c in message)
        line = for_stream(f"atwood: {shown}", sys.stderr)
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
        case Fraction():
            yield as_typed(value)
        case float() | Decimal():
            yield "null" if is_infinite(value) else text(value)
        case _:
            yield json.dumps(value)


def print_csv(records: Iterable[Mapping[str, object]]) -> None:
    """A line of names and a line for each record, as they come."""
    from csv import writer

    table = writer(sys.stdout, lineterminator="\n")
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
    return str(value or "")


def scene_record(scene: Scene, motion: Motion = UNMEASURED) -> dict[str, object]:
    """The inputs as JSON has them: numbers in SI units and degrees, or text where JSON has no number."""
    given: dict[str, object] = scene._asdict()
    if motion != UNMEASURED:
        given |= {name: getattr(motion, name) for name in MEASURED}
        given |= {motion.finds: None} if motion.finds else {}
    if scene.M == inf:
        given["M"] = "inf"
    wrap, axle = scene.wrap, scene.axle
    given["wrap"] = wrap.number if wrap.unit == "°" else f"{as_typed(wrap.number)}rad"
    if axle is None:
        del given["axle"]  # nothing of it shows
    else:
        given["axle"] = axle.number if axle.unit == "N" else f"{as_typed(axle.number)} Nm"
    return given


def describe(scene: Scene, motion: Motion = UNMEASURED, uncertain: Mapping[str, Fraction] = {}) -> str:
    """The scene in one line, as understood, with uncertainties."""
    return ", ".join(inputs_in_words(scene, motion, uncertain).values())


def inputs_in_words(
    scene: Scene, motion: Motion = UNMEASURED, uncertain: Mapping[str, Fraction] = {}
) -> dict[str, str]:
    """What is said of each input: m1 = 1 kg."""
    parts = {}
    for name, value in scene_record(scene, motion).items():
        u = as_typed(uncertain[name]) if name in uncertain else ""
        spread = f" ± {u}" if u else ""
        if isinstance(value, Fraction):
            parts[name] = stated(name, f"{_as_fine(as_typed(value), u)}{spread}")
        elif value is not None:
            number, unit = str(value), ""
            for one in ("rad", " Nm") if u else ():
                if number.endswith(one):
                    number, unit = _as_fine(number.removesuffix(one), u), one
            parts[name] = f"{name} = {number}{spread}{unit}"
    return parts


def _as_fine(number: str, other: str) -> str:
    """The number with as many decimals as the other, zeros if it has fewer: 3 beside 0.02 is 3.00."""
    decimals = len(other.partition(".")[2]) - len(number.partition(".")[2])
    if decimals <= 0 or "e" in number + other or "/" in number + other:
        return number
    return f"{number}{'' if '.' in number else '.'}{'0' * decimals}"
