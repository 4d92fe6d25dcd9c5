"""What is typed: the grammar of numbers, units, what each means, and what is refused, with parameter, value and rule."""

import re
from decimal import Decimal
from fractions import Fraction
from math import inf, nan
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from atwood_cli import SceneError, solve
from atwood_cli.reading.units import UNITS
from atwood_cli.solver.scene import Angle

from .tools.scenes import read_scene

NUMBER = re.compile(r"\s*[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?\s*", re.ASCII)


def error(**given: Any) -> str:
    with pytest.raises(SceneError) as caught:
        solve(**{"m1": "1", "m2": "3", **given})
    return str(caught.value)


NOT_A_NUMBER = "is not a number; write it like 2, 1/3 or 1.5e-3"
FINITE = "must be 0 or more, and finite"
TYPES = "must be text or a number (str, int, float, Decimal, Fraction)"
UNCERTAIN = """is not a number with its uncertainty; write it like 1.000±0.002, 1.000+-0.002 or 1.000(2), without a point in \
the brackets, and a unit after that"""
TOO_LONG = "is too long; numerator and denominator may have 1500 digits"
RULES: list[tuple[str, list[Any], str]] = [
    ("m1", [-1.5, nan, inf, Decimal("sNaN")], FINITE),
    ("m1", [np.str_("1,5")], "has a comma; write a decimal point, and nothing between thousands"),
    ("m1", ["1" * 1001], "has 1001 digits; at most 1000 are taken"),
    ("m1", [Decimal("1e9999999"), f"1.{'1' * 999}/{'7' * 999}e500"], TOO_LONG),
    ("m1", ["4" * 1000 + "lb"], "has 1008 digits, its unit included; at most 1000 are taken"),
    ("m1", [f"1 kg{'*st^9' * 20_000}"], NOT_A_NUMBER),
    ("m1", ["1.0()", "1±", "1±-1", "1g±1", "1kg±1g", "inf±1"], UNCERTAIN),
    ("g", ["moon±0.1"], UNCERTAIN),
    ("a", [nan, -inf], "must be finite"),
    ("digits", [0, -1, 1001, 2.5, "", "six", "99999", True], "must be a whole number from 1 to 1000"),
    ("axle", [(1, "N")], TYPES),
    ("R", [Angle(1)], TYPES),
    ("R", [[1, 2], np.ones(2)], f"{TYPES}; for many see solve_arrays"),
    ("m1", [True, b"1", 1j, np.timedelta64(1, "s"), np.datetime64("2020")], TYPES),
]
"""By parameter, values that it must not have, and why; what can be typed stands in cases/inputs.md."""


@pytest.mark.parametrize(
    ("name", "value", "rule"), [(name, value, rule) for name, values, rule in RULES for value in values]
)
def test_a_value_that_is_refused(name: str, value: Any, rule: str) -> None:
    shown = repr(str(value) if isinstance(value, str) else value)
    shown = shown if len(shown) <= 60 else f"{shown[:40]}...{shown[-10:]}"
    assert error(**{name: value}) == f"{name} {shown} {rule}"


def test_kinetic_friction_above_static_is_shown_exactly() -> None:
    rule, long = "must not be above mu:", f"0.{'3' * 500}"
    assert error(mu=0.3, mu_k="0.3") == f"mu_k '0.3' {rule} 0.3 > {Decimal.from_float(0.3)}"
    shown = f"0.{'3' * 38}...{'3' * 9}1 > 0.{'3' * 38}...{'3' * 10}"
    assert error(mu=long, mu_k=f"{long}1") == f"mu_k '0.{'3' * 37}...{'3' * 8}1' {rule} {shown}"


def test_an_int_too_long_to_write_out_is_still_an_error_that_can_be_shown() -> None:
    for long in (Decimal("1." + "0" * 10**6), Decimal("1." + "3" * 10**6), Decimal("3" * 10**6)):
        assert error(m1=long).endswith(TOO_LONG)
    assert error(m1=10**5000) == f"m1 <int> {TOO_LONG}"
    assert error(m1=Fraction(1, 10**1500)).endswith(TOO_LONG)
    assert read_scene({"m1": Fraction(1, 10**1500 - 1), "m2": "1"}).m1.denominator == 10**1500 - 1


@pytest.mark.parametrize(("m1", "m2", "a"), [(1, 3, 9), (3, 1, -9), (1, "1.1", 9), (7, "2.9", -9)])
def test_about_the_greatest_acceleration_that_an_error_names_is_taken(m1: Any, m2: Any, a: int) -> None:
    greatest = error(m1=m1, m2=m2, M="inf", a=a).split("without friction the acceleration is ")[1].split()[0]
    assert solve(m1=m1, m2=m2, M="inf", a=Fraction(greatest) * Fraction("0.99999")).mu_k is not None


def test_error_carries_its_parts() -> None:
    with pytest.raises(ValueError, match="mu_k") as caught:
        solve(m1=1, m2=3, mu_k=1)
    rule = "needs mu, the coefficient that decides whether it slips"
    assert vars(caught.value) == {"parameter": "mu_k", "value": 1, "rule": rule, "fault": "mu_k without mu"}


@given(
    st.text(alphabet="0123456789.+-e ", max_size=12)
    | st.text("01.-e(/%_ktgµ²\xa0\u2212\u0663\uff11½", max_size=6)
)
def test_the_grammar_of_numbers(text: str) -> None:
    match = NUMBER.fullmatch(text)
    negative = text.strip().startswith("-")
    if match and abs(int((match[3] or "e0")[1:])) <= 500 and not negative:
        assert read_scene({"m1": text, "m2": 1}).m1 == Fraction(text)
    elif match is None or negative:
        try:
            value = read_scene({"m1": text, "m2": 1}).m1
        except SceneError:
            return
        # Only a unit, a sum, a blank of another script, or minus nothing, makes a mass of what is no plain number.
        assert (
            value == 0
            or "+" in text[1:]
            or not text.isascii()
            or text.strip().lower().endswith(tuple(UNITS["mass"]))
        )


# fmt: off
BY_DEFINITION = {
    "mass": "kg 1 g 0.001 mg 0.000001 ug 0.000000001 t 1000 Mg 1000 lb 0.45359237 lbs 0.45359237 oz 0.028349523125 st 6.35029318 slug 44482216152605/3048000000000",
    "length": "m 1 km 1000 dm 0.1 cm 0.01 mm 0.001 um 0.000001 in 0.0254 ft 0.3048 yd 0.9144",
    "angle": "deg 1 ° 1 turn 360 turns 360 rad 1",
    "time": "s 1 ms 0.001 us 0.000001 min 60 h 3600",
    "force": "N 1 mN 0.001 daN 10 kN 1000 lbf 4.4482216152605 kip 4448.2216152605 kgf 9.80665 gf 0.00980665",
    "power": "W 1 kW 1000",
    "energy": "J 1 mJ 0.001 kJ 1000 ft_lbf 1.3558179483314004",
    "torque": "N_m 1 mN_m 0.001 N_cm 0.01 daN_m 10 kN_m 1000 kgf_m 9.80665 lbf_ft 1.3558179483314004 ft_lbf 1.3558179483314004 lbf_in 0.1129848290276167",
    "acceleration": "m/s2 1 m_s-2 1 cm/s2 0.01 ft/s2 0.3048 N/kg 1",
    "angular acceleration": "rad/s2 1 rad_s-2 1",
    "speed": "m/s 1 cm/s 0.01 mm/s 0.001 km/h 5/18 ft/s 0.3048 ft/min 0.00508 mph 0.44704 knot 463/900",
    "angular speed": "rad/s 1 rpm pi/30",
    "moment of inertia": "kg_m2 1 kg_cm2 0.0001 g_cm2 0.0000001 lb_ft2 0.0421401100938048 lb_in2 0.0002926396534292",
}
"""Every unit in those of the SI, by NIST SP 811 (2008), appendix B.8, whose definitions are exact."""
TEXTS: dict[str, dict[str, Any]] = {
    "m1": {
        "+1": 1, ".5": "1/2", "1.": 1, " 1 ": 1, "\xa01\u202f": 1, "-0": 0, "1.5e-3": "3/2000", "1E-3": "1/1000",
        "1e+2": 100, "1e0000000000000003": 1000, "1e500": 10**500, "1e497t": 10**500, "9" * 1000: int("9" * 1000),
        "4" * 1000 + "g": Fraction(int("4" * 1000), 1000), "4" * 992 + "lb": Fraction(int("4" * 992) * 45359237, 10**8),
        "250g": "1/4", "250 g": "1/4", "250\xa0g": "1/4", "2 lb": "0.90718474", "1e3mg": "1/1000",
        "3lbs": "1.36077711", "1 slug": Fraction("4.4482216152605") / Fraction("0.3048"), "2 t": 2000, "3 μg": "3e-9",
        "½": "1/2", "1½": "3/2", "1 ½ g": "3/2000", "+⅞": "7/8", "１２．５": "12.5", "1e−2": "0.01", "3⁄4": "3/4",
        "1/3": "1/3", "1kg/3": "1/3", "1 / 3 kg": "1/3", "-1/-1.5e1": "1/15", "1/3g": "1/3000",
        "80g+5g": "0.085", "80 g + .005 kg": "0.085", "1/3+1e+1": "31/3", "1/3g+1/6g": "1/2000",
        "4*50g": "0.2", "4 × 50 g": "0.2", "0.2 kg*3": "0.6", "80g+4*5g": "0.1", "2/3*3*.5": 1, "-2*3g+7g": "0.001",
    },
    "g": {
        **dict.fromkeys(["9.81m/s2", "9.81 m/s²", "9.81 m/s^2", "981cm/s2", "9.81 m s-2"], "9.81"),
        **dict.fromkeys(["9.81 m s⁻²", "9.81N/kg", "9.81 m·s⁻²"], "9.81"),
        "32ft/s2": "9.7536", "MOON": "1.62", "g/4": "2.4516625", "0.25 g": "2.4516625",
    },
    "I": dict.fromkeys(["3g cm2", "3 g cm²", "3 g*cm^2", "3g·cm²", "3e-3kg cm2", "3e-7 kgm2"], "3e-7"),
    "R": {"2 in": "0.0508", "1 ft": "0.3048", "1yd": "0.9144", "5cm": "0.05", "12cm/2": "0.06", "12 cm / 2": "0.06", "5µm": "5e-6", "2*12cm/2": "0.12"},
    "wrap": {
        "1.5 turn": 540, "90 deg": 90, "90°": 90, "1/2turn": 180, "pi": 180,
        **dict.fromkeys(["3pi/2", "3π/2", "1.5 PI", "3/2*pi", "3 / 2 π", "3π / 2 rad"], 270),
    },
    "M": {" INF ": inf},
    "inertia": {"Hoop": 1, "ring": 1, "disk": "1/2", "sphere": "2/5", "Shell": "2/3"},
}
# fmt: on


@pytest.mark.parametrize("dimension", UNITS)
def test_every_unit_is_the_one_that_is_defined(dimension: str) -> None:
    words = BY_DEFINITION[dimension].split()
    defined = {unit.replace("_", " "): x for unit, x in zip(words[::2], words[1::2], strict=True)}
    assert {
        unit: value for unit, value in UNITS[dimension].items() if value == "pi/30"
    }.items() <= defined.items()
    rational = {unit: Fraction(value) for unit, value in UNITS[dimension].items() if value != "pi/30"}
    assert rational == {unit: Fraction(x) for unit, x in defined.items() if x != "pi/30"}


@pytest.mark.parametrize(
    ("name", "text", "value"), [(name, *pair) for name, pairs in TEXTS.items() for pair in pairs.items()]
)
def test_text_means_exactly_itself(name: str, text: str, value: Any) -> None:
    scene = read_scene({"m1": 1, "m2": 1, "R": 1, name: text})
    read = getattr(scene, name)
    assert getattr(read, "number", read) == (value if value == inf else Fraction(value))


@pytest.mark.parametrize(
    "number", [3, 0.1, Decimal("0.1"), Fraction(1, 3), Decimal("0e99999"), np.float32(0.1), np.int64(3)]
)
def test_numbers_mean_exactly_themselves(number: Any) -> None:
    exact = number.item() if isinstance(number, np.generic) else number
    assert read_scene({"m1": number, "m2": 1}).m1 == Fraction(exact)


@pytest.mark.parametrize("text", ["0.1", "1e4000", "1e-4000", "-inf", "nan"])
def test_a_long_double_is_exact_or_an_error(text: str) -> None:
    """1e4000 was infinite and 1e-4000 was 0, where the platform has them."""
    number: Any = np.longdouble(text)
    exact = Fraction(*number.as_integer_ratio()) if np.isfinite(number) else None
    if exact is None or max(exact.numerator, exact.denominator) >= 10**1500:
        with pytest.raises(SceneError, match=r"^m1 np\.longdouble\('.*'\) (is too long; |must be 0 or more)"):
            read_scene({"m1": number, "m2": 1})
    else:
        assert read_scene({"m1": number, "m2": 1}).m1 == exact
