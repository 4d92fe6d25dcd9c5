"""The arc of contact and sweeps as pictures, for a slide: needs matplotlib (extra ``figure``).

No pyplot, no display; the same scene gives the same SVG to the byte.
"""

import os
import sys
import warnings
from collections.abc import Iterator
from contextlib import chdir, contextmanager
from importlib import import_module
from importlib.util import find_spec
from io import BytesIO
from itertools import pairwise
from math import cos, degrees, hypot, nan, radians, sin
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Any

from ..arithmetic.rounding import to_double
from ..files import check_free, is_stdout, written_beside
from ..model.scene import SceneError
from ..solver.answers import Answers
from ..solver.contact import Contact, contact
from ..solver.messages import verdict
from .text import describe

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ..fit.fitting import Fit
    from ..tradeoff.measure import Tradeoff
    from .curves import Curve, Picture

FORMATS = (".svg", ".png", ".pdf")
NORMAL, FRICTION, STRING, WEIGHT = "#1f5fa8", "#c23b22", "#222222", "#5a7d2a"
LONGEST = 0.75  # radii: the arrow of the greatest force
DRAWABLE = (1e-100, 1e100)
WRAPS = (1e-100, 1e9)  # degrees: of more, doubles no longer say where the end of the arc is
CURVE_POINTS, ARROWS, TITLE_DIGITS = 361, 13, 6
TITLE_WIDTH = 130  # characters: more do not fit the page
MARKED = 60  # points: of more, only the line is drawn
STYLE: Any = {
    "svg.hashsalt": "atwood",  # else the SVG's ids are random
    "font.family": "DejaVu Sans",
    "mathtext.fontset": "dejavusans",
    "font.size": 11,
}


def save(answers: Answers, kind: str | None, path: str, force: bool) -> None:
    """Draw the arc to a file, whose suffix is its format. Raises SceneError, OSError."""
    check_file(path, force)
    doubles = Answers(answers.case.scene)
    scene = answers.case.scene
    tensions = [float(doubles[name] or 0) for name in ("tension_1", "tension_2")]
    weights = [to_double(mass * scene.g) for mass in (scene.m1, scene.m2)]
    if max(tensions) < DRAWABLE[0] or max(*tensions, *weights) > DRAWABLE[1]:
        raise SceneError("figure", path, f"draws forces between {DRAWABLE[0]} and {DRAWABLE[1]} N only")
    if not WRAPS[0] <= doubles.settle(lambda m: m.case.scene.wrap.degrees(m.ar)) <= WRAPS[1]:
        raise SceneError("figure", path, f"draws wraps between {WRAPS[0]} and {WRAPS[1]:.0e} degrees only")
    with _page(path, force) as figure:
        machine, curve = figure.subplots(1, 2, width_ratios=[1.1, 1])
        _draw_machine(machine, doubles, contact(doubles, ARROWS, kind))
        _draw_tension(curve, contact(doubles, CURVE_POINTS, kind))
        shown = Answers(answers.case.scene, answers.digits or TITLE_DIGITS)
        figure.suptitle(f"{describe(shown.case.scene)}\n{verdict(shown)}", fontsize=10)


def save_sweep(picture: "Picture", title: str, path: str, force: bool) -> None:
    """Draw the curves of a sweep to a file, whose suffix is its format. Raises SceneError, OSError."""
    check_file(path, force)
    with _page(path, force) as figure:
        axes = figure.subplots()
        axes.set_xlabel(picture.x)
        axes.set_ylabel(picture.y)
        axes.set_xscale("log" if picture.log else "linear")
        axes.spines[["top", "right"]].set_visible(False)
        for curve in picture.curves:
            _draw_curve(axes, curve)
        if min(curve.xs) < max(curve.xs):
            axes.set_xlim(min(curve.xs), max(curve.xs))  # where the curve has gaps, too
        if len(picture.curves) > 1:
            axes.legend(frameon=False)
        figure.suptitle(title, fontsize=10)


def save_tradeoff(outcome: "Tradeoff", path: str, force: bool) -> None:
    """Draw error against time to a file, whose suffix is its format. Raises SceneError, OSError."""
    from ..tradeoff.measure import EDGES, MARGIN, drawable, drawable_marches

    marches = drawable_marches(outcome.marches)
    with _page(path, force) as figure:
        arithmetic, *rest = figure.subplots(1, 1 + any(marches), squeeze=False)[0]
        families = list(dict.fromkeys(one.family for one in outcome.measured))
        settings = list(dict.fromkeys(one.setting for one in outcome.measured))
        for family, colour in zip(families, FAMILY_COLOURS, strict=False):
            points = [one for one in outcome.measured if one.family == family]
            xs, ys = [one.seconds for one in points], [drawable(one.worst_ulp) for one in points]
            arithmetic.plot(xs, ys, color=colour, lw=0.6, alpha=0.5, label=family)
            for x, y, one in zip(xs, ys, points, strict=True):
                arithmetic.plot([x], [y], MARKERS[settings.index(one.setting)], color=colour)
        for setting, marker in zip(settings, MARKERS, strict=False):
            arithmetic.plot([], [], marker, color="#444444", label=setting)
        arithmetic.axhline(MARGIN, color="#999999", lw=0.8, ls=":", label=f"{MARGIN} ulp")
        arithmetic.set_ylabel("worst error (ulp)")
        for elements in rest:
            kinds = (("elements", NORMAL), ("extrapolated", FRICTION))
            for way, (label, colour) in zip(marches, kinds, strict=True):
                if way:
                    elements.plot(*zip(*way, strict=True), color=colour, marker=".", label=label)
            elements.set_ylabel("relative error of $e^{\\mu\\varphi}$")
        for axes in (arithmetic, *rest):
            axes.loglog()
            axes.set_xlabel("time (s)")
            axes.spines[["top", "right"]].set_visible(False)
            axes.legend(frameon=False, fontsize=8)
        figure.suptitle(EDGES, fontsize=10)


def save_fit(fit: "Fit", head: str, path: str, force: bool) -> None:
    """Draw runs and their line to a file, whose suffix is its format. Raises SceneError, OSError."""
    from ..fit.line import points
    from ..fit.sentences import shown, verdict

    check_file(path, force)
    at = points(fit)
    with _page(path, force) as figure:
        line, rest = figure.subplots(2, 1, sharex=True, height_ratios=[3, 1])
        end = 1.06 * float(max(at.x))
        line.plot([0, end], [at.intercept, at.intercept + at.slope * end], color=NORMAL, lw=1.5)
        bars: Any = {"fmt": "o", "ms": 5, "capsize": 3, "lw": 1.2, "color": STRING}
        line.errorbar(at.x, at.y, yerr=at.u_y, xerr=at.u_x, **bars)
        rest.axhline(0, color=NORMAL, lw=1.5)
        rest.errorbar(at.x, at.residual, yerr=at.u_residual, **bars)
        for run, x, y in zip(fit.used, at.x, at.y, strict=True) if len(fit.used) <= MARKED else ():
            number = ",".join(map(str, run.rows))
            line.annotate(
                number, (x, y), xytext=(6, -12), textcoords="offset points", size=9, color="#777777"
            )
        said = []
        for name, label, unit in (("rim_mass", "slope $c$", "kg"), ("axle", "intercept $f$", "N")):
            spread = fit.uncertainty(name) if name in fit.values else None
            why = (
                "" if name in fit.values else ", given" if name in fit.known.values else ", as none is needed"
            )
            said.append(f"{label} = {shown(fit.estimate.values[name], spread)} {unit}{why}")
        line.text(0.03, 0.95, "\n".join(said), transform=line.transAxes, va="top", color=NORMAL)
        line.set_ylabel("$T_h - T_l = (m_h - m_l)\\,g - a\\,(m_h + m_l)$  (N)")
        rest.set_ylabel("residual (N)")
        rest.set_xlabel("acceleration $a$ (m/s²)")
        line.set_xlim(0, end)
        low, high = min(0.0, float(min(at.y - at.u_y)), at.intercept), float(max(at.y + at.u_y))
        line.set_ylim(low, high + 0.2 * (high - low))
        for axes in (line, rest):
            axes.spines[["top", "right"]].set_visible(False)
        figure.suptitle("\n".join([head, *wrap(verdict(fit), TITLE_WIDTH)]), fontsize=10)


FAMILY_COLOURS = (NORMAL, FRICTION, WEIGHT, "#8a5a9e", STRING)
MARKERS = "xPs^Do*v"


def _draw_curve(axes: "Axes", curve: "Curve") -> None:
    ys = [nan if y is None else y for y in curve.ys]
    (line,) = axes.plot(curve.xs, ys, marker="." if len(ys) <= MARKED else "", label=curve.label)
    for i, regimes in zip(curve.changes, pairwise(curve.regimes), strict=True):
        axes.axvline(curve.xs[i], color=line.get_color(), lw=1, ls="--")
        label = ", ".join([*regimes, *filter(None, [curve.label])])
        place = axes.get_xaxis_transform()  # the height is a share of the axes'
        axes.text(curve.xs[i], 0.98, f" {label}", transform=place, rotation=90, ha="right", va="top", size=9)


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
def _page(path: str, force: bool) -> Iterator["Figure"]:
    """A figure to draw on, which is then saved."""
    _load()
    from matplotlib import rc_context, rcParamsDefault
    from matplotlib.figure import Figure

    kind = Path(path).suffix[1:].lower()
    drawn = BytesIO()  # a full disk is none of matplotlib's business
    with written_beside(Path(path), force) as beside:
        with warnings.catch_warnings(action="ignore"), rc_context({**rcParamsDefault, **STYLE}):
            figure = Figure(figsize=(11, 6), layout="constrained")
            yield figure
            figure.savefig(drawn, format=kind, dpi=200, metadata={"Date": None} if kind == "svg" else None)
        beside.write_bytes(drawn.getbuffer())


def _draw_machine(axes: "Axes", answers: Answers, arc: Contact) -> None:
    from matplotlib.patches import Arc, Circle

    phi = float(answers.settle(lambda m: m.phi))
    axes.set_aspect("equal")
    axes.axis("off")
    axes.add_patch(Circle((0, 0), 1, facecolor="#eeeeee", edgecolor="#999999"))
    axes.add_patch(Circle((0, 0), 0.03, color="#999999"))
    axes.add_patch(Arc((0, 0), 2, 2, theta1=0, theta2=min(degrees(phi), 360), color=STRING, lw=2.5))
    axes.annotate("", (0.45 * cos(0.5), 0.45 * sin(0.5)), (0.45, 0), arrowprops=_arc_arrow())
    axes.text(0.52 * cos(0.25), 0.52 * sin(0.25), r"$\theta$", va="center")

    scale = LONGEST / max(float(point["tension"]) for point in arc.points)
    for point in arc.points:
        theta = radians(float(point["angle"]))
        outwards, along = (cos(theta), sin(theta)), (-sin(theta), cos(theta))
        normal = scale * float(point["normal_per_radian"])
        friction = scale * float(point["friction_per_radian"])
        _arrow(axes, _at((0, 0), outwards, 1 + normal), outwards, -normal, NORMAL)
        _arrow(axes, _at((0, 0), outwards, 0.93), along, friction, FRICTION)
    middle = arc.points[len(arc.points) // 2]
    top = radians(float(middle["angle"]))
    beyond = 1.1 + scale * float(middle["normal_per_radian"])
    axes.text(beyond * cos(top), beyond * sin(top), "$nR$", color=NORMAL, ha="center", va="bottom")
    axes.text(0.8 * cos(top), 0.8 * sin(top), "$fR$", color=FRICTION, ha="center", va="center")

    _hang(axes, answers, "1", (1.0, 0.0), (0.0, -1.0), scale, side=1)
    end, tangent = (cos(phi), sin(phi)), (-sin(phi), cos(phi))
    _hang(axes, answers, "2", end, tangent, scale, side=-1)
    friction_x, friction_y = arc.balance["friction"]["x"], arc.balance["friction"]["y"]
    net = hypot(float(friction_x), float(friction_y))
    axes.text(0, -0.45, f"friction on the pulley\n{net:.4g} N", color=FRICTION, ha="center", va="center")
    axes.set_xlim(-2.15, 2.15)
    axes.set_ylim(-3.1, 2.05)


def _hang(
    axes: "Axes",
    answers: Answers,
    name: str,
    end: tuple[float, float],
    along: tuple[float, float],
    scale: float,
    side: int,
) -> None:
    """The free string from the end of the arc, its tension, and the mass if it hangs straight down."""
    from matplotlib.patches import Rectangle

    mass, tension = getattr(answers.case.scene, f"m{name}"), float(answers[f"tension_{name}"])
    x, y = _at(end, along, 1.5)
    axes.plot([end[0], x], [end[1], y], color=STRING, lw=2.5, solid_capstyle="butt")
    beside = "left" if side > 0 else "right"
    start = _at(end, end, 0.1)  # beside the string
    _arrow(axes, start, along, scale * tension, STRING)
    label = _at(_at(start, along, 0.4), end, 0.12)
    axes.text(*label, f"$T_{name}$ = {tension:.4g} N", ha=beside, va="center", color=STRING)
    if abs(along[0]) > 1e-9 or along[1] > 0:
        return
    axes.add_patch(Rectangle((x - 0.16, y - 0.32), 0.32, 0.32, facecolor="#d8d2c4", edgecolor=STRING))
    axes.text(x, y - 0.16, f"$m_{name}$", ha="center", va="center")
    weight = float(mass * answers.case.scene.g)
    _arrow(axes, (x, y - 0.32), (0, -1), min(scale * weight, 1.2), WEIGHT)
    axes.text(x + 0.12 * side, y - 0.55, f"$W_{name}$ = {weight:.4g} N", ha=beside, va="center", color=WEIGHT)


def _draw_tension(axes: "Axes", arc: Contact) -> None:
    angles = [float(point["angle"]) for point in arc.points]
    axes.plot(angles, _column(arc, "tension"), color=NORMAL, lw=2, label=r"$T(\theta) = nR$")
    axes.plot(angles, _column(arc, "friction_per_radian"), color=FRICTION, lw=2, label=r"$dT/d\theta = fR$")
    axes.set_xlabel(r"$\theta$ (°)")
    axes.set_ylabel("N per radian of arc")
    axes.set_xlim(angles[0], angles[-1])
    axes.axhline(0, color="#999999", lw=0.8)
    axes.legend(frameon=False)
    axes.spines[["top", "right"]].set_visible(False)
    for angle, align in ((angles[0], "left"), (angles[-1], "right")):
        tension = float(arc.points[0 if angle == angles[0] else -1]["tension"])
        axes.annotate(
            f"{tension:.5g} N",
            (angle, tension),
            textcoords="offset points",
            xytext=(4 if align == "left" else -4, 14),
            ha=align,
            color=NORMAL,
        )
    axes.margins(y=0.1)


def _column(arc: Contact, name: str) -> list[float]:
    return [float(point[name]) for point in arc.points]


def _at(point: tuple[float, float], direction: tuple[float, float], distance: float) -> tuple[float, float]:
    return point[0] + distance * direction[0], point[1] + distance * direction[1]


def _arrow(
    axes: "Axes", start: tuple[float, float], direction: tuple[float, float], length: float, color: str
) -> None:
    if abs(length) > 1e-3:
        style: dict[str, Any] = {"arrowstyle": "-|>", "color": color, "lw": 1.6, "shrinkA": 0, "shrinkB": 0}
        axes.annotate("", _at(start, direction, length), start, arrowprops=style)


def _arc_arrow() -> dict[str, Any]:
    return {"arrowstyle": "-|>", "connectionstyle": "arc3,rad=0.25", "color": "#666666"}
