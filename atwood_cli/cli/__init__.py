"""The command line: each command parses, calls one function, hands the result to `output`."""

import io
import os
import sys
from collections import Counter
from collections.abc import Mapping, Sequence
from contextlib import suppress
from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup

from .. import __version__
from ..model.quantities import MEASURED_NAMES, NAMES
from ..model.scene import Scene, SceneError, read_digits, read_whole
from ..model.units import nearest
from .options import (
    COMPLETING,
    DEFAULT_POINTS,
    DEFAULT_SCENES,
    DEFAULT_SEED,
    MOST_SEED,
    SWEEP_SUFFIXES,
    WORDS,
    A,
    Accuracy,
    AllowErrors,
    AsCsv,
    AsJson,
    Budget,
    Columns,
    Digits,
    Drop,
    Elements,
    Explain,
    Extrapolate,
    Families,
    FigureFile,
    Force,
    FromFormat,
    Markdown,
    Only,
    OutputFile,
    OutTable,
    Plot,
    PlotErrors,
    Points,
    Profile,
    Scenes,
    Seed,
    SweepFigure,
    Table,
    Time,
    ToFormat,
    flag,
    takes_scene,
)
from .page import for_stream

DONE, COULD_NOT, WRONG_USAGE = 0, 1, 2
EXTRAS = {"matplotlib": "figure", "plotille": "plot", "polars": "batch"}

# The parent of all of typer's complaints about usage; typer exports only this child of it.
UsageError: Any = typer.BadParameter.__mro__[1]


class Command(TyperCommand):
    """A command with our help, that refuses a scalar option given twice, rather than take the last."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        ctx.meta[WORDS] = list(args)
        if ctx.resilient_parsing:  # to complete what is typed so far
            return super().parse_args(ctx, args)
        _, _, order = self.make_parser(ctx).parse_args(args=list(args))
        for option, times in Counter(order).items():
            if times > 1 and not (getattr(option, "multiple", 0) or getattr(option, "is_flag", 0)):
                raise SceneError(str(option.name), None, f"is given {times} times; give it once")
        return super().parse_args(ctx, args)

    def format_help(self, ctx: Any, formatter: Any) -> None:
        from .help import page

        formatter.write(page(self, ctx))


class Group(TyperGroup):
    """The commands, with our help."""

    format_help = Command.format_help


app = typer.Typer(
    name="atwood",
    cls=Group,
    help="""Atwood's machine with a massive pulley and a rough string, every digit right.

    Examples:
      atwood solve --m1 1 --m2 3 --mu 0.3
      atwood solve --m1 250g --m2 300g --M 100g --only acceleration
      atwood sweep --m1 1 --m2 3 --M 0:50:6 --mu 0.3
      atwood contact --m1 1 --m2 3 --M 10 --mu 0.3
      atwood batch scenes.csv -o results.csv
      atwood tradeoff
    """,
    invoke_without_command=True,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _print_version(wanted: bool) -> None:
    if wanted:
        print(f"atwood {__version__}")
        raise typer.Exit


Version = Annotated[
    bool,
    typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version."),
]


@app.callback()
def root(context: typer.Context, version: Version = False) -> None:
    if context.invoked_subcommand is None:
        from .help import brief

        print(brief(context.command, context))


@app.command("solve", cls=Command)
@takes_scene
def solve(
    given: Mapping[str, str | None],
    *,
    a: A = None,
    drop: Drop = None,
    time: Time = None,
    digits: Digits = None,
    json: AsJson = False,
    csv: AsCsv = False,
    only: Only = None,
    budget: Budget = False,
    explain: Explain = False,
    markdown: Markdown = False,
) -> int:
    """Solve one scene: acceleration, tensions, friction, critical masses.

    Examples:
      atwood solve --m1 1 --m2 3 --mu 0.3
      atwood solve --m1 250g --m2 300g --M 100g --R 5cm --digits 6
      atwood solve --m1 1 --m2 3 --M 100 --mu 0.3 --mu-k 0.25 --json
      atwood solve --m1 1 --m2 3 --M 10 --only acceleration --only mu_verge
      atwood solve --m1 '1.000(2)' --m2 3+/-0.01 --M 10 --budget
      atwood solve --m1 55g --m2 60g --R 5cm --a 0.380+/-0.004
      atwood solve --m1 55g --m2 60g --drop 80cm --time '2.05(2)'
      atwood solve --m1 1 --m2 3 --mu 0.3 --explain

    Any number may have its standard uncertainty, as 1.000+/-0.002 or, in quotes for the shell, '1.000(2)'.
    Results then have theirs, to first order, and a table ends each value at the second digit of it,
    whatever --digits.
    """
    from ..solver.answers import read_answers
    from ..solver.messages import reasons
    from . import page as output

    _exclude_each_other(json, csv)
    names = only or []
    _check_names("only", *names, known=(*NAMES, *MEASURED_NAMES))
    measured = {"a": a, "drop": drop, "time": time}
    refused = {"--json": json, "--csv": csv, "--only": names, "--budget": budget}
    _check_explain(explain, markdown, refused | {flag(name): value for name, value in measured.items()})
    answers, uncertain = read_answers({**given, **measured}, read_digits(digits))
    bare = bool(names) and not (json or csv)
    if explain:
        if uncertain:
            raise SceneError("explain", None, "shows exact numbers; leave their uncertainties out")
        output.print_explanation(answers, markdown)
        return DONE
    if budget and not uncertain:
        raise SceneError("budget", None, "needs an input with its uncertainty, like --m1 '1.000(2)'")
    if budget and (csv or bare):
        raise SceneError("budget", None, f"has no place in {'CSV' if csv else 'bare values'}; take --json")
    found = None
    if uncertain:
        from ..solver.uncertainty import propagate

        found = propagate(answers.case, uncertain, [] if bare else names or answers.names)
    if json:
        output.print_json(answers, names, found, budget)
    elif csv:
        output.print_csv(answers, names, found)
    elif names:
        output.print_only(answers, names)
    else:
        output.print_table(answers, found=found, budget=budget)
        return DONE
    if csv or names:
        for reason in [*reasons(answers), *(found.notes if found else [])]:
            _say(reason)
    return COULD_NOT if bare and not all(output.cell(answers[name]) for name in names) else DONE


@app.command("contact", cls=Command)
@takes_scene
def contact(
    given: Mapping[str, str | None],
    *,
    points: Points = None,
    profile: Profile = None,
    elements: Elements = None,
    extrapolate: Extrapolate = False,
    figure: FigureFile = None,
    force: Force = False,
    digits: Digits = None,
    json: AsJson = False,
    csv: AsCsv = False,
) -> int:
    """Show what acts along the arc of contact, and that it adds up.

    Examples:
      atwood contact --m1 1 --m2 3 --mu 0.3 --digits 6
      atwood contact --m1 1 --m2 3 --M 10 --mu 0.3 --profile least
      atwood contact --m1 1 --m2 3 --mu 0.3 --elements 1000 --extrapolate
      atwood contact --m1 1 --m2 200 --M inf --mu 0.2 --wrap 2.5turn --csv
    """
    from ..solver.answers import Answers
    from ..solver.contact import contact as solve_contact
    from . import page as output

    _exclude_each_other(json, csv)
    _check_force(force, figure=figure)
    answers = Answers(Scene.read(given), read_digits(digits))
    if elements is not None:
        from ..solver.elements import elements as march_elements

        for name, value in (("points", points), ("profile", profile), ("figure", figure)):
            if value is not None:
                raise SceneError(name, value, "has no say beside --elements; leave one of them out")
        found = march_elements(answers, elements, extrapolate)
        if json:
            output.print_elements_json(answers, found)
        elif csv:
            output.print_records_csv([row._asdict() for row in found.rows])
            for note in found.notes:
                _say(note)
        else:
            output.print_elements(answers, found)
        return DONE
    if extrapolate:
        raise SceneError("extrapolate", None, "needs --elements")
    arc = solve_contact(answers, points or DEFAULT_POINTS, profile)
    if figure is not None:
        from .figure import save

        save(answers, profile, figure, force)
    if json:
        output.print_arc_json(answers, arc)
    elif csv:
        output.print_records_csv(arc.points)
        for note in arc.notes:
            _say(note)
    else:
        output.print_arc(answers, arc)
    return DONE


@app.command("sweep", cls=Command)
@takes_scene
def sweep(
    given: Mapping[str, str | None],
    *,
    plot: Plot = None,
    figure: SweepFigure = None,
    output: OutputFile = None,
    force: Force = False,
    digits: Digits = None,
    json: AsJson = False,
    csv: AsCsv = False,
    only: Columns = None,
) -> int:
    """Solve a range of scenes: one or two options carry start:stop:count or start:stop:count:log.

    Examples:
      atwood sweep --m1 1 --m2 3 --M 0:50:6 --mu 0.3 --digits 6
      atwood sweep --m1 1 --m2 3 --M 1:1000:4:log --mu 0.2:0.4:3 --only regime
      atwood sweep --m1 100g:500g:5 --m2 300g --M 50g --csv
      atwood sweep --m1 1 --m2 3 --M 0:60:61 --mu 0.3 --plot acceleration
      atwood sweep --m1 1 --m2 3 --M 0:60:61 --figure a.svg mu_verge -o a.csv
    """
    from ..files import STREAM, stdout_into
    from ..model.quantities import STANDARD
    from ..solver.sweep import check_drawable, picture, read_sweep, solve_rows
    from . import page as out

    _exclude_each_other(json, csv)
    _check_force(force, output=output, figure=figure)
    into_file = output not in (None, STREAM)
    if output is not None and into_file and not (json or csv):
        suffix = os.path.splitext(output)[1].lower()
        if suffix not in SWEEP_SUFFIXES:
            rule = f"must end in one of {', '.join(filter(None, SWEEP_SUFFIXES))}, or name --json or --csv"
            raise SceneError("output", output, rule)
        json, csv = suffix == ".json", suffix == ".csv"
    names = list(dict.fromkeys(only or STANDARD))
    _check_names("only", *names)
    found, precision = read_sweep(given), read_digits(digits)
    drawn = {"plot": plot, "figure": figure and figure[1]}
    for option, name in drawn.items():
        if name is not None:
            _check_names(option, name)
            check_drawable(found, option, name)
    if plot is not None:
        if json or csv:
            raise SceneError(
                "plot", plot, f"draws text, not {'JSON' if json else 'CSV'}; leave one of them out"
            )
        if only:
            raise SceneError("only", only[0], "has no say beside --plot; leave one of them out")
        from .plot import print_plot

        names = [plot]
    if figure is not None:
        from .figure import check_file, save_sweep

        check_file(figure[0], force)
    wanted = dict.fromkeys([*names, *(name for name in drawn.values() if name)])
    with stdout_into(output, force):
        rows = list(out.watched(solve_rows(found, list(wanted), precision), found.total))
        if figure is not None:
            save_sweep(picture(found, rows, "figure", figure[1]), out.sweep_head(found), figure[0], force)
        if plot is not None:
            print_plot(found, rows, plot, plain=into_file)
        elif json:
            out.print_sweep_json(found, rows, names)
        elif csv:
            out.print_sweep_csv(found, rows, names)
        else:
            out.print_sweep(found, rows, names, plain=into_file)
    if csv:
        for note in out.sweep_notes(rows, names):
            _say(note)
    return DONE


@app.command("tradeoff", cls=Command)
@takes_scene
def tradeoff(
    given: Mapping[str, str | None],
    *,
    family: Families = None,
    scenes: Scenes = None,
    seed: Seed = None,
    plot: PlotErrors = False,
    figure: FigureFile = None,
    force: Force = False,
    json: AsJson = False,
    csv: AsCsv = False,
) -> int:
    """Measure what accuracy costs on this machine: time beside error, for families of scenes or for one.

    Examples:
      atwood tradeoff
      atwood tradeoff --family near-critical --scenes 2000 --plot
      atwood tradeoff --m1 1 --m2 3 --M 10 --mu 0.3
      atwood tradeoff --json > measured.json
    """
    from ..tradeoff.measure import MOST_SCENES
    from ..tradeoff.measure import tradeoff as measure
    from ..tradeoff.scenes import FAMILIES
    from . import page as out

    _exclude_each_other(json, csv)
    _check_force(force, figure=figure)
    scene = None
    if any(value is not None for value in given.values()):
        scene = Scene.read(given)
        for name, value in (("family", family and family[0]), ("scenes", scenes), ("seed", seed)):
            if value is not None:
                raise SceneError(name, value, "has no say where a scene is given; leave one of them out")
    for name in family or ():
        if name not in FAMILIES:
            hint = nearest(name, FAMILIES) or f"; there are {', '.join(FAMILIES)}"
            raise SceneError("family", name, f"is no family of scenes{hint}")
    if plot:
        if json or csv:
            raise SceneError(
                "plot", None, f"draws text, not {'JSON' if json else 'CSV'}; leave one of them out"
            )
        from .plot import print_tradeoff_plot
    if figure is not None:
        from .figure import check_file, save_tradeoff

        check_file(figure, force)
    found = measure(
        list(dict.fromkeys(family or FAMILIES)),
        read_whole("scenes", scenes or DEFAULT_SCENES, 1, MOST_SCENES),
        read_whole("seed", seed or DEFAULT_SEED, 0, MOST_SEED),
        scene,
        out.watched,
    )
    if figure is not None:
        save_tradeoff(found, figure, force)
    if plot:
        print_tradeoff_plot(found)
    elif json:
        out.print_tradeoff_json(found)
    elif csv:
        out.print_tradeoff_csv(found)
        for note in (*found.notes, found.advice):
            _say(note)
    else:
        out.print_tradeoff(found)
    return DONE


@app.command("batch", cls=Command)
def batch(
    table: Table,
    *,
    output: OutTable = "-",
    from_: FromFormat = None,
    to: ToFormat = None,
    only: Columns = None,
    accuracy: Accuracy = "certified",
    allow_errors: AllowErrors = False,
    force: Force = False,
) -> int:
    """Solve a table of scenes: the same table with results appended, and the error of each bad row.

    Examples:
      atwood batch scenes.csv -o results.csv
      atwood batch scenes.parquet -o results.parquet --accuracy exact
      atwood batch scenes.csv --only regime --only acceleration | head
      generate | atwood batch - --from ndjson --to ndjson --allow-errors

    Columns m1, m2, M, mu, mu_k, g, inertia, R, wrap are the options of solve, in SI units; an empty cell
    is not given. Other columns stay as they are. A cell is read as the double nearest to it, as is g: so
    even exact can differ in the last digit from solve, which takes 0.1 for a tenth.
    """
    from ..arrays import ACCURACIES
    from ..batch.formats import read_format
    from ..batch.run import Job, run_batch
    from ..model.quantities import STANDARD
    from .page import watched

    names = list(dict.fromkeys(only or STANDARD))
    _check_names("only", *names)
    if accuracy not in ACCURACIES:
        hint = nearest(accuracy, ACCURACIES) or f"; there are {', '.join(ACCURACIES)}"
        raise SceneError("accuracy", accuracy, f"is no accuracy{hint}")
    formats = read_format("from", from_, table), read_format("to", to, output)
    tally = run_batch(Job(table, formats[0], output, formats[1], names, accuracy, force), watched)
    for line in tally.lines():
        _say(line)
    return COULD_NOT if tally.errors and not allow_errors else DONE


def _check_names(option: str, *names: str, known: Sequence[str] = NAMES) -> None:
    for name in names:
        if name not in known:
            hint = nearest(name, known) or f"; there are {', '.join(known)}"
            raise SceneError(option, name, f"is no quantity{hint}")


def _check_explain(explain: bool, markdown: bool, others: Mapping[str, object]) -> None:
    if markdown and not explain:
        raise SceneError("markdown", None, "needs --explain")
    for option, given in others.items():
        if explain and given:
            raise SceneError("explain", None, f"has no part in {option}; leave one of them out")


def _exclude_each_other(json: bool, csv: bool) -> None:
    if json and csv:
        raise SceneError("json", None, "and --csv exclude each other; give one of them")


def _check_force(force: bool, **files: object) -> None:
    if force and not any(files.values()):
        raise SceneError("force", None, f"needs {' or '.join(map(flag, files))}")


def _say(message: str) -> None:
    text = for_stream(f"atwood: {message}", sys.stderr)
    if sys.stderr.isatty():  # a line breaks between words, where it must
        from shutil import get_terminal_size
        from textwrap import fill

        text = fill(text, get_terminal_size().columns, break_long_words=False, break_on_hyphens=False)
    with suppress(OSError):  # there is nobody else to tell
        print(text, file=sys.stderr)


def run(arguments: list[str] | None = None) -> int:
    """Run the command line; every error is a sentence on stderr and an exit status."""
    # A stream closed by the caller is None: what is printed goes nowhere.
    sys.stdout, sys.stderr = sys.stdout or io.StringIO(), sys.stderr or io.StringIO()
    command = typer.main.get_command(app)
    try:
        status = command.main(arguments, prog_name="atwood", standalone_mode=False) or DONE
        sys.stdout.flush()
        return status
    except (BrokenPipeError, SystemExit) as error:  # typer and rich exit where the reader of stdout has left
        if isinstance(error, SystemExit) and COMPLETING in os.environ:  # fish goes by the status
            return int(error.code or DONE)
        # What is still buffered must not fail again when Python closes stdout.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return DONE
    except SceneError as error:
        _say(error.describe(flag(error.parameter)))
        return WRONG_USAGE
    except UsageError as error:
        how = f"; {error.ctx.command_path} -h shows how" if error.ctx else ""
        _say(f"{error.format_message().rstrip('.')}{how}")
        return WRONG_USAGE
    except typer.Abort:
        raise KeyboardInterrupt from None
    except ModuleNotFoundError as error:
        if error.name not in EXTRAS:
            raise
        _say(f"this needs {error.name}; install it with: pip install 'atwood-cli[{EXTRAS[error.name]}]'")
        return COULD_NOT
    except OSError as error:
        known = error.errno is None  # a sentence of ours
        _say(str(error) if known else f"cannot write {error.filename or 'the output'}: {error.strerror}")
        return COULD_NOT
    except ArithmeticError as error:
        _say(str(error))
        return COULD_NOT
