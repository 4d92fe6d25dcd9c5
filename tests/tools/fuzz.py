"""What may be typed or read, drawn by Hypothesis: command lines, and tables that are hardly any."""

import gzip
import io
import json
from collections.abc import Sequence
from functools import partial
from random import Random
from typing import Any, NamedTuple, TypeVar

import polars as pl
import typer
from hypothesis import strategies as st

from atwood_cli import cli
from atwood_cli.reading.units import UNITS
from atwood_cli.solver.quantities import NAMES
from atwood_cli.solver.scene import INPUTS, MASSES, MEASURED
from atwood_cli.tables.sources import FORMATS

T = TypeVar("T")
COMMANDS: dict[str, Any] = cli.program().commands
PARAMS = {name: command.get_params(typer.Context(command)) for name, command in COMMANDS.items()}
SHARES = {"--m1": 0.97, "--m2": 0.97, "--M": 0.6, "--mu": 0.6, "--digits": 0.3, "--wrap": 0.2}
SHARES |= {"--explain": 0.1, "--figure": 0.02, "--help": 0.01}
"""The shares of runs with an option; up to three others are as frequent as another."""

GOOD = "1 3 2 0.3 10 0.25 1.5e-3 100 0.1 90 180 4 0.5".split()
FREE = "1 3 2.5 0.3 1e-300 1e300 1.0000000000000001 0.99 1e-9 7e463".split()
# fmt: off
EDGES = [
    *"0 -0 -1 inf -inf INF nan 1e500 1e-500 1e501 1e-501 1e9999999 1e308 1.8e308 4.9e-324 1e-400 .5 5. +2".split(),
    *"1e 1e+ 0x10 1_000 1,5 1,000 1.2.3 １ ٣ −1 ½ -- - = : ( ) ± % '' \" \\ moon disk hoop None".split(),
    *("", " ", " 1 ", "1\xa0kg", "\x1b[31m", "\udcff", "1\n", "1\t2", "0." + "3" * 500, "1kg" + " t^9/ug^9" * 5),
    *(unit * 9_999 for unit in ("(", "1/", "1(2)", "1,", "a_", '"', "kg*", "m1 in ")),
    *("9" * 1001, "1" * 100_000, "m1:" * 30_000, "--" + "m1" * 50_000, "1 kg" + "*st^9" * 20_000),
]
SOME_UNITS = "kg g lb t mg µg m cm mm in ft deg rad turn ° % s ms N m/s2 m/s² x µ kgg".split()
OF_METAVAR = {name.split()[-1].upper(): list(units) for name, units in UNITS.items()}
OF_METAVAR["FORCE"] += UNITS["torque"]
"""Units by the metavar of an option."""
UNCERTAIN = "175(7)|180(3)|90+/-2|540±0.5|1.5(1)rad|0.5(1)turn|1(1)|179.9(2)|360(1)|0.1(1)".split("|")
HOSTILE = ["\x1b[31mRED", "\x1b]0;a\x07", "\x9b31mred", "a\x85b", "\u202edrow", "\u2066a", "a\u2028b", "\x7f"]
TEXTS = [*"x µ =1+1 regime tension_1 ' \" , ;".split(), "", "a b", "M (kg)", "m1 ", "\t", *HOSTILE]
FILES = ["in.csv", "a", *(f"a.{kind}" for kind in (*FORMATS, "svg", "json", "txt")), "-", "no/a.svg", "\x1b.csv"]
COUNTS = "1 2 5 17 33 40 100 0 -1 10000001 1.5".split()
WORDS = {"FILE": FILES, "OUT": FILES, "NAME": [*NAMES, *MEASURED, "ordinary", "accel"], "N": COUNTS}
"""What may stand behind an option, by its metavar, besides numbers."""
SHAPES = "{} {} {}{u} {}_{u} {}+/-{} {}({}) {}±{} {}:{}:{} {}:{}:5:log {}/{} -{}".split()
HEADINGS = 'M|time 2|a1|m1 (g)|t/s|u(a)|±|u (%)|Δm|m1+m2|h_cm|Team|T1||Run 1: Time (s)|a (m/s²) Run #1|"m1\n(g)"'.split("|")
HEADINGS += "u(((|u(u(a))|+/-|/|a/(|Zeit".split("|")
AROUND = '||||# about|Lab 3|sep=;|sep=,|;;;|,,|5" drop|Mean,,'.split("|")
# fmt: on
class Run(NamedTuple):
    """A command line, and the file `in.csv` or another that it may read."""

    words: list[str]
    source: str
    content: bytes


class Dice:
    """Choices that Hypothesis makes, the first and the usual where it can. In some runs much is odd."""

    def __init__(self, draw: st.DrawFn, odd: Sequence[float] = (0.0, 0.03, 0.2)) -> None:
        self.draw = draw
        self.odd = self.choice(odd)

    def choice(self, values: Sequence[T]) -> T:
        return self.draw(st.sampled_from(values))

    def chance(self, share: float) -> bool:
        return share > 0 and self.draw(st.integers(0, 999)) >= 1000 * (1 - share)

    def is_odd(self) -> bool:
        return self.chance(self.odd)

    def number(self) -> str:
        """A number as it may be typed, mostly one that is."""
        if not self.is_odd():
            return self.choice([*GOOD, *GOOD, *FREE])
        text = self.choice(EDGES)
        if self.chance(0.5):
            text = f"{self.draw(st.integers(0, 10**20))}e{self.choice([0, 3, -3, 20, 300, -300, 500, -500])}"
        shape = self.choice(SHAPES).replace("_", " ")
        return shape.format(text, self.choice(GOOD), self.choice(GOOD), u=self.choice(SOME_UNITS))

    def with_unit(self, metavar: str) -> str:
        return self.choice(GOOD) + self.choice(["", " "]) + self.choice(OF_METAVAR[metavar])

    def value(self, command: str, metavar: str) -> list[str]:
        if metavar == "FILE NAME":
            return [*self.value(command, "FILE"), *self.value(command, "NAME")]
        if self.chance(self.odd / 5):
            return [self.choice([*EDGES, *TEXTS])]
        if words := WORDS.get(metavar, metavar.split("|") if "|" in metavar else []):
            return [self.choice(words)]
        if command == "sweep" and self.chance(0.3):
            ends = [self.with_unit(metavar) if metavar in OF_METAVAR else self.number() for _ in range(2)]
            return [f"{':'.join(ends)}:{self.choice('1234')}{self.choice(['', ':log'])}"]
        if command == "solve" and self.chance(0.5 if metavar == "ANGLE" else 0.05):
            digits = self.draw(st.integers(1, 30))
            return [self.choice(UNCERTAIN if metavar == "ANGLE" else [f"{x}({digits})" for x in GOOD])]
        if metavar in OF_METAVAR and self.chance(0.1):
            return [self.with_unit(metavar)]
        return [self.number()]

    def options(self, command: str) -> list[list[str]]:
        params = {param.opts[0]: param for param in PARAMS[command] if param.param_type_name == "option"}
        usual = [name for name, share in SHARES.items() if name in params and self.chance(share)]
        others = st.sampled_from([name for name in params if name not in SHARES])
        names = [*usual, *self.draw(st.lists(others, max_size=3, unique=True))]
        words = []
        for name in [*names, *names[-1:] * self.chance(0.1)]:  # the last may be there twice
            param = params[name]
            behind = "" if getattr(param, "is_flag", False) else param.metavar or ""
            words.append([self.choice(param.opts), *(self.value(command, behind) if behind else [])])
        return words

    def scenes(self, kind: str) -> bytes:
        """A table of scenes, more or less whole."""
        inputs = [name for name in INPUTS if name in MASSES or self.chance(0.2)]
        others = [name for name in (*TEXTS, "mu_K", "a", "time") if self.is_odd()]
        columns = self.draw(st.permutations(inputs + others))
        row = [self.number if name in INPUTS else partial(self.choice, TEXTS) for name in columns]
        rows = [[cell() for cell in row] for _ in range(self.choice([1, 0, 2, 5, 30]))]
        kind = self.choice(FORMATS) if self.is_odd() else kind
        if kind == "parquet":
            buffer = io.BytesIO()
            texts = [[cell.encode("utf-8", "replace").decode() for cell in row] for row in rows]
            frame = pl.DataFrame({name: [row[i] for row in texts] for i, name in enumerate(columns)})
            frame.cast(self.choice([pl.String, pl.Float64]), strict=False).write_parquet(buffer)
            return buffer.getvalue()
        if kind == "ndjson":
            objects = [[json.dumps(dict(zip(columns, row, strict=True)))] for row in rows]
            return self.text(objects, "").encode("utf-8", "replace")
        separator = self.choice(",\t;|") if self.is_odd() else {"tsv": "\t"}.get(kind, ",")
        return self.text([columns, *rows], separator).encode("utf-8", "replace")

    def text(self, rows: Sequence[Sequence[str]], separator: str) -> str:
        end = self.choice(["\r", "\n\n"]) if self.is_odd() else self.choice(["\n", "\n", "\r\n"])
        lines = end.join(separator.join(row) for row in rows)
        return self.choice(["", "\ufeff"]) + lines + end * self.choice([1, 0, 2])

    def runs(self) -> bytes:
        """A table of runs of one pulley and axle, more or less whole and true."""
        timed = self.chance(0.5)
        names = ["m1", "m2", "time" if timed else "a", *["drop"] * self.chance(0.5)]
        names += [self.choice([*TEXTS, *HEADINGS]) for _ in range(2) if self.is_odd()]
        true = Random(self.draw(st.integers(0, 10**6)))
        c, f, scatter = true.random(), true.random(), self.choice([0, 0.01, 0.3])
        rows = []
        for _ in range(self.choice([1, 2, 3, 5, 30])):
            l = 1 + true.random()
            h = l + 0.1 + true.choice([0.01, 1, 1, 1]) * true.random()
            a = (9.80665 * (h - l) - f) / (h + l + c) + true.gauss(0, scatter)
            masses = [h, l] if true.random() < 0.3 else [l, h]
            numbers = [*masses, abs(2 / a) ** 0.5 if timed else a, 1.0, 1.0, 1.0][: len(names)]
            spread = true.choice(["", "", "+/-0.01"])
            row = [self.number() if self.is_odd() else f"{cell!r}{spread}" for cell in numbers]
            pairs = zip(names, row, strict=True)
            rows.append([self.choice(TEXTS) if name in TEXTS else cell for name, cell in pairs])
        separator = self.choice(",;\t")
        table = [self.choice(AROUND), *(separator.join(row) for row in [names, *rows]), self.choice(AROUND)]
        return "\n".join(filter(None, table)).encode(self.choice(["utf-8"] * 8 + ["cp1252"] * 2), "replace")

    def broken(self, content: bytes) -> bytes:
        """A table, at times cut, changed, packed, or written in another encoding."""
        data = bytearray(content)
        while data and self.is_odd():
            at = self.draw(st.integers(0, len(data) - 1))
            data[at : at + self.choice([0, 1, 5])] = self.draw(st.binary(max_size=3))
        if not self.is_odd():
            return bytes(data)
        wide = self.choice(["utf-16", "utf-16-le", "utf-16-be", "utf-32", "latin-1"])
        text = data.decode("utf-8", "replace").encode(wide, "replace")
        return self.choice([gzip.compress(data, mtime=0), text, b"PK\x03\x04" + data])


@st.composite
def runs(draw: st.DrawFn, command: str) -> Run:
    """A command with options, nearly all of them its own, and what it may read."""
    dice = Dice(draw)
    words = dice.options(command)
    source, content = "in.csv", b""
    if command in ("batch", "fit"):
        kinds = [f"in.{kind}" for kind in FORMATS] if command == "batch" else ["in.csv"] * 8 + ["in.tsv"]
        source = dice.choice([*kinds, "-", "in"])
        words.append([source])
        kind = source.rpartition(".")[2] if "." in source else "csv"
        content = dice.broken(dice.scenes(kind) if command == "batch" else dice.runs())
    line = [command, *(word for option in draw(st.permutations(words)) for word in option)]
    if dice.chance(dice.odd / 3):
        place = draw(st.integers(0, len(line)))
        line.insert(place, dice.choice([*EDGES, *TEXTS, "--m", "-m1", "-h", "--version"]))
    return Run(line, source if source != "-" else "in.csv", content)
