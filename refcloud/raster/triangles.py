"""Triangles, textured and perspective-correct, as OpenGL draws them.

From a mesh to pixels in six steps, none of which loops over triangles or pixels: cut by
planes, project and snap, cull, find row spans, sort out what shows, shade and blend.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal

import numpy as np

from refcloud.camera import AnyCamera, Camera, OrthographicCamera
from refcloud.checking import check, check_fields, checked, complaint
from refcloud.conventions import Array, Range, Shape, Tolerance
from refcloud.raster.clipping import clip
from refcloud.raster.fragments import PLAIN, scissored
from refcloud.raster.framebuffer import CHANNELS, Framebuffer, Rgba
from refcloud.raster.lookup import level_of_detail, looked_up, transformed
from refcloud.raster.meshes import Mesh
from refcloud.raster.runs import Run, View, planes_through
from refcloud.raster.spans import area_of, reaching, row_spans
from refcloud.raster.store import State, flattened, unflattened, write
from refcloud.raster.texture import Texture
from refcloud.raster.varying import Fragments, fragments_of
from refcloud.raster.visible import layers, pieces, places
from refcloud.raster.window import (
    NEAR,
    Far,
    Near,
    planes_of,
    refuse_depths,
    refuse_other_size,
    snapped,
    to_camera,
)

Cull = Literal["FRONT", "BACK", "FRONT_AND_BACK"]
AT_ONCE = 1 << 17  # fragments that are sorted out together
BESIDE = 2.0  # pixels: further beside the window, no rounding leads back to it
SHADED_AT_ONCE = 1 << 15  # their numbers then stay in the cache
# Largest error of texels mixed in float32, of the largest among them: each of up to
# four mixings rounds five times, by 2^-24 of at most twice that.
MIXED_IN_FLOAT32 = 40.0 * 2.0**-24
WHITE = np.ones(CHANNELS)
WHITE.flags.writeable = False


@dataclass(frozen=True, eq=False)
class Textured:
    """Shade by a texture times a colour (GL_MODULATE).

    Attributes
    ----------
    texture
        What is looked up; missing channels are 0, a missing alpha is 1.
    color
        RGBA, shape (4,).
    first
        Which of the mesh's attributes is s; t, and r for a texture in space, follow.
    """

    texture: Texture
    color: Rgba = field(default_factory=lambda: WHITE)
    first: Annotated[int, Range(0, 1000)] = 0

    def __post_init__(self) -> None:
        check_fields(self)

    def __call__(self, fragments: Fragments) -> Array:
        """Give RGBA, shape (n, 4), in float32 where the tolerance allows that."""
        texture = self.texture
        scale = max(texture.largest * float(np.abs(self.color).max()), 1.0)
        kind = "f4" if fragments.tolerance >= MIXED_IN_FLOAT32 * scale else "f8"
        part = slice(self.first, self.first + texture.dimension)
        levels = None
        if texture.min_filter != texture.mag_filter:
            ways = fragments.along_x[part], fragments.along_y[part]
            levels = level_of_detail(texture, *ways)
        coords = transformed(texture, fragments.values[part])
        texels = looked_up(texture, coords, levels, kind)
        if texels.shape[1] == CHANNELS and (self.color == 1.0).all():
            return texels
        color = np.empty((CHANNELS, coords.shape[1]))
        for channel, share in enumerate(self.color):
            there = channel < texels.shape[1]
            if not there:
                color[channel] = share * (channel == 3)
            elif share == 1.0:
                color[channel] = texels[:, channel]
            else:
                np.multiply(texels[:, channel], share, color[channel])
        return color.T


Shade = Rgba | Textured | Callable[[Fragments], Array]


@checked
def draw_triangles(
    buffer: Framebuffer,
    camera: Camera | OrthographicCamera,
    mesh: Mesh,
    shade: Shade,
    *,
    state: State = PLAIN,
    cull: Cull | None = None,
    near: Near = NEAR,
    far: Far | None = None,
    tolerance: Tolerance = 0.0,
) -> None:
    """Draw a mesh, one triangle after the other, as GL_TRIANGLES.

    Formula: at the pixels of `triangle_pixels`, a = sum(b_k a_k / z_k) / sum(b_k / z_k)
    with barycentric b on the screen; then as `draw_fragments`

    Parameters
    ----------
    buffer
        The framebuffer, of the camera's size, written in place.
    camera
        The eye.
    mesh
        Corners, triangles, and the attributes to interpolate.
    shade
        Colours: RGBA of shape (4,), a `Textured`, or a function of `Fragments` that
        gives shape (n, 4), linear and finite. It may be called several times, for some
        of the pixels each time.
    state
        Depth test, blending, masks and scissor; by default all are off.
    cull
        Triangles left out: those that turn their FRONT, counterclockwise, or their BACK
        to the eye.
    near, far
        Depths between which triangles are cut off, scene units; without far nothing is
        too far. Depth in the buffer is 0 at near and 1 at far, or at infinity.
    tolerance
        By how much colours may be off, in units of displayed white: from about 2e-6 of
        a texture's largest number on its texels are mixed in float32.

    Returns
    -------
    Nothing.

    Raises
    ------
    ValueError
        The framebuffer has another size than the camera's picture, far is not beyond
        near, a texture has more coordinates than the mesh gives, parallel rays meet a
        depth test without far, or shade gives something else than finite colours.

    Source: OpenGL 4.6, chapters 13 and 14; paper S (F10, F11), document C (F04).

    Examples
    --------
    >>> from refcloud.raster import framebuffer, plane_mesh
    >>> buffer = framebuffer(2, 2)
    >>> view = OrthographicCamera([0, 1, 0], [0, 0, 0], [0, 0, -1], width=2, height=2)
    >>> draw_triangles(buffer, view, plane_mesh(1, 1, width=1.0), np.ones(4))
    >>> buffer.pixels[..., 0]
    array([[1., 0.],
           [1., 0.]])
    """
    refuse_other_size(buffer, camera)
    _refuse_unfit(camera, mesh, shade, state, near, far)
    height, width = buffer.pixels.shape[:2]
    box = scissored(state, slice(0, height), slice(0, width), height, width)
    how = {"cull": cull, "near": near, "far": far, "tolerance": tolerance}
    states = state, dataclasses.replace(state, depth_func=None)
    store, scratch = flattened(buffer), np.empty(height * width, np.int64)
    for fragments in covered(camera, mesh, box, **how):
        pixel = fragments.pixel(width)
        depths, alone = (lambda f=fragments: f.depth), fragments.alone
        sorted_out = layers(store, states, pixel, depths, scratch, alone=alone)
        for layer, left in sorted_out:
            for part in pieces(layer, SHADED_AT_ONCE):
                some = fragments.of(part)
                depth = None if left.depth_func is None else some.depth
                where = places(pixel, part)
                write(store, (where,), _shaded(shade, some), depth, left)
    unflattened(store, buffer)


def _shaded(shade: Any, fragments: Fragments) -> Array:
    """Ask for colours, and refuse what is none."""
    n = len(fragments)
    if not callable(shade):
        return np.broadcast_to(shade, (n, CHANNELS))
    if isinstance(shade, Textured):
        return shade(fragments)
    return check("shade", shade(fragments), Annotated[Array, Shape(n, CHANNELS)])


def _refuse_unfit(
    camera: AnyCamera, mesh: Mesh, shade: Any, state: State, near: float, far: Any
) -> None:
    """Refuse arguments that do not fit each other."""
    refuse_depths(camera, near, far, state.depth_func)
    if isinstance(shade, Textured):
        needed = shade.first + shade.texture.dimension
        if needed > mesh.attributes.shape[1]:
            got = f"{mesh.attributes.shape[1]}"
            expected = f"a mesh of at least {needed} attributes"
            raise ValueError(complaint("mesh", expected, got))


def covered(
    camera: AnyCamera,
    mesh: Mesh,
    box: tuple[slice, slice],
    *,
    cull: str | None,
    near: float,
    far: float | None,
    tolerance: float,
) -> Iterator[Fragments]:
    """Find the fragments of a mesh, unchecked.

    Parameters
    ----------
    camera, mesh, cull, near, far, tolerance
        As `draw_triangles`.
    box
        Rows and columns that may be drawn to.

    Yields
    ------
    Fragments, first those that have their pixels for themselves, then about AT_ONCE at
    a time in drawing order.
    """
    # 1. Into the camera's frame, and cut.
    corners = np.concatenate([to_camera(camera, mesh.points), mesh.attributes], axis=1)
    planes = planes_of(camera, near, far)
    beside = planes_of(camera, near, guard=BESIDE)[1:]
    corners, faces, source = clip(corners.T, mesh.faces.T, planes, beside)

    # 2. Into the window, on whole sub-pixels.
    place = snapped(camera, corners[:3].T, near)
    x, y = place[:, 0].take(faces), place[:, 1].take(faces)

    # 3. Which side is seen: on the screen, whose y runs down, fronts run clockwise
    #    backward. Corners are then taken clockwise. What misses the box is left out.
    area = area_of(x, y)
    front = area < 0
    kept = (area != 0) & reaching(x, box[1]) & reaching(y, box[0])
    if cull is not None:
        kept &= {"FRONT": ~front, "BACK": front}.get(cull, False)
    faces, source, front = faces[:, kept], source[kept], front[kept]
    faces = np.where(front, faces[[0, 2, 1]], faces)
    x, y = place[:, 0].take(faces), place[:, 1].take(faces)

    # 4. What is linear on the screen, and the spans of pixels it is wanted at.
    pinhole = isinstance(camera, Camera)
    away = np.clip(corners[2], near, far)
    values = np.concatenate([away[None], corners[3:]])
    if pinhole:
        values[0] = 1.0
        values /= away
    linear = planes_through(x, y, values.take(faces, axis=1))
    view = View(pinhole, near, far)
    for spans in row_spans(x, y, *box):
        alone, others = spans.parted()
        for some, most in ((alone, SHADED_AT_ONCE), (others, AT_ONCE)):
            run = Run(some, linear, source, front, view)
            for part in run.parts(most):
                yield fragments_of(part, tolerance, alone=some is alone)
