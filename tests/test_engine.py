"""The motion without slip against MuJoCo, a physics engine that knows no formula of Atwood's machine.

The engine is told of two masses on vertical slides, a pulley on a hinge and a string that makes them
move as one, and integrates Newton's laws. Its string is no exact constraint: each half is a spring,
critically damped, with the time constant TIME. Falling masses stretch it by a constant length, and from
then on everything accelerates as on a rigid string. Until then the disagreement falls as e^{-0.76 t/TIME},
whatever the spring's stiffness: over the scenes below it was at most 3e-4 at 10 TIME, 1e-7 at 20, and at 40
what doubles leave, at most 1e-10. The engine's usual tolerance would end its iterations at 7e-10.

R is 1 m, as the engine weighs the two ends of a joint constraint without regard to their units, and a
hinge of too small a moment would leave the spring soft.
"""

from math import log, pi
from typing import Any

import pytest

from atwood_cli import Solution, solve

mujoco = pytest.importorskip("mujoco", reason="MuJoCo is not installed: no second opinion from an engine")

TIME = 0.01  # s
STEPS_PER_TIME = 10
SETTLED = 40  # times TIME
DISAGREEMENT = 1e-8

PULLEYS = {
    "disk": '<geom type="cylinder" size="1 0.01" mass="{M!r}"/>',  # the engine works out the moments
    "sphere": '<geom type="sphere" size="1" mass="{M!r}"/>',
    "shell": '<geom type="sphere" size="1" mass="{M!r}" shellinertia="true"/>',
    "hoop": '<inertial pos="0 0 0" mass="{M!r}" diaginertia="{half!r} {half!r} {M!r}"/>',
}

MACHINE = """
<mujoco>
  <option gravity="0 {down!r} 0" timestep="{step!r}" tolerance="0"> <flag contact="disable"/> </option>
  <default> <equality solref="{time!r} 1" solimp="0.9999 0.9999 1"/> </default>
  <worldbody>
    <body> <joint name="m1" type="slide" axis="0 1 0"/> <geom size="0.1" mass="{m1!r}"/> </body>
    <body> <joint name="m2" type="slide" axis="0 -1 0"/> <geom size="0.1" mass="{m2!r}"/> </body>
    <body> <joint name="pulley" type="hinge" axis="0 0 1" frictionloss="{axle!r}"/> {pulley} </body>
  </worldbody>
  <equality>
    <joint joint1="m1" joint2="pulley" polycoef="0 1 0 0 0"/>
    <joint joint1="m2" joint2="pulley" polycoef="0 1 0 0 0"/>
  </equality>
</mujoco>
"""


def simulated(
    m1: float, m2: float, M: float, g: float = 9.80665, inertia: str = "disk", axle: float = 0
) -> dict[str, float]:
    """What the engine finds; m1 counts upwards, m2 downwards, the pulley the way that m2 descends."""
    pulley = PULLEYS[inertia].format(M=M, half=M / 2)
    step = TIME / STEPS_PER_TIME
    model = mujoco.MjModel.from_xml_string(
        MACHINE.format(m1=m1, m2=m2, pulley=pulley, axle=axle, down=-g, time=TIME, step=step)
    )
    data = mujoco.MjData(model)
    for _ in range(SETTLED * STEPS_PER_TIME):
        mujoco.mj_step(model, data)
    mujoco.mj_forward(model, data)
    up, down, rim = map(float, data.qacc)
    pull_1, push_2, torque = map(float, data.qfrc_constraint)  # by the string, and the axle's friction
    return {
        "acceleration of m1": up,
        "acceleration of m2": down,
        "rim_acceleration": rim,
        "tension_1": pull_1,
        "tension_2": -push_2,
        "torque": torque + (axle if m2 > m1 else -axle),
    }


def disagreement(measured: dict[str, float], solution: Solution[float]) -> float:
    """The greatest relative one."""
    wanted: dict[str, float] = {name: getattr(solution, name.split(" of ")[0]) for name in measured}
    return max(abs(value / wanted[name] - 1) for name, value in measured.items())


SCENES: dict[str, dict[str, float]] = {
    "the reference": {"m1": 1, "m2": 3, "M": 10},
    "m1 heavier": {"m1": 3, "m2": 1, "M": 10},
    "a light pulley": {"m1": 1, "m2": 3, "M": 0.01},
    "a heavy pulley": {"m1": 1, "m2": 3, "M": 1e4},
    "masses nearly equal": {"m1": 1, "m2": 1.01, "M": 2},
    "masses unlike": {"m1": 0.02, "m2": 5, "M": 0.3},
    "an axle that rubs": {"m1": 1, "m2": 3, "M": 10, "axle": 5},
    "one that rubs against m1": {"m1": 0.207, "m2": 0.2, "M": 0.084, "axle": 0.0153},
    "on the moon": {"m1": 0.2, "m2": 0.25, "M": 0.1, "g": 1.62},
}


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("inertia", PULLEYS)
def test_an_engine_finds_the_same_motion(scene: str, inertia: str) -> None:
    given: dict[str, Any] = SCENES[scene] | {"inertia": inertia}
    solution = solve(**given, R=1)
    assert solution.regime == "no-slip"
    assert disagreement(simulated(**given), solution) < DISAGREEMENT


def test_on_the_critical_pulley_the_engines_tensions_are_on_the_verge() -> None:
    verge = solve(m1=1, m2=3, mu="0.3", R=1)
    assert verge.critical_pulley_mass is not None
    measured = simulated(1, 3, verge.critical_pulley_mass)
    assert disagreement(measured, verge) < DISAGREEMENT
    assert log(measured["tension_2"] / measured["tension_1"]) / pi == pytest.approx(0.3, rel=DISAGREEMENT)
