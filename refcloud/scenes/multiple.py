"""The scene ``multiple``: the large cumulus, marched, every order of scattering in it.

Single scattering alone shows a sixth of the light of such a cloud. Here the rest is
solved along lattice directions, and the cloud is as white as clouds are.
"""

from __future__ import annotations

import dataclasses
import time

import numpy as np

from refcloud.choices import AMBIENT
from refcloud.cloudmap import generate
from refcloud.conventions import WHOLE_SPHERE
from refcloud.image import Picture
from refcloud.march.quadrature import grid_through_the_middle
from refcloud.march_picture import draw_march
from refcloud.optics import Medium, Sun
from refcloud.refusal import complaint
from refcloud.scene import Model, Motion, Scene, View, enter
from refcloud.scenes import cumulus
from refcloud.sky import Sky

# The sun of the other pictures, at a strength that leaves the brightest parts white.
LATE_MORNING = Sun(
    np.array([-0.62, 0.62, 0.42]), 0.5 * WHOLE_SPHERE * np.array([1.0, 0.96, 0.89])
)
THICKNESS, G = 24.0, 0.6  # optical depth through the middle; clouds scatter forward
# Edge of a voxel, scene units times pixels of width: a picture and its cloud are as
# fine as each other, between these edges.
FINENESS, FINEST, COARSEST = 380.0, 0.8, 4.0


def no_model() -> Model:
    """Make nothing yet: how fine the cloud is, its picture says."""
    return Model({})


def draw(model: Model, view: View) -> Picture:
    """Generate the cloud, solve its light and march it."""
    if view.look is not None:
        raise ValueError(complaint("look", "none beside marched light", "one"))
    camera = view.camera or cumulus.camera(view)
    start = time.perf_counter()
    voxel = float(np.clip(FINENESS / camera.width, FINEST, COARSEST))
    grid = generate(seed=cumulus.SEED, voxel=voxel)
    made = time.perf_counter() - start
    sigma_t = THICKNESS / grid_through_the_middle(grid)
    picture = draw_march(
        grid,
        camera,
        (LATE_MORNING,) if view.suns is None else view.suns,
        Sky(),
        medium=view.medium or Medium(sigma_t, g=G, phase="hg"),
        ambient=AMBIENT,
        scattering="multiple",
        tolerance=view.tolerance,
        observe=view.observe,
    )
    return dataclasses.replace(
        picture,
        seconds={"generate": made, **picture.seconds},
        notes=(f"cloud: voxels of {voxel:.3g}, {grid!r}", *picture.notes),
    )


enter(
    Scene(
        "multiple",
        "a cumulus with every order of scattering",
        no_model,
        draw,
        Motion(cumulus.eye, (LATE_MORNING,)),
    )
)
