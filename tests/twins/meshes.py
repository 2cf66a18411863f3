"""Meshes beside their plain twins."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

from refcloud import raster
from refcloud.plain import meshes as plain
from twins import Draw, twin

WITHOUT: dict[str, str] = {}

counts, rings = st.integers(3, 9), st.integers(2, 6)
lengths = st.floats(0.1, 10.0)
SAME = "the same sines, which libraries round apart by a last bit"


def rows(mesh) -> np.ndarray:
    """Put all that a mesh holds into one array."""
    parts = mesh.points, mesh.faces, mesh.attributes
    return np.concatenate([np.asarray(p, np.float64).ravel() for p in parts])


@twin(raster.sphere_mesh, plain.sphere_mesh, tolerance=1e-14, why=SAME)
def sphere_mesh(draw: Draw):
    columns, count, radius = draw(counts), draw(rings), draw(lengths)
    found = raster.sphere_mesh(columns, count, radius=radius)
    return rows(found), rows(plain.sphere_mesh(columns, count, radius))


@twin(raster.dome_mesh, plain.dome_mesh, tolerance=1e-14, why=SAME)
def dome_mesh(draw: Draw):
    columns, count, radius = draw(counts), draw(st.integers(1, 6)), draw(lengths)
    found = raster.dome_mesh(columns, count, radius=radius)
    return rows(found), rows(plain.dome_mesh(columns, count, radius))


@twin(raster.plane_mesh, plain.plane_mesh, tolerance=1e-14, why="the same products")
def plane_mesh(draw: Draw):
    columns, count = draw(st.integers(1, 5)), draw(st.integers(1, 5))
    width, depth, height = draw(lengths), draw(lengths), draw(st.floats(-9.0, 9.0))
    how = {"width": width, "depth": depth, "height": height}
    found = raster.plane_mesh(columns, count, **how)
    return rows(found), rows(plain.plane_mesh(columns, count, **how))
