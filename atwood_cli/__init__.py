"""Atwood's machine with a massive pulley and a rough string, every digit right."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .api import Solution as Solution
    from .api import solve as solve
    from .arrays import STATUSES as STATUSES
    from .arrays import solve_arrays as solve_arrays
    from .batch.frames import solve_table as solve_table
    from .laboratory import Fit as Fit
    from .laboratory import fit as fit
    from .solver.quantities import QUANTITIES as QUANTITIES
    from .solver.quantities import REGIMES as REGIMES
    from .solver.scene import Scene as Scene
    from .solver.scene import SceneError as SceneError

__version__ = "1.2.0"

_HOMES = {
    **dict.fromkeys(("Solution", "solve"), "api"),
    **dict.fromkeys(("STATUSES", "solve_arrays"), "arrays"),
    **{"solve_table": "batch.frames", "REGIMES": "solver.quantities"},
    **dict.fromkeys(("Fit", "fit"), "laboratory"),
    **dict.fromkeys(("Scene", "SceneError"), "solver.scene"),
    "QUANTITIES": "solver.quantities",
}
"""The names that the package exports, and the modules that have them."""
__all__ = [*_HOMES]


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
    """Return the names that a shell completes: all names above, whether they were used or not."""
    return {*globals(), *__all__}
