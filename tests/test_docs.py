"""What the README and the examples show is run, and must come out as shown."""

import doctest
import os
import re
import runpy
from collections import Counter
from math import inf, nan
from pathlib import Path
from shutil import which
from typing import Any

import numpy as np
import polars as pl
import pytest

from atwood_cli import REGIMES, SceneError, fit, solve, solve_arrays, solve_table
from atwood_cli.reading.units import UNITS
from atwood_cli.solver.scene import BODIES
from atwood_cli.tradeoff.measure import FAMILIES, SETTINGS
from atwood_cli.tradeoff.tradeoff_page import COLUMNS, LEGEND

from .tools.regenerate import KEPT, SCRIPTS, answered, denied, essence
from .tools.running import TOP, labels, process

PAGES = {
    path.relative_to(TOP).as_posix(): path.read_text(encoding="utf-8")
    for path in (
        TOP / "README.md",
        *sorted((TOP / "examples").glob("*.md")),
        TOP / "atwood_cli" / "README.md",
        TOP / "tests" / "README.md",
    )
}
README, TRADEOFF = PAGES["README.md"], PAGES["examples/tradeoff.md"]
PYTHON = {
    name: "\n".join(blocks)
    for name, page in PAGES.items()
    if (blocks := re.findall(r"```python\n(.*?)```", page, re.DOTALL))
}


@pytest.mark.filterwarnings("error::RuntimeWarning")  # of NumPy, which a user would read on stderr
@pytest.mark.parametrize("file", dict.fromkeys(kept.file for kept in KEPT), ids=lambda file: file.name)
def test_what_is_kept_is_what_is_printed_today(file: Path, pytestconfig: pytest.Config) -> None:
    lacking = {kept.lacks for kept in KEPT if kept.file == file and kept.lacks}
    lacking |= {"matplotlib"} if pytestconfig.getoption("quick") else set()
    tried = [kept for kept in KEPT if kept.file == file and kept.needs not in lacking]
    for kept in tried:
        assert essence(kept.today()) == essence(kept.text), "after a look: python -m tests.tools.regenerate"
        assert not [*denied(kept.text)]
    if not tried:
        pytest.skip(f"needs {' '.join(lacking)}, or no --quick")


def test_a_value_that_the_oracle_denies_is_not_written() -> None:
    """A wrong value of a fall passed once it was accepted."""
    assert [*denied("$ atwood solve --m1 1 --m2 3\nnote: torque = 1 N m.\n")]  # it has none without R
    for words in ("", " --json", " --only T1,fall_time", " --markdown | grep T", " --digits 3"):
        right = answered(f"$ atwood solve --m1 1 --m2=3 --M 10 --drop 2{words}")
        assert "11.9" in right or "12.0" in right
        assert not [*denied(right)]
        assert len([*denied(re.sub("11.9|12.0", "11.8", right))]) == 1
        assert len([*denied(right.replace("1.35", "1.36"))]) == ("grep" not in words)


@pytest.mark.parametrize("name", PYTHON)
def test_the_python_in_the_pages_runs(name: str) -> None:
    examples = doctest.DocTestParser().get_doctest(PYTHON[name], {}, name, name, 0)
    assert len(examples.examples) >= 4
    report: list[str] = []
    result = doctest.DocTestRunner().run(examples, out=report.append)
    assert result.failed == 0, "".join(report)


def taken_by(door: str, column: Any) -> str:
    """What a door makes of the second cell of a column of M, or of times."""
    fall = {"m1": [0.1] * 4, "m2": [0.12, 0.14, 0.16, 0.18], "t1": [2.05, 1.46, 1.21, 1.06]}
    try:
        if door == "fit":
            repeats = [fit({**fall, "t2": [*more, 1.2, 1.05]}, drop=1) for more in (column, [2.06, None])]
            return "not given" if repeats[0] == repeats[1] else "given"
        if door == "solve":
            return "not given" if solve(1, 3, M=[*column][1], mu=0.3).regime == "verge" else "given"
        if door == "solve_arrays":
            results = solve_arrays(1, 3, M=column, mu=0.3)
            missing, failed = REGIMES[results["regime"][1]] == "verge", results["status"][1] > 0
        else:
            pandas = hasattr(column, "isna")
            frame = column.to_frame("M").assign(m1=1, m2=3, mu=0.3) if pandas else pl.DataFrame({"M": column})
            frame = frame if pandas else frame.with_columns(m1=1, m2=3, mu=0.3)
            row = [*solve_table(frame, ["regime"])["regime"]], [*solve_table(frame)["error"]]
            missing, failed = row[0][1] == "verge", "must be" in str(row[1][1])
        return "error of its row" if failed else "not given" if missing else "given"
    except SceneError:
        return "error"


def test_every_door_takes_missing_values_as_the_page_says() -> None:
    """On `examples/programs.md`, below "What is a missing value?"."""
    pd = pytest.importorskip("pandas")
    missing, doors = "not given", ("solve", "solve_arrays", "solve_table", "fit")
    nulls = [
        *([2.06, None], pl.Series([2.06, None])),
        *(pd.Series([2.06, pd.NA], dtype=kind) for kind in ("Float64", object)),
    ]
    kinds: list[tuple[list[Any], tuple[str, ...]]] = [
        (nulls, (missing,) * 4),
        ([np.ma.masked_less([2.06, 1.2], 2)], (missing, missing, "", missing)),
        ([pd.Series([2.06, nan])], ("", missing, missing, missing)),
        (
            [[2.06, nan], np.array([2.06, nan]), pl.Series([2.06, nan])],
            ("error", "error of its row", "error of its row", missing),
        ),
        ([["2.06", word] for word in ("", "NA", "NULL", "null")], ("error", "error", missing, missing)),
    ]
    for columns, outcomes in kinds:
        for door, outcome in zip(doors, outcomes, strict=True):
            assert {taken_by(door, column) for column in columns if outcome} <= {outcome}, (columns, door)


@pytest.mark.skipif(os.name == "nt" or not which("make"), reason="needs make")
def test_the_makefile_keeps_no_table_in_which_a_row_failed(tmp_path: Path) -> None:
    (rules,) = re.findall(r"```make\n(.*?)```", PAGES["examples/programs.md"], re.DOTALL)
    (tmp_path / "makefile").write_text(rules)
    for mass, status in ((3, 0), (-3, 2)):
        (tmp_path / "scenes.csv").write_text(f"m1,m2\n1,{mass}\n")
        ran = process(shell=f'PATH="$(dirname "$PYTHON"):$PATH" make --always-make -C "{tmp_path}"')
        assert (ran.status, (tmp_path / "results.csv").exists()) == (status, not status), ran
    (tmp_path / "cases.csv").write_text("m1,m2,M,mu\n1,3,10,0.2\n")
    ran = process(shell=f'PATH="$(dirname "$PYTHON"):$PATH" make -C "{tmp_path}" judged.csv')
    assert (ran.status, (tmp_path / "judged.csv").read_text().splitlines()[1]) == (
        2,
        "1,3,10,0.2,0.971685949492679,false,",
    )


@pytest.mark.parametrize("name", PAGES)
def test_links_lead_somewhere(name: str) -> None:
    for path, anchor in re.findall(r"\]\((?!https?:)([^#)]*)#?(.*?)\)", PAGES[name]):
        page = (TOP / name).parent / path if path else TOP / name
        assert page.exists(), path
        headings = re.findall(r"^#+ (.*)", page.read_text(encoding="utf-8"), re.MULTILINE) if anchor else ()
        anchors = {re.sub(r"[^\w -]", "", heading).lower().replace(" ", "-") for heading in headings}
        assert not anchor or anchor in anchors, anchor


def test_a_page_leads_to_every_example() -> None:
    kept = {path.name for path in (TOP / "examples").iterdir() if path.is_file()}
    pages = "".join(page for name, page in PAGES.items() if name != "atwood_cli/README.md")
    assert {name for name in kept - {"__init__.py"} if name not in pages} == set()


def test_the_map_names_every_module() -> None:
    """The table of `atwood_cli/README.md`: a folder, its modules, its one job."""
    rows = re.findall(r"^\| (?:top|`(\w+/)`) \| (.*?) \|", PAGES["atwood_cli/README.md"], re.MULTILINE)
    named = {folder + module for folder, modules in rows for module in re.findall(r"`(\w+)`", modules)}
    package = TOP / "atwood_cli"
    modules = {path.relative_to(package).with_suffix("").as_posix() for path in package.rglob("*.py")}
    assert named == {module for module in modules if not module.endswith("/__init__")}


def test_the_page_of_the_tests_names_every_file() -> None:
    named = re.findall(r"`(?:test)?(_\w+)`|`tools/(\w+)[.]py`", PAGES["tests/README.md"])
    files = {path.stem.removeprefix("test") for path in (TOP / "tests").glob("test_*.py")}
    assert files <= {name for name, _ in named}
    assert all((TOP / "tests" / "tools" / f"{tool}.py").exists() for _, tool in named if tool)


def test_the_setup_commands_are_what_the_workflow_runs() -> None:
    """On every Python of the classifiers, and with actions pinned by their commits."""
    commands = re.findall(r"```sh\n(.*)\n```", README)
    assert [command.split()[-1] for command in commands] == ["0.3", "pytest"]
    assert all(command.startswith("python3 -m venv .venv && .venv/bin/pip install") for command in commands)
    workflow, project = ((TOP / name).read_text() for name in (".github/workflows/ci.yml", "pyproject.toml"))
    versions = re.findall(r'Python :: (3[.]\d+)"', project)
    assert sorted(re.findall(r"^ +(3[.]\d+)$", workflow, re.MULTILINE)) == versions
    for command in re.findall(r"```(?:sh|powershell)\n(.*pip install [.](?: .*|;.*))\n```", README):
        assert f"run: {command}\n" in workflow
    assert all(re.search("@[0-9a-f]{40} # v", line) for line in workflow.splitlines() if "uses:" in line)


def test_a_query_keeps_rows_that_are_no_scenes() -> None:
    run = runpy.run_path(str(TOP / "examples" / "polars_lazy.py"))
    frame = pl.LazyFrame(
        {"m1": [1.0, -1.0, nan, inf, None, 1.0, 1.0], "m2": 3.0, "M": 50.0, "mu": [0.3] * 6 + [None]}
    )
    found = run["by_regime"](frame).collect(engine="streaming")
    assert {row["regime"]: row["len"] for row in found.to_dicts()} == {"slip": 2, "no-slip": 1, None: 4}
    assert None not in found.filter(pl.col("regime") == "slip")["acceleration"].to_list()


def test_what_was_measured_is_of_todays_settings() -> None:
    """Times are that day's; the names, the promises and the picture are today's."""
    rows = [[cell.strip() for cell in line.split("│")[1:-1]] for line in TRADEOFF.splitlines() if "│" in line]
    names = [*SETTINGS]
    assert rows[0] == [*COLUMNS]
    assert [row[:2] for row in rows[1:]] == [[family, name] for family in FAMILIES for name in names]
    assert all(f"| {name} | {meaning} |" in TRADEOFF for name, (_, meaning) in FAMILIES.items())
    errors = {name: [float(row[4]) for row in rows if row[1] == name] for name in names}
    assert max(errors["certified"]) <= 2e-14 * 2**53
    assert max(errors["exact"]) <= 0.5
    assert " ".join(LEGEND) in " ".join(TRADEOFF.split())
    picture = labels((TOP / "examples" / "tradeoff.svg").read_text(encoding="utf-8"))
    assert {*names, *FAMILIES} <= set(picture)


def test_a_page_lists_every_unit() -> None:
    for name, units in UNITS.items():
        assert re.search(
            rf"^\| an? {name}.*? \| {', '.join(units)}[ ,]", PAGES["examples/hoist.md"], re.MULTILINE
        ), name
    words = " ".join(PAGES["examples/hoist.md"].split())
    assert ", ".join(f"{body} {gravity}" for body, gravity in BODIES.items()) in words


def test_every_example_is_tested() -> None:
    shown = Counter(kept.file.relative_to(TOP).as_posix() for kept in KEPT)
    assert shown["README.md"] == 3
    assert all(shown[f"examples/{page}.md"] >= 4 for page in ("lesson", "laboratory", "hoist", "programs"))
    assert "examples/programs.md" in PYTHON
    names = "ci-smoke lift measure-mu paper"
    assert [script.stem for script in SCRIPTS] == names.split()
    outputs = {path for suffix in ("txt", "svg") for path in (TOP / "examples").glob(f"*.{suffix}")}
    measured = TOP / "examples" / "tradeoff.svg"
    assert outputs == {kept.file for kept in KEPT if kept.file.suffix != ".md"} | {measured}
