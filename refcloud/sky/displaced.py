"""A sphere whose vertices noise moves in and out, with normals from its derivative.

Every vertex goes along its own direction d to radius r(d) = 1 + amount n(d, time). The
surface r(d) d has the normal r d - grad r, where of the gradient only the part along
the sphere counts: noise with an analytic derivative (N23) gives it with the value, and
no neighbour is asked.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from refcloud.checking import check_fields, checked
from refcloud.conventions import UNIT, Array, Range, Seed, Shape
from refcloud.noise import octave_bound, octave_frame, simplex_derivative, uniform
from refcloud.noise.octaves import Octaves, Persistence


@dataclass(frozen=True)
class Displacement:
    """How far and how finely a sphere's vertices are moved.

    Attributes
    ----------
    amount
        Share of the radius that noise 1 moves a vertex; below 1, so that no vertex
        reaches the middle.
    frequency
        Cells of the first octave per radius.
    octaves
        1 is a noise function, as the document has it; more are fBm, which it suggests.
    persistence
        Each octave's amplitude relative to the one before.
    seed
        Which pattern.
    """

    amount: Annotated[float, Range(0.0, 1.0, open_upper=True)] = 0.35
    frequency: Annotated[float, Range(1e-100, 1e100)] = 1.4
    octaves: Octaves = 1
    persistence: Persistence = 0.5
    seed: Seed = 0

    def __post_init__(self) -> None:
        check_fields(self)


@checked
def displaced_sphere(
    directions: Annotated[Array, Shape("N", 3), UNIT],
    displacement: Displacement,
    *,
    time: Annotated[float, Range(-1e6, 1e6)] = 0.0,
) -> tuple[Array, Array]:
    """Move a unit sphere's vertices, and give the normals there.

    Formula: r = 1 + amount n(frequency d, time), point r d, normal along r d - (grad r
    - (grad r . d) d), for n = sum of s^i n_i / sum of s^i

    Parameters
    ----------
    directions
        Unit vectors, shape (N, 3).
    displacement
        How far and how finely.
    time
        The noise's fourth coordinate.

    Returns
    -------
    Points and unit normals, each of shape (N, 3).

    Source: document S, section 2 and appendix E (V11, N22, N23, N24).

    Examples
    --------
    >>> points, normals = displaced_sphere([[0, 1, 0]], Displacement(amount=0))
    >>> points, normals
    (array([[0., 1., 0.]]), array([[0., 1., 0.]]))
    """
    n, slope = np.zeros(len(directions)), np.zeros_like(directions)
    for i in range(displacement.octaves):
        own, _ = octave_frame(i, seed=displacement.seed)
        shift = uniform(i, np.arange(4), seed=displacement.seed)
        assert own is not None
        scale = 2.0**i * displacement.frequency
        at = np.column_stack([scale * directions, np.full(len(n), 2.0**i * time)])
        value, change = simplex_derivative(at + shift, seed=own)
        weight = displacement.persistence**i
        n += weight * value
        slope += weight * scale * change[:, :3]
    bound = octave_bound(displacement.octaves, displacement.persistence)
    r = (1.0 + displacement.amount * n / bound)[:, None]
    slope *= displacement.amount / bound
    outward = np.einsum("ij,ij->i", slope, directions)[:, None]
    normals = r * directions - (slope - outward * directions)
    normals /= np.sqrt(np.square(normals).sum(axis=1, keepdims=True))
    return r * directions, normals
