"""Every error text is a test: what the package can say is looked up in what the tests expect."""

import ast
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path

import pytest

import atwood_cli

from .regenerate import CASES, KEPT

PACKAGE, TESTS = Path(atwood_cli.__file__).parent, Path(__file__).parent
SENTENCES = ("SceneError", "Malformed", "Rule", "Unreadable", "OSError", "FileExistsError", "ArithmeticError")
NOT_REACHED = {"not settled within": "no scene is known that fifty thousand digits do not settle"}


def fragments(node: ast.AST) -> Iterator[str]:
    """The constant texts within an expression, or within the constant of the module it names."""
    for part in ast.walk(node):
        if isinstance(part, ast.Constant) and isinstance(part.value, str):
            yield part.value


def errors() -> Iterator[tuple[str, str]]:
    """Where an error is made, and the longest text in it that does not depend on what was given."""
    for path in sorted(PACKAGE.rglob("*.py")):
        module = import_module(
            ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts).removesuffix(".__init__")
        )
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if not isinstance(node, ast.Call) or not node.args:
                continue
            kind = getattr(node.func, "id", "")
            if kind in SENTENCES:
                rule = node.args[min(2, len(node.args) - 1)] if kind in ("SceneError", "Rule") else node
                texts = list(fragments(rule))
                if isinstance(rule, ast.Name):
                    texts = [str(getattr(module, rule.id, ""))]
                if text := max(texts, key=len, default="").strip(" ;:,."):
                    yield f"{path.relative_to(PACKAGE).as_posix()}:{node.lineno}", text


EXPECTED = [
    text
    for path in TESTS.glob("test_*.py")
    for text in fragments(ast.parse(path.read_text(encoding="utf-8")))
    if text not in NOT_REACHED
] + [page.read_text(encoding="utf-8") for page in CASES]


def test_errors_are_looked_for_in_every_folder() -> None:
    made = [where for where, _ in errors()]
    assert len(made) > 60
    folders = {path.name for path in PACKAGE.iterdir() if path.is_dir() and path.name != "__pycache__"}
    without = {"tradeoff"}  # it is given nothing that could be wrong
    assert {where.split("/")[0] for where in made if "/" in where} == folders - without


@pytest.mark.parametrize(("where", "text"), list(errors()), ids=lambda word: word[:40])
def test_every_error_text_is_expected_by_a_test(where: str, text: str) -> None:
    if text in NOT_REACHED:
        pytest.skip(NOT_REACHED[text])
    assert any(text in expected for expected in EXPECTED), f"{where} is tried by no test"


def test_a_refusal_is_one_sentence_and_leaves_stdout_empty() -> None:
    refused = [kept.text for kept in KEPT if kept.text.endswith("\n[2]\n")]
    assert len(refused) > 100
    for text in refused:
        _, *printed, _ = text.splitlines()
        assert [line.startswith("atwood: ") for line in printed] == [True], text
