"""What the triangle benchmark draws: a sphere, a dome and a displaced sphere."""

from __future__ import annotations

import dataclasses
import functools
import math
from typing import Literal

import numpy as np

from refcloud.camera import Camera
from refcloud.conventions import Array
from refcloud.noise import uniform
from refcloud.raster import (
    Framebuffer,
    Mesh,
    State,
    Texture,
    Textured,
    clear,
    dome_mesh,
    framebuffer,
    sphere_mesh,
)
from refcloud.raster.framebuffer import NOTHING
from refcloud.raster.texture import MinFilter

WIDTH, HEIGHT = 1024, 768
SIDE, BLOCK = 512, 4  # texels
DEPTHS = {"near": 0.01, "far": 100.0}
OUTSIDE = Camera(np.array([0.0, 0.8, 3.3]), np.zeros(3), fov_y=0.8)
UNDER = Camera(np.array([0.0, 0.1, 0.0]), np.array([0.0, 0.6, -1.0]), fov_y=1.2)


@functools.cache
def scene(name: str, count: int) -> tuple[Mesh, Camera, Literal["BACK"] | None]:
    """Give a mesh of about so many triangles, an eye, and what is culled."""
    side = max(3, round(math.sqrt(0.5 * count)))
    if name == "dome":
        return dome_mesh(side, side), UNDER, None
    mesh = sphere_mesh(side, side + 1)
    if name == "displaced":
        x, y, z = mesh.points.T
        swell = 1.0 + 0.2 * np.sin(7.0 * x) * np.sin(5.0 * y + 1.0) * np.cos(6.0 * z)
        mesh = dataclasses.replace(mesh, points=mesh.points * swell[:, None])
    return mesh, OUTSIDE, "BACK"


@functools.cache
def textured(filter: MinFilter) -> Textured:
    """Give the texture: random colours in blocks, on a checker."""
    j, i, c = np.ogrid[0:SIDE, 0:SIDE, 0:4]
    colours = uniform(j // BLOCK, i // BLOCK, c, seed=0)
    checker = (i // (8 * BLOCK) + j // (8 * BLOCK)) % 2
    return Textured(Texture(0.7 * colours + 0.3 * checker, min_filter=filter))


def state(depth: bool) -> State:
    """Give what fragments go through."""
    return State(depth_func="LESS" if depth else None)


@functools.cache
def target(depth: bool) -> Framebuffer:
    """Make a framebuffer once, as OpenGL's is made."""
    return framebuffer(WIDTH, HEIGHT, depth=1.0 if depth else None)


def cleared(depth: bool) -> Framebuffer:
    """Clear it, as every frame does."""
    buffer = target(depth)
    clear(buffer, NOTHING, depth=1.0)
    return buffer


def mean_difference(found: Array, exact: Array) -> float:
    """Give the mean of what two pictures differ by."""
    return float(np.abs(found - exact).mean())
