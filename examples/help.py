"""The help of every command, as `help.txt` keeps it: python -m examples.help > examples/help.txt"""

import os
import subprocess
import sys

COMMANDS = ("", "solve", "fit", "sweep", "contact", "batch", "tradeoff")


def pages() -> str:
    """What `atwood -h` and `atwood COMMAND -h` print at 80 columns."""
    env = {**os.environ, "COLUMNS": "80", "PYTHONIOENCODING": "utf-8"}
    shown = []
    for command in COMMANDS:
        words = [*command.split(), "-h"]
        done = subprocess.run(
            [sys.executable, "-m", "atwood_cli", *words], capture_output=True, env=env, check=True
        )
        text = done.stdout.decode().replace("\r\n", "\n")
        shown.append(f"$ atwood {' '.join(words)}\n{text}")
    return "\n".join(shown)


if __name__ == "__main__":
    sys.stdout.reconfigure(encoding="utf-8", newline="\n")  # type: ignore[union-attr]
    sys.stdout.write(pages())
