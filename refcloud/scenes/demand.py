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
from typing import Literal

import numpy as np

from refcloud.camera import Camera, rays
from refcloud.cloudmap import (
    VoxelGrid,
    box_cloud,
    largest_part,
    placed_texture,
    trilinear,
    worley_smooth_texture,
)
from refcloud.conventions import WHOLE_SPHERE, Array
from refcloud.image import Picture, srgb_decode
from refcloud.lighting import Octaves, octave_march
from refcloud.march import ray_box
from refcloud.optics import Medium, Sun
from refcloud.raster import Framebuffer, draw_box
from refcloud.raster.walls import LIGHT_BLUE
from refcloud.scene import Model, Motion, Scene, View, enter
from refcloud.scenes.demand_plane import mended, no_model, pair, plain, refuse_given

# The box by its rear left lower and front right upper corner, and the cloud in it.
LOWER, UPPER = np.array([-1.5, -0.75, -0.8]), np.array([1.5, 0.75, 0.8])
CLOUD = {"cell": 0.36, "seed": 2, "threshold": 0.3, "edge": np.array([1.0, 0.6, 0.7])}
VOXEL, COARSEST = 0.02, 0.1  # scene units: of a picture 1024 pixels wide; at most
EYE, TARGET, FOV_Y = (2.5, 0.9, 4.6), (0.0, -0.05, 0.0), 0.533
LIGHT = Sun(np.array([-0.62, 0.62, 0.42]), 1.3 * WHOLE_SPHERE * np.ones(3))
MEDIUM = Medium(13.0, 1.0, 0.2, "hg")
TEXTURE = {"size": 64, "cells": 4, "seed": 2, "threshold": 0.45}

# Light models. Beer's law alone: every place shines white, whatever lies before it.
DARK, NO_WALL = np.zeros(3), np.zeros(4)
UNLIT = Octaves(1, sky_light=np.ones(3), ground_light=DARK, sky_extinction=0.0)
LIT = Octaves(1, backward_share=0.0)  # single scattering, with light from the sky


def cloud_in_box(view: View) -> VoxelGrid:
    """Make the cloud, as fine as the picture shows it."""
    if view.offset is not None:
        # The noise is fixed in the world: wind through the box is the box moved against
        # it. Lumps come in at one wall and leave at the other, so all of them stay.
        against = LOWER - view.offset, UPPER - view.offset
        blown = box_cloud(*against, voxel=fineness(view), **CLOUD)
        return VoxelGrid(blown.density, LOWER, UPPER)
    grid = box_cloud(LOWER, UPPER, voxel=fineness(view), **CLOUD)
    # Single lumps near the walls would hang in the air as beads.
    return VoxelGrid(largest_part(grid.density), grid.lower, grid.upper)


def fineness(view: View) -> float:
    """Give the edge of a voxel: some two pixels of the picture."""
    return min(max(VOXEL * 1024 / view.width, VOXEL), COARSEST)


def boxed(
    model: Model,
    view: View,
    *,
    light: Octaves = LIT,
    frame: Literal["walls", "lines", "none"] = "none",
    behind: Callable[[View], Array] = mended,
) -> Picture:
    """Draw the cloud between what lies behind it and what lies before it."""
    marched_alone(view)
    if light is UNLIT:
        refuse_given(view, ("suns",), "a cloud without light")
    camera = view.camera or eye(view)
    size = dataclasses.replace(view, width=camera.width, height=camera.height)
    seconds, start = {}, time.perf_counter()
    grid = cloud_in_box(size)
    seconds["generate"], start = time.perf_counter() - start, time.perf_counter()
    buffer = over_opaque(behind(size))
    wall = NO_WALL if frame == "lines" else LIGHT_BLUE
    if frame != "none":
        draw_box(buffer, camera, LOWER, UPPER, "behind", wall_color=wall)
    suns = () if light is UNLIT else view.suns
    L, T, skipped = octave_march(
        grid,
        camera,
        suns=(LIGHT,) if suns is None else suns,
        medium=view.medium or MEDIUM,
        octaves=light,
        step=fineness(size),
        tolerance=view.tolerance,
        seed=view.seed,
        observe=view.observe,
    )
    buffer.pixels[..., :3] = L + T[..., None] * buffer.pixels[..., :3]
    if frame != "none":
        draw_box(buffer, camera, LOWER, UPPER, "before", wall_color=wall)
    seconds["march"] = time.perf_counter() - start
    note = f"cloud: {np.count_nonzero(grid.density)} voxels"
    return Picture(buffer.pixels[..., :3], None, skipped, seconds, (note,))


def faces(model: Model, view: View) -> Picture:
    """Draw the texture where rays enter the box: it is seen on the faces alone."""
    refuse_given(view, ("suns", "medium", "look"), "a texture on faces")
    camera = view.camera or eye(view)
    size = dataclasses.replace(view, width=camera.width, height=camera.height)
    grid = placed_texture(
        worley_smooth_texture(**TEXTURE), LOWER, UPPER, repeats=(2, 1, 1)
    )
    origins, directions = rays(camera)
    t0, t1 = ray_box(origins, directions, lower=grid.lower, upper=grid.upper)
    hit = t1 > t0
    entered = origins[hit] + t0[hit][:, None] * directions[hit]
    # Rounding leaves some of these places just outside.
    density = trilinear(grid, np.clip(entered, grid.lower, grid.upper))
    light = mended(size)
    light[hit] = srgb_decode(np.clip(0.25 + 0.75 * density, 0.0, 1.0))[:, None]
    buffer = over_opaque(light)
    draw_box(buffer, camera, LOWER, UPPER, "before", wall_color=NO_WALL)
    return Picture(buffer.pixels[..., :3])


def backgrounds(model: Model, view: View) -> Picture:
    """Draw the cloud before a plain background, and before the gradient."""
    return pair(view, partial(boxed, model, behind=plain), partial(boxed, model))


def eye(view: View) -> Camera:
    """Look at the box from the front, a little from the right and above."""
    # A narrow picture shows as much of the box's width, and more above and below.
    taller = max(1.0, 4.0 / 3.0 * view.height / view.width)
    return Camera(
        np.array(EYE),
        np.array(TARGET),
        fov_y=2.0 * math.atan(taller * math.tan(0.5 * FOV_Y)),
        width=view.width,
        height=view.height,
    )


def own_eye(model: Model, view: View) -> Camera:
    """Give the scene's own camera."""
    return eye(view)


def over_opaque(light: Array) -> Framebuffer:
    """Make a framebuffer of what stands behind everything."""
    return Framebuffer(np.concatenate([light, np.ones_like(light[..., :1])], axis=-1))


def marched_alone(view: View) -> None:
    """Refuse what a marched cloud has no use for."""
    refuse_given(view, ("look",), "a scene that is marched")


NEVER = (math.inf, math.inf, math.inf)  # the noise in the box does not repeat
BLOWN = Motion(own_eye, (LIGHT,), repeats=NEVER)
UNLIT_BLOWN = Motion(own_eye, (), repeats=NEVER)
for name, title, draw, motion in (
    ("box", "the box, its walls and the cloud", partial(boxed, frame="walls"), BLOWN),
    ("faces", "the wrong try, a texture on the faces", faces, Motion(own_eye)),
    (
        "quad",
        "the cloud by Beer's law alone",
        partial(boxed, frame="lines", light=UNLIT),
        UNLIT_BLOWN,
    ),
    ("lit", "the cloud, lit", boxed, BLOWN),
    ("background", "a plain background and the sky", backgrounds, BLOWN),
):
    enter(Scene(f"demand-{name}", f"document D: {title}", no_model, draw, motion))
