"""The cloud map of balls: their own density at the centres of voxels."""

from __future__ import annotations

import numpy as np
import pytest

from refcloud.cloudmap import cell_size
from refcloud.metaballs import Metaballs, field, sampled_map

BALLS = Metaballs([[0.0, 0, 0], [3.0, 1, 0], [1.0, 0, 2]], [1.0, 2.0, 1.5], [1, 2, 3])


def test_each_voxel_holds_the_density_at_its_centre() -> None:
    grid = sampled_map(BALLS)
    z, y, x = np.indices(grid.density.shape) + 0.5
    centres = grid.lower + np.stack([x, y, z], axis=-1) * cell_size(grid)
    np.testing.assert_allclose(grid.density, field(BALLS, centres), atol=1e-14)
    np.testing.assert_allclose(cell_size(grid), 0.75)  # half the median radius


@pytest.mark.parametrize("most", [1, 5, 64])
def test_the_box_holds_every_ball_in_no_more_voxels_than_allowed(most: int) -> None:
    grid = sampled_map(BALLS, most=most)
    assert max(grid.density.shape) <= most
    reach = BALLS.radii[:, None]
    assert (grid.lower <= (BALLS.centers - reach).min(axis=0)).all()
    assert (grid.upper >= (BALLS.centers + reach).max(axis=0) - 1e-9).all()


def test_no_balls_are_one_empty_voxel() -> None:
    grid = sampled_map(Metaballs(np.zeros((0, 3)), [], []))
    assert grid.density.tolist() == [[[0.0]]]


def test_a_cloud_without_end_is_refused() -> None:
    far = Metaballs([[-1.7e308, 0, 0], [1.7e308, 0, 0]], [1.0, 1.0], [1.0, 1.0])
    with pytest.raises(ValueError, match=r"^balls: expected a cloud whose width"):
        sampled_map(far)
