"""A fit as sentences, tables, JSON and CSV: what the runs determine, their outliers, what to vary."""

from collections.abc import Mapping, Sequence
from functools import partial
from itertools import chain
from math import sqrt
from typing import Any

import numpy as np

from ..explain.given import inputs_in_words
from ..numbers.digits import format_number
from ..numbers.text import counted
from ..output.forms import Report
from ..output.page import Page
from ..output.text import aligned, cell
from ..solver import physics
from ..solver.answers import Answers
from ..solver.scene import MASSES, parameter_of
from .columns import MEASURED
from .diagnosis import RARE, SELDOM
from .estimate import Fitted, data_of, expected, moves
from .results import QUANTITIES, RESULTS, USUAL, Fit, as_determined, cut, equation, published, rounded
from .statistics import NORMAL_DOF

NOT_FITTED = "no value, as it is given, was not to be fitted, or the runs do not determine it"


# Sentences


def verdict(fit: Fitted) -> str:
    """Return how many runs there are, and which quantities are above 0 as the table shows them."""
    measurements = counted(int(fit.data.counts.sum()), MEASURED[fit.runs.kind])
    sentences = [f"{counted(len(fit.data.l), 'run')}, {measurements}."]
    if not fit.names:
        sentences.append("Nothing is left to fit: the pulley and its axle are given.")
    for name in (x for x in USUAL if x in fit.results):
        _, u, (low, high) = fit.results[name]
        most = f"it may be up to {cut(max(high, 0.0), u)} {QUANTITIES[name].unit}"
        is_above = float(cut(low, u) or 0) > 0
        verb = "is clearly above 0" if is_above else f"is not distinguishable from 0; {most}"
        sentences.append(_capital(f"{QUANTITIES[name].words} {verb}."))
    return " ".join(sentences)


def _scatter(fit: Fitted) -> str:
    """Return how the scatter of the runs is known, and if it is more than that of repeats."""
    line, data, p_value = fit.line, fit.data, fit.line.p_value
    if p_value is None:
        return "There are as many runs as results, so nothing is left to test the fit."
    if not data.scatter.any():
        return "No repeats show the scatter of measurements; only the residuals do."
    probability = f"p = {rounded(p_value)}" if p_value >= 0.001 else "p < 0.001"
    test = f" by an F({line.dof}, {data.known_dof:.0f}) test" if data.known_dof < NORMAL_DOF else ""
    chi2, dof = rounded(round(line.chi2, 9), 3), counted(line.dof, "degree")
    tested = f"χ² = {chi2}, {dof} of freedom, {probability}{test}"
    verb = "agree with the fit within chance, by"
    if p_value < SELDOM:
        verb = "scatter more than"
    elif fit.outliers:
        verb = "have outliers, so no test says if they scatter more than"
    elif p_value > 1 - RARE:
        verb = "scatter less than"
    between = f"; the scatter between runs is taken as one of the {data.varying}s" if line.between else ""
    return f"The runs {verb} their {'uncertainties' if data.stated else 'repeats'} ({tested}){between}."


def _capital(words: str) -> str:
    return f"{words[0].upper()}{words[1:]}"


def conditions(fit: Fitted) -> str:
    """Return what is the same in all runs, in words."""
    inputs = fit.shared.inputs
    words = inputs_in_words(Answers(fit.shared.scene, None, inputs))
    g = "" if "gravity" in fit.names else "g"
    inertia = "" if inputs["M"].given is None else "inertia"
    shown = (x for x, typed in inputs.items() if typed.given is not None or x in (g, inertia, "drop"))
    return ", ".join(words[x] for x in shown if x in words)


# Records and pages


def notes_of(fit: Fitted) -> tuple[list[str], list[str], list[str]]:
    """Return the verdict and warnings, how the runs were read and scatter, and what may be wrong in all."""
    outliers = [f"{_capital(message)}." for _, message in fit.outliers]
    doubts, remarks, unused = (map(_capital, x) for x in (fit.runs.doubts, fit.runs.remarks, fit.runs.unused))
    causes = [f"{_capital(fit.cause)}."] if fit.cause else []
    return [verdict(fit), *doubts, *outliers], [*remarks, *unused, _scatter(fit)], causes


def results_of(fit: Fitted) -> Fit:
    """Return all of a fit by name, with its sentences: first the verdict and the warnings."""
    known = fit.data.varying != "value"
    unit, of_unit = ("kg", abs(fit.values["gravity"])) if fit.data.varying == "force" else ("s", 1.0)
    between = as_determined(sqrt(fit.line.between) / of_unit, sqrt(fit.line.between) / of_unit)
    return Fit(
        **{name: fit.results[name].value if name in fit.results else None for name in QUANTITIES},
        uncertainty={name: result.uncertainty for name, result in fit.results.items()},
        interval={name: list(result.interval) for name, result in fit.results.items()},
        correlation=_correlation(fit.line.covariance),
        chi2=as_determined(fit.line.chi2, max(fit.line.chi2, 1e-3)) if known else None,
        dof=fit.line.dof,
        interval_dof=fit.line.t_dof if fit.line.t_dof < NORMAL_DOF else None,
        between_runs=between if known and fit.line.dof else None,
        between_runs_unit=unit if known and fit.line.dof else None,
        runs=_records(fit),
        notes=[*chain(*notes_of(fit))],
    )


def report_of(fit: Fitted, only: Sequence[str]) -> Report:
    """Return a fit in the forms in which it may be asked for; ``only`` names results."""
    public, results = results_of(fit), fit.results
    record = public.to_dict()
    asked = {name: record[name] for name in only or record}
    rows: Sequence[Mapping[str, Any]] = [asked]
    sentences = public.notes
    if only == ["runs"]:
        rows = public.runs
    elif only:
        first, _, causes = notes_of(fit)
        absent = [f"{RESULTS[x]}: {NOT_FITTED}." for x in only if record[x] is None]
        sentences = [*(equation(x, *results[x][:2]) for x in only if x in results), *absent]
        sentences += [*first[1:], *map(_capital, fit.runs.unused), *causes]
    else:
        names = "quantity", "value", "uncertainty", "low", "high", "unit"
        each = ((x, *result[:2], *result.interval, QUANTITIES[x].unit) for x, result in results.items())
        rows = [dict(zip(names, result, strict=True)) for result in each]
    bare = [cell(record[name]) for name in only]
    page = partial(_print_page, fit=fit, runs=public.runs)
    return Report(lambda: asked, lambda: rows, page, lambda: sentences, bare)


def _correlation(covariance: Any) -> float | None:
    """Return the correlation of the two fitted quantities that have most of it."""
    u = np.sqrt(covariance.diagonal())
    pairs = (covariance / np.outer(u, u))[np.triu_indices(len(u), 1)]
    return as_determined(float(max(pairs, key=abs)), 1.0) if len(pairs) else None


def _records(fit: Fitted) -> list[dict[str, Any]]:
    """Return the runs, as JSON and CSV have them; the residual is in standard uncertainties."""
    runs, shown, delay = fit.runs, data_of(fit.runs, fit.shown), fit.values["delay"]
    measured, (u, ideal) = runs.mean.copy(), np.full((2, len(runs.rows)), np.nan)
    if fit.data.stated:
        measured[fit.used] = runs.sign[fit.used] * fit.data.measured  # weighted means
    u[fit.used] = fit.line.sigma
    moving = np.where(moves(shown, fit.values), expected(shown, fit.values), np.nan)
    ideal[fit.shown] = runs.sign[fit.shown] * moving
    a, u_a, ideal_a = measured, u, ideal
    if runs.kind == "time":
        fall = np.where(measured > delay, measured - delay, np.nan)
        a, ideal_a = (physics.acceleration_of_fall(runs.given["drop"], t) for t in (fall, ideal - delay))
        u_a = 2 * a * u / fall
    of_time, of_a = fit.line.sigma.min(), np.nanmin(u_a, initial=1e300)
    computed = {"u": (u, of_time), "expected": (ideal, of_time), "residual": ((measured - ideal) / u, 1.0)}
    computed |= {"a": (a, of_a), "u_a": (u_a, of_a), "expected_a": (ideal_a, of_a)}
    columns = {**runs.given, runs.kind: measured}
    for x, (column, scale) in computed.items():
        columns.setdefault(x, np.array([as_determined(value, scale) for value in column.tolist()]))
    return [
        {"rows": " ".join(map(str, rows))}
        | {x: None if np.isnan(column[i]) else float(column[i]) for x, column in columns.items()}
        for i, rows in enumerate(runs.rows)
    ]


def _print_page(page: Page, fit: Fitted, runs: Sequence[Mapping[str, Any]]) -> None:
    """Print the conditions, the runs, what there is to say, and the results."""
    kind, (first, *others) = fit.runs.kind, notes_of(fit)
    page.say(conditions(fit))
    unit = parameter_of(kind).unit
    heads = f"{kind} ({unit})", f"expected ({unit})", f"u ({unit})", "residual/u"
    of_a = ("a (m/s²)", "expected (m/s²)") if kind == "time" else ()
    _print_table(page, ("row", "m1 (kg)", "m2 (kg)", *heads, *of_a), _rows(fit, runs))
    has_columns = fit.data.stated or fit.data.uncertain
    independent = " Uncertainties in columns count as independent from row to row." if has_columns else ""
    page.say(f"u is the standard uncertainty of a run's mean.{independent}", *chain(*others))
    page.say(*first, style="bold")
    if fit.results:
        numbers = ((x, published(*result), QUANTITIES[x]) for x, result in fit.results.items())
        rows = [(x, both, words.unit, words.symbol, ends) for x, (both, ends), words in numbers]
        value = "Value (outliers included)" if fit.outliers else "Value"
        _print_table(page, ("Quantity", value, "Unit", "Symbol", "95 % interval"), rows)


def _print_table(page: Page, heads: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    page.table(heads, [list(zip(*map(aligned, zip(*rows, strict=True)), strict=True))])


def _rows(fit: Fitted, runs: Sequence[Mapping[str, Any]]) -> list[list[str]]:
    """Return the cells of each run: the measurement, what is expected, and the residual."""
    # The mean has the digits of its own scatter.
    finest = float(min(fit.data.scatter.min() or np.inf, fit.line.sigma.min()))
    kind, rows = fit.runs.kind, []
    for run in runs:
        first, *others = run["rows"].split()
        is_range = len(others) > 1 and int(others[-1]) - int(first) == len(others)  # numbers of rows ascend
        row = f"{first}–{others[-1]}" if is_range else ",".join([first, *others])
        numbers = cut(run[kind], finest), cut(run["expected"], finest), cut(run["u"], run["u"])
        residual = "" if run["residual"] is None else f"{run['residual']:z.2f}"
        a = published(run["a"], run["u_a"])[0] if run["u_a"] else ""
        of_a = [a, cut(run["expected_a"], run["u_a"])] if kind == "time" else []
        rows.append([row, *(format_number(run[x]) for x in MASSES), *numbers, residual, *of_a])
    return rows
