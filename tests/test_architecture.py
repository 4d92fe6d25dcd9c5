"""The folders are the architecture: which may import which, without a circle; and each error is expected by a test."""

import ast
import re
from collections.abc import Iterator
from graphlib import TopologicalSorter
from importlib import import_module
from pathlib import Path

from .tools.regenerate import CASES
from .tools.running import TOP

PATHS = {
    ".".join(path.relative_to(TOP).with_suffix("").parts).removesuffix(".__init__"): path
    for path in (TOP / "atwood_cli").rglob("*.py")
}
MAY_IMPORT = {
    "": "",
    "numbers": "",
    "solver": "numbers",
    "reading": "numbers solver",
    "explain": "numbers solver reading",
    "tables": "numbers solver reading",
    "arrays": "numbers solver reading",
    "output": "numbers solver reading explain",
    "api": "numbers solver reading explain output",
    "batch": "numbers solver reading explain arrays tables output",
    "sweep": "numbers solver reading explain output",
    "laboratory": "numbers solver reading explain tables output",
    "tradeoff": "numbers solver reading explain arrays output api",
    "cli": "numbers solver reading explain tables output batch sweep laboratory tradeoff",
    "__main__": "cli",
}
"""What each folder, or module at the top, may import beside itself."""


def statements(tree: ast.AST) -> Iterator[ast.AST]:
    """All of them, those within functions too, but what stands under `if TYPE_CHECKING`."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            node = ast.Module(node.orelse, [])
        yield node
        yield from statements(node)


def imports(module: str, path: Path) -> Iterator[str]:
    """The modules of ours that a module imports."""
    package = module.split(".") if path.name == "__init__.py" else module.split(".")[:-1]
    for node in statements(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name in PATHS)
        elif isinstance(node, ast.ImportFrom):
            within = package[: len(package) + 1 - node.level] if node.level else []
            origin = ".".join([*within, *([node.module] if node.module else [])])
            for alias in node.names:
                if (name := f"{origin}.{alias.name}") in PATHS or (name := origin) in PATHS:
                    yield name


def place(module: str) -> str:
    """The folder of a module, or its own name at the top."""
    return module.split(".")[1] if "." in module else ""


IMPORTS = {module: set(imports(module, path)) for module, path in PATHS.items()}


def test_every_module_is_seen() -> None:
    assert {place(module) for module in PATHS} == set(MAY_IMPORT)
    importing = {place(module) for module, imported in IMPORTS.items() if imported}
    assert importing == set(MAY_IMPORT) - {""}
    assert "atwood_cli.arrays.rows" in IMPORTS["atwood_cli.arrays"]  # by name
    assert "atwood_cli.solver.physics" in IMPORTS["atwood_cli.solver.machine"]  # from a package
    assert "atwood_cli.cli" in IMPORTS["atwood_cli.__main__"]  # within a function


def test_imports_point_up_the_table() -> None:
    version = ("atwood_cli.cli", "atwood_cli")
    for module, imported in ((module, one) for module, imports in IMPORTS.items() for one in imports):
        allowed = (place(module), *MAY_IMPORT[place(module)].split())
        assert place(imported) in allowed or (module, imported) == version


def test_no_import_comes_back() -> None:
    TopologicalSorter(IMPORTS).prepare()  # raises CycleError, which names the circle


def test_packages_hold_nothing_but_their_docstring() -> None:
    for module, path in PATHS.items():
        if path.name == "__init__.py" and place(module) not in ("", "arrays", "laboratory", "cli"):
            tree = ast.parse(path.read_text(encoding="utf-8"))
            assert [type(node) for node in tree.body] == [ast.Expr], module
            assert ast.get_docstring(tree), module


def closure(module: str) -> set[str]:
    """A module and all that it imports, directly or not."""
    reached, waiting = set[str](), [module]
    while waiting:
        if (name := waiting.pop()) not in reached:
            reached.add(name)
            waiting += IMPORTS[name]
    return reached


def test_one_scene_is_solved_by_what_the_map_says_to_read() -> None:
    """In so many lines; a measured motion and uncertainties stand behind that, and nothing there reads text."""
    section = (TOP / "atwood_cli" / "README.md").read_text(encoding="utf-8").split("\n## ")[1]
    rows = re.findall(r"^\| (`.*?) \|", section, re.MULTILINE)
    read = [(row.split("/")[0].lstrip("`"), name) for row in rows for name in re.findall(r"(\w+)\.py", row)]
    modules = [f"atwood_cli.{folder}.{name}" for folder, name in read]
    assert sorted(modules) == sorted(closure("atwood_cli.solver.answers"))
    lines = sum(len(PATHS[module].read_text(encoding="utf-8").splitlines()) for module in modules)
    (said,) = re.findall(r"about ([\d,]+) lines", section)
    assert abs(lines - int(said.replace(",", ""))) <= 100
    for module, path in PATHS.items():
        if place(module) == "solver":
            text = path.read_text(encoding="utf-8")
            assert not re.search(r"--[a-z]", text), module  # it knows no option
            nodes = [*ast.walk(ast.parse(text))]
            names = {node.id for node in nodes if isinstance(node, ast.Name)}
            names |= {alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names}
            assert not names & {"re", "sys", "json", "print", "open", "numpy"}, module


# Every error text is a test: what the package can say is looked up in what the tests expect

SENTENCES = "SceneError Malformed Rule Unreadable OSError FileExistsError ArithmeticError ask".split()


def fragments(node: ast.AST) -> list[str]:
    """The constant texts within an expression."""
    values = (part.value for part in ast.walk(node) if isinstance(part, ast.Constant))
    return [value for value in values if isinstance(value, str)]


def errors() -> Iterator[tuple[str, str]]:
    """Where an error is made, and the longest text in it that does not depend on what was given."""
    for module, path in PATHS.items():
        calls = ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        for node in (node for node in calls if isinstance(node, ast.Call) and node.args):
            if (kind := getattr(node.func, "id", "")) in SENTENCES:
                rule = node.args[min(2, len(node.args) - 1)] if kind in ("SceneError", "Rule") else node
                texts = fragments(rule)
                if isinstance(rule, ast.Name):
                    texts = [str(getattr(import_module(module), rule.id, ""))]
                if text := max(texts, key=len, default="").strip(" ;:,."):
                    yield f"{module}: {node.lineno}", text


def test_every_error_text_is_expected_by_a_test() -> None:
    sources = (ast.parse(path.read_text(encoding="utf-8")) for path in (TOP / "tests").glob("test_*.py"))
    expected = [text for source in sources for text in fragments(source)]
    expected += [page.read_text(encoding="utf-8") for page in CASES]
    made = list(errors())
    assert len(made) > 60
    # Nothing that could be wrong is given to tradeoff.
    assert {place(where) for where, _ in made} >= {*MAY_IMPORT} - {"", "api", "__main__", "tradeoff"}
    assert [one for one in made if not any(one[1] in text for text in expected)] == [], "is tried by no test"
