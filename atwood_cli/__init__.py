"""Atwood's machine with a massive pulley and a rough string, every digit right."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .api import solve
    from .arrays import solve_arrays
    from .quantities import REGIMES, Solution
    from .scene import Scene, SceneError

__all__ = ["REGIMES", "Scene", "SceneError", "Solution", "solve", "solve_arrays"]
__version__ = "0.1.0"

_HOMES = {"solve": "api", "solve_arrays": "arrays", "REGIMES": "quantities", "Solution": "quantities"}


def __getattr__(name: str) -> Any:
    """The names above, imported when first used: the command line starts before they are there.

    So it can catch Ctrl-C while they load.
    """
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    value = globals()[name] = getattr(import_module(f".{_HOMES.get(name, 'scene')}", __name__), name)
    return value
