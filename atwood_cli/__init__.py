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
__version__ = "1.0.0"

_HOMES = {
    "api": ("Solution", "solve"),
    "arrays": ("STATUSES", "solve_arrays"),
    "batch.frames": ("solve_table",),
    "laboratory": ("Fit", "fit"),
    "model.quantities": ("REGIMES",),
    "model.scene": ("Scene", "SceneError"),
}


def __getattr__(name: str) -> Any:
    """Import one of the names above when it is first used.

    So the command line starts before they are there, and can catch Ctrl-C while they load.
    """
    for home, names in _HOMES.items():
        if name in names:
            from importlib import import_module

            value = globals()[name] = getattr(import_module(f".{home}", __name__), name)
            return value
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> set[str]:
    """Return the names that a shell completes: all names above, whether they were used or not."""
    return {*globals(), *__all__}
