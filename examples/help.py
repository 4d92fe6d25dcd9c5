"""The help of every command, as `help.txt` keeps it: python -m examples.help > examples/help.txt"""

import os
import sys
from contextlib import redirect_stdout
from io import BytesIO, TextIOWrapper
from unittest.mock import patch

from atwood_cli.cli import COMMANDS, run


def pages() -> str:
    """What `atwood -h` and `atwood COMMAND -h` print at 80 columns."""
    kept = BytesIO()
    stream = TextIOWrapper(kept, encoding="utf-8", newline="\n", write_through=True)
    with patch.dict(os.environ, COLUMNS="80"), redirect_stdout(stream):
        for words in (["-h"], *([command, "-h"] for command in COMMANDS)):
            print(f"{chr(10) * bool(kept.tell())}$ atwood {' '.join(words)}")
            run(words)
    return kept.getvalue().decode()


if __name__ == "__main__":
    sys.stdout.reconfigure(encoding="utf-8", newline="\n")  # type: ignore[union-attr]
    sys.stdout.write(pages())
