"""A fit as sentences, tables, JSON and CSV: what the runs determine, their outliers, what to vary."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ..numbers.digits import format_number
from ..numbers.text import counted
from ..output.page import Page, aligned
from ..output.text import Report, cell, inputs_in_words
from ..solver.scene import Motion, parameter_of
from .estimate import as_data, expected
from .fitting import RARE, SELDOM, Fitted
from .results import QUANTITIES, USUAL, Fit, cut, equation, published, rounded
from .runs import MEASURED

NOT_FITTED = "no value, as it is given, was not to be fitted, or the runs do not determine it"
NEEDS = {
    "moment_of_inertia": "needs the rim mass to be fitted, and R",
    "pulley_mass": "needs the rim mass to be fitted, and the pulley's shape, --inertia",
}


# Sentences


def verdict(fit: Fitted) -> str:
    """Return how many runs there are, and which quantities differ from 0 as shown."""
    measurements = counted(int(fit.whole.data.counts.sum()), MEASURED[fit.runs.kind])
    said = [f"{counted(len(fit.whole.data.l), 'run')}, {measurements}."]
    if not fit.whole.names:
        said.append("Nothing is left to fit: the pulley and its axle are given.")
    for name in USUAL:
        if name in fit.whole.results:
            _, u, (low, high) = fit.whole.results[name]
            may_be = f"is not distinguishable from 0; it may be up to {cut(high, u)} {QUANTITIES[name].unit}."
            verb = "is clearly above 0." if low > u / 20 else may_be  # as cut at the second digit of u
            said.append(_capital(f"{QUANTITIES[name].words} {verb}"))
    return " ".join(said)


def _scatter(fit: Fitted) -> str:
    """Return how the scatter of the runs is known, and its p value."""
    whole = fit.whole
    if not whole.dof:
        return "There are as many runs as results, so nothing is left to test the fit."
    if whole.chi2 is None or whole.p_value is None:
        return f"No {MEASURED[fit.runs.kind]} was repeated, so only the residuals show the scatter."
    probability = f"p = {rounded(whole.p_value)}" if whole.p_value >= 0.001 else "p < 0.001"
    source = "uncertainties" if whole.data.stated else "repeats"
    test = f" by an F({whole.dof}, {whole.data.repeats[1]}) test" if whole.is_f_test else ""
    chi2 = f"χ² = {rounded(whole.chi2, 3)}, {counted(whole.dof, 'degree')} of freedom"
    by = f"{source} ({chi2}, {probability}{test})"
    if whole.p_value < SELDOM:
        return f"The runs scatter more than their {by}: masses, friction or timing vary between them."
    if fit.outliers:
        return f"Because of outliers, it is open whether the runs scatter more than their {by}."
    if whole.p_value > 1 - RARE:
        return f"The runs scatter less than their {by}."
    if whole.line.between:
        return f"The runs scatter more than their {by}, but chance may explain that."
    return f"The runs do not scatter more than their {by}."


def _capital(words: str) -> str:
    return f"{words[0].upper()}{words[1:]}"


def conditions(fit: Fitted) -> str:
    """Return what is the same in all runs, in words."""
    inputs = fit.given.inputs
    scene = fit.given.scene
    if "drop" in inputs:
        scene = scene._replace(motion=Motion(drop=inputs["drop"].value))
    uncertain = {name: one.uncertainty for name, one in inputs.items() if one.uncertainty}
    words = inputs_in_words(scene, uncertain)
    g = "" if "gravity" in fit.whole.names else "g"
    inertia = "" if inputs["M"].given is None else "inertia"
    shown = (x for x, one in inputs.items() if one.given is not None or x in (g, inertia, "drop"))
    return ", ".join(words[x] for x in shown if x in words)


# Records and pages


def results_of(fit: Fitted) -> Fit:
    """Return all of a fit by name, with its sentences: first the verdict and the outliers."""
    whole, outliers = fit.whole, [f"{_capital(words)}." for _, words in fit.outliers]
    return Fit(
        **{name: whole.results[name].value if name in whole.results else None for name in QUANTITIES},
        uncertainty={name: one.uncertainty for name, one in whole.results.items()},
        interval={name: list(one.interval) for name, one in whole.results.items()},
        correlation=_correlation(whole.line.covariance),
        chi2=whole.chi2,
        dof=whole.dof,
        between_runs=whole.between_runs,
        runs=_records(fit),
        notes=[verdict(fit), *outliers, *map(_capital, fit.runs.remarks), _scatter(fit), *fit.delay],
    )


def report_of(fit: Fitted, only: Sequence[str]) -> Report:
    """Return a fit in the forms in which it may be asked for; ``only`` names results."""
    found, results = results_of(fit), fit.whole.results
    record = found.to_dict()
    asked = {name: record[name] for name in only or record}
    rows: Sequence[Mapping[str, Any]] = [asked]
    said = [*found.notes]
    if only == ["runs"]:
        rows = found.runs
    elif only:
        said = [equation(x, *results[x][:2]) for x in only if x in results]
        said += [f"{x}: {NEEDS.get(x, NOT_FITTED)}." for x in only if record[x] is None]
        said += [*found.notes[1 : 1 + len(fit.outliers)], *fit.delay]
    else:
        names = "quantity", "value", "uncertainty", "low", "high", "unit"
        each = ((x, *one[:2], *one.interval, QUANTITIES[x].unit) for x, one in results.items())
        rows = [dict(zip(names, one, strict=True)) for one in each]
    bare = [cell(record[name]) for name in only]
    return Report(lambda: asked, lambda: rows, lambda: _print_page(fit, found), lambda: said, bare)


def _correlation(covariance: Any) -> float | None:
    """Return the correlation of the two fitted quantities that have most of it."""
    u = np.sqrt(covariance.diagonal())
    pairs = (covariance / np.outer(u, u))[np.triu_indices(len(u), 1)]
    return float(max(pairs, key=abs)) if len(pairs) else None


def _records(fit: Fitted) -> list[dict[str, Any]]:
    """Return the runs, as JSON and CSV have them; the residual is in standard uncertainties."""
    runs, best, shown = fit.runs, fit.whole, as_data(fit.runs, fit.shown)
    moves = expected(shown._replace(drop=None), best.values) > 0
    measured, (u, ideal) = runs.mean.copy(), np.full((2, len(runs.rows)), np.nan)
    if best.data.stated:
        measured[fit.used] = runs.sign[fit.used] * best.data.measured  # weighted means
    u[fit.used] = best.sigma
    ideal[fit.shown] = runs.sign[fit.shown] * np.where(moves, expected(shown, best.values), np.nan)
    residual = (measured - ideal) / u
    columns = {**runs.given, runs.kind: measured, "u": u, "expected": ideal, "residual": residual}
    return [
        {"rows": " ".join(map(str, rows))}
        | {x: None if np.isnan(column[i]) else float(column[i]) for x, column in columns.items()}
        for i, rows in enumerate(runs.rows)
    ]


def _print_page(fit: Fitted, found: Fit) -> None:
    """Print the conditions, the runs, what there is to say, and the results."""
    page, kind, results, first = Page(), fit.runs.kind, fit.whole.results, 1 + len(fit.outliers)
    page.say(conditions(fit))
    unit = parameter_of(kind).unit
    heads = f"{kind} ({unit})", f"expected ({unit})", f"u ({unit})", "residual/u"
    _print_table(page, ("row", "m1 (kg)", "m2 (kg)", *heads), _rows(fit, found))
    between = " It includes a scatter of forces between runs." if fit.whole.line.between else ""
    page.say(f"u is the standard uncertainty of a run's mean.{between}", *found.notes[first:])
    page.say(*found.notes[:first], style="bold")
    if results:
        numbers = ((x, published(*one), QUANTITIES[x]) for x, one in results.items())
        rows = [(x, both, words.unit, words.symbol, ends) for x, (both, ends), words in numbers]
        _print_table(page, ("Quantity", "Value", "Unit", "Symbol", "95 % interval"), rows)


def _print_table(page: Page, heads: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    page.table(heads, [list(zip(*map(aligned, zip(*rows, strict=True)), strict=True))])


def _rows(fit: Fitted, found: Fit) -> list[list[str]]:
    """Return the cells of each run: the measurement, what is expected, and the residual."""
    # The mean has the digits of its own scatter.
    finest = float(min(fit.whole.data.scatter.min() or np.inf, fit.whole.sigma.min()))
    rows = []
    for run in found.runs:
        where, kind, u, residual = run["rows"].replace(" ", ","), fit.runs.kind, run["u"], run["residual"]
        numbers = format_number(run["m1"]), format_number(run["m2"]), cut(run[kind], finest)
        expected_and_u = cut(run["expected"], finest), cut(u, u)
        rows.append([where, *numbers, *expected_and_u, "" if residual is None else f"{residual:z.2f}"])
    return rows
