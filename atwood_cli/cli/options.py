"""The options of every command: what they are called, say, take and complete; data for `cli`."""

import inspect
import os
from collections.abc import Callable, Mapping
from functools import partial
from typing import Annotated, Any

import typer

from ..model.quantities import MEASURED_NAMES, NAMES, QUANTITIES
from ..model.scene import PARAMETERS, parameter_of

COMPLETING = "_ATWOOD_COMPLETE"
"""Set where a shell asks what a word could be."""
WORDS = "words typed"
"""Where the context of a command keeps them, for completion."""

ALIASES = {"M": ["--pulley-mass"], "R": ["--radius"]}
REMARKS = {
    "m1": ', as 1.5, 250g or "2 lb"',
    "M": "; inf locks it",
    "mu_k": "; mu if not given",
    "g": " by NASA's fact sheets; 9.80665 if not given",
    "inertia": "; 0.5 if not given",
    "I": ", in place of inertia; needs R",
    "R": ", as 0.1 or 5cm",
    "wrap": ", in degrees, or as 1.5turn or 3rad; 180 if not given",
    "a": ": finds M, or beside M gravity",
    "drop": ": gives the time and the speed",
    "time": ", with drop in place of a",
}


def flag(name: str) -> str:
    return f"--{name.replace('_', '-')}"


Words = Callable[[], Mapping[str, str]]
"""Words that a shell may complete, with what they mean."""


def _option(group: str, *flags: str, metavar: str = "", words: Words | None = None, **more: Any) -> Any:
    """An option: the group in which help shows it, and the words it takes.

    Where the metavar lists alternatives (a|b), they are the words.
    """
    if "|" in metavar:
        words = partial(_alternatives, metavar)

    def complete(ctx: typer.Context, incomplete: str) -> list[tuple[str, str]]:
        # FILE NAME: the first is no word, and a shell without words completes files.
        if " " in metavar and ctx.meta[WORDS][-1:] in [[one] for one in flags]:
            return []
        return list(words().items()) if words else []

    return typer.Option(
        *flags,
        metavar=metavar or None,
        rich_help_panel=group,
        show_default=False,
        # typer takes its time over every such function, so at other times there is none.
        autocompletion=complete if words and COMPLETING in os.environ else None,
        **more,
    )


def _alternatives(metavar: str) -> Mapping[str, str]:
    return dict.fromkeys(metavar.split("|"), "")


def _scene_option(name: str, group: str = "Scene") -> Any:
    parameter = parameter_of(name)
    flags = [flag(name), *ALIASES.get(name, [])]
    unit = f" ({parameter.unit})" if parameter.unit not in ("", "°") else ""
    names = f", or {', '.join(parameter.names)}" if parameter.names else ""
    meaning = f"{parameter.meaning[0].upper()}{parameter.meaning[1:]}"
    text = f"{meaning}{unit}{names}{REMARKS.get(name, '')}."
    metavar = (parameter.dimension or "number").upper()
    words = {**parameter.names, **({"inf": "a locked pulley"} if parameter.inf else {})}
    return _option(group, *flags, help=text, metavar=metavar, words=(lambda: words) if words else None)


def takes_scene(command: Callable[..., int]) -> Callable[..., int]:
    """Give a command an option for every parameter of a scene, handed to it as ``given``."""

    def with_scene(**options: Any) -> int:
        given = {name: options.pop(name) for name in PARAMETERS}
        return command(given=given, **options)

    kind = inspect.Parameter.KEYWORD_ONLY
    scene = [
        inspect.Parameter(n, kind, default=None, annotation=Annotated[str | None, _scene_option(n)])
        for n in PARAMETERS
    ]
    _, *own = inspect.signature(command).parameters.values()
    signature = inspect.Signature([*scene, *own])
    with_scene.__dict__["__signature__"] = signature
    with_scene.__annotations__ = {p.name: p.annotation for p in signature.parameters.values()}
    with_scene.__name__, with_scene.__doc__ = command.__name__, command.__doc__
    return with_scene


_output, _files = partial(_option, "Output"), partial(_option, "Files")
_arc, _measured = partial(_option, "Arc"), partial(_option, "Measurement")


def _quantities() -> Mapping[str, str]:
    return {"regime": "no-slip, verge or slip", **_numbers()}


def _answers() -> Mapping[str, str]:
    return {**_quantities(), **dict.fromkeys(MEASURED_NAMES, "found from what was measured")}


def _numbers() -> Mapping[str, str]:
    return {name: QUANTITIES[name].meaning for name in NAMES[1:]}


def _families() -> Mapping[str, str]:
    from ..tradeoff.scenes import FAMILIES

    return {name: family.meaning for name, family in FAMILIES.items()}


Digits = Annotated[
    str | None, _output(metavar="N", help="Significant digits, 1 to 1000 (otherwise doubles).")
]
AsJson = Annotated[bool, _output("--json", help="Print JSON: results, scene and notes.")]
AsCsv = Annotated[bool, _output("--csv", help="Print CSV, with a line of names first.")]
Only = Annotated[
    list[str] | None,
    _output(metavar="NAME", words=_answers, help="Print only this quantity; repeatable."),
]
Budget = Annotated[
    bool,
    _output("--budget", help="Also print each uncertain input's share of every result's variance."),
]

A = Annotated[str | None, _scene_option("a", "Measured")]
Drop = Annotated[str | None, _scene_option("drop", "Measured")]
Time = Annotated[str | None, _scene_option("time", "Measured")]
Explain = Annotated[
    bool, _output("--explain", help="Instead, show how it follows: step by step, with the numbers put in.")
]
Markdown = Annotated[
    bool, _output("--markdown", help="With --explain: a page of Markdown, its mathematics in LaTeX.")
]


DEFAULT_POINTS = 13
Points = Annotated[
    str | None,
    _arc(metavar="N", help=f"Angles along the arc to show, with both ends; {DEFAULT_POINTS} if not given."),
]
Profile = Annotated[
    str | None,
    _arc(
        metavar="creep|least",
        help="Which tension, where friction to spare leaves it open: that of a slightly elastic string"
        " (creep, if not given), or that with the least net friction.",
    ),
]
Elements = Annotated[
    str | None,
    _arc(
        metavar="N",
        help="Instead, solve the arc by N elements of string, in doubles, beside the exact values.",
    ),
]
Extrapolate = Annotated[bool, _arc("--extrapolate", help="Extrapolate from N/2 and N elements (Richardson).")]


FigureFile = Annotated[
    str | None, _files(metavar="FILE", help="Also draw it to FILE.svg, .png or .pdf (extra: figure).")
]

Columns = Annotated[
    list[str] | None,
    _output(
        "--only",
        metavar="NAME",
        words=_quantities,
        help="A column for this quantity, not for the usual seven; repeatable.",
    ),
]
Plot = Annotated[
    str | None,
    _output(
        metavar="NAME", words=_numbers, help="Draw this quantity's curve in place of the table (extra: plot)."
    ),
]
SweepFigure = Annotated[
    tuple[str, str] | None,
    _files(
        "--figure",
        metavar="FILE NAME",
        words=_numbers,
        help="Also draw this quantity's curve to FILE.svg, .png or .pdf (extra: figure).",
    ),
]
OutputFile = Annotated[
    str | None,
    _files(
        "--output",
        "-o",
        metavar="FILE",
        help="Write to FILE, whole or not at all: as CSV (.csv), JSON (.json) or as shown (.txt).",
    ),
]
SWEEP_SUFFIXES = ("", ".txt", ".csv", ".json")
Force = Annotated[bool, _files("--force", help="Replace a file that is there.")]


Table = Annotated[
    str,
    typer.Argument(
        metavar="IN",
        rich_help_panel="Files",
        help="Table of scenes: .csv, .tsv, .ndjson, .jsonl or .parquet; - for stdin.",
        show_default=False,
    ),
]
OutTable = Annotated[
    str, _files("--output", "-o", metavar="OUT", help="Write to this file; - for stdout, if not given.")
]
FromFormat = Annotated[
    str | None,
    _files("--from", metavar="csv|tsv|ndjson|parquet", help="Format of IN, if not that of its suffix."),
]
ToFormat = Annotated[
    str | None,
    _files(
        "--to",
        metavar="csv|tsv|ndjson|parquet",
        help="Format of OUT, if not that of its suffix; stdout: csv.",
    ),
]
Accuracy = Annotated[
    str,
    _output(
        metavar="fast|certified|exact",
        help="How accurate results are; certified, within 4 units in the last place, if not given.",
    ),
]
AllowErrors = Annotated[bool, _output("--allow-errors", help="Exit 0 though rows have errors.")]


Families = Annotated[
    list[str] | None,
    _measured(
        "--family", metavar="NAME", words=_families, help="Measure this family of scenes only; repeatable."
    ),
]
DEFAULT_SCENES, DEFAULT_SEED, MOST_SEED = 500, 1, 10**9
Scenes = Annotated[
    str | None,
    _measured(metavar="N", help=f"Scenes of each family whose errors count; {DEFAULT_SCENES} if not given."),
]
Seed = Annotated[
    str | None,
    _measured(metavar="N", help=f"Seed from which the scenes are drawn; {DEFAULT_SEED} if not given."),
]
PlotErrors = Annotated[
    bool, _output("--plot", help="Draw error against time in place of the tables (extra: plot).")
]
