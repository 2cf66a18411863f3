"""Column densities to the sun: against the exact integral, and by laws."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from smooth_clouds import cloud
from twins.cloudmap import grids
from twins.transport import directions

from refcloud.cloudmap import VoxelGrid
from refcloud.transport import column_density, sun_depths
from refcloud.transport.literal import sheared_depths_literal
from refcloud.transport.sheared import sheared_depths
from refcloud.transport.sun import STRAIGHT, kept_volume

SUNS = [
    *[(0.3, 0.7, 0.5), (0.9, -0.2, 0.4), (-0.5, -0.3, -0.8), (1, 1, 1), (-1, 0, 1)],
    *[(1, 0, 0), (0, -1, 0), (0, 0, 1), (0.05, 1, -0.02)],
]
scales = st.sampled_from([1, 2])


def samples_of(grid: VoxelGrid, scale: int, cells: np.ndarray) -> np.ndarray:
    """Give where samples [z, y, x] of a light volume lie."""
    counts = scale * np.array(grid.density.shape[::-1])
    return grid.lower + (cells[:, ::-1] + 0.5) * (grid.upper - grid.lower) / counts


def exact(grid: VoxelGrid, sun, scale: int = 1) -> np.ndarray:
    shape = tuple(scale * n for n in grid.density.shape)
    cells = np.indices(shape).reshape(3, -1).T
    return column_density(grid, samples_of(grid, scale, cells), sun).reshape(shape)


def distance(grid: VoxelGrid, sun, scale: int, every: int) -> float:
    """Give the relative root mean square error at samples where there is cloud."""
    occupied = np.argwhere(grid.density > 0.0)[::every]
    cells = scale * occupied + np.arange(len(occupied))[:, None] % scale
    expected = column_density(grid, samples_of(grid, scale, cells), sun)
    found = sun_depths(grid, sun, scale=scale).density[tuple(cells.T)]
    return float(
        np.sqrt(np.square(found - expected).mean() / np.square(expected).mean())
    )


@pytest.mark.parametrize("sun", SUNS)
# Worst seen .0035 (almost on an axis) and .0016 (on the diagonal), times 1.4.
@pytest.mark.parametrize(("scale", "most"), [(1, 5e-3), (2, 2.2e-3)])
def test_close_to_the_exact_integral_where_there_is_cloud(sun, scale, most) -> None:
    assert distance(cloud(), sun, scale, every=7) < most


def test_error_at_128_voxels() -> None:
    grid = cloud(128)
    # Issue 6 asks for .0011. Seen: .0005 and .0002.
    assert distance(grid, SUNS[0], 1, every=300) < 8e-4
    assert distance(grid, SUNS[0], 2, every=300) < 3e-4


@pytest.mark.parametrize("sun", [(1, 0, 0), (0, -1, 0), (0, 0, 1)])
@given(grids())
def test_exact_along_an_axis(sun, grid) -> None:
    # Nothing moves across the slices: the trapezoid rule on a field made of lines.
    found = sun_depths(grid, sun).density
    np.testing.assert_allclose(found, exact(grid, sun), rtol=0.0, atol=1e-13)


@given(grids(), directions, scales)
@settings(max_examples=50)
def test_near_the_exact_integral_in_boxes_filled_to_the_border(
    grid, sun, scale
) -> None:
    # Boxes of up to four cells, densities of up to 2 beside 0: nothing is resolved.
    # Worst seen .34 of a cell's diagonal in 600 examples, times 1.8.
    found, expected = (
        sun_depths(grid, sun, scale=scale).density,
        exact(grid, sun, scale),
    )
    cell = np.linalg.norm((grid.upper - grid.lower) / grid.density.shape[::-1])
    assert np.abs(found - expected).max() <= 0.6 * cell


@pytest.mark.parametrize("sun", SUNS)
def test_a_homogeneous_box_is_its_length_toward_the_sun(sun) -> None:
    grid = VoxelGrid(np.full((12, 10, 14), 0.7), [0, 0, 0], [1.4, 1.0, 1.2])
    error = sun_depths(grid, sun).density - exact(grid, sun)
    # Only beside the edges of the box, where the length bends: seen .054 and .0085.
    assert np.abs(error).max() < 0.08
    assert np.sqrt(np.square(error).mean()) < 0.013


@given(grids(), directions, scales)
def test_never_negative_and_nothing_above_the_sunward_face(grid, sun, scale) -> None:
    found = sun_depths(grid, sun, scale=scale).density
    assert (found >= 0.0).all()
    assert not sun_depths(
        VoxelGrid(0.0 * grid.density, grid.lower, grid.upper), sun, scale=scale
    ).density.any()


@given(grids(), directions, scales, st.integers(-60, 60))
@settings(max_examples=40)
def test_linear_in_density_and_in_the_size_of_the_box(grid, sun, scale, power) -> None:
    factor = 2.0**power  # exact, so that no slope rounds
    found = sun_depths(grid, sun, scale=scale).density
    denser = VoxelGrid(factor * grid.density, grid.lower, grid.upper)
    larger = VoxelGrid(grid.density, factor * grid.lower, factor * grid.upper)
    for other in (denser, larger):
        scaled = sun_depths(other, sun, scale=scale).density
        np.testing.assert_allclose(scaled, factor * found, rtol=1e-13)


@given(grids(), directions, scales, st.permutations(range(3)), st.integers(0, 7))
@settings(max_examples=50)
def test_turning_grid_and_sun_together_changes_nothing(
    grid, sun, scale, order, flips
) -> None:
    flip = [1 - 2 * (flips >> axis & 1) for axis in range(3)]
    half = 0.5 * (grid.upper - grid.lower)
    density = np.pad(grid.density, 1)  # at filled edges v and u are not alike

    def turn(values):
        backward = tuple(slice(None, None, step) for step in flip[::-1])
        return values[backward].transpose([2 - axis for axis in order[::-1]])

    moved = (np.array(sun) * flip)[order]
    cells = np.abs(np.array(sun) * density.shape[::-1] / half)
    assume(np.diff(np.sort(cells))[-1] > 1e-9)  # else another axis may be the main one
    found = sun_depths(
        VoxelGrid(turn(density), -half[order], half[order]), moved, scale=scale
    )
    expected = sun_depths(VoxelGrid(density, -half, half), sun, scale=scale)
    np.testing.assert_allclose(found.density, turn(expected.density), atol=1e-11)


@given(grids(), directions)
def test_single_precision(grid, sun) -> None:
    volume = sun_depths(grid, sun, dtype="float32")
    assert volume.density.dtype == np.float32
    expected = sun_depths(grid, sun).density
    scale = max(float(expected.max()), 1e-30)
    # Worst seen 5e-7, times 6.
    np.testing.assert_allclose(volume.density, expected, rtol=0.0, atol=3e-6 * scale)


def test_a_box_far_away() -> None:
    near, far = cloud(16), cloud(16)
    far = VoxelGrid(near.density, near.lower + 1e6, near.upper + 1e6)
    found, expected = (sun_depths(g, SUNS[0]).density for g in (far, near))
    # Cells of 1/8 at 1e6 are known to 1e-9 of themselves.
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-8)


@pytest.mark.parametrize("dtype", ["float32", "float64"])
@pytest.mark.parametrize("peak", [0.0, 5e-324, 1e-300, 1e30, 1e300])
@pytest.mark.parametrize("edge", [1e-300, 1.0, 1e300])
def test_every_magnitude_gives_finite_depths(dtype, peak, edge) -> None:
    density = peak * np.indices((3, 4, 5)).sum(axis=0) / 9.0
    grid = VoxelGrid(density, [0, 0, 0], [edge, 2.0 * edge, edge])
    volume = sun_depths(grid, [0.3, 0.5, 0.4], dtype=dtype)
    assert np.isfinite(volume.density).all()
    least = math.log10(np.finfo(dtype).tiny)
    seen = peak > 0.0 and math.log10(peak) + math.log10(edge) > least
    assert volume.density.any() == seen


def test_flat_boxes() -> None:
    grid = VoxelGrid(np.ones((2, 2, 2)), [0, 0, 0], [1e200, 1e-200, 1.0])
    assert np.isfinite(sun_depths(grid, [1, 1, 1]).density).all()
    assert np.isfinite(sun_depths(grid, [1, 0, 0]).density).all()


def test_one_voxel() -> None:
    grid = VoxelGrid([[[2.0]]], [0, 0, 0], [1, 1, 1])
    assert sun_depths(grid, [0, 3, 0]).density.item() == pytest.approx(1.0)
    assert sun_depths(grid, [1, 1, 1]).density.item() == pytest.approx(np.sqrt(3.0))


def test_a_direction_that_hardly_moves_along_an_axis() -> None:
    grid = VoxelGrid(np.ones((1, 1, 1)), [0, 0, 0], [1, 1, 1])
    points = [[1.125, 0.0, 0.0], [0.5, 0.5, 0.25]]  # beside the box, and in it
    found = column_density(grid, points, [-2.2250738585e-313, 0.0, 1.0])
    assert found.tolist() == [0.0, 0.75]


def test_too_many_samples_are_refused_in_one_line() -> None:
    grid = VoxelGrid(np.zeros((512, 512, 256)), [0, 0, 0], [1, 1, 1])
    with pytest.raises(ValueError, match=r"^scale: expected [^\n]*$"):
        sun_depths(grid, [0, 1, 0], scale=2)


def test_a_sun_without_direction_is_refused() -> None:
    with pytest.raises(ValueError, match=r"^direction: "):
        sun_depths(cloud(4), [0, 0, 0])


def test_a_light_volume_is_kept_while_grid_and_sun_stand_still() -> None:
    grid, other = cloud(8), cloud(8)
    volumes = [sun_depths(grid, sun) for sun in ([0, 1, 0], [1, 1, 0])]
    volumes.append(sun_depths(grid, [1, 1, 0], scale=2))
    for volume in volumes:
        sun = volume.direction
        assert kept_volume(volumes, grid, sun, volume.scale) is volume
        assert kept_volume(volumes, other, sun, volume.scale) is None
    assert kept_volume(volumes, grid, np.array([0.0, 0.0, 1.0]), 1) is None
    assert kept_volume(volumes, grid, np.array([0.0, 1.0, 0.0]), 2) is None
    with pytest.raises(ValueError, match="read-only"):
        volumes[0].density[0, 0, 0] = 1.0
    assert repr(volumes[0]) == "LightVolume(shape (8, 8, 8), float64, sun 0 1 0)"


slopes = st.floats(0.0, 1.0).map(lambda slope: slope if slope > STRAIGHT else 0.0)


@given(grids(), slopes, slopes, scales)
@settings(max_examples=40)
def test_the_form_on_flat_memory_equals_the_literal_one(grid, v, u, scale) -> None:
    how = {"length": 0.7, "scale": scale}
    for slabs in (grid.density, np.pad(grid.density, 2)):
        found = np.empty(tuple(scale * n for n in slabs.shape))
        sheared_depths(slabs, (v, u), out=found, **how)
        expected = sheared_depths_literal(slabs, (v, u), **how)
        # Worst seen 1e-15 in 600 examples: the same sums in another order.
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=5e-14)
