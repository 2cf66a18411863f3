"""The scene ``multiple``: the large cumulus, marched, every order of scattering in it.

Single scattering alone shows a sixth of the light of such a cloud. Here the rest is
solved along lattice directions, and the cloud is as white as clouds are.
"""

from __future__ import annotations

import dataclasses
import functools
import time
from dataclasses import dataclass
from functools import partial
from typing import Annotated

import numpy as np

from refcloud.camera import Camera
from refcloud.checking import check_fields
from refcloud.choices import AMBIENT
from refcloud.cloudmap import VoxelGrid, generate
from refcloud.conventions import WHOLE_SPHERE, Positive, Range, Seed, Vector
from refcloud.declared import Kind, enter_kind
from refcloud.image import Picture
from refcloud.march.quadrature import grid_through_the_middle
from refcloud.march_picture import draw_march
from refcloud.optics import Medium, Sun
from refcloud.refusal import complaint
from refcloud.scene import Model, Motion, Own, View
from refcloud.scenes import cumulus
from refcloud.sky import Sky

# Edge of a voxel, scene units times pixels of width: a picture and its cloud are as
# fine as each other, between these edges.
FINENESS, FINEST, COARSEST = 380.0, 0.8, 4.0


@dataclass(frozen=True)
class Multiple:
    """A marched cumulus with every order of scattering.

    Attributes
    ----------
    seed
        Which cloud.
    eye, target
        The camera.
    sun
        The light.
    thickness
        Optical depth through the cloud's middle.
    g
        Mean cosine of scattering.
    """

    seed: Seed
    eye: Vector
    target: Vector
    sun: Sun
    thickness: Annotated[float, Positive]
    g: Annotated[float, Range(-1.0, 1.0, open_lower=True, open_upper=True)]

    def __post_init__(self) -> None:
        check_fields(self)


OWN = Multiple(
    seed=cumulus.OWN.hero.seed,
    eye=cumulus.OWN.eye,
    target=cumulus.OWN.target,
    # The sun of the other pictures, so strong that the brightest parts are white.
    sun=Sun(
        np.array([-0.62, 0.62, 0.42]), 0.5 * WHOLE_SPHERE * np.array([1.0, 0.96, 0.89])
    ),
    thickness=24.0,
    g=0.6,
)


def fineness(width: int) -> float:
    """Give the edge of a voxel for a picture so many pixels wide."""
    return float(np.clip(FINENESS / width, FINEST, COARSEST))


@functools.lru_cache(maxsize=1)
def cloud(seed: int, voxel: float) -> VoxelGrid:
    """Make the cloud once for its medium and its picture."""
    return generate(seed=seed, voxel=voxel)


def brings(of: Multiple, model: Model | None, view: View) -> Own:
    """Give the sun, and the medium that makes the cloud's middle so thick."""
    scattering = view.scattering or "multiple"
    medium = Medium(1.0, g=of.g, phase="hg")
    if model is None:
        return Own((of.sun,), medium, scattering=scattering, open=("sigma_t",))
    if view.medium is None:
        grid = cloud(of.seed, fineness(view.width))
        sigma_t = of.thickness / grid_through_the_middle(grid)
        medium = dataclasses.replace(medium, sigma_t=sigma_t)
    return Own((of.sun,), medium, scattering=scattering)


def draw(of: Multiple, model: Model, view: View) -> Picture:
    """Generate the cloud, solve its light and march it."""
    if view.look is not None:
        raise ValueError(complaint("look", "none beside marched light", "one"))
    camera = view.camera or own_eye(model, view, of=of)
    start = time.perf_counter()
    voxel = fineness(camera.width)
    grid = cloud(of.seed, voxel)
    made = time.perf_counter() - start
    own = brings(of, model, dataclasses.replace(view, width=camera.width))
    medium = view.medium or own.medium
    assert medium is not None
    picture = draw_march(
        grid,
        camera,
        own.suns or () if view.suns is None else view.suns,
        Sky(),
        medium=medium,
        ambient=AMBIENT,
        scattering=own.scattering or "multiple",
        tolerance=view.tolerance,
        observe=view.observe,
    )
    return dataclasses.replace(
        picture,
        seconds={"generate": made, **picture.seconds},
        notes=(f"cloud: voxels of {voxel:.3g}, {grid!r}", *picture.notes),
    )


def own_eye(model: Model, view: View, *, of: Multiple) -> Camera:
    """Look up at the cloud from below."""
    return Camera(of.eye, of.target, width=view.width, height=view.height)


def turning(of: Multiple) -> Motion:
    """Turn eye and sun."""
    return Motion(partial(own_eye, of=of), (of.sun,))


enter_kind(
    Kind(
        "multiple",
        "a cumulus with every order of scattering",
        OWN,
        draw,
        turning,
        uses=("scattering",),
        brings=brings,
    )
)
