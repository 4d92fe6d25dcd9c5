"""Pictures in files, for a slide: their page, their style and their sentences.

matplotlib draws them (extra ``figure``), without pyplot or a display. The same scene gives the same SVG, to
the byte.
"""

import os
import re
import sys
import warnings
from collections.abc import Iterator
from contextlib import chdir, contextmanager
from importlib import import_module
from importlib.util import find_spec
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..model.quantities import QUANTITIES
from ..model.scene import SceneError
from .files import check_free, is_stdout, written_beside
from .text import wrapped

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

AXIS_WORDS = {
    "m1": ("mass", "m₁"),
    "m2": ("mass", "m₂"),
    "M": ("pulley mass", "M"),
    "mu": ("friction coefficient", "μ"),
    "mu_k": ("kinetic friction coefficient", "μₖ"),
    "g": ("gravity", "g"),
    "inertia": ("inertia factor", "β"),
    "I": ("moment of inertia", "I"),
    "R": ("radius", "R"),
    "wrap": ("angle of wrap", "φ"),
    "axle": ("friction of the axle", "f"),
    "mu_verge": ("verge coefficient", "μ*"),
    "friction_force_min": ("least friction force", "F min"),
    "friction_force_max": ("greatest friction force", "F max"),
    "friction_force_x": ("horizontal friction force", "Fx"),
    "friction_force_y": ("vertical friction force", "Fy"),
}
"""The names and symbols on axes: of parameters, and of quantities whose own name says less."""
PICTURE_SUFFIXES = (".svg", ".png", ".pdf")
BLUE, RED, GREEN, PURPLE, ORANGE, SKY = "#0072b2", "#d55e00", "#009e73", "#b05d91", "#b07800", "#56b4e9"
"""Colours that differ on paper and without seeing red or green (M. Okabe, K. Ito, Color universal design)."""
INK, FAINT = "#222222", "#999999"
PAGE_INCHES, PAGE_CHARACTERS = 11, 130
"""The width of a page, and the most characters of a line on it."""
NAME_POINTS = 10
"""The size of names, in points."""
NAMES_IN_WORDS = re.compile(r"\b(m1|m2|mu|mu_k|(?:inertia|wrap|axle)(?= =))\b")
LONG_DIGITS = re.compile(r"(\d{12})\d{12,}")
STYLE: Any = {
    "svg.hashsalt": "atwood",  # else the SVG's ids are random
    "font.family": "DejaVu Sans",
    "mathtext.fontset": "dejavusans",
    "font.size": 11,
}


def axis_words(name: str) -> tuple[str, str]:
    """The name and the symbol of a parameter or a quantity."""
    if name in AXIS_WORDS:
        return AXIS_WORDS[name]
    return name.rstrip("_12").replace("_", " "), QUANTITIES[name].symbol


def check_file(path: str, force: bool) -> None:
    """Raise in time what a picture would run into: SceneError where its suffix is no format, ImportError, and
    OSError where the file exists.
    """
    if Path(path).suffix.lower() not in PICTURE_SUFFIXES:
        raise SceneError("figure", path, f"must end in one of {', '.join(PICTURE_SUFFIXES)}")
    if is_stdout(path):
        raise SceneError("figure", path, "is where standard output goes; name another")
    _load()
    check_free(Path(path), force)


def _load() -> None:
    """Import matplotlib with its own settings. Raises ImportError.

    It would prefer settings of the user, and above all a file of settings in the folder where it is imported.
    So it is imported in the folder of its own file.
    """
    spec = find_spec("matplotlib")
    if "matplotlib" not in sys.modules and spec and spec.origin:
        os.environ.pop("MPLBACKEND", None)
        with warnings.catch_warnings(action="ignore"), chdir(Path(spec.origin).with_name("mpl-data")):
            import_module("matplotlib")
    import_module("matplotlib").set_loglevel("error")


@contextmanager
def page(path: str, force: bool, inches: float = PAGE_INCHES) -> Iterator["Figure"]:
    """A figure to draw on, so many inches wide, which is then saved."""
    _load()
    from matplotlib import rc_context, rcParamsDefault
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    kind = Path(path).suffix[1:].lower()
    date_key = {"svg": "Date", "pdf": "CreationDate"}.get(kind)
    os.environ.pop("SOURCE_DATE_EPOCH", None)  # a figure has no date, whatever this is set to
    image = BytesIO()  # matplotlib would not report a full disk as we do
    with written_beside(Path(path), force) as beside:
        with warnings.catch_warnings(action="ignore"), rc_context({**rcParamsDefault, **STYLE}):
            figure = Figure(figsize=(inches, 6), layout="constrained")
            FigureCanvasAgg(figure)  # knows the width of words
            yield figure
            figure.savefig(image, format=kind, dpi=200, metadata={date_key: None} if date_key else None)
        beside.write_bytes(image.getbuffer())


def say_above(figure: "Figure", *sentences: str) -> None:
    """Write sentences above a picture."""
    figure.suptitle("\n".join(_lines(figure, words) for words in sentences), fontsize=10)


def say_below(figure: "Figure", words: str) -> None:
    """Write words below a picture."""
    figure.supxlabel(_lines(figure, words), fontsize=10)


def legend_beside(axes: "Axes") -> None:
    """Name the lines on the right of their axes."""
    look: Any = {"frameon": False, "handlelength": 4, "fontsize": NAME_POINTS}
    axes.legend(loc="center left", bbox_to_anchor=(1, 0.5), **look)


def cut(words: str) -> str:
    """The words, with the first twelve digits of numbers that have twice as many."""
    return LONG_DIGITS.sub(r"\1…", words)


def _lines(figure: "Figure", words: str) -> str:
    """Words in lines that fit, with symbols for the names of parameters."""
    in_symbols = NAMES_IN_WORDS.sub(lambda name: AXIS_WORDS[name[0]][1], cut(words))
    return "\n".join(wrapped(in_symbols, int(PAGE_CHARACTERS * figure.get_figwidth() / PAGE_INCHES)))
