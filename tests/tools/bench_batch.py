"""Tables of a million scenes, CSV to CSV and Parquet to Parquet: python -m tests.tools.bench_batch [ROUNDS [ROWS]]

Whole processes, which take turns: rows a second of processor time, and the largest memory of any run.
"""

import subprocess
import sys
from collections.abc import Sequence
from functools import partial
from tempfile import TemporaryDirectory

import polars as pl

from .bench_arrays import in_turn, ordinary
from .running import TOP


def run(words: Sequence[str]) -> tuple[float, int]:
    """Seconds of processor time, and the peak memory in MB."""
    from os import wait4

    command = [sys.executable, "-m", "atwood_cli", "batch", *words, "--force"]
    child = subprocess.Popen(command, stderr=subprocess.DEVNULL, cwd=TOP)
    _, status, usage = wait4(child.pid, 0)
    assert status == 0, words
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss // 1024


def main(rounds: int = 7, rows: int = 1_000_000) -> None:
    with TemporaryDirectory() as folder:
        works = {}
        for kind in ("csv", "parquet"):
            getattr(pl.DataFrame(ordinary(rows)), f"write_{kind}")(f"{folder}/in.{kind}")
            works[kind] = partial(run, [f"{folder}/in.{kind}", "-o", f"{folder}/out.{kind}"])
        for name, turns in in_turn(works, rounds).items():
            seconds, memory = min(turns)[0], max(memory for _, memory in turns)
            print(f"{name:8} {seconds:6.2f} s, {rows / seconds:10,.0f} rows a second, {memory} MB")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
