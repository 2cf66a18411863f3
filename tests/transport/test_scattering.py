"""Laws of light that is scattered again and again, on clouds of eight voxels' edge."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from small_lights import (
    FORWARD,
    SUN,
    cloud,
    leaving,
    radiance_of,
    source_of,
)

from refcloud.cloudmap import VoxelGrid
from refcloud.noise import uniform
from refcloud.optics import Medium, Sun
from refcloud.transport import (
    PLANS,
    Plan,
    Stage,
    cell_mean,
    folded_beams,
    harmonics,
    scattered_light,
    smooth_phase,
    source_toward,
)
from refcloud.transport.folded import passed_and_returned

COUNTS = [26, 50, 128]
MEDIA = [
    FORWARD,
    Medium(6.0, g=0.95, phase="hg"),
    Medium(6.0, g=-0.95, phase="hg"),
    Medium(6.0, phase="rayleigh"),
]
WHITE = np.ones(3)


def converged(count: int, residual: float = 1e-7) -> Plan:
    return Plan((Stage(count, 0, 500, residual),), double=True)


@pytest.mark.parametrize("medium", MEDIA, ids=lambda m: f"{m.phase} {m.g}")
@pytest.mark.parametrize("count", COUNTS)
def test_a_white_furnace_shows_nothing(count: int, medium: Medium) -> None:
    light = scattered_light(
        cloud(), (), medium=medium, sky=WHITE, ground=WHITE, plan=converged(count)
    )
    assert light.converged
    J = source_toward(light, [0.3, 0.2, -0.5])
    near = light.solutions[0].level.beams.near
    np.testing.assert_allclose(J[near], 1.0, rtol=0.0, atol=1e-5)  # worst seen 2e-7


@pytest.mark.parametrize("albedo", [1.0, 0.9, 0.0])
@pytest.mark.parametrize("count", COUNTS)
def test_what_leaves_and_what_is_absorbed_is_what_was_scattered(
    count: int, albedo: float
) -> None:
    medium = dataclasses.replace(FORWARD, albedo=albedo)
    light = scattered_light(cloud(), SUN, medium=medium, plan=converged(count))
    level = light.solutions[0].level
    W, share = level.directions.weights, float(level.scaled.albedo[0])
    _, I, extinction, cell = radiance_of(light)
    beam = level.sunlight[0, 0] * np.sqrt(4.0 * np.pi)  # irradiance in each voxel
    scattered = share * float((beam * extinction[level.beams.near]).sum())
    absorbed = (1.0 - share) * float((extinction * np.tensordot(W, I, 1)).sum())
    escaped = float(W @ leaving(light)) / cell.prod()
    # Worst seen 6e-8, the residual.
    assert escaped + absorbed == pytest.approx(scattered, rel=1e-4, abs=1e-12)


@pytest.mark.parametrize("count", COUNTS)
def test_a_turned_cloud_and_sun_give_turned_light(count: int) -> None:
    grid = cloud(shape=(8, 6, 8), seed=3)
    turned = VoxelGrid(np.rot90(grid.density, axes=(0, 2)), grid.lower, grid.upper)
    x, y, z = SUN.direction
    view = np.array([0.3, -0.4, 0.8])
    light = scattered_light(grid, SUN, medium=FORWARD, plan=converged(count))
    # Turning [z, x] by 90 degrees takes x to -z and z to x.
    after = scattered_light(
        turned, Sun([z, y, -x], SUN.irradiance), medium=FORWARD, plan=converged(count)
    )
    J = source_toward(light, view)
    expected = np.rot90(J, axes=(0, 2))
    found = source_toward(after, [view[2], view[1], -view[0]])
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-6 * J.max())


def test_suns_and_sky_add_up() -> None:
    grid, view = cloud(), [0.2, 0.5, 0.7]
    other = Sun([-0.4, 0.2, 0.9], [0.5, 2.0, 1.0])
    sky, ground = np.array([0.2, 0.3, 0.6]), np.array([0.1, 0.1, 0.0])
    medium = Medium(6.0, [1.0, 0.9, 0.8], 0.6, "hg")
    plan = converged(26)

    def lit(suns, sky=None, ground=None):
        how = {"medium": medium, "plan": plan, "sky": sky, "ground": ground}
        return source_toward(scattered_light(grid, suns, **how), view)

    together = lit((SUN, other), sky, ground)
    apart = lit(SUN) + lit(other) + lit((), sky) + lit((), None, ground)
    np.testing.assert_allclose(together, apart, atol=1e-5 * together.max())


def test_channels_are_solved_each_with_its_own_colour() -> None:
    grid, view = cloud(), [0.2, 0.5, 0.7]
    sun = Sun([0.5, 0.8, -0.3], [3.0, 2.0, 1.0])
    medium = Medium([6.0, 4.0, 6.0], [1.0, 1.0, 0.7], 0.6, "hg")
    whole = source_toward(
        scattered_light(grid, sun, medium=medium, plan=converged(26)), view
    )
    for c, (sigma_t, albedo) in enumerate(((6.0, 1.0), (4.0, 1.0), (6.0, 0.7))):
        grey = Medium(sigma_t, albedo, 0.6, "hg")
        alone = scattered_light(grid, sun, medium=grey, plan=converged(26))
        np.testing.assert_allclose(
            source_toward(alone, view)[..., c], whole[..., c], atol=1e-6 * whole.max()
        )


def test_a_grey_cloud_is_one_case_whatever_its_suns_colour() -> None:
    light = scattered_light(
        cloud(), Sun([1, 1, 0], [3.0, 2.0, 1.0]), medium=FORWARD, plan="quick"
    )
    assert len(light.solutions) == 1
    assert light.moments[0].shape[1] == 1
    assert [factor for _, _, factor in light.channels] == [3.0, 2.0, 1.0]


def test_an_albedo_of_zero_scatters_nothing() -> None:
    medium = dataclasses.replace(FORWARD, albedo=0.0)
    light = scattered_light(
        cloud(), SUN, medium=medium, sky=WHITE, ground=WHITE, plan="quick"
    )
    assert not source_toward(light, [0, 0, 1]).any()


def test_more_albedo_is_more_light() -> None:
    before = np.zeros(1)
    for albedo in (0.1, 0.5, 0.9, 0.99, 1.0):
        medium = Medium(6.0, albedo, phase="isotropic")
        light = scattered_light(cloud(), SUN, medium=medium, plan=converged(26))
        J = source_toward(light, [0, 0, 1])
        assert (J >= before - 1e-9).all()
        before = J


# Shares of diffuse light that pass a conservative slab, from its integral equation.
SLAB = {0.5: 0.70417, 1.0: 0.55341, 2.0: 0.39006, 5.0: 0.20766}


# 26 directions: too few cross a slab aslant; worst seen + 8.2 %.
@pytest.mark.parametrize(
    ("count", "most"),
    [(26, 0.09), (50, 0.015), pytest.param(128, 0.015, marks=pytest.mark.slow)],
)
@pytest.mark.parametrize("tau", SLAB)
def test_a_slab_lets_through_what_theory_says(
    tau: float, count: int, most: float
) -> None:
    H = 48  # voxels, and an empty one above and below; so wide that no side shows
    density = np.pad(np.ones((1, H, 1)), ((0, 0), (1, 1), (0, 0)))
    grid = VoxelGrid(density, [0, -1 / H, 0], [1e8, 1 + 1 / H, 1e8])
    light = scattered_light(
        grid,
        (),
        medium=Medium(tau, phase="isotropic"),
        sky=WHITE,
        plan=converged(count, 1e-5),
    )
    directions = light.solutions[0].level.directions
    rise = directions.vectors[:, 1]
    inflow = np.where(rise < -1e-12, 1.0, np.where(rise > 1e-12, 0.0, 0.5))
    _, I, _, _ = radiance_of(light, inflow)
    flux = directions.weights * np.abs(rise)
    down, up = rise < -1e-12, rise > 1e-12
    entering = flux[down].sum()
    passed = (flux[down] * I[down, 0, 0, 0]).sum() / entering
    back = (flux[up] * I[up, 0, -1, 0]).sum() / entering
    assert passed == pytest.approx(SLAB[tau], rel=most)
    assert passed + back == pytest.approx(1.0, abs=1e-4)


def test_the_source_is_the_sum_over_directions() -> None:
    light = scattered_light(cloud(), SUN, medium=FORWARD, plan=converged(50))
    level = light.solutions[0].level
    _, I, _, _ = radiance_of(light)
    view = np.array([0.6, 0.0, 0.8])
    p = smooth_phase(
        level.scaled.moments, np.clip(level.directions.vectors @ view, -1, 1)
    )
    expected = np.tensordot(level.scaled.albedo[0] * level.directions.weights * p, I, 1)
    found = source_toward(light, view)[..., 0]
    near = level.beams.near
    np.testing.assert_allclose(found[near], np.maximum(expected, 0.0)[near], atol=1e-7)


@pytest.mark.slow
def test_staged_light_is_the_converged_light_of_its_last_directions() -> None:
    plan = dataclasses.replace(PLANS["finest"])
    staged = scattered_light(cloud(16), SUN, medium=FORWARD, plan=plan)
    alone = scattered_light(cloud(16), SUN, medium=FORWARD, plan=converged(128))
    assert len(staged.iterations) > 1
    J, expected = (source_toward(light, [0, 0.6, 0.8]) for light in (staged, alone))
    np.testing.assert_allclose(J, expected, atol=1e-5 * expected.max())


def test_voxels_need_not_be_cubes() -> None:
    def ball(D: int, H: int, W: int) -> VoxelGrid:
        z, y, x = ((np.arange(n) + 0.5) / n * 2 - 1 for n in (D, H, W))
        r2 = z[:, None, None] ** 2 + y[:, None] ** 2 + x**2
        return VoxelGrid(np.clip(1.2 - 1.9 * r2, 0.0, 1.0), [-1] * 3, [1] * 3)

    how = {"medium": Medium(4.0, phase="isotropic"), "plan": converged(50, 1e-5)}
    sums = []
    for shape in ((16, 16, 16), (16, 24, 12)):
        grid = ball(*shape)
        light = scattered_light(grid, SUN, **how)
        J = source_toward(light, [0, 0, 1])[..., 0]
        level = light.solutions[0].level
        cell = (light.upper - light.lower) / np.array(light.shape[::-1])
        _, _, extinction, _ = radiance_of(light)
        sums.append(float((J * extinction).sum() * cell.prod()))
        assert level.beams.groups
    assert sums[1] == pytest.approx(sums[0], rel=0.01)  # seen .001


def test_the_source_of_each_direction_holds_the_first_order() -> None:
    light = scattered_light(cloud(), SUN, medium=FORWARD, plan=converged(26))
    level = light.solutions[0].level
    dark = np.zeros_like(light.moments[0])
    first = source_of(dataclasses.replace(light, moments=(dark,)))
    T = level.sunlight[0, 0] / harmonics(-SUN.direction, 3)[0]
    for n, w in enumerate(level.directions.vectors):
        p = smooth_phase(level.scaled.moments, np.array(-(w @ SUN.direction)))
        expected = float(level.scaled.albedo[0]) * float(p) * T
        np.testing.assert_allclose(first[n][level.beams.near], expected, atol=1e-12)


@pytest.mark.parametrize("turned", [0.0, 0.3, 0.9, 0.999])
def test_opposed_beams_lose_what_they_scatter(turned: float) -> None:
    """Neither makes light: what leaves, and what is scattered aside, came in."""
    whole, n = 7.0, 64
    own = np.full(n, whole / n)
    tau = (np.arange(n) + 0.5) * whole / n
    on, back = folded_beams(tau, np.full(n, whole), own, turned=turned)
    passed, returned = passed_and_returned(np.array(whole), turned)
    aside = (1.0 - turned) * float(((on + back) * own).sum())
    assert aside + passed + returned == pytest.approx(1.0, abs=1e-12)
    assert (on >= 0.0).all()
    assert (back >= 0.0).all()
    if not turned:
        np.testing.assert_allclose(on, cell_mean(tau, own), rtol=1e-14)
        assert not back.any()


# Stability


@pytest.mark.parametrize("thick", [1e-6, 1.0, 30.0, 1e3])
@pytest.mark.parametrize("g", [-0.95, 0.0, 0.95])
def test_thick_and_thin_voxels_give_finite_light(thick: float, g: float) -> None:
    grid = cloud(6)
    medium = Medium(6.0 * thick, g=g, phase="hg")
    light = scattered_light(
        grid, SUN, medium=medium, sky=WHITE, plan=Plan((Stage(26, 0, 30),))
    )
    J = source_toward(light, [0.1, 0.2, 0.3])
    assert np.isfinite(J).all()
    assert J.min() >= 0.0
    # Nothing is brighter than the furnace of sky and sun together.
    assert J.max() <= 1.0 + 1.0


def test_what_does_not_converge_says_so() -> None:
    plan = Plan((Stage(26, 0, 5, 1e-9),))
    light = scattered_light(cloud(), SUN, medium=Medium(200.0), plan=plan)
    assert not light.converged
    assert light.residual > 1e-9
    assert "not converged" in repr(light)


@pytest.mark.parametrize("plan", PLANS)
@pytest.mark.parametrize("shape", [(1, 1, 1), (3, 1, 2), (4, 4, 4)])
def test_empty_and_tiny_grids(plan: str, shape: tuple[int, int, int]) -> None:
    for density in (np.zeros(shape), np.ones(shape)):
        grid = VoxelGrid(density, [0, 0, 0], [1, 1, 1])
        light = scattered_light(grid, SUN, medium=FORWARD, plan=plan)
        J = source_toward(light, [0, 0, 1])
        assert np.isfinite(J).all()
        assert light.converged
        if not density.any():
            assert not J.any()


def test_clouds_that_do_not_touch_light_each_other() -> None:
    density = np.zeros((8, 8, 20))
    density[2:6, 2:6, 2:6] = 1.0
    near, far = density.copy(), density.copy()
    far[2:6, 2:6, 14:18] = 1.0
    box = [0, 0, 0], [2.5, 1, 1]
    how = {"medium": Medium(5.0, phase="isotropic"), "plan": converged(26)}
    alone, both = (
        scattered_light(VoxelGrid(d, *box), Sun([0, 1, 0]), **how) for d in (near, far)
    )
    J = source_toward(alone, [0, 0, 1])
    lit = source_toward(both, [0, 0, 1])[: J.shape[0], : J.shape[1], : J.shape[2]]
    inside = J > 0.0
    assert (lit[inside] >= J[inside] - 1e-5).all()
    assert lit.sum() > J.sum()


@pytest.mark.parametrize("sigma_t", [1e5, 1e300])
def test_voxels_too_thick_to_carry_light_are_refused(sigma_t: float) -> None:
    with pytest.raises(ValueError, match=r"^sigma_t: expected an optical depth of at"):
        scattered_light(cloud(4), SUN, medium=Medium(sigma_t))


def test_an_unknown_plan_is_refused() -> None:
    with pytest.raises(ValueError, match=r"^plan: expected "):
        scattered_light(cloud(4), SUN, medium=FORWARD, plan="best")


def test_same_cloud_same_bits() -> None:
    one, two = (
        scattered_light(cloud(), SUN, medium=FORWARD, plan="quick") for _ in range(2)
    )
    assert np.array_equal(one.moments[0], two.moments[0])
    assert uniform(np.arange(3), seed=1).shape == (3,)
