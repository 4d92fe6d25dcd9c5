"""A million scenes, CSV to CSV, beside polars, DuckDB and mawk: python -m tests.bench_batch [ROUNDS] [ROWS]

Those do the paper's formulas as they stand. The same scenes go from NDJSON to NDJSON too, and one scene goes
from CSV to CSV. Whole processes in turn, A B C A B C ...: processor time, and the largest memory of any run.
"""

import random
import statistics
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path
from shutil import which

import polars as pl

TOP = Path(__file__).parent.parent

DUCKDB = """
import duckdb, sys
duckdb.sql(f'''
    copy (
        select *, ln(t2 / t1) / pi() as mu_verge, mu / sqrt(1 + mu * mu) * (t1 + t2) as friction_force,
            4 * m1 * m2 * (k - 1) / (m2 - m1 * k) as critical_pulley_mass,
            case when ln(t2 / t1) / pi() > mu then 'slip' else 'no-slip' end as regime
        from (
            select m1, m2, M, mu, (m2 - m1) * 9.80665 / (m1 + m2 + M / 2) as acceleration,
                (2 * m2 + M / 2) * m1 * 9.80665 / (m1 + m2 + M / 2) as t1,
                (2 * m1 + M / 2) * m2 * 9.80665 / (m1 + m2 + M / 2) as t2, exp(mu * pi()) as k
            from read_csv('{sys.argv[1]}')
        )
    ) to '{sys.argv[2]}' (header, delimiter ',')
''')
"""
POLARS = """
import polars as pl, sys
from math import pi

m1, m2, M, mu, t1, t2 = map(pl.col, ("m1", "m2", "M", "mu", "t1", "t2"))
k, load = (mu * pi).exp(), m1 + m2 + M / 2
verge = (t2 / t1).log() / pi
pl.scan_csv(sys.argv[1]).with_columns(
    acceleration=(m2 - m1) * 9.80665 / load,
    t1=(2 * m2 + M / 2) * m1 * 9.80665 / load,
    t2=(2 * m1 + M / 2) * m2 * 9.80665 / load,
).with_columns(
    mu_verge=verge,
    friction_force=mu / (1 + mu * mu).sqrt() * (t1 + t2),
    critical_pulley_mass=4 * m1 * m2 * (k - 1) / (m2 - m1 * k),
    regime=pl.when(verge > mu).then(pl.lit("slip")).otherwise(pl.lit("no-slip")),
).sink_csv(sys.argv[2])
"""
MAWK = r"""
BEGIN { FS = OFS = ","; OFMT = CONVFMT = "%.17g"; pi = 3.141592653589793; g = 9.80665 }
NR == 1 { print $0, "acceleration,t1,t2,k,mu_verge,friction_force,critical_pulley_mass,regime"; next }
{
    d = $1 + $2 + $3 / 2; t1 = (2 * $2 + $3 / 2) * $1 * g / d; t2 = (2 * $1 + $3 / 2) * $2 * g / d
    k = exp($4 * pi); verge = log(t2 / t1) / pi
    print $0, ($2 - $1) * g / d, t1, t2, k, verge, $4 / sqrt(1 + $4 * $4) * (t1 + t2), \
        4 * $1 * $2 * (k - 1) / ($2 - $1 * k), (verge > $4 ? "slip" : "no-slip")
}
"""


def write_scenes(path: Path, rows: int) -> None:
    rng = random.Random(2026)
    with path.open("w") as file:
        file.write("m1,m2,M,mu\n")
        for _ in range(rows):
            m1, M, mu = (10 ** rng.uniform(*span) for span in ((-2, 2), (-2, 3), (-2, 0.3)))
            file.write(f"{m1!r},{m1 * (1 + 10 ** rng.uniform(-2, 2))!r},{M!r},{mu!r}\n")


def run(command: list[str]) -> tuple[float, int]:
    """Seconds of processor time, and the peak memory in MB."""
    from os import wait4

    child = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, cwd=TOP)
    _, status, usage = wait4(child.pid, 0)
    assert status == 0, command
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss // 1024


def main(rounds: int, rows: int) -> None:
    with tempfile.TemporaryDirectory() as folder:
        scenes, one, out, program = (
            Path(folder, name) for name in ("scenes.csv", "1.csv", "out.csv", "naive.awk")
        )
        write_scenes(scenes, rows)
        write_scenes(one, 1)
        program.write_text(MAWK)
        lines, lines_out = scenes.with_suffix(".ndjson"), out.with_suffix(".ndjson")
        pl.read_csv(scenes).write_ndjson(lines)
        atwood = [sys.executable, "-m", "atwood_cli", "batch", "--force"]
        commands = {
            "atwood": [*atwood, str(scenes), "-o", str(out)],
            "atwood, NDJSON": [*atwood, str(lines), "-o", str(lines_out)],
            "polars": [sys.executable, "-c", POLARS, str(scenes), str(out)],
            "duckdb": [sys.executable, "-c", DUCKDB, str(scenes), str(out)],
            "mawk": ["sh", "-c", 'mawk -f "$0" "$1" > "$2"', str(program), str(scenes), str(out)],
            "atwood, one row": [*atwood, str(one), "-o", str(out)],
            "polars, one row": [sys.executable, "-c", POLARS, str(one), str(out)],
        }
        for name, there in (("duckdb", find_spec("duckdb")), ("mawk", which("mawk"))):
            if not there:
                print(f"{name} is not installed: it is left out")
                del commands[name]
        for command in commands.values():
            run(command)
        turns = [{name: run(command) for name, command in commands.items()} for _ in range(rounds)]
    for name in commands:
        seconds, least = (of(turn[name][0] for turn in turns) for of in (statistics.median, min))
        memory = max(turn[name][1] for turn in turns)
        print(f"{name}: {seconds:.2f} s, at least {least:.2f} s, {memory} MB")


if __name__ == "__main__":
    main(*(int(word) for word in [*sys.argv[1:], *["7", "1000000"][len(sys.argv) - 1 :]]))
