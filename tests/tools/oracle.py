"""An oracle that shares no equation with the package: ball arithmetic of FLINT, exact fractions.

Formulas are the paper's own, as printed, for the lighter mass l and the heavier h; where the value
is rational it is a Fraction. `correctly_rounded` raises the precision until the ball decides.
"""

from collections.abc import Callable
from decimal import ROUND_HALF_EVEN, Context, Decimal
from fractions import Fraction
from functools import partial
from math import inf, isqrt
from typing import Any

import flint

from atwood_cli.solver.scene import Scene

LARGEST_EXPONENT = 10**8
"""Beyond this power of ten the package says infinite, and below its inverse that it is too small to be written."""
WIDE = Context(prec=1000, Emin=-(10**9), Emax=10**9)

BOUNDS = ("friction_force_min", "friction_force_max")
"""They have no closed form: test_contact checks those of `solve`, with which other doors must agree."""

Value = Fraction | Callable[[], flint.arb]


def rational(q: Any) -> Any:
    """A number as FLINT has it, where there is one."""
    return None if q is None else flint.fmpq(q.numerator, q.denominator)


def endpoints(value: flint.arb) -> tuple[Fraction, Fraction]:
    def exact(x: flint.arb) -> Fraction:
        mantissa, exponent = x.man_exp()
        return Fraction(int(mantissa)) * Fraction(2) ** int(exponent)

    return exact(value.lower()), exact(value.upper())


def round_exact(q: Fraction, digits: int | None) -> float | Decimal:
    if digits is None:
        try:
            return q.numerator / q.denominator
        except OverflowError:
            return inf if q > 0 else -inf
    context = Context(prec=digits, rounding=ROUND_HALF_EVEN, Emin=-(10**6), Emax=10**6)
    return context.divide(Decimal(q.numerator), Decimal(q.denominator))


def correctly_rounded(value: Value, digits: int | None) -> float | Decimal:
    if isinstance(value, Fraction):
        return round_exact(value, digits)
    flint.ctx.prec = 256 + 4 * (digits or 0)
    while True:
        enclosure = value()
        if not enclosure.is_finite() or enclosure.rel_accuracy_bits() < 32:
            flint.ctx.prec *= 2
            continue
        tens = 0
        log = abs(enclosure).log() / flint.arb(10).log()
        if abs(log) > 5000:  # too large or too small for a fraction
            if digits is None:
                return inf if log > 0 else 0.0
            if abs(log) > LARGEST_EXPONENT:
                return Decimal(inf) if log > 0 else Decimal(0)
            tens = int(log.mid().floor().fmpz())
            enclosure = (enclosure.log() - flint.arb(tens) * flint.arb(10).log()).exp()
        lo, hi = (round_exact(q, digits) for q in endpoints(enclosure))
        if lo == hi:
            return lo.scaleb(tens, WIDE) if isinstance(lo, Decimal) else lo
        flint.ctx.prec *= 2


def shown(value: Value | None, digits: int | None) -> float | Decimal | None:
    """The value as it is to be shown: None where there is none, or one too small to be written."""
    if value is None:
        return None
    rounded = correctly_rounded(value, digits)
    return None if isinstance(rounded, Decimal) and not rounded and callable(value) else rounded


def sign(value: Callable[[], flint.arb]) -> int:
    flint.ctx.prec = 256
    while True:
        v = value()
        if v > 0:
            return 1
        if v < 0:
            return -1
        flint.ctx.prec *= 2


def root(square: Any) -> Any:
    """A square root, exact where it is rational."""
    if isinstance(square, flint.arb):
        return square.sqrt()
    exact = rational(Fraction(isqrt(int(square.p)), isqrt(int(square.q))))
    return exact if exact**2 == square else lambda: flint.arb(square).sqrt()


def side(x: Any) -> int:
    return int(x > 0) - int(x < 0)


def measured(scene: Any) -> tuple[Any, Scene]:
    """The acceleration that was measured, positive when m2 descends, and the scene with what it finds.

    T1 = m1 (g + a) and T2 = m2 (g - a), by (1); T2 - T1 = c a + d f, by (3), as the masses move the way d.
    """
    m1, m2, g, beta, finds = scene.m1, scene.m2, scene.g, scene.inertia, scene.motion.finds
    if finds is None:
        return None, scene
    a, s, t, v, *_ = scene.motion
    if a is None:  # from rest: s = a t²/2, v = a t
        a = v / t if s is None else v * v / (2 * s) if t is None else 2 * s / t**2
        a *= 1 if finds == "drive" else (-1 if m2 == 0 else 1) if finds in ("m1", "m2") else side(m2 - m1)
    c = scene.I / scene.R**2 if scene.I else 0 if scene.M in (None, inf) else beta * scene.M
    d = (side(m2 - m1) or -side(a)) if finds == "axle" else side(a)
    f = d * (scene.axle or 0)
    laws: dict[str, Callable[[], Any]] = {
        "m1": lambda: (m2 * (g - a) - c * a - f) / (g + a),
        "m2": lambda: (m1 * (g + a) + c * a + f) / (g - a),
        "M": lambda: (m2 * (g - a) - m1 * (g + a) - f) / a / beta,
        "g": lambda: ((m1 + m2 + c) * a + f) / (m2 - m1),
        "axle": lambda: (m2 * (g - a) - m1 * (g + a) - c * a) * d,
    }
    return a, scene._replace(**{finds: laws[finds]()}) if finds in laws else scene


def expected(scene: Scene) -> dict[str, Any]:
    """Regime and every quantity, as the contract says; None where undetermined.

    What a measured motion finds is computed anew. On a driven pulley l is the mass under the lesser tension,
    and all that moves goes by (1): T_l = l (g + a), T_h = h (g - a).
    """
    if None in (scene.m1, scene.m2):
        return beside_a_missing_mass(scene)
    found_a, scene = measured(scene)
    finds = scene.motion.finds
    driven = finds == "drive"
    locked = scene.M == inf
    g, mu, mu_k, R, beta = map(rational, (scene.g, scene.mu, scene.mu_k, scene.R, scene.inertia))
    mass = None if locked else rational(scene.M)
    l, h = sorted(map(rational, (scene.m1, scene.m2)))
    s = side(scene.m2 - scene.m1) or (-side(found_a) if finds == "axle" else 0)  # the way it moves
    if driven:
        s = side(scene.m2 * (scene.g - found_a) - scene.m1 * (scene.g + found_a))
        l, h = map(rational, (scene.m1, scene.m2) if s >= 0 else (scene.m2, scene.m1))
    away = rational(found_a * (s or 1)) if driven else None
    zero, one, wrap = rational(0), rational(1), rational(scene.wrap.number)
    c = None
    if scene.I is not None:
        c = rational(scene.I) / R**2
        beta = c / mass if mass is not None else None
    elif mass is not None:
        c = beta * mass
    elif mu is None and not locked:
        c = mass = zero
    f = zero
    if scene.axle is not None:
        f = rational(scene.axle)
    rests = 0 < (h - l) * g <= f and finds not in ("axle", "drive")  # the axle holds the pulley
    held = locked or rests
    known = held or driven or c is not None
    equal = s == 0 or (c == 0 and f == 0 and not driven)

    def phi() -> Any:
        return flint.arb(wrap) if scene.wrap.unit == "rad" else flint.arb.pi() * wrap / 180

    def of_k(coefficient: Any, formula: Callable[[Any], Any]) -> Any:
        """A formula with the capstan ratio k, which is 1 without friction."""
        return formula(one) if coefficient == 0 else lambda: formula((coefficient * phi()).exp())

    def log(ratio: Any) -> flint.arb:
        return flint.arb(ratio).log()

    def beats(ratio: Any) -> bool:
        """ratio > e^{mu phi}"""
        if mu == 0 or ratio <= 1:
            return bool(ratio > 1)
        return sign(lambda: log(ratio) - mu * phi()) > 0

    def falls(rim: Any) -> Any:
        """a of a string that grips, by (1) and (3) with f."""
        return ((h - l) * g - f) / (h + l + rim)

    def ratio(a: Any) -> Any:
        """T_h/T_l, by (1)."""
        return h * (g - a) / (l * (g + a))

    grip = turning = None
    if l and known:
        grip = ratio(away) if driven else h / l if held or c is None else ratio(falls(c))
    if f and l and s and not rests and not driven:
        turning = ratio(falls(zero))  # of a pulley without mass, against the axle
    always = bool(turning is not None and mu is not None and beats(turning))
    out: dict[str, Any] = dict.fromkeys((*NAMES, *MEASURED))
    slips_locked = bool(l and s and mu is not None and beats(h / l))
    if finds == "mu_k":
        regime = "slip"
    elif mu is None or equal:
        regime = "no-slip"
    elif not known:
        regime = ("slip" if always else "verge") if slips_locked else "no-slip"
    else:
        regime = "slip" if beats(grip) else "no-slip"
    out["regime"] = regime

    state: Any = None  # |a|, T_l, T_h
    friction_mu: Any = None
    at_limit: Any
    if driven or regime == "no-slip":
        if equal and l:
            friction_mu = zero
        elif grip is not None and mu is None:
            friction_mu = lambda: log(grip) / phi()  # noqa: E731
        if driven:
            state = away, l * (g + away), h * (g - away)
        elif s == 0:
            state = zero, l * g, l * g
        elif held:
            state = zero, l * g, h * g
        elif c is not None:
            a = falls(c)
            state = a, l * (g + a), h * (g - a)
    else:
        friction_mu = used = mu if regime == "verge" or mu_k is None else mu_k
        at_limit = partial(of_k, used)
        if finds == "mu_k":
            sliding = ratio(rational(s * found_a))
            friction_mu = zero if sliding == 1 else lambda: log(sliding) / phi()
            at_limit = lambda formula: formula(sliding)  # noqa: E731
            out["mu_k"] = friction_mu
        # (1) with T_h = k T_l: T_l = m_l (g + a), T_h = m_h (g - a).
        state = (
            at_limit(lambda k: g * (h - l * k) / (h + l * k)),
            at_limit(lambda k: 2 * l * h * g / (h + l * k)),
            at_limit(lambda k: 2 * l * h * g * k / (h + l * k)),
        )

    def lift(v: Any) -> Any:
        return v() if callable(v) else v

    def combine(f: Callable[..., Any], *values: Any) -> Any:
        return (lambda: f(*map(lift, values))) if any(map(callable, values)) else f(*values)

    if state is not None:
        a, t_l, t_h = state
        t1, t2 = (t_l, t_h) if s >= 0 else (t_h, t_l)
        out["acceleration"] = rational(found_a) if driven else combine(lambda v: s * v, a)
        out["tension_1"], out["tension_2"] = t1, t2
        out["tension_difference"] = combine(lambda y, x: y - x, t2, t1)
        if friction_mu == 0:
            out["friction_force"] = out["friction_force_x"] = out["friction_force_y"] = zero
        elif friction_mu is not None:
            fm = friction_mu

            def integral(part: str) -> Any:
                """Force on the pulley: dT/dtheta along the unit tangent, integrated by parts (28)-(29)."""
                nu = s * lift(fm)
                z = flint.acb(nu, 1)
                whole = (((z * phi()).exp() - 1) / z) * nu * lift(t1) * flint.acb(0, 1)
                return whole.real if part == "real" else whole.imag

            out["friction_force_x"] = lambda: integral("real")
            out["friction_force_y"] = lambda: integral("imag")
            out["friction_force"] = lambda: (integral("real") ** 2 + integral("imag") ** 2).sqrt()
        rim = a
        if regime == "slip" and not driven:
            # The axle takes f of what turns the pulley, or all of it.
            left = combine(lambda hi, lo: hi - lo - f, t_h, t_l)
            turns = sign(left) > 0 if callable(left) else left > 0
            rim = zero if rests or c is None or (f and not turns) else combine(lambda x: x / c, left)
        if not (driven and regime == "slip"):
            out["rim_acceleration"] = combine(lambda v: (s or 1) * v, rim)
        if R is not None:
            out["torque"] = combine(lambda y, x: (y - x) * R, t2, t1)
            if out["rim_acceleration"] is not None:
                out["angular_acceleration"] = combine(lambda v: v / R, out["rim_acceleration"])
    if R is not None and c is not None and not (scene.M is None is scene.I):
        out["moment_of_inertia"] = c * R**2
    if regime == "verge":
        out["mu_verge"] = mu
    elif l and equal:
        out["mu_verge"] = zero
    elif grip is not None:
        out["mu_verge"] = lambda: log(grip) / phi()
    if l and equal:
        out["tension_ratio"] = one
    elif regime != "no-slip":
        out["tension_ratio"] = combine(lambda t, u: u / t, state[1], state[2])
    elif l and grip is not None:
        out["tension_ratio"] = grip
    if mu is not None:
        out["capstan_ratio"] = of_k(mu, lambda k: k)
        if regime == "verge":
            out["safety_factor"] = one if mu else None
        elif not equal and grip is not None:
            out["safety_factor"] = zero if mu == 0 else lambda: mu * phi() / log(grip)
        # What (1) and (3) with f say at T_h = k T_l, of each mass in turn; z is l (k - 1), and b is f/g.
        b = f / g
        if driven:
            out["critical_lighter_mass"] = of_k(mu, lambda k: h * (g - away) / (k * (g + away)))
        elif locked or (f and (h * g <= f or beats(h * g / (h * g - f)))):
            out["critical_lighter_mass"] = of_k(mu, lambda k: h / k)
        elif c is not None:
            out["critical_lighter_mass"] = (
                of_k(mu, lambda k: h * (c + b) / (c - b + (k - 1) * (2 * h + c - b))) if c or f else zero
            )
        if l and equal:
            out["least_wrap"] = zero
        elif regime == "verge":
            in_degrees = wrap if scene.wrap.unit == "°" else lambda: phi() * 180 / flint.arb.pi()
            out["least_wrap"] = in_degrees if mu else zero
        elif grip is not None and mu:
            out["least_wrap"] = lambda: log(grip) / mu * 180 / flint.arb.pi()
        if slips_locked and not always and not rests and not driven and beta is not None:

            def critical_pulley_mass(k: Any) -> Any:
                z = l * (k - 1)
                a = g * (h - l - z) / (h + l + z)
                return (z * (g + a) - f) / a / beta

            out["critical_pulley_mass"] = of_k(mu, critical_pulley_mass)
        out["least_heavier_mass"] = of_k(mu, lambda k: l * k * ((g + away) / (g - away) if driven else 1))
        if beta is not None and not (f and beats(1 + b / l)) and not driven:
            out["least_pulley_mass"] = of_k(mu, lambda k: (2 * l * (k - 1) - b) / beta)
        if driven:
            out["critical_heavier_mass"] = out["least_heavier_mass"]
        elif locked or (f and beats(1 + b / l)):
            out["critical_heavier_mass"] = of_k(mu, lambda k: l * k)
        elif c is not None and l and beats(1 + (c + b) / (2 * l)):

            def critical_heavier_mass(k: Any) -> Any:
                z = l * (k - 1)
                a = (z * g - f) / (c - z)
                return l * k * (g + a) / (g - a)

            out["critical_heavier_mass"] = of_k(mu, critical_heavier_mass)
    half_turns = scene.wrap.unit == "°" and (scene.wrap.number - 180) % 360 == 0
    if state is not None and not locked and half_turns:
        pulley = out["critical_pulley_mass"] if regime == "verge" else mass
        if pulley is not None:
            out["axle_force"] = combine(lambda x, y, p: x + y + p * g, state[1], state[2], pulley)
    if finds in FOUND:
        out[FOUND[finds]] = rational(getattr(scene, finds))
    if R is not None and finds == "axle":
        out["axle_torque"] = f * R
    way = side(found_a or scene.motion.speed or scene.motion.drop or 0) if driven else 0
    if driven and regime == "no-slip" and c is not None and (way or not f):
        t1, t2 = out["tension_1"], out["tension_2"]
        out["drive_force"] = c * rational(found_a) + f * way - (t2 - t1)  # (3)
        out["drive_torque"] = None if R is None else out["drive_force"] * R
    fall: Any = (None if x is None else abs(rational(x)) for x in scene.motion[1:4])
    drop, time, speed = fall
    if driven and out["drive_force"] is not None and speed is not None:
        out["drive_power"] = out["drive_force"] * speed * way
    from_rest = finds != "axle" or s * found_a > 0
    if {drop, time, speed} != {None} and from_rest and state is not None and state[0] != 0:
        a = rational(abs(found_a)) if driven else state[0]
        height = lambda a: a * time**2 / 2 if speed is None else speed**2 / (2 * a)  # noqa: E731
        out["drop"] = None if drop is not None else combine(height, a)  # v² = 2 a s
        out["fall_time"] = time or combine(lambda a: root(2 * drop / a) if drop else speed / a, a)
        out["final_speed"] = speed or combine(lambda a: root(2 * drop * a) if drop else a * time, a)
        if driven and out["drive_force"] is not None and speed is None:
            out["drive_power"] = combine(lambda v: out["drive_force"] * v * way, out["final_speed"])
        rim, falls_by = out["rim_acceleration"], drop or out["drop"]
        if rim is not None:
            share = combine(lambda x, y: abs(x) / y, rim, a) if regime == "slip" else one
            if R is not None:
                turns = combine(lambda v, q: v * q / R, out["final_speed"], share)
                out["final_angular_speed"] = turns if callable(rim) or rim else zero

            def energy(height: Any, q: Any, difference: Any) -> Any:
                """What gravity and the drive give, less what the axle takes, and a string that slips."""
                lost = f * q * height + abs(difference) * (1 - q) * height
                way = side(found_a) if driven else s
                driving = out["drive_force"] * way if driven and out["drive_force"] is not None else 0
                return (rational(scene.m2 - scene.m1) * g * way + driving) * height - lost

            if not driven or out["drive_force"] is not None:
                out["kinetic_energy"] = combine(energy, falls_by, share, out["tension_difference"])
    return {name: Fraction(int(x.p), int(x.q)) if isinstance(x, flint.fmpq) else x for name, x in out.items()}


def beside_a_missing_mass(scene: Scene) -> dict[str, Any]:
    """What holds beside a mass that is not given: the limits are those beside an equal one."""
    given = scene.m1 or scene.m2 or Fraction(1)
    twins = expected(scene._replace(m1=given, m2=given))
    both = {} if scene.m1 is scene.m2 is None else dict.fromkeys(LIMITS)
    held = {x: twins[x] for x in ("capstan_ratio", "moment_of_inertia", *both)}
    if both and scene.M is scene.I is None:  # on any pulley: on a locked one
        locked = expected(scene._replace(m1=given, m2=given, M=inf))
        held |= {x: locked[x] for x in ("critical_heavier_mass", "critical_lighter_mass")}
    return dict.fromkeys(twins) | held


LIMITS = "critical_heavier_mass critical_lighter_mass least_heavier_mass least_pulley_mass".split()
"""The limits of one mass, by the other one alone."""
NAMES = """
    regime acceleration tension_1 tension_2 tension_difference mu_verge safety_factor tension_ratio capstan_ratio
    friction_force friction_force_min friction_force_max friction_force_x friction_force_y
    axle_force torque rim_acceleration angular_acceleration
    critical_pulley_mass critical_heavier_mass critical_lighter_mass
    least_heavier_mass least_pulley_mass least_wrap moment_of_inertia
""".split()
FOUND = {"M": "pulley_mass", "g": "gravity", "m1": "m1", "m2": "m2", "axle": "axle"}
"""The quantity that is an input, if a motion finds it."""
MEASURED = [
    *FOUND.values(),
    *"mu_k axle_torque drive_force drive_torque drive_power".split(),
    *"drop fall_time final_speed final_angular_speed kinetic_energy".split(),
]
"""The quantities of measured motions."""
