"""Help on typer's own formatter, with the options by group."""

from typing import Any

BRIEF = ("sweep", "contact")
"""Commands whose help only names the options of a scene: the help of solve explains them."""
LAST = ("Output", "Files")
"""Groups of options that stand behind a command's own groups."""


def write_options(command: Any, context: Any, formatter: Any) -> None:
    """The options of a command by group."""
    groups: dict[str, list[tuple[str, str]]] = {}
    for param in command.get_params(context):
        record = param.get_help_record(context)
        if param.param_type_name == "argument":
            record = (param.metavar, record[1])  # typer 0.29 adds its type
        groups.setdefault(getattr(param, "rich_help_panel", None) or "Output", []).append(record)
    for panel in sorted(groups, key=lambda panel: LAST.index(panel) if panel in LAST else -1):
        with formatter.section(panel):
            if panel == "Scene" and command.name in BRIEF:
                names = " ".join(param.opts[0] for param in command.params if param.rich_help_panel == panel)
                formatter.write_text(f"{names}, as in atwood solve -h")
            else:
                formatter.write_dl(groups[panel], col_max=25)
