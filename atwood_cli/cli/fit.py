"""`atwood fit`: the pulley's inertia and its axle's friction, from runs of a laboratory."""

from collections.abc import Mapping
from typing import Annotated, Any

from typer import Context

from ..laboratory.results import FITTED, QUANTITIES, RESULTS, SYMBOLS
from ..output.forms import FORMS, Destination, Picture, show
from ..output.text import say
from ..reading.names import divided, read_names
from ..solver.scene import SceneError
from ..tables.sources import Unreadable
from .options import (
    COULD_NOT,
    DONE,
    FIGURE,
    OUTPUT,
    TABLE,
    Layout,
    argument,
    flag,
    option,
    refuse,
    scene_option,
    with_options,
)

Table = Annotated[str, argument("Files", "RUNS", "Table of runs: CSV, .tsv, .xlsx, .ods; - for stdin.")]
Find = Annotated[
    list[str] | None,
    option(
        "Measured",
        metavar="NAME",
        words=lambda: {name: QUANTITIES[name].words for name in FITTED},
        help="Fit just this: rim_mass, axle, gravity or delay; or a,b.",
    ),
]
Without = Annotated[
    list[str] | None,
    option("Measured", metavar="ROW", help="Leave out this row, or cell, as 8:t2; repeatable; 5,7."),
]
Only = Annotated[
    list[str] | None,
    option(
        "Output", metavar="NAME", words=lambda: RESULTS, help="Print only this result; repeatable, or a,b."
    ),
]

HELP = """Fit laboratory runs: pulley inertia and axle friction.

\b
Examples:
  atwood fit runs.csv --drop 98cm --g 9.804
  atwood fit runs.csv --R 25mm --inertia disk --figure line.svg
  atwood fit runs.csv --columns m1:g,m2:g,-,t,t --drop 98cm
  atwood fit runs.csv --find gravity --M 84g --axle 0
  atwood fit runs.csv --find rim_mass,axle,delay --without 8:t2

Each row is a run, with columns m1, m2, and a, or t and drop, the height of fall; an option gives what is the
same for all, as --m1 0. Units stand in headings, as m1 (g) or "t, s", or in cells. Repeats are further rows,
or columns t1, t2 and so on. Uncertainties are in cells, 2.05(2), in headings, m1 (±1 g), or in columns headed
u(t), t_err, or ±, that of the column before it. Words of --columns are such names, with a unit as in m1:g;
m1:g+ fills blank cells from above, and no headings are needed.
Values of --M, --I, --axle and --g are not fitted. Results: rim_mass is the pulley's inertia as a mass at its
rim, c = I/R², for a disk M/2; axle is the axle's friction as a force at the rim. Both are fitted, unless
--find names others.
"""


def _shared(**remarks: str | None) -> dict[str, Any]:
    return {name: Annotated[str | None, scene_option(name, remark)] for name, remark in remarks.items()}


SHARED = {
    **_shared(drop="", m1=", of all runs", m2=", of all runs"),
    "hanger": Annotated[str | None, option("Scene", metavar="MASS", help="Mass to add to m1 and to m2.")],
    **_shared(M=", if it is known", inertia="; adds pulley_mass", I="; needs R"),
    **_shared(R="; adds moment_of_inertia", axle="", g=None),
}
"""The options of what all runs share."""


@with_options(OUTPUT, FIGURE, TABLE, SHARED)
def fit(
    context: Context,
    table: Table,
    given: Mapping[str, str | None],
    target: Destination,
    picture: Picture | None,
    layout: Layout,
    *,
    find: Find = None,
    without: Without = None,
    only: Only = None,
) -> int:
    names = read_names("only", only or [], RESULTS, "result", SYMBOLS)
    if "runs" in names and (not target.form or (len(names) > 1 and not FORMS[target.form].has_notes)):
        raise SceneError("only", "runs", "takes --json, or --csv and no other name")
    from ..laboratory import fit_of
    from ..laboratory.report import report_of

    try:
        best = fit_of(table, given, find or [], divided(without or []), *layout, flag)
    except Unreadable as error:
        return refuse(context, table, error)
    if picture is not None:
        from ..laboratory.fit_figure import save

        save(best, picture)
    report = report_of(best, names)
    say(*show(report, target))
    return COULD_NOT if "" in report.bare else DONE
