"""Phase 3 solved at once: the densities, none below 0, of least squared error."""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Shape
from refcloud.metaballs.heights import Product, dot, power_iteration
from refcloud.refusal import complaint

# Optimality: the projected gradient against the right side, and the most steps.
OPTIMAL = 1e-12
MOST_STEPS = 20_000
# A gram matrix may differ from its transpose by rounding of this share.
SYMMETRIC = 1e-9
# An entry of its diagonal that is above 0, but below this share of the largest, would
# take the squares of what is divided by its root out of the numbers.
SMALLEST = 1e-100


@checked
def non_negative_least_squares(
    gram: Annotated[Array, Shape("N", "N")], right: Annotated[Array, Shape("N")]
) -> Array:
    """Find the heights, none below 0, that fit best.

    Formula: v >= 0, s = gram v - right >= 0, v s = 0 (Karush, Kuhn and Tucker)

    Parameters
    ----------
    gram
        A^T A of the design matrix A, shape (N, N): symmetric, no eigenvalue below 0.
    right
        A^T y, shape (N,).

    Returns
    -------
    v, shape (N,), at least 0, with the conditions met to 1e-12 of the right side.

    Raises
    ------
    ValueError
        The matrix is not symmetric, has a negative diagonal or one that spans over 100
        decades, or is so close to singular that the conditions cannot be met; the
        heights are too large to be numbers.

    Source: the standard third phase; eq 20 of paper M with v >= 0.

    Examples
    --------
    >>> non_negative_least_squares([[2.0, 1.0], [1.0, 2.0]], [2.0, -1.0])
    array([1., 0.])
    """
    # 1. Scale both to about 1, so that squares stay numbers: by powers of 2, and of 4
    #    where roots are taken, which change no digit.
    of_gram, of_right = 2 * (_exponent(gram) // 2), _exponent(right)
    least = np.diagonal(gram).min(initial=np.inf, where=np.diagonal(gram) > 0.0)
    gram, right = np.ldexp(gram, -of_gram), np.ldexp(right, -of_right)
    diagonal = np.diagonal(gram)
    largest = float(np.abs(gram).max(initial=0.0))
    skew = float(np.abs(gram - gram.T).max(initial=0.0))
    if skew > SYMMETRIC * largest:
        raise ValueError(f"gram: expected a symmetric matrix, got a skew of {skew:.2g}")
    if diagonal.min(initial=0.0) < 0.0:
        below = np.ldexp(diagonal.min(), of_gram)
        raise ValueError(
            f"gram: expected a diagonal from 0, got {below:.2g}; use A^T A"
        )
    if np.ldexp(least, -of_gram) < SMALLEST * largest:
        expected = f"a diagonal of 0 or at least {SMALLEST:g} times the largest entry"
        advice = "leave such balls out"
        raise ValueError(complaint("gram", expected, f"{least:.2g}", advice))
    # 2. Solve.
    v, off = solve_non_negative(lambda x: gram @ x, diagonal, right, optimal=OPTIMAL)
    if off > 10.0 * OPTIMAL:
        raise ValueError(
            "gram: expected a matrix that is not almost singular, got one that leaves"
            f" {off:.2g} of the right side; leave out balls that repeat one another"
        )
    # 3. Scale back.
    with np.errstate(over="ignore"):
        v = np.ldexp(v, of_right - of_gram)
    if not np.isfinite(v).all():
        expected = "numbers so small beside gram that heights are numbers"
        raise ValueError(complaint("right", expected, "larger ones"))
    return v


def _exponent(numbers: Array) -> int:
    """Give the power of 2 next above all numbers' sizes."""
    return int(np.frexp(np.abs(numbers).max(initial=0.0))[1])


def solve_non_negative(
    product: Product,
    diagonal: Array,
    right: Array,
    *,
    start: Array | None = None,
    optimal: float,
    most_steps: int = MOST_STEPS,
    positive: bool = False,
) -> tuple[Array, float]:
    """Minimise x.Gx/2 - right.x over x >= 0, G known by its products.

    Conjugate gradients on the numbers above 0; a projected step where one of them
    would fall below; a release of those at 0 once their gradient outweighs the rest
    (Dostal's proportioning, which cannot cycle). Returns x and how far the projected
    gradient is from 0, over the right side. `positive` says that no entry of G is
    below 0, which bounds its largest eigenvalue at once.
    """
    # Unit diagonal: balls of all sizes count alike. A ball without voxels stays at 0.
    scale = np.zeros_like(right)
    np.divide(1.0, np.sqrt(diagonal), out=scale, where=diagonal > 0.0)
    b = scale * right
    size = math.sqrt(dot(b, b))
    x = np.zeros_like(b)
    if start is not None and size > 0.0:
        np.divide(start, scale, out=x, where=scale > 0.0)
    if size == 0.0:
        return x, 0.0

    def times(v: Array) -> Array:
        return scale * product(scale * v)

    longest = row_bound if positive else power_iteration
    step = 1.0 / longest(times, len(b))
    gradient = times(x) - b
    free = np.where(x > 0.0, gradient, 0.0)
    direction = free
    off = np.inf
    for _ in range(most_steps):
        bound = np.where(x > 0.0, 0.0, np.minimum(gradient, 0.0))
        off = math.sqrt(dot(free, free) + dot(bound, bound)) / size
        if off <= optimal:
            break
        reduced = np.minimum(x / step, free)
        if dot(bound, bound) > dot(reduced, free):  # release
            image = times(bound)
            curvature = dot(bound, image)
            if not curvature > 0.0:  # flat without end: nothing is least
                break
            length = dot(gradient, bound) / curvature
            x = x - length * bound
            gradient = gradient - length * image
            free = direction = np.where(x > 0.0, gradient, 0.0)
            continue
        image = times(direction)
        curvature = dot(direction, image)
        falling = direction > 0.0
        reach = float((x[falling] / direction[falling]).min(initial=np.inf))
        length = dot(gradient, direction) / curvature if curvature > 0.0 else reach
        if length == np.inf:  # flat without end: singular, and as good as it gets
            break
        if length <= reach and curvature > 0.0:
            x = np.maximum(x - length * direction, 0.0)  # rounding may end below
            gradient = gradient - length * image
            free = np.where(x > 0.0, gradient, 0.0)
            direction = free - dot(free, image) / curvature * direction
        else:  # up to the first 0, then one projected step
            x = np.maximum(x - reach * direction, 0.0)
            gradient = gradient - reach * image
            free = np.where(x > 0.0, gradient, 0.0)
            x = np.maximum(x - step * free, 0.0)
            gradient = times(x) - b
            free = direction = np.where(x > 0.0, gradient, 0.0)
    return scale * x, off


def row_bound(product: Product, count: int) -> float:
    """Bound the largest eigenvalue of a matrix without entries below 0 from above.

    Formula: max of (G w)_i / w_i for any w > 0 (Collatz and Wielandt); w = G 1 + 1
    """
    w = product(np.ones(count)) + 1.0
    return float((product(w) / w).max())
