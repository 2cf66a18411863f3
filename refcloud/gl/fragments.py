"""Fragments drawn by OpenGL: a box of colours from a texture, one to a pixel."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np

from refcloud.conventions import Array
from refcloud.gl.opengl import context, refuse_errors
from refcloud.gl.state import set_state
from refcloud.gl.target import Target
from refcloud.raster import State
from refcloud.raster.formats import nearest_float32
from refcloud.raster.fragments import PLAIN, scissored
from refcloud.raster.framebuffer import refuse_other_box, within

# Four corners without a vertex buffer: the viewport is the box.
VERTEX = """
#version 330
void main() {
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
    gl_Position = vec4(2.0 * corner - 1.0, 0.0, 1.0);
}
"""
FRAGMENT = """
#version 330
uniform sampler2D colors;
uniform sampler2D depths;
uniform ivec2 corner;
{outputs}
void main() {{
    ivec2 place = ivec2(gl_FragCoord.xy) - corner;
    vec4 color = texelFetch(colors, place, 0);
    {writes}
}}
"""


def draw_fragments(
    target: Target,
    rows: slice,
    columns: slice,
    source: Array,
    *,
    depth: Array | float = 0.0,
    state: State = PLAIN,
) -> None:
    """Send a patch of fragments in; twin of `refcloud.raster.draw_fragments`.

    Parameters
    ----------
    target
        The framebuffer; every attachment gets the fragments.
    rows, columns
        The box that the patch fills, as slices within the buffer.
    source
        Colours of the fragments, shape (h, w, 4); float32 is what arrives.
    depth
        Their depths, one number or shape (h, w), in [0, 1].
    state
        The operations that are on.

    Raises
    ------
    ValueError
        The box leaves the buffer, or the patch has another size than the box.
    """
    rows, columns = (
        within("rows", rows, target.height),
        within("columns", columns, target.width),
    )
    refuse_other_box("source", source, rows, columns)
    box = scissored(state, rows, columns, target.height, target.width)
    if any(part.start == part.stop for part in box):
        return
    ctx = context()
    colors = _texture(source, 4)
    depths = _texture(np.broadcast_to(depth, source.shape[:2]), 1)
    fbo, tested = target.fbo, state.depth_func is not None
    fbo.viewport = target.box(rows, columns)
    fbo.scissor = target.box(*box)
    set_state(fbo, state)
    quad = _quad(len(target.formats), tested)
    colors.use(0)
    quad.program["colors"] = 0
    if tested:
        depths.use(1)
        quad.program["depths"] = 1
    quad.program["corner"] = fbo.viewport[:2]
    quad.render(ctx.TRIANGLE_STRIP, vertices=4)
    fbo.scissor = None
    refuse_errors("drawing fragments")


def clear(
    target: Target,
    color: Array | None,
    *,
    depth: float | None = None,
    state: State = PLAIN,
) -> None:
    """Set every pixel and every depth; twin of `refcloud.raster.clear`.

    Parameters
    ----------
    target
        The framebuffer.
    color
        Linear RGBA, shape (4,); None leaves the colours as they are.
    depth
        In [0, 1]; None leaves the depths as they are.
    state
        Its scissor and its masks are honoured.
    """
    rows, columns = slice(0, target.height), slice(0, target.width)
    box = scissored(state, rows, columns, target.height, target.width)
    if any(part.start == part.stop for part in box):
        return
    fbo = target.fbo
    fbo.viewport = 0, 0, target.width, target.height
    fbo.scissor = target.box(*box)
    # moderngl clears colours and depths at once: a mask holds back what stays.
    mask = state.color_mask if color is not None else (False, False, False, False)
    writes = state.depth_mask and depth is not None
    set_state(fbo, State(color_mask=mask, depth_mask=writes))
    value = np.zeros(4) if color is None else nearest_float32(np.asarray(color))
    fbo.clear(*value.tolist(), depth=0.0 if depth is None else depth)
    fbo.scissor = None
    refuse_errors("clearing")


def _texture(values: Array, components: int) -> Any:
    """Put a box of numbers into a texture, turned over."""
    height, width = values.shape[:2]
    data = np.ascontiguousarray(values[::-1], dtype=np.float32).tobytes()
    size = (width, height)
    return context().texture(size, components, data, alignment=1, dtype="f4")


@functools.cache
def _quad(attachments: int, tested: bool) -> Any:
    """Compile the program for a number of attachments, with depths or without."""
    outputs = "".join(
        f"layout(location = {k}) out vec4 out{k};\n" for k in range(attachments)
    )
    writes = " ".join(f"out{k} = color;" for k in range(attachments))
    if tested:
        writes += " gl_FragDepth = texelFetch(depths, place, 0).r;"
    ctx = context()
    program = ctx.program(VERTEX, FRAGMENT.format(outputs=outputs, writes=writes))
    return ctx.vertex_array(program, [])
