"""A fit in words: what the runs determine, what is odd about them, and what to vary."""

from collections.abc import Iterable, Iterator
from math import isfinite

import numpy as np

from ..model.digits import text
from ..model.scene import parameter_of
from ..model.units import counted
from .fitting import shared_error
from .judgement import Fitted, beyond, to_vary
from .published import QUANTITIES, SMALL, USUAL, equation, few
from .runs import MEASURED

MUCH = 0.95
"""A correlation beyond which two results can hardly be distinguished."""
RARE = 0.01
"""A probability below which something is no chance."""
MOST_NAMED = 5
"""Runs of which each has a sentence; more are counted."""
MOST_FAR = 1000
"""Standard uncertainties that are counted."""


def head(fit: Fitted) -> list[str]:
    """The result in words, and what is odd about the runs: above all tables."""
    return [verdict(fit), *(_oddities(fit) if fit.odd else [])]


def verdict(fit: Fitted) -> str:
    """How many runs there are, and which quantities are significant, unless some runs are odd."""
    measurements = counted(int(fit.whole.best.data.times.sum()), MEASURED[fit.runs.kind])
    said = [f"{counted(len(fit.used), 'run')}, {measurements}."]
    if fit.whole.reason:
        said.append(f"No result: {fit.whole.reason}.")
    elif not fit.whole.best.names:
        said.append("Nothing is left to fit: the pulley and its axle are given.")
    for name in [] if fit.odd else [name for name in USUAL if name in fit.whole.results]:
        low, high = fit.whole.results[name].interval
        meaning = "agrees with 0" if low <= 0 <= high else "is significant"
        said.append(f"{_capital(QUANTITIES[name].words)} {meaning}.")
    return " ".join(said)


def _oddities(fit: Fitted) -> list[str]:
    """What is odd about the runs, and the result without it."""
    unit, names = parameter_of(fit.runs.kind).unit, [run.name for run in fit.used]
    repeats = (
        f"In {names[i]}, {text(value)} {unit} is far from its siblings: {_far(size)} standard deviations."
        for i, (value, size) in fit.repeats.items()
    )
    _, faster = beyond(fit.whole.best)
    impossible = "is faster than with neither pulley nor friction"
    rows = (
        f"{_capital(names[i])} {impossible if faster[i] > 0 else 'stands out'}:"
        f" {_far(size)} standard uncertainties from what the others say."
        for i, size in fit.rows.items()
    )
    said = [*_some(repeats, "are, too"), *_some(rows, "stand out, too")]
    odd = [names[i] for i in fit.odd]
    what = "all that is odd" if len(odd) > MOST_NAMED else " and ".join(odd)
    if fit.without is None:
        return [*said, f"Without {what} too few runs are left to fit."]
    results = ", ".join(equation(x, *one[:2]) for x, one in fit.without.results.items())
    end = f"The fit includes {'them' if odd[1:] else 'it'}."
    return [*said, f"Without {what}: {results or 'no result'}. {end}"]


def notes(fit: Fitted) -> list[str]:
    """What else there is to say, first how the table was read."""
    said = [_capital(words) for words in fit.runs.remarks]
    unused = [run for run in fit.runs.runs if run.rows in fit.unusable]
    said += [f"{_capital(run.name)} was left out, as asked." for run in unused if run.left_out]
    others = [run for run in unused if not run.left_out]
    cannot = "could not be used"
    said += _some((f"{_capital(run.name)} {cannot}: {fit.unusable[run.rows]}." for run in others), cannot)
    if fit.whole.reason:
        return said
    zero = [name for name in USUAL if name not in fit.whole.best.names and name not in fit.given.values]
    said += [f"{_capital(QUANTITIES[x].words)} is taken to be 0, as it was not to be found." for x in zero]
    return [*said, _spread(fit), *_indistinct(fit)]


def _spread(fit: Fitted) -> str:
    """How the scatter of the runs is known, and how probable it is."""
    within, chi2, dof = fit.whole.best.data.within, fit.whole.chi2, fit.whole.best.dof
    if chi2 is None:
        return f"Nothing but the runs themselves shows the scatter of a single {MEASURED[fit.runs.kind]}."
    by = "scatter of repeats" if isfinite(within) else "uncertainties stated"
    if not dof:
        return f"As many runs as results: nothing shows whether the runs differ more than by the {by}."
    above = fit.whole.p_value or 0.0
    is_small = above >= 1 - RARE
    share = 1 - above if is_small else above
    percent = f"{few(100 * share)} %" if share >= 0.001 else "less than 0.1 %"
    said = f"χ² = {few(chi2, 3)} by the {by}, {counted(dof, 'degree')} of freedom"
    if is_small:
        hint = ": the uncertainties stated are probably too large" * (not isfinite(within))
        return f"{said}: far too small to be chance ({percent} of sets){hint}."
    between = fit.whole.between_runs
    more = f"; the runs differ by {few(between / SMALL)} g of mass beyond that" if between else ""
    return f"{said}: chance exceeds it in {percent} of sets{more}."


def _indistinct(fit: Fitted) -> Iterator[str]:
    """What the results can hardly be distinguished from, and what to vary."""
    if (pair := fit.whole.correlation) and abs(pair[2]) > MUCH:
        one, other = (QUANTITIES[x].words for x in pair[:2])
        yield (
            f"The runs hardly separate {one} from {other} (their correlation is {few(pair[2], 3)}):"
            f" {to_vary(fit.used)}."
        )
    widths = {x: one.interval[1] - one.interval[0] for x, one in fit.whole.results.items()}
    right = np.array([run.m2.value > run.m1.value for run in fit.used])
    words, changes = shared_error(fit.whole.best, right, widths)
    of = {QUANTITIES[x]: few(by / SMALL) for x, by in changes.items()}
    if of:
        sizes = " and ".join(f"{x.words} by about {by} {x.small_unit}" for x, by in of.items())
        yield f"{_capital(words)} would change {sizes}."


def _far(size: float) -> str:
    """How many standard uncertainties something is away."""
    return few(abs(size)) if abs(size) < MOST_FAR else f"more than {MOST_FAR}"


def _some(sentences: Iterable[str], more: str) -> list[str]:
    """The first of the sentences, and how many more there are."""
    all_ = list(sentences)
    hidden = len(all_) - MOST_NAMED
    return [*all_[:MOST_NAMED], *[f"{hidden} more {more}."] * (hidden > 0)]


def _capital(words: str) -> str:
    return f"{words[0].upper()}{words[1:]}"
