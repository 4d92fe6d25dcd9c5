"""A fit in words: what the runs require, what is odd about them, and what to vary."""

from collections.abc import Iterator, Sequence
from decimal import Decimal
from fractions import Fraction
from math import isfinite

import numpy as np

from ..arithmetic.rounding import text, to_digits, to_place, with_uncertainty
from ..model import physics
from ..model.axle import Axle
from ..model.case import Case
from .fitting import FOUND, SAME, UNITS, WORDS, Fit, away, to_vary, unusable
from .runs import Run
from .student import SURE, fisher_beyond

MUCH = 0.95
"""A correlation beyond which two things are hardly told apart."""


def shown(value: float, uncertainty: float | None) -> str:
    """A value cut at the second digit of its uncertainty, with that; to six digits if it has none."""
    exact = Fraction(value)
    if not uncertainty:
        return text(to_digits(6)(exact))
    return with_uncertainty(
        lambda place: to_place(place)(exact), Decimal(to_digits(2)(Fraction(uncertainty)))
    )


def cut(value: float, uncertainty: float | None) -> str:
    """A value cut at the second digit of an uncertainty; to six digits if there is none."""
    exact = Fraction(value)
    if not uncertainty:
        return text(to_digits(6)(exact))
    return f"{to_place(to_digits(2)(Fraction(uncertainty)).adjusted() - 1)(exact):f}"


def interval(low: float, high: float, uncertainty: float) -> str:
    """The ends of an interval, cut at the second digit of an uncertainty."""
    place = to_digits(2)(Fraction(uncertainty)).adjusted() - 1
    ends = [to_place(place)(Fraction(end)) for end in (low, high)]
    power = max((end.adjusted() for end in ends if end), default=0)
    if -4 <= power < 16:
        return "{:f} to {:f}".format(*ends)
    return "({:f} to {:f})e{}".format(*(end.scaleb(-power) for end in ends), power)


def few(value: float, digits: int = 2) -> str:
    """A value to a few digits, as people write it."""
    return f"{to_digits(digits)(Fraction(value)):f}"


def far(size: float) -> str:
    """How many standard uncertainties something is away."""
    return few(abs(size)) if isfinite(size) else "more than any number of"


def verdict(fit: Fit) -> str:
    """What the runs require, in a sentence or two."""
    count = f"{_counted(len(fit.used), 'run')}, {_counted(int(fit.data.times.sum()), _quantity(fit))}."
    names = sorted(fit.estimate.found, key=fit.away, reverse=True)
    figures = [fit.away(name) for name in names] + [away(one.value, one.uncertainty) for one in fit.dropped]
    distances = list(map(far, figures))
    words = [WORDS[name] for name in (*names, *(one.name for one in fit.dropped))]
    about = [f"{word} ({number})" for word, number in zip(words, distances, strict=True)]
    if about:
        about[0] = f"{about[0][:-1]} standard uncertainties from 0)"
    found, left = about[: len(names)], about[len(names) :]
    if fit.asked:
        return f"{count} Fitted, as asked: {', '.join(found)}."
    if not about:
        return f"{count} Nothing is left to find: the pulley and its axle are known."
    if not found:
        neither = f"neither {left[0]} nor {left[1]} is needed" if left[1:] else f"{left[0]} is not needed"
        return f"{count} {_sentence(neither)}"
    parts = [_sentence(found[0].replace(" (", " is needed (", 1))]
    if found[1:]:
        parts = [f"{parts[0][:-1]}; so is {found[1]}."]
    parts += [_sentence(f"{one.replace(' (', ' is not (', 1)}, and left out") for one in left]
    return " ".join([count, *parts])


def _counted(count: int, thing: str) -> str:
    return f"{count} {thing}{'s' * (count != 1)}"


def _sentence(words: str) -> str:
    return f"{words[0].upper()}{words[1:]}."


def notes(fit: Fit) -> list[str]:
    """What else there is to say."""
    return [*_odd_values(fit), *_spread(fit), *_told_apart(fit), *_odd_runs(fit)]


def _odd_values(fit: Fit) -> Iterator[str]:
    nothing = [name for name in FOUND[:2] if name not in fit.values and name not in fit.known.values]
    if fit.asked and nothing:
        yield f"Neither fitted nor given, and so taken to be 0: {', '.join(nothing)}."
    for name, value in fit.values.items():
        u = fit.uncertainty(name)
        if value < 0 and -value > fit.times * u:
            what = {
                "rim_mass": "No pulley has a negative inertia: masses, heights or gravity are not what they"
                " are said to be, or something drives the masses",
                "axle": "No axle has a negative friction: there is more mass on the heavier side than the"
                " table says, or something drives the masses",
                "gravity": "Gravity is found upwards: m1 and m2, or the sign of a, change places",
            }[name]
            yield f"{what}."
    if fit.values.get("axle") and one_sided(fit):
        mass = fit.values["axle"] / fit.estimate.values["gravity"]
        yield (
            f"The friction of the axle may as well be {few(1000 * abs(mass))} g of mass unaccounted for on"
            f" the {'lighter' if mass > 0 else 'heavier'} side, as the same side is the heavier in all runs:"
            " swap the sides to tell."
        )


def one_sided(fit: Fit) -> bool:
    """Whether the same side is the heavier in all runs."""
    return len({run.m2.value > run.m1.value for run in fit.used}) == 1


def _spread(fit: Fit) -> Iterator[str]:
    data, runs = fit.data, len(fit.used) - len(fit.estimate.found)
    if fit.spread_known and fit.scale != 1:
        yield (
            f"The runs scatter {few(fit.scale)} times as much as their uncertainties say (chi-squared"
            f" {few(fit.estimate.chi2, 3)} for {fit.dof} degrees of freedom): those found are scaled by that."
        )
    elif not fit.spread_known and data.within and runs > 0:
        between = (fit.estimate.chi2 - data.within) / runs
        if (chance := fisher_beyond(between, runs, int(data.within))) < 1 - SURE:
            yield (
                f"The means of the runs scatter {few(between**0.5)} times as much as their repeats explain,"
                f" which chance would do in {few(100 * chance)} % of all cases: something else varies from"
                " run to run, as masses may."
            )


def _told_apart(fit: Fit) -> Iterator[str]:
    sums = np.array([float(run.m1.value + run.m2.value) for run in fit.used])
    constant, vary = np.ptp(sums) < SAME * sums.max(), to_vary(fit.used)
    pair = fit.correlation
    if pair and abs(pair[2]) > MUCH:
        yield (
            f"The runs hardly tell {WORDS[pair[0]]} from {WORDS[pair[1]]} (their correlation is"
            f" {few(pair[2], 3)}): {vary}."
        )
    elif (other := fit.alternative) is not None:
        name = other.estimate.found[0]
        yield (
            f"The runs do not tell {WORDS['rim_mass']} from {WORDS['axle']}: {WORDS[name]} alone would do,"
            f" too, {name} = {shown(other.values[name], other.uncertainty(name))} {UNITS[name]}"
            f". To tell, {vary}."
        )
    elif constant and "rim_mass" in fit.values:
        more = 0.001 * (sums.mean() + fit.values["rim_mass"])
        if "gravity" not in fit.values:
            yield (
                "m1 + m2 is the same in all runs, so that an error of 0.1 % in g, or in all masses, is one"
                f" of {few(1000 * more)} g in rim_mass: vary m1 + m2 as well."
            )


MOST_NAMED = 5
"""Runs of which each has a sentence; of more, the numbers."""


def _odd_runs(fit: Fit) -> Iterator[str]:
    found, known = fit.estimate.found, fit.known
    unused = [(run, why) for run in fit.runs.runs if (why := unusable(fit.runs, run, known, found))]
    yield from (f"{_named(run)} could not be used: {why}." for run, why in unused[:MOST_NAMED])
    yield from _more([run for run, _ in unused], "could not be used")
    too_fast = fit.too_fast
    impossible = {i: why for i in range(len(fit.used)) if (why := _impossible(fit, i, too_fast.get(i)))}
    for i in list(impossible)[:MOST_NAMED]:
        yield f"{_named(fit.used[i])} cannot be: {impossible[i]}."
    yield from _more([fit.used[i] for i in impossible], "cannot be either")
    outliers = {i: size for i, size in fit.outliers.items() if i not in impossible}
    for i in list(outliers)[:MOST_NAMED]:
        away_by = far(outliers[i])
        yield f"{_named(fit.used[i])} stands out: {away_by} standard uncertainties from what the others say."
    yield from _more([fit.used[i] for i in outliers], "stand out, too")
    if odd := [*impossible, *outliers]:
        names = _joined([fit.used[i].name for i in odd]) if len(odd) <= MOST_NAMED else "them all"
        without = fit.without(odd)
        if without is None:
            yield f"Without {names} too few runs are left to fit."
            return
        values = [
            f"{name} = {shown(value, without.uncertainty(name))} {UNITS[name]}"
            for name, value in without.values.items()
        ]
        yield f"Without {names}: {', '.join(values) or 'nothing is fitted'}. None was left out above."


def _more(runs: Sequence[Run], what: str) -> Iterator[str]:
    """The sentence on those that have none of their own."""
    if more := runs[MOST_NAMED:]:
        numbers = ", ".join(str(run.rows[0]) for run in more[: 4 * MOST_NAMED])
        yield f"{len(more)} more {what}: rows {numbers}{', ...' * (len(more) > 4 * MOST_NAMED)}."


def _named(run: Run) -> str:
    return f"{run.name[0].upper()}{run.name[1:]}"


def _joined(names: Sequence[str]) -> str:
    return names[0] if not names[1:] else f"{', '.join(names[:-1])} and {names[-1]}"


def _impossible(fit: Fit, i: int, limit: float | None) -> str:
    """Why a run that was used cannot have been as it is said; empty if it can."""
    data, values, run = fit.data, fit.estimate.values, fit.used[i]
    l, h, g = float(data.l[i]), float(data.h[i]), values["gravity"]
    if limit is not None:
        unit, bound = {"a": ("m/s^2", "most"), "time": ("s", "least")}[data.kind]
        return (
            "it is faster than a massless pulley without friction allows, whose"
            f" {_quantity(fit)} is at {bound} {few(limit, 4)} {unit}"
        )
    b = physics.axle_mass(values["axle"], g)
    if h - l <= b:
        return f"by the friction that was found, the axle would hold its masses (up to {few(1000 * b)} g)"
    scene = fit.known.scene
    if scene.mu is not None and l:
        here = scene._replace(
            m1=run.m1.value,
            m2=run.m2.value,
            M=Fraction(max(values["rim_mass"], 0.0)),
            inertia=Fraction(1),
            I=None,
            g=Fraction(g),
            axle=Axle(Fraction(max(values["axle"], 0.0))),
        )
        if Case(here).regime == "slip":
            return f"the string would slip, as its mu = {text(float(scene.mu))} is too small for these masses"
    return ""


def _quantity(fit: Fit) -> str:
    return {"a": "acceleration", "time": "time"}[fit.runs.kind]
