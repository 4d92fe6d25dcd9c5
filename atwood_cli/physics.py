"""The equations of Atwood's machine with a massive pulley, each written once.

Numbers in parentheses are equations of T. R. de Oliveira and N. A. Lemos, "Force and torque of a
string on a pulley". Every function is plain arithmetic on whatever number type comes in (float,
Fraction, enclosure, NumPy array, mpmath, SymPy); exp, log and sqrt are handed in by the arithmetic.

Symbols: ``l`` and ``h`` are the lighter and the heavier mass (kg), ``c`` = βM is the pulley's
inertia as a mass at the rim (kg; half the pulley's mass in the paper), ``g`` the gravity (m/s²),
``phi`` the angle of wrap (rad; π in the paper), ``k`` = e^{μφ} the capstan ratio, which always
comes in as its excess ``k1`` = k - 1, so that weak friction loses no digits.

One form of the state serves every regime. Let r = T_h/T_l and x = l r, the *effective mass*: the
heavy side moves as if it hung against x over a massless pulley. What differs between regimes is
only the *transfer* z = x - l, the mass that friction adds to the light side, and with it the
*surplus* d = h - x that is left to accelerate:

- no slip, from (1) and (3): z = v (h - l) and d = w (h - l), with the shares v + w = 1 below;
- verge (33) and slip: z = l (k - 1) and d = (h - l) - z.
"""

from collections.abc import Callable
from typing import Any, Protocol, Self, TypeVar


class Number(Protocol):
    """What the equations ask of a number. Ints may stand on either side of an operation."""

    def __add__(self, other: Any, /) -> Self: ...
    def __radd__(self, other: Any, /) -> Self: ...
    def __sub__(self, other: Any, /) -> Self: ...
    def __mul__(self, other: Any, /) -> Self: ...
    def __rmul__(self, other: Any, /) -> Self: ...
    def __truediv__(self, other: Any, /) -> Self: ...
    def __rtruediv__(self, other: Any, /) -> Self: ...


N = TypeVar("N", bound=Number)


def shares(h: N, c: N) -> tuple[N, N]:
    """Shares (w, v) of the mass difference that accelerate the masses and turn the pulley.

    Dimensionless, w + v = 1, from (4). A massless pulley has (1, 0), a locked one (0, 1).
    """
    return 2 * h / (2 * h + c), c / (2 * h + c)


def transfer_at_limit(l: N, k1: N) -> N:
    """Transfer z (kg) of a string whose friction is at its limit all along the arc, from (26)."""
    return l * k1


def surplus_at_limit(l: N, h: N, k1: N) -> N:
    """Surplus d = h - l k (kg) of the same string; positive where a heavy enough pulley makes it slip."""
    return h - l - transfer_at_limit(l, k1)


def acceleration(h: N, x: N, d: N, g: N) -> N:
    """Magnitude of the masses' acceleration (m/s²); (4) when the string grips."""
    return g * d / (h + x)


def light_tension(l: N, h: N, x: N, g: N) -> N:
    """Tension on the lighter mass (N); (4) when the string grips."""
    return 2 * l * h * g / (h + x)


def heavy_tension(h: N, x: N, g: N) -> N:
    """Tension on the heavier mass (N); (4) when the string grips."""
    return 2 * x * h * g / (h + x)


def tension_difference(h: N, x: N, z: N, g: N) -> N:
    """T_h - T_l (N), the pulley's torque per unit radius (23), without cancellation."""
    return 2 * h * z * g / (h + x)


def verge_coefficient(log_ratio: N, phi: N) -> N:
    """Friction coefficient at which the string is on the verge (27); log_ratio = ln(T_h/T_l)."""
    return log_ratio / phi


def critical_pulley_mass(l: N, h: N, k1: N, surplus: N, beta: N) -> N:
    """Pulley mass (kg) above which the string slips (34); surplus = h - l k > 0."""
    return 2 * l * h * k1 / (beta * surplus)


def critical_heavier_mass(l: N, c: N, k1: N) -> N:
    """Heavier mass (kg) at which the string is on the verge (35); needs c > 2 l (k - 1)."""
    return c * least_heavier_mass(l, k1) / (c - 2 * l * k1)


def least_heavier_mass(l: N, k1: N) -> N:
    """What the heavier mass (kg) must exceed for any pulley to slip: first condition of (36)."""
    return l + l * k1


def least_pulley_mass(l: N, k1: N, beta: N) -> N:
    """What the pulley's mass (kg) must exceed for any mass to slip: second condition of (36)."""
    return 2 * l * k1 / beta


def resultant(t1: N, t2: N, difference: N, sin_half: N, sqrt: Callable[[N], N]) -> N:
    """Magnitude (N) of the force of T1 and T2 on an arc of contact; T1 + T2 over half a turn (20).

    ``difference`` = T2 - T1 and ``sin_half``, the sine of half the arc, keep what is nearly equal
    from cancelling in T1² + T2² - 2 T1 T2 cos φ.
    """
    squared: N = difference * difference + 4 * t1 * t2 * sin_half * sin_half
    return sqrt(squared)


def friction_magnitude(mu: N, resultant: N, sqrt: Callable[[N], N]) -> N:
    """Net friction force (N) where T grows as e^{μθ} all along the arc (32)."""
    return mu * resultant / sqrt(mu * mu + 1)


def friction_vector(mu: N, dx: N, dy: N) -> tuple[N, N]:
    """Friction force on the pulley (N), (x, y), of an arc where T grows as e^{μθ}; (31).

    ``dx + i dy`` is T e^{iθ} at the arc's end less that at its start; θ grows with the tension, and μ
    is 0 where the string is stuck without friction. The integrals (28)-(29) give
    μ (1 + iμ)/(1 + μ²) times that difference.
    """
    factor = mu / (mu * mu + 1)
    return factor * (dx - mu * dy), factor * (dy + mu * dx)


def normal_vector(mu: N, dx: N, dy: N) -> tuple[N, N]:
    """Normal force on the pulley (N), (x, y), of the same arc: -∫ T e^{iθ} dθ, from (18)."""
    factor = 1 / (mu * mu + 1)
    return factor * (-1 * mu * dx - dy), factor * (dx - mu * dy)


def resultant_vector(dx: N, dy: N) -> tuple[N, N]:
    """The force on the pulley (N), (x, y), that friction and normal force add up to; (19)-(20)."""
    return -1 * dy, dx


def mirrored(x: N, y: N, cos_phi: N, sin_phi: N) -> tuple[N, N]:
    """A vector of the machine seen from behind: θ there is φ - θ here."""
    return x * cos_phi + y * sin_phi, x * sin_phi - y * cos_phi


def limiting_arc(log_ratio: N, mu: N) -> N:
    """Arc (rad) over which friction at its limit makes up ln(T_h/T_l), from (26)."""
    return log_ratio / mu


def least_friction_slope(mu: N, chord: N, growth: N, cos: N, sin: N, dx: N, dy: N) -> N:
    """What vanishes where moving friction from one end of the arc to the other no longer pays.

    A string that grips with friction at its limit on arcs s and α - s at the ends, and stuck over
    δ = φ - α between, has the net friction μ/√(1 + μ²) |T_l e^{(μ+i)s} (1 - e^{iδ}) + dx + i dy|.
    This is the derivative of its square with respect to s, up to a positive factor: ``chord`` =
    2 T_l sin(δ/2), ``growth`` = e^{μs}, ``cos`` and ``sin`` of s + δ/2, dx + i dy = T_h e^{iφ} - T_l.
    """
    return mu * chord * growth + (mu * dx + dy) * sin + (dx - mu * dy) * cos


def axle_force(t1: N, t2: N, pulley_mass: N, g: N) -> N:
    """Force (N) on the axle of a pulley with half a turn of wrap: (20) and the pulley's weight."""
    return t1 + t2 + pulley_mass * g
