"""`atwood fit`: runs of a laboratory, and what of the pulley and its axle they require."""

import sys
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..arithmetic.rounding import as_typed, text, to_digits
from ..files import STREAM
from ..model.scene import INPUTS, Input, SceneError, parameter_of, read_digits, read_input, stated
from .options import (
    COULD_NOT,
    DONE,
    FIGURE_TO_REPLACE,
    ONE_FORM,
    PLOT_IS_TEXT,
    AsCsv,
    AsJson,
    FigureFile,
    Force,
    Labels,
    Rule,
    check,
    check_extras,
    divided,
    flag,
    near_or_all,
    option,
    scene_option,
)
from .text import Forms, cell, for_stream, say, show

if TYPE_CHECKING:
    from ..fit.fitting import Fit
    from ..fit.results import Result
    from .page import Page

Table = Annotated[
    str,
    typer.Argument(
        metavar="RUNS",
        rich_help_panel="Files",
        help="Table of runs, CSV or .tsv; - for stdin.",
        show_default=False,
    ),
]
WHAT = {
    "rim_mass": "the pulley's inertia as a mass at its rim, c = I/R²",
    "axle": "the friction of its axle, as a force at the rim",
    "gravity": "gravity",
}
NAMED = {"g": "gravity", "c": "rim_mass", "f": "axle"}
Find = Annotated[
    list[str] | None,
    option(
        "Measured",
        metavar="NAME",
        words=lambda: WHAT,
        help="Fit just this, whether or not it is needed: rim_mass, axle or gravity; repeatable.",
    ),
]
RESULTS = {
    **WHAT,
    "chi2": "χ² by the uncertainties given, or the scatter of repeats",
    "dof": "degrees of freedom",
    "moment_of_inertia": "with R, the moment of inertia",
    "pulley_mass": "with its shape, the pulley's mass",
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
        help="Significant digits, 1 to 1000; if not given, those that uncertainties leave, else of doubles.",
    ),
]
Explain = Annotated[
    bool, option("Output", "--explain", help="Instead, show how the line follows, with its numbers.")
]
Plot = Annotated[bool, option("Output", "--plot", help="Draw the line in place of the tables (extra: plot).")]
RULES = (
    *PLOT_IS_TEXT,
    *(
        Rule("explain", name, f"has no part in --{name}; leave one of them out")
        for name in ("json", "csv", "only", "plot")
    ),
    Rule("only", "plot", "has no say beside --plot; leave one of them out"),
)

HELP = """Fit runs of a laboratory: the pulley's inertia, its axle's friction.

Examples:
  atwood fit runs.csv --drop 98cm --g 9.804
  atwood fit runs.csv --R 25mm --inertia disk --figure line.svg
  atwood fit runs.csv --find gravity --M 84g --axle 0
  atwood fit runs.csv --json
  atwood fit runs.csv --explain

A row a run, with columns m1, m2, and a or time with drop, the height of fall (or --drop for all);
a header may name the unit, as m1 (g). Repeats are further rows, or columns time 1, time 2 and so on.
Cells are as solve takes them, with units and uncertainties; columns by other names are labels. Either
mass may be the heavier. What --M, --I, --axle and --g say is known, and not fitted.
"""


def fit(
    table: Table,
    *,
    find: Find = None,
    drop: Annotated[str | None, scene_option("drop", "Measured", ", if all runs have the same")] = None,
    M: Annotated[str | None, scene_option("M", remark=", if it is known")] = None,
    inertia: Annotated[str | None, scene_option("inertia", remark=", which gives the pulley's mass")] = None,
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
    plot: Plot = False,
    figure: FigureFile = None,
    force: Force = False,
) -> int:
    options = dict(locals())
    check([ONE_FORM, FIGURE_TO_REPLACE], options)
    wanted = [NAMED.get(word, word) for word in divided(find or [])]
    for word in wanted:
        if word not in WHAT:
            raise SceneError("find", word, f"is nothing to fit{near_or_all(word, WHAT)}")
    names = divided(only or [])
    for word in names:
        if word not in RESULTS:
            raise SceneError("only", word, f"is no result{near_or_all(word, RESULTS)}")
    check(RULES, options)
    precision = read_digits(digits)
    inputs = {name: read_input(name, options.get(name)) for name in INPUTS}
    height = read_input("drop", drop) if drop is not None else None
    check_extras(plot, figure, force)
    found = _fitted(table, inputs, height, list(dict.fromkeys(wanted)), label or [])
    if explain:
        _print_explanation(found, inputs)
        return DONE
    if figure is not None:
        from .fit_figure import save

        save(found, _head(found, inputs), figure, force)
    forms = _Forms(found, inputs, names, precision, plot)
    bare = bool(names) and not (json or csv)
    say(*show(forms.forms(), json, csv, bare=bare))
    return COULD_NOT if bare and not all(cell(forms.values[name]) for name in names) else DONE


def _fitted(
    table: str, inputs: Mapping[str, Input], drop: Input | None, find: Sequence[str], labels: Sequence[str]
) -> "Fit":
    """The fit of a table. Raises OSError, ArithmeticError, SceneError."""
    from ..batch.formats import opened, read_cells
    from ..batch.quoted import Unreadable
    from ..fit.fitting import fitted, known_of
    from ..fit.runs import inputs_of_runs, read_runs

    usual = "\t" if Path(table).suffix.lower() == ".tsv" else ","
    try:
        with ExitStack() as stack:
            cells = read_cells(opened(table, stack), usual, inputs_of_runs)
        runs = read_runs(cells, usual, labels, drop)
        known = known_of(inputs, runs)
        for name, given in (
            ("rim_mass", "M" if inputs["M"].given else "I"),
            ("axle", "axle"),
            ("gravity", "g"),
        ):
            if name in find and inputs[given].given is not None:
                raise SceneError("find", name, f"is known by {flag(given)}; leave one of them out")
        return fitted(runs, known, find)
    except Unreadable as error:
        raise OSError(f"cannot read {'stdin' if table == STREAM else table}: {error}") from None


class _Forms:
    """A fit in the forms in which it may be asked for."""

    def __init__(
        self, fit: "Fit", inputs: Mapping[str, Input], only: Sequence[str], digits: int | None, plot: bool
    ) -> None:
        from ..fit.results import record
        from ..fit.sentences import notes, verdict

        self.fit, self.inputs, self.only, self.digits, self.plot = fit, inputs, only, digits, plot
        self.notes = [*(f"{words[0].upper()}{words[1:]}" for words in fit.runs.remarks), *notes(fit)]
        self.record = record(fit, inputs, [verdict(fit), *self.notes])
        self.values = {name: self._rounded(self.record.get(name)) for name in RESULTS}

    def _rounded(self, value: Any) -> Any:
        """Numbers to the digits asked for, wherever they are, but for those that were read."""
        if isinstance(value, dict):
            return {name: one if name in READ else self._rounded(one) for name, one in value.items()}
        if isinstance(value, list):
            return [self._rounded(one) for one in value]
        if isinstance(value, float) and self.digits is not None:
            return to_digits(self.digits)(Fraction(value))
        return value

    def forms(self) -> Forms:
        return Forms(json=self._json, records=self._records, page=self._page, notes=self._beside)

    def _json(self) -> Mapping[str, object]:
        if self.only:
            return {name: self.values[name] for name in self.only}
        whole: dict[str, object] = self._rounded(self.record)
        return whole

    def _records(self) -> Sequence[Mapping[str, object]]:
        if self.only:
            return [{name: self.values[name] for name in self.only}]
        runs: list[dict[str, object]] = self._rounded(self.record["runs"])
        return runs

    def _beside(self) -> Sequence[str]:
        """What CSV and bare values have no place for: the verdict, what was found, and all else."""
        from ..fit.results import results
        from ..fit.sentences import shown, verdict

        found = results(self.fit, self.inputs).items()
        values = {name: f"{name} = {shown(*one)} {UNITS[name]}" for name, one in found}
        if self.only:
            absent = (f"{x}: {WITHOUT.get(x, NOT_FITTED)}." for x in self.only if self.values[x] is None)
            return [*(values[name] for name in self.only if name in values), *absent]
        return [verdict(self.fit), *values.values(), *self.notes]

    def _page(self) -> None:
        if self.only:
            if any(values := [cell(self.values[name]) for name in self.only]):
                print(*values, sep="\n")
            return
        from .help import command_lines
        from .page import Page

        page = Page()
        if self.plot:
            from .plot import print_fit_plot

            print_fit_plot(page, _head(self.fit, self.inputs), self.fit)
        else:
            self._tables(page)
        for note in self.notes:
            page.say(note)
        if command := prediction_of(self.fit, self.inputs):
            page.say("To predict:")
            for line in command_lines(command, page.width):
                page.line(line)

    def _tables(self, page: "Page") -> None:
        from ..fit.results import results
        from ..fit.sentences import verdict
        from .page import aligned

        page.say(_head(self.fit, self.inputs))
        page.say(verdict(self.fit), "bold")
        if found := results(self.fit, self.inputs):
            values = aligned(self._shown(one) for one in found.values())
            ranges = aligned(self._range(one) for one in found.values())
            rows = [
                [for_stream(word, sys.stdout) for word in (name, value, UNITS[name], SYMBOLS[name], range_)]
                for name, value, range_ in zip(found, values, ranges, strict=True)
            ]
            page.table(["Quantity", "Value", "Unit", "Symbol", "95 % interval"], [rows])
        self._runs(page)
        page.say(self._quality())

    def _quality(self) -> str:
        """How well it fits, in a sentence."""
        from ..fit.sentences import few

        fit, freedom = self.fit, f"{self.fit.dof} degree{'s' * (self.fit.dof != 1)} of freedom"
        by = "uncertainties given" if fit.spread_known else "scatter of repeats"
        said = freedom if fit.chi2 is None else f"χ² = {few(fit.chi2, 3)} by the {by}, {freedom}"
        if (pair := fit.correlation) is not None:
            said += f"; correlation of {pair[0]} and {pair[1]}: {few(pair[2], 2)}"
        return f"Residuals are in standard uncertainties, u; {said}."

    def _shown(self, one: "Result") -> str:
        from ..fit.sentences import shown

        return shown(*one) if self.digits is None else text(self._rounded(one.value))

    def _range(self, one: "Result") -> str:
        if not one.uncertainty:
            return ""
        from ..fit.sentences import interval

        half = self.fit.times * one.uncertainty
        return interval(one.value - half, one.value + half, one.uncertainty)

    def _runs(self, page: "Page") -> None:
        """Run by run: what was measured, what is expected, and what is left."""
        from ..fit.sentences import cut, shown
        from .page import aligned

        kind, lines = self.fit.runs.kind, self.fit.lines
        unit = parameter_of(kind).unit
        labels = self.fit.runs.labels
        finest = min((line.uncertainty for line in lines if line.uncertainty), default=None)
        columns = {
            "row": [",".join(map(str, line.run.rows)) for line in lines],
            **{name: [line.run.labels[name] for line in lines] for name in labels},
            "m1 (kg)": [as_typed(line.run.m1.value) for line in lines],
            "m2 (kg)": [as_typed(line.run.m2.value) for line in lines],
            f"{kind} ({unit})": [shown(line.measured, line.uncertainty) for line in lines],
            f"expected ({unit})": [
                "" if line.expected is None else cut(line.expected, finest) for line in lines
            ],
            "residual/u": ["" if line.residual is None else f"{line.residual:.2f}" for line in lines],
        }
        cells = [aligned(column) if name not in labels else column for name, column in columns.items()]
        rows = [[for_stream(word, sys.stdout) for word in row] for row in zip(*cells, strict=True)]
        page.table([for_stream(name, sys.stdout) for name in columns], [rows])


READ = ("m1", "m2", "drop", "a", "time")
NOT_FITTED = "was not needed, or is known, and so not fitted"
WITHOUT = {
    "chi2": "needs uncertainties, or repeats",
    "moment_of_inertia": "needs the rim mass to be fitted, and R",
    "pulley_mass": "needs the rim mass to be fitted, and the pulley's shape, --inertia",
}
UNITS = {"rim_mass": "kg", "axle": "N", "gravity": "m/s²", "moment_of_inertia": "kg m²", "pulley_mass": "kg"}
SYMBOLS = {"rim_mass": "c", "axle": "f", "gravity": "g", "moment_of_inertia": "I", "pulley_mass": "M"}


def prediction_of(fit: "Fit", inputs: Mapping[str, Input]) -> str:
    from ..fit.results import prediction

    return prediction(fit, inputs)


def _head(fit: "Fit", inputs: Mapping[str, Input]) -> str:
    """What is the same in all runs, in a line."""
    shared = {name: one for name, one in inputs.items() if one.given is not None or name == "g"}
    parts = [_stated(name, one) for name, one in shared.items()]
    if fit.runs.one_drop and (drop := fit.used[0].drop) is not None:
        parts.append(_stated("drop", drop))
    return ", ".join(parts)


def _stated(name: str, one: Input) -> str:
    if isinstance(one.value, Fraction):
        spread = f" ± {as_typed(one.uncertainty)}" if one.uncertainty else ""
        return stated(name, f"{as_typed(one.value)}{spread}")
    return f"{name} = {one.given}"


def _print_explanation(fit: "Fit", inputs: Mapping[str, Input]) -> None:
    from ..derivation.typeset import as_text
    from ..fit.explained import explained
    from .page import Page
    from .solve import NARROWEST, READABLE

    page = Page()
    width = max(NARROWEST, min(READABLE, page.room or READABLE))
    lines = as_text(_head(fit, inputs), explained(fit), width, lambda words: for_stream(words, sys.stdout))
    for line, style in lines:
        page.line(line, style)
