"""The machine in a picture, alone or above curves of the forces along the arc of contact.

Points and directions are complex numbers, lengths in radii of the pulley, whose axle is at 0. The arc begins
on the left, where the string of m1 hangs down, and runs clockwise over the top. Strings leave along tangents.
"""

from collections.abc import Iterator, Mapping
from fractions import Fraction
from math import pi, radians, sqrt
from typing import TYPE_CHECKING, Any, NamedTuple, cast

import numpy as np

from ..explain.contact import kind_of, point, say_profile
from ..explain.given import inputs_with_effect
from ..explain.messages import unmarked, verdict
from ..numbers.digits import SHOWN_DIGITS, format_number, strip_zeros, to_double
from ..solver import arc
from ..solver.answers import Answers
from ..solver.scene import SceneError
from .figure import BLUE, FAINT, GREEN, INK, PURPLE, RED, saved, typeset
from .forms import Picture

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LEAST, MOST_FORCE, MOST_WRAP = 1e-100, 1e100, 10**9
"""What is drawn, in N and in degrees: doubles do not determine where a greater wrap ends."""
TURN = 2 * pi
RIM_POINTS, CURVE_POINTS = 181, 200
# Lengths and places are in radii of the pulley.
LONGEST, SHORTEST = 0.84, 0.07  # of forces: in proportion within 1:12
STRING, LARGER_SIDE, LEAST_SIDE = 0.95, 0.5, 1 / 3  # of a mass; of its block; the smaller's, beside that
BETWEEN_ARROWS = radians(20)  # along the arc
LONGEST_ON_ARC, LEAST_ON_ARC = 0.9 * BETWEEN_ARROWS, 0.01
NORMAL_AT, FRICTION_AT = 1.05, 0.9  # distances from the axle at which arrows end and start
BEYOND_TIP = 0.16  # of an arrow, where its symbol stands
BETWEEN_WEIGHTS = 18  # characters for which there is room
ROTATION_AT, ACCELERATION = 0.56, 0.4  # a distance from the axle, and a length


def save_scene(answers: Answers, picture: Picture, curves: bool = False) -> None:
    """Draw the machine, and with ``curves`` the forces along the arc. Raises SceneError, OSError."""
    kind = kind_of(answers.decided) if answers.decided.light else None  # else an end is fixed to the pulley
    answers = answers.rounded_to(min(answers.digits or SHOWN_DIGITS, SHOWN_DIGITS))
    decided = answers.decided
    doubles, forces = answers.rounded_to(None), dict[str, float]()
    for end, mass in (("1", decided.scene.m1), ("2", decided.scene.m2)):
        if mass:
            forces[f"T{end}"] = float(doubles[f"tension_{end}"])
            forces[f"W{end}"] = to_double(mass * decided.scene.g)
    least = min(force for name, force in forces.items() if kind or name[0] == "W")
    wrap = float(doubles.settle(lambda m: decided.scene.wrap.degrees(m.ar)))
    if not (LEAST <= least <= max(forces.values()) <= MOST_FORCE and LEAST <= wrap <= MOST_WRAP):
        rule = f"draws forces from {LEAST} to {MOST_FORCE} N and wraps from {LEAST} to {MOST_WRAP}° only"
        raise SceneError("figure", picture.file, rule)
    if not decided.ends_hang_down:
        forces = {name: force for name, force in forces.items() if name[0] == "T"}
    scale = LONGEST / (max(forces.values()) or 1)
    lengths = {name: max(scale * force, SHORTEST) if force else 0.0 for name, force in forces.items()}
    below = [] if picture.symbols else [*_caption(answers, kind, wrap)]
    arrows = _arrows_on_arc(answers, kind, radians(wrap)) if kind else None
    if arrows and picture.symbols and kind == "creep" and not curves:  # nothing says why it acts there
        arrows = arrows._replace(friction=0 * arrows.friction)
    if arrows and (friction := abs(arrows.friction).max()):
        ratio = arrows.normal.max() / friction
        scale_of_friction = f"at {ratio:.3g} times the scale of"
        if picture.symbols:  # that number is 1/μ, which is for students to find
            scale_of_friction = f"at a {'larger' if ratio > 1 else 'smaller'} scale than"
        below.append(f"Friction is drawn {scale_of_friction} the normal force.")
    if longer := [name for name, force in forces.items() if 0 < scale * force < SHORTEST]:
        below.append(f"Drawn longer than to scale: {', '.join(longer)}.")
    given = inputs_with_effect(answers)
    above = [", ".join(given.values()), unmarked(verdict(answers))]
    heights = [1.6, 1] if curves else [1]
    with saved(picture, above, " ".join(below), len(heights)) as figure:
        machine, *more = figure.subplots(len(heights), height_ratios=heights, squeeze=False).flat
        machine.axis("off")
        machine.set_aspect("equal", adjustable="datalim")
        machine.margins(0.01)
        _draw_pulley(machine, answers, radians(wrap))
        if kind and arrows:
            _draw_contact(machine, arrows, "--" if curves else "-")
            for axes in more:
                _draw_curves(axes, answers, kind, wrap)
                if picture.symbols:
                    axes.tick_params(labelbottom=False, labelleft=False)
        if decided.ends_hang_down:
            _draw_masses(machine, answers, lengths)
        else:
            _draw_tensions(machine, lengths, radians(wrap))


def _caption(answers: Answers, kind: arc.Profile | None, wrap: float) -> Iterator[str]:
    """Yield sentences on the forces, and on what is not drawn."""
    if kind:
        yield say_profile(answers, kind)
        if force := answers["friction_force"]:
            yield f"The vector sum of friction is {format_number(force)} N."
        elif answers["friction_force_max"]:
            greatest, least = (format_number(answers[f"friction_force_{edge}"]) for edge in ("max", "min"))
            yield f"Its vector sum is the greatest that is possible, {greatest} N; the least is {least} N."
    if wrap > 360:
        turns = _number(answers.settle(lambda m: answers.decided.scene.wrap.degrees(m.ar) / 360), answers)
        which = ", and the forces on the one at the heavier mass are drawn" if kind else ""
        yield f"There are {turns} turns{which}."
    if answers.decided.is_driven and answers["drive_force"] is not None:
        yield f"The motor or the brake, {format_number(answers['drive_force'])} N at the rim, is not drawn."
    if answers.decided.has_axle_friction:
        yield "The friction of the axle is not drawn."
    if not answers.decided.ends_hang_down:
        tensions = (f"T{end} = {_number(answers[f'tension_{end}'])} N" for end in "12")
        yield f"{', '.join(tensions)}. What hangs on the string is not drawn."


def _forces(answers: Answers, kind: arc.Profile, shares: Any) -> tuple[Any, Any]:
    """Return tension and friction per radian (N) at shares of the arc; nR is the tension, too."""
    names = ("tension", "friction_per_radian")
    points = [point(answers.rounded_to(None), kind, Fraction(share), names) for share in shares]
    tension, friction = ([float(row[name]) for row in points] for name in names)
    return np.array(tension), np.array(friction)


def _rim(angle: Any) -> Any:
    """Return the place on the rim at an angle along the arc."""
    return -np.exp(-1j * angle)


def _draw_pulley(axes: "Axes", answers: Answers, phi: float) -> None:
    """Draw the pulley with its mass, how it turns, and the string around it."""
    scene, around = answers.decided.scene, _rim(np.linspace(0, TURN, RIM_POINTS))
    axes.fill(around.real, around.imag, facecolor="#f0f0f0", edgecolor=FAINT, lw=1)
    axes.plot(0, 0, "o", color=FAINT, ms=3)
    string = around if phi > TURN else _rim(np.linspace(0, phi, RIM_POINTS))
    axes.plot(string.real, string.imag, color=FAINT, lw=2.4, solid_capstyle="butt")
    for mass, end in ((scene.m1, -1 + 0j), (scene.m2, _rim(phi))):
        if not mass:
            axes.plot(end.real, end.imag, "o", color=INK, ms=6)
        elif answers.decided.ends_hang_down:
            axes.plot([end.real] * 2, [0, -STRING], color=FAINT, lw=2.4, solid_capstyle="butt")
    axes.text(0, 0.26, _pulley(answers), ha="center", va="center", size=8)
    clockwise = 1j * np.exp(-1j * np.linspace(-0.6, 0.6, 40))  # as m2 descends
    rim_acceleration = answers["rim_acceleration"]
    if rim_acceleration:
        _draw_motion(axes, ROTATION_AT * clockwise[:: 1 if rim_acceleration > 0 else -1])


def _draw_motion(axes: "Axes", path: Any) -> None:
    """Draw an arrow along points, dashed and with an open head, as it is no force."""
    axes.plot(path.real, path.imag, color=PURPLE, ls=(0, (3, 1.5)), lw=1.3)
    turned = np.angle(path[-1] - path[-2], deg=True) - 90
    axes.plot(path[-1].real, path[-1].imag, marker=(3, 0, turned), ms=7, color=PURPLE, mfc="white")


def _pulley(answers: Answers) -> str:
    """Return the pulley's inertia, as far as it is known, in words; empty if the scene leaves it open."""
    decided, scene = answers.decided, answers.decided.scene
    if decided.locked:
        return "locked"
    if scene.I is not None and scene.M is None:
        return f"I = {_number(scene.I, answers)} kg m²"
    mass = answers["critical_pulley_mass"] if decided.regime == "verge" else decided.pulley_mass
    return "" if mass is None else f"M = {_mass('M', mass, answers)}"


def _number(value: Any, answers: Answers | None = None) -> str:
    """Return a result as tables have it, or with ``answers`` an input, rounded as their results are."""
    return typeset(format_number(strip_zeros(answers.round(value)) if answers else value))


class Arrows(NamedTuple):
    """Normal force and friction (N per radian) at angles of the arc (radians)."""

    angles: Any
    normal: Any
    friction: Any


def _arrows_on_arc(answers: Answers, kind: arc.Profile, phi: float) -> Arrows:
    """Return the forces that are drawn: those over the turn at the heavier mass."""
    drawn = min(1, TURN / phi)
    count = int(drawn * phi / BETWEEN_ARROWS + 1e-9)
    both = phi < TURN  # both ends of a turn are one place
    shares = np.linspace(0, drawn, count + both, endpoint=both) if count else np.array([drawn / 2])
    if answers.decided.heavier_side >= 0:
        shares = 1 - shares
    return Arrows(phi * shares, *_forces(answers, kind, shares))


def _mass(x: str, mass: Any, answers: Answers) -> str:
    """Return a mass in the unit in which it was typed; a weight in kg."""
    unit = answers.typed(x).unit
    if unit.terms or not unit.symbol:
        return f"{_number(mass, answers)} kg"
    return f"{_number(mass / unit.size, answers)} {unit.symbol}"


def _draw_contact(axes: "Axes", arrows: Arrows, dash: str) -> None:
    """Draw the arrows of normal force and friction, with a legend."""
    angles, normal, friction = arrows
    outwards = _rim(angles)
    lengths = normal / normal.max() * LONGEST_ON_ARC
    _draw_arrows(axes, (NORMAL_AT + lengths) * outwards, -lengths * outwards, BLUE)
    axes.plot([], [], color=BLUE, marker=">", ms=4, label="normal force nR")
    if greatest := abs(friction).max():
        around = friction / greatest * LONGEST_ON_ARC * 1j * np.exp(-1j * angles)
        _draw_arrows(axes, FRICTION_AT * outwards, around, RED)
        axes.plot([], [], color=RED, ls=dash, marker=">", ms=4, label="friction fR")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, 0), ncols=2, handlelength=3)


def _draw_masses(axes: "Axes", answers: Answers, lengths: Mapping[str, float]) -> None:
    """Draw the masses that hang on the string, their forces, and their acceleration."""
    scene, acceleration = answers.decided.scene, answers["acceleration"]
    for x, end, mass in ((-1, "1", scene.m1), (1, "2", scene.m2)):
        if not mass:
            continue
        side = LARGER_SIDE * max(LEAST_SIDE, sqrt(mass / max(scene.m1, scene.m2)))
        top, bottom, pull, weight = -STRING, -STRING - side, lengths[f"T{end}"], lengths[f"W{end}"]
        axes.fill_between([x - side / 2, x + side / 2], top, bottom, fc="#e3ddcf", ec=INK, lw=1, zorder=3)
        _draw_arrows(axes, [x + top * 1j], [pull * 1j], INK)
        _draw_arrows(axes, [x + bottom * 1j], [-weight * 1j], GREEN)
        tension, force = _number(answers[f"tension_{end}"]), _number(answers.round(mass * scene.g))
        for away, height, words, colour in (
            (0.12, top + max(pull / 2, 0.17), f"T{end} = {tension} N", INK),
            (side / 2 + 0.08, (top + bottom) / 2, f"m{end} = {_mass(f'm{end}', mass, answers)}", INK),
            (0.12, bottom - max(weight / 2, 0.17), f"W{end} = {force} N", GREEN),
        ):
            look: Any = {"color": colour, "ha": "left" if x > 0 else "right", "va": "center"}
            axes.text(x * (1 + away), height, typeset(words), **look)
        if acceleration:
            centre = complex(x * (1 - side / 2 - 0.13), -STRING - LARGER_SIDE / 2)
            way = -1j * x * (1 if acceleration > 0 else -1) * ACCELERATION
            _draw_motion(axes, centre + way * np.array([-0.5, 0.5]))
    words = typeset(f"a = {_number(acceleration.copy_abs())} m/s²") if acceleration else "a = 0"
    height = -STRING - LARGER_SIDE - 0.17 - (LONGEST if len(words) > BETWEEN_WEIGHTS else 0)
    axes.text(0, height, words, color=PURPLE, ha="center", va="center")
    axes.update_datalim([(0, height - 0.1)])


def _draw_tensions(axes: "Axes", lengths: Mapping[str, float], phi: float) -> None:
    """Draw tensions along the string where it leaves the pulley, their symbols where tips have most room."""
    tips, drawn = dict[str, Any](), [np.zeros(1)]
    for name, angle, down in (("T1", 0.0, -1j), ("T2", phi, 1j)):
        if name in lengths:
            arrow = lengths[name] * down * np.exp(-1j * angle)
            _draw_arrows(axes, [_rim(angle)], [arrow], INK)
            tips[name] = _rim(angle) + arrow
    for arrows in cast(Any, axes.collections):
        tails, along = arrows.XY @ [1, 1j], arrows.U + 1j * arrows.V
        drawn.append((tails + np.linspace(0, 1, 20)[:, None] * along).ravel())
    for name, tip in tips.items():
        around = tip + BEYOND_TIP * np.exp(1j * np.linspace(0, TURN, 16))
        place = max(around[abs(around) > 1], key=lambda z: min(abs(np.concatenate(drawn) - z)))
        axes.text(place.real, place.imag, typeset(name), ha="center", va="center")
        axes.update_datalim([(place.real, place.imag)])
        drawn.append(np.array([place]))


def _draw_arrows(axes: "Axes", starts: Any, arrows: Any, colour: str) -> None:
    """Draw arrows that are long enough to be seen; the head is at most 0.4 of an arrow."""
    tails, along = (np.asarray(values)[np.abs(arrows) > LEAST_ON_ARC] for values in (starts, arrows))
    look: Any = {"units": "inches", "width": 1.3 / 72, "headwidth": 5, "headlength": 6, "headaxislength": 6}
    look |= {"minshaft": 1.5, "minlength": 0, "angles": "xy", "scale_units": "xy", "scale": 1, "zorder": 4}
    if len(tails):
        axes.update_datalim([(place.real, place.imag) for place in (*tails, *(tails + along))])
        axes.quiver(tails.real, tails.imag, along.real, along.imag, color=colour, **look)


def _draw_curves(axes: "Axes", answers: Answers, kind: arc.Profile, wrap: float) -> None:
    """Draw normal force and friction along the arc, over grey where there is no friction."""
    stuck = (
        float(answers.settle(lambda m: (m.phi - m.limiting_arc) / m.phi, to_double))
        if kind == "creep"
        else 0.0
    )
    edge, start = (stuck, 0) if answers.decided.heavier_side >= 0 else (1 - stuck, 1)
    shares = np.sort([*np.linspace(0, 1, CURVE_POINTS), *np.nextafter(edge, [0, edge, 1])])
    tension, friction = _forces(answers, kind, shares)
    axes.axhline(0, color=FAINT, lw=0.8)
    axes.plot(wrap * shares, tension, color=BLUE)
    axes.plot(wrap * shares, friction, color=RED, ls="--")
    axes.set_xlim(0, wrap)
    axes.margins(y=0.2)
    if friction.min() >= 0:
        axes.set_ylim(bottom=0)
    axes.locator_params(axis="x", nbins=8, steps=[1, 3, 4.5, 9, 10])
    axes.set_xlabel("angle θ along the arc, from m₁'s end on the left (°)")
    axes.set_ylabel("tension T = nR and\nfriction fR (N per radian)")
    if stuck:
        axes.axvspan(wrap * edge, wrap * start, color=FAINT, alpha=0.2, lw=0)
    if stuck > 0.1:  # else the word is wider
        middle, top = wrap * (edge + start) / 2, axes.get_ylim()[1]
        axes.text(middle, top, "no friction", ha="center", va="top")
