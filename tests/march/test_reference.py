"""What checked rays are held against: near the quadrature, or the quadrature itself."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from small_marches import BLOB, SUN, blob
from smooth_clouds import cloud
from twins.march import directions

from refcloud.camera import Camera, rays
from refcloud.cloudmap import VoxelGrid
from refcloud.conventions import unit_vector
from refcloud.march import certified, integrate
from refcloud.march.certificate import Certificate, certificate_for
from refcloud.march.cubics import read_cubics, smooth_columns
from refcloud.march.task import Task
from refcloud.march.volumes import volumes_of
from refcloud.optics import Medium, Sun
from refcloud.transport import column_density, sun_depths

EYE = Camera([1.5, 1.0, 3.2], [0, 0, 0], fov_y=0.53, width=40, height=30)


@given(st.floats(1.0, 3.0), st.floats(1.0, 4.0), st.floats(1.0, 5.0))
def test_cubics_keep_what_is_linear(w, v, u) -> None:
    z, y, x = np.meshgrid(*(np.arange(n) for n in (5, 6, 7)), indexing="ij")
    table = (1.0 + 0.25 * x + 2.0 * y + 0.5 * z).astype(np.float32)
    found = read_cubics(table, [np.array([place]) for place in (w, v, u)])
    assert found[0] == pytest.approx(1.0 + 0.25 * u + 2.0 * v + 0.5 * w, abs=1e-5)


@settings(max_examples=10)
@given(directions())
def test_cubics_are_near_the_exact_columns(toward) -> None:
    grid, sun = cloud(24), unit_vector(np.asarray(toward))
    points = np.random.default_rng().uniform(-0.6, 0.6, (400, 3))
    exact = column_density(grid, points, sun)
    found = smooth_columns(sun_depths(grid, sun, dtype="float32")).columns(points)
    # Columns up to .15. Worst of 200 suns .00051, of straight lines .00087; the median
    # .0002 and .0006. Along an axis lines are better: there columns have kinks.
    assert np.sqrt(np.square(found - exact).mean()) < 8e-4


def checked(grid, sigma_t: float, tolerance: float) -> dict:
    seen: dict = {}
    how = {"suns": SUN, "medium": Medium(sigma_t), "observe": seen.__setitem__}
    integrate(grid, *rays(EYE), **how, tolerance=tolerance)
    return seen


def test_a_smooth_cloud_is_checked_at_next_to_no_cost(monkeypatch) -> None:
    """Only few rays have their columns integrated; the gap counts in what is told."""
    asked = []
    true_exact = Task.exact

    def counted(self, least=0.0, points=4, columns_to=None):
        if columns_to is None:
            asked.append(len(self.origins))
        return true_exact(self, least, points, columns_to)

    monkeypatch.setattr(Task, "exact", counted)
    seen = checked(cloud(40), 6.0, 0.03)
    assert sum(asked) <= 20 < len(seen["checked rays"])
    gap = seen["gap of the reference"]
    assert 0.0 < gap < 0.015
    worst = list(seen["errors of settings"].values())[-1]
    assert 2.0 * worst + gap <= seen["skipped"][0].bound <= 0.03


def test_where_the_gap_takes_too_much_the_quadrature_is_the_reference() -> None:
    sharp = VoxelGrid(1.0 * (BLOB.density > 0.2), BLOB.lower, BLOB.upper)
    assert checked(sharp, 8.0, 0.01)["gap of the reference"] == 0.0
    assert checked(blob((9, 9, 9), 3), 4.0, 0.3)["gap of the reference"] > 0.0


@settings(max_examples=4, suppress_health_check=[HealthCheck.too_slow])
@given(st.integers(0, 2**40), st.floats(0.5, 4.0), directions())
def test_the_gap_holds_along_every_checked_ray(seed, sigma_t, toward) -> None:
    """Also where few rays are far off: those are found by what straight lines read."""
    kept: list[Certificate] = []

    def watched(*given_) -> Certificate | None:
        found = certificate_for(*given_)
        kept.extend([found] if found is not None else [])
        return found

    how = {"suns": Sun(toward), "medium": Medium(sigma_t), "tolerance": 1.0}
    with pytest.MonkeyPatch.context() as context:
        context.setattr(certified, "certificate_for", watched)
        integrate(blob((9, 8, 10), seed), *rays(EYE), **how)
    (one,) = kept
    assert one.reference.tables is not None
    off = one.some.error(one.some.exact(), one.expected)
    # Gauged at two points of a piece, not at four, and in single precision.
    assert off <= one.reference.gap + 1e-5


def test_light_volumes_of_the_reference_are_those_of_the_march() -> None:
    seen = checked(cloud(40), 6.0, 0.03)
    assert len(seen["light volumes"]) == 1
    kept = volumes_of(cloud(40), (SUN,), seen["light volumes"]).at(1)
    assert kept[0] is seen["light volumes"][0]
