"""`atwood tradeoff`: time beside error on this machine, on one screen or in full, or drawn."""

import sys
from collections.abc import Mapping, Sequence
from itertools import groupby
from operator import attrgetter
from typing import TYPE_CHECKING, Annotated

from ..model.scene import Scene, SceneError, read_whole
from ..output.text import Forms, describe, for_stream, say, scene_record, show
from .options import (
    DONE,
    AsCsv,
    AsJson,
    FigureFile,
    Force,
    check,
    check_extras,
    option,
    read_names,
    takes_scene,
)

if TYPE_CHECKING:
    from ..output.page import Page
    from ..tradeoff.measure import March, Measured
    from ..tradeoff.outcome import Tradeoff


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
    force: Force = False,
    json: AsJson = False,
    csv: AsCsv = False,
) -> int:
    check({**locals(), **given})
    if given["axle"] is not None:
        why = "is not measured, as arrays have no such column; leave it out"
        raise SceneError("axle", given["axle"], why)
    from ..output.page import watched
    from ..solver.elements import MAX_ELEMENTS
    from ..tradeoff.measure import COUNTS, MOST_SCENES, USUAL_ELEMENTS
    from ..tradeoff.outcome import tradeoff as measure
    from ..tradeoff.scenes import FAMILIES

    scene = Scene.read(given) if any(value is not None for value in given.values()) else None
    families = list(dict.fromkeys(read_names("family", family or FAMILIES, FAMILIES, "family of scenes")))
    check_extras(None, figure, force)
    count = read_whole("scenes", scenes or DEFAULT_SCENES, 1, MOST_SCENES)
    start = read_whole("seed", seed or DEFAULT_SEED, 0, MOST_SEED)
    most = read_whole("elements", elements or USUAL_ELEMENTS, COUNTS[0], MAX_ELEMENTS)
    outcome = measure(families, count, start, scene, most, watched)
    if figure is not None:
        from ..output.tradeoff_figure import save

        save(outcome, figure, force)
    say(*show(_forms(outcome, all), json, csv))
    return DONE


def _forms(outcome: "Tradeoff", everything: bool) -> Forms:
    def page() -> None:
        if everything:
            _print_all(outcome)
        else:
            from ..output.page import Page

            print_front(outcome, Page())

    return Forms(
        json=lambda: _record(outcome),
        records=lambda: _records(outcome),
        page=page,
        notes=lambda: [*outcome.notes, outcome.advice],
    )


def _record(outcome: "Tradeoff") -> dict[str, object]:
    """For JSON: what was measured, the seed or the scene, the notes and the advice."""
    about: dict[str, object] = {"scene": scene_record(outcome.scene)}
    if outcome.seed is not None:
        about = {"seed": outcome.seed, "scenes": outcome.scenes}
    arithmetic = [one._asdict() for one in outcome.measured]
    elements = [one._asdict() for one in outcome.marches]
    return about | {
        "arithmetic": arithmetic,
        "elements": elements,
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
    from ..tradeoff.outcome import elements_in_words, front_legend, in_seconds, percent, short

    settings = outcome.front
    page.say(f"Settings that no other beats (--all shows the rest): {_measured_on(outcome)}")
    columns = {
        "Setting": [one.setting for one in settings],
        "Time": [in_seconds(one.seconds) for one in settings],
        "Slowest family": [
            f"{in_seconds(one.longest)} {one.slowest}" if one.slowest else "" for one in settings
        ],
        "Error (ulp)": [short(one.worst_ulp) for one in settings],
        "Wrong": [percent(one.share_wrong_regime) for one in settings],
    }
    if not any(one.slowest for one in settings):
        del columns["Slowest family"]
    _print_columns(page, list(columns), list(columns.values()))
    page.say(outcome.advice, style="bold")
    page.say(front_legend(len(outcome.families)))
    page.say(*outcome.notes or [elements_in_words(outcome.marches)])


def _measured_on(outcome: "Tradeoff") -> str:
    """The scene, or the families and how many scenes there are of each."""
    if outcome.seed is None:
        return f"scene: {describe(outcome.scene)}"
    each = "scenes each of" if len(outcome.families) > 1 else "scenes,"
    return f"{outcome.scenes} {each} {', '.join(outcome.families)} (seed {outcome.seed})"


def _print_all(outcome: "Tradeoff") -> None:
    """A table of the settings for each family of scenes, one of string elements, and what follows."""
    from ..output.page import Page
    from ..tradeoff.outcome import ELEMENTS_LEGEND, LEGEND
    from ..tradeoff.scenes import FAMILIES

    page = Page()
    for family, settings in groupby(outcome.measured, attrgetter("family")):
        meaning = FAMILIES[family].meaning if family in FAMILIES else describe(outcome.scene)
        page.say(f"{family}: {meaning}", style="bold")
        _print_measured(page, list(settings))
    page.say(LEGEND)
    if outcome.marches:
        page.say(f"String elements: e^(μφ) of {describe(outcome.scene)}", style="bold")
        _print_marches(page, outcome.marches)
        page.say(ELEMENTS_LEGEND)
    page.say(*outcome.notes)
    page.say(outcome.advice, style="bold")


def _print_measured(page: "Page", settings: "Sequence[Measured]") -> None:
    from ..tradeoff.outcome import in_seconds, percent, short

    columns = {
        "  Setting": [f"{'*' if one.best else ' '} {one.setting}" for one in settings],
        "Time": [in_seconds(one.seconds) for one in settings],
        "±": [percent(one.spread) for one in settings],
        "Worst": [short(one.worst_ulp) for one in settings],
        "99 %": [short(one.percentile_99_ulp) for one in settings],
        "Over 4": [percent(one.share_over_4_ulp) for one in settings],
        "Regime": [percent(one.share_wrong_regime) for one in settings],
    }
    _print_columns(page, list(columns), list(columns.values()))


def _print_marches(page: "Page", marches: "Sequence[March]") -> None:
    from ..tradeoff.outcome import in_seconds, scientific

    by_count: dict[int | None, dict[bool, March]] = {}
    for one in marches:
        by_count.setdefault(one.elements, {})[one.extrapolated] = one
    columns = [[str(count or "closed form") for count in by_count]]
    for extrapolated in (False, True):
        ones = [both.get(extrapolated) for both in by_count.values()]
        columns += [
            [f"{'*' if one.best else ' '} {scientific(one.relative_error)}" if one else "" for one in ones],
            [f"{one.order:.2f}" if one and one.order is not None else "" for one in ones],
            [in_seconds(one.seconds) if one else "" for one in ones],
        ]
    heads = ["Elements", "Error", "Order", "Time", "Extrapolated", "Order", "Time"]
    _print_columns(page, heads, columns)


def _print_columns(page: "Page", heads: Sequence[str], columns: Sequence[Sequence[str]]) -> None:
    """A table whose columns but the first are flush right."""
    words = [
        [for_stream(word, sys.stdout) for word in column]
        for column in ([head, *rows] for head, rows in zip(heads, columns, strict=True))
    ]
    flush = [words[0], *([word.rjust(max(map(len, column))) for word in column] for column in words[1:])]
    lines = list(zip(*flush, strict=True))
    page.table(lines[0], [lines[1:]])
