"""An oracle that shares no code with the package: ball arithmetic of FLINT, exact fractions.

Formulas are the paper's own, as printed, for the lighter mass l and the heavier h; where the value
is rational it is a Fraction. `correctly_rounded` raises the precision until the ball decides.
"""

from collections.abc import Callable
from decimal import ROUND_HALF_EVEN, Context, Decimal
from fractions import Fraction
from math import inf
from typing import Any

import flint

from atwood_cli.model.scene import Scene

LARGEST_EXPONENT = 10**8
"""Beyond this power of ten the package says infinite, and below its inverse that it is too small to be written."""
WIDE = Context(prec=1000, Emin=-(10**9), Emax=10**9)

Value = Fraction | Callable[[], flint.arb]


def ball(q: Fraction | int) -> flint.arb:
    return flint.arb(flint.fmpq(q.numerator, q.denominator))


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


def expected(scene: Scene) -> dict[str, Any]:
    """Regime and every quantity, as the contract says; None where undetermined."""
    m1, m2, g, mu, M = scene.m1, scene.m2, scene.g, scene.mu, scene.M
    l, h = min(m1, m2), max(m1, m2)
    s = 1 if m2 > m1 else -1 if m2 < m1 else 0
    locked = M == inf
    beta = scene.inertia
    c: Fraction | None = None
    mass = M if isinstance(M, Fraction) else None
    if scene.I is not None:
        assert scene.R is not None
        c = scene.I / scene.R**2
        beta = c / mass if mass is not None else None
    elif mass is not None:
        assert beta is not None
        c = beta * mass
    elif mu is None and not locked:
        c = mass = Fraction(0)
    f = Fraction(0)
    if scene.axle is not None:
        f = scene.axle.number if scene.axle.unit == "N" else scene.axle.number / (scene.R or 1)
    rests = 0 < (h - l) * g <= f  # the axle holds the pulley
    held = locked or rests
    known = held or c is not None
    equal = s == 0 or (c == 0 and f == 0)

    def phi() -> flint.arb:
        return flint.arb.pi() * ball(scene.wrap.number) / 180

    def k(coefficient: Fraction) -> flint.arb:
        return (ball(coefficient) * phi()).exp()

    def beats(ratio: Fraction) -> bool:
        """ratio > e^{mu phi}"""
        assert mu is not None
        if mu == 0 or ratio <= 1:
            return ratio > 1
        return sign(lambda: ball(ratio).log() - ball(mu) * phi()) > 0

    # T_h/T_l of a string that grips, from (4) with M/2 = c.
    grip = None
    if l and known:
        grip = h / l if held or c is None else (2 * l + c) * h / ((2 * h + c) * l)
    turning = None  # of one that turns a pulley without mass against the axle, by (1)
    if f and l and s and not rests:
        b = ((h - l) * g - f) / (h + l)
        turning = h * (g - b) / (l * (g + b))
        if c is not None and not locked:
            moves = ((h - l) * g - f) / (h + l + c)
            grip = h * (g - moves) / (l * (g + moves))
    always = bool(turning is not None and mu is not None and beats(turning))
    out: dict[str, Any] = dict.fromkeys(NAMES)
    slips_locked = bool(l and s and mu is not None and beats(h / l))
    if mu is None or equal:
        regime = "no-slip"
    elif not known:
        regime = ("slip" if always else "verge") if slips_locked else "no-slip"
    else:
        assert grip is not None
        regime = "slip" if beats(grip) else "no-slip"
    out["regime"] = regime

    state: tuple[Value, Value, Value] | None = None  # |a|, T_l, T_h
    friction_mu: Value | None = None
    if regime == "no-slip":
        if s == 0:
            state = Fraction(0), l * g, l * g
        elif held:
            state = Fraction(0), l * g, h * g
        elif c is not None and f:
            moves = ((h - l) * g - f) / (h + l + c)
            state = moves, l * (g + moves), h * (g - moves)
        elif c is not None:
            total = l + h + c
            state = (h - l) * g / total, (2 * h + c) * l * g / total, (2 * l + c) * h * g / total
        if equal and l:
            friction_mu = Fraction(0)
        elif grip is not None and mu is None:
            friction_mu = lambda: ball(grip).log() / phi()  # noqa: E731
    else:
        used = mu if regime == "verge" or scene.mu_k is None else scene.mu_k
        assert used is not None
        friction_mu = used
        if used == 0:
            state = (h - l) * g / (h + l), 2 * l * h * g / (l + h), 2 * l * h * g / (l + h)
        else:
            # (1) with T_h = k T_l: T_l = m_l (g + a), T_h = m_h (g - a).
            state = (
                lambda: ball(g) * (ball(h) - ball(l) * k(used)) / (ball(h) + ball(l) * k(used)),
                lambda: 2 * ball(l) * ball(h) * ball(g) / (ball(h) + ball(l) * k(used)),
                lambda: 2 * ball(l) * ball(h) * ball(g) * k(used) / (ball(h) + ball(l) * k(used)),
            )

    def lift(v: Value) -> flint.arb:
        return ball(v) if isinstance(v, Fraction) else v()

    def combine(f: Callable[..., Any], *values: Value) -> Value:
        if all(isinstance(v, Fraction) for v in values):
            result = f(*values)
            assert isinstance(result, Fraction)
            return result
        return lambda: f(*map(lift, values))

    if state is not None:
        a, t_l, t_h = state
        t1, t2 = (t_l, t_h) if s >= 0 else (t_h, t_l)
        out["acceleration"] = combine(lambda v: s * v, a)
        out["tension_1"], out["tension_2"] = t1, t2
        if friction_mu == 0:
            out["friction_force"] = out["friction_force_x"] = out["friction_force_y"] = Fraction(0)
        elif friction_mu is not None:
            fm = friction_mu

            def integral(part: str) -> flint.arb:
                """Force on the pulley: dT/dtheta along the unit tangent, integrated by parts (28)-(29)."""
                nu = s * lift(fm)
                z = flint.acb(nu, 1)
                whole = (((z * phi()).exp() - 1) / z) * nu * lift(t1) * flint.acb(0, 1)
                return whole.real if part == "real" else whole.imag

            out["friction_force_x"] = lambda: integral("real")
            out["friction_force_y"] = lambda: integral("imag")
            out["friction_force"] = lambda: (integral("real") ** 2 + integral("imag") ** 2).sqrt()
        rim = a
        if regime == "slip":
            # The axle takes f of what turns the pulley, or all of it.
            left = combine(lambda hi, lo: hi - lo - c_as(hi, f), t_h, t_l)
            turns = left > 0 if isinstance(left, Fraction) else sign(left) > 0
            if rests or c is None or (f and not turns):
                rim = Fraction(0)
            else:
                rim = combine(lambda x: x / c_as(x, c), left)
        out["rim_acceleration"] = combine(lambda v: s * v, rim)
        if scene.R is not None:
            R = scene.R
            out["torque"] = combine(lambda y, x: (y - x) * c_as(y, R), t2, t1)
            out["angular_acceleration"] = combine(lambda v: s * v / c_as(v, R), rim)
    if regime == "verge":
        out["mu_verge"] = mu
    elif l and equal:
        out["mu_verge"] = Fraction(0)
    elif grip is not None:
        out["mu_verge"] = lambda: ball(grip).log() / phi()
    if l and equal:
        out["tension_ratio"] = Fraction(1)
    elif regime != "no-slip":
        out["tension_ratio"] = combine(lambda t, u: u / t, state[1], state[2])  # type: ignore[index]
    elif l and grip is not None:
        out["tension_ratio"] = grip
    if mu is not None:
        out["capstan_ratio"] = Fraction(1) if mu == 0 else lambda: k(mu)
        if regime == "verge":
            out["safety_factor"] = Fraction(1) if mu else None
        elif not equal and grip is not None:
            out["safety_factor"] = Fraction(0) if mu == 0 else lambda: ball(mu) * phi() / ball(grip).log()
        if locked or (f and (h * g <= f or beats(h * g / (h * g - f)))):
            out["critical_lighter_mass"] = h if mu == 0 else lambda: ball(h) / k(mu)
        elif c is not None and f == 0:
            out["critical_lighter_mass"] = (
                (h if c else Fraction(0))
                if mu == 0 or c == 0
                else lambda: ball(h) * ball(c) / (k(mu) * ball(c) + 2 * ball(h) * (k(mu) - 1))
            )
        elif c is not None:
            # (3) with f at T_h = k T_l and (1): h (c + b) = l (c - b + (k - 1) (2h + c - b)).
            out["critical_lighter_mass"] = lambda: (
                ball(h) * (ball(c) + ball(f / g)) / (ball(c - f / g) + (k(mu) - 1) * ball(2 * h + c - f / g))
            )
        if l and equal:
            out["least_wrap"] = Fraction(0)
        elif regime == "verge":
            out["least_wrap"] = scene.wrap.number
        elif grip is not None and mu:
            out["least_wrap"] = lambda: ball(grip).log() / ball(mu) * 180 / flint.arb.pi()
        if f and s:
            # (1) at T_h = k T_l gives a; (3) with f gives c.
            def verge_rim_mass() -> flint.arb:
                z = ball(l) * (k(mu) - 1)
                a = ball(g) * (ball(h) - ball(l) - z) / (ball(h) + ball(l) + z)
                return (z * (ball(g) + a) - ball(f)) / a

            if slips_locked and not always and not rests and beta is not None:
                out["critical_pulley_mass"] = lambda: verge_rim_mass() / ball(beta)
        elif slips_locked and beta is not None:
            out["critical_pulley_mass"] = (
                Fraction(0)
                if mu == 0
                else lambda: 2 * ball(l) * ball(h) * (k(mu) - 1) / (ball(beta) * (ball(h) - ball(l) * k(mu)))
            )
        if mu > 0 or known or f:
            out["least_heavier_mass"] = l if mu == 0 else lambda: ball(l) * k(mu)
            if f:
                if beta is not None and not beats(1 + f / g / l):
                    out["least_pulley_mass"] = lambda: (
                        (2 * ball(l) * (k(mu) - 1) - ball(f) / ball(g)) / ball(beta)
                    )
            elif beta is not None:
                out["least_pulley_mass"] = (
                    Fraction(0) if mu == 0 else lambda: 2 * ball(l) * (k(mu) - 1) / ball(beta)
                )
        if locked or (f and beats(1 + f / g / l)):
            out["critical_heavier_mass"] = l if mu == 0 else lambda: ball(l) * k(mu)
        elif f and c is not None and beats(1 + (c + f / g) / (2 * l)):

            def verge_heavier_mass() -> flint.arb:
                z = ball(l) * (k(mu) - 1)
                a = (z * ball(g) - ball(f)) / (ball(c) - z)  # (3) with f, at T_h = k T_l
                return ball(l) * k(mu) * (ball(g) + a) / (ball(g) - a)

            out["critical_heavier_mass"] = verge_heavier_mass
        elif f:
            pass
        elif c is not None and l and beats(1 + c / (2 * l)):
            out["critical_heavier_mass"] = (
                l if mu == 0 else lambda: ball(c) * ball(l) * k(mu) / (ball(c) - 2 * ball(l) * (k(mu) - 1))
            )
    if state is not None and not locked and (scene.wrap.number - 180) % 360 == 0:
        pulley = out["critical_pulley_mass"] if regime == "verge" else mass
        if pulley is not None:
            out["axle_force"] = combine(lambda x, y, p: x + y + p * c_as(p, g), state[1], state[2], pulley)
    return out


def c_as(like: Any, q: Fraction) -> Any:
    """q as the same kind of number."""
    return q if isinstance(like, Fraction) else ball(q)


NAMES = """
    regime acceleration tension_1 tension_2 mu_verge safety_factor tension_ratio capstan_ratio
    friction_force friction_force_min friction_force_max friction_force_x friction_force_y
    axle_force torque rim_acceleration angular_acceleration
    critical_pulley_mass critical_heavier_mass critical_lighter_mass
    least_heavier_mass least_pulley_mass least_wrap
""".split()
