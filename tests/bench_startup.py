"""Start-up of `atwood solve` beside a bare typer app: python -m tests.bench_startup [PAIRS]

Whole processes in turn, A B A B ..., in an environment that says nothing of Python; what counts is the
median of the ratios, pair by pair.
"""

import os
import statistics
import subprocess
import sys
import time
from pathlib import Path

from .running import PAPER

OURS = [sys.executable, "-m", "atwood_cli"]
BARE = [sys.executable, "-m", "tests.startup_baseline"]
TOP = Path(__file__).parent.parent
CLEAN = {name: os.environ[name] for name in ("HOME", "PATH") if name in os.environ}


def seconds(command: list[str]) -> float:
    start = time.perf_counter()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, cwd=TOP, env=CLEAN)
    return time.perf_counter() - start


def main(pairs: int) -> None:
    for module in ("atwood_cli", "tests"):  # else the first imports would compile
        compiled = [sys.executable, "-m", "compileall", "-q", module]
        subprocess.run(compiled, check=True, cwd=TOP, env=CLEAN)
    for output in (["--json"], []):
        words = [*PAPER, *output]
        seconds([*OURS, *words]), seconds([*BARE, *words])
        times = [(seconds([*OURS, *words]), seconds([*BARE, *words])) for _ in range(pairs)]
        ours, bare = (statistics.median(t[i] for t in times) * 1000 for i in (0, 1))
        ratio = statistics.median(a / b for a, b in times)
        print(
            f"{'json' if output else 'table'}: {ours:.0f} ms, bare typer app {bare:.0f} ms, ratio {ratio:.3f}"
        )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 40)
