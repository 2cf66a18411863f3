"""The scenes that have a golden picture, each as a function that draws it small."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from refcloud import (
    Camera,
    Medium,
    Picture,
    Sun,
    generate,
    load_metaballs,
    render,
)
from refcloud.bench import stability
from refcloud.figure import find_figure
from refcloud.noise import uniform
from refcloud.raster import (
    Blending,
    State,
    Texture,
    Textured,
    draw_lines,
    draw_triangles,
    framebuffer,
    plane_mesh,
    sphere_mesh,
    splat,
)
from refcloud.raster.meshes import separate
from refcloud.scenes import SCENES, Model, View, man_net, man_passes

FIXTURES = Path(__file__).parent / "fixtures"
VIEW, SMALL_VIEW = View(192, 144), View(128, 96)


def blend_fan() -> Picture:
    """Draw a fan of overlapping splats over a gradient, both laws, both footprints."""
    width, height = 128, 96
    buffer = framebuffer(width, height)
    down, across = np.linspace(0, 1, height), np.linspace(0, 1, width)
    buffer.pixels[..., 0] = 0.1 + 0.3 * across
    buffer.pixels[..., 1] = 0.2 + 0.2 * down[:, None]
    buffer.pixels[..., 2] = 0.6 - 0.3 * down[:, None]
    for step in range(9):
        angle = math.pi * step / 8
        colour = 0.5 + 0.5 * np.cos(angle + np.array([0.0, 2.0, 4.0]))
        splat(
            buffer,
            width / 2 - 44 * math.cos(angle),
            height - 8 - 60 * math.sin(angle),
            10 + 2.5 * step,
            emission=colour,
            tau=0.25 * 2 ** (step / 2),
            name=("chord", "profile")[step % 2],
            law=("beer", "linear")[step // 2 % 2],
        )
    return Picture(buffer.pixels[..., :3])


def textured_triangles() -> Picture:
    """Draw a floor to the horizon, two balls that sink in, lines and a half-clear wall.

    The floor is cut by the near plane; everything is tested for depth.
    """
    view = Camera([0.0, 0.9, 3.2], [0.0, 0.2, 0.0], fov_y=0.9, width=128, height=96)
    j, i, c = np.ogrid[0:16, 0:16, 0:4]
    blocks = 0.15 + 0.7 * uniform(j // 2, i // 2, c, seed=3) + 0.15 * ((i + j) % 2)
    blocks[..., 3] = 1.0
    ground = Texture(0.1 + 0.5 * np.array([[[0.0], [1.0]], [[1.0], [0.0]]]) * [1, 1, 1])
    floor = plane_mesh(8, 8, width=60.0, depth=60.0)
    floor = replace(floor, attributes=12.0 * floor.attributes)
    ball = sphere_mesh(24, 18)
    x, y, z = ball.points.T
    swell = 0.7 + 0.2 * np.sin(7.0 * x) * np.sin(5.0 * y + 1.0) * np.cos(6.0 * z)
    lumpy = replace(ball, points=swell[:, None] * ball.points + [0.75, 0.3, -0.4])
    smooth = replace(ball, points=0.6 * ball.points + [-0.8, 0.35, 0.3])
    wall = np.array([[[-2, 0, 0.9], [0.5, 0, 0.9], [0.5, 1, 0.9]]], float)
    buffer = framebuffer(128, 96, color=[0.25, 0.4, 0.7, 1.0], depth=1.0)
    nearest, depths = State(depth_func="LESS"), {"near": 0.3, "far": 50.0}
    for mesh, texture in ((floor, ground), (smooth, Texture(blocks))):
        draw_triangles(buffer, view, mesh, Textured(texture), state=nearest, **depths)
    levels = Texture(blocks, "MIRRORED_REPEAT", "NEAREST", "LINEAR_MIPMAP_LINEAR")
    draw_triangles(buffer, view, lumpy, Textured(levels), state=nearest, **depths)
    axes = [[[-3, 0.3, 0], [3, 0.3, 0]], [[0.1, -1, 0], [0.1, 2, 0]]]
    draw_lines(buffer, view, axes, color=[1, 0.9, 0, 1], depth_func="LESS", **depths)
    over = Blending("SRC_ALPHA", "ONE_MINUS_SRC_ALPHA")
    through = State(blending=over, depth_func="LESS", depth_mask=False)
    half = [0.9, 0.1, 0.1, 0.5]
    draw_triangles(buffer, view, separate(wall), half, state=through, **depths)
    return Picture(buffer.pixels[..., :3])


def marched_map() -> Picture:
    """March a cloud map of coarse voxels, exactly, from below with the sun behind."""
    cloud = generate(seed=7, voxel=2.8)
    low = Camera(
        [14.0, -18.0, 110.0], [1.4, 12.0, 0.0], width=128, height=96, fov_y=0.6
    )
    sun = Sun([-0.5, 0.5, -0.6], [3.2, 2.9, 2.4])
    medium = Medium(0.5, 1.0, 0.5, "hg")
    return render(cloud, camera=low, suns=sun, medium=medium)


def fitted(name: str, balls: str) -> Picture:
    """Draw a scene from stored balls: a fit amplifies what machines differ in."""
    stored = sorted(FIXTURES.glob(f"{balls}-*.npz"))
    clouds = {
        path.stem.removeprefix(f"{balls}-").replace("-", " "): load_metaballs(path)
        for path in stored
    }
    return SCENES[name].draw(Model(clouds), VIEW)


def few_balls(name: str, stored: str) -> Picture:
    """Draw a diagram of the network or of a pass from stored balls."""
    balls = load_metaballs(FIXTURES / f"{stored}.npz")
    found = SimpleNamespace(centers=balls.centers, epochs=0)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(man_net, "adaptive_kmeans", lambda *_, **how: found)
        patch.setattr(man_net, "approximate", lambda *_, **how: balls)
        patch.setattr(man_passes, "approximate", lambda *_, **how: balls)
        return find_figure(name).draw(SMALL_VIEW)


def unfitted(name: str, view: View = VIEW) -> Picture:
    """Draw a scene whose clouds come straight from the noise."""
    scene = SCENES[name]
    return scene.draw(scene.model(), view)


def stability_map() -> Picture:
    """Judge every cell of the map of stability, without its words."""
    return stability.bare_map(stability.panels(stability.PROBES), cell=2, columns=6)


# Drawn in the stage `slow` alone.
SLOW = ("stability",)
GOLDEN: dict[str, Callable[[], Picture]] = {
    "stability": stability_map,
    "blend-fan": blend_fan,
    "cumulus": partial(fitted, "cumulus", "cumulus"),
    "demand": partial(unfitted, "demand"),
    **{
        f"demand-{name}": partial(unfitted, f"demand-{name}", SMALL_VIEW)
        for name in (
            *("worley", "worley-inverted", "cells", "perlin", "sky"),
            *("box", "faces", "quad", "lit", "background"),
        )
    },
    **{
        # So small that no word is written: fonts differ between versions of Pillow.
        f"man-{number}": partial(find_figure(f"man-{number}").draw, VIEW)
        for number in ("02", "03", "05")
    },
    **{
        name: partial(find_figure(name).draw, SMALL_VIEW)
        for name in ("shader-01", "shader-02")
    },
    "man-06": partial(few_balls, "man-06", "man-06-balls"),
    "man-07": partial(few_balls, "man-07", "man-08-cloud"),
    "man-11": partial(few_balls, "man-11", "man-11-balls"),
    "man-12": partial(few_balls, "man-12", "man-11-balls"),
    "man-04": partial(unfitted, "man-04"),
    "man-08": partial(fitted, "man-08", "man-08"),
    "man-09": partial(fitted, "man-09", "man-09"),
    "man-10": partial(fitted, "man-10", "man-10"),
    "man-13": partial(fitted, "man-13", "man-13"),
    "man-14": partial(fitted, "man-14", "man-13"),
    "marched-map": marched_map,
    "multiple": partial(unfitted, "multiple", View(64, 48)),
    **{
        f"shader-{name}": partial(unfitted, f"shader-{name}", SMALL_VIEW)
        for name in (
            *("a", "b", "c", "cover", "d", "dome", "e", "fog", "lit", "particles"),
            *("poles", "raw", "volume"),
        )
    },
    **{
        f"simple-{name}": partial(unfitted, f"simple-{name}", SMALL_VIEW)
        for name in ("noise", "smoothed", "interpolated", "octaves", "filtered")
    },
    "simple-quad": partial(unfitted, "simple-quad", SMALL_VIEW),
    "simple-sky": partial(unfitted, "simple-sky", SMALL_VIEW),
    "textured-triangles": textured_triangles,
}
