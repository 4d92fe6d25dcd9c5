"""Completion: the script that a shell loads, and values behind an equals sign."""

import os
import re
from pathlib import Path
from shlex import quote
from typing import Any

from ..model.quantities import read_name
from ..model.scene import SceneError
from .options import COMPLETING

SHELLS = ("bash", "zsh", "fish", "powershell", "pwsh")
IN_POWERSHELL = ("powershell", "pwsh")
LOAD_COMPLETION = "(( $+functions[compdef] )) || { autoload -Uz compinit; compinit; }\n"
"""What completion in zsh is built on, where the user has not loaded it."""
TAB_KEY = re.compile("^(Import-Module |Set-)PSReadLine.*\n", re.MULTILINE)
"""Lines by which typer would change what the tab key of PowerShell does for all commands."""


def shell_here() -> str:
    """The name of the user's shell."""
    return Path(os.environ.get("SHELL", "powershell")).stem


def script(shell: str) -> str:
    """The completion as that shell loads it."""
    from typer._completion_shared import get_completion_script

    text = get_completion_script(prog_name="atwood", complete_var=COMPLETING, shell=shell)
    return f"{LOAD_COMPLETION * (shell == 'zsh')}{TAB_KEY.sub('', text)}\n"


def show(typed: str) -> None:
    """Print the completion for a shell. Raises SceneError."""
    print(script(read_name("show_completion", typed, SHELLS, "shell with completion")), end="")


def install(typed: str) -> None:
    """Write the completion for a shell, and the line that loads it. Raises SceneError, OSError."""
    shell = read_name("install_completion", typed, SHELLS, "shell with completion")
    if shell in IN_POWERSHELL:
        how = f"has its start-up file where it says; run there: atwood --show-completion {shell} >> $PROFILE"
        raise SceneError("install_completion", shell, how)
    home, environment = Path.home(), os.environ
    if shell == "fish":  # which looks for it there
        start = None
        file = Path(environment.get("XDG_CONFIG_HOME") or home / ".config", "fish/completions/atwood.fish")
    else:
        start = Path((shell == "zsh" and environment.get("ZDOTDIR")) or home, f".{shell}rc")
        file = home / f".local/share/atwood/completion.{shell}"
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(script(shell), encoding="utf-8")
    if start:
        _add_line(start, f"source {quote(str(file))}")
    loaded = f", which {start} loads" if start else ""
    print(f"Completion for {shell} is in {file}{loaded}. It works in a new terminal.")


def _add_line(file: Path, line: str) -> None:
    """Append a line to a file that does not have it."""
    before = file.read_bytes().decode(errors="replace") if file.exists() else ""
    if line not in before.splitlines():
        with file.open("a", encoding="utf-8") as stream:
            stream.write("\n" * (before[-1:] not in ("", "\n")) + f"{line}\n")


def take_equals(program: Any) -> None:
    """Have values completed behind an equals sign too: --only=acc, which shells divide in different ways."""
    line, at = os.environ.get("COMP_WORDS", ""), os.environ.get("COMP_CWORD", "")
    words = line.split("\n" if "\n" in line else None)
    if at.isdecimal() and words[int(at) - 1 : int(at)] == ["="]:  # bash takes the sign for a word
        os.environ["COMP_WORDS"] = "\n".join([*words[: int(at) - 1], *words[int(at) :]])
        os.environ["COMP_CWORD"] = str(int(at) - 1)
        return
    typed = words[int(at) :] if at.isdecimal() else [os.environ.get("_TYPER_COMPLETE_ARGS", "")]
    # Other shells have the option and its value in one word, and want one.
    if option := re.search(r"(?<!\S)(--[\w-]+=)\S*$", "".join(typed[:1])):
        for command in program.commands.values():
            for param in command.params:
                param.shell_complete = _behind(option[1], param.shell_complete)


def _behind(option: str, complete: Any) -> Any:
    def shell_complete(context: Any, incomplete: str) -> Any:
        items = complete(context, incomplete)
        for item in items:
            item.value = f"{option}{item.value}"
        return items

    return shell_complete
