"""Orthogonal least squares: centres chosen one by one among candidates (Chen).

Each chosen column of the design takes its part out of all others; the next one is that
whose rest explains most of what is left. The columns themselves are never needed, only
their products: it is a Cholesky factorisation of A^T A that picks its pivots so.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Range, Shape
from refcloud.metaballs.choices import spaced_patterns
from refcloud.metaballs.pairs import Numbers, Work
from refcloud.metaballs.peaks import AXES, ball_spectrum, padded_shape
from refcloud.metaballs.refine import Fit, Listed
from refcloud.metaballs.settings import Settings
from refcloud.metaballs.sizes import typical_radius
from refcloud.metaballs.solve import with_heights
from refcloud.refusal import complaint

# A column of which less than this share is left repeats the chosen ones.
REPEATED = 1e-10
# Candidates: so many for each ball, at least so many in all.
CANDIDATES, LEAST_CANDIDATES = 4, 400
# The factor holds a row for each ball and a column for each candidate: 1 GB at most.
MOST_NUMBERS = 1 << 27


@checked
def orthogonal_least_squares(
    design: Annotated[Array, Shape("K", "N")],
    y: Annotated[Array, Shape("K")],
    count: Annotated[int, Range(1)],
) -> Numbers:
    """Choose the columns of a design that explain most, one after the other.

    Formula: the k with the largest (w_k . y)^2 / (w_k . w_k), where w_k is column k
    less its parts along the columns chosen before

    Parameters
    ----------
    design
        Kernel of candidate k at voxel j, shape (K, N).
    y
        Density of the voxels, shape (K,).
    count
        How many columns are wanted. Those that repeat others are never chosen.

    Returns
    -------
    The columns in the order of their choice, at most `count`; ties to the lower one.

    Source: paper M, section 3 (A13), after Chen, Cowan and Grant (1991).

    Examples
    --------
    >>> orthogonal_least_squares([[1.0, 1.0, 0.0], [0.0, 1.0, 2.0]], [1.0, 3.0], 2)
    array([2, 0])
    """
    gram = design.T @ design
    return chosen_columns(
        lambda k: gram[k], np.diagonal(gram).copy(), design.T @ y, count
    )


def chosen_columns(
    column: Callable[[int], Array], diagonal: Array, right: Array, count: int
) -> Numbers:
    """Run `orthogonal_least_squares` on columns of A^T A, given when asked for."""
    left, explains = diagonal.copy(), right.copy()  # w . w and w . y of every column
    factor = np.zeros((min(count, len(right)), len(right)))
    chosen: list[int] = []
    for n in range(len(factor)):
        gain = np.zeros_like(left)
        whole = left > REPEATED * diagonal
        np.divide(explains**2, left, out=gain, where=whole)
        k = int(gain.argmax())
        if gain[k] <= 0.0:
            break
        # The chosen column's part in every other: a row of the Cholesky factor.
        known = np.einsum("nm,n->m", factor[:n], factor[:n, k])
        length = np.sqrt(left[k])
        factor[n] = (column(k) - known) / length
        explains -= factor[n] * (explains[k] / length)
        left -= factor[n] ** 2
        left[k] = 0.0
        chosen.append(k)
    return np.array(chosen, dtype=np.intp)


def orthogonal(work: Work, count: int, settings: Settings) -> Listed:
    """Choose equal balls among evenly spaced voxels by orthogonal least squares."""
    radius = max(typical_radius(work, count), settings.least_radius)
    z, y, x = np.nonzero(work.density > 0.0)
    cells = np.stack([x, y, z], axis=1)
    most = min(max(CANDIDATES * count, LEAST_CANDIDATES), len(cells))
    if count * most > MOST_NUMBERS:
        raise ValueError(
            complaint(
                "count",
                f"at most {MOST_NUMBERS} numbers of balls times candidates",
                f"{count} x {most}",
                'ask for fewer balls, or use method "full"',
            )
        )
    cells = cells[spaced_patterns(cells, most)]
    # Balls of one radius on voxels: products depend on their distance alone, and come,
    # like those with the density, from one transform.
    shape = padded_shape(work.density.shape, work.edges, 2.0 * radius)
    spectrum, power = ball_spectrum(shape, work.edges, radius, settings.kernel)
    products = np.fft.irfftn(spectrum**2, shape, AXES)
    density = np.fft.rfftn(work.density, shape, AXES)
    right = np.fft.irfftn(density * spectrum, shape, AXES)
    size = np.array(shape[::-1])

    def column(k: int) -> Array:
        i, j, h = ((cells - cells[k]) % size).T
        return products[h, j, i]

    x, y, z = cells.T
    diagonal = np.full(len(cells), power)
    chosen = chosen_columns(column, diagonal, right[z, y, x], count)
    fit = Fit(
        cells[chosen] * work.edges,
        np.full(len(chosen), radius),
        np.zeros(len(chosen)),
    )
    return with_heights(work, fit, settings.kernel)
