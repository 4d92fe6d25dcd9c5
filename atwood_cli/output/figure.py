"""Pictures in files, as wide as the text of a printed page: their size, their style and their sentences.

matplotlib draws them (extra ``figure``), without a display. The same scene gives the same SVG, to the byte.
"""

import os
import re
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib import import_module
from io import BytesIO
from logging import ERROR, getLogger
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.sax.saxutils import escape

from ..explain.given import WEIGHTS
from ..solver.quantities import QUANTITIES
from ..solver.scene import INPUTS, SceneError
from .files import check_free, written_beside
from .forms import Picture
from .text import say_written, wrapped

if TYPE_CHECKING:
    from matplotlib.figure import Figure

BLUE, RED, GREEN, PURPLE, ORANGE, SKY = "#0072b2", "#d55e00", "#009e73", "#b05d91", "#b07800", "#56b4e9"
"""Colours that differ on paper and without seeing red or green (M. Okabe, K. Ito, Color universal design)."""
COLOURS = (BLUE, RED, GREEN, PURPLE, ORANGE, SKY)
INK, FAINT = "#222222", "#999999"
WIDTH, HEIGHT, PANEL_HEIGHT = 6.4, 4.0, 2.0
"""The size of a picture with one pair of axes, and the height of each further pair, in inches."""
LINE_CHARACTERS = 88
NAMES_IN_WORDS = re.compile(r"\b(mu|mu_k|(?:inertia|wrap|axle)(?= (?:=|from)))\b")
SIDES_IN_WORDS = re.compile(r"\b[mTW][12]\b")
LONG_DIGITS = re.compile(r"(\d{12})\d{12,}")
EXPONENT, MINUS = re.compile(r"(?<=\d)e\+?(-?)0*(\d+)"), re.compile(r"(?<![\w.)])-(?=\d)")
SUPERSCRIPTS, SUBSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"), str.maketrans("12", "₁₂")
STYLE: Any = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans", "Verdana"],  # which is as wide, for SVG without the first
    "font.size": 9,
    "figure.titlesize": 9.5,
    "axes.titlesize": 8.5,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.formatter.limits": (-3, 5),  # the powers of ten between which numbers are written without one
    "axes.formatter.min_exponent": 4,  # the least power of ten with which those on axes of logarithms are
    "axes.formatter.use_mathtext": True,
    "mathtext.fontset": "dejavusans",
    "legend.frameon": False,
    "legend.borderpad": 0,
    "savefig.dpi": 300,
    "svg.fonttype": "none",  # text stays text
    "svg.hashsalt": "atwood",  # else the SVG's ids are random
    "pdf.fonttype": 42,  # fonts that can be edited and searched
}
PICTURE_FORMATS: Any = {"svg": {"Date": None}, "png": {}, "pdf": {"CreationDate": None}}
"""The formats of pictures, and what of their metadata would differ each time."""


def axis_words(name: str) -> tuple[str, str]:
    """Return the words of a parameter or a quantity, and its symbol, if it has one in print."""
    if name in WEIGHTS.values():
        return "weight", name.translate(SUBSCRIPTS)
    about = INPUTS.get(name) or QUANTITIES[name]
    return about.axis or name.rstrip("_12").replace("_", " "), "" if "_" in about.symbol else about.symbol


def check_picture(picture: Picture) -> None:
    """Import matplotlib, and check that it can write the picture. Raises SceneError, ImportError, OSError."""
    path = Path(picture.file)
    if path.suffix[1:].lower() not in PICTURE_FORMATS:
        rule = f"must end in one of {', '.join(f'.{kind}' for kind in PICTURE_FORMATS)}"
        raise SceneError("figure", picture.file, rule)
    os.environ["MPLBACKEND"] = "agg"
    getLogger("matplotlib").setLevel(ERROR)  # silent about settings of the user, which are not used
    import_module("matplotlib")
    check_free(path, picture.force)


@contextmanager
def saved(picture: Picture, above: Sequence[str], below: str = "", panels: int = 1) -> Iterator["Figure"]:
    """Yield a figure with room for so many panels, below each other, save it and say so. Raises OSError.

    The sentences ``above`` are written unless it is bare, or has symbols alone. In the file, the first of
    them is the title, and all others, with those ``below``, are the description.
    """
    from matplotlib import rc_context, rcParamsDefault
    from matplotlib.figure import Figure

    path = Path(picture.file)
    kind = path.suffix[1:].lower()
    above = [] if picture.symbols else above
    title, *others = map(typeset, [*above, below] if above else ["", below])
    description = " ".join(others).strip()
    metadata = PICTURE_FORMATS[kind] | {
        "Title": title,
        "Subject" if kind == "pdf" else "Description": description,
    }
    os.environ.pop("SOURCE_DATE_EPOCH", None)  # a figure has no date, whatever this is set to
    image = BytesIO()  # matplotlib would not report a full disk as we do
    with written_beside(path, picture.force) as beside:
        with warnings.catch_warnings(action="ignore"), rc_context({**rcParamsDefault, **STYLE}):
            figure = Figure((WIDTH, HEIGHT + (panels - 1) * PANEL_HEIGHT), layout="constrained")
            figure.suptitle("" if picture.bare else "\n".join(map(_in_lines, above)))
            figure.supxlabel(_in_lines(below), fontsize=9)
            yield figure
            if picture.symbols:
                _leave_symbols(figure)
            figure.savefig(image, format=kind, metadata=metadata)
        content = image.getvalue()
        if kind == "svg":  # matplotlib leaves this out
            described = f"</title>\n<desc>{escape(description)}</desc>"
            content = content.replace(b"</title>", described.encode(), 1)
        beside.write_bytes(content)
    say_written(picture.file)


def _leave_symbols(figure: "Figure") -> None:
    """Take values off a picture: T₁ = 12 N becomes T₁. Scales and legends of curves keep their numbers."""
    for axes in figure.axes:
        for text in axes.texts:
            text.set_text(re.sub(r"\s= .*", "", text.get_text()))
        for text in legend.get_texts() if (legend := axes.get_legend()) else ():
            text.set_text(re.sub(r"\s(from|beyond) .*", "", text.get_text()))


def typeset(words: str) -> str:
    """Return words as print has them: symbols for names, minus signs, powers of ten, no endless digits."""
    words = NAMES_IN_WORDS.sub(lambda name: [*filter(None, axis_words(name[0]))][-1], words)
    words = re.sub(r" \(--[^)]*\)", "", words)  # options
    words = LONG_DIGITS.sub(r"\1…", words)
    words = SIDES_IN_WORDS.sub(lambda name: name[0].translate(SUBSCRIPTS), words)
    words = EXPONENT.sub(lambda e: f" × 10{(e[1] + e[2]).translate(SUPERSCRIPTS)}", words)
    return MINUS.sub("−", words)


def _in_lines(words: str) -> str:
    return "\n".join(wrapped(typeset(words), LINE_CHARACTERS))
