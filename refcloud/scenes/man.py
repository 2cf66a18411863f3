"""The figures of paper M that are pictures of clouds, as scenes.

Figure 4 is the cloud map, one ball per voxel. Figures 8 to 10 show clusters whose
densities the paper never fitted. Figures 13 and 14 differ in the phase function alone:
"constant 1", and a lobe strong enough to show the silver lining that the text
describes; eq 25, which the text names, brightens by 1.5 at most
(``refcloud.render("man-14", medium=Medium(1, 0.9))`` shows that).

All of them follow the paper's rules to the letter; ``look="cumulus"`` shows what the
extensions change.
"""

from __future__ import annotations

import dataclasses
import time
from functools import partial

import numpy as np

from refcloud.camera import AnyCamera, Camera
from refcloud.cloudmap import VoxelGrid, generate
from refcloud.compose import Layer, draw_layers
from refcloud.conventions import WHOLE_SPHERE
from refcloud.image import Picture
from refcloud.lighting import named
from refcloud.metaballs import approximate, placed, prune, voxel_balls
from refcloud.optics import ALBEDO_MAN2003, Medium, Sun
from refcloud.render import framed
from refcloud.scene import Model, Motion, Scene, View, enter
from refcloud.scenes import cumulus
from refcloud.sky import Sky

# Figure 4: Z = 4, s = 0.5, t = 0.1, d = 1; this seed gives 11,011 voxels.
SEED = 2
OVERLAP = 2.0  # u of figures 8 to 10
CLOUD_MEDIUM = Medium(1.0, ALBEDO_MAN2003)  # sigma_t is not used: every ball has tau 8
FRONT = Sun(np.array([-0.62, 0.62, 0.42]), np.full(3, 1.6 * WHOLE_SPHERE))

# Figures 13 and 14: the sun stands behind the cloud, just over its summit.
BEHIND = Sun(np.array([0.10, 0.36, -0.93]), np.full(3, 0.5 * WHOLE_SPHERE))
EVENING = Sky(
    zenith=np.array([0.02, 0.075, 0.26]),
    horizon=np.array([0.15, 0.29, 0.54]),
    haze=np.array([0.42, 0.52, 0.66]),
    glow=0.008,
)
ISOTROPIC = Medium(1.0, ALBEDO_MAN2003, phase="isotropic")
FORWARD = Medium(1.0, ALBEDO_MAN2003, g=0.5, phase="hg")


def cloud_map() -> VoxelGrid:
    """Generate the cloud of figure 4."""
    return generate("ellipsoid", seed=SEED, octaves=4, persistence=0.5, threshold=0.1)


def voxel_model() -> Model:
    """Take one ball per occupied voxel."""
    start = time.perf_counter()
    grid = cloud_map()
    balls = voxel_balls(grid)
    seconds = {"generate": time.perf_counter() - start}
    note = f"cloud: {len(balls.radii)} voxels"
    return Model({"cloud": balls}, (note,), grid.skipped, seconds)


def cluster_model(count: int) -> Model:
    """Run phases 1 and 2; every ball keeps density 1, as in the paper's figures."""
    start = time.perf_counter()
    grid = cloud_map()
    middle = time.perf_counter()
    fitted = approximate(grid, count=count, method="man", overlap=OVERLAP, seed=SEED)
    balls = dataclasses.replace(fitted, densities=np.ones(len(fitted.radii)))
    seconds = {
        "generate": middle - start,
        "approximate": time.perf_counter() - middle,
    }
    note = f"cloud: {len(balls.radii)} balls, densities not fitted"
    return Model({"cloud": balls}, (note,), grid.skipped, seconds)


def shading_model() -> Model:
    """Take the balls of the scene ``cumulus``."""
    start = time.perf_counter()
    grid = generate(seed=cumulus.SEED)
    middle = time.perf_counter()
    fitted = approximate(grid, count=cumulus.COUNT, seed=cumulus.SEED)
    balls = placed(prune(fitted), np.zeros(3), turn=cumulus.TURN)
    seconds = {
        "generate": middle - start,
        "approximate": time.perf_counter() - middle,
    }
    note = f"cloud: {len(balls.radii)} balls"
    return Model({"cloud": balls}, (note,), grid.skipped, seconds)


def draw_front(model: Model, view: View) -> Picture:
    """Draw a cloud framed by itself, the sun in front."""
    camera = view.camera or in_front(model, view)
    return _draw(model, view, camera, FRONT, CLOUD_MEDIUM, Sky())


def in_front(model: Model, view: View) -> Camera:
    """Frame the cloud by itself."""
    return framed(model.clouds["cloud"], view.width, view.height)


def draw_behind(model: Model, view: View, medium: Medium) -> Picture:
    """Draw the large cloud of ``cumulus`` against the sun."""
    camera = view.camera or cumulus.camera(view)
    return _draw(model, view, camera, BEHIND, medium, EVENING)


def _draw(
    model: Model, view: View, camera: AnyCamera, sun: Sun, medium: Medium, sky: Sky
) -> Picture:
    layer = Layer(
        model.clouds["cloud"], view.medium or medium, named(view.look or "man")
    )
    return draw_layers(
        [layer],
        camera,
        (sun,) if view.suns is None else view.suns,
        sky,
        tolerance=view.tolerance,
        seed=view.seed,
        observe=view.observe,
        backend=view.backend,
        kept=view.kept,
    )


AROUND_FRONT = Motion(in_front, (FRONT,))
AROUND_BEHIND = Motion(cumulus.eye, (BEHIND,))
enter(Scene("man-04", "figure 4: the cloud map", voxel_model, draw_front, AROUND_FRONT))
for figure, count in ((8, 1000), (9, 100), (10, 30)):
    title = f"figure {figure}: the map as {count} balls"
    model = partial(cluster_model, count)
    enter(Scene(f"man-{figure:02}", title, model, draw_front, AROUND_FRONT))
for figure, how, medium in (
    (13, "isotropic", ISOTROPIC),
    (14, "anisotropic", FORWARD),
):
    title = f"figure {figure}: {how} scattering"
    against = partial(draw_behind, medium=medium)
    enter(Scene(f"man-{figure}", title, shading_model, against, AROUND_BEHIND))
