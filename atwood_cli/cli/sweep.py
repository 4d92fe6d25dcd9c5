"""`atwood sweep`: ranges and lists of scenes, as a table with its regimes, JSON, CSV or a picture."""

from collections.abc import Mapping
from functools import partial

from ..explain.conditions import read_condition
from ..numbers.text import counted
from ..output.forms import Destination, Picture, Report, show
from ..output.text import say
from ..reading.inputs import read_digits
from ..reading.names import read_results
from ..solver.quantities import TABLE_NAMES, UNITS
from ..sweep.ranges import read_sweep
from ..sweep.sweep_figure import save_sweep
from ..sweep.sweep_page import SweepPage
from .options import COULD_NOT, DONE, FALL, FIGURE, OUTPUT, SCENE, Columns, Digits, Expect, with_options

HELP = """Solve a range or a list of scenes.

One or two options carry start:stop:count[:log], or a list, as 0,1,10; two make all combinations, at most
a million.

\b
Examples:
  atwood sweep --m1 1 --m2 3 --M 0:50:6 --mu 0.3
  atwood sweep --m1 1 --m2 3 --M 1:1000:4:log --mu 0.2:0.4:3 --only regime
  atwood sweep --m1 100g:500g:5 --m2 300g --M 50g --csv
  atwood sweep --m1 1 --m2 3 --M 0,1,10,inf --inertia disk,hoop
  atwood sweep --m1 1 --m2 3 --M 0:40:5 --mu 0.3 --expect no-slip
  atwood sweep --m1 1 --m2 3 --M 0:60:61 --only T1,T2 --figure t.svg

--figure draws, in place of the table, what --only names, or the acceleration, with one pair of axes for each
unit. A curve runs along a whole range, one for each value of a second range or list; a list alone is points.
"""


@with_options(SCENE | FALL, OUTPUT, FIGURE)
def sweep(
    given: Mapping[str, str | None],
    target: Destination,
    picture: Picture | None,
    *,
    only: Columns = None,
    expect: Expect = None,
    digits: Digits = None,
) -> int:
    asked, units = read_results("only", only or [], {name: UNITS[name] for name in TABLE_NAMES})
    names = list(dict.fromkeys(asked))
    precision, conditions = read_digits(digits), [*map(read_condition, expect or [])]
    swept = read_sweep(given, precision, units)
    if picture is not None:
        save_sweep(swept, names, precision, picture)
    swept_page = SweepPage(swept, names, precision, conditions)
    try:
        # What is drawn is not printed, too, but to a file that is asked for.
        page = partial(swept_page.print, table=picture is None or target.file is not None)
        aside = show(Report(swept_page.json, swept_page.records, page, swept_page.notes), target)
    except KeyboardInterrupt:
        if done := swept_page.tally.rows:
            say(f"stopped after {done} of {counted(swept.total, 'row')}")
        raise
    tally = swept_page.tally
    say(*aside or [f"{name} has no value in any row" for name in tally.missing], *tally.failures_said())
    return COULD_NOT if tally.missing or tally.failures else DONE
