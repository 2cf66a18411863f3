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

import numpy as np

from refcloud.camera import AnyCamera, Camera
from refcloud.conventions import WHOLE_SPHERE, Array
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
from refcloud.scene import Model, Motion, Scene, View, enter
from refcloud.scenes.demand_plane import flat_alone, greys
from refcloud.scenes.shader_eyes import (
    FRONT,
    SUN,
    no_model,
    observed,
    painted,
    precision,
    refuse_unused,
    timed,
)
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
SOLID_CELLS, SOLID_SEED = 3.0, 2
PICTURE = 256  # texels of the picture around a ball, half as many from pole to pole

PUFF = Puff(radius=0.95, cell=0.55, distortion=1.0, softness=0.8, octaves=6, seed=2)
# Its light: steps toward the sun, their length, extinction on that way and to the eye.
PUFF_STEPS, PUFF_STEP, PUFF_SIGMA, PUFF_OPACITY = 10, 0.1, 3.2, 2.6
SMOKE, SHADE = np.array([1.0, 0.97, 0.92]), np.array([0.30, 0.36, 0.46])

BUBBLE = Displacement(amount=0.42, frequency=1.25, octaves=1, seed=3)
COLUMNS, ROWS = 128, 64  # of the sphere's mesh
BUBBLE_CELLS, BUBBLE_SEED = 2.2, 6
BLUE = np.array([0.10, 0.22, 0.50])
BUBBLE_CLOUDS = Cover(-0.02, 5.0, 1.0, -0.5, 0.4)
PERIOD = 8  # units of time of the bubble's texture


def solid_and_mapped(model: Model, view: View) -> Picture:
    """Draw four balls: classic above, simplex below, solid left, wrapped right."""
    refuse_unused(view, "camera")
    half = max(view.width // 2, 1), max(view.height // 2, 1)
    suns = (SUN,) if view.suns is None else view.suns
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
                panel = ball_of_noise(found, kind, solid, view, suns)
                rows = slice(row * half[1], (row + 1) * half[1])
                light[rows, column * half[0] : (column + 1) * half[0]] = panel
        return light, (), ()

    return timed(draw)


def ball_of_noise(
    found: Places, kind: KindName, solid: bool, view: View, suns
) -> Array:
    """Draw a ball of one kind of noise, solid or with a picture wrapped around it."""
    how = {"kind": kind, "seed": SOLID_SEED, "octaves": 1, "dtype": precision(view)}

    def shade(at: Places) -> tuple[Array, Array]:
        if solid:
            noise = fbm(SOLID_CELLS * at.points, time=view.time, **how)
        else:
            # As many cells along the equator and from pole to pole as the solid has.
            line = (np.arange(PICTURE) + 0.5) / PICTURE * math.pi * SOLID_CELLS
            flat = np.stack(np.meshgrid(2.0 * line, line[::2]), axis=-1)
            picture = fbm(flat, time=view.time, **how)
            noise = looked_up(picture, at.coordinates)
        grey = srgb_decode(np.clip(0.5 + 0.5 * noise, 0.0, 1.0))
        return grey[:, None] * lambert(at.points, suns) * 0.75, np.ones(len(grey))

    height, width = found.seen.shape
    return shaded(np.full((height, width, 3), 0.06), found, shade)


def puff(model: Model, view: View) -> Picture:
    """Draw the puff over a sky; its light is marched toward the sun in its plane."""
    refuse_unused(view, "camera")
    suns = (SUN,) if view.suns is None else view.suns

    def draw():
        # 1. Density at every pixel's centre.
        width, height = view.width, view.height
        pixel = 3.4 / min(width, height)
        x: Array = pixel * (np.arange(width, dtype=np.float64) + 0.5 - 0.5 * width)
        y: Array = pixel * (0.5 * height - np.arange(height, dtype=np.float64) - 0.5)
        at = np.stack(np.meshgrid(x, y), axis=-1)
        how = {"time": view.time, "dtype": precision(view)}
        density = puff_density(at, PUFF, **how)

        observed(view, "density", density)

        # 2. From each pixel toward the suns, looked up among the pixels, where it was
        #    drawn already (R09); around the picture there is none.
        rows, columns = np.nonzero(density > 0.0)
        framed = np.pad(density, 1)
        light = np.repeat(SHADE[None], len(rows), axis=0)
        for sun in suns:
            depth = np.zeros(len(rows))
            for i in range(PUFF_STEPS):
                far = (i + 0.5) * PUFF_STEP / pixel
                u = np.clip(columns + 1 + far * sun.direction[0], 0, width + 1)
                v = np.clip(rows + 1 - far * sun.direction[1], 0, height + 1)
                depth += PUFF_STEP * wrapped_bilinear(framed, u, v)
            T = np.exp(-PUFF_SIGMA * depth)[:, None]
            light += SMOKE * T * sun.irradiance / WHOLE_SPHERE * 0.8

        # 3. Over the sky.
        ahead = np.array([0.0, 0.6, -1.0])
        over = painted(Camera(np.zeros(3), ahead, width=width, height=height), view)
        share = -np.expm1(-PUFF_OPACITY * density[rows, columns])[:, None]
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


def bubble_mesh(time: float) -> Mesh:
    """Make the moved sphere: normals, and the place before it was moved, beside it."""
    ball = sphere_mesh(COLUMNS, ROWS)
    points, normals = displaced_sphere(ball.points, BUBBLE, time=time)
    return Mesh(points, ball.faces, np.concatenate([normals, ball.points], axis=1))


def bubble(model: Model, view: View) -> Picture:
    """Draw the distorted sphere as textured triangles, lit by its own normals."""
    refuse_unused(view)
    camera = bubble_eye(model, view)
    suns = (FRONT,) if view.suns is None else view.suns

    def shade(fragments: Fragments) -> Array:
        normals, at = fragments.values[:3].T, fragments.values[3:].T
        normals = normals / np.linalg.norm(normals, axis=1, keepdims=True)
        noise = fbm(
            BUBBLE_CELLS * at,
            time=view.time,
            seed=BUBBLE_SEED,
            octaves=5,
            period=PERIOD,
            dtype=precision(view),
        )
        white, share = cloud_cover(noise, BUBBLE_CLOUDS)
        color = share[:, None] * white[:, None] + (1.0 - share[:, None]) * BLUE
        rgba = np.ones((len(color), 4))
        rgba[:, :3] = color * lambert(normals, suns)
        return rgba

    def draw():
        buffer = framebuffer(camera.width, camera.height, depth=1.0)
        buffer.pixels[..., :3] = painted(camera, view)
        mesh = bubble_mesh(view.time)
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


def raw(model: Model, view: View) -> Picture:
    """Draw the hash of every pixel's place, in squares of some pixels."""
    flat_alone(view)
    edge = max(view.width, view.height) / 64.0
    column = (np.arange(view.width) / edge).astype(np.int64)
    row = (np.arange(view.height) / edge).astype(np.int64)[:, None]
    return greys(0.5 + 0.5 * lattice_random(column, row, 0, seed=1))


for name, title, draw_one, motion in (
    (
        "a",
        "appendix A: noise solid and mapped",
        solid_and_mapped,
        Motion(suns=(SUN,), period=math.inf),
    ),
    ("d", "appendix D: a puff", puff, Motion(suns=(SUN,), period=float(PUFF.period))),
    (
        "e",
        "appendix E: a distorted sphere",
        bubble,
        Motion(bubble_eye, (FRONT,), period=math.inf),
    ),
    ("raw", "raw pseudo-random numbers", raw, Motion()),
):
    enter(Scene(f"shader-{name}", f"document S: {title}", no_model, draw_one, motion))
