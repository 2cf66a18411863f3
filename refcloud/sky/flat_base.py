"""A layer of clouds with a flat base, seen from below and lit through its thickness.

A ray from the eye meets the base at the document's blue dot. The light that leaves it
toward the eye entered the cloud at the red dot, where the line from the blue one toward
the sun leaves the cloud; on the way density is added up at places evenly spaced.

Noise says how high the cloud stands over each place of its base: at height y its
density is what is left of the noise above the threshold when y is taken away. So the
base is flat, tops are rounded, and noise is density, most of it where noise is high.

The noise may be a function that sums octaves for every sample, or a texture that they
were drawn to before (R09): the march is the same.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from refcloud.checking import check_fields, checked
from refcloud.conventions import Array, Positive, Range, Shape, Vector, unit_vector
from refcloud.refusal import complaint

# Places on the base, shape (N, 2), to noise, shape (N,).
Pattern = Callable[[Array], Any]
LOWEST_SUN = 0.02  # sine of elevation: a lower sun's light crosses 50 thicknesses


@dataclass(frozen=True)
class FlatBase:
    """A layer of clouds with a flat base.

    Attributes
    ----------
    threshold
        Noise below it is open sky.
    slope
        Height, in thicknesses, and density per noise above the threshold.
    thickness
        Of the layer.
    sigma_t
        Extinction per unit length at density 1.
    steps
        Places at which density is taken on the way to the sun.
    """

    threshold: Annotated[float, Range(-2.0, 2.0, "noise")] = 0.0
    slope: Annotated[float, Range(0.0, 1e6, "1/noise")] = 2.0
    thickness: Annotated[float, Positive] = 0.5
    sigma_t: Annotated[float, Range(0.0, 1e6, "1/scene unit")] = 6.0
    steps: Annotated[int, Range(1, 4096)] = 16

    def __post_init__(self) -> None:
        check_fields(self)


@checked
def base_density(
    noise: Annotated[Array, Shape("..."), Range()],
    height: Annotated[Array, Shape("..."), Range(0.0, unit="scene units")],
    layer: FlatBase,
) -> Array:
    """Give the density of a layer at heights above its flat base.

    Formula: max(min(slope (noise - threshold), 1) - height / thickness, 0)

    Parameters
    ----------
    noise
        Over the place, any shape.
    height
        Above the base, a shape that broadcasts.
    layer
        The layer.

    Returns
    -------
    Density in [0, 1].

    Source: document S, section 5.1 (V08).

    Examples
    --------
    >>> base_density([0.1, 0.4], 0.1, FlatBase(slope=2, thickness=0.5))
    array([0. , 0.6])
    """
    risen = np.minimum(layer.slope * (noise - layer.threshold), 1.0)
    return np.maximum(risen - height / layer.thickness, 0.0)


@checked
def light_from_above(
    places: Annotated[Array, Shape("N", 2), Range()],
    pattern: Callable,
    layer: FlatBase,
    *,
    sun: Vector,
) -> Array:
    """Give the share of the sun's light that reaches the base of a layer.

    Formula: T = exp(-sigma_t d sum of density at (i + 1/2) d toward the sun), d =
    thickness / sine of elevation / steps

    Parameters
    ----------
    places
        x and z on the base, shape (N, 2), scene units.
    pattern
        Called with places, shape (N, 2); gives the noise there, shape (N,).
    layer
        The layer.
    sun
        Direction toward the sun, shape (3,), above the horizon.

    Returns
    -------
    Transmittance in [0, 1], shape (N,).

    Raises
    ------
    ValueError
        The sun stands too low.

    Source: document S, section 5.1 and figure 2 (R08, R09).

    Examples
    --------
    >>> full = light_from_above(
    ...     [[0, 0]], lambda p: np.ones(len(p)), FlatBase(sigma_t=4), sun=[0, 1, 0]
    ... )
    >>> full.round(6)  # exp(-4 0.5 / 2)
    array([0.367879])
    """
    toward = unit_vector(sun, "sun")
    if toward[1] < LOWEST_SUN:
        expected = f"a direction above the horizon, sine at least {LOWEST_SUN}"
        raise ValueError(complaint("sun", expected, f"{toward[1]:.3g}"))
    step = layer.thickness / toward[1] / layer.steps
    depth = np.zeros(len(places))
    for i in range(layer.steps):
        far = (i + 0.5) * step
        noise = np.asarray(pattern(places + far * toward[[0, 2]]), np.float64)
        depth += base_density(noise, far * toward[1], layer)
    return np.exp(-layer.sigma_t * step * depth)
