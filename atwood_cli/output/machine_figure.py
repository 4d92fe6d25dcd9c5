"""The machine in a picture: pulley, string and masses, and the forces on them as arrows.

Points and directions are complex numbers, lengths in radii of the pulley. All is drawn with m1 on the right,
where the arc begins; with m1 on the left, the axis runs the other way.
"""

from collections.abc import Callable, Sequence
from decimal import Decimal
from fractions import Fraction
from itertools import pairwise
from math import cos, floor, inf, log10, nan, pi, radians, sin, sqrt
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arithmetic.rounding import text, tidy, to_double
from ..model import arc
from ..model.machine import Machine
from ..solver.answers import Answers
from .figure import BLUE, FAINT, GREEN, INK, ORANGE, PURPLE, RED
from .labels import Label

if TYPE_CHECKING:
    from matplotlib.axes import Axes

TURNS = 4  # drawn at most: of more, so many with the same ends
TURN = 2 * pi
ALMOST_A_TURN = radians(345)
GROWTH = 0.09  # radii by which a turn of the string lies outside the one before
LONGEST, LONGEST_WEIGHT, SHORTEST, SHORTEST_WEIGHT = 0.5, 0.8, 0.05, 0.14  # of arrows
APART = radians(15)  # arrows along the arc
MOST_ARROWS = 24
SMALL, CROWDED = 0.14, 0.22
"""Of friction's longest arrow: below the first, all are drawn larger; above the second, only every other."""
RIM, INSIDE = 0.93, 0.86  # where arrows of friction and of the normal force start
WIDEST = 2.4  # from the axle to either side, but for words
SHEAVE, BOX = 0.2, 0.3  # radius and width
AXLE, ACCELERATION = 0.24, 0.36  # radius and length of the arrows of its friction, and of the acceleration
PIECES = 60  # of a turn of the string as it is drawn
NOT_TO_SCALE = "Arrows with open heads are not to scale."


class Profile(NamedTuple):
    """The forces along the arc from m1's end: pieces over which the tension is constant or exponential."""

    knots: list[float]
    """Where pieces begin and end, as shares of the arc."""
    tensions: list[float]
    """At the knots (N)."""
    mus: list[float]
    """By piece: friction over normal force, negative where the tension falls, 0 where the string is stuck."""

    @classmethod
    def of(cls, answers: Answers, kind: arc.Kind) -> "Profile":
        """That of a scene, whose pieces the model lists from the lighter mass's end."""
        stuck = arc.STUCK[kind]

        def at(piece: int, what: Callable[[Machine[Any], Any], Any]) -> float:
            return float(answers.settle(lambda m: what(m, m.arcs(kind)[piece].start)))

        knots = [at(i, lambda m, start: start.angle / m.phi) for i in range(1, len(stuck))]
        tensions = [at(i, lambda _, start: start.tension) for i in range(len(stuck))]
        heaviest = float(answers.settle(lambda m: m.heavy_tension))
        mu = float(answers.settle(lambda m: m.arc_mu(kind)))
        found = cls([0.0, *knots, 1.0], [*tensions, heaviest], [0.0 if one else mu for one in stuck])
        return found if answers.case.sign >= 0 else found.mirrored()

    def mirrored(self) -> "Profile":
        """The same from the other end."""
        knots, mus = [1 - knot for knot in reversed(self.knots)], [-mu for mu in reversed(self.mus)]
        return Profile(knots, self.tensions[::-1], mus)

    def tension(self, shares: Any) -> Any:
        """The tension (N) at shares of the arc, also the normal force per radian."""
        return np.exp(np.interp(shares, self.knots, np.log(self.tensions)))

    def friction(self, shares: Any) -> Any:
        """The friction per radian (N) at shares of the arc."""
        pieces = np.searchsorted(self.knots[1:-1], shares, side="right")
        return np.array(self.mus)[pieces] * self.tension(shares)


def drawn_turns(wrap: float) -> float:
    """How much of the string is drawn, in turns: all, or as much of a wrap (°) as ends in the same place."""
    turns = wrap / 360
    return turns if turns <= TURNS else TURNS - 1 + (wrap % 360) / 360


def draw(
    axes: "Axes", answers: Answers, shown: Answers, profile: Profile | None, wrap: float, m1_left: bool
) -> tuple[list[Label], list[str]]:
    """Draw the machine with its wrap (°); names still to be written, and what is to be said of the arrows.

    Arrows are drawn by ``answers``, in doubles, and numbers written as they are ``shown``. Without a profile,
    as where an end of the string is fixed to the pulley, there are no forces along the arc.
    """
    case, scene = answers.case, answers.case.scene
    masses = scene.m1, scene.m2
    phi = TURN * drawn_turns(wrap)
    growth = GROWTH if phi > ALMOST_A_TURN else 0.0
    outermost = 1 + growth * phi / TURN
    axes.axis("off")
    axes.set_xlim(*((WIDEST, -WIDEST) if m1_left else (-WIDEST, WIDEST)))
    foot = _draw_string(axes, phi, growth, outermost, masses)

    tensions = [float(answers[name]) for name in ("tension_1", "tension_2")]
    weights = [to_double(mass * scene.g) for mass in masses]
    scale = LONGEST / (max(tensions) or inf)
    fitting = LONGEST_WEIGHT / max(weights)
    if scale / 2 <= fitting < scale or not scale:
        scale = fitting
    names, notes = _draw_contact(axes, phi, outermost, profile, scale) if profile else ([], [])
    if friction := _axle_friction(shown):
        turned = case.sign * radians(70)
        _draw_turn(axes, AXLE, -pi / 2 + turned, -pi / 2 - turned, ORANGE)
        names.append(Label(f"axle friction\n{friction} N at the rim", 0, -AXLE, ORANGE))
    pulley = _pulley(shown)
    if phi < pi + APART:  # there are no arrows in the lower half
        axes.text(0, -0.8 if friction else -0.4, pulley, ha="center", va="center", size=10)
    elif pulley:
        names.append(Label(pulley, 0, -0.7))

    to_scale, side_of_2 = True, 1 if foot.real > 1 else -1
    for i, (top, side) in enumerate(((complex(1, foot.imag), -side_of_2), (foot, side_of_2))):
        if masses[i]:
            sub, tension, weight = "₁₂"[i], shown[f"tension_{i + 1}"], shown.round(masses[i] * scene.g)
            said = f"T{sub} = {text(tension)} N", f"W{sub} = {text(weight)} N"
            lengths = scale * tensions[i], scale * weights[i]
            to_scale &= _draw_mass(axes, f"m{sub}", top, side, lengths, said)
            _draw_acceleration(axes, top, side, (1, -1)[i] * case.sign, shown["acceleration"])
    lowest, highest = axes.dataLim.intervaly
    axes.set_ylim(lowest - 0.1, max(highest + 0.1, outermost + 0.3))
    axes.set_aspect("equal")
    return names, notes if to_scale else [*notes, NOT_TO_SCALE]


def _pulley(shown: Answers) -> str:
    """What is known of the pulley's inertia; empty where the scene leaves it open."""
    case, scene = shown.case, shown.case.scene
    if case.locked:
        return "M = inf"
    if scene.I is not None and scene.M is None:
        return f"I = {text(tidy(shown.round(scene.I)))} kg m²"
    mass = shown["critical_pulley_mass"] if case.regime == "verge" else case.pulley_mass
    return "" if mass is None else f"M = {text(tidy(shown.round(mass)))} kg"


def _axle_friction(shown: Answers) -> str:
    """The axle's friction as a force at the rim (N), as far as it acts; empty where it does not."""
    case = shown.case
    if case.axle_friction is None or case.locked or not case.sign:
        return ""
    held = case.rim_stands if case.regime == "slip" else case.axle_holds
    return text(tidy(Decimal(shown.settle(lambda m: m.difference if held else m.f))))


def _draw_contact(
    axes: "Axes", phi: float, outermost: float, profile: Profile, scale: float
) -> tuple[list[Label], list[str]]:
    """The arrows of normal force and friction along the arc; their names, and a note if scales differ."""
    shares = _arrows_along(phi)
    out = np.exp(1j * phi * shares)
    normal = scale * profile.tension(shares)
    _draw_arrows(axes, INSIDE * out, -normal * out, BLUE)
    names = _name("nR", out, normal, min(radians(60), phi / 3), outermost, BLUE)

    friction = scale * profile.friction(shares)
    factor = _factor(abs(friction).max())
    friction *= factor
    some = slice(None, None, -2 if abs(friction).max() > CROWDED and len(out) > 3 else -1)
    along = friction * 1j * out
    _draw_arrows(axes, (RIM * out - along / 2)[some], along[some], RED)
    names += _name("fR", out[some], friction[some], radians(120), outermost, RED)
    times = text(tidy(Decimal(f"{max(factor, 1 / factor):.1g}")))
    notes = [f"Friction is drawn {times} times {'larger' if factor > 1 else 'smaller'}."]
    return names, notes if factor != 1 else []


def _factor(longest: float) -> float:
    """How many times larger than other arrows those of friction are drawn: 1, 2 or 5 times a power of ten."""
    if SMALL <= longest <= LONGEST or not longest:
        return 1.0
    power = 10.0 ** floor(log10(LONGEST / longest))
    return max((n * power for n in (2, 5) if n * power * longest <= LONGEST), default=power)


def _draw_string(
    axes: "Axes", phi: float, growth: float, outermost: float, masses: tuple[Fraction, Fraction]
) -> complex:
    """Draw pulley, string and guide sheaves; the place where m2 hangs, as low as m1.

    An end without a mass is fixed to the pulley, where the arc begins or ends.
    """
    turned = np.linspace(0, phi, max(2, round(PIECES * phi / TURN)) + 1)
    wound = (1 + growth * turned / TURN) * np.exp(1j * turned)
    guided, sheaves = _route(phi % TURN or TURN, wound[-1], outermost) if masses[1] else ([wound[-1]], [])
    circle = np.exp(1j * np.linspace(0, TURN, PIECES))
    for centre, radius in [(0j, 1.0), *((sheave, SHEAVE) for sheave in sheaves)]:
        edge = centre + radius * circle
        axes.fill(edge.real, edge.imag, facecolor="#eeeeee", edgecolor=FAINT, lw=1)
        axes.plot([centre.real], [centre.imag], "o", color=FAINT, ms=4 * radius**0.3)
    lowest = min([0.0, *(sheave.imag for sheave in sheaves)])
    bottom = min(-outermost - 0.75, lowest - SHEAVE - LONGEST - 0.05)
    foot = complex(guided[-1].real, bottom)
    strings = [[1 + 1j * bottom, *wound] if masses[0] else wound, [*guided, foot] if masses[1] else []]
    for string in map(np.array, strings):
        axes.plot(string.real, string.imag, color=INK, lw=2.2, solid_capstyle="butt")
    for mass, end in zip(masses, (wound[0], wound[-1]), strict=True):
        if not mass:
            axes.plot([end.real], [end.imag], "o", color=INK, ms=8)
    return foot


def _route(turn: float, end: complex, outermost: float) -> tuple[list[complex], list[complex]]:
    """The string from the end of the arc, at an angle within a turn, to where it hangs, and its sheaves."""
    level, aside, beside = outermost + 0.45, outermost + 0.45, outermost + 0.3
    heading = 1j * _unit(turn)
    if abs(turn - pi) < 1e-9:
        return [end], []
    if turn < radians(75):  # up, over a sheave, across the pulley and over another
        far = (level - SHEAVE * (1 - sin(turn)) - end.imag) / heading.imag
        first, up = _over(end + far * heading, heading, pi / 2 - turn)
        second, down = _over(SHEAVE - aside + 1j * level, -1 + 0j, pi / 2)
        return [end, *up, *down], [first, second]
    if turn < pi:
        apart = outermost + SHEAVE + 0.05  # of the centres of pulley and sheave
        far = sqrt(apart**2 - (outermost - SHEAVE) ** 2)
        if turn < radians(105):
            far = max(far, (SHEAVE - aside - SHEAVE * cos(turn) - end.real) / heading.real)
    elif turn <= 1.5 * pi:
        far = 0.2
    else:  # behind m1's string and down beside it
        far = 0.6 if turn > radians(335) else (beside - end.real) / heading.real
    sheave, down = _over(end + far * heading, heading, pi - turn)
    return [end, *down], [sheave]


def _over(start: complex, heading: complex, turn: float) -> tuple[complex, list[complex]]:
    """The centre of a sheave that turns the string from its heading, and the string on it."""
    across = heading * (1j if turn > 0 else -1j)
    centre = start + SHEAVE * across
    return centre, [centre - SHEAVE * across * _unit(turn * i / 12) for i in range(13)]


def _unit(angle: float) -> complex:
    return complex(cos(angle), sin(angle))


def mark_theta(axes: "Axes", phi: float) -> None:
    """The angle, from m1's end of the arc onwards."""
    wide = min(phi, 1.0)
    if wide < 0.2:
        return
    axes.plot([0, 0.3], [0, 0], color=FAINT, lw=0.8)
    _draw_turn(axes, 0.17, 0, wide, INK)
    at = 0.27 * _unit(wide / 2)
    axes.text(at.real, at.imag, "θ", ha="center", va="center", size=9)


def _draw_turn(axes: "Axes", radius: float, start: float, end: float, colour: str) -> None:
    """An arrow around the axle, from one angle to another."""
    way = 1 if end > start else -1
    hidden = 0.25 * min(1.0, abs(end - start)) * (0.17 / radius)  # of the line, by the head
    line = radius * np.exp(1j * np.linspace(start, end - way * hidden, 20))
    axes.plot(line.real, line.imag, color=colour, lw=1)
    _draw_heads(axes, [(radius * _unit(end), 0.09j * way * _unit(end - 0.2 * way))], colour)


def _arrows_along(phi: float) -> Any:
    """The shares of the arc at which arrows stand: of several turns, those that are farthest apart."""
    count = int(phi / APART + 1e-9) + 1
    if 1 < count and phi <= ALMOST_A_TURN:
        return np.linspace(0, 1, count)

    def between(count: int) -> Any:
        return (np.arange(count) + 0.5) / count

    def closest(count: int) -> float:
        places: list[float] = sorted(phi * between(count) % TURN)
        return round(min(b - a for a, b in pairwise([*places, places[0] + TURN])), 2)

    if count == 1:
        return between(1)
    counts = range(12, MOST_ARROWS + 1)
    return between(max(counts, key=lambda count: (min(closest(count), APART - 0.02), count)))


def _name(words: str, out: Any, lengths: Any, near: float, outermost: float, colour: str) -> list[Label]:
    """A name outside the string at the arrow nearest to an angle, if any is to be seen."""
    seen = out[abs(lengths) >= SHORTEST]
    if not len(seen):
        return []
    at = outermost * seen[np.argmin(abs(np.angle(seen) % TURN - near))]
    return [Label(words, at.real, at.imag, colour)]


def _draw_mass(
    axes: "Axes", name: str, top: complex, side: int, lengths: tuple[float, float], said: tuple[str, str]
) -> bool:
    """The mass below its string, tension and weight beside it; whether both arrows are to scale."""
    x, y, half = top.real, top.imag, BOX / 2
    axes.fill([x - half, x + half, x + half, x - half], [y, y, y - BOX, y - BOX], fc="#e3ddcf", ec=INK, lw=1)
    axes.text(x, y - half, name, ha="center", va="center")
    forces = ((top + 0.11 * side, 1j, 0.2, INK), (top - 1j * BOX, -1j, 0.12, GREEN))
    to_scale = True
    for (start, way, off, colour), length, words in zip(forces, lengths, said, strict=True):
        drawn = min(max(length, SHORTEST_WEIGHT), LONGEST_WEIGHT) if length else 0.0
        _draw_arrows(axes, [start], [drawn * way], colour, whole=drawn == length)
        to_scale &= drawn == length
        _write_beside(axes, complex(x + off * side, start.imag + 0.24 * way.imag), side, words, colour)
    return to_scale


def _draw_acceleration(axes: "Axes", top: complex, side: int, up: int, a: Decimal) -> None:
    """The acceleration beside a mass: how much, and an arrow that says which way."""
    at, way = top - 0.5j * BOX + 0.27 * side, 1j * ACCELERATION * up if a else 0j
    _draw_arrows(axes, [at - way / 2], [way], PURPLE)
    words = f"a = {text(abs(a))} m/s²" if a else "a = 0"
    _write_beside(axes, at + 0.09 * side, side, words, PURPLE)


def _write_beside(axes: "Axes", at: complex, side: int, words: str, colour: str) -> None:
    """Write words that begin at a place, or end there if they are on the left."""
    left = (side > 0) == axes.xaxis_inverted()
    axes.text(at.real, at.imag, words, ha="right" if left else "left", va="center", color=colour)


def _draw_arrows(
    axes: "Axes", starts: Sequence[complex], arrows: Sequence[complex], colour: str, whole: bool = True
) -> None:
    """Arrows from some points, but for those that are too short to be seen; open if not drawn whole."""
    heads, line = [], list[complex]()
    for start, arrow in zip(starts, arrows, strict=True):
        if (length := abs(arrow)) >= SHORTEST:
            tip, head = start + arrow, arrow / length * min(0.12, 0.75 * length)
            line += [start, tip - (0.4 if whole else 1) * head, complex(nan, nan)]
            heads.append((tip, head))
    if heads:
        points = np.array(line)
        axes.plot(points.real, points.imag, color=colour, lw=1.5, solid_capstyle="butt")
        _draw_heads(axes, heads, colour, whole)


def _draw_heads(
    axes: "Axes", heads: Sequence[tuple[complex, complex]], colour: str, whole: bool = True
) -> None:
    """Heads of arrows: their tips, and the way from foot to tip."""
    from matplotlib.collections import PolyCollection

    corners = [(tip, tip - head * (1 + 0.36j), tip - head * (1 - 0.36j)) for tip, head in heads]
    triangles = [[(corner.real, corner.imag) for corner in three] for three in corners]
    face, width = (colour, 0) if whole else ("white", 1)
    axes.add_collection(PolyCollection(triangles, facecolor=face, edgecolor=colour, lw=width, zorder=3))
