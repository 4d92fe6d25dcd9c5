"""A fit as tables with sentences, JSON and CSV."""

from collections.abc import Mapping, Sequence
from typing import Any

from ..model.digits import text
from ..model.scene import UNMEASURED, parameter_of
from ..output.page import Page, aligned
from ..output.text import VERSION, Forms, cell, inputs_in_words
from .fitting import expected
from .judgement import Fitted
from .published import QUANTITIES, Fit, cut, equation, few, published
from .runs import TAKEN
from .sentences import head, notes

NOT_FITTED = "has no value: it is given, was not to be fitted, or the runs do not determine it"
WITHOUT = {
    "chi2": "needs uncertainties, or repeats",
    "between_runs": "needs uncertainties, or repeats, and more runs than results",
    "correlation": "needs two results",
    "moment_of_inertia": "needs the rim mass to be fitted, and R",
    "pulley_mass": "needs the rim mass to be fitted, and the pulley's shape, --inertia",
}


def forms_of(fit: Fitted, only: Sequence[str]) -> Forms:
    """A fit in the forms in which it may be asked for; ``only`` names results."""
    record: dict[str, Any] = results_of(fit)._asdict()
    said, above = notes(fit), head(fit)
    if fit.without:
        rows = [str(row) for i in fit.odd for row in fit.used[i].rows]
        above.append(f"--without {','.join(rows)} leaves {'them' if rows[1:] else 'it'} out.")

    def json() -> Any:
        if only:
            return {name: record[name] for name in only}
        absent = dict.fromkeys(QUANTITIES)
        by_name = {name: absent | record[name] for name in ("uncertainty", "interval")}
        runs = [line | {x: line.get(x) for x in TAKEN} for line in record["runs"]]
        return {"version": VERSION, **record, **by_name, "runs": runs}

    def beside() -> Sequence[str]:
        """The sentences that CSV and bare values have no place for."""
        values = {x: equation(x, *one[:2]) for x, one in fit.whole.results.items()}
        if not only:
            return [*above, *values.values(), *said]
        absent = (f"{x}: {WITHOUT.get(x, NOT_FITTED)}." for x in only if record[x] is None)
        return [*(values[x] for x in only if x in values), *absent, *above[1:]]

    def page() -> None:
        _print_page(fit, record["runs"], above, said)

    values = [cell(record[name]) for name in only]
    return Forms(json, lambda: [json()] if only else record["runs"], page, beside, values)


def results_of(fit: Fitted) -> Fit:
    """All of a fit by name, with its sentences."""
    whole, correlation = fit.whole, fit.whole.correlation
    return Fit(
        **{name: whole.results[name].value if name in whole.results else None for name in QUANTITIES},
        uncertainty={name: one.uncertainty for name, one in whole.results.items()},
        interval={name: list(one.interval) for name, one in whole.results.items()},
        correlation=correlation and correlation[2],
        chi2=whole.chi2,
        dof=whole.best.dof,
        between_runs=whole.between_runs,
        runs=_lines(fit),
        notes=[*head(fit), *notes(fit)],
    )


def _lines(fit: Fitted) -> list[dict[str, Any]]:
    """The runs, as JSON and CSV have them; the residual is in standard uncertainties."""
    data, values = fit.whole.best.data, fit.whole.best.values
    accelerations = expected(data._replace(drop=None), values)  # not positive where nothing would move
    columns = (data.measured, expected(data, values), accelerations, fit.whole.best.sigma)
    used = {run.rows: one for run, *one in zip(fit.used, *(c.tolist() for c in columns), strict=True)}
    lines = []
    for run in fit.runs.runs:
        sign = -1 if run.mean < 0 else 1
        measured, ideal, a, u = used.get(run.rows, (abs(run.mean), 0.0, 0.0, None))
        lines.append(
            {
                "rows": " ".join(map(str, run.rows)),
                "m1": float(run.m1.value),
                "m2": float(run.m2.value),
                **({} if run.drop is None else {"drop": float(run.drop.value)}),
                fit.runs.kind: sign * measured,
                "u": u,
                "expected": sign * ideal if a > 0 else None,
                "residual": sign * (measured - ideal) / u if a > 0 else None,
            }
        )
    return lines


def _print_page(
    fit: Fitted, lines: Sequence[Mapping[str, Any]], above: Sequence[str], said: Sequence[str]
) -> None:
    """The conditions, the results, the runs, and what there is to say."""
    page = Page()
    page.say(conditions(fit))
    page.say(*above, style="bold")
    written = {x: published(*one) for x, one in fit.whole.results.items()}
    results = {
        "Quantity": list(written),
        "Value": [value for value, _ in written.values()],
        "Unit": [QUANTITIES[x].unit for x in written],
        "Symbol": [QUANTITIES[x].symbol for x in written],
        "95 % interval": [ends for _, ends in written.values()],
    }
    for columns in (results, _columns(fit, lines)) if written else (_columns(fit, lines),):
        page.table(list(columns), [list(zip(*map(aligned, columns.values()), strict=True))])
    u = "u is the standard uncertainty of a run, by all that varies from run to run"
    if (pair := fit.whole.correlation) is not None:
        u += f"; correlation of {pair[0]} and {pair[1]}: {few(pair[2], 2)}"
    page.say(f"{u}.", *said)


def _columns(fit: Fitted, lines: Sequence[Mapping[str, Any]]) -> dict[str, list[str]]:
    """Run by run: the measurement, what is expected, and the residual."""
    kind, data = fit.runs.kind, fit.whole.best.data
    odd = {" ".join(map(str, fit.used[i].rows)) for i in fit.odd}
    unit = parameter_of(kind).unit
    finest = min((line["u"] for line in lines if line["u"]), default=None)
    if data.scatter.any() and finest:  # the mean has the digits of its own scatter
        finest = min(finest, float(data.scatter.min()))

    def column(name: str) -> list[str]:
        return ["" if line[name] is None else cut(line[name], finest) for line in lines]

    return {
        "row": [line["rows"].replace(" ", ",") + " !" * (line["rows"] in odd) for line in lines],
        **{f"{name} (kg)": [text(line[name]) for line in lines] for name in ("m1", "m2")},
        f"{kind} ({unit})": column(kind),
        f"expected ({unit})": column("expected"),
        f"u ({unit})": ["" if line["u"] is None else cut(line["u"], line["u"]) for line in lines],
        "residual/u": ["" if line["residual"] is None else f"{line['residual']:.2f}" for line in lines],
    }


def conditions(fit: Fitted) -> str:
    """What is the same in all runs, in words."""
    inputs = fit.given.inputs
    motion = UNMEASURED._replace(drop=inputs["drop"].value) if "drop" in inputs else UNMEASURED
    uncertain = {name: one.uncertainty for name, one in inputs.items() if one.uncertainty}
    words = inputs_in_words(fit.given.scene, motion, uncertain)
    g = "" if "gravity" in fit.whole.best.names else "g"
    return ", ".join(words[x] for x, one in inputs.items() if one.given is not None or x in (g, "drop"))
