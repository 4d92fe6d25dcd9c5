"""The arc of contact as a picture: the forces on the machine, and what they are along the arc."""

import re
from functools import partial
from math import nan
from typing import TYPE_CHECKING, Any

from ..arithmetic.rounding import to_double
from ..model import arc
from ..model.machine import Machine
from ..model.scene import SceneError
from ..solver.answers import Answers
from ..solver.contact import Contact, contact
from ..solver.messages import unmarked, verdict
from .figure import BLUE, FAINT, GREY, RED, check_file, page
from .labels import Label, write_labels
from .machine_figure import Numbers, draw
from .text import describe, wrapped

if TYPE_CHECKING:
    from matplotlib.axes import Axes

DRAWABLE = (1e-100, 1e100)
WRAPS = (1e-100, 1e9)  # degrees: of more, doubles no longer say where the end of the arc is
CURVE_POINTS, DIGITS, TITLE_WIDTH, CAPTION_WIDTH = 361, 6, 128, 140
SIDES = ("left", "right")
LONG_DIGITS = re.compile(r"(\d{12})\d{12,}")


def save(answers: Answers, shown: Contact, path: str, force: bool, m1_side: str | None) -> None:
    """Draw the arc to a file, whose suffix is its format. Raises SceneError, OSError."""
    if m1_side not in (None, *SIDES):
        raise SceneError("m1_side", m1_side, f"must be {' or '.join(SIDES)}")
    check_file(path, force)
    scene, kind = answers.case.scene, shown.kind
    doubles = Answers(scene)
    tensions = [float(doubles[name] or 0) for name in ("tension_1", "tension_2")]
    weights = [to_double(mass * scene.g) for mass in (scene.m1, scene.m2)]
    if max(tensions) < DRAWABLE[0] or max(*tensions, *weights) > DRAWABLE[1]:
        raise SceneError("figure", path, f"draws forces between {DRAWABLE[0]} and {DRAWABLE[1]} N only")
    wrap = float(doubles.settle(lambda m: scene.wrap.degrees(m.ar)))
    if not WRAPS[0] <= wrap <= WRAPS[1]:
        raise SceneError("figure", path, f"draws wraps between {WRAPS[0]} and {WRAPS[1]:.0e} degrees only")
    numbers = Numbers(Answers(scene, min(answers.digits or DIGITS, DIGITS)))
    with page(path, force) as figure:
        head = [_lines(words, TITLE_WIDTH) for words in (describe(scene), unmarked(verdict(numbers.answers)))]
        figure.suptitle("\n".join(head), fontsize=10)
        caption = [
            "The string acts on the pulley along the arc of contact only: it presses with the normal force"
            " $nR$ and rubs along the rim with the friction $fR$, both per radian.",
            shown.notes[0],
            *numbers.net_friction(kind),
            *numbers.turns(wrap),
        ]
        machine, curve = figure.subplots(1, 2, width_ratios=[1.1, 1])
        names, clipped = draw(machine, doubles, profile(kind), numbers, m1_side == "left")
        labels = _draw_curves(curve, doubles, kind, numbers, m1_side or "right")
        caption += ["A dashed arrow is longer than drawn."] * clipped
        figure.supxlabel(_lines(" ".join(caption), CAPTION_WIDTH), fontsize=10)
        write_labels(machine, names, 11)
        write_labels(curve, labels, 10, laid_out=True)


def _lines(words: str, width: int) -> str:
    """The words in lines that fit the page; of numbers that nobody reads to the end, the beginning."""
    return "\n".join(wrapped(LONG_DIGITS.sub(r"\1…", words), width))


def _draw_curves(
    axes: "Axes", answers: Answers, kind: arc.Kind, numbers: Numbers, m1_side: str
) -> list[Label]:
    """Normal force and friction along the arc, with steps where it is stuck; words still to be written."""
    points = contact(answers, CURVE_POINTS, profile(kind)).points
    names = ("angle", "tension", "friction_per_radian")
    rows = [tuple(float(point[name]) for name in names) for point in points]
    steps = []
    for piece in range(1, len(arc.STUCK[kind])):
        angle, tension, before, after = _boundary(answers, kind, piece)
        axes.plot([angle, angle], [before, after], color=RED, lw=1, ls=":")
        steps.append(angle)
        rows += [(angle, tension, before), (angle, tension, nan), (angle, tension, after)]
    rows.sort(key=lambda row: row[0])  # those of one angle stay as they are
    angles, tensions, frictions = (list(column) for column in zip(*rows, strict=True))
    axes.axhline(0, color=FAINT, lw=0.8)
    axes.plot(angles, tensions, color=BLUE, lw=2)
    axes.plot(angles, frictions, color=RED, lw=2, ls="--")
    axes.set_xlim(angles[0], angles[-1])
    axes.set_xlabel(rf"angle $\theta$ along the arc, from $m_1$'s end on the {m1_side} (°)")
    axes.xaxis.set_major_formatter("{x:.6g}")
    axes.set_ylabel("force per radian of arc, $nR$ and $fR$ (N/rad)")
    axes.margins(y=0.12)
    axes.spines[["top", "right"]].set_visible(False)

    def near(at: float, ys: list[float], words: str, colour: str) -> Label:
        return Label(
            words, at, next(y for x, y in zip(angles, ys, strict=True) if x >= at and y == y), colour
        )

    rubs = (
        (max(steps, default=0), angles[-1]) if answers.case.sign > 0 else (0, min(steps, default=angles[-1]))
    )
    labels = [
        near(angles[-1] / 2, tensions, r"$nR = T(\theta)$, normal force", BLUE),
        near(sum(rubs) / 2, frictions, r"$fR = dT/d\theta$, friction", RED),
        near(angles[0], tensions, "$T_1$", BLUE),
        near(angles[-1], tensions, "$T_2$", BLUE),
    ]
    if True in arc.STUCK[kind]:
        ends, words = _stuck(answers, kind, numbers)
        start, end = ends[0] or angles[0], ends[1] or angles[-1]
        axes.axvspan(start, end, color=FAINT, alpha=0.15, lw=0)
        labels.append(Label(words, (start + end) / 2, max(tensions) / 4, GREY))
    return labels


def profile(kind: arc.Kind) -> str | None:
    """A profile as it is asked for."""
    return None if kind == "exponential" else kind


def _boundary(answers: Answers, kind: arc.Kind, piece: int) -> tuple[float, float, float, float]:
    """Where a piece of the arc begins: angle (°) from m1's end, tension, friction before and behind."""
    sign = answers.case.sign
    tension = float(answers.settle(lambda m: m.arcs(kind)[piece].start.tension))
    limit = float(answers.settle(lambda m: m.arc_mu(kind) * m.arcs(kind)[piece].start.tension)) * sign
    before, after = (0.0 if stuck else limit for stuck in arc.STUCK[kind][piece - 1 : piece + 1][::sign])
    return float(answers.settle(lambda m: _from_m1(m, kind, piece) * 180 / m.ar.pi)), tension, before, after


def _from_m1(m: Machine[Any], kind: arc.Kind, piece: int) -> Any:
    """The angle (rad) from m1's end of the arc at which a piece begins, counted from the lighter mass."""
    angle = m.arcs(kind)[piece].start.angle
    return angle if m.case.sign > 0 else m.phi - angle


def _stuck(
    answers: Answers, kind: arc.Kind, numbers: Numbers
) -> tuple[tuple[float | None, float | None], str]:
    """From where to where (°) the string is stuck, None for an end of the arc, and that in words."""
    pieces = range(1, len(arc.STUCK[kind]))[:: answers.case.sign]
    angles = [_boundary(answers, kind, piece)[0] for piece in pieces]
    words = [numbers.angle(partial(_from_m1, kind=kind, piece=piece)) for piece in pieces]
    if len(angles) > 1:
        return (angles[0], angles[1]), f"stuck from\n{words[0]}\nto {words[1]}"
    if answers.case.sign > 0:
        return (None, angles[0]), f"stuck\nup to\n{words[0]}"
    return (angles[0], None), f"stuck\nfrom\n{words[0]}"
