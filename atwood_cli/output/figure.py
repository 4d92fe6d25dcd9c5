"""Pictures in files, for a slide: needs matplotlib (extra ``figure``); the modules beside it draw them.

No pyplot, no display; the same scene gives the same SVG to the byte.
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

AXES = {
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
"""Names and symbols on axes, of parameters and of quantities whose own name says less."""
FORMATS = (".svg", ".png", ".pdf")
BLUE, RED, GREEN, PURPLE, ORANGE, SKY = "#0072b2", "#d55e00", "#009e73", "#b05d91", "#b07800", "#56b4e9"
"""Told apart without seeing red or green, and on paper: after M. Okabe and K. Ito, Color universal design."""
INK, FAINT = "#222222", "#999999"
INCHES, WIDE = 11, 130  # a page's width; characters: more do not fit it
SIZE = 10  # of names, in points
NAMES = re.compile(r"\b(m1|m2|mu|mu_k|(?:inertia|wrap|axle)(?= =))\b")
LONG_DIGITS = re.compile(r"(\d{12})\d{12,}")
STYLE: Any = {
    "svg.hashsalt": "atwood",  # else the SVG's ids are random
    "font.family": "DejaVu Sans",
    "mathtext.fontset": "dejavusans",
    "font.size": 11,
}


def axis_words(name: str) -> tuple[str, str]:
    """The name and the symbol of a parameter or a quantity."""
    if name in AXES:
        return AXES[name]
    return name.rstrip("_12").replace("_", " "), QUANTITIES[name].symbol


def check_file(path: str, force: bool) -> None:
    """Raises in time: SceneError where the suffix is no format, ImportError, or OSError if it exists."""
    if Path(path).suffix.lower() not in FORMATS:
        raise SceneError("figure", path, f"must end in one of {', '.join(FORMATS)}")
    if is_stdout(path):
        raise SceneError("figure", path, "is where standard output goes; name another")
    _load()
    check_free(Path(path), force)


def _load() -> None:
    """Import matplotlib without any settings but its own: neither the user's nor those of the folder.

    It takes those of the folder it is in first; in its own, these are as it came. Raises ImportError.
    """
    spec = find_spec("matplotlib")
    if "matplotlib" not in sys.modules and spec and spec.origin:
        os.environ.pop("MPLBACKEND", None)
        with warnings.catch_warnings(action="ignore"), chdir(Path(spec.origin).with_name("mpl-data")):
            import_module("matplotlib")
    import_module("matplotlib").set_loglevel("error")


@contextmanager
def page(path: str, force: bool, inches: float = INCHES) -> Iterator["Figure"]:
    """A figure to draw on, of some width, which is then saved."""
    _load()
    from matplotlib import rc_context, rcParamsDefault
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    kind = Path(path).suffix[1:].lower()
    dated = {"svg": "Date", "pdf": "CreationDate"}.get(kind)
    os.environ.pop("SOURCE_DATE_EPOCH", None)  # a figure has no date, whatever this is set to
    drawn = BytesIO()  # a full disk is none of matplotlib's business
    with written_beside(Path(path), force) as beside:
        with warnings.catch_warnings(action="ignore"), rc_context({**rcParamsDefault, **STYLE}):
            figure = Figure(figsize=(inches, 6), layout="constrained")
            FigureCanvasAgg(figure)  # which knows how wide words are
            yield figure
            figure.savefig(drawn, format=kind, dpi=200, metadata={dated: None} if dated else None)
        beside.write_bytes(drawn.getbuffer())


def say_above(figure: "Figure", *sentences: str) -> None:
    """Write sentences above a picture."""
    figure.suptitle("\n".join(_lines(figure, words) for words in sentences), fontsize=10)


def say_below(figure: "Figure", words: str) -> None:
    """Write words below a picture."""
    figure.supxlabel(_lines(figure, words), fontsize=10)


def legend_beside(axes: "Axes") -> None:
    """Name the lines on the right of their axes."""
    axes.legend(loc="center left", bbox_to_anchor=(1, 0.5), frameon=False, handlelength=4, fontsize=SIZE)


def cut(words: str) -> str:
    """The words, without the end of numbers that nobody reads to it."""
    return LONG_DIGITS.sub(r"\1…", words)


def _lines(figure: "Figure", words: str) -> str:
    """Words in lines that fit, parameters by their symbols."""
    words = NAMES.sub(lambda name: AXES[name[0]][1], cut(words))
    return "\n".join(wrapped(words, int(WIDE * figure.get_figwidth() / INCHES)))
