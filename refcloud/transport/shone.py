"""Light that was not scattered yet: from suns and from outside, at each voxel."""

from __future__ import annotations

from dataclasses import dataclass
from dataclasses import field as dataclass_field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array
from refcloud.optics import Medium
from refcloud.products import product
from refcloud.transport.beams import Beams, next_to
from refcloud.transport.delta_m import ScaledMedium, delta_m
from refcloud.transport.directions import Directions
from refcloud.transport.folded import folded_beams
from refcloud.transport.harmonics import degree_of, harmonics
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
    behind
        The same away from each sun where a backward peak turns light round, else none.
    irradiance
        Of each sun in each case, shape (B, S).
    sky, ground
        Radiance from above and from below, shape (B,).
    """

    toward: Array
    columns: Reals
    behind: Reals | None
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
class Beam:
    """A sun's mean transmittance in each voxel.

    Attributes
    ----------
    on
        Of light that goes on, shape (D, H, W).
    back
        Of light that a backward peak turned round, or none.
    once
        What was never turned; where none was turned that is `on`.
    """

    on: Array
    back: Array | None
    once: Array

    def less(self, other: Beam) -> Beam:
        """Subtract another beam of this sun."""
        back = None
        if self.back is not None and other.back is not None:
            back = self.back - other.back
        return Beam(self.on - other.on, back, self.once - other.once)

    def halved(self, density: Array) -> Beam:
        """Average over blocks of voxels as the matter in them sees it."""
        on = halved_light(self.on, density)
        if self.back is None:
            return Beam(on, None, on)
        back, once = (halved_light(v, density) for v in (self.back, self.once))
        return Beam(on, back, once)


@dataclass(frozen=True)
class Shone:
    """Sunlight on a field, by the degree of the scaled medium and by halvings."""

    field: Field
    light: Light
    norms: dict[int, Array]
    known: dict[tuple[int, int], list[Beam]] = dataclass_field(default_factory=dict)

    def at(self, degree: int, halvings: int) -> list[Beam]:
        """Give the beam of each sun.

        It is found on the finest grid, then averaged as the matter sees it.
        """
        if (degree, halvings) in self.known:
            return self.known[degree, halvings]
        density = self.field.density
        if halvings:
            finer = self.at(degree, halvings - 1)
            for _ in range(halvings - 1):
                density = halved(density)
            found = [beam.halved(density) for beam in finer]
        else:
            found = [self._finest(degree, s) for s in range(len(self.light.toward))]
        self.known[degree, halvings] = found
        return found

    def _finest(self, degree: int, s: int) -> Beam:
        density, light = self.field.density, self.light
        scaled = delta_m(self.field.medium, degree)
        sigma, near = float(scaled.sigma_t[0]), np.nonzero(next_to(density > 0.0))
        norm = self.norms[degree][s]
        own = density[near] * (sigma * step_of(light.toward[s], self.field.cell).length)
        tau = sigma * light.columns[s][near]

        def spread(values: Array) -> Array:
            whole = np.zeros(density.shape)
            whole[near] = norm * values
            return whole

        turned = float(scaled.albedo[0]) * scaled.backward
        once = spread(cell_mean(tau, own))
        if light.behind is None or turned == 0.0:
            return Beam(once, None, once)
        whole = tau + sigma * light.behind[s][near]
        on, back = folded_beams(tau, whole, own, turned=turned)
        return Beam(spread(on), spread(back), once)


def sun_moments(
    light: Light,
    suns: list[Beam],
    scaled: ScaledMedium,
    places: NDArray[np.intp],
    beams: Beams,
    dtype: Any,
    *,
    smooth: bool = True,
    more_than_once: bool = False,
) -> Reals:
    """Give the harmonics of parallel light in the near voxels, shape (R, B, M).

    With `smooth` they count as the phase function without its backward peak sees them;
    `more_than_once` leaves out what was never turned round.
    """
    B, M, S = len(light.irradiance), len(beams.near[0]), len(suns)
    degrees = degree_of(places)
    along = harmonics(-light.toward, len(scaled.moments) - 1)[:, places]  # (S, R)
    if smooth and scaled.backward > 0.0:
        chi = np.abs(scaled.moments[degrees])
        along = along * (1.0 - scaled.backward / chi)
    colours = along.T[:, None] * light.irradiance  # (R, B, S)
    colours = colours.reshape(len(places) * B, S).astype(dtype)

    def picked(volumes: list[Array]) -> Reals:
        near = [volume[beams.near] for volume in volumes]
        return np.array(near, dtype).reshape(S, M)

    on = picked([sun.on - sun.once if more_than_once else sun.on for sun in suns])
    found = product(colours, on).reshape(len(places), B, M)
    if all(sun.back is not None for sun in suns) and S:
        back = picked([sun.back for sun in suns if sun.back is not None])
        against = product(colours, back).reshape(len(places), B, M)
        odd = degrees % 2 == 1  # harmonics of odd degree turn their sign with the beam
        against[odd] *= -1.0
        found += against
    return found


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
