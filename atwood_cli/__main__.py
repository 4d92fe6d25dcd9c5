"""The entry of the program: `python -m atwood_cli` and the command `atwood`."""

import gc
import os
import signal
import sys
from typing import NoReturn

INTERRUPTED = 130
"""The exit status of a run that was interrupted."""
ENDING_SIGNALS = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]


def main() -> NoReturn:
    """Run the command line and end the process. A zipapp would drop a status that is returned."""
    sys.exit(_status())


def _status() -> int:
    """Run the command line and return its exit status. The process is to end then."""
    status = 0

    def end(number: int, _: object) -> None:
        """End as on Ctrl-C, with the status that a shell reports."""
        nonlocal status
        status = 128 + number
        raise KeyboardInterrupt

    def lost(error: "sys.UnraisableHookArgs") -> None:
        """End at once if Python cannot raise the interrupt, as while it drops an object."""
        if error.exc_type is KeyboardInterrupt:
            os._exit(status or INTERRUPTED)
        sys.__unraisablehook__(error)

    sys.unraisablehook = lost
    for number in ENDING_SIGNALS:
        if signal.getsignal(number) != signal.SIG_IGN:  # as under nohup
            signal.signal(number, end)
    if sys.stdout and not sys.stdout.isatty():
        # What fits in a pipe is one write, also with PYTHONUNBUFFERED: others may write to it.
        sys.stdout = os.fdopen(1, "w", 1 << 16, sys.stdout.encoding, "replace", closefd=False)
        vars(sys)["__stdout__"] = sys.stdout  # a constant to type checkers
    try:
        # The environment may allow fewer digits than we do.
        sys.set_int_max_str_digits(sys.int_info.default_max_str_digits)
        gc.disable()  # imported code stays: searching it for garbage takes a seventh of a short run
        from .cli import run

        gc.freeze()
        gc.enable()
        done = run()
        return status or done  # NumPy, interrupted while it is imported, raises an ImportError
    except KeyboardInterrupt:
        return status or INTERRUPTED
    except Exception:  # an import that is interrupted may raise another error
        if not status:
            raise
        return status
    finally:
        for number in ENDING_SIGNALS:  # Python would show a traceback of an interrupt at its end
            signal.signal(number, signal.SIG_IGN)
        gc.freeze()  # the end would take longer with a search for garbage


if __name__ == "__main__":
    main()
