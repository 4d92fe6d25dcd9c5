"""`atwood fit`: the pulley's inertia and its axle's friction, from runs of a laboratory."""

from collections.abc import Collection, Mapping, Sequence
from fractions import Fraction
from math import isfinite
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..arithmetic.rounding import DOUBLE_DIGITS, text, to_digits
from ..laboratory.quantities import FITTED, QUANTITIES, SYMBOLS
from ..model.quantities import divided, read_names
from ..model.scene import INPUTS, UNMEASURED, parameter_of, read_digits, read_input, read_whole
from ..model.units import counted
from ..output.text import VERSION, Forms, cell, inputs_in_words, say, show
from .options import (
    COULD_NOT,
    DONE,
    AsCsv,
    AsJson,
    Bare,
    FigureFile,
    Force,
    Labels,
    Markdown,
    Plot,
    check,
    check_extras,
    option,
    scene_option,
)

if TYPE_CHECKING:
    from ..laboratory.fitting import Fitted
    from ..output.page import Page

Table = Annotated[
    str,
    typer.Argument(
        metavar="RUNS",
        rich_help_panel="Files",
        help="Table of runs, CSV or .tsv; - for stdin.",
        show_default=False,
    ),
]
Find = Annotated[
    list[str] | None,
    option(
        "Measured",
        metavar="NAME",
        words=lambda: {name: QUANTITIES[name].words for name in FITTED},
        help="Fit just this: rim_mass, axle or gravity; repeatable.",
    ),
]
Without = Annotated[
    list[str] | None,
    option("Measured", metavar="ROW", help="Leave this row out; repeatable, or 5,7."),
]
RESULTS = {
    **{name: one.words for name, one in QUANTITIES.items()},
    "correlation": "the correlation of two results",
    "chi2": "χ² of the runs by the uncertainties given, or the scatter of repeats",
    "dof": "degrees of freedom: the runs less what is fitted",
    "between_runs": "the standard deviation between runs beyond that, as a mass",
}
Only = Annotated[
    list[str] | None,
    option(
        "Output", metavar="NAME", words=lambda: RESULTS, help="Print only this result; repeatable, or a,b."
    ),
]
FitDigits = Annotated[
    str | None,
    option(
        "Output",
        "--digits",
        metavar="N",
        help="Significant digits, 17 at most; if not given, those that uncertainties leave, else of doubles.",
    ),
]
Explain = Annotated[
    bool, option("Output", "--explain", help="Instead, show how the line follows, with its numbers.")
]

HELP = """Fit runs of a laboratory: the pulley's inertia, its axle's friction.

Examples:
  atwood fit runs.csv --drop 98cm --g 9.804
  atwood fit runs.csv --R 25mm --inertia disk --figure line.svg
  atwood fit runs.csv --find gravity --M 84g --axle 0
  atwood fit runs.csv --json
  atwood fit runs.csv --explain --markdown > report.md

A row a run, with columns m1, m2, and a or time with drop, the height of fall (or --drop for all). Units
stand in headings, as m1 (g) or t/s, or in cells, as solve takes them. Repeats are further rows, or columns
t1, t2 and so on. Uncertainties are in cells, 2.05(2), or in columns u(t), t_err, or ± behind their own.
Columns m1+m2 and m2-m1 (or dm) may stand for masses: any two of the four do. How a file was read is said;
columns by other names are labels. Either mass may be the heavier. What --M, --I, --axle and --g say is given,
and not fitted.
Results: rim_mass is the pulley's inertia as a mass at its rim, c = I/R², of a disk half its mass; axle is
the friction of its axle as a force there. Both are always fitted where runs tell them apart; --find rim_mass
says that the axle is free. Rows are left out only by --without.
"""


def fit(
    table: Table,
    *,
    find: Find = None,
    without: Without = None,
    drop: Annotated[str | None, scene_option("drop", "Measured", ", if all runs have the same")] = None,
    M: Annotated[str | None, scene_option("M", remark=", if it is known")] = None,
    inertia: Annotated[
        str | None, scene_option("inertia", remark=" (a hollow sphere), which gives the pulley's mass")
    ] = None,
    I: Annotated[str | None, scene_option("I", remark=", if it is known; needs R")] = None,
    R: Annotated[str | None, scene_option("R", remark=", which gives the moment of inertia")] = None,
    axle: Annotated[str | None, scene_option("axle", remark=", if it is known")] = None,
    g: Annotated[str | None, scene_option("g")] = None,
    mu: Annotated[str | None, scene_option("mu", remark=", to tell runs that slip")] = None,
    wrap: Annotated[str | None, scene_option("wrap")] = None,
    label: Labels = None,
    digits: FitDigits = None,
    json: AsJson = False,
    csv: AsCsv = False,
    only: Only = None,
    explain: Explain = False,
    markdown: Markdown = False,
    plot: Plot = False,
    figure: FigureFile = None,
    bare: Bare = False,
    force: Force = False,
) -> int:
    options = dict(locals())
    check(options, only="plot")
    names = read_names("only", only or [], RESULTS, "result", SYMBOLS)
    out = [read_whole("without", word, 1, 10**9) for word in divided(without or [])]
    precision = read_digits(digits)
    inputs = {name: read_input(name, options.get(name)) for name in INPUTS}
    height = read_input("drop", drop) if drop is not None else None
    check_extras(plot, figure, force)
    from ..laboratory import fit_of

    best = fit_of(table, inputs, height, find or [], label or [], out)
    if explain:
        from ..laboratory.explained import explained
        from ..output.page import print_explanation

        print_explanation(_conditions(best), explained(best), markdown)
        return DONE
    if figure is not None:
        from ..output.fit_figure import save

        save(best, None if bare else ", ".join(_conditions(best)), figure, force)
    forms = _Forms(best, names, precision, plot)
    values = [cell(forms.values[name]) for name in names]
    say(*show(Forms(forms.json, forms.records, forms.page, forms.notes, values), json, csv))
    return COULD_NOT if "" in values else DONE


class _Forms:
    """A fit in the forms in which it may be asked for."""

    def __init__(self, fit: "Fitted", only: Sequence[str], digits: int | None, plot: bool) -> None:
        from ..laboratory.results import results_of
        from ..laboratory.sentences import head, notes, odd_cells

        self.fit, self.only, self.plot = fit, only, plot
        self.digits = digits and min(digits, DOUBLE_DIGITS)
        self.head, self.said = head(fit), notes(fit)
        odd = odd_cells(fit)
        if odd and not any("," in cell for cell in odd):  # whole rows
            rows = ",".join(cell.removeprefix("row ") for cell in odd)
            self.head.append(f"--without {rows} leaves {'them' if odd[1:] else 'it'} out.")
        self.record = results_of(fit)._asdict()
        self.values = {name: self._rounded(self.record[name]) for name in RESULTS}

    def _rounded(self, value: Any) -> Any:
        """Results rounded to the digits asked for, in lists and mappings too; inputs stay as they are."""
        from ..laboratory.headings import TAKEN

        if isinstance(value, dict):
            return {name: one if name in TAKEN else self._rounded(one) for name, one in value.items()}
        if isinstance(value, list):
            return [self._rounded(one) for one in value]
        if isinstance(value, float) and self.digits is not None:
            return to_digits(self.digits)(Fraction(value))
        return value

    def json(self) -> Any:
        from ..laboratory.headings import TAKEN

        if self.only:
            return {name: self.values[name] for name in self.only}
        record, absent = self._rounded(self.record), dict.fromkeys(QUANTITIES)
        by_name = {name: absent | record[name] for name in ("uncertainty", "interval")}
        runs = [line | {name: line.get(name) for name in TAKEN} for line in record["runs"]]
        return {"version": VERSION, **record, **by_name, "runs": runs}

    def records(self) -> Any:
        return [self.json()] if self.only else self._rounded(self.record["runs"])

    def notes(self) -> Sequence[str]:
        """The sentences that CSV and bare values have no place for."""
        from ..laboratory.numbers import shown

        results = self.fit.results.items()
        values = {x: f"{x} = {shown(*one[:2])} {QUANTITIES[x].unit}" for x, one in results}
        if self.only:
            absent = (f"{x}: {WITHOUT.get(x, NOT_FITTED)}." for x in self.only if self.values[x] is None)
            return [*(values[name] for name in self.only if name in values), *absent, *self.head[1:]]
        return [*self.head, *values.values(), *self.said]

    def page(self) -> None:
        from ..laboratory.results import prediction
        from ..output.page import Page
        from .help import command_lines

        page = Page()
        if self.plot:
            from ..output.plot import print_fit_plot

            print_fit_plot(page, [", ".join(_conditions(self.fit)), *self.head], self.fit)
        else:
            self._tables(page)
        page.say(*self.said)
        if command := prediction(self.fit):
            page.say("To predict:")
            for line in command_lines(command, page.width):
                page.line(line)

    def _tables(self, page: "Page") -> None:
        from ..laboratory.numbers import COLUMNS, rows_of

        page.say(", ".join(_conditions(self.fit)))
        page.say(*self.head, style="bold")
        if results := self.fit.results:
            columns = zip(*rows_of(results, self.digits), strict=True)
            _print_table(page, dict(zip(COLUMNS, columns, strict=True)), ("Quantity", "Unit", "Symbol"))
        self._runs(page)
        page.say(self._quality())

    def _quality(self) -> str:
        """How well the line fits, in a sentence."""
        from ..laboratory.numbers import few

        fit, freedom = self.fit, f"{counted(self.fit.dof, 'degree')} of freedom"
        by = "scatter of repeats" if isfinite(fit.data.within) else "uncertainties given"
        said = freedom if fit.chi2 is None else f"χ² = {few(fit.chi2, 3)} by the {by}, {freedom}"
        if (pair := fit.correlation) is not None:
            said += f"; correlation of {pair[0]} and {pair[1]}: {few(pair[2], 2)}"
        return f"Residuals are in standard uncertainties, u; {said}."

    def _runs(self, page: "Page") -> None:
        """Run by run: the measurement, what is expected, and the residual."""
        from ..laboratory.numbers import cut, shown

        kind, labels, lines = self.fit.runs.kind, self.fit.runs.labels, self.record["runs"]
        odd = {" ".join(map(str, self.fit.used[i].rows)) for i in self.fit.odd.runs}
        if more := max(len(lines) - MOST_ROWS, 0):  # those that are odd, and then the first
            lines = sorted(lines, key=lambda line: line["rows"] not in odd)[:MOST_ROWS]
        unit = parameter_of(kind).unit
        finest = min((line["u"] for line in lines if line["u"]), default=None)
        columns = {
            "row": [line["rows"].replace(" ", ",") + " !" * (line["rows"] in odd) for line in lines],
            **{name: [line[name] for line in lines] for name in labels},
            **{f"{name} (kg)": [text(line[name]) for line in lines] for name in ("m1", "m2")},
            f"{kind} ({unit})": [
                shown(line[kind], line["u"]) if line["u"] else cut(line[kind], finest) for line in lines
            ],
            f"expected ({unit})": [
                "" if line["expected"] is None else cut(line["expected"], finest) for line in lines
            ],
            "residual/u": ["" if line["residual"] is None else f"{line['residual']:.2f}" for line in lines],
        }
        _print_table(page, columns, labels)
        if more:
            page.say(f"{more} more runs: --csv has all.")


def _print_table(page: "Page", columns: Mapping[str, Sequence[str]], words: Collection[str]) -> None:
    """A table whose numbers have their points below each other; columns of words are as they are."""
    from ..output.page import aligned

    cells = (column if name in words else aligned(column) for name, column in columns.items())
    page.table(list(columns), [list(zip(*cells, strict=True))])


MOST_ROWS = 100
"""Runs in a table that somebody reads."""
NOT_FITTED = "has no value: it is given, was not to be fitted, or the runs do not determine it"
WITHOUT = {
    "chi2": "needs uncertainties, or repeats",
    "between_runs": "needs uncertainties, or repeats, and more runs than results",
    "correlation": "needs two results",
    "moment_of_inertia": "needs the rim mass to be fitted, and R",
    "pulley_mass": "needs the rim mass to be fitted, and the pulley's shape, --inertia",
}


def _conditions(fit: "Fitted") -> list[str]:
    """What is the same in all runs."""
    inputs = dict(fit.given.inputs)
    if fit.runs.one_drop and (drop := fit.used[0].drop) is not None:
        inputs["drop"] = drop
    motion = UNMEASURED._replace(drop=inputs["drop"].value) if "drop" in inputs else UNMEASURED
    uncertain = {name: one.uncertainty for name, one in inputs.items() if one.uncertainty}
    words = inputs_in_words(fit.given.scene, motion, uncertain)
    g = "" if "gravity" in fit.values else "g"
    return [words[x] for x, one in inputs.items() if one.given is not None or x in (g, "drop")]
