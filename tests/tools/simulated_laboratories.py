"""What `atwood fit` says of laboratories whose truth is known: `python -m tests.tools.simulated_laboratories [SETS]`.

Sets are drawn with a known pulley (c at the rim), axle (f) and delay, with errors of what is measured and of what the
table does not say. Counted are the 95 % intervals that hold the truth, and their widths over the ideal ones (weighted
least squares with the true variances, of the same quantities).
"""

import re
import sys
from collections.abc import Iterator, Sequence
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from scipy import optimize

from atwood_cli.laboratory.columns import Kind
from atwood_cli.laboratory.estimate import Conditions, Fitted
from atwood_cli.laboratory.fitting import conditions_of, fitted
from atwood_cli.laboratory.results import USUAL
from atwood_cli.laboratory.runs import Runs
from atwood_cli.laboratory.statistics import CannotSeparate
from atwood_cli.reading.inputs import read_input
from atwood_cli.solver.scene import INPUTS

C, F, G, DROP = 0.028, 0.009, 9.80665, 1.1
BLUNDER = 0.01
"""kg, of a mass that is mistyped."""
NOTHING = {name: read_input(name, None) for name in INPUTS}
Random = np.random.Generator


class Design(NamedTuple):
    """A laboratory: n runs of some repeats, with the errors that it has.

    ``u`` is that of a single time (s) or acceleration (m/s²), ``masses`` that of each mass (kg), ``axle`` that of the
    axle's friction from run to run, a share; ``stated`` the uncertainties that the table states, times this. A part of
    ``u`` is ``common`` to all runs. Times are read to the ``step`` and too long by the ``delay`` (s). Times of runs
    scatter by ``between`` (s, the root of the mean square), by errors ``of`` the time, of it as a share, of the
    acceleration or of the force.
    """

    runs: int
    repeats: int
    u: float
    sums: str = "constant"
    kind: Kind = "time"
    masses: float = 0.0
    axle: float = 0.0
    stated: float = 0.0
    step: float = 0.0
    delay: float = 0.0
    common: float = 0.0
    between: float = 0.0
    of: str = "time"

    def __str__(self) -> str:
        """What differs from the usual."""
        usual = self._field_defaults
        names = [name for name, value in self._asdict().items() if value != usual.get(name)]
        return ", ".join(f"{name} {getattr(self, name)}" for name in names)


ERRORS: tuple[Any, ...] = ({}, {"masses": 2e-4}, {"axle": 0.1})
CELLS = [
    Design(runs, repeats, u, "vary", **more)
    for runs, repeats in ((3, 5), (6, 3), (12, 3), (8, 5))
    for u in (0.05, 1e-3, 1e-4)
    for more in ERRORS
]
"""The designs that decided how degrees of freedom are counted."""
OTHERS = [
    *(Design(*size, 0.05, **more) for size in ((3, 5), (6, 3), (8, 5)) for more in ERRORS[:2]),
    Design(8, 1, 0.05),
    Design(8, 1, 0.01, kind="a"),
    Design(8, 3, 0.01, "vary", kind="a"),
    *(Design(8, repeats, 0.05, masses=2e-4, stated=1.0) for repeats in (3, 1)),
    *(Design(runs, repeats, 1e-4, step=1e-3) for runs, repeats in ((8, 5), (6, 3))),
    *(Design(8, repeats, 0.05, step=0.01) for repeats in (3, 1)),
]
"""Masses with a constant sum, which show a variance between runs least; accelerations; readings in steps."""
STATED = [
    *(Design(n, 1, 0.05, "vary", stated=times) for times in (1.0, 0.5, 0.2, 3.0) for n in (3, 5, 8, 12)),
    *(Design(n, 1, 0.05, "vary", stated=1.0, common=0.046) for n in (3, 5, 8, 12)),
    *(Design(n, 3, 0.05, "vary", stated=1.0) for n in (3, 5, 8, 12)),
]
"""Stated uncertainties: right, too small, too large, mostly common to all runs; with repeats."""
SCATTER = {
    of: [
        Design(runs, repeats, 0.02, sums, of=of, between=0.03 if of != "nothing" else 0.0)
        for runs, repeats, sums in ((4, 5, "vary"), (5, 4, "vary"), (6, 3, "constant"), (8, 3, "vary"))
    ]
    for of in ("nothing", "time", "share", "acceleration", "force")
}
"""What may differ between runs, and the designs that show it."""
CAUSES: dict[str, tuple[dict[str, str], Sequence[str], float, str, dict[str, int]]] = {
    "nothing": ({}, USUAL, 0.0, "none", {"both": 0, "vary": 0}),
    "M 50 % low": ({"M": "28g"}, ["axle"], 0.0, "rim_mass is", {"both": 92, "vary": 83}),
    "axle 0": ({"axle": "0"}, ["rim_mass"], 0.0, "axle is", {"both": 97, "vary": 97}),
    "axle 0, gravity": ({"axle": "0", "M": "56g"}, ["gravity"], 0.0, "axle is", {"vary": 93}),
    "g 5 % low": ({"g": "9.316", "M": "56g"}, ["axle"], 0.0, "gravity", {"both": 81}),
    "delay of 0.15 s": ({}, USUAL, 0.15, "all times", {"both": 99}),
}
"""By what is wrong: what is given, what is fitted, the delay, the words of the right cause, and the share (%) of sets in
which it should be named, by how masses vary."""
BESIDE_DELAY: list[tuple[list[str], dict[str, str]]] = [
    (["rim_mass", "delay"], {"axle": "9mN"}),
    (["gravity", "delay"], {"axle": "9mN", "M": "56g"}),
    (["rim_mass", "axle", "delay"], {}),
]
"""Quantities that are fitted beside a delay, and what is given."""
DELAYS = [
    Design(*one) for one in ((8, 5, 0.05, "both"), (8, 3, 0.05, "drops"), (6, 3, 0.05), (8, 5, 0.05, "one"))
]


def runs_of(
    kind: Kind, l: Any, h: Any, drop: Any, values: Any, u: float = 0.0, u_mass: float = 0.0, step: float = 0.0
) -> Runs:
    """Runs with these masses and heights (n), of repeats ``values`` (n, repeats)."""
    (n, repeats), none = values.shape, 0 * l
    given, u_given = {"m1": l.round(13), "m2": h.round(13)}, dict.fromkeys(("m1", "m2"), none + u_mass)
    if kind == "time":
        given, u_given = given | {"drop": drop}, u_given | {"drop": none}
    run, rows = np.repeat(np.arange(n), repeats), [[i + 1] for i in range(n)]
    all_, cells = values.round(13).ravel(), [f"{i + 1}:t{k}" for i in range(n) for k in range(repeats)]
    mean = values.mean(1)
    return Runs(kind, given, u_given, rows, none > 0, mean, all_, 0 * all_ + u, run, cells, step)


class Set(NamedTuple):
    """The masses and heights as the table has them, and what is measured: (runs, repeats)."""

    design: Design
    l: Any
    h: Any
    drop: Any
    values: Any

    def runs(self) -> Runs:
        d = self.design
        errors = d.stated * d.u, d.masses * bool(d.stated), d.step or 1e-13
        return runs_of(d.kind, self.l, self.h, self.drop, self.values, *errors)

    def fit(self, *more: str, given: Conditions | None = None, find: Sequence[str] = USUAL) -> Fitted:
        return fitted(self.runs(), given or given_as(), [*find, *more])


def given_as(**typed: str) -> Conditions:
    """What is given, as typed."""
    return conditions_of(NOTHING | {name: read_input(name, word) for name, word in typed.items()})


def cause_of(fit: Fitted) -> str:
    """What is said to repair the fit, "" if nothing is."""
    return fit.cause if "fit better if" in fit.cause else ""


def expected(kind: Kind, l: Any, h: Any, c: Any, f: Any, g: Any = G, drop: Any = DROP) -> Any:
    """The acceleration, or the time of the fall, as in a textbook."""
    a = ((h - l) * g - f) / (l + h + c)
    return a if kind == "a" else np.sqrt(2 * drop / np.maximum(a, 1e-6))


def by_scipy(kind: Kind, l: Any, h: Any, measured: Any, names: Any = USUAL, **known: Any) -> tuple[Any, Any]:
    """The values of these names by least squares, with ``sigma`` as uncertainties, and their covariance."""
    usual = {"rim_mass": C, "axle": F, "gravity": G, "drop": DROP, "delay": 0.0, "off": 0.0, "which": 0.0}
    known = {"sigma": None, **usual, **known}

    def ideal(_: Any, *values: float) -> Any:
        x = known | dict(zip(names, values, strict=True))
        of_fall = expected(kind, l, h, x["rim_mass"], x["axle"], x["gravity"], x["drop"])
        return of_fall + x["delay"] + x["off"] * x["which"]

    start = [{"rim_mass": 0.03, "axle": 0.01, "gravity": G, "delay": 0.3, "off": 0.0}[name] for name in names]
    tight: Any = dict.fromkeys(("xtol", "ftol", "gtol"), 1e-15) | {"jac": "3-point", "x_scale": "jac"}
    absolute = known["sigma"] is not None
    found = optimize.curve_fit(ideal, l, measured, start, known["sigma"], absolute, method="trf", **tight)
    return found[0], found[1]


def masses_of(design: Design) -> tuple[Any, Any, Any]:
    """The masses and heights of a design."""
    n, drop = design.runs, np.full(design.runs, DROP)
    if design.sums == "vary":
        l = np.linspace(0.1, 0.28, n)
        return l, l + np.linspace(0.05, 0.012, n), drop
    if design.sums == "drops":
        l = np.linspace(0.1, 0.4, n)
        return l, l + 0.02, np.where(np.arange(n) % 2, 0.5, 1.5)
    if design.sums == "one":
        l = np.linspace(0.1, 0.3, n)
        return l, l + 0.02, drop
    total, difference = np.full(n, 0.45), np.linspace(0.008, 0.045, n)
    if design.sums == "both":
        total, difference = np.repeat((0.2, 0.6), n // 2), np.tile(np.linspace(0.015, 0.05, n // 2), 2)
    return (total - difference) / 2, (total + difference) / 2, drop


def between_runs(design: Design, l: Any, h: Any, drop: Any) -> Any:
    """The standard deviation of each run's time, beyond that of its repeats."""
    t = expected("time", l, h, C, F, drop=drop)
    by_a = t**3 / drop
    sizes = {"share": t, "acceleration": by_a, "force": by_a / (l + h + C)}.get(design.of, np.ones_like(t))
    return design.between * sizes / np.sqrt(np.mean(sizes**2))


def drawn(design: Design, random: Random) -> Set:
    """A set of runs with errors, without outliers."""
    n = design.runs
    l, h, drop = masses_of(design)
    if design.step:  # other masses in each set, or each would have the same errors of rounding
        l, h = (np.round(m + 1e-3 * random.random(n), 6) for m in (l, h))
    l_true, h_true = (m + design.masses * random.standard_normal(n) for m in (l, h))
    f = F * (1 + design.axle * random.standard_normal(n))
    ideal = expected(design.kind, l_true, h_true, C, f, drop=drop)[:, None]
    noise = np.sqrt(design.u**2 - design.common**2) * random.standard_normal((n, design.repeats))
    if design.common:
        noise += design.common * random.standard_normal()
    if design.between:
        noise += (between_runs(design, l, h, drop) * random.standard_normal(n))[:, None]
    values = ideal + noise + design.delay
    return Set(design, l, h, drop, np.round(values / design.step) * design.step if design.step else values)


def ideal_widths(design: Design, *more: str) -> Any:
    """The half widths of ideal intervals of c, f, and of the delay if that is fitted."""
    l, h, drop = masses_of(design)
    x = {"l": l, "h": h, "c": C, "f": F}

    def slope(name: str, size: float = 1e-6) -> Any:
        ends = [expected(design.kind, **{**x, name: x[name] + by}, drop=drop) for by in (-size, size)]
        return (ends[1] - ends[0]) / (2 * size)

    masses = (slope("l") ** 2 + slope("h") ** 2) * design.masses**2
    read = design.u**2 / design.repeats + design.step**2 / 12 + between_runs(design, l, h, drop) ** 2
    sigma = np.sqrt(read + masses + (slope("f") * design.axle * F) ** 2)
    J = np.stack([slope("c"), slope("f"), *(np.ones_like(l) for _ in more)], 1) / sigma[:, None]
    return 1.96 * np.sqrt(np.diag(np.linalg.inv(J.T @ J)))


class Counts(NamedTuple):
    """Shares of sets (%) whose intervals hold c, f and more; the median of their widths over the ideal ones; shares (%) without a result, with outliers, and of which it is said that runs scatter more
    than repeats, or that times seem too long.
    """

    within: Any
    width: Any
    refused: float
    accused: float
    scatters: float
    delayed: float


def counts(design: Design, sets: int, *more: str, seed: int = 1) -> Counts:
    random, ideal = np.random.default_rng(seed), ideal_widths(design, *more)
    truth = np.array([C, F, *([design.delay] if more else [])])
    within, widths, said = list[Any](), list[Any](), np.zeros(3)
    for _ in range(sets):
        try:
            fit = drawn(design, random).fit(*more)
        except CannotSeparate:
            continue
        p, cause = fit.line.p_value if fit.data.scatter.any() else None, cause_of(fit)
        said += bool(fit.outliers), p is not None and p < 0.05, "all times" in cause
        ends = np.array([one.interval for one in fit.results.values()])
        within.append((ends[:, 0] <= truth) & (truth <= ends[:, 1]))
        widths.append((ends[:, 1] - ends[:, 0]) / 2 / ideal)
    return Counts(
        100 * np.mean(within, 0), np.median(widths, 0), 100 - 100 * len(within) / sets, *100 * said / sets
    )


def exchanged(time: float) -> float:
    """The time with its first two digits that differ exchanged, as 8.23 for 2.83."""
    digits = list(f"{time:.2f}".replace(".", ""))
    i = next((i for i in range(len(digits) - 1) if digits[i] != digits[i + 1]), 0)
    digits[i], digits[i + 1] = digits[i + 1], digits[i]
    return int("".join(digits)) / 100


def blunders_named(design: Design, kind: str, number: int, sets: int) -> float:
    """The share of sets in which all blunders of so many runs are named: of a ``time`` or of a ``mass``."""
    random, named = np.random.default_rng(1), 0
    for _ in range(sets):
        made = drawn(design, random)
        off = random.choice(design.runs, number, replace=False)
        if kind == "mass":
            made.h[off] += random.choice([-1, 1], number) * BLUNDER
        else:
            k = random.integers(design.repeats, size=number)
            made.values[off, k] = [*map(exchanged, made.values[off, k])]
        try:
            named += {*off.tolist()} <= {run for run, _ in made.fit().outliers}
        except CannotSeparate:
            continue
    return named / sets


def outliers_beside_delay(case: int, sets: int) -> tuple[float, Any]:
    """The share of sets in which a time that is 0.06 s off is named, and the distances said of it over exact ones."""
    find, typed = BESIDE_DELAY[case]
    random, given, ratios = np.random.default_rng(1), given_as(**typed), list[float]()
    for _ in range(sets):
        made, off = drawn(Design(8, 1, 0.003, "vary", delay=0.3), random), int(random.integers(8))
        made.values[off] += random.choice([-0.06, 0.06])
        try:
            said = [words for run, words in made.fit(given=given, find=find).outliers if run == off]
        except CannotSeparate as error:
            said = re.findall(rf"row {off + 1} is [^;]+", str(error))
        far = (float(re.findall(r"is ([\d.e+]+) standard", str(words))[0]) for words in said[:1])
        values, covariance = by_scipy(
            "time", made.l, made.h, made.values[:, 0], [*find, "off"], which=np.arange(8) == off
        )
        exact = abs(values[-1]) / np.sqrt(covariance[-1, -1])  # of one more quantity, in that time alone
        ratios += (distance / exact for distance in far)
    return len(ratios) / sets, np.quantile(ratios, (0.05, 0.95))


def causes_named(case: str, sets: int, sums: str) -> Any:
    """The shares of sets (%) of which a cause is said, the right one is, and it alone is."""
    typed, find, delay, right, _ = CAUSES[case]
    random, given, shares = np.random.default_rng(1), given_as(**typed), np.zeros(3)
    for _ in range(sets):
        try:
            words = cause_of(drawn(Design(8, 3, 0.02, sums, delay=delay), random).fit(given=given, find=find))
        except CannotSeparate as error:
            words = str(error)
        is_right = right in words
        shares += "fit better if" in words, is_right, is_right and "cannot tell" not in words
    return 100 * shares / sets


def report(sets: int) -> Iterator[str]:
    yield f"{sets} sets each; c/f (/delay); 95 % intervals that hold the truth, %; widths over ideal ones"
    yield f"{'what is drawn':54} held      width      no result  outliers  scatter more  delay seen"
    drawn_as: list[tuple[Design, tuple[str, ...]]]
    drawn_as = [
        (one, ()) for one in [*CELLS, *OTHERS, *STATED, *(one for some in SCATTER.values() for one in some)]
    ]
    drawn_as += [(one, ("delay",)) for one in DELAYS]
    drawn_as += [(one._replace(delay=delay), ()) for one in DELAYS for delay in (0.0, 0.03, 0.15)]
    for design, more in drawn_as:
        one = counts(design, sets, *more)
        held, width = "/".join(f"{x:3.0f}" for x in one.within), "/".join(f"{x:.2f}" for x in one.width)
        rest = f"{one.refused:5.1f} {one.accused:9.1f} {one.scatters:9.1f} {one.delayed:9.1f}"
        yield f"{f'{design}{more or str()}':54} {held:9} {width:10} {rest}"
    for runs, repeats in ((8, 1), (8, 3), (5, 3), (15, 3)):
        design, cases = Design(runs, repeats, 0.05, step=0.01), product(("time", "mass"), (1, 2))
        found = (f"{case[1]} {case[0]}: {blunders_named(design, *case, sets):.2f}" for case in cases)
        yield f"{runs} x {repeats}, blunders named: {', '.join(found)}"
    for case, (find, _) in enumerate(BESIDE_DELAY):
        share, ends = outliers_beside_delay(case, sets)
        yield f"find {', '.join(find)}: an outlier named in {share:.2f}, at {ends.round(2)} of its distance"
    for wrong, (*_, bars) in CAUSES.items():
        shares = ", ".join(f"{sums} {causes_named(wrong, sets, sums).round()}" for sums in bars)
        yield f"wrong: {wrong}; % of sets with a cause, the right one, it alone: {shares}"


if __name__ == "__main__":
    for line in report(int(sys.argv[1]) if sys.argv[1:] else 400):
        print(line, flush=True)
