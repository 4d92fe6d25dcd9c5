"""A fit in words: what the runs determine, what is odd about them, and what to vary."""

from collections.abc import Iterable, Iterator
from math import floor, inf, isfinite, log10

import numpy as np

from ..arithmetic.rounding import text
from ..model import physics
from ..model.scene import parameter_of
from ..model.units import counted
from .fitting import SAME, Fitted, to_vary, undetermined, unusable
from .headings import MEASURED
from .numbers import cut, far, few, shown
from .probability import fisher_beyond
from .quantities import QUANTITIES, SMALL, USUAL

MUCH = 0.95
"""A correlation beyond which two results can hardly be distinguished."""
MOST_NAMED = 5
"""Runs of which each has a sentence; more are counted."""
NO_RESULT = {
    "rim_mass": "The runs would need a pulley of {} kg at its rim, and there is none: masses, heights or"
    " gravity are not what they are said to be, or something drives the masses.",
    "axle": "The runs would need an axle with a friction of {} N, and there is none: there is more mass on"
    " the heavier side than the table says, or something drives the masses.",
    "gravity": "The runs would need a gravity of {} m/s²: m1 and m2, or the sign of a, change places.",
}


def head(fit: Fitted) -> list[str]:
    """The result in words, and what is odd about the runs: above all tables."""
    return [verdict(fit), *_oddities(fit)]


def verdict(fit: Fitted) -> str:
    """How many runs there are, and which quantities are significant."""
    said = [
        f"{counted(len(fit.used), 'run')}, {counted(int(fit.data.times.sum()), MEASURED[fit.runs.kind])}."
    ]
    if fit.vague:
        said.append(f"No result: {undetermined(fit.used, fit.estimate.names)}.")
    elif not fit.values:
        said.append("Nothing is left to fit: the pulley and its axle are given.")
    else:
        said += [NO_RESULT[x].format(shown(fit.values[x], fit.uncertainty(x))) for x in fit.impossible]
    for name in () if fit.void else [name for name in USUAL if name in fit.values]:
        value, u, words = fit.values[name], fit.uncertainty(name), _capital(QUANTITIES[name].words)
        if fit.significant(name) > 0:
            away = f"{far(value / u if u else inf)} standard uncertainties from 0"
            said.append(f"{words} is significant ({away}).")
        elif not fit.significant(name):
            most = cut(value + fit.times * u, u)
            said.append(f"{words} agrees with 0: at most {most} {QUANTITIES[name].unit} (95 %).")
    return " ".join(said)


def coefficients(fit: Fitted) -> Iterator[str]:
    """The slope and the intercept of the line, if they are a result, with symbols as in LaTeX."""
    for name, label in zip(USUAL, ("slope $c$", "intercept $f$"), strict=True):
        if not fit.void and name not in fit.impossible:
            spread = fit.uncertainty(name) if name in fit.values else None
            why = "" if name in fit.values else ", given" if name in fit.given.values else ", assumed"
            yield f"{label} = {shown(fit.estimate.values[name], spread)} {QUANTITIES[name].unit}{why}"


def odd_cells(fit: Fitted) -> list[str]:
    """The cells and rows that are odd: row 3, or row 3, time 2 where a row has several measurements."""
    rows = sorted({row for i in {*fit.odd.rows, *fit.odd.cannot} for row in fit.used[i].rows})
    return [*(fit.used[i].cells[k] for i, k in fit.odd.repeats), *(f"row {row}" for row in rows)]


def _oddities(fit: Fitted) -> list[str]:
    """What is odd about the runs, and the result without it; none if the runs are sound."""
    odd = fit.odd
    if not odd.runs:
        return []
    unit, names = parameter_of(fit.runs.kind).unit, [_capital(run.name) for run in fit.used]
    repeats = []
    for (i, k), size in odd.repeats.items():
        cell = f"{_capital(fit.used[i].cells[k])} ({text(float(fit.used[i].measured[k].value))} {unit})"
        repeats.append(f"{cell} is far from its siblings: {far(size)} standard deviations.")
    away = "standard uncertainties from what the others say"
    fast = ", and faster than a massless pulley without friction allows"
    rows = (
        f"{names[i]} stands out: {far(size)} {away}{fast * bool(fit.too_fast[i])}."
        for i, size in odd.rows.items()
    )
    cannot = (f"{names[i]} cannot be: {why}." for i, why in odd.cannot.items())
    said = [*_some(repeats, "are, too"), *_some(rows, "stand out, too"), *_some(cannot, "cannot be either")]
    cells = odd_cells(fit)
    what = f"{', '.join(cells[:-1])}{' and ' * (len(cells) > 1)}{cells[-1]}"
    what = "all that is odd" if len(cells) > MOST_NAMED else what
    if odd.without is None:
        return [*said, f"Without {what} too few runs are left to fit."]
    values = (
        f"{x.replace('_', ' ')} = {shown(*one[:2])} {QUANTITIES[x].unit}"
        for x, one in odd.without.results.items()
    )
    empty = "; to leave a measurement out, empty its cell" * any("," in cell for cell in cells)
    end = f"The fit includes {'them' if cells[1:] else 'it'}{empty}."
    return [*said, f"Without {what}: {', '.join(values) or 'no result'}. {end}"]


def notes(fit: Fitted) -> list[str]:
    """What else there is to say, first how the table was read."""
    said = [*map(_capital, fit.runs.remarks), *_unused(fit)]
    return said if fit.vague else [*said, *_assumptions(fit), *_spread(fit), *_indistinct(fit)]


def _unused(fit: Fitted) -> Iterator[str]:
    used, others = {run.rows for run in fit.used}, []
    for run in fit.runs.runs:
        if run.left_out:
            yield f"{_capital(run.name)} was left out, as asked."
        elif run.rows not in used:
            why = unusable(fit.runs, run, fit.given, fit.estimate.names)
            others.append(f"{_capital(run.name)} could not be used: {why}.")
    yield from _some(others, "could not be used")


def _assumptions(fit: Fitted) -> Iterator[str]:
    """What is taken to be 0, and by how much that may change the results."""
    if fit.assumed:
        yield f"Axle friction is assumed to be 0: {fit.assumed}."
    for name in USUAL:
        if name in fit.values or name in fit.given.values:
            continue
        quantity, drive = QUANTITIES[name], float((fit.data.h - fit.data.l).min())
        size = 10.0 ** floor(log10(drive * (fit.estimate.values["gravity"] if name == "axle" else 1)))
        changes = []
        for i, other in enumerate(fit.estimate.names):
            change, of = float(fit.estimate.by_given[name][i]) * size / SMALL, QUANTITIES[other]
            verb, to = ("take", "off") if change < 0 else ("add", "to")
            changes.append(f"{verb} {few(abs(change))} {of.small_unit} {to} {of.words}")
        yield (
            f"{_capital(quantity.words)} is neither fitted nor given, and so taken to be 0:"
            f" {few(size / SMALL, 1)} {quantity.small_unit} would {' and '.join(changes)}."
        )


def _spread(fit: Fitted) -> Iterator[str]:
    """How the scatter of the runs is known."""
    data, between = fit.data, fit.between_runs
    by = "their repeats explain" if isfinite(data.within) else "their uncertainties say"
    what = MEASURED[fit.runs.kind]
    if not data.spread.any() and data.uncertain:
        yield (
            f"The uncertainty of a single {what} is neither given nor shown by repeats: u is the scatter that"
            " the runs have beside the uncertainties given."
        )
    elif not data.spread.any():
        yield (
            f"Without repeats nothing separates the scatter of the {what}s from what differs between runs: u"
            " is the scatter of the runs."
        )
    elif not fit.dof:
        yield f"As many runs as results: nothing shows whether the runs differ more than {by}."
    elif between and fit.chi2 is not None:
        percent = 100 * fisher_beyond(fit.chi2 / fit.dof, fit.dof, data.within)
        chance = few(percent) if percent >= 0.1 else "less than 0.1"
        yield (
            f"The runs differ by {few(between / SMALL)} g of mass more than {by}, as masses may; chance alone"
            f" does as much in {chance} % of all sets."
        )


def _indistinct(fit: Fitted) -> Iterator[str]:
    """What the results can hardly be distinguished from, and what to vary."""
    one_sided = len({run.m2.value > run.m1.value for run in fit.used}) == 1
    if "axle" in fit.values and fit.significant("axle") > 0 and one_sided:
        mass = physics.axle_mass(fit.values["axle"], fit.estimate.values["gravity"])
        yield (
            f"The friction of the axle may as well be {few(mass / SMALL)} g of mass unaccounted for on"
            " the lighter side, as the same side is the heavier in all runs: swap the sides to tell."
        )
    sums, pair = fit.data.l + fit.data.h, fit.correlation
    if pair and abs(pair[2]) > MUCH:
        one, other = (QUANTITIES[x].words for x in pair[:2])
        yield (
            f"The runs hardly separate {one} from {other} (their correlation is {few(pair[2], 3)}):"
            f" {to_vary(fit.used)}."
        )
    elif np.ptp(sums) < SAME * sums.max() and "rim_mass" in fit.values and "gravity" not in fit.values:
        more = 0.001 * (sums.mean() + fit.values["rim_mass"])
        yield (
            "m1 + m2 is the same in all runs, so that an error of 0.1 % in g, or in all masses, is one"
            f" of {few(more / SMALL)} g in the rim mass: vary m1 + m2 as well."
        )


def _some(sentences: Iterable[str], more: str) -> list[str]:
    """The first of the sentences, and how many more there are."""
    all_ = list(sentences)
    hidden = len(all_) - MOST_NAMED
    return [*all_[:MOST_NAMED], *[f"{hidden} more {more}."] * (hidden > 0)]


def _capital(words: str) -> str:
    return f"{words[0].upper()}{words[1:]}"
