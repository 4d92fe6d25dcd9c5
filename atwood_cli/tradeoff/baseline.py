"""The baseline that accuracies are measured against: the paper's formulas, with shared sums computed once.

They are no part of the model, which has its equations in `physics`: they know no regime, subtract what is
nearly equal, and what they form on the way may overflow.
"""

from typing import Any

import numpy as np

from ..model.quantities import STANDARD


def paper_in_numpy(
    l: Any, h: Any, M: Any = None, mu: Any = None, g: Any = 9.80665, inertia: Any = 0.5, phi: float = np.pi
) -> dict[str, Any]:
    """The seven standard quantities of masses l <= h (kg), less the regime, for arrays of any one float type.

    Without M (kg) the pulley's mass is the critical one (34), or 0 without mu too; without mu friction
    is that on the verge (27). ``phi`` is the angle of wrap (rad).
    """
    if mu is None:
        critical = np.full_like(l, np.nan)
        M = np.zeros_like(l) if M is None else M
    else:
        k = np.exp(mu * phi)
        critical = 2 / inertia * l * h * (k - 1) / (h - l * k)  # (34)
        M = critical if M is None else M
    c = inertia * M
    q = g / (l + h + c)
    a = (h - l) * q  # (4)
    t_l = (2 * h + c) * l * q
    t_h = (2 * l + c) * h * q
    mu_verge = np.log(t_h / t_l) / phi  # (27)
    limit = mu_verge if mu is None else mu
    friction = limit / np.sqrt(1 + limit * limit) * (t_l + t_h)  # (32)
    return dict(zip(STANDARD[1:], (a, t_l, t_h, mu_verge, friction, critical), strict=True))
