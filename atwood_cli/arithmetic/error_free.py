"""Sums and products of doubles with their rounding errors, exactly; columns, a row a scene.

The error of a sum or product of two doubles is itself a double, as long as nothing leaves the normal
doubles. That holds for IEEE 754 arithmetic, rounding to nearest, which NumPy's + - * / and sqrt do on any
platform and with any SIMD path. Columns have the shape (n,), single numbers (1,).
"""

from threading import local
from typing import Any

import numpy as np
from numpy.typing import NDArray

Column = NDArray[np.float64]

UNIT = 2.0**-53  # u, the largest relative error of a rounding
HEAD = -1 << 27  # masks the last 27 of the 53 bits

_scratch = local()


def scratch(count: int, size: int) -> list[Column]:
    """Up to five columns for intermediate results, which the next call may overwrite.

    Each thread has its own, and so small that they stay in the processor's cache.
    """
    columns: list[Column] = getattr(_scratch, "columns", [])
    if not columns or columns[0].size < size:
        _scratch.columns = columns = [np.empty(size) for _ in range(5)]
    return [column[:size] for column in columns[:count]]


def two_sum(x: Column, y: Column, add: Any = np.add) -> tuple[Column, Column]:
    """x + y, or x - y if ``add`` is np.subtract, rounded, and the error of that, exactly.

    Found by six operations, whichever of the two is larger (D. E. Knuth).
    """
    total = add(x, y)
    (added,) = scratch(1, total.size)
    np.subtract(total, x, out=added)
    error = total - added
    np.subtract(x, error, out=error)
    if add is np.add:
        np.subtract(y, added, out=added)
        error += added
    else:
        added += y
        error -= added
    return total, error


def fast_two_sum(x: Column, y: Column, add: Any = np.add) -> tuple[Column, Column]:
    """x + y or x - y, rounded, and its error, by three operations (T. J. Dekker).

    No row of y may be larger in size than that of x.
    """
    total = add(x, y)
    error = x - total
    return total, add(error, y, out=error)


def two_product(x: Column, y: Column) -> tuple[Column, Column]:
    """x y, rounded, and the error of that, exactly, from the products of halves (T. J. Dekker)."""
    product = x * y
    term, *halves = scratch(5, product.size)
    x_high, x_low = split(x, *halves[:2])
    y_high, y_low = split(y, *halves[2:])
    error = x_high * y_high
    error -= product
    error += np.multiply(x_low, y_high, out=term)
    error += np.multiply(x_high, y_low, out=term)
    error += np.multiply(x_low, y_low, out=term)
    return product, error


def split(x: Column, high: Column, low: Column) -> tuple[Column, Column]:
    """Two halves of 26 bits that add up to x, in the columns given; the lower has a sign (T. J. Dekker)."""
    high, low = high[: x.size], low[: x.size]
    np.multiply(x, 2.0**27 + 1, out=low)
    np.subtract(low, x, out=high)
    np.subtract(low, high, out=high)
    return high, np.subtract(x, high, out=low)


def head_of(x: Column, out: Column | None = None) -> Column:
    """The first 26 bits of each double, the others cut off."""
    head: NDArray[np.int64] = np.bitwise_and(
        x.view(np.int64), HEAD, out=None if out is None else out.view(np.int64)
    )
    return head.view(np.float64)
