"""What lights a cloud and what it is made of."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated, Literal

import numpy as np

from refcloud.checking import check_fields
from refcloud.conventions import WHOLE_SPHERE, Array, Range, Shape, Vector, unit_vector

Share = Annotated[float, Range(0.0, 1.0)]
PhaseName = Literal["hg", "rayleigh", "isotropic"]


@dataclass(frozen=True)
class Sun:
    """A light so far away that its rays are parallel.

    Attributes
    ----------
    direction
        Toward the sun, shape (3,), any length but 0; kept as a unit vector.
    irradiance
        Light on a plane across the direction, shape (3,), radiance times steradian.
        With the default 4 pi an isotropic scatterer of albedo 1 shows radiance 1.
    """

    direction: Vector
    irradiance: Annotated[Array, Shape(3), Range(0.0, unit="radiance sr")] = field(
        default_factory=lambda: np.full(3, WHOLE_SPHERE)
    )

    def __post_init__(self) -> None:
        check_fields(self)
        object.__setattr__(self, "direction", unit_vector(self.direction))


@dataclass(frozen=True)
class Medium:
    """What a cloud is made of.

    Attributes
    ----------
    sigma_t
        Extinction at density 1, number or RGB, 1 / scene unit.
    albedo
        Scattered share of extinction, number or RGB, in [0, 1].
    g
        Mean cosine of the Henyey-Greenstein phase function, in (-1, 1).
    phase
        Which phase function.
    """

    sigma_t: (
        Annotated[float, Range(0.0, unit="1 / scene unit")]
        | Annotated[Array, Shape(3), Range(0.0, unit="1 / scene unit")]
    )
    albedo: Share | Annotated[Array, Shape(3), Range(0.0, 1.0)] = 1.0
    g: Annotated[float, Range(-1.0, 1.0, open_lower=True, open_upper=True)] = 0.0
    phase: PhaseName = "rayleigh"

    def __post_init__(self) -> None:
        check_fields(self)

    @property
    def sigma_t_rgb(self) -> Array:
        """Extinction by channel, shape (3,), 1 / scene unit."""
        return np.broadcast_to(self.sigma_t, (3,))

    @property
    def albedo_rgb(self) -> Array:
        """Scattered share of extinction by channel, shape (3,)."""
        return np.broadcast_to(self.albedo, (3,))
