"""Products of matrices in parts so small that they start no threads.

OpenBLAS splits a product of two matrices among threads from 2^18 multiplications on,
and one of two vectors from 10^4. Parts below that keep to one thread: the sums have the
same bits whatever the number of threads, and on a busy machine none waits for another.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Reals = NDArray[np.floating[Any]]

ONE_THREAD = 1 << 18  # multiplications
ONE_THREAD_DOT = 1 << 13  # numbers of a vector


def product(left: Reals, right: Reals, out: Reals | None = None) -> Reals:
    """Multiply a matrix by wide ones, some columns at a time.

    Parameters
    ----------
    left, right
        Shapes (m, K) and (..., K, n).
    out
        Takes the product, shape (..., m, n); None for an array of its own.

    Returns
    -------
    The product.
    """
    if out is None:
        shape = *right.shape[:-2], len(left), right.shape[-1]
        out = np.empty(shape, np.result_type(left, right))
    # A row is multiplied as a vector is.
    most = ONE_THREAD if len(left) > 1 else ONE_THREAD_DOT
    step = max(1, most // max(left.size, 1))
    for first in range(0, right.shape[-1], step):
        part = slice(first, first + step)
        np.matmul(left, right[..., part], out=out[..., part])
    return out


def dot(a: Reals, b: Reals) -> float:
    """Sum a times b over all their numbers, arrays of one shape."""
    a, b = a.reshape(-1), b.reshape(-1)
    return sum(
        float(
            np.dot(a[first : first + ONE_THREAD_DOT], b[first : first + ONE_THREAD_DOT])
        )
        for first in range(0, a.size, ONE_THREAD_DOT)
    )
