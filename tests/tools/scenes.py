"""Seeded scenes of every stress family, as the texts that a user would type."""

import cmath
import re
from collections.abc import Callable, Iterator, Mapping
from decimal import ROUND_DOWN, Context, Decimal
from fractions import Fraction
from math import degrees, exp, expm1, inf, ldexp, log, log1p, nextafter, pi, radians, ulp
from random import Random
from typing import Any

import flint

from atwood_cli.reading.inputs import read_exactly
from atwood_cli.solver.answers import Answers
from atwood_cli.solver.decisions import Decisions
from atwood_cli.solver.scene import FALL, INPUTS, MASSES, Scene

from . import oracle

Given = dict[str, str]


def table(words: str) -> list[list[str]]:
    """The rows of a table, with bars between cells; an indented line goes on with the row above it."""
    rows = re.sub(r"\n\s+", " ", words.strip("\n")).splitlines()
    return [[cell.strip() for cell in row.split("|")] for row in rows]


def read_scene(given: Mapping[str, Any]) -> Scene:
    """The scene of inputs by name."""
    return Scene.of({name: read_exactly(name, given.get(name)) for name in INPUTS})


def inputs(words: str) -> dict[str, Any]:
    """What is given, from words such as "m1=1 M=None"; m1 is 1 and m2 is 3 if they are not named."""
    given = dict(word.split("=", 1) for word in words.split())
    return {"m1": "1", "m2": "3", **{name: None if x == "None" else x for name, x in given.items()}}


# A scene of every kind, by what is said of it.
# With c = 5 and g = 9 masses of 1 and 3 have a = 2, and a = 1 beside an axle with 9 N.
KINDS = """
massless |
no mass | M=0
given pulley | M=10
hoop | M=10 inertia=hoop g=moon
a hub | M=10 inertia=2.5 mu=0.1 mu_k=0.05
locked | M=inf
equal | m2=1 M=3 mu=0.1 R=1
nearly equal | m2=1.00000001 M=3 mu=0.1
equal and missing | m2=1 mu=0.1
equal on a locked pulley | m2=1 M=inf
free end | m1=0 m2=1 M=1
free end, massless | m1=0
verge | mu=0.3
no critical mass | mu=0.4
kinetic and missing | mu=0.4 mu_k=0.1
grips | M=10 mu=0.3
grips on two thirds of a turn | M=10 mu=0.3 wrap=240
grips on a long wrap | M=10 mu=0.3 wrap=540
grips on radians | M=10 mu=0.9 wrap=2rad
caught | M=10 mu=0.3 mu_k=0.25
slides on | M=10 mu=0.3 mu_k=0.1
slips | M=100 mu=0.3 mu_k=0.25 R=0.1
slides without friction | M=100 mu=0.3 mu_k=0
locked and slips | M=inf mu=0.2 wrap=1rad
locked and grips | M=inf mu=0.4
no friction, no pulley | mu=0
no friction | mu=0 M=5
massless, rough | M=0 mu=0.2
mirror | m1=3 m2=1 M=50 mu=0.3 R=0.1
far apart | m1=1e-30 m2=3e30 M=1e-5 mu=1e3
inertia | M=50 mu=0.3 R=0.1 I=0.8 wrap=100
inertia alone | mu=0.3 R=0.1 I=0.3
inertia beside an axle | I=0.3 R=0.1 axle=1Nm mu=0.4
an axle alone | axle=5
an axle that rubs | M=10 axle=5 R=0.1
an axle that holds | M=10 R=0.1 axle=2.5Nm
an axle that holds a free end | m1=0 m2=1 axle=12
an axle of grams | m2=1.1 M=2 mu=0.4 axle=5
an axle that is a note | m2=50 M=3 mu=0.2 axle=3
an axle beside a lock | M=inf axle=30
grips beside an axle | M=10 mu=0.3 axle=5
slips beside an axle | m1=3 m2=1 M=300 mu=0.2 axle=5
verge beside an axle | mu=0.2 axle=5
always slips beside an axle | mu=0.05 axle=5
slips on an axle that holds | mu=0.05 axle=1.2Nm R=0.05 M=1
driven | M=10 R=0.2 a=-1 find=drive
driven against gravity | M=10 R=0.2 axle=5 mu=0.9 a=4 find=drive wrap=200
driven the other way | M=10 R=0.2 axle=5 a=-0.2g mu=0.1 find=drive
held by a brake | m1=3 m2=1 M=10 mu=0.5 a=0 find=drive
driven at equal tensions | m2=1 I=0.2 R=0.2 a=0 mu=0.5 find=drive
a drum | m1=0 M=10 R=0.2 a=-1 find=drive
driven from rest | M=10 R=0.2 drop=-2 time=3 find=drive
a lift that rises steadily | M=10 axle=5 a=0 speed=-2 find=drive
a lift that comes down steadily | m1=3 m2=1 M=10 axle=5 a=0 drop=2 find=drive
a motor after a time | M=10 a=1 time=3 find=drive
driven, of any pulley | m1=3 m2=1 mu=0.5 a=1 find=drive
falls and turns | M=10 R=0.2 drop=2
slips and turns | m1=3 m2=1 M=300 mu=0.1 R=0.2 drop=2
nothing but the axle tells the motion | m2=0.3 mu=3 mu_k=2.5 axle=1e300
finds the pulley | g=9 drop=9 time=3 R=0.1
finds gravity | M=10 a=2
finds gravity beside an axle | M=10 a=1 axle=0.9Nm R=0.1
finds an axle that slows down | M=10 R=0.1 a=-0.2 find=axle
finds the axle of equal masses | m2=1 M=2 a=0.02rad/s2 R=0.1 find=axle
finds a weight's partner by speed and time | m2=20N M=1 R=0.1 speed=4rad/s time=2 m1=None
finds the pulley by speed and height | m1=20N m2=3N drop=2 speed=1
falls from rest | m1=3 m2=1 M=5N speed=2
finds the heavier mass | m2=None M=10 g=9 a=2
finds the lighter mass | m1=3 m2=None M=10 g=9 a=-1 axle=9
finds an equal mass | m2=None M=10 a=0
finds kinetic friction | M=inf g=10 a=2 drop=4
finds no kinetic friction | m1=3 m2=1 M=100 mu=0.2 g=10 a=-5
falls | M=10 g=9 drop=9 mu=0.3
"""


def _log_uniform(rng: Random, low: float, high: float) -> float:
    return 10 ** rng.uniform(low, high)


def _text(rng: Random, x: float) -> str:
    """Sometimes all seventeen digits, sometimes as few as people type."""
    return rng.choice([repr, "{:.3g}".format, "{:.6e}".format])(x)


def ordinary(rng: Random) -> Given:
    m1 = _log_uniform(rng, -2, 2)
    m2 = m1 * (1 + rng.choice([0, *[_log_uniform(rng, -2, 2)] * 15]))
    scene = {"m1": _text(rng, m1), "m2": _text(rng, m2)}
    given = rng.choice(["", "M", "mu", "M mu", "M mu", "M mu mu_k"])
    if "M" in given:
        scene["M"] = rng.choice(["0", "inf", *[_text(rng, _log_uniform(rng, -2, 3))] * 13])
    if "mu" in given:
        mu = rng.choice([0.0, *[_log_uniform(rng, -2, 0.3)] * 14])
        scene["mu"] = repr(mu)
        if "mu_k" in given:
            scene["mu_k"] = repr(mu * rng.random())
    return scene


def nearly_equal(rng: Random) -> Given:
    m1 = _log_uniform(rng, -2, 2)
    offset = _log_uniform(rng, -17, -2)
    # Decimal text, so that the masses may differ in the 20th digit.
    m2 = f"{m1!r}{'' if 'e' in repr(m1) else '0' * 4}" if offset < 1e-15 else repr(m1 * (1 + offset))
    scene = {"m1": repr(m1), "m2": m2 if "e" in m2 else m2 + "1"}
    scene["M"] = repr(_log_uniform(rng, -2, 3))
    if rng.random() < 0.6:
        scene["mu"] = repr(_log_uniform(rng, -18, -2))
    return scene


def light_pulley(rng: Random) -> Given:
    scene = ordinary(rng) | {"M": repr(_log_uniform(rng, -300, -3))}
    if rng.random() < 0.5:
        scene["mu"] = repr(_log_uniform(rng, -300, -3))
        scene.pop("mu_k", None)
    return scene


def near_critical(rng: Random) -> Given:
    """Within 1e-15 to 1e-3 of the critical pulley mass, or of m2 = m1 k, on both sides."""
    flint.ctx.prec = 400
    m1 = _log_uniform(rng, -2, 2)
    mu = _log_uniform(rng, -2, 0)
    k = (flint.arb(mu) * flint.arb.pi()).exp()
    off = flint.arb(rng.choice([-1, 1]) * _log_uniform(rng, -15, -3)) + 1
    digits = rng.choice([17, 17, 40])
    if rng.random() < 0.3:
        m2 = (flint.arb(m1) * k * off).str(digits, radius=False)
        scene = {"m1": repr(m1), "m2": m2, "mu": repr(mu)}
        if rng.random() < 0.5:
            scene["M"] = repr(_log_uniform(rng, 0, 17))
        return scene
    heavier = float(m1 * k.mid()) * (1 + _log_uniform(rng, -3, 1))
    a, b = flint.arb(m1), flint.arb(heavier)
    critical = 4 * a * b * (k - 1) / (b - a * k) * off
    return {
        "m1": repr(m1),
        "m2": repr(heavier),
        "mu": repr(mu),
        "M": critical.str(digits, radius=False).replace("e+", "e"),
    }


def whole_range(rng: Random) -> Given:
    def anything() -> str:
        return f"{rng.randint(1, 9)}.{rng.randint(0, 10**16)}e{rng.randint(-323, 308)}"

    scene = {"m1": anything(), "m2": anything(), "g": anything()}
    if rng.random() < 0.8:
        scene["M"] = anything()
    if rng.random() < 0.8:
        scene["mu"] = rng.choice([anything(), repr(_log_uniform(rng, -3, 3))])
    return scene


FAMILIES: dict[str, Callable[[Random], Given]] = {
    f.__name__: f for f in (ordinary, nearly_equal, light_pulley, near_critical, whole_range)
}
ON_AN_AXLE, MEASURED, LACKING, FALLING = " on an axle", " measured", " without masses", " falling"


def _vary(rng: Random, scene: Given) -> Given:
    """What any family may have on top: mirrored, another gravity, pulley or wrap."""
    if rng.random() < 0.5:
        scene |= {"m1": scene["m2"], "m2": scene["m1"]}
    if rng.random() < 0.3:
        scene["R"] = repr(_log_uniform(rng, -3, 1))
    if rng.random() < 0.2:
        scene.setdefault("g", rng.choice(["moon", "9.81", "1.6e-300"]))
    if rng.random() < 0.2:
        if "R" in scene and scene.get("M") not in ("0", "inf") and rng.random() < 0.5:
            scene["I"] = repr(_log_uniform(rng, -4, 3))
            if rng.random() < 0.5:
                scene.pop("M", None)
        else:
            scene["inertia"] = rng.choice(["hoop", "shell", repr(rng.random() + 0.01)])
    if rng.random() < 0.15:
        scene["wrap"] = rng.choice(["90", "360", "540", "720", "100", "270", "17.5"])
    return scene


def scenes(family: str, count: int, seed: int = 2026) -> Iterator[Given]:
    """Scenes of a family, with what its name says: an axle that rubs, and one more thing; or of a danger."""
    rng, usual = Random(f"{family} {seed}"), family
    for more in (*VARIED, ON_AN_AXLE):
        usual = usual.removesuffix(more)
    for _ in range(count):
        given = _vary(rng, FAMILIES[usual](rng)) if usual in FAMILIES else typed(DANGERS[family](rng))
        given = with_axle(rng, given) if ON_AN_AXLE in family else given
        changed = [change(rng, given) for more, change in VARIED.items() if family.endswith(more)]
        yield changed[0] if changed else given


def without_masses(rng: Random, given: Given) -> Given:
    """The scene with friction, and without a mass or both."""
    lacking = rng.choice([["m1"], ["m2"], ["m1", "m2"]])
    kept = {name: text for name, text in given.items() if name not in lacking}
    return {"mu": repr(_log_uniform(rng, -3, 0.3))} | kept


def falling(rng: Random, given: Given) -> Given:
    """The scene with the height, the time or the speed of a fall."""
    return given | {rng.choice(FALL): _text(rng, _log_uniform(rng, -3, 3))}


def driven(rng: Random, given: Given) -> Given:
    """The scene in a motion that a motor or a brake gives, slower than free fall."""
    given = {name: text for name, text in given.items() if (name, text) != ("M", "inf")}
    a = read_scene(given).g * Fraction(
        rng.choice([0, *[rng.choice([-1, 1]) * 10 ** -rng.uniform(0.01, 6)] * 6])
    )
    a, time = (
        Fraction(Context(prec=17).create_decimal(Decimal(float(a)))),
        Fraction(rng.randint(1, 10**6), 10**3),
    )
    fall = {"drop": a * time**2 / 2, "time": time, "speed": a * time}
    measured = {x: fall[x] for x in rng.sample(FALL, 2)} if a and rng.random() < 0.4 else {"a": a}
    if "a" in measured and rng.random() < 0.4:
        measured[rng.choice(FALL[:: 1 if a else 2])] = time if a else rng.choice([-1, 1]) * time
    return (
        given
        | {x: f"{value.numerator}/{value.denominator}" for x, value in measured.items()}
        | {"find": "drive"}
    )


def with_motion(rng: Random, given: Given) -> Given:
    """The scene with one number of a fall from rest; or with a motion, and without the input that this finds."""
    if rng.random() < 0.2:
        return driven(rng, given)
    given = given | ({"m2": given["m1"]} if rng.random() < 0.05 else {})
    free = {name: text for name, text in given.items() if name not in ("mu", "mu_k")}
    scene, kept = read_scene(free), oracle.expected(read_scene(given))
    l, h, g, M = *sorted((scene.m1, scene.m2)), scene.g, scene.M
    way, most = oracle.side(scene.m2 - scene.m1), g * (h - l) / (h + l)
    a = abs(oracle.expected(scene)["acceleration"])
    time, part = Fraction(_text(rng, _log_uniform(rng, -2, 2))), Fraction(10 ** rng.uniform(-9, 0))
    share = rng.choice([Fraction(1), part])
    finds_mass = (a or scene.axle is None) and (M or scene.I) and M != inf
    motions: dict[str, Any] = {  # by what they find, of the heavier mass
        "M": a * share if a and M and scene.I is None and M != inf else None,
        "g": a * part * 1000 if a and (M or scene.I) else None,
        **dict.fromkeys(MASSES, a * share if finds_mass else None),
        "axle": a - (a + g) * part / 2 if M != inf else None,
        "mu_k": most * share if M == inf and way else None,
    }
    if kept["regime"] == "slip" and M is not None:
        least = Fraction(oracle.correctly_rounded(kept["acceleration"], 40)) * way
        motions["mu_k"] = least + (most - least) * part if most - least > most / 10**15 else None
    finds, a = rng.choice([("", None), *((x, a) for x, a in motions.items() if a is not None)])
    sign, signed = way or rng.choice([-1, 1]), finds in MASSES
    if signed and a and rng.random() < 0.2:  # the other one is an end that is fixed to the pulley
        sign, signed, free["m1"], free["m2"] = {"m1": -1, "m2": 1}[finds], False, "0", "0"
    if a is None or (a and not 1e-200 < abs(a) < 1e200):
        return falling(rng, given)
    if a.denominator > 10**300 or rng.random() < 0.5:  # so that it can be typed
        context = Context(prec=40 if finds == "mu_k" else rng.choice([2, 17]), rounding=ROUND_DOWN)
        a = Fraction(context.divide(Decimal(a.numerator), Decimal(a.denominator)))
    measured = {"a": sign * a, **({rng.choice(FALL): time} if rng.random() < 0.3 else {})}
    if (a > 0 and way) and rng.random() < 0.6:
        fall = {"drop": a * time**2 / 2, "time": time, "speed": a * time}
        measured = {x: fall[x] * (sign if signed and x != "time" else 1) for x in rng.sample(FALL, 2)}
    free.pop(finds, None)
    if finds == "mu_k" and kept["regime"] == "slip":
        free["mu"] = given["mu"]
    found = {"find": finds} if finds == "axle" or rng.random() < 0.2 else {}
    return free | {x: f"{value.numerator}/{value.denominator}" for x, value in measured.items()} | found


VARIED = {MEASURED: with_motion, LACKING: without_masses, FALLING: falling}


def as_doubles(given: Given) -> Given | None:
    """A scene whose numbers are the doubles nearest to those of this one; None if that is no such scene."""
    scene = read_scene(given)
    numbers = {x: getattr(scene, x) for x in INPUTS}
    numbers |= {"wrap": scene.wrap.number, "axle": Decisions(scene).axle_friction}
    numbers |= {x: Fraction(given[x]) for x in FALL if x in given}
    try:
        row = {name: float(value) for name, value in numbers.items() if value is not None}
    except OverflowError:
        return None
    if not all(row.get(name, 1) for name in ("m1", "m2", "g", "I")):
        return None
    return typed(row)


def with_axle(rng: Random, given: Given) -> Given:
    """The scene with an axle: of no matter, or such that it decides; as a torque now and then."""
    scene = read_scene(given)
    l, h = sorted((scene.m1, scene.m2))
    g = scene.g
    limits = [g * (h - l), g * l, g * h]
    if isinstance(scene.M, Fraction) and scene.inertia is not None:
        limits.append(g * scene.M * scene.inertia)
    f = rng.choice(limits) * Fraction(10 ** rng.uniform(-3, 0.5))
    if rng.random() < 0.3:  # just about what it holds
        f = g * (h - l) * (1 + rng.choice([-1, 0, 1]) * Fraction(10 ** rng.uniform(-25, -2)))
    if scene.mu and scene.mu < 1 and h > l and rng.random() < 0.3:
        # The verge of a massless pulley: where b (h + l) = (k - 1) l (2 h - b).
        of_a_pulley = Answers(read_scene({**given, "M": "1", "I": None}), 30)
        k_minus_1 = Fraction(of_a_pulley.settle(lambda m: m.k_minus_1))
        near = 1 + Fraction(rng.choice([-1, 1]) * 10 ** rng.uniform(-15, -3))
        f = g * 2 * h * l * k_minus_1 / (h + l + l * k_minus_1) * near
    context = Context(prec=rng.choice([3, 17, 40]), Emin=-5000, Emax=5000)
    shown = context.divide(Decimal(f.numerator), Decimal(f.denominator))
    text = str(max(min(shown, Decimal("1e450")), Decimal("1e-450")))  # as far as a number may be typed
    return given | {"axle": f"{text} N" if rng.random() < 0.8 or "R" not in given else f"{text} Nm"}


def any_scene(rng: Random, *families: str) -> Given:
    """A scene of any family, or of these, on an axle or not."""
    usual = families or (*FAMILIES, *["ordinary"] * 5)
    return next(scenes(rng.choice(usual) + rng.choice(["", ON_AN_AXLE]), 1, rng.randrange(10**9)))


# Dangers of numbers, each by its name: rows of doubles of few patterns, so that columns solve them together

Row = dict[str, float]
G = 9.80665
DANGERS: dict[str, Callable[[Random], Row]] = {}


def danger(scene: Callable[[Random], Row]) -> Callable[[Random], Row]:
    DANGERS[scene.__name__] = scene
    return scene


def typed(row: Row) -> Given:
    """The doubles as texts that mean just them, to the last of their digits."""
    return {name: "inf" if value == inf else str(Decimal(value)) for name, value in {"g": G, **row}.items()}


def _tiny(rng: Random, least: float = 12, most: float = 305) -> float:
    """From about 2^-40 to beyond 2^-1000."""
    return rng.uniform(1, 2) * _log_uniform(rng, -most, -least)


def _near_1(rng: Random, closest: float) -> float:
    """Beside 1, by 1e-8 or less."""
    return 1 + rng.choice([-1, 1]) * _log_uniform(rng, -closest, -8)


def _masses(rng: Random) -> Row:
    m1 = _log_uniform(rng, -1, 1)
    return {"m1": m1, "m2": m1 * (1 + _log_uniform(rng, -2, 1)), "R": _log_uniform(rng, -1, 1)}


def _with_pulley(rng: Random, given: Row, most: float = 1) -> Row:
    """The row, with a pulley's mass in every other one."""
    return given | rng.choice([{}, {"M": _log_uniform(rng, -1, most)}])


def _turns(rng: Random) -> float:
    return 360.0 * rng.randint(1, 3)


def _beside(rng: Random, exact: flint.arb) -> float:
    """One of the two doubles next to a real number that is none."""
    nearest = float(exact.mid())
    below = nearest if exact > nearest else nextafter(nearest, 0)
    return rng.choice([below, nextafter(below, inf)])


def _capstan(mu: float) -> flint.arb:
    """k - 1 = e^{mu pi} - 1, to 400 bits."""
    flint.ctx.prec = 400
    return (flint.arb(mu) * flint.arb.pi()).expm1()


@danger
def pulley_of_hardly_any_mass(rng: Random) -> Row:
    wrap = rng.choice([_turns(rng), _tiny(rng, 1, 150)])
    return _masses(rng) | {"M": _tiny(rng, most=150 if wrap < 1 else 305), "wrap": wrap}


@danger
def heavy_pulley(rng: Random) -> Row:
    return _masses(rng) | {"M": rng.choice([_log_uniform(rng, 20, 300), inf])}


@danger
def weak_friction(rng: Random) -> Row:
    """Or friction on a short wrap."""
    mu, wrap = rng.choice([(_tiny(rng), _turns(rng)), (_log_uniform(rng, -1, 0), _tiny(rng, 4))])
    return _with_pulley(rng, _masses(rng) | {"mu": mu, "wrap": wrap})


@danger
def masses_a_few_doubles_apart(rng: Random) -> Row:
    m1 = _log_uniform(rng, -1, 1)
    M = _log_uniform(rng, -1, 1) * _tiny(rng, 0, 20)
    return {"m1": m1, "m2": m1 + ulp(m1) * rng.randint(1, 1000), "R": 1.0, "M": M, "wrap": _turns(rng)}


@danger
def near_the_least_heavier_mass(rng: Random) -> Row:
    """Next to it, or where friction is weak and the masses are nearly equal."""
    m1, mu = _log_uniform(rng, -3, 3), rng.choice([rng.uniform(0.01, 2), _log_uniform(rng, -15, -1)])
    apart = expm1(mu * pi) / rng.choice([_near_1(rng, 16), rng.uniform(0.1, 0.9)])
    m2 = rng.choice([_beside(rng, m1 * (1 + _capstan(mu))), m1 * (1 + apart)])
    return _with_pulley(rng, {"m1": m1, "m2": m2, "mu": mu, "R": 1.0}, most=30)


@danger
def near_the_least_pulley_mass(rng: Random) -> Row:
    """The heavier mass may be beyond what a double next to the limit needs to slip."""
    given, mu = _masses(rng), rng.choice([rng.uniform(0.01, 2), _log_uniform(rng, -10, 0)])
    least = 4 * given["m1"] * _capstan(mu)
    M = rng.choice([_beside(rng, least), float(least.mid()) * _near_1(rng, 16)])
    return given | {"m2": rng.choice([given["m2"], 1e25 * given["m1"] * exp(mu * pi)]), "mu": mu, "M": M}


@danger
def beside_the_critical_pulley_mass(rng: Random) -> Row:
    m1 = _log_uniform(rng, -3, 3)
    m2 = m1 * rng.uniform(1.01, 100)
    mu = rng.uniform(0.01, 0.99) * log(m2 / m1) / pi
    k_minus_1 = _capstan(mu)
    critical = 4 * flint.arb(m1) * m2 * k_minus_1 / (m2 - m1 * (1 + k_minus_1))
    return {"m1": m1, "m2": m2, "mu": mu, "mu_k": mu * rng.uniform(0, 0.99), "M": _beside(rng, critical)}


@danger
def grip_with_little_to_spare(rng: Random) -> Row:
    given, M = _masses(rng), _log_uniform(rng, -1, 1)
    excess = (given["m2"] / given["m1"] - 1) * M / (4 * given["m2"] + M)
    return given | {"M": M, "mu": log1p(excess) / pi * (1 + _tiny(rng, 2, 15))}


@danger
def capstan_ratio_beyond_the_doubles(rng: Random) -> Row:
    """Or such that a mass brings it back to them, or takes it beyond."""
    mu, power = rng.choice([(rng.uniform(230, 440), -1000), (235.0, -110), (690 / pi, rng.randint(26, 32))])
    far = power == -1000
    return {"m1": 2.0**power, "m2": 2.0 ** (1000 if far else power + 1), "M": inf if far else 1.0, "mu": mu}


@danger
def friction_straight_up(rng: Random) -> Row:
    """Its part x changes its sign between two doubles of wrap."""
    given = _masses(rng) | {"mu": _log_uniform(rng, -2, -0.5)}
    low, high, turn = radians(200), radians(500), complex(given["mu"], 1)
    for _ in range(60):
        wrap = (low + high) / 2
        before = (1j * (cmath.exp(turn * wrap) - 1) / turn).real < 0
        low, high = (wrap, high) if before else (low, wrap)
    return given | {"wrap": degrees(low)}


@danger
def axle_that_just_holds(rng: Random) -> Row:
    """The difference of the masses, or just about the heavier one."""
    given = _masses(rng) | {"M": rng.choice([0.0, inf, 3.0])}
    borne = rng.choice([given["m2"] - given["m1"], given["m2"]])
    rough = rng.choice([{}, {"mu": _log_uniform(rng, -2, 1)}])
    return given | {"axle": G * borne * _near_1(rng, 16)} | rough


@danger
def slip_on_any_pulley_or_hardly(rng: Random) -> Row:
    """Where the critical pulley mass is about 0."""
    given, mu = _masses(rng), _log_uniform(rng, -3, -1)
    m1, m2, z = given["m1"], given["m2"], given["m1"] * expm1(mu * pi)
    return given | {"mu": mu, "axle": G * 2 * m2 * z / (m1 + m2 + z) * _near_1(rng, 16)}


@danger
def slip_on_an_axle_that_just_turns(rng: Random) -> Row:
    given, mu = _masses(rng), _log_uniform(rng, -3, -2)
    m1, m2, k = given["m1"], given["m2"], exp(mu * pi / 2)
    axle = (k - 1) * 2 * m1 * m2 * G / (m2 + m1 * k) * _near_1(rng, 16)
    return given | {"M": 1e3 * m2, "mu": mu, "mu_k": mu / 2, "axle": axle}


@danger
def numbers_at_an_end_of_the_doubles(rng: Random) -> Row:
    """Sums of the largest overflow, products of the smallest vanish; only results may."""
    power = rng.choice([-1074, 1020])
    masses = {x: ldexp(rng.randint(1, 15), power) for x in ("m1", "m2", "M")}
    far = {"M": 2.0, "g": rng.choice([5e-324, 1e-310, 1e-200, 1e200, 1.7e308])}
    return rng.choice([masses, _masses(rng) | far]) | {"mu": _log_uniform(rng, -2, 0.3)}


@danger
def quotients_that_are_extreme(rng: Random) -> Row:
    """I/R² and the mass whose weight the axle bears, of numbers that are none."""
    R, g = _log_uniform(rng, -35, 35), _log_uniform(rng, -35, 35)
    I, axle = R**2 * _log_uniform(rng, -50, 50), g * _log_uniform(rng, -50, 50)
    return _masses(rng) | {"R": R, "I": I, "g": g, "axle": axle, "mu": _log_uniform(rng, -2, 0)}


@danger
def tie_or_beside_it(rng: Random) -> Row:
    """With load 6 and drive 3 a tension is 3 g/2, of 54 bits: half-way between two doubles, for an odd g."""
    scale, g = 2.0 ** rng.randint(-20, 20), 9.80665 + 2.0**-49 * rng.randint(0, 100)
    load, M, g = rng.choice(
        [(4, 2.0, g), (3, 2.0**-110, g), (3, 2.0**-90, g), (3, 0.0, float((2**54 - 1) // 3) * 2.0**-50)]
    )
    return {"m1": scale, "m2": load * scale, "M": M * scale, "g": g}
