"""Every error text is a test: what the package can say is looked up in what the tests expect."""

import ast
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path

import atwood_cli

from .tools.regenerate import CASES

PACKAGE, TESTS = Path(atwood_cli.__file__).parent, Path(__file__).parent
SENTENCES = "SceneError Malformed Rule Unreadable OSError FileExistsError ArithmeticError ask".split()


def fragments(node: ast.AST) -> list[str]:
    """The constant texts within an expression."""
    values = (part.value for part in ast.walk(node) if isinstance(part, ast.Constant))
    return [value for value in values if isinstance(value, str)]


def errors() -> Iterator[tuple[str, str]]:
    """Where an error is made, and the longest text in it that does not depend on what was given."""
    for path in sorted(PACKAGE.rglob("*.py")):
        module = ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts).removesuffix(".__init__")
        calls = ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        for node in (node for node in calls if isinstance(node, ast.Call) and node.args):
            if (kind := getattr(node.func, "id", "")) in SENTENCES:
                rule = node.args[min(2, len(node.args) - 1)] if kind in ("SceneError", "Rule") else node
                texts = fragments(rule)
                if isinstance(rule, ast.Name):
                    texts = [str(getattr(import_module(module), rule.id, ""))]
                if text := max(texts, key=len, default="").strip(" ;:,."):
                    yield f"{path.relative_to(PACKAGE).as_posix()}:{node.lineno}", text


def test_every_error_text_is_expected_by_a_test() -> None:
    sources = (ast.parse(path.read_text(encoding="utf-8")) for path in TESTS.glob("test_*.py"))
    expected = [text for source in sources for text in fragments(source)]
    expected += [page.read_text(encoding="utf-8") for page in CASES]
    made = list(errors())
    assert len(made) > 60
    folders = {path.name for path in PACKAGE.iterdir() if path.is_dir() and path.name != "__pycache__"}
    without = {"tradeoff"}  # it is given nothing that could be wrong
    assert {where.split("/")[0] for where, _ in made if "/" in where} == folders - without
    assert [one for one in made if not any(one[1] in text for text in expected)] == [], "is tried by no test"
