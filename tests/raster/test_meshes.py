"""Meshes: closed, turned outward, without triangles of no area."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from refcloud.raster import Mesh, dome_mesh, plane_mesh, sphere_mesh

counts = st.integers(3, 12)


def outward(mesh: Mesh) -> np.ndarray:
    a, b, c = (mesh.points[mesh.faces[:, k]] for k in range(3))
    return np.cross(b - a, c - a)


def open_edges(mesh: Mesh) -> int:
    """Count edges of one triangle only; corners at one place are one."""
    _, same = np.unique(mesh.points.round(12) + 0.0, axis=0, return_inverse=True)
    faces = same.ravel()[mesh.faces]
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    there = set(map(tuple, edges.tolist()))
    assert len(there) == len(edges), "an edge that two triangles run the same way"
    return sum((b, a) not in there for a, b in there)


@given(counts, st.integers(2, 9), st.floats(0.1, 10.0))
def test_a_sphere_is_closed_and_looks_outward(columns, rows, radius) -> None:
    mesh = sphere_mesh(columns, rows, radius=radius)
    assert len(mesh.faces) == 2 * columns * (rows - 1)
    assert open_edges(mesh) == 0
    centre = mesh.points[mesh.faces].mean(axis=1)
    assert (np.einsum("ij,ij->i", outward(mesh), centre) > 0.0).all()
    np.testing.assert_allclose(np.linalg.norm(mesh.points, axis=1), radius)
    assert mesh.attributes.min() >= 0.0
    assert mesh.attributes.max() <= 1.0


@given(counts, st.integers(1, 9))
def test_f16_a_dome_ends_at_the_horizon(columns, rows) -> None:
    mesh = dome_mesh(columns, rows)
    assert len(mesh.faces) == columns * (2 * rows - 1)
    assert open_edges(mesh) == columns
    assert (outward(mesh)[:, 1] >= -1e-12).all()
    horizon = mesh.points[:, 1] == 0.0
    assert horizon.sum() == columns + 1
    reach = np.linalg.norm(mesh.attributes - 0.5, axis=1)
    np.testing.assert_allclose(reach[horizon], 0.5)
    # As far from the middle of the texture as from the zenith, along the sphere.
    angle = np.arccos(np.clip(mesh.points[:, 1], -1.0, 1.0))
    np.testing.assert_allclose(reach, angle / np.pi, atol=1e-7)


def test_f17_a_plane_is_level_and_looks_up() -> None:
    mesh = plane_mesh(3, 2, width=6.0, depth=4.0, height=1.5)
    np.testing.assert_allclose(outward(mesh), np.broadcast_to([0, 4, 0], (12, 3)))
    assert open_edges(mesh) == 2 * (3 + 2)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: Mesh(np.zeros((3, 2)), []), r"points: expected an array of shape"),
        (lambda: Mesh([[np.nan] * 3], []), "points: expected finite numbers"),
        (lambda: Mesh(np.zeros((3, 3)), [[0, 1]]), "faces: expected whole numbers"),
        (lambda: Mesh(np.zeros((3, 3)), [[0, 1, 3]]), "faces: expected indices"),
        (lambda: Mesh(np.zeros((3, 3)), [[0.0, 1, 2]]), "faces: expected whole"),
        (
            lambda: Mesh(np.zeros((3, 3)), [[0, 1, 2]], np.zeros((2, 1))),
            r"attributes: expected an array of shape \(3, K\)",
        ),
        (
            lambda: Mesh(np.zeros((3, 3)), np.broadcast_to(0, (17_000_000, 3))),
            "faces: expected at most 16000000 triangles",
        ),
        (lambda: sphere_mesh(8, 1), "rows: expected at least 2"),
        (lambda: dome_mesh(2, 4), "columns: expected a whole number"),
    ],
)
def test_refusals_name_the_argument_in_one_line(call, message: str) -> None:
    with pytest.raises((ValueError, TypeError), match=rf"^{message}[^\n]*$"):
        call()
