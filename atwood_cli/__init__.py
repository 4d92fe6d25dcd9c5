"""Atwood's machine with a massive pulley and a rough string, every digit right."""

from .quantities import REGIMES, Solution
from .scene import Scene, SceneError
from .solver import solve

__all__ = ["REGIMES", "Scene", "SceneError", "Solution", "solve"]
__version__ = "0.1.0"
