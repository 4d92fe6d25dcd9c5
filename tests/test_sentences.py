"""Every sentence said of a scene is true: what it claims is asked of the oracle, at the numbers it names."""

import re
from collections import Counter
from collections.abc import Callable
from decimal import Decimal
from fractions import Fraction
from math import inf
from random import Random
from typing import Any

import pytest

from atwood_cli.explain.messages import notes, unmarked
from atwood_cli.reading.scenes import read_answers
from atwood_cli.solver import answers as answers_
from atwood_cli.solver import quantities as reasons
from atwood_cli.solver.answers import Answers
from atwood_cli.solver.scene import Motion, Scene

from .conftest import many
from .tools import oracle
from .tools.scenes import any_scene, read_scene

NUMBER = r"([-+\d.e]+)"


class Claims:
    """A scene, and what the oracle says of it and of others like it."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.heavy = "m1" if scene.m1 > scene.m2 else "m2"
        self.l, self.h = sorted((scene.m1, scene.m2))
        self.b = (scene.axle or Fraction(0)) / scene.g

    def regime(self, **other: Any) -> str:
        return str(self.expected(**other)["regime"])

    def expected(self, pulley: Any = None, h: Fraction | None = None, **other: Any) -> dict[str, Any]:
        """The oracle's answers with another pulley, of that mass at the rim, another heavier mass, or mu."""
        if pulley is not None:
            other |= {"M": pulley, "I": None, "inertia": Fraction(1)}
        if h is not None:
            other[self.heavy] = h
        return oracle.expected(self.scene._replace(**other))

    def any_pulley(self, **other: Any) -> set[str]:
        """The regimes on pulleys from none to a locked one; all that turn are as one with an axle."""
        masses = [Fraction(m) for m in ("1e-9", "0.01", "1", "1e9")]
        return {self.regime(pulley=m, **other) for m in [*masses, *[Fraction(0)] * bool(self.b), inf]}

    def least_mu(self, text: str, **other: Any) -> None:
        """A mu that rounds up to that one does not hold the string, and one that rounds down to it does."""
        assert self.regime(mu=above(text), mu_k=None, **other) == "no-slip", text
        assert self.regime(mu=below(text), mu_k=None, **other) == "slip", text

    def least_mass(self, text: str) -> None:
        """Under a heavier mass that rounds up to that one no pulley slips; under one that rounds down a locked one does."""
        assert self.regime(pulley=inf, h=below(text)) == "no-slip", text
        assert self.regime(pulley=inf, h=above(text)) == "slip", text


def is_shown(shown: str, value: Any, digits: int) -> bool:
    """Whether a number is the oracle's, rounded to so many digits."""
    return Decimal(shown) == oracle.correctly_rounded(value, digits)


def last_place(text: str) -> Fraction:
    """One in the last digit of a number of three at least, some of which may be zeros before the point."""
    number = Decimal(text)
    exponent = number.as_tuple().exponent
    assert isinstance(exponent, int)
    zeros = (len(text) - len(text.rstrip("0"))) * (exponent == 0)
    return Fraction(10) ** (exponent + min(zeros, max(number.adjusted() - 2, 0)))


def below(text: str) -> Fraction:
    """Half of one in the last digit below a number."""
    return max(Fraction(text) - last_place(text) / 2, Fraction(0))


def above(text: str) -> Fraction:
    return Fraction(text) + last_place(text) / 2


# By the words of a sentence, what is asked of the oracle: the scene, its numbers and words, digits of the table.


def rest(c: Claims, held: str, then: str, digits: int) -> None:
    assert below(held) <= c.b <= above(held)
    assert c.h - c.l <= min(c.b, Fraction(held))
    if match := re.search(f"at least {NUMBER}(\\.$|;| is needed)", then):
        c.least_mu(match[1])


def on_the_verge(c: Claims, critical: str, a: str, locked: str, digits: int) -> None:
    assert Fraction(locked) > (c.scene.mu or 0)
    c.least_mu(locked, pulley=inf)
    assert is_shown(critical, c.expected()["critical_pulley_mass"], digits)
    for factor, regime in (("0.99", "no-slip"), ("1.01", "slip")):
        assert c.regime(M=Fraction(critical) * Fraction(factor) ** (1 if digits > 2 else 60)) == regime
    assert is_shown(a, c.expected(pulley=Fraction(0), mu=None, mu_k=None)["acceleration"], digits)


def slips_on_any(c: Claims, mu: str, least: str, kinetic: str, digits: int) -> None:
    assert (c.any_pulley(), Fraction(mu)) == ({"slip"}, c.scene.mu)
    assert Fraction(mu) < Fraction(least)
    c.least_mu(least, pulley=Fraction(0))


def slips(c: Claims, where: str, mu: str, least: str, kinetic: str, digits: int) -> None:
    answers = c.expected()
    assert (answers["regime"], Fraction(mu)) == ("slip", c.scene.mu)
    assert Fraction(mu) < Fraction(least)
    assert bool(where) == (c.b > 0 and answers["rim_acceleration"] == 0 and c.scene.M != inf)
    assert (kinetic != "") == (c.scene.mu_k is not None)
    assert not kinetic or Fraction(kinetic.split()[-1]) == c.scene.mu_k
    c.least_mu(least)


def assumed(c: Claims, where: str, least: str, locked: str, digits: int) -> None:
    assert bool(locked) == (c.scene.M == inf)
    is_massless = c.scene.M is None and c.scene.I is None
    assert where.startswith("On a massless pulley") == is_massless
    c.least_mu(least, **({"pulley": Fraction(0)} if is_massless else {}))


def holds(c: Claims, mu: str, least: str, digits: int) -> None:
    assert c.regime() == "no-slip"
    assert Fraction(least) < Fraction(mu) == c.scene.mu
    c.least_mu(least)


def holds_on_any(c: Claims, least: str, digits: int) -> None:
    assert c.h < Fraction(least)
    assert c.any_pulley() == {"no-slip"}
    c.least_mass(least)


OPEN = ("acceleration", "tension_1", "tension_2", "mu_verge")
"""What has a range of values on a pulley of unknown mass."""


def open_range(c: Claims, *numbers: Any) -> None:
    *shown, digits = numbers
    ends = [c.expected(pulley=mass, mu=None, mu_k=None) for mass in (Fraction(0), inf)]
    values = [end[name] for name in OPEN for end in ends]
    assert all(is_shown(*pair, digits) for pair in zip(shown, values, strict=True))


def may_slip_somewhere(c: Claims) -> bool:
    """Whether the string slips on this pulley under some heavier mass: the ratio is greatest at these."""
    return "slip" in {c.regime(h=c.l + c.b), c.regime(h=c.h * 10**300)}


def inertia(c: Claims, shown: str, digits: int) -> None:
    scene: Any = c.scene
    beta = scene.I / scene.M / scene.R**2 if scene.inertia is None else scene.inertia
    assert Fraction(shown) > 1
    off = abs(Fraction(shown) / beta - 1)
    assert off == 0 or (scene.I is not None and off < Fraction(1, 10 ** (digits - 1)))


def weights(c: Claims, x: str, weight: str, mass: str, digits: int) -> None:
    assert Fraction(weight) == getattr(c.scene, x) * c.scene.g
    assert abs(Fraction(mass) * c.scene.g / Fraction(weight) - 1) < Fraction(1, 10 ** (digits - 1))


def short_wrap(c: Claims, *numbers: Any) -> None:
    assert {*map(Fraction, numbers[:-1])} == {c.scene.wrap.number}
    assert c.scene.wrap.unit == "°"


def out_of_range(c: Claims, names: str, why: str, digits: int) -> None:
    answers = c.expected()
    for name in {*names.split(", ")} - {*oracle.BOUNDS}:
        as_decimal, as_double = (oracle.correctly_rounded(answers[name], n) for n in (6, None))
        assert {
            answers_.TOO_LARGE: as_decimal == inf,
            answers_.ABOVE_DOUBLES: abs(as_double) == inf,
            answers_.TOO_SMALL: as_decimal == 0,
            answers_.BELOW_DOUBLES: as_double == 0 != as_decimal,
        }[why], name


def claimed(truth: Callable[[Claims], bool]) -> Callable[..., None]:
    def asserted(c: Claims, *_: Any) -> None:
        assert truth(c)

    return asserted


RANGES = "|".join(
    map(re.escape, (answers_.TOO_LARGE, answers_.TOO_SMALL, answers_.ABOVE_DOUBLES, answers_.BELOW_DOUBLES))
)
KINETIC = "(; it slides with mu_k = .*)?"
SENTENCES: dict[str, Callable[..., None]] = {
    r"At rest: the masses are equal, so no friction is needed\.": claimed(lambda c: c.scene.m1 == c.scene.m2),
    rf"At rest: axle friction can hold a difference of masses of up to {NUMBER} kg\.(.*)": rest,
    r"Slips on any pulley with mass, as mu = 0; the values are for a massless pulley\.": claimed(
        lambda c: c.any_pulley() == {"slip"} and c.regime(pulley=Fraction(0)) == "no-slip"
    ),
    rf"On the verge of slipping: as M is not given, this is for the critical pulley mass, {NUMBER} kg\. On a"
    rf" heavier pulley the string slips; on a massless one the acceleration is {NUMBER} m/s²\. On a locked"
    rf" pulley \(--M inf\) it slips: that needs mu of at least {NUMBER}\.": on_the_verge,
    rf"Slips on any pulley, because of axle friction: mu = {NUMBER} is below the {NUMBER} needed even on a"
    rf" massless one{KINETIC}\.": slips_on_any,
    rf"Slips( over a pulley held by axle friction)?: mu = {NUMBER} is below the {NUMBER} needed to hold"
    rf" the string{KINETIC}\.": slips,
    r"No slip: a massless pulley needs no friction to turn, so both tensions are equal\.": claimed(
        lambda c: c.l == 0 or c.expected(pulley=Fraction(0), mu=Fraction(0))["regime"] == "no-slip"
    ),
    r"No slip: the string's end is fixed to the pulley\.": claimed(lambda c: c.l == 0),
    rf"Without mu, no slip is assumed\. (On a massless pulley, t|T)hat needs mu of at least {NUMBER}"
    r"(; for a pulley without friction, give mu = 0)?\.": assumed,
    rf"No slip: mu = {NUMBER}, and at least {NUMBER} is needed\.": holds,
    rf"No slip on any pulley: a heavy enough one makes the string slip only if the heavier mass is above {NUMBER} kg\.": holds_on_any,
    r"No slip on any pulley, for any heavier mass that can be typed\.": claimed(
        lambda c: c.regime(pulley=inf, h=Fraction(10**500)) == "no-slip"
    ),
    r"Far above critical_heavier_mass, the string holds again, .*": claimed(
        lambda c: (c.regime(h=c.l + c.b), c.regime(h=c.h * 10**300)) == ("slip", "no-slip")
    ),
    r"A locked pulley .*, so axle has no effect\.": claimed(lambda c: c.b > 0 and c.scene.M == inf),
    r"M is not given; a drum that does not turn is --M inf\.": claimed(
        lambda c: c.scene.M is c.scene.I is None and c.scene.wrap.number >= 360
    ),
    r"mu_k has no effect here, as the string does not slip\.": claimed(
        lambda c: c.regime(mu_k=None) == c.regime() != "slip"
    ),
    r"A string that already slides keeps sliding, as mu_k is below mu_verge\.": claimed(
        lambda c: c.scene.mu_k != c.scene.mu and c.regime(mu=c.scene.mu_k, mu_k=None) in ("slip", "verge")
    ),
    "As M goes from 0 to inf: "
    + ", ".join(f"{name} from {NUMBER} to {NUMBER}(?: [^,]*)?" for name in OPEN)
    + r"\.": open_range,
    rf"(.*?): ({RANGES})(?:; ask for digits \(--digits 17\) to see it)?\.": out_of_range,
    rf"The inertia factor I/\(M R\^2\) is {NUMBER}, above 1: .*": inertia,
    rf"(m[12]) is a weight of {NUMBER} N, the mass {NUMBER} kg\.": weights,
    rf"(m[12]) is a mass of {NUMBER} kg; for a weight give its unit\.": lambda c, x, mass, digits: claimed(
        lambda c: Fraction(mass) == getattr(c.scene, x) and bool(c.scene.terms)
    )(c),
    r"A pull by hand is not a hanging weight: .* and the acceleration and the other tension differ\.": claimed(
        lambda c: bool(c.scene.terms) and c.expected()["acceleration"] != 0
    ),
    rf"The wrap is {NUMBER}°; for radians write {NUMBER}rad, for turns {NUMBER}turn\.": short_wrap,
}
"""What is said of a scene, and the claim in it."""

REASONS: dict[str, Callable[[Claims], bool]] = {
    reasons.NO_CRITICAL_MASS: lambda c: c.any_pulley() == {"no-slip"},
    reasons.AXLE_HOLDS: lambda c: c.any_pulley() == {"no-slip"} and c.h - c.l <= c.b,
    reasons.ALWAYS_SLIPS: lambda c: c.any_pulley() == {"slip"} and c.b > 0,
    reasons.NO_CRITICAL_HEAVIER_MASS: lambda c: not may_slip_somewhere(c),
    reasons.AXLE_ENOUGH: lambda c: c.any_pulley(h=c.l + c.b) == {"slip"},
    reasons.NO_NEED: lambda c: c.regime(mu=Fraction(0)) == "no-slip" or c.scene.mu == 0,
    reasons.NO_WRAP: lambda c: c.regime(mu=Fraction(0)) == "slip",
    reasons.FIXED_END: lambda c: c.l == 0,
    reasons.DEFINITE: lambda c: c.regime() != "no-slip",
    reasons.NOT_DEFINITE: lambda c: c.regime() == "no-slip" and c.scene.mu is not None,
    reasons.NOT_BOUNDED: lambda c: c.regime() == "no-slip" and c.scene.wrap.number > 180,
    reasons.LONG_WRAP: lambda c: c.scene.wrap.number > 180,
    reasons.NEEDS_MU: lambda c: c.scene.mu is None,
    reasons.NEEDS_M: lambda c: c.scene.M is None,
    reasons.NEEDS_R: lambda c: c.scene.R is None,
    reasons.UNKNOWN_SHAPE: lambda c: c.scene.I is not None and c.scene.M is None,
    reasons.LOCKED_I: lambda c: c.scene.M == inf,
    reasons.LOCKED_AXLE: lambda c: c.scene.M == inf,
    reasons.ONE_SIDED: lambda c: (c.scene.wrap.number - 180) % 360 != 0,
}
"""Why something is missing, and whether that is so."""
SENTENCES |= {f".*: {re.escape(unmarked(why))}\\.": claimed(truth) for why, truth in REASONS.items()}


def near(rng: Random) -> Decimal:
    """A number near 1, or 1."""
    return 1 + rng.choice([-1, 0, 1]) * Decimal(10) ** -rng.randint(1, 9)


def drawn(rng: Random) -> dict[str, str]:
    """A scene of any kind, some of them near a threshold, some with a free end."""
    words = any_scene(rng)
    if rng.random() < 0.1:
        words["wrap"] = rng.choice(["0.5", "3.14", "12.5"])
    scene, masses = read_scene(words), [Decimal(words[x]) for x in ("m1", "m2")]
    if "axle" in words and rng.random() < 0.3:
        words["axle"] = str(abs(masses[0] - masses[1]) * Decimal(float(scene.g)) * near(rng))
    if rng.random() < 0.1:
        words |= {x: f"{words[x]}N" for x in rng.choice([["m1"], ["m2"], ["m1", "m2"]])}
    if "mu" not in words:
        return words | {"m1": "0"} if rng.random() < 0.1 else words
    words.pop("mu_k", None)
    verge = Answers(read_scene({**words, "mu": None}), 20)["mu_verge"]
    if verge and rng.random() < 0.4:
        words["mu"] = str(verge * near(rng))
    critical = Answers(read_scene(words), 20)["critical_heavier_mass"]
    if critical and rng.random() < 0.4:
        words["m1" if masses[0] > masses[1] else "m2"] = str(critical * near(rng))
    if rng.random() < 0.4:
        words["mu_k"] = str(Decimal(words["mu"]) * Decimal(rng.choice(["0", "0.3", "0.9", "0.9999", "1"])))
    return words


@pytest.mark.parametrize("seed", range(4))
def test_every_sentence_is_true(seed: int) -> None:
    rng, said = Random(f"sentences {seed}"), Counter[str]()
    for _ in range(many(240)):
        words, digits = drawn(rng), rng.choice([None, 2, 12])
        try:
            scene = read_scene(words)
        except ValueError:
            continue
        answers, claims = Answers(scene, digits), Claims(scene)
        missing = [name for name in answers.names if answers[name] is None]
        sentences = notes(answers, answers.names)
        assert all(any(name in sentence for sentence in sentences) for name in missing), words
        for sentence in sentences:
            try:
                match = next(filter(None, (re.fullmatch(known, sentence) for known in SENTENCES)))
                SENTENCES[match.re.pattern](claims, *(group or "" for group in match.groups()), digits or 6)
            except Exception as error:
                raise AssertionError(f"{words}, digits={digits}: {sentence}") from error
            said[match.re.pattern] += 1
    assert len(said) > 10, said


def test_the_least_friction_of_an_axle_holds_masses_at_rest_and_less_does_not() -> None:
    rng = Random("at rest")
    for _ in range(many(40)):
        words = {x: str(rng.randint(1, 999)) for x in ("m1", "m2", "M")}
        if words["m1"] == words["m2"]:
            continue
        answers = read_answers({**words, "a": "0", "find": "axle"}, None)
        assert any("axle is the least friction that holds them" in one for one in notes(answers, []))
        scene: Any = answers.decided.scene
        moves = [
            oracle.expected(scene._replace(axle=scene.axle * of, motion=Motion()))["acceleration"]
            for of in (Fraction(1), Fraction(999, 1000))
        ]
        assert [moves[0] == 0, moves[1] == 0] == [True, False]
