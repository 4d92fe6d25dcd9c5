"""`atwood tradeoff`: time beside error on this machine, on one screen or in full, or drawn."""

from collections.abc import Mapping, Sequence
from itertools import groupby
from operator import attrgetter
from typing import TYPE_CHECKING, Annotated

from ..model.quantities import read_names
from ..model.scene import Scene, SceneError, read_whole
from ..output.text import VERSION, Forms, describe, say, scene_record, show
from .options import (
    DONE,
    AsCsv,
    AsJson,
    Bare,
    FigureFile,
    Force,
    check,
    check_extras,
    option,
    takes_scene,
)

if TYPE_CHECKING:
    from ..output.page import Page
    from ..tradeoff.measure import March
    from ..tradeoff.outcome import Overall, Tradeoff


def _families() -> Mapping[str, str]:
    from ..tradeoff.scenes import FAMILIES

    return {name: family.meaning for name, family in FAMILIES.items()}


Families = Annotated[
    list[str] | None,
    option(
        "Measurement",
        "--family",
        metavar="NAME",
        words=_families,
        help="Measure this family of scenes only; repeatable.",
    ),
]
DEFAULT_SCENES, DEFAULT_SEED, MOST_SEED = 500, 1, 10**9
Scenes = Annotated[
    str | None,
    option(
        "Measurement",
        metavar="N",
        help=f"Scenes of each family whose errors count; {DEFAULT_SCENES} if not given.",
    ),
]
Seed = Annotated[
    str | None,
    option(
        "Measurement", metavar="N", help=f"Seed from which the scenes are drawn; {DEFAULT_SEED} if not given."
    ),
]
Elements = Annotated[
    str | None,
    option(
        "Measurement", metavar="N", help="String elements at most, up to 10 million; a million if not given."
    ),
]
Everything = Annotated[
    bool, option("Output", "--all", help="Show every setting on each family, and all numbers of elements.")
]


HELP = """Measure what accuracy costs on this machine: time beside error, for families of scenes or for one.

Examples:
  atwood tradeoff
  atwood tradeoff --m1 1 --m2 3 --M 10 --mu 0.3
  atwood tradeoff --family near-critical --scenes 2000
  atwood tradeoff --all --elements 10000000
  atwood tradeoff --json > measured.json

What is shown are the settings that no other beats: none is both faster and more accurate.
"""


@takes_scene
def tradeoff(
    given: Mapping[str, str | None],
    *,
    family: Families = None,
    scenes: Scenes = None,
    seed: Seed = None,
    elements: Elements = None,
    all: Everything = False,  # noqa: A002 - the name of the option
    figure: FigureFile = None,
    bare: Bare = False,
    force: Force = False,
    json: AsJson = False,
    csv: AsCsv = False,
) -> int:
    check({**locals(), **given})
    for name, instead in {"axle": "leave it out", "I": "give --inertia"}.items():
        if given[name] is not None:
            why = f"is not measured, as the paper's formulas do not take it; {instead}"
            raise SceneError(name, given[name], why)
    from ..output.page import watched
    from ..solver.elements import MAX_ELEMENTS
    from ..tradeoff.measure import COUNTS, MOST_SCENES, USUAL_ELEMENTS
    from ..tradeoff.outcome import tradeoff as measure
    from ..tradeoff.scenes import FAMILIES

    scene = Scene.read(given) if any(value is not None for value in given.values()) else None
    families = list(dict.fromkeys(read_names("family", family or FAMILIES, FAMILIES, "family of scenes")))
    check_extras(False, figure, force)
    count = read_whole("scenes", scenes or DEFAULT_SCENES, 1, MOST_SCENES)
    start = read_whole("seed", seed or DEFAULT_SEED, 0, MOST_SEED)
    most = read_whole("elements", elements or USUAL_ELEMENTS, COUNTS[0], MAX_ELEMENTS)
    outcome = measure(families, count, start, scene, most, watched)
    if figure is not None:
        from ..output.tradeoff_figure import save

        save(outcome, figure, force, bare)
    say(*show(_forms(outcome, all), json, csv))
    return DONE


def _forms(outcome: "Tradeoff", everything: bool) -> Forms:
    from ..output.page import Page

    return Forms(
        json=lambda: _record(outcome),
        records=lambda: _records(outcome),
        page=lambda: _print_all(outcome, Page()) if everything else print_front(outcome, Page()),
        notes=lambda: [*outcome.notes, outcome.advice],
    )


def _record(outcome: "Tradeoff") -> dict[str, object]:
    """For JSON: what was measured, the scene or the seed, the notes and the advice."""
    drawn = outcome.seed is not None
    return {
        "version": VERSION,
        "scene": None if drawn else scene_record(outcome.scene),
        "seed": outcome.seed,
        "scenes": outcome.scenes if drawn else None,
        "arithmetic": [one._asdict() for one in outcome.measured],
        "elements": [one._asdict() for one in outcome.marches],
        "notes": outcome.notes,
        "advice": outcome.advice,
    }


def _records(outcome: "Tradeoff") -> list[dict[str, object]]:
    """For CSV: a line for each setting and family, and for each number of elements."""
    records = [one._asdict() for one in outcome.measured]
    for one in outcome.marches:
        records.append({"setting": "elements" if one.elements else "closed form"} | one._asdict())
    names = dict.fromkeys(name for record in records for name in record)
    return [{name: record.get(name) for name in names} for record in records]


def print_front(outcome: "Tradeoff", page: "Page") -> None:
    """One screen: the settings that none beats, which to take, and what string elements come to."""
    from ..tradeoff.outcome import elements_in_words, front, legend, overall

    families = outcome.families
    of = f"{outcome.scenes} {'scenes each of' if families[1:] else 'scenes,'} {', '.join(families)}"
    about = f"scene: {describe(outcome.scene)}" if outcome.seed is None else f"{of} (seed {outcome.seed})"
    page.say(f"Settings that no other beats (--all shows the rest): {about}")
    _print_settings(page, front(overall(outcome.measured)))
    page.say(outcome.advice, style="bold")
    page.say(legend(len(families)))
    page.say(*outcome.notes or [elements_in_words(outcome.marches)])


def _print_all(outcome: "Tradeoff", page: "Page") -> None:
    """A table of the settings for each family of scenes, one of string elements, and what follows."""
    from ..tradeoff.outcome import ELEMENTS_LEGEND, STARS, front, legend, overall
    from ..tradeoff.scenes import FAMILIES

    for family, group in groupby(outcome.measured, attrgetter("family")):
        meaning = FAMILIES[family].meaning if family in FAMILIES else describe(outcome.scene)
        page.say(f"{family}: {meaning}", style="bold")
        settings = overall(list(group))
        _print_settings(page, settings, front(settings))
    page.say(f"{STARS} {legend()}")
    if outcome.marches:
        page.say(f"String elements: e^(μφ) of {describe(outcome.scene)}", style="bold")
        _print_marches(page, outcome.marches)
        page.say(ELEMENTS_LEGEND)
    page.say(*outcome.notes)
    page.say(outcome.advice, style="bold")


def _print_settings(page: "Page", settings: "Sequence[Overall]", starred: "Sequence[Overall]" = ()) -> None:
    from ..tradeoff.outcome import in_seconds, percent, short

    mark = {True: "* ", False: "  " * bool(starred)}
    columns = [
        ["Setting", *(f"{mark[one in starred]}{one.setting}" for one in settings)],
        ["Time", *(in_seconds(one.seconds) for one in settings)],
        ["Error (ulp)", *(short(one.worst_ulp) for one in settings)],
        ["Wrong", *(percent(one.share_wrong_regime) for one in settings)],
    ]
    if any(one.slowest for one in settings):
        slowest = (f"{in_seconds(one.longest)} {one.slowest}" * bool(one.slowest) for one in settings)
        columns.insert(2, ["Slowest family", *slowest])
    _print_columns(page, columns)


def _print_marches(page: "Page", marches: "Sequence[March]") -> None:
    from ..tradeoff.outcome import in_seconds, scientific

    def cells(one: "March | None") -> tuple[str, str, str]:
        if one is None:
            return "", "", ""
        error = f"{'*' if one.best else ' '} {scientific(one.relative_error)}"
        return error, "" if one.order is None else f"{one.order:.2f}", in_seconds(one.seconds)

    counts = list(dict.fromkeys(one.elements for one in marches))
    columns = [["Elements", *(str(count or "closed form") for count in counts)]]
    for extrapolated, head in ((False, "Error"), (True, "Extrapolated")):
        by_count = {one.elements: one for one in marches if one.extrapolated == extrapolated}
        rows = [(head, "Order", "Time"), *(cells(by_count.get(count)) for count in counts)]
        columns += map(list, zip(*rows, strict=True))
    _print_columns(page, columns)


def _print_columns(page: "Page", columns: Sequence[Sequence[str]]) -> None:
    """A table of columns with their heads, all but the first flush right."""
    first, *rest = columns
    flush = [first, *([word.rjust(max(map(len, column))) for word in column] for column in rest)]
    heads, *lines = zip(*flush, strict=True)
    page.table(heads, [lines])
