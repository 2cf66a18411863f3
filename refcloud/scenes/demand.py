"""The figures of document D that show its box and the cloud in it.

``demand-box`` is the box that the cloud stands in; ``demand-faces`` the first wrong
try, the texture on the box's faces (R07); ``demand-quad`` the cloud by Beer's law
alone; ``demand-lit`` the cloud with a light; ``demand-background`` the cloud before a
plain background and before a sky. Those in the plane are in
`refcloud.scenes.demand_plane`, and ``demand`` itself is in
`refcloud.scenes.demand_hero`.
"""

from __future__ import annotations

import dataclasses
import math
import time
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from refcloud.camera import Camera, rays
from refcloud.checking import complaint
from refcloud.cloudmap import (
    VoxelGrid,
    box_cloud,
    largest_part,
    placed_texture,
    trilinear,
    worley_smooth_texture,
)
from refcloud.conventions import (
    WHOLE_SPHERE,
    Array,
)
from refcloud.declared import Kind, enter_kind, nothing_own
from refcloud.frozen import sealed
from refcloud.image import Picture, srgb_decode
from refcloud.lighting import Octaves, octave_march
from refcloud.march import ray_box
from refcloud.optics import Medium, Sun
from refcloud.raster import Framebuffer, draw_box
from refcloud.raster.walls import LIGHT_BLUE
from refcloud.scene import Model, Motion, Own, Use, View
from refcloud.scenes.demand_kinds import Boxed, Faces, Lumps
from refcloud.scenes.demand_plane import halved, mended, pair, plain, refuse_given

VOXEL, COARSEST = 0.02, 0.1  # scene units: of a picture 1024 pixels wide; at most
DARK, NO_WALL = np.zeros(3), np.zeros(4)


# Light models: single scattering, with light from the sky; or every place shines white,
# whatever lies before it.
LIT = Octaves(1, backward_share=0.0)
UNLIT = Octaves(1, sky_light=np.ones(3), ground_light=DARK, sky_extinction=0.0)
OWN = Boxed(
    lower=np.array([-1.5, -0.75, -0.8]),
    upper=np.array([1.5, 0.75, 0.8]),
    cloud=Lumps(cell=0.36, seed=2, threshold=0.3, edge=np.array([1.0, 0.6, 0.7])),
    eye=np.array([2.5, 0.9, 4.6]),
    target=np.array([0.0, -0.05, 0.0]),
    fov_y=0.533,
    sun=Sun(np.array([-0.62, 0.62, 0.42]), 1.3 * WHOLE_SPHERE * np.ones(3)),
    medium=Medium(13.0, 1.0, 0.2, "hg"),
    light=LIT,
    shone=True,
    frame="none",
)
WALLED = dataclasses.replace(OWN, frame="walls")
QUAD = dataclasses.replace(OWN, frame="lines", light=UNLIT, shone=False)
FACES = Faces(OWN.lower, OWN.upper, size=64, cells=4, seed=2, threshold=0.45)
USES: tuple[Use, ...] = ("scattering", "seed")


def cloud_in_box(of: Boxed, view: View) -> VoxelGrid:
    """Make the cloud, as fine as the picture shows it."""
    lower, upper, how = of.lower, of.upper, lumps(of)
    if view.offset is not None:
        # The noise is fixed in the world: wind through the box is the box moved against
        # it. Lumps come in at one wall and leave at the other, so all of them stay.
        against = lower - view.offset, upper - view.offset
        blown = box_cloud(*against, voxel=fineness(view), **how)
        return VoxelGrid(blown.density, lower, upper)
    grid = box_cloud(lower, upper, voxel=fineness(view), **how)
    # Single lumps near the walls would hang in the air as beads.
    return VoxelGrid(sealed(largest_part(grid.density)), grid.lower, grid.upper)


def lumps(of: Boxed) -> dict[str, Any]:
    """Give the cloud's parameters as `box_cloud` takes them."""
    return {f.name: getattr(of.cloud, f.name) for f in dataclasses.fields(Lumps)}


def fineness(view: View) -> float:
    """Give the edge of a voxel: some two pixels of the picture."""
    return min(max(VOXEL * 1024 / view.width, VOXEL), COARSEST)


def boxed(
    of: Boxed, model: Model, view: View, *, behind: Callable[[View], Array] = mended
) -> Picture:
    """Draw the cloud between what lies behind it and what lies before it."""
    marched_alone(view)
    if view.scattering == "multiple":
        expected = "single beside a figure of document D, whose light is in octaves"
        raise ValueError(complaint("scattering", expected, "multiple"))
    if not of.shone:
        refuse_given(view, ("suns", "scattering"), "a cloud without light")
    camera = view.camera or eye(view, of)
    size = dataclasses.replace(view, width=camera.width, height=camera.height)
    seconds, start = {}, time.perf_counter()
    grid = cloud_in_box(of, size)
    seconds["generate"], start = time.perf_counter() - start, time.perf_counter()
    buffer = over_opaque(behind(size))
    wall = NO_WALL if of.frame == "lines" else LIGHT_BLUE
    if of.frame != "none":
        draw_box(buffer, camera, of.lower, of.upper, "behind", wall_color=wall)
    suns = (of.sun,) if view.suns is None else view.suns
    L, T, skipped = octave_march(
        grid,
        camera,
        suns=suns if of.shone else (),
        medium=view.medium or of.medium,
        octaves=of.light,
        step=fineness(size),
        tolerance=view.tolerance,
        seed=view.seed,
        observe=view.observe,
    )
    buffer.pixels[..., :3] = L + T[..., None] * buffer.pixels[..., :3]
    if of.frame != "none":
        draw_box(buffer, camera, of.lower, of.upper, "before", wall_color=wall)
    seconds["march"] = time.perf_counter() - start
    note = f"cloud: {np.count_nonzero(grid.density)} voxels"
    return Picture(buffer.pixels[..., :3], None, skipped, seconds, (note,))


def faces(of: Faces, model: Model, view: View) -> Picture:
    """Draw the texture where rays enter the box: it is seen on the faces alone."""
    refuse_given(view, ("suns", "medium", "look", "scattering"), "a texture on faces")
    camera = view.camera or eye(view)
    size = dataclasses.replace(view, width=camera.width, height=camera.height)
    texture = worley_smooth_texture(
        of.size, cells=of.cells, seed=of.seed, threshold=of.threshold
    )
    grid = placed_texture(texture, of.lower, of.upper, repeats=(2, 1, 1))
    origins, directions = rays(camera)
    t0, t1 = ray_box(origins, directions, lower=grid.lower, upper=grid.upper)
    hit = t1 > t0
    entered = origins[hit] + t0[hit][:, None] * directions[hit]
    # Rounding leaves some of these places just outside.
    density = trilinear(grid, np.clip(entered, grid.lower, grid.upper))
    light = mended(size)
    light[hit] = srgb_decode(np.clip(0.25 + 0.75 * density, 0.0, 1.0))[:, None]
    buffer = over_opaque(light)
    draw_box(buffer, camera, of.lower, of.upper, "before", wall_color=NO_WALL)
    return Picture(buffer.pixels[..., :3])


def backgrounds(of: Boxed, model: Model, view: View) -> Picture:
    """Draw the cloud before a plain background, and before the gradient."""
    right = partial(boxed, of, model)
    return pair(view, partial(right, behind=plain), right)


def eye(view: View, of: Boxed = OWN) -> Camera:
    """Look at the box from the front, a little from the right and above."""
    # A narrow picture shows as much of the box's width, and more above and below.
    taller = max(1.0, 4.0 / 3.0 * view.height / view.width)
    return Camera(
        of.eye,
        of.target,
        fov_y=2.0 * math.atan(taller * math.tan(0.5 * of.fov_y)),
        width=view.width,
        height=view.height,
    )


def own_eye(model: Model, view: View, *, of: Boxed = OWN) -> Camera:
    """Give the scene's own camera."""
    return eye(view, of)


def half_eye(model: Model, view: View, *, of: Boxed) -> Camera:
    """Give the eye of both pictures of a pair, whose width is that of the pair."""
    return dataclasses.replace(eye(halved(view), of), width=view.width)


def brings(of: Boxed, model: Model | None, view: View) -> Own:
    """Give the sun, if it shines, and the medium."""
    return Own((of.sun,) if of.shone else None, of.medium)


def over_opaque(light: Array) -> Framebuffer:
    """Make a framebuffer of what stands behind everything."""
    return Framebuffer(np.concatenate([light, np.ones_like(light[..., :1])], axis=-1))


def marched_alone(view: View) -> None:
    """Refuse what a marched cloud has no use for."""
    refuse_given(view, ("look",), "a scene that is marched")


def blown(of: Boxed) -> Motion:
    """Turn eye and sun, and blow wind through the box, whose noise never repeats."""
    never = (math.inf, math.inf, math.inf)
    suns = (of.sun,) if of.shone else ()
    return Motion(partial(own_eye, of=of), suns, repeats=never)


def both_blown(of: Boxed) -> Motion:
    """Turn the eye of two pictures, and the rest as in one."""
    return dataclasses.replace(blown(of), eye=partial(half_eye, of=of))


def turning(of: Faces) -> Motion:
    """Turn the eye alone."""
    return Motion(own_eye)


for name, title, own, draw, motion, parts in (
    ("box", "the box, its walls and the cloud", WALLED, boxed, blown, brings),
    (
        "faces",
        "the wrong try, a texture on the faces",
        FACES,
        faces,
        turning,
        nothing_own,
    ),
    ("quad", "the cloud by Beer's law alone", QUAD, boxed, blown, brings),
    ("lit", "the cloud, lit", OWN, boxed, blown, brings),
    (
        "background",
        "a plain background and the sky",
        OWN,
        backgrounds,
        both_blown,
        brings,
    ),
):
    title = f"document D: {title}"
    enter_kind(
        Kind(f"demand-{name}", title, own, draw, motion, uses=USES, brings=parts)
    )
