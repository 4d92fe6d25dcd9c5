"""The options of a scene, other options that several commands share, and help on all."""

import inspect
import os
import sys
from collections.abc import Callable, Mapping
from itertools import chain
from operator import attrgetter
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, get_args

import typer

from ..output.files import STDOUT, check_free, printable
from ..output.forms import FORMS, Destination, Picture
from ..output.text import say
from ..reading.units import MAX_DIGITS
from ..solver.quantities import NAMES, QUANTITIES
from ..solver.scene import FALL as FALLS
from ..solver.scene import INPUTS, MEASURED, SceneError, parameter_of

if TYPE_CHECKING:
    from ..tables.sources import Unreadable

COMPLETING = "_ATWOOD_COMPLETE"
"""The environment variable by which a shell asks for completions of a word."""
DONE, COULD_NOT, WRONG_USAGE = 0, 1, 2
"""The exit statuses of commands."""

ALIASES = {"M": ["--pulley-mass"], "R": ["--radius"]}
REMARKS = {
    "m1": ", 80g+4*5g, 20N",
    "M": "; inf locks it",
    "mu_k": "; mu if not given",
    "g": ", or a planet, moon or pluto; 9.80665 if not given",
    "inertia": ", or disk, cylinder, hoop, ring, sphere, shell; 0.5 if not given",
    "I": ", instead of inertia, or the radius of gyration, 18cm; needs R",
    "wrap": ": degrees, 3rad, pi/2, 2.5turn; 180 if none",
    "axle": ", 15mN, or a torque, 0.4mNm (needs R)",
    "a": ", 0.3g, 5rad/s2: finds M, or a mass, g, mu_k",
    "drop": ": two of drop, time, speed stand for a, one gives the others",
    "speed": ", or 20rad/s, 20rpm",
}


def flag(name: str, value: str = "") -> str:
    """Return an option as it is typed: mu_k is --mu-k. An argument is typed without a name."""
    return name if name == "NAME" else f"--{name.rstrip('_').replace('_', '-')} {value}".rstrip()


def option(group: str, *flags: str, words: Callable[[], Mapping[str, str]] | None = None, **more: Any) -> Any:
    """Return an option, with the ``group`` in which help shows it.

    ``words`` returns the words that a shell may complete, with their meanings.
    """

    def complete(incomplete: str) -> list[tuple[str, str]]:
        return list(words().items()) if words else []

    # typer takes long over such a function, so there is none unless a word is to be completed.
    completion = complete if words and COMPLETING in os.environ else None
    return typer.Option(*flags, rich_help_panel=group, show_default=False, autocompletion=completion, **more)


def argument(group: str, metavar: str, text: str) -> Any:
    """Return an argument, with the ``group`` in which help shows it."""
    return typer.Argument(metavar=metavar, rich_help_panel=group, help=text, show_default=False)


def scene_option(name: str, remark: str | None = None) -> Any:
    """Return the option for an input of a scene or a motion, with a remark that a command may replace."""
    parameter = parameter_of(name)
    flags = [flag(name), *ALIASES.get(name, [])]
    unit = f" ({parameter.unit})" if parameter.unit not in ("", "°") else ""
    meaning = f"{parameter.meaning[0].upper()}{parameter.meaning[1:]}"
    text = f"{meaning}{unit}{REMARKS.get(name, '') if remark is None else remark}."
    metavar = (parameter.dimension or "number").split()[-1].upper()
    group = "Scene" if name in INPUTS else "Measured"
    return option(group, *flags, help=text, metavar=metavar, words=lambda: parameter.names)


Command = Callable[..., int]
FORM_NAMES = " ".join(FORMS)
FOR_PROGRAMS = " ".join(name for name, form in FORMS.items() if not form.is_page)
NO_EFFECT = {
    **dict.fromkeys(FORMS, FORM_NAMES),
    "explain": f"{FOR_PROGRAMS} budget",
    "all_": f"{FOR_PROGRAMS} only explain",
}
"""By option, the others that cannot be used with it, in any command."""
NEEDS = {"bare": "figure", "symbols": "figure", "force": "output figure"}
"""By option, the others of which it needs one, if the command has them."""


SCENE, MOTION = (
    {name: Annotated[str | None, scene_option(name)] for name in names} for names in (INPUTS, MEASURED)
)
"""The options of a scene, and of what is measured of its motion, by name."""


FALL = {name: MOTION[name] for name in FALLS}
"""The options of a fall from rest, one of which gives the others."""


def with_options(*groups: Mapping[str, Any]) -> Callable[[Command], Command]:
    """Give a command groups of options by name, which typer sees one by one.

    The command gets those that `READERS` read as one parameter, as ``target``, and others as ``given``.
    """

    def taking(command: Command) -> Command:
        parameters = inspect.signature(command).parameters.values()
        own = [parameter for parameter in parameters if parameter.name not in ("given", *READERS)]
        taken = {parameter.name for parameter in parameters}

        def run(**options: Any) -> int:
            _check(options)
            arguments = {parameter.name: options[parameter.name] for parameter in own}
            if "given" in taken:
                names = (name for group in groups for name in group if name not in {*OUTPUT, *FIGURE, *TABLE})
                arguments["given"] = {name: options[name] for name in names}
            return command(**arguments, **{x: read(options) for x, read in READERS.items() if x in taken})

        first, *others = ([_parameter(*named) for named in group.items()] for group in groups)
        seen = sorted([*first, *own, *chain(*others)], key=attrgetter("kind"))
        # typer reads this attribute, which type checkers do not know of a function.
        run.__dict__["__signature__"] = inspect.Signature(seen)
        run.__annotations__ = {parameter.name: parameter.annotation for parameter in seen}
        run.__name__ = command.__name__
        return run

    return taking


def _parameter(name: str, annotation: Any) -> inspect.Parameter:
    default = False if get_args(annotation)[0] is bool else None
    return inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=annotation)


def _check(options: Mapping[str, Any]) -> None:
    """Raise SceneError if an option that is given excludes another, or lacks one that it needs."""
    given = [name for name, value in options.items() if value not in (None, False, [], ())]
    for name in given:
        for other in NO_EFFECT.get(name, "").split():
            if other in given and other != name:
                raise SceneError(name, None, f"cannot be used with {flag(other)}; leave one out")
        needed = [other for other in NEEDS.get(name, "").split() if other in options]
        if needed and not {*given}.intersection(needed):
            raise SceneError(name, None, f"needs {' or '.join(map(flag, needed))}")


def quantity_meanings() -> Mapping[str, str]:
    """Return the quantities that every scene has, with their meanings."""
    return {"regime": "no-slip, verge or slip", **{name: QUANTITIES[name].meaning for name in NAMES[1:]}}


# Options of several commands

Digits = Annotated[
    str | None,
    option("Output", metavar="N", help=f"Significant digits, to {MAX_DIGITS}; 6 in tables, else doubles."),
]
Columns = Annotated[
    list[str] | None,
    option(
        "Output",
        "--only",
        metavar="NAME",
        words=quantity_meanings,
        help="A column for this quantity, in place of the usual seven; repeatable, or a,b.",
    ),
]
FIGURE: dict[str, Any] = {
    "figure": Annotated[
        str | None,
        option("Files", metavar="FILE", help="Draw a picture: .svg, .png or .pdf (extra: figure)."),
    ],
    "bare": Annotated[bool, option("Files", "--bare", help="With --figure: no title, as for a report.")],
    "symbols": Annotated[
        bool, option("Files", "--symbols", help="With --figure: symbols without their values, to fill in.")
    ],
}
Expect = Annotated[
    list[str] | None,
    option("Output", metavar="CONDITION", help="Exit 1 unless it holds: no-slip, 'a < 0.3g'; repeatable."),
]
TABLE: dict[str, Any] = {
    "columns": Annotated[
        str | None,
        option("Files", metavar="WORDS", help="What each column is, as m1:g,m2:g,-,t,t; '?' asks."),
    ],
    "column": Annotated[
        list[str] | None,
        option("Files", metavar="NAME=HEADING", help="Say what a column is, as m1='Mass 1 (g)'; repeatable."),
    ],
    "label": Annotated[
        list[str] | None,
        option("Files", metavar="COLUMN", help="Do not read this column; repeatable, or a,b."),
    ],
    "sheet": Annotated[
        str | None, option("Files", metavar="NAME", help="Sheet of a workbook, if not the first.")
    ],
}
"""What the columns of a table are, and where in a workbook it is."""
Layout = tuple[str, list[str], list[str], str | None]
"""The values of these."""


def refuse(context: typer.Context, source: str, why: "Unreadable") -> int:
    """Say why a table cannot be read, and, if it is not understood, list its columns and what to type."""
    from ..tables.places import NotUnderstood
    from ..tables.sources import cannot_read

    say(str(cannot_read(source, why)))
    if isinstance(why, NotUnderstood):
        lines = why.listing([*context.command_path.split(), *context.obj])
        print(*map(printable, lines), sep="\n", file=sys.stderr)
    return COULD_NOT


# Where results go, and in which form


Force = Annotated[bool, option("Files", "--force", help="Replace an existing file.")]


def results(*forms: str) -> dict[str, Any]:
    """Return the options that choose the form of a result among these, and the file that it goes to."""
    text = f"Write to FILE, by its suffix: {', '.join(FORMS[form].suffix for form in forms)}, .txt."
    return {
        **{form: Annotated[bool, option("Output", flag(form), help=FORMS[form].help)] for form in forms},
        "output": Annotated[str | None, option("Files", "--output", "-o", metavar="FILE", help=text)],
        "force": Force,
    }


def _read_target(options: Mapping[str, Any]) -> Destination:
    """Read the form and the file of a result. Raises SceneError, FileExistsError."""
    asked = next((form for form in FORMS if options.get(form)), "")
    file, force = options["output"], options["force"]
    if file in (None, STDOUT):
        return Destination(asked, None, force)
    form = _form_of_file(file, asked, options)
    check_free(Path(file), force)
    return Destination(form, file, force)


def _form_of_file(file: str, asked: str, options: Mapping[str, Any]) -> str:
    """Return the form of a file, as asked for or by its suffix. Raises SceneError if the two disagree."""
    if asked:
        forms = {FORMS[asked].suffix: asked}
    else:
        known = [x for x in FORMS if x in options and (FORMS[x].is_page or not options.get("explain"))]
        forms = {".txt": "", **{FORMS[form].suffix: form for form in known}}
    suffix, way = os.path.splitext(file)[1].lower(), ""
    if suffix and suffix not in forms:
        if suffix in PANDOC and "markdown" in options:
            import shlex

            md = shlex.quote(f"{os.path.splitext(file)[0]}.md")
            way = f"; write {md} by --markdown, then run pandoc {md} -o {shlex.quote(file)}"
        raise SceneError("output", file, f"must end in {' or '.join(forms)}{way}")
    return forms.get(suffix, asked)


OUTPUT = results(*FORMS)
PANDOC = (".docx", ".html", ".odt", ".pdf", ".rtf", ".tex")
"""Files that pandoc writes of Markdown."""


def _read_picture(options: Mapping[str, Any]) -> Picture | None:
    """Read what is asked of a picture, None if it is not. Raises SceneError, OSError, ImportError."""
    if options["figure"] is None:
        return None
    from ..output.figure import check_picture

    picture = Picture(*(options[name] for name in ("figure", "force", "bare", "symbols")))
    check_picture(picture)
    return picture


READERS: Mapping[str, Callable[[Mapping[str, Any]], Any]] = {
    "target": _read_target,
    "picture": _read_picture,
    "layout": lambda x: (x["columns"] or "", x["column"] or [], x["label"] or [], x["sheet"]),
}
"""By the parameter of a command, what reads its value of several options."""

# Help

BRIEF_COMMANDS = ("sweep", "contact", "batch")
"""The commands whose help only names the options of a scene, which the help of solve explains."""
LAST_GROUPS = ("Output", "Files")
"""The groups of options that come after a command's own groups."""


def write_options(command: Any, context: Any, formatter: Any) -> None:
    """Write the help on the options of a command by group, with typer's formatter."""
    groups: dict[str, list[tuple[str, str]]] = {}
    for param in command.get_params(context):
        record = param.get_help_record(context)
        if param.param_type_name == "argument":
            record = (param.metavar, record[1])  # typer 0.29 adds its type
        groups.setdefault(getattr(param, "rich_help_panel", None) or "Output", []).append(record)
    for panel in sorted(groups, key=lambda panel: LAST_GROUPS.index(panel) if panel in LAST_GROUPS else -1):
        with formatter.section(panel):
            if panel in ("Scene", "Measured") and command.name in BRIEF_COMMANDS:
                names = " ".join(param.opts[0] for param in command.params if param.rich_help_panel == panel)
                formatter.write_text(f"{names}, as in atwood solve -h")
            else:
                formatter.write_dl(groups[panel], col_max=25)
