"""How often the intervals of `atwood fit` hold the truth: `python -m tests.coverage [SETS]`.

Laboratory sets are drawn with a known pulley and axle, normal errors of what is measured, and hidden errors of
masses: what a label says and a balance does not. Counted are the intervals that hold the truth, sound sets
of which anything is said to be odd, and errors that are named: a repeat 5 standard deviations off, a row 6
off. Widths are beside those of an analyst who knows the covariance of all errors, and so needs no Student's t.
"""

import sys
from collections.abc import Iterator
from fractions import Fraction
from math import isnan, nan
from typing import Any, NamedTuple

import numpy as np

from atwood_cli.laboratory.fitting import Fitted, Odd, conditions_of, fitted
from atwood_cli.laboratory.headings import Kind
from atwood_cli.laboratory.least_squares import expected
from atwood_cli.laboratory.probability import student_within
from atwood_cli.laboratory.runs import Run, Runs
from atwood_cli.laboratory.statistics import Alike
from atwood_cli.model.scene import INPUTS, Input, read_input

C, G, DROP = 0.04, 9.80665, 1.0
NOTHING = {name: read_input(name, None) for name in INPUTS}
Random = np.random.Generator


class Design(NamedTuple):
    """A laboratory: n runs of some repeats, axle friction (N), errors of masses (kg), hidden or given with ±."""

    runs: int
    repeats: int
    axle: float = 0.01
    hidden: float = 0.0
    given_mass: float = 0.0
    given: bool = False
    constant: bool = False
    kind: Kind = "time"
    c: float = C

    @property
    def seen(self) -> bool:
        """Whether the data can tell what hidden errors add: by repeats."""
        return not self.hidden or self.repeats > 1

    def __str__(self) -> str:
        masses = "m1+m2 const" if self.constant else "m1+m2 vary"
        words = [f"{self.runs:2} x {self.repeats}", f"{self.kind:4}", f"{masses:11}"]
        words += [f"f {1000 * self.axle:2g} mN", f"c {1000 * self.c:2g} g"]
        words += [f"hidden {1000 * self.hidden:g} g"] * bool(self.hidden)
        words += [f"masses ± {1000 * self.given_mass:g} g"] * bool(self.given_mass) + ["±"] * self.given
        return ", ".join(words)


DESIGNS = [
    Design(3, 3, 0.0),
    Design(3, 5, hidden=1e-3),
    Design(4, 1, 0.02),
    Design(5, 1, 0.02, constant=True),
    Design(5, 3, constant=True),
    Design(5, 3, hidden=1e-4, constant=True),
    Design(5, 3, hidden=2e-4),
    Design(5, 3, given=True),
    Design(5, 1, 0.01, given_mass=3e-4),
    Design(6, 2, 0.005, hidden=1e-3),
    Design(8, 1, 0.0),
    Design(8, 1, 0.02, kind="a"),
    Design(8, 1, given=True, kind="a"),
    Design(8, 1, 0.0, c=0.0),
    Design(8, 3, 0.0, c=0.0),
    Design(8, 3, 0.02, hidden=1e-4, constant=True),
    Design(8, 3, hidden=1e-3),
    Design(8, 3, hidden=2e-4, kind="a"),
    Design(8, 1, 0.01, given_mass=3e-4, given=True),
    Design(12, 2, hidden=5e-4, given=True),
    Design(20, 1, 0.01),
    Design(20, 5, 0.01, constant=True),
    Design(20, 5, 0.01, hidden=1e-3),
    Design(20, 3, 0.02, hidden=1e-4, kind="a"),
    Design(50, 1, 0.005, kind="a", c=0.005),
    Design(50, 2, 0.02, hidden=5e-4),
    Design(5, 1, hidden=2e-4, given=True),
    Design(8, 1, hidden=1e-3),
    Design(8, 1, hidden=1e-4, given=True, constant=True),
]


class Set(NamedTuple):
    """The masses as they are said to be, what is expected of them and measured, and the errors' size."""

    design: Design
    l: Any
    h: Any
    values: Any
    ideal: Any
    u: float
    u_run: Any
    known_half: Any

    def runs(self) -> Runs:
        def exact(value: float, u: float = 0.0) -> Input:
            return Input(Fraction(float(value)), Fraction(u), None)

        d, drop = self.design, exact(DROP) if self.design.kind == "time" else None
        u = self.u if d.given else 0.0
        runs = [
            Run(
                (i,),
                {},
                exact(l, d.given_mass),
                exact(h, d.given_mass),
                drop,
                tuple(exact(value, u) for value in some),
                tuple(f"row {i}, time {k}" for k in range(1, d.repeats + 1)),
            )
            for i, (l, h, some) in enumerate(zip(self.l, self.h, self.values, strict=True), 1)
        ]
        return Runs(d.kind, runs, True, False, [], [])


def drawn(design: Design, random: Random) -> Set:
    """A set of runs with errors, and none of them odd."""
    n, shape = design.runs, (design.runs, design.repeats)
    if design.constant:
        difference = np.linspace(0.003, 0.010, n)
        l, h = (0.407 - difference) / 2, (0.407 + difference) / 2
    else:
        l = np.linspace(0.1, 0.3, n)
        h = l + np.linspace(0.01, 0.04, n)[::-1]
    truth = {"drop": DROP, "rim_mass": design.c, "axle": design.axle, "gravity": G}
    off = design.hidden + design.given_mass
    l_true, h_true = (m + off * random.standard_normal(n) for m in (l, h))
    ideal, _ = expected(design.kind, {"l": l_true, "h": h_true, **truth}, [])
    if not np.isfinite(ideal).all() or (h_true <= l_true).any():  # an axle that holds: drawn again
        return drawn(design, random)
    u = {"time": 0.06 if design.constant else 0.02, "a": 0.01}[design.kind]
    values = ideal[:, None] + u * random.standard_normal(shape)
    said, slopes = expected(design.kind, {"l": l, "h": h, **truth}, ["rim_mass", "axle", "l", "h"])
    u_run = np.sqrt(u**2 / design.repeats + off**2 * (slopes["l"] ** 2 + slopes["h"] ** 2))
    J = np.stack([slopes["rim_mass"], slopes["axle"]], 1) / u_run[:, None]
    half = 1.96 * np.sqrt(np.diag(np.linalg.inv(J.T @ J)))
    return Set(design, l, h, values, said, u, u_run, half)


def fit_of(made: Set) -> Fitted:
    runs = made.runs()
    return fitted(runs, conditions_of(NOTHING, runs), [])


def named(made: Set) -> Odd:
    """What of a set is said to be odd."""
    try:
        return fit_of(made).odd
    except Alike:
        return Odd()


class Counts(NamedTuple):
    """Shares of sets, of the rim mass and of the axle where there are two, and their mean relative widths."""

    within_68: Any
    within_95: Any
    width: Any
    accused: float
    negative: float
    repeat_named: float
    row_named: float


def counts(design: Design, sets: int, seed: int = 1) -> Counts:
    random = np.random.default_rng(seed)
    truth = np.array([design.c, design.axle])
    seen: list[Any] = []
    for _ in range(sets):
        made = drawn(design, random)
        fit = fit_of(made)
        values = np.array([fit.values.get(x, 0.0) for x in ("rim_mass", "axle")])
        u = np.array([fit.uncertainty(x) if x in fit.values else 0.0 for x in ("rim_mass", "axle")])
        off = abs(values - truth)
        freedom = fit.dof
        repeat = row = nan
        i, k = random.integers(design.runs), random.integers(design.repeats)
        sign = random.choice([-1, 1])
        if design.repeats > 2:
            values_off = made.values.copy()
            values_off[i, k] = np.delete(values_off[i], k).mean() + sign * 5 * made.u
            repeat = (int(i), int(k)) in named(made._replace(values=values_off)).repeats
        values_off = made.values.copy()
        values_off[i] += made.ideal[i] + sign * 6 * made.u_run[i] - values_off[i].mean()
        row = i in named(made._replace(values=values_off)).rows
        seen.append(
            [
                *(off < student_within(0.6827, freedom) * u),
                *(off < fit.times * u),
                *(fit.times * u / made.known_half),
                bool(fit.odd.runs),
                bool(fit.impossible),
                repeat,
                row,
            ]
        )
    mean = np.mean(np.array(seen, dtype=float), 0)
    return Counts(mean[:2], mean[2:4], mean[4:6], *map(float, mean[6:]))


def report(sets: int) -> Iterator[str]:
    yield f"{sets} sets each; shares in %, of the rim mass / the axle; widths of 95 % beside those of known noise"
    yield f"{'':68} 68 %      95 %      width      odd neg. repeat row"
    covered = []
    for design in DESIGNS:
        one = counts(design, sets)
        shares = [f"{100 * a:3.0f}/{100 * b:3.0f}" for a, b in (one.within_68, one.within_95)]
        width = "/".join(f"{w:.2f}" for w in one.width)
        tail = " ".join("  - " if isnan(x) else f"{100 * x:4.1f}" for x in one[3:])
        yield f"{design!s:68} {shares[0]}   {shares[1]}   {width}   {tail}{'' if design.seen else '  hidden, not seen'}"
        if design.seen:
            covered += list(one.within_95)
    yield f"95 % intervals, where errors are seen: {100 * min(covered):.1f} % at least, {100 * np.mean(covered):.1f} % on average"


if __name__ == "__main__":
    for line in report(int(sys.argv[1]) if sys.argv[1:] else 1000):
        print(line, flush=True)
