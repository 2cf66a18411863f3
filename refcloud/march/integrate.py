"""Any rays through a cloud: the one call of the march."""

from __future__ import annotations

from functools import partial
from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.cloudmap import VoxelGrid
from refcloud.conventions import Array, Colour, Observer, Range, Shape, Tolerance
from refcloud.march.marched import marched
from refcloud.march.mixing import PHYSICAL, Mixing
from refcloud.march.multiple import Scattering, marched_multiple
from refcloud.march.rays import as_rays, shaped
from refcloud.metaballs import Metaballs
from refcloud.optics import Medium, Sun
from refcloud.refusal import complaint
from refcloud.transport import LightVolume


@checked
def integrate(
    cloud: VoxelGrid | Metaballs,
    origins: Annotated[Array, Shape("...", 3)],
    directions: Annotated[Array, Shape("...", 3)],
    *,
    suns: Sun | tuple[Sun, ...],
    medium: Medium,
    tolerance: Tolerance = 0.0,
    background: Colour | Annotated[Array, Shape("...", 3), Range(0.0)] | None = None,
    ambient: Colour | None = None,
    mixing: Mixing = PHYSICAL,
    scattering: Scattering = "single",
    volumes: tuple[LightVolume, ...] = (),
    observe: Observer | None = None,
) -> tuple[Array, Array]:
    """Integrate scattered light along any rays.

    Formula: L = albedo p(cos_theta) E int sigma_t rho exp(-tau_view) exp(-tau_sun) dt
    + albedo ambient (1 - T) + T background, summed over the suns

    Parameters
    ----------
    cloud
        A cloud map, or metaballs, whose chords are known in closed form.
    origins, directions
        Of the rays, shape (..., 3) each, scene units; directions of any length but 0.
        They broadcast.
    suns
        The lights.
    medium
        What the cloud is made of.
    tolerance
        Largest error of a channel that savings may make; 0 is a quadrature in every
        space between voxel centres. Metaballs are exact at any.
    background
        What lies behind, linear RGB, one colour or shape (..., 3); None for nothing.
    ambient
        Radiance that arrives from all sides alike, RGB; None for none. With albedo 1
        this term holds every order of scattering.
    mixing
        Factors without a counterpart in physics, off by default.
    scattering
        "single" counts light that is scattered once; "multiple" solves the rest
        (`refcloud.transport.scattered_light`); or that light, solved before.
    volumes
        Light volumes that an earlier call handed to its `observe` as "light volumes":
        those of this cloud and these suns are not made again. Tolerance 0 has no use
        for them.
    observe
        Called with (name, value) for each intermediate; "skipped" last.

    Returns
    -------
    Radiance of shape (..., 3), and transmittance of shape (...,), or (..., 3) by
    channel where sigma_t is RGB.

    Raises
    ------
    ValueError
        Shapes do not fit, or a direction is zero.

    Source: document D (R02 to R05); E20, E36, E38.

    Examples
    --------
    >>> grid = VoxelGrid(np.ones((2, 2, 2)), [0, 0, 0], [2, 2, 2])
    >>> how = dict(suns=Sun([0, 0, 1]), medium=Medium(0.5, phase="isotropic"))
    >>> L, T = integrate(grid, [1.0, 1, 9], [[0.0, 0, -1]], **how)
    >>> L.round(4), T.round(4)
    (array([[0.4323, 0.4323, 0.4323]]), array([0.3679]))
    """
    rays = as_rays(origins, directions)
    behind = None
    if background is not None:
        if background.shape not in ((3,), (*rays.shape, 3)):
            expected = f"shape (3,) or {(*rays.shape, 3)}, that of the rays"
            got = f"shape {background.shape}"
            raise ValueError(complaint("background", expected, got))
        behind = np.broadcast_to(background, (*rays.shape, 3)).reshape(-1, 3)
    march = marched
    if scattering != "single":
        march = partial(marched_multiple, scattering=scattering)
    found = march(
        cloud,
        rays.origins,
        rays.directions,
        suns=(suns,) if isinstance(suns, Sun) else suns,
        medium=medium,
        ambient=ambient,
        mixing=mixing,
        tolerance=tolerance,
        background=behind,
        observe=observe,
        volumes=volumes,
        shape=rays.shape,
    )
    if observe is not None:
        observe("skipped", found.skipped)
    return shaped(found.radiance, found.transmittance, rays, medium)
