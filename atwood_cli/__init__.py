"""Atwood's machine with a massive pulley and a rough string, every digit right."""

from .api import solve
from .quantities import REGIMES, Solution
from .scene import Scene, SceneError

__all__ = ["REGIMES", "Scene", "SceneError", "Solution", "solve"]
__version__ = "0.1.0"
