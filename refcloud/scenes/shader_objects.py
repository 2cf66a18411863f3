"""Document S's objects: noise on a ball, a puff, a distorted sphere, raw numbers.

``shader-a`` is its appendix A as its text describes it: classic and simplex noise, each
carved out of a solid and as a picture wrapped around, whose pole shows what is wrong
with that (N25). ``shader-d`` is the puff, an implicit circle distorted by animated
noise, lit in its own plane. ``shader-e`` is a sphere whose vertices noise has moved,
textured with sums of octaves in four dimensions. ``shader-raw`` is the output of the
hash itself, neither coherent nor continuous (N04).
"""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from refcloud.camera import AnyCamera, Camera
from refcloud.conventions import WHOLE_SPHERE, Array
from refcloud.declared import Kind, enter_kind, nothing_own, sun_alone, told
from refcloud.image import Picture, srgb_decode
from refcloud.noise import fbm, lattice_random, wrapped_bilinear
from refcloud.noise.kinds import KindName
from refcloud.raster import (
    Fragments,
    Mesh,
    State,
    draw_triangles,
    framebuffer,
    sphere_mesh,
)
from refcloud.scene import Model, Motion, View
from refcloud.scenes.demand_plane import flat_alone, greys, still
from refcloud.scenes.shader_eyes import (
    FRONT,
    SUN,
    observed,
    refuse_unused,
    sunless,
    timed,
)
from refcloud.scenes.shader_kinds import Bubble, LitPuff, NoiseBalls, Raw
from refcloud.scenes.shader_light import lambert
from refcloud.sky import (
    Cover,
    Displacement,
    Places,
    Puff,
    Sphere,
    cloud_cover,
    displaced_sphere,
    looked_up,
    places,
    puff_density,
    shaded,
)

# Appendix A: four balls, seen a little from above so that their poles show.
BALL = Sphere(np.zeros(3), 1.0)
# The picture around a ball has half as many texels from pole to pole.
BALLS = NoiseBalls(seed=2, cells=3.0, size=256, sun=SUN)

SMOKE = LitPuff(
    puff=Puff(radius=0.95, cell=0.55, distortion=1.0, softness=0.8, octaves=6, seed=2),
    steps=10,
    step=0.1,
    sigma_t=3.2,
    opacity=2.6,
    smoke=np.array([1.0, 0.97, 0.92]),
    shade=np.array([0.30, 0.36, 0.46]),
    sun=SUN,
)

COLUMNS, ROWS = 128, 64  # of the sphere's mesh
BUBBLE = Bubble(
    shape=Displacement(amount=0.42, frequency=1.25, octaves=1, seed=3),
    cover=Cover(-0.02, 5.0, 1.0, -0.5, 0.4),
    color=np.array([0.10, 0.22, 0.50]),
    seed=6,
    octaves=5,
    cells=2.2,
    period=8,
    sun=FRONT,
)
NUMBERS = Raw(seed=1, across=64)


def solid_and_mapped(model: Model, view: View, *, of: NoiseBalls = BALLS) -> Picture:
    """Draw four balls: classic above, simplex below, solid left, wrapped right."""
    refuse_unused(view, "camera")
    half = max(view.width // 2, 1), max(view.height // 2, 1)
    suns = (of.sun,) if view.suns is None else view.suns
    eye = Camera(
        np.array([0.0, 2.6, -2.6]),
        np.zeros(3),
        fov_y=0.62,
        width=half[0],
        height=half[1],
    )
    found = places(eye, BALL)

    def draw():
        light = np.full((view.height, view.width, 3), 0.06)
        for row, kind in enumerate(("gradient", "simplex")):
            for column, solid in enumerate((True, False)):
                panel = ball_of_noise(found, kind, solid, view, suns, of)
                rows = slice(row * half[1], (row + 1) * half[1])
                light[rows, column * half[0] : (column + 1) * half[0]] = panel
        return light, (), ()

    return timed(draw)


def ball_of_noise(
    found: Places, kind: KindName, solid: bool, view: View, suns, of: NoiseBalls
) -> Array:
    """Draw a ball of one kind of noise, solid or with a picture wrapped around it."""
    how = {"kind": kind, "seed": of.seed, "octaves": 1}

    def shade(at: Places) -> tuple[Array, Array]:
        if solid:
            noise = fbm(of.cells * at.points, time=view.time, **how)
        else:
            # As many cells along the equator and from pole to pole as the solid has.
            line = (np.arange(of.size) + 0.5) / of.size * math.pi * of.cells
            flat = np.stack(np.meshgrid(2.0 * line, line[::2]), axis=-1)
            picture = fbm(flat, time=view.time, **how)
            noise = looked_up(picture, at.coordinates)
        grey = srgb_decode(np.clip(0.5 + 0.5 * noise, 0.0, 1.0))
        return grey[:, None] * lambert(at.points, suns) * 0.75, np.ones(len(grey))

    height, width = found.seen.shape
    return shaded(np.full((height, width, 3), 0.06), found, shade)


def puff(model: Model, view: View, *, of: LitPuff = SMOKE) -> Picture:
    """Draw the puff over a sky; its light is marched toward the sun in its plane."""
    refuse_unused(view, "camera")
    suns = (of.sun,) if view.suns is None else view.suns

    def draw():
        # 1. Density at every pixel's centre.
        width, height = view.width, view.height
        pixel = 3.4 / min(width, height)
        x: Array = pixel * (np.arange(width, dtype=np.float64) + 0.5 - 0.5 * width)
        y: Array = pixel * (0.5 * height - np.arange(height, dtype=np.float64) - 0.5)
        at = np.stack(np.meshgrid(x, y), axis=-1)
        density = puff_density(at, of.puff, time=view.time)

        observed(view, "density", density)

        # 2. From each pixel toward the suns, looked up among the pixels, where it was
        #    drawn already (R09); around the picture there is none.
        rows, columns = np.nonzero(density > 0.0)
        framed = np.pad(density, 1)
        light = np.repeat(of.shade[None], len(rows), axis=0)
        for sun in suns:
            depth = np.zeros(len(rows))
            for i in range(of.steps):
                far = (i + 0.5) * of.step / pixel
                u = np.clip(columns + 1 + far * sun.direction[0], 0, width + 1)
                v = np.clip(rows + 1 - far * sun.direction[1], 0, height + 1)
                depth += of.step * wrapped_bilinear(framed, u, v)
            T = np.exp(-of.sigma_t * depth)[:, None]
            light += of.smoke * T * sun.irradiance / WHOLE_SPHERE * 0.8

        # 3. Over the sky.
        ahead = np.array([0.0, 0.6, -1.0])
        over = sunless(Camera(np.zeros(3), ahead, width=width, height=height))
        share = -np.expm1(-of.opacity * density[rows, columns])[:, None]
        over[rows, columns] = share * light + (1.0 - share) * over[rows, columns]
        return over, (), ()

    return timed(draw)


def bubble_eye(model: Model, view: View) -> AnyCamera:
    """Look at the sphere from the front, a little from below."""
    if view.camera is not None:
        return view.camera
    return Camera(
        np.array([0.0, -1.1, 4.2]),
        np.zeros(3),
        fov_y=0.72,
        width=view.width,
        height=view.height,
    )


def bubble_mesh(time: float, of: Bubble = BUBBLE) -> Mesh:
    """Make the moved sphere: normals, and the place before it was moved, beside it."""
    ball = sphere_mesh(COLUMNS, ROWS)
    points, normals = displaced_sphere(ball.points, of.shape, time=time)
    return Mesh(points, ball.faces, np.concatenate([normals, ball.points], axis=1))


def bubble(model: Model, view: View, *, of: Bubble = BUBBLE) -> Picture:
    """Draw the distorted sphere as textured triangles, lit by its own normals."""
    refuse_unused(view)
    camera = bubble_eye(model, view)
    suns = (of.sun,) if view.suns is None else view.suns

    def shade(fragments: Fragments) -> Array:
        normals, at = fragments.values[:3].T, fragments.values[3:].T
        normals = normals / np.linalg.norm(normals, axis=1, keepdims=True)
        noise = fbm(
            of.cells * at,
            time=view.time,
            seed=of.seed,
            octaves=of.octaves,
            period=of.period,
        )
        white, share = cloud_cover(noise, of.cover)
        color = share[:, None] * white[:, None] + (1.0 - share[:, None]) * of.color
        rgba = np.ones((len(color), 4))
        rgba[:, :3] = color * lambert(normals, suns)
        return rgba

    def draw():
        buffer = framebuffer(camera.width, camera.height, depth=1.0)
        buffer.pixels[..., :3] = sunless(camera)
        mesh = bubble_mesh(view.time, of)
        far = None if isinstance(camera, Camera) else 1e6
        draw_triangles(
            buffer,
            camera,
            mesh,
            shade,
            state=State(depth_func="LESS"),
            cull="BACK",
            far=far,
        )
        note = f"sphere: {len(mesh.faces)} triangles, {len(mesh.points)} vertices moved"
        return buffer.pixels[..., :3], (), (note,)

    return timed(draw)


def raw(model: Model, view: View, *, of: Raw = NUMBERS) -> Picture:
    """Draw the hash of every pixel's place, in squares of some pixels."""
    flat_alone(view)
    edge = max(view.width, view.height) / of.across
    column = (np.arange(view.width) / edge).astype(np.int64)
    row = (np.arange(view.height) / edge).astype(np.int64)[:, None]
    return greys(0.5 + 0.5 * lattice_random(column, row, 0, seed=of.seed))


def balls_motion(of: NoiseBalls) -> Motion:
    """Move the sun; noise never repeats."""
    return Motion(suns=(of.sun,), period=math.inf)


def puff_motion(of: LitPuff) -> Motion:
    """Move the sun; the puff's noise repeats."""
    return Motion(suns=(of.sun,), period=float(of.puff.period))


def bubble_motion(of: Bubble) -> Motion:
    """Turn the eye, move the sun."""
    return Motion(bubble_eye, (of.sun,), period=math.inf)


for name, title, own, draw_one, motion in (
    (
        "a",
        "appendix A: noise solid and mapped",
        BALLS,
        solid_and_mapped,
        balls_motion,
    ),
    ("d", "appendix D: a puff", SMOKE, puff, puff_motion),
    ("e", "appendix E: a distorted sphere", BUBBLE, bubble, bubble_motion),
    ("raw", "section 3.1: raw pseudo-random numbers", NUMBERS, raw, still),
):
    title, drawn = f"document S: {title}", partial(told, draw_one)
    brings = nothing_own if name == "raw" else sun_alone
    enter_kind(Kind(f"shader-{name}", title, own, drawn, motion, brings=brings))
