"""Seeded scenes of every stress family, as the texts that a user would type."""

import re
from collections.abc import Callable, Iterator
from decimal import Context, Decimal
from fractions import Fraction
from random import Random
from typing import Any

import flint

from atwood_cli.model.scene import Scene
from atwood_cli.solver.answers import Answers

Given = dict[str, str]


def table(words: str) -> list[list[str]]:
    """The rows of a table, with bars between cells; an indented line goes on with the row above it."""
    rows = re.sub(r"\n\s+", " ", words.strip("\n")).splitlines()
    return [[cell.strip() for cell in row.split("|")] for row in rows]


def inputs(words: str) -> dict[str, Any]:
    """What is given, from words such as "m1=1 M=None"; m1 is 1 and m2 is 3 if they are not named."""
    given = dict(word.split("=", 1) for word in words.split())
    return {"m1": "1", "m2": "3", **{name: None if x == "None" else x for name, x in given.items()}}


def _log_uniform(rng: Random, low: float, high: float) -> float:
    return 10 ** rng.uniform(low, high)


def _text(rng: Random, x: float) -> str:
    """Sometimes all seventeen digits, sometimes as few as people type."""
    return rng.choice([repr, "{:.3g}".format, "{:.6e}".format])(x)


def ordinary(rng: Random) -> Given:
    m1 = _log_uniform(rng, -2, 2)
    m2 = m1 * (1 + _log_uniform(rng, -2, 2))
    scene = {"m1": _text(rng, m1), "m2": _text(rng, m2)}
    given = rng.choice(["", "M", "mu", "M mu", "M mu", "M mu mu_k"])
    if "M" in given:
        scene["M"] = rng.choice([_text(rng, _log_uniform(rng, -2, 3))] * 9 + ["inf"])
    if "mu" in given:
        mu = _log_uniform(rng, -2, 0.3)
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


def _vary(rng: Random, scene: Given) -> Given:
    """What any family may have on top: mirrored, another gravity, pulley or wrap."""
    if rng.random() < 0.5:
        scene |= {"m1": scene["m2"], "m2": scene["m1"]}
    if rng.random() < 0.3:
        scene["R"] = repr(_log_uniform(rng, -3, 1))
    if rng.random() < 0.2:
        scene.setdefault("g", rng.choice(["moon", "9.81", "1.6e-300"]))
    if rng.random() < 0.2:
        if "R" in scene and scene.get("M") != "inf" and rng.random() < 0.5:
            scene["I"] = repr(_log_uniform(rng, -4, 3))
            if rng.random() < 0.5:
                scene.pop("M", None)
        else:
            scene["inertia"] = rng.choice(["hoop", "shell", repr(rng.random() + 0.01)])
    if rng.random() < 0.15:
        scene["wrap"] = rng.choice(["90", "360", "540", "720", "100", "270", "17.5"])
    return scene


def scenes(family: str, count: int, seed: int = 2026) -> Iterator[Given]:
    rng = Random(f"{family} {seed}")
    for _ in range(count):
        yield _vary(rng, FAMILIES[family](rng))


def with_axle(rng: Random, given: Given) -> Given:
    """The scene with an axle: of no matter, or such that it decides; as a torque now and then."""
    scene = Scene.read(given)
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
        k1 = Fraction(Answers(Scene.read({**given, "M": "1", "I": None}), 30).settle(lambda m: m.k1))
        near = 1 + Fraction(rng.choice([-1, 1]) * 10 ** rng.uniform(-15, -3))
        f = g * 2 * h * l * k1 / (h + l + l * k1) * near
    context = Context(prec=rng.choice([3, 17, 40]), Emin=-5000, Emax=5000)
    shown = context.divide(Decimal(f.numerator), Decimal(f.denominator))
    text = str(max(min(shown, Decimal("1e450")), Decimal("1e-450")))  # as far as a number may be typed
    return given | {"axle": f"{text} N" if rng.random() < 0.8 or "R" not in given else f"{text} Nm"}


def of_all_kinds(count: int, seed: int = 2026) -> Iterator[Given]:
    """Scenes as people have them, some on an axle that rubs, with a free end or equal masses."""
    rng = Random(f"all kinds {seed}")
    for _ in range(count):
        scene = _vary(rng, ordinary(rng))
        if rng.random() < 0.1:
            scene["m2"] = rng.choice([scene["m1"], "0"][: 1 + ("mu" not in scene)])
        if rng.random() < 0.5:
            difference = abs(float(scene["m1"]) - float(scene["m2"])) or 1.0
            force = 9.8 * difference * _log_uniform(rng, -2, 0.2)
            scene["axle"] = repr(force) + ("Nm" if "R" in scene and rng.random() < 0.5 else "")
        yield scene


def with_friction(rng: Random, size: float = 1) -> Given:
    """A scene of masses of about that size in which friction decides, mostly, in all ways there are."""
    m1 = size * _log_uniform(rng, -2, 2)
    m2 = m1 * rng.choice(
        [1, 1 + _log_uniform(rng, -6, -1), _log_uniform(rng, 0, 3), _log_uniform(rng, -2, 0)]
    )
    words = {"m1": f"{m1:.4g}", "m2": f"{m2:.4g}"}
    if rng.random() < 0.5:
        words["g"] = f"{rng.uniform(1, 20):.3g}"
    if rng.random() < 0.4:
        words["wrap"] = rng.choice(["90", "540", f"{rng.uniform(10, 800):.3g}"])
    if rng.random() < 0.4:
        words["R"] = f"{_log_uniform(rng, -2, 1):.3g}"
    if rng.random() < 0.65:
        unit = "Nm" if "R" in words and rng.random() < 0.3 else ""
        words["axle"] = f"{10 * abs(m2 - m1) * _log_uniform(rng, -2, 0.3) + size * 1e-3:.3g}{unit}"
    if rng.random() < 0.65:
        words["M"] = rng.choice(["0", "inf", *[f"{m1 * _log_uniform(rng, -3, 3):.3g}"] * 5])
    if "R" in words and words.get("M") not in ("0", "inf") and rng.random() < 0.3:
        words["I"] = f"{m1 * _log_uniform(rng, -3, 1):.3g}"
    elif rng.random() < 0.2:
        words["inertia"] = rng.choice(["hoop", "1.5", "1.00000001"])
    if rng.random() < 0.75:
        words["mu"] = rng.choice(["0", *[f"{_log_uniform(rng, -3, 0.2):.3g}"] * 5, "1e9"])
    return words
