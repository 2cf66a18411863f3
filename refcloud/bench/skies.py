"""The skies benchmark: surfaces by rays and by triangles, and who makes their noise.

Frames are those of the scenes, 512 x 384, animated: noise is made anew. X04 is the
half-sphere with a texture in the plane against the sphere with a texture in space, X05
and X06 are simplex against classic noise in three and in four dimensions.
"""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable
from typing import Any

import numpy as np

from refcloud.bench.contenders import scattered
from refcloud.bench.subject import MS, Subject
from refcloud.bench.timing import Contender
from refcloud.conventions import Array
from refcloud.noise import cloud_sheet, exponential_filter, gradient, sheet_map, simplex
from refcloud.noise.sheet import _literal
from refcloud.scene import SCENES, View
from refcloud.scenes import shader, shader_light, shader_objects
from refcloud.sky import Dome, Plane, Sphere, places

WIDTH = 512
TOLERANCE = 1.0 / 255.0  # the command line's
SURFACES = (
    ("plane", shader.PLANE.surface, shader.plane_eye),
    ("sphere", shader.SOLID.surface, shader.upward_eye),
    ("half-sphere", shader.DOME.surface, shader.upward_eye),
)
FINENESS = 64


def view_of(width: int, **how: Any) -> View:
    """Give a view of 4 to 3, at the command line's tolerance."""
    return View(width, width * 3 // 4, tolerance=TOLERANCE, **how)


def surfaces(width: int) -> list[Contender]:
    """List both ways to find what pixels see of a surface; errors are those of u, v."""
    found = []
    for name, surface, eye in SURFACES:
        model = SCENES["shader-dome"].model()
        camera = eye(model, view_of(width))
        rays = functools.partial(_coordinates, camera, surface, "rays")
        triangles = functools.partial(_coordinates, camera, surface, "triangles")
        task, n = f"places on a {name}", 1
        found += [
            Contender(task, "a ray per pixel", n, rays, rival=True),
            Contender(task, f"triangles, fineness {FINENESS}", n, triangles, rays),
        ]
        earlier = places(camera, surface)
        again = functools.partial(places, camera, surface, earlier=earlier)
        found.append(Contender(task, "handed on, the eye still", n, again))
    return found


def _coordinates(camera: Any, surface: Plane | Sphere | Dome, way: Any) -> Array:
    at = places(camera, surface, way=way, fineness=FINENESS)
    held = np.zeros((*at.seen.shape, 2))
    held[at.seen] = at.coordinates
    return held


def frames(width: int) -> list[Contender]:
    """List whole frames, the eye still or not; none waits for one of another time."""
    listed: list[tuple[str, Callable[..., Any]]] = [
        ("half-sphere, texture in the plane", shader.textured_sky),
        ("sphere, texture in space", shader.volume_sky),
        ("sphere, classic 4-D noise at every pixel", shader.solid_sky),
        ("plane, simplex 3-D noise at every pixel", shader.plane_sky),
        ("puff", shader_objects.puff),
        ("distorted sphere, triangles", shader_objects.bubble),
        ("static background (handed on)", shader.background),
    ]
    model = SCENES["shader-dome"].model()
    found = []
    for name, draw in listed:
        kept: dict[Any, Any] = {}
        work = functools.partial(_next_frame, draw, model, view_of(width, kept=kept))
        rival = name.startswith("sphere, texture in space")
        found.append(Contender("frame, the eye still", name, 1, work, rival=rival))
    for name, draw in (*listed[:2], listed[3]):
        for way in ("rays", "triangles"):
            work = functools.partial(draw, model, view_of(width), way=way)
            task = f"frame of a {name.split(',')[0]}"
            found.append(Contender(task, way, 1, work, rival=way == "triangles"))
    return found


def _next_frame(draw: Callable[..., Any], model: Any, view: View) -> Any:
    """Draw the next moment: every call is one, so that no noise is there already."""
    assert view.kept is not None
    count = view.kept["frame"] = view.kept.get("frame", 0) + 1
    return draw(model, dataclasses.replace(view, time=0.05 * count))


def lit_layers(width: int) -> list[Contender]:
    """List both ways to the noise of the lit layer (R08, R09)."""
    model = SCENES["shader-lit"].model()
    view = view_of(width)

    def drawn(direct: bool) -> Array:
        return shader_light.lit_layer(model, view, direct=direct).linear

    direct = functools.cache(functools.partial(drawn, True))
    task = "lit layer, 12 samples a pixel"
    return [
        Contender(task, "octaves at every sample", 1, lambda: drawn(True), rival=True),
        Contender(
            task,
            "drawn to a texture first",
            1,
            lambda: drawn(False),
            direct,
            distance=lambda a, b: float(np.median(np.abs(a - b))),
        ),
    ]


def noises(count: int) -> list[Contender]:
    """List simplex and classic noise in three and in four dimensions."""
    three = scattered(count)
    four = np.concatenate([three, three[:, :1] * 0.37], axis=1)
    found = []
    for at in (three, four):
        n = at.shape[1]
        for name, noise in (("classic", gradient), ("simplex", simplex)):
            work = functools.partial(noise, at, seed=1, dtype="float32")
            task = f"noise of {n} coordinates, {count} points"
            found.append(Contender(task, name, 1, work, rival=name == "classic"))
    return found


def sheets(size: int) -> list[Contender]:
    """List document C's sheet and its loops, in plain Python as printed."""
    task = f"document C's sheet, 32 to {size}"
    loops = functools.partial(_looped_sheet, size)
    whole = functools.cache(lambda: np.array(loops()))

    def literal() -> Array:
        return exponential_filter(_literal(sheet_map(seed=7), size, 4))

    return [
        Contender(task, "its loops, plain Python", 1, loops, rival=True),
        Contender(task, "each octave at every sample", 1, literal, whole),
        Contender(
            task, "refcloud", 1, functools.partial(cloud_sheet, size, seed=7), whole
        ),
    ]


def _looped_sheet(size: int) -> list[list[float]]:
    """Sum octaves and filter them as document C's loops do, number by number."""
    small = sheet_map(seed=7).tolist()
    out = [[0.0] * size for _ in range(size)]
    for octave in range(4):
        scale = 2**octave / size * 32
        for x in range(size):
            for y in range(size):
                out[y][x] += _interpolated(small, x * scale, y * scale) / 2**octave
    for row in out:
        for x in range(size):
            row[x] = 255.0 - 0.95 ** max(row[x] - 235.0, 0.0) * 255.0
    return out


def _interpolated(rows: list[list[float]], x: float, y: float) -> float:
    """Interpolate between four numbers of a map of 32 by 32 that repeats."""
    x_int, y_int = int(x), int(y)
    x_frac, y_frac = x - x_int, y - y_int
    x0, y0, x1, y1 = x_int % 32, y_int % 32, (x_int + 1) % 32, (y_int + 1) % 32
    bot = rows[y0][x0] + x_frac * (rows[y0][x1] - rows[y0][x0])
    top = rows[y1][x0] + x_frac * (rows[y1][x1] - rows[y1][x0])
    return bot + y_frac * (top - bot)


SKIES = Subject(
    name="skies",
    title="skies: rays or triangles, noise made anew, light along layers",
    about=(
        "CPU time per frame of 512x384, of 400000 points or of a sheet, medians; error:"
        " largest difference of u or v, of grey levels, median difference of light"
    ),
    lists=(
        (surfaces, WIDTH, 64),
        (frames, WIDTH, 64),
        (lit_layers, WIDTH, 64),
        (noises, 400_000, 2000),
        (sheets, 256, 32),
    ),
    unit=MS,
    digits=2,
    reference="a ray per pixel, the literal sheet, and octaves at every sample",
)
