"""Residues modulo a prime, in which an equation shows that its value is a given rational number.

The value of a tie never settles: however narrow its enclosure, the two ends round differently. Most values
cannot be one, as they are transcendental, but some are rational though their formulas are not: sines and
cosines of 30°, 2 = 4^(1/2), and whatever is made of e^{μφ} so that it cancels.

Every value here is a rational function of the inputs and of a few *unknowns*: π, e^π, logarithms, powers
e^x and points e^{ix} of the unit circle. Modulo a prime p the unknowns become random residues that keep
what is known of them: e^{x + y} = e^x e^y, the order of roots of unity, the squares of square roots. If
the function comes out as the rational t there, so it does wherever the unknowns may lie, and with that at
their true values: a rational function of degree D that is not t throughout is t for a share D/p of all
residues at most, which is below 10^-30. So residues never take a value for a rational that it is not; they
may miss one whose cancelling needs a relation that they do not keep.

The group of residues has elements of prime order `ORDER`, of which every power with a rational exponent is
defined, and roots of unity of whatever order the angle of wrap asks for.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import lru_cache
from itertools import count
from math import gcd, isqrt, lcm
from random import Random
from typing import TYPE_CHECKING, NoReturn

if TYPE_CHECKING:
    from .protocol import Quantity

ORDER = 2**127 - 1  # a prime (É. Lucas, 1876)
MOST_ORDER = 2**256
"""Roots of unity of higher order, from angles with that many digits, are not looked for."""
MOST_TERMS = 8
SMALL_PRIMES = (2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53)
TRIALS = 32
"""So often square roots that are none modulo p, or have the other sign, are tried with other unknowns."""

Monomial = tuple[tuple[object, int], ...]
Form = dict[Monomial, Fraction]
PI: Monomial = (("π", 1),)


class Unknown(ArithmeticError):
    """Residues can tell nothing of the value."""


class _NoRoot(ArithmeticError):
    """A square root that is none among these residues."""


class _NeedsRoots(ArithmeticError):
    """The field has no roots of unity of that order."""

    def __init__(self, order: int) -> None:
        super().__init__(order)
        self.order = order


def is_rational(quantity: Quantity, value: Fraction) -> bool:
    """Whether a quantity is that rational number, as far as residues can tell; never wrongly true."""
    order, random = 4, Random(0)  # the same everywhere and every time
    for _ in range(TRIALS):
        try:
            field = Residues(order, random)
            if quantity(field).residue == field.of(value):
                return True
        except _NeedsRoots as more:
            order = lcm(order, more.order)
            continue
        except _NoRoot:
            continue
        except (Unknown, ZeroDivisionError):
            return False
        if not field.chose_roots:
            return False
    return False


class Residue:
    """A residue, and the formula of the number in rationals, π and logarithms, if that is short."""

    __slots__ = ("form", "residue", "within")

    def __init__(self, within: Residues, residue: int, form: Form | None = None) -> None:
        self.within, self.residue, self.form = within, residue % within.p, form

    def _lift(self, other: Residue | int) -> Residue:
        return self.within.number(other) if isinstance(other, int) else other

    def __add__(self, other: Residue | int) -> Residue:
        other, form = self._lift(other), None
        if self.form is not None and other.form is not None:
            form = _sum(self.form, other.form)
        return Residue(self.within, self.residue + other.residue, form)

    __radd__ = __add__

    def __sub__(self, other: Residue | int) -> Residue:
        return self + -1 * self._lift(other)

    def __mul__(self, other: Residue | int) -> Residue:
        other, form = self._lift(other), None
        if self.form is not None and other.form is not None:
            form = _product(self.form, other.form)
        return Residue(self.within, self.residue * other.residue, form)

    __rmul__ = __mul__

    def __truediv__(self, other: Residue | int) -> Residue:
        return self * self._lift(other)._inverse()

    def __rtruediv__(self, other: int) -> Residue:
        return other * self._inverse()

    def _inverse(self) -> Residue:
        form = None
        if self.form is not None and len(self.form) == 1:
            [(monomial, factor)] = self.form.items()
            form = {tuple((symbol, -power) for symbol, power in monomial): 1 / factor}
        return Residue(self.within, self.within.inverse(self.residue), form)

    @property
    def rational(self) -> Fraction | None:
        """The rational number that this is, if its formula says so."""
        return self.form.get((), Fraction(0)) if self.form is not None and self.form.keys() <= {()} else None


def _sum(one: Form, other: Form) -> Form | None:
    terms = {m: one.get(m, Fraction(0)) + other.get(m, Fraction(0)) for m in {**one, **other}}
    terms = {monomial: factor for monomial, factor in terms.items() if factor}
    return terms if len(terms) <= MOST_TERMS else None


def _product(one: Form, other: Form) -> Form | None:
    terms: Form | None = {}
    for m, a in one.items():
        for n, b in other.items():
            if terms is not None:
                terms = _sum(terms, {_times(m, n): a * b})
    return terms


def _times(one: Monomial, other: Monomial) -> Monomial:
    powers = dict(one)
    for symbol, power in other:
        powers[symbol] = powers.get(symbol, 0) + power
    return tuple(sorted(((s, p) for s, p in powers.items() if p), key=str))


class Residues:
    """The arithmetic of residues modulo a prime that has roots of unity of that order, a multiple of 4."""

    def __init__(self, order: int, random: Random) -> None:
        if order > MOST_ORDER:
            raise Unknown
        self.order, self.p = order, _prime(order)
        self.chose_roots = False
        self._random = random
        self._unknowns: dict[object, int] = {}
        self._root_of_unity = self._of_order(order)

    def of(self, q: Fraction | int) -> int:
        """The residue of a rational number."""
        return q.numerator * self.inverse(q.denominator) % self.p

    def inverse(self, x: int) -> int:
        if x % self.p == 0:
            raise ZeroDivisionError
        return pow(x, -1, self.p)

    def _of_order(self, order: int) -> int:
        """An element of that order."""
        while True:
            x = pow(self._random.randrange(2, self.p), (self.p - 1) // order, self.p)
            if all(pow(x, order // prime, self.p) != 1 for prime in _primes_of(order)):
                return x

    def _power(self, unknown: object, exponent: Fraction) -> int:
        """A power of the unknown of that name, which is a random element of the order `ORDER`."""
        if unknown not in self._unknowns:
            self._unknowns[unknown] = pow(self._random.randrange(2, self.p), (self.p - 1) // ORDER, self.p)
        by = exponent.numerator * pow(exponent.denominator, -1, ORDER) % ORDER
        return pow(self._unknowns[unknown], by, self.p)

    def _symbol(self, symbol: object) -> Residue:
        """A number that is known by its formula alone, as a random residue."""
        if symbol not in self._unknowns:
            self._unknowns[symbol] = self._random.randrange(2, self.p)
        return Residue(self, self._unknowns[symbol], {((symbol, 1),): Fraction(1)})

    def number(self, q: Fraction | int) -> Residue:
        return Residue(self, self.of(q), {(): Fraction(q)} if q else {})

    def is_zero(self, x: Residue) -> bool:
        return x.residue == 0

    @property
    def pi(self) -> Residue:
        return self._symbol("π")

    def exp(self, x: Residue) -> Residue:
        if x.form is None:
            raise Unknown
        residue = 1
        for monomial, factor in x.form.items():
            match monomial:
                case ((("ln", Fraction() as base), 1),):
                    whole = factor.numerator // factor.denominator
                    residue *= pow(self.of(base), whole, self.p)
                    residue *= self._power(("power", base), factor - whole) if factor != whole else 1
                case _:
                    residue *= self._power(("e", monomial), factor)
        return Residue(self, residue)

    def expm1(self, x: Residue) -> Residue:
        return self.exp(x) - 1

    def log1p(self, x: Residue) -> Residue:
        if x.rational is None:
            raise Unknown
        base, power = _as_power(1 + x.rational)
        return self._symbol(("ln", base)) * power if base != 1 else self.number(0)

    def sqrt(self, x: Residue) -> Residue:
        q = x.rational
        if q is not None and q >= 0:
            root = Fraction(isqrt(q.numerator), isqrt(q.denominator))
            if root * root == q:
                return self.number(root)
        self.chose_roots = True
        return Residue(self, _square_root(x.residue, self.p, self._random))

    def hypot(self, x: Residue, y: Residue | int) -> Residue:
        return self.sqrt(x * x + y * y)

    def cos_sin(self, x: Residue) -> tuple[Residue, Residue]:
        """Cosine and sine by e^{ix}."""
        if x.form is None:
            raise Unknown
        point = 1
        for monomial, factor in x.form.items():
            if monomial == PI:  # e^{iπ factor}: a root of unity
                turns = factor / 2 * self.order
                if turns.denominator > 1:
                    raise _NeedsRoots(turns.denominator * self.order)
                point *= pow(self._root_of_unity, int(turns), self.p)
            else:
                point *= self._power(("circle", monomial), factor)
        i = pow(self._root_of_unity, self.order // 4, self.p)
        back = self.inverse(point)
        halves = self.inverse(2), self.inverse(2 * i)
        return Residue(self, (point + back) * halves[0]), Residue(self, (point - back) * halves[1])

    def cos_sin_of_degrees(self, x: Fraction) -> tuple[Residue, Residue]:
        return self.cos_sin(self.pi * self.number(x / 180))

    def root(self, f: Callable[[Residue], Residue], end: Residue) -> NoReturn:
        raise Unknown


@lru_cache
def _prime(order: int) -> int:
    """A prime p with p - 1 a multiple of the order and of `ORDER`."""
    return next(p for j in count(1) if _is_prime(p := order * ORDER * j + 1))


def _is_prime(n: int) -> bool:
    """Whether none of the first primes shows n > 53 to be composite (G. L. Miller, M. O. Rabin)."""
    if any(n % prime == 0 for prime in SMALL_PRIMES):
        return False
    twos = ((n - 1) & (1 - n)).bit_length() - 1
    for base in SMALL_PRIMES:
        x = pow(base, n - 1 >> twos, n)
        if x != 1 and all(pow(x, 1 << k, n) != n - 1 for k in range(twos)):
            return False
    return True


@lru_cache
def _primes_of(n: int) -> tuple[int, ...]:
    """The prime factors of n, of which all but one must be below 10^5; raises Unknown."""
    primes: list[int] = []
    d = 2
    while d * d <= n and d < 10**5:
        if n % d == 0:
            primes.append(d)
            while n % d == 0:
                n //= d
        d += 1
    if n > 1 and d * d <= n and not _is_prime(n):
        raise Unknown
    return (*primes, *([n] if n > 1 else []))


def _square_root(x: int, p: int, random: Random) -> int:
    """One of the square roots of x modulo p, at random (A. Tonelli, 1891)."""
    if x == 0:
        return 0
    if pow(x, (p - 1) // 2, p) != 1:
        raise _NoRoot
    twos = ((p - 1) & (1 - p)).bit_length() - 1
    odd = p - 1 >> twos
    other = next(y for y in iter(lambda: random.randrange(2, p), 0) if pow(y, (p - 1) // 2, p) == p - 1)
    generator, root, left = pow(other, odd, p), pow(x, (odd + 1) // 2, p), pow(x, odd, p)
    while left != 1:
        k = next(k for k in range(1, twos) if pow(left, 1 << k, p) == 1)
        factor = pow(generator, 1 << twos - k - 1, p)
        root, generator, twos = root * factor % p, factor * factor % p, k
        left = left * generator % p
    return root if random.random() < 0.5 else p - root


@lru_cache
def _as_power(q: Fraction) -> tuple[Fraction, int]:
    """q >= 1 as a power of the least base."""
    times = gcd(*(_times_divisible(part, prime) for part in q.as_integer_ratio() for prime in SMALL_PRIMES))
    # Without a small factor the base is at least 59.
    most = times or q.numerator.bit_length() // 5
    for power in range(most, 1, -1):
        if times % power == 0:
            base = Fraction(_root(q.numerator, power), _root(q.denominator, power))
            if base**power == q:
                return base, power
    return q, 1


def _times_divisible(n: int, prime: int) -> int:
    times = 0
    while n % prime == 0:
        n, times = n // prime, times + 1
    return times


def _root(n: int, k: int) -> int:
    """The largest integer whose k-th power is at most n."""
    if n < 2 or k == 2:
        return isqrt(n)
    x = 1 << -(-n.bit_length() // k)
    while True:
        y = ((k - 1) * x + n // x ** (k - 1)) // k
        if y >= x:
            return x
        x = y
