"""The command line: its commands, each in a module of its name, and its errors, each a sentence."""

import io
import os
import sys
from collections.abc import Callable, Sequence
from errno import EINVAL
from importlib import import_module
from typing import Annotated, Any

import typer
from typer.core import TyperCommand

from .. import __version__
from ..numbers.text import LONGEST_NAME, shortened
from ..output.text import drop, finish, naming_the_extra, say
from ..reading.names import input_meant
from ..solver.quantities import Undetermined
from ..solver.scene import DRIVE, SceneError
from .options import COMPLETING, COULD_NOT, DONE, WRONG_USAGE, flag, write_options

COMMANDS = ("solve", "sweep", "contact", "fit", "batch", "quantities", "tradeoff")
HELP = """Solve Atwood's machine (both masses hang) with pulley mass and friction, every digit right.

\b
Examples:
  atwood solve --m1 1 --m2 3 --mu 0.3
  atwood fit runs.csv --drop 98cm
  atwood sweep --m1 1 --m2 3 --M 0:50:6 --mu 0.3
  atwood solve --m1 250g --m2 300g --M 100g --only acceleration
  atwood contact --m1 1 --m2 3 --M 10 --mu 0.3
  atwood batch scenes.csv -o results.csv
"""

DASHES = "-–—"
# The parent of all usage errors, which typer does not export.
UsageError: Any = typer.BadParameter.__base__
ON_CTRL_C = 130
"""The status that typer returns for a command that was interrupted."""


class Command(TyperCommand):
    """A command with help by group, and with hints at three slips that typer would misunderstand."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        ctx.obj = [*args]  # as they were typed
        if ctx.resilient_parsing:  # to complete a line that is not finished
            return super().parse_args(ctx, args)
        options: dict[str, Any] = {flag: param for param in self.get_params(ctx) for flag in param.opts}
        given = list[Any]()
        for word, value in zip(args, [*args[1:], ""], strict=False):
            name = word.partition("=")[0]
            meant = f"--{name.lstrip(DASHES)}"  # word processors make such dashes of two
            guess = flag(input_meant(name.strip(DASHES)))
            alike = [flag for flag in options if flag.lower() in (meant.lower(), guess.lower())]
            if alike and name not in options and name[0] in DASHES:
                raise UsageError(f"No such option: {name}. Did you mean {alike[0]}?", ctx)
            if name not in options or options[name].is_flag:
                continue
            option = options[name]
            if word == name and value.partition("=")[0] in options:
                raise SceneError(option.name, None, f"needs a value before the option {shortened(value)}")
            if option in given and not option.multiple:
                raise SceneError(option.name, None, "is given twice; leave one out")
            given.append(option)
        return super().parse_args(ctx, args)

    def format_options(self, ctx: Any, formatter: Any) -> None:
        write_options(self, ctx, formatter)

    def collect_usage_pieces(self, ctx: Any) -> list[str]:
        """Return `[OPTIONS] RUNS`, the same in all versions of typer."""
        arguments = [param for param in self.params if param.param_type_name == "argument"]
        return ["[OPTIONS]", *(str(param.metavar) for param in arguments)]


def root(
    context: typer.Context,
    version: Annotated[bool, typer.Option("--version", "-V", help="Print the version.")] = False,
) -> None:
    """Print the version, or the help if no command is named."""
    if version:
        print(f"atwood {__version__}")
        raise typer.Exit
    if context.invoked_subcommand is None:
        print(context.get_help())


def program(names: Sequence[str] = COMMANDS) -> Any:
    """Return the program with these commands; each takes a while to import."""
    app = typer.Typer(
        name="atwood",
        help=HELP,
        rich_markup_mode=None,
        invoke_without_command=True,
        add_completion=tuple(names) == COMMANDS,
        context_settings={"help_option_names": ["-h", "--help"]},
    )
    app.callback()(root)
    for name in names:
        module = import_module(f".{name}", __name__)
        app.command(name, cls=Command, help=module.HELP)(getattr(module, name))
    return typer.main.get_command(app)


def run(arguments: list[str] | None = None) -> int:
    """Run the command line. Every error ends in a sentence on stderr and an exit status."""
    # A stream that the caller has closed is None. Lost results are an error, lost messages are not.
    sys.stdout = sys.stdout or os.fdopen(os.open(os.devnull, os.O_RDONLY))
    sys.stderr = sys.stderr or os.fdopen(os.open(os.devnull, os.O_WRONLY), "w", errors="replace")
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")  # for symbols that it cannot write
    try:
        arguments = sys.argv[1:] if arguments is None else arguments
        if arguments and arguments[0] == "help":
            arguments = [*arguments[1:], "-h"]
        # Help, completion and hints must know all commands.
        is_one = arguments and arguments[0] in COMMANDS and COMPLETING not in os.environ
        command = program([arguments[0]] if is_one else COMMANDS)
        with naming_the_extra():
            status = command.main(arguments, prog_name="atwood", standalone_mode=False) or DONE
        if status == ON_CTRL_C:
            raise KeyboardInterrupt
        sys.stdout.flush()
        return status
    except (KeyboardInterrupt, typer.Abort):
        drop(sys.stdout)  # its reader may have stopped, and writing would wait for ever
        raise KeyboardInterrupt from None
    except SystemExit as error:  # typer and rich exit if the reader of stdout has left
        if COMPLETING in os.environ:  # fish goes by the status
            return int(error.code or DONE)
        drop(sys.stdout)
        return DONE
    except tuple(ERRORS) as error:
        status, why = next(ERRORS[kind] for kind in type(error).__mro__ if kind in ERRORS)
        if words := why(error):
            say(words)
            return status
        drop(sys.stdout)  # its reader has left
        return DONE
    finally:
        finish()


def _why_not_understood(error: Any) -> str:
    """Say what is wrong with the words of a command line."""
    if possible := getattr(error, "possibilities", None):  # typer's are not that close
        from difflib import get_close_matches

        close = get_close_matches(error.option_name.strip(DASHES), [word.strip(DASHES) for word in possible])
        error.possibilities = [flag(word) for word in close]
    hint = f"{error.ctx.command_path} -h" if error.ctx else ""
    words = " ".join(map(shortened, error.format_message().rstrip(".").split(" ")))
    message = shortened(words, LONGEST_NAME)
    if hasattr(error, "possibilities"):  # there is no such option
        options = {name: command.params for name, command in program().commands.items()}
        having = [x for x in options if any(error.option_name in param.opts for param in options[x])]
        if having:
            message = f"No such option: {error.option_name}, which is for atwood {', '.join(having)}"
        elif input_meant(error.option_name.strip(DASHES)) == DRIVE:
            message = f"No such option: {error.option_name}; a motion finds it: atwood solve --find drive"
    if "extra argument" in message:
        message += ": names take commas, as a,T1; a value with a blank takes quotation marks, as '200 g'"
    return f"{message}{' See' if message.endswith('?') else '; see'} {hint}" if hint else message


def _why_not_written(error: OSError) -> str:
    """Say why an output cannot be written, "" if its reader has left."""
    if isinstance(error, BrokenPipeError) or (os.name == "nt" and error.errno == EINVAL):
        return ""
    if isinstance(error, io.UnsupportedOperation):
        return "cannot write the output: stdout is closed"
    if isinstance(error, NotADirectoryError) and isinstance(error.__context__, ImportError):
        return f"{error.__context__}: what is compiled cannot be imported from a zip file"
    if error.errno is None:  # it is a sentence of ours
        return str(error)
    file = shortened(str(error.filename or "the output"), LONGEST_NAME)
    return f"cannot write {file}: {error.strerror}"


ERRORS: dict[type[Exception], tuple[int, Callable[[Any], str]]] = {
    SceneError: (WRONG_USAGE, lambda error: error.describe(flag(error.parameter))),
    UsageError: (WRONG_USAGE, _why_not_understood),
    OSError: (COULD_NOT, _why_not_written),
    Undetermined: (COULD_NOT, lambda error: str(error).replace("`", "")),
    ImportError: (COULD_NOT, str),
    ArithmeticError: (COULD_NOT, str),
    MemoryError: (COULD_NOT, lambda _: "there is not enough memory"),
}
"""The errors in which a command may end: the exit status, and what is said of them."""
