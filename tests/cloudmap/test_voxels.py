"""The grid, its cells, and what is read between their centres."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from twins.cloudmap import grids, places

from refcloud.cloudmap import VoxelGrid, cell_centres, cell_size, trilinear

shares = st.lists(st.tuples(*[st.floats(0.0, 1.0)] * 3), min_size=1, max_size=6)
BOX = {"density": np.ones((1, 1, 1)), "lower": [0, 0, 0], "upper": [1, 1, 1]}


def within(grid: VoxelGrid, places_: list) -> np.ndarray:
    """Give places of the box, from shares of its edges; rounding never leaves it."""
    points = grid.lower + np.array(places_) * (grid.upper - grid.lower)
    return np.clip(points, grid.lower, grid.upper)


@given(grids())
def test_cells_fill_the_box_and_centres_lie_in_their_middles(grid) -> None:
    size, centres = cell_size(grid), cell_centres(grid)
    counts = grid.density.shape[::-1]
    for axis in range(3):
        assert len(centres[axis]) == counts[axis]
        edges = centres[axis] - 0.5 * size[axis]
        expected = np.linspace(grid.lower[axis], grid.upper[axis], counts[axis] + 1)
        np.testing.assert_allclose(edges, expected[:-1], rtol=0.0, atol=1e-14)


@given(grids())
def test_at_the_centres_the_values_are_read(grid) -> None:
    x, y, z = cell_centres(grid)
    points = np.stack(np.broadcast_arrays(*np.ix_(z, y, x))[::-1], axis=-1)
    # A place is known to 1e-14 of a cell, next to values of up to 2.
    np.testing.assert_allclose(trilinear(grid, points), grid.density, atol=1e-12)


@given(grids(), shares)
def test_between_them_nothing_is_added(grid, inside) -> None:
    found = trilinear(grid, within(grid, inside))
    assert (found >= grid.density.min() - 1e-15).all()
    assert (found <= grid.density.max() + 1e-15).all()


@given(grids(), shares, places, st.floats(6.0, 9.0))
def test_linear_densities_are_read_exactly(grid, inside, slope, level) -> None:
    slope = 0.1 * np.array(slope)
    x, y, z = cell_centres(grid)
    values = level + z[:, None, None] * slope[2] + y[:, None] * slope[1] + x * slope[0]
    linear = VoxelGrid(values, grid.lower, grid.upper)
    first, last = (np.array([c[end] for c in (x, y, z)]) for end in (0, -1))
    points = within(grid, inside)
    # Within half a cell of the border the outermost centres' values go on.
    expected = level + np.clip(points, first, last) @ slope
    np.testing.assert_allclose(trilinear(linear, points), expected, atol=1e-12)


@given(grids(), st.integers(0, 2), st.booleans(), st.floats(1e-9, 1e300))
def test_outside_the_box_there_is_nothing(grid, axis, above, far) -> None:
    point = 0.5 * (grid.lower + grid.upper)
    end = (grid.upper if above else grid.lower)[axis]
    point[axis] = end + math.copysign(far, above - 0.5)
    assert trilinear(grid, point) == 0.0


@given(grids())
def test_the_border_belongs_to_the_box(grid) -> None:
    found = trilinear(grid, np.array([grid.lower, grid.upper]))
    corners = grid.density[0, 0, 0], grid.density[-1, -1, -1]
    np.testing.assert_allclose(found, corners, atol=1e-14)


@pytest.mark.parametrize(
    ("given_", "name"),
    [
        ({"density": np.ones((1, 1))}, "density"),
        ({"density": np.ones((1, 0, 1))}, "density"),
        ({"density": -np.ones((1, 1, 1))}, "density"),
        ({"density": np.full((1, 1, 1), math.nan)}, "density"),
        ({"lower": [0, 2, 0]}, "upper"),
        ({"upper": [1, 0, 1]}, "upper"),
        ({"lower": [-1e308] * 3, "upper": [1e308] * 3}, "upper"),
        ({"lower": [0, 0]}, "lower"),
    ],
)
def test_refusals_name_the_field_in_one_line(given_, name: str) -> None:
    with pytest.raises(ValueError, match=rf"^{name}: expected [^\n]*$"):
        VoxelGrid(**(BOX | given_))


def test_a_grid_cannot_be_written_to() -> None:
    with pytest.raises(ValueError, match="read-only"):
        VoxelGrid(**BOX).density[0, 0, 0] = 2.0
