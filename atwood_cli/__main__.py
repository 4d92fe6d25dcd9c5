"""The program's door: `python -m atwood_cli` and the command `atwood`."""

import gc
import signal
import sys

INTERRUPTED, TERMINATED = 130, 143


def main() -> int:
    """Run the command line and return its exit status."""
    terminated = False

    def terminate(*_: object) -> None:
        """Stop as on Ctrl-C, which cleans up: nothing half-written stays beside a file."""
        nonlocal terminated
        terminated = True
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGTERM, terminate)
    gc.disable()  # what is imported stays: looking through it for garbage is a seventh of a short run
    try:
        # Imported here, so that Ctrl-C during start-up shows no traceback either.
        from .cli import run

        gc.freeze()
        gc.enable()
        status = run()
    except KeyboardInterrupt:
        status = INTERRUPTED
    finally:
        signal.signal(signal.SIGTERM, before)
        gc.enable()
        gc.freeze()  # so that it is not looked through at the end either
    return TERMINATED if terminated else status


if __name__ == "__main__":
    sys.exit(main())
