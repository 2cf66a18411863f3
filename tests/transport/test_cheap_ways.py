"""Stand-ins for multiple scattering: what they keep, and how far off they are."""

from __future__ import annotations

import numpy as np
import pytest
from small_lights import BALL, SUN

from refcloud.camera import Camera
from refcloud.cloudmap import VoxelGrid
from refcloud.optics import Medium
from refcloud.scattering_pictures import WAYS, compare_ways, figure_of_ways
from refcloud.transport import diffuse_source, diffused_light, forward_depth

EYE = Camera([1.2, 0.9, 3.0], [0.5, 0.5, 0.5], fov_y=0.5, width=16, height=12)
MEDIUM = Medium(9.0, g=0.6, phase="hg")


def test_diffused_light_leaves_as_it_came() -> None:
    """Albedo 1: what crosses the cloud's faces is what the sun brought in."""
    medium = Medium(9.0, phase="isotropic")
    light = diffused_light(BALL, SUN, medium=medium)
    inside = BALL.density * 9.0 / 16 > 1e-3
    h, sigma = 1 / 16, 9.0 * BALL.density
    D = 1.0 / (3.0 * np.where(inside, sigma, 1.0))
    out = 0.0
    for axis in range(3):
        for shift in (1, -1):
            beyond = np.roll(inside, shift, axis)  # its border is empty
            out += ((inside & ~beyond) * h * h * light.total / (0.5 * h / D + 2)).sum()
    beam = _beam(medium)
    assert out == pytest.approx((sigma * beam * inside).sum() * h**3, rel=1e-3)


def _beam(medium: Medium) -> np.ndarray:
    from refcloud.transport import cell_mean, sun_depths
    from refcloud.transport.sweep import step_of

    sigma = float(medium.sigma_t_rgb[0])
    path = step_of(SUN.direction, np.full(3, 1 / 16)).length
    columns = sun_depths(BALL, SUN.direction).density
    return cell_mean(sigma * columns, sigma * BALL.density * path)


def test_diffused_light_goes_where_it_flows() -> None:
    light = diffused_light(BALL, SUN, medium=MEDIUM)
    assert light.iterations < 200
    ahead, behind = (diffuse_source(light, s * SUN.direction) for s in (-1.0, 1.0))
    assert ahead.sum() > behind.sum() > 0.0
    # Where the beam enters, more flows than a series of two terms can hold.
    whole = (ahead > 0.0) & (behind > 0.0)
    assert whole.sum() > 100
    phi = light.total[whole]
    mean = 0.5 * (ahead + behind)[whole]
    np.testing.assert_allclose(mean, light.albedo * phi / (4 * np.pi))


def test_no_cloud_diffuses_nothing() -> None:
    empty = VoxelGrid(np.zeros((2, 3, 1)), [0, 0, 0], [1, 1, 1])
    light = diffused_light(empty, SUN, medium=MEDIUM)
    assert not light.total.any()


def test_e23_handing_light_on_never_makes_light() -> None:
    tau = np.array([0.0, 1e-9, 0.5, 9.0, 9.5, 1e3, 1e6])
    depth = forward_depth(tau, kappa=0.107)
    assert (depth >= 0.0).all()
    assert (depth <= tau).all()
    # Held at 1 beyond tau = 9.308.
    np.testing.assert_allclose(depth[4:], 0.0, atol=1e-12)


def test_every_way_is_drawn_and_measured() -> None:
    compared = compare_ways(BALL, EYE, sun=SUN, medium=MEDIUM)
    assert [c.name for c in compared[:-1]] == list(WAYS)
    true = compared[-1].radiance
    errors = {c.name.split()[0]: c.error for c in compared[:-2]}
    assert compared[-1].error == 0.0
    assert compared[-2].error < 0.01
    # The order that the figure tells of.
    assert errors["26"] < 0.05 < errors["P1"] < errors["single"]
    assert errors["octaves"] < errors["Beer-powder"]
    figure = figure_of_ways(compared, true)
    assert figure.linear.shape == (24, 16 * len(compared), 3)
    below = figure.linear[12:, -16:]
    np.testing.assert_allclose(below, 1.0)  # the truth is not off
