"""The program's door: `python -m atwood_cli` and the command `atwood`."""

import sys

INTERRUPTED = 130


def main() -> int:
    """Run the command line and return its exit status."""
    try:
        # Imported here, so that Ctrl-C during start-up shows no traceback either.
        from .cli import run

        return run()
    except KeyboardInterrupt:
        return INTERRUPTED


if __name__ == "__main__":
    sys.exit(main())
