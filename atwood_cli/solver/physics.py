"""The equations of Atwood's machine with a massive pulley, each written once.

Numbers in parentheses are equations of T. R. de Oliveira and N. A. Lemos, "Force and torque of a string on a
pulley". Every function is plain arithmetic on whatever number type comes in (float, Fraction, enclosure,
column, mpmath, SymPy); exp, log and roots are handed in by the arithmetic.

Symbols: ``l`` and ``h`` are the lighter and the heavier mass (kg), ``c`` = βM the pulley's inertia as a mass
at the rim (kg; half the pulley's mass in the paper), ``g`` gravity (m/s²), ``phi`` the angle of wrap (rad; π
in the paper), ``f`` the axle's friction as a force at the rim (N), ``b`` = f/g the same as a mass (kg), and
``k`` = e^{μφ} the capstan ratio. It comes in as ``k_minus_1`` = k - 1, so that weak friction loses no digits.

One form of the motion serves every regime, Newton's: a *drive* d (kg) sets a *load* s (kg) moving, a = g d/s.
The light side hangs in its weight and what accelerates it, (1): T_l = l (g + a).

- No slip (4): d = h - l - b and s = h + l + c, or all rests if h - l <= b. T_h - T_l = c a + f turns the
  pulley (3). In the paper, b = f = 0.
- Verge and slip, (1) with (26): friction at its limit lets l count k-fold, d = h - l k and s = h + l k, and
  T_h - T_l = (k - 1) T_l. The *friction mass* z = l (k - 1) is what friction adds to both masses' load.

Divisions come before products that could leave the range of doubles though the result does not.
Most examples are of l = 1, h = 3, c = 5 and g = 9, so that a = 2, T_l = 11 and T_h = 21.
"""

from collections.abc import Callable

from ..numbers.rational import N

Function = Callable[[N], N]


def friction_at_limit(light: N, k_minus_1: N) -> N:
    """Return what friction at its limit adds to ``light``, (26): T_h - T_l (N) to T_l, z (kg) to the mass l.

    >>> friction_at_limit(12, 1), friction_at_limit(1, 2)
    (12, 2)
    """
    return light * k_minus_1


def drive(l: N, h: N, taken: N) -> N:
    """Return the drive d = h - l (kg) less what friction takes: z at its limit, b in an axle.

    At the limit of friction, d = h - l k is positive if a heavy enough pulley makes the string slip.

    >>> drive(1, 3, 0), drive(1, 3, 1)
    (2, 1)
    """
    return h - l - taken


def axle_mass(f: N, g: N) -> N:
    """Return the axle's friction f as a mass b (kg): the greatest difference of masses that it holds.

    >>> axle_mass(9, 9)
    1.0
    """
    return f / g


def load(l: N, h: N, added: N) -> N:
    """Return the load s (kg) that the drive sets moving; ``added`` is c, or z at the limit of friction.

    >>> load(1, 3, 5)
    9
    """
    return l + h + added


def acceleration(d: N, s: N, g: N) -> N:
    """Return the magnitude of the masses' acceleration (m/s²), of drive d and load s: (4), (1) with (26).

    >>> acceleration(2, 9, 9)
    2.0
    """
    return g * (d / s)


def rim_mass(l: N, h: N, a: N, g: N, b: N) -> N:
    """Return c (kg) of the pulley on which masses have a measured acceleration a; (4) solved for it.

    >>> rim_mass(1, 3, 2, 9, 0), rim_mass(1, 3, 1, 9, 1)
    (5.0, 5.0)
    """
    return g * (drive(l, h, b) / a) - l - h


def gravity(l: N, h: N, c: N, a: N, f: N) -> N:
    """Return the gravity (m/s²) under which masses have a measured acceleration a; (4) solved for it.

    >>> gravity(1, 3, 5, 2, 0), gravity(1, 3, 5, 1, 9)
    (9.0, 9.0)
    """
    return (a * load(l, h, c) + f) / (h - l)


def heavier_mass(l: N, c: N, a: N, g: N, f: N) -> N:
    """Return the mass (kg) that descends with a measured acceleration a against a lighter one; (1) with (3).

    >>> heavier_mass(1, 5, 2, 9, 0), heavier_mass(1, 5, 1, 9, 9)
    (3.0, 3.0)
    """
    return (light_tension(l, a, g) + difference_of_a_pulley(c, a, f)) / (g - a)


def lighter_mass(h: N, c: N, a: N, g: N, f: N) -> N:
    """Return the mass (kg) that rises with a measured acceleration a against a heavier one; (1) with (3).

    >>> lighter_mass(3, 5, 2, 9, 0), lighter_mass(3, 5, 1, 9, 9)
    (1.0, 1.0)
    """
    return (h * (g - a) - difference_of_a_pulley(c, a, f)) / (g + a)


def axle_friction(l: N, h: N, c: N, a: N, g: N) -> N:
    """Return the axle's friction f (N) with which masses have a measured acceleration a; (1) with (3).

    ``a`` is negative if ``h`` descends ever slower.

    >>> axle_friction(1, 3, 5, 2, 9), axle_friction(1, 3, 5, 1, 9), axle_friction(2, 2, 5, -1, 9)
    (0, 9, 9)
    """
    return difference_of_moving_masses(l, h, a, g) - c * a


def slide_ratio_minus_1(l: N, h: N, a: N, g: N) -> N:
    """Return T_h/T_l - 1 of masses with a measured acceleration, from (1).

    >>> slide_ratio_minus_1(1, 3, 2, 10)
    1.0
    """
    return difference_of_moving_masses(l, h, a, g) / light_tension(l, a, g)


def inertia_at_rim(I: N, R: N) -> N:
    """Return c (kg), the moment of inertia I (kg m²) of a pulley of radius R (m) as a mass at its rim.

    >>> inertia_at_rim(20, 2)
    5.0
    """
    return I / (R * R)


def moment_of_inertia(c: N, R: N) -> N:
    """Return the moment of inertia (kg m²) of a pulley of radius R (m), from its c as a mass at the rim.

    >>> moment_of_inertia(5, 2)
    20
    """
    return c * R * R


def acceleration_of_fall(drop: N, time: N) -> N:
    """Return the constant acceleration (m/s²) that covers the height ``drop`` (m) from rest in ``time`` (s).

    >>> acceleration_of_fall(9, 3)
    2.0
    """
    return 2 * drop / (time * time)


def height_or_acceleration(speed: N, acceleration_or_height: N) -> N:
    """Return the height (m) of a fall from rest to ``speed`` (m/s), or its acceleration (m/s²), by the other.

    >>> height_or_acceleration(6, 9), height_or_acceleration(6, 2)
    (2.0, 9.0)
    """
    return speed * speed / (2 * acceleration_or_height)


def time_or_acceleration(speed: N, acceleration_or_time: N) -> N:
    """Return the time (s) of a fall from rest to ``speed`` (m/s), or its acceleration (m/s²), by the other.

    >>> time_or_acceleration(6, 3), time_or_acceleration(6, 2)
    (2.0, 3.0)
    """
    return speed / acceleration_or_time


def speed_after(a: N, time: N) -> N:
    """Return the speed (m/s) after a time (s) from rest with the acceleration ``a`` (m/s²).

    >>> speed_after(2, 3)
    6
    """
    return a * time


def fall_time(drop: N, a: N, sqrt: Function[N]) -> N:
    """Return the time (s) to fall the height ``drop`` (m) from rest with the acceleration ``a`` (m/s²).

    >>> fall_time(9, 2, lambda x: x**0.5)
    3.0
    """
    return sqrt(2 * drop / a)


def kinetic_energy(mass: N, a: N, distance: N) -> N:
    """Return the kinetic energy (J) of a mass that accelerates from rest with a over a ``distance`` (m).

    >>> kinetic_energy(4, 2, 9)
    72
    """
    return mass * a * distance


def light_tension(l: N, a: N, g: N) -> N:
    """Return the tension on the lighter mass (N), from (1): its weight and what accelerates it.

    >>> light_tension(1, 2, 9)
    11
    """
    return l * (g + a)


def mass_of_tension(tension: N, a: N, g: N) -> N:
    """Return the mass (kg) that a tension (N) lifts with the acceleration a; `light_tension` solved for it.

    >>> mass_of_tension(22, 2, 9), mass_of_tension(21, -2, 9)
    (2.0, 3.0)
    """
    return tension / (g + a)


def difference_of_a_pulley(c: N, a: N, f: N) -> N:
    """Return T_h - T_l (N) that turns a pulley whose rim has the acceleration a, against f (3).

    >>> difference_of_a_pulley(5, 2, 0), difference_of_a_pulley(5, 1, 9)
    (10, 14)
    """
    return c * a + f


def rim_acceleration(difference: N, c: N, f: N) -> N:
    """Return the acceleration (m/s²) of the rim of a pulley that T_h - T_l turns, against f (3).

    >>> rim_acceleration(10, 5, 0), rim_acceleration(14, 5, 9)
    (2.0, 1.0)
    """
    return (difference - f) / c


def difference_of_moving_masses(l: N, h: N, a: N, g: N) -> N:
    """Return T_h - T_l (N) of masses with a known acceleration, from (1): c a + f if the string grips.

    >>> difference_of_moving_masses(1, 3, 2, 9), difference_of_moving_masses(1, 3, 0, 9)
    (10, 18)
    """
    return g * (h - l) - a * (h + l)


def gripping_ratio_minus_1(l: N, h: N, c: N, b: N, D: N) -> N:
    """Return T_h/T_l - 1 of a string that grips, by (33), without cancellation.

    The pulley's inertia is c/D, so that limits are points like others: D = 0 is a pulley at rest, as it is
    locked or its axle holds it (h - l <= b), and c = 0 is one without mass.

    >>> gripping_ratio_minus_1(1, 3, 6, 0, 1), gripping_ratio_minus_1(1, 3, 5, 1, 1)
    (1.0, 1.4)
    >>> gripping_ratio_minus_1(1, 3, 1, 1, 0), gripping_ratio_minus_1(1, 3, 0, 1, 1)
    (2.0, 0.8)
    """
    return (c * (h - l) + b * D * (h + l)) / (l * (D * (2 * h - b) + c))


def heaviest_ratio_minus_1(l: N, c: N, b: N) -> N:
    """Return the limit of `gripping_ratio_minus_1` for h = ∞, on a pulley that turns.

    >>> heaviest_ratio_minus_1(1, 5, 1)
    3.0
    """
    return (c + b) / (2 * l)


def verge_coefficient(log_ratio: N, phi: N) -> N:
    """Return the friction coefficient at which the string is on the verge (27); log_ratio = ln(T_h/T_l).

    With μ in place of φ, it is the arc (rad) over which friction at its limit makes up that ratio.

    >>> verge_coefficient(0.75, 3)
    0.25
    """
    return log_ratio / phi


def critical_pulley_mass(l: N, h: N, friction_mass: N, d: N, beta: N, b: N) -> N:
    """Return the pulley mass (kg) above which the string slips (34); z and d at the limit of friction.

    >>> z = 1.56633  # e^{0.3 π} - 1, the paper's example
    >>> round(critical_pulley_mass(1, 3, z, drive(1, 3, z), 0.5, 0))
    43
    >>> critical_pulley_mass(1, 3, 1, 1, 0.5, 1)
    2.0
    """
    return (2 * friction_mass * h - b * (h + l + friction_mass)) / (d * beta)


def critical_heavier_mass(l: N, c: N, friction_mass: N, b: N) -> N:
    """Return the heavier mass (kg) above which the string slips (35), for c > b and c + b > 2 l (k - 1).

    >>> critical_heavier_mass(1, 6, 2, 1)
    5.0
    """
    return (c - b) / (c + b - 2 * friction_mass) * least_heavier_mass(l, friction_mass)


def critical_lighter_mass(h: N, c: N, k_minus_1: N, b: N) -> N:
    """Return the lighter mass (kg) below which the string slips: (33) solved for it, like (34) and (35).

    >>> critical_lighter_mass(3, 6, 1, 0), critical_lighter_mass(3, 6, 1, 3)
    (1.0, 2.25)
    """
    return h * ((c + b) / (c - b + k_minus_1 * (2 * h + c - b)))


def lighter_mass_at_rest(h: N, k: N) -> N:
    """Return the lighter mass (kg) below which the string slips on a pulley at rest, from (26).

    >>> lighter_mass_at_rest(3, 2)
    1.5
    """
    return h / k


def least_heavier_mass(l: N, friction_mass: N) -> N:
    """Return the heavier mass (kg) above which the string slips on some pulley, l k: first condition of (36).

    >>> least_heavier_mass(1, 1)
    2
    """
    return l + friction_mass


def least_pulley_mass(friction_mass: N, beta: N, b: N) -> N:
    """Return the pulley mass (kg) above which some mass makes the string slip: second of (36); z >= b.

    >>> least_pulley_mass(1, 0.5, 0), least_pulley_mass(2, 0.5, 1)
    (4.0, 6.0)
    """
    return (2 * friction_mass - b) / beta


def resultant(t1: N, t2: N, difference: N, sin_half: N, sqrt: Function[N]) -> N:
    """Return the magnitude (N) of the force of T1 and T2 on any arc of contact.

    ``difference`` = T2 - T1 and ``sin_half``, the sine of half the arc, keep what is nearly equal
    from cancelling in T1² + T2² - 2 T1 T2 cos φ.

    >>> from math import sqrt
    >>> resultant(9, 16, 7, 1, sqrt)
    25.0
    """
    return sqrt(difference * difference + 4 * sin_half * sin_half * t1 * t2)


def friction_magnitude(mu: N, resultant: N, sqrt: Function[N]) -> N:
    """Return the net friction force (N) if T grows as e^{μθ} all along the arc (32).

    >>> from math import sqrt
    >>> friction_magnitude(0.75, 35, sqrt)
    21.0
    """
    return mu / sqrt(mu * mu + 1) * resultant


def friction_vector(mu: N, dx: N, dy: N) -> tuple[N, N]:
    """Return the friction force on the pulley (N), (x, y), of an arc over which T grows as e^{μθ}; (31).

    ``dx + i dy`` is T e^{iθ} at the arc's end less that at its start; θ grows with the tension, and μ
    is 0 if the string is stuck without friction. The integrals (28)-(29) give
    μ (1 + iμ)/(1 + μ²) times that difference.

    >>> friction_vector(1, -32, 0)
    (-16.0, -16.0)
    """
    factor = mu / (mu * mu + 1)
    return factor * (dx - mu * dy), factor * (dy + mu * dx)


def normal_vector(mu: N, dx: N, dy: N) -> tuple[N, N]:
    """Return the normal force on the pulley (N), (x, y), of such an arc: -∫ T e^{iθ} dθ, from (18).

    >>> normal_vector(1, -32, 0)
    (16.0, -16.0)
    """
    factor = 1 / (mu * mu + 1)
    return factor * (-1 * mu * dx - dy), factor * (dx - mu * dy)


def resultant_vector(dx: N, dy: N) -> tuple[N, N]:
    """Return the force on the pulley (N), (x, y), that friction and normal force add up to; (19)-(20).

    >>> resultant_vector(-32, 0)
    (0, -32)
    """
    return -1 * dy, dx


def mirrored(x: N, y: N, cos_phi: N, sin_phi: N) -> tuple[N, N]:
    """Return a vector of the machine seen from behind: θ there is φ - θ here.

    >>> mirrored(2, 5, -1, 0)
    (-2, 5)
    """
    return x * cos_phi + y * sin_phi, x * sin_phi - y * cos_phi


def least_friction_slope(mu: N, chord: N, growth: N, cos: N, sin: N, dx: N, dy: N) -> N:
    """Return a positive multiple of the slope of the net friction force with the lead s; 0 at its minimum.

    A string that grips with friction at its limit on arcs s and α - s at the ends, and stuck over
    δ = φ - α between, has the net friction μ/√(1 + μ²) |T_l e^{(μ+i)s} (1 - e^{iδ}) + dx + i dy|.
    This is the derivative of its square with respect to s, up to a positive factor: ``chord`` =
    2 T_l sin(δ/2), ``growth`` = e^{μs}, ``cos`` and ``sin`` of s + δ/2, dx + i dy = T_h e^{iφ} - T_l.

    >>> least_friction_slope(1, 3, 1, 0, 1, -4, 1)
    0
    """
    return mu * chord * growth + (mu * dx + dy) * sin + (dx - mu * dy) * cos


def axle_force(t1: N, t2: N, pulley_mass: N, g: N) -> N:
    """Return the force (N) on the axle of a pulley with half a turn of wrap: (20) and the pulley's weight.

    >>> axle_force(11, 21, 10, 9)
    122
    """
    return t1 + t2 + pulley_mass * g
