"""The program's door: `python -m atwood_cli` and the command `atwood`."""

import gc
import signal
import sys

INTERRUPTED = 130
"""The exit status of a run that was interrupted."""
SIGNAL_STATUSES = {
    getattr(signal, name): status
    for name, status in {"SIGINT": INTERRUPTED, "SIGTERM": 143, "SIGHUP": 129, "SIGALRM": 142}.items()
    if hasattr(signal, name)
}
"""The signals of the system that end a run, and their exit statuses."""


def main() -> int:
    """Run the command line and return its exit status. The process is to end then."""
    ended_by, heeded = 0, True  # the signal that ended the run, and whether another signal is heeded

    def end(number: int, _: object) -> None:
        """Stop as on Ctrl-C, which cleans up: nothing half-written stays beside a file."""
        nonlocal ended_by, heeded
        if heeded:  # a second signal would stop the cleaning up
            ended_by, heeded = ended_by or number, False
            raise KeyboardInterrupt

    def end_soon(unraised: "sys.UnraisableHookArgs") -> None:
        """Try again in a moment where Python cannot raise, as while it drops an object."""
        nonlocal heeded
        if heeded or not isinstance(unraised.exc_value, KeyboardInterrupt):
            sys.__unraisablehook__(unraised)
            return
        heeded = True
        if hasattr(signal, "setitimer"):  # elsewhere, the next Ctrl-C ends it
            signal.setitimer(signal.ITIMER_REAL, 0.01)

    try:
        for number in SIGNAL_STATUSES:
            if signal.getsignal(number) != signal.SIG_IGN:  # as under nohup
                signal.signal(number, end)
        sys.unraisablehook = end_soon
        status = _run()
    except KeyboardInterrupt:
        status = SIGNAL_STATUSES.get(ended_by, INTERRUPTED)
    except Exception:  # a module in the middle of its import may turn the interrupt into another error
        if not ended_by:
            raise
        status = SIGNAL_STATUSES[ended_by]
    finally:
        heeded = False  # all is done; Python would show a traceback of an interrupt at its end
        sys.unraisablehook = sys.__unraisablehook__
        for number in SIGNAL_STATUSES:
            signal.signal(number, signal.SIG_IGN)
        gc.freeze()  # the end would take longer with a search for garbage
    return status


def _run() -> int:
    """Run the command line. It is imported here, so that Ctrl-C during the import shows no traceback."""
    # The environment may allow fewer digits than we do.
    sys.set_int_max_str_digits(sys.int_info.default_max_str_digits)
    gc.disable()  # imported code stays: searching it for garbage takes a seventh of a short run
    from .cli import run

    gc.freeze()
    gc.enable()
    return run()


if __name__ == "__main__":
    sys.exit(main())
