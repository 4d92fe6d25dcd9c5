"""A server that has imported the program and forks for each run, since most of a short run is its imports.

A fork differs from a new process in what Python and the program's modules do as they start.
"""

import gc
import json
import os
import socket
import subprocess
import sys
from collections.abc import Mapping, Sequence
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import NoReturn

from atwood_cli import __main__, cli
from atwood_cli.output import page

HANGS = 600  # seconds: nothing takes so long on any machine
TOP = Path(__file__).parent.parent
WARM = [
    *(f"atwood_cli.cli.{name}" for name in cli.COMMANDS),
    "atwood_cli.arrays",
    "atwood_cli.output.typeset",
]
WARM += ["rich.table", "matplotlib.backends.backend_svg"]  # not polars: its threads would not survive
SIZE = 8  # bytes that say how long a request is


@cache
def server() -> tuple[socket.socket, "subprocess.Popen[bytes]"]:
    ours, theirs = socket.socketpair()
    with theirs:
        words = [sys.executable, "-m", "tests.forks", str(theirs.fileno())]
        ours.settimeout(HANGS)
        return ours, subprocess.Popen(words, pass_fds=[theirs.fileno()], stdin=subprocess.DEVNULL, cwd=TOP)


def start(words: Sequence[str], streams: Sequence[int], environment: Mapping[str, str]) -> None:
    """Run the program on three streams."""
    request = json.dumps([words, os.getcwd(), dict(environment)]).encode()
    socket.send_fds(server()[0], [len(request).to_bytes(SIZE)], streams)
    server()[0].sendall(request)


def status() -> int:
    """The exit status of what was started last, once it ends."""
    answer = server()[0].recv(SIZE, socket.MSG_WAITALL)
    assert answer, "the server of forks has ended"
    return int.from_bytes(answer, signed=True)


# What runs in the server


def serve(door: socket.socket) -> None:
    """Fork for each request, say how it ended, and leave when nobody asks any more."""
    for name in WARM:
        if find_spec(name.partition(".")[0]):  # what it belongs to is installed
            import_module(name)
    gc.collect()
    gc.freeze()
    while True:
        size, streams, *_ = socket.recv_fds(door, SIZE, 3)
        if not size:
            return
        request = door.recv(int.from_bytes(size), socket.MSG_WAITALL)
        if not (child := os.fork()):
            door.close()
            words, folder, environment = json.loads(request)
            run(words, folder, environment, streams)
        for stream in streams:
            os.close(stream)
        ended = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        door.sendall(ended.to_bytes(SIZE, signed=True))


def run(
    words: Sequence[str], folder: str, environment: Mapping[str, str], streams: Sequence[int]
) -> NoReturn:
    """Do in a fork what a new process does."""
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(environment)
    for number, stream in enumerate(streams):
        os.dup2(stream, number)
        os.close(stream)
    encoding = environment.get("PYTHONIOENCODING", "utf-8")
    sys.stdin, sys.stdout = open(0, encoding=encoding), open(1, "w", encoding=encoding)  # noqa: SIM115
    sys.stderr = open(2, "w", buffering=1, encoding=encoding, errors="backslashreplace")  # noqa: SIM115
    vars(sys)["__stdout__"] = sys.stdout
    sys.argv = [__main__.__file__, *words]
    vars(page)["monotonic"] = lambda: 0.0  # on a slow machine it would show bars
    status = __main__.main()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)  # to take all modules apart would copy the server's memory


if __name__ == "__main__":
    serve(socket.socket(fileno=int(sys.argv[1])))
