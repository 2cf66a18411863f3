"""Document S's first experiment: a field of clouds as particles, slow from blending.

``shader-particles`` draws some 2500 particles as splats and counts what the document
blames, the pixels that are blended: every particle's disc, most of them on top of each
other (V12). A sky on a surface blends each pixel once.
"""

from __future__ import annotations

import dataclasses
import time
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from refcloud.camera import AnyCamera, Camera, project
from refcloud.checking import check_fields
from refcloud.compose import Layer, draw_layers
from refcloud.conventions import Array, Positive, Range
from refcloud.declared import Kind, enter_kind
from refcloud.extremes import refuse_small
from refcloud.image import Picture
from refcloud.lighting import Haze, named
from refcloud.metaballs import Metaballs
from refcloud.noise import uniform
from refcloud.optics import Medium, Sun
from refcloud.raster.footprint import patch_of
from refcloud.scene import Model, Motion, Own, View
from refcloud.sky import Sky


@dataclass(frozen=True)
class Particles:
    """A field of clouds of particles.

    Attributes
    ----------
    clouds, particles
        How many clouds, and particles in each.
    seed
        Which places; the particles' own come from the next.
    spacing, base
        Between clouds, and up to their bases.
    wide, high
        Half width and height of a cloud.
    sun, medium, air
        The light, what particles are made of, and the distance over which air takes
        all but 1/e of their light.
    """

    clouds: Annotated[int, Range(1, 1000)]
    particles: Annotated[int, Range(1, 1000)]
    seed: Annotated[int, Range(0, 2**62)]
    spacing: Annotated[float, Positive]
    base: Annotated[float, Range(0.0, 1e6, "scene units")]
    wide: Annotated[float, Positive]
    high: Annotated[float, Positive]
    sun: Sun
    medium: Medium
    air: Annotated[float, Positive]

    def __post_init__(self) -> None:
        check_fields(self)
        refuse_small("air", self.air)


OWN = Particles(
    clouds=26,
    particles=96,
    seed=11,
    spacing=34.0,
    base=22.0,
    wide=13.0,
    high=7.0,
    sun=Sun(
        np.array([-0.62, 0.62, 0.42]), 1.25 * 4.0 * np.pi * np.array([1, 0.96, 0.9])
    ),
    medium=Medium(0.9),
    air=420.0,
)
HAZE = np.array([0.58, 0.70, 0.83])


def particles(of: Particles = OWN) -> Model:
    """Scatter particles: clouds on a jittered grid, flat below and heaped above."""
    start = time.perf_counter()
    cloud = np.arange(of.clouds)
    row, column = cloud // 5, cloud % 5
    jitter = uniform(cloud[:, None], np.arange(4), seed=of.seed)
    scale = 0.6 + 0.7 * jitter[:, 2]
    middle = np.stack(
        [
            (column - 2.0 + 0.8 * (jitter[:, 0] - 0.5))
            * of.spacing
            * (1.0 + 0.25 * row),
            np.full(of.clouds, of.base),
            -(70.0 + of.spacing * 1.6 * row + of.spacing * jitter[:, 1]),
        ],
        axis=-1,
    )
    index = np.arange(of.clouds * of.particles).reshape(of.clouds, of.particles)
    u = uniform(index[..., None], np.arange(5), seed=of.seed + 1)
    around, away = 2.0 * np.pi * u[..., 0], np.sqrt(u[..., 1])
    heap = (1.0 - away**2) * u[..., 2]  # lower toward the rim
    size = (0.55 + 0.65 * u[..., 3]) * (1.0 - 0.5 * away)
    offset = np.stack(
        [
            of.wide * away * np.cos(around),
            of.high * heap + 2.4 * size,
            0.7 * of.wide * away * np.sin(around),
        ],
        axis=-1,
    )
    centers = middle[:, None] + scale[:, None, None] * offset
    radii = 4.6 * scale[:, None] * size
    balls = Metaballs(
        centers.reshape(-1, 3), radii.ravel(), np.full(radii.size, 0.55), "wyvill"
    )
    note = f"field: {of.clouds} clouds of {of.particles} particles"
    return Model(
        {"field": balls}, (note,), (), {"scatter": time.perf_counter() - start}
    )


def eye(model: Model, view: View) -> AnyCamera:
    """Stand below the field and look over the horizon."""
    if view.camera is not None:
        return view.camera
    return Camera(
        np.array([0.0, 2.0, 0.0]),
        np.array([0.0, 17.0, -70.0]),
        fov_y=0.6,
        width=view.width,
        height=view.height,
    )


def blended_pixels(balls: Metaballs, camera: AnyCamera) -> int:
    """Count the pixels that splats of all balls blend: one for each ball over each.

    Parameters
    ----------
    balls
        The particles.
    camera
        The eye.

    Returns
    -------
    The sum over balls of the pixels whose centres lie in their discs.
    """
    x, y, _, scale = project(camera, balls.centers)
    size = camera.width, camera.height
    total = 0
    for place in zip(x, y, scale * balls.radii, strict=True):
        found = None if place[2] <= 0.0 else patch_of(*place, *size)
        total += 0 if found is None else int(np.count_nonzero(found.q < 1.0))
    return total


def draw(of: Particles, model: Model, view: View) -> Picture:
    """Draw the field as splats, and count their pixels."""
    camera = eye(model, view)
    balls = model.clouds["field"]
    if view.offset is not None:
        moved: Array = balls.centers + np.asarray(view.offset)
        balls = dataclasses.replace(balls, centers=moved)
    haze = Haze(HAZE, of.air)
    look = named(view.look or "cumulus")
    layer = Layer(balls, view.medium or of.medium, look, haze)
    picture = draw_layers(
        [layer],
        camera,
        (of.sun,) if view.suns is None else view.suns,
        Sky(),
        tolerance=view.tolerance,
        seed=view.seed,
        observe=view.observe,
        backend=view.backend,
    )
    blended, pixels = blended_pixels(balls, camera), camera.width * camera.height
    note = (
        f"blended: {blended} pixels of {len(balls.radii)} particles,"
        f" {blended / pixels:.1f} for each of the picture's {pixels}"
    )
    return dataclasses.replace(picture, notes=(*picture.notes, note))


def brings(of: Particles, model: Model | None, view: View) -> Own:
    """Give sun, medium and look."""
    return Own((of.sun,), of.medium, named(view.look or "cumulus"))


def turning(of: Particles) -> Motion:
    """Turn eye and sun; wind carries every particle away."""
    never = (np.inf, np.inf, np.inf)
    return Motion(eye, (of.sun,), turns="in place", repeats=never)


enter_kind(
    Kind(
        "shader-particles",
        "document S: section 2: a field of clouds as particles",
        OWN,
        draw,
        turning,
        particles,
        ("seed",),
        brings,
    )
)
