"""Pictures in files, for a slide: needs matplotlib (extra ``figure``); the modules beside it draw them.

No pyplot, no display; the same scene gives the same SVG to the byte.
"""

import os
import re
import sys
import warnings
from collections.abc import Iterator, Sequence
from contextlib import chdir, contextmanager
from importlib import import_module
from importlib.util import find_spec
from io import BytesIO
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..model.quantities import QUANTITIES
from ..model.scene import SceneError
from .files import check_free, is_stdout, written_beside
from .text import wrapped

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

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
SIZE, LINE = 10, 1.5  # of names, in points, and from one line to the next as a multiple of it
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


def name_ends(axes: "Axes", ends: Sequence[tuple["Line2D", float, float]]) -> None:
    """Name lines, each at its right end, or in a legend where the names have no room below each other.

    To be called last: it goes by where all else then lies.
    """
    figure: Any = axes.figure
    figure.draw_without_rendering()
    ends = sorted(ends, key=lambda end: -end[2])
    heights = [axes.transData.transform((x, y))[1] for _, x, y in ends]
    room = LINE * SIZE * figure.dpi / 72
    right = {x for _, x, _ in ends} == {axes.get_xlim()[1]}
    if ends[1:] and not (right and all(up - down >= room for up, down in pairwise(heights))):
        handles = [line for line, *_ in ends]
        beside: Any = {"loc": "center left", "bbox_to_anchor": (1, 0.5), "frameon": False}
        axes.legend(handles=handles, handlelength=4, fontsize=SIZE, **beside)
        return
    for line, x, y in ends:
        look: Any = {"va": "center", "color": line.get_color(), "size": SIZE, "annotation_clip": False}
        axes.annotate(str(line.get_label()), (x, y), (6, 0), textcoords="offset points", **look)


def _lines(figure: "Figure", words: str) -> str:
    """Words in lines that fit, parameters by their symbols; numbers that nobody reads to the end are cut."""
    words = NAMES.sub(lambda name: AXES[name[0]][1], LONG_DIGITS.sub(r"\1…", words))
    return "\n".join(wrapped(words, int(WIDE * figure.get_figwidth() / INCHES)))
