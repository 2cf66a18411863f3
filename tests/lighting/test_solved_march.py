"""Cloud maps marched in equal steps under solved light."""

from __future__ import annotations

import numpy as np
import pytest
from small_lights import BALL, FORWARD, SUN

from refcloud.camera import Camera, OrthographicCamera, rays
from refcloud.cloudmap import VoxelGrid
from refcloud.lighting import block_means, solved_march
from refcloud.march import integrate
from refcloud.optics import Medium
from refcloud.transport import Plan, Stage, scattered_light

EYE = Camera([0.8, 0.6, 4.0], [0.5, 0.5, 0.5], fov_y=0.35, width=16, height=12)
TIGHT = Plan((Stage(26, 0, 500, 1e-7),), double=True)


def test_it_shows_what_the_exact_march_shows() -> None:
    light = scattered_light(BALL, SUN, medium=FORWARD, plan=TIGHT)
    L, T, _ = solved_march(BALL, EYE, light=light, step=0.005)
    how = {"suns": SUN, "medium": FORWARD, "scattering": light}
    exact, through = integrate(BALL, *(v.reshape(-1, 3) for v in rays(EYE)), **how)
    # Samples of sunlight lie a voxel apart, and steps start anywhere: seen .008.
    np.testing.assert_allclose(L.reshape(-1, 3), exact, atol=0.02 * exact.max())
    kept = FORWARD.sigma_t / light.sigma_t[0]
    np.testing.assert_allclose(T.ravel() ** kept, np.ravel(through), atol=0.01)


@pytest.mark.parametrize("camera", [EYE, OrthographicCamera([0, 0, 9], [0, 0, 0])])
def test_a_white_furnace_is_invisible_on_a_coarser_map(camera) -> None:
    white = np.ones(3)
    how = {"medium": Medium(9.0), "sky": white, "ground": white, "plan": TIGHT}
    light = scattered_light(block_means(BALL, most=8), (), **how)
    L, T, _ = solved_march(BALL, camera, light=light, step=0.05)
    np.testing.assert_allclose(L[..., 0] + T, 1.0, atol=1e-5)


@pytest.mark.parametrize("most", [1, 3, 5, 7, 64])
def test_means_keep_the_mass_and_the_lower_corner(most: int) -> None:
    grid = VoxelGrid(np.arange(210.0).reshape(5, 6, 7), [1, 2, 3], [8, 8, 8])
    coarse = block_means(grid, most=most)
    assert max(coarse.density.shape) <= most
    volume = [(g.upper - g.lower).prod() / g.density.size for g in (coarse, grid)]
    mass = [v * g.density.sum() for v, g in zip(volume, (coarse, grid), strict=True)]
    assert mass[0] == pytest.approx(mass[1])
    assert coarse.lower.tolist() == grid.lower.tolist()


def test_what_it_does_not_model_is_refused() -> None:
    light = scattered_light(BALL, SUN, medium=Medium([1.0, 2, 3]), plan="quick")
    with pytest.raises(ValueError, match=r"^light: expected light in a medium"):
        solved_march(BALL, EYE, light=light, step=0.1)
