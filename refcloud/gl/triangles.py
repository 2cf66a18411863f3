"""Triangles on OpenGL: corners go in as places of clip space, textures as they are.

Corners are projected here in float64 and handed over as float32, so that a comparison
is one of rasterisers, and not of roundings in a matrix.
"""

from __future__ import annotations

import ctypes
import functools
from collections.abc import Callable
from typing import Any

import numpy as np

from refcloud.camera import AnyCamera, Camera
from refcloud.checking import complaint
from refcloud.conventions import Array
from refcloud.gl.opengl import context, refuse_errors
from refcloud.gl.state import DEPTH_TEST, set_state
from refcloud.gl.target import Target
from refcloud.raster import Mesh, State, Texture, Textured
from refcloud.raster.fragments import PLAIN
from refcloud.raster.lookup import transformed
from refcloud.raster.window import NEAR, scale_of, to_camera

ENUMS = {
    "NEAREST": 0x2600,
    "LINEAR": 0x2601,
    "NEAREST_MIPMAP_NEAREST": 0x2700,
    "LINEAR_MIPMAP_NEAREST": 0x2701,
    "NEAREST_MIPMAP_LINEAR": 0x2702,
    "LINEAR_MIPMAP_LINEAR": 0x2703,
    "REPEAT": 0x2901,
    "CLAMP_TO_EDGE": 0x812F,
    "MIRRORED_REPEAT": 0x8370,
}
WRAP_OF = 0x2802, 0x2803, 0x8072  # GL_TEXTURE_WRAP_S, _T, _R
TARGET_OF = {2: 0x0DE1, 3: 0x806F}  # GL_TEXTURE_2D, GL_TEXTURE_3D
CULL_FACE = 4  # moderngl's flag

VERTEX = """
#version 330
in vec4 place;
in vec3 coords;
out vec3 str;
void main() {
    gl_Position = place;
    str = coords;
}
"""
FRAGMENT = """
#version 330
in vec3 str;
out vec4 source;
uniform vec4 color;
%s
void main() { source = %s; }
"""
# What a fragment gives: its colour, or what a comparison wants to see.
SHADERS = {
    "flat": ("", "color"),
    "2": ("uniform sampler2D texels;", "color * texture(texels, str.st)"),
    "3": ("uniform sampler3D texels;", "color * texture(texels, str)"),
    "values": ("", "vec4(str, gl_PrimitiveID)"),
}


def draw_triangles(
    target: Target,
    camera: AnyCamera,
    mesh: Mesh,
    shade: Array | Textured,
    *,
    state: State = PLAIN,
    cull: str | None = None,
    near: float = NEAR,
    far: float | None = None,
) -> None:
    """Draw a mesh; twin of `refcloud.raster.draw_triangles` for colours and textures.

    Parameters
    ----------
    target
        The framebuffer, of the camera's size.
    camera, mesh, state, cull, near, far
        As the twin.
    shade
        RGBA, shape (4,), or a `Textured`.

    Raises
    ------
    ValueError
        shade is a function, which OpenGL cannot call.
    """
    prepared(target, camera, mesh, shade, cull=cull, near=near, far=far)(state)


def prepared(
    target: Target,
    camera: AnyCamera,
    mesh: Mesh,
    shade: Any,
    *,
    cull: str | None = None,
    near: float = NEAR,
    far: float | None = None,
) -> Callable[[State], None]:
    """Hand a mesh and its texture over, and give the call that draws them.

    Parameters
    ----------
    target, camera, mesh, shade, cull, near, far
        As `draw_triangles`; the word "values" for shade writes s, t, r and the number
        of the triangle.

    Returns
    -------
    A function of the state.
    """
    ctx = context()
    coords, texture, color, kind = np.zeros((3, len(mesh.points))), None, shade, "flat"
    if isinstance(shade, Textured):
        first, d = shade.first, shade.texture.dimension
        coords[:d] = transformed(shade.texture, mesh.attributes.T[first : first + d])
        texture, color, kind = uploaded(shade.texture), shade.color, str(d)
    elif isinstance(shade, str):
        coords[: mesh.attributes.shape[1]] = mesh.attributes.T[:3]
        color, kind = np.ones(4), shade
    elif callable(shade):
        expected, advice = "a colour or a Textured", "choose the backend numpy"
        raise ValueError(complaint("shade", expected, "a function", advice))
    place = in_clip_space(camera, mesh.points, near, far)
    corners = ctx.buffer(np.concatenate([place, coords.T], axis=1).astype("f4"))
    indices = ctx.buffer(mesh.faces.astype("u4")) if len(mesh.faces) else None
    program = compiled(kind)
    layout = [(corners, "4f 3f", "place", "coords")]
    if kind == "flat":
        layout = [(corners, "4f 12x", "place")]
    triangles = ctx.vertex_array(program, layout, indices)
    for name, value in (("color", tuple(color)), ("texels", 0)):
        if name in program:
            program[name] = value

    def draw(state: State) -> None:
        if indices is None:
            return
        target.fbo.viewport = 0, 0, target.width, target.height
        if state.scissor is not None:
            target.fbo.scissor = target.box(*state.scissor)
        set_state(target.fbo, state)
        if cull is not None:
            ctx.cull_face = cull.lower()
            ctx.front_face = "ccw"
            depth = DEPTH_TEST * (state.depth_func is not None)
            ctx.enable(CULL_FACE | depth)
        if texture is not None:
            texture.use(0)
        triangles.render(ctx.TRIANGLES)
        target.fbo.scissor = None
        refuse_errors("drawing triangles")

    return draw


def in_clip_space(
    camera: AnyCamera, points: Array, near: float, far: float | None
) -> Array:
    """Give clip coordinates, float64, whose window depth is that of `raster`.

    Parameters
    ----------
    camera, near, far
        As `draw_triangles`.
    points
        Shape (V, 3), scene units.

    Returns
    -------
    Shape (V, 4).
    """
    right, up, depth = to_camera(camera, points).T
    scale = 2.0 * scale_of(camera)
    x, y = scale / camera.width * right, scale / camera.height * up
    if isinstance(camera, Camera):
        if far is None:
            z = depth - 2.0 * near
        else:
            z = ((far + near) * depth - 2.0 * far * near) / (far - near)
        return np.stack([x, y, z, depth], axis=-1)
    end = max(float(depth.max(initial=near)), 2.0 * near) if far is None else far
    z = 2.0 * (depth - near) / (end - near) - 1.0
    return np.stack([x, y, z, np.ones_like(depth)], axis=-1)


@functools.cache
def compiled(kind: str) -> Any:
    """Compile a program, once for each kind of shade."""
    return context().program(VERTEX, FRAGMENT % SHADERS[kind])


def uploaded(texture: Texture) -> Any:
    """Make a texture, with the levels that `refcloud.raster.mip_levels` gives it.

    Parameters
    ----------
    texture
        Its matrix is not handed over.

    Returns
    -------
    The moderngl texture; in space the smaller levels are those of glGenerateMipmap.
    """
    ctx, levels, codes = context(), texture.levels, texture.texels.dtype == np.uint8
    *sides, channels = levels[0].shape

    def raw(level: Array) -> bytes:
        data = np.rint(level * 255.0).astype("u1") if codes else level.astype("f4")
        return np.ascontiguousarray(data).tobytes()

    make = ctx.texture if texture.dimension == 2 else ctx.texture3d
    dtype = "f1" if codes else "f4"
    made = make(tuple(sides[::-1]), channels, raw(levels[0]), alignment=1, dtype=dtype)
    if len(levels) > 1:
        made.build_mipmaps()
        for number, level in enumerate(levels):
            if texture.dimension == 2:
                made.write(raw(level), level=number, alignment=1)
    made.filter = ENUMS[texture.min_filter], ENUMS[texture.mag_filter]
    made.use(0)
    call = ctypes.CFUNCTYPE(None, ctypes.c_uint, ctypes.c_uint, ctypes.c_int)(
        ctx.mglo._context.load("glTexParameteri")
    )
    for name, wrap in zip(WRAP_OF, texture.wraps, strict=False):
        call(TARGET_OF[texture.dimension], name, ENUMS[wrap])
    refuse_errors("making a texture")
    return made
