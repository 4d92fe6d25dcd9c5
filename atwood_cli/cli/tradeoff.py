"""`atwood tradeoff`: the time and the error of each way to solve scenes, on this computer."""

from itertools import chain
from typing import Annotated

from ..output.forms import Destination, Picture, Report, show
from ..reading.inputs import read_whole
from ..reading.names import read_names
from .options import DONE, FIGURE, option, results, with_options

DEFAULT_SCENES = 500
Families = Annotated[
    list[str] | None,
    option("Measurement", "--family", metavar="NAME", help="Measure this family of scenes only; repeatable."),
]
HELP = """Measure what accuracy costs in time on this machine.

\b
Examples:
  atwood tradeoff
  atwood tradeoff --family near-critical --scenes 2000
  atwood tradeoff --json > measured.json
"""


@with_options(results("json"), FIGURE)
def tradeoff(
    target: Destination,
    picture: Picture | None,
    *,
    family: Families = None,
    scenes: Annotated[
        str | None,
        option(
            "Measurement",
            metavar="N",
            help=f"Scenes of each family whose errors count; {DEFAULT_SCENES} if not given.",
        ),
    ] = None,
) -> int:
    from ..output.page import progress
    from ..tradeoff import tradeoff_page
    from ..tradeoff.measure import FAMILIES, MOST_SCENES, draw_scenes, measure

    families = list(dict.fromkeys(read_names("family", family or FAMILIES, FAMILIES, "family of scenes")))
    count = read_whole("scenes", DEFAULT_SCENES if scenes is None else scenes, 1, MOST_SCENES)
    parts = (measure(name, draw_scenes(name, count)) for name in families)
    with progress(parts, len(families)) as measuring:
        measured = list(chain.from_iterable(measuring))
    if picture is not None:
        tradeoff_page.save(measured, picture)
    report = Report(
        json=lambda: tradeoff_page.record(measured, count),
        records=list,
        page=lambda page: tradeoff_page.print_table(page, measured, count),
    )
    show(report, target)
    return DONE
