"""The machine in a picture: pulley, string and masses, and the forces on them as arrows.

All is drawn with m1 on the right, where the arc begins; with m1 on the left, the axes run the other way.
"""

from collections.abc import Callable, Iterable, Sequence
from decimal import Decimal
from fractions import Fraction
from math import cos, nan, pi, radians, sin, sqrt
from operator import attrgetter
from typing import TYPE_CHECKING, Any, NamedTuple

from ..arithmetic.rounding import text, to_double
from ..derivation.typeset import number_in_latex
from ..model import arc
from ..model.machine import Machine
from ..solver.answers import Answers
from ..solver.contact import contact
from .figure import BLUE, FAINT, GREEN, INK, RED
from .labels import Label

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Point = tuple[float, float]
Arrow = tuple[Point, Point, float]
"""From where, in which direction, how long."""

TURNS = 4  # drawn at most: of more, so many with the same ends
TURN = 2 * pi
ALMOST_A_TURN = radians(345)
GROWTH = 0.09  # radii by which a turn of the string lies outside the one before
LONGEST, LONGEST_WEIGHT, SHORTEST = 0.5, 0.8, 0.05  # radii: arrows
APART = radians(15)  # arrows along the arc
MOST_ARROWS = 24
CROWDED = 0.22  # radii: where friction's arrows are longer, there is one for every second of the others
RIM, INSIDE = 0.93, 0.86  # radii: where arrows of friction and of the normal force start
SHEAVE, BOX = 0.2, 0.3  # radii
PIECES = 60  # of a turn of the string as it is drawn


class Route(NamedTuple):
    """The string from the end of the arc to where it hangs down, and the sheaves that guide it there."""

    string: list[Point]
    sheaves: list[Point]


def drawn_turns(wrap: float) -> float:
    """How much of the string is drawn, in turns: all, or as much of a wrap (°) as ends in the same place."""
    turns = wrap / 360
    return turns if turns <= TURNS else TURNS - 1 + (wrap % 360) / 360


class Numbers:
    """The numbers of a picture, each said once: what is as large as another is said to be."""

    def __init__(self, answers: Answers) -> None:
        self.answers = answers
        self._said: dict[Decimal, tuple[str, Fraction | None]] = {}

    def tension(self, name: str) -> str:
        """The tension of the string at a mass."""
        return self._say(f"T_{name}", attrgetter(f"tension_{name}"))

    def weight(self, name: str) -> str:
        """The weight of a mass."""
        scene = self.answers.case.scene
        weight: Fraction = getattr(scene, f"m{name}") * scene.g
        return self._say(f"W_{name}", lambda m: m.ar.number(weight))

    def net_friction(self, kind: arc.Kind) -> list[str]:
        """What all the friction on the pulley amounts to, if there is any."""
        if self.answers.case.frictionless:
            return []

        def net(m: Machine[Any]) -> Any:
            x, y = arc.friction(m.arcs(kind))
            return m.ar.sqrt(x * x + y * y)

        return [f"All friction on the pulley together is the force {self._say('F', net)}."]

    def turns(self, wrap: float) -> list[str]:
        """How much of the string is drawn, if not all."""
        if wrap <= 360 * TURNS:
            return []
        turns = self._rounded(lambda m: self.answers.case.scene.wrap.degrees(m.ar, Fraction(1, 360)))
        return [f"Of the string's {turns} turns a few are drawn."]

    def angle(self, at: Callable[[Machine[Any]], Any]) -> str:
        """An angle, of which a machine has the radians."""
        return f"{self._rounded(lambda m: at(m) * 180 / m.ar.pi)}°"

    def _rounded(self, quantity: Callable[[Machine[Any]], Any]) -> str:
        return _typeset(self.answers.settle(quantity))

    def _say(self, symbol: str, quantity: Callable[[Machine[Any]], Any]) -> str:
        value, exact = Decimal(self.answers.settle(quantity)), self.answers.exactly(quantity)
        if value not in self._said:
            self._said[value] = symbol, exact
            return f"${symbol}$ = {_typeset(value)} N"
        other, equal = self._said[value]
        return f"${symbol}$ {'=' if exact is not None and exact == equal else '≈'} ${other}$"


def _typeset(value: float | Decimal) -> str:
    digits = text(value)
    return f"${number_in_latex(digits).replace(' ', '')}$" if "e" in digits else digits


def draw(
    axes: "Axes", answers: Answers, kind: str | None, numbers: "Numbers", m1_left: bool
) -> tuple[list[Label], bool]:
    """Draw the machine; names still to be written, and whether an arrow would be longer than it is drawn."""
    case = answers.case
    wrap = float(answers.settle(lambda m: case.scene.wrap.degrees(m.ar)))
    phi = TURN * drawn_turns(wrap)
    growth = GROWTH if phi > ALMOST_A_TURN else 0.0
    outermost = 1 + growth * phi / TURN
    axes.axis("off")
    foot = _draw_string(axes, phi, growth, outermost)

    count = _arrows_along(phi)
    ends = phi <= ALMOST_A_TURN and count > 1
    points = (
        contact(answers, count, kind).points if ends else contact(answers, 2 * count + 1, kind).points[1::2]
    )
    shares = [i / (count - 1) if ends else (2 * i + 1) / (2 * count) for i in range(count)]
    angles = [phi * share for share in shares]
    forces = [[float(point[f"{name}_per_radian"]) for point in points] for name in ("normal", "friction")]
    scale = LONGEST / max(*forces[0], *(float(answers[f"tension_{i}"]) for i in (1, 2)))
    normal, friction = ([scale * force for force in along] for along in forces)
    _normal_arrows(axes, angles, normal)
    last_first = slice(None, None, -2 if max(map(abs, friction)) > CROWDED and count > 3 else -1)
    clipped = _friction_arrows(axes, angles[last_first], friction[last_first])
    names = _name("$nR$", angles, normal, min(radians(60), phi / 3), outermost, BLUE)
    names += _name("$fR$", angles[last_first], friction[last_first], radians(120), outermost, RED)
    _mark_theta(axes, phi)

    right = foot[0] > 1  # of m1
    for name, x, side in (("1", 1.0, -1 if right else 1), ("2", foot[0], 1 if right else -1)):
        clipped |= _mass(axes, answers, name, (x, foot[1]), scale, side, numbers, m1_left)
    axes.set_ylim(foot[1] - BOX - LONGEST_WEIGHT - 0.1, outermost + 0.6)
    axes.set_xlim(*((2.4, -2.4) if m1_left else (-2.4, 2.4)))
    axes.set_aspect("equal", adjustable="datalim")
    return names, clipped


def _draw_string(axes: "Axes", phi: float, growth: float, outermost: float) -> Point:
    """Draw pulley, string and guide sheaves; where m2 hangs, and m1 as low."""
    steps = max(2, round(PIECES * phi / TURN))
    wound = [_polar(1 + growth * phi * i / steps / TURN, phi * i / steps) for i in range(steps + 1)]
    route = _route(phi % TURN or TURN, wound[-1], outermost)
    for centre, radius in [((0.0, 0.0), 1.0), *((sheave, SHEAVE) for sheave in route.sheaves)]:
        axes.fill(*_circle(centre, radius), facecolor="#eeeeee", edgecolor=FAINT, lw=1)
        axes.plot(*zip(centre, strict=True), "o", color=FAINT, ms=4 * radius**0.3)
    x, lowest = route.string[-1][0], min([0.0, *(y for _, y in route.sheaves)])
    bottom = min(-outermost - 0.75, lowest - SHEAVE - LONGEST - 0.05)
    for string in ([(1.0, bottom), *wound], [*route.string, (x, bottom)]):
        axes.plot(*zip(*string, strict=True), color=INK, lw=2.2, solid_capstyle="butt")
    return x, bottom


def _mark_theta(axes: "Axes", phi: float) -> None:
    """The angle, from m1's end of the arc onwards."""
    wide = min(phi, 1.0)
    if wide < 0.2:
        return
    axes.plot([0, 0.3], [0, 0], color=FAINT, lw=0.8)
    axes.plot(*zip(*(_polar(0.17, wide * i / 12) for i in range(10)), strict=True), color=INK, lw=1)
    tip, along = _polar(0.17, wide), _polar(1, wide + pi / 2 - 0.2)
    _heads(axes, [(tip, along, 0.09)], INK)
    axes.text(*_polar(0.27, wide / 2), r"$\theta$", ha="center", va="center", size=9)


def _arrows_along(phi: float) -> int:
    """How many arrows stand along the arc: of several turns, as many as are farthest apart."""
    if phi < APART:
        return 1
    if phi <= ALMOST_A_TURN:
        return int(phi / APART + 1e-9) + 1

    def gap(count: int) -> float:
        places = sorted(phi * (2 * i + 1) / (2 * count) % TURN for i in range(count))
        return round(min(b - a for a, b in zip(places, [*places[1:], places[0] + TURN], strict=True)), 2)

    return max(range(12, MOST_ARROWS + 1), key=lambda count: (min(gap(count), APART - 0.02), count))


def _normal_arrows(axes: "Axes", angles: Sequence[float], lengths: Sequence[float]) -> None:
    """The arrows of nR, from the rim inwards."""
    there = zip(angles, lengths, strict=True)
    _arrows(axes, [(_polar(INSIDE, angle), _polar(-1, angle), length) for angle, length in there], BLUE)


def _friction_arrows(axes: "Axes", angles: Sequence[float], lengths: Sequence[float]) -> bool:
    """The arrows of fR, along the rim; whether one would be longer than it is drawn."""
    whole, clipped = list[Arrow](), list[Arrow]()
    for angle, length in zip(angles, lengths, strict=True):
        shown, along = max(-LONGEST, min(length, LONGEST)), _polar(1, angle + pi / 2)
        start = _beyond(_polar(RIM, angle), along, -shown / 2)
        (whole if shown == length else clipped).append((start, along, shown))
    _arrows(axes, whole, RED)
    _arrows(axes, clipped, RED, "--")
    return bool(clipped)


def _name(
    words: str, angles: Sequence[float], lengths: Sequence[float], near: float, outermost: float, colour: str
) -> list[Label]:
    """A name outside the string at the arrow nearest to an angle, if any is to be seen."""
    seen = [
        (abs(angle % TURN - near), angle)
        for angle, length in zip(angles, lengths, strict=True)
        if abs(length) >= SHORTEST
    ]
    return [Label(words, *_polar(outermost, min(seen)[1]), colour)] if seen else []


def _route(turn: float, end: Point, outermost: float) -> Route:
    """How the string gets from the end of the arc, at that angle within a turn, to where it hangs down."""
    level, aside, beside = outermost + 0.45, outermost + 0.45, outermost + 0.3
    heading = turn + pi / 2
    along = _polar(1, heading)
    if abs(turn - pi) < 1e-9:
        return Route([end], [])
    if turn < radians(75):  # up, over a sheave, across the pulley and over another
        far = (level - SHEAVE * (1 - sin(turn)) - end[1]) / along[1]
        first, up = _over(_beyond(end, along, far), heading, pi / 2 - turn)
        second, down = _over((SHEAVE - aside, level), pi, pi / 2)
        return Route([end, *up, *down], [first, second])
    if turn < pi:
        apart = outermost + SHEAVE + 0.05  # of the centres of pulley and sheave
        far = sqrt(apart**2 - (outermost - SHEAVE) ** 2)
        if turn < radians(105):
            far = max(far, (SHEAVE - aside - SHEAVE * cos(turn) - end[0]) / along[0])
    elif turn <= 1.5 * pi:
        far = 0.2
    else:  # behind m1's string and down beside it
        far = 0.6 if turn > radians(335) else (beside - end[0]) / along[0]
    sheave, down = _over(_beyond(end, along, far), heading, pi - turn)
    return Route([end, *down], [sheave])


def _over(start: Point, heading: float, turn: float) -> tuple[Point, list[Point]]:
    """The centre of a sheave that turns the string from its heading, and the string on it."""
    side = pi / 2 if turn > 0 else -pi / 2
    centre = _beyond(start, _polar(1, heading + side), SHEAVE)
    steps = range(13)
    return centre, [_beyond(centre, _polar(1, heading + turn * i / 12 - side), SHEAVE) for i in steps]


def _mass(
    axes: "Axes",
    answers: Answers,
    name: str,
    top: Point,
    scale: float,
    side: int,
    numbers: "Numbers",
    m1_left: bool,
) -> bool:
    """The mass below its string, tension and weight beside it; whether that is more than is drawn."""
    (x, y), half = top, BOX / 2
    axes.fill([x - half, x + half, x + half, x - half], [y, y, y - BOX, y - BOX], fc="#e3ddcf", ec=INK, lw=1)
    axes.text(x, y - half, f"$m_{name}$", ha="center", va="center")
    beside = "left" if (side > 0) != m1_left else "right"
    tension = scale * float(answers[f"tension_{name}"])
    weight = scale * to_double(getattr(answers.case.scene, f"m{name}") * answers.case.scene.g)
    _arrows(axes, [((x + 0.11 * side, y), (0, 1), tension)], INK)
    axes.text(x + 0.2 * side, y + 0.24, numbers.tension(name), ha=beside, va="center", color=INK)
    clipped = weight > LONGEST_WEIGHT
    _arrows(axes, [((x, y - BOX), (0, -1), min(weight, LONGEST_WEIGHT))], GREEN, "--" if clipped else "-")
    axes.text(x + 0.12 * side, y - BOX - 0.24, numbers.weight(name), ha=beside, va="center", color=GREEN)
    return clipped


def _arrows(axes: "Axes", arrows: Iterable[Arrow], colour: str, style: str = "-") -> None:
    """Arrows, each from a point in a direction, as long as is told; none where it would not be seen."""
    heads, xs, ys = [], list[float](), list[float]()
    for start, direction, length in arrows:
        if abs(length) < SHORTEST:
            continue
        way = direction if length > 0 else (-direction[0], -direction[1])
        tip, head = _beyond(start, way, abs(length)), min(0.12, 0.75 * abs(length))
        neck = _beyond(tip, way, -0.4 * head)
        xs += [start[0], neck[0], nan]
        ys += [start[1], neck[1], nan]
        heads.append((tip, way, head))
    if heads:
        axes.plot(xs, ys, color=colour, lw=1.5, ls=style, solid_capstyle="butt")
        _heads(axes, heads, colour)


def _heads(axes: "Axes", heads: Sequence[Arrow], colour: str) -> None:
    """Heads of arrows: tip, direction, length."""
    from matplotlib.collections import PolyCollection

    triangles = []
    for tip, way, length in heads:
        foot, across = _beyond(tip, way, -length), (-way[1], way[0])
        triangles.append([tip, _beyond(foot, across, 0.36 * length), _beyond(foot, across, -0.36 * length)])
    axes.add_collection(PolyCollection(triangles, color=colour, lw=0, zorder=3))


def _polar(radius: float, angle: float) -> Point:
    return radius * cos(angle), radius * sin(angle)


def _beyond(point: Point, direction: Point, distance: float) -> Point:
    return point[0] + distance * direction[0], point[1] + distance * direction[1]


def _circle(centre: Point, radius: float) -> tuple[list[float], list[float]]:
    points = [_beyond(centre, _polar(1, TURN * i / PIECES), radius) for i in range(PIECES)]
    return [x for x, _ in points], [y for _, y in points]
