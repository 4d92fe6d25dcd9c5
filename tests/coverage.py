"""How often the intervals of `atwood fit` hold the truth, beside SciPy: `python -m tests.coverage [SETS]`.

Laboratory sets are drawn with a known pulley (c at the rim) and axle (f), with normal errors of what is measured
and of what the table does not say. Counted are the 95 % intervals that hold the truth, their median widths over
those of unweighted least squares (`scipy.optimize.curve_fit` of the runs' means, Student's t with n - 2), sets
without a result, and sound sets of which anything is said to be odd.
"""

import sys
from collections.abc import Iterator
from fractions import Fraction
from math import nan
from typing import Any, NamedTuple

import numpy as np
from scipy import optimize, stats

from atwood_cli.laboratory.judgement import Fitted, conditions_of, fitted
from atwood_cli.laboratory.published import USUAL
from atwood_cli.laboratory.runs import Kind, Run, Runs
from atwood_cli.laboratory.statistics import Alike
from atwood_cli.model.scene import INPUTS, Input, read_input

C, F, G, DROP = 0.028, 0.009, 9.80665, 1.1
BLUNDER = 0.01
"""kg, of a mass that is mistyped."""
NOTHING = {name: read_input(name, None) for name in INPUTS}
Random = np.random.Generator


class Design(NamedTuple):
    """A laboratory: n runs of some repeats, with the errors that it has.

    ``u`` is that of a single time (s) or acceleration (m/s²), or of a time as a share of it if ``relative``;
    ``masses`` that of each mass (kg), ``axle`` that of the axle's friction from run to run, ``between`` that of
    all times of a run, both as shares. ``stated``: the uncertainties that the table states, times this.
    If ``averaged``, the table has only the mean of the repeats.
    """

    runs: int
    repeats: int
    u: float
    sums: str = "constant"
    kind: Kind = "time"
    masses: float = 0.0
    axle: float = 0.0
    between: float = 0.0
    stated: float = 0.0
    relative: bool = False
    averaged: bool = False
    c: float = C
    f: float = F

    def __str__(self) -> str:
        """What differs from the usual."""
        usual = self._field_defaults
        names = [name for name, value in self._asdict().items() if value != usual.get(name)]
        return ", ".join(f"{name} {getattr(self, name)}" for name in names)


class Bar(NamedTuple):
    """What a design must reach: the least coverage (%), and the greatest width over that of SciPy."""

    design: Design
    within: float = 90.0
    width: float = 1.25


BARS = [
    # Runs that differ by their scatter alone.
    *(Bar(Design(runs, 3, u)) for runs, u in ((7, 0.1), (3, 0.07), (4, 0.05), (5, 0.05))),
    Bar(Design(5, 4, 0.05, "vary")),
    *(Bar(Design(*of)) for of in ((7, 3, 0.07), (12, 3, 0.05), (20, 5, 0.05))),
    *(Bar(Design(7, 3, u, averaged=True)) for u in (0.1, 0.2)),
    Bar(Design(8, 1, 0.05)),
    Bar(Design(8, 1, 0.01, kind="a")),
    Bar(Design(8, 3, 0.01, "vary", kind="a")),
    Bar(Design(8, 3, 0.05, "swapped")),
    Bar(Design(8, 3, 0.05, c=0.0, f=0.0)),
    # Uncertainties that are stated, rightly and wrongly.
    *(Bar(Design(7, 3, 0.05, stated=times)) for times in (1.0, 0.5, 2.0)),
    *(Bar(Design(8, repeats, 0.05, masses=2e-4, stated=1.0), 92, nan) for repeats in (3, 1)),
    # Runs that differ by more than their scatter.
    Bar(Design(8, 3, 0.001, axle=0.1), 90, nan),
    Bar(Design(8, 3, 0.001, between=0.015), 90, nan),
    Bar(Design(8, 3, 0.05, masses=2e-4), 80, nan),
    Bar(Design(8, 1, 0.02, relative=True), 80, nan),
]


class Set(NamedTuple):
    """The masses as the table has them, and what is measured: (runs, repeats)."""

    design: Design
    l: Any
    h: Any
    values: Any

    def runs(self) -> Runs:
        def exact(value: float, u: float = 0.0) -> Input:
            return Input(Fraction(float(value)), Fraction(u), None)

        d = self.design
        values = self.values.mean(1, keepdims=True) if d.averaged else self.values
        drop, runs = exact(DROP) if d.kind == "time" else None, []
        for i, (l, h, some) in enumerate(zip(self.l, self.h, values, strict=True), 1):
            masses = [exact(m, d.masses * bool(d.stated)) for m in (l, h)]
            m1, m2 = masses[::-1] if d.sums == "swapped" and i % 2 else masses
            runs.append(Run((i,), m1, m2, drop, tuple(exact(value, d.stated * d.u) for value in some)))
        return Runs(d.kind, runs, False, [])

    def fit(self) -> Fitted:
        return fitted(self.runs(), conditions_of(NOTHING), [])


def expected(kind: Kind, l: Any, h: Any, c: Any, f: Any, g: Any = G, drop: float = DROP) -> Any:
    """The acceleration, or the time of the fall, as in a textbook."""
    a = ((h - l) * g - f) / (l + h + c)
    return a if kind == "a" else np.sqrt(2 * drop / np.maximum(a, 1e-6))


def by_scipy(kind: Kind, l: Any, h: Any, measured: Any, names: Any = USUAL, **known: Any) -> tuple[Any, Any]:
    """The values of these names by least squares, with ``sigma`` as weights, and their covariance."""
    known = {"gravity": G, "drop": DROP, "sigma": None, **known}

    def ideal(_: Any, *values: float) -> Any:
        x = known | dict(zip(names, values, strict=True))
        return expected(kind, l, h, x["rim_mass"], x["axle"], x["gravity"], x["drop"])

    start = [{"rim_mass": 0.03, "axle": 0.01, "gravity": G}[name] for name in names]
    tight: Any = dict.fromkeys(("xtol", "ftol", "gtol"), 1e-15) | {"jac": "3-point", "x_scale": "jac"}
    found = optimize.curve_fit(ideal, l, measured, start, known["sigma"], method="trf", **tight)
    return found[0], found[1]


def drawn(design: Design, random: Random) -> Set:
    """A set of runs with errors, and none of them odd."""
    n = design.runs
    if design.sums == "vary":
        l = np.linspace(0.1, 0.28, n)
        h = l + np.linspace(0.05, 0.012, n)
    else:
        difference = np.linspace(0.008, 0.045, n)
        l, h = (0.45 - difference) / 2, (0.45 + difference) / 2
    l_true, h_true = (m + design.masses * random.standard_normal(n) for m in (l, h))
    f = design.f * (1 + design.axle * random.standard_normal(n))
    shares = 1 + design.between * random.standard_normal(n)
    ideal = (expected(design.kind, l_true, h_true, design.c, f) * shares)[:, None]
    noise = design.u * random.standard_normal((n, design.repeats))
    return Set(design, l, h, ideal * (1 + noise) if design.relative else ideal + noise)


class Counts(NamedTuple):
    """Shares of sets (%), of c and of f where there are two, and median widths over those of SciPy."""

    within: Any
    width: Any
    scipy: Any
    refused: float
    accused: float


def counts(design: Design, sets: int, seed: int = 1) -> Counts:
    random, truth = np.random.default_rng(seed), np.array([design.c, design.f])
    within, widths, theirs, accused = list[Any](), list[Any](), list[Any](), 0
    for _ in range(sets):
        made = drawn(design, random)
        values, covariance = by_scipy(design.kind, made.l, made.h, made.values.mean(1))
        half = stats.t.ppf(0.975, design.runs - 2) * np.sqrt(np.diag(covariance))
        theirs.append(np.abs(values - truth) <= half)
        try:
            fit = made.fit()
        except Alike:
            continue
        accused += bool(fit.odd)
        if not fit.whole.reason:
            ends = np.array([fit.whole.results[x].interval for x in USUAL])
            within.append((ends[:, 0] <= truth) & (truth <= ends[:, 1]))
            widths.append((ends[:, 1] - ends[:, 0]) / 2 / half)
    held, theirs_held = (100 * np.mean(some, 0) for some in (within, theirs))
    refused = 100 * (1 - len(within) / sets)
    return Counts(held, np.median(widths, 0), theirs_held, refused, 100 * accused / sets)


def blunders_named(sets: int, seed: int = 1) -> list[int]:
    """Of eight runs, two of which have a mass that is 10 g off: how many sets have 0, 1 or 2 of them named."""
    random, named = np.random.default_rng(seed), [0, 0, 0]
    for _ in range(sets):
        made = drawn(Design(8, 3, 0.05), random)
        off = random.choice(8, 2, replace=False)
        h = made.h.copy()
        h[off] += random.choice([-1, 1], 2) * BLUNDER
        named[len({*off.tolist()} & {*made._replace(h=h).fit().odd})] += 1
    return named


def report(sets: int) -> Iterator[str]:
    yield f"{sets} sets each; c/f; 95 % intervals that hold the truth, median width over SciPy's"
    yield f"{'what is drawn':60} held      width       SciPy     no result  accused"
    for bar in BARS:
        one = counts(bar.design, sets)
        (c, f), (wide_c, wide_f), (their_c, their_f) = one.within, one.width, one.scipy
        shares = f"{c:4.0f}/{f:3.0f}  {wide_c:.2f}/{wide_f:.2f}  {their_c:4.0f}/{their_f:3.0f}"
        yield f"{bar.design!s:60} {shares}   {one.refused:5.1f}     {one.accused:5.1f}"
    yield f"two of eight masses 10 g off: none, one, both named in {blunders_named(sets)} of {sets} sets"


if __name__ == "__main__":
    for line in report(int(sys.argv[1]) if sys.argv[1:] else 400):
        print(line, flush=True)
