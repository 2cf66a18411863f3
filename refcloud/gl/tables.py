"""Tables of float32 in textures, read by whole numbers: exactly, and of any shape.

A texture's filter interpolates with 8-bit weights on much hardware, and a 3-D texture
is at most 2048 cells wide. So a table lies in a 2-D texture, row after row of cells,
and shaders fetch the eight corners themselves.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from refcloud.conventions import Array
from refcloud.gl.opengl import context, refuse_errors, refuse_large_side

ROW_BITS = 12
ROW = 1 << ROW_BITS  # texels in a row of the texture

FETCH = f"""
vec4 cell_of(sampler2D table, int index) {{
    return texelFetch(table, ivec2(index & {ROW - 1}, index >> {ROW_BITS}), 0);
}}
"""

# refcloud.cloudmap.sample.clamped_trilinear: `cell` and the place's distance from it,
# so that float32 counts neighbouring cells finely however far they are from cell 0.
TRILINEAR = """
vec4 trilinear(sampler2D table, vec3 cell, vec3 place, ivec3 count, int all, int one) {
    vec3 whole = floor(place);
    ivec3 i = ivec3(cell) + ivec3(whole);
    vec3 t = place - whole;
    t = mix(t, vec3(0.0), lessThan(i, ivec3(0)));
    t = mix(t, vec3(1.0), greaterThan(i, count - 2));
    i = clamp(i, ivec3(0), max(count - 2, ivec3(0)));
    ivec3 next = ivec3(1, count.x, count.x * count.y);
    next *= ivec3(greaterThan(count, ivec3(1)));
    int first = (i.z * count.y + i.y) * count.x + i.x;
    vec4 edges[4];
    for (int k = 0; k < 4; k++) {
        int near = first + (k & 1) * next.y + (k >> 1) * next.z;
        vec4 a = cell_of(table, near * all + one);
        vec4 b = cell_of(table, (near + next.x) * all + one);
        edges[k] = a + t.x * (b - a);
    }
    vec4 below = edges[0] + t.y * (edges[1] - edges[0]);
    vec4 above = edges[2] + t.y * (edges[3] - edges[2]);
    return below + t.z * (above - below);
}
"""


def table(values: Array) -> Any:
    """Put a table into a texture.

    Parameters
    ----------
    values
        Shape (cells, 1) or (cells, 4), finite in float32.

    Returns
    -------
    A moderngl.Texture; cell i is texel (i mod 4096, i // 4096).

    Raises
    ------
    ValueError
        This OpenGL cannot hold as many.
    """
    cells, components = values.shape
    rows = max(-(-cells // ROW), 1)
    refuse_large_side(ROW, rows)
    padded = np.zeros((rows * ROW, components), np.float32)
    padded[:cells] = values
    size = ROW, rows
    made = context().texture(size, components, padded.tobytes(), dtype="f4")
    refuse_errors("making a table")
    return made


def cells_from(points: Array, lower: Array, size: Array | float) -> tuple[Array, Array]:
    """Give places in cells as whole cells and what is left, each exact in float32.

    Parameters
    ----------
    points
        Shape (N, 3), scene units.
    lower
        Where cell 0 has its centre, shape (3,).
    size
        Of a cell, scene units.

    Returns
    -------
    Whole cells and parts in [0, 1), each of shape (N, 3).
    """
    places = (points - lower) / size
    whole = np.floor(places)
    return whole, places - whole
