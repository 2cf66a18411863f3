"""The gradient sets, and how large noise made of them can get.

The true bound of a noise is the largest sum, over all places, of each corner's weight
times the best that any gradient of the set does there: every corner may have that one.
Where a sum has no closed form, it was enclosed by branch and bound, and the constant
here is an upper end that a test encloses once more.
"""

from __future__ import annotations

import itertools
import math
from typing import Annotated, Literal

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Range
from refcloud.refusal import complaint

Gradients = Literal["directions8", "diagonals4", "edges12", "corners8", "edges32"]
Fade = Literal["quintic", "hermite"]
Radius = Literal["continuous", "usual"]

HALF = math.sqrt(0.5)
DIAGONAL = [(HALF, HALF), (-HALF, HALF), (-HALF, -HALF), (HALF, -HALF)]


def _with_zeros(dimensions: int, zeros: int) -> Array:
    """List the vectors of -1, 0 and 1 with so many zeros, in order."""
    every = itertools.product((-1.0, 0.0, 1.0), repeat=dimensions)
    return np.array([vector for vector in every if vector.count(0.0) == zeros])


SETS: dict[Gradients, Array] = {
    # Eight unit vectors in the plane, an eighth of a turn apart.
    "directions8": np.array([(1, 0), (0, 1), (-1, 0), (0, -1), *DIAGONAL]),
    # Sums and differences alone, no multiplications: a square's and a cube's corners,
    # and the middles of the edges of a cube and of a tesseract.
    "diagonals4": _with_zeros(2, 0),
    "edges12": _with_zeros(3, 1),
    "corners8": _with_zeros(3, 0),
    "edges32": _with_zeros(4, 1),
}
USUAL: dict[int, Gradients] = {2: "directions8", 3: "edges12", 4: "edges32"}

# Largest |noise| before scaling, by gradient set and fade. With unit gradients of all
# directions it is sqrt(N)/2, in the middle of a cell, for both fades w: the sum of
# weights times |d| is at most the root of the sum of weights times |d|^2, whose part of
# each axis t^2 + w (1 - 2t) stays below 1/4, as w <= t below 1/2. The eight directions
# hold the diagonals that reach it. For the corners each axis adds t + w (1 - 2t), which
# is 1/2 at most.
PEAKS: dict[Gradients, dict[Fade, float]] = {
    "directions8": {"quintic": HALF, "hermite": HALF},
    "diagonals4": {"quintic": 1.0, "hermite": 1.0},
    "edges12": {"quintic": 1.047, "hermite": 1.0555},  # enclosed
    "corners8": {"quintic": 1.5, "hermite": 1.5},
    "edges32": {"quintic": 1.565, "hermite": 1.575},  # enclosed
}


@checked
def gradient_set(
    name: Gradients | None = None, *, dimensions: Annotated[int, Range(2, 4)] = 3
) -> Array:
    """Give the gradients that a lattice point's bits choose from.

    Formula: cube edges: all (+-1, +-1, 0), (+-1, 0, +-1), (0, +-1, +-1)

    Parameters
    ----------
    name
        Which set. None is the usual one: "directions8" in the plane, "edges12" in
        space, "edges32" in four dimensions.
    dimensions
        How many coordinates a place has, 2 to 4.

    Returns
    -------
    One gradient per row, shape (count, dimensions).

    Raises
    ------
    ValueError
        The set is one of another number of dimensions.

    Source: document S (N21).

    Examples
    --------
    >>> gradient_set(dimensions=3).shape
    (12, 3)
    """
    return SETS[_named(name, dimensions)].copy()


def _named(name: Gradients | None, dimensions: int) -> Gradients:
    """Give the set's name, refused where it does not fit the dimensions."""
    if name is None:
        return USUAL[dimensions]
    if SETS[name].shape[1] != dimensions:
        fit = [key for key, rows in SETS.items() if rows.shape[1] == dimensions]
        expected = f"a set for {dimensions} coordinates: {' or '.join(map(repr, fit))}"
        raise ValueError(complaint("gradients", expected, repr(name)))
    return name
