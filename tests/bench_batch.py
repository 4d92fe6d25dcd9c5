"""A million scenes, CSV to CSV, beside DuckDB and mawk: python -m tests.bench_batch [PAIRS] [ROWS]

Those do the paper's formulas as they stand. The same scenes go from NDJSON to NDJSON too. Whole processes in turn, A B C A B C ...; what counts is
the median of the ratios, round by round, and the largest memory of any run.
"""

import random
import statistics
import subprocess
import sys
import tempfile
import time
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
    """Seconds, and the peak memory in MB."""
    from os import wait4

    start = time.perf_counter()
    child = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, cwd=TOP)
    _, status, usage = wait4(child.pid, 0)
    assert status == 0, command
    return time.perf_counter() - start, usage.ru_maxrss // 1024


def main(rounds: int, rows: int) -> None:
    if find_spec("duckdb") is None or which("mawk") is None:
        sys.exit("this measures beside duckdb and mawk: pip install duckdb, and mawk of your system")
    with tempfile.TemporaryDirectory() as folder:
        scenes, out, program = (Path(folder, name) for name in ("scenes.csv", "out.csv", "naive.awk"))
        write_scenes(scenes, rows)
        program.write_text(MAWK)
        lines, lines_out = scenes.with_suffix(".ndjson"), out.with_suffix(".ndjson")
        pl.read_csv(scenes).write_ndjson(lines)
        atwood = [sys.executable, "-m", "atwood_cli", "batch", "--force"]
        commands = {
            "atwood": [*atwood, str(scenes), "-o", str(out)],
            "atwood, NDJSON": [*atwood, str(lines), "-o", str(lines_out)],
            "duckdb": [sys.executable, "-c", DUCKDB, str(scenes), str(out)],
            "mawk": ["sh", "-c", 'mawk -f "$0" "$1" > "$2"', str(program), str(scenes), str(out)],
        }
        for command in commands.values():
            run(command)
        turns = [{name: run(command) for name, command in commands.items()} for _ in range(rounds)]
    for name in commands:
        seconds = statistics.median(turn[name][0] for turn in turns)
        ratio = statistics.median(turn["atwood"][0] / turn[name][0] for turn in turns)
        memory = max(turn[name][1] for turn in turns)
        print(f"{name}: {seconds:.2f} s, {memory} MB; atwood takes {ratio:.2f} of its time")


if __name__ == "__main__":
    main(*(int(word) for word in [*sys.argv[1:], *["7", "1000000"][len(sys.argv) - 1 :]]))
