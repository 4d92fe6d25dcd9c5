"""Command lines, files and arguments at random, and what is wrong with the runs: python -m tests.fuzz [RUNS [FIRST]]

A run is made from its number alone, so that it can be had again: python -m tests.fuzz 1 NUMBER. Whatever
is typed, a run ends within the limits, without a traceback or a warning, with a status of ours, with stdout
empty on an error and with sentences on stderr. A table comes out with as many rows as were read. What is
read steers no terminal, and nothing long is repeated whole. What a closed stdout loses is said.

python -m tests.fuzz kill [RUNS [FIRST]] has runs that write a file get a signal at a random instant, some of
them two. The file is then as it was, or whole, and but for SIGKILL nothing is left beside it.
"""

import csv
import gzip
import io
import json
import os
import re
import signal
import subprocess
import sys
import time
import traceback
import warnings
import zipfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import chdir, contextmanager, redirect_stderr, redirect_stdout
from decimal import Decimal
from fractions import Fraction
from functools import cache, partial
from itertools import pairwise
from math import inf, nan
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from typing import Any
from unicodedata import category
from unittest.mock import patch

import numpy as np
import polars as pl
import typer

from atwood_cli import SceneError, cli, solve, solve_arrays
from atwood_cli.model.quantities import NAMES
from atwood_cli.model.scene import INPUTS, MASSES, MEASURED
from atwood_cli.model.units import UNITS
from atwood_cli.tables.sources import FORMATS
from atwood_cli.tradeoff import measure

from .running import hearing

LIMIT = 120  # seconds, for a run that waits
BUSY = 15  # seconds of processor time, for any run
MOST_SAID = 2000  # characters of a sentence
STATUSES = (0, 1, 2, 130)
COMMANDS: dict[str, Any] = cli.program().commands
WEIGHTS = {"solve": 40, "contact": 20, "sweep": 20, "batch": 20, "fit": 20, "tradeoff": 1}
RARE = {"--figure": 0.02, "--help": 0.01, "--explain": 0.1, "--digits": 0.3}
CLOSED = 0.005
"""How often stdout is closed, for which a process is needed."""
OFTEN = {"--wrap": 0.2, "--m1": 0.97, "--m2": 0.97, "--M": 0.6, "--mu": 0.6}

GOOD = "1 3 2 0.3 10 0.25 1.5e-3 100 0.1 90 180 4 0.5".split()
FREE = "1 3 2.5 0.3 1e-300 1e300 1.0000000000000001 0.99 1e-9 7e463".split()
EDGES = [
    *"0 -0 -1 inf -inf INF nan 1e500 1e-500 1e501 1e-501 1e9999999 1e308 1.8e308 4.9e-324 1e-400 .5 5. +2".split(),
    *"1e 1e+ 0x10 1_000 1,5 1,000 1.2.3 １ ٣ −1 ½ -- - = : ( ) ± % '' \" \\ moon disk hoop None".split(),
    *(
        "",
        " ",
        " 1 ",
        "1\xa0kg",
        "\x1b[31m",
        "\udcff",
        "1\n",
        "1\t2",
        "9" * 1000,
        "9" * 1001,
        "0." + "3" * 500,
        "1" * 100_000,
        "1 kg" + "*st^9" * 20_000,
        "1kg" + " t^9/ug^9" * 5,
    ),
]
SOME_UNITS = "kg g lb t mg µg m cm mm in ft deg rad turn ° % s ms N m/s2 m/s² x µ kgg".split()
OF_METAVAR = {
    **{name.split()[-1].upper(): list(units) for name, units in UNITS.items()},
    "FORCE": [*UNITS["force"], *UNITS["torque"]],
}
"""Units by the metavar of an option."""
UNCERTAIN = "175(7)|180(3)|90+/-2|540±0.5|1.5(1)rad|0.5(1)turn|1(1)|179.9(2)|360(1)|0.1(1)".split("|")
HOSTILE = ["\x1b[31mRED", "\x1b]0;a\x07", "\x9b31mred", "a\x85b", "\u202edrow", "\u2066a", "a\u2028b", "\x7f"]
LONG = [
    "x" * 100_000,
    "9" * 100_000,
    "1" + "kg " * 30_000,
    "--" + "m1" * 50_000,
    "1(" * 50_000,
    "m1:" * 30_000,
]
TEXTS = [*"x µ =1+1 regime tension_1 ' \" , ;".split(), "", "a b", "M (kg)", "m1 ", "\t", *HOSTILE]
FILES = [
    "in.csv",
    "a",
    *(f"a.{kind}" for kind in (*FORMATS, "svg", "json", "txt")),
    "-",
    "no/a.svg",
    "\x1b.csv",
]
COUNTS = "1 2 5 17 33 40 100 0 -1 10000001 1.5".split()
SHAPES = "{} {} {}{u} {}_{u} {}+/-{} {}({}) {}±{} {}:{}:{} {}:{}:5:log {}/{} -{}".split()
ODD_VALUES: list[Any] = [
    *(None, True, 1 + 2j, "x", b"1", [], [1, 2], {}, object(), nan, inf, -inf, 5e-324, 1e308, 10**400, -1, 0),
    *(Decimal("sNaN"), Decimal("1e400"), Decimal("Infinity"), Fraction(1, 3), np.float32(0.1), np.int64(2)),
    *(np.datetime64("2020"), np.timedelta64(1, "s"), np.ma.masked, np.array(2.0), np.array([1.0, nan, 0.0])),
    *(
        np.ma.array([1.0, 2.0, 3.0], mask=[False, True, False]),
        np.array([(1.0,)], dtype=[("a", float)]),
        [[1], [2, 3]],
    ),
]


class Dice(Random):
    """Some runs are to get far, in others much is wrong."""

    def __init__(self, run: int) -> None:
        super().__init__(run)
        self.odd = self.choice([0.0, 0.03, 0.2])
        self.given = self.choice([0.04, 0.1, 0.2])

    def is_odd(self) -> bool:
        return self.random() < self.odd


def number(random: Dice) -> str:
    """A number as it may be typed, mostly one that is."""
    if not random.is_odd():
        return random.choice(GOOD if random.random() < 0.7 else FREE)
    text = random.choice(EDGES)
    if random.random() < 0.5:
        exponent = random.choice([0, 3, 20, 300, 500]) * random.choice([1, -1])
        text = f"{random.randrange(10 ** random.choice([1, 3, 20]))}e{exponent}"
    shape = random.choice(SHAPES).replace("_", " ")
    return shape.format(text, random.choice(GOOD), random.choice(GOOD), u=random.choice(SOME_UNITS))


def with_unit(random: Dice, metavar: str) -> str:
    """A number with a unit of what is measured."""
    return f"{random.choice(GOOD)}{random.choice(['', ' '])}{random.choice(OF_METAVAR[metavar])}"


def value(random: Dice, command: str, metavar: str) -> list[str]:
    """What may stand behind an option."""
    if metavar == "FILE NAME":
        return [*value(random, command, "FILE"), *value(random, command, "NAME")]
    if random.random() < random.odd / 5:
        return [random.choice([*EDGES, *TEXTS, *LONG])]
    if metavar in ("FILE", "OUT"):
        return [random.choice(FILES)]
    if metavar == "NAME":
        return [random.choice([*NAMES, *MEASURED, "ordinary", "accel"])]
    if metavar == "N":
        return [random.choice(COUNTS)]
    if "|" in metavar:
        return [random.choice(metavar.split("|"))]
    if command == "sweep" and random.random() < 0.3:
        ends = [with_unit(random, metavar) if metavar in OF_METAVAR else number(random) for _ in range(2)]
        return [f"{ends[0]}:{ends[1]}:{random.choice('1234')}{random.choice(['', ':log'])}"]
    if command == "solve" and random.random() < (0.5 if metavar == "ANGLE" else 0.05):
        return [
            random.choice(UNCERTAIN)
            if metavar == "ANGLE"
            else f"{random.choice(GOOD)}({random.randint(1, 30)})"
        ]
    if metavar in OF_METAVAR and random.random() < 0.1:
        return [with_unit(random, metavar)]
    return [number(random)]


def command_line(random: Dice) -> list[str]:
    """A command with options, nearly all of them its own."""
    command = random.choices(list(WEIGHTS), list(WEIGHTS.values()))[0]
    words = []
    for param in COMMANDS[command].get_params(typer.Context(COMMANDS[command])):
        flag = random.choice(param.opts)
        while random.random() < OFTEN.get(param.opts[0], RARE.get(param.opts[0], random.given)):
            is_flag = getattr(param, "is_flag", False)
            words.append([flag, *([] if is_flag else value(random, command, param.metavar or ""))])
            if not getattr(param, "multiple", False) and random.random() < 0.99:
                break
    random.shuffle(words)
    if command == "batch":
        sources = [*(f"in.{kind}" for kind in FORMATS), "-", "in"]
        words.append([random.choice(sources)])
    if command == "fit":
        words.append([random.choice(["in.csv"] * 8 + ["in.tsv", "-", "in"])])
    line = [command, *(word for option in words for word in option)]
    if random.random() < random.odd / 3:
        line.insert(
            random.randrange(len(line)),
            random.choice([*EDGES, *TEXTS, *LONG, "--m", "-m1", "-h", "--version"]),
        )
    return line


def table(random: Dice, kind: str) -> bytes:
    """A table of scenes, more or less whole."""
    columns = [name for name in INPUTS if name in MASSES or random.random() < 0.2]
    columns += [name for name in (*TEXTS, "mu_K", "a", "time") if random.is_odd()]
    random.shuffle(columns)
    rows = [
        [number(random) if name in INPUTS else random.choice(TEXTS) for name in columns]
        for _ in range(random.choice([0, 1, 2, 5, 30]))
    ]
    kind = random.choice(FORMATS) if random.is_odd() else kind
    if kind == "parquet":
        buffer = io.BytesIO()
        texts = [[cell.encode("utf-8", "replace").decode() for cell in row] for row in rows]
        frame = pl.DataFrame({name: [row[i] for row in texts] for i, name in enumerate(columns)})
        frame.cast(random.choice([pl.String, pl.Float64]), strict=False).write_parquet(buffer)
        data = bytearray(buffer.getvalue())
    else:
        separator = random.choice(",\t;|") if random.is_odd() else {"tsv": "\t"}.get(kind, ",")
        lines = [separator.join(row) for row in [columns, *rows]]
        if kind == "ndjson":
            lines = [json.dumps(dict(zip(columns, row, strict=True))) for row in rows]
        end = random.choice(["\r\n", "\n\n", "\r"]) if random.is_odd() else "\n"
        text = random.choice(["", "\ufeff"]) + end.join(lines) + random.choice(["", end])
        data = bytearray(text.encode("utf-8", "replace"))
    while data and random.is_odd():
        at = random.randrange(len(data))
        data[at : at + random.choice([0, 1, 5])] = random.randbytes(random.choice([0, 1, 3]))
    return otherwise(random, bytes(data))


def otherwise(random: Dice, data: bytes) -> bytes:
    """A table, at times as no table is read."""
    if not random.is_odd():
        return data
    text = data.decode("utf-8", "replace")
    wide = random.choice(["utf-16", "utf-16-le", "utf-16-be", "utf-32", "latin-1"])
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as book:
        book.writestr(zipfile.ZipInfo("xl/worksheets/sheet1.xml"), data)
    return random.choice([gzip.compress(data, mtime=0), text.encode(wide, "replace"), packed.getvalue()])


HEADINGS = (
    'M|time 2|a1|m1 (g)|t/s|u(a)|±|u (%)|Δm|m1+m2|h_cm|Team|T1||Run 1: Time (s)|a (m/s²) Run #1|"m1\n(g)"|u(((|'
    "u(u(a))|+/-|/|a/(|Zeit"
).split("|")
AROUND = [[line] * bool(line) for line in '||||# about|Lab 3|sep=;|sep=,|;;;|,,|5" drop|Mean,,'.split("|")]


def table_of_runs(random: Dice) -> bytes:
    """A table of runs of one pulley and axle, more or less whole and true."""
    c, f, timed = random.random(), random.random(), random.random() < 0.5
    names = ["m1", "m2", "time" if timed else "a", *["drop"] * (random.random() < 0.5)]
    names += [random.choice([*TEXTS, *HEADINGS]) for _ in range(2) if random.is_odd()]
    rows = []
    for _ in range(random.choice([1, 2, 3, 5, 30])):
        l = 1 + random.random()
        h = l + 0.1 + random.choice([0.01, 1, 1, 1]) * random.random()
        a = (9.80665 * (h - l) - f) / (h + l + c) + random.gauss(0, random.choice([0, 0.01, 0.3]))
        measured = abs(2 / a) ** 0.5 if timed else a
        numbers = [*random.choice([[l, h], [l, h], [h, l]]), measured, 1.0, 1.0, 1.0][: len(names)]
        spread = random.choice(["", "", "+/-0.01"])
        rows.append([number(random) if random.is_odd() else f"{cell!r}{spread}" for cell in numbers])
        rows[-1] = [
            random.choice(TEXTS) if name in TEXTS else cell
            for name, cell in zip(names, rows[-1], strict=True)
        ]
    separator = random.choice(",;\t")
    table = [separator.join(row) for row in [names, *rows]]
    table = [*random.choice(AROUND), *table, *random.choice(AROUND)]
    text = "\n".join(table).encode(random.choice(["utf-8"] * 8 + ["cp1252"] * 2), "replace")
    return otherwise(random, text)


@contextmanager
def limited() -> Iterator[None]:
    """Raises TimeoutError in what takes longer than `LIMIT` or `BUSY`, where the system has alarms."""
    if not hasattr(signal, "setitimer"):
        yield
        return

    def ring(number: int, _: object) -> None:
        taken = f"{BUSY} s of processor time" if number == signal.SIGPROF else f"{LIMIT} s"
        raise TimeoutError(f"it takes more than {taken}")

    timers = ((signal.ITIMER_REAL, signal.SIGALRM, LIMIT), (signal.ITIMER_PROF, signal.SIGPROF, BUSY))
    before = [signal.signal(number, ring) for _, number, _ in timers]
    for timer, _, seconds in timers:
        signal.setitimer(timer, seconds)
    try:
        yield
    finally:
        for (timer, number, _), handler in zip(timers, before, strict=True):
            signal.setitimer(timer, 0)
            signal.signal(number, handler)


def wrong_with_line(words: Sequence[str]) -> str:
    """What is wrong with a run of the program, here; nothing if it ends as it should."""
    out, err = (io.TextIOWrapper(io.BytesIO(), "utf-8", "surrogateescape", newline="") for _ in range(2))
    with (
        open("in.csv", encoding="utf-8", errors="replace") as stdin,
        redirect_stdout(out),
        redirect_stderr(err),
        patch("sys.stdin", stdin),
    ):
        status = cli.run(list(words))
    printed, said = (stream.detach().getvalue().decode("utf-8", "replace") for stream in (out, err))
    if status not in STATUSES:
        return f"status {status}"
    partly = words[0] == "batch" or "--only" in words  # rows that failed, values that do not exist
    if printed and (status == 2 or (status == 1 and not partly)):
        return f"status {status} beside {printed[:80]!r} on stdout"
    if strange := [line for line in said.splitlines() if not re.match("atwood: .", line)]:
        return f"on stderr: {strange[0]!r}"
    if status and not said:
        return f"status {status} without a word"
    if "\x1b" in said:
        return f"an escape sequence on stderr: {said!r}"
    if long := [line for line in said.splitlines() if len(line) > MOST_SAID]:
        return f"{len(long[0])} characters in a line of stderr: {long[0]!r:.99}"
    if steers := _steering(printed) if words[0] != "batch" and not {"--csv", "--markdown"} & {*words} else "":
        return f"{steers!r} on stdout, which steers a terminal"
    counted = re.search(r"^atwood: (\d+) rows?: ", said, re.MULTILINE)
    if counted and _rows_out(words, printed) not in (None, int(counted[1])):
        return f"{_rows_out(words, printed)} rows came out of {counted[1]}"
    if (
        words[0] != "batch"
        and status == 0
        and "--json" in words
        and not {"-h", "--help", "-o", "--output"} & {*words}
    ):
        json.loads(printed, parse_constant=lambda word: 1 / 0)
    return ""


def _steering(text: str) -> str:
    """What is in a page that no page has: controls, and marks that turn the direction of words."""
    return "".join({c for c in text if category(c) in ("Cc", "Cf") and c != "\n"})


def wrong_with_closed(words: Sequence[str]) -> str:
    """What is wrong with a run whose stdout is closed: its result is lost, and it should say so."""
    if any("\0" in word for word in words):
        return ""
    command = ["sh", "-c", 'exec "$@" >&-', "sh", sys.executable, "-m", "atwood_cli", *words]
    with open("in.csv", "rb") as stdin:
        ran = subprocess.run(
            command, stdin=stdin, stderr=subprocess.PIPE, env=ENVIRONMENT, timeout=LIMIT, check=False
        )
    said = ran.stderr.decode("utf-8", "replace")
    if ran.returncode not in STATUSES or "Traceback" in said:
        return f"status {ran.returncode}, and on stderr {said[-2000:]!r}"
    elsewhere = {"-o", "--output", "-h", "--help", "-V", "--version"} & {*words}
    if ran.returncode == 0 and not elsewhere:
        return f"status 0, though stdout is closed; on stderr {said!r}"
    return ""


def _rows_out(words: Sequence[str], printed: str) -> int | None:
    """How many rows a run printed; None where that cannot be told."""
    if {"-o", "--output"} & {*words}:
        return None
    source = next((word for word in words if word in ("-", "in") or word.startswith("in.")), "-")
    kinds = [after for word, after in pairwise(words) if word == "--from"] or [source.rpartition(".")[2]]
    if kinds == ["ndjson"]:
        return printed.count("\n")
    if kinds[0] not in ("csv", "-"):
        return None
    return sum(1 for row in csv.reader(io.StringIO(printed, newline="")) if row) - 1


def wrong_with_arguments(random: Dice) -> str:
    """What is wrong with a call from Python: all but results and errors that are promised."""

    def odd(good: float) -> Any:
        if random.random() < good:
            return random.choice([float, str, Decimal])(random.choice(GOOD))
        return random.choice([*ODD_VALUES, *EDGES, [float(random.choice(GOOD)) for _ in range(3)]])

    def call(function: Callable[..., object], more: dict[str, Any], names: Sequence[str]) -> str:
        given = {name: odd(0.8) for name in names if name in ("m1", "m2") or random.random() < 0.3} | more
        try:
            function(**given)
        except SceneError as error:
            str(error)
        except Exception as error:
            if not (isinstance(error, ValueError) and "broadcast" in str(error)):
                return f"{function.__name__}(**{given!r}): {traceback.format_exc()}"
        return ""

    if random.random() < 0.5:
        return call(
            solve, random.choice([{}, {"digits": random.choice([3, 30, *ODD_VALUES])}]), [*INPUTS, *MEASURED]
        )
    accuracy = random.choice(["fast", "certified", "exact", "x", None])
    quantities = random.choice([None, random.sample(NAMES, 3), ["x"], []])
    return call(solve_arrays, {"accuracy": accuracy, "quantities": quantities}, [*INPUTS])


ENVIRONMENT = {**os.environ, "PYTHONPATH": str(Path(cli.__file__).parents[2])}
KILLED_BY = {"SIGINT": 130, "SIGTERM": 143, "SIGHUP": 129, "SIGKILL": -9}
KILLED = [
    "batch in.csv -o out.csv",
    "batch in.ndjson -o out.ndjson",
    "batch in.parquet -o out.parquet --accuracy exact",
    "sweep --m1 1 --m2 3 --M 1:100:2000 -o out.csv",
    "sweep --m1 1 --m2 3 --M 1:100:20 -o out.json",
    "sweep --m1 1 --m2 3 --M 1:100:20 --figure out.svg",
    "contact --m1 1 --m2 3 --mu 0.3 --figure out.svg",
]


def start(line: str) -> "subprocess.Popen[bytes]":
    """A run of the program, here, which hears no signal before its own handlers are there."""
    scenes = pl.DataFrame({"m1": [1.0] * 50_000, "m2": [3.0] * 50_000, "n": range(50_000)})
    scenes.write_csv("in.csv")
    scenes.write_ndjson("in.ndjson")
    scenes.write_parquet("in.parquet")
    return hearing(*line.split(), "--force", env=ENVIRONMENT)


@cache
def whole(line: str) -> tuple[bytes, float]:
    """What a run writes that is left alone, and how long it takes."""
    with TemporaryDirectory() as folder, chdir(folder):
        begun = time.perf_counter()
        start(line).communicate()
        taken = time.perf_counter() - begun
        (out,) = Path().glob("out.*")
        return out.read_bytes(), taken


def wrong_with_killed(run: int) -> str:
    """What is wrong once the run of that number got its signals, and the run itself."""
    random = Dice(run)
    line, blow = random.choice(KILLED), random.choice(list(KILLED_BY))
    whole_file, seconds = whole(line)
    out = Path(next(word for word in line.split() if word.startswith("out.")))
    before = random.choice([None, b"as it was"])
    if before is not None:
        out.write_bytes(before)
    delays = [random.uniform(0, 1.2 * seconds), *random.choice([[], [random.uniform(0, 0.02)]])]
    child = start(line)
    for delay in delays:
        time.sleep(delay)
        child.send_signal(signal.Signals[blow])
    _, said = child.communicate(timeout=LIMIT)
    left = {path.name for path in Path().iterdir()} - {"in.csv", "in.ndjson", "in.parquet", str(out)}
    after = out.read_bytes() if out.exists() else None
    wrong = ""
    if child.returncode not in (0, KILLED_BY[blow]):
        wrong = f"status {child.returncode}, and on stderr {said!r}"
    elif after not in (before, whole_file) or (child.returncode == 0 and after != whole_file):
        wrong = f"{out} is neither as it was nor whole"
    elif left and not (blow == "SIGKILL" and all(name.startswith(".atwood-") for name in left)):
        wrong = f"there are {left} beside it"
    elif any(not line.startswith(b"atwood: ") for line in said.splitlines()):
        wrong = f"on stderr: {said!r}"
    return wrong and f"run {run}, {line} and {blow} after {delays} s: {wrong}"


def wrong_with(run: int) -> str:
    """What is wrong with the run of that number, and the run itself."""
    random = Dice(run)
    if random.random() < 0.2:
        what, try_it = "a call", partial(wrong_with_arguments, random)
    else:
        words = command_line(random)
        for kind in FORMATS:
            made = table(random, kind) if words[0] == "batch" else b""
            Path(f"in.{kind}").write_bytes(table_of_runs(random) if words[0] == "fit" else made)
        what, try_it = (
            repr([word if len(word) < 1100 else f"{word[:50]}..." for word in words]),
            partial(wrong_with_line, words),
        )
        if random.random() < CLOSED and os.name == "posix":
            what, try_it = f"{what} >&-", partial(wrong_with_closed, words)
    try:
        with limited():
            wrong = try_it()
    except BaseException as error:
        if isinstance(error, KeyboardInterrupt):
            raise
        wrong = traceback.format_exc()
    return wrong and f"run {run}, {what}: {wrong}"


def faults(runs: Sequence[int], wrong_with: Callable[[int], str] = wrong_with) -> Iterator[str]:
    """What is wrong with runs, each in a folder of its own; measurements are cut short."""
    short = patch.multiple(measure, RUN_SECONDS=1e-5, REPEATS=1, MOST_SCENES=20, MOST=2)
    for run in runs:
        with TemporaryDirectory() as folder, chdir(folder), short, warnings.catch_warnings():
            warnings.simplefilter("always")
            if wrong := wrong_with(run):
                yield wrong


def main(runs: int = 1000, first: int = 0, wrong_with: Callable[[int], str] = wrong_with) -> int:
    """Report every fault; the status says whether there is one."""
    count = 0
    for fault in faults(range(first, first + runs), wrong_with):
        print(fault, flush=True)
        count += 1
    print(f"{runs} runs, {count} faults")
    return min(count, 1)


if __name__ == "__main__":
    os.environ.pop("COLUMNS", None)
    typed = sys.argv[1:]
    what = wrong_with_killed if typed[:1] == ["kill"] else wrong_with
    numbers = dict(zip(("runs", "first"), map(int, typed[what is wrong_with_killed :]), strict=False))
    sys.exit(main(**numbers, wrong_with=what))
