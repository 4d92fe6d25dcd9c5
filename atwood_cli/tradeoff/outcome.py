"""What follows from what was measured: the settings that none beats, and which of them for which need."""

from collections.abc import Callable, Iterator, Sequence
from decimal import Decimal
from fractions import Fraction
from itertools import groupby
from math import degrees, inf, isinf
from operator import attrgetter
from typing import Any, NamedTuple, TypeVar

from ..arithmetic.rounding import as_typed, text, to_double
from ..model.machine import Undetermined
from ..model.scene import INPUTS, Scene, SceneError
from ..solver.messages import unmarked
from .measure import MARGIN, March, Measured, counts, marches, measure, with_orders
from .scenes import Inputs, draw_scenes

Watch = Callable[[Iterator[Any], int], Iterator[Any]]

PAPERS_SCENE = {"m1": "1", "m2": "3", "mu": "0.3"}


class Overall(NamedTuple):
    """A setting on all families: its time on the first, and the worst that any of them makes of it."""

    setting: str
    seconds: float
    slowest: str | None
    """The family that takes longest, if that is much longer than the first."""
    longest: float
    worst_ulp: float | None
    share_wrong_regime: float


class Tradeoff(NamedTuple):
    """What was measured: of ``scenes`` of each family from the seed, or of one scene (seed None).

    ``scene`` is the one whose e^{μφ} the elements approach.
    """

    scene: Scene
    scenes: int
    seed: int | None
    measured: list[Measured]
    marches: list[March]
    notes: list[str]

    @property
    def families(self) -> list[str]:
        return list(dict.fromkeys(one.family for one in self.measured))

    @property
    def advice(self) -> str:
        return advice(self.measured)


def tradeoff(
    families: Sequence[str], scenes: int, seed: int, scene: Scene | None, elements: int, watch: Watch
) -> Tradeoff:
    """Measure every setting on so many scenes of each family, or on the one scene given. Raises SceneError.

    ``elements`` are the most that are marched. ``watch`` takes the parts of the work, and how many there
    are, and yields them as they are done.
    """
    sets: Iterator[tuple[str, list[Inputs]]] = ((name, draw_scenes(name, scenes, seed)) for name in families)
    if scene is not None:
        sets, families, scenes = iter([("scene", [inputs_of(scene)])]), ["scene"], 1
    measured = [one for part in watch((measure(*each) for each in sets), len(families)) for one in part]
    marched = scene or Scene.read(PAPERS_SCENE)
    run, notes = [], []
    try:
        run = with_orders(list(watch(marches(marched, elements), 2 * len(counts(elements)) + 1)))
    except SceneError as error:
        notes.append(f"String elements {error.rule}.")
    except Undetermined as reason:
        notes.append(unmarked(f"String elements: {reason}."))
    return Tradeoff(marched, scenes, seed if scene is None else None, with_best(measured), run, notes)


def inputs_of(scene: Scene) -> Inputs:
    """A scene as the doubles that it is measured with, m1 the lighter mass. Raises SceneError."""
    inputs: Inputs = {}
    given = scene._asdict() | {"wrap": scene.wrap.number}
    for name in INPUTS:
        if (value := given[name]) is not None:
            inputs[name] = double = to_double(value)
            if isinstance(value, Fraction) and (double == inf or (double == 0 and value)):
                raise SceneError(name, as_typed(value), "is beyond the doubles, which are measured here")
    if scene.wrap.unit == "rad":
        inputs["wrap"] = degrees(inputs["wrap"])
    inputs["m1"], inputs["m2"] = sorted((inputs["m1"], inputs["m2"]))
    return inputs


# The settings


MUCH = 5
"""How many times as long a family must take as the first to be named."""
NEEDS = {"results within 4 ulp": MARGIN, "the nearest double": 0.5, "more digits": 1e-9}

Cost = TypeVar("Cost", Measured, Overall)


def front(settings: Sequence[Cost]) -> list[Cost]:
    """The settings that no other beats: none is both faster and more accurate. The fastest come first."""
    unbeaten = [one for one in settings if not any(_beats(other, one) for other in settings)]
    return sorted(unbeaten, key=lambda one: one.seconds)


def _beats(other: Cost, one: Cost) -> bool:
    mine, others = ((each.seconds, _inaccuracy(each)) for each in (one, other))
    return others != mine and others[0] <= mine[0] and others[1] <= mine[1]


def _inaccuracy(one: Cost) -> tuple[float, float]:
    """Regimes count first: what mistakes fewer of them is the more accurate."""
    return one.share_wrong_regime, inf if one.worst_ulp is None else one.worst_ulp


def with_best(measured: Sequence[Measured]) -> list[Measured]:
    """The settings, those marked that no other beats on their family."""
    best = [one for _, group in groupby(measured, attrgetter("family")) for one in front(list(group))]
    return [one._replace(best=one in best) for one in measured]


def overall(measured: Sequence[Measured]) -> list[Overall]:
    """Each setting on all the families together."""
    by_setting: dict[str, list[Measured]] = {}
    for one in measured:
        by_setting.setdefault(one.setting, []).append(one)
    together = []
    for setting, ones in by_setting.items():
        slowest = max(ones, key=lambda one: one.seconds)
        much = slowest.seconds > MUCH * ones[0].seconds
        worst = max((one.worst_ulp for one in ones if one.worst_ulp is not None), default=None)
        wrong = max(one.share_wrong_regime for one in ones)
        family = slowest.family if much else None
        together.append(Overall(setting, ones[0].seconds, family, slowest.seconds, worst, wrong))
    return together


def advice(measured: Sequence[Measured]) -> str:
    """Which setting for which need, from what was measured: times of the first family, errors of all.

    Where another family takes much longer, that is said too.
    """
    settings = {one.setting: one for one in overall(measured)}
    right = {
        name: one.worst_ulp
        for name, one in settings.items()
        if one.worst_ulp is not None and not one.share_wrong_regime  # a wrong regime is no answer
    }
    wanted: dict[str, list[str]] = {}
    for need, most in NEEDS.items():
        fit = [name for name, off in right.items() if off <= most]
        wanted.setdefault(min(fit, key=lambda name: settings[name].seconds), []).append(need)

    def cost(name: str) -> str:
        one = settings[name]
        more = f", {in_seconds(one.longest)} if {one.slowest}" if one.slowest else ""
        return in_seconds(one.seconds) + " a scene" * (name == next(iter(wanted))) + more

    parts = [f"{name} for {' and '.join(needs)} ({cost(name)})" for name, needs in wanted.items()]
    fast = settings["fast"]
    wrong = fast.share_wrong_regime
    regimes = f" and mistook up to {percent(wrong)} of the regimes" if wrong else ""
    lost = f"; fast ({cost('fast')}) was up to {short(fast.worst_ulp or 0)} ulp off{regimes}"
    return f"Take {', '.join(parts)}{'' if right.get('fast', inf) <= MARGIN else lost}."


def legend(families: int = 1) -> str:
    """What the columns of a table of settings mean, and its settings."""
    of = " of the first family" if families > 1 else ""
    return (
        f"Time: of one scene{of}. Error: of the worst result, in units in the last place of a double (ulp),"
        " 1e-16 of it. Wrong: scenes of which it mistakes whether the string slips. paper: its formulas in"
        " NumPy; fast to exact: accuracies of solve_arrays; digits: of solve."
    )


# String elements


STARS = "* No other setting is both faster and more accurate."
ELEMENTS_LEGEND = (
    "* The least error: with more elements rounding takes over. Order is the power of N by which the error"
    " fell."
)


def elements_in_words(marched: Sequence[March]) -> str:
    """How far the elements come at best, plain and extrapolated, beside the closed form."""
    best = {(one.elements is None, one.extrapolated): one for one in reversed(marched) if one.best}

    def to(one: March) -> str:
        off = f"to {scientific(one.relative_error)}" if one.relative_error else "exactly"
        return f"{off} ({in_seconds(one.seconds)})"

    parts = []
    if plain := best.get((False, False)):
        parts.append(f"At best, {plain.elements:,} string elements give e^(μφ) {to(plain)}")
        if halved := best.get((False, True)):
            parts[0] += f", {halved.elements:,} extrapolated {to(halved)}"
    closed = to(best[True, False])
    parts.append(f"the closed form {closed}." if parts else f"The closed form gives e^(μφ) {closed}.")
    return "; ".join(parts)


# In words


def in_seconds(seconds: float) -> str:
    """A time to three digits, in the unit that fits."""
    shown = {unit: float(f"{seconds / factor:.3g}") for unit, factor in SECONDS.items()}
    unit = next((unit for unit, number in shown.items() if number < 1000), "s")
    return f"{short(shown[unit], 3)} {unit}"


SECONDS = {"ns": 1e-9, "µs": 1e-6, "ms": 1e-3, "s": 1.0}


def short(value: float | None, digits: int = 2) -> str:
    """A number to a few digits; a dash where there is none."""
    if value is None or isinf(value):
        return "-" if value is None else "inf"
    return text(Decimal(f"{value:.{digits}g}"))


def scientific(value: float) -> str:
    """A number to two digits, with its power of ten."""
    mantissa, exponent = f"{value:.1e}".split("e")
    return f"{mantissa}e{int(exponent)}"


def percent(share: float) -> str:
    """A share in percent, to three digits."""
    return f"{short(100 * share, 3)} %"
