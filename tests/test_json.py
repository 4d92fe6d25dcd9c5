"""What `--json` prints has the keys, types and units of `examples/json.md`, and no others."""

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from atwood_cli import solve
from atwood_cli.laboratory import published as laboratory
from atwood_cli.model.quantities import QUANTITIES
from atwood_cli.model.scene import parameter_of

from .running import Atwood
from .scenes import inputs

TOP = Path(__file__).parent.parent
PAGE = (TOP / "examples" / "json.md").read_text(encoding="utf-8")
ROW = r"^\| `(.*?)` \| (.*?) \| (.*?) \| (.*?) \| (.*?) \|$"
SECTIONS = {
    title: {key: rest for key, *rest in re.findall(ROW, text, re.MULTILINE)}
    for title, text in re.findall(r"^## (.*)\n((?:(?!## ).*\n)*)", PAGE, re.MULTILINE)
}
TYPES = {
    "number": (int, float),
    "integer": (int,),
    "text": (str,),
    "boolean": (bool,),
    "object": (dict,),
    "list": (list,),
}
NAMED = {
    "solve": {r"^(uncertainty|budget)\.\w+": r"\1.NAME", r"^(budget\.NAME)\.\w+": r"\1.INPUT"},
    "sweep": {r"^(rows\[\])\.\w+": r"\1.NAME"},
    "fit": {r"^(uncertainty|interval)\.\w+": r"\1.NAME", r"^runs\[\]\.shift$": "runs[].LABEL"},
}
"""Of a command, the keys that are names of quantities, of inputs, or of a file."""
PRINTED = {
    "solve": [
        "--m1 1 --m2 3 --mu 0.3",
        "--m1 1.0(1) --m2 3 --M 10 --mu 0.3 --mu-k 0.2 --R 5cm --axle 1mNm --wrap 3rad --budget",
        "--m1 1 --m2 3 --drop 1 --time 1",
        "--m1 0.1 --m2 0.4 --M inf --a 2.141",
        "--m1 1 --M 10 --a 2 --inertia hoop",
    ],
    "sweep": ["--m1 1 --m2 3 --M 1,inf", "--m1 1 --m2 3 --mu 0.3 --wrap 1rad:2rad:2 --g 1:2:2 --only regime"],
    "contact": ["--m1 1 --m2 3 --mu 0.3", "--m1 1 --m2 3 --M inf --R 1 --axle 1N --points 2"],
    "fit": ["{rit} --drop 98cm", "{labelled} --R 1 --g 9.8"],
    "quantities": [""],
    "tradeoff": ["--family ordinary --scenes 5"],
}


def keys(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Every value below this one, with the way to it: points[].angle."""
    below: Any = value.items() if isinstance(value, dict) else ()
    for key, one in below:
        way = f"{path}.{key}".lstrip(".")
        yield way, one
        yield from keys(one, way)
    for one in value if isinstance(value, list) else ():
        yield f"{path}[]", one
        yield from keys(one, f"{path}[]")


@pytest.mark.parametrize("command", PRINTED)
def test_every_key_is_on_the_page_and_of_its_type(
    atwood: Atwood, tmp_path: Path, command: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("atwood_cli.tradeoff.measure.REPEATS", 1)
    labelled = tmp_path / "runs.csv"
    labelled.write_text("shift,m1,m2,a\nday,1,2,2.4\nday,1,3,3.9\nnight,2,3,1.6\nnight,1,4,4.9\n")
    page = SECTIONS[command] | (
        SECTIONS["The scene"] if command not in ("fit", "quantities", "tradeoff") else {}
    )
    top, found = [], set()
    for words in PRINTED[command]:
        words = f"{command} {words} --json".format(rit=TOP / "examples" / "rit.csv", labelled=labelled)
        ran = atwood(*words.split())
        assert ran.err == ""
        result = json.loads(ran.out)
        assert result["version"] == 2
        top.append(list(result))
        for key, value in keys(result):
            for named, name in NAMED.get(command, {}).items():
                key = re.sub(named, name, key)
            found.add(key)
            assert key in page, key
            kinds, _, _, null = page[key]
            kinds += " or text" * (command == "sweep" and key.startswith("scene."))  # a range
            allowed = [kind for name in kinds.split(" or ") for kind in TYPES[name]]
            assert type(value) in allowed or (value is None and null), (words, key, value)
    assert found == page.keys()
    assert all(one == top[0] for one in top)


def test_units_and_meanings_are_those_of_tables_and_help() -> None:
    solved = SECTIONS["solve"]
    for name, about in QUANTITIES.items():
        assert solved[name][1:3] == [about.unit, about.meaning]
    for name, quantity in laboratory.QUANTITIES.items():
        assert SECTIONS["fit"][name][1] == quantity.unit
    for key, (_, unit, meaning, _) in SECTIONS["The scene"].items():
        if key != "scene":
            parameter = parameter_of(key.removeprefix("scene."))
            assert (unit, meaning) == (parameter.unit, parameter.meaning)


@pytest.mark.parametrize(
    "given", ["m1=1 m2=3 mu=0.3", "m1=1.0(1) m2=3 a=2 drop=1", "m1=0.1 m2=0.4 M=inf a=2.141"]
)
def test_to_dict_has_the_keys_that_json_has(atwood: Atwood, given: str) -> None:
    typed = ["solve", *(word for one in given.split() for word in f"--{one}".split("=")), "--json"]
    assert list(solve(**inputs(given)).to_dict()) == list(json.loads(atwood(*typed).out))


def test_only_prints_its_keys_alone(atwood: Atwood) -> None:
    for words, keys in (
        ("solve --m1 1 --m2 3", ["tension_1"]),
        ("solve --m1 1.0(1) --m2 3", ["tension_1", "uncertainty"]),
    ):
        assert list(json.loads(atwood(*words.split(), "--only", "tension_1", "--json").out)) == keys
