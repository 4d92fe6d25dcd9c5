"""Atwood's machine with a massive pulley and a rough string, every digit right."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .api import Solution, solve
    from .arrays import STATUSES, solve_arrays
    from .batch.frames import solve_table
    from .laboratory import Fit, fit
    from .model.quantities import REGIMES
    from .model.scene import Scene, SceneError

__all__ = [
    "REGIMES",
    "STATUSES",
    "Fit",
    "Scene",
    "SceneError",
    "Solution",
    "fit",
    "solve",
    "solve_arrays",
    "solve_table",
]
__version__ = "0.1.0"

_HOMES = {
    "REGIMES": "model.quantities",
    "STATUSES": "arrays",
    "Fit": "laboratory",
    "Scene": "model.scene",
    "SceneError": "model.scene",
    "Solution": "api",
    "fit": "laboratory",
    "solve": "api",
    "solve_arrays": "arrays",
    "solve_table": "batch.frames",
}


def __getattr__(name: str) -> Any:
    """Import one of the names above when it is first used.

    So the command line starts before they are there, and can catch Ctrl-C while they load.
    """
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    value = globals()[name] = getattr(import_module(f".{_HOMES[name]}", __name__), name)
    return value


def __dir__() -> set[str]:
    """The names that a shell completes: all names above, whether they were used or not."""
    return {*globals(), *__all__}
