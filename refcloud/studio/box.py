"""Document D's program: a cloud in a box, with its sliders (W06, W07)."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from typing import Annotated, Literal

import numpy as np

from refcloud.camera import Camera, OrthographicCamera
from refcloud.checking import check_fields, checked
from refcloud.cloudmap import VoxelGrid
from refcloud.conventions import Array, Observer, Range, Seed, Shape, Tolerance, Vector
from refcloud.image import Picture
from refcloud.lighting import Octaves, octave_march
from refcloud.optics import Medium, Sun
from refcloud.raster import draw_box
from refcloud.raster.walls import LIGHT_BLUE
from refcloud.scene import View
from refcloud.scenes.demand import NO_WALL, OWN, over_opaque
from refcloud.scenes.demand_plane import mended

Frame = Literal["walls", "lines", "none"]
Samples = Annotated[int, Range(1, 4096)]


@dataclass(frozen=True)
class Box:
    """Where the box of a cloud stands, and how large it is.

    Attributes
    ----------
    place
        Its middle, shape (3,), scene units.
    lengths
        Along x, y and z, shape (3,), scene units, above 0.
    """

    place: Vector = field(default_factory=lambda: 0.5 * (OWN.lower + OWN.upper))
    lengths: Annotated[
        Array, Shape(3), Range(0.0, 1e6, "scene units", open_lower=True)
    ] = field(default_factory=lambda: OWN.upper - OWN.lower)

    def __post_init__(self) -> None:
        check_fields(self)

    def corners(self) -> tuple[Array, Array]:
        """Give the lower and the upper corner."""
        return self.place - 0.5 * self.lengths, self.place + 0.5 * self.lengths


@checked
def box_picture(
    cloud: VoxelGrid,
    camera: Camera | OrthographicCamera,
    *,
    suns: tuple[Sun, ...],
    medium: Medium,
    octaves: Octaves,
    samples: Samples = 256,
    frame: Frame = "walls",
    tolerance: Tolerance = 0.0,
    seed: Seed = 0,
    observe: Observer | None = None,
) -> Picture:
    """Draw a cloud map in its box, before document D's sky.

    Formula: `refcloud.lighting.octave_march` between the walls behind the cloud and
    those before it

    Parameters
    ----------
    cloud
        The cloud map; its box is the one that is drawn.
    camera
        The eye.
    suns
        The lights.
    medium
        What the cloud is made of; its phase function is "hg" or "isotropic".
    octaves
        The light model.
    samples
        The sample rate: samples along the box's diagonal.
    frame
        What is drawn of the box: its walls and lines, its lines, or nothing.
    tolerance
        Largest error of a channel that savings may make.
    seed
        Chooses where the rays start between two samples.
    observe
        Called with (name, value) for each intermediate.

    Returns
    -------
    The picture.

    Source: document D, Prior to Ray Tracing, Ray and Box intersection (F08, F09, R02).

    Examples
    --------
    >>> cloud = VoxelGrid(np.ones((2, 2, 2)), [-1, -1, -1], [1, 1, 1])
    >>> eye = Camera([0, 0, 9], [0, 0, 0], width=4, height=3)
    >>> how = dict(medium=Medium(1.0, phase="hg"), octaves=Octaves(), samples=4)
    >>> box_picture(cloud, eye, suns=(), **how).linear.shape
    (3, 4, 3)
    """
    start = time.perf_counter()
    buffer = over_opaque(mended(View(camera.width, camera.height)))
    wall = NO_WALL if frame == "lines" else LIGHT_BLUE
    box = cloud.lower, cloud.upper
    if frame != "none":
        draw_box(buffer, camera, *box, "behind", wall_color=wall)
    drawn = time.perf_counter()
    L, T, skipped = octave_march(
        cloud,
        camera,
        suns=suns,
        medium=medium,
        octaves=octaves,
        step=step_of(cloud, samples),
        tolerance=tolerance,
        seed=seed,
        observe=observe,
    )
    buffer.pixels[..., :3] = L + T[..., None] * buffer.pixels[..., :3]
    marched = time.perf_counter()
    if frame != "none":
        draw_box(buffer, camera, *box, "before", wall_color=wall)
    seconds = {"walls": drawn - start, "march": marched - drawn}
    seconds["walls"] += time.perf_counter() - marched
    note = f"cloud: {np.count_nonzero(cloud.density)} voxels"
    return Picture(buffer.pixels[..., :3], None, skipped, seconds, (note,))


def step_of(cloud: VoxelGrid, samples: int) -> float:
    """Give the distance between samples that sets so many on the box's diagonal."""
    return float(np.sqrt(np.square(cloud.upper - cloud.lower).sum())) / samples
