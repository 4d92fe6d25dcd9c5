"""What `--json` prints has the keys, types and units of `examples/json.md`, and no others."""

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from atwood_cli import solve
from atwood_cli.laboratory import results as laboratory
from atwood_cli.solver.quantities import QUANTITIES
from atwood_cli.solver.scene import INPUTS, MEASURED

from .tools.running import TOP, Atwood

PAGE = (TOP / "examples" / "json.md").read_text(encoding="utf-8")
ROW = r"^- `(.*?)` \((.*?)(?:, (.*?))?\): .*?(?:; null: (.*))?$"
SECTIONS = {
    title: {key: about for key, *about in re.findall(ROW, text, re.MULTILINE)}
    for title, text in re.findall(r"^## (.*)\n((?:(?!## ).*\n)*)", PAGE, re.MULTILINE)
}
TYPES = {int: "integer number", float: "number", str: "text", bool: "boolean", dict: "object", list: "list"}
QUANTITY = f"({'|'.join(QUANTITIES)})"
INPUT = f"({'|'.join([*INPUTS, *MEASURED])})"
NAMED = {
    "solve": {
        rf"^{QUANTITY}$": "QUANTITY",
        r"^(uncertainty|budget)\.\w+": r"\1.QUANTITY",
        r"^(budget\.QUANTITY|terms)\.\w+": r"\1.INPUT",
    },
    "sweep": {rf"^(rows\[\])\.{INPUT}$": r"\1.INPUT", r"^(rows\[\])\.(?!expected)[a-z]\w+": r"\1.QUANTITY"},
    "contact": {r"^balance\.(friction|normal|sum|resultant|residual)": "balance.FORCE"},
    "fit": {r"^(uncertainty|interval)\.\w+": r"\1.RESULT"},
}
"""Of a command, the keys that are names of quantities, of inputs, or of a file."""
EVERYWHERE = {"version": ("integer", "", ""), "notes": ("list", "", ""), "notes[]": ("text", "", "")}
PRINTED = {
    "solve": [
        "--m1 1 --m2 3 --mu 0.3",
        "--m1 1.0(1) --m2 3 --M 10 --mu 0.3 --mu-k 0.2 --R 5cm --axle 1mNm --wrap 3rad --budget",
        "--m1 1 --m2 3 --drop 1 --time 1",
        "--m1 0.1 --m2 0.4 --M inf --a 2.141",
        "--m1 1 --M 10 --a 2 --inertia hoop",
        "--m1 20N --M 1 --R 5cm --speed 40rad/s --time 2",
    ],
    "sweep": [
        "--m1 1 --m2 3 --M 1,inf",
        "--m1 1 --m2 3 --M 1,inf --mu 9 --expect no-slip",
        "--m1 1 --m2 3 --mu 0.3 --wrap 1rad:2rad:2 --g 1:2:2 --only regime",
    ],
    "contact": ["--m1 1 --m2 3 --mu 0.3", "--m1 1 --m2 3 --M inf --R 1 --axle 1N --points 2"],
    "fit": ["{rit} --drop 98cm", "{labelled} --R 1 --g 9.8"],
}


def keys(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Every value below this one, with the way to it: points[].angle."""
    items = isinstance(value, list) and [("[]", item) for item in value]
    for key, below in value.items() if isinstance(value, dict) else items or ():
        way = f"{path}.{key}".replace(".[]", "[]").lstrip(".")
        yield way, below
        yield from keys(below, way)


@pytest.mark.parametrize("command", PRINTED)
def test_every_key_is_on_the_page_and_of_its_type(atwood: Atwood, tmp_path: Path, command: str) -> None:
    labelled = tmp_path / "runs.csv"
    labelled.write_text("shift,m1,m2,a\nday,1,2,2.4\nday,1,3,3.9\nnight,2,3,1.6\nnight,1,4,4.9\n")
    page = EVERYWHERE | SECTIONS[command]
    top, found = [], set()
    for words in PRINTED[command]:
        words = f"{command} {words} --json".format(rit=TOP / "examples" / "rit.csv", labelled=labelled)
        ran = atwood(*words.split())
        assert ran.err == ""
        result = json.loads(ran.out)
        assert result["version"] == 3
        top.append(list(result))
        for key, value in keys(result):
            key = re.sub(r"^scene\.\w+", "scene.INPUT", key)
            for named, name in NAMED[command].items():
                key = re.sub(named, name, key)
            found.add(key)
            assert key in page, key
            kinds, _, null = page[key]
            kinds += " or text" * (command == "sweep" and key.startswith("scene."))  # a range
            fits = {*kinds.split(" or ")} & {*TYPES.get(type(value), "").split()}
            assert fits or (value is None and null), (words, key, value)
    assert found == page.keys()
    for name in page.keys() & laboratory.QUANTITIES.keys() if command == "fit" else ():
        assert page[name][1] == laboratory.QUANTITIES[name].unit
    assert all(one == top[0] for one in top)


def test_keys_of_the_short_lists(atwood: Atwood, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("atwood_cli.tradeoff.measure.REPEATS", 1)
    for command in ("quantities", "tradeoff --family ordinary --scenes 5"):
        result = json.loads(atwood(*command.split(), "--json").out)
        (listed,) = (items for items in result.values() if isinstance(items, list))
        section = PAGE.split(f"\n## {command.split()[0]}\n")[1].split("\n## ")[0]
        assert {*result, *(key for item in listed for key in item)} == {*re.findall(r"`(\w+)`", section)}


def test_what_no_double_holds_is_text_in_python() -> None:
    """JSON has a number for it, which `json` would read as infinite."""
    scene = solve(m1=1, m2=3, M="1e400").to_dict()["scene"]
    assert (scene["M"], scene["m2"]) == ("1e400", 3.0)
