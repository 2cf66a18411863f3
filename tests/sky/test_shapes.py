"""Fractal textures, the puff and the displaced sphere."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from twins.noise import seeds

from refcloud.noise import fbm
from refcloud.sky import (
    Displacement,
    Puff,
    displaced_sphere,
    fractal_texture,
    fractal_volume,
    puff_density,
)

times = st.floats(-20.0, 20.0)
PLACES = np.stack(np.meshgrid(*[np.linspace(-2.2, 2.2, 23)] * 2), axis=-1)


@settings(max_examples=10)
@given(seeds, st.integers(1, 4), times)
def test_a_fractal_texture_closes_in_space_and_in_time(seed, cells, time) -> None:
    how = {"cells": cells, "seed": seed, "octaves": 2}
    texture, _ = fractal_texture(8, time=time, **how)
    later, _ = fractal_texture(8, time=time + cells, **how)
    np.testing.assert_allclose(later, texture, atol=1e-12)
    place = np.array([[0.5, 0.5], [0.5, 0.5 + 8]]) * cells / 8
    one, other = fbm(place, time=time, seed=seed, octaves=2, period=cells)
    assert one == pytest.approx(texture[0, 0], abs=1e-12)
    assert other == pytest.approx(one, abs=1e-12)


def test_octaves_finer_than_a_texel_are_reported() -> None:
    for make in (fractal_texture, fractal_volume):
        values, (row,) = make(8, cells=4, octaves=4)
        assert (row.skipped, row.of) == (2, 4)
        assert np.abs(values).max() <= 1.0


@given(seeds, times)
def test_a_puff_closes_in_time_and_stays_within_its_reach(seed, time) -> None:
    puff = Puff(seed=seed, octaves=2, period=4)
    density = puff_density(PLACES, puff, time=time)
    assert ((density >= 0.0) & (density <= 1.0)).all()
    away = np.hypot(PLACES[..., 0], PLACES[..., 1])
    assert (density[away >= 1.0 + puff.distortion] == 0.0).all()
    later = puff_density(PLACES, puff, time=time + 4)
    np.testing.assert_allclose(later, density, atol=1e-11)


def test_noise_distorts_a_circle_by_as_much_as_it_is_told() -> None:
    angle = np.linspace(0.0, 2.0 * np.pi, 400, endpoint=False)
    radii = np.linspace(0.0, 2.0, 400)
    ring = radii[:, None, None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    spread = []
    for distortion in (0.0, 0.2, 0.6):
        density = puff_density(ring, Puff(distortion=distortion, seed=3), time=0.7)
        edge = radii[(density > 0.0).argmin(axis=0)]
        spread.append(np.ptp(edge))
    assert spread[0] == 0.0
    assert 0.02 < spread[1] < spread[2]


def test_the_product_stays_in_the_circle() -> None:
    density = puff_density(PLACES, Puff(combine="multiply", seed=1), time=0.2)
    away = np.hypot(PLACES[..., 0], PLACES[..., 1])
    assert (density[away >= 1.0] == 0.0).all()
    assert 0.0 < density.max() < 1.0


def ways(count: int) -> np.ndarray:
    """Spread directions over a sphere by the golden angle."""
    k = np.arange(count) + 0.5
    up, around = 1.0 - 2.0 * k / count, np.pi * (1.0 + np.sqrt(5.0)) * k
    level = np.sqrt(1.0 - up * up)
    return np.stack([level * np.cos(around), up, level * np.sin(around)], axis=1)


@given(seeds, times, st.integers(1, 3))
def test_normals_are_those_of_the_moved_surface(seed, time, octaves) -> None:
    displacement = Displacement(0.3, 1.5, octaves, seed=seed)
    d, step = ways(20), 1e-5
    points, normals = displaced_sphere(d, displacement, time=time)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, rtol=1e-12)
    side = np.cross(d, [0.48, 0.6, 0.64])
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    for tangent in (side, np.cross(d, side)):
        ahead, behind = (
            displaced_sphere(
                (d + s * tangent) / np.hypot(1, step), displacement, time=time
            )
            for s in (step, -step)
        )
        along = (ahead[0] - behind[0]) / (2.0 * step)
        # Second differences of octaves of some 10 cells leave 1e-8 of a slope.
        assert np.abs(np.einsum("ij,ij->i", along, normals)).max() < 1e-6
    assert (np.einsum("ij,ij->i", normals, points) > 0.0).all(), "they point outward"


@given(seeds, times)
def test_vertices_move_by_simplex_noise_in_four_dimensions(seed, time) -> None:
    d = ways(30)
    displacement = Displacement(0.4, 1.3, 2, seed=seed)
    points, _ = displaced_sphere(d, displacement, time=time)
    noise = fbm(1.3 * d, kind="simplex", time=time, seed=seed, octaves=2)
    np.testing.assert_allclose(points, (1.0 + 0.4 * noise)[:, None] * d, atol=1e-12)


def test_a_sphere_that_is_not_moved_is_one() -> None:
    points, normals = displaced_sphere(ways(9), Displacement(amount=0.0), time=3.0)
    np.testing.assert_allclose(points, ways(9), atol=1e-15)
    np.testing.assert_allclose(normals, ways(9), atol=1e-15)


def test_a_displaced_sphere_takes_unit_vectors_and_waves_that_are_numbers() -> None:
    with pytest.raises(ValueError, match=r"^directions: expected numbers in \[-1, 1\]"):
        displaced_sphere([[0.0, 1e300, 0.0]], Displacement())
    with pytest.raises(ValueError, match=r"^frequency: expected .* in \[1e-100, 1e"):
        Displacement(frequency=1e300)
    for frequency in (1e-100, 1e100):
        fine = Displacement(frequency=frequency, octaves=32)
        _, normals = displaced_sphere(ways(9), fine)
        np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, atol=1e-14)
