"""The quad that a cloud is drawn on beside its plain twins."""

from __future__ import annotations

from hypothesis import strategies as st

from refcloud import raster
from refcloud.plain import quad as plain
from twins import Draw, twin
from twins.camera import STEEP, as_plain, drawn_camera

WITHOUT: dict[str, str] = {}

distances = st.floats(0.1, 10.0)


@twin(raster.quad_corners, plain.quad_corners, tolerance=1e-12, why=STEEP)
def quad_corners(draw: Draw):
    camera, distance = drawn_camera(draw), draw(distances)
    expected = plain.quad_corners(as_plain(camera), distance)
    return raster.quad_corners(camera, distance), expected


@twin(raster.quad_points, plain.quad_points, tolerance=1e-12, why=STEEP)
def quad_points(draw: Draw):
    camera, distance = drawn_camera(draw), draw(distances)
    expected = [
        [
            plain.quad_points(as_plain(camera), distance, i, j)
            for i in range(camera.width)
        ]
        for j in range(camera.height)
    ]
    return raster.quad_points(camera, distance), expected
