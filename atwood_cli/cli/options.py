"""Options: those of a scene, those that several commands share, and which exclude or need which."""

import inspect
import os
from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Annotated, Any

import typer

from ..files import STREAM
from ..model.quantities import NAMES, QUANTITIES
from ..model.scene import INPUTS, SceneError, parameter_of
from ..model.units import read_number, shortened
from ..output.text import say

COMPLETING = "_ATWOOD_COMPLETE"
"""The environment variable by which a shell asks how a word could go on."""
DONE, COULD_NOT, WRONG_USAGE = 0, 1, 2
"""Exit status."""

ALIASES = {"M": ["--pulley-mass"], "R": ["--radius"]}
REMARKS = {
    "m1": ', as 1.5, 1/3, 250g or "2 lb"',
    "M": "; inf locks it",
    "mu_k": "; mu if not given",
    "g": " by NASA's fact sheets, giants at 1 bar; 9.80665 if not given",
    "inertia": " (a hollow sphere); 0.5 if not given",
    "I": ", in place of inertia; needs R",
    "R": ", as 0.1 or 5cm",
    "wrap": ", in degrees, or as 1.5turn, 3rad or pi/2; 180 if not given",
    "axle": ", as 15mN or 0.4mNm",
    "a": ": finds M; beside M, a mass or gravity; of a string that slips, mu_k",
    "drop": ": gives the time and the speed",
    "time": ", with drop in place of a",
}


def flag(name: str) -> str:
    """A name as an option is typed: mu_k is --mu-k."""
    return f"--{name.replace('_', '-')}"


Words = Callable[[], Mapping[str, str]]
"""Words that a shell may complete, with what they mean."""


def option(group: str, *flags: str, metavar: str = "", words: Words | None = None, **more: Any) -> Any:
    """An option: the group in which help shows it, and the words it takes, if not those of a metavar a|b."""

    def complete(incomplete: str) -> list[tuple[str, str]]:
        return list((words() if words else dict.fromkeys(metavar.split("|"), "")).items())

    return typer.Option(
        *flags,
        metavar=metavar or None,
        rich_help_panel=group,
        show_default=False,
        # typer takes its time over every such function, so at other times there is none.
        autocompletion=complete if (words or "|" in metavar) and COMPLETING in os.environ else None,
        **more,
    )


def scene_option(name: str, group: str = "Scene", remark: str | None = None) -> Any:
    """The option of a parameter of a scene or of the motion, with a remark of a command's own."""
    parameter = parameter_of(name)
    flags = [flag(name), *ALIASES.get(name, [])]
    unit = f" ({parameter.unit})" if parameter.unit not in ("", "°") else ""
    names = f", or {', '.join(parameter.names)}" if parameter.names else ""
    meaning = f"{parameter.meaning[0].upper()}{parameter.meaning[1:]}"
    text = f"{meaning}{unit}{names}{REMARKS.get(name, '') if remark is None else remark}."
    metavar = (parameter.dimension or "number").split()[-1].upper()
    words = {**parameter.names, **({"inf": "a locked pulley"} if parameter.inf else {})}
    return option(group, *flags, help=text, metavar=metavar, words=(lambda: words) if words else None)


def takes_scene(command: Callable[..., int]) -> Callable[..., int]:
    """Give a command an option for every parameter of a scene, handed to it as ``given``."""

    def with_scene(**options: Any) -> int:
        given = {name: options.pop(name) for name in INPUTS}
        status = command(given=given, **options)
        if (wrap := given["wrap"]) and _may_be_radians(wrap):
            typed = f"--wrap {shortened(wrap)}"
            say(f"{typed} was taken for degrees; if it is in radians, write rad behind it, as 3.14rad")
        return status

    kind = inspect.Parameter.KEYWORD_ONLY
    scene = [
        inspect.Parameter(n, kind, default=None, annotation=Annotated[str | None, scene_option(n)])
        for n in INPUTS
    ]
    _, *own = inspect.signature(command).parameters.values()
    signature = inspect.Signature([*scene, *own])
    with_scene.__dict__["__signature__"] = signature
    with_scene.__annotations__ = {p.name: p.annotation for p in signature.parameters.values()}
    with_scene.__name__ = command.__name__
    return with_scene


LIKE_RADIANS = (0.3, 12.6)
"""Numbers that are few degrees, and in radians a wrap that a pulley may have, up to two turns."""


def _may_be_radians(typed: str) -> bool:
    """Whether a valid angle, or all numbers of a range or a list, have no unit and the size of radians."""
    least, most = LIKE_RADIANS
    words = typed.split(":")[:2] if ":" in typed else typed.split(",")
    angles = [read_number(word, "angle") for word in words]
    return not any(angle.unit for angle in angles) and least < max(angle.value for angle in angles) < most


def quantities() -> Mapping[str, str]:
    """The quantities that every scene has, with what they mean."""
    return {"regime": "no-slip, verge or slip", **{name: QUANTITIES[name].meaning for name in NAMES[1:]}}


# Shared by several commands

Digits = Annotated[
    str | None,
    option(
        "Output",
        metavar="N",
        help="Significant digits, 1 to 1000; if not given, 6 in tables, all of a double elsewhere.",
    ),
]
AsJson = Annotated[bool, option("Output", "--json", help="Print JSON: results, scene and notes.")]
AsCsv = Annotated[bool, option("Output", "--csv", help="Print CSV, with a line of names first.")]
Columns = Annotated[
    list[str] | None,
    option(
        "Output",
        "--only",
        metavar="NAME",
        words=quantities,
        help="A column for this quantity, not for the usual seven; repeatable, or a,b; see solve -h.",
    ),
]
Markdown = Annotated[
    bool,
    option("Output", "--markdown", help="With --explain: a page of Markdown, its mathematics in LaTeX."),
]
Plot = Annotated[
    bool, option("Output", "--plot", help="Draw it in the terminal, in place of tables (extra: plot).")
]
FigureFile = Annotated[
    str | None,
    option("Files", metavar="FILE", help="Also draw it to FILE.svg, .png or .pdf (extra: figure)."),
]
Bare = Annotated[
    bool, option("Files", "--bare", help="With --figure: draw without sentences, as for a report.")
]
M1Side = Annotated[
    str | None,
    option("Files", metavar="left|right", help="On which side the figure has m1; right if not given."),
]
OutputFile = Annotated[
    str | None,
    option(
        "Files",
        "--output",
        "-o",
        metavar="FILE",
        help="Write to FILE, whole or not at all: as CSV (.csv), JSON (.json) or as shown (.txt).",
    ),
]
SUFFIXES = ("", ".txt", ".csv", ".json")
Force = Annotated[bool, option("Files", "--force", help="Replace a file that is there.")]
Labels = Annotated[
    list[str] | None,
    option(
        "Files",
        "--label",
        metavar="COLUMN",
        help="Pass this column on as it is, though it may be meant for an input; repeatable.",
    ),
]


def form_of(options: Mapping[str, Any]) -> tuple[bool, bool]:
    """Whether to print JSON or CSV, by the options or else by the suffix of --output. Raises SceneError."""
    output, json, csv = options["output"], options["json"], options["csv"]
    if output in (None, STREAM):
        return json, csv
    figure = options["figure"]
    if figure is not None and os.path.realpath(figure) == os.path.realpath(output):
        raise SceneError("figure", figure, "is the file of --output; name another")
    if json or csv or options.get("markdown"):
        return json, csv
    suffix = os.path.splitext(output)[1].lower()
    if suffix not in SUFFIXES:
        rule = f"must end in one of {', '.join(filter(None, SUFFIXES))}, or name --json or --csv"
        raise SceneError("output", output, rule)
    return suffix == ".json", suffix == ".csv"


# Which options exclude or need which

NO_EFFECT = {
    "json": "csv",
    "plot": "json csv",
    "explain": "json csv only plot budget",
    "all": "json csv only explain",
    "budget": "csv",
    "points": "elements",
    "profile": "elements",
    "figure": "elements",
    **dict.fromkeys(("family", "scenes", "seed"), "m1 m2"),
}
"""Of all commands: an option, and those with which it has no effect."""
NEEDS = {
    "markdown": "explain",
    "extrapolate": "elements",
    "m1_side": "figure",
    "bare": "figure",
    "force": "output figure",
}
"""Of all commands: an option, and those of which it needs one."""


def check(options: Mapping[str, Any], **more: str) -> None:
    """Raises SceneError where an option that is given excludes another, or lacks one that it needs.

    ``more``: by option, others with which it has no effect in this command.
    """
    no_effect = NO_EFFECT | {name: f"{NO_EFFECT.get(name, '')} {others}" for name, others in more.items()}
    given = {name: value for name, value in options.items() if value not in (None, False, [], ())}
    for name, value in given.items():
        shown = value[0] if isinstance(value, list | tuple) else None if value is True else value
        for other in no_effect.get(name, "").split():
            if other in given:
                raise SceneError(name, shown, f"has no effect with {flag(other)}; leave one of them out")
        needed = [other for other in NEEDS.get(name, "").split() if other in options]
        if needed and not given.keys() & set(needed):
            raise SceneError(name, shown, f"needs {' or '.join(map(flag, needed))}")


def check_extras(plot: bool, figure: str | None, force: bool) -> None:
    """Raise, before anything is solved, what a picture will run into: SceneError, OSError, ImportError."""
    if plot:
        import_module("plotille")
    if figure is not None:
        from ..output.figure import check_file

        check_file(figure, force)
