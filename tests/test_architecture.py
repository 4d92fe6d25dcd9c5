"""The folders are the architecture: which may import which, without a circle, and no module unseen."""

import ast
import re
from collections.abc import Iterator
from graphlib import TopologicalSorter
from pathlib import Path

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
