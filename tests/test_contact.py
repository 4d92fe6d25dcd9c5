"""The arc of contact: identities, and bounds against a linear programme."""

from collections import Counter
from fractions import Fraction
from math import pi
from random import Random
from typing import Any, cast

import mpmath
import numpy as np
import pytest
from scipy.optimize import linprog, minimize_scalar
from scipy.sparse import diags_array, vstack

from atwood_cli import SceneError, solve
from atwood_cli.explain.contact import contact
from atwood_cli.solver.answers import Answers

from .conftest import many
from .tools import oracle
from .tools.scenes import any_scene, inputs, read_scene


def test_forces_along_the_arc_add_up_and_keep_to_the_limits_of_friction() -> None:
    """(20), (23) and (26), to the last digits; where friction is to spare, it is all at the heavier mass's end."""
    mpmath.mp.dps, kinds, rng = 60, Counter[str](), Random("the arc")
    for scene in (any_scene(rng, "ordinary") for _ in range(many(240))):
        try:
            seen = contact(Answers(read_scene(scene), 30), 7)
        except SceneError:  # a free end, or a motion that is open
            continue
        kinds[seen.kind] += 1
        s, balance = solve(**scene, digits=40), cast(Any, seen.balance)
        numbers = (s.tension_1, s.tension_2, scene.get("R", 1), scene.get("mu", 0), scene.get("wrap", 180))
        t1, t2, radius, mu, wrap = (mpmath.mpf(str(number)) for number in numbers)
        magnitude, ends = mpmath.mpf(str(balance["resultant"].pop("magnitude"))), balance["resultant"]
        assert balance["sum"] == ends, scene
        assert abs(magnitude - mpmath.hypot(*(mpmath.mpf(str(ends[x])) for x in "xy"))) <= magnitude / 10**28
        assert balance["torque"]["contact"] == balance["torque"]["ends"]
        ends = mpmath.mpf(str(balance["torque"]["ends"]))
        assert abs(ends - (t2 - t1) * radius) <= 2 * max(t1, t2) * radius / 10**29
        low, high, sign, phi = min(t1, t2), max(t1, t2), 1 if t1 <= t2 else -1, mpmath.radians(wrap)
        for i, point in enumerate(seen.points):
            from_light = mpmath.mpf(i if sign > 0 else 6 - i) / 6
            if seen.kind == "exponential":
                tension, friction = low * (high / low) ** from_light, mpmath.log(high / low) / phi
            else:
                creeping = high * mpmath.exp(-mu * phi * (1 - from_light))
                tension, friction = (creeping, mu) if creeping > low else (low, 0)
            per_radian = {"normal": tension, "friction": sign * friction * tension}
            wanted = {"angle": wrap * i / 6, "tension": tension}
            for unit, each in (("radian", 1), *[("metre", radius)] * ("R" in scene)):
                wanted |= {f"{name}_per_{unit}": force / each for name, force in per_radian.items()}
            for name, value in wanted.items():
                there = mpmath.mpf(str(point[name]))
                assert mpmath.almosteq(there, value, rel_eps=mpmath.mpf(10) ** -28), (scene, name)
    assert min(kinds["exponential"], kinds["creep"]) > many(40), kinds


# The bounds of the friction force


GRIPPING = """
m1=3.152 m2=3.735 M=24.299 mu=2.592 wrap=30
m1=3.295 m2=2.697 M=33.193 mu=1.459 wrap=180
m1=1.966 m2=0.6 M=0.56 mu=1.25 wrap=60
m1=1 m2=3 M=10 mu=0.4 wrap=150
""".strip().splitlines()
HARDLY_LOADED = "m1=1 m2=3 M=1e-30 mu=1 wrap=180"
JUST_HOLDS = "m1=1 m2=3 M=10 mu=0.20582781927064069 wrap=180"
"""Where the verge is at 0.205827819270640686: both bounds meet in (32) there."""


@pytest.mark.parametrize("words", GRIPPING)
def test_bounds_against_a_linear_programme(words: str) -> None:
    """All profiles on elements with T_j <= T_{j+1} <= e^{μΔ} T_j, friction at each one's middle.

    The force in a direction is linear in T, so a linear programme finds its extremes; the greatest
    force is the greatest of those over all directions, the least (the distance of a convex set from
    the origin) the greatest of their minima.
    """
    scene: dict[str, Any] = {name: float(x) for name, x in inputs(words).items()}
    solution = solve(**scene)
    low, high = sorted((float(solution.tension_1 or 0), float(solution.tension_2 or 0)))
    count = 150
    # Elements shrink towards the ends, where the limiting arcs of the least force lie.
    nodes = scene["wrap"] * pi / 360 * (1 - np.cos(pi * np.arange(count + 1) / count))
    steps, middle = np.diff(nodes), (nodes[1:] + nodes[:-1]) / 2
    unit = np.stack([-np.sin(middle), np.cos(middle)])
    no_fall, no_slip = (
        diags_array([-growth * sign, sign * np.ones(count)], offsets=[0, 1], shape=(count, count + 1))
        for growth, sign in ((np.ones(count), -1), (np.exp(scene["mu"] * steps), 1))
    )
    bounds = [(low, low), *[(low, high)] * (count - 1), (high, high)]

    def extreme(angle: float, sign: int) -> float:
        along = np.array([np.cos(angle), np.sin(angle)]) @ unit
        costs = sign * (np.concatenate([[0], along]) - np.concatenate([along, [0]]))
        result = linprog(costs, A_ub=vstack([no_fall, no_slip]), b_ub=np.zeros(2 * count), bounds=bounds)
        assert result.status == 0
        return sign * float(result.fun)

    def best(sign: int) -> float:
        """The greatest over all directions, near the greatest of a few."""
        around = max(np.arange(0, 2 * pi, 0.4), key=lambda angle: extreme(angle, sign))
        near = {"bounds": (around - 0.4, around + 0.4), "method": "bounded", "options": {"xatol": 1e-3}}
        return -float(minimize_scalar(lambda angle: -extreme(angle, sign), **near).fun)

    # What elements misplace is of second order in their size, what the direction's search misses too.
    tolerance = (high - low) * (steps.max() ** 2 + 1e-5)
    assert solution.friction_force_min == pytest.approx(best(1), abs=tolerance)
    assert solution.friction_force_max == pytest.approx(best(-1), abs=tolerance)


@pytest.mark.parametrize("words", [HARDLY_LOADED, JUST_HOLDS, *GRIPPING[:3]])
def test_bounds_to_the_last_digit(words: str) -> None:
    """Both bounds from their definitions, the least one by minimising it, at 300 digits."""
    scene = inputs(words)
    with mpmath.workdps(300):
        s = solve(**scene, digits=300)
        low, high = sorted((mpmath.mpf(str(s.tension_1)), mpmath.mpf(str(s.tension_2))))
        mu, phi = mpmath.mpf(scene["mu"]), mpmath.radians(mpmath.mpf(scene["wrap"]))
        alpha = mpmath.log(high / low) / mu
        share = mu / mpmath.sqrt(1 + mu**2)

        def squared(lead: Any) -> Any:
            bridge = low * mpmath.exp(mpmath.mpc(mu, 1) * lead) * (1 - mpmath.expj(phi - alpha))
            return abs(bridge + high * mpmath.expj(phi) - low) ** 2

        # The square's derivative, from its definition; a root of it is found by bisection.
        def falls(lead: Any) -> bool:
            h = alpha * mpmath.mpf(10) ** -100
            return bool(squared(lead + h) < squared(lead - h))

        assert falls(alpha / 10**9)
        assert not falls(alpha)
        low_lead, high_lead = mpmath.mpf(0), alpha
        for _ in range(230):
            lead = (low_lead + high_lead) / 2
            low_lead, high_lead = (lead, high_lead) if falls(lead) else (low_lead, lead)
        least = share * mpmath.sqrt(squared(lead))
        greatest = share * abs(high * mpmath.expj(alpha) - low)
        for digits in (None, 40):
            t = solve(**scene, digits=digits)
            for got, want in ((t.friction_force_min, least), (t.friction_force_max, greatest)):
                # (mpmath's own nstr would round a near tie the wrong way, at M = 1e-30.)
                mantissa, exponent = want.man_exp
                assert got == oracle.round_exact(Fraction(mantissa) * Fraction(2) ** exponent, digits)
