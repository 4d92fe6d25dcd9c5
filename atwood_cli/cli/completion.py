"""Completion: words after an equals sign, which shells hand over in different ways."""

import os
import re
from typing import Any


def take_equals(program: Any) -> None:
    """Have values completed behind an equals sign too, as in --only=acc."""
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
