"""The page of the machine's picture, alone or beside curves of what acts along the arc of contact."""

from functools import partial
from math import radians
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arithmetic.rounding import text, to_double
from ..model import arc
from ..model.machine import Machine
from ..model.scene import SceneError
from ..solver.answers import Answers
from ..solver.contact import about
from ..solver.messages import unmarked, verdict
from .figure import BLUE, FAINT, INCHES, RED, check_file, page, say_above, say_below
from .labels import Label, write_labels
from .machine_figure import TURNS, Profile, draw, mark_theta
from .text import describe

if TYPE_CHECKING:
    from matplotlib.axes import Axes

DRAWABLE = (1e-100, 1e100)
WRAPS = (1e-100, 1e9)  # degrees: of more, doubles no longer say where the end of the arc is
DIGITS, CURVE_POINTS = 4, 200
ALONE = 8  # inches: the width of a page without curves
SIDES = ("left", "right")


def save(
    answers: Answers,
    kind: arc.Kind | None,
    path: str,
    force: bool,
    m1_side: str | None,
    bare: bool,
    curves: bool = False,
) -> None:
    """Draw the machine to a file, whose suffix is its format, with ``curves`` also what acts along the arc.

    ``kind`` is the profile of the tension; there is none where the string is fixed to the pulley. ``bare``
    leaves out all sentences but those on the scale of arrows. Raises SceneError, OSError.
    """
    if m1_side not in (None, *SIDES):
        raise SceneError("m1_side", m1_side, f"must be {' or '.join(SIDES)}")
    check_file(path, force)
    scene, doubles = answers.case.scene, answers.to(None)
    few = answers.to(min(answers.digits or DIGITS, DIGITS))
    weights = [to_double(mass * scene.g) for mass in (scene.m1, scene.m2)]
    tensions = [float(doubles[name] or 0) for name in ("tension_1", "tension_2")]
    least = min(tensions) if kind else max(weights)
    if least < DRAWABLE[0] or max(*tensions, *weights) > DRAWABLE[1]:
        raise SceneError("figure", path, f"draws forces between {DRAWABLE[0]} and {DRAWABLE[1]} N only")
    wrap = float(doubles.settle(lambda m: scene.wrap.degrees(m.ar)))
    if not WRAPS[0] <= wrap <= WRAPS[1]:
        raise SceneError("figure", path, f"draws wraps between {WRAPS[0]} and {WRAPS[1]:.0e} degrees only")
    profile = Profile.of(doubles, kind) if kind else None
    widths = [1.1, 1] if curves else [1]
    with page(path, force, INCHES if curves else ALONE) as figure:
        if not bare:
            inputs = describe(scene, answers.case.motion, answers.uncertain)
            say_above(figure, inputs, unmarked(verdict(few)))
        machine, *beside = figure.subplots(1, len(widths), width_ratios=widths, squeeze=False)[0]
        names, of_arrows = draw(machine, doubles, few, profile, wrap, m1_side == "left")
        labels = {machine: names}
        if curves and profile:
            mark_theta(machine, radians(wrap))
            labels[beside[0]] = _draw_curves(beside[0], profile, wrap, m1_side or "right")
        said = _sentences(few, kind, "grey part" if curves else "rest") if kind and not bare else []
        said += of_arrows
        if wrap > 360 * TURNS:
            turns = text(few.settle(lambda m: scene.wrap.degrees(m.ar) / 360))
            said.append(f"Of the string's {turns} turns a few are drawn.")
        say_below(figure, " ".join(said))
        write_labels(figure, labels, 10)


def _sentences(few: Answers, kind: arc.Kind, rest: str) -> list[str]:
    """What the string does to the pulley, and over which parts of the arc friction acts if not over all."""
    said = [
        "The string acts on the pulley along the arc of contact only: it presses with the normal force nR"
        " and rubs along the rim with the friction fR, both per radian.",
        about(few.case, kind),
    ]
    if few.case.frictionless:
        return said

    def net(m: Machine[Any]) -> Any:
        x, y = arc.friction(m.arcs(kind))
        return m.ar.sqrt(x * x + y * y)

    def angle(piece: int, m: Machine[Any]) -> Any:
        return (m.arcs(kind)[piece].end.angle - m.arcs(kind)[piece].start.angle) * 180 / m.ar.pi

    said.append(f"All friction together is a force of {text(few.settle(net))} N.")
    if True in arc.STUCK[kind]:
        rubbing = [piece for piece, stuck in enumerate(arc.STUCK[kind]) if not stuck][:: few.case.sign]
        ends = ["first", "last"] if rubbing[1:] else ["last" if few.case.sign > 0 else "first"]
        angles = [text(few.settle(partial(angle, piece))) for piece in rubbing]
        parts = " and ".join(f"the {end} {wide}°" for end, wide in zip(ends, angles, strict=True))
        said.append(f"It acts over {parts} of the arc; over the {rest} the string is stuck.")
    return said


def _draw_curves(axes: "Axes", profile: Profile, wrap: float, m1_side: str) -> list[Label]:
    """Normal force and friction along the arc, with steps where it is stuck; words still to be written."""
    axes.axhline(0, color=FAINT, lw=0.8)
    ends = []  # of friction over each piece
    for start, end, mu in zip(profile.knots, profile.knots[1:], profile.mus, strict=False):
        shares = np.linspace(start, end, CURVE_POINTS)
        tension = profile.tension(shares)
        axes.plot(wrap * shares, tension, color=BLUE, lw=2)
        axes.plot(wrap * shares, mu * tension, color=RED, lw=2, ls="--")
        ends += [mu * tension[0], mu * tension[-1]]
        if not mu and any(profile.mus):
            axes.axvspan(wrap * start, wrap * end, color=FAINT, alpha=0.15, lw=0)
    for knot, *step in zip(profile.knots[1:-1], ends[1::2], ends[2::2], strict=False):
        axes.plot([wrap * knot] * 2, step, color=RED, lw=1, ls=":")
    axes.set_xlim(0, wrap)
    axes.set_xlabel(f"angle θ along the arc, from m₁'s end on the {m1_side} (°)")
    axes.xaxis.set_major_formatter("{x:.6g}")
    axes.set_ylabel("force per radian of arc, nR and fR (N/rad)")
    axes.margins(y=0.12)
    axes.spines[["top", "right"]].set_visible(False)

    rubbing = int(np.argmax(np.abs(profile.mus) * np.diff(profile.knots)))
    at = sum(profile.knots[rubbing : rubbing + 2]) / 2
    return [
        Label("nR = T(θ), normal force", wrap / 2, profile.tension(0.5), BLUE),
        Label("fR = dT/dθ, friction", wrap * at, profile.mus[rubbing] * profile.tension(at), RED),
        Label("T₁", 0, profile.tensions[0], BLUE),
        Label("T₂", wrap, profile.tensions[-1], BLUE),
    ]
