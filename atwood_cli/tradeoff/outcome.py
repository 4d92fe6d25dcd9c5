"""What follows from what was measured: the settings that none beats, and which of them for which need."""

from collections.abc import Callable, Iterator, Sequence
from decimal import Decimal
from fractions import Fraction
from math import degrees, inf, isinf
from typing import Any, NamedTuple

from ..arithmetic.rounding import as_typed, text, to_double
from ..model.machine import Undetermined
from ..model.scene import COLUMNS, Scene, SceneError
from ..solver.messages import unmarked
from .measure import (
    MARGIN,
    PRECISE_SCENES,
    TABLE,
    March,
    Measured,
    counts,
    front,
    marches,
    measure,
    with_orders,
)
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
    def front(self) -> list[Overall]:
        """The settings that no other beats, over all families, the fastest first."""
        return sorted(front(overall(self.measured)), key=lambda one: one.seconds)

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
        sets, families = iter([("scene", [inputs_of(scene)])]), ["scene"]
    measured = [one for part in watch((measure(*each) for each in sets), len(families)) for one in part]
    marched = scene or Scene.read(PAPERS_SCENE)
    run, notes = [], []
    try:
        run = with_orders(list(watch(marches(marched, elements), 2 * len(counts(elements)) + 1)))
    except SceneError as error:
        notes.append(f"String elements {error.rule}.")
    except Undetermined as reason:
        notes.append(unmarked(f"String elements: {reason}."))
    if scene is not None:
        return Tradeoff(marched, 1, None, measured, run, notes)
    return Tradeoff(marched, scenes, seed, measured, run, notes)


def inputs_of(scene: Scene) -> Inputs:
    """A scene as the doubles that it is measured with, m1 the lighter mass. Raises SceneError."""
    inputs: Inputs = {}
    given = scene._asdict() | {"wrap": scene.wrap.number}
    for name in COLUMNS:
        if (value := given[name]) is not None:
            inputs[name] = double = to_double(value)
            if isinstance(value, Fraction) and (double == inf or (double == 0 and value)):
                raise SceneError(name, as_typed(value), "is beyond the doubles, which are measured here")
    if scene.I is not None:
        raise SceneError("I", None, "is not measured, as arrays have no such column; give --inertia")
    if scene.wrap.unit == "rad":
        inputs["wrap"] = degrees(inputs["wrap"])
    inputs["m1"], inputs["m2"] = sorted((inputs["m1"], inputs["m2"]))
    return inputs


# The settings


MUCH = 5
"""How many times as long a family must take as the first to be named."""
NEEDS = {"results within 4 ulp": MARGIN, "the nearest double": 0.5, "more digits": 1e-9}


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
    regimes = f" and took up to {percent(wrong)} of the regimes wrongly" if wrong else ""
    lost = f"; fast ({cost('fast')}) was up to {short(fast.worst_ulp or 0)} ulp off{regimes}"
    return f"Take {', '.join(parts)}{'' if right.get('fast', inf) <= MARGIN else lost}."


LEGEND = (
    "* No other setting is both faster and more accurate. Time is for one scene on this machine, of a table"
    f" of at least {TABLE:,} (fewer where they take long) but for digits, ± half the range of its repeats."
    " Errors are in units in the last place (ulp) of a double, a scene's the worst of its quantities', over"
    f" the scenes whose regime is right (with digits, of the first {PRECISE_SCENES}); Over 4 is the share of"
    " them over 4 ulp, Regime the share of scenes whose regime is wrong. paper: the paper's formulas typed"
    " into NumPy."
)


def front_legend(families: int) -> str:
    """What the columns of the front mean, and its settings."""
    of = " of the first family" if families > 1 else ""
    return (
        f"Time: of one scene{of}. Error: of the worst result, in units in the last place of a double (ulp),"
        " 1e-16 of it. Wrong: scenes of which it mistakes whether the string slips. paper: its formulas in"
        " NumPy; fast to exact: accuracies of solve_arrays; digits: of solve."
    )


# String elements


ELEMENTS_LEGEND = (
    "* The least error: with more elements rounding takes over. Order is the power of N by which the error"
    " fell."
)


def elements_in_words(marched: Sequence[March]) -> str:
    """How far the elements come at best, plain and extrapolated, beside the closed form."""
    least: dict[tuple[bool, bool], March] = {}
    for one in marched:
        kind = (one.elements is None, one.extrapolated)
        if kind not in least or one.relative_error < least[kind].relative_error:
            least[kind] = one

    def to(one: March) -> str:
        off = f"to {scientific(one.relative_error)}" if one.relative_error else "exactly"
        return f"{off} ({in_seconds(one.seconds)})"

    parts = []
    if plain := least.get((False, False)):
        parts.append(f"At best, {plain.elements:,} string elements give e^(μφ) {to(plain)}")
        if halved := least.get((False, True)):
            parts[0] += f", {halved.elements:,} extrapolated {to(halved)}"
    closed = to(least[True, False])
    parts.append(f"the closed form {closed}." if parts else f"The closed form gives e^(μφ) {closed}.")
    return "; ".join(parts)


# Pictures


LEAST_DRAWN, GREATEST_DRAWN = 1e-3, 1e16


def drawable(worst_ulp: float | None) -> float:
    """The error as far as a picture shows it."""
    return GREATEST_DRAWN if worst_ulp is None else min(max(worst_ulp, LEAST_DRAWN), GREATEST_DRAWN)


def drawable_marches(marched: Sequence[March]) -> list[list[March]]:
    """Those of elements, then of extrapolated ones, that have an error: of none, there is no logarithm."""
    return [
        [one for one in marched if one.extrapolated == way and one.elements and one.relative_error]
        for way in (False, True)
    ]


# In words


def in_seconds(seconds: float) -> str:
    """A time to three digits, in the unit that fits."""
    shown = (
        f"{short(seconds / factor, 3)} {unit}" for unit, factor in SECONDS.items() if _below(seconds, factor)
    )
    return next(shown, f"{short(seconds, 3)} s")


def _below(seconds: float, factor: float) -> bool:
    """Whether less than a thousand of the unit are shown."""
    return float(f"{seconds / factor:.3g}") < 1000


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


def percent(share: float | None) -> str:
    """A share in percent, to three digits; a dash where there is none."""
    return "-" if share is None else f"{short(100 * share, 3)} %"
