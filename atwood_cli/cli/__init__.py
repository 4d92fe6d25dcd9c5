"""The command line: its commands, each in a module of its name, and how errors are reported."""

import io
import os
import sys
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from importlib import import_module
from typing import Annotated, Any, cast

import typer
from typer._completion_classes import completion_init
from typer.core import TyperCommand, TyperGroup

from .. import __version__
from ..files import LONGEST_NAME, ClosedStdout
from ..model.quantities import NAMES, SYMBOLS
from ..model.scene import SceneError
from ..model.units import in_quotes, near, shortened
from ..output.text import drop, finish, say
from .options import COMPLETING, COULD_NOT, DONE, WRONG_USAGE, flag

COMMANDS = ("solve", "fit", "sweep", "contact", "batch", "tradeoff")
EXTRAS = {"matplotlib": "figure", "plotille": "plot", "polars": "batch"}
OF_TOOLS = {
    "uv-receipt.toml": "uv tool install",
    "pipx_metadata.json": "pipx runpip atwood-cli install",
}
"""Files by which installers of tools mark an environment, and what adds a package there."""
HELP = """Atwood's machine with a massive pulley and a rough string, every digit right.

Examples:
  atwood solve --m1 1 --m2 3 --mu 0.3
  atwood fit runs.csv --drop 98cm
  atwood sweep --m1 1 --m2 3 --M 0:50:6 --mu 0.3
  atwood solve --m1 250g --m2 300g --M 100g --only acceleration
  atwood contact --m1 1 --m2 3 --M 10 --mu 0.3
  atwood batch scenes.csv -o results.csv
"""

# The parent of all of typer's usage errors, of which typer exports only this child.
UsageError: Any = typer.BadParameter.__mro__[1]


ON_CTRL_C = 130
"""What typer returns for a command that was interrupted."""


class Command(TyperCommand):
    """A command with our help, which refuses words that were hardly meant as typer takes them."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        if not ctx.resilient_parsing:  # which completes what is typed so far
            options = {flag: param for param in self.get_params(ctx) for flag in param.opts}
            try:
                values, left, order = self.make_parser(ctx).parse_args(args=list(args))
            except UsageError as error:
                _check_dashes(ctx, args, options)
                if hasattr(error, "possibilities"):  # which typer finds by their dashes, too
                    typed = error.option_name
                    meant = near(typed.lstrip("-"), [known.lstrip("-") for known in options])
                    raise _no_option(typed, meant, ctx) from None
                raise
            _check_dashes(ctx, left, options)
            _check_values(values, order, options)
            _check_left(args, left, options)
        return super().parse_args(ctx, args)

    def format_help(self, ctx: Any, formatter: Any) -> None:
        from .help import page

        formatter.write(page(self, ctx))


def _check_dashes(ctx: Any, words: Iterable[str], options: Mapping[str, Any]) -> None:
    """Refuse -m1 and m1=1, and the dash that word processors make of two, with a hint at --m1."""
    for word in words:
        name, equals, _ = word.partition("=")
        meant = f"--{name.lstrip('-–—')}"
        if meant in options and name not in options and (equals or meant[2:] != name):
            raise _no_option(name, meant[2:], ctx)


def _no_option(typed: str, meant: str, ctx: Any) -> Exception:
    """The error for an unknown option, with a hint at the one that is meant, if any."""
    hint = f". Did you mean --{meant}?" if meant else ""
    error: Exception = UsageError(f"No such option: {typed}{hint}", ctx)
    return error


def _check_values(values: Mapping[str, Any], order: Sequence[Any], options: Mapping[str, Any]) -> None:
    """Refuse a scalar option given twice, rather than take the last, and another option as a value."""
    for option, times in Counter(order).items():
        typed = values[option.name]
        for value in typed if isinstance(typed, list | tuple) else [typed]:
            if str(value).partition("=")[0] in options:
                rule = f"lacks its value: what follows is the option {shortened(value)}"
                raise SceneError(option.name, None, rule)
        if times > 1 and not (getattr(option, "multiple", 0) or getattr(option, "is_flag", 0)):
            raise SceneError(option.name, None, f"is given {times} times; give it once")


def _check_left(args: Sequence[str], left: Sequence[str], options: Mapping[str, Any]) -> None:
    """Refuse a value that was split into words, and the name of a quantity without its option."""
    for before, value, word in zip(args, args[1:], args[2:], strict=False):
        if word in left[:1] and before in options:
            several = getattr(options[before], "multiple", 0)
            if SYMBOLS.get(word, word) in NAMES and not several:
                break
            joined = f"{value}{',' if several else ' '}{word}"
            rule = f"is followed by a stray {in_quotes(word)}; write {in_quotes(joined)} if it belongs there"
            raise SceneError(options[before].name, value, rule)
    takes_words = any(not name.startswith("-") for name in options)
    if left and SYMBOLS.get(left[0], left[0]) in NAMES and "--only" in options and not takes_words:
        raise SceneError("only", None, f"must stand before the name of a quantity: --only {left[0]}")


class Group(TyperGroup):
    """The commands, with our help."""

    format_help = Command.format_help


def _print_version(wanted: bool) -> None:
    if wanted:
        print(f"atwood {__version__}")
        raise typer.Exit


Version = Annotated[
    bool,
    typer.Option("--version", "-V", callback=_print_version, is_eager=True, help="Print the version."),
]


def _completing(do: str) -> Any:
    """An option that takes the name of a shell, for the function of that name in `completion`."""

    def act(shell: str | None) -> None:
        if shell is not None:
            getattr(import_module(".completion", __name__), do)(shell)
            raise typer.Exit

    help_ = f"{do.capitalize()} completion for your shell, or for the one named."
    flag_ = f"--{do}-completion"
    return typer.Option(flag_, metavar="[SHELL]", callback=act, is_eager=True, help=help_, show_default=False)


Install = Annotated[str | None, _completing("install")]
Show = Annotated[str | None, _completing("show")]


def root(
    context: typer.Context, version: Version = False, install: Install = None, show: Show = None
) -> None:
    """Print the help where no command is named."""
    if context.invoked_subcommand is None:
        print(context.get_help())


def program(names: Iterable[str] = COMMANDS) -> Any:
    """The program with the commands named: importing one and making its options takes a while."""
    app = typer.Typer(
        name="atwood",
        cls=Group,
        help=HELP,
        invoke_without_command=True,
        add_completion=False,  # typer's writes lines that are not ours into start-up files
        context_settings={"help_option_names": ["-h", "--help"]},
    )
    app.callback()(root)
    for name in names:
        module = import_module(f".{name}", __name__)
        listed = getattr(module, "LISTED", None)
        app.command(name, cls=Command, help=module.HELP, epilog=listed)(getattr(module, name))
    return typer.main.get_command(app)


def _installer() -> str:
    """The command that installs a package where this runs, by what installed the program there."""
    from importlib.metadata import PackageNotFoundError, distribution
    from pathlib import Path
    from shlex import quote

    for file, command in OF_TOOLS.items():
        if Path(sys.prefix, file).exists():
            return command
    try:
        by = (distribution("atwood-cli").read_text("INSTALLER") or "").strip()
    except PackageNotFoundError:  # it runs from its source
        by = ""
    python = quote(sys.executable or "python3")
    return f"uv pip install --python {python}" if by == "uv" else f"{python} -m pip install"


def _needed(arguments: list[str]) -> tuple[str, ...]:
    """The command named; all where none is, so that help, completion and hints know them."""
    first = next(iter(arguments), "")
    return (first,) if first in COMMANDS and COMPLETING not in os.environ else COMMANDS


def run(arguments: list[str] | None = None) -> int:
    """Run the command line; every error is a sentence on stderr and an exit status."""
    # A stream that the caller closed is None. Lost results are an error; lost messages cannot be reported.
    sys.stdout, sys.stderr = sys.stdout or cast(Any, ClosedStdout()), sys.stderr or io.StringIO()
    try:
        arguments = sys.argv[1:] if arguments is None else arguments
        if arguments[:1] == ["help"]:
            arguments = [*arguments[1:], "-h"]
        if arguments in (["--install-completion"], ["--show-completion"]):
            from .completion import shell_here

            arguments = [*arguments, shell_here()]
        command = program(_needed(arguments))
        if COMPLETING in os.environ:
            from .completion import take_equals

            completion_init()
            take_equals(command)
        status = command.main(arguments, prog_name="atwood", standalone_mode=False) or DONE
        if status == ON_CTRL_C:
            raise KeyboardInterrupt
        sys.stdout.flush()
        return status
    except (BrokenPipeError, SystemExit) as error:  # typer and rich exit if the reader of stdout has left
        if isinstance(error, SystemExit) and COMPLETING in os.environ:  # fish goes by the status
            return int(error.code or DONE)
        drop(sys.stdout)
        return DONE
    except SceneError as error:
        say(error.describe(flag(error.parameter)))
        return WRONG_USAGE
    except UsageError as error:
        how = f"; {error.ctx.command_path} -h shows how" if error.ctx else ""
        words = " ".join(map(shortened, error.format_message().rstrip(".").split(" ")))
        say(f"{shortened(words, LONGEST_NAME)}{how}")
        return WRONG_USAGE
    except (KeyError, ValueError):
        if COMPLETING not in os.environ:
            raise
        how = "by which a shell asks for words, but not COMP_WORDS and COMP_CWORD; unset it"
        say(f"{COMPLETING} is set, {how}")
        return WRONG_USAGE
    except (KeyboardInterrupt, EOFError, typer.Abort) as error:
        if EOFError in (type(error), type(error.__cause__)):  # of a compiled module that was cut off
            say("a file of the program is damaged; install it again")
            return COULD_NOT
        drop(sys.stdout)  # who reads it may have stopped, and writing would wait for ever
        raise KeyboardInterrupt from None
    except ModuleNotFoundError as error:
        if error.name not in EXTRAS:
            raise
        say(f"this needs {error.name}; install it with: {_installer()} 'atwood-cli[{EXTRAS[error.name]}]'")
        return COULD_NOT
    except OSError as error:
        known = error.errno is None  # a sentence of ours
        name = shortened(str(error.filename or "the output"), LONGEST_NAME)
        say(str(error) if known else f"cannot write {name}: {error.strerror}")
        return COULD_NOT
    except ArithmeticError as error:
        say(str(error))
        return COULD_NOT
    finally:
        finish()
