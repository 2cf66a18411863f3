"""Light that was not scattered yet: from suns and from outside, at each voxel."""

from __future__ import annotations

from dataclasses import dataclass
from dataclasses import field as dataclass_field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array
from refcloud.optics import Medium
from refcloud.transport.beams import Beams, next_to
from refcloud.transport.delta_m import delta_m
from refcloud.transport.directions import Directions
from refcloud.transport.harmonics import harmonics
from refcloud.transport.levels import halved, halved_light
from refcloud.transport.sunlight import cell_mean
from refcloud.transport.sweep import step_of
from refcloud.transport.swept import swept_terms

Reals = NDArray[np.floating[Any]]
LEVEL = 1e-12  # a direction that rises less than this runs along the horizon


@dataclass(frozen=True)
class Light:
    """What shines on a grid: a batch of B cases that differ in colour alone.

    Attributes
    ----------
    toward
        Unit vectors toward the suns, shape (S, 3).
    columns
        Column densities from each voxel to each sun, shape (S, D, H, W).
    irradiance
        Of each sun in each case, shape (B, S).
    sky, ground
        Radiance from above and from below, shape (B,).
    """

    toward: Array
    columns: Reals
    irradiance: Array
    sky: Array
    ground: Array


@dataclass(frozen=True)
class Field:
    """A grid of matter of one colour.

    Attributes
    ----------
    density
        Shape (D, H, W), every axis a multiple of what the plan halves.
    cell
        Edges of a voxel in x, y, z.
    medium
        Grey: one sigma_t and one albedo.
    """

    density: Array
    cell: Array
    medium: Medium


@dataclass(frozen=True)
class Shone:
    """Sunlight on a field, by the degree of the scaled medium and by halvings."""

    field: Field
    light: Light
    norms: dict[float, Array]
    known: dict[tuple[int, int], list[Array]] = dataclass_field(default_factory=dict)

    def at(self, degree: int, halvings: int) -> list[Array]:
        """Give the mean transmittance to each sun in each voxel, (D, H, W) each.

        It is found on the finest grid, then averaged as the matter sees it.
        """
        if (degree, halvings) in self.known:
            return self.known[degree, halvings]
        density = self.field.density
        if halvings:
            finer = self.at(degree, halvings - 1)
            for _ in range(halvings - 1):
                density = halved(density)
            found = [halved_light(sun, density) for sun in finer]
        else:
            scaled = delta_m(self.field.medium, degree)
            sigma, near = float(scaled.sigma_t[0]), np.nonzero(next_to(density > 0.0))
            found = []
            for toward, columns, norm in zip(
                self.light.toward,
                self.light.columns,
                self.norms[scaled.forward],
                strict=True,
            ):
                path = step_of(toward, self.field.cell).length
                own = density[near] * (sigma * path)
                sun = np.zeros(density.shape)
                sun[near] = norm * cell_mean(sigma * columns[near], own)
                found.append(sun)
        self.known[degree, halvings] = found
        return found


def sun_moments(
    light: Light,
    suns: list[Array],
    degree: int,
    places: NDArray[np.intp],
    beams: Beams,
    dtype: Any,
) -> Reals:
    """Give the harmonics of parallel light in the near voxels, shape (R, B, M)."""
    B, M = len(light.irradiance), len(beams.near[0])
    along = harmonics(-light.toward, degree)[:, places]  # (S, R)
    colours = along.T[:, None] * light.irradiance  # (R, B, S)
    reaching = np.array([sun[beams.near] for sun in suns], dtype).reshape(len(suns), M)
    found = colours.reshape(len(places) * B, len(suns)).astype(dtype) @ reaching
    return found.reshape(len(places), B, M)


def boundary(directions: Directions, sky: Array, ground: Array) -> Array:
    """Give the radiance that enters along each direction: (N, B) from (B,) and (B,)."""
    rise = directions.vectors[:, 1, None]
    level = np.abs(rise) < LEVEL  # the mean of both
    return np.where(level, 0.5 * (sky + ground), np.where(rise < 0.0, sky, ground))


def inflow_moments(
    light: Light, directions: Directions, beams: Beams, Y: Array, dtype: Any
) -> Reals | None:
    """Carry light from outside to each voxel, unscattered, and take its moments."""
    if not (light.sky.any() or light.ground.any()):
        return None
    outside = boundary(directions, light.sky, light.ground)
    V = Y.T * directions.weights
    # Outside is dark to the sweep: the inflow is taken off everywhere and put back.
    M = len(beams.near[0])
    parts = []
    for case in range(outside.shape[1]):
        source = np.zeros((1, outside.shape[1], M), dtype)
        source[0, case] = 1.0
        lost = swept_terms(source, beams, -outside[:, case, None], V)[:, case]
        parts.append(lost + (V @ outside[:, case]).astype(dtype)[:, None])
    return np.stack(parts, axis=1)
