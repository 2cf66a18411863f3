"""A puff of smoke in the plane: a circle by its distance function, distorted by noise.

The distance to a point is a circular pattern. Noise added to it moves the circle's edge
in and out, by as much as its amplitude says; noise that is animated makes it billow. It
stands in for the still picture of a particle.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np

from refcloud.checking import check_fields, checked
from refcloud.conventions import Array, Positive, Range, Seed, Shape
from refcloud.noise import fbm
from refcloud.noise.octaves import Octaves
from refcloud.noise.scattered import Dtype

Combination = Literal["distort", "multiply"]


@dataclass(frozen=True)
class Puff:
    """A puff.

    Attributes
    ----------
    radius
        Of the circle without noise, scene units.
    cell
        Of the noise's first octave, scene units.
    distortion
        How far noise 1 moves the edge, radii.
    softness
        Over which density rises from 0 to 1 inside the edge, radii.
    combine
        "distort" adds the noise to the distance, "multiply" multiplies the circle's
        own density by noise in [0, 1].
    octaves
        Of the noise.
    seed
        Which pattern.
    period
        Units of time after which the noise repeats, and cells along x and y.
    """

    radius: Annotated[float, Positive] = 1.0
    cell: Annotated[float, Positive] = 0.5
    distortion: Annotated[float, Range(0.0, 10.0, "radii")] = 0.9
    softness: Annotated[float, Range(0.0, 10.0, "radii", open_lower=True)] = 0.45
    combine: Combination = "distort"
    octaves: Octaves = 5
    seed: Seed = 0
    period: Annotated[int, Range(1, 2**20)] = 16

    def __post_init__(self) -> None:
        check_fields(self)


@checked
def puff_density(
    points: Annotated[Array, Shape("...", 2), Range()],
    puff: Puff,
    *,
    time: Annotated[float, Range(-1e6, 1e6)] = 0.0,
    dtype: Dtype = "float64",
) -> Array:
    """Give how dense a puff is at places of its plane.

    Formula: clip((1 - |p| / radius + distortion n) / softness, 0, 1), or clip((1 - |p|
    / radius) / softness, 0, 1) (1 + n) / 2, for n = fbm(p / cell, time)

    Parameters
    ----------
    points
        Places around the puff's middle, shape (..., 2), scene units.
    puff
        The puff.
    time
        The noise's third coordinate.
    dtype
        Precision of the noise.

    Returns
    -------
    Density in [0, 1], shape (...,); 0 beyond (1 + distortion) radii.

    Source: document S, section 2 and appendix D (V10, N24).

    Examples
    --------
    >>> puff_density([[0.0, 0.0], [5.0, 0.0]], Puff(distortion=0.0))
    array([1., 0.])
    """
    inside = 1.0 - np.hypot(points[..., 0], points[..., 1]) / puff.radius
    # Nothing shows farther out, so no noise is summed there.
    reach = puff.distortion if puff.combine == "distort" else 0.0
    shown = inside > -reach
    noise = np.zeros(inside.shape)
    noise[shown] = fbm(
        points[shown] / puff.cell,
        time=time,
        seed=puff.seed,
        octaves=puff.octaves,
        period=puff.period,
        dtype=dtype,
    )
    if puff.combine == "multiply":
        circle = np.clip(inside / puff.softness, 0.0, 1.0)
        return circle * (0.5 + 0.5 * noise)
    return np.clip((inside + puff.distortion * noise) / puff.softness, 0.0, 1.0)
