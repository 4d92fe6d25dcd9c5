"""What the README and the examples show is run, and must come out as shown."""

import doctest
import os
import re
import runpy
from collections import Counter
from math import inf, nan
from pathlib import Path

import pytest

from atwood_cli.model.scene import Scene
from atwood_cli.tradeoff.measure import SETTINGS, March, Measured, counts
from atwood_cli.tradeoff.outcome import PAPERS_SCENE, Tradeoff, legend
from atwood_cli.tradeoff.scenes import FAMILIES

from .regenerate import ENGINES, KEPT, SCRIPTS, TOP, Kept, essence, printed
from .running import labels, process

PAGES = {
    path.relative_to(TOP).as_posix(): path.read_text(encoding="utf-8")
    for path in (
        TOP / "README.md",
        *sorted((TOP / "examples").glob("*.md")),
        TOP / "atwood_cli" / "README.md",
    )
}
README, TOUR, TRADEOFF = (PAGES[name] for name in ("README.md", "examples/README.md", "examples/tradeoff.md"))
PYTHON = {
    name: "\n".join(blocks)
    for name, page in PAGES.items()
    if (blocks := re.findall(r"```python\n(.*?)```", page, re.DOTALL))
}


@pytest.mark.parametrize("kept", KEPT, ids=lambda kept: f"{kept.file.name}: {kept.text[:60]!r}")
def test_what_is_kept_is_what_is_printed_today(kept: Kept) -> None:
    if kept.file.stem == "dask_tables":
        pytest.importorskip("distributed")
    assert essence(kept.today()) == essence(kept.text), "after a look: python -m tests.regenerate"


@pytest.mark.parametrize("name", PYTHON)
def test_the_python_in_the_pages_runs(name: str) -> None:
    examples = doctest.DocTestParser().get_doctest(PYTHON[name], {}, name, name, 0)
    assert len(examples.examples) >= 4
    report: list[str] = []
    result = doctest.DocTestRunner().run(examples, out=report.append)
    assert result.failed == 0, "".join(report)


def test_transcripts_and_python_are_found_in_the_pages() -> None:
    shown = Counter(kept.file.relative_to(TOP).as_posix() for kept in KEPT)
    assert shown["README.md"] == 2
    assert shown["examples/laboratory.md"] >= 4
    assert shown["examples/README.md"] >= 15
    assert list(PYTHON) == ["README.md", "examples/README.md"]
    assert len(TASKS) == 4


def anchors(page: Path) -> set[str]:
    headings = re.findall(r"^#+ (.*)", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w -]", "", heading).lower().replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("name", PAGES)
def test_links_lead_somewhere(name: str) -> None:
    for target in re.findall(r"\]\((?!https?:)(.*?)\)", PAGES[name]):
        path, _, anchor = target.partition("#")
        page = (TOP / name).parent / path if path else TOP / name
        assert page.exists(), target
        assert not anchor or anchor in anchors(page), target


TASKS = re.findall(r"^\| [^|]+ \| `(atwood .*?)` \| (.*) \|$", README, re.MULTILINE)


@pytest.mark.parametrize(("command", "shown"), TASKS, ids=[command for command, _ in TASKS])
def test_the_readmes_tasks_print_what_it_says(command: str, shown: str) -> None:
    out = " ".join(printed(command).split())
    for words in re.findall(r"""`(.*?)`|"(.*?)\"""", shown):
        assert "".join(words) in out


def test_the_tour_leads_to_every_example() -> None:
    kept = {path.name for path in (TOP / "examples").iterdir() if path.is_file()}
    assert {name for name in kept - {"README.md", "__init__.py"} if name not in TOUR} == {
        "tradeoff.svg",  # on its own page
    }


def test_the_map_names_every_module() -> None:
    """The table of `atwood_cli/README.md`: a folder, its modules, its one job."""
    rows = re.findall(r"^\| (?:top|`(\w+/)`) \| (.*?) \|", PAGES["atwood_cli/README.md"], re.MULTILINE)
    named = {folder + module for folder, modules in rows for module in re.findall(r"`(\w+)`", modules)}
    package = TOP / "atwood_cli"
    modules = {path.relative_to(package).with_suffix("").as_posix() for path in package.rglob("*.py")}
    assert named == {module for module in modules if not module.endswith("/__init__")}


def test_both_setup_commands_are_there() -> None:
    commands = re.findall(r"```sh\n(.*)\n```", README)
    assert [command.split()[-1] for command in commands] == ["0.3", "pytest"]
    assert all(command.startswith("python3 -m venv .venv && .venv/bin/pip install") for command in commands)


def test_engines_keep_rows_that_are_no_scenes() -> None:
    import dask.array as da
    import polars as pl

    bad = [-1.0, nan, inf]
    for script in ENGINES:
        if script.stem == "dask_tables":  # which a cluster runs, below
            continue
        run = runpy.run_path(str(script))
        if "by_regime" in run:
            frame = pl.LazyFrame(
                {"m1": [1.0, *bad, None, 1.0, 1.0], "m2": 3.0, "M": 50.0, "mu": [0.3] * 6 + [None]}
            )
            found = run["by_regime"](frame).collect(engine="streaming")
            assert {row["regime"]: row["len"] for row in found.to_dicts()} == {
                "slip": 2,
                "no-slip": 1,
                None: 4,
            }
            assert None not in found.filter(pl.col("regime") == "slip")["acceleration"].to_list()
        else:
            M, mu = da.ma.masked_equal(da.array([50.0, 10.0, -1.0, 7.0]), 7.0), da.array([0.3] * 4)
            assert run["share_of_slip"](M, mu) == 0.5
    with_rows = [path for path in (TOP / "examples").glob("*.py") if "solve_arrays" in path.read_text()]
    with_tables = [path for path in (TOP / "examples").glob("*.py") if "solve_table" in path.read_text()]
    assert sorted({*with_rows, *with_tables}) == sorted(ENGINES)


WORKER_KILLED = """
import os, runpy, signal, sys
from tempfile import TemporaryDirectory
from distributed import Client, LocalCluster, wait
example = runpy.run_path(sys.argv[1])
cluster = LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None)
with TemporaryDirectory() as folder, cluster, Client(cluster) as client:
    example["write_scenes"](folder, 24, 20_000)
    parts = client.compute(example["solved"](folder).to_delayed())
    wait(parts, return_when="FIRST_COMPLETED")
    os.kill(next(iter(client.run(os.getpid).values())), signal.SIGKILL)
    open_parts = sum(part.status == "pending" for part in parts)
    tables = client.gather(parts)
    rows = {M for table in tables for M in table["M"]}
    print(open_parts > 0, sum(map(len, tables)), len(rows), sum(table["error"].notna().sum() for table in tables))
"""


@pytest.mark.skipif(os.name == "nt", reason="needs POSIX signals")
def test_a_cluster_that_loses_a_worker_loses_no_row() -> None:
    pytest.importorskip("distributed")
    pytest.importorskip("dask.dataframe")
    ran = process(str(TOP / "examples" / "dask_tables.py"), code=WORKER_KILLED, PYTHONPATH=str(TOP))
    assert (ran.status, ran.out) == (0, "True 480000 480000 0\n"), ran.err


def test_what_was_measured_is_of_todays_settings() -> None:
    """Times are that day's; the names, the promises and the picture are today's."""
    measured = TRADEOFF.split("<!-- python -m examples.speed writes this -->")[1].split("<!-- to here -->")[0]
    rows = [line.strip("| ").split(" | ") for line in measured.splitlines() if line.startswith("| ")]
    assert rows[0] == ["setting", *FAMILIES]
    errors = {
        row[0]: [cell.replace("*", "").split(": ")[1] for cell in row[1:]]
        for row in rows[2 : 2 + len(SETTINGS)]
    }
    assert list(errors) == [setting.name for setting in SETTINGS]
    assert max(map(float, errors["certified"])) <= 4
    assert max(map(float, errors["exact"])) <= 0.5
    marched = [row[0] for row in rows[4 + len(SETTINGS) :]]
    assert marched == [*map(str, counts()), "closed form"]
    picture = labels((TOP / "examples" / "tradeoff.svg").read_text(encoding="utf-8"))
    assert all(picture.count(name) == len(FAMILIES) for name in errors)
    assert set(FAMILIES) <= set(picture)
    screen = measured.split("```text\n$ atwood tradeoff\n")[1].split("```")[0]
    assert max(map(len, screen.splitlines())) <= 100
    words = " ".join(screen.split())
    assert legend(len(FAMILIES)) in words
    assert "Settings that no other beats (--all shows the rest): 500 scenes each of ordinary, " in words
    (advice,) = re.findall(r"Take certified for results within 4 ulp .*?\.(?= Time)", words)
    assert advice in " ".join(" ".join(picture).split())  # the picture's caption


def test_the_measuring_script_fills_its_place() -> None:
    script = runpy.run_path(str(TOP / "examples" / "speed.py"))
    assert script["PLACE"].search(TRADEOFF)

    def run(seconds: float) -> Tradeoff:
        measured = [
            Measured(family, setting.name, seconds, 0.1, off, off, 0.0, 0.0)
            for family in FAMILIES
            for setting in SETTINGS
            for off in [1e-30 if "digits" in setting.name else 1.5]
        ]
        marches = [March(4, False, 1e-5, 0.1, 1e-3), March(None, False, seconds / 20, 0.1, 1e-17, None, True)]
        return Tradeoff(Scene.read(PAPERS_SCENE), 6, 1, measured, marches, [])

    written = script["section"](script["typical"]([run(1e-6), run(2e-7), run(1e-7)]), "a machine")
    assert "![Error against time](tradeoff.svg)\n" in written
    assert ", on a machine; 6 scenes of each family, seed 1; times are medians of 5 runs.\n" in written
    assert (
        "```text\n$ atwood tradeoff\nSettings that no other beats (--all shows the rest): 6 scenes" in written
    )
    assert f"| certified |{' 200 ns: 1.5 |' * len(FAMILIES)}\n" in written
    assert f"| 50 digits |{' 200 ns: **1e-30** |' * len(FAMILIES)}\n" in written
    assert "| closed form | **1.0e-17** |  | 10 ns |  |  |  |\n" in written


def test_every_example_is_tested() -> None:
    names = "capstan ci-smoke lift measure-mu paper scripts sweep"
    assert [script.stem for script in SCRIPTS] == names.split()
    outputs = {path for suffix in ("txt", "svg") for path in (TOP / "examples").glob(f"*.{suffix}")}
    measured = TOP / "examples" / "tradeoff.svg"
    assert outputs == {kept.file for kept in KEPT if kept.file.suffix != ".md"} | {measured}
