"""The machine in a picture, alone or beside curves of what acts along the arc of contact.

Points and directions are complex numbers, lengths in radii of the pulley, whose axle is at 0. The arc begins
on the left, where the string of m1 hangs down, and runs clockwise over the top. Strings leave along tangents.
"""

from collections.abc import Sequence
from decimal import Decimal
from math import cos, floor, inf, log10, pi, radians, sin
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..model import arc
from ..model.digits import text, tidy, to_double
from ..model.machine import Machine
from ..model.scene import SceneError
from ..solver.answers import Answers
from ..solver.balance import about
from ..solver.messages import unmarked, verdict
from .figure import (
    BLUE,
    FAINT,
    GREEN,
    INCHES,
    INK,
    ORANGE,
    PURPLE,
    RED,
    SIZE,
    check_file,
    page,
    say_above,
    say_below,
)
from .text import describe

if TYPE_CHECKING:
    from matplotlib.axes import Axes

DRAWABLE = (1e-100, 1e100)
WRAPS = (1e-100, 1e9)  # degrees: of more, doubles no longer say where the end of the arc is
DIGITS, CURVE_POINTS = 4, 200
ALONE = 8  # inches: the width of a page without curves

TURN = 2 * pi
PIECES = 360  # of a turn, as it is drawn
BOX, LINE = 0.3, 1.75  # the width of a mass, and the length of its string
WORDS = 1.15 + 0.4j  # the room of the words beside a mass
SHORT, BEYOND, OUT = 0.4, radians(250), 1.6
"""m2's string is short where it ends right of m1's; from an angle of wrap on it ends left, so far out."""
TENSION, WEIGHT, SHORTEST = 0.35, 0.5, 0.05  # the lengths of arrows: most and least
SMALL, LARGE = 0.12, 0.3  # of friction's longest arrow; beyond, all of friction is drawn larger or smaller
APART = radians(15)  # between arrows along the arc
RIM, INSIDE = 0.93, 0.86  # where arrows of friction and of the normal force start
AXLE, ACCELERATION = (0.23, -0.08), 0.36  # the end of the arrow around the axle, and the length of an arrow
NAME = -0.36j  # where the pulley's mass is said
NOT_TO_SCALE = "Short and long arrows are not to scale."
GUIDED = "m₂'s guide is not drawn."


def save(
    answers: Answers, kind: arc.Kind | None, path: str, force: bool, bare: bool, curves: bool = False
) -> None:
    """Draw the machine to a file, whose suffix is its format, with ``curves`` also what acts along the arc.

    ``kind`` is how the tension runs along the arc; there is none where an end of the string is fixed to the
    pulley. ``bare`` leaves out all sentences but those on how it is drawn. Raises SceneError, OSError.
    """
    check_file(path, force)
    scene, few = answers.case.scene, answers.to(min(answers.digits or DIGITS, DIGITS))
    doubles = answers.to(None)
    weights = [to_double(mass * scene.g) for mass in (scene.m1, scene.m2)]
    tensions = [float(doubles[name] or 0) for name in ("tension_1", "tension_2")]
    least = min(tensions) if kind else max(weights)
    if least < DRAWABLE[0] or max(*tensions, *weights) > DRAWABLE[1]:
        raise SceneError("figure", path, f"draws forces between {DRAWABLE[0]} and {DRAWABLE[1]} N only")
    wrap = float(doubles.settle(lambda m: scene.wrap.degrees(m.ar)))
    if not WRAPS[0] <= wrap <= WRAPS[1]:
        raise SceneError("figure", path, f"draws wraps between {WRAPS[0]} and {WRAPS[1]:.0e} degrees only")
    forces = Forces.of(doubles, kind) if kind else None
    widths = [1.3, 1] if curves else [1]
    with page(path, force, INCHES if curves else ALONE) as figure:
        if not bare:
            inputs = describe(scene, answers.case.motion, answers.uncertain)
            say_above(figure, inputs, unmarked(verdict(few)))
        machine, *beside = figure.subplots(1, len(widths), width_ratios=widths, squeeze=False)[0]
        drawn = _draw_machine(machine, few, forces, radians(wrap), tensions, weights)
        if curves and forces:
            _draw_curves(beside[0], forces, wrap)
        said = _sentences(few, kind) if kind and not bare else []
        if wrap > 360:
            turns = text(tidy(Decimal(few.settle(lambda m: scene.wrap.degrees(m.ar) / 360))))
            drawn.insert(
                0, f"Of {turns} turns, the heavier mass's is drawn." if kind else f"There are {turns} turns."
            )
        say_below(figure, " ".join([*said, *drawn]))


def number(value: Any) -> str:
    """A number as a picture says it: without an exponent where it is readable without."""
    return f"{value:f}" if isinstance(value, Decimal) and 0 <= value.adjusted() < 16 else text(value)


def _sentences(few: Answers, kind: arc.Kind) -> list[str]:
    """What friction does to the pulley, and over which part of the arc if not over all."""
    if few.case.frictionless:
        return [about(few.case, kind)]

    def net(m: Machine[Any]) -> Any:
        x, y = arc.friction(m.arcs(kind))
        return m.ar.sqrt(x * x + y * y)

    force = f"The net friction force is {number(few.settle(net))} N"
    if kind != "creep":
        return [about(few.case, kind), f"{force}."]
    end = "last" if few.case.sign > 0 else "first"
    angle = number(few.settle(lambda m: m.alpha * 180 / m.ar.pi))
    return [f"{force}, over the {end} {angle}° of the arc; over the rest the string is stuck."]


class Forces(NamedTuple):
    """The forces along the arc: the tension is constant from the lighter mass on, and then exponential."""

    stuck: float
    """The share of the arc over which it is constant."""
    light: float
    heavy: float
    """The tensions (N)."""
    mu: float
    """Friction over normal force beyond that, positive where the tension grows along the arc."""
    sign: int
    """1 where m1 is the lighter mass, and -1 where it is the heavier."""

    @classmethod
    def of(cls, answers: Answers, kind: arc.Kind) -> "Forces":
        mu = float(answers.settle(lambda m: m.arc_mu(kind)))
        stuck = float(answers.settle(lambda m: (m.phi - m.alpha) / m.phi)) if kind == "creep" else 0.0
        light = float(answers.settle(lambda m: m.light_tension))
        heavy = float(answers.settle(lambda m: m.heavy_tension))
        sign = 1 if answers.case.sign >= 0 else -1
        return cls(stuck, light, heavy, sign * mu, sign)

    def along(self, shares: Any) -> tuple[Any, Any]:
        """Tension and friction per radian (N) at shares of the arc; the first is the normal force, too."""
        from_light = shares if self.sign > 0 else 1 - shares
        limiting = np.clip((from_light - self.stuck) / (1 - self.stuck), 0, 1)
        tension = self.light * (self.heavy / self.light) ** limiting
        return tension, np.where(from_light < self.stuck, 0, self.mu * tension)


class End(NamedTuple):
    """An end of the string: the top of its mass, where the string leads, and where words stand beside it."""

    top: complex
    down: complex
    aside: complex


def _ends(end: float) -> tuple[End, End]:
    """Both ends, where the arc ends at an angle within a turn."""
    beyond, leaving = end >= BEYOND, 1j * np.exp(-1j * end)
    first = End(-1 - LINE * 1j, -1j, 1.0 if beyond else -1.0)
    aside = -1j if beyond and end < 1.5 * pi else 1j
    return first, End(_rim(end) + _length(end) * leaving, leaving, aside * leaving)


def _draw_machine(
    axes: "Axes",
    few: Answers,
    forces: Forces | None,
    phi: float,
    tensions: Sequence[float],
    weights: Sequence[float],
) -> list[str]:
    """Draw pulley, string and masses, and the forces on them; what is to be said of the drawing."""
    axes.axis("off")
    turn = phi % TURN or TURN  # where the arc ends, however many turns there are
    ends = _ends(turn)
    _draw_string(
        axes, phi, turn, [end.top if weight else None for end, weight in zip(ends, weights, strict=True)]
    )
    scale = TENSION / (max(tensions) or inf)
    fitting = WEIGHT / max(weights)
    if scale / 2 <= fitting < scale or not scale:
        scale = fitting
    legend, whole = _draw_contact(axes, forces, phi, scale) if forces else ([], True)
    if friction := _axle_friction(few):
        (x, y), way = AXLE, few.case.sign
        look: Any = {"color": ORANGE, "arrowstyle": "-|>", "connectionstyle": f"arc3,rad={0.7 * way}"}
        axes.annotate("", (way * x, y), (-way * x, y), arrowprops=look)
        legend.append((f"axle friction, {friction} N at the rim", ORANGE))
    axes.text(NAME.real, NAME.imag, _pulley(few), ha="center", va="center", size=10)
    for i, (end, tension, weight) in enumerate(zip(ends, tensions, weights, strict=True)):
        if weight:
            whole &= _draw_mass(axes, few, i, end, scale * tension, scale * weight)
    axes.margins(0.02)
    axes.autoscale_view()
    axes.set_aspect("equal")
    _draw_legend(axes, legend)
    guided = bool(weights[1]) and abs(turn - pi) > 1e-9
    return [*[GUIDED] * guided, *[NOT_TO_SCALE] * (not whole)]


def _draw_string(axes: "Axes", phi: float, turn: float, tops: Sequence[complex | None]) -> None:
    """Draw the pulley, and the string from one mass to the other; an end without a mass is fixed there."""
    rim = _rim(np.linspace(0, TURN, PIECES + 1))
    axes.fill(rim.real, rim.imag, facecolor="#eeeeee", edgecolor=FAINT, lw=1)
    axes.plot([0], [0], "o", color=FAINT, ms=4)
    around = _rim(np.linspace(0, turn + TURN * (phi > TURN), 2 * PIECES))
    start, end = ([] if top is None else [top] for top in tops)
    string = np.array([*start, *around, *end])
    axes.plot(string.real, string.imag, color=INK, lw=2.2, solid_capstyle="butt", solid_joinstyle="round")
    for top, place in zip(tops, around[[0, -1]], strict=True):
        if top is None:
            axes.plot([place.real], [place.imag], "o", color=INK, ms=8)


def _draw_legend(axes: "Axes", entries: Sequence[tuple[str, str]]) -> None:
    """What arrows are, by their colours, below the picture."""
    from matplotlib.lines import Line2D

    lines = [Line2D([], [], color=colour, marker=">", label=words) for words, colour in entries]
    if lines:
        axes.legend(
            handles=lines, ncols=2, loc="upper center", bbox_to_anchor=(0.5, 0), frameon=False, fontsize=SIZE
        )


def _rim(angle: Any) -> Any:
    """The place on the rim at an angle along the arc."""
    return -np.exp(-1j * angle)


def _length(end: float) -> float:
    """How long m2's string is from the end of the arc, so that m2 hangs clear of m1."""
    if pi < end < BEYOND:
        return SHORT
    return LINE if end <= pi else min(LINE, (OUT - cos(end)) / -sin(end))


def _pulley(few: Answers) -> str:
    """What is known of the pulley's inertia; empty where the scene leaves it open."""
    case, scene = few.case, few.case.scene
    if case.locked:
        return "M = inf"
    if scene.I is not None and scene.M is None:
        return f"I = {text(tidy(few.round(scene.I)))} kg m²"
    mass = few["critical_pulley_mass"] if case.regime == "verge" else case.pulley_mass
    return "" if mass is None else f"M = {text(tidy(few.round(mass)))} kg"


def _axle_friction(few: Answers) -> str:
    """The axle's friction as a force at the rim (N), as far as it acts; empty where it does not."""
    case = few.case
    if not case.rubs or case.locked or not case.sign:
        return ""
    held = case.rim_stands if case.regime == "slip" else case.axle_holds
    return text(tidy(Decimal(few.settle(lambda m: m.difference if held else m.f))))


def _draw_contact(
    axes: "Axes", forces: Forces, phi: float, scale: float
) -> tuple[list[tuple[str, str]], bool]:
    """The arrows of normal force and friction; what they are, by colour, and whether all are to scale.

    Of several turns, they are drawn over the one at the heavier mass.
    """
    drawn = min(phi, TURN) / phi
    count = int(drawn * phi / APART + 1e-9) + 1
    shares = np.linspace(0, drawn, count) if count > 1 else np.array([drawn / 2])
    shares = shares[: -1 if phi >= TURN else None]  # both ends are one place
    if forces.sign > 0:
        shares = 1 - shares
    out = _rim(phi * shares)
    normal, friction = (scale * force for force in forces.along(shares))
    factor = _factor(abs(friction).max())
    along = factor * friction * 1j * np.exp(-1j * phi * shares)
    inwards = -normal * out
    whole = [_draw_arrows(axes, INSIDE * out, inwards, BLUE), _draw_arrows(axes, RIM * out, along, RED)]
    said = number(tidy(Decimal(f"{max(factor, 1 / factor):.1g}")))
    times = f", drawn {said} times {'larger' if factor > 1 else 'smaller'}" * (factor != 1)
    said_of_friction = [(f"friction fR{times}", RED)] * bool(np.any(friction))
    return [("normal force nR", BLUE), *said_of_friction], all(whole)


def _factor(longest: float) -> float:
    """How many times larger than other arrows those of friction are drawn: 1, 2 or 5 times a power of ten."""
    if SMALL <= longest <= LARGE or not longest:
        return 1.0
    power = 10.0 ** floor(log10(LARGE / longest))
    return max((n * power for n in (2, 5) if n * power * longest <= LARGE), default=power)


def _draw_mass(axes: "Axes", few: Answers, i: int, end: End, tension: float, weight: float) -> bool:
    """A mass at its end of the string, the forces on it and its acceleration, in words and as arrows so long.

    Returns whether both forces are to scale.
    """
    scene, sub, (top, down, aside) = few.case.scene, "₁₂"[i], end
    centre = top + down * BOX / 2
    box = centre + BOX / 2 * down * np.array([1 + 1j, 1 - 1j, -1 - 1j, -1 + 1j])
    axes.fill(box.real, box.imag, fc="#e3ddcf", ec=INK, lw=1)
    axes.text(centre.real, centre.imag, f"m{sub}", ha="center", va="center")
    whole = _draw_arrows(axes, [top + 0.11 * aside], [-tension * down], INK)
    whole &= _draw_arrows(axes, [top + down * BOX], [weight * down], GREEN)
    acceleration = few["acceleration"]
    if acceleration:
        along = (-1, 1)[i] * few.case.sign * ACCELERATION * down
        _draw_arrows(axes, [centre + 0.27 * aside - along / 2], [along], PURPLE)
    said = (
        (f"T{sub} = {number(few[f'tension_{i + 1}'])} N", INK),
        (f"W{sub} = {number(few.round((scene.m1, scene.m2)[i] * scene.g))} N", GREEN),
        (f"a = {number(abs(acceleration))} m/s²" if acceleration else "a = 0", PURPLE),
    )
    _write_beside(axes, centre + 0.46 * aside, aside, said)
    return whole


def _write_beside(axes: "Axes", at: complex, aside: complex, said: Sequence[tuple[str, str]]) -> None:
    """Write lines, each in its colour, on one side of a place."""
    from matplotlib.offsetbox import AnnotationBbox, TextArea, VPacker

    lines: Any = [TextArea(words, textprops={"color": colour}) for words, colour in said]
    align = (1 - aside.real) / 2, (1 - aside.imag) / 2
    corner = at - complex(WORDS.real * align[0], WORDS.imag * align[1])
    axes.update_datalim([(place.real, place.imag) for place in (corner, corner + WORDS)])
    look: Any = {"box_alignment": align, "pad": 0, "frameon": False, "annotation_clip": False}
    axes.add_artist(AnnotationBbox(VPacker(children=lines, sep=3), (at.real, at.imag), **look))


def _draw_arrows(axes: "Axes", starts: Any, arrows: Any, colour: str) -> bool:
    """Arrows from some points, each at least so long that it is seen; whether all are to scale."""
    there = [(start, arrow) for start, arrow in zip(starts, arrows, strict=True) if arrow]
    lengths = [abs(arrow) for _, arrow in there]
    drawn = np.clip(lengths, SHORTEST, WEIGHT)
    at = np.array([start for start, _ in there], complex)
    along = np.array([arrow / length for (_, arrow), length in zip(there, lengths, strict=True)]) * drawn
    axes.update_datalim([(place.real, place.imag) for place in (*at, *(at + along))])
    look: Any = {"units": "inches", "width": 1.5 / 72, "headwidth": 5, "headlength": 6, "headaxislength": 6}
    scale: Any = {"angles": "xy", "scale_units": "xy", "scale": 1, "minlength": 0}
    axes.quiver(at.real, at.imag, along.real, along.imag, color=colour, **look, **scale)
    return bool(np.all(drawn == lengths))


def _draw_curves(axes: "Axes", forces: Forces, wrap: float) -> None:
    """Normal force and friction along the arc, which is grey where the string is stuck."""
    edge = forces.stuck if forces.sign > 0 else 1 - forces.stuck
    shares = np.sort([*np.linspace(0, 1, CURVE_POINTS), *np.nextafter(edge, [0, edge, 1])])
    tension, friction = forces.along(shares)
    angles = wrap * shares
    axes.axhline(0, color=FAINT, lw=0.8)
    if forces.stuck:
        axes.axvspan(wrap * edge, wrap * (forces.sign < 0), color=FAINT, alpha=0.15, lw=0)
    axes.plot(angles, tension, color=BLUE, lw=2, label="nR = T(θ)")
    axes.plot(angles, friction, color=RED, lw=2, ls="--", label="fR = dT/dθ")
    axes.set_xlim(0, wrap)
    axes.set_xlabel("angle θ along the arc, from m₁'s end on the left (°)")
    axes.xaxis.set_major_formatter("{x:.6g}")
    axes.set_ylabel("force per radian of arc, nR and fR (N/rad)")
    axes.margins(y=0.12)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1), ncols=2, frameon=False, fontsize=SIZE)
