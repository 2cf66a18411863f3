"""Lines and the box around a cloud beside their plain twins."""

from __future__ import annotations

import numpy as np
from hypothesis import assume
from hypothesis import strategies as st

from refcloud import raster
from refcloud.camera import Camera, project
from refcloud.cloudmap import box_corners, box_triangles
from refcloud.plain import walls as plain
from refcloud.raster import window
from twins import Draw, twin
from twins.box import drawn_box
from twins.camera import as_plain, drawn_camera, places

WITHOUT: dict[str, str] = {}

# Halves, quarters and 256ths of a pixel are the places where rules decide.
place = st.integers(-3 * 256, 10 * 256).map(lambda n: n / 256.0)
place |= st.integers(-6, 20).map(lambda n: 0.5 * n) | st.floats(-4.0, 12.0)
spots = st.tuples(place, place)
sizes = st.integers(1, 8)
thicknesses = st.sampled_from([1, 1, 2, 3])
nears = st.sampled_from([1e-3, 0.5, 4.0])
channel = st.floats(0.0, 1.0)
colours = st.tuples(channel, channel, channel, channel)
WHOLE = "whole numbers, then the same products"


def listed(rows: np.ndarray, columns: np.ndarray) -> list:
    return sorted(zip(rows.tolist(), columns.tolist(), strict=True))


def as_array(pixels: list) -> np.ndarray:
    return np.array(pixels, np.float64).reshape(-1, 2)


def assume_plain_places(camera, points: np.ndarray, near: float) -> None:
    """Leave out places that a last bit moves to another sub-pixel or across a plane."""
    there = window.to_camera(camera, points)
    planes = window.planes_of(camera, near)
    inside = there @ planes[:, :3].T + planes[:, 3]
    assume((np.abs(inside) > 1e-9).all())
    x, y, depth, _ = project(camera, points.reshape(-1, 3))
    seen = 256.0 * np.stack([x, y])[:, depth > near]
    assume((np.abs(seen % 1.0 - 0.5) > 1e-6).all())


@twin(raster.line_pixels, plain.line_pixels, tolerance=0.0, why=WHOLE)
def line_pixels(draw: Draw):
    start, end, size = draw(spots), draw(spots), (draw(sizes), draw(sizes))
    thickness = draw(thicknesses)
    width, height = size
    found = raster.line_pixels(
        start, end, width=width, height=height, thickness=thickness
    )
    expected = plain.line_pixels(start, end, width, height, thickness)
    return as_array(listed(*found)), as_array(expected)


def _buffers(camera) -> tuple[raster.Framebuffer, list]:
    count = np.arange(camera.height * camera.width * 4.0)
    pixels = (count * 2.0**0.5 % 1.0).reshape(camera.height, camera.width, 4)
    return raster.Framebuffer(pixels), pixels.tolist()


@twin(raster.draw_lines, plain.draw_lines, tolerance=1e-15, why=WHOLE)
def draw_lines(draw: Draw):
    camera, near = drawn_camera(draw), draw(nears)
    ends = np.array(draw(st.lists(st.tuples(places, places), max_size=3)))
    ends = ends.reshape(-1, 2, 3)
    assume_plain_places(camera, ends, near)
    (buffer, expected), color = _buffers(camera), draw(colours)
    thickness = draw(thicknesses)
    how = {"thickness": thickness, "near": near}
    raster.draw_lines(buffer, camera, ends, color=color, **how)
    plain.draw_lines(expected, as_plain(camera), ends.tolist(), color, thickness, near)
    return buffer.pixels, expected


@twin(raster.faces_away, plain.faces_away, tolerance=0.0, why="a sign")
def faces_away(draw: Draw):
    camera = drawn_camera(draw)
    corners = np.array(draw(st.lists(st.tuples(places, places, places), max_size=3)))
    corners = corners.reshape(-1, 3, 3)
    expected = [plain.faces_away(as_plain(camera), c) for c in corners.tolist()]
    _assume_plain_sides(camera, corners)
    return raster.faces_away(camera, corners), expected


def _assume_plain_sides(camera, corners: np.ndarray) -> None:
    """Leave out triangles that are seen edge on."""
    there = window.to_camera(camera, corners)
    if not isinstance(camera, Camera):  # the corners' shadow on the picture
        there = np.concatenate([there[..., :2], np.ones_like(there[..., :1])], axis=-1)
    volume = np.linalg.det(there)
    assume((np.abs(volume) > 1e-6).all())


@twin(raster.draw_box, plain.draw_box, tolerance=1e-15, why=WHOLE)
def draw_box(draw: Draw):
    camera, near, box = drawn_camera(draw), draw(nears), drawn_box(draw)
    assume_plain_places(camera, box_corners(*box), near)
    _assume_plain_sides(camera, box_triangles(*box))
    (buffer, expected), line, wall = _buffers(camera), draw(colours), draw(colours)
    part, thickness = draw(st.sampled_from(["behind", "before"])), draw(thicknesses)
    raster.draw_box(
        buffer,
        camera,
        *box,
        part,
        line_color=line,
        wall_color=wall,
        thickness=thickness,
        near=near,
    )
    plain_box = [corner.tolist() for corner in box]
    plain.draw_box(
        expected, as_plain(camera), *plain_box, part, line, wall, thickness, near
    )
    return buffer.pixels, expected
