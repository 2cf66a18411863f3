"""Phase 3: the balls' densities by the paper's gradient, and its stable limit."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Positive, Range, Shape

Product = Callable[[Array], Array]

# The default rate is this share of the stable limit: within 1 % in 4 to 10 steps.
SHARE_OF_LIMIT = 0.5
# The power iteration ends where its estimate moves by less, or after MOST_POWERS.
POWER_CHANGE = 1e-9
MOST_POWERS = 500


@checked
def largest_eigenvalue(gram: Annotated[Array, Shape("N", "N")]) -> float:
    """Estimate the largest eigenvalue of a Gram matrix, from below.

    Formula: v = gram v / |gram v|, repeated; lambda = v . gram v

    Parameters
    ----------
    gram
        Symmetric, no eigenvalue below 0, shape (N, N).

    Returns
    -------
    The eigenvalue, low by a few parts in 1e9 at most where the next one is not close.

    Source: the limit of paper M, eq 24; E19.

    Examples
    --------
    >>> round(largest_eigenvalue([[2.0, 1.0], [1.0, 2.0]]), 9)
    3.0
    """
    return power_iteration(lambda v: gram @ v, len(gram))


@checked
def gradient_descent(
    design: Annotated[Array, Shape("K", "N")],
    y: Annotated[Array, Shape("K")],
    *,
    rate: Annotated[float, Positive] | None = None,
    limit: Annotated[float, Range(0.0)] = 0.0,
    most_steps: Annotated[int, Range(0)] = 50,
) -> Array:
    """Learn the heights by the paper's gradient, phase 3.

    Formula: v += 2 lambda A^T (y - A v), from v = 0, until H = |y - A v|^2 <= limit

    Parameters
    ----------
    design
        Kernel of ball k at voxel j, the matrix A, shape (K, N).
    y
        Density of the voxels, shape (K,).
    rate
        lambda. Without it, half of the stable limit 1 / (largest eigenvalue of A^T A).
    limit
        The H at which learning ends.
    most_steps
        Where it ends at the latest.

    Returns
    -------
    The heights v, shape (N,). They may be below 0: nothing in eq 24 forbids it.

    Raises
    ------
    ValueError
        The rate is not below the stable limit: H would grow without end.

    Source: paper M, eq 20 and 24; E19.

    Examples
    --------
    >>> gradient_descent([[1.0], [1.0]], [1.0, 3.0]).round(6)
    array([2.])
    """
    return descend(
        lambda v: design @ v, lambda r: design.T @ r, y, design.shape[1],
        rate=rate, limit=limit, most_steps=most_steps,
    )  # fmt: skip


def dot(a: Array, b: Array) -> float:
    """Sum products on one thread: the same bits, whatever the number of threads."""
    return float(np.einsum("i,i->", a, b))


def power_iteration(product: Product, count: int) -> float:
    """Estimate the largest eigenvalue of a Gram matrix known by its products."""
    # Uneven on purpose: across no eigenvector that a design of kernels has.
    v = 1.0 + np.arange(count) / (3.0 * max(count, 1))
    v /= max(math.sqrt(dot(v, v)), 1.0)
    value = 0.0
    for _ in range(MOST_POWERS):
        w = product(v)
        before, value = value, dot(v, w)
        length = math.sqrt(dot(w, w))
        if length == 0.0 or abs(value - before) <= POWER_CHANGE * value:
            break
        v = w / length
    return value


def descend(
    forward: Product,
    backward: Product,
    y: Array,
    count: int,
    *,
    rate: float | None,
    limit: float,
    most_steps: int,
) -> Array:
    """Run `gradient_descent` on products with A and its transpose."""
    largest = power_iteration(lambda v: backward(forward(v)), count)
    v = np.zeros(count)
    if largest == 0.0:
        return v
    if rate is None:
        rate = SHARE_OF_LIMIT / largest
    if rate * largest >= 1.0 - 10.0 * POWER_CHANGE:  # estimated from below
        raise ValueError(
            f"rate: expected below the stable limit {1.0 / largest:.6g}"
            f" (1 / largest eigenvalue, E19), got {rate:.6g}"
        )
    residual = y - forward(v)
    for _ in range(most_steps):
        if dot(residual, residual) <= limit:
            break
        v = v + 2.0 * rate * backward(residual)
        residual = y - forward(v)
    return v
