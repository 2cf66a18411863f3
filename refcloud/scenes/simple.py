"""Document C's sky, step by step, and the textured quad that it scrolls.

``simple-noise`` is its 32 x 32 map as SetNoise makes it, ``simple-smoothed`` the map
smoothed by nine taps, ``simple-interpolated`` its first octave, ``simple-octaves`` the
sum of four and ``simple-filtered`` the cloud. ``simple-quad`` is DrawGLScene to the
letter: a grey quad over the middle of a black window, scrolled by the texture matrix;
``simple-sky`` the sheet as clouds on a blue sky, on a quad that fills the window.

The program runs in three parts (W13): Init makes the map, LoopForever sums and filters
it, DrawGLScene draws. Lines that the document's page lost are recovered (E31): the
three channels take the colour, MIN and MAG filters are LINEAR, WRAP is REPEAT, x grows
by 0.01 a frame and moves the texture matrix.

Its faults, and what is done here:

* the same cloud is summed and filtered again for every frame; here once, and kept;
* a new texture every frame, never deleted: 262143 bytes each with its mipmaps
  (`bytes_of_a_frame`); here one texture;
* those mipmaps are built and never read, for LINEAR filters the texture itself;
* `char` for 0 to 255 cannot hold what is above 127 where char is signed;
* the matrix mode is left at GL_TEXTURE: the next frame's glLoadIdentity then resets the
  scroll instead of the view, and only by that luck x is the place and not the speed
  (`scrolled`);
* x is added to the coordinates, so the clouds go from right to left, not "from left to
  right": here the other way in ``simple-sky``;
* what it calls mirroring is wrapping, what it calls Perlin noise is value noise;
* values reach 256 before the sum and 480 after it, where its text says 255: only what
  is above 235 of them is cloud, and all of that is below 255 again.
"""

from __future__ import annotations

import dataclasses
import math
import time
from collections.abc import Callable
from functools import partial

import numpy as np

from refcloud.camera import OrthographicCamera
from refcloud.conventions import Array
from refcloud.image import Picture
from refcloud.noise import cloud_sheet, elias2d, overlap_octaves, sheet_map
from refcloud.noise.sheet import WHITE
from refcloud.raster import (
    Fragments,
    Mesh,
    Texture,
    Textured,
    draw_triangles,
    framebuffer,
)
from refcloud.scene import Model, Motion, Scene, View, enter
from refcloud.scenes.demand_plane import flat_alone, greys
from refcloud.sky import sky_gradient

SEED = 7
SMALL, LARGE = 32, 256
STEP = 0.01  # of the texture's width a frame
FRAMES = 100  # after which the scroll is where it was
MOST = 480.0  # what the sum of four octaves reaches
TOP, BOTTOM = np.array([0.035, 0.13, 0.42]), np.array([0.30, 0.48, 0.74])
LIGHT = np.array([1.0, 0.99, 0.97])
SPAN = 0.75  # share of the sheet's height that the sky's window shows


def raw_map() -> Array:
    """Give the map before it is smoothed."""
    x, y = np.arange(1, SMALL + 1), np.arange(1, SMALL + 1)[:, None]
    return 128.0 + 128.0 * elias2d(x, y, seed=SEED)


def first_octave() -> Array:
    """Give the first octave: the map blown up to the sheet's size."""
    return overlap_octaves(sheet_map(SMALL, seed=SEED), LARGE, octaves=1)


def octaves() -> Array:
    """Give the sum of four octaves, as grey levels of 255."""
    return overlap_octaves(sheet_map(SMALL, seed=SEED), LARGE) * (WHITE / MOST)


def cloud() -> Array:
    """Give the cloud."""
    return cloud_sheet(LARGE, seed=SEED)


def step(model: Model, view: View, *, make: Callable[[], Array]) -> Picture:
    """Show one step of the program, a square for each number."""
    flat_alone(view)
    start = time.perf_counter()
    values = make()
    seconds = {"sheet": time.perf_counter() - start}
    # Squares of whole numbers, as many as fit, from the top row on.
    side = max(view.width, view.height)
    rows = np.arange(view.height) * len(values) // side
    columns = np.arange(view.width) * len(values) // side
    shown = np.clip(values[rows[:, None], columns] / WHITE, 0.0, 1.0)
    return dataclasses.replace(greys(shown), seconds=seconds)


def scrolled(frames: float, *, reset: bool = True) -> float:
    """Give how far the texture has been moved after some frames.

    Parameters
    ----------
    frames
        How many were drawn.
    reset
        Whether each frame begins with the texture's matrix at identity, which the
        document owes to its own fault; without it every frame moves on from the last.

    Returns
    -------
    Of the texture's width: 0.01 n, or 0.01 (1 + 2 + ... + n).
    """
    return STEP * frames if reset else STEP * frames * (frames + 1.0) / 2.0


def bytes_of_a_frame(size: int = LARGE) -> int:
    """Count the bytes of the texture that each frame leaves behind, mipmaps among them.

    Parameters
    ----------
    size
        Texels along each side, a power of two.

    Returns
    -------
    Three bytes for each texel of every level down to one texel.
    """
    return 3 * sum(4**level for level in range(size.bit_length()))


def quad(half_width: float, half_height: float, across: float, down: float) -> Mesh:
    """Make a rectangle about the origin that shows so much of a texture."""
    corners = np.array([[1, 1], [0, 1], [0, 0], [1, 0]], np.float64)
    x, y = ((2.0 * corners - 1.0) * [half_width, half_height]).T
    points = np.stack([x, y, np.zeros(4)], axis=-1)
    return Mesh(points, np.array([[0, 1, 2], [0, 2, 3]]), corners * [across, down])


def window(view: View, half_height: float) -> OrthographicCamera:
    """Look at the quad along -z; x and y of OpenGL's window where half_height is 1."""
    return OrthographicCamera(
        np.array([0.0, 0.0, 1.0]),
        np.zeros(3),
        height_of_view=2.0 * half_height,
        width=view.width,
        height=view.height,
    )


def moved(s: float, t: float = 0.0) -> Array:
    """Give the texture matrix of glTranslatef(s, t, 0)."""
    matrix = np.eye(4)
    matrix[:2, 3] = s, t
    return matrix


def kept_texture(view: View) -> Texture:
    """Make the texture, or take the one of the frame before."""
    stored = None if view.kept is None else view.kept.get("sheet")
    if stored is None:
        texels = np.repeat(cloud()[..., None] / WHITE, 3, axis=-1)
        stored = Texture(
            texels, wrap="REPEAT", mag_filter="LINEAR", min_filter="LINEAR"
        )
        if view.kept is not None:
            view.kept["sheet"] = stored
    return stored


def drawn_quad(model: Model, view: View) -> Picture:
    """Draw the document's scene: a grey quad over half of the window's sides."""
    flat_alone(view)
    start = time.perf_counter()
    texture = kept_texture(view)
    texture = dataclasses.replace(texture, matrix=moved(scrolled(view.time)))
    buffer = framebuffer(view.width, view.height)
    # The window is 2 high and 2 wide, whatever its shape in pixels.
    wide = 0.5 * view.width / view.height
    draw_triangles(
        buffer, window(view, 1.0), quad(wide, 0.5, 1.0, 1.0), Textured(texture)
    )
    shown = greys(np.clip(buffer.pixels[..., 0], 0.0, 1.0))
    return dataclasses.replace(shown, seconds={"draw": time.perf_counter() - start})


def drawn_sky(model: Model, view: View) -> Picture:
    """Draw the sheet as clouds on a sky, on a quad that fills the window."""
    flat_alone(view)
    start = time.perf_counter()
    texture = kept_texture(view)
    wind = np.zeros(3) if view.offset is None else np.asarray(view.offset)
    # What moves right is looked up further left.
    matrix = moved(-scrolled(view.time) - wind[0], -wind[1])
    texture = dataclasses.replace(texture, matrix=matrix)
    buffer = framebuffer(view.width, view.height)
    size = {"width": view.width, "height": view.height}
    buffer.pixels[..., :3] = sky_gradient(TOP, BOTTOM, **size)
    wide = view.width / view.height

    def shade(fragments: Fragments) -> Array:
        opacity = Textured(texture)(fragments)[:, :1]
        behind = buffer.pixels[fragments.row, fragments.column]
        rgba = behind + opacity * (np.array([*LIGHT, 1.0]) - behind)
        rgba[:, 3] = 1.0
        return rgba

    mesh = quad(0.5 * wide, 0.5, SPAN * wide, SPAN)
    draw_triangles(buffer, window(view, 0.5), mesh, shade)
    seconds = {"draw": time.perf_counter() - start}
    return Picture(buffer.pixels[..., :3], None, (), seconds)


def no_model() -> Model:
    """Make nothing yet: the sheet is the scene's texture."""
    return Model({})


SCROLL = Motion(period=float(FRAMES))
BLOWN = Motion(period=float(FRAMES), repeats=(1.0, 1.0, math.inf))
for name, title, draw, motion in (
    ("noise", "the random map", partial(step, make=raw_map), Motion()),
    (
        "smoothed",
        "the map smoothed",
        partial(step, make=partial(sheet_map, SMALL, seed=SEED)),
        Motion(),
    ),
    ("interpolated", "the first octave", partial(step, make=first_octave), Motion()),
    ("octaves", "four octaves", partial(step, make=octaves), Motion()),
    ("filtered", "the exponential filter", partial(step, make=cloud), Motion()),
    ("quad", "the scrolling quad, to the letter", drawn_quad, SCROLL),
    ("sky", "the sheet as a scrolling sky", drawn_sky, BLOWN),
):
    enter(Scene(f"simple-{name}", f"document C: {title}", no_model, draw, motion))
