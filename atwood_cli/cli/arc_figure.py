"""The arc of contact as a picture: the forces on the machine, and what they are along the arc."""

from math import cos, degrees, hypot, radians, sin
from typing import TYPE_CHECKING, Any

from ..arithmetic.rounding import to_double
from ..model.scene import SceneError
from ..solver.answers import Answers
from ..solver.contact import Contact, contact
from ..solver.messages import verdict
from .figure import BLUE, GREEN, INK, RED, check_file, page
from .text import describe

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LONGEST = 0.75  # radii: the arrow of the greatest force
DRAWABLE = (1e-100, 1e100)
WRAPS = (1e-100, 1e9)  # degrees: of more, doubles no longer say where the end of the arc is
CURVE_POINTS, ARROWS, TITLE_DIGITS = 361, 13, 6


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
    with page(path, force) as figure:
        machine, curve = figure.subplots(1, 2, width_ratios=[1.1, 1])
        _draw_machine(machine, doubles, contact(doubles, ARROWS, kind))
        _draw_tension(curve, contact(doubles, CURVE_POINTS, kind))
        shown = Answers(answers.case.scene, answers.digits or TITLE_DIGITS)
        figure.suptitle(f"{describe(shown.case.scene)}\n{verdict(shown)}", fontsize=10)


def _draw_machine(axes: "Axes", answers: Answers, arc: Contact) -> None:
    from matplotlib.patches import Arc, Circle

    phi = float(answers.settle(lambda m: m.phi))
    axes.set_aspect("equal")
    axes.axis("off")
    axes.add_patch(Circle((0, 0), 1, facecolor="#eeeeee", edgecolor="#999999"))
    axes.add_patch(Circle((0, 0), 0.03, color="#999999"))
    axes.add_patch(Arc((0, 0), 2, 2, theta1=0, theta2=min(degrees(phi), 360), color=INK, lw=2.5))
    axes.annotate("", (0.45 * cos(0.5), 0.45 * sin(0.5)), (0.45, 0), arrowprops=_arc_arrow())
    axes.text(0.52 * cos(0.25), 0.52 * sin(0.25), r"$\theta$", va="center")

    scale = LONGEST / max(float(point["tension"]) for point in arc.points)
    for point in arc.points:
        theta = radians(float(point["angle"]))
        outwards, along = (cos(theta), sin(theta)), (-sin(theta), cos(theta))
        normal = scale * float(point["normal_per_radian"])
        friction = scale * float(point["friction_per_radian"])
        _arrow(axes, _at((0, 0), outwards, 1 + normal), outwards, -normal, BLUE)
        _arrow(axes, _at((0, 0), outwards, 0.93), along, friction, RED)
    middle = arc.points[len(arc.points) // 2]
    top = radians(float(middle["angle"]))
    beyond = 1.1 + scale * float(middle["normal_per_radian"])
    axes.text(beyond * cos(top), beyond * sin(top), "$nR$", color=BLUE, ha="center", va="bottom")
    axes.text(0.8 * cos(top), 0.8 * sin(top), "$fR$", color=RED, ha="center", va="center")

    _hang(axes, answers, "1", (1.0, 0.0), (0.0, -1.0), scale, side=1)
    end, tangent = (cos(phi), sin(phi)), (-sin(phi), cos(phi))
    _hang(axes, answers, "2", end, tangent, scale, side=-1)
    friction_x, friction_y = arc.balance["friction"]["x"], arc.balance["friction"]["y"]
    net = hypot(float(friction_x), float(friction_y))
    axes.text(0, -0.45, f"friction on the pulley\n{net:.4g} N", color=RED, ha="center", va="center")
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
    axes.plot([end[0], x], [end[1], y], color=INK, lw=2.5, solid_capstyle="butt")
    beside = "left" if side > 0 else "right"
    start = _at(end, end, 0.1)  # beside the string
    _arrow(axes, start, along, scale * tension, INK)
    label = _at(_at(start, along, 0.4), end, 0.12)
    axes.text(*label, f"$T_{name}$ = {tension:.4g} N", ha=beside, va="center", color=INK)
    if abs(along[0]) > 1e-9 or along[1] > 0:
        return
    axes.add_patch(Rectangle((x - 0.16, y - 0.32), 0.32, 0.32, facecolor="#d8d2c4", edgecolor=INK))
    axes.text(x, y - 0.16, f"$m_{name}$", ha="center", va="center")
    weight = float(mass * answers.case.scene.g)
    _arrow(axes, (x, y - 0.32), (0, -1), min(scale * weight, 1.2), GREEN)
    axes.text(x + 0.12 * side, y - 0.55, f"$W_{name}$ = {weight:.4g} N", ha=beside, va="center", color=GREEN)


def _draw_tension(axes: "Axes", arc: Contact) -> None:
    angles = [float(point["angle"]) for point in arc.points]
    axes.plot(angles, _column(arc, "tension"), color=BLUE, lw=2, label=r"$T(\theta) = nR$")
    axes.plot(angles, _column(arc, "friction_per_radian"), color=RED, lw=2, label=r"$dT/d\theta = fR$")
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
            color=BLUE,
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
