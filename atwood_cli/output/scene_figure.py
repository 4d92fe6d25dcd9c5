"""The machine in a picture, alone or beside curves of the forces along the arc of contact.

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
    INK,
    NAME_POINTS,
    ORANGE,
    PAGE_INCHES,
    PURPLE,
    RED,
    check_file,
    page,
    say_above,
    say_below,
)
from .text import describe

if TYPE_CHECKING:
    from matplotlib.axes import Axes

DRAWN_FORCES = (1e-100, 1e100)
"""The least and the greatest force that is drawn, in N."""
DRAWN_WRAPS = (1e-100, 1e9)
"""The least and the greatest wrap that is drawn, in degrees: doubles cannot tell where a greater one ends."""
SAID_DIGITS, CURVE_POINTS = 4, 200
MACHINE_INCHES = 8
"""The width of a page without curves."""

TURN = 2 * pi
TURN_PIECES = 360
"""The number of straight pieces that a turn is drawn in."""
# Lengths and places are in radii of the pulley.
BOX, STRING = 0.3, 1.75  # the width of a mass, and the length of its string
WORDS_SIZE = 1.15 + 0.4j  # the width and the height of the words beside a mass
SHORT_STRING = 0.4  # m2's string where it ends right of m1's
ENDS_LEFT, CLEAR = radians(250), 1.6  # from this angle of wrap on it ends left of m1's, so far from the axle
MOST_TENSION, MOST_WEIGHT, LEAST_ARROW = 0.35, 0.5, 0.05  # lengths of arrows
FRICTION_ARROW = (0.12, 0.3)  # the longest of friction; beyond, all of friction is drawn larger or smaller
BETWEEN_ARROWS = radians(15)  # along the arc
FRICTION_AT, NORMAL_AT = 0.93, 0.86  # distances from the axle at which arrows start
AXLE_ARROW, ACCELERATION_ARROW = (0.23, -0.08), 0.36  # the end of the first, and the length of the second
PULLEY_WORDS = -0.36j  # the place of the pulley's mass
NOT_TO_SCALE = "Short and long arrows are not to scale."
GUIDED = "m₂'s guide is not drawn."


def save(
    answers: Answers, kind: arc.Kind | None, path: str, force: bool, bare: bool, curves: bool = False
) -> None:
    """Draw the machine to a file, whose suffix is its format, and with ``curves`` the forces along the arc.

    ``kind`` is how the tension runs along the arc; there is none where an end of the string is fixed to the
    pulley. ``bare`` leaves out all sentences except on how it is drawn. Raises SceneError, OSError.
    """
    check_file(path, force)
    scene, few = answers.case.scene, answers.to(min(answers.digits or SAID_DIGITS, SAID_DIGITS))
    doubles = answers.to(None)
    weights = [to_double(mass * scene.g) for mass in (scene.m1, scene.m2)]
    tensions = [float(doubles[name] or 0) for name in ("tension_1", "tension_2")]
    least, greatest = DRAWN_FORCES
    if (min(tensions) if kind else max(weights)) < least or max(*tensions, *weights) > greatest:
        raise SceneError("figure", path, f"draws forces between {least} and {greatest} N only")
    wrap = float(doubles.settle(lambda m: scene.wrap.degrees(m.ar)))
    least, greatest = DRAWN_WRAPS
    if not least <= wrap <= greatest:
        raise SceneError("figure", path, f"draws wraps between {least} and {greatest:.0e} degrees only")
    forces = Forces.of(doubles, kind) if kind else None
    widths = [1.3, 1] if curves else [1]
    with page(path, force, PAGE_INCHES if curves else MACHINE_INCHES) as figure:
        if not bare:
            inputs = describe(scene, answers.case.motion, answers.uncertain)
            say_above(figure, inputs, unmarked(verdict(few)))
        machine, *beside = figure.subplots(1, len(widths), width_ratios=widths, squeeze=False)[0]
        on_drawing = _draw_machine(machine, few, forces, radians(wrap), tensions, weights)
        if curves and forces:
            _draw_curves(beside[0], forces, wrap)
        sentences = _sentences(few, kind) if kind and not bare else []
        if wrap > 360:
            turns = text(tidy(Decimal(few.settle(lambda m: scene.wrap.degrees(m.ar) / 360))))
            of_them = f"Of {turns} turns, the heavier mass's is drawn."
            sentences.append(of_them if kind else f"There are {turns} turns.")
        say_below(figure, " ".join([*sentences, *on_drawing]))


def number(value: Any) -> str:
    """A number as a picture says it: without an exponent where it is readable without."""
    return f"{value:f}" if isinstance(value, Decimal) and 0 <= value.adjusted() < 16 else text(value)


def _sentences(few: Answers, kind: arc.Kind) -> list[str]:
    """Sentences on the friction on the pulley, and on the part of the arc over which it acts."""
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
    """The forces along the arc: from the lighter mass on the tension is constant, and then exponential."""

    stuck: float
    """The share of the arc over which the tension is constant."""
    light: float
    heavy: float
    """The tensions at both ends, in N."""
    mu: float
    """Friction over normal force where the tension changes, positive where it grows towards m2."""
    sign: int
    """1 where m1 is the lighter mass, and -1 where it is the heavier mass."""

    @classmethod
    def of(cls, answers: Answers, kind: arc.Kind) -> "Forces":
        mu = float(answers.settle(lambda m: m.arc_mu(kind)))
        stuck = float(answers.settle(lambda m: (m.phi - m.alpha) / m.phi)) if kind == "creep" else 0.0
        light = float(answers.settle(lambda m: m.light_tension))
        heavy = float(answers.settle(lambda m: m.heavy_tension))
        sign = 1 if answers.case.sign >= 0 else -1
        return cls(stuck, light, heavy, sign * mu, sign)

    def along(self, shares: Any) -> tuple[Any, Any]:
        """Tension and friction per radian (N) at shares of the arc; the tension is the normal force, too."""
        from_light = shares if self.sign > 0 else 1 - shares
        limiting = np.clip((from_light - self.stuck) / (1 - self.stuck), 0, 1)
        tension = self.light * (self.heavy / self.light) ** limiting
        return tension, np.where(from_light < self.stuck, 0, self.mu * tension)


class End(NamedTuple):
    """An end of the string: the top of its mass, the direction of the string, and the side of the words."""

    top: complex
    down: complex
    aside: complex


def _ends(end: float) -> tuple[End, End]:
    """Both ends, where the arc ends at an angle within a turn."""
    ends_left, leaving = end >= ENDS_LEFT, 1j * np.exp(-1j * end)
    first = End(-1 - STRING * 1j, -1j, 1.0 if ends_left else -1.0)
    aside = -1j if ends_left and end < 1.5 * pi else 1j
    return first, End(_rim(end) + _length(end) * leaving, leaving, aside * leaving)


def _draw_machine(
    axes: "Axes",
    few: Answers,
    forces: Forces | None,
    phi: float,
    tensions: Sequence[float],
    weights: Sequence[float],
) -> list[str]:
    """Draw pulley, string and masses, and the forces on them. Returns sentences on the drawing."""
    axes.axis("off")
    turn = phi % TURN or TURN  # where the arc ends, however many turns there are
    ends = _ends(turn)
    _draw_string(
        axes, phi, turn, [end.top if weight else None for end, weight in zip(ends, weights, strict=True)]
    )
    # The longest tension gives the scale, or the longest weight where this makes it no less than half.
    scale = MOST_TENSION / (max(tensions) or inf)
    fitting = MOST_WEIGHT / max(weights)
    if scale / 2 <= fitting < scale or not scale:
        scale = fitting
    legend, to_scale = _draw_contact(axes, forces, phi, scale) if forces else ([], True)
    if friction := _axle_friction(few):
        (x, y), sign = AXLE_ARROW, few.case.sign
        look: Any = {"color": ORANGE, "arrowstyle": "-|>", "connectionstyle": f"arc3,rad={0.7 * sign}"}
        axes.annotate("", (sign * x, y), (-sign * x, y), arrowprops=look)
        legend.append((f"axle friction, {friction} N at the rim", ORANGE))
    axes.text(PULLEY_WORDS.real, PULLEY_WORDS.imag, _pulley(few), ha="center", va="center", size=10)
    for place, (end, tension, weight) in enumerate(zip(ends, tensions, weights, strict=True)):
        if weight:
            to_scale &= _draw_mass(axes, few, place, end, scale * tension, scale * weight)
    axes.margins(0.02)
    axes.autoscale_view()
    axes.set_aspect("equal")
    _draw_legend(axes, legend)
    guided = bool(weights[1]) and abs(turn - pi) > 1e-9
    return [*[GUIDED] * guided, *[NOT_TO_SCALE] * (not to_scale)]


def _draw_string(axes: "Axes", phi: float, turn: float, tops: Sequence[complex | None]) -> None:
    """Draw the pulley, and the string from one mass to the other; an end without a mass is fixed there."""
    rim = _rim(np.linspace(0, TURN, TURN_PIECES + 1))
    axes.fill(rim.real, rim.imag, facecolor="#eeeeee", edgecolor=FAINT, lw=1)
    axes.plot([0], [0], "o", color=FAINT, ms=4)
    around = _rim(np.linspace(0, turn + TURN * (phi > TURN), 2 * TURN_PIECES))
    start, end = ([] if top is None else [top] for top in tops)
    string = np.array([*start, *around, *end])
    axes.plot(string.real, string.imag, color=INK, lw=2.2, solid_capstyle="butt", solid_joinstyle="round")
    for top, place in zip(tops, around[[0, -1]], strict=True):
        if top is None:
            axes.plot([place.real], [place.imag], "o", color=INK, ms=8)


def _draw_legend(axes: "Axes", entries: Sequence[tuple[str, str]]) -> None:
    """Write below the picture what arrows are, by their colours."""
    from matplotlib.lines import Line2D

    lines = [Line2D([], [], color=colour, marker=">", label=words) for words, colour in entries]
    if lines:
        look: Any = {"ncols": 2, "frameon": False, "fontsize": NAME_POINTS}
        axes.legend(handles=lines, loc="upper center", bbox_to_anchor=(0.5, 0), **look)


def _rim(angle: Any) -> Any:
    """The place on the rim at an angle along the arc."""
    return -np.exp(-1j * angle)


def _length(end: float) -> float:
    """The length of m2's string from the end of the arc, with which m2 hangs clear of m1."""
    if pi < end < ENDS_LEFT:
        return SHORT_STRING
    return STRING if end <= pi else min(STRING, (CLEAR - cos(end)) / -sin(end))


def _pulley(few: Answers) -> str:
    """The pulley's inertia, as far as it is known, in words; empty where the scene leaves it open."""
    case, scene = few.case, few.case.scene
    if case.locked:
        return "M = inf"
    if scene.I is not None and scene.M is None:
        return f"I = {text(tidy(few.round(scene.I)))} kg m²"
    mass = few["critical_pulley_mass"] if case.regime == "verge" else case.pulley_mass
    return "" if mass is None else f"M = {text(tidy(few.round(mass)))} kg"


def _axle_friction(few: Answers) -> str:
    """The axle's friction as a force at the rim (N), as much of it as acts; empty where none does."""
    case = few.case
    if not case.rubs or case.locked or not case.sign:
        return ""
    held = case.rim_stands if case.regime == "slip" else case.axle_holds
    return text(tidy(Decimal(few.settle(lambda m: m.difference if held else m.f))))


def _draw_contact(
    axes: "Axes", forces: Forces, phi: float, scale: float
) -> tuple[list[tuple[str, str]], bool]:
    """Draw the arrows of normal force and friction over the turn at the heavier mass.

    Returns the entries of the legend, by colour, and whether all arrows are to scale.
    """
    drawn = min(phi, TURN) / phi
    count = int(drawn * phi / BETWEEN_ARROWS + 1e-9) + 1
    shares = np.linspace(0, drawn, count) if count > 1 else np.array([drawn / 2])
    shares = shares[: -1 if phi >= TURN else None]  # of a turn, both ends are one place
    if forces.sign > 0:
        shares = 1 - shares
    outwards = _rim(phi * shares)
    normal, friction = (scale * force for force in forces.along(shares))
    factor = _factor(abs(friction).max())
    along = factor * friction * 1j * np.exp(-1j * phi * shares)
    to_scale = _draw_arrows(axes, NORMAL_AT * outwards, -normal * outwards, BLUE)
    to_scale &= _draw_arrows(axes, FRICTION_AT * outwards, along, RED)
    times = number(tidy(Decimal(f"{max(factor, 1 / factor):.1g}")))
    enlarged = f", drawn {times} times {'larger' if factor > 1 else 'smaller'}" * (factor != 1)
    of_friction = [(f"friction fR{enlarged}", RED)] * bool(np.any(friction))
    return [("normal force nR", BLUE), *of_friction], to_scale


def _factor(longest: float) -> float:
    """The factor by which arrows of friction are drawn larger than others: 1, 2 or 5 times a power of ten."""
    least, most = FRICTION_ARROW
    if least <= longest <= most or not longest:
        return 1.0
    power = 10.0 ** floor(log10(most / longest))
    return max((n * power for n in (2, 5) if n * power * longest <= most), default=power)


def _draw_mass(axes: "Axes", few: Answers, place: int, end: End, tension: float, weight: float) -> bool:
    """Draw a mass at its end of the string, with its acceleration, and its forces as arrows of given lengths.

    Returns whether both forces are to scale.
    """
    scene, sub, (top, down, aside) = few.case.scene, "₁₂"[place], end
    centre = top + down * BOX / 2
    box = centre + BOX / 2 * down * np.array([1 + 1j, 1 - 1j, -1 - 1j, -1 + 1j])
    axes.fill(box.real, box.imag, fc="#e3ddcf", ec=INK, lw=1)
    axes.text(centre.real, centre.imag, f"m{sub}", ha="center", va="center")
    to_scale = _draw_arrows(axes, [top + 0.11 * aside], [-tension * down], INK)
    to_scale &= _draw_arrows(axes, [top + down * BOX], [weight * down], GREEN)
    acceleration = few["acceleration"]
    if acceleration:
        along = (-1, 1)[place] * few.case.sign * ACCELERATION_ARROW * down
        _draw_arrows(axes, [centre + 0.27 * aside - along / 2], [along], PURPLE)
    lines = (
        (f"T{sub} = {number(few[f'tension_{place + 1}'])} N", INK),
        (f"W{sub} = {number(few.round((scene.m1, scene.m2)[place] * scene.g))} N", GREEN),
        (f"a = {number(abs(acceleration))} m/s²" if acceleration else "a = 0", PURPLE),
    )
    _write_beside(axes, centre + 0.46 * aside, aside, lines)
    return to_scale


def _write_beside(axes: "Axes", place: complex, aside: complex, lines: Sequence[tuple[str, str]]) -> None:
    """Write lines, each in its colour, on one side of a place."""
    from matplotlib.offsetbox import AnnotationBbox, TextArea, VPacker

    areas: Any = [TextArea(words, textprops={"color": colour}) for words, colour in lines]
    align = (1 - aside.real) / 2, (1 - aside.imag) / 2
    corner = place - complex(WORDS_SIZE.real * align[0], WORDS_SIZE.imag * align[1])
    axes.update_datalim([(point.real, point.imag) for point in (corner, corner + WORDS_SIZE)])
    look: Any = {"box_alignment": align, "pad": 0, "frameon": False, "annotation_clip": False}
    axes.add_artist(AnnotationBbox(VPacker(children=areas, sep=3), (place.real, place.imag), **look))


def _draw_arrows(axes: "Axes", starts: Any, arrows: Any, colour: str) -> bool:
    """Draw arrows that are not 0, each long enough to be seen. Returns whether all are to scale."""
    pairs = [(start, arrow) for start, arrow in zip(starts, arrows, strict=True) if arrow]
    tails, lengths = np.array([start for start, _ in pairs], complex), [abs(arrow) for _, arrow in pairs]
    drawn = np.clip(lengths, LEAST_ARROW, MOST_WEIGHT)
    along = np.array([arrow / length for (_, arrow), length in zip(pairs, lengths, strict=True)]) * drawn
    axes.update_datalim([(point.real, point.imag) for point in (*tails, *(tails + along))])
    look: Any = {"units": "inches", "width": 1.5 / 72, "headwidth": 5, "headlength": 6, "headaxislength": 6}
    scale: Any = {"angles": "xy", "scale_units": "xy", "scale": 1, "minlength": 0}
    axes.quiver(tails.real, tails.imag, along.real, along.imag, color=colour, **look, **scale)
    return bool(np.all(drawn == lengths))


def _draw_curves(axes: "Axes", forces: Forces, wrap: float) -> None:
    """Draw normal force and friction along the arc, over grey where the string is stuck."""
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
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1), ncols=2, frameon=False, fontsize=NAME_POINTS)
