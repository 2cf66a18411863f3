"""The density of all balls: additive, anchored to the balls, the same on a grid."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from twins.metaballs import as_metaballs, balls_drawn, kernels, places

from refcloud.cloudmap.voxels import VoxelGrid, cell_centres
from refcloud.metaballs import Metaballs, field, field_grid, placed, voxel_balls

points_drawn = st.lists(places, min_size=1, max_size=5).map(np.array)
# Worst seen 2.4e-15 between sums in two orders, times 10; the densities reach 25.
CLOSE = {"rtol": 0.0, "atol": 1e-12}


@given(first=balls_drawn, second=balls_drawn, points=points_drawn, kernel=kernels)
def test_densities_add(first, second, points, kernel):
    together = field(as_metaballs(first + second, kernel), points)
    apart = [field(as_metaballs(part, kernel), points) for part in (first, second)]
    np.testing.assert_allclose(together, sum(apart), **CLOSE)


@given(
    balls=balls_drawn, points=points_drawn, whole=st.tuples(*[st.integers(-8, 8)] * 3)
)
def test_the_field_moves_with_the_balls(balls, points, whole):
    # Sums of halves and small whole numbers are exact: the distances stay the same.
    points = np.round(points * 8) / 8
    balls = [(np.round(np.array(c) * 8) / 8, R, v) for c, R, v in balls]
    cloud = as_metaballs(balls)
    moved = placed(cloud, np.array(whole, float))
    np.testing.assert_array_equal(
        field(moved, points + np.array(whole, float)), field(cloud, points)
    )


@given(balls=balls_drawn, kernel=kernels)
def test_the_grid_equals_the_points(balls, kernel):
    x, y, z = np.arange(-3.0, 4.0), np.arange(-2.0, 3.0) * 0.7, np.array([0.1])
    cloud = as_metaballs(balls, kernel)
    k, j, i = np.meshgrid(z, y, x, indexing="ij")
    expected = field(cloud, np.stack([i, j, k], axis=-1))
    np.testing.assert_allclose(field_grid(cloud, x, y=y, z=z), expected, **CLOSE)


def test_no_balls_no_density():
    nothing = Metaballs(np.zeros((0, 3)), np.zeros(0), np.zeros(0))
    assert len(nothing) == 0
    assert field(nothing, np.zeros((2, 3, 3))).tolist() == [[0.0] * 3] * 2
    assert not field_grid(nothing, [0.0], y=[0.0], z=[0.0]).any()


def test_any_finite_place_and_size_work():
    cloud = Metaballs([[1e300, 0, 0], [0, 0, 0]], [1e-300, 1e300], [1.0, 2.0])
    found = field(cloud, [[-1.7e308, 1.7e308, 0.0], [1e300, 0.0, 0.0], [0.0, 0.0, 0.0]])
    assert found.tolist() == [0.0, 1.0, 2.0]
    assert field_grid(cloud, [0.0, 1e300], y=[0.0], z=[0.0]).tolist() == [[[2.0, 1.0]]]


def test_coordinates_that_do_not_ascend_are_refused():
    cloud = Metaballs([[0, 0, 0]], [1], [1])
    with pytest.raises(ValueError, match="y: expected ascending"):
        field_grid(cloud, [0.0], y=[1.0, 1.0], z=[0.0])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (([[0, 0]], [1], [1]), r"centers: expected an array of shape \(N, 3\)"),
        (([[0, 0, 0]], [1, 2], [1]), r"radii: expected an array of shape \(N,\)"),
        (([[0, 0, 0]], [-1], [1]), "radii: expected numbers in"),
        (([[0, 0, 0]], [0], [1]), "radii: expected numbers in"),
        (([[0, 0, 0]], [1], [-1]), "densities: expected numbers in"),
        (([[0, np.nan, 0]], [1], [1]), "centers: expected finite numbers"),
        (([[0, 0, 0]], [1], [1], "blob"), "kernel: expected one of"),
    ],
)
def test_balls_that_cannot_be_are_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        Metaballs(*arguments)


@pytest.mark.parametrize("kernel", ["wyvill", "gaussian"])
@pytest.mark.parametrize("cell", [(1.0, 1.0, 1.0), (0.5, 2.0, 1.5)])
def test_voxel_balls_hold_the_mass_of_the_cloud(kernel, cell):
    density = np.zeros((5, 5, 5))
    density[2, 2, 2], density[2, 2, 3] = 0.7, 0.2
    grid = VoxelGrid(density, [0, 0, 0], 5 * np.array(cell))
    balls = voxel_balls(grid, kernel=kernel)
    x, _, z = cell_centres(grid)
    assert balls.centers[0].tolist() == [x[2], 2.5 * cell[1], z[2]]
    # A fine sum over a box that holds both balls: the Gaussian's rim costs it most.
    step = 0.06
    axes = [np.arange(-1.5, 11.5, step) for _ in range(3)]
    total = field_grid(balls, axes[0], y=axes[1], z=axes[2]).sum() * step**3
    assert total == pytest.approx(0.9 * np.prod(cell), rel=5e-3)
