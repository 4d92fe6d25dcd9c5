"""The program's door: `python -m atwood_cli` and the command `atwood`."""

import gc
import signal
import sys

INTERRUPTED = 130
STATUSES = {"SIGINT": INTERRUPTED, "SIGTERM": 143, "SIGHUP": 129}
"""Signals that end a run, where the system has them, with the exit status of each."""


def main() -> int:
    """Run the command line and return its exit status. What comes after is the end of the process."""
    ended_by, heeded = 0, True
    statuses = {getattr(signal, name): status for name, status in STATUSES.items() if hasattr(signal, name)}

    def end(number: int, _: object) -> None:
        """Stop as on Ctrl-C, which cleans up: nothing half-written stays beside a file."""
        nonlocal ended_by, heeded
        if heeded:  # a second signal would stop the cleaning up
            ended_by, heeded = statuses[number], False
            raise KeyboardInterrupt

    for number in statuses:
        if signal.getsignal(number) != signal.SIG_IGN:  # as under nohup
            signal.signal(number, end)
    sys.set_int_max_str_digits(
        sys.int_info.default_max_str_digits
    )  # the environment may allow fewer than we do
    gc.disable()  # what is imported stays: looking through it for garbage is a seventh of a short run
    try:
        # Imported here, so that Ctrl-C during start-up shows no traceback either.
        from .cli import run

        gc.freeze()
        gc.enable()
        status = run()
    except KeyboardInterrupt:
        status = ended_by or INTERRUPTED
    finally:
        heeded = False  # all is done, and Python would show a traceback of what interrupts its end
        gc.enable()
        gc.freeze()  # so that it is not looked through at the end either
    return status


if __name__ == "__main__":
    sys.exit(main())
