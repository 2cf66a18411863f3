"""Triangles beside their plain twins."""

from __future__ import annotations

import numpy as np
from hypothesis import assume
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from refcloud import raster
from refcloud.camera import Camera
from refcloud.plain import texture as plain_texture
from refcloud.plain import triangles as plain
from refcloud.raster import clipping, window
from twins import Draw, twin
from twins.camera import as_plain, drawn_camera, places
from twins.framebuffer import drawn_state
from twins.texture import assume_clear, drawn_texture
from twins.walls import WHOLE, as_array, assume_plain_places, listed, sizes, spots

WITHOUT: dict[str, str] = {}

nears = st.sampled_from([1e-3, 0.5, 4.0])
culls = st.sampled_from([None, None, None, "FRONT", "BACK", "FRONT_AND_BACK"])


@twin(raster.triangle_pixels, plain.triangle_pixels, tolerance=0.0, why=WHOLE)
def triangle_pixels(draw: Draw):
    corners, width, height = [draw(spots) for _ in range(3)], draw(sizes), draw(sizes)
    found = raster.triangle_pixels(corners, width=width, height=height)
    expected = plain.triangle_pixels(corners, width, height)
    return as_array(listed(*found)), as_array(expected)


def drawn_mesh(draw: Draw, attributes: int) -> raster.Mesh:
    """Draw up to three triangles over up to five corners."""
    points = np.array(draw(st.lists(places, min_size=3, max_size=5)))
    corner = st.integers(0, len(points) - 1)
    faces = draw(st.lists(st.tuples(corner, corner, corner), max_size=3))
    numbers = st.floats(-4.0, 4.0)
    values = draw(arrays(np.float64, (len(points), attributes), elements=numbers))
    return raster.Mesh(points, np.array(faces, int).reshape(-1, 3), values)


def as_plain_mesh(mesh: raster.Mesh) -> plain.Mesh:
    lists = mesh.points, mesh.faces, mesh.attributes
    return plain.Mesh(*(part.tolist() for part in lists))


def assume_plain_cuts(camera, mesh: raster.Mesh, near: float, far) -> None:
    """Leave out meshes of which a cut end may fall to either side of a sub-pixel."""
    assume_plain_places(camera, mesh.points, near)
    planes = window.planes_of(camera, near, far)
    there = window.to_camera(camera, mesh.points)
    cut, faces, _ = clipping.clip(there.T, mesh.faces.T, planes)
    if not faces.size:
        return
    used = cut[:, np.unique(faces)].T
    scale = window.scale_of(camera)
    if isinstance(camera, Camera):
        scale = scale / np.maximum(used[:, 2:], near)
    middle = 0.5 * np.array([camera.width, camera.height])
    place = 256.0 * (middle + scale * used[:, :2] * [1.0, -1.0])
    assume((np.abs(place % 1.0 - 0.5) > 1e-5).all())
    assume(far is None or (np.abs(there[:, 2] - far) > 1e-9).all())


@twin(
    raster.draw_triangles,
    plain.draw_triangles,
    tolerance=1e-8,
    why="slivers: pixels at 1e-4 of a triangle whose depths differ by 1e4",
)
def draw_triangles(draw: Draw):
    camera, near = drawn_camera(draw), draw(nears)
    far = draw(st.sampled_from([8.0, 20.0]) | st.none())
    mesh, cull = drawn_mesh(draw, 3), draw(culls)
    state, plainly = drawn_state(draw, 4)
    if far is None and not isinstance(camera, Camera):
        far = 50.0
    assume_plain_cuts(camera, mesh, near, far)
    size = camera.width, camera.height
    buffer = raster.framebuffer(*size, color=[0.1, 0.2, 0.3, 0.4], depth=0.75)
    expected = buffer.pixels.tolist()
    depths = np.full((camera.height, camera.width), 0.75).tolist()
    texture, plain_one = drawn_texture(draw)
    textured = draw(st.booleans()) and "MIPMAP" not in texture.min_filter

    def shade(fragments: raster.Fragments) -> np.ndarray:
        values = fragments.values
        if textured:
            assume_clear(texture, values.T)
            found = raster.sample(texture, values.T)[:, :1]
            return found * [1.0, 0.5, 0.0, 0.0] + [0.0, 0.0, 0.0, 1.0]
        return np.stack([*values, 1.0 / fragments.away], axis=-1)

    def plain_shade(values: list[float], depth: float) -> list[float]:
        if textured:
            found = plain_texture.sample(plain_one, values)[0]
            return [found, 0.5 * found, 0.0, 1.0]
        return [*values, 1.0 / depth]

    how = {"state": state, "cull": cull, "near": near, "far": far}
    raster.draw_triangles(buffer, camera, mesh, shade, **how)
    plain.draw_triangles(
        expected,
        depths,
        as_plain(camera),
        as_plain_mesh(mesh),
        plain_shade,
        plainly,
        near,
        far,
        cull,
    )
    assert buffer.depth is not None
    found = np.concatenate([buffer.pixels, buffer.depth[..., None]], axis=2)
    expected = np.concatenate([expected, np.array(depths)[..., None]], axis=2)
    return found, expected
